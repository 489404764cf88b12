//! Bounds on how far a body reaches beyond a support point that a climb has found.
//!
//! - *reach*: the largest distance of a vertex from the origin of the body frame.
//! - *flatness* `f`: a bound of the distance of a corner from its polygon's plane.
//! - *plateau* of a vertex `v`: the vertices connected with `v` by edges that are at most `h = 2 GAIN reach + 4 f`
//!   below `v` along the normal. It contains the support point. Mostly it is `v` alone, or the corners of an edge
//!   or a face.
//! - *excess* of `v`: an upper bound of the height above `v` that the body reaches along the normal.
//!
//! Faces with many corners are measured at three corners, with a bound for the others. The plateau can be visited
//! from any vertex, so the bounds also verify vertices that no climb has found. Derivations: `docs/theory/supports.md`.

use glam::DVec3;

use super::ConvexPolyhedron;
use super::fan::{AboveQuery, MAX_SCANNED_NEIGHBOURS, MAX_UNMEASURED_CORNERS};
use colltrans_kernel::noise;
use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::visit_counter;

/// Maximum number of vertices of a plateau that are visited one by one. A larger plateau is bounded by a large face
/// or by a scan of the whole body.
const MAX_VISITED: usize = 16;

/// Maximum number of vertices of a body that is scanned if the plateau is too large to visit.
const MAX_SCANNED_VERTICES: usize = 48;

/// Maximum excess of a face measured at three corners that is accepted without a scan of its corners, in multiples
/// of `GAIN reach`. An exactly flat face has half of this.
const MAX_HIDDEN_GAINS: f64 = 32.0;

/// Maximum number of corners of a face that are scanned if three corners give too large an excess.
const MAX_SCANNED_CORNERS: usize = 64;

/// Maximum number of large faces of a body that queries treat one by one.
const MAX_LARGE_FACES: usize = 8;

/// Minimum cosine of the angle between a normal and the normal of a large face that is considered for it.
const MIN_NORMAL_COSINE: f64 = 0.9;

/// Sum of the maximum magnitudes of the weights over three corners.
const WEIGHT_SUM: f64 = 7.0;

/// The highest vertex that was visited, and a bound on how far the body reaches beyond the vertex where the visits
/// began.
struct MaxExcess {
    vertex: u32,
    excess: f64,
}

/// A face with many corners, or a face with more than three corners of a body that has few vertices and few such
/// faces.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LargeFace {
    pub(crate) face: u32,
    corner_count: u32,
    /// Three corners that span the face.
    pub(crate) corners: [u32; 3],
    /// The half-edges of the face that leave these corners.
    pub(crate) half_edges: [u32; 3],
    /// Unit normal, outwards.
    pub(crate) normal: DVec3,
    /// Height of the triangle of the three corners, over the side between the first two.
    height: f64,
    /// The smallest downward slope of an edge that leaves the face, as a sine.
    descent: f64,
}

impl LargeFace {
    /// Checks whether the face counts as large only because the body has few polygons.
    #[inline]
    pub(crate) fn has_few_corners(&self) -> bool {
        self.corner_count <= MAX_UNMEASURED_CORNERS as u32
    }
}

/// The vertices of a plateau that have been found.
struct Plateau {
    /// Unused positions hold the first vertex.
    vertices: [u32; MAX_VISITED],
    count: usize,
}

impl Plateau {
    /// Inserts a vertex unless it is present. Returns `false` if there is no space for it.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a plateau in memory stalls its reader")]
    #[expect(clippy::needless_bitwise_bool, reason = "comparing all at once is faster than a loop")]
    fn insert_vertex(&mut self, vertex: u32) -> bool {
        if self.vertices.iter().fold(false, |found, &v| found | (v == vertex)) {
            return true;
        }
        let has_room = self.count < MAX_VISITED;
        if has_room {
            self.vertices[self.count] = vertex;
            self.count += 1;
        }
        has_room
    }
}

impl ConvexPolyhedron {
    /// Returns a support point along the unit vector `normal` (body frame), and a bound on how far the body reaches
    /// beyond it.
    ///
    /// `vertex` is the vertex that a search along `normal` has found. On a body that is small enough to scan, it is not
    /// verified: it must be the result of a scan.
    #[doc(hidden)]
    #[inline]
    pub fn support_with_excess(&self, normal: DVec3, vertex: u32) -> (u32, f64) {
        if self.support.is_scanned() {
            return (vertex, self.scan_excess());
        }
        // The loop ends because each vertex is higher than the last one by more than rounding error.
        let mut at = vertex;
        loop {
            let found = self.max_excess(normal, 1.0, at, f64::INFINITY);
            let highest = found.unwrap_or_else(|| self.max_excess_of_all(normal, 1.0, at));
            if highest.excess <= 3.0 * noise::GAIN * self.inertia.reach || highest.vertex == at {
                return (at, highest.excess);
            }
            at = highest.vertex;
        }
    }

