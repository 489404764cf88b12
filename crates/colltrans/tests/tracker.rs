//! Trackers give the answers of one-off queries, whatever they have been asked before.

use colltrans::glam::{DQuat, DVec3};
use colltrans::{
    Clearance, ContactRange, ConvexPolyhedron, Focus, Options, Outcome, Pose, QueryError, Region,
    Solver, StartedFrom, Steps, Tracker,
};
use colltrans_oracle::check::same;
use colltrans_oracle::sequences::Walk;
use colltrans_oracle::settings::{Bodies, FAMILIES, Rng, Setting, cuboid};
use colltrans_oracle::shadow::sideways_overlap;
use colltrans_oracle::tracked::{Lanes, track, without_steps};
use proptest::prelude::*;

/// Walks of every family, each asked of every lane; one step in so many is solved by the oracle.
const WALKS: u64 = 6;
const STEPS: u32 = 50;
const ORACLE_EVERY: u32 = 25;

#[test]
fn every_family_against_one_off_queries() {
    let mut wrong = Vec::new();
    let (mut features, mut queries) = (0, 0);
    for (family, ..) in FAMILIES {
        for seed in 0..WALKS {
            let mut walk = Walk::new(family, seed);
            let bodies = walk.setting.bodies().expect("a body");
            let mut lanes = Lanes::new(&bodies);
            while walk.step < STEPS {
                for finding in lanes.ask(&walk.setting, walk.step.is_multiple_of(ORACLE_EVERY)) {
                    queries += 1;
                    match finding.verdict {
                        Ok(agreement) => {
                            features += u32::from(agreement.path == StartedFrom::Features);
                        }
                        Err(e) => wrong.push(format!("{walk} {}: {e}", finding.lane)),
                    }
                }
                walk.advance();
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong answers, among them\n{}", wrong.len(), wrong[0]);
    // All this would say little if trackers always began from scratch.
    assert!(features > queries / 2, "{features} of {queries}");
}

/// What a query with two casts found, as outcomes along the direction and against it.
fn range_ends(range: &ContactRange) -> Vec<Outcome> {
    match *range {
        ContactRange::Contact { first, last } => [first, last].map(Outcome::Contact).to_vec(),
        ContactRange::Grazing { first, last } => [first, last].map(Outcome::Grazing).to_vec(),
        ContactRange::Separated(separated) => vec![Outcome::Separated(separated)],
    }
}

/// Ranges of one kind with ends that agree, or such that the oracle approves of both: rounding
/// decides at the rim.
fn ranges_agree(setting: &Setting, bodies: &Bodies, a: &ContactRange, b: &ContactRange) -> bool {
    let back = Setting { direction: -setting.direction, ..setting.clone() };
    let judges = [setting.judge(bodies), back.judge(bodies)];
    let ends = [range_ends(a), range_ends(b)];
    let admissible = |ends: &[Outcome]| {
        ends.iter().zip(&judges).all(|(end, judge)| judge.compare_with_oracle(end).is_ok())
    };
    let alike = ends[0].len() == ends[1].len()
        && ends[0].iter().zip(&ends[1]).all(|(a, b)| same(a, b).is_ok());
    alike || ends.iter().all(|ends| admissible(ends))
}

/// Clearances that agree within both casts' tolerances, or differ where rounding decides: at a
/// distance of 0, and where the shadows overlap by no more than what grazes.
fn clearances_agree(setting: &Setting, bodies: &Bodies, a: &Clearance, b: &Clearance) -> bool {
    let scene = setting.judge(bodies).scene;
    let tolerance = 2.0
        * (tolerance_of(setting, 1.0, bodies) + tolerance_of(setting, -1.0, bodies))
        + scene.noise / setting.direction.length();
    let close = |s: f64, t: f64| (s - t).abs() <= tolerance;
    let range = |c: &Clearance| match c {
        Clearance::Free => None,
        Clearance::Blocked { distance, .. } => Some([*distance; 2]),
        Clearance::Overlapping { range } => Some(*range),
    };
    match (range(a), range(b)) {
        (None, None) => true,
        (Some([enter, exit]), Some([other, end])) => {
            close(enter, other) && (close(exit, end) || close(enter, 0.0))
        }
        (Some([enter, exit]), None) | (None, Some([enter, exit])) => {
            let border = setting.graze_tolerance.max(scene.touching) + 2.0 * scene.noise;
            close(enter, 0.0) || close(exit, 0.0) || !sideways_overlap(&scene).exceeds(border)
        }
    }
}

/// The tolerance of the contact along the direction or against it, if there is one.
fn tolerance_of(setting: &Setting, sign: f64, bodies: &Bodies) -> f64 {
    let aimed = Setting { direction: setting.direction * sign, ..setting.clone() };
    match aimed.cast(bodies, Solver::Auto) {
        Ok(Outcome::Contact(contact)) => contact.certificate.tolerance,
        _ => 0.0,
    }
}

#[test]
fn ranges_and_clearances_are_those_of_one_off_queries() {
    for (family, ..) in FAMILIES {
        for seed in 100..104 {
            let mut walk = Walk::new(family, seed);
            let bodies = walk.setting.bodies().expect("a body");
            let Bodies { moving, fixed } = &bodies;
            let mut tracker = Tracker::new(moving, fixed);
            while walk.step < 60 {
                let s = &walk.setting;
                let (m, f, d) = (&s.moving_pose, &s.fixed_pose, s.direction);
                let solver = if seed % 2 == 0 { Solver::Auto } else { Solver::Cta };
                let options =
                    Options { solver, graze_tolerance: s.graze_tolerance, ..Options::default() };
                let d = if walk.step.is_multiple_of(3) { -d } else { d };
                let aimed = Setting { direction: d, ..s.clone() };
                if walk.step.is_multiple_of(2) {
                    let found = tracker.contact_range(m, f, d, &options).expect("a range");
                    let one_off = colltrans::contact_range(moving, m, fixed, f, d, &options);
                    let one_off = one_off.expect("a range");
                    assert!(
                        ranges_agree(&aimed, &bodies, &found, &one_off),
                        "{walk}: {found:?} {one_off:?}"
                    );
                } else {
                    let found = tracker.clearance(m, f, d, &options).expect("a clearance");
                    let one_off = colltrans::clearance(moving, m, fixed, f, d, &options);
                    let one_off = one_off.expect("a clearance");
                    assert!(
                        clearances_agree(&aimed, &bodies, &found, &one_off),
                        "{walk}: {found:?} {one_off:?}"
                    );
                }
                walk.advance();
            }
        }
    }
}

/// A ball of points, a flat polygon, a segment, a point, a box, or a cone.
fn any_body() -> impl Strategy<Value = Vec<DVec3>> {
    let coordinate = -1.0..1.0_f64;
    let vector = (coordinate.clone(), coordinate.clone(), coordinate)
        .prop_map(|(x, y, z)| DVec3::new(x, y, z));
    prop_oneof![
        4 => prop::collection::vec(vector.clone(), 4..14),
        1 => prop::collection::vec(vector.clone().prop_map(|v| v.with_z(0.0)), 3..8),
        1 => prop::collection::vec(vector.clone(), 1..3),
        2 => vector.prop_map(|v| cuboid(v.abs() + 0.1)),
        1 => (3..40_u32).prop_map(cone),
    ]
}

/// A cone over a regular polygon: its apex has as many neighbours.
fn cone(sides: u32) -> Vec<DVec3> {
    let corner = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(sides)).sin_cos();
        DVec3::new(cos, sin, 0.0)
    };
    (0..sides).map(corner).chain([DVec3::Z]).collect()
}

/// A setting with these bodies, one above the other.
fn above(moving: Vec<DVec3>, fixed: Vec<DVec3>) -> Setting {
    Setting {
        family: "above",
        seed: 0,
        moving,
        fixed,
        moving_pose: Pose::from_translation(DVec3::new(0.1, 0.2, 4.0)).expect("a pose"),
        fixed_pose: Pose::IDENTITY,
        direction: DVec3::NEG_Z,
        graze_tolerance: 0.0,
    }
}

/// A step of the moving body: `10^-exponent` of its size.
fn step(setting: &mut Setting, rng: &mut Rng, exponent: f64) {
    let size = 10.0_f64.powf(-exponent);
    let turn = DQuat::from_axis_angle(rng.direction(), size);
    let pose = &setting.moving_pose;
    let rotation = (turn * pose.rotation()).normalize();
    // Back towards the middle: the shadows meet about half of the time.
    let pull = pose.translation() * DVec3::new(-0.1, -0.1, 0.0) * size;
    let at = pose.translation() + rng.vector() * size + pull;
    setting.moving_pose = Pose::new(rotation, at).expect("in range");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn walks_of_any_bodies(
        moving in any_body(),
        fixed in any_body(),
        seed in any::<u64>(),
        exponents in prop::collection::vec(-0.5..14.0_f64, 1..40),
    ) {
        let mut setting = above(moving, fixed);
        let Ok(bodies) = setting.bodies() else { return Ok(()) };
        let mut rng = Rng::new(seed);
        let mut lanes = Lanes::new(&bodies);
        for (index, exponent) in exponents.into_iter().enumerate() {
            for finding in lanes.ask(&setting, index % 16 == 0) {
                prop_assert!(finding.verdict.is_ok(), "{finding:?}\n{}", setting.dump());
            }
            step(&mut setting, &mut rng, exponent);
            if rng.one_in(8) {
                setting.direction = -setting.direction;
            }
        }
    }
}

#[test]
fn cone_apex_with_many_neighbours() {
    for sides in [31, 32, 33, 64, 200] {
        let mut setting = above(cone(sides), cone(sides));
        let down = DQuat::from_rotation_x(std::f64::consts::PI);
        let bodies = setting.bodies().expect("bodies");
        let mut tracker = Tracker::new(&bodies.moving, &bodies.fixed);
        let mut rng = Rng::new(sides.into());
        for apex in [0, 1].repeat(60) {
            // The apex leads, or the base.
            let rotation = if apex == 1 { down } else { DQuat::IDENTITY };
            let at = rng.vector() * DVec3::new(1.5, 1.5, 0.0) + DVec3::Z * 4.0;
            setting.moving_pose = Pose::new(rotation, at).expect("a pose");
            for _ in 0..4 {
                check(&mut tracker, &setting, &bodies);
                step(&mut setting, &mut rng, 2.0);
            }
        }
    }
}

/// The tracked answer, checked exactly and against the one-off answer.
fn check(tracker: &mut Tracker, setting: &Setting, bodies: &Bodies) -> Outcome {
    let found = track(tracker, setting, Solver::Auto).expect("an answer");
    let one_off = setting.cast(bodies, Solver::Auto).expect("an answer");
    let judge = setting.judge(bodies);
    judge.check(&found).unwrap_or_else(|e| panic!("{e}\n{}", setting.dump()));
    same(&found, &one_off).unwrap_or_else(|e| panic!("{e}\n{}", setting.dump()));
    found
}

#[test]
fn a_clone_follows_another_future() {
    let mut setting = above(cone(12), cuboid(DVec3::ONE));
    let bodies = setting.bodies().expect("bodies");
    let mut here = Tracker::new(&bodies.moving, &bodies.fixed);
    check(&mut here, &setting, &bodies);
    let mut there = here.clone();
    let mut other = setting.clone();
    let (mut first, mut second) = (Rng::new(1), Rng::new(2));
    for _ in 0..100 {
        step(&mut setting, &mut first, 1.5);
        step(&mut other, &mut second, 1.5);
        check(&mut here, &setting, &bodies);
        check(&mut there, &other, &bodies);
    }
    // And neither has touched the other: the first alone has the same bits.
    let mut setting = above(cone(12), cuboid(DVec3::ONE));
    let mut alone = Tracker::new(&bodies.moving, &bodies.fixed);
    let mut rng = Rng::new(1);
    check(&mut alone, &setting, &bodies);
    for _ in 0..100 {
        step(&mut setting, &mut rng, 1.5);
        check(&mut alone, &setting, &bodies);
    }
    assert_eq!(format!("{here:?}"), format!("{alone:?}"));
}

#[test]
fn reset_forgets() {
    let setting = above(cone(12), cuboid(DVec3::ONE));
    let bodies = setting.bodies().expect("bodies");
    let mut tracker = Tracker::new(&bodies.moving, &bodies.fixed);
    let first = check(&mut tracker, &setting, &bodies);
    assert_eq!(first.steps().started_from, StartedFrom::Scratch);
    assert_eq!(check(&mut tracker, &setting, &bodies).steps().started_from, StartedFrom::Features);
    tracker.reset();
    assert_eq!(check(&mut tracker, &setting, &bodies), first);
}

#[test]
fn a_refused_query_changes_no_answer() {
    let setting = above(cone(12), cuboid(DVec3::ONE));
    let bodies = setting.bodies().expect("bodies");
    let mut tracker = Tracker::new(&bodies.moving, &bodies.fixed);
    check(&mut tracker, &setting, &bodies);
    let (m, f) = (&setting.moving_pose, &setting.fixed_pose);
    for direction in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::X * 1e-100] {
        let refused = tracker.cast(m, f, direction);
        assert!(matches!(refused, Err(QueryError::Direction { .. })), "{refused:?}");
        let options = Options::default();
        assert!(tracker.contact_range(m, f, direction, &options).is_err());
        assert!(tracker.clearance(m, f, direction, &options).is_err());
        for sign in [1.0, -1.0, 1.0] {
            let aimed = Setting { direction: setting.direction * sign, ..setting.clone() };
            check(&mut tracker, &aimed, &bodies);
        }
    }
    for graze_tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        let options = Options { graze_tolerance, ..Options::default() };
        let refused = tracker.cast_with(m, f, setting.direction, &options);
        assert!(matches!(refused, Err(QueryError::GrazeTolerance { .. })), "{refused:?}");
        check(&mut tracker, &setting, &bodies);
    }
    for half_side in [-1.0, f64::NAN] {
        let focus = Focus { features: true, region: Region::Fixed(half_side) };
        let refused = Tracker::new(&bodies.moving, &bodies.fixed).with_focus(focus);
        assert!(matches!(refused, Err(QueryError::RegionFocus { .. })), "{refused:?}");
    }
}

