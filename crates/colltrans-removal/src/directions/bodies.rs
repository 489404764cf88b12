//! Two placed solids for queries about all directions: for each body its vertices, and a tree of bounds whose
//! leaves are single facets. Coordinates are in the setting frame, which has the axes of the world and its
//! origin at the moving body's translation.

use glam::DVec3;

use super::line::PlaneVertex;
use colltrans_kernel::descent::{node_to_split, pair_with_node};
use colltrans_kernel::integer::{Integer, difference};
use colltrans_solid::body::tree::{self, ANY_ANGLE, Node};
use colltrans_solid::solve::projected::Projected;
use colltrans_solid::solve::scene::{ExactPoint, PairFrame, PlacedBody, PlacedVertex};

/// Bounds of a set of facets of one body, in the setting frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodeBounds {
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// Unit vector near the facet normals, or 0.
    pub(crate) axis: DVec3,
    /// Upper bound on the sine of the angle between a facet normal and `axis`. A value of at least 1 bounds
    /// nothing.
    pub(crate) spread: f64,
    /// Range of the facets' coordinates along `axis`.
    pub(super) slab: [f64; 2],
    /// Index of the first child, and the number of children; 0 for a facet.
    child_range: [u32; 2],
}

impl NodeBounds {
    /// Returns the indices of the children.
    pub(crate) fn children(&self) -> std::ops::Range<u32> {
        self.child_range[0]..self.child_range[0] + self.child_range[1]
    }

    pub(crate) fn is_facet(&self) -> bool {
        self.child_range[1] == 0
    }

    pub(crate) fn squared_diagonal(&self) -> f64 {
        (self.high - self.low).length_squared()
    }
}

/// Two solids, the moving one first.
pub(crate) struct Bodies<'a> {
    /// Scene with direction `z`, so that its query frame is the setting frame.
    pub(super) scene: PairFrame<'a>,
    corners: [Vec<PlacedVertex>; 2],
    pub(crate) nodes: [Vec<NodeBounds>; 2],
    /// Whether the pose of the body only permutes axes and changes signs, so that rotated normals are exact.
    pub(super) permutes: [bool; 2],
}

impl<'a> Bodies<'a> {
    /// Builds the bodies of a scene with direction `z`.
    pub(crate) fn new(scene: PairFrame<'a>) -> Self {
        let sides = [&scene.moving, &scene.fixed];
        let corners = sides.map(|side| {
            let count = side.solid.vertices().len() as u32;
            (0..count).map(|v| side.corner(v)).collect::<Vec<_>>()
        });
        let nodes = [0, 1].map(|k| node_bounds(&scene, sides[k], &corners[k]));
        let permutes = sides.map(|side| side.permutes);
        Self { scene, corners, nodes, permutes }
    }

    /// Returns the two nodes of a pair.
    pub(crate) fn node_pair(&self, pair: [u32; 2]) -> [&NodeBounds; 2] {
        [0, 1].map(|k| &self.nodes[k][pair[k] as usize])
    }

    /// Replaces the larger node of a pair that has children by each of them. Returns `None` for two facets.
    pub(crate) fn child_pairs(
        &self,
        pair: [u32; 2],
    ) -> Option<impl Iterator<Item = [u32; 2]> + use<>> {
        let views = self.node_pair(pair);
        let which =
            node_to_split(views.map(NodeBounds::is_facet), |k| views[k].squared_diagonal())?;
        Some(views[which].children().map(move |part| pair_with_node(pair, which, part)))
    }

    pub(crate) fn placed_vertex(&self, vertex: PlaneVertex) -> &PlacedVertex {
        &self.corners[usize::from(!vertex.moving)][vertex.vertex as usize]
    }

    /// Checks whether a vertex exists.
    pub(super) fn has_vertex(&self, vertex: PlaneVertex) -> bool {
        (vertex.vertex as usize) < self.corners[usize::from(!vertex.moving)].len()
    }

    /// Returns the position of a vertex in exact integers.
    pub(super) fn exact_position<const N: usize>(&self, vertex: PlaneVertex) -> [Integer<N>; 3] {
        let corner = self.placed_vertex(vertex);
        let world = corner.exact_position(&self.scene);
        world.map_or_else(
            || corner.integer_position(&self.scene),
            |at| at.to_array().map(Integer::exact_number),
        )
    }

    /// Returns the displacement from one vertex to another, and a bound on the error of a component.
    pub(super) fn displacement(&self, ends: [PlaneVertex; 2]) -> (DVec3, f64) {
        let [a, b] = ends.map(|vertex| self.placed_vertex(vertex));
        let noise = (f64::from(!a.exact) + f64::from(!b.exact)) * self.scene.noise;
        let way = b.at - a.at;
        (way, noise + f64::EPSILON * way.abs().max_element())
    }

