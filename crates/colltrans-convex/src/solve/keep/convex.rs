//! Convex bodies that are to keep a gap: from a setting to an outcome.
//!
//! Notation as in [`super`]. The outcome is that of a cast of a point at `M` grown by a ball of the gap, told apart by
//! the shadows: with `o = g - m`, what the gap takes of the shadow beyond the line, they are *apart* for `o < 0`, for
//! certain; else the bodies *graze* up to the graze tolerance.
//!
//! A *slight* gap, of less than eight noises, leaves no room for a point that is as near for certain. There the bodies are cast as
//! they are: their own contact is an upper bound, and the plane, lowered by the gap, the lower one.

use glam::{DMat3, DVec3};

use super::{Line, Look, Near, Plane, Target, Travel, shadow, travel};
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

/// How far apart, in noises over `n.d`, the bounds of an answer may be.
const WIDEST: f64 = 15.0;

/// The same of bodies that glide: what a check takes for rounding is more.
const WIDEST_GLIDING: f64 = 24.0;

/// By how many noises points are looked for that are nearer than the gap, where those at the gap are not near enough
/// for certain; shadows that overlap by more than grazing do by eight.
const DEEPER: [f64; 4] = [4.0, 2.0, 6.0, 8.0];

/// How far behind such a plane a point is looked for, in noises over `n.d`.
const MOST_BEHIND: u8 = 10;

/// Nearest points and a plane that are so many noises apart are looked for once more.
const STUCK: f64 = 2.0;

/// By how many noises a margin has to be larger than the gap to be proven without being looked at as a check does.
const CLEARLY: f64 = 2.0;

/// `M`, what was found last, and who hears of it.
struct Bodies<'s, 'a, 'o, O> {
    setting: &'s Setting<'a>,
    noise: Noise,
    pairs: NearestPairs,
    observer: &'o mut O,
    /// Support points computed.
    supports: u32,
}

/// Three pairs of vertices and their weights.
type Spot = ([VertexPair; 3], [f64; 3]);

/// The shadow frame, for observers.
fn setting_from_shadow(setting: &Setting) -> DMat3 {
    MinkowskiDifference::new(setting).setting_from_shadow
}

impl<O: Observer> Bodies<'_, '_, '_, O> {
    fn begun(&mut self) {
        let (setting, noise) = (self.setting, self.noise.point());
        let frame = || ShadowFrame { world_from_shadow: setting_from_shadow(setting), noise };
        self.observer.begun(frame);
    }

    /// The plane across a support point, which the observer hears of.
    fn plane(&mut self, normal: DVec3, support: VertexPair, beyond: f64) -> Plane<VertexPair> {
        let setting = self.setting;
        self.observer.support(|| {
            let to_shadow = setting_from_shadow(setting).transpose();
            let at = to_shadow * setting.difference(support);
            Support { normal: to_shadow * normal, at, pair: support }
        });
        let height = normal.dot(self.setting.difference(support));
        let height = height - self.noise.lowered() - beyond;
        Plane { normal, height, beyond, support }
    }
}

impl<O: Observer> Target for Bodies<'_, '_, '_, O> {
    type Support = VertexPair;
    type Spot = Spot;

    fn lowest(&mut self, normal: DVec3) -> (Plane<VertexPair>, DVec3) {
        self.supports += 1;
        let bodies: &TwoBodies = &self.setting.bodies;
        let normals = [bodies.moving_normal(normal), bodies.fixed_normal(normal)];
        let found = VertexPair {
            moving: bodies.moving.support(normals[0]),
            fixed: bodies.fixed.support(-normals[1]),
        };
        let (support, beyond) = bodies.support_with_excess(&normals, found);
        (self.plane(normal, support, beyond), bodies.difference(support))
    }

    fn look(&mut self, from: DVec3) -> Look<VertexPair, Spot> {
        let moved = self.setting.bodies.moved_by(from);
        let difference = Difference::new(&moved);
        let mut found = nearest_points(&difference, &self.pairs, None);
        self.supports += found.supports;
        if found.computed_gap() > STUCK * self.noise.point() {
            // From pairs on a sliver a descent may get nowhere.
            found = nearest_points(&difference, &NearestPairs::default(), None);
            self.supports += found.supports;
        }
        self.pairs = found.pairs();
        let plane = found.plane(&difference);
        let plane = plane.map(|plane| self.plane(plane.gap.normal, plane.lowest, plane.excess));
        let (pairs, weights) = found.points();
        // In the setting itself: the origin is where the body was.
        let corners = [0, 1, 2].map(|k| self.setting.difference(pairs[k]));
        let count = weights.iter().filter(|weight| **weight > 0.0).count();
        let point = mean(&corners, &weights);
        Look { plane, point, spot: (pairs, weights), corners, count }
    }
}

