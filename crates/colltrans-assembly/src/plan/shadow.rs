//! Projections of the parts along a direction, and the travel until a part is beyond all others.
//!
//! One tree over the boxes of all parts serves every direction. Each direction has its own bounds of the nodes, so
//! that only parts that overlap laterally are visited.
//!
//! Invariant: a cached travel refers to the part behind which it ends, and is dropped when that part is removed.

use std::cell::Cell;
use std::collections::HashMap;

use colltrans::{Aabb, Bounded};
use glam::DVec3;

use crate::bodies::Bodies;
use crate::boxes::RemainingBoxes;
use crate::part::Part;

/// The projections of the present parts along a direction.
pub(super) struct Shadow {
    pub(super) direction: DVec3,
    /// Bounding boxes of the parts in a frame whose third axis is the direction; empty for parts that were absent at
    /// first.
    boxes: Vec<Aabb>,
    /// Bounding box of each node of the tree over all parts.
    bounds: Vec<Aabb>,
    /// Cached travels of single parts.
    travels: HashMap<usize, f64>,
    /// For each part, the parts whose cached travel ends behind it.
    behind: HashMap<usize, Vec<usize>>,
}

impl Shadow {
    pub(super) fn new(bodies: &Bodies, present: &[bool], direction: DVec3) -> Self {
        let (u, v) = direction.any_orthonormal_pair();
        let seen = |p: &DVec3| DVec3::new(p.dot(u), p.dot(v), p.dot(direction));
        let around = |(part, present): (&Part, &bool)| {
            let vertices = present.then(|| part.solid().vertices().iter().map(seen));
            Aabb::from_points(vertices.into_iter().flatten())
        };
        let boxes: Vec<Aabb> = bodies.assembly().parts().iter().zip(present).map(around).collect();
        let bounds = bodies.node_bounds(&boxes);
        let (travels, behind) = (HashMap::new(), HashMap::new());
        Self { direction, boxes, bounds, travels, behind }
    }

    /// Returns the distance that a group travels until it is beyond all other present parts. Caches the result of
    /// single parts.
    pub(super) fn travel_of(
        &mut self,
        bodies: &Bodies,
        parts: &[usize],
        living: &RemainingBoxes,
    ) -> f64 {
        let &[part] = parts else {
            let each = parts.iter().map(|&part| self.travel_past(bodies, part, parts, living).0);
            return each.fold(0.0, f64::max);
        };
        if let Some(&known) = self.travels.get(&part) {
            return known;
        }
        let (travel, last) = self.travel_past(bodies, part, parts, living);
        self.travels.insert(part, travel);
        if let Some(last) = last {
            self.behind.entry(last).or_default().push(part);
        }
        travel
    }

    /// Returns bounds of the distance that a removed group travels until it is beyond all present parts. Caches
    /// nothing.
    pub(super) fn bounded_travel(
        &self,
        bodies: &Bodies,
        parts: &[usize],
        living: &RemainingBoxes,
    ) -> Bounded {
        let all = self.bounds.first().map_or(0.0, |b| b.low.abs().max(b.high.abs()).max_element());
        let found = Cell::new(ZERO_TRAVEL);
        for &part in parts {
            let own = bodies.direction_extents(part, self.direction);
            // The frame is rotated, so coordinates in the world may be larger.
            let reach = own.reach().max(2.0 * all);
            let is_further = |seen: &Aabb| own.may_be_behind(seen, reach, &found.get());
            bodies.visit_highest_first(living, &self.bounds, is_further, |other| {
                if is_further(&self.boxes[other]) {
                    let past = own.travel_beyond(&bodies.direction_extents(other, self.direction));
                    found.set(max_bounded(found.get(), past));
                }
            });
        }
        found.get()
    }

    /// Removes a part, and returns the parts whose cached travel ended behind it.
    pub(super) fn remove(&mut self, part: usize) -> Vec<usize> {
        let behind = self.behind.remove(&part).unwrap_or_default();
        for part in &behind {
            self.travels.remove(part);
        }
        behind
    }

    /// Returns the distance that a part travels along the direction, the third axis of the boxes, until it is beyond
    /// all present parts outside of its group. Also returns the part that requires this distance.
    fn travel_past(
        &self,
        bodies: &Bodies,
        part: usize,
        group: &[usize],
        living: &RemainingBoxes,
    ) -> (f64, Option<usize>) {
        let own = self.boxes[part];
        let found = Cell::new((0.0, None));
        let is_further = |seen: &Aabb| {
            let lateral_gap = |k: usize| seen.low[k] > own.high[k] || own.low[k] > seen.high[k];
            seen.high.z - own.low.z > found.get().0 && !(0..2).any(lateral_gap)
        };
        bodies.visit_highest_first(living, &self.bounds, is_further, |other| {
            if !group.contains(&other) && is_further(&self.boxes[other]) {
                found.set((self.boxes[other].high.z - own.low.z, Some(other)));
            }
        });
        found.get()
    }
}

pub(super) const ZERO_TRAVEL: Bounded = Bounded { value: 0.0, lower: 0.0, upper: 0.0 };

/// Returns the component-wise maximum of two bounded numbers.
pub(super) fn max_bounded(a: Bounded, b: Bounded) -> Bounded {
    Bounded {
        value: a.value.max(b.value),
        lower: a.lower.max(b.lower),
        upper: a.upper.max(b.upper),
    }
}