    /// Returns the displacement from one vertex to another in exact integers.
    pub(super) fn exact_displacement<const N: usize>(
        &self,
        ends: [PlaneVertex; 2],
    ) -> [Integer<N>; 3] {
        let [a, b] = ends.map(|vertex| self.exact_position::<N>(vertex));
        difference(&b, &a)
    }

    /// Returns the vertices of a triangle.
    pub(crate) fn triangle_vertices(&self, moving: bool, triangle: u32) -> [PlaneVertex; 3] {
        let solid = self.scene.side(moving).solid;
        solid.triangles()[triangle as usize].map(|vertex| PlaneVertex { moving, vertex })
    }

    /// Returns the number of triangles of a body.
    pub(crate) fn triangle_count(&self, moving: bool) -> u32 {
        self.scene.side(moving).solid.triangles().len() as u32
    }

    /// Returns an upper bound on the absolute value of a coordinate, and a bound on its error.
    pub(crate) fn coordinate_bound(&self) -> [f64; 2] {
        let of = |corner: &PlacedVertex| corner.at.abs().max_element();
        let noise = self.scene.noise;
        let all = self.corners.iter().flatten();
        let off = |corner: &PlacedVertex| if corner.exact { 0.0 } else { noise };
        let most = all.clone().map(off).fold(0.0, f64::max);
        [all.map(of).fold(0.0, f64::max) + most, most]
    }

    /// Returns the index of the triangle of a leaf.
    pub(crate) fn leaf_triangle(&self, moving: bool, leaf: u32) -> u32 {
        leaf - self.scene.side(moving).solid.nodes().len() as u32
    }
}

/// Builds the nodes of the tree, followed by one leaf for each facet.
fn node_bounds(scene: &PairFrame, side: &PlacedBody, corners: &[PlacedVertex]) -> Vec<NodeBounds> {
    let nodes = side.solid.nodes();
    let tree_node = |(at, node): (usize, &Node)| {
        let Projected { bounds, axis, slab, .. } = Projected::new(scene, side, at);
        let child_range = if node.is_leaf() {
            [nodes.len() as u32 + node.first_facet, node.facet_count]
        } else {
            [at as u32 + node.child_offset, 2]
        };
        NodeBounds {
            low: bounds.low,
            high: bounds.high,
            axis,
            spread: normal_spread(side, at),
            slab,
            child_range,
        }
    };
    let facet = |t: &[u32; 3]| facet_bounds(scene.noise, t.map(|v| corners[v as usize]));
    let facets = side.solid.triangles().iter().map(facet);
    nodes.iter().enumerate().map(tree_node).chain(facets).collect()
}

/// Bounds the sine of the angle between facet normals of a node and its axis.
fn normal_spread(side: &PlacedBody, at: usize) -> f64 {
    let own = f64::from(side.solid.nodes()[at].spread);
    let moved = side.shrinking.map_or(0.0, |shrinking| {
        let motion = &shrinking.node_motions[at];
        f64::from(motion.normal_turn_rate) * side.amount + f64::from(motion.rounding_turn)
    });
    // The rotated axis is rounded, the rotated facets are not.
    let rotation_rounding = if side.permutes { 0.0 } else { 16.0 * f64::EPSILON };
    own + moved + side.defect + rotation_rounding
}

fn facet_bounds(noise: f64, corners: [PlacedVertex; 3]) -> NodeBounds {
    let noise = if corners.iter().all(|c| c.exact) { 0.0 } else { noise };
    let [a, b, c] = corners.map(|corner| corner.at);
    let (normal, doubt) = tree::area_vector([a, b, c]);
    let area = normal.length();
    let size = (b - a).length() + (c - a).length();
    let doubt = doubt + 1.01 * (4.0 * noise * size + 8.0 * noise * noise) / area;
    let (axis, spread) = if area > 0.0 && doubt < 1.0 {
        let unit = normal / area;
        let is_axis = unit.abs().max_element() == 1.0 && unit.abs().element_sum() == 1.0;
        (unit, if is_axis { doubt } else { doubt + 4.0 * f64::EPSILON })
    } else {
        (DVec3::ZERO, ANY_ANGLE)
    };
    let heights = [a, b, c].map(|p| axis.dot(p));
    let slack = 2.0 * noise + 4.0 * f64::EPSILON * (a.length() + size);
    let slab = [
        heights.into_iter().fold(f64::INFINITY, f64::min) - slack,
        heights.into_iter().fold(f64::NEG_INFINITY, f64::max) + slack,
    ];
    let (low, high) = (a.min(b).min(c) - noise, a.max(b).max(c) + noise);
    NodeBounds { low, high, axis, spread, slab, child_range: [0, 0] }
}
