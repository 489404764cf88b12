//! What two nodes bound: whether any pair of their facets can count, and for how little.
//!
//! A node is looked at in the query frame as a [`Shade`]: a box, a slab `low <= n.x <= high` and a
//! cylinder about `n` that hold its facets, and how far their normals differ from `n`. Everything is rounded outwards by the
//! blur of coordinates, except along axes where coordinates are exact: there boxes that touch are
//! told from boxes that overlap, so that zero clearance is cut off high up in the trees.

use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};

use super::scene::{Scene, Side, sum_error};
use crate::body::solid::Shrinking;

/// Slabs steeper than this say little about heights.
const STEEP: f64 = 1e-3;
/// Slabs less steep than this say little about shadows.
const LEVEL: f64 = 0.1;
/// Rounding of a sine, or of the square of one.
const SINE: f64 = 32.0 * f64::EPSILON;

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
#[derive(Debug, Clone, Copy)]
pub(super) struct Shade {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    /// The box in the body frame, after shrinking.
    local: [DVec3; 2],
    /// The node's axis and its slab.
    pub(super) axis: DVec3,
    pub(super) slab: [f64; 2],
    /// The middle of a cylinder around the node, its axis the node's; a ball where that has none.
    middle: DVec3,
    radius: f64,
    /// Half the cylinder's height.
    thick: f64,
    /// No point of the node has a shadow farther from that of the middle.
    breadth: f64,
    /// The slab over the shadow, if it says something of heights.
    heights: Option<Heights>,
    /// The axis' component along the direction, rounded in the body frame.
    along: f64,
    /// Facing can be told if `|along|` reaches this.
    spread: f64,
}

impl Shade {
    pub(super) fn new(scene: &Scene, side: &Side, at: usize) -> Self {
        let node = &side.solid.nodes()[at];
        let axis = side.view * node.axis;
        let shift = axis.dot(side.view_offset);
        let mut shade = Self {
            low: node.low,
            high: node.high,
            local: [node.low, node.high],
            axis,
            slab: [node.slab[0] + shift - scene.blur, node.slab[1] + shift + scene.blur],
            middle: side.view * ((node.low + node.high) * 0.5) + side.view_offset,
            radius: f64::from(node.radius) + 2.0 * scene.blur,
            thick: 0.0,
            breadth: 0.0,
            heights: None,
            along: node.axis.dot(side.along),
            spread: f64::from(node.spread),
        };
        if let Some(shrinking) = side.shrinking {
            shade.shrink(shrinking, side.amount, at);
        }
        let terms = (node.axis * side.along).abs().element_sum();
        shade.spread +=
            if side.permutes { 2.0 * f64::EPSILON * terms } else { 16.0 * f64::EPSILON };
        (shade.low, shade.high) = boxed(scene, side, shade.local);
        shade.trim();
        shade.breadth = shade.radius + axis.xy().length() * shade.thick;
        shade.heights = Heights::new(scene, &shade);
        shade
    }

    /// Moves the sides inwards as the facets do.
    fn shrink(&mut self, shrinking: &Shrinking, amount: f64, at: usize) {
        let motion = &shrinking.nodes[at];
        let swell = shrinking.farthest * amount.abs();
        self.spread += f64::from(motion.turn) * amount + f64::from(motion.rough);
        self.radius += swell;
        self.local = shrinking.boxed(self.local, amount, at);
        if amount <= shrinking.most {
            self.slab[0] += f64::from(motion.slab[0]) * amount;
            self.slab[1] += f64::from(motion.slab[1]) * amount;
        } else {
            self.slab = [self.slab[0] - swell, self.slab[1] + swell];
        }
    }

    /// Lifts the middle to that of the slab, and cuts from the box what is outside the cylinder: of a
    /// patch that lies aslant in its body's frame, the box is much larger.
    fn trim(&mut self) {
        let mut extent = DVec3::splat(self.radius);
        if self.slab[1] < f64::INFINITY {
            let lift = (self.slab[0] + self.slab[1]) * 0.5 - self.axis.dot(self.middle);
            self.middle += self.axis * lift;
            self.thick = (self.slab[1] - self.slab[0]) * 0.5;
            let squares = self.axis * self.axis;
            let across = squares.yzx() + squares.zxy();
            let sines = DVec3::new(across.x.sqrt(), across.y.sqrt(), across.z.sqrt());
            extent = extent * sines + self.axis.abs() * self.thick + (self.radius * SINE);
        }
        self.low = self.low.max(self.middle - extent);
        self.high = self.high.min(self.middle + extent);
    }

    /// No point of the node is farther from its middle, in the shadow, along a unit vector there.
    fn reach(&self, along: DVec2) -> f64 {
        let rise = self.axis.xy().dot(along);
        if self.slab[1] == f64::INFINITY {
            return self.radius;
        }
        self.radius * (1.0 - rise * rise + SINE).max(0.0).sqrt() + rise.abs() * self.thick
    }

