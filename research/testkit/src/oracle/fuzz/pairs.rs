//! Fuzz targets of queries without a direction, casts with a minimum gap, rounded bodies, and scene queries.
//!
//! Bytes are read as for casts: the conversion of numbers, a byte (bits 0 and 1 select the rotated bodies, bit
//! 2 selects solids), the bodies, their poses, and the parameters of the query.

use colltrans::solid::SolidCast;
use colltrans::{AnyBody, Cast, ObstacleId, Obstacles, Pair, Pose, SceneQuery, Tracker};
use glam::{DQuat, DVec3};

use super::{MOST_JUDGED, Reader, read_setting, read_solid};
use crate::oracle::settings::{Bodies, Setting};
use crate::oracle::solids::{min_gap as solid_gap, nearest as solids};
use crate::oracle::{among, min_gap as convex_gap, nearest, rounded as rounded_judge};
use crate::tally::Tally;

/// Maximum number of pairs of facets that are judged in rational arithmetic. More pairs would only slow down a
/// run.
const MOST_PAIRS: usize = 600;
/// Maximum number of vertices of both bodies for which a depth is compared with the exact one.
const MOST_COMPARED: usize = 12;
/// Maximum number of changes of a scene.
const MOST_CHANGES: usize = 12;

/// Two placed bodies.
enum Read {
    Convex(Box<(Setting, Bodies)>),
    Solids(Box<solids::Setting>),
}

/// Reads two placed bodies; `None` if they are invalid.
fn read_bodies(reader: &mut Reader) -> Option<Read> {
    let turned = reader.clone().byte();
    if turned & 4 == 0 {
        return read_setting(reader).map(|setting| Read::Convex(Box::new(setting)));
    }
    reader.byte();
    let solids = [read_solid(reader)?, read_solid(reader)?];
    if solids[0].triangles().len() * solids[1].triangles().len() > MOST_PAIRS {
        return None;
    }
    let poses = [read_pose(reader, turned & 1 == 1)?, read_pose(reader, turned & 2 == 2)?];
    Some(Read::Solids(Box::new(solids::Setting { solids, poses })))
}

/// Reads a pose; `None` if it is out of range.
fn read_pose(reader: &mut Reader, is_turned: bool) -> Option<Pose> {
    let rotation = if is_turned { reader.rotation() } else { DQuat::IDENTITY };
    Pose::new(rotation, reader.vector()).ok()
}

/// Builds the pair of a setting.
fn build_pair<'a>(setting: &Setting, bodies: &'a Bodies) -> Pair<'a> {
    let [p, q] = [bodies.moving.at(setting.moving_pose), bodies.fixed.at(setting.fixed_pose)];
    Pair::new(p, q).expect("any two placed bodies are a pair")
}

/// Checks that the distance of two bodies is between its bounds, and that its proofs are valid and prove no
/// more. For solids, also checks whether they are within some lengths.
///
/// # Panics
/// If an answer is wrong.
pub fn distance(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    match read_bodies(&mut reader) {
        None => {}
        Some(Read::Solids(setting)) => {
            setting.examine().unwrap_or_else(|e| panic!("{e}"));
        }
        Some(Read::Convex(of)) => {
            let pair = build_pair(&of.0, &of.1);
            let answer = pair.distance().unwrap_or_else(|e| panic!("{e}"));
            nearest::DistanceJudge::new(pair).check(&answer).unwrap_or_else(|e| panic!("{e}"));
        }
    }
}

