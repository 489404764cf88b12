//! Snapshots: edges of the section, in cyclic order, at chosen levels.
//!
//! The first snapshot is at the lowest level. The next one comes after the vertices passed have as
//! many edges as [`EDGES_PER_ENTRY`] times its entries, so all snapshots together have `O(n)`
//! entries, and a vertex of very many edges (the apex of a cone) gets a snapshot of its own. A query
//! at level `x` starts from the last snapshot at or below `x`: no such vertex lies between.
//!
//! A walk from a snapshot passes the vertices between its level and `x`, and the edges between two
//! entries. A snapshot of every `s`-th edge makes the next one come `s` times as soon: the first
//! become fewer and the second more, in the same space. Where the faces are round, a section of `m`
//! edges passes few vertices until the next one; where they are thin or large, a corner of the
//! section passes a share of `m`. A stride `s` in proportion to the root of `m` suits both.
//!
//! An entry holds a crossing edge and, as `f32`, where it crosses, and its *way*: how a climb from
//! it, at each vertex along the edge that leads highest, moves per level up to the next snapshot.
//! Where faces are thin, corners of the section pass many vertices between two snapshots, so that only
//! the way tells where they are. Positions and ways only guide a search, whose end is decided on the
//! mesh.

use glam::{DVec2, DVec3};

use super::chains::Chains;
use super::walk::next_counter_clockwise;
use colltrans_kernel::topology::Topology;

/// Edges of vertices passed per entry of a snapshot: about a vertex's worth of upward and downward
/// edges.
const EDGES_PER_ENTRY: usize = 4;

/// A snapshot holds every `s`-th edge of the section, `s` being this share of the root of how many
/// there are (measured).
const STRIDE_PER_ROOT: f64 = 1.0 / 3.0;

/// Bodies with a section of more edges than so many times the root of all vertices have chains. With 8,
/// ellipsoids of 20,000 vertices and 16 meridians had them too, and took 103 iterations a planar problem in
/// place of 63.
pub(super) const CHAIN_THRESHOLD: f64 = 24.0;

/// Candidates of one round of the search for an extreme entry.
const CANDIDATES: usize = 16;

/// A crossing edge of a snapshot.
#[derive(Debug, Clone, Copy)]
struct Entry {
    /// The half-edge that runs upwards.
    up: u32,
    /// Where it crosses, in the scaled coordinates of the section plane.
    position: [f32; 2],
    /// How a climb from there moves per level.
    drift: [f32; 2],
}

impl Entry {
    /// Where it seems to be, so many levels above the snapshot.
    #[inline]
    fn position_at(&self, above: f32) -> [f32; 2] {
        [0, 1].map(|i| self.position[i] + self.drift[i] * above)
    }
}

/// What sections are built from.
#[derive(Clone, Copy)]
pub(super) struct LeveledMesh<'a> {
    vertices: &'a [DVec3],
    pub(super) topology: &'a Topology,
    /// Level of each vertex.
    levels: &'a [f64],
}

impl LeveledMesh<'_> {
    /// Whether a half-edge runs upwards.
    pub(super) fn is_up(&self, h: u32) -> bool {
        let [from, to] = [self.topology.origin(h), self.topology.target(h)];
        self.levels[from as usize] < self.levels[to as usize]
    }

    /// How many edges a section has at most, of vertices from the lowest.
    fn max_section_edges(&self, order: &[(f64, u32)]) -> usize {
        let widths = order.iter().scan(0, |width: &mut usize, &(level, v)| {
            for &end in self.topology.neighbours(v) {
                let other = self.levels[end as usize];
                *width += usize::from(other > level);
                *width -= usize::from(other < level).min(*width);
            }
            Some(*width)
        });
        widths.max().unwrap_or(0)
    }

    /// Where a mesh edge, by a half-edge upwards, crosses a level.
    fn crossing_point(&self, up: u32, level: f64) -> DVec3 {
        let [low, high] = [self.topology.origin(up), self.topology.target(up)];
        let [from, to] = [low, high].map(|v| self.levels[v as usize]);
        let share = ((level - from) / (to - from)).min(1.0);
        let [low, high] = [low, high].map(|v| self.vertices[v as usize]);
        low + (high - low) * share
    }

    /// The edge from each vertex that leads highest, if one leads up.
    fn highest_edges(&self) -> Vec<Option<u32>> {
        let level = |v: u32| self.levels[v as usize];
        let highest = |v: u32| {
            let (edges, ends) = (self.topology.outgoing(v), self.topology.neighbours(v));
            let upwards = edges.iter().zip(ends).filter(|&(_, &end)| level(end) > level(v));
            upwards.max_by(|a, b| level(*a.1).total_cmp(&level(*b.1))).map(|(&edge, _)| edge)
        };
        (0..self.vertices.len() as u32).map(highest).collect()
    }
}

