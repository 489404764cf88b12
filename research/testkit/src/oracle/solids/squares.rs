//! Bodies of cubes and squares of a grid, whose crossings follow without facets.
//!
//! As in [`cells`](super::cells), the grids of both bodies are mapped by one linear map, and all numbers are
//! exact. A cube or a square without its boundary is a product of open unit intervals and points. Two such
//! products, one of which moves, meet for the `t` of an open interval, or, if points must coincide, at one `t`
//! or always.
//!
//! - A square enters a body of cubes if it meets a cube, or the square between two cubes.
//! - Two squares cross if they meet. Squares in parallel planes cross where they coincide, and squares that
//!   move in one plane cross at every common point.
//! - An edge that joins two squares is crossed by a square that moves along its own plane, or by an edge of the
//!   other body, if the joined squares are on different sides of it.

use std::collections::BTreeMap;

use colltrans::Solid;
use colltrans::solid::SolidError;
use glam::{DMat3, DVec3};

use super::cells::{Cells, InGrid, cut};
use crate::oracle::exact::{Dyadic, Ratio, Vector};
use crate::random::Random;

/// A product of open unit intervals and points of the grid, given by its lower corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Piece {
    at: [i32; 3],
    /// For each axis 1 for an interval, 0 for a point.
    open: [i32; 3],
}

impl Piece {
    fn square(at: [i32; 3], axis: usize) -> Self {
        let mut open = [1; 3];
        open[axis] = 0;
        Self { at, open }
    }

    /// Returns the axis perpendicular to a square.
    fn axis(&self) -> usize {
        (0..3).find(|&k| self.open[k] == 0).unwrap_or(0)
    }
}

/// Squares with ordered corners. Each edge belongs to at most two squares.
#[derive(Debug, Clone, Default)]
pub struct Squares(Vec<[[i32; 3]; 4]>);

impl Squares {
    /// Draws a connected surface of at most `count` squares, near the origin.
    pub fn random(count: usize, rng: &mut Random) -> Self {
        let axis = rng.int(0, 2) as usize;
        let mut squares = Self(vec![square_corners([0; 3], axis)]);
        for _ in 0..4 * count {
            if squares.0.len() >= count {
                break;
            }
            // Adds a square at a side of a square, in the same plane or perpendicular to it.
            let from = squares.0[rng.int(0, squares.0.len() as i64 - 1) as usize];
            let k = rng.int(0, 3) as usize;
            let side = [from[k], from[(k + 1) % 4]];
            let along = (0..3).find(|&a| side[0][a] != side[1][a]).unwrap_or(0);
            let across = (along + rng.int(1, 2) as usize) % 3;
            let mut at = [0, 1, 2].map(|a| side[0][a].min(side[1][a]));
            at[across] -= i32::from(rng.one_in(2));
            let mut new = square_corners(at, 3 - along - across);
            let runs = |q: &[[i32; 3]; 4]| (0..4).any(|j| [q[j], q[(j + 1) % 4]] == side);
            if runs(&new) {
                new.reverse();
            }
            if new.iter().flatten().all(|c| c.abs() <= 3) && squares.admits(&new) {
                squares.0.push(new);
            }
        }
        if squares.is_closed() {
            squares.0.pop();
        }
        squares
    }

