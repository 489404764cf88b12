//! Many placed bodies, kept in a tree of boxes.

use std::collections::HashMap;

use thiserror::Error;

use super::boxes::of_placed;
use colltrans_convex::body::{Aabb, ObstacleId, Pose};
use colltrans_kernel::dynamic_tree::DynamicTree;
use colltrans_solid::kinds::{AnyBody, AnyPlaced};

/// There is no such obstacle (any more).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("there is no obstacle {id}, or not any more")]
pub struct UnknownObstacle {
    /// The one that was named.
    pub id: ObstacleId,
}

/// Many placed bodies, convex ones and solids: what [`Among`](crate::Among) asks about.
///
/// Bodies are shared, so thousands of placements of one mesh take the space of one. A tree of boxes over
/// them is kept: all at once ([`Self::insert_all`]) it is built in `O(n log n)`; one that comes, moves or goes
/// costs `O(log^2 n)` on average. Parts of the tree are built anew after as many changes as they had obstacles,
/// so its height stays below `5.2 log2 n` plus a few, whatever happens: nobody has to build it again.
///
/// ```
/// use std::sync::Arc;
///
/// use colltrans::glam::DVec3;
/// use colltrans::{Among, ConvexPolyhedron, Obstacles, Pose};
///
/// let cube = Arc::new(ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?);
/// let mut shelf = Obstacles::new();
/// let row = (0..1_000).map(|k| (cube.clone(), Pose::from_translation(DVec3::X * f64::from(2 * k))));
/// let row: Vec<_> = row.map(|(cube, pose)| Ok((cube, pose?))).collect::<Result<_, colltrans::PoseError>>()?;
/// let ids = shelf.insert_all(row);
///
/// let hand = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::splat(0.5))?;
/// let above = Pose::from_translation(DVec3::new(24.25, 0.25, 5.0))?;
/// let asked = Among::new(hand.at(above), &shelf)?;
/// let nearest = asked.nearest()?.expect("there are obstacles");
/// assert_eq!(nearest.obstacle, ids[12]);
/// assert!(nearest.lower <= 4.0 && 4.0 <= nearest.distance.upper());
///
/// let down = asked.clearance(DVec3::NEG_Z)?;
/// assert_eq!(down.stop.expect("it is in the way").0, ids[12]);
/// shelf.remove(ids[12]);
/// assert_eq!(Among::new(hand.at(above), &shelf)?.clearance(DVec3::NEG_Z)?.lower, f64::INFINITY);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Obstacles {
    /// In the order of the tree's items.
    placed: Vec<Obstacle>,
    tree: DynamicTree,
    positions: HashMap<ObstacleId, u32>,
    next: u64,
    counts: Counts,
}

/// One of them.
#[derive(Debug, Clone)]
pub(super) struct Obstacle {
    pub(super) id: ObstacleId,
    pub(super) body: AnyBody,
    pub(super) pose: Pose,
}

/// How many are of which kind.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Counts {
    pub(super) solids: usize,
    /// Points and segments.
    pub(super) bare: usize,
}

impl Obstacle {
    pub(super) fn placed(&self) -> AnyPlaced<'_> {
        self.body.at(self.pose)
    }
}

impl Obstacles {
    /// None.
    pub fn new() -> Self {
        Self::default()
    }

    /// One more. Of many at once see [`Self::insert_all`].
    pub fn insert(&mut self, body: impl Into<AnyBody>, pose: Pose) -> ObstacleId {
        let id = self.push(body.into(), pose);
        let bounds = self.last_bounds();
        self.tree.insert(bounds);
        id
    }

    /// Many more, in one pass where they are many beside those that there are; their numbers in the same
    /// order.
    pub fn insert_all<B: Into<AnyBody>>(
        &mut self,
        bodies: impl IntoIterator<Item = (B, Pose)>,
    ) -> Vec<ObstacleId> {
        let before = self.placed.len();
        let bodies = bodies.into_iter();
        let room = bodies.size_hint().0;
        self.placed.reserve(room);
        self.positions.reserve(room);
        let ids: Vec<ObstacleId> =
            bodies.map(|(body, pose)| self.push(body.into(), pose)).collect();
        let new = self.placed[before..].iter().map(|obstacle| of_placed(&obstacle.placed()));
        if 2 * ids.len() > before {
            let old = (0..before).map(|item| *self.tree.bounds(item as u32));
            self.tree = DynamicTree::build(old.chain(new));
        } else {
            new.for_each(|bounds| self.tree.insert(bounds));
        }
        ids
    }

