//! The exit test: whether the best point of a cell solves the problem (line 6 of the paper's
//! algorithm).
//!
//! Notation. The sides of a cell that meet in its best point `q` name the *features* that touch
//! there, of P and of Q: a vertex, an edge or a face. `q` minimises `phi` exactly if these features
//! have a common normal `n`, `n . d > 0`, that supports P outward and Q inward: zero is then in the
//! convex hull of the gradients of all cells at `q`. A face or two crossing edges leave one normal,
//! which is held against the neighbours of the features; anything else is a linear programme in
//! the two lateral parts of `n`. Where that one normal does not support a body, the faces are told on
//! which it leads beyond: `phi` falls where the contact passes on to them.
//!
//! Local support of a convex body is support. So a hit is a proof up to rounding, at the height
//! where the plane meets: if that is not `q`'s, ties have named features that do not touch, and the
//! test misses. A miss costs a step, and the finish proves whatever a hit claims.

use glam::{DMat3, DVec2, DVec3};

use super::cell::{End, Ends, face_of};
use super::planar::Planar;
use super::region::Region;
use super::sectioned_body::Side;
use crate::setting::{Setting, TwoBodies, VertexPair};
use colltrans_kernel::topology::Topology;

/// The height of a supporting plane is that of the best point if they differ by less than this
/// share of the extent along the direction.
///
/// Section coordinates are off by [`noise::SECTION`](colltrans_kernel::noise::SECTION), `1.4e-14` of
/// the extent. The best point is found by crossing two lines, of section edges and then of a cell's
/// sides, of which each divides that error by the sine between them: the share leaves room for
/// sines that multiply to `1.4e-4`. Where they are smaller the test misses, which costs a step. A
/// plane so near that does not touch is no error either: the finish looks for what lies below it.
pub(super) const SAME_HEIGHT: f64 = 1e-10;

/// Ways out of the features that are compared; vertices with more are not decided.
const MOST_WAYS: usize = 40;

/// The greatest lateral part of a normal with `n . d = 1` that the linear programme finds.
const STEEPEST: f64 = 1e3;

/// Two edges with a smaller sine between them count as parallel.
const PARALLEL: f64 = 1e-8;

/// Three or four corners of a face of the difference of the bodies, in order; of three the last twice.
pub(crate) type Corners = [VertexPair; 4];

/// The contact, as the features that touch prove it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solved {
    /// The contact normal, with `n . d = 1`.
    pub(super) normal: DVec3,
    /// The features of each body, as two pairs of vertices.
    pub(super) vertices: [[u32; 4]; 2],
    /// A part of the face of the difference that the line passes.
    pub(super) corners: Option<Corners>,
}

/// What normal the features that touch have in common.
#[derive(Debug, Clone, Copy)]
enum Common {
    Normal(DVec3),
    /// None: the only one that there could be does not support a body, which leads beyond its plane
    /// on the faces of these half-edges, or on one of them.
    Beyond([u32; 2]),
    Undecided,
}

/// What the exit test found.
#[derive(Debug, Clone, Copy)]
pub(super) enum Exit {
    Solved(Solved),
    /// The best point is none of the problem, and `phi` falls beyond it.
    Falls(Beyond),
    /// The features tell nothing.
    Missed,
}

/// Where `phi` falls: at these levels the contact is at the rim of these faces, by half-edges, and
/// goes on there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beyond {
    pub(super) faces: [u32; 2],
    pub(super) levels: [f64; 2],
}

/// What of a body touches; edges and faces by a half-edge.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Feature {
    Vertex(u32),
    Edge(u32),
    Face(u32),
}

/// The bodies of a query, in the setting frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct ExitTest<'q, 'a> {
    pub(super) sides: &'q [Side<'a>; 2],
    pub(super) setting: &'q Setting<'a>,
    /// Of both bodies along the direction.
    pub(super) extent: f64,
}

impl ExitTest<'_, '_> {
    /// Whether the best point of a cell, at these levels and where these sides meet, solves the
    /// problem, at height `upper` along the direction.
    pub(super) fn solves(
        &self,
        answer: &Planar,
        (levels, ends): ([f64; 2], &Ends),
        upper: f64,
    ) -> Exit {
        let Some(features) = self.features(answer, ends) else { return Exit::Missed };
        let normal = match self.common_normal(features) {
            Common::Normal(normal) => normal,
            Common::Beyond(faces) => return Exit::Falls(self.beyond(features, faces, levels)),
            Common::Undecided => return Exit::Missed,
        };
        let [p, q] = [0, 1].map(|body| self.at(body, self.vertex_of(body, features[body])));
        let height = normal.dot(q + self.setting.offset - p);
        if (upper - height).abs() > SAME_HEIGHT * self.extent {
            return Exit::Missed;
        }
        let vertices = [0, 1].map(|body| self.named(body, features[body]));
        Exit::Solved(Solved { normal, vertices, corners: self.corners(features) })
    }

