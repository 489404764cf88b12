//! Two bodies that joints carry, between two consecutive rows: poses and bounds for the search and the check.
//!
//! Both bodies are in the frame that their chains start in. For points `p`, `q` of the bodies, `g = n.q - n.p` with a
//! normal `n` that is linear in time. A bound `C >= g''` over all points gives
//! `g(x) >= (1 - x) g(0) + x g(1) - C x (1 - x) / 2`. Derivatives are by the row; `h` is the length of the interval. Derivation:
//! `docs/theory/motion-bounds.md`.
//!
//! - *Loose* bound: `C_P = h^2 max |p''| + 2 h |dn| max |p'|`.
//! - *Tight* bound: the mean of the maxima of `g''` at both ends, which are support points, plus half of its possible
//!   change `h^3 max |n.p'''| + 3 h^2 |dn| max |p''|`.
//! - *Distances*: two gaps prove all times between them, over any number of rows, if the bodies together move by less
//!   than the sum of the gaps.

use glam::DVec3;

use super::super::curvature::SupportSearch;
use super::super::relative_motion::RelativeMotion;
use super::super::span::Instant;
use super::chain::{BOUND_FACTOR, Chain, DerivativeBounds, PointRates};
use super::mechanism::{JointPath, PathPlace};
use colltrans_convex::body::{ConvexPolyhedron, Placed};
use colltrans_convex::setting::TwoBodies;
use colltrans_kernel::noise;
use colltrans_solid::body::Solid;

/// Ratio of the bound of the third derivative along a normal to the bound in all directions, below which the former is
/// used. Points then move almost parallel to a plane.
const FLAT_RATIO: f64 = 1e-2;

/// Two bodies and the joints that carry them.
#[derive(Debug)]
pub(super) struct LinkPair<'a> {
    pub(super) path: &'a JointPath,
    pub(super) chains: [Chain; 2],
    /// Upper bounds of the distance that both bodies together move, from the first row to each row.
    travel: Vec<f64>,
    /// Minimum gap, in world units.
    pub(super) min_gap: f64,
}

impl<'a> LinkPair<'a> {
    /// Computes the distances that the bodies move between rows.
    pub(super) fn new(path: &'a JointPath, chains: [Chain; 2], min_gap: f64) -> Self {
        let mut travel = vec![0.0];
        for row in 0..path.last_row() {
            let distance: f64 = chains.iter().map(|chain| chain.travel_bound(path, row)).sum();
            travel.push((travel[row] + distance).next_up());
        }
        Self { path, chains, travel, min_gap }
    }

    /// Returns an upper bound of the distance that both bodies together move from the start to a place.
    pub(super) fn travel_to(&self, place: PathPlace) -> f64 {
        let current = self.travel[place.row];
        let next = self.travel.get(place.row + 1).unwrap_or(&current);
        current + place.share * (next - current)
    }

    /// Checks whether gaps at two places prove all places between them.
    pub(super) fn gaps_prove_between(&self, places: [PathPlace; 2], gaps: [f64; 2]) -> bool {
        if places[0].normalised() == places[1].normalised() {
            return true;
        }
        let [a, b] = places.map(|place| self.travel_to(place));
        (b - a) * BOUND_FACTOR + 4.0 * f64::EPSILON * b < gaps[0] + gaps[1]
    }

    /// Returns the last place, not after `until`, up to which both bodies together move by at most about `length`.
    pub(super) fn place_within(&self, from: PathPlace, until: PathPlace, length: f64) -> PathPlace {
        let most = self.travel_to(from) + length;
        if self.travel_to(until) <= most {
            return until;
        }
        let row = self.travel.partition_point(|distance| *distance <= most).saturating_sub(1);
        let (current, next) =
            (self.travel[row], self.travel.get(row + 1).unwrap_or(&f64::INFINITY));
        let share = ((most - current) / (next - current)).clamp(0.0, 1.0);
        PathPlace { row, share }.normalised()
    }

    /// Returns both solids at a place, and the error bound of computed places of one relative to the other.
    pub(super) fn place_solids<'s>(
        &self,
        [moving, fixed]: [&'s Solid; 2],
        place: PathPlace,
    ) -> (TwoBodies<'s, Solid>, f64) {
        let [p, q] = self
            .chains
            .each_ref()
            .map(|chain| chain.pose_and_rates(self.path, place.row, place.share).0);
        let bodies =
            TwoBodies::new(Placed { body: moving, pose: p }, Placed { body: fixed, pose: q });
        let off = bodies.noise().point_error() + self.chains[0].error + self.chains[1].error;
        (bodies, off)
    }

    /// Returns the motion of two pieces of the bodies between two rows.
    pub(super) fn segment_motion<'p>(
        &'p self,
        pieces: [&'p ConvexPolyhedron; 2],
        row: usize,
        times: [f64; 2],
    ) -> WaypointSegment<'p> {
        let derivative_bounds =
            self.chains.each_ref().map(|chain| chain.derivative_bounds(self.path, row));
        let left_out = pieces.map(ConvexPolyhedron::hull_error).iter().sum::<f64>();
        let error = self.chains[0].error
            + self.chains[1].error
            + left_out
            + noise::FLUSHED_POSE_COORDINATES;
        WaypointSegment {
            path: self.path,
            chains: &self.chains,
            pieces,
            row,
            times,
            derivative_bounds,
            error,
            min_gap: self.min_gap,
        }
    }
}

