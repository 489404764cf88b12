//! Pieces: where the features in contact stay the same, `phi` is linear (the paper, section III-C).
//!
//! Notation. `(X, Y) = (x - x0, y - y0)` around the levels `(x0, y0)` of a planar problem. A
//! *piece* is an affine function that bounds `phi` from below (weight 1), or that is positive only
//! where the sections miss each other (weight 0). The covector of a piece, in the shadow plane's
//! terms, is what the supporting plane of the sections contributes to the contact normal.

use glam::{DVec2, DVec3};

use super::crossing::Bracket;
use super::planar::Planar;

/// An affine function of `(X, Y)`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Affine {
    pub(super) value: f64,
    pub(super) gradient: DVec2,
}

/// The directions of a query in the setting frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// `a / (a . d)` and `b / (b . d)`.
    pub(super) axes: [DVec3; 2],
    /// `a . d` and `b . d`.
    pub(super) along: [f64; 2],
    /// The covectors of the shadow coordinates `h` and `g`.
    pub(super) shadow: [DVec3; 2],
}

impl Frame {
    /// What the levels add to the height of the contact in `phi`.
    pub(super) fn base(&self, levels: [f64; 2]) -> f64 {
        levels[1] / self.along[1] - levels[0] / self.along[0]
    }
}

/// An affine bound with its weight and normal: `weight * t >= value + gradient . (X, Y)` and
/// `normal . d = weight`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Piece {
    pub(super) bound: Affine,
    pub(super) weight: f64,
    pub(super) normal: DVec3,
}

impl Piece {
    /// A supporting plane of the bodies: a bound that holds for all levels.
    pub(super) fn constant(t: f64, normal: DVec3) -> Self {
        Self { bound: Affine { value: t, gradient: DVec2::ZERO }, weight: 1.0, normal }
    }
}

impl Planar {
    /// The piece that the answer at `levels` gives, up to the constant of `t`.
    pub(super) fn piece(&self, frame: &Frame, levels: [f64; 2]) -> Piece {
        let base = frame.base(levels);
        let slope = DVec2::new(-1.0 / frame.along[0], 1.0 / frame.along[1]);
        match self {
            Self::Vertex { upper, vertex, .. } => Piece {
                bound: Affine {
                    value: base + vertex.h(),
                    gradient: slope + unit(*upper) * vertex.drift.x,
                },
                weight: 1.0,
                normal: frame.axes[1 - upper],
            },
            Self::Edges { edges, contact } => {
                let motion = contact_motion(edges);
                let [r, s] = edges.each_ref().map(|edge| edge.direction);
                let [c, g] = frame.shadow;
                Piece {
                    bound: Affine {
                        value: base + contact.x,
                        gradient: slope + DVec2::new(motion[0].x, motion[1].x),
                    },
                    weight: 1.0,
                    normal: frame.axes[0] + (c * r.y - g * r.x) * (s.x / r.perp_dot(s)),
                }
            }
            Self::Separated { u, supports } => Piece {
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

/// The unit vector of a body's level.
pub(super) fn unit(body: usize) -> DVec2 {
    if body == 0 { DVec2::X } else { DVec2::Y }
}

/// How the point where two moving lines cross moves per unit of each level.
pub(super) fn contact_motion(edges: &[Bracket; 2]) -> [DVec2; 2] {
    let [r, s] = edges.each_ref().map(|edge| edge.direction);
    let cross = r.perp_dot(s);
    // A line moves across itself by `direction x drift`.
    [
        s * (r.perp_dot(edges[0].steeper().drift) / cross),
        r * (s.perp_dot(edges[1].steeper().drift) / cross) * -1.0,
    ]
}
