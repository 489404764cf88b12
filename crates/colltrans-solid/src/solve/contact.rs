//! From a pair of facets to a contact: points, normal, features, and the translation with bounds.
//!
//! - [`SolidContact::offset_distance`] is the travel of the offset bodies. The pair's gap plus its error is the upper
//!   bound. The lower bound also covers all other pairs ([`LeastGap::others`]).
//! - [`SolidContact::translation`] is the travel at which the same two facets meet in nominal position.
//! - Up to its `lower` the offset bodies do not overlap, which is proven, and the two facets have not met. Beyond its
//!   `upper` the bodies overlap.
//! - Other facets of the nominal bodies may overlap earlier by less than the tolerance, and these overlaps are not
//!   reported.
//! - Without a tolerance both numbers and their bounds are equal.
//!
//! Derivation of the bounds: `docs/theory/solid-contact.md`.

use std::cmp::Ordering;

use glam::DVec3;

use super::edge_on;
use super::leaf::{Gap, Meeting, Opposed, listed, nearest_after};
use super::scene::{PairFrame, PlacedBody, PlacedVertex};
use super::search::{Aim, LeastGap, exact_gap_of};
use crate::body::Solid;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::Bounded;
use colltrans_convex::body::Feature;

/// The contact that blocks a solid.
///
/// The contact points belong to the nominal bodies. Their weights with respect to the corners of the facets are those
/// of the points where the offset bodies touch. At [`Self::translation`] they coincide along the normal. Laterally they
/// may differ by the displacement of the offset. Points of rounded bodies are those of the cores, moved by the radius
/// along the normal.
///
/// The feature of a body is chosen among those that contain the contact point: the face that lies in the contact plane,
/// otherwise the edge that does, otherwise the smallest of a corner, an edge or a face.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidContact {
    /// Translation at which the blocking facets of the offset bodies meet in nominal position, in multiples of the
    /// direction. It is negative if these facets overlap in nominal position, and for contacts behind the start, of
    /// [`Cast::first_contact`](colltrans_convex::Cast::first_contact).
    ///
    /// Up to `lower` the offset bodies do not overlap, and these facets have not met. Beyond `upper` the nominal bodies
    /// overlap if these facets meet in nominal position. Otherwise the offset bodies overlap there, and so do the
    /// nominal ones if the offset only removed material ([`Solid::shrink_report`](crate::Solid::shrink_report)).
    pub translation: Bounded,
    /// Travel of the bodies that are offset by half the tolerance each, in multiples of the direction. It exceeds the
    /// translation by about the tolerance, and equals it without a tolerance.
    pub offset_distance: Bounded,
    /// Unit contact normal in the world, from the moving body to the fixed one; `normal . direction > 0`. If corners or
    /// parallel edges meet, it is one of several normals.
    pub normal: DVec3,
    /// Contact point on the nominal moving body, in the world, at its start pose.
    pub point_on_moving: DVec3,
    /// Contact point on the nominal fixed body, in the world; one of many if edges or facets meet.
    pub point_on_fixed: DVec3,
    /// Feature of the moving body at the contact, numbered as in its input.
    pub moving_feature: Feature,
    /// Feature of the fixed body at the contact, numbered as in its input.
    pub fixed_feature: Feature,
    /// The triangles in contact, as positions in [`Solid::triangles`](crate::Solid::triangles).
    pub triangles: [u32; 2],
    /// Work done for the answer that contains this contact.
    pub steps: SolidSteps,
}

impl SolidContact {
    /// Returns the translation of the last contact along the direction, if this is the first contact of a
    /// [reversed](colltrans_convex::Cast::reversed) cast; in multiples of the direction. Beyond `upper` the bodies
    /// never meet.
    pub fn exit(&self) -> Bounded {
        self.translation.negated()
    }
}

/// A point of a facet, given by the weights of its corners.
struct FacetPoint {
    vertices: [u32; 3],
    weights: DVec3,
}

impl FacetPoint {
    /// Returns the point of the nominal body in the setting frame.
    fn nominal_point(&self, side: &PlacedBody) -> DVec3 {
        let local = self.weighted_mean(|v| side.solid.vertices()[v as usize]);
        side.matrix * local + side.offset[0]
    }

