//! Primitive shapes of robot files: boxes, cylinders, spheres and capsules.
//!
//! - Spheres and capsules of a robot are exact rounded bodies ([`Primitive::rounded_body`]).
//! - Other round shapes become polyhedra with 64 sides. They are inscribed (touching the true shape at their vertices)
//!   in parts, and circumscribed in robots.
//! - A regular polygon scaled by `1 / cos(pi / n)` relative to the inscribed one encloses the circle. The factor
//!   `ROUNDING_MARGIN` covers the rounding errors of the vertices.

use std::f64::consts::TAU;

use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_mesh::Mesh;
use glam::{DAffine3, DVec3};

use colltrans_assembly::Piece;

/// The number of sides of a polyhedron that replaces a round shape.
const SIDES: usize = 64;

/// A factor for the size of circumscribed polyhedra. Its excess over 1 is larger than the rounding errors of the
/// vertices and the error of a convex hull that is built from them, relative to the radius.
const ROUNDING_MARGIN: f64 = 1.0 + 1e-12;

/// Returns the size of a polygon that encloses a circle, relative to the inscribed one.
fn circumscribed_scale() -> f64 {
    ROUNDING_MARGIN / (TAU / 2.0 / SIDES as f64).cos()
}

/// A shape about the origin of its own frame; its axis is z. All lengths are positive and finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Primitive {
    /// A box with these edge lengths.
    Cuboid(DVec3),
    /// A cylinder.
    Cylinder {
        /// The radius.
        radius: f64,
        /// The length of the axis.
        length: f64,
    },
    /// A sphere of this radius.
    Sphere(f64),
    /// A cylinder with a half sphere on each end.
    Capsule {
        /// The radius.
        radius: f64,
        /// The length of the axis, without the half spheres.
        length: f64,
    },
}

impl Primitive {
    /// Returns the shape if its lengths are positive and finite.
    ///
    /// # Errors
    /// A message with the lengths otherwise.
    pub(super) fn checked(self) -> Result<Self, String> {
        let (what, sizes): (_, &[f64]) = match &self {
            Self::Cuboid(size) => ("box", size.as_ref()),
            Self::Cylinder { radius, length } => ("cylinder", &[*radius, *length]),
            Self::Sphere(radius) => ("sphere", &[*radius]),
            Self::Capsule { radius, length } => ("capsule", &[*radius, *length]),
        };
        if sizes.iter().all(|x| x.is_finite() && *x > 0.0) {
            return Ok(self);
        }
        Err(format!("a {what} has sizes {sizes:?}; accepted: finite and positive"))
    }

    /// Returns the number of faces of [`Self::piece`].
    pub(super) const fn face_count(self) -> usize {
        match self {
            Self::Cuboid(_) => 6,
            Self::Cylinder { .. } => SIDES + 2,
            Self::Sphere(_) => SIDES * SIDES / 2,
            Self::Capsule { .. } => SIDES * (SIDES / 2 + 1),
        }
    }

    /// Builds the mesh of the shape. Round shapes are replaced by inscribed polyhedra.
    pub(super) fn piece(self, world_from_piece: DAffine3) -> Piece {
        match self {
            Self::Cuboid(size) => cuboid(size, world_from_piece),
            Self::Cylinder { radius, length } => cylinder(radius, length, world_from_piece),
            Self::Sphere(radius) => ball(radius, 0.0, world_from_piece),
            Self::Capsule { radius, length } => ball(radius, length, world_from_piece),
        }
    }

    /// Builds a sphere or a capsule at a pose without scale, as a rounded convex body. Returns `None` for other shapes.
    ///
    /// # Errors
    /// [`BuildError`] if the shape is outside the accepted range.
    pub(super) fn rounded_body(
        self,
        link_from_shape: DAffine3,
    ) -> Option<Result<ConvexPolyhedron, BuildError>> {
        let at = |z: f64| link_from_shape.transform_point3(DVec3::Z * z);
        match self {
            Self::Sphere(radius) => Some(ConvexPolyhedron::sphere(at(0.0), radius)),
            Self::Capsule { radius, length } => {
                let half = 0.5 * length;
                Some(ConvexPolyhedron::capsule([at(-half), at(half)], radius))
            }
            Self::Cuboid(_) | Self::Cylinder { .. } => None,
        }
    }

    /// Builds the mesh of the shape like [`Self::piece`], except that a cylinder is enclosed by its prism. A body that
    /// does not meet the prism does not meet the cylinder.
    pub(super) fn enclosing_piece(self, world_from_piece: DAffine3) -> Piece {
        match self {
            Self::Cylinder { radius, length } => {
                cylinder(radius * circumscribed_scale(), length, world_from_piece)
            }
            _ => self.piece(world_from_piece),
        }
    }

