//! Campaign of bodies that do not rotate, queried by the faces of their Minkowski difference with several
//! positions and directions. Each answer is judged, and compared with that of a normal cast.

use colltrans::{FixedRotations, StartedFrom};
use colltrans_testkit::oracle::settings::setting;
use colltrans_testkit::oracle::still::{CASTS, ask, cast};
use colltrans_testkit::random::Random;
use colltrans_testkit::tally::Tally;

use crate::{Asked, casts};

/// One setting out of this many is solved by the linear programme, regardless of the certificate.
const LP_EVERY: u64 = 200;

/// Columns of the table.
pub(crate) const COLUMNS: &[&str] =
    &["casts", "contact", "grazing", "separated", "answers", "by faces", "rounding"];

/// Examines [`CASTS`] casts of a setting.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) {
    let Asked { family, seed, .. } = *asked;
    let setting = setting(family, seed);
    let Ok(bodies) = setting.bodies() else { return };
    let [moving, fixed] =
        [bodies.moving.at(setting.moving_pose), bodies.fixed.at(setting.fixed_pose)];
    let rotations = FixedRotations::new(moving, fixed);
    let Ok(approach) = rotations.for_direction(setting.direction) else { return };
    let mut random = Random::new(seed ^ 0xb01c);
    for which in 0..CASTS {
        let Ok(cast) = cast(&setting, &bodies, which, &mut random) else { continue };
        tally.count("casts");
        let findings =
            ask(&rotations, &approach, &cast, &setting, asked.index().is_multiple_of(LP_EVERY));
        let findings = match findings {
            Ok(findings) => findings,
            Err(objection) => {
                tally.disagree(format!("{setting} cast {which}: {objection}"));
                continue;
            }
        };
        if let Some((_, outcome, _)) = findings.first() {
            tally.count(casts::kind(outcome));
        }
        for (who, outcome, verdict) in findings {
            tally.count("answers");
            let by_faces = outcome.steps().started_from == StartedFrom::Difference;
            tally.mean("by faces", u8::from(by_faces));
            match verdict {
                Ok(agreement) => tally.count_if("rounding", agreement.rounding_decides),
                Err(objection) => {
                    tally.disagree(format!(
                        "{setting} cast {which} {who} ({by_faces}): {objection}"
                    ));
                }
            }
        }
    }
}
