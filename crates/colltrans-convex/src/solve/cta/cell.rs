//! Cells: where a piece is `phi` itself, and what ends at their sides (the paper, section III-C).
//!
//! Notation. `(X, Y)` as in [`super::piece`]. A cell is an intersection of half-planes around the
//! origin. A section edge lies on a face of its body, whatever the level; in the plane of the
//! position along the edge and the level that face is a convex polygon, and the cell is where the
//! contact stays in it. So it does not end where the section edge passes a mesh vertex, and each
//! side is tagged with the mesh edge over which the contact leaves. Cells only guess: a face of many
//! sides, or one that the contact seems to have left by rounding, is replaced by the part between
//! the two mesh edges that cross, within their levels.

use glam::DVec2;

use super::crossing::{Bracket, Crossing, is_horizontal};
use super::piece::{Affine, contact_motion, unit};
use super::planar::Planar;
use super::section::FACE_SIDES;
use super::sectioned_body::{Point, Side};
use colltrans_kernel::noise;

/// At most so many half-planes bound a cell: those of a vertex contact.
const CELL_SIDES: usize = 2 + 2 * (1 + FACE_SIDES);

/// What ends at a side of a cell, for a body by its index.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) enum End {
    /// Nothing that has a name.
    #[default]
    Level,
    /// The contact leaves a face over this half-edge.
    Edge(usize, u32),
    /// The contact reaches the end of a mesh edge.
    Vertex(usize, u32),
    /// The contact reaches the face of this half-edge.
    Face(usize, u32),
}

/// An intersection of half-planes `value + gradient . (X, Y) >= 0` around the origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    sides: [Affine; CELL_SIDES],
    ends: [End; CELL_SIDES],
    count: usize,
}

/// The best point of a cell.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Best {
    /// Where it is.
    pub(super) at: DVec2,
    /// The change of the piece's value up to there.
    pub(super) change: f64,
    /// The sides on which the simplex method ended.
    on: [Option<usize>; 2],
}

impl Cell {
    fn new() -> Self {
        Self { sides: [Affine::default(); CELL_SIDES], ends: [End::Level; CELL_SIDES], count: 0 }
    }

    /// Rounding may put the origin outside by a little: it counts as on the boundary.
    fn keep(&mut self, value: f64, gradient: DVec2, end: End) {
        self.sides[self.count] = Affine { value: value.max(0.0), gradient };
        self.ends[self.count] = end;
        self.count += 1;
    }

    pub(super) fn half_planes(&self) -> &[Affine] {
        &self.sides[..self.count]
    }

    /// The best point for a gradient: the simplex method in the plane, from the inside.
    pub(super) fn best(&self, gradient: DVec2) -> Best {
        let mut best = Best { at: DVec2::ZERO, change: 0.0, on: [None; 2] };
        let mut way = -gradient;
        let mut on: Option<usize> = None;
        // A vertex where more than two sides meet may be visited more than once, hence the limit.
        for _ in 0..=self.count {
            let Some((side, step)) = self.ray(best.at, way, on) else { break };
            best.at += way * step;
            best.on = [on, Some(side)];
            let along = self.sides[side].gradient.perp();
            let descent = -gradient.dot(along);
            way = if descent < 0.0 { -along } else { along };
            let leaves = on.is_some_and(|side| self.sides[side].gradient.dot(way) < 0.0);
            if descent == 0.0 || leaves {
                break;
            }
            on = Some(side);
        }
        best.change = gradient.dot(best.at);
        best
    }

    /// The side that a ray hits first, and after which multiple of `way`.
    fn ray(&self, at: DVec2, way: DVec2, on: Option<usize>) -> Option<(usize, f64)> {
        let (mut nearest, mut least) = (0, f64::INFINITY);
        for (index, side) in self.sides[..self.count].iter().enumerate() {
            let rate = -side.gradient.dot(way);
            let slack = (side.value + side.gradient.dot(at)).max(0.0);
            let ahead = rate > 0.0 && on != Some(index);
            // Without branches: they would be unpredictable.
            let step = if ahead { slack / rate } else { f64::INFINITY };
            nearest = if step < least { index } else { nearest };
            least = least.min(step);
        }
        (least < f64::INFINITY).then_some((nearest, least))
    }

