//! Lengths, directions and names as a mechanic reads them.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::DVec3;

use super::{Findings, arrow, digits, short};
use crate::likes::common_name;
use crate::part::Assembly;
use crate::plan::Leg;
use crate::{Fit, units};

/// Names are listed up to so many.
const MOST_NAMES: usize = 8;
/// Parts that leave as one are all named up to one more than so many, ...
const MOST_OF_GROUP: usize = 4;
/// ... and names of parts of one shape, without their numbers, up to so many.
const MOST_STEMS: usize = 3;
/// Runs of numbers are all told up to so many.
const MOST_RUNS: usize = 5;
/// Sides that are less than this share of the longest one are those of a sheet.
const FLAT: f64 = 1e-6;
/// Directions that differ by less than this angle in radians are told as one.
const EQUAL: f64 = 1e-6;

/// How lengths and directions are told.
pub(super) struct Words<'a> {
    assembly: &'a Assembly,
    up: DVec3,
    factor: f64,
    unit: &'a str,
}

impl<'a> Words<'a> {
    pub(super) fn new(f: &Findings<'a>) -> Self {
        let assembly = f.bodies.assembly();
        let unit = assembly.unit().unwrap_or_default();
        // What fits on a bench is measured in millimetres.
        let small = units::metres(unit) == Some(1.0) && assembly.size() < 2.0;
        let (factor, unit) = if small { (1e3, "mm") } else { (1.0, unit) };
        Self { assembly, up: f.up, factor, unit }
    }

    pub(super) fn length(&self, x: f64) -> String {
        self.with_unit(short(x * self.factor))
    }

    fn with_unit(&self, number: String) -> String {
        if self.unit.is_empty() { number } else { format!("{number} {}", self.unit) }
    }

    /// Width, depth and height.
    pub(super) fn extent(&self, size: DVec3) -> String {
        self.with_unit(self.sides(size))
    }

    /// The same without the unit; what rounding leaves of a sheet's thickness is none.
    pub(super) fn sides(&self, size: DVec3) -> String {
        let least = FLAT * size.max_element();
        let side = |x: f64| if x < least { 0.0 } else { x * self.factor };
        size.to_array().map(|x| digits(side(x), 3)).join(" × ")
    }

    /// What lengths are measured in; nothing, if that is not known.
    pub(super) const fn unit(&self) -> &str {
        self.unit
    }

    /// "up (+z)", "along −x", "12° off +y (0.2, 0.98, 0)".
    pub(super) fn way(&self, d: DVec3) -> String {
        let off = |axis: DVec3| angle(d, axis);
        if off(self.up) < EQUAL {
            return format!("up ({})", axis_name(d));
        }
        if off(DVec3::ZERO - self.up) < EQUAL {
            return format!("down ({})", axis_name(d));
        }
        let axis = nearest_axis(d);
        if off(axis) < EQUAL {
            return format!("along {}", arrow(axis));
        }
        let by = digits(off(axis).to_degrees(), 2);
        format!("{by}° off {} {}", arrow(axis), arrow(d).replace('-', "−"))
    }

    /// A move, how far it goes, and how much it is turned meanwhile.
    pub(super) fn leg(&self, leg: &Leg) -> String {
        let mut said = self.way(leg.direction);
        if self.is_far(leg.travel) {
            said = format!("{said}, {}", self.length(leg.travel));
        }
        let Some(turn) = &leg.turn else { return said };
        let hand = if turn.turns < 0.0 { "clockwise" } else { "counter-clockwise" };
        let turns = if leg.travel == 0.0 {
            format!("turned by {:.0} degrees", 360.0 * turn.turns.abs())
        } else {
            format!("unscrewed by {:.1} turns", turn.turns.abs())
        };
        format!("{turns} {hand} as seen from where it goes; {said}")
    }

    /// Whether a length is more than the last digits of the file.
    pub(super) fn is_far(&self, travel: f64) -> bool {
        travel > Fit::negligible(self.assembly)
    }

    /// Names, of many the first ones.
    pub(super) fn names(&self, parts: &[usize]) -> String {
        listed(&self.assembly.names(parts), MOST_NAMES)
    }

    /// Parts that stay together, in a few words: their name, or the largest part of it and how many others.
    pub(super) fn group(&self, parts: &[usize]) -> String {
        let names = self.assembly.names(parts);
        if let Some(name) = self.assembly.constraints().name(parts) {
            return name.to_owned();
        }
        match &names[..] {
            [all @ .., last] if (1..MOST_OF_GROUP).contains(&all.len()) => {
                format!("{} and {last}", all.join(", "))
            }
            [_, _, ..] => {
                let size = |&&part: &&usize| self.assembly.parts()[part].bounds().size().length();
                let largest = parts.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
                let name = largest.map_or("", |&part| self.assembly.parts()[part].name());
                format!("{name} with {} others", names.len() - 1)
            }
            _ => names.concat(),
        }
    }

