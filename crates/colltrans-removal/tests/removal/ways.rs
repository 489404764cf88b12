//! Removal paths: closed forms, checks of proofs and of modified proofs, limits of work.

use colltrans_convex::{Cast, ConvexPolyhedron, Placed, Pose};
use colltrans_removal::directions::FreeError;
use colltrans_removal::path::{NoRemovalPath, Order, RemovalOptions, RemovalPath, RemovalSearch};
use colltrans_solid::{Solid, SolidCast};
use colltrans_testkit::oracle::cubes::Cubes;
use colltrans_testkit::random::Random;
use colltrans_testkit::solids::TRAY_WITH_GROOVES;
use glam::{DMat3, DVec3, EulerRot};

fn union_of_blocks(blocks: &[[[f64; 3]; 2]]) -> Solid {
    let block = |[low, high]: &[[f64; 3]; 2]| {
        ConvexPolyhedron::cuboid(DVec3::from(*low), DVec3::from(*high)).unwrap()
    };
    Solid::from_pieces(&blocks.iter().map(block).collect::<Vec<_>>()).unwrap()
}

/// Returns a bar of length 2 with a stem, and a T-slot along x with closed ends. The lips of the slot are
/// open in `window`.
fn key_and_slot(window: [f64; 2]) -> [Solid; 2] {
    let [from, to] = window;
    let plate = union_of_blocks(&[
        [[-1.0, -3.0, -1.0], [21.0, 3.0, 0.0]],
        [[-1.0, -3.0, 0.0], [0.0, 3.0, 2.0]],
        [[20.0, -3.0, 0.0], [21.0, 3.0, 2.0]],
        [[0.0, -3.0, 0.0], [20.0, -2.0, 2.0]],
        [[0.0, 2.0, 0.0], [20.0, 3.0, 2.0]],
        [[0.0, -2.0, 1.0], [from, -1.0, 2.0]],
        [[0.0, 1.0, 1.0], [from, 2.0, 2.0]],
        [[to, -2.0, 1.0], [20.0, -1.0, 2.0]],
        [[to, 1.0, 1.0], [20.0, 2.0, 2.0]],
    ]);
    let key = union_of_blocks(&[
        [[0.5, -1.5, 0.2], [2.5, 1.5, 0.8]],
        [[0.5, -0.5, 0.5], [2.5, 0.5, 3.0]],
    ]);
    [key, plate]
}

fn find_path(bodies: &[Solid; 2], pose: Pose, options: &RemovalOptions) -> Option<RemovalPath> {
    let [a, b] = bodies.each_ref().map(|solid| solid.at(pose));
    match RemovalSearch::search(&a, &b, options).unwrap() {
        RemovalSearch::Found(way) => {
            way.verify(&[a, b]).unwrap();
            Some(way)
        }
        _ => None,
    }
}

#[test]
fn key_leaves_through_window_in_two_legs() {
    let bodies = key_and_slot([14.0, 17.0]);
    let way = find_path(&bodies, Pose::IDENTITY, &RemovalOptions::default()).unwrap();
    assert_eq!(way.legs.len(), 2);
    assert_eq!(way.legs[0].direction, DVec3::X);
    // The bar, which extends from 0.5 to 2.5, is below the window.
    assert!((13.5..=14.5).contains(&way.legs[0].travel), "{}", way.legs[0].travel);
    assert_eq!((way.legs[1].direction, way.legs[1].travel), (DVec3::Z, f64::INFINITY));
    let searched = way.searched;
    assert!(searched.places <= 8 && searched.looks <= 23_244, "{searched:?}");
}

#[test]
fn window_as_long_as_key_is_found_when_rotated() {
    let bodies = key_and_slot([14.0, 16.0]);
    let turn = DMat3::from_euler(EulerRot::XYZ, 0.3, 0.6, 0.9);
    for pose in [Pose::IDENTITY, Pose::from_matrix(turn, DVec3::ZERO).unwrap()] {
        let way =
            find_path(&bodies, pose, &RemovalOptions::default().with_tolerance(1e-5)).unwrap();
        assert_eq!(way.legs.len(), 2);
        assert!((way.legs[0].travel - 13.5).abs() <= 1e-5, "{}", way.legs[0].travel);
    }
}

