//! Two facets on their way: how far apart, and that they cross.
//!
//! A distance is that of two triangles in closed form ([`triangle`]), whose plane is a guess as any other: a look
//! takes of it what it proves. That they *cross* is an edge of one that passes through the other: five volumes
//! have signs, and keep them wherever the points are that computed ones stand for. Points of two facets are off by
//! less than `e` each, noise and motion together; for vectors `x, y, z` between them the volume then is by less
//! than `8 e (|y||z| + |x||z| + |x||y| + e (|x| + |y| + |z| + e)) + 48 u |x||y||z|` in the maximum norm.

use glam::DVec3;

use super::super::answer::MotionSteps;
use super::super::bend::Looking;
use super::super::course::Course;
use super::super::look::{Look, Looker, closing};
use super::super::search::{Advanced, End, advance};
use super::super::span::{Instant, Span};
use super::proof::FacetsMet;
use super::tree::Facet;
use colltrans_convex::answer::are_weights;
use colltrans_solid::solve::nearest::triangle::{self, Corners, GAP, LENGTH};

/// Looks at two facets.
#[derive(Debug, Clone, Default)]
pub(super) struct FacetLooker {
    pub(super) steps: MotionSteps,
}

/// The corners of both facets in the setting frame.
pub(super) fn corners<M>(at: &Instant<'_, M, Facet>) -> [Corners; 2] {
    let bodies = &at.bodies;
    let [f, g] = [bodies.moving.corners, bodies.fixed.corners];
    [f.map(|v| bodies.moving_matrix * v), g.map(|v| bodies.fixed_matrix * v + bodies.offset)]
}

impl Looker<Facet> for FacetLooker {
    type Met = FacetsMet;
    type Supports = Looking;
    const SUPPORTS: Looking = Looking;

    fn look<'a, C>(&mut self, course: &C, time: f64) -> Look<'a, C::Moved, Facet>
    where
        C: Course<'a, Body = Facet>,
    {
        self.steps.looks += 1;
        let at = course.instant(time);
        let noise = at.bodies.noise().point();
        let [f, g] = corners(&at);
        let found = triangle::nearest(&f, &g, noise);
        let gap = found.gap - GAP * noise - course.keep() - course.error();
        let [p, q] = [at.bodies.moving.corners, at.bodies.fixed.corners];
        let points = [triangle::mean(&p, found.weights[0]), triangle::mean(&q, found.weights[1])];
        let (normal, floor) = (found.normal, 4.0 * noise + course.error());
        let rate = if gap > 0.0 { closing(course, &at, points, normal) } else { 0.0 };
        Look { at, normal, gap, rate, points, floor }
    }

    fn met<'a, C>(&mut self, course: &C, time: f64) -> Option<FacetsMet>
    where
        C: Course<'a, Body = Facet>,
    {
        self.steps.looks += 1;
        let at = course.instant(time);
        if course.keep() > 0.0 {
            let [f, g] = corners(&at);
            let weights = triangle::nearest(&f, &g, at.bodies.noise().point()).weights;
            let met = FacetsMet::Near { weights: weights.map(|w| w.to_array()) };
            return holds(course, &at, met).then_some(met);
        }
        let edges = [true, false].into_iter().flat_map(|moving| (0..3).map(move |k| (moving, k)));
        edges
            .map(|(moving, edge)| FacetsMet::Crossing { moving, edge })
            .find(|met| holds(course, &at, *met))
    }
}

/// Whether two facets meet at a time, for certain.
pub(super) fn holds<'a, C: Course<'a, Body = Facet>>(
    course: &C,
    at: &Instant<'a, C::Moved, Facet>,
    met: FacetsMet,
) -> bool {
    let (noise, [f, g]) = (at.bodies.noise().point(), corners(at));
    match met {
        FacetsMet::Crossing { moving, edge } => {
            let (own, other) = if moving { (f, g) } else { (g, f) };
            let (k, off) = (edge as usize, noise + course.error());
            k < 3 && course.keep() == 0.0 && pierces(own[k], own[(k + 1) % 3], other, off)
        }
        FacetsMet::Near { weights } => {
            let length = triangle::length(&f, &g, weights.map(DVec3::from_array));
            weights.iter().all(|weights| are_weights(&weights[..]))
                && length + LENGTH * noise + course.error() <= course.keep()
        }
        // It is more than two facets that tell.
        FacetsMet::Inside { .. } | FacetsMet::Contained { .. } => false,
    }
}

