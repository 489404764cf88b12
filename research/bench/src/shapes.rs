//! Bodies to measure with: ellipsoids, hulls of random points, boxes, needles, plates and others.

use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{self, Mesh};
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
    /// Boxes with random sides (8 vertices whatever is asked for).
    Box,
    /// `|x|^4 + |y|^4 + |z|^4 = 1`, with random semi-axes.
    Superellipsoid,
    /// Half an ellipsoid, with a flat base.
    HalfEllipsoid,
    /// A prism of half as many sides.
    Prism,
}

impl Shape {
    /// The name in tables.
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
        }
    }

    /// One body with about `n` vertices.
    ///
    /// # Errors
    /// As the constructors of [`ConvexPolyhedron`].
    pub fn draw(self, n: usize, random: &mut Random) -> Result<ConvexPolyhedron, BuildError> {
        let semi_axes = DVec3::from_array([0; 3].map(|_| random.range(0.6, 1.4)));
        let [around, rings] = shapes::even_rings(n);
        let scaled = |mesh: Mesh, by: DVec3| mesh.mapped(|v| v * by);
        body(&match self {
            Self::Ellipsoid => scaled(shapes::ring_sphere(around, rings), semi_axes),
            Self::RandomHull => shapes::random_hull(n, random),
            // Of the same length whatever the ratio; the rings run around the long axis or across
            // the plate.
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
        })
    }
}

/// A mesh as a body; the corners of a polygon are rounded, so it is flat to within a few units in
/// the last place.
///
/// # Errors
/// As the constructors of [`ConvexPolyhedron`].
pub fn body(mesh: &Mesh) -> Result<ConvexPolyhedron, BuildError> {
    if mesh.faces.is_empty() {
        ConvexPolyhedron::from_points(&mesh.vertices)
    } else {
        ConvexPolyhedron::from_mesh(&mesh.vertices, &mesh.faces, 64.0 * f64::EPSILON)
    }
}
