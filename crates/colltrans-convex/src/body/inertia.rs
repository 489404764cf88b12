//! Size, volume and inertia ellipsoid of a body.
//!
//! The *inertia ellipsoid* is `{c + x : x^T S^-1 x <= 1}`. Its centre `c` is the body's centroid, and `S = 5 cov`
//! with the covariance `cov` of the body's volume. For a body without volume, `c` and `cov` are those of its
//! vertices. A small multiple of the identity is added to `cov`, so that `S` is positive definite. Except for this
//! term, the inertia ellipsoid of a solid ellipsoid is this ellipsoid itself.
//!
//! It provides guesses of the first normal of a query, the directions of the support table, over which the body's
//! normals spread evenly, and the coordinates in which offset bodies are computed.

use glam::{DMat3, DVec3};

use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::topology::Topology;

/// Size, volume and inertia ellipsoid of a body, in its own frame.
#[derive(Debug, Clone, Copy)]
pub struct Inertia {
    /// Largest distance of a vertex from the frame's origin.
    pub reach: f64,
    /// Centroid of the volume; of the vertices if the body has no volume.
    pub center: DVec3,
    /// Lower triangular `L` with `S = L L^T` positive definite. The inertia ellipsoid is `c + L (unit ball)`.
    pub factor: DMat3,
    /// Square root of the trace of `S`, the mean size of the ellipsoid.
    pub(crate) radius: f64,
    /// Whether the semi-axes of the ellipsoid are nearly equal.
    pub(crate) is_round: bool,
    /// Radius of a ball around the centre that the body certainly contains; 0 if the body has no volume.
    pub(crate) inner_radius: f64,
    /// Volume; 0 for a body of lower dimension.
    pub(crate) volume: f64,
}

/// Minimum ratio of the ellipsoid's axes. It keeps `S` positive definite for flat bodies.
const MIN_AXIS_RATIO: f64 = 1e-6;

/// Minimum ratio of the geometric to the arithmetic mean of the squared semi-axes of a round ellipsoid.
const MIN_ROUNDNESS: f64 = 0.6;

impl Inertia {
    /// Computes the moments of a body from its vertices, its faces and its dimension.
    pub(crate) fn new(vertices: &[DVec3], topology: &Topology, dimension: u8) -> Self {
        let reach = vertices.iter().map(|v| v.length()).fold(0.0, f64::max);
        let mean = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        let solid = if dimension == 3 { solid_moments(vertices, topology, mean) } else { None };
        let (volume, center, covariance) = solid.unwrap_or_else(|| {
            let spread = |v: &DVec3| outer_product(*v - mean, *v - mean);
            let sum = vertices.iter().map(spread).fold(DMat3::ZERO, |a, b| a + b);
            (0.0, mean, sum * (1.0 / vertices.len() as f64))
        });
        // A body of one point has a covariance of zero; the matrix must still be positive definite.
        let trace = covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z;
        let floor = (trace * MIN_AXIS_RATIO * MIN_AXIS_RATIO).max(f64::MIN_POSITIVE.sqrt());
        let shape = (covariance + DMat3::from_diagonal(DVec3::splat(floor))) * 5.0;
        let radius = (0..3).map(|i| shape.col(i)[i]).sum::<f64>().sqrt();
        let factor = cholesky(&shape);
        // Both means are cubed and divided by powers of the radius. This needs no root, which platforms round
        // differently, and cannot overflow.
        let axes = (factor.x_axis.x / radius) * (factor.y_axis.y / radius);
        let geometric = axes * (factor.z_axis.z / radius);
        let round = geometric * geometric
            > (MIN_ROUNDNESS / 3.0) * (MIN_ROUNDNESS / 3.0) * (MIN_ROUNDNESS / 3.0);
        let inner = if volume > 0.0 { inner_radius(vertices, topology, center) } else { 0.0 };
        Self { reach, center, factor, radius, is_round: round, inner_radius: inner, volume }
    }

    /// Returns the signed volume that a closed surface encloses. It is positive if the faces are counter-clockwise
    /// as seen from outside.
    pub(crate) fn signed_volume(vertices: &[DVec3], topology: &Topology) -> f64 {
        let apex = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        (0..topology.face_count() as u32)
            .map(|face| {
                let mut corners = topology.face_vertices(face).map(|v| vertices[v as usize] - apex);
                let (Some(a), Some(mut b)) = (corners.next(), corners.next()) else { return 0.0 };
                let mut volume = 0.0;
                for c in corners {
                    volume += a.dot(b.cross(c)) / 6.0;
                    b = c;
                }
                volume
            })
            .sum()
    }