    /// Returns a support point along `normal`, and a bound on how far the body reaches beyond it. Returns `None` if
    /// a vertex is found that gains more than `most` over `near`, or if no bound up to `most` is found. The returned
    /// bound may exceed `most` by the rounding error and the flatness.
    ///
    /// `length` is the length of `normal`. Comparisons are scaled by it, so that they need not wait for a division.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction in memory stalls the scan")]
    pub(crate) fn support_within(
        &self,
        normal: DVec3,
        length: f64,
        near: u32,
        most: f64,
    ) -> Option<(u32, f64)> {
        if self.support.is_scanned() {
            let found = self.support_point_from(normal, near);
            let gain = normal.dot(self.vertices[found as usize] - self.vertices[near as usize]);
            return (gain <= most * length).then(|| (found, self.scan_excess()));
        }
        self.excess_up_to(normal, length, near, most).map(|excess| (near, excess))
    }

    /// Returns the excess beyond a support point that a scan has found. The scan selects the largest rounded
    /// product, and the compared products may both be off.
    #[inline]
    fn scan_excess(&self) -> f64 {
        2.0 * noise::GAIN * self.inertia.reach
    }

    /// Returns the excess of a point, of a segment beyond the end at which a rounded product is largest, or of an upright
    /// box beyond the corner that the signs of a rounded normal select.
    #[inline]
    pub(crate) fn corner_excess(&self) -> f64 {
        if self.dimension == 0 { 0.0 } else { self.scan_excess() }
    }

    /// Computes the excess beyond a vertex. Returns `None` if a vertex gains more than `most`, or if the plateau is
    /// too large to visit and no bound up to `most` is found.
    fn excess_up_to(&self, normal: DVec3, length: f64, vertex: u32, most: f64) -> Option<f64> {
        self.max_excess(normal, length, vertex, most).map(|found| found.excess)
    }

    /// Computes the highest vertex of the plateau of `vertex`, and the excess. Returns `None` as
    /// [`Self::excess_up_to`] does.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "callers skip an unused highest vertex")]
    fn max_excess(&self, normal: DVec3, length: f64, vertex: u32, most: f64) -> Option<MaxExcess> {
        let here = self.vertices[vertex as usize];
        let [least, limit] = [-self.plateau_depth(), most].map(|limit| limit * length);
        let mut plateau = Plateau { vertices: [vertex; MAX_VISITED], count: 1 };
        let (mut next, mut highest, mut highest_vertex) = (0, 0.0, vertex);
        while next < plateau.count {
            let from = plateau.vertices[next];
            let neighbours = self.neighbours(from);
            if neighbours.len() > MAX_SCANNED_NEIGHBOURS {
                let reach = self.inertia.reach;
                let above = AboveQuery { normal, length, here, least, reach };
                match self.visit_fan(from, &above, &mut plateau, (highest_vertex, highest)) {
                    Some(found) => (highest_vertex, highest) = found,
                    None => return self.max_excess_of_large_plateau(normal, length, vertex, most),
                }
            } else {
                visit_counter::count_visits(neighbours.len());
                for &w in neighbours {
                    let gained = normal.dot(self.vertices[w as usize] - here);
                    highest_vertex = if gained > highest { w } else { highest_vertex };
                    highest = if gained > highest { gained } else { highest };
                    if gained > least && !plateau.insert_vertex(w) {
                        return self.max_excess_of_large_plateau(normal, length, vertex, most);
                    }
                }
            }
            if highest > limit {
                return None;
            }
            next += 1;
            if next == 1
                && plateau.count > 1
                && !self.large_faces.is_empty()
                && let Some(found) = self.max_excess_of_large_plateau(normal, length, vertex, most)
            {
                return Some(found);
            }
        }
        if plateau.count == 1 {
            return Some(MaxExcess { vertex, excess: 0.0 });
        }
        let excess = highest / length + noise::GAIN * self.inertia.reach;
        Some(MaxExcess { vertex: highest_vertex, excess })
    }

