//! Lengths, directions and names as text for mechanics.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::DVec3;

use super::{Analysis, direction_name, rounded_number, short_number};
use crate::identical::common_name;
use crate::part::Assembly;
use crate::plan::Leg;
use crate::{Fit, units};

/// Maximum number of listed names.
const MAX_NAMES: usize = 8;
/// Groups of at most one part more than this are listed completely.
const MAX_GROUP_NAMES: usize = 4;
/// Maximum number of listed names without numbers of parts of equal shape.
const MAX_STEMS: usize = 3;
/// Maximum number of listed runs of numbers.
const MAX_RUNS: usize = 5;
/// Sides below this share of the longest one count as 0, as for sheets.
const MIN_SIDE: f64 = 1e-6;
/// Angle in radians below which directions count as equal.
const SAME_DIRECTION: f64 = 1e-6;

/// Formats lengths, directions and names of an assembly.
pub(super) struct Words<'a> {
    assembly: &'a Assembly,
    up: DVec3,
    factor: f64,
    unit: &'a str,
}

impl<'a> Words<'a> {
    /// Selects the unit. Assemblies in metres that are smaller than 2 m are described in millimetres.
    pub(super) fn new(f: &Analysis<'a>) -> Self {
        let assembly = f.bodies.assembly();
        let unit = assembly.unit().unwrap_or_default();
        // Machines that fit on a bench are measured in millimetres.
        let small = units::unit_in_metres(unit) == Some(1.0) && assembly.coordinate_size() < 2.0;
        let (factor, unit) = if small { (1e3, "mm") } else { (1.0, unit) };
        Self { assembly, up: f.up, factor, unit }
    }

    /// Formats a length with its unit.
    pub(super) fn length_text(&self, x: f64) -> String {
        self.with_unit(short_number(x * self.factor))
    }

    /// Appends the unit, if it is known.
    fn with_unit(&self, number: String) -> String {
        if self.unit.is_empty() { number } else { format!("{number} {}", self.unit) }
    }

    /// Formats the sides of a box with the unit.
    pub(super) fn extent_text(&self, size: DVec3) -> String {
        self.with_unit(self.sides_text(size))
    }

    /// Formats the sides of a box without the unit. A side below [`MIN_SIDE`] of the largest one, such as the rounded
    /// thickness of a flat surface, becomes 0.
    pub(super) fn sides_text(&self, size: DVec3) -> String {
        let least = MIN_SIDE * size.max_element();
        let side = |x: f64| if x < least { 0.0 } else { x * self.factor };
        size.to_array().map(|x| rounded_number(side(x), 3)).join(" × ")
    }

    /// Returns the unit of lengths; empty if it is unknown.
    pub(super) const fn unit(&self) -> &str {
        self.unit
    }

    /// Formats a direction: "up (+z)", "along −x", "12° off +y (0.2, 0.98, 0)".
    pub(super) fn direction_text(&self, d: DVec3) -> String {
        let off = |axis: DVec3| angle(d, axis);
        if off(self.up) < SAME_DIRECTION {
            return format!("up ({})", axis_name(d));
        }
        if off(DVec3::ZERO - self.up) < SAME_DIRECTION {
            return format!("down ({})", axis_name(d));
        }
        let axis = nearest_axis(d);
        if off(axis) < SAME_DIRECTION {
            return format!("along {}", direction_name(axis));
        }
        let by = rounded_number(off(axis).to_degrees(), 2);
        format!("{by}° off {} {}", direction_name(axis), direction_name(d).replace('-', "−"))
    }

    /// Describes a move with its travel and its rotation.
    pub(super) fn move_text(&self, leg: &Leg) -> String {
        let mut text = self.direction_text(leg.direction);
        if self.is_significant(leg.travel) {
            text = format!("{text}, {}", self.length_text(leg.travel));
        }
        let Some(turn) = &leg.turn else { return text };
        let hand = if turn.turns < 0.0 { "clockwise" } else { "counter-clockwise" };
        let turns = if leg.travel == 0.0 {
            format!("turned by {:.0} degrees", 360.0 * turn.turns.abs())
        } else {
            format!("unscrewed by {:.1} turns", turn.turns.abs())
        };
        format!("{turns} {hand} as viewed against its motion; {text}")
    }

    /// Checks whether a length exceeds the last digits of the files.
    pub(super) fn is_significant(&self, travel: f64) -> bool {
        travel > Fit::negligible(self.assembly)
    }

    /// Lists names, at most the first ones.
    pub(super) fn name_list(&self, parts: &[usize]) -> String {
        joined_names(&self.assembly.part_names(parts), MAX_NAMES)
    }

    /// Describes parts that move as one: the name of the subassembly, the names of few parts, or the largest
    /// part and the number of others.
    pub(super) fn group_text(&self, parts: &[usize]) -> String {
        let names = self.assembly.part_names(parts);
        if let Some(name) = self.assembly.constraints().group_name(parts) {
            return name.to_owned();
        }
        match &names[..] {
            [all @ .., last] if (1..MAX_GROUP_NAMES).contains(&all.len()) => {
                format!("{} and {last}", all.join(", "))
            }
            [_, _, ..] => {
                let size =
                    |&&part: &&usize| self.assembly.parts()[part].bounds().side_lengths().length();
                let largest = parts.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
                let name = largest.map_or("", |&part| self.assembly.parts()[part].name());
                format!("{name} with {} others", names.len() - 1)
            }
            _ => names.concat(),
        }
    }

