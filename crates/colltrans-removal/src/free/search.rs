//! Breadth-first search over cells, in which each cell is decided or divided into quarters.
//!
//! A cell has a list of the pairs of nodes that may block some of its directions. The steps for a cell are:
//!
//! 1. *Blocked*, if the cone of one pair of facets contains its corners. Candidates are cones of the parent,
//!    and the result of a best-first search that dismisses pairs which miss a corner.
//! 2. *Open*, if its list is empty, or if no further pair blocks a direction outside the cones found at
//!    centers of its remainder. An empty remainder is blocked by several pairs together.
//! 3. *Inner*, if a box inside the moving and one inside the fixed body block it. Boxes are grown behind the
//!    points where facets meet along the center of the cell.
//! 4. Otherwise it is divided. It is *undecided* at the maximum depth, or when the limit of node visits is
//!    reached.

use std::collections::{BinaryHeap, HashMap, VecDeque};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

use super::FreeOptions;
use super::bodies::{Bodies, View};
use super::cell::Cell;
use super::cone::Cone;
use super::inner::{InnerBox, cover};
use super::proof::Fate;
use super::rest::{Rest, TooMuch};
use super::window::Window;
use colltrans_kernel::descent::Entry;
use colltrans_solid::cast::StartOverlap;

/// Number of pairs in the list of a cell from which on no pair is replaced by its children.
const LIST: usize = 192;
/// Maximum number of node visits of one search for a pair of facets.
const LOOKS: usize = 400;
/// Maximum number of cones that are subtracted one by one before a cell is divided.
const TARGETS: usize = 12;
/// Maximum number of cones that a cell passes to its quarters.
const WITNESSES: usize = 12;
/// Maximum number of node visits of the check that nothing else blocks the remainder of a cell.
const REST_LOOKS: usize = 2_000;
/// Factor on this limit if the center of a piece is free.
const FREE_FACTOR: usize = 10;
/// Maximum number of node visits of the search for the facets that meet along the center of a cell.
const HIT_LOOKS: usize = 10 * LOOKS;
/// Maximum number of pairs of facets behind which boxes are grown.
const GROWN: usize = 400;
/// Node visits that growing these boxes counts for.
const GROWTH: u64 = 4_000;
/// Maximum number of pairs of boxes that are tried again.
const SEEN: usize = 24;
/// Maximum number of cones that are tried again for the next single cell.
const KNOWN: usize = 8;
/// Maximum number of pieces of a cell.
pub(super) const PIECES: usize = 64;

/// Pair of nodes, or of facets.
type Pair = [u32; 2];

/// Result of a search: the cells by index, the six sides of the cube first.
pub(super) struct Found {
    pub(super) fates: Vec<Fate>,
    pub(super) boxes: [Vec<InnerBox>; 2],
    pub(super) looks: u64,
}

/// Cell that is still to be decided.
struct Task {
    at: usize,
    cell: Cell,
    pairs: Vec<Pair>,
    /// Cones that meet the parent cell.
    witnesses: Vec<u32>,
}

/// Result of an attempt to decide a cell.
enum Decided {
    Fate(Fate),
    /// The cell is to be divided, and these cones are passed to its quarters. At a limit it is undecided
    /// outside these cones.
    Open(Vec<u32>),
}

/// Results that later cells use again.
#[derive(Default)]
pub(super) struct Memory {
    cones: Vec<Cone>,
    known: HashMap<Pair, u32>,
    inner: Inner,
    /// Cones that blocked a single cell, the most recent first.
    covering: VecDeque<u32>,
    /// Lists of pairs that may block some directions of single cells that are not known to be blocked. Each
    /// of these cells contains the next one.
    around: Vec<(Cell, Vec<Pair>)>,
    looks: u64,
}

/// Boxes inside the moving and inside the fixed body.
#[derive(Default)]
struct Inner {
    boxes: [Vec<InnerBox>; 2],
    /// Index ranges of the boxes behind the points where two facets meet.
    behind: HashMap<Pair, [Range<u32>; 2]>,
    /// Pairs of boxes that blocked a cell, the most recent first.
    seen: VecDeque<Pair>,
}

pub(super) struct Search<'s, 'a> {
    bodies: &'s Bodies<'a>,
    options: FreeOptions,
    cancel: Option<&'s AtomicBool>,
    memory: Memory,
}

impl<'s, 'a> Search<'s, 'a> {
    pub(super) fn new(
        bodies: &'s Bodies<'a>,
        options: FreeOptions,
        cancel: Option<&'s AtomicBool>,
    ) -> Self {
        Self { bodies, options, cancel, memory: Memory::default() }
    }

