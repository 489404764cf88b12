//! Constraints on plans beyond geometry: order, parts that leave together, and forbidden directions.
//!
//! An order constraint is an additional arc of the blocking graph along every direction: "`a` before `b`" is an arc
//! from `b` to `a`, as if `a` blocked `b`. Parts that leave as one are connected by arcs both ways. Therefore all
//! properties of blocking graphs remain valid: a removable group stays removable, and a greedy plan removes as much
//! as any other. A forbidden direction of a part is forbidden for every group that contains the part.
//!
//! Invariant: units that are never taken apart are disjoint. Of two other units that share a part, one contains the
//! other.

use glam::DVec3;
use petgraph::algo::tarjan_scc;
use petgraph::graph::DiGraph;
use petgraph::unionfind::UnionFind;

use crate::error::AssemblyError;
use crate::sphere::normalized_direction;

/// A unit: parts that leave as one.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidUnit {
    /// Name of the unit.
    pub name: Option<String>,
    /// Indices of the parts, in increasing order.
    pub parts: Vec<usize>,
    /// Whether the unit is taken apart once nothing else is left. This holds for subassemblies, not for parts that
    /// stay together.
    pub is_subassembly: bool,
}

/// A forbidden range of directions of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForbiddenDirection {
    /// Index of the part.
    pub part: usize,
    /// Centre of the range, of length 1.
    pub direction: DVec3,
    /// Angle of the range around its centre, in degrees.
    pub angle_degrees: f64,
}

/// Constraints on plans.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Constraints {
    before: Vec<[usize; 2]>,
    units: Vec<RigidUnit>,
    never: Vec<ForbiddenDirection>,
}

/// Default angle around a forbidden direction, in degrees.
pub const DEFAULT_FORBIDDEN_DEGREES: f64 = 45.0;

/// Tolerance of cosines, so that an angle equal to the limit is within it.
const COSINE_TOLERANCE: f64 = 1e-12;

impl Constraints {
    /// Returns the pairs of which the first part leaves before or together with the second.
    pub fn order_pairs(&self) -> &[[usize; 2]] {
        &self.before
    }

    /// Returns the units of parts that leave as one.
    pub fn units(&self) -> &[RigidUnit] {
        &self.units
    }

    /// Returns the forbidden directions of parts.
    pub fn forbidden_directions(&self) -> &[ForbiddenDirection] {
        &self.never
    }

    /// Checks whether there are order constraints or units.
    pub(crate) fn is_any_order(&self) -> bool {
        !self.before.is_empty() || !self.units.is_empty()
    }

