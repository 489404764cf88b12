//! Judges free directions of bodies of cubes and of convex bodies, most of them with ties.
//!
//! - They are compared with casts along axes, near them, in cells next to borders, and along random directions.
//! - They are compared with the union of the cones of all pairs of facets, in rational arithmetic.
//! - The bodies are also rotated together, and queried with a larger tolerance, which must not free less.
//! - Proofs are modified as a whole and cell by cell, and must be rejected.

mod alike;
mod bodies;
pub mod thin;

use colltrans::removal::directions::{
    CellBlocker, CellProof, DirectionCell, FreeDirections, FreeError, FreeOptions, Verdict,
};
use colltrans::solid::{SolidCast, StartOverlap};
use colltrans::{Cast, Placed, Pose, Solid};
use glam::DVec3;

use super::facets::{FacetJudge, Triangle, triangles};
use crate::random::Random;
use crate::tally::Tally;
pub use bodies::FAMILIES;
use bodies::{Bodies, draw};

/// Maximum number of pairs of nodes that a query examines.
const LOOKS: u64 = 300_000;

/// Maximum number of pairs of facets that are examined in rational arithmetic for a setting, over all
/// directions. At least one direction is judged.
const PAIRS: usize = 3_000;

/// Maximum number of pairs of facets for which arcs and isolated directions are judged.
const THIN: usize = 4_000;

/// Number of cells whose facets are modified.
const CELLS: usize = 6;

/// Columns: numbers of settings, of overlaps, of judged directions, free ones, undecided ones, those judged in
/// rational arithmetic, judged arcs and isolated directions, directions compared after a rotation or with a
/// larger tolerance, rejected modified proofs, and cells with a modified facet that does not block them.
pub const COLUMNS: &[&str] = &[
    "settings",
    "overlapping",
    "judged",
    "free",
    "undecided",
    "fractions",
    "thin",
    "compared",
    "refused",
    "cells",
];

/// Judges the bodies of a setting along `count` directions.
///
/// # Errors
/// A description of the first disagreement.
pub fn examine(family: &str, seed: u64, count: u64, tally: &mut Tally) -> Result<(), String> {
    tally.count("settings");
    let bodies = draw(family, seed)?.ok_or("no such family")?;
    let Bodies { solids: [a, b], poses: [p, q] } = &bodies;
    let (p, q) = (*p, *q);
    let start = if seed.is_multiple_of(2) { StartOverlap::Refuse } else { StartOverlap::Ignore };
    // The rational judge does not know the bodies that a tolerance shrinks.
    let tolerance = if seed % 8 < 6 { 0.0 } else { 0.03125 };
    let options =
        FreeOptions::DEFAULT.with_tolerance(tolerance).with_start_overlap(start).with_looks(LOOKS);
    let all = match FreeDirections::compute(&a.at(p), &b.at(q), options) {
        Err(FreeError::Overlapping { .. }) => {
            tally.count("overlapping");
            return Ok(());
        }
        all => all.map_err(|e| e.to_string())?,
    };
    all.verify().map_err(|e| e.to_string())?;
    let mut rng = Random::new(seed ^ 0xf4ee);
    tally.add("refused", check_changed_proofs(&all, [a.at(p), b.at(q)], &mut rng)?);
    tally.add("cells", changed_cells([a, b], [p, q], (options, count), &mut rng)?);
    let pairs = a.triangles().len() * b.triangles().len();
    if start == StartOverlap::Refuse && tolerance == 0.0 && pairs <= THIN {
        tally.add("thin", thin::judge(&all, [a.at(p), b.at(q)])?);
    }
    compare_along(&all, [a.at(p), b.at(q)], count, &mut rng, tally)?;
    if seed % 4 == 2 {
        tally.add("compared", alike::turned(&all, &bodies, &mut rng)?);
    }
    // Ignored overlaps decrease with a larger tolerance, and may then block. They are excluded here.
    if seed.is_multiple_of(4) && start == StartOverlap::Refuse {
        let larger = alike::larger(&all, &bodies, tolerance + 0.015_625, &mut rng)?;
        tally.add("compared", larger);
    }
    Ok(())
}

