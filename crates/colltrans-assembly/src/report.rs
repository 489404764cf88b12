//! What people read: one HTML file ([`html`]), and an animation ([`glb`]). The same facts as JSON: [`facts`].
//!
//! The file has a first page (`cover`, with an `exploded` view), a page for each step (`sheet`), what follows them (`after`),
//! `tables` with blocking graphs ([`graph`]), and a `viewer`. `words` says lengths and ways, `kinds` which parts are
//! alike, `scene` draws with the `lines` of each part.

mod after;
mod cover;
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

pub use colltrans_picture::escaped;
use glam::DVec3;
use maud::PreEscaped;

pub(crate) use crate::digits::{digits, short};
use crate::findings::Findings;
use crate::plan::Step;
use scene::Studio;
use words::Words;

/// What all pages are made of.
struct Report<'a> {
    pub f: &'a Findings<'a>,
    pub words: Words<'a>,
    pub studio: Studio<'a>,
    /// Of each step.
    pub seconds: Vec<f64>,
    /// The number of each step's round.
    pub rounds: Vec<usize>,
    /// The length of the diagonal of the box around all parts.
    pub diagonal: f64,
}

impl<'a> Report<'a> {
    fn new(f: &'a Findings<'a>) -> Self {
        let mut rounds = vec![0; f.plan.steps.len()];
        for (round, steps) in f.plan.rounds().iter().enumerate() {
            for &step in steps {
                rounds[step] = round;
            }
        }
        let bounds = f.bodies.assembly().bounds();
        let diagonal = DVec3::length(bounds.high - bounds.low);
        let (words, studio, seconds) = (Words::new(f), Studio::new(f), f.times.of(&f.plan));
        Self { f, words, studio, seconds, rounds, diagonal }
    }
}

/// A picture that was drawn here, whose texts are escaped.
fn picture(svg: String) -> PreEscaped<String> {
    PreEscaped(svg)
}

/// A direction, for people: an axis by name.
pub(crate) fn arrow(d: glam::DVec3) -> String {
    let names = [(glam::DVec3::X, "x"), (glam::DVec3::Y, "y"), (glam::DVec3::Z, "z")];
    for (axis, name) in names {
        if d == axis {
            return format!("+{name}");
        }
        if d == -axis {
            return format!("−{name}");
        }
    }
    // No zero is negative.
    let [x, y, z] = d.to_array().map(|c| if c.abs() < 0.000_5 { 0.0 } else { c });
    format!("({x:.3}, {y:.3}, {z:.3})")
}

/// The parts that are there when a step begins: of all, or of the group that it takes apart.
fn there<'a>(f: &'a Findings, step: usize) -> impl Iterator<Item = usize> + use<'a> {
    let (steps, mut is_there) = (&f.plan.steps, vec![true; f.bodies.len()]);
    let within = steps[step].within;
    if let Some(group) = within {
        is_there = f.bodies.mask(&steps[group].parts);
    }
    for before in steps[..step].iter().filter(|before| before.within == within) {
        before.parts.iter().for_each(|&part| is_there[part] = false);
    }
    (0..is_there.len()).filter(move |&part| is_there[part])
}

/// By how much a part has been moved before the last move of a step.
fn aside(step: &Step, part: usize) -> DVec3 {
    let before = &step.path[..step.path.len() - 1];
    let own = before.iter().filter(|leg| leg.parts.contains(&part));
    own.map(|leg| leg.direction * leg.travel).sum()
}

/// A colour as HTML writes it.
fn hexadecimal(colour: [f64; 3]) -> String {
    let [r, g, b] = colour.map(|c| (c.clamp(0.0, 1.0) * 255.0) as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A colour for each kind of parts, spread by the golden angle.
fn tint(kind: usize) -> [f64; 3] {
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
    fn numbers_for_people() {
        let cases =
            [(0.0, "0"), (27.0, "27"), (0.0617, "0.0617"), (1234.56, "1235"), (1e-9, "1.00e-9")];
        for (x, text) in cases {
            assert_eq!(short(x), text);
        }
        assert_eq!(arrow(glam::DVec3::NEG_Y), "−y");
    }
}
