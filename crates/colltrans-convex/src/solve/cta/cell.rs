//! Cells: the levels at which a piece equals `phi` (the paper, section III-C).
//!
//! A cell is an intersection of half-planes in `(X, Y)`, see [`super::piece`], that contains the origin.
//!
//! - A section edge lies on a face of its body at every level. In the plane of the position along the edge and
//!   the level, the face is a convex polygon, and the cell is where the contact stays in it. Therefore the cell
//!   does not end where the section edge passes a mesh vertex.
//! - Each side of a cell is tagged with its feature change, for example the mesh edge over which the contact
//!   leaves the face.
//! - Cells are only guesses. A face with more than [`MAX_FACE_SIDES`] sides, or one that the contact seems to
//!   have left by rounding, is replaced by the part between the two mesh edges that cross the level, within
//!   their levels.

use glam::DVec2;

use super::crossing::{Crossing, SectionEdge, is_horizontal};
use super::piece::{Affine, contact_motion, level_axis};
use super::planar::PlanarAnswer;
use super::section::MAX_FACE_SIDES;
use super::sectioned_body::{LevelPoint, SectionedBody};
use colltrans_kernel::noise;

/// Maximum number of half-planes of a cell, reached by a vertex contact.
const MAX_CELL_SIDES: usize = 2 + 2 * (1 + MAX_FACE_SIDES);

/// Change of the touching features at a side of a cell. The first number is the index of the body.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) enum FeatureChange {
    /// A change that names no feature.
    #[default]
    Unnamed,
    /// The contact leaves a face over this half-edge.
    Edge(usize, u32),
    /// The level reaches that of this vertex. If the contact is on a mesh edge that ends there, it reaches the vertex.
    Vertex(usize, u32),
    /// The contact reaches the face of this half-edge.
    Face(usize, u32),
}

/// An intersection of half-planes `value + gradient . (X, Y) >= 0` that contains the origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactCell {
    sides: [Affine; MAX_CELL_SIDES],
    changes: [FeatureChange; MAX_CELL_SIDES],
    count: usize,
}

/// The point of a cell at which a piece is least.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BestPoint {
    /// Levels relative to the origin of the cell.
    pub(super) offset: DVec2,
    /// Change of the piece's value from the origin to this point; not positive.
    pub(super) change: f64,
    /// Sides on which the simplex method ended.
    sides: [Option<usize>; 2],
}

impl ContactCell {
    pub(super) fn new() -> Self {
        Self {
            sides: [Affine::default(); MAX_CELL_SIDES],
            changes: [FeatureChange::Unnamed; MAX_CELL_SIDES],
            count: 0,
        }
    }

    /// Adds a half-plane. A negative `value` becomes 0: rounding may put the origin slightly outside, and the
    /// origin then counts as on the boundary.
    fn add_half_plane(&mut self, value: f64, gradient: DVec2, change: FeatureChange) {
        self.sides[self.count] = Affine { value: value.max(0.0), gradient };
        self.changes[self.count] = change;
        self.count += 1;
    }

    pub(super) fn half_planes(&self) -> &[Affine] {
        &self.sides[..self.count]
    }

    /// Finds the point at which a function with this gradient is least, by the simplex method in the plane from
    /// the origin.
    pub(super) fn best_point(&self, gradient: DVec2) -> BestPoint {
        let mut best = BestPoint { offset: DVec2::ZERO, change: 0.0, sides: [None; 2] };
        let mut direction = -gradient;
        let mut on: Option<usize> = None;
        // A vertex where more than two sides meet may be visited more than once, hence the limit.
        for _ in 0..=self.count {
            let Some((side, step)) = self.first_side_on_ray(best.offset, direction, on) else {
                break;
            };
            best.offset += direction * step;
            best.sides = [on, Some(side)];
            let along = self.sides[side].gradient.perp();
            let descent = -gradient.dot(along);
            direction = if descent < 0.0 { -along } else { along };
            let leaves = on.is_some_and(|side| self.sides[side].gradient.dot(direction) < 0.0);
            if descent == 0.0 || leaves {
                break;
            }
            on = Some(side);
        }
        best.change = gradient.dot(best.offset);
        best
    }

    /// Finds the first side that a ray from `at` hits, other than `on`, and the multiple of `direction` up to
    /// it. `None` if the ray hits no side.
    fn first_side_on_ray(
        &self,
        at: DVec2,
        direction: DVec2,
        on: Option<usize>,
    ) -> Option<(usize, f64)> {
        let (mut nearest, mut least) = (0, f64::INFINITY);
        for (index, side) in self.sides[..self.count].iter().enumerate() {
            let rate = -side.gradient.dot(direction);
            let slack = (side.value + side.gradient.dot(at)).max(0.0);
            let ahead = rate > 0.0 && on != Some(index);
            // Branch-free because the branches would be unpredictable.
            let step = if ahead { slack / rate } else { f64::INFINITY };
            nearest = if step < least { index } else { nearest };
            least = least.min(step);
        }
        (least < f64::INFINITY).then_some((nearest, least))
    }

