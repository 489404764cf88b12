//! Bounds for one plane over an interval: fixed, or carried by the moving body.
//!
//! - *Fixed* plane: the coordinate of each vertex along the normal is a sinusoid of the angle. The bound adds the
//!   extremes of both bodies and of the vector between the axes.
//! - *Carried* plane: its normal rotates with the moving body. If both bodies have the same angular velocity, the fixed
//!   one only translates relative to the moving one. A difference of the angular velocities adds to the bound.
//!
//! Derivation: `docs/theory/motion-bounds.md`.

use glam::DVec3;

use super::curvature::perpendicular_part;
use super::span::{Instant, Span};
use colltrans_convex::body::VertexHull;
use colltrans_kernel::motion::{Piece, PiecePlacement};

/// Error bound of the sums in this module, relative to the sizes.
const SUM_ERROR: f64 = 1e-14;

/// Maximum relative difference of angular velocities that count as equal.
const SAME_SPIN: f64 = 1e-12;

/// Returns an upper bound of the loss of gap, over an interval, of the plane with a fixed normal.
pub(super) fn gap_loss<B: VertexHull>(
    span: &Span<B>,
    ends: [&Instant<[PiecePlacement; 2], B>; 2],
    normal: DVec3,
) -> f64 {
    let h = ends[1].time - ends[0].time;
    let drift = normal.dot(span.relative_velocity()) * h;
    let sizes = (0..2).map(|which| span.piece(which).arm.length() + span.body(which).reach());
    let size = sizes.sum::<f64>() + span.relative_velocity().length() * h;
    let total_rise = max_rise(span, ends, 0, normal) + max_rise(span, ends, 1, -normal);
    // The rise is computed from places that have errors at both ends.
    total_rise - drift.min(0.0) + 2.0 * span.error + SUM_ERROR * size
}

/// Returns an upper bound of the rise, within an interval, of the highest point of a body along a normal.
fn max_rise<B: VertexHull>(
    span: &Span<B>,
    ends: [&Instant<[PiecePlacement; 2], B>; 2],
    which: usize,
    normal: DVec3,
) -> f64 {
    let (piece, body) = (span.piece(which), span.body(which));
    let angle = piece.rate * (ends[1].time - ends[0].time);
    if angle == 0.0 {
        return 0.0;
    }
    let moved = ends.map(|end| &end.moved[which]);
    // From nearly half a turn on, the peak is assumed to be inside the interval. This only weakens the bound.
    let around = angle.abs() >= 3.0;
    let [n, side] =
        [perpendicular_part(normal, piece.axis), normal.cross(piece.axis) * angle.signum()];
    let along = normal - n;
    let (mut highest, mut highest_at_start) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for v in body.hull_vertices() {
        let first = moved[0].arm + moved[0].rotation * *v;
        let last = moved[1].arm + moved[1].rotation * *v;
        // The slopes at both ends decide whether the peak is between them.
        let peak = around || (side.dot(first) > 0.0 && side.dot(last) < 0.0);
        let start_height = normal.dot(first);
        let top = if peak {
            let (a, b) = (n.dot(first), side.dot(first));
            along.dot(first) + (a * a + b * b).sqrt()
        } else {
            start_height.max(normal.dot(last))
        };
        highest = highest.max(top);
        highest_at_start = highest_at_start.max(start_height);
    }
    highest - highest_at_start
}

/// Returns an upper bound of the gap that a plane loses while the moving body carries it for a time `h`. `offset` is
/// the vector from the axis of the moving body to that of the fixed body at the start. Returns infinity unless both
/// bodies rotate.
pub(super) fn carried_gap_loss<B: VertexHull>(
    span: &Span<B>,
    offset: DVec3,
    h: f64,
    normal: DVec3,
) -> f64 {
    let [p, q] = [span.piece(0), span.piece(1)];
    if p.rate == 0.0 || q.rate == 0.0 {
        return f64::INFINITY;
    }
    let arm = |piece: &Piece| piece.arm.length();
    let size = offset.length() + arm(p) + arm(q);
    let axis_distance =
        perpendicular_part(offset, p.axis).length() + 4.0 * span.error + SUM_ERROR * size;
    let rotation_length = (p.rate.abs() * h).min(2.0) * normal.length();
    let spin_difference = q.axis * q.rate - p.axis * p.rate;
    let spin_error = if spin_difference == DVec3::ZERO {
        0.0
    } else {
        spin_difference.length() + SUM_ERROR * p.rate.abs()
    };
    let deviation_rate = spin_error * (arm(q) + span.body(1).reach()) * normal.length();
    let drift = span.relative_velocity();
    let axial_rate = (-normal.dot(p.axis) * drift.dot(p.axis)).max(0.0);
    let lateral_rate =
        perpendicular_part(drift, p.axis).length() * perpendicular_part(normal, p.axis).length();
    let rounded = SUM_ERROR * drift.length() * normal.length();
    (axis_distance * rotation_length + (deviation_rate + axial_rate + lateral_rate + rounded) * h)
        * (1.0 + 1e-12)
}

/// Checks whether both bodies have the same angular velocity, up to rounding.
pub(super) fn has_same_spin<B: VertexHull>(span: &Span<B>) -> bool {
    let [p, q] = [span.piece(0), span.piece(1)];
    let spin_difference = q.axis * q.rate - p.axis * p.rate;
    p.rate != 0.0 && spin_difference.length() <= SAME_SPIN * p.rate.abs()
}
