//! Trackers: sequences of similar queries about convex bodies.

use std::sync::Arc;

use colltrans::{ByKind, Cast, ConvexPolyhedron, Pair, QueryError};
use self_cell::self_cell;

use crate::answer::{CastAnswer, DistanceAnswer};
use crate::body::{Body, Pose, bodies, pose};
use crate::cast::CastOptions;
use crate::error::{Failure, Fallible, Output, Status, exclusive, found, free, guard, vector};

type Bodies = [Arc<ConvexPolyhedron>; 2];
type Borrowing<'a> = colltrans::Tracker<'a>;

self_cell!(
    struct Tracked {
        owner: Bodies,
        #[not_covariant]
        dependent: Borrowing,
    }
);

/// A sequence of similar queries about convex bodies, each of which starts from the last answer. Queries change it, so
/// each thread needs one of its own.
pub struct Tracker(Option<Tracked>);

impl Tracker {
    /// Runs a query with the library's tracker for these bodies. Other bodies get a new one.
    #[inline]
    fn run<T>(
        &mut self,
        bodies: [&Body; 2],
        query: impl for<'a> FnOnce(&mut Borrowing<'a>, [&'a ConvexPolyhedron; 2]) -> Fallible<T>,
    ) -> Fallible<T> {
        let [ByKind::Convex(moving), ByKind::Convex(fixed)] = bodies.map(|of| &of.body) else {
            let what = "trackers accept two convex bodies";
            return Err(Failure::invalid("moving, fixed", what));
        };
        let tracked = self.0.take_if(|tracked| {
            let [p, q] = tracked.borrow_owner();
            Arc::ptr_eq(p, moving) && Arc::ptr_eq(q, fixed)
        });
        let tracked = tracked
            .unwrap_or_else(|| Tracked::new([moving.clone(), fixed.clone()], |_| Borrowing::new()));
        let tracked = self.0.insert(tracked);
        tracked.with_dependent_mut(|[moving, fixed], tracker| query(tracker, [&**moving, &**fixed]))
    }
}

/// Runs a query of a cast.
#[inline]
unsafe fn track<T>(
    tracker: *mut Tracker,
    [moving, fixed]: [*const Body; 2],
    [moving_pose, fixed_pose]: [*const Pose; 2],
    direction: *const f64,
    options: *const CastOptions,
    answer: *mut CastAnswer,
    query: impl for<'a> FnOnce(&mut Borrowing<'a>, &Cast<'a>) -> Result<T, QueryError>,
    set: impl FnOnce(&mut CastAnswer, &T, &Cast<'_>, bool),
) -> Status {
    guard(move || unsafe {
        let answer = Output::new(answer, "answer")?;
        let tracker = exclusive(tracker, "tracker")?;
        let bodies = bodies(moving, fixed)?;
        let poses = [pose(moving_pose, "moving_pose")?, pose(fixed_pose, "fixed_pose")?];
        let direction = vector(direction, "direction")?;
        let options = CastOptions::read(options)?;
        tracker.run(bodies, |tracker, [moving, fixed]| {
            let placed = [moving.at(poses[0]), fixed.at(poses[1])];
            let cast = options.convex_cast(placed, direction)?;
            let result = query(tracker, &cast);
            let found = found(&result)?;
            set(answer.set(CastAnswer::NONE), found, &cast, options.features != 0);
            Ok(())
        })
    })
}

/// Builds a tracker.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_tracker_new(tracker: *mut *mut Tracker) -> Status {
    guard(|| unsafe {
        Output::new(tracker, "tracker")?.set_handle(Tracker(None));
        Ok(())
    })
}

/// Frees a tracker; null is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_tracker_free(tracker: *mut Tracker) {
    unsafe { free(tracker) }
}

/// Discards the last answer: the next query starts from scratch.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_tracker_reset(tracker: *mut Tracker) -> Status {
    guard(|| unsafe {
        exclusive(tracker, "tracker")?.0 = None;
        Ok(())
    })
}

/// Computes `colltrans_first_contact` from the last answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_tracker_first_contact(
    tracker: *mut Tracker,
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    direction: *const f64,
    options: *const CastOptions,
    answer: *mut CastAnswer,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe {
        track(
            tracker,
            bodies,
            poses,
            direction,
            options,
            answer,
            |tracker, cast| tracker.first_contact(cast),
            CastAnswer::set_outcome,
        )
    }
}

/// Computes `colltrans_contact_range` from the last answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_tracker_contact_range(
    tracker: *mut Tracker,
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    direction: *const f64,
    options: *const CastOptions,
    answer: *mut CastAnswer,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe {
        track(
            tracker,
            bodies,
            poses,
            direction,
            options,
            answer,
            |tracker, cast| tracker.contact_range(cast),
            CastAnswer::set_range,
        )
    }
}

/// Computes `colltrans_clearance` from the last answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_tracker_clearance(
    tracker: *mut Tracker,
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    direction: *const f64,
    options: *const CastOptions,
    answer: *mut CastAnswer,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe {
        track(
            tracker,
            bodies,
            poses,
            direction,
            options,
            answer,
            |tracker, cast| tracker.clearance(cast),
            CastAnswer::set_clearance,
        )
    }
}

/// Computes `colltrans_distance` from the last answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_tracker_distance(
    tracker: *mut Tracker,
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    answer: *mut DistanceAnswer,
) -> Status {
    guard(move || unsafe {
        let answer = Output::new(answer, "answer")?;
        let tracker = exclusive(tracker, "tracker")?;
        let bodies = bodies(moving, fixed)?;
        let poses = [pose(moving_pose, "moving_pose")?, pose(fixed_pose, "fixed_pose")?];
        answer.set(tracker.run(bodies, |tracker, [moving, fixed]| {
            let pair = Pair::new(moving.at(poses[0]), fixed.at(poses[1]))?;
            let distance = tracker.distance(&pair);
            Ok(DistanceAnswer::of_convex(found(&distance)?, [moving, fixed]))
        })?);
        Ok(())
    })
}
