//! First contacts of moving bodies.

use colltrans::Solver;
use colltrans::glam::DVec3;
use colltrans::motion::{Motion, MotionCast, MotionError};
use colltrans::record::{Ending, MotionRecord};
use colltrans_mesh::body::between_motions;

use super::answers::{
    Encode as _, FeatureField, Found, Free, MotionContact, MotionUndecided, Overlapping, PoseAnswer,
};
use super::bodies::Part;
use super::error::{Failure, Fallible, Kind};
use super::pairs::middle;
use super::question::{CastOptions, Numbers, PoseForm};
use super::solid::start_overlap;

impl From<MotionError> for Failure {
    fn from(error: MotionError) -> Self {
        Self::new(Kind::Query, "motion", error)
    }
}

/// Reads a motion: its kind, the pose at time 0, and the numbers of the kind. Poses that the body passes through are
/// matrices.
pub(crate) fn read(numbers: &mut Numbers<'_>, bytes: &[u8]) -> Fallible<Motion> {
    let kind = numbers.count()?;
    let pose = numbers.pose("pose")?;
    Ok(match kind {
        0 => Motion::at_rest(pose),
        1 => Motion::translation(pose, numbers.vector()?)?,
        2 => {
            let (point, axis) = (numbers.vector()?, numbers.vector()?);
            Motion::screw(pose, point, axis, numbers.next()?, numbers.next()?)?
        }
        3 => Motion::free_flight(pose, numbers.vector()?, numbers.vector()?, numbers.vector()?)?,
        4 => {
            let (first, count) = (numbers.count()?, numbers.count()?);
            let mut rows = Numbers::new(bytes).skip(first);
            let poses: Fallible<Vec<_>> =
                (0..count).map(|_| rows.pose_in(PoseForm::Matrix)).collect();
            Motion::through_poses(&poses.map_err(|error| error.of("poses"))?)?
        }
        _ => return Err(Failure::input("motion", "unknown kind of motion")),
    })
}

/// Returns the pose at a time.
pub(crate) fn pose_at(motion: &Motion, time: f64) -> Fallible<PoseAnswer> {
    let pose = motion.pose_at(time).map_err(|error| Failure::from(error).of("time"))?;
    let [x_axis, y_axis, z_axis] = [0, 1, 2].map(|axis| pose.matrix().col(axis));
    Ok(PoseAnswer { position: pose.translation(), x_axis, y_axis, z_axis })
}

/// Finds the first contact of two bodies, each along its motion.
pub(crate) fn answer(
    bodies: [&Part; 2],
    numbers: &mut Numbers<'_>,
    bytes: &[u8],
    options: &CastOptions,
) -> Fallible<Found> {
    let moving = read(numbers, bytes).map_err(|error| error.of("movingMotion"))?;
    let fixed = read(numbers, bytes).map_err(|error| error.of("fixedMotion"))?;
    let message = "a motion has no such option";
    if options.graze_tolerance.is_some() {
        return Err(Failure::input("grazeTolerance", message));
    }
    if options.solver != Solver::Auto {
        return Err(Failure::input("solver", message));
    }
    let record = if let [Part::Convex(p), Part::Convex(q)] = bodies {
        if options.ignore_start_overlaps {
            return Err(Failure::input("ignoreStartOverlaps", "it is an option for solids"));
        }
        let cast = MotionCast::new(p.with_motion(&moving), q.with_motion(&fixed))?;
        let cast = match options.tolerance {
            Some(_) if options.min_gap != 0.0 => {
                let message = "minGap and tolerance are both given; convex bodies accept only one";
                return Err(Failure::input("tolerance", message));
            }
            Some(depth) => cast.with_tolerance(depth)?,
            None => cast.with_min_gap(options.min_gap)?,
        };
        MotionRecord::from_outcome(&cast.first_contact()?, &cast)
    } else {
        let [p, q] = [bodies[0].surface("moving")?, bodies[1].surface("fixed")?];
        let (p, q) = (p.with_motion(&moving), q.with_motion(&fixed));
        let cast = between_motions(p, q, bodies.map(Part::precision), options.tolerance)?;
        let cast = cast.with_min_gap(options.min_gap)?.with_start_overlap(start_overlap(options));
        MotionRecord::of_solids(&cast.first_contact()?, &cast)
    };
    Ok(found(&record))
}

fn found(of: &MotionRecord) -> Found {
    let lower = of.time.map_or(0.0, |time| time.lower);
    let upper = of.time.and_then(|time| time.upper).unwrap_or(f64::INFINITY);
    match of.outcome {
        Ending::Contact => MotionContact {
            value: middle(lower, upper),
            lower,
            upper,
            normal: of.normal.map(DVec3::from_array),
            point: of.point.map(DVec3::from_array),
            features: of
                .features
                .as_ref()
                .map(|of| [&of.moving, &of.fixed].map(FeatureField::from_record)),
        }
        .found(),
        Ending::Free => Free::ANSWER.found(),
        Ending::Overlapping => {
            let least_tolerance = of.start_overlaps.first().and_then(|of| of.least_tolerance);
            Overlapping { value: None, back: None, on: None, least_tolerance }.found()
        }
        outcome => {
            let grazes = outcome == Ending::Grazing;
            MotionUndecided { value: None, lower, upper, grazes }.found()
        }
    }
}