#[test]
fn without_focus_the_same_bits_as_from_scratch() {
    for (family, ..) in FAMILIES {
        for solver in [Solver::Auto, Solver::Cta] {
            let mut walk = Walk::new(family, 5);
            let bodies = walk.setting.bodies().expect("a body");
            let tracker = Tracker::new(&bodies.moving, &bodies.fixed);
            let mut tracker = tracker.with_focus(Focus::NONE).expect("a focus");
            while walk.step < 100 {
                let found = track(&mut tracker, &walk.setting, solver).expect("an answer");
                let one_off = walk.setting.cast(&bodies, solver).expect("an answer");
                assert_eq!(format!("{found:?}"), format!("{one_off:?}"), "{walk}");
                walk.advance();
            }
        }
    }
}

#[test]
fn the_same_sequence_gives_the_same_bits() {
    for (family, ..) in FAMILIES {
        let all = || {
            let mut walk = Walk::new(family, 9);
            let bodies = walk.setting.bodies().expect("a body");
            let mut tracker = Tracker::new(&bodies.moving, &bodies.fixed);
            let mut answers = Vec::new();
            while walk.step < 60 {
                let solver = if walk.step % 4 < 2 { Solver::Auto } else { Solver::Cta };
                answers.push(format!("{:?}", track(&mut tracker, &walk.setting, solver)));
                walk.advance();
            }
            answers
        };
        assert_eq!(all(), all(), "{family}");
    }
}