/// Whether a segment passes through a triangle, wherever its points are to within `e`.
fn pierces(p: DVec3, q: DVec3, [a, b, c]: Corners, e: f64) -> bool {
    let [below, above] = [p, q].map(|end| sign([b - a, c - a, end - a], e));
    if below == 0 || below + above != 0 {
        return false;
    }
    let way = q - p;
    let turns = [(a, b), (b, c), (c, a)].map(|(u, v)| sign([way, u - p, v - p], e));
    turns[0] != 0 && turns == [turns[0]; 3]
}

/// The sign of the volume of three vectors between such points, 0 if it is not certain.
fn sign([x, y, z]: [DVec3; 3], e: f64) -> i32 {
    let [l, m, n] = [x, y, z].map(|v| v.abs().max_element());
    let value = x.cross(y).dot(z);
    let pairs = l * m + m * n + n * l;
    let rounded = 24.0 * f64::EPSILON * l * m * n;
    let error = 8.0 * e * (pairs + e * (l + m + n + e)) + rounded;
    if value.abs() > error { value.signum() as i32 } else { 0 }
}

/// So many looks are taken at facets that cross, for a time at which they are apart, and that is halved so often.
const LOOKS: i32 = 8;
const HALVINGS: i32 = 40;

/// After a contact that does not count they are looked at so much later, in parts of the span, each time twice as much.
const SOON: f64 = 1e-9;
const ROUNDS: i32 = 32;

/// Facets that look along their way by no more than this share of it are on edge.
const ON_EDGE: f64 = 1e-12;

/// A contact that begins after two facets were apart.
#[derive(Debug, Clone, Copy)]
pub(super) struct Later {
    /// They are apart before, back to then.
    pub(super) lower: f64,
    /// When they meet for certain, and why.
    pub(super) met: Option<(f64, FacetsMet)>,
}

/// The first contact of two facets that begins within a span while they look at each other, of which it is told which
/// have a side to look to. Facets that are not apart when the span begins are left out until they are, but for those
/// that may only touch when the motion does.
pub(super) fn later(
    span: &Span<Facet>,
    sided: [bool; 2],
    looker: &mut FacetLooker,
) -> Option<Later> {
    let begins = span.from == 0.0 && !looker.look(span, 0.0).is_apart();
    if begins && looker.met(span, 0.0).is_none() && look_at_each_other(span, 0.0, sided, looker) {
        return Some(Later { lower: 0.0, met: None });
    }
    let mut from = apart_from(span, span.from, looker)?;
    for k in 0..ROUNDS {
        let part = span.within([from, span.to]);
        let Advanced { planes, end } = advance(&part, looker);
        let lower = planes.last().map_or(from, |plane| plane.time);
        let met = match end {
            End::Free => return None,
            End::Met(time, met) => Some((time, met)),
            End::Blurred | End::Stalled => None,
        };
        if look_at_each_other(span, lower, sided, looker) {
            return Some(Later { lower, met });
        }
        let more = (span.to - span.from) * SOON * 2.0_f64.powi(k);
        let after = met.map_or(lower, |(time, _)| time) + more;
        from = apart_from(span, after, looker)?;
    }
    None
}

/// The first time seen, from one on, at which two facets are apart.
fn apart_from(span: &Span<Facet>, from: f64, looker: &mut FacetLooker) -> Option<f64> {
    if from > span.to {
        return None;
    }
    let time = |k: i32| from + (span.to - from) * (f64::from(k) / f64::from(LOOKS));
    let mut is_apart = |time: f64| looker.look(span, time).is_apart();
    let first = (0..=LOOKS).find(|k| is_apart(time(*k)))?;
    if first == 0 {
        return Some(from);
    }
    let [mut low, mut high] = [time(first - 1), time(first).min(span.to)];
    for _ in 0..HALVINGS {
        let middle = low + 0.5 * (high - low);
        *(if is_apart(middle) { &mut high } else { &mut low }) = middle;
    }
    Some(high)
}

/// Whether facets that meet do so from outside of both, as those of a cast; those without a side always do.
fn look_at_each_other(
    span: &Span<Facet>,
    time: f64,
    sided: [bool; 2],
    looker: &mut FacetLooker,
) -> bool {
    let at = span.instant(time);
    let [f, g] = corners(&at);
    looker.steps.looks += 1;
    let weights = triangle::nearest(&f, &g, at.bodies.noise().point()).weights;
    let bodies = [at.bodies.moving.corners, at.bodies.fixed.corners];
    let speed = |k: usize| span.velocity(&at, k, triangle::mean(&bodies[k], weights[k]));
    // How the moving facet goes, seen from the fixed one.
    let way = speed(0) - speed(1);
    let normal = |[a, b, c]: Corners| (b - a).cross(c - a);
    let looks = |n: DVec3, way: DVec3| n.dot(way) > ON_EDGE * n.length() * way.length();
    (!sided[0] || looks(normal(f), way)) && (!sided[1] || looks(normal(g), -way))
}
