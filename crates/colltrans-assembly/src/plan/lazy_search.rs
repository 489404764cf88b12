//! Search for removable groups along directions that the matrix does not contain.
//!
//! For one direction, the only question is whether some proper group has no arc that leaves it. Therefore arcs are
//! computed on demand. Take a strongly connected component of the known arcs that no arc leaves, and test its pairs
//! with parts outside. If one pair blocks, it gives one more arc. If none blocks, the group is removable. If all
//! parts are one component, no group is removable. For interlocked parts this needs about as many casts as parts, not
//! as pairs. Most of these are casts of two facets that met along another direction ([`Memory`]). The memory changes
//! no answer, so each thread has its own. Results are cached across states of a plan, because parts keep their poses
//! ([`ContactCache`]).

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use colltrans::solid::StartOverlap;
use glam::DVec3;
use rayon::prelude::*;

use super::GroupRemoval;
use crate::blocking::BlockingGraph;
use crate::bodies::Bodies;
use crate::error::AssemblyError;
use crate::matrix::direction_bits;
use crate::watch::Watch;
use crate::witness::Memory;

/// Cached contacts: for each direction, whether one part blocks another.
#[derive(Default)]
pub(super) struct ContactCache(HashMap<[u64; 3], Answers>);

type Answers = HashMap<[usize; 2], bool>;

impl ContactCache {
    fn take_answers(&mut self, d: DVec3) -> Mutex<Answers> {
        Mutex::new(self.0.remove(&direction_bits(d)).unwrap_or_default())
    }

    fn put_back(&mut self, d: DVec3, answers: Mutex<Answers>) {
        let answers = answers.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.0.entry(direction_bits(d)).or_default().extend(answers);
    }
}

/// Returns the removable group for which the fewest parts move, over some directions. Ties go to the first direction.
///
/// `allowed` returns the number of parts that move for a group along a direction, or `None` if it may not move.
/// Returns `None` if no allowed group is removable. Along `-d` all arcs are reversed, so one component along `d` is
/// one along `-d`. The opposite direction is then skipped, unless order constraints add arcs, which are not reversed.
pub(super) fn smallest_group(
    bodies: &Bodies,
    directions: &[DVec3],
    alive: &[bool],
    start: StartOverlap,
    allowed: impl Fn(&[usize], DVec3) -> Option<usize> + Sync,
    known: &mut ContactCache,
    watch: Watch,
) -> Result<Option<GroupRemoval>, AssemblyError> {
    let answers: Vec<Mutex<Answers>> = directions.iter().map(|d| known.take_answers(*d)).collect();
    let constraints = bodies.assembly().constraints();
    let (order, is_ordered) = (constraints.order_arcs(alive), constraints.is_ordered(alive));
    let opposite = |k: usize| directions.iter().position(|d| *d == -directions[k]);
    let search_direction = |memory: &mut Memory, k: usize| {
        watch.check_cancelled()?;
        if opposite(k).is_some_and(|o| o < k) {
            return Ok(Vec::new());
        }
        let mut found = Vec::new();
        for k in std::iter::once(k).chain(opposite(k)) {
            let d = directions[k];
            let search = |g: &[usize]| allowed(g, d).is_some();
            // Each direction is processed by one thread.
            let mut known = answers[k].lock().unwrap_or_else(PoisonError::into_inner);
            let queries = ContactQueries { bodies, d, start, known: &mut known, memory };
            match removable_group(queries, &order, alive, search) {
                SearchOutcome::OneComponent if !is_ordered => break,
                SearchOutcome::OneComponent | SearchOutcome::NoneAllowed => (),
                SearchOutcome::Found(group) => {
                    let moving = allowed(&group, d).unwrap_or(usize::MAX);
                    found.push(((moving, k), group));
                }
            }
        }
        Ok(found)
    };
    let found: Result<Vec<Vec<Ranked>>, AssemblyError> =
        (0..directions.len()).into_par_iter().map_init(Memory::default, search_direction).collect();
    for (d, answers) in directions.iter().zip(answers) {
        known.put_back(*d, answers);
    }
    let best = found?.into_iter().flatten().min_by_key(|x| x.0);
    Ok(best.map(|((_, k), parts)| GroupRemoval::straight(parts, directions[k])))
}

/// The number of parts that move and the index of the direction, with the group.
type Ranked = ((usize, usize), Vec<usize>);

/// Contact queries along one direction.
struct ContactQueries<'a> {
    bodies: &'a Bodies<'a>,
    d: DVec3,
    start: StartOverlap,
    known: &'a mut Answers,
    memory: &'a mut Memory,
}

impl ContactQueries<'_> {
    /// Checks whether one part ever meets another, at any distance.
    fn pair_meets(&mut self, pair: [usize; 2]) -> bool {
        if let Some(known) = self.known.get(&pair) {
            return *known;
        }
        let meets = self.memory.pair_meets(self.bodies, pair, self.d, self.start);
        self.known.insert(pair, meets);
        meets
    }
}

enum SearchOutcome {
    /// All parts are one component.
    OneComponent,
    /// Removable groups exist, but none is allowed to move.
    NoneAllowed,
    Found(Vec<usize>),
}

/// Searches for an allowed removable group along one direction. Smaller groups are tried first.
fn removable_group(
    mut queries: ContactQueries,
    order: &[(usize, usize)],
    alive: &[bool],
    allowed: impl Fn(&[usize]) -> bool,
) -> SearchOutcome {
    let count = alive.iter().filter(|a| **a).count();
    let ahead = |part: usize| -> Vec<usize> {
        let all = queries.bodies.parts_ahead(part, queries.d).into_iter().map(|x| x.1);
        all.filter(|&k| alive[k]).collect()
    };
    let mut untested: Vec<Vec<usize>> =
        (0..alive.len()).map(|k| if alive[k] { ahead(k) } else { Vec::new() }).collect();
    let mut arcs = order.to_vec();
    loop {
        let graph = BlockingGraph::from_arcs(arcs.iter().copied(), alive);
        let mut groups = graph.removable_groups();
        groups.retain(|g| g.len() < count);
        if groups.is_empty() {
            return SearchOutcome::OneComponent;
        }
        groups.sort_by_key(Vec::len);
        let before = arcs.len();
        for group in groups {
            match blocking_arc(&mut queries, &group, &mut untested) {
                Some(arc) => arcs.push(arc),
                None if allowed(&group) => return SearchOutcome::Found(group),
                None => (),
            }
        }
        if arcs.len() == before {
            return SearchOutcome::NoneAllowed;
        }
    }
}

/// Returns an arc from the group to a part outside, from pairs that were not tested before. Returns `None` if no pair
/// blocks.
fn blocking_arc(
    queries: &mut ContactQueries,
    group: &[usize],
    untested: &mut [Vec<usize>],
) -> Option<(usize, usize)> {
    for &a in group {
        let mut k = 0;
        while k < untested[a].len() {
            let b = untested[a][k];
            if group.contains(&b) {
                k += 1;
                continue;
            }
            untested[a].remove(k);
            if queries.pair_meets([a, b]) {
                return Some((a, b));
            }
        }
    }
    None
}