    /// The contact goes on at these half-edges, from features at some levels: where one is a vertex,
    /// just above or below it.
    fn beyond(&self, features: [Feature; 2], faces: [u32; 2], at: [f64; 2]) -> Beyond {
        let level = |body: usize| match features[body] {
            Feature::Vertex(v) => {
                let side = &self.sides[body];
                let level = side.level(v);
                let is_up = side.level(side.topology.target(faces[body])) > level;
                if is_up { level } else { level.next_down() }
            }
            Feature::Edge(_) | Feature::Face(_) => at[body],
        };
        Beyond { faces, levels: [level(0), level(1)] }
    }

    /// The features that touch in the best point.
    fn features(&self, answer: &Planar, ends: &Ends) -> Option<[Feature; 2]> {
        match answer {
            Planar::Edges { edges, .. } => {
                let of = |body: usize| {
                    let (face, _) = face_of(&self.sides[body], &edges[body])?;
                    Some(self.narrowed(body, Feature::Face(face), ends.clone()))
                };
                Some([of(0)?, of(1)?])
            }
            Planar::Vertex { upper, vertex, .. } => {
                let lower = 1 - upper;
                let own = self.narrowed(*upper, Feature::Edge(vertex.up), ends.clone());
                let face = ends.clone().find_map(|end| match end {
                    End::Face(_, h) => Some(h),
                    _ => None,
                })?;
                let topology = self.sides[lower].topology;
                let on_face = ends.clone().filter(|end| match end {
                    End::Edge(_, h) => bounds(topology, *h, face),
                    _ => true,
                });
                let other = self.narrowed(lower, Feature::Face(face), on_face);
                Some(if *upper == 0 { [own, other] } else { [other, own] })
            }
            Planar::Separated { .. } => None,
        }
    }

    /// A feature of a body, narrowed to what ends there.
    fn narrowed(&self, body: usize, from: Feature, ends: impl Iterator<Item = End>) -> Feature {
        let topology = self.sides[body].topology;
        let mut feature = from;
        for end in ends {
            feature = match (end, feature) {
                (End::Vertex(b, v), _) if b == body => Feature::Vertex(v),
                (End::Edge(b, h), Feature::Face(_)) if b == body => Feature::Edge(h),
                (End::Edge(b, h), Feature::Edge(e)) if b == body => {
                    shared(topology, e, h).map_or(feature, Feature::Vertex)
                }
                _ => feature,
            };
        }
        feature
    }

    /// A normal with `n . d = 1` that supports both bodies where the features touch.
    fn common_normal(&self, features: [Feature; 2]) -> Common {
        let unit = self.setting.unit;
        let single = match features {
            [Feature::Face(f), _] => Some(self.face_normal(0, f)),
            [_, Feature::Face(f)] => Some(self.face_normal(1, f)),
            [Feature::Edge(e), Feature::Edge(f)] => self.across(e, f),
            _ => None,
        };
        let Some(single) = single else {
            return self.any_normal(features).map_or(Common::Undecided, Common::Normal);
        };
        let along = single.dot(unit);
        // A face has an outside; two edges do not.
        let outward = match features {
            [Feature::Face(_), _] => along > 0.0,
            [_, Feature::Face(_)] => along < 0.0,
            _ => along != 0.0,
        };
        let normal = single / along;
        if !(outward && normal.is_finite()) {
            return Common::Undecided;
        }
        // Of the normal's length at most its coordinates' sum: no square root (the paper, V-A).
        let noise = self.setting.noise().point() * normal.abs().element_sum();
        let farthest = [0, 1].map(|body| {
            let outward = self.in_body(body, if body == 0 { normal } else { -normal });
            self.farthest(body, outward, features[body])
        });
        if farthest.iter().all(|(distance, _)| *distance <= noise) {
            return Common::Normal(normal);
        }
        Common::Beyond([0, 1].map(|body| match (farthest[body], features[body]) {
            ((distance, _), Feature::Face(h) | Feature::Edge(h)) if distance <= noise => h,
            ((_, h), _) => h,
        }))
    }

