//! The smallest set of parts whose removal takes selected parts out.
//!
//! A set that contains the selected parts is *sufficient* if they leave when all its removable subsets are removed
//! repeatedly. An insufficient set is extended by all parts that block one of its remaining parts along one
//! direction. Sets are tried in order of size, so the first sufficient set is a smallest one.
//! `docs/theory/disassembly.md` shows that no sufficient set is missed.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

use glam::DVec3;

use crate::bodies::Bodies;
use crate::constraints::RigidUnit;
use crate::matrix::ContactMatrix;

/// Maximum number of sets that are tried, and of 64-bit words that they take together.
const MAX_SETS: usize = 20_000;
const MAX_WORDS: usize = 1 << 22;

/// A sufficient set of parts.
pub(super) struct SufficientSet {
    pub(super) parts: Vec<usize>,
    /// Whether no smaller set suffices along the directions of the matrix.
    pub(super) least: bool,
}

/// Returns a smallest set that contains the selected parts and suffices to take them out along the directions of a
/// matrix.
///
/// The set contains no part of the base. Returns `None` if no set was found to suffice, or if all parts are selected.
/// After [`MAX_SETS`] sets, or [`MAX_WORDS`] words of sets, the search becomes greedy, and `least` is false.
pub(super) fn smallest_sufficient_set(
    bodies: &Bodies,
    matrix: &ContactMatrix,
    wanted: &[usize],
    is_base: &[bool],
) -> Option<SufficientSet> {
    if wanted.len() >= bodies.len() {
        return None;
    }
    let search = SubsetSearch::new(bodies, matrix, wanted, is_base);
    let first = PartSet::from_parts(wanted, bodies.len());
    let mut queue = BinaryHeap::from([Reverse((first.len(), first.clone()))]);
    let mut seen = HashSet::from([first]);
    let words = bodies.len().div_ceil(64);
    let mut best: Option<PartSet> = None;
    while let Some(Reverse((_, set))) = queue.pop() {
        let left = match search.try_removal(&set) {
            TrialOutcome::Enough => {
                return Some(SufficientSet { parts: set.to_parts(), least: best.is_none() });
            }
            TrialOutcome::Left(left) => left,
        };
        let over = seen.len() >= MAX_SETS || seen.len() * words >= MAX_WORDS;
        if over {
            // From here on only the smallest addition is followed. This is fast, but the result need not be a
            // smallest set.
            best = Some(set.clone());
            queue.clear();
        }
        for larger in search.larger_sets(&set, &left) {
            if seen.insert(larger.clone()) {
                queue.push(Reverse((larger.len(), larger)));
            }
            if best.is_some() {
                break;
            }
        }
    }
    None
}

/// A set of parts, with one bit for each part.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct PartSet(Vec<u64>);

impl PartSet {
    fn from_parts(parts: &[usize], count: usize) -> Self {
        let mut set = Self(vec![0; count.div_ceil(64)]);
        for &part in parts {
            set.add(part);
        }
        set
    }

    fn add(&mut self, part: usize) {
        self.0[part / 64] |= 1 << (part % 64);
    }

    fn contains(&self, part: usize) -> bool {
        self.0[part / 64] >> (part % 64) & 1 == 1
    }

    fn len(&self) -> usize {
        self.0.iter().map(|word| word.count_ones() as usize).sum()
    }

    fn to_parts(&self) -> Vec<usize> {
        (0..64 * self.0.len()).filter(|&part| self.contains(part)).collect()
    }

    fn is_superset_of(&self, other: &Self) -> bool {
        self.0.iter().zip(&other.0).all(|(a, b)| a & b == *b)
    }
}

enum TrialOutcome {
    Enough,
    /// The mask of present parts when no further part of the set can leave.
    Left(Vec<bool>),
}

struct SubsetSearch<'a> {
    wanted: &'a [usize],
    /// For each direction and part, its blockers and the parts that must leave before it. `None` if the part must not
    /// move along the direction.
    blockers: Vec<Vec<Option<Vec<usize>>>>,
    /// Parts that leave as one body.
    units: &'a [RigidUnit],
    /// The base, which does not move.
    fixed: Vec<bool>,
}

