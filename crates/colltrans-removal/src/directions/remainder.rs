//! The remainder of a cell outside some cones: convex pieces with exact corners.
//!
//! A corner is a corner of the cell or the intersection of two lines. In general its side of a third line is
//! the sign of a determinant of the linear forms of the three lines. Cones are open, therefore pieces are
//! closed. Between two cones an arc or a point may remain: a piece with two corners or with one.

use std::cmp::Ordering;
use std::cmp::Ordering::{Equal, Greater, Less};

use glam::DVec3;

use super::bodies::Bodies;
use super::cell::{Cell, CubeSide, solid_angle};
use super::cone::Cone;
use super::line::{Line, PlaneVertex, Ray, exact_cross, orientation};
use super::window::Window;
use colltrans_kernel::integer::{Integer, LARGE_LIMBS, SMALL_LIMBS};

/// Error of a place above which it is computed from exact integers.
const MAX_PLACE_ERROR: f64 = 1e-14;

/// Error: a number is too large for the exact arithmetic, or a limit of pieces, cones or node visits is
/// exceeded.
pub(super) struct LimitExceeded;

/// Corner of a piece.
#[derive(Debug, Clone, Copy)]
struct PieceCorner {
    at: CornerDirection,
    /// Two lines that intersect in the corner.
    lines: [u32; 2],
    place: [f64; 2],
    /// Upper bound on the error of each coordinate of `place`.
    error: f64,
}

/// Exact direction of a corner.
#[derive(Debug, Clone, Copy)]
enum CornerDirection {
    OfCell(DVec3),
    /// The cross product of the forms of its lines, or its opposite.
    Crossing {
        against: bool,
    },
    /// The direction from the first vertex to the second one, in which lines intersect that share both
    /// vertices.
    Toward([PlaneVertex; 2]),
}

/// Convex part of a cell.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    corners: Vec<PieceCorner>,
    /// Line from each corner to the next one.
    edges: Vec<u32>,
}

impl Piece {
    pub(super) fn corner_places(&self) -> Vec<[f64; 2]> {
        self.corners.iter().map(|corner| corner.place).collect()
    }

    /// Checks whether the piece has an area. An arc has two corners, a point has one.
    pub(super) fn is_region(&self) -> bool {
        self.corners.len() >= 3
    }

    pub(super) fn area(&self) -> f64 {
        if self.is_region() { solid_angle(&self.corner_places()) } else { 0.0 }
    }

    /// Returns an upper bound on the error of the area.
    pub(super) fn area_error(&self) -> f64 {
        let places = self.corner_places();
        let [mut around, mut error] = [0.0_f64; 2];
        for (k, [u, v]) in places.iter().enumerate() {
            let [s, t] = places[(k + 1) % places.len()];
            around += (u - s).abs() + (v - t).abs();
            error = error.max(self.corners[k].error);
        }
        // A boundary displaced by the error, and the rounding of a sum of angles.
        if self.is_region() { (2.0 * error + 32.0 * f64::EPSILON) * around } else { 0.0 }
    }

    /// Returns the mean of the corners.
    pub(super) fn center(&self) -> [f64; 2] {
        let count = self.corners.len() as f64;
        let mean = |axis: usize| self.corners.iter().map(|c| c.place[axis]).sum::<f64>() / count;
        [mean(0), mean(1)]
    }
}

/// Piece with its lines, which later exact tests need.
pub(super) struct Outline {
    pub(super) corners: Vec<OutlineCorner>,
    /// Line from each corner to the next one; an arc has the same line twice.
    pub(super) edges: Vec<Line>,
}

/// Corner of an outline.
#[derive(Clone, Copy)]
pub(super) struct OutlineCorner {
    pub(super) ray: Ray,
    /// Two lines that intersect in the corner.
    pub(super) lines: [Line; 2],
    /// Rounded direction with a largest component of 1 or -1.
    pub(super) direction: DVec3,
}

/// Remainder of a cell outside some cones.
#[derive(Debug)]
pub(super) struct Remainder {
    cell: Cell,
    lines: Vec<Line>,
    pub(super) pieces: Vec<Piece>,
}

