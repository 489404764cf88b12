//! Removal paths of several moves, for groups that no single move removes.
//!
//! [`RemovalSearch`] searches for legs that separate some parts from the others, and proves them. Parts that were moved to
//! make room return along the same legs in reverse order after the group has left. On its way back a leg has the same
//! relative poses as on its way out, so the same proofs hold for the remaining parts. Therefore all parts are in
//! their initial poses after each step, and one matrix serves every state of a plan. This loses no solution: any
//! motion that is possible among other parts is also possible without them.
//!
//! Stationary parts never move: instead of a group that contains one, the search moves all other parts in the opposite
//! direction. Roles, tolerances of pairs, ignored overlaps and open surfaces are relations of pairs
//! ([`Bodies::path_relation`]). The search deepens by itself until its [work](PlanOptions::effort) is used.

use colltrans::removal::path::{
    MAX_BODIES, RemovalOptions, RemovalPath, RemovalScene, RemovalSearch, SearchWork,
    large_facet_axes,
};
use colltrans::{Placed, Pose, Solid, removal::directions::FreeError};
use glam::DVec3;

use super::{Leg, PlanOptions, enclosure};
use crate::blocking::BlockingGraph;
use crate::bodies::Bodies;
use crate::constraints::Constraints;
use crate::error::AssemblyError;
use crate::matrix::{ContactMatrix, PairContact};
use crate::watch::Watch;

/// Maximum number of axes that are tried.
const MAX_AXES: usize = 13;
/// Maximum number of repeated searches after a path violates the constraints. The violating parts are fixed in each
/// repetition.
const MAX_TRIES: usize = 3;
/// Maximum number of legs of a path. The work ends a search before.
const MAX_LEGS: usize = 64;
/// Minimum lengths of a move, as fractions of the size of the largest body. After a search has explored all places that
/// moves of one length reach, the next shorter length is tried.
const STEP_SHARES: [f64; 4] = [0.02, 0.005, 0.0025, 0.001];
/// Two axes are equal if their cross product is shorter than this.
const PARALLEL: f64 = 1e-6;

/// Reason for no search with effort 0.
const EFFORT_IS_ZERO: &str = "the effort is 0";

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
    /// It is proven that no motion separates any of the parts from the others: closed surfaces of some enclose the
    /// others. This covers turns, and several parts that move at the same time.
    Enclosed,
    /// No path was found with this effort. This does not prove that there is none.
    NotFound {
        /// The [effort](PlanOptions::effort).
        effort: u32,
        /// Extent of the search.
        searched: SearchWork,
    },
    /// The paths that were found violate the order or direction constraints.
    ConstraintsViolated,
}

impl PathSearch {
    /// No search, because the effort is 0.
    pub const EFFORT_ZERO: Self = Self::NotSearched(EFFORT_IS_ZERO);
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

/// The parts among which a path is searched.
pub(super) struct PathParts<'a> {
    /// The remaining parts.
    pub(super) left: &'a [usize],
    /// The parts of `left` that do not move.
    pub(super) stationary: Vec<usize>,
    /// The parts that may leave; all if there are none. Others may move aside and return.
    pub(super) leaving: &'a [usize],
}

