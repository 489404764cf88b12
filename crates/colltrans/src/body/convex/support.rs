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
//! A vertex with many neighbours (the apex of a cone) would make one step linear. Cut by a plane,
//! the edges of a vertex are the corners of a convex polygon, over which a linear function has one
//! maximum and one minimum: the steepest edge is found among widely spaced ones first, then among
//! ever closer ones. Along the boundary of a face with many corners (the base of a cylinder) a climb
//! would take a step for each: there it goes twice as far each time while the boundary still rises,
//! and then searches where it began to fall.

use std::hint::select_unpredictable;

use glam::{DMat3, DVec2, DVec3};

use crate::body::Inertia;
use crate::body::topology::Topology;
use crate::number::noise;
use crate::work;

/// Up to this many vertices, looking at each is fastest (measured).
const SCAN_LIMIT: usize = 20;

/// An entry of the table is a vertex, or, with this bit, the first of four finer cells.
const DIVIDED: u32 = 1 << 31;

/// A cell whose corners are farther than this many climbing steps from its centre is divided.
const NEAR_STEPS: usize = 3;

/// After this many steps a climb from a guess asks the table (measured).
const PATIENCE: usize = 2;

/// Divisions of one cell of the cube map: `2^-20` of its side is below any spread that
/// single-precision models have.
const MAX_DEPTH: u32 = 20;

/// A vertex with more neighbours than this is searched, not scanned.
const FAN: usize = 32;

/// Steps after which a climb looks whether it goes along a face with more corners than [`FAN`]
/// (measured).
const LONG: usize = 6;

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
    groups: Vec<Group>,
    /// Vertices with many neighbours, ascending, each with a vector that has a positive product
    /// with all its edges.
    fans: Vec<(u32, DVec3)>,
    /// Whether there are faces with more corners than [`FAN`].
    has_wide_faces: bool,
}

impl SupportIndex {
    pub(crate) fn build(vertices: &[DVec3], topology: &Topology, inertia: &Inertia) -> Self {
        let mut index = Self {
            normalise: inertia.factor.transpose(),
            resolution: 0,
            cells: Vec::new(),
            groups: Vec::new(),
            fans: fans(vertices, topology),
            has_wide_faces: (0..topology.face_count() as u32)
                .any(|face| topology.face(face).len() > FAN),
        };
        if vertices.len() <= SCAN_LIMIT {
            index.groups = groups(vertices);
        } else {
            index.resolution = ((vertices.len() as f64 / 3.0).sqrt() as u32).max(5);
            index.fill(vertices, topology);
        }
        index
    }

    /// The vertex farthest along `direction` (body frame, any length).
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    pub(crate) fn extreme(&self, vertices: &[DVec3], topology: &Topology, direction: DVec3) -> u32 {
        if self.resolution == 0 {
            return scan(&self.groups, direction);
        }
        self.ascend(vertices, topology, direction, self.look_up(direction))
    }

