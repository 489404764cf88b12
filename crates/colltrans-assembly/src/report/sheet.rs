//! A page for each step, or for steps that are one for whoever does them.

use std::collections::BTreeSet;
use std::ops::Range;

use colltrans::Aabb;
use glam::{DVec2, DVec3};
use maud::{Markup, html};

use super::scene::{Arrow, Look, Scene, Shown, Viewpoint};
use super::words::{numbers, time};
use super::{Report, picture, there};
use crate::Fit;
use crate::likes::pairs_alike;
use crate::plan::Passed;
use crate::plan::{Leg, Step};

const SIZE: DVec2 = DVec2::new(760.0, 580.0);
/// Of a picture of one move of several.
const SMALL: DVec2 = DVec2::new(400.0, 300.0);
/// Of parts that are alike so many have an arrow at most: more would hide them.
const MOST_ARROWS: usize = 12;
/// Moves are drawn up to so many of a step.
const MOST_FRAMES: usize = 9;
/// How far out what moves is drawn, as shares of the assembly's size, at least and at most.
const OUT: [f64; 2] = [0.12, 0.5];
/// Pairs are named up to so many.
const MOST_PAIRS: usize = 6;

/// Of stages that are the same work elsewhere, of which the first is drawn.
pub(super) fn page(r: &Report, again: &[&Range<usize>]) -> Markup {
    let stage = again[0];
    let steps = &r.f.plan.steps[stage.clone()];
    let all: Vec<usize> = stage.clone().collect();
    let head = if stage.len() == 1 { "Step" } else { "Steps" };
    let told: Vec<Step> =
        again.iter().flat_map(|stage| r.f.plan.steps[(*stage).clone()].to_vec()).collect();
    html! {
        section.sheet.step id=(format!("step-{}", stage.start + 1)) {
            h2 { (head) " " (numbers(&all)) ": take out " (takes(r, stage)) }
            @if let Some(within) = steps[0].within {
                p.soft { "On the bench, from what step " (within + 1) " took out: " (r.words.group(&r.f.plan.steps[within].parts)) "." }
            }
            @if steps[0].path.len() > 1 { (frames(r, stage.start)) } @else { (one_picture(r, stage)) }
            (facts(r, stage))
            (likewise(r, &again[1..]))
            (warnings(r, &told))
            (proof(r, &told))
        }
    }
}

/// The same work elsewhere, which is not drawn.
fn likewise(r: &Report, others: &[&Range<usize>]) -> Markup {
    html! {
        @if !others.is_empty() {
            p { b { (others.len() + 1) " ×, " } "the others in their turn, with the steps between:" }
            ul {
                @for stage in others {
                    @let all: Vec<usize> = (*stage).clone().collect();
                    @let far = far(r, &r.f.plan.steps[(*stage).clone()]);
                    li {
                        (step_words(&all)) ": " (takes(r, stage)) ", " (ways(r, stage, 1.0))
                        @if let Some(far) = far { ", " (far) }
                    }
                }
            }
        }
    }
}

/// What a stage takes away, in a few words.
pub(super) fn takes(r: &Report, stage: &Range<usize>) -> String {
    let steps = &r.f.plan.steps[stage.clone()];
    match steps {
        [step] => {
            let named = r.f.bodies.assembly().constraints().name(&step.parts).is_some();
            let as_one = if named || step.parts.len() == 1 { "" } else { ", as one" };
            r.words.group(&step.parts) + as_one
        }
        _ => r.words.count(&parts(steps)),
    }
}

fn parts(steps: &[Step]) -> Vec<usize> {
    steps.iter().flat_map(|step| step.parts.iter().copied()).collect()
}

