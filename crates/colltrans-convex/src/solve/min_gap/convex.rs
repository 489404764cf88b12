//! Casts of convex bodies with a minimum gap: from a setting to an outcome. Notation as in [`super`].
//!
//! The outcome is that of a cast of a point against `M` grown by a ball of radius `g`. With the distance `m` of
//! the whole line from `M`, the shadows overlap by `o = g - m`:
//!
//! - *separated* if `o < 0` for certain,
//! - *grazing* if `o` is at most the graze tolerance,
//! - else *contact*.
//!
//! A *slight* gap, of at most eight noises, leaves no room for a point that is proven to be within the gap. In this
//! case the bodies are cast without the gap. Their contact is an upper bound, and its plane, lowered by the
//! gap, proves the lower one. If the result is a separation whose margin is not proven to exceed the gap, the search
//! with the gap follows.

use glam::{DMat3, DVec3};

use super::{
    CrossingBounds, DistanceSample, GapLine, NearPoint, SampledSet, SetPlane, bound_crossing,
    distance_to_line,
};
use crate::answer::{
    Certificate, Contact, Grazing, Outcome, Separated, Separation, Solver, StartedFrom, Steps,
};
use crate::setting::error::{QueryError, Stalled};
use crate::setting::minkowski::MinkowskiDifference;
use crate::setting::{Setting, TwoBodies, VertexPair};
use crate::solve::nearest::{Difference, NearestPairs, nearest_points};
use crate::solve::observe::{NoObserver, Observer, Phase, ShadowFrame, Support};
use crate::solve::options::{Focus, Options};
use crate::solve::{TrackerUpdate, WarmStart};
use colltrans_kernel::noise::Noise;

/// Maximum difference of the bounds of an answer, in noises over `n.d`.
const MAX_WIDTH: f64 = 15.0;

/// Maximum difference of the bounds of gliding bodies (`gliding_contact`), in noises over `n.d`. Larger because a check
/// allows more for rounding there.
const MAX_WIDTH_GLIDING: f64 = 24.0;

/// Reductions of the gap, in noises, for gliding bodies (`gliding_contact`). If no point at the gap is proven to be
/// within the gap, the search for a smaller gap finds nearer points. The overlap of a contact exceeds the graze
/// tolerance, which is at least eight noises. Therefore the line crosses all gaps that are smaller by at most eight.
const GAP_REDUCTIONS: [f64; 4] = [4.0, 2.0, 6.0, 8.0];

/// Maximum distance behind the plane of gliding bodies, in noises over `n.d`, at which a point is searched.
const MAX_STEPS_BEHIND: u8 = 10;

/// Maximum difference of the bounds of nearest points, in noises. Above it they are searched again from
/// scratch.
const MAX_NEAREST_GAP: f64 = 2.0;

/// Difference of a margin and the gap, in noises, above which the margin is proven without a check.
const CLEAR_MARGIN: f64 = 2.0;

/// `M` of two convex bodies, with the last nearest points and the observer.
struct ConvexDifference<'s, 'a, 'o, O> {
    setting: &'s Setting<'a>,
    noise: Noise,
    pairs: NearestPairs,
    observer: &'o mut O,
    /// Number of support points computed.
    supports: u32,
}

/// Three pairs of vertices and their weights.
type WeightedPairs = ([VertexPair; 3], [f64; 3]);

/// Returns the shadow frame, for observers.
fn setting_from_shadow(setting: &Setting) -> DMat3 {
    MinkowskiDifference::new(setting).setting_from_shadow
}

