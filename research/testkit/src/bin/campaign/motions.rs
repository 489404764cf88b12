//! Campaign of motions: the bodies of a setting, one or both rotating, in screw motions or thrown, with minimum
//! gaps and tolerated depths. The library checks all proofs, and a sample is judged with the motion as a real
//! function. The clearance is examined in the same way, with depths and distances on the way.

use colltrans::motion::{Motion, MotionCast, MotionClearance, MotionOutcome, MotionStop};
use colltrans::{MIN_MAGNITUDE, Pair, Pose, QueryError};
use colltrans_testkit::oracle::check::Objection;
use colltrans_testkit::oracle::motion::{MotionJudge, Spin};
use colltrans_testkit::oracle::settings::setting;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::reach;
use colltrans_testkit::tally::Tally;
use glam::DVec3;

use crate::{Asked, column_of};

/// One setting out of this many is judged in integer arithmetic.
const SAMPLE: u64 = 100;

/// Number of times along a motion at which the depth is computed.
const TIMES: u32 = 8;

/// Columns of the table.
pub(crate) const COLUMNS: &[&str] = &[
    "settings",
    "contacts",
    "grazing",
    "free",
    "overlapping",
    "stopped",
    "looks",
    "most looks",
    "judged",
    "open",
];

/// Examines the first contact and the clearance of a motion of a setting's bodies.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let Asked { family, seed, .. } = *asked;
    let setting = setting(family, seed);
    tally.count("settings");
    let Ok(bodies) = setting.bodies() else { return Ok(()) };
    let Ok(cast) = setting.query(&bodies) else { return Ok(()) };
    let mut random = Random::new(seed ^ 0x0710_7104);
    let poses = [cast.moving_pose(), cast.fixed_pose()];
    let [p, q] = [cast.moving(), cast.fixed()];
    let size = reach(p.vertices()) + reach(q.vertices());
    let way = cast.direction().normalize_or_zero() * size;
    let Some(moving) = draw_spin(poses[0], poses[1], way, size, &mut random) else { return Ok(()) };
    let fixed = if random.one_in(3) {
        draw_spin(poses[1], poses[0], -way, size, &mut random)
    } else {
        Some(motion_at_rest(poses[1]))
    };
    let Some(fixed) = fixed else { return Ok(()) };
    let min_gap = match random.index(6) {
        0 => size * 10.0_f64.powf(random.range(-12.0, -0.5)),
        1 => -size * 10.0_f64.powf(random.range(-12.0, -1.0)),
        _ => 0.0,
    };
    let judge = MotionJudge { bodies: [p, q], spins: [moving, fixed], min_gap };
    Ok(check_first_contact(&judge, seed.is_multiple_of(SAMPLE), tally)?)
}

/// Returns the motion of a body at rest.
fn motion_at_rest(start: Pose) -> Spin {
    Spin { start, arm: DVec3::ZERO, axis: DVec3::Z, angle: 0.0, way: DVec3::ZERO }
}

/// Draws a motion: a rotation, a screw, a translation, or a throw. `None` if its numbers are not finite.
fn draw_spin(start: Pose, other: Pose, way: DVec3, size: f64, random: &mut Random) -> Option<Spin> {
    let axis = random.direction();
    let (from, to) = (start.translation(), other.translation());
    let between = from.lerp(to, random.range(-0.5, 1.5)) + random.vector() * size;
    let angle = random.range(-1.0, 1.0) * random.pick(&[1e-6, 1.0, 6.0, 6.0, 100.0]);
    let unit = axis / axis.length();
    let spin = match random.index(4) {
        0 => Spin { start, arm: from - between, axis: unit, angle, way: DVec3::ZERO },
        1 => {
            let way = unit * (random.range(-1.0, 1.0) * size);
            Spin { start, arm: from - between, axis: unit, angle, way }
        }
        2 => Spin { way: way * random.range(0.2, 4.0), ..motion_at_rest(start) },
        _ => {
            let omega = axis * angle;
            let (axis, angle) = (omega / omega.length(), omega.length());
            let way = (to - from) * random.range(0.2, 2.0) + way * random.range(-0.5, 0.5);
            Spin { start, arm: DVec3::ZERO, axis, angle, way }
        }
    };
    (spin.axis.is_finite() && spin.way.is_finite()).then_some(spin)
}

/// Builds the library's motion from these numbers; `None` if it is out of range.
fn motion(spin: &Spin) -> Option<Motion> {
    let Spin { start, arm, axis, angle, way } = spin;
    Motion::from_arm_and_axis(*start, *arm, *axis, *angle, *way).ok()
}

