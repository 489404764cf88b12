//! Adjacency of triangles across edges, in linear time.
//!
//! Half-edge `3 t + k` goes from corner `k` of triangle `t` to the next corner. Half-edges are sorted into buckets by
//! their smaller vertex. At an edge with more than two facets, as many in each direction, facets are paired such that
//! each pair bounds a wedge of material that contains no other facet. If the numbers in the two directions differ,
//! facets are paired in the order of the input. The remaining ones are open or inconsistent.

use std::cmp::Ordering;

use glam::DVec3;

use super::exact;
use super::wedge::{AxisSigns, Ray, Wedge};

/// Marks a side of a triangle without a neighbour.
pub(crate) const NO_NEIGHBOUR: u32 = u32::MAX;

/// The pairs of half-edges of a mesh, and the half-edges without a partner.
pub(super) struct Edges {
    /// The triangle across each half-edge, or [`NO_NEIGHBOUR`].
    pub(super) neighbours: Vec<[u32; 3]>,
    /// Half-edges without a partner, at edges with an odd number of facets.
    pub(super) open: Vec<u32>,
    /// Half-edges without a partner in the opposite direction, at edges with an even number of facets.
    pub(super) inconsistent: Vec<u32>,
    /// Number of edges with more than two facets, as many in each direction.
    pub(super) crowded: usize,
}

/// Returns the start and end vertex of a half-edge.
pub(super) fn half_edge_ends(triangles: &[[u32; 3]], half_edge: u32) -> [u32; 2] {
    let (t, k) = (half_edge as usize / 3, half_edge as usize % 3);
    [triangles[t][k], triangles[t][(k + 1) % 3]]
}

fn opposite_vertex(triangles: &[[u32; 3]], half_edge: u32) -> u32 {
    triangles[half_edge as usize / 3][(half_edge as usize + 2) % 3]
}

impl Edges {
    pub(super) fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let mut edges = Self {
            neighbours: vec![[NO_NEIGHBOUR; 3]; triangles.len()],
            open: Vec::new(),
            inconsistent: Vec::new(),
            crowded: 0,
        };
        let (starts, mut entries) = half_edges_by_vertex(vertices.len(), triangles);
        for v in 0..vertices.len() {
            let bucket = &mut entries[starts[v] as usize..starts[v + 1] as usize];
            bucket.sort_unstable();
            for edge in bucket.chunk_by(|a, b| a.0 == b.0) {
                edges.pair_half_edges(vertices, triangles, edge);
            }
        }
        edges
    }

    /// Pairs the half-edges of one edge. The middle of an entry is 1 for backward half-edges, which come last.
    fn pair_half_edges(
        &mut self,
        vertices: &[DVec3],
        triangles: &[[u32; 3]],
        edge: &[(u32, u8, u32)],
    ) {
        let (forward, backward) = edge.split_at(edge.partition_point(|e| e.1 == 0));
        if let ([f], [b]) = (forward, backward) {
            self.make_neighbours(f.2, b.2);
            return;
        }
        if forward.len() == backward.len() {
            self.crowded += 1;
            let fan = Fan::new(vertices, triangles, edge);
            for f in 0..forward.len() {
                let b = fan.nearest_clockwise(f, forward.len());
                self.make_neighbours(edge[f].2, edge[b].2);
            }
            return;
        }
        let shared = forward.len().min(backward.len());
        for (f, b) in forward.iter().zip(backward) {
            self.make_neighbours(f.2, b.2);
        }
        let rest = forward[shared..].iter().chain(&backward[shared..]).map(|e| e.2);
        if edge.len() % 2 == 1 { self.open.extend(rest) } else { self.inconsistent.extend(rest) }
    }

    fn make_neighbours(&mut self, f: u32, b: u32) {
        self.neighbours[f as usize / 3][f as usize % 3] = b / 3;
        self.neighbours[b as usize / 3][b as usize % 3] = f / 3;
    }
}

/// Returns the half-edges by their smaller vertex: the start of each bucket, and entries of the larger vertex, 1 for
/// a backward half-edge, and the half-edge.
fn half_edges_by_vertex(
    vertices: usize,
    triangles: &[[u32; 3]],
) -> (Vec<u32>, Vec<(u32, u8, u32)>) {
    let half_edges = || (0..3 * triangles.len() as u32).map(|h| (h, half_edge_ends(triangles, h)));
    let mut starts = vec![0_u32; vertices + 1];
    for (_, [from, to]) in half_edges() {
        starts[from.min(to) as usize + 1] += 1;
    }
    for v in 0..vertices {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut entries = vec![(0, 0, 0); 3 * triangles.len()];
    for (h, [from, to]) in half_edges() {
        let slot = &mut next[from.min(to) as usize];
        entries[*slot as usize] = (from.max(to), u8::from(from > to), h);
        *slot += 1;
    }
    (starts, entries)
}

/// The facets around one edge, represented by their vertices opposite to the edge.
struct Fan {
    p: DVec3,
    q: DVec3,
    apexes: Vec<DVec3>,
}

impl Fan {
    fn new(vertices: &[DVec3], triangles: &[[u32; 3]], edge: &[(u32, u8, u32)]) -> Self {
        let [p, q] = half_edge_ends(triangles, edge[0].2).map(|v| vertices[v as usize]);
        let apex_of = |e: &(u32, u8, u32)| vertices[opposite_vertex(triangles, e.2) as usize];
        Self { p, q, apexes: edge.iter().map(apex_of).collect() }
    }

    /// Returns the backward facet that bounds the material of forward facet `f`: the nearest one clockwise. A
    /// backward facet that coincides with `f` counts as the farthest, for example between two bodies in face-to-face
    /// contact.
    fn nearest_clockwise(&self, f: usize, forward: usize) -> usize {
        let mut best = forward;
        for b in forward + 1..self.apexes.len() {
            let wedge = Wedge { start: Ray::towards(best), end: Ray::towards(f) };
            if wedge.is_empty(self) || wedge.contains(Ray::towards(b), self) {
                best = b;
            }
        }
        best
    }
}

impl AxisSigns for Fan {
    fn determinant_sign(&self, x: usize, y: usize) -> Ordering {
        exact::sign_of_side(self.p, self.q, self.apexes[x], self.apexes[y])
    }

    fn same_half(&self, x: usize, y: usize) -> bool {
        let turn = |k: usize, axis| exact::sign_along_axis(self.p, self.q, self.apexes[k], axis);
        let axis = (0..3).find(|&axis| turn(x, axis) != Ordering::Equal).unwrap_or(0);
        turn(x, axis) == turn(y, axis)
    }
}
