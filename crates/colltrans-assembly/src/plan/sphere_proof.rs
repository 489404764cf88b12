//! Proof that no group leaves the others by one translation in *any* direction. A plan reports the number of cells
//! ([`Interlocked::proof_cells`](super::Interlocked::proof_cells)); no certificate is written.
//!
//! The proof does not cover parts that move at the same time in different directions.
//!
//! The sphere is divided into cells. In a cell, one part blocks another if a pair of their facets, or of boxes inside
//! the parts, blocks all directions of the cell; this is decided exactly. If these arcs make all parts one strongly
//! connected component, no group leaves along any direction of the cell. With fixed parts it suffices that every
//! component without leaving arcs contains a fixed part. Arcs of order constraints hold in all cells. Arcs of a cell
//! also hold in its quarters. Arcs are computed on demand, as in [`lazy_search`](super::lazy_search): from components
//! without leaving arcs to parts ahead of them along the cell's centre.

use std::collections::HashMap;

use colltrans::removal::directions::{CellBlocker, DirectionCell};
use colltrans::solid::StartOverlap;
use glam::DVec3;

use crate::blocking::BlockingGraph;
use crate::bodies::Bodies;
use crate::error::AssemblyError;
use crate::roles::PairTolerance;
use crate::watch::Watch;

/// Maximum number of subdivisions of a side of the cube.
const MAX_DEPTH: u32 = 14;
/// Maximum number of cells that are processed.
const MAX_CELLS: usize = 20_000;
/// Maximum number of parts, because memory grows with the number of pairs.
const MAX_PARTS: usize = 40;
/// Maximum number of centres of unproven cells that are returned.
const MAX_OPEN: usize = 48;

/// Outcome of a proof over the sphere.
pub(super) enum SphereProof {
    /// No direction separates the parts. The value is the number of cells.
    Proven(usize),
    /// Not proven. Some of these directions may separate the parts.
    Open(Vec<DVec3>),
}

/// A cell with the arcs that hold in all of it.
struct CellTask {
    cell: DirectionCell,
    arcs: Vec<(usize, usize)>,
}

struct Certifier<'a> {
    bodies: &'a Bodies<'a>,
    parts: &'a [usize],
    among: Vec<bool>,
    /// `None` for pairs that do not support the query.
    blockers: HashMap<[usize; 2], Option<CellBlocker<'a>>>,
}

/// Tries to prove that no group of these parts leaves the others along any direction.
pub(super) fn prove_interlocked(
    bodies: &Bodies,
    parts: &[usize],
    start: StartOverlap,
    watch: Watch,
) -> Result<SphereProof, AssemblyError> {
    if parts.len() > MAX_PARTS || !has_plain_contacts(bodies, parts, start) {
        return Ok(SphereProof::Open(Vec::new()));
    }
    let among = bodies.part_mask(parts);
    let mut certifier = Certifier { bodies, parts, among, blockers: HashMap::new() };
    // Along `-d` all arcs are reversed, which preserves a single component, so half of the sphere suffices. Arcs of
    // order constraints are not reversed, and fixed parts need all cells.
    let constraints = bodies.assembly().constraints();
    let all = certifier.is_any_fixed(parts) || constraints.is_ordered(&certifier.among);
    let sides = if all { 6 } else { 3 };
    let overlapping = bodies.overlapping_pairs().iter().flat_map(|&[a, b]| [(a, b), (b, a)]);
    let order = constraints.order_arcs(&certifier.among);
    let arcs: Vec<(usize, usize)> = overlapping.chain(order).collect();
    let all = DirectionCell::sphere().into_iter().enumerate();
    let wanted = all.filter(|(k, _)| sides == 6 || k % 2 == 0);
    let mut tasks: Vec<CellTask> =
        wanted.map(|(_, cell)| CellTask { cell, arcs: arcs.clone() }).collect();
    let (mut cells, mut open) = (0, Vec::new());
    while let Some(mut task) = tasks.pop() {
        watch.check_cancelled()?;
        cells += 1;
        if certifier.prove_cell(&mut task) {
            continue;
        }
        if task.cell.depth() >= MAX_DEPTH || cells >= MAX_CELLS {
            open.push(task.cell.center().normalize());
            if open.len() >= MAX_OPEN || cells >= MAX_CELLS {
                return Ok(SphereProof::Open(open));
            }
            continue;
        }
        let quarters = task.cell.quarters().into_iter();
        tasks.extend(quarters.map(|cell| CellTask { cell, arcs: task.arcs.clone() }));
    }
    Ok(if open.is_empty() { SphereProof::Proven(cells) } else { SphereProof::Open(open) })
}

/// Checks whether all pairs block each other without exceptions: closed solids, no minimum gap, no ignored overlap at
/// the start, and no pair that is ignored, is a snap fit, or tolerates crossings.
fn has_plain_contacts(bodies: &Bodies, parts: &[usize], start: StartOverlap) -> bool {
    let assembly = bodies.assembly();
    let lets_pass = |a, b| {
        let own = bodies.tolerated_contacts([a, b]);
        matches!(own, Some(PairTolerance::Snap(_) | PairTolerance::Crossing))
    };
    let ignored = |a: usize| {
        parts.iter().any(|&b| assembly.ignored_contacts(a, b).is_some() || lets_pass(a, b))
    };
    start == StartOverlap::Refuse
        && bodies.fit().tolerance() >= 0.0
        && !parts.iter().any(|&a| assembly.parts()[a].is_surface() || ignored(a))
}

impl<'a> Certifier<'a> {
    /// Checks whether no group leaves along any direction of a cell. Adds the arcs that it computes to the task.
    fn prove_cell(&mut self, task: &mut CellTask) -> bool {
        let middle = task.cell.center().normalize();
        let mut tested = Vec::new();
        loop {
            let graph = BlockingGraph::from_arcs(task.arcs.iter().copied(), &self.among);
            let mut groups = graph.removable_groups();
            groups.retain(|group| group.len() < self.parts.len() && !self.is_any_fixed(group));
            if groups.is_empty() {
                return true;
            }
            for group in groups {
                match self.blocking_arc(&group, &task.cell, middle, &mut tested) {
                    Some(arc) => task.arcs.push(arc),
                    None => return false,
                }
            }
        }
    }

    /// Returns an arc from a group to a part outside that holds in the whole cell. Returns `None` if no untested pair
    /// gives one.
    fn blocking_arc(
        &mut self,
        group: &[usize],
        cell: &DirectionCell,
        middle: DVec3,
        tested: &mut Vec<[usize; 2]>,
    ) -> Option<(usize, usize)> {
        for &a in group {
            for (_, b) in self.bodies.parts_ahead(a, middle) {
                if !self.among[b] || group.contains(&b) || tested.contains(&[a, b]) {
                    continue;
                }
                tested.push([a, b]);
                if self.cell_blocker([a, b]).is_some_and(|of| of.is_blocked(cell)) {
                    return Some((a, b));
                }
            }
        }
        None
    }

    fn cell_blocker(&mut self, pair: [usize; 2]) -> Option<&mut CellBlocker<'a>> {
        let bodies = self.bodies;
        self.blockers.entry(pair).or_insert_with(|| bodies.cell_blocker(pair)).as_mut()
    }

    fn is_any_fixed(&self, parts: &[usize]) -> bool {
        parts.iter().any(|&part| self.bodies.assembly().parts()[part].is_fixed())
    }
}
