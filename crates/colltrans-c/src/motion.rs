//! Motions: poses at all times from 0 to 1, and the first contact of bodies that rotate.

use colltrans::ByKind;
use colltrans::motion::{Motion as LibraryMotion, MotionCast};
use colltrans::record::MotionRecord;
use colltrans::{ConvexPolyhedron, Solid};

use crate::answer::MotionAnswer;
use crate::body::{Body, Pose, bodies, pose, surface};
use crate::cast::{CastOptions, reject};
use crate::error::{
    Failure, Fallible, OfArgument, Output, Status, array, free, guard, reference, vector,
};

/// The pose of a body at all times from 0 to 1. It never changes, and any number of threads may use it.
pub struct Motion(LibraryMotion);

/// A motion cast of two convex bodies or of two solids.
pub(crate) type AnyMotionCast<'a> = ByKind<MotionCast<'a, ConvexPolyhedron>, MotionCast<'a, Solid>>;

/// Reads the bodies, motions and options of a query.
pub(crate) unsafe fn motion_cast<'a>(
    [moving, fixed]: [*const Body; 2],
    [moving_motion, fixed_motion]: [*const Motion; 2],
    options: *const CastOptions,
) -> Fallible<AnyMotionCast<'a>> {
    // SAFETY: the caller keeps the invariants of the crate.
    unsafe {
        let bodies = bodies(moving, fixed)?;
        let motions: [&'a Motion; 2] =
            [reference(moving_motion, "moving_motion")?, reference(fixed_motion, "fixed_motion")?];
        let options = CastOptions::read(options)?;
        reject(options.graze_tolerance != 0.0, "graze_tolerance", "a motion")?;
        reject(options.has_before != 0, "before", "a motion")?;
        reject(options.solver != 0, "solver", "a motion")?;
        let [a, b] = motions.map(|motion| &motion.0);
        let [ByKind::Convex(p), ByKind::Convex(q)] = bodies.map(|of| &of.body) else {
            let p = surface(&bodies[0].body).of("moving")?.with_motion(a);
            let q = surface(&bodies[1].body).of("fixed")?.with_motion(b);
            let cast = MotionCast::new(p, q)?.with_min_gap(options.min_gap)?;
            let cast = cast.with_start_overlap(options.start_overlap());
            return Ok(ByKind::Solid(match options.tolerance()? {
                Some(tolerance) => cast.with_tolerance(tolerance)?,
                None => cast,
            }));
        };
        let ignores = options.ignore_start_overlap != 0;
        reject(ignores, "ignore_start_overlap", "a motion of convex bodies")?;
        let cast = MotionCast::new(p.with_motion(a), q.with_motion(b))?;
        Ok(ByKind::Convex(match options.tolerance()? {
            Some(_) if options.min_gap != 0.0 => {
                let what = "a motion of convex bodies has a minimum gap or a tolerance, not both";
                return Err(Failure::invalid("options.tolerance", what));
            }
            Some(depth) => cast.with_tolerance(depth)?,
            None => cast.with_min_gap(options.min_gap)?,
        }))
    }
}

/// Writes the handle of a motion.
unsafe fn set(motion: *mut *mut Motion, build: impl FnOnce() -> Fallible<LibraryMotion>) -> Status {
    guard(|| unsafe {
        let motion = Output::new(motion, "motion")?;
        motion.set_handle(Motion(build()?));
        Ok(())
    })
}

/// Builds the motion of a body at rest. A null pose is the identity.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_motion_rest(
    pose: *const Pose,
    motion: *mut *mut Motion,
) -> Status {
    unsafe { set(motion, || Ok(LibraryMotion::at_rest(self::pose(pose, "pose")?))) }
}

/// Builds a translation by a vector.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_motion_translation(
    pose: *const Pose,
    displacement: *const f64,
    motion: *mut *mut Motion,
) -> Status {
    unsafe {
        set(motion, || {
            let displacement = vector(displacement, "displacement")?;
            LibraryMotion::translation(self::pose(pose, "pose")?, displacement).of("displacement")
        })
    }
}

