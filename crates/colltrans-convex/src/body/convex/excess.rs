//! How far a body can reach beyond a support point that a climb has found.
//!
//! A climb ends where no neighbour gains more than rounding can tell. On the exact convex hull of the
//! vertices a path along its edges leads from any vertex `v` to the support point without ever going
//! down, so the support point is found by visiting, from `v`, all that may not be lower than `v`: the
//! *plateau*. What is gained there is computed from differences of vertices, up to `GAIN reach`.
//!
//! Edges of the exact hull may be diagonals of the body's polygons, which are flat only up to the
//! *flatness* `f`. One of the two ways round a polygon stays as high as its diagonal, up to `4 f`; so
//! the plateau is visited down to `h = 2 GAIN reach + 4 f` below `v`. Mostly it is `v` alone, or the
//! corners of an edge or a face.
//!
//! A face with many corners has its plateau measured at three that span it widely, `a`, `b` the one
//! farthest from `a`, and `c` the one farthest from the line through both. Any corner is `l_a a + l_b
//! b + l_c c` with `|l_c| <= 1`, `|l_b| <= 2`, `|l_a| <= 4`, up to `8 f`, so it gains at most 7 times
//! what one of the three does; and where all edges that leave the face go down more steeply than the
//! normal can be tilted, nothing off the face belongs to the plateau. Where the face is so uneven that
//! this says too little, its corners are looked at one by one.
//!
//! All this holds for any vertex, so it also tells whether one that was not found by a climb is a
//! support point: if nothing gains more than is asked for. And a climb may stick: next to edges as short
//! as `f` a vertex can be higher than its neighbours and yet lower than the support point, by `f` times
//! as much as the body is longer than they are. It is seen on the plateau, and goes on from there.

use glam::DVec3;

use super::ConvexPolyhedron;
use super::fan::{AboveQuery, FAN, MAX_UNMEASURED_CORNERS};
use colltrans_kernel::noise;
use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::work;

/// Vertices of a plateau that are visited one by one; a larger one is taken to be the whole body.
const MAX_VISITED: usize = 16;

/// Of a body with up to this many vertices each is looked at then.
const MAX_SCANNED_VERTICES: usize = 48;

/// What may be hidden by measuring at three corners, in `GAIN reach`: an exactly flat face hides half of it.
const MAX_HIDDEN_GAINS: f64 = 32.0;

/// A face with more corners is measured at three even if that hides more.
const MAX_SCANNED_CORNERS: usize = 64;

/// Of bodies with up to this many such faces each may be looked at.
const MAX_LARGE_FACES: usize = 8;

/// Cosine of the largest angle between a normal and that of a face which is looked at for it.
const MIN_NORMAL_COSINE: f64 = 0.9;

/// Sum of the magnitudes of the weights over three corners.
const WEIGHT_SUM: f64 = 7.0;

/// The highest vertex of a plateau, and how far the body may reach beyond the one it was seen from.
struct MaxExcess {
    vertex: u32,
    excess: f64,
}

/// A face with many corners, or one of few polygons.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LargeFace {
    face: u32,
    corner_count: u32,
    /// Three that span it.
    pub(crate) corners: [u32; 3],
    /// The half-edges that leave these along the face.
    pub(crate) half_edges: [u32; 3],
    /// Its unit normal, outwards.
    pub(crate) normal: DVec3,
    /// Of the triangle of the three.
    height: f64,
    /// The least slope, downwards, of the edges that leave the face.
    descent: f64,
}

impl LargeFace {
    /// Whether it counts as large only because there are few others.
    #[inline]
    pub(crate) fn has_few_corners(&self) -> bool {
        self.corner_count <= MAX_UNMEASURED_CORNERS as u32
    }
}

/// The vertices of a plateau, as far as they were found.
struct Plateau {
    /// In place of those not found yet, the first one.
    vertices: [u32; MAX_VISITED],
    count: usize,
}

impl Plateau {
    /// Adds a vertex unless it is known. `false` if there are too many.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    #[expect(clippy::needless_bitwise_bool, reason = "all compared at once is faster than a loop")]
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
    /// The support point along the unit vector `normal` (body frame), given the one that a climb has
    /// found, and a bound on how far the body reaches beyond it.
    #[doc(hidden)]
    #[inline]
    pub fn settled(&self, normal: DVec3, vertex: u32) -> (u32, f64) {
        if self.support.is_scanned() {
            return (vertex, self.scan_excess());
        }
        // Each vertex on the way is higher than the one before by more than rounding.
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

    /// A support point along `normal`, of this length, and the excess beyond it, if `near` is one as
    /// well: if nothing is seen to gain more than `most` beyond it.
    ///
    /// Lengths are compared with that of the normal, so that nothing waits for it.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    pub(crate) fn support_at(
        &self,
        normal: DVec3,
        length: f64,
        near: u32,
        most: f64,
    ) -> Option<(u32, f64)> {
        if self.support.is_scanned() {
            let found = self.support_from(normal, near);
            let gain = normal.dot(self.vertices[found as usize] - self.vertices[near as usize]);
            return (gain <= most * length).then(|| (found, self.scan_excess()));
        }
        self.excess_up_to(normal, length, near, most).map(|excess| (near, excess))
    }

    /// Of a support point that was found by a look at each vertex: the largest of the rounded
    /// products was taken, and both may be off.
    #[inline]
    fn scan_excess(&self) -> f64 {
        2.0 * noise::GAIN * self.inertia.reach
    }

