//! The report of an audit: one HTML file with all findings, the worst first.
//!
//! - Each finding has its numbers and a section through its place (module `cut`).
//! - A click on a finding shows the pair in the viewer, a cut through it, and the shortest way out that was found as a
//!   motion. The script also filters the list. Without scripts the list is complete.
//! - The file contains each part once. Sections and parts are limited by `MAX_SECTION_BYTES` and
//!   `viewer::MAX_TRIANGLES`; the worst findings come first. Names are shortened, because each entry repeats them.

use colltrans::Aabb;
use colltrans_mesh::plain::escape_control;
use glam::DVec3;
use maud::{Markup, PreEscaped, html};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::cut::{Cut, Measure};
use super::{
    direction_name, html, kind_colour, picture_markup, rounded_number, short_number, viewer,
};
use crate::audit::{Audit, AuditOptions, AuditedPair, ClearanceLevel, PairFinding};
use crate::bodies::Bodies;
use crate::error::AssemblyError;
use crate::part::Assembly;
use crate::watch::{Stage, Watch};

/// Maximum number of listed findings.
const MAX_FINDINGS: usize = 5_000;
/// Number of bytes of all sections after which no more are drawn.
const MAX_SECTION_BYTES: usize = 24_000_000;
/// Maximum number of characters of a name in the list.
const MAX_NAME: usize = 120;
/// Maximum number of characters of a unit.
const MAX_UNIT: usize = 16;
/// Maximum number of listed clearances of groups.
const MAX_LEVELS: usize = 20;
/// Number of digits of a length, and their maximum if a distance and its clearance differ by little.
const DIGITS: [i32; 2] = [4, 9];
/// Number of sections that are drawn at a time.
const SECTIONS_AT_A_TIME: usize = 64;
/// Names of the findings, in the order of the report.
const KINDS: [&str; 4] = ["interfering", "contained", "touching", "apart"];
/// Style sheet in addition to that of all reports.
const CLASH_STYLE: &str = "
body { max-width: 88em; }
.clash { padding: 0; margin: 0 0 .5em; }
.clash > summary { padding: .45em .9em; display: flex; gap: .2em .8em; align-items: baseline; flex-wrap: wrap; }
.clash > summary::before { content: '▸'; color: var(--soft); }
.clash[open] > summary::before { content: '▾'; }
.clash.shown { border-color: #0b57d0; box-shadow: 0 0 0 1px #0b57d0; }
.clash > div { padding: 0 .9em .6em; }
.clash .names { flex: 1 1 9em; min-width: 0; overflow-wrap: anywhere; }
.clash .measure { font-weight: 400; white-space: nowrap; }
.clash figure > svg { border: 1px solid var(--line); }
.kind { font-size: .8em; padding: .05em .6em; border-radius: 1em; color: #fff; background: #56616f; }
.kind.interfering { background: #b01657; } .kind.contained { background: #8a3ea8; } .kind.apart { background: #b45f06; }
.filter { display: flex; flex-wrap: wrap; gap: .5em 1em; margin: .6em 0; align-items: center; }
.filter select, .filter input { font: inherit; padding: .2em .5em; max-width: 100%; }
.blue { background: #7b9cc9; } .sand { background: #c6bca5; } .both { background: #b01657; }
#clashes #viewer { position: sticky; top: .5em; z-index: 1; margin: 0 0 1em; }
#clashes #viewer .view { height: 34vh; }
@media (min-width: 62em) {
  #clashes { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1.1fr); gap: 0 1.4em; align-items: start; }
  #clashes #viewer { grid-column: 2; grid-row: 1; }
  #clashes #viewer .view { height: min(70vh, 44em); }
}
@media print { .clash:not([open]):not([hidden]) { display: block; } .clash { break-inside: avoid; } .filter { display: none; } }
";

/// A line of text about a finding.
pub(super) struct Fact {
    /// Name of the quantity.
    pub(super) name: &'static str,
    /// Value with its unit.
    pub(super) value: String,
}

/// Returns the report as an HTML document.
///
/// # Errors
/// [`AssemblyError::Cancelled`].
pub fn clashes_page(
    bodies: &Bodies,
    options: &AuditOptions,
    audit: &Audit,
    title: &str,
    watch: Watch,
) -> Result<String, AssemblyError> {
    let assembly = bodies.assembly();
    let listed = &audit.pairs[..audit.pairs.len().min(MAX_FINDINGS)];
    let sections = sections(assembly, listed, watch)?;
    let body = html! {
        main {
            h1 { (title) }
            (summary(bodies, options, audit))
            div id="clashes" {
                (viewer(assembly, listed))
                div id="findings" {
                    @for (k, pair) in listed.iter().enumerate() {
                        (finding(assembly, k, pair, sections.get(k)))
                    }
                }
            }
        }
        script { (PreEscaped(viewer::SCRIPT)) }
    };
    Ok(html::document(title, CLASH_STYLE, &body))
}

/// Returns the numbers of findings and the settings of the audit.
fn summary(bodies: &Bodies, options: &AuditOptions, audit: &Audit) -> Markup {
    let assembly = bodies.assembly();
    let (counts, parts) = (audit.counts, assembly.parts().len());
    let numbers = [counts.interfering, counts.contained, counts.touching, counts.near];
    let is_clean = counts.violations == 0;
    let violations = match counts.violations {
        0 => "No pair violates its clearance.".into(),
        1 => "1 pair violates its clearance.".into(),
        count => format!("{count} pairs violate their clearance."),
    };
    let more = audit.pairs.len().saturating_sub(MAX_FINDINGS);
    let levels = options.levels();
    let more_levels = levels.len().saturating_sub(MAX_LEVELS);
    let group = |names: &[String]| shortened(&names.join(", "), MAX_NAME);
    let of = |ClearanceLevel { names: [a, b], .. }: &ClearanceLevel| [group(a), group(b)];
    html! {
        p.proof[is_clean].warn[!is_clean] { b { (violations) } }
        dl.facts {
            div { dt { "parts" } dd { (parts) } }
            div { dt { "examined pairs" } dd { (counts.examined) } }
            @for (kind, number) in KINDS.iter().zip(numbers) {
                div { dt { (kind) } dd { (number) } }
            }
            div { dt { "clearance" } dd { (length_text(options.within, assembly)) } }
            div { dt { "tolerance, at most" } dd { (length_text(bodies.fit().tolerance(), assembly)) } }
        }
        @for (level, [a, b]) in levels.iter().take(MAX_LEVELS).map(|level| (level, of(level))) {
            p.soft { "Clearance between " (a) " and " (b) ": " (length_text(level.length, assembly)) }
        }
        @if more_levels > 0 { p.soft { "JSON has " (more_levels) " more clearances of groups." } }
        @if options.allow_contact { p.soft { "Parts that touch satisfy every clearance." } }
        @if counts.ignored > 0 { p.soft { (counts.ignored) " pairs are ignored or glued, and not examined." } }
        @if more > 0 {
            p.soft { "The list ends after " (MAX_FINDINGS) " findings. JSON and CSV have " (more) " more." }
        }
        @if assembly.unit().is_none() { p.soft { "The file states no unit of length." } }
        @for note in assembly.notes().iter().take(5) { p.soft { (note) } }
    }
}

/// Returns the list entry of a finding.
fn finding(assembly: &Assembly, k: usize, pair: &AuditedPair, section: Option<&String>) -> Markup {
    let [a, b] = display_names(assembly, pair);
    let kind = pair.finding.name();
    html! {
        details.clash data-kind=(kind) data-violation[pair.is_violation] open[k == 0] {
            summary {
                span { (k + 1) }
                span.names { (a) " · " (b) }
                span.measure { (headline(assembly, pair)) }
                span.{ "kind " (kind) } { (kind) }
            }
            div {
                dl.facts { @for fact in facts(assembly, pair) { div { dt { (fact.name) } dd { (fact.value) } } } }
                @for file in pair.proof_files() { p.soft { "Proof: " code { (file) } } }
                @match section {
                    Some(section) => figure {
                        (picture_markup(section.clone()))
                        figcaption {
                            "Section through the place: " span.swatch.blue {} " " (a) ", " span.swatch.sand {} " " (b)
                            @if pair.finding.interference().is_some() { ", " span.swatch.both {} " their common part" }
                            "."
                        }
                    },
                    None => p.soft { "Without a section, because those of the findings above fill the file." },
                }
            }
        }
    }
}

/// Draws the sections of the findings until they have [`MAX_SECTION_BYTES`].
fn sections(
    assembly: &Assembly,
    listed: &[AuditedPair],
    watch: Watch,
) -> Result<Vec<String>, AssemblyError> {
    let tally = watch.start_stage(Stage::Pictures, listed.len());
    let mut all = Vec::new();
    let mut bytes = 0;
    for pairs in listed.chunks(SECTIONS_AT_A_TIME) {
        if bytes > MAX_SECTION_BYTES {
            break;
        }
        let first = all.len();
        let draw = |(k, pair): (usize, &AuditedPair)| {
            let [a, b] = display_names(assembly, pair);
            let solids = pair.parts.map(|part| assembly.parts()[part].solid());
            let label = format!("Section of {a} and {b}");
            let name = format!("cut-{}", first + k);
            let drawn =
                pair_cut(assembly, pair).section(solids, &unit_text(assembly), &name, &label);
            tally.finish_item().map(|()| drawn)
        };
        let drawn: Result<Vec<String>, _> = pairs.par_iter().enumerate().map(draw).collect();
        let drawn = drawn?;
        bytes += drawn.iter().map(String::len).sum::<usize>();
        all.extend(drawn);
    }
    Ok(all)
}

/// Returns the viewer with the parts of the worst findings, as far as the page permits.
fn viewer(assembly: &Assembly, listed: &[AuditedPair]) -> Markup {
    let mut is_shown = vec![false; assembly.parts().len()];
    let mut triangles = 0;
    let mut add = |part: usize| {
        let more = assembly.parts()[part].solid().triangles().len();
        if !is_shown[part] && triangles + more <= viewer::MAX_TRIANGLES {
            triangles += more;
            is_shown[part] = true;
        }
    };
    listed.iter().flat_map(|pair| pair.parts).for_each(&mut add);
    // The other parts are the surroundings.
    (0..assembly.parts().len()).for_each(&mut add);
    let Aabb { low, high } = assembly.bounds();
    let (middle, size) = ((low + high) / 2.0, (high - low).length());
    let shown: Vec<usize> = (0..is_shown.len()).filter(|part| is_shown[*part]).collect();
    let clashes = listed.iter().zip(clash_views(assembly, listed)).map(|(pair, mut clash)| {
        let [Ok(a), Ok(b)] = pair.parts.map(|part| shown.binary_search(&part)) else {
            return Value::Null;
        };
        clash["parts"] = json!([a, b]);
        clash
    });
    let parts = shown.iter().map(|&k| {
        let part = &assembly.parts()[k];
        viewer::part_data(part, part.colour().unwrap_or_else(|| kind_colour(k)), middle)
    });
    let data = json!({
        "unit": unit_text(assembly),
        "size": size,
        "parts": parts.collect::<Vec<_>>(),
        "clashes": clashes.collect::<Vec<_>>(),
    });
    html! {
        div id="viewer" {}
        script type="application/json" id="viewer-data" { (viewer::script_data(&data)) }
    }
}

/// Returns what a viewer shows of findings: `parts`, a `line` between the nearest points or along the shortest way out
/// that was found (`parts_by_moving`), the `radius` of its neighbourhood, and the `normal` of the plane of its section.
/// Points are relative to the middle of the assembly.
pub fn clash_views(assembly: &Assembly, pairs: &[AuditedPair]) -> impl Iterator<Item = Value> {
    let Aabb { low, high } = assembly.bounds();
    let middle = (low + high) / 2.0;
    pairs.iter().map(move |pair| {
        let Cut { at, radius, normal, .. } = pair_cut(assembly, pair);
        let ends = match (way_out(pair), pair.finding.nearest()) {
            (Some(way), _) => [at, at + way],
            (None, Some(nearest)) => nearest.points,
            (None, None) => [at; 2],
        };
        json!({
            "parts": pair.parts,
            "line": ends.map(|end| (end - middle).to_array()),
            "parts_by_moving": way_out(pair).is_some(),
            "radius": radius,
            "normal": normal.to_array(),
        })
    })
}

/// Returns the shortest displacement of the first part that was found to separate a pair; `None` if the pair does not
/// interfere.
fn way_out(pair: &AuditedPair) -> Option<DVec3> {
    pair.finding.interference()?.known_depth().map(|depth| depth.translation)
}

/// Returns the plane through the place of a finding.
pub(super) fn pair_cut(assembly: &Assembly, pair: &AuditedPair) -> Cut {
    let boxes = pair.parts.map(|part| assembly.parts()[part].bounds());
    let (interference, nearest) = (pair.finding.interference(), pair.finding.nearest());
    let at = pair.finding.place();
    let measure = match (way_out(pair), nearest) {
        (Some(way), _) => {
            let label = length_text(way.length(), assembly);
            Some(Measure { ends: [DVec3::ZERO, way], is_arrow: true, label })
        }
        (None, Some(found)) => {
            let label = match pair.finding {
                PairFinding::Touching(_) => String::new(),
                _ => bounds_text(found.distance, &unit_text(assembly), length_digits(pair)),
            };
            Some(Measure { ends: found.points.map(|point| point - at), is_arrow: false, label })
        }
        (None, None) => None,
    };
    let common = interference.and_then(|found| found.common.bounds);
    Cut::new(boxes, at, common, measure, assembly.up())
}

/// Returns the names of both parts for display: shortened, without characters that are invisible or reverse the text.
pub(super) fn display_names(assembly: &Assembly, pair: &AuditedPair) -> [String; 2] {
    pair.parts.map(|part| shortened(assembly.parts()[part].name(), MAX_NAME))
}

/// Returns the unit of an assembly for display; empty without a unit.
fn unit_text(assembly: &Assembly) -> String {
    shortened(assembly.unit().unwrap_or_default(), MAX_UNIT)
}

/// Escapes control characters, and cuts a text after `most` characters.
fn shortened(text: &str, most: usize) -> String {
    // A character has at most ten characters when it is escaped, so that a prefix suffices.
    let prefix = text.char_indices().nth(most + 1).map_or(text, |(end, _)| &text[..end]);
    let text = escape_control(prefix);
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into_owned(),
    }
}

/// Returns the number that ranks a finding, with its name.
pub(super) fn headline(assembly: &Assembly, pair: &AuditedPair) -> String {
    let unit = &unit_text(assembly);
    match (pair.finding.interference(), &pair.finding) {
        (Some(found), _) => found.known_depth().map_or_else(
            || "surfaces cross".into(),
            |depth| format!("depth {}", bounds_text(depth.bounds(), unit, DIGITS[0])),
        ),
        (None, PairFinding::Touching(_)) => "in contact".into(),
        (None, finding) => {
            let distance = finding.nearest().map_or([0.0; 2], |found| found.distance);
            format!("distance {}", bounds_text(distance, unit, length_digits(pair)))
        }
    }
}

/// Returns all numbers of a finding.
pub(super) fn facts(assembly: &Assembly, pair: &AuditedPair) -> Vec<Fact> {
    let unit = &unit_text(assembly);
    let [a, _] = display_names(assembly, pair);
    let digits = length_digits(pair);
    let mut facts = Vec::new();
    let mut push = |name, value| facts.push(Fact { name, value });
    if let Some(inner) = pair.finding.inner() {
        push("inside the other part", shortened(assembly.parts()[inner].name(), MAX_NAME));
    }
    if let Some(found) = pair.finding.interference()
        && let Some(depth) = found.known_depth()
    {
        push("depth", bounds_text(depth.bounds(), unit, DIGITS[0]));
        let way = direction_name(depth.direction);
        push(
            "shortest way out found",
            format!("{a} by {} along {way}", length_text(depth.upper, assembly)),
        );
        let cubic = if unit.is_empty() { String::new() } else { format!("{unit}³") };
        push("common volume", bounds_text(found.common.volume, &cubic, DIGITS[0]));
    }
    if let Some(found) = pair.finding.nearest() {
        push("distance", bounds_text(found.distance, unit, digits));
    }
    if let Some(found) = pair.finding.wall() {
        push("wall between the surfaces", bounds_text(found.distance, unit, DIGITS[0]));
        let [from, to] = found.points.map(coordinates_text);
        push("thinnest place of the wall", with_unit(&format!("{from} to {to}"), unit));
    }
    push("place", with_unit(&coordinates_text(pair.finding.place()), unit));
    push("required clearance", with_unit(&rounded_number(pair.clearance, digits), unit));
    push("tolerance", length_text(pair.tolerance, assembly));
    if let Some(role) = assembly.pair_fit(pair.parts[0], pair.parts[1]).and_then(|fit| fit.role) {
        push("role", role.name().into());
    }
    let open: Vec<String> =
        pair.open_parts().map(|part| shortened(assembly.parts()[part].name(), MAX_NAME)).collect();
    if !open.is_empty() {
        push("open shells, without an inside", open.join(", "));
    }
    facts
}

/// Formats the coordinates of a point.
fn coordinates_text(at: DVec3) -> String {
    let [x, y, z] = at.to_array().map(short_number);
    format!("({x}, {y}, {z})")
}

/// Formats a length in the unit of the assembly.
fn length_text(length: f64, assembly: &Assembly) -> String {
    with_unit(&short_number(length), &unit_text(assembly))
}

/// Returns the number of digits of the distance and the clearance of a pair. A distance that violates the clearance
/// differs from it in print, if nine digits suffice.
fn length_digits(pair: &AuditedPair) -> i32 {
    let [fewest, most] = DIGITS;
    let Some(found) = pair.finding.nearest().filter(|_| pair.is_violation) else { return fewest };
    let differ = |digits: &i32| {
        let [upper, clearance] = [found.distance[1], pair.clearance];
        rounded_number(upper, *digits) != rounded_number(clearance, *digits)
    };
    (fewest..most).find(differ).unwrap_or(most)
}

/// Formats bounds with a number of digits: as one number if both round to it, otherwise rounded outwards.
fn bounds_text([lower, upper]: [f64; 2], unit: &str, digits: i32) -> String {
    let (from, to) = (rounded_number(lower, digits), rounded_number(upper, digits));
    if from == to {
        return with_unit(&from, unit);
    }
    let outwards = |x: f64, round: fn(f64) -> f64| {
        let scale = 10_f64.powf(f64::from(digits - 1) - x.abs().log10().floor());
        let rounded = round(x * scale) / scale;
        rounded_number(if rounded.is_finite() { rounded } else { x }, digits)
    };
    with_unit(&format!("{} to {}", outwards(lower, f64::floor), outwards(upper, f64::ceil)), unit)
}

/// Appends a unit, if there is one.
fn with_unit(number: &str, unit: &str) -> String {
    format!("{number} {unit}").trim_end().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_and_invisible_names_are_cut_and_escaped() {
        assert_eq!(shortened("bolt\u{202e}x", 120), "bolt\\u{202e}x");
        assert_eq!(shortened("größer", 6), "größer");
        assert_eq!(shortened("größere", 6), "größer…");
        assert_eq!(shortened(&"\u{0}".repeat(1_000_000), 8), "\\u{0}\\u{…");
    }

    #[test]
    fn bounds_are_rounded_outwards_to_their_digits() {
        assert_eq!(bounds_text([0.25; 2], "mm", 4), "0.25 mm");
        assert_eq!(bounds_text([1.23454, 1.25], "", 4), "1.234 to 1.25");
        assert_eq!(bounds_text([0.49998; 2], "mm", 4), "0.5 mm");
        assert_eq!(bounds_text([0.49998; 2], "mm", 5), "0.49998 mm");
    }
}
