//! Solids in the situations that people have names for.

use colltrans_convex::{
    Bounded, Cast, Clearance, ContactRange, ConvexPolyhedron, InputFacet, Outcome, Pair, Pose,
    QueryError,
};
use colltrans_solid::{
    Overlap, ShellKind, Solid, SolidCast, SolidError, SolidOptions, SolidOverlap, SolidPair,
    StartOverlap,
};
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, block, extruded, ring};
use colltrans_testkit::solids::{bolt, pin, slab, turned, washer};
use glam::{DMat3, DQuat, DVec3};

use crate::common::{at, cuboid, solid};

/// In place, along a direction.
fn cast<'a>(a: &'a Solid, b: &'a Solid, direction: DVec3) -> Cast<'a, Solid> {
    Cast::new(a.at(Pose::IDENTITY), b.at(Pose::IDENTITY), direction).expect("a direction")
}

#[expect(clippy::large_types_passed_by_value, reason = "it is turned into another one")]
fn with_tolerance(cast: Cast<'_, Solid>, tolerance: f64) -> Cast<'_, Solid> {
    cast.with_tolerance(tolerance).expect("a tolerance")
}

/// Of the shrunk bodies.
fn distance(cast: &Cast<Solid>) -> f64 {
    match cast.clearance().expect("an answer") {
        Clearance::Blocked { contact, .. } => contact.offset_distance.value,
        other => panic!("{other:?}"),
    }
}

/// How far the chords of a circle are inside it.
fn chord_error(radius: f64, sides: usize) -> f64 {
    radius * (1.0 - (std::f64::consts::PI / sides as f64).cos())
}

#[test]
fn pins_in_holes_of_one_radius() {
    for (pin_sides, hole_sides) in [(32, 32), (32, 48), (64, 24), (128, 127)] {
        let pin = solid(&pin(1.0, [-2.0, 3.0], pin_sides));
        let plate = solid(&washer([1.0, 4.0], [0.0, 1.0], hole_sides));
        // Both tessellations together, on either body half of it.
        let fit = chord_error(1.0, pin_sides) + chord_error(1.0, hole_sides);
        for direction in [DVec3::Z, DVec3::NEG_Z] {
            let out = with_tolerance(cast(&pin, &plate, direction), 2.0 * fit);
            assert!(out.clearance().expect("an answer").is_free(), "{pin_sides} in {hole_sides}");
            // Prisms of the same sides have no shadows in common; others are out after 3.
            match out.exit() {
                None => assert_eq!(pin_sides, hole_sides),
                Some(exit) => {
                    assert!((exit.value - 3.0).abs() < 1e-12, "{exit:?}");
                    assert!(exit.lower <= 3.0 && 3.0 <= exit.upper, "{exit:?}");
                }
            }
        }
        let aside = with_tolerance(cast(&pin, &plate, DVec3::X), 2.0 * fit);
        assert!(distance(&aside) < 4.0 * fit);
    }
    // The same tessellation slides without any tolerance.
    let (pin, plate) =
        (solid(&pin(1.0, [-2.0, 3.0], 32)), solid(&washer([1.0, 4.0], [0.0, 1.0], 32)));
    assert!(cast(&pin, &plate, DVec3::Z).clearance().expect("an answer").is_free());
    assert_eq!(distance(&cast(&pin, &plate, DVec3::X)), 0.0);
}

#[test]
fn a_bolt_whose_head_stops_at_seven() {
    let bolt = solid(&bolt([1.0, 2.0], [-5.0, 8.0, 9.0], 48));
    let plate = solid(&washer([1.0, 4.0], [0.0, 1.0], 32));
    let fit = 2.0 * (chord_error(1.0, 48) + chord_error(1.0, 32));
    let in_hole = with_tolerance(cast(&bolt, &plate, DVec3::NEG_Z), fit);
    let Clearance::Blocked { distance, contact } = in_hole.clearance().expect("an answer") else {
        panic!("{:?}", in_hole.clearance().expect("an answer"))
    };
    assert!(distance <= 7.0 && 7.0 - distance < 1e-12, "safe to move by: {distance}");
    let Bounded { value, lower, upper } = contact.translation;
    assert!((value - 7.0).abs() < 1e-12, "{value}");
    assert!(lower == distance && upper >= 7.0 && upper - lower < 1e-12, "{contact:?}");
    let shrunk = contact.offset_distance;
    assert!((shrunk.value - 7.0 - fit).abs() < 1e-9, "the shrunk bodies meet later: {shrunk:?}");
    assert!(shrunk.upper - shrunk.lower < 1e-12, "{shrunk:?}");
    assert_eq!(contact.normal, DVec3::NEG_Z);
    assert!((in_hole.least_tolerance().expect("slivers overlap") - fit).abs() < fit);
}

#[test]
fn a_plate_that_rests_on_a_table() {
    let table = cuboid([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0]);
    let plate = solid(&slab(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.5), [5, 7, 2]));
    assert_eq!(distance(&cast(&plate, &table, DVec3::NEG_Z)), 0.0);
    for free in [DVec3::Z, DVec3::X, DVec3::NEG_Y, DVec3::new(0.3, -0.7, 0.0)] {
        assert!(cast(&plate, &table, free).clearance().expect("an answer").is_free(), "{free}");
    }
    assert!(cast(&plate, &table, DVec3::Z).intersects().expect("an answer").meets);
    assert!(!cast(&plate, &table, DVec3::Z).overlaps());
    assert_eq!(distance(&cast(&plate, &table, DVec3::new(1.0, 0.0, -1e-9))), 0.0);
}

