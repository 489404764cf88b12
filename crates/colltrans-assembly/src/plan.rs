//! Disassembly plans: the removal steps, the parts that remain, and why they remain.
//!
//! All parts keep their initial poses until they are removed. Which parts block a part along a direction therefore does
//! not depend on earlier removals: the blocking graph of every state is a subgraph of one [`ContactMatrix`]. Each step
//! removes one of the smallest removable groups over all directions (module `order` chooses among them). The *base*
//! never moves: the fixed parts, or else the largest part. If a removable group contains the base, the other parts move
//! in the opposite direction. A removed group is then taken apart by itself.
//!
//! If no direction of the matrix removes a group, these are tried in turn: finer candidates, samples of the sphere,
//! samples refined for movable parts, a proof over the sphere, paths of several moves, and a turn followed by a move.
//! The last two deepen until the [effort](PlanOptions::effort) is used.
//! Every step is replayed against the remaining parts before it is reported (module `replay`). The exception is a turn
//! followed by a move, which its own search proves (module `bayonet`).

mod bayonet;
mod enclosure;
mod interlock;
mod known_parts;
mod lazy_search;
mod multi_move;
mod options;
mod order;
mod precedence;
mod ranking;
mod replay;
mod selection;
mod shadow;
mod single;
mod smallest_set;
mod sphere_proof;
mod stability;
mod stage;
mod step;
mod times;
mod tolerated;
mod unscrewing;

use std::collections::{BTreeMap, HashSet};
use std::sync::atomic::AtomicBool;

use colltrans::Bounded;
use colltrans::removal::directions::FreeOptions;
use colltrans::solid::Workspace;
use glam::DVec3;
use petgraph::unionfind::UnionFind;

use crate::blocking::BlockingGraph;
use crate::bodies::Bodies;
use crate::candidates::FinerCandidate;
use crate::error::AssemblyError;
use crate::fasteners::Fasteners;
use crate::free::RemovalPair;
use crate::map::{MapOptions, find_removal_direction};
use crate::matrix::{ContactMatrix, direction_bits};
use crate::part::Part;
use crate::sphere::{Sphere, normalized_direction};
use crate::watch::{Stage, StageProgress, Watch};
use crate::witness::Memory;

use bayonet::Bayonet;
pub use interlock::BlockingSets;
use known_parts::KnownParts;
pub use multi_move::PathSearch;
use multi_move::{MovePath, PathParts};
pub use options::PlanOptions;
use order::{GroupChoice, Order};
pub use precedence::precedence_graph;
pub use selection::{SelectedRemoval, remove};
use single::SingleParts;
use sphere_proof::{SphereProof, prove_interlocked};
pub use step::{Leg, Step, Turn, TurnProof};
pub use times::HandlingTimes;
pub use tolerated::ToleratedContact;

/// Interlocked parts: no translation of a group as one body separates it from the other parts.
///
/// The statement holds for all directions if [`proof_cells`](Self::proof_cells) is set, otherwise for the tested
/// directions. Field [`path_search`](Self::path_search) reports whether paths of several moves were searched. Parts
/// that move at the same time, each in its own direction, may still come apart.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Interlocked {
    /// Indices of the parts, in increasing order.
    pub parts: Vec<usize>,
    /// Number of distinct directions that were tested.
    pub tested_directions: usize,
    /// Number of cells of the sphere of directions in the proof that no group leaves the others by one translation,
    /// in any direction. `None` without a proof; then directions that were not tested may separate the parts.
    pub proof_cells: Option<usize>,
    /// Result of the search for paths of several moves.
    pub path_search: PathSearch,
    /// For each movable part, the smallest sets of other parts that block it.
    pub blocking_sets: Vec<BlockingSets>,
    /// Pairs that overlap with this fit and therefore move as one body.
    pub overlapping_pairs: Vec<[usize; 2]>,
    /// Whether the group contains fixed parts.
    pub has_fixed_parts: bool,
    /// Whether order or direction constraints concern these parts. All statements then hold under these constraints.
    pub is_constrained: bool,
}

/// A disassembly plan.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Plan {
    /// The steps in order. Steps that take a group apart follow the step that removed the group.
    pub steps: Vec<Step>,
    /// Parts from which all others were removed and which stay in place: the base, parts that stay together, or an
    /// interlocked group without fixed parts. Empty if parts [remain](Self::remaining).
    pub base: Vec<usize>,
    /// Parts that remain because they are fixed or because no tested direction moves them.
    pub remaining: Vec<usize>,
    /// Interlocked groups, with the reasons.
    pub interlocked: Vec<Interlocked>,
    /// For each part, the index of the first part with the same shape, see
    /// [`first_identical_parts`](crate::identical::first_identical_parts).
    pub first_identical: Vec<usize>,
    /// The fasteners of the assembly. They affect the order and the texts, never which moves are free.
    pub fasteners: Fasteners,
    /// For a plan that removes selected parts: which other parts are removed with them. `None` for a plan of all
    /// parts.
    pub selection: Option<SelectedRemoval>,
}

