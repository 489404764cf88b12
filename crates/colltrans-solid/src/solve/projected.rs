//! The bounds of a node in the query frame.
//!
//! A node is a box and a slab `low <= n.x <= high` that hold its facets, and how far their normals differ
//! from `n`. Everything is rounded outwards by the noise of coordinates, except along axes where coordinates
//! are exact: there boxes that touch are told from boxes that overlap, so that zero clearance is cut off
//! high up in the trees.

use glam::{DMat3, DVec3};

use super::scene::{Scene, Side};
use crate::body::Shrinking;
use crate::body::cuts::Parts;
use colltrans_convex::body::Aabb;
use colltrans_kernel::error_free::sum_error;

/// Cosine from which on a slab bounds more along an axis than the box does.
const PARALLEL: f64 = 0.75;
/// Slabs steeper than this say little about heights.
const STEEP: f64 = 1e-3;

/// A node in the query frame.
#[derive(Debug, Clone, Copy)]
pub struct Projected {
    pub(crate) node: u32,
    pub bounds: Aabb,
    /// The box in the body frame, after shrinking.
    pub(crate) local: Aabb,
    /// The node's axis and its slab.
    pub axis: DVec3,
    pub slab: [f64; 2],
    /// The axis' component along the direction, rounded in the body frame.
    along: f64,
    /// Facing can be told if `|along|` reaches this.
    spread: f64,
    /// Whether a facet that looks into the box may lie in the side where that starts along the direction, of the
    /// moving body, or ends, of the fixed one.
    inward: bool,
}

impl Projected {
    /// Both bodies as they are whole.
    pub(crate) fn roots(scene: &Scene) -> [Self; 2] {
        [&scene.moving, &scene.fixed].map(|side| Self::new(scene, side, 0))
    }

    pub fn new(scene: &Scene, side: &Side, at: usize) -> Self {
        let node = &side.solid.nodes()[at];
        let axis = side.view * node.axis;
        let shift = axis.dot(side.view_offset);
        let noise = scene.noise + side.skew();
        let mut projected = Self {
            node: at as u32,
            bounds: node.bounds,
            local: node.bounds,
            axis,
            slab: [node.slab[0] + shift - noise, node.slab[1] + shift + noise],
            along: node.axis.dot(side.along),
            spread: f64::from(node.spread),
            inward: scene.keeps() || side.inward & node.inward != 0,
        };
        if let Some(shrinking) = side.shrinking {
            projected.shrink(shrinking, side.amount, at);
        }
        let terms = (node.axis * side.along).abs().element_sum();
        projected.spread += side.defect
            + if side.permutes { 2.0 * f64::EPSILON * terms } else { 16.0 * f64::EPSILON };
        projected.bounds = boxed(scene, side, projected.local);
        if scene.keeps() {
            // What is on edge looks neither way.
            projected.spread += f64::MIN_POSITIVE;
        }
        if side.swell > 0.0 {
            projected.slab = [projected.slab[0] - side.swell, projected.slab[1] + side.swell];
            projected.bounds = projected.bounds.grown(side.swell + scene.noise);
        }
        if node.is_open() {
            // What is on edge has a shadow without a width, but counts.
            projected.bounds = projected.bounds.grown(scene.noise);
        }
        projected
    }

    /// Moves the sides inwards as the facets do.
    fn shrink(&mut self, shrinking: &Shrinking, amount: f64, at: usize) {
        let motion = &shrinking.nodes[at];
        let swell = shrinking.farthest * amount.abs();
        self.spread += f64::from(motion.turn) * amount + f64::from(motion.rough);
        self.local = shrinking.boxed(self.local, amount, at);
        if amount <= shrinking.most {
            self.slab[0] += f64::from(motion.slab[0]) * amount;
            self.slab[1] += f64::from(motion.slab[1]) * amount;
        } else {
            self.slab = [self.slab[0] - swell, self.slab[1] + swell];
        }
    }

    /// Whether both nodes lie in one plane, exactly, and look at each other. Boxes without thickness are
    /// exact: others are rounded outwards.
    pub(crate) fn is_face_to_face(&self, other: &Self) -> bool {
        let (a, b) = (&self.bounds, &other.bounds);
        let flat = |k: usize| {
            a.low[k] == a.high[k]
                && b.low[k] == b.high[k]
                && a.low[k] == b.low[k]
                && self.axis[k] * other.axis[k] < 0.0
        };
        self.spread < 1.0 && other.spread < 1.0 && (0..3).any(flat)
    }

