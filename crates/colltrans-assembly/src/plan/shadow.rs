//! Parts as seen along a direction, and how far it is there until one is beyond all others.
//!
//! Invariant: what is kept of a travel names the part that it ends behind, and is asked anew once that part has gone.

use colltrans::Aabb;
use glam::DVec3;

use crate::bodies::Bodies;
use crate::part::Part;

/// The parts that are there as seen along a direction.
pub(super) struct Shadow {
    pub(super) direction: DVec3,
    /// In a frame whose third axis is the direction; nothing of parts that are not there.
    boxes: Vec<Aabb>,
    /// By part: its travel alone and the part that it ends behind, once asked.
    travels: Vec<Option<(f64, Option<usize>)>>,
}

impl Shadow {
    pub(super) fn new(bodies: &Bodies, there: &[bool], direction: DVec3) -> Self {
        let (u, v) = direction.any_orthonormal_pair();
        let seen = |p: &DVec3| DVec3::new(p.dot(u), p.dot(v), p.dot(direction));
        let around = |(part, there): (&Part, &bool)| {
            let vertices = there.then(|| part.solid().vertices().iter().map(seen));
            Aabb::of_points(vertices.into_iter().flatten())
        };
        let boxes: Vec<Aabb> = bodies.assembly().parts().iter().zip(there).map(around).collect();
        Self { direction, travels: vec![None; boxes.len()], boxes }
    }

    /// How far a group goes until it is beyond all that are there.
    pub(super) fn travel(&mut self, parts: &[usize], there: &[bool]) -> f64 {
        if let &[part] = parts {
            let boxes = &self.boxes;
            let known = &mut self.travels[part];
            return known.get_or_insert_with(|| past(boxes, part, &[], there)).0;
        }
        let each = parts.iter().map(|&part| past(&self.boxes, part, parts, there).0);
        each.fold(0.0, f64::max)
    }

    /// Parts have gone.
    pub(super) fn update(&mut self, there: &[bool]) {
        for travel in &mut self.travels {
            if travel.is_some_and(|(_, behind)| behind.is_some_and(|b| !there[b])) {
                *travel = None;
            }
        }
    }
}

/// How far a part goes along the third axis until it is beyond all that are there, but for those of its group; and the
/// part that it ends behind.
fn past(boxes: &[Aabb], part: usize, group: &[usize], there: &[bool]) -> (f64, Option<usize>) {
    let own = boxes[part];
    let mut found = (0.0, None);
    for (other, seen) in boxes.iter().enumerate() {
        let way = seen.high.z - own.low.z;
        if way <= found.0 || other == part || !there[other] || group.contains(&other) {
            continue;
        }
        let beside = (0..2).any(|k| seen.low[k] > own.high[k] || own.low[k] > seen.high[k]);
        if !beside {
            found = (way, Some(other));
        }
    }
    found
}