    /// Adds the constraint that some parts leave before others. `name` returns the name of a part.
    ///
    /// # Errors
    /// Returns an error if the order becomes cyclic.
    pub(crate) fn add_before<'a>(
        &mut self,
        [first, second]: [&[usize]; 2],
        name: impl Fn(usize) -> &'a str,
    ) -> Result<(), AssemblyError> {
        if let ([a], [b]) = (first, second)
            && a == b
        {
            return Err(AssemblyError::CyclicOrder { names: vec![name(*a).to_owned()] });
        }
        let pairs = first.iter().flat_map(|&a| second.iter().map(move |&b| [a, b]));
        self.before.extend(pairs.filter(|[a, b]| a != b));
        self.before.sort_unstable();
        self.before.dedup();
        self.check_acyclic(name)
    }

    /// Returns the constraints with preferred order pairs: the first part of each leaves before or together with the
    /// second. Pairs that contradict these constraints, or pairs before them, are left out.
    pub(crate) fn with_preferred(&self, pairs: &[[usize; 2]]) -> Self {
        let mut all = self.clone();
        all.before.extend(pairs.iter().filter(|[a, b]| a != b));
        all.before.sort_unstable();
        all.before.dedup();
        if all.check_acyclic(|_| "").is_ok() {
            return all;
        }
        let mut kept = self.clone();
        for &[a, b] in pairs {
            let mut next = kept.clone();
            if a != b && next.add_before([&[a], &[b]], |_| "").is_ok() {
                kept = next;
            }
        }
        kept
    }

    /// Adds a unit of parts that leave as one. `name` returns the name of a part.
    ///
    /// # Errors
    /// Returns an error if two subassemblies overlap and neither contains the other, or if the order becomes cyclic.
    pub(crate) fn add_unit<'a>(
        &mut self,
        added: RigidUnit,
        name: impl Fn(usize) -> &'a str,
    ) -> Result<(), AssemblyError> {
        self.units.push(added);
        // Units that stay together are merged if they share a part. A subassembly that contains a part of one is
        // extended by all of it.
        while let Some([a, b]) =
            self.overlapping_units(|a, b| !a.is_subassembly || !b.is_subassembly)
        {
            let (from, to) = if self.units[b].is_subassembly { (a, b) } else { (b, a) };
            let parts = self.units[from].parts.clone();
            let both = &mut self.units[to];
            both.parts.extend(parts);
            both.parts.sort_unstable();
            both.parts.dedup();
            if !both.is_subassembly {
                self.units.remove(from);
            }
        }
        if let Some(pair) = self.overlapping_units(|_, _| true) {
            let names = pair.map(|k| {
                let unit = &self.units[k];
                let parts = || unit.parts.iter().map(|&p| name(p)).collect::<Vec<_>>().join(", ");
                unit.name.clone().unwrap_or_else(parts)
            });
            return Err(AssemblyError::OverlappingSubassemblies { names });
        }
        self.check_acyclic(name)
    }

    /// Returns the first two units that share parts although neither may contain the other, among pairs that are
    /// `wanted`.
    fn overlapping_units(
        &self,
        wanted: impl Fn(&RigidUnit, &RigidUnit) -> bool,
    ) -> Option<[usize; 2]> {
        let holds = |a: &RigidUnit, b: &RigidUnit| {
            a.is_subassembly && b.parts.iter().all(|p| a.parts.contains(p))
        };
        let pairs = (0..self.units.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
        let clash = |pair: &[usize; 2]| {
            let [a, b] = pair.map(|k| &self.units[k]);
            let shared = a.parts.iter().any(|p| b.parts.contains(p));
            shared && !holds(a, b) && !holds(b, a) && wanted(a, b)
        };
        pairs.into_iter().find(clash)
    }

    /// Adds a forbidden direction of a part, with all directions within an angle in degrees.
    ///
    /// # Errors
    /// Returns an error if the direction is zero or not finite, or the angle is negative or at least 180 degrees.
    pub(crate) fn add_forbidden_direction(
        &mut self,
        part: usize,
        direction: DVec3,
        within: f64,
    ) -> Result<(), AssemblyError> {
        if !(0.0..180.0).contains(&within) {
            return Err(AssemblyError::InvalidAngle { degrees: within });
        }
        self.never.push(ForbiddenDirection {
            part,
            direction: normalized_direction(direction)?,
            angle_degrees: within,
        });
        Ok(())
    }

    /// Checks that the order is acyclic if parts that stay together count as one. Returns the parts of a cycle as an
    /// error.
    fn check_acyclic<'a>(&self, name: impl Fn(usize) -> &'a str) -> Result<(), AssemblyError> {
        let count = self.before.iter().flatten().chain(self.units.iter().flat_map(|u| &u.parts));
        let mut one = UnionFind::new(count.max().map_or(0, |most| most + 1));
        for unit in self.units.iter().filter(|unit| !unit.is_subassembly) {
            unit.parts.windows(2).for_each(|pair| {
                one.union(pair[0], pair[1]);
            });
        }
        let arcs = self.before.iter().map(|pair| pair.map(|part| one.find(part) as u32));
        let graph = DiGraph::<(), ()>::from_edges(arcs.map(|[a, b]| (a, b)));
        let round = tarjan_scc(&graph)
            .into_iter()
            .find(|all| all.len() > 1 || graph.contains_edge(all[0], all[0]));
        let Some(round) = round else { return Ok(()) };
        let among = |part: &usize| round.iter().any(|k| k.index() == one.find(*part));
        let mut parts: Vec<usize> = self.before.iter().flatten().copied().filter(among).collect();
        parts.sort_unstable();
        parts.dedup();
        let names = parts.into_iter().map(|part| name(part).to_owned()).collect();
        Err(AssemblyError::CyclicOrder { names })
    }

    /// Checks whether constraints concern these parts.
    pub(crate) fn is_concerned(&self, parts: &[usize]) -> bool {
        let mut present = vec![false; parts.iter().max().map_or(0, |most| most + 1)];
        for &part in parts {
            present[part] = true;
        }
        let kept = self.never.iter().any(|never| is_there(&present, never.part));
        kept || !self.order_arcs(&present).is_empty()
    }

    /// Returns the arcs of the constraints among the present parts. They hold along every direction.
    pub(crate) fn order_arcs(&self, present: &[bool]) -> Vec<(usize, usize)> {
        let ordered =
            self.before.iter().filter(|pair| pair.iter().all(|&part| is_there(present, part)));
        let mut arcs: Vec<(usize, usize)> = ordered.map(|&[a, b]| (b, a)).collect();
        arcs.extend(self.rigid_pairs(present).into_iter().flat_map(|[a, b]| [(a, b), (b, a)]));
        arcs
    }

    /// Returns all pairs of present parts that leave as one.
    pub(crate) fn rigid_pairs(&self, present: &[bool]) -> Vec<[usize; 2]> {
        let mut pairs = Vec::new();
        for unit in self.units.iter().filter(|unit| !unit.is_released(present)) {
            let parts = unit.parts.iter().copied().filter(|&part| is_there(present, part));
            let parts: Vec<usize> = parts.collect();
            let with = parts
                .iter()
                .enumerate()
                .flat_map(|(k, &b)| parts[..k].iter().map(move |&a| [a, b]));
            pairs.extend(with);
        }
        pairs
    }

    /// Returns the number of units that may be taken apart because nothing else is present.
    pub(crate) fn released_count(&self, present: &[bool]) -> usize {
        self.units.iter().filter(|unit| unit.is_released(present)).count()
    }

    /// Checks whether the constraints require that a part is removed before a group: the part comes before one of the
    /// group, or the group takes apart a unit that the part does not belong to.
    pub(crate) fn must_wait_for(&self, group: &[usize], part: usize) -> bool {
        let later = |pair: &[usize; 2]| pair[0] == part && group.contains(&pair[1]);
        let apart = |unit: &RigidUnit| {
            let some = group.iter().any(|k| unit.parts.contains(k));
            some && !unit.parts.contains(&part) && unit.parts.iter().any(|k| !group.contains(k))
        };
        self.before.iter().any(later) || self.units.iter().any(apart)
    }

    /// Checks whether present parts have order constraints. Their arcs have one direction, so results along `d` do
    /// not transfer to `-d` by reversal of all arcs.
    pub(crate) fn is_ordered(&self, present: &[bool]) -> bool {
        self.before.iter().any(|pair| pair.iter().all(|&part| present[part]))
    }

    /// Checks whether the constraints allow a group to leave all other present parts.
    pub(crate) fn allows_leaving(&self, group: &[usize], present: &[bool]) -> bool {
        !self.order_arcs(present).iter().any(|(a, b)| group.contains(a) && !group.contains(b))
    }

    /// Checks whether no part of a group is forbidden to move along a direction.
    pub(crate) fn allows_direction(&self, group: &[usize], d: DVec3) -> bool {
        let kept = |never: &&ForbiddenDirection| {
            group.contains(&never.part)
                && never.direction.dot(d)
                    >= never.angle_degrees.to_radians().cos() - COSINE_TOLERANCE
        };
        !self.never.iter().any(|never| kept(&never))
    }

    /// Checks whether these parts belong to one unit that stays together.
    pub(crate) fn keeps_together(&self, parts: &[usize]) -> bool {
        let mut units = self.units.iter().filter(|unit| !unit.is_subassembly);
        units.any(|unit| parts.iter().all(|part| unit.parts.contains(part)))
    }

    /// Checks whether other parts must leave after a part.
    pub(crate) fn is_first(&self, part: usize) -> bool {
        self.before.iter().any(|pair| pair[0] == part)
    }

    /// Returns the name of a group if its parts are exactly a named unit.
    pub fn group_name(&self, parts: &[usize]) -> Option<&str> {
        let mut named = self.units.iter().filter(|unit| unit.parts == parts);
        named.find_map(|unit| unit.name.as_deref())
    }
}

