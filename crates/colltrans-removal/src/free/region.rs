//! Connected regions of convex pieces, for people: where they are, how large, and their corners.
//!
//! Pieces of neighbouring cells share a part of a border, which is a side of a cell: their forms are exact there, from
//! differences of corners. Pieces narrower than roundings, which cuts leave along a border, are passed over where they
//! lie beside another: of each two of their sides it could not be told which one is outside. Nothing here decides what
//! is free.

use std::f64::consts::PI;

use glam::DVec3;

use super::answer::FreePiece;

/// Directions of the cube that differ by less are taken for one.
const BESIDE: f64 = 1e-12;
/// Borders that turn by less, in radians, have no corner.
const TURN: f64 = 1e-6;
/// Regions of at least this area have no border.
const WHOLE: f64 = 4.0 * PI * (1.0 - 1e-9);
/// Parts of a side that are shorter than this share of it are nothing.
const PART: f64 = 1e-9;
/// Pieces whose middles are tried for the direction farthest from a border; steps from there, and how short these get
/// against the angle to the border.
const MIDDLES: usize = 32;
const STEPS: usize = 60;
const FINEST: f64 = 1e-3;

/// A connected region of free directions, borders included.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeRegion {
    /// A free direction of it, of length 1, nearly the farthest from its border.
    pub center: DVec3,
    /// The angle between that and the border, in radians; `PI` if there is none.
    pub margin: f64,
    /// Where its border turns, by more than a millionth of a radian: directions with a largest component of 1 (or
    /// -1), exact but for their last roundings, in no order.
    pub corners: Vec<DVec3>,
    /// Arcs that together are its border, by their ends, in no order.
    pub border: Vec<[DVec3; 2]>,
    /// Its solid angle.
    pub area: f64,
    /// Convex pieces that together are it, but for some that are narrower than `1e-12` and lie beside another.
    pub pieces: Vec<FreePiece>,
}

/// Pieces joined where they touch, the largest region first; `is_free` tells of a direction.
pub(super) fn regions(pieces: &[FreePiece], is_free: impl Fn(DVec3) -> bool) -> Vec<FreeRegion> {
    let pieces = &without_slivers(pieces)[..];
    let touching = touching(pieces);
    let mut group = vec![usize::MAX; pieces.len()];
    let mut regions: Vec<FreeRegion> = Vec::new();
    for first in 0..pieces.len() {
        if group[first] != usize::MAX {
            continue;
        }
        group[first] = regions.len();
        let mut members = vec![first];
        let mut next = 0;
        while let Some(&at) = members.get(next) {
            next += 1;
            for &other in &touching[at] {
                if group[other] == usize::MAX {
                    group[other] = regions.len();
                    members.push(other);
                }
            }
        }
        regions.push(region(pieces, &members, &touching, &is_free));
    }
    regions.sort_by(|a, b| b.area.total_cmp(&a.area));
    regions
}

/// All pieces but slivers that touch a piece that is none.
fn without_slivers(pieces: &[FreePiece]) -> Vec<FreePiece> {
    let slivers: Vec<bool> = pieces.iter().map(is_sliver).collect();
    if !slivers.contains(&true) {
        return pieces.to_vec();
    }
    let touching = touching(pieces);
    let beside = |k: usize| slivers[k] && touching[k].iter().any(|&other| !slivers[other]);
    (0..pieces.len()).filter(|&k| !beside(k)).map(|k| pieces[k].clone()).collect()
}

/// Whether all corners lie on one line, but for roundings.
fn is_sliver(piece: &FreePiece) -> bool {
    let length = |k: usize| piece.corners[k].distance(piece.corners[(k + 1) % piece.corners.len()]);
    let longest = (0..piece.corners.len()).max_by(|&a, &b| length(a).total_cmp(&length(b)));
    longest.is_none_or(|k| piece.corners.iter().all(|c| side(piece, k).dot(*c).abs() < BESIDE))
}

