//! The contact matrix: for every direction and ordered pair of parts, whether and where the first blocks against the
//! second.
//!
//! `A` meets `B` along `d` at the same distance as `B` meets `A` along `-d`. Therefore only one of two opposite
//! directions is computed, and the other one is its mirror image. Pairs that never meet are not stored.
//!
//! In a row of parts every pair meets. A plan of many parts therefore computes on demand: *one* blocker of a part, or
//! the parts nearby, by a best-first search of a tree of boxes. All pairs are computed only for parts of which none
//! leaves alone.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};

use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::{Bodies, FreeTravel, Stop};
use crate::boxes::RemainingBoxes;
use crate::csv::{Cell, Table};
use crate::error::AssemblyError;
use crate::travel::PartTravel;
use crate::watch::{Stage, Watch};

/// Maximum number of stored contacts, of 130 bytes each.
const MAX_MEETINGS: usize = 1 << 24;

/// Returns the bits of a direction as a key. Both signs of zero have one key.
pub(crate) fn direction_bits(d: DVec3) -> [u64; 3] {
    d.to_array().map(|x| (x + 0.0).to_bits())
}

/// A contact of two parts along a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairContact {
    /// Index of the moving part.
    pub moving: usize,
    /// Index of the part that blocks it.
    pub fixed: usize,
    /// The contact; `None` if the parts overlap at the start.
    pub stop: Option<Stop>,
}

impl PairContact {
    /// Returns the proven safe travel; 0 if the parts overlap at the start.
    pub fn safe_distance(&self) -> f64 {
        self.stop.map_or(0.0, |stop| stop.distance())
    }

    /// Returns the travel of the bodies with their tolerance or gap applied. It decides which contact is first.
    pub fn displaced_distance(&self) -> f64 {
        self.stop.map_or(0.0, |stop| stop.shrunk_translation.value)
    }

    /// Returns the contact from the view of the other part, which moves along `-d`.
    fn reversed(&self, d: DVec3) -> Self {
        let turn = |s: Stop| Stop {
            normal: -s.normal,
            point: s.point - d * s.shrunk_translation.value,
            triangles: [s.triangles[1], s.triangles[0]],
            ..s
        };
        Self { moving: self.fixed, fixed: self.moving, stop: self.stop.map(turn) }
    }
}

/// The contacts of all parts along a list of directions.
///
/// In a row of parts every pair meets, so the complete matrix has an entry for every pair. It is computed at first
/// use ([`compute_all`](Self::compute_all)). The queries of a plan about single parts do not need it.
#[derive(Clone)]
pub struct ContactMatrix<'a> {
    bodies: &'a Bodies<'a>,
    directions: Vec<DVec3>,
    among: Vec<bool>,
    start: StartOverlap,
    /// For each direction, the contacts sorted by moving and fixed part.
    complete_meetings: OnceLock<Arc<Vec<Vec<PairContact>>>>,
    /// The parts of the matrix, for queries on demand.
    all: OnceLock<Arc<RemainingBoxes>>,
}

impl std::fmt::Debug for ContactMatrix<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self { directions, among, complete_meetings, .. } = self;
        let mut fields = f.debug_struct("ContactMatrix");
        fields
            .field("directions", directions)
            .field("among", among)
            .field("complete_meetings", complete_meetings);
        fields.finish_non_exhaustive()
    }
}

impl PartialEq for ContactMatrix<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.directions == other.directions && self.all_meetings() == other.all_meetings()
    }
}

impl<'a> ContactMatrix<'a> {
    /// Computes the contacts of all ordered pairs of the parts in the mask `among`, along directions of length 1.
    ///
    /// # Errors
    /// Returns an error if the run is cancelled or more than 2^24 contacts would be stored.
    pub fn new(
        bodies: &'a Bodies<'a>,
        directions: &[DVec3],
        among: &[bool],
        start: StartOverlap,
        watch: Watch,
    ) -> Result<Self, AssemblyError> {
        let matrix = Self::on_demand(bodies, directions, among, start);
        matrix.compute_all(watch)?;
        Ok(matrix)
    }

    /// Creates a matrix that computes contacts on demand.
    pub fn on_demand(
        bodies: &'a Bodies<'a>,
        directions: &[DVec3],
        among: &[bool],
        start: StartOverlap,
    ) -> Self {
        let (directions, among) = (directions.to_vec(), among.to_vec());
        Self {
            bodies,
            directions,
            among,
            start,
            complete_meetings: OnceLock::new(),
            all: OnceLock::new(),
        }
    }

    /// Computes all contacts, unless they are computed already.
    ///
    /// # Errors
    /// Returns an error if the run is cancelled or more than 2^24 contacts would be stored.
    pub fn compute_all(&self, watch: Watch) -> Result<(), AssemblyError> {
        if self.complete_meetings.get().is_none() {
            let complete_meetings = self.compute_meetings(MAX_MEETINGS, watch)?;
            self.complete_meetings.get_or_init(|| Arc::new(complete_meetings));
        }
        Ok(())
    }

