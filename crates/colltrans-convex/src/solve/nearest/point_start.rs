//! Start of a descent for a point and a polytope, such as the cores of a sphere and a box.
//!
//! `y` is the point in the frame of the polytope. The start is a vertex `v` near `y`, with the ends of at most two edges
//! that leave `v` towards `y`: those along which the distance falls most. If `v` is the vertex of a box that is nearest
//! to `y`, these span the feature nearest to `y`, and the nearest point is in their simplex, because `v` is nearer to `y`
//! than the opposite corners of its faces. Elsewhere the descent replaces corners as from any start.

use glam::DVec3;

use super::Difference;
use super::simplex::{Corner, Simplex};
use crate::body::{ConvexPolyhedron, MAX_SCANNED_NEIGHBOURS};
use crate::setting::VertexPair;

/// Maximum number of edges to a nearer vertex that are followed.
const MAX_STEPS: usize = 8;

/// Returns the start for rounded bodies, if a core is a point.
#[inline]
pub(super) fn starting_simplex(difference: &Difference) -> Option<Simplex<f64>> {
    let bodies = difference.bodies;
    let has_point = bodies.moving.dimension().min(bodies.fixed.dimension()) == 0;
    (has_point && bodies.is_rounded()).then(|| simplex_near_point(difference))
}

/// Returns the simplex for bodies of which one is a point.
#[inline(never)]
fn simplex_near_point(difference: &Difference) -> Simplex<f64> {
    let bodies = difference.bodies;
    let [p, q] = bodies.vertices(VertexPair::default());
    if bodies.moving.dimension() == 0 {
        let point = bodies.fixed_normal(bodies.moving_matrix * p - bodies.offset);
        let corner = |vertex| difference.corner_at(VertexPair::from_indices(0, vertex));
        simplex_towards(bodies.fixed, point, corner)
    } else {
        let point = bodies.moving_normal(bodies.fixed_matrix * q + bodies.offset);
        let corner = |vertex| difference.corner_at(VertexPair::from_indices(vertex, 0));
        simplex_towards(bodies.moving, point, corner)
    }
}

/// Returns the simplex of a vertex near a point and of up to two edges towards the point.
#[inline]
fn simplex_towards(
    polytope: &ConvexPolyhedron,
    point: DVec3,
    corner: impl Fn(u32) -> Corner<f64>,
) -> Simplex<f64> {
    let vertices = polytope.vertices();
    let mut from = polytope.vertex_near(point);
    // Squares of the lengths by which two edges lead towards the point, and their ends.
    let mut best = [(0.0, from); 2];
    for _ in 0..MAX_STEPS {
        let neighbours = polytope.neighbours(from);
        if neighbours.len() > MAX_SCANNED_NEIGHBOURS {
            break;
        }
        let way = point - vertices[from as usize];
        let mut nearer = (0.0, from);
        for &end in neighbours {
            let edge = vertices[end as usize] - vertices[from as usize];
            let (along, square) = (edge.dot(way), edge.length_squared());
            if along <= 0.0 {
                continue;
            }
            if 2.0 * along - square > nearer.0 {
                nearer = (2.0 * along - square, end);
            }
            let gain = along * along / square;
            if gain > best[1].0 {
                best[1] = (gain, end);
                if gain > best[0].0 {
                    best.swap(0, 1);
                }
            }
        }
        if nearer.1 == from {
            break;
        }
        from = nearer.1;
        best = [(0.0, from); 2];
    }
    let mut simplex = Simplex::new(corner(from));
    for (_, end) in best.into_iter().filter(|(gain, _)| *gain > 0.0) {
        simplex.push(corner(end));
    }
    simplex
}
