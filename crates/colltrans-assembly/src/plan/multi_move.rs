//! Removal paths of several moves, for groups that no single move removes.
//!
//! [`RemovalSearch`] searches for legs that separate some parts from the others, and proves them. Parts that were moved to
//! make room return along the same legs in reverse order after the group has left. On its way back a leg has the same
//! relative poses as on its way out, so the same proofs hold for the remaining parts. Therefore all parts are in
//! their initial poses after each step, and one matrix serves every state of a plan. This loses no solution: any
//! motion that is possible among other parts is also possible without them.
//!
//! The search moves any group against the others. If that group contains the base, the plan moves the *complement*,
//! all other parts, in the opposite direction. The relative motions are equal, so the proofs hold.

use colltrans::removal::path::{
    self, RemovalOptions, RemovalPath, RemovalSearch, SearchWork, large_facet_axes,
};
use colltrans::{Placed, Pose, Solid, removal::directions::FreeError, solid::StartOverlap};
use glam::DVec3;

use super::{Leg, PlanOptions};
use crate::blocking::BlockingGraph;
use crate::bodies::Bodies;
use crate::constraints::Constraints;
use crate::error::AssemblyError;
use crate::matrix::ContactMatrix;
use crate::watch::Watch;

/// Maximum number of axes that are tried.
const MAX_AXES: usize = 13;
/// Maximum number of repeated searches after a path violates the constraints. The violating parts are fixed in each
/// repetition.
const MAX_TRIES: usize = 3;
/// Maximum number of parts of a group that is searched.
const MAX_PARTS: usize = 24;
/// Number of casts for each leg, and the divisor of the work limit for each leg.
const CASTS: usize = 500;
const SHARE: u64 = 40;
/// Two axes are equal if their cross product is shorter than this.
const PARALLEL: f64 = 1e-6;

/// Outcome of the search for removal paths of several moves.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum PathSearch {
    /// No search, with the reason.
    NotSearched(&'static str),
    /// For two parts: it is proven that no sequence of translations separates them.
    Proven {
        /// Number of cells of displacements in the proof.
        cells: usize,
    },
    /// No path of up to `legs` moves was found. This does not prove that there is none.
    NotFound {
        /// Maximum number of moves, including the last one.
        legs: usize,
        /// Extent of the search.
        searched: SearchWork,
    },
    /// The paths that were found violate the order or direction constraints.
    ConstraintsViolated,
}

/// A removal path: the legs before the last one, and the direction of the last one.
pub(super) struct MovePath {
    /// The legs before the last one.
    pub(super) legs: Vec<Leg>,
    /// The displacement of each of these legs.
    pub(super) motions: Vec<DVec3>,
    /// The legs that return the moved parts to their initial poses after the removal.
    pub(super) return_legs: Vec<Leg>,
    /// The group that leaves, and its direction.
    pub(super) parts: Vec<usize>,
    pub(super) direction: DVec3,
}

