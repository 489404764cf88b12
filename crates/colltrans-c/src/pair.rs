//! Questions about two placed bodies without a direction: distance, proximity, penetration depth.

use colltrans::record::{PairQuestion, Record};
use colltrans::{ByKind, Pair, Solid};

use crate::answer::{DepthAnswer, DistanceAnswer};
use crate::body::{Body, Placement, Pose, placed};
use crate::error::{Failure, Fallible, Output, Status, found, guard};

/// A pair of two convex bodies or of two solids.
pub(crate) type AnyPair<'a> = ByKind<Pair<'a>, Pair<'a, Solid>>;

/// Builds the pair of two placed bodies.
#[inline(always)]
#[expect(clippy::inline_always, reason = "a copy through memory costs as much as the call")]
pub(crate) fn pair<'a>(bodies: &Placement<'a>) -> Fallible<AnyPair<'a>> {
    if let Some([moving, fixed]) = bodies.convex() {
        return Ok(ByKind::Convex(Pair::new(moving, fixed)?));
    }
    let [moving, fixed] = bodies.solids()?;
    Ok(ByKind::Solid(Pair::new(moving, fixed)?))
}

/// Computes the record of a question.
fn record(question: PairQuestion, pair: &AnyPair<'_>) -> Fallible<Record> {
    Ok(match pair {
        ByKind::Convex(pair) => question.answer(pair)?.record(pair),
        ByKind::Solid(pair) => question.answer_solids(pair)?.record(pair)?,
    })
}

/// Computes a distance.
#[inline]
pub(crate) fn distance_of(pair: &AnyPair<'_>) -> Fallible<DistanceAnswer> {
    match pair {
        ByKind::Convex(pair) => {
            let bodies = [pair.moving(), pair.fixed()];
            let distance = pair.distance();
            Ok(DistanceAnswer::of_convex(found(&distance)?, bodies))
        }
        ByKind::Solid(_) => distance_record(PairQuestion::Distance, pair),
    }
}

fn distance_record(question: PairQuestion, pair: &AnyPair<'_>) -> Fallible<DistanceAnswer> {
    match record(question, pair)? {
        Record::Distance(of) => Ok(DistanceAnswer::from(&of)),
        other => Err(unexpected(&other)),
    }
}

/// Builds the failure for a record of another question.
fn unexpected(record: &Record) -> Failure {
    Failure::new(Status::InternalError, format_args!("unexpected record: {}", record.outcome()))
}

/// Computes the distance of the bodies and their nearest points. Null poses are the identity.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_distance(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    answer: *mut DistanceAnswer,
) -> Status {
    guard(move || unsafe {
        let answer = Output::new(answer, "answer")?;
        let pair = pair(&placed(moving, moving_pose, fixed, fixed_pose)?)?;
        answer.set(distance_of(&pair)?);
        Ok(())
    })
}

/// Computes the lower and the upper bound of the distance, without points and features.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_distance_bounds(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    bounds: *mut f64,
) -> Status {
    guard(move || unsafe {
        let bounds: Output<[f64; 2]> = Output::new(bounds.cast(), "bounds")?;
        bounds.set(match pair(&placed(moving, moving_pose, fixed, fixed_pose)?)? {
            ByKind::Convex(pair) => pair.distance_bounds()?,
            ByKind::Solid(pair) => pair.distance_bounds()?,
        });
        Ok(())
    })
}

/// Decides whether the bodies are closer than a length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_within(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    length: f64,
    answer: *mut DistanceAnswer,
) -> Status {
    guard(move || unsafe {
        let answer = Output::new(answer, "answer")?;
        let pair = pair(&placed(moving, moving_pose, fixed, fixed_pose)?)?;
        answer.set(distance_record(PairQuestion::Within(length), &pair)?);
        Ok(())
    })
}

/// Computes the shortest translation that separates convex bodies, or the least tolerance at which solids do not
/// overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_depth(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    answer: *mut DepthAnswer,
) -> Status {
    guard(move || unsafe {
        let answer = Output::new(answer, "answer")?;
        let pair = pair(&placed(moving, moving_pose, fixed, fixed_pose)?)?;
        answer.set(match record(PairQuestion::Depth, &pair)? {
            Record::Depth(of) => DepthAnswer::from(&of),
            other => return Err(unexpected(&other)),
        });
        Ok(())
    })
}
