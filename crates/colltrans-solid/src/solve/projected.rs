//! Bounds of a node in the query frame.
//!
//! - A node is bounded by a box and by a slab `low <= n.x <= high`, and the normals of its facets by a spread around
//!   `n`.
//! - All bounds are rounded outwards by the noise of coordinates, except along axes where coordinates are exact.
//! - Along those axes boxes that touch are distinguished from boxes that overlap. Therefore pairs of nodes with zero
//!   clearance are dismissed near the roots of the trees.

use glam::{DMat3, DVec3};

use super::scene::{PairFrame, PlacedBody};
use crate::body::OffsetField;
use crate::body::cuts::NormalDecomposition;
use colltrans_convex::body::Aabb;
use colltrans_kernel::error_free::sum_error;

/// Cosine above which a slab gives better bounds along an axis than the box.
const PARALLEL: f64 = 0.75;
/// Cosine of the slab axis and the direction below which a slab is too steep to bound heights.
const STEEP: f64 = 1e-3;

/// The bounds of a node in the query frame.
#[derive(Debug, Clone, Copy)]
pub struct Projected {
    pub(crate) node: u32,
    pub bounds: Aabb,
    /// The box in the body frame, after the offset.
    pub(crate) local: Aabb,
    /// Unit normal of the slab in the query frame.
    pub axis: DVec3,
    pub slab: [f64; 2],
    /// Component of the axis along the direction, computed in the body frame.
    along: f64,
    /// The facing of all facets is certain if `|along|` reaches this.
    spread: f64,
    /// Whether a facet that faces into the box may lie in the box side where the moving body begins along the
    /// direction, or the fixed one ends.
    inward: bool,
}

impl Projected {
    /// Returns the bounds of both bodies as a whole.
    pub(crate) fn root_bounds(scene: &PairFrame) -> [Self; 2] {
        [&scene.moving, &scene.fixed].map(|side| Self::new(scene, side, 0))
    }

    pub fn new(scene: &PairFrame, side: &PlacedBody, at: usize) -> Self {
        let node = &side.solid.nodes()[at];
        let axis = side.view * node.axis;
        let shift = axis.dot(side.view_offset);
        let noise = scene.noise + side.skew_bound();
        let mut projected = Self {
            node: at as u32,
            bounds: node.bounds,
            local: node.bounds,
            axis,
            slab: [node.slab[0] + shift - noise, node.slab[1] + shift + noise],
            along: node.axis.dot(side.along),
            spread: f64::from(node.spread),
            inward: scene.has_min_gap() || side.inward & node.inward_sides != 0,
        };
        if let Some(shrinking) = side.shrinking {
            projected.move_inwards(shrinking, side.amount, at);
        }
        let terms = (node.axis * side.along).abs().element_sum();
        projected.spread += side.defect
            + if side.permutes { 2.0 * f64::EPSILON * terms } else { 16.0 * f64::EPSILON };
        projected.bounds = box_in_query_frame(scene, side, projected.local);
        if scene.has_min_gap() {
            // An edge-on facet faces neither way.
            projected.spread += f64::MIN_POSITIVE;
        }
        if side.swell > 0.0 {
            projected.slab = [projected.slab[0] - side.swell, projected.slab[1] + side.swell];
            projected.bounds = projected.bounds.expanded(side.swell + scene.noise);
        }
        if node.is_open() {
            // The shadow of an edge-on facet has no width, but counts.
            projected.bounds = projected.bounds.expanded(scene.noise);
        }
        projected
    }

    /// Moves the sides inwards by the offset.
    fn move_inwards(&mut self, shrinking: &OffsetField, amount: f64, at: usize) {
        let motion = &shrinking.node_motions[at];
        let swell = shrinking.max_displacement * amount.abs();
        self.spread +=
            f64::from(motion.normal_turn_rate) * amount + f64::from(motion.rounding_turn);
        self.local = shrinking.offset_box(self.local, amount, at);
        if amount <= shrinking.max_rate_amount {
            self.slab[0] += f64::from(motion.slab[0]) * amount;
            self.slab[1] += f64::from(motion.slab[1]) * amount;
        } else {
            self.slab = [self.slab[0] - swell, self.slab[1] + swell];
        }
    }

    /// Checks whether both nodes lie exactly in one plane and face each other. Only exact boxes have no thickness,
    /// because others are rounded outwards.
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

