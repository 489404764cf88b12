//! Paths of joints: closed forms, samples of the path, one joint against a rotation, solids, proofs and modified
//! proofs, counts of work.

use std::f64::consts::{FRAC_PI_2, PI};

use colltrans_convex::{ConvexPolyhedron, Pose};
use colltrans_motion::path::{
    CoverStep, Frame, Joint, JointPath, Mechanism, PathBody, PathCast, PathContact,
    PathContactProof, PathError, PathOutcome, PathPlace, PathProof, PathProofError,
    PathProvenContact,
};
use colltrans_motion::{Motion, MotionCast, MotionOutcome};
use colltrans_solid::Solid;
use colltrans_testkit::bodies::{at_xyz as at, block as cuboid};
use colltrans_testkit::oracle::path::Arm;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{block, random_hull};
use glam::{DQuat, DVec3};

/// Builds a planar arm: links of length 1 along x, joints about z.
fn planar_arm(links: usize) -> Mechanism {
    let frame = |k: usize| Frame {
        parent: k.checked_sub(1),
        origin: at(if k == 0 { 0.0 } else { 1.0 }, 0.0, 0.0),
        joint: Joint::Turning(DVec3::Z),
    };
    Mechanism::new((0..links).map(frame).collect()).expect("an arm")
}

fn expect_contact(outcome: PathOutcome) -> PathContact {
    match outcome {
        PathOutcome::Contact(contact) => contact,
        other => panic!("no contact: {other:?}"),
    }
}

#[test]
fn random_arms_of_convex_bodies_pass_samples() {
    let (mut contacts, mut free, mut others) = (0, 0, 0);
    for seed in 0..300 {
        let outcome = Arm::random(seed, false).judge(60);
        match outcome.unwrap_or_else(|wrong| panic!("{seed}: {}", wrong.0)) {
            PathOutcome::Contact(of) => {
                contacts += 1;
                let width = of.upper - of.lower;
                assert!(width < 1e-9, "{width:e} at {seed}");
            }
            PathOutcome::Free(_) => free += 1,
            _ => others += 1,
        }
    }
    assert!(contacts > 40 && free > 60, "{contacts} {free} {others}");
}

#[test]
fn random_arms_of_solids_pass_samples() {
    let (mut contacts, mut free) = (0, 0);
    for seed in 0..60 {
        let outcome = Arm::random(seed, true).judge(20);
        match outcome.unwrap_or_else(|wrong| panic!("{seed}: {}", wrong.0)) {
            PathOutcome::Contact(_) => contacts += 1,
            PathOutcome::Free(_) => free += 1,
            _ => {}
        }
    }
    assert!(contacts > 8 && free > 8, "{contacts} {free}");
}

#[test]
fn path_of_one_joint_matches_rotation() {
    let mut random = Random::new(3);
    let (mut contacts, mut free) = (0, 0);
    for _ in 0..200 {
        let [p, q] = [(); 2].map(|()| {
            let points = random_hull(12, &mut random).vertices;
            ConvexPolyhedron::from_points(&points).expect("a body")
        });
        let pose = Pose::new(random.rotation(), random.direction() * 3.0).expect("a pose");
        let (point, axis) = (random.vector() * 2.0, random.direction());
        let angle = random.range(-6.0, 6.0);
        let turn = Motion::rotation_about(pose, point, axis, angle).expect("a motion");
        // Near the path of the body.
        let by = turn.pose_at(random.unit()).expect("a pose").translation() + random.vector() * 2.0;
        let there = at(by.x, by.y, by.z);
        let cast = MotionCast::new(p.with_motion(&turn), q.at(there)).expect("a cast");
        let origin = Pose::from_translation(point).expect("a pose");
        let frame = Frame { parent: None, origin, joint: Joint::Turning(axis) };
        let mechanism = Mechanism::new(vec![frame]).expect("a joint");
        let path = JointPath::at_unit_times(vec![vec![0.0], vec![angle]]).expect("a path");
        let own = pose.translated_by(-point).expect("a pose");
        let bodies = vec![PathBody::carried_by(0, p.at(own)), PathBody::at_rest(q.at(there))];
        let query = PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast");
        let found = query.first_contact().expect("an answer");
        match (cast.first_contact().expect("an answer"), found) {
            (MotionOutcome::Contact(a), PathOutcome::Contact(b)) => {
                contacts += 1;
                assert!(a.lower <= b.upper && b.lower <= a.upper, "{a:?} {b:?}");
                assert!(b.upper - b.lower < 1e-9, "{:e}", b.upper - b.lower);
            }
            (MotionOutcome::Free(_), PathOutcome::Free(_)) => free += 1,
            (MotionOutcome::Overlapping(_), PathOutcome::Overlapping(_)) => {}
            (a, b) => panic!("{a:?}, but {b:?}"),
        }
    }
    assert!(contacts > 40 && free > 40, "{contacts} {free}");
}

