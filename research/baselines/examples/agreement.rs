//! Compares the distances of enhanced GJK, PQP, H-Walk and V-Clip on random pairs of solids: separated, near,
//! touching and overlapping.
//!
//! ```text
//! cargo run --release -p colltrans-baselines --example agreement -- [PAIRS] [SEED]
//! ```
//! Prints the largest difference as a share of the size; the exit code is 1 if it exceeds 1e-9.

use std::process::ExitCode;

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_baselines::egjk::Egjk;
use colltrans_baselines::hwalk::{HWalk, Hierarchy};
use colltrans_baselines::pqp::{Pqp, Soup};
use colltrans_baselines::vclip::{Shell, VClip};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::reach;
use glam::DVec3;

/// Pairs of places for one pair of bodies.
const PLACES: u64 = 50;

/// Largest disagreement, as a share of the size.
const AGREEMENT: f64 = 1e-9;

const KINDS: [&str; 4] = ["separated", "near", "touching", "overlapping"];

fn main() -> ExitCode {
    let mut words = std::env::args().skip(1).map(|word| word.parse::<u64>());
    let (Ok(pairs), Ok(seed)) =
        (words.next().unwrap_or(Ok(100_000)), words.next().unwrap_or(Ok(1)))
    else {
        eprintln!("agreement [PAIRS] [SEED]");
        return ExitCode::from(2);
    };
    let mut worst = [0.0_f64; KINDS.len()];
    let mut counts = [0_u64; KINDS.len()];
    let mut gave_up = 0;
    for round in 0..pairs.div_ceil(PLACES) {
        let mut rng = Random::new(seed.wrapping_mul(1_000_003) + round);
        let bodies = [solid(&mut rng), solid(&mut rng)];
        let mut contest = Contest::new(&bodies);
        contest.place(&mut rng, |kind, size, answers, unproven| {
            let spread = answers.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                - answers.iter().copied().fold(f64::INFINITY, f64::min);
            worst[kind] = worst[kind].max(spread / size);
            counts[kind] += 1;
            gave_up += u64::from(unproven);
        });
    }
    for (kind, name) in KINDS.iter().enumerate() {
        println!(
            "{name:<12} {:>8} pairs, worst disagreement {:.2e} of the size",
            counts[kind], worst[kind]
        );
    }
    println!("answers without a proof: {gave_up}");
    let holds = worst.iter().all(|&w| w <= AGREEMENT) && gave_up == 0;
    if holds { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Returns points on an ellipsoid, round or stretched; some in rings, with many parallel edges.
fn solid(rng: &mut Random) -> ConvexPolyhedron {
    let axes = DVec3::from_array([0; 3].map(|_| 10.0_f64.powf(rng.range(-1.0, 0.3))));
    let count = rng.int(4, 60);
    let rings = rng.one_in(3);
    let points: Vec<DVec3> = (0..count)
        .map(|k| {
            let point = if rings {
                let angle = (k % 8) as f64 * std::f64::consts::FRAC_PI_4;
                let height = (k / 8) as f64 / 4.0 - 1.0;
                let radius = (1.0 - 0.8 * height * height).sqrt();
                DVec3::new(radius * angle.cos(), radius * angle.sin(), height)
            } else {
                rng.direction()
            };
            point * axes
        })
        .collect();
    let body = ConvexPolyhedron::from_points(&points).expect("a body");
    if body.dimension() == 3 { body } else { solid(rng) }
}

struct Contest<'a> {
    bodies: &'a [ConvexPolyhedron; 2],
    shells: [Shell; 2],
    hierarchies: [Hierarchy; 2],
    soups: [Soup; 2],
}

impl<'a> Contest<'a> {
    fn new(bodies: &'a [ConvexPolyhedron; 2]) -> Self {
        Self {
            bodies,
            shells: bodies.each_ref().map(|b| Shell::new(b).expect("a solid")),
            hierarchies: bodies.each_ref().map(|b| Hierarchy::new(b).expect("a solid")),
            soups: bodies.each_ref().map(Soup::of_polyhedron),
        }
    }

    /// Measures some placements with all algorithms, each with its coherence.
    fn place(&mut self, rng: &mut Random, mut note: impl FnMut(usize, f64, &[f64], bool)) {
        let [p, q] = self.bodies;
        let (mut egjk, mut vclip) = (Egjk::new(p, q), VClip::new(&self.shells[0], &self.shells[1]));
        let mut hwalk = HWalk::new(&self.hierarchies[0], &self.hierarchies[1]).with_patience(5);
        let mut pqp = Pqp::new(&self.soups[0], &self.soups[1]);
        let size = reach(p.vertices()) + reach(q.vertices());
        for place in 0..PLACES {
            let kind = place as usize % KINDS.len();
            let at = rng.direction() * size * rng.range(1.0, 2.0);
            let fixed = Pose::new(rng.rotation(), DVec3::ZERO).expect("a pose");
            let start = Pose::new(rng.rotation(), at).expect("a pose");
            let apart = egjk.distance(&start, &fixed);
            let gap = match kind {
                0 => apart.distance,
                1 => 10.0_f64.powf(rng.range(-9.0, -2.0)) * size,
                2 => 0.0,
                _ => -10.0_f64.powf(rng.range(-9.0, -2.0)) * size,
            };
            let way = apart.on_fixed - apart.on_moving;
            let offset = way * (1.0 - gap / apart.distance);
            let moving = start.translated_by(offset).expect("a pose");
            let walked = vclip.distance(&moving, &fixed);
            let hierarchical = hwalk.distance(&moving, &fixed);
            let answers = [
                egjk.distance(&moving, &fixed).distance,
                walked.distance,
                hierarchical.distance,
                pqp.distance(&moving, &fixed).distance,
            ];
            let unproven = walked.steps.gave_up || hierarchical.steps.gave_up;
            note(kind, size + moving.translation().length(), &answers, unproven);
        }
    }
}
