//! The search over places: those in regions where few places are first, so that a clearance, in which there are many, is left
//! soon; or those with the fewest legs, so the first way found has the fewest of those that it looks for.
//!
//! At a place each pair of bodies is cast along all directions. Who is hit within a step moves along: so each body and
//! each direction have a least group. A group that never hits the rest leaves, and that is the answer. Else it goes
//! along and stops in the middle of the openings for other directions, of all its pairs together and of each alone (and
//! near the ends of wide ones), and before what it hits; never at it. When no place is left, all directions along which
//! a body leaves another one are asked for at the first of them, for last legs that are skew.
//!
//! *Invariants.* The base, a body that is fixed or the largest, never moves: a group with it stays where it is, and
//! the others move against the direction. Displacements lie on a grid that is finer than the slack, whose
//! differences are exact. Two places are one if all bodies are in the same cells of a coarse grid and the same pairs
//! can move along the same directions. A group that has come along a line does not go on along it: from where it came
//! it has been to all its openings.

use std::cmp::Reverse;
use std::collections::hash_map::DefaultHasher;
use std::collections::{BinaryHeap, HashMap, VecDeque};
use std::hash::{Hash, Hasher};
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

use super::openings::{add, open};
use super::options::{Order, Searched, WayOptions};
use super::pairs::{Pair, bits};
use crate::free::{FreeDirections, FreeError, FreeOptions};
use colltrans_convex::setting::error::QueryError;

/// Places at which free sets are asked for, at most, and pairs of nodes that each looks at.
const MOST_FREE_SETS: usize = 64;
const FREE_LOOKS: u64 = 200_000;
/// Regions of new places, in cells of one place.
const REGION: f64 = 8.0;

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
    /// The axis along which it was reached.
    axis: Option<usize>,
    legs: usize,
}

/// What tells places apart.
type Key = (Vec<[u64; 3]>, u64);

