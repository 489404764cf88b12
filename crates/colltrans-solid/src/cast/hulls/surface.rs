//! Surface of a convex solid with its hull: facets around a vertex, at an edge, and at a point.

use glam::DVec3;

use super::ConvexBody;
use crate::body::Solid;
use colltrans_kernel::plane::triangle_normal;

/// Maximum number of steps from facet to facet around a vertex or towards a point.
const MAX_STEPS: usize = 32;
/// Number of steps towards a point before the tree is searched.
const STEPS_BEFORE_TREE: usize = 4;
/// Minimum cosine of the angle between the normals of a facet and of a point in it.
const MIN_COSINE: f64 = 1e-3;
/// Size of the stack of a tree search. The search visits fewer nodes, each of which leaves at most one more on the
/// stack.
const MAX_NODES: usize = 128;

/// A convex solid and its hull.
#[derive(Clone, Copy)]
pub(super) struct Surface<'a> {
    pub(super) solid: &'a Solid,
    pub(super) body: &'a ConvexBody,
}

/// Point on a surface with the outward normal there, in the body's frame.
#[derive(Clone, Copy)]
pub(super) struct SurfacePoint {
    pub(super) position: DVec3,
    pub(super) outward: DVec3,
}

impl<'a> Surface<'a> {
    /// Returns the surface of a solid; `None` if it is not convex.
    pub(super) fn of_convex(solid: &'a Solid) -> Option<Self> {
        Some(Self { solid, body: ConvexBody::cached(solid)? })
    }

    pub(super) fn triangle_corners(&self, triangle: u32) -> [DVec3; 3] {
        self.solid.triangles()[triangle as usize].map(|v| self.solid.vertices()[v as usize])
    }

    /// Iterates over at most [`MAX_STEPS`] triangles around a vertex of the hull, each with the position of the vertex
    /// among its corners.
    pub(super) fn triangles_around(
        &self,
        vertex: u32,
    ) -> impl Iterator<Item = (u32, usize)> + use<'a> {
        let (solid, first) = (self.solid, self.body.triangle_at[vertex as usize]);
        let number = self.body.solid_vertex(vertex);
        let place = move |t: u32| {
            Some((t, solid.triangles()[t as usize].iter().position(|&v| v == number)?))
        };
        let next = move |&(t, k): &(u32, usize)| {
            let next = solid.neighbours()[t as usize][k];
            if next == first { None } else { place(next) }
        };
        std::iter::successors(place(first), next).take(MAX_STEPS)
    }

    /// Finds the triangles on both sides of an edge of the hull; `None` if it is not found as an edge of the solid.
    pub(super) fn triangles_at_edge(&self, from: u32, to: u32) -> Option<[u32; 2]> {
        let to = self.body.solid_vertex(to);
        self.triangles_around(from).find_map(|(t, k)| {
            let leads = self.solid.triangles()[t as usize][(k + 1) % 3] == to;
            leads.then(|| [t, self.solid.neighbours()[t as usize][k]])
        })
    }

    /// Computes for each side of a triangle, seen against the point's normal, the distance of the point inside the side
    /// times the side's projected length, minus `slack` times the sum norm of the side. A positive `slack` is thus
    /// subtracted from the distance at least in full, and a negative one is added at least in full.
    pub(super) fn distances_inside(
        &self,
        triangle: u32,
        point: &SurfacePoint,
        slack: f64,
    ) -> [f64; 3] {
        let corners = self.triangle_corners(triangle);
        [0, 1, 2].map(|k| {
            let side = corners[(k + 1) % 3] - corners[k];
            let inside = side.cross(point.position - corners[k]).dot(point.outward);
            inside - slack * side.abs().element_sum()
        })
    }

    /// Finds the facet that contains a point, to within `slack` at its sides. The search walks from a facet around
    /// the hull vertex `corner` towards the point. It uses the tree after [`STEPS_BEFORE_TREE`] steps, or at once
    /// if the point is more than that many heights beyond the first facet. `None` if no facet is found.
    pub(super) fn facet_at(&self, corner: u32, point: &SurfacePoint, slack: f64) -> Option<u32> {
        let mut triangle = self
            .triangles_around(corner)
            .map(|(t, _)| t)
            .find(|&t| self.faces_outward(t, point))?;
        for step in 0..MAX_STEPS {
            let sides = self.distances_inside(triangle, point, -slack);
            let worst = (0..3).fold(0, |worst, k| if sides[k] < sides[worst] { k } else { worst });
            if sides[worst] > 0.0 {
                return self.faces_outward(triangle, point).then_some(triangle);
            }
            let area = || triangle_normal(self.triangle_corners(triangle)).dot(point.outward);
            let is_far = || -sides[worst] > STEPS_BEFORE_TREE as f64 * area();
            let next = self.solid.neighbours()[triangle as usize][worst];
            triangle = match step {
                0 if is_far() => self.find_in_tree(point, slack).unwrap_or(next),
                STEPS_BEFORE_TREE => self.find_in_tree(point, slack)?,
                _ => next,
            };
        }
        None
    }

    /// Checks whether a triangle faces along the normal of a point.
    fn faces_outward(&self, triangle: u32, point: &SurfacePoint) -> bool {
        let [a, b, c] = self.triangle_corners(triangle);
        let area = (b - a).cross(c - a);
        area.dot(point.outward) > MIN_COSINE * area.length()
    }

    /// Finds a facet that contains a point by a search of the tree; `None` if there is none among the visited
    /// nodes.
    #[cold]
    fn find_in_tree(&self, point: &SurfacePoint, slack: f64) -> Option<u32> {
        let nodes = self.solid.nodes();
        let box_slack = slack + self.body.dent;
        let mut stack = [0_u32; MAX_NODES];
        let mut count = 1;
        for _ in 0..MAX_NODES - 1 {
            count = usize::checked_sub(count, 1)?;
            let at = stack[count];
            let node = &nodes[at as usize];
            let bounds = node.bounds.expanded(box_slack);
            if bounds.low.cmpgt(point.position).any() || bounds.high.cmplt(point.position).any() {
                continue;
            }
            if node.is_leaf() {
                let holds = |t: u32| {
                    let inside = self.distances_inside(t, point, -slack);
                    self.faces_outward(t, point) && inside.iter().all(|&side| side > 0.0)
                };
                let facets = node.facets();
                let found = (facets.start as u32..facets.end as u32).find(|&t| holds(t));
                if found.is_some() {
                    return found;
                }
            } else {
                [stack[count], stack[count + 1]] = node.child_positions(at);
                count += 2;
            }
        }
        None
    }
}
