//! How far parts reach along directions that are asked of all: planes between parts that boxes along the axes of the world
//! do not know of.
//!
//! A machine that is turned has its faces in slanting planes, and the boxes of plates that lie on each other overlap. Between
//! slabs `low <= n . x <= high` along the normals of contacts, which are among the directions asked, there is room.
//! A part that moves by `t d` meets another one only at such `t` for which it does so along each `n`, as of boxes ([`boxes`]).
//!
//! Rounding. With `S` the largest coordinate, `n . x` is off by less than `6 u S` (two of them by `12 u S`), and `n . d` by
//! `3 u`; parts meet at `|t| <= 4 S` or not at all, so that the latter takes `12 u S`: slabs are `64 u S` further
//! apart than computed, and `n . d` of no more than `8 u` counts as 0.

use colltrans::Solid;
use glam::DVec3;
use rayon::prelude::*;

use crate::boxes::{first_meeting, span};

/// Rounding of how far apart slabs are, in multiples of the largest coordinate.
const SLACK: f64 = 32.0 * f64::EPSILON;
/// Directions are orthogonal that are so to within this.
const LEVEL: f64 = 4.0 * f64::EPSILON;

/// The reach of parts along some directions.
pub(crate) struct Slabs {
    /// Of two opposite ones one.
    normals: Vec<DVec3>,
    /// For each part, along each.
    ends: Vec<Vec<[f64; 2]>>,
    slack: f64,
}

impl Slabs {
    /// Of the bodies of each part, with something around them.
    pub(crate) fn new(parts: &[Vec<&Solid>], around: f64, directions: &[DVec3]) -> Self {
        let mut normals: Vec<DVec3> = Vec::new();
        for &d in directions {
            if !normals.iter().any(|&n| n == d || n == -d) {
                normals.push(d);
            }
        }
        let reach = |bodies: &Vec<&Solid>| -> Vec<[f64; 2]> {
            let along = |&n: &DVec3| {
                let places = bodies.iter().flat_map(|body| body.vertices()).map(|p| n.dot(*p));
                let [low, high] = span(places);
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

    /// The least translation at which a part may meet another one, from below; `None` if it never does.
    pub(crate) fn entry(&self, [moving, fixed]: [usize; 2], d: DVec3) -> Option<f64> {
        let (own, other) = (&self.ends[moving], &self.ends[fixed]);
        let each = self.normals.iter().zip(own).zip(other);
        first_meeting(each.map(|((n, [low, high]), [least, most])| {
            let along = n.dot(d);
            let along = if along.abs() <= LEVEL { 0.0 } else { along };
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
    use crate::boxes::entry as entry_of;

    const FACES: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

    /// A box of whole numbers, turned.
    fn block(random: &mut Random, world: DQuat) -> Solid {
        let mut whole =
            |most: f64| DVec3::from_array([0; 3].map(|_| (random.unit() * most).floor()));
        let (low, size) = (whole(8.0), whole(3.0) + 1.0);
        let corner = |k: usize| DVec3::from_array([0, 1, 2].map(|axis| (k >> axis & 1) as f64));
        let vertices: Vec<DVec3> = (0..8).map(|k| world * (low + size * corner(k))).collect();
        Solid::from_mesh(&vertices, &FACES).expect("a box")
    }

    /// Boxes on a grid that is turned, so that they touch, slide and pass each other all the time: no pair that meets is
    /// lost, and of others fewer are kept than by boxes along the axes of the world.
    #[test]
    fn what_meets_is_kept_and_little_else() {
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
                    let entry = slabs.entry([a, b], d);
                    match cast.clearance().expect("an answer") {
                        Clearance::Free(_) => {
                            kept += usize::from(entry.is_some());
                            let by_boxes = entry_of(&bodies[a].bounds(), &bodies[b].bounds(), d);
                            boxed += usize::from(by_boxes.is_some());
                        }
                        Clearance::Blocked { contact, .. } => {
                            met += 1;
                            let least = entry.unwrap_or(f64::INFINITY);
                            lost += usize::from(least > contact.shrunk_distance.upper + 1e-12);
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