/// Climbs to one level after the other, each along the edges that lead highest. A vertex passes on to
/// later climbs where the one before arrived, so all climbs to a level visit it once.
struct Climbs<'a> {
    mesh: &'a LeveledMesh<'a>,
    highest: Vec<Option<u32>>,
    /// For which climb a vertex knows the edge of arrival, and that edge.
    arrivals: Vec<(u32, u32)>,
    passed: Vec<u32>,
}

impl<'a> Climbs<'a> {
    fn new(mesh: &'a LeveledMesh<'a>, highest: Vec<Option<u32>>) -> Self {
        let arrivals = vec![(u32::MAX, 0); mesh.vertices.len()];
        Self { mesh, highest, arrivals, passed: Vec::new() }
    }

    /// The edge that crosses `to`, or the last one below it, on climb number `number`.
    fn climb(&mut self, mut up: u32, (number, to): (u32, f64)) -> u32 {
        self.passed.clear();
        loop {
            let end = self.mesh.topology.target(up) as usize;
            let Some(ahead) = self.highest[end] else { break };
            if self.mesh.levels[end] > to {
                break;
            }
            if self.arrivals[end].0 == number {
                up = self.arrivals[end].1;
                break;
            }
            self.passed.push(end as u32);
            up = ahead;
        }
        for &vertex in &self.passed {
            self.arrivals[vertex as usize] = (number, up);
        }
        up
    }
}

/// The sections across one axis.
#[derive(Debug, Clone)]
pub(crate) struct AxisSections {
    /// Lowest and highest level of a vertex.
    pub(crate) range: [f64; 2],
    pub(crate) axis: DVec3,
    /// An upper bound of the body's diameter.
    pub(crate) diameter: f64,
    /// The range over the square root of the number of vertices: about what an edge spans.
    pub(crate) of_an_edge: f64,
    /// Scaled coordinates of the section plane: `position_i = plane_i . v - origin_i`.
    plane: [DVec3; 2],
    origin: [f64; 2],
    /// Level of each snapshot, ascending.
    levels: Vec<f64>,
    /// The level at which positions of each snapshot are meant, between that of the snapshot and
    /// the next one of a vertex.
    halfway: Vec<f64>,
    /// First entry of each snapshot, and one past the end.
    starts: Vec<u32>,
    /// Each snapshot counter-clockwise.
    entries: Vec<Entry>,
    /// For sections of many edges.
    chains: Option<Box<Chains>>,
}

impl AxisSections {
    pub(super) fn build(vertices: &[DVec3], topology: &Topology, axis: DVec3, ring: f64) -> Self {
        let vertex_levels: Vec<f64> = vertices.iter().map(|&v| axis.dot(v)).collect();
        let mut order: Vec<(f64, u32)> =
            vertex_levels.iter().zip(0..).map(|(&level, v)| (level, v)).collect();
        // Total: the same snapshots wherever it runs.
        order.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        let (plane, origin) = scaled_plane(vertices, axis);
        let range = [order[0].0, order[order.len() - 1].0];
        let across = 1.0 / plane[0].length();
        let mut sections = Self {
            range,
            diameter: (range[1] - range[0]) / axis.length() + 2.0 * across,
            of_an_edge: (range[1] - range[0]) / (vertices.len() as f64).sqrt(),
            axis,
            plane,
            origin,
            levels: Vec::new(),
            halfway: Vec::new(),
            starts: vec![0],
            entries: Vec::new(),
            chains: None,
        };
        let mesh = LeveledMesh { vertices, topology, levels: &vertex_levels };
        let highest = mesh.highest_edges();
        if mesh.max_section_edges(&order) as f64 > ring * (vertices.len() as f64).sqrt() {
            sections.chains = Some(Box::new(Chains::build(&mesh, &order, &highest)));
        }
        sections.take_snapshots(&mesh, &order);
        sections.compute_drifts(Climbs::new(&mesh, highest));
        sections.halfway.shrink_to_fit();
        sections.levels.shrink_to_fit();
        sections.starts.shrink_to_fit();
        sections.entries.shrink_to_fit();
        sections
    }