    /// The normal of two edges, of either sense; `None` if they are parallel.
    fn across(&self, e: u32, f: u32) -> Option<DVec3> {
        let along = |body: usize, h: u32| {
            let topology = self.sides[body].topology;
            let way = self.way(body, topology.origin(h), topology.target(h));
            *self.matrix(body) * way
        };
        let (p, q) = (along(0, e), along(1, f));
        let normal = p.cross(q);
        let sizes = p.length_squared() * q.length_squared();
        (normal.length_squared() > PARALLEL * PARALLEL * sizes).then_some(normal)
    }

    /// The outward normal of a face, of any length.
    fn face_normal(&self, body: usize, half_edge: u32) -> DVec3 {
        let topology = self.sides[body].topology;
        let third = topology.target(topology.next(half_edge));
        let first = topology.origin(half_edge);
        let along = self.way(body, first, topology.target(half_edge));
        *self.matrix(body) * along.cross(self.way(body, first, third))
    }

    /// How far the ways out of a feature lead along a normal of the body's frame, and the half-edge
    /// at whose face is the one that leads farthest.
    fn farthest(&self, body: usize, outward: DVec3, feature: Feature) -> (f64, u32) {
        let mut farthest = (f64::NEG_INFINITY, 0);
        self.for_ways(body, feature, |way, h| {
            let distance = outward.dot(way);
            farthest = if distance > farthest.0 { (distance, h) } else { farthest };
        });
        farthest
    }

    /// By clipping the plane of normals `d + s1 e1 + s2 e2` with all ways out of both features,
    /// each by as much too little as rounding may hide.
    fn any_normal(&self, features: [Feature; 2]) -> Option<DVec3> {
        let unit = self.setting.unit;
        let e1 = unit.any_orthonormal_vector();
        let e2 = unit.cross(e1);
        let ways = |body: usize| self.count_ways(body, features[body]);
        if ways(0) + ways(1) > MOST_WAYS {
            return None;
        }
        let noise = self.setting.noise().point();
        let mut normals = Region::rectangle(DVec2::splat(-STEEPEST), DVec2::splat(STEEPEST));
        for (body, feature) in features.into_iter().enumerate() {
            let sign = if body == 0 { 1.0 } else { -1.0 };
            let [d, e1, e2] = [unit, e1, e2].map(|v| self.in_body(body, v * sign));
            self.for_ways(body, feature, |way, _| {
                normals.cut(DVec2::new(e1.dot(way), e2.dot(way)), noise - d.dot(way));
            });
        }
        let slope = normals.centroid()?;
        Some(unit + e1 * slope.x + e2 * slope.y)
    }

    fn count_ways(&self, body: usize, feature: Feature) -> usize {
        match feature {
            Feature::Vertex(v) => self.sides[body].topology.neighbours(v).len(),
            Feature::Edge(_) => 4,
            Feature::Face(_) => 3,
        }
    }

    /// The ways out of a feature along the surface, and both ways along it, in the body's frame, each
    /// with a half-edge of the face where it is.
    fn for_ways(&self, body: usize, feature: Feature, mut visit: impl FnMut(DVec3, u32)) {
        let topology = self.sides[body].topology;
        let here = self.vertex_of(body, feature);
        match feature {
            Feature::Vertex(v) => {
                let ways = topology.neighbours(v).iter().zip(topology.outgoing(v));
                ways.for_each(|(&to, &h)| visit(self.way(body, here, to), h));
            }
            Feature::Edge(h) => {
                let twin = topology.half_edge(h).twin;
                let end = topology.target(h);
                visit(self.way(body, here, end), h);
                visit(self.way(body, here, topology.target(topology.next(h))), h);
                visit(self.way(body, here, topology.target(topology.next(twin))), twin);
                visit(self.way(body, end, here), twin);
            }
            Feature::Face(h) => {
                let next = topology.next(h);
                let [back, third] = [topology.target(h), topology.target(next)];
                visit(self.way(body, here, back), h);
                visit(self.way(body, here, third), h);
                visit(self.way(body, back, here), h);
                visit(self.way(body, third, here), h);
            }
        }
    }

    /// A vertex of the body in the setting frame, up to Q's offset.
    fn at(&self, body: usize, vertex: u32) -> DVec3 {
        *self.matrix(body) * self.sides[body].vertices[vertex as usize]
    }