#[test]
fn path_through_short_window_is_proven_impossible() {
    let bodies = key_and_slot([14.0, 15.9]);
    let [a, b] = bodies.each_ref().map(|solid| solid.at(Pose::IDENTITY));
    let proof = prove_no_path(&a, &b);
    assert!(proof.cell_count() < 4_000, "{}", proof.cell_count());
    // Without cells the answer only reports the amounts of work.
    let options = RemovalOptions::default().with_places(20).with_cells(0);
    let RemovalSearch::NotFound { searched } = RemovalSearch::search(&a, &b, &options).unwrap()
    else {
        panic!("no path exists")
    };
    assert!(searched.places > 0 && searched.directions == 6, "{searched:?}");
}

fn prove_no_path(a: &Placed<'_, Solid>, b: &Placed<'_, Solid>) -> NoRemovalPath {
    let RemovalSearch::Proven(proof) =
        RemovalSearch::search(a, b, &RemovalOptions::default()).unwrap()
    else {
        panic!("no path exists")
    };
    proof.verify(a, b).unwrap();
    proof
}

/// Checks that the bodies overlap in blocked cells: at the lowest corner of every second cell, and at a
/// random point of the others.
fn assert_overlap_in_blocked_cells(
    proof: &NoRemovalPath,
    a: &Placed<'_, Solid>,
    b: &Placed<'_, Solid>,
) {
    let mut random = Random::new(7);
    for (k, &(cell, _)) in proof.walls.iter().enumerate() {
        let [low, high] = proof.room.corners(cell);
        let share = DVec3::new(random.unit(), random.unit(), random.unit());
        let place = if k % 2 == 0 { low + share * (high - low) } else { low };
        let by = proof.room.axes * place;
        let moved = a.body.at(a.pose.translated_by(by).unwrap());
        let cast = Cast::new(moved, *b, DVec3::Z).unwrap();
        assert!(cast.with_tolerance(proof.tolerance).unwrap().overlaps(), "{cell:?} {by}");
    }
}

/// Builds a closed box around a room from 0 to 4. With `two`, a second room follows behind a wall at `x` from
/// 4 to 5. The square holes are centered in the first room's roof, the wall between the rooms, and the second
/// room's roof.
fn chambers(two: bool, holes: [f64; 3]) -> Solid {
    let far = if two { 9.0 } else { 4.0 };
    let mut blocks = vec![
        [[-1.0, -1.0, -1.0], [far + 1.0, 5.0, 0.0]],
        [[-1.0, -1.0, 0.0], [0.0, 5.0, 4.0]],
        [[far, -1.0, 0.0], [far + 1.0, 5.0, 4.0]],
        [[0.0, -1.0, 0.0], [far, 0.0, 4.0]],
        [[0.0, 4.0, 0.0], [far, 5.0, 4.0]],
    ];
    let mut roof = |from: f64, to: f64, hole: f64| {
        let (x, h) = (0.5 * (from + to), 0.5 * hole);
        blocks
            .extend([[[from, -1.0, 4.0], [x - h, 5.0, 5.0]], [[x + h, -1.0, 4.0], [to, 5.0, 5.0]]]);
        if hole > 0.0 {
            blocks.extend([
                [[x - h, -1.0, 4.0], [x + h, 2.0 - h, 5.0]],
                [[x - h, 2.0 + h, 4.0], [x + h, 5.0, 5.0]],
            ]);
        }
    };
    roof(-1.0, if two { 4.5 } else { 5.0 }, holes[0]);
    if two {
        roof(4.5, 10.0, holes[2]);
        let h = 0.5 * holes[1];
        blocks.extend([
            [[4.0, 0.0, 0.0], [5.0, 2.0 - h, 4.0]],
            [[4.0, 2.0 + h, 0.0], [5.0, 4.0, 4.0]],
        ]);
        if h > 0.0 {
            blocks.extend([
                [[4.0, 2.0 - h, 0.0], [5.0, 2.0 + h, 2.0 - h]],
                [[4.0, 2.0 - h, 2.0 + h], [5.0, 2.0 + h, 4.0]],
            ]);
        }
    }
    union_of_blocks(&blocks)
}