    /// The same, starting from a vertex believed to be near; if it is not, the table helps out.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    pub(crate) fn extreme_from(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        start: u32,
    ) -> u32 {
        if self.resolution == 0 {
            return scan(&self.groups, direction);
        }
        self.climb_from(vertices, topology, direction, start)
    }

    /// Whether the body is small enough to look at each vertex.
    #[inline]
    pub(crate) fn is_scanned(&self) -> bool {
        self.resolution == 0
    }

    /// Where a climb along `direction` may start; of no use to a body that is scanned.
    #[inline]
    pub(crate) fn guess(&self, direction: DVec3) -> u32 {
        if self.resolution == 0 { 0 } else { self.look_up(direction) }
    }

    /// [`Self::extreme`] from a guess.
    #[inline]
    pub(crate) fn extreme_from_guess(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        guess: u32,
    ) -> u32 {
        if self.resolution == 0 {
            return scan(&self.groups, direction);
        }
        self.ascend(vertices, topology, direction, guess)
    }

    fn climb_from(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        start: u32,
    ) -> u32 {
        let (reached, steps) = self.climb(vertices, topology, direction, start, PATIENCE);
        if steps < PATIENCE {
            return reached;
        }
        let other = self.look_up(direction);
        let ahead = direction.dot(vertices[other as usize] - vertices[reached as usize]) > 0.0;
        let start = if ahead { other } else { reached };
        self.ascend(vertices, topology, direction, start)
    }

    /// Steepest ascent along edges, at most `limit` steps, and the number of steps it took.
    ///
    /// Gains are taken from edge vectors, not from differences of dot products, so their rounding
    /// error is relative to the edge and not to the body.
    fn climb(
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
            let here = vertices[at as usize];
            let neighbours = topology.neighbours(at);
            let (best, gain) = if neighbours.len() <= FAN {
                steepest(vertices, neighbours, here, direction)
            } else {
                let best = neighbours[self.steepest_in_fan(vertices, topology, at, direction)];
                (best, direction.dot(vertices[best as usize] - here))
            };
            if gain <= 0.0 {
                return (at, steps);
            }
            let edge = vertices[best as usize] - here;
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
    fn ascend(&self, vertices: &[DVec3], topology: &Topology, direction: DVec3, start: u32) -> u32 {
        if self.has_wide_faces {
            return self.ascend_along_faces(vertices, topology, direction, start);
        }
        self.climb(vertices, topology, direction, start, usize::MAX).0
    }

    /// The same, with long strides along faces with many corners.
    #[inline(never)]
    fn ascend_along_faces(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
        start: u32,
    ) -> u32 {
        let mut at = start;
        loop {
            let (last, steps) = self.climb(vertices, topology, direction, at, LONG - 1);
            if steps < LONG - 1 {
                return last;
            }
            let (next, steps) = self.climb(vertices, topology, direction, last, 1);
            if steps < 1 {
                return last;
            }
            at = along_face(vertices, topology, direction, [last, next]);
        }
    }

    /// Position among its neighbours of the steepest edge of a vertex with many.
    fn steepest_in_fan(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        vertex: u32,
        direction: DVec3,
    ) -> usize {
        let here = vertices[vertex as usize];
        let neighbours = topology.neighbours(vertex);
        let inward = self
            .fans
            .binary_search_by_key(&vertex, |fan| fan.0)
            .map_or(DVec3::ZERO, |k| self.fans[k].1);
        let slope = |i: usize| {
            let edge = vertices[neighbours[i] as usize] - here;
            direction.dot(edge) / inward.dot(edge)
        };
        greatest_on_cycle(neighbours.len(), slope)
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
        let best = self.steepest_in_fan(vertices, topology, vertex, direction);
        ((best + count - 1) % count, 3)
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.cells.capacity() * size_of::<u32>()
            + self.groups.capacity() * size_of::<Group>()
            + self.fans.capacity() * size_of::<(u32, DVec3)>()
    }

    /// The entry of the cell that a direction falls into.
    fn look_up(&self, direction: DVec3) -> u32 {
        let half = 0.5 * f64::from(self.resolution);
        let place = octahedral(self.normalise * direction) * half + half;
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

    fn fill(&mut self, vertices: &[DVec3], topology: &Topology) {
        let r = self.resolution;
        let base = r * r;
        let mut cells = vec![0; base as usize];
        let builder = Builder {
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
                let cell = Cell { side: 2.0 / f64::from(r), i, j, depth: 0 };
                near = builder.support(cell.direction(0.5, 0.5), near);
                let entry = builder.entry(cell, near, &mut cells);
                cells[(j * r + i) as usize] = entry;
            }
        }
        cells.shrink_to_fit();
        self.cells = cells;
    }
}

/// A square of the map `[-1, 1]^2`.
#[derive(Clone, Copy)]
struct Cell {
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
        let along = 1.0 - s.abs() - t.abs();
        let [s, t] = if along < 0.0 { folded(s, t) } else { [s, t] };
        DVec3::new(s, t, along)
    }

    fn quarter(&self, i: u32, j: u32) -> Self {
        Self { side: self.side * 0.5, i: 2 * self.i + i, j: 2 * self.j + j, depth: self.depth + 1 }
    }
}

