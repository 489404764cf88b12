//! Clearances of two placed bodies of parts.

use colltrans::glam::DVec3;
use colltrans::record::{Ending, FeatureRecord, SolidClearanceRecord, StartOverlapRecord};
use colltrans::solid::{SolidCast, SolidOverlap, StartOverlap};
use colltrans::{Cast, Pose, ProofFile, QueryError, Solid};
use colltrans_mesh::body::cast_between;

use super::{Body, Piece, extent, renumber_features};
use crate::failure::{Code, Failure};

/// Rounding error of a length, relative to the size of the scene.
const RELATIVE_ROUNDING: f64 = 1e-14;

/// The query how far a body can move before another blocks it.
#[derive(Clone, Copy)]
pub(crate) struct PartsQuery<'a> {
    pub(crate) bodies: [&'a Body; 2],
    pub(crate) poses: [Pose; 2],
    pub(crate) direction: DVec3,
    /// `None` for the default, which follows from the precision of the files.
    pub(crate) tolerance: Option<f64>,
    pub(crate) ignore_start_overlaps: bool,
    /// The minimum gap, or 0.
    pub(crate) min_gap: f64,
}

/// The answer of a [`PartsQuery`].
pub(crate) struct Answer {
    /// The record with names of files. Overlaps at the start are computed if they are ignored or the bodies overlap; the
    /// deepest is first.
    pub(crate) record: SolidClearanceRecord,
    /// Notes about surfaces that cannot be offset by the tolerance.
    pub(crate) notes: Vec<String>,
    /// Error of lengths: the precision of the files, and rounding.
    pub(crate) error: f64,
    /// Extent of the smaller body.
    pub(crate) extent: f64,
}

impl<'a> PartsQuery<'a> {
    /// Returns a query for answers that do not depend on its direction.
    pub(super) const fn without_direction(
        bodies: [&'a Body; 2],
        poses: [Pose; 2],
        tolerance: Option<f64>,
    ) -> Self {
        let (direction, ignore_start_overlaps, min_gap) = (DVec3::Z, false, 0.0);
        Self { bodies, poses, direction, tolerance, ignore_start_overlaps, min_gap }
    }

    /// Returns the number of pairs of files.
    pub(crate) fn pair_count(&self) -> usize {
        self.bodies.map(|body| body.pieces.len()).into_iter().product()
    }

    /// Answers the query. Calls `pair_done` after each pair of files whose overlap was computed.
    pub(crate) fn answer(&self, pair_done: impl FnMut()) -> Result<Answer, QueryError> {
        let cast = self.cast_of_bodies()?;
        let tolerance = cast.tolerance();
        let clearance = cast.clearance()?;
        let mut record = SolidClearanceRecord::from_clearance(&clearance, cast.exit(), &cast);
        [record.moving, record.fixed] = renumber_features(self.bodies, &mut record.features);
        if self.ignore_start_overlaps || record.outcome == Ending::Overlapping {
            record.start_overlaps = self.start_overlaps(tolerance, pair_done)?;
        }
        if record.outcome == Ending::Overlapping
            && let Some(deepest) = record.start_overlaps.first()
        {
            (record.moving, record.fixed) = (deepest.moving.clone(), deepest.fixed.clone());
        }
        let notes = self.offset_notes(tolerance);
        Ok(Answer { record, notes, error: self.length_error(), extent: extent(self.bodies) })
    }

    /// Returns the error of lengths: the precision of the files, and rounding.
    pub(super) fn length_error(&self) -> f64 {
        self.bodies.map(Body::precision).into_iter().sum::<f64>()
            + RELATIVE_ROUNDING * self.max_coordinate()
    }

    /// Returns the proof of the answer with a tolerance.
    ///
    /// # Errors
    /// The proof cannot be computed.
    pub(crate) fn prove(&self, tolerance: f64) -> Result<ProofFile, Failure> {
        let cast = self.cast(self.bodies.map(Body::solid), [0.0; 2], Some(tolerance))?;
        let [moving, fixed] = self.bodies.map(Body::solids);
        ProofFile::of_solids(&cast, [&moving, &fixed])
            .map_err(|error| Failure::new(Code::Query, error.to_string()))
    }

    /// Returns the cast of the library.
    pub(super) fn cast_of_bodies(&self) -> Result<Cast<'_, Solid>, QueryError> {
        self.cast(self.bodies.map(Body::solid), self.bodies.map(Body::precision), self.tolerance)
    }

