//! Support points: the vertex of a body farthest along a direction, in `O(log n)`.
//!
//! Two steps. A *table* over directions gives a vertex that is right for a direction nearby; from
//! there a *climb* along edges, always to the steepest neighbour, ends at the support point,
//! because on a convex body a local maximum is global. Solvers that already know a vertex nearby
//! climb from it and leave the table out.
//!
//! The table is an octahedral map of *normalised* directions `L^T n`, where `L L^T` is the shape of the
//! body's inertia ellipsoid: a support point of an affine image `L u` of a round body in direction
//! `n` is that of the round body in direction `L^T n`, so needles and plates spread over the table
//! as evenly as balls. Where vertices still crowd (the rim of a prism with many sides, a rounded
//! corner), a cell is divided in four, and again, until its centre and its corners are a few edges
//! apart. The number of cells is at most proportional to the number of vertices.
//!
//! A vertex with many neighbours (the apex of a cone) would make one step linear, and along the boundary of
//! a face with many corners (the base of a cylinder), or along what is beside it, a climb would take a step
//! for each: there the place is found by its angle ([`ring`](super::ring), [`fan`](super::fan)).

use std::hint::select_unpredictable;

use glam::{DMat3, DVec2, DVec3};

use super::fan::{FAN, Fan};
use super::ring::{Rim, Ring};
use crate::body::Inertia;
use colltrans_kernel::noise;
use colltrans_kernel::topology::Topology;
use colltrans_kernel::work;

/// Up to this many vertices, looking at each is fastest (measured).
const SCAN_LIMIT: usize = 20;

/// An entry of the table is a vertex, or, with this bit, the first of four finer cells.
const DIVIDED: u32 = 1 << 31;

/// A cell whose corners are farther than this many climbing steps from its centre is divided.
const MAX_CELL_STEPS: usize = 3;

/// After this many steps a climb from a guess asks the table (measured).
const MAX_GUESS_STEPS: usize = 2;

/// Divisions of one cell of the cube map: `2^-20` of its side is below any spread that
/// single-precision models have.
const MAX_DIVISIONS: u32 = 20;

/// Steps after which a climb looks whether it goes along a ring.
const RING_CHECK_STEPS: usize = 3;

/// Rims and points that a body may be taken to be the hull of.
pub(crate) const MOST_RIMS: usize = 8;

/// No ring.
const NO_RING: u16 = u16::MAX;

/// The table over directions.
#[derive(Debug, Clone)]
pub(crate) struct SupportIndex {
    /// `L^T`.
    normalise: DMat3,
    /// Cells along a side of the map; 0 if the body is small enough to scan.
    resolution: u32,
    /// Entries of the base cells, then groups of four.
    cells: Vec<u32>,
    /// The vertices of a body small enough to scan.
    groups: Vec<VertexGroup>,
    /// Vertices with many neighbours, ascending.
    fans: Vec<Fan>,
    /// The rings of faces with many corners, and those beside them.
    rings: Vec<Ring>,
    /// For each vertex its ring: a number in `rings`, or beyond these in `fans`. Empty without any.
    ring_of: Vec<u16>,
    /// The rims and points that the body is nearly the hull of, if these are few.
    outline: Vec<Rim>,
}

impl SupportIndex {
    pub(crate) fn build(vertices: &[DVec3], topology: &Topology, inertia: &Inertia) -> Self {
        let mut index = Self {
            normalise: inertia.factor.transpose(),
            resolution: 0,
            cells: Vec::new(),
            groups: Vec::new(),
            fans: build_fans(vertices, topology),
            rings: build_rings(vertices, topology),
            ring_of: Vec::new(),
            outline: Vec::new(),
        };
        index.ring_of = index.number_rings(topology);
        index.outline = index.compute_outline(vertices).unwrap_or_default();
        if vertices.len() <= SCAN_LIMIT {
            index.groups = vertex_groups(vertices);
        } else {
            index.resolution = ((vertices.len() as f64 / 3.0).sqrt() as u32).max(5);
            index.fill_table(vertices, topology);
        }
        index
    }

    /// The vertex farthest along `direction` (body frame, any length).
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    pub(crate) fn farthest_vertex(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
    ) -> u32 {
        if self.resolution == 0 {
            return scan_vertices(&self.groups, direction);
        }
        self.climb_to_support(vertices, topology, direction, self.table_entry(direction))
    }

