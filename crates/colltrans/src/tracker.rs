//! Coherence: a query that starts from the last one's answer (the paper, section III-D).
//!
//! Notation. A *warm start* is what a cast leaves behind: the portal it ended with, or the separating
//! direction. There is one for casts along the direction and one for casts against it.
//!
//! Invariant. A warm start only proposes where to begin; every answer is proven by its own certificate,
//! from the poses and the direction of its own query.

use glam::DVec3;

use crate::answer::{Clearance, ContactRange, Outcome, StartedFrom, Steps};
use crate::body::ConvexPolyhedron;
use crate::body::Pose;
use crate::cast::{clearance_of, range_of};
use crate::error::QueryError;
use crate::number::range::in_exact_range;
use crate::setting::Setting;
use crate::solve::observe::Nobody;
use crate::solve::options::{Focus, Options, Region};
use crate::solve::{WarmStart, search};

/// Casts of one pair of bodies, each starting from the answer of the one before.
///
/// For motion planning, simulation and disassembly, which ask the same pair again after a small
/// change of pose or direction. Outcomes and certificates are those of the one-off functions
/// ([`cast`](crate::cast()), [`contact_range`](crate::contact_range),
/// [`clearance`](crate::clearance)); where corners or parallel edges meet, the normal and the
/// witness points may be another choice of several, and so may the contact of a grazing outcome,
/// which is that of bodies widened by rounding. Poses and direction may jump, and the bodies
/// may meet now and pass each other then: a poor beginning costs time, never the answer.
///
/// A tracker is small (less than 300 bytes), allocates nothing and may be
/// cloned, to follow several motions from one place. [`Focus`] says what it makes of its last
/// answer.
///
/// ```
/// # use colltrans::glam::{DQuat, DVec3};
/// # use colltrans::{ConvexPolyhedron, Options, Outcome, StartedFrom, Pose, Tracker};
/// # let corners: Vec<DVec3> = (0..8)
/// #     .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64))
/// #     .collect();
/// let cube = ConvexPolyhedron::from_points(&corners)?; // from (0, 0, 0) to (1, 1, 1)
/// let mut tracker = Tracker::new(&cube, &cube);
/// // A cube that turns while it is carried over another one: how far could it be lowered?
/// for step in 0..100 {
///     let turn = DQuat::from_axis_angle(DVec3::ONE.normalize(), 0.3 + 1e-3 * f64::from(step));
///     let pose = Pose::new(turn, DVec3::new(3e-3 * f64::from(step), 0.2, 4.0))?;
///     let Outcome::Contact(contact) = tracker.cast(&pose, &Pose::IDENTITY, DVec3::NEG_Z)? else {
///         unreachable!("it stays above")
///     };
///     let from = if step == 0 { StartedFrom::Scratch } else { StartedFrom::Features };
///     assert_eq!(contact.steps.started_from, from);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tracker<'a> {
    moving: &'a ConvexPolyhedron,
    fixed: &'a ConvexPolyhedron,
    focus: Focus,
    /// The direction of the last query.
    direction: DVec3,
    /// What the last casts along it and against it left.
    warm_starts: [WarmStart; 2],
    steps: Steps,
}

impl<'a> Tracker<'a> {
    /// For a moving and a fixed body; the first query starts from scratch.
    pub fn new(moving: &'a ConvexPolyhedron, fixed: &'a ConvexPolyhedron) -> Self {
        Self {
            moving,
            fixed,
            focus: Focus::default(),
            direction: DVec3::ZERO,
            warm_starts: [WarmStart::Nothing; 2],
            steps: Steps::default(),
        }
    }

    /// With another [`Focus`].
    ///
    /// # Errors
    /// A half-side of the region that is negative or not a number.
    pub fn with_focus(self, focus: Focus) -> Result<Self, QueryError> {
        match focus.region {
            Region::Fixed(half_side) if half_side.is_nan() || half_side < 0.0 => {
                Err(QueryError::RegionFocus { half_side })
            }
            _ => Ok(Self { focus, ..self }),
        }
    }

    /// Forgets the last answer: the next query starts from scratch.
    pub fn reset(&mut self) {
        self.warm_starts = [WarmStart::Nothing; 2];
    }

    /// The work of the last query: of all its casts together, and of their paths the longest.
    pub fn steps(&self) -> Steps {
        self.steps
    }

    /// [`cast`](crate::cast()) for the tracker's bodies.
    ///
    /// # Errors
    /// As [`cast`](crate::cast()).
    pub fn cast(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        direction: DVec3,
    ) -> Result<Outcome, QueryError> {
        self.cast_with(moving_pose, fixed_pose, direction, &Options::default())
    }

    /// [`cast_with`](crate::cast_with) for the tracker's bodies.
    ///
    /// # Errors
    /// As [`cast_with`](crate::cast_with).
    pub fn cast_with(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        direction: DVec3,
        options: &Options,
    ) -> Result<Outcome, QueryError> {
        self.begin(direction);
        self.run(moving_pose, fixed_pose, direction, options)
    }

    /// [`contact_range`](crate::contact_range) for the tracker's bodies.
    ///
    /// # Errors
    /// As [`contact_range`](crate::contact_range).
    pub fn contact_range(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        direction: DVec3,
        options: &Options,
    ) -> Result<ContactRange, QueryError> {
        self.begin(direction);
        range_of(direction, |d| self.run(moving_pose, fixed_pose, d, options))
    }

    /// [`clearance`](crate::clearance) for the tracker's bodies.
    ///
    /// # Errors
    /// As [`clearance`](crate::clearance).
    pub fn clearance(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        direction: DVec3,
        options: &Options,
    ) -> Result<Clearance, QueryError> {
        self.begin(direction);
        clearance_of(direction, |d| self.run(moving_pose, fixed_pose, d, options))
    }

    /// A query begins: the warm starts change places if it looks the other way.
    fn begin(&mut self, direction: DVec3) {
        self.steps = Steps { started_from: StartedFrom::Features, ..Steps::default() };
        if direction.dot(self.direction) < 0.0 {
            self.warm_starts.swap(0, 1);
        }
        // A direction that is about to be refused leaves nothing.
        if in_exact_range(direction) && direction != DVec3::ZERO {
            self.direction = direction;
        }
    }

    /// One cast of a query.
    fn run(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        direction: DVec3,
        options: &Options,
    ) -> Result<Outcome, QueryError> {
        let setting = Setting::new(self.moving, moving_pose, self.fixed, fixed_pose, direction)?;
        let backwards = direction.dot(self.direction) < 0.0;
        let warm_start = &mut self.warm_starts[usize::from(backwards)];
        // Matched in place: an outcome is large, and moving it costs a tenth of a coherent query.
        let outcome = search(&setting, moving_pose, options, &self.focus, warm_start, &mut Nobody);
        if let Ok(outcome) = &outcome {
            self.steps.add(&outcome.steps());
        }
        outcome
    }
}
