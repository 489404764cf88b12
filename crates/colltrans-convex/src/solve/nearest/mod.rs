//! The nearest points of two convex bodies, and a plane between them.
//!
//! Notation. `M = {q - p}` in the setting frame (the axes of the world, the origin at the moving body's
//! translation); `v` is its point nearest to the origin, `n` a unit normal, `S` the size, `u = 2^-53`.
//!
//! The way: [`gjk`] descends to `v` over simplices of points of `M`, first in rounded numbers, and where
//! these leave the bounds apart, once more in numbers of twice their precision. Rounding turns the direction
//! of a short `v` by `u S / |v|`, which costs a plane across it the size of the bodies times as much: so
//! planes are across *simplices*, whose edges are not short, and what is still open has ties that only more
//! digits tell apart. Both are the same descent, and both only propose a plane and two points.
//!
//! Invariant. The bounds are those of what was proposed, whatever led there:
//!
//! - *Upper.* The points are a weighted mean of vertices; their distance is raised by what it may be off
//!   ([`Noise::mean_raised`]).
//! - *Lower.* The height along a rounded unit normal is off by less than one noise, as in a cast; it is
//!   taken off, and what bodies reach beyond the support points ([`TwoBodies::support_with_excess`]).
//!
//! The descent ends when the bounds are one noise apart as computed. So they are proven to within three
//! noises and a half, and what the bodies reach beyond support points: half a noise if each vertex is looked
//! at, nothing where no edge lies in the plane.

mod depth;
mod gjk;
pub mod simplex;
mod winding;

use glam::{DMat3, DVec3};

pub(crate) use self::depth::deepest;
use self::gjk::{Goal, descend, unit};
use self::simplex::{Corner, Simplex};
pub(crate) use self::winding::surrounds;
use crate::answer::{NearPoints, PlaneGap, Steps};
use crate::body::Inertia;
use crate::setting::{TwoBodies, VertexPair};
use colltrans_kernel::noise::Noise;
use colltrans_kernel::plane::triangle_normal;
use colltrans_kernel::real::{Real, Twice, Vector};
use colltrans_kernel::symmetric::Symmetric;
use colltrans_kernel::volume::{encloses, weights_of_origin};

/// Bodies that are so many noises apart, as computed, are near contact.
const NEAR: f64 = 4.0;

/// Steps to a guess (measured), and how far its last point may be off the ellipsoid, as a share.
const GUESSES: usize = 6;
const NEARLY: f64 = 0.01;

/// `M` in the setting frame.
pub struct Difference<'a> {
    pub bodies: &'a TwoBodies<'a>,
    pub noise: Noise,
}

impl<'a> Difference<'a> {
    #[inline]
    pub fn new(bodies: &'a TwoBodies<'a>) -> Self {
        Self { bodies, noise: bodies.noise() }
    }

    /// The point of a pair of vertices.
    #[inline]
    fn point(&self, pair: VertexPair) -> DVec3 {
        self.bodies.difference(pair)
    }

    /// The lowest point along a normal, from a pair that may be near.
    #[inline]
    fn lowest(&self, normal: DVec3, near: Option<VertexPair>) -> Corner<f64> {
        let bodies = self.bodies;
        self.corner(
            self.climbed(&[bodies.moving_normal(normal), bodies.fixed_normal(normal)], near),
        )
    }

    /// The pair of it, along a normal that is given in both bodies' frames.
    #[inline]
    fn climbed(&self, normals: &[DVec3; 2], near: Option<VertexPair>) -> VertexPair {
        let bodies = self.bodies;
        let (in_moving, in_fixed) = (normals[0], -normals[1]);
        let (moving, fixed) = match near {
            Some(near) => (
                bodies.moving.support_from(in_moving, near.moving.0),
                bodies.fixed.support_from(in_fixed, near.fixed.0),
            ),
            None => (bodies.moving.support(in_moving).0, bodies.fixed.support(in_fixed).0),
        };
        VertexPair::of(moving, fixed)
    }

