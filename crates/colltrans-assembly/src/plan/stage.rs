//! Steps that are one for whoever does them: "8 x bolt, up 40".

use std::ops::Range;

use glam::DVec3;

use super::{Leg, Passed, Plan, Step};
use crate::likes::{common_name, pairs_alike};
use crate::part::Assembly;

/// Screws that are told as one take the same turns, to this.
const SAME_TURNS: f64 = 0.01;
/// Parts that are told as one though each has its own direction go equally far, but for this share.
const SAME_TRAVEL: f64 = 1e-3;
/// Stages of what comes several times over, at most.
const MOST_PERIOD: usize = 12;

impl Plan {
    /// All steps in order, in runs of parts that are alike and leave alone, in one move each, in any order: none of them
    /// waits for another one. They leave along one direction, or equally far each along its own.
    pub fn stages(&self) -> Vec<Range<usize>> {
        let mut stages: Vec<Range<usize>> = Vec::new();
        // Whether all steps of the last stage go along one direction.
        let mut one_way = true;
        for (k, step) in self.steps.iter().enumerate() {
            if let Some(stage) = stages.last_mut() {
                one_way &= self.steps[stage.start].direction == step.direction;
                if self.joins(stage, step, one_way) {
                    stage.end = k + 1;
                    continue;
                }
            }
            stages.push(k..k + 1);
            one_way = true;
        }
        stages
    }

    /// Of stages, runs that come several times over, one right after another, with parts that are alike and go along one
    /// direction, or as far along another: "barrel, pin, piston, rod", nine times. Each is the positions of the first run and how many there are; all others are runs of one
    /// stage, once.
    pub fn repeats(&self, stages: &[Range<usize>]) -> Vec<(Range<usize>, usize)> {
        let mut found = Vec::new();
        let mut at = 0;
        while at < stages.len() {
            let times = |period: usize| {
                let block = |k: usize| stages.get(at + k * period..at + (k + 1) * period);
                let again = |k: &usize| match (block(0), block(*k)) {
                    (Some(first), Some(next)) => {
                        first.iter().zip(next).all(|(a, b)| self.are_alike(a, b))
                    }
                    _ => false,
                };
                1 + (1..stages.len()).take_while(again).count()
            };
            let runs = (1..=MOST_PERIOD).map(|period| (period, times(period)));
            let several = runs.filter(|(_, times)| *times > 1);
            // Of equally many stages the shortest run.
            let best = several.reduce(|a, b| if b.0 * b.1 > a.0 * a.1 { b } else { a });
            let (period, times) = best.unwrap_or((1, 1));
            found.push((at..at + period, times));
            at += period * times;
        }
        found
    }

    /// Whether two stages are the same work, elsewhere.
    fn are_alike(&self, a: &Range<usize>, b: &Range<usize>) -> bool {
        let likes = |step: &Step| {
            let mut likes: Vec<usize> = step.parts.iter().map(|&part| self.likes[part]).collect();
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
            // Of groups that were taken out in the run before, or of none.
            let within = a.within.is_some() == b.within.is_some();
            within && likes(a) == likes(b) && legs(&a.path, &b.path) && legs(&a.back, &b.back)
        };
        let (first, second) = (&self.steps[a.clone()], &self.steps[b.clone()]);
        first.len() == second.len() && first.iter().zip(second).all(step)
    }

    /// What a stage takes away: names of its parts, after that of their subassembly, or of several that are alike how
    /// many, and what their names share.
    pub fn takes(&self, assembly: &Assembly, stage: &Range<usize>) -> String {
        let steps = &self.steps[stage.clone()];
        let all: Vec<usize> = steps.iter().flat_map(|step| step.parts.iter().copied()).collect();
        let names = assembly.names(&all);
        if let (Some(name), [_]) = (assembly.constraints().name(&all), steps) {
            return format!("{name} ({})", names.join(", "));
        }
        match common_name(&names) {
            Some(name) if steps.len() > 1 => format!("{} x {name}", steps.len()),
            _ => names.join(", "),
        }
    }

    /// Where the parts of a stage go; `None` if each goes its own way.
    pub fn direction(&self, stage: &Range<usize>) -> Option<DVec3> {
        let first = self.steps[stage.start].direction;
        self.steps[stage.clone()].iter().all(|step| step.direction == first).then_some(first)
    }

    /// How far the parts of a stage have to go, at most; of several moves the last one.
    pub fn travel(&self, stage: &Range<usize>) -> f64 {
        self.steps[stage.clone()].iter().map(|step| step.travel.value).fold(0.0, f64::max)
    }

    /// The numbers of a stage's steps, counted from 1: "3" or "3-10".
    pub fn numbers(stage: &Range<usize>) -> String {
        match stage.len() {
            1 => stage.end.to_string(),
            _ => format!("{}-{}", stage.start + 1, stage.end),
        }
    }

    /// What the steps of a stage let pass of pairs with a fit of their own.
    pub fn passed(&self, stage: &Range<usize>) -> Vec<Passed> {
        self.steps[stage.clone()].iter().flat_map(|step| step.passed.iter().copied()).collect()
    }

    /// The same in words, of parts that are alike together: "4 x bolt and plate: thread, ...".
    pub fn passed_words(&self, assembly: &Assembly, stage: &Range<usize>) -> Vec<String> {
        let all = self.passed(stage);
        let said = |passed: &Passed| passed.tolerated.words(passed.role);
        let all = all.iter().map(|passed| (passed.parts, said(passed), said(passed)));
        let told = |(said, sides): (String, [Vec<usize>; 2])| {
            let [a, b] = sides.map(|side| {
                let names = assembly.names(&side);
                match common_name(&names) {
                    Some(name) if names.len() > 1 => format!("{} x {name}", names.len()),
                    _ => names.join(", "),
                }
            });
            format!("{a} and {b}: {said}")
        };
        pairs_alike(&self.likes, all).into_iter().map(told).collect()
    }

    /// Checks whether a step is of one stage with those before it; `one_way` is whether all go along one direction.
    fn joins(&self, stage: &Range<usize>, step: &Step, one_way: bool) -> bool {
        let first = &self.steps[stage.start];
        let turns = |step: &Step| step.turn().map_or(0.0, |turn| turn.turns);
        let plain = |step: &Step| {
            let moves = if step.turn().is_some() { 2 } else { 1 };
            step.parts.len() == 1 && step.path.len() == moves
        };
        let equally = |other: &Step| {
            let [a, b] = [step, other].map(|step| step.travel.value);
            (a - b).abs() <= SAME_TRAVEL * a.max(b)
        };
        plain(first)
            && plain(step)
            && self.likes[first.parts[0]] == self.likes[step.parts[0]]
            && (one_way || self.steps[stage.clone()].iter().all(equally))
            && first.within == step.within
            && (turns(first) - turns(step)).abs() < SAME_TURNS
            && !step.after.iter().any(|k| stage.contains(k))
    }
}
