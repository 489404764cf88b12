//! Kinds of fasteners by their profile.
//!
//! Rows are counted from the tip of a screw to its head. Radii of rows find the parts of the shape, vertices and flat
//! faces give the sizes. Shapes that other parts share need a name: plain cylinders, heads without a drive, boxes.

use std::f64::consts::{PI, TAU};

use super::profile::{Profile, Row, median};
use super::sizes::{Metric, agrees, bearing, is_dowel, is_key, metric_washer};
use super::{Drive, FastenerKind, Head};

/// Number of rows of a solid.
const ROWS: usize = 48;
/// Number of rows of a head, in which the drive is searched.
const HEAD_ROWS: usize = 20;
/// Number of rows of the measurement of a pitch, and their distance as a share of the diameter.
const PITCH_ROWS: usize = 24;
const PITCH_STEP: f64 = 0.025;
/// Minimum ratio of the radii of head and shank, and the maximum.
const HEAD_RATIO: [f64; 2] = [1.2, 2.8];
/// Height of a head in diameters of the shank.
const HEAD_HEIGHT: [f64; 2] = [0.12, 1.35];
/// Length of a shank in diameters.
const SHANK_LENGTH: [f64; 2] = [0.4, 40.0];
/// Relative deviation of a radius within a cylinder.
const SAME_RADIUS: f64 = 0.03;
/// Minimum number of rows of equal radius in a shank, whose thread may be drawn as a cylinder of its core.
const MIN_PLATEAU: usize = 3;
/// Minimum ratio of the radii of core and shank.
const MIN_CORE: f64 = 0.7;
/// Vertices beyond this multiple of the radius of the shank belong to the head.
const BEYOND_SHANK: f64 = 1.06;
/// Minimum first Fourier coefficient of a thread.
const MIN_THREAD: f64 = 0.008;

/// A shape that may be a fastener, in the unit of the profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    pub(super) kind: FastenerKind,
    /// Whether other parts have this shape too, so that the name decides.
    pub(super) needs_name: bool,
    pub(super) diameter: f64,
    pub(super) length: f64,
    pub(super) width: f64,
    pub(super) head: Option<Head>,
    pub(super) head_height: f64,
    pub(super) drive: Option<(Drive, f64)>,
    pub(super) pitch: Option<f64>,
    /// Least and largest diameter of the hole of a nut.
    pub(super) hole: [f64; 2],
}

impl Shape {
    const fn new(kind: FastenerKind, [diameter, length, width]: [f64; 3]) -> Self {
        Self {
            kind,
            needs_name: false,
            diameter,
            length,
            width,
            head: None,
            head_height: 0.0,
            drive: None,
            pitch: None,
            hole: [0.0; 2],
        }
    }
}

/// Returns the shape of a profile; `scale` is the number of millimetres of its unit.
pub(super) fn recognise_profile(mut profile: Profile, scale: f64) -> (Option<Shape>, Profile) {
    let rows = profile.rows(profile.range, ROWS);
    let found = ring_shape(&profile, &rows, scale)
        .or_else(|| cylinder_shape(&mut profile, &rows, scale))
        .or_else(|| screw_shape(&mut profile, &rows));
    if found.is_some() {
        return (found, profile);
    }
    let mut profile = profile.reversed();
    let rows: Vec<Row> = rows.into_iter().rev().map(|row| Row { z: -row.z, ..row }).collect();
    let found =
        cylinder_shape(&mut profile, &rows, scale).or_else(|| screw_shape(&mut profile, &rows));
    (found, profile)
}

/// Returns the share of the rows for which a property holds.
fn share(rows: &[Row], holds: impl Fn(&Row) -> bool) -> f64 {
    rows.iter().filter(|row| holds(row)).count() as f64 / rows.len().max(1) as f64
}

