//! Minkowski portal refinement: Snethen, "`XenoCollide`: complex collision made simple", Game Programming Gems 7, 2008,
//! after the author's program.
//!
//! - `M = {q - p}` is the Minkowski difference in the fixed body's frame. The bodies overlap if it contains the origin.
//! - The ray leads from `v_0`, the difference of both centres, to the origin.
//! - *Discovery* finds a portal: three points of `M` around the ray. It ends early at a plane that separates the bodies.
//! - *Refinement* replaces a corner of the portal by the support point along the portal's normal. It ends if the
//!   origin is beyond the plane through this point, or if the plane is within the tolerance of the portal.
//!
//! The answer is yes if some portal lies beyond the origin. A depth less than the tolerance may be reported as no
//! overlap. The program's loops have no limit; here [`MAX_STEPS`] is one.

use colltrans::{ConvexPolyhedron, Pose};
use glam::DVec3;

use crate::egjk::Difference;
use crate::placed::Relative;
use crate::wedge::{Wedge, centre};

/// Maximum number of portals in each phase.
pub const MAX_STEPS: u32 = 1000;

/// Work of a query.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Steps {
    /// Number of portals and of candidates for the first one.
    pub portals: u32,
    /// Number of vertices whose neighbours were examined while climbing to support points.
    pub climbed: u32,
}

/// Answer to an overlap query.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Overlap {
    /// Whether the bodies overlap; `None` if the maximum number of steps was reached.
    pub overlaps: Option<bool>,
    /// Work of the query.
    pub steps: Steps,
}

/// Solver for overlap queries between two solids. Climbing starts at the last support points.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{ConvexPolyhedron, Pose};
/// use colltrans_baselines::mpr::Mpr;
///
/// let octahedron = ConvexPolyhedron::from_points(&DVec3::AXES.map(|e| [e, -e]).concat())?;
/// let mut mpr = Mpr::new(&octahedron, &octahedron);
/// for (x, expected) in [(1.9, true), (2.1, false)] {
///     let pose = Pose::from_translation(DVec3::X * x)?;
///     assert_eq!(mpr.overlap(&pose, &Pose::IDENTITY).overlaps, Some(expected));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Mpr<'a> {
    difference: Difference<'a>,
    centres: [DVec3; 2],
    tolerance: f64,
}

impl<'a> Mpr<'a> {
    /// Default tolerance, in units of the size.
    pub const TOLERANCE: f64 = 1e-6;

    /// Creates a solver for two solids, in `O(n)` time.
    pub fn new(moving: &'a ConvexPolyhedron, fixed: &'a ConvexPolyhedron) -> Self {
        let centres = [moving, fixed].map(centre);
        Self { difference: Difference::new(moving, fixed), centres, tolerance: Self::TOLERANCE }
    }

    /// Returns the solver with another tolerance, in units of the size.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Discards the last support points.
    pub fn reset(&mut self) {
        self.difference.reset();
    }

    /// Checks whether the placed bodies overlap.
    pub fn overlap(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> Overlap {
        let relative = Relative::new(moving_pose, fixed_pose);
        let inside = self.centres[1] - relative.point(self.centres[0]);
        let mut search = Search {
            tolerance: self.tolerance * self.difference.size(&relative),
            difference: &mut self.difference,
            relative,
            inside,
            steps: Steps::default(),
        };
        let overlaps = search.discover().and_then(|found| match found {
            Discovery::Portal(portal) => search.refine(portal),
            Discovery::Done(overlaps) => Some(overlaps),
        });
        Overlap { overlaps, steps: search.steps }
    }
}

/// Result of the first phase.
enum Discovery {
    Portal(Wedge),
    Done(bool),
}

/// A query in progress.
struct Search<'s, 'a> {
    difference: &'s mut Difference<'a>,
    relative: Relative,
    /// `v_0`.
    inside: DVec3,
    tolerance: f64,
    steps: Steps,
}

impl Search<'_, '_> {
    /// Returns the support point along a normal, relative to `v_0`, and whether the origin is beyond its plane.
    fn support(&mut self, normal: DVec3) -> (DVec3, bool) {
        let point =
            self.difference.lowest_point(&self.relative, -normal, &mut self.steps.climbed).point;
        (point - self.inside, point.dot(normal) <= 0.0)
    }

    /// Finds a portal. Returns `None` at the limit of steps.
    fn discover(&mut self) -> Option<Discovery> {
        let ray = -self.inside;
        if ray == DVec3::ZERO {
            return Some(Discovery::Done(true));
        }
        let (mut a, is_beyond) = self.support(ray);
        if is_beyond {
            return Some(Discovery::Done(false));
        }
        let across = ray.cross(a);
        if across == DVec3::ZERO {
            // The support point is on the ray, beyond the origin.
            return Some(Discovery::Done(true));
        }
        let (mut b, is_beyond) = self.support(across);
        if is_beyond {
            return Some(Discovery::Done(false));
        }
        if a.cross(b).dot(ray) < 0.0 {
            (a, b) = (b, a);
        }
        for _ in 0..MAX_STEPS {
            self.steps.portals += 1;
            let (c, is_beyond) = self.support(a.cross(b));
            if is_beyond {
                return Some(Discovery::Done(false));
            }
            if a.cross(c).dot(ray) > 0.0 {
                b = c;
            } else if c.cross(b).dot(ray) > 0.0 {
                a = c;
            } else {
                return Some(Discovery::Portal(Wedge { ray, corners: [a, b, c] }));
            }
        }
        None
    }

    /// Refines a portal. Returns `None` at the limit of steps.
    fn refine(&mut self, mut portal: Wedge) -> Option<bool> {
        let mut is_hit = false;
        for _ in 0..MAX_STEPS {
            self.steps.portals += 1;
            let Some(normal) = portal.normal().try_normalize() else { return Some(is_hit) };
            let height = normal.dot(portal.corners[0]);
            is_hit |= height >= normal.dot(portal.ray);
            let (point, is_beyond) = self.support(normal);
            if is_beyond || normal.dot(point) - height <= self.tolerance {
                return Some(is_hit);
            }
            portal.replace_corner(point);
        }
        None
    }
}
