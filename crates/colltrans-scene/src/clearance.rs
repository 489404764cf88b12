//! How far a body can move before one of many stops it.

use glam::DVec3;

use super::boxes::Sweep;
use super::obstacles::Obstacle;
use super::{Among, AmongSteps, ByKind};
use colltrans_convex::answer::Clearance;
use colltrans_convex::body::ObstacleId;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::setting::{check_direction, check_length};
use colltrans_solid::Solid;
use colltrans_solid::kinds::AnyClearance;
use colltrans_solid::{SolidCast, SolidScene};

/// Searches between solids end so many noises beyond the best answer: more than their bounds are off.
const BEYOND: f64 = 64.0;

/// The answer of [`Among::clearance`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ClearanceAmong {
    /// No obstacle stops the moving body before, in multiples of the direction: infinite where none ever
    /// does, or the end that was asked for; 0 if it overlaps an obstacle now.
    #[cfg_attr(feature = "serde", serde(with = "colltrans_kernel::written::or_infinite"))]
    pub lower: f64,
    /// What stops it, [`Clearance::Blocked`], or overlaps it, [`Clearance::Overlapping`]: the obstacle whose
    /// upper bound is least; of equal ones, and of those that overlap, the one that came first.
    pub stop: Option<(ObstacleId, AnyClearance)>,
    /// Work done.
    pub steps: AmongSteps,
}

impl ClearanceAmong {
    /// How far the moving body may safely move, past all obstacles, in multiples of the direction: infinite
    /// where nothing stops it, `None` if it overlaps an obstacle now.
    pub fn distance(&self) -> Option<f64> {
        let overlaps = self.stop.is_some_and(|(_, stop)| stop.distance().is_none());
        (!overlaps).then_some(self.lower)
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
