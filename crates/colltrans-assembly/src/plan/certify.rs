//! A proof over the whole sphere that no group, moved as one by a translation, leaves the others along *any* direction.
//! Parts that move at once, each its own way, are not covered.
//!
//! The sphere is cut into cells. In a cell, one part blocks another all over it if one pair of their facets, or of boxes
//! inside them, blocks the whole cell, which is decided exactly. If such arcs make one component, no group leaves along
//! any direction of the cell; with parts that are fixed, if every component that no arc leaves has one of them. An order
//! that is asked for has arcs that hold everywhere. Arcs of
//! a cell hold in its quarters. As in [`loose`](super::loose) arcs are asked as needed: out of components that none leaves, towards
//! parts that are ahead of the middle of the cell.

use std::collections::HashMap;

use colltrans::free::{CellBlocker, DirectionCell};
use colltrans::solid::StartOverlap;
use glam::DVec3;

use crate::blocking::Blocking;
use crate::bodies::Bodies;
use crate::error::AssemblyError;
use crate::roles::Tolerated;
use crate::watch::Watch;

/// Sides of the cube are halved no more often.
const DEEPEST: u32 = 14;
/// Cells that are looked at, at most.
const MOST_CELLS: usize = 20_000;
/// Parts, at most: memory goes with pairs.
const MOST_PARTS: usize = 40;
/// Of cells that are not proven, so many middles are handed back.
const MOST_OPEN: usize = 48;

/// What came of a proof.
pub(super) enum Proof {
    /// No direction takes them apart, in so many cells.
    Proven(usize),
    /// Along some of these directions perhaps.
    Open(Vec<DVec3>),
}

/// A cell, and the arcs that hold all over it.
struct Task {
    cell: DirectionCell,
    arcs: Vec<(usize, usize)>,
}

struct Certifier<'a> {
    bodies: &'a Bodies<'a>,
    parts: &'a [usize],
    among: Vec<bool>,
    /// `None` of parts that cannot be asked.
    blockers: HashMap<[usize; 2], Option<CellBlocker<'a>>>,
}

/// Tries to prove that no group of these parts leaves the others along any direction.
pub(super) fn certify(
    bodies: &Bodies,
    parts: &[usize],
    start: StartOverlap,
    watch: Watch,
) -> Result<Proof, AssemblyError> {
    if parts.len() > MOST_PARTS || !is_plain(bodies, parts, start) {
        return Ok(Proof::Open(Vec::new()));
    }
    let among = bodies.mask(parts);
    let mut certifier = Certifier { bodies, parts, among, blockers: HashMap::new() };
    // Along -d all arcs are turned round, which leaves one component one; those of an order are not.
    let constraints = bodies.assembly().constraints();
    let all = certifier.is_any_fixed(parts) || constraints.is_ordered(&certifier.among);
    let sides = if all { 6 } else { 3 };
    let overlapping = bodies.overlapping().iter().flat_map(|&[a, b]| [(a, b), (b, a)]);
    let order = constraints.arcs(&certifier.among);
    let arcs: Vec<(usize, usize)> = overlapping.chain(order).collect();
    let all = DirectionCell::sphere().into_iter().enumerate();
    let wanted = all.filter(|(k, _)| sides == 6 || k % 2 == 0);
    let mut tasks: Vec<Task> = wanted.map(|(_, cell)| Task { cell, arcs: arcs.clone() }).collect();
    let (mut cells, mut open) = (0, Vec::new());
    while let Some(mut task) = tasks.pop() {
        watch.check()?;
        cells += 1;
        if certifier.holds(&mut task) {
            continue;
        }
        if task.cell.depth() >= DEEPEST || cells >= MOST_CELLS {
            open.push(task.cell.center().normalize());
            if open.len() >= MOST_OPEN || cells >= MOST_CELLS {
                return Ok(Proof::Open(open));
            }
            continue;
        }
        let quarters = task.cell.quarters().into_iter();
        tasks.extend(quarters.map(|cell| Task { cell, arcs: task.arcs.clone() }));
    }
    Ok(if open.is_empty() { Proof::Proven(cells) } else { Proof::Open(open) })
}

/// Whether all pairs stop each other as they are: closed bodies, none ignored, none kept apart.
fn is_plain(bodies: &Bodies, parts: &[usize], start: StartOverlap) -> bool {
    let assembly = bodies.assembly();
    let lets_pass = |a, b| {
        let own = bodies.tolerated([a, b]);
        matches!(own, Some(Tolerated::Bent(_) | Tolerated::Crossing))
    };
    let ignored =
        |a: usize| parts.iter().any(|&b| assembly.ignored(a, b).is_some() || lets_pass(a, b));
    start == StartOverlap::Refuse
        && bodies.fit().tolerance() >= 0.0
        && !parts.iter().any(|&a| assembly.parts()[a].is_surface() || ignored(a))
}

impl<'a> Certifier<'a> {
    /// Whether no group leaves along any direction of a cell; adds the arcs that were found.
    fn holds(&mut self, task: &mut Task) -> bool {
        let middle = task.cell.center().normalize();
        let mut asked = Vec::new();
        loop {
            let graph = Blocking::from_arcs(task.arcs.iter().copied(), &self.among);
            let mut groups = graph.removable();
            groups.retain(|group| group.len() < self.parts.len() && !self.is_any_fixed(group));
            if groups.is_empty() {
                return true;
            }
            for group in groups {
                match self.leaving(&group, &task.cell, middle, &mut asked) {
                    Some(arc) => task.arcs.push(arc),
                    None => return false,
                }
            }
        }
    }

    /// An arc from a group to a part outside that holds all over a cell.
    fn leaving(
        &mut self,
        group: &[usize],
        cell: &DirectionCell,
        middle: DVec3,
        asked: &mut Vec<[usize; 2]>,
    ) -> Option<(usize, usize)> {
        for &a in group {
            for (_, b) in self.bodies.ahead(a, middle) {
                if !self.among[b] || group.contains(&b) || asked.contains(&[a, b]) {
                    continue;
                }
                asked.push([a, b]);
                if self.blocker([a, b]).is_some_and(|of| of.covers(cell)) {
                    return Some((a, b));
                }
            }
        }
        None
    }

    fn blocker(&mut self, pair: [usize; 2]) -> Option<&mut CellBlocker<'a>> {
        let bodies = self.bodies;
        self.blockers.entry(pair).or_insert_with(|| bodies.cell_blocker(pair)).as_mut()
    }

    fn is_any_fixed(&self, parts: &[usize]) -> bool {
        parts.iter().any(|&part| self.bodies.assembly().parts()[part].fixed())
    }
}
