//! What cones leave of a cell: convex pieces with exact corners.
//!
//! A corner is one of the cell, or where two lines cross; on which side of a third one it is, is the sign of a
//! determinant of three forms. Cones are open, so pieces are closed, and what is left between two cones may be an arc
//! or a point: pieces of two corners or one.

use std::cmp::Ordering;
use std::cmp::Ordering::{Equal, Greater, Less};

use glam::DVec3;

use super::bodies::Bodies;
use super::cell::{Cell, Side, solid_angle};
use super::cone::Cone;
use super::line::{Line, PlaneVertex, Ray, orientation, wide_cross};
use super::window::Window;
use colltrans_kernel::integer::{Integer, LARGE, SMALL};

/// Places known less well are computed in whole numbers.
const ROUGH: f64 = 1e-14;

/// A number is too large, or the pieces are too many.
pub(super) struct TooMuch;

/// A corner of a piece.
#[derive(Debug, Clone, Copy)]
struct Corner {
    at: At,
    /// Two lines that cross there.
    lines: [u32; 2],
    place: [f64; 2],
    /// Each of the two is off by at most this.
    error: f64,
}

/// Which direction it is, exactly.
#[derive(Debug, Clone, Copy)]
enum At {
    OfCell(DVec3),
    /// Along the vector product of the forms of its lines, or against it.
    Crossing {
        against: bool,
    },
    /// Where lines cross that share two vertices: from the first to the second.
    Toward([PlaneVertex; 2]),
}

/// A convex part of a cell.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    corners: Vec<Corner>,
    /// The lines from each corner to the next.
    edges: Vec<u32>,
}

impl Piece {
    pub(super) fn places(&self) -> Vec<[f64; 2]> {
        self.corners.iter().map(|corner| corner.place).collect()
    }

    /// Whether it has an area: of an arc there are two corners, of a point one.
    pub(super) fn is_region(&self) -> bool {
        self.corners.len() >= 3
    }

    pub(super) fn area(&self) -> f64 {
        if self.is_region() { solid_angle(&self.places()) } else { 0.0 }
    }

    /// By how much the area may be off.
    pub(super) fn area_error(&self) -> f64 {
        let places = self.places();
        let [mut around, mut error] = [0.0_f64; 2];
        for (k, [u, v]) in places.iter().enumerate() {
            let [s, t] = places[(k + 1) % places.len()];
            around += (u - s).abs() + (v - t).abs();
            error = error.max(self.corners[k].error);
        }
        // A border that is moved by so much, and the roundings of a sum of angles.
        if self.is_region() { (2.0 * error + 32.0 * f64::EPSILON) * around } else { 0.0 }
    }

    /// Somewhere inside.
    pub(super) fn center(&self) -> [f64; 2] {
        let count = self.corners.len() as f64;
        let mean = |axis: usize| self.corners.iter().map(|c| c.place[axis]).sum::<f64>() / count;
        [mean(0), mean(1)]
    }
}

/// A piece with what it takes to ask about it exactly.
pub(super) struct Outline {
    pub(super) corners: Vec<Turn>,
    /// The lines from each corner to the next; of an arc the same one twice.
    pub(super) edges: Vec<Line>,
}

/// A corner of an outline.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    pub(super) ray: Ray,
    /// Two lines that cross there.
    pub(super) lines: [Line; 2],
    /// Rounded, with a largest component of 1 (or -1).
    pub(super) direction: DVec3,
}

/// A cell without some cones.
#[derive(Debug)]
pub(super) struct Rest {
    cell: Cell,
    lines: Vec<Line>,
    pub(super) pieces: Vec<Piece>,
}

impl Rest {
    /// All of a cell.
    pub(super) fn whole(cell: Cell) -> Self {
        let [_, i, j] = cell.side.axes();
        let across = DVec3::AXES[cell.side.axes()[0]] * cell.side.sign();
        let [u, v] = [cell.range(0), cell.range(1)];
        // From corner to corner: the lower v, the upper u, the upper v, the lower u.
        let bounds = [(j, v[0]), (i, u[1]), (j, v[1]), (i, u[0])];
        let lines =
            bounds.map(|(axis, at)| Line::exactly(DVec3::AXES[axis] - across * at)).to_vec();
        let places = cell.places();
        let corner = |k: usize| Corner {
            at: At::OfCell(cell.side.direction(places[k])),
            lines: [(k as u32 + 3) % 4, k as u32],
            place: places[k],
            error: 0.0,
        };
        let corners = [0, 1, 2, 3].map(corner).to_vec();
        Self { cell, lines, pieces: vec![Piece { corners, edges: vec![0, 1, 2, 3] }] }
    }

    /// With one of its pieces alone.
    pub(super) fn only(&self, piece: &Piece) -> Self {
        Self { cell: self.cell, lines: self.lines.clone(), pieces: vec![piece.clone()] }
    }

