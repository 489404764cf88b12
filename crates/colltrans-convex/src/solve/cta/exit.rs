//! The exit test: checks whether the best point of a cell solves the problem (line 6 of the paper's algorithm).
//!
//! The sides of a cell that meet in its best point `q` name the *features* of P and Q that touch there: a
//! vertex, an edge or a face. `q` minimises `phi` exactly if these features have a common normal `n`,
//! `n . d > 0`, that supports P outward and Q inward (`docs/theory/section-minimisation.md`).
//!
//! - A face or two crossing edges leave one normal, which is compared with the neighbours of the features. If
//!   it does not support a body, the result names the faces that extend beyond its plane: `phi` falls where the
//!   contact passes on to them.
//! - Other features leave a linear programme in the two lateral parts of `n`.
//! - A hit is a proof up to rounding if the height of the plane is that of `q`. If it is not, ties have named
//!   features that do not touch, and the test misses. A miss costs a step. Portal refinement proves the result
//!   of a hit.

use glam::{DMat3, DVec2, DVec3};

use super::cell::{FeatureChange, SideChanges, face_of_edge};
use super::planar::PlanarAnswer;
use super::region::LevelRegion;
use super::sectioned_body::SectionedBody;
use crate::body::MAX_SCANNED_NEIGHBOURS;
use crate::setting::{Setting, TwoBodies, VertexPair};
use colltrans_kernel::topology::Topology;

/// Maximum difference between the heights of the supporting plane and of the best point at which the exit test
/// succeeds, as a share of the bodies' extent along the direction. If the plane does not touch `M` in spite of a
/// smaller difference, portal refinement finds the lower face. `docs/theory/section-minimisation.md` derives the value.
pub(super) const HEIGHT_TOLERANCE: f64 = 1e-10;

/// Maximum number of steps out of both features for which the linear programme is solved.
const MAX_FEATURE_STEPS: usize = 40;

/// Maximum absolute value of each lateral part of a normal with `n . d = 1` in the linear programme.
const MAX_LATERAL_PART: f64 = 1e3;

/// Maximum number of corners of a face of which successive corners are chosen around the line.
const MAX_SUCCESSIVE_CORNERS: u32 = 8;

/// Sine of the angle between two edges up to which they count as parallel.
const MIN_SINE: f64 = 1e-8;

/// Three or four corners of a face of the Minkowski difference, in order. A triangle repeats its last corner.
pub(crate) type Corners = [VertexPair; 4];

/// The contact that the touching features prove.
#[derive(Debug, Clone, Copy)]
pub(super) struct SolvedContact {
    /// Contact normal, with `n . d = 1`.
    pub(super) normal: DVec3,
    /// Feature of each body, as two pairs of vertices.
    pub(super) vertices: [[u32; 4]; 2],
    /// Part of the face of the Minkowski difference that contains the line. `None` for features other than two
    /// edges, or a vertex and a face.
    pub(super) corners: Option<Corners>,
}

/// Result of the search for a common normal of the touching features.
#[derive(Debug, Clone, Copy)]
enum CommonNormal {
    /// A normal with `n . d = 1` that supports both bodies.
    Normal(DVec3),
    /// The only possible normal does not support a body. A half-edge of each body. At least one body extends beyond
    /// the plane along this edge.
    Unsupported([u32; 2]),
    /// The features do not decide.
    Undecided,
}

/// Result of the exit test.
#[derive(Debug, Clone, Copy)]
pub(super) enum ExitResult {
    /// The best point solves the problem.
    Solved(SolvedContact),
    /// The best point does not solve the problem: `phi` falls beyond it.
    Falls(Descent),
    /// The features do not decide.
    Missed,
}

/// Place from which `phi` falls. At these levels, up to rounding, the contact lies in one face of each body or on the
/// boundary of this face. Beyond them it continues in these faces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Descent {
    /// Edge of each body, whose faces may contain the contact.
    pub(super) edges: [u32; 2],
    /// Level of each body.
    pub(super) levels: [f64; 2],
}

/// Touching feature of a body. Edges and faces are given by a half-edge.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Feature {
    Vertex(u32),
    Edge(u32),
    Face(u32),
}

/// The exit test for the bodies of a query, in the setting frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct ExitTest<'q, 'a> {
    pub(super) sides: &'q [SectionedBody<'a>; 2],
    pub(super) setting: &'q Setting<'a>,
    /// Extent of both bodies together along the direction.
    pub(super) extent: f64,
}