    /// The excess beyond a vertex; `None` if something gains more than `most`, or the plateau is
    /// larger than can be visited.
    fn excess_up_to(&self, normal: DVec3, length: f64, vertex: u32, most: f64) -> Option<f64> {
        self.max_excess(normal, length, vertex, most).map(|found| found.excess)
    }

    /// The same with the summit of the plateau.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "who does not need the highest vertex does not look for it"
    )]
    fn max_excess(&self, normal: DVec3, length: f64, vertex: u32, most: f64) -> Option<MaxExcess> {
        let here = self.vertices[vertex as usize];
        let [least, limit] = [-self.plateau_depth(), most].map(|limit| limit * length);
        let mut plateau = Plateau { vertices: [vertex; MAX_VISITED], count: 1 };
        let (mut next, mut highest, mut highest_vertex) = (0, 0.0, vertex);
        while next < plateau.count {
            let from = plateau.vertices[next];
            let neighbours = self.neighbours(from);
            if neighbours.len() > FAN {
                let reach = self.inertia.reach;
                let above = AboveQuery { normal, length, here, least, reach };
                match self.visit_fan(from, &above, &mut plateau, (highest_vertex, highest)) {
                    Some(found) => (highest_vertex, highest) = found,
                    None => return self.max_excess_of_large_plateau(normal, length, vertex, most),
                }
            } else {
                work::count(neighbours.len());
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

    /// The highest and how high it is, after a look at those of many neighbours that may belong to the plateau;
    /// `None` if these are too many.
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

    /// The same where more may be in the plateau than is worth visiting.
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

    /// How far below a vertex its plateau is visited.
    #[inline]
    pub fn plateau_depth(&self) -> f64 {
        2.0 * noise::GAIN * self.inertia.reach + 4.0 * self.flatness
    }

    /// The same by a look at all vertices.
    fn max_excess_of_all(&self, normal: DVec3, length: f64, vertex: u32) -> MaxExcess {
        self.max_excess_among(0..self.vertices.len() as u32, normal, length, vertex)
    }

    /// The highest of some vertices, which contain the plateau.
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

    /// The same where the plateau is, at most, one face with many corners: they are looked at one by
    /// one where three do not tell enough.
    fn max_excess_on_large_face(
        &self,
        normal: DVec3,
        length: f64,
        vertex: u32,
        most: f64,
    ) -> Option<MaxExcess> {
        let outgoing = self.topology.outgoing(vertex);
        let excess_of = |face: u32| {
            let found = self.large_faces.binary_search_by_key(&face, |large| large.face).ok()?;
            let large = &self.large_faces[found];
            let excess = || self.excess_of_face(large, normal, length, vertex, most);
            let is_across = normal.dot(large.normal) > MIN_NORMAL_COSINE * length;
            is_across.then(excess).flatten().map(|excess| (face, excess))
        };
        let (face, excess) = if outgoing.len() > FAN {
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

    /// The same where the plateau is, at most, this face.
    #[inline]
    pub(crate) fn excess_of_face(
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

    /// Whether there are large faces, but few.
    #[inline]
    pub(crate) fn has_large_faces(&self) -> bool {
        (1..=MAX_LARGE_FACES).contains(&self.large_faces.len())
    }

    /// Of the large faces, the one most nearly across a direction (body frame, any
    /// length), outwards.
    #[inline]
    pub(crate) fn large_face_toward(&self, direction: DVec3) -> Option<&LargeFace> {
        let (first, others) = self.large_faces.split_first()?;
        let along = |large: &LargeFace| direction.dot(large.normal);
        let farther = |best, large| if along(large) > along(best) { large } else { best };
        Some(others.iter().fold(first, farther))
    }

    /// Measures how flat the polygons are, and those that are large.
    ///
    /// All polygons count as large, triangles apart, where they are few on a body that is looked at vertex by
    /// vertex, as those of boxes are: parts stand on them.
    pub(super) fn measure_faces(&mut self) {
        let polygons: Vec<u32> = (0..self.face_count() as u32)
            .filter(|&face| self.face_vertices(face).len() > 3)
            .collect();
        let all = self.support.is_scanned() && polygons.len() <= MAX_LARGE_FACES;
        for face in polygons {
            let at = |v: u32| self.vertices[v as usize];
            let corners = self.face_vertices(face).map(at);
            let normal = polygon_normal(corners.clone());
            // From the plane through one corner: another parallel one is at most as far from all.
            let first = corners.clone().next().unwrap_or_default();
            let is_large = all || corners.len() > MAX_UNMEASURED_CORNERS;
            let off = corners.map(|p| normal.dot(p - first).abs()).fold(0.0, f64::max);
            self.flatness = self.flatness.max(off + noise::GAIN * self.inertia.reach);
            if is_large {
                self.large_faces.push(self.measure_large_face(face, normal));
            }
        }
    }

    fn measure_large_face(&self, face: u32, normal: DVec3) -> LargeFace {
        let at = |v: u32| self.vertices[v as usize];
        let corners: Vec<u32> = self.face_vertices(face).collect();
        let farthest = |measure: &dyn Fn(DVec3) -> f64| {
            corners.iter().copied().fold((corners[0], 0.0), |best, v| {
                let value = measure(at(v));
                if value > best.1 { (v, value) } else { best }
            })
        };
        let first = self.topology.face(face).start;
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
