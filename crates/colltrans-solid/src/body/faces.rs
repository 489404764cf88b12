//! Polygonal faces made of triangles, and the feature of a face, edge or corner at a point.
//!
//! - A face grows from its largest triangle across edges. It takes neighbours of the same input facet, and neighbours
//!   with the same orientation whose corners lie in the current plane of the face, within the precision.
//! - The normal of this plane is the sum of the area vectors of the face, and the plane contains their weighted
//!   centroid. Both become more accurate as the face grows, so small triangles with rounded corners do not tilt the
//!   plane. Neighbours are compared with this plane and not with the plane of one triangle. Therefore the small angles
//!   between the facets of a cylinder do not accumulate.
//! - The precision is the reach of the body times [`SINGLE_PRECISION`] if all coordinates are single-precision numbers,
//!   and times [`DOUBLE_PRECISION`] otherwise.
//! - Faces give the features of contacts and distances. They also determine whether a contact lies inside a face, which
//!   selects its normal and thus affects its nominal translation. Certificates do not depend on faces.
//! - An edge of the mesh is *sharp* if it has no neighbour or one of another face. A vertex at which exactly two sharp
//!   edges end, in one straight line, lies within an edge of the solid. Every other end of a sharp edge is a corner.

use glam::DVec3;

use super::Solid;
use super::edges::NO_NEIGHBOUR;
use super::tree;
use colltrans_convex::body::{FaceId, Feature};

/// Precision of single-precision coordinates, in multiples of the largest distance from the origin.
const SINGLE_PRECISION: f64 = 1.0 / (1_u64 << 22) as f64;
/// Precision of double-precision coordinates, in multiples of the largest distance from the origin.
const DOUBLE_PRECISION: f64 = 1.0 / (1_u64 << 48) as f64;

/// The face of each triangle.
#[derive(Debug, Clone)]
pub(crate) struct Faces {
    /// Number of the face of each triangle: the smallest input facet of the face.
    face_of: Vec<u32>,
    /// Whether more than two sharp edges end at each vertex.
    corners: Vec<bool>,
    /// Maximum difference of coordinates that were meant to be equal, a length.
    precision: f64,
}

impl Faces {
    fn new(solid: &Solid) -> Self {
        let single = |v: &DVec3| v.as_vec3().as_dvec3() == *v;
        let share =
            if solid.vertices.iter().all(single) { SINGLE_PRECISION } else { DOUBLE_PRECISION };
        let precision = share * solid.reach;
        let areas: Vec<DVec3> = (0..solid.triangles.len() as u32)
            .map(|t| tree::area_vector(solid.triangle_corners(t)).0)
            .collect();
        let mut order: Vec<u32> = (0..areas.len() as u32).collect();
        let size = |t: &u32| areas[*t as usize].length_squared();
        order.sort_by(|a, b| size(b).total_cmp(&size(a)));
        let mut face_of = vec![NO_NEIGHBOUR; areas.len()];
        let mut members: Vec<u32> = Vec::new();
        for seed in order {
            if face_of[seed as usize] != NO_NEIGHBOUR {
                continue;
            }
            let mut plane = FacePlane::default();
            let mut take = |t: u32, members: &mut Vec<u32>, face_of: &mut Vec<u32>| {
                plane.add(solid.triangle_corners(t), areas[t as usize]);
                face_of[t as usize] = solid.facet_index[t as usize].0;
                members.push(t);
                plane
            };
            let mut plane = take(seed, &mut members, &mut face_of);
            let mut next = 0;
            while let Some(&t) = members.get(next) {
                next += 1;
                for n in solid.neighbours[t as usize] {
                    if n == NO_NEIGHBOUR || face_of[n as usize] != NO_NEIGHBOUR {
                        continue;
                    }
                    let same = solid.facet_index[n as usize] == solid.facet_index[t as usize];
                    if same
                        || plane.contains_triangle(
                            solid.triangle_corners(n),
                            areas[n as usize],
                            precision,
                        )
                    {
                        plane = take(n, &mut members, &mut face_of);
                    }
                }
            }
            let number = members.iter().map(|&t| face_of[t as usize]).min().unwrap_or(NO_NEIGHBOUR);
            members.drain(..).for_each(|t| face_of[t as usize] = number);
        }
        let corners = corner_vertices(solid, &face_of);
        Self { face_of, corners, precision }
    }

    /// Returns the faces for the same triangles in another order.
    pub(super) fn reordered(&self, order: &[u32]) -> Self {
        let face_of = order.iter().map(|&t| self.face_of[t as usize]).collect();
        Self { face_of, corners: self.corners.clone(), ..*self }
    }

