//! Support points: the vertex of a body farthest along a direction, in `O(log n)`.
//!
//! Two steps. A *table* over directions gives a vertex that is right for a direction nearby; from there a *climb*
//! along edges, always to the steepest neighbour, ends at the support point, because on a convex body a local
//! maximum is global. Solvers that already know a vertex nearby climb from it and leave the table out.
//!
//! The table is a cube map of *normalised* directions `L^T n`, where `L L^T` is the shape of the body's inertia
//! ellipsoid: a support point of an affine image `L u` of a round body in direction `n` is that of the round body in
//! direction `L^T n`, so needles and plates spread over the table as evenly as balls. Where vertices still
//! crowd (the rim of a prism with many sides, a rounded corner), a cell is divided in four, and again, until its
//! centre and its corners are a few edges apart. The number of cells is at most proportional to the number of vertices.

use glam::{DMat3, DVec3};

use super::measure::Measure;
use super::topology::Topology;

/// Up to this many vertices, looking at each is fastest (measured).
const SCAN_LIMIT: usize = 20;

/// An entry of the table is a vertex, or, with this bit, the first of four finer cells.
const DIVIDED: u32 = 1 << 31;

/// A cell whose corners are farther than this many climbing steps from its centre is divided.
const NEAR_STEPS: usize = 3;

/// Divisions of one cell of the cube map: `2^-20` of its side is below any spread that single-precision models have.
const MAX_DEPTH: u32 = 20;

/// Relative rounding error of a dot product of a direction with an edge: a gain below this share of the terms'
/// magnitudes may not be real. Demanding more makes every climb strictly ascending, so it ends.
const GAIN_NOISE: f64 = 4.0 * f64::EPSILON;

/// The table over directions.
#[derive(Debug, Clone)]
pub(crate) struct SupportIndex {
    /// `L^T`.
    normalise: DMat3,
    /// Cells along an edge of the cube; 0 if the body is small enough to scan.
    resolution: u32,
    /// Entries of the base cells, then groups of four.
    cells: Vec<u32>,
}

impl SupportIndex {
    pub(crate) fn build(vertices: &[DVec3], topology: &Topology, measure: &Measure) -> Self {
        let mut index =
            Self { normalise: measure.cholesky().transpose(), resolution: 0, cells: Vec::new() };
        if vertices.len() > SCAN_LIMIT {
            index.resolution = ((vertices.len() as f64 / 18.0).sqrt() as u32).max(2);
            index.fill(vertices, topology);
        }
        index
    }

    /// The vertex farthest along `direction` (body frame, any length).
    pub(crate) fn extreme(&self, vertices: &[DVec3], topology: &Topology, direction: DVec3) -> u32 {
        if self.resolution == 0 {
            return scan(vertices, direction);
        }
        climb(vertices, topology, direction, self.look_up(direction)).0
    }

    /// The same, starting from a vertex believed to be near.
    pub(crate) fn extreme_from(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        start: u32,
    ) -> u32 {
        if self.resolution == 0 {
            return scan(vertices, direction);
        }
        climb(vertices, topology, direction, start).0
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.cells.capacity() * size_of::<u32>()
    }

    /// The entry of the cell that a direction falls into.
    fn look_up(&self, direction: DVec3) -> u32 {
        let w = self.normalise * direction;
        let (face, along, s, t) = cube_face(w);
        let scale = 0.5 * f64::from(self.resolution) / along;
        let half = 0.5 * f64::from(self.resolution);
        // Casts saturate, so that a NaN from a zero direction is cell 0.
        let (mut fs, mut ft) = (s * scale + half, t * scale + half);
        let last = self.resolution - 1;
        let (i, j) = ((fs as u32).min(last), (ft as u32).min(last));
        let mut entry = self.cells[((face * self.resolution + j) * self.resolution + i) as usize];
        if entry & DIVIDED == 0 {
            return entry;
        }
        fs -= f64::from(i);
        ft -= f64::from(j);
        while entry & DIVIDED != 0 {
            fs *= 2.0;
            ft *= 2.0;
            let (i, j) = (u32::from(fs >= 1.0), u32::from(ft >= 1.0));
            fs -= f64::from(i);
            ft -= f64::from(j);
            entry = self.cells[((entry & !DIVIDED) + 2 * j + i) as usize];
        }
        entry
    }

