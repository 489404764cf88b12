//! Bounds for a pair of nodes: whether any pair of their facets can count, and the least gap that it can have.
//!
//! A node is compared by its [`Projected`] bounds and, as a [`Profile`], by its extents along the query's [separating
//! axes](super::separating_axes).

use glam::DVec3;

use super::projected::Projected;
use super::scene::{PairFrame, PlacedBody, PlacedVertex};
use super::separating_axes::Reach;
use colltrans_convex::body::Aabb;

/// Length ratio above which the facets of a long leaf, instead of its box, are compared with the box of another node.
const MIN_LENGTH_RATIO: f64 = 4.0;

/// Reason in a proof why no two facets of a pair of nodes need to be compared further.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Reason {
    /// No facet of the moving body's node faces along the direction.
    MovingFacesAway,
    /// No facet of the fixed body's node faces against the direction.
    FixedFacesAway,
    /// The interiors of the nodes' shadows are disjoint.
    ShadowsApart,
    /// No gap is positive, and no pair of facets has a gap of zero over its whole common shadow. Therefore no pair
    /// blocks.
    Parting,
    /// The least gap is not smaller than the answer.
    NotBefore,
    /// Both nodes are leaves, and each pair of their facets was compared individually.
    Examined,
    /// The nodes have no point in common at the start. For both roots, only their interiors need to be disjoint.
    Disjoint,
    /// The facets lie in one plane and face each other, so they show no overlap.
    FaceToFace,
}

/// The bounds of a node that a search compares.
#[derive(Clone, Copy)]
pub(crate) struct Profile<'s> {
    pub(crate) projected: &'s Projected,
    /// `None` if both bodies have the axes of the query frame, because boxes give the same bounds then.
    pub(crate) reach: Option<&'s Reach>,
}

impl Profile<'_> {
    /// Returns a lower bound of all gaps with a node of the fixed body, from the separating axes.
    fn gap_along_axes(self, fixed: Self) -> f64 {
        self.reach.zip(fixed.reach).map_or(f64::NEG_INFINITY, |(a, b)| a.least_gap(b))
    }

    /// Checks whether the separating axes show disjoint shadows.
    fn is_apart_along_axes(self, fixed: Self) -> bool {
        self.reach.zip(fixed.reach).is_some_and(|(a, b)| a.is_apart(b))
    }
}

/// Returns the reason why no pair of facets under two nodes has a gap below `limit` that counts; `None` if boxes and
/// facing directions do not show one. If `parting` is set, pairs whose largest gap is negative do not count.
pub(crate) fn dismissal_reason(
    a: &Projected,
    b: &Projected,
    limit: f64,
    parting: bool,
) -> Option<Reason> {
    if a.faces_backward() {
        return Some(Reason::MovingFacesAway);
    }
    if b.faces_forward() {
        return Some(Reason::FixedFacesAway);
    }
    if are_box_shadows_disjoint(a, b) {
        return Some(Reason::ShadowsApart);
    }
    let [least, largest] = box_gaps(a, b);
    if least >= limit {
        return Some(Reason::NotBefore);
    }
    (parting && none_can_block(a, b, largest)).then_some(Reason::Parting)
}

/// Checks whether no pair of facets under two nodes counts, given that their boxes bound all gaps by `largest`. A pair
/// counts if its largest gap is positive, or if its gap is zero over its whole common shadow. If `largest` is 0, a pair
/// that counts has level facets in the plane in which the boxes touch.
fn none_can_block(a: &Projected, b: &Projected, largest: f64) -> bool {
    largest < 0.0 || largest == 0.0 && !(a.may_be_level() && b.may_be_level())
}

