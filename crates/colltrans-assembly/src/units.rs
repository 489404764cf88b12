//! Units of length: their names in files, and how many metres they are.

/// A unit, the name that is written first, and how many metres it is.
const UNITS: [(&[&str], f64); 6] = [
    (&["m", "meter", "metre"], 1.0),
    (&["mm", "millimeter", "millimetre"], 1e-3),
    (&["cm", "centimeter", "centimetre"], 1e-2),
    (&["in", "inch"], 0.0254),
    (&["ft", "foot"], 0.3048),
    (&["micron", "um"], 1e-6),
];

/// Returns how many metres a unit is; `None` if its name is not known.
pub fn metres(name: &str) -> Option<f64> {
    UNITS.iter().find(|(names, _)| names.contains(&name)).map(|(_, metres)| *metres)
}

/// Returns the name of a unit of so many metres, if it has one.
pub fn name(metres: f64) -> Option<&'static str> {
    let same = |(_, of): &&(&[&'static str], f64)| (of / metres - 1.0).abs() < 1e-9;
    UNITS.iter().find(same).map(|(names, _)| names[0])
}
