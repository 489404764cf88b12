//! Normals of triangles and polygons that stay accurate for slivers and long, narrow faces.

use glam::DVec3;

use super::determinant::accurate_cross;

/// Sine of the angle between two edges below which their plain cross product is not used. Above it,
/// cancellation costs this product less than four bits.
const NEARLY_PARALLEL: f64 = 0.1;

/// Computes twice the area times the unit normal of the counter-clockwise triangle `a b c`.
///
/// If the sine of the angle at `a` is below [`NEARLY_PARALLEL`], the cross product of the two shorter edges is
/// used. If these are nearly parallel, the product is computed without cancellation.
#[inline]
pub fn triangle_normal(corners: [DVec3; 3]) -> DVec3 {
    wide_normal(corners).unwrap_or_else(|| normal_of_sliver(corners))
}

/// Computes twice the area times the unit normal; `None` if the sine of the angle at `a` is below
/// [`NEARLY_PARALLEL`].
#[inline]
fn wide_normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let (u, v) = (b - a, c - a);
    let normal = u.cross(v);
    let size = u.length_squared() * v.length_squared();
    (normal.length_squared() >= NEARLY_PARALLEL * NEARLY_PARALLEL * size).then_some(normal)
}

/// Computes the normal from the two shorter edges, which determine it best. In the cross product of two long,
/// nearly parallel edges, rounding errors would dominate. If the shorter edges are nearly parallel, their product
/// is computed without cancellation.
#[inline]
fn normal_of_sliver([a, b, c]: [DVec3; 3]) -> DVec3 {
    let edges = [b - a, c - b, a - c];
    let lengths = edges.map(DVec3::length_squared);
    let longest = if lengths[0] >= lengths[1] && lengths[0] >= lengths[2] {
        0
    } else if lengths[1] >= lengths[2] {
        1
    } else {
        2
    };
    let (i, j) = ((longest + 1) % 3, (longest + 2) % 3);
    let normal = edges[i].cross(edges[j]);
    let size = lengths[i] * lengths[j];
    if normal.length_squared() < NEARLY_PARALLEL * NEARLY_PARALLEL * size {
        return accurate_cross(edges[i], edges[j]);
    }
    normal
}

/// Computes the unit normal of a convex polygon from three of its corners that are far apart. Returns zero
/// for a polygon without area.
pub fn polygon_normal<I: Iterator<Item = DVec3> + Clone>(mut corners: I) -> DVec3 {
    let all = corners.clone();
    let Some(a) = corners.next() else { return DVec3::ZERO };
    let mut others = corners.clone();
    if let (Some(b), Some(c), None) = (others.next(), others.next(), others.next())
        && let Some(normal) = wide_normal([a, b, c])
    {
        return normal.normalize_or_zero();
    }
    let farthest = |measure: &dyn Fn(DVec3) -> f64| {
        all.clone().enumerate().fold((0, a, 0.0), |best, (k, p)| {
            let value = measure(p);
            if value > best.2 { (k, p, value) } else { best }
        })
    };
    let (i, b, length) = farthest(&|p| p.distance_squared(a));
    let axis = (b - a) / length.sqrt();
    let (j, c, _) = farthest(&|p| (p - a).cross(axis).length_squared());
    let normal = triangle_normal(if i < j { [a, b, c] } else { [a, c, b] });
    normal.normalize_or_zero()
}