#[test]
fn a_plate_pressed_into_a_table() {
    let table = cuboid([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0]);
    let plate = cuboid([-1.0, -1.0, -0.125], [1.0, 1.0, 0.5]);
    let down = cast(&plate, &table, DVec3::NEG_Z);
    let Clearance::Overlapping(SolidOverlap { least_tolerance: Some(depth), .. }) =
        down.clearance().expect("an answer")
    else {
        panic!("{:?}", down.clearance().expect("an answer"))
    };
    assert!((depth - 0.125).abs() < 1e-9, "{depth}");
    let tolerated = |direction| with_tolerance(cast(&plate, &table, direction), depth);
    assert!(distance(&tolerated(DVec3::NEG_Z)) < 1e-9);
    assert!(tolerated(DVec3::Z).clearance().expect("an answer").is_free());
    assert!(tolerated(DVec3::X).clearance().expect("an answer").is_free());
}

#[test]
fn what_was_ignored_at_the_start_is_told() {
    let table = cuboid([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0]);
    let plate = cuboid([-1.0, -1.0, -0.125], [1.0, 1.0, 0.5]);
    let aside = cast(&plate, &table, DVec3::X).with_start_overlap(StartOverlap::Ignore);
    assert!(aside.clearance().expect("an answer").is_free());
    let told = aside.start_overlap().expect("it is pressed in");
    assert!((told.least_tolerance.expect("a tolerance") - 0.125).abs() < 1e-9, "{told:?}");
    let Overlap::Facets(f, g) = told.place else { panic!("{told:?}") };
    // A facet that reaches from below the table's top to above it, and one of the top or the like.
    let heights = |s: &Solid, t: u32| s.triangles()[t as usize].map(|v| s.vertices()[v as usize].z);
    assert!(heights(&plate, f).contains(&-0.125), "{told:?}");
    assert!(heights(&table, g).contains(&0.0), "{told:?}");
    // The answer that refuses tells the same, and with a tolerance of the depth there is nothing.
    let refused = aside.with_start_overlap(StartOverlap::Refuse).clearance().expect("an answer");
    assert!(matches!(refused, Clearance::Overlapping(same) if same == told), "{refused:?}");
    let depth = told.least_tolerance.expect("a tolerance");
    assert_eq!(aside.with_tolerance(depth).expect("a tolerance").start_overlap(), None);
    // Half of it tolerated changes where, but not how deep.
    let half = aside.with_tolerance(depth / 2.0).expect("a tolerance").start_overlap();
    assert_eq!(half.expect("it still is").least_tolerance, told.least_tolerance);
    // What is inside.
    let (block, part) = (cuboid([-3.0; 3], [3.0; 3]), cuboid([-0.5; 3], [0.5; 3]));
    let place = |a, b| cast(a, b, DVec3::X).start_overlap().map(|o| o.place);
    assert!(matches!(place(&part, &block), Some(Overlap::MovingInside(_))));
    assert!(matches!(place(&block, &part), Some(Overlap::FixedInside(_))));
    let beside = cuboid([3.0, 0.0, 0.0], [4.0, 1.0, 1.0]);
    assert_eq!(place(&beside, &block), None);
}

/// A tolerance shrinks both by half of it. The cube of side 1 is nothing at 1, and still inside then, 2.5 from the
/// sides of a block; 0.375 below its top, it is free at 0.375. Two triangles back to back are nothing to begin with.
#[test]
fn what_is_too_deep_inside_is_parted_by_no_tolerance() {
    let (block, part) = (cuboid([-3.0; 3], [3.0; 3]), cuboid([-0.5; 3], [0.5; 3]));
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let two_sides = Solid::from_mesh(&corners, &[[0, 1, 2], [0, 2, 1]]).expect("closed");
    let least = |moving: &Solid, z: f64| {
        let pair =
            Pair::new(moving.at(at(DVec3::Z * z)), block.at(Pose::IDENTITY)).expect("a pair");
        let found = pair.overlap_depth().expect("an answer");
        assert!(found.meets && found.steps.nodes > 0);
        found.least_tolerance
    };
    for (moving, z) in [(&part, 0.0), (&part, 2.25), (&two_sides, 0.0), (&two_sides, 2.75)] {
        assert_eq!(least(moving, z), None, "{z}");
    }
    let pressed = least(&part, 3.125).expect("a tolerance");
    assert!((pressed - 0.375).abs() < 1e-9, "{pressed}");
    assert_eq!(least(&two_sides, 3.0), Some(0.0));
}

#[test]
fn a_blind_press_fit() {
    // A cup with walls at radius 1, its bottom at 0; a pin 0.01 too thick, 1 above the bottom.
    let cup = solid(&turned(
        &[[0.0, -1.0], [3.0, -1.0], [3.0, 4.0], [1.0, 4.0], [1.0, 0.0], [0.0, 0.0]],
        24,
    ));
    let pin = solid(&pin(1.01, [1.0, 6.0], 24));
    let press = |direction| cast(&pin, &cup, direction);
    assert!(matches!(press(DVec3::Z).clearance().expect("an answer"), Clearance::Overlapping(_)));
    // The interference of the flat sides, and of the bodies' edges, which are 0.01 too far out.
    let interference = 0.02;
    let tolerated = |direction| with_tolerance(press(direction), interference);
    assert!(tolerated(DVec3::Z).clearance().expect("an answer").is_free());
    let Clearance::Blocked { contact, .. } =
        tolerated(DVec3::NEG_Z).clearance().expect("an answer")
    else {
        panic!("the bottom")
    };
    assert!((contact.translation.value - 1.0).abs() < 1e-9, "{contact:?}");
    // Ignored, the overlap does not hide the bottom either.
    let ignore = SolidOptions::default().with_start_overlap(StartOverlap::Ignore);
    let ignoring = press(DVec3::NEG_Z).with_options(ignore).expect("choices");
    assert!((distance(&ignoring) - 1.0).abs() < 1e-9);
}

