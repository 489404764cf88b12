//! Nearest points of the cores of spheres and capsules: points or segments.
//!
//! `M` is a point, a segment or a parallelogram. Its point nearest to the origin is in closed form, and the lowest of
//! its at most four corners needs no search. The bounds are computed and proven as those of a descent.

use super::gjk::{Goal, unit_vector};
use super::simplex::{Corner, Simplex};
use super::{DescentResult, Difference};
use crate::setting::VertexPair;
use colltrans_kernel::real::RealVector;

impl Difference<'_> {
    /// Checks whether a body is rounded and both cores are points or segments.
    #[inline]
    pub(super) fn is_of_rounded_segments(&self) -> bool {
        let bodies = self.bodies;
        bodies.is_rounded() && bodies.moving.dimension().max(bodies.fixed.dimension()) <= 1
    }

    /// Returns a bound on how far cores that are points, segments or upright boxes reach beyond the lowest of their
    /// corners, and their inputs.
    #[inline]
    pub(super) fn corner_excess(&self) -> f64 {
        let bodies = self.bodies;
        bodies.moving.corner_excess() + bodies.fixed.corner_excess() + bodies.input_excess()
    }
}

/// Computes nearest points and a plane between two cores that are points or segments. `None` if rounding keeps the
/// bounds from reaching `goal`, as for parallel segments of which `M` is a segment.
#[inline(never)]
pub(super) fn nearest_of_segments(difference: &Difference, goal: &Goal) -> Option<DescentResult> {
    let [ends_of_moving, ends_of_fixed] =
        [difference.bodies.moving, difference.bodies.fixed].map(|body| u32::from(body.dimension()));
    let corner =
        |moving: u32, fixed: u32| difference.corner_at(VertexPair::from_indices(moving, fixed));
    let a = corner(0, 0);
    let mut found = DescentResult { supports: 1, ..DescentResult::unbounded() };
    if ends_of_moving + ends_of_fixed == 0 {
        record_simplex(difference, &[a], &Simplex::new(a), &a.at, &mut found);
    } else {
        let b = corner(ends_of_moving, ends_of_fixed);
        let mut edge = Simplex::new(a);
        edge.push(b);
        if ends_of_moving + ends_of_fixed == 1 {
            let nearest = edge.reduce();
            record_simplex(difference, &[a, b], &edge, &nearest, &mut found);
        } else {
            let [c, d] = [corner(1, 0), corner(0, 1)];
            for other in [c, d] {
                let mut triangle = edge;
                triangle.push(other);
                let nearest = triangle.reduce();
                record_simplex(difference, &[a, b, c, d], &triangle, &nearest, &mut found);
            }
        }
    }
    found.excess = Some(difference.corner_excess());
    goal.is_reached(&found).then_some(found)
}

/// Stores the `nearest` point of a reduced simplex, and the plane perpendicular to it at the lowest of all `corners` of
/// `M`.
#[inline]
fn record_simplex<const N: usize>(
    difference: &Difference,
    corners: &[Corner<f64>; N],
    simplex: &Simplex<f64>,
    nearest: &RealVector<f64>,
    found: &mut DescentResult,
) {
    let point = nearest.to_dvec3();
    let distance = point.length();
    if distance >= found.upper {
        return;
    }
    found.record_point(distance, simplex);
    if distance <= difference.noise.point_error() {
        return;
    }
    let Some(normal) = unit_vector(simplex.normal(nearest)).or_else(|| unit_vector(point)) else {
        return;
    };
    let height = |corner: &Corner<f64>| normal.dot(corner.at.to_dvec3());
    let lower = |best, corner| if height(corner) < height(best) { corner } else { best };
    found.record_plane(normal, corners.iter().fold(&corners[0], lower));
}
