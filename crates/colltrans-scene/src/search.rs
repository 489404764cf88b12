//! Which obstacle is nearest, and which are closer than a length.

use super::boxes;
use super::obstacles::Obstacle;
use super::{Among, AmongSteps, ByKind};
use colltrans_convex::answer::Within;
use colltrans_convex::body::ObstacleId;
use colltrans_convex::setting::check_length;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::kinds::{AnyDistance, AnyNear};

/// The answer of [`Among::nearest`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Nearest {
    /// The one whose distance has the least upper bound; of equal ones, of those that overlap the moving
    /// body, say, the one that came first.
    pub obstacle: ObstacleId,
    /// How far it is, and where; its upper bound is one of the least distance of all.
    pub distance: AnyDistance,
    /// No obstacle is nearer; rounded down, and at most the lower bound of the distance.
    pub lower: f64,
    /// Work done.
    pub steps: AmongSteps,
}

/// The answer of [`Among::within`], in the order in which obstacles came.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Nearby {
    /// Those that are closer, each with two points of the bodies.
    pub closer: Vec<(ObstacleId, AnyNear)>,
    /// Those of which rounding cannot tell: the length lies between their bounds.
    pub undecided: Vec<(ObstacleId, AnyDistance)>,
    /// Work done.
    pub steps: AmongSteps,
}

impl Among<'_> {
    /// Which obstacle is nearest, and how far is it? `None` if there are none.
    ///
    /// # Errors
    /// A search that ends without an answer: see [`QueryError::NotConverged`].
    pub fn nearest(&self) -> Result<Option<Nearest>, QueryError> {
        let mut best: Option<(ObstacleId, AnyDistance)> = None;
        let (mut lower, mut limit, mut bodies) = (f64::INFINITY, f64::INFINITY, 0);
        let bound = |other: &_| boxes::distance(&self.bounds, other);
        let boxes = self.obstacles.tree().search(limit, bound, |item, bound| {
            let obstacle = self.obstacle(item);
            let id = obstacle.id;
            let is_later = best.is_some_and(|(first, _)| bound == limit && id > first);
            if is_later || self.is_ignored(id) {
                return Ok(limit);
            }
            bodies += 1;
            let found = self.distance_to(obstacle, limit);
            let (least, distance) = found.map_err(|e| e.of_obstacle(id))?;
            lower = lower.min(least);
            if let Some(distance) = distance {
                let (upper, first) = (distance.upper(), best.map_or(id, |(first, _)| first));
                if best.is_none() || (upper, id) < (limit, first) {
                    (best, limit) = (Some((id, distance)), upper);
                }
            }
            Ok::<_, QueryError>(limit)
        })?;
        let steps = AmongSteps { boxes, bodies };
        Ok(best.map(|(obstacle, distance)| Nearest { obstacle, distance, lower, steps }))
    }

    /// What an obstacle is not nearer than, and its distance if it may be closer than a length.
    fn distance_to(
        &self,
        obstacle: &Obstacle,
        limit: f64,
    ) -> Result<(f64, Option<AnyDistance>), QueryError> {
        let distance = match self.pair(obstacle)? {
            ByKind::Convex(pair) => ByKind::Convex(pair.distance()?),
            ByKind::Solid(pair) if limit < f64::INFINITY => match pair.within(limit)? {
                Within::Farther(gap) => return Ok((gap.gap, None)),
                Within::Closer(_) => ByKind::Solid(pair.distance()?),
                Within::Undecided(distance) => ByKind::Solid(distance),
            },
            ByKind::Solid(pair) => ByKind::Solid(pair.distance()?),
        };
        Ok((distance.lower(), Some(distance)))
    }

    /// Which obstacles are closer than a length, in world units?
    ///
    /// # Errors
    /// A length that is negative or not a number; and as [`Self::nearest`].
    pub fn within(&self, length: f64) -> Result<Nearby, QueryError> {
        check_length(length)?;
        let mut nearby = Nearby::default();
        let bound = |other: &_| boxes::distance(&self.bounds, other);
        let boxes = self.obstacles.tree().search(length, bound, |item, _| {
            let obstacle = self.obstacle(item);
            if !self.is_ignored(obstacle.id) {
                let found = self.is_within(obstacle, length);
                nearby.add(obstacle.id, found.map_err(|e| e.of_obstacle(obstacle.id))?);
            }
            Ok::<_, QueryError>(length)
        })?;
        nearby.closer.sort_unstable_by_key(|(id, _)| *id);
        nearby.undecided.sort_unstable_by_key(|(id, _)| *id);
        nearby.steps.boxes = boxes;
        Ok(nearby)
    }

    pub(super) fn is_within(
        &self,
        obstacle: &Obstacle,
        length: f64,
    ) -> Result<Closeness, QueryError> {
        Ok(match self.pair(obstacle)? {
            ByKind::Convex(pair) => match pair.within(length)? {
                Within::Closer(near) => Closeness::Closer(ByKind::Convex(near)),
                Within::Farther(_) => Closeness::Farther,
                Within::Undecided(distance) => Closeness::Undecided(ByKind::Convex(distance)),
            },
            ByKind::Solid(pair) => match pair.within(length)? {
                Within::Closer(near) => Closeness::Closer(ByKind::Solid(near)),
                Within::Farther(_) => Closeness::Farther,
                Within::Undecided(distance) => Closeness::Undecided(ByKind::Solid(distance)),
            },
        })
    }
}

/// Whether one obstacle is closer than a length.
#[derive(Debug, Clone, Copy)]
pub(super) enum Closeness {
    Closer(AnyNear),
    Farther,
    Undecided(AnyDistance),
}

impl Nearby {
    fn add(&mut self, id: ObstacleId, closeness: Closeness) {
        self.steps.bodies += 1;
        match closeness {
            Closeness::Closer(near) => self.closer.push((id, near)),
            Closeness::Undecided(distance) => self.undecided.push((id, distance)),
            Closeness::Farther => {}
        }
    }
}