    /// Returns the displacement of the point by the offset, in the setting frame.
    fn offset_displacement(&self, side: &PlacedBody) -> DVec3 {
        let Some(shrinking) = side.shrinking else { return DVec3::ZERO };
        side.matrix * self.weighted_mean(|v| shrinking.displacements[v as usize] * side.amount)
    }

    fn weighted_mean(&self, value: impl Fn(u32) -> DVec3) -> DVec3 {
        let [a, b, c] = self.vertices.map(value);
        a * self.weights.x + b * self.weights.y + c * self.weights.z
    }
}

impl LeastGap {
    /// Returns the gap as a translation with its bounds; see the head of the module.
    pub(crate) fn bounded(&self, scene: &PairFrame) -> Bounded {
        bounded_gap(scene, (self.gap, self.error), self.others)
    }
}

/// Converts a gap with its error to a translation with bounds, given a lower bound `others` of all other gaps.
fn bounded_gap(scene: &PairFrame, (gap, error): (f64, f64), others: f64) -> Bounded {
    let lower = others.min(gap - error) - scene.noise;
    let upper = gap + error + scene.noise;
    let [value, lower, upper] = [gap, lower, upper].map(|length| length / scene.setting.length);
    Bounded { value, lower, upper }
}

/// Builds the contact of two facets that a search in `scene` has found. `offset_distance` is the translation, in
/// multiples of the direction, at which the offset bodies meet, with its bounds.
pub(crate) fn contact_of_facets(
    scene: &PairFrame,
    found: &LeastGap,
    offset_distance: Bounded,
    steps: SolidSteps,
) -> SolidContact {
    let origin = scene.setting.translations[0];
    let (moving, fixed) = (&scene.moving, &scene.fixed);
    let of_f = ListedTriangle::new(scene, moving, found.moving);
    let of_g = ListedTriangle::new(scene, fixed, found.fixed);
    let (p, q) = (of_f.places, of_g.places);
    let gap = DVec3::Z * found.gap;
    let (on_f, on_g, normal) = match found.at {
        Meeting::Corner(k) => {
            let within = of_f.is_within_face(moving.solid, k as usize);
            (
                corner_weights(k),
                weights_below_or_above(q, p[k as usize] + gap),
                plane_normal(if within { p } else { q }),
            )
        }
        Meeting::Under(k) => {
            let within = of_g.is_within_face(fixed.solid, k as usize);
            (
                weights_below_or_above(p, q[k as usize] - gap),
                corner_weights(k),
                plane_normal(if within { q } else { p }),
            )
        }
        Meeting::Sides(k, j) => {
            let (k, j) = (k as usize, j as usize);
            let (a, b) = ([p[k], p[(k + 1) % 3]], [q[j], q[(j + 1) % 3]]);
            let (s, t) = crossing_positions(a, b);
            // A side or corner that lies within a face makes contact with the face.
            let flats = (of_f.is_flat(moving.solid, k), of_g.is_flat(fixed.solid, j));
            let normal = match flats {
                (_, true) => plane_normal(q),
                (true, _) => plane_normal(p),
                _ => (a[1] - a[0]).cross(b[1] - b[0]),
            };
            (side_weights(k, s), side_weights(j, t), normal * normal.z.signum())
        }
        Meeting::OnSide(k, j) => {
            let side = [q[j as usize], q[(j as usize + 1) % 3]];
            (
                corner_weights(k),
                side_weights(j as usize, position_on_side(side, p[k as usize])),
                side_plane_normal(side),
            )
        }
        Meeting::UnderSide(k, j) => {
            let side = [p[k as usize], p[(k as usize + 1) % 3]];
            (
                side_weights(k as usize, position_on_side(side, q[j as usize])),
                corner_weights(j),
                side_plane_normal(side),
            )
        }
        Meeting::Near => {
            let corners = [&of_f, &of_g].map(|of| of.corners);
            // Only pairs with a minimum gap have this kind of contact.
            let near = scene
                .has_min_gap()
                .then(|| nearest_after(scene, &corners[0], &corners[1], found.gap));
            let (weights, normal) = near.unwrap_or_default();
            (weights[0], weights[1], scene.frame * normal)
        }
    };
    let on_f = FacetPoint { vertices: of_f.vertices, weights: on_f };
    let on_g = FacetPoint { vertices: of_g.vertices, weights: on_g };
    let normal = (scene.frame.transpose() * normal).normalize_or_zero();
    let translation = if moving.amount == 0.0 && fixed.amount == 0.0 {
        offset_distance
    } else {
        let shift = on_f.offset_displacement(moving) - on_g.offset_displacement(fixed);
        let pair = [found.moving, found.fixed];
        nominal_translation(&scene.with_offsets(0.0, 0.0), pair, offset_distance, normal, shift)
    };
    let named = |side: &PlacedBody, triangle, foot: &FacetPoint| {
        let at = foot.weighted_mean(|v| side.solid.vertices()[v as usize]);
        feature_at(side.solid, triangle, (at, side.matrix.transpose() * normal), scene.noise)
    };
    let cores = [on_f.nominal_point(moving), on_g.nominal_point(fixed)];
    let [point_on_moving, point_on_fixed] = scene.setting.surface_points_along(cores, normal);
    SolidContact {
        translation,
        offset_distance,
        normal,
        point_on_moving: point_on_moving + origin,
        point_on_fixed: point_on_fixed + origin,
        moving_feature: named(moving, found.moving, &on_f),
        fixed_feature: named(fixed, found.fixed, &on_g),
        triangles: [found.moving, found.fixed],
        steps,
    }
}

