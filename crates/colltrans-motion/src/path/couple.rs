//! Two bodies that joints carry, from a row to the next one: what a search and a check ask of them.
//!
//! Notation. As [`bend`](super::super::bend) and [`chain`](super::chain). Both are in the frame that their chains
//! begin in. For a point of either, carried by its chain, let `g = n.q - n.p` with the linear law of normals `n(x)`;
//! then `g'' = n.(q'' - p'') + 2 dn.(q' - p')`, and `g(x) >= (1 - x) g(0) + x g(1) - C x (1 - x) / 2` if `C` is at
//! least `g''` throughout, for all points of both. All derivatives are by `x`, so those by rows are multiplied by
//! the interval's length `h`.
//!
//! - *Loose.* `C_P = h^2 max |p''| + 2 h |dn| max |p'|`.
//! - *Tight.* `g''` is affine in the point, so its largest at either end is a support point away; and in between it
//!   is at most the mean of both and half of what it may change by, `h^3 max |n.p'''| + 3 h^2 |dn| max |p''|`.
//!
//! - *Far.* A distance changes by no more than points move: two gaps prove all times between them, over any number
//!   of rows, if the bodies' ways together are less than their sum.

use glam::DVec3;

use super::super::bend::Supports;
use super::super::course::Course;
use super::super::span::Instant;
use super::chain::{Chain, Most, RAISED, Rates};
use super::mechanism::{JointPath, Place};
use colltrans_convex::body::{ConvexPolyhedron, Placed};
use colltrans_convex::setting::TwoBodies;
use colltrans_kernel::noise;
use colltrans_solid::body::Solid;

/// Points move along a normal by less than this share of how they move where they slide over a plane, nearly.
const FLAT: f64 = 1e-2;

/// Two bodies and the joints that carry them.
#[derive(Debug)]
pub(super) struct Couple<'a> {
    pub(super) path: &'a JointPath,
    pub(super) chains: [Chain; 2],
    /// How far both together may move from the first row to each.
    ways: Vec<f64>,
    /// The gap to be kept.
    pub(super) keep: f64,
}

impl<'a> Couple<'a> {
    pub(super) fn new(path: &'a JointPath, chains: [Chain; 2], keep: f64) -> Self {
        let mut ways = vec![0.0];
        for row in 0..path.last() {
            let way: f64 = chains.iter().map(|chain| chain.way(path, row)).sum();
            ways.push((ways[row] + way).next_up());
        }
        Self { path, chains, ways, keep }
    }

    /// How far both together may move from the beginning to a place.
    pub(super) fn way_to(&self, place: Place) -> f64 {
        let here = self.ways[place.row];
        let next = self.ways.get(place.row + 1).unwrap_or(&here);
        here + place.share * (next - here)
    }

    /// Whether gaps at two places prove all between them.
    pub(super) fn is_near(&self, places: [Place; 2], gaps: [f64; 2]) -> bool {
        if places[0].settled() == places[1].settled() {
            return true;
        }
        let [a, b] = places.map(|place| self.way_to(place));
        (b - a) * RAISED + 4.0 * f64::EPSILON * b < gaps[0] + gaps[1]
    }

    /// The place, not after the end, up to which both move by such a length, or hardly less.
    pub(super) fn within(&self, from: Place, until: Place, length: f64) -> Place {
        let most = self.way_to(from) + length;
        if self.way_to(until) <= most {
            return until;
        }
        let row = self.ways.partition_point(|way| *way <= most).saturating_sub(1);
        let (here, next) = (self.ways[row], self.ways.get(row + 1).unwrap_or(&f64::INFINITY));
        let share = ((most - here) / (next - here)).clamp(0.0, 1.0);
        Place { row, share }.settled()
    }

    /// Both at a place, as solids, and how far computed places of them may be off each other.
    pub(super) fn solids<'s>(
        &self,
        [moving, fixed]: [&'s Solid; 2],
        place: Place,
    ) -> (TwoBodies<'s, Solid>, f64) {
        let [p, q] =
            self.chains.each_ref().map(|chain| chain.at(self.path, place.row, place.share).0);
        let bodies =
            TwoBodies::new(Placed { body: moving, pose: p }, Placed { body: fixed, pose: q });
        let off = bodies.noise().point() + self.chains[0].error + self.chains[1].error;
        (bodies, off)
    }

    /// Pieces of the bodies from a row to the next one.
    pub(super) fn course<'p>(
        &'p self,
        pieces: [&'p ConvexPolyhedron; 2],
        row: usize,
        times: [f64; 2],
    ) -> RowCourse<'p> {
        let most = self.chains.each_ref().map(|chain| chain.most(self.path, row));
        let left_out = pieces.map(ConvexPolyhedron::hull_error).iter().sum::<f64>();
        let error = self.chains[0].error + self.chains[1].error + left_out + noise::FLUSHED;
        RowCourse {
            path: self.path,
            chains: &self.chains,
            pieces,
            row,
            times,
            most,
            error,
            keep: self.keep,
        }
    }
}

