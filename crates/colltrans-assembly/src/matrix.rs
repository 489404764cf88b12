//! The whole matrix: every ordered pair of parts, by direction.
//!
//! `A` moving along `d` meets `B` after as far as `B` moving along `-d` meets `A`. So of two opposite
//! directions one is asked, and the other is its mirror image. Pairs that never meet are not stored.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::{Bodies, Room, Stop};
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
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Matrix {
    directions: Vec<DVec3>,
    meetings: Vec<Vec<Meeting>>,
}

impl Matrix {
    /// Asks every ordered pair of the parts that are `true` in `among`, along unit directions.
    ///
    /// # Errors
    /// Cancelled; more pairs meet than are kept.
    pub fn new(
        bodies: &Bodies,
        directions: &[DVec3],
        among: &[bool],
        start: StartOverlap,
        watch: Watch,
    ) -> Result<Self, AssemblyError> {
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
            let met = meetings(bodies, part, directions[k], among, start, workspace);
            let stored = if opposite(k).is_some() { 2 * met.len() } else { met.len() };
            if count.fetch_add(stored, Relaxed) + stored > MOST_MEETINGS {
                let (what, most) =
                    ("pairs of parts meet along the directions asked", MOST_MEETINGS);
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
        Ok(Self { directions: directions.to_vec(), meetings: all })
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
        &self.meetings[direction]
    }

    /// What a part meets along a direction.
    pub fn of_part(&self, direction: usize, part: usize) -> &[Meeting] {
        let all = &self.meetings[direction];
        let from = all.partition_point(|m| m.moving < part);
        let to = all.partition_point(|m| m.moving <= part);
        &all[from..to]
    }

    /// The room of a part along a direction, against all others.
    pub fn room(&self, direction: usize, part: usize) -> PartRoom {
        let met = self.of_part(direction, part);
        let first = met.iter().min_by(|x, y| {
            let key = |m: &Meeting| (m.stop.is_some(), m.displaced_distance());
            key(x).partial_cmp(&key(y)).unwrap_or(std::cmp::Ordering::Equal)
        });
        match first {
            None => PartRoom::Free,
            Some(&Meeting { moving: part, fixed: by, stop: None }) => {
                PartRoom::Overlapping { part, by }
            }
            Some(&Meeting { moving: part, fixed: by, stop: Some(stop) }) => {
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
        for (d, met) in self.directions.iter().zip(&self.meetings) {
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
    let mut met = Vec::new();
    for (_, other) in bodies.ahead(part, d) {
        if !among[other] {
            continue;
        }
        match bodies.room([part, other], d, None, start, workspace) {
            Room::Free => (),
            Room::Overlapping => met.push(Meeting { moving: part, fixed: other, stop: None }),
            Room::Blocked(stop) => {
                met.push(Meeting { moving: part, fixed: other, stop: Some(stop) });
            }
        }
    }
    met
}