    /// Returns the feature changes of the sides that meet in the best point, up to rounding.
    pub(super) fn changes_at(&self, best: &BestPoint) -> SideChanges<'_> {
        let far = best.offset.abs().element_sum();
        let mut active = 0;
        for (index, side) in self.sides[..self.count].iter().enumerate() {
            let slack = side.value + side.gradient.dot(best.offset);
            let size = side.value + side.gradient.abs().element_sum() * far;
            active |= u32::from(slack <= noise::SECTION * size) << index;
        }
        for index in best.sides.into_iter().flatten() {
            active |= 1 << index;
        }
        SideChanges { cell: self, active }
    }
}

/// Iterator over the feature changes of some sides of a cell.
#[derive(Debug, Clone)]
pub(super) struct SideChanges<'a> {
    cell: &'a ContactCell,
    /// Set of the remaining sides, one bit each.
    active: u32,
}

impl Iterator for SideChanges<'_> {
    type Item = FeatureChange;

    fn next(&mut self) -> Option<FeatureChange> {
        let index = self.active.trailing_zeros();
        let change = *self.cell.changes.get(index as usize)?;
        self.active &= self.active - 1;
        Some(change)
    }
}

/// Finds the face on which a section edge lies. Returns a half-edge of this face and a sign. The sign is 1 if the
/// boundary of the face is counter-clockwise in the plane whose axes are the position along the section edge and the
/// level, else -1. `None` if the mesh edges at the ends of the section edge do not bound a common face.
pub(super) fn face_of_edge(side: &SectionedBody, edge: &SectionEdge) -> Option<(u32, f64)> {
    let topology = side.topology;
    let face = |h: u32| topology.half_edge(h).face;
    let twin = |h: u32| topology.half_edge(h).twin;
    let (low, high) = (edge.low.half_edge, edge.high.half_edge);
    if face(high) == face(twin(low)) {
        Some((high, 1.0))
    } else if face(low) == face(twin(high)) {
        Some((low, -1.0))
    } else {
        None
    }
}

/// A contact on a section edge of one body.
#[derive(Debug, Clone, Copy)]
struct EdgeContact<'a> {
    /// Index of the body.
    body: usize,
    edge: &'a SectionEdge,
    /// Level of the section.
    level: f64,
    /// Covector of the shadow plane that measures positions along the edge.
    measure: DVec2,
    /// Position of the contact.
    position: f64,
    /// Gradient of the position with respect to both levels.
    motion: DVec2,
}

/// A corner of a face, relative to the contact.
#[derive(Debug, Clone, Copy)]
struct FaceCorner {
    /// Position along the edge.
    along: f64,
    /// Level.
    rise: f64,
    /// Bounds on the rounding errors of the position and of the level.
    slack: [f64; 2],
}

impl EdgeContact<'_> {
    /// Returns a vertex of the body relative to the contact.
    fn face_corner(&self, side: &SectionedBody, vertex: u32) -> FaceCorner {
        let LevelPoint { level, shadow } = side.level_point(vertex);
        let [h, g] = (self.measure * shadow).to_array();
        FaceCorner {
            along: h + g - self.position,
            rise: level - self.level,
            slack: [
                noise::SECTION * (h.abs() + g.abs() + self.position.abs()),
                noise::SECTION * (level.abs() + self.level.abs()),
            ],
        }
    }

    /// Returns the half-plane of levels at which the contact is on the inner side of the face's edge between
    /// two corners. `None` if the contact is outside by more than rounding, or if rounding hides the edge's
    /// direction.
    fn half_plane(&self, [from, to]: [&FaceCorner; 2], sense: f64) -> Option<Affine> {
        let (along, rise) = (to.along - from.along, to.rise - from.rise);
        let value = sense * (from.along * to.rise - to.along * from.rise);
        let error = along.abs() * from.slack[1] + rise.abs() * from.slack[0];
        let gradient = (level_axis(self.body) * along - self.motion * rise) * sense;
        let directed =
            along.abs() > from.slack[0] + to.slack[0] || rise.abs() > from.slack[1] + to.slack[1];
        (value >= -error && directed).then_some(Affine { value, gradient })
    }
}

impl ContactCell {
    /// Adds the sides within which the contact stays on the face of a section edge. Replaces the face by the
    /// part between the two mesh edges if [`Self::add_face`] returns `None`.
    fn add_edge_contact(&mut self, contact: &EdgeContact, side: &SectionedBody) {
        let count = self.count;
        if self.add_face(contact, side).is_none() {
            self.count = count;
            self.add_mesh_edges(contact);
        }
    }