fn mean(corners: &[DVec3; 3], weights: &[f64; 3]) -> DVec3 {
    let sum: f64 = weights.iter().sum();
    corners.iter().zip(weights).map(|(corner, weight)| *corner * (weight / sum)).sum()
}

/// Casts bodies that are to keep a gap, as [`crate::solve::search`] does those that are not.
#[cold]
pub(crate) fn search<O: Observer>(
    setting: &Setting,
    options: &Options,
    focus: &Focus,
    last: &WarmStart,
    next: &mut TrackerUpdate,
    observer: &mut O,
) -> Result<Outcome, QueryError> {
    *next = TrackerUpdate::default();
    if Noise::of(setting.scale() + options.keep).is_slight(options.keep) {
        let touching = Options { keep: 0.0, ..*options };
        let outcome = crate::solve::search(setting, &touching, focus, last, next, observer)?;
        if let Some(outcome) = slightly_apart(setting, options.keep, outcome) {
            return Ok(outcome);
        }
    }
    let last = if focus.features { *last } else { WarmStart::Nothing };
    search_apart(setting, options, &last, next, observer)
}

/// Where bodies that are to keep a gap are first as near as that; leaves in `next` where a later search may start.
fn search_apart<O: Observer>(
    setting: &Setting,
    options: &Options,
    last: &WarmStart,
    next: &mut TrackerUpdate,
    observer: &mut O,
) -> Result<Outcome, QueryError> {
    let size = setting.scale();
    let line = Line::new(setting.unit, options.keep, size);
    let pairs = NearestPairs::default();
    let bodies = Bodies { setting, noise: line.noise, pairs, observer, supports: 0 };
    let mut kept = Kept { options, line, bodies, steps: Steps::default() };
    kept.bodies.begun();
    let start = kept.start(last);
    kept.bodies.observer.ended(Phase::Setup);
    let found = travel(&mut kept.bodies, &line, start, f64::INFINITY);
    kept.bodies.observer.ended(Phase::Finish);
    kept.steps.pivots = found.looks;
    next.start = WarmStart::WithMinGap { normal: found.plane.normal, pairs: kept.bodies.pairs };
    let outcome = kept.outcome(&found);
    next.steps = outcome.as_ref().ok().map(Outcome::steps);
    kept.bodies.observer.ended(Phase::Answer);
    outcome
}

/// One search under way.
struct Kept<'s, 'a, 'o, O> {
    options: &'s Options,
    line: Line,
    bodies: Bodies<'s, 'a, 'o, O>,
    steps: Steps,
}

type Found<'s, 'a, 'o, O> = Travel<Bodies<'s, 'a, 'o, O>>;

impl<'s, 'a, 'o, O: Observer> Kept<'s, 'a, 'o, O> {
    /// The work done so far.
    fn steps(&self) -> Steps {
        Steps { supports: self.bodies.supports, ..self.steps }
    }

    /// The plane to begin with: that of the last search, or one across the line.
    fn start(&mut self, last: &WarmStart) -> Plane<VertexPair> {
        let mut start = self.bodies.lowest(self.line.unit).0;
        if let WarmStart::WithMinGap { normal, pairs } = last {
            self.bodies.pairs = *pairs;
            self.steps.started_from = StartedFrom::Features;
            let plane = self.bodies.lowest(*normal).0;
            if self.line.lower(&plane) > self.line.lower(&start) {
                start = plane;
            }
        }
        start
    }