    fn push(&mut self, body: AnyBody, pose: Pose) -> ObstacleId {
        let id = ObstacleId(self.next);
        self.next += 1;
        self.positions.insert(id, self.placed.len() as u32);
        self.counts.solids += usize::from(matches!(body, AnyBody::Solid(_)));
        self.counts.bare += usize::from(is_bare(&body));
        self.placed.push(Obstacle { id, body, pose });
        id
    }

    fn last_bounds(&self) -> Aabb {
        self.placed.last().map_or(Aabb::EMPTY, |obstacle| of_placed(&obstacle.placed()))
    }

    /// Takes one away: the body, and where it was; `None` if there is no such one.
    pub fn remove(&mut self, id: ObstacleId) -> Option<(AnyBody, Pose)> {
        let item = self.positions.remove(&id)?;
        self.tree.remove(item);
        let Obstacle { body, pose, .. } = self.placed.swap_remove(item as usize);
        if let Some(moved) = self.placed.get(item as usize) {
            self.positions.insert(moved.id, item);
        }
        self.counts.solids -= usize::from(matches!(body, AnyBody::Solid(_)));
        self.counts.bare -= usize::from(is_bare(&body));
        Some((body, pose))
    }

    /// Puts one elsewhere.
    ///
    /// # Errors
    /// There is no such one.
    pub fn set_pose(&mut self, id: ObstacleId, pose: Pose) -> Result<(), UnknownObstacle> {
        let item = self.item(id)?;
        let obstacle = &mut self.placed[item as usize];
        obstacle.pose = pose;
        self.tree.set(item, of_placed(&obstacle.placed()));
        Ok(())
    }

    /// Puts many elsewhere, in one pass where they are many.
    ///
    /// # Errors
    /// There is no such one: then nothing has moved.
    pub fn set_poses(&mut self, poses: &[(ObstacleId, Pose)]) -> Result<(), UnknownObstacle> {
        let items: Vec<u32> =
            poses.iter().map(|(id, _)| self.item(*id)).collect::<Result<_, _>>()?;
        for (item, (_, pose)) in items.iter().zip(poses) {
            self.placed[*item as usize].pose = *pose;
        }
        let bounds = |item: &u32| of_placed(&self.placed[*item as usize].placed());
        if 4 * items.len() > self.len() {
            let mut boxes: Vec<Aabb> =
                (0..self.len()).map(|k| *self.tree.bounds(k as u32)).collect();
            for item in &items {
                boxes[*item as usize] = bounds(item);
            }
            self.tree = DynamicTree::build(boxes);
        } else {
            for item in &items {
                self.tree.set(*item, bounds(item));
            }
        }
        Ok(())
    }

    pub(super) fn item(&self, id: ObstacleId) -> Result<u32, UnknownObstacle> {
        self.positions.get(&id).copied().ok_or(UnknownObstacle { id })
    }

    /// One of them, and where it is; `None` if there is no such one.
    pub fn get(&self, id: ObstacleId) -> Option<(&AnyBody, Pose)> {
        let item = *self.positions.get(&id)?;
        let Obstacle { body, pose, .. } = &self.placed[item as usize];
        Some((body, *pose))
    }

    /// All of them, in no order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (ObstacleId, &AnyBody, Pose)> {
        self.placed.iter().map(|Obstacle { id, body, pose }| (*id, body, *pose))
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.placed.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.placed.is_empty()
    }

    /// A box that holds all of them, rounded outwards; `None` if there are none.
    pub fn bounds(&self) -> Option<Aabb> {
        self.tree.root().copied()
    }

    pub(super) fn placed(&self) -> &[Obstacle] {
        &self.placed
    }

    pub(super) fn tree(&self) -> &DynamicTree {
        &self.tree
    }

    pub(super) fn counts(&self) -> Counts {
        self.counts
    }
}

/// Returns whether a body has no faces: no solid can be asked about it.
fn is_bare(body: &AnyBody) -> bool {
    matches!(body, AnyBody::Convex(body) if body.face_count() == 0)
}
