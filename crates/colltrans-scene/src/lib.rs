//! Queries of one body against many placed bodies: the nearest one, those within a distance, the first one hit.
//!
//! The bodies are in a dynamic bounding volume tree. A query visits the boxes in the order of their bounds, and runs a
//! [`Pair`] or [`Cast`] query for each body that its box does not exclude.
//!
//! - `U` is the least upper bound found so far, of a distance or of the translation at which a body stops the moving
//!   one.
//! - Invariant: a box is excluded only if its bound, rounded down, is above `U`. A body inserted after the best one so
//!   far is also excluded if its bound equals `U`, or if the best one overlaps the moving body. Excluded bodies change
//!   neither bound of the answer.
//! - The answer is that of querying all bodies one by one: the body with the least upper bound, or the one inserted
//!   first if several are equal. It does not depend on the tree.
//! - The least lower bound of the queried bodies is a lower bound for all bodies.
//!
//! The modules: `boxes` (rounded outwards, and their bounds), `obstacles` (the stored bodies), `answer`, `search` (best
//! first), `proof`, and `verify`, which checks all bodies one by one. `bulk` is for many casts of one pair that does
//! not rotate.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "hidden modules are read with their private parts"
)]

mod answer;
mod boxes;
mod bulk;
mod obstacles;
mod proof;
mod search;
mod verify;

use std::fmt;

use glam::DVec3;

pub use answer::{Nearby, Nearest, SceneClearance};
use boxes::{RoundedBox, Sweep};
pub use bulk::{DirectionMap, FixedRotations};
use colltrans_convex::ConvexPolyhedron;
use colltrans_convex::body::{Aabb, ObstacleId, Pose};
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::solve::options::Options;
use colltrans_solid::Solid;
use colltrans_solid::body::AsSolid;
use colltrans_solid::cast::SolidOptions;
use colltrans_solid::kinds::{AnyBody, AnyPlaced, ByKind};
use colltrans_solid::{SolidCast, SolidPair};
use obstacles::Obstacle;
pub use obstacles::{Obstacles, UnknownObstacle};
pub use proof::{
    ApartProof, ClearanceProof, NearbyProof, NearestProof, ObstacleClearanceProof, SceneProof,
};

/// Predicate for obstacles that a query ignores.
type IgnoredPredicate<'a> = &'a (dyn Fn(ObstacleId) -> bool + Sync);

/// A moving body among many placed ones, for queries of one against all.
///
/// It is built for one pose of the moving body, and can be queried any number of times from any thread. Answers are
/// those of querying all obstacles one by one, with a [`Pair`] or a [`Cast`] each. They report the obstacle with the
/// least upper bound, and the one inserted first if several are equal. Bounds hold for all obstacles together.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::solid::SolidCast;
/// use colltrans::{SceneQuery, ConvexPolyhedron, Obstacles, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let mut scene = Obstacles::new();
/// let table = ConvexPolyhedron::cuboid(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0))?;
/// let table = scene.insert(table, Pose::IDENTITY);
/// let mug = scene.insert(cube.clone(), Pose::from_translation(DVec3::new(2.0, 0.0, 0.0))?);
/// let finger = scene.insert(cube.clone(), Pose::from_translation(DVec3::new(-1.0, 0.0, 3.0))?);
///
/// let hand = Pose::from_translation(DVec3::new(0.0, 0.0, 3.0))?;
/// let own = |id| id == finger;
/// let query = SceneQuery::new(cube.at(hand), &scene)?.ignoring(&own);
/// assert_eq!(query.nearest()?.expect("there are some").obstacle, mug);
/// assert_eq!(query.within(2.5)?.closer.len(), 1);
/// let stop = query.clearance(DVec3::NEG_Z)?.stop.expect("the table is below");
/// assert_eq!(stop.0, table);
///
/// // The proof is checked against all bodies, without a search.
/// let (down, proof) = query.certified_clearance(DVec3::NEG_Z)?;
/// assert!(down.lower <= 3.0 && down.lower > 2.999);
/// assert!(query.verify(&proof)? < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
pub struct SceneQuery<'a> {
    moving: AnyPlaced<'a>,
    obstacles: &'a Obstacles,
    /// The moving body lies in it.
    rounded: RoundedBox,
    /// Box around `rounded`.
    bounds: Aabb,
    ignored: Option<IgnoredPredicate<'a>>,
    options: Options,
    solid_options: SolidOptions,
}

