//! Removal of selected parts together with as few other parts as possible.

use std::collections::BTreeMap;

use super::order::base_parts;
use super::smallest_set::{SufficientSet, smallest_sufficient_set};
use super::{Interlocked, KnownParts, Plan, PlanOptions, Planner};
use crate::bodies::Bodies;
use crate::candidates::FinerCandidate;
use crate::error::AssemblyError;
use crate::matrix::ContactMatrix;
use crate::part::Assembly;
use crate::sphere::normalized_direction;
use crate::watch::Watch;

/// The parts that are removed so that selected parts come out.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct SelectedRemoval {
    /// Indices of the selected parts, in increasing order.
    pub parts: Vec<usize>,
    /// Indices of the other removed parts, in increasing order.
    pub others: Vec<usize>,
    /// Those of the others that are screws that hold a selected part. They are removed before it.
    pub fasteners: Vec<usize>,
    /// Those of the others that stand in the way of the tools for these screws, for selected fasteners, or for one
    /// another. They are removed before them.
    pub obstacles: Vec<usize>,
    /// The parts that never move: the fixed ones, or else the largest part that is not selected.
    pub base: Vec<usize>,
    /// Whether it is certain that fewer other parts do not suffice. This covers single moves of any groups along the
    /// directions of the matrix, not other directions.
    pub is_minimal: bool,
    /// Whether all selected parts come out.
    pub is_complete: bool,
}

/// Maximum number of plans that try to do without other parts, after a plan of all parts.
const MAX_SMALLER_PLANS: usize = 8;

/// Computes a plan that removes selected parts.
///
/// The base never moves ([`SelectedRemoval::base`]). Screws that hold a selected part are removed before it, and before
/// them the parts in the way of their tools, if they can be removed. Otherwise removes the fewest other parts that suffice in single moves along the directions of the matrix.
/// If that is any part, searches for several moves that remove the selected parts alone, at first of these parts only,
/// then with others that move aside and return, and then for each other part in turn whether it may stay. If no set
/// suffices, or the selected parts leave only inside others that hold them, computes a plan of all parts, keeps the
/// steps that the selected parts need, and tries to do without halves of the others, and smaller shares.
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
    let up = normalized_direction(options.up.unwrap_or(bodies.assembly().up()))?;
    let is_base = base_parts(bodies, &vec![true; bodies.len()], up, |part| parts.contains(&part));
    let screws = known.screws_of(&parts, &is_base);
    let plan_with = |own: &[usize], movable: Option<&[usize]>, makes_room: bool| {
        let mut planner = Planner::new(bodies, finer, &known, options, watch)?;
        (planner.wanted, planner.movable, planner.makes_room) = (own, movable, makes_room);
        planner.plan_all(matrix)?;
        Ok::<Plan, AssemblyError>(planner.plan)
    };
    let plan_of = |own: &[usize]| {
        let found = smallest_sufficient_set(bodies, matrix, own, &is_base);
        plan_removal(
            own,
            found,
            options,
            &|movable, makes_room| plan_with(own, movable, makes_room),
            bodies.len(),
        )
    };
    let mut obstacles = known.obstacles_of(&[&parts[..], &screws].concat(), &is_base);
    let mut fasteners = screws;
    let (mut plan, mut single) = plan_of(&[&parts[..], &fasteners, &obstacles].concat())?;
    // What cannot be removed stays: first the parts in the way of tools, then the screws.
    for stays in [true, false] {
        let wanted = [&parts[..], &fasteners, &obstacles].concat();
        let more = if stays { &mut obstacles } else { &mut fasteners };
        if more.is_empty() || plan.takes_out(&wanted) {
            continue;
        }
        more.clear();
        (plan, single) = plan_of(&[&parts[..], &fasteners, &obstacles].concat())?;
    }
    let (gone, mut others): (Vec<usize>, Vec<usize>) =
        plan.removed_parts().partition(|part| parts.contains(part));
    others.sort_unstable();
    let least = others.is_empty() || single;
    let out = gone.len() == parts.len() && plan.takes_out(&parts);
    let base = (0..bodies.len()).filter(|&part| is_base[part]).collect();
    plan.selection = Some(SelectedRemoval {
        parts,
        others,
        fasteners,
        obstacles,
        base,
        is_minimal: least,
        is_complete: out,
    });
    Ok(known.complete(plan))
}

