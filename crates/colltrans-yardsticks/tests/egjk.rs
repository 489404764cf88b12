//! Enhanced GJK against the exact distance.

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_oracle::distance::{distance_of_bodies, distance_of_point};
use colltrans_oracle::settings::{FAMILIES, Rng, setting};
use colltrans_yardsticks::Proximity;
use colltrans_yardsticks::egjk::{Egjk, Steps};
use glam::DVec3;

type Placed<'a> = (&'a ConvexPolyhedron, &'a Pose);

fn reach(body: &ConvexPolyhedron) -> f64 {
    body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max)
}

fn size(moving: Placed, fixed: Placed) -> f64 {
    reach(moving.0) + reach(fixed.0) + moving.1.translation().distance(fixed.1.translation())
}

#[derive(Debug, Default)]
struct Worst {
    error: f64,
    gap: f64,
    apart: f64,
    off_body: f64,
    iterations: u32,
}

fn check(name: &str, answer: &Proximity<Steps>, moving: Placed, fixed: Placed, worst: &mut Worst) {
    let exact = distance_of_bodies(moving, fixed);
    let size = size(moving, fixed);
    let world = size + moving.1.translation().length();
    let error = (answer.distance - exact.to_f64()).abs() / size;
    let apart = (answer.on_fixed - answer.on_moving).distance(exact.shortest) / world;
    let off = distance_of_point(answer.on_moving, moving)
        .to_f64()
        .max(distance_of_point(answer.on_fixed, fixed).to_f64())
        / world;
    if error > 1e-14 || answer.steps.gap / size > 1e-14 || apart > 1e-13 || off > 1e-14 {
        println!(
            "{name}: {:e} exact {:e} error {error:e} gap {:e} apart {apart:e} off {off:e} {:?}",
            answer.distance,
            exact.to_f64(),
            answer.steps.gap / size,
            answer.steps
        );
    }
    worst.error = worst.error.max(error);
    worst.gap = worst.gap.max(answer.steps.gap / size);
    worst.apart = worst.apart.max(apart);
    worst.off_body = worst.off_body.max(off);
    worst.iterations = worst.iterations.max(answer.steps.iterations);
}

#[test]
fn families() {
    for (family, _) in FAMILIES {
        let mut worst = Worst::default();
        for seed in 0..400 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().unwrap();
            let moving = (&bodies.moving, &setting.moving_pose);
            let fixed = (&bodies.fixed, &setting.fixed_pose);
            let answer = Egjk::new(moving.0, fixed.0).distance(moving.1, fixed.1);
            check(&setting.to_string(), &answer, moving, fixed, &mut worst);
        }
        println!("{family} {worst:?}");
    }
}
