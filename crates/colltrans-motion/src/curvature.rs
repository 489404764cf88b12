//! Curvature bounds: prove that two rotating bodies are separated between the times of two planes.
//!
//! With gaps `s_a`, `s_b` at the ends of an interval, the gap at its share `x` is at least `(1 - x) s_a + x s_b - C x
//! (1 - x) / 2`. It is positive throughout if `sqrt(s_a) + sqrt(s_b) > sqrt(C / 2)`. Derivation:
//! `docs/theory/motion-bounds.md`.
//!
//! - `C = C_P + C_Q + 2 dn.dc`: `dn` is the change of the normal, `dc` that of the vector between the axes. A tolerated
//!   depth `w` adds `2 w |dn|^2`.
//! - `C_P`: the maximum support of `P`, in its frame, along `W = alpha^2 n_across + 2 alpha k x dn`; `-W` for `Q`.
//!   `alpha` is the angle of rotation about the axis `k`, `n_across` the part of the normal perpendicular to `k`.
//! - *Loose* bound of `C_P`: `max |W|` times the largest distance of the body from its axis. No support points are
//!   needed.
//! - *Tight* bound of `C_P`, up to 2 radians: four support points, divided by a lower bound of `cos(alpha / 2)`.

use glam::DVec3;

use super::span::{Instant, Span};
use colltrans_convex::body::{ConvexPolyhedron, VertexHull};
use colltrans_kernel::motion::PiecePlacement;

/// Relative error bound of the sums in this module.
const SUM_ERROR: f64 = 1e-13;

/// Relative margin of the square roots in a check. A search keeps twice this margin.
pub(super) const ROOT_MARGIN: f64 = 1e-9;

/// Returns the largest `C` for which the gaps at the ends prove the whole interval, with a relative margin.
pub(super) fn max_provable_curvature([a, b]: [f64; 2], spare: f64) -> f64 {
    let roots = (a.max(0.0).sqrt() + b.max(0.0).sqrt()) * (1.0 - spare);
    2.0 * roots * roots
}

/// Upper bounds of the support function of a body.
pub(super) trait SupportSearch<B> {
    /// Returns an upper bound of the support of the body along a direction of its frame, of any length.
    fn support_bound(&self, body: &B, normal: DVec3) -> f64;
}

/// Finds support points by hill climbing.
pub(super) struct HillClimbing;

impl SupportSearch<ConvexPolyhedron> for HillClimbing {
    fn support_bound(&self, body: &ConvexPolyhedron, normal: DVec3) -> f64 {
        let length = normal.length();
        if length == 0.0 {
            return 0.0;
        }
        let unit = normal / length;
        let (vertex, beyond) = body.support_with_excess(unit, body.support(unit).0);
        normal.dot(body.vertices()[vertex as usize]) + beyond * length
    }
}

/// Finds support points by a scan of all vertices.
pub(super) struct VertexScan;

impl<B: VertexHull> SupportSearch<B> for VertexScan {
    fn support_bound(&self, body: &B, normal: DVec3) -> f64 {
        body.hull_vertices().iter().map(|v| normal.dot(*v)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Computes an upper bound of `C` between two planes: the loose bound if it is at most `enough`, otherwise the tight
/// bound.
pub(super) fn curvature_bound<'a, B: VertexHull>(
    span: &Span<'a, B>,
    ends: [&Instant<'a, [PiecePlacement; 2], B>; 2],
    normals: [DVec3; 2],
    enough: f64,
    supports: &impl SupportSearch<B>,
) -> f64 {
    let h = ends[1].time - ends[0].time;
    let dn = normals[1] - normals[0];
    let drift = 2.0 * h * dn.dot(span.relative_velocity());
    let tolerated = 2.0 * (-span.min_gap).max(0.0) * dn.length_squared() * (1.0 + SUM_ERROR);
    let drift =
        drift + tolerated + SUM_ERROR * 2.0 * h * dn.length() * span.relative_velocity().length();
    let turns = [0, 1].map(|which| TurningBody::new(span, ends, normals, which, h));
    let loose = drift + turns.iter().map(TurningBody::loose_bound).sum::<f64>();
    if loose <= enough {
        return loose;
    }
    drift + turns.iter().map(|turn| turn.tight_bound(supports)).sum::<f64>()
}

/// Returns an upper bound of `C` divided by the square of the interval, for a normal that hardly rotates.
pub(super) fn typical_curvature<B: VertexHull>(span: &Span<B>) -> f64 {
    let of = |which: usize| {
        let piece = span.piece(which);
        let reach = span.body(which).reach() + perpendicular_part(piece.arm, piece.axis).length();
        piece.rate * piece.rate * reach
    };
    of(0) + of(1)
}

/// A body that rotates in an interval, with the vectors `W` at both ends.
struct TurningBody<'s, 'a, B> {
    which: usize,
    span: &'s Span<'a, B>,
    ends: [&'s Instant<'a, [PiecePlacement; 2], B>; 2],
    end_vectors: [DVec3; 2],
    angle: f64,
}

impl<'s, 'a, B: VertexHull> TurningBody<'s, 'a, B> {
    fn new(
        span: &'s Span<'a, B>,
        ends: [&'s Instant<'a, [PiecePlacement; 2], B>; 2],
        normals: [DVec3; 2],
        which: usize,
        h: f64,
    ) -> Self {
        let piece = span.piece(which);
        let angle = piece.rate * h;
        let sideways = piece.axis.cross(normals[1] - normals[0]) * (2.0 * angle);
        let sign = if which == 0 { 1.0 } else { -1.0 };
        let end_vectors = normals
            .map(|n| (perpendicular_part(n, piece.axis) * (angle * angle) + sideways) * sign);
        Self { which, span, ends, end_vectors, angle: angle.abs() }
    }

    /// Returns the larger length of the two vectors `W`.
    fn max_vector_length(&self) -> f64 {
        self.end_vectors[0].length().max(self.end_vectors[1].length())
    }

    /// Returns the loose bound of the part of `C` of this body.
    fn loose_bound(&self) -> f64 {
        if self.angle == 0.0 {
            return 0.0;
        }
        let piece = self.span.piece(self.which);
        let reach = self.span.body(self.which).reach();
        self.max_vector_length()
            * (reach + perpendicular_part(piece.arm, piece.axis).length())
            * (1.0 + 1e-6)
    }

    /// Returns the tight bound of the part of `C` of this body.
    fn tight_bound(&self, supports: &impl SupportSearch<B>) -> f64 {
        // The bound of the tight formula needs a smaller angle.
        if self.angle == 0.0 || self.angle > 2.0 {
            return self.loose_bound();
        }
        let body = self.span.body(self.which);
        let mut most = f64::NEG_INFINITY;
        for end in self.ends {
            let moved = &end.moved[self.which];
            for vector in self.end_vectors {
                let reach = supports.support_bound(body, moved.rotation.transpose() * vector);
                most = most.max(vector.dot(moved.arm) + reach);
            }
        }
        let size = body.reach() + self.span.piece(self.which).arm.length();
        let most = most + SUM_ERROR * self.max_vector_length() * size;
        // cos(x) >= 1 - x^2 / 2.
        let widest = 1.0 / (1.0 - 0.125 * self.angle * self.angle);
        if most > 0.0 { most * widest * (1.0 + SUM_ERROR) } else { most }
    }
}

/// Returns the part of a vector perpendicular to a unit vector.
pub(super) fn perpendicular_part(v: DVec3, axis: DVec3) -> DVec3 {
    v - axis * axis.dot(v)
}
