//! Threads are unscrewed.
//!
//! A step pulls a screw out as its core, which is proven by casts. Here the turn that a mechanic makes of it is found and
//! proven: the screw, as the file has it, on its helix, until its thread is out of the hole, and straight on from
//! there, against all that is left. Where the file has the threads in each other, it begins where they overlap least.
//! What cannot be proven is told all the same, with why.
//!
//! Notation: of a leg along `d` turns are counted about `d`, counter-clockwise as seen against it.

use colltrans::motion::Motion;
use colltrans::{Bounded, QueryError};
use glam::DVec3;

use super::step::{Leg, Turn, TurnProof};
use crate::bodies::{Bodies, Turned, two_digits_up};
use crate::threads::{Seat, Thread};
use colltrans::solid::StartOverlap;

/// A step goes along the axis of a thread within this angle, in radians.
const ALONG: f64 = 0.02;
/// It is the axis within this one.
const ONE: f64 = 1e-3;
/// Threads of one turn: their axes within this share of the crest, and pitches within this of each other.
const SAME: f64 = 0.02;
/// No tolerance is tried beyond this share of the depth of a thread, and none that was asked for is exceeded.
const DEEPEST: f64 = 0.25;
/// The first one beside that of all parts, as a share of that depth.
const FIRST: f64 = 0.02;
/// A tolerance beyond the least one.
const BEYOND: f64 = 1.05;

