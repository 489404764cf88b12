//! One body among many placed ones: which is nearest, which are closer than a length, which is hit first.
//!
//! The bodies lie in a dynamic tree of [`boxes`]. A search asks about single bodies, with the questions that a
//! [`Pair`] and a [`Cast`] answer, by the bounds of their boxes, the least first; what a box
//! proves to be of no interest is not asked about.
//!
//! Notation. `U` is the least upper bound of an answer so far: of a distance, or of the translation at which a
//! body stops the moving one.
//!
//! Invariant. A box is left out only if its bound, rounded outwards, is above `U`. What is in it then has a
//! true value above `U`, so an upper bound above `U`, and is no better than the lower bound of the answer. So:
//!
//! - the answer is about the body whose own upper bound is the least of all, of equal ones the one that came
//!   first, whatever the tree looks like: that of asking all one by one;
//! - the least lower bound of those that were asked about is one of all.
//!
//! The modules: `boxes` (rounded outwards, and what they prove), `obstacles` (who is kept);
//! then the questions: `answer`, `search`, best first by boxes, `proof`, and `verify`, whose checks take all bodies one by one.
//! `bulk` is one pair asked many times while neither body turns: `faces` of `M`, made once, each with its bound; `star`
//! guesses where a line enters, `search` walks there, `approach` has a map for one direction.

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

pub use answer::{ClearanceAmong, Nearby, Nearest};
pub use bulk::{Approach, FixedRotations};
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
pub use proof::{AmongProof, ApartProof, ClearanceProof, NearbyProof, NearestProof, PassedProof};

/// Bodies that are not asked about.
type Ignored<'a> = &'a (dyn Fn(ObstacleId) -> bool + Sync);

/// A moving body among many placed ones: what is asked of one and all of the others.
///
/// Made for one pose of the moving body, asked as often as one likes, from any thread. Answers are those of
/// asking all obstacles one by one, a [`Pair`] or a [`Cast`] each: of several that cannot be told apart, the
/// one whose upper bound is least, and of equal ones the one that came first. Bounds hold for all obstacles
/// together.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::solid::SolidCast;
/// use colltrans::{Among, ConvexPolyhedron, Obstacles, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let mut room = Obstacles::new();
/// let table = ConvexPolyhedron::cuboid(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0))?;
/// let table = room.insert(table, Pose::IDENTITY);
/// let mug = room.insert(cube.clone(), Pose::from_translation(DVec3::new(2.0, 0.0, 0.0))?);
/// let finger = room.insert(cube.clone(), Pose::from_translation(DVec3::new(-1.0, 0.0, 3.0))?);
///
/// let hand = Pose::from_translation(DVec3::new(0.0, 0.0, 3.0))?;
/// let own = |id| id == finger;
/// let asked = Among::new(cube.at(hand), &room)?.ignoring(&own);
/// assert_eq!(asked.nearest()?.expect("there are some").obstacle, mug);
/// assert_eq!(asked.within(2.5)?.closer.len(), 1);
/// let stop = asked.clearance(DVec3::NEG_Z)?.stop.expect("the table is below");
/// assert_eq!(stop.0, table);
///
/// // The proof: checked against all bodies, without a search.
/// let (down, proof) = asked.certified_clearance(DVec3::NEG_Z)?;
/// assert!(down.lower <= 3.0 && down.lower > 2.999);
/// assert!(asked.verify(&proof)? < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
pub struct Among<'a> {
    moving: AnyPlaced<'a>,
    obstacles: &'a Obstacles,
    bounds: Aabb,
    ignored: Option<Ignored<'a>>,
    options: Options,
    solid_options: SolidOptions,
}

/// The work of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AmongSteps {
    /// Boxes that were looked at, of obstacles and of many together.
    pub boxes: u32,
    /// Obstacles that were asked about.
    pub bodies: u32,
}

/// Two bodies of the same kind.
pub(crate) type AnyPair<'a> = ByKind<Pair<'a>, Pair<'a, Solid>>;

/// The same, and a direction.
pub(crate) type AnyCast<'a> = ByKind<Cast<'a>, Cast<'a, Solid>>;

impl<'a> Among<'a> {
    /// A placed body among obstacles, with the default choices.
    ///
    /// # Errors
    /// A convex body whose facets [`Solid::from_mesh`](colltrans_solid::Solid::from_mesh) refuses, where a solid is asked
    /// about it: as the moving body among solids, or among the obstacles of a moving solid, by its id
    /// ([`QueryError::Obstacle`]).
    pub fn new(
        moving: impl Into<AnyPlaced<'a>>,
        obstacles: &'a Obstacles,
    ) -> Result<Self, QueryError> {
        let moving = moving.into();
        let counts = obstacles.counts();
        match moving {
            ByKind::Convex(placed) if counts.solids > 0 => drop(placed.body.as_surface()?),
            ByKind::Solid(_) if counts.bare > 0 => obstacles.refuse_bare()?,
            _ => {}
        }
        Ok(Self {
            moving,
            obstacles,
            bounds: boxes::of_placed(&moving),
            ignored: None,
            options: Options::default(),
            solid_options: SolidOptions::default(),
        })
    }

