//! Properties of the parts that affect the order and the texts of a plan: identical shapes, fasteners, and tools.
//!
//! The preferred orders of tools and of fasteners are added to the constraints of the assembly. A step ignores that of
//! the tools, or both, if it lets no part leave alone, so that no part is kept from leaving. Proofs do not depend on
//! these orders.

use super::order::base_parts;
use super::{Leg, Plan};
use crate::bodies::Bodies;
use crate::constraints::Constraints;
use crate::error::AssemblyError;
use crate::fasteners::{FastenerKind, Fasteners, Unscrewing};
use crate::identical::first_identical_parts;
use crate::tools::{ToolReach, Tools};

/// Properties of the parts that affect the order of a plan.
pub(super) struct KnownParts {
    /// For each part, the first part with the same shape.
    pub(super) likes: Vec<usize>,
    pub(super) fasteners: Fasteners,
    /// Pairs of which the first part leaves before or together with the second: what fasteners hold.
    held: Vec<[usize; 2]>,
    tools: Tools,
    /// Pairs of which the first part leaves before the second, a fastener, so that a tool reaches it.
    tool_pairs: Vec<[usize; 2]>,
    /// The constraints of the assembly with the order that tools and fasteners demand, and with that of fasteners.
    pub(super) preferred: [Constraints; 2],
}

impl KnownParts {
    pub(super) fn new(bodies: &Bodies) -> Result<Self, AssemblyError> {
        let (assembly, fasteners) = (bodies.assembly(), Fasteners::with_holds(bodies)?);
        let held = fasteners.holds().iter().flat_map(|hold| hold.order_pairs(&fasteners));
        let held: Vec<[usize; 2]> = held.collect();
        let tools = Tools::find(assembly, &fasteners);
        let base = base_parts(bodies, &vec![true; bodies.len()], assembly.up(), |_| false);
        let stays = |own: usize, other: usize| base[other] || held.contains(&[own, other]);
        let tool_pairs = tools.order_pairs(&fasteners, stays);
        let by_holds = assembly.constraints().with_preferred(&held);
        let preferred = [by_holds.with_preferred(&tool_pairs), by_holds];
        let likes = first_identical_parts(assembly);
        Ok(Self { likes, fasteners, held, tools, tool_pairs, preferred })
    }

    /// Returns the screws that hold some parts, in increasing order: none of these parts and none of the base.
    pub(super) fn screws_of(&self, parts: &[usize], is_base: &[bool]) -> Vec<usize> {
        let is_screw = |&[first, held]: &[usize; 2]| {
            let kind = self.fasteners.get(first).map(|fastener| fastener.kind);
            kind == Some(FastenerKind::Screw) && parts.contains(&held)
        };
        let pairs = self.held.iter().filter(|pair| is_screw(pair));
        let mut screws: Vec<usize> = pairs.map(|[first, _]| *first).collect();
        screws.retain(|screw| !parts.contains(screw) && !is_base[*screw]);
        screws.sort_unstable();
        screws.dedup();
        screws
    }

    /// Returns the parts that stand in the way of the tools for some parts, and those in the way of tools for these, in
    /// increasing order: none of the base.
    pub(super) fn obstacles_of(&self, parts: &[usize], is_base: &[bool]) -> Vec<usize> {
        let mut all = parts.to_vec();
        let mut at = 0;
        while at < all.len() {
            let own = all[at];
            let before = self.tool_pairs.iter().filter(|[_, second]| *second == own);
            let mut new: Vec<usize> = before.map(|[first, _]| *first).collect();
            new.extend(self.screws_of(&[own], is_base));
            new.retain(|part| !all.contains(part) && !is_base[*part]);
            all.extend(new);
            at += 1;
        }
        all.retain(|part| !parts.contains(part));
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Returns whether a tool reaches a fastener that leaves alone along the first move of a path.
    pub(super) fn tool_reach(
        &self,
        path: &[Leg],
        parts: &[usize],
        present: &[bool],
    ) -> Option<ToolReach> {
        let (part, first) = single_part_move(path, parts)?;
        self.tools.reach(part, first.direction, |part| present[part])
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
        let (part, first) = single_part_move(path, parts)?;
        if path.iter().any(|leg| leg.turn.is_some()) {
            return None;
        }
        let is_present = |part: usize| present[part];
        let found = Unscrewing::of_part(&self.fasteners, part, first.direction, is_present)?;
        (path.len() == 1 || found.length <= first.travel).then_some(found)
    }
}

/// Returns the only one of some parts, and the first move of a path; `None` if there are several parts, or if other
/// parts move first.
fn single_part_move<'p>(path: &'p [Leg], parts: &[usize]) -> Option<(usize, &'p Leg)> {
    let ([part], first) = (parts, path.first()?) else { return None };
    (first.parts == parts).then_some((*part, first))
}
