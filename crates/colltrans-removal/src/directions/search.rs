//! Breadth-first search over cells, in which each cell is decided or divided into quarters.
//!
//! A cell has a list of the pairs of nodes that may block some of its directions. Pairs of boxes that blocked
//! earlier cells are tried before the best-first search of step 1. The steps for a cell are:
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
use super::bodies::{Bodies, NodeBounds};
use super::cell::Cell;
use super::cone::Cone;
use super::inner::{InnerBox, boxes_block};
use super::proof::CellState;
use super::remainder::{LimitExceeded, Remainder};
use super::window::Window;
use colltrans_kernel::descent::QueuedPair;
use colltrans_solid::cast::StartOverlap;

/// Number of pairs in the list of a cell from which on no pair is replaced by its children.
const MAX_LIST: usize = 192;
/// Maximum number of node visits of one search for a pair of facets.
const MAX_SEARCH_VISITS: usize = 400;
/// Maximum number of cones that are subtracted one by one before a cell is divided.
const MAX_CONES_BEFORE_DIVISION: usize = 12;
/// Maximum number of cones that a cell passes to its quarters, unless more were subtracted from it.
const MAX_WITNESSES: usize = 12;
/// Maximum number of node visits of the check that nothing else blocks the remainder of a cell.
const MAX_REMAINDER_VISITS: usize = 2_000;
/// Factor on [`MAX_REMAINDER_VISITS`] if the center of a piece is free.
const FREE_FACTOR: usize = 10;
/// Maximum number of node visits of the search for the facets that meet along the center of a cell.
const MAX_HIT_VISITS: usize = 10 * MAX_SEARCH_VISITS;
/// Maximum number of pairs of facets behind which boxes are grown.
const MAX_GROWN_PAIRS: usize = 400;
/// Number of node visits that growing boxes behind one pair of facets counts as.
const GROWTH_VISITS: u64 = 4_000;
/// Maximum number of pairs of boxes that blocked earlier cells and are tried again.
const MAX_RECENT_BOXES: usize = 24;
/// Maximum number of cones that are tried again for the next single cell.
const MAX_KNOWN_CONES: usize = 8;
/// Maximum number of pieces of a cell.
pub(super) const MAX_PIECES: usize = 64;

/// Pair of nodes, or of facets.
type Pair = [u32; 2];

/// Result of a search: the cells by index, the six sides of the cube first.
pub(super) struct SearchResult {
    pub(super) states: Vec<CellState>,
    pub(super) boxes: [Vec<InnerBox>; 2],
    pub(super) visits: u64,
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
enum Decision {
    Final(CellState),
    /// The cell is to be divided, and these cones are passed to its quarters. At a limit it is undecided
    /// outside these cones.
    Open(Vec<u32>),
}

/// Results that later cells use again.
#[derive(Default)]
pub(super) struct SearchMemory {
    cones: Vec<Cone>,
    known: HashMap<Pair, u32>,
    inner: InnerBoxes,
    /// Cones that blocked a single cell, the most recent first.
    covering: VecDeque<u32>,
    /// Single cells for which no blocking pair was found, each with the pairs that may block some of its
    /// directions. Each of these cells contains the next one.
    around: Vec<(Cell, Vec<Pair>)>,
    visits: u64,
}

/// Boxes inside the moving and inside the fixed body.
#[derive(Default)]
struct InnerBoxes {
    boxes: [Vec<InnerBox>; 2],
    /// Index ranges of the boxes behind the points where two facets meet.
    behind: HashMap<Pair, [Range<u32>; 2]>,
    /// Pairs of boxes that blocked a cell, the most recent first.
    recent: VecDeque<Pair>,
}

pub(super) struct Search<'s, 'a> {
    bodies: &'s Bodies<'a>,
    options: FreeOptions,
    cancel: Option<&'s AtomicBool>,
    memory: SearchMemory,
}

impl<'s, 'a> Search<'s, 'a> {
    pub(super) fn new(
        bodies: &'s Bodies<'a>,
        options: FreeOptions,
        cancel: Option<&'s AtomicBool>,
    ) -> Self {
        Self { bodies, options, cancel, memory: SearchMemory::default() }
    }

