//! Search over placements: fewest legs first, or best first with preference for regions with few placements.
//!
//! At a placement, each pair of bodies is cast along all directions. A body moves together with the bodies
//! that it hits within the minimum length of a move, as a *group*. If a group never hits the other bodies and
//! casts certify all legs, the path is found. Otherwise the group stops within openings for other directions
//! and just before the first contact. After two bodies have no unexplored placement left, last legs along any
//! free direction are tried.
//!
//! - The base, a fixed body or the largest one, never moves. Instead of a group with the base, all other bodies
//!   move in the opposite direction.
//! - Displacements lie on a grid that is finer than the distance from contacts. Their differences are exact.
//! - Two placements are equal if all bodies are in the same cells of a coarse grid and the same moves are
//!   possible.
//! - A group does not continue along the line of the leg that it has just made.
//! - Normals of facets that stop bodies give further directions, along which all explored placements are tried again.
//! - The order of exploration does not depend on the limits of work, so a larger limit continues the same search.

use std::cmp::Reverse;
use std::collections::hash_map::DefaultHasher;
use std::collections::{BinaryHeap, HashMap, VecDeque};
use std::hash::{Hash, Hasher};
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

use super::openings::{complement, insert_interval};
use super::options::{Order, RemovalOptions, SearchWork};
use super::pairs::{BodyPair, bit_key};
use super::walls::MetWalls;
use crate::directions::{FreeDirections, FreeError, FreeOptions};
use colltrans_convex::setting::error::QueryError;

/// Maximum number of placements at which free directions are computed.
const MAX_FREE_SETS: usize = 64;
/// Maximum number of node visits of each of these computations.
const MAX_FREE_VISITS: u64 = 200_000;
/// Number of explored placements after which directions along walls are added. It doubles each time.
const FIRST_WALL_PLACEMENTS: usize = 32;
/// Number of axes that are added each time, and the maximum number of all axes.
const NEW_AXES: usize = 3;
const MAX_AXES: usize = 24;
/// Size of the regions in which placements are counted, in cells of a placement.
const REGION_SIZE: f64 = 8.0;

/// Set of bodies, one bit for each.
pub(super) type Group = u128;

/// Planned leg: the bodies that move, and the vector. The last leg has a direction and no end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Move {
    pub(super) group: Group,
    pub(super) motion: DVec3,
}

/// Lengths of a search.
#[derive(Debug, Clone, Copy)]
pub(super) struct SearchScale {
    /// Length that exceeds the size of all bodies together.
    pub(super) far: f64,
    /// Minimum length of a move of the largest body.
    pub(super) step: f64,
    /// Distance from a contact, or from the end of an opening, at which a leg stops.
    pub(super) off: f64,
    /// Power of two of which displacements are multiples.
    pub(super) grid: f64,
}

struct Placement {
    at: Vec<DVec3>,
    before: Option<(usize, Move)>,
    /// Index of the axis along which it was reached.
    axis: Option<usize>,
    legs: usize,
    /// The group that made all legs, if it is only one.
    mover: Option<Group>,
    progress: Progress,
}

/// Progress of a placement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Progress {
    Unexplored,
    /// Explored: last legs were tried. Placements beyond it are still missing.
    Explored,
    /// Explored, and not continued any more.
    Finished,
}

/// Entry of a queue: the cost, the placement, and whether placements beyond it are wanted.
type QueueEntry = Reverse<(usize, usize, bool)>;

/// Which bodies move, and how far at least.
pub(super) struct BodyRoles {
    /// Bodies that do not move, including the base.
    pub(super) fixed: Group,
    pub(super) base: usize,
    /// Bodies that the last leg may remove.
    pub(super) leaving: Group,
    /// Minimum length of a move of each body. It is also the size of the cells in which placements are equal.
    pub(super) steps: Vec<f64>,
}

/// Identity of a placement.
type PlacementKey = (Vec<[u64; 3]>, u64);

/// End of a search.
pub(super) enum SearchEnd<P> {
    Found(P),
    /// Unexplored placements remain.
    Paused,
    /// A limit was reached, or all placements were explored and the search is complete.
    Ended,
}

