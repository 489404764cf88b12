//! What two nodes bound: whether any pair of their facets can count, and for how little.
//!
//! A node is looked at in the query frame as a [`Shade`]: a box, a slab `low <= n.x <= high` that
//! holds its facets, and how far their normals differ from `n`. Everything is rounded outwards by the
//! blur of coordinates, except along axes where coordinates are exact: there boxes that touch are
//! told from boxes that overlap, so that zero clearance is cut off high up in the trees.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::scene::{Scene, Side, sum_error};
use crate::body::solid::tree::Node;

/// Slabs steeper than this say little about heights.
const STEEP: f64 = 1e-3;
/// Slabs less steep than this say little about shadows.
const LEVEL: f64 = 0.1;

/// Why no two facets of a pair of nodes need a further look: what a proof says of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Reason {
    /// No facet of the moving body looks along the direction.
    MovingFacesAway,
    /// No facet of the fixed body looks against the direction.
    FixedFacesAway,
    /// The interiors of their shadows are disjoint.
    ShadowsApart,
    /// The largest gap is negative: they part.
    Parting,
    /// The least gap is not smaller than the answer.
    NotBefore,
    /// Two leaves: each pair of facets was looked at by itself.
    Examined,
    /// They have no point in common where they are.
    Disjoint,
    /// They lie in one plane and look at each other, so they show no overlap.
    FaceToFace,
}

/// A node in the query frame.
#[derive(Clone, Copy)]
pub(super) struct Shade {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    /// The box in the body frame, after shrinking.
    local: [DVec3; 2],
    /// The node's axis and its slab.
    pub(super) axis: DVec3,
    pub(super) slab: [f64; 2],
    /// The axis' component along the direction, rounded in the body frame.
    along: f64,
    /// Facing can be told if `|along|` reaches this.
    spread: f64,
}

impl Shade {
    pub(super) fn new(scene: &Scene, side: &Side, at: usize) -> Self {
        let node = &shrunk(side, at);
        let (low, high) = boxed(scene, side, node);
        let mut spread = f64::from(node.spread);
        if let Some(shrinking) = side.shrinking {
            let motion = &shrinking.nodes[at];
            spread += f64::from(motion.turn) * side.amount + f64::from(motion.rough);
        }
        let terms = (node.axis * side.along).abs().element_sum();
        spread += if side.permutes { 2.0 * f64::EPSILON * terms } else { 16.0 * f64::EPSILON };
        let axis = side.view * node.axis;
        let (shift, slack) = (axis.dot(side.view_offset), scene.blur);
        Self {
            low,
            high,
            local: [node.low, node.high],
            axis,
            slab: [node.slab[0] + shift - slack, node.slab[1] + shift + slack],
            along: node.axis.dot(side.along),
            spread,
        }
    }

    /// Whether both nodes lie in one plane, exactly, and look at each other. Boxes without thickness are
    /// exact: others are rounded outwards.
    pub(super) fn is_face_to_face(&self, other: &Self) -> bool {
        let flat = |k: usize| {
            self.low[k] == self.high[k]
                && other.low[k] == other.high[k]
                && self.low[k] == other.low[k]
                && self.axis[k] * other.axis[k] < 0.0
        };
        self.spread < 1.0 && other.spread < 1.0 && (0..3).any(flat)
    }

    /// The range of the box along an axis of the body, in the query frame.
    fn local_range(&self, side: &Side, k: usize) -> [f64; 2] {
        let shift = side.view.col(k).dot(side.view_offset);
        [self.local[0][k] + shift, self.local[1][k] + shift]
    }

    /// The range of `m.x` over the node, by its box in the body frame and by its slab.
    fn range(&self, side: &Side, m: DVec3, blur: f64) -> [f64; 2] {
        let local = side.view.transpose() * m;
        let [low, high] = self.local;
        let middle = local.dot((low + high) * 0.5) + m.dot(side.view_offset);
        let spread = local.abs().dot((high - low) * 0.5);
        let [mut least, mut largest] = [middle - spread, middle + spread];
        if self.slab[1] < f64::INFINITY {
            let sign = self.axis.dot(m).signum();
            let rest = m - self.axis * sign;
            let (center, half) = ((self.low + self.high) * 0.5, (self.high - self.low) * 0.5);
            let (value, spread) = (rest.dot(center), rest.abs().dot(half));
            let [x, y] = [sign * self.slab[0], sign * self.slab[1]];
            least = least.max(x.min(y) + value - spread);
            largest = largest.min(x.max(y) + value + spread);
        }
        [least - blur, largest + blur]
    }

    /// Whether it has no facet that looks along the direction.
    fn looks_back(&self) -> bool {
        self.spread < 1.0 && self.along <= -self.spread
    }

    /// Whether it has no facet that looks against the direction.
    fn looks_ahead(&self) -> bool {
        self.spread < 1.0 && self.along >= self.spread
    }
}

