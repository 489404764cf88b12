//! Draws convex bodies that rotate with little play: pairs in long screw motions, and arms near contact.
//!
//! Each setting has a play of 1e-2 to 1e-9 between bodies of size 1, for 1 to 100 turns. A separating plane is
//! therefore valid for short times only, so a search through time steps has steps of the order of the root of
//! the play.

use std::f64::consts::TAU;

use colltrans::motion::path::{Frame, Joint};
use colltrans::motion::{Motion, MotionCast, MotionOutcome};
use colltrans::{ConvexPolyhedron, MIN_MAGNITUDE, Pair, Pose};
use glam::{DQuat, DVec3};

use crate::oracle::check::Objection;
use crate::oracle::path::{Arm, Body};
use crate::random::Random;
use crate::shapes::{prism, random_hull};

/// The kinds of screw motions.
pub const KINDS: [&str; 8] = [
    "one rigid motion",
    "one spin, sliding along the axis",
    "a pin beside a wall",
    "pins on parallel axes",
    "pins of one spin on parallel axes",
    "pins on crossing axes",
    "hulls of one spin on parallel axes",
    "one above the other",
];

/// The plays.
const PLAYS: [f64; 8] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];

/// The numbers of turns.
const TURNS: [f64; 6] = [1.0, 3.0, 10.0, 30.0, 50.0, 100.0];

/// Number of times before a contact at which answers are checked.
const SAMPLES: u32 = 40;

/// Two convex bodies that rotate with little play.
#[derive(Debug, Clone)]
pub struct Screw {
    /// The moving and the fixed body.
    pub bodies: [ConvexPolyhedron; 2],
    /// Their motions.
    pub motions: [Motion; 2],
    /// The play at the start of the motion.
    pub play: f64,
    /// The number of turns of the moving body.
    pub turns: f64,
}

/// Draws a pin of radius 0.5 along z.
fn draw_pin(random: &mut Random) -> ConvexPolyhedron {
    let sides = random.pick(&[12, 30, 48, 64]);
    let mesh = prism(sides, 1.0).mapped(|v| v * DVec3::new(0.5, 0.5, 1.0));
    ConvexPolyhedron::from_points(&mesh.vertices).expect("a pin")
}

/// Returns the unit cube centred at the origin.
fn cube() -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)).expect("a cube")
}