fn region(
    pieces: &[FreePiece],
    members: &[usize],
    touching: &[Vec<usize>],
    is_free: impl Fn(DVec3) -> bool,
) -> FreeRegion {
    let own: Vec<FreePiece> = members.iter().map(|&k| pieces[k].clone()).collect();
    let mut corners: Vec<DVec3> = Vec::new();
    for &at in members {
        for &c in &pieces[at].corners {
            if corners.iter().any(|other| other.distance(c) < BESIDE) {
                continue;
            }
            let around = touching[at].iter().chain([&at]).map(|&k| angle(&pieces[k], c));
            let whole: f64 = around.sum();
            if (whole - PI).abs() > TURN && (whole - 2.0 * PI).abs() > TURN {
                corners.push(c);
            }
        }
    }
    let area: f64 = own.iter().map(|piece| piece.area).sum();
    let mean: DVec3 = own.iter().map(|piece| center(piece) * piece.area).sum();
    let mut border: Vec<[DVec3; 2]> =
        members.iter().flat_map(|&at| outer_sides(pieces, at, &touching[at])).collect();
    if border.is_empty() && area < WHOLE {
        // Narrower than roundings, so its sides lie on each other: all of them are its border.
        border = own.iter().flat_map(sides).collect();
        corners = own.iter().flat_map(|piece| piece.corners.iter().copied()).collect();
    }
    let inside = mean.try_normalize().filter(|d| is_free(*d));
    let (center, margin) = farthest(&border, inside.into_iter().chain(middles(&own)));
    // The middle of a piece is free whatever the border is.
    let middle = || middles(&own).next().unwrap_or(DVec3::Z);
    let (center, margin) = if is_free(center) { (center, margin) } else { (middle(), 0.0) };
    FreeRegion { center, margin, corners, border, area, pieces: own }
}

/// The middles of the largest pieces.
fn middles(pieces: &[FreePiece]) -> impl Iterator<Item = DVec3> {
    let mut order: Vec<&FreePiece> = pieces.iter().collect();
    order.sort_by(|a, b| b.area.total_cmp(&a.area));
    order.into_iter().take(MIDDLES).map(center)
}

/// The sides of a piece.
fn sides(piece: &FreePiece) -> impl Iterator<Item = [DVec3; 2]> + '_ {
    let next = piece.corners.iter().cycle().skip(1);
    piece.corners.iter().zip(next).map(|(a, b)| [*a, *b])
}

/// What other pieces leave of the sides of one.
fn outer_sides(pieces: &[FreePiece], at: usize, touching: &[usize]) -> Vec<[DVec3; 2]> {
    let piece = &pieces[at];
    let mut found = Vec::new();
    for k in 0..piece.corners.len() {
        let (a, b) = (piece.corners[k], piece.corners[(k + 1) % piece.corners.len()]);
        let (form, way) = (side(piece, k), b - a);
        let along = |c: DVec3| (c - a).dot(way) / way.length_squared();
        let mut shared: Vec<[f64; 2]> = Vec::new();
        for other in touching.iter().map(|&other| &pieces[other]) {
            for (j, &c) in other.corners.iter().enumerate() {
                let d = other.corners[(j + 1) % other.corners.len()];
                if form.dot(c).abs() < BESIDE && form.dot(d).abs() < BESIDE {
                    let (s, t) = (along(c), along(d));
                    shared.push([s.min(t), s.max(t)]);
                }
            }
        }
        shared.sort_by(|x, y| x[0].total_cmp(&y[0]));
        let mut from = 0.0_f64;
        for [low, high] in shared.into_iter().chain([[1.0, 1.0]]) {
            if low.min(1.0) - from > PART {
                found.push([a + way * from, a + way * low.min(1.0)]);
            }
            from = from.max(high);
        }
    }
    found
}

/// A direction inside a border, nearly the farthest from it, from some to begin with, and how far it is.
fn farthest(border: &[[DVec3; 2]], inside: impl Iterator<Item = DVec3>) -> (DVec3, f64) {
    let sides: Vec<Side> = border.iter().map(Side::new).collect();
    let margin = |d: DVec3| sides.iter().map(|side| side.angle(d)).fold(PI, f64::min);
    let starts = inside.map(|d| (d, margin(d)));
    let Some(mut best) = starts.max_by(|a, b| a.1.total_cmp(&b.1)) else { return (DVec3::Z, 0.0) };
    // Whatever is nearer than the border is inside.
    let mut step = best.1 / 2.0;
    for _ in 0..STEPS {
        let (u, v) = best.0.any_orthonormal_pair();
        let around = [u, u + v, v, v - u, -u, -u - v, -v, u - v];
        let moved = around.map(|way| (best.0 + way.normalize() * step).normalize());
        let next = moved.map(|d| (d, margin(d))).into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        match next {
            Some(next) if next.1 > best.1 => best = next,
            _ => step /= 2.0,
        }
        if step < FINEST * best.1 {
            break;
        }
    }
    best
}

