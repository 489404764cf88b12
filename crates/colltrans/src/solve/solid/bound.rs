//! What two nodes bound: whether any pair of their facets can count, and for how little.
//!
//! A node is compared by its [`Projected`] bounds, and as a [`Profile`], which says besides how far it
//! reaches along the query's [separating axes](super::separating_axes).

use glam::DVec3;

use super::projected::Projected;
use super::scene::{Scene, Side};
use super::separating_axes::Reach;

/// Why no two facets of a pair of nodes need a further look: what a proof says of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Reason {
    /// No facet of the moving body looks along the direction.
    MovingFacesAway,
    /// No facet of the fixed body looks against the direction.
    FixedFacesAway,
    /// The interiors of their shadows are disjoint.
    ShadowsApart,
    /// No gap is positive, and no two facets have one of zero all over: they part.
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

/// A node as a search compares it.
#[derive(Clone, Copy)]
pub(crate) struct Profile<'s> {
    pub(crate) projected: &'s Projected,
    /// Not asked for where both bodies have the axes of the query: then boxes say as much.
    pub(crate) reach: Option<&'s Reach>,
}

impl Profile<'_> {
    /// No gap with a node of the fixed body is smaller, by the axes.
    fn gap_along_axes(self, fixed: Self) -> f64 {
        self.reach.zip(fixed.reach).map_or(f64::NEG_INFINITY, |(a, b)| a.least_gap(b))
    }

    /// Whether the shadows are apart, by the axes.
    fn is_apart_along_axes(self, fixed: Self) -> bool {
        self.reach.zip(fixed.reach).is_some_and(|(a, b)| a.is_apart(b))
    }
}

/// Why no pair of facets under two nodes counts for less than `limit`, as far as boxes and facing say;
/// `parting` pairs, with a negative largest gap, are of no interest if so said.
pub(crate) fn dismissed(a: &Projected, b: &Projected, limit: f64, parting: bool) -> Option<Reason> {
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
    (parting && parts(a, b, largest)).then_some(Reason::Parting)
}

/// Whether no pair of facets under two nodes counts, whose gaps are at most `largest` by their boxes: none has
/// a positive gap, nor one that is zero all over, which only level facets have where the boxes meet.
fn parts(a: &Projected, b: &Projected, largest: f64) -> bool {
    largest < 0.0 || largest == 0.0 && !(a.may_be_level() && b.may_be_level())
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
    let (a, b) = (p.projected, q.projected);
    if let Some(reason) = dismissed(a, b, limit, parting) {
        return Err(reason);
    }
    let rough = p.gap_along_axes(q).max(box_gaps(a, b)[0]);
    if rough >= limit {
        return Err(Reason::NotBefore);
    }
    if p.is_apart_along_axes(q) {
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
    let (a, b) = (p.projected, q.projected);
    match reason {
        Reason::MovingFacesAway => a.looks_back(),
        Reason::FixedFacesAway => b.looks_ahead(),
        Reason::ShadowsApart => boxes_apart(a, b) || p.is_apart_along_axes(q),
        Reason::Parting => parts(a, b, box_gaps(a, b)[1]) || slab_gaps(scene, a, b)[1] < 0.0,
        Reason::NotBefore => {
            let along_axes = p.gap_along_axes(q);
            along_axes.max(box_gaps(a, b)[0]).max(least_slab_gap(scene, a, b)) >= limit
        }
        Reason::Disjoint | Reason::FaceToFace | Reason::Examined => false,
    }
}

/// Whether the interiors of the boxes' shadows are disjoint.
fn boxes_apart(a: &Projected, b: &Projected) -> bool {
    let (a, b) = (&a.bounds, &b.bounds);
    let (low, high) = (a.low.max(b.low), a.high.min(b.high));
    low.x >= high.x || low.y >= high.y
}

/// Bounds of all gaps, by the boxes. Bodies of whose boxes the first is not negative do not overlap.
pub(crate) fn box_gaps(a: &Projected, b: &Projected) -> [f64; 2] {
    [b.bounds.low.z - a.bounds.high.z, b.bounds.high.z - a.bounds.low.z]
}

/// The same by the slabs: a plane along one bounds the heights of its node, and how far the other is
/// above it.
fn slab_gaps(scene: &Scene, a: &Projected, b: &Projected) -> [f64; 2] {
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
fn least_slab_gap(scene: &Scene, a: &Projected, b: &Projected) -> f64 {
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
pub(crate) fn apart(scene: &Scene, a: &Projected, b: &Projected) -> bool {
    let (p, q) = (&scene.moving, &scene.fixed);
    !a.bounds.meets(&b.bounds) || beyond(scene, (p, a), (q, b)) || beyond(scene, (q, b), (p, a))
}

/// Whether a node is certainly beyond a side of another's box or slab: of two that are opposite, the one nearer to it.
pub(crate) fn beyond(
    scene: &Scene,
    (p, a): (&Side, &Projected),
    (q, b): (&Side, &Projected),
) -> bool {
    let middle = b.bounds.center();
    let apart = |axis: DVec3, [low, high]: [f64; 2]| {
        let above = 2.0 * axis.dot(middle) > low + high;
        let (axis, end) = if above { (axis, high) } else { (-axis, -low) };
        b.is_beyond(q, axis, 2.0 * scene.noise, end + scene.noise)
    };
    a.slab[1] < f64::INFINITY && apart(a.axis, a.slab)
        || p.aligned == [false; 3] && (0..3).any(|k| apart(p.view.col(k), a.local_range(p, k)))
}