#[test]
fn a_part_sealed_in_a_cavity() {
    let hollow = slab(DVec3::splat(-3.0), DVec3::splat(3.0), [2; 3])
        .joined(&slab(DVec3::splat(-2.0), DVec3::splat(2.0), [3; 3]).reversed());
    let hollow = solid(&hollow);
    assert_eq!(hollow.report().shells.len(), 2);
    assert!((hollow.volume() - 152.0).abs() < 1e-12);
    let part = cuboid([-0.5; 3], [0.5; 3]);
    assert_eq!(distance(&cast(&part, &hollow, DVec3::X)), 1.5);
    assert!(!cast(&part, &hollow, DVec3::X).overlaps());
    let exit = cast(&part, &hollow, DVec3::X).exit().expect("walls behind");
    assert_eq!(exit.value, 3.5);
    assert!(exit.lower < 3.5 && 3.5 < exit.upper && exit.upper - exit.lower < 1e-12, "{exit:?}");
}

#[test]
fn the_volumes_of_shrunk_and_grown_shells() {
    // Far apart in the tree, the second one with a cavity.
    let cube = |low: f64, high: f64| slab(DVec3::splat(low), DVec3::splat(high), [2; 3]);
    let mesh = cube(40.0, 41.0).joined(&cube(-3.0, 3.0)).joined(&cube(-2.0, 2.0).reversed());
    let body = solid(&mesh);
    let near = |body: &Solid, right: [f64; 3]| {
        let found: Vec<f64> = body.report().shells.iter().map(|s| s.volume).collect();
        assert_eq!(found.len(), 3);
        let all = found.iter().zip(right).all(|(x, y)| (x - y).abs() < 1e-9);
        assert!(all, "{found:?}, not {right:?}");
        assert!((body.volume() - right.iter().sum::<f64>()).abs() < 1e-9);
    };
    near(&body, [1.0, 216.0, -64.0]);
    near(&body.shrunk(0.25).expect("an amount").0, [0.125, 166.375, -91.125]);
    near(&body.grown(0.5).expect("an amount").0, [8.0, 343.0, -27.0]);
    // By more than half its size the small cube is mirrored in its middle, and the wall between the
    // other shells, 1 thick, passes through itself: that is said of all their facets.
    let (mirrored, said) = body.shrunk(0.75).expect("an amount");
    near(&mirrored, [-0.125, 91.125, -166.375]);
    assert_eq!(said.inverted, (0..72).map(InputFacet).collect::<Vec<_>>());
    assert!(body.shrink_report(0.25).inverted.is_empty());
}

/// A box around a cavity.
fn hollow(outside: DVec3, cavity: [DVec3; 2], counts: [usize; 3]) -> Solid {
    let around = slab(-outside, outside, counts);
    solid(&around.joined(&slab(cavity[0], cavity[1], counts.map(|n| n + 1)).reversed()))
}

#[test]
fn a_wall_all_round_a_cavity_passes_through_itself() {
    let wall = 0.0625;
    let inside = DVec3::splat(1.0 - wall);
    for counts in [[1; 3], [3, 2, 4]] {
        let thin = hollow(DVec3::ONE, [-inside, inside], counts);
        let said = |amount: f64| thin.shrink_report(amount).inverted;
        assert_eq!(said(0.49 * wall), []);
        // Then both shells are named: each is on the wrong side of the other.
        for amount in [0.51 * wall, wall, 3.0 * wall] {
            let last = thin.facet_indices().iter().max().expect("facets");
            assert_eq!(said(amount), (0..=last.0).map(InputFacet).collect::<Vec<_>>(), "{amount}");
        }
        // Grown, the wall only gets thicker.
        assert_eq!(thin.grown(0.25).expect("an amount").1.inverted, []);
        assert!(thin.shrunk(0.6 * wall).expect("an amount").1.fixed_vertices.is_empty());
    }
}

#[test]
fn a_wall_on_one_side_of_a_cavity_passes_through_itself() {
    let wall = 0.0625;
    for counts in [[1; 3], [3, 2, 4]] {
        let cavity = [DVec3::new(-0.5, -0.25, -0.25), DVec3::new(1.0 - wall, 0.5, 0.25)];
        let thin = hollow(DVec3::ONE, cavity, counts);
        assert_eq!(thin.shrink_report(0.49 * wall).inverted, []);
        assert!(!thin.shrink_report(0.51 * wall).inverted.is_empty());
    }
    // Two cavities, and the wall between them.
    let block = slab(DVec3::splat(-2.0), DVec3::splat(2.0), [2; 3]);
    let cavity = |low: f64, high: f64| {
        let corner =
            |x| DVec3::new(x, 0.5_f64.copysign(x - low - 0.1), 1.0_f64.copysign(x - low - 0.1));
        slab(corner(low), corner(high), [1, 2, 1]).reversed()
    };
    let two = solid(&block.joined(&cavity(-1.0, -0.03)).joined(&cavity(0.03, 1.0)));
    assert_eq!(two.shrink_report(0.029).inverted, []);
    assert!(!two.shrink_report(0.031).inverted.is_empty());
}