    /// What ends at the sides that meet in the best point, up to rounding.
    pub(super) fn ends_at(&self, best: &Best) -> Ends<'_> {
        let far = best.at.abs().element_sum();
        let mut meet = 0;
        for (index, side) in self.sides[..self.count].iter().enumerate() {
            let slack = side.value + side.gradient.dot(best.at);
            let size = side.value + side.gradient.abs().element_sum() * far;
            meet |= u32::from(slack <= noise::SECTION * size) << index;
        }
        for index in best.on.into_iter().flatten() {
            meet |= 1 << index;
        }
        Ends { cell: self, meet }
    }
}

/// What ends at some sides of a cell.
#[derive(Debug, Clone)]
pub(super) struct Ends<'a> {
    cell: &'a Cell,
    /// One bit for each side.
    meet: u32,
}

impl Iterator for Ends<'_> {
    type Item = End;

    fn next(&mut self) -> Option<End> {
        let index = self.meet.trailing_zeros();
        let end = *self.cell.ends.get(index as usize)?;
        self.meet &= self.meet - 1;
        Some(end)
    }
}

/// The face that an edge of a section lies on, by a half-edge, and the sense of its boundary in the
/// plane of the position along the edge and the level: 1 counter-clockwise.
pub(super) fn face_of(side: &Side, edge: &Bracket) -> Option<(u32, f64)> {
    let topology = side.topology;
    let face = |h: u32| topology.half_edge(h).face;
    let twin = |h: u32| topology.half_edge(h).twin;
    let (low, high) = (edge.low.up, edge.high.up);
    if face(high) == face(twin(low)) {
        Some((high, 1.0))
    } else if face(low) == face(twin(high)) {
        Some((low, -1.0))
    } else {
        None
    }
}

/// Where the contact is on a section edge: its position as measured by a covector, and how that
/// changes with the levels.
#[derive(Debug, Clone, Copy)]
struct OnEdge<'a> {
    body: usize,
    edge: &'a Bracket,
    level: f64,
    measure: DVec2,
    position: f64,
    motion: DVec2,
}

/// A corner of a face, relative to the contact: its position along the edge and its level, and what
/// rounding can make of either.
#[derive(Debug, Clone, Copy)]
struct Corner {
    along: f64,
    rise: f64,
    slack: [f64; 2],
}

impl OnEdge<'_> {
    fn corner(&self, side: &Side, vertex: u32) -> Corner {
        let Point { level, shadow } = side.point(vertex);
        let [h, g] = (self.measure * shadow).to_array();
        Corner {
            along: h + g - self.position,
            rise: level - self.level,
            slack: [
                noise::SECTION * (h.abs() + g.abs() + self.position.abs()),
                noise::SECTION * (level.abs() + self.level.abs()),
            ],
        }
    }

    /// The edge of its face between two corners as a half-plane; `None` if the contact is beyond it
    /// by more than rounding, or it has no direction.
    fn side(&self, [from, to]: [&Corner; 2], sense: f64) -> Option<Affine> {
        let (along, rise) = (to.along - from.along, to.rise - from.rise);
        let value = sense * (from.along * to.rise - to.along * from.rise);
        let error = along.abs() * from.slack[1] + rise.abs() * from.slack[0];
        let gradient = (unit(self.body) * along - self.motion * rise) * sense;
        let directed =
            along.abs() > from.slack[0] + to.slack[0] || rise.abs() > from.slack[1] + to.slack[1];
        (value >= -error && directed).then_some(Affine { value, gradient })
    }
}

impl Cell {
    /// The contact stays on the face of an edge.
    fn keep_on(&mut self, on: &OnEdge, side: &Side) {
        let kept = self.count;
        if self.keep_face(on, side).is_none() {
            self.count = kept;
            self.keep_between(on);
        }
    }

