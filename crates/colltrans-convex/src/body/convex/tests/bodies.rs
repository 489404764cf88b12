//! Bodies for the tests of sections, support points and the minimisation, constructed without a hull.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::body::ConvexPolyhedron;

/// A small generator of reproducible numbers.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Returns a number in `[-1, 1)`.
    pub(crate) fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * 0.5 * (self.signed() + 1.0)
    }

    pub(crate) fn index(&mut self, count: usize) -> usize {
        (self.within(0.0, count as f64) as usize).min(count - 1)
    }

    pub(crate) fn unit(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(self.signed(), self.signed(), self.signed());
            if (0.01..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }

    pub(crate) fn rotation(&mut self) -> DQuat {
        DQuat::from_axis_angle(self.unit(), self.within(0.0, TAU))
    }
}

/// Builds an ellipsoid with about `count` vertices (at least 8): two poles and rings between them.
pub(crate) fn ellipsoid(count: usize, semi_axes: DVec3) -> ConvexPolyhedron {
    let around = ((2.0 * count as f64).sqrt().round() as usize).clamp(3, count - 2);
    ellipsoid_with_meridians(count, around, semi_axes)
}

/// Builds an ellipsoid with about `count` vertices, whose faces are a hundred times as long as wide.
pub(crate) fn thin_ellipsoid(count: usize, semi_axes: DVec3) -> ConvexPolyhedron {
    ellipsoid_with_meridians(
        count,
        ((0.0127 * count as f64).sqrt().round() as usize).max(8),
        semi_axes,
    )
}

fn ellipsoid_with_meridians(count: usize, around: usize, semi_axes: DVec3) -> ConvexPolyhedron {
    let rings = ((count - 2) / around).max(1);
    rings_body(rings, around, semi_axes, |ring| {
        let polar = 0.5 * TAU * (ring + 1) as f64 / (rings + 1) as f64;
        (polar.sin(), polar.cos())
    })
}

/// Builds a body from poles at `z = 1` and `z = -1` and rings of `(radius, z)` from top to bottom, scaled by
/// `scale`.
fn rings_body(
    rings: usize,
    around: usize,
    scale: DVec3,
    profile: impl Fn(usize) -> (f64, f64),
) -> ConvexPolyhedron {
    let mut vertices = vec![DVec3::Z * scale];
    for ring in 0..rings {
        let (radius, z) = profile(ring);
        for i in 0..around {
            let (sin, cos) = (TAU * i as f64 / around as f64).sin_cos();
            vertices.push(DVec3::new(radius * cos, radius * sin, z) * scale);
        }
    }
    vertices.push(-DVec3::Z * scale);
    let at = |ring: usize, i: usize| (1 + ring * around + i % around) as u32;
    let south = vertices.len() as u32 - 1;
    let mut faces = Vec::new();
    for i in 0..around {
        faces.push(vec![0, at(0, i), at(0, i + 1)]);
        for ring in 1..rings {
            faces.push(vec![at(ring - 1, i), at(ring, i), at(ring, i + 1), at(ring - 1, i + 1)]);
        }
        faces.push(vec![at(rings - 1, i), south, at(rings - 1, i + 1)]);
    }
    ConvexPolyhedron::from_convex_faces(&vertices, &faces)
}

/// Builds a right prism over a regular polygon, along z.
pub(crate) fn prism(around: usize, scale: DVec3) -> ConvexPolyhedron {
    let mut vertices = Vec::new();
    for z in [-1.0, 1.0] {
        for i in 0..around {
            let (sin, cos) = (TAU * i as f64 / around as f64).sin_cos();
            vertices.push(DVec3::new(cos, sin, z) * scale);
        }
    }
    let n = around as u32;
    let mut faces = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]));
    ConvexPolyhedron::from_convex_faces(&vertices, &faces)
}

/// Builds a cone over a regular polygon, with the apex at z = 1 and the base at z = -1.
pub(crate) fn cone(around: usize, scale: DVec3) -> ConvexPolyhedron {
    let mut vertices = vec![DVec3::Z * scale];
    for i in 0..around {
        let (sin, cos) = (TAU * i as f64 / around as f64).sin_cos();
        vertices.push(DVec3::new(cos, sin, -1.0) * scale);
    }
    let n = around as u32;
    let mut faces = vec![(1..=n).rev().collect()];
    faces.extend((0..n).map(|i| vec![0, 1 + i, 1 + (i + 1) % n]));
    ConvexPolyhedron::from_convex_faces(&vertices, &faces)
}

/// Builds a box with the given half extents around `centre`.
pub(crate) fn cuboid(centre: DVec3, half: DVec3) -> ConvexPolyhedron {
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        centre + half * DVec3::new(sign(0), sign(1), sign(2))
    };
    let vertices: Vec<DVec3> = (0..8).map(corner).collect();
    let faces =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    ConvexPolyhedron::from_convex_faces(&vertices, &faces.map(Vec::from))
}