/// The two moves of a step that unscrews some parts from others, which alone are there: turning, and straight on; `None` if
/// nothing is screwed between them, or nothing looks like a helix. `travel` is how far the parts go in all.
pub(super) fn unscrewed(
    bodies: &Bodies,
    (parts, direction): (&[usize], DVec3),
    (others, there): (&[usize], &[bool]),
    travel: Bounded,
    start: StartOverlap,
) -> Option<([Leg; 2], Bounded)> {
    let threads = threads(bodies, parts, there, direction);
    let screw = Screw::new(bodies, *threads.first()?, direction)?;
    let one = threads.iter().all(|(_, thread)| screw.is_one_with(thread));
    let mut turning = screw.leg(parts);
    let proof = if one {
        screw.proven(bodies, &turning, others, &threads, start)
    } else {
        Err("several threads would have to turn at once".into())
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

/// The threads between parts that go and others that are there, about axes along the way: the first part of each pair
/// goes.
fn threads(
    bodies: &Bodies,
    parts: &[usize],
    there: &[bool],
    d: DVec3,
) -> Vec<([usize; 2], Thread)> {
    let pairs = bodies.partners(parts, there);
    let along =
        |thread: &Thread| thread.pitch.is_some() && thread.axis[1].cross(d).length() < ALONG;
    let found = pairs.filter_map(|pair| Some((pair, bodies.thread(pair).filter(along)?)));
    found.collect()
}

/// The motion of parts that are unscrewed.
struct Screw {
    /// The thread, and whether what moves has it on its outside.
    thread: Thread,
    is_inner: bool,
    seat: Seat,
    /// A point on the axis that stays, and the axis, along the way.
    point: DVec3,
    axis: DVec3,
    way: f64,
    turns: f64,
}

impl Screw {
    fn new(bodies: &Bodies, (pair, thread): ([usize; 2], Thread), d: DVec3) -> Option<Self> {
        let seat = bodies.seat(pair, &thread)?;
        let is_second = pair[0] > pair[1];
        let is_inner = (thread.screw == 1) == is_second;
        let (sense, mut axis) = sense(&thread, d);
        if axis.cross(d).length() < ONE {
            axis = d;
        }
        // The hole goes the other way than the screw would.
        let way = seat.ways[usize::from((sense < 0.0) == is_inner)];
        let point = thread.axis[0] + if is_inner { seat.aside } else { DVec3::ZERO };
        let turns = way / thread.pitch?;
        Some(Self { thread, is_inner, seat, point, axis, way, turns })
    }

    /// Whether what moves turns about the axis of the thread or against it, and the same if that is the hole.
    fn sense(&self) -> (f64, DVec3) {
        let (sense, axis) = sense(&self.thread, self.axis);
        (if self.is_inner { sense } else { -sense }, axis)
    }

    fn is_one_with(&self, other: &Thread) -> bool {
        let [point, axis] = other.axis;
        let off = (point - self.thread.axis[0]).reject_from(self.axis).length();
        let radius = self.thread.radii[1];
        let [a, b] = [self.thread.pitch, other.pitch].map(|pitch| pitch.unwrap_or(0.0));
        axis.cross(self.axis).length() < ALONG
            && off < SAME * radius
            && (a - b).abs() < SAME * a.abs()
    }

    /// From where the screw sits best, along its helix; not proven yet.
    fn leg(&self, parts: &[usize]) -> Leg {
        let (sense, _) = self.sense();
        let turn = Turn {
            point: self.point,
            turns: self.turns,
            // Zeros without a sign.
            phase: sense * self.seat.phase + 0.0,
            aside: self.seat.aside * if self.is_inner { 1.0 } else { -1.0 } + DVec3::ZERO,
            proof: Err(String::new()),
        };
        let (parts, direction) = (parts.to_vec(), self.axis);
        Leg { parts, direction, travel: self.way, turn: Some(turn) }
    }

    /// Whether the parts may go so, with the tolerance of the thread that it takes; else why not.
    fn proven(
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
                "the hole of {} has no thread, it is plain and narrower than the thread of {}",
                name(nut),
                name(screw)
            ));
        }
        let motion = leg.motion().map_err(|error| error.to_string())?;
        let (mut tolerance, mut pairs) = (0.0_f64, 0);
        for (pair, _) in threads {
            let (used, more) = self.tolerated(bodies, *pair, &motion)?;
            (tolerance, pairs) = (tolerance.max(used), pairs + more);
        }
        let is_thread = |pair: [usize; 2]| threads.iter().any(|(known, _)| *known == pair);
        for pair in leg.parts.iter().flat_map(|&a| others.iter().map(move |&b| [a, b])) {
            if is_thread(pair)
                || bodies.is_let_pass(pair, start)
                || !bodies.may_meet_turning(pair, [self.point, self.axis])
            {
                continue;
            }
            let [part, other] = pair.map(name);
            let along = (&motion, self.axis);
            match bodies.turned(pair, along, None).map_err(|error| error.to_string())? {
                Turned::Free(more) => pairs += more,
                Turned::Overlapping(_) => {
                    return Err(format!("{part} and {other} overlap where it begins"));
                }
                Turned::Blocked(share) => return Err(self.met(share, part, other)),
            }
        }
        Ok(TurnProof { tolerance, pairs })
    }

    fn met(&self, share: f64, part: &str, other: &str) -> String {
        let turns = share * self.turns.abs();
        if share >= 1.0 {
            format!("once it is unscrewed, {part} meets {other} on its way")
        } else {
            format!("after {turns:.2} turns facets of {part} meet those of {other}")
        }
    }

    /// The tolerance with which a thread turns, and how many pairs were looked at for it.
    fn tolerated(
        &self,
        bodies: &Bodies,
        pair: [usize; 2],
        motion: &Motion,
    ) -> Result<(f64, u64), String> {
        let depth = self.thread.radii[1] - self.thread.radii[0];
        let asked = bodies.assembly().pair(pair[0], pair[1]).and_then(|fit| fit.tolerance);
        let mut tolerance = asked.unwrap_or_else(|| bodies.fit().tolerance().max(0.0));
        let most = asked.unwrap_or(DEEPEST * depth).max(tolerance);
        let names = pair.map(|part| bodies.assembly().parts()[part].name());
        let refused = |error: QueryError| error.to_string();
        loop {
            let along = (motion, self.axis);
            let (least, why) = match bodies.turned(pair, along, Some(tolerance)).map_err(refused)? {
                Turned::Free(pairs) => return Ok((tolerance, pairs)),
                Turned::Overlapping(least) => {
                    let deep = least.map_or("deeply".into(), |deep| format!("by {deep:.2e}"));
                    let why = format!(
                        "the threads of {} and {} overlap {deep} wherever they are turned to",
                        names[0], names[1]
                    );
                    (least.unwrap_or(f64::INFINITY) * BEYOND, why)
                }
                Turned::Blocked(share) => (0.0, self.met(share, names[0], names[1])),
            };
            let next = two_digits_up(least.max(2.0 * tolerance).max(FIRST * depth));
            if next > most || tolerance >= most {
                return Err(format!("{why}, and no more than {most:.2e} is let pass"));
            }
            tolerance = next;
        }
    }
}

/// Whether a way goes along the axis of a thread or against it, 1 or -1, and that axis along the way.
fn sense(thread: &Thread, d: DVec3) -> (f64, DVec3) {
    let sense = if thread.axis[1].dot(d) < 0.0 { -1.0 } else { 1.0 };
    (sense, thread.axis[1] * sense)
}