    /// The rectangle around a piece.
    pub(super) fn window(&self, piece: &Piece) -> Window {
        let around = |axis: usize| {
            let ends =
                piece.corners.iter().map(|c| (c.place[axis] - c.error, c.place[axis] + c.error));
            let (low, high) =
                ends.fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
            let [least, most] = self.cell.range(axis);
            [low.max(least), high.min(most)]
        };
        Window::new(self.cell.side, around(0), around(1))
    }

    /// A piece by itself.
    pub(super) fn outline(&self, piece: &Piece) -> Outline {
        let form = |k: u32| self.lines[k as usize];
        let turn = |corner: &Corner| Turn {
            ray: match corner.at {
                At::OfCell(d) => Ray::Exactly(d),
                At::Toward(ends) => Ray::Toward(ends),
                At::Crossing { against } => {
                    let [a, b] = corner.lines.map(form);
                    Ray::Crossing(if against { [b, a] } else { [a, b] })
                }
            },
            lines: corner.lines.map(form),
            direction: self.cell.side.direction(corner.place) + 0.0,
        };
        Outline {
            corners: piece.corners.iter().map(turn).collect(),
            edges: piece.edges.iter().map(|&k| form(k)).collect(),
        }
    }

    /// Takes a cone away; whether there was something to take.
    pub(super) fn cut(
        &mut self,
        bodies: &Bodies,
        cone: &Cone,
        most: usize,
    ) -> Result<bool, TooMuch> {
        let mut changed = false;
        let mut numbers = Vec::new();
        for at in (0..self.pieces.len()).rev() {
            if self.misses(bodies, at, cone)? {
                continue;
            }
            if !changed {
                numbers = (0..cone.lines.len()).map(|k| (self.lines.len() + k) as u32).collect();
                self.lines.extend_from_slice(&cone.lines);
                changed = true;
            }
            let piece = self.pieces.swap_remove(at);
            self.subtract(bodies, piece, &numbers)?;
        }
        if self.pieces.len() > most { Err(TooMuch) } else { Ok(changed) }
    }

    /// Whether a cone has no direction of a piece, as one of its sides has all of it behind, or as nothing is left
    /// of the piece on the inner sides of all.
    fn misses(&mut self, bodies: &Bodies, at: usize, cone: &Cone) -> Result<bool, TooMuch> {
        let first = self.lines.len();
        self.lines.extend_from_slice(&cone.lines);
        let missed = self.is_outside(bodies, &self.pieces[at], first);
        self.lines.truncate(first);
        missed
    }

