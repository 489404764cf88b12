//! A step of a plan: the removal of a group by one or several moves.

use std::f64::consts::TAU;

use colltrans::motion::{Motion, MotionError};
use colltrans::{Bounded, Pose};
use glam::{DQuat, DVec3};

use super::ToleratedContact;
use crate::fasteners::Unscrewing;
use crate::part::Assembly;
use crate::tools::ToolReach;

/// Maximum number of ignored pairs that are named for a step.
const MAX_NAMED: usize = 4;

/// A motion of some parts as one body: a translation, or a screw motion about an axis along the translation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Leg {
    /// Indices of the parts, in increasing order.
    pub parts: Vec<usize>,
    /// Direction of the translation, of length 1.
    pub direction: DVec3,
    /// Length of the translation.
    pub travel: f64,
    /// Uniform rotation during the translation, if any.
    pub turn: Option<Turn>,
}

/// Rotation of parts during a [leg](Leg), about an axis along its direction.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Turn {
    /// A point on the axis.
    pub point: DVec3,
    /// Number of turns. Positive turns are counter-clockwise if seen against the direction.
    pub turns: f64,
    /// Initial rotation in turns, of the same sign convention. With it and `offset` the threads overlap least, or have
    /// play.
    pub initial_turns: f64,
    /// Initial displacement of the parts; 0 if the file has them in this position.
    pub offset: DVec3,
    /// The proof of the motion, or the reason why it is not proven.
    pub proof: Result<TurnProof, String>,
}

/// Proof that parts perform the screw motion of a leg, and then move straight, without contact with the remaining
/// parts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TurnProof {
    /// Tolerance of the thread: both sides are shrunk by half of it.
    pub tolerance: f64,
    /// Number of pairs of tree nodes, each with a time interval, that the proof visited.
    pub pairs: u64,
}

impl Leg {
    /// Returns a translation.
    pub(super) const fn straight(parts: Vec<usize>, direction: DVec3, travel: f64) -> Self {
        Self { parts, direction, travel, turn: None }
    }

    /// Returns the leg as a motion for a [`MotionCast`](colltrans::motion::MotionCast) of the parts in their initial
    /// poses.
    ///
    /// # Errors
    /// Returns an error if a number is out of range.
    pub fn to_motion(&self) -> Result<Motion, MotionError> {
        let Some(turn) = &self.turn else {
            return Motion::translation(Pose::IDENTITY, self.direction * self.travel);
        };
        let start = if turn.initial_turns == 0.0 && turn.offset == DVec3::ZERO {
            Pose::IDENTITY
        } else {
            let (own, angle) = (turn.point - turn.offset, TAU * turn.initial_turns);
            let turned = Motion::rotation_about(Pose::IDENTITY, own, self.direction, angle)?;
            turned.pose_at(1.0)?.translated_by(turn.offset)?
        };
        Motion::screw(start, turn.point, self.direction, TAU * turn.turns, self.travel)
    }

    /// Returns the position of a point after a fraction of the leg, from 0 to 1.
    pub fn move_point(&self, point: DVec3, share: f64) -> DVec3 {
        let by = self.direction * (self.travel * share);
        let Some(turn) = &self.turn else { return point + by };
        let own = turn.point - turn.offset;
        turn.point + turn.rotation_at(self, share) * (point - own) + by
    }
}

impl Turn {
    /// Returns the rotation of the parts after a fraction of the leg, from 0 to 1.
    pub fn rotation_at(&self, leg: &Leg, share: f64) -> DQuat {
        DQuat::from_axis_angle(leg.direction, TAU * (self.initial_turns + self.turns * share))
    }

    /// Returns a description of the turns and of their proof.
    pub fn describe(&self) -> String {
        let turns = format!("{:.3} turns", self.turns.abs());
        let hand = if self.turns < 0.0 { ", clockwise if seen against the direction" } else { "" };
        let mut begin = String::new();
        if self.initial_turns != 0.0 {
            begin = format!(", from an initial rotation of {:.3} turns", self.initial_turns);
        }
        if self.offset != DVec3::ZERO {
            let aside = self.offset.length();
            begin = format!("{begin}, displaced by {aside:.2e} to align the axes");
        }
        match &self.proof {
            Ok(TurnProof { tolerance, .. }) => {
                format!("{turns}{hand}{begin}: proven, tolerance {tolerance}")
            }
            Err(why) => format!("{turns}{hand}{begin}: the turn is not proven: {why}"),
        }
    }
}

