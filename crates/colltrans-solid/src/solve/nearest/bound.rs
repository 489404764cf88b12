//! Lower bounds of the distance of two nodes.
//!
//! - Any unit vector `n` gives a bound for two convex sets: the least coordinate of one along `n` minus the largest of
//!   the other. For boxes, three gaps along orthogonal vectors give a better one: the length of their vector.
//! - Bounds use the axes of the fixed body, those of the moving one, the axes of the nodes' slabs, and the direction of
//!   the longer of two vectors: the gaps along the axes of the fixed body, and those along the axes of the moving one.
//!   Cuts and slabs make a node smaller than its box.
//! - A pose's matrix `R` is a rotation only up to rounding. A coordinate along the axis `n` of a slab in the body frame
//!   is one along `R^-T n` in the setting frame, exactly. The three gaps along the columns of `R` are those of `R^T v`,
//!   which is at most the norm of `R` times as long as `v`.
//!
//! Derivation of [`ROUNDING`]: `docs/theory/solid-rounding.md`.

use glam::{DMat3, DVec3};

use crate::body::cuts::{Depths, NormalDecomposition, depth_table};
use crate::body::tree::Node;
use crate::solve::scene::{PairFrame, PlacedBody};
use colltrans_kernel::pose::rotation_defect;

use super::triangle::unit_vector;

/// Noises by which bounds are lowered to cover rounding errors of both bodies.
const ROUNDING: f64 = 2.0;
/// Cosine above which a slab gives better bounds along an axis than the box.
const PARALLEL: f64 = 0.75;

/// Reason in a proof why no two facets of a pair of nodes are nearer than a distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Apart {
    /// The gaps of their boxes along the axes of the fixed body.
    AxesOfFixed,
    /// The gaps of their boxes along the axes of the moving body.
    AxesOfMoving,
    /// The slab of the moving body's node.
    SlabOfMoving,
    /// The slab of the fixed body's node.
    SlabOfFixed,
    /// A plane orthogonal to the vector of the gaps of their boxes along the axes of one body. Of the vectors for both
    /// bodies it is the longer one.
    Way,
    /// The plane between the two facets that prove the upper bound of the distance. It separates all vertices of both
    /// nodes.
    NearestPlane,
    /// Both nodes are leaves, and each pair of their facets was compared individually.
    Examined,
}

/// The axes along which all nodes are measured: those of the fixed and of the moving body.
pub(crate) struct Axes {
    /// The axes in the frames of the moving and of the fixed body.
    seen: [[Axis; 6]; 2],
    /// Factor for the length of three gaps, because the axes are only nearly orthonormal.
    shares: [f64; 2],
    /// The axes in the setting frame, as columns.
    frames: [DMat3; 2],
    /// Maps the axes of slabs of the moving and of the fixed body to the setting frame.
    duals: [DMat3; 2],
    /// Whether both bodies have the same axes.
    pub(super) shared: bool,
    /// Length by which bounds are lowered.
    rounding: f64,
}

/// One axis in a body's frame.
#[derive(Clone, Copy)]
struct Axis {
    local: DVec3,
    offset: f64,
    /// The cuts along the axis and against it.
    parts: [NormalDecomposition; 2],
}

impl Axis {
    fn new(side: &PlacedBody, axis: DVec3) -> Self {
        let local = side.matrix.transpose() * axis;
        let parts = [NormalDecomposition::new(local), NormalDecomposition::new(-local)];
        Self { local, offset: axis.dot(side.offset[0]), parts }
    }

    /// Returns the least and the largest coordinate of a node along the axis.
    #[inline]
    fn range_along(&self, middle: DVec3, half: DVec3, depths: &Depths) -> [f64; 2] {
        let (at, width) = (self.local.dot(middle) + self.offset, self.local.abs().dot(half));
        let [high, low] =
            [self.parts[0].support_reduction(depths), self.parts[1].support_reduction(depths)];
        [at - width + low, at + width - high]
    }
}

