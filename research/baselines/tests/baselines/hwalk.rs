//! H-Walk against the exact distance, and against V-Clip on large bodies.

use crate::walks::{
    Placed, coherent, hard_settings, large, pairs_from_scratch_and_coherent, random_settings,
    wide_settings,
};
use colltrans_baselines::Proximity;
use colltrans_baselines::hwalk::{HWalk, Hierarchy, Steps};
use colltrans_baselines::vclip::{Shell, VClip};

fn hierarchies(placed: &Placed) -> [Hierarchy; 2] {
    [&placed.moving, &placed.fixed].map(|body| Hierarchy::new(body).unwrap())
}

/// Answers from scratch with a small patience, so that small bodies use shortcuts too, and again from the result.
fn twice(placed: &Placed) -> [Proximity<Steps>; 2] {
    let [moving, fixed] = hierarchies(placed);
    let mut solver = HWalk::new(&moving, &fixed).with_patience(2);
    [0; 2].map(|_| solver.distance(&placed.moving_pose, &placed.fixed_pose))
}

fn check(settings: impl Iterator<Item = Placed>, accuracy: f64) {
    let (mut count, mut layers) = (0, 0);
    for placed in settings {
        for Proximity { distance, on_moving, on_fixed, steps } in twice(&placed) {
            let error = placed.error(distance);
            let place = placed.error_of_points(distance, on_moving, on_fixed);
            assert!(error <= accuracy && !steps.gave_up, "{}: {error:e}, {steps:?}", placed.name);
            assert!(place <= accuracy, "{}: points {place:e}, {steps:?}", placed.name);
            count += 1;
            layers += steps.layers;
        }
    }
    assert!(count >= 60 && layers > count, "{count} settings, {layers} layers");
}

#[test]
fn random_solids_at_all_distances() {
    check(random_settings(2_000), 4e-15);
}

#[test]
fn hard_families_are_exact() {
    check(hard_settings(60), 1e-14);
}

#[test]
fn wide_faces_and_crowded_vertices() {
    check(wide_settings(), 4e-15);
}

#[test]
fn coherent_query_agrees_with_fewer_steps() {
    for (seed, patience) in [(0, 1), (1, 4), (2, 16), (3, 64), (4, 16)] {
        let placed = large(500, seed);
        let [moving, fixed] = hierarchies(&placed);
        let solver = HWalk::new(&moving, &fixed).with_patience(patience);
        let (mut fresh, mut carried) = (solver.clone(), solver);
        let [fresh_pairs, carried_pairs] = pairs_from_scratch_and_coherent(&placed, seed, |pose| {
            fresh.reset();
            [&mut fresh, &mut carried].map(|solver| {
                let found = solver.distance(pose, &placed.fixed_pose);
                (found.distance, found.steps.pairs)
            })
        });
        assert!(2 * carried_pairs < fresh_pairs, "{patience}: {carried_pairs} of {fresh_pairs}");
    }
}

#[test]
fn large_bodies_agree_with_v_clip_in_fewer_steps() {
    let (mut walks, mut hierarchical) = (0, 0);
    for (n, seed) in [(2_000, 1), (2_000, 2), (20_000, 3)] {
        let placed = large(n, seed);
        let [moving, fixed] = hierarchies(&placed);
        let shells = [&placed.moving, &placed.fixed].map(|body| Shell::new(body).unwrap());
        let mut plain = VClip::new(&shells[0], &shells[1]);
        let mut solver = HWalk::new(&moving, &fixed);
        for gap in [None, Some(1e-3), Some(1e-9), Some(0.0), Some(-0.01), Some(-1.0)] {
            let here = gap.map_or_else(|| placed.clone(), |gap| placed.at_gap(gap));
            plain.reset();
            solver.reset();
            let expected = plain.distance(&here.moving_pose, &here.fixed_pose);
            let answer = solver.distance(&here.moving_pose, &here.fixed_pose);
            let error = here.error(answer.distance);
            assert!(error <= 1e-14 && !answer.steps.gave_up, "{}: {error:e}", here.name);
            let difference = (answer.distance - expected.distance).abs();
            assert!(difference <= 1e-14 * here.size(), "{}: {difference:e}", here.name);
            walks += expected.steps.pairs;
            hierarchical += answer.steps.pairs;
        }
    }
    assert!(hierarchical < walks, "{hierarchical} against {walks}");
}

/// Half a turn between two queries, after which a walk on layer 0 would cross the body.
#[test]
fn large_rotations_cause_shortcuts() {
    let placed = large(5_000, 9);
    let [moving, fixed] = hierarchies(&placed);
    let mut solver = HWalk::new(&moving, &fixed);
    let poses = coherent(&placed, std::f64::consts::PI, 2, 4);
    solver.distance(&poses[0], &placed.fixed_pose);
    let answer = solver.distance(&poses[1], &placed.fixed_pose);
    assert!(answer.steps.shortcuts > 0 && answer.steps.layers > answer.steps.shortcuts);
    let error = Placed { moving_pose: poses[1], ..placed }.error(answer.distance);
    assert!(error <= 1e-14, "{error:e}");
}

/// Along a motion, the answer does not depend on the start layer. Coarser layers use less of the last result.
#[test]
fn start_layers_change_work_but_not_answers() {
    let placed = large(2_000, 11);
    let [moving, fixed] = hierarchies(&placed);
    let poses = coherent(&placed, 0.001, 60, 5);
    let walked = |layer: usize| {
        let mut solver = HWalk::new(&moving, &fixed).with_start_layer(layer);
        let mut plain = HWalk::new(&moving, &fixed);
        solver.distance(&poses[0], &placed.fixed_pose);
        let mut iterations = 0;
        for pose in &poses[1..] {
            let answer = solver.distance(pose, &placed.fixed_pose);
            plain.reset();
            let expected = plain.distance(pose, &placed.fixed_pose);
            let difference = (answer.distance - expected.distance).abs();
            assert!(difference <= 1e-14 * placed.size(), "{layer}: {difference:e}");
            assert!(answer.steps.iterations >= answer.steps.pairs + answer.steps.layers);
            assert_eq!(answer.steps.shortcuts, 0, "{layer}");
            iterations += answer.steps.iterations;
        }
        iterations
    };
    let coarsest = moving.layer_count().max(fixed.layer_count()) - 1;
    let [strong, weak, beyond] = [0, coarsest, coarsest + 7].map(walked);
    assert!(2 * strong < weak, "{strong} and {weak}");
    assert_eq!(weak, beyond);
}

/// Hard settings from scratch and again, with every start layer.
#[test]
fn start_layers_on_hard_settings() {
    for placed in hard_settings(6) {
        let [moving, fixed] = hierarchies(&placed);
        for layer in 0..moving.layer_count().max(fixed.layer_count()) {
            let mut solver = HWalk::new(&moving, &fixed).with_start_layer(layer);
            for _ in 0..2 {
                let answer = solver.distance(&placed.moving_pose, &placed.fixed_pose);
                let error = placed.error(answer.distance);
                assert!(error <= 1e-14 && !answer.steps.gave_up, "{}: {error:e}", placed.name);
            }
        }
    }
}
