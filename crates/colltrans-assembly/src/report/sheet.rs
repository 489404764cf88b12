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
/// Size of the picture of the place of moving parts in pixels.
const PLACE: DVec2 = DVec2::new(180.0, 130.0);
/// Maximum number of like pages that are printed on one sheet of paper.
const MAX_ON_SHEET: usize = 4;
/// Maximum number of arrows for equal parts; more would hide the parts.
const MAX_ARROWS: usize = 12;
/// Maximum number of drawn moves of a step.
const MAX_FRAMES: usize = 9;
/// Minimum and maximum displacement of moving parts in a picture, as shares of the assembly's size.
const DRAWN_TRAVEL: [f64; 2] = [0.12, 0.5];
/// Maximum number of named pairs.
const MAX_PAIRS: usize = 6;

/// Returns the page of stages that repeat the same work, the first one in the order of the document first. Only the
/// first one is drawn.
pub(super) fn step_page(r: &Report, repeats: &[&Range<usize>]) -> Markup {
    let stage = repeats[0];
    let steps = &r.f.plan.steps[stage.clone()];
    let all: Vec<usize> = stage.clone().collect();
    let head = if stage.len() == 1 { "Step" } else { "Steps" };
    let all_steps: Vec<Step> =
        repeats.iter().flat_map(|stage| r.f.plan.steps[(*stage).clone()].to_vec()).collect();
    let number = all.iter().map(|&step| r.position(step)).min().unwrap_or(0) + 1;
    html! {
        section.sheet.step id=(format!("step-{number}")) {
            div.where { (place_picture(r, stage)) }
            h2 { (head) " " (r.step_numbers(&all)) ": " (action_text(r, stage)) }
            @if let Some(within) = steps[0].group_step {
                @let group = r.words.group_text(&r.f.plan.steps[within].parts);
                p.soft {
                    "On the bench, "
                    @if r.is_assembly() { "for what step " (r.step_numbers(&[within])) " puts in: " (group) }
                    @else { "from what step " (r.step_numbers(&[within])) " took out: " (group) }
                    "."
                    @if let Some(first) = first_parts_of_group(r, stage) { " It begins with " (r.words.name_list(&first)) "." }
                }
            }
            @if has_one_picture(r, stage) { (stage_picture(r, stage)) } @else { (move_pictures(r, stage.start)) }
            (stage_facts(r, stage))
            (repeats_section(r, &repeats[1..]))
            (stability_warnings(r, &all_steps))
            (proof_section(r, &all_steps))
        }
    }
}

/// Checks whether a stage is drawn as one picture: its steps have one move each.
fn has_one_picture(r: &Report, stage: &Range<usize>) -> bool {
    r.f.plan.steps[stage.start].path.len() == 1
}

/// Checks whether the pages of two stages are alike: one picture each, along the same direction, both unscrewed or
/// both not, and of the same group.
fn are_alike(r: &Report, a: &Range<usize>, b: &Range<usize>) -> bool {
    let plan = &r.f.plan;
    let direction = plan.stage_direction(a);
    [a, b].iter().all(|stage| has_one_picture(r, stage))
        && direction.is_some()
        && direction == plan.stage_direction(b)
        && plan.is_unscrewed(a) == plan.is_unscrewed(b)
        && plan.steps[a.start].group_step == plan.steps[b.start].group_step
}

/// Divides the pages into runs that are printed on one sheet of paper: up to [`MAX_ON_SHEET`] consecutive pages that
/// are alike and do not list repetitions. Each page is a list of stages that repeat the same work.
pub(super) fn like_pages<'p, 'a>(
    r: &Report,
    pages: &'p [Vec<&'a Range<usize>>],
) -> Vec<&'p [Vec<&'a Range<usize>>]> {
    let mut runs = Vec::new();
    let mut start = 0;
    for end in 1..=pages.len() {
        let joins = end < pages.len()
            && end - start < MAX_ON_SHEET
            && pages[start].len() == 1
            && pages[end].len() == 1
            && are_alike(r, pages[start][0], pages[end][0]);
        if !joins {
            runs.push(&pages[start..end]);
            start = end;
        }
    }
    runs
}

