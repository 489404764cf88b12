//! The answers in words.

use colltrans::ObstacleId;
use colltrans::glam::DVec3;
use colltrans::record::{
    Ending, NearbyRecord, NearestRecord, PairQuestion, SceneClearanceRecord, SceneWithinRecord,
};

use crate::distance;
use crate::numbers::{known_vector, number, unit_vector};
use crate::report::{features, kept, line, safe};
use crate::terminal::shown;

/// Which obstacle is nearest.
pub(super) fn nearest(record: &NearestRecord, error: f64) -> String {
    let text = distance::distance(PairQuestion::Distance, &record.into(), error);
    let (headline, rest) = text.split_once('\n').unwrap_or((&text, ""));
    let mut text = format!("{headline}\n");
    let name = record.fixed.as_deref();
    line(&mut text, "nearest", &which(name, record.obstacle, record.obstacles));
    text + rest
}

/// Which ones are closer than a length.
pub(super) fn within(record: &SceneWithinRecord, length: f64) -> String {
    let (length, all) = (number(length), record.obstacles);
    let closer = record.closer.as_deref().unwrap_or_default();
    let mut text = match record.outcome {
        Ending::Closer => {
            format!("closer: {} of {all} are no farther away than {length}\n", closer.len())
        }
        Ending::Undecided => {
            format!("undecided: of some of {all}, {length} lies between the bounds\n")
        }
        _ => format!("farther: all of {all} are farther away than {length}\n"),
    };
    for NearbyRecord { obstacle, fixed, upper, .. } in closer {
        let name = named(fixed.as_deref());
        line(
            &mut text,
            "closer",
            &format!("{name}, number {obstacle}: at most {}", number(*upper)),
        );
    }
    for NearbyRecord { obstacle, fixed, lower, upper, .. } in &record.undecided {
        let name = named(fixed.as_deref());
        let bounds = format!("{} to {}", number(lower.unwrap_or_default()), number(*upper));
        line(&mut text, "undecided", &format!("{name}, number {obstacle}: {bounds}"));
    }
    text
}

/// Which one the body meets first.
pub(super) fn clearance(
    record: &SceneClearanceRecord,
    direction: DVec3,
    error: f64,
    is_default: bool,
) -> String {
    let mut text = match record.outcome {
        Ending::Blocked => "blocked\n".to_owned(),
        Ending::Overlapping => "overlapping: the body overlaps an obstacle now\n".to_owned(),
        _ => {
            let all = record.obstacles;
            format!("free: none of {all} stops it along this direction\n")
        }
    };
    if let Some(obstacle) = record.obstacle {
        line(&mut text, "by", &which(record.fixed.as_deref(), obstacle, record.obstacles));
    }
    if record.outcome == Ending::Blocked {
        blocked(&mut text, record, direction, error);
    }
    if let Some(tolerance) = record.tolerance {
        let source = if is_default {
            "from the files' precision and the poses; --tolerance sets another"
        } else {
            "as asked: of solids, both bodies are shrunk by half of it"
        };
        line(&mut text, "tolerance", &format!("{} ({source})", number(tolerance)));
    }
    kept(&mut text, record.keep);
    text
}

/// Who passes by a tolerance that was asked for.
pub(super) fn grazed(tolerance: f64) -> String {
    let mut text = String::new();
    if tolerance > 0.0 {
        let by = format!("who overlaps sideways by no more than {} is passed", number(tolerance));
        line(&mut text, "grazing", &by);
    }
    text
}

fn blocked(text: &mut String, record: &SceneClearanceRecord, direction: DVec3, error: f64) {
    let [far, length] = safe(record.distance, direction);
    line(text, "distance", &format!("{far} times the direction, a length of {length}"));
    if let Some([lower, upper]) = record.translation_bounds {
        line(text, "bounds", &format!("{} to {}", number(lower), number(upper)));
    }
    features(text, record.features.as_ref(), [None, record.fixed.as_deref()]);
    if let (Some(normal), Some(point)) = (record.normal, record.point) {
        let rounding = 1e-14 * point.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        line(text, "normal", &unit_vector(normal.into()));
        line(text, "point", &known_vector(point.into(), error.max(rounding)));
    }
}

/// The obstacle that is told of.
fn which(name: Option<&str>, obstacle: ObstacleId, obstacles: usize) -> String {
    format!("{}, number {obstacle} of {obstacles}, from 0 on", named(name))
}

fn named(name: Option<&str>) -> String {
    shown(name.unwrap_or("an obstacle"))
}
