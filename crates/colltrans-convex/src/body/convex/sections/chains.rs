//! Chains: an order of a body's faces from left to right, and a binary tree over the edges between them. In
//! sections with many edges, one test finds an edge in a given part of the section.
//!
//! - *cut*: a climb from the lowest to the highest vertex, always along the edge that leads highest. Each section,
//!   cut open there, is a row of faces, counter-clockwise.
//! - *rank* of a face: its position in one order of all faces that holds for the rows of all levels.
//! - *chain* `k`: the edges between faces of ranks below `k` and other faces. Each level crosses one edge of it.
//! - *node* of two ranks `l < r`: the number with the most trailing zeros in `l + 1..=r`. An edge is stored only at
//!   the node of its two faces, so the tree takes `O(n)` space.
//!
//! Invariant of a search: between two edges of a section, the faces have ranks from `l` to `r`. If `l < r`, their
//! node stores an edge that crosses the level between the two edges. Rounding of levels may hide it; then the
//! search returns `None` and the caller walks. Derivation: `docs/theory/sections.md`.

use super::snapshots::{LeveledMesh, Turn};
use colltrans_kernel::topology::Topology;

/// Number of sides of a face above which its boundary is searched with steps that double.
const MAX_WALKED_SIDES: u32 = 8;

/// Marks a face without a rank.
const NONE: u32 = u32::MAX;

/// The chains across one axis.
#[derive(Debug, Clone)]
pub(crate) struct Chains {
    /// Rank of each face.
    ranks: Vec<u32>,
    /// First edge of each node, followed by the number of all edges.
    starts: Vec<u32>,
    /// Half-edges that run upwards, grouped by node and ascending by origin within a node.
    edges: Vec<u32>,
    /// Half-edges of the cut, upwards.
    cut: Vec<u32>,
}

/// The search of one level in the chains.
pub(crate) struct ChainSearch<'a, L, C> {
    pub(crate) chains: &'a Chains,
    pub(crate) topology: &'a Topology,
    pub(crate) x: f64,
    /// Returns the level of a vertex.
    pub(crate) level: L,
    /// Receives numbers of steps to count.
    pub(crate) count: C,
}

impl Chains {
    /// Builds the chains. `order` lists the vertices from the lowest, and `highest` contains for each vertex the
    /// edge that leads highest.
    pub(super) fn build(mesh: &LeveledMesh, order: &[(f64, u32)], highest: &[Option<u32>]) -> Self {
        let cut = cut_edges(mesh, order[0].1, highest);
        let ranks = face_ranks(mesh, &cut);
        let count = ranks.len();
        let mut chains = Self { ranks, starts: vec![0; count + 2], edges: Vec::new(), cut };
        let mut is_cut = vec![false; mesh.topology.half_edges().len()];
        chains.cut.iter().for_each(|&up| is_cut[up as usize] = true);
        let of_vertex = |&(_, v): &(f64, u32)| mesh.topology.outgoing_half_edges(v).iter().copied();
        let ups =
            || order.iter().flat_map(of_vertex).filter(|&h| mesh.is_up(h) && !is_cut[h as usize]);
        // First pass: count the edges of each node. Second pass: store them, with `starts` as the next free
        // positions.
        for up in ups() {
            if let Some(node) = chains.node_of(mesh.topology, up) {
                chains.starts[node as usize + 1] += 1;
            }
        }
        for k in 1..chains.starts.len() {
            chains.starts[k] += chains.starts[k - 1];
        }
        chains.edges = vec![0; chains.starts[count + 1] as usize];
        for up in ups() {
            if let Some(node) = chains.node_of(mesh.topology, up) {
                chains.edges[chains.starts[node as usize] as usize] = up;
                chains.starts[node as usize] += 1;
            }
        }
        // Each start is now the end of its node, which is the start of the next node.
        chains.starts.rotate_right(1);
        chains.starts[0] = 0;
        chains
    }

    /// Returns the ranks of the faces at an edge, on its clockwise side and on its counter-clockwise side.
    fn adjacent_ranks(&self, topology: &Topology, up: u32) -> [u32; 2] {
        let edge = topology.half_edge(up);
        [edge.face, topology.half_edge(edge.twin).face].map(|face| self.ranks[face as usize])
    }

    /// Returns the node of an edge. Returns `None` if the ranks are not in order.
    fn node_of(&self, topology: &Topology, up: u32) -> Option<u32> {
        let [left, right] = self.adjacent_ranks(topology, up);
        // Rounding may have left a cycle.
        (left < right).then(|| separating_node(left, right))
    }

