//! One HTML file: offline, its pictures drawn into it; without scripts only the viewer is missing.
//!
//! Written with `maud`, which escapes every text that is put in. Let through as they are, and marked
//! [`PreEscaped`], are only what this crate holds (style, script) or draws (pictures, see `markup`).

use std::ops::Range;

use colltrans::Aabb;
use glam::DVec3;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::scene::{self, Arrow, Shown};
use super::{Findings, arrow, graph, short, viewer};
use crate::blocking::Blocking;
use crate::map;
use crate::part::Part;
use crate::plan::{Leg, Plan, Step};
use crate::rooms::PartRoom;
use crate::suggest;

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:70em;\
padding:0 1em;color:#222}h1,h2{font-weight:600}h2{margin-top:2em;border-bottom:1px solid #ccc}\
table{border-collapse:collapse;font-size:13px}td,th{border:1px solid #ddd;padding:.2em .5em;\
text-align:left;vertical-align:top}th{background:#f3f5f8}td.n{text-align:right}\
td.free{background:#fde3c4}td.overlapping{background:#eac8c8}.wide{overflow-x:auto}\
.steps{display:grid;grid-template-columns:repeat(auto-fill,minmax(20em,1fr));gap:1em}\
.graphs{grid-template-columns:repeat(auto-fill,minmax(min(30em,100%),1fr))}.steps figure{margin:0;border:1px solid #ddd;padding:.5em}figure svg{width:100%;height:auto}\
figcaption{font-size:13px}.moves{margin:.3em 0 0;padding-left:1.6em}.warn{background:#fff3e0;border-left:4px solid #f6963a;padding:.5em 1em}";

/// Tables of rooms and pictures of graphs are cut off here; the JSON has all.
const MOST_ROWS: usize = 200;
const MOST_STEPS: usize = 60;
const MOST_GRAPHS: usize = 6;

/// The report.
pub fn page(f: &Findings, title: &str) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (title) }
                (overview(f))
                (viewer::section(f))
                (overlaps(f))
                (steps(f))
                (order(f))
                (stuck(f))
                @for (name, map) in f.maps { (map_section(map, name)) }
                (rooms(f))
                (graphs(f))
                (contacts(f))
                (parts(f))
            }
        }
    };
    page.into_string()
}

fn overview(f: &Findings) -> Markup {
    let assembly = f.bodies.assembly();
    let Aabb { low, high } = assembly.bounds();
    let size = high - low;
    let unit = assembly.unit().map_or(String::new(), |unit| format!(" {unit}"));
    let (tolerance, word) = match f.bodies.fit() {
        crate::Fit::Tolerance(length) => (length, "tolerance"),
        crate::Fit::Chords { largest, .. } => (largest, "tolerances from chord errors, at most"),
        crate::Fit::Apart(length) => (length, "length to keep"),
    };
    let summary = format!(
        "{} parts, {} × {} × {}{unit}; {word} {}{unit}; {} directions asked of all parts. Plan: {} \
         steps, {} parts left, {} that do not come apart.",
        assembly.parts().len(),
        short(size.x),
        short(size.y),
        short(size.z),
        short(tolerance),
        f.matrix.directions().len(),
        f.plan.steps.len(),
        f.plan.left.len(),
        match f.plan.stuck.len() {
            1 => "1 group".to_owned(),
            count => format!("{count} groups"),
        }
    );
    html! {
        p { (summary) }
        @for note in assembly.notes() { p.warn { (note) } }
        @if !assembly.parts().is_empty() {
            figure style="max-width:45em" { (picture(scene::svg(&whole(f, &[]), &[]))) }
        }
    }
}

/// A picture that was drawn here, whose texts are escaped.
fn picture(svg: String) -> PreEscaped<String> {
    PreEscaped(svg)
}

/// All parts, those that are listed moved away.
fn whole<'a>(f: &Findings<'a>, moved: &[(usize, DVec3)]) -> Vec<Shown<'a>> {
    let parts = f.bodies.assembly().parts().iter().enumerate();
    let by = |k: usize| moved.iter().find(|m| m.0 == k).map_or(DVec3::ZERO, |m| m.1);
    parts.map(|(k, part)| Shown { part, color: k, by: by(k), pale: false }).collect()
}

