//! Plans with several moves, compared with closed forms, with burr puzzles solved by all moves of their cubes, and
//! with the collection of assemblies if it is present.

use std::path::Path;

use crate::common::*;
use colltrans_assembly::attempts::next_attempts;
use colltrans_assembly::plan::{Leg, PathSearch, Plan, PlanOptions};
use colltrans_assembly::roles::{PairFit, Role};
use colltrans_assembly::{
    AnalysisRequest, Assembly, Bodies, Fit, Ignored, Part, Piece, Watch, record,
};
use colltrans_assembly_io::read::{ReadOptions, read};
use colltrans_mesh::Mesh;
use colltrans_testkit::oracle::cubes::Cubes;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::block;
use colltrans_testkit::solids::TRAY_WITH_GROOVES;
use glam::{DAffine3, DVec3};

fn planned(assembly: &Assembly, options: PlanOptions) -> Plan {
    let bodies = Bodies::new(assembly, Fit::default_for(assembly)).unwrap();
    let plan = crate::common::planned(&bodies, options);
    check_moves(&bodies, &plan);
    plan
}

/// Checks every move of every step for overlaps at 201 positions, with the shrunk parts, and that parts moved aside
/// return.
fn check_moves(bodies: &Bodies, plan: &Plan) {
    let mut there = vec![true; bodies.len()];
    for (k, step) in plan.steps.iter().enumerate() {
        // A step within a group has only the remaining parts of the group around it.
        let group = step.group_step.map(|w| &plan.steps[w].parts);
        let inside = |p: usize| match group {
            Some(group) => {
                let before = plan.steps[..k].iter().filter(|s| s.group_step == step.group_step);
                group.contains(&p) && !before.into_iter().any(|s| s.parts.contains(&p))
            }
            None => there[p],
        };
        let all: Vec<usize> = (0..bodies.len()).filter(|&p| inside(p)).collect();
        let mut at = vec![DVec3::ZERO; bodies.len()];
        let mut go = |leg: &Leg, gone: &[usize]| {
            let motion = leg.direction * leg.travel;
            let outside = |p: &&usize| !leg.parts.contains(p);
            // Parts that have left are far away.
            let apart = |a: usize, b: usize| gone.contains(&a) != gone.contains(&b);
            for &a in &leg.parts {
                for &b in all.iter().filter(outside).filter(|&&b| !apart(a, b)) {
                    for share in 0..=200 {
                        let by = at[a] - at[b] + motion * (f64::from(share) / 200.0);
                        assert!(!bodies.overlaps_displaced(a, by, b), "{a} {b} {share} {leg:?}");
                    }
                }
            }
            for &part in &leg.parts {
                at[part] += motion;
            }
        };
        for leg in &step.path {
            go(leg, &[]);
        }
        let last = step.path.last().unwrap();
        assert_eq!((&last.parts, last.travel), (&step.parts, step.travel.value));
        for leg in &step.return_legs {
            go(leg, &step.parts);
        }
        for &part in all.iter().filter(|p| !step.parts.contains(p)) {
            assert!(at[part].length() < 1e-9, "part {part} must return");
        }
        let first = at[step.parts[0]];
        assert!(
            step.parts.iter().all(|&p| (at[p] - first).length() < 1e-9),
            "the group must have no relative displacement"
        );
        if step.group_step.is_none() {
            step.parts.iter().for_each(|&p| there[p] = false);
        }
    }
}

fn blocks(name: &str, all: &[[[f64; 3]; 2]]) -> Part {
    let pieces: Vec<Piece> = all.iter().map(|[low, high]| cuboid(*low, *high)).collect();
    part(name, &pieces)
}