    /// Returns a note on the error of the body in a robot; `None` if that is exact.
    pub(super) fn replacement_note(self) -> Option<String> {
        let Self::Cylinder { radius, .. } = self else { return None };
        let larger = (circumscribed_scale() - 1.0) * radius;
        Some(format!(
            "a cylinder of radius {radius} is replaced by a circumscribed polyhedron of {SIDES} sides, larger by up \
             to {larger:.1e}"
        ))
    }
}

/// Builds a box with edges of length `size`, centred at the origin of the piece.
fn cuboid(size: DVec3, world_from_piece: DAffine3) -> Piece {
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

/// Builds a prism inscribed in a cylinder about z, centred at the origin of the piece.
fn cylinder(radius: f64, length: f64, world_from_piece: DAffine3) -> Piece {
    solid_of_revolution(&[(radius, -length / 2.0), (radius, length / 2.0)], None, world_from_piece)
}

/// Builds a polyhedron inscribed in a capsule about z, centred at the origin of the piece. Its axis has this length,
/// 0 for a sphere.
fn ball(radius: f64, length: f64, world_from_piece: DAffine3) -> Piece {
    let rings = SIDES / 2;
    let at = |k: usize, end: f64| {
        let (s, c) = (k as f64 / rings as f64 * TAU / 2.0).sin_cos();
        (radius * s, end - radius * c)
    };
    let half = 0.5 * length;
    // The circle in the middle is needed twice if there is an axis.
    let upper = if length > 0.0 { rings / 2 } else { rings / 2 + 1 };
    let lower = (1..=rings / 2).map(|k| at(k, -half));
    let profile: Vec<(f64, f64)> = lower.chain((upper..rings).map(|k| at(k, half))).collect();
    solid_of_revolution(&profile, Some([-half - radius, half + radius]), world_from_piece)
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
        let ball = 4.0 / 3.0 * TAU / 2.0;
        let cases = [
            (Primitive::Cuboid(DVec3::new(1.0, 2.0, 3.0)), 6.0, 1e-12),
            (Primitive::Cylinder { radius: 2.0, length: 3.0 }, round * 12.0, 1e-9),
            (Primitive::Sphere(1.0), ball, 0.02),
            (Primitive::Capsule { radius: 1.0, length: 2.0 }, ball + TAU, 0.02),
        ];
        for (shape, volume, error) in cases {
            let piece = shape.piece(at);
            assert_eq!(piece.mesh.faces.len(), shape.face_count());
            let part = Part::new("shape", &[piece]).unwrap();
            assert!(part.defects().is_empty());
            assert!((part.solid().volume() - volume).abs() < error * volume);
        }
    }

    /// Returns the smallest distance of the plane of a side from the axis, and the largest one of a vertex.
    fn distance_range(piece: &Piece) -> [f64; 2] {
        let Mesh { vertices, faces, .. } = &piece.mesh;
        let farthest = vertices.iter().map(|v| v.truncate().length()).fold(0.0, f64::max);
        let plane_distance = |face: &Vec<u32>| {
            let [a, b, c] = [0, 1, 2].map(|k| vertices[face[k] as usize]);
            let normal = (b - a).cross(c - a).normalize();
            (normal.z.abs() < 0.5).then(|| normal.dot(a))
        };
        [faces.iter().filter_map(plane_distance).fold(f64::INFINITY, f64::min), farthest]
    }

    #[test]
    fn prisms_enclose_cylinders_of_robots_only() {
        for radius in [1e-3, 0.7, 40.0] {
            let at = DAffine3::IDENTITY;
            let [_, most] = distance_range(&cylinder(radius, 3.0, at)).map(|x| x / radius);
            assert!(most <= 1.0 + 1e-15, "{most}");
            let outer = Primitive::Cylinder { radius, length: 3.0 }.enclosing_piece(at);
            let [least, most] = distance_range(&outer).map(|x| x / radius);
            // The reported bound is the factor of the vertices.
            assert!(least >= 1.0 + 1e-13 && most <= 1.0013, "{least} {most}");
        }
    }

    #[test]
    fn balls_of_robots_are_exact() {
        let at = DAffine3::from_translation(DVec3::X);
        let built = |shape: Primitive| shape.rounded_body(at).expect("round").expect("a body");
        let sphere = built(Primitive::Sphere(0.5));
        assert_eq!((sphere.vertices(), sphere.radius()), (&[DVec3::X][..], 0.5));
        let capsule = built(Primitive::Capsule { radius: 0.25, length: 2.0 });
        assert_eq!((capsule.vertices().len(), capsule.radius()), (2, 0.25));
        assert_eq!(Primitive::Sphere(0.5).replacement_note(), None);
        assert!(Primitive::Sphere(-1.0).checked().is_err());
    }
}
