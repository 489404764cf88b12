//! The question between two placed bodies, and its answer.

use colltrans::glam::DVec3;
use colltrans::record::{Ending, FeatureRecord, SolidClearanceRecord, StartOverlapRecord};
use colltrans::solid::{SolidCast, SolidOverlap, StartOverlap};
use colltrans::{Cast, Pose, ProofFile, QueryError, Solid};
use colltrans_mesh::body::between;

use super::{Body, Piece, name_features};
use crate::failure::{Code, Failure};

/// What rounding alone can do to a length, as a part of the scene's size.
const ROUNDING: f64 = 1e-14;

/// How far a body can move from where it is.
#[derive(Clone, Copy)]
pub(crate) struct PartsQuery<'a> {
    pub(crate) bodies: [&'a Body; 2],
    pub(crate) poses: [Pose; 2],
    pub(crate) direction: DVec3,
    /// `None` for what the files' precision asks for.
    pub(crate) tolerance: Option<f64>,
    pub(crate) ignore_start_overlaps: bool,
    /// The gap to be kept, or 0.
    pub(crate) keep: f64,
}

/// What can be said.
pub(crate) struct Answer {
    /// With the names of files, and all that overlaps at the start, the deepest first; that is looked
    /// at where it matters.
    pub(crate) record: SolidClearanceRecord,
    /// What could not be shrunk as the tolerance asks for.
    pub(crate) notes: Vec<String>,
    /// How far lengths may be off by the precision of the files and by rounding.
    pub(crate) error: f64,
}

impl<'a> PartsQuery<'a> {
    /// Returns a query between placed bodies for answers that do not depend on its direction.
    pub(super) const fn placed(
        bodies: [&'a Body; 2],
        poses: [Pose; 2],
        tolerance: Option<f64>,
    ) -> Self {
        let (direction, ignore_start_overlaps, keep) = (DVec3::Z, false, 0.0);
        Self { bodies, poses, direction, tolerance, ignore_start_overlaps, keep }
    }

    /// Pairs of files that may be looked at.
    pub(crate) fn pairs(&self) -> usize {
        self.bodies.map(|body| body.pieces.len()).into_iter().product()
    }

    /// The answer; `done` is called after each pair of files that was looked at.
    pub(crate) fn ask(&self, done: impl FnMut()) -> Result<Answer, QueryError> {
        let cast = self.of_bodies()?;
        let tolerance = cast.tolerance();
        let clearance = cast.clearance()?;
        let mut record = SolidClearanceRecord::of(&clearance, cast.exit(), &cast);
        [record.moving, record.fixed] = name_features(self.bodies, &mut record.features);
        if self.ignore_start_overlaps || record.outcome == Ending::Overlapping {
            record.start_overlaps = self.overlaps(tolerance, done)?;
        }
        if record.outcome == Ending::Overlapping
            && let Some(deepest) = record.start_overlaps.first()
        {
            (record.moving, record.fixed) = (deepest.moving.clone(), deepest.fixed.clone());
        }
        Ok(Answer { record, notes: self.unshrunk(tolerance), error: self.error() })
    }

    /// How far lengths may be off by the precision of the files and by rounding.
    pub(super) fn error(&self) -> f64 {
        self.bodies.map(Body::precision).into_iter().sum::<f64>() + ROUNDING * self.size()
    }

    /// The proof of the answer with a tolerance.
    pub(crate) fn prove(&self, tolerance: f64) -> Result<ProofFile, Failure> {
        let cast = self.cast(self.bodies.map(Body::solid), [0.0; 2], Some(tolerance))?;
        let [moving, fixed] = self.bodies.map(Body::solids);
        ProofFile::of_solids(&cast, [&moving, &fixed])
            .map_err(|error| Failure::new(Code::Query, error.to_string()))
    }

    /// The query as the library has it.
    pub(super) fn of_bodies(&self) -> Result<Cast<'_, Solid>, QueryError> {
        self.cast(self.bodies.map(Body::solid), self.bodies.map(Body::precision), self.tolerance)
    }

    fn cast<'s>(
        &self,
        [moving, fixed]: [&'s Solid; 2],
        precisions: [f64; 2],
        tolerance: Option<f64>,
    ) -> Result<Cast<'s, Solid>, QueryError> {
        let start =
            if self.ignore_start_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
        let (moving, fixed) = (moving.at(self.poses[0]), fixed.at(self.poses[1]));
        between(moving, fixed, self.direction, precisions, tolerance, start)?.keeping(self.keep)
    }

    /// All pairs of files, because bodies overlap exactly where pieces of them do.
    pub(super) fn overlaps(
        &self,
        tolerance: f64,
        mut done: impl FnMut(),
    ) -> Result<Vec<StartOverlapRecord>, QueryError> {
        let mut found = Vec::new();
        for moving in &self.bodies[0].pieces {
            for fixed in &self.bodies[1].pieces {
                let of_files = |by| self.cast([&moving.solid, &fixed.solid], [0.0; 2], Some(by));
                let cast = match of_files(tolerance) {
                    // A file among others of which nothing is left is asked as it is.
                    Err(QueryError::NothingLeft { .. }) => of_files(0.0)?,
                    cast => cast?,
                };
                if let Some(SolidOverlap { least_tolerance, .. }) = cast.start_overlap() {
                    let [moving, fixed] = [moving.name(), fixed.name()].map(Some);
                    found.push(StartOverlapRecord { moving, fixed, least_tolerance });
                }
                done();
            }
        }
        let depth = |overlap: &StartOverlapRecord| overlap.least_tolerance.unwrap_or(f64::INFINITY);
        found.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
        Ok(found)
    }

    /// What shrinking by half the tolerance cannot do as it should, file by file.
    pub(super) fn unshrunk(&self, tolerance: f64) -> Vec<String> {
        if tolerance == 0.0 {
            return Vec::new();
        }
        let pieces = self.bodies.into_iter().flat_map(|body| &body.pieces);
        pieces.filter_map(|piece| piece.unshrunk(tolerance / 2.0)).collect()
    }

    /// The largest coordinate.
    fn size(&self) -> f64 {
        let reach = |k: usize| {
            let bounds = self.bodies[k].solid().bounds();
            let corners = [bounds.low, bounds.high].map(DVec3::length);
            corners[0].max(corners[1]) + self.poses[k].translation().length()
        };
        reach(0).max(reach(1))
    }
}

impl Body {
    /// Numbers a feature as its file does, and returns the file.
    pub(super) fn renumber(&self, feature: &mut FeatureRecord) -> String {
        let (mut first, mut base) = (feature.vertices.first().map_or(0, |v| v.0), 0);
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
        for vertex in &mut feature.vertices {
            vertex.0 -= base;
        }
        owner.name()
    }
}

impl Piece {
    pub(super) fn name(&self) -> String {
        self.file.display().to_string()
    }

    fn unshrunk(&self, amount: f64) -> Option<String> {
        let text = self.reports.of(&self.solid, amount)?;
        // A convex body of a batch has no file.
        let is_file = !self.file.as_os_str().is_empty();
        let name = if is_file { self.file.display().to_string() } else { "the convex body".into() };
        Some(format!("{name}: not all of it can be shrunk: {text}"))
    }
}
