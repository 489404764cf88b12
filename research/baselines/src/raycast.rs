//! GJK ray cast: van den Bergen, "Ray casting against general convex objects with application to
//! continuous collision detection", 2004. The linear cast that physics engines ship.
//!
//! Notation. In the fixed body's frame, `M = {q - p}` is the Minkowski difference, `d` the
//! direction, and `x = t d` the tip of the ray, which starts at the origin: the moving body, moved
//! by `t d`, touches the fixed one when `x` enters `M`. `v` is the shortest vector from `x` to the
//! simplex (the paper has `-v`), `w` the lowest point of `M` along `v`, and `S` the size: the reach
//! of both bodies plus the distance of their frames.
//!
//! Invariant. `t` is a lower bound of the collision translation: it is raised only as far as a
//! plane below all of `M`, through `w` with normal `v`, which `x` has not yet crossed. A *hit* is
//! declared when `|v|` is no larger than the tolerance `e`. As `x` is then within `e` of `M`, which
//! lies beyond its contact plane, `t` lacks at most `e / n . d`; but the contact normal `n` is not
//! known. A ray that misses `M` ends with a plane that it moves away from.
//!
//! Where that fails, as published:
//!
//! - *Rays that graze.* A ray that passes `M` by less than `e` is a hit, or a miss. One that comes
//!   in at a small angle hits early by a multiple of `e`.
//! - *A start within `e` of `M`* is a contact even if the motion leads away.
//! - *The normal* is that of the last plane that raised `t`, not of the face that is hit: off by
//!   up to `1.5e-3` rad in the tests between bodies of 2,000 vertices.
//! - *Rounding.* No proof bounds the iterations, so running out of them is an answer of its own;
//!   64 have been enough in all tests. With `e` near `1e-12 S`, rounding may hit early by more than
//!   that.
//!
//! One thing is added: as all of `M` is within `S` of the origin, `t |d| > S` is a miss, proven.

use colltrans::{ConvexPolyhedron, Pose};
use glam::DVec3;

use crate::egjk::{Difference, Simplex};
use crate::placed::Relative;

/// When a ray cast stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The distance at which the bodies count as touching, in units of the size `S`; no less than
    /// the rounding error, `32 u`. The default is `1e-6`.
    pub tolerance: f64,
    /// Iterations after which the cast gives up. The default is 64, which is what Bullet allows in
    /// double precision.
    pub max_iterations: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self { tolerance: 1e-6, max_iterations: 64 }
    }
}

/// Work done by one cast.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Steps {
    /// Simplices whose nearest point was computed.
    pub iterations: u32,
    /// How often the ray's tip was moved on.
    pub advances: u32,
    /// Vertices whose neighbours were looked at while climbing to support points.
    pub climbed: u32,
}

/// What a ray cast answers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RayCastAnswer {
    /// After this translation the bodies are within the tolerance of each other.
    Hit {
        /// In multiples of the direction, from 0. Up to rounding it is not beyond the collision
        /// translation, if there is one.
        translation: f64,
        /// Unit normal of the last plane that kept the bodies apart, from the moving body to the
        /// fixed one, in the world.
        normal: DVec3,
        /// A point of the fixed body, in the world, within the tolerance of the moving one then.
        on_fixed: DVec3,
        /// Work done.
        steps: Steps,
    },
    /// The bodies are within the tolerance of each other where they are, or overlap. (The published
    /// algorithm calls that a hit at 0 without a normal.)
    InContact {
        /// A point of the fixed body, in the world, within the tolerance of the moving one.
        on_fixed: DVec3,
        /// Work done.
        steps: Steps,
    },
    /// They do not meet ahead.
    Miss {
        /// Work done.
        steps: Steps,
    },
    /// The iterations ran out.
    Exhausted {
        /// They do not meet before this, in multiples of the direction, up to rounding.
        lower_bound: f64,
        /// Work done.
        steps: Steps,
    },
}

/// Ray casts between two bodies. Climbing starts where the last cast's ended.
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

/// The tip of the ray and what was last known about it.
#[derive(Debug, Clone, Copy)]
struct Tip {
    translation: f64,
    /// Normal of the plane that it was last moved to, of any length; 0 at the start.
    normal: DVec3,
    steps: Steps,
}

impl<'a> RayCast<'a> {
    /// Two bodies, with default options and seeds at their first vertices. Takes `O(n)`.
    pub fn new(moving: &'a ConvexPolyhedron, fixed: &'a ConvexPolyhedron) -> Self {
        Self::with_options(moving, fixed, Options::default())
    }

    /// Two bodies, with these options.
    pub fn with_options(
        moving: &'a ConvexPolyhedron,
        fixed: &'a ConvexPolyhedron,
        options: Options,
    ) -> Self {
        Self { difference: Difference::new(moving, fixed), options }
    }

    /// Forgets where the last support points were found.
    pub fn reset(&mut self) {
        self.difference.reset();
    }

    /// How far the moving body can move along `direction` (world, any length but 0) from where it
    /// is until it touches the fixed one.
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
        let mut simplex = Simplex::new(self.difference.last(&relative));
        let mut tip = Tip { translation: 0.0, normal: DVec3::ZERO, steps: Steps::default() };
        while tip.steps.iterations < self.options.max_iterations {
            tip.steps.iterations += 1;
            let towards = simplex.reduce(ray * tip.translation);
            if towards.length() <= tolerance {
                let [_, on_fixed] = self.difference.nearest_points(&simplex);
                return tip.arrived(fixed_pose, fixed_pose.transform_point(on_fixed));
            }
            let lowest = self.difference.lowest(&relative, towards, &mut tip.steps.climbed);
            if !tip.advance(ray, towards, lowest.point) || tip.translation * ray.length() > size {
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
    /// Moves on to the plane through `lowest` with normal `towards`, if that is ahead; `false` if
    /// it is, and the ray never gets there.
    fn advance(&mut self, ray: DVec3, towards: DVec3, lowest: DVec3) -> bool {
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

    fn arrived(self, fixed_pose: &Pose, on_fixed: DVec3) -> RayCastAnswer {
        let Self { translation, normal, steps } = self;
        if normal == DVec3::ZERO {
            return RayCastAnswer::InContact { on_fixed, steps };
        }
        let normal = fixed_pose.transform_vector(normal.normalize());
        RayCastAnswer::Hit { translation, normal, on_fixed, steps }
    }
}