    /// Without those for which this is true: the parts of a gripper, say.
    #[must_use]
    pub fn ignoring(self, ignored: &'a (dyn Fn(ObstacleId) -> bool + Sync)) -> Self {
        Self { ignored: Some(ignored), ..self }
    }

    /// With other choices for casts at convex bodies.
    ///
    /// # Errors
    /// As [`Cast::with_options`].
    pub fn with_options(self, options: Options) -> Result<Self, QueryError> {
        options.check()?;
        Ok(Self { options, ..self })
    }

    /// With other choices for casts of solids; they are checked for each body that is asked about.
    #[must_use]
    pub fn with_solid_options(self, solid_options: SolidOptions) -> Self {
        Self { solid_options, ..self }
    }

    /// The moving body, and where it is.
    pub fn moving(&self) -> AnyPlaced<'a> {
        self.moving
    }

    /// Where the moving body is.
    pub fn moving_pose(&self) -> Pose {
        match self.moving {
            ByKind::Convex(placed) => placed.pose,
            ByKind::Solid(placed) => placed.pose,
        }
    }

    /// The choices of casts at convex bodies.
    pub fn options(&self) -> Options {
        self.options
    }

    /// The choices of casts of solids.
    pub fn solid_options(&self) -> SolidOptions {
        self.solid_options
    }

    /// All obstacles, those that are ignored as well.
    pub fn obstacles(&self) -> &'a Obstacles {
        self.obstacles
    }

    /// The box of the moving body, with the gap that casts are to keep around it, and a little for rounding.
    fn swept(&self) -> Aabb {
        let keep = self.options.keep.max(self.solid_options.keep);
        if keep > 0.0 {
            let Aabb { low, high } = self.bounds;
            let size = low.abs().max(high.abs()).max_element() + keep;
            self.bounds.grown(keep + 16.0 * f64::EPSILON * size)
        } else {
            self.bounds
        }
    }

    fn is_ignored(&self, id: ObstacleId) -> bool {
        self.ignored.is_some_and(|ignored| ignored(id))
    }

    /// Those that are asked about, in no order.
    fn asked(&self) -> impl Iterator<Item = &'a Obstacle> {
        self.obstacles.placed().iter().filter(|obstacle| !self.is_ignored(obstacle.id))
    }

    /// How many obstacles are asked about.
    pub fn count(&self) -> usize {
        if self.ignored.is_none() { self.obstacles.len() } else { self.asked().count() }
    }

    /// The moving body and an obstacle, if there is such a one.
    #[cfg(feature = "serde")]
    #[doc(hidden)]
    pub fn pair_with(&self, id: ObstacleId) -> Option<AnyPair<'a>> {
        let item = self.obstacles.item(id).ok()?;
        self.pair(self.obstacle(item)).ok()
    }

    /// The same, and a direction.
    #[cfg(feature = "serde")]
    #[doc(hidden)]
    pub fn cast_at(&self, id: ObstacleId, direction: DVec3) -> Option<AnyCast<'a>> {
        let item = self.obstacles.item(id).ok()?;
        self.cast(self.obstacle(item), direction).ok()
    }

    /// The same, in the order in which they came.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    pub fn asked_in_order(&self) -> impl Iterator<Item = (&'a AnyBody, Pose)> {
        let mut all: Vec<&Obstacle> = self.asked().collect();
        all.sort_unstable_by_key(|one| one.id);
        all.into_iter().map(|one| (&one.body, one.pose))
    }

    fn obstacle(&self, item: u32) -> &'a Obstacle {
        &self.obstacles.placed()[item as usize]
    }

    fn pair(&self, obstacle: &'a Obstacle) -> Result<AnyPair<'a>, QueryError> {
        Ok(match (self.moving, obstacle.placed()) {
            (ByKind::Convex(p), ByKind::Convex(q)) => ByKind::Convex(Pair::new(p, q)?),
            (ByKind::Convex(p), ByKind::Solid(q)) => ByKind::Solid(Pair::between(p, q)?),
            (ByKind::Solid(p), ByKind::Convex(q)) => ByKind::Solid(Pair::between(p, q)?),
            (ByKind::Solid(p), ByKind::Solid(q)) => ByKind::Solid(Pair::between(p, q)?),
        })
    }

    fn cast(&self, obstacle: &'a Obstacle, direction: DVec3) -> Result<AnyCast<'a>, QueryError> {
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
    /// What a solid cannot be asked about.
    fn refuse_bare(&self) -> Result<(), QueryError> {
        for (id, body, _) in self.iter() {
            if let AnyBody::Convex(body) = body {
                body.as_surface().map_err(|error| QueryError::from(error).of_obstacle(id))?;
            }
        }
        Ok(())
    }
}

impl fmt::Debug for Among<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Among")
            .field("moving", &self.moving)
            .field("obstacles", &self.obstacles.len())
            .field("ignores", &self.ignored.is_some())
            .finish_non_exhaustive()
    }
}

/// From any thread.
const _: fn() = || {
    fn shared<T: Send + Sync>() {}
    shared::<Among<'_>>();
    shared::<Obstacles>();
    shared::<ConvexPolyhedron>();
};
