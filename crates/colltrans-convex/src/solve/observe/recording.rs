//! Records all events of a query, for a picture or a replay.

use glam::{DVec2, DVec3};

use super::{Cut, Observer, Phase, PlanarProblem, Sections, ShadowFrame, Support};

/// One event of a query.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// A search began.
    SearchStarted(ShadowFrame),
    /// A support point was computed.
    Support(Support),
    /// A portal was reached. Contains its corners in the shadow frame.
    Portal([DVec3; 3]),
    /// A minimisation over pairs of sections began.
    Sections(Sections),
    /// A planar problem was solved.
    PlanarProblem(PlanarProblem),
    /// The cell of the last planar problem was computed. Contains its corners, each a pair of levels.
    Cell(Vec<DVec2>),
    /// The exit test was evaluated. `true` if the best point of the cell is recognised as the solution.
    ExitTest(bool),
    /// The region of levels was cut.
    Cut(Cut),
    /// A phase ended.
    PhaseEnded(Phase),
}

/// An [`Observer`] that records all events in their order.
///
/// ```
/// # use colltrans::glam::DVec3;
/// # use colltrans::observe::{Event, Recording};
/// # use colltrans::{Cast, ConvexPolyhedron, Pose, Solver};
/// let body = ConvexPolyhedron::from_points(&[DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO])?;
/// let start = Pose::from_translation(DVec3::new(-5.0, 0.1, 0.1))?;
/// let mut recording = Recording::default();
/// let cast = Cast::new(body.at(start), body.at(Pose::IDENTITY), DVec3::X)?;
/// let outcome = cast.with_solver(Solver::Cta).first_contact_observed(&mut recording)?;
/// let planar = recording.events().iter().filter(|e| matches!(e, Event::PlanarProblem(_)));
/// assert_eq!(planar.count(), outcome.steps().planar_problems as usize);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    events: Vec<Event>,
}

impl Recording {
    /// Returns the recorded events.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Removes all events.
    pub fn clear(&mut self) {
        self.events.clear();
    }
}

impl Observer for Recording {
    fn search_started(&mut self, frame: impl FnOnce() -> ShadowFrame) {
        self.events.push(Event::SearchStarted(frame()));
    }

    fn support(&mut self, support: impl FnOnce() -> Support) {
        self.events.push(Event::Support(support()));
    }

    fn portal(&mut self, corners: impl FnOnce() -> [DVec3; 3]) {
        self.events.push(Event::Portal(corners()));
    }

    fn sections(&mut self, sections: impl FnOnce() -> Sections) {
        self.events.push(Event::Sections(sections()));
    }

    fn planar_problem(&mut self, problem: impl FnOnce() -> PlanarProblem) {
        self.events.push(Event::PlanarProblem(problem()));
    }

    fn cell(&mut self, corners: impl FnOnce() -> Vec<DVec2>) {
        self.events.push(Event::Cell(corners()));
    }

    fn exit_test(&mut self, solved: impl FnOnce() -> bool) {
        self.events.push(Event::ExitTest(solved()));
    }

    fn cut(&mut self, cut: impl FnOnce() -> Cut) {
        self.events.push(Event::Cut(cut()));
    }

    fn phase_ended(&mut self, phase: Phase) {
        self.events.push(Event::PhaseEnded(phase));
    }
}
