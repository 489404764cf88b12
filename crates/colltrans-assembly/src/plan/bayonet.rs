//! Bayonets: where no straight moves take anything out, a turn about an axis of a part and then a straight move along it.
//!
//! A part turns either way until something stops it, which is proven. At angles before that, even ones and others that
//! come near the stop, it is asked whether it is free along the axis; the middle of the longest run of these is taken,
//! and the turn up to there and the way on are proven against all that is left.

use std::cell::Cell;

use colltrans::Bounded;
use glam::DVec3;

use super::PlanOptions;
use super::order::Order;
use super::shadow::larger;
use super::step::{Leg, Turn, TurnProof};
use crate::bodies::{Bodies, Turned};
use crate::boxes::span;
use crate::error::AssemblyError;
use crate::threads::is_round;
use crate::watch::Watch;
use crate::{cylinders, inertia};

/// Parts among which a turn is looked for, axes of each, at most.
const MOST_PARTS: usize = 24;
const MOST_AXES: usize = 3;
/// Pairs of parts of bodies that are looked at, at most, of what is stuck together; a cast counts as so many.
const LOOKS: u64 = 1_000_000;
const CAST: u64 = 500;
/// Even angles, in a turn and at least, and those that halve the way to the stop.
const IN_A_TURN: f64 = 360.0;
const FEWEST: f64 = 48.0;
const HALVES: i32 = 12;
/// What is so round, as a share of its radius, is the same turned.
const ROUND: f64 = 0.02;
/// A turn that is shorter than this is none.
const LEAST: f64 = 1e-4;
/// Roundings of a vertex that was turned, with those of the sums that follow.
const SUMS: f64 = 32.0;

/// A part that is turned, and then leaves.
pub(super) struct Bayonet {
    pub(super) turn: Leg,
    pub(super) direction: DVec3,
    pub(super) travel: Bounded,
}

/// The first part of those that are left which a turn lets go.
pub(super) fn search(
    bodies: &Bodies,
    order: &Order,
    left: &[usize],
    options: PlanOptions,
    watch: Watch,
) -> Result<Option<Bayonet>, AssemblyError> {
    if options.legs < 2 || left.len() > MOST_PARTS || bodies.fit().tolerance() < 0.0 {
        return Ok(None);
    }
    let work = Cell::new(0);
    for &part in left.iter().filter(|part| !order.stays(**part)) {
        let others: Vec<usize> = left.iter().copied().filter(|k| *k != part).collect();
        let about = About { bodies, part, others: &others, options, work: &work };
        if others.iter().any(|&b| bodies.overlaps(part, b) && !about.passes(b)) {
            continue;
        }
        for [point, axis] in axes(bodies, part) {
            watch.check()?;
            let solid = bodies.assembly().parts()[part].solid();
            if is_round(solid, [point, axis], ROUND) {
                continue;
            }
            for d in [axis, DVec3::ZERO - axis] {
                if order.way(&[part], left, d).is_none_or(|way| way.parts != [part]) {
                    continue;
                }
                for sense in [1.0, -1.0] {
                    if work.get() > LOOKS {
                        return Ok(None);
                    }
                    if let Some(found) = about.turned([point, d], sense) {
                        return Ok(Some(found));
                    }
                }
            }
        }
    }
    Ok(None)
}

/// Axes of a part through its middle: of its cylinders, then of inertia.
fn axes(bodies: &Bodies, part: usize) -> Vec<[DVec3; 2]> {
    let solid = bodies.assembly().parts()[part].solid();
    let mut found: Vec<DVec3> = Vec::new();
    let cylinders = cylinders::axes(solid).into_iter().map(|(_, axis)| axis);
    for axis in cylinders.chain(inertia::axes(solid)) {
        if found.len() < MOST_AXES && !found.iter().any(|a| a.cross(axis).length() < 1e-6) {
            found.push(axis);
        }
    }
    let middle = |axis: DVec3| {
        let (u, v) = axis.any_orthonormal_pair();
        let extent = |d: DVec3| {
            let along = solid.vertices().iter().map(|p| p.dot(d));
            let [low, high] = span(along);
            d * low.midpoint(high)
        };
        [extent(u) + extent(v), axis]
    };
    found.into_iter().map(middle).collect()
}

/// A part among others.
#[derive(Clone, Copy)]
struct About<'a> {
    bodies: &'a Bodies<'a>,
    part: usize,
    others: &'a [usize],
    options: PlanOptions,
    work: &'a Cell<u64>,
}

