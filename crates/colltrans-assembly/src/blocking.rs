//! The directional blocking graph of Wilson and Latombe ("Geometric reasoning about mechanical assembly", Artificial
//! Intelligence 71, 1994).
//!
//! Notation: an arc from `A` to `B` states that `A`, moving to infinity along `d`, collides with `B`. The *closure*
//! of `A` is the set of all parts that are reachable from it; they must move with `A`. The strongly connected
//! components are the smallest groups that move as one body. A component that no arc leaves can be removed along `d`.

use petgraph::algo::tarjan_scc;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::Dfs;

use crate::matrix::ContactMatrix;

/// The blocking graph of some parts along one direction.
#[derive(Debug, Clone)]
pub struct BlockingGraph {
    graph: DiGraph<usize, ()>,
    /// The node of each part, or `None` if the part is not in the graph.
    node: Vec<Option<NodeIndex>>,
}

impl BlockingGraph {
    /// Builds the graph of the parts in the mask `among` along a direction of the matrix.
    pub fn new(matrix: &ContactMatrix, direction: usize, among: &[bool]) -> Self {
        let arcs = matrix.contacts_along(direction).iter().map(|m| (m.moving, m.fixed));
        Self::from_arcs(arcs, among)
    }

    /// Builds the graph along a direction with additional arcs of order constraints.
    pub(crate) fn with_order(
        matrix: &ContactMatrix,
        direction: usize,
        order: &[(usize, usize)],
        among: &[bool],
    ) -> Self {
        let arcs = matrix.contacts_along(direction).iter().map(|m| (m.moving, m.fixed));
        Self::from_arcs(arcs.chain(order.iter().copied()), among)
    }

    /// Builds the graph with these arcs, of the parts in the mask `among`.
    pub fn from_arcs(arcs: impl IntoIterator<Item = (usize, usize)>, among: &[bool]) -> Self {
        let mut graph = DiGraph::new();
        let node: Vec<Option<NodeIndex>> = among
            .iter()
            .enumerate()
            .map(|(part, &takes_part)| takes_part.then(|| graph.add_node(part)))
            .collect();
        for (a, b) in arcs {
            if let (Some(a), Some(b)) = (node[a], node[b]) {
                graph.add_edge(a, b, ());
            }
        }
        Self { graph, node }
    }

    /// Returns the closure of a part, itself included, in increasing order. It is empty if the part is not in the
    /// graph.
    pub fn reachable_parts(&self, part: usize) -> Vec<usize> {
        let Some(start) = self.node[part] else { return Vec::new() };
        let mut search = Dfs::new(&self.graph, start);
        let mut reached = Vec::new();
        while let Some(node) = search.next(&self.graph) {
            reached.push(self.graph[node]);
        }
        reached.sort_unstable();
        reached
    }

    /// Returns the parts that block a part directly, in increasing order.
    pub fn direct_blockers(&self, part: usize) -> Vec<usize> {
        let Some(node) = self.node[part] else { return Vec::new() };
        let mut met: Vec<usize> = self.graph.neighbors(node).map(|n| self.graph[n]).collect();
        met.sort_unstable();
        met.dedup();
        met
    }

    /// Returns the strongly connected components, each in increasing order, sorted by their first parts.
    pub fn strong_components(&self) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = tarjan_scc(&self.graph)
            .into_iter()
            .map(|nodes| {
                let mut parts: Vec<usize> = nodes.into_iter().map(|n| self.graph[n]).collect();
                parts.sort_unstable();
                parts
            })
            .collect();
        groups.sort();
        groups
    }

    /// Returns the components that no arc leaves. Each can be removed.
    pub fn removable_groups(&self) -> Vec<Vec<usize>> {
        let mut group_of = vec![usize::MAX; self.node.len()];
        let groups = self.strong_components();
        for (k, group) in groups.iter().enumerate() {
            for &part in group {
                group_of[part] = k;
            }
        }
        let mut leaves = vec![false; groups.len()];
        for edge in self.graph.raw_edges() {
            let (a, b) = (self.graph[edge.source()], self.graph[edge.target()]);
            if group_of[a] != group_of[b] {
                leaves[group_of[a]] = true;
            }
        }
        groups.into_iter().zip(leaves).filter(|(_, l)| !l).map(|(group, _)| group).collect()
    }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;

    use super::*;

    fn random_arcs(n: usize, random: &mut Random) -> Vec<(usize, usize)> {
        let count = random.index(2 * n + 1);
        let arc = |_| (random.index(n), random.index(n));
        (0..count).map(arc).filter(|(a, b)| a != b).collect()
    }

    /// Returns all subsets of the parts that no arc leaves.
    fn closed_sets(n: usize, arcs: &[(usize, usize)], among: &[bool]) -> Vec<u32> {
        let alive: u32 = (0..n).filter(|&k| among[k]).map(|k| 1 << k).sum();
        let closed = |set: &u32| {
            let inside = |k: usize| set >> k & 1 == 1;
            set & !alive == 0 && arcs.iter().all(|&(a, b)| !inside(a) || inside(b) || !among[b])
        };
        (1..1_u32 << n).filter(closed).collect()
    }

    #[test]
    fn closures_and_removable_groups_equal_minimal_closed_subsets() {
        let mut random = Random::new(11);
        for _ in 0..500 {
            let n = 1 + random.index(8);
            let arcs = random_arcs(n, &mut random);
            let among: Vec<bool> = (0..n).map(|_| random.unit() < 0.8).collect();
            let graph = BlockingGraph::from_arcs(arcs.iter().copied(), &among);
            let closed = closed_sets(n, &arcs, &among);
            let set = |parts: &[usize]| parts.iter().map(|&k| 1_u32 << k).sum::<u32>();
            for part in (0..n).filter(|&k| among[k]) {
                let least =
                    closed.iter().filter(|s| *s >> part & 1 == 1).min_by_key(|s| s.count_ones());
                assert_eq!(Some(&set(&graph.reachable_parts(part))), least);
            }
            // Removable groups are the minimal closed sets.
            let minimal = |s: &&u32| !closed.iter().any(|t| t != *s && t & **s == *t);
            let mut expected: Vec<u32> = closed.iter().filter(minimal).copied().collect();
            let mut found: Vec<u32> = graph.removable_groups().iter().map(|g| set(g)).collect();
            expected.sort_unstable();
            found.sort_unstable();
            assert_eq!(found, expected);
        }
    }
}
