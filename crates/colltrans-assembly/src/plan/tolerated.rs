//! Contacts that a step tolerates, of pairs with a fit of their own.

use crate::bodies::Bodies;
use crate::part::Assembly;
use crate::roles::{PairTolerance, Role};

/// A contact of two parts that a step tolerates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToleratedContact {
    /// Indices of the moving and the stationary part.
    pub parts: [usize; 2],
    /// The role of the pair, if it has one.
    pub role: Option<Role>,
    /// The tolerated contact.
    pub tolerated: PairTolerance,
}

impl ToleratedContact {
    /// Returns a description with the names of the parts.
    pub fn describe(&self, assembly: &Assembly) -> String {
        let names = assembly.part_names(&self.parts).join(" and ");
        format!("{names}: {}", self.tolerated.describe(self.role))
    }

    /// Returns the tolerated contacts between a moving group and present parts.
    pub(crate) fn tolerated_contacts(
        bodies: &Bodies,
        group: &[usize],
        present: &[bool],
    ) -> Vec<Self> {
        let passed = |parts: [usize; 2]| {
            let tolerated = bodies.tolerated_contacts(parts)?;
            let role = bodies.assembly().pair_fit(parts[0], parts[1]).and_then(|fit| fit.role);
            Some(Self { parts, role, tolerated })
        };
        bodies.present_partners(group, present).filter_map(passed).collect()
    }
}
