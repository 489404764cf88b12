//! Supporting planes of `M`, and their proof.
//!
//! A plane through known vertices of `M` needs no search for a support point. The neighbourhood of one
//! of the vertices decides whether it is a support point, and bounds how far the bodies reach beyond
//! the plane ([`support_with_excess`](crate::body::ConvexPolyhedron::support_with_excess)). A certificate needs this
//! bound in any case.

use glam::DVec3;

use crate::body::LargeFace;
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};

/// Maximum excess of the bodies beyond the plane of two large faces, in noises. If the faces are less flat, this plane
/// is not used, because planes through other support points prove a tighter bound.
const MAX_EXCESS: f64 = 4.0;

/// A supporting plane of `M`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    /// Unit normal in the world.
    pub(crate) normal: DVec3,
    /// The unit normal in the frames of the moving and of the fixed body.
    pub(crate) normals: [DVec3; 2],
    /// Vertex pair that is lowest along the normal.
    pub(crate) lowest: VertexPair,
    /// Bound on the distance by which `M`, computed from the bodies or from the points that they were built from,
    /// reaches below this pair along the normal.
    pub(crate) excess: f64,
}

/// The lowest face of `M` on the line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    /// Its supporting plane.
    pub(crate) plane: Plane,
    /// Barycentric weights of the line in the portal.
    pub(crate) weights: [f64; 3],
}

impl Plane {
    /// Builds the plane perpendicular to `normal` (shadow frame, any length) at the support pair, given the
    /// pair that a search has found.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub(crate) fn at_support(
        difference: &MinkowskiDifference,
        normal: DVec3,
        found: VertexPair,
    ) -> Self {
        let setting = difference.setting;
        let normal = (difference.setting_from_shadow * normal).normalize();
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let (lowest, excess) = setting.support_with_excess(&normals, found);
        Self { normal, normals, lowest, excess }
    }

    /// Builds the plane perpendicular to `normal` (shadow frame, any length) if the pair `near`, or for
    /// small bodies a scan of all vertices, shows that it supports `M`.
    ///
    /// The plane may be exceeded by half a noise on each body. `None` if more is found, or too many
    /// vertices would have to be examined.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub(crate) fn if_supported_at(
        difference: &MinkowskiDifference,
        normal: DVec3,
        near: VertexPair,
    ) -> Option<Self> {
        let setting = difference.setting;
        let normal = difference.setting_from_shadow * normal;
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let length = normal.length();
        let most = 0.5 * difference.noise.point_error();
        let (moving, p) = setting.moving.support_within(normals[0], length, near.moving.0, most)?;
        let (fixed, q) = setting.fixed.support_within(-normals[1], length, near.fixed.0, most)?;
        let to_unit = 1.0 / length;
        Some(Self {
            normal: normal * to_unit,
            normals: normals.map(|n| n * to_unit),
            lowest: VertexPair::from_indices(moving, fixed),
            excess: p + q + setting.input_excess(),
        })
    }

    /// Builds the plane through the first corners of two large faces, perpendicular to `normal` (shadow
    /// frame, any length).
    ///
    /// `None` unless it supports both bodies in these faces with an excess of at most `MAX_EXCESS` noises.
    #[inline]
    pub(super) fn from_large_faces(
        difference: &MinkowskiDifference,
        normal: DVec3,
        f: &LargeFace,
        g: &LargeFace,
    ) -> Option<Self> {
        let setting = difference.setting;
        let normal = (difference.setting_from_shadow * normal).normalize();
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let lowest = VertexPair::from_indices(f.corners[0], g.corners[0]);
        let noise = difference.noise.point_error();
        let most = 0.5 * noise;
        let excess = setting.moving.large_face_excess(f, normals[0], 1.0, lowest.moving.0, most)?
            + setting.fixed.large_face_excess(g, -normals[1], 1.0, lowest.fixed.0, most)?;
        (excess <= MAX_EXCESS * noise).then(|| {
            let excess = excess + setting.input_excess();
            Self { normal, normals, lowest, excess }
        })
    }

    /// Returns the support point along `normal`, given the point at which a hill climb stopped. Between
    /// edges as short as rounding errors a climb may stop far from the support point.
    pub(super) fn verified_support_point(
        difference: &MinkowskiDifference,
        normal: DVec3,
        climbed: ShadowPoint,
    ) -> ShadowPoint {
        let lowest = Self::at_support(difference, normal, climbed.pair).lowest;
        if lowest == climbed.pair { climbed } else { difference.widened_point(lowest, normal) }
    }
}