    /// Adds one side for each edge of the face. `None`, possibly after some sides were added, if the face has
    /// more than [`MAX_FACE_SIDES`] sides, cannot be found, or does not contain the contact, or if rounding
    /// alone lifts the mesh edges across the level.
    fn add_face(&mut self, contact: &EdgeContact, side: &SectionedBody) -> Option<()> {
        let [bottom, top] = side.level_range();
        if contact.edge.longer_end().level_span() <= noise::SECTION * (top - bottom) {
            return None;
        }
        let (half_edge, sense) = face_of_edge(side, contact.edge)?;
        let topology = side.topology;
        let boundary = topology.face_half_edges(topology.half_edge(half_edge).face);
        if boundary.len() > MAX_FACE_SIDES {
            return None;
        }
        let corner = |h: u32| contact.face_corner(side, topology.half_edge(h).origin);
        let first = corner(boundary.start);
        let mut from = first;
        for h in boundary.clone() {
            let to = if h + 1 < boundary.end { corner(h + 1) } else { first };
            let Affine { value, gradient } = contact.half_plane([&from, &to], sense)?;
            self.add_half_plane(value, gradient, FeatureChange::Edge(contact.body, h));
            from = to;
        }
        Some(())
    }

    /// Adds the sides within which the contact stays between the ends of a section edge, and each of these ends on
    /// its mesh edge.
    fn add_mesh_edges(&mut self, contact: &EdgeContact) {
        let SectionEdge { low, high, .. } = contact.edge;
        let own = level_axis(contact.body);
        for (end, sign) in [(low, 1.0), (high, -1.0)] {
            self.add_half_plane(
                sign * (contact.position - contact.measure.dot(end.w)),
                sign * (contact.motion - own * contact.measure.dot(end.drift)),
                FeatureChange::Edge(contact.body, end.half_edge),
            );
        }
        // These sides follow, because a vertex narrows an edge, not the face.
        let bottom = if low.levels[0] > high.levels[0] { low } else { high };
        let top = if low.levels[1] < high.levels[1] { low } else { high };
        self.add_half_plane(
            contact.level - bottom.levels[0],
            own,
            FeatureChange::Vertex(contact.body, bottom.vertices[0]),
        );
        self.add_half_plane(
            top.levels[1] - contact.level,
            -own,
            FeatureChange::Vertex(contact.body, top.vertices[1]),
        );
    }

    /// Adds the sides of a vertex contact: the vertex of section `upper` stays on its mesh edge, and between
    /// the edges `left` and `right` of the other section at its height.
    fn add_vertex_contact(
        &mut self,
        (upper, vertex): (usize, &Crossing),
        [left, right]: [&SectionEdge; 2],
        sides: &[SectionedBody; 2],
        levels: [f64; 2],
    ) {
        let lower = 1 - upper;
        let (own, other) = (level_axis(upper), level_axis(lower));
        let [bottom, top] = vertex.levels;
        self.add_half_plane(
            levels[upper] - bottom,
            own,
            FeatureChange::Vertex(upper, vertex.vertices[0]),
        );
        self.add_half_plane(
            top - levels[upper],
            -own,
            FeatureChange::Vertex(upper, vertex.vertices[1]),
        );
        for (edge, inward) in [(left, 1.0), (right, -1.0)] {
            let normal = edge.direction.perp() * inward;
            let face = face_of_edge(&sides[lower], edge);
            let end = edge.longer_end();
            self.add_half_plane(
                normal.dot(vertex.w - end.w),
                own * normal.dot(vertex.drift) - other * normal.dot(end.drift),
                face.map_or(FeatureChange::Unnamed, |(h, _)| FeatureChange::Face(lower, h)),
            );
            let contact = EdgeContact {
                body: lower,
                edge,
                level: levels[lower],
                measure: DVec2::X,
                position: vertex.h(),
                motion: own * vertex.drift.x,
            };
            if is_horizontal(edge.direction) {
                self.add_mesh_edges(&contact);
            } else {
                self.add_edge_contact(&contact, &sides[lower]);
            }
        }
    }
}

impl PlanarAnswer {
    /// Adds the sides of the cell of a contact to `cell`, which has none. Returns `false` if the sections are separated.
    pub(super) fn add_contact_cell(
        &self,
        sides: &[SectionedBody; 2],
        levels: [f64; 2],
        cell: &mut ContactCell,
    ) -> bool {
        match self {
            Self::Vertex { upper, vertex, left, right } => {
                cell.add_vertex_contact((*upper, vertex), [left, right], sides, levels);
            }
            Self::Edges { edges, contact } => {
                let motion = contact_motion(edges);
                for (body, edge) in edges.iter().enumerate() {
                    let measure = edge.direction;
                    let contact = EdgeContact {
                        body,
                        edge,
                        level: levels[body],
                        measure,
                        position: measure.dot(*contact),
                        motion: DVec2::new(measure.dot(motion[0]), measure.dot(motion[1])),
                    };
                    cell.add_edge_contact(&contact, &sides[body]);
                }
            }
            Self::Separated { .. } => return false,
        }
        true
    }
}