/// The node of the shrunk body, but for its normals.
fn shrunk(side: &Side, at: usize) -> Node {
    let mut node = side.solid.nodes()[at];
    let Some(shrinking) = side.shrinking else { return node };
    let amount = side.amount;
    if amount <= shrinking.most {
        let motion = &shrinking.nodes[at];
        let rate = |r: [f32; 3]| DVec3::from_array(r.map(f64::from)) * amount;
        node.low += rate(motion.low);
        node.high += rate(motion.high);
        node.slab[0] += f64::from(motion.slab[0]) * amount;
        node.slab[1] += f64::from(motion.slab[1]) * amount;
    } else {
        let swell = shrinking.farthest * amount;
        node.low -= swell;
        node.high += swell;
        node.slab = [node.slab[0] - swell, node.slab[1] + swell];
    }
    node
}

/// The node's box in the query frame: exact along aligned axes, rounded outwards along others.
fn boxed(scene: &Scene, side: &Side, node: &Node) -> (DVec3, DVec3) {
    let (center, half) = ((node.low + node.high) * 0.5, (node.high - node.low) * 0.5);
    let middle = side.view * center + side.view_offset;
    let rows = side.view.transpose();
    let extent = DVec3::new(
        rows.x_axis.abs().dot(half),
        rows.y_axis.abs().dot(half),
        rows.z_axis.abs().dot(half),
    ) + DVec3::splat(scene.blur);
    let (mut low, mut high) = (middle - extent, middle + extent);
    if side.shrinking.is_none() {
        for (k, row) in [rows.x_axis, rows.y_axis, rows.z_axis].into_iter().enumerate() {
            if side.aligned[k] {
                let (a, b) = (row.dot(node.low), row.dot(node.high));
                let offset = side.view_offset[k];
                let exact = side.moving || side.offset[1] == DVec3::ZERO;
                low[k] = rounded_sum(a.min(b), offset, exact, -1);
                high[k] = rounded_sum(a.max(b), offset, exact, 1);
            }
        }
    }
    (low, high)
}

/// `a + b`, rounded downwards or upwards unless it is exact.
fn rounded_sum(a: f64, b: f64, exact: bool, way: i32) -> f64 {
    let (sum, error) = (a + b, sum_error(a, b));
    if exact && (error == 0.0 || (error > 0.0) == (way < 0)) {
        return sum;
    }
    if way < 0 { sum.next_down() } else { sum.next_up() }
}

/// The least gap that a pair of facets under two nodes can have, as a length; `parting` pairs, with a
/// negative largest gap, are of no interest if so said.
///
/// # Errors
/// Why no pair of facets counts for less than `limit`.
pub(super) fn least_gap(
    scene: &Scene,
    a: &Shade,
    b: &Shade,
    limit: f64,
    parting: bool,
) -> Result<f64, Reason> {
    if a.looks_back() {
        return Err(Reason::MovingFacesAway);
    }
    if b.looks_ahead() {
        return Err(Reason::FixedFacesAway);
    }
    let (low, high) = (a.low.max(b.low), a.high.min(b.high));
    if low.x >= high.x || low.y >= high.y {
        return Err(Reason::ShadowsApart);
    }
    let bare = b.low.z - a.high.z;
    if bare >= limit {
        return Err(Reason::NotBefore);
    }
    if parting && b.high.z < a.low.z {
        return Err(Reason::Parting);
    }
    let swept = swept(scene, a, b);
    if swept[0] > swept[1] {
        return Err(Reason::ShadowsApart);
    }
    if swept[0] >= limit {
        return Err(Reason::NotBefore);
    }
    if parting && swept[1] < 0.0 {
        return Err(Reason::Parting);
    }
    let region = Region { middle: (low + high).xy() * 0.5, half: (high - low).xy() * 0.5 };
    let (p, q) = (Heights::new(scene, a), Heights::new(scene, b));
    let [least, largest] = gaps(&region, (a, p.as_ref()), (b, q.as_ref()), swept);
    if least >= limit {
        return Err(Reason::NotBefore);
    }
    if parting && largest < 0.0 {
        return Err(Reason::Parting);
    }
    if p.is_none() || q.is_none() {
        let apart = sides_apart(scene, (&scene.moving, a), (&scene.fixed, b))
            || sides_apart(scene, (&scene.fixed, b), (&scene.moving, a));
        if apart {
            return Err(Reason::ShadowsApart);
        }
    }
    Ok(least)
}

/// The range of gaps that boxes of bodies with the same axes leave.
fn swept(scene: &Scene, a: &Shade, b: &Shade) -> [f64; 2] {
    let all = [f64::NEG_INFINITY, f64::INFINITY];
    scene.sweep.as_ref().map_or(all, |sweep| sweep.gaps(&a.local, &b.local, scene.blur))
}

