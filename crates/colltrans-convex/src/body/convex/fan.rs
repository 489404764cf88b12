//! Vertices with many neighbours, as the apex of a cone.
//!
//! Cut by a plane, the edges of such a vertex are the corners of a convex polygon, a [`Ring`], over which the
//! slope along a direction, a linear function, has one maximum and one minimum.
//!
//! A proof has to know all neighbours above some level. Of a convex polygon these are next to each other, and nothing has
//! to be known of the others; as corners are rounded, up to the polygon's *dent*.

use glam::DVec3;

use super::ring::{Cycle, Ring};
use colltrans_kernel::noise;
use colltrans_kernel::topology::Topology;
use colltrans_kernel::work;

/// A vertex with more neighbours than this is searched, not scanned; a face with more corners has a ring.
pub(crate) const FAN: usize = 32;

/// A face with more corners is measured at three.
pub(super) const MAX_UNMEASURED_CORNERS: usize = 8;

/// By how much slopes that are compared may be off together, in `GAIN` times the square of what edges are longer than
/// inwards; and what is gained over the least length inwards, in `GAIN reach` over that.
const SLOPE_DOUBT: f64 = 8.0;

#[derive(Debug, Clone)]
pub(super) struct Fan {
    pub(super) vertex: u32,
    /// A unit vector that has a positive product with all edges.
    inward: DVec3,
    /// The least of these.
    least: f64,
    /// The length of the longest edge.
    longest: f64,
    ring: Ring,
    /// How far from convex the polygon may be: by so much slopes may rise once they fall, times the normal's length.
    dent: f64,
    /// The faces with many corners around the vertex.
    wide: Vec<u32>,
}

/// What is asked for: neighbours more than `least` above a place along a normal of this length.
pub(super) struct AboveQuery {
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
        let inward = inward.normalize_or_zero();
        let least = edges().map(|edge| inward.dot(edge)).fold(f64::INFINITY, f64::min);
        let longest = edges().map(DVec3::length).fold(0.0, f64::max);
        let cut = edges().map(|edge| edge / inward.dot(edge));
        let corners = neighbours.iter().map(|&w| vertices[w as usize]);
        let (ring, dent) = Ring::new((Cycle::Fan(vertex), neighbours[0]), inward, corners, cut);
        let dent = if least > 0.0 { dent } else { f64::INFINITY };
        let faces = topology.outgoing(vertex).iter().map(|&h| topology.half_edge(h).face);
        let wide =
            faces.filter(|&face| topology.face(face).len() > MAX_UNMEASURED_CORNERS).collect();
        Self { vertex, inward, least, longest, ring, dent, wide }
    }

    pub(super) fn ring(&self) -> &Ring {
        &self.ring
    }

    /// The faces around the vertex with more than [`MANY`] corners.
    pub(super) fn wide_faces(&self) -> &[u32] {
        &self.wide
    }

    /// Position among the neighbours of the steepest edge along a direction.
    pub(super) fn steepest_edge(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
    ) -> usize {
        let slope = self.slope_function(vertices, topology, direction);
        let near = self.ring.first_candidate(direction) as usize;
        greatest_near(topology.neighbours(self.vertex).len(), near, slope)
    }

    /// How steep edges are along a direction: what they rise over their lengths inwards.
    #[inline]
    fn slope_function<'a>(
        &'a self,
        vertices: &'a [DVec3],
        topology: &'a Topology,
        direction: DVec3,
    ) -> impl Fn(usize) -> f64 + 'a {
        let neighbours = topology.neighbours(self.vertex);
        let here = vertices[self.vertex as usize];
        move |k| {
            let edge = vertices[neighbours[k] as usize] - here;
            direction.dot(edge) / self.inward.dot(edge)
        }
    }

    /// Looks at all neighbours that are asked for, and at some others, until a look says `false`.
    ///
    /// From the steepest edge on to either side, until one is less steep than that and than any asked for: those
    /// beyond are less steep still, up to what is in doubt.
    pub(super) fn visit_above(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        above: &AboveQuery,
        visit: &mut impl FnMut(u32) -> bool,
    ) -> bool {
        let neighbours = topology.neighbours(self.vertex);
        let slope = self.slope_function(vertices, topology, above.normal);
        let steepest = self.steepest_edge(vertices, topology, above.normal);
        let min_gain = above.least - above.normal.dot(vertices[self.vertex as usize] - above.here);
        // Lengths inwards are rounded, too.
        let aspect = self.longest / self.least;
        let rounding = SLOPE_DOUBT * noise::GAIN * (above.reach / self.least + aspect * aspect);
        let doubt = above.length * (rounding + self.dent);
        let stop_slope = slope(steepest).min(min_gain.min(0.0) / self.least) - doubt;
        let count = neighbours.len();
        let (mut goes_on, mut visited) = (visit(neighbours[steepest]), 1);
        for step in [1, count - 1] {
            let mut k = steepest;
            while goes_on && visited < count {
                k = wrapped_index(k + step, count);
                goes_on = visit(neighbours[k]);
                visited += 1;
                if slope(k) < stop_slope {
                    break;
                }
            }
        }
        work::count(visited);
        goes_on
    }

    /// Bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        self.ring.heap_bytes() + self.wide.capacity() * size_of::<u32>()
    }
}

/// Where a function on a cycle with one maximum and one minimum is greatest, from near there.
///
/// On to the side that leads up, with strides that grow as long as they do; then between the two that are lower.
#[inline]
pub(crate) fn greatest_near(count: usize, near: usize, value: impl Fn(usize) -> f64) -> usize {
    let mut best = (near, value(near));
    work::count(1);
    let mut rises = |step: usize| {
        work::count(1);
        let there = wrapped_index(best.0 + step, count);
        let value = value(there);
        let higher = value > best.1;
        if higher {
            best = (there, value);
        }
        higher
    };
    let ahead = rises(1);
    if ahead || rises(count - 1) {
        let step = |stride: usize| if ahead { stride } else { count - stride };
        let mut stride = 1;
        while rises(step(stride)) {
            stride *= if 4 * stride <= count { 2 } else { 1 };
        }
        while stride > 1 {
            stride /= 2;
            let _ = rises(step(stride)) || rises(count - step(stride));
        }
    }
    best.0
}

/// A place on a cycle, counted on over its end at most once.
#[inline]
fn wrapped_index(i: usize, count: usize) -> usize {
    if i >= count { i - count } else { i }
}
