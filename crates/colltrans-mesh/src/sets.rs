//! Disjoint sets of numbers that grow together, each member one way round or the other.

/// Disjoint sets of `0..n`.
pub(crate) struct Sets {
    /// A member of the same set that is nearer to its first one, and whether they are one way round.
    above: Vec<(usize, bool)>,
}

impl Sets {
    /// Each number alone.
    pub(crate) fn new(count: usize) -> Self {
        Self { above: (0..count).map(|k| (k, false)).collect() }
    }

    /// What stands for the set of a number, and whether the number is the other way round than that.
    pub(crate) fn find(&mut self, number: usize) -> (usize, bool) {
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

    /// Joins the sets of two, which are the other way round than each other if `against`; whether they are
    /// that way, which they may not be if they were in one set before.
    pub(crate) fn join(&mut self, a: usize, b: usize, against: bool) -> bool {
        let ((a, x), (b, y)) = (self.find(a), self.find(b));
        let wanted = x ^ y ^ against;
        if a == b {
            return !wanted;
        }
        let (first, second) = (a.min(b), a.max(b));
        self.above[second] = (first, wanted);
        true
    }
}
