//! Enhanced GJK: Cameron, "Enhancing GJK: computing minimum and penetration distances between
//! convex polyhedra", ICRA 1997.
//!
//! Notation. In the fixed body's frame, `M = {q - p}` is the Minkowski difference, and `v` the
//! point of the simplex of GJK (Gilbert, Johnson, Keerthi 1988) nearest to the origin; `w` is the
//! lowest point of `M` along `v`, and `S` the size: the reach of both bodies from their frames'
//! origins plus the distance of these.
//!
//! Invariant. `v` belongs to `M`, so `|v|` is an upper bound of the distance; all of `M` lies
//! beyond the plane through `w` with normal `v`, so `v . w / |v|` is a lower one. The *gap* between
//! the best of both bounds the error of the answer, whatever rounding did to `v` itself.
//!
//! The search ends when the gap is a rounding error of a point of `M`, or when rounding stalls it.
//! Measured on more than 200,000 tied, touching, thin and coherent settings: stalled 9 times, on
//! bodies a thousand times as long as thick or more, with gaps up to `2.9e-13 S`.
//!
//! Cameron's enhancement: a support point is found by climbing from vertex to vertex (`climb`),
//! starting where the last one was found, and the simplex is carried over from query to query.
//! The nearest point of the simplex is found by signed volumes (`simplex`).

mod climb;
mod difference;
mod simplex;

use colltrans::{ConvexPolyhedron, Pose};
use glam::DVec3;

use crate::placed::Relative;
use crate::proximity::Proximity;
pub(crate) use difference::Difference;
pub(crate) use simplex::{Corner, Simplex};

/// Iterations after which a query returns what it has; some tens are usual.
const MAX_ITERATIONS: u32 = 1000;

/// For how many iterations neither bound may become better. Where almost parallel faces or edges
/// meet, `v` first turns by a small angle, which shortens it by the square of that angle: nothing
/// that an `f64` shows, but the next support points need it. So `|v|` must be allowed to stay as it
/// is for a while: as long as it takes to walk over a face.
const PATIENCE: u32 = 30;

/// How a support point of a body is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SupportSearch {
    /// From vertex to vertex along edges, from where the last one was found: Cameron's enhancement.
    #[default]
    Climbing,
    /// Over all vertices, as in GJK before it was enhanced: the time grows linearly.
    Linear,
}

/// Work done by one query, and what it proved.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Steps {
    /// Simplices whose nearest point was computed.
    pub iterations: u32,
    /// Support points of `M`, each made of one of either body.
    pub supports: u32,
    /// Vertices whose neighbours were looked at while climbing; all vertices of both bodies for each
    /// support point if the search is linear.
    pub climbed: u32,
    /// Upper minus lower bound of the distance, in world units: the answer's error is at most this
    /// plus twice the rounding error of a point, `32 u S`.
    ///
    /// Nearly always no larger than one such error, and often 0; larger where the simplex is so
    /// thin that rounding stalls the search.
    pub gap: f64,
}

/// Distance queries between two bodies, coherent from one to the next.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{ConvexPolyhedron, Pose};
/// use colltrans_baselines::egjk::Egjk;
///
/// let octahedron = ConvexPolyhedron::from_points(&DVec3::AXES.map(|e| [e, -e]).concat())?;
/// let mut egjk = Egjk::new(&octahedron, &octahedron);
/// for step in 0..8 {
///     let pose = Pose::from_translation(DVec3::X * (3.0 + f64::from(step)))?;
///     let answer = egjk.distance(&pose, &Pose::IDENTITY);
///     assert_eq!(answer.distance, 1.0 + f64::from(step));
///     assert_eq!(answer.on_fixed, DVec3::X);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Egjk<'a> {
    difference: Difference<'a>,
    /// The simplex of the last answer.
    simplex: Simplex,
}

/// The best bounds so far, the simplex of the upper one, and for how many iterations neither has
/// become better.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    upper: f64,
    lower: f64,
    simplex: Simplex,
    idle: u32,
}

impl Bounds {
    fn gap(&self) -> f64 {
        self.upper - self.lower
    }

    /// Of simplices that are equally near up to rounding the last has the best direction.
    fn take_upper(&mut self, upper: f64, simplex: &Simplex, noise: f64) {
        self.idle = if upper < self.upper { 0 } else { self.idle + 1 };
        if upper <= self.upper + noise {
            self.simplex = *simplex;
        }
        self.upper = self.upper.min(upper);
    }

    fn take_lower(&mut self, lower: f64) {
        if lower > self.lower {
            (self.lower, self.idle) = (lower, 0);
        }
    }
}

impl<'a> Egjk<'a> {
    /// Two bodies, seeds at their first vertices. Takes `O(n)`.
    pub fn new(moving: &'a ConvexPolyhedron, fixed: &'a ConvexPolyhedron) -> Self {
        let simplex = Simplex::new(Corner::default());
        Self { difference: Difference::new(moving, fixed), simplex }
    }

    /// With another way to find support points; unless said, it is [`SupportSearch::Climbing`].
    #[must_use]
    pub fn with_support_search(mut self, search: SupportSearch) -> Self {
        self.difference.search = search;
        self
    }

    /// Forgets what the last query left behind: the next one starts from scratch.
    pub fn reset(&mut self) {
        self.difference.reset();
        self.simplex = Simplex::new(Corner::default());
    }

    /// Distance and nearest points of the placed bodies, to within [`Steps::gap`].
    ///
    /// A distance below the rounding error `32 u S` is returned as 0. If the bodies overlap, both
    /// nearest points are one point of both, up to rounding. Where almost parallel faces or edges
    /// are nearest, many pairs of points have the same distance up to rounding; the answer is one.
    pub fn distance(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> Proximity<Steps> {
        let relative = Relative::new(moving_pose, fixed_pose);
        let noise = Difference::NOISE * self.difference.size(&relative);
        let mut steps = Steps::default();
        let mut simplex = self.simplex;
        for corner in simplex.corners_mut() {
            *corner = self.difference.corner(&relative, corner.pair);
        }
        let mut best = Bounds { upper: f64::INFINITY, lower: 0.0, simplex, idle: 0 };
        while steps.iterations < MAX_ITERATIONS {
            steps.iterations += 1;
            let nearest = simplex.reduce(DVec3::ZERO);
            let upper = nearest.length();
            best.take_upper(upper, &simplex, noise);
            if upper <= noise {
                break;
            }
            steps.supports += 1;
            let lowest = self.difference.lowest(&relative, nearest, &mut steps.climbed);
            best.take_lower(nearest.dot(lowest.point) / upper);
            if best.gap() <= noise || best.idle > PATIENCE || simplex.contains(lowest.pair) {
                break;
            }
            simplex.push(lowest);
        }
        steps.gap = best.gap();
        self.simplex = best.simplex;
        let [on_moving, on_fixed] = self.difference.nearest_points(&best.simplex);
        Proximity {
            distance: if best.upper <= noise { 0.0 } else { best.upper },
            on_moving: moving_pose.transform_point(on_moving),
            on_fixed: fixed_pose.transform_point(on_fixed),
            steps,
        }
    }
}