impl About<'_> {
    fn count(&self, looks: u64) {
        self.work.set(self.work.get() + looks);
    }

    fn passes(&self, other: usize) -> bool {
        self.bodies.lets_pass(self.part, other, self.options.start)
    }

    /// A turn by so many turns about an axis; not proven yet.
    fn leg(&self, [point, axis]: [DVec3; 2], turns: f64) -> Leg {
        let (aside, proof) = (DVec3::ZERO, Err(String::new()));
        let turn = Turn { point, turns, phase: 0.0, aside, proof };
        Leg { parts: vec![self.part], direction: axis, travel: 0.0, turn: Some(turn) }
    }

    /// The way out after a turn in one sense, along the axis.
    fn turned(&self, about: [DVec3; 2], sense: f64) -> Option<Bayonet> {
        let stop = self.stop(about, sense)?;
        if stop < LEAST {
            return None;
        }
        let count = (IN_A_TURN * stop).ceil().max(FEWEST);
        let even = (1..=count as usize).map(|k| stop * k as f64 / count * (1.0 - 1e-9));
        let near = (7..=HALVES + 6).map(|k| stop * (1.0 - 0.5_f64.powi(k)));
        let mut angles: Vec<f64> = even.chain(near).collect();
        angles.sort_by(f64::total_cmp);
        if self.work.get() > LOOKS {
            return None;
        }
        let free: Vec<bool> =
            angles.iter().map(|turns| self.leaves(about, sense * turns)).collect();
        let mut longest: Option<[f64; 2]> = None;
        let mut first = 0;
        while first < free.len() {
            let length = free[first..].iter().take_while(|free| **free).count();
            if length > 0 {
                let run = [angles[first], angles[first + length - 1]];
                if longest.is_none_or(|[from, to]| run[1] - run[0] > to - from) {
                    longest = Some(run);
                }
            }
            first += length.max(1);
        }
        let [from, to] = longest?;
        // If the middle is between two samples and not free, the first one is.
        [from.midpoint(to), from].into_iter().find_map(|turns| self.proven(about, sense * turns))
    }

    /// After how many turns the part is stopped, at most one.
    fn stop(&self, about: [DVec3; 2], sense: f64) -> Option<f64> {
        let mut stop = 1.0_f64;
        let motion = self.leg(about, sense).motion().ok()?;
        for &other in self.others {
            if self.passes(other) || !self.bodies.may_meet_turning([self.part, other], about) {
                continue;
            }
            let (share, looks) = self.bodies.stopped([self.part, other], &motion)?;
            self.count(looks);
            stop = stop.min(share);
            if stop < LEAST {
                break;
            }
        }
        Some(stop)
    }

    /// Whether it is free along the axis once it is turned.
    fn leaves(&self, about: [DVec3; 2], turns: f64) -> bool {
        let Ok(motion) = self.leg(about, turns).motion() else { return false };
        let free = |&other: &usize| {
            let pair = [self.part, other];
            self.count(CAST);
            self.passes(other)
                || !self.bodies.may_meet_turning(pair, about)
                || self.bodies.goes_on(pair, (&motion, about[1])).unwrap_or(false)
        };
        self.others.iter().all(free)
    }

    /// The same with the turn up to there, if all of it is proven.
    fn proven(&self, about: [DVec3; 2], turns: f64) -> Option<Bayonet> {
        let mut leg = self.leg(about, turns);
        let motion = leg.motion().ok()?;
        let (direction, mut pairs) = (about[1], 0);
        let mut travel = Bounded { value: 0.0, lower: 0.0, upper: 0.0 };
        for &other in self.others {
            let pair = [self.part, other];
            if self.passes(other) || !self.bodies.may_meet_turning(pair, about) {
                continue;
            }
            match self.bodies.turned(pair, (&motion, direction), None) {
                Ok(Turned::Free(looks)) => pairs += looks,
                _ => return None,
            }
            let moved = |p: DVec3| leg.moved(p, 1.0);
            let past = self.bodies.past_moved((self.part, moved), other, direction, SUMS);
            travel = larger(travel, past);
        }
        let tolerance = self.bodies.fit().tolerance();
        if let Some(turn) = &mut leg.turn {
            turn.proof = Ok(TurnProof { tolerance, pairs });
        }
        Some(Bayonet { turn: leg, direction, travel })
    }
}
