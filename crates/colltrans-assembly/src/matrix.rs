//! The whole matrix: every ordered pair of parts, by direction.
//!
//! `A` moving along `d` meets `B` after as far as `B` moving along `-d` meets `A`. So of two opposite
//! directions one is asked, and the other is its mirror image. Pairs that never meet are not stored.
//!
//! Parts in a row meet in every pair. So a plan of many parts asks for *one* part in the way of another, or for what is near,
//! best first over a tree of boxes, and for every pair only of those parts of which none leaves alone.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};

use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::{Bodies, Room, Stop};
use crate::boxes::Living;
use crate::csv::{Cell, Table};
use crate::error::AssemblyError;
use crate::rooms::PartRoom;
use crate::watch::{Stage, Watch};

/// Meetings that are kept, 130 bytes each.
const MOST_MEETINGS: usize = 1 << 24;

/// The bits of a direction, to find it again by; both zeros are one.
pub(crate) fn bits(d: DVec3) -> [u64; 3] {
    d.to_array().map(|x| (x + 0.0).to_bits())
}

/// One part meets another along a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// The part that moves.
    pub moving: usize,
    /// The part that stops it.
    pub fixed: usize,
    /// Where; `None` if they overlap where they are.
    pub stop: Option<Stop>,
}

impl Meeting {
    /// How far it is safe to move; 0 if they overlap where they are.
    pub fn distance(&self) -> f64 {
        self.stop.map_or(0.0, |stop| stop.distance())
    }

    /// How far the bodies go that were shrunk, or are to be kept apart: what decides who comes first.
    pub fn displaced_distance(&self) -> f64 {
        self.stop.map_or(0.0, |stop| stop.displaced.value)
    }

    /// The same meeting, as the other part sees it that moves along the opposite of `d`.
    fn mirrored(&self, d: DVec3) -> Self {
        let turn = |s: Stop| Stop {
            normal: -s.normal,
            point: s.point - d * s.displaced.value,
            triangles: [s.triangles[1], s.triangles[0]],
            ..s
        };
        Self { moving: self.fixed, fixed: self.moving, stop: self.stop.map(turn) }
    }
}

/// Who meets whom along which directions.
///
/// Of many parts in a row each meets all others, so the whole has an entry for every pair. It is computed when it is first
/// asked for ([`complete`](Self::complete)); what a plan asks of single parts is found without it.
#[derive(Clone)]
pub struct Matrix<'a> {
    bodies: &'a Bodies<'a>,
    directions: Vec<DVec3>,
    among: Vec<bool>,
    start: StartOverlap,
    /// By direction, sorted by moving and fixed part.
    whole: OnceLock<Arc<Vec<Vec<Meeting>>>>,
    /// The parts among which it asks, once a room is asked for.
    all: OnceLock<Arc<Living>>,
}

impl std::fmt::Debug for Matrix<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self { directions, among, whole, .. } = self;
        let mut fields = f.debug_struct("Matrix");
        fields.field("directions", directions).field("among", among).field("whole", whole);
        fields.finish_non_exhaustive()
    }
}

impl PartialEq for Matrix<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.directions == other.directions && self.whole() == other.whole()
    }
}

impl<'a> Matrix<'a> {
    /// Asks every ordered pair of the parts that are `true` in `among`, along unit directions.
    ///
    /// # Errors
    /// Cancelled; more pairs meet than are kept.
    pub fn new(
        bodies: &'a Bodies<'a>,
        directions: &[DVec3],
        among: &[bool],
        start: StartOverlap,
        watch: Watch,
    ) -> Result<Self, AssemblyError> {
        let matrix = Self::on_demand(bodies, directions, among, start);
        matrix.complete(watch)?;
        Ok(matrix)
    }

    /// Asks nothing yet.
    pub fn on_demand(
        bodies: &'a Bodies<'a>,
        directions: &[DVec3],
        among: &[bool],
        start: StartOverlap,
    ) -> Self {
        let (directions, among) = (directions.to_vec(), among.to_vec());
        Self { bodies, directions, among, start, whole: OnceLock::new(), all: OnceLock::new() }
    }

    /// Asks every ordered pair, if that has not been done yet.
    ///
    /// # Errors
    /// Cancelled; more pairs meet than are kept.
    pub fn complete(&self, watch: Watch) -> Result<(), AssemblyError> {
        if self.whole.get().is_none() {
            let whole = self.asked(MOST_MEETINGS, watch)?;
            self.whole.get_or_init(|| Arc::new(whole));
        }
        Ok(())
    }

