//! Connected regions of convex pieces, for display: a direction inside, the area and the corners.
//!
//! Pieces of neighbouring cells share part of a cell's side. The forms of such sides are exact, because they
//! are computed from differences of corners. Cuts can leave pieces that are narrower than rounding along a
//! boundary. Such a sliver is ignored if it touches a wider piece, because its outer side cannot be
//! distinguished from its inner one. No decision about a direction depends on this module.

use std::f64::consts::PI;

use glam::DVec3;

use super::answer::FreePiece;

/// Directions on the cube that differ by less are identified.
const SAME_DIRECTION: f64 = 1e-12;
/// Minimum angle, in radians, by which a boundary turns at a corner.
const MIN_TURN: f64 = 1e-6;
/// Area from which on a region is the whole sphere and has no boundary.
const WHOLE_SPHERE: f64 = 4.0 * PI * (1.0 - 1e-9);
/// Parts of a side that are shorter than this fraction of it are ignored.
const MIN_PART: f64 = 1e-9;
/// Maximum number of pieces whose centers are starting points of the search for the direction farthest from
/// the boundary.
const MAX_STARTS: usize = 32;
/// Maximum number of steps of the search for the direction farthest from the boundary.
const MAX_STEPS: usize = 60;
/// Step length at which the search for the direction farthest from the boundary ends, relative to the angle
/// to the boundary.
const MIN_STEP: f64 = 1e-3;

/// Connected region of free directions, including its boundary.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeRegion {
    /// Free direction of length 1 in the region, approximately the farthest one from the boundary.
    pub center: DVec3,
    /// Angle between `center` and the boundary in radians; `PI` if there is no boundary. It is 0 if the
    /// search for the farthest direction ended at a direction that is not free, so that `center` is the
    /// center of the largest piece.
    pub margin: f64,
    /// Corners of the boundary, where it turns by more than a millionth of a radian, in no particular order.
    /// They are directions with a largest component of 1 or -1. Only their last roundings make them inexact.
    pub corners: Vec<DVec3>,
    /// Arcs that form the boundary, each given by its ends, in no particular order.
    pub border: Vec<[DVec3; 2]>,
    /// Solid angle in steradians.
    pub area: f64,
    /// Convex pieces whose union is the region, except for some that are narrower than `1e-12` and touch
    /// another piece.
    pub pieces: Vec<FreePiece>,
}

/// Joins pieces that touch to regions, sorted by decreasing area. `is_free` classifies a direction exactly.
pub(super) fn connected_regions(
    pieces: &[FreePiece],
    is_free: impl Fn(DVec3) -> bool,
) -> Vec<FreeRegion> {
    let pieces = &without_slivers(pieces)[..];
    let touching = touching_pieces(pieces);
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
        regions.push(build_region(pieces, &members, &touching, &is_free));
    }
    regions.sort_by(|a, b| b.area.total_cmp(&a.area));
    regions
}

/// Removes slivers that touch another piece which is not a sliver.
fn without_slivers(pieces: &[FreePiece]) -> Vec<FreePiece> {
    let slivers: Vec<bool> = pieces.iter().map(is_sliver).collect();
    if !slivers.contains(&true) {
        return pieces.to_vec();
    }
    let touching = touching_pieces(pieces);
    let beside = |k: usize| slivers[k] && touching[k].iter().any(|&other| !slivers[other]);
    (0..pieces.len()).filter(|&k| !beside(k)).map(|k| pieces[k].clone()).collect()
}

/// Checks whether all corners lie on one line, up to rounding.
fn is_sliver(piece: &FreePiece) -> bool {
    let length = |k: usize| piece.corners[k].distance(piece.corners[(k + 1) % piece.corners.len()]);
    let longest = (0..piece.corners.len()).max_by(|&a, &b| length(a).total_cmp(&length(b)));
    longest.is_none_or(|k| {
        piece.corners.iter().all(|c| side_normal(piece, k).dot(*c).abs() < SAME_DIRECTION)
    })
}

