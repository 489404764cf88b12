//! Common parts of the tests of V-Clip and H-Walk: settings, and exact distances.

#![allow(unreachable_pub, reason = "shared by files of this program")]

use std::f64::consts::TAU;

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_testkit::oracle::distance::{distance_of_bodies, distance_of_point};
use colltrans_testkit::oracle::scene::size;
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::reach;
use glam::{DQuat, DVec2, DVec3};

/// Two placed solids.
#[derive(Debug, Clone)]
pub struct Placed {
    pub name: String,
    pub moving: ConvexPolyhedron,
    pub fixed: ConvexPolyhedron,
    pub moving_pose: Pose,
    pub fixed_pose: Pose,
}

impl Placed {
    /// Returns the size of the configuration.
    pub fn size(&self) -> f64 {
        let vertices = [self.moving.vertices(), self.fixed.vertices()];
        size(vertices, [&self.moving_pose, &self.fixed_pose])
    }

    /// Moves the body along the shortest vector until the distance is about `gap`.
    pub fn at_gap(&self, gap: f64) -> Self {
        let exact = self.exact();
        let share = 1.0 - gap / exact.to_f64();
        let moving_pose = self.moving_pose.translated_by(exact.shortest * share).unwrap();
        Self { name: format!("{} at {gap:e}", self.name), moving_pose, ..self.clone() }
    }

    fn exact(&self) -> colltrans_testkit::oracle::distance::Distance {
        distance_of_bodies((&self.moving, &self.moving_pose), (&self.fixed, &self.fixed_pose))
    }

    /// Returns the error of a distance, as a share of the size.
    pub fn error(&self, distance: f64) -> f64 {
        (distance - self.exact().to_f64()).abs() / self.size()
    }

    /// Returns the largest error of nearest points, as a share of the size and of their coordinates: their distances
    /// from the bodies, and the difference of their distance from `distance`.
    pub fn error_of_points(&self, distance: f64, on_moving: DVec3, on_fixed: DVec3) -> f64 {
        let of_point = |x, body, pose| distance_of_point(x, (body, pose)).to_f64();
        let errors = [
            (distance - on_moving.distance(on_fixed)).abs(),
            of_point(on_moving, &self.moving, &self.moving_pose),
            of_point(on_fixed, &self.fixed, &self.fixed_pose),
        ];
        let place = self.moving_pose.translation().length();
        errors.into_iter().fold(0.0, f64::max) / (self.size() + place)
    }
}

/// Returns random solids of 4 to 20 vertices: apart, at gaps down to nothing, overlapping, nested.
pub fn random_settings(count: u64) -> impl Iterator<Item = Placed> {
    (0..count).map(|seed| {
        let mut rng = Random::new(seed);
        let mut solid = || {
            let (n, axes) =
                (rng.int(4, 20), DVec3::from_array([0; 3].map(|_| rng.range(0.3, 1.5))));
            let points: Vec<DVec3> = (0..n).map(|_| rng.direction() * axes).collect();
            ConvexPolyhedron::from_points(&points).unwrap()
        };
        let (moving, fixed) = (solid(), solid());
        let distance = rng.range(3.0, 6.0);
        let at = rng.direction() * distance;
        let moving_pose = Pose::new(rng.rotation(), rng.vector()).unwrap();
        let fixed_pose = Pose::new(rng.rotation(), moving_pose.translation() + at).unwrap();
        let apart =
            Placed { name: format!("random {seed}"), moving, fixed, moving_pose, fixed_pose };
        match seed % 5 {
            0 => apart,
            1 => apart.at_gap(10.0_f64.powf(rng.range(-9.0, -3.0))),
            2 => apart.at_gap(0.0),
            3 => apart.at_gap(-rng.range(0.0, 0.8)),
            _ => nested(&apart),
        }
    })
}

/// Places the moving body, scaled to a tenth of its size, in the middle of the fixed one.
fn nested(apart: &Placed) -> Placed {
    let small: Vec<DVec3> = apart.moving.vertices().iter().map(|v| v * 0.1).collect();
    let vertices = apart.fixed.vertices();
    let middle = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
    let at = apart.fixed_pose.transform_point(middle);
    Placed {
        name: format!("{} nested", apart.name),
        moving: ConvexPolyhedron::from_points(&small).unwrap(),
        moving_pose: Pose::new(apart.moving_pose.rotation(), at).unwrap(),
        ..apart.clone()
    }
}

