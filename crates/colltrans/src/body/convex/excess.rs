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
//! normal can be tilted, nothing off the face belongs to the plateau.

use glam::DVec3;

use super::ConvexPolyhedron;
use crate::number::noise;
use crate::number::plane::polygon_normal;

/// Vertices of a plateau that are visited one by one; a larger one is taken to be the whole body.
const VISITED: usize = 16;

/// Of bodies with up to this many vertices each is looked at: that is faster than to visit some.
const SMALL: usize = 48;

/// A face with more corners is measured at three.
const FEW: usize = 8;

/// Sum of the magnitudes of the weights over three corners.
const WEIGHTS: f64 = 7.0;

/// A face with many corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct LargeFace {
    face: u32,
    /// Three that span it.
    corners: [u32; 3],
    normal: DVec3,
    /// Of the triangle of the three.
    height: f64,
    /// The least slope, downwards, of the edges that leave the face.
    descent: f64,
}

impl ConvexPolyhedron {
    /// Bound on how far the body reaches beyond `vertex`, a support point found along the unit vector
    /// `normal` (body frame).
    #[inline]
    pub(crate) fn excess(&self, normal: DVec3, vertex: u32) -> f64 {
        if self.support.is_scanned() {
            // The largest of the rounded products was taken: both may be off.
            return 2.0 * noise::GAIN * self.inertia.reach;
        }
        let here = self.vertices[vertex as usize];
        let least = -self.plateau_depth();
        let neighbours = self.neighbours(vertex);
        let ties = |w: &u32| normal.dot(self.vertices[*w as usize] - here) > least;
        if neighbours.iter().any(ties) { self.excess_of_plateau(normal, vertex) } else { 0.0 }
    }

    /// How far below a vertex its plateau is visited.
    #[inline]
    fn plateau_depth(&self) -> f64 {
        2.0 * noise::GAIN * self.inertia.reach + 4.0 * self.flatness
    }

    #[inline(never)]
    fn excess_of_plateau(&self, normal: DVec3, vertex: u32) -> f64 {
        if self.vertices.len() <= SMALL {
            return self.excess_of_all(normal, vertex);
        }
        if !self.large_faces.is_empty()
            && let Some(excess) = self.excess_of_large_face(normal, vertex)
        {
            return excess;
        }
        let here = self.vertices[vertex as usize];
        let least = -self.plateau_depth();
        let gain = |w: u32| normal.dot(self.vertices[w as usize] - here);
        let mut plateau = [vertex; VISITED];
        let (mut count, mut next, mut most) = (1, 0, 0.0_f64);
        while next < count {
            for &w in self.neighbours(plateau[next]) {
                let gained = gain(w);
                if gained <= least || plateau[..count].contains(&w) {
                    continue;
                }
                if count == VISITED {
                    return self.excess_of_all(normal, vertex);
                }
                plateau[count] = w;
                count += 1;
                most = most.max(gained);
            }
            next += 1;
        }
        most + noise::GAIN * self.inertia.reach
    }

    /// The same by a look at all vertices.
    fn excess_of_all(&self, normal: DVec3, vertex: u32) -> f64 {
        let here = self.vertices[vertex as usize];
        let mut most = 0.0;
        for v in &self.vertices {
            let gain = normal.dot(*v - here);
            most = if gain > most { gain } else { most };
        }
        most + noise::GAIN * self.inertia.reach
    }

    /// The same where the plateau is, at most, one face with many corners.
    fn excess_of_large_face(&self, normal: DVec3, vertex: u32) -> Option<f64> {
        let here = self.vertices[vertex as usize];
        let gain = |w: u32| normal.dot(self.vertices[w as usize] - here);
        let around = self.topology.outgoing(vertex).iter();
        let large = around.map(|&h| self.topology.half_edge(h).face).filter_map(|face| {
            let found = self.large_faces.binary_search_by_key(&face, |large| large.face);
            found.ok().map(|k| &self.large_faces[k])
        });
        let near = large.filter(|large| normal.dot(large.normal) > 0.9);
        for LargeFace { corners, height, descent, .. } in near {
            let gains = corners.map(|w| gain(w).abs());
            let most = gains[0].max(gains[1]).max(gains[2]) + noise::GAIN * self.inertia.reach;
            if 8.0 * most < descent * height {
                return Some(WEIGHTS * most + 8.0 * self.flatness);
            }
        }
        None
    }

    /// Measures how flat the polygons are, and those with many corners.
    pub(super) fn measure_faces(&mut self) {
        for face in 0..self.face_count() as u32 {
            let count = self.face_vertices(face).len();
            if count > 3 {
                let at = |v: u32| self.vertices[v as usize];
                let corners = self.face_vertices(face).map(at);
                let normal = polygon_normal(corners.clone());
                // From the plane through one corner: another parallel one is at most as far from all.
                let first = corners.clone().next().unwrap_or_default();
                let off = corners.map(|p| normal.dot(p - first).abs()).fold(0.0, f64::max);
                self.flatness = self.flatness.max(off + noise::GAIN * self.inertia.reach);
                if count > FEW {
                    self.large_faces.push(self.large_face(face, normal));
                }
            }
        }
    }

    fn large_face(&self, face: u32, normal: DVec3) -> LargeFace {
        let at = |v: u32| self.vertices[v as usize];
        let corners: Vec<u32> = self.face_vertices(face).collect();
        let farthest = |measure: &dyn Fn(DVec3) -> f64| {
            corners.iter().copied().fold((corners[0], 0.0), |best, v| {
                let value = measure(at(v));
                if value > best.1 { (v, value) } else { best }
            })
        };
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
            corners: [a, b, c],
            normal,
            height,
            descent: leaving.fold(f64::INFINITY, f64::min),
        }
    }
}
