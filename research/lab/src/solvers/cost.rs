//! Instructions of a query, estimated from its counts.
//!
//! A query of an algorithm takes about `base + step * steps + iteration * iterations` instructions. The three numbers
//! are fitted to counts of callgrind by `research/lab/instructions.py`, which prints them with the deviations. Claims
//! about the growth and the ratios of costs are judged by these estimates, because unlike times they do not depend on
//! the machine and its load.

use colltrans_baselines::egjk::SupportSearch;

use super::{Answer, Until, Who, Work};

impl Who {
    /// Estimates the instructions of a query.
    pub(crate) fn instructions(self, work: Work) -> f64 {
        let [base, step, iteration] = self.costs(work.answer == Answer::Pass);
        base + step * f64::from(work.steps) + iteration * f64::from(work.iterations)
    }

    /// Returns the instructions of a query without a step, of a step, and of an iteration. Steps of CTA from scratch
    /// cost less if the bodies pass each other, because they lack the cell and the exit test.
    fn costs(self, passes: bool) -> [f64; 3] {
        match self {
            // Of 200 and 3,200 vertices (off by at most 12 % at all sizes). Bodies that pass closely take 5 steps at
            // any size, so a fit to all sizes has no cost of a step, which would be wrong for bodies far apart.
            Self::Cta(_) | Self::CtaCentroid if passes => [7090.8, 4878.0, 131.5],
            Self::Cta(Until::End) | Self::CtaCentroid => [39302.2, 1778.6, 223.4],
            Self::Cta(Until::Near) => [44139.4, 0.0, 216.9],
            Self::Cta(Until::EndAcrossCells) => [39756.9, 0.0, 279.8],
            Self::CtaColdScratch if passes => [15164.9, 0.0, 185.4],
            Self::CtaColdScratch => [27775.1, 0.0, 243.0],
            Self::CtaRegion(..) => [6030.3, 6740.3, 228.7],
            Self::CtaCold(_) => [6097.9, 4747.8, 196.4],
            Self::Portal => [2072.1, 0.0, 1270.6],
            Self::Tracker => [529.3, 177.6, 1036.1],
            Self::Egjk(SupportSearch::FirstVertex) => [0.0, 1467.8, 146.7],
            Self::EgjkTracked => [0.0, 900.5, 146.6],
            Self::Egjk(SupportSearch::Climbing) => [0.0, 1054.5, 146.6],
            Self::Egjk(SupportSearch::Linear) => [0.0, 1035.8, 14.5],
            Self::Pqp => [54723.1, 0.0, 515.2],
            Self::HWalk(_) => [2111.8, 434.9, 0.0],
            Self::VClip => [1942.5, 427.6, 0.0],
            Self::RayCast => [0.0, 1324.3, 145.7],
            Self::Intersects => [2610.8, 0.0, 1247.9],
            Self::Mpr => [999.3, 0.0, 146.2],
            Self::Growth => [0.0, 416.3, 143.3],
        }
    }
}