fn overlaps(f: &Findings) -> Markup {
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    let remaining = f.start.remaining().count();
    html! {
        h2 { "Overlaps at the start" }
        @if f.start.overlaps.is_empty() {
            p { "None." }
        } @else {
            @if remaining > 0 {
                p.warn {
                    (remaining) " pairs overlap with this tolerance, and count as one body where they \
                     meet."
                    @if let Some(tolerance) = f.start.suggested {
                        " Try a tolerance of " (short(tolerance)) " or, for curved fits, the chord \
                         errors of both parts together."
                    }
                    @let said = suggest::told(f.bodies.assembly(), f.suggestions);
                    @if !said.is_empty() { " They may be on purpose: " (said.join("; ")) "." }
                }
            }
            table {
                tr { th { "parts" } th { "depth" } th { "with this tolerance" } }
                @for o in f.start.overlaps.iter().take(MOST_ROWS) {
                    tr {
                        td { (name(o.parts[0])) ", " (name(o.parts[1])) }
                        td.n { (o.depth.map_or("more than their size".into(), short)) }
                        td { (if o.remains { "overlap" } else { "do not" }) }
                    }
                }
            }
        }
    }
}

fn steps(f: &Findings) -> Markup {
    let steps = &f.plan.steps;
    let stages = f.plan.stages().len();
    let mut gone = vec![false; f.bodies.len()];
    let mut figures = Vec::new();
    for stage in f.plan.stages().into_iter().take(MOST_STEPS) {
        figures.push(stage_figure(f, &stage, &gone));
        for step in steps[stage].iter().filter(|step| step.within.is_none()) {
            step.parts.iter().for_each(|&p| gone[p] = true);
        }
    }
    html! {
        h2 { "Plan" }
        @if steps.is_empty() {
            p { "Nothing can be taken out." }
        } @else {
            div.steps { @for figure in figures { (figure) } }
            @if stages > MOST_STEPS {
                p { (stages - MOST_STEPS) " more are in the JSON." }
            }
            @if let Some(wanted) = &f.plan.wanted {
                p { "To take out " (wanted.words(f.bodies.assembly())) "." }
            }
            @if !f.plan.last.is_empty() {
                p { "What remains: " (f.bodies.assembly().names(&f.plan.last).join(", ")) "." }
            }
        }
    }
}

/// Which steps wait for which, how long it takes, and how it is put together.
fn order(f: &Findings) -> Markup {
    let steps = &f.plan.steps;
    if steps.len() < 2 {
        return Markup::default();
    }
    let names = |step: usize| f.bodies.assembly().names(&steps[step].parts).join(", ");
    let numbers =
        |all: &[usize]| all.iter().map(|k| (k + 1).to_string()).collect::<Vec<_>>().join(", ");
    let seconds = f.times.of(f.plan);
    html! {
        h2 { "Which steps wait for which" }
        p {
            "Steps of one round may go at once. By the table of handling times all steps take "
            (short(seconds.iter().sum::<f64>())) " s, one after another."
        }
        table {
            tr { th { "round" } th { "step" } th { "takes" } th { "after" } th { "seconds" } }
            @for (round, all) in f.plan.rounds().iter().enumerate() {
                @for &step in all.iter().take(MOST_ROWS) {
                    tr {
                        td.n { (round + 1) }
                        td.n { (step + 1) }
                        td { (names(step)) }
                        td { (numbers(&steps[step].after)) }
                        td.n { (short(seconds[step])) }
                    }
                }
            }
        }
        h2 { "Putting it together" }
        p {
            "The steps backwards, each move the other way"
            @if !f.plan.last.is_empty() {
                ", beginning with " (f.bodies.assembly().names(&f.plan.last).join(", "))
            }
            "."
        }
        ol {
            @for (step, _) in f.plan.assembly().into_iter().take(MOST_ROWS) {
                li { (names(step)) " (" (arrow(DVec3::ZERO - steps[step].direction)) ")" }
            }
        }
    }
}