#[test]
fn the_bottom_of_a_pocket_passes_through_the_underside() {
    // One shell, turned about z: a cup whose bottom is 0.01 thick and whose walls are 1.
    let profile = [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [1.0, 3.0], [1.0, 0.01], [0.0, 0.01]];
    let cup = solid(&turned(&profile, 24));
    assert_eq!(cup.shrink_report(0.0049).inverted, []);
    assert!(!cup.shrink_report(0.0051).inverted.is_empty());
    // The other way round, a pocket of that width closes when the body grows.
    let slit = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 3.0],
        [1.01, 3.0],
        [1.01, 1.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [0.0, 3.0],
    ];
    let slit = solid(&turned(&slit, 64));
    let grown = |amount: f64| slit.grown(amount).expect("an amount").1.inverted;
    assert_eq!(grown(0.0049), []);
    assert!(!grown(0.0051).is_empty());
}

#[test]
fn pieces_that_overlap_are_no_thin_walls() {
    let bars =
        [cuboid([-3.0, -0.5, -0.5], [3.0, 0.5, 0.5]), cuboid([-0.4, -3.0, -0.7], [0.6, 3.0, 0.3])];
    let cross = Solid::from_pieces(&bars).expect("two pieces");
    assert_eq!(cross.shrink_report(0.1).inverted, []);
    // A rod through the wall of a cavity, and loose parts in it.
    let block = hollow(DVec3::splat(4.0), [DVec3::splat(-2.0), DVec3::splat(2.0)], [3; 3]);
    let rod = solid(&slab(DVec3::new(1.0, -0.3, -0.2), DVec3::new(6.0, 0.31, 0.22), [9, 1, 1]));
    let loose = cuboid([-1.5; 3], [-1.0; 3]);
    let all = Solid::from_pieces([&block, &rod, &loose]).expect("three pieces");
    assert_eq!(all.shrink_report(0.05).inverted, []);
}

#[test]
fn a_body_in_a_filled_cavity_overlaps() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let wall = hollow_box([[-1.0; 3], [2.0; 3]], Some([[0.0; 3], [1.0; 3]]));
    assert!(!cast(&cube, &wall, DVec3::X).overlaps());
    let filled = Solid::from_pieces([&wall, &cuboid([-0.5; 3], [1.5; 3])]).expect("two pieces");
    for (moving, fixed) in [(&cube, &filled), (&filled, &cube)] {
        let cast = cast(moving, fixed, DVec3::X);
        assert!(cast.overlaps());
        assert!(matches!(cast.clearance().expect("an answer"), Clearance::Overlapping(_)));
    }
    let beside = Solid::from_pieces([&wall, &cuboid([1.0, 0.0, 0.0], [3.0, 1.0, 1.0])]);
    assert!(!cast(&cube, &beside.expect("two pieces"), DVec3::X).overlaps());
}

/// A box with or without a cavity.
fn hollow_box([low, high]: [[f64; 3]; 2], cavity: Option<[[f64; 3]; 2]>) -> Solid {
    let outside = block(low, high);
    solid(&match cavity {
        Some([low, high]) => outside.joined(&block(low, high).reversed()),
        None => outside,
    })
}

/// A box overlaps a union of hollow boxes if it has a cell of one of them. All corners are integers, so that faces lie
/// on each other.
#[test]
fn boxes_overlap_unions_of_hollow_boxes_that_have_one_of_their_cells() {
    let mut random = Random::new(2030);
    let mut counts = [0; 2];
    let any_box = |random: &mut Random, [low, high]: [i64; 2], least: i64| {
        let lows = [0; 3].map(|_| random.int(low, high - least));
        [lows, lows.map(|x| random.int(x + least, high))]
    };
    let corners = |ends: [[i64; 3]; 2]| ends.map(|corner| corner.map(|x| x as f64));
    let contains = |[low, high]: [[i64; 3]; 2], cell: [i64; 3]| {
        (0..3).all(|k| low[k] <= cell[k] && cell[k] < high[k])
    };
    for round in 0..cases(4_000) {
        let moving = any_box(&mut random, [0, 5], 1);
        let outside = any_box(&mut random, [0, 5], 3);
        let cavity = [0, 1, 2].map(|k| {
            let [low, high] = outside.map(|corner| corner[k]);
            let first = random.int(low + 1, high - 2);
            [first, random.int(first + 1, high - 1)]
        });
        let cavity = [0, 1].map(|end| cavity.map(|ends| ends[end]));
        let pieces = [(outside, Some(cavity)), (any_box(&mut random, [0, 5], 1), None)];
        let is_filled = |cell| {
            pieces.iter().any(|(outside, cavity)| {
                contains(*outside, cell) && !cavity.is_some_and(|cavity| contains(cavity, cell))
            })
        };
        let cells = (0..125).map(|k| [k % 5, k / 5 % 5, k / 25]);
        let expected = cells.filter(|&cell| contains(moving, cell)).any(is_filled);
        let fixed =
            pieces.map(|(outside, cavity)| hollow_box(corners(outside), cavity.map(corners)));
        let fixed = Solid::from_pieces(&fixed).expect("two pieces");
        let moving = hollow_box(corners(moving), None);
        assert_eq!(cast(&moving, &fixed, DVec3::X).overlaps(), expected, "{round}: {pieces:?}");
        assert_eq!(cast(&fixed, &moving, DVec3::X).overlaps(), expected, "{round}: {pieces:?}");
        counts[usize::from(expected)] += 1;
    }
    assert!(counts.iter().all(|&n| n > cases(200)), "{counts:?}");
}