    /// Visits the neighbours of a fan that may belong to the plateau. Returns the highest vertex and its gain, or
    /// `None` if the plateau has no space for them.
    #[cold]
    #[inline(never)]
    fn visit_fan(
        &self,
        from: u32,
        above: &AboveQuery,
        plateau: &mut Plateau,
        (mut highest_vertex, mut highest): (u32, f64),
    ) -> Option<(u32, f64)> {
        let mut visit = |w: u32| {
            let gained = above.normal.dot(self.vertices[w as usize] - above.here);
            if gained > highest {
                (highest_vertex, highest) = (w, gained);
            }
            gained <= above.least || plateau.insert_vertex(w)
        };
        let fan = self.support.fan_of_vertex(from);
        let fits = fan.visit_above(&self.vertices, &self.topology, above, &mut visit);
        fits.then_some((highest_vertex, highest))
    }

    /// Computes the excess of a plateau that is too large to visit vertex by vertex. Small bodies are scanned; for
    /// others the plateau must be within a large face. Returns `None` if no bound up to `most` is found.
    #[inline(never)]
    fn max_excess_of_large_plateau(
        &self,
        normal: DVec3,
        length: f64,
        vertex: u32,
        most: f64,
    ) -> Option<MaxExcess> {
        if self.vertices.len() > MAX_SCANNED_VERTICES {
            return self.max_excess_on_large_face(normal, length, vertex, most);
        }
        let found = self.max_excess_of_all(normal, length, vertex);
        (found.excess <= most).then_some(found)
    }

    /// Returns the depth below a vertex down to which its plateau is visited.
    #[inline]
    pub fn plateau_depth(&self) -> f64 {
        2.0 * noise::GAIN * self.inertia.reach + 4.0 * self.flatness
    }

    /// Computes the excess beyond a vertex by a scan of all vertices.
    fn max_excess_of_all(&self, normal: DVec3, length: f64, vertex: u32) -> MaxExcess {
        self.max_excess_among(0..self.vertices.len() as u32, normal, length, vertex)
    }

    /// Computes the excess beyond a vertex from a set of vertices that contains its plateau.
    fn max_excess_among(
        &self,
        vertices: impl Iterator<Item = u32>,
        normal: DVec3,
        length: f64,
        vertex: u32,
    ) -> MaxExcess {
        let here = self.vertices[vertex as usize];
        let (mut highest, mut highest_vertex) = (0.0, vertex);
        for w in vertices {
            let gain = normal.dot(self.vertices[w as usize] - here);
            highest_vertex = if gain > highest { w } else { highest_vertex };
            highest = if gain > highest { gain } else { highest };
        }
        MaxExcess {
            vertex: highest_vertex,
            excess: highest / length + noise::GAIN * self.inertia.reach,
        }
    }

    /// Computes the excess beyond a vertex whose plateau is within a large face. The corners are scanned if three of
    /// them give too large a bound. Returns `None` if no large face contains the plateau, or the excess exceeds
    /// `most`.
    fn max_excess_on_large_face(
        &self,
        normal: DVec3,
        length: f64,
        vertex: u32,
        most: f64,
    ) -> Option<MaxExcess> {
        let outgoing = self.topology.outgoing_half_edges(vertex);
        let excess_of = |face: u32| {
            let found = self.large_faces.binary_search_by_key(&face, |large| large.face).ok()?;
            let large = &self.large_faces[found];
            let excess = || self.large_face_excess(large, normal, length, vertex, most);
            let is_across = normal.dot(large.normal) > MIN_NORMAL_COSINE * length;
            is_across.then(excess).flatten().map(|excess| (face, excess))
        };
        let (face, excess) = if outgoing.len() > MAX_SCANNED_NEIGHBOURS {
            self.support
                .fan_of_vertex(vertex)
                .wide_faces()
                .iter()
                .find_map(|&face| excess_of(face))?
        } else {
            outgoing.iter().find_map(|&h| excess_of(self.topology.half_edge(h).face))?
        };
        let corners = self.face_vertices(face);
        let gain = noise::GAIN * self.inertia.reach;
        if excess <= MAX_HIDDEN_GAINS * gain || corners.len() > MAX_SCANNED_CORNERS {
            return Some(MaxExcess { vertex, excess });
        }
        let found = self.max_excess_among(corners, normal, length, vertex);
        (found.excess <= most + gain).then_some(found)
    }

