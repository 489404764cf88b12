//! Bodies that do not turn, asked from several places and along several directions by the faces of their difference:
//! each answer judged, and held against the ordinary cast's.

use colltrans::{FixedRotations, Outcome, StartedFrom};
use colltrans_testkit::oracle::settings::setting;
use colltrans_testkit::oracle::still::{CASTS, ask, cast};
use colltrans_testkit::random::Random;

/// One of so many is solved by the linear programme, whatever its certificate proves.
const LP_EVERY: u64 = 200;

/// What became of the casts of one family.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    casts: u64,
    contact: u64,
    grazing: u64,
    separated: u64,
    answers: u64,
    /// Answered by the faces.
    by_faces: u64,
    /// Whose outcome or value is another one, both of which are admissible.
    rounding: u64,
    disagreements: Vec<String>,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 16;

    fn header() -> String {
        let heads = ["casts", "contact", "grazing", "separated", "answers", "by faces", "rounding"];
        let heads = heads.iter().chain(&["wrong"]).map(|head| format!("{head:>9} "));
        heads.collect::<Vec<_>>().concat()
    }

    fn line(&self) -> String {
        let counts = [self.casts, self.contact, self.grazing, self.separated, self.answers];
        let counts = counts.map(|count| format!("{count:>9} ")).concat();
        let share = self.by_faces as f64 / self.answers.max(1) as f64;
        format!("{counts}{share:>9.3} {:>9} {:>9}", self.rounding, self.disagreements.len())
    }

    fn merge(mut self, other: Self) -> Self {
        self.casts += other.casts;
        self.contact += other.contact;
        self.grazing += other.grazing;
        self.separated += other.separated;
        self.answers += other.answers;
        self.by_faces += other.by_faces;
        self.rounding += other.rounding;
        self.disagreements.extend(other.disagreements);
        self
    }

    fn disagreements(&self) -> &[String] {
        &self.disagreements
    }
}

/// Asks [`CASTS`] of a setting.
pub(crate) fn examine(family: &str, seed: u64, tally: &mut Tally) {
    let setting = setting(family, seed);
    let Ok(bodies) = setting.bodies() else { return };
    let [moving, fixed] =
        [bodies.moving.at(setting.moving_pose), bodies.fixed.at(setting.fixed_pose)];
    let rotations = FixedRotations::new(moving, fixed);
    let Ok(approach) = rotations.along(setting.direction) else { return };
    let mut random = Random::new(seed ^ 0xb01c);
    let index = seed & u64::from(u32::MAX);
    for which in 0..CASTS {
        let Ok(cast) = cast(&setting, &bodies, which, &mut random) else { continue };
        tally.casts += 1;
        let findings = ask(&rotations, &approach, &cast, &setting, index.is_multiple_of(LP_EVERY));
        let findings = match findings {
            Ok(findings) => findings,
            Err(objection) => {
                tally.disagreements.push(format!("{setting} cast {which}: {objection}"));
                continue;
            }
        };
        if let Some((_, outcome, _)) = findings.first() {
            match outcome {
                Outcome::Contact(_) => tally.contact += 1,
                Outcome::Grazing(_) => tally.grazing += 1,
                Outcome::Separated(_) => tally.separated += 1,
            }
        }
        for (who, outcome, verdict) in findings {
            tally.answers += 1;
            let by_faces = outcome.steps().started_from == StartedFrom::Difference;
            tally.by_faces += u64::from(by_faces);
            match verdict {
                Ok(agreement) => tally.rounding += u64::from(agreement.rounding_decides),
                Err(objection) => tally
                    .disagreements
                    .push(format!("{setting} cast {which} {who} ({by_faces}): {objection}")),
            }
        }
    }
}
