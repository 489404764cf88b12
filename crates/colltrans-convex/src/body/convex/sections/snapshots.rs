//! Snapshots: edges of the section at selected levels, in cyclic order.
//!
//! The first snapshot is at the lowest level. The next one follows when the vertices passed since the last snapshot
//! have [`EDGES_PER_ENTRY`] edges for each entry of that snapshot. Therefore all snapshots together have `O(n)`
//! entries, and a vertex with very many edges gets its own snapshot. A query at level `x` starts from the last snapshot
//! at or below `x`, and no such vertex lies between.
//!
//! An entry stores a crossing edge, its position and its *drift*: the change of position per level along a climb to
//! the next snapshot. Positions and drifts are `f32` and only guide a search, which the mesh decides. A snapshot
//! stores every `s`-th edge, where `s` is proportional to the square root of the number of edges. Rationale:
//! `docs/theory/sections.md`.

use glam::{DVec2, DVec3};

use super::chains::Chains;
use super::walk::next_counter_clockwise;
use colltrans_kernel::topology::Topology;

/// Number of edges of passed vertices per entry of a snapshot: about the edges of one vertex.
const EDGES_PER_ENTRY: usize = 4;

/// Ratio of the stride `s` of a snapshot to the square root of the number of edges of its section (measured).
const STRIDE_PER_ROOT: f64 = 1.0 / 3.0;

/// Ratio of the number of edges of the largest section to the square root of the number of vertices above which a body
/// has chains. With a ratio of 8, ellipsoids of 20,000 vertices and 16 meridians had chains too. They took 103 instead
/// of 63 iterations per planar problem.
pub(super) const CHAIN_THRESHOLD: f64 = 24.0;

/// Maximum number of candidates with which the search for an extreme entry begins.
const FIRST_CANDIDATES: usize = 4;

/// A crossing edge of a snapshot.
#[derive(Debug, Clone, Copy)]
struct Entry {
    /// Half-edge that runs upwards.
    up: u32,
    /// Point where the edge crosses, in the scaled coordinates of the section plane.
    position: [f32; 2],
    /// Change of position per level along a climb from the edge.
    drift: [f32; 2],
}

impl Entry {
    /// Extrapolates the position to a level that is `above` levels above the snapshot's positions.
    #[inline]
    fn position_at(&self, above: f32) -> [f32; 2] {
        [0, 1].map(|i| self.position[i] + self.drift[i] * above)
    }
}

/// Vertices, topology and levels from which sections are built.
#[derive(Clone, Copy)]
pub(super) struct LeveledMesh<'a> {
    vertices: &'a [DVec3],
    pub(super) topology: &'a Topology,
    /// Level of each vertex.
    levels: &'a [f64],
}

impl LeveledMesh<'_> {
    /// Checks whether a half-edge runs upwards.
    pub(super) fn is_up(&self, h: u32) -> bool {
        let [from, to] = [self.topology.origin(h), self.topology.target(h)];
        self.levels[from as usize] < self.levels[to as usize]
    }

    /// Returns the largest number of edges of a section. `order` lists the vertices from the lowest.
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

    /// Computes the point where a mesh edge crosses a level. `up` is its half-edge upwards.
    fn crossing_point(&self, up: u32, level: f64) -> DVec3 {
        let [low, high] = [self.topology.origin(up), self.topology.target(up)];
        let [from, to] = [low, high].map(|v| self.levels[v as usize]);
        let share = ((level - from) / (to - from)).min(1.0);
        let [low, high] = [low, high].map(|v| self.vertices[v as usize]);
        low + (high - low) * share
    }

    /// Returns for each vertex the edge that leads highest; `None` if no edge leads up.
    fn highest_edges(&self) -> Vec<Option<u32>> {
        let level = |v: u32| self.levels[v as usize];
        let highest = |v: u32| {
            let (edges, ends) = (self.topology.outgoing_half_edges(v), self.topology.neighbours(v));
            let upwards = edges.iter().zip(ends).filter(|&(_, &end)| level(end) > level(v));
            upwards.max_by(|a, b| level(*a.1).total_cmp(&level(*b.1))).map(|(&edge, _)| edge)
        };
        (0..self.vertices.len() as u32).map(highest).collect()
    }
}

