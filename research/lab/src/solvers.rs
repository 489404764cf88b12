//! The compared solvers: every algorithm behind one trait.

use colltrans::observe::Observer;
use colltrans::{Focus, Options, Outcome, QueryError, Solver, Steps, Tracker, cta};
use colltrans_baselines::egjk::{Egjk, SupportSearch};
use colltrans_baselines::hwalk::HWalk;
use colltrans_baselines::pqp::Pqp;
use colltrans_baselines::raycast::{RayCast, RayCastAnswer};

use crate::settings::Setting;
use crate::shapes::Bodies;

/// An algorithm with its options.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Who {
    /// The paper's algorithm without coherence, starting at the centre of the levels.
    Cta(Until),
    /// The paper's incremental algorithm, starting in the region of the last solution. A fixed half side is
    /// in diameters.
    CtaRegion(cta::Region, Until),
    /// The paper's incremental algorithm with each planar problem solved from scratch, as its section V-F
    /// describes.
    CtaCold(cta::Region),
    /// The default of `colltrans` for single queries: portal refinement.
    Portal,
    /// The default of `colltrans` for sequences of queries: feature focus.
    Tracker,
    /// Distance by enhanced GJK.
    Egjk(SupportSearch),
    /// Distance by swept sphere trees over triangles.
    Pqp,
    /// Distance by H-Walk with a start layer: the paper's `l`, as a share of the range from the finest to the
    /// coarsest layer.
    HWalk(f64),
    /// Collision translation by GJK ray cast, to `1e-6` of the size; not exact.
    RayCast,
}

/// Stage at which portal refinement replaces the collision translation algorithm (CTA).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Until {
    /// At a gap of [`PAPER_GAP`]. Portal refinement finds the last feature. This *hybrid* is not the paper's,
    /// and no claim is judged by it.
    Near,
    /// At the exit test, as published. Portal refinement only confirms the result.
    End,
    /// At the exit test, with a modification: where little of the region remains, the shift continues from
    /// cell to cell, which needs fewer planar problems.
    EndAcrossCells,
}

/// Gap between upper and lower bound at which the hybrid changes to portal refinement, as a share of the
/// bodies' extent along the direction.
pub(crate) const PAPER_GAP: f64 = 1e-2;

impl Until {
    /// Returns the options of the paper's minimisation down to this stage.
    pub(crate) fn options(self) -> Options {
        let until = match self {
            Self::Near => colltrans::cta::Until::Gap(PAPER_GAP),
            Self::End | Self::EndAcrossCells => colltrans::cta::Until::Exit,
        };
        let keeps_to_cell = self != Self::EndAcrossCells;
        cta_options(cta::Options::new(cta::Start::Center, until).with_keeps_to_cell(keeps_to_cell))
    }
}

/// Returns the options of the paper's minimisation.
fn cta_options(narrowing: cta::Options) -> Options {
    Options::default().with_solver(Solver::Cta).with_narrowing(narrowing)
}

/// Returns options of the complete minimisation with unshifted cuts through the centroid.
pub(crate) fn centroid_cuts() -> Options {
    cta_options(cta::Options::default().with_cuts(cta::Cuts::Centroid))
}

/// Answer of a solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Answer {
    /// The bodies meet after this translation.
    Meet(f64),
    /// The bodies come within a tolerance of each other.
    MeetNearly,
    /// The bodies do not meet.
    Pass,
    /// Distance of the bodies.
    Distance(f64),
    /// The solver failed.
    Failed,
}

/// Answer to a query, and the work for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Work {
    pub(crate) answer: Answer,
    /// Steps of the algorithm: planar problems of CTA, portals, simplices, or pairs of bounding volumes or
    /// features.
    pub(crate) steps: u32,
    /// Iterations of all loops, outer and inner, where they are counted (`docs/laboratory.md`).
    pub(crate) iterations: u32,
}

/// An algorithm for queries on two bodies.
pub(crate) trait Algorithm {
    /// Discards coherence: the next query starts from scratch.
    fn forget(&mut self);
    /// Answers a query, possibly starting from the previous one.
    fn ask(&mut self, setting: &Setting) -> Work;
}

impl Who {
    /// Returns the name in legends.
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

    /// Prepares the algorithm for two bodies, including data structures that are computed once.
    pub(crate) fn enter(self, bodies: &Bodies) -> Box<dyn Algorithm + '_> {
        let [moving, fixed] = &bodies.pair;
        match self {
            Self::Cta(until) => Box::new(Scratch { bodies, options: until.options() }),
            Self::Portal => Box::new(Scratch { bodies, options: Options::default() }),
            Self::CtaRegion(region, until) => {
                Box::new(Tracked::in_region(bodies, region, until.options()))
            }
            Self::CtaCold(region) => {
                let cold = cta_options(cta::Options::default().with_starts_cold(true));
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

/// Casts without coherence.
struct Scratch<'a> {
    bodies: &'a Bodies,
    options: Options,
}

impl Algorithm for Scratch<'_> {
    fn forget(&mut self) {}

    fn ask(&mut self, setting: &Setting) -> Work {
        work_of_outcome(
            &setting.cast(self.bodies, &self.options).and_then(|cast| cast.first_contact()),
        )
    }
}

/// Casts with coherence.
pub(crate) struct Tracked<'a> {
    bodies: &'a Bodies,
    tracker: Tracker<'a>,
    options: Options,
}

impl<'a> Tracked<'a> {
    /// Creates the paper's incremental algorithm; a fixed half side of the region is in diameters.
    pub(crate) fn in_region(bodies: &'a Bodies, region: cta::Region, options: Options) -> Self {
        let region = match region {
            cta::Region::Fixed(delta) => cta::Region::Fixed(delta * bodies.diameter),
            region => region,
        };
        Self::new(bodies, Focus::NONE.with_region(region), options)
    }

    /// Answers a query with an observer.
    pub(crate) fn watched(
        &mut self,
        setting: &Setting,
        observer: &mut impl Observer,
    ) -> Result<Outcome, QueryError> {
        let cast = setting.cast(self.bodies, &self.options)?;
        self.tracker.first_contact_observed(&cast, observer)
    }

    /// Creates a tracker with a focus.
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
        work_of_outcome(&cast.and_then(|cast| self.tracker.first_contact(&cast)))
    }
}

/// Converts an outcome.
fn work_of_outcome<E>(outcome: &Result<Outcome, E>) -> Work {
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