#[test]
fn two_links_reach_wall_at_closed_form_time() {
    // Both joints rotate by a. The corner (1, 1/8) of the second link is at the height sin a + sin 2a + cos 2a / 8.
    let link = cuboid([0.2, -0.125, -0.1], [1.0, 0.125, 0.1]);
    let wall = cuboid([-9.0, 0.75, -9.0], [9.0, 0.76, 9.0]);
    let height = |a: f64| a.sin() + (2.0 * a).sin() + (2.0 * a).cos() / 8.0;
    let (mut low, mut high) = (0.0, 0.4);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if height(middle) < 0.75 { low = middle } else { high = middle }
    }
    let mechanism = planar_arm(2);
    let path = JointPath::new(vec![2.0, 4.0], vec![vec![0.0, 0.0], vec![1.0, 1.0]]);
    let path = path.expect("a path");
    let bodies = vec![
        PathBody::carried_by(0, link.at(Pose::IDENTITY)),
        PathBody::carried_by(1, link.at(Pose::IDENTITY)),
        PathBody::at_rest(wall.at(Pose::IDENTITY)),
    ];
    let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 2], [1, 2]]).expect("a cast");
    let found = expect_contact(cast.first_contact().expect("an answer"));
    let expected = 2.0 + 2.0 * low;
    assert!(found.lower <= expected + 1e-14 && expected <= found.upper + 1e-14, "{found:?}");
    assert!(found.upper - found.lower < 1e-12, "{:e}", found.upper - found.lower);
    assert_eq!(found.pair, [1, 2]);
    let points = found.points.expect("points");
    assert!((points[1].y - 0.75).abs() < 1e-9 && points[0].distance(points[1]) < 1e-9);
    assert!((found.normal.expect("a normal").y - 1.0).abs() < 1e-6);
}

#[test]
fn thin_wire_between_samples_is_found() {
    // A thin wire in the path of an arm that rotates by 90 degrees per row. With a hundred samples per row, the tip is
    // on both sides of the wire and never in it.
    let link = cuboid([0.0, -0.002, -0.002], [1.0, 0.002, 0.002]);
    let angle: f64 = 0.5 * FRAC_PI_2 + 0.5 * FRAC_PI_2 / 100.0;
    let tip = DVec3::new(angle.cos(), angle.sin(), 0.0) * 1.9;
    let wire = cuboid([-0.001, -0.001, -1.0], [0.001, 0.001, 1.0]);
    let arm = Arm {
        frames: planar_arm(2).frames().to_vec(),
        rows: vec![vec![0.0, 0.0], vec![FRAC_PI_2, 0.0]],
        bodies: vec![],
        pairs: vec![],
        min_gap: 0.0,
    };
    let with = Arm {
        bodies: vec![
            (Some(1), colltrans_testkit::oracle::path::Body::Convex(link), Pose::IDENTITY),
            (None, colltrans_testkit::oracle::path::Body::Convex(wire), at(tip.x, tip.y, 0.0)),
        ],
        pairs: vec![[0, 1]],
        ..arm
    };
    let seen = (0..=100).filter(|k| {
        let place = PathPlace { row: 0, share: f64::from(*k) / 100.0 };
        with.gap([0, 1], place).expect("a gap") <= 0.0
    });
    assert_eq!(seen.count(), 0, "sampling misses it");
    let found = expect_contact(with.judge(100).expect("an answer"));
    assert!(0.5 < found.lower && found.upper < 0.51, "{} {}", found.lower, found.upper);
}

#[test]
fn links_at_rest_relative_to_each_other_take_two_samples() {
    // Two links of an arm with a joint between them that rests do not move relative to each other.
    let cube = cuboid([-0.4; 3], [0.4; 3]);
    let mechanism = planar_arm(3);
    let rows = (0..1000).map(|k| vec![f64::from(k) * 0.1, 0.0, f64::from(k)]).collect();
    let path = JointPath::at_unit_times(rows).expect("a path");
    let bodies = vec![
        PathBody::carried_by(0, cube.at(Pose::IDENTITY)),
        PathBody::carried_by(1, cube.at(Pose::IDENTITY)),
    ];
    let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast");
    let outcome = cast.first_contact().expect("an answer");
    assert!(matches!(outcome, PathOutcome::Free(_)), "{outcome:?}");
    assert_eq!(outcome.steps().looks, 2);
    assert_eq!(cast.verify(outcome.proof()), Ok([999.0, f64::INFINITY]));
}