    fn take_snapshots(&mut self, mesh: &LeveledMesh, order: &[(f64, u32)]) {
        let LeveledMesh { topology, levels: vertex_levels, .. } = *mesh;
        let mut edges_passed = 0;
        let mut edges_due = 0;
        // The edges of one section.
        let mut ring = Vec::new();
        for (rank, &(level, vertex)) in order.iter().enumerate() {
            edges_passed += topology.neighbours(vertex).len();
            let Some(&(next_level, _)) = order.get(rank + 1) else { break };
            if edges_passed < edges_due || next_level == level {
                continue;
            }
            // A vertex below the top has an edge upwards; rounding may hide it, then its
            // predecessor serves.
            let first = order[..=rank].iter().rev().find_map(|&(_, v)| {
                let mut outgoing = topology.outgoing(v).iter().copied();
                outgoing.find(|&h| vertex_levels[topology.target(h) as usize] > level)
            });
            if let Some(first) = first {
                self.take_snapshot(mesh, first, [level, next_level], &mut ring);
                edges_due = EDGES_PER_ENTRY
                    * (self.entries.len() - self.starts[self.starts.len() - 2] as usize);
                edges_passed = 0;
            }
        }
    }

    /// Appends a snapshot of the section between two successive levels of vertices, which `first`
    /// crosses.
    fn take_snapshot(
        &mut self,
        mesh: &LeveledMesh,
        first: u32,
        [level, next_level]: [f64; 2],
        ring: &mut Vec<u32>,
    ) {
        let topology = mesh.topology;
        // Halfway no two of its vertices coincide.
        let halfway = f64::midpoint(level, next_level);
        let mut up = first;
        ring.clear();
        // A section has no more entries than there are edges; rounding in the levels could make the
        // walk miss its start.
        for _ in 0..topology.edge_count() {
            ring.push(up);
            up = next_counter_clockwise(topology, up, |v| mesh.levels[v as usize] > level);
            if up == first {
                break;
            }
        }
        let stride = ((ring.len() as f64).sqrt() * STRIDE_PER_ROOT).max(1.0) as usize;
        for &up in ring.iter().step_by(stride) {
            let position = self.plane_position(mesh.crossing_point(up, halfway));
            self.entries.push(Entry { up, position, drift: [0.0; 2] });
        }
        self.levels.push(level);
        self.halfway.push(halfway);
        self.starts.push(self.entries.len() as u32);
    }

    /// Climbs from every entry to the next snapshot, or the top.
    fn compute_drifts(&mut self, mut climbs: Climbs) {
        let mesh = climbs.mesh;
        for index in 0..self.halfway.len() {
            let from = self.halfway[index];
            let to = self.halfway.get(index + 1).map_or(self.range[1], |&next| next);
            for i in self.starts[index] as usize..self.starts[index + 1] as usize {
                let Entry { up, position, .. } = self.entries[i];
                let arrival = climbs.climb(up, (index as u32, to));
                let there = self.plane_position(mesh.crossing_point(arrival, to));
                let drift = [0, 1].map(|k| f64::from(there[k] - position[k]) / (to - from));
                self.entries[i].drift = drift.map(|w| if w.is_finite() { w as f32 } else { 0.0 });
            }
        }
    }

    fn plane_position(&self, v: DVec3) -> [f32; 2] {
        [0, 1].map(|i| (self.plane[i].dot(v) - self.origin[i]) as f32)
    }

    /// The last snapshot at or below level `x >= range[0]`, as a map shows it at that level.
    pub(crate) fn snapshot<'a>(&'a self, map: &'a SectionMap, x: f64) -> Snapshot<'a> {
        let index = self.levels.partition_point(|&level| level <= x).max(1) - 1;
        let end = self.starts.get(index + 1).map_or(0, |&end| end as usize);
        Snapshot {
            entries: &self.entries[self.starts[index] as usize..end],
            map,
            above: self.halfway.get(index).map_or(0.0, |halfway| (x - halfway) as f32),
            base: map.constant + map.per_level * x,
        }
    }

    /// The affine map `(covectors . v) + constants` of the body frame, on this axis' sections.
    pub(crate) fn map(&self, covectors: [DVec3; 2], constants: DVec2) -> SectionMap {
        // The plane's coordinate vectors are orthogonal and equally long.
        let scale_squared = self.plane[0].length_squared();
        let of = |v: DVec3| DVec2::from_array(covectors.map(|covector| covector.dot(v)));
        let slopes = self.plane.map(|p| of(p) / scale_squared);
        let height = slopes.map(|slope| slope.x);
        let size = height[0].abs().max(height[1].abs());
        SectionMap {
            slopes,
            per_level: of(self.axis) / self.axis.length_squared(),
            constant: constants + slopes[0] * self.origin[0] + slopes[1] * self.origin[1],
            height: height.map(|slope| (slope / size) as f32),
        }
    }