    /// How far points of another node are above this one's slab, along the direction, by the other's
    /// cylinder; `sine` and `cosine` are those of the angle between the axes.
    fn heights_above(&self, other: &Self, inverse: f64, [sine, cosine]: [f64; 2]) -> [f64; 2] {
        let level = self.axis.dot(other.middle);
        let spread = other.radius * sine + other.thick * cosine.abs();
        let (x, y) = (level - spread - self.slab[1], level + spread - self.slab[0]);
        let (x, y) = (x * inverse, y * inverse);
        [x.min(y), x.max(y)]
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

/// The node's box in the query frame: exact along aligned axes, rounded outwards along others.
fn boxed(scene: &Scene, side: &Side, [near, far]: [DVec3; 2]) -> (DVec3, DVec3) {
    let (center, half) = ((near + far) * 0.5, (far - near) * 0.5);
    let middle = side.view * center + side.view_offset;
    let DMat3 { x_axis, y_axis, z_axis } = side.view;
    let extent = x_axis.abs() * half.x + y_axis.abs() * half.y + z_axis.abs() * half.z;
    let extent = extent + scene.blur;
    let (mut low, mut high) = (middle - extent, middle + extent);
    if side.shrinking.is_none() && side.aligned != [false; 3] {
        let rows = side.view.transpose();
        for (k, row) in [rows.x_axis, rows.y_axis, rows.z_axis].into_iter().enumerate() {
            if side.aligned[k] {
                let (a, b) = (row.dot(near), row.dot(far));
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
    if discs_apart(a, b) {
        return Err(Reason::ShadowsApart);
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
    let [least, largest] = gaps(a, b, swept);
    if least >= limit {
        return Err(Reason::NotBefore);
    }
    if parting && largest < 0.0 {
        return Err(Reason::Parting);
    }
    if ellipses_apart(a, b) {
        return Err(Reason::ShadowsApart);
    }
    if a.heights.is_none() || b.heights.is_none() {
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
    let gaps = || gaps(a, b, swept(scene, a, b));
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
                || discs_apart(a, b)
                || ellipses_apart(a, b)
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

/// Whether the shadows of the cylinders are apart, by discs around them.
fn discs_apart(a: &Shade, b: &Shade) -> bool {
    let reach = a.breadth + b.breadth;
    (b.middle - a.middle).xy().length_squared() > reach * reach
}

/// The same, seen along the line of their middles.
fn ellipses_apart(a: &Shade, b: &Shade) -> bool {
    let apart = (b.middle - a.middle).xy();
    let distance = apart.length();
    distance > 0.0 && {
        let along = apart / distance;
        distance > a.reach(along) + b.reach(along)
    }
}

/// What holds a common shadow: a rectangle, and two discs.
struct Region {
    middle: DVec2,
    half: DVec2,
    discs: [(DVec2, f64); 2],
}

impl Region {
    fn new(a: &Shade, b: &Shade) -> Self {
        let (low, high) = (a.low.max(b.low).xy(), a.high.min(b.high).xy());
        let disc = |s: &Shade| (s.middle.xy(), s.breadth);
        Self { middle: (low + high) * 0.5, half: (high - low) * 0.5, discs: [disc(a), disc(b)] }
    }

    /// The range of a linear function over the rectangle.
    fn range(&self, slope: DVec2) -> [f64; 2] {
        let (value, spread) = (slope.dot(self.middle), slope.abs().dot(self.half));
        [value - spread, value + spread]
    }

    /// The same, by the discs too.
    fn fine_range(&self, slope: DVec2) -> [f64; 2] {
        let [mut low, mut high] = self.range(slope);
        let steep = slope.length();
        for (middle, radius) in self.discs {
            let (value, spread) = (slope.dot(middle), steep * radius);
            (low, high) = (low.max(value - spread), high.min(value + spread));
        }
        [low, high]
    }
}

/// Heights of a slab over the shadow: `base[0] + slope.s <= h <= base[1] + slope.s`.
#[derive(Debug, Clone, Copy)]
struct Heights {
    slope: DVec2,
    base: [f64; 2],
    /// One over the axis' component along the direction.
    inverse: f64,
}

impl Heights {
    fn new(scene: &Scene, shade: &Shade) -> Option<Self> {
        let c = shade.axis.z;
        if c.abs() < STEEP || shade.slab[1] == f64::INFINITY {
            return None;
        }
        let inverse = c.recip();
        let (x, y) = (shade.slab[0] * inverse, shade.slab[1] * inverse);
        let slack = scene.blur * inverse.abs();
        let base = [x.min(y) - slack, x.max(y) + slack];
        Some(Self { slope: shade.axis.xy() * -inverse, base, inverse })
    }
}

/// Bounds of all gaps, the best of boxes, slabs and what is known already.
fn gaps(a: &Shade, b: &Shade, swept: [f64; 2]) -> [f64; 2] {
    let region = Region::new(a, b);
    let (p, q) = (a.heights.as_ref(), b.heights.as_ref());
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
        let [low, high] = region.fine_range(q.slope - p.slope);
        least = least.max(q.base[0] - p.base[1] + low);
        largest = largest.min(q.base[1] - p.base[0] + high);
        let angle = [a.axis.cross(b.axis).length(), a.axis.dot(b.axis)];
        let over = a.heights_above(b, p.inverse, angle);
        let under = b.heights_above(a, q.inverse, angle);
        least = least.max(over[0]).max(-under[1]);
        largest = largest.min(over[1]).min(-under[0]);
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