impl<O: Observer> ConvexDifference<'_, '_, '_, O> {
    fn report_begin(&mut self) {
        let (setting, noise) = (self.setting, self.noise.point_error());
        let frame = || ShadowFrame { world_from_shadow: setting_from_shadow(setting), noise };
        self.observer.search_started(frame);
    }

    /// Builds the plane with this normal through the support point `at`, and reports the support point to the
    /// observer.
    #[inline]
    fn report_plane(
        &mut self,
        normal: DVec3,
        (support, at): (VertexPair, DVec3),
        beyond: f64,
    ) -> SetPlane<VertexPair> {
        let setting = self.setting;
        self.observer.support(|| {
            let to_shadow = setting_from_shadow(setting).transpose();
            Support { normal: to_shadow * normal, at: to_shadow * at, pair: support }
        });
        let height = normal.dot(at);
        let height = height - self.noise.lower_bound_margin() - beyond;
        SetPlane { normal, height, excess: beyond, support }
    }
}

impl<O: Observer> SampledSet for ConvexDifference<'_, '_, '_, O> {
    type PlaneId = VertexPair;
    type PointId = WeightedPairs;

    fn supporting_plane(&mut self, normal: DVec3) -> (SetPlane<VertexPair>, DVec3) {
        self.supports += 1;
        let bodies: &TwoBodies = &self.setting.bodies;
        let normals = [bodies.moving_normal(normal), bodies.fixed_normal(normal)];
        let found = VertexPair {
            moving: bodies.moving.support(normals[0]),
            fixed: bodies.fixed.support(-normals[1]),
        };
        let (support, beyond) = bodies.support_with_excess(&normals, found);
        let at = bodies.difference_point(support);
        (self.report_plane(normal, (support, at), beyond), at)
    }

    fn sample(&mut self, from: DVec3) -> DistanceSample<VertexPair, WeightedPairs> {
        let moved = self.setting.bodies.moved_by(from);
        let difference = Difference::new(&moved);
        let mut found = nearest_points(&difference, &self.pairs, None);
        self.supports += found.supports;
        if found.computed_gap() > MAX_NEAREST_GAP * self.noise.point_error() {
            // A descent from pairs on a sliver may stall.
            found = nearest_points(&difference, &NearestPairs::default(), None);
            self.supports += found.supports;
        }
        self.pairs = found.start_pairs();
        let plane = found.gap_plane(&difference).map(|plane| {
            let at = self.setting.difference_point(plane.lowest);
            self.report_plane(plane.gap.normal, (plane.lowest, at), plane.excess)
        });
        let (pairs, weights) = found.weighted_pairs_and_weights(&difference);
        // In the frame of the setting, where the origin is the unmoved body.
        let corners = [0, 1, 2].map(|k| self.setting.difference_point(pairs[k]));
        let count = weights.iter().filter(|weight| **weight > 0.0).count();
        let point = weighted_mean(&corners, &weights);
        DistanceSample { plane, point, spot: (pairs, weights), corners, count }
    }
}

fn weighted_mean(corners: &[DVec3; 3], weights: &[f64; 3]) -> DVec3 {
    let sum: f64 = weights.iter().sum();
    corners.iter().zip(weights).map(|(corner, weight)| *corner * (weight / sum)).sum()
}

/// Casts bodies with a minimum gap. [`crate::solve::search`] casts bodies without one.
///
/// # Errors
///
/// Returns [`QueryError::NotConverged`] if the bounds are farther apart than rounding explains, or if no plane
/// along the line was found.
#[cold]
pub(crate) fn cast_with_min_gap<O: Observer>(
    setting: &Setting,
    options: &Options,
    focus: &Focus,
    last: &WarmStart,
    next: &mut TrackerUpdate,
    observer: &mut O,
) -> Result<Outcome, QueryError> {
    *next = TrackerUpdate::default();
    let [_, gap] = setting.core_gap_bounds(options.min_gap);
    let line = GapLine::new(setting.unit, gap, setting.size());
    if line.noise.is_below_noise(gap) {
        let touching = Options { min_gap: 0.0, ..*options };
        let outcome = crate::solve::search(setting, &touching, focus, last, next, observer)?;
        if let Some(outcome) = lower_by_slight_gap(setting, options.min_gap, outcome) {
            return Ok(outcome);
        }
    }
    let last = if focus.features { *last } else { WarmStart::Nothing };
    find_gap_crossing(setting, line, options, &last, next, observer)
}

