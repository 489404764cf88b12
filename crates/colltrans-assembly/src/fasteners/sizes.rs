//! Standard sizes in millimetres, and designations.
//!
//! Sources: ISO 261 and ISO 262 (diameters and coarse pitches), ISO 4032 (nuts), ISO 7089 (washers), ISO 8734 and ISO
//! 2338 (dowels), ISO/R 773 (keys), ISO 15 (deep groove ball bearings).

use crate::digits::rounded_number;

/// A metric thread with its nut and its washer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Metric {
    /// Nominal diameter.
    pub(super) diameter: f64,
    /// Coarse pitch.
    pub(super) pitch: f64,
    /// Width across flats of the hexagon nut.
    pub(super) across_flats: f64,
    /// Inner and outer diameter of the washer.
    pub(super) washer: [f64; 2],
}

const fn metric(diameter: f64, pitch: f64, across_flats: f64, washer: [f64; 2]) -> Metric {
    Metric { diameter, pitch, across_flats, washer }
}

/// Metric threads by increasing diameter.
const METRIC: [Metric; 21] = [
    metric(1.6, 0.35, 3.2, [1.7, 4.0]),
    metric(2.0, 0.4, 4.0, [2.2, 5.0]),
    metric(2.5, 0.45, 5.0, [2.7, 6.0]),
    metric(3.0, 0.5, 5.5, [3.2, 7.0]),
    metric(3.5, 0.6, 6.0, [3.7, 8.0]),
    metric(4.0, 0.7, 7.0, [4.3, 9.0]),
    metric(5.0, 0.8, 8.0, [5.3, 10.0]),
    metric(6.0, 1.0, 10.0, [6.4, 12.0]),
    metric(8.0, 1.25, 13.0, [8.4, 16.0]),
    metric(10.0, 1.5, 16.0, [10.5, 20.0]),
    metric(12.0, 1.75, 18.0, [13.0, 24.0]),
    metric(14.0, 2.0, 21.0, [15.0, 28.0]),
    metric(16.0, 2.0, 24.0, [17.0, 30.0]),
    metric(18.0, 2.5, 27.0, [19.0, 34.0]),
    metric(20.0, 2.5, 30.0, [21.0, 37.0]),
    metric(22.0, 2.5, 34.0, [23.0, 39.0]),
    metric(24.0, 3.0, 36.0, [25.0, 44.0]),
    metric(27.0, 3.0, 41.0, [28.0, 50.0]),
    metric(30.0, 3.5, 46.0, [31.0, 56.0]),
    metric(36.0, 4.0, 55.0, [37.0, 66.0]),
    metric(42.0, 4.5, 65.0, [45.0, 78.0]),
];

/// Diameters of dowels.
const DOWELS: [f64; 18] = [
    0.8, 1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 30.0, 40.0,
];
/// Lengths of dowels up to 100.
const DOWEL_LENGTHS: [f64; 31] = [
    2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 22.0, 24.0, 26.0, 28.0, 30.0,
    32.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 90.0, 100.0,
];
/// Widths and heights of parallel keys.
const KEYS: [[f64; 2]; 13] = [
    [2.0, 2.0],
    [3.0, 3.0],
    [4.0, 4.0],
    [5.0, 5.0],
    [6.0, 6.0],
    [8.0, 7.0],
    [10.0, 8.0],
    [12.0, 8.0],
    [14.0, 9.0],
    [16.0, 10.0],
    [18.0, 11.0],
    [20.0, 12.0],
    [22.0, 14.0],
];
/// Deep groove ball bearings: designation, bore, outer diameter and width.
const BEARINGS: [(&str, [f64; 3]); 34] = [
    ("623", [3.0, 10.0, 4.0]),
    ("624", [4.0, 13.0, 5.0]),
    ("625", [5.0, 16.0, 5.0]),
    ("626", [6.0, 19.0, 6.0]),
    ("608", [8.0, 22.0, 7.0]),
    ("609", [9.0, 24.0, 7.0]),
    ("683", [3.0, 7.0, 2.0]),
    ("684", [4.0, 9.0, 2.5]),
    ("685", [5.0, 11.0, 3.0]),
    ("688", [8.0, 16.0, 4.0]),
    ("6000", [10.0, 26.0, 8.0]),
    ("6001", [12.0, 28.0, 8.0]),
    ("6002", [15.0, 32.0, 9.0]),
    ("6003", [17.0, 35.0, 10.0]),
    ("6004", [20.0, 42.0, 12.0]),
    ("6005", [25.0, 47.0, 12.0]),
    ("6006", [30.0, 55.0, 13.0]),
    ("6007", [35.0, 62.0, 14.0]),
    ("6008", [40.0, 68.0, 15.0]),
    ("6200", [10.0, 30.0, 9.0]),
    ("6201", [12.0, 32.0, 10.0]),
    ("6202", [15.0, 35.0, 11.0]),
    ("6203", [17.0, 40.0, 12.0]),
    ("6204", [20.0, 47.0, 14.0]),
    ("6205", [25.0, 52.0, 15.0]),
    ("6206", [30.0, 62.0, 16.0]),
    ("6207", [35.0, 72.0, 17.0]),
    ("6208", [40.0, 80.0, 18.0]),
    ("6800", [10.0, 19.0, 5.0]),
    ("6801", [12.0, 21.0, 5.0]),
    ("6804", [20.0, 32.0, 7.0]),
    ("6900", [10.0, 22.0, 6.0]),
    ("6901", [12.0, 24.0, 6.0]),
    ("6904", [20.0, 37.0, 9.0]),
];