    /// What was found, by how far the shadows are in each other's way.
    fn outcome(&mut self, found: &Found<'s, 'a, 'o, O>) -> Result<Outcome, QueryError> {
        let keep = self.line.keep;
        let least = 8.0 * self.line.noise.point();
        let tolerance = self.options.graze_tolerance.max(least);
        let aside = |near: &Near<Spot>| near.point.reject_from_normalized(self.line.unit).length();
        if found.near.as_ref().is_some_and(|near| keep - aside(near) > tolerance) {
            return self.contact(found).map(Outcome::Contact);
        }
        let center = |of: DVec3| self.line.unit.cross(of).cross(self.line.unit);
        let setting = self.bodies.setting;
        let between = setting.fixed_matrix * setting.fixed.inertia().center
            - setting.moving_matrix * setting.moving.inertia().center
            + setting.offset;
        let Some(shadow) = shadow(&mut self.bodies, &self.line, center(between)) else {
            return Err(stalled(Stalled::NoPortal));
        };
        if let Some(certificate) = self.separation(&shadow.plane) {
            let (solver, steps) = (self.solver(), self.steps());
            return Ok(Outcome::Separated(Separated { certificate, solver, steps }));
        }
        let overlap = keep - if shadow.distance > 0.0 { shadow.plane.height } else { 0.0 };
        if shadow.distance == 0.0
            && let Some(grazing) = self.slides(found, tolerance)
        {
            return Ok(Outcome::Grazing(grazing));
        }
        if overlap > tolerance || shadow.distance == 0.0 {
            return self.contact(found).map(Outcome::Contact);
        }
        let separating_direction = shadow.plane.normal;
        let contact = self.grazed(found);
        Ok(Outcome::Grazing(Grazing { separating_direction, overlap, contact }))
    }

    /// Whether the bodies graze although their shadows overlap: by less than the tolerance, with the gap.
    fn slides(&self, found: &Found<'s, 'a, 'o, O>, tolerance: f64) -> Option<Grazing> {
        let keep = self.line.keep;
        if keep >= tolerance {
            return None;
        }
        let plain = Options { keep: 0.0, graze_tolerance: tolerance - keep, ..*self.options };
        let (last, mut next) = (WarmStart::Nothing, TrackerUpdate::default());
        let setting = self.bodies.setting;
        let outcome =
            crate::solve::search(setting, &plain, &Focus::NONE, &last, &mut next, &mut NoObserver);
        let Ok(Outcome::Grazing(of)) = outcome else { return None };
        Some(Grazing { overlap: of.overlap + keep, contact: self.grazed(found), ..of })
    }

    /// The separation that a plane along the line proves.
    fn separation(&self, plane: &Plane<VertexPair>) -> Option<Separation> {
        let certificate = Separation { normal: plane.normal, margin: plane.height };
        let surely = self.line.keep + CLEARLY * self.line.noise.point();
        let proven = plane.height > surely
            || plane.height > self.line.keep
                && certificate.verify_with_gap(self.bodies.setting, self.line.keep).is_ok();
        proven.then_some(certificate)
    }

    fn solver(&self) -> Solver {
        match self.options.solver {
            Solver::Auto => Solver::Portal,
            solver => solver,
        }
    }

    /// The contact, if its bounds are no farther apart than rounding explains.
    fn contact(&mut self, found: &Found<'s, 'a, 'o, O>) -> Result<Contact, QueryError> {
        let tolerance = self.line.rounding(&found.plane, WIDEST);
        let upper = found.near.map_or(f64::INFINITY, |near| near.upper);
        if upper - found.lower <= tolerance {
            return Ok(self.contact_of(found, tolerance));
        }
        if let Some(contact) = self.glided(found) {
            return Ok(contact);
        }
        let length = self.bodies.setting.length;
        let [lower, upper, tolerance] = [found.lower, upper, tolerance].map(|s| s / length);
        Err(stalled(Stalled::Gap { lower, upper, tolerance }))
    }

