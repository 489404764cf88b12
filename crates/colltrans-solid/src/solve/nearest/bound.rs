//! How near two nodes can be to each other.
//!
//! Between two convex sets any unit vector `n` gives a bound: how far one reaches along it less than the other
//! does. Between boxes three of them, at right angles, give more: the length of the three gaps. Tried are the axes
//! of the fixed body, those of the moving one, the axes of the nodes' slabs, and the direction of the longest
//! of the first two. Nodes are less than boxes by their cuts, and by their slabs.
//!
//! A pose's matrix `R` need not be a rotation to the last digit. What lies along the axis `n` of a slab in the body
//! frame lies along `R^-T n` in the setting frame, exactly. The three gaps along the columns of `R` are those of
//! `R^T v`, which is longer than `v` by the norm of `R` at most.
//!
//! Rounding, for a body with the reach `r` at the offset `o`. How far a node reaches along a unit vector is off
//! by `5.2 u r` for the vector in the body frame, `11 u r` for the box's middle and half extents and products with
//! them, `14 u r` for the cuts, `22 u r` for what of the vector is along the slab, `5 u (r + o)` for the vector that is
//! left, `9 u o` for the offset: less than `58 u (r + o)`. Along an axis of a body it is `31 u (r + o)`, and
//! the length of three is off by `sqrt 3` times that. So [`ROUNDING`] noises, `64 u S`, cover both bodies.

use glam::{DMat3, DVec3};

use crate::body::cuts::{Depths, Parts, depths};
use crate::body::tree::Node;
use crate::solve::scene::{Scene, Side};
use colltrans_kernel::pose::rotation_defect;

use super::triangle::unit;

/// What bounds are lowered by, in noises.
const ROUNDING: f64 = 2.0;
/// Cosine from which on a slab bounds more along an axis than the box does.
const PARALLEL: f64 = 0.75;

/// What shows that no two facets of a pair of nodes are nearer than a distance: what a proof says of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Apart {
    /// The gaps of their boxes along the axes of the fixed body.
    AxesOfFixed,
    /// The same along those of the moving body.
    AxesOfMoving,
    /// The slab of the moving body's node.
    SlabOfMoving,
    /// The slab of the fixed body's node.
    SlabOfFixed,
    /// A plane across the shortest way between their boxes.
    Way,
    /// Two leaves: each pair of facets was looked at by itself.
    Examined,
}

/// The axes along which all nodes are measured: those of the fixed and of the moving body.
pub(crate) struct Axes {
    /// As the moving and as the fixed body see them.
    seen: [[Axis; 6]; 2],
    /// What the length of three gaps is multiplied by.
    shares: [f64; 2],
    /// The axes in the setting frame, by columns.
    frames: [DMat3; 2],
    /// Of the moving and of the fixed body, where the axes of slabs go.
    duals: [DMat3; 2],
    /// Whether the moving body has the axes of the fixed one.
    pub(super) shared: bool,
    /// What bounds are lowered by.
    rounding: f64,
}

/// One axis in a body's frame.
#[derive(Clone, Copy)]
struct Axis {
    local: DVec3,
    offset: f64,
    /// Which cuts are along it, and against it.
    parts: [Parts; 2],
}

impl Axis {
    fn new(side: &Side, axis: DVec3) -> Self {
        let local = side.matrix.transpose() * axis;
        let parts = [Parts::new(local), Parts::new(-local)];
        Self { local, offset: axis.dot(side.offset[0]), parts }
    }

    /// The least and the largest place of a node along it.
    #[inline]
    fn range(&self, middle: DVec3, half: DVec3, depths: &Depths) -> [f64; 2] {
        let (at, width) = (self.local.dot(middle) + self.offset, self.local.abs().dot(half));
        let [high, low] = [self.parts[0].gain(depths), self.parts[1].gain(depths)];
        [at - width + low, at + width - high]
    }
}

