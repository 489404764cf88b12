//! Support points by hill climbing over the edges (Cameron 1997).
//!
//! `d` is the direction and `x_v` the position of vertex `v`. Climbing moves to the neighbour with the largest gain
//! `d . (x_w - x_v)` until no gain is positive. A convex polyhedron is inside the cone of the edges of each vertex,
//! therefore such a vertex is a support point.
//!
//! Rounding: two rounded heights `d . x` differ by about `u |d| |x|` without a true difference. On a short edge this
//! error is a steep slope, which a long body amplifies. The gain of the edge vector has an error of only `4 u sum
//! |d_i| |e_i|`, a slope of a few `u` for any edge length. Therefore the missed height is a few `u |d|` times the
//! width of the body. Climbing requires a gain above this error, so that the true height increases with every step
//! and plateaus cause no cycle.

use colltrans::ConvexPolyhedron;
use glam::DVec3;

/// Rounding error of a gain in units of `sum |d_i| |e_i|`: a subtraction, a product and two sums.
const GAIN_ERROR: f64 = 2.0 * f64::EPSILON;

/// Returns a support vertex of `body` along `direction` (in its own frame), climbing from vertex `from`. Adds the
/// number of vertices whose neighbours were examined to `climbed`.
///
/// The error of a gain is amplified at vertices whose edges almost cancel, inside a longer edge or a larger face up
/// to `64 u` of the size. The hull removes such vertices. If the corners of a larger face deviate as much from a
/// plane, next to short edges, climbing may end too low. The library searches the surroundings there; this
/// implementation does not.
pub(crate) fn climb_to_support(
    body: &ConvexPolyhedron,
    direction: DVec3,
    from: u32,
    climbed: &mut u32,
) -> u32 {
    let vertices = body.vertices();
    let mut at = from;
    loop {
        *climbed += 1;
        let position = vertices[at as usize];
        let (mut next, mut most) = (at, 0.0);
        for &neighbour in body.neighbours(at) {
            let products = direction * (vertices[neighbour as usize] - position);
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

/// Returns the first support vertex of `body` along `direction`, by a scan. Adds the number of vertices to
/// `visited`.
pub(crate) fn scan_for_support(
    body: &ConvexPolyhedron,
    direction: DVec3,
    visited: &mut u32,
) -> u32 {
    let vertices = body.vertices();
    *visited += vertices.len() as u32;
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

    /// Checks whether faces of the family are only nearly flat.
    fn is_uneven(family: &str) -> bool {
        family == "narrow-rings" || NEARLY_FLAT.contains(&family)
    }

    /// Compares with a scan of all vertices, along random directions, the axes and the face normals.
    #[test]
    fn climbing_finds_highest_vertex() {
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
                        let found = climb_to_support(&body, d, from, &mut 0);
                        let height = d.dot(body.vertices()[found as usize]);
                        let missed = highest - height;
                        assert!(missed <= 8.0 * f64::EPSILON * reach, "{setting}: {missed:e}");
                    }
                }
            }
        }
    }
}