/// How a search ended.
pub(super) enum Run<P> {
    Found(P),
    /// Places are left for another time.
    Paused,
    /// A limit was reached, or all places were left: then what was searched is complete.
    Ended,
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
    order: Order,
    pub(super) cancel: Option<&'s AtomicBool>,
    pub(super) searched: Searched,
    places: Vec<Place>,
    /// Places to be left, by their cost.
    queue: BinaryHeap<Reverse<(usize, usize)>>,
    /// Places that were left.
    left: Vec<usize>,
    /// Places that are one, and in the finest cells, with the fewest legs by which they were reached.
    known: HashMap<Key, usize>,
    seen: HashMap<Vec<[u64; 3]>, usize>,
    /// How many places were reached in each region.
    crowds: HashMap<Vec<[u64; 3]>, usize>,
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
        let own = if count == 2 { Order::NewestFirst } else { Order::FewestLegs };
        let order = options.order.unwrap_or(own);
        let searched = Searched { directions: directions.len(), ..Searched::default() };
        let start = Place { at: vec![DVec3::ZERO; count], before: None, axis: None, legs: 0 };
        let (places, queue, left) = (vec![start], BinaryHeap::from([Reverse((0, 0))]), Vec::new());
        let (seen, known, crowds) = (HashMap::new(), HashMap::new(), HashMap::new());
        Self {
            pairs,
            count,
            fixed,
            base,
            directions,
            scale,
            options,
            order,
            cancel,
            searched,
            places,
            queue,
            left,
            known,
            seen,
            crowds,
        }
    }

    /// Legs that take some bodies away from the others, which `proven` accepts; at most so many places are left until
    /// it pauses.
    pub(super) fn run<P>(
        &mut self,
        places: usize,
        mut proven: impl FnMut(&[Move]) -> Result<Option<P>, FreeError>,
    ) -> Result<Run<P>, FreeError> {
        while let Some(&Reverse((_, at))) = self.queue.peek() {
            self.check()?;
            if self.is_spent() {
                return Ok(Run::Ended);
            }
            if self.searched.places >= places {
                return Ok(Run::Paused);
            }
            self.queue.pop();
            self.searched.places += 1;
            let rooms = self.rooms(at)?;
            for last in self.leaving(&rooms, 0) {
                if let Some(way) = proven(&self.moves(at, last))? {
                    return Ok(Run::Found(way));
                }
            }
            self.left.push(at);
            let goes_on = self.places[at].legs + 2 <= self.options.legs;
            let (key, legs) = (self.key(at, &rooms), self.places[at].legs);
            if goes_on && is_new(&mut self.known, key, legs) {
                let new = self.next(at, &rooms)?;
                for place in new {
                    let cost = self.cost(place);
                    self.queue.push(Reverse((cost, place)));
                }
            }
        }
        self.searched.complete = !self.is_spent();
        Ok(Run::Ended)
    }

    /// The same with a last leg along directions that are free at places which have been left, whatever they are.
    pub(super) fn askew<P>(
        &mut self,
        mut proven: impl FnMut(&[Move]) -> Result<Option<P>, FreeError>,
    ) -> Result<Option<P>, FreeError> {
        let mut left = std::mem::take(&mut self.left);
        left.sort_by_key(|&place| self.places[place].legs);
        left.truncate(MOST_FREE_SETS);
        for place in left {
            for last in self.leaving_askew(place)? {
                if let Some(way) = proven(&self.moves(place, last))? {
                    return Ok(Some(way));
                }
            }
        }
        Ok(None)
    }

    /// A proposal of displacements of the first of two bodies, from one to the next and then on without an end, in as
    /// few legs from one of them to a later one as casts allow; `sign` is -1 if it is the other that moves.
    pub(super) fn shortened<P>(
        &mut self,
        body: usize,
        (places, grid, sign): (&[DVec3], f64, f64),
        mut proven: impl FnMut(&[Move]) -> Result<Option<P>, FreeError>,
    ) -> Result<Option<P>, FreeError> {
        let group = 1 << body;
        let on_grid = |v: &DVec3| v.map(|x| (x / grid).round() * grid);
        let places: Vec<DVec3> = places.iter().map(on_grid).collect();
        let leg = |motion: DVec3| Move { group, motion: motion * sign };
        let (mut before, mut legs) = (vec![None; places.len()], vec![0; places.len()]);
        let mut queue = VecDeque::from([0]);
        while let Some(at) = queue.pop_front() {
            self.check()?;
            for &d in &self.directions.clone() {
                if self.pairs[0].room_along(places[at], d, &mut self.searched)? < f64::INFINITY {
                    continue;
                }
                let way = std::iter::successors(Some(at), |&k| before[k]);
                let step = |k: usize| before[k].map(|from: usize| leg(places[k] - places[from]));
                let mut moves: Vec<Move> = way.filter_map(step).collect();
                moves.reverse();
                moves.push(leg(d));
                if let Some(way) = proven(&moves)? {
                    return Ok(Some(way));
                }
            }
            let goes_on = legs[at] + 2 <= self.options.legs;
            for next in (at + 1..places.len()).filter(|_| goes_on) {
                let motion = places[next] - places[at];
                let length = motion.length();
                if before[next].is_none() && length > 0.0 {
                    let d = motion / length;
                    if self.pairs[0].room_along(places[at], d, &mut self.searched)? > length {
                        (before[next], legs[next]) = (Some(at), legs[at] + 1);
                        queue.push_back(next);
                    }
                }
            }
        }
        Ok(None)
    }

    fn check(&self) -> Result<(), FreeError> {
        let cancelled = self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed));
        if cancelled { Err(FreeError::Cancelled) } else { Ok(()) }
    }

    /// Whether a limit is reached.
    fn is_spent(&self) -> bool {
        let (searched, most) = (&self.searched, self.options);
        searched.looks >= most.looks
            || searched.casts >= most.casts
            || searched.places >= most.places
    }

    /// What is left first: the least.
    fn cost(&mut self, place: usize) -> usize {
        let legs = self.places[place].legs;
        if self.order == Order::FewestLegs {
            return legs;
        }
        let cell = |v: &DVec3| bits((*v / (REGION * self.scale.grain)).round());
        let region = self.places[place].at.iter().map(cell).collect();
        let crowd = self.crowds.entry(region).or_default();
        *crowd += 1;
        legs + 2 * (*crowd - 1)
    }

    /// For each direction how far each body goes until it hits each other, in rows of the moving ones.
    fn rooms(&mut self, place: usize) -> Result<Vec<Vec<f64>>, FreeError> {
        let mut rooms = vec![vec![f64::INFINITY; self.count * self.count]; self.directions.len()];
        for k in 0..self.directions.len() {
            self.put_rooms(place, k, &mut rooms)?;
        }
        Ok(rooms)
    }

    /// Those of the first of each two bodies along a direction, which are those of the second against it.
    fn put_rooms(
        &mut self,
        place: usize,
        k: usize,
        rooms: &mut [Vec<f64>],
    ) -> Result<(), QueryError> {
        let (count, d) = (self.count, (k, self.directions[k]));
        for j in 1..count {
            for i in 0..j {
                let by = self.places[place].at[i] - self.places[place].at[j];
                let pair = &mut self.pairs[j * (j - 1) / 2 + i];
                let room = pair.room(by, d, &mut self.searched)?;
                rooms[k][i * count + j] = room;
                rooms[k ^ 1][j * count + i] = room;
            }
        }
        Ok(())
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

    /// The last moves that are possible along the directions from one on, of the smallest groups first.
    fn leaving(&self, rooms: &[Vec<f64>], from: usize) -> Vec<Move> {
        let mut found = Vec::new();
        for (k, d) in self.directions.iter().enumerate().skip(from) {
            for (group, turned) in self.groups(&rooms[k], f64::INFINITY) {
                found.push(Move { group, motion: if turned { DVec3::ZERO - *d } else { *d } });
            }
        }
        found.sort_by_key(|way| way.group.count_ones());
        found.truncate(4);
        found
    }

    /// The last moves along directions in the middle of what is free for a body against the one that leaves it least.
    fn leaving_askew(&mut self, place: usize) -> Result<Vec<Move>, FreeError> {
        let (count, known) = (self.count, self.directions.len());
        let mut askew = Vec::new();
        for i in (0..count).filter(|i| self.fixed >> i & 1 == 0) {
            let mut least: Option<(f64, Vec<DVec3>)> = None;
            for j in (0..count).filter(|&j| j != i) {
                self.check()?;
                let (low, high) = (i.min(j), i.max(j));
                let pair = &self.pairs[high * (high - 1) / 2 + low];
                if pair.overlap.is_some() {
                    continue;
                }
                let by = self.places[place].at[low] - self.places[place].at[high];
                let [a, b] = pair.placed(by)?;
                let (moving, fixed) = if i < j { (a, b) } else { (b, a) };
                let options =
                    FreeOptions::DEFAULT.with_tolerance(pair.tolerance).with_looks(FREE_LOOKS);
                self.searched.free_sets += 1;
                // What rounding has made an overlap of, at the planned place, is left out.
                let Ok(free) = FreeDirections::of(&moving, &fixed, options) else { continue };
                let area = free.free_area()[1] + free.undecided_area();
                if least.as_ref().is_none_or(|least| area < least.0) {
                    least = Some((area, some_of(&free)));
                }
            }
            askew.extend(least.map_or_else(Vec::new, |least| least.1));
        }
        for d in askew {
            self.directions.extend([d, DVec3::ZERO - d]);
        }
        let mut rooms = vec![vec![f64::INFINITY; count * count]; self.directions.len()];
        for k in known..self.directions.len() {
            self.put_rooms(place, k, &mut rooms)?;
        }
        let found = self.leaving(&rooms, known);
        self.directions.truncate(known);
        for pair in &mut self.pairs {
            pair.forget_rooms(known);
        }
        Ok(found)
    }

    /// The places that are reached from one, those that are new.
    fn next(&mut self, place: usize, rooms: &[Vec<f64>]) -> Result<Vec<usize>, FreeError> {
        let mut new = Vec::new();
        let came = self.places[place].before.map(|(_, step)| step.group);
        for k in 0..self.directions.len() {
            for (group, turned) in self.groups(&rooms[k], self.scale.step) {
                if came == Some(group) && self.places[place].axis == Some(k / 2) {
                    continue;
                }
                if self.is_spent() {
                    return Ok(new);
                }
                let along = if turned { k ^ 1 } else { k };
                let pairs = self.border(group);
                let room = |&[i, j]: &[usize; 2]| rooms[along][i * self.count + j];
                let room = pairs.iter().map(room).fold(self.scale.far, f64::min);
                for t in self.stops(place, &pairs, along, room)? {
                    new.extend(self.reach(place, group, (along, t)));
                }
            }
        }
        Ok(new)
    }

    /// All pairs of one body in a group and one that is not.
    pub(super) fn border(&self, group: Group) -> Vec<[usize; 2]> {
        border(group, self.count)
    }

    /// Where a group that can go `room` along a direction may stop.
    fn stops(
        &mut self,
        place: usize,
        pairs: &[[usize; 2]],
        d: usize,
        room: f64,
    ) -> Result<Vec<f64>, QueryError> {
        let Scale { far, step, off, .. } = self.scale;
        let mut stops = Vec::new();
        for e in 0..self.directions.len() {
            if e / 2 == d / 2 {
                continue;
            }
            // In openings for far moves first: one for a shorter move around such a stop is none of its own.
            let (mut own, mut shared) = (vec![Vec::new(); pairs.len()], Vec::new());
            for far in [8.0 * far, 5.0 * step, step] {
                let mut joint = Vec::new();
                for (pair, own) in pairs.iter().zip(&mut own) {
                    let blocked = self.blocked(place, *pair, [d, e], [room, far])?;
                    if pairs.len() > 1 {
                        put(&open(&blocked, room), off, step, own);
                    }
                    for span in blocked {
                        add(&mut joint, span);
                    }
                }
                put(&open(&joint, room), off, step, &mut shared);
            }
            stops.extend(shared.into_iter().chain(own.into_iter().flatten()));
        }
        if room < far {
            stops.push(room - off);
        }
        stops.retain(|&t| t > off && t <= room - 0.5 * off);
        Ok(stops)
    }

    fn blocked(
        &mut self,
        place: usize,
        [i, j]: [usize; 2],
        [d, e]: [usize; 2],
        lengths: [f64; 2],
    ) -> Result<Vec<[f64; 2]>, QueryError> {
        let at = &self.places[place].at;
        // The second of a pair goes against the directions of the first.
        let turn = usize::from(i > j);
        let (low, high) = (i.min(j), i.max(j));
        let numbers = [d ^ turn, e ^ turn];
        let along = numbers.map(|k| self.directions[k]);
        let pair = &mut self.pairs[high * (high - 1) / 2 + low];
        let by = at[low] - at[high];
        Ok(pair.blocked(by, numbers, along, lengths, &mut self.searched)?.to_vec())
    }

    /// The place to which a motion, so far along a direction, takes a group, if it is new.
    fn reach(&mut self, place: usize, group: Group, (d, t): (usize, f64)) -> Option<usize> {
        let grid = self.scale.grid;
        let motion = (self.directions[d] * t).map(|x| (x / grid).round() * grid);
        let moved = |(k, at): (usize, &DVec3)| if group >> k & 1 == 1 { *at + motion } else { *at };
        let at: Vec<DVec3> = self.places[place].at.iter().enumerate().map(moved).collect();
        let fine = 2.5 * self.scale.off;
        let key = at.iter().map(|v| bits((*v / fine).round())).collect();
        let legs = self.places[place].legs + 1;
        if motion == DVec3::ZERO || !is_new(&mut self.seen, key, legs) {
            return None;
        }
        let before = Some((place, Move { group, motion }));
        self.places.push(Place { at, before, axis: Some(d / 2), legs });
        Some(self.places.len() - 1)
    }

    /// What tells places apart.
    fn key(&self, place: usize, rooms: &[Vec<f64>]) -> Key {
        let mut ways = DefaultHasher::new();
        for rooms in rooms {
            for room in rooms {
                (*room >= self.scale.step).hash(&mut ways);
            }
        }
        let cell = |v: &DVec3| bits((*v / self.scale.grain).round());
        (self.places[place].at.iter().map(cell).collect(), ways.finish())
    }

    /// The moves to a place, and the last one.
    fn moves(&self, mut place: usize, last: Move) -> Vec<Move> {
        let mut moves = vec![last];
        while let Some((before, step)) = self.places[place].before {
            moves.push(step);
            place = before;
        }
        moves.reverse();
        moves
    }
}

