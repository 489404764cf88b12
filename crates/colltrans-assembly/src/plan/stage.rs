//! Steps that are one for whoever does them: "8 x bolt, up 40".

use std::ops::Range;

use super::{Plan, Step};
use crate::likes::common_name;
use crate::part::Assembly;
use crate::roles::Passed;

/// Screws that are told as one take the same turns, to this.
const SAME_TURNS: f64 = 0.01;

impl Plan {
    /// All steps in order, in runs of parts that are alike and leave alone along one direction, in one move each, in any
    /// order: none of them waits for another one.
    pub fn stages(&self) -> Vec<Range<usize>> {
        let mut stages: Vec<Range<usize>> = Vec::new();
        for (k, step) in self.steps.iter().enumerate() {
            match stages.last_mut() {
                Some(stage) if self.joins(stage, step) => stage.end = k + 1,
                _ => stages.push(k..k + 1),
            }
        }
        stages
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

    fn joins(&self, stage: &Range<usize>, step: &Step) -> bool {
        let first = &self.steps[stage.start];
        let turns = |step: &Step| step.turn().map_or(0.0, |turn| turn.turns);
        let plain = |step: &Step| {
            let moves = if step.turn().is_some() { 2 } else { 1 };
            step.parts.len() == 1 && step.path.len() == moves
        };
        plain(first)
            && plain(step)
            && self.likes[first.parts[0]] == self.likes[step.parts[0]]
            && first.direction == step.direction
            && first.within == step.within
            && (turns(first) - turns(step)).abs() < SAME_TURNS
            && !step.after.iter().any(|k| stage.contains(k))
    }
}
