//! Ways out in several moves: closed forms, proofs that are checked and refused, counts of work.

use colltrans_convex::{Cast, ConvexPolyhedron, Placed, Pose};
use colltrans_removal::free::FreeError;
use colltrans_removal::ways::{NoWay, Order, WayOptions, WayOut, WaysOut};
use colltrans_solid::{Solid, SolidCast};
use colltrans_testkit::oracle::cubes::Cubes;
use colltrans_testkit::random::Random;
use colltrans_testkit::solids::TRAY_WITH_GROOVES;
use glam::{DMat3, DVec3, EulerRot};

fn solid(blocks: &[[[f64; 3]; 2]]) -> Solid {
    let block = |[low, high]: &[[f64; 3]; 2]| {
        ConvexPolyhedron::cuboid(DVec3::from(*low), DVec3::from(*high)).unwrap()
    };
    Solid::from_pieces(&blocks.iter().map(block).collect::<Vec<_>>()).unwrap()
}

/// A T-slot along x, closed at both ends, whose lips are open for `window`; and a bar with a stem in it, 2 long.
fn slot(window: [f64; 2]) -> [Solid; 2] {
    let [from, to] = window;
    let plate = solid(&[
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
    let key = solid(&[[[0.5, -1.5, 0.2], [2.5, 1.5, 0.8]], [[0.5, -0.5, 0.5], [2.5, 0.5, 3.0]]]);
    [key, plate]
}

fn found(bodies: &[Solid; 2], pose: Pose, options: &WayOptions) -> Option<WayOut> {
    let [a, b] = bodies.each_ref().map(|solid| solid.at(pose));
    match WaysOut::of(&a, &b, options).unwrap() {
        WaysOut::Found(way) => {
            way.verify(&[a, b]).unwrap();
            Some(way)
        }
        _ => None,
    }
}

#[test]
fn a_key_leaves_where_its_slot_is_open() {
    let bodies = slot([14.0, 17.0]);
    let way = found(&bodies, Pose::IDENTITY, &WayOptions::default()).unwrap();
    assert_eq!(way.legs.len(), 2);
    assert_eq!(way.legs[0].direction, DVec3::X);
    // The bar from 0.5 to 2.5 is under the window.
    assert!((13.5..=14.5).contains(&way.legs[0].travel), "{}", way.legs[0].travel);
    assert_eq!((way.legs[1].direction, way.legs[1].travel), (DVec3::Z, f64::INFINITY));
    let searched = way.searched;
    assert!(searched.places <= 8 && searched.looks <= 23_244, "{searched:?}");
}

#[test]
fn a_window_as_long_as_the_key_is_found_in_any_rotation() {
    let bodies = slot([14.0, 16.0]);
    let turn = DMat3::from_euler(EulerRot::XYZ, 0.3, 0.6, 0.9);
    for pose in [Pose::IDENTITY, Pose::from_matrix(turn, DVec3::ZERO).unwrap()] {
        let way = found(&bodies, pose, &WayOptions::default().with_tolerance(1e-5)).unwrap();
        assert_eq!(way.legs.len(), 2);
        assert!((way.legs[0].travel - 13.5).abs() <= 1e-5, "{}", way.legs[0].travel);
    }
}

#[test]
fn a_window_that_is_too_short_is_no_way_which_is_proven() {
    let bodies = slot([14.0, 15.9]);
    let [a, b] = bodies.each_ref().map(|solid| solid.at(Pose::IDENTITY));
    let proof = no_way(&a, &b);
    assert!(proof.cells() < 4_000, "{}", proof.cells());
    // Without cells it is said what was searched, and nothing more.
    let options = WayOptions::default().with_places(20).with_cells(0);
    let WaysOut::NotFound { searched } = WaysOut::of(&a, &b, &options).unwrap() else {
        panic!("it is closed in")
    };
    assert!(searched.places > 0 && searched.directions == 6, "{searched:?}");
}

fn no_way(a: &Placed<'_, Solid>, b: &Placed<'_, Solid>) -> NoWay {
    let WaysOut::Proven(proof) = WaysOut::of(a, b, &WayOptions::default()).unwrap() else {
        panic!("it is closed in")
    };
    proof.verify(a, b).unwrap();
    proof
}

/// Within the walls of a proof two bodies overlap, wherever: at one corner of every other, and somewhere in the others.
fn overlap_in_walls(proof: &NoWay, a: &Placed<'_, Solid>, b: &Placed<'_, Solid>) {
    let mut random = Random::new(7);
    for (k, &(cell, _)) in proof.walls.iter().enumerate() {
        let [low, high] = proof.room.corners(cell);
        let share = DVec3::new(random.unit(), random.unit(), random.unit());
        let place = if k % 2 == 0 { low + share * (high - low) } else { low };
        let by = proof.room.axes * place;
        let moved = a.body.at(a.pose.translated(by).unwrap());
        let cast = Cast::new(moved, *b, DVec3::Z).unwrap();
        assert!(cast.with_tolerance(proof.tolerance).unwrap().overlaps(), "{cell:?} {by}");
    }
}

/// A closed box around a room from 0 to 4, with another one behind a wall at `x` from 4 to 5 if there are two; holes
/// are square, in the middle: of the first room's roof, of the wall between and of the second room's roof.
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
    solid(&blocks)
}

#[test]
fn a_cube_in_a_box_leaves_through_holes_that_are_large_enough_and_else_it_is_proven() {
    let cube = solid(&[[[0.5, 0.75, 0.5], [1.5, 1.75, 1.5]]]);
    let at = Pose::IDENTITY;
    for (two, holes) in [
        (false, [0.0, 0.0, 0.0]),
        (false, [0.9, 0.0, 0.0]),
        (true, [0.0, 1.1, 0.0]),
        (true, [0.0, 0.9, 1.5]),
    ] {
        let walls = chambers(two, holes);
        let proof = no_way(&cube.at(at), &walls.at(at));
        assert!(proof.cells() < 4_000, "{holes:?}: {}", proof.cells());
        overlap_in_walls(&proof, &cube.at(at), &walls.at(at));
    }
    // Where two coordinates have to be right at once, cells in which nothing meets lead there.
    for (two, holes, legs) in [(false, [1.1, 0.0, 0.0], 3), (true, [0.0, 1.1, 1.5], 5)] {
        let found = found(&[cube.clone(), chambers(two, holes)], at, &WayOptions::default());
        let way = found.expect("a way");
        assert!((2..=legs).contains(&way.legs.len()), "{holes:?}: {:?}", way.legs.len());
    }
}

#[test]
#[ignore = "long: rooms in every rotation"]
fn bodies_that_are_turned_are_proven_to_stay_as_well() {
    let cube = solid(&[[[-0.5; 3], [0.5; 3]]]);
    let mut random = Random::new(11);
    for (two, holes) in [(false, [0.0; 3]), (false, [0.9, 0.0, 0.0]), (true, [0.0, 1.1, 0.0])] {
        let walls = chambers(two, holes);
        for round in 0..4 {
            // Turned together by a quarter about the middle of the first room, and the cube alone by a little.
            let quarter = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
            let little = DMat3::from_axis_angle(random.direction(), 0.1);
            let room = if round % 2 == 0 { quarter } else { DMat3::IDENTITY };
            let turns = [if round % 2 == 0 { quarter } else { little }, room];
            let middle = room * DVec3::splat(2.0);
            let [p, q] = [(turns[0], middle), (turns[1], DVec3::ZERO)]
                .map(|(turn, by)| Pose::from_matrix(turn, by).unwrap());
            let proof = no_way(&cube.at(p), &walls.at(q));
            assert!(proof.cells() < 20_000, "{holes:?} {round}: {}", proof.cells());
            overlap_in_walls(&proof, &cube.at(p), &walls.at(q));
            // Of a body that stands elsewhere it is no proof.
            let other = Pose::from_matrix(turns[0], middle + room * DVec3::X * 1.25).unwrap();
            let elsewhere = proof.verify(&cube.at(other), &walls.at(q));
            assert!(matches!(elsewhere, Err(FreeError::NotProven(_))), "{holes:?} {round}");
        }
    }
}

#[test]
#[ignore = "long: rooms in every rotation"]
fn rooms_that_are_slanted_are_proven_closed_and_left_by_their_windows() {
    let cube = solid(&[[[0.5, 0.75, 0.5], [1.5, 1.75, 1.5]]]);
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
                let found = found(&[cube.clone(), walls.clone()], pose, &WayOptions::default());
                assert!(found.is_some(), "{holes:?} {round}");
                continue;
            }
            let proof = no_way(&a, &b);
            // As many as along the axes, or nearly.
            assert!(proof.cells() < 4_000, "{holes:?} {round}: {}", proof.cells());
            overlap_in_walls(&proof, &a, &b);
            // The same cells along other axes, or along such as lie in a plane, are no proof.
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
fn a_room_whose_walls_are_askew_to_each_other_is_proven_closed() {
    // A room whose walls are sheared, and a cube in it; with a hole in the roof that is as wide as the cube it leaves.
    let sheared = |[low, high]: [[f64; 3]; 2]| {
        let corner = |k: usize| {
            [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { low[axis] } else { high[axis] })
        };
        let corners = (0..8).map(corner).map(|[x, y, z]| DVec3::new(x + 0.5 * y, y, z + 0.3 * y));
        ConvexPolyhedron::from_points(&corners.collect::<Vec<_>>()).unwrap()
    };
    let turn = DMat3::from_euler(EulerRot::XYZ, 0.4, 0.7, 0.2);
    let pose = Pose::from_matrix(turn, DVec3::ZERO).unwrap();
    let cube = solid(&[[[1.5, 1.0, 1.5], [2.0, 1.5, 2.0]]]);
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
            assert!(found(&[cube.clone(), walls.clone()], pose, &WayOptions::default()).is_some());
        } else {
            let proof = no_way(&a, &b);
            assert!(proof.cells() < 4_000, "{}", proof.cells());
            overlap_in_walls(&proof, &a, &b);
        }
    }
}

