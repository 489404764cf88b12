//! Temporal coherence: each query starts from the answer of the previous one (the paper, section III-D).
//!
//! A *warm start* is the data that a cast leaves for the next one. Each of three *slots* has its own: casts
//! along the direction, against it, and between the centres. A cast tries in this order:
//! 1. *Features*: the last separating direction or portal. If the line has left the portal, gift wrapping
//!    finds the next face, or slopes and curvatures predict a face farther away.
//! 2. *Region* (only with [`Solver::Cta`](crate::Solver::Cta)): section levels around the last contact.
//! 3. *Scratch*: a cast without a warm start, also if either body is another object than in the last query.
//!
//! Invariant: every answer is proven by its own certificate, from the poses and the direction of its query.

use glam::DVec3;

use crate::answer::{
    Clearance, ContactRange, DirectionalDepth, Distance, Intersection, Outcome, StartedFrom, Steps,
};
use crate::body::ConvexPolyhedron;
use crate::cast::{
    Cast, clearance_by_casts, contact_range_by_casts, directional_depth_by_casts,
    intersection_by_casts,
};
use crate::pair::{Pair, distance_from};
use crate::setting::error::QueryError;
use crate::solve::cta::options::Region;
use crate::solve::nearest::NearestPairs;
use crate::solve::observe::{NoObserver, Observer};
use crate::solve::options::Focus;
use crate::solve::{TrackerUpdate, WarmStart, WarmStartPolicy};

/// A sequence of similar queries, each of which starts from the answer of the previous one.
///
/// Use it in motion planning, simulation and disassembly, where the same pair of bodies is queried again
/// after a small change of pose or direction. Outcomes and certificates are those of the [`Cast`] methods.
/// The normal and the witness points may differ if vertices or parallel edges meet, because they are not
/// unique then. So may the contact of a grazing outcome, which is that of bodies widened by rounding. Poses
/// and direction may jump, and bodies may change: a poor start costs time, but never correctness.
///
/// A tracker has less than 600 bytes, allocates nothing, and may be cloned to follow several motions from one
/// state. By default it uses features. With [`Solver::Cta`](crate::Solver::Cta) it uses the region instead, as the
/// paper does. If starts from features take more work than casts from scratch (as [`Steps`] counts it), it casts
/// from scratch and tries features again at intervals. With [`with_focus`](Self::with_focus) it always uses
/// the given [`Focus`]. A body's first query that solves a planar problem builds its sections, tracked or
/// not: see [`ConvexPolyhedron::prepare_sections`](crate::ConvexPolyhedron::prepare_sections).
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
    /// The focus given by the user; if `None`, that of the solver.
    focus: Option<Focus>,
    /// The direction of the last query.
    direction: DVec3,
    /// The slots of casts along the direction and against it (in the opposite order if `swapped`), and
    /// between the centres.
    slots: [CastSlot; 3],
    /// Whether the slots of the two directions are exchanged. The value changes whenever the direction turns
    /// by more than 90 degrees.
    swapped: bool,
    /// The pairs of vertices with which the last distance ended.
    nearest: NearestPairs,
    /// The work of the last query, without the last cast of each slot.
    steps: Steps,
}

/// State of the casts of one kind.
///
/// The work of the last cast is read from `carry` when the next cast begins.
#[derive(Debug, Clone, Copy, Default)]
struct CastSlot {
    /// Warm start and work of the last cast.
    carry: TrackerUpdate,
    /// Decides whether a warm start pays off.
    policy: WarmStartPolicy,
    /// Whether the last cast tried to start from features.
    warm_started: bool,
    /// Whether the last cast belongs to the last query.
    in_last_query: bool,
}

/// Index of the slot of casts between the centres.
const BETWEEN_CENTERS: usize = 2;

impl<'a> Tracker<'a> {
    /// Builds a tracker whose first query starts from scratch.
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the tracker with a given focus instead of the solver's ([`Focus::for_solver`]).
    ///
    /// # Errors
    /// Returns [`QueryError::RegionFocus`] if the half-side of a fixed region is negative or not a number.
    pub fn with_focus(self, focus: Focus) -> Result<Self, QueryError> {
        match focus.region {
            Region::Fixed(half_side) if half_side.is_nan() || half_side < 0.0 => {
                Err(QueryError::RegionFocus { half_side })
            }
            _ => Ok(Self { focus: Some(focus), ..self }),
        }
    }

    /// Discards the warm starts: the next query starts from scratch.
    pub fn reset(&mut self) {
        self.steps = self.steps();
        self.slots = [CastSlot::default(); 3];
        self.nearest = NearestPairs::default();
    }

