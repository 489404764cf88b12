//! Two bodies during a span, in which both rotate at a constant rate about axes with constant velocities.

use derive_where::derive_where;
use glam::DVec3;

use colltrans_convex::body::{ConvexPolyhedron, Placed, VertexHull};
use colltrans_convex::setting::TwoBodies;
use colltrans_kernel::motion::{Motion, Piece, PiecePlacement};
use colltrans_kernel::noise;

/// Two bodies during a span of time.
#[derive(Debug)]
#[derive_where(Clone)]
pub(super) struct Span<'a, B = ConvexPolyhedron> {
    /// The bodies at the starts of their motion pieces.
    start: TwoBodies<'a, B>,
    pieces: [Piece; 2],
    pub(super) from: f64,
    pub(super) to: f64,
    /// Error bound of computed points of the motion, for both bodies together, in world units.
    pub(super) error: f64,
    /// Minimum gap, in world units; a negative value is a tolerated depth.
    pub(super) min_gap: f64,
}

/// Both bodies at one time, with additional data of the relative motion.
#[derive(Debug)]
#[derive_where(Clone, Copy; M)]
pub(super) struct Instant<'a, M = [PiecePlacement; 2], B = ConvexPolyhedron> {
    pub(super) time: f64,
    pub(super) bodies: TwoBodies<'a, B>,
    pub(super) moved: M,
}

impl<'a, B: VertexHull> Span<'a, B> {
    /// Builds the span of two bodies from the pieces of their motions.
    pub(super) fn new(
        bodies: [&'a B; 2],
        pieces: [&Piece; 2],
        [from, to]: [f64; 2],
        min_gap: f64,
    ) -> Self {
        let [moving, fixed] =
            [0, 1].map(|k| Placed { body: bodies[k], pose: pieces[k].start_pose });
        let error = |k: usize| pieces[k].error_bound(bodies[k].reach(), to - pieces[k].start_time);
        let start = TwoBodies::new(moving, fixed);
        Self {
            start,
            pieces: pieces.map(|piece| *piece),
            from,
            to,
            error: error(0) + error(1) + noise::FLUSHED_POSE_COORDINATES,
            min_gap,
        }
    }

    /// Returns the span of two parts of these bodies, over a part of the time.
    pub(super) fn part_span<'b, C>(&self, bodies: [&'b C; 2], [from, to]: [f64; 2]) -> Span<'b, C> {
        let Self { start, pieces, error, min_gap, .. } = self;
        let (start, pieces) = (start.with_bodies(bodies), *pieces);
        Span { start, pieces, from, to, error: *error, min_gap: *min_gap }
    }

    /// Returns the span of the same bodies, ended at a time.
    pub(super) fn ending_at(&self, to: f64) -> Self {
        self.restricted_to([self.from, to])
    }

    /// Returns the span of the same bodies over a part of the time.
    pub(super) fn restricted_to(&self, [from, to]: [f64; 2]) -> Self {
        Self { from, to, ..self.clone() }
    }

    /// Returns both bodies at a time.
    pub(super) fn instant_at(&self, time: f64) -> Instant<'a, [PiecePlacement; 2], B> {
        let moved = self.pieces.map(|piece| piece.placement_at(time));
        let bodies =
            self.start.with_poses_moved(moved.map(|m| m.rotation), moved.map(|m| m.displacement));
        Instant { time, bodies, moved }
    }

    /// Returns the piece of motion of the moving body (0) or the fixed body (1).
    pub(super) fn piece(&self, which: usize) -> &Piece {
        &self.pieces[which]
    }

    /// Returns the moving body (0) or the fixed body (1).
    pub(super) fn body(&self, which: usize) -> &'a B {
        [self.start.moving, self.start.fixed][which]
    }

    /// Returns the velocity of the axis of the fixed body relative to that of the moving body.
    pub(super) fn relative_velocity(&self) -> DVec3 {
        self.pieces[1].velocity - self.pieces[0].velocity
    }
}

/// Splits the time from 0 to 1 into spans, at the starts of all pieces of both motions.
pub(super) fn split_into_spans<'a, B: VertexHull>(
    bodies: [&'a B; 2],
    motions: [&Motion; 2],
    min_gap: f64,
) -> Vec<Span<'a, B>> {
    let pieces = motions.map(Motion::pieces);
    let mut times: Vec<f64> = pieces.into_iter().flatten().map(|piece| piece.start_time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times.push(1.0);
    let ends = times.windows(2).map(|pair| [pair[0], pair[1]]);
    ends.map(|[from, to]| {
        Span::new(bodies, pieces.map(|all| piece_at(all, from)), [from, to], min_gap)
    })
    .collect()
}

/// Returns the piece that contains a time.
fn piece_at(pieces: &[Piece], time: f64) -> &Piece {
    &pieces[pieces.partition_point(|piece| piece.start_time <= time).max(1) - 1]
}