impl Plan {
    /// Returns the parts that stay although all parts, or the selected ones, were to be removed: the
    /// [remaining](Self::remaining) parts, or the [base](Self::base) if it is an interlocked group.
    pub fn parts_left(&self) -> &[usize] {
        if self.interlocked.iter().any(|group| group.parts == self.base) {
            return &self.base;
        }
        &self.remaining
    }
}

/// Computes a plan that takes all parts apart.
///
/// Uses the directions of a matrix of all parts, and finer directions for parts that those do not move. For interlocked
/// groups, tries to prove that no translation direction separates them ([`Interlocked::proof_cells`]). The proof is not
/// attempted in these cases:
/// - [`PlanOptions::prove`] is false, a minimum gap is set, or overlaps at the start are ignored;
/// - the group has more than 40 parts, open surfaces, ignored pairs, snap fits, or pairs whose crossings at the start
///   are tolerated.
///
/// # Errors
/// Returns an error if the run is cancelled, if the up direction of the options is zero or not finite, or if a step
/// fails its replay (a bug).
pub fn disassemble<'a>(
    bodies: &'a Bodies<'a>,
    matrix: &ContactMatrix<'a>,
    finer: &[FinerCandidate],
    options: PlanOptions,
    watch: Watch,
) -> Result<Plan, AssemblyError> {
    let known = KnownParts::new(bodies)?;
    let mut planner = Planner::new(bodies, finer, &known, options, watch)?;
    planner.plan_all(matrix)?;
    let plan = planner.plan;
    Ok(known.complete(plan))
}

/// Maximum number of finer directions that are tested for an interlocked group.
const MAX_FINER: usize = 64;
/// Maximum number of groups for which the sphere of samples is refined.
const MAX_LOOSE: usize = 64;
/// A group counts as movable if it travels at least this fraction of its size along a main direction.
const MIN_LOOSE_TRAVEL: f64 = 0.125;

struct Planner<'a> {
    bodies: &'a Bodies<'a>,
    finer: &'a [FinerCandidate],
    options: PlanOptions,
    up: DVec3,
    known: &'a KnownParts,
    watch: Watch<'a>,
    tally: StageProgress<'a>,
    plan: Plan,
    contact_cache: lazy_search::ContactCache,
    /// The complete matrix of the remaining parts, once a state without a removable single part needed it.
    complete_matrix: Option<ContactMatrix<'a>>,
    /// Whether any part is an open surface.
    has_surfaces: bool,
    /// The selected parts to remove; empty to remove all.
    wanted: &'a [usize],
    /// The parts that may leave, if the plan is limited to some. Only these move, ...
    movable: Option<&'a [usize]>,
    /// ... unless others may move aside and return.
    makes_room: bool,
}

/// Maximum number of box pairs visited for the free directions of a group with a known removal direction.
const MAX_REGION_LOOKS: u64 = 1_000_000;

/// A removable group with its direction.
struct GroupRemoval {
    parts: Vec<usize>,
    direction: DVec3,
    /// The path of several moves, if one move does not suffice.
    path: Option<MovePath>,
    /// The turn before the straight move and the travel after it, if a turn is needed.
    bayonet: Option<(Leg, Bounded)>,
}

impl GroupRemoval {
    fn straight(parts: Vec<usize>, direction: DVec3) -> Self {
        Self { parts, direction, path: None, bayonet: None }
    }
}

/// The parts that were removed from a group.
struct RemovedParts {
    /// The step that removed this group; `None` for the whole assembly.
    within: Option<usize>,
    /// For each removed part, the index of its step.
    step_of_part: BTreeMap<usize, usize>,
}

impl From<GroupChoice> for GroupRemoval {
    fn from(GroupChoice { parts, direction }: GroupChoice) -> Self {
        Self::straight(parts, direction)
    }
}

/// Returns the best of the smallest removable groups over all directions of a matrix. Returns `None` if no group may
/// leave.
fn smallest_removable_group(
    order: &mut Order,
    matrix: &ContactMatrix,
    left: &[usize],
) -> Option<GroupChoice> {
    #[cfg(test)]
    GRAPH_COUNT.with(|graphs| graphs.set(graphs.get() + matrix.directions().len()));
    let mut groups: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    let arcs = order.order_arcs();
    for (k, &d) in matrix.directions().iter().enumerate() {
        for group in BlockingGraph::with_order(matrix, k, &arcs, order.present()).removable_groups()
        {
            let removal = order
                .choice_for(&group, left, d)
                .filter(|removal| removal.parts.len() < left.len());
            let Some(GroupChoice { parts, direction }) = removal else { continue };
            let along = order.direction_index(direction);
            let ways = groups.entry(parts).or_default();
            if !ways.contains(&along) {
                ways.push(along);
            }
        }
    }
    let least = groups.keys().map(Vec::len).min()?;
    groups.retain(|parts, _| parts.len() == least);
    order.best_group(&groups.iter().map(|(parts, ways)| (&parts[..], &ways[..])))
}

