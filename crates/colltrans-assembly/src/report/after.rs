//! Sections after the steps: order, assembly, interlocked groups, overlaps and maps.

use std::ops::Range;

use maud::{Markup, html};

use super::sheet::{self, direction_text, taken_parts_text, travel_text};
use super::words::{number_runs, plain_number, time_text};
use super::{Report, direction_name, picture_markup};
use crate::Fit;
use crate::map;
use crate::plan::ToleratedContact;
use crate::roles::{PairFit, Role};
use crate::suggest::Suggestion;

/// Maximum number of items in a list of constraints or suggestions.
const MAX_ITEMS: usize = 20;

/// Returns the sections after the steps.
pub(super) fn after_section(r: &Report) -> Markup {
    let f = r.f;
    html! {
        section.sheet id="after" {
            (order_section(r))
            (assembly_section(r))
            (interlocked_section(r))
            (constraints_section(r))
            (overlaps_section(r))
            @for (name, map) in &f.maps { (map_section(map, name)) }
        }
    }
}

/// Returns the table of steps with the steps that each needs, its round and its time.
fn order_section(r: &Report) -> Markup {
    let steps = &r.f.plan.steps;
    let rounds = r.rounds.iter().max().map_or(0, |k| k + 1);
    html! {
        h2 { "The steps" }
        @if steps.is_empty() {
            p { "Nothing can be taken out." }
        } @else {
            p {
                @if steps.len() > 1 {
                    "A step can be done once the steps that it needs are done. Steps of the same round can be done at the \
                     same time. "
                    @if rounds > 1 { "There are " (rounds) " rounds. " }
                }
                "By the table of handling times it takes about " (time_text(r.seconds.iter().sum()))
                @if steps.len() > 1 { ", one step after another" }
                "."
            }
            div.wide {
                table {
                    thead { tr { th { "steps" } th { "take out" } th { "way" } th { "need" } th { "round" } th { "time" } } }
                    tbody {
                        @for stage in r.f.plan.stages() {
                            @let all: Vec<usize> = stage.clone().collect();
                            @let after: Vec<usize> = steps[stage.clone()].iter().flat_map(|s| s.predecessors.iter().copied()).collect();
                            @let rounds: Vec<usize> = all.iter().map(|&k| r.rounds[k]).collect();
                            tr {
                                td { (number_runs(&all)) }
                                td { (taken_parts_text(r, &stage)) }
                                td { (move_text(r, &stage)) }
                                td { @if !after.is_empty() { (number_runs(&after)) } }
                                td { (number_runs(&rounds)) }
                                td.n { (time_text(r.seconds[stage.clone()].iter().sum())) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Describes the move of a stage, or the number of its moves.
fn move_text(r: &Report, stage: &Range<usize>) -> String {
    let steps = &r.f.plan.steps[stage.clone()];
    let direction = direction_text(r, stage, 1.0);
    match (steps[0].path.len(), travel_text(r, steps)) {
        (1, None) => direction,
        (1, Some(far)) => format!("{direction}, {far}"),
        (moves, _) => format!("{moves} moves"),
    }
}

/// Returns the steps in reverse order, as instructions for assembly.
fn assembly_section(r: &Report) -> Markup {
    let plan = &r.f.plan;
    let stages = plan.stages();
    html! {
        @if plan.steps.len() > 1 {
            h3 { "Putting it together" }
            p {
                "The steps in reverse order, with each move reversed; the same proofs apply"
                @if !plan.base.is_empty() { ". It begins with " (r.words.name_list(&plan.base)) }
                "."
            }
            ol {
                @for stage in stages.iter().rev() {
                    @let step = &plan.steps[stage.start];
                    li {
                        (taken_parts_text(r, stage)) ": "
                        @if step.path.len() > 1 {
                            (r.step_list(&stage.clone().collect::<Vec<_>>())) " in reverse"
                        } @else {
                            (direction_text(r, stage, -1.0))
                        }
                        @if step.group_step.is_some() { ", before its group is put in" }
                    }
                }
            }
        }
    }
}

/// Returns the list of interlocked groups with the reasons.
fn interlocked_section(r: &Report) -> Markup {
    html! {
        @if !r.f.plan.interlocked.is_empty() {
            h3 { "What stays together, and why" }
            ul {
                @for s in &r.f.plan.interlocked {
                    @let (reason, details) = (s.reason_sentence(r.f.bodies), s.evidence_sentences(r.f.bodies));
                    li { b { (r.words.name_list(&s.parts)) ": " (reason) } " " (details) }
                }
            }
        }
    }
}

/// Returns the list of fits of pairs and of constraints on the plan.
fn constraints_section(r: &Report) -> Markup {
    let (assembly, words) = (r.f.bodies.assembly(), &r.words);
    let constraints = assembly.constraints();
    let name = |part: usize| assembly.parts()[part].name();
    let mut items: Vec<String> = sheet::passed_texts(r, &pairs_with_fit(r));
    let before = constraints.order_pairs().iter();
    items.extend(before.map(|&[a, b]| format!("{} leaves before {}", name(a), name(b))));
    items.extend(constraints.units().iter().map(|unit| {
        let names = words.name_list(&unit.parts);
        let apart =
            if unit.is_subassembly { ", and is then taken apart" } else { ", and stays together" };
        match &unit.name {
            Some(known) => format!("{known} ({names}) leaves as one{apart}"),
            None => format!("{names} leave as one"),
        }
    }));
    items.extend(constraints.forbidden_directions().iter().map(|never| {
        let within = plain_number(never.angle_degrees);
        format!(
            "{} never goes {}, nor within {within}° of that",
            name(never.part),
            words.direction_text(never.direction)
        )
    }));
    html! {
        @if !items.is_empty() {
            h3 { "Given fits and constraints" }
            ul { @for text in items.iter().take(MAX_ITEMS) { li { (text) } } }
            @if items.len() > MAX_ITEMS { p { (items.len() - MAX_ITEMS) " more are in assembly.json." } }
        }
    }
}

/// Returns all pairs with a fit of their own.
fn pairs_with_fit(r: &Report) -> Vec<ToleratedContact> {
    let bodies = r.f.bodies;
    let pair = |(parts, fit): ([usize; 2], PairFit)| {
        Some(ToleratedContact {
            parts,
            role: fit.role,
            tolerated: bodies.tolerated_contacts(parts)?,
        })
    };
    bodies.assembly().pair_fits().filter_map(pair).collect()
}

/// Returns the number of overlapping pairs, and suggestions for them.
fn overlaps_section(r: &Report) -> Markup {
    let f = r.f;
    let remaining = f.start.remaining().count();
    html! {
        @if remaining > 0 {
            @let apart = matches!(f.bodies.fit(), Fit::MinGap(_));
            h3 { @if apart { "Parts that are too near to each other" } @else { "Parts that run into each other" } }
            p {
                (remaining) @if remaining == 1 { " pair " } @else { " pairs " }
                @if apart {
                    @if remaining == 1 { "is" } @else { "are" } " nearer than the length to keep"
                } @else {
                    "overlap" @if remaining == 1 { "s" } " with this tolerance"
                }
                ", and count as one body where they meet; a table of them is at the end of the file."
                @if let Some(tolerance) = f.start.suggested_tolerance.filter(|_| !apart) {
                    " Try a tolerance of " (plain_number(tolerance)) " or, for curved fits, the chord errors of both parts together."
                }
            }
        }
        @let items = suggestion_texts(r);
        @if !items.is_empty() {
            @if remaining > 0 {
                p { "They may be intended; --auto applies all of these suggestions:" }
            } @else {
                h3 { "Suggestions" }
                p { "--auto applies all of these suggestions:" }
            }
            ul { @for text in items.iter().take(MAX_ITEMS) { li { (text) } } }
            @if items.len() > MAX_ITEMS { p { (items.len() - MAX_ITEMS) " more are in assembly.json." } }
        }
    }
}

/// Returns the suggestions for pairs as texts, equal pairs together, the largest tolerance first.
fn suggestion_texts(r: &Report) -> Vec<String> {
    let mut all: Vec<&Suggestion> = r.f.suggestions.iter().collect();
    let tolerance = |s: &Suggestion| s.fit.tolerance.unwrap_or(0.0);
    all.sort_by(|a, b| tolerance(b).total_cmp(&tolerance(a)));
    let text = |s: &Suggestion| {
        let what = match s.fit.role {
            Some(Role::Press) => "perhaps a press fit",
            Some(Role::Thread) => "perhaps a thread",
            Some(Role::Soft) => "perhaps soft",
            Some(Role::Snap) => "perhaps a snap",
            Some(Role::Glued) => "perhaps glued",
            None => "perhaps only rounded shapes",
        };
        let remedy = s.fit.tolerance.map(|t| {
            format!("; a tolerance of {} removes the overlap", r.words.fine_length_text(t))
        });
        format!("{what} ({}){}", s.reason, remedy.unwrap_or_default())
    };
    sheet::pair_texts(r, all.into_iter().map(|s| (s.parts, s.fit.role, text(s))))
}

/// Returns the map of the free directions of a part.
fn map_section(map: &map::RemovalMap, name: &str) -> Markup {
    let title = format!("Free travel of {name} in all directions");
    html! {
        h3 { (title) }
        figure { (picture_markup(map::render_svg(map, &title))) }
        @match &map.cover {
            Ok(cover) => {
                p {
                    (percentage(cover.free_share())) " of all directions are free, which is proven; of "
                    (percentage(cover.undecided_share())) " the outcome is unknown."
                }
            }
            Err(why) => {
                p { (percentage(map.free_share())) " of the directions sampled are free: " (why) "." }
            }
        }
        @for region in map.regions.iter().take(8) {
            p {
                "A free region of " (plain_number(region.solid_angle)) " steradians around "
                (direction_name(region.center)) "."
            }
        }
        @for d in &map.isolated { p { "An isolated free direction: " (direction_name(*d)) "." } }
    }
}

/// Formats a share as a percentage.
fn percentage(share: f64) -> String {
    format!("{} %", plain_number(100.0 * share))
}