/// Maximum shortfall, in noises, of the approximate lower bound below the nominal translation. If it is exceeded, the
/// bound is computed again, exactly.
const MAX_SHORTFALL: f64 = 64.0;
/// Cosine of the contact normal and the direction at or below which the contact is not moved back along its plane.
const MIN_COSINE: f64 = 1e-3;

/// Computes the translation at which the facets of a contact of offset bodies meet in nominal position. `bare` is the
/// scene without offsets, and `shift` the displacement, by the offset, of the moving contact point relative to the
/// fixed one.
pub(crate) fn nominal_translation(
    bare: &PairFrame,
    pair: [u32; 2],
    shrunk: Bounded,
    normal: DVec3,
    shift: DVec3,
) -> Bounded {
    let known = |gap: (f64, f64)| {
        let place = bounded_gap(bare, gap, gap.0);
        Bounded { lower: place.lower.min(shrunk.lower), ..place }
    };
    let facets = Opposed::new(bare, pair);
    let gap = facets.as_ref().and_then(|facets| facets.least_gap(bare));
    if bare.has_min_gap() {
        return gap.map_or(shrunk, known);
    }
    if let Some(gap) = gap.or_else(|| edge_on::least_gap_of(bare, &Gap::counts, pair)) {
        return known(gap);
    }
    let slope = normal.dot(bare.setting.direction);
    // Two planes nearly parallel to the direction carry no information about where the bodies meet.
    let steep = slope <= MIN_COSINE * bare.setting.length;
    let noise = bare.noise / bare.setting.length;
    let [back, error] =
        if steep { [0.0, noise] } else { [normal.dot(shift), bare.noise].map(|x| x / slope) };
    let value = (shrunk.value + back).min(shrunk.value);
    let least = if let Some(facets) = facets {
        let in_doubt = facets.least_in_doubt(bare) / bare.setting.length;
        if in_doubt >= value - MAX_SHORTFALL * noise {
            in_doubt
        } else if let Some(gap) = exact_gap_of(bare, Aim::Stop, &facets) {
            return known(gap);
        } else {
            first_meeting_bound(bare, pair)
        }
    } else {
        first_meeting_bound(bare, pair)
    };
    let lower = (least - noise).min(value - error).min(shrunk.lower);
    Bounded { value, lower, upper: shrunk.upper }
}