impl ExitTest<'_, '_> {
    /// Tests whether the best point of a cell, at `levels` and on the cell sides with these feature changes,
    /// solves the problem. `upper` is the value of `phi` there, a length.
    pub(super) fn test_best_point(
        &self,
        answer: &PlanarAnswer,
        (levels, changes): ([f64; 2], &SideChanges),
        upper: f64,
    ) -> ExitResult {
        let Some(features) = self.touching_features(answer, changes) else {
            return ExitResult::Missed;
        };
        let normal = match self.common_normal(features) {
            CommonNormal::Normal(normal) => normal,
            CommonNormal::Unsupported(edges) => {
                return ExitResult::Falls(self.descent_along(features, edges, levels));
            }
            CommonNormal::Undecided => return ExitResult::Missed,
        };
        let point =
            |body: usize| self.vertex_position(body, self.first_vertex(body, features[body]));
        let height = normal.dot(point(1) + self.setting.offset - point(0));
        if (upper - height).abs() > HEIGHT_TOLERANCE * self.extent {
            return ExitResult::Missed;
        }
        let vertices = |body: usize| self.vertex_pairs(body, features[body]);
        ExitResult::Solved(SolvedContact {
            normal,
            vertices: [vertices(0), vertices(1)],
            corners: self.difference_corners(features),
        })
    }

    /// Returns where the contact continues on the faces of these edges. A section at the level of a vertex lies
    /// just above the vertex. Therefore this level is kept if the half-edge leads upwards, and else replaced by the
    /// next lower number.
    fn descent_along(&self, features: [Feature; 2], edges: [u32; 2], levels: [f64; 2]) -> Descent {
        let level = |body: usize| match features[body] {
            Feature::Vertex(v) => {
                let side = &self.sides[body];
                let level = side.vertex_level(v);
                let is_up = side.vertex_level(side.topology.target(edges[body])) > level;
                if is_up { level } else { level.next_down() }
            }
            Feature::Edge(_) | Feature::Face(_) => levels[body],
        };
        Descent { edges, levels: [level(0), level(1)] }
    }

    /// Finds the features that touch in the best point. `None` for separated sections, for an edge whose face is
    /// unknown, and for a vertex contact if none of the `changes` names a face of the other body.
    fn touching_features(
        &self,
        answer: &PlanarAnswer,
        changes: &SideChanges,
    ) -> Option<[Feature; 2]> {
        match answer {
            PlanarAnswer::Edges { edges, .. } => {
                let of = |body: usize| {
                    let (face, _) = face_of_edge(&self.sides[body], &edges[body])?;
                    Some(self.narrow_feature(body, Feature::Face(face), changes.clone()))
                };
                Some([of(0)?, of(1)?])
            }
            PlanarAnswer::Vertex { upper, vertex, .. } => {
                let lower = 1 - upper;
                let own =
                    self.narrow_feature(*upper, Feature::Edge(vertex.half_edge), changes.clone());
                let face = changes.clone().find_map(|change| match change {
                    FeatureChange::Face(_, h) => Some(h),
                    _ => None,
                })?;
                let topology = self.sides[lower].topology;
                let on_face = changes.clone().filter(|change| match change {
                    FeatureChange::Edge(_, h) => edge_bounds_face(topology, *h, face),
                    _ => true,
                });
                let other = self.narrow_feature(lower, Feature::Face(face), on_face);
                Some(if *upper == 0 { [own, other] } else { [other, own] })
            }
            PlanarAnswer::Separated { .. } => None,
        }
    }

    /// Narrows a feature of a body by the feature changes of this body: a face to an edge, an edge to a vertex.
    fn narrow_feature(
        &self,
        body: usize,
        from: Feature,
        changes: impl Iterator<Item = FeatureChange>,
    ) -> Feature {
        let topology = self.sides[body].topology;
        let mut feature = from;
        for change in changes {
            feature = match (change, feature) {
                (FeatureChange::Vertex(b, v), Feature::Edge(e))
                    if b == body && [topology.origin(e), topology.target(e)].contains(&v) =>
                {
                    Feature::Vertex(v)
                }
                (FeatureChange::Edge(b, h), Feature::Face(_)) if b == body => Feature::Edge(h),
                (FeatureChange::Edge(b, h), Feature::Edge(e)) if b == body => {
                    shared_vertex(topology, e, h).map_or(feature, Feature::Vertex)
                }
                _ => feature,
            };
        }
        feature
    }

