//! What a search and a check ask of two bodies that move during a span of time.
//!
//! Notation. As [`bend`](super::bend). A *course* says where the bodies are, how far computed places may be off,
//! and how far supporting planes may bend: whoever has that of another kind of motion has the search.

use glam::DVec3;

use super::arc;
use super::bend::{SPARE, Supports, across, bend, most_bend, usual};
use super::proof::PlaneAt;
use super::span::{Instant, Span};
use colltrans_convex::body::Hull;
use colltrans_kernel::motion::Moved;

/// Axes whose cross product is shorter are parallel.
const PARALLEL: f64 = 1e-9;

/// Both bodies of a course at a time.
pub(super) type At<'a, C> = Instant<'a, <C as Course<'a>>::Moved, <C as Course<'a>>::Body>;

/// Two bodies during a span of time.
pub(super) trait Course<'a> {
    /// What the bodies are.
    type Body: Hull + 'a;
    /// What else is known of a time.
    type Moved: Copy;

    /// The times between which it holds.
    fn times(&self) -> [f64; 2];

    /// How far points may be from where they are computed, for both bodies together.
    fn error(&self) -> f64;

    /// The gap to be kept; negative a depth that is tolerated.
    fn keep(&self) -> f64;

    /// Where the bodies are.
    fn instant(&self, time: f64) -> At<'a, Self>;

    /// The velocity of a point of the moving body (0) or the fixed one (1), in its body's frame.
    fn velocity(&self, at: &At<'a, Self>, which: usize, point: DVec3) -> DVec3;

    /// `C` between two planes, at least, as far as one cares: a loose one if that is at most `enough`.
    fn bend(
        &self,
        ends: [&At<'a, Self>; 2],
        normals: [DVec3; 2],
        enough: f64,
        supports: &impl Supports<Self::Body>,
    ) -> f64;

    /// `C` of an interval at most, per its square, if the normal hardly turns.
    fn usual(&self) -> f64;

    /// How many corners move on arcs that [`Self::lost`] knows; none if it knows nothing.
    fn arcs(&self) -> usize;

    /// How much of the gap that a plane leaves at the first of two times is lost until the second, at most.
    fn lost(&self, ends: [&At<'a, Self>; 2], normal: DVec3) -> f64;

    /// A normal across the axis of a body that turns, to a point of the other one: of a plane beside all that its turn
    /// sweeps, if that leaves one.
    fn aside(&self, at: &At<'a, Self>, points: [DVec3; 2]) -> Option<DVec3> {
        let _ = (at, points);
        None
    }

    /// The normal of a plane across the shortest way from the moving body's axis to the fixed one's, if both turn: of two
    /// round bodies it parts all that their turns sweep.
    fn between_axes(&self, at: &At<'a, Self>) -> Option<DVec3> {
        let _ = at;
        None
    }

    /// Sum of the bodies' angular velocities, in radians in a unit of time.
    fn turning(&self) -> f64 {
        0.0
    }

    /// The same, if the plane is carried along by the moving body: little, where both spin as one.
    fn carried(&self, from: &At<'a, Self>, until: f64, normal: DVec3) -> f64 {
        let _ = (from, until, normal);
        f64::INFINITY
    }

    /// What a plane proves at a time of the gap beyond what is to be kept, over all corners.
    fn proven_gap(&self, at: &At<'a, Self>, normal: DVec3) -> f64 {
        at.bodies.proven_gap(normal) - self.keep() - self.error()
    }

    /// What a search claims of that gap: the one between the points that the bodies were made from.
    fn claimed_gap(&self, at: &At<'a, Self>, normal: DVec3) -> f64 {
        at.bodies.input_gap(normal) - self.keep() - self.error()
    }

    /// Whether two planes prove the time between them.
    fn joins(
        &self,
        planes: [&PlaneAt; 2],
        ends: [&At<'a, Self>; 2],
        supports: &impl Supports<Self::Body>,
    ) -> bool {
        if ends[0].time == ends[1].time {
            return true;
        }
        let [a, b] = planes;
        if a.alone {
            return a.normal == b.normal && a.gap > self.lost(ends, a.normal);
        }
        if a.gap > self.carried(ends[0], b.time, a.normal) {
            return true;
        }
        let enough = most_bend([a.gap, b.gap], SPARE);
        self.bend(ends, [a.normal, b.normal], enough, supports) <= enough
    }
}

impl<'a, B: Hull> Course<'a> for Span<'a, B> {
    type Body = B;
    type Moved = [Moved; 2];

    fn times(&self) -> [f64; 2] {
        [self.from, self.to]
    }

    fn error(&self) -> f64 {
        self.error
    }

    fn keep(&self) -> f64 {
        self.keep
    }

    fn instant(&self, time: f64) -> Instant<'a, [Moved; 2], B> {
        Span::instant(self, time)
    }

    fn velocity(&self, at: &Instant<'a, [Moved; 2], B>, which: usize, point: DVec3) -> DVec3 {
        let moved = &at.moved[which];
        self.piece(which).point_velocity(moved.arm + moved.rotation * point)
    }

    fn bend(
        &self,
        ends: [&Instant<'a, [Moved; 2], B>; 2],
        normals: [DVec3; 2],
        enough: f64,
        supports: &impl Supports<B>,
    ) -> f64 {
        bend(self, ends, normals, enough, supports)
    }

    fn usual(&self) -> f64 {
        usual(self)
    }

    fn arcs(&self) -> usize {
        let turning = |which: usize| self.piece(which).rate != 0.0;
        let corners = |which: usize| self.body(which).corners().len();
        (0..2).filter(|which| turning(*which)).map(corners).sum()
    }

    fn lost(&self, ends: [&Instant<'a, [Moved; 2], B>; 2], normal: DVec3) -> f64 {
        arc::lost(self, ends, normal)
    }

    fn aside(&self, at: &Instant<'a, [Moved; 2], B>, [p, q]: [DVec3; 2]) -> Option<DVec3> {
        let bodies = &at.bodies;
        let across = if self.piece(0).rate == 0.0 {
            // From the fixed body's axis to a point of the moving one.
            let to = bodies.moving_matrix * p - bodies.offset + at.moved[1].arm;
            -across(to, self.piece(1).axis)
        } else {
            let to = bodies.fixed_matrix * q + bodies.offset + at.moved[0].arm;
            across(to, self.piece(0).axis)
        };
        across.try_normalize()
    }

    fn between_axes(&self, at: &Instant<'a, [Moved; 2], B>) -> Option<DVec3> {
        let [p, q] = [self.piece(0), self.piece(1)];
        if p.rate == 0.0 || q.rate == 0.0 {
            return None;
        }
        let way = at.bodies.offset - (at.moved[1].arm - at.moved[0].arm);
        let normal = p.axis.cross(q.axis);
        let are_parallel = normal.length() < PARALLEL;
        let normal = if are_parallel { across(way, p.axis) } else { normal };
        normal.try_normalize().map(|n| if n.dot(way) < 0.0 { -n } else { n })
    }

    fn turning(&self) -> f64 {
        self.piece(0).rate.abs() + self.piece(1).rate.abs()
    }

    fn carried(&self, from: &Instant<'a, [Moved; 2], B>, until: f64, normal: DVec3) -> f64 {
        let offset = from.bodies.offset - (from.moved[1].arm - from.moved[0].arm);
        arc::carried(self, offset, until - from.time, normal)
    }
}
