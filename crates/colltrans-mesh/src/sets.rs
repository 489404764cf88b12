//! Union-find over numbers, with the relative orientation of the members of a set.

/// A partition of `0..n` into sets. Two members of a set have equal or opposite orientation.
pub(crate) struct OrientedSets {
    /// For each number its parent in the tree of its set, and whether their orientations are opposite. A root
    /// is its own parent.
    above: Vec<(usize, bool)>,
}

impl OrientedSets {
    /// Builds a partition in which each number is a set of its own.
    pub(crate) fn new(count: usize) -> Self {
        Self { above: (0..count).map(|k| (k, false)).collect() }
    }

    /// Returns the root of a number's set, which is its smallest member, and whether their orientations are
    /// opposite. Shortens the path to the root.
    pub(crate) fn root(&mut self, number: usize) -> (usize, bool) {
        let (mut first, mut other) = (number, false);
        while self.above[first].0 != first {
            let (above, against) = self.above[first];
            (first, other) = (above, other ^ against);
        }
        let (mut at, mut way) = (number, other);
        while self.above[at].0 != first {
            let (above, against) = self.above[at];
            self.above[at] = (first, way);
            (at, way) = (above, way ^ against);
        }
        (first, other)
    }

    /// Joins the sets of two numbers, whose orientations are opposite if `against`. Returns whether the
    /// orientations are consistent. They may be inconsistent only if both numbers were in one set before.
    pub(crate) fn join(&mut self, a: usize, b: usize, against: bool) -> bool {
        let ((a, x), (b, y)) = (self.root(a), self.root(b));
        let wanted = x ^ y ^ against;
        if a == b {
            return !wanted;
        }
        let (first, second) = (a.min(b), a.max(b));
        self.above[second] = (first, wanted);
        true
    }
}
