//! Several moves, where no single one takes anything out.
//!
//! [`WaysOut`] looks for legs that take some parts away from the others, and proves them. What was moved aside goes
//! back along the same lines, the last leg first, once they have left. Back along a leg each pair of parts is in the
//! same places as along it, so the same proofs hold: of what is still there and, by itself, of what has left. So all
//! parts stand where they stood, and one matrix answers for every state of a plan. Nothing is lost by that: whatever
//! the parts that are left can do with others there, they can do without them.
//!
//! The search moves any group against the others. If that group has the base in it, the plan moves the *complement*
//! instead, all other parts, the opposite way: pairs of parts take the same relative ways, so the proofs hold.

use colltrans::ways::{self, Searched, WayOptions, WayOut, WaysOut, of_large_facets};
use colltrans::{Placed, Pose, Solid, free::FreeError, solid::StartOverlap};
use glam::DVec3;

use super::{Leg, PlanOptions};
use crate::blocking::Blocking;
use crate::bodies::Bodies;
use crate::constraints::Constraints;
use crate::error::AssemblyError;
use crate::matrix::Matrix;
use crate::watch::Watch;

/// Axes that are tried, at most.
const MOST_AXES: usize = 13;
/// Where what was found does not keep what is asked, it is looked for once more, so often, with the parts that do not in their
/// places.
const MOST_TRIES: usize = 3;
/// Parts, at most.
const MOST_PARTS: usize = 24;
/// Casts for each move that is asked for, and the share of the work that goes to it.
const CASTS: usize = 500;
const SHARE: u64 = 40;
/// Axes whose cross product is shorter are one.
const ALIKE: f64 = 1e-6;

/// What is known of several moves, one after another, where no single one takes anything out.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Moves {
    /// They were not looked for, and why.
    NotAsked(&'static str),
    /// Of two parts, which is proven: no translations one after another take one from the other.
    Proven {
        /// Cells of displacements that prove it.
        cells: usize,
    },
    /// Of up to so many moves none were found. That is no proof that there are none.
    NotFound {
        /// Moves, the last one included.
        legs: usize,
        /// What was searched.
        searched: Searched,
    },
    /// Those that were found do not keep the order, or the directions, that are asked for.
    NotKept,
}

/// Moves that take a group out, the last one apart.
pub(super) struct Aside {
    /// Those before the last one.
    pub(super) legs: Vec<Leg>,
    /// The same, as vectors.
    pub(super) motions: Vec<DVec3>,
    /// What goes back afterwards.
    pub(super) back: Vec<Leg>,
    /// The group, and where to.
    pub(super) parts: Vec<usize>,
    pub(super) direction: DVec3,
}

/// Finds moves that take some of the parts that are left out, or what is known of them; of two parts, unless not wanted, a
/// proof that there are none. No part for which `stays` holds moves, unless such parts are moved against each other.
pub(super) fn search(
    bodies: &Bodies,
    (left, matrix): (&[usize], &Matrix),
    stays: impl Fn(usize) -> bool,
    options: PlanOptions,
    watch: Watch,
) -> Result<Result<Aside, Moves>, AssemblyError> {
    if let Some(why) = not_asked(bodies, left, options) {
        return Ok(Err(Moves::NotAsked(why)));
    }
    let legs = options.legs;
    if !anything_moves(bodies, left, matrix) {
        let why = "nothing can go by 2 % of the largest part along the directions asked";
        return Ok(Err(Moves::NotAsked(why)));
    }
    let parts = bodies.assembly().parts();
    let placed: Vec<_> = left.iter().map(|&k| parts[k].solid().at(Pose::IDENTITY)).collect();
    let mut fixed: Vec<usize> = (0..left.len()).filter(|&k| parts[left[k]].fixed()).collect();
    let cells = if options.prove { WayOptions::default().cells } else { 0 };
    let options = WayOptions::default()
        .with_cells(cells)
        .with_tolerance(bodies.least_tolerance(left))
        .with_legs(legs)
        .with_casts(CASTS * legs)
        .with_looks(options.looks / SHARE * legs as u64)
        .with_directions(directions(&placed, matrix));
    let constraints = bodies.assembly().constraints();
    for tries in 0.. {
        let way = match WaysOut::among(&placed, &fixed, &options, watch.flag()) {
            Ok(WaysOut::Found(way)) => way,
            Ok(WaysOut::Proven(proof)) => {
                let [a, b] = [&placed[0], &placed[1]];
                proof.verify(a, b).map_err(refused)?;
                return Ok(Err(Moves::Proven { cells: proof.cells() }));
            }
            Ok(WaysOut::NotFound { searched }) => {
                return Ok(Err(Moves::NotFound { legs, searched }));
            }
            Err(FreeError::Overlapping { .. }) => {
                let why = "they overlap with 0.8 of the tolerance, with which moves are planned";
                return Ok(Err(Moves::NotAsked(why)));
            }
            Err(error) => return Err(refused(error)),
        };
        let found = aside(bodies.len(), left, &stays, &way);
        let against = found.against(constraints, &bodies.mask(left));
        if against.is_empty() {
            way.verify(&placed).map_err(refused)?;
            return Ok(Ok(found));
        }
        fixed.extend((0..left.len()).filter(|&k| against.contains(&left[k])));
        fixed.sort_unstable();
        fixed.dedup();
        if tries == MOST_TRIES || fixed.len() >= left.len() {
            break;
        }
    }
    Ok(Err(Moves::NotKept))
}