/// A side of a border, to be measured from.
struct Side {
    ends: [DVec3; 2],
    /// Across it, and from each end along it.
    across: DVec3,
    along: [DVec3; 2],
}

impl Side {
    fn new([a, b]: &[DVec3; 2]) -> Self {
        let across = a.cross(b - a).normalize_or_zero();
        let ends = [a.normalize(), b.normalize()];
        Self { ends, across, along: [across.cross(ends[0]), ends[1].cross(across)] }
    }

    /// The angle between it and a direction of length 1.
    fn angle(&self, d: DVec3) -> f64 {
        if self.along.iter().all(|along| along.dot(d) >= 0.0) {
            let sine = self.across.dot(d - self.ends[0]).abs();
            return sine.atan2((1.0 - sine * sine).max(0.0).sqrt());
        }
        let chord = self.ends.map(|end| end.distance(d)).into_iter().fold(2.0, f64::min) / 2.0;
        2.0 * chord.atan2((1.0 - chord * chord).max(0.0).sqrt())
    }
}

/// The middle of a piece, of length 1.
fn center(piece: &FreePiece) -> DVec3 {
    piece.corners.iter().sum::<DVec3>().normalize_or(DVec3::Z)
}

/// For each piece the others that have a direction of it.
fn touching(pieces: &[FreePiece]) -> Vec<Vec<usize>> {
    let bounds = |piece: &FreePiece| {
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        piece.corners.iter().fold(start, |(low, high), &c| (low.min(c), high.max(c)))
    };
    let boxes: Vec<(DVec3, DVec3)> = pieces.iter().map(bounds).collect();
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    order.sort_by(|&a, &b| boxes[a].0.x.total_cmp(&boxes[b].0.x));
    let mut touching = vec![Vec::new(); pieces.len()];
    for (k, &a) in order.iter().enumerate() {
        for &b in &order[k + 1..] {
            if boxes[b].0.x > boxes[a].1.x + BESIDE {
                break;
            }
            let ([p, q], [r, s]) = ([boxes[a].0, boxes[a].1], [boxes[b].0, boxes[b].1]);
            let near = p.cmple(s + BESIDE).all() && r.cmple(q + BESIDE).all();
            if near && !is_apart(&pieces[a], &pieces[b]) && !is_apart(&pieces[b], &pieces[a]) {
                touching[a].push(b);
                touching[b].push(a);
            }
        }
    }
    touching
}

/// Whether a side of one piece has all of another behind it.
fn is_apart(piece: &FreePiece, other: &FreePiece) -> bool {
    let inner: DVec3 = piece.corners.iter().sum();
    (0..piece.corners.len()).any(|k| {
        let form = side(piece, k);
        let form = if form.dot(inner) < 0.0 { -form } else { form };
        other.corners.iter().all(|c| form.dot(*c) < -BESIDE)
    })
}

/// The plane through the origin and a side, from the corner of that number, of length 1.
fn side(piece: &FreePiece, k: usize) -> DVec3 {
    let (a, b) = (piece.corners[k], piece.corners[(k + 1) % piece.corners.len()]);
    // Exact along the sides of cells.
    a.cross(b - a).normalize_or_zero()
}

/// The angle under which a direction on the border of a piece sees it, 0 from elsewhere.
fn angle(piece: &FreePiece, at: DVec3) -> f64 {
    let count = piece.corners.len();
    if let Some(k) = (0..count).find(|&k| piece.corners[k].distance(at) < BESIDE) {
        let way = |other: DVec3| (other - at).reject_from(at);
        let (a, b) = (piece.corners[(k + 1) % count], piece.corners[(k + count - 1) % count]);
        return way(a).angle_between(way(b));
    }
    let is_on = |k: usize| {
        let (a, b) = (piece.corners[k], piece.corners[(k + 1) % count]);
        side(piece, k).dot(at).abs() < BESIDE && (a - at).dot(b - at) < 0.0
    };
    if (0..count).any(is_on) { PI } else { 0.0 }
}
