//! Fuzz target of rotating bodies.
//!
//! Bytes are read as for casts, whose direction is the translation of the moving body's axis. Then follow, for
//! each body, arm, axis and angle (a product of two numbers), and for the fixed body the translation of its
//! axis, and finally the gap or tolerance.

use colltrans::QueryError;
use colltrans::motion::{Motion, MotionCast};

use super::{Reader, read_setting};
use crate::oracle::motion::{MotionJudge, Spin};

/// Maximum angle. Larger angles are covered by the library's own checks.
const MOST_ANGLE: f64 = 1e4;
/// Maximum number of planes of a proof that is judged exactly. More planes would only slow down a run.
const MOST_PLANES: usize = 40;

/// Checks that a first contact of two rotating bodies is proven, and that its proof holds for the motion as a
/// real function.
///
/// # Panics
/// If an answer is wrong.
pub fn motion(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let Some((setting, bodies)) = read_setting(&mut reader) else { return };
    let poses = [setting.moving_pose, setting.fixed_pose];
    let mut spins = Vec::new();
    for start in poses {
        let (arm, axis) = (reader.vector(), reader.vector());
        let (axis, angle) = (axis / axis.length(), reader.number() * reader.number());
        let way = if spins.is_empty() { setting.direction } else { reader.vector() };
        if angle.abs() > MOST_ANGLE {
            return;
        }
        spins.push(Spin { start, arm, axis, angle, way });
    }
    let Ok([moving, fixed]) = <[Spin; 2]>::try_from(spins) else { return };
    let spun = |spin: &Spin| {
        Motion::from_arm_and_axis(spin.start, spin.arm, spin.axis, spin.angle, spin.way)
    };
    let (Ok(a), Ok(b)) = (spun(&moving), spun(&fixed)) else { return };
    let cast = MotionCast::new(bodies.moving.with_motion(&a), bodies.fixed.with_motion(&b));
    let (kind, length) = (reader.byte(), reader.number().abs() / 64.0);
    let kept = cast.and_then(|cast| match kind % 3 {
        0 => Ok(cast),
        1 => cast.with_min_gap(length),
        _ => cast.with_tolerance(length),
    });
    let Ok(cast) = kept else { return };
    let outcome = match cast.first_contact() {
        Ok(outcome) => outcome,
        // Bodies that are nearly straight lines may have no answer.
        Err(QueryError::NotConverged { .. }) => return,
        Err(error) => panic!("{error}"),
    };
    let checked = cast.verify(outcome.proof());
    checked.unwrap_or_else(|error| panic!("{error}: {outcome:?}"));
    if outcome.proof().spans.iter().map(Vec::len).sum::<usize>() > MOST_PLANES {
        return;
    }
    let (bodies, min_gap) = ([&bodies.moving, &bodies.fixed], cast.min_gap() - cast.tolerance());
    let judge = MotionJudge { bodies, spins: [moving, fixed], min_gap };
    judge.check(&outcome).unwrap_or_else(|error| panic!("{error}: {outcome:?}"));
}
