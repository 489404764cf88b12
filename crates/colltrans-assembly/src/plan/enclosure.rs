//! Proof that a closed surface of one part encloses another part, so that no motion separates them.
//!
//! The winding number of a closed surface is constant along a path that does not cross the surface, and 0 far away. If
//! it is not 0 at a vertex of another part, this vertex stays enclosed in all motions in which the surfaces of both
//! parts do not cross: translations and turns, also of several parts at the same time. Surfaces are closed shells, each
//! edge of which belongs to as many half-edges in either direction. The vertex is off the surface by more than rounding
//! errors. A wall thinner than the tolerance is inside out in the body of a plan, and proves nothing.

use petgraph::unionfind::UnionFind;

use crate::bodies::Bodies;

/// Maximum number of vertices of a part that are tried.
const MAX_VERTICES: usize = 16;
/// Minimum distance of the vertex from the surface, as a share of the largest coordinate.
const MARGIN: f64 = 1e-9;

/// Checks whether no motion separates any of these parts from the others: each is connected with all others by pairs of
/// parts of which one encloses the other.
pub(super) fn are_enclosed(bodies: &Bodies, parts: &[usize]) -> bool {
    let mut sets = UnionFind::new(bodies.len());
    for &inner in parts {
        for &outer in parts.iter().filter(|outer| **outer != inner) {
            if !sets.equiv(inner, outer) && is_enclosed_by(bodies, inner, outer) {
                sets.union(inner, outer);
            }
        }
    }
    parts.iter().all(|&part| sets.equiv(part, parts[0]))
}

/// Checks whether a closed surface of the part `outer` encloses the part `inner`, with the bodies of the pair.
fn is_enclosed_by(bodies: &Bodies, inner: usize, outer: usize) -> bool {
    let [inner_solid, outer_solid] = bodies.pair_solids([inner, outer]);
    let bounds = outer_solid.bounds();
    // The exact test for overlaps comes last.
    if !bounds.contains_box(&inner_solid.bounds())
        || !inner_solid.is_closed()
        || bodies.has_inverted_facets([inner, outer])
        || !bodies.blocks_plainly([inner, outer])
    {
        return false;
    }
    let far = bounds.low.abs().max(bounds.high.abs()).max_element();
    let corners = inner_solid.triangles().iter().take(MAX_VERTICES).map(|t| t[0]);
    outer_solid.encloses_any(corners.map(|v| inner_solid.vertices()[v as usize]), MARGIN * far)
}
