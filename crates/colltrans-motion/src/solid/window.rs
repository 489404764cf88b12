//! Two parts of solids in an interval of time: does one plane part them throughout?
//!
//! Notation. As [`bend`](super::super::bend), with one normal `n` for all of the interval: `dn = 0`, `W = alpha^2
//! n_across` of the moving body and `-W` of the fixed one are constant, and `C` needs how far each part reaches
//! along two directions of its frame. Parts are boxes, or single facets.
//!
//! A *plane* is named, not given: each of a few directions that both parts have at hand, turned from the moving
//! to the fixed one. So a proof holds a letter where a plane parts them, and a check asks that one alone.
//!
//! Normals are as they come, of any length: gaps and `C` grow with it, and so does what they are lowered by, with the
//! sum of the normal's components, which is no less than its length.
//!
//! Rounding. A height along a unit normal is off by less than a noise of the span's size, as any support is; that
//! of a box by one more, for its middle and extents; what computed places are off comes to it.

use glam::{DMat3, DVec3};

use super::super::arc;
use super::super::bend::{SPARE, across, most_bend};
use super::super::span::Span;
use super::tree::{Below, Facet, Node, Tree};
use colltrans_convex::body::Hull;
use colltrans_kernel::motion::{Moved, Piece};
use colltrans_kernel::noise::Noise;

/// Arcs that are longer are none any more.
const ARC: f64 = 2.0;

/// Axes that are no farther apart than this share of the bodies' size are one.
const BESIDE: f64 = 1e-6;

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
    /// From a point of its axis to its origin, and how much of that is along the axis.
    arm: DVec3,
    along: f64,
}

/// What is the same for all parts and intervals of a span.
#[derive(Debug, Clone)]
pub(super) struct Frame<'s, 'a> {
    pub(super) span: &'s Span<'a, Tree<'a>>,
    /// What heights along a unit normal are lowered by.
    lowered: f64,
    /// Whether both bodies spin as one about one axis, so that one only moves along it as seen from the other.
    is_one: bool,
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
}

/// A part where it is at a time, as vectors with the axes of the world from its body's origin: the corners of a
/// facet, or the middle of a box and the halves of its edges.
#[derive(Debug, Clone, Copy)]
struct Seen {
    vectors: [DVec3; 4],
    /// How much of each is along the body's axis.
    along: [f64; 4],
    is_facet: bool,
}

impl Seen {
    #[inline]
    fn new(part: &Part, rotation: &DMat3, axis: DVec3) -> Self {
        let vectors = match part {
            Part::Box(node) => {
                let half = node.half;
                let [x, y, z] = [rotation.x_axis, rotation.y_axis, rotation.z_axis];
                [*rotation * node.middle, x * half.x, y * half.y, z * half.z]
            }
            Part::Facet(facet) => {
                let [a, b, c] = facet.corners.map(|v| *rotation * v);
                [a, b, c, DVec3::ZERO]
            }
        };
        let along = vectors.map(|v| v.dot(axis));
        Self { vectors, along, is_facet: part.facet().is_some() }
    }

    #[inline]
    fn middle(&self) -> DVec3 {
        let [a, b, c, _] = self.vectors;
        if self.is_facet { (a + b + c) / 3.0 } else { a }
    }

    /// The largest height along a normal, and along the part of it across the axis, if such a share of it is
    /// along that.
    #[inline]
    fn reach(&self, normal: DVec3, share: f64) -> [f64; 2] {
        let [a, b, c, d] = self.vectors.map(|v| normal.dot(v));
        let [k, l, m, n] = self.along.map(|along| share * along);
        if self.is_facet {
            [a.max(b).max(c), (a - k).max(b - l).max(c - m)]
        } else {
            let side = (a - k) + ((b - l).abs() + (c - m).abs() + (d - n).abs());
            [a + (b.abs() + c.abs() + d.abs()), side]
        }
    }
}

