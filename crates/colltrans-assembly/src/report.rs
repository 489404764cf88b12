//! Reports for people: one HTML file ([`html`]) and an animation ([`glb`]), and all findings as JSON
//! ([`facts`]). Of an audit: an HTML file ([`clashes`]), and issues for programs of the building industry ([`bcf`]).
//!
//! - `bill`: the bill of materials, also as CSV ([`bill_csv`]).
//! - `cover`: the first page, with an `exploded` view. `sheet`: a page for each step. `after`: the sections
//!   after the steps.
//! - `tables`: folded tables with blocking graphs ([`graph`]). `viewer`: an interactive view.
//! - `words`: lengths, directions and names as text. `kinds`: parts of equal shape.
//! - `scene`: pictures, with the `lines` of each part. `cut`: a plane through the place where two parts meet.

mod after;
#[cfg(feature = "bcf")]
pub mod bcf;
mod bill;
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

pub use bill::bill_csv;
pub use colltrans_picture::escape_xml;
use glam::DVec3;
use maud::PreEscaped;

pub(crate) use crate::digits::{rounded_number, short_number};
use crate::findings::Analysis;
use crate::plan::Step;
use scene::Studio;
use words::Words;

/// Order in which a document shows the steps of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    /// The order of the plan, which takes the assembly apart.
    Disassembly,
    /// The reverse order with reversed moves, which puts it together.
    Assembly,
}

/// Data that all pages share.
struct Report<'a> {
    pub f: &'a Analysis<'a>,
    pub order: Order,
    pub words: Words<'a>,
    pub studio: Studio<'a>,
    /// For each step, the estimated handling time in seconds.
    pub seconds: Vec<f64>,
    /// For each step, the index of its round in the order of the document.
    pub rounds: Vec<usize>,
    /// For each step, the steps that are needed before it in the order of the document.
    pub needs: Vec<Vec<usize>>,
    /// Length of the diagonal of the box of all parts.
    pub diagonal: f64,
}

impl<'a> Report<'a> {
    /// Prepares the data of a report.
    fn new(f: &'a Analysis<'a>, order: Order) -> Self {
        let (rounds, needs) = match order {
            Order::Disassembly => removal_rounds(f),
            Order::Assembly => insertion_rounds(f),
        };
        let bounds = f.bodies.assembly().bounds();
        let diagonal = DVec3::length(bounds.high - bounds.low);
        let (words, studio, seconds) =
            (Words::new(f), Studio::new(f), f.times.step_seconds(&f.plan));
        Self { f, order, words, studio, seconds, rounds, needs, diagonal }
    }

    /// Checks whether the document shows how the assembly is put together.
    fn is_assembly(&self) -> bool {
        self.order == Order::Assembly
    }

    /// Returns the sign of directions in the order of the document.
    fn sign(&self) -> f64 {
        if self.is_assembly() { -1.0 } else { 1.0 }
    }

    /// Returns the position of a step of the plan in the order of the document, from 0 on.
    fn position(&self, step: usize) -> usize {
        if self.is_assembly() { self.f.plan.steps.len() - 1 - step } else { step }
    }

    /// Formats steps of the plan as their numbers in the document: "1–4, 6".
    fn step_numbers(&self, steps: &[usize]) -> String {
        let positions: Vec<usize> = steps.iter().map(|&step| self.position(step)).collect();
        words::number_runs(&positions)
    }

    /// Returns "step 3" or "steps 1–4, 6".
    fn step_list(&self, steps: &[usize]) -> String {
        let one = steps.iter().all(|step| *step == steps[0]);
        format!("{} {}", if one { "step" } else { "steps" }, self.step_numbers(steps))
    }
}

/// Returns the round and the required earlier steps of each step, if the steps take the assembly apart.
fn removal_rounds(f: &Analysis) -> (Vec<usize>, Vec<Vec<usize>>) {
    let mut rounds = vec![0; f.plan.steps.len()];
    for (round, steps) in f.plan.parallel_rounds().iter().enumerate() {
        for &step in steps {
            rounds[step] = round;
        }
    }
    (rounds, f.plan.steps.iter().map(|step| step.predecessors.clone()).collect())
}

/// Returns the round and the required earlier steps of each step, if the steps in reverse order put the assembly
/// together. A group is complete before it is put in.
fn insertion_rounds(f: &Analysis) -> (Vec<usize>, Vec<Vec<usize>>) {
    let steps = &f.plan.steps;
    let (mut rounds, mut needs) = (vec![0; steps.len()], vec![Vec::new(); steps.len()]);
    for (later, step) in steps.iter().enumerate() {
        let freed = step.predecessors.iter().copied().chain(step.group_step);
        freed.for_each(|earlier| needs[earlier].push(later));
    }
    for step in (0..steps.len()).rev() {
        needs[step].sort_unstable();
        needs[step].dedup();
        rounds[step] = needs[step].iter().map(|&k: &usize| rounds[k] + 1).max().unwrap_or(0);
    }
    (rounds, needs)
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