/// What is left, pale, and what moves, on its way out.
fn one_picture(r: &Report, stage: &Range<usize>) -> Markup {
    let steps = &r.f.plan.steps[stage.clone()];
    let travel = r.f.plan.travel(stage);
    let out = drawn_out(r, travel);
    let moving = parts(steps);
    let by = |part: usize| {
        let own = steps.iter().find(|step| step.parts.contains(&part));
        own.map_or(DVec3::ZERO, |step| step.direction * out)
    };
    let mut scene = Scene {
        size: SIZE,
        shown: shown(r, stage.start, &moving, by),
        arrows: steps
            .iter()
            .step_by(steps.len().div_ceil(MOST_ARROWS))
            .map(|step| arrow(r, &step.parts, DVec3::ZERO, step.direction * out))
            .collect(),
        traces: Vec::new(),
        numbers: Vec::new(),
        label: format!(
            "{} moves {}; it is drawn in colour, what stays is pale",
            takes(r, stage),
            match r.f.plan.direction(stage) {
                Some(_) => r.words.leg(&steps[0].path[0]),
                None => ways(r, stage, 1.0),
            }
        ),
    };
    if r.words.is_far(travel) {
        scene.arrows[0].label = r.words.length(travel);
    }
    let groups: Vec<Vec<usize>> = steps.iter().map(|step| step.parts.clone()).collect();
    let viewpoint = r.studio.arrange(&mut scene, &groups);
    html! {
        figure {
            (picture(r.studio.picture(&scene, viewpoint)))
            (caption(r, &scene, viewpoint, "", (moving.len() > 1).then(|| r.words.names(&moving))))
        }
    }
}

/// A picture for each move, with everything where the moves before have left it.
fn frames(r: &Report, at: usize) -> Markup {
    let step = &r.f.plan.steps[at];
    let mut by = vec![DVec3::ZERO; r.f.bodies.len()];
    let mut figures = Vec::new();
    for (k, leg) in step.path.iter().enumerate().take(MOST_FRAMES) {
        let is_last = k + 1 == step.path.len();
        let out = leg.direction * if is_last { drawn_out(r, leg.travel) } else { leg.travel };
        let before = by[leg.parts[0]];
        leg.parts.iter().for_each(|&part| by[part] += out);
        let mut scene = Scene {
            size: SMALL,
            shown: shown(r, at, &leg.parts, |part| by[part]),
            arrows: vec![arrow(r, &leg.parts, before, out)],
            traces: Vec::new(),
            numbers: Vec::new(),
            label: format!(
                "Move {} of {}: {} {}",
                k + 1,
                step.path.len(),
                r.words.names(&leg.parts),
                r.words.leg(leg)
            ),
        };
        let viewpoint = r.studio.arrange(&mut scene, std::slice::from_ref(&leg.parts));
        let said = format!("{}. {}: {}. ", k + 1, r.words.names(&leg.parts), r.words.leg(leg));
        figures.push(html! {
            figure {
                (picture(r.studio.picture(&scene, viewpoint)))
                (caption(r, &scene, viewpoint, &said, None))
            }
        });
    }
    html! {
        div.frames { @for figure in figures { (figure) } }
        @if step.path.len() > MOST_FRAMES {
            ol start=(MOST_FRAMES + 1) { @for leg in &step.path[MOST_FRAMES..] { (leg_item(r, leg)) } }
        }
        @if !step.back.is_empty() {
            p { "Then back to its place:" }
            ol { @for leg in &step.back { (leg_item(r, leg)) } }
        }
    }
}

fn leg_item(r: &Report, leg: &Leg) -> Markup {
    html! { li { (r.words.names(&leg.parts)) ": " (r.words.leg(leg)) } }
}

fn caption(
    r: &Report,
    scene: &Scene,
    viewpoint: Viewpoint,
    said: &str,
    names: Option<String>,
) -> Markup {
    let glass: Vec<usize> =
        scene.shown.iter().filter(|s| s.look == Look::Glass).map(|s| s.part).collect();
    html! {
        figcaption {
            (said)
            @if let Some(names) = names { (names) ". " }
            @if !viewpoint.name.is_empty() { "Seen " (viewpoint.name) ". " }
            @if !glass.is_empty() { "Drawn as glass: " (r.words.names(&glass)) "." }
        }
    }
}

/// How far out what has to go by a travel is drawn.
fn drawn_out(r: &Report, travel: f64) -> f64 {
    let [least, most] = OUT.map(|share| share * r.diagonal);
    (0.5 * travel).clamp(least, most)
}

fn shown(r: &Report, step: usize, moving: &[usize], by: impl Fn(usize) -> DVec3) -> Vec<Shown> {
    let look = |part: usize| if moving.contains(&part) { Look::Moving } else { Look::Pale };
    there(r.f, step).map(|part| Shown { part, by: by(part), look: look(part) }).collect()
}

