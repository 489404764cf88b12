//! The two cubes of the pictures, and the steps of the algorithm as reported to an observer.

use colltrans::observe::{Cut, Event, PlanarProblem, Recording, Sections};
use colltrans::{Cast, ConvexPolyhedron, Focus, Outcome, Pose, QueryError, Solver, Tracker, cta};
use glam::{DQuat, DVec2, DVec3};

/// Returns a cube of side 2 about its origin.
fn cube_of_side_2() -> Result<ConvexPolyhedron, colltrans::BuildError> {
    let corner =
        |k: u32| DVec3::from_array([0, 1, 2].map(|axis| f64::from(k >> axis & 1) * 2.0 - 1.0));
    ConvexPolyhedron::from_points(&(0..8).map(corner).collect::<Vec<_>>())
}

/// Two placed cubes and a direction.
#[derive(Debug)]
pub(super) struct Setting {
    pub(super) bodies: [ConvexPolyhedron; 2],
    pub(super) poses: [Pose; 2],
    /// Direction of length 1.
    pub(super) direction: DVec3,
}

/// A planar problem and its use by the algorithm.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) problem: PlanarProblem,
    /// The cell with the same features in contact; empty if the sections do not meet.
    pub(super) cell: Vec<DVec2>,
    /// The remaining region of levels before this step.
    pub(super) region: Vec<DVec2>,
    /// The cut; `None` after the exit test.
    pub(super) cut: Option<Cut>,
}

/// A minimisation.
#[derive(Debug, Clone)]
pub(super) struct Run {
    pub(super) sections: Sections,
    pub(super) steps: Vec<Step>,
    /// The proven translation of the answer.
    pub(super) translation: Option<f64>,
}

impl Setting {
    /// Places the moving cube by its position and a quaternion of any length.
    ///
    /// # Errors
    /// [`Error`] if the pose is invalid.
    pub(super) fn new(at: [f64; 3], turn: [f64; 4], towards: [f64; 3]) -> Result<Self, Error> {
        let direction = DVec3::from_array(towards).normalize();
        let moving = Pose::new(DQuat::from_array(turn).normalize(), DVec3::from_array(at))?;
        Ok(Self {
            bodies: [cube_of_side_2()?, cube_of_side_2()?],
            poses: [moving, Pose::IDENTITY],
            direction,
        })
    }

    /// Returns the cast of the cubes.
    fn cast(&self) -> Result<Cast<'_>, QueryError> {
        let [moving, fixed] = [0, 1].map(|body| self.bodies[body].at(self.poses[body]));
        Ok(Cast::new(moving, fixed, self.direction)?.with_solver(Solver::Cta))
    }

    /// Runs the complete minimisation from the centre.
    ///
    /// # Errors
    /// [`Error`] if the query fails or solves no planar problem.
    pub(super) fn run(&self) -> Result<Run, Error> {
        let mut seen = Recording::default();
        let outcome = self.cast()?.first_contact_observed(&mut seen)?;
        Run::from_recording(&seen, &outcome)
    }

    /// Runs the minimisation after another setting, in the neighbourhood of its solution with this half side.
    ///
    /// # Errors
    /// [`Error`] if a query fails or solves no planar problem.
    pub(super) fn run_after(&self, before: &Self, half: f64) -> Result<Run, Error> {
        let focus = Focus::NONE.with_region(cta::Region::Fixed(half));
        let (mut tracker, mut seen) = (Tracker::new().with_focus(focus)?, Recording::default());
        tracker.first_contact(&before.cast()?)?;
        let outcome = tracker.first_contact_observed(&self.cast()?, &mut seen)?;
        Run::from_recording(&seen, &outcome)
    }
}

impl Run {
    /// Extracts the steps from a recording.
    fn from_recording(seen: &Recording, outcome: &Outcome) -> Result<Self, Error> {
        let mut sections = None;
        let (mut region, mut steps) = (Vec::new(), Vec::<Step>::new());
        for event in seen.events() {
            match event {
                Event::Sections(told) => {
                    let [[a, b], [c, d]] = told.ranges;
                    region = [[a, c], [b, c], [b, d], [a, d]].map(DVec2::from_array).to_vec();
                    sections = Some(*told);
                }
                Event::PlanarProblem(problem) => {
                    let (cell, region) = (Vec::new(), region.clone());
                    steps.push(Step { problem: *problem, cell, region, cut: None });
                }
                Event::Cell(corners) => {
                    if let Some(step) = steps.last_mut() {
                        step.cell.clone_from(corners);
                    }
                }
                Event::Cut(cut) => {
                    if let Some(step) = steps.last_mut() {
                        step.cut = Some(*cut);
                    }
                    region = below(&region, cut.gradient, cut.gradient.dot(cut.origin) + cut.limit);
                }
                _ => {}
            }
        }
        let translation = match outcome {
            Outcome::Contact(contact) => Some(contact.translation),
            _ => None,
        };
        Ok(Self { sections: sections.ok_or(Error::NoMinimisation)?, steps, translation })
    }

    /// Returns the corners of the rectangle of all levels.
    pub(super) fn rectangle(&self) -> [DVec2; 2] {
        let [[a, b], [c, d]] = self.sections.ranges;
        [DVec2::new(a, c), DVec2::new(b, d)]
    }

    /// Returns the levels of the smallest value; `None` without contact.
    pub(super) fn best(&self) -> Option<DVec2> {
        let met = self.steps.iter().filter(|step| step.problem.touch.intersects());
        let least = met.min_by(|a, b| a.problem.shifted.total_cmp(&b.problem.shifted));
        least.map(|step| DVec2::from_array(step.problem.best))
    }
}

/// Returns the part of a convex polygon in which `gradient . p <= limit`.
pub(crate) fn below(polygon: &[DVec2], gradient: DVec2, limit: f64) -> Vec<DVec2> {
    let mut kept = Vec::new();
    for (k, &from) in polygon.iter().enumerate() {
        let to = polygon[(k + 1) % polygon.len()];
        let [u, v] = [from, to].map(|p| gradient.dot(p) - limit);
        if u <= 0.0 {
            kept.push(from);
        }
        if (u < 0.0 && v > 0.0) || (u > 0.0 && v < 0.0) {
            kept.push(from.lerp(to, u / (u - v)));
        }
    }
    kept
}

/// Returns the mean of a polygon's corners.
pub(super) fn middle(polygon: &[DVec2]) -> DVec2 {
    polygon.iter().sum::<DVec2>() / polygon.len().max(1) as f64
}

/// Reason why a picture cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A cube cannot be built.
    #[error(transparent)]
    Build(#[from] colltrans::BuildError),
    /// A pose is invalid.
    #[error(transparent)]
    Pose(#[from] colltrans::PoseError),
    /// A query failed.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// The algorithm answered without a planar problem.
    #[error("the algorithm solved no planar problem")]
    NoMinimisation,
    /// The setting does not show the subject of the picture.
    #[error("the cubes show no {0}")]
    Missing(&'static str),
}