    /// Checks whether every edge joins two squares.
    fn is_closed(&self) -> bool {
        let mut edges: BTreeMap<[[i32; 3]; 2], i32> = BTreeMap::new();
        for q in &self.0 {
            for k in 0..4 {
                let [a, b] = [q[k], q[(k + 1) % 4]];
                *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        edges.values().all(|&count| count == 2)
    }

    /// Checks whether a square can be added: each of its edges belongs to at most one other square, in the
    /// opposite direction.
    fn admits(&self, new: &[[i32; 3]; 4]) -> bool {
        let edges = |q: &[[i32; 3]; 4]| [0, 1, 2, 3].map(|k| [q[k], q[(k + 1) % 4]]);
        let same = |q: &[[i32; 3]; 4]| piece_from_corners(q) == piece_from_corners(new);
        let old: Vec<_> = self.0.iter().flat_map(edges).collect();
        !self.0.iter().any(same)
            && edges(new).iter().all(|&[p, q]| {
                let back = old.iter().filter(|e| **e == [q, p]).count();
                let along = old.iter().filter(|e| **e == [p, q]).count();
                along == 0 && back <= 1
            })
    }

    /// Returns the edges that join two coplanar squares, each with the axis along which the squares are on its
    /// two sides.
    fn straight_edges(&self) -> Vec<(Piece, usize)> {
        let mut around: BTreeMap<Piece, Vec<Piece>> = BTreeMap::new();
        for q in &self.0 {
            for k in 0..4 {
                let [a, b] = [q[k], q[(k + 1) % 4]];
                let at = [0, 1, 2].map(|i| a[i].min(b[i]));
                let open = [0, 1, 2].map(|i| i32::from(a[i] != b[i]));
                around.entry(Piece { at, open }).or_default().push(piece_from_corners(q));
            }
        }
        let straight = |(edge, squares): (Piece, Vec<Piece>)| {
            let [a, b] = squares[..] else { return None };
            let run = (0..3).find(|&k| edge.open[k] == 1)?;
            (a.axis() == b.axis()).then_some((edge, 3 - run - a.axis()))
        };
        around.into_iter().filter_map(straight).collect()
    }

    fn surface(&self, map: DMat3, rng: &mut Random) -> (Vec<DVec3>, Vec<Vec<u32>>) {
        let (mut vertices, mut facets) = (Vec::new(), Vec::new());
        let mut index: BTreeMap<[i32; 3], u32> = BTreeMap::new();
        for square in &self.0 {
            let corners = square.map(|corner| {
                *index.entry(corner).or_insert_with(|| {
                    vertices.push(map * DVec3::from_array(corner.map(f64::from)));
                    vertices.len() as u32 - 1
                })
            });
            cut(&mut vertices, &mut facets, corners, rng);
        }
        (vertices, facets)
    }
}

fn piece_from_corners(corners: &[[i32; 3]; 4]) -> Piece {
    let at = [0, 1, 2].map(|k| corners.iter().map(|c| c[k]).min().unwrap_or(0));
    let high = [0, 1, 2].map(|k| corners.iter().map(|c| c[k]).max().unwrap_or(0));
    Piece { at, open: [0, 1, 2].map(|k| high[k] - at[k]) }
}

/// Returns the corners of a square perpendicular to an axis.
fn square_corners(at: [i32; 3], axis: usize) -> [[i32; 3]; 4] {
    [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(a, b)| {
        let mut corner = at;
        corner[(axis + 1) % 3] += a;
        corner[(axis + 2) % 3] += b;
        corner
    })
}

/// A body of cubes, squares or both.
#[derive(Debug, Clone)]
pub struct Mixed {
    /// The closed part.
    pub cubes: Option<Cells>,
    /// The open part.
    pub squares: Squares,
}

impl Mixed {
    /// Builds the solid of the body, with its grid under a linear map.
    ///
    /// # Errors
    /// [`SolidError`] if the library rejects the surface.
    pub fn solid(&self, map: DMat3, rng: &mut Random) -> Result<Solid, SolidError> {
        let mut pieces = Vec::new();
        if let Some(cubes) = &self.cubes {
            let (vertices, facets) = cubes.surface(map, rng);
            pieces.push(Solid::from_mesh(&vertices, &facets)?);
        }
        if !self.squares.0.is_empty() {
            let (vertices, facets) = self.squares.surface(map, rng);
            pieces.push(Solid::from_open_mesh(&vertices, &facets)?);
        }
        match &pieces[..] {
            [alone] => Ok(alone.clone()),
            both => Solid::from_pieces(both),
        }
    }

    /// Returns the cubes and the squares between them.
    fn inside(&self) -> Vec<Piece> {
        let Some(Cells(cells)) = &self.cubes else { return Vec::new() };
        let mut pieces: Vec<Piece> = cells.iter().map(|&at| Piece { at, open: [1; 3] }).collect();
        for cell in cells {
            for axis in 0..3 {
                let mut next = *cell;
                next[axis] += 1;
                if cells.contains(&next) {
                    pieces.push(Piece::square(next, axis));
                }
            }
        }
        pieces
    }

    fn sheets(&self) -> Vec<Piece> {
        self.squares.0.iter().map(piece_from_corners).collect()
    }
}

/// The `t` at which two pieces meet.
enum Times {
    Between(Ratio, Ratio),
    At(Ratio),
}

/// The exact result of a motion, from the times at which pieces of two bodies meet.
#[derive(Debug, Clone, Default)]
pub struct SquareCrossing {
    /// Whether pieces cross at the start.
    pub overlaps: bool,
    /// The smallest `t >= 0` from which on pieces cross; `None` if there is none.
    pub stop: Option<Ratio>,
    /// The largest `t` up to which pieces cross; `None` if there is none.
    pub last: Option<Ratio>,
}

impl SquareCrossing {
    /// Computes the exact result of a motion of `moving` along `direction`, with `fixed` displaced by `offset`.
    /// Both are in the world, and the grids are mapped by `rotation shear`.
    pub fn new(
        [moving, fixed]: [&Mixed; 2],
        maps: [DMat3; 2],
        offset: &Vector,
        direction: DVec3,
    ) -> Self {
        let grid = InGrid::new(maps, offset, direction);
        let mut found = Self::default();
        let (inside, sheets) =
            ([moving.inside(), fixed.inside()], [moving.sheets(), fixed.sheets()]);
        for p in &inside[0] {
            for q in inside[1].iter().filter(|q| p.open == [1; 3] && q.open == [1; 3]) {
                found.through(&grid, p, q);
            }
        }
        // Squares of one body with the interior of the other. Squares between cubes matter only in their own
        // plane.
        let enters =
            |square: &Piece, inner: &Piece| inner.open == [1; 3] || inner.axis() == square.axis();
        for p in &sheets[0] {
            for q in inside[1].iter().filter(|q| enters(p, q)) {
                found.through(&grid, p, q);
            }
        }
        for q in &sheets[1] {
            for p in inside[0].iter().filter(|p| enters(q, p)) {
                found.through(&grid, p, q);
            }
        }
        for p in &sheets[0] {
            for q in &sheets[1] {
                if p.axis() == q.axis() {
                    found.upon(&grid, p, q);
                } else {
                    found.through(&grid, p, q);
                }
            }
        }
        let straight = [moving.squares.straight_edges(), fixed.squares.straight_edges()];
        for (edge, across) in &straight[0] {
            for q in sheets[1].iter().filter(|q| q.axis() == *across) {
                found.through(&grid, edge, q);
            }
            let other = straight[1].iter().filter(|(e, a)| e.open == edge.open && a != across);
            for (e, _) in other {
                found.through(&grid, edge, e);
            }
        }
        for (edge, across) in &straight[1] {
            for p in sheets[0].iter().filter(|p| p.axis() == *across) {
                found.through(&grid, p, edge);
            }
        }
        found
    }

    /// Adds pieces that cross where they meet. A meeting at a single `t` counts only at the start, as an overlap. At
    /// any other `t` the pieces next to these decide.
    fn through(&mut self, grid: &InGrid, p: &Piece, q: &Piece) {
        let zero = Ratio::from_f64(0.0);
        match meeting_times(grid, p, q) {
            Some(Times::Between(first, last)) => {
                self.overlaps |= first < zero && zero < last;
                self.ahead(first, last);
            }
            Some(Times::At(t)) => self.overlaps |= t.is_zero(),
            None => (),
        }
    }

    /// Adds squares of parallel planes.
    fn upon(&mut self, grid: &InGrid, p: &Piece, q: &Piece) {
        match meeting_times(grid, p, q) {
            Some(Times::Between(first, last)) => self.ahead(first, last),
            Some(Times::At(t)) if !t.is_negative() => self.stop_at(t),
            _ => (),
        }
    }

    fn ahead(&mut self, first: Ratio, last: Ratio) {
        let zero = Ratio::from_f64(0.0);
        if zero < last {
            self.stop_at(if first < zero { zero } else { first });
        }
        if self.last.as_ref().is_none_or(|l| *l < last) {
            self.last = Some(last);
        }
    }

    fn stop_at(&mut self, t: Ratio) {
        if self.stop.as_ref().is_none_or(|s| t < *s) {
            self.stop = Some(t);
        }
    }
}

/// Returns the `t` at which two pieces meet. `None` also for pieces that meet always, because they do not move
/// along any axis in which they are open.
fn meeting_times(grid: &InGrid, p: &Piece, q: &Piece) -> Option<Times> {
    let InGrid { shift, way, unit } = grid;
    let whole = |n: i32| &Dyadic::new(f64::from(n)) * unit;
    let mut open: Option<[Ratio; 2]> = None;
    let mut at: Option<Ratio> = None;
    for k in 0..3 {
        // p + apart + t way is to be q, up to what both are open by.
        let apart = &whole(p.at[k] - q.at[k]) - &shift[k];
        let (low, high) = (&whole(-p.open[k]) - &apart, &whole(q.open[k]) - &apart);
        let is_point = p.open[k] + q.open[k] == 0;
        if way[k].is_zero() {
            let holds =
                if is_point { apart.is_zero() } else { low.is_negative() && high.is_positive() };
            if !holds {
                return None;
            }
        } else if is_point {
            let t = Ratio::new(low, way[k].clone());
            if at.as_ref().is_some_and(|at| *at != t) {
                return None;
            }
            at = Some(t);
        } else {
            let [x, y] = [low, high].map(|n| Ratio::new(n, way[k].clone()));
            let [x, y] = if x < y { [x, y] } else { [y, x] };
            open = Some(match open {
                None => [x, y],
                Some([a, b]) => [if a < x { x } else { a }, if y < b { y } else { b }],
            });
        }
    }
    if let Some([x, y]) = &open
        && x >= y
    {
        return None;
    }
    match (open, at) {
        (Some([x, y]), Some(at)) => (x < at && at < y).then_some(Times::At(at)),
        (None, Some(at)) => Some(Times::At(at)),
        (Some([x, y]), None) => Some(Times::Between(x, y)),
        (None, None) => None,
    }
}
