//! An answer in words.

use std::fmt::Write as _;

use colltrans::glam::DVec3;
use colltrans::{Contact, ContactRange, Steps};

use crate::record::{FeatureRecord, Record, exit_of, solver_name};

/// Vertices of a feature that are listed.
const LISTED: usize = 12;

/// The readable answer of `colltrans cast`.
pub(crate) fn text(answer: &ContactRange, record: &Record, direction: DVec3) -> String {
    let mut text = String::new();
    match answer {
        ContactRange::Contact { first, last } => {
            text.push_str("contact\n");
            contact(&mut text, first, last, record, direction);
        }
        ContactRange::Grazing { first, last } => {
            text.push_str("grazing: the bodies slide along each other\n");
            line(&mut text, "overlap", &format!("{:e} sideways", first.overlap));
            line(&mut text, "along", &vector(first.separating_direction));
            text.push_str("  the contact, if the overlap is taken for real:\n");
            contact(&mut text, &first.contact, &last.contact, record, direction);
        }
        ContactRange::Separated(separated) => {
            text.push_str("separated: the bodies never meet along this direction\n");
            line(&mut text, "margin", &number(separated.certificate.margin));
            line(
                &mut text,
                "normal",
                &format!("{} of the separating plane", vector(separated.certificate.normal)),
            );
            line(&mut text, "solver", &work(solver_name(separated.solver), separated.steps));
        }
    }
    text
}

fn contact(text: &mut String, first: &Contact, last: &Contact, record: &Record, direction: DVec3) {
    let length = direction.length();
    let exit = exit_of(last);
    let along =
        |t: f64| format!("{} times the direction, a length of {}", number(t), number(t * length));
    let remark = if first.translation > 0.0 {
        ""
    } else if exit < 0.0 {
        " (the contact lies behind)"
    } else if first.translation == 0.0 {
        " (the bodies touch)"
    } else {
        " (the bodies overlap)"
    };
    line(text, "translation", &format!("{}{remark}", along(first.translation)));
    line(text, "exit", &along(exit));
    line(text, "normal", &vector(first.normal));
    line(text, "point", &vector(first.point_on_fixed));
    if let Some(features) = &record.features {
        line(text, "moving", &feature(&features.moving));
        line(text, "fixed", &feature(&features.fixed));
    }
    let proof = &first.certificate;
    line(
        text,
        "bounds",
        &format!(
            "{} to {}, gap {:e} (rounding alone: up to {:e})",
            number(proof.lower),
            number(proof.upper),
            proof.upper - proof.lower,
            proof.tolerance
        ),
    );
    line(text, "solver", &work(solver_name(first.solver), first.steps));
}

pub(crate) fn line(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "  {name:<12} {value}");
}

/// All digits, with an exponent where there would be many zeros.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || (1e-4..1e15).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

pub(crate) fn vector(v: DVec3) -> String {
    v.to_array().map(number).join(",")
}

fn feature(feature: &FeatureRecord) -> String {
    let count = feature.vertices.len();
    let mut text = format!("{} {}", feature.kind, if count == 1 { "" } else { "of vertices" });
    let text_trimmed = text.trim_end().len();
    text.truncate(text_trimmed);
    for vertex in feature.vertices.iter().take(LISTED) {
        let _ = write!(text, " {vertex}");
    }
    if count > LISTED {
        let _ = write!(text, " ... ({count} in all)");
    }
    text
}

fn work(solver: &str, steps: Steps) -> String {
    // One-off queries start from scratch.
    let Steps { planar_problems, supports, pivots, iterations: _, started_from: _ } = steps;
    format!("{solver}: {planar_problems} planar problems, {supports} supports, {pivots} pivots")
}
