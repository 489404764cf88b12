//! Surface of a convex solid with its hull: facets around a vertex, at an edge, and at a point.

use glam::DVec3;

use super::ConvexBody;
use crate::body::{Solid, offset_vertex};
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

/// Maximum number of facets of one body that are compared.
const MAX_FACETS: usize = 4;
/// Distance of the contact point from a side, in noises, up to which the facet across counts too.
pub const NEAR_NOISES: f64 = 64.0;
/// Maximum number of vertices that are compared for the farthest one.
const MAX_TOP_VERTICES: usize = 32;

/// A convex solid and its hull.
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    pub(crate) solid: &'a Solid,
    pub body: &'a ConvexBody,
}

/// Point on a surface with the outward normal there, in the body's frame.
#[derive(Clone, Copy)]
pub struct SurfacePoint {
    pub position: DVec3,
    pub outward: DVec3,
}

impl<'a> Surface<'a> {
    /// Returns the surface of a solid; `None` if it is not convex.
    pub fn of_convex(solid: &'a Solid) -> Option<Self> {
        Some(Self { solid, body: ConvexBody::cached(solid)? })
    }

    pub(crate) fn triangle_corners(&self, triangle: u32) -> [DVec3; 3] {
        self.solid.triangles()[triangle as usize].map(|v| self.solid.vertices()[v as usize])
    }

    /// Iterates over at most [`MAX_STEPS`] triangles around a vertex of the hull, each with the position of the vertex
    /// among its corners.
    pub(crate) fn triangles_around(
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
    pub(crate) fn triangles_at_edge(&self, from: u32, to: u32) -> Option<[u32; 2]> {
        let to = self.body.solid_vertex(to);
        self.triangles_around(from).find_map(|(t, k)| {
            let leads = self.solid.triangles()[t as usize][(k + 1) % 3] == to;
            leads.then(|| [t, self.solid.neighbours()[t as usize][k]])
        })
    }

    /// Computes for each side of a triangle, seen against the point's normal, the distance of the point inside the side
    /// times the side's projected length, minus `slack` times the sum norm of the side. A positive `slack` is thus
    /// subtracted from the distance at least in full, and a negative one is added at least in full.
    pub(crate) fn distances_inside(
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
    pub(crate) fn facet_at(&self, corner: u32, point: &SurfacePoint, slack: f64) -> Option<u32> {
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

impl Surface<'_> {
    /// Computes the maximum height of the vertices of the solid, offset inwards by `amount`, along a vector of the
    /// body frame that is at most 1 long, up to the rounding of one product. `None` if the hull lacks vertices, or if
    /// more than [`MAX_TOP_VERTICES`] may be highest.
    ///
    /// Vertices lower than the highest hull vertex `from` by twice the displacement of the offset and by `rounding`, an
    /// error of heights, cannot be highest. The others are found from `from` over edges of the hull, as the plateau of
    /// a support point is.
    pub fn max_height(&self, local: DVec3, from: u32, amount: f64, rounding: f64) -> Option<f64> {
        let Self { body, solid } = self;
        let height = |v: u32| local.dot(body.hull.vertices()[v as usize]);
        let shrinking = solid.shrinking_by(amount);
        let offset_height = |v: u32| {
            let v = body.solid_vertex(v) as usize;
            let at = solid.vertices()[v];
            local.dot(
                shrinking.map_or(at, |field| offset_vertex(at, field.displacements[v], amount)),
            )
        };
        let moved = shrinking.map_or(0.0, |field| field.max_displacement * amount.abs());
        let end = height(from) - 2.0 * moved - rounding - body.hull.plateau_depth();
        let (mut top, mut count, mut next) = ([from; MAX_TOP_VERTICES], 1, 0);
        let mut reach = f64::NEG_INFINITY;
        while body.has_all_vertices && next < count {
            reach = reach.max(offset_height(top[next]));
            for &v in body.hull.neighbours(top[next]) {
                if height(v) < end || top[..count].contains(&v) {
                    continue;
                }
                if count == MAX_TOP_VERTICES {
                    return None;
                }
                top[count] = v;
                count += 1;
            }
            next += 1;
        }
        body.has_all_vertices.then_some(reach)
    }
}

/// Facets of one body around a point.
pub struct FacetGroup {
    facets: [u32; MAX_FACETS],
    count: usize,
}

impl FacetGroup {
    /// Collects the facet at a point, and the facets across its sides within the distance `near` of the point. The
    /// search begins at the hull vertex `corner`. `None` if no facet is found.
    pub fn new(surface: &Surface, corner: u32, point: &SurfacePoint, near: f64) -> Option<Self> {
        let triangle = surface.facet_at(corner, point, near)?;
        let mut group = Self { facets: [triangle; MAX_FACETS], count: 1 };
        for (k, inside) in surface.distances_inside(triangle, point, near).into_iter().enumerate() {
            if inside <= 0.0 {
                group.facets[group.count] = surface.solid.neighbours()[triangle as usize][k];
                group.count += 1;
            }
        }
        Some(group)
    }

    pub fn facets(&self) -> &[u32] {
        &self.facets[..self.count]
    }
}
