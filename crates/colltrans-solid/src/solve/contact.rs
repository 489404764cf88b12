//! From a pair of facets to a contact: points, normal, features, and where it is, with bounds.
//!
//! Two numbers say how far a body goes that was shrunk, each with its bounds; without a tolerance they
//! are one.
//!
//! *The shrunk bodies.* A search ends with a pair of facets whose gap `v` is off by at most its own
//! error `e`, so that `v + e` is an upper bound. Below, all other pairs were left out for one of two
//! reasons. Either their own gap, less its error, or that of a pair that was the best before, is at
//! least a number that the search has kept ([`Found::others`]); or a bound, of nodes or of the facets,
//! was not less than the limit of that time, which was not less than the last one, and bounds of nodes
//! are off by less than [`node_rounding`](super::search::node_rounding). The least of the three, less one
//! noise, which is more than what the roundings of these few operations and of the division by the
//! direction's length can be (some `8 u S` of `32 u S`), is the lower bound.
//!
//! *The true place.* The same two facets are looked at once more, as they are. Where they face each
//! other and their shadows overlap, for certain, their gap is where they meet, to within its error,
//! and from there on the bodies as they are overlap. Where they do not (the floor of a pocket grows
//! when its walls are moved back, so that facets at its rim may pass each other as they are), or
//! where rounding cannot tell in poses that turn, the place is that of their planes at the contact
//! point, unless these are all but on edge. Then all that is known from above is that the shrunk bodies
//! overlap beyond their own upper bound, and from below that the two facets do not meet before the least
//! gap at any corner that their common shadow may have ([`Opposed::least_in_doubt`]); where that says too
//! little, whole numbers decide after all. Facets that do not look at each other may still meet: no lower bound is larger
//! than where they do, in rounded numbers. Nor is it larger than that of the shrunk bodies.
//!
//! So, of [`SolidContact::translation`]: up to `lower` the shrunk bodies do not overlap, which is
//! proven, and those two facets have not met; beyond `upper` the bodies overlap. Nothing is said of other facets of the
//! bodies as they are: that they may overlap on the way by less than the tolerance is what a tolerance
//! is for. Without one, both bounds are those of the bodies as given.

use std::cmp::Ordering;

use glam::DVec3;

use super::leaf::{Gap, Meeting, Opposed, listed, nearest_after};
use super::rim;
use super::scene::{Corner, Scene, Side};
use super::search::{Aim, Found, exact_gap_of};
use crate::body::Solid;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::Bounded;
use colltrans_convex::body::Feature;

/// Where a solid is stopped.
///
/// Points are those of the bodies as they are, not shrunk: the same shares of the facets' corners as
/// where the shrunk bodies touch. They come together at [`Self::translation`], along the normal, and
/// sideways to within what shrinking has moved them.
///
/// What of a body meets there: of all that holds the contact point the face that lies in the contact
/// plane, else the edge that does, else the smallest, be it a corner, an edge or a face.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidContact {
    /// Where the facets that stop the shrunk bodies meet in their true place, in multiples of the
    /// direction: 7 for a head that stops at 7. Negative where these facets, as they are, overlap, and
    /// for contacts behind, of [`Cast::first_contact`](colltrans_convex::Cast::first_contact).
    ///
    /// Up to `lower` the shrunk bodies do not overlap, and these facets have not met; beyond `upper` the
    /// bodies overlap: as they are, where these facets meet; else shrunk, and so as they are, if
    /// shrinking took nothing but material away ([`Solid::shrink_report`](crate::Solid::shrink_report)).
    pub translation: Bounded,
    /// How far the bodies go that were shrunk by half the tolerance each, in multiples of the direction:
    /// beyond the translation by about the tolerance. Without a tolerance it is the same.
    pub shrunk_distance: Bounded,
    /// Unit contact normal in the world, from the moving body to the fixed one;
    /// `normal . direction > 0`. Where corners meet, or parallel edges, it is one of several.
    pub normal: DVec3,
    /// Contact point on the moving body as it is, in the world, at its start pose.
    pub point_on_moving: DVec3,
    /// Contact point on the fixed body as it is, in the world; one of many where edges or facets meet.
    pub point_on_fixed: DVec3,
    /// What of the moving body meets there, by the numbers of its input.
    pub moving_feature: Feature,
    /// What of the fixed body meets there, by the numbers of its input.
    pub fixed_feature: Feature,
    /// The triangles, as positions in [`Solid::triangles`](crate::Solid::triangles).
    pub triangles: [u32; 2],
    /// Work done for the answer that it is of.
    pub steps: SolidSteps,
}

impl SolidContact {
    /// Of the first contact of a [reversed](colltrans_convex::Cast::reversed) cast: where the bodies meet last
    /// along the direction itself, in multiples of it. Beyond `upper` they never meet.
    pub fn exit(&self) -> Bounded {
        self.translation.negated()
    }
}

