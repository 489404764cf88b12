//! What two nodes bound: whether any pair of their facets can count, and for how little.
//!
//! A node is compared by its [`Projected`] bounds, and as a [`Profile`], which says besides how far it
//! reaches along the query's [separating axes](super::separating_axes).

use glam::DVec3;

use super::projected::Projected;
use super::scene::{Corner, Scene, Side};
use super::separating_axes::Reach;
use colltrans_convex::body::Aabb;

/// The facets of a leaf are compared with the box of another node if the leaf is longer than it by this factor.
const LONG: f64 = 4.0;

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

/// Checks whether no point of one node is a point of the other, by boxes, slabs, and the facets of long leaves.
pub(crate) fn apart(scene: &Scene, a: &Projected, b: &Projected) -> bool {
    let (p, q) = (&scene.moving, &scene.fixed);
    // The boxes of both bodies are boxes of the query frame only where both have its axes.
    !a.bounds.meets(&b.bounds)
        || beyond(scene, (p, a), (q, b))
        || beyond(scene, (q, b), (p, a))
        || leaf_avoids(scene, (p, a), (q, b))
        || leaf_avoids(scene, (q, b), (p, a))
}

/// Checks whether the first node is a leaf, longer than the second node by [`LONG`], whose facets certainly have no
/// point in the box of the second node.
///
/// The box of a long thin facet contains large parts of the other body, for example all teeth of a comb.
fn leaf_avoids(
    scene: &Scene,
    (p, leaf): (&Side, &Projected),
    (q, other): (&Side, &Projected),
) -> bool {
    let node = &p.solid.nodes()[leaf.node as usize];
    let length = |node: &Projected| node.local.size().max_element();
    node.is_leaf()
        && length(leaf) > LONG * length(other)
        && node.facets().all(|t| facet_avoids(scene, p.corners(t), p.swell, (q, &other.local)))
}

/// Checks whether a plane certainly separates a facet, grown by `swell`, from a box of the other body: one that is
/// parallel to a side of the box, to the facet, or to an edge of each.
///
/// The facet is taken to the frame of the box, by the transpose of the box's matrix. Where that matrix is not exactly a
/// rotation, this moves points by the skew. Rounding: a coordinate of the query frame is off by one noise, and three of them
/// move a point by less than two; the product with the transpose and the planes add less than one noise each. Together these
/// are the four noises of the margin.
fn facet_avoids(
    scene: &Scene,
    corners: [Corner; 3],
    swell: f64,
    (side, bounds): (&Side, &Aabb),
) -> bool {
    let margin = 4.0 * scene.noise + swell + side.swell + side.skew();
    let (center, half) = (bounds.center(), bounds.size() * 0.5 + margin);
    let corners = corners.map(|c| side.view.transpose() * (c.at - side.view_offset) - center);
    let separates = |axis: DVec3| {
        let [a, b, c] = corners.map(|p| axis.dot(p));
        // The second term covers products that underflow.
        let reach = axis.abs().dot(half) + f64::MIN_POSITIVE;
        a.min(b).min(c) > reach || a.max(b).max(c) < -reach
    };
    let [a, b, c] = corners;
    let edges = [b - a, c - b, a - c];
    DVec3::AXES.into_iter().any(separates)
        || separates(edges[0].cross(edges[1]))
        || edges.iter().any(|edge| DVec3::AXES.iter().any(|e| separates(e.cross(*edge))))
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
        || p.aligned != [true; 3] && (0..3).any(|k| apart(p.view.col(k), a.local_range(p, k)))
}

#[cfg(test)]
mod tests {
    use glam::DQuat;
    use proptest::prelude::*;

    use super::super::overlap::{Overlap, is_touch};
    use super::*;
    use crate::body::Solid;
    use crate::{SolidCast, SolidScene};
    use colltrans_convex::body::Pose;
    use colltrans_convex::cast::Cast;

    fn triangle(most: i16) -> impl Strategy<Value = Solid> {
        let point = (-most..=most, -most..=most, -most..=most);
        let point = point.prop_map(|(x, y, z)| DVec3::from([x, y, z].map(f64::from)));
        [point.clone(), point.clone(), point].prop_filter_map("no area", |corners| {
            Solid::from_open_mesh(&corners, &[[0, 1, 2]]).ok()
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// Long triangles and small ones, with whole coordinates, that often touch; turned as a whole, so that rounding hides
        /// where they do.
        #[test]
        fn a_long_facet_that_avoids_a_box_has_no_point_in_it(
            long in triangle(40), small in triangle(3), at in [-20..20_i16, -20..20, -20..20],
            q in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0, 0.25..1.0], is_turned: bool, is_moving: bool,
        ) {
            let q = if is_turned { DQuat::from_array(q).normalize() } else { DQuat::IDENTITY };
            let at = DVec3::from(at.map(f64::from));
            let placed = |body, at: DVec3| -> colltrans_convex::Placed<'_, Solid> {
                Solid::at(body, Pose::new(q, q * at).expect("a rotation"))
            };
            let [a, b] = [placed(&long, DVec3::ZERO), placed(&small, at)];
            let [a, b] = if is_moving { [a, b] } else { [b, a] };
            let cast = Cast::new(a, b, q * DVec3::new(0.3, 0.5, 1.0)).expect("a query");
            let scene = cast.with_tolerance(0.0).expect("a tolerance").asked();
            let [p, r] = Projected::roots(&scene);
            let sides = [(&scene.moving, &p), (&scene.fixed, &r)];
            let [leaf, other] = if is_moving { sides } else { [sides[1], sides[0]] };
            if leaf_avoids(&scene, leaf, other) {
                prop_assert!(!is_touch(&scene, Overlap::Facets(0, 0)));
            }
        }
    }
}
