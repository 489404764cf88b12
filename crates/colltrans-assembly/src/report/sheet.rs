//! A page for each stage: a step, or several steps that are one task for the worker.

use std::collections::BTreeSet;
use std::ops::Range;

use colltrans::Aabb;
use glam::{DVec2, DVec3};
use maud::{Markup, html};

use super::scene::{Arrow, Look, Scene, Shown, Viewpoint};
use super::words::{number_runs, sentence, time_text};
use super::{Report, picture_markup, present_parts};
use crate::Fit;
use crate::identical::group_identical_pairs;
use crate::plan::ToleratedContact;
use crate::plan::{Leg, Step};

/// Size of the picture of a stage in pixels.
const SIZE: DVec2 = DVec2::new(760.0, 580.0);
/// Size of the picture of one of several moves in pixels.
const SMALL: DVec2 = DVec2::new(400.0, 300.0);
/// Maximum number of arrows for equal parts; more would hide the parts.
const MAX_ARROWS: usize = 12;
/// Maximum number of drawn moves of a step.
const MAX_FRAMES: usize = 9;
/// Minimum and maximum displacement of moving parts in a picture, as shares of the assembly's size.
const DRAWN_TRAVEL: [f64; 2] = [0.12, 0.5];
/// Maximum number of named pairs.
const MAX_PAIRS: usize = 6;

/// Returns the page of stages that repeat the same work. Only the first one is drawn.
pub(super) fn step_page(r: &Report, repeats: &[&Range<usize>]) -> Markup {
    let stage = repeats[0];
    let steps = &r.f.plan.steps[stage.clone()];
    let all: Vec<usize> = stage.clone().collect();
    let head = if stage.len() == 1 { "Step" } else { "Steps" };
    let all_steps: Vec<Step> =
        repeats.iter().flat_map(|stage| r.f.plan.steps[(*stage).clone()].to_vec()).collect();
    html! {
        section.sheet.step id=(format!("step-{}", stage.start + 1)) {
            h2 { (head) " " (number_runs(&all)) ": " (action_text(r, stage)) }
            @if let Some(within) = steps[0].group_step {
                p.soft { "On the bench, from what step " (within + 1) " took out: " (r.words.group_text(&r.f.plan.steps[within].parts)) "." }
            }
            @if steps[0].path.len() > 1 { (move_pictures(r, stage.start)) } @else { (stage_picture(r, stage)) }
            (stage_facts(r, stage))
            (repeats_section(r, &repeats[1..]))
            (stability_warnings(r, &all_steps))
            (proof_section(r, &all_steps))
        }
    }
}

/// Returns the list of stages that repeat the same work.
fn repeats_section(r: &Report, others: &[&Range<usize>]) -> Markup {
    html! {
        @if !others.is_empty() {
            p { b { (others.len() + 1) " ×, " } "the others in their order, with the steps between:" }
            ul {
                @for stage in others {
                    @let all: Vec<usize> = (*stage).clone().collect();
                    @let travel = travel_text(r, &r.f.plan.steps[(*stage).clone()]);
                    li {
                        (step_list(&all)) ": " (taken_parts_text(r, stage)) ", " (direction_text(r, stage, 1.0))
                        @if let Some(travel) = travel { ", " (travel) }
                    }
                }
            }
        }
    }
}

/// Describes the action of a stage: `take out base`, `unscrew M5 x 20 (m5x20_1)`.
fn action_text(r: &Report, stage: &Range<usize>) -> String {
    match r.f.plan.describe_fasteners(r.f.bodies.assembly(), stage) {
        Some(text) if r.f.plan.is_unscrewed(stage) => text,
        Some(text) => format!("take out {text}"),
        None => format!("take out {}", taken_parts_text(r, stage)),
    }
}