    /// A pair of support points along a normal.
    #[inline]
    pub fn lowest_pair(&self, normal: DVec3) -> VertexPair {
        self.lowest(normal, None).pair
    }

    #[inline]
    fn corner(&self, pair: VertexPair) -> Corner<f64> {
        Corner { at: Vector(self.point(pair).to_array()), pair }
    }

    /// From the centre of the moving body to that of the fixed one.
    fn center(&self) -> DVec3 {
        let bodies = self.bodies;
        let [p, q] = [bodies.moving.inertia().center, bodies.fixed.inertia().center];
        bodies.fixed_matrix * q - bodies.moving_matrix * p + bodies.offset
    }

    /// A pair to begin with where bodies overlap: the polytope that a depth grows from is wide, as one that
    /// begins near the shortest way out would not be.
    pub(crate) fn first_pair(&self) -> NearestPairs {
        let pair = self.lowest(toward(self.center()), None).pair;
        NearestPairs { pairs: [pair; 3], count: 1 }
    }

    /// A direction in which the fixed body may be, of any length: across the shortest way between the
    /// inertia ellipsoids, nearly, or from centre to centre.
    fn guess(&self) -> DVec3 {
        let bodies = self.bodies;
        let [p, q] = [bodies.moving.inertia(), bodies.fixed.inertia()];
        let center = self.center();
        if bodies.moving.is_like_ball() && bodies.fixed.is_like_ball() {
            return toward(center);
        }
        let of = |inertia: &Inertia, rotation: &DMat3| {
            Symmetric::gram(&inertia.axes_by_factor(&rotation.transpose()))
        };
        let [a, b] = [of(p, &bodies.moving_matrix), of(q, &bodies.fixed_matrix)];
        toward(between(&a, &b, center, q.radius / p.radius))
    }
}

/// A direction, or any where there is none.
#[inline]
fn toward(v: DVec3) -> DVec3 {
    if v.length_squared() > 0.0 && v.is_finite() { v } else { DVec3::X }
}

/// The way across the nearest points of two ellipsoids with the matrices `A` and `B` whose centres are `c` apart.
///
/// Both are replaced by one, `K = (1 + r) A + (1 + 1/r) B`, which contains their sum, and touches it along `y`
/// if `r^2 = y.B y / y.A y`. The point of it nearest to the origin is `t y` where `(K + t) y = c` and
/// `f(t) = sqrt(y.K y)` is 1. `1 / f` is nearly linear, of a ball exactly so: Newton's steps are taken on it,
/// and `r` follows.
#[inline]
fn between(a: &Symmetric, b: &Symmetric, center: DVec3, mut r: f64) -> DVec3 {
    let (mut t, mut across) = (0.0_f64, center);
    for _ in 0..GUESSES {
        let k = a.combine(1.0 + r, b, 1.0 + 1.0 / r);
        let (inverse, det) = k.plus_diagonal(t).adjugate();
        let y = inverse.apply(center) * (1.0 / det);
        let ky = k.apply(y);
        let square = y.dot(ky);
        let slope = ky.dot(inverse.apply(y)) * (1.0 / det);
        let next = t + (square.sqrt() - 1.0) * square / slope;
        let ratio = (b.square(y) / a.square(y)).sqrt();
        if !(next.is_finite() && ratio > 0.0 && ratio.is_finite()) {
            break;
        }
        (t, r, across) = (next.max(0.0), ratio, y);
        if (square - 1.0).abs() < NEARLY {
            break;
        }
    }
    across
}

/// Up to three pairs of vertices to begin a descent with: those that the last one ended with.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NearestPairs {
    pairs: [VertexPair; 3],
    count: usize,
}

impl NearestPairs {
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    fn iter(&self) -> impl Iterator<Item = VertexPair> + '_ {
        self.pairs[..self.count].iter().copied()
    }
}