/// Counters of the work of a query.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SceneSteps {
    /// Number of visited boxes, of single obstacles and of inner nodes.
    pub boxes: u32,
    /// Number of obstacles that were queried.
    pub bodies: u32,
}

/// A pair of bodies of the same kind.
pub(crate) type AnyPair<'a> = ByKind<Pair<'a>, Pair<'a, Solid>>;

/// A cast of bodies of the same kind.
pub(crate) type AnyCast<'a> = ByKind<Cast<'a>, Cast<'a, Solid>>;

impl<'a> SceneQuery<'a> {
    /// Builds the queries of a placed body among obstacles, with default options.
    ///
    /// # Errors
    /// Returns an error for a convex body whose facets [`Solid::from_mesh`](colltrans_solid::Solid::from_mesh) rejects,
    /// if it must be converted to a solid. This applies to a moving body among solids, and to the obstacles of a moving
    /// solid ([`QueryError::Obstacle`] with the id). The obstacles are checked here only if one of them is a point or a
    /// segment; otherwise the queries return this error.
    pub fn new(
        moving: impl Into<AnyPlaced<'a>>,
        obstacles: &'a Obstacles,
    ) -> Result<Self, QueryError> {
        let moving = moving.into();
        let counts = obstacles.counts();
        match moving {
            ByKind::Convex(placed) if counts.solids > 0 => drop(placed.body.as_surface()?),
            ByKind::Solid(_) if counts.faceless > 0 => obstacles.check_all_have_faces()?,
            _ => {}
        }
        let rounded = RoundedBox::of_placed(&moving);
        Ok(Self {
            moving,
            obstacles,
            rounded,
            bounds: rounded.outer_box(),
            ignored: None,
            options: Options::default(),
            solid_options: SolidOptions::default(),
        })
    }

    /// Excludes obstacles for which the predicate returns true, for example the parts of a gripper.
    #[must_use]
    pub fn ignoring(self, ignored: &'a (dyn Fn(ObstacleId) -> bool + Sync)) -> Self {
        Self { ignored: Some(ignored), ..self }
    }

    /// Sets the options of casts between convex bodies.
    ///
    /// # Errors
    /// Returns the errors of [`Cast::with_options`].
    pub fn with_options(self, options: Options) -> Result<Self, QueryError> {
        options.check_lengths()?;
        Ok(Self { options, ..self })
    }

    /// Sets the options of casts with solids. They are checked for each body that is queried.
    #[must_use]
    pub fn with_solid_options(self, solid_options: SolidOptions) -> Self {
        Self { solid_options, ..self }
    }

