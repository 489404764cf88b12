//! Relations of two parts in searches for removal paths of several moves.

use colltrans::removal::path::{BlockingPair, PairRelation};
use colltrans::solid::StartOverlap;
use colltrans::{Placed, Pose, Solid};

use super::{Bodies, Fit};
use crate::part::Ignored;
use crate::roles::PairTolerance;

/// Tolerance of the search for pairs with an ignored overlap, as a fraction of the tolerance that removes the overlap.
/// The tolerance exceeds the least one by 5 %, so the pair is apart in the search too.
const IGNORED_SEARCH_SHARE: f64 = 0.98;

/// Returns two solids in the world frame.
fn placed(solids: [&Solid; 2]) -> [Placed<'_, Solid>; 2] {
    solids.map(|solid| solid.at(Pose::IDENTITY))
}

impl Bodies<'_> {
    /// Returns the relation of two parts `a < b` in a search for removal paths.
    ///
    /// - Pairs whose contacts are all ignored never block each other, and glued parts move together.
    /// - Pairs that overlap move together. If their overlap is ignored, a tolerance that removes it applies instead, if
    ///   there is one. So no later overlap is deeper than the one at the start.
    /// - Other pairs block each other with the bodies of the pair. Snap fits have no exception here.
    pub(crate) fn path_relation(&self, pair: [usize; 2], start: StartOverlap) -> PairRelation<'_> {
        let [a, b] = pair;
        if self.tolerated_contacts(pair) == Some(PairTolerance::Glued) {
            return PairRelation::Joined;
        }
        if self.assembly.ignored_contacts(a, b) == Some(Ignored::Always) {
            return PairRelation::Ignored;
        }
        let shrunk = placed(self.pair_solids(pair));
        if self.overlaps(a, b) {
            let ignored = self.pair_start_overlap(a, b, start) == StartOverlap::Ignore;
            let known = || self.passing.get(&pair).copied();
            let tolerance = ignored.then(|| known().or_else(|| self.overlap_free_tolerance(pair)));
            return match tolerance.flatten() {
                None => PairRelation::Joined,
                Some(tolerance) => {
                    let search_tolerance = IGNORED_SEARCH_SHARE * tolerance;
                    let slack = tolerance - search_tolerance;
                    PairRelation::Blocking(Box::new(BlockingPair {
                        proven: shrunk,
                        tolerance,
                        searched: shrunk,
                        search_tolerance,
                        slack,
                    }))
                }
            };
        }
        PairRelation::Blocking(Box::new(match self.pair_fit(pair) {
            Fit::Tolerance(tolerance) => {
                let given = [self.unshrunk_solid([a, b]), self.unshrunk_solid([b, a])];
                BlockingPair::new(placed(given), tolerance)
            }
            // Each body is shrunk by its own length. The search uses the same bodies.
            Fit::Chords { .. } | Fit::MinGap(_) => BlockingPair::without_slack(shrunk),
        }))
    }
}