/// Searches for a path that removes some of the remaining parts.
///
/// Returns the path, or else the outcome of the search. For two parts the search may prove that no path exists,
/// unless proofs are disabled.
pub(super) fn search_path(
    bodies: &Bodies,
    among: &PathParts,
    matrix: &ContactMatrix,
    options: PlanOptions,
    watch: Watch,
) -> Result<Result<MovePath, PathSearch>, AssemblyError> {
    let left = among.left;
    if let Some(why) = unsupported_reason(bodies, left, options) {
        return Ok(Err(PathSearch::NotSearched(why)));
    }
    if options.prove && enclosure::are_enclosed(bodies, left) {
        return Ok(Err(PathSearch::Enclosed));
    }
    let can_move = |share: &f64| can_any_group_move(bodies, left, matrix, *share);
    let Some(first) = STEP_SHARES.iter().position(can_move) else {
        let why = "no group can travel 0.1 % of its size along the tested directions";
        return Ok(Err(PathSearch::NotSearched(why)));
    };
    let parts = bodies.assembly().parts();
    let placed: Vec<_> = left.iter().map(|&k| parts[k].solid().at(Pose::IDENTITY)).collect();
    let cells = if options.prove { RemovalOptions::default().cells } else { 0 };
    let mut limits = RemovalOptions::default()
        .with_cells(cells)
        .with_legs(MAX_LEGS)
        .with_places(usize::MAX)
        .with_casts(usize::MAX)
        .with_looks(u64::MAX)
        .with_work(options.work())
        .with_step(STEP_SHARES[first])
        .with_directions(search_directions(&placed, matrix));
    let mut shorter = STEP_SHARES[first + 1..].iter();
    let mut searched_before = SearchWork::default();
    let index = |part: &usize| left.iter().position(|k| k == part);
    let relation = |i: usize, j: usize| bodies.path_relation([left[i], left[j]], options.start);
    let mut scene = RemovalScene::new(placed, relation);
    if !among.leaving.is_empty() {
        scene = scene.with_leaving(&among.leaving.iter().filter_map(index).collect::<Vec<_>>());
    }
    let mut fixed: Vec<usize> = among.stationary.iter().filter_map(index).collect();
    let constraints = bodies.assembly().constraints();
    let mut violations = 0;
    loop {
        scene = scene.with_fixed(&fixed);
        let way = match scene.search(&limits, watch.cancel_flag()) {
            Ok(RemovalSearch::Found(way)) => way,
            Ok(RemovalSearch::Proven(proof)) => {
                let Some([a, b]) = scene.first_proven_pair() else { break };
                proof.verify(&a, &b).map_err(to_assembly_error)?;
                return Ok(Err(PathSearch::Proven { cells: proof.cell_count() }));
            }
            Ok(RemovalSearch::NotFound { searched }) => {
                searched_before = searched_before.followed_by(searched);
                let work = options.work().saturating_sub(searched_before.total());
                match shorter.next() {
                    Some(&step) if searched.complete && work > 0 => {
                        limits = limits.with_step(step).with_work(work).with_cells(0);
                        continue;
                    }
                    _ => {}
                }
                let (effort, searched) = (options.effort, searched_before);
                return Ok(Err(PathSearch::NotFound { effort, searched }));
            }
            Err(FreeError::Overlapping { .. }) => {
                let why = "they overlap with 0.8 of the tolerance, which the search uses";
                return Ok(Err(PathSearch::NotSearched(why)));
            }
            Err(error) => return Err(to_assembly_error(error)),
        };
        let found = removal_path(bodies.len(), left, &way);
        let violating = found.violating_parts(constraints, &bodies.part_mask(left));
        if violating.is_empty() {
            way.verify_in(&scene).map_err(to_assembly_error)?;
            return Ok(Ok(found));
        }
        fixed.extend(violating.iter().filter_map(index));
        fixed.sort_unstable();
        fixed.dedup();
        violations += 1;
        if violations > MAX_TRIES || fixed.len() >= left.len() {
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
    if options.effort == 0 {
        Some(EFFORT_IS_ZERO)
    } else if bodies.fit().tolerance() < 0.0 {
        Some("the fit has a minimum gap")
    } else if left.len() > MAX_BODIES {
        Some("there are more than 127 parts")
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

/// Checks whether some group can travel a share of its size along a direction of the matrix. If not, no cast is needed.
fn can_any_group_move(bodies: &Bodies, left: &[usize], matrix: &ContactMatrix, share: f64) -> bool {
    let among = bodies.part_mask(left);
    let size = |k: usize| bodies.bounds(k).side_lengths().max_element();
    let fixed = |k: &usize| bodies.assembly().parts()[*k].is_fixed();
    (0..matrix.directions().len()).any(|k| {
        let is_close = |m: &&PairContact| m.displaced_distance() < share * size(m.moving);
        let met = matrix.contacts_along(k).iter().filter(is_close);
        let graph = BlockingGraph::from_arcs(met.map(|m| (m.moving, m.fixed)), &among);
        graph.removable_groups().iter().any(|g| g.len() < left.len() && !g.iter().any(fixed))
    })
}

/// Converts a path of the search to part indices of the assembly, and adds the return legs.
fn removal_path(count: usize, left: &[usize], way: &RemovalPath) -> MovePath {
    let members = |bodies: &[usize]| bodies.iter().map(|&k| left[k]).collect::<Vec<usize>>();
    let (last, before) = way.legs.split_last().expect("a path has at least one leg");
    let (mut at, mut legs, mut return_legs) = (vec![DVec3::ZERO; count], Vec::new(), Vec::new());
    let mut motions = Vec::new();
    for leg in before {
        let parts = members(&leg.bodies);
        for &part in &parts {
            at[part] += leg.motion;
        }
        legs.push(Leg::straight(parts, leg.direction, leg.travel));
        motions.push(leg.motion);
    }
    let gone = members(&last.bodies);
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
    MovePath { legs, motions, return_legs, parts: gone, direction: last.direction }
}
