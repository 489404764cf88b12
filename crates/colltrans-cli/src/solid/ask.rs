//! The question between two placed bodies, and its answer.

use std::path::Path;

use colltrans::glam::DVec3;
use colltrans::solid::{SolidContact, SolidOverlap, StartOverlap};
use colltrans::{Bounded, Cast, Clearance, Feature, Pose, ProofFile, QueryError, Solid};
use colltrans_mesh::body::between;

use super::{Body, Piece};
use crate::failure::{Code, Failure};
use crate::numbers::counted;
use crate::record::FeatureRecord;

/// What rounding alone can do to a length, as a part of the scene's size.
const ROUNDING: f64 = 1e-14;

/// How far a body can move from where it is.
#[derive(Clone, Copy)]
pub(crate) struct Question<'a> {
    pub(crate) moving: &'a Body,
    pub(crate) moving_pose: Pose,
    pub(crate) fixed: &'a Body,
    pub(crate) fixed_pose: Pose,
    pub(crate) direction: DVec3,
    /// `None` for what the files' precision asks for.
    pub(crate) tolerance: Option<f64>,
    pub(crate) ignore_start_overlaps: bool,
}

/// What can be said.
pub(crate) struct Answer<'a> {
    pub(crate) kind: Kind<'a>,
    /// The tolerance that was used, a length.
    pub(crate) tolerance: f64,
    /// The translation after which the bodies never meet; `None` if they never do.
    pub(crate) exit: Option<Bounded>,
    /// What overlaps at the start, the deepest first; looked at where it matters.
    pub(crate) overlaps: Vec<Overlap<'a>>,
    /// Which of the moving and the fixed body are surfaces, at least in part.
    pub(crate) surfaces: [bool; 2],
    /// What could not be shrunk as the tolerance asks for.
    pub(crate) notes: Vec<String>,
    /// How far lengths may be off by the precision of the files and by rounding.
    pub(crate) error: f64,
}

impl Answer<'_> {
    /// `moving` and `fixed`, those that are surfaces.
    pub(crate) fn surface_names(&self) -> Vec<&'static str> {
        let names = ["moving", "fixed"].into_iter().zip(self.surfaces);
        names.filter_map(|(name, is_surface)| is_surface.then_some(name)).collect()
    }
}

/// How it ends.
pub(crate) enum Kind<'a> {
    Free,
    Blocked(Box<Stop<'a>>),
    Overlapping,
}

/// What stops the moving body.
pub(crate) struct Stop<'a> {
    /// How far it is safe to move, in multiples of the direction.
    pub(crate) distance: f64,
    /// Where the facets that stop it meet in their true place.
    pub(crate) translation: Bounded,
    /// How far the shrunk bodies go.
    pub(crate) shrunk: Bounded,
    pub(crate) normal: DVec3,
    /// On the fixed body.
    pub(crate) point: DVec3,
    pub(crate) moving: Touch<'a>,
    pub(crate) fixed: Touch<'a>,
}

/// What of a file is touched: a feature by the numbers of the file.
pub(crate) struct Touch<'a> {
    pub(crate) file: &'a Path,
    pub(crate) feature: FeatureRecord,
}

/// Two files that overlap where they are.
pub(crate) struct Overlap<'a> {
    pub(crate) moving: &'a Path,
    pub(crate) fixed: &'a Path,
    /// The least tolerance with which they would not; `None` if there is none.
    pub(crate) depth: Option<f64>,
}

impl<'a> Question<'a> {
    /// Pairs of files that may be looked at.
    pub(crate) fn pairs(&self) -> usize {
        self.moving.pieces.len() * self.fixed.pieces.len()
    }