impl<'a> SubsetSearch<'a> {
    fn new(
        bodies: &Bodies<'a>,
        matrix: &ContactMatrix,
        wanted: &'a [usize],
        is_base: &[bool],
    ) -> Self {
        let (count, assembly) = (bodies.len(), bodies.assembly());
        let constraints = assembly.constraints();
        let along = |(k, d): (usize, &DVec3)| {
            let mut met: Vec<Option<Vec<usize>>> = (0..count)
                .map(|part| constraints.allows_direction(&[part], *d).then(Vec::new))
                .collect();
            let arcs = matrix.contacts_along(k).iter().map(|m| (m.moving, m.fixed));
            for (a, b) in arcs.chain(constraints.order_pairs().iter().map(|&[a, b]| (b, a))) {
                if let Some(met) = &mut met[a] {
                    met.push(b);
                }
            }
            met
        };
        let blockers = matrix.directions().iter().enumerate().map(along).collect();
        Self { wanted, blockers, units: constraints.units(), fixed: is_base.to_vec() }
    }

    /// Removes the removable subsets of a set repeatedly, and checks whether the selected parts leave.
    fn try_removal(&self, set: &PartSet) -> TrialOutcome {
        let mut present = vec![true; self.fixed.len()];
        let parts = set.to_parts();
        loop {
            let before = present.iter().filter(|t| **t).count();
            for met in &self.blockers {
                let mut leaving = vec![false; present.len()];
                for &part in &parts {
                    leaving[part] = present[part] && !self.fixed[part] && met[part].is_some();
                }
                let units: Vec<&RigidUnit> =
                    self.units.iter().filter(|unit| !unit.is_released(&present)).collect();
                let held = |part: usize, leaving: &[bool]| {
                    let stays = |&by: &usize| present[by] && !leaving[by];
                    let with = units.iter().filter(|unit| unit.parts.contains(&part));
                    let mut met = met[part].iter().flatten();
                    met.any(stays) || with.flat_map(|unit| &unit.parts).any(stays)
                };
                while let Some(&part) =
                    parts.iter().find(|&&part| leaving[part] && held(part, &leaving))
                {
                    leaving[part] = false;
                }
                for part in 0..present.len() {
                    present[part] &= !leaving[part];
                }
            }
            if !self.wanted.iter().any(|&part| present[part]) {
                return TrialOutcome::Enough;
            }
            if present.iter().filter(|t| **t).count() == before {
                return TrialOutcome::Left(present);
            }
        }
    }

    /// Returns the extensions of a set, smallest first. Omits sets that contain another one.
    fn larger_sets(&self, set: &PartSet, present: &[bool]) -> Vec<PartSet> {
        let mut found: Vec<PartSet> = Vec::new();
        let mut add = |parts: &mut dyn Iterator<Item = usize>| {
            let (mut larger, mut free) = (set.clone(), true);
            for part in parts.filter(|&part| present[part]) {
                larger.add(part);
                free &= !self.fixed[part];
            }
            // At least one part must stay.
            if free && larger != *set && larger.len() < present.len() && !found.contains(&larger) {
                found.push(larger);
            }
        };
        for part in set.to_parts().into_iter().filter(|&part| present[part]) {
            let with = || self.units.iter().filter(|unit| unit.parts.contains(&part));
            for met in self.blockers.iter().filter_map(|met| met[part].as_ref()) {
                let as_one = with().filter(|unit| !unit.is_released(present));
                let as_one = as_one.flat_map(|unit| unit.parts.iter().copied());
                add(&mut met.iter().copied().chain(as_one));
            }
            for unit in with().filter(|unit| unit.is_subassembly) {
                add(&mut (0..present.len()).filter(|part| !unit.parts.contains(part)));
            }
        }
        found.sort_by_key(|set| (set.len(), set.clone()));
        let mut least: Vec<PartSet> = Vec::new();
        for set in found {
            if !least.iter().any(|smaller| set.is_superset_of(smaller)) {
                least.push(set);
            }
        }
        least
    }
}