/// Where a direction meets the octahedron `|x| + |y| + |z| = 1`, in `x` and `y`, with the lower half
/// folded outwards onto the square around the upper one.
#[inline]
fn octahedral(w: DVec3) -> DVec2 {
    let a = w.abs();
    let w = w * (1.0 / (a.x + a.y + a.z));
    let [s, t] = folded(w.x, w.y);
    let below = w.z < 0.0;
    DVec2::new(select_unpredictable(below, s, w.x), select_unpredictable(below, t, w.y))
}

/// The fold about the edges of the diamond `|s| + |t| = 1`.
fn folded(s: f64, t: f64) -> [f64; 2] {
    [(1.0 - t.abs()).copysign(s), (1.0 - s.abs()).copysign(t)]
}

struct Builder<'a> {
    index: &'a SupportIndex,
    vertices: &'a [DVec3],
    topology: &'a Topology,
    to_body: DMat3,
    /// Most entries the table may have.
    limit: usize,
}

impl Builder<'_> {
    fn support(&self, normalised: DVec3, start: u32) -> u32 {
        let direction = self.to_body * normalised;
        self.index.ascend(self.vertices, self.topology, direction, start)
    }

    /// Whether the support point is a few climbing steps from a vertex.
    fn is_near(&self, normalised: DVec3, start: u32) -> bool {
        let direction = self.to_body * normalised;
        let most = NEAR_STEPS + 1;
        self.index.climb(self.vertices, self.topology, direction, start, most).1 < most
    }

    /// The entry of a cell whose centre has the support point `center`: divided while its corners
    /// are far.
    fn entry(&self, cell: Cell, center: u32, cells: &mut Vec<u32>) -> u32 {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
        let is_near = |(s, t)| self.is_near(cell.direction(s, t), center);
        let full = cells.len() + 4 > self.limit;
        if cell.depth == MAX_DEPTH || full || corners.into_iter().all(is_near) {
            return center;
        }
        let first = cells.len();
        cells.extend([center; 4]);
        for (k, (i, j)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let quarter = cell.quarter(i, j);
            let near = self.support(quarter.direction(0.5, 0.5), center);
            cells[first + k] = self.entry(quarter, near, cells);
        }
        first as u32 | DIVIDED
    }
}

/// The coordinates of a small body, in groups of four for a scan without branches.
#[derive(Debug, Clone, Copy)]
struct Group {
    x: [f64; LANES],
    y: [f64; LANES],
    z: [f64; LANES],
}

const LANES: usize = 4;

/// Groups of a body's vertices; the last one is filled up with copies of vertex 0.
fn groups(vertices: &[DVec3]) -> Vec<Group> {
    let padded = |chunk: &[DVec3], k: usize| *chunk.get(k).unwrap_or(&vertices[0]);
    let group = |chunk: &[DVec3]| Group {
        x: std::array::from_fn(|k| padded(chunk, k).x),
        y: std::array::from_fn(|k| padded(chunk, k).y),
        z: std::array::from_fn(|k| padded(chunk, k).z),
    };
    vertices.chunks(LANES).map(group).collect()
}