impl Remainder {
    /// Returns a remainder that consists of the whole cell.
    pub(super) fn of_cell(cell: Cell) -> Self {
        let [_, i, j] = cell.side.axes();
        let across = DVec3::AXES[cell.side.axes()[0]] * cell.side.sign();
        let [u, v] = [cell.coordinate_range(0), cell.coordinate_range(1)];
        // The edges in cyclic order: lower v, upper u, upper v, lower u.
        let bounds = [(j, v[0]), (i, u[1]), (j, v[1]), (i, u[0])];
        let lines = bounds
            .map(|(axis, at)| Line::from_exact_form(DVec3::AXES[axis] - across * at))
            .to_vec();
        let places = cell.corner_places();
        let corner = |k: usize| PieceCorner {
            at: CornerDirection::OfCell(cell.side.direction_at(places[k])),
            lines: [(k as u32 + 3) % 4, k as u32],
            place: places[k],
            error: 0.0,
        };
        let corners = [0, 1, 2, 3].map(corner).to_vec();
        Self { cell, lines, pieces: vec![Piece { corners, edges: vec![0, 1, 2, 3] }] }
    }

    /// Returns a remainder with one of the pieces alone.
    pub(super) fn with_piece(&self, piece: &Piece) -> Self {
        Self { cell: self.cell, lines: self.lines.clone(), pieces: vec![piece.clone()] }
    }

    /// Returns the bounding rectangle of a piece.
    pub(super) fn bounding_window(&self, piece: &Piece) -> Window {
        let around = |axis: usize| {
            let ends =
                piece.corners.iter().map(|c| (c.place[axis] - c.error, c.place[axis] + c.error));
            let (low, high) =
                ends.fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
            let [least, most] = self.cell.coordinate_range(axis);
            [low.max(least), high.min(most)]
        };
        Window::new(self.cell.side, around(0), around(1))
    }

    /// Returns a piece with its lines.
    pub(super) fn outline(&self, piece: &Piece) -> Outline {
        let form = |k: u32| self.lines[k as usize];
        let turn = |corner: &PieceCorner| OutlineCorner {
            ray: match corner.at {
                CornerDirection::OfCell(d) => Ray::Exactly(d),
                CornerDirection::Toward(ends) => Ray::Toward(ends),
                CornerDirection::Crossing { against } => {
                    let [a, b] = corner.lines.map(form);
                    Ray::Crossing(if against { [b, a] } else { [a, b] })
                }
            },
            lines: corner.lines.map(form),
            direction: self.cell.side.direction_at(corner.place) + 0.0,
        };
        Outline {
            corners: piece.corners.iter().map(turn).collect(),
            edges: piece.edges.iter().map(|&k| form(k)).collect(),
        }
    }

    /// Subtracts a cone. Returns `true` if the cone contains a direction of a piece. Returns an error for
    /// more than `most` pieces, or if a number is too large.
    pub(super) fn subtract_cone(
        &mut self,
        bodies: &Bodies,
        cone: &Cone,
        most: usize,
    ) -> Result<bool, LimitExceeded> {
        let mut changed = false;
        let mut numbers = Vec::new();
        for at in (0..self.pieces.len()).rev() {
            if self.cone_misses_piece(bodies, at, cone)? {
                continue;
            }
            if !changed {
                numbers = (0..cone.lines.len()).map(|k| (self.lines.len() + k) as u32).collect();
                self.lines.extend_from_slice(&cone.lines);
                changed = true;
            }
            let piece = self.pieces.swap_remove(at);
            self.subtract_from_piece(bodies, piece, &numbers)?;
        }
        if self.pieces.len() > most { Err(LimitExceeded) } else { Ok(changed) }
    }

    /// Checks whether a cone contains no direction of a piece: one of its sides has the whole piece on it or
    /// behind it, or nothing of the piece is left on the inner sides of all.
    fn cone_misses_piece(
        &mut self,
        bodies: &Bodies,
        at: usize,
        cone: &Cone,
    ) -> Result<bool, LimitExceeded> {
        let first = self.lines.len();
        self.lines.extend_from_slice(&cone.lines);
        let missed = self.is_outside(bodies, &self.pieces[at], first);
        self.lines.truncate(first);
        missed
    }