    /// Returns the names, without numbers, of parts of equal shape.
    pub(super) fn kind_name(&self, parts: &[usize]) -> String {
        let names = self.assembly.part_names(parts);
        if let [name] = &names[..] {
            return (*name).to_owned();
        }
        let mut stems: Vec<String> = Vec::new();
        for name in names {
            let stem = common_name(&[name]).unwrap_or_else(|| name.to_owned());
            if !stems.contains(&stem) {
                stems.push(stem);
            }
        }
        joined_names(&stems, MAX_STEMS)
    }

    /// Describes parts of equal shape with their number.
    pub(super) fn count_text(&self, parts: &[usize]) -> String {
        let kind = self.kind_name(parts);
        if parts.len() > 1 { format!("{} × {kind}", parts.len()) } else { kind }
    }
}

/// Joins the first items and the number of further ones.
fn joined_names<T: AsRef<str>>(all: &[T], most: usize) -> String {
    let few = if all.len() <= most + 1 { all } else { &all[..most] };
    let named: Vec<&str> = few.iter().map(AsRef::as_ref).collect();
    match all.len() - few.len() {
        0 => named.join(", "),
        more => format!("{} and {more} more", named.join(", ")),
    }
}

/// Returns the angle in radians between two directions of length 1.
fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// Returns the signed axis nearest to a direction.
fn nearest_axis(d: DVec3) -> DVec3 {
    let k = d.abs().max_position();
    DVec3::AXES[k] * d[k].signum()
}

/// Formats a direction, as an axis if it is nearly parallel to one.
fn axis_name(d: DVec3) -> String {
    let axis = nearest_axis(d);
    direction_name(if angle(d, axis) < SAME_DIRECTION { axis } else { d })
}

/// Formats indices as numbers from 1 on, merged into runs: "1–8, 17". More than [`MAX_RUNS`] runs are
/// shortened to the first run and the last number.
pub(super) fn number_runs(all: &[usize]) -> String {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for &k in &all.iter().copied().collect::<BTreeSet<usize>>() {
        match runs.last_mut() {
            Some(run) if run.end == k => run.end = k + 1,
            _ => runs.push(k..k + 1),
        }
    }
    let format_run = |run: &Range<usize>| match run.len() {
        1 => run.end.to_string(),
        2 => format!("{}, {}", run.start + 1, run.end),
        _ => format!("{}–{}", run.start + 1, run.end),
    };
    match &runs[..] {
        [first, .., last] if runs.len() > MAX_RUNS => {
            format!("{}, … {}", format_run(first), last.end)
        }
        _ => runs.iter().map(format_run).collect::<Vec<_>>().join(", "),
    }
}

/// Formats a note as a sentence, with a full stop and a capital, unless it begins with a name.
pub(super) fn sentence(note: &str) -> String {
    let first = note.split(' ').next().unwrap_or_default();
    let is_word = !first.is_empty() && first.bytes().all(|c| c.is_ascii_lowercase());
    let begun = if is_word { first[..1].to_uppercase() + &note[1..] } else { note.to_owned() };
    if begun.ends_with(['.', '!', '?']) { begun } else { begun + "." }
}

/// Formats a time in seconds, or in minutes from 120 s on.
pub(super) fn time_text(seconds: f64) -> String {
    if seconds < 120.0 {
        return format!("{} s", short_number(seconds));
    }
    let whole = seconds.round();
    let (minutes, rest) = (whole.div_euclid(60.0), whole.rem_euclid(60.0));
    if rest == 0.0 { format!("{minutes} min") } else { format!("{minutes} min {rest} s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_runs_merge_consecutive_indices() {
        assert_eq!(number_runs(&[3, 0, 1, 2, 5, 7, 8]), "1–4, 6, 8, 9");
        assert_eq!(number_runs(&[]), "");
        assert_eq!(number_runs(&[2, 5, 6, 9, 11, 14, 17]), "3, … 18");
    }

    #[test]
    fn sentences_get_capital_and_full_stop() {
        let told = ["taken as suggested: soft of a,b", "bolt.stl: open.", "leg_1 is open", ""];
        let known = ["Taken as suggested: soft of a,b.", "bolt.stl: open.", "leg_1 is open.", "."];
        assert_eq!(told.map(sentence), known);
    }

    #[test]
    fn thickness_of_sheet_is_zero() {
        let assembly = Assembly::default();
        let words = Words { assembly: &assembly, up: DVec3::Z, factor: 1e3, unit: "mm" };
        assert_eq!(words.extent_text(DVec3::new(2.4e-12, 0.0254, 0.054)), "0 × 25.4 × 54 mm");
        assert_eq!(words.sides_text(DVec3::new(2.4e-6, 0.0254, 0.054)), "0.0024 × 25.4 × 54");
    }

    #[test]
    fn times_from_120_seconds_are_in_minutes() {
        let told = [24.0, 94.5, 120.0, 228.4].map(time_text);
        assert_eq!(told, ["24 s", "94.5 s", "2 min", "3 min 48 s"]);
    }
}
