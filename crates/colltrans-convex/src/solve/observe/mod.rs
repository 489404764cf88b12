//! What a search does, seen from outside: one seam for counting, timing and recording.
//!
//! Solvers report to a watch, which counts [`Steps`] and passes everything on to an [`Observer`]. Both are known at compile time: without an observer nothing is left of the reports,
//! and what they would say is never computed.

mod clock;
mod recording;

use glam::{DMat3, DVec2, DVec3};

use crate::answer::Steps;
use crate::setting::VertexPair;
use crate::setting::minkowski::Point;
pub use clock::{Clock, Profile};
pub use recording::{Event, Recording};

/// A part of a query's work, in the order of the data (the paper, table I).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Phase {
    /// Frames, section axes, and the first guess.
    Setup,
    /// Planar problems.
    Planar,
    /// Pieces, cells and the shift to a cell's best point.
    Cell,
    /// Cuts of the region and centroids.
    Region,
    /// What all pieces prove together.
    Bound,
    /// Portal refinement.
    Finish,
    /// Bounds and witness points of the answer.
    Answer,
}

/// The frame of a search: shadows, and heights along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowFrame {
    /// Columns: two lateral unit vectors and the unit direction, in the world.
    pub world_from_shadow: DMat3,
    /// The rounding error that coordinates may have.
    pub noise: f64,
}

/// A support point of the Minkowski difference `{q - p}`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// The normal along which it is lowest (shadow frame, any length).
    pub normal: DVec3,
    /// Where it is (shadow frame).
    pub at: DVec3,
    /// The vertices of the two bodies that it comes from.
    pub pair: VertexPair,
}

impl Support {
    #[inline]
    pub(crate) fn of(normal: DVec3, point: &Point) -> Self {
        Self { normal, at: point.at, pair: point.pair }
    }
}

/// The sections of a minimisation: planes across an axis of each body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sections {
    /// The section axes of P and of Q, in the world. A point `v` of a body, in its own frame, has the
    /// level `axis . (R v)`.
    pub axes: [DVec3; 2],
    /// Lowest and highest level of either body.
    pub ranges: [[f64; 2]; 2],
    /// The centre and the half-side of `N(p)`, the square of levels around the last solution `p`, if the search
    /// starts there.
    pub neighbourhood: Option<(DVec2, f64)>,
}

/// One planar problem: two sections at a pair of levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarProblem {
    /// The levels of P's and of Q's section, each in its own frame.
    pub levels: [f64; 2],
    /// The value there: `phi`, or how far the sections are apart if they never meet; not a number if
    /// rounding hides a section.
    pub value: f64,
    /// How the sections meet.
    pub touch: Touch,
    /// The change of the value with the two levels.
    pub gradient: DVec2,
    /// The levels in the cell where the same features stay in contact to which the cell shift goes; those
    /// of the problem if the sections miss each other.
    pub best: [f64; 2],
    /// The value there, the least of the cell.
    pub shifted: f64,
}

/// How two sections meet: what the same features decide in each cell of the mark (the paper, II-B).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Touch {
    /// An edge of one section touches an edge of the other: two faces.
    Edges,
    /// A corner of one section touches the inside of the other: an edge of a body against a section.
    Vertex,
    /// They never meet: a line along the direction's shadow lies between them.
    Separated,
    /// Rounding hides a section.
    Hidden,
}

impl Touch {
    /// Whether they meet at all.
    pub fn meets(self) -> bool {
        matches!(self, Self::Edges | Self::Vertex)
    }
}

impl PlanarProblem {
    /// Rounding errors of the mesh hide a section: nothing was learnt.
    pub(crate) fn hidden(levels: [f64; 2]) -> Self {
        Self {
            levels,
            value: f64::NAN,
            touch: Touch::Hidden,
            gradient: DVec2::ZERO,
            best: levels,
            shifted: f64::NAN,
        }
    }
}

/// What was cut from the levels: kept is `gradient . (levels - origin) <= limit`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// The middle of all levels.
    pub origin: DVec2,
    /// Across the cut line, towards what is lost.
    pub gradient: DVec2,
    /// The cut line.
    pub limit: f64,
    /// The lower bound that all pieces prove with this one, in units of length up to a constant of
    /// the query.
    pub lower: f64,
    /// The least value found, on the same scale.
    pub upper: f64,
}

/// Looks on while a query is answered. Every method does nothing unless it is overridden, and what
/// it would be told is then never computed.
///
/// [`Clock`] times the phases, [`Recording`] keeps the events, [`Steps`] counts; a pair of observers
/// is one.
pub trait Observer {
    /// A search begins, or begins again in a frame turned about the direction.
    fn begun(&mut self, frame: impl FnOnce() -> ShadowFrame) {
        let _ = frame;
    }

    /// A support point was computed.
    fn support(&mut self, support: impl FnOnce() -> Support) {
        let _ = support;
    }

    /// A portal was reached: three points of the Minkowski difference around the line (shadow
    /// frame).
    fn portal(&mut self, corners: impl FnOnce() -> [DVec3; 3]) {
        let _ = corners;
    }