/// Returns the page of the parts with which assembly begins: those that no step removes. Empty without steps.
pub(super) fn first_parts_page(r: &Report) -> Markup {
    let mut is_first = vec![true; r.f.bodies.len()];
    for step in &r.f.plan.steps {
        step.parts.iter().for_each(|&part| is_first[part] = false);
    }
    let parts: Vec<usize> = (0..is_first.len()).filter(|&part| is_first[part]).collect();
    if parts.is_empty() || r.f.plan.steps.is_empty() {
        return Markup::default();
    }
    let shown = |&part: &usize| Shown { part, by: DVec3::ZERO, look: Look::Full };
    let scene = Scene {
        size: SIZE,
        shown: parts.iter().map(shown).collect(),
        arrows: Vec::new(),
        traces: Vec::new(),
        numbers: Vec::new(),
        label: format!("The first parts: {}", r.words.name_list(&parts)),
    };
    html! {
        section.sheet.step id="first" {
            h2 { "Begin with " (r.words.group_text(&parts)) }
            figure { (picture_markup(r.studio.draw_picture(&scene, r.studio.default_viewpoint()))) }
            @if parts.len() > 1 {
                p.warn { "The plan does not take these parts apart: how they are put together is not known." }
            }
        }
    }
}

/// Returns the parts with which a group is put together, if a stage is the first one of its group in instructions.
fn first_parts_of_group(r: &Report, stage: &Range<usize>) -> Option<Vec<usize>> {
    let steps = &r.f.plan.steps;
    let within = steps[stage.start].group_step?;
    let is_first = !steps[stage.end..].iter().any(|step| step.group_step == Some(within));
    let inner: Vec<usize> = steps
        .iter()
        .filter(|step| step.group_step == Some(within))
        .flat_map(|step| step.parts.iter().copied())
        .collect();
    let rest = steps[within].parts.iter().copied().filter(|part| !inner.contains(part));
    (r.is_assembly() && is_first).then(|| rest.collect())
}

/// Returns a small picture of the whole assembly with the parts of a stage in colour, at their places.
fn place_picture(r: &Report, stage: &Range<usize>) -> Markup {
    let moving = moved_parts(&r.f.plan.steps[stage.clone()]);
    let look = |part: &usize| if moving.contains(part) { Look::Moving } else { Look::Glass };
    let shown = |part: usize| Shown { part, by: DVec3::ZERO, look: look(&part) };
    let scene = Scene {
        size: PLACE,
        shown: (0..r.f.bodies.len()).map(shown).collect(),
        arrows: Vec::new(),
        traces: Vec::new(),
        numbers: Vec::new(),
        label: format!("Where: {} in the whole", taken_parts_text(r, stage)),
    };
    picture_markup(r.studio.draw_picture(&scene, r.studio.default_viewpoint()))
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
                        (r.step_list(&all)) ": " (taken_parts_text(r, stage)) ", " (direction_text(r, stage, r.sign()))
                        @if let Some(travel) = travel { ", " (travel) }
                    }
                }
            }
        }
    }
}

/// Describes the action of a stage: `take out base`, `unscrew M5 x 20 (m5x20_1)`, or its reverse.
fn action_text(r: &Report, stage: &Range<usize>) -> String {
    let verb = if r.is_assembly() { "put in" } else { "take out" };
    match r.f.plan.describe_fasteners(r.f.bodies.assembly(), stage) {
        Some(text) if r.f.plan.is_unscrewed(stage) => {
            if r.is_assembly() {
                screwed_in(&text)
            } else {
                text
            }
        }
        Some(text) => format!("{verb} {text}"),
        None => format!("{verb} {}", taken_parts_text(r, stage)),
    }
}

