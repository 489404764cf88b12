//! Polygons into triangles.
//!
//! A polygon is looked at along the axis in which its area vector is largest; turns of the projected
//! corners are decided exactly. Ears have an area and no other corner in them or on their rim, so
//! triangles have areas and corners that lie on a side stay corners. A polygon of `k` corners gives
//! `k - 2` triangles over its own corners.

use glam::{DVec2, DVec3, Vec3Swizzles};
use robust::{Coord, orient2d};

/// Triangles over the polygon's corners, as positions in it; `None` if it crosses itself.
pub(super) fn triangulate(corners: &[DVec3]) -> Option<Vec<[usize; 3]>> {
    let flat = project(corners);
    let mut rest: Vec<usize> = (0..corners.len()).collect();
    let mut triangles = Vec::with_capacity(corners.len().saturating_sub(2));
    let mut start = 0;
    while rest.len() > 3 {
        let n = rest.len();
        let ear = (0..n).map(|k| (start + k) % n).find(|&k| is_ear(&flat, &rest, k))?;
        triangles.push([rest[(ear + n - 1) % n], rest[ear], rest[(ear + 1) % n]]);
        rest.remove(ear);
        // The next ear is looked for beyond: fans would have the thinnest triangles.
        start = (ear + 1) % rest.len();
    }
    if turn(flat[rest[0]], flat[rest[1]], flat[rest[2]]) <= 0.0 {
        return None;
    }
    triangles.push([rest[0], rest[1], rest[2]]);
    Some(triangles)
}

/// The corners along the axis in which the area vector is largest, running counter-clockwise.
fn project(corners: &[DVec3]) -> Vec<DVec2> {
    let first = corners[0];
    let area: DVec3 = corners.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum();
    let flat = |p: &DVec3| match area.abs().max_position() {
        0 => p.yz(),
        1 => p.zx(),
        _ => p.xy(),
    };
    let upwards = area[area.abs().max_position()] >= 0.0;
    let turned = |p: DVec2| if upwards { p } else { DVec2::new(-p.x, p.y) };
    corners.iter().map(|p| turned(flat(p))).collect()
}

fn is_ear(flat: &[DVec2], rest: &[usize], k: usize) -> bool {
    let n = rest.len();
    let (i, j, l) = ((k + n - 1) % n, k, (k + 1) % n);
    let [a, b, c] = [i, j, l].map(|m| flat[rest[m]]);
    if turn(a, b, c) <= 0.0 {
        return false;
    }
    let inside = |p: DVec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    (0..n).filter(|m| ![i, j, l].contains(m)).all(|m| {
        let p = flat[rest[m]];
        // A corner passed twice (a slit to a hole) lies on the ear without being in it.
        p == a || p == b || p == c || !inside(p)
    })
}

/// Positive if `a b c` turn to the left; exact in sign.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[DVec3], triangles: &[[usize; 3]]) -> f64 {
        let double = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|k| corners[k]);
            (b - a).cross(c - a).z
        };
        triangles.iter().map(double).sum::<f64>() / 2.0
    }

    #[test]
    fn polygons_that_are_not_convex_keep_their_area() {
        let l: Vec<DVec3> = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 1)]
            .map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), 1.0))
            .to_vec();
        let triangles = triangulate(&l).unwrap();
        assert_eq!(triangles.len(), 5);
        assert_eq!(area(&l, &triangles), 3.0);
        let reversed: Vec<DVec3> = l.iter().rev().copied().collect();
        assert_eq!(area(&reversed, &triangulate(&reversed).unwrap()), -3.0);
    }

    #[test]
    fn a_bow_tie_has_no_triangulation() {
        let tie = [DVec3::ZERO, DVec3::X + DVec3::Y, DVec3::X, DVec3::Y * 2.0];
        assert!(triangulate(&tie).is_none());
    }

    #[test]
    fn a_hole_reached_by_a_slit() {
        let corners: Vec<DVec3> =
            [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1)]
                .map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), 0.0))
                .to_vec();
        let triangles = triangulate(&corners).unwrap();
        assert_eq!(area(&corners, &triangles), 15.0);
    }
}
