//! Ways out in several moves: closed forms, proofs that are checked and refused, counts of work.

use colltrans::free::FreeError;
use colltrans::glam::{DMat3, DVec3, EulerRot};
use colltrans::ways::{WayOptions, WayOut, WaysOut};
use colltrans::{ConvexPolyhedron, Pose, Solid};

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
        WaysOut::NotFound { .. } => None,
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
fn a_window_that_is_too_short_is_none() {
    let bodies = slot([14.0, 15.9]);
    let [a, b] = bodies.each_ref().map(|solid| solid.at(Pose::IDENTITY));
    let WaysOut::NotFound { searched } =
        WaysOut::of(&a, &b, &WayOptions::default().with_places(200)).unwrap()
    else {
        panic!("it is closed in")
    };
    assert!(searched.places > 0 && searched.directions == 6);
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
    refused(&|way| way.legs[0].travel = 14.0);
    refused(&|way| way.legs[0].bodies = vec![0, 1]);
    refused(&|way| way.legs[0].bodies = vec![0, 99]);
    refused(&|way| way.legs.clear());
}

#[test]
fn another_body_moves_aside_first() {
    // A cube in a box whose lid slides in grooves.
    let cube = solid(&[[[1.0, 1.0, 0.5], [2.0, 2.0, 1.5]]]);
    let lid = solid(&[[[0.1, -0.4, 2.2], [3.9, 3.4, 2.8]]]);
    let tray = solid(&[
        [[-1.0, -1.0, -1.0], [5.0, 4.0, 0.0]],
        [[-1.0, -1.0, 0.0], [0.0, 4.0, 3.5]],
        [[4.0, -1.0, 0.0], [5.0, 4.0, 2.0]],
        [[0.0, -1.0, 0.0], [4.0, 0.0, 2.0]],
        [[0.0, 3.0, 0.0], [4.0, 4.0, 2.0]],
        [[-1.0, -1.0, 2.0], [9.0, -0.5, 4.0]],
        [[-1.0, 3.5, 2.0], [9.0, 4.0, 4.0]],
        [[-1.0, -0.5, 3.0], [9.0, 0.0, 4.0]],
        [[-1.0, 3.0, 3.0], [9.0, 3.5, 4.0]],
        [[8.5, -1.0, 2.0], [9.0, 4.0, 4.0]],
    ]);
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
