//! Support points by hill climbing over the edges (Cameron 1997).
//!
//! Notation. `d` is the direction, `x_v` the position of vertex `v`; climbing goes from a vertex to
//! the neighbour with the largest gain `d . (x_w - x_v)` as long as there is one.
//!
//! On a convex polyhedron a vertex without a better neighbour is a farthest one: all the body lies
//! in the cone of its edges. What that leaves when rounded depends on what is compared. Two
//! rounded heights `d . x` differ by some `u |d| |x|` for nothing, which over a short edge is a
//! steep slope that a long way then multiplies. The gain of the edge vector errs by `4 u sum |d_i|
//! |e_i|` only, a slope of some `u` however short the edge is, and the height missed at the end is
//! some `u |d|` times the width of the body. Only a neighbour that gains more than that error is
//! climbed to; so the true height increases with every step, and no plateau is walked in circles.
//!
//! Amplified is that error only at a vertex whose edges almost cancel each other, in the middle of
//! what is almost a longer edge or a larger face: less than `64 u` of the size off it, and the hull
//! would not have kept it. But where the corners of a larger face are themselves that far off a plane,
//! next to edges as short, a climb may stick lower: the library looks around where it ends, this does not.

use colltrans::ConvexPolyhedron;
use glam::DVec3;

/// Rounding error of a gain in units of `sum |d_i| |e_i|`: subtraction, product and two sums.
const GAIN_ERROR: f64 = 2.0 * f64::EPSILON;

/// A vertex of `body` farthest along `direction` (its own frame), climbing up from vertex `from`;
/// `climbed` counts the vertices whose neighbours were looked at.
pub(crate) fn climb(
    body: &ConvexPolyhedron,
    direction: DVec3,
    from: u32,
    climbed: &mut u32,
) -> u32 {
    let vertices = body.vertices();
    let mut at = from;
    loop {
        *climbed += 1;
        let here = vertices[at as usize];
        let (mut next, mut most) = (at, 0.0);
        for &neighbour in body.neighbours(at) {
            let products = direction * (vertices[neighbour as usize] - here);
            let gain = products.element_sum();
            if gain > most && gain > GAIN_ERROR * products.abs().element_sum() {
                (next, most) = (neighbour, gain);
            }
        }
        if next == at {
            return at;
        }
        at = next;
    }
}

/// A vertex of `body` farthest along `direction`, the first of several; `looked_at` counts all.
pub(crate) fn scan(body: &ConvexPolyhedron, direction: DVec3, looked_at: &mut u32) -> u32 {
    let vertices = body.vertices();
    *looked_at += vertices.len() as u32;
    let (mut best, mut highest) = (0, f64::NEG_INFINITY);
    for (vertex, at) in (0..).zip(vertices) {
        let height = direction.dot(*at);
        if height > highest {
            (best, highest) = (vertex, height);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans_testkit::oracle::settings::{FAMILIES, NEARLY_FLAT, setting};
    use colltrans_testkit::random::Random;

    /// Whether faces are flat only nearly.
    fn is_uneven(family: &str) -> bool {
        family == "narrow-rings" || NEARLY_FLAT.contains(&family)
    }

    /// Against a scan of all vertices, along random directions, the axes and the face normals.
    #[test]
    fn no_vertex_is_farther() {
        for (family, _) in FAMILIES.iter().filter(|family| !is_uneven(family.0)) {
            for seed in 0..20 {
                let setting = setting(family, seed);
                let body = setting.bodies().unwrap().fixed;
                let mut rng = Random::new(seed);
                let normals = (0..body.face_count() as u32).map(|f| body.face_normal(f));
                let random = (0..20).map(|_| rng.direction());
                for d in normals.chain(random).chain(DVec3::AXES).collect::<Vec<_>>() {
                    let heights = body.vertices().iter().map(|v| d.dot(*v));
                    let highest = heights.fold(f64::NEG_INFINITY, f64::max);
                    let reach = body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max);
                    for from in 0..body.vertices().len() as u32 {
                        let found = climb(&body, d, from, &mut 0);
                        let height = d.dot(body.vertices()[found as usize]);
                        let missed = highest - height;
                        assert!(missed <= 8.0 * f64::EPSILON * reach, "{setting}: {missed:e}");
                    }
                }
            }
        }
    }
}
