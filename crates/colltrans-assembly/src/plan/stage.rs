//! Stages of a plan: steps that a reader performs as one operation, for example "8 x bolt, up 40".

use std::ops::Range;

use glam::DVec3;

use super::{Leg, Plan, Step, ToleratedContact};
use crate::bodies::Bodies;
use crate::fasteners::{FastenerKind, Unscrewing};
use crate::identical::{common_name, group_identical_pairs};
use crate::part::Assembly;
use crate::tools::ToolReach;

/// Maximum difference of the numbers of turns within a stage.
const SAME_TURNS: f64 = 0.01;
/// Relative difference of travels below which parts that leave in different directions form one stage.
const SAME_TRAVEL: f64 = 1e-3;
/// Maximum number of stages in a repeated run.
const MAX_PERIOD: usize = 12;

impl Plan {
    /// Returns the stages of the plan, as ranges of steps in their order.
    ///
    /// The steps of a stage remove identical parts one by one, each in one move (unscrewing included), and do not
    /// depend on each other. They share a direction, or have equal travel along different directions.
    pub fn stages(&self) -> Vec<Range<usize>> {
        let mut stages: Vec<Range<usize>> = Vec::new();
        // Whether all steps of the last stage share one direction.
        let mut one_way = true;
        for (k, step) in self.steps.iter().enumerate() {
            if let Some(stage) = stages.last_mut() {
                one_way &= self.steps[stage.start].direction == step.direction;
                if self.joins_stage(stage, step, one_way) {
                    stage.end = k + 1;
                    continue;
                }
            }
            stages.push(k..k + 1);
            one_way = true;
        }
        stages
    }

    /// Groups stages into runs that repeat one after another, for example "barrel, pin, piston, rod" nine times.
    ///
    /// Corresponding stages of a run remove identical parts, along the same direction or equally far. Returns for
    /// each group the indices of the first run and the number of runs. A stage that does not repeat is a run of its
    /// own.
    pub fn repeated_stages(&self, stages: &[Range<usize>]) -> Vec<(Range<usize>, usize)> {
        let mut found = Vec::new();
        let mut at = 0;
        while at < stages.len() {
            let times = |period: usize| {
                let block = |k: usize| stages.get(at + k * period..at + (k + 1) * period);
                let again = |k: &usize| match (block(0), block(*k)) {
                    (Some(first), Some(next)) => {
                        first.iter().zip(next).all(|(a, b)| self.are_repetitions(a, b))
                    }
                    _ => false,
                };
                1 + (1..stages.len()).take_while(again).count()
            };
            let runs = (1..=MAX_PERIOD).map(|period| (period, times(period)));
            let several = runs.filter(|(_, times)| *times > 1);
            // If two choices cover equally many stages, the shorter run wins.
            let best = several.reduce(|a, b| if b.0 * b.1 > a.0 * a.1 { b } else { a });
            let (period, times) = best.unwrap_or((1, 1));
            found.push((at..at + period, times));
            at += period * times;
        }
        found
    }

