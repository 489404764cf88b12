//! An exploded view along the moves of the plan: the parts of each step are just beyond the parts that they
//! must pass.
//!
//! The steps are processed backwards. The parts of a step are moved along its direction until their boxes, in
//! the frame of this direction, are beyond the displaced boxes of all remaining parts that overlap them
//! laterally.

use std::collections::HashMap;
use std::ops::Range;

use colltrans::Aabb;
use glam::{DMat3, DVec3};

use super::{Analysis, displacement_before_last_move, present_parts};
use crate::matrix::direction_bits;
use crate::plan::Step;

/// Distance between two parts, as a share of the assembly's size.
const GAP: f64 = 0.05;

/// Displacements of an exploded view.
pub(super) struct Exploded {
    /// For each part, its displacement.
    pub by: Vec<DVec3>,
    /// For each step, the line of its last move, through the middle of its parts.
    pub traces: Vec<[DVec3; 2]>,
}

impl Exploded {
    /// Computes the displacements.
    pub(super) fn new(f: &Analysis) -> Self {
        let Aabb { low, high } = f.bodies.assembly().bounds();
        let gap = GAP * (high - low).length();
        let mut by = vec![DVec3::ZERO; f.bodies.len()];
        let mut own = Vec::new();
        let mut boxes = Boxes { f, known: HashMap::new() };
        for stage in f.plan.stages().into_iter().rev() {
            let steps = &f.plan.steps[stage.clone()];
            let far = boxes.clearing_distance(&stage, &by, gap);
            for step in steps {
                let way = step.direction * far;
                for &part in &step.parts {
                    by[part] += displacement_before_last_move(step, part) + way;
                }
                own.push((step, way));
            }
        }
        let traces = own.into_iter().map(|(step, way)| {
            let middle = step_center(f, step) + by[step.parts[0]];
            [middle - way, middle]
        });
        let traces = traces.collect();
        Self { by, traces }
    }
}

/// Returns the centre of the box of the parts of a step, at their places.
fn step_center(f: &Analysis, step: &Step) -> DVec3 {
    let boxes = step.parts.iter().map(|&part| f.bodies.bounds(part));
    boxes.reduce(|a, b| a.union(&b)).map_or(DVec3::ZERO, |all| all.center())
}

/// Boxes of all parts in frames of directions, with the direction as the third axis.
struct Boxes<'a> {
    f: &'a Analysis<'a>,
    known: HashMap<[u64; 3], (DMat3, Vec<Aabb>)>,
}

impl Boxes<'_> {
    /// Returns the distance that the parts of a stage must move, after all but their last moves, to be beyond
    /// all remaining parts.
    fn clearing_distance(&mut self, stage: &Range<usize>, by: &[DVec3], gap: f64) -> f64 {
        let f = self.f;
        let steps = &f.plan.steps[stage.clone()];
        let moving = |part: usize| steps.iter().any(|step| step.parts.contains(&part));
        let left: Vec<usize> =
            present_parts(f, stage.start).filter(|&part| !moving(part)).collect();
        let mut far = gap;
        for step in steps {
            let &(to_frame, ref boxes) = self.frame_and_boxes(step.direction);
            let placed = |part: usize, more: DVec3| {
                let by = to_frame * (by[part] + more);
                let Aabb { low, high } = boxes[part];
                Aabb { low: low + by, high: high + by }
            };
            for &a in &step.parts {
                let own = placed(a, displacement_before_last_move(step, a));
                for other in left.iter().map(|&b| placed(b, DVec3::ZERO)) {
                    let lateral_gap =
                        (own.low.max(other.low) - own.high.min(other.high)).truncate();
                    if lateral_gap.max_element() < 0.0 {
                        far = far.max(other.high.z - own.low.z + gap);
                    }
                }
            }
        }
        far
    }

    /// Returns the frame of a direction and the boxes in it, computed once.
    fn frame_and_boxes(&mut self, d: DVec3) -> &(DMat3, Vec<Aabb>) {
        let parts = self.f.bodies.assembly().parts();
        self.known.entry(direction_bits(d)).or_insert_with(|| {
            let (u, v) = d.any_orthonormal_pair();
            let to_frame = DMat3::from_cols(u, v, d).transpose();
            let around = |part: &crate::part::Part| {
                let all = part.solid().vertices().iter().map(|&p| to_frame * p);
                all.fold(Aabb { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY }, |b, p| Aabb {
                    low: b.low.min(p),
                    high: b.high.max(p),
                })
            };
            (to_frame, parts.iter().map(around).collect())
        })
    }
}