    /// Returns the work of the last query, summed over its casts. `started_from` is the start with the most
    /// work.
    pub fn steps(&self) -> Steps {
        let mut steps = self.steps;
        let of_last_query = self.slots.iter().filter(|slot| slot.in_last_query);
        for cast_steps in of_last_query.filter_map(|slot| slot.carry.steps) {
            steps += cast_steps;
        }
        steps
    }

    /// Computes [`Cast::first_contact`], starting from the last answer.
    ///
    /// # Errors
    /// Returns the errors of [`Cast::first_contact`].
    pub fn first_contact(&mut self, cast: &Cast<'a>) -> Result<Outcome, QueryError> {
        self.first_contact_observed(cast, &mut NoObserver)
    }

    /// Computes [`Cast::first_contact`], starting from the last answer, and reports each step to an observer.
    ///
    /// # Errors
    /// Returns the errors of [`Cast::first_contact`].
    pub fn first_contact_observed<O: Observer>(
        &mut self,
        cast: &Cast<'a>,
        observer: &mut O,
    ) -> Result<Outcome, QueryError> {
        self.begin_cast_query(cast);
        self.cast_in_slot(cast, usize::from(self.swapped), observer)
    }

    /// Computes [`Cast::contact_range`], starting from the last answer.
    ///
    /// # Errors
    /// Returns the errors of [`Cast::contact_range`].
    pub fn contact_range(&mut self, cast: &Cast<'a>) -> Result<ContactRange, QueryError> {
        self.begin_cast_query(cast);
        contact_range_by_casts(cast, |cast| self.cast_either_way(cast))
    }

    /// Computes [`Cast::clearance`], starting from the last answer.
    ///
    /// # Errors
    /// Returns the errors of [`Cast::clearance`].
    pub fn clearance(&mut self, cast: &Cast<'a>) -> Result<Clearance, QueryError> {
        self.begin_cast_query(cast);
        clearance_by_casts(cast, |cast| self.cast_either_way(cast))
    }

    /// Computes [`Cast::directional_depth`], starting from the last answer.
    ///
    /// # Errors
    /// Returns the errors of [`Cast::directional_depth`].
    pub fn directional_depth(&mut self, cast: &Cast<'a>) -> Result<DirectionalDepth, QueryError> {
        self.begin_cast_query(cast);
        directional_depth_by_casts(cast, |cast| self.cast_either_way(cast))
    }

    /// Computes [`Cast::intersects`], starting from the last answer of this method.
    ///
    /// # Errors
    /// Returns the errors of [`Cast::intersects`].
    pub fn intersects(&mut self, cast: &Cast<'a>) -> Result<Intersection, QueryError> {
        self.begin_cast_query(cast);
        intersection_by_casts(cast, |cast| {
            self.cast_in_slot(cast, BETWEEN_CENTERS, &mut NoObserver)
        })
    }

    /// Computes [`Pair::distance`], starting from the vertex pairs of the last nearest points.
    ///
    /// # Errors
    /// Returns the errors of [`Pair::distance`].
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

    /// Begins a query about `bodies`. Resets the tracker if the bodies have changed.
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

    /// Begins a query of casts. Exchanges the slots of the two directions if the direction has turned by more
    /// than 90 degrees.
    #[inline]
    fn begin_cast_query(&mut self, cast: &Cast<'a>) {
        self.begin_query([cast.moving(), cast.fixed()]);
        if cast.direction().dot(self.direction) < 0.0 {
            self.swapped = !self.swapped;
        }
        self.direction = cast.direction();
    }

    /// Runs a cast along the direction of the query or against it, in the matching slot.
    fn cast_either_way(&mut self, cast: &Cast<'a>) -> Result<Outcome, QueryError> {
        let against = cast.direction().dot(self.direction) < 0.0;
        self.cast_in_slot(cast, usize::from(against != self.swapped), &mut NoObserver)
    }

    /// Runs one cast of a query in a slot, with a warm start if the focus and the slot's policy allow it.
    #[inline]
    fn cast_in_slot<O: Observer>(
        &mut self,
        cast: &Cast<'a>,
        index: usize,
        observer: &mut O,
    ) -> Result<Outcome, QueryError> {
        let solver_focus = Focus::for_solver(cast.options.solver);
        let adaptive = self.focus.is_none() && solver_focus.features;
        let CastSlot { carry, policy, warm_started, in_last_query } = &mut self.slots[index];
        if let Some(steps) = carry.steps {
            policy.record_cast(*warm_started, &steps);
            if *in_last_query {
                self.steps += steps;
            }
        }
        let paused = adaptive && !policy.should_warm_start();
        let focus =
            self.focus.unwrap_or(solver_focus.with_features(solver_focus.features && !paused));
        let last = if paused { WarmStart::Nothing } else { carry.start };
        *warm_started = focus.features && !matches!(last, WarmStart::Nothing);
        *in_last_query = true;
        cast.search_first_contact(&focus, &last, carry, observer)
    }
}
