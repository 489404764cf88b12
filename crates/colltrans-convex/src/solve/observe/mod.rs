//! Observation of a search: one interface for counting, timing and recording.
//!
//! Solvers report to a [`Watch`], which counts [`Steps`] and passes all reports on to an [`Observer`]. Both types are
//! static. Therefore reports to [`NoObserver`] cost nothing, and their arguments are never computed.

mod clock;
mod recording;

use glam::{DMat3, DVec2, DVec3};

use crate::answer::Steps;
use crate::setting::VertexPair;
use crate::setting::minkowski::ShadowPoint;
pub use clock::{Clock, Profile};
pub use recording::{Event, Recording};

/// Phase of a query (the paper, table I).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Phase {
    /// Computation of frames, section axes, and the first guess.
    Setup,
    /// Solution of planar problems.
    Planar,
    /// Computation of pieces and cells, and the shift to the best point of a cell.
    Cell,
    /// Cuts of the region, and its centroids.
    Region,
    /// Lower bound that all pieces prove together.
    Bound,
    /// Portal refinement.
    Finish,
    /// Computation of the answer's bounds and witness points.
    Answer,
}

/// Shadow frame of a search: two lateral axes and the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowFrame {
    /// Columns: two lateral unit vectors and the unit direction, in the world.
    pub world_from_shadow: DMat3,
    /// Bound on the rounding error of a coordinate (world units).
    pub noise: f64,
}

/// Support point of the Minkowski difference `{q - p}`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// Normal along which the point is lowest (shadow frame, any length).
    pub normal: DVec3,
    /// Position of the point (shadow frame).
    pub at: DVec3,
    /// Vertices of the two bodies whose difference is the point.
    pub pair: VertexPair,
}

impl Support {
    /// Builds the report of a point that was found along `normal` (shadow frame).
    #[inline]
    pub(crate) fn from_point(normal: DVec3, point: &ShadowPoint) -> Self {
        Self { normal, at: point.coordinates, pair: point.pair }
    }
}

/// Sections of a minimisation: the planes perpendicular to one axis of each body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sections {
    /// Section axes of `P` and of `Q`, in the world. A point `v` in the frame of a body with rotation `R` has the level
    /// `axis . (R v)`.
    pub axes: [DVec3; 2],
    /// Lowest and highest level of each body.
    pub ranges: [[f64; 2]; 2],
    /// Centre and half-side of `N(p)`, the square of levels around the last solution `p`. `None` if the search does not
    /// start there.
    pub neighbourhood: Option<(DVec2, f64)>,
}

/// Planar problem: two sections at a pair of levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarProblem {
    /// Levels of the sections of `P` and of `Q`, each relative to the origin of its body.
    pub levels: [f64; 2],
    /// Value at these levels: `phi`, or the distance of the sections if they never meet. Not a number if rounding
    /// hides a section.
    pub value: f64,
    /// Features at which the sections meet.
    pub touch: SectionContact,
    /// Gradient of the value with respect to the two levels.
    pub gradient: DVec2,
    /// Levels that the cell shift reaches, in the cell in which the same features stay in contact. Equal to `levels` if
    /// the sections miss each other.
    pub best: [f64; 2],
    /// Value at the levels `best`, the smallest of the cell.
    pub shifted: f64,
}

/// Features at which two sections meet. They are the same in a whole cell of the plane of levels (the paper, section
/// II-B, calls the set of these cells the mark).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SectionContact {
    /// An edge of one section touches an edge of the other. Each edge lies on a face of its body.
    Edges,
    /// A corner of one section, which lies on an edge of its body, touches the other section.
    Vertex,
    /// The sections never meet: a line separates their projections along the direction.
    Separated,
    /// Rounding hides a section.
    Hidden,
}

impl SectionContact {
    /// Checks whether the sections meet.
    pub fn intersects(self) -> bool {
        matches!(self, Self::Edges | Self::Vertex)
    }
}

