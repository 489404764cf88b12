//! Adjacency of triangles across edges, in linear time.
//!
//! Half-edge `3 t + k` goes from corner `k` of triangle `t` to the next corner. Half-edges are sorted into buckets by
//! their smaller vertex. An edge with more than two facets, as many in each direction, is *crowded*.
//!
//! - Facets of a crowded edge are paired such that each pair bounds a wedge of material that contains no other facet.
//! - If wedges overlap, no such pairing exists, for example where two bodies that overlap have an edge in common. Then
//!   facets of one *patch*, which other edges connect, are paired first, and the others in the order of the input. Each
//!   pairing gives the same winding numbers, so that only the division into shells depends on it.
//! - If the numbers in the two directions differ, facets are paired in the order of the input. The remaining ones are
//!   open or inconsistent.

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
        let mut overlapping: Vec<Vec<Entry>> = Vec::new();
        for v in 0..vertices.len() {
            let bucket = &mut entries[starts[v] as usize..starts[v + 1] as usize];
            bucket.sort_unstable();
            for edge in bucket.chunk_by(|a, b| a.0 == b.0) {
                if !edges.pair_half_edges(vertices, triangles, edge) {
                    overlapping.push(edge.to_vec());
                }
            }
        }
        if !overlapping.is_empty() {
            let patches = shell_numbers(&edges.neighbours);
            for edge in overlapping {
                edges.pair_by_patch(vertices, triangles, edge, &patches);
            }
        }
        edges
    }

    /// Pairs the half-edges of one edge. Returns `false` if it is crowded and wedges of material overlap.
    fn pair_half_edges(
        &mut self,
        vertices: &[DVec3],
        triangles: &[[u32; 3]],
        edge: &[Entry],
    ) -> bool {
        let (forward, backward) = split_directions(edge);
        if let ([f], [b]) = (forward, backward) {
            self.make_neighbours(f.2, b.2);
            return true;
        }
        if forward.len() == backward.len() {
            self.crowded += 1;
            return self.pair_by_wedges(vertices, triangles, edge);
        }
        let shared = forward.len().min(backward.len());
        self.pair_in_order(edge);
        let rest = forward[shared..].iter().chain(&backward[shared..]).map(|e| e.2);
        let list = if edge.len() % 2 == 1 { &mut self.open } else { &mut self.inconsistent };
        list.extend(rest);
        true
    }

    /// Pairs facets that bound a wedge without other facets. Returns `false`, and pairs none, if wedges overlap.
    fn pair_by_wedges(
        &mut self,
        vertices: &[DVec3],
        triangles: &[[u32; 3]],
        edge: &[Entry],
    ) -> bool {
        let fan = Fan::new(vertices, triangles, edge);
        let forward = edge.len() / 2;
        let nearest: Vec<usize> = (0..forward).map(|f| fan.nearest_clockwise(f, forward)).collect();
        let mut different = nearest.clone();
        different.sort_unstable();
        different.dedup();
        if different.len() < forward {
            return false;
        }
        for (f, b) in nearest.into_iter().enumerate() {
            self.make_neighbours(edge[f].2, edge[b].2);
        }
        true
    }

    /// Pairs facets of the same patch, where it has as many in each direction, and the others in the order of the
    /// input.
    fn pair_by_patch(
        &mut self,
        vertices: &[DVec3],
        triangles: &[[u32; 3]],
        mut edge: Vec<Entry>,
        patches: &[u32],
    ) {
        let patch = |e: &Entry| patches[e.2 as usize / 3];
        edge.sort_by_key(|e| (patch(e), e.1));
        let mut others = Vec::new();
        for same in edge.chunk_by(|a, b| patch(a) == patch(b)) {
            let (forward, backward) = split_directions(same);
            if forward.len() != backward.len() {
                others.extend_from_slice(same);
            } else if !self.pair_by_wedges(vertices, triangles, same) {
                self.pair_in_order(same);
            }
        }
        others.sort_unstable();
        if !others.is_empty() && !self.pair_by_wedges(vertices, triangles, &others) {
            self.pair_in_order(&others);
        }
    }

    /// Pairs half-edges of opposite directions in the order of the input.
    fn pair_in_order(&mut self, edge: &[Entry]) {
        let (forward, backward) = split_directions(edge);
        for (f, b) in forward.iter().zip(backward) {
            self.make_neighbours(f.2, b.2);
        }
    }

    fn make_neighbours(&mut self, f: u32, b: u32) {
        self.neighbours[f as usize / 3][f as usize % 3] = b / 3;
        self.neighbours[b as usize / 3][b as usize % 3] = f / 3;
    }
}

/// A half-edge: its larger vertex, 1 if it starts there (backward), and its number.
type Entry = (u32, u8, u32);

/// Splits sorted half-edges of one edge into forward and backward ones.
fn split_directions(edge: &[Entry]) -> (&[Entry], &[Entry]) {
    edge.split_at(edge.partition_point(|e| e.1 == 0))
}

/// Returns the half-edges by their smaller vertex, and the start of each bucket.
fn half_edges_by_vertex(vertices: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<Entry>) {
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

/// Returns the shell of each triangle. Shells are numbered in the order of their first triangles.
pub(super) fn shell_numbers(neighbours: &[[u32; 3]]) -> Vec<u32> {
    let mut shell_of = vec![NO_NEIGHBOUR; neighbours.len()];
    let mut stack = Vec::new();
    let mut count = 0;
    for seed in 0..neighbours.len() {
        if shell_of[seed] != NO_NEIGHBOUR {
            continue;
        }
        shell_of[seed] = count;
        stack.push(seed as u32);
        while let Some(t) = stack.pop() {
            for &n in &neighbours[t as usize] {
                if n != NO_NEIGHBOUR && shell_of[n as usize] == NO_NEIGHBOUR {
                    shell_of[n as usize] = count;
                    stack.push(n);
                }
            }
        }
        count += 1;
    }
    shell_of
}

/// The facets around one edge, represented by their vertices opposite to the edge.
struct Fan {
    p: DVec3,
    q: DVec3,
    apexes: Vec<DVec3>,
}

impl Fan {
    fn new(vertices: &[DVec3], triangles: &[[u32; 3]], edge: &[Entry]) -> Self {
        let [p, q] = half_edge_ends(triangles, edge[0].2).map(|v| vertices[v as usize]);
        let apex_of = |e: &Entry| vertices[opposite_vertex(triangles, e.2) as usize];
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
