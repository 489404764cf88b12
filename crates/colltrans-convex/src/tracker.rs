//! Coherence: a query that starts from the last one's answer (the paper, section III-D).
//!
//! Notation. A *warm start* is what a cast leaves behind: the portal it ended with, or the separating
//! direction. The casts of a tracker have three *sides*, each with a warm start of its own: along the direction,
//! against it, and between the centres.
//!
//! Invariant. A warm start only proposes where to begin; every answer is proven by its own certificate,
//! from the poses and the direction of its own query.

use glam::DVec3;

use crate::answer::{
    Clearance, ContactRange, DirectionalDepth, Distance, Intersection, Outcome, StartedFrom, Steps,
};
use crate::body::ConvexPolyhedron;
use crate::cast::{Cast, clearance_of, depth_of, intersection_by_casts, range_of};
use crate::pair::{Pair, distance_from};
use crate::setting::error::QueryError;
use crate::solve::cta::options::Region;
use crate::solve::nearest::NearestPairs;
use crate::solve::observe::{NoObserver, Observer};
use crate::solve::options::Focus;
use crate::solve::{Left, Pace, WarmStart};

/// Queries that follow each other closely, each starting from the answer of the one before.
///
/// For motion planning, simulation and disassembly, which ask about the same pair of bodies again
/// after a small change of pose or direction. Outcomes and certificates are those of the [`Cast`]'s
/// own methods; where corners or parallel edges meet, the normal and the witness points may be
/// another choice of several, and so may the contact of a grazing outcome, which is that of bodies
/// widened by rounding. Poses and direction may jump, the bodies may meet now and pass each other
/// then, or be other bodies: a poor beginning costs time, never the answer.
///
/// A tracker is small (less than 600 bytes), allocates nothing and may be
/// cloned, to follow several motions from one place. [`Focus`] says what it makes of its last
/// answer: with [`Solver::Cta`](crate::Solver::Cta) its region, as the paper, else its features. Where these take
/// more work than casts from scratch (as steps count it), a tracker without a focus of its own casts from scratch
/// and tries again now and then; with [`with_focus`](Self::with_focus) it always starts as it is told. A body's first query that solves a planar problem makes
/// its sections, tracked or not: see [`ConvexPolyhedron::prepare_sections`](crate::ConvexPolyhedron::prepare_sections).
///
/// ```
/// use colltrans::glam::{DQuat, DVec3};
/// use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose, StartedFrom, Tracker};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let mut tracker = Tracker::new();
/// // A cube that turns while it is carried over another one: how far could it be lowered?
/// for step in 0..100 {
///     let turn = DQuat::from_axis_angle(DVec3::ONE.normalize(), 0.3 + 1e-3 * f64::from(step));
///     let pose = Pose::new(turn, DVec3::new(3e-3 * f64::from(step), 0.2, 4.0))?;
///     let cast = Cast::new(cube.at(pose), cube.at(Pose::IDENTITY), DVec3::NEG_Z)?;
///     let Outcome::Contact(contact) = tracker.first_contact(&cast)? else {
///         unreachable!("it stays above")
///     };
///     let from = if step == 0 { StartedFrom::Scratch } else { StartedFrom::Features };
///     assert_eq!(contact.steps.started_from, from);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Tracker<'a> {
    /// The bodies of the last query.
    bodies: Option<[&'a ConvexPolyhedron; 2]>,
    /// What was chosen; if nothing, the solver decides.
    focus: Option<Focus>,
    /// The direction of the last query.
    direction: DVec3,
    /// Of casts along the direction and against it, or the other way round where it is `turned`, and between the
    /// centres.
    slots: [CastSlot; 3],
    swapped: bool,
    /// The pairs of vertices that the last distance ended with.
    nearest: NearestPairs,
    /// The work of the last query but for the last cast of each side.
    steps: Steps,
}

/// The casts of one side. The last one is taken into account when the next begins, from what it has left.
#[derive(Debug, Clone, Copy, Default)]
struct CastSlot {
    carry: Left,
    /// Whether it pays to start from there.
    policy: Pace,
    /// Whether the last cast did.
    warm_started: bool,
    /// Whether it is of the last query.
    in_last_query: bool,
}

/// The side of casts between the centres.
const BETWEEN_CENTERS: usize = 2;

impl<'a> Tracker<'a> {
    /// The first query starts from scratch.
    pub fn new() -> Self {
        Self::default()
    }

    /// With another [`Focus`] than the solver's own: [`Focus::of`].
    ///
    /// # Errors
    /// A half-side of the region that is negative or not a number.
    pub fn with_focus(self, focus: Focus) -> Result<Self, QueryError> {
        match focus.region {
            Region::Fixed(half_side) if half_side.is_nan() || half_side < 0.0 => {
                Err(QueryError::RegionFocus { half_side })
            }
            _ => Ok(Self { focus: Some(focus), ..self }),
        }
    }

    /// Forgets the last answer: the next query starts from scratch.
    pub fn reset(&mut self) {
        self.steps = self.steps();
        self.slots = [CastSlot::default(); 3];
        self.nearest = NearestPairs::default();
    }

    /// The work of the last query: of all its casts together, and of their starts the one with most
    /// work.
    pub fn steps(&self) -> Steps {
        let mut steps = self.steps;
        let of_last_query = self.slots.iter().filter(|slot| slot.in_last_query);
        for cast_steps in of_last_query.filter_map(|slot| slot.carry.steps) {
            steps += cast_steps;
        }
        steps
    }

