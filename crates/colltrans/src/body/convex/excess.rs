//! How far a body can reach beyond a support point that a climb has found.
//!
//! A climb ends where no neighbour gains more than rounding can tell. On an exactly convex body a
//! vertex none of whose neighbours gains is extreme; here neighbours may gain by as much as a dot
//! product with an edge can be wrong, and the exact hull of the vertices may have edges that are no
//! edges of the body: diagonals of its polygons, which are flat only up to the *flatness* `f`.
//!
//! Notation. `n` is the normal, `v` the vertex, `e` an edge or a diagonal from it, of unit length
//! where marked `^`; `g(e) = n . e`, known up to `err(e)`. An edge is *tied* if `g(e)` may be above
//! `-(BAND |e| + 2 f)`, a face if one of its two edges at `v` is; then its diagonals are looked at,
//! too. Along those of other faces nothing is gained but `2 f`.
//!
//! - No tie: no point is beyond `v` by more than `2 f`.
//! - With ties let `m` be the unit vector along the sum of the tied `^e`, and `s` the largest
//!   `(g(e) + err(e)) / (m . e)` of them that is positive. Then `(n - s m) . e <= 0` for the tied
//!   edges and diagonals, and, as long as `s <= BAND`, for all others up to `2 f`: `v` is extreme
//!   along `n - s m`, and along `n` no point `x` is beyond it by more than `s |x - v| + 2 f <= 2 s
//!   reach + 2 f`.
//! - At the corners of polygons with many sides, where some `m . e` is small, `s` says too much. Then
//!   all vertices are looked at, and the largest gain found is exceeded by rounding alone.

use glam::DVec3;

use super::ConvexPolyhedron;
use crate::number::noise;
use crate::number::plane::polygon_normal;

/// Gains above minus this share of an edge are ties.
const BAND: f64 = 32.0 * noise::GAIN;

/// The largest `s` that is not worth a look at all vertices.
const ENOUGH: f64 = 8.0 * noise::GAIN;

impl ConvexPolyhedron {
    /// Bound on how far the body reaches beyond `vertex`, a support point found along the unit vector
    /// `normal` (body frame).
    #[inline]
    pub(crate) fn excess(&self, normal: DVec3, vertex: u32) -> f64 {
        if self.support.is_scanned() {
            // The largest of the rounded products was taken: both may be off.
            return 2.0 * noise::GAIN * self.inertia.reach;
        }
        self.excess_of_climb(normal, vertex)
    }

    fn excess_of_climb(&self, normal: DVec3, vertex: u32) -> f64 {
        let mut sum = DVec3::ZERO;
        self.each_tie(normal, vertex, |edge, _| sum += edge * (1.0 / edge.length()));
        if sum == DVec3::ZERO {
            return 2.0 * self.flatness;
        }
        let m = sum.normalize_or_zero();
        let mut tilt = 0.0_f64;
        self.each_tie(normal, vertex, |edge, gain| {
            let excess = gain + noise::GAIN * normal.abs().dot(edge.abs());
            if excess > 0.0 {
                let along = m.dot(edge);
                // A product that may be nothing but rounding bounds nothing.
                let sound = along > noise::GAIN * edge.abs().element_sum();
                tilt = if sound { tilt.max(1.01 * excess / along) } else { f64::INFINITY };
            }
        });
        if tilt <= ENOUGH {
            return 2.0 * (self.flatness + tilt * self.inertia.reach);
        }
        let here = self.vertices[vertex as usize];
        let gain = |v: &DVec3| normal.dot(*v - here);
        let most = self.vertices.iter().map(gain).fold(0.0, f64::max);
        most + 2.0 * noise::GAIN * self.inertia.reach
    }

    /// Reports the tied edges, and the diagonals of tied faces, with what they gain.
    #[inline]
    fn each_tie(&self, normal: DVec3, vertex: u32, mut report: impl FnMut(DVec3, f64)) {
        let here = self.vertices[vertex as usize];
        let neighbours = self.neighbours(vertex);
        let mut last = usize::MAX;
        for (k, &w) in neighbours.iter().enumerate() {
            let edge = self.vertices[w as usize] - here;
            let gain = normal.dot(edge);
            let least = 2.0 * self.flatness;
            // Squares: most edges are not tied, and a root for each costs more than the rest.
            let low = (gain + least).min(0.0);
            if low * low > BAND * BAND * edge.length_squared() {
                continue;
            }
            report(edge, gain);
            if self.flatness > 0.0 {
                // The faces on either side; the one before may have been looked at.
                let before = if k == 0 { neighbours.len() - 1 } else { k - 1 };
                for corner in [before, k] {
                    if corner != last {
                        self.each_diagonal(normal, vertex, corner, &mut report);
                        last = corner;
                    }
                }
            }
        }
    }

    /// The diagonals of the face between a neighbour and the next one.
    fn each_diagonal(
        &self,
        normal: DVec3,
        vertex: u32,
        corner: usize,
        report: &mut impl FnMut(DVec3, f64),
    ) {
        let here = self.vertices[vertex as usize];
        let outgoing = self.topology.outgoing(vertex);
        let neighbours = self.neighbours(vertex);
        // The face between a neighbour and the next one is on the left of the half-edge to the next.
        let next = (corner + 1) % outgoing.len();
        let face = self.topology.half_edge(outgoing[next]).face;
        let rim = [vertex, neighbours[corner], neighbours[next]];
        for w in self.topology.face_vertices(face).filter(|w| !rim.contains(w)) {
            let edge = self.vertices[w as usize] - here;
            report(edge, normal.dot(edge));
        }
    }

    /// The largest distance of a corner from its face's plane, of all faces with more than three.
    pub(super) fn measure_flatness(&self) -> f64 {
        let polygons = 0..self.face_count() as u32;
        let off = |face: u32| {
            let corners = self.face_vertices(face).map(|v| self.vertices[v as usize]);
            let normal = polygon_normal(corners.clone());
            let Some(first) = corners.clone().next() else { return 0.0 };
            // The plane through one corner: another parallel one is at most as far from all.
            let rounding = noise::GAIN * self.inertia.reach;
            corners.map(|p| normal.dot(p - first).abs()).fold(0.0, f64::max) + rounding
        };
        polygons.filter(|&f| self.face_vertices(f).len() > 3).map(off).fold(0.0, f64::max)
    }
}
