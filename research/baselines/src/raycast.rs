//! GJK ray cast: van den Bergen, "Ray casting against general convex objects with application to continuous collision
//! detection", 2004. Physics engines use this linear cast. [`RayCast`] lists known failures of the published
//! algorithm.
//!
//! - `M = {q - p}` is the Minkowski difference in the fixed body's frame, `d` the direction. `S` is the size, as in
//!   [`egjk`](crate::egjk).
//! - `x = t d` is the tip of the ray from the origin. The moved bodies touch when `x` enters `M`.
//! - `v` is the shortest vector from `x` to the simplex (the paper uses `-v`); `w` is the lowest point of `M` along
//!   `v`.
//!
//! Invariant: `t` is a lower bound of the collision translation. It is raised only to planes below `M`, through `w`
//! with normal `v`, that `x` has not crossed. A *hit* is declared if `|v|` is at most the tolerance `e`. Then `t` is
//! too small by at most `e / n . d` with the unknown contact normal `n`. A ray that misses `M` ends at a plane from
//! which it moves away, or at `t |d| > S`, beyond which no point of `M` is (an addition).

use colltrans::{ConvexPolyhedron, Pose};
use glam::DVec3;

use crate::egjk::{Difference, Simplex};
use crate::placed::Relative;

/// Limits of a ray cast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Distance at which the bodies count as touching, in units of the size `S`; at least the rounding error
    /// `32 u`. The default is `1e-6`.
    pub tolerance: f64,
    /// Maximum number of iterations. The default is 64, the limit of Bullet in double precision.
    pub max_iterations: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self { tolerance: 1e-6, max_iterations: 64 }
    }
}

/// Work of a cast.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Steps {
    /// Number of simplices whose nearest point was computed.
    pub iterations: u32,
    /// Number of advances of the ray's tip.
    pub advances: u32,
    /// Number of vertices whose neighbours were examined while climbing to support points.
    pub climbed: u32,
}

/// Answer of a ray cast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RayCastAnswer {
    /// The bodies are within the tolerance of each other after this translation.
    Hit {
        /// Translation in multiples of the direction, at least 0. Up to rounding it does not exceed the
        /// collision translation, if there is one.
        translation: f64,
        /// Unit normal of the last separating plane, from the moving body to the fixed one, in the world.
        normal: DVec3,
        /// A point of the fixed body, in the world, within the tolerance of the moved body.
        on_fixed: DVec3,
        /// Work of the cast.
        steps: Steps,
    },
    /// The bodies are within the tolerance of each other at the start, or overlap. The published algorithm
    /// reports a hit at 0 without a normal.
    InContact {
        /// A point of the fixed body, in the world, within the tolerance of the moving body.
        on_fixed: DVec3,
        /// Work of the cast.
        steps: Steps,
    },
    /// The bodies do not meet ahead.
    Miss {
        /// Work of the cast.
        steps: Steps,
    },
    /// The maximum number of iterations was reached.
    Exhausted {
        /// Lower bound of the collision translation, in multiples of the direction, up to rounding.
        lower_bound: f64,
        /// Work of the cast.
        steps: Steps,
    },
}

/// Solver for ray casts between two bodies. Climbing starts at the last support points.
///
/// Known failures of the published algorithm:
/// - *Grazing rays*: a ray that passes `M` at less than `e` is a hit or a miss. A ray at a small angle to the
///   surface hits early by a multiple of `e`.
/// - *Start within `e` of `M`*: this is a contact, even if the motion leads away.
/// - *Normal*: it belongs to the last plane that raised `t`, not to the face in contact. Its error is up to
///   `1.5e-3` rad in tests between bodies of 2,000 vertices.
/// - *Rounding*: the number of iterations has no proven bound, so [`RayCastAnswer::Exhausted`] exists. 64
///   iterations suffice in all tests. For `e` near `1e-12 S`, rounding may make a hit earlier than stated.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{ConvexPolyhedron, Pose};
/// use colltrans_baselines::raycast::{RayCast, RayCastAnswer};
///
/// let octahedron = ConvexPolyhedron::from_points(&DVec3::AXES.map(|e| [e, -e]).concat())?;
/// let start = Pose::from_translation(DVec3::new(-5.0, 0.25, 0.5))?;
/// let mut ray_cast = RayCast::new(&octahedron, &octahedron);
/// let answer = ray_cast.cast(&start, &Pose::IDENTITY, DVec3::X);
/// let RayCastAnswer::Hit { translation, .. } = answer else { unreachable!("it is in the way") };
/// assert!((translation - 3.75).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct RayCast<'a> {
    difference: Difference<'a>,
    options: Options,
}