    /// Decides all cells. Returns `None` if the search was cancelled.
    pub(super) fn run(mut self) -> Option<SearchResult> {
        let mut states = vec![CellState::UNKNOWN; 6];
        let task = |(at, cell)| Task { at, cell, pairs: vec![[0, 0]], witnesses: Vec::new() };
        let mut tasks: VecDeque<Task> =
            Cell::root_cells().into_iter().enumerate().map(task).collect();
        while let Some(mut task) = tasks.pop_front() {
            if self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                return None;
            }
            if self.memory.visits >= self.options.looks {
                states[task.at] = CellState::Undecided(self.facet_pairs(&task.witnesses));
                continue;
            }
            match self.decide(&mut task) {
                Decision::Final(state) => states[task.at] = state,
                Decision::Open(witnesses) if task.cell.depth >= self.options.depth => {
                    states[task.at] = CellState::Undecided(self.facet_pairs(&witnesses));
                }
                Decision::Open(witnesses) => {
                    self.divide(&task, &witnesses, &mut states, &mut tasks);
                }
            }
        }
        let boxes = used_boxes(&mut states, &self.memory.inner.boxes);
        Some(SearchResult { states, boxes, visits: self.memory.visits })
    }

    /// Divides a cell into quarters.
    fn divide(
        &self,
        task: &Task,
        cones: &[u32],
        states: &mut Vec<CellState>,
        tasks: &mut VecDeque<Task>,
    ) {
        let first = states.len();
        states[task.at] = CellState::Cut(first as u32);
        let corners = task.cell.corner_directions();
        let mut witnesses = cones.to_vec();
        let old = task.witnesses.iter().filter(|w| !cones.contains(w));
        witnesses.extend(
            old.filter(|w| !self.memory.cones[**w as usize].misses_all(self.bodies, &corners)),
        );
        witnesses.truncate(MAX_WITNESSES.max(cones.len()));
        for k in 0..4 {
            states.push(CellState::UNKNOWN);
            let (cell, pairs) = (task.cell.quarter(k), task.pairs.clone());
            tasks.push_back(Task { at: first + k, cell, pairs, witnesses: witnesses.clone() });
        }
    }

    fn facet_pairs(&self, cones: &[u32]) -> Vec<Pair> {
        cones.iter().map(|k| self.memory.cones[*k as usize].pair).collect()
    }

    /// Searches for a pair of facets that blocks all directions of a cell. Returns `None` if the limited
    /// search finds none.
    pub(super) fn covering_pair(mut self, cell: &Cell) -> Option<Pair> {
        let mut pairs = vec![[0, 0]];
        self.refine_pairs(&mut pairs, cell);
        self.any_covering_cone(&pairs, cell).map(|k| self.memory.cones[k as usize].pair)
    }

    fn any_covering_cone(&mut self, pairs: &[Pair], cell: &Cell) -> Option<u32> {
        [false, true].into_iter().find_map(|aside| self.covering_cone(pairs, cell, aside))
    }

    /// Checks whether one pair of facets, or of inner boxes, blocks all directions of a cell, within limited
    /// work. `memory` holds results of earlier cells and receives those of this one.
    pub(super) fn covers_cell(
        bodies: &Bodies,
        options: FreeOptions,
        cell: &Cell,
        memory: &mut SearchMemory,
    ) -> bool {
        let mut search = Search { bodies, options, cancel: None, memory: std::mem::take(memory) };
        let found = search.is_covered(cell);
        *memory = search.memory;
        found
    }

    fn is_covered(&mut self, cell: &Cell) -> bool {
        let corners = cell.corner_directions();
        let SearchMemory { cones, covering, .. } = &mut self.memory;
        let covers = |k: &u32| cones[*k as usize].contains_all(self.bodies, &corners);
        if let Some(known) = covering.iter().position(covers) {
            covering.swap(0, known);
            return true;
        }
        if self.recent_boxes(&corners).is_some() {
            return true;
        }
        let around = &mut self.memory.around;
        while around.last().is_some_and(|(other, _)| !other.contains(cell)) {
            around.pop();
        }
        let mut pairs = around.last().map_or_else(|| vec![[0, 0]], |(_, pairs)| pairs.clone());
        self.refine_pairs(&mut pairs, cell);
        if let Some(k) = self.any_covering_cone(&pairs, cell) {
            self.memory.covering.push_front(k);
            self.memory.covering.truncate(MAX_KNOWN_CONES);
            return true;
        }
        let task = Task { at: 0, cell: *cell, pairs, witnesses: Vec::new() };
        let found = !task.pairs.is_empty() && self.blocking_boxes(&task, &[]).is_some();
        if !found {
            self.memory.around.push((*cell, task.pairs));
        }
        found
    }

