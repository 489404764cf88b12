//! Pieces: `phi` is affine where the features in contact stay the same (the paper, section III-C).
//!
//! `(X, Y) = (x - x0, y - y0)` are the levels relative to the levels `(x0, y0)` of a planar problem. A *piece* is an
//! affine function of `(X, Y)` with a weight:
//! - weight 1: bounds `phi` from below,
//! - weight 0: positive only where the sections have no point in common.
//!
//! Its normal is that of a supporting plane of both bodies.

use glam::{DVec2, DVec3};

use super::crossing::SectionEdge;
use super::planar::PlanarAnswer;

/// An affine function `value + gradient . (X, Y)`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Affine {
    pub(super) value: f64,
    pub(super) gradient: DVec2,
}

/// Covectors of a query in the setting frame, for section axes `a` of P and `b` of Q.
#[derive(Debug, Clone, Copy)]
pub(super) struct SectionFrame {
    /// `a / (a . d)` and `b / (b . d)`.
    pub(super) axes: [DVec3; 2],
    /// `a . d` and `b . d`.
    pub(super) along: [f64; 2],
    /// Covectors of the shadow coordinates `h` and `g`.
    pub(super) shadow: [DVec3; 2],
}

impl SectionFrame {
    /// Returns the part of `phi` that depends on the levels alone, `y/(b.d) - x/(a.d)`.
    pub(super) fn base_height(&self, levels: [f64; 2]) -> f64 {
        levels[1] / self.along[1] - levels[0] / self.along[0]
    }
}

/// An affine bound with its weight and normal: `weight * t >= value + gradient . (X, Y)` and
/// `normal . d = weight`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LinearPiece {
    pub(super) bound: Affine,
    pub(super) weight: f64,
    pub(super) normal: DVec3,
}

impl LinearPiece {
    /// Builds the bound `t` that a supporting plane of the bodies proves for all levels.
    pub(super) fn from_supporting_plane(t: f64, normal: DVec3) -> Self {
        Self { bound: Affine { value: t, gradient: DVec2::ZERO }, weight: 1.0, normal }
    }
}

impl PlanarAnswer {
    /// Returns the piece of the answer at `levels`, without the constant of the section pair.
    pub(super) fn linear_piece(&self, frame: &SectionFrame, levels: [f64; 2]) -> LinearPiece {
        let base = frame.base_height(levels);
        let slope = DVec2::new(-1.0 / frame.along[0], 1.0 / frame.along[1]);
        match self {
            Self::Vertex { upper, vertex, .. } => LinearPiece {
                bound: Affine {
                    value: base + vertex.h(),
                    gradient: slope + level_axis(*upper) * vertex.drift.x,
                },
                weight: 1.0,
                normal: frame.axes[1 - upper],
            },
            Self::Edges { edges, contact } => {
                let motion = contact_motion(edges);
                let [r, s] = edges.each_ref().map(|edge| edge.direction);
                let [c, g] = frame.shadow;
                LinearPiece {
                    bound: Affine {
                        value: base + contact.x,
                        gradient: slope + DVec2::new(motion[0].x, motion[1].x),
                    },
                    weight: 1.0,
                    normal: frame.axes[0] + (c * r.y - g * r.x) * (s.x / r.perp_dot(s)),
                }
            }
            Self::Separated { u, supports } => LinearPiece {
                bound: Affine {
                    value: u.dot(supports[1].w - supports[0].w),
                    gradient: DVec2::new(-u.dot(supports[0].drift), u.dot(supports[1].drift)),
                },
                weight: 0.0,
                normal: frame.shadow[0] * u.x + frame.shadow[1] * u.y,
            },
        }
    }
}

/// Returns the unit vector of a body's level in the plane of levels.
pub(super) fn level_axis(body: usize) -> DVec2 {
    if body == 0 { DVec2::X } else { DVec2::Y }
}

/// Returns the derivatives of the point where the lines of two section edges intersect, with respect to each
/// level.
pub(super) fn contact_motion(edges: &[SectionEdge; 2]) -> [DVec2; 2] {
    let [r, s] = edges.each_ref().map(|edge| edge.direction);
    let cross = r.perp_dot(s);
    // A line moves across itself by `direction x drift`.
    [
        s * (r.perp_dot(edges[0].longer_end().drift) / cross),
        r * (s.perp_dot(edges[1].longer_end().drift) / cross) * -1.0,
    ]
}
