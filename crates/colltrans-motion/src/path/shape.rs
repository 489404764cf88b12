//! A body as pieces that are convex: itself, or the boxes of a solid's tree and its facets.
//!
//! Piece 0 is all of it. Pieces of a solid are numbered as the nodes of its tree, each with the box of its facets,
//! and then the facets; boxes are a little larger than they are, so that rounding leaves nothing outside. Points
//! of a piece that a hull leaves out by rounding are within its `hull_error`, which counts as an error of its place.

use std::sync::OnceLock;

use glam::DVec3;

use colltrans_convex::body::{Aabb, ConvexPolyhedron, Pose};
use colltrans_solid::body::Solid;
use colltrans_solid::kinds::{AnyPlaced, ByKind};

/// By which share of its size a box is made larger.
const LARGER: f64 = 1e-9;

/// A placed body and its pieces, made when they are first asked for.
#[derive(Debug)]
pub(super) struct Shape<'a> {
    pub(super) placed: AnyPlaced<'a>,
    made: Vec<OnceLock<ConvexPolyhedron>>,
}

impl<'a> Shape<'a> {
    pub(super) fn new(placed: AnyPlaced<'a>) -> Self {
        let count = match placed {
            ByKind::Convex(_) => 0,
            ByKind::Solid(solid) => solid.body.nodes().len() + solid.body.triangles().len(),
        };
        Self { placed, made: (0..count).map(|_| OnceLock::new()).collect() }
    }

    pub(super) fn pose(&self) -> Pose {
        self.placed.pose()
    }

    /// The points that it is the hull of, or lies within the hull of.
    pub(super) fn corners(&self) -> &'a [DVec3] {
        match self.placed {
            ByKind::Convex(placed) => placed.body.vertices(),
            ByKind::Solid(placed) => placed.body.vertices(),
        }
    }

    /// How many pieces there are.
    pub(super) fn count(&self) -> usize {
        self.made.len().max(1)
    }

    /// A piece, by its number.
    pub(super) fn piece(&self, number: usize) -> &ConvexPolyhedron {
        match self.placed {
            ByKind::Convex(placed) => placed.body,
            ByKind::Solid(placed) => {
                self.made[number].get_or_init(|| piece_of(placed.body, number))
            }
        }
    }

    /// The solid that it is.
    pub(super) fn solid(&self) -> Option<&'a Solid> {
        match self.placed {
            ByKind::Convex(_) => None,
            ByKind::Solid(placed) => Some(placed.body),
        }
    }

    /// The facet that a piece is, and its corners.
    pub(super) fn facet(&self, number: usize) -> Option<(u32, [DVec3; 3])> {
        let solid = self.solid()?;
        let facet = number.checked_sub(solid.nodes().len())?;
        Some((facet as u32, corners_of(solid, facet)))
    }

    /// The piece that a facet of its solid is.
    pub(super) fn piece_of(&self, facet: u32) -> usize {
        self.solid().map_or(0, |solid| solid.nodes().len() + facet as usize)
    }

    /// The pieces that a piece is made of; none, if it is itself one of the body's.
    pub(super) fn parts(&self, number: usize) -> Vec<usize> {
        let ByKind::Solid(placed) = self.placed else { return Vec::new() };
        let nodes = placed.body.nodes();
        match nodes.get(number) {
            None => Vec::new(),
            Some(node) if node.is_leaf() => node.facets().map(|f| nodes.len() + f).collect(),
            Some(node) => {
                let first = number + node.skip as usize;
                vec![first, first + 1]
            }
        }
    }
}

fn piece_of(solid: &Solid, number: usize) -> ConvexPolyhedron {
    let nodes = solid.nodes();
    if let Some(node) = nodes.get(number) {
        let Aabb { low, high } = node.bounds;
        let size = low.abs().max(high.abs()).max_element();
        let by = DVec3::splat(size * LARGER);
        return ConvexPolyhedron::cuboid(low - by, high + by).expect("a box that is wide");
    }
    ConvexPolyhedron::from_points(&corners_of(solid, number - nodes.len()))
        .expect("the corners of a facet")
}

fn corners_of(solid: &Solid, facet: usize) -> [DVec3; 3] {
    solid.triangles()[facet].map(|v| solid.vertices()[v as usize])
}
