//! Unscrewing motions of threaded parts.
//!
//! A step removes a screw as its core, which casts prove. This module constructs the turn that a mechanic makes and
//! tries to prove it. The screw, with the geometry of the file, follows its helix until its thread has left the hole,
//! and then moves straight, against all remaining parts. If the threads of the file overlap, the motion starts from
//! the pose of least overlap. A motion that is not proven is reported with the reason.
//!
//! Notation: turns of a leg along `d` are about `d`, and counter-clockwise if seen against `d`.

use colltrans::motion::Motion;
use colltrans::{Bounded, QueryError};
use glam::DVec3;

use super::step::{Leg, Turn, TurnProof};
use crate::bodies::{Bodies, ScrewOutcome, two_digits_up};
use crate::threads::{Seat, Thread};
use colltrans::solid::StartOverlap;

/// Maximum angle between a step and the axis of a thread, in radians.
const MAX_STEP_ANGLE: f64 = 0.02;
/// Angle below which the direction of the step replaces the axis, in radians.
const SAME_AXIS: f64 = 1e-3;
/// Two threads turn together if their axes are nearly parallel ([`MAX_STEP_ANGLE`]) and less than this fraction of the
/// crest radius apart, and their pitches differ by less than this fraction.
const SAME_HELIX: f64 = 0.02;
/// Maximum tolerance that is tried, as a fraction of the thread's depth. A tolerance given for the pair is never
/// exceeded.
const MAX_TOLERANCE: f64 = 0.25;
/// First tolerance that is tried after that of all parts, as a fraction of the thread's depth.
const FIRST_TOLERANCE: f64 = 0.02;
/// Factor by which a tolerance exceeds the least possible one.
const TOLERANCE_FACTOR: f64 = 1.05;

/// Returns the two legs of a step that unscrews some parts from others, and the travel of the second leg.
///
/// The first leg turns, the second is straight. `others` are the parts that remain, and `present` is their mask.
/// `travel` is the total distance. With `is_last` the parts then move on forever, otherwise another move follows.
/// Returns `None` if no thread connects the parts, if no helix was found, or if the parts would not leave the thread.
pub(super) fn unscrewing_legs(
    bodies: &Bodies,
    (parts, direction): (&[usize], DVec3),
    (others, present): (&[usize], &[bool]),
    (travel, is_last): (Bounded, bool),
    start: StartOverlap,
) -> Option<([Leg; 2], Bounded)> {
    let threads = threads_along(bodies, parts, present, direction);
    let mut screw = ScrewMotion::new(bodies, *threads.first()?, direction)?;
    if !is_last {
        if screw.way > travel.value {
            return None;
        }
        screw.end = Some(travel.value - screw.way);
    }
    let one = threads.iter().all(|(_, thread)| screw.has_same_helix(thread));
    let mut turning = screw.unproven_leg(parts);
    let proof = if one {
        screw.prove_turn(bodies, &turning, others, &threads, start)
    } else {
        Err("several threads with different helices would have to turn simultaneously".into())
    };
    if let Some(turn) = &mut turning.turn {
        turn.proof = proof;
    }
    let way = screw.way;
    let rest = Bounded {
        value: (travel.value - way).max(0.0),
        lower: (travel.lower - way).next_down().max(0.0),
        upper: (travel.upper - way).next_up().max(0.0),
    };
    let legs = [turning, Leg::straight(parts.to_vec(), direction, rest.value)];
    Some((legs, rest))
}

/// Returns the threads with a helix between moving parts and present ones whose axes are along the direction, in
/// either sense. The first part of each pair moves.
fn threads_along(
    bodies: &Bodies,
    parts: &[usize],
    present: &[bool],
    d: DVec3,
) -> Vec<([usize; 2], Thread)> {
    let pairs = bodies.present_partners(parts, present);
    let along = |thread: &Thread| {
        thread.pitch.is_some() && thread.axis[1].cross(d).length() < MAX_STEP_ANGLE
    };
    let found = pairs.filter_map(|pair| Some((pair, bodies.pair_thread(pair).filter(along)?)));
    found.collect()
}

/// The screw motion of parts that are unscrewed.
struct ScrewMotion {
    /// The thread, and whether the moving part has the external thread.
    thread: Thread,
    is_inner: bool,
    seat: Seat,
    /// A point on the axis of the stationary part, and the axis, which points along the motion.
    point: DVec3,
    axis: DVec3,
    way: f64,
    turns: f64,
    /// Distance along the axis after the turn, if another move follows.
    end: Option<f64>,
}

impl ScrewMotion {
    fn new(bodies: &Bodies, (pair, thread): ([usize; 2], Thread), d: DVec3) -> Option<Self> {
        let seat = bodies.screw_seat(pair, &thread)?;
        let is_second = pair[0] > pair[1];
        let is_inner = (thread.screw == 1) == is_second;
        let (sense, mut axis) = axis_along(&thread, d);
        if axis.cross(d).length() < SAME_AXIS {
            axis = d;
        }
        // A moving hole takes the opposite direction of a moving screw.
        let way = seat.exit_travels[usize::from((sense < 0.0) == is_inner)];
        let point = thread.axis[0] + if is_inner { seat.lateral_offset } else { DVec3::ZERO };
        let turns = way / thread.pitch?;
        Some(Self { thread, is_inner, seat, point, axis, way, turns, end: None })
    }

    /// Returns the sense of the motion along the thread's axis, 1 or -1 (reversed if the hole moves), and the axis
    /// along the motion.
    fn turn_sense(&self) -> (f64, DVec3) {
        let (sense, axis) = axis_along(&self.thread, self.axis);
        (if self.is_inner { sense } else { -sense }, axis)
    }

