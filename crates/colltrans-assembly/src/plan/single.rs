//! Parts that can be taken out alone: most of every plan, without a graph for each step.
//!
//! Invariant: of every part that is there, and by direction, one part that is there and that it meets is known, its
//! *watched* one; those that meet none are `free`. Only when a watched part goes another one is looked for. So of `n` parts
//! in a row there are `n` entries along a direction, not `n^2`.

use std::collections::BTreeMap;

use colltrans::solid::Workspace;
use rayon::prelude::*;

use super::ranking::Ranking;
use crate::bodies::Bodies;
use crate::boxes::Living;
use crate::error::AssemblyError;
use crate::matrix::Matrix;
use crate::watch::{Stage, Watch};

/// Which parts of a group meet nothing else of it.
pub(super) struct Single<'a> {
    bodies: &'a Bodies<'a>,
    matrix: Matrix<'a>,
    living: Living,
    /// By part, how many of those that are there have to leave before it.
    waits: Vec<usize>,
    /// By part, which ones wait for it.
    awaited: Vec<Vec<usize>>,
    /// By direction and part, those that watch it.
    watched: Vec<Vec<Vec<u32>>>,
    /// By part, the directions along which it meets nothing, increasing.
    free: BTreeMap<usize, Vec<usize>>,
    /// The parts that are free and wait for nothing, by what it costs to take them away.
    pub(super) ranking: Ranking,
    /// Parts that have left, or whose ways are not those by which they were ranked.
    pub(super) changed: Vec<usize>,
    workspace: Workspace,
}

impl<'a> Single<'a> {
    /// Looks at the parts that are `alive`, with the arcs of an order; of those, along each direction, `movable` ones are
    /// looked for.
    pub(super) fn new(
        bodies: &'a Bodies<'a>,
        matrix: &Matrix<'a>,
        order: &[(usize, usize)],
        alive: &[bool],
        movable: impl Fn(usize, usize) -> bool,
        watch: Watch,
    ) -> Result<Self, AssemblyError> {
        let (count, directions) = (alive.len(), matrix.directions().len());
        let (mut waits, mut awaited) = (vec![0; count], vec![Vec::new(); count]);
        for &(waiting, before) in order.iter().filter(|(a, b)| alive[*a] && alive[*b]) {
            waits[waiting] += 1;
            awaited[before].push(waiting);
        }
        let living = bodies.living(alive);
        let parts = (0..count).filter(|&part| alive[part]);
        let jobs = parts.flat_map(|part| (0..directions).map(move |k| (k, part)));
        let jobs: Vec<(usize, usize)> = jobs.filter(|&(k, part)| movable(k, part)).collect();
        let tally = watch.stage(Stage::Rooms, jobs.len());
        let look = |workspace: &mut Workspace, &(k, part): &(usize, usize)| {
            let by = matrix.blocker(k, part, &living, workspace);
            tally.step().map(|()| by)
        };
        let found: Result<Vec<Option<usize>>, AssemblyError> =
            jobs.par_iter().map_init(Workspace::default, look).collect();
        let mut watched = vec![vec![Vec::new(); count]; directions];
        let mut free = BTreeMap::<usize, Vec<usize>>::new();
        for ((k, part), by) in jobs.into_iter().zip(found?) {
            match by {
                Some(by) => watched[k][by].push(part as u32),
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
            waits,
            awaited,
            watched,
            free,
            ranking,
            changed,
            workspace,
        })
    }

    /// Returns the directions along which a part is free, if there are any and it waits for nothing.
    pub(super) fn ways(&self, part: usize) -> Option<&[usize]> {
        let ways = self.free.get(&part).filter(|_| self.waits[part] == 0);
        ways.map(|ways| &ways[..])
    }

    /// Takes a part away.
    pub(super) fn remove(&mut self, part: usize) {
        self.free.remove(&part);
        self.changed.push(part);
        self.bodies.remove(&mut self.living, part);
        for waiting in std::mem::take(&mut self.awaited[part]) {
            self.waits[waiting] -= 1;
            self.changed.push(waiting);
        }
        for k in 0..self.watched.len() {
            for watching in std::mem::take(&mut self.watched[k][part]) {
                let moving = watching as usize;
                if !self.living.has(moving) {
                    continue;
                }
                let by = self.matrix.blocker(k, moving, &self.living, &mut self.workspace);
                if let Some(by) = by {
                    self.watched[k][by].push(watching);
                } else {
                    self.changed.push(moving);
                    let ways = self.free.entry(moving).or_default();
                    ways.insert(ways.partition_point(|&known| known < k), k);
                }
            }
        }
    }

    /// How many entries are kept.
    #[cfg(test)]
    pub(super) fn entries(&self) -> usize {
        self.free.values().map(Vec::len).sum::<usize>()
            + self.watched.iter().flatten().map(Vec::len).sum::<usize>()
    }
}
