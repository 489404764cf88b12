//! An exploded view along the plan's own ways: each step's parts stand just beyond what they have to pass.
//!
//! The steps are walked backwards. What a step takes away is moved along its direction until, in the frame of that
//! direction, its box lies beyond the boxes of all that it leaves behind, where those stand by then, as far as they are
//! beside its way.

use std::collections::HashMap;
use std::ops::Range;

use colltrans::Aabb;
use glam::{DMat3, DVec3};

use super::{Findings, aside, there};
use crate::matrix::direction_bits;
use crate::plan::Step;

/// The room between two parts, as a share of the assembly's size.
const GAP: f64 = 0.05;

/// Where everything stands.
pub(super) struct Exploded {
    /// By how much each part is displaced.
    pub by: Vec<DVec3>,
    /// The last way of each step, from where its middle would be without it.
    pub traces: Vec<[DVec3; 2]>,
}

impl Exploded {
    pub(super) fn new(f: &Findings) -> Self {
        let Aabb { low, high } = f.bodies.assembly().bounds();
        let gap = GAP * (high - low).length();
        let mut by = vec![DVec3::ZERO; f.bodies.len()];
        let mut own = Vec::new();
        let mut boxes = Boxes { f, known: HashMap::new() };
        for stage in f.plan.stages().into_iter().rev() {
            let steps = &f.plan.steps[stage.clone()];
            let far = boxes.beyond(&stage, &by, gap);
            for step in steps {
                let way = step.direction * far;
                for &part in &step.parts {
                    by[part] += aside(step, part) + way;
                }
                own.push((step, way));
            }
        }
        let traces = own.into_iter().map(|(step, way)| {
            let middle = middle(f, step) + by[step.parts[0]];
            [middle - way, middle]
        });
        let traces = traces.collect();
        Self { by, traces }
    }
}

/// The middle of what a step takes away, in its place.
fn middle(f: &Findings, step: &Step) -> DVec3 {
    let boxes = step.parts.iter().map(|&part| f.bodies.bounds(part));
    boxes.reduce(|a, b| a.join(&b)).map_or(DVec3::ZERO, |all| all.center())
}

/// Boxes of all parts in frames of directions, which are the third axis.
struct Boxes<'a> {
    f: &'a Findings<'a>,
    known: HashMap<[u64; 3], (DMat3, Vec<Aabb>)>,
}

impl Boxes<'_> {
    /// How far the parts of a stage have to go, beside what they do before their last move, to be beyond all that is left.
    fn beyond(&mut self, stage: &Range<usize>, by: &[DVec3], gap: f64) -> f64 {
        let f = self.f;
        let steps = &f.plan.steps[stage.clone()];
        let moving = |part: usize| steps.iter().any(|step| step.parts.contains(&part));
        let left: Vec<usize> = there(f, stage.start).filter(|&part| !moving(part)).collect();
        let mut far = gap;
        for step in steps {
            let &(to_frame, ref boxes) = self.along(step.direction);
            let placed = |part: usize, more: DVec3| {
                let by = to_frame * (by[part] + more);
                let Aabb { low, high } = boxes[part];
                Aabb { low: low + by, high: high + by }
            };
            for &a in &step.parts {
                let own = placed(a, aside(step, a));
                for other in left.iter().map(|&b| placed(b, DVec3::ZERO)) {
                    let beside = (own.low.max(other.low) - own.high.min(other.high)).truncate();
                    if beside.max_element() < 0.0 {
                        far = far.max(other.high.z - own.low.z + gap);
                    }
                }
            }
        }
        far
    }

    fn along(&mut self, d: DVec3) -> &(DMat3, Vec<Aabb>) {
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