#[test]
fn distant_path_takes_few_samples() {
    // A moving hand at a distance of 3 from a wall, over 1,000 rows.
    let hand = cuboid([0.0, -0.1, -0.1], [1.0, 0.1, 0.1]);
    let wall = cuboid([5.0, -9.0, -9.0], [6.0, 9.0, 9.0]);
    let mechanism = planar_arm(2);
    let rows: Vec<Vec<f64>> =
        (0..1000).map(|k| vec![(f64::from(k) * 0.02).sin(), (f64::from(k) * 0.03).cos()]).collect();
    let bodies = || {
        vec![
            PathBody::carried_by(1, hand.at(Pose::IDENTITY)),
            PathBody::at_rest(wall.at(Pose::IDENTITY)),
        ]
    };
    let path = JointPath::at_unit_times(rows.clone()).expect("a path");
    let cast = PathCast::new(&mechanism, &path, bodies(), vec![[0, 1]]).expect("a cast");
    let outcome = cast.first_contact().expect("an answer");
    assert!(matches!(outcome, PathOutcome::Free(_)), "{outcome:?}");
    assert!(outcome.steps().looks < 60, "{} looks", outcome.steps().looks);
    // Near the gap all the time: about two samples per row.
    let near = PathCast::new(&mechanism, &path, bodies(), vec![[0, 1]]).expect("a cast");
    let near = near.with_min_gap(2.99).expect("a gap");
    let outcome = near.first_contact().expect("an answer");
    assert!(outcome.steps().looks < 2_500, "{} looks", outcome.steps().looks);
    near.verify(outcome.proof()).expect("a proof");
}

#[test]
fn hand_in_hollow_box_is_free_until_it_meets_side() {
    // A closed box with a cavity.
    let outer = block([-2.0; 3], [2.0; 3]);
    let inner = block([-1.5; 3], [1.5; 3]).reversed();
    let mesh = outer.joined(&inner).triangulated();
    let hollow = Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a solid");
    let hand = cuboid([0.5, -0.1, -0.1], [1.0, 0.1, 0.1]);
    let mechanism = Mechanism::new(vec![
        Frame { parent: None, origin: Pose::IDENTITY, joint: Joint::Turning(DVec3::Z) },
        Frame { parent: Some(0), origin: Pose::IDENTITY, joint: Joint::Sliding(DVec3::X) },
    ])
    .expect("an arm");
    let rows = vec![vec![0.0, 0.0], vec![20.0 * PI, 0.0], vec![20.0 * PI, 1.0]];
    let path = JointPath::at_unit_times(rows).expect("a path");
    let bodies = vec![
        PathBody::carried_by(1, hand.at(Pose::IDENTITY)),
        PathBody::at_rest(hollow.at(Pose::IDENTITY)),
    ];
    let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast");
    let found = expect_contact(cast.first_contact().expect("an answer"));
    assert!(found.lower <= 1.5 && 1.5 <= found.upper && found.upper - found.lower < 1e-11);
    assert_eq!(cast.verify(&found.proof), Ok([found.lower, found.upper]));
    // Inside the material no surface is near, but the bodies overlap.
    let thick = Solid::from_mesh(
        &block([-2.0; 3], [2.0; 3]).triangulated().vertices,
        &block([-2.0; 3], [2.0; 3]).triangulated().faces,
    );
    let thick = thick.expect("a solid");
    let bodies = vec![
        PathBody::carried_by(1, hand.at(Pose::IDENTITY)),
        PathBody::at_rest(thick.at(Pose::IDENTITY)),
    ];
    let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast");
    let outcome = cast.first_contact().expect("an answer");
    assert!(matches!(outcome, PathOutcome::Overlapping(_)), "{outcome:?}");
    assert_eq!(cast.verify(outcome.proof()), Ok([0.0, 0.0]));
}

