//! The search: cells from the largest to the smallest, each decided or cut in four.
//!
//! A cell comes with the pairs of nodes that may block some of it. It is
//!
//! 1. *blocked* by one pair of facets whose cone holds its corners: one of those that its parent has seen, or what a
//!    search finds that drops all pairs which miss a corner;
//! 2. *open*, as nothing is left of its pairs of nodes; or, cut by the cones that are found at the middle of what is
//!    left of it, as no other pair meets the rest. If there is no rest, several pairs block it together;
//! 3. *inner*, as a box inside the moving and one inside the fixed body block it, grown behind the places where facets
//!    meet along its middle;
//! 4. cut in four, or *undecided* at the greatest depth, or when as many pairs have been looked at as were allowed:
//!    then it is blocked where the cones are that have been found.

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

/// Pairs of nodes that a cell hands on, at most.
const LIST: usize = 192;
/// Pairs of nodes that each search for one pair of facets looks at, at most.
const LOOKS: usize = 400;
/// Cones that are taken from a cell one by one before it is cut.
const TARGETS: usize = 12;
/// Cones that a cell hands on, at most.
const WITNESSES: usize = 12;
/// Pairs of nodes that are looked at to see that nothing else meets what is left of a cell; so many times as many
/// where its middle is free.
const REST_LOOKS: usize = 2_000;
const FREE_FACTOR: usize = 10;
/// Pairs of nodes that are looked at for the facets that meet along the middle of a cell, at most; pairs of facets
/// behind which boxes are grown; what that counts for; and pairs of boxes that are tried again.
const HIT_LOOKS: usize = 10 * LOOKS;
const GROWN: usize = 400;
const GROWTH: u64 = 4_000;
const SEEN: usize = 24;
/// Cones that are tried again of cells that are asked about alone.
const KNOWN: usize = 8;
/// Pieces that a cell may be cut into.
pub(super) const PIECES: usize = 64;

/// A pair of views.
type Pair = [u32; 2];

/// The cells of the sphere, by their numbers: first the six sides of the cube.
pub(super) struct Found {
    pub(super) fates: Vec<Fate>,
    pub(super) boxes: [Vec<InnerBox>; 2],
    pub(super) looks: u64,
}

/// A cell to be decided.
struct Task {
    at: usize,
    cell: Cell,
    pairs: Vec<Pair>,
    /// Cones that meet the cell around it.
    witnesses: Vec<u32>,
}

/// What has become of a cell.
enum Decided {
    Fate(Fate),
    /// To be cut in four, with these witnesses; or undecided, with what these cones leave.
    Open(Vec<u32>),
}

/// What is found on the way.
#[derive(Default)]
pub(super) struct Memory {
    cones: Vec<Cone>,
    known: HashMap<Pair, u32>,
    inner: Inner,
    /// Cones that have covered a cell that was asked about alone, the last ones first.
    covering: VecDeque<u32>,
    /// What may block some of cells that were asked about alone and are not known to be blocked, each within the one
    /// before it.
    around: Vec<(Cell, Vec<Pair>)>,
    looks: u64,
}

/// Boxes inside either body.
#[derive(Default)]
struct Inner {
    boxes: [Vec<InnerBox>; 2],
    /// Those behind the places where two facets meet.
    behind: HashMap<Pair, [Range<u32>; 2]>,
    /// Pairs that have blocked a cell, the last ones first.
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

    /// Decides all cells; `None` if it was cancelled.
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

    /// Cuts a cell in four.
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

    /// A pair of facets that blocks all of a cell, if one is found soon.
    pub(super) fn covering_pair(mut self, cell: &Cell) -> Option<Pair> {
        let mut pairs = vec![[0, 0]];
        self.refine(&mut pairs, cell);
        self.covering_one(&pairs, cell).map(|k| self.memory.cones[k as usize].pair)
    }

    fn covering_one(&mut self, pairs: &[Pair], cell: &Cell) -> Option<u32> {
        [false, true].into_iter().find_map(|aside| self.covering(pairs, cell, aside))
    }

    /// Whether a pair of facets, or of boxes inside, blocks all of a cell, if one is found soon; with what is known
    /// from cells before, and what is known after.
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

