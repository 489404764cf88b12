//! The search: breadth first over places, so the first way found has the fewest legs of those that it looks for.
//!
//! At a place each pair of bodies is cast along all directions. Who is hit within a step moves along: so each body and
//! each direction have a least group. A group that never hits the rest leaves, and that is the answer. Else it goes
//! along and stops in the middle of the openings for other directions, of all its pairs together and of each alone (and
//! near the ends of wide ones), and before what it hits; never at it.
//!
//! *Invariants.* The base, a body that is fixed or the largest, never moves: a group with it stays where it is, and
//! the others move against the direction. Displacements lie on a grid that is finer than the slack, whose
//! differences are exact. Two places are one if all bodies are in the same cells of a coarse grid and the same pairs
//! can move along the same directions.

use std::collections::hash_map::DefaultHasher;
use std::collections::{HashSet, VecDeque};
use std::hash::{Hash, Hasher};
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

use super::openings::{add, open};
use super::options::{Searched, WayOptions};
use super::pairs::{Pair, bits};
use crate::free::FreeError;

/// Bodies in a group, a bit each.
pub(super) type Group = u64;

/// A leg as it is planned: who moves, and by which vector; the last one along a direction without an end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Move {
    pub(super) group: Group,
    pub(super) motion: DVec3,
}

/// Lengths.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// Longer than all bodies together.
    pub(super) far: f64,
    /// The least move worth making.
    pub(super) step: f64,
    /// Cells of one place.
    pub(super) grain: f64,
    /// How far before a contact, or beside the end of an opening, a leg stops.
    pub(super) off: f64,
    /// Displacements are multiples of this power of two.
    pub(super) grid: f64,
}

struct Place {
    at: Vec<DVec3>,
    before: Option<(usize, Move)>,
    legs: usize,
}

pub(super) struct Search<'s, 'a> {
    /// For bodies `i < j` at `j (j - 1) / 2 + i`.
    pub(super) pairs: Vec<Pair<'a>>,
    pub(super) count: usize,
    /// Bodies that do not move, the base one of them.
    pub(super) fixed: Group,
    pub(super) base: usize,
    pub(super) directions: Vec<DVec3>,
    pub(super) scale: Scale,
    pub(super) options: &'s WayOptions,
    pub(super) cancel: Option<&'s AtomicBool>,
    pub(super) searched: Searched,
    places: Vec<Place>,
    seen: HashSet<Vec<[u64; 3]>>,
}

impl<'s, 'a> Search<'s, 'a> {
    pub(super) fn new(
        pairs: Vec<Pair<'a>>,
        (count, fixed, base): (usize, Group, usize),
        directions: Vec<DVec3>,
        scale: Scale,
        options: &'s WayOptions,
        cancel: Option<&'s AtomicBool>,
    ) -> Self {
        let searched = Searched { directions: directions.len(), ..Searched::default() };
        let (places, seen) = (Vec::new(), HashSet::new());
        Self {
            pairs,
            count,
            fixed,
            base,
            directions,
            scale,
            options,
            cancel,
            searched,
            places,
            seen,
        }
    }

