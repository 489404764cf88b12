//! Overlaps of the parts as the files have them, how deep they are, and which tolerance lets them
//! pass.

use rayon::prelude::*;

use crate::bodies::{Bodies, two_digits_up};
use crate::error::AssemblyError;
use crate::watch::{Stage, Watch};

/// Two parts that overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Overlap {
    /// Positions of the parts, the smaller first.
    pub parts: [usize; 2],
    /// The least tolerance with which they do not; `None` if there is none up to their size.
    pub depth: Option<f64>,
    /// Whether they still overlap with the fit that is asked about.
    pub remains: bool,
}

impl Overlap {
    /// Whether it is small against both parts: else it is no tolerance, but a fault of the model.
    pub(crate) fn is_shallow(&self, bodies: &Bodies) -> bool {
        self.is_within(bodies, LARGEST_SHARE)
    }

    /// Whether its depth is at most such a share of the thickness of both parts.
    pub(crate) fn is_within(&self, bodies: &Bodies, share: f64) -> bool {
        let thin = self.parts.map(|k| bodies.bounds(k).size().min_element());
        self.depth.is_some_and(|depth| depth <= share * thin[0].min(thin[1]))
    }
}

/// How the assembly starts.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Start {
    /// Pairs that overlap as the files have them, deepest first.
    pub overlaps: Vec<Overlap>,
    /// A tolerance with which no pair overlaps: a little more than the deepest, two digits, if that
    /// is small against the parts; `None` if there is nothing to suggest.
    pub suggested: Option<f64>,
}

/// A tolerance larger than this share of a part's box is no tolerance, but a fault of the model.
const LARGEST_SHARE: f64 = 0.1;

impl Start {
    /// Looks at all pairs.
    ///
    /// # Errors
    /// Cancelled; too many parts lie within each other's boxes.
    pub fn new(bodies: &Bodies, watch: Watch) -> Result<Self, AssemblyError> {
        let mut pairs = bodies.neighbours(0.0)?;
        pairs.retain(|&[a, b]| bodies.assembly().ignored(a, b).is_none());
        let tally = watch.stage(Stage::Start, pairs.len());
        let look = |&[a, b]: &[usize; 2]| {
            let remains = bodies.overlaps(a, b);
            let given = bodies.overlap_as_given(a, b);
            let overlap = (remains || given.is_some()).then_some(Overlap {
                parts: [a, b],
                depth: given.unwrap_or(Some(0.0)),
                remains,
            });
            tally.step().map(|()| overlap)
        };
        let found: Result<Vec<Option<Overlap>>, AssemblyError> =
            pairs.par_iter().map(look).collect();
        let mut overlaps: Vec<Overlap> = found?.into_iter().flatten().collect();
        let key = |o: &Overlap| o.depth.unwrap_or(f64::INFINITY);
        overlaps.sort_by(|x, y| key(y).total_cmp(&key(x)).then(x.parts.cmp(&y.parts)));
        let suggested = suggest(bodies, &overlaps);
        Ok(Self { overlaps, suggested })
    }

    /// Pairs that overlap even with the fit asked about.
    pub fn remaining(&self) -> impl Iterator<Item = &Overlap> {
        self.overlaps.iter().filter(|o| o.remains)
    }
}

fn suggest(bodies: &Bodies, overlaps: &[Overlap]) -> Option<f64> {
    let deepest = overlaps
        .iter()
        .filter(|o| o.is_shallow(bodies))
        .filter_map(|o| o.depth)
        // What is rounded off goes without saying.
        .filter(|depth| *depth > bodies.noise())
        .reduce(f64::max)?;
    Some(two_digits_up(deepest * 1.05))
}

#[cfg(test)]
mod tests {
    use super::two_digits_up;

    #[test]
    fn two_digits() {
        assert_eq!(two_digits_up(0.0519), 0.052);
        assert_eq!(two_digits_up(0.052), 0.052);
        assert_eq!(two_digits_up(1.21e-7), 1.3e-7);
        assert_eq!(two_digits_up(99.5), 100.0);
        assert_eq!(two_digits_up(123.0), 130.0);
        assert_eq!(two_digits_up(0.0), 0.0);
    }
}