/// Motion of two pieces between two consecutive rows, or in a part of this interval.
#[derive(Debug)]
pub(super) struct WaypointSegment<'p> {
    path: &'p JointPath,
    chains: &'p [Chain; 2],
    pieces: [&'p ConvexPolyhedron; 2],
    row: usize,
    times: [f64; 2],
    derivative_bounds: [DerivativeBounds; 2],
    error: f64,
    min_gap: f64,
}

impl<'p> RelativeMotion<'p> for WaypointSegment<'p> {
    type Body = ConvexPolyhedron;
    type Moved = [PointRates; 2];

    fn time_range(&self) -> [f64; 2] {
        self.times
    }

    fn position_error(&self) -> f64 {
        self.error
    }

    fn min_gap(&self) -> f64 {
        self.min_gap
    }

    /// Returns the proven gap, because the position error includes the distance of input points from the pieces.
    fn claimed_gap(&self, at: &Instant<'p, [PointRates; 2]>, normal: DVec3) -> f64 {
        self.proven_gap(at, normal)
    }

    fn instant_at(&self, time: f64) -> Instant<'p, [PointRates; 2]> {
        let [p, q] =
            self.chains.each_ref().map(|chain| chain.pose_and_rates(self.path, self.row, time));
        let [moving, fixed] = self.pieces;
        let bodies =
            TwoBodies::new(Placed { body: moving, pose: p.0 }, Placed { body: fixed, pose: q.0 });
        Instant { time, bodies, moved: [p.1, q.1] }
    }

    fn point_velocity(
        &self,
        at: &Instant<'p, [PointRates; 2]>,
        which: usize,
        point: DVec3,
    ) -> DVec3 {
        let placed = [at.bodies.moving_placed(), at.bodies.fixed_placed()][which];
        let PointRates { v, w, .. } = at.moved[which];
        v + w.cross(placed.pose.transform_point(point))
    }

    fn curvature_bound(
        &self,
        ends: [&Instant<'p, [PointRates; 2]>; 2],
        normals: [DVec3; 2],
        enough: f64,
        supports: &impl SupportSearch<ConvexPolyhedron>,
    ) -> f64 {
        let h = ends[1].time - ends[0].time;
        let loose = |which: usize| loose_bound(&self.derivative_bounds[which], h, normals);
        let found = loose(0) + loose(1);
        if found <= enough {
            return found;
        }
        let tight = |which: usize| {
            let curvatures =
                [0, 1].map(|end| max_curvature_at(ends[end], which, h, normals, end, supports));
            let (most, across) =
                (&self.derivative_bounds[which], (normals[1] - normals[0]).length());
            let [_, second, third] = most.derivatives;
            let along = self.chains[which].third_along(self.path, self.row, normals);
            // A bound that is only slightly better does not justify different steps.
            let third = if along < FLAT_RATIO * third { along } else { third };
            let changes = h * h * (h * third + 3.0 * across * second);
            let off = h * (h * most.off[1] + 2.0 * across * most.off[0]);
            (0.5 * (curvatures[0] + curvatures[1] + changes) + off).min(loose(which))
        };
        tight(0) + tight(1)
    }

    fn typical_curvature(&self) -> f64 {
        self.derivative_bounds[0].derivatives[1] + self.derivative_bounds[1].derivatives[1]
    }

    fn arc_vertex_count(&self) -> usize {
        0
    }

    fn gap_loss(&self, _: [&Instant<'p, [PointRates; 2]>; 2], _: DVec3) -> f64 {
        f64::INFINITY
    }
}

/// Returns the loose part of `C` of one body.
fn loose_bound(most: &DerivativeBounds, h: f64, normals: [DVec3; 2]) -> f64 {
    let [first, second, _] = most.derivatives;
    h * (h * second + 2.0 * (normals[1] - normals[0]).length() * first) * BOUND_FACTOR
}

/// Returns the maximum of `g''` over the points of one body at an end of an interval.
fn max_curvature_at(
    at: &Instant<[PointRates; 2]>,
    which: usize,
    h: f64,
    normals: [DVec3; 2],
    end: usize,
    supports: &impl SupportSearch<ConvexPolyhedron>,
) -> f64 {
    let sign = if which == 0 { -1.0 } else { 1.0 };
    let (n, dn) = (normals[end] * (h * h * sign), (normals[1] - normals[0]) * (2.0 * h * sign));
    let PointRates { v, w, a, matrix } = at.moved[which];
    // dn.(w x p) = (dn x w).p
    let along = matrix.transpose() * n + dn.cross(w);
    let placed = [at.bodies.moving_placed(), at.bodies.fixed_placed()][which];
    let own = placed.pose.matrix().transpose() * along;
    n.dot(a)
        + dn.dot(v)
        + along.dot(placed.pose.translation())
        + supports.support_bound(placed.body, own)
}