/// The best plane and the best points that a descent has seen.
#[derive(Debug, Clone, Copy)]
pub struct Found {
    /// The plane's gap as computed, and its normal.
    lower: f64,
    normal: DVec3,
    /// A pair of support points along it, as a climb has found them, or settled.
    lowest: Option<VertexPair>,
    /// How far the bodies may reach beyond these, once they are.
    beyond: Option<f64>,
    /// The distance of the points as computed.
    upper: f64,
    /// Those with a weight come first; the others mean nothing.
    pairs: [VertexPair; 4],
    weights: [f64; 4],
    /// Whether the pairs are four that seem to enclose the origin.
    full: bool,
    /// How many lowest points were looked for.
    pub supports: u32,
}

impl Found {
    fn nothing() -> Self {
        Self {
            lower: f64::NEG_INFINITY,
            normal: DVec3::ZERO,
            lowest: None,
            beyond: None,
            upper: f64::INFINITY,
            pairs: [VertexPair::default(); 4],
            weights: [0.0; 4],
            full: false,
            supports: 0,
        }
    }

    #[inline]
    fn note_point<T: Real>(&mut self, distance: f64, simplex: &Simplex<T>) {
        if distance < self.upper {
            self.upper = distance;
            (self.pairs, self.weights) = simplex.weighted();
            self.full = simplex.is_full();
        }
    }

    #[inline]
    fn note_plane(&mut self, normal: DVec3, lowest: &Corner<f64>) {
        let lower = normal.dot(lowest.at.value());
        if lower > self.lower || self.lowest.is_none() {
            self.lower = lower;
            self.normal = normal;
            self.lowest = Some(lowest.pair);
            self.beyond = None;
        }
    }

    /// The lowest point along the normal of the plane, whatever a climb has made of it.
    #[inline]
    fn settle(&mut self, difference: &Difference) {
        let Some(pair) = self.lowest.filter(|_| self.beyond.is_none()) else { return };
        let bodies = difference.bodies;
        let normals = [bodies.moving_normal(self.normal), bodies.fixed_normal(self.normal)];
        let (settled, beyond) = bodies.support_with_excess(&normals, pair);
        (self.lowest, self.beyond) = (Some(settled), Some(beyond));
        if settled != pair {
            self.lower = self.normal.dot(difference.point(settled));
        }
    }

    /// The work done so far.
    #[inline]
    pub(crate) fn steps(&self) -> Steps {
        Steps { supports: self.supports, ..Steps::default() }
    }

    /// What a later descent may begin with.
    #[inline]
    pub fn pairs(&self) -> NearestPairs {
        let mut pairs = NearestPairs::default();
        for pair in self.simplex().take(3) {
            pairs.pairs[pairs.count] = pair;
            pairs.count += 1;
        }
        pairs
    }

    /// The pairs that the nearest point is made of.
    fn simplex(&self) -> impl Iterator<Item = VertexPair> + '_ {
        let weighted = self.pairs.iter().zip(self.weights);
        weighted.filter(|(_, weight)| *weight > 0.0).map(|(pair, _)| *pair)
    }
}

/// The nearest points and a plane; with a length, until they are known to be nearer or farther. `start`
/// are pairs to begin with.
#[inline]
pub(crate) fn nearest(difference: &Difference, start: &NearestPairs, than: Option<f64>) -> Found {
    let noise = difference.noise.point();
    // What is proven is less than what is computed by this, mostly.
    let than = than.map(|than| [than + 3.0 * noise, than - 1.5 * noise]);
    reached(difference, start, &Goal { gap: noise, than, share: None })
}

/// The same to such a share of what bodies are farther apart than a length, if they are.
#[inline]
pub fn nearly(difference: &Difference, start: &NearestPairs, share: f64, beyond: f64) -> Found {
    let share = Some([share, beyond]);
    reached(difference, start, &Goal { gap: difference.noise.point(), than: None, share })
}