    /// Returns the range of the box along axis `k` of the body, in the query frame.
    pub(crate) fn local_range(&self, side: &PlacedBody, k: usize) -> [f64; 2] {
        let shift = side.view.col(k).dot(side.view_offset);
        let skew = side.skew_bound() + side.swell;
        [self.local.low[k] + shift - skew, self.local.high[k] + shift + skew]
    }

    /// Returns the range of `m.x` over the node for a unit vector `m`.
    pub(crate) fn range_along(&self, side: &PlacedBody, m: DVec3, noise: f64) -> [f64; 2] {
        [self.least_along(side, m, noise), -self.least_along(side, -m, noise)]
    }

    /// Returns a lower bound of `m.x` over the node for a unit vector `m`. If the cosine of `m` and the slab's axis
    /// exceeds [`PARALLEL`], the slab bounds that component, and the box with its cut corners the remainder.
    pub(crate) fn least_along(&self, side: &PlacedBody, m: DVec3, noise: f64) -> f64 {
        let (least, local) = self.least_uncut(side, m, noise);
        least + self.cut_gain(side, local)
    }

    /// Checks whether the node lies beyond the coordinate `place` along a unit vector. The cuts of its box are
    /// evaluated only if the uncut box does not decide.
    pub(crate) fn is_beyond(&self, side: &PlacedBody, m: DVec3, noise: f64, place: f64) -> bool {
        let (least, local) = self.least_uncut(side, m, noise);
        least > place || least + self.cut_gain(side, local) > place
    }

    /// Returns a lower bound of `m.x` from the box without its cuts, and from the slab if that is nearly parallel to
    /// `m` (see [`Self::least_along`]). Also returns the vector in the body frame along which the box was measured.
    fn least_uncut(&self, side: &PlacedBody, m: DVec3, noise: f64) -> (f64, DVec3) {
        let along = self.axis.dot(m);
        let (mut rest, mut slab) = (m, 0.0);
        if along.abs() > PARALLEL && self.slab[1] < f64::INFINITY {
            rest -= self.axis * along;
            // The slab without its enlargement, which is subtracted once from the whole bound.
            let own = self.slab[usize::from(along < 0.0)] + side.swell.copysign(along);
            slab = own * along;
        }
        let (local, bounds) = (side.view.transpose() * rest, self.local);
        let middle = local.dot(bounds.center()) + rest.dot(side.view_offset);
        let spread = local.abs().dot(bounds.side_lengths() * 0.5) + noise;
        (slab + middle - spread - side.swell, local)
    }

    /// Returns the length by which the cuts of its box shorten its extent against a vector of the body frame.
    fn cut_gain(&self, side: &PlacedBody, local: DVec3) -> f64 {
        let node = &side.solid.nodes()[self.node as usize];
        NormalDecomposition::new(-local).support_reduction_by_cuts(
            &node.cuts,
            node.bounds.side_lengths(),
            side.max_displacement(),
        )
    }

    /// Checks whether the slab bounds heights.
    pub(crate) fn has_heights(&self) -> bool {
        self.slab[1] < f64::INFINITY && self.axis.z.abs() > STEEP
    }

    /// Checks whether the node may have a level facet that blocks although the largest gap of two boxes is 0. Such a
    /// facet faces into its box and lies in the side where the moving body begins along the direction, or where the
    /// fixed one ends.
    pub(crate) fn may_be_level(&self) -> bool {
        self.inward
    }

    /// Checks whether no facet of the node faces along the direction.
    pub(crate) fn faces_backward(&self) -> bool {
        self.spread < 1.0 && self.along <= -self.spread
    }

    /// Checks whether no facet of the node faces against the direction.
    pub(crate) fn faces_forward(&self) -> bool {
        self.spread < 1.0 && self.along >= self.spread
    }
}

/// Computes the node's box in the query frame: exact along aligned axes, rounded outwards along others.
fn box_in_query_frame(scene: &PairFrame, side: &PlacedBody, local: Aabb) -> Aabb {
    let (center, half) = (local.center(), local.side_lengths() * 0.5);
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

/// Computes `a + b`, rounded downwards or upwards unless it is exact.
fn rounded_sum(a: f64, b: f64, exact: bool, way: i32) -> f64 {
    let (sum, error) = (a + b, sum_error(a, b, a + b));
    if exact && (error == 0.0 || (error > 0.0) == (way < 0)) {
        return sum;
    }
    if way < 0 { sum.next_down() } else { sum.next_up() }
}