/// Climbs from all entries to one level, then to the next one, along the edges that lead highest. Each vertex
/// stores where the last climb through it arrived. Therefore all climbs to one level visit a vertex once.
struct Climbs<'a> {
    mesh: &'a LeveledMesh<'a>,
    highest: Vec<Option<u32>>,
    /// For each vertex the number of the climb for which its edge of arrival is valid, and that edge.
    arrivals: Vec<(u32, u32)>,
    passed: Vec<u32>,
}

impl<'a> Climbs<'a> {
    fn new(mesh: &'a LeveledMesh<'a>, highest: Vec<Option<u32>>) -> Self {
        let arrivals = vec![(u32::MAX, 0); mesh.vertices.len()];
        Self { mesh, highest, arrivals, passed: Vec::new() }
    }

    /// Climbs from the edge `up`. Returns the edge that crosses level `to`, or the last edge of the climb if none
    /// does. `number` identifies the level.
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
    /// The difference of `range` divided by the square root of the number of vertices, approximately the range of
    /// one edge.
    pub(crate) mean_edge_range: f64,
    /// Scaled coordinates of the section plane: `position_i = plane_i . v - origin_i`.
    plane: [DVec3; 2],
    origin: [f64; 2],
    /// Level of each snapshot, ascending.
    levels: Vec<f64>,
    /// For each snapshot the level of its positions, halfway between its own level and the next level of a vertex.
    halfway: Vec<f64>,
    /// First entry of each snapshot, followed by the number of entries.
    starts: Vec<u32>,
    /// Entries of all snapshots, each snapshot counter-clockwise.
    entries: Vec<Entry>,
    /// Chains, if the sections have many edges.
    chains: Option<Box<Chains>>,
}