    /// Checks whether all contacts are computed.
    pub fn is_complete(&self) -> bool {
        self.complete_meetings.get().is_some()
    }

    /// Returns a complete matrix that covers at least the parts of a mask: this one if it is complete, otherwise one
    /// of these parts.
    pub(crate) fn complete_among(
        &self,
        some: &[bool],
        watch: Watch,
    ) -> Result<Self, AssemblyError> {
        if self.is_complete() {
            return Ok(self.clone());
        }
        Self::new(self.bodies, &self.directions, some, self.start, watch)
    }

    /// Checks whether the matrix covers all of these parts.
    pub(crate) fn covers(&self, parts: &[usize]) -> bool {
        parts.iter().all(|&part| self.among[part])
    }

    fn all_meetings(&self) -> &[Vec<PairContact>] {
        // Without a watch there is no cancellation. The limit applies only to callers that can receive its error.
        self.complete_meetings.get_or_init(|| {
            Arc::new(self.compute_meetings(usize::MAX, Watch::default()).unwrap_or_default())
        })
    }

    /// Computes all contacts for each direction. Returns an error if there are more than `most`.
    fn compute_meetings(
        &self,
        most: usize,
        watch: Watch,
    ) -> Result<Vec<Vec<PairContact>>, AssemblyError> {
        let Self { bodies, directions, among, start, .. } = self;
        let index: HashMap<[u64; 3], usize> =
            directions.iter().enumerate().map(|(k, d)| (direction_bits(*d), k)).collect();
        let opposite = |k: usize| index.get(&direction_bits(-directions[k])).copied();
        let computed: Vec<usize> =
            (0..directions.len()).filter(|&k| opposite(k).is_none_or(|o| o > k)).collect();
        let moving: Vec<usize> = (0..bodies.len()).filter(|&k| among[k]).collect();
        let tally = watch.start_stage(Stage::Rooms, computed.len() * moving.len());
        let jobs: Vec<(usize, usize)> =
            computed.iter().flat_map(|&k| moving.iter().map(move |&part| (k, part))).collect();
        let count = AtomicUsize::new(0);
        let row = |workspace: &mut Workspace, &(k, part): &(usize, usize)| {
            let met = part_meetings(bodies, part, directions[k], among, *start, workspace);
            let stored = if opposite(k).is_some() { 2 * met.len() } else { met.len() };
            if count.fetch_add(stored, Relaxed) + stored > most {
                let what = "contacts of pairs of parts along the tested directions";
                return Err(AssemblyError::TooMany { what, most });
            }
            tally.finish_item().map(|()| (k, met))
        };
        let rows: Result<Vec<(usize, Vec<PairContact>)>, AssemblyError> =
            jobs.par_iter().map_init(Workspace::default, row).collect();
        let mut all = vec![Vec::new(); directions.len()];
        for (k, met) in rows? {
            if let Some(other) = opposite(k) {
                all[other].extend(met.iter().map(|m| m.reversed(directions[k])));
            }
            all[k].extend(met);
        }
        for met in &mut all {
            met.sort_by_key(|m: &PairContact| (m.moving, m.fixed));
        }
        Ok(all)
    }

    /// Returns the directions, of length 1.
    pub fn directions(&self) -> &[DVec3] {
        &self.directions
    }

    /// Returns the index of a direction, or `None` if the matrix does not contain it.
    pub fn direction_index(&self, direction: DVec3) -> Option<usize> {
        self.directions.iter().position(|d| direction_bits(*d) == direction_bits(direction))
    }

    /// Returns all contacts along a direction, sorted by moving and fixed part. Computes the matrix if necessary.
    pub fn contacts_along(&self, direction: usize) -> &[PairContact] {
        &self.all_meetings()[direction]
    }

    /// Returns the contacts of a moving part along a direction. Computes the matrix if necessary.
    pub fn contacts_of_part(&self, direction: usize, part: usize) -> &[PairContact] {
        let all = self.contacts_along(direction);
        let from = all.partition_point(|m| m.moving < part);
        let to = all.partition_point(|m| m.moving <= part);
        &all[from..to]
    }

    /// Returns any present part that blocks a part along a direction. Returns `None` if the part is free. If several
    /// parts block it, the result depends on whether the matrix is complete.
    pub(crate) fn find_blocker(
        &self,
        direction: usize,
        part: usize,
        living: &RemainingBoxes,
        workspace: &mut Workspace,
    ) -> Option<usize> {
        if self.is_complete() {
            return self
                .contacts_of_part(direction, part)
                .iter()
                .map(|m| m.fixed)
                .find(|&by| living.contains(by));
        }
        let (bodies, d) = (self.bodies, self.directions[direction]);
        let meets = |_, other| bodies.ever_meets([part, other], d, self.start, workspace);
        bodies.first_part_ahead(part, d, living, meets)
    }