    /// Checks whether two stages are the same operation on different parts.
    fn are_repetitions(&self, a: &Range<usize>, b: &Range<usize>) -> bool {
        let likes = |step: &Step| {
            let mut likes: Vec<usize> =
                step.parts.iter().map(|&part| self.first_identical[part]).collect();
            likes.sort_unstable();
            likes
        };
        let leg = |[a, b]: [&Leg; 2]| {
            let equal = |x: f64, y: f64| (x - y).abs() <= SAME_TRAVEL * x.abs().max(y.abs());
            let turns = |leg: &Leg| leg.turn.as_ref().map_or(0.0, |turn| turn.turns);
            let one_way = a.direction == b.direction;
            (one_way || equal(a.travel, b.travel)) && equal(turns(a), turns(b))
        };
        let legs =
            |a: &[Leg], b: &[Leg]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| leg([a, b]));
        let step = |(a, b): (&Step, &Step)| {
            // Either both take apart a group that was removed before, or neither does.
            let within = a.group_step.is_some() == b.group_step.is_some();
            within
                && likes(a) == likes(b)
                && legs(&a.path, &b.path)
                && legs(&a.return_legs, &b.return_legs)
        };
        let (first, second) = (&self.steps[a.clone()], &self.steps[b.clone()]);
        first.len() == second.len() && first.iter().zip(second).all(step)
    }

    /// Returns a description of the parts that a stage removes.
    ///
    /// This is the name of their subassembly with the part names. For several identical parts it is their number and
    /// the common beginning of their names. Otherwise it is the list of names.
    pub fn describe_stage(&self, assembly: &Assembly, stage: &Range<usize>) -> String {
        let steps = &self.steps[stage.clone()];
        let all: Vec<usize> = steps.iter().flat_map(|step| step.parts.iter().copied()).collect();
        let names = assembly.part_names(&all);
        if let (Some(name), [_]) = (assembly.constraints().group_name(&all), steps) {
            return format!("{name} ({})", names.join(", "));
        }
        match common_name(&names) {
            Some(name) if steps.len() > 1 => format!("{} x {name}", steps.len()),
            _ => names.join(", "),
        }
    }

    /// Returns the action of a stage that removes fasteners of one designation one by one: `unscrew 4 x M5 x 20
    /// (bolt)`, `washer M5 (washer_1)`. Returns `None` for other stages.
    pub fn describe_fasteners(&self, assembly: &Assembly, stage: &Range<usize>) -> Option<String> {
        let steps = &self.steps[stage.clone()];
        let fastener = |step: &Step| match step.parts[..] {
            [part] => self.fasteners.get(part),
            _ => None,
        };
        let first = fastener(&steps[0])?;
        let title = first.title();
        if !steps.iter().all(|step| fastener(step).is_some_and(|f| f.title() == title)) {
            return None;
        }
        let parts: Vec<usize> = steps.iter().map(|step| step.parts[0]).collect();
        let names = assembly.part_names(&parts);
        let name = common_name(&names).filter(|_| names.len() > 1);
        let name = name.unwrap_or_else(|| names.join(", "));
        let count = if steps.len() > 1 { format!("{} x ", steps.len()) } else { String::new() };
        let is_turned = self.is_unscrewed(stage);
        // A screw needs no name of its kind beside the verb.
        let size = match first.kind {
            FastenerKind::Screw if is_turned => &first.designation,
            _ => &title,
        };
        let verb = if is_turned { "unscrew " } else { "" };
        Some(format!("{verb}{count}{size} ({name})"))
    }

    /// Checks whether each step of a stage begins with a turn along a thread, modelled or plain.
    pub fn is_unscrewed(&self, stage: &Range<usize>) -> bool {
        let turns = |step: &Step| step.unscrewing.is_some() || step.first_turn().is_some();
        self.steps[stage.clone()].iter().all(turns)
    }

    /// Returns descriptions of the turns of plain threads in a stage, each once.
    pub fn describe_unscrewing(
        &self,
        stage: &Range<usize>,
        describe: impl Fn(&Unscrewing) -> String,
    ) -> Vec<String> {
        self.distinct_texts(stage, |step| step.unscrewing.as_ref().map(&describe))
    }

    /// Returns the reasons why the moves of some steps are not proven for the parts as drawn: open surfaces, and
    /// overlapping parts that move as one. `names` joins the names of parts.
    pub fn unproven_reasons(
        &self,
        bodies: &Bodies,
        steps: &Range<usize>,
        names: impl Fn(&[usize]) -> String,
    ) -> Vec<String> {
        let (steps, mut reasons) = (&self.steps[steps.clone()], Vec::new());
        let mut surfaces: Vec<usize> =
            steps.iter().flat_map(|step| step.surfaces.iter().copied()).collect();
        surfaces.sort_unstable();
        surfaces.dedup();
        if !surfaces.is_empty() {
            reasons.push(format!("open surfaces have no known inside: {}", names(&surfaces)));
        }
        let moves_as_one = |pair: &&[usize; 2]| {
            steps.iter().any(|step| pair.iter().all(|part| step.parts.contains(part)))
        };
        let mut overlaps = bodies.overlapping_pairs().iter().filter(moves_as_one);
        if let Some(first) = overlaps.next() {
            let more = match overlaps.count() {
                0 => String::new(),
                1 => " and 1 more pair".into(),
                count => format!(" and {count} more pairs"),
            };
            reasons.push(format!("overlapping parts move as one: {}{more}", names(first)));
        }
        reasons
    }

    /// Returns descriptions of the tools of a stage, each once.
    pub fn describe_tools(
        &self,
        stage: &Range<usize>,
        describe: impl Fn(&ToolReach) -> String,
    ) -> Vec<String> {
        self.distinct_texts(stage, |step| step.tool.as_ref().map(&describe))
    }

    /// Returns the texts of the steps of a stage, each once.
    fn distinct_texts(
        &self,
        stage: &Range<usize>,
        text: impl Fn(&Step) -> Option<String>,
    ) -> Vec<String> {
        let mut all: Vec<String> = Vec::new();
        for step in &self.steps[stage.clone()] {
            all.extend(text(step).filter(|text| !all.contains(text)));
        }
        all
    }

    /// Returns the common direction of the steps of a stage, or `None` if their directions differ.
    pub fn stage_direction(&self, stage: &Range<usize>) -> Option<DVec3> {
        let first = self.steps[stage.start].direction;
        self.steps[stage.clone()].iter().all(|step| step.direction == first).then_some(first)
    }

    /// Returns the largest travel of the steps of a stage. For a path of several moves the last move counts.
    pub fn stage_travel(&self, stage: &Range<usize>) -> f64 {
        self.steps[stage.clone()].iter().map(|step| step.travel.value).fold(0.0, f64::max)
    }

    /// Returns the step numbers of a stage, counted from 1: "3" or "3-10".
    pub fn step_numbers(stage: &Range<usize>) -> String {
        match stage.len() {
            1 => stage.end.to_string(),
            _ => format!("{}-{}", stage.start + 1, stage.end),
        }
    }

    /// Returns the tolerated contacts of a stage, of pairs with a fit of their own.
    pub fn stage_contacts(&self, stage: &Range<usize>) -> Vec<ToleratedContact> {
        self.steps[stage.clone()].iter().flat_map(|step| step.tolerated.iter().copied()).collect()
    }

    /// Returns descriptions of the tolerated contacts of a stage, with identical pairs combined: "4 x bolt and plate:
    /// thread, ...".
    pub fn describe_stage_contacts(
        &self,
        assembly: &Assembly,
        stage: &Range<usize>,
    ) -> Vec<String> {
        let all = self.stage_contacts(stage);
        let description = |passed: &ToleratedContact| passed.tolerated.describe(passed.role);
        let all = all.iter().map(|passed| (passed.parts, description(passed), description(passed)));
        let describe_group = |(description, sides): (String, [Vec<usize>; 2])| {
            let [a, b] = sides.map(|side| {
                let names = assembly.part_names(&side);
                match common_name(&names) {
                    Some(name) if names.len() > 1 => format!("{} x {name}", names.len()),
                    _ => names.join(", "),
                }
            });
            format!("{a} and {b}: {description}")
        };
        group_identical_pairs(&self.first_identical, all).into_iter().map(describe_group).collect()
    }

    /// Checks whether a step belongs to the stage before it. `one_way` states whether all of them share one
    /// direction.
    fn joins_stage(&self, stage: &Range<usize>, step: &Step, one_way: bool) -> bool {
        let first = &self.steps[stage.start];
        let turns = |step: &Step| step.first_turn().map_or(0.0, |turn| turn.turns);
        let plain = |step: &Step| {
            let moves = if step.first_turn().is_some() { 2 } else { 1 };
            step.parts.len() == 1 && step.path.len() == moves
        };
        let equally = |other: &Step| {
            let [a, b] = [step, other].map(|step| step.travel.value);
            (a - b).abs() <= SAME_TRAVEL * a.max(b)
        };
        plain(first)
            && plain(step)
            && self.first_identical[first.parts[0]] == self.first_identical[step.parts[0]]
            && (one_way || self.steps[stage.clone()].iter().all(equally))
            && first.group_step == step.group_step
            && (turns(first) - turns(step)).abs() < SAME_TURNS
            && !step.predecessors.iter().any(|k| stage.contains(k))
    }
}