/// Recognises nuts, washers, circlips and bearings: shapes with a hole.
fn ring_shape(profile: &Profile, rows: &[Row], scale: f64) -> Option<Shape> {
    let height = profile.length();
    let hole = median(rows.iter().map(|row| row.hole.most));
    let is_open = |row: &Row| row.hole.cover > 0.97 && !row.hole.is_hexagon();
    let outer = median(rows.iter().map(|row| row.outer.most));
    if share(rows, |row| row.outer.is_hexagon() && is_open(row)) > 0.5
        && share(rows, is_open) > 0.97
    {
        let flats = median(rows.iter().filter(|r| r.outer.is_hexagon()).map(|r| r.outer.least));
        // An error of the centre cancels in the sum of apothem and corner.
        let corner = median(rows.iter().filter(|r| r.outer.is_hexagon()).map(|r| r.outer.most));
        let flats = flats.midpoint(corner * (PI / 6.0).cos());
        let [least, most] = [median(rows.iter().map(|row| row.hole.least)), hole];
        let most = profile.circle_radius(most, profile.range).unwrap_or(most);
        let fits = least > 0.36 * flats && most < 0.76 * flats;
        let is_flat = (0.4..2.8).contains(&(height / most));
        let shape = Shape::new(FastenerKind::Nut, [2.0 * most, height, 2.0 * flats]);
        return (fits && is_flat).then_some(Shape { hole: [2.0 * least, 2.0 * most], ..shape });
    }
    let is_ring = |row: &Row| row.outer.is_round() && row.hole.is_round();
    let is_even = |row: &Row| {
        agrees(row.outer.most, outer, SAME_RADIUS) && agrees(row.hole.most, hole, SAME_RADIUS)
    };
    let sizes = [2.0 * hole, height, 2.0 * outer];
    if share(rows, |row| is_ring(row) && is_even(row)) > 0.6 && share(rows, is_ring) > 0.97 {
        let [bore, width, rim] = sizes.map(|x| x * scale);
        let most = rows.iter().map(|row| row.outer.most).fold(0.0, f64::max);
        if most > (1.0 + SAME_RADIUS) * outer {
            return None;
        }
        if height < 0.2 * outer * 2.0 && height > 0.02 * outer && hole > 0.28 * outer {
            let size = metric_washer(bore);
            let is_usual = |m: Metric| {
                (0.84..1.7).contains(&(rim / m.washer[1])) && width < 0.3 * m.diameter + 0.1
            };
            let needs_name = !size.is_some_and(is_usual);
            return Some(Shape { needs_name, ..Shape::new(FastenerKind::Washer, sizes) });
        }
        let needs_name = bearing([bore, rim, width]).is_none();
        let fits = hole > 0.2 * outer && hole < 0.85 * outer && height < 2.0 * outer;
        return fits.then_some(Shape { needs_name, ..Shape::new(FastenerKind::Bearing, sizes) });
    }
    let [inside, outside] =
        [median(rows.iter().map(|r| r.hole.median)), median(rows.iter().map(|r| r.outer.median))];
    let is_arc = |row: &Row| {
        let [a, b] = [row.outer.cover, row.hole.cover];
        (0.55..0.995).contains(&b) && a > 0.6 && agrees(row.hole.median, inside, SAME_RADIUS)
    };
    let is_thin = height < 0.15 * 2.0 * outside && outside - inside < 0.45 * outside;
    let is_circlip = is_thin && inside > 0.0 && share(rows, is_arc) > 0.9;
    is_circlip.then(|| Shape::new(FastenerKind::Circlip, [2.0 * inside, height, 2.0 * outside]))
}