/// Describes the parts that a stage removes.
pub(super) fn taken_parts_text(r: &Report, stage: &Range<usize>) -> String {
    let steps = &r.f.plan.steps[stage.clone()];
    match steps {
        [step] => {
            let named = r.f.bodies.assembly().constraints().group_name(&step.parts).is_some();
            let as_one = if named || step.parts.len() == 1 { "" } else { ", as one" };
            r.words.group_text(&step.parts) + as_one
        }
        _ => r.words.count_text(&moved_parts(steps)),
    }
}

/// Returns the parts that some steps remove.
fn moved_parts(steps: &[Step]) -> Vec<usize> {
    steps.iter().flat_map(|step| step.parts.iter().copied()).collect()
}

/// Returns the picture of a stage: the remaining parts pale, the moving parts in colour, displaced along
/// their directions.
fn stage_picture(r: &Report, stage: &Range<usize>) -> Markup {
    let steps = &r.f.plan.steps[stage.clone()];
    let travel = r.f.plan.stage_travel(stage);
    let out = drawn_travel(r, travel);
    let moving = moved_parts(steps);
    let by = |part: usize| {
        let own = steps.iter().find(|step| step.parts.contains(&part));
        own.map_or(DVec3::ZERO, |step| step.direction * out)
    };
    let mut scene = Scene {
        size: SIZE,
        shown: shown_parts(r, stage.start, &moving, by),
        arrows: steps
            .iter()
            .step_by(steps.len().div_ceil(MAX_ARROWS))
            .map(|step| move_arrow(r, &step.parts, DVec3::ZERO, step.direction * out))
            .collect(),
        traces: Vec::new(),
        numbers: Vec::new(),
        label: format!(
            "{} moves {}; moving parts in colour, other parts pale",
            taken_parts_text(r, stage),
            match r.f.plan.stage_direction(stage) {
                Some(_) => r.words.move_text(&steps[0].path[0]),
                None => direction_text(r, stage, 1.0),
            }
        ),
    };
    if r.words.is_significant(travel) {
        scene.arrows[0].label = r.words.length_text(travel);
    }
    let groups: Vec<Vec<usize>> = steps.iter().map(|step| step.parts.clone()).collect();
    let viewpoint = r.studio.choose_viewpoint(&mut scene, &groups);
    html! {
        figure {
            (picture_markup(r.studio.draw_picture(&scene, viewpoint)))
            (caption(r, &scene, viewpoint, "", (moving.len() > 1).then(|| r.words.name_list(&moving))))
        }
    }
}

/// Returns a picture for each move of a step, with all parts displaced by the earlier moves.
fn move_pictures(r: &Report, at: usize) -> Markup {
    let step = &r.f.plan.steps[at];
    let mut by = vec![DVec3::ZERO; r.f.bodies.len()];
    let mut figures = Vec::new();
    for (k, leg) in step.path.iter().enumerate().take(MAX_FRAMES) {
        let is_last = k + 1 == step.path.len();
        let out = leg.direction * if is_last { drawn_travel(r, leg.travel) } else { leg.travel };
        let before = by[leg.parts[0]];
        leg.parts.iter().for_each(|&part| by[part] += out);
        let mut scene = Scene {
            size: SMALL,
            shown: shown_parts(r, at, &leg.parts, |part| by[part]),
            arrows: vec![move_arrow(r, &leg.parts, before, out)],
            traces: Vec::new(),
            numbers: Vec::new(),
            label: format!(
                "Move {} of {}: {} {}",
                k + 1,
                step.path.len(),
                r.words.name_list(&leg.parts),
                r.words.move_text(leg)
            ),
        };
        let viewpoint = r.studio.choose_viewpoint(&mut scene, std::slice::from_ref(&leg.parts));
        let description =
            format!("{}. {}: {}. ", k + 1, r.words.name_list(&leg.parts), r.words.move_text(leg));
        figures.push(html! {
            figure {
                (picture_markup(r.studio.draw_picture(&scene, viewpoint)))
                (caption(r, &scene, viewpoint, &description, None))
            }
        });
    }
    html! {
        div.frames { @for figure in figures { (figure) } }
        @if step.path.len() > MAX_FRAMES {
            ol start=(MAX_FRAMES + 1) { @for leg in &step.path[MAX_FRAMES..] { (leg_item(r, leg)) } }
        }
        @if !step.return_legs.is_empty() {
            p { "Then back to its place:" }
            ol { @for leg in &step.return_legs { (leg_item(r, leg)) } }
        }
    }
}

