//! Hand tools with their sizes in millimetres.
//!
//! Arms of hex keys are those of ISO 2936, blades of screwdrivers those of ISO 2380 and ISO 8764. Sockets, spanners,
//! handles and pliers have usual sizes, rounded up. A head without a modelled recess has the hexagon socket of ISO 4762
//! (cylinders), ISO 10642 (cones) or ISO 7380 (domes). A tool is described along the axis of a fastener, from the place
//! where it grips: rods about the axis, and a lever that swings at some height.

use std::f64::consts::FRAC_1_SQRT_2;

use crate::digits::rounded_number;
use crate::fasteners::Head;

/// A cylinder about the axis of the fastener.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rod {
    pub(super) radius: f64,
    /// Where it begins and ends.
    pub(super) range: [f64; 2],
}

/// A straight lever that turns about the axis by an angle at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lever {
    /// Distance of its end from the axis.
    pub(super) length: f64,
    /// Half of its width.
    pub(super) half_width: f64,
    pub(super) range: [f64; 2],
    /// Angle in degrees after which the tool can be put on again.
    pub(super) degrees: f64,
}

/// A tool on its fastener.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ToolShape {
    pub(super) name: String,
    pub(super) rods: Vec<Rod>,
    pub(super) lever: Option<Lever>,
}

/// Widths across flats of hex keys, and the lengths of their long and short arms.
const HEX_KEYS: [[f64; 3]; 15] = [
    [0.9, 33.0, 11.0],
    [1.3, 41.0, 13.0],
    [1.5, 46.5, 15.5],
    [2.0, 52.0, 18.0],
    [2.5, 58.5, 20.5],
    [3.0, 66.0, 23.0],
    [4.0, 74.0, 29.0],
    [5.0, 85.0, 33.0],
    [6.0, 96.0, 38.0],
    [8.0, 108.0, 44.0],
    [10.0, 122.0, 50.0],
    [12.0, 137.0, 57.0],
    [14.0, 154.0, 70.0],
    [17.0, 177.0, 80.0],
    [19.0, 199.0, 89.0],
];
/// Numbers of hexalobular sockets and their largest diameters.
const HEXALOBULAR: [(u32, f64); 16] = [
    (5, 1.42),
    (6, 1.7),
    (7, 1.99),
    (8, 2.31),
    (9, 2.5),
    (10, 2.74),
    (15, 3.27),
    (20, 3.86),
    (25, 4.43),
    (27, 5.0),
    (30, 5.52),
    (40, 6.65),
    (45, 7.82),
    (50, 8.83),
    (55, 11.22),
    (60, 13.25),
];
/// Blades of slotted drivers: thickness and width.
const SLOTTED: [[f64; 2]; 11] = [
    [0.4, 2.5],
    [0.5, 3.0],
    [0.6, 3.5],
    [0.8, 4.0],
    [1.0, 5.5],
    [1.2, 6.5],
    [1.2, 8.0],
    [1.6, 8.0],
    [1.6, 10.0],
    [2.0, 12.0],
    [2.5, 14.0],
];
/// Cross drivers: largest metric size, number, and diameter of the blade.
const CROSS: [(f64, u32, f64); 5] =
    [(2.0, 0, 3.0), (3.0, 1, 4.5), (5.0, 2, 6.0), (7.0, 3, 8.0), (f64::INFINITY, 4, 10.0)];
/// Metric sizes with the widths of the hexagon sockets of ISO 4762, and of ISO 10642 and ISO 7380.
const SOCKETS: [(f64, [f64; 2]); 12] = [
    (1.6, [1.5, 0.9]),
    (2.0, [1.5, 1.3]),
    (2.5, [2.0, 1.5]),
    (3.0, [2.5, 2.0]),
    (4.0, [3.0, 2.5]),
    (5.0, [4.0, 3.0]),
    (6.0, [5.0, 4.0]),
    (8.0, [6.0, 5.0]),
    (10.0, [8.0, 6.0]),
    (12.0, [10.0, 8.0]),
    (16.0, [14.0, 10.0]),
    (20.0, [17.0, 12.0]),
];
/// Maximum relative deviation of a width from a size of a table.
const SAME_SIZE: f64 = 0.05;
/// Angle after which a key for a hexagon can be put on again, and one for twelve points, in degrees.
const HEXAGON_DEGREES: f64 = 60.0;
const TWELVE_POINT_DEGREES: f64 = 30.0;
/// Angle by which the lever of a ratchet turns at least, in degrees.
const RATCHET_DEGREES: f64 = 15.0;