/// Searches for a path that removes some of the remaining parts.
///
/// Returns the path, or else the outcome of the search. For two parts the search may prove that no path exists,
/// unless proofs are disabled. Parts for which `is_stationary` holds do not move, except against each other.
pub(super) fn search_path(
    bodies: &Bodies,
    (left, matrix): (&[usize], &ContactMatrix),
    is_stationary: impl Fn(usize) -> bool,
    options: PlanOptions,
    watch: Watch,
) -> Result<Result<MovePath, PathSearch>, AssemblyError> {
    if let Some(why) = unsupported_reason(bodies, left, options) {
        return Ok(Err(PathSearch::NotSearched(why)));
    }
    let legs = options.max_moves;
    if !can_any_group_move(bodies, left, matrix) {
        let why =
            "no group can travel 2 % of the size of the largest part along the tested directions";
        return Ok(Err(PathSearch::NotSearched(why)));
    }
    let parts = bodies.assembly().parts();
    let placed: Vec<_> = left.iter().map(|&k| parts[k].solid().at(Pose::IDENTITY)).collect();
    let mut fixed: Vec<usize> = (0..left.len()).filter(|&k| parts[left[k]].is_fixed()).collect();
    let cells = if options.prove { RemovalOptions::default().cells } else { 0 };
    let options = RemovalOptions::default()
        .with_cells(cells)
        .with_tolerance(bodies.least_fit_tolerance(left))
        .with_legs(legs)
        .with_casts(CASTS * legs)
        .with_looks(options.max_work / SHARE * legs as u64)
        .with_directions(search_directions(&placed, matrix));
    let constraints = bodies.assembly().constraints();
    for tries in 0.. {
        let way = match RemovalSearch::search_among(&placed, &fixed, &options, watch.cancel_flag())
        {
            Ok(RemovalSearch::Found(way)) => way,
            Ok(RemovalSearch::Proven(proof)) => {
                let [a, b] = [&placed[0], &placed[1]];
                proof.verify(a, b).map_err(to_assembly_error)?;
                return Ok(Err(PathSearch::Proven { cells: proof.cell_count() }));
            }
            Ok(RemovalSearch::NotFound { searched }) => {
                return Ok(Err(PathSearch::NotFound { legs, searched }));
            }
            Err(FreeError::Overlapping { .. }) => {
                let why = "they overlap with 0.8 of the tolerance, which the search uses";
                return Ok(Err(PathSearch::NotSearched(why)));
            }
            Err(error) => return Err(to_assembly_error(error)),
        };
        let found = removal_path(bodies.len(), left, &is_stationary, &way);
        let violating = found.violating_parts(constraints, &bodies.part_mask(left));
        if violating.is_empty() {
            way.verify(&placed).map_err(to_assembly_error)?;
            return Ok(Ok(found));
        }
        fixed.extend((0..left.len()).filter(|&k| violating.contains(&left[k])));
        fixed.sort_unstable();
        fixed.dedup();
        if tries == MAX_TRIES || fixed.len() >= left.len() {
            break;
        }
    }
    Ok(Err(PathSearch::ConstraintsViolated))
}

impl MovePath {
    /// Returns the parts that violate the constraints, in increasing order.
    ///
    /// These are parts that leave too early, parts of a unit that moves incompletely, and parts that move along a
    /// forbidden direction. Return legs are checked as well.
    fn violating_parts(&self, constraints: &Constraints, present: &[bool]) -> Vec<usize> {
        let mut found = Vec::new();
        for (a, b) in constraints.order_arcs(present) {
            if self.parts.contains(&a) && !self.parts.contains(&b) {
                found.push(a);
            }
        }
        let last = Leg::straight(self.parts.clone(), self.direction, 0.0);
        for leg in self.legs.iter().chain([&last]).chain(&self.return_legs) {
            let torn =
                |pair: &[usize; 2]| leg.parts.contains(&pair[0]) != leg.parts.contains(&pair[1]);
            found.extend(constraints.rigid_pairs(present).into_iter().filter(torn).flatten());
            found.extend(
                leg.parts
                    .iter()
                    .filter(|&&part| !constraints.allows_direction(&[part], leg.direction)),
            );
        }
        found.sort_unstable();
        found.dedup();
        found
    }
}

fn to_assembly_error(error: FreeError) -> AssemblyError {
    match error {
        FreeError::Cancelled => AssemblyError::Cancelled,
        other => AssemblyError::Free(other),
    }
}

/// Returns the reason why no path is searched, for example because a pair is ignored. Returns `None` if the search
/// applies.
fn unsupported_reason(
    bodies: &Bodies,
    left: &[usize],
    options: PlanOptions,
) -> Option<&'static str> {
    let assembly = bodies.assembly();
    let pairs = || left.iter().flat_map(|&a| left.iter().map(move |&b| [a, b]));
    let ignored = |[a, b]: [usize; 2]| assembly.ignored_contacts(a, b).is_some();
    let lets_pass = options.start == StartOverlap::Ignore;
    if options.max_moves < 2 {
        Some("the maximum number of moves is 1")
    } else if bodies.fit().tolerance() < 0.0 {
        Some("the fit has a minimum gap")
    } else if left.len() > MAX_PARTS {
        Some("there are more than 24 parts")
    } else if left.iter().any(|&k| assembly.parts()[k].is_surface()) {
        Some("some parts are open surfaces")
    } else if pairs().any(|p| bodies.tolerated_contacts(p).is_some()) {
        Some("some pairs have a fit of their own")
    } else if pairs().any(|p| ignored(p) || lets_pass && bodies.overlaps(p[0], p[1])) {
        Some("some overlaps are ignored")
    } else {
        None
    }
}

