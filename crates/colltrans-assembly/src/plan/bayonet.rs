//! Bayonet motions: a turn about an axis of a part, followed by a straight move along the axis.
//!
//! They are searched if no straight moves remove anything. A part turns in either sense up to a proven bound before
//! its first contact. At evenly spaced angles below this bound, and at further ones close to it, the part is tested
//! for being free along the axis. The middle of the longest free run is chosen. The turn to this angle and the move
//! are then proven against all remaining parts.

use std::cell::Cell;

use colltrans::Bounded;
use glam::DVec3;

use super::PlanOptions;
use super::order::Order;
use super::shadow::max_bounded;
use super::step::{Leg, Turn, TurnProof};
use crate::bodies::{Bodies, ScrewOutcome};
use crate::boxes::value_range;
use crate::error::AssemblyError;
use crate::threads::{is_rotationally_symmetric, round_axes};
use crate::watch::Watch;

/// Maximum number of axes of each part.
const MAX_AXES: usize = 3;
/// Divisor of the work of a search for moves. The result is the maximum number of visited pairs for a group.
const SHARE: u64 = 20;
/// Number of pairs for which a cast counts.
const CAST_WORK: u64 = 500;
/// Number of evenly spaced angles for a full turn, their minimum number, and the number of angles that halve the
/// distance to the first contact.
const ANGLES_PER_TURN: f64 = 360.0;
const MIN_ANGLES: f64 = 48.0;
const HALVES: i32 = 12;
/// Maximum deviation from a round shape, as a fraction of the radius, for which turning is pointless.
const ROUND_TOLERANCE: f64 = 0.02;
/// Minimum number of turns that is considered.
const MIN_TURNS: f64 = 1e-4;
/// Number of rounding errors of a turned vertex and of the sums that follow.
const ROUNDINGS: f64 = 32.0;

/// A part that is turned and then leaves.
pub(super) struct Bayonet {
    pub(super) turn: Leg,
    pub(super) direction: DVec3,
    pub(super) travel: Bounded,
}

/// Returns the first remaining part that a turn releases. Returns `None` if no turn is found or a limit is exceeded.
pub(super) fn search_bayonet(
    bodies: &Bodies,
    order: &Order,
    left: &[usize],
    options: PlanOptions,
    watch: Watch,
) -> Result<Option<Bayonet>, AssemblyError> {
    let max_work = options.work() / SHARE;
    if max_work == 0 || bodies.fit().tolerance() < 0.0 {
        return Ok(None);
    }
    let work = Cell::new(0);
    for &part in left.iter().filter(|part| !order.is_stationary(**part)) {
        let others: Vec<usize> = left.iter().copied().filter(|k| *k != part).collect();
        let about = TurningPart { bodies, part, others: &others, options, work: &work };
        if others.iter().any(|&b| bodies.overlaps(part, b) && !about.is_ignored(b)) {
            continue;
        }
        for [point, axis] in candidate_axes(bodies, part) {
            watch.check_cancelled()?;
            let solid = bodies.assembly().parts()[part].solid();
            if is_rotationally_symmetric(solid, [point, axis], ROUND_TOLERANCE) {
                continue;
            }
            for d in [axis, DVec3::ZERO - axis] {
                if order.choice_for(&[part], left, d).is_none_or(|way| way.parts != [part]) {
                    continue;
                }
                for sense in [1.0, -1.0] {
                    if work.get() > max_work {
                        return Ok(None);
                    }
                    if let Some(found) = about.removal_after_turn([point, d], sense) {
                        return Ok(Some(found));
                    }
                }
            }
        }
    }
    Ok(None)
}

/// Returns axes through the middle of a part: those of its cylinders, then principal axes of inertia.
fn candidate_axes(bodies: &Bodies, part: usize) -> Vec<[DVec3; 2]> {
    let solid = bodies.assembly().parts()[part].solid();
    let mut found: Vec<DVec3> = Vec::new();
    for axis in round_axes(solid) {
        if found.len() < MAX_AXES && !found.iter().any(|a| a.cross(axis).length() < 1e-6) {
            found.push(axis);
        }
    }
    let middle = |axis: DVec3| {
        let (u, v) = axis.any_orthonormal_pair();
        let extent = |d: DVec3| {
            let along = solid.vertices().iter().map(|p| p.dot(d));
            let [low, high] = value_range(along);
            d * low.midpoint(high)
        };
        [extent(u) + extent(v), axis]
    };
    found.into_iter().map(middle).collect()
}

