//! Invariants of motions with rotation, and hard families: grazing tips, fast rotations, parallel faces.

use std::f64::consts::{FRAC_PI_2, TAU};

use colltrans_convex::{ConvexPolyhedron, Pose};
use colltrans_motion::{Motion, MotionCast, MotionContact, MotionOutcome};
use colltrans_testkit::bodies::{at_xyz as at, centered as cuboid, hull};
use colltrans_testkit::random::Random;
use glam::{DMat3, DQuat, DVec3};

/// Computes the first contact and verifies its proof.
fn verified_outcome([p, q]: [&ConvexPolyhedron; 2], [a, b]: [&Motion; 2]) -> MotionOutcome {
    let cast = MotionCast::new(p.with_motion(a), q.with_motion(b)).expect("a cast");
    let outcome = cast.first_contact().expect("an answer");
    cast.verify(outcome.proof()).unwrap_or_else(|error| panic!("{error}: {outcome:?}"));
    outcome
}

fn expect_contact(outcome: MotionOutcome) -> MotionContact {
    match outcome {
        MotionOutcome::Contact(contact) => contact,
        other => panic!("no contact: {other:?}"),
    }
}

/// Returns the bounds of the contact time. A free motion has a contact after its end.
fn bounds(outcome: &MotionOutcome) -> [f64; 2] {
    match outcome {
        MotionOutcome::Contact(contact) | MotionOutcome::Grazing(contact) => {
            [contact.lower, contact.upper]
        }
        MotionOutcome::Free(_) => [1.0, f64::INFINITY],
        _ => [0.0; 2],
    }
}

/// Asserts that the bounds of two outcomes overlap within a margin.
fn assert_consistent(a: &MotionOutcome, b: &MotionOutcome, off: f64) {
    let [x, y] = [a, b].map(bounds);
    assert!(x[0] <= y[1] + off && y[0] <= x[1] + off, "{a:?}, but {b:?}");
}

struct Setting {
    bodies: [ConvexPolyhedron; 2],
    start: Pose,
    other: Pose,
    point: DVec3,
    axis: DVec3,
    angle: f64,
    rise: f64,
}

impl Setting {
    fn new(random: &mut Random) -> Self {
        let n = random.pick(&[4, 8, 20]);
        let from = random.direction() * random.range(2.2, 4.0);
        Self {
            bodies: [hull(n, random), hull(n, random)],
            start: Pose::new(random.rotation(), from).expect("a pose"),
            other: Pose::new(random.rotation(), DVec3::ZERO).expect("a pose"),
            point: random.vector() * 2.0,
            axis: random.direction(),
            angle: random.range(-6.0, 6.0),
            rise: random.range(-2.0, 2.0),
        }
    }

    fn screw(&self, start: Pose) -> Motion {
        Motion::screw(start, self.point, self.axis, self.angle, self.rise).expect("a motion")
    }

    fn outcome(&self) -> MotionOutcome {
        let [p, q] = &self.bodies;
        verified_outcome([p, q], [&self.screw(self.start), &Motion::at_rest(self.other)])
    }
}

/// Returns random settings of a seed with their outcomes.
fn settings(seed: u64, count: usize) -> impl Iterator<Item = (Setting, MotionOutcome)> {
    let mut random = Random::new(seed);
    (0..count).map(move |_| {
        let setting = Setting::new(&mut random);
        let outcome = setting.outcome();
        (setting, outcome)
    })
}

#[test]
fn swapped_bodies_have_same_time() {
    let mut contacts = 0;
    for (setting, outcome) in settings(1, 300) {
        let [p, q] = &setting.bodies;
        let motions = [&Motion::at_rest(setting.other), &setting.screw(setting.start)];
        assert_consistent(&outcome, &verified_outcome([q, p], motions), 0.0);
        contacts += u32::from(matches!(outcome, MotionOutcome::Contact(_)));
    }
    assert!(contacts > 20, "{contacts}");
}