    /// A minimisation over pairs of sections begins.
    fn sections(&mut self, sections: impl FnOnce() -> Sections) {
        let _ = sections;
    }

    /// A planar problem was solved.
    fn planar_problem(&mut self, problem: impl FnOnce() -> PlanarProblem) {
        let _ = problem;
    }

    /// The cell of the planar problem before, where the same features stay in contact: its corners, pairs
    /// of levels, counter-clockwise and within the levels of the bodies.
    fn cell(&mut self, corners: impl FnOnce() -> Vec<DVec2>) {
        let _ = corners;
    }

    /// The best point of a cell was the best so far: whether the features that touch there were
    /// seen to solve the problem.
    fn exit_test(&mut self, solved: impl FnOnce() -> bool) {
        let _ = solved;
    }

    /// The region of levels was cut.
    fn cut(&mut self, cut: impl FnOnce() -> Cut) {
        let _ = cut;
    }

    /// A part of the work ended: what was done since the last report belongs to it.
    fn ended(&mut self, phase: Phase) {
        let _ = phase;
    }
}

/// Hears everything and does nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoObserver;

impl Observer for NoObserver {}

impl Observer for Steps {
    #[inline]
    fn support(&mut self, _: impl FnOnce() -> Support) {
        self.supports += 1;
    }

    #[inline]
    fn portal(&mut self, _: impl FnOnce() -> [DVec3; 3]) {
        self.pivots += 1;
    }

    #[inline]
    fn planar_problem(&mut self, _: impl FnOnce() -> PlanarProblem) {
        self.planar_problems += 1;
    }
}

impl<A: Observer, B: Observer> Observer for (A, B) {
    fn begun(&mut self, frame: impl FnOnce() -> ShadowFrame) {
        let frame = frame();
        self.0.begun(|| frame);
        self.1.begun(|| frame);
    }

    fn support(&mut self, support: impl FnOnce() -> Support) {
        let support = support();
        self.0.support(|| support);
        self.1.support(|| support);
    }

    fn portal(&mut self, corners: impl FnOnce() -> [DVec3; 3]) {
        let corners = corners();
        self.0.portal(|| corners);
        self.1.portal(|| corners);
    }

    fn sections(&mut self, sections: impl FnOnce() -> Sections) {
        let sections = sections();
        self.0.sections(|| sections);
        self.1.sections(|| sections);
    }

    fn planar_problem(&mut self, problem: impl FnOnce() -> PlanarProblem) {
        let problem = problem();
        self.0.planar_problem(|| problem);
        self.1.planar_problem(|| problem);
    }

    fn cell(&mut self, corners: impl FnOnce() -> Vec<DVec2>) {
        let corners = corners();
        self.0.cell(|| corners.clone());
        self.1.cell(|| corners);
    }

    fn exit_test(&mut self, solved: impl FnOnce() -> bool) {
        let solved = solved();
        self.0.exit_test(|| solved);
        self.1.exit_test(|| solved);
    }

    fn cut(&mut self, cut: impl FnOnce() -> Cut) {
        let cut = cut();
        self.0.cut(|| cut);
        self.1.cut(|| cut);
    }

    fn ended(&mut self, phase: Phase) {
        self.0.ended(phase);
        self.1.ended(phase);
    }
}

/// Counts, and passes on.
pub(crate) struct Watch<'o, O> {
    /// What was counted.
    pub(crate) steps: Steps,
    /// Who looks on.
    pub(crate) observer: &'o mut O,
}

impl<'o, O: Observer> Watch<'o, O> {
    #[inline]
    pub(crate) fn new(observer: &'o mut O) -> Self {
        Self { steps: Steps::default(), observer }
    }
}

impl<O: Observer> Observer for Watch<'_, O> {
    #[inline]
    fn begun(&mut self, frame: impl FnOnce() -> ShadowFrame) {
        self.observer.begun(frame);
    }

    #[inline]
    fn support(&mut self, support: impl FnOnce() -> Support) {
        self.steps.supports += 1;
        self.observer.support(support);
    }

    #[inline]
    fn portal(&mut self, corners: impl FnOnce() -> [DVec3; 3]) {
        self.steps.pivots += 1;
        self.observer.portal(corners);
    }

    #[inline]
    fn sections(&mut self, sections: impl FnOnce() -> Sections) {
        self.observer.sections(sections);
    }

    #[inline]
    fn planar_problem(&mut self, problem: impl FnOnce() -> PlanarProblem) {
        self.steps.planar_problems += 1;
        self.observer.planar_problem(problem);
    }

    #[inline]
    fn cell(&mut self, corners: impl FnOnce() -> Vec<DVec2>) {
        self.observer.cell(corners);
    }

    #[inline]
    fn exit_test(&mut self, solved: impl FnOnce() -> bool) {
        self.observer.exit_test(solved);
    }

    #[inline]
    fn cut(&mut self, cut: impl FnOnce() -> Cut) {
        self.observer.cut(cut);
    }

    #[inline]
    fn ended(&mut self, phase: Phase) {
        self.observer.ended(phase);
    }
}
