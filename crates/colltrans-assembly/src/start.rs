//! Overlaps of the parts as given in the files: their depths, and a tolerance that removes them.

use rayon::prelude::*;

use crate::bodies::{Bodies, two_digits_up};
use crate::error::AssemblyError;
use crate::watch::{Stage, Watch};

/// Two parts that overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Overlap {
    /// Indices of the parts, the smaller first.
    pub parts: [usize; 2],
    /// The least tolerance with which the parts do not overlap; `None` if no tolerance up to their size
    /// suffices. It is 0 if they overlap only with the requested fit.
    pub depth: Option<f64>,
    /// Whether the parts still overlap with the requested fit.
    pub remains_with_fit: bool,
}

impl Overlap {
    /// Checks whether the depth is at most [`MAX_TOLERANCE_SHARE`] of the thickness of both parts. A deeper
    /// overlap counts as a fault of the model.
    pub(crate) fn is_shallow(&self, bodies: &Bodies) -> bool {
        self.is_at_most_share(bodies, MAX_TOLERANCE_SHARE)
    }

    /// Checks whether the depth is at most `share` of the thickness of both parts. The thickness is the
    /// smallest side of a part's box.
    pub(crate) fn is_at_most_share(&self, bodies: &Bodies, share: f64) -> bool {
        let thicknesses = self.parts.map(|k| bodies.bounds(k).side_lengths().min_element());
        self.depth.is_some_and(|depth| depth <= share * thicknesses[0].min(thicknesses[1]))
    }
}

/// Overlaps of an assembly at the start.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Start {
    /// Pairs that overlap as given in the files, or with the requested fit, deepest first.
    pub overlaps: Vec<Overlap>,
    /// Tolerance with which no shallow overlap remains: 5 % above the deepest shallow overlap, rounded up to
    /// two digits. `None` if there is no shallow overlap above the noise.
    pub suggested_tolerance: Option<f64>,
}

/// Maximum depth of a shallow overlap, as a share of the thickness of both parts.
const MAX_TOLERANCE_SHARE: f64 = 0.1;

impl Start {
    /// Finds the overlaps of all pairs that are not ignored.
    ///
    /// # Errors
    /// [`AssemblyError::Cancelled`], and [`AssemblyError::TooMany`] if too many boxes of parts intersect.
    pub fn new(bodies: &Bodies, watch: Watch) -> Result<Self, AssemblyError> {
        let mut pairs = bodies.neighbouring_pairs(0.0)?;
        pairs.retain(|&[a, b]| bodies.assembly().ignored_contacts(a, b).is_none());
        let tally = watch.start_stage(Stage::Start, pairs.len());
        let examine = |&[a, b]: &[usize; 2]| {
            let remains = bodies.overlaps(a, b);
            let given = bodies.least_tolerance(a, b);
            let overlap = (remains || given.is_some()).then_some(Overlap {
                parts: [a, b],
                depth: given.unwrap_or(Some(0.0)),
                remains_with_fit: remains,
            });
            tally.finish_item().map(|()| overlap)
        };
        let found: Result<Vec<Option<Overlap>>, AssemblyError> =
            pairs.par_iter().map(examine).collect();
        let mut overlaps: Vec<Overlap> = found?.into_iter().flatten().collect();
        let depth_of = |o: &Overlap| o.depth.unwrap_or(f64::INFINITY);
        overlaps.sort_by(|x, y| depth_of(y).total_cmp(&depth_of(x)).then(x.parts.cmp(&y.parts)));
        let suggested = suggested_tolerance(bodies, &overlaps);
        Ok(Self { overlaps, suggested_tolerance: suggested })
    }

    /// Iterates over the pairs that overlap even with the requested fit.
    pub fn remaining(&self) -> impl Iterator<Item = &Overlap> {
        self.overlaps.iter().filter(|o| o.remains_with_fit)
    }
}

/// Returns the tolerance for [`Start::suggested_tolerance`].
fn suggested_tolerance(bodies: &Bodies, overlaps: &[Overlap]) -> Option<f64> {
    let deepest = overlaps
        .iter()
        .filter(|o| o.is_shallow(bodies))
        .filter_map(|o| o.depth)
        // Overlaps within the noise need no suggestion.
        .filter(|depth| *depth > bodies.noise())
        .reduce(f64::max)?;
    Some(two_digits_up(deepest * 1.05))
}

#[cfg(test)]
mod tests {
    use super::two_digits_up;

    #[test]
    fn two_digits_up_rounds_up_to_two_significant_digits() {
        assert_eq!(two_digits_up(0.0519), 0.052);
        assert_eq!(two_digits_up(0.052), 0.052);
        assert_eq!(two_digits_up(1.21e-7), 1.3e-7);
        assert_eq!(two_digits_up(99.5), 100.0);
        assert_eq!(two_digits_up(123.0), 130.0);
        assert_eq!(two_digits_up(0.0), 0.0);
    }
}
