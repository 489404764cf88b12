//! Properties of the parts that affect the order and the texts of a plan: identical shapes and fasteners.
//!
//! The preferred order of the fasteners is added to the constraints of the assembly. A step ignores this order if it
//! lets no part leave alone, so it never keeps a part from leaving. Proofs do not depend on it.

use super::{Leg, Plan};
use crate::bodies::Bodies;
use crate::constraints::Constraints;
use crate::error::AssemblyError;
use crate::fasteners::{FastenerKind, Fasteners, Unscrewing};
use crate::identical::first_identical_parts;

/// Properties of the parts that affect the order of a plan.
pub(super) struct KnownParts {
    /// For each part, the first part with the same shape.
    pub(super) likes: Vec<usize>,
    pub(super) fasteners: Fasteners,
    /// The constraints of the assembly with the order that the fasteners demand.
    pub(super) preferred: Constraints,
}

impl KnownParts {
    pub(super) fn new(bodies: &Bodies) -> Result<Self, AssemblyError> {
        let fasteners = Fasteners::with_holds(bodies)?;
        let pairs = fasteners.holds().iter().flat_map(|hold| hold.order_pairs(&fasteners));
        let preferred = bodies.assembly().constraints().with_preferred(&pairs.collect::<Vec<_>>());
        Ok(Self { likes: first_identical_parts(bodies.assembly()), fasteners, preferred })
    }

    /// Returns the screws that hold some parts, in increasing order: none of these parts and none of the base.
    pub(super) fn screws_of(&self, parts: &[usize], is_base: &[bool]) -> Vec<usize> {
        let holds = self.fasteners.holds().iter();
        let pairs = holds.flat_map(|hold| hold.order_pairs(&self.fasteners));
        let is_screw = |&[first, held]: &[usize; 2]| {
            let kind = self.fasteners.get(first).map(|fastener| fastener.kind);
            kind == Some(FastenerKind::Screw) && parts.contains(&held)
        };
        let mut screws: Vec<usize> = pairs.filter(is_screw).map(|[first, _]| first).collect();
        screws.retain(|screw| !parts.contains(screw) && !is_base[*screw]);
        screws.sort_unstable();
        screws.dedup();
        screws
    }

    /// Returns a plan with these properties.
    pub(super) fn complete(self, plan: Plan) -> Plan {
        Plan { first_identical: self.likes, fasteners: self.fasteners, ..plan }
    }

    /// Returns the turns by which a screw or nut leaves along the first move of a path, if no thread of the model turns
    /// it. The move must be long enough.
    pub(super) fn plain_unscrewing(
        &self,
        path: &[Leg],
        parts: &[usize],
        present: &[bool],
    ) -> Option<Unscrewing> {
        let ([part], first) = (parts, path.first()?) else { return None };
        if first.parts != parts || path.iter().any(|leg| leg.turn.is_some()) {
            return None;
        }
        let is_present = |part: usize| present[part];
        let found = Unscrewing::of_part(&self.fasteners, *part, first.direction, is_present)?;
        (path.len() == 1 || found.length <= first.travel).then_some(found)
    }
}
