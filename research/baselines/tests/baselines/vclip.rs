//! V-Clip against the exact distance.

use crate::walks::{
    Placed, coherent, hard_settings, large, pairs_from_scratch_and_coherent, random_settings,
    wide_settings,
};
use colltrans_baselines::Proximity;
use colltrans_baselines::vclip::{Shell, Steps, VClip};

fn shells(placed: &Placed) -> [Shell; 2] {
    [&placed.moving, &placed.fixed].map(|body| Shell::new(body).unwrap())
}

fn from_scratch(placed: &Placed) -> Proximity<Steps> {
    let [moving, fixed] = shells(placed);
    VClip::new(&moving, &fixed).distance(&placed.moving_pose, &placed.fixed_pose)
}

/// Asserts the accuracy as a share of the size, and that all claims hold.
fn check(settings: impl Iterator<Item = Placed>, accuracy: f64) {
    let mut count = 0;
    for placed in settings {
        let Proximity { distance, on_moving, on_fixed, steps } = from_scratch(&placed);
        let error = placed.error(distance);
        let place = placed.error_of_points(distance, on_moving, on_fixed);
        assert!(error <= accuracy && !steps.gave_up, "{}: {error:e}, {steps:?}", placed.name);
        assert!(place <= accuracy, "{}: points {place:e}, {steps:?}", placed.name);
        count += 1;
    }
    assert!(count >= 60, "{count} settings");
}

#[test]
fn random_solids_at_all_distances() {
    check(random_settings(2_000), 4e-15);
}

#[test]
fn hard_families_are_exact() {
    check(hard_settings(100), 1e-14);
}

#[test]
fn wide_faces_and_crowded_vertices() {
    check(wide_settings(), 4e-15);
}

#[test]
fn coherent_query_agrees_with_fewer_steps() {
    for seed in 0..5 {
        let placed = large(500, seed);
        let [moving, fixed] = shells(&placed);
        let (mut fresh, mut carried) = (VClip::new(&moving, &fixed), VClip::new(&moving, &fixed));
        let [fresh_pairs, carried_pairs] = pairs_from_scratch_and_coherent(&placed, seed, |pose| {
            fresh.reset();
            [&mut fresh, &mut carried].map(|solver| {
                let found = solver.distance(pose, &placed.fixed_pose);
                (found.distance, found.steps.pairs)
            })
        });
        assert!(3 * carried_pairs < fresh_pairs, "{seed}: {carried_pairs} of {fresh_pairs}");
    }
}

#[test]
fn tied_bodies_moving_along_ties_are_exact() {
    for placed in hard_settings(12) {
        let [moving, fixed] = shells(&placed);
        let mut carried = VClip::new(&moving, &fixed);
        for pose in coherent(&placed, 0.05, 12, 1) {
            let answer = carried.distance(&pose, &placed.fixed_pose);
            let here = Placed { moving_pose: pose, ..placed.clone() };
            let error = here.error(answer.distance);
            assert!(error <= 1e-14 && !answer.steps.gave_up, "{}: {error:e} {answer:?}", here.name);
        }
    }
}

#[test]
fn large_bodies() {
    for (n, seed) in [(2_000, 1), (2_000, 2), (20_000, 3)] {
        let placed = large(n, seed);
        let [moving, fixed] = shells(&placed);
        let mut solver = VClip::new(&moving, &fixed);
        for gap in [None, Some(1e-3), Some(1e-9), Some(-0.01), Some(-1.0)] {
            let here = gap.map_or_else(|| placed.clone(), |gap| placed.at_gap(gap));
            let answer = solver.distance(&here.moving_pose, &here.fixed_pose);
            let error = here.error(answer.distance);
            assert!(error <= 1e-14 && !answer.steps.gave_up, "{}: {error:e}", here.name);
        }
    }
}
