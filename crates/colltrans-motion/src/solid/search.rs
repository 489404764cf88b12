//! Down both trees and through time, earlier times first.
//!
//! What is open is a stack of pairs of parts, each in an interval. A pair that no plane parts throughout is split:
//! its time, where the parts move farther than they are large or turn much; else the larger part. Two facets
//! that are left are asked as two convex bodies are.
//!
//! Invariant. Every pair of facets is parted up to the end of the span, or up to the earliest contact found so far,
//! but for what is open. What lies later than that is not looked at.

use super::super::answer::MotionSteps;
use super::super::search::{Advanced, End, advance};
use super::facets::{FacetLooker, Later, later};
use super::proof::{Entry, FacetsMet, Written, middle};
use super::tree::{Below, Node, Tree};
use super::window::{Frame, Part, Plane, Snap, Window};
use colltrans_kernel::descent::{node_to_split, replaced};

/// Longer arcs are halved at once.
const TURN: f64 = 0.7;

/// Time is halved while parts move by more than so many times their size; facets by more.
const WAYS: f64 = 4.0;
const FACET_WAYS: f64 = 8.0;

/// Intervals that are shorter are not halved: what is open there is asked facet by facet.
const SHORTEST: f64 = 1e-9;

/// The planes that are tried, in this order: those of facets where there are some.
const PLANES: [Plane; 3] = [Plane::Middles, Plane::Across(0), Plane::Across(1)];
const AXES: [Plane; 6] = {
    use Plane::Axis;
    [Axis(1, 0), Axis(1, 1), Axis(1, 2), Axis(0, 0), Axis(0, 1), Axis(0, 2)]
};
const EDGES: [Plane; 9] = {
    use Plane::Edges;
    [
        Edges(0, 0),
        Edges(0, 1),
        Edges(0, 2),
        Edges(1, 0),
        Edges(1, 1),
        Edges(1, 2),
        Edges(2, 0),
        Edges(2, 1),
        Edges(2, 2),
    ]
};

/// The earliest contact found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    /// All facets are apart before.
    pub(super) lower: f64,
    /// Those that are not from then on.
    pub(super) triangles: [u32; 2],
    /// Whether it is there that the search of two facets took its maximum number of steps.
    pub(super) is_open: bool,
    /// When some are seen to meet, and why.
    pub(super) met: Option<(f64, [u32; 2], FacetsMet)>,
}

/// What a search is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    /// The first contact.
    Plain,
    /// The same, and what is proven is written down.
    Writing,
    /// The first contact of facets that look at each other, without those that have crossed from the start on.
    Ignoring,
}

/// A pair of parts in an interval, which nothing is known of yet.
#[derive(Debug, Clone, Copy)]
struct Open {
    parts: [u32; 2],
    /// Where its ends are among the snaps, and how many of these are to be kept for what is open.
    ends: [u32; 2],
    snaps: u32,
}

/// A search through a span under way.
pub(super) struct Search<'s, 'a> {
    frame: Frame<'s, 'a>,
    trees: [&'a Tree<'a>; 2],
    snaps: Vec<Snap>,
    stack: Vec<Open>,
    /// What parted the last pair.
    last: Plane,
    ignores: bool,
    pub(super) found: Option<Found>,
    pub(super) written: Option<Written>,
    pub(super) steps: MotionSteps,
}

impl<'s, 'a> Search<'s, 'a> {
    pub(super) fn new(frame: Frame<'s, 'a>, mode: Mode) -> Self {
        let trees = [frame.span.body(0), frame.span.body(1)];
        let snaps = vec![frame.snap(frame.span.from), frame.snap(frame.span.to)];
        Self {
            frame,
            trees,
            snaps,
            stack: Vec::new(),
            last: Plane::Middles,
            found: None,
            ignores: mode == Mode::Ignoring,
            written: (mode == Mode::Writing).then(Written::default),
            steps: MotionSteps::default(),
        }
    }

    pub(super) fn run(&mut self) {
        self.stack.push(Open { parts: [0, 0], ends: [0, 1], snaps: 2 });
        while let Some(open) = self.stack.pop() {
            self.snaps.truncate(open.snaps as usize);
            self.visit(open);
        }
    }

