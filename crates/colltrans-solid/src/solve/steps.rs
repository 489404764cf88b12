//! Counters for the work of a query between solids.

/// Work done for one answer between solids: the searches for an overlap at the start, for what blocks the body, and for
/// the least tolerance of an overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidSteps {
    /// Number of pairs of nodes of the two trees that were compared.
    pub nodes: u32,
    /// Number of pairs of leaves whose facets were compared.
    pub leaves: u32,
}

impl std::ops::AddAssign for SolidSteps {
    fn add_assign(&mut self, other: Self) {
        self.nodes += other.nodes;
        self.leaves += other.leaves;
    }
}
