//! Reports for people: one HTML file ([`html`]) and an animation ([`glb`]), and all findings as JSON
//! ([`facts`]). Of an audit: an HTML file ([`clashes`]), and issues for programs of the building industry ([`bcf`]).
//!
//! - `cover`: the first page, with an `exploded` view. `sheet`: a page for each step. `after`: the sections
//!   after the steps.
//! - `tables`: folded tables with blocking graphs ([`graph`]). `viewer`: an interactive view.
//! - `words`: lengths, directions and names as text. `kinds`: parts of equal shape.
//! - `scene`: pictures, with the `lines` of each part. `cut`: a plane through the place where two parts meet.

mod after;
#[cfg(feature = "bcf")]
pub mod bcf;
pub mod clashes;
mod cover;
mod cut;
mod exploded;
pub mod facts;
pub mod glb;
pub mod graph;
pub mod html;
mod kinds;
mod lines;
mod scene;
mod sheet;
mod tables;
mod viewer;
mod words;

pub use colltrans_picture::escape_xml;
use glam::DVec3;
use maud::PreEscaped;

pub(crate) use crate::digits::{rounded_number, short_number};
use crate::findings::Analysis;
use crate::plan::Step;
use scene::Studio;
use words::Words;

/// Data that all pages share.
struct Report<'a> {
    pub f: &'a Analysis<'a>,
    pub words: Words<'a>,
    pub studio: Studio<'a>,
    /// For each step, the estimated handling time in seconds.
    pub seconds: Vec<f64>,
    /// For each step, the index of its round.
    pub rounds: Vec<usize>,
    /// Length of the diagonal of the box of all parts.
    pub diagonal: f64,
}

impl<'a> Report<'a> {
    /// Prepares the data of a report.
    fn new(f: &'a Analysis<'a>) -> Self {
        let mut rounds = vec![0; f.plan.steps.len()];
        for (round, steps) in f.plan.parallel_rounds().iter().enumerate() {
            for &step in steps {
                rounds[step] = round;
            }
        }
        let bounds = f.bodies.assembly().bounds();
        let diagonal = DVec3::length(bounds.high - bounds.low);
        let (words, studio, seconds) =
            (Words::new(f), Studio::new(f), f.times.step_seconds(&f.plan));
        Self { f, words, studio, seconds, rounds, diagonal }
    }
}

/// Marks an SVG picture that this crate drew as safe HTML. Its texts are escaped already.
fn picture_markup(svg: String) -> PreEscaped<String> {
    PreEscaped(svg)
}

/// Formats a direction: an axis by its signed name, other directions by their components.
pub(crate) fn direction_name(d: glam::DVec3) -> String {
    let names = [(glam::DVec3::X, "x"), (glam::DVec3::Y, "y"), (glam::DVec3::Z, "z")];
    for (axis, name) in names {
        if d == axis {
            return format!("+{name}");
        }
        if d == -axis {
            return format!("−{name}");
        }
    }
    // Small components become positive zeros.
    let [x, y, z] = d.to_array().map(|c| if c.abs() < 0.000_5 { 0.0 } else { c });
    format!("({x:.3}, {y:.3}, {z:.3})")
}

/// Iterates over the parts that are present when a step begins: of the assembly, or of the group that the
/// step takes apart.
fn present_parts<'a>(f: &'a Analysis, step: usize) -> impl Iterator<Item = usize> + use<'a> {
    let (steps, mut is_present) = (&f.plan.steps, vec![true; f.bodies.len()]);
    let within = steps[step].group_step;
    if let Some(group) = within {
        is_present = f.bodies.part_mask(&steps[group].parts);
    }
    for before in steps[..step].iter().filter(|before| before.group_step == within) {
        before.parts.iter().for_each(|&part| is_present[part] = false);
    }
    (0..is_present.len()).filter(move |&part| is_present[part])
}

/// Returns the displacement of a part by all moves of a step but the last one.
fn displacement_before_last_move(step: &Step, part: usize) -> DVec3 {
    let before = &step.path[..step.path.len() - 1];
    let own = before.iter().filter(|leg| leg.parts.contains(&part));
    own.map(|leg| leg.direction * leg.travel).sum()
}

/// Formats an sRGB colour for HTML.
fn html_colour(colour: [f64; 3]) -> String {
    let [r, g, b] = colour.map(|c| (c.clamp(0.0, 1.0) * 255.0) as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Returns the colour of a kind of parts. Hues are spread by the golden angle.
fn kind_colour(kind: usize) -> [f64; 3] {
    let hue = (kind as f64 * 0.381_966_011_250_105 + 0.58) % 1.0;
    let channel = |shift: f64| {
        let h = (hue + shift).fract() * 6.0;
        let ramp = ((h - 3.0).abs() - 1.0).clamp(0.0, 1.0);
        0.40 + 0.48 * ramp
    };
    [channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_axes_are_formatted_for_people() {
        let cases =
            [(0.0, "0"), (27.0, "27"), (0.0617, "0.0617"), (1234.56, "1235"), (1e-9, "1.00e-9")];
        for (x, text) in cases {
            assert_eq!(short_number(x), text);
        }
        assert_eq!(direction_name(glam::DVec3::NEG_Y), "−y");
    }
}