/// Returns the blade and the handle of a screwdriver.
fn driver(name: String, blade: [f64; 2], handle: [f64; 2]) -> ToolShape {
    let ([radius, length], [grip, end]) = (blade, handle);
    let rods = vec![
        Rod { radius, range: [0.0, length] },
        Rod { radius: grip, range: [length, length + end] },
    ];
    ToolShape { name, rods, lever: None }
}

/// Returns a driver with a handle that fits a blade of a diameter, and a short one.
fn drivers(name: &str, diameter: f64, lengths: [f64; 2]) -> Vec<ToolShape> {
    let handle = if diameter < 4.0 { [12.0, 85.0] } else { [18.0, 120.0] };
    let [long, short] = lengths;
    vec![
        driver(format!("{name} x {long}"), [diameter / 2.0, long], handle),
        driver(format!("{name} x {short}"), [diameter / 2.0, short], [18.0, 60.0]),
    ]
}

/// Returns an angled key, first with its long arm in the fastener and then with the short one. `radius` is that of
/// the bar.
fn angled_keys(name: &str, radius: f64, [long, short]: [f64; 2]) -> [ToolShape; 2] {
    let key = |inner: f64, outer: f64, which: &str| {
        let top = [inner - 2.0 * radius, inner];
        let lever =
            Lever { length: outer, half_width: radius, range: top, degrees: HEXAGON_DEGREES };
        ToolShape {
            name: format!("{name}, {which} arm in the screw"),
            rods: vec![Rod { radius, range: [0.0, inner] }],
            lever: Some(lever),
        }
    };
    [key(long, short, "long"), key(short, long, "short")]
}

/// Returns the tools for a hexagon socket.
pub(super) fn for_hex_socket(across: f64) -> Vec<ToolShape> {
    let known = HEX_KEYS.iter().find(|[size, ..]| (size / across - 1.0).abs() <= SAME_SIZE);
    let larger = HEX_KEYS.iter().find(|[size, ..]| *size >= across);
    let size = known.map_or(across, |[size, ..]| *size);
    let [_, long, short] = *known.or(larger).unwrap_or(&HEX_KEYS[HEX_KEYS.len() - 1]);
    // Corners of the hexagon.
    let radius = size.max(across) / 3.0_f64.sqrt();
    let size = rounded_number(size, 2);
    let blade = if across < 3.5 { 100.0 } else { 150.0 };
    let straight = format!("hex driver {size} x {blade}");
    let mut all = vec![driver(straight, [radius, blade], [18.0, 120.0])];
    all.extend(angled_keys(&format!("hex key {size}"), radius, [long, short]));
    all
}

/// Returns the tools for a head of a metric size without a modelled recess; none for a size without a standard.
pub(super) fn for_plain_head(head: Head, metric: f64) -> Vec<ToolShape> {
    let Some((_, [cylinder, other])) = SOCKETS.iter().find(|(size, _)| *size == metric) else {
        return Vec::new();
    };
    let (across, standard) = match head {
        Head::Cylinder => (cylinder, "ISO 4762"),
        Head::Countersunk => (other, "ISO 10642"),
        Head::Rounded => (other, "ISO 7380"),
        Head::Hexagon | Head::FlangedHexagon | Head::None => return Vec::new(),
    };
    let mut all = for_hex_socket(*across);
    for tool in &mut all {
        tool.name = format!("{} (socket of {standard})", tool.name);
    }
    all
}

/// Returns the tools for a hexalobular socket of a largest diameter.
pub(super) fn for_hexalobular(diameter: f64) -> Vec<ToolShape> {
    let known = HEXALOBULAR.iter().find(|(_, d)| (d / diameter - 1.0).abs() <= SAME_SIZE);
    let number =
        known.map_or_else(|| rounded_number(diameter, 2), |(number, _)| format!("T{number}"));
    let radius = diameter / 2.0;
    let key = HEX_KEYS.iter().find(|[size, ..]| *size >= diameter * 0.8);
    let [_, long, short] = *key.unwrap_or(&HEX_KEYS[HEX_KEYS.len() - 1]);
    let mut all = drivers(&format!("hexalobular driver {number}"), diameter, [100.0, 25.0]);
    all.extend(angled_keys(&format!("hexalobular key {number}"), radius, [long, short]));
    all
}