/// Two parts in an interval.
#[derive(Debug, Clone)]
pub(super) struct Window<'w, 's, 'a> {
    frame: &'w Frame<'s, 'a>,
    ends: [&'w Snap; 2],
    /// Of the moving and of the fixed part, at both ends.
    seen: [[Seen; 2]; 2],
    /// From middle to middle, at both ends together.
    apart: DVec3,
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
        let lowered = LOWERED * noise.point() + span.error;
        let arms = [0, 1].map(|which| span.piece(which).arm);
        let beside = across(start.offset - (arms[1] - arms[0]), span.piece(0).axis).length();
        let size = span.body(0).reach() + span.body(1).reach();
        let is_one = arc::is_one_spin(span) && beside <= BESIDE * size;
        Self { span, lowered, is_one }
    }

    pub(super) fn snap(&self, time: f64) -> Snap {
        let at = self.span.instant(time);
        let rotations = [at.bodies.moving_matrix, at.bodies.fixed_matrix];
        let place = |k: usize| {
            let (rotation, Moved { arm, .. }) = (rotations[k], at.moved[k]);
            Place { rotation, arm, along: arm.dot(self.piece(k).axis) }
        };
        Snap { time, places: [place(0), place(1)], offset: at.bodies.offset }
    }

    fn piece(&self, which: usize) -> &Piece {
        self.span.piece(which)
    }

    /// Two parts between two times.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub(super) fn window<'w>(
        &'w self,
        ends: [&'w Snap; 2],
        parts: [&Part; 2],
    ) -> Window<'w, 's, 'a> {
        let seen = |which: usize| {
            let (part, piece) = (parts[which], self.piece(which));
            let at = |end: &Snap| Seen::new(part, &end.places[which].rotation, piece.axis);
            let first = at(ends[0]);
            [first, if piece.rate == 0.0 { first } else { at(ends[1]) }]
        };
        let seen = [seen(0), seen(1)];
        let middles = seen.each_ref().map(|[a, b]| a.middle() + b.middle());
        let apart = (ends[0].offset + ends[1].offset) + (middles[1] - middles[0]);
        Window { frame: self, ends, seen, apart }
    }
}

