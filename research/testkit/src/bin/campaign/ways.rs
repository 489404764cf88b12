//! Campaign of removal paths in several moves: puzzles of cubes, axis-aligned and rotated, compared with all
//! moves of cubes, and boxes with holes that are large enough or not, axis-aligned and rotated. Every leg is
//! checked at 201 positions.

use colltrans::removal::path::{Order, RemovalOptions, RemovalPath, RemovalSearch};
use colltrans::solid::SolidCast;
use colltrans::{Cast, ConvexPolyhedron, Placed, Pose, Solid};
use colltrans_testkit::oracle::cubes::Cubes;
use colltrans_testkit::random::Random;
use colltrans_testkit::tally::Tally;
use glam::DVec3;

use crate::Asked;

/// The families of settings.
pub(crate) const FAMILIES: [&str; 4] =
    ["tunnels", "turned tunnels", "boxes with holes", "turned boxes"];

/// Maximum number of moves.
const LEGS: usize = 12;
/// Number of positions of each leg, without its start.
const PLACES: u32 = 200;

/// Columns of the table.
pub(crate) const COLUMNS: &[&str] =
    &["settings", "found", "proven", "open", "legs", "most legs", "places", "refused"];

/// Examines a setting.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let Asked { family, seed, .. } = *asked;
    let mut random = Random::new(seed);
    tally.count("settings");
    let pose = if family.starts_with("turned") {
        Pose::new(random.rotation(), DVec3::ZERO).map_err(|e| e.to_string())?
    } else {
        Pose::IDENTITY
    };
    match family {
        "tunnels" | "turned tunnels" => examine_puzzle(&mut random, pose, tally),
        _ => holes(&mut random, pose, tally),
    }
}

/// Examines a puzzle of cubes.
fn examine_puzzle(random: &mut Random, pose: Pose, tally: &mut Tally) -> Result<(), String> {
    let cubes = Cubes::random(random);
    let solids = cubes.solids();
    let placed: Vec<Placed<'_, Solid>> = solids.iter().map(|solid| solid.at(pose)).collect();
    let options = RemovalOptions::default()
        .with_order(Order::FewestLegs)
        .with_tolerance(1e-5)
        .with_legs(LEGS)
        .with_cells(2_000);
    let answer =
        RemovalSearch::search_among(&placed, &[], &options, None).map_err(|e| e.to_string())?;
    let level = cubes.level().filter(|level| level.moves <= LEGS);
    match (&answer, level) {
        (RemovalSearch::Found(way), Some(level)) if way.legs.len() == level.moves => (),
        (RemovalSearch::Found(way), _) => {
            return Err(format!("{} legs, {level:?} of cubes", way.legs.len()));
        }
        (_, Some(level)) => return Err(format!("no way, {level:?} of cubes")),
        _ => (),
    }
    // For cubes the judge computes overlaps without the library.
    let inverse = pose.matrix().transpose();
    let enters = |pair, by: DVec3| cubes.enter(pair, inverse * by, 1.1e-5);
    check_legs(&placed, &answer, tally, enters)
}