    /// Returns the product `L^T m`.
    #[inline]
    pub(crate) fn transposed_factor_product(&self, m: &DMat3) -> DMat3 {
        let l = &self.factor;
        let column = |c: DVec3| {
            DVec3::new(l.x_axis.dot(c), l.y_axis.y * c.y + l.y_axis.z * c.z, l.z_axis.z * c.z)
        };
        DMat3::from_cols(column(m.x_axis), column(m.y_axis), column(m.z_axis))
    }
}

/// Factor of the computed inner radius that is kept. The margin covers rounding errors, and rotations that deviate
/// from orthogonality by the admitted amount.
const INNER_SHARE: f64 = 1.0 - 1e-5;

/// Returns the radius of a ball around `center` inside a closed convex surface, or 0 if rounding leaves none.
///
/// For each face, the smallest distance of a corner from `center` along the face's normal is a lower bound of the
/// distance of every triangle between corners of the face. This also holds for faces that are not exactly flat.
/// These triangles form a closed surface around the centre, and the body, which is convex, contains the volume that
/// they enclose.
fn inner_radius(vertices: &[DVec3], topology: &Topology, center: DVec3) -> f64 {
    let corners = |face| topology.face_vertices(face).map(|v| vertices[v as usize] - center);
    let distance = |face| {
        let normal = polygon_normal(corners(face));
        corners(face).map(|corner| normal.dot(corner)).fold(f64::INFINITY, f64::min)
    };
    let min_distance =
        (0..topology.face_count() as u32).map(distance).fold(f64::INFINITY, f64::min);
    // The rounding error is relative to the coordinates, not to the distance.
    let rounding = 16.0 * f64::EPSILON * vertices.iter().map(|v| v.length()).fold(0.0, f64::max);
    if min_distance.is_finite() { (INNER_SHARE * min_distance - rounding).max(0.0) } else { 0.0 }
}

/// Computes the lower triangular Cholesky factor `L` with `s = L L^T`.
fn cholesky(s: &DMat3) -> DMat3 {
    let floor = f64::MIN_POSITIVE;
    let l00 = s.x_axis.x.max(floor).sqrt();
    let (l10, l20) = (s.x_axis.y / l00, s.x_axis.z / l00);
    let l11 = (s.y_axis.y - l10 * l10).max(floor).sqrt();
    let l21 = (s.y_axis.z - l20 * l10) / l11;
    let l22 = (s.z_axis.z - l20 * l20 - l21 * l21).max(floor).sqrt();
    DMat3::from_cols(
        DVec3::new(l00, l10, l20),
        DVec3::new(0.0, l11, l21),
        DVec3::new(0.0, 0.0, l22),
    )
}

/// Returns the matrix `a b^T`.
fn outer_product(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Computes volume, centroid and covariance from the tetrahedra between `apex` and a triangle fan of each face.
/// Returns `None` if rounding leaves no positive volume.
fn solid_moments(
    vertices: &[DVec3],
    topology: &Topology,
    apex: DVec3,
) -> Option<(f64, DVec3, DMat3)> {
    let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
    for face in 0..topology.face_count() as u32 {
        let mut corners = topology.face_vertices(face).map(|v| vertices[v as usize] - apex);
        let (Some(a), Some(mut b)) = (corners.next(), corners.next()) else { continue };
        for c in corners {
            let six_volumes = a.dot(b.cross(c));
            let sum = a + b + c;
            volume += six_volumes / 6.0;
            first += sum * (six_volumes / 24.0);
            let squares = outer_product(a, a)
                + outer_product(b, b)
                + outer_product(c, c)
                + outer_product(sum, sum);
            second += squares * (six_volumes / 120.0);
            b = c;
        }
    }
    let mean = first / volume;
    let covariance = second * (1.0 / volume) - outer_product(mean, mean);
    let sound = volume > 0.0 && (0..3).all(|i| covariance.col(i)[i] >= 0.0);
    (sound && covariance.is_finite()).then_some((volume, apex + mean, covariance))
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::shapes::{Mesh, block};

    use super::*;

    #[test]
    fn box_moments_match_closed_form() {
        let Mesh { vertices, faces } = block(DVec3::ZERO, DVec3::new(2.0, 4.0, 6.0));
        let topology =
            Topology::from_sphere_faces(8, (0..=6).map(|f| 4 * f).collect(), faces.concat())
                .unwrap();
        let m = Inertia::new(&vertices, &topology, 3);
        assert!((m.volume - 48.0).abs() < 1e-12);
        assert!((m.center - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
        assert!(m.inner_radius < 1.0 && m.inner_radius > 0.9999);
        let expected = DVec3::new(1.0, 4.0, 9.0) / 3.0 * 5.0;
        for i in 0..3 {
            let s = m.factor * m.factor.transpose();
            assert!((s.col(i)[i] / expected[i] - 1.0).abs() < 1e-9);
            assert!((s.col(i)[(i + 1) % 3]).abs() < 1e-9);
        }
    }
}