/// Returns a T-slot along x, closed at both ends, whose lips are open from 14 to 17, and a bar with a stem in it.
fn slot() -> Assembly {
    let plate = blocks(
        "plate",
        &[
            [[-1.0, -3.0, -1.0], [21.0, 3.0, 0.0]],
            [[-1.0, -3.0, 0.0], [0.0, 3.0, 2.0]],
            [[20.0, -3.0, 0.0], [21.0, 3.0, 2.0]],
            [[0.0, -3.0, 0.0], [20.0, -2.0, 2.0]],
            [[0.0, 2.0, 0.0], [20.0, 3.0, 2.0]],
            [[0.0, -2.0, 1.0], [14.0, -1.0, 2.0]],
            [[0.0, 1.0, 1.0], [14.0, 2.0, 2.0]],
            [[17.0, -2.0, 1.0], [20.0, -1.0, 2.0]],
            [[17.0, 1.0, 1.0], [20.0, 2.0, 2.0]],
        ],
    );
    let key =
        blocks("key", &[[[0.5, -1.5, 0.2], [2.5, 1.5, 0.8]], [[0.5, -0.5, 0.5], [2.5, 0.5, 3.0]]]);
    Assembly::new(vec![key, plate]).unwrap()
}

#[test]
fn default_options_find_a_path_of_two_moves() {
    let assembly = slot();
    let plan = planned(&assembly, PlanOptions::default());
    assert!(plan.interlocked.is_empty() && plan.remaining.is_empty());
    let step = &plan.steps[0];
    assert_eq!((&step.parts[..], step.path.len(), step.return_legs.len()), (&[0][..], 2, 0));
    assert_eq!(step.path[0].direction, DVec3::X);
    assert_eq!(step.direction, DVec3::Z);
    // It moves up from 0.2 until it is above the lips, which end at 2.
    assert!((step.travel.value - 1.8).abs() < 1e-12, "{:?}", step.travel);
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    let told = record::plan_json(&bodies, &plan);
    assert_eq!(told["plan"][0]["path"][0]["parts"][0], "key");
    assert!(told["plan"][0].get("back").is_none());
    assert_eq!((&told["last"][0], told["plan"].as_array().unwrap().len()), (&"plate".into(), 1));
}

#[test]
fn effort_zero_disables_the_path_search() {
    let plan = planned(&slot(), PlanOptions::default().with_effort(0));
    assert_eq!(plan.interlocked[0].path_search, PathSearch::NotSearched("the effort is 0"));
    assert_eq!(plan.remaining, [0, 1]);
}

/// Returns a box with a cube in it and a lid that slides in grooves up to a stop.
fn sliding_lid() -> Assembly {
    let tray = blocks("tray", &TRAY_WITH_GROOVES);
    let cube = blocks("cube", &[[[1.0, 1.0, 0.5], [2.0, 2.0, 1.5]]]);
    let lid = blocks("lid", &[[[0.1, -0.4, 2.2], [3.9, 3.4, 2.8]]]);
    Assembly::new(vec![cube, lid, tray]).unwrap()
}

#[test]
fn lid_that_makes_room_returns_after_the_removal() {
    let assembly = sliding_lid();
    let plan = planned(&assembly, PlanOptions::default());
    let step = &plan.steps[0];
    assert_eq!(assembly.part_names(&step.parts), ["cube"]);
    assert_eq!(assembly.part_names(&step.path[0].parts), ["lid"]);
    assert_eq!(step.return_legs.len(), 1);
    assert_eq!(step.return_legs[0].parts, step.path[0].parts);
    assert_eq!(step.return_legs[0].direction, -step.path[0].direction);
    assert_eq!(step.return_legs[0].travel, step.path[0].travel);
    // The stop holds the lid: this is proven, or reported with the extent of the search.
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    for (proofs, words) in
        [(true, "Nor do several straight moves"), (false, "not found with effort 3")]
    {
        let plan = planned(&assembly, PlanOptions::default().with_proofs(proofs));
        let stuck = &plan.interlocked[0];
        assert_eq!(assembly.part_names(&stuck.parts), ["lid", "tray"]);
        assert_eq!(stuck.proof_cells.is_some(), proofs);
        let because = stuck.explain(&bodies);
        assert!(because.contains(words), "{because}");
    }
}