pub(super) struct Search<'s, 'a> {
    /// Pair of the bodies `i < j` at index `j (j - 1) / 2 + i`.
    pub(super) pairs: Vec<BodyPair<'a>>,
    pub(super) count: usize,
    roles: BodyRoles,
    pub(super) directions: Vec<DVec3>,
    pub(super) scale: SearchScale,
    pub(super) options: &'s RemovalOptions,
    order: Order,
    pub(super) cancel: Option<&'s AtomicBool>,
    pub(super) searched: SearchWork,
    placements: Vec<Placement>,
    /// Placements by cost.
    queue: BinaryHeap<QueueEntry>,
    /// Placements that one group alone has reached, best first, if the other queue has the fewest legs first.
    focused: BinaryHeap<QueueEntry>,
    focused_work: u64,
    walls: MetWalls,
    /// Number of explored placements at which directions along walls are added next.
    next_walls: usize,
    /// Explored placements.
    explored: Vec<usize>,
    /// Fewest legs by which placements were reached, by their identity.
    known: HashMap<PlacementKey, usize>,
    /// Fewest legs by which placements were reached, by their cells in a fine grid.
    seen: HashMap<Vec<[u64; 3]>, usize>,
    /// Number of placements that were reached in each region.
    region_counts: HashMap<Vec<[u64; 3]>, usize>,
}

impl<'s, 'a> Search<'s, 'a> {
    pub(super) fn new(
        pairs: Vec<BodyPair<'a>>,
        roles: BodyRoles,
        directions: Vec<DVec3>,
        scale: SearchScale,
        options: &'s RemovalOptions,
        cancel: Option<&'s AtomicBool>,
    ) -> Self {
        let count = roles.steps.len();
        let own = if count == 2 { Order::NewestFirst } else { Order::FewestLegs };
        let order = options.order.unwrap_or(own);
        let searched = SearchWork { directions: directions.len(), ..SearchWork::default() };
        let start = Placement {
            at: vec![DVec3::ZERO; count],
            before: None,
            axis: None,
            legs: 0,
            mover: None,
            progress: Progress::Unexplored,
        };
        let (seen, known, region_counts) = (HashMap::new(), HashMap::new(), HashMap::new());
        Self {
            pairs,
            count,
            roles,
            directions,
            scale,
            options,
            order,
            cancel,
            searched,
            placements: vec![start],
            queue: BinaryHeap::from([Reverse((0, 0, false))]),
            focused: BinaryHeap::new(),
            focused_work: 0,
            walls: MetWalls::default(),
            next_walls: FIRST_WALL_PLACEMENTS,
            explored: Vec::new(),
            known,
            seen,
            region_counts,
        }
    }

    /// Searches for legs that separate some bodies from the others and that `proven` accepts. Pauses after
    /// `places` explored placements in total.
    pub(super) fn run<P>(
        &mut self,
        places: usize,
        mut proven: impl FnMut(&[Move]) -> Result<Option<P>, FreeError>,
    ) -> Result<SearchEnd<P>, FreeError> {
        loop {
            self.check_cancelled()?;
            let is_empty = self.queue.is_empty() && self.focused.is_empty();
            if (is_empty || self.searched.places >= self.next_walls)
                && self.add_directions_of_walls()
            {
                continue;
            }
            if is_empty {
                break;
            }
            if self.is_limit_reached() {
                return Ok(SearchEnd::Ended);
            }
            if self.searched.places >= places {
                return Ok(SearchEnd::Paused);
            }
            let before = self.searched.total();
            let is_focused = !self.focused.is_empty()
                && (self.queue.is_empty()
                    || self.focused_work + RemovalOptions::FIRST_FOCUSED_WORK
                        < before - self.focused_work);
            let queue = if is_focused { &mut self.focused } else { &mut self.queue };
            let Some(Reverse((_, at, go_on))) = queue.pop() else { continue };
            if self.placements[at].progress == Progress::Unexplored
                && let Some(way) = self.explore(at, &mut proven)?
            {
                return Ok(SearchEnd::Found(way));
            }
            if self.placements[at].progress == Progress::Explored {
                if go_on || is_focused || self.order == Order::NewestFirst {
                    self.continue_from(at)?;
                } else {
                    // Placements beyond this one cost one leg more, so others of its cost are explored first.
                    self.queue.push(Reverse((2 * self.placements[at].legs + 1, at, true)));
                }
            }
            if is_focused {
                self.focused_work += self.searched.total() - before;
            }
        }
        self.searched.complete = !self.is_limit_reached();
        Ok(SearchEnd::Ended)
    }

