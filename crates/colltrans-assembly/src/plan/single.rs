//! Parts that can be taken out alone: most of every plan, without a graph for each step.
//!
//! Invariant: of every part that is there it is known, by direction, how many of the parts that are
//! there it meets; those that meet none are `free`. All steps together look at each meeting once.

use std::collections::BTreeSet;

use crate::matrix::Matrix;

/// Which parts of a group meet nothing else of it.
pub(super) struct Single {
    /// By direction and part.
    met: Vec<Vec<u32>>,
    /// By direction: who is met by whom, sorted.
    met_by: Vec<Vec<[u32; 2]>>,
    /// Directions and parts.
    free: BTreeSet<(usize, usize)>,
    wanted: Vec<bool>,
}

impl Single {
    /// Of the parts that are `alive`, with the arcs of an order; of those, `movable` ones are looked for.
    pub(super) fn new(
        matrix: &Matrix,
        order: &[(usize, usize)],
        alive: &[bool],
        movable: impl Fn(usize) -> bool,
    ) -> Self {
        let wanted: Vec<bool> = (0..alive.len()).map(|k| alive[k] && movable(k)).collect();
        let (mut met, mut met_by, mut free) = (Vec::new(), Vec::new(), BTreeSet::new());
        for k in 0..matrix.directions().len() {
            let mut counts = vec![0; alive.len()];
            let mut by = Vec::new();
            let arcs = matrix.meetings(k).iter().map(|m| (m.moving, m.fixed));
            let arcs = arcs.chain(order.iter().copied());
            for (moving, fixed) in arcs.filter(|(a, b)| alive[*a] && alive[*b]) {
                counts[moving] += 1;
                by.push([fixed as u32, moving as u32]);
            }
            by.sort_unstable();
            let alone = |part: &usize| wanted[*part] && counts[*part] == 0;
            free.extend((0..alive.len()).filter(alone).map(|part| (k, part)));
            met.push(counts);
            met_by.push(by);
        }
        Self { met, met_by, free, wanted }
    }

    /// Directions and the parts that are free along them.
    pub(super) fn all(&self) -> impl Iterator<Item = (usize, usize)> {
        self.free.iter().copied()
    }

    /// A part is there no longer.
    pub(super) fn remove(&mut self, part: usize) {
        self.wanted[part] = false;
        for (k, by) in self.met_by.iter().enumerate() {
            self.free.remove(&(k, part));
            let from = by.partition_point(|m| (m[0] as usize) < part);
            for &[_, moving] in by[from..].iter().take_while(|m| m[0] as usize == part) {
                let moving = moving as usize;
                let count = &mut self.met[k][moving];
                *count -= 1;
                if *count == 0 && self.wanted[moving] {
                    self.free.insert((k, moving));
                }
            }
        }
    }
}