impl Screw {
    /// Draws a setting of a kind.
    ///
    /// # Panics
    /// Never, because all numbers yield valid bodies and motions.
    pub fn random(kind: usize, seed: u64) -> Self {
        let mut random = Random::stream(seed, &[0x5c_4e77, kind as u64]);
        let (play, turns) = (random.pick(&PLAYS), random.pick(&TURNS));
        let angle = TAU * turns * random.pick(&[-1.0, 1.0]);
        let (rise, q) = (random.range(-1.0, 1.0), random.rotation());
        let place = Pose::new(q, random.vector()).expect("a pose");
        // Poses and axes are given in the frame of `place`.
        let pose =
            |t: DVec3, turn: DQuat| Pose::new(q * turn, place.transform_point(t)).expect("a pose");
        let screw = |start: Pose, point: DVec3, axis: DVec3, angle: f64, rise: f64| {
            Motion::screw(start, place.transform_point(point), q * axis, angle, rise)
                .expect("a motion")
        };
        let none = DQuat::IDENTITY;
        let ratio = random.pick(&[-3.0, -1.0, -0.5, 0.3, 2.0]);
        let beside = DVec3::new(1.0 + play, 0.0, 0.0);
        let (bodies, motions) = match KINDS[kind] {
            "one rigid motion" | "one spin, sliding along the axis" => {
                let starts = [pose(DVec3::ZERO, none), pose(beside + DVec3::Z * 0.2, none)];
                let along = kind == 1;
                let axis = if along { DVec3::Z } else { random.direction() };
                let point = random.vector();
                let rises = [rise, if along { 0.3 * rise } else { rise }];
                let motions = [0, 1].map(|k| screw(starts[k], point, axis, angle, rises[k]));
                ([cube(), cube()], motions)
            }
            "a pin beside a wall" => {
                let turned = screw(pose(DVec3::ZERO, none), DVec3::ZERO, DVec3::Z, angle, rise);
                ([draw_pin(&mut random), cube()], [turned, Motion::at_rest(pose(beside, none))])
            }
            "pins on parallel axes" | "pins of one spin on parallel axes" => {
                let other = if kind == 4 { angle } else { angle * ratio };
                let first = screw(pose(DVec3::ZERO, none), DVec3::ZERO, DVec3::Z, angle, rise);
                let second = screw(pose(beside, none), beside, DVec3::Z, other, -rise);
                ([draw_pin(&mut random), draw_pin(&mut random)], [first, second])
            }
            "pins on crossing axes" => {
                let turn = DQuat::from_rotation_x(random.range(0.2, 2.9));
                let axis = turn * DVec3::Z;
                let first = screw(pose(DVec3::ZERO, none), DVec3::ZERO, DVec3::Z, angle, 0.0);
                let second = screw(pose(beside, turn), beside, axis, angle * ratio, 0.0);
                ([draw_pin(&mut random), draw_pin(&mut random)], [first, second])
            }
            "hulls of one spin on parallel axes" => {
                let hulls = [(); 2].map(|()| {
                    let points = random_hull(12, &mut random).vertices;
                    ConvexPolyhedron::from_points(&points).expect("a body")
                });
                let most = |body: &ConvexPolyhedron, sign: f64| {
                    body.vertices().iter().map(|v| sign * v.x).fold(f64::NEG_INFINITY, f64::max)
                };
                let way = DVec3::X * (most(&hulls[0], 1.0) + most(&hulls[1], -1.0) + play);
                let first = screw(pose(DVec3::ZERO, none), DVec3::ZERO, DVec3::Z, angle, rise);
                let second = screw(pose(way, none), way, DVec3::Z, angle, rise);
                (hulls, [first, second])
            }
            _ => {
                let above = DVec3::Z * (1.5 + play);
                let first = screw(pose(DVec3::ZERO, none), DVec3::ZERO, DVec3::Z, angle, rise);
                let second = screw(pose(above, none), DVec3::ZERO, DVec3::Z, angle * ratio, rise);
                ([draw_pin(&mut random), cube()], [first, second])
            }
        };
        Self { bodies, motions, play, turns }
    }

    /// Computes the first contact, verifies the proof, and checks times before the contact.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn judge(&self) -> Result<MotionOutcome, Objection> {
        let object = |what: &dyn std::fmt::Display| Objection(what.to_string());
        let [p, q] = &self.bodies;
        let cast =
            MotionCast::new(p.with_motion(&self.motions[0]), q.with_motion(&self.motions[1]));
        let cast = cast.map_err(|e| object(&e))?;
        let outcome = cast.first_contact().map_err(|e| object(&e))?;
        let proven = cast.verify(outcome.proof()).map_err(|e| object(&e))?;
        let said = match &outcome {
            MotionOutcome::Contact(of)
            | MotionOutcome::Grazing(of)
            | MotionOutcome::Overlapping(of)
            | MotionOutcome::Undecided(of) => [of.lower, of.upper],
            _ => [1.0, f64::INFINITY],
        };
        if said != proven {
            return Err(Objection(format!("reported {said:?}, proven {proven:?}")));
        }
        for k in 0..SAMPLES {
            let time = said[0] * f64::from(k) / f64::from(SAMPLES);
            let [Ok(a), Ok(b)] = self.motions.each_ref().map(|motion| motion.pose_at(time)) else {
                continue;
            };
            let pair = Pair::new(p.at(a), q.at(b)).map_err(|e| object(&e))?;
            let deep = pair.depth().map_or(0.0, |depth| depth.lower);
            // Poses in the world are rounded.
            if deep > 1e-13 + MIN_MAGNITUDE && said[1] > 0.0 {
                return Err(Objection(format!("{deep:e} deep at {time}, before {}", said[0])));
            }
        }
        Ok(outcome)
    }
}