/// Pieces of two bodies from a row to the next one, or for a part of it.
#[derive(Debug)]
pub(super) struct RowCourse<'p> {
    path: &'p JointPath,
    chains: &'p [Chain; 2],
    pieces: [&'p ConvexPolyhedron; 2],
    row: usize,
    times: [f64; 2],
    most: [Most; 2],
    error: f64,
    keep: f64,
}

impl<'p> Course<'p> for RowCourse<'p> {
    type Body = ConvexPolyhedron;
    type Moved = [Rates; 2];

    fn times(&self) -> [f64; 2] {
        self.times
    }

    fn error(&self) -> f64 {
        self.error
    }

    fn keep(&self) -> f64 {
        self.keep
    }

    /// Its error counts already what the inputs may reach beyond the pieces.
    fn claimed_gap(&self, at: &Instant<'p, [Rates; 2]>, normal: DVec3) -> f64 {
        self.proven_gap(at, normal)
    }

    fn instant(&self, time: f64) -> Instant<'p, [Rates; 2]> {
        let [p, q] = self.chains.each_ref().map(|chain| chain.at(self.path, self.row, time));
        let [moving, fixed] = self.pieces;
        let bodies =
            TwoBodies::new(Placed { body: moving, pose: p.0 }, Placed { body: fixed, pose: q.0 });
        Instant { time, bodies, moved: [p.1, q.1] }
    }

    fn velocity(&self, at: &Instant<'p, [Rates; 2]>, which: usize, point: DVec3) -> DVec3 {
        let placed = [at.bodies.moving_placed(), at.bodies.fixed_placed()][which];
        let Rates { v, w, .. } = at.moved[which];
        v + w.cross(placed.pose.transform_point(point))
    }

    fn bend(
        &self,
        ends: [&Instant<'p, [Rates; 2]>; 2],
        normals: [DVec3; 2],
        enough: f64,
        supports: &impl Supports<ConvexPolyhedron>,
    ) -> f64 {
        let h = ends[1].time - ends[0].time;
        let loose = |which: usize| loose(&self.most[which], h, normals);
        let found = loose(0) + loose(1);
        if found <= enough {
            return found;
        }
        let tight = |which: usize| {
            let bends = [0, 1].map(|end| bend_at(ends[end], which, h, normals, end, supports));
            let (most, across) = (&self.most[which], (normals[1] - normals[0]).length());
            let [_, second, third] = most.derivatives;
            let along = self.chains[which].third_along(self.path, self.row, normals);
            // A bound that is hardly better is not worth other steps.
            let third = if along < FLAT * third { along } else { third };
            let changes = h * h * (h * third + 3.0 * across * second);
            let off = h * (h * most.off[1] + 2.0 * across * most.off[0]);
            (0.5 * (bends[0] + bends[1] + changes) + off).min(loose(which))
        };
        tight(0) + tight(1)
    }

    fn usual(&self) -> f64 {
        self.most[0].derivatives[1] + self.most[1].derivatives[1]
    }

    fn arcs(&self) -> usize {
        0
    }

    fn lost(&self, _: [&Instant<'p, [Rates; 2]>; 2], _: DVec3) -> f64 {
        f64::INFINITY
    }
}

fn loose(most: &Most, h: f64, normals: [DVec3; 2]) -> f64 {
    let [first, second, _] = most.derivatives;
    h * (h * second + 2.0 * (normals[1] - normals[0]).length() * first) * RAISED
}

/// The largest `g''` of points of one body at an end of an interval.
fn bend_at(
    at: &Instant<[Rates; 2]>,
    which: usize,
    h: f64,
    normals: [DVec3; 2],
    end: usize,
    supports: &impl Supports<ConvexPolyhedron>,
) -> f64 {
    let sign = if which == 0 { -1.0 } else { 1.0 };
    let (n, dn) = (normals[end] * (h * h * sign), (normals[1] - normals[0]) * (2.0 * h * sign));
    let Rates { v, w, a, matrix } = at.moved[which];
    // dn.(w x p) = (dn x w).p
    let along = matrix.transpose() * n + dn.cross(w);
    let placed = [at.bodies.moving_placed(), at.bodies.fixed_placed()][which];
    let own = placed.pose.matrix().transpose() * along;
    n.dot(a) + dn.dot(v) + along.dot(placed.pose.translation()) + supports.reach(placed.body, own)
}