/// Maximum relative deviation of a diameter from the nearest metric size.
pub(super) const MAX_DEVIATION: f64 = 0.04;
/// Maximum relative deviation from a tabulated dowel, key or bearing.
const MAX_EXACT_DEVIATION: f64 = 0.015;
/// Maximum deviation of a length from a multiple of half a millimetre that is written instead, in millimetres, ...
const MAX_LENGTH_DEVIATION: f64 = 0.06;
/// ... and relative to the length, for fillets and chords.
const MAX_LENGTH_SHARE: f64 = 0.003;

/// Checks whether two lengths agree within a share of the second one.
pub(super) fn agrees(x: f64, nominal: f64, share: f64) -> bool {
    (x - nominal).abs() <= share * nominal
}

/// Returns the metric thread whose diameter is nearest, if it is within [`MAX_DEVIATION`].
pub(super) fn nearest_metric(diameter: f64) -> Option<Metric> {
    METRIC.into_iter().find(|m| agrees(diameter, m.diameter, MAX_DEVIATION))
}

/// Returns the metric thread with a nominal diameter.
pub(super) fn metric_named(diameter: f64) -> Option<Metric> {
    METRIC.into_iter().find(|m| m.diameter == diameter)
}

/// Returns the metric nut with a least and a largest radius of its hole: plain at the nominal diameter or at that
/// of the core, or with a thread between both. Of several, the one with the nearest width across flats.
pub(super) fn metric_nut([least, most]: [f64; 2], across_flats: f64) -> Option<Metric> {
    let fits = |m: &Metric| {
        let core = m.diameter - 1.0825 * m.pitch;
        2.0 * least >= 0.96 * core && 2.0 * most <= 1.06 * m.diameter
    };
    let off = |m: &Metric| (across_flats / m.across_flats - 1.0).abs();
    METRIC.into_iter().filter(fits).min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// Returns the metric size of a washer: its hole lies between the thread and slightly more than the standard hole.
pub(super) fn metric_washer(hole: f64) -> Option<Metric> {
    METRIC.into_iter().find(|m| hole >= 0.99 * m.diameter && hole <= 1.05 * m.washer[0])
}

/// Checks whether a cylinder has the diameter and length of a dowel.
pub(super) fn is_dowel([diameter, length]: [f64; 2]) -> bool {
    DOWELS.into_iter().any(|d| agrees(diameter, d, MAX_EXACT_DEVIATION))
        && DOWEL_LENGTHS.into_iter().any(|l| agrees(length, l, MAX_EXACT_DEVIATION))
}

/// Checks whether a cross-section is that of a parallel key.
pub(super) fn is_key([width, height]: [f64; 2]) -> bool {
    KEYS.into_iter().any(|[b, h]| {
        agrees(width, b, MAX_EXACT_DEVIATION) && agrees(height, h, MAX_EXACT_DEVIATION)
    })
}

/// Returns the designation of a deep groove ball bearing.
pub(super) fn bearing(sizes: [f64; 3]) -> Option<&'static str> {
    let same = |of: &[f64; 3]| (0..3).all(|k| agrees(sizes[k], of[k], MAX_EXACT_DEVIATION));
    BEARINGS.into_iter().find(|(_, of)| same(of)).map(|(name, _)| name)
}

/// Formats a measured diameter in millimetres with three digits.
pub(super) fn diameter_text(x: f64) -> String {
    rounded_number(x, 3)
}

/// Formats a length in millimetres: the nearest multiple of 0.5 if it is near, otherwise three digits.
pub(super) fn length_text(x: f64) -> String {
    let round = (2.0 * x).round() / 2.0;
    if (x - round).abs() <= MAX_LENGTH_DEVIATION.max(MAX_LENGTH_SHARE * x) && round > 0.0 {
        return rounded_number(round, 6);
    }
    rounded_number(x, 3)
}