    /// The same, starting from a vertex believed to be near; if it is not, the table helps out.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    pub(crate) fn farthest_vertex_near(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        start: u32,
    ) -> u32 {
        if self.resolution == 0 {
            return scan_vertices(&self.groups, direction);
        }
        self.climb_from_near(vertices, topology, direction, start)
    }

    /// Whether the body is small enough to look at each vertex.
    #[inline]
    pub(crate) fn is_scanned(&self) -> bool {
        self.resolution == 0
    }

    /// Where a climb along `direction` may start; of no use to a body that is scanned.
    #[inline]
    pub(crate) fn table_guess(&self, direction: DVec3) -> u32 {
        if self.resolution == 0 { 0 } else { self.table_entry(direction) }
    }

    /// [`Self::extreme`] from a guess.
    #[inline]
    pub(crate) fn farthest_vertex_from_guess(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        guess: u32,
    ) -> u32 {
        if self.resolution == 0 {
            return scan_vertices(&self.groups, direction);
        }
        self.climb_to_support(vertices, topology, direction, guess)
    }

    fn climb_from_near(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        start: u32,
    ) -> u32 {
        let start = self.jump_along_ring(vertices, topology, direction, start);
        let (reached, steps) =
            self.climb_edges(vertices, topology, direction, start, MAX_GUESS_STEPS);
        if steps < MAX_GUESS_STEPS {
            return reached;
        }
        let other = self.table_entry(direction);
        let ahead = direction.dot(vertices[other as usize] - vertices[reached as usize]) > 0.0;
        let start = if ahead { other } else { reached };
        self.climb_to_support(vertices, topology, direction, start)
    }

    /// Steepest ascent along edges, at most `limit` steps, and the number of steps it took.
    ///
    /// Gains are taken from edge vectors, not from differences of dot products, so their rounding
    /// error is relative to the edge and not to the body.
    fn climb_edges(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        start: u32,
        limit: usize,
    ) -> (u32, usize) {
        let mut at = start;
        for steps in 0..limit {
            work::count(1);
            let origin = vertices[at as usize];
            let neighbours = topology.neighbours(at);
            let (best, gain) = if neighbours.len() <= FAN {
                steepest_neighbour(vertices, neighbours, origin, direction)
            } else {
                let best =
                    neighbours[self.fan_of_vertex(at).steepest_edge(vertices, topology, direction)];
                (best, direction.dot(vertices[best as usize] - origin))
            };
            if gain <= 0.0 {
                return (at, steps);
            }
            let edge = vertices[best as usize] - origin;
            // Demanding more than rounding makes every climb strictly ascending, so it ends.
            if gain <= noise::GAIN * direction.abs().dot(edge.abs()) {
                return (at, steps);
            }
            at = best;
        }
        (at, limit)
    }

    /// Steepest ascent from a vertex to the support point.
    #[inline]
    fn climb_to_support(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        start: u32,
    ) -> u32 {
        if self.ring_of.is_empty() {
            return self.climb_edges(vertices, topology, direction, start, usize::MAX).0;
        }
        self.climb_along_rings(vertices, topology, direction, start)
    }

    /// The same, along rings at once.
    #[inline(never)]
    fn climb_along_rings(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        start: u32,
    ) -> u32 {
        let mut at = start;
        loop {
            at = self.jump_along_ring(vertices, topology, direction, at);
            let (reached, steps) =
                self.climb_edges(vertices, topology, direction, at, RING_CHECK_STEPS);
            if steps < RING_CHECK_STEPS {
                return reached;
            }
            at = reached;
        }
    }

    /// The farthest vertex of the ring that a vertex is on, if it is on one and that is farther by more than
    /// rounding.
    #[inline]
    fn jump_along_ring(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        at: u32,
    ) -> u32 {
        let there = self.farthest_on_ring(vertices, topology, direction, at);
        if there == at {
            return at;
        }
        let way = vertices[there as usize] - vertices[at as usize];
        if direction.dot(way) > noise::GAIN * direction.abs().dot(way.abs()) { there } else { at }
    }

    /// The ring that a vertex is on, if it is on one.
    #[inline]
    fn ring_of_vertex(&self, vertex: u32) -> Option<&Ring> {
        let number = self.ring_of.get(vertex as usize).filter(|&&number| number != NO_RING)?;
        Some(self.ring_by_number(*number))
    }

    fn ring_by_number(&self, number: u16) -> &Ring {
        let number = usize::from(number);
        self.rings.get(number).unwrap_or_else(|| self.fans[number - self.rings.len()].ring())
    }

    /// Whether a vertex may be on a ring.
    #[inline]
    pub(super) fn has_rings(&self) -> bool {
        !self.ring_of.is_empty()
    }

    /// The rims and points that the body is nearly the hull of, if it has rims and these are few.
    #[inline]
    pub(super) fn outline(&self) -> &[Rim] {
        &self.outline
    }

    /// The same, measured.
    fn compute_outline(&self, vertices: &[DVec3]) -> Option<Vec<Rim>> {
        let mut outline = Vec::new();
        let mut is_known = vec![false; self.rings.len() + self.fans.len()];
        for (vertex, &number) in self.ring_of.iter().enumerate() {
            if number == NO_RING {
                outline.push(Rim::from_vertex(vertex as u32, vertices[vertex]));
            } else if !std::mem::replace(&mut is_known[usize::from(number)], true) {
                let ring = self.ring_by_number(number);
                outline.push(*ring.rim());
                if !ring.is_round() {
                    return None;
                }
            }
            if outline.len() > MOST_RIMS {
                return None;
            }
        }
        Some(outline.iter().map(|rim| rim.with_ends_among(&outline)).collect())
    }

    /// The farthest vertex of the ring that a vertex is on, or that vertex.
    #[inline]
    pub(super) fn farthest_on_ring(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        at: u32,
    ) -> u32 {
        self.ring_of_vertex(at)
            .map_or(at, |ring| ring.farthest_vertex(vertices, topology, direction))
    }

    /// For each vertex the number of its ring, the one with the most corners.
    fn number_rings(&self, topology: &Topology) -> Vec<u16> {
        let count = (self.rings.len() + self.fans.len()).min(usize::from(NO_RING));
        let mut ring_of =
            if count > 0 { vec![NO_RING; topology.vertex_count()] } else { Vec::new() };
        for number in 0..count as u16 {
            let ring = self.ring_by_number(number);
            for k in 0..ring.corner_count() {
                let known = &mut ring_of[ring.corner_vertex(topology, k) as usize];
                if *known == NO_RING
                    || self.ring_by_number(*known).corner_count() < ring.corner_count()
                {
                    *known = number;
                }
            }
        }
        ring_of
    }

    /// That of a vertex with many neighbours.
    pub(super) fn fan_of_vertex(&self, vertex: u32) -> &Fan {
        let found = self.fans.binary_search_by_key(&vertex, |fan| fan.vertex);
        &self.fans[found.unwrap_or_default()]
    }

    /// Candidates for neighbours in the supporting plane at `vertex`: positions of consecutive
    /// neighbours, as first position and count, that contain all of them if the vertex has few, and
    /// the three steepest if it has many.
    #[inline]
    pub(crate) fn plane_candidates(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        vertex: u32,
        direction: DVec3,
    ) -> (usize, usize) {
        let count = topology.neighbours(vertex).len();
        if count <= FAN {
            return (0, count);
        }
        let best = self.fan_of_vertex(vertex).steepest_edge(vertices, topology, direction);
        ((best + count - 1) % count, 3)
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.cells.capacity() * size_of::<u32>()
            + self.groups.capacity() * size_of::<VertexGroup>()
            + self.ring_of.capacity() * size_of::<u16>()
            + self.outline.capacity() * size_of::<Rim>()
            + self.fans.capacity() * size_of::<Fan>()
            + self.fans.iter().map(Fan::heap_bytes).sum::<usize>()
            + self.rings.capacity() * size_of::<Ring>()
            + self.rings.iter().map(Ring::heap_bytes).sum::<usize>()
    }

    /// The entry of the cell that a direction falls into.
    fn table_entry(&self, direction: DVec3) -> u32 {
        let half = 0.5 * f64::from(self.resolution);
        let place = octahedral_point(self.normalise * direction) * half + half;
        // Casts saturate, so that a NaN from a zero direction is cell 0.
        let (mut fs, mut ft) = (place.x, place.y);
        let last = self.resolution - 1;
        let (i, j) = ((fs as u32).min(last), (ft as u32).min(last));
        let mut entry = self.cells[(j * self.resolution + i) as usize];
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

    fn fill_table(&mut self, vertices: &[DVec3], topology: &Topology) {
        let r = self.resolution;
        let base = r * r;
        let mut cells = vec![0; base as usize];
        let builder = TableBuilder {
            index: self,
            vertices,
            topology,
            // Directions of the table to directions of the body: the inverse of `normalise`.
            to_body: self.normalise.inverse(),
            limit: base as usize + vertices.len(),
        };
        let mut near = 0;
        for j in 0..r {
            for i in 0..r {
                let cell = MapCell { side: 2.0 / f64::from(r), i, j, depth: 0 };
                near = builder.support_point(cell.direction_at(0.5, 0.5), near);
                let entry = builder.cell_entry(cell, near, &mut cells);
                cells[(j * r + i) as usize] = entry;
            }
        }
        cells.shrink_to_fit();
        self.cells = cells;
    }
}

