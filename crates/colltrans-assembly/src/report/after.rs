//! What follows the steps: their order, the way back, what stays together, what overlaps, and maps.

use std::ops::Range;

use maud::{Markup, html};

use super::sheet::{self, far, step_words, takes, ways};
use super::words::{numbers, time};
use super::{Report, arrow, picture, short};
use crate::Fit;
use crate::map;
use crate::plan::Passed;
use crate::roles::{PairFit, Role};
use crate::suggest::Suggestion;

/// What was asked is listed up to so many.
const MOST_SAID: usize = 20;

pub(super) fn section(r: &Report) -> Markup {
    let f = r.f;
    html! {
        section.sheet id="after" {
            (order(r))
            (backwards(r))
            (stuck(r))
            (asked(r))
            (overlaps(r))
            @for (name, map) in &f.maps { (map_section(map, name)) }
        }
    }
}

/// Which steps wait for which, and how long they take.
fn order(r: &Report) -> Markup {
    let steps = &r.f.plan.steps;
    let rounds = r.rounds.iter().max().map_or(0, |k| k + 1);
    html! {
        h2 { "The steps" }
        @if steps.is_empty() {
            p { "Nothing can be taken out." }
        } @else {
            p {
                @if steps.len() > 1 {
                    "A step may be done as soon as those that it needs are done; steps of one round may be done at the \
                     same time. "
                    @if rounds > 1 { "There are " (rounds) " rounds. " }
                }
                "By the table of handling times it takes about " (time(r.seconds.iter().sum()))
                @if steps.len() > 1 { ", one step after another" }
                "."
            }
            div.wide {
                table {
                    thead { tr { th { "steps" } th { "take out" } th { "way" } th { "need" } th { "round" } th { "time" } } }
                    tbody {
                        @for stage in r.f.plan.stages() {
                            @let all: Vec<usize> = stage.clone().collect();
                            @let after: Vec<usize> = steps[stage.clone()].iter().flat_map(|s| s.after.iter().copied()).collect();
                            @let rounds: Vec<usize> = all.iter().map(|&k| r.rounds[k]).collect();
                            tr {
                                td { (numbers(&all)) }
                                td { (takes(r, &stage)) }
                                td { (way(r, &stage)) }
                                td { @if !after.is_empty() { (numbers(&after)) } }
                                td { (numbers(&rounds)) }
                                td.n { (time(r.seconds[stage.clone()].iter().sum())) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn way(r: &Report, stage: &Range<usize>) -> String {
    let steps = &r.f.plan.steps[stage.clone()];
    let way = ways(r, stage, 1.0);
    match (steps[0].path.len(), far(r, steps)) {
        (1, None) => way,
        (1, Some(far)) => format!("{way}, {far}"),
        (moves, _) => format!("{moves} moves"),
    }
}

/// How it is put together.
fn backwards(r: &Report) -> Markup {
    let plan = &r.f.plan;
    let stages = plan.stages();
    html! {
        @if plan.steps.len() > 1 {
            h3 { "Putting it together" }
            p {
                "The steps backwards, each move the other way, which the same proofs allow"
                @if !plan.last.is_empty() { "; it begins with " (r.words.names(&plan.last)) }
                "."
            }
            ol {
                @for stage in stages.iter().rev() {
                    @let step = &plan.steps[stage.start];
                    li {
                        (takes(r, stage)) ": "
                        @if step.path.len() > 1 {
                            (step_words(&stage.clone().collect::<Vec<_>>())) " backwards"
                        } @else {
                            (ways(r, stage, -1.0))
                        }
                        @if step.within.is_some() { ", before its group is put in" }
                    }
                }
            }
        }
    }
}

fn stuck(r: &Report) -> Markup {
    html! {
        @if !r.f.plan.stuck.is_empty() {
            h3 { "What stays together, and why" }
            ul {
                @for s in &r.f.plan.stuck {
                    @let (reason, details) = (s.reason(r.f.bodies), s.details(r.f.bodies));
                    li { b { (r.words.names(&s.parts)) ": " (reason) } " " (details) }
                }
            }
        }
    }
}

/// What was said of pairs and asked of the order.
fn asked(r: &Report) -> Markup {
    let (assembly, words) = (r.f.bodies.assembly(), &r.words);
    let constraints = assembly.constraints();
    let name = |part: usize| assembly.parts()[part].name();
    let mut said: Vec<String> = sheet::told(r, &tolerated(r));
    let before = constraints.before().iter();
    said.extend(before.map(|&[a, b]| format!("{} leaves before {}", name(a), name(b))));
    said.extend(constraints.units().iter().map(|unit| {
        let names = words.names(&unit.parts);
        let apart = if unit.apart { ", and is then taken apart" } else { ", and stays together" };
        match &unit.name {
            Some(known) => format!("{known} ({names}) leaves as one{apart}"),
            None => format!("{names} leave as one"),
        }
    }));
    said.extend(constraints.never().iter().map(|never| {
        let within = short(never.within);
        format!(
            "{} never goes {}, nor within {within}° of that",
            name(never.part),
            words.way(never.direction)
        )
    }));
    html! {
        @if !said.is_empty() {
            h3 { "What was said of parts" }
            ul { @for text in said.iter().take(MOST_SAID) { li { (text) } } }
            @if said.len() > MOST_SAID { p { (said.len() - MOST_SAID) " more are in assembly.json." } }
        }
    }
}

/// All pairs with a fit of their own.
fn tolerated(r: &Report) -> Vec<Passed> {
    let bodies = r.f.bodies;
    let pair = |(parts, fit): ([usize; 2], PairFit)| {
        Some(Passed { parts, role: fit.role, tolerated: bodies.tolerated(parts)? })
    };
    bodies.assembly().pairs().filter_map(pair).collect()
}

/// What runs into each other as it is drawn, and what may help.
fn overlaps(r: &Report) -> Markup {
    let f = r.f;
    let remaining = f.start.remaining().count();
    html! {
        @if remaining > 0 {
            @let apart = matches!(f.bodies.fit(), Fit::Apart(_));
            h3 { @if apart { "Parts that are too near to each other" } @else { "Parts that run into each other" } }
            p {
                (remaining) @if remaining == 1 { " pair " } @else { " pairs " }
                @if apart {
                    @if remaining == 1 { "is" } @else { "are" } " nearer than the length to keep"
                } @else {
                    "overlap" @if remaining == 1 { "s" } " with this tolerance"
                }
                ", and count as one body where they meet; a table of them is at the end of the file."
                @if let Some(tolerance) = f.start.suggested.filter(|_| !apart) {
                    " Try a tolerance of " (short(tolerance)) " or, for curved fits, the chord errors of both parts together."
                }
            }
        }
        @let said = suggested(r);
        @if !said.is_empty() {
            @if remaining > 0 {
                p { "They may be on purpose; --auto takes all of these for granted:" }
            } @else {
                h3 { "What may hold" }
                p { "With --auto all of these are taken for granted:" }
            }
            ul { @for text in said.iter().take(MOST_SAID) { li { (text) } } }
            @if said.len() > MOST_SAID { p { (said.len() - MOST_SAID) " more are in assembly.json." } }
        }
    }
}

/// What pairs may be, the largest overlap of like ones first.
fn suggested(r: &Report) -> Vec<String> {
    let mut all: Vec<&Suggestion> = r.f.suggestions.iter().collect();
    let tolerance = |s: &Suggestion| s.fit.tolerance.unwrap_or(0.0);
    all.sort_by(|a, b| tolerance(b).total_cmp(&tolerance(a)));
    let said = |s: &Suggestion| {
        let what = match s.fit.role {
            Some(Role::Press) => "perhaps a press fit",
            Some(Role::Thread) => "perhaps a thread",
            Some(Role::Soft) => "perhaps soft",
            Some(Role::Snap) => "perhaps a snap",
            Some(Role::Glued) => "perhaps glued",
            None => "perhaps no more than rounded shapes",
        };
        let enough =
            s.fit.tolerance.map(|t| format!("; a tolerance of {} ends that", r.words.length(t)));
        format!("{what} ({}){}", s.why, enough.unwrap_or_default())
    };
    sheet::alike(r, all.into_iter().map(|s| (s.parts, s.fit.role, said(s))))
}

fn map_section(map: &map::RemovalMap, name: &str) -> Markup {
    let title = format!("Room of {name} in all directions");
    html! {
        h3 { (title) }
        figure { (picture(map::svg(map, &title))) }
        @match &map.cover {
            Ok(cover) => {
                p {
                    (share(cover.free_share())) " of all directions are free, which is proven; of "
                    (share(cover.undecided_share())) " nothing is known."
                }
            }
            Err(why) => {
                p { (share(map.free_share())) " of the directions sampled are free: " (why) "." }
            }
        }
        @for region in map.regions.iter().take(8) {
            p {
                "A free region of " (short(region.solid_angle)) " steradians around "
                (arrow(region.center)) "."
            }
        }
        @for d in &map.isolated { p { "An isolated free direction: " (arrow(*d)) "." } }
    }
}

/// A share as a percentage.
fn share(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}