    fn fill(&mut self, vertices: &[DVec3], topology: &Topology) {
        let r = self.resolution;
        let base = 6 * r * r;
        self.cells = vec![0; base as usize];
        let builder = Builder {
            vertices,
            topology,
            // Directions of the table to directions of the body: the inverse of `normalise`.
            to_body: self.normalise.inverse(),
            limit: base as usize + vertices.len(),
        };
        let mut near = 0;
        for face in 0..6 {
            for j in 0..r {
                for i in 0..r {
                    let cell = Cell { face, side: 2.0 / f64::from(r), i, j, depth: 0 };
                    near = builder.support(cell.direction(0.5, 0.5), near).0;
                    let entry = builder.entry(cell, near, &mut self.cells);
                    self.cells[((face * r + j) * r + i) as usize] = entry;
                }
            }
        }
        self.cells.shrink_to_fit();
    }
}

/// A square on a face of the cube `[-1, 1]^3`.
#[derive(Clone, Copy)]
struct Cell {
    face: u32,
    side: f64,
    i: u32,
    j: u32,
    depth: u32,
}

impl Cell {
    /// The normalised direction at relative position `(s, t)` in the cell.
    fn direction(&self, s: f64, t: f64) -> DVec3 {
        let s = (f64::from(self.i) + s) * self.side - 1.0;
        let t = (f64::from(self.j) + t) * self.side - 1.0;
        let along = if self.face & 1 == 0 { 1.0 } else { -1.0 };
        match self.face >> 1 {
            0 => DVec3::new(along, s, t),
            1 => DVec3::new(t, along, s),
            _ => DVec3::new(s, t, along),
        }
    }

    fn quarter(&self, i: u32, j: u32) -> Self {
        Self {
            side: self.side * 0.5,
            i: 2 * self.i + i,
            j: 2 * self.j + j,
            depth: self.depth + 1,
            ..*self
        }
    }
}

/// Face of the cube, distance to it, and the two coordinates on it.
fn cube_face(w: DVec3) -> (u32, f64, f64, f64) {
    let a = w.abs();
    if a.x >= a.y && a.x >= a.z {
        (u32::from(w.x < 0.0), a.x, w.y, w.z)
    } else if a.y >= a.z {
        (2 + u32::from(w.y < 0.0), a.y, w.z, w.x)
    } else {
        (4 + u32::from(w.z < 0.0), a.z, w.x, w.y)
    }
}

struct Builder<'a> {
    vertices: &'a [DVec3],
    topology: &'a Topology,
    to_body: DMat3,
    /// Most entries the table may have.
    limit: usize,
}

impl Builder<'_> {
    fn support(&self, normalised: DVec3, start: u32) -> (u32, usize) {
        climb(self.vertices, self.topology, self.to_body * normalised, start)
    }

    /// The entry of a cell whose centre has the support point `center`: divided while its corners are far.
    fn entry(&self, cell: Cell, center: u32, cells: &mut Vec<u32>) -> u32 {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
        let is_near = |(s, t)| self.support(cell.direction(s, t), center).1 <= NEAR_STEPS;
        let full = cells.len() + 4 > self.limit;
        if cell.depth == MAX_DEPTH || full || corners.into_iter().all(is_near) {
            return center;
        }
        let first = cells.len();
        cells.extend([center; 4]);
        for (k, (i, j)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let quarter = cell.quarter(i, j);
            let near = self.support(quarter.direction(0.5, 0.5), center).0;
            cells[first + k] = self.entry(quarter, near, cells);
        }
        first as u32 | DIVIDED
    }
}

/// Looks at every vertex.
fn scan(vertices: &[DVec3], direction: DVec3) -> u32 {
    let mut best = 0;
    let mut reach = f64::NEG_INFINITY;
    for (v, vertex) in vertices.iter().enumerate() {
        let along = direction.dot(*vertex);
        if along > reach {
            (best, reach) = (v, along);
        }
    }
    best as u32
}

/// Steepest ascent along edges, and the number of steps it took.
///
/// Gains are taken from edge vectors, not from differences of dot products, so their rounding error is relative to
/// the edge and not to the body.
fn climb(vertices: &[DVec3], topology: &Topology, direction: DVec3, start: u32) -> (u32, usize) {
    let mut at = start;
    let mut steps = 0;
    loop {
        let here = vertices[at as usize];
        let (mut best, mut gain) = (at, 0.0);
        for &w in topology.neighbours(at) {
            let along = direction.dot(vertices[w as usize] - here);
            if along > gain {
                (best, gain) = (w, along);
            }
        }
        let edge = vertices[best as usize] - here;
        if gain <= GAIN_NOISE * direction.abs().dot(edge.abs()) {
            return (at, steps);
        }
        at = best;
        steps += 1;
    }
}
