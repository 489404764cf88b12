//! Pieces and cells: where the features in contact stay the same, `phi` is linear (the paper,
//! section III-C).
//!
//! Notation. `(X, Y) = (x - x0, y - y0)` around the levels `(x0, y0)` of a planar problem. A
//! *piece* is an affine function that bounds `phi` from below (weight 1), or that is positive only
//! where the sections miss each other (weight 0). The covector of a piece, in the shadow plane's
//! terms, is what the supporting plane of the sections contributes to the contact normal. A *cell*
//! is the set, an intersection of half-planes, on which the piece is `phi` itself.

use glam::{DVec2, DVec3};

use super::planar::Planar;
use super::crossing::Bracket;

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

/// At most so many half-planes bound a cell: those of a vertex contact.
const CELL_SIDES: usize = 12;

/// An intersection of half-planes `value + gradient . (X, Y) >= 0` around the origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    sides: [Affine; CELL_SIDES],
    count: usize,
}

impl Cell {
    fn new() -> Self {
        Self { sides: [Affine::default(); CELL_SIDES], count: 0 }
    }

    /// Rounding may put the origin outside by a little: it counts as on the boundary.
    fn keep(&mut self, value: f64, gradient: DVec2) {
        self.sides[self.count] = Affine { value: value.max(0.0), gradient };
        self.count += 1;
    }

    /// `levels[body]` within all of `ranges`.
    fn keep_levels(&mut self, unit: DVec2, level: f64, ranges: &[[f64; 2]]) {
        let low = ranges.iter().map(|r| r[0]).fold(f64::NEG_INFINITY, f64::max);
        let high = ranges.iter().map(|r| r[1]).fold(f64::INFINITY, f64::min);
        self.keep(level - low, unit);
        self.keep(high - level, -unit);
    }

    /// The least change of `gradient . (X, Y)` over the cell: the simplex method in the plane, from
    /// the inside.
    pub(super) fn least(&self, gradient: DVec2) -> f64 {
        let mut at = DVec2::ZERO;
        let mut way = -gradient;
        let mut on: Option<usize> = None;
        // A vertex where more than two sides meet may be visited more than once, hence the limit.
        for _ in 0..=self.count {
            let Some((side, step)) = self.ray(at, way, on) else { break };
            at += way * step;
            let along = self.sides[side].gradient.perp();
            let descent = -gradient.dot(along);
            way = if descent < 0.0 { -along } else { along };
            let leaves = on.is_some_and(|side| self.sides[side].gradient.dot(way) < 0.0);
            if descent == 0.0 || leaves {
                break;
            }
            on = Some(side);
        }
        gradient.dot(at)
    }

    /// The side that a ray hits first, and after which multiple of `way`.
    fn ray(&self, at: DVec2, way: DVec2, on: Option<usize>) -> Option<(usize, f64)> {
        // Without branches in the first pass: they would be unpredictable.
        let mut steps = [f64::INFINITY; CELL_SIDES];
        for (step, side) in steps.iter_mut().zip(&self.sides) {
            let rate = -side.gradient.dot(way);
            let slack = (side.value + side.gradient.dot(at)).max(0.0);
            *step = if rate > 0.0 { slack / rate } else { f64::INFINITY };
        }
        if let Some(side) = on {
            steps[side] = f64::INFINITY;
        }
        let least = steps
            .iter()
            .fold(f64::INFINITY, |least, &step| if step < least { step } else { least });
        let side = steps.iter().position(|&step| step == least)?;
        (least < f64::INFINITY).then_some((side, least))
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

    /// The cell of a contact.
    pub(super) fn cell(&self, levels: [f64; 2]) -> Option<Cell> {
        let mut cell = Cell::new();
        match self {
            Self::Vertex { upper, vertex, left, right } => {
                let (own, other) = (unit(*upper), unit(1 - *upper));
                cell.keep_levels(own, levels[*upper], &[vertex.levels]);
                let ranges =
                    [left.low.levels, left.high.levels, right.low.levels, right.high.levels];
                cell.keep_levels(other, levels[1 - *upper], &ranges);
                for (edge, inward) in [(left, 1.0), (right, -1.0)] {
                    let normal = edge.direction.perp() * inward;
                    cell.keep(
                        normal.dot(vertex.w - edge.low.w),
                        own * normal.dot(vertex.drift) - other * normal.dot(edge.low.drift),
                    );
                    for (end, sign) in [(&edge.low, 1.0), (&edge.high, -1.0)] {
                        cell.keep(
                            sign * (vertex.h() - end.h()),
                            sign * (own * vertex.drift.x - other * end.drift.x),
                        );
                    }
                }
            }
            Self::Edges { edges, contact } => {
                let motion = contact_motion(edges);
                for (body, edge) in edges.iter().enumerate() {
                    let ranges = [edge.low.levels, edge.high.levels];
                    cell.keep_levels(unit(body), levels[body], &ranges);
                    for (end, sign) in [(&edge.low, 1.0), (&edge.high, -1.0)] {
                        let along = edge.direction * sign;
                        let moved = DVec2::new(along.dot(motion[0]), along.dot(motion[1]));
                        cell.keep(
                            along.dot(*contact - end.w),
                            moved - unit(body) * along.dot(end.drift),
                        );
                    }
                }
            }
            Self::Separated { .. } => return None,
        }
        Some(cell)
    }
}

/// The unit vector of a body's level.
fn unit(body: usize) -> DVec2 {
    if body == 0 { DVec2::X } else { DVec2::Y }
}

/// How the point where two moving lines cross moves per unit of each level.
fn contact_motion(edges: &[Bracket; 2]) -> [DVec2; 2] {
    let [r, s] = edges.each_ref().map(|edge| edge.direction);
    let cross = r.perp_dot(s);
    // A line moves across itself by `direction x drift`.
    [
        s * (r.perp_dot(edges[0].low.drift) / cross),
        r * (s.perp_dot(edges[1].low.drift) / cross) * -1.0,
    ]
}