impl AxisSections {
    /// Builds the sections across `axis`, with chains if a section has more than `ring` times as many edges as the
    /// square root of the number of vertices.
    pub(super) fn build(vertices: &[DVec3], topology: &Topology, axis: DVec3, ring: f64) -> Self {
        let vertex_levels: Vec<f64> = vertices.iter().map(|&v| axis.dot(v)).collect();
        let mut order: Vec<(f64, u32)> =
            vertex_levels.iter().zip(0..).map(|(&level, v)| (level, v)).collect();
        // A total order, so that the snapshots are the same on all platforms.
        order.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        let (plane, origin) = scaled_plane(vertices, axis);
        let range = [order[0].0, order[order.len() - 1].0];
        let across = 1.0 / plane[0].length();
        let mut sections = Self {
            range,
            diameter: (range[1] - range[0]) / axis.length() + 2.0 * across,
            mean_edge_range: (range[1] - range[0]) / (vertices.len() as f64).sqrt(),
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

    /// Selects the levels of the snapshots, and stores their entries.
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
            // A vertex below the top has an edge upwards. If rounding hides it, use one of the vertices before it.
            let first = order[..=rank].iter().rev().find_map(|&(_, v)| {
                let mut outgoing = topology.outgoing_half_edges(v).iter().copied();
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

    /// Appends a snapshot of the section between two successive levels of vertices. `first` is one of its edges, and
    /// `ring` is scratch space.
    fn take_snapshot(
        &mut self,
        mesh: &LeveledMesh,
        first: u32,
        [level, next_level]: [f64; 2],
        ring: &mut Vec<u32>,
    ) {
        let topology = mesh.topology;
        // Halfway between the levels, no two vertices of the section coincide.
        let halfway = f64::midpoint(level, next_level);
        let mut up = first;
        ring.clear();
        // A section has no more entries than there are edges. Because of rounding of levels, the walk might miss its
        // start.
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

    /// Computes the drifts by climbs from every entry to the next snapshot, or to the top.
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

    /// Returns a point in the scaled coordinates of the section plane.
    fn plane_position(&self, v: DVec3) -> [f32; 2] {
        [0, 1].map(|i| (self.plane[i].dot(v) - self.origin[i]) as f32)
    }

    /// Returns the last snapshot at or below level `x >= range[0]`, extrapolated to this level and mapped by `map`.
    pub(crate) fn snapshot_below<'a>(&'a self, map: &'a SectionMap, x: f64) -> Snapshot<'a> {
        let index = self.levels.partition_point(|&level| level <= x).max(1) - 1;
        let end = self.starts.get(index + 1).map_or(0, |&end| end as usize);
        Snapshot {
            entries: &self.entries[self.starts[index] as usize..end],
            map,
            above: self.halfway.get(index).map_or(0.0, |halfway| (x - halfway) as f32),
            base: map.constant + map.per_level * x,
        }
    }

    /// Returns the affine map `(covectors . v) + constants` of the body frame, as a function on the sections across
    /// this axis.
    pub(crate) fn map(&self, covectors: [DVec3; 2], constants: DVec2) -> SectionMap {
        // The coordinate vectors of the plane are orthogonal and have equal length.
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

    /// Returns the number of bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        size_of::<f64>() * (self.levels.capacity() + self.halfway.capacity())
            + size_of::<u32>() * self.starts.capacity()
            + size_of::<Entry>() * self.entries.capacity()
            + self.chains.as_ref().map_or(0, |chains| size_of::<Chains>() + chains.heap_bytes())
    }

    /// Returns the chains; `None` if no section has many edges.
    pub(crate) fn chains(&self) -> Option<&Chains> {
        self.chains.as_deref()
    }
}

/// Computes coordinates of the planes across `axis`, right-handed with the axis, in which the body has about unit
/// size. Returns the coordinate vectors and the origin.
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
    /// Derivatives by the two positions.
    slopes: [DVec2; 2],
    /// Derivative by the level.
    per_level: DVec2,
    /// Value at level 0 and positions 0.
    constant: DVec2,
    /// Derivatives of the first coordinate by the two positions, scaled to the range of `f32`.
    height: [f32; 2],
}

/// The two directions around a section.
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

/// A snapshot extrapolated to a level: its entries in cyclic order, mapped to points of a plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Snapshot<'a> {
    entries: &'a [Entry],
    map: &'a SectionMap,
    /// Difference of the level from that of the snapshot's positions.
    above: f32,
    /// Contribution of the level to every point.
    base: DVec2,
}

impl Snapshot<'_> {
    /// Returns the number of entries.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns the crossing edge of entry `index`.
    pub(crate) fn crossing_edge(&self, index: usize) -> u32 {
        self.entries[index].up
    }

    /// Computes the extrapolated point of entry `index`.
    #[inline]
    pub(crate) fn extrapolated_point(&self, index: usize) -> DVec2 {
        let [u, v] = self.entries[index].position_at(self.above);
        self.base + self.map.slopes[0] * f64::from(u) + self.map.slopes[1] * f64::from(v)
    }

    /// Finds the entry whose point has the smallest first coordinate times `sign`, which is 1 or -1.
    ///
    /// On a convex polygon, the minimum lies within one stride of the best of every `stride`-th entry. Therefore each
    /// halving of the stride adds two candidates. They are compared without branches, because the outcomes are
    /// unpredictable.
    pub(crate) fn extreme_entry(&self, sign: f32) -> usize {
        let count = self.entries.len();
        let slope = self.map.height.map(|s| sign * s);
        let value = |i: usize| {
            let [u, v] = self.entries[i].position_at(self.above);
            slope[0] * u + slope[1] * v
        };
        let mut stride = 1;
        while stride * FIRST_CANDIDATES < count {
            stride *= 2;
        }
        let (mut best, mut least) = (0, value(0));
        let mut consider = |i: usize| {
            let candidate = value(i);
            best = if candidate < least { i } else { best };
            least = least.min(candidate);
            best
        };
        let mut centre = (stride..count).step_by(stride).map(&mut consider).last().unwrap_or(0);
        while stride > 1 {
            stride /= 2;
            let (back, ahead) = (centre + count - stride, centre + stride);
            consider(if back >= count { back - count } else { back });
            centre = consider(if ahead >= count { ahead - count } else { ahead });
        }
        centre
    }
}

#[cfg(test)]
impl AxisSections {
    /// Returns the level and the crossing edges of the snapshot for `x`.
    pub(crate) fn snapshot_for_test(&self, x: f64) -> (f64, Vec<u32>) {
        let index = self.levels.partition_point(|&level| level <= x) - 1;
        let of = self.starts[index] as usize..self.starts[index + 1] as usize;
        (self.levels[index], self.entries[of].iter().map(|entry| entry.up).collect())
    }
}