impl Axes {
    pub(crate) fn new(scene: &PairFrame) -> Self {
        let frames = [scene.fixed.matrix, scene.moving.matrix];
        let sides = [&scene.moving, &scene.fixed];
        let columns = |m: DMat3| [m.x_axis, m.y_axis, m.z_axis];
        let all = [columns(frames[0]), columns(frames[1])];
        let seen = sides.map(|side| std::array::from_fn(|k| Axis::new(side, all[k / 3][k % 3])));
        let shares = frames.map(|m| 1.0 / (1.0 + 0.5 * rotation_defect(m) + 16.0 * f64::EPSILON));
        let duals = sides.map(|side| side.matrix.inverse().transpose());
        let shared = frames[0] == frames[1];
        Self { seen, shares, frames, duals, shared, rounding: ROUNDING * scene.noise }
    }
}

/// A node in the setting frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodeExtents {
    /// Least coordinates along the axes of the fixed and of the moving body.
    low: [DVec3; 2],
    high: [DVec3; 2],
    /// Unit vector of the axis of its slab; 0 if there is none.
    axis: DVec3,
    slab: [f64; 2],
    /// Centre of the box in the body frame.
    middle: DVec3,
    half: DVec3,
    pub(super) node: u32,
    pub(super) leaf: bool,
    pub(super) size: f64,
}

impl NodeExtents {
    pub(super) fn new(axes: &Axes, side: &PlacedBody, at: u32) -> Self {
        let node = &side.solid.nodes()[at as usize];
        let (middle, size) = (node.bounds.center(), node.bounds.side_lengths());
        let half = size * 0.5;
        let k = usize::from(!side.moving);
        let depths = depth_table(&node.cuts, size, 0.0);
        let ranges = axes.seen[k].map(|axis| axis.range_along(middle, half, &depths));
        let ends = |frame: usize, end: usize| {
            DVec3::from_array([0, 1, 2].map(|i| ranges[3 * frame + i][end]))
        };
        let (axis, slab) = slab_in_setting_frame(axes.duals[k], side, node);
        Self {
            low: [ends(0, 0), ends(1, 0)],
            high: [ends(0, 1), ends(1, 1)],
            axis,
            slab,
            middle,
            half,
            node: at,
            leaf: node.is_leaf(),
            size: size.length_squared(),
        }
    }

    /// Returns a lower bound of `n.x` over the node for a unit vector `n`.
    fn least_along(&self, side: &PlacedBody, n: DVec3) -> f64 {
        let along = self.axis.dot(n);
        let (mut rest, mut by_slab) = (n, 0.0);
        if along.abs() > PARALLEL {
            rest -= self.axis * along;
            by_slab = self.slab[usize::from(along < 0.0)] * along;
        }
        let local = side.matrix.transpose() * rest;
        let middle = local.dot(self.middle) + rest.dot(side.offset[0]);
        let node = &side.solid.nodes()[self.node as usize];
        let gain = NormalDecomposition::new(-local).support_reduction_by_cuts(
            &node.cuts,
            self.half * 2.0,
            0.0,
        );
        by_slab + middle - local.abs().dot(self.half) + gain
    }
}

/// Returns the slab of a node in the setting frame: its axis and range. The axis is 0 if there is no slab.
fn slab_in_setting_frame(dual: DMat3, side: &PlacedBody, node: &Node) -> (DVec3, [f64; 2]) {
    let axis = dual * node.axis;
    let length = axis.length();
    if node.slab[1] == f64::INFINITY || length == 0.0 {
        return (DVec3::ZERO, [f64::NEG_INFINITY, f64::INFINITY]);
    }
    let axis = axis / length;
    let shift = axis.dot(side.offset[0]);
    (axis, node.slab.map(|end| end / length + shift))
}

