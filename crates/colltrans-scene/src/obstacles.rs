//! Many placed bodies in a dynamic bounding volume tree.

use std::collections::HashMap;

use thiserror::Error;

use super::boxes::bounds_of_placed;
use colltrans_convex::body::{Aabb, ObstacleId, Pose};
use colltrans_kernel::dynamic_tree::DynamicTree;
use colltrans_solid::kinds::{AnyBody, AnyPlaced};

/// The obstacle does not exist, or was removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("unknown obstacle {id}; it was never inserted, or was removed")]
pub struct UnknownObstacle {
    /// Id of the obstacle.
    pub id: ObstacleId,
}

/// Many placed bodies, convex ones and solids, for queries by [`SceneQuery`](crate::SceneQuery).
///
/// Bodies are shared, so thousands of placements of one mesh take the memory of one. A tree of boxes is maintained.
/// Inserting all at once ([`Self::insert_all`]) takes `O(n log n)`. Inserting, moving or removing one takes `O(log^2
/// n)` amortised, because subtrees are rebuilt after as many changes as they have obstacles. The height of the tree
/// therefore stays below `5.2 log2 n` plus a constant, and the caller never needs to rebuild the tree.
///
/// ```
/// use std::sync::Arc;
///
/// use colltrans::glam::DVec3;
/// use colltrans::{SceneQuery, ConvexPolyhedron, Obstacles, Pose};
///
/// let cube = Arc::new(ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?);
/// let mut shelf = Obstacles::new();
/// let row = (0..1_000).map(|k| (cube.clone(), Pose::from_translation(DVec3::X * f64::from(2 * k))));
/// let row: Vec<_> = row.map(|(cube, pose)| Ok((cube, pose?))).collect::<Result<_, colltrans::PoseError>>()?;
/// let ids = shelf.insert_all(row);
///
/// let hand = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::splat(0.5))?;
/// let above = Pose::from_translation(DVec3::new(24.25, 0.25, 5.0))?;
/// let query = SceneQuery::new(hand.at(above), &shelf)?;
/// let nearest = query.nearest()?.expect("there are obstacles");
/// assert_eq!(nearest.obstacle, ids[12]);
/// assert!(nearest.lower <= 4.0 && 4.0 <= nearest.distance.upper());
///
/// let down = query.clearance(DVec3::NEG_Z)?;
/// assert_eq!(down.stop.expect("it is in the way").0, ids[12]);
/// shelf.remove(ids[12]);
/// assert_eq!(SceneQuery::new(hand.at(above), &shelf)?.clearance(DVec3::NEG_Z)?.lower, f64::INFINITY);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Obstacles {
    /// In the order of the items of the tree.
    placed: Vec<Obstacle>,
    tree: DynamicTree,
    items: HashMap<ObstacleId, u32>,
    next_id: u64,
    counts: Counts,
}

/// An obstacle: a placed body with its id.
#[derive(Debug, Clone)]
pub(super) struct Obstacle {
    pub(super) id: ObstacleId,
    pub(super) body: AnyBody,
    pub(super) pose: Pose,
}

/// Numbers of obstacles by kind.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Counts {
    pub(super) solids: usize,
    /// Number of points and segments.
    pub(super) faceless: usize,
}

impl Obstacle {
    /// Returns the placed body.
    pub(super) fn placed(&self) -> AnyPlaced<'_> {
        self.body.at(self.pose)
    }
}

impl Obstacles {
    /// Returns an empty set.
    pub fn new() -> Self {
        Self::default()
    }

    /// Inserts a body and returns its id. For many bodies, see [`Self::insert_all`].
    pub fn insert(&mut self, body: impl Into<AnyBody>, pose: Pose) -> ObstacleId {
        let id = self.store_obstacle(body.into(), pose);
        let bounds = self.last_obstacle_bounds();
        self.tree.insert(bounds);
        id
    }

    /// Inserts many bodies and returns their ids in the same order. Rebuilds the tree in one pass if more than half as
    /// many bodies are inserted as there are already.
    pub fn insert_all<B: Into<AnyBody>>(
        &mut self,
        bodies: impl IntoIterator<Item = (B, Pose)>,
    ) -> Vec<ObstacleId> {
        let before = self.placed.len();
        let bodies = bodies.into_iter();
        let size_hint = bodies.size_hint().0;
        self.placed.reserve(size_hint);
        self.items.reserve(size_hint);
        let ids: Vec<ObstacleId> =
            bodies.map(|(body, pose)| self.store_obstacle(body.into(), pose)).collect();
        let new = self.placed[before..].iter().map(|obstacle| bounds_of_placed(&obstacle.placed()));
        if 2 * ids.len() > before {
            let old = (0..before).map(|item| *self.tree.item_bounds(item as u32));
            self.tree = DynamicTree::from_boxes(old.chain(new));
        } else {
            new.for_each(|bounds| self.tree.insert(bounds));
        }
        ids
    }