    pub(crate) fn heap_bytes(&self) -> usize {
        self.face_of.capacity() * size_of::<u32>() + self.corners.capacity()
    }
}

/// Returns for each vertex whether more than two sharp edges end there.
fn corner_vertices(solid: &Solid, face_of: &[u32]) -> Vec<bool> {
    let mut ends = vec![0_u8; solid.vertices.len()];
    let mut count = |v: u32| ends[v as usize] = ends[v as usize].saturating_add(1);
    for (t, neighbours) in solid.neighbours.iter().enumerate() {
        for (k, &n) in neighbours.iter().enumerate() {
            let on_boundary = n == NO_NEIGHBOUR;
            if on_boundary || face_of[n as usize] != face_of[t] {
                // The neighbour counts the other end.
                count(solid.triangles[t][k]);
            }
            if on_boundary {
                count(solid.triangles[t][(k + 1) % 3]);
            }
        }
    }
    ends.into_iter().map(|count| count > 2).collect()
}

/// The plane of a face: the sum of the area vectors, and the weighted centroid of the triangles.
#[derive(Debug, Clone, Copy, Default)]
struct FacePlane {
    area: DVec3,
    weighted: DVec3,
    weight: f64,
}

impl FacePlane {
    fn add(&mut self, [a, b, c]: [DVec3; 3], area: DVec3) {
        let weight = area.length();
        self.area += area;
        self.weighted += (a + b + c) / 3.0 * weight;
        self.weight += weight;
    }

    /// Checks whether a triangle lies in the plane within a length, and has the same orientation. The orientation of
    /// a triangle whose height is at most this length is not checked.
    fn contains_triangle(&self, corners: [DVec3; 3], area: DVec3, precision: f64) -> bool {
        let (normal, center) = (self.area.normalize_or_zero(), self.weighted / self.weight);
        let [a, b, c] = corners;
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let looks = area.dot(normal) > 0.0 || area.length() <= precision * longest;
        looks && corners.iter().all(|p| normal.dot(*p - center).abs() <= precision)
    }
}

/// The sharp edges at a vertex: for each one its other end and a triangle of which it is a side.
#[derive(Default)]
struct SharpEdges {
    ends: [[u32; 2]; 2],
    /// Number of sharp edges; counting stops at 3.
    count: usize,
}

impl SharpEdges {
    fn add(&mut self, edge: [u32; 2]) {
        if let Some(free) = self.ends.get_mut(self.count) {
            *free = edge;
        }
        self.count += 1;
    }
}

impl Solid {
    /// Returns the number of the face of each of [`Self::triangles`], as in [`Feature::Face`]. It is the smallest
    /// input facet of the face.
    pub fn face_numbers(&self) -> &[u32] {
        &self.faces().face_of
    }

    pub(super) fn faces(&self) -> &Faces {
        self.faces.get_or_init(|| Box::new(Faces::new(self)))
    }