#[test]
fn path_of_one_row_reports_overlap_or_free() {
    let cube = cuboid([-0.4; 3], [0.4; 3]);
    let mechanism = planar_arm(2);
    let query = |angle: f64| {
        let path = JointPath::at_unit_times(vec![vec![angle, 0.0]]).expect("a path");
        let bodies = vec![
            PathBody::carried_by(1, cube.at(Pose::IDENTITY)),
            PathBody::at_rest(cube.at(at(1.0, 0.0, 0.0))),
        ];
        let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast");
        cast.first_contact().expect("an answer")
    };
    assert!(matches!(query(0.5), PathOutcome::Overlapping(_)));
    assert!(matches!(query(FRAC_PI_2), PathOutcome::Free(_)));
}

/// Returns all planes of a proof.
fn planes_mut(proof: &mut PathProof) -> Vec<&mut colltrans_motion::TimedPlane> {
    let steps = proof.covers.iter_mut().flat_map(|cover| &mut cover.steps);
    let stretches = steps.flat_map(|step| match step {
        CoverStep::Planes(stretches) => stretches.iter_mut(),
        CoverStep::Parts { .. } => [].iter_mut(),
    });
    stretches.flat_map(|stretch| &mut stretch.planes).collect()
}

#[test]
fn modified_proof_is_rejected() {
    let link = cuboid([0.2, -0.125, -0.1], [1.0, 0.125, 0.1]);
    let wall = cuboid([-9.0, 0.75, -9.0], [9.0, 0.76, 9.0]);
    let mechanism = planar_arm(2);
    let rows = vec![vec![0.0, 0.0], vec![0.1, 0.05], vec![1.0, 1.0]];
    let path = JointPath::at_unit_times(rows).expect("a path");
    let bodies = vec![
        PathBody::carried_by(0, link.at(Pose::IDENTITY)),
        PathBody::carried_by(1, link.at(Pose::IDENTITY)),
        PathBody::at_rest(wall.at(Pose::IDENTITY)),
    ];
    let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 2], [1, 2]]).expect("a cast");
    let found = expect_contact(cast.first_contact().expect("an answer"));
    let proof = &found.proof;
    let count = proof.plane_count();
    assert!(count > 6, "{count}");
    for k in 0..count {
        let mut larger = proof.clone();
        planes_mut(&mut larger)[k].gap *= 1.5;
        assert!(matches!(cast.verify(&larger), Err(PathProofError::Gap { .. })), "{k}");
        let mut turned = proof.clone();
        let plane = &mut *planes_mut(&mut turned)[k];
        plane.normal = DQuat::from_rotation_z(1.0) * plane.normal;
        assert!(cast.verify(&turned).is_err(), "{k}");
        let mut later = proof.clone();
        planes_mut(&mut later)[k].time += 0.01;
        assert!(cast.verify(&later).is_err(), "{k}");
    }
    let mut sooner = proof.clone();
    sooner.meeting.as_mut().expect("a meeting").place.share = 0.05;
    assert!(cast.verify(&sooner).is_err());
    let mut less = proof.clone();
    less.covers.pop();
    assert!(matches!(cast.verify(&less), Err(PathProofError::Pairs { .. })));
    // Without its steps, a cover is valid but proves no time.
    let mut empty = proof.clone();
    empty.covers[0].steps.clear();
    assert_eq!(cast.verify(&empty).map(|bounds| bounds[0]), Ok(0.0));
}

#[test]
fn proof_with_removed_planes_is_rejected() {
    let link = cuboid([0.2, -0.125, -0.1], [1.0, 0.125, 0.1]);
    let wall = cuboid([-9.0, 0.75, -9.0], [9.0, 0.76, 9.0]);
    let mechanism = planar_arm(2);
    let path = JointPath::at_unit_times(vec![vec![0.0, 0.0], vec![-6.0, 6.0]]).expect("a path");
    let bodies = vec![
        PathBody::carried_by(1, link.at(Pose::IDENTITY)),
        PathBody::at_rest(wall.at(Pose::IDENTITY)),
    ];
    let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast");
    let found = expect_contact(cast.first_contact().expect("an answer"));
    let mut proof = found.proof;
    let CoverStep::Planes(stretches) = &mut proof.covers[0].steps[0] else { panic!("no planes") };
    let planes = &mut stretches[0].planes;
    assert!(planes.len() > 4, "{}", planes.len());
    planes.drain(1..planes.len() - 1);
    assert!(matches!(cast.verify(&proof), Err(PathProofError::Join { .. })), "{proof:?}");
}

