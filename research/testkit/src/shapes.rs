//! Bodies to measure with, as vertices and faces: centred at the origin, of about unit size.
//!
//! Notation. A *ring body* has `rings` parallels of `around` vertices each between two poles.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::random::Random;

/// Vertices and faces, counter-clockwise as seen from outside. Without faces: the convex hull of
/// the vertices is meant.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// The vertices.
    pub vertices: Vec<DVec3>,
    /// The faces, as lists of vertices; trapezoids are flat but for rounding.
    pub faces: Vec<Vec<u32>>,
}

impl Mesh {
    /// Points alone.
    pub fn of_points(vertices: Vec<DVec3>) -> Self {
        Self { vertices, faces: Vec::new() }
    }

    /// The image under a map that keeps the orientation and flat faces flat.
    #[must_use]
    pub fn mapped(mut self, map: impl Fn(DVec3) -> DVec3) -> Self {
        for v in &mut self.vertices {
            *v = map(*v);
        }
        self
    }
}

/// Points by the bits of their coordinates: cases that were found once, to the last digit.
pub fn of_bits(bits: &[[u64; 3]]) -> Vec<DVec3> {
    bits.iter().map(|point| DVec3::from_array(point.map(f64::from_bits))).collect()
}

/// A unit sphere in rings, its inner faces trapezoids.
pub fn ring_sphere(around: u32, rings: u32) -> Mesh {
    let vertices = ring_points(around, rings, 0.0);
    let at = |ring: u32, k: u32| 1 + ring * around + k % around;
    let south = rings * around + 1;
    let mut faces = Vec::new();
    for k in 0..around {
        faces.push(vec![0, at(0, k), at(0, k + 1)]);
        for ring in 1..rings {
            faces.push(vec![at(ring - 1, k), at(ring, k), at(ring, k + 1), at(ring - 1, k + 1)]);
        }
        faces.push(vec![at(rings - 1, k), south, at(rings - 1, k + 1)]);
    }
    Mesh { vertices, faces }
}

/// The poles and rings of a unit sphere; odd rings are turned by `twist` steps.
pub fn ring_points(around: u32, rings: u32, twist: f64) -> Vec<DVec3> {
    let mut vertices = vec![DVec3::Z];
    for ring in 1..=rings {
        let polar_rad = PI * f64::from(ring) / f64::from(rings + 1);
        for k in 0..around {
            let angle_rad = TAU * (f64::from(k) + twist * f64::from(ring % 2)) / f64::from(around);
            vertices.push(DVec3::new(
                polar_rad.sin() * angle_rad.cos(),
                polar_rad.sin() * angle_rad.sin(),
                polar_rad.cos(),
            ));
        }
    }
    vertices.push(DVec3::NEG_Z);
    vertices
}

/// Vertices around and rings of a ring body with about `n` vertices, as many around as rings.
pub fn even_rings(n: usize) -> [u32; 2] {
    let inner = n.saturating_sub(2) as f64;
    let around = inner.sqrt().round().max(3.0);
    [around as u32, (inner / around).round().max(1.0) as u32]
}

/// About `n` vertices in rings on `|x|^e + |y|^e + |z|^e = 1`: round for 2, box-like above.
///
/// The faces are not flat: the hull of the points is meant.
pub fn superellipsoid(n: usize, exponent: f64) -> Mesh {
    let [around, rings] = even_rings(n);
    let onto = |v: DVec3| {
        let sum: f64 = v.abs().to_array().into_iter().map(|c| c.powf(exponent)).sum();
        v * sum.powf(-exponent.recip())
    };
    // Turned a little, so that no ring lies in a symmetry plane.
    Mesh::of_points(ring_points(around, rings, 0.3).into_iter().map(onto).collect())
}

/// The upper half of a ring sphere of about `2 n` vertices, with a flat base.
pub fn half_sphere(n: usize) -> Mesh {
    let [around, rings] = even_rings(2 * n);
    let rings = (rings - 1) | 1;
    let upper =
        ring_points(around, rings, 0.0).into_iter().take(1 + (around * (rings / 2 + 1)) as usize);
    Mesh::of_points(upper.map(|v| if v.z.abs() < 1e-9 { v.with_z(0.0) } else { v }).collect())
}

/// A prism over a regular polygon with `sides` corners of radius 1, from `z = -half_height` to
/// `half_height`: the first corner on the x axis, bottom ring first.
pub fn prism(sides: u32, half_height: f64) -> Mesh {
    let ring = |z: f64| {
        (0..sides).map(move |k| {
            let angle_rad = TAU * f64::from(k) / f64::from(sides);
            DVec3::new(angle_rad.cos(), angle_rad.sin(), z)
        })
    };
    let vertices = ring(-half_height).chain(ring(half_height)).collect();
    let mut faces: Vec<Vec<u32>> = vec![(0..sides).rev().collect(), (sides..2 * sides).collect()];
    for k in 0..sides {
        let next = (k + 1) % sides;
        faces.push(vec![k, next, sides + next, sides + k]);
    }
    Mesh { vertices, faces }
}

/// The box from `-half` to `half`.
pub fn cuboid(half: DVec3) -> Mesh {
    let corner = |i: usize| {
        half * DVec3::new([-1.0, 1.0][i & 1], [-1.0, 1.0][i >> 1 & 1], [-1.0, 1.0][i >> 2])
    };
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh { vertices: (0..8).map(corner).collect(), faces: faces.map(Vec::from).to_vec() }
}

/// Random points on the unit sphere: their hull has triangles only.
pub fn random_hull(n: usize, random: &mut Random) -> Mesh {
    Mesh::of_points((0..n).map(|_| random.direction()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every directed edge once, its reverse once, and every face seen from outside.
    fn assert_closed_and_outward(mesh: &Mesh) {
        let mut edges = std::collections::BTreeSet::new();
        for face in &mesh.faces {
            for (k, &from) in face.iter().enumerate() {
                assert!(edges.insert((from, face[(k + 1) % face.len()])), "twice: {face:?}");
            }
            let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[face[k] as usize]);
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0, "inwards: {face:?}");
        }
        assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
        assert_eq!(mesh.vertices.len() + mesh.faces.len(), edges.len() / 2 + 2);
    }

    #[test]
    fn meshes_are_closed() {
        for mesh in [ring_sphere(5, 3), ring_sphere(3, 1), prism(3, 0.5), prism(24, 1.0)] {
            assert_closed_and_outward(&mesh);
        }
        assert_closed_and_outward(&cuboid(DVec3::new(1.0, 2.0, 3.0)));
    }

    #[test]
    fn ring_bodies_have_about_the_vertices_asked_for() {
        for (n, expected) in [(8, 8), (32, 32), (128, 123), (512, 508), (2_000, 1_982)] {
            let [around, rings] = even_rings(n);
            assert_eq!(ring_sphere(around, rings).vertices.len(), expected);
            assert_eq!(superellipsoid(n, 4.0).vertices.len(), expected);
            let half = half_sphere(n).vertices.len();
            assert!(half.abs_diff(n) <= 2 + n / 4, "{n}: {half}");
        }
    }

    #[test]
    fn shapes_lie_where_they_should() {
        for v in superellipsoid(500, 4.0).vertices {
            let sum: f64 = v.to_array().into_iter().map(|c| c.powi(4)).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
        let half = half_sphere(500);
        let base = half.vertices.iter().filter(|v| v.z == 0.0).count();
        assert!(base >= 20 && half.vertices.iter().all(|v| v.z >= 0.0), "{base}");
    }
}