/// A point of one facet, by the weights of its corners.
struct Foot {
    vertices: [u32; 3],
    weights: DVec3,
}

impl Foot {
    /// The point of the body as it is, in the setting frame.
    fn point(&self, side: &Side) -> DVec3 {
        let local = self.mean(|v| side.solid.vertices()[v as usize]);
        side.matrix * local + side.offset[0]
    }

    /// How far shrinking has moved it, in the setting frame.
    fn displacement(&self, side: &Side) -> DVec3 {
        let Some(shrinking) = side.shrinking else { return DVec3::ZERO };
        side.matrix * self.mean(|v| shrinking.field[v as usize] * side.amount)
    }

    fn mean(&self, value: impl Fn(u32) -> DVec3) -> DVec3 {
        let [a, b, c] = self.vertices.map(value);
        a * self.weights.x + b * self.weights.y + c * self.weights.z
    }
}

impl Found {
    /// The gap as a translation with its bounds; see the module's head.
    pub(crate) fn bounded(&self, scene: &Scene) -> Bounded {
        bounded(scene, (self.gap, self.error), self.others)
    }
}

/// A gap up to its error, all others being at least `others`, as a translation.
fn bounded(scene: &Scene, (gap, error): (f64, f64), others: f64) -> Bounded {
    let lower = others.min(gap - error) - scene.noise;
    let upper = gap + error + scene.noise;
    let [value, lower, upper] = [gap, lower, upper].map(|length| length / scene.setting.length);
    Bounded { value, lower, upper }
}

/// The contact of a search with the bodies as `scene` has them, which ended at `shrunk_distance`.
pub(crate) fn contact(
    scene: &Scene,
    found: &Found,
    shrunk_distance: Bounded,
    steps: SolidSteps,
) -> SolidContact {
    let origin = scene.setting.translations[0];
    let (moving, fixed) = (&scene.moving, &scene.fixed);
    let of_f = Listed::new(scene, moving, found.moving);
    let of_g = Listed::new(scene, fixed, found.fixed);
    let (p, q) = (of_f.places, of_g.places);
    let gap = DVec3::Z * found.gap;
    let (on_f, on_g, normal) = match found.at {
        Meeting::Corner(k) => {
            let within = of_f.is_within_face(moving.solid, k as usize);
            (corner(k), over(q, p[k as usize] + gap), plane(if within { p } else { q }))
        }
        Meeting::Under(k) => {
            let within = of_g.is_within_face(fixed.solid, k as usize);
            (over(p, q[k as usize] - gap), corner(k), plane(if within { q } else { p }))
        }
        Meeting::Sides(k, j) => {
            let (k, j) = (k as usize, j as usize);
            let (a, b) = ([p[k], p[(k + 1) % 3]], [q[j], q[(j + 1) % 3]]);
            let (s, t) = meeting(a, b);
            // What is no edge, or no corner, but within a face touches with that.
            let flats = (of_f.is_flat(moving.solid, k), of_g.is_flat(fixed.solid, j));
            let normal = match flats {
                (_, true) => plane(q),
                (true, _) => plane(p),
                _ => (a[1] - a[0]).cross(b[1] - b[0]),
            };
            (along(k, s), along(j, t), normal * normal.z.signum())
        }
        Meeting::OnSide(k, j) => {
            let side = [q[j as usize], q[(j as usize + 1) % 3]];
            (corner(k), along(j as usize, share(side, p[k as usize])), upright(side))
        }
        Meeting::UnderSide(k, j) => {
            let side = [p[k as usize], p[(k as usize + 1) % 3]];
            (along(k as usize, share(side, q[j as usize])), corner(j), upright(side))
        }
        Meeting::Near => {
            let corners = [&of_f, &of_g].map(|of| of.corners);
            // Without a gap nothing is met so.
            let near =
                scene.keeps().then(|| nearest_after(scene, &corners[0], &corners[1], found.gap));
            let (weights, normal) = near.unwrap_or_default();
            (weights[0], weights[1], scene.frame * normal)
        }
    };
    let on_f = Foot { vertices: of_f.vertices, weights: on_f };
    let on_g = Foot { vertices: of_g.vertices, weights: on_g };
    let normal = (scene.frame.transpose() * normal).normalize_or_zero();
    let translation = if moving.amount == 0.0 && fixed.amount == 0.0 {
        shrunk_distance
    } else {
        let shift = on_f.displacement(moving) - on_g.displacement(fixed);
        let pair = [found.moving, found.fixed];
        true_place(&scene.shrunk(0.0, 0.0), pair, shrunk_distance, normal, shift)
    };
    let named = |side: &Side, triangle, foot: &Foot| {
        let at = foot.mean(|v| side.solid.vertices()[v as usize]);
        feature(side.solid, triangle, (at, side.matrix.transpose() * normal), scene.noise)
    };
    SolidContact {
        translation,
        shrunk_distance,
        normal,
        point_on_moving: on_f.point(moving) + origin,
        point_on_fixed: on_g.point(fixed) + origin,
        moving_feature: named(moving, found.moving, &on_f),
        fixed_feature: named(fixed, found.fixed, &on_g),
        triangles: [found.moving, found.fixed],
        steps,
    }
}