fn of_cubes(cubes: &Cubes) -> Assembly {
    let cube = |c: &[i32; 3]| cuboid(c.map(f64::from), c.map(|x| f64::from(x + 1)));
    let part = |(k, cells): (usize, &Vec<[i32; 3]>)| {
        part(&format!("piece{k}"), &cells.iter().map(cube).collect::<Vec<_>>())
    };
    Assembly::new(cubes.pieces.iter().enumerate().map(part).collect()).unwrap()
}

/// Returns the largest of some parts by box and volume; ties go to the lowest and then the first part.
fn base_of(assembly: &Assembly, parts: &[usize]) -> usize {
    let key = |part: usize| {
        let solid = assembly.parts()[part].solid();
        let (size, height) = (solid.bounds().side_lengths(), solid.bounds().center().z);
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        [size.element_product(), area, solid.volume(), -height].map(|x| x as f32)
    };
    let larger = |a: usize, b: usize| if key(b) > key(a) { b } else { a };
    parts.iter().copied().reduce(larger).expect("parts")
}

/// Checks that no move of any step moves the base of the parts from which the step removes.
fn check_base_is_stationary(assembly: &Assembly, plan: &Plan) {
    let all: Vec<usize> = (0..assembly.parts().len()).collect();
    for (k, step) in plan.steps.iter().enumerate() {
        let base = base_of(assembly, step.group_step.map_or(&all, |w| &plan.steps[w].parts));
        let mut legs = step.path.iter().chain(&step.return_legs);
        assert!(!step.parts.contains(&base), "step {k} takes the base {base}: {plan:?}");
        assert!(legs.all(|leg| !leg.parts.contains(&base)), "step {k} moves {base}: {plan:?}");
    }
}

/// The search for paths keeps the largest body fixed. The plan instead keeps the plate, because the larger key is to
/// be removed.
#[test]
fn selected_part_moves_even_if_it_is_the_largest() {
    let key = blocks(
        "key",
        &[
            [[0.5, -1.5, 0.2], [2.5, 1.5, 0.8]],
            [[0.5, -0.5, 0.5], [2.5, 0.5, 3.0]],
            [[-30.0, -30.0, 3.0], [30.0, 30.0, 4.0]],
        ],
    );
    let assembly = Assembly::new(vec![key, slot().parts()[1].clone()]).unwrap();
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    let question = AnalysisRequest::default().with_selected(vec![0]);
    let plan = question.analyse(&bodies, Watch::default()).unwrap().plan;
    let [step] = &plan.steps[..] else { panic!("one step: {plan:?}") };
    assert_eq!((&step.parts[..], &plan.base[..], step.path.len()), (&[0][..], &[1][..], 2));
    assert!(step.path.iter().all(|leg| leg.parts == [0]), "{plan:?}");
    assert_eq!((step.path[0].direction, step.direction), (DVec3::X, DVec3::Z));
    assert!(
        plan.selection
            .as_ref()
            .is_some_and(|wanted| wanted.is_complete && wanted.others.is_empty())
    );
}

#[test]
#[ignore = "long: 150 puzzles, and all moves of their cubes"]
fn random_puzzles_agree_with_exhaustive_cube_moves() {
    let mut random = Random::new(29);
    // Numbers of stuck and solved puzzles, and of those whose first step has more than one, two and three moves.
    let mut counts = [0; 5];
    for case in 0..150 {
        let cubes = Cubes::random(&mut random);
        let assembly = of_cubes(&cubes);
        let plan = planned(&assembly, PlanOptions::default().with_samples(0));
        let (expected, level) = (cubes.can_separate(), cubes.level());
        assert_eq!(plan.interlocked.is_empty(), expected, "case {case}: {cubes:?} {plan:?}");
        check_base_is_stationary(&assembly, &plan);
        if let Some(level) = level {
            let first = plan.steps[0].path.len();
            assert_eq!(first, level.moves, "case {case}: {cubes:?} {plan:?}");
            (1..4).for_each(|more| counts[1 + more] += usize::from(first > more));
        }
        counts[usize::from(expected)] += 1;
    }
    assert!(counts[0] >= 20 && counts[1] >= 100 && counts[2] >= 15 && counts[3] >= 3, "{counts:?}");
}