/// Returns the tools for a square socket.
pub(super) fn for_square_socket(across: f64) -> Vec<ToolShape> {
    let name = format!("square driver {}", rounded_number(across, 2));
    drivers(&name, across / FRAC_1_SQRT_2, [100.0, 25.0])
}

/// Returns the tools for a cross recess of a thread.
pub(super) fn for_cross(thread: f64) -> Vec<ToolShape> {
    let &(_, number, diameter) =
        CROSS.iter().find(|(most, ..)| thread <= *most).unwrap_or(&CROSS[4]);
    let long = [60.0, 80.0, 100.0, 150.0, 200.0][number as usize];
    drivers(&format!("cross driver PH{number}"), diameter, [long, 25.0])
}

/// Returns the tools for a slot of a width, in a head of a diameter.
pub(super) fn for_slot(width: f64, head: f64) -> Vec<ToolShape> {
    let fits = |[thickness, blade]: &&[f64; 2]| *thickness <= width * 1.02 && *blade <= head;
    let [_, blade] = *SLOTTED.iter().rev().find(fits).unwrap_or(&SLOTTED[0]);
    let long = if blade < 5.0 { 100.0 } else { 150.0 };
    drivers(&format!("slotted driver {blade}"), blade, [long, 25.0])
}

/// Returns the tools for a hexagon head or a nut.
pub(super) fn for_hexagon(across: f64) -> Vec<ToolShape> {
    let size = rounded_number(across, 2);
    let outer = f64::midpoint(1.35 * across, 2.0);
    let is_small = across <= 14.0;
    let (depth, extension, bar, lever) = if is_small {
        (30.0, 125.0, 9.0, 200.0)
    } else {
        (0.6 * across + 30.0, 150.0, 14.0, 280.0)
    };
    let ratchet = |at: f64| Lever {
        length: lever,
        half_width: 18.0,
        range: [at, at + 35.0],
        degrees: RATCHET_DEGREES,
    };
    let head = |at: f64| Rod { radius: 18.0, range: [at, at + 35.0] };
    let socket = Rod { radius: outer, range: [0.0, depth] };
    let above = depth + extension;
    let rod = Rod { radius: bar, range: [depth, above] };
    let height = 0.45 * across + 3.0;
    // A ring is put on from above, by its height.
    let range = [0.0, 2.0 * height];
    let ring = Rod { radius: 0.75 * across + 1.5, range };
    let spanner = Lever {
        length: 8.5 * across + 60.0,
        half_width: 0.75 * across + 1.5,
        range,
        degrees: TWELVE_POINT_DEGREES,
    };
    vec![
        ToolShape {
            name: format!("socket {size} with an extension of {extension}"),
            rods: vec![socket, rod, head(above)],
            lever: Some(ratchet(above)),
        },
        ToolShape {
            name: format!("socket {size} with a ratchet"),
            rods: vec![socket, head(depth)],
            lever: Some(ratchet(depth)),
        },
        ToolShape { name: format!("ring spanner {size}"), rods: vec![ring], lever: Some(spanner) },
    ]
}

/// Returns the tools for a circlip of inner and outer diameter.
pub(super) fn for_circlip([inner, outer]: [f64; 2]) -> Vec<ToolShape> {
    let radius = inner.midpoint(outer) / 2.0;
    let nose = |end: f64| Rod { radius, range: [0.0, end] };
    let body = Rod { radius: 22.0, range: [35.0, 85.0] };
    let handles = Rod { radius: 35.0, range: [85.0, 190.0] };
    let bent = Lever { length: 180.0, half_width: 35.0, range: [20.0, 45.0], degrees: 0.0 };
    vec![
        ToolShape {
            name: "straight circlip pliers".into(),
            rods: vec![nose(35.0), body, handles],
            lever: None,
        },
        ToolShape {
            name: "angled circlip pliers".into(),
            rods: vec![nose(45.0)],
            lever: Some(bent),
        },
    ]
}
