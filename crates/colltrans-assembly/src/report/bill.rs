//! The bill of materials: a line for each kind of parts, as a section of the report and as CSV.
//!
//! Parts of a line agree in shape, material and density. Volumes need a closed surface, masses also a density and a
//! known unit of length. Unknown values are left empty.

use maud::{Markup, html};

use super::kinds::{Kind, kinds};
use super::words::{Words, drawing_number};
use super::{Analysis, Report};
use crate::csv::{Cell, Table};
use crate::fasteners::Fastener;
use crate::units;

/// Heads of the columns of the CSV file.
const COLUMNS: [&str; 12] = [
    "number",
    "name",
    "quantity",
    "fastener",
    "form",
    "material",
    "volume",
    "unit",
    "density_kg_per_m3",
    "mass_kg",
    "total_mass_kg",
    "steps",
];

/// A line of the bill of materials.
struct BillLine<'a> {
    /// The parts and the steps that remove them.
    kind: Kind,
    /// The fastener that each part is; `None` if they are none.
    fastener: Option<&'a Fastener>,
    material: &'a str,
    /// Volume of one part in the unit of the files; `None` if its surface is open.
    volume: Option<f64>,
    /// Density in kilograms per cubic metre.
    density: Option<f64>,
    /// Mass of one part in kilograms.
    mass: Option<f64>,
}

/// Returns the lines of the bill, in the order of the numbers in the exploded view.
fn bill_lines<'a>(f: &'a Analysis) -> Vec<BillLine<'a>> {
    let assembly = f.bodies.assembly();
    let metres = assembly.unit().and_then(units::unit_in_metres);
    let line = |kind: Kind| {
        let first = kind.parts[0];
        let part = &assembly.parts()[first];
        let volume = (!part.is_surface()).then(|| part.solid().volume());
        let density = part.density();
        let mass = match (volume, density, metres) {
            (Some(volume), Some(density), Some(metres)) => Some(volume * metres.powi(3) * density),
            _ => None,
        };
        let material = part.material().unwrap_or_default();
        BillLine { fastener: f.plan.fasteners.get(first), material, volume, density, mass, kind }
    };
    kinds(&f.plan, assembly.parts()).into_iter().map(line).collect()
}

/// Returns the bill of materials as CSV. Volumes are in the unit of the files, masses in kilograms.
pub fn bill_csv(f: &Analysis) -> String {
    let words = Words::new(f);
    let unit = f.bodies.assembly().unit().map_or_else(String::new, |unit| format!("{unit}^3"));
    let mut table = Table::new(&COLUMNS);
    for (k, line) in bill_lines(f).iter().enumerate() {
        let number = |x: Option<f64>| x.map_or(Cell::Text(""), |x| Cell::Number(six_digits(x)));
        let count = line.kind.parts.len() as f64;
        let name = words.kind_name(&line.kind.parts);
        let [title, details] = [Fastener::title, Fastener::details]
            .map(|text| line.fastener.map_or_else(String::new, text));
        let steps: Vec<String> = line.kind.steps.iter().map(|k| (k + 1).to_string()).collect();
        table.push_row(&[
            Cell::Number((k + 1) as f64),
            Cell::Text(&name),
            Cell::Number(count),
            Cell::Text(&title),
            Cell::Text(&details),
            Cell::Text(line.material),
            number(line.volume),
            Cell::Text(if line.volume.is_some() { &unit } else { "" }),
            number(line.density),
            number(line.mass),
            number(line.mass.map(|mass| mass * count)),
            Cell::Text(&steps.join(" ")),
        ]);
    }
    table.into_text()
}

/// Returns the bill of materials as a section; empty without parts. Columns without any value are left out.
pub(super) fn bill_section(r: &Report) -> Markup {
    let lines = bill_lines(r.f);
    if lines.is_empty() {
        return Markup::default();
    }
    let has_fasteners = lines.iter().any(|line| line.fastener.is_some());
    let has_materials = lines.iter().any(|line| !line.material.is_empty());
    let masses = lines.iter().filter_map(|line| Some(line.mass? * line.kind.parts.len() as f64));
    let (known, total) = masses.fold((0, 0.0), |(count, sum), mass| (count + 1, sum + mass));
    let count: usize = lines.iter().map(|line| line.kind.parts.len()).sum();
    html! {
        section.sheet.bill id="bill" {
            h2 { "Bill of materials" }
            div.wide { table {
                thead { tr {
                    th { "no." } th { "name" } th { "quantity" }
                    @if has_fasteners { th { "standard part" } }
                    @if has_materials { th { "material" } }
                    th { "volume" }
                    @if known > 0 { th { "mass" } th { "mass of all" } }
                } }
                tbody {
                    @for (k, line) in lines.iter().enumerate() {
                        tr {
                            td.n { (k + 1) }
                            td { (r.words.kind_name(&line.kind.parts)) }
                            td.n { (line.kind.parts.len()) }
                            @if has_fasteners { td { (line.fastener.map_or_else(String::new, Fastener::title)) } }
                            @if has_materials { td { (line.material) } }
                            td.n { (line.volume.map_or_else(String::new, |volume| r.words.volume_text(volume))) }
                            @if known > 0 {
                                td.n { (line.mass.map_or_else(String::new, mass_text)) }
                                td.n { (line.mass.map_or_else(String::new, |mass| mass_text(mass * line.kind.parts.len() as f64))) }
                            }
                        }
                    }
                }
            } }
            p {
                (count) @if count == 1 { " part" } @else { " parts" } " in " (lines.len())
                @if lines.len() == 1 { " line" } @else { " lines" }
                @if known == lines.len() { ", " (mass_text(total)) " in all" }
                @else if known > 0 { ", " (mass_text(total)) " without the " (lines.len() - known) " of unknown mass" }
                ". Parts of one line have equal shape and material."
                @if known == 0 { " Masses need a unit of length in the source and a density (--density, or the manifest)." }
            }
        }
    }
}

/// Rounds a number to six significant digits.
fn six_digits(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// Formats a mass in kilograms, or in grams below one kilogram.
fn mass_text(kilograms: f64) -> String {
    let (value, unit) = if kilograms < 1.0 { (kilograms * 1e3, "g") } else { (kilograms, "kg") };
    let decimals = if value < 10.0 { 3 } else { 1 };
    format!("{} {unit}", drawing_number(value, decimals))
}

#[cfg(test)]
mod tests {
    use super::mass_text;

    #[test]
    fn masses_are_in_grams_below_one_kilogram() {
        let found = [0.0, 1e-9, 0.001_25, 0.271_83, 0.999, 1.0, 7.8504, 123.456].map(mass_text);
        let expected =
            ["0 g", "under 0.001 g", "1.25 g", "271.8 g", "999 g", "1 kg", "7.85 kg", "123.5 kg"];
        assert_eq!(found, expected);
    }
}
