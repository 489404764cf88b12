//! Builds meshes of the shapes of URDF: boxes, cylinders and spheres. Round shapes become polyhedra with 64
//! sides, inscribed (touching the true shape at their vertices) or circumscribed.
//!
//! Size of a circumscribed polyhedron, with `c = cos(pi / n)` for `n` sides:
//!
//! - A regular polygon scaled by `1 / c` relative to the inscribed one encloses the circle.
//! - A face of a sphere lies between two circles of latitude and two meridians. In a meridian plane the profile
//!   of the inscribed polyhedron is a polygon of `n` sides, at least `c` from the centre. Halfway between
//!   meridians that profile is narrower by `c`. All faces are therefore at least `c^2` from the centre, and the
//!   factor `1 / c^2` encloses the sphere.
//! - The factor `ROUNDING_MARGIN` covers the rounding errors of the vertices.

use std::f64::consts::TAU;

use colltrans_mesh::Mesh;
use glam::{DAffine3, DVec3};

use colltrans_assembly::Piece;

/// The number of sides of a polyhedron that replaces a round shape.
pub(super) const SIDES: usize = 64;

/// A factor for the size of circumscribed polyhedra. Its excess over 1 is larger than the rounding errors of the
/// vertices and the error of a convex hull that is built from them, relative to the radius.
const ROUNDING_MARGIN: f64 = 1.0 + 1e-12;

/// The position of the polyhedron relative to the round shape that it replaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Round {
    /// Inscribed: it touches the true shape at its vertices, so shapes that fit still fit.
    Inscribed,
    /// Circumscribed: it encloses the true shape, so a body that does not meet it does not meet the true shape.
    Circumscribed,
}

impl Round {
    /// Returns the size relative to the inscribed polyhedron, for a cylinder.
    pub(super) fn cylinder_scale(self) -> f64 {
        match self {
            Self::Inscribed => 1.0,
            Self::Circumscribed => ROUNDING_MARGIN / (TAU / 2.0 / SIDES as f64).cos(),
        }
    }

    /// Returns the size relative to the inscribed polyhedron, for a sphere.
    pub(super) fn sphere_scale(self) -> f64 {
        match self {
            Self::Inscribed => 1.0,
            Self::Circumscribed => ROUNDING_MARGIN / (TAU / 2.0 / SIDES as f64).cos().powi(2),
        }
    }
}

/// Builds a box with edges of length `size`, centred at the origin of the piece.
pub(super) fn cuboid(size: DVec3, world_from_piece: DAffine3) -> Piece {
    let half = size * 0.5;
    let corner = |k: usize| {
        let sign = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        half * DVec3::new(sign(0), sign(1), sign(2))
    };
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = faces.iter().map(|f| f.to_vec()).collect();
    Piece { mesh: Mesh::new((0..8).map(corner).collect(), faces), world_from_piece }
}

/// Builds a cylinder about z, centred at the origin of the piece.
pub(super) fn cylinder(
    radius: f64,
    length: f64,
    round: Round,
    world_from_piece: DAffine3,
) -> Piece {
    let radius = radius * round.cylinder_scale();
    solid_of_revolution(&[(radius, -length / 2.0), (radius, length / 2.0)], None, world_from_piece)
}

/// Builds a sphere, centred at the origin of the piece.
pub(super) fn sphere(radius: f64, round: Round, world_from_piece: DAffine3) -> Piece {
    let radius = radius * round.sphere_scale();
    let rings = SIDES / 2;
    let at = |k: usize| (k as f64 / rings as f64 * TAU / 2.0).sin_cos();
    let profile: Vec<(f64, f64)> =
        (1..rings).map(at).map(|(s, c)| (radius * s, -radius * c)).collect();
    solid_of_revolution(&profile, Some([-radius, radius]), world_from_piece)
}