    /// Returns the number of bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        let Self { ranks, starts, edges, cut } = self;
        let counts = [ranks, starts, edges, cut].map(Vec::capacity);
        size_of::<u32>() * counts.iter().sum::<usize>()
    }
}

/// Returns the node that separates two ranks, given in ascending order.
fn separating_node(left: u32, right: u32) -> u32 {
    let bits = (left ^ right).ilog2();
    right >> bits << bits
}

/// Climbs from the lowest vertex along the edges that lead highest. Returns these edges.
fn cut_edges(mesh: &LeveledMesh, lowest: u32, highest: &[Option<u32>]) -> Vec<u32> {
    let ahead = |&up: &u32| highest[mesh.topology.target(up) as usize];
    std::iter::successors(highest[lowest as usize], ahead).collect()
}

/// Computes the ranks of all faces. Each rank is above those of the faces adjacent on the clockwise side. Faces are
/// ranked in the order in which they become available, so that faces near each other have close ranks.
fn face_ranks(mesh: &LeveledMesh, cut: &[u32]) -> Vec<u32> {
    let topology = mesh.topology;
    let faces = topology.face_count() as u32;
    let mut is_cut = vec![false; topology.half_edges().len()];
    for &up in cut {
        is_cut[up as usize] = true;
        is_cut[topology.half_edge(up).twin as usize] = true;
    }
    let is_down = |h: &u32| mesh.is_up(topology.half_edge(*h).twin) && !is_cut[*h as usize];
    let mut waiting: Vec<u32> = (0..faces)
        .map(|face| topology.face_half_edges(face).filter(is_down).count() as u32)
        .collect();
    let mut ranks = vec![NONE; faces as usize];
    let mut queue: Vec<u32> = (0..faces).filter(|&face| waiting[face as usize] == 0).collect();
    let mut ranked = 0;
    while let Some(&face) = queue.get(ranked) {
        ranks[face as usize] = ranked as u32;
        ranked += 1;
        for h in topology.face_half_edges(face).filter(|&h| mesh.is_up(h) && !is_cut[h as usize]) {
            let next = topology.half_edge(topology.half_edge(h).twin).face as usize;
            waiting[next] -= 1;
            if waiting[next] == 0 {
                queue.push(next as u32);
            }
        }
    }
    // Faces that rounding has left in a cycle come last.
    let rest = ranks.iter_mut().filter(|rank| **rank == NONE);
    rest.zip(ranked as u32..).for_each(|(rank, last)| *rank = last);
    ranks
}