    /// Legs that take some bodies away from the others, which `proven` accepts.
    pub(super) fn run<P>(
        &mut self,
        mut proven: impl FnMut(&[Move]) -> Result<Option<P>, FreeError>,
    ) -> Result<Option<P>, FreeError> {
        let mut known = HashSet::new();
        self.places.push(Place { at: vec![DVec3::ZERO; self.count], before: None, legs: 0 });
        let mut queue = VecDeque::from([0]);
        while let Some(at) = queue.pop_front() {
            if self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                return Err(FreeError::Cancelled);
            }
            let spent = self.searched.looks >= self.options.looks;
            if spent || self.searched.places >= self.options.places {
                return Ok(None);
            }
            self.searched.places += 1;
            let rooms = self.rooms(at)?;
            for last in self.leaving(&rooms) {
                let mut moves = self.moves(at);
                moves.push(last);
                if let Some(way) = proven(&moves)? {
                    return Ok(Some(way));
                }
            }
            if self.places[at].legs + 2 <= self.options.legs && known.insert(self.key(at, &rooms)) {
                queue.extend(self.next(at, &rooms));
            }
        }
        self.searched.complete = true;
        Ok(None)
    }

    /// For each direction how far each body goes until it hits each other, in rows of the moving ones.
    fn rooms(&mut self, place: usize) -> Result<Vec<Vec<f64>>, FreeError> {
        let (count, directions) = (self.count, self.directions.len());
        let mut rooms = vec![vec![f64::INFINITY; count * count]; directions];
        for j in 1..count {
            for i in 0..j {
                let by = self.places[place].at[i] - self.places[place].at[j];
                for k in 0..directions {
                    let d = (k, self.directions[k]);
                    let pair = &mut self.pairs[j * (j - 1) / 2 + i];
                    let room = pair.room(by, d, &mut self.searched)?;
                    rooms[k][i * count + j] = room;
                    // One moves, or the other against it.
                    rooms[k ^ 1][j * count + i] = room;
                }
            }
        }
        Ok(rooms)
    }

    /// The groups that move along a direction if whom they hit before `end` moves along, each once; those with the
    /// base, or what is fixed, are left out or turned: the others, against it.
    fn groups(&self, rooms: &[f64], end: f64) -> Vec<(Group, bool)> {
        let mut found = Vec::new();
        let all = Group::MAX >> (Group::BITS as usize - self.count);
        for first in 0..self.count {
            let (mut group, mut stack): (Group, _) = (1 << first, vec![first]);
            while let Some(i) = stack.pop() {
                for j in 0..self.count {
                    if group >> j & 1 == 0 && rooms[i * self.count + j] < end {
                        group |= 1 << j;
                        stack.push(j);
                    }
                }
            }
            let turned = group >> self.base & 1 == 1;
            let moving = if turned { all & !group } else { group };
            if moving != 0 && moving & self.fixed == 0 && !found.contains(&(moving, turned)) {
                found.push((moving, turned));
            }
        }
        found
    }

    /// The last moves that are possible, of the smallest groups first.
    fn leaving(&self, rooms: &[Vec<f64>]) -> Vec<Move> {
        let mut found = Vec::new();
        for (k, d) in self.directions.iter().enumerate() {
            for (group, turned) in self.groups(&rooms[k], f64::INFINITY) {
                found.push(Move { group, motion: if turned { DVec3::ZERO - *d } else { *d } });
            }
        }
        found.sort_by_key(|way| way.group.count_ones());
        found.truncate(4);
        found
    }

    /// The places that are reached from one, those that are new.
    fn next(&mut self, place: usize, rooms: &[Vec<f64>]) -> Vec<usize> {
        let mut new = Vec::new();
        for k in 0..self.directions.len() {
            for (group, turned) in self.groups(&rooms[k], self.scale.step) {
                let along = if turned { k ^ 1 } else { k };
                let pairs = self.border(group);
                let room = |&[i, j]: &[usize; 2]| rooms[along][i * self.count + j];
                let room = pairs.iter().map(room).fold(self.scale.far, f64::min);
                for t in self.stops(place, &pairs, along, room) {
                    new.extend(self.reach(place, group, self.directions[along] * t));
                }
            }
        }
        new
    }

    /// All pairs of one body in a group and one that is not.
    pub(super) fn border(&self, group: Group) -> Vec<[usize; 2]> {
        border(group, self.count)
    }

    /// Where a group that can go `room` along a direction may stop.
    fn stops(&mut self, place: usize, pairs: &[[usize; 2]], d: usize, room: f64) -> Vec<f64> {
        let Scale { far, step, off, .. } = self.scale;
        let mut stops = Vec::new();
        for e in 0..self.directions.len() {
            if e / 2 == d / 2 {
                continue;
            }
            for far in [8.0 * far, 5.0 * step, step] {
                let mut joint = Vec::new();
                for &[i, j] in pairs {
                    let blocked = self.blocked(place, [i, j], [d, e], [room, far]);
                    if pairs.len() > 1 {
                        put(&open(&blocked, room), off, step, &mut stops);
                    }
                    for span in blocked {
                        add(&mut joint, span);
                    }
                }
                put(&open(&joint, room), off, step, &mut stops);
            }
        }
        if room < far {
            stops.push(room - off);
        }
        stops.retain(|&t| t > off && t <= room - 0.5 * off);
        stops
    }

    fn blocked(
        &mut self,
        place: usize,
        [i, j]: [usize; 2],
        [d, e]: [usize; 2],
        lengths: [f64; 2],
    ) -> Vec<[f64; 2]> {
        let at = &self.places[place].at;
        // The second of a pair goes against the directions of the first.
        let turn = usize::from(i > j);
        let (low, high) = (i.min(j), i.max(j));
        let numbers = [d ^ turn, e ^ turn];
        let along = numbers.map(|k| self.directions[k]);
        let pair = &mut self.pairs[high * (high - 1) / 2 + low];
        pair.blocked(at[low] - at[high], numbers, along, lengths, &mut self.searched).to_vec()
    }

    /// The place to which a motion takes a group, if it is new.
    fn reach(&mut self, place: usize, group: Group, motion: DVec3) -> Option<usize> {
        let grid = self.scale.grid;
        let motion = motion.map(|x| (x / grid).round() * grid);
        let moved = |(k, at): (usize, &DVec3)| if group >> k & 1 == 1 { *at + motion } else { *at };
        let at: Vec<DVec3> = self.places[place].at.iter().enumerate().map(moved).collect();
        let fine = 2.5 * self.scale.off;
        let key = at.iter().map(|v| bits((*v / fine).round())).collect();
        if motion == DVec3::ZERO || !self.seen.insert(key) {
            return None;
        }
        let legs = self.places[place].legs + 1;
        self.places.push(Place { at, before: Some((place, Move { group, motion })), legs });
        Some(self.places.len() - 1)
    }

    /// What tells places apart.
    fn key(&self, place: usize, rooms: &[Vec<f64>]) -> (Vec<[u64; 3]>, u64) {
        let mut ways = DefaultHasher::new();
        for rooms in rooms {
            for room in rooms {
                (*room >= self.scale.step).hash(&mut ways);
            }
        }
        let cell = |v: &DVec3| bits((*v / self.scale.grain).round());
        (self.places[place].at.iter().map(cell).collect(), ways.finish())
    }

    /// The moves to a place.
    fn moves(&self, mut place: usize) -> Vec<Move> {
        let mut moves = Vec::new();
        while let Some((before, step)) = self.places[place].before {
            moves.push(step);
            place = before;
        }
        moves.reverse();
        moves
    }
}

/// All pairs of one body in a group and one that is not.
pub(super) fn border(group: Group, count: usize) -> Vec<[usize; 2]> {
    let within = |k: &usize| group >> k & 1 == 1;
    let outside = move |i: usize| (0..count).filter(move |j| !within(j)).map(move |j| [i, j]);
    (0..count).filter(within).flat_map(outside).collect()
}

/// Stops in openings that do not begin where the leg does.
fn put(openings: &[[f64; 2]], off: f64, step: f64, stops: &mut Vec<f64>) {
    for &[low, high] in openings {
        if low > off {
            stops.push(0.5 * (low + high));
            if high - low > 0.05 * step {
                stops.extend([low + off, high - off]);
            }
        }
    }
}