    /// Tries last legs at a placement. Returns the first one that `proven` accepts.
    fn explore<P>(
        &mut self,
        at: usize,
        proven: &mut impl FnMut(&[Move]) -> Result<Option<P>, FreeError>,
    ) -> Result<Option<P>, FreeError> {
        self.searched.places += 1;
        let travels = self.free_travels(at)?;
        for last in self.last_moves(&travels, 0) {
            if let Some(way) = proven(&self.moves_to(at, last))? {
                return Ok(Some(way));
            }
        }
        self.explored.push(at);
        let legs = self.placements[at].legs;
        let key = self.placement_key(at, &travels);
        let goes_on = legs + 2 <= self.options.legs && is_improvement(&mut self.known, key, legs);
        self.placements[at].progress =
            if goes_on { Progress::Explored } else { Progress::Finished };
        Ok(None)
    }

    /// Adds the placements beyond an explored one to the queues.
    fn continue_from(&mut self, at: usize) -> Result<(), FreeError> {
        let travels = self.free_travels(at)?;
        for place in self.new_placements(at, &travels)? {
            self.enqueue(place);
        }
        self.placements[at].progress = Progress::Finished;
        Ok(())
    }

    fn enqueue(&mut self, place: usize) {
        if self.order == Order::NewestFirst {
            let cost = self.best_first_cost(place);
            self.queue.push(Reverse((cost, place, false)));
            return;
        }
        self.queue.push(Reverse((2 * self.placements[place].legs, place, false)));
        if self.placements[place].mover.is_some() {
            let cost = self.best_first_cost(place);
            self.focused.push(Reverse((cost, place, true)));
        }
    }

    /// Adds directions along the walls that have stopped bodies. Returns whether there are new ones. All explored
    /// placements are then explored again.
    fn add_directions_of_walls(&mut self) -> bool {
        while self.next_walls <= self.searched.places {
            self.next_walls *= 2;
        }
        let axes = self.directions.len() / 2;
        let new =
            self.walls.new_axes(&self.directions, NEW_AXES.min(MAX_AXES.saturating_sub(axes)));
        if new.is_empty() {
            return false;
        }
        self.directions.extend(new.into_iter().flat_map(|axis| [axis, DVec3::ZERO - axis]));
        self.searched.directions = self.directions.len();
        self.explored.clear();
        for place in 0..self.placements.len() {
            let placement = &mut self.placements[place];
            if placement.progress != Progress::Unexplored {
                placement.progress = Progress::Unexplored;
                self.enqueue(place);
            }
        }
        true
    }

    /// Searches for a last leg along any free direction at an explored placement. Returns `None` if `proven`
    /// accepts none.
    pub(super) fn last_leg_in_any_direction<P>(
        &mut self,
        mut proven: impl FnMut(&[Move]) -> Result<Option<P>, FreeError>,
    ) -> Result<Option<P>, FreeError> {
        let mut explored = std::mem::take(&mut self.explored);
        explored.sort_by_key(|&place| self.placements[place].legs);
        explored.truncate(MAX_FREE_SETS);
        for place in explored {
            for last in self.last_moves_in_free_directions(place)? {
                if let Some(way) = proven(&self.moves_to(place, last))? {
                    return Ok(Some(way));
                }
            }
        }
        Ok(None)
    }