/// A square of the map `[-1, 1]^2`.
#[derive(Clone, Copy)]
struct MapCell {
    side: f64,
    i: u32,
    j: u32,
    depth: u32,
}

impl MapCell {
    /// The normalised direction at relative position `(s, t)` in the cell.
    fn direction_at(&self, s: f64, t: f64) -> DVec3 {
        let s = (f64::from(self.i) + s) * self.side - 1.0;
        let t = (f64::from(self.j) + t) * self.side - 1.0;
        let along = 1.0 - s.abs() - t.abs();
        let [s, t] = if along < 0.0 { fold_about_diamond(s, t) } else { [s, t] };
        DVec3::new(s, t, along)
    }

    fn quarter_cell(&self, i: u32, j: u32) -> Self {
        Self { side: self.side * 0.5, i: 2 * self.i + i, j: 2 * self.j + j, depth: self.depth + 1 }
    }
}

/// Where a direction meets the octahedron `|x| + |y| + |z| = 1`, in `x` and `y`, with the lower half
/// folded outwards onto the square around the upper one.
#[inline]
fn octahedral_point(w: DVec3) -> DVec2 {
    let a = w.abs();
    let w = w * (1.0 / (a.x + a.y + a.z));
    let [s, t] = fold_about_diamond(w.x, w.y);
    let below = w.z < 0.0;
    DVec2::new(select_unpredictable(below, s, w.x), select_unpredictable(below, t, w.y))
}