/// Whether a reason to cut a pair of nodes holds, checked by itself; `limit` as for [`least_gap`].
pub(super) fn holds(scene: &Scene, a: &Shade, b: &Shade, reason: Reason, limit: f64) -> bool {
    let (low, high) = (a.low.max(b.low), a.high.min(b.high));
    let gaps = || {
        let region = Region { middle: (low + high).xy() * 0.5, half: (high - low).xy() * 0.5 };
        let (p, q) = (Heights::new(scene, a), Heights::new(scene, b));
        gaps(&region, (a, p.as_ref()), (b, q.as_ref()), swept(scene, a, b))
    };
    let swept_apart = || {
        let [least, largest] = swept(scene, a, b);
        least > largest
    };
    match reason {
        Reason::MovingFacesAway => a.looks_back(),
        Reason::FixedFacesAway => b.looks_ahead(),
        Reason::ShadowsApart => {
            low.x >= high.x
                || low.y >= high.y
                || swept_apart()
                || sides_apart(scene, (&scene.moving, a), (&scene.fixed, b))
                || sides_apart(scene, (&scene.fixed, b), (&scene.moving, a))
        }
        Reason::Parting => gaps()[1] < 0.0,
        Reason::NotBefore => gaps()[0] >= limit,
        Reason::Disjoint => apart(scene, a, b),
        Reason::FaceToFace => a.is_face_to_face(b),
        Reason::Examined => false,
    }
}

/// A rectangle of the shadow plane.
struct Region {
    middle: DVec2,
    half: DVec2,
}

impl Region {
    /// The range of a linear function.
    fn range(&self, slope: DVec2) -> [f64; 2] {
        let (value, spread) = (slope.dot(self.middle), slope.abs().dot(self.half));
        [value - spread, value + spread]
    }
}

/// Heights of a slab over the shadow: `base[0] + slope.s <= h <= base[1] + slope.s`.
struct Heights {
    slope: DVec2,
    base: [f64; 2],
}

impl Heights {
    fn new(scene: &Scene, shade: &Shade) -> Option<Self> {
        let c = shade.axis.z;
        if c.abs() < STEEP || shade.slab[1] == f64::INFINITY {
            return None;
        }
        let (x, y) = (shade.slab[0] / c, shade.slab[1] / c);
        let slack = scene.blur / c.abs();
        Some(Self { slope: -shade.axis.xy() / c, base: [x.min(y) - slack, x.max(y) + slack] })
    }
}

/// Bounds of all gaps over a region, the best of boxes, slabs and what is known already.
fn gaps(
    region: &Region,
    (a, p): (&Shade, Option<&Heights>),
    (b, q): (&Shade, Option<&Heights>),
    swept: [f64; 2],
) -> [f64; 2] {
    let mut least = swept[0].max(b.low.z - a.high.z);
    let mut largest = swept[1].min(b.high.z - a.low.z);
    if let Some(p) = p {
        let [low, high] = region.range(p.slope);
        least = least.max(b.low.z - (p.base[1] + high));
        largest = largest.min(b.high.z - (p.base[0] + low));
    }
    if let Some(q) = q {
        let [low, high] = region.range(q.slope);
        least = least.max(q.base[0] + low - a.high.z);
        largest = largest.min(q.base[1] + high - a.low.z);
    }
    if let (Some(p), Some(q)) = (p, q) {
        let [low, high] = region.range(q.slope - p.slope);
        least = least.max(q.base[0] - p.base[1] + low);
        largest = largest.min(q.base[1] - p.base[0] + high);
    }
    [least, largest]
}

/// Whether the shadows are apart along the axis of a slab or a box that is nearly orthogonal to the
/// direction.
///
/// For a point with shadow `s` and height `h` it is `n.x = m.s + c h`, with `m` the axis' shadow and
/// `c` its component along the direction.
fn sides_apart(scene: &Scene, (p, a): (&Side, &Shade), (q, b): (&Side, &Shade)) -> bool {
    let apart = |axis: DVec3, range: [f64; 2]| {
        let c = axis.z;
        if c.abs() > LEVEL {
            return false;
        }
        let rise = [c * a.low.z, c * a.high.z];
        let low = range[0] - rise[0].max(rise[1]);
        let high = range[1] - rise[0].min(rise[1]);
        let [least, largest] = b.range(q, axis.with_z(0.0), scene.blur);
        let slack = scene.blur;
        least >= high + slack || largest <= low - slack
    };
    if a.slab[1] < f64::INFINITY && apart(a.axis, a.slab) {
        return true;
    }
    p.aligned == [false; 3] && (0..3).any(|k| apart(p.view.col(k), a.local_range(p, k)))
}

/// Whether no point of one node is a point of the other, by boxes and slabs.
pub(super) fn apart(scene: &Scene, a: &Shade, b: &Shade) -> bool {
    let (p, q) = (&scene.moving, &scene.fixed);
    (0..3).any(|k| a.high[k] < b.low[k] || b.high[k] < a.low[k])
        || beyond(scene, (p, a), (q, b))
        || beyond(scene, (q, b), (p, a))
}

/// Whether a node is certainly beyond a side of another's box or slab.
pub(super) fn beyond(scene: &Scene, (p, a): (&Side, &Shade), (q, b): (&Side, &Shade)) -> bool {
    let apart = |axis: DVec3, range: [f64; 2]| {
        let [least, largest] = b.range(q, axis, scene.blur);
        least > range[1] + scene.blur || largest < range[0] - scene.blur
    };
    a.slab[1] < f64::INFINITY && apart(a.axis, a.slab)
        || p.aligned == [false; 3] && (0..3).any(|k| apart(p.view.col(k), a.local_range(p, k)))
}