    /// The range of the box along an axis of the body, in the query frame.
    pub(crate) fn local_range(&self, side: &Side, k: usize) -> [f64; 2] {
        let shift = side.view.col(k).dot(side.view_offset);
        let skew = side.skew() + side.swell;
        [self.local.low[k] + shift - skew, self.local.high[k] + shift + skew]
    }

    /// The range of `m.x` over the node, `m` a unit vector.
    pub(crate) fn range(&self, side: &Side, m: DVec3, noise: f64) -> [f64; 2] {
        [self.least_along(side, m, noise), -self.least_along(side, -m, noise)]
    }

    /// The least `m.x` over the node, `m` a unit vector, by its cut box: of what is left of `m` next to
    /// its part along the slab, if that is most of it.
    pub(crate) fn least_along(&self, side: &Side, m: DVec3, noise: f64) -> f64 {
        let (least, local) = self.least_uncut(side, m, noise);
        least + self.gain(side, local)
    }

    /// Whether it lies beyond a place along a unit vector. What is cut off its box is looked at only if it has to be.
    pub(crate) fn is_beyond(&self, side: &Side, m: DVec3, noise: f64, place: f64) -> bool {
        let (least, local) = self.least_uncut(side, m, noise);
        least > place || least + self.gain(side, local) > place
    }

    /// The least `m.x` by its whole box, and along what in the body's frame that was asked.
    fn least_uncut(&self, side: &Side, m: DVec3, noise: f64) -> (f64, DVec3) {
        let along = self.axis.dot(m);
        let (mut rest, mut slab) = (m, 0.0);
        if along.abs() > PARALLEL && self.slab[1] < f64::INFINITY {
            rest -= self.axis * along;
            // As it is: what its body is taken for besides reaches no farther along `m`.
            let own = self.slab[usize::from(along < 0.0)] + side.swell.copysign(along);
            slab = own * along;
        }
        let (local, bounds) = (side.view.transpose() * rest, self.local);
        let middle = local.dot(bounds.center()) + rest.dot(side.view_offset);
        let spread = local.abs().dot(bounds.size() * 0.5) + noise;
        (slab + middle - spread - side.swell, local)
    }

    /// What the cuts of its box take from how far that reaches against a vector of the body's frame.
    fn gain(&self, side: &Side, local: DVec3) -> f64 {
        let node = &side.solid.nodes()[self.node as usize];
        Parts::new(-local).gain_of(&node.cuts, node.bounds.size(), side.moved())
    }

    /// Whether its slab bounds heights.
    pub(crate) fn has_heights(&self) -> bool {
        self.slab[1] < f64::INFINITY && self.axis.z.abs() > STEEP
    }

    /// Whether it may have a level facet where its box has no more than a plane in common with one that it
    /// leaves behind, and the facet blocks.
    pub(crate) fn may_be_level(&self) -> bool {
        self.inward
    }

    /// Whether it has no facet that looks along the direction.
    pub(crate) fn looks_back(&self) -> bool {
        self.spread < 1.0 && self.along <= -self.spread
    }

    /// Whether it has no facet that looks against the direction.
    pub(crate) fn looks_ahead(&self) -> bool {
        self.spread < 1.0 && self.along >= self.spread
    }
}

/// The node's box in the query frame: exact along aligned axes, rounded outwards along others.
fn boxed(scene: &Scene, side: &Side, local: Aabb) -> Aabb {
    let (center, half) = (local.center(), local.size() * 0.5);
    let middle = side.view * center + side.view_offset;
    let DMat3 { x_axis, y_axis, z_axis } = side.view;
    let extent = x_axis.abs() * half.x + y_axis.abs() * half.y + z_axis.abs() * half.z;
    let extent = extent + scene.noise;
    let mut bounds = Aabb { low: middle - extent, high: middle + extent };
    if side.shrinking.is_none() && side.aligned != [false; 3] {
        let rows = side.view.transpose();
        for (k, row) in [rows.x_axis, rows.y_axis, rows.z_axis].into_iter().enumerate() {
            if side.aligned[k] {
                let (a, b) = (row.dot(local.low), row.dot(local.high));
                let offset = side.view_offset[k];
                let exact = side.moving || side.offset[1] == DVec3::ZERO;
                bounds.low[k] = rounded_sum(a.min(b), offset, exact, -1);
                bounds.high[k] = rounded_sum(a.max(b), offset, exact, 1);
            }
        }
    }
    bounds
}

/// `a + b`, rounded downwards or upwards unless it is exact.
fn rounded_sum(a: f64, b: f64, exact: bool, way: i32) -> f64 {
    let (sum, error) = (a + b, sum_error(a, b, a + b));
    if exact && (error == 0.0 || (error > 0.0) == (way < 0)) {
        return sum;
    }
    if way < 0 { sum.next_down() } else { sum.next_up() }
}