fn collected(name: &str) -> Option<Assembly> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/assemblies");
    let folder = folder.join(name);
    folder.is_dir().then(|| read(folder, &ReadOptions::default()).unwrap())
}

#[test]
fn burr_of_level_six_is_disassembled_by_six_moves() {
    let Some(assembly) = collected("burr_p3_19") else { return };
    let plan = planned(&assembly, PlanOptions::default().with_samples(0));
    assert!(plan.remaining.is_empty() && plan.interlocked.is_empty());
    check_base_is_stationary(&assembly, &plan);
    assert_eq!(plan.steps[0].path.len(), 6);
    let taken: usize = plan.steps.iter().filter(|s| s.parts.len() == 1).count();
    assert!(taken + plan.base.len() >= 5, "every piece must be removed: {:?}", plan.steps);
    // More effort finds the same path. Too little effort is reported, and proves nothing.
    for effort in [1, 100] {
        let other = planned(&assembly, PlanOptions::default().with_samples(0).with_effort(effort));
        let Some(stuck) = other.interlocked.first() else {
            assert_eq!(other.steps, plan.steps, "effort {effort}");
            continue;
        };
        let PathSearch::NotFound { searched, .. } = &stuck.path_search else { panic!("{other:?}") };
        assert!(effort == 1 && searched.total() >= PlanOptions::EFFORT_WORK, "{searched:?}");
    }
}

/// Returns the slot with its key, and `more` parts beside it.
fn slot_with(more: Vec<Part>) -> Assembly {
    Assembly::new(slot().parts().iter().cloned().chain(more).collect()).unwrap()
}

/// Checks that the key leaves the slot in two moves.
fn check_key_leaves(assembly: &Assembly, plan: &Plan) {
    let key = assembly.parts_named(&["key"]).unwrap();
    let step =
        plan.steps.iter().find(|step| step.parts == key).unwrap_or_else(|| panic!("{plan:?}"));
    assert_eq!(step.path.len(), 2, "{step:?}");
}

#[test]
fn roles_of_other_pairs_do_not_disable_the_path_search() {
    let block = |name: &str, x: f64| blocks(name, &[[[x, 10.0, 0.0], [x + 1.0, 11.0, 1.0]]]);
    let assembly = slot_with(vec![block("a", 0.0), block("b", 1.0), block("c", 5.0)]);
    let glued = PairFit { role: Some(Role::Glued), tolerance: None };
    let glued_pair = assembly.clone().with_pair([&["a"], &["b"]], glued).unwrap();
    check_key_leaves(&glued_pair, &planned(&glued_pair, PlanOptions::default()));
    let soft = PairFit { role: Some(Role::Soft), tolerance: Some(0.1) };
    let with_tolerance = assembly.with_pair([&["key"], &["plate"]], soft).unwrap();
    check_key_leaves(&with_tolerance, &planned(&with_tolerance, PlanOptions::default()));
}

#[test]
fn glued_parts_leave_together_in_several_moves() {
    let knob = blocks("knob", &[[[1.0, -1.0, 3.0], [2.0, 1.0, 4.0]]]);
    let glued = PairFit { role: Some(Role::Glued), tolerance: None };
    let assembly = slot_with(vec![knob]).with_pair([&["key"], &["knob"]], glued).unwrap();
    let plan = planned(&assembly, PlanOptions::default());
    let moved = assembly.parts_named(&["key", "knob"]).unwrap();
    let step = &plan.steps[0];
    assert_eq!((&step.parts, step.path.len()), (&moved, 2), "{plan:?}");
    assert!(step.path.iter().all(|leg| leg.parts == moved), "{step:?}");
}

