//! Growth distance by cutting planes: Thirugnanam, Sreenath, "A ray intersection algorithm for fast growth distance
//! computation between convex sets", arXiv 2604.10058, after the authors' program.
//!
//! - The *growth distance* is the least factor by which both bodies, scaled about their centres, touch.
//! - `M = {q - p}` is the Minkowski difference in the fixed body's frame, `v_0` the difference of both centres. If the
//!   ray from `v_0` to the origin leaves `M` at the share `s` of its length, the growth distance is `1 / s`.
//! - Three points of `M` surround the ray. The first three are on the balls inside the bodies. The plane of the three
//!   points gives a lower bound of `s`, the parallel supporting plane an upper one. The support point replaces one of
//!   the three.
//!
//! The search ends at a relative gap between the bounds, by default the square root of the machine epsilon.

use colltrans::{ConvexPolyhedron, Pose};
use glam::DVec3;

use crate::egjk::Difference;
use crate::placed::Relative;
use crate::wedge::{Wedge, centre};

/// Maximum number of steps, as in the authors' program.
pub const MAX_STEPS: u32 = 100;

/// Work of a query.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Steps {
    /// Number of supporting planes.
    pub planes: u32,
    /// Number of vertices whose neighbours were examined while climbing to support points.
    pub climbed: u32,
}

/// Bounds of the growth distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Growth {
    /// Lower bound, up to rounding; 0 if the centres coincide.
    pub lower: f64,
    /// Upper bound, up to rounding; 0 if the centres coincide.
    pub upper: f64,
    /// Whether the gap between the bounds is at most the tolerance.
    pub is_converged: bool,
    /// Work of the query.
    pub steps: Steps,
}

/// Solver for growth distances of two solids about the means of their vertices. Climbing starts at the last support
/// points.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{ConvexPolyhedron, Pose};
/// use colltrans_baselines::growth::GrowthDistance;
///
/// let octahedron = ConvexPolyhedron::from_points(&DVec3::AXES.map(|e| [e, -e]).concat())?;
/// let pose = Pose::from_translation(DVec3::X * 3.0)?;
/// let growth = GrowthDistance::new(&octahedron, &octahedron).distance(&pose, &Pose::IDENTITY);
/// assert!((growth.lower - 1.5).abs() < 1e-7 && (growth.upper - 1.5).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct GrowthDistance<'a> {
    difference: Difference<'a>,
    centres: [DVec3; 2],
    /// Sum of the radii of the balls about the centres.
    inradius: f64,
    tolerance: f64,
}

impl<'a> GrowthDistance<'a> {
    /// Creates a solver for two solids, in `O(n)` time.
    pub fn new(moving: &'a ConvexPolyhedron, fixed: &'a ConvexPolyhedron) -> Self {
        let bodies = [moving, fixed];
        let centres = bodies.map(centre);
        let inradius = [0, 1].map(|k| inradius(bodies[k], centres[k])).iter().sum();
        let tolerance = f64::EPSILON.sqrt();
        Self { difference: Difference::new(moving, fixed), centres, inradius, tolerance }
    }

    /// Discards the last support points.
    pub fn reset(&mut self) {
        self.difference.reset();
    }

    /// Computes bounds of the growth distance of the placed bodies.
    pub fn distance(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> Growth {
        let relative = Relative::new(moving_pose, fixed_pose);
        let inside = self.centres[1] - relative.point(self.centres[0]);
        let mut steps = Steps::default();
        let Some(along) = (-inside).try_normalize() else {
            return Growth { lower: 0.0, upper: 0.0, is_converged: true, steps };
        };
        let (x, y) = along.any_orthonormal_pair();
        let corners = [DVec3::new(1.0, 0.0, 0.0), DVec3::new(-0.5, 0.75_f64.sqrt(), 0.0)];
        let corners = [corners[0], corners[1], -corners[0] - corners[1]]
            .map(|c| (x * c.x + y * c.y) * self.inradius);
        let mut wedge = Wedge { ray: -inside, corners };
        if wedge.normal().dot(along) < 0.0 {
            wedge.corners.swap(1, 2);
        }
        let [mut inner, mut outer] = [0.0_f64, f64::INFINITY];
        let mut is_converged = false;
        while steps.planes < MAX_STEPS && !is_converged {
            steps.planes += 1;
            let normal = wedge.normal();
            let point =
                self.difference.lowest_point(&relative, -normal, &mut steps.climbed).point - inside;
            inner = inner.max(wedge.share_to_plane(normal, wedge.corners[0]));
            outer = outer.min(wedge.share_to_plane(normal, point));
            is_converged = outer - inner <= self.tolerance * outer;
            wedge.replace_corner(point);
        }
        Growth { lower: outer.recip(), upper: inner.recip(), is_converged, steps }
    }
}

/// Returns the distance of the nearest face's plane from a point inside a body.
fn inradius(body: &ConvexPolyhedron, inside: DVec3) -> f64 {
    let depth = |face: u32| {
        let corner = body.face_vertices(face).next().expect("a face has corners");
        let normal = body.face_normal(face);
        normal.dot(body.vertices()[corner as usize] - inside) / normal.length()
    };
    (0..body.face_count() as u32).map(depth).fold(f64::INFINITY, f64::min)
}
