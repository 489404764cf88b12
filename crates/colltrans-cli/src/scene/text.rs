//! Answers of queries with a scene as text.

use colltrans::ObstacleId;
use colltrans::glam::DVec3;
use colltrans::record::{
    Ending, NearbyRecord, NearestRecord, PairQuestion, SceneClearanceRecord, SceneWithinRecord,
};

use crate::distance::{self, Accuracy};
use crate::numbers::{at_most, interval, length_down, length_up, point, unit_vector};
use crate::report::{push_features, push_line, push_min_gap, safe_distance};
use crate::terminal::escape_line;

/// Returns the answer of `distance`.
pub(super) fn nearest_text(record: &NearestRecord, accuracy: Accuracy) -> String {
    let text = distance::distance_text(PairQuestion::Distance, &record.into(), accuracy);
    let (headline, rest) = text.split_once('\n').unwrap_or((&text, ""));
    let mut text = format!("{headline}\n");
    let name = record.fixed.as_deref();
    push_line(&mut text, "nearest", &obstacle_text(name, record.obstacle, record.obstacles));
    text + rest
}

/// Returns the answer of `within`.
pub(super) fn within_text(record: &SceneWithinRecord, length: f64) -> String {
    let all = record.obstacles;
    let closer = record.closer.as_deref().unwrap_or_default();
    let mut text = match record.outcome {
        Ending::Closer => {
            let length = length_up(length);
            format!("closer: {} of {all} are no farther away than {length}\n", closer.len())
        }
        Ending::Undecided => {
            let length = length_down(length);
            format!("undecided: {length} lies between the bounds of some of {all}\n")
        }
        _ => format!("farther: all of {all} are farther away than {}\n", length_down(length)),
    };
    for NearbyRecord { obstacle, fixed, upper, .. } in closer {
        let name = obstacle_name(fixed.as_deref());
        push_line(
            &mut text,
            "closer",
            &format!("{name}, number {obstacle}: at most {}", at_most(*upper)),
        );
    }
    for NearbyRecord { obstacle, fixed, lower, upper, .. } in &record.undecided {
        let name = obstacle_name(fixed.as_deref());
        let bounds = interval([lower.unwrap_or_default(), *upper]);
        push_line(&mut text, "undecided", &format!("{name}, number {obstacle}: {bounds}"));
    }
    text
}

/// Returns the answer of `clearance`. `accuracy` is that of a blocking obstacle. `is_default` states that no tolerance
/// was given.
pub(super) fn clearance_text(
    record: &SceneClearanceRecord,
    direction: DVec3,
    accuracy: Option<Accuracy>,
    is_default: bool,
) -> String {
    let mut text = match record.outcome {
        Ending::Blocked => "blocked\n".to_owned(),
        Ending::Overlapping => "overlapping: the body overlaps an obstacle now\n".to_owned(),
        _ => {
            let all = record.obstacles;
            format!("free: none of {all} stops the body along this direction\n")
        }
    };
    if let Some(obstacle) = record.obstacle {
        push_line(
            &mut text,
            "by",
            &obstacle_text(record.fixed.as_deref(), obstacle, record.obstacles),
        );
    }
    if let (Ending::Blocked, Some(accuracy)) = (record.outcome, accuracy) {
        push_contact(&mut text, record, direction, accuracy);
    }
    if let Some(tolerance) = record.tolerance {
        let source = if is_default {
            "from the files' precision and the poses; --tolerance sets another"
        } else {
            "as given: each solid is offset inwards by half of it"
        };
        push_line(&mut text, "tolerance", &format!("{} ({source})", length_up(tolerance)));
    }
    push_min_gap(&mut text, record.min_gap);
    text
}

/// Returns a line about the graze tolerance; empty if it is 0.
pub(super) fn graze_line(tolerance: f64) -> String {
    let mut text = String::new();
    if tolerance > 0.0 {
        let passed = format!(
            "obstacles that overlap sideways by no more than {} do not block",
            length_up(tolerance)
        );
        push_line(&mut text, "grazing", &passed);
    }
    text
}

/// Appends the safe distance, the bounds and the contact.
fn push_contact(
    text: &mut String,
    record: &SceneClearanceRecord,
    direction: DVec3,
    accuracy: Accuracy,
) {
    let [distance, length] = safe_distance(record.distance, direction);
    push_line(text, "distance", &format!("{distance} times the direction, a length of {length}"));
    if let Some(bounds) = record.translation_bounds {
        push_line(text, "bounds", &interval(bounds));
    }
    push_features(text, record.features.as_ref(), [None, record.fixed.as_deref()]);
    if let (Some(normal), Some(place)) = (record.normal, record.point) {
        let Accuracy { error, extent } = accuracy;
        push_line(text, "normal", &unit_vector(normal.into()));
        push_line(text, "point", &point(place.into(), error, extent));
    }
}

/// Returns the name and the number of an obstacle.
fn obstacle_text(name: Option<&str>, obstacle: ObstacleId, obstacles: usize) -> String {
    format!("{}, number {obstacle} of {obstacles}, counted from 0", obstacle_name(name))
}

/// Returns the escaped name of an obstacle, or a replacement if it has none.
fn obstacle_name(name: Option<&str>) -> String {
    escape_line(name.unwrap_or("an obstacle"))
}
