//! Duration of a plan, from a table of handling times.

use serde::{Deserialize, Serialize};

use super::Plan;
use crate::roles::Role;

/// Handling times in seconds.
///
/// The defaults are round figures of the order of those of Boothroyd, Dewhurst and Knight, *Product Design for
/// Manufacture and Assembly*, chapter 3. Replace them if measured times are available.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct HandlingTimes {
    /// Grasping the parts that leave.
    pub grasp: f64,
    /// Each move, of the parts that leave or of parts that make room.
    pub r#move: f64,
    /// A direction that differs from that of the step before.
    pub direction: f64,
    /// A shape that differs from that of the step before, because it needs another tool.
    pub shape: f64,
    /// A group of several parts, in addition to the time for one part.
    pub group: f64,
    /// Each part that must be held because it falls or is off balance.
    pub hold: f64,
    /// Each pair with a press fit.
    pub press: f64,
    /// Each pair with a soft part.
    pub soft: f64,
    /// Each snap fit.
    pub snap: f64,
    /// Each threaded pair, and each screw or nut that is unscrewed from a plain hole.
    pub thread: f64,
}

impl Default for HandlingTimes {
    fn default() -> Self {
        Self {
            grasp: 1.5,
            r#move: 1.5,
            direction: 4.5,
            shape: 3.0,
            group: 2.0,
            hold: 5.0,
            press: 5.0,
            soft: 3.0,
            snap: 2.0,
            thread: 8.0,
        }
    }
}

impl HandlingTimes {
    /// Returns the name and the value of the first entry outside of 0 to 1e9 seconds, or `None` if all entries are
    /// valid.
    pub fn first_invalid(&self) -> Option<(&'static str, f64)> {
        let all = [
            ("grasp", self.grasp),
            ("move", self.r#move),
            ("direction", self.direction),
            ("shape", self.shape),
            ("group", self.group),
            ("hold", self.hold),
            ("press", self.press),
            ("soft", self.soft),
            ("snap", self.snap),
            ("thread", self.thread),
        ];
        all.into_iter().find(|(_, seconds)| !(0.0..=1e9).contains(seconds))
    }

    /// Returns the seconds of each step of a plan, in its order.
    pub fn step_seconds(&self, plan: &Plan) -> Vec<f64> {
        let mut last = None;
        let step = |step: &super::Step| {
            let shape = plan.first_identical[step.parts[0]];
            let (turned, other) = last.map_or((false, false), |(direction, known)| {
                (direction != step.direction, known != shape)
            });
            last = Some((step.direction, shape));
            let moves = (step.path.len() + step.return_legs.len()) as f64;
            let held = (step.falling.len() + step.off_balance.len()) as f64;
            let when = |what: bool, seconds: f64| if what { seconds } else { 0.0 };
            let passed = step.tolerated.iter().map(|passed| match passed.role {
                Some(Role::Press) => self.press,
                Some(Role::Soft) => self.soft,
                Some(Role::Snap) => self.snap,
                Some(Role::Thread) => self.thread,
                Some(Role::Glued) | None => 0.0,
            });
            self.grasp
                + self.r#move * moves
                + when(turned, self.direction)
                + when(other, self.shape)
                + when(step.parts.len() > 1, self.group)
                + self.hold * held
                + when(step.unscrewing.is_some(), self.thread)
                + passed.sum::<f64>()
        };
        plan.steps.iter().map(step).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_accept_known_names_and_reject_negative_seconds() {
        let read = |text: &str| serde_json::from_str::<HandlingTimes>(text);
        assert_eq!(
            read(r#"{"grasp": 2.5}"#).unwrap(),
            HandlingTimes { grasp: 2.5, ..HandlingTimes::default() }
        );
        assert!(read(r#"{"grip": 2.5}"#).is_err());
        assert_eq!(read(r#"{"move": -1}"#).unwrap().first_invalid(), Some(("move", -1.0)));
        assert_eq!(HandlingTimes::default().first_invalid(), None);
    }
}