#[test]
fn motion_through_poses_has_same_contact_as_screw() {
    for (setting, outcome) in settings(2, 150) {
        let [p, q] = &setting.bodies;
        let screw = setting.screw(setting.start);
        // Each piece rotates by less than half a turn, so it is the shorter rotation.
        let poses: Vec<Pose> =
            (0..=4).map(|k| screw.pose_at(0.25 * f64::from(k)).expect("a pose")).collect();
        let pieces = Motion::through_poses(&poses).expect("a motion");
        let found = verified_outcome([p, q], [&pieces, &Motion::at_rest(setting.other)]);
        // Intermediate poses are rounded, so grazing bodies may or may not touch.
        let is_decided = |of: &MotionOutcome| !matches!(of, MotionOutcome::Grazing(_));
        let [x, y] = [&outcome, &found].map(bounds);
        let slow = x[1] - x[0] > 1e-11 || y[1] - y[0] > 1e-11;
        if is_decided(&outcome) && is_decided(&found) && !slow {
            assert_consistent(&outcome, &found, 1e-10);
        }
    }
}

/// One carried plane proves the motion, for any gap.
#[test]
fn cubes_with_common_motion_are_free_with_few_samples() {
    let cube = cuboid([0.5; 3]);
    for gap in [1e-3, 1e-6, 1e-8, 1e-10, 1e-12] {
        for turn in [0.0, 0.3] {
            let poses = [DVec3::ZERO, DVec3::X * (1.0 + gap)].map(|place| {
                let by = DQuat::from_rotation_y(turn);
                Pose::new(by, DVec3::new(2.0, 1.0, 0.0) + by * place).expect("a pose")
            });
            let screw = |pose: Pose| {
                let (point, axis) = (DVec3::new(0.5, 0.25, 0.0), DVec3::new(1.0, 2.0, 3.0));
                Motion::screw(pose, point, axis, 3.0, 2.0).expect("a motion")
            };
            let outcome = verified_outcome([&cube, &cube], [&screw(poses[0]), &screw(poses[1])]);
            let MotionOutcome::Free(free) = outcome else { panic!("{gap:e}: {outcome:?}") };
            assert!(free.steps.looks <= 4, "{} looks at {gap:e}", free.steps.looks);
            // The same motion through poses, which are rounded.
            let through = |pose: Pose| {
                let poses = [0.0, 0.5, 1.0].map(|time| screw(pose).pose_at(time).expect("a pose"));
                Motion::through_poses(&poses).expect("a motion")
            };
            if gap >= 1e-10 {
                let [a, b] = poses.map(through);
                let outcome = verified_outcome([&cube, &cube], [&a, &b]);
                let MotionOutcome::Free(free) = outcome else { panic!("{gap:e}: {outcome:?}") };
                assert!(free.steps.looks <= 8, "{} looks at {gap:e}", free.steps.looks);
            }
        }
    }
}

/// A face of an oblique cube meets an edge of another cube, which is slightly displaced.
#[test]
fn oblique_cube_face_meets_edge_with_narrow_bounds() {
    let cube = cuboid([0.5; 3]);
    for slant in [0.0, 0.3, 0.7, std::f64::consts::FRAC_PI_4] {
        for aside in [0.0, 0.05, 0.1, 0.3] {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE] {
                let by = DQuat::from_axis_angle(axis.normalize(), slant);
                let pose = Pose::new(by, DVec3::new(-3.0, aside, 0.0)).expect("a pose");
                let slide = Motion::translation(pose, DVec3::X * 4.0).expect("a motion");
                let there = Motion::at_rest(Pose::IDENTITY);
                let found = expect_contact(verified_outcome([&cube, &cube], [&slide, &there]));
                let width = found.upper - found.lower;
                assert!(width < 1e-12, "{slant} {aside} {axis}: {} {width:e}", found.lower);
            }
        }
    }
}

