//! Planes through points: normals that stay accurate for slivers and long, narrow faces.

use glam::DVec3;

/// Twice the area times the unit normal of the counter-clockwise triangle `a b c`.
///
/// From its two shorter edges: the product of two long, nearly parallel edges would lose the normal to rounding.
pub(crate) fn triangle_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    let edges = [b - a, c - b, a - c];
    let lengths = edges.map(DVec3::length_squared);
    if lengths[0] >= lengths[1] && lengths[0] >= lengths[2] {
        edges[1].cross(edges[2])
    } else if lengths[1] >= lengths[2] {
        edges[2].cross(edges[0])
    } else {
        edges[0].cross(edges[1])
    }
}

/// Unit normal of a convex polygon, from a triangle of its corners that spans it widely; zero if it has no area.
pub(crate) fn polygon_normal<I: Iterator<Item = DVec3> + Clone>(mut corners: I) -> DVec3 {
    let all = corners.clone();
    let Some(a) = corners.next() else { return DVec3::ZERO };
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