    /// Shortens a proposed path of displacements of the first of two bodies against the second one: it finds
    /// a path with few legs, each from one displacement to a later one, that casts permit. `sign` is -1 if
    /// the second body moves instead. Returns `None` if `proven` accepts no path.
    pub(super) fn shortened_path<P>(
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
            self.check_cancelled()?;
            for &d in &self.directions.clone() {
                if self.pairs[0].uncached_free_travel(places[at], d, &mut self.searched)?
                    < f64::INFINITY
                {
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
                    if self.pairs[0].uncached_free_travel(places[at], d, &mut self.searched)?
                        > length
                    {
                        (before[next], legs[next]) = (Some(at), legs[at] + 1);
                        queue.push_back(next);
                    }
                }
            }
        }
        Ok(None)
    }

    fn check_cancelled(&self) -> Result<(), FreeError> {
        let cancelled = self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed));
        if cancelled { Err(FreeError::Cancelled) } else { Ok(()) }
    }

    /// Checks whether a limit is reached.
    fn is_limit_reached(&self) -> bool {
        let (searched, most) = (&self.searched, self.options);
        searched.looks >= most.looks
            || searched.casts >= most.casts
            || searched.places >= most.places
            || searched.total() >= most.work
    }

    /// Returns the cost of a placement in a best-first search. The smallest cost is explored first.
    fn best_first_cost(&mut self, place: usize) -> usize {
        let Placement { at, legs, .. } = &self.placements[place];
        let region = self.body_cells(at, REGION_SIZE);
        let legs = *legs;
        let region_count = self.region_counts.entry(region).or_default();
        *region_count += 1;
        legs + 2 * (*region_count - 1)
    }

    /// Returns the cell of each body. Cells have this multiple of the minimum length of a move.
    fn body_cells(&self, at: &[DVec3], size: f64) -> Vec<[u64; 3]> {
        let cell = |(v, step): (&DVec3, &f64)| bit_key((*v / (size * step)).round());
        at.iter().zip(&self.roles.steps).map(cell).collect()
    }

    /// Returns for each direction a matrix of free travels. The entry `i * count + j` is the free travel of
    /// body `i` against body `j`; it may be 0 if it is below the minimum length of a move.
    fn free_travels(&mut self, place: usize) -> Result<Vec<Vec<f64>>, FreeError> {
        let mut travels = vec![vec![f64::INFINITY; self.count * self.count]; self.directions.len()];
        for k in 0..self.directions.len() {
            self.compute_travels(place, k, &mut travels)?;
        }
        Ok(travels)
    }

    /// Computes the free travels of all pairs along a direction. That of the first body of a pair equals that
    /// of the second one in the opposite direction.
    fn compute_travels(
        &mut self,
        place: usize,
        k: usize,
        travels: &mut [Vec<f64>],
    ) -> Result<(), QueryError> {
        let (count, d) = (self.count, (k, self.directions[k]));
        for j in 1..count {
            for i in 0..j {
                let by = self.placements[place].at[i] - self.placements[place].at[j];
                let pair = &mut self.pairs[j * (j - 1) / 2 + i];
                let travel = pair.free_travel(by, d, &mut self.searched)?;
                pair.hit_normals.drain(..).for_each(|normal| self.walls.add(normal));
                travels[k][i * count + j] = travel;
                travels[k ^ 1][j * count + i] = travel;
            }
        }
        Ok(())
    }

    /// Returns the distinct groups that move along a direction if the bodies that they hit join them: before the
    /// minimum length of a move of the body that hits, or at any distance with `ever`. A group with the base is
    /// replaced by the other bodies, with the flag set for the opposite motion. Groups with fixed bodies are omitted.
    fn moving_groups(&self, travels: &[f64], ever: bool) -> Vec<(Group, bool)> {
        let mut found = Vec::new();
        let all = Group::MAX >> (Group::BITS as usize - self.count);
        let hit_by = |i: usize| {
            let end = if ever { f64::INFINITY } else { self.roles.steps[i] };
            let row = &travels[i * self.count..(i + 1) * self.count];
            let hit = |(j, travel): (usize, &f64)| Group::from(j != i && *travel < end) << j;
            row.iter().enumerate().fold(0, |mask, entry| mask | hit(entry))
        };
        let hits: Vec<Group> = (0..self.count).map(hit_by).collect();
        for first in 0..self.count {
            let (mut group, mut new): (Group, Group) = (1 << first, 1 << first);
            while new != 0 {
                let i = new.trailing_zeros() as usize;
                let joining = hits[i] & !group;
                group |= joining;
                new = (new & (new - 1)) | joining;
            }
            let reversed = group >> self.roles.base & 1 == 1;
            let moving = if reversed { all & !group } else { group };
            if moving != 0 && moving & self.roles.fixed == 0 && !found.contains(&(moving, reversed))
            {
                found.push((moving, reversed));
            }
        }
        found
    }

    /// Returns possible last moves along the directions from an index on, smallest groups first, at most
    /// four.
    fn last_moves(&self, travels: &[Vec<f64>], from: usize) -> Vec<Move> {
        let mut found = Vec::new();
        for (k, d) in self.directions.iter().enumerate().skip(from) {
            let groups = self.moving_groups(&travels[k], true).into_iter();
            for (group, reversed) in groups.filter(|(group, _)| group & !self.roles.leaving == 0) {
                found.push(Move { group, motion: if reversed { DVec3::ZERO - *d } else { *d } });
            }
        }
        found.sort_by_key(|way| way.group.count_ones());
        found.truncate(4);
        found
    }

    /// Returns last moves along free directions of each body, relative to the other body that leaves it the
    /// smallest area.
    fn last_moves_in_free_directions(&mut self, place: usize) -> Result<Vec<Move>, FreeError> {
        let (count, known) = (self.count, self.directions.len());
        let mut askew = Vec::new();
        for i in (0..count).filter(|i| self.roles.fixed >> i & 1 == 0) {
            let mut least: Option<(f64, Vec<DVec3>)> = None;
            for j in (0..count).filter(|&j| j != i) {
                self.check_cancelled()?;
                let (low, high) = (i.min(j), i.max(j));
                let pair = &self.pairs[high * (high - 1) / 2 + low];
                if pair.overlap.is_some() {
                    continue;
                }
                let by = self.placements[place].at[low] - self.placements[place].at[high];
                let [a, b] = pair.placed_bodies(by)?;
                let (moving, fixed) = if i < j { (a, b) } else { (b, a) };
                let options =
                    FreeOptions::DEFAULT.with_tolerance(pair.tolerance).with_looks(MAX_FREE_VISITS);
                self.searched.free_sets += 1;
                // Rounding can cause an overlap at the planned placement. Such a pair is skipped.
                let Ok(free) = FreeDirections::compute(&moving, &fixed, options) else { continue };
                let area = free.free_area()[1] + free.undecided_area();
                if least.as_ref().is_none_or(|least| area < least.0) {
                    least = Some((area, sample_free_directions(&free)));
                }
            }
            askew.extend(least.map_or_else(Vec::new, |least| least.1));
        }
        for d in askew {
            self.directions.extend([d, DVec3::ZERO - d]);
        }
        let mut travels = vec![vec![f64::INFINITY; count * count]; self.directions.len()];
        for k in known..self.directions.len() {
            self.compute_travels(place, k, &mut travels)?;
        }
        let found = self.last_moves(&travels, known);
        self.directions.truncate(known);
        for pair in &mut self.pairs {
            pair.forget_travels(known);
        }
        Ok(found)
    }

    /// Returns the new placements that can be reached from a placement.
    fn new_placements(
        &mut self,
        place: usize,
        travels: &[Vec<f64>],
    ) -> Result<Vec<usize>, FreeError> {
        let mut new = Vec::new();
        let came = self.placements[place].before.map(|(_, step)| step.group);
        for k in 0..self.directions.len() {
            for (group, reversed) in self.moving_groups(&travels[k], false) {
                if came == Some(group) && self.placements[place].axis == Some(k / 2) {
                    continue;
                }
                if self.is_limit_reached() {
                    return Ok(new);
                }
                let along = if reversed { k ^ 1 } else { k };
                let pairs = self.moving_pairs(group);
                let travel = |&[i, j]: &[usize; 2]| travels[along][i * self.count + j];
                let travel = pairs.iter().map(travel).fold(self.scale.far, f64::min);
                let step = (0..self.count)
                    .filter(|k| group >> k & 1 == 1)
                    .map(|k| self.roles.steps[k])
                    .fold(self.scale.step, f64::min);
                for t in self.stop_positions(place, &pairs, along, [travel, step])? {
                    new.extend(self.placement_after(place, group, (along, t)));
                }
            }
        }
        Ok(new)
    }

    /// Returns all pairs of a body in a group and a body outside it.
    pub(super) fn moving_pairs(&self, group: Group) -> Vec<[usize; 2]> {
        moving_pairs(group, self.count)
    }

    /// Returns the positions at which a group with free travel `travel` along a direction may stop. `step` is the
    /// minimum length of a move of the group.
    fn stop_positions(
        &mut self,
        place: usize,
        pairs: &[[usize; 2]],
        d: usize,
        [travel, step]: [f64; 2],
    ) -> Result<Vec<f64>, QueryError> {
        let SearchScale { far, off, .. } = self.scale;
        let mut stops = Vec::new();
        for e in 0..self.directions.len() {
            if e / 2 == d / 2 {
                continue;
            }
            // Openings for long moves come first. One for a shorter move around such a stop adds no further stop.
            let (mut own, mut shared) = (vec![Vec::new(); pairs.len()], Vec::new());
            for far in [8.0 * far, 5.0 * step, step] {
                let mut joint = Vec::new();
                for (pair, own) in pairs.iter().zip(&mut own) {
                    let blocked = self.blocked_intervals(place, *pair, [d, e], [travel, far])?;
                    if pairs.len() > 1 {
                        add_stops(&complement(&blocked, travel), off, step, own);
                    }
                    for span in blocked {
                        insert_interval(&mut joint, span);
                    }
                }
                add_stops(&complement(&joint, travel), off, step, &mut shared);
            }
            stops.extend(shared.into_iter().chain(own.into_iter().flatten()));
        }
        if travel < far {
            stops.push(travel - off);
        }
        stops.retain(|&t| t > off && t <= travel - 0.5 * off);
        Ok(stops)
    }

    fn blocked_intervals(
        &mut self,
        place: usize,
        [i, j]: [usize; 2],
        [d, e]: [usize; 2],
        lengths: [f64; 2],
    ) -> Result<Vec<[f64; 2]>, QueryError> {
        let at = &self.placements[place].at;
        // The second body of a pair moves opposite to the directions of the first one.
        let turn = usize::from(i > j);
        let (low, high) = (i.min(j), i.max(j));
        let numbers = [d ^ turn, e ^ turn];
        let along = numbers.map(|k| self.directions[k]);
        let pair = &mut self.pairs[high * (high - 1) / 2 + low];
        let by = at[low] - at[high];
        Ok(pair.blocked_intervals(by, numbers, along, lengths, &mut self.searched)?.to_vec())
    }

    /// Returns the placement after a motion of length `t` of a group along a direction. Returns `None` if it
    /// is not new.
    fn placement_after(
        &mut self,
        place: usize,
        group: Group,
        (d, t): (usize, f64),
    ) -> Option<usize> {
        let grid = self.scale.grid;
        let motion = (self.directions[d] * t).map(|x| (x / grid).round() * grid);
        let moved = |(k, at): (usize, &DVec3)| if group >> k & 1 == 1 { *at + motion } else { *at };
        let at: Vec<DVec3> = self.placements[place].at.iter().enumerate().map(moved).collect();
        let fine = 2.5 * self.scale.off;
        let key = at.iter().map(|v| bit_key((*v / fine).round())).collect();
        let legs = self.placements[place].legs + 1;
        if motion == DVec3::ZERO || !is_improvement(&mut self.seen, key, legs) {
            return None;
        }
        let Placement { before, mover, .. } = &self.placements[place];
        let mover = if before.is_none() { Some(group) } else { mover.filter(|own| *own == group) };
        let before = Some((place, Move { group, motion }));
        let (axis, progress) = (Some(d / 2), Progress::Unexplored);
        self.placements.push(Placement { at, before, axis, legs, mover, progress });
        Some(self.placements.len() - 1)
    }

    /// Returns the identity of a placement.
    fn placement_key(&self, place: usize, travels: &[Vec<f64>]) -> PlacementKey {
        let mut ways = DefaultHasher::new();
        for travels in travels {
            for (k, travel) in travels.iter().enumerate() {
                let step = self.roles.steps[k / self.count];
                (*travel >= step).hash(&mut ways);
            }
        }
        (self.body_cells(&self.placements[place].at, 1.0), ways.finish())
    }

    /// Returns the moves to a placement, followed by the last one.
    fn moves_to(&self, mut place: usize, last: Move) -> Vec<Move> {
        let mut moves = vec![last];
        while let Some((before, step)) = self.placements[place].before {
            moves.push(step);
            place = before;
        }
        moves.reverse();
        moves
    }
}