/// Returns the axes normal to large facets, and then directions of the matrix that are not parallel to them.
fn search_directions(placed: &[Placed<'_, Solid>], matrix: &ContactMatrix) -> Vec<DVec3> {
    let mut axes = large_facet_axes(placed);
    for &d in matrix.directions() {
        if axes.len() < MAX_AXES && !axes.iter().any(|a| a.cross(d).length() < PARALLEL) {
            axes.push(d);
        }
    }
    axes
}

/// Checks whether some group can travel one search step along a direction of the matrix. If not, no cast is needed.
fn can_any_group_move(bodies: &Bodies, left: &[usize], matrix: &ContactMatrix) -> bool {
    let among = bodies.part_mask(left);
    let size = |&k: &usize| bodies.bounds(k).side_lengths().max_element();
    let step = RemovalOptions::default().step * left.iter().map(size).fold(0.0, f64::max);
    let fixed = |k: &usize| bodies.assembly().parts()[*k].is_fixed();
    (0..matrix.directions().len()).any(|k| {
        let met = matrix.contacts_along(k).iter().filter(|m| m.displaced_distance() < step);
        let graph = BlockingGraph::from_arcs(met.map(|m| (m.moving, m.fixed)), &among);
        graph.removable_groups().iter().any(|g| g.len() < left.len() && !g.iter().any(fixed))
    })
}

/// Returns the parts that a leg moves, and the sign of their motion. These are the parts of the leg, or all others in
/// the opposite direction if only the leg's group contains stationary parts.
fn moved_parts(
    leg: &path::Leg,
    left: &[usize],
    is_stationary: &impl Fn(usize) -> bool,
) -> (Vec<usize>, f64) {
    let group: Vec<usize> = leg.bodies.iter().map(|&k| left[k]).collect();
    let others: Vec<usize> = left.iter().copied().filter(|k| !group.contains(k)).collect();
    let holds = |parts: &[usize]| parts.iter().any(|&part| is_stationary(part));
    if holds(&group) && !holds(&others) { (others, -1.0) } else { (group, 1.0) }
}

/// Converts a path of the search to part indices of the assembly, and adds the return legs.
fn removal_path(
    count: usize,
    left: &[usize],
    is_stationary: &impl Fn(usize) -> bool,
    way: &RemovalPath,
) -> MovePath {
    let turned = |v: DVec3, sign: f64| if sign < 0.0 { DVec3::ZERO - v } else { v };
    let (last, before) = way.legs.split_last().expect("a path has at least one leg");
    let (mut at, mut legs, mut return_legs) = (vec![DVec3::ZERO; count], Vec::new(), Vec::new());
    let mut motions = Vec::new();
    for leg in before {
        let (parts, sign) = moved_parts(leg, left, is_stationary);
        let motion = turned(leg.motion, sign);
        for &part in &parts {
            at[part] += motion;
        }
        legs.push(Leg::straight(parts, turned(leg.direction, sign), leg.travel));
        motions.push(motion);
    }
    let (gone, sign) = moved_parts(last, left, is_stationary);
    // Parts of a group that left without relative displacement need not return.
    let as_it_stood = gone.iter().all(|&part| at[part] == at[gone[0]]);
    for leg in legs.iter().rev() {
        let mut parts = leg.parts.clone();
        parts.retain(|part| !(as_it_stood && gone.contains(part)));
        if !parts.is_empty() {
            let direction = DVec3::ZERO - leg.direction;
            return_legs.push(Leg::straight(parts, direction, leg.travel));
        }
    }
    MovePath { legs, motions, return_legs, parts: gone, direction: turned(last.direction, sign) }
}