#[test]
fn ignored_overlaps_and_open_surfaces_take_part_in_paths() {
    // The key is 0.05 too deep in the plate.
    let low = blocks(
        "key",
        &[[[0.5, -1.5, -0.05], [2.5, 1.5, 0.8]], [[0.5, -0.5, 0.5], [2.5, 0.5, 3.0]]],
    );
    let assembly = Assembly::new(vec![low, slot().parts()[1].clone()]).unwrap();
    assert!(planned(&assembly, PlanOptions::default()).steps.is_empty());
    let ignored = assembly.with_ignored(&[["key", "plate"]], Ignored::Overlap).unwrap();
    let bodies = Bodies::new(&ignored, Fit::default_for(&ignored)).unwrap();
    check_key_leaves(&ignored, &crate::common::planned(&bodies, PlanOptions::default()));
    // A sheet without thickness lies below the plate.
    let corners = [[13.0, 1.0, -3.0], [18.0, 1.0, -3.0], [18.0, -1.0, -3.0], [13.0, -1.0, -3.0]];
    let mesh = Mesh::new(corners.map(DVec3::from).to_vec(), vec![vec![0, 1, 2, 3]]);
    let sheet = part("sheet", &[Piece { mesh, world_from_piece: DAffine3::IDENTITY }]);
    let below = slot_with(vec![sheet]).with_fixed(&["plate", "sheet"]).unwrap();
    check_key_leaves(&below, &planned(&below, PlanOptions::default()));
}

#[test]
fn more_than_24_parts_are_searched() {
    let block = |k: u32| {
        let x = 3.0 * f64::from(k);
        blocks(&format!("block{k}"), &[[[x, 10.0, 0.0], [x + 1.0, 11.0, 1.0]]])
    };
    let assembly =
        slot_with((0..30).map(block).collect()).with_fixed(&["plate", "block*"]).unwrap();
    check_key_leaves(&assembly, &planned(&assembly, PlanOptions::default()));
}

#[test]
fn pin_leaves_a_channel_with_a_bend_of_60_degrees() {
    // The channel is open only at its far end.
    let plate = channel_with_bend();
    let pin = blocks("pin", &[[[-0.4, -0.4, 0.1], [0.4, 0.4, 0.9]]]);
    let assembly = Assembly::new(vec![pin, plate]).unwrap();
    let plan = planned(&assembly, PlanOptions::default().with_samples(0));
    assert!(plan.interlocked.is_empty(), "{plan:?}");
    assert!(plan.steps[0].path.len() >= 2, "{plan:?}");
}

/// Returns a plate with a channel along x from 0 to 10 and then, at an angle of 60 degrees, to its open end.
fn channel_with_bend() -> Part {
    let (u, v) = (DVec3::new(0.5, 0.75_f64.sqrt(), 0.0), DVec3::new(-(0.75_f64.sqrt()), 0.5, 0.0));
    let second = DAffine3::from_cols(u, v, DVec3::Z, DVec3::new(10.0, 0.0, 0.0));
    let placed = |[low, high]: [[f64; 3]; 2], world_from_piece: DAffine3| Piece {
        world_from_piece,
        ..cuboid(low, high)
    };
    let (first, tall) = (DAffine3::IDENTITY, [0.0, 1.0]);
    let wall = |x: [f64; 2], y: [f64; 2], at: DAffine3| {
        placed([[x[0], y[0], tall[0]], [x[1], y[1], tall[1]]], at)
    };
    part(
        "plate",
        &[
            placed([[-3.0, -14.0, -1.0], [30.0, 14.0, 0.0]], first),
            placed([[-3.0, -14.0, 1.0], [30.0, 14.0, 2.0]], first),
            wall([-2.0, -1.0], [-2.0, 2.0], first),
            wall([-2.0, 9.5], [0.5, 1.5], first),
            wall([-2.0, 12.5], [-1.5, -0.5], first),
            wall([0.0, 7.0], [1.2, 2.2], second),
            wall([0.8, 7.0], [-2.2, -1.2], second),
        ],
    )
}

