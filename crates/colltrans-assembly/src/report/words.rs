//! Lengths, directions and names as text for mechanics.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::{DQuat, DVec3};

use super::{Analysis, direction_name, short_number};
use crate::digits::without_trailing_zeros;
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
/// Decimals of lengths in each unit: 0.01 mm, or a little finer.
const DECIMALS: [(&str, usize); 6] =
    [("mm", 2), ("cm", 3), ("m", 3), ("in", 3), ("ft", 3), ("micron", 1)];
/// Significant digits of the size of an assembly by which lengths are rounded if the unit is unknown or large.
const SIZE_DIGITS: i32 = 4;
/// Maximum number of decimals of a small length.
const MAX_DECIMALS: usize = 9;
/// Decimals of angles in degrees.
const ANGLE_DECIMALS: usize = 1;
/// Angle in radians below which directions count as equal.
const SAME_DIRECTION: f64 = 1e-6;

/// Formats lengths, directions and names of an assembly.
pub(super) struct Words<'a> {
    assembly: &'a Assembly,
    /// Directions to the right, to the back and up. In the default view the front and the right are nearest.
    frame: [DVec3; 3],
    factor: f64,
    unit: &'a str,
    /// Number of decimals of lengths.
    decimals: usize,
}

impl<'a> Words<'a> {
    /// Selects the unit. Assemblies in metres that are smaller than 2 m are described in millimetres.
    pub(super) fn new(f: &Analysis<'a>) -> Self {
        let assembly = f.bodies.assembly();
        let unit = assembly.unit().unwrap_or_default();
        // Machines that fit on a bench are measured in millimetres.
        let small = units::unit_in_metres(unit) == Some(1.0) && assembly.coordinate_size() < 2.0;
        let (factor, unit) = if small { (1e3, "mm") } else { (1.0, unit) };
        let bounds = assembly.bounds();
        let size = (bounds.high - bounds.low).length() * factor;
        let turn = DQuat::from_rotation_arc(DVec3::Z, f.up);
        let frame = [turn * DVec3::X, turn * DVec3::Y, f.up];
        Self { assembly, frame, factor, unit, decimals: length_decimals(unit, size) }
    }

    /// Formats a length with its unit.
    pub(super) fn length_text(&self, x: f64) -> String {
        self.with_unit(self.length_number(x))
    }

    /// Formats a length without its unit, rounded as on a drawing.
    pub(super) fn length_number(&self, x: f64) -> String {
        drawing_number(x * self.factor, self.decimals)
    }

    /// Formats a length that may be far below the precision of a drawing, such as a tolerance, without an exponent.
    pub(super) fn fine_length_text(&self, x: f64) -> String {
        let x = x * self.factor;
        if x == 0.0 || !x.is_finite() {
            return self.with_unit(drawing_number(x, 0));
        }
        let two_digits = 1 - x.abs().log10().floor() as i32;
        let decimals = usize::try_from(two_digits).unwrap_or(0).clamp(self.decimals, MAX_DECIMALS);
        self.with_unit(drawing_number(x, decimals))
    }

    /// Formats an area without an exponent.
    pub(super) fn area_text(&self, x: f64) -> String {
        self.with_power(plain_number(x * self.factor.powi(2)), "²")
    }

    /// Formats a volume without an exponent; from 1000 mm³ on in cubic centimetres.
    pub(super) fn volume_text(&self, x: f64) -> String {
        let x = x * self.factor.powi(3);
        if self.unit == "mm" && x.abs() >= 1e3 {
            return format!("{} cm³", plain_number(x / 1e3));
        }
        self.with_power(plain_number(x), "³")
    }

    /// Appends a power of the unit, if it is known.
    fn with_power(&self, number: String, power: &str) -> String {
        if self.unit.is_empty() { number } else { format!("{number} {}{power}", self.unit) }
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
        let side = |x: f64| if x < least { 0.0 } else { x };
        size.to_array().map(|x| self.length_number(side(x))).join(" × ")
    }

    /// Returns the unit of lengths; empty if it is unknown.
    pub(super) const fn unit(&self) -> &str {
        self.unit
    }