/// The tip of the ray, with the last separating plane.
#[derive(Debug, Clone, Copy)]
struct Tip {
    translation: f64,
    /// Normal of the plane that it was last moved to, of any length; 0 at the start.
    normal: DVec3,
    steps: Steps,
}

impl<'a> RayCast<'a> {
    /// Creates a solver with default options that starts at the first vertices, in `O(n)` time.
    pub fn new(moving: &'a ConvexPolyhedron, fixed: &'a ConvexPolyhedron) -> Self {
        Self::with_options(moving, fixed, Options::default())
    }

    /// Creates a solver with options that starts at the first vertices, in `O(n)` time.
    pub fn with_options(
        moving: &'a ConvexPolyhedron,
        fixed: &'a ConvexPolyhedron,
        options: Options,
    ) -> Self {
        Self { difference: Difference::new(moving, fixed), options }
    }

    /// Discards the last support points.
    pub fn reset(&mut self) {
        self.difference.reset();
    }

    /// Computes the translation of the moving body along `direction` (in the world, of any length but 0)
    /// until it touches the fixed body.
    pub fn cast(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        direction: DVec3,
    ) -> RayCastAnswer {
        let relative = Relative::new(moving_pose, fixed_pose);
        let ray = fixed_pose.matrix().transpose() * direction;
        let size = self.difference.size(&relative);
        let tolerance = self.options.tolerance.max(Difference::NOISE) * size;
        let mut simplex = Simplex::new(self.difference.last_support(&relative));
        let mut tip = Tip { translation: 0.0, normal: DVec3::ZERO, steps: Steps::default() };
        while tip.steps.iterations < self.options.max_iterations {
            tip.steps.iterations += 1;
            let towards = simplex.reduce(ray * tip.translation);
            if towards.length() <= tolerance {
                let [_, on_fixed] = self.difference.nearest_points(&simplex);
                return tip.contact_answer(fixed_pose, fixed_pose.transform_point(on_fixed));
            }
            let lowest = self.difference.lowest_point(&relative, towards, &mut tip.steps.climbed);
            if !tip.advance_to_plane(ray, towards, lowest.point)
                || tip.translation * ray.length() > size
            {
                return RayCastAnswer::Miss { steps: tip.steps };
            }
            if !simplex.contains(lowest.pair) {
                simplex.push(lowest);
            }
        }
        RayCastAnswer::Exhausted { lower_bound: tip.translation, steps: tip.steps }
    }
}

impl Tip {
    /// Advances to the plane through `lowest` with normal `towards` if the plane is ahead. Returns `false` if
    /// it is ahead and the ray never reaches it.
    fn advance_to_plane(&mut self, ray: DVec3, towards: DVec3, lowest: DVec3) -> bool {
        let ahead = towards.dot(lowest - ray * self.translation);
        if ahead > 0.0 {
            let speed = towards.dot(ray);
            if speed <= 0.0 {
                return false;
            }
            self.translation += ahead / speed;
            self.normal = towards;
            self.steps.advances += 1;
        }
        true
    }

    /// Returns the answer for a tip within the tolerance of `M`.
    fn contact_answer(self, fixed_pose: &Pose, on_fixed: DVec3) -> RayCastAnswer {
        let Self { translation, normal, steps } = self;
        if normal == DVec3::ZERO {
            return RayCastAnswer::InContact { on_fixed, steps };
        }
        let normal = fixed_pose.transform_vector(normal.normalize());
        RayCastAnswer::Hit { translation, normal, on_fixed, steps }
    }
}