/// The fold about the edges of the diamond `|s| + |t| = 1`.
fn fold_about_diamond(s: f64, t: f64) -> [f64; 2] {
    [(1.0 - t.abs()).copysign(s), (1.0 - s.abs()).copysign(t)]
}

struct TableBuilder<'a> {
    index: &'a SupportIndex,
    vertices: &'a [DVec3],
    topology: &'a Topology,
    to_body: DMat3,
    /// Most entries the table may have.
    limit: usize,
}

impl TableBuilder<'_> {
    fn support_point(&self, normalised: DVec3, start: u32) -> u32 {
        let direction = self.to_body * normalised;
        self.index.climb_to_support(self.vertices, self.topology, direction, start)
    }

    /// Whether the support point is a few climbing steps from a vertex.
    fn is_near(&self, normalised: DVec3, start: u32) -> bool {
        let direction = self.to_body * normalised;
        let start = self.index.jump_along_ring(self.vertices, self.topology, direction, start);
        let most = MAX_CELL_STEPS + 1;
        self.index.climb_edges(self.vertices, self.topology, direction, start, most).1 < most
    }

    /// The entry of a cell whose centre has the support point `center`: divided while its corners
    /// are far.
    fn cell_entry(&self, cell: MapCell, center: u32, cells: &mut Vec<u32>) -> u32 {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
        let is_near = |(s, t)| self.is_near(cell.direction_at(s, t), center);
        let full = cells.len() + 4 > self.limit;
        if cell.depth == MAX_DIVISIONS || full || corners.into_iter().all(is_near) {
            return center;
        }
        let first = cells.len();
        cells.extend([center; 4]);
        for (k, (i, j)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let quarter = cell.quarter_cell(i, j);
            let near = self.support_point(quarter.direction_at(0.5, 0.5), center);
            cells[first + k] = self.cell_entry(quarter, near, cells);
        }
        first as u32 | DIVIDED
    }
}