    fn decide(&mut self, task: &mut Task) -> Decision {
        let (cell, corners) = (task.cell, task.cell.corner_directions());
        let covers = |k: &&u32| self.memory.cones[**k as usize].contains_all(self.bodies, &corners);
        if let Some(&k) = task.witnesses.iter().find(covers) {
            return Decision::Final(CellState::Blocked(self.memory.cones[k as usize].pair));
        }
        self.refine_pairs(&mut task.pairs, &cell);
        if task.pairs.is_empty() {
            return Decision::Final(CellState::Open(Vec::new()));
        }
        if let Some(pair) = self.recent_boxes(&corners) {
            return Decision::Final(CellState::Inner(pair));
        }
        if let Some(k) = self.any_covering_cone(&task.pairs, &cell) {
            return Decision::Final(CellState::Blocked(self.memory.cones[k as usize].pair));
        }
        let decided = self.resolve_cell(task);
        match decided {
            Decision::Open(cones) => {
                let found = self.blocking_boxes(task, &cones);
                found.map_or(Decision::Open(cones), |pair| Decision::Final(CellState::Inner(pair)))
            }
            Decision::Final(_) => decided,
        }
    }

    /// Returns a pair of boxes that blocks this cell, among those that blocked an earlier cell.
    fn recent_boxes(&mut self, corners: &[DVec3; 4]) -> Option<Pair> {
        let InnerBoxes { boxes, recent, .. } = &mut self.memory.inner;
        let found = recent.iter().position(|&[a, b]| {
            boxes_block([&boxes[0][a as usize], &boxes[1][b as usize]], corners)
        })?;
        recent.swap(0, found);
        recent.front().copied()
    }

    /// Searches for a pair of boxes that blocks a cell, behind the points where two facets meet along its
    /// center. The facets are those of one of the given cones, or result from a search. Returns `None` if
    /// there are no such boxes, or a start overlap is ignored.
    fn blocking_boxes(&mut self, task: &Task, cones: &[u32]) -> Option<Pair> {
        if self.options.start_overlap == StartOverlap::Ignore {
            return None;
        }
        let (cell, d) = (task.cell, task.cell.side.direction_at(task.cell.center()));
        let known = cones
            .iter()
            .find(|k| self.memory.cones[**k as usize].contains_direction(self.bodies, d));
        let hit = match known {
            Some(k) => Some(*k),
            None => self.blocking_cone(&task.pairs, &cell, cell.center(), MAX_HIT_VISITS).flatten(),
        };
        let pair = self.memory.cones[hit? as usize].pair;
        let [moving, fixed] = self.boxes_behind(pair, d);
        let corners = cell.corner_directions();
        let found = moving.flat_map(|a| fixed.clone().map(move |b| [a, b])).find(|&[a, b]| {
            let [p, q] = &self.memory.inner.boxes;
            boxes_block([&p[a as usize], &q[b as usize]], &corners)
        })?;
        self.memory.inner.recent.push_front(found);
        self.memory.inner.recent.truncate(MAX_RECENT_BOXES);
        Some(found)
    }

    /// Returns the boxes behind the points where two facets meet. They are grown at the first request; after
    /// [`MAX_GROWN_PAIRS`] pairs of facets, there are none for further pairs.
    fn boxes_behind(&mut self, pair: Pair, d: DVec3) -> [Range<u32>; 2] {
        let InnerBoxes { boxes, behind, .. } = &mut self.memory.inner;
        if let Some(found) = behind.get(&pair) {
            return found.clone();
        }
        let first = boxes.each_ref().map(Vec::len);
        if behind.len() < MAX_GROWN_PAIRS {
            let grown = InnerBox::grown_behind(self.bodies, pair, d);
            for (boxes, grown) in boxes.iter_mut().zip(grown) {
                boxes.extend(grown);
            }
            self.memory.visits += GROWTH_VISITS;
        }
        let found = [0, 1].map(|k| first[k] as u32..boxes[k].len() as u32);
        behind.insert(pair, found.clone());
        found
    }

    /// Checks whether a pair of nodes blocks no direction of a rectangle.
    fn misses_window(&mut self, [a, b]: Pair, window: &Window) -> bool {
        self.memory.visits += 1;
        let [p, q] = &self.bodies.nodes;
        window.is_missed(self.bodies, &p[a as usize], &q[b as usize])
    }

    /// Replaces the larger node of a pair by its children. The result is empty for two facets.
    fn child_pairs(&self, pair: Pair) -> impl Iterator<Item = Pair> + use<> {
        self.bodies.child_pairs(pair).into_iter().flatten()
    }

    fn node_pair(&self, pair: Pair) -> [&NodeBounds; 2] {
        self.bodies.node_pair(pair)
    }

    fn is_leaf(&self, pair: Pair) -> bool {
        self.node_pair(pair).iter().all(|view| view.is_facet())
    }