/// Asked again, a tracker finds the value again in the last digits, and needs no search for it.
#[test]
fn asked_again() {
    let setting = above(cone(12), cuboid(DVec3::ONE));
    let bodies = setting.bodies().expect("bodies");
    let mut tracker = Tracker::new(&bodies.moving, &bodies.fixed);
    check(&mut tracker, &setting, &bodies);
    let again = check(&mut tracker, &setting, &bodies);
    let once_more = check(&mut tracker, &setting, &bodies);
    assert_eq!(without_steps(&again), without_steps(&once_more));
    assert!(once_more.steps().supports <= 8, "{:?}", once_more.steps());
}

#[test]
fn steps_are_those_of_all_casts() {
    let setting = above(cone(12), cuboid(DVec3::ONE));
    let bodies = setting.bodies().expect("bodies");
    let mut tracker = Tracker::new(&bodies.moving, &bodies.fixed);
    let (m, f, d) = (&setting.moving_pose, &setting.fixed_pose, setting.direction);
    for _ in 0..3 {
        for solver in [Solver::Auto, Solver::Cta] {
            let options = Options { solver, ..Options::default() };
            let outcome = tracker.cast_with(m, f, d, &options).expect("an answer");
            assert_eq!(tracker.steps(), outcome.steps());
            let range = tracker.contact_range(m, f, d, &options).expect("a range");
            let ends = range_ends(&range).into_iter().map(|end| end.steps());
            let sum = ends.fold(
                Steps { started_from: StartedFrom::Features, ..Steps::default() },
                |a, b| Steps {
                    planar_problems: a.planar_problems + b.planar_problems,
                    supports: a.supports + b.supports,
                    pivots: a.pivots + b.pivots,
                    iterations: a.iterations + b.iterations,
                    started_from: a.started_from.max(b.started_from),
                },
            );
            assert_eq!(tracker.steps(), sum);
        }
    }
}

