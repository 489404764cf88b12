//! Free directions against closed forms, casts in random directions and exact cones; modified proofs.

use std::f64::consts::{PI, TAU};

use colltrans_convex::{Cast, ConvexPolyhedron, Pose};
use colltrans_removal::directions::{
    CellKind, CellProof, FreeDirections, FreeError, FreeOptions, FreeProof, InnerBox, Verdict,
};
use colltrans_solid::{Solid, SolidCast, StartOverlap};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::solids::free::{FAMILIES, examine, is_free_of_all, thin::judge};
use colltrans_testkit::random::Random;
use colltrans_testkit::solids::{ROOM_WITH_WINDOW, thread};
use colltrans_testkit::tally::Tally;
use glam::{DMat3, DQuat, DVec3};

const EXACT: FreeOptions = FreeOptions::DEFAULT.with_no_tolerance();

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Solid {
    let body = ConvexPolyhedron::cuboid(DVec3::from(low), DVec3::from(high)).unwrap();
    Solid::from_convex(&body).unwrap()
}

fn union_of(pieces: &[Solid]) -> Solid {
    Solid::from_pieces(pieces).unwrap()
}

fn free_directions<'a>(a: &'a Solid, b: &'a Solid, options: FreeOptions) -> FreeDirections<'a> {
    let all =
        FreeDirections::compute(&a.at(Pose::IDENTITY), &b.at(Pose::IDENTITY), options).unwrap();
    all.verify().unwrap();
    all
}

/// Returns the total length of the arcs.
fn arc_length(free: &FreeDirections) -> f64 {
    let turns = free.arcs().iter().flat_map(|arc| arc.along.windows(2));
    turns.map(|ends| ends[0].angle_between(ends[1])).sum()
}

fn assert_area(free: &FreeDirections, expected: f64) {
    let [low, high] = free.free_area();
    assert!(low <= expected && expected <= high && high - low < 1e-12, "{low} {high}: {expected}");
    assert_eq!(free.undecided_area(), 0.0);
    assert!(free.is_complete());
}

#[test]
fn lid_on_table_is_free_in_half_space() {
    let (lid, table) =
        (cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 1.0]), cuboid([-3.0, -2.0, -1.0], [2.0, 5.0, 0.0]));
    let all = free_directions(&lid, &table, EXACT);
    assert_area(&all, TAU);
    assert_eq!(all.classify(DVec3::new(0.3, -5.0, 0.0)), Ok(Verdict::Free));
    assert!(matches!(all.classify(DVec3::new(0.3, -5.0, -1e-60)), Ok(Verdict::Blocked(_))));
    assert!(all.classify(DVec3::ZERO).is_err());
    assert!(!all.is_blocked());
}

#[test]
fn cube_in_corner_is_free_in_octant() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let walls = union_of(&[
        cuboid([-1.0, -1.0, -1.0], [5.0, 5.0, 0.0]),
        cuboid([-1.0, -1.0, 0.0], [0.0, 5.0, 5.0]),
        cuboid([0.0, -1.0, 0.0], [5.0, 0.0, 5.0]),
    ]);
    let all = free_directions(&cube, &walls, EXACT);
    assert_area(&all, PI / 2.0);
}

#[test]
fn bar_in_rail_has_two_isolated_directions() {
    let bar = cuboid([0.0, 0.0, 0.0], [4.0, 1.0, 1.0]);
    let rail = union_of(&[
        cuboid([-1.0, -1.0, -1.0], [7.0, 2.0, 0.0]),
        cuboid([-1.0, -1.0, 1.0], [7.0, 2.0, 2.0]),
        cuboid([-1.0, -1.0, 0.0], [7.0, 0.0, 1.0]),
        cuboid([-1.0, 1.0, 0.0], [7.0, 2.0, 1.0]),
    ]);
    let all = free_directions(&bar, &rail, EXACT);
    assert_area(&all, 0.0);
    assert!(all.regions().is_empty() && all.arcs().is_empty());
    let points = all.points();
    assert_eq!(points.len(), 2, "{points:?}");
    for d in [DVec3::X, DVec3::NEG_X] {
        let own: Vec<_> = points.iter().filter(|p| all.is_at_point(p, d * 3.0).unwrap()).collect();
        assert!(own.len() == 1 && own[0].direction == d, "{own:?}");
        for beside in [DVec3::Y, DVec3::Z].map(|by| d + by * 1e-50) {
            assert!(!all.is_at_point(own[0], beside).unwrap());
        }
        assert_eq!(all.classify(d), Ok(Verdict::Free));
    }
    // With a tolerance near rounding they are regions that are narrower than the limit for distinct corners.
    let all = free_directions(&bar, &rail, FreeOptions::DEFAULT.with_tolerance(1e-13));
    assert_eq!(all.regions().len(), 2);
    for region in all.regions() {
        assert!(region.margin < 1e-12 && !region.corners.is_empty(), "{region:?}");
    }
}

