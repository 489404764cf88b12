//! Searches both trees and time for the first contact of two solids, earlier times first.
//!
//! The open entries are a stack of pairs of parts, each with an interval. A pair that no plane separates throughout its
//! interval is split. Its time is halved if the parts rotate far or move farther than a multiple of their size;
//! otherwise the larger part is split. Two remaining facets are searched like two convex bodies. Without a proof to
//! record, the part that is nearer at the start of the interval is searched first. An early contact shortens the
//! intervals of all pairs that follow.
//!
//! Invariant: every pair of facets is separated up to the end of the span, or up to the earliest contact found so far,
//! except for the open entries. Later times are not searched.

use super::super::answer::MotionSteps;
use super::super::proof::{Entry, FacetContactProof, PlaneName, RecordedProof, interval_middle};
use super::super::search::{SpanEnd, SpanResult, prove_span};
use super::facets::{FacetSampler, LaterContact, find_later_contact};
use super::tree::{BoxNode, NodeContent, SolidTree};
use super::window::{Snapshot, SpanFrame, TreePart, Window};
use colltrans_kernel::descent::{node_to_split, pair_with_node};

/// Angle in radians above which an interval is halved.
const MAX_TURN: f64 = 0.7;

/// Maximum distance that two parts move in an interval, as a multiple of their size. If they move farther, the interval
/// is halved.
const MAX_TRAVEL_RATIO: f64 = 4.0;
/// Maximum distance that two facets move in an interval, as a multiple of their size.
const MAX_FACET_TRAVEL_RATIO: f64 = 8.0;

/// Length of an interval below which it is not halved. Its facets are searched in pairs.
const MIN_INTERVAL: f64 = 1e-9;

/// Planes in the order in which they are tried. Those of facets are tried only for facets.
const PLANES: [PlaneName; 3] =
    [PlaneName::Middles, PlaneName::FacetNormal(0), PlaneName::FacetNormal(1)];
const AXES: [PlaneName; 6] = {
    use PlaneName::Axis;
    [Axis(1, 0), Axis(1, 1), Axis(1, 2), Axis(0, 0), Axis(0, 1), Axis(0, 2)]
};
const EDGES: [PlaneName; 9] = {
    use PlaneName::Edges;
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

/// Index of the snapshot at the end of the search: the end of the span, or the lower bound of the earliest contact.
const LAST_SNAPSHOT: u32 = 1;

/// The earliest contact found.
#[derive(Debug, Clone, Copy)]
pub(super) struct EarliestContact {
    /// Time up to which all facets are separated.
    pub(super) lower: f64,
    /// Facets that are not separated from then on.
    pub(super) triangles: [u32; 2],
    /// Whether the search between these two facets took its maximum number of steps.
    pub(super) is_open: bool,
    /// Time of a proven contact, its facets and the proof.
    pub(super) met: Option<(f64, [u32; 2], FacetContactProof)>,
    /// Whether the facets around it are proven to be apart shortly before that time.
    pub(super) is_refined: bool,
}

impl EarliestContact {
    /// Builds a contact that a search of two facets has found.
    fn new(
        lower: f64,
        triangles: [u32; 2],
        is_open: bool,
        met: Option<(f64, [u32; 2], FacetContactProof)>,
    ) -> Self {
        Self { lower, triangles, is_open, met, is_refined: false }
    }
}

/// Purpose of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SearchMode {
    /// Finds the first contact.
    FirstContact,
    /// Finds the first contact and records the proof.
    Recording,
    /// Finds the first contact of facets that face each other, except for facets that cross from the start on.
    IgnoringStartOverlaps,
}

/// A pair of parts in an interval that is not yet searched.
#[derive(Debug, Clone, Copy)]
struct OpenEntry {
    parts: [u32; 2],
    /// Indices of both ends among the snapshots.
    ends: [u32; 2],
    /// Number of snapshots that later entries need.
    snapshots: u32,
}

/// A search in a span.
pub(super) struct TreeSearch<'s, 'a> {
    frame: SpanFrame<'s, 'a>,
    trees: [&'a SolidTree<'a>; 2],
    snapshots: Vec<Snapshot>,
    stack: Vec<OpenEntry>,
    /// Plane that separated the last pair.
    last_plane: PlaneName,
    ignores_start_overlaps: bool,
    pub(super) found: Option<EarliestContact>,
    pub(super) recorded: Option<RecordedProof>,
    pub(super) steps: MotionSteps,
}

