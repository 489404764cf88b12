//! The solvers compared: every algorithm behind one trait.

use colltrans::observe::Observer;
use colltrans::{Focus, Options, Outcome, QueryError, Solver, Steps, Tracker, cta};
use colltrans_baselines::egjk::{Egjk, SupportSearch};
use colltrans_baselines::hwalk::HWalk;
use colltrans_baselines::pqp::Pqp;
use colltrans_baselines::raycast::{RayCast, RayCastAnswer};

use crate::settings::Setting;
use crate::shapes::Bodies;

/// An algorithm and its choices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Who {
    /// The paper's algorithm from scratch: from the centre of the levels.
    Cta(Until),
    /// The paper's incremental algorithm: from the region of the last solution, a fixed half-side
    /// being in diameters.
    CtaRegion(cta::Region, Until),
    /// The same to the end, each planar problem from nothing: what its section V-F says of the paper's.
    CtaCold(cta::Region),
    /// What `colltrans` does by default from scratch: portal refinement.
    Portal,
    /// What `colltrans` does by default from query to query: feature focus.
    Tracker,
    /// Distance by enhanced GJK.
    Egjk(SupportSearch),
    /// Distance by swept sphere trees over triangles.
    Pqp,
    /// Distance by H-Walk, features being picked on this layer: the paper's `l`, as a share of the
    /// way from the finest layer to the coarsest.
    HWalk(f64),
    /// Collision translation by GJK ray cast, to `1e-6` of the size: not exact.
    RayCast,
}

/// How far the collision translation algorithm goes before portal refinement takes over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Until {
    /// Most of the way: down to [`PAPER_GAP`]. Portal refinement finds the last feature. This *hybrid* is not
    /// the paper's, and nothing is judged by it.
    Near,
    /// All the way, as published: to the exit test. Portal refinement has nothing left but to confirm.
    End,
    /// All the way, and not as published: where little is left of the region, the shift goes on from
    /// cell to cell, which takes fewer planar problems.
    EndAcrossCells,
}

/// The gap between upper and lower bound at which the collision translation algorithm hands over,
/// as a share of the bodies' extent along the direction.
pub(crate) const PAPER_GAP: f64 = 1e-2;

impl Until {
    /// The paper's minimisation, down to here.
    pub(crate) fn options(self) -> Options {
        let until = match self {
            Self::Near => colltrans::cta::Until::Gap(PAPER_GAP),
            Self::End | Self::EndAcrossCells => colltrans::cta::Until::Exit,
        };
        let keeps_to_cell = self != Self::EndAcrossCells;
        cta(cta::Options::new(cta::Start::Center, until).with_keeps_to_cell(keeps_to_cell))
    }
}

/// The paper's minimisation with these choices.
fn cta(narrowing: cta::Options) -> Options {
    Options::default().with_solver(Solver::Cta).with_narrowing(narrowing)
}

/// To the end with cuts through the centroid, which are not shifted.
pub(crate) fn centroid_cuts() -> Options {
    cta(cta::Options::default().with_cuts(cta::Cuts::Centroid))
}

/// What a solver said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Answer {
    /// The bodies meet after this translation.
    Meet(f64),
    /// The bodies meet, and come within a tolerance of each other at a known translation.
    MeetNearly,
    /// They do not meet.
    Pass,
    /// How far they are apart.
    Distance(f64),
    /// None.
    Failed,
}

/// The answer to one query and the work it took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Work {
    pub(crate) answer: Answer,
    /// The algorithm's own steps: planar problems of the collision translation algorithm, portals,
    /// simplices, pairs of bounding volumes or features.
    pub(crate) steps: u32,
    /// Iterations of all loops, outer and inner, where they are counted (`docs/laboratory.md`).
    pub(crate) iterations: u32,
}

/// An algorithm at work on two bodies.
pub(crate) trait Algorithm {
    /// The next query starts from scratch.
    fn forget(&mut self);
    /// A query; it may start from the one before.
    fn ask(&mut self, setting: &Setting) -> Work;
}

impl Who {
    /// Its name in legends.
    pub(crate) fn name(self) -> String {
        match self {
            Self::Cta(Until::Near) => "hybrid".into(),
            Self::Cta(Until::End) => "CTA".into(),
            Self::Cta(Until::EndAcrossCells) => "CTA across cells".into(),
            Self::CtaRegion(_, Until::Near) => "hybrid, region focus".into(),
            Self::CtaRegion(_, Until::End) => "CTA, region focus".into(),
            Self::CtaRegion(_, Until::EndAcrossCells) => "CTA across cells, region focus".into(),
            Self::CtaCold(_) => "CTA, region focus, planar problems cold".into(),
            Self::Portal => "portal refinement".into(),
            Self::Tracker => "feature focus".into(),
            Self::Egjk(SupportSearch::Climbing) => "EGJK, climbing".into(),
            Self::Egjk(SupportSearch::Linear) => "EGJK, linear search".into(),
            Self::Pqp => "PQP".into(),
            Self::HWalk(share) => format!("H-Walk, {:.0} % of the layers", 100.0 * share),
            Self::RayCast => "GJK ray cast".into(),
        }
    }