/// Returns a list item that describes a move.
fn leg_item(r: &Report, leg: &Leg) -> Markup {
    html! { li { (r.words.name_list(&leg.parts)) ": " (r.words.move_text(leg)) } }
}

/// Returns the caption of a picture: a description, names, the viewpoint, and the parts drawn as glass.
fn caption(
    r: &Report,
    scene: &Scene,
    viewpoint: Viewpoint,
    description: &str,
    names: Option<String>,
) -> Markup {
    let glass: Vec<usize> =
        scene.shown.iter().filter(|s| s.look == Look::Glass).map(|s| s.part).collect();
    html! {
        figcaption {
            (description)
            @if let Some(names) = names { (names) ". " }
            @if !viewpoint.name.is_empty() { "Seen " (viewpoint.name) ". " }
            @if !glass.is_empty() { "Drawn as glass: " (r.words.name_list(&glass)) "." }
        }
    }
}

/// Returns the displacement in a picture of parts that move by `travel`: half of it, within [`DRAWN_TRAVEL`].
fn drawn_travel(r: &Report, travel: f64) -> f64 {
    let [least, most] = DRAWN_TRAVEL.map(|share| share * r.diagonal);
    (0.5 * travel).clamp(least, most)
}

/// Returns the parts that are present before a step, with their displacements and styles.
fn shown_parts(
    r: &Report,
    step: usize,
    moving: &[usize],
    by: impl Fn(usize) -> DVec3,
) -> Vec<Shown> {
    let look = |part: usize| if moving.contains(&part) { Look::Moving } else { Look::Pale };
    present_parts(r.f, step).map(|part| Shown { part, by: by(part), look: look(part) }).collect()
}

/// Returns an arrow from the middle of the moving parts to a point beyond their drawn position.
fn move_arrow(r: &Report, parts: &[usize], before: DVec3, out: DVec3) -> Arrow {
    let boxes = parts.iter().map(|&part| r.f.bodies.bounds(part));
    let Aabb { low, high } = boxes.reduce(|a, b| a.union(&b)).expect("something moves");
    let from = low.midpoint(high) + before;
    let beyond = out.normalize_or_zero() * 0.1 * r.diagonal;
    Arrow { from, to: from + out + beyond, label: String::new() }
}

/// Returns the list of facts about a stage: direction, travel, needed steps, round and time.
fn stage_facts(r: &Report, stage: &Range<usize>) -> Markup {
    let steps = &r.f.plan.steps[stage.clone()];
    let step = &steps[0];
    let after: Vec<usize> =
        steps.iter().flat_map(|step| step.predecessors.iter().copied()).collect();
    let rounds: Vec<usize> = stage.clone().map(|k| r.rounds[k]).collect();
    html! {
        dl.facts {
            @if step.path.len() == 1 {
                div { dt { "Direction" } dd { (direction_text(r, stage, 1.0)) } }
                div {
                    dt { "Travel until clear" }
                    dd { (travel_text(r, steps).unwrap_or_else(|| "nothing in the way: just take it off".into())) }
                }
            } @else {
                div { dt { "Moves" } dd { (step.path.len()) @if !step.return_legs.is_empty() { ", and " (step.return_legs.len()) " back" } } }
            }
            @for turns in r.f.plan.describe_unscrewing(stage, |turns| turns.describe(|x| r.words.length_text(x))) {
                div { dt { "Thread" } dd { (sentence(&turns)) } }
            }
            @for tool in r.f.plan.describe_tools(r.f.bodies.assembly(), stage) {
                div { dt { "Reach" } dd { (sentence(&tool)) } }
            }
            @for reason in r.f.plan.unproven_reasons(r.f.bodies, stage, |parts| r.words.name_list(parts)) {
                div { dt { "Not proven, because" } dd { (reason) } }
            }
            div { dt { "Needs" } dd { @if after.is_empty() { "no earlier step" } @else { (step_list(&after)) } } }
            div { dt { "Round" } dd { (number_runs(&rounds)) " of " (r.rounds.iter().max().map_or(0, |k| k + 1)) } }
            div { dt { "Time, about" } dd { (time_text(r.seconds[stage.clone()].iter().sum())) } }
        }
    }
}

