//! Units of length: their names in files and their lengths in metres.

/// Units: accepted names, the preferred one first, and the length in metres.
const UNITS: [(&[&str], f64); 6] = [
    (&["m", "meter", "metre"], 1.0),
    (&["mm", "millimeter", "millimetre"], 1e-3),
    (&["cm", "centimeter", "centimetre"], 1e-2),
    (&["in", "inch"], 0.0254),
    (&["ft", "foot"], 0.3048),
    (&["micron", "um"], 1e-6),
];

/// Preferred names of all units.
pub const UNIT_NAMES: [&str; UNITS.len()] = {
    let mut names = [""; UNITS.len()];
    let mut k = 0;
    while k < UNITS.len() {
        names[k] = UNITS[k].0[0];
        k += 1;
    }
    names
};

/// Returns the length of a unit in metres; `None` if the name is unknown.
pub fn unit_in_metres(name: &str) -> Option<f64> {
    UNITS.iter().find(|(names, _)| names.contains(&name)).map(|(_, metres)| *metres)
}

/// Returns the preferred name of the unit of this length; `None` if no listed unit has it.
pub fn unit_name(metres: f64) -> Option<&'static str> {
    let same = |(_, of): &&(&[&'static str], f64)| (of / metres - 1.0).abs() < 1e-9;
    UNITS.iter().find(same).map(|(names, _)| names[0])
}