    /// Returns the index of the cone of two facets.
    fn cone_index(&mut self, [a, b]: Pair) -> u32 {
        let pair = [self.bodies.leaf_triangle(true, a), self.bodies.leaf_triangle(false, b)];
        let next = self.memory.cones.len() as u32;
        let number = *self.memory.known.entry(pair).or_insert(next);
        if number == next {
            self.memory.visits += 16;
            self.memory.cones.push(Cone::new(self.bodies, pair));
        }
        number
    }

    /// Removes pairs that miss the cell, and replaces pairs that appear wide compared with it by their
    /// children, up to a maximum number of pairs.
    fn refine_pairs(&mut self, pairs: &mut Vec<Pair>, cell: &Cell) {
        let (window, corners) = (Window::of_cell(cell), cell.corner_directions());
        let mut todo = std::mem::take(pairs);
        while let Some(pair) = todo.pop() {
            if self.misses_window(pair, &window) {
                continue;
            }
            if self.is_leaf(pair) {
                let k = self.cone_index(pair);
                if !self.memory.cones[k as usize].misses_all(self.bodies, &corners) {
                    pairs.push(pair);
                }
                continue;
            }
            let room = todo.len() + pairs.len() < MAX_LIST;
            if room && self.is_wide(pair, cell.size) {
                todo.extend(self.child_pairs(pair));
            } else {
                pairs.push(pair);
            }
        }
    }

    /// Checks whether the differences of a pair span a larger angle than a cell.
    fn is_wide(&self, pair: Pair, size: f64) -> bool {
        let [a, b] = self.node_pair(pair);
        let (low, high) = (b.low - a.high, b.high - a.low);
        let near = low.max(-high).max(DVec3::ZERO).max_element();
        (high - low).max_element() > size * near
    }

    /// Returns the distance of the center of a pair's differences from a ray, relative to their size. If
    /// `aside` is set, adds a penalty for facets that do not face along the ray.
    fn ray_deviation(&self, pair: Pair, d: DVec3, aside: bool) -> f64 {
        let [a, b] = self.node_pair(pair);
        let (low, high) = (b.low - a.high, b.high - a.low);
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let along = (middle.dot(d) / d.length_squared()).max(0.0);
        let off = (middle - d * along).length() / half.length();
        let faces = |view: &NodeBounds, d: DVec3| {
            let sine = view.axis.dot(d) / d.length() + view.spread;
            if view.spread < 1.0 { 1.0 - sine.min(1.0) } else { 0.0 }
        };
        if aside { off + faces(a, d) + faces(b, -d) } else { off }
    }

    /// Searches best-first for a pair whose cone contains the whole cell, and dismisses pairs that miss a
    /// corner. Returns `None` if the limited search finds none.
    fn covering_cone(&mut self, pairs: &[Pair], cell: &Cell, aside: bool) -> Option<u32> {
        let corners = cell.corner_directions();
        let windows = cell.corner_places().map(|place| Window::at_place(cell.side, place));
        let d = cell.side.direction_at(cell.center());
        let hits = |search: &mut Self, pair| !windows.iter().any(|w| search.misses_window(pair, w));
        let judge = |search: &Self, k: u32| {
            search.memory.cones[k as usize].contains_all(search.bodies, &corners).then_some(k)
        };
        let key = |search: &Self, pair| search.ray_deviation(pair, d, aside);
        self.best_first(pairs, MAX_SEARCH_VISITS, key, hits, judge)?
    }

    /// Searches for a pair that blocks a direction. Returns `Some(None)` if there is none, and `None` if the
    /// limit is reached.
    #[expect(clippy::option_option, reason = "`Some(None)`: there is none; `None`: limit reached")]
    fn blocking_cone(
        &mut self,
        pairs: &[Pair],
        cell: &Cell,
        place: [f64; 2],
        visits: usize,
    ) -> Option<Option<u32>> {
        let (window, d) = (Window::at_place(cell.side, place), cell.side.direction_at(place));
        let hits = |search: &mut Self, pair| !search.misses_window(pair, &window);
        let judge = |search: &Self, k: u32| {
            search.memory.cones[k as usize].contains_direction(search.bodies, d).then_some(k)
        };
        self.best_first(
            pairs,
            visits,
            |search, pair| search.ray_deviation(pair, d, false),
            hits,
            judge,
        )
    }