    /// What parts of one shape are called: their names without numbers.
    pub(super) fn kind(&self, parts: &[usize]) -> String {
        let names = self.assembly.names(parts);
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
        listed(&stems, MOST_STEMS)
    }

    /// What parts of one shape are, and how many.
    pub(super) fn count(&self, parts: &[usize]) -> String {
        let kind = self.kind(parts);
        if parts.len() > 1 { format!("{} × {kind}", parts.len()) } else { kind }
    }
}

/// The first ones of many, and how many others there are.
fn listed<T: AsRef<str>>(all: &[T], most: usize) -> String {
    let few = if all.len() <= most + 1 { all } else { &all[..most] };
    let named: Vec<&str> = few.iter().map(AsRef::as_ref).collect();
    match all.len() - few.len() {
        0 => named.join(", "),
        more => format!("{} and {more} more", named.join(", ")),
    }
}

/// The angle between two directions of length 1, in radians.
fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// The axis that a direction is nearest to.
fn nearest_axis(d: DVec3) -> DVec3 {
    let k = d.abs().max_position();
    DVec3::AXES[k] * d[k].signum()
}

fn axis_name(d: DVec3) -> String {
    let axis = nearest_axis(d);
    arrow(if angle(d, axis) < EQUAL { axis } else { d })
}

/// Whole numbers, counted from 1: "1–8, 17"; of many runs the first one and where the last one ends.
pub(super) fn numbers(all: &[usize]) -> String {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for &k in &all.iter().copied().collect::<BTreeSet<usize>>() {
        match runs.last_mut() {
            Some(run) if run.end == k => run.end = k + 1,
            _ => runs.push(k..k + 1),
        }
    }
    let told = |run: &Range<usize>| match run.len() {
        1 => run.end.to_string(),
        2 => format!("{}, {}", run.start + 1, run.end),
        _ => format!("{}–{}", run.start + 1, run.end),
    };
    match &runs[..] {
        [first, .., last] if runs.len() > MOST_RUNS => format!("{}, … {}", told(first), last.end),
        _ => runs.iter().map(told).collect::<Vec<_>>().join(", "),
    }
}

/// A note as a sentence: begun with a capital, unless it begins with a name, and with a full stop.
pub(super) fn sentence(note: &str) -> String {
    let first = note.split(' ').next().unwrap_or_default();
    let is_word = !first.is_empty() && first.bytes().all(|c| c.is_ascii_lowercase());
    let begun = if is_word { first[..1].to_uppercase() + &note[1..] } else { note.to_owned() };
    if begun.ends_with(['.', '!', '?']) { begun } else { begun + "." }
}

/// Seconds, from two minutes on in minutes.
pub(super) fn time(seconds: f64) -> String {
    if seconds < 120.0 {
        return format!("{} s", short(seconds));
    }
    let whole = seconds.round();
    let (minutes, rest) = (whole.div_euclid(60.0), whole.rem_euclid(60.0));
    if rest == 0.0 { format!("{minutes} min") } else { format!("{minutes} min {rest} s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_runs() {
        assert_eq!(numbers(&[3, 0, 1, 2, 5, 7, 8]), "1–4, 6, 8, 9");
        assert_eq!(numbers(&[]), "");
        assert_eq!(numbers(&[2, 5, 6, 9, 11, 14, 17]), "3, … 18");
    }

    #[test]
    fn notes_are_sentences() {
        let told = ["taken as suggested: soft of a,b", "bolt.stl: open.", "leg_1 is open", ""];
        let known = ["Taken as suggested: soft of a,b.", "bolt.stl: open.", "leg_1 is open.", "."];
        assert_eq!(told.map(sentence), known);
    }

    #[test]
    fn sheets_have_no_thickness() {
        let assembly = Assembly::default();
        let words = Words { assembly: &assembly, up: DVec3::Z, factor: 1e3, unit: "mm" };
        assert_eq!(words.extent(DVec3::new(2.4e-12, 0.0254, 0.054)), "0 × 25.4 × 54 mm");
        assert_eq!(words.sides(DVec3::new(2.4e-6, 0.0254, 0.054)), "0.0024 × 25.4 × 54");
    }

    #[test]
    fn times_of_minutes() {
        let told = [24.0, 94.5, 120.0, 228.4].map(time);
        assert_eq!(told, ["24 s", "94.5 s", "2 min", "3 min 48 s"]);
    }
}
