//! The first page: a summary, an exploded view, and a list of the parts.

use colltrans::Aabb;
use glam::{DVec2, DVec3};
use maud::{Markup, html};

use super::exploded::Exploded;
use super::kinds::{Kind, kinds};
use super::scene::{Look, Scene, Shown};
use super::words::{sentence, time_text};
use super::{Report, html_colour, picture_markup};
use crate::Fit;
use crate::attempts::next_attempts;
use crate::plan::Interlocked;

/// Width of the picture in pixels.
const WIDTH: f64 = 860.0;
/// Minimum and maximum height of the picture in pixels.
const HEIGHTS: [f64; 2] = [380.0, 900.0];
/// Maximum number of listed notes of the reader.
const MAX_NOTES: usize = 5;
/// Maximum number of items in a list without columns.
const ONE_COLUMN: usize = 8;

/// Returns the first page.
pub(super) fn cover_page(r: &Report, title: &str) -> Markup {
    let kinds = kinds(&r.f.plan, r.f.bodies.assembly().parts());
    html! {
        section.sheet id="cover" {
            h1 { (title) }
            p { (summary_text(r, kinds.len())) }
            @if r.is_assembly() { (assembly_result(r)) } @else { (result_section(r)) (notes_section(r)) }
            @if !kinds.is_empty() {
                (exploded_picture(r, &kinds, title))
                (part_list(r, &kinds))
            }
        }
    }
}

/// Returns the numbers of parts and shapes, the size, the fit, and the time.
fn summary_text(r: &Report, kinds: usize) -> String {
    let (assembly, words) = (r.f.bodies.assembly(), &r.words);
    let Aabb { low, high } = assembly.bounds();
    let count = assembly.parts().len();
    let shapes = if kinds < count { format!(" of {kinds} shapes") } else { String::new() };
    let size = words.extent_text(high - low);
    let unit = if assembly.unit().is_none() { " The file states no unit of length." } else { "" };
    let fit = match r.f.bodies.fit() {
        Fit::Tolerance(length) if length <= 1.001 * Fit::digits(assembly) => String::new(),
        Fit::Tolerance(length) => format!(" Tolerance {}.", words.fine_length_text(length)),
        Fit::Chords { largest, .. } => {
            format!(
                " Tolerances from the chord errors of the parts, at most {}.",
                words.fine_length_text(largest)
            )
        }
        Fit::MinGap(length) => format!(" Minimum gap {}.", words.fine_length_text(length)),
    };
    let seconds: f64 = r.seconds.iter().sum();
    let work = match r.f.plan.steps.len() {
        0 => String::new(),
        1 => format!(" 1 step, about {} of handling.", time_text(seconds)),
        steps => format!(" {steps} steps, about {} of handling.", time_text(seconds)),
    };
    format!("{count} parts{shapes}, {size} overall.{unit}{fit}{work}")
}

/// Returns the reason of each interlocked group, a sentence for each.
fn interlocking_reasons(r: &Report) -> String {
    let reason = |stuck: &Interlocked| {
        let parts = r.words.group_text(&stuck.parts);
        format!("{parts}: {}", stuck.reason_sentence(r.f.bodies))
    };
    r.f.plan.interlocked.iter().map(reason).collect::<Vec<_>>().join(" ")
}