/// Builds a rotation by `angle` radians about an axis through a point of the world, with a translation by `rise` along
/// the axis.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_motion_screw(
    pose: *const Pose,
    point: *const f64,
    axis: *const f64,
    angle: f64,
    rise: f64,
    motion: *mut *mut Motion,
) -> Status {
    unsafe {
        set(motion, || {
            let (point, axis) = (vector(point, "point")?, vector(axis, "axis")?);
            let pose = self::pose(pose, "pose")?;
            LibraryMotion::screw(pose, point, axis, angle, rise).of("point, axis, angle, rise")
        })
    }
}

/// Builds a free flight: a point of the world that moves with the body has a constant velocity, and the body rotates
/// about it at a constant angular velocity, in radians for the unit of time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_motion_free_flight(
    pose: *const Pose,
    center: *const f64,
    velocity: *const f64,
    angular_velocity: *const f64,
    motion: *mut *mut Motion,
) -> Status {
    unsafe {
        set(motion, || {
            let (center, velocity) = (vector(center, "center")?, vector(velocity, "velocity")?);
            let angular = vector(angular_velocity, "angular_velocity")?;
            let pose = self::pose(pose, "pose")?;
            LibraryMotion::free_flight(pose, center, velocity, angular)
                .of("center, velocity, angular_velocity")
        })
    }
}

/// Builds screw motions from each pose to the next one, of equal durations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_motion_through_poses(
    poses: *const Pose,
    pose_count: usize,
    motion: *mut *mut Motion,
) -> Status {
    unsafe {
        set(motion, || {
            let poses = array(poses, pose_count, "poses")?.iter().enumerate();
            let poses = poses.map(|(k, pose)| pose.checked(&format!("poses[{k}]")));
            LibraryMotion::through_poses(&poses.collect::<Fallible<Vec<_>>>()?).of("poses")
        })
    }
}

/// Frees a motion; null is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_motion_free(motion: *mut Motion) {
    unsafe { free(motion) }
}

/// Computes the pose at a time from 0 to 1, rounded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_motion_pose_at(
    motion: *const Motion,
    time: f64,
    pose: *mut Pose,
) -> Status {
    guard(|| unsafe {
        let pose = Output::new(pose, "pose")?;
        pose.set(reference(motion, "motion")?.0.pose_at(time).of("time")?.into());
        Ok(())
    })
}

/// Answers a query about two bodies along their motions.
unsafe fn answer(
    bodies: [*const Body; 2],
    motions: [*const Motion; 2],
    options: *const CastOptions,
    answer: *mut MotionAnswer,
    record: impl FnOnce(&AnyMotionCast<'_>) -> Fallible<MotionRecord>,
) -> Status {
    guard(|| unsafe {
        let answer = Output::new(answer, "answer")?;
        let cast = motion_cast(bodies, motions, options)?;
        answer.set(MotionAnswer::from(&record(&cast)?));
        Ok(())
    })
}

/// Finds the first time at which the bodies meet along their motions.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_motion_first_contact(
    moving: *const Body,
    moving_motion: *const Motion,
    fixed: *const Body,
    fixed_motion: *const Motion,
    options: *const CastOptions,
    answer: *mut MotionAnswer,
) -> Status {
    let (bodies, motions) = ([moving, fixed], [moving_motion, fixed_motion]);
    unsafe {
        self::answer(bodies, motions, options, answer, |cast| {
            Ok(match cast {
                ByKind::Convex(cast) => MotionRecord::from_outcome(&cast.first_contact()?, cast),
                ByKind::Solid(cast) => MotionRecord::of_solids(&cast.first_contact()?, cast),
            })
        })
    }
}

/// Finds how far the bodies can move along their motions. Bodies that touch at the start do not block each other unless
/// the motion makes them overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_motion_clearance(
    moving: *const Body,
    moving_motion: *const Motion,
    fixed: *const Body,
    fixed_motion: *const Motion,
    options: *const CastOptions,
    answer: *mut MotionAnswer,
) -> Status {
    let (bodies, motions) = ([moving, fixed], [moving_motion, fixed_motion]);
    unsafe {
        self::answer(bodies, motions, options, answer, |cast| {
            Ok(match cast {
                ByKind::Convex(cast) => MotionRecord::of_clearance(&cast.clearance()?, cast),
                ByKind::Solid(cast) => MotionRecord::of_solid_clearance(&cast.clearance()?, cast),
            })
        })
    }
}