    /// The contact of bodies that glide at about the gap: a face that is all but along the direction comes nearer by so
    /// little that points are as near for certain only far behind its front edge. That face says how far: its
    /// plane is met where a smaller gap is asked for, and the bounds are as far apart as it is slanting. The best
    /// estimate is still where the front edge is met.
    #[cold]
    fn glided(&mut self, found: &Found<'s, 'a, 'o, O>) -> Option<Contact> {
        let contact = DEEPER.iter().find_map(|deeper| self.behind_edge(found, *deeper))?;
        let Certificate { lower, upper, .. } = contact.certificate;
        let translation = (found.lower / self.bodies.setting.length).min(upper).max(lower);
        Some(Contact { translation, ..contact })
    }

    /// The same by a plane that is met at a gap that is so many noises smaller.
    fn behind_edge(&mut self, found: &Found<'s, 'a, 'o, O>, deeper: f64) -> Option<Contact> {
        let line = Line { keep: self.line.keep - deeper * self.line.noise.point(), ..self.line };
        let start = self.bodies.lowest(found.plane.normal).0;
        let mut behind = travel(&mut self.bodies, &line, start, f64::INFINITY);
        self.steps.pivots += behind.looks;
        let (met, plane) = (behind.lower, behind.plane);
        behind.lower = self.line.lower(&plane)?;
        for ahead in 1..=MOST_BEHIND {
            if behind.near.is_some() {
                break;
            }
            let from = met + self.line.rounding(&plane, f64::from(ahead));
            let look = self.bodies.look(self.line.unit * from);
            self.steps.pivots += 1;
            behind.note_point(&self.line, &look);
        }
        let width = behind.near?.upper - behind.lower;
        let is_explained = width <= self.line.rounding(&plane, WIDEST_GLIDING);
        is_explained.then(|| self.contact_of(&behind, width))
    }

    /// The contact of bodies that graze, whatever its bounds.
    fn grazed(&self, found: &Found<'s, 'a, 'o, O>) -> Contact {
        self.contact_of(found, self.line.rounding(&found.plane, WIDEST))
    }

    fn contact_of(&self, found: &Found<'s, 'a, 'o, O>, rounding: f64) -> Contact {
        let setting = self.bodies.setting;
        let plane = &found.plane;
        let steepness = plane.normal.dot(setting.direction);
        let lower = ((plane.height - self.line.keep) / steepness).next_down();
        let certain = found.near.and_then(|near| Some((self.upper(&near)?, near)));
        let (upper, value, (pairs, weights)) = match certain {
            Some((upper, near)) => {
                let value = self.line.estimate(near.point).map(|s| s / setting.length);
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
            solver: self.solver(),
            steps: self.steps(),
        }
    }

    /// The upper bound in multiples of the direction, once more as near as the gap.
    fn upper(&self, near: &Near<Spot>) -> Option<f64> {
        let setting = self.bodies.setting;
        let upper = (near.upper / setting.length).next_up();
        self.line.is_near(near.point - setting.direction * upper).then_some(upper)
    }
}

fn stalled(reason: Stalled) -> QueryError {
    QueryError::NotConverged { reason }
}

/// The outcome of bodies that keep a slight gap, from that of the bodies as they are; `None` if only a search for the gap can tell.
fn slightly_apart(setting: &Setting, keep: f64, outcome: Outcome) -> Option<Outcome> {
    let nearer = |contact: Contact| {
        let certificate = contact.certificate;
        let back = keep / contact.normal.dot(setting.direction);
        let lower = (certificate.lower - back).next_down();
        let certificate =
            Certificate { lower, rounding: certificate.rounding + back, ..certificate };
        Contact { translation: (contact.translation - back).max(lower), certificate, ..contact }
    };
    match outcome {
        Outcome::Contact(contact) => Some(Outcome::Contact(nearer(contact))),
        Outcome::Grazing(of) => Some(Outcome::Grazing(Grazing {
            overlap: of.overlap + keep,
            contact: nearer(of.contact),
            ..of
        })),
        Outcome::Separated(of) => {
            let proven = of.certificate.verify_with_gap(setting, keep).is_ok();
            proven.then_some(Outcome::Separated(of))
        }
    }
}