    /// Returns the present parts that block a part along a direction within a length, in increasing order.
    pub(crate) fn blockers_within(
        &self,
        direction: usize,
        part: usize,
        length: f64,
        living: &RemainingBoxes,
    ) -> Vec<usize> {
        let mut found = Vec::new();
        if self.is_complete() {
            let met = self.contacts_of_part(direction, part).iter();
            let met = met.filter(|m| m.displaced_distance() <= length && living.contains(m.fixed));
            return met.map(|m| m.fixed).collect();
        }
        let mut workspace = Workspace::default();
        self.bodies.first_part_ahead(part, self.directions[direction], living, |bound, other| {
            let near = bound <= length;
            let met =
                near.then(|| self.pair_meeting(direction, [part, other], &mut workspace)).flatten();
            found.extend(met.filter(|m| m.displaced_distance() <= length).map(|m| m.fixed));
            !near
        });
        found.sort_unstable();
        found
    }

    /// Computes the contact of one pair, equal to the entry of the complete matrix.
    fn pair_meeting(
        &self,
        k: usize,
        [a, b]: [usize; 2],
        workspace: &mut Workspace,
    ) -> Option<PairContact> {
        let d = self.directions[k];
        // Only the first of two opposite directions is computed.
        let opposite =
            self.directions[..k].iter().find(|other| direction_bits(**other) == direction_bits(-d));
        match opposite {
            Some(&other) => first_meeting(self.bodies, [b, a], other, self.start, workspace)
                .map(|m| m.reversed(other)),
            None => first_meeting(self.bodies, [a, b], d, self.start, workspace),
        }
    }

    /// Returns the free travel of a part along a direction, against all other parts of the matrix.
    pub fn travel_of_part(&self, direction: usize, part: usize) -> PartTravel {
        let key = |m: &PairContact| (m.stop.is_some(), m.displaced_distance());
        let before = |x: &PairContact, y: &PairContact| {
            let by = key(x).partial_cmp(&key(y)).unwrap_or(std::cmp::Ordering::Equal);
            by.then(x.fixed.cmp(&y.fixed))
        };
        let mut first: Option<PairContact> = None;
        if self.is_complete() {
            first =
                self.contacts_of_part(direction, part).iter().min_by(|x, y| before(x, y)).copied();
        } else {
            let all = || Arc::new(self.bodies.remaining_parts(&self.among));
            let (living, mut workspace) = (self.all.get_or_init(all), Workspace::default());
            self.bodies.first_part_ahead(
                part,
                self.directions[direction],
                living,
                |bound, other| {
                    if first.is_some_and(|m| bound > m.displaced_distance()) {
                        return true;
                    }
                    let met = self.pair_meeting(direction, [part, other], &mut workspace);
                    first = first.into_iter().chain(met).min_by(|x, y| before(x, y));
                    false
                },
            );
        }
        match first {
            None => PartTravel::Free,
            Some(PairContact { moving: part, fixed: by, stop: None }) => {
                PartTravel::Overlapping { part, by }
            }
            Some(PairContact { moving: part, fixed: by, stop: Some(stop) }) => {
                PartTravel::Blocked { part, by, stop }
            }
        }
    }

    /// Returns the matrix as CSV, with a line for each direction and ordered pair that meets. Computes it if
    /// necessary.
    pub fn to_csv(&self, bodies: &Bodies) -> String {
        let parts = bodies.assembly().parts();
        let heads =
            ["direction_x", "direction_y", "direction_z", "moving", "fixed", "outcome", "distance"];
        let mut table = Table::new(&heads);
        for (d, met) in self.directions.iter().zip(self.all_meetings()) {
            for m in met {
                let outcome = if m.stop.is_some() { "blocked" } else { "overlapping" };
                table.push_row(&[
                    Cell::Number(d.x),
                    Cell::Number(d.y),
                    Cell::Number(d.z),
                    Cell::Text(parts[m.moving].name()),
                    Cell::Text(parts[m.fixed].name()),
                    Cell::Text(outcome),
                    Cell::Number(m.safe_distance()),
                ]);
            }
        }
        table.into_text()
    }
}

fn part_meetings(
    bodies: &Bodies,
    part: usize,
    d: DVec3,
    among: &[bool],
    start: StartOverlap,
    workspace: &mut Workspace,
) -> Vec<PairContact> {
    let ahead = bodies.parts_ahead(part, d).into_iter().filter(|&(_, other)| among[other]);
    ahead
        .filter_map(|(_, other)| first_meeting(bodies, [part, other], d, start, workspace))
        .collect()
}

fn first_meeting(
    bodies: &Bodies,
    [moving, fixed]: [usize; 2],
    d: DVec3,
    start: StartOverlap,
    workspace: &mut Workspace,
) -> Option<PairContact> {
    let stop = match bodies.free_travel([moving, fixed], d, None, start, workspace) {
        FreeTravel::Free => return None,
        FreeTravel::Overlapping => None,
        FreeTravel::Blocked(stop) => Some(stop),
    };
    Some(PairContact { moving, fixed, stop })
}