/// Steps that are told as one: the moves of the first one, and all of their parts.
fn stage_figure(f: &Findings, stage: &Range<usize>, gone: &[bool]) -> Markup {
    let step = &f.plan.steps[stage.start];
    let travel = f.plan.travel(stage);
    html! {
        figure {
            (picture(stage_picture(f, stage, gone)))
            figcaption {
                b { (Plan::numbers(stage)) "." } " " (f.plan.takes(f.bodies.assembly(), stage))
                @if let Some(w) = step.within { " (of the group of step " (w + 1) ")" }
                ": "
                @if step.path.len() > 1 {
                    "in " (step.path.len()) " moves"
                    ol.moves {
                        @for leg in &step.path { (leg_item(f, leg, "")) }
                        @for leg in &step.back { (leg_item(f, leg, "back: ")) }
                    }
                } @else {
                    (arrow(step.direction))
                    @if travel > 0.0 { ", " (short(travel)) }
                }
                @if !step.surfaces.is_empty() {
                    "; rests on an open surface: "
                    (f.bodies.assembly().names(&step.surfaces).join(", "))
                }
                @if let Some(ignored) = step.ignores(f.bodies.assembly()) {
                    br; span.warn { (ignored) }
                }
                @for step in &f.plan.steps[stage.clone()] {
                    @for said in step.unsettled(f.bodies.assembly()) { br; span.warn { (said) } }
                }
                @for passed in f.plan.passed(stage) {
                    br; span.warn { (passed.words(f.bodies.assembly())) }
                }
            }
        }
    }
}

fn leg_item(f: &Findings, leg: &Leg, before: &str) -> Markup {
    let names = f.bodies.assembly().names(&leg.parts).join(", ");
    html! {
        li { (before) (names) ": " (arrow(leg.direction)) @if leg.travel > 0.0 { ", " (short(leg.travel)) } }
    }
}

/// What is left, pale, and what moves, on its way out; what made room where it is then.
fn stage_picture(f: &Findings, stage: &Range<usize>, gone: &[bool]) -> String {
    let steps = &f.plan.steps[stage.clone()];
    let step = &steps[0];
    let parts = f.bodies.assembly().parts();
    let Aabb { low, high } = f.bodies.assembly().bounds();
    let by = step.direction
        * (f.plan.travel(stage) * 0.5)
            .clamp(0.12 * (high - low).length(), 0.5 * (high - low).length());
    let group = step.within.map(|w| &f.plan.steps[w].parts);
    let there = |p: usize| match group {
        Some(group) => {
            group.contains(&p)
                && !f.plan.steps[..stage.start]
                    .iter()
                    .any(|s| s.within == step.within && s.parts.contains(&p))
        }
        None => !gone[p],
    };
    let shown: Vec<Shown> = (0..parts.len())
        .filter(|&p| there(p))
        .map(|p| {
            let moves = steps.iter().any(|step| step.parts.contains(&p));
            let by = aside(step, p) + if moves { by } else { DVec3::ZERO };
            Shown { part: &parts[p], color: p, by, pale: !moves }
        })
        .collect();
    let long = step.direction * 0.1 * (high - low).length();
    let arrows: Vec<Arrow> = steps.iter().flat_map(|step| arrows(f, step, by + long)).collect();
    scene::svg(&shown, &arrows)
}

/// By how much a part has been moved before the last move of a step.
fn aside(step: &Step, part: usize) -> DVec3 {
    let before = &step.path[..step.path.len() - 1];
    let own = before.iter().filter(|leg| leg.parts.contains(&part));
    own.map(|leg| leg.direction * leg.travel).sum()
}

/// An arrow for each move of a step, from the middle of what moves; the last one by `out`.
fn arrows(f: &Findings, step: &Step, out: DVec3) -> Vec<Arrow> {
    let mut at = vec![DVec3::ZERO; f.bodies.len()];
    let mut arrows = Vec::new();
    for (k, leg) in step.path.iter().enumerate() {
        let bounds = |&part: &usize| {
            let Aabb { low, high } = f.bodies.bounds(part);
            Aabb { low: low + at[part], high: high + at[part] }
        };
        let Some(all) = leg.parts.iter().map(bounds).reduce(|a, b| a.join(&b)) else { continue };
        let from = all.center();
        let by = if k + 1 == step.path.len() { out } else { leg.direction * leg.travel };
        arrows.push(Arrow { from, to: from + by });
        for &part in &leg.parts {
            at[part] += by;
        }
    }
    arrows
}

