//! Exact signs of determinants in the frame of one body, from its given coordinates.

use std::cmp::Ordering;

use glam::{DVec2, DVec3, Vec3Swizzles};

pub(crate) use colltrans_kernel::predicates::sign_of;
use colltrans_kernel::predicates::{orient2d, orient3d};

/// Projects a point along an axis, preserving counter-clockwise order.
pub(super) fn drop_axis(p: DVec3, axis: usize) -> DVec2 {
    match axis {
        0 => p.yz(),
        1 => p.zx(),
        _ => p.xy(),
    }
}

/// Returns the sign of `det[b - a, c - a, e]`, where `e` is the unit vector of an axis.
pub(crate) fn sign_along_axis(a: DVec3, b: DVec3, c: DVec3, axis: usize) -> Ordering {
    let [a, b, c] = [a, b, c].map(|p| drop_axis(p, axis));
    sign_of(orient2d(a, b, c))
}

/// Returns the sign of `det[b - a, c - a, e - a]`.
pub(crate) fn sign_of_side(a: DVec3, b: DVec3, c: DVec3, e: DVec3) -> Ordering {
    sign_of(orient3d(a, b, c, e))
}

/// Checks whether three points lie on one line.
pub(super) fn are_collinear(a: DVec3, b: DVec3, c: DVec3) -> bool {
    (0..3).all(|axis| sign_along_axis(a, b, c, axis) == Ordering::Equal)
}

/// Checks whether `m`, a point on the line through `p` and `q`, lies strictly between them.
pub(super) fn is_strictly_between(p: DVec3, q: DVec3, m: DVec3) -> bool {
    let axis = (q - p).abs().max_position();
    let (p, q, m) = (p[axis], q[axis], m[axis]);
    (p < m && m < q) || (q < m && m < p)
}
