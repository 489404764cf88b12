//! Answers of `distance`, `depth` and `within` as text.

use colltrans::record::{DepthRecord, DistanceRecord, Ending, PairQuestion, Record};

use crate::numbers::{
    at_least, at_most, estimate, interval, length_down, length_up, point, unit_vector,
};
use crate::record::Line;
use crate::report::{push_features, push_hulls, push_line, push_start_overlaps};

/// Accuracy of the numbers of an answer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Accuracy {
    /// Error of lengths.
    pub(crate) error: f64,
    /// Extent of the smaller body, by which points are rounded.
    pub(crate) extent: f64,
}

/// Returns the answer.
pub(super) fn answer_text(question: PairQuestion, line: &Line, accuracy: Accuracy) -> String {
    let mut text = match &line.record {
        Record::Distance(record) => distance_text(question, record, accuracy),
        Record::Depth(record) => depth_text(record, accuracy.error),
        other => format!("{}\n", other.outcome()),
    };
    push_hulls(&mut text, line.hull, line.record.outcome(), question == PairQuestion::Depth);
    text
}

/// Returns the answer of a distance, or of its comparison with a length.
pub(crate) fn distance_text(
    question: PairQuestion,
    record: &DistanceRecord,
    accuracy: Accuracy,
) -> String {
    let mut text = format!("{}\n", headline(question, record.outcome));
    push_bounds(&mut text, "distance", [record.lower, record.upper], accuracy.error);
    if let Some(normal) = record.normal {
        push_line(&mut text, "normal", &unit_vector(normal.into()));
    }
    push_nearest_points(&mut text, record, accuracy);
    push_open_surfaces(&mut text, &record.surfaces);
    text
}

/// Returns the answer of a depth.
fn depth_text(record: &DepthRecord, error: f64) -> String {
    let headline = match record.outcome {
        Ending::Apart => "apart: the bodies have no common point",
        Ending::Touching => "touching: the bodies overlap by no more than rounding resolves",
        Ending::Overlapping => "overlapping: the bodies overlap now",
        outcome => outcome.name(),
    };
    let mut text = format!("{headline}\n");
    push_bounds(&mut text, "depth", [record.lower, record.upper], error);
    if let Some(direction) = record.direction {
        let direction = unit_vector(direction.into());
        push_line(&mut text, "direction", &format!("{direction}, for the moving body"));
    }
    if let Some(translation) = record.separating_translation {
        let translation = point(translation.into(), error, record.upper.unwrap_or_default());
        push_line(
            &mut text,
            "translation",
            &format!("{translation} of the moving body separates them"),
        );
    }
    push_start_overlaps(&mut text, &record.start_overlaps, "overlap");
    push_open_surfaces(&mut text, &record.surfaces);
    text
}

/// Returns the first line of the answer.
fn headline(question: PairQuestion, outcome: Ending) -> String {
    let within = |what: &str, text_of: fn(f64) -> String| match question {
        PairQuestion::Within(length) => format!("{outcome}: {what} {}", text_of(length)),
        _ => outcome.to_string(),
    };
    match outcome {
        Ending::Meeting => "meeting: the bodies touch or overlap; `depth` computes how deep".into(),
        Ending::Closer => within("the bodies are no farther apart than", length_up),
        Ending::Farther => within("the bodies are farther apart than", length_down),
        Ending::Undecided => within("between the bounds of the distance is", length_down),
        outcome => outcome.to_string(),
    }
}

/// Appends a number and its proven bounds.
fn push_bounds(text: &mut String, name: &str, [lower, upper]: [Option<f64>; 2], error: f64) {
    let positive = |bound: &f64| *bound > 0.0;
    match (lower, upper.filter(positive)) {
        (Some(lower), Some(upper)) => {
            if lower > 0.0 {
                let value = lower + 0.5 * (upper - lower);
                push_line(text, name, &estimate(value, error.max(upper - lower)));
            }
            push_line(text, "bounds", &interval([lower, upper]));
        }
        (None, Some(upper)) => push_line(text, "at most", &at_most(upper)),
        (lower, None) => {
            if let Some(lower) = lower.filter(positive) {
                push_line(text, "at least", &at_least(lower));
            }
        }
    }
}

/// Appends the nearest points and their features.
fn push_nearest_points(text: &mut String, record: &DistanceRecord, accuracy: Accuracy) {
    let Accuracy { error, extent } = accuracy;
    let point = |p: [f64; 3]| point(p.into(), error, extent);
    match record.points {
        Some([moving, _]) if record.outcome == Ending::Meeting => {
            push_line(text, "point", &point(moving));
        }
        Some([moving, fixed]) => {
            push_line(text, "from", &format!("{} of the moving body", point(moving)));
            push_line(text, "to", &format!("{} of the fixed body", point(fixed)));
        }
        None => {}
    }
    let names = [record.moving.as_deref(), record.fixed.as_deref()];
    push_features(text, record.features.as_ref(), names);
}

/// Appends the names of open surfaces.
fn push_open_surfaces(text: &mut String, surfaces: &[&str]) {
    if !surfaces.is_empty() {
        let open = surfaces.join(" and ");
        push_line(text, "surface", &format!("{open}: open, its interior is unknown"));
    }
}