/// Boxes of one mesh overlap, and have edges, faces or all facets in common. Each is closed, so that a box overlaps them
/// if it has a cell of one of them.
#[test]
fn overlapping_boxes_of_one_mesh_with_common_edges_have_an_inside() {
    let mut random = Random::new(2031);
    let (mut crowded, mut counts) = (0, [0; 2]);
    let any_box = |random: &mut Random| {
        let lows = [0; 3].map(|_| random.int(0, 2));
        [lows, lows.map(|x| random.int(x + 1, 3))]
    };
    let mesh_of = |ends: [[i64; 3]; 2]| {
        let [low, high] = ends.map(|corner| corner.map(|x| x as f64));
        block(low, high)
    };
    let contains = |[low, high]: [[i64; 3]; 2], cell: [i64; 3]| {
        (0..3).all(|k| low[k] <= cell[k] && cell[k] < high[k])
    };
    for round in 0..cases(4_000) {
        let boxes: Vec<_> = (0..random.int(2, 4)).map(|_| any_box(&mut random)).collect();
        let mut mesh = Mesh { vertices: Vec::new(), faces: Vec::new() };
        for &ends in &boxes {
            mesh = mesh.joined(&mesh_of(ends));
        }
        if random.one_in(2) {
            mesh = mesh.triangulated();
        }
        if random.one_in(2) {
            for k in (1..mesh.faces.len()).rev() {
                mesh.faces.swap(k, random.index(k + 1));
            }
        }
        let fixed = solid(&mesh);
        let report = fixed.report();
        let is_closed = report.shells.iter().all(|shell| shell.kind == ShellKind::Closed);
        assert!(is_closed && report.open_edges == 0, "{round}: {boxes:?}");
        crowded += usize::from(report.non_manifold_edges > 0);
        let volume: i64 =
            boxes.iter().map(|[p, q]| (0..3).map(|k| q[k] - p[k]).product::<i64>()).sum();
        assert!((fixed.volume() - volume as f64).abs() < 1e-12, "{round}: {boxes:?}");
        let moving = any_box(&mut random);
        let is_filled = |cell| boxes.iter().any(|&ends| contains(ends, cell));
        let cells = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9]);
        let expected = cells.filter(|&cell| contains(moving, cell)).any(is_filled);
        let moving = solid(&mesh_of(moving));
        assert_eq!(cast(&moving, &fixed, DVec3::X).overlaps(), expected, "{round}: {boxes:?}");
        assert_eq!(cast(&fixed, &moving, DVec3::X).overlaps(), expected, "{round}: {boxes:?}");
        counts[usize::from(expected)] += 1;
    }
    assert!(
        crowded > cases(1_000) && counts.iter().all(|&n| n > cases(200)),
        "{crowded} {counts:?}"
    );
}

/// Two prisms overlap, with one edge in common, and a grain lies in both.
#[test]
fn a_body_inside_overlapping_prisms_with_a_common_edge_overlaps() {
    let turned = |[x, y]: [f64; 2]| DVec3::new(0.75 * x - 0.5 * y, 0.5 * x + 0.75 * y, 0.0);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let both = block(DVec3::ZERO, DVec3::ONE).joined(&extruded(&corners.map(turned), [0.0, 1.0]));
    let both = solid(&both);
    assert_eq!(both.report().non_manifold_edges, 1);
    assert_eq!(
        both.report().shells.iter().map(|shell| shell.triangles).collect::<Vec<_>>(),
        [12; 2]
    );
    let grain = cuboid([0.3, 0.35, 0.4], [0.4, 0.45, 0.6]);
    assert!(cast(&grain, &both, DVec3::X).overlaps() && cast(&both, &grain, DVec3::X).overlaps());
}

#[test]
fn thin_triangles_of_large_faces_are_told_apart() {
    // Boxes of thin triangles in one plane overlap by the thousand.
    let ring = solid(&washer([1.0, 2.0], [0.0, 1.0], 5_000));
    assert!(ring.shrink_report(1e-4).inverted.is_empty());
}

#[test]
fn a_prism_of_20_000_sides_round_and_jagged() {
    let sides = 20_000;
    for radii in [[1.0, 1.0], [1.0, 0.6]] {
        let outline = ring(sides, 1.0, 0.0).enumerate().map(|(k, p)| p * radii[k % 2]);
        let prism = solid(&extruded(&outline.collect::<Vec<_>>(), [0.0, 1.0]));
        assert_eq!(prism.triangles().len(), 4 * sides - 4);
        let area =
            0.5 * sides as f64 * radii[0] * radii[1] * (std::f64::consts::TAU / sides as f64).sin();
        assert!((prism.volume() / area - 1.0).abs() < 1e-9, "{}", prism.volume());
        let on_top = cast(&prism, &prism, DVec3::Z);
        assert!(on_top.overlaps());
        let above = Pose::from_translation(DVec3::Z * 3.0).expect("in range");
        let down = Cast::new(prism.at(above), prism.at(Pose::IDENTITY), DVec3::NEG_Z);
        assert_eq!(distance(&down.expect("a direction")), 2.0);
    }
}

#[test]
fn a_flat_polygon_is_a_sheet_and_a_segment_is_no_solid() {
    let flat = |z: f64| {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::Z * z);
        ConvexPolyhedron::from_points(&corners).expect("a triangle")
    };
    let block = cuboid([-3.0; 3], [3.0; 3]);
    for (z, inside) in [(0.0, true), (3.0, false), (4.0, false)] {
        let sheet = flat(z);
        let down = Cast::between(sheet.at(Pose::IDENTITY), block.at(Pose::IDENTITY), DVec3::NEG_Z)
            .expect("a direction");
        assert_eq!(down.overlaps(), inside, "at {z}");
        assert!(inside || distance(&down) == z - 3.0);
    }
    let segment = ConvexPolyhedron::from_points(&[DVec3::ZERO, DVec3::X]).expect("a segment");
    assert!(matches!(Solid::from_convex(&segment), Err(SolidError::NoArea { .. })));
}