    /// Returns the moving body and its pose.
    pub fn moving(&self) -> AnyPlaced<'a> {
        self.moving
    }

    /// Returns the pose of the moving body.
    pub fn moving_pose(&self) -> Pose {
        match self.moving {
            ByKind::Convex(placed) => placed.pose,
            ByKind::Solid(placed) => placed.pose,
        }
    }

    /// Returns the options of casts between convex bodies.
    pub fn options(&self) -> Options {
        self.options
    }

    /// Returns the options of casts with solids.
    pub fn solid_options(&self) -> SolidOptions {
        self.solid_options
    }

    /// Returns all obstacles, including the ignored ones.
    pub fn obstacles(&self) -> &'a Obstacles {
        self.obstacles
    }

    /// Returns the sweep of the moving body along a direction, where the minimum gap of casts is added to its radius.
    fn sweep(&self, direction: DVec3) -> Sweep {
        let min_gap = self.options.min_gap.max(self.solid_options.min_gap);
        Sweep::new(self.rounded.widened(min_gap), direction)
    }

    /// Checks whether queries ignore an obstacle.
    fn is_ignored(&self, id: ObstacleId) -> bool {
        self.ignored.is_some_and(|ignored| ignored(id))
    }

    /// Returns the obstacles that are not ignored, in any order.
    fn queried_obstacles(&self) -> impl Iterator<Item = &'a Obstacle> {
        self.obstacles.placed().iter().filter(|obstacle| !self.is_ignored(obstacle.id))
    }

    /// Returns the number of obstacles that are not ignored.
    pub fn queried_count(&self) -> usize {
        if self.ignored.is_none() { self.obstacles.len() } else { self.queried_obstacles().count() }
    }

    /// Returns the pair of the moving body and an obstacle. Returns `None` if the obstacle does not exist, or if the
    /// pair cannot be built.
    #[cfg(feature = "serde")]
    #[doc(hidden)]
    pub fn pair_with(&self, id: ObstacleId) -> Option<AnyPair<'a>> {
        let item = self.obstacles.item_of(id).ok()?;
        self.pair_with_obstacle(self.obstacle_of_item(item)).ok()
    }

    /// Returns the cast of the moving body at an obstacle. Returns `None` if the obstacle does not exist, or if the
    /// cast cannot be built.
    #[cfg(feature = "serde")]
    #[doc(hidden)]
    pub fn cast_with(&self, id: ObstacleId, direction: DVec3) -> Option<AnyCast<'a>> {
        let item = self.obstacles.item_of(id).ok()?;
        self.cast_with_obstacle(self.obstacle_of_item(item), direction).ok()
    }

    /// Returns the bodies that are not ignored, with their poses, in the order of insertion.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    pub fn queried_in_order(&self) -> impl Iterator<Item = (&'a AnyBody, Pose)> {
        let mut all: Vec<&Obstacle> = self.queried_obstacles().collect();
        all.sort_unstable_by_key(|one| one.id);
        all.into_iter().map(|one| (&one.body, one.pose))
    }

    /// Returns the obstacle of an item of the tree.
    fn obstacle_of_item(&self, item: u32) -> &'a Obstacle {
        &self.obstacles.placed()[item as usize]
    }

    /// Builds the pair of the moving body and an obstacle.
    fn pair_with_obstacle(&self, obstacle: &'a Obstacle) -> Result<AnyPair<'a>, QueryError> {
        Ok(match (self.moving, obstacle.placed()) {
            (ByKind::Convex(p), ByKind::Convex(q)) => ByKind::Convex(Pair::new(p, q)?),
            (ByKind::Convex(p), ByKind::Solid(q)) => ByKind::Solid(Pair::between(p, q)?),
            (ByKind::Solid(p), ByKind::Convex(q)) => ByKind::Solid(Pair::between(p, q)?),
            (ByKind::Solid(p), ByKind::Solid(q)) => ByKind::Solid(Pair::between(p, q)?),
        })
    }

    /// Builds the cast of the moving body at an obstacle.
    fn cast_with_obstacle(
        &self,
        obstacle: &'a Obstacle,
        direction: DVec3,
    ) -> Result<AnyCast<'a>, QueryError> {
        let cast = match (self.moving, obstacle.placed()) {
            (ByKind::Convex(p), ByKind::Convex(q)) => {
                let cast = Cast::new(p, q, direction)?;
                return Ok(ByKind::Convex(cast.with_options(self.options)?));
            }
            (ByKind::Convex(p), ByKind::Solid(q)) => Cast::between(p, q, direction)?,
            (ByKind::Solid(p), ByKind::Convex(q)) => Cast::between(p, q, direction)?,
            (ByKind::Solid(p), ByKind::Solid(q)) => Cast::between(p, q, direction)?,
        };
        Ok(ByKind::Solid(cast.with_options(self.solid_options)?))
    }
}

impl Obstacles {
    /// Returns an error for the first convex obstacle that cannot be converted to a solid.
    fn check_all_have_faces(&self) -> Result<(), QueryError> {
        for (id, body, _) in self.iter() {
            if let AnyBody::Convex(body) = body {
                body.as_surface().map_err(|error| QueryError::from(error).of_obstacle(id))?;
            }
        }
        Ok(())
    }
}

impl fmt::Debug for SceneQuery<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SceneQuery")
            .field("moving", &self.moving)
            .field("obstacles", &self.obstacles.len())
            .field("ignores", &self.ignored.is_some())
            .finish_non_exhaustive()
    }
}

/// Checks at compile time that queries can be shared by threads.
const _: fn() = || {
    fn shared<T: Send + Sync>() {}
    shared::<SceneQuery<'_>>();
    shared::<Obstacles>();
    shared::<ConvexPolyhedron>();
};