#[test]
fn invalid_input_returns_typed_errors() {
    let z = Joint::Turning(DVec3::Z);
    let frame = |parent, joint| Frame { parent, origin: Pose::IDENTITY, joint };
    assert_eq!(Mechanism::new(vec![frame(Some(0), z)]), Err(PathError::Parent { frame: 0 }));
    let none = Joint::Sliding(DVec3::ZERO);
    assert!(matches!(Mechanism::new(vec![frame(None, none)]), Err(PathError::Axis { .. })));
    assert!(matches!(JointPath::at_unit_times(vec![]), Err(PathError::Rows { .. })));
    let twice = JointPath::new(vec![1.0, 1.0], vec![vec![0.0], vec![0.0]]);
    assert!(matches!(twice, Err(PathError::Time { row: 1, .. })));
    let uneven = JointPath::at_unit_times(vec![vec![0.0], vec![]]);
    assert!(matches!(uneven, Err(PathError::Row { row: 1, values: 0, joints: 1 })));
    let mechanism = planar_arm(2);
    let cube = cuboid([-0.4; 3], [0.4; 3]);
    let query = |rows: Vec<Vec<f64>>, frame: usize, pair: [usize; 2]| {
        let path = JointPath::at_unit_times(rows).expect("a path");
        let bodies = vec![
            PathBody::carried_by(frame, cube.at(Pose::IDENTITY)),
            PathBody::at_rest(cube.at(Pose::IDENTITY)),
        ];
        PathCast::new(&mechanism, &path, bodies, vec![pair]).map(drop)
    };
    let row = vec![vec![0.0, 0.0]];
    assert!(matches!(query(vec![vec![0.0]], 0, [0, 1]), Err(PathError::Row { joints: 2, .. })));
    assert!(matches!(query(vec![vec![0.0, f64::NAN]], 0, [0, 1]), Err(PathError::Value { .. })));
    assert!(matches!(query(vec![vec![0.0, 2e5]], 0, [0, 1]), Err(PathError::Value { .. })));
    assert!(matches!(query(row.clone(), 7, [0, 1]), Err(PathError::Frame { frame: 7, .. })));
    assert!(matches!(query(row.clone(), 0, [1, 1]), Err(PathError::Pair { .. })));
    assert_eq!(query(row, 0, [0, 1]), Ok(()));
}

/// Returns a lift that lowers a body by 8, its path, and the two cuboids of a step below.
fn lift_above_step() -> (Mechanism, JointPath, [ConvexPolyhedron; 2]) {
    let lift = Frame {
        parent: None,
        origin: at(1.0, 5.0, 0.0),
        joint: Joint::Sliding(DVec3::new(0.0, -1.0, 0.0)),
    };
    let mechanism = Mechanism::new(vec![lift]).expect("a lift");
    let path = JointPath::at_unit_times(vec![vec![0.0], vec![8.0]]).expect("a path");
    let step = [cuboid([0.0; 3], [3.0, 1.0, 1.0]), cuboid([0.0, 1.0, 0.0], [1.0, 3.0, 1.0])];
    (mechanism, path, step)
}

#[test]
fn cube_lowered_flush_onto_step_reports_contact() {
    let (mechanism, path, pieces) = lift_above_step();
    let step = Solid::from_pieces(&pieces.map(|piece| Solid::from_convex(&piece).unwrap()));
    let (step, cube) = (step.unwrap(), cuboid([-0.5; 3], [0.5; 3]));
    // Lowered onto each part of the step, with sides in one plane.
    for (x, meets) in [(0.5, 0.1875), (0.0, 0.1875), (1.5, 0.4375), (2.0, 0.4375), (2.25, 0.4375)] {
        let bodies = vec![
            PathBody { frame: Some(0), placed: cube.at(at(x - 1.0, 0.0, 0.5)).into() },
            PathBody { frame: None, placed: step.at(Pose::IDENTITY).into() },
        ];
        let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast");
        let found = expect_contact(cast.first_contact().expect("an answer"));
        assert_eq!(cast.verify(&found.proof), Ok([found.lower, found.upper]));
        assert!((found.upper - meets).abs() < 1e-9, "{x}: {} {}", found.lower, found.upper);
    }
}