/// Returns the result of the plan, and the number of overlapping pairs.
fn result_section(r: &Report) -> Markup {
    let (plan, words) = (&r.f.plan, &r.words);
    let whole = plan.remaining.is_empty() && plan.interlocked.is_empty();
    html! {
        @if let Some(wanted) = &plan.selection {
            p.partly { "To remove " (wanted.describe(r.f.bodies.assembly())) "." }
        } @else if plan.steps.is_empty() && !plan.remaining.is_empty() {
            p.warn { "No part can be removed. " (interlocking_reasons(r)) }
        } @else if whole && !plan.base.is_empty() {
            p.proof { "It can be taken apart completely. " (words.name_list(&plan.base)) " stays in place, all other parts are removed from it." }
        } @else if !whole {
            p.warn { "Not all of it comes apart. " (interlocking_reasons(r)) }
        }
        @for attempt in next_attempts(r.f) {
            p { "To try: " code { (attempt.option) } ", because " (attempt.reason) "." }
        }
        @let remaining = r.f.start.remaining().count();
        @if remaining > 0 {
            p.warn {
                @let apart = matches!(r.f.bodies.fit(), Fit::MinGap(_));
                @match (apart, remaining) {
                    (true, 1) => { "One pair of parts is nearer to each other than the minimum gap" }
                    (true, pairs) => { (pairs) " pairs of parts are nearer to each other than the minimum gap" }
                    (false, 1) => { "One pair of parts runs into each other with this fit" }
                    (false, pairs) => { (pairs) " pairs of parts run into each other with this fit" }
                }
                @if remaining == 1 { ", and is" } @else { ", and are" }
                " moved as one. The section after the steps lists them with suggestions."
            }
        }
    }
}

/// Returns the result of the plan for readers who put the assembly together.
fn assembly_result(r: &Report) -> Markup {
    let plan = &r.f.plan;
    html! {
        @if plan.steps.is_empty() {
            p.warn { "No order of assembly is known, because no part can be taken out. The report has the reasons." }
        } @else {
            p { "The steps are those of the report in reverse order, with reversed moves." }
        }
        @for stuck in &plan.interlocked {
            p.warn { (r.words.group_text(&stuck.parts)) ": how these parts are put together is not known; they are handled as one." }
        }
    }
}

/// Returns the notes of the reader.
fn notes_section(r: &Report) -> Markup {
    let notes = r.f.bodies.assembly().notes();
    html! {
        @for note in notes.iter().take(MAX_NOTES) { p.warn { (sentence(note)) } }
        @if notes.len() > MAX_NOTES { p.soft { (notes.len() - MAX_NOTES) " more notes are in assembly.json." } }
    }
}

/// Returns the exploded view, with the numbers of the list.
fn exploded_picture(r: &Report, kinds: &[Kind], title: &str) -> Markup {
    let Exploded { by, traces } = Exploded::new(r.f);
    let shown = |(part, &by): (usize, &DVec3)| Shown { part, by, look: Look::Full };
    let numbers = kinds.iter().enumerate().map(|(k, kind)| (k + 1, kind.parts.clone()));
    let mut scene = Scene {
        size: DVec2::new(WIDTH, HEIGHTS[0]),
        shown: by.iter().enumerate().map(shown).collect(),
        arrows: Vec::new(),
        traces,
        numbers: numbers.collect(),
        label: format!("{title}, each part moved away along its own path"),
    };
    scene.size.y = r.studio.picture_height(&scene, HEIGHTS).round();
    html! {
        figure {
            (picture_markup(r.studio.draw_picture(&scene, r.studio.default_viewpoint())))
            figcaption {
                "Each part is moved along its own path. Numbers refer to the list."
                @if let Some(frame) = r.words.frame_text() { " Directions: " (frame) "." }
            }
        }
    }
}

/// Returns the list of parts, grouped by shape, with sizes and steps.
fn part_list(r: &Report, kinds: &[Kind]) -> Markup {
    let assembly = r.f.bodies.assembly();
    let fixed = |kind: &Kind| kind.parts.iter().any(|&part| assembly.parts()[part].is_fixed());
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
                        span.swatch style=(format!("background:{}", html_colour(r.studio.own_colour(kind.parts[0])))) {}
                        " " (r.words.kind_name(&kind.parts))
                        @if fixed(kind) { " (fixed)" }
                    }
                    span { (r.words.sides_text(assembly.parts()[kind.parts[0]].bounds().side_lengths())) }
                    span { @if kind.steps.is_empty() { "stays" } @else { (r.step_list(&kind.steps)) } }
                }
            }
        }
    }
}