/// Returns a description that begins with unscrewing as that of screwing in.
fn screwed_in(text: &str) -> String {
    let verbs = [("unscrewed", "screwed in"), ("unscrew", "screw in")];
    let found = verbs.iter().find_map(|(from, to)| Some((text.strip_prefix(from)?, to)));
    found.map_or_else(|| text.to_owned(), |(rest, verb)| format!("{verb}{rest}"))
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
                Some(_) => r.words.move_text(&steps[0].path[0], r.is_assembly()),
                None => direction_text(r, stage, r.sign()),
            }
        ),
    };
    // The tip of the arrow of an insertion is within the picture of the assembly.
    if r.words.is_significant(travel) && !r.is_assembly() {
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

/// Returns a picture for each move of a step in the order of the document, with all parts displaced by the earlier
/// moves of the plan.
fn move_pictures(r: &Report, at: usize) -> Markup {
    let step = &r.f.plan.steps[at];
    let mut by = vec![DVec3::ZERO; r.f.bodies.len()];
    let mut frames = Vec::new();
    let moves = step.path.len();
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
                "Move {} of {moves}: {} {}",
                if r.is_assembly() { moves - k } else { k + 1 },
                r.words.name_list(&leg.parts),
                r.words.move_text(leg, r.is_assembly())
            ),
        };
        let viewpoint = r.studio.choose_viewpoint(&mut scene, std::slice::from_ref(&leg.parts));
        let description = format!(
            "{}. {}: {}. ",
            if r.is_assembly() { moves - k } else { k + 1 },
            r.words.name_list(&leg.parts),
            r.words.move_text(leg, r.is_assembly())
        );
        frames.push(html! {
            figure {
                (picture_markup(r.studio.draw_picture(&scene, viewpoint)))
                (caption(r, &scene, viewpoint, &description, None))
            }
        });
    }
    // Moves that are not drawn, from the first one in the order of the plan.
    let undrawn = step.path.get(MAX_FRAMES..).unwrap_or_default();
    if r.is_assembly() {
        frames.reverse();
    }
    html! {
        @if r.is_assembly() {
            @if !step.return_legs.is_empty() {
                p { "First make room:" }
                ol { @for leg in step.return_legs.iter().rev() { (leg_item(r, leg)) } }
            }
            @if !undrawn.is_empty() { ol { @for leg in undrawn.iter().rev() { (leg_item(r, leg)) } } }
        }
        div.frames { @for figure in frames { (figure) } }
        @if !r.is_assembly() {
            @if !undrawn.is_empty() {
                ol start=(MAX_FRAMES + 1) { @for leg in undrawn { (leg_item(r, leg)) } }
            }
            @if !step.return_legs.is_empty() {
                p { "Then back to its place:" }
                ol { @for leg in &step.return_legs { (leg_item(r, leg)) } }
            }
        }
    }
}