/// Plans with the parts that may leave, if not all may, and whether other parts make room.
type PlanWith<'p> = &'p dyn Fn(Option<&[usize]>, bool) -> Result<Plan, AssemblyError>;

/// Plans the removal of some parts: by `found`, the smallest set that suffices in single moves, or by several moves of
/// fewer parts. Also returns whether the removed parts are certainly the fewest in single moves.
fn plan_removal(
    own: &[usize],
    found: Option<SufficientSet>,
    options: PlanOptions,
    plan_with: PlanWith,
    count: usize,
) -> Result<(Plan, bool), AssemblyError> {
    let is_whole = |plan: &Plan| plan.takes_out(own);
    // A set of single moves with others may be larger than necessary: several moves may take out fewer parts.
    let mut fewest = found.as_ref().map(|set| set.parts.clone());
    let mut planned = None;
    if options.effort > 0 && found.as_ref().is_none_or(|set| set.parts.len() > own.len()) {
        for makes_room in [false, true] {
            let plan = plan_with(Some(own), makes_room)?;
            if is_whole(&plan) {
                (planned, fewest) = (Some(plan), Some(own.to_vec()));
                break;
            }
        }
    }
    if options.effort > 0 && planned.is_none() {
        let set = fewest.clone().unwrap_or_default();
        for &other in set.iter().filter(|part| !own.contains(part)) {
            let Some(known) = &fewest else { break };
            let smaller = without(known, &[other]);
            if smaller.len() == own.len() {
                break;
            }
            let plan = plan_with(Some(&smaller), false)?;
            if is_whole(&plan) {
                (planned, fewest) = (Some(plan), Some(smaller));
            }
        }
    }
    let mut plan = match planned {
        Some(plan) => plan,
        None => plan_with(fewest.as_deref(), false)?,
    };
    if fewest.is_some() && !is_whole(&plan) {
        // The selected parts leave with others, and then stay locked in them.
        (plan, fewest) = (plan_with(None, false)?, None);
    }
    let is_single = fewest.as_ref().map(Vec::len) == found.as_ref().map(|set| set.parts.len())
        && found.is_some_and(|set| set.least);
    if fewest.is_none() {
        plan.drop_unneeded_steps(own, count);
        if options.effort > 0 && is_whole(&plan) {
            plan = with_fewer_parts(plan, own, plan_with)?;
        }
    }
    Ok((plan, is_single))
}

/// Tries to do without other parts that a plan removes: halves of them, then smaller shares.
fn with_fewer_parts(
    mut plan: Plan,
    own: &[usize],
    plan_with: PlanWith,
) -> Result<Plan, AssemblyError> {
    let mut tries = 0;
    let mut share = plan.removed_parts().count().saturating_sub(own.len()).div_ceil(2);
    while share > 0 {
        let others: Vec<usize> = plan.removed_parts().filter(|part| !own.contains(part)).collect();
        for dropped in others.chunks(share) {
            tries += 1;
            if tries > MAX_SMALLER_PLANS {
                return Ok(plan);
            }
            let removed: Vec<usize> = plan.removed_parts().collect();
            let smaller = plan_with(Some(&without(&removed, dropped)), false)?;
            if smaller.takes_out(own) {
                plan = smaller;
            }
        }
        share /= 2;
    }
    Ok(plan)
}

/// Returns the parts that are not dropped.
fn without(parts: &[usize], dropped: &[usize]) -> Vec<usize> {
    parts.iter().copied().filter(|part| !dropped.contains(part)).collect()
}

impl Plan {
    /// Iterates over the parts that are removed from the whole assembly.
    fn removed_parts(&self) -> impl Iterator<Item = usize> {
        let main = self.steps.iter().filter(|step| step.group_step.is_none());
        main.flat_map(|step| step.parts.iter().copied())
    }

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
        let screws = match self.fasteners.len() {
            0 => String::new(),
            count if count == self.others.len() => ", screwed out first".to_owned(),
            _ => format!(", of which {} are screwed out first", names(&self.fasteners)),
        };
        let room = match self.obstacles.len() {
            0 => String::new(),
            _ => format!("; {} first, to make room for the tools", names(&self.obstacles)),
        };
        format!("{wanted}: {others} ({}){screws}{room}; {least}", names(&self.others))
    }
}