impl<L: Fn(u32) -> f64, C: Fn(u32)> ChainSearch<'_, L, C> {
    /// Returns the edge of a node that crosses the level, if there is one.
    fn crossing_edge_of_node(&self, node: u32) -> Option<u32> {
        let Chains { starts, edges, .. } = self.chains;
        let [from, to] = [node, node + 1].map(|k| starts[k as usize] as usize);
        self.crossing_edge(&edges[from..to])
    }

    /// Finds the edge among the edges of a chain that crosses the level. Returns `None` if rounding hides it.
    fn crossing_edge(&self, edges: &[u32]) -> Option<u32> {
        (self.count)(edges.len().checked_ilog2().unwrap_or(0));
        let below = |up: &u32| (self.level)(self.topology.origin(*up)) <= self.x;
        let last = edges[..edges.partition_point(below)].last();
        let found = last.filter(|&&up| (self.level)(self.topology.target(up)) > self.x);
        // If an edge is found, the caller counts its test.
        (self.count)(u32::from(found.is_none()));
        found.copied()
    }

    /// Finds an edge that crosses the level on a face with many sides, next to the edge `up`, which does not cross
    /// it. Returns `None` if neither face has many sides, or the search does not reach the level.
    pub(crate) fn crossing_along_faces(&self, up: u32) -> Option<u32> {
        let beside = [up, self.topology.half_edge(up).twin];
        beside.into_iter().find_map(|h| self.along_face(h))
    }

    /// Searches the boundary of a face with many sides, on which levels rise once and fall once. Steps towards the
    /// level double in length; bisection follows. Returns `None` if the face has few sides or the search does not
    /// reach the level.
    fn along_face(&self, from: u32) -> Option<u32> {
        let topology = self.topology;
        let face = topology.face_half_edges(topology.half_edge(from).face);
        let sides = face.len() as u32;
        if sides <= MAX_WALKED_SIDES {
            return None;
        }
        let level = |h: u32| (self.level)(topology.origin(h));
        let is_below = level(from) <= self.x;
        let next = topology.next(from);
        // Step in the direction in which levels approach `x`.
        let is_forward = (level(from) < level(next)) == is_below;
        let first = if is_forward { from } else { next };
        let at = |steps: u32| {
            let offset = if is_forward { steps } else { sides - steps };
            face.start + (first - face.start + offset) % sides
        };
        let is_past = |h: u32| (level(h) <= self.x) != is_below;
        let comes_nearer = |steps: u32| (level(at(steps)) < level(at(steps + 1))) == is_below;
        let is_ahead = |steps: u32| !is_past(at(steps)) && comes_nearer(steps);
        let (mut low, mut high) = (0, 1);
        while high < sides && is_ahead(high) {
            (self.count)(1);
            (low, high) = (high, (2 * high).min(sides));
        }
        while high - low > 1 {
            (self.count)(1);
            let middle = u32::midpoint(low, high);
            if is_ahead(middle) { low = middle } else { high = middle }
        }
        if high >= sides || !is_past(at(high)) {
            return None;
        }
        let edge = if is_forward { at(low) } else { at(high) };
        let is_up = level(edge) <= self.x;
        Some(if is_up { edge } else { topology.half_edge(edge).twin })
    }

    /// Returns the ranks of the faces behind and ahead of an edge.
    fn ranks_along(&self, up: u32, turn: Turn) -> [u32; 2] {
        let [left, right] = self.chains.adjacent_ranks(self.topology, up);
        match turn {
            Turn::CounterClockwise => [left, right],
            Turn::Clockwise => [right, left],
        }
    }

    /// Finds an edge that crosses the level, starting at an edge `up` that may cross another level. Returns `None`
    /// if rounding hides all candidates.
    pub(crate) fn any_crossing_edge(&self, up: u32) -> Option<u32> {
        let [face, _] = self.ranks_along(up, Turn::CounterClockwise);
        let faces = self.chains.ranks.len() as u32;
        let above = (0..=faces.ilog2()).map(|bits| (face >> bits | 1) << bits);
        let found =
            above.filter(|&node| node < faces).find_map(|node| self.crossing_edge_of_node(node));
        found.or_else(|| self.crossing_edge(&self.chains.cut))
    }

    /// Finds the last edge of the section from `start` on for which `holds` is true. It must be true for `start` and
    /// the edges after it up to some edge, and false for the remaining ones. Returns `None` if rounding hides an
    /// edge.
    pub(crate) fn last_while(
        &self,
        start: u32,
        turn: Turn,
        mut holds: impl FnMut(u32) -> bool,
    ) -> Option<u32> {
        let end = self.ranks_along(start, turn)[0];
        let mut last = start;
        let mut ahead = self.ranks_along(start, turn)[1];
        // Test larger and larger parts of the section, up to an edge for which the predicate is false.
        let mut behind = None;
        for bits in 0..=self.chains.ranks.len().ilog2() {
            let node = self.node_ahead(ahead, bits, turn);
            let Some(up) = node.and_then(|node| self.crossing_edge_of_node(node)) else { continue };
            if !holds(up) {
                behind = Some(self.ranks_along(up, turn)[0]);
                break;
            }
            last = up;
            ahead = self.ranks_along(up, turn)[1];
        }
        if behind.is_none() {
            // Continue across the cut, at most to where the search began.
            let cut = self.crossing_edge(&self.chains.cut)?;
            behind = Some(if cut == start {
                end
            } else if holds(cut) {
                last = cut;
                ahead = self.ranks_along(cut, turn)[1];
                end
            } else {
                self.ranks_along(cut, turn)[0]
            });
        }
        let mut behind = behind?;
        while ahead != behind {
            let up =
                self.crossing_edge_of_node(separating_node(ahead.min(behind), ahead.max(behind)))?;
            if holds(up) {
                last = up;
                ahead = self.ranks_along(up, turn)[1];
            } else {
                behind = self.ranks_along(up, turn)[0];
            }
        }
        Some(last)
    }

    /// Returns the node of height `bits` over a rank; `None` if it is not ahead of the rank.
    fn node_ahead(&self, rank: u32, bits: u32, turn: Turn) -> Option<u32> {
        let node = (rank >> bits | 1) << bits;
        let is_ahead = (rank >> bits & 1 == 0) == (turn == Turn::CounterClockwise);
        (is_ahead && (node as usize) < self.chains.ranks.len()).then_some(node)
    }
}