/// Finds where the distance of the bodies first falls to the gap of a line. Stores in `next` where a later search may
/// start.
fn find_gap_crossing<O: Observer>(
    setting: &Setting,
    line: GapLine,
    options: &Options,
    last: &WarmStart,
    next: &mut TrackerUpdate,
    observer: &mut O,
) -> Result<Outcome, QueryError> {
    let pairs = NearestPairs::default();
    let bodies = ConvexDifference { setting, noise: line.noise, pairs, observer, supports: 0 };
    let mut search = GapSearch { options, line, bodies, steps: Steps::default() };
    search.bodies.report_begin();
    let found = search.crossing_of_rounded_segment().unwrap_or_else(|| {
        let start = search.first_plane(last);
        search.bodies.observer.phase_ended(Phase::Setup);
        bound_crossing(&mut search.bodies, &line, start, f64::INFINITY)
    });
    search.bodies.observer.phase_ended(Phase::Finish);
    search.steps.pivots = found.samples;
    next.start = WarmStart::WithMinGap { normal: found.plane.normal, pairs: search.bodies.pairs };
    let outcome = search.classify_outcome(&found);
    next.steps = outcome.as_ref().ok().map(Outcome::steps);
    search.bodies.observer.phase_ended(Phase::Answer);
    outcome
}

struct GapSearch<'s, 'a, 'o, O> {
    options: &'s Options,
    line: GapLine,
    bodies: ConvexDifference<'s, 'a, 'o, O>,
    steps: Steps,
}

type FoundBounds<'s, 'a, 'o, O> = CrossingBounds<ConvexDifference<'s, 'a, 'o, O>>;

impl<'s, 'a, 'o, O: Observer> GapSearch<'s, 'a, 'o, O> {
    /// Returns the work done, with the number of support points.
    fn total_steps(&self) -> Steps {
        Steps { supports: self.bodies.supports, ..self.steps }
    }

