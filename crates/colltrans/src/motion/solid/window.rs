//! Two parts of solids in an interval of time: does one plane part them throughout?
//!
//! Notation. As [`bend`](super::super::bend), with one normal `n` for all of the interval: `dn = 0`, `W = alpha^2
//! n_across` of the moving body and `-W` of the fixed one are constant, and `C` needs how far each part reaches
//! along two directions of its frame. Parts are boxes, or single facets.
//!
//! A *plane* is named, not given: each of a few directions that both parts have at hand, turned from the moving
//! to the fixed one. So a proof holds a letter where a plane parts them, and a check asks that one alone.
//!
//! Rounding. A height along a unit normal is off by less than a noise of the span's size, as any support is; that
//! of a box by one more, for its middle and extents; what computed places are off comes to it.

use glam::{DMat3, DVec3};

use super::super::bend::{SPARE, across, most_bend};
use super::super::span::Span;
use super::tree::{Below, Facet, Node, Tree};
use crate::body::Hull;
use crate::body::motion::{Moved, Piece};
use crate::number::noise::Noise;

/// Arcs that are longer are none any more.
const ARC: f64 = 2.0;

/// By which heights are lowered, in noises.
const LOWERED: f64 = 2.0;

/// Both bodies at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Snap {
    pub(super) time: f64,
    places: [Place; 2],
    /// From the moving body's origin to the fixed one's.
    offset: DVec3,
}

/// A body at a time.
#[derive(Debug, Clone, Copy)]
struct Place {
    rotation: DMat3,
    /// From a point of its axis to its origin.
    arm: DVec3,
    /// Its axis, in its own frame and in the world.
    axis: DVec3,
    along: DVec3,
}

/// What is the same for all parts and intervals of a span.
#[derive(Debug, Clone)]
pub(super) struct Frame<'s, 'a> {
    pub(super) span: &'s Span<'a, Tree<'a>>,
    /// What heights are lowered by, and the gap to be kept.
    lowered: f64,
}

/// A direction that both parts have at hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Plane {
    /// From middle to middle.
    Middles,
    /// An axis of the moving (0) or the fixed body's (1) frame.
    Axis(u8, u8),
    /// Across the moving (0) or the fixed (1) facet.
    Across(u8),
    /// Across an edge of each facet, the moving one's first.
    Edges(u8, u8),
}

/// A part of a body, in its frame.
#[derive(Debug, Clone, Copy)]
pub(super) enum Part {
    Box(Node),
    Facet(Facet),
}

impl Part {
    pub(super) fn of(tree: &Tree, at: u32) -> Self {
        let node = tree.node(at);
        match node.below {
            Below::Facet(triangle) => Self::Facet(tree.facet(triangle)),
            Below::Nodes(_) => Self::Box(*node),
        }
    }

    pub(super) fn facet(&self) -> Option<&Facet> {
        match self {
            Self::Box(_) => None,
            Self::Facet(facet) => Some(facet),
        }
    }

    #[inline]
    fn middle(&self) -> DVec3 {
        match self {
            Self::Box(node) => node.middle,
            Self::Facet(Facet { corners: [a, b, c], .. }) => (*a + *b + *c) / 3.0,
        }
    }

    /// The least and the largest height along a direction of any length.
    #[inline]
    fn range(&self, along: DVec3) -> [f64; 2] {
        match self {
            Self::Box(node) => {
                let (at, reach) = (along.dot(node.middle), along.abs().dot(node.half));
                [at - reach, at + reach]
            }
            Self::Facet(facet) => {
                let [a, b, c] = facet.corners.map(|v| along.dot(v));
                [a.min(b).min(c), a.max(b).max(c)]
            }
        }
    }
}

impl<'s, 'a> Frame<'s, 'a> {
    pub(super) fn new(span: &'s Span<'a, Tree<'a>>) -> Self {
        let start = span.instant(span.from).bodies;
        // No two points come to be farther apart within the span.
        let far = |which: usize| {
            let (piece, h) = (span.piece(which), span.to - span.from);
            let swung = 2.0 * piece.arm.length() * (piece.rate.abs() * h).min(1.0);
            span.body(which).reach() + swung + piece.velocity.length() * h
        };
        let noise = Noise::of(start.offset.length() + far(0) + far(1));
        let kept = span.keep * (1.0 + 1e-12);
        Self { span, lowered: LOWERED * noise.point() + span.error + kept }
    }

    pub(super) fn snap(&self, time: f64) -> Snap {
        let at = self.span.instant(time);
        let rotations = [at.bodies.moving_matrix, at.bodies.fixed_matrix];
        let place = |k: usize| {
            let (rotation, Moved { arm, .. }, along) =
                (rotations[k], at.moved[k], self.piece(k).axis);
            Place { rotation, arm, axis: rotation.transpose() * along, along }
        };
        Snap { time, places: [place(0), place(1)], offset: at.bodies.offset }
    }