#[test]
fn cube_leaves_chambers_through_large_holes_and_small_ones_are_proven_closed() {
    let cube = union_of_blocks(&[[[0.5, 0.75, 0.5], [1.5, 1.75, 1.5]]]);
    let at = Pose::IDENTITY;
    for (two, holes) in [
        (false, [0.0, 0.0, 0.0]),
        (false, [0.9, 0.0, 0.0]),
        (true, [0.0, 1.1, 0.0]),
        (true, [0.0, 0.9, 1.5]),
    ] {
        let walls = chambers(two, holes);
        let proof = prove_no_path(&cube.at(at), &walls.at(at));
        assert!(proof.cell_count() < 4_000, "{holes:?}: {}", proof.cell_count());
        assert_overlap_in_blocked_cells(&proof, &cube.at(at), &walls.at(at));
    }
    // If two coordinates must be right at once, the path to the hole follows cells without contact.
    for (two, holes, legs) in [(false, [1.1, 0.0, 0.0], 3), (true, [0.0, 1.1, 1.5], 5)] {
        let found =
            find_path(&[cube.clone(), chambers(two, holes)], at, &RemovalOptions::default());
        let way = found.expect("a way");
        assert!((2..=legs).contains(&way.legs.len()), "{holes:?}: {:?}", way.legs.len());
    }
}

#[test]
#[ignore = "long: rooms in every rotation"]
fn rotated_bodies_in_closed_rooms_have_proof() {
    let cube = union_of_blocks(&[[[-0.5; 3], [0.5; 3]]]);
    let mut random = Random::new(11);
    for (two, holes) in [(false, [0.0; 3]), (false, [0.9, 0.0, 0.0]), (true, [0.0, 1.1, 0.0])] {
        let walls = chambers(two, holes);
        for round in 0..4 {
            // Even rounds rotate both bodies by a quarter turn, odd ones rotate the cube slightly.
            let quarter = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
            let little = DMat3::from_axis_angle(random.direction(), 0.1);
            let room = if round % 2 == 0 { quarter } else { DMat3::IDENTITY };
            let turns = [if round % 2 == 0 { quarter } else { little }, room];
            let middle = room * DVec3::splat(2.0);
            let [p, q] = [(turns[0], middle), (turns[1], DVec3::ZERO)]
                .map(|(turn, by)| Pose::from_matrix(turn, by).unwrap());
            let proof = prove_no_path(&cube.at(p), &walls.at(q));
            assert!(proof.cell_count() < 20_000, "{holes:?} {round}: {}", proof.cell_count());
            assert_overlap_in_blocked_cells(&proof, &cube.at(p), &walls.at(q));
            // The proof does not hold for a body in another place.
            let other = Pose::from_matrix(turns[0], middle + room * DVec3::X * 1.25).unwrap();
            let elsewhere = proof.verify(&cube.at(other), &walls.at(q));
            assert!(matches!(elsewhere, Err(FreeError::NotProven(_))), "{holes:?} {round}");
        }
    }
}

#[test]
#[ignore = "long: rooms in every rotation"]
fn randomly_rotated_rooms_are_proven_closed_or_left() {
    let cube = union_of_blocks(&[[[0.5, 0.75, 0.5], [1.5, 1.75, 1.5]]]);
    let mut random = Random::new(29);
    for (two, holes, closed) in [
        (false, [0.0; 3], true),
        (false, [0.9, 0.0, 0.0], true),
        (true, [0.0, 0.9, 1.5], true),
        (false, [1.1, 0.0, 0.0], false),
        (true, [0.0, 1.1, 1.5], false),
    ] {
        let walls = chambers(two, holes);
        for round in 0..4 {
            let pose = Pose::new(random.rotation(), 3.0 * random.direction()).unwrap();
            let (a, b) = (cube.at(pose), walls.at(pose));
            if !closed {
                let found =
                    find_path(&[cube.clone(), walls.clone()], pose, &RemovalOptions::default());
                assert!(found.is_some(), "{holes:?} {round}");
                continue;
            }
            let proof = prove_no_path(&a, &b);
            // About as many cells as for axis-aligned rooms.
            assert!(proof.cell_count() < 4_000, "{holes:?} {round}: {}", proof.cell_count());
            assert_overlap_in_blocked_cells(&proof, &a, &b);
            // The same cells along other axes, or along dependent ones, prove nothing.
            let [x, y, z] = [0, 1, 2].map(|k| proof.room.axes.col(k));
            for axes in [
                DMat3::IDENTITY,
                DMat3::from_cols(x, y, DVec3::ZERO - z),
                DMat3::from_cols(x, y, (x + y).normalize()),
                DMat3::from_cols(x, y, 2.0 * z),
                DMat3::from_cols(x, y, DVec3::NAN),
                DMat3::ZERO,
            ] {
                let mut changed = proof.clone();
                changed.room.axes = axes;
                let said = changed.verify(&a, &b);
                assert!(matches!(said, Err(FreeError::NotProven(_))), "{holes:?} {axes}");
            }
        }
    }
}