    /// Decides all cells. Returns `None` if the search was cancelled.
    pub(super) fn run(mut self) -> Option<Found> {
        let mut fates = vec![Fate::UNKNOWN; 6];
        let task = |(at, cell)| Task { at, cell, pairs: vec![[0, 0]], witnesses: Vec::new() };
        let mut tasks: VecDeque<Task> = Cell::roots().into_iter().enumerate().map(task).collect();
        while let Some(mut task) = tasks.pop_front() {
            if self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                return None;
            }
            if self.memory.looks >= self.options.looks {
                fates[task.at] = Fate::Undecided(self.pairs(&task.witnesses));
                continue;
            }
            match self.decide(&mut task) {
                Decided::Fate(fate) => fates[task.at] = fate,
                Decided::Open(witnesses) if task.cell.depth >= self.options.depth => {
                    fates[task.at] = Fate::Undecided(self.pairs(&witnesses));
                }
                Decided::Open(witnesses) => self.cut(&task, &witnesses, &mut fates, &mut tasks),
            }
        }
        let boxes = named(&mut fates, &self.memory.inner.boxes);
        Some(Found { fates, boxes, looks: self.memory.looks })
    }

    /// Divides a cell into quarters.
    fn cut(&self, task: &Task, cones: &[u32], fates: &mut Vec<Fate>, tasks: &mut VecDeque<Task>) {
        let first = fates.len();
        fates[task.at] = Fate::Cut(first as u32);
        let corners = task.cell.corners();
        let mut witnesses = cones.to_vec();
        let old = task.witnesses.iter().filter(|w| !cones.contains(w));
        witnesses
            .extend(old.filter(|w| !self.memory.cones[**w as usize].misses(self.bodies, &corners)));
        witnesses.truncate(WITNESSES.max(cones.len()));
        for k in 0..4 {
            fates.push(Fate::UNKNOWN);
            let (cell, pairs) = (task.cell.quarter(k), task.pairs.clone());
            tasks.push_back(Task { at: first + k, cell, pairs, witnesses: witnesses.clone() });
        }
    }

    fn pairs(&self, cones: &[u32]) -> Vec<Pair> {
        cones.iter().map(|k| self.memory.cones[*k as usize].pair).collect()
    }

    /// Searches for a pair of facets that blocks all directions of a cell. Returns `None` if the limited
    /// search finds none.
    pub(super) fn covering_pair(mut self, cell: &Cell) -> Option<Pair> {
        let mut pairs = vec![[0, 0]];
        self.refine(&mut pairs, cell);
        self.covering_one(&pairs, cell).map(|k| self.memory.cones[k as usize].pair)
    }

    fn covering_one(&mut self, pairs: &[Pair], cell: &Cell) -> Option<u32> {
        [false, true].into_iter().find_map(|aside| self.covering(pairs, cell, aside))
    }

    /// Checks whether one pair of facets, or of inner boxes, blocks all directions of a cell, within limited
    /// work. `memory` holds results of earlier cells and receives those of this one.
    pub(super) fn covers(
        bodies: &Bodies,
        options: FreeOptions,
        cell: &Cell,
        memory: &mut Memory,
    ) -> bool {
        let mut search = Search { bodies, options, cancel: None, memory: std::mem::take(memory) };
        let found = search.is_covered(cell);
        *memory = search.memory;
        found
    }

    fn is_covered(&mut self, cell: &Cell) -> bool {
        let corners = cell.corners();
        let Memory { cones, covering, .. } = &mut self.memory;
        let covers = |k: &u32| cones[*k as usize].covers(self.bodies, &corners);
        if let Some(known) = covering.iter().position(covers) {
            covering.swap(0, known);
            return true;
        }
        if self.seen_boxes(&corners).is_some() {
            return true;
        }
        let around = &mut self.memory.around;
        while around.last().is_some_and(|(other, _)| !other.contains(cell)) {
            around.pop();
        }
        let mut pairs = around.last().map_or_else(|| vec![[0, 0]], |(_, pairs)| pairs.clone());
        self.refine(&mut pairs, cell);
        if let Some(k) = self.covering_one(&pairs, cell) {
            self.memory.covering.push_front(k);
            self.memory.covering.truncate(KNOWN);
            return true;
        }
        let task = Task { at: 0, cell: *cell, pairs, witnesses: Vec::new() };
        let found = !task.pairs.is_empty() && self.boxes(&task, &[]).is_some();
        if !found {
            self.memory.around.push((*cell, task.pairs));
        }
        found
    }

    fn decide(&mut self, task: &mut Task) -> Decided {
        let (cell, corners) = (task.cell, task.cell.corners());
        let covers = |k: &&u32| self.memory.cones[**k as usize].covers(self.bodies, &corners);
        if let Some(&k) = task.witnesses.iter().find(covers) {
            return Decided::Fate(Fate::Blocked(self.memory.cones[k as usize].pair));
        }
        self.refine(&mut task.pairs, &cell);
        if task.pairs.is_empty() {
            return Decided::Fate(Fate::Open(Vec::new()));
        }
        if let Some(pair) = self.seen_boxes(&corners) {
            return Decided::Fate(Fate::Inner(pair));
        }
        if let Some(k) = self.covering_one(&task.pairs, &cell) {
            return Decided::Fate(Fate::Blocked(self.memory.cones[k as usize].pair));
        }
        let decided = self.resolve(task);
        match decided {
            Decided::Open(cones) => {
                let found = self.boxes(task, &cones);
                found.map_or(Decided::Open(cones), |pair| Decided::Fate(Fate::Inner(pair)))
            }
            Decided::Fate(_) => decided,
        }
    }

    /// Returns a pair of boxes that blocks this cell, among those that blocked an earlier cell.
    fn seen_boxes(&mut self, corners: &[DVec3; 4]) -> Option<Pair> {
        let Inner { boxes, seen, .. } = &mut self.memory.inner;
        let found = seen
            .iter()
            .position(|&[a, b]| cover([&boxes[0][a as usize], &boxes[1][b as usize]], corners))?;
        seen.swap(0, found);
        seen.front().copied()
    }

    /// Searches for a pair of boxes that blocks a cell, behind the points where two facets meet along its
    /// center. The facets are those of one of the given cones, or result from a search. Returns `None` if
    /// there are no such boxes, or a start overlap is ignored.
    fn boxes(&mut self, task: &Task, cones: &[u32]) -> Option<Pair> {
        if self.options.start_overlap == StartOverlap::Ignore {
            return None;
        }
        let (cell, d) = (task.cell, task.cell.side.direction(task.cell.center()));
        let known = cones.iter().find(|k| self.memory.cones[**k as usize].holds(self.bodies, d));
        let hit = match known {
            Some(k) => Some(*k),
            None => self.blocking(&task.pairs, &cell, cell.center(), HIT_LOOKS).flatten(),
        };
        let pair = self.memory.cones[hit? as usize].pair;
        let [moving, fixed] = self.behind(pair, d);
        let corners = cell.corners();
        let found = moving.flat_map(|a| fixed.clone().map(move |b| [a, b])).find(|&[a, b]| {
            let [p, q] = &self.memory.inner.boxes;
            cover([&p[a as usize], &q[b as usize]], &corners)
        })?;
        self.memory.inner.seen.push_front(found);
        self.memory.inner.seen.truncate(SEEN);
        Some(found)
    }

    /// Returns the boxes behind the points where two facets meet. They are grown at the first request.
    fn behind(&mut self, pair: Pair, d: DVec3) -> [Range<u32>; 2] {
        let Inner { boxes, behind, .. } = &mut self.memory.inner;
        if let Some(found) = behind.get(&pair) {
            return found.clone();
        }
        let first = boxes.each_ref().map(Vec::len);
        if behind.len() < GROWN {
            let grown = InnerBox::behind(self.bodies, pair, d);
            for (boxes, grown) in boxes.iter_mut().zip(grown) {
                boxes.extend(grown);
            }
            self.memory.looks += GROWTH;
        }
        let found = [0, 1].map(|k| first[k] as u32..boxes[k].len() as u32);
        behind.insert(pair, found.clone());
        found
    }

    /// Checks whether a pair of nodes blocks no direction of a rectangle.
    fn misses(&mut self, [a, b]: Pair, window: &Window) -> bool {
        self.memory.looks += 1;
        let [p, q] = &self.bodies.views;
        window.is_missed(self.bodies, &p[a as usize], &q[b as usize])
    }

    /// Replaces the larger node of a pair by its children. The result is empty for two facets.
    fn parts(&self, pair: Pair) -> impl Iterator<Item = Pair> + use<> {
        self.bodies.parts(pair).into_iter().flatten()
    }

    fn views(&self, pair: Pair) -> [&View; 2] {
        self.bodies.views_of(pair)
    }

    fn is_leaf(&self, pair: Pair) -> bool {
        self.views(pair).iter().all(|view| view.is_facet())
    }

    /// Returns the index of the cone of two facets.
    fn cone(&mut self, [a, b]: Pair) -> u32 {
        let pair = [self.bodies.triangle(true, a), self.bodies.triangle(false, b)];
        let next = self.memory.cones.len() as u32;
        let number = *self.memory.known.entry(pair).or_insert(next);
        if number == next {
            self.memory.looks += 16;
            self.memory.cones.push(Cone::new(self.bodies, pair));
        }
        number
    }

    /// Removes pairs that miss the cell, and replaces pairs that appear wide compared with it by their
    /// children, up to a maximum number of pairs.
    fn refine(&mut self, pairs: &mut Vec<Pair>, cell: &Cell) {
        let (window, corners) = (Window::of(cell), cell.corners());
        let mut todo = std::mem::take(pairs);
        while let Some(pair) = todo.pop() {
            if self.misses(pair, &window) {
                continue;
            }
            if self.is_leaf(pair) {
                let k = self.cone(pair);
                if !self.memory.cones[k as usize].misses(self.bodies, &corners) {
                    pairs.push(pair);
                }
                continue;
            }
            let room = todo.len() + pairs.len() < LIST;
            if room && self.is_wide(pair, cell.size) {
                todo.extend(self.parts(pair));
            } else {
                pairs.push(pair);
            }
        }
    }

    /// Checks whether the differences of a pair span a larger angle than a cell.
    fn is_wide(&self, pair: Pair, size: f64) -> bool {
        let [a, b] = self.views(pair);
        let (low, high) = (b.low - a.high, b.high - a.low);
        let near = low.max(-high).max(DVec3::ZERO).max_element();
        (high - low).max_element() > size * near
    }

    /// Returns the distance of the center of a pair's differences from a ray, relative to their size. If
    /// `aside` is set, adds a penalty for facets that do not face along the ray.
    fn key(&self, pair: Pair, d: DVec3, aside: bool) -> f64 {
        let [a, b] = self.views(pair);
        let (low, high) = (b.low - a.high, b.high - a.low);
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let along = (middle.dot(d) / d.length_squared()).max(0.0);
        let off = (middle - d * along).length() / half.length();
        let faces = |view: &View, d: DVec3| {
            let sine = view.axis.dot(d) / d.length() + view.spread;
            if view.spread < 1.0 { 1.0 - sine.min(1.0) } else { 0.0 }
        };
        if aside { off + faces(a, d) + faces(b, -d) } else { off }
    }

    /// Searches best-first for a pair whose cone contains the whole cell, and dismisses pairs that miss a
    /// corner. Returns `None` if the limited search finds none.
    fn covering(&mut self, pairs: &[Pair], cell: &Cell, aside: bool) -> Option<u32> {
        let corners = cell.corners();
        let windows = cell.places().map(|place| Window::at(cell.side, place));
        let d = cell.side.direction(cell.center());
        let hits = |search: &mut Self, pair| !windows.iter().any(|w| search.misses(pair, w));
        let judge = |search: &Self, k: u32| {
            search.memory.cones[k as usize].covers(search.bodies, &corners).then_some(k)
        };
        let key = |search: &Self, pair| search.key(pair, d, aside);
        self.best_first(pairs, LOOKS, key, hits, judge)?
    }

    /// Searches for a pair that blocks a direction. Returns `Some(None)` if there is none, and `None` if the
    /// limit is reached.
    #[expect(clippy::option_option, reason = "`Some(None)`: there is none; `None`: limit reached")]
    fn blocking(
        &mut self,
        pairs: &[Pair],
        cell: &Cell,
        place: [f64; 2],
        looks: usize,
    ) -> Option<Option<u32>> {
        let (window, d) = (Window::at(cell.side, place), cell.side.direction(place));
        let hits = |search: &mut Self, pair| !search.misses(pair, &window);
        let judge = |search: &Self, k: u32| {
            search.memory.cones[k as usize].holds(search.bodies, d).then_some(k)
        };
        self.best_first(pairs, looks, |search, pair| search.key(pair, d, false), hits, judge)
    }

    /// Searches both trees best-first, in order of increasing key, for a pair of facets that `judge` accepts.
    /// Returns `Some(None)` if there is none, and `None` if the limit is reached.
    #[expect(clippy::option_option, reason = "`Some(None)`: there is none; `None`: limit reached")]
    fn best_first(
        &mut self,
        pairs: &[Pair],
        looks: usize,
        key: impl Fn(&Self, Pair) -> f64,
        hits: impl Fn(&mut Self, Pair) -> bool,
        judge: impl Fn(&Self, u32) -> Option<u32>,
    ) -> Option<Option<u32>> {
        let entry = |search: &Self, views: Pair| Entry {
            bound: key(search, views),
            number: 0,
            reason: (),
            views,
        };
        let mut queue: BinaryHeap<Entry> = pairs.iter().map(|&pair| entry(self, pair)).collect();
        for _ in 0..looks {
            let Some(Entry { views: pair, .. }) = queue.pop() else { return Some(None) };
            if !hits(self, pair) {
                continue;
            }
            if self.is_leaf(pair) {
                let cone = self.cone(pair);
                if let Some(found) = judge(self, cone) {
                    return Some(Some(found));
                }
            } else {
                let parts: Vec<Pair> = self.parts(pair).collect();
                queue.extend(parts.into_iter().map(|part| entry(self, part)));
            }
        }
        queue.is_empty().then_some(None)
    }

    /// Subtracts cones from a cell until nothing is left, or until no pair blocks a direction of the
    /// remainder.
    fn resolve(&mut self, task: &Task) -> Decided {
        let mut rest = Rest::whole(task.cell);
        let mut used = Vec::new();
        match self.take(task, &mut rest, &mut used) {
            Ok(true) => Decided::Fate(Fate::Open(self.pairs(&used))),
            Ok(false) | Err(TooMuch) => Decided::Open(used),
        }
    }

    /// Subtracts cones from a remainder and collects their indices. Returns `true` if all remaining
    /// directions are free.
    fn take(&mut self, task: &Task, rest: &mut Rest, used: &mut Vec<u32>) -> Result<bool, TooMuch> {
        let mut found_free = false;
        for _ in 0..TARGETS {
            let widest = rest.pieces.iter().max_by(|a, b| a.area().total_cmp(&b.area()));
            let Some(place) = widest.map(super::rest::Piece::center) else { return Ok(true) };
            match self.blocking(&task.pairs, &task.cell, place, LOOKS) {
                Some(Some(k)) => {
                    let cone = &self.memory.cones[k as usize];
                    if !rest.cut(self.bodies, cone, PIECES)? {
                        // The center of an arc or a point is rounded and therefore lies next to it.
                        found_free = true;
                        break;
                    }
                    used.push(k);
                }
                Some(None) => {
                    found_free = true;
                    break;
                }
                None => break,
            }
        }
        if task.cell.depth < self.options.depth && !found_free {
            return Ok(rest.pieces.is_empty());
        }
        self.take_all(
            task,
            rest,
            used,
            if found_free { FREE_FACTOR * REST_LOOKS } else { REST_LOOKS },
        )
    }

    /// Subtracts all cones that meet a remainder, if they are few enough. Returns an error if a limit is
    /// exceeded.
    fn take_all(
        &mut self,
        task: &Task,
        rest: &mut Rest,
        used: &mut Vec<u32>,
        looks: usize,
    ) -> Result<bool, TooMuch> {
        let mut stack = task.pairs.clone();
        let mut windows = windows(rest);
        let mut left = looks;
        while let Some(pair) = stack.pop() {
            left = left.checked_sub(1).ok_or(TooMuch)?;
            if windows.iter().all(|window| self.misses(pair, window)) {
                continue;
            }
            if !self.is_leaf(pair) {
                stack.extend(self.parts(pair));
                continue;
            }
            let k = self.cone(pair);
            if rest.cut(self.bodies, &self.memory.cones[k as usize], PIECES)? {
                used.push(k);
                if used.len() > self.options.cones {
                    return Err(TooMuch);
                }
                windows = self::windows(rest);
            }
        }
        Ok(true)
    }
}

/// Returns the boxes that cells refer to, and renumbers them in the cells.
fn named(fates: &mut [Fate], boxes: &[Vec<InnerBox>; 2]) -> [Vec<InnerBox>; 2] {
    let mut numbers = [HashMap::new(), HashMap::new()];
    let mut used = [Vec::new(), Vec::new()];
    for fate in fates {
        let Fate::Inner(pair) = fate else { continue };
        for k in 0..2 {
            pair[k] = *numbers[k].entry(pair[k]).or_insert_with(|| {
                used[k].push(boxes[k][pair[k] as usize]);
                used[k].len() as u32 - 1
            });
        }
    }
    used
}

/// Returns the bounding rectangles of the pieces.
pub(super) fn windows(rest: &Rest) -> Vec<Window> {
    rest.pieces.iter().map(|piece| rest.window(piece)).collect()
}