#[test]
fn selected_part_leaves_alone_if_others_move_aside() {
    let assembly = sliding_lid();
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    let cube = assembly.parts_named(&["cube"]).unwrap();
    let question = AnalysisRequest::default().with_selected(cube.clone());
    let plan = question.analyse(&bodies, Watch::default()).unwrap().plan;
    check_moves(&bodies, &plan);
    let selection = plan.selection.as_ref().expect("a selection");
    assert!(selection.is_complete && selection.others.is_empty(), "{plan:?}");
    assert_eq!((plan.steps.len(), &plan.steps[0].parts), (1, &cube));
    assert_eq!(plan.steps[0].return_legs.len(), 1);
}

#[test]
fn long_rod_leaves_after_a_short_move() {
    // The rod is 60 long. It must drop by about 1, until its knob is below the ceiling, and then slides out.
    let base = blocks(
        "base",
        &[
            [[-1.0, -1.0, -2.0], [60.0, 2.0, -1.0]],
            [[-1.0, -1.0, -1.0], [60.0, 0.0, 2.0]],
            [[-1.0, 1.0, -1.0], [60.0, 2.0, 2.0]],
            [[-1.0, 0.0, -1.0], [0.0, 1.0, 2.0]],
            [[0.0, 0.0, 1.0], [2.0, 1.0, 2.0]],
            [[3.0, 0.0, 1.0], [60.0, 1.0, 2.0]],
            [[-1.0, -1.0, 2.0], [60.0, 2.0, 3.0]],
        ],
    );
    let rod = blocks(
        "rod",
        &[[[0.02, 0.02, 0.02], [60.0, 0.98, 0.98]], [[2.02, 0.02, 0.5], [2.98, 0.98, 1.98]]],
    );
    let plan = planned(&Assembly::new(vec![base, rod]).unwrap(), PlanOptions::default());
    assert!(plan.interlocked.is_empty() && plan.remaining.is_empty(), "{plan:?}");
    assert_eq!((plan.steps.len(), plan.steps[0].path.len()), (1, 2));
    assert_eq!(plan.steps[0].path[0].direction, DVec3::NEG_Z);
}

#[test]
fn selected_part_that_stays_locked_in_another_one_is_not_out() {
    // The bolt leaves by two moves after the plug, but without clearance no search of several moves finds them. The
    // base and the bolt together leave all others by one move.
    let base = blocks(
        "base",
        &[
            [[0.0, 0.0, 0.0], [7.0, 3.0, 1.0]],
            [[0.0, 0.0, 1.0], [7.0, 1.0, 5.0]],
            [[0.0, 2.0, 1.0], [7.0, 3.0, 5.0]],
            [[0.0, 1.0, 1.0], [1.0, 2.0, 5.0]],
            [[6.0, 1.0, 1.0], [7.0, 2.0, 5.0]],
            [[1.0, 1.0, 3.0], [5.0, 2.0, 5.0]],
        ],
    );
    let bolt = blocks("bolt", &[[[1.0, 1.0, 1.0], [2.0, 2.0, 3.0]]]);
    let plug = blocks("plug", &[[[5.0, 1.0, 3.0], [6.0, 2.0, 5.0]]]);
    let beside = |k: u8| {
        let x = 9.0 + 2.0 * f64::from(k);
        blocks(&format!("beside_{k}"), &[[[x, 0.0, 0.0], [x + 1.0, 2.0, 1.0]]])
    };
    let mut parts = vec![base, bolt, plug];
    parts.extend((0..4).map(beside));
    let assembly = Assembly::new(parts).unwrap();
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    for effort in [0, 1] {
        let options = PlanOptions::default().with_effort(effort);
        let question = AnalysisRequest::default().with_options(options).with_selected(vec![1]);
        let plan = question.analyse(&bodies, Watch::default()).unwrap().plan;
        let selection = plan.selection.as_ref().expect("a selection");
        let holds = |parts: &[usize]| parts.contains(&1) && parts.len() > 1;
        let locked = plan.interlocked.iter().any(|group| holds(&group.parts));
        assert_eq!(selection.is_complete, !locked, "{plan:?}");
        assert!(!selection.is_minimal || selection.is_complete);
    }
}