/// From the middle of what moves, and beyond where it is drawn.
fn arrow(r: &Report, parts: &[usize], before: DVec3, out: DVec3) -> Arrow {
    let boxes = parts.iter().map(|&part| r.f.bodies.bounds(part));
    let Aabb { low, high } = boxes.reduce(|a, b| a.join(&b)).expect("something moves");
    let from = low.midpoint(high) + before;
    let beyond = out.normalize_or_zero() * 0.1 * r.diagonal;
    Arrow { from, to: from + out + beyond, label: String::new() }
}

fn facts(r: &Report, stage: &Range<usize>) -> Markup {
    let steps = &r.f.plan.steps[stage.clone()];
    let step = &steps[0];
    let after: Vec<usize> = steps.iter().flat_map(|step| step.after.iter().copied()).collect();
    let rounds: Vec<usize> = stage.clone().map(|k| r.rounds[k]).collect();
    html! {
        dl.facts {
            @if step.path.len() == 1 {
                div { dt { "Where to" } dd { (ways(r, stage, 1.0)) } }
                div {
                    dt { "How far until it is clear" }
                    dd { (far(r, steps).unwrap_or_else(|| "nothing to pass: just take it off".into())) }
                }
            } @else {
                div { dt { "Moves" } dd { (step.path.len()) @if !step.back.is_empty() { ", and " (step.back.len()) " back" } } }
            }
            div { dt { "Needs" } dd { @if after.is_empty() { "nothing before it" } @else { (step_words(&after)) } } }
            div { dt { "Round" } dd { (numbers(&rounds)) " of " (r.rounds.iter().max().map_or(0, |k| k + 1)) } }
            div { dt { "Time, about" } dd { (time(r.seconds[stage.clone()].iter().sum())) } }
        }
    }
}

/// Where the parts of a stage go, or with -1 where they come from.
pub(super) fn ways(r: &Report, stage: &Range<usize>, sign: f64) -> String {
    match r.f.plan.direction(stage) {
        Some(d) => r.words.way(d * sign + DVec3::ZERO),
        None => "each along its own way, as it is drawn".into(),
    }
}

/// How far the parts of a stage have to go; `None` if there is nothing to pass.
pub(super) fn far(r: &Report, steps: &[Step]) -> Option<String> {
    let all = steps.iter().map(|step| step.travel.value);
    let (least, most) = all.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    let [least, most, each] = match steps.len() {
        1 => [r.words.length(most), r.words.length(most), String::new()],
        _ => [r.words.length(least), r.words.length(most), " each".into()],
    };
    let told = if least == most { most + &each } else { format!("{least} to {most}") };
    steps.iter().any(|step| r.words.is_far(step.travel.value)).then_some(told)
}

pub(super) fn step_words(steps: &[usize]) -> String {
    let one = steps.iter().all(|step| *step == steps[0]);
    format!("{} {}", if one { "step" } else { "steps" }, numbers(steps))
}

/// What is no longer carried afterwards.
fn warnings(r: &Report, steps: &[Step]) -> Markup {
    let falls: Vec<usize> = steps.iter().flat_map(|step| step.falls.iter().copied()).collect();
    let tips: Vec<usize> = steps.iter().flat_map(|step| step.off_balance.iter().copied()).collect();
    html! {
        @if !falls.is_empty() {
            @let them = if falls.len() == 1 { "it" } else { "them" };
            p.warn { b { "Hold " (r.words.names(&falls)) ":" } " then nothing that is left carries " (them) "." }
        }
        @if !tips.is_empty() {
            @let [their, them, they] = if tips.len() == 1 { ["its", "it", "it"] } else { ["their", "them", "they"] };
            p.warn {
                b { "Steady " (r.words.names(&tips)) ":" }
                " then " (their) " weight is beside what carries " (them) ", and " (they) " may tip over."
            }
        }
    }
}

