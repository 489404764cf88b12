//! Tests that dismiss pairs of nodes whose facets cannot pass through each other.

use glam::DVec3;

use super::PlacedFacets;
use crate::body::edges::NO_NEIGHBOUR;
use crate::body::tree::{self, Node};
use colltrans_convex::body::Aabb;
use colltrans_kernel::visit_counter;

/// Maximum distance of facets from their common plane, in multiples of the reach of the body.
const PLANE_TOLERANCE: f64 = 64.0 * f64::EPSILON;
/// Maximum spread (sine) of a node that is tested for a common plane of its facets.
const MAX_PLANE_SPREAD: f32 = 0.5;
/// Factor by which a leaf must be longer than another node, so that its facets are compared with the box of this
/// node.
const LENGTH_FACTOR: f64 = 4.0;

/// Bounds of the facets of each node, which prove that facets of two nodes do not touch or need not be compared.
pub(super) struct PairFilter<'a> {
    placed: &'a PlacedFacets<'a>,
    /// Maximum rounding error of the product of a vertex with a vector, as a multiple of the sum norm of that vector.
    rounding: f64,
    boxes: Vec<Aabb>,
    /// The planes of nodes whose facets lie in one plane with the same orientation.
    planes: Vec<Option<FacetPlane>>,
    /// Vertices common to all facets of a node, followed by [`NO_NEIGHBOUR`].
    shared_vertices: Vec<[u32; 3]>,
}

/// A plane, with the extreme vertices of its facets along the axes.
struct FacetPlane {
    normal: DVec3,
    origin: DVec3,
    extremes: [DVec3; 6],
    /// Maximum distance of a point of the plane due to rounding, and its increase per unit of distance from `origin`
    /// due to tilt.
    tolerance: f64,
    tilt: f64,
}

impl FacetPlane {
    fn new(placed: &PlacedFacets, node: &Node, tolerance: f64) -> Option<Self> {
        if node.spread > MAX_PLANE_SPREAD {
            return None;
        }
        let corners = || node.facets().flat_map(|t| placed.facet_corners(t));
        let first = corners().next()?;
        let mut extremes = [first; 6];
        for p in corners() {
            for k in 0..3 {
                if p[k] < extremes[k][k] {
                    extremes[k] = p;
                }
                if p[k] > extremes[k + 3][k] {
                    extremes[k + 3] = p;
                }
            }
        }
        let (mut area, mut longest) = (DVec3::ZERO, 0.0_f64);
        for i in 1..6 {
            for j in 0..i {
                let [u, v] = [extremes[i] - extremes[0], extremes[j] - extremes[0]];
                let product = u.cross(v);
                longest = longest.max(u.length()).max(v.length());
                if product.length_squared() > area.length_squared() {
                    area = product;
                }
            }
        }
        let facing =
            node.facets().map(|t| tree::area_vector(placed.facet_corners(t)).0).sum::<DVec3>();
        let normal = (area * area.dot(facing).signum()).try_normalize()?;
        let tilt = tolerance * longest / area.length();
        let plane = Self { normal, origin: extremes[0], extremes, tolerance, tilt };
        let alike = |t: usize| tree::area_vector(placed.facet_corners(t)).0.dot(normal) > 0.0;
        let lies = corners().all(|p| plane.contains_point(p)) && node.facets().all(alike);
        lies.then_some(plane)
    }

    /// Checks whether a point lies in the plane within the tolerance.
    fn contains_point(&self, point: DVec3) -> bool {
        let away = point - self.origin;
        self.normal.dot(away).abs() <= self.tolerance + self.tilt * away.length()
    }

    /// Checks whether both lie in one plane with the same orientation.
    fn is_coplanar_with(&self, other: &Self) -> bool {
        let holds = |f: &Self, g: &Self| g.extremes.iter().all(|p| f.contains_point(*p));
        self.normal.dot(other.normal) > 0.0 && (holds(self, other) || holds(other, self))
    }
}