    /// Searches both trees best-first, in order of increasing key, for a pair of facets that `judge` accepts.
    /// Returns `Some(None)` if there is none, and `None` if the limit is reached.
    #[expect(clippy::option_option, reason = "`Some(None)`: there is none; `None`: limit reached")]
    fn best_first(
        &mut self,
        pairs: &[Pair],
        visits: usize,
        key: impl Fn(&Self, Pair) -> f64,
        hits: impl Fn(&mut Self, Pair) -> bool,
        judge: impl Fn(&Self, u32) -> Option<u32>,
    ) -> Option<Option<u32>> {
        let entry = |search: &Self, views: Pair| QueuedPair {
            bound: key(search, views),
            number: 0,
            reason: (),
            views,
        };
        let mut queue: BinaryHeap<QueuedPair> =
            pairs.iter().map(|&pair| entry(self, pair)).collect();
        for _ in 0..visits {
            let Some(QueuedPair { views: pair, .. }) = queue.pop() else { return Some(None) };
            if !hits(self, pair) {
                continue;
            }
            if self.is_leaf(pair) {
                let cone = self.cone_index(pair);
                if let Some(found) = judge(self, cone) {
                    return Some(Some(found));
                }
            } else {
                let parts: Vec<Pair> = self.child_pairs(pair).collect();
                queue.extend(parts.into_iter().map(|part| entry(self, part)));
            }
        }
        queue.is_empty().then_some(None)
    }

    /// Subtracts cones from a cell until nothing is left, until no pair blocks a direction of the remainder,
    /// or until a limit is reached.
    fn resolve_cell(&mut self, task: &Task) -> Decision {
        let mut remainder = Remainder::of_cell(task.cell);
        let mut used = Vec::new();
        match self.subtract_blocking_cones(task, &mut remainder, &mut used) {
            Ok(true) => Decision::Final(CellState::Open(self.facet_pairs(&used))),
            Ok(false) | Err(LimitExceeded) => Decision::Open(used),
        }
    }

    /// Subtracts cones from a remainder and collects their indices. Returns `true` if all remaining
    /// directions are free.
    fn subtract_blocking_cones(
        &mut self,
        task: &Task,
        remainder: &mut Remainder,
        used: &mut Vec<u32>,
    ) -> Result<bool, LimitExceeded> {
        let mut found_free = false;
        for _ in 0..MAX_CONES_BEFORE_DIVISION {
            let widest = remainder.pieces.iter().max_by(|a, b| a.area().total_cmp(&b.area()));
            let Some(place) = widest.map(super::remainder::Piece::center) else { return Ok(true) };
            match self.blocking_cone(&task.pairs, &task.cell, place, MAX_SEARCH_VISITS) {
                Some(Some(k)) => {
                    let cone = &self.memory.cones[k as usize];
                    if !remainder.subtract_cone(self.bodies, cone, MAX_PIECES)? {
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
            return Ok(remainder.pieces.is_empty());
        }
        self.subtract_all_cones(
            task,
            remainder,
            used,
            if found_free { FREE_FACTOR * MAX_REMAINDER_VISITS } else { MAX_REMAINDER_VISITS },
        )
    }

    /// Subtracts the cones of all pairs in the list of a cell that meet the remainder, and appends their
    /// indices to `used`. Always returns `true`, because the rest is free. Returns an error if a limit of
    /// node visits, cones or pieces is exceeded.
    fn subtract_all_cones(
        &mut self,
        task: &Task,
        remainder: &mut Remainder,
        used: &mut Vec<u32>,
        visits: usize,
    ) -> Result<bool, LimitExceeded> {
        let mut stack = task.pairs.clone();
        let mut windows = piece_windows(remainder);
        let mut left = visits;
        while let Some(pair) = stack.pop() {
            left = left.checked_sub(1).ok_or(LimitExceeded)?;
            if windows.iter().all(|window| self.misses_window(pair, window)) {
                continue;
            }
            if !self.is_leaf(pair) {
                stack.extend(self.child_pairs(pair));
                continue;
            }
            let k = self.cone_index(pair);
            if remainder.subtract_cone(self.bodies, &self.memory.cones[k as usize], MAX_PIECES)? {
                used.push(k);
                if used.len() > self.options.cones {
                    return Err(LimitExceeded);
                }
                windows = piece_windows(remainder);
            }
        }
        Ok(true)
    }
}

/// Returns the boxes that cells refer to, and renumbers them in the cells.
fn used_boxes(states: &mut [CellState], boxes: &[Vec<InnerBox>; 2]) -> [Vec<InnerBox>; 2] {
    let mut numbers = [HashMap::new(), HashMap::new()];
    let mut used = [Vec::new(), Vec::new()];
    for state in states {
        let CellState::Inner(pair) = state else { continue };
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
pub(super) fn piece_windows(remainder: &Remainder) -> Vec<Window> {
    remainder.pieces.iter().map(|piece| remainder.bounding_window(piece)).collect()
}