/// Builds a solid of revolution: rotates a profile of points (radius, z), in increasing order of z, about z.
/// Its ends are the points `poles` on the axis, or flat faces if that is `None`.
fn solid_of_revolution(
    profile: &[(f64, f64)],
    poles: Option<[f64; 2]>,
    world_from_piece: DAffine3,
) -> Piece {
    let angle = |k: usize| (k as f64 / SIDES as f64 * TAU).sin_cos();
    let mut vertices: Vec<DVec3> = Vec::new();
    for &(r, z) in profile {
        vertices.extend((0..SIDES).map(angle).map(|(s, c)| DVec3::new(r * c, r * s, z)));
    }
    let n = SIDES as u32;
    let mut faces = Vec::new();
    for ring in 0..profile.len() as u32 - 1 {
        for k in 0..n {
            let (a, b) = (ring * n + k, ring * n + (k + 1) % n);
            faces.push(vec![a, b, b + n, a + n]);
        }
    }
    let top = (profile.len() as u32 - 1) * n;
    if let Some([low, high]) = poles {
        let pole = vertices.len() as u32;
        vertices.extend([DVec3::Z * low, DVec3::Z * high]);
        for k in 0..n {
            let l = (k + 1) % n;
            faces.push(vec![l, k, pole]);
            faces.push(vec![top + k, top + l, pole + 1]);
        }
    } else {
        faces.push((0..n).rev().collect());
        faces.push((top..top + n).collect());
    }
    Piece { mesh: Mesh::new(vertices, faces), world_from_piece }
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans_assembly::Part;

    #[test]
    fn shapes_are_closed_with_expected_volumes() {
        let at = DAffine3::IDENTITY;
        let round = 0.5 * SIDES as f64 * (TAU / SIDES as f64).sin();
        let cases = [
            (cuboid(DVec3::new(1.0, 2.0, 3.0), at), 6.0, 1e-12),
            (cylinder(2.0, 3.0, Round::Inscribed, at), round * 12.0, 1e-9),
            (sphere(1.0, Round::Inscribed, at), 4.0 / 3.0 * TAU / 2.0, 0.02),
        ];
        for (piece, volume, error) in cases {
            let part = Part::new("shape", &[piece]).unwrap();
            assert!(part.defects().is_empty());
            assert!((part.solid().volume() - volume).abs() < error * volume);
        }
    }

    /// Returns the smallest distance of the plane of a face, and the largest distance of a vertex. Distances are
    /// from the axis of a cylinder (`flat`) or from the centre of a sphere. The end faces of a cylinder are left
    /// out.
    fn distance_range(piece: &Piece, flat: bool) -> [f64; 2] {
        let Mesh { vertices, faces, .. } = &piece.mesh;
        let from_axis = |v: DVec3| if flat { v.truncate().length() } else { v.length() };
        let plane = |face: &Vec<u32>| {
            let [a, b, c] = [0, 1, 2].map(|k| vertices[face[k] as usize]);
            let normal = (b - a).cross(c - a).normalize();
            // The end faces of a cylinder do not depend on its radius.
            if flat && normal.z.abs() > 0.5 { f64::INFINITY } else { normal.dot(a) }
        };
        let least = faces.iter().map(plane).fold(f64::INFINITY, f64::min);
        [least, vertices.iter().copied().map(from_axis).fold(0.0, f64::max)]
    }

    #[test]
    fn round_shapes_are_inscribed_or_circumscribed() {
        let at = DAffine3::IDENTITY;
        for radius in [1e-3, 0.7, 40.0] {
            for (round, is_around) in [(Round::Inscribed, false), (Round::Circumscribed, true)] {
                for (piece, flat) in
                    [(cylinder(radius, 3.0, round, at), true), (sphere(radius, round, at), false)]
                {
                    let [least, most] = distance_range(&piece, flat).map(|x| x / radius);
                    if is_around {
                        // The reported bound is the factor of the vertices.
                        assert!(least >= 1.0 + 1e-13, "{least}");
                        assert!(most <= 1.0025, "{most}");
                    } else {
                        assert!(most <= 1.0 + 1e-15 && least >= 0.997, "{least} {most}");
                    }
                }
            }
        }
    }
}
