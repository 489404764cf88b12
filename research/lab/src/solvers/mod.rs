//! The compared solvers: every algorithm behind one trait.

mod cost;

use colltrans::observe::Observer;
use colltrans::{Focus, Options, Outcome, QueryError, Solver, Steps, Tracker, cta};
use colltrans_baselines::egjk::{Egjk, SupportSearch};
use colltrans_baselines::growth::GrowthDistance;
use colltrans_baselines::hwalk::HWalk;
use colltrans_baselines::mpr::Mpr;
use colltrans_baselines::pqp::Pqp;
use colltrans_baselines::raycast::{RayCast, RayCastAnswer};
use colltrans_baselines::vclip::VClip;

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
    /// The paper's algorithm without coherence, with each planar problem solved from scratch, as its section
    /// V-F describes.
    CtaColdScratch,
    /// The paper's incremental algorithm with each planar problem solved from scratch.
    CtaCold(cta::Region),
    /// The minimisation without coherence with cuts through the centroid, as in the earlier method.
    CtaCentroid,
    /// The default of `colltrans` for single queries: portal refinement.
    Portal,
    /// The default of `colltrans` for sequences of queries: feature focus.
    Tracker,
    /// Distance by enhanced GJK, from scratch.
    Egjk(SupportSearch),
    /// Distance by enhanced GJK in a sequence of queries.
    EgjkTracked,
    /// Distance by swept sphere trees over triangles.
    Pqp,
    /// Distance by H-Walk with a start layer: the paper's `l`, as a share of the range from the finest to the
    /// coarsest layer.
    HWalk(f64),
    /// Distance by V-Clip.
    VClip,
    /// Collision translation by GJK ray cast, to `1e-6` of the size; not exact.
    RayCast,
    /// Overlap by `colltrans`.
    Intersects,
    /// Overlap by Minkowski portal refinement, to `1e-6` of the size; not exact.
    Mpr,
    /// Growth distance by cutting planes, to a relative gap of the square root of the machine epsilon.
    Growth,
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

/// Returns options of the complete minimisation with each planar problem solved from scratch.
fn cold_problems() -> Options {
    cta_options(cta::Options::default().with_starts_cold(true))
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
    /// Whether the bodies overlap at the start.
    Overlap(bool),
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
            Self::CtaColdScratch => "CTA, planar problems cold".into(),
            Self::CtaCentroid => "cuts through the centroid".into(),
            Self::CtaCold(_) => "CTA, region focus, planar problems cold".into(),
            Self::Portal => "portal refinement".into(),
            Self::Tracker => "feature focus".into(),
            Self::Egjk(SupportSearch::FirstVertex) | Self::EgjkTracked => "EGJK".into(),
            Self::Egjk(SupportSearch::Climbing) => "EGJK, seeds kept".into(),
            Self::Egjk(SupportSearch::Linear) => "EGJK, linear search".into(),
            Self::Pqp => "PQP".into(),
            Self::HWalk(share) => format!("H-Walk, {:.0} % of the layers", 100.0 * share),
            Self::VClip => "V-Clip".into(),
            Self::RayCast => "GJK ray cast".into(),
            Self::Intersects => "overlap by portal refinement".into(),
            Self::Mpr => "MPR".into(),
            Self::Growth => "growth distance".into(),
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
            Self::CtaColdScratch => Box::new(Scratch { bodies, options: cold_problems() }),
            Self::CtaCentroid => Box::new(Scratch { bodies, options: centroid_cuts() }),
            Self::CtaCold(region) => Box::new(Tracked::in_region(bodies, region, cold_problems())),
            Self::Tracker => Box::new(Tracked::new(bodies, Focus::default(), Options::default())),
            Self::Egjk(search) => Box::new(Egjk::new(moving, fixed).with_support_search(search)),
            Self::EgjkTracked => Self::Egjk(SupportSearch::FirstVertex).enter(bodies),
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
            Self::VClip => {
                let [moving, fixed] = bodies.shells();
                Box::new(VClip::new(moving, fixed))
            }
            Self::RayCast => Box::new(RayCast::new(moving, fixed)),
            Self::Intersects => Box::new(Intersects { bodies }),
            Self::Mpr => Box::new(Mpr::new(moving, fixed)),
            Self::Growth => Box::new(GrowthDistance::new(moving, fixed)),
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
        Work { answer, steps: steps.iterations, iterations: steps.iterations + steps.climbed }
    }
}

impl Algorithm for Pqp<'_> {
    fn forget(&mut self) {
        self.reset();
    }

    fn ask(&mut self, setting: &Setting) -> Work {
        let found = self.distance(&setting.moving, &setting.fixed);
        let colltrans_baselines::pqp::Steps { volume_tests, triangle_tests } = found.steps;
        let [steps, iterations] = [volume_tests, volume_tests + triangle_tests]
            .map(|count| u32::try_from(count).unwrap_or(u32::MAX));
        Work { answer: Answer::Distance(found.distance), steps, iterations }
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

impl Algorithm for VClip<'_> {
    fn forget(&mut self) {
        self.reset();
    }

    fn ask(&mut self, setting: &Setting) -> Work {
        let found = self.distance(&setting.moving, &setting.fixed);
        let colltrans_baselines::vclip::Steps { pairs, iterations, .. } = found.steps;
        Work { answer: Answer::Distance(found.distance), steps: pairs, iterations }
    }
}

/// Overlap queries without coherence.
struct Intersects<'a> {
    bodies: &'a Bodies,
}

impl Algorithm for Intersects<'_> {
    fn forget(&mut self) {}

    fn ask(&mut self, setting: &Setting) -> Work {
        let found =
            setting.cast(self.bodies, &Options::default()).and_then(|cast| cast.intersects());
        let Ok(found) = found else {
            return Work { answer: Answer::Failed, steps: 0, iterations: 0 };
        };
        let Steps { supports, pivots, iterations, .. } = found.evidence.outcome.steps();
        let answer = Answer::Overlap(found.meets);
        Work { answer, steps: pivots, iterations: iterations + pivots + supports }
    }
}

impl Algorithm for Mpr<'_> {
    fn forget(&mut self) {
        self.reset();
    }

    fn ask(&mut self, setting: &Setting) -> Work {
        let found = self.overlap(&setting.moving, &setting.fixed);
        let colltrans_baselines::mpr::Steps { portals, climbed } = found.steps;
        let answer = found.overlaps.map_or(Answer::Failed, Answer::Overlap);
        Work { answer, steps: portals, iterations: portals + climbed }
    }
}

impl Algorithm for GrowthDistance<'_> {
    fn forget(&mut self) {
        self.reset();
    }

    fn ask(&mut self, setting: &Setting) -> Work {
        let found = self.distance(&setting.moving, &setting.fixed);
        let colltrans_baselines::growth::Steps { planes, climbed } = found.steps;
        let answer =
            if found.is_converged { Answer::Overlap(found.upper <= 1.0) } else { Answer::Failed };
        Work { answer, steps: planes, iterations: planes + climbed }
    }
}