    /// Returns the corners of a triangle.
    pub(super) fn triangle_corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.vertices[v as usize])
    }

    /// Returns the maximum difference of coordinates that were meant to be equal, a length.
    pub(crate) fn coordinate_precision(&self) -> f64 {
        self.faces().precision
    }

    /// Returns the feature of the body that touches at a point of a triangle, for a contact normal (body frame).
    ///
    /// Among the features that contain the point within `slack`, a face in the contact plane has precedence, then an
    /// edge in this plane, then the smallest feature.
    pub(crate) fn feature_at(
        &self,
        triangle: u32,
        point: DVec3,
        normal: DVec3,
        slack: f64,
    ) -> Feature {
        let place = |v: u32| self.vertices[v as usize];
        let touches = |v: u32| (place(v) - point).dot(normal).abs() <= slack;
        let lies = |t: u32| self.triangles[t as usize].into_iter().all(touches);
        let own = self.triangles[triangle as usize];
        if self.is_without_area(triangle as usize) {
            let [a, b, _] = own;
            let end = [a, b].into_iter().find(|&v| place(v).distance(point) <= slack);
            let vertex = |v: u32| self.vertex_index[v as usize];
            return match end {
                Some(v) => Feature::Vertex(vertex(v)),
                None => Feature::Edge([vertex(a), vertex(b)]),
            };
        }
        if lies(triangle) {
            return self.face_feature(triangle);
        }
        if let Some(k) = (0..3).find(|&k| place(own[k]).distance(point) <= slack) {
            let (mut face, mut edge) = (None, None);
            self.visit_around(own[k], triangle, |t, _| {
                face = face.or(lies(t).then_some(t));
                face.is_some()
            });
            if let Some(t) = face {
                return self.face_feature(t);
            }
            self.visit_sharp_edges(own[k], triangle, |[end, t]| {
                edge = edge.or(touches(end).then_some([end, t]));
                edge.is_some()
            });
            return match edge {
                Some([end, t]) => self.edge_along_side([own[k], end], t),
                None => self.corner_feature(triangle, k),
            };
        }
        let is_on = |k: &usize| {
            let [a, b] = [own[*k], own[(k + 1) % 3]].map(place);
            (point - a).cross(b - a).length() <= slack * (b - a).length()
        };
        match (0..3).find(is_on) {
            None => self.face_feature(triangle),
            Some(k) => match self.neighbours[triangle as usize][k] {
                n if n != NO_NEIGHBOUR && lies(n) => self.face_feature(n),
                _ => self.side_feature(triangle, k),
            },
        }
    }

    fn face_feature(&self, triangle: u32) -> Feature {
        Feature::Face(FaceId(self.faces().face_of[triangle as usize]))
    }

    /// Returns the feature of side `k` of a triangle, from corner `k` to the next corner: an edge or a face.
    fn side_feature(&self, triangle: u32, k: usize) -> Feature {
        if !self.is_sharp(triangle, k) {
            return self.face_feature(triangle);
        }
        let own = self.triangles[triangle as usize];
        self.edge_along_side([own[k], own[(k + 1) % 3]], triangle)
    }

    /// Returns the feature of corner `k` of a triangle: a corner, an edge or a face of the solid.
    fn corner_feature(&self, triangle: u32, k: usize) -> Feature {
        let vertex = self.triangles[triangle as usize][k];
        let corner = Feature::Vertex(self.vertex_index[vertex as usize]);
        if self.is_corner(vertex) {
            return corner;
        }
        let sharp = self.sharp_edges_at(vertex, triangle);
        let [[a, s], [b, t]] = sharp.ends;
        match sharp.count {
            0 => self.face_feature(triangle),
            2 if self.is_straight([a, vertex, b]) => self.edge_through([a, vertex, b], [s, t]),
            _ => corner,
        }
    }

    /// Checks whether side `k` of a triangle belongs to an edge of the solid, and not to the interior of a face.
    pub(crate) fn is_sharp(&self, triangle: u32, k: usize) -> bool {
        let n = self.neighbours[triangle as usize][k];
        let face_of = &self.faces().face_of;
        n == NO_NEIGHBOUR || face_of[n as usize] != face_of[triangle as usize]
    }

    /// Checks whether more than two sharp edges end at a vertex.
    fn is_corner(&self, vertex: u32) -> bool {
        self.faces().corners[vertex as usize]
    }

    /// Visits the triangles around a vertex, or from one boundary edge to the other, until `visit` returns true. The
    /// second argument of `visit` is the position of the vertex in the triangle.
    fn visit_around(&self, vertex: u32, triangle: u32, mut visit: impl FnMut(u32, usize) -> bool) {
        let place = |t: u32| self.triangles[t as usize].iter().position(|&v| v == vertex);
        let across = |t: u32, side: usize| self.neighbours[t as usize][side % 3];
        // First across the sides that start at the vertex, then across the sides that end there.
        for side in [0, 2] {
            let first = if side == 0 { Some(triangle) } else { None };
            let mut at = first.or_else(|| Some(across(triangle, place(triangle)? + side)));
            for _ in 0..self.triangles.len() {
                let Some((t, k)) =
                    at.filter(|&t| t != NO_NEIGHBOUR).and_then(|t| Some((t, place(t)?)))
                else {
                    break;
                };
                if visit(t, k) {
                    return;
                }
                at = Some(across(t, k + side));
                if at == Some(triangle) {
                    return;
                }
            }
        }
    }

    /// Checks whether a vertex of a triangle has no sharp edges.
    pub(crate) fn is_within_face(&self, vertex: u32, triangle: u32) -> bool {
        let mut any = false;
        self.visit_sharp_edges(vertex, triangle, |_| {
            any = true;
            any
        });
        !any
    }

    /// Visits the sharp edges at a vertex of a triangle until `visit` returns true. Arguments are the other end and a
    /// triangle.
    fn visit_sharp_edges(
        &self,
        vertex: u32,
        triangle: u32,
        mut visit: impl FnMut([u32; 2]) -> bool,
    ) {
        self.visit_around(vertex, triangle, |t, k| {
            let own = self.triangles[t as usize];
            let arriving = (k + 2) % 3;
            // An edge between two triangles is visited in the triangle in which it starts at the vertex.
            let on_boundary = self.neighbours[t as usize][arriving] == NO_NEIGHBOUR;
            self.is_sharp(t, k) && visit([own[(k + 1) % 3], t])
                || on_boundary && visit([own[arriving], t])
        });
    }

    /// Returns the sharp edges at a vertex of a triangle; only the first two are stored.
    fn sharp_edges_at(&self, vertex: u32, triangle: u32) -> SharpEdges {
        let mut sharp = SharpEdges::default();
        self.visit_sharp_edges(vertex, triangle, |edge| {
            sharp.add(edge);
            sharp.count > 2
        });
        sharp
    }

    /// Checks whether the middle one of three vertices lies on the segment between the others, within the precision.
    fn is_straight(&self, [a, m, b]: [u32; 3]) -> bool {
        let [a, m, b] = [a, m, b].map(|v| self.vertices[v as usize]);
        let (to, whole) = (m - a, b - a);
        let off = to.cross(whole).length_squared();
        let slack = self.faces().precision * whole.length();
        off <= slack * slack && to.dot(whole) > 0.0 && (b - m).dot(whole) > 0.0
    }

    /// Returns the complete straight edge that contains a side of a triangle.
    fn edge_along_side(&self, [a, b]: [u32; 2], triangle: u32) -> Feature {
        let far = self.end_of_edge(a, [a, b], triangle);
        let near = self.end_of_edge(far, [b, a], triangle);
        self.edge_feature([near, far])
    }

    /// Returns the complete straight edge through `a`, `m` and `b`, where `m` lies between the others. `s` and `t`
    /// are triangles at the sides to `a` and `b`.
    fn edge_through(&self, [a, m, b]: [u32; 3], [s, t]: [u32; 2]) -> Feature {
        let far = self.end_of_edge(a, [m, b], t);
        let near = self.end_of_edge(far, [m, a], s);
        self.edge_feature([near, far])
    }

    fn edge_feature(&self, ends: [u32; 2]) -> Feature {
        let mut ends = ends.map(|v| self.vertex_index[v as usize]);
        ends.sort_unstable();
        Feature::Edge(ends)
    }

    /// Returns the end of a straight edge: walks from vertex `before` through `at`, a corner of the triangle, as long
    /// as the edge is straight from its other end `end`.
    fn end_of_edge(&self, end: u32, [mut before, mut at]: [u32; 2], mut triangle: u32) -> u32 {
        for _ in 0..self.vertices.len() {
            if self.is_corner(at) {
                break;
            }
            let sharp = self.sharp_edges_at(at, triangle);
            let ahead = sharp.ends.into_iter().find(|[next, _]| *next != before);
            let Some([next, t]) = ahead.filter(|_| sharp.count == 2) else { break };
            if !self.is_straight([end, at, next]) {
                break;
            }
            (before, at, triangle) = (at, next, t);
        }
        at
    }

    /// Returns the corners of a face, as positions in [`Self::vertices`]. They are listed loop by loop, each
    /// counter-clockwise around the material. The loop with the largest area is first.
    pub(crate) fn face_corners(&self, face: u32) -> Vec<u32> {
        let face_of = &self.faces().face_of;
        // Sharp sides of the face: start, end and triangle, sorted by start.
        let mut sharp_sides: Vec<[u32; 3]> = Vec::new();
        for t in (0..self.triangles.len() as u32).filter(|t| face_of[*t as usize] == face) {
            let own = self.triangles[t as usize];
            let sharp = (0..3).filter(|&k| self.is_sharp(t, k));
            sharp_sides.extend(sharp.map(|k| [own[k], own[(k + 1) % 3], t]));
        }
        sharp_sides.sort_unstable();
        let mut loops: Vec<(f64, Vec<u32>)> = Vec::new();
        while let Some(mut side) = sharp_sides.pop() {
            let (first, mut around, mut area) = (side[0], Vec::new(), DVec3::ZERO);
            let origin = self.vertices[first as usize];
            loop {
                let [from, to, triangle] = side;
                let own = self.triangles[triangle as usize];
                let k = own.iter().position(|&v| v == from).unwrap_or(0);
                if matches!(self.corner_feature(triangle, k), Feature::Vertex(_)) {
                    around.push(from);
                }
                let [p, q] = [from, to].map(|v| self.vertices[v as usize] - origin);
                area += p.cross(q);
                let next = sharp_sides.partition_point(|r| r[0] < to);
                if to == first || sharp_sides.get(next).is_none_or(|r| r[0] != to) {
                    break;
                }
                side = sharp_sides.remove(next);
            }
            loops.push((area.length_squared(), around));
        }
        loops.sort_by(|a, b| b.0.total_cmp(&a.0));
        loops.into_iter().flat_map(|(_, around)| around).collect()
    }
}
