//! Which obstacle is nearest, which are closer than a length, and which stops the moving body first.

use glam::DVec3;

use super::boxes;
use super::boxes::Sweep;
use super::obstacles::Obstacle;
use super::{Among, AmongSteps, ByKind, ClearanceAmong, Nearby, Nearest};
use colltrans_convex::answer::{Clearance, Within};
use colltrans_convex::body::ObstacleId;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::setting::{check_direction, check_length};
use colltrans_solid::Solid;
use colltrans_solid::kinds::{AnyClearance, AnyDistance, AnyNear};
use colltrans_solid::{SolidCast, SolidScene};

/// Searches between solids end so many noises beyond the best answer: more than their bounds are off.
const BEYOND: f64 = 64.0;

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

impl Among<'_> {
    /// How far can the moving body move from where it is, along a direction of any length, and what stops it?
    ///
    /// As [`Cast::clearance`] of each obstacle: what is behind does not stop it, nor what it slides along
    /// within the graze tolerance; obstacles whose boxes are never met ahead do not at all. For "the first
    /// that is hit within a way" see [`Self::clearance_before`].
    ///
    /// # Errors
    /// A direction that is zero, not finite or out of range; and as [`Cast::clearance`] of an obstacle that
    /// is asked about.
    pub fn clearance(&self, direction: DVec3) -> Result<ClearanceAmong, QueryError> {
        self.clearance_before(direction, f64::INFINITY)
    }

    /// The same up to an end, in multiples of the direction: what is not met before it for certain, by its
    /// upper bound, is of no interest.
    ///
    /// # Errors
    /// An end that is negative or not a number; and as [`Self::clearance`].
    pub fn clearance_before(
        &self,
        direction: DVec3,
        end: f64,
    ) -> Result<ClearanceAmong, QueryError> {
        check_direction(direction)?;
        check_length(end)?;
        let sweep = Sweep::new(self.swept(), direction);
        let mut stop: Option<(ObstacleId, AnyClearance)> = None;
        let (mut lower, mut upper, mut bodies) = (end, end, 0);
        let entry = |other: &_| sweep.entry(other);
        let boxes = self.obstacles.tree().search(end, entry, |item, bound| {
            let obstacle = self.obstacle(item);
            let (id, first) = (obstacle.id, stop.map_or(ObstacleId(0), |(first, _)| first));
            // A bound of 0 says nothing: the bodies may overlap.
            let is_no_better = upper == f64::NEG_INFINITY || (bound > 0.0 && bound == upper);
            if (is_no_better && id > first) || self.is_ignored(id) {
                return Ok(upper.max(0.0));
            }
            bodies += 1;
            let found = self.clearance_of(obstacle, direction, upper.max(0.0));
            let found = found.map_err(|e| e.of_obstacle(id))?;
            lower = lower.min(found.distance().unwrap_or(0.0));
            if (found.upper(), id) < (upper, first) {
                (stop, upper) = (Some((id, found)), found.upper());
            }
            Ok::<_, QueryError>(upper.max(0.0))
        })?;
        Ok(ClearanceAmong { lower, stop, steps: AmongSteps { boxes, bodies } })
    }

    /// The clearance of one obstacle, of interest if it is below a limit.
    fn clearance_of(
        &self,
        obstacle: &Obstacle,
        direction: DVec3,
        limit: f64,
    ) -> Result<AnyClearance, QueryError> {
        Ok(match self.cast(obstacle, direction)? {
            ByKind::Convex(cast) => ByKind::Convex(cast.clearance()?),
            ByKind::Solid(cast) => ByKind::Solid(clearance_below(&cast, limit)?),
        })
    }
}

/// The clearance of two solids, or that they are free where it is clearly not below a limit.
///
/// Searches end by where shrunk bodies meet. Those that meet in their true place before the limit may do so, shrunk, any
/// way behind it, if their facets are all but along the direction: the limit is of use without a tolerance only.
fn clearance_below(cast: &Cast<'_, Solid>, limit: f64) -> Result<Clearance<Solid>, QueryError> {
    if limit == f64::INFINITY || cast.tolerance() > 0.0 {
        return cast.clearance();
    }
    let beyond = BEYOND * cast.scene(0.0).noise / cast.setting.length;
    let before = cast.options().before.unwrap_or(f64::INFINITY).min(limit + beyond);
    cast.with_options(cast.options().with_before(before))?.clearance()
}
