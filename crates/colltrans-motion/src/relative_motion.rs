//! The motion of two bodies over a time range, as the search and the check use it.
//!
//! [`RelativeMotion`] returns poses, error bounds of computed places, and bounds of the curvature of the gap. [`Span`]
//! implements it for two bodies with constant rates of rotation, `path` for bodies that joints carry. Notation:
//! [`curvature`](super::curvature).

use glam::DVec3;

use super::arc;
use super::curvature::{
    ROOT_MARGIN, SupportSearch, curvature_bound, max_provable_curvature, perpendicular_part,
    typical_curvature,
};
use super::proof::TimedPlane;
use super::span::{Instant, Span};
use colltrans_convex::body::VertexHull;
use colltrans_kernel::motion::PiecePlacement;

/// Maximum length of the cross product of two axes that count as parallel.
const PARALLEL_LENGTH: f64 = 1e-9;

/// Both bodies of a relative motion at one time.
pub(super) type InstantOf<'a, C> =
    Instant<'a, <C as RelativeMotion<'a>>::Moved, <C as RelativeMotion<'a>>::Body>;

/// Two bodies over a time range.
pub(super) trait RelativeMotion<'a> {
    /// The type of both bodies.
    type Body: VertexHull + 'a;
    /// Additional data of an instant, one entry for each body.
    type Moved: Copy;

    /// Returns the start and the end of the time range.
    fn time_range(&self) -> [f64; 2];

    /// Returns an upper bound of the error of computed points, for both bodies together, in world units.
    fn position_error(&self) -> f64;

    /// Returns the minimum gap, in world units; a negative value is a tolerated depth.
    fn min_gap(&self) -> f64;

    /// Returns both bodies at a time.
    fn instant_at(&self, time: f64) -> InstantOf<'a, Self>;

    /// Returns the velocity of a point of the moving body (0) or the fixed body (1), given in the frame of that body.
    fn point_velocity(&self, at: &InstantOf<'a, Self>, which: usize, point: DVec3) -> DVec3;

    /// Computes an upper bound of `C` between two planes: a loose bound if it is at most `enough`, otherwise a tighter
    /// one.
    fn curvature_bound(
        &self,
        ends: [&InstantOf<'a, Self>; 2],
        normals: [DVec3; 2],
        enough: f64,
        supports: &impl SupportSearch<Self::Body>,
    ) -> f64;

    /// Returns an upper bound of `C` divided by the square of the interval, for a normal that hardly rotates.
    fn typical_curvature(&self) -> f64;

    /// Returns the number of vertices that move on arcs in [`Self::gap_loss`]; 0 if that method has no bound.
    fn arc_vertex_count(&self) -> usize;

    /// Returns an upper bound of the gap that a plane with a fixed normal has lost at any time between two instants,
    /// since the first of them.
    fn gap_loss(&self, ends: [&InstantOf<'a, Self>; 2], normal: DVec3) -> f64;

    /// Returns the normal, from the moving to the fixed body, along the perpendicular from the axis of a rotating body
    /// to a point of the other body. `points` has a point of each body, in its frame. The plane may lie outside the
    /// volume swept by the rotation. Returns `None` if there is no such normal.
    fn radial_normal(&self, at: &InstantOf<'a, Self>, points: [DVec3; 2]) -> Option<DVec3> {
        let _ = (at, points);
        None
    }

    /// Returns the normal along the shortest connection of both axes, from the moving body to the fixed one. For two
    /// round bodies its plane separates the swept volumes. Returns `None` unless both bodies rotate about different
    /// axes.
    fn normal_between_axes(&self, at: &InstantOf<'a, Self>) -> Option<DVec3> {
        let _ = at;
        None
    }

    /// Returns the sum of the angular speeds of both bodies, in radians per unit of time. A search uses it only for its
    /// maximum number of steps. The default of 0 adds none.
    fn angular_speed(&self) -> f64 {
        0.0
    }

    /// Returns an upper bound of the gap that a plane loses if the moving body carries it from an instant to the time
    /// `until`. The bound is small if both bodies have the same angular velocity, and infinite unless both rotate.
    fn carried_gap_loss(&self, from: &InstantOf<'a, Self>, until: f64, normal: DVec3) -> f64 {
        let _ = (from, until, normal);
        f64::INFINITY
    }

    /// Returns the gap of a plane at an instant minus the minimum gap, proven over all vertices.
    fn proven_gap(&self, at: &InstantOf<'a, Self>, normal: DVec3) -> f64 {
        at.bodies.proven_gap(normal) - self.min_gap() - self.position_error()
    }

    /// Returns the gap of a plane at an instant minus the minimum gap, between the input points of the bodies. A search
    /// claims this gap.
    fn claimed_gap(&self, at: &InstantOf<'a, Self>, normal: DVec3) -> f64 {
        at.bodies.input_gap(normal) - self.min_gap() - self.position_error()
    }

    /// Checks whether two planes prove the time between them.
    fn proves_between(
        &self,
        planes: [&TimedPlane; 2],
        ends: [&InstantOf<'a, Self>; 2],
        supports: &impl SupportSearch<Self::Body>,
    ) -> bool {
        if ends[0].time == ends[1].time {
            return true;
        }
        let [a, b] = planes;
        if a.alone {
            return a.normal == b.normal && a.gap > self.gap_loss(ends, a.normal);
        }
        if a.gap > self.carried_gap_loss(ends[0], b.time, a.normal) {
            return true;
        }
        let enough = max_provable_curvature([a.gap, b.gap], ROOT_MARGIN);
        self.curvature_bound(ends, [a.normal, b.normal], enough, supports) <= enough
    }
}

impl<'a, B: VertexHull> RelativeMotion<'a> for Span<'a, B> {
    type Body = B;
    type Moved = [PiecePlacement; 2];

    fn time_range(&self) -> [f64; 2] {
        [self.from, self.to]
    }

    fn position_error(&self) -> f64 {
        self.error
    }

    fn min_gap(&self) -> f64 {
        self.min_gap
    }

    fn instant_at(&self, time: f64) -> Instant<'a, [PiecePlacement; 2], B> {
        Span::instant_at(self, time)
    }

    fn point_velocity(
        &self,
        at: &Instant<'a, [PiecePlacement; 2], B>,
        which: usize,
        point: DVec3,
    ) -> DVec3 {
        let moved = &at.moved[which];
        self.piece(which).point_velocity(moved.arm + moved.rotation * point)
    }

    fn curvature_bound(
        &self,
        ends: [&Instant<'a, [PiecePlacement; 2], B>; 2],
        normals: [DVec3; 2],
        enough: f64,
        supports: &impl SupportSearch<B>,
    ) -> f64 {
        curvature_bound(self, ends, normals, enough, supports)
    }

    fn typical_curvature(&self) -> f64 {
        typical_curvature(self)
    }

    fn arc_vertex_count(&self) -> usize {
        let turning = |which: usize| self.piece(which).rate != 0.0;
        let corners = |which: usize| self.body(which).vertex_count();
        (0..2).filter(|which| turning(*which)).map(corners).sum()
    }

    fn gap_loss(&self, ends: [&Instant<'a, [PiecePlacement; 2], B>; 2], normal: DVec3) -> f64 {
        arc::gap_loss(self, ends, normal)
    }

    fn radial_normal(
        &self,
        at: &Instant<'a, [PiecePlacement; 2], B>,
        [p, q]: [DVec3; 2],
    ) -> Option<DVec3> {
        let bodies = &at.bodies;
        let across = if self.piece(0).rate == 0.0 {
            // From the axis of the fixed body to a point of the moving one.
            let to = bodies.moving_matrix * p - bodies.offset + at.moved[1].arm;
            -perpendicular_part(to, self.piece(1).axis)
        } else {
            let to = bodies.fixed_matrix * q + bodies.offset + at.moved[0].arm;
            perpendicular_part(to, self.piece(0).axis)
        };
        across.try_normalize()
    }

    fn normal_between_axes(&self, at: &Instant<'a, [PiecePlacement; 2], B>) -> Option<DVec3> {
        let [p, q] = [self.piece(0), self.piece(1)];
        if p.rate == 0.0 || q.rate == 0.0 {
            return None;
        }
        let axis_offset = at.bodies.offset - (at.moved[1].arm - at.moved[0].arm);
        let normal = p.axis.cross(q.axis);
        let are_parallel = normal.length() < PARALLEL_LENGTH;
        let normal = if are_parallel { perpendicular_part(axis_offset, p.axis) } else { normal };
        normal.try_normalize().map(|n| if n.dot(axis_offset) < 0.0 { -n } else { n })
    }

    fn angular_speed(&self) -> f64 {
        self.piece(0).rate.abs() + self.piece(1).rate.abs()
    }

    fn carried_gap_loss(
        &self,
        from: &Instant<'a, [PiecePlacement; 2], B>,
        until: f64,
        normal: DVec3,
    ) -> f64 {
        let offset = from.bodies.offset - (from.moved[1].arm - from.moved[0].arm);
        arc::carried_gap_loss(self, offset, until - from.time, normal)
    }
}