#[test]
fn a_part_inside_solid_material() {
    let block = cuboid([-3.0; 3], [3.0; 3]);
    let part = cuboid([-0.5; 3], [0.5; 3]);
    assert!(cast(&part, &block, DVec3::X).overlaps());
    assert!(cast(&block, &part, DVec3::X).overlaps());
    assert!(cast(&part, &block, DVec3::X).intersects().expect("an answer").meets);
    // Its corners touch the walls from inside: still inside.
    let octahedron = turned(&[[0.0, -3.0], [3.0, 0.0], [0.0, 3.0]], 4);
    assert!(cast(&solid(&octahedron), &block, DVec3::X).overlaps());
    // An open surface has no inside: nothing that is within it overlaps it.
    let mesh = slab(DVec3::splat(-3.0), DVec3::splat(3.0), [1; 3]);
    let shell = Solid::from_open_mesh(&mesh.vertices, &mesh.faces[1..]).expect("a surface");
    assert!(!cast(&part, &shell, DVec3::X).overlaps());
    assert!(Solid::from_mesh(&mesh.vertices, &mesh.faces[1..]).is_err());
}

#[test]
fn a_solid_in_its_own_place_overlaps_itself() {
    let plate = solid(&washer([1.0, 4.0], [0.0, 1.0], 16));
    assert!(cast(&plate, &plate, DVec3::Z).overlaps());
    let beside = cuboid([0.0; 3], [1.0; 3]);
    let next = cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]);
    assert!(!cast(&beside, &next, DVec3::X).overlaps());
}

fn wedge(apex: DVec3, base: [DVec3; 4]) -> Solid {
    // A ridge from `apex` along y, and a base of four corners counter-clockwise from outside.
    let vertices = [apex, apex + DVec3::Y, base[0], base[1], base[2], base[3]];
    let faces: [&[u32]; 5] = [&[0, 1, 3, 2], &[1, 0, 5, 4], &[0, 2, 5], &[1, 4, 3], &[2, 3, 4, 5]];
    Solid::from_mesh(&vertices, &faces).expect("a wedge")
}

#[test]
fn wedges_that_share_an_edge_and_part() {
    let upper = wedge(
        DVec3::ZERO,
        [
            DVec3::new(-1.0, 0.0, 1.0),
            DVec3::new(-1.0, 1.0, 1.0),
            DVec3::new(1.0, 1.0, 1.0),
            DVec3::new(1.0, 0.0, 1.0),
        ],
    );
    let lower = upper.clone();
    let half_turn = Pose::new(DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0), DVec3::Y).expect("a rotation");
    let ask = |direction| {
        Cast::new(upper.at(Pose::IDENTITY), lower.at(half_turn), direction).expect("a direction")
    };
    assert!(ask(DVec3::Z).clearance().expect("an answer").is_free());
    assert!(ask(DVec3::X).clearance().expect("an answer").is_free());
    assert_eq!(distance(&ask(DVec3::NEG_Z)), 0.0);
}

#[test]
fn vertex_on_vertex() {
    let spike = solid(&turned(&[[0.0, 0.0], [1.0, 2.0], [0.0, 2.0]], 5));
    let under = solid(&turned(&[[0.0, -2.0], [1.0, -2.0], [0.0, 0.0]], 7));
    assert!(cast(&spike, &under, DVec3::Z).clearance().expect("an answer").is_free());
    assert!(cast(&spike, &under, DVec3::X).clearance().expect("an answer").is_free());
    assert_eq!(distance(&cast(&spike, &under, DVec3::NEG_Z)), 0.0);
}

#[test]
fn a_zero_clearance_slide_of_100_000_facets() {
    // A bar in a groove of its own width, both in many facets of different sizes.
    let bar = solid(&slab(DVec3::new(-4.0, -1.0, 0.0), DVec3::new(4.0, 1.0, 1.0), [160, 60, 40]));
    let groove = [
        slab(DVec3::new(-4.0, 1.0, -1.0), DVec3::new(4.0, 2.0, 1.0), [150, 20, 50]),
        slab(DVec3::new(-4.0, -2.0, -1.0), DVec3::new(4.0, -1.0, 1.0), [140, 20, 50]),
        slab(DVec3::new(-4.0, -1.0, -1.0), DVec3::new(4.0, 1.0, 0.0), [150, 50, 20]),
    ]
    .map(|mesh| solid(&mesh));
    let groove = Solid::from_pieces(&groove).expect("three pieces");
    assert!(bar.triangles().len() + groove.triangles().len() > 100_000);
    let quarter = DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5);
    let general = DQuat::from_xyzw(0.1, 0.7, -0.2, 0.3).normalize();
    for rotation in [DQuat::IDENTITY, quarter, general] {
        let pose = Pose::new(rotation, DVec3::ZERO).expect("a rotation");
        let ask = |direction: DVec3| {
            Cast::new(bar.at(pose), groove.at(pose), pose.transform_vector(direction))
                .expect("a direction")
                .clearance()
                .expect("an answer")
        };
        assert!(ask(DVec3::X).is_free(), "{rotation}");
        assert!(ask(DVec3::Z).is_free(), "{rotation}");
        let Clearance::Blocked { contact, .. } = ask(DVec3::Y) else { panic!("{rotation}") };
        assert!(contact.offset_distance.upper < 1e-11, "{contact:?}");
    }
}

#[test]
fn shells_that_are_inside_out_are_turned() {
    let inverted = slab(DVec3::ZERO, DVec3::ONE, [2; 3]).reversed();
    let body = solid(&inverted);
    assert_eq!(body.report().turned(), 1);
    assert!((body.volume() - 1.0).abs() < 1e-14);
    assert_eq!(solid(&washer([1.0, 2.0], [0.0, 1.0], 12)).report().holes_through(), 1);
    let nan = Solid::from_mesh(&[DVec3::NAN, DVec3::X, DVec3::Y], &[[0, 1, 2]]);
    assert!(matches!(nan, Err(SolidError::Coordinate { vertex: 0, .. })));
}

