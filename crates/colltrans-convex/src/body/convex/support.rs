//! Support points: the vertex of a body farthest along a direction, in `O(log n)`.
//!
//! 1. A *table* over directions returns a vertex that is the support point of a nearby direction. It is an
//!    octahedral map of the normalised directions `L^T n`, where `L L^T` is the matrix of the inertia ellipsoid.
//! 2. A *climb* along edges, always to the steepest neighbour, ends at the support point, because on a convex body
//!    each local maximum is global. A search that is given a vertex nearby starts there, and reads the table only if
//!    the climb takes [`MAX_GUESS_STEPS`] steps or more.
//! 3. Faces with many corners and vertices with many neighbours are searched by angle ([`ring`](super::ring),
//!    [`fan`](super::fan)). A climb along them would take linear time.
//!
//! The number of table entries is at most proportional to the number of vertices. Details:
//! `docs/theory/supports.md`.

use std::hint::select_unpredictable;

use glam::{DMat3, DVec2, DVec3};

use super::fan::{Fan, MAX_SCANNED_NEIGHBOURS};
use super::ring::{Rim, Ring};
use crate::body::Inertia;
use colltrans_kernel::noise;
use colltrans_kernel::topology::Topology;
use colltrans_kernel::visit_counter;

/// Maximum number of vertices of a body whose support points are found by a scan (measured).
const SCAN_LIMIT: usize = 20;

/// Flag of a table entry. An entry with this bit is the index of the first of four finer cells, else it is a
/// vertex.
const DIVIDED: u32 = 1 << 31;

/// Maximum number of climbing steps from the centre of a cell to its corners; otherwise the cell is divided.
const MAX_CELL_STEPS: usize = 3;

/// Number of steps after which a climb from a guess consults the table (measured).
const MAX_GUESS_STEPS: usize = 2;

/// Maximum number of divisions of one cell of the map. A side of `2^-20` is below any spread that single-precision
/// models have.
const MAX_DIVISIONS: u32 = 20;

/// Number of steps after which a climb tests for a ring to follow.
const RING_CHECK_STEPS: usize = 3;

/// Maximum number of rims and points in the outline of a body.
pub(crate) const MAX_RIMS: usize = 8;

/// Marks a vertex without a ring.
const NO_RING: u16 = u16::MAX;

/// The table over directions, with the rings and fans of the body.
#[derive(Debug, Clone)]
pub(crate) struct SupportIndex {
    /// `L^T`.
    normalise: DMat3,
    /// Number of cells along a side of the map; 0 if the body is small enough to scan.
    resolution: u32,
    /// Entries of the base cells, followed by groups of four.
    cells: Vec<u32>,
    /// Vertices of a body that is small enough to scan.
    groups: Vec<VertexGroup>,
    /// Vertices with many neighbours, ascending.
    fans: Vec<Fan>,
    /// Rings of faces with many corners, followed by rings adjacent to them.
    rings: Vec<Ring>,
    /// Ring number of each vertex: a position in `rings` or, beyond its end, in `fans`. Empty if the body has
    /// neither.
    ring_of: Vec<u16>,
    /// Rims and points whose hull approximates the body; empty unless there are few.
    outline: Vec<Rim>,
}

impl SupportIndex {
    /// Builds the table, rings and fans of a body.
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

    /// Finds the vertex farthest along `direction` (body frame, any length).
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction in memory stalls the scan")]
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

    /// Finds the vertex farthest along `direction` (body frame, any length), starting at a vertex that is expected
    /// to be near. If the climb takes too many steps, it consults the table.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction in memory stalls the scan")]
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

    /// Checks whether the body is small enough to scan all vertices.
    #[inline]
    pub(crate) fn is_scanned(&self) -> bool {
        self.resolution == 0
    }

    /// Returns the table's vertex for a climb along `direction`, or 0 for a body that is scanned.
    #[inline]
    pub(crate) fn table_guess(&self, direction: DVec3) -> u32 {
        if self.resolution == 0 { 0 } else { self.table_entry(direction) }
    }

    /// Finds the vertex farthest along `direction` (body frame, any length), starting at a vertex from
    /// [`Self::table_guess`].
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

    /// Climbs from a vertex, and restarts at the table's vertex if the climb is long and that vertex is higher.
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

