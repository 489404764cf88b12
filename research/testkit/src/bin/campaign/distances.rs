//! Campaign of distances, of settings as drawn, and moved along their direction near contact, to touching, and
//! to overlap.

use colltrans::{Pair, Pose, QueryError, Within};
use colltrans_testkit::oracle::check::Objection;
use colltrans_testkit::oracle::nearest::DistanceJudge;
use colltrans_testkit::oracle::settings::{Bodies, Setting, near_contact, setting};
use colltrans_testkit::random::Random;
use colltrans_testkit::tally::Tally;

use crate::Asked;

/// Maximum number of vertices of both bodies for which depths are compared with the exact one.
const SMALL: usize = 24;

/// Columns of the table.
pub(crate) const COLUMNS: &[&str] = &[
    "settings",
    "apart",
    "near",
    "meeting",
    "proven",
    "undecided",
    "widest",
    "wide",
    "deep",
    "compared",
    "widest depth",
    "open",
];

/// Computes the distance of a setting's bodies, and judges it.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let Asked { family, seed, .. } = *asked;
    let setting = setting(family, seed);
    tally.count("settings");
    let Ok(bodies) = setting.bodies() else { return Ok(()) };
    let mut random = Random::new(seed ^ 0x5eed);
    let moving = near_contact(&setting, &bodies, &mut random).unwrap_or(setting.moving_pose);
    Ok(judge_distances(&setting, &bodies, moving, &mut random, tally)?)
}

/// Judges distance, depth and `within` of two bodies.
fn judge_distances(
    setting: &Setting,
    bodies: &Bodies,
    moving: Pose,
    random: &mut Random,
    tally: &mut Tally,
) -> Result<(), Objection> {
    let error = |e: &dyn std::fmt::Display| Objection(e.to_string());
    let pair = Pair::new(bodies.moving.at(moving), bodies.fixed.at(setting.fixed_pose))
        .map_err(|e| error(&e))?;
    let judge = DistanceJudge::new(pair);
    let (answer, depth) = match (pair.distance(), pair.depth()) {
        (Ok(answer), Ok(depth)) => (answer, depth),
        (Err(QueryError::NotConverged { .. }), _) | (_, Err(QueryError::NotConverged { .. })) => {
            tally.count("open");
            return Ok(());
        }
        (Err(e), _) | (_, Err(e)) => return Err(error(&e)),
    };
    let apart = judge.check(&answer)?;
    tally.largest("widest", apart);
    tally.count_if("wide", apart > 4.0);
    let truth = judge.truth.to_f64();
    if judge.truth.intersects() {
        tally.count("meeting");
        tally.count_if("proven", answer.upper == 0.0);
    } else {
        tally.count("apart");
        tally.count_if("near", truth < judge.noise * 1e8);
    }
    tally.largest("widest depth", judge.check_depth(&depth)?);
    tally.count_if("deep", depth.lower > 0.0);
    let vertices = bodies.moving.vertices().len() + bodies.fixed.vertices().len();
    if judge.truth.intersects() && vertices <= SMALL && random.one_in(8) {
        judge.compare_depth(&depth)?;
        tally.count("compared");
    }
    for length in [truth, truth * random.range(0.0, 2.0), truth + judge.noise * 4.0, 0.0] {
        let within = pair.within(length).map_err(|e| error(&e))?;
        tally.count_if("undecided", matches!(within, Within::Undecided(_)));
        judge.check_within(length, &within)?;
    }
    Ok(())
}