    fn is_outside(&self, bodies: &Bodies, piece: &Piece, first: usize) -> Result<bool, TooMuch> {
        let lines = first as u32..self.lines.len() as u32;
        let mut mixed = Vec::new();
        for line in lines.clone() {
            let sides = self.sides(bodies, piece, line)?;
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
            let sides = self.sides(bodies, &inner, line)?;
            if !sides.contains(&Greater) {
                return Ok(true);
            }
            inner = self.part(bodies, &inner, line, &sides)?;
        }
        for line in lines {
            if !self.sides(bodies, &inner, line)?.contains(&Greater) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// A piece without a cone, by the numbers of its lines: of what is inside the lines before, what is not inside the
    /// next one. A face on a line that is in the part behind an earlier line is no piece of its own.
    fn subtract(&mut self, bodies: &Bodies, piece: Piece, lines: &[u32]) -> Result<(), TooMuch> {
        let mut inner = piece;
        for (k, &line) in lines.iter().enumerate() {
            let sides = self.sides(bodies, &inner, line)?;
            if !sides.contains(&Greater) {
                self.pieces.push(inner);
                return Ok(());
            }
            if sides.iter().all(|side| *side == Greater) {
                continue;
            }
            let turned: Vec<Ordering> = sides.iter().map(|side| side.reverse()).collect();
            let outer = self.part(bodies, &inner, line, &turned)?;
            if outer.is_region() || !self.is_on_one_of(bodies, &outer, &lines[..k])? {
                self.pieces.push(outer);
            }
            if sides.contains(&Less) {
                inner = self.part(bodies, &inner, line, &sides)?;
            }
        }
        Ok(())
    }

    /// Whether one of the lines has all of a piece on it.
    fn is_on_one_of(&self, bodies: &Bodies, piece: &Piece, lines: &[u32]) -> Result<bool, TooMuch> {
        for &line in lines {
            if self.sides(bodies, piece, line)?.iter().all(|side| *side == Equal) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// On which side of a line the corners of a piece are.
    fn sides(&self, bodies: &Bodies, piece: &Piece, line: u32) -> Result<Vec<Ordering>, TooMuch> {
        piece.corners.iter().map(|corner| self.side(bodies, corner, line)).collect()
    }

    fn side(&self, bodies: &Bodies, corner: &Corner, line: u32) -> Result<Ordering, TooMuch> {
        let form = |k: u32| &self.lines[k as usize];
        match corner.at {
            At::OfCell(d) => Ok(form(line).side(bodies, d)),
            At::Toward(ends) => Ok(form(line).side_of(bodies, ends)),
            At::Crossing { .. } if corner.lines.contains(&line) => Ok(Equal),
            At::Crossing { against } => {
                let [a, b] = corner.lines;
                let side = orientation(bodies, [form(a), form(b), form(line)]).ok_or(TooMuch)?;
                Ok(if against { side.reverse() } else { side })
            }
        }
    }

    /// The part of a piece on the inner side of a line, or on it, from the sides of its corners.
    fn part(
        &self,
        bodies: &Bodies,
        piece: &Piece,
        line: u32,
        sides: &[Ordering],
    ) -> Result<Piece, TooMuch> {
        let count = piece.corners.len();
        let (mut corners, mut edges) =
            (Vec::with_capacity(count + 1), Vec::with_capacity(count + 1));
        for k in 0..count {
            let (own, next, edge) = (sides[k], sides[(k + 1) % count], piece.edges[k]);
            if own != Less {
                corners.push(piece.corners[k]);
                edges.push(if own == Equal && next == Less { line } else { edge });
            }
            // An arc has one edge, there and back.
            let crosses = own != Equal && next == own.reverse() && (count != 2 || k == 0);
            if crosses {
                corners.push(self.crossing(bodies, edge, line)?);
                edges.push(if own == Greater { line } else { edge });
            }
        }
        if count == 2 {
            edges.fill(piece.edges[0]);
        }
        Ok(Piece { corners, edges })
    }

    /// Where two lines cross within the cell.
    fn crossing(&self, bodies: &Bodies, a: u32, b: u32) -> Result<Corner, TooMuch> {
        let (p, q) = (&self.lines[a as usize], &self.lines[b as usize]);
        if let Some(ends) = p.shared(q) {
            return self.toward(bodies, [a, b], ends);
        }
        let way = p.form.cross(q.form);
        let (m, n) = (p.form.abs().max_element(), q.form.abs().max_element());
        let error =
            2.02 * (p.error * n + q.error * m + p.error * q.error) + 4.0 * f64::EPSILON * m * n;
        let side = self.cell.side;
        let [k, i, j] = side.axes();
        let main = way[k] * side.sign();
        // A place is at most 1 from the middle of the side.
        let off = 2.02 * error / (main.abs() - error) + 4.0 * f64::EPSILON;
        if main.abs() > error && off <= ROUGH {
            let (at, place) =
                (At::Crossing { against: main < 0.0 }, [way[i] / main, way[j] / main]);
            return Ok(Corner { at, lines: [a, b], place, error: off });
        }
        let small = self.crossing_exactly::<SMALL>(bodies, [a, b], side);
        small.or_else(|| self.crossing_exactly::<LARGE>(bodies, [a, b], side)).ok_or(TooMuch)
    }

    /// Along the difference of two vertices, one way or the other, within the cell.
    fn toward(
        &self,
        bodies: &Bodies,
        lines: [u32; 2],
        [a, b]: [PlaneVertex; 2],
    ) -> Result<Corner, TooMuch> {
        let side = self.cell.side;
        let [k, i, j] = side.axes();
        let (way, doubt) = bodies.way([a, b]);
        let main = way[k] * side.sign();
        let off = 2.02 * doubt / (main.abs() - doubt) + 4.0 * f64::EPSILON;
        if main.abs() > doubt && off <= ROUGH {
            let ends = if main > 0.0 { [a, b] } else { [b, a] };
            return Ok(Corner {
                at: At::Toward(ends),
                lines,
                place: [way[i] / main, way[j] / main],
                error: off,
            });
        }
        let small = || placed(&bodies.wide_way::<SMALL>([a, b]), side);
        let large = || placed(&bodies.wide_way::<LARGE>([a, b]), side);
        let (ends, place) = small().or_else(large).ok_or(TooMuch)?;
        let ends = if ends { [b, a] } else { [a, b] };
        Ok(Corner { at: At::Toward(ends), lines, place, error: 8.0 * f64::EPSILON })
    }

    fn crossing_exactly<const N: usize>(
        &self,
        bodies: &Bodies,
        lines: [u32; 2],
        side: Side,
    ) -> Option<Corner> {
        let [p, q] = lines.map(|k| self.lines[k as usize].wide::<N>(bodies));
        let (against, place) = placed(&wide_cross(&p, &q), side)?;
        let at = At::Crossing { against };
        Some(Corner { at, lines, place, error: 8.0 * f64::EPSILON })
    }
}

/// Whether a direction goes away from a side, and its place there or that of its opposite; `None` if numbers are too
/// large, or the direction is along the side.
fn placed<const N: usize>(way: &[Integer<N>; 3], side: Side) -> Option<(bool, [f64; 2])> {
    let [k, i, j] = side.axes();
    let main: Integer<N> = if side.sign() > 0.0 { way[k] } else { Integer::ZERO.subtract(&way[k]) };
    let against = match main.sign()? {
        Less => true,
        Greater => false,
        Equal => return None,
    };
    Some((against, [way[i].ratio(&main)?, way[j].ratio(&main)?]))
}