#[test]
fn answers_do_not_depend_on_order_subdivision_or_displacement() {
    let a = slab(DVec3::new(0.0, 0.0, 0.0), DVec3::new(2.0, 1.0, 1.0), [1; 3]).joined(&slab(
        DVec3::new(0.0, 0.0, 1.0),
        DVec3::new(1.0, 1.0, 2.0),
        [1; 3],
    ));
    let b = washer([1.0, 3.0], [4.0, 5.0], 8);
    let finer = slab(DVec3::new(0.0, 0.0, 0.0), DVec3::new(2.0, 1.0, 1.0), [8, 2, 4])
        .joined(&slab(DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 1.0, 2.0), [4, 4, 2]));
    let mut turned_round = finer.clone();
    turned_round.faces.reverse();
    let far = DVec3::new(1_048_576.0, -512.0, 0.5);
    let answer = |mesh: &Mesh, by: DVec3, direction: DVec3| {
        let (a, b) = (solid(mesh), solid(&b));
        let pose = Pose::from_translation(by).expect("in range");
        let cast = Cast::new(a.at(pose), b.at(pose), direction).expect("a direction");
        match cast.clearance().expect("an answer") {
            Clearance::Blocked { contact, .. } => Some(contact.translation.value),
            Clearance::Free(_) => None,
            Clearance::Overlapping(_) => panic!("apart"),
        }
    };
    for direction in [DVec3::Z, DVec3::new(1.0, 0.0, 2.0), DVec3::new(0.25, -0.5, 1.0)] {
        let first = answer(&a, DVec3::ZERO, direction);
        for mesh in [&a, &finer, &turned_round] {
            for by in [DVec3::ZERO, far] {
                let other = answer(mesh, by, direction);
                assert_eq!(first.is_some(), other.is_some());
                assert!((first.unwrap_or(0.0) - other.unwrap_or(0.0)).abs() < 1e-13);
            }
        }
    }
}

#[test]
fn a_negative_tolerance_is_refused() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    assert!(cast(&cube, &cube, DVec3::X).with_tolerance(-1.0).is_err());
}

#[test]
fn a_range_has_the_contacts_at_both_ends_and_the_work() {
    let (bolt, plate) = (bolt([1.0, 2.0], [-5.0, 8.0, 9.0], 12), washer([1.5, 4.0], [0.0, 1.0], 9));
    let (bolt, plate) = (solid(&bolt), solid(&plate));
    // In the hole: the shaft passes, and the head, from 8 to 9, meets the plate from both sides.
    let down = cast(&bolt, &plate, DVec3::NEG_Z);
    let ContactRange::Contact { first, last } = down.contact_range().expect("an answer") else {
        panic!("the head is over the plate")
    };
    for (end, right) in [(first.translation, 7.0), (last.exit(), 9.0)] {
        assert!(end.lower <= right && right <= end.upper && end.upper - end.lower < 1e-12);
    }
    assert!((first.normal - DVec3::NEG_Z).length() < 1e-15);
    assert!((last.normal - DVec3::Z).length() < 1e-15);
    assert_eq!(down.first_contact(), Ok(Outcome::Contact(first)));
    // The same behind, and the other way round.
    let range = down.reversed().contact_range().expect("an answer");
    assert_eq!(range, ContactRange::Contact { first: last, last: first });
    let far = Pose::from_translation(DVec3::X * 9.0).expect("in range");
    let beside = Cast::new(bolt.at(far), plate.at(Pose::IDENTITY), DVec3::Z).expect("a direction");
    let Ok(ContactRange::Separated(apart)) = beside.contact_range() else { panic!("beside") };
    assert!(beside.verify(&apart.separation.expect("a plane")).expect("a plane") > 2.9);
    let Ok(Clearance::Blocked { contact, .. }) = down.clearance() else { panic!("blocked") };
    let Ok(Clearance::Free(free)) = down.reversed().clearance() else { panic!("free") };
    for steps in [first.steps, last.steps, contact.steps, free.steps, apart.steps] {
        assert!(steps.nodes > 0 && steps.leaves <= steps.nodes, "{steps:?}");
    }
    assert!(contact.steps.leaves > 0);
}

#[test]
fn a_negative_end_of_the_query_is_an_error() {
    let (cube, below) = (cuboid([0.0; 3], [1.0; 3]), cuboid([0.0, 0.0, -3.0], [1.0, 1.0, -2.0]));
    let with_end = |end: f64| {
        let cast = cast(&cube, &below, DVec3::NEG_Z);
        cast.with_options(SolidOptions::default().with_before(end))
    };
    for end in [-1.0, f64::NEG_INFINITY, f64::NAN] {
        let refused = with_end(end).map(|_| ()).expect_err("an end that is never reached");
        assert!(matches!(refused, QueryError::Length { .. }), "{end}: {refused}");
    }
    for (end, is_free) in [(0.0, true), (1.0, true), (3.0, false), (f64::INFINITY, false)] {
        let answer = with_end(end).and_then(|cast| cast.clearance()).expect("an answer");
        assert_eq!(answer.is_free(), is_free, "{end}");
    }
}

