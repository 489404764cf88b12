//! Vertices with many neighbours, for example the apex of a cone.
//!
//! A plane that cuts all edges of such a vertex cuts them in the corners of a convex polygon, a [`Ring`]. The slope
//! of the edges along a direction is a linear function on this polygon, with one maximum and one minimum.
//!
//! Proofs need all neighbours above some level. On a convex polygon these are consecutive, so the other neighbours
//! need not be visited. For rounded corners this holds up to the polygon's *dent*. Derivation:
//! `docs/theory/supports.md`.

use glam::DVec3;

use super::ring::{Cycle, Ring};
use colltrans_kernel::noise;
use colltrans_kernel::topology::Topology;
use colltrans_kernel::visit_counter;

/// Maximum number of neighbours of a vertex that is scanned; a vertex with more is searched as a [`Fan`]. Faces
/// with more corners have a ring.
pub(crate) const MAX_SCANNED_NEIGHBOURS: usize = 32;

/// Number of corners of a face above which the face is measured at three corners only.
pub(super) const MAX_UNMEASURED_CORNERS: usize = 8;

/// Factor of the bound of the rounding error of two compared slopes, which is
/// `GAIN (reach / least + (longest / least)^2)`.
const SLOPE_DOUBT: f64 = 8.0;

/// A vertex with many neighbours, with the ring of its neighbours.
#[derive(Debug, Clone)]
pub(super) struct Fan {
    pub(super) vertex: u32,
    /// A unit vector that has a positive product with all edges, unless `dent` is infinite.
    inward: DVec3,
    /// The smallest product of an edge with `inward`.
    least: f64,
    /// The length of the longest edge.
    longest: f64,
    ring: Ring,
    /// Bound of the polygon's deviation from convexity: the amount by which slopes may rise after they have begun to
    /// fall, relative to the normal's length.
    dent: f64,
    /// Faces around the vertex with more than [`MAX_UNMEASURED_CORNERS`] corners.
    wide: Vec<u32>,
}

/// Query for the neighbours whose product with `normal` exceeds that of the point `here` by more than `least`, which
/// may be negative. `length` is the length of `normal`, which is not normalised.
pub(super) struct AboveQuery {
    pub(super) normal: DVec3,
    pub(super) length: f64,
    pub(super) here: DVec3,
    pub(super) least: f64,
    /// The largest distance of a vertex from the origin of the body frame.
    pub(super) reach: f64,
}

impl Fan {
    pub(super) fn new(vertices: &[DVec3], topology: &Topology, vertex: u32) -> Self {
        let here = vertices[vertex as usize];
        let neighbours = topology.neighbours(vertex);
        let edges = || neighbours.iter().map(|&w| vertices[w as usize] - here);
        // Neighbours are clockwise as seen from outside. Therefore the product of two consecutive edges points
        // inwards.
        let consecutive = edges().zip(edges().cycle().skip(1));
        let inward = consecutive.map(|(a, b)| a.cross(b).normalize_or_zero()).sum::<DVec3>();
        let inward = inward.normalize_or_zero();
        let least = edges().map(|edge| inward.dot(edge)).fold(f64::INFINITY, f64::min);
        let longest = edges().map(DVec3::length).fold(0.0, f64::max);
        let cut = edges().map(|edge| edge / inward.dot(edge));
        let corners = neighbours.iter().map(|&w| vertices[w as usize]);
        let (ring, dent) = Ring::new((Cycle::Fan(vertex), neighbours[0]), inward, corners, cut);
        let dent = if least > 0.0 { dent } else { f64::INFINITY };
        let faces =
            topology.outgoing_half_edges(vertex).iter().map(|&h| topology.half_edge(h).face);
        let wide = faces
            .filter(|&face| topology.face_half_edges(face).len() > MAX_UNMEASURED_CORNERS)
            .collect();
        Self { vertex, inward, least, longest, ring, dent, wide }
    }

    pub(super) fn ring(&self) -> &Ring {
        &self.ring
    }

    /// Returns the faces around the vertex with more than [`MAX_UNMEASURED_CORNERS`] corners.
    pub(super) fn wide_faces(&self) -> &[u32] {
        &self.wide
    }

    /// Finds the steepest edge along `direction`, as a position among the neighbours.
    pub(super) fn steepest_edge_position(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
    ) -> usize {
        let slope = self.slope_function(vertices, topology, direction);
        let near = self.ring.first_candidate(direction) as usize;
        cyclic_maximum(topology.neighbours(self.vertex).len(), near, slope)
    }

    /// Returns the function that computes the slope of an edge along `direction`: its gain along `direction` divided
    /// by its length along `inward`.
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

    /// Visits all neighbours that a query selects, and possibly others, until `visit` returns `false`. Returns
    /// whether all visits returned `true`.
    ///
    /// The visits begin at the steepest edge and proceed to either side. A side ends at a slope that is lower, by
    /// more than the error bound, than both the steepest slope and any slope that the query selects. All slopes
    /// beyond are lower still, up to this error.
    pub(super) fn visit_above(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        above: &AboveQuery,
        visit: &mut impl FnMut(u32) -> bool,
    ) -> bool {
        let neighbours = topology.neighbours(self.vertex);
        let slope = self.slope_function(vertices, topology, above.normal);
        let steepest = self.steepest_edge_position(vertices, topology, above.normal);
        let min_gain = above.least - above.normal.dot(vertices[self.vertex as usize] - above.here);
        // Lengths along `inward` are rounded, too.
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
        visit_counter::count_visits(visited);
        goes_on
    }

    /// Returns the number of bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        self.ring.heap_bytes() + self.wide.capacity() * size_of::<u32>()
    }
}

/// Finds the position of the maximum of a function on a cycle of `count` positions, starting at `near`. The
/// function must have one maximum and one minimum.
///
/// The search proceeds uphill with strides that double while the value increases. Then it halves the stride and
/// tests both sides.
#[inline]
pub(crate) fn cyclic_maximum(count: usize, near: usize, value: impl Fn(usize) -> f64) -> usize {
    let mut best = (near, value(near));
    visit_counter::count_visits(1);
    let mut rises = |step: usize| {
        visit_counter::count_visits(1);
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

/// Returns a position on a cycle, which may be given beyond its end, by less than one round.
#[inline]
fn wrapped_index(i: usize, count: usize) -> usize {
    if i >= count { i - count } else { i }
}