    /// Checks whether every pair has been asked.
    pub fn is_complete(&self) -> bool {
        self.whole.get().is_some()
    }

    /// Returns a complete matrix of at least some of the parts: this one, or one of them alone.
    pub(crate) fn of(&self, some: &[bool], watch: Watch) -> Result<Self, AssemblyError> {
        if self.is_complete() {
            return Ok(self.clone());
        }
        Self::new(self.bodies, &self.directions, some, self.start, watch)
    }

    /// Checks whether all of these parts are among those asked.
    pub(crate) fn has(&self, parts: &[usize]) -> bool {
        parts.iter().all(|&part| self.among[part])
    }

    fn whole(&self) -> &[Vec<Meeting>] {
        // Nobody calls this off, and the limit is for those who can be told of it.
        self.whole
            .get_or_init(|| Arc::new(self.asked(usize::MAX, Watch::default()).unwrap_or_default()))
    }

    /// All meetings, by direction, unless they are more than `most`.
    fn asked(&self, most: usize, watch: Watch) -> Result<Vec<Vec<Meeting>>, AssemblyError> {
        let Self { bodies, directions, among, start, .. } = self;
        let index: HashMap<[u64; 3], usize> =
            directions.iter().enumerate().map(|(k, d)| (bits(*d), k)).collect();
        let opposite = |k: usize| index.get(&bits(-directions[k])).copied();
        let asked: Vec<usize> =
            (0..directions.len()).filter(|&k| opposite(k).is_none_or(|o| o > k)).collect();
        let moving: Vec<usize> = (0..bodies.len()).filter(|&k| among[k]).collect();
        let tally = watch.stage(Stage::Rooms, asked.len() * moving.len());
        let jobs: Vec<(usize, usize)> =
            asked.iter().flat_map(|&k| moving.iter().map(move |&part| (k, part))).collect();
        let count = AtomicUsize::new(0);
        let row = |workspace: &mut Workspace, &(k, part): &(usize, usize)| {
            let met = meetings(bodies, part, directions[k], among, *start, workspace);
            let stored = if opposite(k).is_some() { 2 * met.len() } else { met.len() };
            if count.fetch_add(stored, Relaxed) + stored > most {
                let what = "pairs of parts meet along the directions asked";
                return Err(AssemblyError::TooMany { what, most });
            }
            tally.step().map(|()| (k, met))
        };
        let rows: Result<Vec<(usize, Vec<Meeting>)>, AssemblyError> =
            jobs.par_iter().map_init(Workspace::default, row).collect();
        let mut all = vec![Vec::new(); directions.len()];
        for (k, met) in rows? {
            if let Some(other) = opposite(k) {
                all[other].extend(met.iter().map(|m| m.mirrored(directions[k])));
            }
            all[k].extend(met);
        }
        for met in &mut all {
            met.sort_by_key(|m: &Meeting| (m.moving, m.fixed));
        }
        Ok(all)
    }

    /// The directions, of length 1.
    pub fn directions(&self) -> &[DVec3] {
        &self.directions
    }

    /// The position of a direction, if it was asked.
    pub fn position(&self, direction: DVec3) -> Option<usize> {
        self.directions.iter().position(|d| bits(*d) == bits(direction))
    }

    /// All meetings along a direction, sorted by moving and fixed part.
    pub fn meetings(&self, direction: usize) -> &[Meeting] {
        &self.whole()[direction]
    }

    /// What a part meets along a direction.
    pub fn of_part(&self, direction: usize, part: usize) -> &[Meeting] {
        let all = self.meetings(direction);
        let from = all.partition_point(|m| m.moving < part);
        let to = all.partition_point(|m| m.moving <= part);
        &all[from..to]
    }

    /// Returns the first of some parts that are left which a part meets along a direction, of whichever comes first.
    pub(crate) fn blocker(
        &self,
        direction: usize,
        part: usize,
        living: &Living,
        workspace: &mut Workspace,
    ) -> Option<usize> {
        if self.is_complete() {
            return self
                .of_part(direction, part)
                .iter()
                .map(|m| m.fixed)
                .find(|&by| living.has(by));
        }
        let (bodies, d) = (self.bodies, self.directions[direction]);
        let meets = |_, other| bodies.meets([part, other], d, self.start, workspace);
        bodies.first_ahead(part, d, living, meets)
    }