#[test]
fn plate_between_plates_has_full_circle() {
    let plate = cuboid([0.0; 3], [1.0; 3]);
    let stack = union_of(&[
        cuboid([-5.0, -5.0, -1.0], [5.0, 5.0, 0.0]),
        cuboid([-5.0, -5.0, 1.0], [5.0, 5.0, 2.0]),
    ]);
    let all = free_directions(&plate, &stack, EXACT);
    assert_area(&all, 0.0);
    assert!(all.points().is_empty());
    let arcs = all.arcs();
    assert!(arcs.len() == 1 && arcs[0].ends.is_none(), "{arcs:?}");
    assert_eq!(arcs[0].along.first(), arcs[0].along.last());
    assert!((arc_length(&all) - TAU).abs() < 1e-12, "{}", arc_length(&all));
    for (d, expected) in
        [([3.0, 7.0, 0.0], true), ([-0.1, 0.3, 0.0], true), ([1.0, 1.0, 1e-50], false)]
    {
        assert_eq!(all.is_on_arc(&arcs[0], d.into()), Ok(expected));
    }
}

#[test]
fn bar_in_closed_v_groove_has_quarter_arc() {
    // A bar with a square section rests on its edge in a V-groove with closed ends. It can only move up between the
    // two planes.
    let turn = DMat3::from_cols(
        DVec3::new(3.0, 4.0, 0.0) / 5.0,
        DVec3::new(-4.0, 3.0, 0.0) / 5.0,
        DVec3::Z,
    );
    let pose = Pose::from_matrix(turn, DVec3::ZERO).unwrap();
    let bar = cuboid([0.0, 0.0, 0.0], [1.0, 1.0, 2.0]);
    let groove = union_of(&[
        cuboid([-1.0, -1.0, -1.0], [9.0, 0.0, 3.0]),
        cuboid([-1.0, 0.0, -1.0], [0.0, 9.0, 3.0]),
        cuboid([0.0, 0.0, -1.0], [9.0, 9.0, 0.0]),
        cuboid([0.0, 0.0, 2.0], [9.0, 9.0, 3.0]),
    ]);
    let all = free_directions(&bar, &groove, EXACT);
    assert_area(&all, 0.0);
    assert!((arc_length(&all) - PI / 2.0).abs() < 1e-12, "{}", arc_length(&all));
    assert!(all.points().is_empty());
    let [arc] = all.arcs() else { panic!("{:?}", all.arcs()) };
    for (d, expected) in [
        (DVec3::X, true),
        (DVec3::Y, true),
        (DVec3::new(5.0, 7.0, 0.0), true),
        (DVec3::new(5.0, -1e-50, 0.0), false),
        (DVec3::new(5.0, 7.0, 1e-50), false),
        (DVec3::new(-5.0, -7.0, 0.0), false),
    ] {
        assert_eq!(all.is_on_arc(arc, d), Ok(expected), "{d}");
        assert_eq!(all.classify(d).unwrap() == Verdict::Free, expected, "{d}");
    }
    let turned = FreeDirections::compute(&bar.at(pose), &groove.at(pose), EXACT).unwrap();
    turned.verify().unwrap();
    assert_area(&turned, 0.0);
    assert!(turned.arcs().len() == 1 && turned.points().is_empty(), "{:?}", turned.arcs());
    assert!((arc_length(&turned) - PI / 2.0).abs() < 1e-12, "{}", arc_length(&turned));
}

#[test]
fn closed_box_blocks_all_directions() {
    let cube = cuboid([1.0; 3], [2.0; 3]);
    let cavity = union_of(&[
        cuboid([0.0, 0.0, 0.0], [3.0, 3.0, 0.5]),
        cuboid([0.0, 0.0, 2.5], [3.0, 3.0, 3.0]),
        cuboid([0.0, 0.0, 0.5], [0.5, 3.0, 2.5]),
        cuboid([2.5, 0.0, 0.5], [3.0, 3.0, 2.5]),
        cuboid([0.5, 0.0, 0.5], [2.5, 0.5, 2.5]),
        cuboid([0.5, 2.5, 0.5], [2.5, 3.0, 2.5]),
    ]);
    let all = free_directions(&cube, &cavity, EXACT);
    assert!(all.is_blocked());
    assert_area(&all, 0.0);
}

