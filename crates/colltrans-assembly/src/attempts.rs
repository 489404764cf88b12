//! Options of the command line to try next, if parts stay together. They are printed, and never applied.

use crate::bodies::Fit;
use crate::digits::short_number;
use crate::findings::Analysis;
use crate::plan::{Interlocked, PathSearch, PlanOptions};
use crate::roles::Role;

/// A tolerance below this share of the size of the assembly hardly lets parts with an exact fit slide.
const SLIDING_SHARE: f64 = 1e-6;
/// Factor of the effort that is suggested after a search that did not end by itself.
const MORE_EFFORT: u32 = 10;

/// An option to try, with its value, and the reason.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Attempt {
    /// The option as written on the command line, for example `--effort 100`.
    pub option: String,
    /// The reason, without a full stop.
    pub reason: String,
}

/// Returns the options to try next: suggested roles, a snap, a tolerance, and more effort. Returns none if no parts
/// stay interlocked.
pub fn next_attempts(found: &Analysis) -> Vec<Attempt> {
    let stuck = &found.plan.interlocked;
    if stuck.is_empty() {
        return Vec::new();
    }
    let mut all = Vec::new();
    let mut add = |option: String, reason: String| all.push(Attempt { option, reason });
    let apart = matches!(found.bodies.fit(), Fit::MinGap(_));
    match found.suggestions.len() {
        0 => (),
        _ if apart => (),
        1 => add("--auto".into(), "one pair has a suggested role or tolerance".into()),
        pairs => add("--auto".into(), format!("{pairs} pairs have suggested roles or tolerances")),
    }
    let assembly = found.bodies.assembly();
    for suggestion in &found.suggestions {
        if let (Some(Role::Snap), Some(length)) = (suggestion.fit.role, suggestion.fit.tolerance) {
            let names = assembly.part_names(&suggestion.parts).join(",");
            add(format!("--snap {names}={length}"), suggestion.reason.clone());
        }
    }
    let overlapping = |stuck: &Interlocked| !stuck.overlapping_pairs.is_empty();
    if let Some(tolerance) = found.start.suggested_tolerance
        && !apart
        && stuck.iter().any(overlapping)
    {
        let reason = "with it no shallow overlap is left, and overlapping parts move as one";
        add(format!("--tolerance {}", short_number(tolerance)), reason.into());
    }
    let tolerance = found.bodies.fit().tolerance();
    let sliding = sliding_tolerance(found);
    let searched = |stuck: &Interlocked| matches!(stuck.path_search, PathSearch::NotFound { .. });
    if (0.0..sliding).contains(&tolerance)
        && !stuck.iter().any(overlapping)
        && stuck.iter().any(searched)
    {
        let reason = "parts that fit exactly can hardly slide in several moves with a smaller one";
        add(format!("--tolerance {}", short_number(sliding)), reason.into());
    }
    let efforts = stuck.iter().filter_map(|stuck| match &stuck.path_search {
        PathSearch::NotFound { effort, searched } if !searched.complete => Some(*effort),
        _ => None,
    });
    if let Some(effort) = efforts.max() {
        let more = effort.saturating_mul(MORE_EFFORT);
        let reason =
            format!("several moves were not found with effort {effort}, which proves nothing");
        add(format!("--effort {more}"), reason);
    } else if stuck.iter().any(|stuck| stuck.path_search == PathSearch::EFFORT_ZERO) {
        let effort = PlanOptions::DEFAULT_EFFORT;
        add(format!("--effort {effort}"), "several moves were not searched".into());
    }
    all
}

/// Returns the power of ten at or below [`SLIDING_SHARE`] of the size of the assembly.
fn sliding_tolerance(found: &Analysis) -> f64 {
    let size = found.bodies.assembly().bounds().side_lengths().length();
    10_f64.powf((SLIDING_SHARE * size).log10().floor())
}
