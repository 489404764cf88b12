//! The answer in words.

use colltrans::record::{DepthRecord, DistanceRecord, Ending, PairQuestion, Record};

use crate::numbers::{known, known_vector, number, unit_vector};
use crate::record::Line;
use crate::report::{features, hulls, line, overlaps};

/// The readable answer; lengths may be off by what the files' precision leaves.
pub(crate) fn answer(question: PairQuestion, told: &Line, error: f64) -> String {
    let mut text = match &told.record {
        Record::Distance(record) => distance(question, record, error),
        Record::Depth(record) => depth(record, error),
        other => format!("{}\n", other.outcome()),
    };
    hulls(&mut text, told.hull, told.record.outcome(), question == PairQuestion::Depth);
    text
}

/// How far bodies are apart, or whether they are closer than a length.
pub(crate) fn distance(question: PairQuestion, record: &DistanceRecord, error: f64) -> String {
    let mut text = format!("{}\n", headline(question, record.outcome));
    bounds(&mut text, "distance", [record.lower, record.upper], error);
    if let Some(normal) = record.normal {
        line(&mut text, "normal", &unit_vector(normal.into()));
    }
    places(&mut text, record, error);
    surfaces(&mut text, &record.surfaces);
    text
}

fn depth(record: &DepthRecord, error: f64) -> String {
    let headline = match record.outcome {
        Ending::Apart => "apart: the bodies have no point in common",
        Ending::Touching => "touching: the bodies overlap by no more than rounding can tell",
        Ending::Overlapping => "overlapping: the bodies overlap now",
        outcome => outcome.name(),
    };
    let mut text = format!("{headline}\n");
    bounds(&mut text, "depth", [record.lower, record.upper], error);
    if let Some(direction) = record.direction {
        let direction = unit_vector(direction.into());
        line(&mut text, "direction", &format!("{direction}, of the moving body"));
    }
    overlaps(&mut text, &record.start_overlaps, "overlap");
    surfaces(&mut text, &record.surfaces);
    text
}

fn headline(question: PairQuestion, outcome: Ending) -> String {
    let within = |what: &str| match question {
        PairQuestion::Within(length) => format!("{outcome}: {what} {}", number(length)),
        _ => outcome.to_string(),
    };
    match outcome {
        Ending::Meeting => "meeting: the bodies touch or overlap; `depth` says how deep".into(),
        Ending::Closer => within("the bodies are no farther apart than"),
        Ending::Farther => within("the bodies are farther apart than"),
        Ending::Undecided => within("between the bounds of the distance lies"),
        outcome => outcome.to_string(),
    }
}

fn bounds(text: &mut String, name: &str, [lower, upper]: [Option<f64>; 2], error: f64) {
    let positive = |bound: &f64| *bound > 0.0;
    match (lower, upper.filter(positive)) {
        (Some(lower), Some(upper)) => {
            if lower > 0.0 {
                let value = lower + 0.5 * (upper - lower);
                line(text, name, &known(value, error.max(upper - lower)));
            }
            line(text, "bounds", &format!("{} to {}", number(lower), number(upper)));
        }
        (None, Some(upper)) => line(text, "at most", &number(upper)),
        (lower, None) => {
            if let Some(lower) = lower.filter(positive) {
                line(text, "at least", &number(lower));
            }
        }
    }
}

/// Where the bodies are nearest.
fn places(text: &mut String, record: &DistanceRecord, error: f64) {
    let rounding = record.points.map_or(0.0, |points| {
        1e-14 * points.as_flattened().iter().fold(0.0_f64, |most, c| most.max(c.abs()))
    });
    let place = |p: [f64; 3]| known_vector(p.into(), error.max(rounding));
    match record.points {
        Some([moving, _]) if record.outcome == Ending::Meeting => {
            line(text, "point", &place(moving));
        }
        Some([moving, fixed]) => {
            line(text, "from", &format!("{} of the moving body", place(moving)));
            line(text, "to", &format!("{} of the fixed body", place(fixed)));
        }
        None => {}
    }
    let names = [record.moving.as_deref(), record.fixed.as_deref()];
    features(text, record.features.as_ref(), names);
}

fn surfaces(text: &mut String, surfaces: &[&str]) {
    if !surfaces.is_empty() {
        let open = surfaces.join(" and ");
        line(text, "surface", &format!("{open}: open, what is inside is not known"));
    }
}