/// Recognises dowels, and screws without a head.
fn cylinder_shape(profile: &mut Profile, rows: &[Row], scale: f64) -> Option<Shape> {
    let radius = rows.iter().map(|row| row.outer.most).fold(0.0, f64::max);
    let is_full =
        |row: &Row| row.outer.cover > 0.97 && row.outer.most > (1.0 - SAME_RADIUS) * radius;
    let length = profile.length();
    if share(rows, is_full) < 0.7 || length < radius {
        return None;
    }
    let diameter = 2.0 * profile.radius();
    let sizes = [diameter, length, diameter];
    let screw = Shape { head: Some(Head::None), ..Shape::new(FastenerKind::Screw, sizes) };
    let [low, high] = profile.range;
    let is_solid = share(rows, |row| row.hole.cover > 0.5) == 0.0;
    let pitch = measure_pitch(profile, [low + 0.1 * length, high - 0.1 * length], diameter);
    let is_round = share(rows, |row| row.outer.is_round()) > 0.97;
    let is_plain = is_solid && pitch.is_none() && is_round;
    if is_plain {
        let is_blunt = |at: f64| {
            let at_end = |p: &&glam::DVec3| (p.z - at).abs() <= 1e-3 * length;
            let ends = profile.vertices.iter().filter(at_end);
            ends.map(|p| p.truncate().length()).fold(0.0, f64::max) < 0.985 * diameter / 2.0
        };
        let rounded = is_blunt(low) && is_blunt(high);
        let standard = is_dowel([diameter * scale, length * scale]) && length < 10.0 * diameter;
        let dowel = Shape::new(FastenerKind::Dowel, sizes);
        return Some(Shape { needs_name: !(rounded && standard), ..dowel });
    }
    let drive = find_drive(profile, [high - 0.8 * length, high]);
    let is_turned = pitch.is_some() || share(rows, |row| row.outer.is_round()) > 0.7;
    let is_grub = is_turned
        && drive.is_some_and(|(drive, _)| drive != Drive::Slot || pitch.is_some())
        && share(rows, |row| row.hole.cover > 0.5) < 0.85
        && length < 10.0 * diameter;
    let is_stud = is_solid && pitch.is_some() && length < SHANK_LENGTH[1] * diameter;
    (is_grub || is_stud).then_some(Shape { drive, pitch, ..screw })
}

