//! One plane for an interval: each vertex on its arc; or both bodies and the plane carried along.
//!
//! Notation. As [`bend`](super::bend). Along a fixed normal `n` a point `z` of a body is at `n.E z`, a
//! sinusoid of the angle: with `w` where it is at the beginning, `n.w_along + cos n.w_across + sin n.(k x
//! w)`. The axes drift apart evenly. The least gap over an interval is at least that of both extremes apart:
//! of the fixed body's lowest point at any time, the moving one's highest, and the axes'.
//!
//! *Carried* along by the moving body, a plane has the normal `E n`. In the frame that turns by `E`, the moving body
//! rests. If the fixed body also turns by `E`, it only translates in that frame: by `E' (c + v t) - c`, where `c` is the
//! vector between points of both axes and `v` the velocity of one relative to the other. Along `n`, the part of `v` along
//! the axis counts exactly. The parts of `c` and `v` across the axis turn, so they count with the part of `n` across the
//! axis. If the angular velocities differ, points of the fixed body are elsewhere by at most the difference, times
//! their distances from the point of the axis.

use glam::DVec3;

use super::bend::across;
use super::span::{Instant, Span};
use colltrans_convex::body::Hull;
use colltrans_kernel::motion::{Moved, Piece};

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

/// Returns how much of its gap a plane loses at most while the moving body carries it along for a time `h`; `offset` is
/// the vector from the moving body's axis to the fixed one's when that begins.
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
    let elsewhere = other * (arm(q) + span.body(1).reach()) * normal.length();
    let drift = span.drift();
    let sinking = (-normal.dot(p.axis) * drift.dot(p.axis)).max(0.0);
    let sideways = across(drift, p.axis).length() * across(normal, p.axis).length();
    let rounded = ROUNDED * drift.length() * normal.length();
    (beside * swung + (elsewhere + sinking + sideways + rounded) * h) * (1.0 + 1e-12)
}

/// Checks whether both bodies have one angular velocity, to rounding.
pub(super) fn is_one_spin<B: Hull>(span: &Span<B>) -> bool {
    let [p, q] = [span.piece(0), span.piece(1)];
    let spins = q.axis * q.rate - p.axis * p.rate;
    p.rate != 0.0 && spins.length() <= AS_ONE * p.rate.abs()
}