/// Checks that the depth of two convex bodies is between its bounds, with proofs.
///
/// # Panics
/// If an answer is wrong.
pub fn depth(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let Some((setting, bodies)) = read_setting(&mut reader) else { return };
    let pair = build_pair(&setting, &bodies);
    let depth = pair.depth().unwrap_or_else(|e| panic!("{e}"));
    let judge = nearest::DistanceJudge::new(pair);
    judge.check_depth(&depth).unwrap_or_else(|e| panic!("{e}"));
    let vertices = bodies.moving.vertices().len() + bodies.fixed.vertices().len();
    if judge.truth.intersects() && vertices <= MOST_COMPARED {
        judge.compare_depth(&depth).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Checks whether two convex bodies are within lengths from the bytes and around the exact distance.
///
/// # Panics
/// If an answer is wrong.
pub fn within(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let Some((setting, bodies)) = read_setting(&mut reader) else { return };
    let pair = build_pair(&setting, &bodies);
    let judge = nearest::DistanceJudge::new(pair);
    let truth = judge.truth.to_f64();
    let lengths = [truth, truth.next_up(), truth.next_down(), truth + 4.0 * judge.noise];
    for length in lengths.into_iter().chain([reader.number(), truth * reader.number()]) {
        if !(0.0..f64::INFINITY).contains(&length) {
            assert!(length.is_infinite() || pair.within(length).is_err(), "{length}: no length");
            continue;
        }
        let answer = pair.within(length).unwrap_or_else(|e| panic!("{length:e}: {e}"));
        judge.check_within(length, &answer).unwrap_or_else(|e| panic!("{length:e}: {e}"));
    }
}

/// Checks that a cast with a minimum gap is rejected, or that its answers are approved in exact arithmetic.
///
/// # Panics
/// If an answer is wrong.
pub fn min_gap(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    match read_bodies(&mut reader) {
        None => {}
        Some(Read::Solids(of)) => {
            let gap = f64::from(reader.byte()) / 16.0 + 1.0 / 64.0;
            let ([a, b], [p, q]) = (&of.solids, of.poses);
            let cast = Cast::new(a.at(p), b.at(q), reader.vector());
            let cast = cast.and_then(|cast| cast.with_tolerance(0.0)?.with_min_gap(gap));
            // Bodies that are much larger than the gap are covered by other judges.
            if let Ok(cast) = cast
                && gap > 1e-6 * of.reach()
            {
                solid_gap::judge(&cast).unwrap_or_else(|e| panic!("gap {gap}: {e}"));
            }
        }
        Some(Read::Convex(of)) => {
            let gap = reader.number().abs() / 16.0;
            let Ok(cast) = of.0.query(&of.1).and_then(|cast| cast.with_min_gap(gap)) else {
                return;
            };
            let judge = convex_gap::GapJudge::new(cast);
            let outcome = cast.first_contact().unwrap_or_else(|e| panic!("gap {gap:e}: {e}"));
            judge.check(&outcome).unwrap_or_else(|e| panic!("gap {gap:e}: {e}"));
            let clearance = cast.clearance().unwrap_or_else(|e| panic!("gap {gap:e}: {e}"));
            judge.check_clearance(&clearance).unwrap_or_else(|e| panic!("gap {gap:e}: {e}"));
        }
    }
}

/// Checks all answers about two convex bodies with radii from the bytes: see [`rounded_judge::judge_all`].
///
/// # Panics
/// If an answer is wrong, or a search ends without one.
pub fn rounded(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let Some((setting, bodies)) = read_setting(&mut reader) else { return };
    let vertices = bodies.moving.vertices().len() + bodies.fixed.vertices().len();
    let mut read_length = || reader.number().abs() / 16.0;
    let [r, s] = [read_length(), read_length()];
    let (Ok(moving), Ok(fixed)) = (bodies.moving.rounded(r), bodies.fixed.rounded(s)) else {
        return;
    };
    let bodies = Bodies { moving, fixed };
    let (gap, length) = (read_length(), read_length());
    let Ok(cast) = setting.query(&bodies).and_then(|cast| cast.with_min_gap(gap)) else { return };
    let mut tracker = Tracker::new();
    let length = if length.is_finite() { length } else { 0.0 };
    let answers = rounded_judge::judge_all(&cast, &mut tracker, length, vertices <= MOST_COMPARED);
    let answers = answers.unwrap_or_else(|e| panic!("radii {r:e} and {s:e}, gap {gap:e}: {e}"));
    assert!(answers.is_some(), "radii {r:e} and {s:e}, gap {gap:e}: no answer");
}

/// Checks that a scene query after insertions, moves and removals gives the answers of queries of each
/// obstacle.
///
/// # Panics
/// If an answer is wrong.
pub fn among(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let mut bodies: Vec<AnyBody> = Vec::new();
    for _ in 0..=reader.byte() % 3 {
        let solid = reader.byte() % 4 == 3;
        if solid {
            let Some(solid) = read_solid(&mut reader) else { return };
            if solid.triangles().len() > MOST_PAIRS / 24 {
                return;
            }
            bodies.push(solid.into());
        } else {
            let points = reader.points(MOST_JUDGED);
            let Ok(body) = colltrans::ConvexPolyhedron::from_points(&points) else { return };
            bodies.push(body.into());
        }
    }
    let Some(obstacles) = read_scene(&mut reader, &bodies) else { return };
    let moving = bodies[usize::from(reader.byte()) % bodies.len()].clone();
    let Some(pose) = read_pose(&mut reader, true) else { return };
    let (direction, length) = (reader.vector(), reader.number().abs());
    let is_asked = direction.is_finite() && direction != DVec3::ZERO && length.is_finite();
    // Points and segments are not solids, so a scene with both is rejected.
    let refused = SceneQuery::new(moving.at(pose), &obstacles).is_err();
    if is_asked && !refused && (1e-9..1e9).contains(&direction.length()) {
        among::Setting::of(obstacles, moving, pose, direction, length)
            .examine(&mut Tally::default())
            .unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Reads a sequence of insertions, moves and removals; `None` if a pose is invalid.
fn read_scene(reader: &mut Reader, bodies: &[AnyBody]) -> Option<Obstacles> {
    let mut obstacles = Obstacles::new();
    let mut ids: Vec<ObstacleId> = Vec::new();
    for _ in 0..usize::from(reader.byte()) % (MOST_CHANGES + 1) {
        let kind = reader.byte();
        let which = usize::from(kind / 8);
        match kind % 8 {
            0 if !ids.is_empty() => {
                let id = ids.remove(which % ids.len());
                assert!(obstacles.remove(id).is_some(), "{id} is gone already");
            }
            1 | 2 if !ids.is_empty() => {
                let pose = read_pose(reader, kind % 8 == 2)?;
                obstacles.set_pose(ids[which % ids.len()], pose).expect("it is there");
            }
            _ => {
                let pose = read_pose(reader, kind % 8 == 3)?;
                ids.push(obstacles.insert(bodies[which % bodies.len()].clone(), pose));
            }
        }
    }
    Some(obstacles)
}