#[test]
#[ignore = "long: rooms in every rotation"]
fn sheared_room_is_proven_closed_or_left_through_hole() {
    // A room with sheared walls and a cube in it. The cube leaves through a hole in the roof of its own width.
    let sheared = |[low, high]: [[f64; 3]; 2]| {
        let corner = |k: usize| {
            [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { low[axis] } else { high[axis] })
        };
        let corners = (0..8).map(corner).map(|[x, y, z]| DVec3::new(x + 0.5 * y, y, z + 0.3 * y));
        ConvexPolyhedron::from_points(&corners.collect::<Vec<_>>()).unwrap()
    };
    let turn = DMat3::from_euler(EulerRot::XYZ, 0.4, 0.7, 0.2);
    let pose = Pose::from_matrix(turn, DVec3::ZERO).unwrap();
    let cube = union_of_blocks(&[[[1.5, 1.0, 1.5], [2.0, 1.5, 2.0]]]);
    for open in [false, true] {
        let mut blocks = vec![
            [[-1.0, -1.0, -1.0], [5.0, 5.0, 0.0]],
            [[-1.0, -1.0, 0.0], [0.0, 5.0, 4.0]],
            [[4.0, -1.0, 0.0], [5.0, 5.0, 4.0]],
            [[0.0, -1.0, 0.0], [4.0, 0.0, 4.0]],
            [[0.0, 4.0, 0.0], [4.0, 5.0, 4.0]],
        ];
        if open {
            blocks.push([[-1.0, -1.0, 4.0], [2.0, 5.0, 5.0]]);
        } else {
            blocks.push([[-1.0, -1.0, 4.0], [5.0, 5.0, 5.0]]);
        }
        let walls =
            Solid::from_pieces(&blocks.into_iter().map(sheared).collect::<Vec<_>>()).unwrap();
        let (a, b) = (cube.at(pose), walls.at(pose));
        if open {
            assert!(
                find_path(&[cube.clone(), walls.clone()], pose, &RemovalOptions::default())
                    .is_some()
            );
        } else {
            let proof = prove_no_path(&a, &b);
            assert!(proof.cell_count() < 4_000, "{}", proof.cell_count());
            assert_overlap_in_blocked_cells(&proof, &a, &b);
        }
    }
}

#[test]
fn modified_no_path_proof_is_rejected() {
    let cube = union_of_blocks(&[[[0.5, 0.75, 0.5], [1.5, 1.75, 1.5]]]);
    let (walls, at) = (chambers(false, [0.9, 0.0, 0.0]), Pose::IDENTITY);
    let (a, b) = (cube.at(at), walls.at(at));
    let proof = prove_no_path(&a, &b);
    let refused = |change: &dyn Fn(&mut NoRemovalPath)| {
        let mut changed = proof.clone();
        change(&mut changed);
        assert!(matches!(changed.verify(&a, &b), Err(FreeError::NotProven(_))));
    };
    for k in (0..proof.walls.len()).step_by(7) {
        refused(&|proof| {
            proof.walls.remove(k);
        });
        refused(&|proof| proof.walls[k].1.edge.1 = 3);
        refused(&|proof| proof.walls[k].1.edge.0 = u32::MAX);
        refused(&|proof| proof.walls[k].0 = proof.rooms[0]);
        refused(&|proof| proof.walls[k].1.facet = u32::MAX);
        refused(&|proof| proof.walls[k].0.depth = 99);
    }
    for k in 0..proof.rooms.len() {
        refused(&|proof| {
            proof.rooms.remove(k);
        });
    }
    refused(&|proof| proof.rooms.clear());
    refused(&|proof| proof.room.side *= 1.5);
    refused(&|proof| proof.room.side = f64::NAN);
    refused(&|proof| proof.room.low.x -= 3.0);
    refused(&|proof| proof.room.axes.x_axis = proof.room.axes.y_axis);
    // A room with a hole that lets the cube through is another body.
    let open = chambers(false, [1.1, 0.0, 0.0]);
    assert!(matches!(proof.verify(&a, &open.at(at)), Err(FreeError::NotProven(_))));
}

