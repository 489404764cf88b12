//! Bounds of the distance of a point from a point or an upright box, such as the cores of spheres and boxes, in closed
//! form, without the points and vertices that prove them.
//!
//! The *box* has the matrix `R`. The point is at `x`, in the axes of the world and relative to the origin of the box's
//! frame. In that frame it is about `y = R^T x`, and `c` is the point of the box nearest to `y`, coordinate by
//! coordinate.
//!
//! - *Upper*: `|R c - x|`. Clamping does not round, so `c` is a point of the box.
//! - *Lower*: the height of the box along `n = R (c - y)`, scaled to length 1, above `x`. A coordinate of `c - y` is
//!   exactly 0 if `c` and `y` agree in it, so `n` is as perpendicular to faces and edges of the box as the columns of
//!   its matrix. The lowest corner is chosen by the signs of `R^T n`. Wrong signs, each of a coordinate below `3 u`, raise
//!   the corner by at most `3 u` times the sum of the sides. This is at most `6 sqrt(3) u` reaches of the box, less than
//!   [`ConvexPolyhedron::corner_excess`].
//!
//! Both carry the margins of other points and planes (`docs/theory/rounding.md`).

use glam::{DMat3, DVec3};

use super::Difference;
use super::gjk::unit_vector;
use crate::body::{Aabb, ConvexPolyhedron};
use crate::setting::VertexPair;

impl Difference<'_> {
    /// Returns bounds of the distance of the cores, `[lower, upper]`. `None` if neither is a point, if the other is
    /// neither a point nor an upright box, or if rounding hides the bounds.
    #[inline]
    pub(crate) fn point_bounds(&self) -> Option<[f64; 2]> {
        let bodies = self.bodies;
        let (moving, fixed) = (bodies.moving, bodies.fixed);
        let [p, q] = bodies.vertices(VertexPair::default());
        let [lower, upper] = match [moving, fixed].map(|body| body.dimension() == 0) {
            [true, true] => [self.point(VertexPair::default()).length(); 2],
            [true, false] if fixed.is_upright_box() => {
                from_box(fixed, &bodies.fixed_matrix, bodies.moving_matrix * p - bodies.offset)?
            }
            [false, true] if moving.is_upright_box() => {
                from_box(moving, &bodies.moving_matrix, bodies.fixed_matrix * q + bodies.offset)?
            }
            _ => return None,
        };
        let error = self.noise.lower_bound_margin() + self.corner_excess();
        let proven_lower = (lower - error).next_down();
        let proven_upper = (upper + self.noise.mean_length_margin()).next_up();
        let is_sharp = upper - lower <= self.noise.point_error();
        (proven_lower > 0.0 && is_sharp).then_some([proven_lower, proven_upper])
    }
}

/// Returns computed bounds of the distance of a box with this matrix from the point `x`. `None` if the point is in the
/// box.
#[inline]
fn from_box(upright: &ConvexPolyhedron, matrix: &DMat3, x: DVec3) -> Option<[f64; 2]> {
    let Aabb { low, high } = Aabb::from_points(upright.vertices().iter().copied());
    let y = matrix.transpose() * x;
    let c = y.clamp(low, high);
    let normal = unit_vector(*matrix * (c - y))?;
    let in_box = matrix.transpose() * normal;
    let lowest = DVec3::select(in_box.cmpgt(DVec3::ZERO), low, high);
    Some([normal.dot(*matrix * lowest - x), (*matrix * c - x).length()])
}
