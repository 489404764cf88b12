//! The polygonal faces that a solid's triangles make up, and what of them a place is part of.
//!
//! A face grows from its largest triangle, over edges, as long as the next triangle looks to the same
//! side and its corners lie in the plane of the face so far, to within the precision of the
//! coordinates; triangles of one input facet always belong together. That plane, through the centre
//! and by the sum of the area vectors, is known the better the larger the face is, as small triangles
//! of rounded corners need; and as it is not the neighbour's, the small angles of a cylinder do not
//! add up. The precision is [`SINGLE`] of the body's reach where all coordinates are numbers of single precision,
//! else [`DOUBLE`] of it. This only names: nothing that is measured depends on it.
//!
//! An edge of the mesh is *sharp* if it has no neighbour, or one of another face. Where exactly two
//! sharp edges meet in a straight line, they are parts of one edge of the solid; where others meet is
//! a corner; all other vertices of the mesh lie within a face.

use glam::DVec3;

use super::Solid;
use super::edges::NONE;
use super::tree;
use colltrans_convex::body::{FaceId, Feature};

/// Precision of coordinates, in multiples of the largest distance from the origin.
const SINGLE: f64 = 1.0 / (1_u64 << 22) as f64;
const DOUBLE: f64 = 1.0 / (1_u64 << 48) as f64;

/// Of each triangle, its face.
#[derive(Debug, Clone)]
pub(crate) struct Faces {
    /// The least number of the input facets that the face is made of.
    of: Vec<u32>,
    /// Of each vertex, whether more than two sharp edges end there.
    corners: Vec<bool>,
    /// How far apart coordinates may be that were meant to be one, a length.
    precision: f64,
}

impl Faces {
    fn new(solid: &Solid) -> Self {
        let single = |v: &DVec3| v.as_vec3().as_dvec3() == *v;
        let share = if solid.vertices.iter().all(single) { SINGLE } else { DOUBLE };
        let precision = share * solid.reach;
        let areas: Vec<DVec3> = (0..solid.triangles.len() as u32)
            .map(|t| tree::normal(solid.corners_of(t)).0)
            .collect();
        let mut order: Vec<u32> = (0..areas.len() as u32).collect();
        let size = |t: &u32| areas[*t as usize].length_squared();
        order.sort_by(|a, b| size(b).total_cmp(&size(a)));
        let mut of = vec![NONE; areas.len()];
        let mut members: Vec<u32> = Vec::new();
        for seed in order {
            if of[seed as usize] != NONE {
                continue;
            }
            let mut plane = Plane::default();
            let mut take = |t: u32, members: &mut Vec<u32>, of: &mut Vec<u32>| {
                plane.add(solid.corners_of(t), areas[t as usize]);
                of[t as usize] = solid.facet_index[t as usize].0;
                members.push(t);
                plane
            };
            let mut plane = take(seed, &mut members, &mut of);
            let mut next = 0;
            while let Some(&t) = members.get(next) {
                next += 1;
                for n in solid.neighbours[t as usize] {
                    if n == NONE || of[n as usize] != NONE {
                        continue;
                    }
                    let same = solid.facet_index[n as usize] == solid.facet_index[t as usize];
                    if same || plane.holds(solid.corners_of(n), areas[n as usize], precision) {
                        plane = take(n, &mut members, &mut of);
                    }
                }
            }
            let number = members.iter().map(|&t| of[t as usize]).min().unwrap_or(NONE);
            members.drain(..).for_each(|t| of[t as usize] = number);
        }
        let corners = corners(solid, &of);
        Self { of, corners, precision }
    }

    /// Of the same triangles in another order.
    pub(super) fn ordered(&self, order: &[u32]) -> Self {
        let of = order.iter().map(|&t| self.of[t as usize]).collect();
        Self { of, corners: self.corners.clone(), ..*self }
    }

    pub(crate) fn heap_bytes(&self) -> usize {
        self.of.capacity() * size_of::<u32>() + self.corners.capacity()
    }
}

/// Of each vertex, whether more than two sharp edges end there.
fn corners(solid: &Solid, of: &[u32]) -> Vec<bool> {
    let mut ends = vec![0_u8; solid.vertices.len()];
    let mut count = |v: u32| ends[v as usize] = ends[v as usize].saturating_add(1);
    for (t, neighbours) in solid.neighbours.iter().enumerate() {
        for (k, &n) in neighbours.iter().enumerate() {
            let rim = n == NONE;
            if rim || of[n as usize] != of[t] {
                // What is across tells of its other end.
                count(solid.triangles[t][k]);
            }
            if rim {
                count(solid.triangles[t][(k + 1) % 3]);
            }
        }
    }
    ends.into_iter().map(|count| count > 2).collect()
}

/// The plane of the triangles of a face: their area vector, and their centre.
#[derive(Debug, Clone, Copy, Default)]
struct Plane {
    area: DVec3,
    weighted: DVec3,
    weight: f64,
}

