//! One cast: from a setting, and what is left of the one before, to an outcome.
//!
//! The way: *features* (the portal or the separating direction of the last answer, if there is one)
//! -> *narrowing* (a guess of the normal, from ellipsoids or by the collision translation
//! algorithm, which may confine itself to the *region* of the last solution) -> a first portal ->
//! the lowest face. The first two only save work: whatever they propose passes through the same
//! enclosure and refinement, so a wrong proposal costs time and nothing else.

use glam::{DVec2, DVec3};

use crate::answer::{self, Proven};
use crate::cta::{self, ContactGuess, CtaOptions, CtaStart, Guess, RegionFocus};
use crate::error::QueryError;
use crate::minkowski::Difference;
use crate::options::{self, Focus, Narrowing, Options, Region};
use crate::outcome::{Grazing, Outcome, Path, Separated, Solver, Steps};
use crate::portal::{self, Enclosure, Followed, Met, OneSide, Overlap, Portal, Refined, Start};
use crate::pose::Pose;
use crate::profile::{Phase, lap};
use crate::setting::{Setting, VertexPair};

/// What a query leaves to the next one: the features it ended with.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) enum Trace {
    /// Nothing yet.
    #[default]
    Nothing,
    /// The bodies met.
    Contact(Met),
    /// They passed each other, or grazed.
    Apart {
        /// The separating direction, in the frames of the moving and of the fixed body.
        normals: [DVec3; 2],
        /// A pair of vertices extreme along it.
        pair: VertexPair,
    },
}

/// Casts, starting from `trace` as far as `focus` allows, and leaves the new trace there.
#[inline]
pub(crate) fn search(
    setting: &Setting,
    moving_pose: &Pose,
    options: &Options,
    focus: &Focus,
    trace: &mut Trace,
) -> Result<Outcome, QueryError> {
    options.check()?;
    let solver = match options.solver {
        Solver::Auto => Solver::Portal,
        solver => solver,
    };
    let last = std::mem::take(trace);
    let mut first = Search {
        difference: Difference::new(setting),
        moving_pose,
        graze_tolerance: options.graze_tolerance,
        solver,
        narrowing: options.narrowing,
        steps: Steps::default(),
    };
    let mut answer = first.run(focus, &last, trace);
    lap(Phase::Answer);
    if let Err(QueryError::NotConverged { .. }) = answer {
        let turns_rad: &[f64] =
            if first.steps.path == Path::Scratch { &OTHER_TURNS_RAD } else { &ALL_TURNS_RAD };
        answer = again(first.steps, turns_rad, |turn_rad, steps| {
            let difference = Difference::turned_by(setting, turn_rad);
            let mut next = Search { difference, steps: *steps, ..first };
            let answer = next.run(&Focus::NONE, &Trace::Nothing, trace);
            *steps = next.steps;
            answer
        });
    }
    answer
}

/// Tries turns of the lateral axes from scratch until there is an answer.
#[cold]
fn again(
    steps: Steps,
    turns_rad: &[f64],
    mut run: impl FnMut(f64, &mut Steps) -> Result<Outcome, QueryError>,
) -> Result<Outcome, QueryError> {
    let mut steps = Steps { path: Path::Scratch, ..steps };
    let mut answer = run(turns_rad[0], &mut steps);
    for &turn_rad in &turns_rad[1..] {
        let Err(QueryError::NotConverged { .. }) = answer else { break };
        answer = run(turn_rad, &mut steps);
    }
    answer
}

/// Turns of the lateral axes: ties that follow each other in a circle in one frame do not in
/// another.
const ALL_TURNS_RAD: [f64; 3] = [0.0, 0.7, 2.1];
const OTHER_TURNS_RAD: [f64; 2] = [0.7, 2.1];

/// A followed portal that is this many exchanges from the lowest face was a bad place to start, or
/// one where ties follow each other.
const MOST_AFTER_FOLLOWING: usize = 30;

/// One cast under way.
struct Search<'a> {
    difference: Difference<'a>,
    moving_pose: &'a Pose,
    graze_tolerance: f64,
    solver: Solver,
    narrowing: Narrowing,
    steps: Steps,
}