    fn has_same_helix(&self, other: &Thread) -> bool {
        let [point, axis] = other.axis;
        let off = (point - self.thread.axis[0]).reject_from(self.axis).length();
        let radius = self.thread.radii[1];
        let [a, b] = [self.thread.pitch, other.pitch].map(|pitch| pitch.unwrap_or(0.0));
        axis.cross(self.axis).length() < MAX_STEP_ANGLE
            && off < SAME_HELIX * radius
            && (a - b).abs() < SAME_HELIX * a.abs()
    }

    /// Returns the leg along the helix, from the pose in which the screw fits best. Its proof is still missing.
    fn unproven_leg(&self, parts: &[usize]) -> Leg {
        let (sense, _) = self.turn_sense();
        let turn = Turn {
            point: self.point,
            turns: self.turns,
            // Adding 0 removes the sign of zeros.
            initial_turns: sense * self.seat.phase + 0.0,
            offset: self.seat.lateral_offset * if self.is_inner { 1.0 } else { -1.0 } + DVec3::ZERO,
            proof: Err(String::new()),
        };
        let (parts, direction) = (parts.to_vec(), self.axis);
        Leg { parts, direction, travel: self.way, turn: Some(turn) }
    }

    /// Tries to prove the turning leg and the straight motion after it, against the parts `others`. Returns the
    /// tolerance of the thread that this needs with the number of node pairs that were visited, or the reason of the
    /// failure.
    fn prove_turn(
        &self,
        bodies: &Bodies,
        leg: &Leg,
        others: &[usize],
        threads: &[([usize; 2], Thread)],
        start: StartOverlap,
    ) -> Result<TurnProof, String> {
        let name = |part: usize| bodies.assembly().parts()[part].name();
        let ([moving, staying], _) = threads[0];
        let [screw, nut] = if self.is_inner { [moving, staying] } else { [staying, moving] };
        if !self.seat.threaded {
            return Err(format!(
                "the hole of {} has no thread and is narrower than the thread of {}",
                name(nut),
                name(screw)
            ));
        }
        let motion = leg.to_motion().map_err(|error| error.to_string())?;
        let (mut tolerance, mut pairs) = (0.0_f64, 0);
        for (pair, _) in threads {
            let (used, more) = self.find_tolerance(bodies, *pair, &motion)?;
            (tolerance, pairs) = (tolerance.max(used), pairs + more);
        }
        let is_thread = |pair: [usize; 2]| threads.iter().any(|(known, _)| *known == pair);
        for pair in leg.parts.iter().flat_map(|&a| others.iter().map(move |&b| [a, b])) {
            if is_thread(pair)
                || bodies.disregards_other_contacts(pair, start)
                || !bodies.may_meet_turning(pair, [self.point, self.axis])
            {
                continue;
            }
            let [part, other] = pair.map(name);
            let along = (&motion, self.axis, self.end);
            match bodies.screw_outcome(pair, along, None).map_err(|error| error.to_string())? {
                ScrewOutcome::Free(more) => pairs += more,
                ScrewOutcome::Overlapping(_) => {
                    return Err(format!("{part} and {other} overlap at the start of the motion"));
                }
                ScrewOutcome::Blocked(share) => {
                    return Err(self.contact_message(share, part, other));
                }
            }
        }
        Ok(TurnProof { tolerance, pairs })
    }

    fn contact_message(&self, share: f64, part: &str, other: &str) -> String {
        let turns = share * self.turns.abs();
        if share >= 1.0 {
            format!("after the thread has left the hole, {part} collides with {other}")
        } else {
            format!("after {turns:.2} turns facets of {part} and {other} collide")
        }
    }

    /// Searches for a tolerance with which a thread turns freely. Returns it with the number of node pairs that were
    /// visited, or the reason of the failure.
    fn find_tolerance(
        &self,
        bodies: &Bodies,
        pair: [usize; 2],
        motion: &Motion,
    ) -> Result<(f64, u64), String> {
        let depth = self.thread.radii[1] - self.thread.radii[0];
        let given = bodies.assembly().pair_fit(pair[0], pair[1]).and_then(|fit| fit.tolerance);
        let mut tolerance = given.unwrap_or_else(|| bodies.fit().tolerance().max(0.0));
        let most = given.unwrap_or(MAX_TOLERANCE * depth).max(tolerance);
        let names = pair.map(|part| bodies.assembly().parts()[part].name());
        let refused = |error: QueryError| error.to_string();
        loop {
            let along = (motion, self.axis, self.end);
            let (least, why) =
                match bodies.screw_outcome(pair, along, Some(tolerance)).map_err(refused)? {
                    ScrewOutcome::Free(pairs) => return Ok((tolerance, pairs)),
                    ScrewOutcome::Overlapping(least) => {
                        let deep = least.map_or("deeply".into(), |deep| format!("by {deep:.2e}"));
                        let why = format!(
                            "the threads of {} and {} overlap {deep} in any rotation",
                            names[0], names[1]
                        );
                        (least.unwrap_or(f64::INFINITY) * TOLERANCE_FACTOR, why)
                    }
                    ScrewOutcome::Blocked(share) => {
                        (0.0, self.contact_message(share, names[0], names[1]))
                    }
                };
            let next = two_digits_up(least.max(2.0 * tolerance).max(FIRST_TOLERANCE * depth));
            if next > most || tolerance >= most {
                return Err(format!("{why}; the maximum tolerance is {most:.2e}"));
            }
            tolerance = next;
        }
    }
}

/// Returns 1 if a direction is along the axis of the thread and -1 if it is opposite, and the axis along the
/// direction.
fn axis_along(thread: &Thread, d: DVec3) -> (f64, DVec3) {
    let sense = if thread.axis[1].dot(d) < 0.0 { -1.0 } else { 1.0 };
    (sense, thread.axis[1] * sense)
}