/// What the cast against the direction left is there for the next one that looks that way.
#[test]
fn both_ends_of_a_range_are_followed() {
    let setting = above(cone(12), cuboid(DVec3::ONE));
    let bodies = setting.bodies().expect("bodies");
    let mut tracker = Tracker::new(&bodies.moving, &bodies.fixed);
    let (m, f, d) = (&setting.moving_pose, &setting.fixed_pose, setting.direction);
    let options = Options::default();
    tracker.contact_range(m, f, d, &options).expect("a range");
    assert_eq!(tracker.steps().started_from, StartedFrom::Scratch);
    let [once, back] = [d, -d].map(|d| {
        tracker.contact_range(m, f, d, &options).expect("a range");
        tracker.steps()
    });
    assert_eq!([once.started_from, back.started_from], [StartedFrom::Features; 2]);
    // Both ends are where they were: no face is crossed on the way there.
    assert!(once.supports <= 8 && back.supports <= 8, "{once:?} {back:?}");
    for direction in [d, -d, -d, d] {
        let outcome = tracker.cast(m, f, direction).expect("an answer");
        assert_eq!(outcome.steps().started_from, StartedFrom::Features);
    }
}

#[test]
fn a_tracker_is_small() {
    let size = size_of::<Tracker>();
    println!("a tracker takes {size} bytes");
    assert!(size <= 400, "{size}");
    // As its documentation says: besides two references and the focus.
    assert!(size - 2 * size_of::<&ConvexPolyhedron>() < 300 + size_of::<Focus>(), "{size}");
}

#[test]
fn a_slide_from_contact_to_separation_is_followed() {
    let mut rng = Rng::new(5);
    let (mut switches, mut followed) = (0, 0);
    for _ in 0..100 {
        let mut body = || {
            let points: Vec<DVec3> = (0..60).map(|_| rng.direction()).collect();
            ConvexPolyhedron::from_points(&points).unwrap()
        };
        let (moving, fixed) = (body(), body());
        let mut tracker = Tracker::new(&moving, &fixed);
        let mut met = false;
        for step in 0..250 {
            let at = DVec3::new(0.01 * f64::from(step), 0.1, 5.0);
            let pose = Pose::from_translation(at).unwrap();
            let outcome = tracker.cast(&pose, &Pose::IDENTITY, DVec3::NEG_Z).unwrap();
            let meets = matches!(outcome, Outcome::Contact(_));
            if met && !meets {
                switches += 1;
                followed += u32::from(tracker.steps().started_from == StartedFrom::Features);
            }
            met = meets;
        }
    }
    assert!(switches >= 100 && 10 * followed >= 9 * switches, "{followed} of {switches}");
}