    /// Computes the excess beyond a vertex from three corners of a large face. Returns `None` if the plateau may
    /// leave the face, or if another corner may gain more than `most`. The result also includes rounding errors and the
    /// flatness. Therefore it may exceed `most`.
    #[inline]
    pub(crate) fn large_face_excess(
        &self,
        large: &LargeFace,
        normal: DVec3,
        length: f64,
        vertex: u32,
        most: f64,
    ) -> Option<f64> {
        let here = self.vertices[vertex as usize];
        let gain = |w: u32| normal.dot(self.vertices[w as usize] - here).abs();
        let [a, b, c] = large.corners;
        let highest = gain(a).max(gain(b)).max(gain(c)) / length;
        let reached = highest + noise::GAIN * self.inertia.reach;
        let is_confined = 8.0 * reached < large.descent * large.height;
        (is_confined && highest <= self.plateau_depth() && WEIGHT_SUM * highest <= most)
            .then_some(WEIGHT_SUM * reached + 8.0 * self.flatness)
    }

    /// Checks whether the body has large faces, and at most [`MAX_LARGE_FACES`].
    #[inline]
    pub(crate) fn has_large_faces(&self) -> bool {
        (1..=MAX_LARGE_FACES).contains(&self.large_faces.len())
    }

    /// Returns the large faces.
    pub(crate) fn large_faces(&self) -> &[LargeFace] {
        &self.large_faces
    }

    /// Returns the large face whose outward normal has the largest product with `direction` (body frame, any
    /// length); `None` if there are no large faces.
    #[inline]
    pub(crate) fn large_face_toward(&self, direction: DVec3) -> Option<&LargeFace> {
        let (first, others) = self.large_faces.split_first()?;
        let along = |large: &LargeFace| direction.dot(large.normal);
        let farther = |best, large| if along(large) > along(best) { large } else { best };
        Some(others.iter().fold(first, farther))
    }

    /// Returns the outward unit normal of a face (body frame) if the face is large. Three successive corners of such a
    /// face are nearly collinear. `None` for other faces.
    #[inline]
    pub(crate) fn large_face_normal(&self, face: u32) -> Option<DVec3> {
        let found = self.large_faces.binary_search_by_key(&face, |large| large.face).ok()?;
        Some(self.large_faces[found].normal)
    }

    /// Measures the flatness of the polygons, and selects the large faces.
    ///
    /// On a body that is scanned and has few polygons, all polygons count as large, but not its triangles. This
    /// covers boxes, which often rest on their faces.
    pub(super) fn measure_faces(&mut self) {
        let polygons: Vec<u32> = (0..self.face_count() as u32)
            .filter(|&face| self.face_vertices(face).len() > 3)
            .collect();
        let all = self.support.is_scanned() && polygons.len() <= MAX_LARGE_FACES;
        for face in polygons {
            let at = |v: u32| self.vertices[v as usize];
            let corners = self.face_vertices(face).map(at);
            let normal = polygon_normal(corners.clone());
            // Measured from the plane through one corner. The best parallel plane is at most as far from all
            // corners.
            let first = corners.clone().next().unwrap_or_default();
            let is_large = all || corners.len() > MAX_UNMEASURED_CORNERS;
            let off = corners.map(|p| normal.dot(p - first).abs()).fold(0.0, f64::max);
            self.flatness = self.flatness.max(off + noise::GAIN * self.inertia.reach);
            if is_large {
                self.large_faces.push(self.measure_large_face(face, normal));
            }
        }
    }

    /// Selects three corners that span a face, and measures the slopes of the edges that leave it.
    fn measure_large_face(&self, face: u32, normal: DVec3) -> LargeFace {
        let at = |v: u32| self.vertices[v as usize];
        let corners: Vec<u32> = self.face_vertices(face).collect();
        let farthest = |measure: &dyn Fn(DVec3) -> f64| {
            corners.iter().copied().fold((corners[0], 0.0), |best, v| {
                let value = measure(at(v));
                if value > best.1 { (v, value) } else { best }
            })
        };
        let first = self.topology.face_half_edges(face).start;
        let along = |v: u32| first + corners.iter().position(|&w| w == v).unwrap_or(0) as u32;
        let a = corners[0];
        let (b, length) = farthest(&|p| p.distance(at(a)));
        let axis = (at(b) - at(a)) / length;
        let (c, height) = farthest(&|p| (p - at(a)).cross(axis).length());
        let mut on_face = corners.clone();
        on_face.sort_unstable();
        let leaving = corners.iter().flat_map(|&v| {
            self.neighbours(v).iter().filter(|w| on_face.binary_search(w).is_err()).map(move |&w| {
                let edge = at(w) - at(v);
                -normal.dot(edge) / edge.length()
            })
        });
        LargeFace {
            face,
            corner_count: corners.len() as u32,
            corners: [a, b, c],
            half_edges: [a, b, c].map(along),
            normal,
            height,
            descent: leaving.fold(f64::INFINITY, f64::min),
        }
    }
}