    /// Returns the cast of two solids at the poses of the query.
    fn cast<'s>(
        &self,
        [moving, fixed]: [&'s Solid; 2],
        precisions: [f64; 2],
        tolerance: Option<f64>,
    ) -> Result<Cast<'s, Solid>, QueryError> {
        let start =
            if self.ignore_start_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
        let (moving, fixed) = (moving.at(self.poses[0]), fixed.at(self.poses[1]));
        cast_between(moving, fixed, self.direction, precisions, tolerance, start)?
            .with_min_gap(self.min_gap)
    }

    /// Returns the overlaps of all pairs of files at the start, the deepest first. Bodies overlap exactly if two of their
    /// pieces do.
    pub(super) fn start_overlaps(
        &self,
        tolerance: f64,
        mut pair_done: impl FnMut(),
    ) -> Result<Vec<StartOverlapRecord>, QueryError> {
        let mut found = Vec::new();
        for moving in &self.bodies[0].pieces {
            for fixed in &self.bodies[1].pieces {
                let cast_of_files =
                    |by| self.cast([&moving.solid, &fixed.solid], [0.0; 2], Some(by));
                let cast = match cast_of_files(tolerance) {
                    // A file that the offset removes completely is queried without offset.
                    Err(QueryError::NothingLeft { .. }) => cast_of_files(0.0)?,
                    cast => cast?,
                };
                if let Some(SolidOverlap { least_tolerance, .. }) = cast.start_overlap() {
                    let [moving, fixed] = [moving.name(), fixed.name()].map(Some);
                    found.push(StartOverlapRecord { moving, fixed, least_tolerance });
                }
                pair_done();
            }
        }
        let depth = |overlap: &StartOverlapRecord| overlap.least_tolerance.unwrap_or(f64::INFINITY);
        found.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
        Ok(found)
    }

    /// Returns a note for each file whose surface cannot be offset by half of the tolerance.
    pub(super) fn offset_notes(&self, tolerance: f64) -> Vec<String> {
        if tolerance == 0.0 {
            return Vec::new();
        }
        let pieces = self.bodies.into_iter().flat_map(|body| &body.pieces);
        pieces.filter_map(|piece| piece.offset_note(tolerance / 2.0)).collect()
    }

    /// Returns an upper bound of the coordinates of both placed bodies.
    fn max_coordinate(&self) -> f64 {
        let bound = |k: usize| {
            let bounds = self.bodies[k].bounds();
            let corners = [bounds.low, bounds.high].map(DVec3::length);
            corners[0].max(corners[1]) + self.poses[k].translation().length()
        };
        bound(0).max(bound(1))
    }
}

impl Body {
    /// Renumbers the vertices of a feature as in its file. Returns the name of the file.
    pub(super) fn renumber_feature(&self, feature: &mut FeatureRecord) -> String {
        let (mut first, mut base) = (feature.vertices.first().map_or(0, |v| v.0), 0);
        let mut owner = &self.pieces[0];
        // The input vertices of all pieces are numbered consecutively.
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
    /// Returns the name of the file.
    pub(super) fn name(&self) -> String {
        self.file.display().to_string()
    }

    /// Returns a note about parts of the surface that cannot be offset by an amount; `None` if there are none.
    fn offset_note(&self, amount: f64) -> Option<String> {
        let text = self.reports.report(&self.solid, amount)?;
        // A convex body of a batch has no file.
        let is_file = !self.file.as_os_str().is_empty();
        let name = if is_file { self.file.display().to_string() } else { "the convex body".into() };
        Some(format!("{name}: not all of it can be offset inwards: {text}"))
    }
}