/// Compares the answers along `count` directions with casts and with rational arithmetic.
fn compare_along(
    all: &FreeDirections,
    bodies: [Placed<'_, Solid>; 2],
    count: u64,
    rng: &mut Random,
    tally: &mut Tally,
) -> Result<(), String> {
    let options = all.options();
    let exactly = options.start_overlap == StartOverlap::Refuse && all.tolerance() == 0.0;
    let facets = exactly.then(|| facets(bodies));
    let pairs = bodies.map(|placed| placed.body.triangles().len());
    let in_fractions = (PAIRS / (pairs[0] * pairs[1])).max(1) as u64;
    for k in 0..count {
        let d = direction(all, rng);
        let says = all.classify(d).map_err(|e| e.to_string())?;
        let free = by_cast(bodies, options, d)?;
        if let Some(facets) = facets.as_ref().filter(|_| k < in_fractions) {
            tally.count("fractions");
            if is_free(facets, d) != free {
                return Err(format!(
                    "along {d:?} the cast says free: {free}, the union of all cones not"
                ));
            }
        }
        match says {
            Verdict::Free if !free => return Err(format!("free along {d:?}, but a cast is not")),
            Verdict::Blocked(pair) if free => {
                return Err(format!("blocked along {d:?} by {pair:?}, but a cast is free"));
            }
            Verdict::Undecided => tally.count("undecided"),
            Verdict::Free => tally.count("free"),
            Verdict::Blocked(_) => {}
        }
        tally.count("judged");
    }
    Ok(())
}

/// Replaces a blocking facet of cells, and checks that the change is rejected or the centre of the cell is
/// blocked nevertheless.
fn changed_cells(
    bodies: [&Solid; 2],
    [p, q]: [Pose; 2],
    (options, count): (FreeOptions, u64),
    rng: &mut Random,
) -> Result<u64, String> {
    let blocker = CellBlocker::new(&bodies[0].at(p), &bodies[1].at(q), options);
    let blocker = blocker.map_err(|e| e.to_string())?;
    let mut refused = 0;
    for _ in 0..CELLS {
        let mut cell = DirectionCell::sphere()[rng.int(0, 5) as usize];
        for _ in 0..rng.int(0, 6) {
            cell = cell.quarters()[rng.int(0, 3) as usize];
        }
        let Some(pair) = blocker.blocking_pair(&cell) else { continue };
        for k in 0..count as usize {
            let (side, mut other) = (k % 2, pair);
            other[side] = rng.int(0, bodies[side].triangles().len() as i64) as u32;
            if !blocker.is_blocked_by(&cell, other) {
                refused += 1;
            } else if by_cast([bodies[0].at(p), bodies[1].at(q)], options, cell.center())? {
                return Err(format!("{other:?} are said to block {cell:?}, but a cast is free"));
            }
        }
    }
    Ok(refused)
}

/// Checks whether a direction is free, over all pairs of facets of two solids in rational arithmetic (brute
/// force).
pub fn is_free_of_all(bodies: [Placed<'_, Solid>; 2], d: DVec3) -> bool {
    is_free(&facets(bodies), d)
}

fn facets(bodies: [Placed<'_, Solid>; 2]) -> [Vec<Triangle>; 2] {
    bodies.map(|Placed { body, pose }| {
        triangles(body.vertices(), body.triangles(), (pose.matrix(), pose.translation()))
    })
}

fn by_cast([a, b]: [Placed<'_, Solid>; 2], options: FreeOptions, d: DVec3) -> Result<bool, String> {
    let cast = Cast::new(a, b, d)
        .and_then(|cast| cast.with_tolerance(options.tolerance.unwrap_or(0.0)))
        .map_err(|e| e.to_string())?;
    let cast = cast.with_start_overlap(options.start_overlap);
    Ok(cast.clearance().map_err(|e| e.to_string())?.is_free())
}

/// Checks whether no pair of facets blocks a direction, in rational arithmetic.
fn is_free(facets: &[Vec<Triangle>; 2], d: DVec3) -> bool {
    is_free_along(facets, &FacetJudge::new(d))
}

fn is_free_along([moving, fixed]: &[Vec<Triangle>; 2], judge: &FacetJudge) -> bool {
    let blocks = |f: &Triangle| fixed.iter().any(|g| judge.gaps(f, g).contribution().is_some());
    !moving.iter().any(blocks)
}

fn any_direction(rng: &mut Random) -> DVec3 {
    DVec3::from([0; 3].map(|_| rng.range(-1.0, 1.0)))
}

/// Draws a direction. Half of them are in cells, which are small near borders, including their corners.
fn direction(all: &FreeDirections, rng: &mut Random) -> DVec3 {
    let d = match rng.int(0, 5) {
        0 => rng.grid(-2, 2),
        1 => rng.grid(-2, 2) + any_direction(rng) * 1e-9,
        2 => any_direction(rng),
        kind => {
            let cells = all.cells().count();
            let corners = all.cells().nth(rng.int(0, cells as i64 - 1) as usize).map(|c| c.corners);
            let [a, b, c, _] = corners.unwrap_or([DVec3::X; 4]);
            let part =
                |rng: &mut Random| if kind == 3 { rng.whole(0, 1) } else { rng.range(0.0, 1.0) };
            a + (b - a) * part(rng) + (c - b) * part(rng)
        }
    };
    if d == DVec3::ZERO { DVec3::X } else { d }
}

/// Checks that proofs with a different facet in one cell are rejected, or make the same statement.
fn check_changed_proofs(
    all: &FreeDirections,
    bodies: [Placed<'_, Solid>; 2],
    rng: &mut Random,
) -> Result<u64, String> {
    let proof = all.proof();
    let [p, q] = bodies;
    let mut refused = 0;
    for _ in 0..4 {
        let (mut other, at) = (proof.clone(), rng.int(0, proof.cells.len() as i64 - 1) as usize);
        let counts = [p, q].map(|placed| placed.body.triangles().len() as i64);
        let side = rng.int(0, 1) as usize;
        let facet = rng.int(0, counts[side]) as u32;
        let pairs: &mut [[u32; 2]] = match &mut other.cells[at] {
            CellProof::Cut => continue,
            CellProof::Blocked(pair) | CellProof::Inner(pair) => std::slice::from_mut(pair),
            CellProof::Open(pairs) | CellProof::Undecided(pairs) => pairs,
        };
        let Some(pair) = pairs.first_mut() else { continue };
        pair[side] = facet;
        match FreeDirections::from_proof(&p, &q, &other) {
            Err(_) => refused += 1,
            Ok(same) if same.free_area()[0] > all.free_area()[1] + all.undecided_area() => {
                return Err("a changed proof was accepted with more that is free".to_owned());
            }
            Ok(same) => {
                for _ in 0..4 {
                    let d = direction(all, rng);
                    match (same.classify(d), all.classify(d)) {
                        (Ok(Verdict::Free), Ok(Verdict::Blocked(_)))
                        | (Ok(Verdict::Blocked(_)), Ok(Verdict::Free)) => {
                            return Err(format!("a changed proof was accepted: {d:?}"));
                        }
                        _ => {}
                    }
                }
            }
        }
    }
    Ok(refused)
}