impl Axes {
    pub(crate) fn new(scene: &Scene) -> Self {
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
pub(super) struct View {
    /// Along the axes of the fixed and of the moving body.
    low: [DVec3; 2],
    high: [DVec3; 2],
    /// The axis of its slab, of length 1, and where that is; 0 if there is none.
    axis: DVec3,
    slab: [f64; 2],
    /// The box in the body frame.
    middle: DVec3,
    half: DVec3,
    pub(super) node: u32,
    pub(super) leaf: bool,
    pub(super) size: f64,
}

impl View {
    pub(super) fn new(axes: &Axes, side: &Side, at: u32) -> Self {
        let node = &side.solid.nodes()[at as usize];
        let (middle, size) = (node.bounds.center(), node.bounds.size());
        let half = size * 0.5;
        let k = usize::from(!side.moving);
        let depths = depths(&node.cuts, size, 0.0);
        let ranges = axes.seen[k].map(|axis| axis.range(middle, half, &depths));
        let ends = |frame: usize, end: usize| {
            DVec3::from_array([0, 1, 2].map(|i| ranges[3 * frame + i][end]))
        };
        let (axis, slab) = slab(axes.duals[k], side, node);
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

    /// The least `n.x` over the node, `n` a unit vector.
    fn least_along(&self, side: &Side, n: DVec3) -> f64 {
        let along = self.axis.dot(n);
        let (mut rest, mut by_slab) = (n, 0.0);
        if along.abs() > PARALLEL {
            rest -= self.axis * along;
            by_slab = self.slab[usize::from(along < 0.0)] * along;
        }
        let local = side.matrix.transpose() * rest;
        let middle = local.dot(self.middle) + rest.dot(side.offset[0]);
        let node = &side.solid.nodes()[self.node as usize];
        let gain = Parts::new(-local).gain_of(&node.cuts, self.half * 2.0, 0.0);
        by_slab + middle - local.abs().dot(self.half) + gain
    }
}

/// The slab of a node in the setting frame.
fn slab(dual: DMat3, side: &Side, node: &Node) -> (DVec3, [f64; 2]) {
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
pub(super) struct Couple<'s, 'a> {
    pub(super) scene: &'s Scene<'a>,
    pub(super) axes: &'s Axes,
    pub(super) moving: &'s View,
    pub(super) fixed: &'s View,
}

impl Couple<'_, '_> {
    /// No point of one is nearer to the other, by one reason.
    pub(super) fn bound(&self, reason: Apart) -> f64 {
        let gap = match reason {
            Apart::AxesOfFixed => self.gaps(0).length() * self.axes.shares[0],
            Apart::AxesOfMoving => self.gaps(1).length() * self.axes.shares[1],
            Apart::SlabOfMoving => self.past_moving(),
            Apart::SlabOfFixed => self.past_fixed(),
            Apart::Way => self.along_way(),
            Apart::Examined => return 0.0,
        };
        if gap.is_nan() { 0.0 } else { (gap - self.axes.rounding).max(0.0) }
    }

    /// The largest bound, and why; what is not below `limit` will do.
    pub(super) fn best(&self, limit: f64) -> (f64, Apart) {
        let mut best = (self.bound(Apart::AxesOfFixed), Apart::AxesOfFixed);
        let rest = [Apart::AxesOfMoving, Apart::SlabOfMoving, Apart::SlabOfFixed, Apart::Way];
        for reason in rest.into_iter().skip(usize::from(self.axes.shared)) {
            if best.0 >= limit {
                break;
            }
            let bound = self.bound(reason);
            if bound > best.0 {
                best = (bound, reason);
            }
        }
        best
    }

    /// The gaps of the boxes along the axes of a frame, signed from the moving to the fixed body.
    #[inline]
    fn gaps(&self, frame: usize) -> DVec3 {
        let ahead = self.fixed.low[frame] - self.moving.high[frame];
        let behind = self.moving.low[frame] - self.fixed.high[frame];
        ahead.max(DVec3::ZERO) - behind.max(DVec3::ZERO)
    }

    /// From the slab of the moving node to the fixed one, on whichever side that is.
    fn past_moving(&self) -> f64 {
        let Self { scene, moving, fixed, .. } = self;
        let n = moving.axis;
        if n == DVec3::ZERO {
            return f64::NEG_INFINITY;
        }
        let ahead = self.toward(n);
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
        if self.toward(n) {
            fixed.slab[0] + moving.least_along(&scene.moving, -n)
        } else {
            moving.least_along(&scene.moving, n) - fixed.slab[1]
        }
    }

    /// Whether the fixed node is farther along a vector.
    fn toward(&self, n: DVec3) -> bool {
        let [p, q] = [(&self.scene.moving, self.moving), (&self.scene.fixed, self.fixed)]
            .map(|(side, view)| side.matrix * view.middle + side.offset[0]);
        n.dot(q - p) > 0.0
    }

    fn along_way(&self) -> f64 {
        let gaps = [0, 1].map(|frame| self.gaps(frame));
        let frame = usize::from(gaps[1].length_squared() > gaps[0].length_squared());
        // Of the gaps along the axes, what is between the bodies.
        let Some(n) = unit(self.axes.frames[frame] * gaps[frame]) else {
            return f64::NEG_INFINITY;
        };
        self.fixed.least_along(&self.scene.fixed, n)
            + self.moving.least_along(&self.scene.moving, -n)
    }
}