/// Draws an arm of one to seven joints about parallel axes, whose last link slides above a table with little
/// play.
///
/// # Panics
/// Never, because all numbers yield a valid arm.
pub fn slider(seed: u64) -> Arm {
    let mut random = Random::stream(seed, &[0x511d_e400]);
    let (play, most) = (random.pick(&PLAYS), random.pick(&[0.3, 1.0, 3.0, 6.0]));
    let count = 1 + random.index(7);
    let frames = (0..count)
        .map(|k| {
            let reach = DVec3::new(random.range(0.2, 1.0), random.range(-0.5, 0.5), 0.0);
            let origin = Pose::from_translation(if k == 0 { DVec3::ZERO } else { reach });
            let joint = Joint::Turning(DVec3::Z);
            Frame { parent: k.checked_sub(1), origin: origin.expect("a pose"), joint }
        })
        .collect();
    let row: Vec<f64> = (0..count).map(|_| random.range(-1.0, 1.0)).collect();
    let next = row.iter().map(|value| value + random.range(-most, most)).collect();
    let points = random_hull(16, &mut random).vertices;
    let lowest = points.iter().map(|v| v.z).fold(f64::INFINITY, f64::min);
    let hull = ConvexPolyhedron::from_points(&points).expect("a body");
    let pin = draw_pin(&mut random);
    let (link, low) = if random.one_in(2) { (hull, lowest) } else { (pin, -1.0) };
    let top = low - play;
    let table =
        ConvexPolyhedron::cuboid(DVec3::new(-9.0, -9.0, top - 1.0), DVec3::new(9.0, 9.0, top))
            .expect("a table");
    // The setting is rotated, so that nothing is parallel to an axis of the world.
    let slant = Pose::new(random.rotation(), random.vector()).expect("a pose");
    let base = Frame { parent: None, origin: slant, joint: Joint::Fixed };
    let shifted = |frame: Frame| Frame { parent: Some(frame.parent.map_or(0, |k| k + 1)), ..frame };
    let frames: Vec<Frame> = frames;
    let frames = [base].into_iter().chain(frames.into_iter().map(shifted)).collect();
    Arm {
        frames,
        rows: vec![row, next],
        bodies: vec![
            (Some(count), Body::Convex(link), Pose::IDENTITY),
            (None, Body::Convex(table), slant),
        ],
        pairs: vec![[0, 1]],
        min_gap: 0.0,
    }
}

/// Draws an arm near contact. Its last joint rotates a pin next to a plate by many turns. The other joints
/// rest, or move if the plate is attached to the frame before. The play is between pin and plate.
///
/// # Panics
/// Never, because all numbers yield a valid arm.
pub fn chain(seed: u64) -> Arm {
    let mut random = Random::stream(seed, &[0x00c4_a125]);
    let (play, turns) = (random.pick(&PLAYS), random.pick(&[0.1, 0.5, 1.0, 3.0]));
    let count = 1 + random.index(6);
    let mut frames: Vec<Frame> = (0..count)
        .map(|k| {
            let axis = random.direction();
            let joint = if random.one_in(4) { Joint::Sliding(axis) } else { Joint::Turning(axis) };
            let origin = Pose::new(random.rotation(), random.vector()).expect("a pose");
            Frame { parent: k.checked_sub(1), origin, joint }
        })
        .collect();
    let last = frames.len();
    let origin = Pose::new(random.rotation(), random.vector()).expect("a pose");
    frames.push(Frame { parent: last.checked_sub(1), origin, joint: Joint::Turning(DVec3::Z) });
    // The pose of the plate is given in the frame before the last one, to which the origin of the last one
    // refers.
    let carried = random.one_in(2);
    let plate =
        ConvexPolyhedron::cuboid(DVec3::new(0.5 + play, -1.0, -1.5), DVec3::new(0.8, 1.0, 1.5))
            .expect("a plate");
    let first: Vec<f64> = (0..=last).map(|_| random.range(-1.0, 1.0)).collect();
    let mut second = first.clone();
    second[last] += TAU * turns;
    if carried {
        second[..last].iter_mut().for_each(|value| *value += random.range(-1.0, 1.0));
    }
    let pin = Body::Convex(draw_pin(&mut random));
    let mut arm = Arm {
        frames,
        rows: vec![first, second],
        bodies: vec![(Some(last), pin, Pose::IDENTITY)],
        pairs: vec![[0, 1]],
        min_gap: 0.0,
    };
    let (frame, pose) = if carried {
        (Some(last - 1), origin)
    } else {
        let start = arm.places(colltrans::motion::path::PathPlace { row: 0, share: 0.0 })[last - 1];
        let there =
            start * glam::DAffine3::from_mat3_translation(origin.matrix(), origin.translation());
        (None, Pose::from_matrix(there.matrix3, there.translation).expect("a pose"))
    };
    arm.bodies.push((frame, Body::Convex(plate), pose));
    arm
}
