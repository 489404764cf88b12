//! An answer in words.

use std::fmt::Write as _;

use colltrans::glam::DVec3;
use colltrans::{Contact, ContactRange, Steps};

use crate::record::{FeatureRecord, Record, solver_name};

/// Vertices of a feature that are listed.
const LISTED: usize = 12;

/// The readable answer of `colltrans cast`.
pub(crate) fn text(answer: &ContactRange, record: &Record, direction: DVec3) -> String {
    let mut text = String::new();
    match answer {
        ContactRange::Contact { enter, exit } => {
            text.push_str("contact\n");
            contact(&mut text, enter, exit, record, direction);
        }
        ContactRange::Grazing { enter, exit } => {
            text.push_str("grazing: the bodies slide along each other\n");
            line(&mut text, "overlap", &format!("{:e} sideways", enter.overlap));
            line(&mut text, "along", &vector(enter.separating_direction));
            text.push_str("  the contact, if the overlap is taken for real:\n");
            contact(&mut text, &enter.contact, &exit.contact, record, direction);
        }
        ContactRange::Separated(separated) => {
            text.push_str("separated: the bodies never meet along this direction\n");
            line(&mut text, "margin", &separated.certificate.margin.to_string());
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

fn contact(text: &mut String, enter: &Contact, exit: &Contact, record: &Record, direction: DVec3) {
    let length = direction.length();
    let along = |t: f64| format!("{t} times the direction, a length of {}", t * length);
    let remark = if enter.translation > 0.0 {
        ""
    } else if exit.translation < 0.0 {
        " (the contact lies behind)"
    } else if enter.translation == 0.0 {
        " (the bodies touch)"
    } else {
        " (the bodies overlap)"
    };
    line(text, "translation", &format!("{}{remark}", along(enter.translation)));
    line(text, "exit", &along(exit.translation));
    line(text, "normal", &vector(enter.normal));
    line(text, "point", &vector(enter.point_on_fixed));
    if let Some(features) = &record.features {
        line(text, "moving", &feature(&features.moving));
        line(text, "fixed", &feature(&features.fixed));
    }
    let proof = &enter.certificate;
    line(
        text,
        "bounds",
        &format!(
            "{} to {}, gap {:e} (rounding alone: up to {:e})",
            proof.lower,
            proof.upper,
            proof.upper - proof.lower,
            proof.tolerance
        ),
    );
    line(text, "solver", &work(solver_name(enter.solver), enter.steps));
}

pub(crate) fn line(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "  {name:<12} {value}");
}

pub(crate) fn vector(v: DVec3) -> String {
    format!("{},{},{}", v.x, v.y, v.z)
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
    let Steps { planar_problems, supports, pivots } = steps;
    format!("{solver}: {planar_problems} planar problems, {supports} supports, {pivots} pivots")
}
