//! Two convex bodies that turn, during a span of time in which both spin evenly.

use glam::DVec3;

use crate::body::motion::{Moved, Piece};
use crate::body::{ConvexPolyhedron, Placed};
use crate::setting::TwoBodies;

/// Two bodies during a span of time.
#[derive(Debug, Clone)]
pub(super) struct Span<'a> {
    /// Where they are when their pieces begin.
    start: TwoBodies<'a>,
    pieces: [Piece; 2],
    pub(super) from: f64,
    pub(super) to: f64,
    /// How far the motion's points may be from where they are computed, for both bodies together.
    pub(super) error: f64,
    /// The gap to be kept; negative a depth that is tolerated.
    pub(super) keep: f64,
}

/// Both bodies at a time, and what else a course knows of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instant<'a, M = [Moved; 2]> {
    pub(super) time: f64,
    pub(super) bodies: TwoBodies<'a>,
    pub(super) moved: M,
}

impl<'a> Span<'a> {
    pub(super) fn new(
        bodies: [&'a ConvexPolyhedron; 2],
        pieces: [&Piece; 2],
        [from, to]: [f64; 2],
        keep: f64,
    ) -> Self {
        let [moving, fixed] = [0, 1].map(|k| Placed { body: bodies[k], pose: pieces[k].start });
        let error = |k: usize| pieces[k].error(bodies[k].inertia().reach, to - pieces[k].since);
        let start = TwoBodies::new(moving, fixed);
        Self {
            start,
            pieces: pieces.map(|piece| *piece),
            from,
            to,
            error: error(0) + error(1),
            keep,
        }
    }

    pub(super) fn instant(&self, time: f64) -> Instant<'a> {
        let moved = self.pieces.map(|piece| piece.at(time));
        let bodies = self.start.carried(moved.map(|m| m.rotation), moved.map(|m| m.by));
        Instant { time, bodies, moved }
    }

    pub(super) fn piece(&self, which: usize) -> &Piece {
        &self.pieces[which]
    }

    pub(super) fn body(&self, which: usize) -> &'a ConvexPolyhedron {
        [self.start.moving, self.start.fixed][which]
    }

    /// How far the fixed body's axis moves beyond the moving one's in a unit of time.
    pub(super) fn drift(&self) -> DVec3 {
        self.pieces[1].velocity - self.pieces[0].velocity
    }
}
