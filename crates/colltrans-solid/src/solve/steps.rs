//! How much work an answer about solids was.

/// Work done for one answer between solids: of the searches for an overlap at the start, for what stops
/// the body, and for the least tolerance of an overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidSteps {
    /// Pairs of nodes of the two trees that were looked at.
    pub nodes: u32,
    /// Pairs of leaves, facet by facet.
    pub leaves: u32,
}

impl std::ops::AddAssign for SolidSteps {
    fn add_assign(&mut self, other: Self) {
        self.nodes += other.nodes;
        self.leaves += other.leaves;
    }
}
