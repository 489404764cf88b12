//! Bodies of a search for removal paths, with a relation for each pair.

use std::sync::atomic::AtomicBool;

use super::answer::{MAX_BODIES, RemovalSearch, SEARCH_TOLERANCE_SHARE};
use super::options::RemovalOptions;
use crate::directions::FreeError;
use colltrans_convex::body::Placed;
use colltrans_solid::body::Solid;

/// Relation of two bodies in a search for removal paths.
#[derive(Debug, Clone)]
pub enum PairRelation<'a> {
    /// The bodies never block each other.
    Ignored,
    /// The bodies always move together.
    Joined,
    /// The bodies block each other.
    Blocking(Box<BlockingPair<'a>>),
}

/// Two bodies that block each other: those of the proofs, and slightly larger ones of the search.
#[derive(Debug, Clone, Copy)]
pub struct BlockingPair<'a> {
    /// Bodies of the proofs, in the order of their indices.
    pub proven: [Placed<'a, Solid>; 2],
    /// Tolerance of the proofs. Both bodies are offset inwards by half of it.
    pub tolerance: f64,
    /// Bodies of the search.
    pub searched: [Placed<'a, Solid>; 2],
    /// Tolerance of the search.
    pub search_tolerance: f64,
    /// Difference of the gaps of both, which absorbs the rounding of placements.
    pub slack: f64,
}

impl<'a> BlockingPair<'a> {
    /// Returns the pair of two bodies with a tolerance. The search uses 0.8 of it.
    pub fn new(bodies: [Placed<'a, Solid>; 2], tolerance: f64) -> Self {
        let search_tolerance = SEARCH_TOLERANCE_SHARE * tolerance;
        let slack = (1.0 - SEARCH_TOLERANCE_SHARE) * tolerance;
        Self { proven: bodies, tolerance, searched: bodies, search_tolerance, slack }
    }

    /// Returns the pair of two bodies that are offset already. The search uses the same bodies.
    pub fn without_slack(bodies: [Placed<'a, Solid>; 2]) -> Self {
        Self { proven: bodies, tolerance: 0.0, searched: bodies, search_tolerance: 0.0, slack: 0.0 }
    }
}

/// Bodies of a search, the relation of each pair, the bodies that do not move, and those that may leave.
#[derive(Debug, Clone)]
pub struct RemovalScene<'a> {
    pub(super) bodies: Vec<Placed<'a, Solid>>,
    /// Relation of the bodies `i < j` at index `j (j - 1) / 2 + i`.
    relations: Vec<PairRelation<'a>>,
    pub(super) fixed: Vec<usize>,
    pub(super) leaving: Option<Vec<usize>>,
}

impl<'a> RemovalScene<'a> {
    /// Builds the scene of some bodies. `relation` returns the relation of the bodies `i < j`.
    pub fn new(
        bodies: Vec<Placed<'a, Solid>>,
        mut relation: impl FnMut(usize, usize) -> PairRelation<'a>,
    ) -> Self {
        let pairs = (1..bodies.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
        let relations = pairs.map(|(i, j)| relation(i, j)).collect();
        Self { bodies, relations, fixed: Vec::new(), leaving: None }
    }

    /// Builds the scene of bodies that all block each other, with one tolerance.
    pub fn with_tolerance(bodies: &[Placed<'a, Solid>], tolerance: f64) -> Self {
        Self::new(bodies.to_vec(), |i, j| {
            let pair = BlockingPair::new([bodies[i], bodies[j]], tolerance);
            PairRelation::Blocking(Box::new(pair))
        })
    }

    /// Returns the scene with bodies that do not move. The first one is the base.
    #[must_use]
    pub fn with_fixed(self, fixed: &[usize]) -> Self {
        Self { fixed: fixed.to_vec(), ..self }
    }

    /// Returns the scene with the bodies that the last leg may remove. By default all may leave.
    #[must_use]
    pub fn with_leaving(self, leaving: &[usize]) -> Self {
        Self { leaving: Some(leaving.to_vec()), ..self }
    }

    /// Searches for a removal path of some bodies. All that are not fixed may move, alone or together.
    ///
    /// Motions are relative to a *base*, which is the first fixed body, or otherwise the largest one. Among more than
    /// two bodies, those that overlap at the start move together. Open shells block by their facets. For fewer than
    /// two or more than 127 bodies the answer is [`RemovalSearch::NotFound`] without a search. The tolerance of
    /// `options` is not used.
    ///
    /// # Errors
    /// Returns [`FreeError::Query`] for bodies or options that a cast rejects, [`FreeError::Overlapping`] if two
    /// bodies overlap at the start, and [`FreeError::Cancelled`] after the flag is set.
    pub fn search(
        &self,
        options: &RemovalOptions,
        cancel: Option<&AtomicBool>,
    ) -> Result<RemovalSearch, FreeError> {
        RemovalSearch::search_scene(self, options, cancel)
    }

    /// Returns the bodies of the proofs of the first pair that blocks each other, in the order of their indices.
    pub fn first_proven_pair(&self) -> Option<[Placed<'a, Solid>; 2]> {
        self.blocking_pairs().next().map(|pair| pair.proven)
    }

    /// Returns the number of bodies.
    pub(super) fn count(&self) -> usize {
        self.bodies.len()
    }

    /// Returns the relation of two different bodies, and whether they are in reversed order.
    pub(super) fn relation(&self, [i, j]: [usize; 2]) -> (&PairRelation<'a>, bool) {
        let (low, high) = (i.min(j), i.max(j));
        (&self.relations[high * (high - 1) / 2 + low], i > j)
    }

    /// Returns the bodies of the proofs, in this order, with their tolerance. Returns `None` for pairs that do not
    /// block each other.
    pub(super) fn proven_pair(&self, pair: [usize; 2]) -> Option<([Placed<'a, Solid>; 2], f64)> {
        let (relation, reversed) = self.relation(pair);
        let PairRelation::Blocking(pair) = relation else { return None };
        let [a, b] = pair.proven;
        Some((if reversed { [b, a] } else { [a, b] }, pair.tolerance))
    }

    /// Checks whether two bodies always move together.
    pub(super) fn is_joined(&self, pair: [usize; 2]) -> bool {
        matches!(self.relation(pair).0, PairRelation::Joined)
    }

    /// Iterates over the pairs that block each other.
    pub(super) fn blocking_pairs(&self) -> impl Iterator<Item = &BlockingPair<'a>> {
        self.relations.iter().filter_map(|relation| match relation {
            PairRelation::Blocking(pair) => Some(&**pair),
            _ => None,
        })
    }

    /// Returns the pairs of a moving group that need a proof. Returns `None` if the group separates joined bodies.
    pub(super) fn pairs_to_prove(&self, pairs: Vec<[usize; 2]>) -> Option<Vec<[usize; 2]>> {
        let separated = pairs.iter().any(|&pair| self.is_joined(pair));
        let blocking = |pair: &[usize; 2]| self.proven_pair(*pair).is_some();
        (!separated).then(|| pairs.into_iter().filter(blocking).collect())
    }

    /// Checks that there are not too many bodies.
    pub(super) fn has_valid_count(&self) -> bool {
        (2..=MAX_BODIES).contains(&self.bodies.len())
    }
}
