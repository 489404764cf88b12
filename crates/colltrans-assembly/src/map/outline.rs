//! Outlines of convex polygons, arcs and cells of directions on the plane of a map.
//!
//! Sides are arcs of great circles, drawn in short steps. Polygons are split along the meridian at which the map
//! ends, so that each half lies on one side of it.

use glam::{DVec2, DVec3};

use super::draw::map_position;

/// Maximum step along a side, in radians.
const STEP: f64 = 0.03;

/// Returns the outlines of a convex polygon on the map, given its corners in order.
pub(super) fn polygon_outlines(corners: &[DVec3]) -> Vec<Vec<DVec2>> {
    [1.0, -1.0].into_iter().filter_map(|sign| half_outline(corners, sign)).collect()
}

/// Returns the outline of the part of a polygon where `y` has the given sign, or `None` if it has no area.
fn half_outline(corners: &[DVec3], sign: f64) -> Option<Vec<DVec2>> {
    let mut kept: Vec<DVec3> = Vec::new();
    for (k, &a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        if a.y * sign >= 0.0 {
            kept.push(a);
        }
        if (a.y > 0.0 && b.y < 0.0) || (a.y < 0.0 && b.y > 0.0) {
            kept.push(a + (b - a) * (a.y / (a.y - b.y)));
        }
    }
    if kept.len() < 3 || kept.iter().all(|d| d.y == 0.0) {
        return None;
    }
    let sides = (0..kept.len()).flat_map(|k| arc_steps(kept[k], kept[(k + 1) % kept.len()]));
    Some(sides.map(|d| map_position(clamp_to_side(d, sign))).collect())
}

/// Returns the direction with its `y` clamped to the given sign.
fn clamp_to_side(d: DVec3, sign: f64) -> DVec3 {
    DVec3::new(d.x, (d.y * sign).max(0.0) * sign, d.z)
}

/// Returns directions of length 1 along an arc, without its end.
fn arc_steps(a: DVec3, b: DVec3) -> Vec<DVec3> {
    let count = (a.angle_between(b) / STEP).ceil().max(1.0) as usize;
    (0..count).map(|k| (a + (b - a) * (k as f64 / count as f64)).normalize()).collect()
}

/// Returns an arc on the map, in pieces that do not cross the meridian at which the map ends.
pub(super) fn arc_lines(a: DVec3, b: DVec3) -> Vec<Vec<DVec2>> {
    let mut parts = vec![Vec::new()];
    let mut last: Option<DVec2> = None;
    for at in arc_steps(a, b).into_iter().chain([b.normalize()]).map(map_position) {
        if last.is_some_and(|last| last.distance(at) > 1.0) {
            parts.push(Vec::new());
        }
        if let Some(part) = parts.last_mut() {
            part.push(at);
        }
        last = Some(at);
    }
    parts
}

/// Checks whether a point is inside an outline.
pub(super) fn is_inside(outline: &[DVec2], at: DVec2) -> bool {
    let mut inside = false;
    for (k, p) in outline.iter().enumerate() {
        let q = outline[(k + 1) % outline.len()];
        if (p.y > at.y) != (q.y > at.y) && at.x < p.x + (q.x - p.x) * (at.y - p.y) / (q.y - p.y) {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the area of an outline.
    fn outline_area(outline: &[DVec2]) -> f64 {
        let turn = |k: usize| outline[k].perp_dot(outline[(k + 1) % outline.len()]);
        ((0..outline.len()).map(turn).sum::<f64>() / 2.0).abs()
    }

    #[test]
    fn outlines_of_cube_faces_cover_the_map() {
        // The map is an ellipse of semi-axes 2 and 1, and preserves areas.
        let mut whole = 0.0;
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[u, v]| {
                    let mut d = DVec3::ZERO;
                    (d[axis], d[(axis + 1) % 3], d[(axis + 2) % 3]) = (sign, u, v);
                    d
                });
                let side: f64 =
                    polygon_outlines(&corners).iter().map(|outline| outline_area(outline)).sum();
                assert!((side - std::f64::consts::PI / 3.0).abs() < 0.01, "{axis} {sign}: {side}");
                whole += side;
                let middle = map_position(corners[0].midpoint(corners[2]).normalize());
                let holds = |outline: &Vec<DVec2>| is_inside(outline, middle - DVec2::splat(1e-3));
                assert!(axis != 0 || sign < 0.0 || polygon_outlines(&corners).iter().any(holds));
            }
        }
        assert!((whole - 2.0 * std::f64::consts::PI).abs() < 0.02, "{whole}");
    }

    #[test]
    fn arc_across_the_map_boundary_is_split() {
        let (a, b) = (DVec3::new(-1.0, 0.5, 0.3), DVec3::new(-1.0, -0.5, 0.3));
        assert_eq!(arc_lines(a, b).len(), 2);
        assert_eq!(arc_lines(DVec3::X, DVec3::Y).len(), 1);
    }
}