    /// Returns the parts that are left which a part meets along a direction within a length, increasing.
    pub(crate) fn within(
        &self,
        direction: usize,
        part: usize,
        length: f64,
        living: &Living,
    ) -> Vec<usize> {
        let mut found = Vec::new();
        if self.is_complete() {
            let met = self.of_part(direction, part).iter();
            let met = met.filter(|m| m.displaced_distance() <= length && living.has(m.fixed));
            return met.map(|m| m.fixed).collect();
        }
        let mut workspace = Workspace::default();
        self.bodies.first_ahead(part, self.directions[direction], living, |bound, other| {
            let near = bound <= length;
            let met =
                near.then(|| self.meeting(direction, [part, other], &mut workspace)).flatten();
            found.extend(met.filter(|m| m.displaced_distance() <= length).map(|m| m.fixed));
            !near
        });
        found.sort_unstable();
        found
    }

    /// Asks one pair, as a whole matrix has it.
    fn meeting(&self, k: usize, [a, b]: [usize; 2], workspace: &mut Workspace) -> Option<Meeting> {
        let d = self.directions[k];
        // Of two opposite directions the first one is asked.
        let opposite = self.directions[..k].iter().find(|other| bits(**other) == bits(-d));
        match opposite {
            Some(&other) => meeting(self.bodies, [b, a], other, self.start, workspace)
                .map(|m| m.mirrored(other)),
            None => meeting(self.bodies, [a, b], d, self.start, workspace),
        }
    }

    /// The room of a part along a direction, against all others.
    pub fn room(&self, direction: usize, part: usize) -> PartRoom {
        let key = |m: &Meeting| (m.stop.is_some(), m.displaced_distance());
        let before = |x: &Meeting, y: &Meeting| {
            let by = key(x).partial_cmp(&key(y)).unwrap_or(std::cmp::Ordering::Equal);
            by.then(x.fixed.cmp(&y.fixed))
        };
        let mut first: Option<Meeting> = None;
        if self.is_complete() {
            first = self.of_part(direction, part).iter().min_by(|x, y| before(x, y)).copied();
        } else {
            let all = || Arc::new(self.bodies.living(&self.among));
            let (living, mut workspace) = (self.all.get_or_init(all), Workspace::default());
            self.bodies.first_ahead(part, self.directions[direction], living, |bound, other| {
                if first.is_some_and(|m| bound > m.displaced_distance()) {
                    return true;
                }
                let met = self.meeting(direction, [part, other], &mut workspace);
                first = first.into_iter().chain(met).min_by(|x, y| before(x, y));
                false
            });
        }
        match first {
            None => PartRoom::Free,
            Some(Meeting { moving: part, fixed: by, stop: None }) => {
                PartRoom::Overlapping { part, by }
            }
            Some(Meeting { moving: part, fixed: by, stop: Some(stop) }) => {
                PartRoom::Blocked { part, by, stop }
            }
        }
    }

    /// The matrix as CSV: a line for each ordered pair and direction that is not free.
    pub fn to_csv(&self, bodies: &Bodies) -> String {
        let parts = bodies.assembly().parts();
        let heads =
            ["direction_x", "direction_y", "direction_z", "moving", "fixed", "outcome", "distance"];
        let mut table = Table::new(&heads);
        for (d, met) in self.directions.iter().zip(self.whole()) {
            for m in met {
                let outcome = if m.stop.is_some() { "blocked" } else { "overlapping" };
                table.row(&[
                    Cell::Number(d.x),
                    Cell::Number(d.y),
                    Cell::Number(d.z),
                    Cell::Text(parts[m.moving].name()),
                    Cell::Text(parts[m.fixed].name()),
                    Cell::Text(outcome),
                    Cell::Number(m.distance()),
                ]);
            }
        }
        table.finish()
    }
}

fn meetings(
    bodies: &Bodies,
    part: usize,
    d: DVec3,
    among: &[bool],
    start: StartOverlap,
    workspace: &mut Workspace,
) -> Vec<Meeting> {
    let ahead = bodies.ahead(part, d).into_iter().filter(|&(_, other)| among[other]);
    ahead.filter_map(|(_, other)| meeting(bodies, [part, other], d, start, workspace)).collect()
}

fn meeting(
    bodies: &Bodies,
    [moving, fixed]: [usize; 2],
    d: DVec3,
    start: StartOverlap,
    workspace: &mut Workspace,
) -> Option<Meeting> {
    let stop = match bodies.room([moving, fixed], d, None, start, workspace) {
        Room::Free => return None,
        Room::Overlapping => None,
        Room::Blocked(stop) => Some(stop),
    };
    Some(Meeting { moving, fixed, stop })
}