    fn is_outside(
        &self,
        bodies: &Bodies,
        piece: &Piece,
        first: usize,
    ) -> Result<bool, LimitExceeded> {
        let lines = first as u32..self.lines.len() as u32;
        let mut mixed = Vec::new();
        for line in lines.clone() {
            let sides = self.corner_sides(bodies, piece, line)?;
            if !sides.contains(&Greater) {
                return Ok(true);
            }
            if sides.contains(&Less) {
                mixed.push(line);
            }
        }
        if first == self.lines.len() {
            return Ok(true);
        }
        let mut inner = piece.clone();
        for line in mixed {
            let sides = self.corner_sides(bodies, &inner, line)?;
            if !sides.contains(&Greater) {
                return Ok(true);
            }
            inner = self.inner_part(bodies, &inner, line, &sides)?;
        }
        for line in lines {
            if !self.corner_sides(bodies, &inner, line)?.contains(&Greater) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Subtracts a cone, given by the indices of its lines, from a piece. Each step splits off the part
    /// outside the next line. An arc or a point that lies on an earlier line is not kept, because an earlier
    /// part contains it.
    fn subtract_from_piece(
        &mut self,
        bodies: &Bodies,
        piece: Piece,
        lines: &[u32],
    ) -> Result<(), LimitExceeded> {
        let mut inner = piece;
        for (k, &line) in lines.iter().enumerate() {
            let sides = self.corner_sides(bodies, &inner, line)?;
            if !sides.contains(&Greater) {
                self.pieces.push(inner);
                return Ok(());
            }
            if sides.iter().all(|side| *side == Greater) {
                continue;
            }
            let reversed: Vec<Ordering> = sides.iter().map(|side| side.reverse()).collect();
            let outer = self.inner_part(bodies, &inner, line, &reversed)?;
            if outer.is_region() || !self.is_on_one_of(bodies, &outer, &lines[..k])? {
                self.pieces.push(outer);
            }
            if sides.contains(&Less) {
                inner = self.inner_part(bodies, &inner, line, &sides)?;
            }
        }
        Ok(())
    }

    /// Checks whether all corners of a piece lie on one of the lines.
    fn is_on_one_of(
        &self,
        bodies: &Bodies,
        piece: &Piece,
        lines: &[u32],
    ) -> Result<bool, LimitExceeded> {
        for &line in lines {
            if self.corner_sides(bodies, piece, line)?.iter().all(|side| *side == Equal) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Returns the side of a line for each corner of a piece.
    fn corner_sides(
        &self,
        bodies: &Bodies,
        piece: &Piece,
        line: u32,
    ) -> Result<Vec<Ordering>, LimitExceeded> {
        piece.corners.iter().map(|corner| self.corner_side(bodies, corner, line)).collect()
    }

    fn corner_side(
        &self,
        bodies: &Bodies,
        corner: &PieceCorner,
        line: u32,
    ) -> Result<Ordering, LimitExceeded> {
        let form = |k: u32| &self.lines[k as usize];
        match corner.at {
            CornerDirection::OfCell(d) => Ok(form(line).side_of_direction(bodies, d)),
            CornerDirection::Toward(ends) => Ok(form(line).side_of_displacement(bodies, ends)),
            CornerDirection::Crossing { .. } if corner.lines.contains(&line) => Ok(Equal),
            CornerDirection::Crossing { against } => {
                let [a, b] = corner.lines;
                let side =
                    orientation(bodies, [form(a), form(b), form(line)]).ok_or(LimitExceeded)?;
                Ok(if against { side.reverse() } else { side })
            }
        }
    }

    /// Returns the part of a piece on the inner side of a line or on it. `sides` holds the sides of the
    /// corners.
    fn inner_part(
        &self,
        bodies: &Bodies,
        piece: &Piece,
        line: u32,
        sides: &[Ordering],
    ) -> Result<Piece, LimitExceeded> {
        let count = piece.corners.len();
        let (mut corners, mut edges) =
            (Vec::with_capacity(count + 1), Vec::with_capacity(count + 1));
        for k in 0..count {
            let (own, next, edge) = (sides[k], sides[(k + 1) % count], piece.edges[k]);
            if own != Less {
                corners.push(piece.corners[k]);
                edges.push(if own == Equal && next == Less { line } else { edge });
            }
            // An arc has one edge, traversed in both directions.
            let crosses = own != Equal && next == own.reverse() && (count != 2 || k == 0);
            if crosses {
                corners.push(self.intersection(bodies, edge, line)?);
                edges.push(if own == Greater { line } else { edge });
            }
        }
        if count == 2 {
            edges.fill(piece.edges[0]);
        }
        Ok(Piece { corners, edges })
    }

    /// Returns the intersection of two lines within the cell.
    fn intersection(&self, bodies: &Bodies, a: u32, b: u32) -> Result<PieceCorner, LimitExceeded> {
        let (p, q) = (&self.lines[a as usize], &self.lines[b as usize]);
        if let Some(ends) = p.shared_vertices(q) {
            return self.intersection_of_sharing_lines(bodies, [a, b], ends);
        }
        let vector = p.form.cross(q.form);
        let (m, n) = (p.form.abs().max_element(), q.form.abs().max_element());
        let error =
            2.02 * (p.error * n + q.error * m + p.error * q.error) + 4.0 * f64::EPSILON * m * n;
        let side = self.cell.side;
        let [k, i, j] = side.axes();
        let main = vector[k] * side.sign();
        // A place is at most 1 from the center of the side.
        let off = 2.02 * error / (main.abs() - error) + 4.0 * f64::EPSILON;
        if main.abs() > error && off <= MAX_PLACE_ERROR {
            let (at, place) = (
                CornerDirection::Crossing { against: main < 0.0 },
                [vector[i] / main, vector[j] / main],
            );
            return Ok(PieceCorner { at, lines: [a, b], place, error: off });
        }
        let small = self.exact_intersection::<SMALL_LIMBS>(bodies, [a, b], side);
        small
            .or_else(|| self.exact_intersection::<LARGE_LIMBS>(bodies, [a, b], side))
            .ok_or(LimitExceeded)
    }

    /// Returns the intersection of two lines that share two vertices: the difference of these, with the sign
    /// that lies within the cell.
    fn intersection_of_sharing_lines(
        &self,
        bodies: &Bodies,
        lines: [u32; 2],
        [a, b]: [PlaneVertex; 2],
    ) -> Result<PieceCorner, LimitExceeded> {
        let side = self.cell.side;
        let [k, i, j] = side.axes();
        let (vector, doubt) = bodies.displacement([a, b]);
        let main = vector[k] * side.sign();
        let off = 2.02 * doubt / (main.abs() - doubt) + 4.0 * f64::EPSILON;
        if main.abs() > doubt && off <= MAX_PLACE_ERROR {
            let ends = if main > 0.0 { [a, b] } else { [b, a] };
            return Ok(PieceCorner {
                at: CornerDirection::Toward(ends),
                lines,
                place: [vector[i] / main, vector[j] / main],
                error: off,
            });
        }
        let small = || place_on_side(&bodies.exact_displacement::<SMALL_LIMBS>([a, b]), side);
        let large = || place_on_side(&bodies.exact_displacement::<LARGE_LIMBS>([a, b]), side);
        let (ends, place) = small().or_else(large).ok_or(LimitExceeded)?;
        let ends = if ends { [b, a] } else { [a, b] };
        Ok(PieceCorner {
            at: CornerDirection::Toward(ends),
            lines,
            place,
            error: 8.0 * f64::EPSILON,
        })
    }

    fn exact_intersection<const N: usize>(
        &self,
        bodies: &Bodies,
        lines: [u32; 2],
        side: CubeSide,
    ) -> Option<PieceCorner> {
        let [p, q] = lines.map(|k| self.lines[k as usize].exact_form::<N>(bodies));
        let (against, place) = place_on_side(&exact_cross(&p, &q), side)?;
        let at = CornerDirection::Crossing { against };
        Some(PieceCorner { at, lines, place, error: 8.0 * f64::EPSILON })
    }
}

/// Computes the place where the line along a direction intersects a side of the cube, and whether the
/// direction points away from this side. Returns `None` if a number is too large, or the direction is
/// parallel to the side.
fn place_on_side<const N: usize>(
    vector: &[Integer<N>; 3],
    side: CubeSide,
) -> Option<(bool, [f64; 2])> {
    let [k, i, j] = side.axes();
    let main: Integer<N> =
        if side.sign() > 0.0 { vector[k] } else { Integer::ZERO.subtract(&vector[k]) };
    let against = match main.sign()? {
        Less => true,
        Greater => false,
        Equal => return None,
    };
    Some((against, [vector[i].ratio(&main)?, vector[j].ratio(&main)?]))
}
