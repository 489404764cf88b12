//! Walks over the faces of `M0`, the Minkowski difference without translations, to the face that a line enters.
//!
//! A face is *entered* if its inward normal has a positive component along the direction. The projections of the
//! entered faces tile the shadow of `M0`. The walk crosses the side beyond which the line is farthest.

use glam::DVec3;

use super::faces::{Faces, Side};
use super::proof::{Line, LineMargins, SilhouettePlane, build_contact, build_separation};
use colltrans_convex::answer::{Outcome, StartedFrom, Steps};
use colltrans_kernel::noise::UNIT_VECTOR;

/// Minimum component along the direction that exceeds the rounding error.
pub(super) const MIN_ENTRY_COMPONENT: f64 = 0.25 * UNIT_VECTOR;

/// Maximum number of faces of a walk. Few walks need ten.
const MAX_WALK_FACES: u32 = 256;

/// Faces relative to a line, in coordinates of its direction.
pub(super) trait LineView {
    /// Type of the side of a face.
    type Side;
    /// Returns the sides of a face, counter-clockwise in the lateral coordinates of [`Self::corner_coordinates`].
    fn sides(&self, face: u32) -> &[Self::Side];
    /// Returns the start of a side, with the coordinate along the direction last.
    fn corner_coordinates(&self, side: &Self::Side) -> DVec3;
    /// Returns the face beyond a side, or `None` if it is not entered.
    fn face_beyond(&self, side: &Self::Side) -> Option<u32>;
}

/// The end of a walk.
#[derive(Debug, Clone, Copy)]
pub(super) enum WalkEnd {
    /// The face that the line seems to enter; and whether it certainly does, with a sufficient margin.
    Face { face: u32, certain: bool },
    /// A side beyond which the line passes and no face is entered.
    Silhouette { face: u32, side: usize },
}

/// Walks from an entered face. Returns the end and the number of visited faces. Returns `None` if the walk does not end
/// within [`MAX_WALK_FACES`] faces, for example if rounding errors make it cyclic.
#[inline(always)]
#[expect(clippy::inline_always, reason = "passed through memory its end stalls its reader")]
pub(super) fn walk_faces(
    view: &impl LineView,
    mut face: u32,
    margins: &LineMargins,
) -> Option<(WalkEnd, u32)> {
    for visited in 1..=MAX_WALK_FACES {
        let sides = view.sides(face);
        let (mut side, mut farthest, mut over, mut certain) = (sides.len() - 1, 0.0, None, true);
        let mut from = view.corner_coordinates(&sides[side]).truncate();
        for (next, corner) in sides.iter().enumerate() {
            let to = view.corner_coordinates(corner).truncate();
            let area = from.perp_dot(to);
            certain &= margins.is_clearly_inside(area, from, to);
            if area < farthest {
                (farthest, over) = (area, Some(side));
            }
            (side, from) = (next, to);
        }
        let Some(side) = over else { return Some((WalkEnd::Face { face, certain }, visited)) };
        match view.face_beyond(&sides[side]) {
            Some(beyond) => face = beyond,
            None => return Some((WalkEnd::Silhouette { face, side }, visited)),
        }
    }
    None
}

/// Returns the work of visiting the given number of faces.
pub(super) fn walk_steps(visited: u32) -> Steps {
    Steps::from_pivots(visited, StartedFrom::Difference)
}

/// All faces, for casts along any direction.
pub(super) struct FaceView<'f> {
    faces: &'f Faces,
    axes: [DVec3; 3],
    /// Components of `offset` along the axes.
    at: DVec3,
}

impl<'f> FaceView<'f> {
    /// Prepares the faces for a line.
    #[inline]
    pub(super) fn new(faces: &'f Faces, line: &Line) -> Self {
        let axes = line.direction_axes();
        Self { faces, axes, at: coordinates_along(&axes, line.setting.offset) }
    }

    /// Returns the outcome of the line, or `None` if the faces do not make it certain.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "moved about, an outcome goes through memory")]
    pub(super) fn outcome_by_faces(&self, line: &Line) -> Option<Outcome> {
        let setting = line.setting;
        let guess = self.faces.entry_guess.guessed_face(setting.offset, setting.direction);
        match walk_faces(self, self.nearest_entered_face(guess)?, &line.margins)? {
            (WalkEnd::Face { face, certain: true }, visited) => {
                build_contact(self.faces, face, (self, face), line, walk_steps(visited))
                    .map(Outcome::Contact)
            }
            (WalkEnd::Face { .. }, _) => None,
            (WalkEnd::Silhouette { face, side }, visited) => {
                let beyond = self.faces.sides(face)[side].beyond;
                let [face, beyond] = [face, beyond].map(|face| self.faces.plane(face));
                let silhouette = SilhouettePlane::new(face, beyond, setting.unit)?;
                build_separation(&silhouette, line, walk_steps(visited)).map(Outcome::Separated)
            }
        }
    }

    /// Returns an entered face, found by hill climbing. Returns `None` if rounding errors stop the climb.
    fn nearest_entered_face(&self, mut face: u32) -> Option<u32> {
        let along = |face: u32| self.faces.plane(face).normal.dot(self.axes[2]);
        while along(face) <= MIN_ENTRY_COMPONENT {
            let best = self.faces.sides(face).iter().map(|side| side.beyond);
            let best = best.max_by(|a, b| along(*a).total_cmp(&along(*b)))?;
            if along(best) <= along(face) {
                return None;
            }
            face = best;
        }
        Some(face)
    }
}

impl LineView for FaceView<'_> {
    type Side = Side;

    #[inline]
    fn sides(&self, face: u32) -> &[Side] {
        self.faces.sides(face)
    }

    #[inline]
    fn corner_coordinates(&self, side: &Side) -> DVec3 {
        coordinates_along(&self.axes, self.faces.points[side.corner as usize]) + self.at
    }

    #[inline]
    fn face_beyond(&self, side: &Side) -> Option<u32> {
        let along = self.faces.plane(side.beyond).normal.dot(self.axes[2]);
        (along > MIN_ENTRY_COMPONENT).then_some(side.beyond)
    }
}

/// Returns the coordinates of a point along axes.
#[inline]
pub(super) fn coordinates_along(axes: &[DVec3; 3], point: DVec3) -> DVec3 {
    DVec3::from_array(axes.each_ref().map(|axis| axis.dot(point)))
}
