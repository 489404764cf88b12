//! Groups of parts of equal shape, in the order in which the plan removes them.

use std::collections::BTreeMap;

use super::kind_colour;
use crate::part::Part;
use crate::plan::Plan;

/// Parts of equal shape, material and density.
pub(super) struct Kind {
    /// Indices of the parts, in increasing order.
    pub parts: Vec<usize>,
    /// Steps that remove them, in order. Each is the last step of some of the parts.
    pub steps: Vec<usize>,
}

/// Groups the parts by shape, material and density, in the order of their first steps. Kinds that stay are last.
pub(super) fn kinds(plan: &Plan, parts: &[Part]) -> Vec<Kind> {
    let mut step_of = vec![None; parts.len()];
    for (k, step) in plan.steps.iter().enumerate() {
        step.parts.iter().for_each(|&part| step_of[part] = Some(k));
    }
    // Bits of densities, so that they can be compared.
    let mut by_first = BTreeMap::<(usize, Option<&str>, Option<u64>), Vec<usize>>::new();
    for (k, part) in parts.iter().enumerate() {
        let first = plan.first_identical.get(k).copied().unwrap_or(k);
        let key = (first, part.material(), part.density().map(f64::to_bits));
        by_first.entry(key).or_default().push(k);
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

/// Returns the sRGB colour of each part: its own colour if all parts have one and not all are equal,
/// otherwise the colour of its kind.
pub(super) fn part_colours(plan: &Plan, parts: &[Part]) -> Vec<[f64; 3]> {
    let own: Option<Vec<[f64; 3]>> = parts.iter().map(Part::colour).collect();
    if let Some(own) = own.filter(|own| own.iter().any(|colour| *colour != own[0])) {
        return own;
    }
    let mut colours = vec![kind_colour(0); parts.len()];
    for (k, kind) in kinds(plan, parts).iter().enumerate() {
        kind.parts.iter().for_each(|&part| colours[part] = kind_colour(k));
    }
    colours
}