    /// Formats a direction in words: "up (+z)", "towards the front (−y)", "towards the front, 34 degrees up". An axis
    /// of the files is added in brackets.
    pub(super) fn direction_text(&self, d: DVec3) -> String {
        let [right, back, up] = self.frame.map(|axis| d.dot(axis));
        let elevation = up.atan2(right.hypot(back)).to_degrees();
        let rounds_to_zero = |degrees: f64| {
            drawing_number(degrees.abs(), ANGLE_DECIMALS).starts_with("under") || degrees == 0.0
        };
        let vertical = if up > 0.0 { "up" } else { "down" };
        let mut words = Vec::new();
        if rounds_to_zero(90.0 - elevation.abs()) {
            words.push(vertical.to_owned());
        } else {
            let (along, [main, side]) = match (right.abs() > back.abs(), right > 0.0, back > 0.0) {
                (true, is_right, is_back) => (
                    back.abs().atan2(right.abs()),
                    [
                        if is_right { "right" } else { "left" },
                        if is_back { "back" } else { "front" },
                    ],
                ),
                (false, is_right, is_back) => (
                    right.abs().atan2(back.abs()),
                    [
                        if is_back { "back" } else { "front" },
                        if is_right { "right" } else { "left" },
                    ],
                ),
            };
            words.push(format!("towards the {main}"));
            let degrees = |x: f64| drawing_number(x.abs(), ANGLE_DECIMALS);
            if !rounds_to_zero(along.to_degrees()) {
                words.push(format!("{} degrees to the {side}", degrees(along.to_degrees())));
            }
            if !rounds_to_zero(elevation) {
                words.push(format!("{} degrees {vertical}", degrees(elevation)));
            }
        }
        let is_single = words.len() == 1;
        let text = words.join(", ");
        let axis = nearest_axis(d);
        if angle(d, axis) < SAME_DIRECTION {
            return format!("{text} ({})", direction_name(axis));
        }
        let is_exact = self.frame.iter().any(|&own| own.cross(d).length() < SAME_DIRECTION);
        if is_single && !is_exact { format!("almost {text}") } else { text }
    }

    /// Returns the names of the directions by axes of the files: "front is −y, right is +x, up is +z"; `None` if the
    /// upward direction is not an axis.
    pub(super) fn frame_text(&self) -> Option<String> {
        let [right, back, up] = self.frame;
        let axis = |d: DVec3| {
            let axis = nearest_axis(d);
            (angle(d, axis) < SAME_DIRECTION).then(|| direction_name(axis))
        };
        let [front, right, up] = [axis(DVec3::ZERO - back)?, axis(right)?, axis(up)?];
        Some(format!("front is {front}, right is {right}, up is {up}"))
    }