impl<'a> PairFilter<'a> {
    pub(super) fn new(placed: &'a PlacedFacets) -> Self {
        let nodes = &placed.solid.nodes;
        let tolerance = PLANE_TOLERANCE * placed.solid.reach;
        let farthest = placed.vertices.iter().map(|v| v.length()).fold(0.0, f64::max);
        let mut filter = Self {
            placed,
            rounding: 16.0 * f64::EPSILON * farthest,
            boxes: vec![Aabb::EMPTY; nodes.len()],
            planes: nodes.iter().map(|node| FacetPlane::new(placed, node, tolerance)).collect(),
            shared_vertices: vec![[NO_NEIGHBOUR; 3]; nodes.len()],
        };
        // Children follow their node, so reverse order visits them first.
        for (k, node) in nodes.iter().enumerate().rev() {
            (filter.boxes[k], filter.shared_vertices[k]) = if node.is_leaf() {
                let triangles = node.facets().map(|t| placed.solid.triangles[t]);
                let points = node.facets().flat_map(|t| placed.facet_corners(t));
                (
                    Aabb::from_points(points),
                    triangles.reduce(common_vertices).unwrap_or([NO_NEIGHBOUR; 3]),
                )
            } else {
                let [m, n] = [0, 1].map(|n| k + node.child_offset as usize + n);
                (
                    filter.boxes[m].union(&filter.boxes[n]),
                    common_vertices(filter.shared_vertices[m], filter.shared_vertices[n]),
                )
            };
        }
        filter
    }

    /// Checks whether the facets of two nodes need not be compared. They cannot touch, or they lie in one plane with
    /// the same orientation, or they all have a common vertex (a fan).
    pub(super) fn excludes_pair(&self, a: usize, b: usize) -> bool {
        let one_plane = || match (&self.planes[a], &self.planes[b]) {
            (Some(f), Some(g)) => a == b || f.is_coplanar_with(g),
            _ => false,
        };
        !self.boxes[a].intersects(&self.boxes[b])
            || one_plane()
            || common_vertices(self.shared_vertices[a], self.shared_vertices[b])[0] != NO_NEIGHBOUR
            || self.leaf_avoids_box(a, b)
            || self.leaf_avoids_box(b, a)
    }

    /// Returns the longest side of the box of a node.
    pub(super) fn longest_side(&self, node: usize) -> f64 {
        self.boxes[node].side_lengths().max_element()
    }

    /// Checks whether the first node is a leaf that is more than [`LENGTH_FACTOR`] times as long as the second node,
    /// and whose facets avoid the box of the second node.
    ///
    /// The test is for long thin triangles. Their boxes contain large parts of the solid, so boxes alone would not
    /// exclude the pair.
    fn leaf_avoids_box(&self, leaf: usize, node: usize) -> bool {
        let leaf_node = &self.placed.solid.nodes[leaf];
        leaf_node.is_leaf()
            && self.longest_side(leaf) > LENGTH_FACTOR * self.longest_side(node)
            && leaf_node.facets().all(|t| self.facet_avoids_box(t, &self.boxes[node]))
    }

    /// Checks whether a plane certainly separates a facet from a box: a plane parallel to a side of the box, to the
    /// facet, or to an edge of each.
    fn facet_avoids_box(&self, triangle: usize, bounds: &Aabb) -> bool {
        let corners = self.placed.facet_corners(triangle);
        if !Aabb::from_triangle(corners).intersects(bounds) {
            return true;
        }
        visit_counter::count_visits(1);
        let (center, half) = (bounds.center(), bounds.side_lengths() * 0.5);
        let separates = |axis: DVec3| {
            let [a, b, c] = corners.map(|p| axis.dot(p - center));
            let reach = axis.abs().dot(half) + axis.abs().element_sum() * self.rounding;
            a.min(b).min(c) > reach || a.max(b).max(c) < -reach
        };
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        separates(edges[0].cross(edges[1]))
            || edges.iter().any(|edge| DVec3::AXES.iter().any(|e| separates(e.cross(*edge))))
    }
}

/// Returns the vertices that both lists contain, in increasing order, followed by [`NO_NEIGHBOUR`].
fn common_vertices(a: [u32; 3], b: [u32; 3]) -> [u32; 3] {
    let mut both = a.map(|v| if b.contains(&v) { v } else { NO_NEIGHBOUR });
    both.sort_unstable();
    both
}