/// Maximum distance, in noises, of the origin from a shadow that counts as containing it: the error of differences of
/// corners.
const DIFFERENCE_ERROR: f64 = 4.0;
/// Width of a shadow, in multiples of [`DIFFERENCE_ERROR`] noises, at or below which it counts as a segment.
const MIN_WIDTH: f64 = 64.0;

/// Returns a lower bound of the translation at which two triangles meet, whichever way they face; infinity if they
/// never meet.
///
/// The line through the origin along the direction meets the convex hull of the differences of their corners first at
/// its lowest point in the hull. This point lies in one of the triangles of three differences, or in one of its sides
/// if its shadow is too narrow.
fn first_meeting_bound(bare: &PairFrame, pair: [u32; 2]) -> f64 {
    let corners = |side: &PlacedBody, t: u32| side.corners(t as usize).map(|corner| corner.at);
    let (f, g) = (corners(&bare.moving, pair[0]), corners(&bare.fixed, pair[1]));
    let difference = |k: usize| g[k % 3] - f[k / 3];
    let (mut least, off) = (f64::INFINITY, DIFFERENCE_ERROR * bare.noise);
    for a in 0..9 {
        for b in a + 1..9 {
            for c in b + 1..9 {
                least = least.min(triangle_height_bound([a, b, c].map(difference), off));
            }
        }
    }
    least / bare.setting.length
}

/// Returns a lower bound of the height of a triangle above the origin; infinity if the origin is farther than `off`
/// from its shadow.
fn triangle_height_bound(corners: [DVec3; 3], off: f64) -> f64 {
    let flat = corners.map(DVec3::truncate);
    let side = |k: usize| flat[(k + 2) % 3] - flat[(k + 1) % 3];
    let longest = (0..3).map(|k| side(k).length()).fold(0.0, f64::max);
    let whole = side(2).perp_dot(flat[2] - flat[0]);
    let width = whole.abs() / longest;
    if longest == 0.0 || width <= MIN_WIDTH * off {
        let of_side =
            |k: usize| segment_height_bound(corners[(k + 1) % 3], corners[(k + 2) % 3], off);
        return (0..3).map(of_side).fold(f64::INFINITY, f64::min);
    }
    // Twice the area of the origin and the side opposite to corner `k`. It determines the weight of the corner, and the
    // distance of the origin from that side.
    let area = |k: usize| flat[(k + 1) % 3].perp_dot(flat[(k + 2) % 3]) * whole.signum();
    if (0..3).any(|k| area(k) < -off * side(k).length()) {
        return f64::INFINITY;
    }
    let height: f64 = (0..3).map(|k| area(k) / whole.abs() * corners[k].z).sum();
    let [low, high] = height_range(&corners);
    height - off - 2.0 * off / width * (high - low)
}

/// Returns a lower bound of the height, above the origin, of a segment and all points of a narrow triangle around it;
/// infinity if the origin is too far from its shadow.
fn segment_height_bound(a: DVec3, b: DVec3, off: f64) -> f64 {
    let near = (MIN_WIDTH + DIFFERENCE_ERROR) * off;
    let along = (b - a).truncate();
    let length = along.length();
    let [low, high] = height_range(&[a, b]);
    if length <= 4.0 * near {
        let is_near = a.truncate().length().min(b.truncate().length()) <= 5.0 * near;
        return if is_near { low - off } else { f64::INFINITY };
    }
    let unit = along / length;
    let (at, beside) = (-unit.dot(a.truncate()), unit.perp_dot(a.truncate()));
    if beside.abs() > near || at < -near || at > length + near {
        return f64::INFINITY;
    }
    let share = (at / length).clamp(0.0, 1.0);
    a.z + share * (b.z - a.z) - off - 2.0 * near / length * (high - low)
}

/// Returns the least and the largest height.
fn height_range(points: &[DVec3]) -> [f64; 2] {
    let ends = |[low, high]: [f64; 2], v: &DVec3| [low.min(v.z), high.max(v.z)];
    points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], ends)
}

/// Returns a normal of the plane through three points.
fn plane_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// A triangle with its corners in the order of [`listed`].
struct ListedTriangle {
    triangle: u32,
    vertices: [u32; 3],
    corners: [PlacedVertex; 3],
    places: [DVec3; 3],
    /// Orientation of the shadow in the original order of the corners.
    turn: Ordering,
}