/// The removal of a group.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// Indices of the parts, in increasing order.
    pub parts: Vec<usize>,
    /// Direction of the removal, of length 1. For a path of several moves, that of the last one.
    pub direction: DVec3,
    /// Travel along `direction` until the group is beyond all remaining parts; 0 if none is ahead. Parts whose
    /// projected boxes are separated by more than rounding errors are not ahead. For a path of several moves, the
    /// travel of the last one.
    pub travel: Bounded,
    /// The moves that remove the group, in order, of the group or of parts that make room. In the last one the group
    /// leaves, along `direction` for `travel`. Mostly this is the only one.
    pub path: Vec<Leg>,
    /// The turns of a screw or nut at the beginning of its first move, if its thread is not modelled or has no role.
    /// The proof of the move does not contain the turns.
    pub unscrewing: Option<Unscrewing>,
    /// Whether a hand tool reaches the fastener that the step removes, among the parts that remain. `None` if the step
    /// removes no fastener that needs a tool of the [table](crate::tools), or not along its axis.
    pub tool: Option<ToolReach>,
    /// The reversed moves of parts that made room, after the group has left, and of parts of the group that left with
    /// a relative displacement. After each step all remaining parts are in their initial poses.
    pub return_legs: Vec<Leg>,
    /// For a step that takes a group apart: the index of the step that removed the group.
    pub group_step: Option<usize>,
    /// Indices of the steps that must precede this one, in increasing order: those that removed parts in its way,
    /// that order constraints demand, or that removed the enclosing group. A path of several moves follows all
    /// earlier steps of its group. Other steps may also come later.
    pub predecessors: Vec<usize>,
    /// Pairs to which the step does not apply, the moving part first. Their overlap at the start, or all of their
    /// contacts, are ignored on request.
    pub ignored: Vec<[usize; 2]>,
    /// Tolerated contacts of pairs that have a [role](crate::roles) or a tolerance of their own.
    pub tolerated: Vec<ToleratedContact>,
    /// Parts that nothing carries after the step, in increasing order. They must be held.
    pub falling: Vec<usize>,
    /// Parts that stood before the step and whose centre of mass is then outside of their support. They tip unless
    /// they are supported laterally.
    pub off_balance: Vec<usize>,
    /// Open surfaces on which the step depends, in increasing order: those of the group, and remaining ones ahead of
    /// its boxes. Their facets block, but what they enclose is unknown.
    pub surfaces: Vec<usize>,
}

impl Step {
    /// Returns a description of the ignored pairs, or `None` if there are none.
    pub fn describe_ignored(&self, assembly: &Assembly) -> Option<String> {
        let pair = |p: &[usize; 2]| assembly.part_names(p).join(" and ");
        let named: Vec<String> = self.ignored.iter().take(MAX_NAMED).map(pair).collect();
        let more = match self.ignored.len().saturating_sub(MAX_NAMED) {
            0 => String::new(),
            more => format!(" and {more} more pairs"),
        };
        (!named.is_empty()).then(|| format!("ignored: {}{more}", named.join(", ")))
    }

    /// Returns descriptions of the parts that fall or are off balance after the step.
    pub fn describe_unsettled(&self, assembly: &Assembly) -> Vec<String> {
        let list_parts = |parts: &[usize], what: &str| {
            let names = assembly.part_names(parts).join(", ");
            (!parts.is_empty()).then(|| format!("{what}: {names}"))
        };
        let falls = list_parts(&self.falling, "then rests on nothing");
        let tips = list_parts(&self.off_balance, "then off balance");
        falls.into_iter().chain(tips).collect()
    }

    /// Returns the first turn of the path, or `None` if the step has none.
    pub fn first_turn(&self) -> Option<&Turn> {
        self.path.iter().find_map(|leg| leg.turn.as_ref())
    }

    /// Returns all moves with their displacements as pictures show them: the group moves `beyond` its travel before
    /// other parts return.
    pub fn displayed_legs(&self, beyond: f64) -> impl Iterator<Item = (&Leg, DVec3)> {
        let last = self.path.len() - 1;
        self.path.iter().chain(&self.return_legs).enumerate().map(move |(k, leg)| {
            let travel = if k == last { leg.travel + beyond } else { leg.travel };
            (leg, leg.direction * travel)
        })
    }
}