impl Plane {
    fn add(&mut self, [a, b, c]: [DVec3; 3], area: DVec3) {
        let weight = area.length();
        self.area += area;
        self.weighted += (a + b + c) / 3.0 * weight;
        self.weight += weight;
    }

    /// Whether a triangle lies in it, to within a length, and looks to the same side; one that is less
    /// high than that length may look anywhere.
    fn holds(&self, corners: [DVec3; 3], area: DVec3, precision: f64) -> bool {
        let (normal, center) = (self.area.normalize_or_zero(), self.weighted / self.weight);
        let [a, b, c] = corners;
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let looks = area.dot(normal) > 0.0 || area.length() <= precision * longest;
        looks && corners.iter().all(|p| normal.dot(*p - center).abs() <= precision)
    }
}

/// The sharp edges at a vertex: the other end of each, and a triangle that it is a side of.
#[derive(Default)]
struct Sharp {
    ends: [[u32; 2]; 2],
    /// Stops at three.
    count: usize,
}

impl Sharp {
    fn add(&mut self, edge: [u32; 2]) {
        if let Some(free) = self.ends.get_mut(self.count) {
            *free = edge;
        }
        self.count += 1;
    }
}

impl Solid {
    /// For each of [`Self::triangles`], the number of the face that it is part of, as in
    /// [`Feature::Face`]: the least number of the input's facets that make up its polygon.
    pub fn face_numbers(&self) -> &[u32] {
        &self.faces().of
    }

    pub(super) fn faces(&self) -> &Faces {
        self.faces.get_or_init(|| Box::new(Faces::new(self)))
    }

