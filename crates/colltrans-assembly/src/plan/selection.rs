//! Removal of selected parts together with as few other parts as possible.

use std::collections::BTreeMap;

use super::smallest_set::{SufficientSet, smallest_sufficient_set};
use super::{Interlocked, KnownParts, Plan, PlanOptions, Planner};
use crate::bodies::Bodies;
use crate::candidates::FinerCandidate;
use crate::error::AssemblyError;
use crate::matrix::ContactMatrix;
use crate::part::Assembly;
use crate::watch::Watch;

/// The parts that are removed so that selected parts come out.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct SelectedRemoval {
    /// Indices of the selected parts, in increasing order.
    pub parts: Vec<usize>,
    /// Indices of the other removed parts, in increasing order.
    pub others: Vec<usize>,
    /// Whether it is certain that fewer other parts do not suffice. This covers single moves of any groups along the
    /// directions of the matrix, not other directions.
    pub is_minimal: bool,
    /// Whether all selected parts come out.
    pub is_complete: bool,
}

/// Computes a plan that removes selected parts.
///
/// Removes the fewest other parts that suffice in single moves along the directions of the matrix. If that is any part,
/// searches for several moves that remove the selected parts alone, at first of these parts only, then with others that
/// move aside and return, and then for each other part in turn whether it may stay. If no set suffices, or the selected
/// parts leave only inside others that hold them, computes a plan of all parts and keeps the steps that the selected
/// parts need.
///
/// # Errors
/// Returns the errors of [`disassemble`](super::disassemble), and an error if no parts or all parts are selected or a
/// selected part is fixed.
pub fn remove<'a>(
    bodies: &'a Bodies<'a>,
    matrix: &ContactMatrix<'a>,
    finer: &[FinerCandidate],
    parts: &[usize],
    options: PlanOptions,
    watch: Watch,
) -> Result<Plan, AssemblyError> {
    let mut parts = parts.to_vec();
    parts.sort_unstable();
    parts.dedup();
    if parts.is_empty() || parts.len() >= bodies.len() {
        return Err(AssemblyError::InvalidRemoval { count: parts.len(), of: bodies.len() });
    }
    let all = bodies.assembly().parts();
    if let Some(&fixed) = parts.iter().find(|&&part| all[part].is_fixed()) {
        return Err(AssemblyError::FixedAndRemoved { name: all[fixed].name().to_owned() });
    }
    matrix.compute_all(watch)?;
    let known = KnownParts::new(bodies)?;
    let found = smallest_sufficient_set(bodies, matrix, &parts);
    let other_count = |set: &SufficientSet| set.parts.len() - parts.len();
    let plan_with = |movable: Option<&[usize]>, makes_room: bool| {
        let mut planner = Planner::new(bodies, finer, &known, options, watch)?;
        (planner.wanted, planner.movable, planner.makes_room) = (&parts, movable, makes_room);
        planner.plan_all(matrix)?;
        Ok::<Plan, AssemblyError>(planner.plan)
    };
    let is_whole = |plan: &Plan| plan.takes_out(&parts);
    // A set of single moves with others may be larger than necessary: several moves may take out fewer parts.
    let mut fewest = found.as_ref().map(|set| set.parts.clone());
    let mut planned = None;
    if options.effort > 0 && found.as_ref().is_none_or(|set| other_count(set) > 0) {
        for makes_room in [false, true] {
            let plan = plan_with(Some(&parts), makes_room)?;
            if is_whole(&plan) {
                (planned, fewest) = (Some(plan), Some(parts.clone()));
                break;
            }
        }
    }
    let dropped = |set: &[usize], other: usize| {
        set.iter().copied().filter(|&part| part != other).collect::<Vec<usize>>()
    };
    if options.effort > 0 && planned.is_none() {
        let set = fewest.clone().unwrap_or_default();
        for &other in set.iter().filter(|part| !parts.contains(part)) {
            let Some(known) = &fewest else { break };
            let smaller = dropped(known, other);
            if smaller.len() == parts.len() {
                break;
            }
            let plan = plan_with(Some(&smaller), false)?;
            if is_whole(&plan) {
                (planned, fewest) = (Some(plan), Some(smaller));
            }
        }
    }
    let mut planned = match planned {
        Some(plan) => plan,
        None => plan_with(fewest.as_deref(), false)?,
    };
    if fewest.is_some() && !is_whole(&planned) {
        // The selected parts leave with others, and then stay locked in them.
        (planned, fewest) = (plan_with(None, false)?, None);
    }
    let is_reduced = fewest.as_ref().map(Vec::len) != found.as_ref().map(|set| set.parts.len());
    let mut plan = planned;
    if fewest.is_none() {
        plan.drop_unneeded_steps(&parts, bodies.len());
    }
    let moved = plan
        .steps
        .iter()
        .filter(|step| step.group_step.is_none())
        .flat_map(|step| step.parts.clone());
    let (gone, mut others): (Vec<usize>, Vec<usize>) = moved.partition(|part| parts.contains(part));
    others.sort_unstable();
    let single = !is_reduced && found.is_some_and(|SufficientSet { least, .. }| least);
    let least = others.is_empty() || single;
    let out = gone.len() == parts.len() && plan.takes_out(&parts);
    plan.selection = Some(SelectedRemoval { parts, others, is_minimal: least, is_complete: out });
    Ok(known.complete(plan))
}