/// A part that may turn among others.
#[derive(Clone, Copy)]
struct TurningPart<'a> {
    bodies: &'a Bodies<'a>,
    part: usize,
    others: &'a [usize],
    options: PlanOptions,
    work: &'a Cell<u64>,
}

impl TurningPart<'_> {
    fn add_work(&self, looks: u64) {
        self.work.set(self.work.get() + looks);
    }

    fn is_ignored(&self, other: usize) -> bool {
        self.bodies.disregards_contacts(self.part, other, self.options.start)
    }

    /// Returns a leg with a number of turns about an axis, without a proof.
    fn turn_leg(&self, [point, axis]: [DVec3; 2], turns: f64) -> Leg {
        let (aside, proof) = (DVec3::ZERO, Err(String::new()));
        let turn = Turn { point, turns, initial_turns: 0.0, offset: aside, proof };
        Leg { parts: vec![self.part], direction: axis, travel: 0.0, turn: Some(turn) }
    }

    /// Searches for a turn in one sense after which the part leaves along the axis.
    fn removal_after_turn(&self, about: [DVec3; 2], sense: f64) -> Option<Bayonet> {
        let stop = self.turns_to_stop(about, sense)?;
        if stop < MIN_TURNS {
            return None;
        }
        let count = (ANGLES_PER_TURN * stop).ceil().max(MIN_ANGLES);
        let even = (1..=count as usize).map(|k| stop * k as f64 / count * (1.0 - 1e-9));
        let near = (7..=HALVES + 6).map(|k| stop * (1.0 - 0.5_f64.powi(k)));
        let mut angles: Vec<f64> = even.chain(near).collect();
        angles.sort_by(f64::total_cmp);
        if self.work.get() > self.options.work() / SHARE {
            return None;
        }
        let free: Vec<bool> =
            angles.iter().map(|turns| self.leaves_after(about, sense * turns)).collect();
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
        // If the middle of the run is between samples and not free, its first angle is used.
        [from.midpoint(to), from]
            .into_iter()
            .find_map(|turns| self.prove_removal(about, sense * turns))
    }

    /// Returns a lower bound, at most 1, of the number of turns before the part collides. Returns `None` if a query
    /// fails or the part overlaps another one at the start.
    fn turns_to_stop(&self, about: [DVec3; 2], sense: f64) -> Option<f64> {
        let mut stop = 1.0_f64;
        let motion = self.turn_leg(about, sense).to_motion().ok()?;
        for &other in self.others {
            if self.is_ignored(other) || !self.bodies.may_meet_turning([self.part, other], about) {
                continue;
            }
            let (share, looks) = self.bodies.contact_share([self.part, other], &motion)?;
            self.add_work(looks);
            stop = stop.min(share);
            if stop < MIN_TURNS {
                break;
            }
        }
        Some(stop)
    }

    /// Checks whether the part is free along the axis after a number of turns.
    fn leaves_after(&self, about: [DVec3; 2], turns: f64) -> bool {
        let Ok(motion) = self.turn_leg(about, turns).to_motion() else { return false };
        let free = |&other: &usize| {
            let pair = [self.part, other];
            self.add_work(CAST_WORK);
            self.is_ignored(other)
                || !self.bodies.may_meet_turning(pair, about)
                || self.bodies.is_free_beyond(pair, (&motion, about[1])).unwrap_or(false)
        };
        self.others.iter().all(free)
    }

    /// Proves the turn and the move along the axis. Returns `None` if a pair is not proven free.
    fn prove_removal(&self, about: [DVec3; 2], turns: f64) -> Option<Bayonet> {
        let mut leg = self.turn_leg(about, turns);
        let motion = leg.to_motion().ok()?;
        let (direction, mut pairs) = (about[1], 0);
        let mut travel = Bounded { value: 0.0, lower: 0.0, upper: 0.0 };
        for &other in self.others {
            let pair = [self.part, other];
            if self.is_ignored(other) || !self.bodies.may_meet_turning(pair, about) {
                continue;
            }
            match self.bodies.screw_outcome(pair, (&motion, direction, None), None) {
                Ok(ScrewOutcome::Free(looks)) => pairs += looks,
                _ => return None,
            }
            let moved = |p: DVec3| leg.move_point(p, 1.0);
            let past =
                self.bodies.travel_beyond_moved((self.part, moved), other, direction, ROUNDINGS);
            travel = max_bounded(travel, past);
        }
        let tolerance = self.bodies.fit().tolerance();
        if let Some(turn) = &mut leg.turn {
            turn.proof = Ok(TurnProof { tolerance, pairs });
        }
        Some(Bayonet { turn: leg, direction, travel })
    }
}