fn build_region(
    pieces: &[FreePiece],
    members: &[usize],
    touching: &[Vec<usize>],
    is_free: impl Fn(DVec3) -> bool,
) -> FreeRegion {
    let own: Vec<FreePiece> = members.iter().map(|&k| pieces[k].clone()).collect();
    let mut corners: Vec<DVec3> = Vec::new();
    for &at in members {
        for &c in &pieces[at].corners {
            if corners.iter().any(|other| other.distance(c) < SAME_DIRECTION) {
                continue;
            }
            let around = touching[at].iter().chain([&at]).map(|&k| interior_angle(&pieces[k], c));
            let whole: f64 = around.sum();
            if (whole - PI).abs() > MIN_TURN && (whole - 2.0 * PI).abs() > MIN_TURN {
                corners.push(c);
            }
        }
    }
    let area: f64 = own.iter().map(|piece| piece.area).sum();
    let mean: DVec3 = own.iter().map(|piece| piece_center(piece) * piece.area).sum();
    let mut border: Vec<[DVec3; 2]> =
        members.iter().flat_map(|&at| outer_sides(pieces, at, &touching[at])).collect();
    if border.is_empty() && area < WHOLE_SPHERE {
        // The region is narrower than rounding, and its sides coincide. All of them form its boundary.
        border = own.iter().flat_map(piece_sides).collect();
        corners = own.iter().flat_map(|piece| piece.corners.iter().copied()).collect();
    }
    let inside = mean.try_normalize().filter(|d| is_free(*d));
    let (center, margin) =
        farthest_from_boundary(&border, inside.into_iter().chain(largest_centers(&own)));
    // The center of a piece is free, independently of the boundary.
    let middle = || largest_centers(&own).next().unwrap_or(DVec3::Z);
    let (center, margin) = if is_free(center) { (center, margin) } else { (middle(), 0.0) };
    FreeRegion { center, margin, corners, border, area, pieces: own }
}

/// Returns the centers of the largest pieces.
fn largest_centers(pieces: &[FreePiece]) -> impl Iterator<Item = DVec3> {
    let mut order: Vec<&FreePiece> = pieces.iter().collect();
    order.sort_by(|a, b| b.area.total_cmp(&a.area));
    order.into_iter().take(MAX_STARTS).map(piece_center)
}

/// Returns the sides of a piece.
fn piece_sides(piece: &FreePiece) -> impl Iterator<Item = [DVec3; 2]> + '_ {
    let next = piece.corners.iter().cycle().skip(1);
    piece.corners.iter().zip(next).map(|(a, b)| [*a, *b])
}

/// Returns the parts of a piece's sides that no other piece shares.
fn outer_sides(pieces: &[FreePiece], at: usize, touching: &[usize]) -> Vec<[DVec3; 2]> {
    let piece = &pieces[at];
    let mut found = Vec::new();
    for k in 0..piece.corners.len() {
        let (a, b) = (piece.corners[k], piece.corners[(k + 1) % piece.corners.len()]);
        let (form, vector) = (side_normal(piece, k), b - a);
        let along = |c: DVec3| (c - a).dot(vector) / vector.length_squared();
        let mut shared: Vec<[f64; 2]> = Vec::new();
        for other in touching.iter().map(|&other| &pieces[other]) {
            for (j, &c) in other.corners.iter().enumerate() {
                let d = other.corners[(j + 1) % other.corners.len()];
                if form.dot(c).abs() < SAME_DIRECTION && form.dot(d).abs() < SAME_DIRECTION {
                    let (s, t) = (along(c), along(d));
                    shared.push([s.min(t), s.max(t)]);
                }
            }
        }
        shared.sort_by(|x, y| x[0].total_cmp(&y[0]));
        let mut from = 0.0_f64;
        for [low, high] in shared.into_iter().chain([[1.0, 1.0]]) {
            if low.min(1.0) - from > MIN_PART {
                found.push([a + vector * from, a + vector * low.min(1.0)]);
            }
            from = from.max(high);
        }
    }
    found
}

/// Maximises the angle to a boundary by a pattern search, which begins at the one of the given directions
/// inside with the largest angle. Returns the direction and its angle; `Z` and 0 if no direction is given.
fn farthest_from_boundary(
    border: &[[DVec3; 2]],
    inside: impl Iterator<Item = DVec3>,
) -> (DVec3, f64) {
    let sides: Vec<BoundarySide> = border.iter().map(BoundarySide::new).collect();
    let margin = |d: DVec3| sides.iter().map(|side| side.angle_to(d)).fold(PI, f64::min);
    let starts = inside.map(|d| (d, margin(d)));
    let Some(mut best) = starts.max_by(|a, b| a.1.total_cmp(&b.1)) else { return (DVec3::Z, 0.0) };
    // Directions that are nearer than the boundary are inside.
    let mut step = best.1 / 2.0;
    for _ in 0..MAX_STEPS {
        let (u, v) = best.0.any_orthonormal_pair();
        let around = [u, u + v, v, v - u, -u, -u - v, -v, u - v];
        let moved = around.map(|vector| (best.0 + vector.normalize() * step).normalize());
        let next = moved.map(|d| (d, margin(d))).into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        match next {
            Some(next) if next.1 > best.1 => best = next,
            _ => step /= 2.0,
        }
        if step < MIN_STEP * best.1 {
            break;
        }
    }
    best
}