#[test]
fn an_intersection_names_what_meets() {
    let (cube, other) = (cuboid([0.0; 3], [1.0; 3]), cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]));
    let touching = cast(&cube, &other, DVec3::X).intersects().expect("an answer");
    assert!(touching.meets && matches!(touching.evidence.place, Some(Overlap::Facets(..))));
    let inner = cuboid([0.25; 3], [0.75; 3]);
    let inside = cast(&inner, &cube, DVec3::X).intersects().expect("an answer");
    assert!(matches!(inside.evidence.place, Some(Overlap::MovingInside(_))));
    let apart = cast(&inner, &other, DVec3::X).intersects().expect("an answer");
    assert!(!apart.meets && apart.evidence.place.is_none() && apart.evidence.steps.nodes > 0);
}

/// As thick as the tolerance, or less, in the body's own frame; whatever its pose.
#[test]
fn a_tolerance_that_leaves_nothing_of_a_body_is_an_error() {
    let plate = cuboid([0.0; 3], [9.0, 9.0, 0.5]);
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let turned = Pose::new(DQuat::from_rotation_x(0.7), DVec3::Z * 20.0).expect("a pose");
    let down = |a: &Solid, b: &Solid, tolerance: f64| {
        let cast = Cast::new(a.at(turned), b.at(Pose::IDENTITY), DVec3::NEG_Z).expect("a query");
        cast.with_tolerance(tolerance)?.clearance()
    };
    assert!(down(&plate, &cube, 0.499).is_ok() && down(&cube, &plate, 0.499).is_ok());
    for tolerance in [0.5, 0.75, 1e6] {
        let nothing_left = |which| QueryError::NothingLeft { which, tolerance, extent: 0.5 };
        assert_eq!(down(&plate, &cube, tolerance), Err(nothing_left("moving")));
        if tolerance < 1.0 {
            assert_eq!(down(&cube, &plate, tolerance), Err(nothing_left("fixed")));
        }
    }
    // Sheets are not shrunk, so they stay.
    let sheet = Solid::from_open_mesh(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]);
    assert!(down(&sheet.expect("a sheet"), &cube, 0.75).is_ok());
    // The default tolerance of a turned pose, far away, is a tolerance too.
    let film = cuboid([0.0; 3], [1.0, 1.0, 1e-9]);
    let far = Pose::new(turned.rotation(), DVec3::Z * 1e9).expect("a pose");
    let cast = Cast::new(film.at(far), cube.at(Pose::IDENTITY), DVec3::NEG_Z).expect("a query");
    let refused = cast.clearance().map(|_| ()).expect_err("thinner than rounding");
    assert!(matches!(refused, QueryError::NothingLeft { which: "moving", .. }), "{refused}");
    assert_eq!(cast.certified_clearance().map(|_| ()), Err(refused));
}

/// A matrix that is off a rotation by less than `1e-6` places a body that is stretched by as much: what bounds its
/// facets along their own axes is stretched, too.
#[test]
fn a_pose_that_stretches_presses_blocks_into_each_other() {
    let turn = DQuat::from_xyzw(0.1, 0.7, -0.2, 0.3).normalize();
    let (top, bottom) = (1.125, 1.125 * (1.0 + 2e-7));
    let block = slab(DVec3::new(-1.0, -1.0, -1.0), DVec3::new(1.0, 1.0, top), [8, 8, 4]);
    let above = slab(DVec3::new(-0.5, -0.5, bottom), DVec3::new(0.5, 0.5, 2.0), [8, 8, 4]);
    // Upside down in its own frame: what the search for shells begins with is far from the block.
    let over = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    let (block, above) = (solid(&block.mapped(|v| turn * v)), solid(&above.mapped(|v| over * v)));
    let pose = |matrix| Pose::from_matrix(matrix, DVec3::ZERO).expect("nearly a rotation");
    let there = pose(DMat3::from_quat(turn) * over);
    for (stretch, pressed) in [(0.0, false), (4e-7, true)] {
        let here = pose(DMat3::IDENTITY * (1.0 + stretch));
        for direction in [turn * DVec3::Z, turn * DVec3::NEG_Z] {
            let cast = Cast::new(block.at(here), above.at(there), direction).expect("a direction");
            let cast = with_tolerance(cast, 0.0);
            assert_eq!(cast.overlaps(), pressed, "{stretch} {direction}");
            assert_eq!(cast.intersects().expect("an answer").meets, pressed);
            let apart = cast.certified_clearance().expect("an answer");
            assert_eq!(matches!(apart.0, Clearance::Overlapping(_)), pressed);
            assert!(cast.verify(&apart.1).is_ok());
        }
    }
}

#[test]
fn a_shell_inside_that_touches_from_within_is_told_with_any_tolerance() {
    // A roof stands on its ridge in a larger one, on that one's floor.
    let roof = |half: [f64; 2], top: f64, floor: f64| {
        let [x, y] = half;
        let ridge = [-x, x].map(|x| DVec3::new(x, 0.0, top));
        let eaves = [-x, x].map(|x| [-y, y].map(|y| DVec3::new(x, y, floor)));
        let points: Vec<DVec3> = ridge.into_iter().chain(eaves.into_iter().flatten()).collect();
        ConvexPolyhedron::from_points(&points).expect("a roof")
    };
    let (outer, inner) = (roof([3.0, 3.0], 2.0, 0.0), roof([1.0, 1.0], 0.0, 1.0));
    for tolerance in [0.0, 1e-15, 2.2e-12, 1e-9, 1e-6, 0.1] {
        for swapped in [false, true] {
            let (a, b) = if swapped { (&inner, &outer) } else { (&outer, &inner) };
            let cast = Cast::between(a.at(Pose::IDENTITY), b.at(Pose::IDENTITY), DVec3::Z);
            let cast = cast.and_then(|cast| cast.with_tolerance(tolerance)).expect("a cast");
            assert!(cast.overlaps(), "{tolerance} {swapped}");
        }
    }
}