    pub(crate) fn heap_bytes(&self) -> usize {
        size_of::<f64>() * (self.levels.capacity() + self.halfway.capacity())
            + size_of::<u32>() * self.starts.capacity()
            + size_of::<Entry>() * self.entries.capacity()
            + self.chains.as_ref().map_or(0, |chains| size_of::<Chains>() + chains.heap_bytes())
    }

    /// The chains, if sections have many edges.
    pub(crate) fn chains(&self) -> Option<&Chains> {
        self.chains.as_deref()
    }
}

/// Coordinates of the planes across `axis` in which the body has about unit size, right-handed with
/// the axis.
fn scaled_plane(vertices: &[DVec3], axis: DVec3) -> ([DVec3; 2], [f64; 2]) {
    let first = axis.normalize().any_orthonormal_vector();
    let second = axis.normalize().cross(first);
    let plane = [first, second];
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for v in vertices {
        for i in 0..2 {
            let coordinate = plane[i].dot(*v);
            low[i] = low[i].min(coordinate);
            high[i] = high[i].max(coordinate);
        }
    }
    let scale = 1.0 / (high[0] - low[0]).max(high[1] - low[1]);
    let origin = [0, 1].map(|i| scale * f64::midpoint(low[i], high[i]));
    (plane.map(|p| p * scale), origin)
}

/// An affine map of the sections across one axis to a plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SectionMap {
    /// Per unit of either position, and of the level.
    slopes: [DVec2; 2],
    per_level: DVec2,
    constant: DVec2,
    /// The slopes of the first coordinate, scaled so that `f32` can hold them.
    height: [f32; 2],
}

/// The two ways along a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Turn {
    CounterClockwise,
    Clockwise,
}

impl Turn {
    pub(crate) fn reversed(self) -> Self {
        match self {
            Self::CounterClockwise => Self::Clockwise,
            Self::Clockwise => Self::CounterClockwise,
        }
    }
}

/// One snapshot as it seems to be at a level: its entries in cyclic order, and points of a plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Snapshot<'a> {
    entries: &'a [Entry],
    map: &'a SectionMap,
    /// How far the level in question is above it.
    above: f32,
    /// What the level adds to every point.
    base: DVec2,
}

impl Snapshot<'_> {
    /// How many entries it has.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// The crossing edge of entry `index`.
    pub(crate) fn up(&self, index: usize) -> u32 {
        self.entries[index].up
    }

    /// Where entry `index` seems to be.
    #[inline]
    pub(crate) fn point(&self, index: usize) -> DVec2 {
        let [u, v] = self.entries[index].position_at(self.above);
        self.base + self.map.slopes[0] * f64::from(u) + self.map.slopes[1] * f64::from(v)
    }

    /// The entry whose point's first coordinate, times `sign`, is least; `sign` is 1 or -1.
    ///
    /// On a convex polygon the minimum lies within one stride of the best of every `stride`-th
    /// entry. All candidates of a round are compared, without branches that hardware could not
    /// predict.
    pub(crate) fn extreme(&self, sign: f32) -> usize {
        let count = self.entries.len();
        let slope = self.map.height.map(|s| sign * s);
        let value = |i: usize| {
            let [u, v] = self.entries[i].position_at(self.above);
            slope[0] * u + slope[1] * v
        };
        let mut stride = 1;
        while stride * CANDIDATES < count {
            stride *= CANDIDATES / 2;
        }
        let (mut best, mut least) = (0, value(0));
        let mut consider = |from: usize, to: usize, stride: usize| {
            for i in (from..to).step_by(stride) {
                let candidate = value(i);
                best = if candidate < least { i } else { best };
                least = least.min(candidate);
            }
            best
        };
        let mut centre = consider(0, count, stride);
        while stride > 1 {
            let reach = stride;
            stride = (stride / (CANDIDATES / 2)).max(1);
            let (from, to) = (centre as isize - reach as isize, centre + reach);
            if from < 0 {
                consider((from + count as isize).max(0) as usize, count, stride);
            }
            if to > count {
                consider(0, to - count, stride);
            }
            centre = consider(from.max(0) as usize, to.min(count), stride);
        }
        centre
    }
}

#[cfg(test)]
impl AxisSections {
    /// Level and crossing edges of the snapshot for `x`.
    pub(crate) fn snapshot_for_test(&self, x: f64) -> (f64, Vec<u32>) {
        let index = self.levels.partition_point(|&level| level <= x) - 1;
        let of = self.starts[index] as usize..self.starts[index + 1] as usize;
        (self.levels[index], self.entries[of].iter().map(|entry| entry.up).collect())
    }
}