    /// Computes the crossing in closed form, of spheres, or of a sphere and a capsule: `M` is a point or a segment. A
    /// line enters the ball about an end of the segment if it enters the cylinder about the whole edge beyond this
    /// end.
    ///
    /// Returns `None` for other bodies, if there is no crossing, or if rounding does not explain the difference of the
    /// bounds.
    fn crossing_of_rounded_segment(&mut self) -> Option<FoundBounds<'s, 'a, 'o, O>> {
        let (setting, line) = (self.bodies.setting, self.line);
        let [p, q] = [setting.moving.dimension(), setting.fixed.dimension()].map(u32::from);
        if p + q > 1 || !setting.is_rounded() {
            return None;
        }
        let pairs = [VertexPair::from_indices(0, 0), VertexPair::from_indices(p, q)];
        let from = setting.difference_point(pairs[0]);
        let ends = [from, if p + q == 0 { from } else { setting.difference_point(pairs[1]) }];
        let edge = ends[1] - from;
        let (mut s, mut share) = (line.estimate_crossing(ends[0]), 0.0);
        if p + q == 1 {
            s = line.edge_crossing(ends);
            share = (line.unit * s? - ends[0]).dot(edge) / edge.length_squared();
            if !(0.0..=1.0).contains(&share) {
                let end = u8::from(share > 0.0);
                share = f64::from(end);
                s = line.estimate_crossing(ends[usize::from(end)]);
            }
        }
        let point = ends[0] + edge * share;
        let mut normal = point - line.unit * s?;
        if share > 0.0 && share < 1.0 {
            normal -= edge * (normal.dot(edge) / edge.length_squared());
        }
        let normal = normal.try_normalize()?;
        let lowest = usize::from(normal.dot(edge) < 0.0);
        self.bodies.supports += 1;
        let support = (pairs[lowest], ends[lowest]);
        let plane = self.bodies.report_plane(normal, support, setting.input_excess());
        let lower = line.lower_bound(&plane)?;
        let upper = line.crossing_upper_bound(point)?;
        let spot = if share < 1.0 {
            ([pairs[0], pairs[1], pairs[1]], [1.0 - share, share, 0.0])
        } else {
            ([pairs[1]; 3], [1.0, 0.0, 0.0])
        };
        let near_point = Some(NearPoint { upper, point, spot });
        let is_explained = upper - lower <= line.bound_width(&plane, MAX_WIDTH);
        let is_passing = false;
        is_explained.then_some(CrossingBounds { plane, lower, near_point, samples: 0, is_passing })
    }

    /// Returns the plane to start with: that of the last search or the one perpendicular to the line, whichever
    /// has the greater lower bound.
    fn first_plane(&mut self, last: &WarmStart) -> SetPlane<VertexPair> {
        let mut start = self.bodies.supporting_plane(self.line.unit).0;
        if let WarmStart::WithMinGap { normal, pairs } = last {
            self.bodies.pairs = *pairs;
            self.steps.started_from = StartedFrom::Features;
            let plane = self.bodies.supporting_plane(*normal).0;
            if self.line.lower_bound(&plane) > self.line.lower_bound(&start) {
                start = plane;
            }
        }
        start
    }

    /// Returns the outcome, by the overlap of the shadows.
    fn classify_outcome(
        &mut self,
        found: &FoundBounds<'s, 'a, 'o, O>,
    ) -> Result<Outcome, QueryError> {
        let min_gap = self.line.min_gap;
        let min_tolerance = 8.0 * self.line.noise.point_error();
        let tolerance = self.options.graze_tolerance.max(min_tolerance);
        let lateral_distance = |near: &NearPoint<WeightedPairs>| {
            near.point.reject_from_normalized(self.line.unit).length()
        };
        if found
            .near_point
            .as_ref()
            .is_some_and(|near| min_gap - lateral_distance(near) > tolerance)
        {
            return self.proven_contact(found).map(Outcome::Contact);
        }
        let center = |of: DVec3| self.line.unit.cross(of).cross(self.line.unit);
        let setting = self.bodies.setting;
        let between = setting.fixed_matrix * setting.fixed.inertia().center
            - setting.moving_matrix * setting.moving.inertia().center
            + setting.offset;
        let Some(shadow) = distance_to_line(&mut self.bodies, &self.line, center(between)) else {
            return Err(not_converged(Stalled::NoPortal));
        };
        if let Some(certificate) = self.proven_separation(&shadow.plane) {
            let (solver, steps) = (self.reported_solver(), self.total_steps());
            return Ok(Outcome::Separated(Separated { certificate, solver, steps }));
        }
        let overlap = min_gap - if shadow.distance > 0.0 { shadow.plane.height } else { 0.0 };
        if shadow.distance == 0.0
            && let Some(grazing) = self.grazing_without_gap(found, tolerance)
        {
            return Ok(Outcome::Grazing(grazing));
        }
        if overlap > tolerance || shadow.distance == 0.0 {
            return self.proven_contact(found).map(Outcome::Contact);
        }
        let separating_direction = shadow.plane.normal;
        let contact = self.grazing_contact(found);
        Ok(Outcome::Grazing(Grazing { separating_direction, overlap, contact }))
    }

    /// Casts the bodies without the gap, with a graze tolerance that is smaller by the gap. Returns the grazing
    /// contact that this finds. `None` if it finds none, or if the gap is not below the tolerance.
    fn grazing_without_gap(
        &self,
        found: &FoundBounds<'s, 'a, 'o, O>,
        tolerance: f64,
    ) -> Option<Grazing> {
        let min_gap = self.line.min_gap;
        if min_gap >= tolerance {
            return None;
        }
        let plain = Options { min_gap: 0.0, graze_tolerance: tolerance - min_gap, ..*self.options };
        let (last, mut next) = (WarmStart::Nothing, TrackerUpdate::default());
        let setting = self.bodies.setting;
        let outcome =
            crate::solve::search(setting, &plain, &Focus::NONE, &last, &mut next, &mut NoObserver);
        let Ok(Outcome::Grazing(of)) = outcome else { return None };
        Some(Grazing { overlap: of.overlap + min_gap, contact: self.grazing_contact(found), ..of })
    }

    /// Returns the separation that a plane along the line proves. `None` if its margin is not proven to be
    /// larger than the gap.
    fn proven_separation(&self, plane: &SetPlane<VertexPair>) -> Option<Separation> {
        let setting = self.bodies.setting;
        let certificate = separation_of_bodies(setting, plane.normal, plane.height);
        let clear_height = self.line.min_gap + CLEAR_MARGIN * self.line.noise.point_error();
        let proven = plane.height > clear_height
            || plane.height > self.line.min_gap
                && certificate.verify_with_gap(setting, self.options.min_gap).is_ok();
        proven.then_some(certificate)
    }

    fn reported_solver(&self) -> Solver {
        match self.options.solver {
            Solver::Auto => Solver::Portal,
            solver => solver,
        }
    }

    /// Returns the contact if rounding explains the difference of its bounds.
    fn proven_contact(
        &mut self,
        found: &FoundBounds<'s, 'a, 'o, O>,
    ) -> Result<Contact, QueryError> {
        let tolerance = self.line.bound_width(&found.plane, MAX_WIDTH);
        let upper = found.near_point.map_or(f64::INFINITY, |near| near.upper);
        if upper - found.lower <= tolerance {
            return Ok(self.build_contact(found, tolerance));
        }
        if let Some(contact) = self.gliding_contact(found) {
            return Ok(contact);
        }
        let length = self.bodies.setting.length;
        let [lower, upper, tolerance] = [found.lower, upper, tolerance].map(|s| s / length);
        Err(not_converged(Stalled::Gap { lower, upper, tolerance }))
    }

    /// Finds the contact of *gliding* bodies: a face nearly parallel to the direction passes at about the gap. Its
    /// distance falls so slowly that points are proven to be within the gap only far behind its front edge.
    ///
    /// Tries the [`GAP_REDUCTIONS`] in order. The plane that is reached at the smaller gap proves the lower bound, and
    /// a point found there or behind proves the upper bound. The estimate remains the lower bound of `found`, clamped
    /// to these bounds. `None` if rounding does not explain their difference.
    #[cold]
    fn gliding_contact(&mut self, found: &FoundBounds<'s, 'a, 'o, O>) -> Option<Contact> {
        let contact = GAP_REDUCTIONS
            .iter()
            .find_map(|reduction| self.contact_behind_edge(found, *reduction))?;
        let Certificate { lower, upper, .. } = contact.certificate;
        let translation = (found.lower / self.bodies.setting.length).min(upper).max(lower);
        Some(Contact { translation, ..contact })
    }

    /// Finds the contact by a plane that is reached at a gap smaller by `reduction` noises. `None` if no point
    /// is near enough, or if rounding does not explain the difference of the bounds.
    fn contact_behind_edge(
        &mut self,
        found: &FoundBounds<'s, 'a, 'o, O>,
        reduction: f64,
    ) -> Option<Contact> {
        let line = GapLine {
            min_gap: self.line.min_gap - reduction * self.line.noise.point_error(),
            ..self.line
        };
        let start = self.bodies.supporting_plane(found.plane.normal).0;
        let mut behind = bound_crossing(&mut self.bodies, &line, start, f64::INFINITY);
        self.steps.pivots += behind.samples;
        let (met, plane) = (behind.lower, behind.plane);
        behind.lower = self.line.lower_bound(&plane)?;
        for step in 1..=MAX_STEPS_BEHIND {
            if behind.near_point.is_some() {
                break;
            }
            let from = met + self.line.bound_width(&plane, f64::from(step));
            let look = self.bodies.sample(self.line.unit * from);
            self.steps.pivots += 1;
            behind.record_point(&self.line, &look);
        }
        let width = behind.near_point?.upper - behind.lower;
        let is_explained = width <= self.line.bound_width(&plane, MAX_WIDTH_GLIDING);
        is_explained.then(|| self.build_contact(&behind, width))
    }

    /// Returns the contact of bodies that graze, with any difference of its bounds.
    fn grazing_contact(&self, found: &FoundBounds<'s, 'a, 'o, O>) -> Contact {
        self.build_contact(found, self.line.bound_width(&found.plane, MAX_WIDTH))
    }

    /// Builds the contact from a plane and, if it was found, a point.
    fn build_contact(&self, found: &FoundBounds<'s, 'a, 'o, O>, rounding: f64) -> Contact {
        let setting = self.bodies.setting;
        let plane = &found.plane;
        let steepness = plane.normal.dot(setting.direction);
        let lower = ((plane.height - self.line.min_gap) / steepness).next_down();
        let certain =
            found.near_point.and_then(|near| Some((self.certified_upper_bound(&near)?, near)));
        let (upper, value, (pairs, weights)) = match certain {
            Some((upper, near)) => {
                let value = self.line.estimate_crossing(near.point).map(|s| s / setting.length);
                (upper, value.unwrap_or(upper), near.spot)
            }
            None => (f64::INFINITY, lower, ([plane.support; 3], [1.0, 0.0, 0.0])),
        };
        Contact {
            translation: value.min(upper).max(lower),
            normal: plane.normal,
            support: plane.support,
            certificate: Certificate {
                normal: plane.normal,
                lower,
                pairs,
                weights,
                upper,
                rounding: rounding / setting.length,
            },
            solver: self.reported_solver(),
            steps: self.total_steps(),
        }
    }

    /// Returns the upper bound in multiples of the direction. `None` if, rounded up, it is no longer as near as
    /// the gap.
    fn certified_upper_bound(&self, near: &NearPoint<WeightedPairs>) -> Option<f64> {
        let setting = self.bodies.setting;
        let upper = (near.upper / setting.length).next_up();
        self.line.is_within_gap(near.point - setting.direction * upper).then_some(upper)
    }
}