#[test]
fn overlap_open_shell_and_negative_tolerance_are_rejected() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let other = cuboid([0.5; 3], [2.0; 3]);
    let place = |options| {
        FreeDirections::compute(&cube.at(Pose::IDENTITY), &other.at(Pose::IDENTITY), options)
    };
    let Err(overlap @ FreeError::Overlapping { .. }) = place(EXACT) else { panic!("they overlap") };
    let message = overlap.to_string();
    let start = "the bodies overlap at the start (triangle ";
    let end = " of the fixed body), so no direction is free; increase the tolerance or ignore the start overlap";
    assert!(message.starts_with(start) && message.ends_with(end), "{message}");
    assert!(place(EXACT.with_start_overlap(StartOverlap::Ignore)).is_ok());
    assert!(matches!(place(EXACT.with_tolerance(-1.0)), Err(FreeError::Query(_))));
    let sheet = Solid::from_open_mesh(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]).unwrap();
    let all = FreeDirections::compute(&sheet.at(Pose::IDENTITY), &other.at(Pose::IDENTITY), EXACT);
    assert!(matches!(all, Err(FreeError::Open { which: "moving" })));
}

#[test]
#[ignore = "long: exact fractions"]
fn answers_agree_with_casts_and_exact_cones_and_mutants_are_rejected() {
    // The bodies are so thin that a larger tolerance makes them vanish.
    let mut thin = Tally::default();
    examine("tetrahedra", 416_611_827_720, 4, &mut thin).unwrap();
    assert_eq!([thin.get("settings"), thin.get("overlapping")], [1, 0]);
    for family in FAMILIES {
        let mut all = Tally::default();
        for seed in 0..10 {
            examine(family, seed, 40, &mut all).unwrap_or_else(|e| panic!("{family}:{seed}: {e}"));
        }
        let [judged, refused, cells] = ["judged", "refused", "cells"].map(|name| all.get(name));
        assert!(judged > 100 && refused > 0 && cells > 20, "{family}: {all:?}");
    }
}

#[test]
fn common_rotation_keeps_free_area() {
    let q = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.5, 0.9);
    let turned = Pose::new(q, DVec3::new(1.0, 2.0, 3.0)).unwrap();
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let wall = union_of(&[
        cuboid([-1.0, -1.0, -1.0], [5.0, 5.0, 0.0]),
        cuboid([-1.0, -1.0, 0.0], [-0.125, 5.0, 5.0]),
    ]);
    let plain = free_directions(&cube, &wall, FreeOptions::default());
    let all = FreeDirections::compute(&cube.at(turned), &wall.at(turned), FreeOptions::default())
        .unwrap();
    all.verify().unwrap();
    let [low, high] = all.free_area();
    assert!((low - plain.free_area()[0]).abs() < 1e-9 && high >= plain.free_area()[0], "{low}");
    assert!(all.undecided_area() < 1e-9);
}

/// Returns a bar in a longer tube, and the tube.
fn bar_in_tube() -> [Solid; 2] {
    let bar = cuboid([0.0, 0.0, 0.0], [4.0, 1.0, 1.0]);
    let tube = union_of(&[
        cuboid([-1.0, -1.0, -1.0], [7.0, 2.0, 0.0]),
        cuboid([-1.0, -1.0, 1.0], [7.0, 2.0, 2.0]),
        cuboid([-1.0, -1.0, 0.0], [7.0, 0.0, 1.0]),
        cuboid([-1.0, 1.0, 0.0], [7.0, 2.0, 1.0]),
    ]);
    [bar, tube]
}

#[test]
fn free_directions_grow_with_tolerance() {
    let [bar, tube] = bar_in_tube();
    let all = [0.0, 0.001, 0.01, 0.1]
        .map(|length| free_directions(&bar, &tube, EXACT.with_tolerance(length)));
    for pair in all.windows(2) {
        assert!(pair[0].free_area()[1] <= pair[1].free_area()[0]);
        for cell in pair[0].cells() {
            for d in cell.corners {
                let [tight, loose] = [0, 1].map(|k| pair[k].classify(d).unwrap());
                assert!(tight != Verdict::Free || loose == Verdict::Free, "{d}");
            }
        }
    }
}

