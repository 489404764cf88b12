//! A body as convex pieces: itself, or the boxes of the tree of a solid and its facets.
//!
//! - Piece 0 is the whole body.
//! - The pieces of a solid are its tree nodes, each with the box of its facets, and then its facets. Boxes are slightly
//!   enlarged, so that rounding leaves no point outside. They have the radius of the solid.
//! - Points that the hull of a piece excludes by rounding are within its `hull_error`, which counts as a position
//!   error.

use std::sync::OnceLock;

use glam::DVec3;

use colltrans_convex::body::{Aabb, ConvexPolyhedron, Pose};
use colltrans_solid::body::Solid;
use colltrans_solid::kinds::{AnyPlaced, ByKind};

/// Relative enlargement of a box.
const BOX_ENLARGEMENT: f64 = 1e-9;

/// A placed body and its pieces, which are built on first use.
#[derive(Debug)]
pub(super) struct Shape<'a> {
    pub(super) placed: AnyPlaced<'a>,
    built_pieces: Vec<OnceLock<ConvexPolyhedron>>,
}

impl<'a> Shape<'a> {
    /// Prepares the pieces of a placed body.
    pub(super) fn new(placed: AnyPlaced<'a>) -> Self {
        let count = match placed {
            ByKind::Convex(_) => 0,
            ByKind::Solid(solid) => solid.body.nodes().len() + solid.body.triangles().len(),
        };
        Self { placed, built_pieces: (0..count).map(|_| OnceLock::new()).collect() }
    }

    /// Returns the pose in the frame of the body's link.
    pub(super) fn pose(&self) -> Pose {
        self.placed.pose()
    }

    /// Returns points whose hull is or contains the body.
    pub(super) fn corners(&self) -> &'a [DVec3] {
        match self.placed {
            ByKind::Convex(placed) => placed.body.vertices(),
            ByKind::Solid(placed) => placed.body.vertices(),
        }
    }

    /// Returns the number of pieces.
    pub(super) fn piece_count(&self) -> usize {
        self.built_pieces.len().max(1)
    }

    /// Returns a piece by its number.
    pub(super) fn piece(&self, number: usize) -> &ConvexPolyhedron {
        match self.placed {
            ByKind::Convex(placed) => placed.body,
            ByKind::Solid(placed) => {
                self.built_pieces[number].get_or_init(|| build_piece(placed.body, number))
            }
        }
    }

    /// Returns the solid, or `None` for a convex body.
    pub(super) fn solid(&self) -> Option<&'a Solid> {
        match self.placed {
            ByKind::Convex(_) => None,
            ByKind::Solid(placed) => Some(placed.body),
        }
    }

    /// Returns the index and the corners of the facet of a piece. Returns `None` if the piece is not a facet.
    pub(super) fn facet(&self, number: usize) -> Option<(u32, [DVec3; 3])> {
        let solid = self.solid()?;
        let facet = number.checked_sub(solid.nodes().len())?;
        Some((facet as u32, facet_corners(solid, facet)))
    }

    /// Returns the number of the piece of a facet.
    pub(super) fn facet_piece(&self, facet: u32) -> usize {
        self.solid().map_or(0, |solid| solid.nodes().len() + facet as usize)
    }

    /// Returns the pieces that form a piece. The list is empty for a facet or a convex body.
    pub(super) fn sub_pieces(&self, number: usize) -> Vec<usize> {
        let ByKind::Solid(placed) = self.placed else { return Vec::new() };
        let nodes = placed.body.nodes();
        match nodes.get(number) {
            None => Vec::new(),
            Some(node) if node.is_leaf() => node.facets().map(|f| nodes.len() + f).collect(),
            Some(node) => {
                let first = number + node.child_offset as usize;
                vec![first, first + 1]
            }
        }
    }
}

/// Builds a piece of a solid: a box or a facet, with the radius of the solid.
fn build_piece(solid: &Solid, number: usize) -> ConvexPolyhedron {
    build_core(solid, number).rounded(solid.radius()).expect("the radius of a solid")
}

/// Builds a box or a facet of a solid, without its radius.
fn build_core(solid: &Solid, number: usize) -> ConvexPolyhedron {
    let nodes = solid.nodes();
    if let Some(node) = nodes.get(number) {
        let Aabb { low, high } = node.bounds;
        let size = low.abs().max(high.abs()).max_element();
        let by = DVec3::splat(size * BOX_ENLARGEMENT);
        return ConvexPolyhedron::cuboid(low - by, high + by).expect("a box that is wide");
    }
    ConvexPolyhedron::from_points(&facet_corners(solid, number - nodes.len()))
        .expect("the corners of a facet")
}

/// Returns the corners of a facet.
fn facet_corners(solid: &Solid, facet: usize) -> [DVec3; 3] {
    solid.triangles()[facet].map(|v| solid.vertices()[v as usize])
}
