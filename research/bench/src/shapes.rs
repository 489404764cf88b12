//! Draws bodies for measurements: ellipsoids, hulls of random points, boxes, needles, plates and others.

use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{self, Mesh};
use glam::DVec3;

/// A kind of body, with any number of vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Vertices on an ellipsoid with random semi-axes from 0.6 to 1.4, in rings. Nearly all faces are
    /// trapezoids.
    Ellipsoid,
    /// Random points on a sphere; all faces are triangles.
    RandomHull,
    /// An affine image of a ring ellipsoid. Its length is the given multiple of its thickness.
    Needle(f64),
    /// An affine image of a ring ellipsoid. Its width is the given multiple of its thickness.
    Plate(f64),
    /// Boxes with random sides, always with 8 vertices.
    Box,
    /// `|x|^4 + |y|^4 + |z|^4 = 1`, with random semi-axes.
    Superellipsoid,
    /// Half an ellipsoid, with a flat base.
    HalfEllipsoid,
    /// A prism with half as many sides as vertices.
    Prism,
    /// A round cylinder, as in machine parts: a prism over a regular polygon.
    Cylinder,
    /// A cylinder with rims chamfered by 1/100 of its radius.
    Chamfered,
    /// A round cone; its apex is adjacent to all other vertices.
    Cone,
    /// A cone without its tip.
    Frustum,
    /// Two cones on one base.
    Bicone,
}

/// Chamfer of the rims of a cylinder with radius 1.
const CHAMFER: f64 = 0.01;

impl Shape {
    /// Returns the name in tables.
    pub fn name(self) -> String {
        match self {
            Self::Ellipsoid => "ellipsoid".into(),
            Self::RandomHull => "random hull".into(),
            Self::Needle(ratio) => format!("needle {ratio}:1"),
            Self::Plate(ratio) => format!("plate {ratio}:1"),
            Self::Box => "box".into(),
            Self::Superellipsoid => "superellipsoid".into(),
            Self::HalfEllipsoid => "half ellipsoid".into(),
            Self::Prism => "prism".into(),
            Self::Cylinder => "cylinder".into(),
            Self::Chamfered => "chamfered".into(),
            Self::Cone => "cone".into(),
            Self::Frustum => "frustum".into(),
            Self::Bicone => "bicone".into(),
        }
    }

    /// Draws two bodies with about `n` vertices each.
    ///
    /// # Errors
    /// The errors of the constructors of [`ConvexPolyhedron`].
    pub fn pair(self, n: usize, random: &mut Random) -> Result<[ConvexPolyhedron; 2], BuildError> {
        Ok([self.draw(n, random)?, self.draw(n, random)?])
    }

    /// Draws a body with about `n` vertices.
    ///
    /// # Errors
    /// The errors of the constructors of [`ConvexPolyhedron`].
    pub fn draw(self, n: usize, random: &mut Random) -> Result<ConvexPolyhedron, BuildError> {
        let semi_axes = DVec3::from_array([0; 3].map(|_| random.range(0.6, 1.4)));
        let [around, rings] = shapes::even_rings(n);
        let scaled = |mesh: Mesh, by: DVec3| mesh.mapped(|v| v * by);
        let round = DVec3::new(semi_axes.x, semi_axes.x, semi_axes.z);
        // About `n` vertices, on rings with these radii and heights.
        let turned = |rings: &[[f64; 2]], apexes: &[f64]| {
            scaled(shapes::revolved(rings, apexes, (n / rings.len()).max(3)), round)
        };
        let inner = 1.0 - CHAMFER;
        body_from_mesh(&match self {
            Self::Ellipsoid => scaled(shapes::ring_sphere(around, rings), semi_axes),
            Self::RandomHull => shapes::random_hull(n, random),
            // The length does not depend on the ratio. The rings run around the long axis or across the plate.
            Self::Needle(ratio) => {
                let thin = semi_axes * DVec3::new(1.0 / ratio, 1.0 / ratio, 1.0);
                scaled(shapes::ring_sphere(around, rings), thin)
            }
            Self::Plate(ratio) => {
                let thin = semi_axes * DVec3::new(1.0, 1.0 / ratio, 1.0);
                scaled(shapes::ring_sphere(around, rings), thin)
            }
            Self::Box => shapes::cuboid(semi_axes),
            Self::Superellipsoid => scaled(shapes::superellipsoid(n, 4.0), semi_axes),
            Self::HalfEllipsoid => scaled(shapes::half_sphere(n), semi_axes),
            Self::Prism => scaled(shapes::prism((n / 2).max(3), 1.0), semi_axes),
            Self::Cylinder => scaled(shapes::prism((n / 2).max(3), 1.0), round),
            Self::Chamfered => {
                turned(&[[inner, -1.0], [1.0, -inner], [1.0, inner], [inner, 1.0]], &[])
            }
            Self::Cone => turned(&[[1.0, -0.5]], &[1.0]),
            Self::Frustum => turned(&[[1.0, -1.0], [0.6, 1.0]], &[]),
            Self::Bicone => turned(&[[1.0, 0.0]], &[-1.0, 1.0]),
        })
    }
}

/// Builds a body from a mesh. The corners of a polygon are rounded, so it is flat to within a few units in the
/// last place.
///
/// # Errors
/// The errors of the constructors of [`ConvexPolyhedron`].
pub fn body_from_mesh(mesh: &Mesh) -> Result<ConvexPolyhedron, BuildError> {
    if mesh.faces.is_empty() {
        ConvexPolyhedron::from_points(&mesh.vertices)
    } else {
        ConvexPolyhedron::from_mesh(&mesh.vertices, &mesh.faces, 64.0 * f64::EPSILON)
    }
}