    /// From a vertex to another in the body's frame.
    fn way(&self, body: usize, from: u32, to: u32) -> DVec3 {
        let vertices = self.sides[body].vertices;
        vertices[to as usize] - vertices[from as usize]
    }

    /// A covector of the setting frame in the body's frame.
    fn in_body(&self, body: usize, covector: DVec3) -> DVec3 {
        self.matrix(body).transpose() * covector
    }

    /// The rotation of the body.
    fn matrix(&self, body: usize) -> &DMat3 {
        let TwoBodies { moving_matrix, fixed_matrix, .. } = &self.setting.bodies;
        if body == 0 { moving_matrix } else { fixed_matrix }
    }

    /// A vertex of a feature.
    fn vertex_of(&self, body: usize, feature: Feature) -> u32 {
        match feature {
            Feature::Vertex(v) => v,
            Feature::Edge(h) | Feature::Face(h) => self.sides[body].topology.origin(h),
        }
    }

    /// A feature as two pairs of its vertices.
    fn named(&self, body: usize, feature: Feature) -> [u32; 4] {
        let topology = self.sides[body].topology;
        let first = self.vertex_of(body, feature);
        match feature {
            Feature::Vertex(_) => [first; 4],
            Feature::Edge(h) => [first, topology.target(h), first, topology.target(h)],
            Feature::Face(h) => {
                let third = topology.target(topology.next(h));
                [first, topology.target(h), third, first]
            }
        }
    }

    /// Corners of the features' difference around the line: all of them if they are at most four.
    fn corners(&self, features: [Feature; 2]) -> Option<Corners> {
        match features {
            [Feature::Edge(e), Feature::Edge(f)] => {
                let ends = |body: usize, h: u32| {
                    let topology = self.sides[body].topology;
                    [topology.origin(h), topology.target(h)]
                };
                let (p, q) = (ends(0, e), ends(1, f));
                let pair = |i: usize, j: usize| VertexPair::of(p[i], q[j]);
                Some([pair(0, 0), pair(1, 0), pair(1, 1), pair(0, 1)])
            }
            [Feature::Vertex(moving), Feature::Face(h)] => {
                let at = self.at(0, moving) - self.setting.offset;
                Some(self.around(1, h, at).map(|fixed| VertexPair::of(moving, fixed)))
            }
            [Feature::Face(h), Feature::Vertex(fixed)] => {
                let at = self.at(1, fixed) + self.setting.offset;
                Some(self.around(0, h, at).map(|moving| VertexPair::of(moving, fixed)))
            }
            _ => None,
        }
    }

    /// Three or four corners of a face, in order, around where the line through a point passes it:
    /// the first and two or three in succession, found by halving. Only up to rounding.
    fn around(&self, body: usize, half_edge: u32, point: DVec3) -> [u32; 4] {
        let topology = self.sides[body].topology;
        let boundary = topology.face(topology.half_edge(half_edge).face);
        let corner = |i: u32| topology.origin(boundary.start + i);
        let count = boundary.len() as u32;
        if count == 3 {
            return [corner(0), corner(1), corner(2), corner(2)];
        }
        // The faces that touch look along the direction on P and against it on Q.
        let outward = if body == 0 { self.setting.unit } else { -self.setting.unit };
        let first = self.at(body, corner(0));
        let is_left = |i: u32| {
            let along = self.at(body, corner(i)) - first;
            along.cross(point - first).dot(outward) > 0.0
        };
        // The point is to the left of the diagonal to `low` and not of that to `high`.
        let (mut low, mut high) = (1, count - 1);
        while high - low > 1 {
            let middle = low.midpoint(high);
            (low, high) = if is_left(middle) { (middle, high) } else { (low, middle) };
        }
        let low = low.min(count - 3);
        [corner(0), corner(low), corner(low + 1), corner(low + 2)]
    }
}

/// Whether an edge bounds the face of another half-edge.
fn bounds(topology: &Topology, edge: u32, of_face: u32) -> bool {
    let face = |h: u32| topology.half_edge(h).face;
    let twin = topology.half_edge(edge).twin;
    face(edge) == face(of_face) || face(twin) == face(of_face)
}

/// The vertex that two different edges share.
fn shared(topology: &Topology, e: u32, f: u32) -> Option<u32> {
    let ends = |h: u32| [topology.origin(h), topology.target(h)];
    let (of_e, of_f) = (ends(e), ends(f));
    if f == e || f == topology.half_edge(e).twin {
        return None;
    }
    of_e.into_iter().find(|v| of_f.contains(v))
}