#[test]
fn common_rigid_transformation_preserves_time() {
    let mut random = Random::new(77);
    for (setting, outcome) in settings(3, 150) {
        let [p, q] = &setting.bodies;
        let turn = DMat3::from_quat(random.rotation());
        let carry = Pose::from_matrix(turn, random.vector() * 3.0).expect("a pose");
        let carried = |pose: &Pose| carry.compose(pose).expect("a pose");
        let (point, axis) = (carry.transform_point(setting.point), turn * setting.axis);
        let screw =
            Motion::screw(carried(&setting.start), point, axis, setting.angle, setting.rise);
        let still = Motion::at_rest(carried(&setting.other));
        let found = verified_outcome([p, q], [&screw.expect("a motion"), &still]);
        let [x, y] = [&outcome, &found].map(bounds);
        if x[1] - x[0] < 1e-11 && y[1] - y[0] < 1e-11 {
            assert_consistent(&outcome, &found, 1e-10);
        }
    }
}

#[test]
fn additional_full_rotations_preserve_first_contact() {
    let mut contacts = 0;
    for (setting, _) in settings(4, 300) {
        let [p, q] = &setting.bodies;
        let still = Motion::at_rest(setting.other);
        let turn = |angle: f64| {
            let turn = Motion::rotation_about(setting.start, setting.point, setting.axis, angle);
            verified_outcome([p, q], [&turn.expect("a motion"), &still])
        };
        let once = turn(TAU);
        for whole in [2.0, 5.0, 40.0] {
            let more = turn(whole * TAU);
            match (&once, &more) {
                (MotionOutcome::Free(_), found) => {
                    assert!(matches!(found, MotionOutcome::Free(_)), "{found:?}");
                }
                (MotionOutcome::Contact(first), MotionOutcome::Contact(found)) => {
                    contacts += 1;
                    let off = 1e-14;
                    assert!(whole * found.lower <= first.upper + off, "{first:?} {found:?}");
                    assert!(first.lower <= whole * found.upper + off, "{first:?} {found:?}");
                }
                (MotionOutcome::Overlapping(_), MotionOutcome::Overlapping(_))
                | (MotionOutcome::Grazing(_), _)
                | (_, MotionOutcome::Grazing(_)) => {}
                (one, other) => panic!("{one:?}, but {other:?}"),
            }
        }
    }
    assert!(contacts > 80, "{contacts}");
}

/// Builds a blade with its tip at distance 1 from the axis, and a wall that it penetrates by a depth.
fn tip_and_wall(depth: f64) -> [ConvexPolyhedron; 2] {
    let blade: Vec<DVec3> = [(0.0, -0.05), (0.0, 0.05), (1.0, 0.0)]
        .into_iter()
        .flat_map(|(x, y)| [DVec3::new(x, y, -0.1), DVec3::new(x, y, 0.1)])
        .collect();
    let wall =
        ConvexPolyhedron::cuboid(DVec3::new(1.0 - depth, -2.0, -2.0), DVec3::new(3.0, 2.0, 2.0));
    [ConvexPolyhedron::from_points(&blade).expect("a blade"), wall.expect("a wall")]
}

#[test]
fn grazing_tip_meets_wall_at_closed_form_time() {
    let start = Pose::new(DQuat::from_rotation_z(-1.0), DVec3::ZERO).expect("a pose");
    let swing = Motion::rotation_about(start, DVec3::ZERO, DVec3::Z, 2.0).expect("a motion");
    let still = Motion::at_rest(Pose::IDENTITY);
    for k in 3..=13 {
        let depth = 10.0_f64.powi(-k);
        let [blade, wall] = tip_and_wall(depth);
        // The depth of the rounded body.
        let depth = 1.0 - wall.vertices().iter().map(|v| v.x).fold(f64::INFINITY, f64::min);
        let found = expect_contact(verified_outcome([&blade, &wall], [&swing, &still]));
        // cos a = 1 - depth.
        let angle = 2.0 * (0.5 * depth).sqrt().asin();
        let expected = 0.5 * (1.0 - angle);
        let off = 1e-15 / angle.sin();
        assert!(found.lower <= expected + off, "1e-{k}: {expected} {found:?}");
        assert!(expected <= found.upper + off, "1e-{k}: {expected} {found:?}");
        let width = found.upper - found.lower;
        assert!(width < 1e-12 / angle.sin(), "1e-{k}: {width:e}");
        assert!(found.steps.looks <= 100, "1e-{k}: {} looks", found.steps.looks);

        let [blade, wall] = tip_and_wall(-depth);
        let outcome = verified_outcome([&blade, &wall], [&swing, &still]);
        let is_free = matches!(outcome, MotionOutcome::Free(_));
        let is_grazing = matches!(outcome, MotionOutcome::Grazing(_));
        assert!(is_free || (k >= 13 && is_grazing), "1e-{k}: {outcome:?}");
    }
}