#[inline]
fn reached(difference: &Difference, start: &NearestPairs, goal: &Goal) -> Found {
    let mut found = Found { supports: u32::from(start.is_empty()), ..Found::nothing() };
    let simplex = begin(difference, start);
    descend::<f64>(difference, simplex, goal, &mut found);
    if !goal.is_reached(&found) {
        polish(difference, &mut found);
    }
    if !goal.is_reached(&found) {
        descend_with_more_digits(difference, goal, &mut found);
    }
    found.settle(difference);
    found
}

/// The simplex of some pairs; of a first support point, if there are none.
fn begin(difference: &Difference, start: &NearestPairs) -> Simplex<f64> {
    let corners = start.iter().map(|pair| difference.corner(pair));
    Simplex::of(corners)
        .unwrap_or_else(|| Simplex::new(difference.lowest(difference.guess(), None)))
}

/// Tries the plane across the simplex.
fn polish(difference: &Difference, found: &mut Found) {
    let Some(normal) = across_simplex(difference, found) else { return };
    let normal = if normal.dot(found.normal) < 0.0 { -normal } else { normal };
    let lowest = difference.lowest(normal, found.lowest);
    found.supports += 1;
    found.note_plane(normal, &lowest);
    found.settle(difference);
}

/// The normal across a simplex of two or three points by its edges, not by its corners: where both bodies' own
/// are short, rounding turns it less.
fn across_simplex(difference: &Difference, found: &Found) -> Option<DVec3> {
    let bodies = difference.bodies;
    let NearestPairs { pairs: [a, b, c], count } = found.pairs();
    let across = match count {
        2 => {
            let edge = bodies.displacement_between(a, b);
            let nearest =
                difference.point(a) * found.weights[0] + difference.point(b) * found.weights[1];
            nearest - edge * (nearest.dot(edge) / edge.length_squared())
        }
        3 => triangle_normal([
            DVec3::ZERO,
            bodies.displacement_between(a, b),
            bodies.displacement_between(a, c),
        ]),
        _ => return None,
    };
    unit(across)
}

/// The rest of the way, where ties are told apart by digits that rounding has lost.
#[cold]
#[inline(never)]
fn descend_with_more_digits(difference: &Difference, goal: &Goal, found: &mut Found) {
    let corner = |pair| Corner { at: difference.bodies.terms(pair).twice(), pair };
    if let Some(simplex) = Simplex::<Twice>::of(found.simplex().take(3).map(corner)) {
        descend::<Twice>(difference, simplex, goal, found);
    }
}

/// A plane between the bodies.
#[derive(Debug, Clone, Copy)]
pub struct Plane {
    /// What it proves, if that is positive.
    pub gap: PlaneGap,
    /// A pair of support points along it.
    pub(crate) lowest: VertexPair,
    /// How far the bodies, and the points that they were made from, may reach beyond these.
    pub(crate) beyond: f64,
}

impl Found {
    /// The best plane, if there is one.
    #[inline]
    pub fn plane(&self, difference: &Difference) -> Option<Plane> {
        let (normal, lowest, beyond) = (self.normal, self.lowest?, self.beyond?);
        let gap = (self.lower - difference.noise.lowered() - beyond).next_down();
        Some(Plane { gap: PlaneGap { normal, gap }, lowest, beyond })
    }

    /// The same, or one that tells bodies apart that are less so than rounding.
    #[inline]
    pub(crate) fn best_plane(&self, difference: &Difference) -> Option<Plane> {
        let plane = self.plane(difference);
        let is_open = plane.is_none_or(|plane| plane.gap.gap <= 0.0);
        let is_near = self.upper <= NEAR * difference.noise.point();
        if is_open && is_near { self.sharp_plane(difference).or(plane) } else { plane }
    }

