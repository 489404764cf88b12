//! A separating plane of two solids in any direction, from all of their vertices, by the algorithm of Gilbert, Johnson
//! and Keerthi.
//!
//! The bounding volume trees of strongly offset bodies are loose. In contrast, a plane between all vertices separates
//! all facets. Convex bodies have such a plane unless they overlap.

use glam::DVec3;

use super::scene::{PairFrame, PlacedBody};
use super::separate::HEIGHTS;
use colltrans_convex::setting::VertexPair;
use colltrans_convex::solve::nearest::simplex::{Corner, Simplex};
use colltrans_kernel::real::RealVector;

/// Maximum number of rounds. Each round ends the search or comes closer; only rounding errors could prolong it.
const MAX_ROUNDS: usize = 64;

/// Finds the normal in the world, from the moving body to the fixed one, of a plane that certainly separates the
/// bodies. `near` is an initial guess. `None` if the search ends without such a plane.
pub(crate) fn separating_normal(scene: &PairFrame, near: Option<DVec3>) -> Option<DVec3> {
    let middle = |side: &PlacedBody| side.matrix * side.solid.bounds().center() + side.offset[0];
    let apart = || (middle(&scene.fixed) - middle(&scene.moving)).try_normalize();
    let mut normal = near.or_else(apart)?;
    let mut simplex: Option<Simplex<f64>> = None;
    for _ in 0..MAX_ROUNDS {
        let [(p, from), (q, to)] =
            [farthest_vertex(&scene.moving, normal), farthest_vertex(&scene.fixed, -normal)];
        let lowest = to - from;
        if normal.dot(lowest) > HEIGHTS * scene.noise {
            return Some(normal);
        }
        let corner =
            Corner { at: RealVector(lowest.to_array()), pair: VertexPair::from_indices(p, q) };
        let simplex = match &mut simplex {
            Some(simplex) => {
                simplex.push(corner);
                simplex
            }
            none => none.insert(Simplex::new(corner)),
        };
        let nearest = simplex.reduce();
        if simplex.is_full() {
            return None;
        }
        normal = simplex.normal(&nearest).try_normalize()?;
    }
    None
}

/// Returns the vertex of a body that is farthest along a normal, and its position in the setting frame.
fn farthest_vertex(side: &PlacedBody, normal: DVec3) -> (u32, DVec3) {
    let local = side.matrix.transpose() * normal;
    let mut best = (0, f64::NEG_INFINITY);
    for v in 0..side.solid.vertices().len() as u32 {
        let height = local.dot(side.offset_vertex(v));
        if height > best.1 {
            best = (v, height);
        }
    }
    (best.0, side.matrix * side.offset_vertex(best.0) + side.offset[0])
}