/// What is behind a step: a proof, and what that does not speak of.
fn proof(r: &Report, steps: &[Step]) -> Markup {
    let (f, words) = (r.f, &r.words);
    let mut surfaces: Vec<usize> = steps.iter().flat_map(|s| s.surfaces.iter().copied()).collect();
    surfaces.sort_unstable();
    surfaces.dedup();
    let ignored: Vec<[usize; 2]> = steps.iter().flat_map(|s| s.ignored.iter().copied()).collect();
    let passed: Vec<Passed> = steps.iter().flat_map(|step| step.passed.iter().copied()).collect();
    let passed = told(r, &passed);
    let turns = steps.iter().flat_map(|step| &step.path).filter_map(|leg| leg.turn.as_ref());
    let unproven: BTreeSet<&String> =
        turns.clone().filter_map(|turn| turn.proof.as_ref().err()).collect();
    let threads: BTreeSet<String> = turns
        .filter_map(|turn| turn.proof.as_ref().ok())
        .map(|proof| words.length(proof.tolerance))
        .collect();
    let plain = surfaces.is_empty() && ignored.is_empty() && unproven.is_empty();
    let way = match (steps, steps[0].path.len()) {
        _ if !unproven.is_empty() => "no straight move meets anything".to_owned(),
        ([_], 1) => "this way meets nothing that is left".to_owned(),
        (_, 1) => "none of them meets anything that is left on its way".to_owned(),
        (_, moves) => format!("none of the {moves} moves meets anything"),
    };
    let plain_only = plain && passed.is_empty() && threads.is_empty();
    let class = if plain_only { "proof" } else { "partly" };
    html! {
        div class=(class) {
            b { @if plain { "Proven: " } @else { "Proven, as far as said below: " } }
            (way) (fit(r)) "."
            @if !plain_only {
                ul {
                    @for why in &unproven {
                        li { b { "That it can be turned so is not proven: " } (why) "." }
                    }
                    @for length in &threads {
                        li { "Turning is proven with the sides of the thread " (length) " thinner together." }
                    }
                    @for said in &passed { li { (said) } }
                    @if !surfaces.is_empty() {
                        li {
                            b { "Rests on open surfaces: " } (words.names(&surfaces))
                            ". No surface is crossed; what would be inside of them is not known."
                        }
                    }
                    @if !ignored.is_empty() {
                        li {
                            b { "Not looked at, as was asked: " }
                            "where they are drawn into each other, "
                            (pairs(&ignored, |pair| f.bodies.assembly().names(pair).join(" and "))) "."
                        }
                    }
                }
            }
        }
    }
}

/// With which fit that is so.
fn fit(r: &Report) -> String {
    let assembly = r.f.bodies.assembly();
    match r.f.bodies.fit() {
        Fit::Tolerance(length) if length <= 1.001 * Fit::digits(assembly) => {
            ", with the parts as they are drawn, to the file's last digits".into()
        }
        Fit::Tolerance(length) => format!(
            ", with a tolerance of {}: each part is taken {} thinner all around",
            r.words.length(length),
            r.words.length(length / 2.0)
        ),
        Fit::Chords { largest, .. } => {
            format!(
                ", with tolerances by the chord errors of the parts, {} at most",
                r.words.length(largest)
            )
        }
        Fit::Apart(length) => format!(", and stays {} away from all of it", r.words.length(length)),
    }
}

/// What is let pass of pairs with a fit of their own, like ones together.
pub(super) fn told(r: &Report, all: &[Passed]) -> Vec<String> {
    let said = |passed: &Passed| passed.tolerated.words(passed.role);
    alike(r, all.iter().map(|passed| (passed.parts, said(passed), said(passed))))
}

/// What is said of pairs, as "8 × bolt and plate: ...", those of the same shapes and with the same key together: the
/// words of the first one.
pub(super) fn alike<K: Ord>(
    r: &Report,
    all: impl Iterator<Item = ([usize; 2], K, String)>,
) -> Vec<String> {
    let told = |(said, sides): (String, [Vec<usize>; 2])| {
        let [a, b] = sides.map(|side| r.words.count(&side));
        format!("{a} and {b}: {said}")
    };
    pairs_alike(&r.f.plan.likes, all).into_iter().map(told).collect()
}

/// Pairs in words, of many the first ones.
fn pairs(all: &[[usize; 2]], words: impl Fn(&[usize; 2]) -> String) -> String {
    let named: Vec<String> = all.iter().take(MOST_PAIRS).map(words).collect();
    match all.len().saturating_sub(MOST_PAIRS) {
        0 => named.join(", "),
        more => format!("{} and {more} more pairs", named.join(", ")),
    }
}