    /// Finds a normal with `n . d = 1` that supports both bodies where the features touch.
    fn common_normal(&self, features: [Feature; 2]) -> CommonNormal {
        let unit = self.setting.unit;
        let single = match features {
            [Feature::Face(f), _] => Some(self.face_normal(0, f)),
            [_, Feature::Face(f)] => Some(self.face_normal(1, f)),
            [Feature::Edge(e), Feature::Edge(f)] => self.edge_pair_normal(e, f),
            _ => None,
        };
        let Some(single) = single else {
            return self
                .clip_normals(features)
                .map_or(CommonNormal::Undecided, CommonNormal::Normal);
        };
        let along = single.dot(unit);
        // A face has an outward normal. The normal of two edges has either sense.
        let outward = match features {
            [Feature::Face(_), _] => along > 0.0,
            [_, Feature::Face(_)] => along < 0.0,
            _ => along != 0.0,
        };
        let normal = single / along;
        if !(outward && normal.is_finite()) {
            return CommonNormal::Undecided;
        }
        // The sum of the coordinates bounds the length of the normal without a square root (the paper, V-A).
        let noise = self.setting.noise().point_error() * normal.abs().element_sum();
        let own_face = match features {
            [Feature::Face(_), _] => Some(0),
            [_, Feature::Face(_)] => Some(1),
            _ => None,
        };
        let farthest = |body: usize| match features[body] {
            // The normal is that of this face.
            Feature::Face(h) if own_face == Some(body) => (0.0, h),
            feature => {
                let outward = self.in_body_frame(body, if body == 0 { normal } else { -normal });
                self.farthest_step(body, outward, feature)
            }
        };
        let (of_p, of_q) = (farthest(0), farthest(1));
        if of_p.0 <= noise && of_q.0 <= noise {
            return CommonNormal::Normal(normal);
        }
        let edge = |farthest: (f64, u32), feature: Feature| match (farthest, feature) {
            ((distance, _), Feature::Face(h) | Feature::Edge(h)) if distance <= noise => h,
            ((_, h), _) => h,
        };
        CommonNormal::Unsupported([edge(of_p, features[0]), edge(of_q, features[1])])
    }

    /// Returns the cross product of two edges. `None` if they are parallel.
    fn edge_pair_normal(&self, e: u32, f: u32) -> Option<DVec3> {
        let along = |body: usize, h: u32| {
            let topology = self.sides[body].topology;
            let step = self.vertex_difference(body, topology.origin(h), topology.target(h));
            *self.rotation_matrix(body) * step
        };
        let (p, q) = (along(0, e), along(1, f));
        let normal = p.cross(q);
        let sizes = p.length_squared() * q.length_squared();
        (normal.length_squared() > MIN_SINE * MIN_SINE * sizes).then_some(normal)
    }

    /// Returns the outward normal of a face in the setting frame, of any length.
    fn face_normal(&self, body: usize, half_edge: u32) -> DVec3 {
        let topology = self.sides[body].topology;
        let polyhedron = if body == 0 { self.setting.moving } else { self.setting.fixed };
        if let Some(normal) = polyhedron.large_face_normal(topology.half_edge(half_edge).face) {
            return *self.rotation_matrix(body) * normal;
        }
        let third = topology.target(topology.next(half_edge));
        let first = topology.origin(half_edge);
        let along = self.vertex_difference(body, first, topology.target(half_edge));
        *self.rotation_matrix(body) * along.cross(self.vertex_difference(body, first, third))
    }

    /// Finds the step of [`Self::for_each_step`] that leads farthest along `outward`, a normal in the body frame.
    /// Returns its distance, and a half-edge of the face that contains it. At a vertex with many edges, takes the steepest
    /// edge.
    fn farthest_step(&self, body: usize, outward: DVec3, feature: Feature) -> (f64, u32) {
        if let Feature::Vertex(v) = feature
            && self.count_steps(body, feature) > MAX_SCANNED_NEIGHBOURS
        {
            let polyhedron = if body == 0 { self.setting.moving } else { self.setting.fixed };
            let position = polyhedron.steepest_edge_position(v, outward);
            let topology = self.sides[body].topology;
            let step = self.vertex_difference(body, v, topology.neighbours(v)[position]);
            return (outward.dot(step), topology.outgoing_half_edges(v)[position]);
        }
        let mut farthest = (f64::NEG_INFINITY, 0);
        self.for_each_step(body, feature, |step, h| {
            let distance = outward.dot(step);
            farthest = if distance > farthest.0 { (distance, h) } else { farthest };
        });
        farthest
    }

