//! The least that has to go for some parts to come out.
//!
//! Notation: `N` are parts that go, the *wanted* ones among them. `N` is *enough* if, taking away whatever of it can
//! leave, again and again, the wanted parts have left; as what can leave stays able to leave, one try decides it. If it
//! is not, `n` in `N` that has not left, along `k`, meets some parts outside of `N`; of whatever is enough and holds `N`,
//! some `n` first leaves along some `k`, and all that it meets then goes too. (Did each leave along a direction in which
//! it meets only parts of `N`, the first of them could have left with `N` alone.) So adding what one `n` meets along one
//! `k`, of all `n` and `k` in turn, misses nothing, and of two such additions the larger one need not be tried if it holds
//! the other. Of a subassembly that is not to be taken apart before all else is gone all else is one addition more. Sets are tried in the order of their size, so the first one that is enough is a least one.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

use glam::DVec3;

use crate::bodies::Bodies;
use crate::constraints::Unit;
use crate::matrix::Matrix;
use crate::part::Part;

/// Sets that are tried, and 64-bit words that all of them may take.
const MOST_SETS: usize = 20_000;
const MOST_WORDS: usize = 1 << 22;

/// Parts that are enough.
pub(super) struct Enough {
    pub(super) parts: Vec<usize>,
    /// That no fewer are, along the directions of the matrix.
    pub(super) least: bool,
}

/// Fewest parts with these that take them out, along the directions of a matrix; `None` if none do.
pub(super) fn enough(bodies: &Bodies, matrix: &Matrix, wanted: &[usize]) -> Option<Enough> {
    if wanted.len() >= bodies.len() {
        return None;
    }
    let search = Search::new(bodies, matrix, wanted);
    let first = Set::of(wanted, bodies.len());
    let mut queue = BinaryHeap::from([Reverse((first.len(), first.clone()))]);
    let mut seen = HashSet::from([first]);
    let words = bodies.len().div_ceil(64);
    let mut best: Option<Set> = None;
    while let Some(Reverse((_, set))) = queue.pop() {
        let left = match search.tried(&set) {
            Tried::Enough => return Some(Enough { parts: set.parts(), least: best.is_none() }),
            Tried::Left(left) => left,
        };
        let over = seen.len() >= MOST_SETS || seen.len() * words >= MOST_WORDS;
        if over {
            // From here on only the smallest addition: that is quick, and need not be the least.
            best = Some(set.clone());
            queue.clear();
        }
        for larger in search.additions(&set, &left) {
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

/// Parts, a bit each.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct Set(Vec<u64>);

impl Set {
    fn of(parts: &[usize], count: usize) -> Self {
        let mut set = Self(vec![0; count.div_ceil(64)]);
        for &part in parts {
            set.add(part);
        }
        set
    }

    fn add(&mut self, part: usize) {
        self.0[part / 64] |= 1 << (part % 64);
    }

    fn has(&self, part: usize) -> bool {
        self.0[part / 64] >> (part % 64) & 1 == 1
    }

    fn len(&self) -> usize {
        self.0.iter().map(|word| word.count_ones() as usize).sum()
    }

    fn parts(&self) -> Vec<usize> {
        (0..64 * self.0.len()).filter(|&part| self.has(part)).collect()
    }

    fn holds(&self, other: &Self) -> bool {
        self.0.iter().zip(&other.0).all(|(a, b)| a & b == *b)
    }
}

enum Tried {
    Enough,
    /// Parts of the set that cannot leave, while those are there that are listed as `true`.
    Left(Vec<bool>),
}

struct Search<'a> {
    wanted: &'a [usize],
    /// By direction and part, whom it meets, and who has to go before it; `None` where it never goes.
    met: Vec<Vec<Option<Vec<usize>>>>,
    /// Parts that leave as one.
    units: &'a [Unit],
    fixed: Vec<bool>,
}

impl<'a> Search<'a> {
    fn new(bodies: &Bodies<'a>, matrix: &Matrix, wanted: &'a [usize]) -> Self {
        let (count, assembly) = (bodies.len(), bodies.assembly());
        let constraints = assembly.constraints();
        let along = |(k, d): (usize, &DVec3)| {
            let mut met: Vec<Option<Vec<usize>>> =
                (0..count).map(|part| constraints.allows(&[part], *d).then(Vec::new)).collect();
            let arcs = matrix.meetings(k).iter().map(|m| (m.moving, m.fixed));
            for (a, b) in arcs.chain(constraints.before().iter().map(|&[a, b]| (b, a))) {
                if let Some(met) = &mut met[a] {
                    met.push(b);
                }
            }
            met
        };
        let met = matrix.directions().iter().enumerate().map(along).collect();
        let fixed = assembly.parts().iter().map(Part::fixed).collect();
        Self { wanted, met, units: constraints.units(), fixed }
    }

    /// Takes away what of a set can leave, again and again.
    fn tried(&self, set: &Set) -> Tried {
        let mut there = vec![true; self.fixed.len()];
        let parts = set.parts();
        loop {
            let before = there.iter().filter(|t| **t).count();
            for met in &self.met {
                let mut leaving = vec![false; there.len()];
                for &part in &parts {
                    leaving[part] = there[part] && !self.fixed[part] && met[part].is_some();
                }
                let units: Vec<&Unit> =
                    self.units.iter().filter(|unit| !unit.is_released(&there)).collect();
                let held = |part: usize, leaving: &[bool]| {
                    let stays = |&by: &usize| there[by] && !leaving[by];
                    let with = units.iter().filter(|unit| unit.parts.contains(&part));
                    let mut met = met[part].iter().flatten();
                    met.any(stays) || with.flat_map(|unit| &unit.parts).any(stays)
                };
                while let Some(&part) =
                    parts.iter().find(|&&part| leaving[part] && held(part, &leaving))
                {
                    leaving[part] = false;
                }
                for part in 0..there.len() {
                    there[part] &= !leaving[part];
                }
            }
            if !self.wanted.iter().any(|&part| there[part]) {
                return Tried::Enough;
            }
            if there.iter().filter(|t| **t).count() == before {
                return Tried::Left(there);
            }
        }
    }

    /// The set with what one of its parts that are left meets along one direction, or waits for, the smallest first; of
    /// those that hold another one nothing.
    fn additions(&self, set: &Set, there: &[bool]) -> Vec<Set> {
        let mut found: Vec<Set> = Vec::new();
        let mut add = |parts: &mut dyn Iterator<Item = usize>| {
            let (mut larger, mut free) = (set.clone(), true);
            for part in parts.filter(|&part| there[part]) {
                larger.add(part);
                free &= !self.fixed[part];
            }
            // Something has to stay.
            if free && larger != *set && larger.len() < there.len() && !found.contains(&larger) {
                found.push(larger);
            }
        };
        for part in set.parts().into_iter().filter(|&part| there[part]) {
            let with = || self.units.iter().filter(|unit| unit.parts.contains(&part));
            for met in self.met.iter().filter_map(|met| met[part].as_ref()) {
                let as_one = with().filter(|unit| !unit.is_released(there));
                let as_one = as_one.flat_map(|unit| unit.parts.iter().copied());
                add(&mut met.iter().copied().chain(as_one));
            }
            for unit in with().filter(|unit| unit.apart) {
                add(&mut (0..there.len()).filter(|part| !unit.parts.contains(part)));
            }
        }
        found.sort_by_key(|set| (set.len(), set.clone()));
        let mut least: Vec<Set> = Vec::new();
        for set in found {
            if !least.iter().any(|smaller| set.holds(smaller)) {
                least.push(set);
            }
        }
        least
    }
}
