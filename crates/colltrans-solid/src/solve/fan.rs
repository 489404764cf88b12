//! The facets around a vertex.
//!
//! Notation
//! - `v`: the vertex. `u`: the direction of a line through it. A facet of the fan spans the cone of `a - v` and `b -
//!   v`.
//! - `m`: a point inside a facet of the fan, the *target*.
//!
//! A line through `v` that lies in no closed cone of the fan passes an open shell from one side to the other if the
//! half-plane of `u` and `m` cuts an odd number of facets. All signs are exact. If the half-plane passes through an
//! edge, another target replaces this one.

use std::cmp::Ordering;
use std::cmp::Ordering::Equal;

use super::inside::{FacetMean, WEIGHTS};
use super::line::Line;
use super::scene::{PairFrame, PlacedBody, PlacedVertex};
use crate::body::edges::NO_NEIGHBOUR;

/// The facets around a vertex that form a closed ring, each given by its other two corners.
pub(super) struct Fan<'s, 'a> {
    scene: &'s PairFrame<'a>,
    vertex: PlacedVertex,
    around: Vec<[PlacedVertex; 2]>,
}

impl<'s, 'a> Fan<'s, 'a> {
    /// Finds the facets around a corner of a triangle; `None` unless they form a closed ring.
    pub(super) fn new(
        scene: &'s PairFrame<'a>,
        side: &PlacedBody,
        triangle: u32,
        vertex: &PlacedVertex,
    ) -> Option<Self> {
        let solid = side.solid;
        let number = |t: u32| solid.triangles()[t as usize];
        let v = number(triangle).into_iter().find(|&v| side.offset_vertex(v) == vertex.local)?;
        let (mut around, mut t) = (Vec::new(), triangle);
        loop {
            let corners = number(t);
            let k = corners.iter().position(|&w| w == v)?;
            around.push([1, 2].map(|i| side.corner(corners[(k + i) % 3])));
            t = solid.neighbours()[t as usize][k];
            if t == triangle {
                return Some(Self { scene, vertex: *vertex, around });
            }
            if t == NO_NEIGHBOUR || around.len() > solid.triangles().len() {
                return None;
            }
        }
    }

    /// Returns the corners of each facet, beginning with the vertex.
    pub(super) fn facet_corners(&self) -> impl Iterator<Item = [&PlacedVertex; 3]> {
        self.around.iter().map(|[a, b]| [&self.vertex, a, b])
    }

    /// Checks whether a line through the vertex passes from one side of an open shell to the other.
    pub(super) fn is_passed(&self, line: &Line) -> bool {
        if self.around.iter().any(|facet| self.cone_contains(line, facet)) {
            return false;
        }
        // If a fan with very many folds has no target, the vertex blocks.
        self.target_point(line).is_none_or(|target| {
            let is_over = |facet: &&[PlacedVertex; 2]| self.is_over(line, &target, facet);
            self.around.iter().filter(is_over).count() % 2 == 1
        })
    }

    /// Returns a point inside a facet whose half-plane with the direction passes through no edge; `None` if no tried
    /// point qualifies.
    fn target_point(&self, line: &Line) -> Option<FacetMean> {
        let (scene, v) = (self.scene, &self.vertex);
        let is_upright = |[a, b]: &[PlacedVertex; 2]| line.turn(scene, a, b) == Equal;
        self.around.iter().filter(|facet| !is_upright(facet)).find_map(|&[a, b]| {
            WEIGHTS[..3].iter().find_map(|&weights| {
                let target = FacetMean::new(scene, [*v, a, b], weights);
                // An edge opposite to the direction is on no half-plane.
                let on_line =
                    |c: &PlacedVertex| (0..3).all(|k| line.turn_about(scene, k, c) == Equal);
                let passes = |[c, _]: &[PlacedVertex; 2]| {
                    line.turn(scene, &target, c) == Equal && !on_line(c)
                };
                (!self.around.iter().any(passes)).then_some(target)
            })
        })
    }

    /// Checks whether the direction or its opposite lies in the closed cone of a facet.
    fn cone_contains(&self, line: &Line, [a, b]: &[PlacedVertex; 2]) -> bool {
        let (scene, v) = (self.scene, &self.vertex);
        if line.turn(scene, a, b) != Equal {
            return false;
        }
        let area = |axis: &usize| scene.projected_orientation(*axis, v, a, b) != Equal;
        let Some(axis) = (0..3).find(area) else { return false };
        let whole = scene.projected_orientation(axis, v, a, b);
        // The direction's coordinates with respect to `a` and `b`: `det[u, b, e]` and `det[a, u, e]` over `det[a, b,
        // e]`.
        let shares = [line.turn_about(scene, axis, b), line.turn_about(scene, axis, a).reverse()];
        let signed = |way: Ordering| shares.iter().all(|&s| s == Equal || s == way);
        signed(whole) || signed(whole.reverse())
    }

    /// Checks whether the half-plane of the direction and the target cuts a facet.
    fn is_over(&self, line: &Line, target: &FacetMean, [a, b]: &[PlacedVertex; 2]) -> bool {
        let [of_a, of_b] = [a, b].map(|c| line.turn(self.scene, target, c));
        of_a != of_b && of_b == line.turn(self.scene, a, b)
    }
}