#[test]
fn regions_of_bar_in_tube_have_four_corners() {
    let [bar, tube] = bar_in_tube();
    let all = free_directions(&bar, &tube, EXACT.with_tolerance(0.1));
    let regions = all.regions();
    assert_eq!(regions.len(), 2, "one at each end of the tube");
    for (region, sign) in regions.iter().zip([-1.0, 1.0]) {
        assert_eq!(region.corners.len(), 4, "{region:?}");
        assert!((region.center.x - sign).abs() < 1e-6);
        assert_eq!(all.classify(region.center), Ok(Verdict::Free));
        // The offset bar has a total play of 0.1 on each side, and leaves after 4.9 or 6.9.
        let slope = if sign < 0.0 { 0.1 / 4.9 } else { 0.1 / 6.9 };
        for corner in &region.corners {
            assert!((corner.y.abs() - slope).abs() < 0.01, "{corner}");
        }
    }
    let area: f64 = regions.iter().map(|region| region.area).sum();
    assert!((area - all.free_area()[0]).abs() < 1e-12);
    assert!(all.pieces().len() >= regions.len());
}

#[test]
fn work_is_bounded_for_bar_in_tube_and_limit_leaves_all_undecided() {
    let [bar, tube] = bar_in_tube();
    let [cells, looks] = free_directions(&bar, &tube, EXACT).work_counts();
    assert!(cells <= 6 && looks < 20_000, "{cells} {looks}");
    let [cells, looks] = free_directions(&bar, &tube, EXACT.with_tolerance(0.01)).work_counts();
    assert!(cells <= 24 && looks < 60_000, "{cells} {looks}");
    let none = FreeDirections::compute(
        &bar.at(Pose::IDENTITY),
        &tube.at(Pose::IDENTITY),
        EXACT.with_looks(0),
    );
    let none = none.unwrap();
    assert!(!none.is_complete() && !none.is_blocked());
    assert!((none.undecided_area() - 2.0 * TAU).abs() < 1e-12);
    assert_eq!(none.free_among_undecided(), [DVec3::X, DVec3::NEG_X]);
}

#[test]
fn random_tetrahedra_agree_with_casts() {
    let mut rng = Random::new(29);
    let mut judged = [0_u32; 2];
    for _ in 0..60 {
        let mut tetrahedron = |by: f64| {
            let corners = [0; 4].map(|_| DVec3::from([0; 3].map(|_| rng.range(-1.0, 1.0))) * by);
            ConvexPolyhedron::from_points(&corners).ok().map(|body| Solid::from_convex(&body))
        };
        let (Some(Ok(a)), Some(Ok(b))) = (tetrahedron(1.0), tetrahedron(2.0)) else { continue };
        let place = Pose::from_translation(DVec3::new(1.5, 0.5, 0.25)).unwrap();
        let (a, b) = (a.at(place), b.at(Pose::IDENTITY));
        let Ok(all) = FreeDirections::compute(&a, &b, EXACT) else { continue };
        all.verify().unwrap();
        assert!(all.is_complete());
        let cells: Vec<_> = all.cells().collect();
        for cell in &cells {
            let [p, q, r, _] = cell.corners;
            for d in [p, p + (q - p) * rng.range(0.0, 1.0) + (r - q) * rng.range(0.0, 1.0)] {
                let cast = Cast::<Solid>::new(a, b, d).unwrap().with_tolerance(0.0).unwrap();
                let free = cast.clearance().unwrap().is_free();
                assert_eq!(all.classify(d).unwrap() == Verdict::Free, free, "{d}");
                judged[usize::from(free)] += 1;
            }
        }
    }
    assert!(judged[0] > 100 && judged[1] > 100, "{judged:?}");
}