/// A ball and a box are lowered onto a step, which may be rounded.
#[test]
fn rounded_bodies_meet_rounded_solids_at_closed_form_times() {
    let (mechanism, path, pieces) = lift_above_step();
    let step = Solid::from_pieces(&pieces).expect("a solid");
    let ball = ConvexPolyhedron::sphere(DVec3::ZERO, 0.5).expect("a ball");
    let cube = cuboid([-0.5; 3], [0.5; 3]);
    for (body, radius, x, meets) in [
        (&ball, 0.0, 0.5, 0.1875),
        (&ball, 0.0, 2.0, 0.4375),
        // Beside the edge by 0.3.
        (&ball, 0.0, 1.3, 0.2),
        (&ball, 0.25, 0.5, 0.15625),
        (&cube, 0.25, 2.25, 0.40625),
        (&cube, 0.25, 0.5, 0.15625),
    ] {
        let cast = |step| {
            let bodies = vec![
                PathBody { frame: Some(0), placed: body.at(at(x - 1.0, 0.0, 0.5)).into() },
                PathBody { frame: None, placed: Solid::at(step, Pose::IDENTITY).into() },
            ];
            PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast")
        };
        let rounded = step.clone().rounded(radius).expect("a solid");
        let found = expect_contact(cast(&rounded).first_contact().expect("an answer"));
        assert_eq!(cast(&rounded).verify(&found.proof), Ok([found.lower, found.upper]));
        let is_close = found.lower <= meets + 1e-12 && meets <= found.upper + 1e-12;
        assert!(is_close && found.upper - found.lower < 1e-9, "{x}: {found:?}");
        let larger = step.clone().rounded(radius + 1e-3).expect("a solid");
        assert!(cast(&larger).verify(&found.proof).is_err(), "{x}");
    }
    // The core of a ball inside a step overlaps at the start.
    let bodies = vec![
        PathBody { frame: None, placed: ball.at(at(0.5, 0.5, 0.5)).into() },
        PathBody { frame: Some(0), placed: step.at(at(-1.0, -5.0, 0.0)).into() },
    ];
    let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast");
    assert!(matches!(cast.first_contact(), Ok(PathOutcome::Overlapping(_))));
}

#[test]
fn prisms_with_equal_cross_sections_have_proven_contact() {
    let solid = |low: [f64; 3], high: [f64; 3]| {
        Solid::from_convex(&cuboid(low, high)).expect("a block is a solid")
    };
    let (plate, column) =
        (solid([0.0; 3], [1.0, 1.0, 0.25]), solid([0.0, 0.0, -3.0], [1.0, 1.0, 0.0]));
    let lift =
        Frame { parent: None, origin: at(0.0, 0.0, 1.0), joint: Joint::Sliding(DVec3::NEG_Z) };
    // Rotated, and with edges on diagonals of the face of the column.
    let post = solid([-0.25, -0.25, 0.0], [0.25, 0.25, 0.5]);
    let turned = |angle: f64, x: f64, y: f64| {
        Pose::new(DQuat::from_rotation_z(angle), DVec3::new(x, y, 0.0)).expect("a pose")
    };
    let meets = 0.25;
    for (body, pose) in [
        (&plate, Pose::IDENTITY),
        (&plate, turned(FRAC_PI_2, 1.0, 0.0)),
        (&post, turned(0.5 * FRAC_PI_2, 0.5, 0.5)),
    ] {
        let mechanism = Mechanism::new(vec![lift]).expect("a lift");
        let path = JointPath::at_unit_times(vec![vec![0.0], vec![4.0]]).expect("a path");
        let bodies = vec![
            PathBody::carried_by(0, body.at(pose)),
            PathBody::at_rest(column.at(Pose::IDENTITY)),
        ];
        let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast");
        let found = expect_contact(cast.first_contact().expect("an answer"));
        assert_eq!(cast.verify(&found.proof), Ok([found.lower, found.upper]));
        assert!(found.lower < meets + 1e-11 && found.upper > meets - 1e-15, "{found:?}");
        assert!(found.upper - found.lower < 1e-11, "{:e}", found.upper - found.lower);
        let meeting = found.proof.meeting.clone().expect("it is proven");
        let PathContactProof::Point { pieces, point } = meeting.how else { continue };
        // A point that is not inside both is not a proof, nor is one at another time.
        for (axis, far) in [(0, 2.0), (1, -2.0), (2, 1.0), (2, f64::NAN)] {
            let mut elsewhere = point;
            elsewhere[axis] += far;
            let how = PathContactProof::Point { pieces, point: elsewhere };
            let mut proof = found.proof.clone();
            proof.meeting = Some(PathProvenContact { how, ..meeting.clone() });
            assert!(cast.verify(&proof).is_err(), "{axis} {far}");
        }
        let mut proof = found.proof.clone();
        let place = PathPlace { share: found.lower, ..meeting.place };
        proof.meeting = Some(PathProvenContact { place, ..meeting });
        assert!(cast.verify(&proof).is_err(), "too early");
    }
}
