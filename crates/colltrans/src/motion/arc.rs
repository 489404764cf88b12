//! One plane for an interval: each vertex on its arc; or both bodies and the plane carried along.
//!
//! Notation. As [`bend`](super::bend). Along a fixed normal `n` a point `z` of a body is at `n.E z`, a
//! sinusoid of the angle: with `w` where it is at the beginning, `n.w_along + cos n.w_across + sin n.(k x
//! w)`. The axes drift apart evenly. The least gap over an interval is at least that of both extremes apart:
//! of the fixed body's lowest point at any time, the moving one's highest, and the axes'.
//!
//! *Carried* along by the moving body a plane has the normal `E n`, and stays where it is for that one. Where the fixed
//! body turned by the same `E`, so it would for that one, but for the way `c` between points of both axes, of which `E n`
//! sees what is across the axis turned round, and what the axes drift apart. With another angular velocity its points
//! are elsewhere by at most the difference, times their distances from the axis' point.

use glam::DVec3;

use super::bend::across;
use super::span::{Instant, Span};
use crate::body::Hull;
use crate::body::motion::{Moved, Piece};

/// Sums here are off by less than this share of the sizes.
const ROUNDED: f64 = 1e-14;

/// Spins that differ by no more than this share are one.
const AS_ONE: f64 = 1e-12;

/// How much of the gap that a plane leaves at the first of two times is lost until the second, at most.
pub(super) fn lost<B: Hull>(
    span: &Span<B>,
    ends: [&Instant<[Moved; 2], B>; 2],
    normal: DVec3,
) -> f64 {
    let h = ends[1].time - ends[0].time;
    let drift = normal.dot(span.drift()) * h;
    let sizes = (0..2).map(|which| span.piece(which).arm.length() + span.body(which).reach());
    let size = sizes.sum::<f64>() + span.drift().length() * h;
    let risen = rise(span, ends, 0, normal) + rise(span, ends, 1, -normal);
    // What rises is computed of places that may be off at both ends.
    risen - drift.min(0.0) + 2.0 * span.error + ROUNDED * size
}

/// By how much the highest point of a body along a normal rises within an interval, at most.
fn rise<B: Hull>(
    span: &Span<B>,
    ends: [&Instant<[Moved; 2], B>; 2],
    which: usize,
    normal: DVec3,
) -> f64 {
    let (piece, body) = (span.piece(which), span.body(which));
    let angle = piece.rate * (ends[1].time - ends[0].time);
    if angle == 0.0 {
        return 0.0;
    }
    let moved = ends.map(|end| &end.moved[which]);
    // More than half a turn has its peak for certain, or is taken to have it.
    let around = angle.abs() >= 3.0;
    let [n, side] = [across(normal, piece.axis), normal.cross(piece.axis) * angle.signum()];
    let along = normal - n;
    let (mut highest, mut before) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for v in body.corners() {
        let first = moved[0].arm + moved[0].rotation * *v;
        let last = moved[1].arm + moved[1].rotation * *v;
        // The slopes at both ends tell whether the peak is between them.
        let peak = around || (side.dot(first) > 0.0 && side.dot(last) < 0.0);
        let here = normal.dot(first);
        let top = if peak {
            let (a, b) = (n.dot(first), side.dot(first));
            along.dot(first) + (a * a + b * b).sqrt()
        } else {
            here.max(normal.dot(last))
        };
        highest = highest.max(top);
        before = before.max(here);
    }
    highest - before
}

/// The same of a plane that is carried along by the moving body; `offset` is from the moving body's axis to the fixed one's
/// when it begins, `h` how long.
pub(super) fn carried<B: Hull>(span: &Span<B>, offset: DVec3, h: f64, normal: DVec3) -> f64 {
    let [p, q] = [span.piece(0), span.piece(1)];
    if p.rate == 0.0 || q.rate == 0.0 {
        return f64::INFINITY;
    }
    let arm = |piece: &Piece| piece.arm.length();
    let size = offset.length() + arm(p) + arm(q);
    let beside = across(offset, p.axis).length() + 4.0 * span.error + ROUNDED * size;
    let swung = (p.rate.abs() * h).min(2.0) * normal.length();
    let spins = q.axis * q.rate - p.axis * p.rate;
    let other = if spins == DVec3::ZERO { 0.0 } else { spins.length() + ROUNDED * p.rate.abs() };
    let elsewhere = other * (arm(q) + span.body(1).reach());
    let drift = span.drift().length();
    (beside * swung + (elsewhere + drift) * h * normal.length()) * (1.0 + 1e-12)
}

/// Whether both bodies spin as one, to rounding, so that halving time leads no further.
pub(super) fn is_one_spin<B: Hull>(span: &Span<B>) -> bool {
    let [p, q] = [span.piece(0), span.piece(1)];
    let spins = q.axis * q.rate - p.axis * p.rate;
    let size = span.body(0).reach() + span.body(1).reach();
    p.rate != 0.0
        && spins.length() <= AS_ONE * p.rate.abs()
        && span.drift().length() <= AS_ONE * size
}