/// Computes the first contact, and checks it with the library, and in integer arithmetic if required.
fn check_first_contact(
    judge: &MotionJudge,
    in_whole_numbers: bool,
    tally: &mut Tally,
) -> Result<(), Objection> {
    let [Some(moving), Some(fixed)] = judge.spins.each_ref().map(motion) else { return Ok(()) };
    let cast =
        MotionCast::new(judge.bodies[0].with_motion(&moving), judge.bodies[1].with_motion(&fixed));
    let kept = cast.and_then(|cast| {
        if judge.min_gap < 0.0 {
            cast.with_tolerance(-judge.min_gap)
        } else {
            cast.with_min_gap(judge.min_gap)
        }
    });
    let cast = kept.map_err(|e| Objection(e.to_string()))?;
    let outcome = cast.first_contact().map_err(|e| Objection(e.to_string()))?;
    cast.verify(outcome.proof()).map_err(|e| Objection(e.to_string()))?;
    let looks = outcome.steps().looks;
    tally.mean("looks", looks);
    tally.largest("most looks", looks);
    tally.count(column_of!(&outcome, MotionOutcome, "open"));
    let planes: usize = outcome.proof().spans.iter().map(Vec::len).sum();
    let judged = in_whole_numbers && judge.bodies.iter().all(|b| b.vertices().len() < 60);
    if judged && planes < 60 && outcome.proof().solids.is_none() {
        tally.count("judged");
        judge.check(&outcome)?;
    }
    check_clearance(judge, &cast, &outcome, judged, tally)
}

/// Checks the clearance: its proof holds, it does not extend through a deep contact, and no position on the way
/// is deep.
fn check_clearance(
    judge: &MotionJudge,
    cast: &MotionCast,
    first: &MotionOutcome,
    judged: bool,
    tally: &mut Tally,
) -> Result<(), Objection> {
    let found = match cast.clearance() {
        Ok(found) => found,
        Err(QueryError::NotConverged { .. }) => {
            tally.count("open");
            return Ok(());
        }
        // This occurs if bodies are smaller than rounding errors.
        Err(QueryError::PositionError { .. }) => return Ok(()),
        Err(e) => return Err(Objection(format!("clearance: {e}"))),
    };
    let object =
        |what: String| Err(Objection(format!("clearance up to {:?}: {what}", found.time())));
    let cleared = cast.with_clearance_tolerance();
    let shrunk = match &found {
        MotionClearance::Overlapping(_) => {
            let overlaps = matches!(first, MotionOutcome::Overlapping(_));
            return if overlaps { Ok(()) } else { object("no overlap at the start".into()) };
        }
        MotionClearance::Free(free) => MotionOutcome::Free(free.clone()),
        MotionClearance::Blocked { time, contact } => {
            tally.count("stopped");
            let MotionStop { time: place, shrunk, .. } = &**contact;
            let is_bound = *time <= place.lower && *time <= shrunk.lower && *time >= 0.0;
            if !is_bound || place.lower > place.value || place.value > place.upper {
                return object("no bounds".into());
            }
            // The nominal contact is not before the first contact, unless there is a tolerance.
            let apart = if cast.tolerance() > 0.0 { 0.0 } else { apart_until(first) };
            if place.upper < apart || matches!(first, MotionOutcome::Free(_)) {
                return object(format!("no contact before {apart}"));
            }
            let proven = shrunk.upper.is_finite();
            let of = if proven { MotionOutcome::Contact } else { MotionOutcome::Grazing };
            of(shrunk.clone())
        }
    };
    cleared.verify(shrunk.proof()).map_err(|e| Objection(format!("clearance: {e}")))?;
    let min_gap = cleared.min_gap() - cleared.tolerance();
    let planes: usize = shrunk.proof().spans.iter().map(Vec::len).sum();
    if judged && planes < 60 {
        let spins = judge.spins.clone();
        MotionJudge { bodies: judge.bodies, spins, min_gap }
            .check(&shrunk)
            .map_err(|Objection(what)| Objection(format!("clearance: {what}")))?;
    }
    on_the_way(cast, found.time().unwrap_or(0.0), min_gap)
}

/// Returns the time up to which a first contact proves that the bodies are disjoint.
fn apart_until(first: &MotionOutcome) -> f64 {
    match first {
        MotionOutcome::Contact(of)
        | MotionOutcome::Grazing(of)
        | MotionOutcome::Overlapping(of)
        | MotionOutcome::Undecided(of) => of.lower,
        _ => 1.0,
    }
}

/// Checks that the bodies are not nearer than `min_gap` up to a time, or not deeper than `-min_gap` if it is
/// negative.
fn on_the_way(cast: &MotionCast, until: f64, min_gap: f64) -> Result<(), Objection> {
    for k in 0..=TIMES {
        let time = until * f64::from(k) / f64::from(TIMES);
        let [Ok(p), Ok(q)] = cast.motions().map(|motion| motion.pose_at(time)) else {
            return Ok(());
        };
        let [moving, fixed] = cast.bodies();
        let pair = Pair::new(moving.at(p), fixed.at(q)).map_err(|e| Objection(e.to_string()))?;
        // Poses are rounded relative to their size, and coordinates close to zero are not represented.
        let far = [p, q].map(|pose| pose.translation().length());
        let size = far[0] + far[1] + reach(moving.vertices()) + reach(fixed.vertices());
        let off = 256.0 * f64::EPSILON * size + 4.0 * MIN_MAGNITUDE;
        let wrong = match (pair.depth(), pair.distance()) {
            (Ok(depth), _) if min_gap <= 0.0 && depth.lower > off - min_gap => Some(-depth.lower),
            (_, Ok(found)) if min_gap > 0.0 && found.upper < min_gap - off => Some(found.upper),
            _ => None,
        };
        if let Some(gap) = wrong {
            return Err(Objection(format!("clearance: up to {until}, a gap of {gap:e} at {time}")));
        }
    }
    Ok(())
}