impl<'s, 'a> TreeSearch<'s, 'a> {
    /// Starts a search of a span.
    pub(super) fn new(frame: SpanFrame<'s, 'a>, mode: SearchMode) -> Self {
        let trees = [frame.span.body(0), frame.span.body(1)];
        let snapshots = vec![frame.snapshot_at(frame.span.from), frame.snapshot_at(frame.span.to)];
        Self {
            frame,
            trees,
            snapshots,
            stack: Vec::new(),
            last_plane: PlaneName::Middles,
            found: None,
            ignores_start_overlaps: mode == SearchMode::IgnoringStartOverlaps,
            recorded: (mode == SearchMode::Recording).then(RecordedProof::default),
            steps: MotionSteps::default(),
        }
    }

    /// Processes open entries until none is left.
    pub(super) fn process_entries(&mut self) {
        self.stack.push(OpenEntry { parts: [0, 0], ends: [0, 1], snapshots: 2 });
        while let Some(open) = self.stack.pop() {
            self.snapshots.truncate(open.snapshots as usize);
            self.process_entry(open);
        }
    }

    /// Separates a pair, splits it, or searches its facets.
    fn process_entry(&mut self, OpenEntry { parts: at, ends: [from, mut to], .. }: OpenEntry) {
        if let Some(EarliestContact { lower, .. }) = self.found {
            if self.snapshot_time(from) >= lower {
                return;
            }
            if self.snapshot_time(to) > lower {
                to = LAST_SNAPSHOT;
            }
        }
        self.steps.nodes += 1;
        let parts = [0, 1].map(|k| TreePart::at_node(self.trees[k], at[k]));
        let ends = [&self.snapshots[from as usize], &self.snapshots[to as usize]];
        let window = self.frame.window(ends, parts.each_ref());
        let facets = parts.each_ref().map(|part| part.facet().is_some());
        if let Some(plane) = find_separating_plane(&window, facets, self.last_plane) {
            self.last_plane = plane;
            self.record_entry(Entry::Separated(plane));
            return;
        }
        let nodes = [0, 1].map(|k| self.trees[k].node(at[k]));
        let sizes = nodes.map(|node| node.half.length());
        let travel_ratio = window.travel_bound() / sizes[0].max(sizes[1]);
        let turns = window.max_rotation_angle() > MAX_TURN;
        let is_long = ends[1].time - ends[0].time >= MIN_INTERVAL;
        let content = nodes.map(|node| node.content);
        if let [NodeContent::Facet(s), NodeContent::Facet(t)] = content {
            if is_long && (turns || travel_ratio > MAX_FACET_TRAVEL_RATIO) {
                self.halve_interval(at, [from, to]);
            } else {
                self.search_facets([s, t], [from, to], parts.each_ref());
            }
        } else if is_long && (turns || travel_ratio > MAX_TRAVEL_RATIO) {
            self.halve_interval(at, [from, to]);
        } else if let Some((which, [mut first, mut second])) =
            split_larger_node(at, nodes.each_ref())
        {
            if self.recorded.is_some() {
                self.record_entry(Entry::Split(which));
            } else if !self.ignores_start_overlaps {
                let gap = |parts| self.box_gap(parts, from);
                if gap(second) < gap(first) {
                    (first, second) = (second, first);
                }
            }
            let (ends, snapshots) = ([from, to], self.snapshots.len() as u32);
            let open = |parts| OpenEntry { parts, ends, snapshots };
            self.stack.extend([open(second), open(first)]);
        }
    }

    /// Estimates the gap of the boxes of two nodes at a snapshot.
    fn box_gap(&self, parts: [u32; 2], snap: u32) -> f64 {
        let [moving, fixed] = [0, 1].map(|k| self.trees[k].node(parts[k]));
        self.snapshots[snap as usize].box_gap(&moving, &fixed)
    }

    /// Returns the time of a snapshot.
    fn snapshot_time(&self, snap: u32) -> f64 {
        self.snapshots[snap as usize].time
    }

    /// Appends an entry to the proof, if one is recorded.
    fn record_entry(&mut self, entry: Entry) {
        if let Some(recorded) = &mut self.recorded {
            recorded.entries.push(entry);
        }
    }

