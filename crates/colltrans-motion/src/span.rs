//! Two bodies that turn, during a span of time in which both spin evenly: convex ones, or parts of solids.

use derive_where::derive_where;
use glam::DVec3;

use colltrans_convex::body::{ConvexPolyhedron, Hull, Placed};
use colltrans_convex::setting::TwoBodies;
use colltrans_kernel::motion::{Motion, Moved, Piece};
use colltrans_kernel::noise;

/// Two bodies during a span of time.
#[derive(Debug)]
#[derive_where(Clone)]
pub(super) struct Span<'a, B = ConvexPolyhedron> {
    /// Where they are when their pieces begin.
    start: TwoBodies<'a, B>,
    pieces: [Piece; 2],
    pub(super) from: f64,
    pub(super) to: f64,
    /// How far the motion's points may be from where they are computed, for both bodies together.
    pub(super) error: f64,
    /// The gap to be kept; negative a depth that is tolerated.
    pub(super) keep: f64,
}

/// Both bodies at a time, and what else a course knows of it.
#[derive(Debug)]
#[derive_where(Clone, Copy; M)]
pub(super) struct Instant<'a, M = [Moved; 2], B = ConvexPolyhedron> {
    pub(super) time: f64,
    pub(super) bodies: TwoBodies<'a, B>,
    pub(super) moved: M,
}

impl<'a, B: Hull> Span<'a, B> {
    pub(super) fn new(
        bodies: [&'a B; 2],
        pieces: [&Piece; 2],
        [from, to]: [f64; 2],
        keep: f64,
    ) -> Self {
        let [moving, fixed] = [0, 1].map(|k| Placed { body: bodies[k], pose: pieces[k].start });
        let error = |k: usize| pieces[k].error(bodies[k].reach(), to - pieces[k].since);
        let start = TwoBodies::new(moving, fixed);
        Self {
            start,
            pieces: pieces.map(|piece| *piece),
            from,
            to,
            error: error(0) + error(1) + noise::FLUSHED,
            keep,
        }
    }

    /// Other bodies, which are parts of these, during a part of the time.
    pub(super) fn part<'b, C>(&self, bodies: [&'b C; 2], [from, to]: [f64; 2]) -> Span<'b, C> {
        let Self { start, pieces, error, keep, .. } = self;
        let (start, pieces) = (start.holding(bodies), *pieces);
        Span { start, pieces, from, to, error: *error, keep: *keep }
    }

    /// The same bodies up to a time.
    pub(super) fn until(&self, to: f64) -> Self {
        self.within([self.from, to])
    }

    /// The same bodies during a part of the time.
    pub(super) fn within(&self, [from, to]: [f64; 2]) -> Self {
        Self { from, to, ..self.clone() }
    }

    pub(super) fn instant(&self, time: f64) -> Instant<'a, [Moved; 2], B> {
        let moved = self.pieces.map(|piece| piece.at(time));
        let bodies = self.start.carried(moved.map(|m| m.rotation), moved.map(|m| m.by));
        Instant { time, bodies, moved }
    }

    pub(super) fn piece(&self, which: usize) -> &Piece {
        &self.pieces[which]
    }

    pub(super) fn body(&self, which: usize) -> &'a B {
        [self.start.moving, self.start.fixed][which]
    }

    /// How far the fixed body's axis moves beyond the moving one's in a unit of time.
    pub(super) fn drift(&self) -> DVec3 {
        self.pieces[1].velocity - self.pieces[0].velocity
    }
}

/// The times in which both bodies spin evenly, one after the other.
pub(super) fn spans<'a, B: Hull>(
    bodies: [&'a B; 2],
    motions: [&Motion; 2],
    keep: f64,
) -> Vec<Span<'a, B>> {
    let pieces = motions.map(Motion::pieces);
    let mut times: Vec<f64> = pieces.into_iter().flatten().map(|piece| piece.since).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times.push(1.0);
    let ends = times.windows(2).map(|pair| [pair[0], pair[1]]);
    ends.map(|[from, to]| {
        Span::new(bodies, pieces.map(|all| piece_at(all, from)), [from, to], keep)
    })
    .collect()
}

/// The piece that a time belongs to.
fn piece_at(pieces: &[Piece], time: f64) -> &Piece {
    &pieces[pieces.partition_point(|piece| piece.since <= time).max(1) - 1]
}