impl RigidUnit {
    /// Checks whether the unit may be taken apart because nothing else is present.
    pub(crate) fn is_released(&self, present: &[bool]) -> bool {
        let all = present.iter().filter(|present| **present).count();
        let own = self.parts.iter().filter(|&&part| is_there(present, part)).count();
        self.is_subassembly && all == own
    }
}

/// Checks whether a part is present. Masks may be shorter than the number of parts.
fn is_there(present: &[bool], part: usize) -> bool {
    present.get(part).copied().unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_of(parts: &[usize], apart: bool) -> RigidUnit {
        RigidUnit { name: None, parts: parts.to_vec(), is_subassembly: apart }
    }

    #[test]
    fn cyclic_order_constraints_are_rejected() {
        let name = |k: usize| ["a", "b", "c", "d"][k];
        let mut order = Constraints::default();
        order.add_before([&[0], &[1, 2]], name).unwrap();
        order.add_before([&[1], &[2]], name).unwrap();
        let refused = order.clone().add_before([&[2], &[0]], name).unwrap_err();
        assert!(
            matches!(refused, AssemblyError::CyclicOrder { names } if names == ["a", "b", "c"])
        );
        let refused = order.clone().add_unit(unit_of(&[0, 1], false), name).unwrap_err();
        assert!(matches!(refused, AssemblyError::CyclicOrder { .. }));
        let refused = order.clone().add_before([&[3], &[3]], name).unwrap_err();
        assert!(matches!(refused, AssemblyError::CyclicOrder { names } if names == ["d"]));
        // Patterns may overlap: each part is before all others, but not before itself.
        order.clone().add_before([&[0, 3], &[3]], name).unwrap();
        // The order of parts in a subassembly applies when it is taken apart.
        order.add_unit(unit_of(&[0, 1], true), name).unwrap();
        assert!(order.add_forbidden_direction(3, DVec3::ZERO, 10.0).is_err());
        assert!(order.add_forbidden_direction(3, DVec3::Z, 180.0).is_err());
    }

    #[test]
    fn overlapping_units_merge_and_subassemblies_must_nest() {
        let name = |k: usize| ["a", "b", "c", "d", "e"][k];
        let mut order = Constraints::default();
        order.add_unit(unit_of(&[0, 1], false), name).unwrap();
        order.add_unit(unit_of(&[1, 2], false), name).unwrap();
        assert_eq!(order.units(), [unit_of(&[0, 1, 2], false)]);
        order.add_unit(unit_of(&[2, 3], true), name).unwrap();
        assert_eq!(order.units()[1].parts, [0, 1, 2, 3]);
        order.add_unit(unit_of(&[0, 1, 2, 3, 4], true), name).unwrap();
        let refused = order.clone().add_unit(unit_of(&[3, 4], true), name).unwrap_err();
        assert!(matches!(refused, AssemblyError::OverlappingSubassemblies { .. }));
        // If a subassembly is alone, it may be taken apart, except for parts that stay together.
        let arcs = |present: [bool; 5]| order.order_arcs(&present).len();
        assert_eq!(arcs([true; 5]), 6 + 12);
        assert_eq!(arcs([true, true, true, true, false]), 6);
        assert!(order.keeps_together(&[0, 2]) && !order.keeps_together(&[0, 3]));
    }

    #[test]
    fn directions_within_the_forbidden_angle_are_not_allowed() {
        let mut order = Constraints::default();
        order.add_forbidden_direction(0, DVec3::new(0.0, 0.0, -2.0), 45.0).unwrap();
        let within = DVec3::new(0.0, 1.0, -1.01).normalize();
        let beside = DVec3::new(0.0, 1.0, -0.99).normalize();
        assert!(!order.allows_direction(&[0, 1], within) && order.allows_direction(&[0], beside));
        assert!(order.allows_direction(&[1], within));
    }
}