impl ListedTriangle {
    fn new(scene: &PairFrame, side: &PlacedBody, triangle: u32) -> Self {
        let (corners, turn) = listed(scene, side, triangle as usize);
        let mut vertices = side.solid.triangles()[triangle as usize];
        if turn == Ordering::Less {
            vertices.swap(1, 2);
        }
        Self { triangle, vertices, corners, places: corners.map(|c| c.at), turn }
    }

    /// Checks whether corner `k` lies within the face, and the face is not edge-on.
    fn is_within_face(&self, solid: &Solid, k: usize) -> bool {
        self.turn != Ordering::Equal && solid.is_within_face(self.vertices[k], self.triangle)
    }

    /// Checks whether the side from corner `k` to the next one lies within the face, and the face is not edge-on.
    fn is_flat(&self, solid: &Solid, k: usize) -> bool {
        let own = if self.turn == Ordering::Less { 2 - k } else { k };
        self.turn != Ordering::Equal && !solid.is_sharp(self.triangle, own)
    }
}

/// Returns the position along a side, from 0 to 1, of the point whose shadow is that of `p`. The side must not be
/// vertical.
fn position_on_side([a, b]: [DVec3; 2], p: DVec3) -> f64 {
    let (u, v) = ((b - a).truncate(), (p - a).truncate());
    (v.dot(u) / u.length_squared()).clamp(0.0, 1.0)
}

/// Returns the normal of a side in the plane that contains the side and the direction.
fn side_plane_normal([a, b]: [DVec3; 2]) -> DVec3 {
    let u = (b - a).normalize_or_zero();
    DVec3::Z - u * u.z
}

fn corner_weights(k: u8) -> DVec3 {
    DVec3::AXES[k as usize]
}

fn side_weights(k: usize, s: f64) -> DVec3 {
    let mut weights = [0.0; 3];
    (weights[k], weights[(k + 1) % 3]) = (1.0 - s, s);
    DVec3::from_array(weights)
}

/// Returns the weights of the point of a triangle below or above `p`, whose shadow lies in that of the triangle up to
/// rounding errors.
fn weights_below_or_above([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let flat = |u: DVec3, v: DVec3| u.truncate().perp_dot(v.truncate());
    let normal = (b - a).cross(c - a);
    let steep = flat(b - a, c - a) == 0.0;
    // The rounded shadow of a facet that is nearly edge-on may have no area.
    let area = |u: DVec3, v: DVec3| if steep { u.cross(v).dot(normal) } else { flat(u, v) };
    let whole = area(b - a, c - a);
    let (v, w) = (area(p - a, c - a) / whole, area(b - a, p - a) / whole);
    // Rounding errors may move a boundary point out of the triangle.
    let (v, w) = (v.clamp(0.0, 1.0), w.clamp(0.0, 1.0));
    let excess = (v + w).max(1.0);
    DVec3::new(1.0 - (v + w) / excess, v / excess, w / excess)
}

/// Returns the positions, from 0 to 1 along each segment, where the shadows of two segments cross.
fn crossing_positions(a: [DVec3; 2], b: [DVec3; 2]) -> (f64, f64) {
    let flat = |v: DVec3| v.truncate();
    let (u, v, w) = (flat(a[1] - a[0]), flat(b[1] - b[0]), flat(b[0] - a[0]));
    let whole = u.perp_dot(v);
    let share = |x: f64| if whole == 0.0 { 0.5 } else { (x / whole).clamp(0.0, 1.0) };
    (share(w.perp_dot(v)), share(w.perp_dot(u)))
}

/// Returns the feature of a solid at a point of a triangle with the given normal, both in the body frame. The slack is
/// the precision of the body's coordinates plus rounding.
pub(crate) fn feature_at(
    solid: &Solid,
    triangle: u32,
    (at, normal): (DVec3, DVec3),
    noise: f64,
) -> Feature {
    solid.feature_at(triangle, at, normal, 2.0 * solid.coordinate_precision() + noise)
}