fn not_converged(reason: Stalled) -> QueryError {
    QueryError::NotConverged { reason }
}

/// Returns the separation of the bodies, from the margin of their cores.
fn separation_of_bodies(setting: &Setting, normal: DVec3, core_margin: f64) -> Separation {
    Separation { normal, margin: setting.less_radii(core_margin) }
}

/// Lowers the outcome of cores without a gap by a slight gap, the minimum gap `min_gap` plus both radii. `None` for
/// separated cores whose margin does not prove the gap: only a search with the gap decides.
fn lower_by_slight_gap(setting: &Setting, min_gap: f64, outcome: Outcome) -> Option<Outcome> {
    let [_, gap] = setting.core_gap_bounds(min_gap);
    let nearer = |contact: Contact| {
        let certificate = contact.certificate;
        let back = gap / contact.normal.dot(setting.direction);
        let lower = (certificate.lower - back).next_down();
        let certificate =
            Certificate { lower, rounding: certificate.rounding + back, ..certificate };
        Contact { translation: (contact.translation - back).max(lower), certificate, ..contact }
    };
    match outcome {
        Outcome::Contact(contact) => Some(Outcome::Contact(nearer(contact))),
        Outcome::Grazing(of) => Some(Outcome::Grazing(Grazing {
            overlap: of.overlap + gap,
            contact: nearer(of.contact),
            ..of
        })),
        Outcome::Separated(of) => {
            let Separation { normal, margin } = of.certificate;
            let certificate = separation_of_bodies(setting, normal, margin);
            let proven = certificate.verify_with_gap(setting, min_gap).is_ok();
            proven.then_some(Outcome::Separated(Separated { certificate, ..of }))
        }
    }
}