/// Examines a cube in a box whose roof has a square hole.
fn holes(random: &mut Random, pose: Pose, tally: &mut Tally) -> Result<(), String> {
    let block = |low: [f64; 3], high: [f64; 3]| {
        ConvexPolyhedron::cuboid(DVec3::from(low), DVec3::from(high)).map_err(|e| e.to_string())
    };
    let [a, b, c] = [0, 1, 2].map(|_| 1.5 + 3.0 * random.unit());
    let hole = 0.7 + 0.6 * random.unit();
    let [x, y] = [a, b].map(|wide| 0.1 + (wide - hole - 0.2) * random.unit());
    let walls = [
        block([-1.0, -1.0, -1.0], [a + 1.0, b + 1.0, 0.0])?,
        block([-1.0, -1.0, 0.0], [0.0, b + 1.0, c])?,
        block([a, -1.0, 0.0], [a + 1.0, b + 1.0, c])?,
        block([0.0, -1.0, 0.0], [a, 0.0, c])?,
        block([0.0, b, 0.0], [a, b + 1.0, c])?,
        block([-1.0, -1.0, c], [x, b + 1.0, c + 1.0])?,
        block([x + hole, -1.0, c], [a + 1.0, b + 1.0, c + 1.0])?,
        block([x, -1.0, c], [x + hole, y, c + 1.0])?,
        block([x, y + hole, c], [x + hole, b + 1.0, c + 1.0])?,
    ];
    let walls = Solid::from_pieces(&walls).map_err(|e| e.to_string())?;
    let at = DVec3::new(a - 1.0, b - 1.0, c - 1.0) * DVec3::splat(random.unit());
    let cube = block(at.to_array(), (at + 1.0).to_array())?;
    let cube = Solid::from_pieces([&cube]).map_err(|e| e.to_string())?;
    let placed = [cube.at(pose), walls.at(pose)];
    let options = RemovalOptions::default().with_tolerance(1e-5).with_places(200);
    let answer =
        RemovalSearch::search_among(&placed, &[1], &options, None).map_err(|e| e.to_string())?;
    match &answer {
        RemovalSearch::Found(_) if hole < 1.0 - 1e-5 => return Err(format!("through {hole}")),
        RemovalSearch::Proven(_) if hole > 1.0 => return Err(format!("none through {hole}")),
        _ => (),
    }
    let overlap = |[i, j]: [usize; 2], by: DVec3| {
        let moved = pose.translated_by(by).expect("a place");
        let cast = Cast::new(placed[i].body.at(moved), placed[j], DVec3::Z);
        cast.and_then(|cast| cast.with_tolerance(1e-5)).is_ok_and(|cast| cast.overlaps())
    };
    check_legs(&placed, &answer, tally, overlap)
}

/// Verifies the proof, and checks 201 positions of each leg.
fn check_legs(
    placed: &[Placed<'_, Solid>],
    answer: &RemovalSearch,
    tally: &mut Tally,
    enters: impl Fn([usize; 2], DVec3) -> bool,
) -> Result<(), String> {
    let way = match answer {
        RemovalSearch::Found(way) => way,
        RemovalSearch::Proven(proof) => {
            tally.count("proven");
            return proof.verify(&placed[0], &placed[1]).map_err(|e| e.to_string());
        }
        RemovalSearch::NotFound { .. } => {
            tally.count("open");
            return Ok(());
        }
    };
    way.verify(placed).map_err(|e| e.to_string())?;
    tally.count("found");
    tally.add("legs", way.legs.len() as u64);
    tally.largest("most legs", way.legs.len() as f64);
    if let Some(entered) = first_overlap(way, placed.len(), &enters, tally) {
        return Err(entered);
    }
    check_extended_leg(placed, way, &enters, tally)
}

/// Returns a description of the first overlap on a path; `None` if there is none.
fn first_overlap(
    way: &RemovalPath,
    bodies: usize,
    enters: &impl Fn([usize; 2], DVec3) -> bool,
    tally: &mut Tally,
) -> Option<String> {
    let mut at = vec![DVec3::ZERO; bodies];
    for (k, leg) in way.legs.iter().enumerate() {
        // The last leg is checked up to a length beyond the extent of all bodies.
        let motion = if k + 1 == way.legs.len() { leg.direction * 20.0 } else { leg.motion };
        for proof in &leg.proofs {
            let [i, j] = proof.bodies;
            for place in 0..=PLACES {
                let by = at[i] - at[j] + motion * (f64::from(place) / f64::from(PLACES));
                tally.count("places");
                if enters([i, j], by) {
                    return Some(format!("leg {k}: {i} enters {j} at place {place}"));
                }
            }
        }
        for &body in &leg.bodies {
            at[body] += leg.motion;
        }
    }
    None
}

/// Checks that a leg which is extended beyond its proof is rejected, or that the extended leg has no overlap.
fn check_extended_leg(
    placed: &[Placed<'_, Solid>],
    way: &RemovalPath,
    enters: &impl Fn([usize; 2], DVec3) -> bool,
    tally: &mut Tally,
) -> Result<(), String> {
    for k in 0..way.legs.len() - 1 {
        let mut longer = way.clone();
        let leg = &mut longer.legs[k];
        leg.motion *= 1.5;
        leg.travel = leg.motion.length();
        leg.direction = leg.motion.normalize();
        if longer.verify(placed).is_err() {
            tally.count("refused");
        } else if let Some(entered) = first_overlap(&longer, placed.len(), enters, tally) {
            return Err(format!("leg {k}, made longer, is accepted, but {entered}"));
        }
    }
    Ok(())
}