    /// A plane across the simplex, or from its only point, with the gap that a check finds, less what the
    /// inputs may reach beyond the bodies.
    #[cold]
    #[inline(never)]
    fn sharp_plane(&self, difference: &Difference) -> Option<Plane> {
        let first = self.simplex().next().and_then(|pair| unit(difference.point(pair)));
        let across = across_simplex(difference, self).or(first)?;
        let planes = [across, -across, self.normal]
            .into_iter()
            .filter_map(unit)
            .map(|normal| PlaneGap { normal, gap: difference.bodies.input_gap(normal) });
        let gap = planes.max_by(|a, b| a.gap.total_cmp(&b.gap)).filter(|plane| plane.gap > 0.0)?;
        let lowest = difference.lowest(gap.normal, self.lowest).pair;
        Some(Plane { gap, lowest, beyond: 0.0 })
    }

    /// How far the point and the plane are apart, as computed.
    pub(crate) fn gap(&self) -> f64 {
        self.upper - self.lower.max(0.0)
    }

    /// The point, by up to three pairs and their weights.
    #[inline]
    pub fn points(&self) -> ([VertexPair; 3], [f64; 3]) {
        let mut points = ([self.pairs[0]; 3], [0.0; 3]);
        let weighted = self.pairs.iter().zip(self.weights).filter(|(_, weight)| *weight > 0.0);
        for (k, (pair, weight)) in weighted.take(3).enumerate() {
            (points.0[k], points.1[k]) = (*pair, weight);
        }
        points
    }

    /// The points, with what they prove.
    #[inline]
    pub(crate) fn near(&self, difference: &Difference) -> NearPoints {
        let Self { mut pairs, weights, .. } = *self;
        for k in 1..4 {
            if weights[k] == 0.0 {
                pairs[k] = pairs[0];
            }
        }
        let bodies = difference.bodies;
        if self.full && encloses(&pairs.map(|pair| bodies.terms(pair)), bodies.scale()) {
            return meeting(difference, pairs, weights);
        }
        let is_near = self.upper <= NEAR * difference.noise.point();
        let met = if is_near { self.enclosing(difference) } else { None };
        met.unwrap_or_else(|| {
            let distance = (self.upper + difference.noise.mean_raised()).next_up();
            NearPoints { pairs, weights, distance }
        })
    }

    /// Four pairs that enclose the origin, where it lies on a simplex of fewer, or beside it by rounding alone,
    /// as of boxes that are lined up: that simplex, and support points along the axes.
    #[cold]
    #[inline(never)]
    fn enclosing(&self, difference: &Difference) -> Option<NearPoints> {
        let bodies = difference.bodies;
        let axes = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        let beside: Vec<VertexPair> =
            axes.map(|normal| difference.lowest(normal, None).pair).collect();
        let (corners, mut weights) = (self.simplex().count(), [0.0; 4]);
        let given = self.weights.iter().filter(|weight| **weight > 0.0);
        weights.iter_mut().zip(given).for_each(|(place, weight)| *place = *weight);
        // Which of the six are taken, as bits.
        let choices = (0_u32..1 << 6).filter(|bits| corners + bits.count_ones() as usize == 4);
        let mut made = choices.map(|bits| {
            let more = (0..6).filter(|k| bits >> k & 1 == 1).map(|k| beside[k]);
            let mut pairs = [VertexPair::default(); 4];
            pairs
                .iter_mut()
                .zip(self.simplex().chain(more))
                .for_each(|(place, pair)| *place = pair);
            pairs
        });
        let pairs =
            made.find(|pairs| encloses(&pairs.map(|pair| bodies.terms(pair)), bodies.scale()))?;
        Some(meeting(difference, pairs, weights))
    }
}

/// Points of bodies that meet, by four pairs that enclose the origin. Where these are nearly in a plane, rounding
/// leaves points apart that are one: exact volumes tell their weights.
fn meeting(difference: &Difference, pairs: [VertexPair; 4], mut weights: [f64; 4]) -> NearPoints {
    let apart: DVec3 = pairs.iter().zip(weights).map(|(p, w)| difference.point(*p) * w).sum();
    if apart.length() > difference.noise.point() {
        let corners = pairs.map(|pair| difference.bodies.terms(pair));
        weights = weights_of_origin(&corners).unwrap_or(weights);
    }
    NearPoints { pairs, weights, distance: 0.0 }
}