#[test]
fn inner_boxes_block_cells_of_finely_tessellated_bodies() {
    // A ring around a rod, with facets that are small compared with the gap.
    let [ring, rod] =
        [([0.0, 1.0], 10, Some(3.0)), ([-1.0, 2.0], 30, None)].map(|(heights, rows, outer)| {
            let radius = if outer.is_some() { 1.25 } else { 1.0 };
            let mesh = thread([radius, 0.0, 1.0], heights, [48, rows], outer);
            Solid::from_mesh(&mesh.vertices, &mesh.faces).unwrap()
        });
    let all = free_directions(&ring, &rod, EXACT.with_depth(3));
    assert!(all.undecided_area() < 0.05 * 2.0 * TAU && all.work_counts()[1] < 1_500_000);
    let proof = all.proof();
    let inner = proof.cells.iter().filter(|cell| matches!(cell, CellProof::Inner(_))).count();
    assert!(inner > 0, "{:?}", all.work_counts());
    for cell in all.cells().filter(|cell| cell.kind == CellKind::Blocked) {
        let middle = cell.corners[0] + (cell.corners[2] - cell.corners[0]) * 0.5;
        let Ok(Verdict::Blocked(pair)) = all.classify(middle) else { panic!("{middle}") };
        assert!(cell.blocked_by.is_some() && pair[0] < ring.triangles().len() as u32);
        let cast = Cast::<Solid>::new(ring.at(Pose::IDENTITY), rod.at(Pose::IDENTITY), middle);
        assert!(!cast.unwrap().with_tolerance(0.0).unwrap().clearance().unwrap().is_free());
    }
    let refused = |proof: &FreeProof| {
        FreeDirections::from_proof(&ring.at(Pose::IDENTITY), &rod.at(Pose::IDENTITY), proof)
            .is_err()
    };
    assert!(!refused(&proof));
    for side in 0..2 {
        for at in 0..proof.boxes[side].len() {
            for k in 0..3 {
                // A larger box leaves the body. Then a box outside, and an inverted one.
                let mut other = proof.clone();
                other.boxes[side][at].high[k] += 8.0;
                assert!(refused(&other));
                other.boxes[side][at].low[k] += 8.0;
                assert!(refused(&other));
                let InnerBox { low, high } = &mut other.boxes[side][at];
                std::mem::swap(low, high);
                assert!(refused(&other));
            }
        }
    }
    let ignored = FreeProof { start_overlap: StartOverlap::Ignore, ..proof };
    assert!(refused(&ignored), "boxes inside do not block if the start overlap is ignored");
}

#[test]
fn free_directions_of_hulls_match_brute_force_over_facets() {
    let mut rng = Random::new(2903);
    let mut judged = [0_u32; 2];
    for count in [4, 8, 20, 40] {
        let mut hull = |by: f64| {
            let corners: Vec<DVec3> = (0..count)
                .map(|_| DVec3::from([0; 3].map(|_| rng.range(-1.0, 1.0))) * by)
                .collect();
            Solid::from_convex(&ConvexPolyhedron::from_points(&corners).unwrap()).unwrap()
        };
        let (a, b) = (hull(1.0), hull(2.0));
        let place = Pose::from_translation(DVec3::new(2.5, 1.5, 0.75)).unwrap();
        let (a, b) = (a.at(place), b.at(Pose::IDENTITY));
        let Ok(all) = FreeDirections::compute(&a, &b, EXACT) else { continue };
        all.verify().unwrap();
        assert!(all.is_complete());
        let corners: Vec<DVec3> = all.cells().flat_map(|cell| cell.corners).collect();
        for k in 0..24 {
            let any = DVec3::from([0; 3].map(|_| rng.range(-1.0, 1.0)));
            let d = if k % 2 == 0 {
                any
            } else {
                corners[rng.int(0, corners.len() as i64 - 1) as usize]
            };
            let free = is_free_of_all([a, b], d);
            assert_eq!(all.classify(d).unwrap() == Verdict::Free, free, "{count}: {d}");
            judged[usize::from(free)] += 1;
        }
    }
    assert!(judged[0] > 10 && judged[1] > 10, "{judged:?}");
}

#[test]
fn region_center_maximises_margin() {
    let (lid, table) =
        (cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 1.0]), cuboid([-3.0, -2.0, -1.0], [2.0, 5.0, 0.0]));
    let half = &free_directions(&lid, &table, EXACT).regions()[0];
    assert!(half.center.z > 0.999 && (half.margin - PI / 2.0).abs() < 0.05, "{half:?}");
    let border: f64 = half.border.iter().map(|[a, b]| a.angle_between(*b)).sum();
    assert!((border - TAU).abs() < 1e-9, "{border}");
    let [bar, tube] = bar_in_tube();
    let all = free_directions(&bar, &tube, EXACT.with_tolerance(0.1));
    for region in all.regions() {
        // For a square of directions the margin is half of its side.
        assert!(region.center.x.abs() > 0.999_99, "{}", region.center);
        let nearest = region.corners.iter().map(|c| c.normalize().distance(region.center));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(region.margin < nearest && region.margin > 0.69 * nearest, "{region:?}");
    }
    // All directions are free except a square below, so the farthest direction is on the opposite side.
    let (high, small) = (cuboid([0.0, 0.0, 9.0], [1.0, 1.0, 10.0]), cuboid([0.0; 3], [1.0; 3]));
    let most = &free_directions(&high, &small, EXACT).regions()[0];
    assert!(most.margin > 2.5 && most.center.z > 0.9, "{} {}", most.margin, most.center);
}