/// Describes the direction of a stage, multiplied by `sign`.
pub(super) fn direction_text(r: &Report, stage: &Range<usize>, sign: f64) -> String {
    match r.f.plan.stage_direction(stage) {
        Some(d) => r.words.direction_text(d * sign + DVec3::ZERO),
        None => "each along its own path, as drawn".into(),
    }
}

/// Describes the travel of the parts of a stage; `None` if no part is in the way.
pub(super) fn travel_text(r: &Report, steps: &[Step]) -> Option<String> {
    let all = steps.iter().map(|step| step.travel.value);
    let (least, most) = all.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    let [least, most, each] = match steps.len() {
        1 => [r.words.length_text(most), r.words.length_text(most), String::new()],
        _ => [r.words.length_text(least), r.words.length_text(most), " each".into()],
    };
    let text = if least == most { most + &each } else { format!("{least} to {most}") };
    steps.iter().any(|step| r.words.is_significant(step.travel.value)).then_some(text)
}

/// Returns "step 3" or "steps 1–4, 6".
pub(super) fn step_list(steps: &[usize]) -> String {
    let one = steps.iter().all(|step| *step == steps[0]);
    format!("{} {}", if one { "step" } else { "steps" }, number_runs(steps))
}

/// Returns warnings about parts that fall or may tip over after the steps.
fn stability_warnings(r: &Report, steps: &[Step]) -> Markup {
    let falls: Vec<usize> = steps.iter().flat_map(|step| step.falling.iter().copied()).collect();
    let tips: Vec<usize> = steps.iter().flat_map(|step| step.off_balance.iter().copied()).collect();
    html! {
        @if !falls.is_empty() {
            @let them = if falls.len() == 1 { "it" } else { "them" };
            p.warn { b { "Hold " (r.words.name_list(&falls)) ":" } " then no remaining part supports " (them) "." }
        }
        @if !tips.is_empty() {
            @let [their, them, they] = if tips.len() == 1 { ["its", "it", "it"] } else { ["their", "them", "they"] };
            p.warn {
                b { "Steady " (r.words.name_list(&tips)) ":" }
                " then " (their) " weight is not above what supports " (them) ", and " (they) " may tip over."
            }
        }
    }
}

