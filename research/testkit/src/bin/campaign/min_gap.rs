//! Campaign of casts with a minimum gap. Gaps of random settings are between rounding errors and many times the
//! size of the bodies, and include the gaps at which bodies graze or start. The family [`GLIDING`] has bodies
//! that slide at about the gap.

use colltrans::{Cast, Clearance, ConvexPolyhedron, Outcome, Pair, Pose, QueryError};
use colltrans_testkit::oracle::check::Objection;
use colltrans_testkit::oracle::min_gap::GapJudge;
use colltrans_testkit::oracle::settings::setting;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{random_hull, reach};
use colltrans_testkit::tally::Tally;
use glam::{DQuat, DVec3};

use crate::Asked;

/// The family of boxes and hulls with a flat side that slide above another one. Their distance is the gap up to
/// some noises, and they are tilted by about as much.
pub(crate) const GLIDING: &str = "gliding";

/// Bounds that differ by more than this many noises over `n.d` are counted as wide.
const WIDE: f64 = 6.0;

/// Columns of the table.
pub(crate) const COLUMNS: &[&str] = &[
    "settings",
    "contacts",
    "grazing",
    "separated",
    "blocked",
    "nearer",
    "widest",
    "wide",
    "looks",
    "most looks",
    "open",
];

/// Casts the bodies of a setting with a gap, and judges the answers.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let Asked { family, seed, .. } = *asked;
    if family == GLIDING {
        return examine_gliding(seed, tally);
    }
    let setting = setting(family, seed);
    tally.count("settings");
    let Ok(bodies) = setting.bodies() else { return Ok(()) };
    let mut random = Random::new(seed ^ 0x6a9);
    let Ok(cast) = setting.query(&bodies) else { return Ok(()) };
    let gap = draw_gap(&cast, &mut random);
    judge_with_gap(&cast, gap, tally).map_err(|objection| format!("{gap:e} {objection}"))
}

/// Examines one setting of [`GLIDING`].
fn examine_gliding(seed: u64, tally: &mut Tally) -> Result<(), String> {
    let mut random = Random::new(seed ^ 0x61de);
    tally.count("settings");
    let size = 10.0_f64.powf(random.range(-3.0, 3.0));
    let flat = |random: &mut Random, side: f64| {
        let half =
            DVec3::new(random.range(0.5, 1.5), random.range(0.5, 1.5), random.range(0.5, 1.5));
        let corners = (0..8).map(|k| {
            let sign = |bit: u32| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
            half * DVec3::new(sign(0), sign(1), sign(2))
        });
        let hull = random_hull(12, random).vertices.into_iter().map(|v| v * 2.0);
        // The corners of a box, or a hull that is cut to a flat side towards the other body.
        let cut = |v: DVec3| if v.z * side > half.z { v.with_z(half.z * side) } else { v };
        let points: Vec<DVec3> = if random.index(2) == 0 {
            corners.collect()
        } else {
            hull.chain(corners).map(cut).collect()
        };
        (points.into_iter().map(|v| v * size).collect::<Vec<_>>(), half.z * size)
    };
    let [(moving, low), (fixed, high)] = [flat(&mut random, -1.0), flat(&mut random, 1.0)];
    let bodies = [moving, fixed].map(|points| ConvexPolyhedron::from_points(&points));
    let [Ok(moving), Ok(fixed)] = bodies else { return Ok(()) };
    let gap = size * 10.0_f64.powf(random.range(-6.0, 0.5));
    let noise = 16.0 * f64::EPSILON * (6.0 * size + gap);
    let tilt = DQuat::from_axis_angle(
        DVec3::new(random.range(-0.3, 0.3), 1.0, 0.0).normalize(),
        random.range(-8.0, 8.0) * noise / size,
    );
    let start = DVec3::new(random.range(-4.0, 4.0), random.range(-0.4, 0.4), 0.0) * size;
    let height = low + high + gap - random.range(-2.0, 24.0) * noise;
    let Ok(pose) = Pose::new(tilt, start + DVec3::Z * height) else { return Ok(()) };
    let cast = Cast::new(moving.at(pose), fixed.at(Pose::IDENTITY), DVec3::X);
    let Ok(cast) = cast else { return Ok(()) };
    judge_with_gap(&cast, gap, tally).map_err(|objection| format!("{gap:e} {objection}"))
}

/// Draws a gap: 0, some rounding errors, a fraction or a multiple of the size, or a gap at which a case is
/// tied.
fn draw_gap(cast: &Cast, random: &mut Random) -> f64 {
    let size = (reach(cast.moving().vertices()) + reach(cast.fixed().vertices())).max(1e-50);
    let gap = match random.index(10) {
        0 => 0.0,
        1 => size * f64::EPSILON * random.range(0.0, 400.0),
        2 => size * 1e-9,
        3 => size * 10.0_f64.powf(random.range(-14.0, 0.0)),
        4 => size * 10.0_f64.powf(random.range(0.0, 4.0)),
        5 => random.pick(&[0.125, 0.25, 0.5, 1.0, 2.0]),
        6 | 7 => size * random.range(0.0, 1.0),
        // The gap of the shadows, or that at the start, or one close to it.
        kind => {
            let tied = if kind == 8 {
                GapJudge::new(*cast).shadows
            } else {
                let pair = Pair::new(
                    cast.moving().at(cast.moving_pose()),
                    cast.fixed().at(cast.fixed_pose()),
                );
                pair.ok().and_then(|pair| pair.distance().ok()).map_or(0.0, |found| found.upper)
            };
            tied * (1.0 + random.pick(&[0.0, 0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-7, -1e-7]))
        }
    };
    gap.clamp(0.0, 1e58)
}

/// Judges the first contact and the clearance with a gap.
fn judge_with_gap(cast: &Cast, gap: f64, tally: &mut Tally) -> Result<(), Objection> {
    let error = |e: &dyn std::fmt::Display| Objection(e.to_string());
    let kept = cast.with_min_gap(gap).map_err(|e| error(&e))?;
    if gap == 0.0 && kept.first_contact() != cast.first_contact() {
        return Err(Objection("a gap of 0 changes the answer".into()));
    }
    let judge = GapJudge::new(kept);
    let (outcome, clearance) = match (kept.first_contact(), kept.clearance()) {
        (Ok(outcome), Ok(clearance)) => (outcome, clearance),
        (Err(QueryError::NotConverged { reason }), _)
        | (_, Err(QueryError::NotConverged { reason })) => {
            tally.count("open");
            eprintln!("no answer with a gap of {gap:e}: {reason}");
            return Ok(());
        }
        (Err(e), _) | (_, Err(e)) => return Err(error(&e)),
    };
    let noises = judge.check(&outcome)?.noises;
    judge.check_clearance(&clearance)?;
    match &outcome {
        Outcome::Contact(contact) => {
            tally.count("contacts");
            tally.mean("looks", contact.steps.pivots);
            tally.largest("most looks", contact.steps.pivots);
            tally.largest("widest", noises);
            tally.count_if("wide", noises > WIDE);
        }
        Outcome::Grazing(_) => tally.count("grazing"),
        Outcome::Separated(_) => tally.count("separated"),
    }
    tally.count_if("blocked", matches!(clearance, Clearance::Blocked { .. }));
    tally.count_if("nearer", matches!(clearance, Clearance::Overlapping(_)));
    Ok(())
}
