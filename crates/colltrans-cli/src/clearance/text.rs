//! The answer in words.

use colltrans::glam::DVec3;
use colltrans::record::{Ending, Record};

use crate::numbers::{known_vector, number, unit_vector};
use crate::record::Line;
use crate::report::{features, kept, line, overlaps, remedy, safely, times};
use crate::solid::Answer;

/// Below this many tolerances a body hardly moves: perhaps a fit is tighter than the tolerance.
const HARDLY: f64 = 4.0;

/// The readable answer of `colltrans clearance`.
pub(super) fn answer(answer: &Answer, direction: DVec3, is_default: bool) -> String {
    let mut text = String::new();
    let record = &answer.record;
    let tolerance = record.tolerance.unwrap_or_default();
    match record.outcome {
        Ending::Blocked => {
            text.push_str("blocked\n");
            blocked(&mut text, answer, direction);
            let hardly = HARDLY * tolerance;
            if is_default && record.distance.is_some_and(|t| t * direction.length() <= hardly) {
                let fit =
                    "if a fit is meant to slide here, give the chord errors of both as --tolerance";
                line(&mut text, "", fit);
            }
        }
        Ending::Overlapping => text.push_str("overlapping: the bodies overlap now\n"),
        _ => text.push_str("free: nothing stops it along this direction\n"),
    }
    if let Some([_, upper]) = record.exit_bounds {
        line(&mut text, "exit", &format!("{}; after it they never meet", times(upper)));
    }
    let ignored = record.outcome != Ending::Overlapping;
    let name = if ignored { "ignored" } else { "overlap" };
    overlaps(&mut text, &record.start_overlaps, name);
    if !ignored {
        line(&mut text, "", remedy(&record.start_overlaps));
    }
    if !record.surfaces.is_empty() {
        let what = "open, blocking from both sides, rims included; what is inside is not known";
        line(&mut text, "surface", &format!("{}, {what}", record.surfaces.join(" and ")));
    }
    let source = match (is_default, tolerance == 0.0) {
        (true, _) => "from the files' precision and the poses; --tolerance sets another",
        (false, true) => "as asked: the bodies are taken as they are",
        (false, false) => "as asked: both bodies are shrunk by half of it",
    };
    line(&mut text, "tolerance", &format!("{} ({source})", number(tolerance)));
    kept(&mut text, record.keep);
    text
}

/// The heads of the columns of [`scan_line`].
pub(super) fn scan_head() -> String {
    columns("direction", ["outcome", "distance", "shrunk", "exit"].map(str::to_owned))
}

/// The answer for one of many directions.
pub(super) fn scan_line(told: &Line, direction: DVec3) -> String {
    let direction = direction.to_array().map(number).join(",");
    let outcome = told.record.outcome().name().to_owned();
    let Record::SolidClearance(record) = &told.record else {
        let message = told.message.clone().unwrap_or_default();
        return columns(&direction, [outcome, message, String::new(), String::new()]);
    };
    let shrunk = record.shrunk_distance_bounds.map(|[lower, _]| lower);
    let exit = record.exit_bounds.map(|[_, upper]| upper);
    let or_none = |t: Option<f64>| t.map_or_else(|| "-".into(), number);
    let [distance, shrunk, exit] = [record.distance, shrunk, exit].map(or_none);
    columns(&direction, [outcome, distance, shrunk, exit])
}

fn columns(direction: &str, others: [String; 4]) -> String {
    let [outcome, distance, shrunk, exit] = others;
    let text = format!("{direction:<24} {outcome:<11} {distance:<19} {shrunk:<19} {exit}");
    text.trim_end().to_owned() + "\n"
}

fn blocked(text: &mut String, answer: &Answer, direction: DVec3) {
    let record = &answer.record;
    let error = answer.error / direction.length();
    if let (Some(value), Some([lower, upper]), Some(distance), Some([shrunk, _])) = (
        record.translation,
        record.translation_bounds,
        record.distance,
        record.shrunk_distance_bounds,
    ) {
        let remark = if value.abs() <= error { " (the parts touch)" } else { "" };
        let far = safely(value.max(0.0), error, [distance, shrunk], direction);
        line(text, "distance", &format!("{far}{remark}"));
        line(text, "bounds", &format!("{} to {}", number(lower), number(upper)));
        if record.tolerance > Some(0.0) {
            line(text, "shrunk", &format!("{}, for the shrunk bodies", times(shrunk)));
        }
    }
    features(text, record.features.as_ref(), [record.moving.as_deref(), record.fixed.as_deref()]);
    if let (Some(normal), Some(point)) = (record.normal, record.point) {
        line(text, "normal", &unit_vector(normal.into()));
        line(text, "point", &known_vector(point.into(), answer.error));
    }
}