/// Recognises screws with a head at the end of the axis.
fn screw_shape(profile: &mut Profile, rows: &[Row]) -> Option<Shape> {
    let widest = rows.iter().map(|row| row.outer.most).fold(0.0, f64::max);
    let first = rows.iter().position(|row| row.outer.most > widest / HEAD_RATIO[0])?;
    if first < 3 {
        return None;
    }
    let (lower, upper) = rows.split_at(first);
    let plateau = |radius: f64| {
        let same = lower.iter().filter(|row| agrees(row.outer.most, radius, SAME_RADIUS));
        same.count() >= MIN_PLATEAU
    };
    let shank = lower.iter().map(|row| row.outer.most).filter(|r| plateau(*r)).fold(0.0, f64::max);
    let is_shank = |row: &Row| {
        row.outer.cover > 0.97
            && row.outer.least > 0.55 * row.outer.most
            && row.outer.most > MIN_CORE * shank
            && row.outer.most <= BEYOND_SHANK * shank
            && row.outer.symmetry[2] < 0.9
    };
    let is_hollow = |row: &Row| row.hole.cover > 0.5;
    let solid = &lower[..lower.len() * 3 / 4];
    let is_waist = |row: &Row| row.outer.most <= 1.1 * shank;
    if share(lower, is_shank) < 0.55 || solid.iter().any(is_hollow) || share(upper, is_waist) > 0.3
    {
        return None;
    }
    // Vertices of the head and of its recess do not count.
    let is_same = |row: &&Row| agrees(row.outer.most, shank, SAME_RADIUS);
    let reach = lower.iter().filter(is_same).map(|row| row.z).fold(profile.range[0], f64::max);
    let own = profile.vertices.iter().filter(|p| p.z < reach).map(|p| p.truncate().length());
    let shank = own.filter(|r| *r <= BEYOND_SHANK * shank).fold(0.0, f64::max);
    let diameter = 2.0 * shank;
    let (seat, is_flat) = head_seat(profile, shank)?;
    let [low, high] = profile.range;
    let (height, widest) = (high - seat, profile.radius());
    let (length, ratio) = (seat - low, widest / shank);
    let between = |x: f64, [least, most]: [f64; 2]| (least..=most).contains(&x);
    if !between(ratio, HEAD_RATIO)
        || !between(height / diameter, HEAD_HEIGHT)
        || !between(length / diameter, SHANK_LENGTH)
    {
        return None;
    }
    let head = profile.rows([seat, high], HEAD_ROWS);
    let hexagons = share(&head, |row| row.outer.is_hexagon());
    let top = median(head[HEAD_ROWS / 2..].iter().map(|row| row.outer.most));
    let even = share(&head, |row| row.outer.most > (1.0 - SAME_RADIUS) * widest);
    let form = if hexagons > 0.6 {
        Head::Hexagon
    } else if hexagons > 0.35 && head[0].outer.most > 1.05 * top {
        Head::FlangedHexagon
    } else if !is_flat && cone_share(profile, seat - 0.1 * shank) > 0.4 {
        Head::Countersunk
    } else if is_flat && even > 0.7 {
        Head::Cylinder
    } else {
        Head::Rounded
    };
    let is_hexagonal = form.is_hexagonal();
    if share(&head, |row| row.outer.cover > 0.9) < 0.6 && !is_hexagonal {
        return None;
    }
    let drive = if is_hexagonal { None } else { find_drive(profile, [seat, high]) };
    let width = if is_hexagonal {
        2.0 * median(head.iter().filter(|r| r.outer.is_hexagon()).map(|r| r.outer.least))
    } else {
        2.0 * widest
    };
    let is_usual_cone = form == Head::Countersunk && (1.6..2.4).contains(&ratio);
    let length = if form == Head::Countersunk { high - low } else { length };
    let pitch = measure_pitch(profile, [low + 0.1 * length, seat - 0.25 * diameter], diameter)
        .or_else(|| measure_pitch(profile, [low + 0.1 * length, low.midpoint(seat)], diameter));
    let shaft = profile.circle_radius(shank, [low, reach]).map_or(diameter, |radius| 2.0 * radius);
    Some(Shape {
        needs_name: drive.is_none() && !is_hexagonal && !is_usual_cone && pitch.is_none(),
        head: Some(form),
        head_height: height,
        drive,
        pitch,
        ..Shape::new(FastenerKind::Screw, [shaft, length, width])
    })
}

/// Returns where the head begins, and whether it has a flat seat: the flat ring around the shank that faces the tip, or
/// else the place at which the surface leaves the shank.
fn head_seat(profile: &mut Profile, shank: f64) -> Option<(f64, bool)> {
    let (mut area, mut sum) = (0.0, 0.0);
    for (corners, normal) in profile.facets() {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let is_out = corners.iter().any(|p| p.truncate().length() > BEYOND_SHANK * shank);
        if is_out && normal.z < -0.99 * normal.length() {
            area -= normal.z / 2.0;
            sum -= normal.z / 2.0 * middle.z;
        }
    }
    profile.work += 2 * profile.vertices.len() as u64;
    if area > 0.25 * PI * shank * shank {
        return Some((sum / area, true));
    }
    // Where the surface leaves the shank.
    let mut first = f64::INFINITY;
    for (corners, normal) in profile.facets() {
        let middle = (corners[0] + corners[1] + corners[2]).truncate();
        if normal.truncate().dot(middle) <= 0.0 {
            continue;
        }
        for (k, a) in corners.iter().enumerate() {
            for b in [corners[(k + 1) % 3], corners[(k + 2) % 3]] {
                let [near, far] = [*a, b].map(|p| p.truncate().length());
                if near <= 1.001 * shank && far > BEYOND_SHANK * shank {
                    let share = ((shank - near) / (far - near)).max(0.0);
                    first = first.min(a.z + (b.z - a.z) * share);
                }
            }
        }
    }
    first.is_finite().then_some((first, false))
}