/// Returns the proven claims about the steps, and the exceptions.
fn proof_section(r: &Report, steps: &[Step]) -> Markup {
    let (f, words) = (r.f, &r.words);
    let mut surfaces: Vec<usize> = steps.iter().flat_map(|s| s.surfaces.iter().copied()).collect();
    surfaces.sort_unstable();
    surfaces.dedup();
    let ignored: Vec<[usize; 2]> = steps.iter().flat_map(|s| s.ignored.iter().copied()).collect();
    let passed: Vec<ToleratedContact> =
        steps.iter().flat_map(|step| step.tolerated.iter().copied()).collect();
    let passed = passed_texts(r, &passed);
    let turns = steps.iter().flat_map(|step| &step.path).filter_map(|leg| leg.turn.as_ref());
    let unproven: BTreeSet<&String> =
        turns.clone().filter_map(|turn| turn.proof.as_ref().err()).collect();
    let threads: BTreeSet<String> = turns
        .filter_map(|turn| turn.proof.as_ref().ok())
        .map(|proof| words.length_text(proof.tolerance))
        .collect();
    let plain = surfaces.is_empty() && ignored.is_empty() && unproven.is_empty();
    let claim = match (steps, steps[0].path.len()) {
        _ if !unproven.is_empty() => "straight moves meet no part".to_owned(),
        ([_], 1) => "this move meets no remaining part".to_owned(),
        (_, 1) => "none of these moves meets a remaining part".to_owned(),
        (_, moves) => format!("none of the {moves} moves meets another part"),
    };
    let plain_only = plain && passed.is_empty() && threads.is_empty();
    let class = if plain_only { "proof" } else { "partly" };
    html! {
        div class=(class) {
            b { @if plain { "Proven: " } @else { "Proven, with these exceptions: " } }
            (claim) (fit_text(r)) "."
            @if !plain_only {
                ul {
                    @for why in &unproven {
                        li { b { "Not proven that it can be turned this way: " } (why) "." }
                    }
                    @for length in &threads {
                        li { "Turning is proven with both sides of the thread together " (length) " thinner." }
                    }
                    @for text in &passed { li { (text) } }
                    @if !surfaces.is_empty() {
                        li {
                            b { "Rests on open surfaces: " } (words.name_list(&surfaces))
                            ". No surface is crossed; their interior is unknown."
                        }
                    }
                    @if !ignored.is_empty() {
                        li {
                            b { "Not checked, as requested: " }
                            "overlaps at the start of "
                            (pair_list(&ignored, |pair| f.bodies.assembly().part_names(pair).join(" and "))) "."
                        }
                    }
                }
            }
        }
    }
}

/// Describes the fit for which the proof holds.
fn fit_text(r: &Report) -> String {
    let assembly = r.f.bodies.assembly();
    match r.f.bodies.fit() {
        Fit::Tolerance(length) if length <= 1.001 * Fit::digits(assembly) => {
            ", with the parts as drawn, to the last digits of the files".into()
        }
        Fit::Tolerance(length) => format!(
            ", with a tolerance of {}: each part is {} thinner on all sides",
            r.words.length_text(length),
            r.words.length_text(length / 2.0)
        ),
        Fit::Chords { largest, .. } => {
            format!(
                ", with tolerances by the chord errors of the parts, {} at most",
                r.words.length_text(largest)
            )
        }
        Fit::MinGap(length) => {
            format!(", and keeps a gap of {} to all others", r.words.length_text(length))
        }
    }
}

/// Describes the tolerated contacts of pairs with a fit of their own, equal pairs together.
pub(super) fn passed_texts(r: &Report, all: &[ToleratedContact]) -> Vec<String> {
    let text = |passed: &ToleratedContact| passed.tolerated.describe(passed.role);
    pair_texts(r, all.iter().map(|passed| (passed.parts, text(passed), text(passed))))
}

/// Describes pairs, for example "8 × bolt and plate: ...". Pairs of parts of the same shapes with the same
/// key are merged under the text of the first one.
pub(super) fn pair_texts<K: Ord>(
    r: &Report,
    all: impl Iterator<Item = ([usize; 2], K, String)>,
) -> Vec<String> {
    let text = |(description, sides): (String, [Vec<usize>; 2])| {
        let [a, b] = sides.map(|side| r.words.count_text(&side));
        format!("{a} and {b}: {description}")
    };
    group_identical_pairs(&r.f.plan.first_identical, all).into_iter().map(text).collect()
}

/// Joins the descriptions of pairs; beyond [`MAX_PAIRS`], states the number of further pairs.
fn pair_list(all: &[[usize; 2]], words: impl Fn(&[usize; 2]) -> String) -> String {
    let named: Vec<String> = all.iter().take(MAX_PAIRS).map(words).collect();
    match all.len().saturating_sub(MAX_PAIRS) {
        0 => named.join(", "),
        more => format!("{} and {more} more pairs", named.join(", ")),
    }
}