    /// Describes a move with its travel and its rotation, or its reverse.
    pub(super) fn move_text(&self, leg: &Leg, is_reversed: bool) -> String {
        let sign = if is_reversed { -1.0 } else { 1.0 };
        let mut text = self.direction_text(leg.direction * sign + DVec3::ZERO);
        if self.is_significant(leg.travel) {
            text = format!("{text}, {}", self.length_text(leg.travel));
        }
        let Some(turn) = &leg.turn else { return text };
        // The reverse of a screw motion has the same hand; it is described from the other side.
        let hand = if turn.turns * sign < 0.0 { "clockwise" } else { "counter-clockwise" };
        let (verb, side) =
            if is_reversed { ("screwed in", "along") } else { ("unscrewed", "against") };
        let turns = if leg.travel == 0.0 {
            format!("turned by {:.0} degrees", 360.0 * turn.turns.abs())
        } else {
            format!("{verb} by {:.1} turns", turn.turns.abs())
        };
        format!("{turns} {hand} as viewed {side} its motion; {text}")
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

/// Returns the number of decimals of lengths in a unit, for an assembly of a size in this unit.
fn length_decimals(unit: &str, size: f64) -> usize {
    let by_size = if size > 0.0 && size.is_finite() {
        usize::try_from(SIZE_DIGITS - 1 - size.log10().floor() as i32).unwrap_or(0)
    } else {
        SIZE_DIGITS as usize
    };
    let by_unit = DECIMALS.iter().find(|(name, _)| *name == unit).map(|(_, decimals)| *decimals);
    let decimals = match by_unit {
        Some(decimals) if size >= 1.0 || size == 0.0 => decimals,
        Some(decimals) => decimals.max(by_size),
        None => by_size,
    };
    decimals.min(MAX_DECIMALS)
}

/// Formats a number with at most this many decimals and without an exponent. A number that would become zero is
/// "under" the smallest one.
pub(super) fn drawing_number(x: f64, decimals: usize) -> String {
    if !x.is_finite() {
        return "∞".into();
    }
    let text = without_trailing_zeros(format!("{x:.decimals$}"));
    match &text[..] {
        "0" | "-0" if x != 0.0 => {
            format!("under {:.decimals$}", 0.1_f64.powi(i32::try_from(decimals).unwrap_or(0)))
        }
        "-0" => "0".into(),
        _ => text,
    }
}

/// Formats a number with four significant digits and without an exponent.
pub(super) fn plain_number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return drawing_number(x, 0);
    }
    let decimals = usize::try_from(3 - x.abs().log10().floor() as i32).unwrap_or(0);
    drawing_number(x, decimals.min(MAX_DECIMALS))
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
        let words = words(&assembly, DVec3::Z);
        assert_eq!(words.extent_text(DVec3::new(2.4e-12, 0.0254, 0.054)), "0 × 25.4 × 54 mm");
        assert_eq!(words.sides_text(DVec3::new(2.4e-6, 0.0254, 0.054)), "under 0.01 × 25.4 × 54");
    }

    /// Returns words for an assembly in metres, in millimetres.
    fn words(assembly: &Assembly, up: DVec3) -> Words<'_> {
        let turn = DQuat::from_rotation_arc(DVec3::Z, up);
        let frame = [turn * DVec3::X, turn * DVec3::Y, up];
        Words { assembly, frame, factor: 1e3, unit: "mm", decimals: length_decimals("mm", 50.0) }
    }

    #[test]
    fn lengths_have_hundredths_of_a_millimetre_and_no_exponent() {
        let assembly = Assembly::default();
        let words = words(&assembly, DVec3::Z);
        let lengths = [0.0, 6.25e-7, 0.006_251_4, 0.012, 12_345.678_912, -0.002_5];
        let expected = ["0 mm", "under 0.01 mm", "6.25 mm", "12 mm", "12345678.91 mm", "-2.5 mm"];
        assert_eq!(lengths.map(|x| words.length_text(x)), expected);
        let tolerances = [0.0, 6.25e-7, 1e-4, 0.012_345, 6e-15];
        let expected = ["0 mm", "0.00063 mm", "0.1 mm", "12.35 mm", "under 0.000000001 mm"];
        assert_eq!(tolerances.map(|x| words.fine_length_text(x)), expected);
        assert_eq!([2e-9, 5e-6].map(|x| words.volume_text(x)), ["2 mm³", "5 cm³"]);
        assert_eq!(words.area_text(1.23456e-10), "0.0001235 mm²");
        assert_eq!(plain_number(123_456_789.0), "123456789");
    }

    #[test]
    fn unknown_and_small_units_are_rounded_by_size() {
        assert_eq!(length_decimals("", 24.0), 2);
        assert_eq!(length_decimals("", 0.005), 6);
        assert_eq!(length_decimals("mm", 0.5), 4);
        assert_eq!(length_decimals("mm", 300.0), 2);
        assert_eq!(length_decimals("", 1e7), 0);
    }

    #[test]
    fn directions_are_described_in_words() {
        let assembly = Assembly::default();
        let by_angles = |towards: DVec3, degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            towards * cos + DVec3::Z * sin
        };
        let named = words(&assembly, DVec3::Z);
        let cases = [
            (DVec3::Z, "up (+z)"),
            (DVec3::NEG_Z, "down (−z)"),
            (DVec3::NEG_Y, "towards the front (−y)"),
            (DVec3::NEG_X, "towards the left (−x)"),
            (by_angles(DVec3::NEG_Y, 34.0), "towards the front, 34 degrees up"),
            (by_angles(DVec3::X, -12.5), "towards the right, 12.5 degrees down"),
            (DVec3::new(0.6, 0.8, 0.0), "towards the back, 36.9 degrees to the right"),
            (by_angles(DVec3::Y, 89.99), "almost up"),
            (by_angles(DVec3::Y, 0.01), "almost towards the back"),
        ];
        for (d, text) in cases {
            assert_eq!(named.direction_text(d), text);
        }
        assert_eq!(named.frame_text().unwrap(), "front is −y, right is +x, up is +z");
        let gltf = words(&assembly, DVec3::Y);
        assert_eq!(gltf.direction_text(DVec3::Z), "towards the front (+z)");
        assert_eq!(gltf.direction_text(DVec3::Y), "up (+y)");
        assert_eq!(gltf.frame_text().unwrap(), "front is +z, right is +x, up is +y");
        let tilted = words(&assembly, DVec3::new(0.0, 0.6, 0.8));
        assert_eq!(tilted.direction_text(DVec3::new(0.0, 0.6, 0.8)), "up");
        assert_eq!(tilted.frame_text(), None);
    }

    #[test]
    fn times_from_120_seconds_are_in_minutes() {
        let told = [24.0, 94.5, 120.0, 228.4].map(time_text);
        assert_eq!(told, ["24 s", "94.5 s", "2 min", "3 min 48 s"]);
    }
}