/// Side of a boundary, prepared for angles.
struct BoundarySide {
    ends: [DVec3; 2],
    /// Normal of the side's plane, and the directions from each end along the side.
    across: DVec3,
    along: [DVec3; 2],
}

impl BoundarySide {
    fn new([a, b]: &[DVec3; 2]) -> Self {
        let across = a.cross(b - a).normalize_or_zero();
        let ends = [a.normalize(), b.normalize()];
        Self { ends, across, along: [across.cross(ends[0]), ends[1].cross(across)] }
    }

    /// Returns the angle between the side and a direction of length 1.
    fn angle_to(&self, d: DVec3) -> f64 {
        if self.along.iter().all(|along| along.dot(d) >= 0.0) {
            let sine = self.across.dot(d - self.ends[0]).abs();
            return sine.atan2((1.0 - sine * sine).max(0.0).sqrt());
        }
        let chord = self.ends.map(|end| end.distance(d)).into_iter().fold(2.0, f64::min) / 2.0;
        2.0 * chord.atan2((1.0 - chord * chord).max(0.0).sqrt())
    }
}

/// Returns the center of a piece, of length 1.
fn piece_center(piece: &FreePiece) -> DVec3 {
    piece.corners.iter().sum::<DVec3>().normalize_or(DVec3::Z)
}

/// Returns for each piece the other pieces that share a direction with it.
fn touching_pieces(pieces: &[FreePiece]) -> Vec<Vec<usize>> {
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
            if boxes[b].0.x > boxes[a].1.x + SAME_DIRECTION {
                break;
            }
            let ([p, q], [r, s]) = ([boxes[a].0, boxes[a].1], [boxes[b].0, boxes[b].1]);
            let near = p.cmple(s + SAME_DIRECTION).all() && r.cmple(q + SAME_DIRECTION).all();
            if near
                && !has_separating_side(&pieces[a], &pieces[b])
                && !has_separating_side(&pieces[b], &pieces[a])
            {
                touching[a].push(b);
                touching[b].push(a);
            }
        }
    }
    touching
}

/// Checks whether a side of one piece separates it from another one.
fn has_separating_side(piece: &FreePiece, other: &FreePiece) -> bool {
    let inner: DVec3 = piece.corners.iter().sum();
    (0..piece.corners.len()).any(|k| {
        let form = side_normal(piece, k);
        let form = if form.dot(inner) < 0.0 { -form } else { form };
        other.corners.iter().all(|c| form.dot(*c) < -SAME_DIRECTION)
    })
}

/// Returns the unit normal of the plane through the origin and the side from corner `k`.
fn side_normal(piece: &FreePiece, k: usize) -> DVec3 {
    let (a, b) = (piece.corners[k], piece.corners[(k + 1) % piece.corners.len()]);
    // Exact for sides of cells.
    a.cross(b - a).normalize_or_zero()
}

/// Returns the interior angle of a piece at a direction on its boundary, and 0 for other directions.
fn interior_angle(piece: &FreePiece, at: DVec3) -> f64 {
    let count = piece.corners.len();
    if let Some(k) = (0..count).find(|&k| piece.corners[k].distance(at) < SAME_DIRECTION) {
        let vector = |other: DVec3| (other - at).reject_from(at);
        let (a, b) = (piece.corners[(k + 1) % count], piece.corners[(k + count - 1) % count]);
        return vector(a).angle_between(vector(b));
    }
    let is_on = |k: usize| {
        let (a, b) = (piece.corners[k], piece.corners[(k + 1) % count]);
        side_normal(piece, k).dot(at).abs() < SAME_DIRECTION && (a - at).dot(b - at) < 0.0
    };
    if (0..count).any(is_on) { PI } else { 0.0 }
}
