//! Distances: of settings as they are drawn, brought near contact along their direction, to touch, and to
//! overlap.

use colltrans::{Pair, Pose, QueryError, Within};
use colltrans_testkit::oracle::check::Objection;
use colltrans_testkit::oracle::nearest::Judge;
use colltrans_testkit::oracle::settings::{Bodies, Setting, near_contact, setting};
use colltrans_testkit::random::Random;

/// Vertices of both bodies up to which depths are compared with the exact one.
const SMALL: usize = 24;

/// What became of the settings of one family.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    settings: u64,
    apart: u64,
    meeting: u64,
    /// Of those apart, less than `1e-6` of the size.
    near: u64,
    /// Meeting ones that are proven to.
    proven: u64,
    undecided: u64,
    /// Without an answer: nothing is claimed of them.
    open: u64,
    /// The most that bounds are apart, in noises.
    widest: f64,
    /// More than four noises apart.
    wide: u64,
    /// Depths proven to be positive, and the most that their bounds are apart, in noises.
    deep: u64,
    /// Those of meeting bodies compared with the exact one.
    compared: u64,
    widest_depth: f64,
    disagreements: Vec<String>,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 64;

    fn header() -> String {
        format!(
            "{:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} {:>8} {:>6} {:>8} {:>8} {:>6} {:>6}",
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
            "widest",
            "open",
            "wrong"
        )
    }

    fn line(&self) -> String {
        format!(
            "{:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8.2} {:>8} {:>6} {:>8} {:>8.2} {:>6} {:>6}",
            self.settings,
            self.apart,
            self.near,
            self.meeting,
            self.proven,
            self.undecided,
            self.widest,
            self.wide,
            self.deep,
            self.compared,
            self.widest_depth,
            self.open,
            self.disagreements.len()
        )
    }

    fn merge(mut self, other: Self) -> Self {
        self.settings += other.settings;
        self.apart += other.apart;
        self.near += other.near;
        self.meeting += other.meeting;
        self.proven += other.proven;
        self.undecided += other.undecided;
        self.open += other.open;
        self.widest = self.widest.max(other.widest);
        self.wide += other.wide;
        self.deep += other.deep;
        self.compared += other.compared;
        self.widest_depth = self.widest_depth.max(other.widest_depth);
        self.disagreements.extend(other.disagreements);
        self
    }

    fn disagreements(&self) -> &[String] {
        &self.disagreements
    }
}

/// Asks for the distance of a setting's bodies, and judges it.
pub(crate) fn examine(family: &str, seed: u64, tally: &mut Tally) {
    let setting = setting(family, seed);
    tally.settings += 1;
    let Ok(bodies) = setting.bodies() else { return };
    let mut random = Random::new(seed ^ 0x5eed);
    let moving = near_contact(&setting, &bodies, &mut random).unwrap_or(setting.moving_pose);
    let verdict = judge(&setting, &bodies, moving, &mut random, tally);
    if let Err(objection) = verdict {
        tally.disagreements.push(format!("{setting} {objection}"));
    }
}

fn judge(
    setting: &Setting,
    bodies: &Bodies,
    moving: Pose,
    random: &mut Random,
    tally: &mut Tally,
) -> Result<(), Objection> {
    let error = |e: &dyn std::fmt::Display| Objection(e.to_string());
    let pair = Pair::new(bodies.moving.at(moving), bodies.fixed.at(setting.fixed_pose))
        .map_err(|e| error(&e))?;
    let judge = Judge::new(pair);
    let (answer, depth) = match (pair.distance(), pair.depth()) {
        (Ok(answer), Ok(depth)) => (answer, depth),
        (Err(QueryError::NotConverged { .. }), _) | (_, Err(QueryError::NotConverged { .. })) => {
            tally.open += 1;
            return Ok(());
        }
        (Err(e), _) | (_, Err(e)) => return Err(error(&e)),
    };
    let apart = judge.check(&answer)?;
    tally.widest = tally.widest.max(apart);
    tally.wide += u64::from(apart > 4.0);
    let truth = judge.truth.to_f64();
    if judge.truth.intersects() {
        tally.meeting += 1;
        tally.proven += u64::from(answer.upper == 0.0);
    } else {
        tally.apart += 1;
        tally.near += u64::from(truth < judge.noise * 1e8);
    }
    tally.widest_depth = tally.widest_depth.max(judge.check_depth(&depth)?);
    tally.deep += u64::from(depth.lower > 0.0);
    let vertices = bodies.moving.vertices().len() + bodies.fixed.vertices().len();
    if judge.truth.intersects() && vertices <= SMALL && random.one_in(8) {
        judge.compare_depth(&depth)?;
        tally.compared += 1;
    }
    for length in [truth, truth * random.range(0.0, 2.0), truth + judge.noise * 4.0, 0.0] {
        let within = pair.within(length).map_err(|e| error(&e))?;
        tally.undecided += u64::from(matches!(within, Within::Undecided(_)));
        judge.check_within(length, &within)?;
    }
    Ok(())
}
