//! Free directions of bodies of cubes, most of them tied, held against ordinary casts along directions of the axes,
//! near them, in cells beside borders, and anywhere; against the union of the cones of all pairs of facets, in
//! fractions; and proofs that were changed, as wholes and cell by cell.

use colltrans::free::{
    CellBlocker, CellProof, DirectionCell, FreeDirections, FreeError, FreeOptions, Verdict,
};
use colltrans::solid::StartOverlap;
use colltrans::{Cast, Placed, Pose, Solid};
use glam::DVec3;

use super::facets::{Judge, Triangle, triangles};
use super::settings::Setting;
use crate::random::Random;

/// Pairs of nodes that are looked at for one setting.
const LOOKS: u64 = 300_000;

/// Cells whose facets are changed, and how often each.
const CELLS: usize = 6;
const CHANGES: usize = 20;

/// What came out of one setting.
#[derive(Debug, Clone, Copy, Default)]
pub struct Judged {
    /// Directions judged, and of these free and undecided.
    pub directions: u64,
    /// Free ones.
    pub free: u64,
    /// Undecided ones.
    pub undecided: u64,
    /// Changed proofs that were refused, as they should be.
    pub refused: u64,
    /// Cells of which another facet is said to block them and does not, which was refused.
    pub cells: u64,
}

impl std::ops::AddAssign for Judged {
    fn add_assign(&mut self, other: Self) {
        self.directions += other.directions;
        self.free += other.free;
        self.undecided += other.undecided;
        self.refused += other.refused;
        self.cells += other.cells;
    }
}

/// Asks about the bodies of a setting along so many directions; `None` where they overlap.
///
/// # Errors
/// What disagrees.
pub fn examine(family: &str, seed: u64, count: u64) -> Result<Option<Judged>, String> {
    let setting = Setting::draw(family, seed).ok_or("no such family")?;
    let [a, b] = [solid(&setting, 0)?, solid(&setting, 1)?];
    let start = if seed.is_multiple_of(2) { StartOverlap::Refuse } else { StartOverlap::Ignore };
    let options =
        FreeOptions::DEFAULT.with_no_tolerance().with_start_overlap(start).with_looks(LOOKS);
    let [p, q] = setting.poses;
    let all = match FreeDirections::of(&a.at(p), &b.at(q), options) {
        Err(FreeError::Overlapping { .. }) => return Ok(None),
        all => all.map_err(|e| e.to_string())?,
    };
    all.verify().map_err(|e| e.to_string())?;
    let mut rng = Random::new(seed ^ 0xf4ee);
    let facets = (start == StartOverlap::Refuse).then(|| {
        [(&a, p), (&b, q)].map(|(solid, pose)| {
            triangles(solid.vertices(), solid.triangles(), (pose.matrix(), pose.translation()))
        })
    });
    let mut judged = Judged {
        refused: changed(&all, [a.at(p), b.at(q)], &mut rng)?,
        cells: changed_cells([&a, &b], [p, q], options, &mut rng)?,
        ..Judged::default()
    };
    for k in 0..count {
        let d = direction(&all, &mut rng);
        let says = all.says(d).map_err(|e| e.to_string())?;
        let free = by_cast([&a, &b], [p, q], start, d)?;
        let in_fractions = facets.as_ref().filter(|_| k == 0);
        if in_fractions.is_some_and(|facets| is_free(facets, d) != free) {
            return Err(format!(
                "along {d:?} the cast says free: {free}, the union of all cones not"
            ));
        }
        match says {
            Verdict::Free if !free => return Err(format!("free along {d:?}, but a cast is not")),
            Verdict::Blocked(pair) if free => {
                return Err(format!("blocked along {d:?} by {pair:?}, but a cast is free"));
            }
            Verdict::Undecided => judged.undecided += 1,
            Verdict::Free => judged.free += 1,
            Verdict::Blocked(_) => {}
        }
        judged.directions += 1;
    }
    Ok(Some(judged))
}

/// Another facet in the place of one that blocks a cell is refused, or the middle of the cell is blocked all the same.
fn changed_cells(
    bodies: [&Solid; 2],
    [p, q]: [Pose; 2],
    options: FreeOptions,
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
        let Some(pair) = blocker.covering(&cell) else { continue };
        for k in 0..CHANGES {
            let (side, mut other) = (k % 2, pair);
            other[side] = rng.int(0, bodies[side].triangles().len() as i64) as u32;
            if !blocker.blocks(&cell, other) {
                refused += 1;
            } else if by_cast(bodies, [p, q], options.start_overlap, cell.center())? {
                return Err(format!("{other:?} are said to block {cell:?}, but a cast is free"));
            }
        }
    }
    Ok(refused)
}

/// Whether no pair of facets of two solids blocks a direction, in fractions, over all of them: brute force.
pub fn is_free_of_all(bodies: [Placed<'_, Solid>; 2], d: DVec3) -> bool {
    let facets = bodies.map(|Placed { body, pose }| {
        triangles(body.vertices(), body.triangles(), (pose.matrix(), pose.translation()))
    });
    is_free(&facets, d)
}

fn solid(setting: &Setting, k: usize) -> Result<Solid, String> {
    let (vertices, facets) = &setting.surfaces[k];
    Solid::from_mesh(vertices, facets).map_err(|e| format!("body {k}: {e}"))
}

fn by_cast(
    bodies: [&Solid; 2],
    [p, q]: [Pose; 2],
    start: StartOverlap,
    d: DVec3,
) -> Result<bool, String> {
    let cast = Cast::new(bodies[0].at(p), bodies[1].at(q), d)
        .and_then(|cast| cast.with_tolerance(0.0))
        .map_err(|e| e.to_string())?;
    let answer = cast.with_start_overlap(start).clearance().map_err(|e| e.to_string())?;
    Ok(answer.is_free())
}

/// Whether no pair of facets blocks, in fractions, over all of them.
fn is_free([moving, fixed]: &[Vec<Triangle>; 2], d: DVec3) -> bool {
    let judge = Judge::new(d);
    let blocks = |f: &Triangle| fixed.iter().any(|g| judge.gaps(f, g).contribution().is_some());
    !moving.iter().any(blocks)
}

fn any(rng: &mut Random) -> DVec3 {
    DVec3::from([0; 3].map(|_| rng.range(-1.0, 1.0)))
}

/// Half of them in cells, which are small beside borders, their corners among them.
fn direction(all: &FreeDirections, rng: &mut Random) -> DVec3 {
    let d = match rng.int(0, 5) {
        0 => rng.grid(-2, 2),
        1 => rng.grid(-2, 2) + any(rng) * 1e-9,
        2 => any(rng),
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

/// Proofs with another facet in one cell are refused, or say nothing else.
fn changed(
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
                    match (same.says(d), all.says(d)) {
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