#[test]
fn modified_leg_is_rejected() {
    let bodies = key_and_slot([14.0, 17.0]);
    let way = find_path(&bodies, Pose::IDENTITY, &RemovalOptions::default()).unwrap();
    let placed = bodies.each_ref().map(|solid| solid.at(Pose::IDENTITY));
    let refused = |change: &dyn Fn(&mut RemovalPath)| {
        let mut changed = way.clone();
        change(&mut changed);
        assert!(matches!(changed.verify(&placed), Err(FreeError::NotProven(_))));
    };
    refused(&|way| way.legs[0].motion *= 0.5);
    refused(&|way| way.legs[0].motion *= 2.0);
    refused(&|way| drop(way.legs.remove(0)));
    refused(&|way| drop(way.legs.pop()));
    refused(&|way| way.legs[1].motion = -DVec3::Z);
    refused(&|way| way.legs[0].proofs.clear());
    refused(&|way| way.legs[0].travel += 0.25);
    refused(&|way| way.legs[0].bodies = vec![0, 1]);
    refused(&|way| way.legs[0].bodies = vec![0, 99]);
    refused(&|way| way.legs.clear());
}

#[test]
fn blocking_body_is_moved_first() {
    // A cube in a box with a lid that slides in grooves.
    let cube = union_of_blocks(&[[[1.0, 1.0, 0.5], [2.0, 2.0, 1.5]]]);
    let lid = union_of_blocks(&[[[0.1, -0.4, 2.2], [3.9, 3.4, 2.8]]]);
    let tray = union_of_blocks(&TRAY_WITH_GROOVES);
    let placed = [&cube, &lid, &tray].map(|solid| solid.at(Pose::IDENTITY));
    let RemovalSearch::Found(way) =
        RemovalSearch::search_among(&placed, &[2], &RemovalOptions::default(), None).unwrap()
    else {
        panic!("the lid moves sideways, then the cube moves up")
    };
    way.verify(&placed).unwrap();
    assert_eq!(way.legs[0].bodies, [1]);
    assert_eq!(way.legs.last().unwrap().bodies, [0]);
}

#[test]
fn cancelled_search_returns_error() {
    let bodies = key_and_slot([14.0, 17.0]);
    let placed = bodies.each_ref().map(|solid| solid.at(Pose::IDENTITY));
    let flag = std::sync::atomic::AtomicBool::new(true);
    let answer =
        RemovalSearch::search_among(&placed, &[1], &RemovalOptions::default(), Some(&flag));
    assert_eq!(answer, Err(FreeError::Cancelled));
}

/// Returns a block in a channel along x, and the channel. The only path out is a slanted shaft at its far
/// end.
fn skew_shaft() -> [Solid; 2] {
    // The walls of the shaft are sheared by (0.3, 0.2) per unit of z, in a roof of thickness 3.
    let at = |x: f64, y: f64, z: f64| DVec3::new(x + 0.3 * (z - 1.2), y + 0.2 * (z - 1.2), z);
    let sheared = |low: [f64; 2], high: [f64; 2]| {
        let corners = [1.2, 4.2].map(|z| {
            [[low[0], low[1]], [high[0], low[1]], [low[0], high[1]], [high[0], high[1]]]
                .map(|[x, y]| at(x, y, z))
        });
        ConvexPolyhedron::from_points(&corners.concat()).unwrap()
    };
    let block = |low: [f64; 3], high: [f64; 3]| {
        ConvexPolyhedron::cuboid(DVec3::from(low), DVec3::from(high)).unwrap()
    };
    let walls = [
        block([-1.0, -1.0, -1.0], [9.0, 2.2, 0.0]),
        block([-1.0, -1.0, 0.0], [0.0, 2.2, 1.2]),
        block([8.0, -1.0, 0.0], [9.0, 2.2, 1.2]),
        block([0.0, -1.0, 0.0], [8.0, 0.0, 1.2]),
        block([0.0, 1.2, 0.0], [8.0, 2.2, 1.2]),
        sheared([-1.0, -1.0], [6.0, 2.2]),
        sheared([7.2, -1.0], [9.0, 2.2]),
        sheared([6.0, -1.0], [7.2, 0.0]),
        sheared([6.0, 1.2], [7.2, 2.2]),
    ];
    [union_of_blocks(&[[[0.1, 0.1, 0.1], [0.7, 0.7, 1.1]]]), Solid::from_pieces(&walls).unwrap()]
}

