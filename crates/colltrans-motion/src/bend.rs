//! From two planes to all times in between.
//!
//! Notation. Planes with the normals `n_a`, `n_b` and gaps `s_a`, `s_b` at the ends of an interval of length
//! `h`; `x` from 0 to 1 over it; `n(x) = (1 - x) n_a + x n_b`, of any length, and `dn = n_b - n_a`. `alpha =
//! w h` is the angle by which a body turns about `k` meanwhile, `E(x)` its rotation.
//!
//! In the body's frame a normal is `u(x) = E' n`, and `u'' = -E' W` with `W = alpha^2 n_across + 2 alpha k x
//! dn`, where `n_across` is the part of `n` across `k`. So `u = chord + integral of G E' W` with Green's
//! function `G >= 0` of the interval, whose integral is `x (1 - x) / 2`; as `h_P` is sublinear, `h_P(u)`
//! exceeds its chord by at most `C_P x (1 - x) / 2`, `C_P = max_x h_P(E' W)`. The same holds of `Q` with
//! `-W`. The axes drift apart by `dc`: `n.c` is below its chord by `dn.dc x (1 - x)`. Together
//!
//! `s(x) >= (1 - x) s_a + x s_b - C x (1 - x) / 2`, `C = C_P + C_Q + 2 dn.dc`,
//!
//! which is positive throughout if `sqrt(s_a) + sqrt(s_b) > sqrt(C / 2)`. `s(x) > 0` proves that no points
//! meet then, whatever the length of `n(x)`.
//!
//! - *Loose.* `C_P <= max(|W_a|, |W_b|)` times the body's distance from its axis: no support point is asked.
//! - *Tight.* `W` is affine and `E' W_j` an arc of at most `alpha`, each direction of which is a combination
//!   of those at its ends with weights that sum to at most `1 / cos(alpha / 2)`, and to at least 1: four
//!   support points bound `C_P`.
//!
//! A gap to be kept is taken off both gaps, where a plane keeps it; `n(x)` is no longer than 1, so it is kept
//! in between.

use glam::DVec3;

use super::span::{Instant, Span};
use colltrans_convex::body::{ConvexPolyhedron, Hull};
use colltrans_kernel::motion::Moved;

/// Sums here are off by less than this share of their terms.
const ROUNDED: f64 = 1e-13;

/// By which share square roots have to be larger, for a check; a search leaves as much to it.
pub(super) const SPARE: f64 = 1e-9;

/// Up to which `C` the gaps at the ends of an interval prove all of it, with some share to spare.
pub(super) fn most_bend([a, b]: [f64; 2], spare: f64) -> f64 {
    let roots = (a.max(0.0).sqrt() + b.max(0.0).sqrt()) * (1.0 - spare);
    2.0 * roots * roots
}

/// How far a body reaches along a direction of its frame, of any length: at least.
pub(super) trait Supports<B> {
    fn reach(&self, body: &B, normal: DVec3) -> f64;
}

/// By climbing.
pub(super) struct Climbing;

impl Supports<ConvexPolyhedron> for Climbing {
    fn reach(&self, body: &ConvexPolyhedron, normal: DVec3) -> f64 {
        let length = normal.length();
        if length == 0.0 {
            return 0.0;
        }
        let unit = normal / length;
        let (vertex, beyond) = body.settled(unit, body.support(unit).0);
        normal.dot(body.vertices()[vertex as usize]) + beyond * length
    }
}

/// By a look at all corners.
pub(super) struct Looking;

impl<B: Hull> Supports<B> for Looking {
    fn reach(&self, body: &B, normal: DVec3) -> f64 {
        body.corners().iter().map(|v| normal.dot(*v)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// `C` between two planes, at least, as far as one cares: a loose one if that is at most `enough`.
pub(super) fn bend<'a, B: Hull>(
    span: &Span<'a, B>,
    ends: [&Instant<'a, [Moved; 2], B>; 2],
    normals: [DVec3; 2],
    enough: f64,
    supports: &impl Supports<B>,
) -> f64 {
    let h = ends[1].time - ends[0].time;
    let dn = normals[1] - normals[0];
    let drift = 2.0 * h * dn.dot(span.drift());
    let tolerated = 2.0 * (-span.keep).max(0.0) * dn.length_squared() * (1.0 + ROUNDED);
    let drift = drift + tolerated + ROUNDED * 2.0 * h * dn.length() * span.drift().length();
    let turns = [0, 1].map(|which| Turning::new(span, ends, normals, which, h));
    let loose = drift + turns.iter().map(Turning::loose).sum::<f64>();
    if loose <= enough {
        return loose;
    }
    drift + turns.iter().map(|turn| turn.tight(supports)).sum::<f64>()
}

/// `C` of an interval of this length at most, per its square, if the normal hardly turns.
pub(super) fn usual<B: Hull>(span: &Span<B>) -> f64 {
    let of = |which: usize| {
        let piece = span.piece(which);
        let reach = span.body(which).reach() + across(piece.arm, piece.axis).length();
        piece.rate * piece.rate * reach
    };
    of(0) + of(1)
}

/// A body that turns in an interval, and the `W` of its ends.
struct Turning<'s, 'a, B> {
    which: usize,
    span: &'s Span<'a, B>,
    ends: [&'s Instant<'a, [Moved; 2], B>; 2],
    bends: [DVec3; 2],
    angle: f64,
}

impl<'s, 'a, B: Hull> Turning<'s, 'a, B> {
    fn new(
        span: &'s Span<'a, B>,
        ends: [&'s Instant<'a, [Moved; 2], B>; 2],
        normals: [DVec3; 2],
        which: usize,
        h: f64,
    ) -> Self {
        let piece = span.piece(which);
        let angle = piece.rate * h;
        let sideways = piece.axis.cross(normals[1] - normals[0]) * (2.0 * angle);
        let sign = if which == 0 { 1.0 } else { -1.0 };
        let bends = normals.map(|n| (across(n, piece.axis) * (angle * angle) + sideways) * sign);
        Self { which, span, ends, bends, angle: angle.abs() }
    }

    fn most(&self) -> f64 {
        self.bends[0].length().max(self.bends[1].length())
    }

    fn loose(&self) -> f64 {
        if self.angle == 0.0 {
            return 0.0;
        }
        let piece = self.span.piece(self.which);
        let reach = self.span.body(self.which).reach();
        self.most() * (reach + across(piece.arm, piece.axis).length()) * (1.0 + 1e-6)
    }

    fn tight(&self, supports: &impl Supports<B>) -> f64 {
        // Beyond that arcs are no arcs any more.
        if self.angle == 0.0 || self.angle > 2.0 {
            return self.loose();
        }
        let body = self.span.body(self.which);
        let mut most = f64::NEG_INFINITY;
        for end in self.ends {
            let moved = &end.moved[self.which];
            for bend in self.bends {
                let reach = supports.reach(body, moved.rotation.transpose() * bend);
                most = most.max(bend.dot(moved.arm) + reach);
            }
        }
        let size = body.reach() + self.span.piece(self.which).arm.length();
        let most = most + ROUNDED * self.most() * size;
        // cos(x) >= 1 - x^2 / 2.
        let widest = 1.0 / (1.0 - 0.125 * self.angle * self.angle);
        if most > 0.0 { most * widest * (1.0 + ROUNDED) } else { most }
    }
}

/// The part across a unit vector.
pub(super) fn across(v: DVec3, axis: DVec3) -> DVec3 {
    v - axis * axis.dot(v)
}