    /// [`Cast::first_contact`], starting from the last answer.
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn first_contact(&mut self, cast: &Cast<'a>) -> Result<Outcome, QueryError> {
        self.first_contact_observed(cast, &mut NoObserver)
    }

    /// The same, with an observer, as for [`Cast::first_contact_observed`].
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn first_contact_observed<O: Observer>(
        &mut self,
        cast: &Cast<'a>,
        observer: &mut O,
    ) -> Result<Outcome, QueryError> {
        self.begin_cast_query(cast);
        self.cast_in_slot(cast, usize::from(self.swapped), observer)
    }

    /// [`Cast::contact_range`], starting from the last answer.
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn contact_range(&mut self, cast: &Cast<'a>) -> Result<ContactRange, QueryError> {
        self.begin_cast_query(cast);
        range_of(cast, |cast| self.cast_either_way(cast))
    }

    /// [`Cast::clearance`], starting from the last answer.
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn clearance(&mut self, cast: &Cast<'a>) -> Result<Clearance, QueryError> {
        self.begin_cast_query(cast);
        clearance_of(cast, |cast| self.cast_either_way(cast))
    }

    /// [`Cast::directional_depth`], starting from the last answer.
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn directional_depth(&mut self, cast: &Cast<'a>) -> Result<DirectionalDepth, QueryError> {
        self.begin_cast_query(cast);
        depth_of(cast, |cast| self.cast_either_way(cast))
    }

    /// [`Cast::intersects`], starting from the last answer to the same question.
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn intersects(&mut self, cast: &Cast<'a>) -> Result<Intersection, QueryError> {
        self.begin_cast_query(cast);
        intersection_by_casts(cast, |cast| {
            self.cast_in_slot(cast, BETWEEN_CENTERS, &mut NoObserver)
        })
    }

    /// [`Pair::distance`], starting from the last answer to the same question: the pairs of vertices that
    /// the nearest points were made of.
    ///
    /// # Errors
    /// As [`Pair::distance`].
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{ConvexPolyhedron, Pair, Pose, Tracker};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let mut tracker = Tracker::new();
    /// for step in 0..100 {
    ///     let pose = Pose::from_translation(DVec3::new(2.0, 1e-2 * f64::from(step), 0.5))?;
    ///     let pair = Pair::new(cube.at(Pose::IDENTITY), cube.at(pose))?;
    ///     let [lower, upper] = tracker.distance(&pair)?.bounds();
    ///     assert!(lower <= 1.0 && 1.0 <= upper && upper - lower < 1e-13);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn distance(&mut self, pair: &Pair<'a>) -> Result<Distance, QueryError> {
        self.begin_query([pair.moving(), pair.fixed()]);
        self.steps = Steps::default();
        let distance = distance_from(pair, &mut self.nearest)?;
        self.steps = distance.steps;
        Ok(distance)
    }

    /// A query begins: what was found of other bodies is of no use.
    #[inline]
    fn begin_query(&mut self, bodies: [&'a ConvexPolyhedron; 2]) {
        self.steps = Steps { started_from: StartedFrom::Features, ..Steps::default() };
        for slot in &mut self.slots {
            slot.in_last_query = false;
        }
        let are_same = |last: [&ConvexPolyhedron; 2]| {
            std::ptr::eq(last[0], bodies[0]) && std::ptr::eq(last[1], bodies[1])
        };
        if !self.bodies.is_some_and(are_same) {
            self.reset();
            self.bodies = Some(bodies);
        }
    }

    /// A query of casts begins: sides are exchanged if it looks the other way.
    #[inline]
    fn begin_cast_query(&mut self, cast: &Cast<'a>) {
        self.begin_query([cast.moving(), cast.fixed()]);
        if cast.direction().dot(self.direction) < 0.0 {
            self.swapped = !self.swapped;
        }
        self.direction = cast.direction();
    }

    /// A cast along the direction of the query, or against it.
    fn cast_either_way(&mut self, cast: &Cast<'a>) -> Result<Outcome, QueryError> {
        let against = cast.direction().dot(self.direction) < 0.0;
        self.cast_in_slot(cast, usize::from(against != self.swapped), &mut NoObserver)
    }

    /// One cast of a query.
    #[inline]
    fn cast_in_slot<O: Observer>(
        &mut self,
        cast: &Cast<'a>,
        index: usize,
        observer: &mut O,
    ) -> Result<Outcome, QueryError> {
        let solver_focus = Focus::of(cast.options.solver);
        let adaptive = self.focus.is_none() && solver_focus.features;
        let CastSlot { carry, policy, warm_started, in_last_query } = &mut self.slots[index];
        if let Some(steps) = carry.steps {
            policy.note(*warm_started, &steps);
            if *in_last_query {
                self.steps += steps;
            }
        }
        let paused = adaptive && !policy.follows();
        let focus =
            self.focus.unwrap_or(solver_focus.with_features(solver_focus.features && !paused));
        let last = if paused { WarmStart::Nothing } else { carry.start };
        *warm_started = focus.features && !matches!(last, WarmStart::Nothing);
        *in_last_query = true;
        cast.search(&focus, &last, carry, observer)
    }
}