/// A node of the moving body and one of the fixed body.
#[derive(Clone, Copy)]
pub(super) struct NodePair<'s, 'a> {
    pub(super) scene: &'s PairFrame<'a>,
    pub(super) axes: &'s Axes,
    pub(super) moving: &'s NodeExtents,
    pub(super) fixed: &'s NodeExtents,
}

impl NodePair<'_, '_> {
    /// Returns a lower bound of the distance of the nodes, from one reason.
    pub(super) fn distance_bound(&self, reason: Apart) -> f64 {
        let gap = match reason {
            Apart::AxesOfFixed => self.box_gaps(0).length() * self.axes.shares[0],
            Apart::AxesOfMoving => self.box_gaps(1).length() * self.axes.shares[1],
            Apart::SlabOfMoving => self.past_moving(),
            Apart::SlabOfFixed => self.past_fixed(),
            Apart::Way => self.along_way(),
            Apart::NearestPlane | Apart::Examined => return 0.0,
        };
        if gap.is_nan() { 0.0 } else { (gap - self.axes.rounding).max(0.0) }
    }

    /// Returns the largest bound and its reason. Stops at the first bound that is not below `limit`.
    pub(super) fn best_bound(&self, limit: f64) -> (f64, Apart) {
        let mut best = (self.distance_bound(Apart::AxesOfFixed), Apart::AxesOfFixed);
        let rest = [Apart::AxesOfMoving, Apart::SlabOfMoving, Apart::SlabOfFixed, Apart::Way];
        for reason in rest.into_iter().skip(usize::from(self.axes.shared)) {
            if best.0 >= limit {
                break;
            }
            let bound = self.distance_bound(reason);
            if bound > best.0 {
                best = (bound, reason);
            }
        }
        best
    }

    /// Returns the gaps of the boxes along the axes of a frame, signed from the moving to the fixed body.
    #[inline]
    fn box_gaps(&self, frame: usize) -> DVec3 {
        let ahead = self.fixed.low[frame] - self.moving.high[frame];
        let behind = self.moving.low[frame] - self.fixed.high[frame];
        ahead.max(DVec3::ZERO) - behind.max(DVec3::ZERO)
    }

    /// Returns the distance from the slab of the moving node to the fixed node, on the side where the fixed node is.
    fn past_moving(&self) -> f64 {
        let Self { scene, moving, fixed, .. } = self;
        let n = moving.axis;
        if n == DVec3::ZERO {
            return f64::NEG_INFINITY;
        }
        let ahead = self.is_fixed_ahead(n);
        if ahead {
            fixed.least_along(&scene.fixed, n) - moving.slab[1]
        } else {
            fixed.least_along(&scene.fixed, -n) + moving.slab[0]
        }
    }

    fn past_fixed(&self) -> f64 {
        let Self { scene, moving, fixed, .. } = self;
        let n = fixed.axis;
        if n == DVec3::ZERO {
            return f64::NEG_INFINITY;
        }
        if self.is_fixed_ahead(n) {
            fixed.slab[0] + moving.least_along(&scene.moving, -n)
        } else {
            moving.least_along(&scene.moving, n) - fixed.slab[1]
        }
    }

    /// Checks whether the fixed node is farther along a vector than the moving one.
    fn is_fixed_ahead(&self, n: DVec3) -> bool {
        let [p, q] = [(&self.scene.moving, self.moving), (&self.scene.fixed, self.fixed)]
            .map(|(side, view)| side.matrix * view.middle + side.offset[0]);
        n.dot(q - p) > 0.0
    }

    fn along_way(&self) -> f64 {
        let gaps = [0, 1].map(|frame| self.box_gaps(frame));
        let frame = usize::from(gaps[1].length_squared() > gaps[0].length_squared());
        // The shortest vector between the boxes, from the gaps along the axes.
        let Some(n) = unit_vector(self.axes.frames[frame] * gaps[frame]) else {
            return f64::NEG_INFINITY;
        };
        self.fixed.least_along(&self.scene.fixed, n)
            + self.moving.least_along(&self.scene.moving, -n)
    }
}
