//! What a step lets pass of pairs with a fit of their own.

use crate::bodies::Bodies;
use crate::part::Assembly;
use crate::roles::{Role, Tolerated};

/// What a step lets pass of two parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passed {
    /// The first part moves, the second stays.
    pub parts: [usize; 2],
    /// What is said of them.
    pub role: Option<Role>,
    /// What is let pass.
    pub tolerated: Tolerated,
}

impl Passed {
    /// In words, with the parts.
    pub fn words(&self, assembly: &Assembly) -> String {
        let names = assembly.names(&self.parts).join(" and ");
        format!("{names}: {}", self.tolerated.words(self.role))
    }

    /// All of a group that goes and others that are there.
    pub(crate) fn between(bodies: &Bodies, group: &[usize], there: &[bool]) -> Vec<Self> {
        let passed = |parts: [usize; 2]| {
            let tolerated = bodies.tolerated(parts)?;
            let role = bodies.assembly().pair(parts[0], parts[1]).and_then(|fit| fit.role);
            Some(Self { parts, role, tolerated })
        };
        bodies.partners(group, there).filter_map(passed).collect()
    }
}
