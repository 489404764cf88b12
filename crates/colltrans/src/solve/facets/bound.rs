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

/// Why a pair of nodes needs no further look.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Reason {
    /// The moving node has no facet that looks along the direction.
    MovingFacesAway,
    /// The fixed node has no facet that looks against the direction.
    FixedFacesAway,
    /// The interiors of the shadows are disjoint.
    ShadowsApart,
    /// The largest gap is negative.
    Parting,
    /// The least gap is not smaller than the answer.
    NotBefore,
}

/// A node in the query frame.
#[derive(Clone, Copy)]
pub(super) struct Shade {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
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
        let node = &side.solid.nodes()[at];
        let [reach, turn, rough] = side.shrinking.map_or([0.0; 3], |s| s.nodes[at].map(f64::from));
        let swell = reach * side.amount.abs() * (1.0 + 1e-9);
        let (low, high) = boxed(scene, side, node, swell);
        let mut spread = f64::from(node.spread) + turn * side.amount.abs();
        if side.amount != 0.0 {
            spread += rough;
        }
        let terms = (node.axis * side.along).abs().element_sum();
        spread += if side.permutes { 2.0 * f64::EPSILON * terms } else { 16.0 * f64::EPSILON };
        let axis = side.view * node.axis;
        let (shift, slack) = (axis.dot(side.view_offset), swell + 4.0 * scene.blur);
        Self {
            low,
            high,
            axis,
            slab: [node.slab[0] + shift - slack, node.slab[1] + shift + slack],
            along: node.axis.dot(side.along),
            spread,
        }
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

/// The node's box in the query frame: exact along aligned axes, rounded outwards along others.
fn boxed(scene: &Scene, side: &Side, node: &Node, swell: f64) -> (DVec3, DVec3) {
    let (center, half) = ((node.low + node.high) * 0.5, (node.high - node.low) * 0.5);
    let middle = side.view * center + side.view_offset;
    let rows = side.view.transpose();
    let extent = DVec3::new(
        rows.x_axis.abs().dot(half),
        rows.y_axis.abs().dot(half),
        rows.z_axis.abs().dot(half),
    ) + DVec3::splat(swell + scene.blur);
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
    let region = Region { middle: (low + high).xy() * 0.5, half: (high - low).xy() * 0.5 };
    let (p, q) = (Heights::new(scene, a), Heights::new(scene, b));
    let [least, largest] = gaps(&region, (a, p.as_ref()), (b, q.as_ref()));
    if least >= limit {
        return Err(Reason::NotBefore);
    }
    if parting && largest < 0.0 {
        return Err(Reason::Parting);
    }
    if p.is_none() || q.is_none() {
        let apart = slab_apart(scene, a, b) || slab_apart(scene, b, a);
        if apart {
            return Err(Reason::ShadowsApart);
        }
    }
    Ok(least)
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
        let slack = 2.0 * scene.blur / c.abs();
        Some(Self { slope: -shade.axis.xy() / c, base: [x.min(y) - slack, x.max(y) + slack] })
    }
}

/// Bounds of all gaps over a region, the best of boxes and slabs.
fn gaps(
    region: &Region,
    (a, p): (&Shade, Option<&Heights>),
    (b, q): (&Shade, Option<&Heights>),
) -> [f64; 2] {
    let [mut least, mut largest] = [b.low.z - a.high.z, b.high.z - a.low.z];
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

/// Whether the shadows are apart along the axis of a slab that is nearly parallel to the direction.
///
/// For a point with shadow `s` and height `h` it is `n.x = m.s + c h`, with `m` the axis' shadow. The
/// other node is bounded by its box, or by its own slab where that is nearly opposite.
fn slab_apart(scene: &Scene, a: &Shade, b: &Shade) -> bool {
    let c = a.axis.z;
    if c.abs() > LEVEL || a.slab[1] == f64::INFINITY {
        return false;
    }
    let m = a.axis.xy();
    let rise = [c * a.low.z, c * a.high.z];
    let low = a.slab[0] - rise[0].max(rise[1]);
    let high = a.slab[1] - rise[0].min(rise[1]);
    let box_of_b = Region { middle: (b.low + b.high).xy() * 0.5, half: (b.high - b.low).xy() * 0.5 };
    let [mut least, mut largest] = box_of_b.range(m);
    if b.slab[1] < f64::INFINITY {
        for sign in [1.0, -1.0] {
            let [x, y] = [sign * b.slab[0], sign * b.slab[1]];
            let lift = [sign * b.axis.z * b.low.z, sign * b.axis.z * b.high.z];
            let [d, e] = box_of_b.range(m - b.axis.xy() * sign);
            least = least.max(x.min(y) - lift[0].max(lift[1]) + d);
            largest = largest.min(x.max(y) - lift[0].min(lift[1]) + e);
        }
    }
    let slack = 8.0 * scene.blur;
    least >= high + slack || largest <= low - slack
}