/// Returns the hard families of the oracle, solids only, unchanged and moved to a gap, to contact and to overlap.
pub fn hard_settings(seeds: u64) -> impl Iterator<Item = Placed> {
    FAMILIES
        .iter()
        .flat_map(move |&(family, _)| (0..seeds).map(move |seed| (family, seed)))
        .filter_map(|(family, seed)| {
            let drawn = setting(family, seed);
            let bodies = drawn.bodies().ok()?;
            if bodies.moving.dimension() < 3 || bodies.fixed.dimension() < 3 {
                return None;
            }
            let placed = Placed {
                name: format!("{family}:{seed}"),
                moving: bodies.moving,
                fixed: bodies.fixed,
                moving_pose: drawn.moving_pose,
                fixed_pose: drawn.fixed_pose,
            };
            let (size, distance) = (placed.size(), placed.exact().to_f64());
            if distance <= 1e-12 * size {
                return Some(placed);
            }
            Some(match seed % 4 {
                0 | 1 => placed,
                2 => placed.at_gap(0.0),
                _ => placed.at_gap(1e-6 * distance),
            })
        })
}

/// Returns prisms and double cones over polygons with many sides: wide faces, and vertices with many neighbours. They
/// are stacked or side by side, in contact or slightly apart, and possibly slightly tilted.
pub fn wide_settings() -> impl Iterator<Item = Placed> {
    let ring = (0..200).map(|k| DVec3::from((DVec2::from_angle(TAU * f64::from(k) / 200.0), -0.5)));
    let prism: Vec<DVec3> = ring.clone().flat_map(|p| [p, p + DVec3::Z]).collect();
    let cone: Vec<DVec3> = ring.chain([DVec3::Z, DVec3::NEG_Z]).collect();
    let solids = [prism, cone].map(|points| ConvexPolyhedron::from_points(&points).unwrap());
    let (axis, aslant) = (DVec3::new(0.6, 0.8, 0.0), DVec3::new(1.0, 0.3, 1.0));
    let places = [DVec3::ZERO, DVec3::Z, DVec3::Z * 2.0, DVec3::X * 2.0, aslant, aslant * 0.1];
    let mut settings = Vec::new();
    for body in solids {
        for place in places {
            for (gap, tilt) in [(0.0, 0.0), (0.0, 1e-12), (1e-9, 0.0), (1e-9, 1e-9), (1e-6, 1e-5)] {
                let at = place * (1.0 + gap);
                settings.push(Placed {
                    name: format!("wide, {} faces at {at} by {tilt:e}", body.face_count()),
                    moving: body.clone(),
                    fixed: body.clone(),
                    moving_pose: Pose::new(DQuat::from_axis_angle(axis, tilt), DVec3::ZERO)
                        .unwrap(),
                    fixed_pose: Pose::from_translation(at).unwrap(),
                });
            }
        }
    }
    settings.into_iter()
}

/// Returns random ellipsoids with `n` vertices and semi-axes from 0.6 to 1.4, about as far apart as they are large.
pub fn large(n: usize, seed: u64) -> Placed {
    let mut rng = Random::new(seed);
    let mut ellipsoid = || {
        let axes = DVec3::from_array([0; 3].map(|_| rng.range(0.6, 1.4)));
        let points: Vec<DVec3> = (0..n).map(|_| rng.direction() * axes).collect();
        ConvexPolyhedron::from_points(&points).unwrap()
    };
    let (moving, fixed) = (ellipsoid(), ellipsoid());
    let moving_pose = Pose::new(rng.rotation(), rng.vector()).unwrap();
    let at = moving_pose.translation() + rng.direction() * rng.range(3.0, 4.0);
    let fixed_pose = Pose::new(rng.rotation(), at).unwrap();
    Placed { name: format!("large {seed}"), moving, fixed, moving_pose, fixed_pose }
}

/// Returns poses of the moving body that rotate about a fixed axis and pass the other body, by `share` of its size in
/// each step.
pub fn coherent(placed: &Placed, share: f64, steps: u32, seed: u64) -> Vec<Pose> {
    let mut rng = Random::new(seed);
    let (axis, along) = (rng.direction(), rng.direction());
    let reach = reach(placed.moving.vertices());
    let poses = (0..steps).map(|k| {
        let turn = DQuat::from_axis_angle(axis, share * f64::from(k));
        let rotation = (turn * placed.moving_pose.rotation()).normalize();
        let at = placed.moving_pose.translation() + along * reach * share * f64::from(k);
        Pose::new(rotation, at).unwrap()
    });
    poses.collect()
}

/// Returns the numbers of pairs examined by a solver from scratch and by one with coherence, along a motion. `ask`
/// returns the distances and the pairs of both at a pose; the distances must agree.
pub fn pairs_from_scratch_and_coherent(
    placed: &Placed,
    seed: u64,
    mut ask: impl FnMut(&Pose) -> [(f64, u32); 2],
) -> [u32; 2] {
    let poses = coherent(placed, 0.0025, 200, seed);
    ask(&poses[0]);
    let mut pairs = [0; 2];
    for pose in &poses {
        let [expected, answer] = ask(pose);
        let difference = (expected.0 - answer.0).abs();
        assert!(difference <= 1e-14 * placed.size(), "{seed}: {difference:e}");
        pairs = [pairs[0] + expected.1, pairs[1] + answer.1];
    }
    pairs
}