/// Returns a list item that describes a move in the order of the document.
fn leg_item(r: &Report, leg: &Leg) -> Markup {
    html! { li { (r.words.name_list(&leg.parts)) ": " (r.words.move_text(leg, r.is_assembly())) } }
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

/// Returns an arrow from the middle of the moving parts to a point beyond their drawn position. It is reversed if the
/// document shows how the assembly is put together.
fn move_arrow(r: &Report, parts: &[usize], before: DVec3, out: DVec3) -> Arrow {
    let boxes = parts.iter().map(|&part| r.f.bodies.bounds(part));
    let Aabb { low, high } = boxes.reduce(|a, b| a.union(&b)).expect("something moves");
    let from = low.midpoint(high) + before;
    let beyond = out.normalize_or_zero() * 0.1 * r.diagonal;
    let ends = [from, from + out + beyond];
    let [from, to] = if r.is_assembly() { [ends[1], ends[0]] } else { ends };
    Arrow { from, to, label: String::new() }
}

/// Returns the list of facts about a stage: direction, travel, needed steps, round and time.
fn stage_facts(r: &Report, stage: &Range<usize>) -> Markup {
    let steps = &r.f.plan.steps[stage.clone()];
    let step = &steps[0];
    let after: Vec<usize> = stage.clone().flat_map(|k| r.needs[k].iter().copied()).collect();
    let rounds: Vec<usize> = stage.clone().map(|k| r.rounds[k]).collect();
    html! {
        dl.facts {
            @if step.path.len() == 1 {
                div { dt { "Direction" } dd { (direction_text(r, stage, r.sign())) } }
                div {
                    dt { @if r.is_assembly() { "Travel, at least" } @else { "Travel until clear" } }
                    dd { (travel_text(r, steps).unwrap_or_else(|| nothing_in_the_way(r).into())) }
                }
            } @else {
                div { dt { "Moves" } dd { (step.path.len()) @if !step.return_legs.is_empty() { ", and " (step.return_legs.len()) " back" } } }
            }
            @for turns in r.f.plan.describe_unscrewing(stage, |turns| turns.describe(|x| r.words.length_text(x))) {
                div { dt { "Thread" } dd { (sentence(&if r.is_assembly() { screwed_in(&turns) } else { turns })) } }
            }
            @for tool in r.f.plan.describe_tools(stage, |reach| reach.finding(r.f.bodies.assembly())) {
                div { dt { "Tool" } dd { (sentence(&tool)) } }
            }
            @for reason in r.f.plan.unproven_reasons(r.f.bodies, stage, |parts| r.words.name_list(parts)) {
                div { dt { "Assumed" } dd { (sentence(&reason)) } }
            }
            div { dt { "Needs" } dd { @if after.is_empty() { "no earlier step" } @else { (r.step_list(&after)) } } }
            div { dt { "Round" } dd { (number_runs(&rounds)) " of " (r.rounds.iter().max().map_or(0, |k| k + 1)) } }
            div { dt { "Time, about" } dd { (time_text(r.seconds[stage.clone()].iter().sum())) } }
        }
    }
}

/// Returns the travel of parts that no other part confines.
fn nothing_in_the_way(r: &Report) -> &'static str {
    if r.is_assembly() {
        "nothing in the way: just put it on"
    } else {
        "nothing in the way: just take it off"
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

/// Returns warnings about parts that fall or may tip over after the steps.
fn stability_warnings(r: &Report, steps: &[Step]) -> Markup {
    let falls: Vec<usize> = steps.iter().flat_map(|step| step.falling.iter().copied()).collect();
    let tips: Vec<usize> = steps.iter().flat_map(|step| step.off_balance.iter().copied()).collect();
    html! {
        @if !falls.is_empty() {
            @let them = if falls.len() == 1 { "it" } else { "them" };
            p.warn { b { "Hold " (r.words.name_list(&falls)) ":" } @if r.is_assembly() { " before this step no part supports " } @else { " then no remaining part supports " } (them) "." }
        }
        @if !tips.is_empty() {
            @let [their, them, they] = if tips.len() == 1 { ["its", "it", "it"] } else { ["their", "them", "they"] };
            p.warn {
                b { "Steady " (r.words.name_list(&tips)) ":" }
                @if r.is_assembly() { " before this step " } @else { " then " } (their) " weight is not above what supports " (them) ", and " (they) " may tip over."
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
        .map(|proof| words.fine_length_text(proof.tolerance))
        .collect();
    let plain = surfaces.is_empty() && ignored.is_empty() && unproven.is_empty();
    let claim = match (steps, steps[0].path.len()) {
        _ if r.is_assembly() => "the reverse of a move that meets no part".to_owned(),
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
            r.words.fine_length_text(length),
            r.words.fine_length_text(length / 2.0)
        ),
        Fit::Chords { largest, .. } => {
            format!(
                ", with tolerances by the chord errors of the parts, {} at most",
                r.words.fine_length_text(largest)
            )
        }
        Fit::MinGap(length) => {
            format!(", and keeps a gap of {} to all others", r.words.fine_length_text(length))
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