/// The coordinates of a small body, in groups of four for a scan without branches.
#[derive(Debug, Clone, Copy)]
struct VertexGroup {
    x: [f64; LANES],
    y: [f64; LANES],
    z: [f64; LANES],
}

const LANES: usize = 4;

/// Groups of a body's vertices; the last one is filled up with copies of vertex 0.
fn vertex_groups(vertices: &[DVec3]) -> Vec<VertexGroup> {
    let padded = |chunk: &[DVec3], k: usize| *chunk.get(k).unwrap_or(&vertices[0]);
    let group = |chunk: &[DVec3]| VertexGroup {
        x: std::array::from_fn(|k| padded(chunk, k).x),
        y: std::array::from_fn(|k| padded(chunk, k).y),
        z: std::array::from_fn(|k| padded(chunk, k).z),
    };
    vertices.chunks(LANES).map(group).collect()
}

/// Looks at every vertex. Of equals, one is chosen by position alone, so the answer does not depend
/// on where a search starts.
///
/// In one place for all, so that a query meets it in the cache; what it takes fits into registers.
#[inline]
fn scan_vertices(groups: &[VertexGroup], direction: DVec3) -> u32 {
    scan_along(groups, direction.x, direction.y, direction.z)
}

#[inline(never)]
fn scan_along(groups: &[VertexGroup], x: f64, y: f64, z: f64) -> u32 {
    let mut reach = [f64::NEG_INFINITY; LANES];
    // Group numbers as f64, so that number and reach are selected by the same mask.
    let mut best = [0.0; LANES];
    let mut number = 0.0;
    for group in groups {
        for k in 0..LANES {
            let along = x * group.x[k] + y * group.y[k] + z * group.z[k];
            let farther = along > reach[k];
            best[k] = if farther { number } else { best[k] };
            reach[k] = if farther { along } else { reach[k] };
        }
        number += 1.0;
    }
    let index = |k: usize| best[k] * LANES as f64 + k as f64;
    let pick = |a: (f64, f64), b: (f64, f64)| {
        let second = b.0 > a.0;
        (if second { b.0 } else { a.0 }, if second { b.1 } else { a.1 })
    };
    let low = pick((reach[0], index(0)), (reach[1], index(1)));
    let high = pick((reach[2], index(2)), (reach[3], index(3)));
    pick(low, high).1 as u32
}

/// The steepest neighbour and what it gains.
#[inline]
fn steepest_neighbour(
    vertices: &[DVec3],
    neighbours: &[u32],
    origin: DVec3,
    direction: DVec3,
) -> (u32, f64) {
    let (mut best, mut gain) = (u32::MAX, f64::NEG_INFINITY);
    for &w in neighbours {
        let along = direction.dot(vertices[w as usize] - origin);
        let higher = along > gain;
        best = select_unpredictable(higher, w, best);
        gain = select_unpredictable(higher, along, gain);
    }
    (best, gain)
}

/// The vertices with more than [`FAN`] neighbours.
fn build_fans(vertices: &[DVec3], topology: &Topology) -> Vec<Fan> {
    (0..topology.vertex_count() as u32)
        .filter(|&v| topology.neighbours(v).len() > FAN)
        .map(|v| Fan::new(vertices, topology, v))
        .collect()
}

/// The rings of faces with more than [`FAN`] corners, then those beside them that are no rings of faces.
fn build_rings(vertices: &[DVec3], topology: &Topology) -> Vec<Ring> {
    let large_faces =
        || (0..topology.face_count() as u32).filter(|&f| topology.face(f).len() > FAN);
    let mut rings: Vec<Ring> =
        large_faces().map(|f| Ring::from_face(vertices, topology, f)).collect();
    if rings.is_empty() {
        return rings;
    }
    let mut is_known = vec![false; vertices.len()];
    large_faces().flat_map(|f| topology.face_vertices(f)).for_each(|v| is_known[v as usize] = true);
    let is_new = |ring: &Ring| {
        (0..ring.corner_count()).any(|k| !is_known[ring.corner_vertex(topology, k) as usize])
    };
    let adjacent = large_faces()
        .filter_map(|face| Ring::from_adjacent_corners(vertices, topology, face))
        .filter(is_new);
    rings.extend(adjacent);
    rings
}
