//! The answer in words.

use colltrans::Bounded;
use colltrans::glam::DVec3;

use crate::numbers::{decade, known_vector, number, unit_vector};
use crate::record::Record;
use crate::report::{feature, line, safely, times};
use crate::solid::{Answer, Kind, Overlap, Stop, Touch};
use crate::terminal::shown;

/// Below this many tolerances a body hardly moves: perhaps a fit is tighter than the tolerance.
const HARDLY: f64 = 4.0;

/// The readable answer of `colltrans clear`.
pub(super) fn answer(answer: &Answer<'_>, direction: DVec3, is_default: bool) -> String {
    let mut text = String::new();
    match &answer.kind {
        Kind::Free => text.push_str("free: nothing stops it along this direction\n"),
        Kind::Blocked(stop) => {
            text.push_str("blocked\n");
            blocked(&mut text, answer, stop, direction);
            if is_default && stop.distance * direction.length() <= HARDLY * answer.tolerance {
                let fit =
                    "if a fit is meant to slide here, give the chord errors of both as --tolerance";
                line(&mut text, "", fit);
            }
        }
        Kind::Overlapping => text.push_str("overlapping: the bodies overlap now\n"),
    }
    if let Some(exit) = answer.exit {
        let exit = times(exit.upper);
        line(&mut text, "exit", &format!("{exit}; after it they never meet"));
    }
    overlaps(&mut text, answer);
    let surfaces = answer.surface_names();
    if !surfaces.is_empty() {
        let what = "open, blocking from both sides, rims included; what is inside is not known";
        line(&mut text, "surface", &format!("{}, {what}", surfaces.join(" and ")));
    }
    let source = match (is_default, answer.tolerance == 0.0) {
        (true, _) => "from the files' precision and the poses; --tolerance sets another",
        (false, true) => "as asked: the bodies are taken as they are",
        (false, false) => "as asked: both bodies are shrunk by half of it",
    };
    line(&mut text, "tolerance", &format!("{} ({source})", number(answer.tolerance)));
    text
}

/// The heads of the columns of [`scan_line`].
pub(super) fn scan_head() -> String {
    columns("direction", ["outcome", "distance", "shrunk", "exit"].map(str::to_owned))
}

/// The answer for one of many directions.
pub(super) fn scan_line(record: &Record) -> String {
    let vector = |v: [f64; 3]| v.map(number).join(",");
    let direction = record.direction.map_or_else(String::new, vector);
    if let Some(message) = &record.message {
        return columns(
            &direction,
            [record.outcome.text().into(), message.clone(), String::new(), String::new()],
        );
    }
    let shrunk = record.shrunk_distance.map(|shrunk| shrunk.lower);
    let exit = record.exit.map(|exit| exit.upper);
    let or_none = |t: Option<f64>| t.map_or_else(|| "-".into(), number);
    let [distance, shrunk, exit] = [record.distance, shrunk, exit].map(or_none);
    columns(&direction, [record.outcome.text().into(), distance, shrunk, exit])
}

fn columns(direction: &str, others: [String; 4]) -> String {
    let [outcome, distance, shrunk, exit] = others;
    let text = format!("{direction:<24} {outcome:<11} {distance:<19} {shrunk:<19} {exit}");
    text.trim_end().to_owned() + "\n"
}

fn blocked(text: &mut String, answer: &Answer<'_>, stop: &Stop<'_>, direction: DVec3) {
    let error = answer.error / direction.length();
    let Bounded { value, lower, upper } = stop.translation;
    let remark = if value.abs() <= error { " (the parts touch)" } else { "" };
    let far = safely(value.max(0.0), error, [stop.distance, stop.shrunk.lower], direction);
    line(text, "distance", &format!("{far}{remark}"));
    line(text, "bounds", &format!("{} to {}", number(lower), number(upper)));
    if answer.tolerance > 0.0 {
        line(text, "shrunk", &format!("{}, for the shrunk bodies", times(stop.shrunk.lower)));
    }
    line(text, "moving", &touched(&stop.moving));
    line(text, "fixed", &touched(&stop.fixed));
    line(text, "normal", &unit_vector(stop.normal));
    line(text, "point", &known_vector(stop.point, answer.error));
}

fn touched(touch: &Touch<'_>) -> String {
    format!("{} of {}", feature(&touch.feature), shown(touch.file.display()))
}

fn overlaps(text: &mut String, answer: &Answer<'_>) {
    let ignored = !matches!(answer.kind, Kind::Overlapping);
    for Overlap { moving, fixed, depth } in &answer.overlaps {
        let (moving, fixed) = (shown(moving.display()), shown(fixed.display()));
        let depth = match depth {
            Some(depth) => format!("a tolerance of {} would part them", above(*depth)),
            None => "no tolerance would part them".into(),
        };
        let name = if ignored { "ignored" } else { "overlap" };
        line(text, name, &format!("{moving} in {fixed}: {depth}"));
    }
    if !ignored {
        let hint = if answer.overlaps.iter().all(|overlap| overlap.depth.is_some()) {
            "--tolerance allows for it, --ignore-start-overlaps lets it pass"
        } else {
            "--ignore-start-overlaps lets it pass"
        };
        line(text, "", hint);
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