impl Search<'_> {
    fn run(
        &mut self,
        focus: &Focus,
        last: &Trace,
        next: &mut Trace,
    ) -> Result<Outcome, QueryError> {
        let followed = if focus.features { self.follow(last) } else { None };
        let enclosure = if followed.is_some() {
            self.steps.path = Path::Features;
            followed
        } else {
            let start = self.start(focus.region, last);
            lap(Phase::Setup);
            match self.approach(&start) {
                None => portal::enclose(&self.difference, &start, &mut self.steps),
                found => found,
            }
        };
        lap(Phase::Finish);
        let noise = self.difference.noise;
        match enclosure {
            None => Err(self.not_converged()),
            Some(Enclosure::Portal(mut portal)) => self.contact_or_grazing(&mut portal, next),
            Some(Enclosure::OneSide(found)) if found.margin > noise => {
                Ok(Outcome::Separated(self.separated(&found, next)))
            }
            Some(Enclosure::OneSide(found)) => {
                let widest = portal::widest_margin(&self.difference, found, &mut self.steps);
                if widest.margin > noise {
                    return Ok(Outcome::Separated(self.separated(&widest, next)));
                }
                self.touching(&widest, next).map(Outcome::Grazing)
            }
        }
    }

    /// Feature focus: a portal, or a separating direction, from those of the last answer.
    fn follow(&mut self, last: &Trace) -> Option<Enclosure> {
        match last {
            Trace::Nothing => None,
            Trace::Contact(met) => match portal::follow(&self.difference, met, &mut self.steps) {
                Followed::Portal(portal) => Some(Enclosure::Portal(portal)),
                Followed::Rim { outward, near } => self.one_side(-outward, near),
                Followed::Lost => None,
            },
            Trace::Apart { normals, pair } => {
                let [p, q] = self.difference.turned(*normals)?;
                self.one_side((p + q).truncate(), *pair)
            }
        }
    }

    /// A portal, or a separating direction, face by face from a guess that is not lateral.
    #[inline]
    fn approach(&mut self, start: &Start) -> Option<Enclosure> {
        if start.normal.z <= 0.0 {
            return None;
        }
        match portal::approach(&self.difference, start, &mut self.steps) {
            Followed::Portal(portal) => Some(Enclosure::Portal(portal)),
            Followed::Rim { outward, near } => self.one_side(-outward, near),
            Followed::Lost => None,
        }
    }

    /// Whether all of `M` lies beyond a lateral direction.
    fn one_side(&mut self, lateral: DVec2, near: VertexPair) -> Option<Enclosure> {
        // Of a length fit to be normalised: shorter ones lose digits.
        if lateral.length_squared() <= f64::MIN_POSITIVE {
            return None;
        }
        let normal = lateral.try_normalize()?;
        let least = -self.difference.touching();
        if normal.dot(self.difference.vertex(near).shadow()) < least {
            return None;
        }
        self.steps.supports += 1;
        let point = self.difference.support_from(normal.extend(0.0), near);
        let margin = normal.dot(point.shadow());
        (margin >= least).then_some(Enclosure::OneSide(OneSide { normal, margin, point }))
    }

    /// The first guess of the contact normal.
    fn start(&mut self, region: Region, last: &Trace) -> Start {
        let setting = self.difference.setting;
        let solid = setting.moving.dimension() == 3 && setting.fixed.dimension() == 3;
        if self.solver != Solver::Cta || !solid {
            return Start::new(&self.difference);
        }
        let ellipsoids = Start::from_ellipsoids(&self.difference);
        let start = match self.cta_start(&ellipsoids, region, last) {
            Ok(start) => start,
            Err(extreme) => return ellipsoids.guided(ellipsoids.normal, extreme),
        };
        lap(Phase::Setup);
        let narrowed = cta::minimise(setting, &CtaOptions::new(start, self.narrowing.gap));
        self.steps.planar_problems += narrowed.planar_problems;
        let [moving, fixed] = narrowed.vertices;
        let near = VertexPair { moving: moving[0], fixed: fixed[0] };
        let in_shadow = |normal| self.difference.axes.transpose() * normal;
        match narrowed.guess {
            Guess::Contact { normal } => ellipsoids.guided(in_shadow(normal), near),
            Guess::Separation { direction } => {
                ellipsoids.guided(in_shadow(direction).with_z(0.0), near)
            }
            Guess::Nothing => ellipsoids,
        }
    }

    /// Where the minimisation starts; an error, with the pair extreme along it, if the ellipsoids'
    /// normal already separates the bodies.
    fn cta_start(
        &mut self,
        ellipsoids: &Start,
        region: Region,
        last: &Trace,
    ) -> Result<CtaStart, VertexPair> {
        let by_ellipsoids = self.narrowing.start == options::Start::Ellipsoids;
        let normal = ellipsoids.normal;
        if by_ellipsoids && normal.z == 0.0 {
            self.steps.supports += 1;
            let support = self.difference.support(normal);
            if normal.dot(support.at) > 0.0 {
                return Err(support.pair);
            }
        }
        if let Some(focus) = self.region(region, last) {
            self.steps.path = Path::Region;
            return Ok(CtaStart::Region(focus));
        }
        if !by_ellipsoids || normal.z == 0.0 {
            return Ok(CtaStart::Center);
        }
        self.steps.supports += 1;
        let support = self.difference.support(normal);
        Ok(CtaStart::Contact(ContactGuess {
            normal: self.difference.axes * normal,
            supports: [support.pair.moving, support.pair.fixed],
            touching: ellipsoids.touching(&self.difference),
        }))
    }

    /// Region focus: the last contact points, and the half-side of the square around them.
    fn region(&self, region: Region, last: &Trace) -> Option<RegionFocus> {
        let setting = self.difference.setting;
        let (touching, normals) = match last {
            Trace::Nothing => return None,
            Trace::Contact(met) => (setting.weighted(&met.pairs, &met.weights), met.normals),
            Trace::Apart { pair, normals } => (setting.vertices(*pair), *normals),
        };
        let half_side = match region {
            Region::Everywhere => return None,
            Region::Fixed(delta) => delta,
            Region::Automatic => {
                self.difference.turned(normals)?;
                setting.displacement(touching)
            }
        };
        let worth = region != Region::Automatic || self.difference.is_near(half_side);
        worth.then_some(RegionFocus { touching, half_side })
    }

    fn contact_or_grazing(
        &mut self,
        portal: &mut Portal,
        next: &mut Trace,
    ) -> Result<Outcome, QueryError> {
        let most = match self.steps.path {
            Path::Features => MOST_AFTER_FOLLOWING,
            Path::Region | Path::Scratch => portal::MAX_PORTALS,
        };
        let optimum = match portal::refine(&self.difference, portal, most, &mut self.steps) {
            Some(Refined::Optimum(optimum)) => optimum,
            Some(Refined::Rim(rim)) => return self.touching(&rim, next).map(Outcome::Grazing),
            None => return Err(self.not_converged()),
        };
        let tolerance = self.graze_tolerance.max(self.difference.touching());
        let overlap = portal::overlap(&self.difference, portal, tolerance, &mut self.steps);
        lap(Phase::Finish);
        let proven = Proven::new(&self.difference, portal, &optimum)?;
        *next = Trace::Contact(proven.met());
        match overlap {
            Overlap::Ample => {
                Ok(Outcome::Contact(proven.contact(self.moving_pose, self.solver, self.steps)))
            }
            Overlap::Slight { inward, depth } => {
                let contact = proven.contact(self.moving_pose, self.solver, self.steps);
                let grazing = answer::grazing(&self.difference, inward, depth, contact);
                Ok(Outcome::Grazing(grazing))
            }
        }
    }

    /// The shadow of `M` ends at the line, or misses it by less than rounding can tell: the contact
    /// of the bodies widened sideways by a little more than that.
    #[cold]
    fn touching(&mut self, rim: &OneSide, next: &mut Trace) -> Result<Grazing, QueryError> {
        self.difference = self.difference.widened(rim.margin);
        let start = Start::from_ellipsoids(&self.difference);
        let Some(Enclosure::Portal(mut portal)) =
            portal::enclose(&self.difference, &start, &mut self.steps)
        else {
            return Err(self.not_converged());
        };
        let Some(Refined::Optimum(optimum)) =
            portal::refine(&self.difference, &mut portal, portal::MAX_PORTALS, &mut self.steps)
        else {
            return Err(self.not_converged());
        };
        let proven = Proven::new(&self.difference, &portal, &optimum)?;
        let contact = proven.contact(self.moving_pose, self.solver, self.steps);
        let grazing = answer::grazing(&self.difference, rim.normal, -rim.margin, contact);
        *next = self.apart(grazing.separating_direction, rim);
        Ok(grazing)
    }

    fn separated(&self, found: &OneSide, next: &mut Trace) -> Separated {
        let separated = answer::separated(&self.difference, found, self.solver, self.steps);
        *next = self.apart(separated.certificate.normal, found);
        separated
    }

    fn apart(&self, normal: DVec3, found: &OneSide) -> Trace {
        let setting = self.difference.setting;
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        Trace::Apart { normals, pair: found.point.pair }
    }

    fn not_converged(&self) -> QueryError {
        QueryError::NotConverged {
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            tolerance: self.difference.noise,
        }
    }
}
