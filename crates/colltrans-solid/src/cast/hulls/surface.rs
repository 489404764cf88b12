//! The surface of a convex solid beside its hull: facets around a corner, beside an edge, and at a place.

use glam::DVec3;

use super::Body;
use crate::body::Solid;
use colltrans_kernel::plane::triangle_normal;

/// Steps from facet to facet around a corner, or towards a place: after the first few the tree is asked.
const MOST_STEPS: usize = 32;
const FEW_STEPS: usize = 4;
/// Least cosine of the angle between the normals of a facet and of a place in it.
const STEEPEST: f64 = 1e-3;
/// Nodes that are looked at for a facet at a place; each leaves another one aside.
const MOST_NODES: usize = 128;

/// A convex solid and its hull.
#[derive(Clone, Copy)]
pub(super) struct Surface<'a> {
    pub(super) solid: &'a Solid,
    pub(super) body: &'a Body,
}

/// A place on a surface, and the normal there, in the body's frame.
#[derive(Clone, Copy)]
pub(super) struct Spot {
    pub(super) at: DVec3,
    pub(super) outward: DVec3,
}

impl<'a> Surface<'a> {
    /// That of a solid, if it is convex.
    pub(super) fn of(solid: &'a Solid) -> Option<Self> {
        Some(Self { solid, body: Body::of(solid)? })
    }

    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.solid.triangles()[triangle as usize].map(|v| self.solid.vertices()[v as usize])
    }

    /// The triangles around a vertex of the hull, with which of their corners it is.
    pub(super) fn around(&self, vertex: u32) -> impl Iterator<Item = (u32, usize)> + use<'a> {
        let (solid, first) = (self.solid, self.body.at[vertex as usize]);
        let number = self.body.number(vertex);
        let place = move |t: u32| {
            Some((t, solid.triangles()[t as usize].iter().position(|&v| v == number)?))
        };
        let next = move |&(t, k): &(u32, usize)| {
            let next = solid.neighbours()[t as usize][k];
            if next == first { None } else { place(next) }
        };
        std::iter::successors(place(first), next).take(MOST_STEPS)
    }

    /// The triangles on either side of an edge of the hull, if it is one of the solid.
    pub(super) fn beside(&self, from: u32, to: u32) -> Option<[u32; 2]> {
        let to = self.body.number(to);
        self.around(from).find_map(|(t, k)| {
            let leads = self.solid.triangles()[t as usize][(k + 1) % 3] == to;
            leads.then(|| [t, self.solid.neighbours()[t as usize][k]])
        })
    }

    /// How far inside of its sides a place is in a triangle, seen against the normal there, each at least less `slack`: as
    /// multiples of lengths that are at most those of the sides.
    pub(super) fn inside(&self, triangle: u32, spot: &Spot, slack: f64) -> [f64; 3] {
        let corners = self.corners(triangle);
        [0, 1, 2].map(|k| {
            let side = corners[(k + 1) % 3] - corners[k];
            let inside = side.cross(spot.at - corners[k]).dot(spot.outward);
            inside - slack * side.abs().element_sum()
        })
    }

    /// The facet at a place: from one at a corner of its face on, a few steps towards it, then from where the tree leads;
    /// at once where it is beyond that one by more of its heights than these steps.
    pub(super) fn facet_at(&self, corner: u32, spot: &Spot, slack: f64) -> Option<u32> {
        let mut triangle = self.around(corner).map(|(t, _)| t).find(|&t| self.looks(t, spot))?;
        for step in 0..MOST_STEPS {
            let sides = self.inside(triangle, spot, -slack);
            let worst = (0..3).fold(0, |worst, k| if sides[k] < sides[worst] { k } else { worst });
            if sides[worst] > 0.0 {
                return self.looks(triangle, spot).then_some(triangle);
            }
            let area = || triangle_normal(self.corners(triangle)).dot(spot.outward);
            let is_far = || -sides[worst] > FEW_STEPS as f64 * area();
            let next = self.solid.neighbours()[triangle as usize][worst];
            triangle = match step {
                0 if is_far() => self.found(spot, slack).unwrap_or(next),
                FEW_STEPS => self.found(spot, slack)?,
                _ => next,
            };
        }
        None
    }

    /// Whether a triangle looks along the normal of a place.
    fn looks(&self, triangle: u32, spot: &Spot) -> bool {
        let [a, b, c] = self.corners(triangle);
        let area = (b - a).cross(c - a);
        area.dot(spot.outward) > STEEPEST * area.length()
    }

    /// A facet at a place, by the tree.
    #[cold]
    fn found(&self, spot: &Spot, slack: f64) -> Option<u32> {
        let nodes = self.solid.nodes();
        let slack_of_boxes = slack + self.body.dent;
        let mut left = [0_u32; MOST_NODES];
        let mut count = 1;
        for _ in 0..MOST_NODES - 1 {
            count = usize::checked_sub(count, 1)?;
            let at = left[count];
            let node = &nodes[at as usize];
            let bounds = node.bounds.grown(slack_of_boxes);
            if bounds.low.cmpgt(spot.at).any() || bounds.high.cmplt(spot.at).any() {
                continue;
            }
            if node.is_leaf() {
                let holds = |t: u32| {
                    let inside = self.inside(t, spot, -slack);
                    self.looks(t, spot) && inside.iter().all(|&side| side > 0.0)
                };
                let facets = node.facets();
                let found = (facets.start as u32..facets.end as u32).find(|&t| holds(t));
                if found.is_some() {
                    return found;
                }
            } else {
                [left[count], left[count + 1]] = node.children(at);
                count += 2;
            }
        }
        None
    }
}