#[cfg(test)]
thread_local! {
    /// Number of blocking graphs that were built.
    static GRAPH_COUNT: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

impl<'a> Planner<'a> {
    fn new(
        bodies: &'a Bodies<'a>,
        finer: &'a [FinerCandidate],
        known: &'a KnownParts,
        options: PlanOptions,
        watch: Watch<'a>,
    ) -> Result<Self, AssemblyError> {
        let tally = watch.start_stage(Stage::Plan, bodies.len());
        let up = normalized_direction(options.up.unwrap_or(bodies.assembly().up()))?;
        let (plan, contact_cache) = (Plan::default(), lazy_search::ContactCache::default());
        let (wanted, movable) = (&[][..], None);
        let has_surfaces = bodies.assembly().parts().iter().any(Part::is_surface);
        Ok(Self {
            bodies,
            finer,
            options,
            up,
            known,
            watch,
            tally,
            plan,
            contact_cache,
            complete_matrix: None,
            has_surfaces,
            wanted,
            movable,
            makes_room: false,
        })
    }

    /// Plans the removal of all parts, or of the selected ones.
    fn plan_all(&mut self, matrix: &ContactMatrix<'a>) -> Result<(), AssemblyError> {
        let all: Vec<usize> = (0..self.bodies.len()).collect();
        self.plan.remaining = self.take_apart(&all, matrix, None)?;
        Ok(())
    }

    /// Returns a complete matrix that covers at least the remaining parts. Reuses the stored one if it covers them.
    fn complete_matrix_among(
        &mut self,
        matrix: &ContactMatrix<'a>,
        left: &[usize],
    ) -> Result<ContactMatrix<'a>, AssemblyError> {
        match self.complete_matrix.take().filter(|known| known.covers(left)) {
            Some(known) => self.complete_matrix = Some(known),
            None => {
                self.complete_matrix =
                    Some(matrix.complete_among(&self.bodies.part_mask(left), self.watch)?);
            }
        }
        Ok(self.complete_matrix.clone().unwrap_or_else(|| matrix.clone()))
    }

    /// Takes a group apart. Returns the parts that remain; empty if the group comes apart completely.
    fn take_apart(
        &mut self,
        group: &[usize],
        matrix: &ContactMatrix<'a>,
        within: Option<usize>,
    ) -> Result<Vec<usize>, AssemblyError> {
        let alive = self.bodies.part_mask(group);
        let mut left = group.to_vec();
        let movable = self.movable.filter(|_| within.is_none());
        let (bodies, known, wanted) = (self.bodies, self.known, self.wanted);
        let PlanOptions { samples, start, .. } = self.options;
        let mut order = Order::new(bodies, matrix, &known.likes, &alive, self.up, movable, wanted)
            .with_shortcuts(samples, start)
            .with_preferred(&known.preferred);
        let constraints = self.bodies.assembly().constraints();
        let watch = self.watch;
        let single_parts = |order: &Order| {
            let (arcs, present) = (order.order_arcs(), order.present());
            let movable = |k: usize, part: usize| {
                !order.is_stationary(part)
                    && constraints.allows_direction(&[part], matrix.directions()[k])
            };
            SingleParts::new(bodies, matrix, &arcs, present, movable, watch)
        };
        let mut single = single_parts(&order)?;
        let mut removed = RemovedParts { within, step_of_part: BTreeMap::new() };
        while !left.is_empty() {
            self.watch.check_cancelled()?;
            let one = left.len() == 1 || constraints.keeps_together(&left);
            if self.is_out(&left, within) || one && !left.iter().any(|&k| self.is_fixed(k)) {
                self.finish_with(left, within);
                return Ok(Vec::new());
            }
            if one {
                return Ok(left);
            }
            let mut tested: HashSet<[u64; 3]> =
                matrix.directions().iter().copied().map(direction_bits).collect();
            let (mut choice, mut whole) = (order.best_single_part(&mut single), None);
            while choice.is_none() && order.relax() {
                // The order of tools or fasteners permits no part alone: this step ignores it.
                choice = order.best_single_part(&mut single_parts(&order)?);
            }
            if choice.is_none() {
                let whole = &*whole.insert(self.complete_matrix_among(matrix, &left)?);
                choice = smallest_removable_group(&mut order, whole, &left);
            }
            let among = whole.as_ref().unwrap_or(matrix);
            let mut removal = choice.map(GroupRemoval::from);
            let mut proven = None;
            if removal.is_none() {
                let mut found = self.search_finer(&order, &left, among, &mut tested)?;
                if found.is_none() {
                    (found, proven) = self.prove_stuck(&order, &left, &mut tested)?;
                }
                removal = found
                    .map(|removal| self.best_direction(&mut order, &left, removal))
                    .transpose()?;
            }
            let mut moves = None;
            if removal.is_none() {
                (removal, moves) = self.search_path(&order, &left, among, movable)?;
            }
            if removal.is_none() && moves != Some(PathSearch::Enclosed) {
                let found =
                    bayonet::search_bayonet(bodies, &order, &left, self.options, self.watch)?;
                removal = found.map(|Bayonet { turn, direction, travel }| GroupRemoval {
                    bayonet: Some((turn.clone(), travel)),
                    ..GroupRemoval::straight(turn.parts, direction)
                });
            }
            let Some(removal) = removal else {
                self.explain_stuck(&left, among, (tested.len(), proven, moves));
                let alone = within.is_none() && !self.plan.steps.is_empty();
                if alone && !left.iter().any(|&k| self.is_fixed(k)) {
                    // All other parts are removed, so this group remains as the last one.
                    self.finish_with(left, within);
                    return Ok(Vec::new());
                }
                return Ok(left);
            };
            let released = constraints.released_count(order.present());
            left.retain(|k| !removal.parts.contains(k));
            let unsettled = order.unsettled_parts(&removal.parts);
            order.remove(&removal.parts, removal.direction);
            if constraints.released_count(order.present()) > released {
                single = single_parts(&order)?;
            } else {
                removal.parts.iter().for_each(|&part| single.remove(part));
            }
            order.restore();
            self.take_out(removal, (&order, &left), unsettled, matrix, &mut removed)?;
        }
        Ok(left)
    }

    /// Appends the step that removes a group, and then takes the group apart.
    fn take_out(
        &mut self,
        removal: GroupRemoval,
        (order, left): (&Order, &[usize]),
        [falls, off_balance]: [Vec<usize>; 2],
        matrix: &ContactMatrix<'a>,
        removed: &mut RemovedParts,
    ) -> Result<(), AssemblyError> {
        let start = self.options.start;
        let mut travel = match &removal.bayonet {
            Some((_, travel)) => *travel,
            None => replay::checked_travel(self.bodies, &removal, (order, left), start)?,
        };
        let at = self.plan.steps.len();
        let GroupRemoval { parts, direction, path: moves, bayonet } = removal;
        let present = order.present();
        let ignored = self.bodies.present_partners(&parts, present).filter(|&[a, b]| {
            self.bodies.tolerated_contacts([a, b]).is_none()
                && self.bodies.disregards_contacts(a, b, start)
        });
        let ignored = ignored.collect();
        let passed = ToleratedContact::tolerated_contacts(self.bodies, &parts, present);
        let mut surfaces = self.surfaces_ahead(&parts, left, direction);
        for leg in moves.iter().flat_map(|moves| &moves.legs) {
            surfaces.extend(self.surfaces_ahead(&leg.parts, left, leg.direction));
        }
        surfaces.sort_unstable();
        surfaces.dedup();
        let several = moves.is_some() || bayonet.is_some();
        let after = self.preceding_steps(&parts, direction, several, matrix, removed);
        removed.step_of_part.extend(parts.iter().map(|&part| (part, at)));
        let (mut path, back) =
            moves.map_or_else(Default::default, |moves| (moves.legs, moves.return_legs));
        if let Some(turned) = self.unscrewed_first_leg(&path, &parts, left) {
            path.splice(0..1, turned);
        }
        path.extend(bayonet.map(|(turn, _)| turn));
        let along = (&parts[..], direction);
        let unscrewed = || {
            unscrewing::unscrewing_legs(self.bodies, along, (left, present), (travel, true), start)
        };
        match path.is_empty().then(unscrewed).flatten() {
            Some((legs, rest)) => {
                path.extend(legs);
                travel = rest;
            }
            None => path.push(Leg::straight(parts.clone(), direction, travel.value)),
        }
        let unscrewing = self.known.plain_unscrewing(&path, &parts, present);
        let tool = self.known.tool_reach(&path, &parts, present);
        self.plan.steps.push(Step {
            parts: parts.clone(),
            direction,
            travel,
            path,
            unscrewing,
            tool,
            return_legs: back,
            group_step: removed.within,
            predecessors: after,
            ignored,
            tolerated: passed,
            falling: falls,
            off_balance,
            surfaces,
        });
        for _ in &parts {
            self.tally.finish_item()?;
        }
        let wanted = |part: &usize| self.wanted.contains(part);
        let none = self.wanted.is_empty();
        if parts.len() > 1 && (none || parts.iter().any(wanted) && !parts.iter().all(wanted)) {
            // A group that stays together is handled by the recursive call.
            self.take_apart(&parts, matrix, Some(at))?;
        }
        Ok(())
    }

    /// Returns the two legs that replace the first one of a path by a turn and a straight move, if it unscrews the
    /// parts that the path removes. `left` are the parts that remain.
    fn unscrewed_first_leg(
        &self,
        path: &[Leg],
        parts: &[usize],
        left: &[usize],
    ) -> Option<[Leg; 2]> {
        let first = path.first().filter(|leg| leg.parts == parts)?;
        let Leg { direction, travel: length, .. } = *first;
        let travel = Bounded { value: length, lower: length, upper: length };
        let (along, mask) = ((parts, direction), self.bodies.part_mask(left));
        let (present, start) = ((left, &mask[..]), self.options.start);
        let legs = unscrewing::unscrewing_legs(self.bodies, along, present, (travel, false), start);
        legs.map(|(legs, _)| legs)
    }

    /// Checks whether all selected parts are removed.
    fn is_out(&self, left: &[usize], within: Option<usize>) -> bool {
        let is_left = |part: &usize| left.contains(part);
        within.is_none() && !self.wanted.is_empty() && !self.wanted.iter().any(is_left)
    }

    /// Stores the last part or group of the whole assembly. Does nothing for a group that was taken apart.
    fn finish_with(&mut self, left: Vec<usize>, within: Option<usize>) {
        if within.is_none() {
            self.plan.base = left;
        }
    }

    /// Returns the steps that must precede the removal of a group, in increasing order.
    ///
    /// These are the step that removed the enclosing group, the steps demanded by order constraints, and the steps
    /// that removed parts in the way. A path of several moves must follow all earlier steps of its group.
    fn preceding_steps(
        &self,
        group: &[usize],
        direction: DVec3,
        several: bool,
        matrix: &ContactMatrix,
        RemovedParts { within, step_of_part }: &RemovedParts,
    ) -> Vec<usize> {
        let mut after: Vec<usize> = within.iter().copied().collect();
        let constraints = &self.known.preferred[0];
        if constraints.is_any_order() {
            let waits =
                step_of_part.iter().filter(|(part, _)| constraints.must_wait_for(group, **part));
            after.extend(waits.map(|(_, step)| *step));
        }
        if several {
            after.extend(step_of_part.values());
        } else if let Some(k) = matrix.direction_index(direction).filter(|_| matrix.is_complete()) {
            let met = group.iter().flat_map(|&part| matrix.contacts_of_part(k, part));
            after.extend(met.filter_map(|m| step_of_part.get(&m.fixed)));
        } else {
            let (mut workspace, start) = (Workspace::default(), self.options.start);
            for &part in group {
                for (_, other) in self.bodies.parts_ahead(part, direction) {
                    let Some(step) = step_of_part.get(&other).filter(|step| !after.contains(step))
                    else {
                        continue;
                    };
                    if self.bodies.ever_meets([part, other], direction, start, &mut workspace) {
                        after.push(*step);
                    }
                }
            }
        }
        after.sort_unstable();
        after.dedup();
        after
    }

    /// Returns the open surfaces of a group and those remaining ones whose boxes lie ahead of the group.
    fn surfaces_ahead(&self, group: &[usize], left: &[usize], direction: DVec3) -> Vec<usize> {
        let passed =
            |&part: &usize| self.bodies.parts_ahead(part, direction).into_iter().map(|x| x.1);
        if !self.has_surfaces {
            return Vec::new();
        }
        let parts = self.bodies.assembly().parts();
        let mut found: Vec<usize> = group.iter().flat_map(passed).collect();
        found.retain(|part| left.contains(part));
        found.extend(group);
        found.retain(|&part| parts[part].is_surface());
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Searches for a removable group along directions that the matrix lacks: finer candidates first, then samples of
    /// the sphere, then refined samples. Adds the tested directions to `tested`.
    fn search_finer(
        &mut self,
        order: &Order,
        left: &[usize],
        matrix: &ContactMatrix,
        tested: &mut HashSet<[u64; 3]>,
    ) -> Result<Option<GroupRemoval>, AssemblyError> {
        let alive = order.present();
        if left.iter().filter(|&&k| !self.is_fixed(k)).count() == 0 {
            return Ok(None);
        }
        let concerning = |any: bool| {
            let own = self.finer.iter().filter(move |f| f.part.is_none() == any);
            own.filter(|f| f.concerns_any_of(alive)).map(|f| f.direction)
        };
        let own: Vec<DVec3> = concerning(true).chain(concerning(false).take(MAX_FINER)).collect();
        let sphere = match self.options.samples {
            0 => Vec::new(),
            count => Sphere::with_directions(count).directions,
        };
        for directions in [own, sphere] {
            tested.extend(directions.iter().copied().map(direction_bits));
            let removal = self.smallest_group(order, left, &directions)?;
            if removal.is_some() {
                return Ok(removal);
            }
        }
        self.search_refined(order, left, matrix)
    }

    /// Searches for a removal direction of a movable group on a sphere of samples that is refined where outcomes
    /// change. Groups are single parts, and parts that move as one because they overlap or are constrained to leave
    /// together.
    fn search_refined(
        &self,
        order: &Order,
        left: &[usize],
        matrix: &ContactMatrix,
    ) -> Result<Option<GroupRemoval>, AssemblyError> {
        let alive = order.present();
        let PlanOptions { start, samples, .. } = self.options;
        if samples == 0 {
            return Ok(None);
        }
        let moving = |group: &[usize]| order.moving_parts(group, left).map(|parts| parts.len());
        let mut groups = self.rigid_groups(left);
        groups.retain(|g| g.len() < left.len() && moving(g).is_some());
        groups.retain(|g| self.is_loose(g, alive, matrix));
        groups.sort_by_key(|g| (moving(g), g[0]));
        groups.truncate(MAX_LOOSE);
        let options = MapOptions { samples, start, ..MapOptions::default() };
        for parts in groups {
            let found = find_removal_direction(self.bodies, &parts, alive, options, self.watch)?;
            if let Some(direction) = found.filter(|&d| order.choice_for(&parts, left, d).is_some())
            {
                return Ok(Some(GroupRemoval::straight(parts, direction)));
            }
        }
        Ok(None)
    }

    /// Checks whether a group travels at least [`MIN_LOOSE_TRAVEL`] of its size along a direction of the matrix.
    fn is_loose(&self, group: &[usize], alive: &[bool], matrix: &ContactMatrix) -> bool {
        let bounds = group.iter().map(|&k| self.bodies.bounds(k)).reduce(|a, b| a.union(&b));
        let size = bounds.map_or(0.0, |b| (b.high - b.low).max_element());
        (0..matrix.directions().len()).any(|k| {
            let met = group.iter().flat_map(|&part| matrix.contacts_of_part(k, part));
            let mut met = met.filter(|m| alive[m.fixed] && !group.contains(&m.fixed));
            met.all(|m| m.displaced_distance() >= MIN_LOOSE_TRAVEL * size)
        })
    }

    /// Partitions parts into rigid groups: parts that overlap, unless the overlap is ignored, and parts that must
    /// leave together.
    fn rigid_groups(&self, left: &[usize]) -> Vec<Vec<usize>> {
        let mut sets = UnionFind::new(self.bodies.len());
        for &[a, b] in self.bodies.overlapping_pairs() {
            let rigid = !self.bodies.disregards_contacts(a, b, self.options.start);
            if rigid && left.contains(&a) && left.contains(&b) {
                sets.union(a, b);
            }
        }
        for [a, b] in self.bodies.assembly().constraints().rigid_pairs(&self.bodies.part_mask(left))
        {
            sets.union(a, b);
        }
        let mut groups = BTreeMap::<usize, Vec<usize>>::new();
        for &k in left {
            groups.entry(sets.find(k)).or_default().push(k);
        }
        groups.into_values().collect()
    }

    /// Returns the removable group of present parts for which the fewest parts move, over some directions. Returns
    /// `None` if no group that the order allows is removable.
    fn smallest_group(
        &mut self,
        order: &Order,
        left: &[usize],
        directions: &[DVec3],
    ) -> Result<Option<GroupRemoval>, AssemblyError> {
        let allowed = |group: &[usize], d| order.moving_count(group, left, d);
        let (bodies, start, watch) = (self.bodies, self.options.start, self.watch);
        let (alive, known) = (order.present(), &mut self.contact_cache);
        lazy_search::smallest_group(bodies, directions, alive, start, allowed, known, watch)
    }

    /// Tries to prove that no direction separates the parts. If the proof fails, tests the directions that it left
    /// open.
    ///
    /// Returns the group found along such a direction, and the number of cells of a complete proof.
    fn prove_stuck(
        &mut self,
        order: &Order,
        left: &[usize],
        tested: &mut HashSet<[u64; 3]>,
    ) -> Result<(Option<GroupRemoval>, Option<usize>), AssemblyError> {
        if !self.options.prove {
            return Ok((None, None));
        }
        let start = self.options.start;
        let directions = match prove_interlocked(self.bodies, left, start, self.watch)? {
            SphereProof::Proven(cells) => return Ok((None, Some(cells))),
            SphereProof::Open(directions) => directions,
        };
        tested.extend(directions.iter().copied().map(direction_bits));
        let removal = self.smallest_group(order, left, &directions)?;
        Ok((removal, None))
    }

    /// Returns the best direction for a group with a known removal direction.
    ///
    /// The candidates are that direction, its opposite, and the nearest centre of a free region. If the base is in the
    /// group, the other parts move instead.
    fn best_direction(
        &self,
        order: &mut Order,
        left: &[usize],
        removal: GroupRemoval,
    ) -> Result<GroupRemoval, AssemblyError> {
        let Some(parts) = order.moving_parts(&removal.parts, left) else { return Ok(removal) };
        let found = if parts == removal.parts {
            removal.direction
        } else {
            DVec3::ZERO - removal.direction
        };
        let others: Vec<usize> = left.iter().copied().filter(|k| !parts.contains(k)).collect();
        let mut directions = vec![found, DVec3::ZERO - found];
        directions.extend(self.region_center_near(&parts, &others, found)?);
        let constraints = self.bodies.assembly().constraints();
        let (mut memory, present) = (Memory::default(), self.bodies.part_mask(&others));
        directions.retain(|&d| {
            constraints.allows_direction(&parts, d)
                && memory.is_free(self.bodies, &parts, &present, d, self.options.start)
        });
        let ways: Vec<usize> = directions.into_iter().map(|d| order.direction_index(d)).collect();
        let group = (&parts[..], &ways[..]);
        Ok(order.best_group(&std::iter::once(group)).map_or(removal, GroupRemoval::from))
    }

    /// Returns the centre of a free region that is nearest to a direction, of all free regions. Returns `None` if the
    /// free directions cannot be computed or no region is free.
    fn region_center_near(
        &self,
        parts: &[usize],
        others: &[usize],
        direction: DVec3,
    ) -> Result<Option<DVec3>, AssemblyError> {
        // Without exact free directions the found direction is used.
        let Ok(removal) = RemovalPair::between(self.bodies, parts, others) else { return Ok(None) };
        let options = FreeOptions::DEFAULT.with_looks(MAX_REGION_LOOKS);
        let never = AtomicBool::new(false);
        let free =
            match removal.free_directions(options, self.watch.cancel_flag().unwrap_or(&never)) {
                Ok(free) => free,
                Err(AssemblyError::Cancelled) => return Err(AssemblyError::Cancelled),
                Err(_) => return Ok(None),
            };
        let near = |d: &DVec3| d.dot(direction);
        let around = free.regions().into_iter().map(|region| region.center);
        Ok(around.max_by(|a, b| near(a).total_cmp(&near(b))))
    }

    /// Searches for a removal path of several moves. Returns the path, or else the outcome of the search. `movable`
    /// are the parts that may leave, if not all may.
    fn search_path(
        &self,
        order: &Order,
        left: &[usize],
        matrix: &ContactMatrix,
        movable: Option<&[usize]>,
    ) -> Result<(Option<GroupRemoval>, Option<PathSearch>), AssemblyError> {
        if left.iter().all(|&k| self.is_fixed(k)) {
            return Ok((None, None));
        }
        let makes_room = self.makes_room && movable.is_some();
        let stays = |part: &usize| {
            if makes_room { self.is_fixed(*part) } else { order.is_stationary(*part) }
        };
        let mut stationary: Vec<usize> = left.iter().copied().filter(stays).collect();
        if stationary.is_empty() {
            let volume = |part: &usize| self.bodies.bounds(*part).side_lengths().element_product();
            let others = left.iter().filter(|part| movable.is_none_or(|own| !own.contains(part)));
            stationary.extend(others.max_by(|a, b| volume(a).total_cmp(&volume(b))));
        }
        let leaving = if makes_room { movable.unwrap_or_default() } else { &[] };
        let among = PathParts { left, stationary, leaving };
        let found = multi_move::search_path(self.bodies, &among, matrix, self.options, self.watch)?;
        Ok(match found {
            Ok(path) => {
                let (parts, direction) = (path.parts.clone(), path.direction);
                let removal = GroupRemoval::straight(parts, direction);
                (Some(GroupRemoval { path: Some(path), ..removal }), None)
            }
            Err(moves) => (None, Some(moves)),
        })
    }

    fn explain_stuck(
        &mut self,
        left: &[usize],
        matrix: &ContactMatrix,
        (tested, proven, moves): (usize, Option<usize>, Option<PathSearch>),
    ) {
        let movable = left.iter().any(|&k| !self.is_fixed(k));
        if !movable {
            return;
        }
        let fixed = left.iter().any(|&k| self.is_fixed(k));
        let moves = moves.unwrap_or(PathSearch::NotSearched("all parts are fixed"));
        let known = (tested, proven, moves);
        self.plan.interlocked.push(interlock::explain_stuck(
            self.bodies,
            left,
            matrix,
            fixed,
            known,
        ));
    }

    fn is_fixed(&self, part: usize) -> bool {
        self.bodies.assembly().parts()[part].is_fixed()
    }
}

#[cfg(test)]
mod tests {
    use colltrans::solid::StartOverlap;
    use colltrans_mesh::Mesh;
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::block;
    use glam::DAffine3;

    use std::sync::atomic::Ordering::Relaxed;

    use super::*;
    use crate::bodies::Fit;
    use crate::identical::first_identical_parts;
    use crate::part::{Assembly, Piece};

    fn cube_part(name: usize, at: DVec3) -> Part {
        box_part(name, at, DVec3::ONE)
    }

    fn box_part(name: usize, at: DVec3, size: DVec3) -> Part {
        let cube = block(DVec3::ZERO, size);
        let mesh = Mesh::new(cube.vertices, cube.faces);
        let piece = Piece { mesh, world_from_piece: DAffine3::from_translation(at) };
        Part::new(name.to_string(), &[piece]).unwrap()
    }

    #[test]
    fn single_part_removals_build_no_blocking_graph() {
        let parts = (0..40).map(|k| cube_part(k, DVec3::X * 2.0 * k as f64)).collect();
        let assembly = Assembly::new(parts).unwrap();
        let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
        let (all, start, watch) = (vec![true; 40], StartOverlap::Refuse, Watch::default());
        let matrix =
            ContactMatrix::new(&bodies, &[DVec3::X, DVec3::NEG_X], &all, start, watch).unwrap();
        GRAPH_COUNT.with(|graphs| graphs.set(0));
        let plan = disassemble(&bodies, &matrix, &[], PlanOptions::default(), watch).unwrap();
        assert_eq!(plan.steps.len(), 39);
        assert_eq!(plan.base.len(), 1);
        assert!(plan.steps.iter().all(|step| step.parts.len() == 1));
        assert_eq!(
            GRAPH_COUNT.with(std::cell::Cell::get),
            0,
            "number of graphs for 40 steps along 2 directions"
        );
    }

    #[test]
    fn best_single_part_equals_scan_of_removable_parts() {
        let mut random = Random::new(23);
        let (start, watch) = (StartOverlap::Refuse, Watch::default());
        let axes: Vec<DVec3> = DVec3::AXES.iter().flat_map(|&d| [d, -d]).collect();
        let mut steps = 0;
        for round in 0..12 {
            // Stacks of blocks, some of them smaller. Neighbours touch in every second round.
            let gap = [1.0, 1.3][round % 2];
            let mut parts = Vec::new();
            for cell in (0..48).filter(|_| random.unit() < 0.6).collect::<Vec<usize>>() {
                let [x, y, z] = [cell % 4, cell / 4 % 3, cell / 12].map(|k| k as f64);
                let sizes = [DVec3::ONE, DVec3::new(0.4, 1.0, 1.0), DVec3::new(0.9, 0.9, 1.0)];
                let (at, size) = (DVec3::new(gap * x, gap * y, z), sizes[random.index(3)]);
                parts.push(box_part(parts.len(), at, size));
            }
            let count = parts.len();
            let assembly = Assembly::new(parts).unwrap();
            let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
            let (all, likes) = (vec![true; count], first_identical_parts(&assembly));
            let matrix = ContactMatrix::on_demand(&bodies, &axes, &all, start);
            let mut order = Order::new(&bodies, &matrix, &likes, &all, DVec3::Z, None, &[])
                .with_shortcuts(42, start);
            let movable = |_, part: usize| !order.is_stationary(part);
            let mut single = SingleParts::new(&bodies, &matrix, &[], &all, movable, watch).unwrap();
            while let Some(GroupChoice { parts, direction }) = order.best_single_part(&mut single) {
                let ways = |part| Some((part, single.free_directions(part)?.to_vec()));
                let free: Vec<(usize, Vec<usize>)> = (0..count).filter_map(ways).collect();
                let groups =
                    free.iter().map(|(part, ways)| (std::slice::from_ref(part), &ways[..]));
                let scanned = order.best_group(&groups).unwrap();
                assert_eq!((&parts, direction), (&scanned.parts, scanned.direction));
                order.remove(&parts, direction);
                single.remove(parts[0]);
                steps += 1;
            }
        }
        assert!(steps > 200, "{steps}");
    }

    #[test]
    fn removals_from_a_row_query_n_log_n_pairs() {
        let mut random = Random::new(5);
        let (start, watch) = (StartOverlap::Refuse, Watch::default());
        for count in [100, 200, 400] {
            let parts = (0..count).map(|k| cube_part(k, DVec3::X * 2.0 * k as f64)).collect();
            let assembly = Assembly::new(parts).unwrap();
            let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
            let all = vec![true; count];
            let matrix = ContactMatrix::on_demand(&bodies, &[DVec3::X, DVec3::NEG_X], &all, start);
            bodies.query_count.store(0, Relaxed);
            let mut single =
                SingleParts::new(&bodies, &matrix, &[], &all, |_, _| true, watch).unwrap();
            assert_eq!(single.entry_count(), 2 * count);
            // Parts are removed in random order. The expected number of parts that each part watches in turn is about
            // `ln n`.
            let mut left: Vec<usize> = (0..count).collect();
            while !left.is_empty() {
                let removed = left.swap_remove(random.index(left.len()));
                single.remove(removed);
                let ways = |part| Some((part, single.free_directions(part)?.to_vec()));
                let free: Vec<(usize, Vec<usize>)> = (0..count).filter_map(ways).collect();
                let expected = match (left.iter().min(), left.iter().max()) {
                    (Some(low), Some(high)) if low < high => {
                        vec![(*low, vec![1]), (*high, vec![0])]
                    }
                    (Some(last), _) => vec![(*last, vec![0, 1])],
                    _ => Vec::new(),
                };
                assert_eq!(free, expected);
            }
            let (tested, n) = (bodies.query_count.load(Relaxed) as f64, count as f64);
            assert!(tested <= 2.0 * n * (2.0 + n.ln()), "{tested} of {n} parts");
        }
    }
}
