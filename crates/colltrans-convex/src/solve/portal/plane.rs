//! Supporting planes of `M`, with what proves that they are.
//!
//! Whoever has a plane through vertices of `M` need not search for the support point along its normal:
//! a look around one of them tells whether it is the support point, and how far beyond the plane the
//! bodies may reach ([`settled`](crate::body::ConvexPolyhedron::settled)), which a proof has to know in
//! any case.

use glam::DVec3;

use crate::body::LargeFace;
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};

/// What may lie beyond faces, in noises: of less flat ones other support points prove more.
const MOST_BEYOND: f64 = 4.0;

/// A supporting plane of `M`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    /// Its unit normal, in the world.
    pub(crate) normal: DVec3,
    /// The same in the frames of the moving and of the fixed body.
    pub(crate) normals: [DVec3; 2],
    /// A pair that is lowest along it.
    pub(crate) lowest: VertexPair,
    /// How far the bodies, and the points that they were made from, may reach beyond that.
    pub(crate) beyond: f64,
}

/// The lowest face of `M` on the line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    /// Its plane.
    pub(crate) plane: Plane,
    /// Barycentric weights of the line in the portal.
    pub(crate) weights: [f64; 3],
}

impl Plane {
    /// Across a normal (shadow frame, any length), with a pair that was found to be lowest along it.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub(crate) fn of(difference: &MinkowskiDifference, normal: DVec3, found: VertexPair) -> Self {
        let setting = difference.setting;
        let normal = (difference.setting_from_shadow * normal).normalize();
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let (lowest, beyond) = setting.support_with_excess(&normals, found);
        Self { normal, normals, lowest, beyond }
    }

    /// The same, if a pair is seen to be lowest along it: within half a noise for each of the bodies,
    /// so that the plane supports `M`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub(crate) fn at(
        difference: &MinkowskiDifference,
        normal: DVec3,
        near: VertexPair,
    ) -> Option<Self> {
        let setting = difference.setting;
        let normal = difference.setting_from_shadow * normal;
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let length = normal.length();
        let most = 0.5 * difference.noise.point();
        let (moving, p) = setting.moving.support_at(normals[0], length, near.moving.0, most)?;
        let (fixed, q) = setting.fixed.support_at(-normals[1], length, near.fixed.0, most)?;
        let to_unit = 1.0 / length;
        Some(Self {
            normal: normal * to_unit,
            normals: normals.map(|n| n * to_unit),
            lowest: VertexPair::of(moving, fixed),
            beyond: p + q + setting.input_excess(),
        })
    }

    /// The same, of two large faces, if it supports both bodies there, and hardly anything may lie
    /// beyond.
    #[inline]
    pub(super) fn of_faces(
        difference: &MinkowskiDifference,
        normal: DVec3,
        f: &LargeFace,
        g: &LargeFace,
    ) -> Option<Self> {
        let setting = difference.setting;
        let normal = (difference.setting_from_shadow * normal).normalize();
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let lowest = VertexPair::of(f.corners[0], g.corners[0]);
        let noise = difference.noise.point();
        let most = 0.5 * noise;
        let beyond = setting.moving.excess_of_face(f, normals[0], 1.0, lowest.moving.0, most)?
            + setting.fixed.excess_of_face(g, -normals[1], 1.0, lowest.fixed.0, most)?;
        (beyond <= MOST_BEYOND * noise).then(|| {
            let beyond = beyond + setting.input_excess();
            Self { normal, normals, lowest, beyond }
        })
    }

    /// The point of `M` lowest along a normal, from where a climb has ended: among edges as short as
    /// rounding errors it may have stuck far away.
    pub(super) fn settled(
        difference: &MinkowskiDifference,
        normal: DVec3,
        climbed: Point,
    ) -> Point {
        let lowest = Self::of(difference, normal, climbed.pair).lowest;
        if lowest == climbed.pair { climbed } else { difference.point(lowest, normal) }
    }
}
