//! Nearest points of the cores of spheres and capsules: points or segments.
//!
//! `M` is a point, a segment or a parallelogram. Its point nearest to the origin is in closed form, and the lowest of
//! its at most four corners needs no search. The bounds are computed and proven as those of a descent.

use super::gjk::{Goal, unit_vector};
use super::simplex::{Corner, Simplex};
use super::{DescentResult, Difference};
use crate::setting::VertexPair;

impl Difference<'_> {
    /// Checks whether a body is rounded and both cores are points or segments.
    #[inline]
    pub(super) fn is_of_rounded_segments(&self) -> bool {
        let bodies = self.bodies;
        bodies.is_rounded() && bodies.moving.dimension().max(bodies.fixed.dimension()) <= 1
    }
}

/// Computes nearest points and a plane between two cores that are points or segments. `None` if rounding keeps the
/// bounds from reaching `goal`.
pub(super) fn nearest_of_segments(difference: &Difference, goal: &Goal) -> Option<DescentResult> {
    let [ends_of_moving, ends_of_fixed] =
        [difference.bodies.moving, difference.bodies.fixed].map(|body| u32::from(body.dimension()));
    let corner = |moving: u32, fixed: u32| {
        let pair = VertexPair::from_indices(moving.min(ends_of_moving), fixed.min(ends_of_fixed));
        difference.corner_at(pair)
    };
    let [a, b] = [corner(0, 0), corner(1, 1)];
    let mut found = DescentResult { supports: 1, ..DescentResult::unbounded() };
    if ends_of_moving + ends_of_fixed < 2 {
        let others = (ends_of_moving + ends_of_fixed == 1).then_some(b);
        try_simplex(difference, &[a, b], [a].into_iter().chain(others), &mut found);
    } else {
        let [c, d] = [corner(1, 0), corner(0, 1)];
        for other in [c, d] {
            try_simplex(difference, &[a, b, c, d], [a, b, other].into_iter(), &mut found);
        }
    }
    found.verify_plane(difference);
    goal.is_reached(&found).then_some(found)
}

/// Stores the nearest point of a simplex, and the plane perpendicular to it at the lowest of all `corners` of `M`.
#[inline]
fn try_simplex(
    difference: &Difference,
    corners: &[Corner<f64>],
    of_simplex: impl Iterator<Item = Corner<f64>>,
    found: &mut DescentResult,
) {
    let Some(mut simplex) = Simplex::from_corners(of_simplex) else { return };
    let nearest = simplex.reduce();
    let point = nearest.to_dvec3();
    let distance = point.length();
    if distance >= found.upper {
        return;
    }
    found.record_point(distance, &simplex);
    if distance <= difference.noise.point_error() {
        return;
    }
    let Some(normal) = unit_vector(simplex.normal(&nearest)).or_else(|| unit_vector(point)) else {
        return;
    };
    let height = |corner: &Corner<f64>| normal.dot(corner.at.to_dvec3());
    if let Some(lowest) = corners.iter().min_by(|a, b| height(a).total_cmp(&height(b))) {
        found.record_plane(normal, lowest);
    }
}
