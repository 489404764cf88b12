//! Connected regions of convex pieces, for people: where they are, how large, and their corners.
//!
//! Pieces of neighbouring cells share a part of a border, which is a side of a cell: their forms are exact there, from
//! differences of corners. Nothing here decides what is free.

use std::f64::consts::PI;

use glam::DVec3;

use super::answer::FreePiece;

/// Directions of the cube that differ by less are taken for one.
const BESIDE: f64 = 1e-12;
/// Borders that turn by less, in radians, have no corner.
const TURN: f64 = 1e-6;

/// A connected region of free directions, borders included.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeRegion {
    /// A free direction of it, of length 1, away from its borders where it is convex.
    pub center: DVec3,
    /// Where its border turns, by more than a millionth of a right angle: directions with a largest component of 1 (or
    /// -1), exact but for their last roundings, in no order.
    pub corners: Vec<DVec3>,
    /// Its solid angle.
    pub area: f64,
    /// Convex pieces that together are it.
    pub pieces: Vec<FreePiece>,
}

/// Pieces joined where they touch, the largest region first; `is_free` tells of a direction.
pub(super) fn regions(pieces: &[FreePiece], is_free: impl Fn(DVec3) -> bool) -> Vec<FreeRegion> {
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
    let area = own.iter().map(|piece| piece.area).sum();
    let mean: DVec3 = own.iter().map(|piece| center(piece) * piece.area).sum();
    let largest = own.iter().max_by(|a, b| a.area.total_cmp(&b.area)).map_or(DVec3::Z, center);
    let inside = mean.try_normalize().filter(|d| is_free(*d));
    FreeRegion { center: inside.unwrap_or(largest), corners, area, pieces: own }
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
