//! Bodies that turn.
//!
//! Bytes are read as for casts, whose direction is the way of the moving body's axis; then of each body an arm and an
//! axis, its angle as a product, and of the fixed one its way; and what is to be kept.

use colltrans::QueryError;
use colltrans::motion::{Motion, MotionCast};

use super::{Reader, read_setting};
use crate::oracle::motion::{Judge, Spin};

/// Angles beyond are for the library's own checks.
const MOST_ANGLE: f64 = 1e4;
/// Planes of a proof that are judged with as many digits as it takes: more would only make a run slower.
const MOST_PLANES: usize = 40;

/// A first contact of two bodies that spin is proven, and its proof holds for the motion as a real function.
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
    let spun = |spin: &Spin| Motion::about(spin.start, spin.arm, spin.axis, spin.angle, spin.way);
    let (Ok(a), Ok(b)) = (spun(&moving), spun(&fixed)) else { return };
    let cast = MotionCast::new(bodies.moving.along(&a), bodies.fixed.along(&b));
    let (kind, length) = (reader.byte(), reader.number().abs() / 64.0);
    let kept = cast.and_then(|cast| match kind % 3 {
        0 => Ok(cast),
        1 => cast.keeping(length),
        _ => cast.tolerating(length),
    });
    let Ok(cast) = kept else { return };
    let outcome = match cast.first_contact() {
        Ok(outcome) => outcome,
        // Of bodies that are nearly straight lines: nothing is said of them.
        Err(QueryError::NotConverged { .. }) => return,
        Err(error) => panic!("{error}"),
    };
    let checked = cast.verify(outcome.proof());
    checked.unwrap_or_else(|error| panic!("{error}: {outcome:?}"));
    if outcome.proof().spans.iter().map(Vec::len).sum::<usize>() > MOST_PLANES {
        return;
    }
    let (bodies, keep) = ([&bodies.moving, &bodies.fixed], cast.keep() - cast.tolerance());
    let judge = Judge { bodies, spins: [moving, fixed], keep };
    judge.check(&outcome).unwrap_or_else(|error| panic!("{error}: {outcome:?}"));
}