    fn visit(&mut self, Open { parts: at, ends: [from, mut to], .. }: Open) {
        if let Some(Found { lower, .. }) = self.found {
            if self.time(from) >= lower {
                return;
            }
            if self.time(to) > lower {
                self.snaps.push(self.frame.snap(lower));
                to = self.snaps.len() as u32 - 1;
            }
        }
        self.steps.nodes += 1;
        let parts = [0, 1].map(|k| Part::of(self.trees[k], at[k]));
        let ends = [&self.snaps[from as usize], &self.snaps[to as usize]];
        let window = self.frame.window(ends, parts.each_ref());
        let facets = parts.each_ref().map(|part| part.facet().is_some());
        if let Some(plane) = parted(&window, facets, self.last) {
            self.last = plane;
            self.write(Entry::Parted(plane));
            return;
        }
        let nodes = [0, 1].map(|k| self.trees[k].node(at[k]));
        let sizes = nodes.map(|node| node.half.length());
        let way = window.way() / sizes[0].max(sizes[1]);
        let turns = window.turn() > TURN;
        let is_long = ends[1].time - ends[0].time >= SHORTEST;
        let below = nodes.map(|node| node.below);
        if let [Below::Facet(s), Below::Facet(t)] = below {
            if is_long && (turns || way > FACET_WAYS) {
                self.halve(at, [from, to]);
            } else {
                self.ask([s, t], [from, to], parts.each_ref());
            }
        } else if is_long && (turns || way > WAYS) {
            self.halve(at, [from, to]);
        } else if let Some((which, [first, second])) = split(at, nodes) {
            self.write(Entry::Split(which));
            let (ends, snaps) = ([from, to], self.snaps.len() as u32);
            let open = |parts| Open { parts, ends, snaps };
            self.stack.extend([open(second), open(first)]);
        }
    }

    fn time(&self, snap: u32) -> f64 {
        self.snaps[snap as usize].time
    }

    fn write(&mut self, entry: Entry) {
        if let Some(written) = &mut self.written {
            written.entries.push(entry);
        }
    }

    fn halve(&mut self, parts: [u32; 2], [from, to]: [u32; 2]) {
        self.write(Entry::Halved);
        let [a, b] = [self.time(from), self.time(to)];
        self.snaps.push(self.frame.snap(middle(a, b)));
        let snaps = self.snaps.len() as u32;
        let half = |ends| Open { parts, ends, snaps };
        self.stack.extend([half([snaps - 1, to]), half([from, snaps - 1])]);
    }

    /// Two facets in an interval, as two convex bodies.
    fn ask(&mut self, triangles: [u32; 2], ends: [u32; 2], parts: [&Part; 2]) {
        let [Some(f), Some(g)] = parts.map(Part::facet) else { return };
        let times = ends.map(|k| self.time(k));
        let span = self.frame.span.part([f, g], times);
        let mut looker = FacetLooker::default();
        self.steps.leaves += 1;
        if self.ignores {
            let sided = [0, 1].map(|k| !self.trees[k].solid.is_open(triangles[k] as usize));
            if let Some(Later { lower, met }) = later(&span, sided, &mut looker) {
                let met = met.map(|(time, met)| (time, triangles, met));
                self.take(Found { lower, triangles, is_open: false, met });
            }
            self.steps += looker.steps;
            return;
        }
        let Advanced { planes, end } = advance(&span, &mut looker);
        self.steps += looker.steps;
        let lower = planes.last().map_or(times[0], |plane| plane.time);
        match end {
            End::Free => {
                self.write(Entry::Listed);
                if let Some(written) = &mut self.written {
                    written.lists.push(planes);
                }
            }
            End::Met(time, met) => {
                let met = Some((time, triangles, met));
                self.take(Found { lower, triangles, is_open: false, met });
            }
            End::Blurred => self.take(Found { lower, triangles, is_open: false, met: None }),
            End::Stalled => self.take(Found { lower, triangles, is_open: true, met: None }),
        }
    }

    fn take(&mut self, new: Found) {
        let Some(before) = &mut self.found else {
            self.found = Some(new);
            return;
        };
        let met = match (before.met, new.met) {
            (Some(old), Some(new)) if new.0 < old.0 => Some(new),
            (old, new) => old.or(new),
        };
        if new.lower < before.lower {
            *before = new;
        }
        before.met = met;
    }
}

/// Which of two nodes is split, the larger one that is no facet, and the pairs that come of it.
pub(super) fn split(at: [u32; 2], nodes: [&Node; 2]) -> Option<(u8, [[u32; 2]; 2])> {
    let are_facets = nodes.map(|node| matches!(node.below, Below::Facet(_)));
    let which = node_to_split(are_facets, |k| nodes[k].half.length())?;
    let Below::Nodes(first) = nodes[which].below else { return None };
    Some((which as u8, [first, first + 1].map(|part| replaced(at, which, part))))
}

/// The plane that parts two parts throughout an interval, of which it is told whether they are facets: that which
/// parted the last two first.
pub(super) fn parted(window: &Window, facets: [bool; 2], last: Plane) -> Option<Plane> {
    if window.is_parted_by(last) {
        return Some(last);
    }
    let holds = |plane: &Plane| *plane != last && window.is_parted_by(*plane);
    let both = facets == [true; 2];
    let first: &[Plane] = match facets {
        [false, false] => &PLANES[..1],
        [true, false] => &PLANES[..2],
        [true, true] => &PLANES[..3],
        [false, true] => &[PLANES[0], PLANES[2]],
    };
    let rest = if both { &EDGES[..] } else { &AXES[..] };
    first.iter().chain(rest).copied().find(holds)
}
