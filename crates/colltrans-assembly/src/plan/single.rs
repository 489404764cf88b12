//! Parts that can be removed alone. Most steps of a plan remove one part and need no blocking graph.
//!
//! Invariant: for every present part and every direction along which it may move, either one present part that blocks
//! it is stored (its *watched* part), or the direction is listed in `free`. Another blocker is searched only after the
//! watched part is removed. Thus `n` parts in a row need `n` entries for each direction instead of `n^2`.

use std::collections::BTreeMap;

use colltrans::solid::Workspace;
use rayon::prelude::*;

use super::ranking::Ranking;
use crate::bodies::Bodies;
use crate::boxes::RemainingBoxes;
use crate::error::AssemblyError;
use crate::matrix::ContactMatrix;
use crate::watch::{Stage, Watch};

/// The parts of a group that no other part of the group blocks.
pub(super) struct SingleParts<'a> {
    bodies: &'a Bodies<'a>,
    matrix: ContactMatrix<'a>,
    living: RemainingBoxes,
    /// For each part, the number of present parts that must leave before it.
    waiting_counts: Vec<usize>,
    /// For each part, the parts that must leave after it.
    waiting_parts: Vec<Vec<usize>>,
    /// For each direction and part, the parts that watch it.
    watchers: Vec<Vec<Vec<u32>>>,
    /// For each part, the directions without a blocker, in increasing order.
    free: BTreeMap<usize, Vec<usize>>,
    /// The parts that can leave now, ranked by cost.
    pub(super) ranking: Ranking,
    /// Parts whose rank is out of date: removed ones, and those with changed free directions or constraints.
    pub(super) changed: Vec<usize>,
    workspace: Workspace,
}

impl<'a> SingleParts<'a> {
    /// Searches a blocker for each part of the `alive` mask and each direction for which `movable` holds. Pair `(a,
    /// b)` of `order` demands that `b` leaves before `a`.
    pub(super) fn new(
        bodies: &'a Bodies<'a>,
        matrix: &ContactMatrix<'a>,
        order: &[(usize, usize)],
        alive: &[bool],
        movable: impl Fn(usize, usize) -> bool,
        watch: Watch,
    ) -> Result<Self, AssemblyError> {
        let (count, directions) = (alive.len(), matrix.directions().len());
        let (mut waiting_counts, mut waiting_parts) = (vec![0; count], vec![Vec::new(); count]);
        for &(waiting, before) in order.iter().filter(|(a, b)| alive[*a] && alive[*b]) {
            waiting_counts[waiting] += 1;
            waiting_parts[before].push(waiting);
        }
        let living = bodies.remaining_parts(alive);
        let parts = (0..count).filter(|&part| alive[part]);
        let jobs = parts.flat_map(|part| (0..directions).map(move |k| (k, part)));
        let jobs: Vec<(usize, usize)> = jobs.filter(|&(k, part)| movable(k, part)).collect();
        let tally = watch.start_stage(Stage::Rooms, jobs.len());
        let find = |workspace: &mut Workspace, &(k, part): &(usize, usize)| {
            let by = matrix.find_blocker(k, part, &living, workspace);
            tally.finish_item().map(|()| by)
        };
        let found: Result<Vec<Option<usize>>, AssemblyError> =
            jobs.par_iter().map_init(Workspace::default, find).collect();
        let mut watchers = vec![vec![Vec::new(); count]; directions];
        let mut free = BTreeMap::<usize, Vec<usize>>::new();
        for ((k, part), by) in jobs.into_iter().zip(found?) {
            match by {
                Some(by) => watchers[k][by].push(part as u32),
                None => free.entry(part).or_default().push(k),
            }
        }
        let changed = free.keys().copied().collect();
        let (matrix, ranking, workspace) =
            (matrix.clone(), Ranking::default(), Workspace::default());
        Ok(Self {
            bodies,
            matrix,
            living,
            waiting_counts,
            waiting_parts,
            watchers,
            free,
            ranking,
            changed,
            workspace,
        })
    }

    /// Returns the free directions of a part. Returns `None` if it has none or waits for another part.
    pub(super) fn free_directions(&self, part: usize) -> Option<&[usize]> {
        let directions = self.free.get(&part).filter(|_| self.waiting_counts[part] == 0);
        directions.map(|directions| &directions[..])
    }

    /// Removes a part, and updates the parts that watched it or waited for it.
    pub(super) fn remove(&mut self, part: usize) {
        self.free.remove(&part);
        self.changed.push(part);
        self.bodies.remove(&mut self.living, part);
        for waiting in std::mem::take(&mut self.waiting_parts[part]) {
            self.waiting_counts[waiting] -= 1;
            self.changed.push(waiting);
        }
        for k in 0..self.watchers.len() {
            for watching in std::mem::take(&mut self.watchers[k][part]) {
                let moving = watching as usize;
                if !self.living.contains(moving) {
                    continue;
                }
                let by = self.matrix.find_blocker(k, moving, &self.living, &mut self.workspace);
                if let Some(by) = by {
                    self.watchers[k][by].push(watching);
                } else {
                    self.changed.push(moving);
                    let directions = self.free.entry(moving).or_default();
                    directions.insert(directions.partition_point(|&known| known < k), k);
                }
            }
        }
    }

    /// Returns the number of stored entries.
    #[cfg(test)]
    pub(super) fn entry_count(&self) -> usize {
        self.free.values().map(Vec::len).sum::<usize>()
            + self.watchers.iter().flatten().map(Vec::len).sum::<usize>()
    }
}