impl Window<'_, '_, '_> {
    /// By how much a body turns.
    #[inline]
    fn angle(&self, which: usize) -> f64 {
        (self.frame.piece(which).rate * (self.ends[1].time - self.ends[0].time)).abs()
    }

    /// The larger of both angles; none, if both bodies spin as one.
    pub(super) fn turn(&self) -> f64 {
        if self.frame.is_one {
            return 0.0;
        }
        self.angle(0).max(self.angle(1))
    }

    /// How far the middles of both parts move together, at most; if both bodies spin as one, one as seen from the other.
    pub(super) fn way(&self) -> f64 {
        let drift = self.frame.span.drift().length() * (self.ends[1].time - self.ends[0].time);
        if self.frame.is_one {
            return drift;
        }
        let of = |which: usize| {
            let (piece, place) = (self.frame.piece(which), &self.ends[0].places[which]);
            let from_axis = across(place.arm + self.seen[which][0].middle(), piece.axis);
            from_axis.length() * self.angle(which)
        };
        of(0) + of(1) + drift
    }

    /// Whether a plane parts both throughout; it does not tell where one turns by more than [`ARC`]. The normal may be
    /// of any length: gaps and `C` grow with it.
    #[inline]
    fn is_parted(&self, normal: DVec3) -> bool {
        let (frame, length) = (self.frame, normal.abs().element_sum());
        let keep = frame.span.keep;
        let kept = if keep > 0.0 { keep * normal.length() * (1.0 + 1e-12) } else { 0.0 };
        let lowered = frame.lowered * length + kept;
        let shares = [0, 1].map(|k| normal.dot(self.frame.piece(k).axis));
        let mut gaps = [0.0; 2];
        // How far the parts reach along what supporting planes bend by.
        let mut most = [f64::NEG_INFINITY; 2];
        for (k, end) in self.ends.into_iter().enumerate() {
            let [moving, fixed] = &end.places;
            let [high, side] = self.seen[0][k].reach(normal, shares[0]);
            let [low, back] = self.seen[1][k].reach(-normal, -shares[1]);
            gaps[k] = normal.dot(end.offset) - low - high - lowered;
            if gaps[k] <= 0.0 {
                return false;
            }
            let arms = [
                normal.dot(moving.arm) - shares[0] * moving.along,
                shares[1] * fixed.along - normal.dot(fixed.arm),
            ];
            most = [most[0].max(side + arms[0]), most[1].max(back + arms[1])];
        }
        let c = self.bend(0, most[0], length) + self.bend(1, most[1], length);
        c <= most_bend(gaps, SPARE)
    }

    /// `C` of a body that reaches so far at the ends along a normal of at most this length, at most.
    #[inline]
    fn bend(&self, which: usize, most: f64, length: f64) -> f64 {
        let angle = self.angle(which);
        if angle == 0.0 {
            return 0.0;
        }
        if angle > ARC {
            return f64::INFINITY;
        }
        // What is computed is off by less than the last term.
        let size = self.frame.span.body(which).reach() + self.frame.piece(which).arm.length();
        let most = most + 1e-13 * size * length;
        // cos(x) >= 1 - x^2 / 2.
        let most = if most > 0.0 { most / (1.0 - 0.125 * angle * angle) } else { most };
        angle * angle * most
    }

    /// The normal of a plane, of any length, from the moving to the fixed part; none if they have none of its kind.
    #[inline]
    fn normal(&self, plane: Plane) -> Option<DVec3> {
        // A direction of a body, halfway, twice.
        let axis = |which: usize, k: usize| {
            let [a, b] = self.ends.map(|end| end.places[which].rotation.col(k));
            a + b
        };
        let edge = |which: usize, k: usize| {
            let [a, b] = &self.seen[which];
            let next = (k + 1) % 3;
            let along = (a.vectors[next] - a.vectors[k]) + (b.vectors[next] - b.vectors[k]);
            a.is_facet.then_some(along)
        };
        let along = match plane {
            Plane::Middles => self.apart,
            Plane::Axis(which, k) => axis(which as usize, k as usize),
            Plane::Across(which) => edge(which as usize, 0)?.cross(edge(which as usize, 1)?),
            Plane::Edges(i, j) => edge(0, i as usize)?.cross(edge(1, j as usize)?),
        };
        // Products of shorter or longer ones would leave the range.
        let is_fit = (1e-100..1e100).contains(&along.abs().max_element());
        is_fit.then_some(if along.dot(self.apart) < 0.0 { -along } else { along })
    }

    /// Whether a plane of this name parts both throughout.
    #[inline]
    pub(super) fn is_parted_by(&self, plane: Plane) -> bool {
        self.normal(plane).is_some_and(|normal| self.is_parted(normal)) || self.is_carried_by(plane)
    }

    /// Whether both bodies spin as one and this plane parts both when the interval begins, by more than is lost of it
    /// while they carry it along.
    fn is_carried_by(&self, plane: Plane) -> bool {
        let Frame { span, lowered, is_one } = *self.frame;
        if !is_one {
            return false;
        }
        let start = self.ends[0];
        let seen = self.seen.map(|[first, _]| [first; 2]);
        let apart = (start.offset + (seen[1][0].middle() - seen[0][0].middle())) * 2.0;
        let begin = Window { frame: self.frame, ends: [start; 2], seen, apart };
        let Some(normal) = begin.normal(plane) else { return false };
        let [high, _] = seen[0][0].reach(normal, 0.0);
        let [low, _] = seen[1][0].reach(-normal, 0.0);
        let kept = span.keep.max(0.0) * normal.length() * (1.0 + 1e-12);
        let gap =
            normal.dot(start.offset) - low - high - lowered * normal.abs().element_sum() - kept;
        let offset = start.offset - (start.places[1].arm - start.places[0].arm);
        gap > arc::carried(span, offset, self.ends[1].time - start.time, normal)
    }
}