    /// Stores a body and assigns its id, without inserting it into the tree.
    fn store_obstacle(&mut self, body: AnyBody, pose: Pose) -> ObstacleId {
        let id = ObstacleId(self.next_id);
        self.next_id += 1;
        self.items.insert(id, self.placed.len() as u32);
        self.counts.solids += usize::from(matches!(body, AnyBody::Solid(_)));
        self.counts.faceless += usize::from(has_no_faces(&body));
        self.placed.push(Obstacle { id, body, pose });
        id
    }

    /// Returns the box of the last obstacle.
    fn last_obstacle_bounds(&self) -> Aabb {
        self.placed.last().map_or(Aabb::EMPTY, |obstacle| bounds_of_placed(&obstacle.placed()))
    }

    /// Removes an obstacle and returns its body and pose. Returns `None` if it does not exist.
    pub fn remove(&mut self, id: ObstacleId) -> Option<(AnyBody, Pose)> {
        let item = self.items.remove(&id)?;
        self.tree.remove(item);
        let Obstacle { body, pose, .. } = self.placed.swap_remove(item as usize);
        if let Some(moved) = self.placed.get(item as usize) {
            self.items.insert(moved.id, item);
        }
        self.counts.solids -= usize::from(matches!(body, AnyBody::Solid(_)));
        self.counts.faceless -= usize::from(has_no_faces(&body));
        Some((body, pose))
    }

    /// Moves an obstacle to another pose.
    ///
    /// # Errors
    /// Returns an error if the obstacle does not exist.
    pub fn set_pose(&mut self, id: ObstacleId, pose: Pose) -> Result<(), UnknownObstacle> {
        let item = self.item_of(id)?;
        let obstacle = &mut self.placed[item as usize];
        obstacle.pose = pose;
        self.tree.set_bounds(item, bounds_of_placed(&obstacle.placed()));
        Ok(())
    }

    /// Moves many obstacles. Rebuilds the tree in one pass if they are more than a quarter of all.
    ///
    /// # Errors
    /// Returns an error if one of the obstacles does not exist. Then none is moved.
    pub fn set_poses(&mut self, poses: &[(ObstacleId, Pose)]) -> Result<(), UnknownObstacle> {
        let items: Vec<u32> =
            poses.iter().map(|(id, _)| self.item_of(*id)).collect::<Result<_, _>>()?;
        for (item, (_, pose)) in items.iter().zip(poses) {
            self.placed[*item as usize].pose = *pose;
        }
        let bounds = |item: &u32| bounds_of_placed(&self.placed[*item as usize].placed());
        if 4 * items.len() > self.len() {
            let mut boxes: Vec<Aabb> =
                (0..self.len()).map(|k| *self.tree.item_bounds(k as u32)).collect();
            for item in &items {
                boxes[*item as usize] = bounds(item);
            }
            self.tree = DynamicTree::from_boxes(boxes);
        } else {
            for item in &items {
                self.tree.set_bounds(*item, bounds(item));
            }
        }
        Ok(())
    }

    /// Returns the item of the tree of an obstacle.
    pub(super) fn item_of(&self, id: ObstacleId) -> Result<u32, UnknownObstacle> {
        self.items.get(&id).copied().ok_or(UnknownObstacle { id })
    }

    /// Returns a body and its pose. Returns `None` if the obstacle does not exist.
    pub fn get(&self, id: ObstacleId) -> Option<(&AnyBody, Pose)> {
        let item = *self.items.get(&id)?;
        let Obstacle { body, pose, .. } = &self.placed[item as usize];
        Some((body, *pose))
    }

    /// Returns all obstacles, in any order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (ObstacleId, &AnyBody, Pose)> {
        self.placed.iter().map(|Obstacle { id, body, pose }| (*id, body, *pose))
    }

    /// Returns the number of obstacles.
    pub fn len(&self) -> usize {
        self.placed.len()
    }

    /// Checks whether there are no obstacles.
    pub fn is_empty(&self) -> bool {
        self.placed.is_empty()
    }

    /// Returns a box that contains all obstacles, rounded outwards. Returns `None` if there are none.
    pub fn bounds(&self) -> Option<Aabb> {
        self.tree.root_bounds().copied()
    }

    /// Returns the obstacles in the order of the items of the tree.
    pub(super) fn placed(&self) -> &[Obstacle] {
        &self.placed
    }

    /// Returns the tree of boxes.
    pub(super) fn tree(&self) -> &DynamicTree {
        &self.tree
    }

    /// Returns the numbers of obstacles by kind.
    pub(super) fn counts(&self) -> Counts {
        self.counts
    }
}

/// Checks whether a body has no faces: a point or a segment.
fn has_no_faces(body: &AnyBody) -> bool {
    matches!(body, AnyBody::Convex(body) if body.face_count() == 0)
}