/// Records the number of legs by which a key was reached. Returns `true` if it is smaller than all before.
fn is_improvement<K: Eq + Hash>(reached: &mut HashMap<K, usize>, key: K, legs: usize) -> bool {
    let fewest = reached.entry(key).or_insert(usize::MAX);
    let new = legs < *fewest;
    *fewest = legs.min(*fewest);
    new
}

/// Returns some directions of length 1 that are free up to rounding: centers of all regions, isolated
/// directions, directions of arcs, and free directions in undecided cells.
fn sample_free_directions(free: &FreeDirections<'_>) -> Vec<DVec3> {
    let mut some: Vec<DVec3> = free.regions().iter().map(|region| region.center).collect();
    some.extend(free.points().iter().map(|point| point.direction));
    some.extend(free.arcs().iter().flat_map(|arc| arc.along.clone()));
    some.extend(free.free_among_undecided());
    some.into_iter().map(DVec3::normalize).collect()
}

/// Returns all pairs of a body in a group and a body outside it.
pub(super) fn moving_pairs(group: Group, count: usize) -> Vec<[usize; 2]> {
    let within = |k: &usize| group >> k & 1 == 1;
    let outside = move |i: usize| (0..count).filter(move |j| !within(j)).map(move |j| [i, j]);
    (0..count).filter(within).flat_map(outside).collect()
}

/// Adds stops to the openings that contain none: a point near the end if the opening begins with the leg,
/// otherwise its center and, for a wide opening, points near both ends.
fn add_stops(openings: &[[f64; 2]], off: f64, step: f64, stops: &mut Vec<f64>) {
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