    /// Climbs along edges by steepest ascent, at most `limit` steps. Returns the last vertex and the number of
    /// steps.
    ///
    /// Gains are computed from edge vectors, not from differences of dot products. Therefore their rounding error is
    /// relative to the edge and not to the body.
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
            visit_counter::count_visits(1);
            let origin = vertices[at as usize];
            let neighbours = topology.neighbours(at);
            let (best, gain) = if neighbours.len() <= MAX_SCANNED_NEIGHBOURS {
                steepest_neighbour(vertices, neighbours, origin, direction)
            } else {
                let best = neighbours
                    [self.fan_of_vertex(at).steepest_edge_position(vertices, topology, direction)];
                (best, direction.dot(vertices[best as usize] - origin))
            };
            if gain <= 0.0 {
                return (at, steps);
            }
            let edge = vertices[best as usize] - origin;
            // Each step must gain more than the rounding error. Therefore the climb strictly ascends and ends.
            if gain <= noise::GAIN * direction.abs().dot(edge.abs()) {
                return (at, steps);
            }
            at = best;
        }
        (at, limit)
    }

    /// Climbs from a vertex to the support point.
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

    /// Climbs from a vertex to the support point, and jumps along rings on the way.
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

    /// Returns the farthest vertex of the ring that contains `at`. Returns `at` if it is on no ring, or if the gain
    /// does not exceed the rounding error.
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

    /// Returns the ring of a vertex; `None` if the vertex is on no ring.
    #[inline]
    fn ring_of_vertex(&self, vertex: u32) -> Option<&Ring> {
        let number = self.ring_of.get(vertex as usize).filter(|&&number| number != NO_RING)?;
        Some(self.ring_by_number(*number))
    }

    /// Returns the ring with a number of `ring_of`.
    fn ring_by_number(&self, number: u16) -> &Ring {
        let number = usize::from(number);
        self.rings.get(number).unwrap_or_else(|| self.fans[number - self.rings.len()].ring())
    }

    /// Checks whether any vertex may be on a ring.
    #[inline]
    pub(super) fn has_rings(&self) -> bool {
        !self.ring_of.is_empty()
    }

    /// Returns the rims and points whose hull approximates the body. The slice is empty if the body has no rims, too
    /// many of them, or some that are not round.
    #[inline]
    pub(super) fn outline(&self) -> &[Rim] {
        &self.outline
    }

    /// Computes the outline. Returns `None` if a ring is not nearly an ellipse, or if there are more than
    /// [`MAX_RIMS`] rims and points.
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
            if outline.len() > MAX_RIMS {
                return None;
            }
        }
        Some(outline.iter().map(|rim| rim.with_ends_among(&outline)).collect())
    }

    /// Returns the farthest vertex of the ring that contains `at`; `at` itself if it is on no ring.
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

    /// Computes the ring number of each vertex. Of several rings, the one with the most corners counts.
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

    /// Returns the fan of a vertex, which must have more than [`MAX_SCANNED_NEIGHBOURS`] neighbours.
    pub(super) fn fan_of_vertex(&self, vertex: u32) -> &Fan {
        let found = self.fans.binary_search_by_key(&vertex, |fan| fan.vertex);
        &self.fans[found.unwrap_or_default()]
    }

    /// Returns the positions of candidates for neighbours in the supporting plane at `vertex`, as first position and
    /// count, cyclic. A vertex with at most [`MAX_SCANNED_NEIGHBOURS`] neighbours yields all of them, any other the
    /// steepest neighbour and the two next to it.
    #[inline]
    pub(crate) fn plane_candidates(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        vertex: u32,
        direction: DVec3,
    ) -> (usize, usize) {
        let count = topology.neighbours(vertex).len();
        if count <= MAX_SCANNED_NEIGHBOURS {
            return (0, count);
        }
        let best = self.fan_of_vertex(vertex).steepest_edge_position(vertices, topology, direction);
        ((best + count - 1) % count, 3)
    }

    /// Returns the number of bytes on the heap.
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

    /// Returns the table entry of the cell that contains a direction.
    fn table_entry(&self, direction: DVec3) -> u32 {
        let half = 0.5 * f64::from(self.resolution);
        let place = octahedral_point(self.normalise * direction) * half + half;
        // Casts saturate: a NaN from a zero direction selects cell 0.
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

    /// Computes all entries of the table.
    fn fill_table(&mut self, vertices: &[DVec3], topology: &Topology) {
        let r = self.resolution;
        let base = r * r;
        let mut cells = vec![0; base as usize];
        let builder = TableBuilder {
            index: self,
            vertices,
            topology,
            // Maps directions of the table to directions of the body: the inverse of `normalise`.
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
    /// Computes the normalised direction at the relative position `(s, t)` in the cell.
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

/// Projects a direction onto the octahedron `|x| + |y| + |z| = 1`. Returns `x` and `y`, where the lower half is
/// folded outwards onto the square around the upper half.
#[inline]
fn octahedral_point(w: DVec3) -> DVec2 {
    let a = w.abs();
    let w = w * (1.0 / (a.x + a.y + a.z));
    let [s, t] = fold_about_diamond(w.x, w.y);
    let below = w.z < 0.0;
    DVec2::new(select_unpredictable(below, s, w.x), select_unpredictable(below, t, w.y))
}

/// Folds a point about the edges of the diamond `|s| + |t| = 1`.
fn fold_about_diamond(s: f64, t: f64) -> [f64; 2] {
    [(1.0 - t.abs()).copysign(s), (1.0 - s.abs()).copysign(t)]
}

struct TableBuilder<'a> {
    index: &'a SupportIndex,
    vertices: &'a [DVec3],
    topology: &'a Topology,
    to_body: DMat3,
    /// Maximum number of entries of the table.
    limit: usize,
}

impl TableBuilder<'_> {
    /// Finds the support point along a normalised direction, starting at a vertex.
    fn support_point(&self, normalised: DVec3, start: u32) -> u32 {
        let direction = self.to_body * normalised;
        self.index.climb_to_support(self.vertices, self.topology, direction, start)
    }

    /// Checks whether a climb from `start` to the support point takes at most [`MAX_CELL_STEPS`] steps.
    fn is_near(&self, normalised: DVec3, start: u32) -> bool {
        let direction = self.to_body * normalised;
        let start = self.index.jump_along_ring(self.vertices, self.topology, direction, start);
        let most = MAX_CELL_STEPS + 1;
        self.index.climb_edges(self.vertices, self.topology, direction, start, most).1 < most
    }

    /// Computes the entry of a cell, where `center` is the support point of its centre. The cell is divided while a
    /// corner is too many climbing steps away.
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

/// Coordinates of [`LANES`] vertices, for a scan without branches.
#[derive(Debug, Clone, Copy)]
struct VertexGroup {
    x: [f64; LANES],
    y: [f64; LANES],
    z: [f64; LANES],
}

/// Number of vertices that a scan compares at a time.
const LANES: usize = 4;

/// Returns the vertices of a body in groups. The last group is padded with copies of vertex 0.
fn vertex_groups(vertices: &[DVec3]) -> Vec<VertexGroup> {
    let padded = |chunk: &[DVec3], k: usize| *chunk.get(k).unwrap_or(&vertices[0]);
    let group = |chunk: &[DVec3]| VertexGroup {
        x: std::array::from_fn(|k| padded(chunk, k).x),
        y: std::array::from_fn(|k| padded(chunk, k).y),
        z: std::array::from_fn(|k| padded(chunk, k).z),
    };
    vertices.chunks(LANES).map(group).collect()
}

/// Scans all vertices for the one farthest along `direction`. Ties are broken by position alone, so the result does
/// not depend on the start of a search.
///
/// All callers share [`scan_along`], which keeps its code in the instruction cache. Its arguments fit into
/// registers.
#[inline]
fn scan_vertices(groups: &[VertexGroup], direction: DVec3) -> u32 {
    scan_along(groups, direction.x, direction.y, direction.z)
}

/// Scans all vertices for the one farthest along `(x, y, z)`.
#[inline(never)]
fn scan_along(groups: &[VertexGroup], x: f64, y: f64, z: f64) -> u32 {
    let mut reach = [f64::NEG_INFINITY; LANES];
    // Group numbers are stored as f64, so that one mask selects both the number and the reach.
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

/// Returns the steepest neighbour and its gain along `direction`.
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

/// Builds the fans of all vertices with more than [`MAX_SCANNED_NEIGHBOURS`] neighbours.
fn build_fans(vertices: &[DVec3], topology: &Topology) -> Vec<Fan> {
    (0..topology.vertex_count() as u32)
        .filter(|&v| topology.neighbours(v).len() > MAX_SCANNED_NEIGHBOURS)
        .map(|v| Fan::new(vertices, topology, v))
        .collect()
}

/// Builds the rings of all faces with more than [`MAX_SCANNED_NEIGHBOURS`] corners, followed by the rings adjacent to
/// such faces that have a vertex outside them.
fn build_rings(vertices: &[DVec3], topology: &Topology) -> Vec<Ring> {
    let large_faces = || {
        (0..topology.face_count() as u32)
            .filter(|&f| topology.face_half_edges(f).len() > MAX_SCANNED_NEIGHBOURS)
    };
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
