//! What two nodes bound: whether any pair of their facets can count, and for how little.
//!
//! A node is looked at in the query frame as a [`Shade`], a box and a slab `low <= n.x <= high` that hold
//! its facets, and how far their normals differ from `n`; and as a [`Profile`], which says besides how
//! far it reaches along the directions of the query's [fan](super::fan). Everything is rounded outwards
//! by the noise of coordinates, except along axes where coordinates are exact: there boxes that touch
//! are told from boxes that overlap, so that zero clearance is cut off high up in the trees.

use glam::{DMat3, DVec3};

use super::fan::Reach;
use super::scene::{Scene, Side};
use crate::body::solid::Shrinking;
use crate::body::solid::cuts::Parts;
use crate::number::error_free::sum_error;

/// Cosine from which on a slab bounds more along an axis than the box does.
const PARALLEL: f64 = 0.75;
/// Slabs steeper than this say little about heights.
const STEEP: f64 = 1e-3;

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
pub(crate) struct Shade {
    pub(crate) node: u32,
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// The box in the body frame, after shrinking.
    pub(crate) local: [DVec3; 2],
    /// The node's axis and its slab.
    pub(crate) axis: DVec3,
    pub(crate) slab: [f64; 2],
    /// The axis' component along the direction, rounded in the body frame.
    along: f64,
    /// Facing can be told if `|along|` reaches this.
    spread: f64,
}