#[test]
fn fast_rotation_meets_wall_in_first_turn() {
    let [blade, wall] = tip_and_wall(1e-3);
    let still =
        Motion::at_rest(Pose::new(DQuat::from_rotation_z(FRAC_PI_2), DVec3::ZERO).expect("a pose"));
    // The wall is rotated by a quarter turn. The tip reaches it where the sine is 1 - depth.
    let depth = 1.0 - wall.vertices().iter().map(|v| v.x).fold(f64::INFINITY, f64::min);
    let reached = FRAC_PI_2 - 2.0 * (0.5 * depth).sqrt().asin();
    for angle in [2.0, 100.0, 1e4, 1e5] {
        let spin =
            Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, angle).expect("a motion");
        let found = expect_contact(verified_outcome([&blade, &wall], [&spin, &still]));
        let expected = reached / angle;
        let off = 1e-13 * expected;
        assert!(found.lower <= expected + off && expected <= found.upper + off, "{found:?}");
        assert!(found.upper - found.lower < 1e-11, "{found:?}");
    }
    // A thousand turns past the wall, each equally near.
    let [blade, wall] = tip_and_wall(-1e-3);
    let spin =
        Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 1e3 * TAU).expect("a motion");
    let outcome = verified_outcome([&blade, &wall], [&spin, &still]);
    let MotionOutcome::Free(free) = &outcome else { panic!("{outcome:?}") };
    assert!(free.steps.looks <= 40_000, "{} looks", free.steps.looks);
}

#[test]
fn parallel_faces_meet_when_gap_closes() {
    let [part, plate] = [cuboid([0.5, 0.5, 0.25]), cuboid([4.0, 4.0, 0.25])];
    for k in 2..=11 {
        let gap = 10.0_f64.powi(-k);
        let start = at(0.25, 0.5, 0.5 + gap);
        // Rotation and translation in the plane keep the gap.
        for way in [DVec3::ZERO, DVec3::new(0.5, -0.25, 0.0)] {
            let turn = Motion::free_flight(start, start.translation(), way, DVec3::Z * 5.0);
            let still = Motion::at_rest(Pose::IDENTITY);
            let outcome = verified_outcome([&part, &plate], [&turn.expect("a motion"), &still]);
            let MotionOutcome::Free(free) = &outcome else { panic!("{gap}: {outcome:?}") };
            assert!(free.steps.looks <= 10, "{} looks at {gap}", free.steps.looks);
        }
        // A screw towards the plate meets it face to face when the gap is closed.
        let down = Motion::screw(start, DVec3::ZERO, DVec3::Z, 4.0, -4.0 * gap).expect("a motion");
        let still = Motion::at_rest(Pose::IDENTITY);
        let found = expect_contact(verified_outcome([&part, &plate], [&down, &still]));
        let off = 1e-15 / gap;
        assert!(found.lower <= 0.25 + off && 0.25 <= found.upper + off, "{gap}: {found:?}");
        assert!(found.upper - found.lower < 1e-13 / gap, "{gap}: {found:?}");
        // A tilt meets the plate with an edge.
        let tilt =
            Motion::rotation_about(start, start.translation(), DVec3::Y, 0.5).expect("a motion");
        let found = expect_contact(verified_outcome([&part, &plate], [&tilt, &still]));
        // 0.5 sin a + 0.25 cos a = 0.25 + gap.
        let (r, phase) = ((0.25_f64 + 0.0625).sqrt(), 0.5_f64.atan());
        let angle = ((0.25 + gap) / r).asin() - phase;
        let expected = angle / 0.5;
        assert!((found.lower - expected).abs() < 1e-12, "{gap}: {expected} {found:?}");
    }
}