    /// The answer; `done` is called after each pair of files that was looked at.
    pub(crate) fn ask(&self, done: impl FnMut()) -> Result<Answer<'a>, QueryError> {
        let precisions = [self.moving.precision(), self.fixed.precision()];
        let cast =
            self.cast(self.moving.solid(), self.fixed.solid(), precisions, self.tolerance)?;
        let tolerance = cast.tolerance();
        let kind = match cast.clearance()? {
            Clearance::Free(_) => Kind::Free,
            Clearance::Blocked { distance, contact } => {
                Kind::Blocked(Box::new(self.stop(distance, &contact)))
            }
            Clearance::Overlapping(_) => Kind::Overlapping,
        };
        let overlaps = if self.ignore_start_overlaps || matches!(kind, Kind::Overlapping) {
            self.overlaps(tolerance, done)?
        } else {
            Vec::new()
        };
        Ok(Answer {
            kind,
            tolerance,
            exit: cast.exit(),
            overlaps,
            surfaces: [self.moving.is_surface(), self.fixed.is_surface()],
            notes: self.unshrunk(tolerance),
            error: precisions[0] + precisions[1] + ROUNDING * self.size(),
        })
    }

    /// The proof of the answer with a tolerance.
    pub(crate) fn prove(&self, tolerance: f64) -> Result<ProofFile, Failure> {
        let cast = self.cast(self.moving.solid(), self.fixed.solid(), [0.0; 2], Some(tolerance))?;
        let [moving, fixed] = [self.moving, self.fixed]
            .map(|body| body.pieces.iter().map(|piece| &piece.solid).collect::<Vec<_>>());
        ProofFile::of_solids(&cast, [&moving, &fixed])
            .map_err(|error| Failure::new(Code::Query, error.to_string()))
    }

    fn cast<'s>(
        &self,
        moving: &'s Solid,
        fixed: &'s Solid,
        precisions: [f64; 2],
        tolerance: Option<f64>,
    ) -> Result<Cast<'s, Solid>, QueryError> {
        let start =
            if self.ignore_start_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
        let (moving, fixed) = (moving.at(self.moving_pose), fixed.at(self.fixed_pose));
        between(moving, fixed, self.direction, precisions, tolerance, start)
    }

    fn stop(&self, distance: f64, contact: &SolidContact) -> Stop<'a> {
        Stop {
            distance,
            translation: contact.translation,
            shrunk: contact.shrunk_distance,
            normal: contact.normal,
            point: contact.point_on_fixed,
            moving: self.moving.touch(contact.moving_feature),
            fixed: self.fixed.touch(contact.fixed_feature),
        }
    }

    /// All pairs of files, because bodies overlap exactly where pieces of them do.
    fn overlaps(
        &self,
        tolerance: f64,
        mut done: impl FnMut(),
    ) -> Result<Vec<Overlap<'a>>, QueryError> {
        let mut found = Vec::new();
        for moving in &self.moving.pieces {
            for fixed in &self.fixed.pieces {
                let cast = self.cast(&moving.solid, &fixed.solid, [0.0; 2], Some(tolerance))?;
                if let Some(SolidOverlap { least_tolerance: depth, .. }) = cast.start_overlap() {
                    let (moving, fixed) = (moving.file.as_path(), fixed.file.as_path());
                    found.push(Overlap { moving, fixed, depth });
                }
                done();
            }
        }
        let depth = |overlap: &Overlap| overlap.depth.unwrap_or(f64::INFINITY);
        found.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
        Ok(found)
    }

    /// What shrinking by half the tolerance cannot do as it should, file by file.
    fn unshrunk(&self, tolerance: f64) -> Vec<String> {
        if tolerance == 0.0 {
            return Vec::new();
        }
        let pieces = self.moving.pieces.iter().chain(&self.fixed.pieces);
        pieces.filter_map(|piece| piece.unshrunk(tolerance / 2.0)).collect()
    }

    /// The largest coordinate.
    fn size(&self) -> f64 {
        let reach = |body: &Body, pose: &Pose| {
            let bounds = body.solid().bounds();
            let corners = [bounds.low, bounds.high].map(DVec3::length);
            corners[0].max(corners[1]) + pose.translation().length()
        };
        reach(self.moving, &self.moving_pose).max(reach(self.fixed, &self.fixed_pose))
    }
}

impl Body {
    /// The file of a feature, and the feature in its numbers.
    fn touch(&self, feature: Feature) -> Touch<'_> {
        let mut vertices: Vec<u32> =
            feature.vertices(self.solid()).into_iter().map(u32::from).collect();
        let (mut first, mut base) = (vertices.first().copied().unwrap_or(0), 0);
        let mut owner = &self.pieces[0];
        // The inputs of the pieces are numbered through.
        for piece in &self.pieces {
            owner = piece;
            let [count, _] = piece.solid.input_counts();
            if first < count {
                break;
            }
            (first, base) = (first - count, base + count);
        }
        for vertex in &mut vertices {
            *vertex -= base;
        }
        let feature = FeatureRecord { kind: feature.kind(), vertices };
        Touch { file: &owner.file, feature }
    }
}

impl Piece {
    fn unshrunk(&self, amount: f64) -> Option<String> {
        let report = self.solid.shrink_report(amount);
        let mut text = Vec::new();
        if let Some(first) = report.stuck.first() {
            let (one, many) = ("vertex stays where it is", "vertices stay where they are");
            let vertices = counted(report.stuck.len(), one, many);
            text.push(format!("{vertices}, as in a saddle (vertex {first})"));
        }
        if let Some(first) = report.inverted.first() {
            let one = "face turns inside out or passes through another";
            let many = "faces turn inside out or pass through others";
            let faces = counted(report.inverted.len(), one, many);
            text.push(format!(
                "{faces}, because the part is thinner than the tolerance (face {first})"
            ));
        }
        // A convex body of a batch has no file.
        let is_file = !self.file.as_os_str().is_empty();
        let name = if is_file { self.file.display().to_string() } else { "the convex body".into() };
        (!text.is_empty())
            .then(|| format!("{name}: not all of it can be shrunk: {}", text.join("; ")))
    }
}