    /// Finds a common normal of features that leave more than one. Clips the plane of normals
    /// `d + s1 e1 + s2 e2` by all steps out of both features, each relaxed by rounding, and takes the centroid.
    /// `None` if nothing remains or if there are more than [`MAX_FEATURE_STEPS`] steps.
    fn clip_normals(&self, features: [Feature; 2]) -> Option<DVec3> {
        let unit = self.setting.unit;
        let e1 = unit.any_orthonormal_vector();
        let e2 = unit.cross(e1);
        let steps = |body: usize| self.count_steps(body, features[body]);
        if steps(0) + steps(1) > MAX_FEATURE_STEPS {
            return None;
        }
        let noise = self.setting.noise().point_error();
        let mut normals = LevelRegion::from_rectangle(
            DVec2::splat(-MAX_LATERAL_PART),
            DVec2::splat(MAX_LATERAL_PART),
        );
        for (body, feature) in features.into_iter().enumerate() {
            let sign = if body == 0 { 1.0 } else { -1.0 };
            let [d, e1, e2] = [unit, e1, e2].map(|v| self.in_body_frame(body, v * sign));
            self.for_each_step(body, feature, |step, _| {
                normals.cut_by(DVec2::new(e1.dot(step), e2.dot(step)), noise - d.dot(step));
            });
        }
        let slope = normals.centroid()?;
        Some(unit + e1 * slope.x + e2 * slope.y)
    }

    /// Returns the number of steps out of a feature.
    fn count_steps(&self, body: usize, feature: Feature) -> usize {
        match feature {
            Feature::Vertex(v) => self.sides[body].topology.neighbours(v).len(),
            Feature::Edge(_) => 4,
            Feature::Face(_) => 3,
        }
    }

    /// Visits the steps out of a feature along the surface, and the steps along the feature in both senses. A
    /// step is a vector in the body frame, with a half-edge of the face that contains it.
    fn for_each_step(&self, body: usize, feature: Feature, mut visit: impl FnMut(DVec3, u32)) {
        let topology = self.sides[body].topology;
        let here = self.first_vertex(body, feature);
        match feature {
            Feature::Vertex(v) => {
                let steps = topology.neighbours(v).iter().zip(topology.outgoing_half_edges(v));
                steps.for_each(|(&to, &h)| visit(self.vertex_difference(body, here, to), h));
            }
            Feature::Edge(h) => {
                let twin = topology.half_edge(h).twin;
                let end = topology.target(h);
                visit(self.vertex_difference(body, here, end), h);
                visit(self.vertex_difference(body, here, topology.target(topology.next(h))), h);
                visit(
                    self.vertex_difference(body, here, topology.target(topology.next(twin))),
                    twin,
                );
                visit(self.vertex_difference(body, end, here), twin);
            }
            Feature::Face(h) => {
                let next = topology.next(h);
                let [back, third] = [topology.target(h), topology.target(next)];
                visit(self.vertex_difference(body, here, back), h);
                visit(self.vertex_difference(body, here, third), h);
                visit(self.vertex_difference(body, back, here), h);
                visit(self.vertex_difference(body, third, here), h);
            }
        }
    }

    /// Returns a vertex of a body in the setting frame, without Q's offset.
    fn vertex_position(&self, body: usize, vertex: u32) -> DVec3 {
        *self.rotation_matrix(body) * self.sides[body].vertices[vertex as usize]
    }

    /// Returns the vector from one vertex to another in the body frame.
    fn vertex_difference(&self, body: usize, from: u32, to: u32) -> DVec3 {
        let vertices = self.sides[body].vertices;
        vertices[to as usize] - vertices[from as usize]
    }

    /// Rotates a covector of the setting frame into the body frame.
    fn in_body_frame(&self, body: usize, covector: DVec3) -> DVec3 {
        self.rotation_matrix(body).transpose() * covector
    }

    /// Returns the rotation of a body.
    fn rotation_matrix(&self, body: usize) -> &DMat3 {
        let TwoBodies { moving_matrix, fixed_matrix, .. } = &self.setting.bodies;
        if body == 0 { moving_matrix } else { fixed_matrix }
    }

    /// Returns a vertex of a feature.
    fn first_vertex(&self, body: usize, feature: Feature) -> u32 {
        match feature {
            Feature::Vertex(v) => v,
            Feature::Edge(h) | Feature::Face(h) => self.sides[body].topology.origin(h),
        }
    }

    /// Returns vertices of a feature as two pairs.
    fn vertex_pairs(&self, body: usize, feature: Feature) -> [u32; 4] {
        let topology = self.sides[body].topology;
        let first = self.first_vertex(body, feature);
        match feature {
            Feature::Vertex(_) => [first; 4],
            Feature::Edge(h) => [first, topology.target(h), first, topology.target(h)],
            Feature::Face(h) => {
                let third = topology.target(topology.next(h));
                [first, topology.target(h), third, first]
            }
        }
    }