#[test]
fn window_margin_and_corners_are_rotation_invariant() {
    // A cube in a room with a window has one convex region. Each rotation divides it at other cell sides.
    let cube = cuboid([-0.2; 3], [0.2; 3]);
    let room = union_of(&ROOM_WITH_WINDOW.map(|[low, high]| cuboid(low, high)));
    // The cube's upper edge passes the window's front edge, its lower edge the back edge: z / x is between
    // 0.7 / 1.8 and 1.1 / 2.4, y / x between -0.6 / 2.4 and 0.6 / 2.4.
    let (low, high) = ((0.7_f64 / 1.8).atan(), (1.1_f64 / 2.4).atan());
    let mut random = Random::new(5);
    for round in 0..cases(60) {
        let turn = if round == 0 { DQuat::IDENTITY } else { random.rotation() };
        let pose = Pose::new(turn, DVec3::ZERO).unwrap();
        let all =
            FreeDirections::compute(&cube.at(pose), &room.at(pose), FreeOptions::DEFAULT).unwrap();
        let regions = all.regions();
        assert_eq!(regions.len(), 1, "{round}");
        let region = &regions[0];
        assert_eq!(all.classify(region.center), Ok(Verdict::Free), "{round}");
        // The region lies between two planes that are rotated about y. The margin is at most half of their angle.
        let half = (high - low) / 2.0;
        assert!((0.99 * half..1.001 * half).contains(&region.margin), "{round} {}", region.margin);
        assert_eq!(region.corners.len(), 4, "{round} {:?}", region.corners);
    }
}

#[test]
#[ignore = "long: exact fractions in every rotation"]
fn arcs_and_points_are_rotation_invariant() {
    let [bar, tube] = bar_in_tube();
    let plate = cuboid([0.0; 3], [1.0; 3]);
    let slabs = [([-5.0, -5.0, -1.0], [5.0, 5.0, 0.0]), ([-5.0, -5.0, 1.0], [5.0, 5.0, 2.0])];
    // A stop on one side takes half of the circle. A stop at a distance takes less.
    let stop = ([-2.0, -5.0, 0.0], [0.0, 5.0, 1.0]);
    let far = ([-2.0, -2.0, 0.0], [-1.0, 3.0, 1.0]);
    let stack = |more: &[_]| {
        let all: Vec<Solid> =
            slabs.iter().chain(more).map(|(low, high)| cuboid(*low, *high)).collect();
        union_of(&all)
    };
    let cases = [
        (&bar, tube, 2, 0.0, 0),
        (&plate, stack(&[]), 0, TAU, 1),
        (&plate, stack(&[stop]), 0, PI, 1),
        // The stop is at distance 1 from the plate and extends by 3 to each side.
        (&plate, stack(&[far]), 0, TAU - 2.0 * (3.0_f64).atan(), 1),
    ];
    let mut random = Random::new(71);
    for round in 0..6 {
        let turn = if round == 0 { DQuat::IDENTITY } else { random.rotation() };
        let pose = Pose::new(turn, DVec3::new(0.5, -3.0, 2.0)).unwrap();
        for (moving, fixed, points, long, arcs) in &cases {
            let (a, b) = (moving.at(pose), fixed.at(pose));
            let all = FreeDirections::compute(&a, &b, EXACT).unwrap();
            all.verify().unwrap();
            assert_area(&all, 0.0);
            assert_eq!((all.points().len(), all.arcs().len()), (*points, *arcs), "{round}");
            assert!((arc_length(&all) - long).abs() < 1e-9, "{round}: {} {long}", arc_length(&all));
            judge(&all, [a, b]).unwrap_or_else(|e| panic!("{round}: {e}"));
        }
    }
}