/// Roundings by which a lower bound of the true place may be less than the place without being taken again.
const ENOUGH: f64 = 64.0;
/// Slope, of a contact plane against the direction, up to which it is not moved back.
const STEEPEST: f64 = 1e-3;

/// Where the facets of a contact of shrunk bodies meet as they are, in `bare`; `shift` is what shrinking
/// has moved the one contact point against the other.
pub(crate) fn true_place(
    bare: &Scene,
    pair: [u32; 2],
    shrunk: Bounded,
    normal: DVec3,
    shift: DVec3,
) -> Bounded {
    let known = |gap: (f64, f64)| {
        let place = bounded(bare, gap, gap.0);
        Bounded { lower: place.lower.min(shrunk.lower), ..place }
    };
    let facets = Opposed::new(bare, pair);
    let gap = facets.as_ref().and_then(|facets| facets.least_gap(bare));
    if bare.keeps() {
        return gap.map_or(shrunk, known);
    }
    if let Some(gap) = gap.or_else(|| rim::least_gap_of(bare, &Gap::counts, pair)) {
        return known(gap);
    }
    let slope = normal.dot(bare.setting.direction);
    // Along planes that are all but on edge their meeting says nothing of the bodies.
    let steep = slope <= STEEPEST * bare.setting.length;
    let noise = bare.noise / bare.setting.length;
    let [back, error] =
        if steep { [0.0, noise] } else { [normal.dot(shift), bare.noise].map(|x| x / slope) };
    let value = (shrunk.value + back).min(shrunk.value);
    let least = if let Some(facets) = facets {
        let in_doubt = facets.least_in_doubt(bare) / bare.setting.length;
        if in_doubt >= value - ENOUGH * noise {
            in_doubt
        } else if let Some(gap) = exact_gap_of(bare, Aim::Stop, &facets) {
            return known(gap);
        } else {
            first_meeting(bare, pair)
        }
    } else {
        first_meeting(bare, pair)
    };
    let lower = (least - noise).min(value - error).min(shrunk.lower);
    Bounded { value, lower, upper: shrunk.upper }
}

/// How far the origin may be beyond what is told to hold it, in noises: what differences of corners are off by.
const ROUND: f64 = 4.0;
/// Shadows that are narrower count as segments, shorter ones as points, in the same unit.
const NARROW: f64 = 64.0;

/// Returns a lower bound of the translation at which two triangles meet, whichever way they look; infinity if they never
/// meet.
///
/// The differences of their corners have a convex hull, which the direction enters at its lowest point above the origin:
/// in one of the triangles of three differences, or of their sides where the shadow is too narrow to tell.
fn first_meeting(bare: &Scene, pair: [u32; 2]) -> f64 {
    let corners = |side: &Side, t: u32| side.corners(t as usize).map(|corner| corner.at);
    let (f, g) = (corners(&bare.moving, pair[0]), corners(&bare.fixed, pair[1]));
    let difference = |k: usize| g[k % 3] - f[k / 3];
    let (mut least, off) = (f64::INFINITY, ROUND * bare.noise);
    for a in 0..9 {
        for b in a + 1..9 {
            for c in b + 1..9 {
                least = least.min(height_of([a, b, c].map(difference), off));
            }
        }
    }
    least / bare.setting.length
}

/// Returns a lower bound of the height of a triangle above the origin; infinity if its shadow is more than `off` beside it.
fn height_of(corners: [DVec3; 3], off: f64) -> f64 {
    let flat = corners.map(DVec3::truncate);
    let side = |k: usize| flat[(k + 2) % 3] - flat[(k + 1) % 3];
    let longest = (0..3).map(|k| side(k).length()).fold(0.0, f64::max);
    let whole = side(2).perp_dot(flat[2] - flat[0]);
    let width = whole.abs() / longest;
    if longest == 0.0 || width <= NARROW * off {
        let of_side = |k: usize| height_of_side(corners[(k + 1) % 3], corners[(k + 2) % 3], off);
        return (0..3).map(of_side).fold(f64::INFINITY, f64::min);
    }
    // Of each corner its weight, and how far the origin is within the side across.
    let area = |k: usize| flat[(k + 1) % 3].perp_dot(flat[(k + 2) % 3]) * whole.signum();
    if (0..3).any(|k| area(k) < -off * side(k).length()) {
        return f64::INFINITY;
    }
    let height: f64 = (0..3).map(|k| area(k) / whole.abs() * corners[k].z).sum();
    let [low, high] = range(&corners);
    height - off - 2.0 * off / width * (high - low)
}

