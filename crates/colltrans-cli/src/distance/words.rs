//! The answer in words.

use colltrans::record::{Ending, PairQuestion, Record};

use crate::clearance;
use crate::numbers::{known, known_vector, number, unit_vector};
use crate::record::Line;
use crate::report::{features, hulls, line};

/// The readable answer; lengths may be off by what the files' precision leaves.
pub(crate) fn answer(question: PairQuestion, told: &Line, error: f64) -> String {
    let record = &told.record;
    let mut text = format!("{}\n", headline(question, record));
    if let (Some(lower), Some(upper)) = (record.lower, record.upper)
        && upper > 0.0
    {
        let name = if question == PairQuestion::Depth { "depth" } else { "distance" };
        if lower > 0.0 {
            let value = lower + 0.5 * (upper - lower);
            line(&mut text, name, &known(value, error.max(upper - lower)));
        }
        line(&mut text, "bounds", &format!("{} to {}", number(lower), number(upper)));
    } else if let Some(upper) = record.upper.filter(|upper| *upper > 0.0) {
        line(&mut text, "at most", &number(upper));
    } else if let Some(lower) = record.lower.filter(|lower| *lower > 0.0) {
        line(&mut text, "at least", &number(lower));
    }
    if let Some(direction) = record.direction {
        line(
            &mut text,
            "direction",
            &format!("{}, of the moving body", unit_vector(direction.into())),
        );
    }
    if let Some(normal) = record.normal {
        line(&mut text, "normal", &unit_vector(normal.into()));
    }
    places(&mut text, record, error);
    clearance::overlaps(&mut text, record, "overlap");
    if !record.surfaces.is_empty() {
        let open = record.surfaces.join(" and ");
        line(&mut text, "surface", &format!("{open}: open, what is inside is not known"));
    }
    hulls(&mut text, told);
    text
}

fn headline(question: PairQuestion, record: &Record) -> String {
    let within = |what: &str| match question {
        PairQuestion::Within(length) => format!("{}: {what} {}", record.outcome, number(length)),
        _ => record.outcome.to_string(),
    };
    match record.outcome {
        Ending::Apart if question == PairQuestion::Depth => {
            "apart: the bodies have no point in common".into()
        }
        Ending::Touching => "touching: the bodies overlap by no more than rounding can tell".into(),
        Ending::Meeting => "meeting: the bodies touch or overlap; `depth` says how deep".into(),
        Ending::Overlapping => "overlapping: the bodies overlap now".into(),
        Ending::Closer => within("the bodies are no farther apart than"),
        Ending::Farther => within("the bodies are farther apart than"),
        Ending::Undecided => within("between the bounds of the distance lies"),
        outcome => outcome.to_string(),
    }
}

/// Where the bodies are nearest.
fn places(text: &mut String, record: &Record, error: f64) {
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
    features(text, record, [record.moving.as_deref(), record.fixed.as_deref()]);
}
