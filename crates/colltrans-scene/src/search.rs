//! Searches for the nearest obstacle, for those within a distance, and for the one that stops the moving body first.

use glam::DVec3;

use super::obstacles::Obstacle;
use super::{ByKind, Nearby, Nearest, SceneClearance, SceneQuery, SceneSteps};
use colltrans_convex::answer::{Clearance, Within};
use colltrans_convex::body::ObstacleId;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::setting::{check_direction, check_length};
use colltrans_solid::Solid;
use colltrans_solid::kinds::{AnyClearance, AnyDistance, AnyNear};
use colltrans_solid::{SolidCast, SolidScene};

/// Distance, in noises, behind the best answer at which searches between solids end. It exceeds the errors of their
/// bounds.
const SEARCH_MARGIN: f64 = 64.0;

impl SceneQuery<'_> {
    /// Finds the nearest obstacle and its distance. Returns `None` if there are no obstacles, or all are ignored.
    ///
    /// # Errors
    /// Returns [`QueryError::Obstacle`] with the error of an obstacle: [`QueryError::NotConverged`] if a search ends
    /// without an answer, or that of a convex body that cannot be converted to a solid.
    pub fn nearest(&self) -> Result<Option<Nearest>, QueryError> {
        let mut best: Option<(ObstacleId, AnyDistance)> = None;
        let (mut lower, mut limit, mut bodies) = (f64::INFINITY, f64::INFINITY, 0);
        let bound = |other: &_| self.rounded.distance(other);
        let boxes = self.obstacles.tree().visit_by_bound(limit, bound, |item, bound| {
            let obstacle = self.obstacle_of_item(item);
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
        let steps = SceneSteps { boxes, bodies };
        Ok(best.map(|(obstacle, distance)| Nearest { obstacle, distance, lower, steps }))
    }

    /// Returns a lower bound of the distance of an obstacle, and the distance unless it exceeds the limit.
    fn distance_to(
        &self,
        obstacle: &Obstacle,
        limit: f64,
    ) -> Result<(f64, Option<AnyDistance>), QueryError> {
        let distance = match self.pair_with_obstacle(obstacle)? {
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

    /// Finds the obstacles that are closer than a length, in world units.
    ///
    /// # Errors
    /// Returns an error if the length is negative or not a number, and the errors of [`Self::nearest`].
    pub fn within(&self, length: f64) -> Result<Nearby, QueryError> {
        check_length(length)?;
        let mut nearby = Nearby::default();
        let bound = |other: &_| self.rounded.distance(other);
        let boxes = self.obstacles.tree().visit_by_bound(length, bound, |item, _| {
            let obstacle = self.obstacle_of_item(item);
            if !self.is_ignored(obstacle.id) {
                let found = self.closeness_of(obstacle, length);
                nearby.add_obstacle(obstacle.id, found.map_err(|e| e.of_obstacle(obstacle.id))?);
            }
            Ok::<_, QueryError>(length)
        })?;
        nearby.closer.sort_unstable_by_key(|(id, _)| *id);
        nearby.undecided.sort_unstable_by_key(|(id, _)| *id);
        nearby.steps.boxes = boxes;
        Ok(nearby)
    }

    /// Checks whether an obstacle is closer than a length.
    pub(super) fn closeness_of(
        &self,
        obstacle: &Obstacle,
        length: f64,
    ) -> Result<Closeness, QueryError> {
        Ok(match self.pair_with_obstacle(obstacle)? {
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

/// Whether an obstacle is closer than a length.
#[derive(Debug, Clone, Copy)]
pub(super) enum Closeness {
    Closer(AnyNear),
    Farther,
    Undecided(AnyDistance),
}

impl Nearby {
    /// Adds the result of one obstacle to the answer.
    fn add_obstacle(&mut self, id: ObstacleId, closeness: Closeness) {
        self.steps.bodies += 1;
        match closeness {
            Closeness::Closer(near) => self.closer.push((id, near)),
            Closeness::Undecided(distance) => self.undecided.push((id, distance)),
            Closeness::Farther => {}
        }
    }
}

impl SceneQuery<'_> {
    /// Computes how far the moving body can move along a direction of any length, and the obstacle that stops it.
    ///
    /// The answer is that of [`Cast::clearance`] of each obstacle. Obstacles behind the body do not stop it, nor do
    /// those along which it slides within the graze tolerance, nor those whose boxes the swept rounded box does not
    /// meet. For the first obstacle within a limited travel, see [`Self::clearance_before`].
    ///
    /// # Errors
    /// Returns an error if the direction is zero, not finite or out of range, and the errors of [`Cast::clearance`] of
    /// the obstacles.
    pub fn clearance(&self, direction: DVec3) -> Result<SceneClearance, QueryError> {
        self.clearance_before(direction, f64::INFINITY)
    }

    /// Computes the clearance up to an end, in multiples of the direction. The lower bound is at most the end. An
    /// obstacle whose upper bound is not before the end is not reported as the stop, but its lower bound still counts.
    ///
    /// # Errors
    /// Returns an error if the end is negative or not a number, and the errors of [`Self::clearance`].
    pub fn clearance_before(
        &self,
        direction: DVec3,
        end: f64,
    ) -> Result<SceneClearance, QueryError> {
        check_direction(direction)?;
        check_length(end)?;
        let sweep = self.sweep(direction);
        let mut stop: Option<(ObstacleId, AnyClearance)> = None;
        let (mut lower, mut upper, mut bodies) = (end, end, 0);
        let entry = |other: &_| sweep.entry(other);
        let boxes = self.obstacles.tree().visit_by_bound(end, entry, |item, bound| {
            let obstacle = self.obstacle_of_item(item);
            let (id, first) = (obstacle.id, stop.map_or(ObstacleId(0), |(first, _)| first));
            // A bound of 0 excludes nothing, because the bodies may overlap.
            let is_no_better = upper == f64::NEG_INFINITY || (bound > 0.0 && bound == upper);
            if (is_no_better && id > first) || self.is_ignored(id) {
                return Ok(upper.max(0.0));
            }
            bodies += 1;
            let found = self.clearance_of(obstacle, direction, upper.max(0.0));
            let found = found.map_err(|e| e.of_obstacle(id))?;
            lower = lower.min(found.distance().unwrap_or(0.0));
            if (found.upper_bound(), id) < (upper, first) {
                (stop, upper) = (Some((id, found)), found.upper_bound());
            }
            Ok::<_, QueryError>(upper.max(0.0))
        })?;
        Ok(SceneClearance { lower, stop, steps: SceneSteps { boxes, bodies } })
    }

    /// Computes the clearance of an obstacle. If it is not below the limit, any answer that is not below it may be
    /// returned.
    fn clearance_of(
        &self,
        obstacle: &Obstacle,
        direction: DVec3,
        limit: f64,
    ) -> Result<AnyClearance, QueryError> {
        Ok(match self.cast_with_obstacle(obstacle, direction)? {
            ByKind::Convex(cast) => ByKind::Convex(cast.clearance()?),
            ByKind::Solid(cast) => ByKind::Solid(clearance_below(&cast, limit)?),
        })
    }
}

/// Computes the clearance of two solids. Returns `Free` if it is clearly not below the limit.
///
/// Searches end where the offset solids meet. With a tolerance, solids that meet in nominal position before the limit
/// may meet any distance later after the offset, if their facets are nearly parallel to the direction. The limit is
/// therefore used without a tolerance only.
fn clearance_below(cast: &Cast<'_, Solid>, limit: f64) -> Result<Clearance<Solid>, QueryError> {
    if limit == f64::INFINITY || cast.tolerance() > 0.0 {
        return cast.clearance();
    }
    let margin = SEARCH_MARGIN * cast.scene_with_tolerance(0.0).noise / cast.setting.length;
    let search_end = cast.options().before.unwrap_or(f64::INFINITY).min(limit + margin);
    cast.with_options(cast.options().with_before(search_end))?.clearance()
}
