//! A step of a plan: a group that is taken out, in one straight move or in several.

use std::f64::consts::TAU;

use colltrans::motion::{Motion, MotionError};
use colltrans::{Bounded, Pose};
use glam::{DQuat, DVec3};

use super::Passed;
use crate::part::Assembly;

/// Pairs that are ignored are named up to so many for a step.
const MOST_NAMED: usize = 4;

/// A move of some parts, as one: straight, or as a screw about an axis along it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Leg {
    /// Positions of the parts, in increasing order.
    pub parts: Vec<usize>,
    /// Where to, of length 1.
    pub direction: DVec3,
    /// How far.
    pub travel: f64,
    /// How they turn meanwhile, evenly, if they do.
    pub turn: Option<Turn>,
}

/// How parts turn while they go along a [leg](Leg), about an axis along its direction.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Turn {
    /// A point on the axis.
    pub point: DVec3,
    /// How many turns, counter-clockwise as seen against the direction if positive.
    pub turns: f64,
    /// The threads overlap least, or have play, where the parts are first turned by so many turns, counted alike, ...
    pub phase: f64,
    /// ... and put aside by this vector: 0 where the file has them so.
    pub aside: DVec3,
    /// What proves that they may turn so, or why that is not proven.
    pub proof: Result<TurnProof, String>,
}

/// That parts turn as a leg says, and then go straight on, is proven, against all that is left.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TurnProof {
    /// The length by half of which both sides of the thread are shrunk for it.
    pub tolerance: f64,
    /// Pairs of parts of the bodies, in intervals of time, that were looked at for it.
    pub pairs: u64,
}

impl Leg {
    /// A straight one.
    pub(super) const fn straight(parts: Vec<usize>, direction: DVec3, travel: f64) -> Self {
        Self { parts, direction, travel, turn: None }
    }

    /// The same for a [`MotionCast`](colltrans::motion::MotionCast) of the parts as they stand in the assembly.
    ///
    /// # Errors
    /// Numbers that are out of range.
    pub fn motion(&self) -> Result<Motion, MotionError> {
        let Some(turn) = &self.turn else {
            return Motion::slide(Pose::IDENTITY, self.direction * self.travel);
        };
        let start = if turn.phase == 0.0 && turn.aside == DVec3::ZERO {
            Pose::IDENTITY
        } else {
            let (own, angle) = (turn.point - turn.aside, TAU * turn.phase);
            let turned = Motion::turn(Pose::IDENTITY, own, self.direction, angle)?;
            turned.at(1.0)?.translated(turn.aside)?
        };
        Motion::screw(start, turn.point, self.direction, TAU * turn.turns, self.travel)
    }

    /// Where it has brought a point after a share of it, from 0 to 1.
    pub fn moved(&self, point: DVec3, share: f64) -> DVec3 {
        let by = self.direction * (self.travel * share);
        let Some(turn) = &self.turn else { return point + by };
        let own = turn.point - turn.aside;
        turn.point + turn.rotation(self, share) * (point - own) + by
    }
}

impl Turn {
    /// How it has turned the parts of its leg after a share of it, from 0 to 1.
    pub fn rotation(&self, leg: &Leg, share: f64) -> DQuat {
        DQuat::from_axis_angle(leg.direction, TAU * (self.phase + self.turns * share))
    }

    /// How much is turned, and whether that is proven, in words.
    pub fn words(&self) -> String {
        let turns = format!("{:.3} turns", self.turns.abs());
        let hand = if self.turns < 0.0 { ", clockwise as seen from where it goes" } else { "" };
        let mut begin = String::new();
        if self.phase != 0.0 {
            begin = format!(", begun turned by {:.3} turns", self.phase);
        }
        if self.aside != DVec3::ZERO {
            let aside = self.aside.length();
            begin = format!("{begin}, {aside:.2e} aside, where the axes are one");
        }
        match &self.proof {
            Ok(TurnProof { tolerance, .. }) => {
                format!("{turns}{hand}{begin}: proven, tolerance {tolerance}")
            }
            Err(why) => format!("{turns}{hand}{begin}: turning is not proven, as {why}"),
        }
    }
}

/// A group that is taken out.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// Positions of the parts, in increasing order.
    pub parts: Vec<usize>,
    /// Where to, of length 1; of several moves that of the one which takes them out.
    pub direction: DVec3,
    /// How far until it lies wholly beyond what is left; 0 if nothing is ahead. What the boxes of their
    /// shadows miss by more than rounding is not ahead. Of several moves that of the last one.
    pub travel: Bounded,
    /// The moves that take the group out, in order: of it, or of parts that make room. With the last one the group
    /// leaves, along `direction` for `travel`; mostly there is no other.
    pub path: Vec<Leg>,
    /// How what made room goes back to its place, by the same ways reversed, once the group has left; and parts of the
    /// group, if it left with one moved against another. So after each step what is left stands where it stood.
    pub back: Vec<Leg>,
    /// For a step that takes a group apart: the step that took the group out.
    pub within: Option<usize>,
    /// The steps before it without which it would not go, in increasing order: that took away what it meets on its way,
    /// or the group that it takes apart. Of several moves all before it. All others may as well come later.
    pub after: Vec<usize>,
    /// What the step does not speak of: of each pair the first part moves and the second stays, and
    /// their overlap at the start, or all that they do, is ignored on request.
    pub ignored: Vec<[usize; 2]>,
    /// What it lets pass of pairs that have a [role](crate::roles) or a tolerance of their own.
    pub passed: Vec<Passed>,
    /// What then rests on nothing that is left, in increasing order: hold it.
    pub falls: Vec<usize>,
    /// What stood before, and whose centre of mass then lies beyond what carries it: it tips, unless it is held at its
    /// sides.
    pub off_balance: Vec<usize>,
    /// The open surfaces that it rests on, in increasing order: of the group, and of what is left and in
    /// its way or beside it. What they block is known; what is inside of them is not.
    pub surfaces: Vec<usize>,
}

impl Step {
    /// What it does not speak of, in words; `None` if there is nothing.
    pub fn ignores(&self, assembly: &Assembly) -> Option<String> {
        let pair = |p: &[usize; 2]| assembly.names(p).join(" and ");
        let named: Vec<String> = self.ignored.iter().take(MOST_NAMED).map(pair).collect();
        let more = match self.ignored.len().saturating_sub(MOST_NAMED) {
            0 => String::new(),
            more => format!(" and {more} more pairs"),
        };
        (!named.is_empty()).then(|| format!("ignored: {}{more}", named.join(", ")))
    }

    /// What is no longer carried once it is done, in words.
    pub fn unsettled(&self, assembly: &Assembly) -> Vec<String> {
        let said = |parts: &[usize], what: &str| {
            let names = assembly.names(parts).join(", ");
            (!parts.is_empty()).then(|| format!("{what}: {names}"))
        };
        let falls = said(&self.falls, "then rests on nothing");
        let tips = said(&self.off_balance, "then off balance");
        falls.into_iter().chain(tips).collect()
    }

    /// The turn of what is unscrewed, if it is.
    pub fn turn(&self) -> Option<&Turn> {
        self.path.iter().find_map(|leg| leg.turn.as_ref())
    }

    /// All moves, as a picture shows them: the group goes `beyond` its travel before anything goes back.
    pub fn shown(&self, beyond: f64) -> impl Iterator<Item = (&Leg, DVec3)> {
        let last = self.path.len() - 1;
        self.path.iter().chain(&self.back).enumerate().map(move |(k, leg)| {
            let travel = if k == last { leg.travel + beyond } else { leg.travel };
            (leg, leg.direction * travel)
        })
    }
}