/// Returns a housing around a channel from x = 0 on that turns into a shaft, and a cube that fits into both exactly.
/// With `turns` of 2, the shaft goes up at once; with 3, the channel turns to y before.
fn exact_channel(turns: usize, cube: f64) -> Assembly {
    let housing = if turns == 2 {
        blocks(
            "housing",
            &[
                [[-1.0, -1.0, -1.0], [3.0, 2.0, 0.0]],
                [[-1.0, -1.0, 0.0], [3.0, 0.0, 2.0]],
                [[-1.0, 1.0, 0.0], [3.0, 2.0, 2.0]],
                [[-1.0, 0.0, 0.0], [0.0, 1.0, 2.0]],
                [[2.0, 0.0, 0.0], [3.0, 1.0, 2.0]],
                [[0.0, 0.0, 1.0], [1.0, 1.0, 2.0]],
            ],
        )
    } else {
        blocks(
            "housing",
            &[
                [[-1.0, -1.0, -1.0], [4.0, 4.0, 0.0]],
                [[-1.0, -1.0, 0.0], [4.0, 0.0, 2.0]],
                [[-1.0, 3.0, 0.0], [4.0, 4.0, 2.0]],
                [[-1.0, 0.0, 0.0], [0.0, 3.0, 2.0]],
                [[3.0, 0.0, 0.0], [4.0, 3.0, 2.0]],
                [[0.0, 1.0, 0.0], [2.0, 3.0, 2.0]],
                [[0.0, 0.0, 1.0], [3.0, 1.0, 2.0]],
                [[2.0, 1.0, 1.0], [3.0, 2.0, 2.0]],
            ],
        )
    };
    Assembly::new(vec![blocks("cube", &[[[0.0; 3], [cube; 3]]]), housing]).unwrap()
}

#[test]
fn exact_fits_leave_in_several_moves_with_a_tolerance_above_rounding() {
    for turns in [2, 3] {
        let plan_with = |cube: f64, tolerance: f64| {
            let assembly = exact_channel(turns, cube);
            let bodies = Bodies::new(&assembly, Fit::Tolerance(tolerance)).unwrap();
            let plan = crate::common::planned(&bodies, PlanOptions::default());
            check_moves(&bodies, &plan);
            plan
        };
        // A leg that ends at a wall passes it by less than the share by which its cast is longer.
        for tolerance in [1e-10, 1e-9, 1e-6] {
            let plan = plan_with(1.0, tolerance);
            assert!(plan.interlocked.is_empty(), "{turns} {tolerance}: {plan:?}");
            assert_eq!((&plan.steps[0].parts[..], plan.steps[0].path.len()), (&[0][..], turns));
            let large = plan_with(1.0 + 2.0 * tolerance, tolerance);
            assert_eq!(large.interlocked.len(), 1, "{large:?}");
        }
    }
}

/// With the default tolerance of files in double precision, rounding leaves no room for proofs. The search ends, by its
/// counted work, and a tolerance is suggested.
#[test]
fn exact_fits_suggest_a_tolerance_for_several_moves() {
    for turns in [2, 3] {
        let assembly = exact_channel(turns, 1.0);
        let bodies = Bodies::new(&assembly, Fit::Tolerance(0.5_f64.powi(44))).unwrap();
        let found = AnalysisRequest::default().analyse(&bodies, Watch::default()).unwrap();
        let stuck = &found.plan.interlocked[0];
        let PathSearch::NotFound { searched, .. } = &stuck.path_search else { panic!("{stuck:?}") };
        // Each placement needs a test or a cast along six directions.
        assert!(searched.places < 30_000 && searched.total() < 6_100_000, "{searched:?}");
        let tried = next_attempts(&found);
        let tolerance = tried.iter().find_map(|way| way.option.strip_prefix("--tolerance "));
        let tolerance: f64 = tolerance.expect("a tolerance to try").parse().unwrap();
        let bodies = Bodies::new(&assembly, Fit::Tolerance(tolerance)).unwrap();
        let plan = crate::common::planned(&bodies, PlanOptions::default());
        assert!(plan.interlocked.is_empty(), "{plan:?}");
    }
}

