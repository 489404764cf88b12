//! Vertices with many neighbours, as the apex of a cone.
//!
//! Cut by a plane, the edges of such a vertex are the corners of a convex polygon, a [`Ring`], over which the
//! slope along a direction, a linear function, has one maximum and one minimum.
//!
//! A proof has to know all neighbours above some level, and may not trust in that, as corners are rounded.
//! So neighbours are taken in blocks of 8, 16, 32, ...: none of a block is farther from the segment between its
//! ends than the block's *bulge*, so none is higher than the higher end by more than that.

use glam::DVec3;

use super::excess::MANY;
use super::ring::{Cycle, Ring};
use crate::body::topology::Topology;
use crate::number::noise;
use crate::work;

/// Neighbours in the smallest block.
const BLOCK: usize = 8;

/// Blocks of the largest size, about.
const FEW: usize = 4;

/// By how much the heights and distances that are compared may be off together, in `GAIN reach`.
const DOUBT: f64 = 8.0;

#[derive(Debug, Clone)]
pub(super) struct Fan {
    pub(super) vertex: u32,
    /// It has a positive product with all edges.
    inward: DVec3,
    ring: Ring,
    /// The faces with many corners around the vertex.
    wide: Vec<u32>,
    /// The bulges of all blocks of each size, the smallest first.
    bulges: Vec<Vec<f64>>,
}

/// What is asked for: neighbours more than `least` above a place along a normal of this length.
pub(super) struct Above {
    pub(super) normal: DVec3,
    pub(super) length: f64,
    pub(super) here: DVec3,
    pub(super) least: f64,
    /// The body's reach.
    pub(super) reach: f64,
}

impl Fan {
    pub(super) fn new(vertices: &[DVec3], topology: &Topology, vertex: u32) -> Self {
        let here = vertices[vertex as usize];
        let neighbours = topology.neighbours(vertex);
        let edges = || neighbours.iter().map(|&w| vertices[w as usize] - here);
        // Neighbours are clockwise from outside, so the product of two consecutive edges points inwards.
        let consecutive = edges().zip(edges().cycle().skip(1));
        let inward = consecutive.map(|(a, b)| a.cross(b).normalize_or_zero()).sum::<DVec3>();
        let cut = edges().map(|edge| edge / inward.dot(edge));
        let corners = neighbours.iter().map(|&w| vertices[w as usize]);
        let ring = Ring::new(Cycle::Fan(vertex), inward, corners, cut);
        let faces = topology.outgoing(vertex).iter().map(|&h| topology.half_edge(h).face);
        let wide = faces.filter(|&face| topology.face(face).len() > MANY).collect();
        let mut bulges = Vec::new();
        let mut size = BLOCK;
        loop {
            bulges.push(bulges_of(vertices, neighbours, size));
            if neighbours.len() <= FEW * size {
                return Self { vertex, inward, ring, wide, bulges };
            }
            size *= 2;
        }
    }

    pub(super) fn ring(&self) -> &Ring {
        &self.ring
    }

    /// The faces around the vertex with more than [`MANY`] corners.
    pub(super) fn wide(&self) -> &[u32] {
        &self.wide
    }

    /// Position among the neighbours of the steepest edge along a direction.
    pub(super) fn steepest(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
    ) -> usize {
        let here = vertices[self.vertex as usize];
        let neighbours = topology.neighbours(self.vertex);
        let slope = |k: usize| {
            let edge = vertices[neighbours[k] as usize] - here;
            direction.dot(edge) / self.inward.dot(edge)
        };
        let rises = |from: u32, to: u32| slope(to as usize) > slope(from as usize);
        let found = self.ring.farthest(direction, rises) as usize;
        let count = neighbours.len();
        let beside = [found + 1, found + count - 1].map(|k| slope(k % count));
        if beside.into_iter().all(|other| other <= slope(found)) {
            found
        } else {
            greatest_on_cycle(count, slope)
        }
    }

    /// Looks at all neighbours that are asked for, and at some others, until a look says `false`.
    pub(super) fn look_above(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        above: &Above,
        look: &mut impl FnMut(u32) -> bool,
    ) -> bool {
        let top = self.bulges.len() - 1;
        let neighbours = topology.neighbours(self.vertex);
        (0..self.bulges[top].len())
            .all(|block| self.look_in(vertices, neighbours, above, [top, block], look))
    }

    fn look_in(
        &self,
        vertices: &[DVec3],
        neighbours: &[u32],
        above: &Above,
        [level, block]: [usize; 2],
        look: &mut impl FnMut(u32) -> bool,
    ) -> bool {
        work::count(1);
        let count = neighbours.len();
        let size = BLOCK << level;
        let (from, to) = (block * size, ((block + 1) * size).min(count));
        let gain =
            |k: usize| above.normal.dot(vertices[neighbours[k % count] as usize] - above.here);
        let beyond = self.bulges[level][block] + DOUBT * noise::GAIN * above.reach;
        if gain(from).max(gain(to)) + beyond * above.length <= above.least {
            return true;
        }
        if level == 0 {
            return neighbours[from..to].iter().all(|&w| look(w));
        }
        let halves = [2 * block, 2 * block + 1];
        halves
            .into_iter()
            .filter(|&half| half < self.bulges[level - 1].len())
            .all(|half| self.look_in(vertices, neighbours, above, [level - 1, half], look))
    }

    /// Bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        let blocks = self.bulges.iter().map(Vec::capacity).sum::<usize>();
        let wide = self.wide.capacity() * size_of::<u32>();
        let levels = self.bulges.capacity() * size_of::<Vec<f64>>();
        self.ring.heap_bytes() + wide + levels + blocks * size_of::<f64>()
    }
}

/// For each block of consecutive neighbours the largest distance of one from the segment between the first and
/// the one after the last.
fn bulges_of(vertices: &[DVec3], neighbours: &[u32], size: usize) -> Vec<f64> {
    let at = |k: usize| vertices[neighbours[k % neighbours.len()] as usize];
    let bulge = |from: usize| {
        let to = (from + size).min(neighbours.len());
        let (a, way) = (at(from), at(to) - at(from));
        let square = way.length_squared();
        let distance = |k: usize| {
            let off = at(k) - a;
            let share = if square > 0.0 { (off.dot(way) / square).clamp(0.0, 1.0) } else { 0.0 };
            (off - way * share).length()
        };
        (from..to).map(distance).fold(0.0, f64::max)
    };
    (0..neighbours.len()).step_by(size).map(bulge).collect()
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