fn stuck(f: &Findings) -> Markup {
    html! {
        @if !f.plan.stuck.is_empty() {
            h2 { "What does not come apart" }
            ul {
                @for s in &f.plan.stuck {
                    li {
                        b { (f.bodies.assembly().names(&s.parts).join(", ")) }
                        ": " (s.because(f.bodies)) "."
                    }
                }
            }
        }
    }
}

fn map_section(map: &map::RemovalMap, name: &str) -> Markup {
    let title = format!("Room of {name} in all directions");
    html! {
        h2 { (title) }
        figure style="max-width:52em" { (picture(map::svg(map, &title))) }
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

/// Zero instead of what rounding has left of it.
fn tidy(x: f64, size: f64) -> f64 {
    if x.abs() < 1e-9 * size { 0.0 } else { x }
}

fn rooms(f: &Findings) -> Markup {
    let size = f.bodies.assembly().size();
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    let directions = f.matrix.directions();
    let cell = |room: &PartRoom| match room {
        PartRoom::Free => "free".into(),
        PartRoom::Overlapping { by, .. } => format!("overlaps {}", name(*by)),
        PartRoom::Blocked { by, stop, .. } => {
            format!("{} {}", short(tidy(stop.distance(), size)), name(*by))
        }
    };
    html! {
        h2 { "Rooms" }
        p { "How far each part can move before another stops it, with all parts in place." }
        div.wide {
            table {
                tr { th { "part" } @for d in directions { th { (arrow(*d)) } } }
                @for part in 0..f.bodies.len().min(MOST_ROWS) {
                    tr {
                        th { (name(part)) }
                        @for room in (0..directions.len()).map(|k| f.matrix.room(k, part)) {
                            td class=(room.outcome()) { (cell(&room)) }
                        }
                    }
                }
            }
        }
    }
}

fn graphs(f: &Findings) -> Markup {
    let most = 60;
    if f.bodies.is_empty() || f.bodies.len() > most {
        return Markup::default();
    }
    let all = vec![true; f.bodies.len()];
    let graph = |k: usize| graph::svg(f.bodies, &Blocking::new(f.matrix, k, &all));
    let origin = |k: usize| f.candidates.get(k).map_or("", |c| c.origin.name());
    html! {
        h2 { "Blocking graphs" }
        p {
            "An arrow from a part to each one that it meets. Orange: comes out as it is, alone or with \
             its group; red rings and arrows: moves as one."
        }
        div.steps.graphs {
            @for (k, d) in f.matrix.directions().iter().enumerate().take(MOST_GRAPHS) {
                figure {
                    (picture(graph(k)))
                    figcaption { (arrow(*d)) " (" (origin(k)) ")" }
                }
            }
        }
    }
}

fn contacts(f: &Findings) -> Markup {
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    let size = f.bodies.assembly().size();
    html! {
        h2 { "Contacts" }
        @if f.liaisons.is_empty() {
            p { "None." }
        } @else {
            table {
                tr { th { "parts" } th { "area" } th { "around" } }
                @for l in f.liaisons.iter().take(MOST_ROWS) {
                    tr {
                        td { (name(l.parts[0])) ", " (name(l.parts[1])) }
                        td.n { (short(l.area())) }
                        td { (l.center().to_array().map(|x| short(tidy(x, size))).join(", ")) }
                    }
                }
            }
        }
    }
}

fn parts(f: &Findings) -> Markup {
    let remarks = |k: usize, p: &Part| {
        let fixed = p.fixed().then(|| "fixed".to_owned());
        let all: Vec<String> =
            p.defects().iter().cloned().chain(f.bodies.remark(k)).chain(fixed).collect();
        all.join("; ")
    };
    html! {
        h2 { "Parts" }
        table {
            tr { th { "part" } th { "facets" } th { "volume" } th { "remarks" } }
            @for (k, p) in f.bodies.assembly().parts().iter().enumerate().take(MOST_ROWS) {
                tr {
                    td { (p.name()) }
                    td.n { (p.facets()) }
                    td.n { (short(p.solid().volume())) }
                    td { (remarks(k, p)) }
                }
            }
        }
    }
}