impl PlanarProblem {
    /// Builds the result of a problem in which rounding errors of the mesh hide a section.
    pub(crate) fn hidden(levels: [f64; 2]) -> Self {
        Self {
            levels,
            value: f64::NAN,
            touch: SectionContact::Hidden,
            gradient: DVec2::ZERO,
            best: levels,
            shifted: f64::NAN,
        }
    }
}

/// Cut of the region of levels. The part with `gradient . (levels - origin) <= limit` remains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// Centre of the range of levels of both bodies.
    pub origin: DVec2,
    /// Vector perpendicular to the cut line, towards the part that is removed.
    pub gradient: DVec2,
    /// Position of the cut line along the gradient.
    pub limit: f64,
    /// Lower bound that all pieces prove together, this cut included (world units, up to a constant of the query).
    pub lower: f64,
    /// Smallest value found, in the same unit and up to the same constant as `lower`.
    pub upper: f64,
}

/// Receives reports while a query is answered.
///
/// By default each method does nothing, and its argument is never computed. [`Clock`] times the phases, [`Recording`]
/// records the events, and [`Steps`] counts. A pair of observers is an observer.
pub trait Observer {
    /// Reports that a search begins, or begins again from scratch, possibly in a frame rotated about the direction.
    fn search_started(&mut self, frame: impl FnOnce() -> ShadowFrame) {
        let _ = frame;
    }

    /// Reports a support point.
    fn support(&mut self, support: impl FnOnce() -> Support) {
        let _ = support;
    }

    /// Reports a portal: three points of the Minkowski difference around the line (shadow frame).
    fn portal(&mut self, corners: impl FnOnce() -> [DVec3; 3]) {
        let _ = corners;
    }

    /// Reports that a minimisation over pairs of sections begins.
    fn sections(&mut self, sections: impl FnOnce() -> Sections) {
        let _ = sections;
    }

    /// Reports a planar problem that was solved.
    fn planar_problem(&mut self, problem: impl FnOnce() -> PlanarProblem) {
        let _ = problem;
    }

    /// Reports the cell of the last planar problem, in which the same features stay in contact. Its corners are pairs
    /// of levels, counter-clockwise and within the levels of the bodies.
    fn cell(&mut self, corners: impl FnOnce() -> Vec<DVec2>) {
        let _ = corners;
    }

    /// Reports the exit test at the best point of a cell, if this is the best point of the search until then. `true` if
    /// the features that touch there are recognised as the solution.
    fn exit_test(&mut self, solved: impl FnOnce() -> bool) {
        let _ = solved;
    }

    /// Reports a cut of the region of levels.
    fn cut(&mut self, cut: impl FnOnce() -> Cut) {
        let _ = cut;
    }

    /// Reports that a phase ended. The work since the previous report of this kind belongs to the phase.
    fn phase_ended(&mut self, phase: Phase) {
        let _ = phase;
    }
}

/// An [`Observer`] that ignores all reports.
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
    fn search_started(&mut self, frame: impl FnOnce() -> ShadowFrame) {
        let frame = frame();
        self.0.search_started(|| frame);
        self.1.search_started(|| frame);
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

    fn phase_ended(&mut self, phase: Phase) {
        self.0.phase_ended(phase);
        self.1.phase_ended(phase);
    }
}

/// Counter of steps that passes all reports on to an observer.
pub(crate) struct Watch<'o, O> {
    /// Counts until now.
    pub(crate) steps: Steps,
    /// Receiver of the reports.
    pub(crate) observer: &'o mut O,
}

impl<'o, O: Observer> Watch<'o, O> {
    /// Builds a watch with counts of 0.
    #[inline]
    pub(crate) fn new(observer: &'o mut O) -> Self {
        Self { steps: Steps::default(), observer }
    }
}

impl<O: Observer> Observer for Watch<'_, O> {
    #[inline]
    fn search_started(&mut self, frame: impl FnOnce() -> ShadowFrame) {
        self.observer.search_started(frame);
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
    fn phase_ended(&mut self, phase: Phase) {
        self.observer.phase_ended(phase);
    }
}