    fn corners_of(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.vertices[v as usize])
    }

    /// How far apart coordinates may be that were meant to be one, a length.
    pub(crate) fn precision(&self) -> f64 {
        self.faces().precision
    }

    /// What touches with a normal (of the body frame) at a point of a triangle: of all that holds the
    /// point, to within `slack`, the face that lies in the contact plane, else the edge that does, else
    /// the smallest.
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
            self.around(own[k], triangle, |t, _| {
                face = face.or(lies(t).then_some(t));
                face.is_some()
            });
            if let Some(t) = face {
                return self.face_feature(t);
            }
            self.each_sharp(own[k], triangle, |[end, t]| {
                edge = edge.or(touches(end).then_some([end, t]));
                edge.is_some()
            });
            return match edge {
                Some([end, t]) => self.edge_between([own[k], end], t),
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
                n if n != NONE && lies(n) => self.face_feature(n),
                _ => self.side_feature(triangle, k),
            },
        }
    }

    fn face_feature(&self, triangle: u32) -> Feature {
        Feature::Face(FaceId(self.faces().of[triangle as usize]))
    }

    /// What side `k` of a triangle, from corner `k` to the next one, is part of: an edge or a face.
    fn side_feature(&self, triangle: u32, k: usize) -> Feature {
        if !self.is_sharp(triangle, k) {
            return self.face_feature(triangle);
        }
        let own = self.triangles[triangle as usize];
        self.edge_between([own[k], own[(k + 1) % 3]], triangle)
    }

    /// What corner `k` of a triangle is part of: a corner of the solid, an edge or a face.
    fn corner_feature(&self, triangle: u32, k: usize) -> Feature {
        let vertex = self.triangles[triangle as usize][k];
        let corner = Feature::Vertex(self.vertex_index[vertex as usize]);
        if self.is_corner(vertex) {
            return corner;
        }
        let sharp = self.sharp_at(vertex, triangle);
        let [[a, s], [b, t]] = sharp.ends;
        match sharp.count {
            0 => self.face_feature(triangle),
            2 if self.is_straight([a, vertex, b]) => self.edge_through([a, vertex, b], [s, t]),
            _ => corner,
        }
    }

    /// Whether side `k` of a triangle is an edge, and not within a face.
    pub(crate) fn is_sharp(&self, triangle: u32, k: usize) -> bool {
        let n = self.neighbours[triangle as usize][k];
        let of = &self.faces().of;
        n == NONE || of[n as usize] != of[triangle as usize]
    }

    /// Whether more than two sharp edges end at a vertex.
    fn is_corner(&self, vertex: u32) -> bool {
        self.faces().corners[vertex as usize]
    }

    /// Goes around a vertex of a triangle, or from rim to rim, until `visit` says stop: the triangles,
    /// and which of their corners the vertex is.
    fn around(&self, vertex: u32, triangle: u32, mut visit: impl FnMut(u32, usize) -> bool) {
        let place = |t: u32| self.triangles[t as usize].iter().position(|&v| v == vertex);
        let across = |t: u32, side: usize| self.neighbours[t as usize][side % 3];
        // Over the side that leaves the vertex, then over the one that leads to it.
        for side in [0, 2] {
            let first = if side == 0 { Some(triangle) } else { None };
            let mut at = first.or_else(|| Some(across(triangle, place(triangle)? + side)));
            for _ in 0..self.triangles.len() {
                let Some((t, k)) = at.filter(|&t| t != NONE).and_then(|t| Some((t, place(t)?)))
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

    /// Whether no edge ends at a vertex of a triangle, nor runs through it.
    pub(crate) fn is_within_face(&self, vertex: u32, triangle: u32) -> bool {
        let mut any = false;
        self.each_sharp(vertex, triangle, |_| {
            any = true;
            any
        });
        !any
    }

    /// The sharp edges with a vertex of a triangle, told until `visit` says stop.
    fn each_sharp(&self, vertex: u32, triangle: u32, mut visit: impl FnMut([u32; 2]) -> bool) {
        self.around(vertex, triangle, |t, k| {
            let own = self.triangles[t as usize];
            let arriving = (k + 2) % 3;
            // An edge between two triangles is told by the one that it leaves in.
            let rim = self.neighbours[t as usize][arriving] == NONE;
            self.is_sharp(t, k) && visit([own[(k + 1) % 3], t]) || rim && visit([own[arriving], t])
        });
    }

    fn sharp_at(&self, vertex: u32, triangle: u32) -> Sharp {
        let mut sharp = Sharp::default();
        self.each_sharp(vertex, triangle, |edge| {
            sharp.add(edge);
            sharp.count > 2
        });
        sharp
    }

    /// Whether the middle one of three vertices lies between the others.
    fn is_straight(&self, [a, m, b]: [u32; 3]) -> bool {
        let [a, m, b] = [a, m, b].map(|v| self.vertices[v as usize]);
        let (to, whole) = (m - a, b - a);
        let off = to.cross(whole).length_squared();
        let slack = self.faces().precision * whole.length();
        off <= slack * slack && to.dot(whole) > 0.0 && (b - m).dot(whole) > 0.0
    }

    /// The whole straight edge that a side of a triangle is part of.
    fn edge_between(&self, [a, b]: [u32; 2], triangle: u32) -> Feature {
        let far = self.end_of_edge(a, [a, b], triangle);
        let near = self.end_of_edge(far, [b, a], triangle);
        self.edge_of([near, far])
    }

    /// The whole straight edge that runs through `a`, `m` and `b`, with a triangle at either end and `m`
    /// between them.
    fn edge_through(&self, [a, m, b]: [u32; 3], [s, t]: [u32; 2]) -> Feature {
        let far = self.end_of_edge(a, [m, b], t);
        let near = self.end_of_edge(far, [m, a], s);
        self.edge_of([near, far])
    }

    fn edge_of(&self, ends: [u32; 2]) -> Feature {
        let mut ends = ends.map(|v| self.vertex_index[v as usize]);
        ends.sort_unstable();
        Feature::Edge(ends)
    }

    /// From a vertex `before` to the next one, a corner of the triangle, and on as far as the edge is
    /// straight, as seen from its other `end`.
    fn end_of_edge(&self, end: u32, [mut before, mut at]: [u32; 2], mut triangle: u32) -> u32 {
        for _ in 0..self.vertices.len() {
            if self.is_corner(at) {
                break;
            }
            let sharp = self.sharp_at(at, triangle);
            let ahead = sharp.ends.into_iter().find(|[next, _]| *next != before);
            let Some([next, t]) = ahead.filter(|_| sharp.count == 2) else { break };
            if !self.is_straight([end, at, next]) {
                break;
            }
            (before, at, triangle) = (at, next, t);
        }
        at
    }

    /// The corners of a face, as positions in [`Self::vertices`]: loop by loop, each counter-clockwise
    /// about the material, the one with the largest area first.
    pub(crate) fn face_corners(&self, face: u32) -> Vec<u32> {
        let of = &self.faces().of;
        // Rims by where they start, and a triangle at each.
        let mut rims: Vec<[u32; 3]> = Vec::new();
        for t in (0..self.triangles.len() as u32).filter(|t| of[*t as usize] == face) {
            let own = self.triangles[t as usize];
            let sharp = (0..3).filter(|&k| self.is_sharp(t, k));
            rims.extend(sharp.map(|k| [own[k], own[(k + 1) % 3], t]));
        }
        rims.sort_unstable();
        let mut loops: Vec<(f64, Vec<u32>)> = Vec::new();
        while let Some(mut rim) = rims.pop() {
            let (first, mut around, mut area) = (rim[0], Vec::new(), DVec3::ZERO);
            let origin = self.vertices[first as usize];
            loop {
                let [from, to, triangle] = rim;
                let own = self.triangles[triangle as usize];
                let k = own.iter().position(|&v| v == from).unwrap_or(0);
                if matches!(self.corner_feature(triangle, k), Feature::Vertex(_)) {
                    around.push(from);
                }
                let [p, q] = [from, to].map(|v| self.vertices[v as usize] - origin);
                area += p.cross(q);
                let next = rims.partition_point(|r| r[0] < to);
                if to == first || rims.get(next).is_none_or(|r| r[0] != to) {
                    break;
                }
                rim = rims.remove(next);
            }
            loops.push((area.length_squared(), around));
        }
        loops.sort_by(|a, b| b.0.total_cmp(&a.0));
        loops.into_iter().flat_map(|(_, around)| around).collect()
    }
}