/// Returns the share of the lateral area above a coordinate that is a cone of 74 to 124 degrees around the shank.
fn cone_share(profile: &mut Profile, low: f64) -> f64 {
    let (mut all, mut cone) = (0.0, 0.0);
    for (corners, normal) in profile.facets() {
        let (middle, size) = ((corners[0] + corners[1] + corners[2]) / 3.0, normal.length());
        let out = middle.truncate().dot(normal.truncate()) > 0.0;
        if middle.z > low && out && normal.z.abs() < 0.95 * size {
            all += size;
            if (-0.88..-0.6).contains(&(normal.z / size)) {
                cone += size;
            }
        }
    }
    profile.work += profile.vertices.len() as u64;
    if all > 0.0 { cone / all } else { 0.0 }
}

/// Finds the recess of a head that ends at the upper limit of a range, and its width.
fn find_drive(profile: &mut Profile, range: [f64; 2]) -> Option<(Drive, f64)> {
    let rows = profile.rows(range, HEAD_ROWS);
    let is_open = |row: &&Row| row.hole.cover > 0.5;
    let open: Vec<&Row> = rows.iter().rev().take_while(is_open).collect();
    if open.len() < 2 {
        return None;
    }
    let ring = open[open.len() / 2].hole;
    let width = 2.0 * ring.least;
    // An error of the centre cancels in the sum of apothem and corner.
    let across = |sides: f64| ring.least + ring.most * (PI / sides).cos();
    let [two, four, six] = ring.symmetry;
    if ring.least <= 0.0 {
        return None;
    }
    let ratio = ring.most / ring.least;
    if six > 0.9 && ratio < 1.25 {
        return Some((Drive::HexSocket, across(6.0)));
    }
    if two > 0.6 && ratio > 1.6 {
        return Some((Drive::Slot, width));
    }
    if four > 0.8 {
        let is_square = ratio < 1.55;
        let square = (Drive::SquareSocket, across(4.0));
        return Some(if is_square { square } else { (Drive::Cross, width) });
    }
    (1.15..1.8).contains(&ratio).then_some((Drive::Hexalobular, 2.0 * ring.most))
}

/// Measures the signed pitch of an external thread within a range: the phase of the first Fourier coefficient of the
/// radius increases by a turn for each pitch. Returns `None` without a thread.
fn measure_pitch(profile: &mut Profile, [low, high]: [f64; 2], diameter: f64) -> Option<f64> {
    let step = PITCH_STEP * diameter;
    let span = step * PITCH_ROWS as f64;
    let middle = low.midpoint(high);
    if high - low < span / 2.0 {
        return None;
    }
    let span = span.min(high - low);
    let rows = profile.rows([middle - span / 2.0, middle + span / 2.0], PITCH_ROWS);
    let step = span / PITCH_ROWS as f64;
    if rows.iter().any(|row| row.outer.cover < 0.9 || row.outer.first.length() < MIN_THREAD) {
        return None;
    }
    let turns: Vec<f64> = rows
        .windows(2)
        .map(|pair| pair[0].outer.first.angle_to(pair[1].outer.first) / TAU)
        .collect();
    let rise = turns.iter().sum::<f64>();
    let is_even = turns.iter().all(|turn| turn * rise.signum() > 0.0);
    let pitch = step * turns.len() as f64 / rise;
    (is_even && (0.04..0.45).contains(&(pitch.abs() / diameter))).then_some(pitch)
}

/// Recognises a parallel key from its volume and its extents along its faces.
pub(super) fn key_shape(extents: [f64; 3], volume: f64, scale: f64) -> Option<Shape> {
    let mut sides = extents;
    sides.sort_by(f64::total_cmp);
    let [height, width, length] = sides;
    let key = Shape::new(FastenerKind::Key, [width, length, height]);
    if !is_key([width * scale, height * scale]) || !(1.5..15.0).contains(&(length / width)) {
        return None;
    }
    let full = volume / (width * height * length);
    let round_ends = 1.0 - (1.0 - PI / 4.0) * width / length;
    if (full - round_ends).abs() < 0.01 && full < 0.99 {
        return Some(key);
    }
    (full > 0.985).then_some(Shape { needs_name: true, ..key })
}