impl Shade {
    pub(crate) fn new(scene: &Scene, side: &Side, at: usize) -> Self {
        let node = &side.solid.nodes()[at];
        let axis = side.view * node.axis;
        let shift = axis.dot(side.view_offset);
        let mut shade = Self {
            node: at as u32,
            low: node.low,
            high: node.high,
            local: [node.low, node.high],
            axis,
            slab: [node.slab[0] + shift - scene.noise, node.slab[1] + shift + scene.noise],
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
        if node.is_open() {
            // What is on edge has a shadow without a width, but counts.
            shade.low -= scene.noise;
            shade.high += scene.noise;
        }
        shade
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

    /// The range of `m.x` over the node, `m` a unit vector.
    fn range(&self, side: &Side, m: DVec3, noise: f64) -> [f64; 2] {
        [self.least_along(side, m, noise), -self.least_along(side, -m, noise)]
    }

    /// The least `m.x` over the node, `m` a unit vector, by its cut box: of what is left of `m` next to
    /// its part along the slab, if that is most of it.
    fn least_along(&self, side: &Side, m: DVec3, noise: f64) -> f64 {
        let along = self.axis.dot(m);
        let (mut rest, mut slab) = (m, 0.0);
        if along.abs() > PARALLEL && self.slab[1] < f64::INFINITY {
            rest -= self.axis * along;
            slab = self.slab[usize::from(along < 0.0)] * along;
        }
        let (local, [low, high]) = (side.view.transpose() * rest, self.local);
        let middle = local.dot((low + high) * 0.5) + rest.dot(side.view_offset);
        let spread = local.abs().dot((high - low) * 0.5) + noise;
        let node = &side.solid.nodes()[self.node as usize];
        let gain = Parts::new(-local).gain_of(&node.cuts, node.high - node.low, side.moved());
        slab + middle - spread + gain
    }

    /// Whether its slab bounds heights.
    fn has_heights(&self) -> bool {
        self.slab[1] < f64::INFINITY && self.axis.z.abs() > STEEP
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
    let extent = extent + scene.noise;
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
    let (sum, error) = (a + b, sum_error(a, b, a + b));
    if exact && (error == 0.0 || (error > 0.0) == (way < 0)) {
        return sum;
    }
    if way < 0 { sum.next_down() } else { sum.next_up() }
}

/// A node as a search compares it.
#[derive(Clone, Copy)]
pub(crate) struct Profile<'s> {
    pub(crate) shade: &'s Shade,
    /// Not asked for where both bodies have the axes of the query: then boxes say as much.
    pub(crate) reach: Option<&'s Reach>,
}

impl Profile<'_> {
    /// No gap with a node of the fixed body is smaller, by the fan.
    fn fanned_gap(self, fixed: Self) -> f64 {
        self.reach.zip(fixed.reach).map_or(f64::NEG_INFINITY, |(a, b)| a.least_gap(b))
    }

    /// Whether the shadows are apart, by the fan.
    fn is_fanned_apart(self, fixed: Self) -> bool {
        self.reach.zip(fixed.reach).is_some_and(|(a, b)| a.is_apart(b))
    }
}

/// Why no pair of facets under two nodes counts for less than `limit`, as far as boxes and facing say;
/// `parting` pairs, with a negative largest gap, are of no interest if so said.
pub(crate) fn dismissed(a: &Shade, b: &Shade, limit: f64, parting: bool) -> Option<Reason> {
    if a.looks_back() {
        return Some(Reason::MovingFacesAway);
    }
    if b.looks_ahead() {
        return Some(Reason::FixedFacesAway);
    }
    if boxes_apart(a, b) {
        return Some(Reason::ShadowsApart);
    }
    let [least, largest] = box_gaps(a, b);
    if least >= limit {
        return Some(Reason::NotBefore);
    }
    (parting && largest < 0.0).then_some(Reason::Parting)
}

/// The least gap that a pair of facets under two nodes can have, as a length.
///
/// # Errors
/// Why no pair of facets counts for less than `limit`.
pub(crate) fn least_gap(
    scene: &Scene,
    p: Profile,
    q: Profile,
    limit: f64,
    parting: bool,
) -> Result<f64, Reason> {
    let (a, b) = (p.shade, q.shade);
    if let Some(reason) = dismissed(a, b, limit, parting) {
        return Err(reason);
    }
    let rough = p.fanned_gap(q).max(box_gaps(a, b)[0]);
    if rough >= limit {
        return Err(Reason::NotBefore);
    }
    if p.is_fanned_apart(q) {
        return Err(Reason::ShadowsApart);
    }
    // Gaps that are not negative do not part: then there is no need to look from above.
    let least = if parting && rough < 0.0 {
        let [least, largest] = slab_gaps(scene, a, b);
        if largest < 0.0 {
            return Err(Reason::Parting);
        }
        least
    } else {
        least_slab_gap(scene, a, b)
    };
    let least = least.max(rough);
    if least >= limit { Err(Reason::NotBefore) } else { Ok(least) }
}

/// Whether a reason to cut a pair of nodes holds, checked by itself; `limit` as for [`least_gap`].
pub(crate) fn holds(scene: &Scene, p: Profile, q: Profile, reason: Reason, limit: f64) -> bool {
    let (a, b) = (p.shade, q.shade);
    match reason {
        Reason::MovingFacesAway => a.looks_back(),
        Reason::FixedFacesAway => b.looks_ahead(),
        Reason::ShadowsApart => boxes_apart(a, b) || p.is_fanned_apart(q),
        Reason::Parting => box_gaps(a, b)[1] < 0.0 || slab_gaps(scene, a, b)[1] < 0.0,
        Reason::NotBefore => {
            let fanned = p.fanned_gap(q);
            fanned.max(box_gaps(a, b)[0]).max(least_slab_gap(scene, a, b)) >= limit
        }
        Reason::Disjoint | Reason::FaceToFace | Reason::Examined => false,
    }
}

/// Whether the interiors of the boxes' shadows are disjoint.
fn boxes_apart(a: &Shade, b: &Shade) -> bool {
    let (low, high) = (a.low.max(b.low), a.high.min(b.high));
    low.x >= high.x || low.y >= high.y
}

/// Bounds of all gaps, by the boxes.
fn box_gaps(a: &Shade, b: &Shade) -> [f64; 2] {
    [b.low.z - a.high.z, b.high.z - a.low.z]
}

/// The same by the slabs: a plane along one bounds the heights of its node, and how far the other is
/// above it.
fn slab_gaps(scene: &Scene, a: &Shade, b: &Shade) -> [f64; 2] {
    let (mut least, mut largest) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut add = |low: f64, high: f64, slope: f64| {
        let inverse = slope.recip();
        least = least.max((low * inverse).min(high * inverse));
        largest = largest.min((low * inverse).max(high * inverse));
    };
    if a.has_heights() {
        let [low, high] = b.range(&scene.fixed, a.axis, 2.0 * scene.noise);
        add(low - a.slab[1], high - a.slab[0], a.axis.z);
    }
    if b.has_heights() {
        let [low, high] = a.range(&scene.moving, b.axis, 2.0 * scene.noise);
        add(b.slab[0] - high, b.slab[1] - low, b.axis.z);
    }
    [least, largest]
}

/// The lower of these bounds.
fn least_slab_gap(scene: &Scene, a: &Shade, b: &Shade) -> f64 {
    let noise = 2.0 * scene.noise;
    let mut least = f64::NEG_INFINITY;
    if a.has_heights() {
        let up = a.axis.z.signum();
        let top = if up > 0.0 { a.slab[1] } else { -a.slab[0] };
        least = (b.least_along(&scene.fixed, a.axis * up, noise) - top) / a.axis.z.abs();
    }
    if b.has_heights() {
        let up = b.axis.z.signum();
        let bottom = if up > 0.0 { b.slab[0] } else { -b.slab[1] };
        let rest = a.least_along(&scene.moving, b.axis * -up, noise);
        least = least.max((rest + bottom) / b.axis.z.abs());
    }
    least
}

/// Whether no point of one node is a point of the other, by boxes and slabs.
pub(crate) fn apart(scene: &Scene, a: &Shade, b: &Shade) -> bool {
    let (p, q) = (&scene.moving, &scene.fixed);
    (0..3).any(|k| a.high[k] < b.low[k] || b.high[k] < a.low[k])
        || beyond(scene, (p, a), (q, b))
        || beyond(scene, (q, b), (p, a))
}

/// Whether a node is certainly beyond a side of another's box or slab.
pub(crate) fn beyond(scene: &Scene, (p, a): (&Side, &Shade), (q, b): (&Side, &Shade)) -> bool {
    let apart = |axis: DVec3, range: [f64; 2]| {
        let [least, largest] = b.range(q, axis, 2.0 * scene.noise);
        least > range[1] + scene.noise || largest < range[0] - scene.noise
    };
    a.slab[1] < f64::INFINITY && apart(a.axis, a.slab)
        || p.aligned == [false; 3] && (0..3).any(|k| apart(p.view.col(k), a.local_range(p, k)))
}
