//! Penetration depths of two placed convex bodies.
//!
//! `R` is the sum of the radii, 0 for bodies that are not rounded. The depth is
//!
//! - `R - d` if the cores are apart by `d`, 0 if that is negative,
//! - `R` plus the depth of the cores if they overlap.
//!
//! Both hold because the boundary of `M + B(R)` is at the distance `R` from the convex set `M`.

use super::convex::MAX_BOUND_GAP;
use super::verify::depth_by_points;
use super::{Pair, rounded};
use crate::answer::{Depth, Enclosure, Steps};
use crate::setting::error::{QueryError, Stalled};
use crate::solve::nearest::{
    DescentResult, Difference, GapPlane, nearest_points, penetration_depth,
};

impl Pair<'_> {
    /// Computes the penetration depth: the length of the shortest translation, in any direction, that
    /// separates the bodies.
    ///
    /// The bounds hold exactly, and differ by a few noises. Both are 0 if a plane is proven to separate the bodies. The
    /// lower one is 0 if they touch, or are flat in a common plane.
    ///
    /// # Errors
    /// Returns [`QueryError::NotConverged`] if the search ends without an answer.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{ConvexPolyhedron, Pair, Pose};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let there = Pose::from_translation(DVec3::new(0.75, 0.5, 0.5))?;
    /// let pair = Pair::new(cube.at(Pose::IDENTITY), cube.at(there))?;
    /// let depth = pair.depth()?;
    /// assert!(depth.lower <= 0.25 && 0.25 <= depth.upper && depth.upper < 0.25 + 1e-13);
    /// assert_eq!(depth.direction, DVec3::NEG_X);
    /// assert!(pair.verify(&depth)? >= depth.lower);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn depth(&self) -> Result<Depth, QueryError> {
        self.depth_until(f64::INFINITY)
    }

    /// Computes the penetration depth as [`Self::depth`] does, but ends as soon as the lower bound exceeds
    /// `enough`, in world units. The bounds may differ by any amount then.
    ///
    /// # Errors
    /// Returns [`QueryError::NotConverged`] if the search ends without an answer.
    #[doc(hidden)]
    #[inline]
    pub fn depth_until(&self, enough: f64) -> Result<Depth, QueryError> {
        let difference = Difference::new(&self.bodies);
        let mut found = nearest_points(&difference, &difference.depth_start(), None);
        found.supports += 1;
        match found.gap_plane(&difference).filter(|plane| plane.gap.gap > 0.0) {
            Some(plane) => depth_between_cores(&difference, &found, &plane, enough),
            None => depth_of_overlapping_cores(&difference, &found, enough),
        }
    }
}

/// Returns the depth of bodies whose cores are separated by a plane.
fn depth_between_cores(
    difference: &Difference,
    found: &DescentResult,
    plane: &GapPlane,
    enough: f64,
) -> Result<Depth, QueryError> {
    let [_, radii] = difference.bodies.core_gap_bounds(0.0);
    let upper = if plane.gap.gap < radii { (radii - plane.gap.gap).next_up() } else { 0.0 };
    let (direction, enclosure) = (-plane.gap.normal, Enclosure::default());
    let mut depth =
        Depth { lower: 0.0, upper, direction, enclosure, near: None, steps: found.steps() };
    if upper > 0.0 {
        let rounding = 8.0 * f64::EPSILON * radii;
        depth = with_near_points(difference, found, depth);
        check_bounds(difference, &depth, plane.excess + rounding, enough)?;
    }
    Ok(depth)
}

/// Returns the depth of bodies whose cores overlap, or touch.
fn depth_of_overlapping_cores(
    difference: &Difference,
    found: &DescentResult,
    enough: f64,
) -> Result<Depth, QueryError> {
    let bodies = difference.bodies;
    let [least, most] = bodies.core_gap_bounds(0.0);
    let cores = penetration_depth(difference, found, enough - least);
    let depth = Depth {
        lower: cores.lower,
        upper: cores.upper,
        direction: cores.outward,
        enclosure: cores.enclosure,
        near: None,
        steps: Steps { supports: cores.supports, ..Steps::default() },
    };
    check_bounds(difference, &depth, cores.excess, enough - least)?;
    if !bodies.is_rounded() {
        return Ok(depth);
    }
    let depth = Depth { upper: (depth.upper + most).next_up(), ..depth };
    if depth.lower > 0.0 {
        return Ok(Depth { lower: (depth.lower + least).next_down(), ..depth });
    }
    Ok(with_near_points(difference, found, depth))
}

/// Returns a depth with the lower bound that the nearest points of the cores prove, if it is positive.
fn with_near_points(difference: &Difference, found: &DescentResult, depth: Depth) -> Depth {
    let bodies = difference.bodies;
    let near = found.near_points(difference);
    match depth_by_points(bodies, &near) {
        Ok(lower) if lower > 0.0 => {
            Depth { lower, near: Some(rounded::near_points(bodies, near)), ..depth }
        }
        _ => depth,
    }
}

/// Checks that the bounds of a depth are near, or that the lower one exceeds `enough`. `excess` is the reach of the
/// bodies beyond support points.
///
/// Returns [`QueryError::NotConverged`] otherwise.
fn check_bounds(
    difference: &Difference,
    depth: &Depth,
    excess: f64,
    enough: f64,
) -> Result<(), QueryError> {
    let &Depth { lower, upper, .. } = depth;
    let tolerance = MAX_BOUND_GAP * difference.noise.point_error() + excess;
    if lower <= enough && upper - lower > tolerance {
        let reason = Stalled::Distance { lower, upper, tolerance };
        return Err(QueryError::NotConverged { reason });
    }
    Ok(())
}