    /// Ready to answer. What is made of the bodies beforehand is made here.
    pub(crate) fn enter(self, bodies: &Bodies) -> Box<dyn Algorithm + '_> {
        let [moving, fixed] = &bodies.pair;
        match self {
            Self::Cta(until) => Box::new(Scratch { bodies, options: until.options() }),
            Self::Portal => Box::new(Scratch { bodies, options: Options::default() }),
            Self::CtaRegion(region, until) => {
                Box::new(Tracked::in_region(bodies, region, until.options()))
            }
            Self::CtaCold(region) => {
                let cold = cta(cta::Options::default().with_starts_cold(true));
                Box::new(Tracked::in_region(bodies, region, cold))
            }
            Self::Tracker => Box::new(Tracked::new(bodies, Focus::default(), Options::default())),
            Self::Egjk(search) => Box::new(Egjk::new(moving, fixed).with_support_search(search)),
            Self::Pqp => {
                let [moving, fixed] = bodies.soups();
                Box::new(Pqp::new(moving, fixed))
            }
            Self::HWalk(share) => {
                let [moving, fixed] = bodies.hierarchies();
                let coarsest = moving.layer_count().max(fixed.layer_count()) - 1;
                let layer = (share * coarsest as f64).round() as usize;
                Box::new(HWalk::new(moving, fixed).with_start_layer(layer))
            }
            Self::RayCast => Box::new(RayCast::new(moving, fixed)),
        }
    }
}

/// Casts that know nothing of each other.
struct Scratch<'a> {
    bodies: &'a Bodies,
    options: Options,
}

impl Algorithm for Scratch<'_> {
    fn forget(&mut self) {}

    fn ask(&mut self, setting: &Setting) -> Work {
        work(&setting.cast(self.bodies, &self.options).and_then(|cast| cast.first_contact()))
    }
}

/// Casts that start from the one before.
pub(crate) struct Tracked<'a> {
    bodies: &'a Bodies,
    tracker: Tracker<'a>,
    options: Options,
}

impl<'a> Tracked<'a> {
    /// The paper's incremental algorithm; a fixed half-side of the region is in diameters.
    pub(crate) fn in_region(bodies: &'a Bodies, region: cta::Region, options: Options) -> Self {
        let region = match region {
            cta::Region::Fixed(delta) => cta::Region::Fixed(delta * bodies.diameter),
            region => region,
        };
        Self::new(bodies, Focus::NONE.with_region(region), options)
    }

    /// A query, with somebody who looks on.
    pub(crate) fn watched(
        &mut self,
        setting: &Setting,
        observer: &mut impl Observer,
    ) -> Result<Outcome, QueryError> {
        let cast = setting.cast(self.bodies, &self.options)?;
        self.tracker.first_contact_observed(&cast, observer)
    }

    fn new(bodies: &'a Bodies, focus: Focus, options: Options) -> Self {
        let tracker = Tracker::new().with_focus(focus).expect("half-sides are positive");
        Self { bodies, tracker, options }
    }
}

impl Algorithm for Tracked<'_> {
    fn forget(&mut self) {
        self.tracker.reset();
    }

    fn ask(&mut self, setting: &Setting) -> Work {
        let cast = setting.cast(self.bodies, &self.options);
        work(&cast.and_then(|cast| self.tracker.first_contact(&cast)))
    }
}

fn work<E>(outcome: &Result<Outcome, E>) -> Work {
    let Ok(outcome) = outcome else {
        return Work { answer: Answer::Failed, steps: 0, iterations: 0 };
    };
    let answer = match outcome {
        Outcome::Contact(contact) => Answer::Meet(contact.translation),
        Outcome::Grazing(_) | Outcome::Separated(_) => Answer::Pass,
    };
    let Steps { planar_problems, supports, pivots, iterations, .. } = outcome.steps();
    let steps = if planar_problems == 0 { pivots } else { planar_problems };
    Work { answer, steps, iterations: iterations + planar_problems + pivots + supports }
}

impl Algorithm for Egjk<'_> {
    fn forget(&mut self) {
        self.reset();
    }

    fn ask(&mut self, setting: &Setting) -> Work {
        let found = self.distance(&setting.moving, &setting.fixed);
        let answer = Answer::Distance(found.distance);
        let iterations = found.steps.iterations + found.steps.climbed;
        Work { answer, steps: found.steps.iterations, iterations }
    }
}

impl Algorithm for RayCast<'_> {
    fn forget(&mut self) {
        self.reset();
    }

    fn ask(&mut self, setting: &Setting) -> Work {
        let (answer, steps) = match self.cast(&setting.moving, &setting.fixed, setting.direction) {
            RayCastAnswer::Hit { steps, .. } | RayCastAnswer::InContact { steps, .. } => {
                (Answer::MeetNearly, steps)
            }
            RayCastAnswer::Miss { steps } => (Answer::Pass, steps),
            RayCastAnswer::Exhausted { steps, .. } => (Answer::Failed, steps),
        };
        Work { answer, steps: steps.iterations, iterations: steps.iterations }
    }
}

impl Algorithm for Pqp<'_> {
    fn forget(&mut self) {
        self.reset();
    }

    fn ask(&mut self, setting: &Setting) -> Work {
        let found = self.distance(&setting.moving, &setting.fixed);
        let steps = u32::try_from(found.steps.volume_tests).unwrap_or(u32::MAX);
        Work { answer: Answer::Distance(found.distance), steps, iterations: steps }
    }
}

impl Algorithm for HWalk<'_> {
    fn forget(&mut self) {
        self.reset();
    }

    fn ask(&mut self, setting: &Setting) -> Work {
        let found = self.distance(&setting.moving, &setting.fixed);
        let colltrans_baselines::hwalk::Steps { pairs, iterations, .. } = found.steps;
        Work { answer: Answer::Distance(found.distance), steps: pairs, iterations }
    }
}
