//! H-Walk against the exact distance, and against V-Clip on large bodies.

mod walks;

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_oracle::settings::Rng;
use colltrans_yardsticks::hwalk::{HWalk, Hierarchy};
use colltrans_yardsticks::vclip::{Shell, VClip};
use walks::{ACCURACY, Placed, coherent, hard_settings, large, random_settings, worst_of};

fn solver_error(placed: &Placed) -> f64 {
    let [moving, fixed] = [&placed.moving, &placed.fixed].map(|b| Hierarchy::new(b).unwrap());
    let mut solver = HWalk::new(&moving, &fixed).with_patience(2);
    let scratch = solver.distance(&placed.moving_pose, &placed.fixed_pose);
    let again = solver.distance(&placed.moving_pose, &placed.fixed_pose);
    let verdict = placed.verdict(
        scratch.distance,
        scratch.on_moving,
        scratch.on_fixed,
        scratch.steps.gave_up || again.steps.gave_up,
    );
    verdict.max((scratch.distance - again.distance).abs() / placed.size())
}

#[test]
fn random_solids() {
    let (worst, name) = worst_of(random_settings(2_000), solver_error);
    assert!(worst <= ACCURACY, "{name}: {worst:e}");
}

#[test]
fn tied_solids() {
    let (worst, name) = worst_of(hard_settings(150), solver_error);
    assert!(worst <= ACCURACY, "{name}: {worst:e}");
}

#[test]
fn a_hierarchy_has_few_layers_and_little_more_vertices_than_the_body() {
    let mut rng = Rng::new(3);
    for n in [20, 300, 5_000] {
        let points: Vec<_> = (0..n).map(|_| rng.direction()).collect();
        let body = ConvexPolyhedron::from_points(&points).unwrap();
        let hierarchy = Hierarchy::new(&body).unwrap();
        assert!(hierarchy.vertex_count() < 6 * n, "{n}: {}", hierarchy.vertex_count());
        let layers = hierarchy.layer_count() as f64;
        assert!(layers < 6.0 * (n as f64).log2(), "{n}: {layers} layers");
    }
}

#[test]
fn large_solids_agree_with_v_clip_at_every_patience() {
    let mut rng = Rng::new(11);
    for (n, settings) in [(2_000, 20), (20_000, 4)] {
        for placed in large(n, settings, &mut rng) {
            let shells = [&placed.moving, &placed.fixed].map(|body| Shell::new(body).unwrap());
            let walks = [&placed.moving, &placed.fixed].map(|body| Hierarchy::new(body).unwrap());
            let reference = VClip::new(&shells[0], &shells[1])
                .distance(&placed.moving_pose, &placed.fixed_pose);
            for patience in [1, 5, 20, 1_000_000] {
                let mut solver = HWalk::new(&walks[0], &walks[1]).with_patience(patience);
                for at in coherent(&placed, 0.05, 6, &mut rng) {
                    let tracked = solver.distance(&at.moving_pose, &at.fixed_pose);
                    let fresh = VClip::new(&shells[0], &shells[1])
                        .distance(&at.moving_pose, &at.fixed_pose);
                    let difference = (tracked.distance - fresh.distance).abs() / at.size();
                    assert!(difference <= ACCURACY, "{} {patience}: {difference:e}", at.name);
                    assert!(!tracked.steps.gave_up, "{}", at.name);
                }
                solver.reset();
                let again = solver.distance(&placed.moving_pose, &placed.fixed_pose);
                let difference = (again.distance - reference.distance).abs() / placed.size();
                assert!(difference <= ACCURACY, "{} {patience}: {difference:e}", placed.name);
                // From scratch through the layers, the way is short whatever the size.
                assert!(again.steps.pairs < 400, "{}: {:?}", placed.name, again.steps);
            }
        }
    }
}

#[test]
fn coherence_and_shortcuts_save_steps() {
    let mut rng = Rng::new(12);
    let placed = large(20_000, 1, &mut rng).remove(0);
    let walks = [&placed.moving, &placed.fixed].map(|body| Hierarchy::new(body).unwrap());
    let pairs = |sequence: &[Placed], patience: u32| {
        let mut solver = HWalk::new(&walks[0], &walks[1]).with_patience(patience);
        let steps = sequence
            .iter()
            .map(|at| solver.distance(&at.moving_pose, &at.fixed_pose).steps.pairs)
            .collect::<Vec<_>>();
        steps[1..].iter().sum::<u32>()
    };
    let near = coherent(&placed, 1e-4, 30, &mut rng);
    // Half a turn about each other and about themselves from one to the next.
    let far: Vec<Placed> = (0..30)
        .map(|k| {
            let side = if k % 2 == 0 { 1.0 } else { -1.0 };
            let at = placed.moving_pose.translation() * side;
            let moving_pose = Pose::new(rng.rotation(), at).unwrap();
            Placed { moving_pose, ..placed.clone() }
        })
        .collect();
    let (near, short, long) = (pairs(&near, 5), pairs(&far, 5), pairs(&far, 1_000_000));
    println!("pairs of features: coherent {near}, far {short}, far without shortcuts {long}");
    assert!(near < short && short < long, "{near} {short} {long}");
}