/// Looks at every vertex. Of equals, one is chosen by position alone, so the answer does not depend
/// on where a search starts.
#[inline(always)]
#[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
fn scan(groups: &[Group], direction: DVec3) -> u32 {
    let mut reach = [f64::NEG_INFINITY; LANES];
    // Group numbers as f64, so that number and reach are selected by the same mask.
    let mut best = [0.0; LANES];
    let mut number = 0.0;
    for group in groups {
        for k in 0..LANES {
            let along =
                direction.x * group.x[k] + direction.y * group.y[k] + direction.z * group.z[k];
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
fn steepest(vertices: &[DVec3], neighbours: &[u32], here: DVec3, direction: DVec3) -> (u32, f64) {
    let (mut best, mut gain) = (u32::MAX, f64::NEG_INFINITY);
    for &w in neighbours {
        let along = direction.dot(vertices[w as usize] - here);
        let higher = along > gain;
        best = select_unpredictable(higher, w, best);
        gain = select_unpredictable(higher, along, gain);
    }
    (best, gain)
}

/// Where a function on a cycle with one maximum and one minimum is greatest.
///
/// Between samples with a common distance, the maximum is at most that distance from the greatest
/// sample.
pub(crate) fn greatest_on_cycle(count: usize, value: impl Fn(usize) -> f64) -> usize {
    let mut stride = (count / 8).max(1).next_power_of_two();
    let (mut best, mut greatest) = (0, f64::NEG_INFINITY);
    let mut look = |i: usize, best: &mut usize| {
        let v = value(i);
        if v > greatest {
            (*best, greatest) = (i, v);
        }
    };
    for i in (0..count).step_by(stride) {
        look(i, &mut best);
    }
    while stride > 1 {
        stride /= 2;
        let center = best;
        look((center + stride) % count, &mut best);
        look((center + count - stride) % count, &mut best);
    }
    best
}

/// Where the boundary of a face with many corners is highest beyond an edge that rises along it; the
/// edge's end if neither face beside it has many.
///
/// A linear function rises along the boundary of a convex polygon up to one maximum, then falls, and
/// rises again to where it began; so where it rises and is higher than there, the maximum is ahead.
#[cold]
#[inline(never)]
fn along_face(
    vertices: &[DVec3],
    topology: &Topology,
    direction: DVec3,
    [from, at]: [u32; 2],
) -> u32 {
    let Some(left) = topology.edge_between(from, at) else { return at };
    let right = topology.half_edge(left).twin;
    let boundary = |edge: u32| topology.face(topology.half_edge(edge).face);
    let is_wide = |edge: &u32| boundary(*edge).len() > FAN;
    let Some(edge) = [left, right].into_iter().find(is_wide) else { return at };
    let face = boundary(edge);
    let (first, count) = (edge - face.start, face.len() as u32);
    // The corner `k` edges beyond `at`.
    let corner = |k: u32| {
        let ahead = if edge == left { first + 1 + k } else { first + 2 * count - k };
        topology.half_edge(face.start + ahead % count).origin
    };
    let here = vertices[at as usize];
    let rises_to = |k: u32| {
        let [last, there] = [k - 1, k].map(|k| vertices[corner(k) as usize]);
        direction.dot(there - last) > 0.0 && direction.dot(there - here) > 0.0
    };
    // The boundary rises to `low`, and not to `high` or further than round.
    let (mut low, mut high) = (0, 1);
    while high < count && rises_to(high) {
        (low, high) = (high, 2 * high);
    }
    high = high.min(count);
    while high - low > 1 {
        let middle = u32::midpoint(low, high);
        if rises_to(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let there = corner(low);
    let way = vertices[there as usize] - here;
    if direction.dot(way) > noise::GAIN * direction.abs().dot(way.abs()) { there } else { at }
}

/// The vertices with more than [`FAN`] neighbours, with the mean of the inward unit normals of
/// their faces.
fn fans(vertices: &[DVec3], topology: &Topology) -> Vec<(u32, DVec3)> {
    let inward = |v: u32| {
        let here = vertices[v as usize];
        let neighbours = topology.neighbours(v);
        let next = neighbours.iter().cycle().skip(1);
        // Neighbours are clockwise from outside, so the product of two consecutive edges points
        // inwards.
        let normal = |(&a, &b): (&u32, &u32)| {
            (vertices[a as usize] - here).cross(vertices[b as usize] - here).normalize_or_zero()
        };
        neighbours.iter().zip(next).map(normal).sum::<DVec3>()
    };
    (0..topology.vertex_count() as u32)
        .filter(|&v| topology.neighbours(v).len() > FAN)
        .map(|v| (v, inward(v)))
        .collect()
}