#[test]
fn enclosed_parts_are_proven_to_stay() {
    let walls = [
        [[-1.0, -1.0, -1.0], [3.0, 3.0, 0.0]],
        [[-1.0, -1.0, 2.0], [3.0, 3.0, 3.0]],
        [[-1.0, -1.0, 0.0], [3.0, 0.0, 2.0]],
        [[-1.0, 2.0, 0.0], [3.0, 3.0, 2.0]],
        [[-1.0, 0.0, 0.0], [0.0, 2.0, 2.0]],
        [[2.0, 0.0, 0.0], [3.0, 2.0, 2.0]],
    ];
    // One body with a cavity.
    let hollow = || {
        let outside = block(DVec3::splat(-1.0), DVec3::splat(3.0));
        let body = outside.joined(&block(DVec3::ZERO, DVec3::splat(2.0)).reversed());
        let mesh = Mesh::new(body.vertices, body.faces);
        part("shell", &[Piece { mesh, world_from_piece: DAffine3::IDENTITY }])
    };
    let small = |name: &str, low: f64| blocks(name, &[[[low; 3], [low + 0.7; 3]]]);
    let foot = blocks("foot", &[[[-1.0, -1.0, -3.0], [3.0, 3.0, -1.0]]]);
    let told = |parts: Vec<Part>| {
        let assembly = Assembly::new(parts).unwrap();
        let plan = planned(&assembly, PlanOptions::default());
        let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
        (record::plan_json(&bodies, &plan), plan)
    };
    let (json, plan) = told(vec![small("cube", 0.1), hollow(), foot]);
    assert_eq!((plan.steps.len(), &plan.interlocked[0].parts[..]), (1, &[0, 1][..]));
    assert_eq!(plan.interlocked[0].path_search, PathSearch::Enclosed);
    assert_eq!(json["left"], serde_json::json!(["cube", "shell"]));
    assert_eq!(json["stuck"][0]["moves"], serde_json::json!({ "enclosed": true }));
    // Two cubes in the cavity, which block each other.
    let (_, plan) = told(vec![small("a", 0.1), small("b", 1.1), hollow()]);
    assert_eq!(plan.interlocked[0].path_search, PathSearch::Enclosed);
    // A touching cube below the box, and one that touches the wall from inside.
    let below = blocks("below", &[[[0.0, 0.0, -2.0], [1.0, 1.0, -1.0]]]);
    let (_, plan) = told(vec![below, hollow()]);
    assert!(plan.interlocked.is_empty(), "{plan:?}");
    let (_, plan) = told(vec![small("cube", 0.0), hollow()]);
    assert_eq!(plan.interlocked[0].path_search, PathSearch::Enclosed);
    // With a tolerance above the thickness, nothing is left of the wall.
    let wide = blocks("cube", &[[[0.1; 3], [1.9; 3]]]);
    let assembly = Assembly::new(vec![wide, hollow()]).unwrap();
    let path_search = |tolerance: f64| {
        let bodies = Bodies::new(&assembly, Fit::Tolerance(tolerance)).unwrap();
        let plan = crate::common::planned(&bodies, PlanOptions::default());
        plan.interlocked.first().map(|stuck| stuck.path_search.clone())
    };
    assert_eq!(path_search(0.5), Some(PathSearch::Enclosed));
    assert_ne!(path_search(1.2), Some(PathSearch::Enclosed));
    // A box of walls that has a window is not closed.
    let (json, plan) = told(vec![small("cube", 0.1), blocks("shell", &walls[..5])]);
    assert!(plan.interlocked.is_empty(), "{plan:?}");
    assert_eq!(json["left"], serde_json::json!([]));
}
