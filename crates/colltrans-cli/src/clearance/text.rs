//! Answers of `colltrans clearance` for parts as text.

use colltrans::glam::DVec3;
use colltrans::record::{Ending, Record};

use crate::numbers::{
    at_least, at_most, interval, interval_of_unit, length_up, point, unit_vector, vector,
};
use crate::record::Line;
use crate::report::{
    overlap_hint, push_features, push_line, push_min_gap, push_start_overlaps, safe_travel,
};
use crate::solid::Answer;

/// Number of tolerances up to which a travel suggests that a fit is tighter than the tolerance.
const TIGHT_FIT: f64 = 4.0;

/// Returns the answer. `is_default` states that no tolerance was given.
pub(super) fn answer_text(answer: &Answer, direction: DVec3, is_default: bool) -> String {
    let mut text = String::new();
    let record = &answer.record;
    let tolerance = record.tolerance.unwrap_or_default();
    match record.outcome {
        Ending::Blocked => {
            text.push_str("blocked\n");
            push_contact(&mut text, answer, direction);
            let tight = TIGHT_FIT * tolerance;
            if is_default && record.distance.is_some_and(|t| t * direction.length() <= tight) {
                let fit = "if a fit slides here, give the sum of both chord errors as --tolerance";
                push_line(&mut text, "", fit);
            }
        }
        Ending::Overlapping => text.push_str("overlapping: the bodies overlap now\n"),
        _ => text.push_str("free: nothing stops the body along this direction\n"),
    }
    if let Some(bounds) = record.exit_bounds {
        let exit = interval_of_unit(bounds, "times the direction");
        push_line(&mut text, "exit", &format!("{exit}; after it they never meet"));
    }
    let ignored = record.outcome != Ending::Overlapping;
    let name = if ignored { "ignored" } else { "overlap" };
    push_start_overlaps(&mut text, &record.start_overlaps, name);
    if !ignored {
        push_line(&mut text, "", overlap_hint(&record.start_overlaps));
    }
    if !record.surfaces.is_empty() {
        let what = "open, blocks from both sides and with its boundary; its interior is unknown";
        push_line(&mut text, "surface", &format!("{}, {what}", record.surfaces.join(" and ")));
    }
    let source = match (is_default, tolerance == 0.0) {
        (true, _) => "from the files' precision and the poses; --tolerance sets another",
        (false, true) => "as given: the nominal bodies",
        (false, false) => "as given: each body is offset inwards by half of it",
    };
    push_line(&mut text, "tolerance", &format!("{} ({source})", length_up(tolerance)));
    push_min_gap(&mut text, record.min_gap);
    text
}

/// Returns the header of the columns of [`scan_line`].
pub(super) fn scan_header() -> String {
    join_columns("direction", ["outcome", "distance", "offset", "exit"].map(str::to_owned))
}

/// Returns the line of one direction of `--directions`.
pub(super) fn scan_line(line: &Line, direction: DVec3) -> String {
    let direction = vector(direction);
    let outcome = line.record.outcome().name().to_owned();
    let Record::SolidClearance(record) = &line.record else {
        let message = line.message.clone().unwrap_or_default();
        return join_columns(&direction, [outcome, message, String::new(), String::new()]);
    };
    let shrunk = record.offset_distance_bounds.map(|[lower, _]| lower);
    let exit = record.exit_bounds.map(|[_, upper]| upper);
    let or_none = |t: Option<f64>, text: fn(f64) -> String| t.map_or_else(|| "-".into(), text);
    let [distance, shrunk] = [record.distance, shrunk].map(|t| or_none(t, at_least));
    join_columns(&direction, [outcome, distance, shrunk, or_none(exit, at_most)])
}

/// Joins columns with fixed widths.
fn join_columns(direction: &str, others: [String; 4]) -> String {
    let [outcome, distance, shrunk, exit] = others;
    let text = format!("{direction:<24} {outcome:<11} {distance:<19} {shrunk:<19} {exit}");
    text.trim_end().to_owned() + "\n"
}

/// Appends the safe travel, the bounds, the features and the contact.
fn push_contact(text: &mut String, answer: &Answer, direction: DVec3) {
    let record = &answer.record;
    let error = answer.error / direction.length();
    if let (Some(value), Some(bounds), Some(distance), Some([shrunk, _])) = (
        record.translation,
        record.translation_bounds,
        record.distance,
        record.offset_distance_bounds,
    ) {
        let remark = if value.abs() <= error { " (the parts touch)" } else { "" };
        let travel = safe_travel(value.max(0.0), error, [distance, shrunk], direction);
        push_line(text, "distance", &format!("{travel}{remark}"));
        push_line(text, "bounds", &interval(bounds));
        if record.tolerance > Some(0.0) {
            let shrunk = at_least(shrunk);
            let offset = format!("{shrunk} times the direction, for the offset bodies");
            push_line(text, "offset", &offset);
        }
    }
    push_features(
        text,
        record.features.as_ref(),
        [record.moving.as_deref(), record.fixed.as_deref()],
    );
    if let (Some(normal), Some(place)) = (record.normal, record.point) {
        push_line(text, "normal", &unit_vector(normal.into()));
        push_line(text, "point", &point(place.into(), answer.error, answer.extent));
    }
}
