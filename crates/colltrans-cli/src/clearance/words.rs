//! The answer in words.

use colltrans::glam::DVec3;
use colltrans::record::{Ending, Record, StartOverlapRecord};

use crate::numbers::{decade, known_vector, number, unit_vector};
use crate::record::Line;
use crate::report::{features, kept, line, safely, times};
use crate::solid::Answer;
use crate::terminal::shown;

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

/// Returns which flags let bodies move that overlap at the start.
pub(crate) fn remedy(overlaps: &[StartOverlapRecord]) -> &'static str {
    if overlaps.iter().all(|overlap| overlap.least_tolerance.is_some()) {
        "--tolerance allows for it, --ignore-start-overlaps lets it pass"
    } else {
        "--ignore-start-overlaps lets it pass"
    }
}

/// What overlaps what, a line each.
pub(crate) fn overlaps(text: &mut String, overlaps: &[StartOverlapRecord], name: &str) {
    for StartOverlapRecord { moving, fixed, least_tolerance } in overlaps {
        let [moving, fixed] =
            [moving, fixed].map(|name| shown(name.as_deref().unwrap_or_default()));
        let remedy = match least_tolerance {
            Some(least) => format!("a tolerance of {} would part them", above(*least)),
            None => "no tolerance would part them".into(),
        };
        line(text, name, &format!("{moving} in {fixed}: {remedy}"));
    }
}

/// A few digits, and no less than the value.
fn above(value: f64) -> String {
    let short: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    let step: f64 = format!("1e{}", decade(value) - 3).parse().unwrap_or(0.0);
    let rounded = if short >= value { short } else { short + step };
    let shown: f64 = format!("{rounded:.3e}").parse().unwrap_or(rounded);
    number(if shown >= value { shown } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_suggested_tolerance_suffices() {
        for value in [0.1, 0.12345, 0.999_96, 7.0, 1e-7 / 3.0, 2.0 / 3.0, 123_456.7] {
            let shown: f64 = above(value).parse().unwrap();
            assert!(shown >= value && shown <= value * 1.002, "{value} as {shown}");
        }
        assert_eq!(above(0.25), "0.25");
    }
}