    /// Returns corners of the features' Minkowski difference around the line. `None` for features other than
    /// two edges, or a vertex and a face.
    fn difference_corners(&self, features: [Feature; 2]) -> Option<Corners> {
        match features {
            [Feature::Edge(e), Feature::Edge(f)] => {
                let ends = |body: usize, h: u32| {
                    let topology = self.sides[body].topology;
                    [topology.origin(h), topology.target(h)]
                };
                let (p, q) = (ends(0, e), ends(1, f));
                let pair = |i: usize, j: usize| VertexPair::from_indices(p[i], q[j]);
                Some([pair(0, 0), pair(1, 0), pair(1, 1), pair(0, 1)])
            }
            [Feature::Vertex(moving), Feature::Face(h)] => {
                let at = self.vertex_position(0, moving) - self.setting.offset;
                Some(
                    self.face_corners_around(1, h, at)
                        .map(|fixed| VertexPair::from_indices(moving, fixed)),
                )
            }
            [Feature::Face(h), Feature::Vertex(fixed)] => {
                let at = self.vertex_position(1, fixed) + self.setting.offset;
                Some(
                    self.face_corners_around(0, h, at)
                        .map(|moving| VertexPair::from_indices(moving, fixed)),
                )
            }
            _ => None,
        }
    }

    /// Finds three or four corners of a face, in order, around the intersection with the line through `point`.
    /// Bisection finds two consecutive corners that enclose the line with another one, the *apex*. For a face with many
    /// corners, a fourth one is far from these three, because the plane of a narrow triangle is inaccurate. Otherwise
    /// the next corner follows. Rounding may make them miss the line.
    fn face_corners_around(&self, body: usize, half_edge: u32, point: DVec3) -> [u32; 4] {
        let topology = self.sides[body].topology;
        let boundary = topology.face_half_edges(topology.half_edge(half_edge).face);
        let corner = |i: u32| topology.origin(boundary.start + i);
        let count = boundary.len() as u32;
        if count == 3 {
            return [corner(0), corner(1), corner(2), corner(2)];
        }
        // The outward normal of a touching face has a positive component along the direction on P, a negative
        // one on Q.
        let outward = if body == 0 { self.setting.unit } else { -self.setting.unit };
        // Corners are counted from the apex.
        let enclosing = |apex: u32| {
            let first = self.vertex_position(body, corner(apex));
            let is_left = |i: u32| {
                let along = self.vertex_position(body, corner((apex + i) % count)) - first;
                along.cross(point - first).dot(outward) > 0.0
            };
            // Invariant: the point is to the left of the diagonal to `low`, and not to the left of the diagonal
            // to `high`.
            let (mut low, mut high) = (1, count - 1);
            while high - low > 1 {
                let middle = low.midpoint(high);
                (low, high) = if is_left(middle) { (middle, high) } else { (low, middle) };
            }
            low
        };
        if count <= MAX_SUCCESSIVE_CORNERS {
            let low = enclosing(0).min(count - 3);
            return [corner(0), corner(low), corner(low + 1), corner(low + 2)];
        }
        let is_far = |low: u32| (count / 4..3 * count / 4).contains(&low);
        let (mut apex, mut low) = (0, enclosing(0));
        if !is_far(low) {
            // Seen from the corner opposite the line, the line is far.
            apex = (low + count / 2) % count;
            low = enclosing(apex);
        }
        let between = (low + 1).midpoint(count);
        [low, low + 1, between, 0].map(|i| corner((apex + i) % count))
    }
}

/// Checks whether an edge bounds the face of another half-edge.
fn edge_bounds_face(topology: &Topology, edge: u32, of_face: u32) -> bool {
    let face = |h: u32| topology.half_edge(h).face;
    let twin = topology.half_edge(edge).twin;
    face(edge) == face(of_face) || face(twin) == face(of_face)
}

/// Finds the vertex that two different edges share. `None` if they are the same edge or share no vertex.
fn shared_vertex(topology: &Topology, e: u32, f: u32) -> Option<u32> {
    let ends = |h: u32| [topology.origin(h), topology.target(h)];
    let (of_e, of_f) = (ends(e), ends(f));
    if f == e || f == topology.half_edge(e).twin {
        return None;
    }
    of_e.into_iter().find(|v| of_f.contains(v))
}