/// Returns the same of a segment, which stands for all that is as far beside it as shadows are narrow.
fn height_of_side(a: DVec3, b: DVec3, off: f64) -> f64 {
    let near = (NARROW + ROUND) * off;
    let along = (b - a).truncate();
    let length = along.length();
    let [low, high] = range(&[a, b]);
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
fn range(of: &[DVec3]) -> [f64; 2] {
    let ends = |[low, high]: [f64; 2], v: &DVec3| [low.min(v.z), high.max(v.z)];
    of.iter().fold([f64::INFINITY, f64::NEG_INFINITY], ends)
}

/// A normal of the plane through three points.
fn plane([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// A triangle as the leaf lists it.
struct Listed {
    triangle: u32,
    vertices: [u32; 3],
    corners: [Corner; 3],
    places: [DVec3; 3],
    /// Which way its shadow runs as the body has it.
    turn: Ordering,
}

impl Listed {
    fn new(scene: &Scene, side: &Side, triangle: u32) -> Self {
        let (corners, turn) = listed(scene, side, triangle as usize);
        let mut vertices = side.solid.triangles()[triangle as usize];
        if turn == Ordering::Less {
            vertices.swap(1, 2);
        }
        Self { triangle, vertices, corners, places: corners.map(|c| c.at), turn }
    }

    /// Whether corner `k` lies within the face, and the face is not on edge.
    fn is_within_face(&self, solid: &Solid, k: usize) -> bool {
        self.turn != Ordering::Equal && solid.is_within_face(self.vertices[k], self.triangle)
    }

    /// Whether the side from corner `k` to the next is no edge but within the face, and the face is not on
    /// edge.
    fn is_flat(&self, solid: &Solid, k: usize) -> bool {
        let own = if self.turn == Ordering::Less { 2 - k } else { k };
        self.turn != Ordering::Equal && !solid.is_sharp(self.triangle, own)
    }
}

/// Where on a side that is not upright the shadow of a point on its shadow is.
fn share([a, b]: [DVec3; 2], p: DVec3) -> f64 {
    let (u, v) = ((b - a).truncate(), (p - a).truncate());
    (v.dot(u) / u.length_squared()).clamp(0.0, 1.0)
}

/// The normal of a side in the plane through it and the direction.
fn upright([a, b]: [DVec3; 2]) -> DVec3 {
    let u = (b - a).normalize_or_zero();
    DVec3::Z - u * u.z
}

fn corner(k: u8) -> DVec3 {
    DVec3::AXES[k as usize]
}

fn along(k: usize, s: f64) -> DVec3 {
    let mut weights = [0.0; 3];
    (weights[k], weights[(k + 1) % 3]) = (1.0 - s, s);
    DVec3::from_array(weights)
}

/// The weights of the point of a triangle over the shadow of a point that is on it, to within rounding.
fn over([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let flat = |u: DVec3, v: DVec3| u.truncate().perp_dot(v.truncate());
    let normal = (b - a).cross(c - a);
    let steep = flat(b - a, c - a) == 0.0;
    // Rounding has left nothing of the shadow of what is all but on edge.
    let area = |u: DVec3, v: DVec3| if steep { u.cross(v).dot(normal) } else { flat(u, v) };
    let whole = area(b - a, c - a);
    let (v, w) = (area(p - a, c - a) / whole, area(b - a, p - a) / whole);
    // A point on the rim may have come out beyond it, by rounding.
    let (v, w) = (v.clamp(0.0, 1.0), w.clamp(0.0, 1.0));
    let excess = (v + w).max(1.0);
    DVec3::new(1.0 - (v + w) / excess, v / excess, w / excess)
}

/// Where the shadows of two segments cross, as shares of each.
fn meeting(a: [DVec3; 2], b: [DVec3; 2]) -> (f64, f64) {
    let flat = |v: DVec3| v.truncate();
    let (u, v, w) = (flat(a[1] - a[0]), flat(b[1] - b[0]), flat(b[0] - a[0]));
    let whole = u.perp_dot(v);
    let share = |x: f64| if whole == 0.0 { 0.5 } else { (x / whole).clamp(0.0, 1.0) };
    (share(w.perp_dot(v)), share(w.perp_dot(u)))
}

/// What is at a point of a triangle, with a normal there, both in the body's frame: to within the precision of its
/// coordinates and rounding.
pub(crate) fn feature(
    solid: &Solid,
    triangle: u32,
    (at, normal): (DVec3, DVec3),
    noise: f64,
) -> Feature {
    solid.feature_at(triangle, at, normal, 2.0 * solid.precision() + noise)
}