    /// A pair of boxes that has blocked a cell before and blocks this one.
    fn seen_boxes(&mut self, corners: &[DVec3; 4]) -> Option<Pair> {
        let Inner { boxes, seen, .. } = &mut self.memory.inner;
        let found = seen
            .iter()
            .position(|&[a, b]| cover([&boxes[0][a as usize], &boxes[1][b as usize]], corners))?;
        seen.swap(0, found);
        seen.front().copied()
    }

    /// A pair of boxes that blocks a cell, behind the places where two facets meet along its middle: facets of one of
    /// these cones, or of one that is looked for.
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

    /// The boxes behind the places where two facets meet, grown when first asked for.
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

    /// Whether a pair of views blocks none of the directions.
    fn misses(&mut self, [a, b]: Pair, window: &Window) -> bool {
        self.memory.looks += 1;
        let [p, q] = &self.bodies.views;
        window.is_missed(self.bodies, &p[a as usize], &q[b as usize])
    }

    /// The parts of a pair, of the larger view that has some; none of two facets.
    fn parts(&self, pair: Pair) -> impl Iterator<Item = Pair> + use<> {
        self.bodies.parts(pair).into_iter().flatten()
    }

    fn views(&self, pair: Pair) -> [&View; 2] {
        self.bodies.views_of(pair)
    }

    fn is_leaf(&self, pair: Pair) -> bool {
        self.views(pair).iter().all(|view| view.is_facet())
    }

    /// The number of the cone of two facets.
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

    /// Drops pairs that miss the cell, and splits what is wide against it, down to a number of pairs.
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

    /// Whether differences of a pair are seen at a larger angle than a cell.
    fn is_wide(&self, pair: Pair, size: f64) -> bool {
        let [a, b] = self.views(pair);
        let (low, high) = (b.low - a.high, b.high - a.low);
        let near = low.max(-high).max(DVec3::ZERO).max_element();
        (high - low).max_element() > size * near
    }

    /// How far the middle of a pair's differences is off a ray, against their size; and how little its facets look
    /// along it, if so asked.
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

    /// A pair whose cone holds all of a cell, if one is found soon: best first, without what misses a corner.
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

    /// A pair that blocks a direction, if there is one; nothing if that is not known soon.
    #[expect(clippy::option_option, reason = "none at all, or none so far")]
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

    /// The first pair of facets that is judged to be one, going down from pairs of nodes, the least key first.
    /// `Some(None)` if there is none, `None` if none was found soon.
    #[expect(clippy::option_option, reason = "none at all, or none so far")]
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

    /// Takes cones from a cell until nothing is left of it, or nothing meets what is left.
    fn resolve(&mut self, task: &Task) -> Decided {
        let mut rest = Rest::whole(task.cell);
        let mut used = Vec::new();
        match self.take(task, &mut rest, &mut used) {
            Ok(true) => Decided::Fate(Fate::Open(self.pairs(&used))),
            Ok(false) | Err(TooMuch) => Decided::Open(used),
        }
    }

    /// The same, with the numbers of the cones; whether it is done.
    fn take(&mut self, task: &Task, rest: &mut Rest, used: &mut Vec<u32>) -> Result<bool, TooMuch> {
        let mut found_free = false;
        for _ in 0..TARGETS {
            let widest = rest.pieces.iter().max_by(|a, b| a.area().total_cmp(&b.area()));
            let Some(place) = widest.map(super::rest::Piece::center) else { return Ok(true) };
            match self.blocking(&task.pairs, &task.cell, place, LOOKS) {
                Some(Some(k)) => {
                    let cone = &self.memory.cones[k as usize];
                    if !rest.cut(self.bodies, cone, PIECES)? {
                        // The middle of an arc, or a point, is beside it by roundings.
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

    /// Takes all that meets what is left, if it is little enough.
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

/// The boxes that cells name, which get their numbers.
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

/// The rectangles around what is left.
pub(super) fn windows(rest: &Rest) -> Vec<Window> {
    rest.pieces.iter().map(|piece| rest.window(piece)).collect()
}