#[test]
fn proofs_of_no_way_that_were_changed_are_refused() {
    let cube = solid(&[[[0.5, 0.75, 0.5], [1.5, 1.75, 1.5]]]);
    let (walls, at) = (chambers(false, [0.9, 0.0, 0.0]), Pose::IDENTITY);
    let (a, b) = (cube.at(at), walls.at(at));
    let proof = no_way(&a, &b);
    let refused = |change: &dyn Fn(&mut NoWay)| {
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
    // A hole that lets the cube through is another body.
    let open = chambers(false, [1.1, 0.0, 0.0]);
    assert!(matches!(proof.verify(&a, &open.at(at)), Err(FreeError::NotProven(_))));
}

#[test]
fn legs_that_were_changed_are_refused() {
    let bodies = slot([14.0, 17.0]);
    let way = found(&bodies, Pose::IDENTITY, &WayOptions::default()).unwrap();
    let placed = bodies.each_ref().map(|solid| solid.at(Pose::IDENTITY));
    let refused = |change: &dyn Fn(&mut WayOut)| {
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
fn another_body_moves_aside_first() {
    // A cube in a box whose lid slides in grooves.
    let cube = solid(&[[[1.0, 1.0, 0.5], [2.0, 2.0, 1.5]]]);
    let lid = solid(&[[[0.1, -0.4, 2.2], [3.9, 3.4, 2.8]]]);
    let tray = solid(&TRAY_WITH_GROOVES);
    let placed = [&cube, &lid, &tray].map(|solid| solid.at(Pose::IDENTITY));
    let WaysOut::Found(way) = WaysOut::among(&placed, &[2], &WayOptions::default(), None).unwrap()
    else {
        panic!("the lid goes aside, then the cube up")
    };
    way.verify(&placed).unwrap();
    assert_eq!(way.legs[0].bodies, [1]);
    assert_eq!(way.legs.last().unwrap().bodies, [0]);
}

#[test]
fn what_is_cancelled_says_so() {
    let bodies = slot([14.0, 17.0]);
    let placed = bodies.each_ref().map(|solid| solid.at(Pose::IDENTITY));
    let flag = std::sync::atomic::AtomicBool::new(true);
    let answer = WaysOut::among(&placed, &[1], &WayOptions::default(), Some(&flag));
    assert_eq!(answer, Err(FreeError::Cancelled));
}

/// A channel along x with a block in it, whose only way out is a shaft that leads up askew at its far end.
fn skew_shaft() -> [Solid; 2] {
    // The shaft's walls are sheared by (0.3, 0.2) for 1 of z, in a roof 3 thick.
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
    [solid(&[[[0.1, 0.1, 0.1], [0.7, 0.7, 1.1]]]), Solid::from_pieces(&walls).unwrap()]
}

#[test]
fn a_last_leg_that_no_candidate_has_is_found_among_free_directions() {
    let [cube, channel] = skew_shaft();
    let at = Pose::IDENTITY;
    // Candidates are the normals of walls; the shaft's direction is across two of them, unless only axes are given.
    let axes = vec![DVec3::X, DVec3::Y, DVec3::Z];
    let options = WayOptions::default().with_directions(axes).with_legs(2);
    let way = found(&[cube, channel], at, &options).expect("along the channel, then up askew");
    assert_eq!(way.legs.len(), 2);
    let last = way.legs[1].direction;
    assert!(last.x > 0.2 && last.y > 0.1 && last.z > 0.8, "{last}");
    assert!(way.searched.free_sets > 0);
}

#[test]
fn either_order_finds_ways() {
    for order in [Order::FewestLegs, Order::NewestFirst] {
        let options = WayOptions::default().with_order(order);
        let way = found(&slot([14.0, 17.0]), Pose::IDENTITY, &options).unwrap();
        assert_eq!(way.legs.len(), 2);
    }
}

#[test]
fn a_way_through_the_cells_of_a_proof_is_not_taken_where_one_of_fewer_legs_is_looked_for() {
    // A proof is tried while there are places left, and its cells lead out in four legs.
    let cubes = Cubes::random(&mut Random::new(450_971_566_688));
    let [a, b] = &cubes.solids()[..] else { panic!("two bodies") };
    let options =
        WayOptions::default().with_order(Order::FewestLegs).with_tolerance(1e-5).with_cells(2_000);
    let placed = [a.at(Pose::IDENTITY), b.at(Pose::IDENTITY)];
    let WaysOut::Found(way) = WaysOut::among(&placed, &[], &options, None).unwrap() else {
        panic!("there is one")
    };
    assert_eq!(way.legs.len(), cubes.level().unwrap().moves);
    assert_eq!(way.legs.len(), 3);
}

#[test]
fn what_is_asked_wrongly_is_refused_as_it_was_asked() {
    let [key, plate] = slot([14.0, 17.0]);
    let placed = [key.at(Pose::IDENTITY), plate.at(Pose::IDENTITY)];
    let refused = |options: &WayOptions| {
        WaysOut::among(&placed, &[], options, None).expect_err("refused").to_string()
    };
    let none = WayOptions::default().with_directions(vec![DVec3::X, DVec3::ZERO]);
    assert!(refused(&none).contains("direction"), "{}", refused(&none));
    let negative = WayOptions::default().with_tolerance(-1.0);
    assert!(refused(&negative).contains("-1"), "{}", refused(&negative));
}

#[test]
fn bodies_that_overlap_move_as_one_unless_there_are_two() {
    let [key, plate] = slot([14.0, 17.0]);
    // A knob that is pressed onto the key's stem.
    let knob = solid(&[[[0.4, -0.6, 2.5], [2.6, 0.6, 3.5]]]);
    let placed = [&key, &knob, &plate].map(|solid| solid.at(Pose::IDENTITY));
    let WaysOut::Found(way) = WaysOut::among(&placed, &[], &WayOptions::default(), None).unwrap()
    else {
        panic!("as the key alone")
    };
    way.verify(&placed).unwrap();
    assert!(way.legs.iter().all(|leg| leg.bodies == [0, 1]), "{:?}", way.legs);
    let two = WaysOut::among(&placed[..2], &[], &WayOptions::default(), None);
    assert!(matches!(two, Err(FreeError::Overlapping { .. })));
}
