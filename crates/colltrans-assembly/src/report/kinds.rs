//! Parts of one shape, for a list of parts: in the order in which the plan takes them away.

use std::collections::BTreeMap;

use super::tint;
use crate::part::Part;
use crate::plan::Plan;

/// Parts of one shape.
pub(super) struct Kind {
    /// Their positions, in increasing order.
    pub parts: Vec<usize>,
    /// The steps that take them away, in order, each the last one for some part.
    pub steps: Vec<usize>,
}

/// All kinds, those first that leave first, and those last that stay.
pub(super) fn kinds(plan: &Plan, parts: usize) -> Vec<Kind> {
    let mut step_of = vec![None; parts];
    for (k, step) in plan.steps.iter().enumerate() {
        step.parts.iter().for_each(|&part| step_of[part] = Some(k));
    }
    let mut by_first = BTreeMap::<usize, Vec<usize>>::new();
    for part in 0..parts {
        let first = plan.likes.get(part).copied().unwrap_or(part);
        by_first.entry(first).or_default().push(part);
    }
    let kind = |parts: Vec<usize>| {
        let mut steps: Vec<usize> = parts.iter().filter_map(|&part| step_of[part]).collect();
        steps.sort_unstable();
        steps.dedup();
        Kind { parts, steps }
    };
    let mut all: Vec<Kind> = by_first.into_values().map(kind).collect();
    all.sort_by_key(|kind| kind.steps.first().copied().unwrap_or(usize::MAX));
    all
}

/// The colour of each part, as screens have it: its own, if the parts have colours that tell some of them apart; else that of
/// its kind.
pub(super) fn colours(plan: &Plan, parts: &[Part]) -> Vec<[f64; 3]> {
    let own: Option<Vec<[f64; 3]>> = parts.iter().map(Part::colour).collect();
    if let Some(own) = own.filter(|own| own.iter().any(|colour| *colour != own[0])) {
        return own;
    }
    let mut colours = vec![tint(0); parts.len()];
    for (k, kind) in kinds(plan, parts.len()).iter().enumerate() {
        kind.parts.iter().for_each(|&part| colours[part] = tint(k));
    }
    colours
}