impl Aside {
    /// What does not do as is asked: parts that leave before others, parts of what stays together that are moved without
    /// the rest of it, and parts that go where they never go, on the way back, too.
    fn against(&self, constraints: &Constraints, there: &[bool]) -> Vec<usize> {
        let mut found = Vec::new();
        for (a, b) in constraints.arcs(there) {
            if self.parts.contains(&a) && !self.parts.contains(&b) {
                found.push(a);
            }
        }
        let last = Leg::straight(self.parts.clone(), self.direction, 0.0);
        for leg in self.legs.iter().chain([&last]).chain(&self.back) {
            let torn =
                |pair: &[usize; 2]| leg.parts.contains(&pair[0]) != leg.parts.contains(&pair[1]);
            found.extend(constraints.pairs(there).into_iter().filter(torn).flatten());
            found.extend(
                leg.parts.iter().filter(|&&part| !constraints.allows(&[part], leg.direction)),
            );
        }
        found.sort_unstable();
        found.dedup();
        found
    }
}

fn refused(error: FreeError) -> AssemblyError {
    match error {
        FreeError::Cancelled => AssemblyError::Cancelled,
        other => AssemblyError::Free(other),
    }
}

/// Why several moves are not looked for: parts that do not stop each other as they are, among others.
fn not_asked(bodies: &Bodies, left: &[usize], options: PlanOptions) -> Option<&'static str> {
    let assembly = bodies.assembly();
    let pairs = || left.iter().flat_map(|&a| left.iter().map(move |&b| [a, b]));
    let ignored = |[a, b]: [usize; 2]| assembly.ignored(a, b).is_some();
    let lets_pass = options.start == StartOverlap::Ignore;
    if options.legs < 2 {
        Some("no more than one was asked for")
    } else if bodies.fit().tolerance() < 0.0 {
        Some("the parts are to be kept apart")
    } else if left.len() > MOST_PARTS {
        Some("there are more than 24 parts")
    } else if left.iter().any(|&k| assembly.parts()[k].is_surface()) {
        Some("there are open surfaces among them")
    } else if pairs().any(|p| bodies.tolerated(p).is_some()) {
        Some("some of them have a fit of their own")
    } else if pairs().any(|p| ignored(p) || lets_pass && bodies.overlaps(p[0], p[1])) {
        Some("overlaps among them are ignored")
    } else {
        None
    }
}

/// Axes of large facets, and those of the matrix.
fn directions(placed: &[Placed<'_, Solid>], matrix: &Matrix) -> Vec<DVec3> {
    let mut axes = of_large_facets(placed);
    for &d in matrix.directions() {
        if axes.len() < MOST_AXES && !axes.iter().any(|a| a.cross(d).length() < ALIKE) {
            axes.push(d);
        }
    }
    axes
}

/// Whether a group can go by a step along a direction of the matrix: if none can, no cast is asked for.
fn anything_moves(bodies: &Bodies, left: &[usize], matrix: &Matrix) -> bool {
    let among = bodies.mask(left);
    let size = |&k: &usize| bodies.bounds(k).size().max_element();
    let step = WayOptions::default().step * left.iter().map(size).fold(0.0, f64::max);
    let fixed = |k: &usize| bodies.assembly().parts()[*k].fixed();
    (0..matrix.directions().len()).any(|k| {
        let met = matrix.meetings(k).iter().filter(|m| m.displaced_distance() < step);
        let graph = Blocking::from_arcs(met.map(|m| (m.moving, m.fixed)), &among);
        graph.removable().iter().any(|g| g.len() < left.len() && !g.iter().any(fixed))
    })
}

/// Returns the parts that a leg moves and the sign of their motion: those of the leg, or all others the opposite way if
/// something that stays is among the former only.
fn moved(leg: &ways::Leg, left: &[usize], stays: &impl Fn(usize) -> bool) -> (Vec<usize>, f64) {
    let group: Vec<usize> = leg.bodies.iter().map(|&k| left[k]).collect();
    let others: Vec<usize> = left.iter().copied().filter(|k| !group.contains(k)).collect();
    let holds = |parts: &[usize]| parts.iter().any(|&part| stays(part));
    if holds(&group) && !holds(&others) { (others, -1.0) } else { (group, 1.0) }
}

/// Returns the moves with the numbers of all parts, and how what made room goes back.
fn aside(count: usize, left: &[usize], stays: &impl Fn(usize) -> bool, way: &WayOut) -> Aside {
    let turned = |v: DVec3, sign: f64| if sign < 0.0 { DVec3::ZERO - v } else { v };
    let (last, before) = way.legs.split_last().expect("a way has a leg");
    let (mut at, mut legs, mut back) = (vec![DVec3::ZERO; count], Vec::new(), Vec::new());
    let mut motions = Vec::new();
    for leg in before {
        let (parts, sign) = moved(leg, left, stays);
        let motion = turned(leg.motion, sign);
        for &part in &parts {
            at[part] += motion;
        }
        legs.push(Leg::straight(parts, turned(leg.direction, sign), leg.travel));
        motions.push(motion);
    }
    let (gone, sign) = moved(last, left, stays);
    // What left as it stood need not go back.
    let as_it_stood = gone.iter().all(|&part| at[part] == at[gone[0]]);
    for leg in legs.iter().rev() {
        let mut parts = leg.parts.clone();
        parts.retain(|part| !(as_it_stood && gone.contains(part)));
        if !parts.is_empty() {
            let direction = DVec3::ZERO - leg.direction;
            back.push(Leg::straight(parts, direction, leg.travel));
        }
    }
    Aside { legs, motions, back, parts: gone, direction: turned(last.direction, sign) }
}
