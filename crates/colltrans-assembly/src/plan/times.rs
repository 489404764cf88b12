//! How long a plan takes, by a table of handling times.

use serde::{Deserialize, Serialize};

use super::Plan;
use crate::roles::Role;

/// Seconds for what a plan asks of whoever follows it: round figures of the order of those of Boothroyd, Dewhurst and
/// Knight, *Product Design for Manufacture and Assembly*, chapter 3; whoever has measured better ones replaces them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Times {
    /// To grasp what leaves.
    pub grasp: f64,
    /// Each straight move, of what leaves or makes room.
    pub r#move: f64,
    /// Another direction than in the step before.
    pub direction: f64,
    /// Another shape than in the step before: another tool.
    pub shape: f64,
    /// A group of several parts, more than one part.
    pub group: f64,
    /// Each part that is to be held, as it falls or is off balance.
    pub hold: f64,
    /// Each pair that is pressed, ...
    pub press: f64,
    /// ... soft, ...
    pub soft: f64,
    /// ... snapped, ...
    pub snap: f64,
    /// ... screwed.
    pub thread: f64,
}

impl Default for Times {
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

impl Times {
    /// The name and the value of an entry that is no time, if there is one.
    pub fn wrong(&self) -> Option<(&'static str, f64)> {
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

    /// Seconds for each step of a plan, in its order.
    pub fn of(&self, plan: &Plan) -> Vec<f64> {
        let mut last = None;
        let step = |step: &super::Step| {
            let shape = plan.likes[step.parts[0]];
            let (turned, other) = last.map_or((false, false), |(direction, known)| {
                (direction != step.direction, known != shape)
            });
            last = Some((step.direction, shape));
            let moves = (step.path.len() + step.back.len()) as f64;
            let held = (step.falls.len() + step.off_balance.len()) as f64;
            let when = |what: bool, seconds: f64| if what { seconds } else { 0.0 };
            let passed = step.passed.iter().map(|passed| match passed.role {
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
                + passed.sum::<f64>()
        };
        plan.steps.iter().map(step).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_a_number_of_seconds() {
        let read = |text: &str| serde_json::from_str::<Times>(text);
        assert_eq!(read(r#"{"grasp": 2.5}"#).unwrap(), Times { grasp: 2.5, ..Times::default() });
        assert!(read(r#"{"grip": 2.5}"#).is_err());
        assert_eq!(read(r#"{"move": -1}"#).unwrap().wrong(), Some(("move", -1.0)));
        assert_eq!(Times::default().wrong(), None);
    }
}
