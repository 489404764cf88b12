//! Contacts that a step tolerates, of pairs with a fit of their own.

use crate::bodies::Bodies;
use crate::part::Assembly;
use crate::roles::{Role, Tolerated};

/// A contact of two parts that a step tolerates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passed {
    /// Indices of the moving and the stationary part.
    pub parts: [usize; 2],
    /// The role of the pair, if it has one.
    pub role: Option<Role>,
    /// The tolerated contact.
    pub tolerated: Tolerated,
}

impl Passed {
    /// Returns a description with the names of the parts.
    pub fn words(&self, assembly: &Assembly) -> String {
        let names = assembly.names(&self.parts).join(" and ");
        format!("{names}: {}", self.tolerated.words(self.role))
    }

    /// Returns the tolerated contacts between a moving group and present parts.
    pub(crate) fn between(bodies: &Bodies, group: &[usize], present: &[bool]) -> Vec<Self> {
        let passed = |parts: [usize; 2]| {
            let tolerated = bodies.tolerated(parts)?;
            let role = bodies.assembly().pair(parts[0], parts[1]).and_then(|fit| fit.role);
            Some(Self { parts, role, tolerated })
        };
        bodies.partners(group, present).filter_map(passed).collect()
    }
}
