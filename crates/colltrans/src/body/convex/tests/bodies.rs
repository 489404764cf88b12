//! Bodies for the tests of sections and of the minimisation, built without a hull.

use colltrans_testkit::shapes::{self, Mesh};
use glam::DVec3;

use crate::body::ConvexPolyhedron;

/// About `count` vertices (at least 8) on an ellipsoid: two poles and rings between them.
pub(crate) fn ellipsoid(count: usize, semi_axes: DVec3) -> ConvexPolyhedron {
    let around = ((2.0 * count as f64).sqrt().round() as usize).clamp(3, count - 2);
    ellipsoid_around(count, around, semi_axes)
}

/// The same with faces a hundred times as long as wide.
pub(crate) fn thin_ellipsoid(count: usize, semi_axes: DVec3) -> ConvexPolyhedron {
    ellipsoid_around(count, ((0.0127 * count as f64).sqrt().round() as usize).max(8), semi_axes)
}

fn ellipsoid_around(count: usize, around: usize, semi_axes: DVec3) -> ConvexPolyhedron {
    let rings = ((count - 2) / around).max(1);
    built(shapes::ring_sphere(around as u32, rings as u32), semi_axes)
}

fn built(mesh: Mesh, scale: DVec3) -> ConvexPolyhedron {
    let Mesh { vertices, faces } = mesh.mapped(|v| v * scale);
    ConvexPolyhedron::from_convex_faces(&vertices, &faces)
}

/// A right prism over a regular polygon, along z.
pub(crate) fn prism(around: usize, scale: DVec3) -> ConvexPolyhedron {
    built(shapes::prism(around, 1.0), scale)
}

/// A cone over a regular polygon: apex at z = 1, base at z = -1.
pub(crate) fn cone(around: usize, scale: DVec3) -> ConvexPolyhedron {
    built(shapes::cone(around, [-1.0, 1.0]), scale)
}

/// A box with the given half extents around `centre`.
pub(crate) fn cuboid(centre: DVec3, half: DVec3) -> ConvexPolyhedron {
    built(shapes::block(centre - half, centre + half), DVec3::ONE)
}