    /// Splits an open entry at the middle of its interval.
    fn halve_interval(&mut self, parts: [u32; 2], [from, to]: [u32; 2]) {
        self.record_entry(Entry::Halved);
        let [a, b] = [self.snapshot_time(from), self.snapshot_time(to)];
        self.snapshots.push(self.frame.snapshot_at(interval_middle(a, b)));
        let snapshots = self.snapshots.len() as u32;
        let half = |ends| OpenEntry { parts, ends, snapshots };
        self.stack.extend([half([snapshots - 1, to]), half([from, snapshots - 1])]);
    }

    /// Searches two facets in an interval like two convex bodies.
    fn search_facets(&mut self, triangles: [u32; 2], ends: [u32; 2], parts: [&TreePart; 2]) {
        let [Some(f), Some(g)] = parts.map(TreePart::facet) else { return };
        let times = ends.map(|k| self.snapshot_time(k));
        let span = self.frame.span.part_span([f, g], times);
        let mut sampler = FacetSampler::default();
        self.steps.leaves += 1;
        if self.ignores_start_overlaps {
            let sided = [0, 1].map(|k| !self.trees[k].solid.is_open(triangles[k] as usize));
            if let Some(LaterContact { lower, is_open, met }) =
                find_later_contact(&span, sided, &mut sampler)
            {
                let met = met.map(|(time, met)| (time, triangles, met));
                self.store_contact(EarliestContact::new(lower, triangles, is_open, met));
            }
            self.steps += sampler.steps;
            return;
        }
        let SpanResult { planes, end } = prove_span(&span, &mut sampler);
        self.steps += sampler.steps;
        let lower = planes.last().map_or(times[0], |plane| plane.time);
        match end {
            SpanEnd::Free => {
                self.record_entry(Entry::PlaneList);
                if let Some(recorded) = &mut self.recorded {
                    recorded.lists.push(planes);
                }
            }
            SpanEnd::Met(time, met) => {
                let met = Some((time, triangles, met));
                self.store_contact(EarliestContact::new(lower, triangles, false, met));
            }
            SpanEnd::Indeterminate => {
                self.store_contact(EarliestContact::new(lower, triangles, false, None));
            }
            SpanEnd::Stalled => {
                self.store_contact(EarliestContact::new(lower, triangles, true, None));
            }
        }
    }

    /// Stores a contact. The earlier lower bound and the earlier proven contact remain. The recorded entries are
    /// dropped, because they prove times after the contact too.
    fn store_contact(&mut self, new: EarliestContact) {
        self.recorded = None;
        if self.found.is_none_or(|before| new.lower < before.lower) {
            self.snapshots[LAST_SNAPSHOT as usize] = self.frame.snapshot_at(new.lower);
        }
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

/// Returns which of two nodes is split, the larger one that is not a facet, and the resulting pairs. Returns `None` for
/// two facets.
pub(super) fn split_larger_node(at: [u32; 2], nodes: [&BoxNode; 2]) -> Option<(u8, [[u32; 2]; 2])> {
    let are_facets = nodes.map(|node| matches!(node.content, NodeContent::Facet(_)));
    let which = node_to_split(are_facets, |k| nodes[k].half.length())?;
    let NodeContent::Children(children) = nodes[which].content else { return None };
    Some((which as u8, children.map(|part| pair_with_node(at, which, part))))
}

/// Returns a plane that separates two parts throughout an interval, or `None`. The plane that separated the last pair
/// is tried first. `facets` states which parts are facets.
pub(super) fn find_separating_plane(
    window: &Window,
    facets: [bool; 2],
    last_plane: PlaneName,
) -> Option<PlaneName> {
    if window.is_separated_by(last_plane) {
        return Some(last_plane);
    }
    let holds = |plane: &PlaneName| *plane != last_plane && window.is_separated_by(*plane);
    let both = facets == [true; 2];
    let first: &[PlaneName] = match facets {
        [false, false] => &PLANES[..1],
        [true, false] => &PLANES[..2],
        [true, true] => &PLANES[..3],
        [false, true] => &[PLANES[0], PLANES[2]],
    };
    let rest = if both { &EDGES[..] } else { &AXES[..] };
    first.iter().chain(rest).copied().find(holds)
}