    fn keep_face(&mut self, on: &OnEdge, side: &Side) -> Option<()> {
        let [bottom, top] = side.range();
        if on.edge.steeper().span() <= noise::SECTION * (top - bottom) {
            return None;
        }
        let (half_edge, sense) = face_of(side, on.edge)?;
        let topology = side.topology;
        let boundary = topology.face(topology.half_edge(half_edge).face);
        if boundary.len() > FACE_SIDES {
            return None;
        }
        let corner = |h: u32| on.corner(side, topology.origin(h));
        let first = corner(boundary.start);
        let mut from = first;
        for h in boundary.clone() {
            let to = if h + 1 < boundary.end { corner(h + 1) } else { first };
            let Affine { value, gradient } = on.side([&from, &to], sense)?;
            self.keep(value, gradient, End::Edge(on.body, h));
            from = to;
        }
        Some(())
    }

    /// The contact stays between the ends of an edge, and these on their mesh edges.
    fn keep_between(&mut self, on: &OnEdge) {
        let Bracket { low, high, .. } = on.edge;
        let own = unit(on.body);
        self.keep(on.level - low.levels[0].max(high.levels[0]), own, End::Level);
        self.keep(low.levels[1].min(high.levels[1]) - on.level, -own, End::Level);
        for (end, sign) in [(low, 1.0), (high, -1.0)] {
            self.keep(
                sign * (on.position - on.measure.dot(end.w)),
                sign * (on.motion - own * on.measure.dot(end.drift)),
                End::Edge(on.body, end.up),
            );
        }
    }

    /// A vertex of section `upper` stays in the other section: on its mesh edge, and between two
    /// edges at its height.
    fn keep_inside(
        &mut self,
        (upper, vertex): (usize, &Crossing),
        [left, right]: [&Bracket; 2],
        sides: &[Side; 2],
        levels: [f64; 2],
    ) {
        let lower = 1 - upper;
        let (own, other) = (unit(upper), unit(lower));
        let [bottom, top] = vertex.levels;
        self.keep(levels[upper] - bottom, own, End::Vertex(upper, vertex.vertices[0]));
        self.keep(top - levels[upper], -own, End::Vertex(upper, vertex.vertices[1]));
        for (edge, inward) in [(left, 1.0), (right, -1.0)] {
            let normal = edge.direction.perp() * inward;
            let face = face_of(&sides[lower], edge);
            let end = edge.steeper();
            self.keep(
                normal.dot(vertex.w - end.w),
                own * normal.dot(vertex.drift) - other * normal.dot(end.drift),
                face.map_or(End::Level, |(h, _)| End::Face(lower, h)),
            );
            let on = OnEdge {
                body: lower,
                edge,
                level: levels[lower],
                measure: DVec2::X,
                position: vertex.h(),
                motion: own * vertex.drift.x,
            };
            if is_horizontal(edge.direction) {
                self.keep_between(&on);
            } else {
                self.keep_on(&on, &sides[lower]);
            }
        }
    }
}

impl Planar {
    /// The cell of a contact.
    pub(super) fn cell(&self, sides: &[Side; 2], levels: [f64; 2]) -> Option<Cell> {
        let mut cell = Cell::new();
        match self {
            Self::Vertex { upper, vertex, left, right } => {
                cell.keep_inside((*upper, vertex), [left, right], sides, levels);
            }
            Self::Edges { edges, contact } => {
                let motion = contact_motion(edges);
                for (body, edge) in edges.iter().enumerate() {
                    let measure = edge.direction;
                    let on = OnEdge {
                        body,
                        edge,
                        level: levels[body],
                        measure,
                        position: measure.dot(*contact),
                        motion: DVec2::new(measure.dot(motion[0]), measure.dot(motion[1])),
                    };
                    cell.keep_on(&on, &sides[body]);
                }
            }
            Self::Separated { .. } => return None,
        }
        Some(cell)
    }
}