/// Computes a lower bound, as a length, of the gaps of all pairs of facets under two nodes.
///
/// # Errors
/// Returns the reason if no pair of facets has a gap below `limit` that counts.
pub(crate) fn least_gap(
    scene: &PairFrame,
    p: Profile,
    q: Profile,
    limit: f64,
    parting: bool,
) -> Result<f64, Reason> {
    let (a, b) = (p.projected, q.projected);
    if let Some(reason) = dismissal_reason(a, b, limit, parting) {
        return Err(reason);
    }
    let rough = p.gap_along_axes(q).max(box_gaps(a, b)[0]);
    if rough >= limit {
        return Err(Reason::NotBefore);
    }
    if p.is_apart_along_axes(q) {
        return Err(Reason::ShadowsApart);
    }
    // If no gap is negative, no slab can show that the pair does not count, so the largest gap is not needed.
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

/// Checks independently of the search whether a reason to cut a pair of nodes is valid; `limit` as in [`least_gap`].
/// Returns `false` for reasons that bounds cannot show.
pub(crate) fn reason_holds(
    scene: &PairFrame,
    p: Profile,
    q: Profile,
    reason: Reason,
    limit: f64,
) -> bool {
    let (a, b) = (p.projected, q.projected);
    match reason {
        Reason::MovingFacesAway => a.faces_backward(),
        Reason::FixedFacesAway => b.faces_forward(),
        Reason::ShadowsApart => are_box_shadows_disjoint(a, b) || p.is_apart_along_axes(q),
        Reason::Parting => {
            none_can_block(a, b, box_gaps(a, b)[1]) || slab_gaps(scene, a, b)[1] < 0.0
        }
        Reason::NotBefore => {
            let along_axes = p.gap_along_axes(q);
            along_axes.max(box_gaps(a, b)[0]).max(least_slab_gap(scene, a, b)) >= limit
        }
        Reason::Disjoint | Reason::FaceToFace | Reason::Examined => false,
    }
}

/// Checks whether the interiors of the boxes' shadows are disjoint.
fn are_box_shadows_disjoint(a: &Projected, b: &Projected) -> bool {
    let (a, b) = (&a.bounds, &b.bounds);
    let (low, high) = (a.low.max(b.low), a.high.min(b.high));
    low.x >= high.x || low.y >= high.y
}

/// Returns bounds on all gaps from the boxes: the least and the largest. If the least one of two bodies is not
/// negative, they do not overlap.
pub(crate) fn box_gaps(a: &Projected, b: &Projected) -> [f64; 2] {
    [b.bounds.low.z - a.bounds.high.z, b.bounds.high.z - a.bounds.low.z]
}

/// Returns bounds on all gaps from the slabs, the least and the largest. A plane parallel to a slab bounds the heights
/// of its node and the height of the other node above it.
fn slab_gaps(scene: &PairFrame, a: &Projected, b: &Projected) -> [f64; 2] {
    let (mut least, mut largest) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut add = |low: f64, high: f64, slope: f64| {
        let inverse = slope.recip();
        least = least.max((low * inverse).min(high * inverse));
        largest = largest.min((low * inverse).max(high * inverse));
    };
    if a.has_heights() {
        let [low, high] = b.range_along(&scene.fixed, a.axis, 2.0 * scene.noise);
        add(low - a.slab[1], high - a.slab[0], a.axis.z);
    }
    if b.has_heights() {
        let [low, high] = a.range_along(&scene.moving, b.axis, 2.0 * scene.noise);
        add(b.slab[0] - high, b.slab[1] - low, b.axis.z);
    }
    [least, largest]
}

/// Returns the lower bound of [`slab_gaps`].
fn least_slab_gap(scene: &PairFrame, a: &Projected, b: &Projected) -> f64 {
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

/// Checks whether two nodes have no point in common, by their boxes, slabs, and the facets of long leaves.
pub(crate) fn are_separated(scene: &PairFrame, a: &Projected, b: &Projected) -> bool {
    let (p, q) = (&scene.moving, &scene.fixed);
    // The boxes in the query frame are compared first, then slabs. If a body does not have the axes of the query frame,
    // the sides of its boxes in its own frame are tested too.
    !a.bounds.intersects(&b.bounds)
        || is_beyond_side(scene, (p, a), (q, b))
        || is_beyond_side(scene, (q, b), (p, a))
        || leaf_avoids(scene, (p, a), (q, b))
        || leaf_avoids(scene, (q, b), (p, a))
}

/// Checks whether the first node is a leaf that is more than [`MIN_LENGTH_RATIO`] times as long as the second node, and
/// whose facets certainly have no point in the box of the second node.
///
/// The box of a long thin facet contains large parts of the other body, for example all teeth of a comb.
fn leaf_avoids(
    scene: &PairFrame,
    (p, leaf): (&PlacedBody, &Projected),
    (q, other): (&PlacedBody, &Projected),
) -> bool {
    let node = &p.solid.nodes()[leaf.node as usize];
    let length = |node: &Projected| node.local.side_lengths().max_element();
    node.is_leaf()
        && length(leaf) > MIN_LENGTH_RATIO * length(other)
        && node.facets().all(|t| facet_avoids(scene, p.corners(t), p.swell, (q, &other.local)))
}

/// Checks whether a plane certainly separates a facet, grown by `swell`, from a box of the other body. The plane is
/// parallel to a side of the box, to the facet, or to an edge of each.
///
/// The transpose of the box's matrix maps the facet to the frame of the box. If the matrix is not exactly a rotation,
/// this moves points by the skew. The margin of four noises covers rounding: less than two for a point of the query
/// frame, whose three coordinates have an error of one noise each, and less than one each for the product with the
/// transpose and for the planes.
fn facet_avoids(
    scene: &PairFrame,
    corners: [PlacedVertex; 3],
    swell: f64,
    (side, bounds): (&PlacedBody, &Aabb),
) -> bool {
    let margin = 4.0 * scene.noise + swell + side.swell + side.skew_bound();
    let (center, half) = (bounds.center(), bounds.side_lengths() * 0.5 + margin);
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

/// Checks whether a node is certainly beyond a side of another node's box or slab. Of two opposite sides only the
/// nearer one is tested.
pub(crate) fn is_beyond_side(
    scene: &PairFrame,
    (p, a): (&PlacedBody, &Projected),
    (q, b): (&PlacedBody, &Projected),
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

    fn any_triangle(most: i16) -> impl Strategy<Value = Solid> {
        let point = (-most..=most, -most..=most, -most..=most);
        let point = point.prop_map(|(x, y, z)| DVec3::from([x, y, z].map(f64::from)));
        [point.clone(), point.clone(), point].prop_filter_map("no area", |corners| {
            Solid::from_open_mesh(&corners, &[[0, 1, 2]]).ok()
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// Long and small triangles with integer coordinates, which often touch. Rotating both together hides the
        /// contact in rounding errors.
        #[test]
        fn a_long_facet_that_avoids_a_box_has_no_point_in_it(
            long in any_triangle(40), small in any_triangle(3), at in [-20..20_i16, -20..20, -20..20],
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
            let scene = cast.with_tolerance(0.0).expect("a tolerance").query_scene();
            let [p, r] = Projected::root_bounds(&scene);
            let sides = [(&scene.moving, &p), (&scene.fixed, &r)];
            let [leaf, other] = if is_moving { sides } else { [sides[1], sides[0]] };
            if leaf_avoids(&scene, leaf, other) {
                prop_assert!(!is_touch(&scene, Overlap::Facets(0, 0)));
            }
        }
    }
}