/// Whether nobody was there with as few legs.
fn is_new<K: Eq + Hash>(reached: &mut HashMap<K, usize>, key: K, legs: usize) -> bool {
    let fewest = reached.entry(key).or_insert(usize::MAX);
    let new = legs < *fewest;
    *fewest = legs.min(*fewest);
    new
}

/// Some free directions: the middles of all regions, then points, some of arcs, and what is free though undecided.
fn some_of(free: &FreeDirections<'_>) -> Vec<DVec3> {
    let mut some: Vec<DVec3> = free.regions().iter().map(|region| region.center).collect();
    some.extend(free.points().iter().map(|point| point.direction));
    some.extend(free.arcs().iter().flat_map(|arc| arc.along.clone()));
    some.extend(free.free_among_undecided());
    some.into_iter().map(DVec3::normalize).collect()
}

/// All pairs of one body in a group and one that is not.
pub(super) fn border(group: Group, count: usize) -> Vec<[usize; 2]> {
    let within = |k: &usize| group >> k & 1 == 1;
    let outside = move |i: usize| (0..count).filter(move |j| !within(j)).map(move |j| [i, j]);
    (0..count).filter(within).flat_map(outside).collect()
}

/// Stops in openings in which there is none yet; in one that begins where the leg does, near its end.
fn put(openings: &[[f64; 2]], off: f64, step: f64, stops: &mut Vec<f64>) {
    for &[low, high] in openings {
        if stops.iter().any(|t| (low..=high).contains(t)) {
            continue;
        }
        if low <= off {
            stops.push(high - off);
        } else {
            stops.push(0.5 * (low + high));
            if high - low > 0.05 * step {
                stops.extend([low + off, high - off]);
            }
        }
    }
}
