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
    /// A round cylinder, as parts of machines are: a prism over a regular polygon.
    Cylinder,
    /// A cylinder whose rims are cut off by a hundredth of its radius.
    Chamfered,
    /// A round cone: its apex has all others for neighbours.
    Cone,
    /// A cone without its tip.
    Frustum,
    /// Two cones on one base.
    Bicone,
}

/// What is cut off the rims of a chamfered cylinder of radius 1.
const CHAMFER: f64 = 0.01;

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
            Self::Cylinder => "cylinder".into(),
            Self::Chamfered => "chamfered".into(),
            Self::Cone => "cone".into(),
            Self::Frustum => "frustum".into(),
            Self::Bicone => "bicone".into(),
        }
    }

    /// Two bodies with about `n` vertices each.
    ///
    /// # Errors
    /// As the constructors of [`ConvexPolyhedron`].
    pub fn pair(self, n: usize, random: &mut Random) -> Result<[ConvexPolyhedron; 2], BuildError> {
        Ok([self.draw(n, random)?, self.draw(n, random)?])
    }

    /// One body with about `n` vertices.
    ///
    /// # Errors
    /// As the constructors of [`ConvexPolyhedron`].
    pub fn draw(self, n: usize, random: &mut Random) -> Result<ConvexPolyhedron, BuildError> {
        let semi_axes = DVec3::from_array([0; 3].map(|_| random.range(0.6, 1.4)));
        let [around, rings] = shapes::even_rings(n);
        let scaled = |mesh: Mesh, by: DVec3| mesh.mapped(|v| v * by);
        let round = DVec3::new(semi_axes.x, semi_axes.x, semi_axes.z);
        // About as many vertices on so many rings of these radii and heights.
        let turned = |rings: &[[f64; 2]], apexes: &[f64]| {
            scaled(shapes::revolved(rings, apexes, (n / rings.len()).max(3)), round)
        };
        let inner = 1.0 - CHAMFER;
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
