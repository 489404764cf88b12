//! Extents of parts along the normals of contacts: slabs that separate parts whose axis-aligned boxes
//! overlap.
//!
//! In a machine that is rotated against the world axes, the boxes of plates in contact overlap, but their
//! slabs `low <= n . x <= high` along the contact normals `n` do not. A part that moves by `t d` can meet
//! another one only at values of `t` at which their slabs meet for every `n`, as for [`boxes`](crate::boxes).
//!
//! Rounding, with the largest coordinate `S`:
//! - `n . x` has an error below `6 u S` (two products: `12 u S`), and `n . d` one below `3 u`.
//! - Parts meet at `|t| <= 4 S` or never, therefore the error of `n . d` contributes `12 u S`.
//! - Slabs are widened by `64 u S`, and `n . d` of at most `8 u` counts as 0.

use colltrans::Solid;
use glam::DVec3;
use rayon::prelude::*;

use crate::boxes::{first_meeting, value_range};

/// Widening of the distance of slabs, in multiples of the largest coordinate.
const SLACK: f64 = 32.0 * f64::EPSILON;
/// Bound on `|n . d|` below which directions count as orthogonal.
const MAX_ORTHOGONAL_DOT: f64 = 4.0 * f64::EPSILON;

/// Extents of all parts along some directions.
pub(crate) struct Slabs {
    /// The directions, without opposite ones.
    normals: Vec<DVec3>,
    /// For each part and each direction, the lower and the upper end.
    ends: Vec<Vec<[f64; 2]>>,
    slack: f64,
}

impl Slabs {
    /// Computes the extents of the bodies of each part, widened by `around`.
    pub(crate) fn new(parts: &[Vec<&Solid>], around: f64, directions: &[DVec3]) -> Self {
        let mut normals: Vec<DVec3> = Vec::new();
        for &d in directions {
            if !normals.iter().any(|&n| n == d || n == -d) {
                normals.push(d);
            }
        }
        let reach = |bodies: &Vec<&Solid>| -> Vec<[f64; 2]> {
            let along = |&n: &DVec3| {
                let coordinates = bodies.iter().flat_map(|body| body.vertices()).map(|p| n.dot(*p));
                let [low, high] = value_range(coordinates);
                [low - around, high + around]
            };
            normals.iter().map(along).collect()
        };
        let ends = parts.par_iter().map(reach).collect();
        let bounds = parts.iter().flatten().map(|body| body.bounds());
        let sizes = bounds.map(|b| b.low.abs().max(b.high.abs()).max_element());
        let size = sizes.fold(0.0, f64::max) + around;
        Self { normals, ends, slack: SLACK * size }
    }

    /// Returns a lower bound of the translation at which a part may meet another one; `None` if it never
    /// does.
    pub(crate) fn entry_translation(&self, [moving, fixed]: [usize; 2], d: DVec3) -> Option<f64> {
        let (own, other) = (&self.ends[moving], &self.ends[fixed]);
        let each = self.normals.iter().zip(own).zip(other);
        first_meeting(each.map(|((n, [low, high]), [least, most])| {
            let along = n.dot(d);
            let along = if along.abs() <= MAX_ORTHOGONAL_DOT { 0.0 } else { along };
            ([least - high - self.slack, most - low + self.slack], along)
        }))
    }
}

#[cfg(test)]
mod tests {
    use colltrans::{Cast, Clearance, Pose};
    use colltrans_testkit::random::Random;
    use glam::DQuat;

    use super::*;
    use crate::boxes::entry_translation;

    const FACES: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

    /// Returns a rotated box with integer sides and corners.
    fn block(random: &mut Random, world: DQuat) -> Solid {
        let mut whole =
            |most: f64| DVec3::from_array([0; 3].map(|_| (random.unit() * most).floor()));
        let (low, size) = (whole(8.0), whole(3.0) + 1.0);
        let corner = |k: usize| DVec3::from_array([0, 1, 2].map(|axis| (k >> axis & 1) as f64));
        let vertices: Vec<DVec3> = (0..8).map(|k| world * (low + size * corner(k))).collect();
        Solid::from_mesh(&vertices, &FACES).expect("a box")
    }

    /// Tests boxes on a rotated grid, which often touch and slide. Pairs that meet must never be excluded. Of
    /// the other pairs, slabs must exclude more than axis-aligned boxes.
    #[test]
    fn slabs_keep_all_contacts_and_exclude_more_than_boxes() {
        let mut random = Random::new(12);
        let [mut met, mut kept, mut boxed, mut lost] = [0; 4];
        for round in 0..60 {
            let world = if round % 3 == 0 { DQuat::IDENTITY } else { random.rotation() };
            let bodies: Vec<Solid> = (0..6).map(|_| block(&mut random, world)).collect();
            let parts: Vec<Vec<&Solid>> = bodies.iter().map(|body| vec![body]).collect();
            let axes = DVec3::AXES.map(|axis| world * axis);
            let slabs = Slabs::new(&parts, 0.0, &[axes[0], axes[1], axes[2], -axes[0]]);
            assert_eq!(slabs.normals.len(), 3);
            let skew = random.direction();
            for d in axes.into_iter().chain(axes.map(|axis| -axis)).chain([skew]) {
                for (a, b) in
                    (0..6).flat_map(|a| (0..6).map(move |b| (a, b))).filter(|(a, b)| a != b)
                {
                    let place = |k: usize| bodies[k].at(Pose::IDENTITY);
                    let cast = Cast::new(place(a), place(b), d).expect("a cast");
                    let entry = slabs.entry_translation([a, b], d);
                    match cast.clearance().expect("an answer") {
                        Clearance::Free(_) => {
                            kept += usize::from(entry.is_some());
                            let by_boxes =
                                entry_translation(&bodies[a].bounds(), &bodies[b].bounds(), d);
                            boxed += usize::from(by_boxes.is_some());
                        }
                        Clearance::Blocked { contact, .. } => {
                            met += 1;
                            let least = entry.unwrap_or(f64::INFINITY);
                            lost += usize::from(least > contact.offset_distance.upper + 1e-12);
                        }
                        Clearance::Overlapping(_) => lost += usize::from(entry.is_none()),
                    }
                }
            }
        }
        assert!(lost == 0 && met > 800, "{lost} of {met}");
        assert!(kept < boxed / 2, "{kept}, {boxed} by boxes");
    }
}
