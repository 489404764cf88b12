//! The first page: what it is, all of it in an exploded view, and a list of its parts.

use colltrans::Aabb;
use glam::{DVec2, DVec3};
use maud::{Markup, html};

use super::exploded::Exploded;
use super::kinds::{Kind, kinds};
use super::scene::{Look, Scene, Shown};
use super::sheet::step_words;
use super::words::{sentence, time};
use super::{Report, hexadecimal, picture};
use crate::Fit;
use crate::plan::Stuck;

/// The width of the picture in pixels, and bounds of its height.
const WIDTH: f64 = 860.0;
const HEIGHTS: [f64; 2] = [380.0, 900.0];
/// Notes of the source are listed up to so many.
const MOST_NOTES: usize = 5;
/// Longer lists stand in columns.
const ONE_COLUMN: usize = 8;

pub(super) fn page(r: &Report, title: &str) -> Markup {
    let kinds = kinds(&r.f.plan, r.f.bodies.len());
    html! {
        section.sheet id="cover" {
            h1 { (title) }
            p { (summary(r, kinds.len())) }
            (result(r))
            (notes(r))
            @if !kinds.is_empty() {
                (exploded(r, &kinds, title))
                (list(r, &kinds))
            }
        }
    }
}

/// How many parts of how many shapes, how large it is, with which fit, and how long it takes.
fn summary(r: &Report, kinds: usize) -> String {
    let (assembly, words) = (r.f.bodies.assembly(), &r.words);
    let Aabb { low, high } = assembly.bounds();
    let count = assembly.parts().len();
    let shapes = if kinds < count { format!(" of {kinds} shapes") } else { String::new() };
    let size = words.extent(high - low);
    let unit = if assembly.unit().is_none() { " The file names no unit of length." } else { "" };
    let fit = match r.f.bodies.fit() {
        Fit::Tolerance(length) if length <= 1.001 * Fit::digits(assembly) => String::new(),
        Fit::Tolerance(length) => format!(" Tolerance {}.", words.length(length)),
        Fit::Chords { largest, .. } => {
            format!(
                " Tolerances by the chord errors of the parts, {} at most.",
                words.length(largest)
            )
        }
        Fit::Apart(length) => format!(" To be kept apart by {}.", words.length(length)),
    };
    let seconds: f64 = r.seconds.iter().sum();
    let work = match r.f.plan.steps.len() {
        0 => String::new(),
        1 => format!(" 1 step, about {} of handling.", time(seconds)),
        steps => format!(" {steps} steps, about {} of handling.", time(seconds)),
    };
    format!("{count} parts{shapes}, {size} overall.{unit}{fit}{work}")
}

/// Why parts stay together, a sentence for each group of them.
fn reasons(r: &Report) -> String {
    let reason = |stuck: &Stuck| {
        let parts = r.words.group(&stuck.parts);
        format!("{parts}: {}", stuck.reason(r.f.bodies))
    };
    r.f.plan.stuck.iter().map(reason).collect::<Vec<_>>().join(" ")
}

/// How far the plan comes, in a sentence.
fn result(r: &Report) -> Markup {
    let (plan, words) = (&r.f.plan, &r.words);
    let whole = plan.left.is_empty() && plan.stuck.is_empty();
    html! {
        @if let Some(wanted) = &plan.wanted {
            p.partly { "To take out " (wanted.words(r.f.bodies.assembly())) "." }
        } @else if plan.steps.is_empty() && !plan.left.is_empty() {
            p.warn { "Nothing can be taken out. " (reasons(r)) }
        } @else if whole && !plan.last.is_empty() {
            p.proof { "It comes apart wholly. " (words.names(&plan.last)) " stays where it is, the rest is taken off it." }
        } @else if !whole {
            p.warn { "Not all comes apart. " (reasons(r)) }
        }
        @let remaining = r.f.start.remaining().count();
        @if remaining > 0 {
            p.warn {
                @let apart = matches!(r.f.bodies.fit(), Fit::Apart(_));
                @match (apart, remaining) {
                    (true, 1) => { "One pair of parts is nearer to each other than what is to be kept" }
                    (true, pairs) => { (pairs) " pairs of parts are nearer to each other than what is to be kept" }
                    (false, 1) => { "One pair of parts runs into each other as they are drawn" }
                    (false, pairs) => { (pairs) " pairs of parts run into each other as they are drawn" }
                }
                @if remaining == 1 { ", and is" } @else { ", and are" }
                " moved as one; which, and what may help, is said after the steps."
            }
        }
    }
}

fn notes(r: &Report) -> Markup {
    let notes = r.f.bodies.assembly().notes();
    html! {
        @for note in notes.iter().take(MOST_NOTES) { p.warn { (sentence(note)) } }
        @if notes.len() > MOST_NOTES { p.soft { (notes.len() - MOST_NOTES) " more notes are in assembly.json." } }
    }
}

fn exploded(r: &Report, kinds: &[Kind], title: &str) -> Markup {
    let Exploded { by, traces } = Exploded::new(r.f);
    let shown = |(part, &by): (usize, &DVec3)| Shown { part, by, look: Look::Full };
    let numbers = kinds.iter().enumerate().map(|(k, kind)| (k + 1, kind.parts.clone()));
    let mut scene = Scene {
        size: DVec2::new(WIDTH, HEIGHTS[0]),
        shown: by.iter().enumerate().map(shown).collect(),
        arrows: Vec::new(),
        traces,
        numbers: numbers.collect(),
        label: format!("{title}, each part moved away along its own way"),
    };
    scene.size.y = r.studio.height(&scene, HEIGHTS).round();
    html! {
        figure {
            (picture(r.studio.picture(&scene, r.studio.front())))
            figcaption { "Every part is drawn where its own way leads it. Numbers are those of the list." }
        }
    }
}

fn list(r: &Report, kinds: &[Kind]) -> Markup {
    let assembly = r.f.bodies.assembly();
    let fixed = |kind: &Kind| kind.parts.iter().any(|&part| assembly.parts()[part].fixed());
    let class = if kinds.len() > ONE_COLUMN { "list columns" } else { "list" };
    let unit = match r.words.unit() {
        "" => String::new(),
        unit => format!(", sizes in {unit}"),
    };
    html! {
        h2 { "Parts" span.soft { (unit) } }
        ol class=(class) {
            @for (k, kind) in kinds.iter().enumerate() {
                li {
                    b { (k + 1) }
                    span { (kind.parts.len()) " ×" }
                    span {
                        span.swatch style=(format!("background:{}", hexadecimal(r.studio.own_colour(kind.parts[0])))) {}
                        " " (r.words.kind(&kind.parts))
                        @if fixed(kind) { " (fixed)" }
                    }
                    span { (r.words.sides(assembly.parts()[kind.parts[0]].bounds().size())) }
                    span { @if kind.steps.is_empty() { "stays" } @else { (step_words(&kind.steps)) } }
                }
            }
        }
    }
}