    pub(super) fn piece(&self, which: usize) -> &Piece {
        self.span.piece(which)
    }

    /// By how much a body turns between two times.
    pub(super) fn angle(&self, which: usize, [a, b]: [&Snap; 2]) -> f64 {
        (self.piece(which).rate * (b.time - a.time)).abs()
    }

    /// How far the middles of two parts move, together, at most.
    pub(super) fn way(&self, ends: [&Snap; 2], parts: [&Part; 2]) -> f64 {
        let of = |which: usize, middle: DVec3| {
            let (piece, place) = (self.piece(which), &ends[0].places[which]);
            let from_axis = across(place.arm + place.rotation * middle, piece.axis);
            from_axis.length() * self.angle(which, ends)
        };
        let drift = self.span.drift().length() * (ends[1].time - ends[0].time);
        of(0, parts[0].middle()) + of(1, parts[1].middle()) + drift
    }

    /// Whether a plane parts two parts throughout an interval, in which neither turns by more than [`ARC`].
    #[inline]
    pub(super) fn parts(&self, ends: [&Snap; 2], [p, q]: [&Part; 2], normal: DVec3) -> bool {
        let mut gaps = [0.0; 2];
        // How far the parts reach along what supporting planes bend by.
        let mut most = [f64::NEG_INFINITY; 2];
        for (k, end) in ends.into_iter().enumerate() {
            let [moving, fixed] = &end.places;
            let (u, v) =
                (moving.rotation.transpose() * normal, fixed.rotation.transpose() * normal);
            let ([_, high], [low, _]) = (p.range(u), q.range(v));
            gaps[k] = (normal.dot(end.offset) + low) - high - self.lowered;
            if gaps[k] <= 0.0 {
                return false;
            }
            let share = |which: usize| normal.dot(self.piece(which).axis);
            if self.piece(0).rate != 0.0 {
                most[0] =
                    most[0].max(moving.sideways(normal, u, share(0), |across| p.range(across)[1]));
            }
            if self.piece(1).rate != 0.0 {
                let least = |across: DVec3| q.range(across)[0];
                most[1] = most[1].max(-fixed.sideways(normal, v, share(1), least));
            }
        }
        let c = self.bends(0, ends, most[0]) + self.bends(1, ends, most[1]);
        c <= most_bend(gaps, SPARE)
    }

    /// `C` of a body that reaches so far along `n_across` at the ends, at most.
    #[inline]
    fn bends(&self, which: usize, ends: [&Snap; 2], most: f64) -> f64 {
        let angle = self.angle(which, ends);
        if angle == 0.0 {
            return 0.0;
        }
        if angle > ARC {
            return f64::INFINITY;
        }
        // What is computed is off by less than the last term.
        let most = most + 1e-13 * (self.span.body(which).reach() + self.piece(which).arm.length());
        // cos(x) >= 1 - x^2 / 2.
        let most = if most > 0.0 { most / (1.0 - 0.125 * angle * angle) } else { most };
        angle * angle * most
    }
}

impl Place {
    /// How far a part reaches from its axis along the part of a normal across that, which has such a `share`
    /// along it and is `own` in the body's frame.
    #[inline]
    fn sideways(&self, normal: DVec3, own: DVec3, share: f64, reach: impl Fn(DVec3) -> f64) -> f64 {
        // The axis is a unit vector to rounding.
        let arm = normal.dot(self.arm) - share * self.along.dot(self.arm);
        arm + reach(own - self.axis * share)
    }
}

/// The normal of a plane, from the moving to the fixed part; none if they have none of its kind.
pub(super) fn normal(ends: [&Snap; 2], parts: [&Part; 2], plane: Plane) -> Option<DVec3> {
    let place = |snap: &Snap| {
        let [p, q] = &snap.places;
        q.rotation * parts[1].middle() + snap.offset - p.rotation * parts[0].middle()
    };
    let apart = place(ends[0]) + place(ends[1]);
    // A direction of a body, halfway.
    let turned = |which: usize, v: DVec3| {
        ends[0].places[which].rotation * v + ends[1].places[which].rotation * v
    };
    let edge = |which: usize, k: usize| {
        let corners = parts[which].facet()?.corners;
        Some(corners[(k + 1) % 3] - corners[k])
    };
    let along = match plane {
        Plane::Middles => apart,
        Plane::Axis(which, k) => turned(which as usize, DVec3::AXES[k as usize]),
        Plane::Across(which) => {
            let which = which as usize;
            turned(which, edge(which, 0)?.cross(edge(which, 1)?))
        }
        Plane::Edges(i, j) => {
            turned(0, edge(0, i as usize)?).cross(turned(1, edge(1, j as usize)?))
        }
    };
    let square = along.length_squared();
    if !(square > 1e-280 && square < 1e280) {
        return None;
    }
    let normal = along / square.sqrt();
    Some(if normal.dot(apart) < 0.0 { -normal } else { normal })
}