impl Plan {
    /// Checks whether parts leave, and do not stay interlocked with other parts.
    fn takes_out(&self, wanted: &[usize]) -> bool {
        let stays = |part: &usize| self.remaining.contains(part) || self.base.contains(part);
        let is_locked = |group: &Interlocked| {
            let (inside, others) =
                group.parts.iter().partition::<Vec<usize>, _>(|part| wanted.contains(part));
            !inside.is_empty() && !others.is_empty()
        };
        !wanted.iter().any(stays) && !self.interlocked.iter().any(is_locked)
    }

    /// Drops the steps that the selected parts do not need. Does nothing if a selected part does not come out.
    fn drop_unneeded_steps(&mut self, wanted: &[usize], count: usize) {
        if !self.takes_out(wanted) {
            return;
        }
        let takes = |step: &super::Step| step.parts.iter().any(|part| wanted.contains(part));
        let mut needed: Vec<bool> = self.steps.iter().map(takes).collect();
        for k in (0..self.steps.len()).rev().filter(|&k| needed[k]).collect::<Vec<_>>() {
            self.mark_needed(k, &mut needed);
        }
        let mut at = BTreeMap::new();
        let steps = std::mem::take(&mut self.steps).into_iter().enumerate();
        for (k, mut step) in steps.filter(|(k, _)| needed[*k]) {
            step.group_step = step.group_step.map(|k| at[&k]);
            step.predecessors = step.predecessors.iter().map(|k| at[k]).collect();
            at.insert(k, self.steps.len());
            self.steps.push(step);
        }
        let main = self.steps.iter().filter(|step| step.group_step.is_none());
        let gone: Vec<usize> = main.flat_map(|step| step.parts.iter().copied()).collect();
        self.base = (0..count).filter(|part| !gone.contains(part)).collect();
    }

    /// Marks all steps that must precede a step.
    fn mark_needed(&self, step: usize, needed: &mut [bool]) {
        for &k in &self.steps[step].predecessors {
            if !std::mem::replace(&mut needed[k], true) {
                self.mark_needed(k, needed);
            }
        }
    }
}

impl SelectedRemoval {
    /// Returns a sentence that lists the removed parts.
    pub fn describe(&self, assembly: &Assembly) -> String {
        let names = |parts: &[usize]| assembly.part_names(parts).join(", ");
        let wanted = names(&self.parts);
        if !self.is_complete {
            return format!(
                "{wanted}: no removal path was found, although all removable parts were removed"
            );
        }
        let others = match self.others.len() {
            0 => return format!("{wanted}: nothing else has to go"),
            1 => "1 other part goes".to_owned(),
            count => format!("{count} other parts go"),
        };
        let least = if self.is_minimal {
            "no fewer are enough, in single moves along the directions asked"
        } else {
            "fewer may be enough"
        };
        format!("{wanted}: {others} ({}); {least}", names(&self.others))
    }
}
