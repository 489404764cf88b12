//! V-Clip: distance of convex polyhedra by a walk over pairs of features. B. Mirtich, "V-Clip: fast and robust
//! polyhedral collision detection", ACM Transactions on Graphics 17(3), 1998.
//!
//! Two features are closest if each has its nearest point in the Voronoi region of the other. A walk starts at the
//! closest features of the last query and repeatedly replaces one feature by a nearer neighbour (`walk`, `view`).
//!
//! The implementation follows the publication except for its end. Rounded decisions can cause a cycle among tied
//! features, which is detected, or hide that a neighbour is nearer. Therefore every result is compared with the
//! supporting planes perpendicular to it (`proof`), which examines the neighbours of a few vertices. An unproven
//! result is improved first by distances among the surrounding features. Then walks restart at the vertices on the
//! supporting planes, with enlarged Voronoi regions. [`Steps::gap`] is the remaining uncertainty.

pub(crate) mod proof;
mod segment;
mod view;
pub(crate) mod walk;

use colltrans::Pose;
use glam::DVec3;

use crate::features::Feature;
pub use crate::features::{NotSolid, Shell};
use crate::proximity::Proximity;
use proof::Slab;
use walk::{End, Pair, Scene, Work};

/// Maximum number of restarts of an unproven walk, at the vertices on the supporting planes.
const MAX_RESTARTS: u32 = 6;

/// Work of a query, and its bound on the error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Steps {
    /// Number of pairs of features examined.
    pub pairs: u32,
    /// Number of scans of all faces of a body, in local minima of the walk, for example between overlapping
    /// bodies.
    pub scans: u32,
    /// Number of iterations: pairs of features and scanned faces.
    pub iterations: u32,
    /// Number of times that an unproven result was left for nearer features in its surroundings, or for
    /// another walk.
    pub rescues: u32,
    /// Bound on the error: the distance is at most the reported one, and at least the reported one minus this
    /// gap, up to rounding (world units). It is 0 if the bodies overlap.
    pub gap: f64,
    /// Whether all rescues were used and the gap exceeds rounding.
    pub gave_up: bool,
}

/// Solver for a sequence of distance queries between two bodies.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{ConvexPolyhedron, Pose};
/// use colltrans_baselines::vclip::{Shell, VClip};
///
/// let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| DVec3::new(
///     f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2),
/// ));
/// let cube = Shell::new(&ConvexPolyhedron::from_points(&corners)?)?;
/// let mut solver = VClip::new(&cube, &cube);
/// let offset = Pose::from_translation(DVec3::new(4.0, 5.0, 0.5))?;
/// let proximity = solver.distance(&Pose::IDENTITY, &offset);
/// assert_eq!(proximity.distance, 5.0);
/// assert!(!proximity.steps.gave_up);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct VClip<'a> {
    moving: &'a Shell,
    fixed: &'a Shell,
    pair: Pair,
}

impl<'a> VClip<'a> {
    /// Creates a solver for two bodies; the first query starts at their first vertices.
    pub fn new(moving: &'a Shell, fixed: &'a Shell) -> Self {
        Self { moving, fixed, pair: FIRST_VERTICES }
    }

    /// Discards the closest features of the last query.
    pub fn reset(&mut self) {
        self.pair = FIRST_VERTICES;
    }

    /// Computes the distance of the placed bodies.
    pub fn distance(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> Proximity<Steps> {
        let scene = Scene::new((self.moving, moving_pose), (self.fixed, fixed_pose));
        let mut work = Work::default();
        let end = scene.walk(&mut self.pair, scene.patience(), &mut work);
        let settled = settle(&scene, &mut self.pair, end, &mut work);
        settled.into_proximity(fixed_pose, work)
    }
}

/// The first vertex of each body, as a start of walks.
pub(crate) const FIRST_VERTICES: Pair = [Feature::Vertex(0); 2];

/// An answer in the fixed body's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settled {
    pub(crate) on_moving: DVec3,
    pub(crate) on_fixed: DVec3,
    pub(crate) distance: f64,
    pub(crate) gap: f64,
    pub(crate) rescues: u32,
    pub(crate) gave_up: bool,
}

impl Settled {
    /// Returns the answer for bodies with a common point.
    pub(crate) fn overlapping(common: DVec3, rescues: u32) -> Self {
        Self {
            on_moving: common,
            on_fixed: common,
            distance: 0.0,
            gap: 0.0,
            rescues,
            gave_up: false,
        }
    }

    /// Converts the answer of V-Clip to the world.
    fn into_proximity(self, fixed_pose: &Pose, work: Work) -> Proximity<Steps> {
        let Self { gap, rescues, gave_up, .. } = self;
        let Work { pairs, scans, scanned } = work;
        let iterations = pairs + scanned;
        self.proximity(fixed_pose, Steps { pairs, scans, iterations, rescues, gap, gave_up })
    }

    /// Converts the answer to the world.
    pub(crate) fn proximity<S>(&self, fixed_pose: &Pose, steps: S) -> Proximity<S> {
        Proximity {
            distance: self.distance,
            on_moving: fixed_pose.transform_point(self.on_moving),
            on_fixed: fixed_pose.transform_point(self.on_fixed),
            steps,
        }
    }
}

/// Computes the answer from the result of a walk. Leaves local minima, and restarts elsewhere while the
/// answer is unproven. Returns the nearest result.
pub(crate) fn settle(scene: &Scene, pair: &mut Pair, mut end: End, work: &mut Work) -> Settled {
    let mut best: Option<(Settled, Pair)> = None;
    let mut scene = *scene;
    let mut rescues = 0;
    for restart in 0..=MAX_RESTARTS {
        end = scene.walk_on(pair, end, work);
        if let End::Penetrating(body, x) = end {
            let common = if body == 1 { x } else { to_fixed(&scene, x) };
            return Settled::overlapping(common, rescues);
        }
        if end == End::Circle {
            scene.settle_in_circle(pair);
        }
        let (mut settled, mut supports) = evaluate_pair(&scene, *pair, rescues);
        if settled.gave_up && scene.polish(pair) {
            rescues += 1;
            (settled, supports) = evaluate_pair(&scene, *pair, rescues);
        }
        if !settled.gave_up {
            return settled;
        }
        if best.is_none_or(|(other, _)| settled.distance < other.distance) {
            best = Some((settled, *pair));
        }
        *pair = supports;
        // The planes are moved outwards by a larger length in each restart, up to the error that the proof
        // accepts.
        let flare = scene.rounding() / f64::from(1 << (MAX_RESTARTS - restart));
        rescues += 1;
        scene = scene.with_flare(flare);
        end = scene.walk(pair, scene.patience(), work);
    }
    let (settled, kept) = best.expect("at least one walk");
    *pair = kept;
    settled
}

/// Returns the answer for a pair of features, and the vertices on the supporting planes.
fn evaluate_pair(scene: &Scene, pair: Pair, rescues: u32) -> (Settled, Pair) {
    let near = scene.nearest(pair);
    let Slab { gap, supports } = scene.narrowest_gap_slab(&near, pair);
    let settled = Settled {
        on_moving: near.on_moving,
        on_fixed: near.on_fixed,
        distance: near.distance,
        gap,
        rescues,
        gave_up: gap > scene.rounding(),
    };
    (settled, supports)
}

/// Transforms a point from the moving body's frame to the fixed body's frame.
fn to_fixed(scene: &Scene, x: DVec3) -> DVec3 {
    scene.views[1].rotation * x + scene.views[1].translation
}
