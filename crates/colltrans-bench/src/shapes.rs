//! Bodies to measure with: ellipsoids in rings, random hulls, needles and plates.

use std::f64::consts::{PI, TAU};

use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_oracle::settings::Rng;
use glam::DVec3;

/// A kind of body, of any number of vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Vertices on an ellipsoid with random semi-axes from 0.6 to 1.4, in rings: nearly all faces
    /// are trapezoids.
    Ellipsoid,
    /// Random points on a sphere: all faces are triangles.
    RandomHull,
    /// An affine image of a ring ellipsoid, this many times longer than thick.
    Needle(f64),
    /// An affine image of a ring ellipsoid, this many times wider than thick.
    Plate(f64),
}

impl Shape {
    /// The name in tables.
    pub fn name(self) -> String {
        match self {
            Self::Ellipsoid => "ellipsoid".into(),
            Self::RandomHull => "random hull".into(),
            Self::Needle(ratio) => format!("needle {ratio}:1"),
            Self::Plate(ratio) => format!("plate {ratio}:1"),
        }
    }

    /// One body with about `n` vertices.
    ///
    /// # Errors
    /// As the constructors of [`ConvexPolyhedron`].
    pub fn draw(self, n: usize, rng: &mut Rng) -> Result<ConvexPolyhedron, BuildError> {
        let semi_axes = DVec3::from_array([0; 3].map(|_| rng.range(0.6, 1.4)));
        match self {
            Self::Ellipsoid => ring_ellipsoid(n, semi_axes),
            Self::RandomHull => {
                let points: Vec<DVec3> = (0..n).map(|_| rng.direction()).collect();
                ConvexPolyhedron::from_points(&points)
            }
            // Of the same length whatever the ratio; the rings run around the long axis or across
            // the plate.
            Self::Needle(ratio) => {
                ring_ellipsoid(n, semi_axes * DVec3::new(1.0 / ratio, 1.0 / ratio, 1.0))
            }
            Self::Plate(ratio) => ring_ellipsoid(n, semi_axes * DVec3::new(1.0, 1.0 / ratio, 1.0)),
        }
    }
}

/// Vertices and faces of a sphere in rings between two poles, about as many rings as vertices in a
/// ring.
pub fn ring_sphere(n: usize) -> (Vec<DVec3>, Vec<Vec<u32>>) {
    let around = (n.saturating_sub(2) as f64).sqrt().round().max(3.0) as u32;
    let rings = (n.saturating_sub(2) as f64 / f64::from(around)).round().max(1.0) as u32;
    let mut vertices = vec![DVec3::Z];
    for ring in 1..=rings {
        let polar_rad = PI * f64::from(ring) / f64::from(rings + 1);
        for k in 0..around {
            let angle_rad = TAU * f64::from(k) / f64::from(around);
            vertices.push(DVec3::new(
                polar_rad.sin() * angle_rad.cos(),
                polar_rad.sin() * angle_rad.sin(),
                polar_rad.cos(),
            ));
        }
    }
    vertices.push(DVec3::NEG_Z);
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
    (vertices, faces)
}

/// A ring sphere with the given semi-axes, built from its mesh.
///
/// # Errors
/// As [`ConvexPolyhedron::from_mesh`].
pub fn ring_ellipsoid(n: usize, semi_axes: DVec3) -> Result<ConvexPolyhedron, BuildError> {
    let (vertices, faces) = ring_sphere(n);
    let vertices: Vec<DVec3> = vertices.iter().map(|v| *v * semi_axes).collect();
    // The corners of a trapezoid are rounded: its face is flat to within a few units in the last
    // place.
    ConvexPolyhedron::from_mesh(&vertices, &faces, 64.0 * f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ring_spheres_have_about_the_vertices_asked_for() {
        for (n, expected) in [(8, 8), (32, 32), (128, 123), (512, 508), (2_000, 1_982)] {
            let (vertices, faces) = ring_sphere(n);
            assert!(vertices.len().abs_diff(expected) <= n / 20, "{n}: {}", vertices.len());
            let edges = faces.iter().map(Vec::len).sum::<usize>() / 2;
            assert_eq!(vertices.len() + faces.len(), edges + 2);
        }
    }
}
