//! A step of a plan: a group that is taken out, in one straight move or in several.

use colltrans::Bounded;
use glam::DVec3;

use crate::part::Assembly;
use crate::roles::Passed;

/// Pairs that are ignored are named up to so many for a step.
const MOST_NAMED: usize = 4;

/// A straight move of some parts, as one.
#[derive(Debug, Clone, PartialEq)]
pub struct Leg {
    /// Positions of the parts, in increasing order.
    pub parts: Vec<usize>,
    /// Where to, of length 1.
    pub direction: DVec3,
    /// How far.
    pub travel: f64,
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

    /// All moves, as a picture shows them: the group goes `beyond` its travel before anything goes back.
    pub fn shown(&self, beyond: f64) -> impl Iterator<Item = (&Leg, DVec3)> {
        let last = self.path.len() - 1;
        self.path.iter().chain(&self.back).enumerate().map(move |(k, leg)| {
            let travel = if k == last { leg.travel + beyond } else { leg.travel };
            (leg, leg.direction * travel)
        })
    }
}
