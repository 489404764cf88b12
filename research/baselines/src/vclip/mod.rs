//! V-Clip: the distance of convex polyhedra by a walk over pairs of features.
//!
//! B. Mirtich, "V-Clip: fast and robust polyhedral collision detection", ACM Transactions on
//! Graphics 17(3), 1998. Two features are closest if each has its nearest point in the other's
//! Voronoi region. A walk starts from the closest features of the last query and exchanges one
//! feature at a time for a neighbour that is nearer (`walk`, `view`).
//!
//! As published, apart from its end. The walk decides on rounded numbers, and can then go in
//! circles among tied features, which is noticed, or end where rounding hides that a feature is
//! nearer. So every end is measured against the supporting planes across it (`proof`), which
//! costs a look at the neighbours of a few vertices. If it is not proven, the search goes on by
//! distances alone to nearer features around, then from where the planes touch, with Voronoi
//! regions that overlap by more than rounding. [`Steps::gap`] is what that leaves open.

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

/// How often a walk whose answer is not proven starts again, where the supporting planes touch.
const MAX_RESTARTS: u32 = 6;

/// The work of a query, and what it proves.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Steps {
    /// Pairs of features looked at.
    pub pairs: u32,
    /// Scans of all faces of a body, in local minima of the walk: when bodies overlap.
    pub scans: u32,
    /// How often an end that was not proven was left for nearer features around, or for a new walk.
    pub rescues: u32,
    /// The distance is at most what is reported and at least that less this gap, up to rounding
    /// (world units); 0 if the bodies overlap.
    pub gap: f64,
    /// Whether all rescues were used up and the gap is more than rounding explains.
    pub gave_up: bool,
}

/// The distance of two bodies that move, query after query.
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
/// let aside = Pose::from_translation(DVec3::new(4.0, 5.0, 0.5))?;
/// let proximity = solver.distance(&Pose::IDENTITY, &aside);
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
    /// A solver for two bodies; its first query starts from their first vertices.
    pub fn new(moving: &'a Shell, fixed: &'a Shell) -> Self {
        Self { moving, fixed, pair: FIRST_VERTICES }
    }

    /// Forgets the closest features of the last query.
    pub fn reset(&mut self) {
        self.pair = FIRST_VERTICES;
    }

    /// The distance of the bodies in these places.
    pub fn distance(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> Proximity<Steps> {
        let scene = Scene::new((self.moving, moving_pose), (self.fixed, fixed_pose));
        let mut work = Work::default();
        let end = scene.walk(&mut self.pair, scene.patience(), &mut work);
        let settled = settle(&scene, &mut self.pair, end, &mut work);
        settled.into_proximity(fixed_pose, work)
    }
}

/// Every body has a first vertex.
pub(crate) const FIRST_VERTICES: Pair = [Feature::Vertex(0); 2];

/// The answer in the fixed body's frame.
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
    /// Bodies with a point in common.
    pub(crate) fn meeting(common: DVec3, rescues: u32) -> Self {
        Self {
            on_moving: common,
            on_fixed: common,
            distance: 0.0,
            gap: 0.0,
            rescues,
            gave_up: false,
        }
    }

    fn into_proximity(self, fixed_pose: &Pose, work: Work) -> Proximity<Steps> {
        let Self { gap, rescues, gave_up, .. } = self;
        self.proximity(
            fixed_pose,
            Steps { pairs: work.pairs, scans: work.scans, rescues, gap, gave_up },
        )
    }

    /// In the world.
    pub(crate) fn proximity<S>(&self, fixed_pose: &Pose, steps: S) -> Proximity<S> {
        Proximity {
            distance: self.distance,
            on_moving: fixed_pose.transform_point(self.on_moving),
            on_fixed: fixed_pose.transform_point(self.on_fixed),
            steps,
        }
    }
}

/// From the end of a walk to an answer: out of local minima, and again from elsewhere as long as
/// the answer is not proven.
pub(crate) fn settle(scene: &Scene, pair: &mut Pair, mut end: End, work: &mut Work) -> Settled {
    let mut best: Option<(Settled, Pair)> = None;
    let mut scene = *scene;
    let mut rescues = 0;
    for restart in 0..=MAX_RESTARTS {
        end = scene.walk_on(pair, end, work);
        if let End::Penetrating(body, x) = end {
            let common = if body == 1 { x } else { to_fixed(&scene, x) };
            return Settled::meeting(common, rescues);
        }
        if end == End::Circle {
            scene.settle_in_circle(pair);
        }
        let (mut settled, mut supports) = judge(&scene, *pair, rescues);
        if settled.gave_up && scene.polish(pair) {
            rescues += 1;
            (settled, supports) = judge(&scene, *pair, rescues);
        }
        if !settled.gave_up {
            return settled;
        }
        if best.is_none_or(|(other, _)| settled.distance < other.distance) {
            best = Some((settled, *pair));
        }
        *pair = supports;
        // Planes flared by more each time: up to what the proof forgives.
        let flare = scene.rounding() / f64::from(1 << (MAX_RESTARTS - restart));
        rescues += 1;
        scene = scene.flared(flare);
        end = scene.walk(pair, scene.patience(), work);
    }
    let (settled, kept) = best.expect("at least one walk");
    *pair = kept;
    settled
}

/// What a pair of features is worth, and vertices of nearer ones if it is not the answer.
fn judge(scene: &Scene, pair: Pair, rescues: u32) -> (Settled, Pair) {
    let near = scene.nearest(pair);
    let Slab { gap, supports } = scene.slab(&near, pair);
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

/// A point of the moving body's frame in the fixed body's.
fn to_fixed(scene: &Scene, x: DVec3) -> DVec3 {
    scene.views[1].rotation * x + scene.views[1].translation
}