#[test]
fn skew_last_leg_is_found_along_walls() {
    let [cube, channel] = skew_shaft();
    let at = Pose::IDENTITY;
    // With axes as the only candidates, the direction of the shaft comes from the walls that stop the cube.
    let axes = vec![DVec3::X, DVec3::Y, DVec3::Z];
    let options = RemovalOptions::default().with_directions(axes).with_legs(2);
    let way =
        find_path(&[cube, channel], at, &options).expect("along the channel, then up the shaft");
    assert_eq!(way.legs.len(), 2);
    let last = way.legs[1].direction;
    assert!(last.x > 0.2 && last.y > 0.1 && last.z > 0.8, "{last}");
    assert!(way.searched.directions > 6, "{:?}", way.searched);
}

#[test]
fn both_orders_find_two_leg_path() {
    for order in [Order::FewestLegs, Order::NewestFirst] {
        let options = RemovalOptions::default().with_order(order);
        let way = find_path(&key_and_slot([14.0, 17.0]), Pose::IDENTITY, &options).unwrap();
        assert_eq!(way.legs.len(), 2);
    }
}

#[test]
fn fewest_legs_order_prefers_shorter_path_to_path_through_cells() {
    // A proof is attempted while unexplored placements remain, and its cells lead outside in four legs.
    let cubes = Cubes::random(&mut Random::new(450_971_566_688));
    let [a, b] = &cubes.solids()[..] else { panic!("two bodies") };
    let options = RemovalOptions::default()
        .with_order(Order::FewestLegs)
        .with_tolerance(1e-5)
        .with_cells(2_000);
    let placed = [a.at(Pose::IDENTITY), b.at(Pose::IDENTITY)];
    let RemovalSearch::Found(way) =
        RemovalSearch::search_among(&placed, &[], &options, None).unwrap()
    else {
        panic!("a path exists")
    };
    assert_eq!(way.legs.len(), cubes.level().unwrap().moves);
    assert_eq!(way.legs.len(), 3);
}

#[test]
fn zero_direction_and_negative_tolerance_are_rejected_with_given_value() {
    let [key, plate] = key_and_slot([14.0, 17.0]);
    let placed = [key.at(Pose::IDENTITY), plate.at(Pose::IDENTITY)];
    let refused = |options: &RemovalOptions| {
        RemovalSearch::search_among(&placed, &[], options, None).expect_err("refused").to_string()
    };
    let none = RemovalOptions::default().with_directions(vec![DVec3::X, DVec3::ZERO]);
    assert!(refused(&none).contains("direction"), "{}", refused(&none));
    let negative = RemovalOptions::default().with_tolerance(-1.0);
    assert!(refused(&negative).contains("-1"), "{}", refused(&negative));
}

#[test]
fn overlapping_bodies_move_together_in_groups_of_three() {
    let [key, plate] = key_and_slot([14.0, 17.0]);
    // A knob that overlaps the key's stem.
    let knob = union_of_blocks(&[[[0.4, -0.6, 2.5], [2.6, 0.6, 3.5]]]);
    let placed = [&key, &knob, &plate].map(|solid| solid.at(Pose::IDENTITY));
    let RemovalSearch::Found(way) =
        RemovalSearch::search_among(&placed, &[], &RemovalOptions::default(), None).unwrap()
    else {
        panic!("the knob leaves together with the key")
    };
    way.verify(&placed).unwrap();
    assert!(way.legs.iter().all(|leg| leg.bodies == [0, 1]), "{:?}", way.legs);
    let two = RemovalSearch::search_among(&placed[..2], &[], &RemovalOptions::default(), None);
    assert!(matches!(two, Err(FreeError::Overlapping { .. })));
}
