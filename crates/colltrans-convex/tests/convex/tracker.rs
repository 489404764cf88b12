//! Trackers give the answers of one-off queries, whatever they have been asked before.

use colltrans_convex::{
    Cast, Clearance, ContactRange, ConvexPolyhedron, Focus, Options, Outcome, OverlapAhead, Pair,
    Pose, QueryError, Solver, StartedFrom, Steps, Tracker, cta,
};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::check::compare_answers;
use colltrans_testkit::oracle::sequences::Walk;
use colltrans_testkit::oracle::settings::{Bodies, FAMILIES, Setting};
use colltrans_testkit::oracle::shadow::sideways_overlap;
use colltrans_testkit::oracle::tracked::{Lanes, ignoring_steps, track};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{self, cuboid};
use glam::{DQuat, DVec3};
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
        for seed in 0..cases(WALKS) {
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

/// Two boxes pass each other corner by corner, by two roundings: the corner is the nearest point of
/// the shadow, and so is a rounded one of the edge there.
#[test]
fn boxes_that_pass_by_their_corners_are_apart_for_every_lane() {
    let mut walk = Walk::new("boxes", 1_726_576_853_074);
    let bodies = walk.setting.bodies().expect("a body");
    let mut lanes = Lanes::new(&bodies);
    while walk.step < 34 {
        for finding in lanes.ask(&walk.setting, walk.step >= 29) {
            if let Err(e) = finding.verdict {
                panic!("{walk} {}: {e}", finding.lane);
            }
        }
        walk.advance();
    }
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
        && ends[0].iter().zip(&ends[1]).all(|(a, b)| compare_answers(a, b).is_ok());
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
        Clearance::Blocked { distance, .. } => Some([*distance; 2]),
        Clearance::Overlapping(OverlapAhead { first, last }) => {
            Some([first.translation, -last.translation])
        }
        Clearance::Free(_) => None,
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
        Ok(Outcome::Contact(contact)) => contact.certificate.rounding,
        _ => 0.0,
    }
}

#[test]
fn ranges_and_clearances_are_those_of_one_off_queries() {
    for (family, ..) in FAMILIES {
        for seed in 100..104 {
            let mut walk = Walk::new(family, seed);
            let bodies = walk.setting.bodies().expect("a body");
            let mut tracker = Tracker::new();
            while walk.step < 60 {
                let s = &walk.setting;
                let solver = if seed % 2 == 0 { Solver::Auto } else { Solver::Cta };
                let sign = if walk.step.is_multiple_of(3) { -1.0 } else { 1.0 };
                let aimed = Setting { direction: s.direction * sign, ..s.clone() };
                let cast = aimed.query(&bodies).expect("a query").with_solver(solver);
                if walk.step.is_multiple_of(2) {
                    let found = tracker.contact_range(&cast).expect("a range");
                    let one_off = cast.contact_range().expect("a range");
                    if let Some([enter, exit]) = found.interval() {
                        assert!(enter <= exit, "{walk}: {found:?}");
                    }
                    assert!(
                        ranges_agree(&aimed, &bodies, &found, &one_off),
                        "{walk}: {found:?} {one_off:?}"
                    );
                } else {
                    let found = tracker.clearance(&cast).expect("a clearance");
                    let one_off = cast.clearance().expect("a clearance");
                    assert!(
                        clearances_agree(&aimed, &bodies, &found, &one_off),
                        "{walk}: {found:?} {one_off:?}"
                    );
                }
                let found = tracker.intersects(&cast).expect("an answer");
                let one_off = cast.intersects().expect("an answer");
                assert_eq!(
                    (found.meets, found.evidence.direction),
                    (one_off.meets, one_off.evidence.direction)
                );
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
        2 => vector.prop_map(|v| cuboid(v.abs() + 0.1).vertices),
        1 => (3..40_usize).prop_map(cone),
    ]
}

/// A cone over a regular polygon: its apex has as many neighbours.
fn cone(sides: usize) -> Vec<DVec3> {
    shapes::cone(sides, [0.0, 1.0]).vertices
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
fn step(setting: &mut Setting, rng: &mut Random, exponent: f64) {
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
        let mut rng = Random::new(seed);
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
        let mut tracker = Tracker::new();
        let mut rng = Random::new(sides as u64);
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
fn check<'a>(tracker: &mut Tracker<'a>, setting: &Setting, bodies: &'a Bodies) -> Outcome {
    let found = track(tracker, setting, bodies, Solver::Auto).expect("an answer");
    let one_off = setting.cast(bodies, Solver::Auto).expect("an answer");
    let judge = setting.judge(bodies);
    judge.check(&found).unwrap_or_else(|e| panic!("{e}\n{}", setting.dump()));
    compare_answers(&found, &one_off).unwrap_or_else(|e| panic!("{e}\n{}", setting.dump()));
    found
}

#[test]
fn a_clone_follows_another_future() {
    let mut setting = above(cone(12), cuboid(DVec3::ONE).vertices);
    let bodies = setting.bodies().expect("bodies");
    let mut here = Tracker::new();
    check(&mut here, &setting, &bodies);
    let mut there = here.clone();
    let mut other = setting.clone();
    let (mut first, mut second) = (Random::new(1), Random::new(2));
    for _ in 0..100 {
        step(&mut setting, &mut first, 1.5);
        step(&mut other, &mut second, 1.5);
        check(&mut here, &setting, &bodies);
        check(&mut there, &other, &bodies);
    }
    // And neither has touched the other: the first alone has the same bits.
    let mut setting = above(cone(12), cuboid(DVec3::ONE).vertices);
    let mut alone = Tracker::new();
    let mut rng = Random::new(1);
    check(&mut alone, &setting, &bodies);
    for _ in 0..100 {
        step(&mut setting, &mut rng, 1.5);
        check(&mut alone, &setting, &bodies);
    }
    assert_eq!(format!("{here:?}"), format!("{alone:?}"));
}

#[test]
fn reset_forgets() {
    let setting = above(cone(12), cuboid(DVec3::ONE).vertices);
    let bodies = setting.bodies().expect("bodies");
    let mut tracker = Tracker::new();
    let first = check(&mut tracker, &setting, &bodies);
    assert_eq!(first.steps().started_from, StartedFrom::Scratch);
    assert_eq!(check(&mut tracker, &setting, &bodies).steps().started_from, StartedFrom::Features);
    tracker.reset();
    assert_eq!(check(&mut tracker, &setting, &bodies), first);
}

#[test]
fn a_focus_is_checked() {
    for half_side in [-1.0, f64::NAN] {
        let focus = Focus::NONE.with_features(true).with_region(cta::Region::Fixed(half_side));
        let refused = Tracker::new().with_focus(focus);
        assert!(matches!(refused, Err(QueryError::RegionFocus { .. })), "{refused:?}");
    }
}

/// One tracker for several pairs of bodies: each change starts from scratch.
#[test]
fn other_bodies_are_other_bodies() {
    let settings = [
        above(cone(40), cuboid(DVec3::ONE).vertices),
        above(cuboid(DVec3::ONE).vertices, cone(40)),
        above(cone(3), cone(5)),
    ];
    let bodies = settings.each_ref().map(|s| s.bodies().expect("bodies"));
    let mut tracker = Tracker::new();
    for _ in 0..3 {
        for (setting, bodies) in settings.iter().zip(&bodies) {
            let first = check(&mut tracker, setting, bodies);
            assert_eq!(first.steps().started_from, StartedFrom::Scratch);
            let again = check(&mut tracker, setting, bodies);
            assert_eq!(again.steps().started_from, StartedFrom::Features);
        }
    }
}

#[test]
fn without_focus_the_same_bits_as_from_scratch() {
    for (family, ..) in FAMILIES {
        for solver in [Solver::Auto, Solver::Cta] {
            let mut walk = Walk::new(family, 5);
            let bodies = walk.setting.bodies().expect("a body");
            let tracker = Tracker::new();
            let mut tracker = tracker.with_focus(Focus::NONE).expect("a focus");
            while walk.step < 100 {
                let found = track(&mut tracker, &walk.setting, &bodies, solver).expect("an answer");
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
            let mut tracker = Tracker::new();
            let mut answers = Vec::new();
            while walk.step < 60 {
                let solver = if walk.step % 4 < 2 { Solver::Auto } else { Solver::Cta };
                answers.push(format!("{:?}", track(&mut tracker, &walk.setting, &bodies, solver)));
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
    let setting = above(cone(12), cuboid(DVec3::ONE).vertices);
    let bodies = setting.bodies().expect("bodies");
    let mut tracker = Tracker::new();
    check(&mut tracker, &setting, &bodies);
    let again = check(&mut tracker, &setting, &bodies);
    let once_more = check(&mut tracker, &setting, &bodies);
    assert_eq!(ignoring_steps(&again), ignoring_steps(&once_more));
    assert!(once_more.steps().supports <= 8, "{:?}", once_more.steps());
}

#[test]
fn steps_are_those_of_all_casts() {
    let setting = above(cone(12), cuboid(DVec3::ONE).vertices);
    let bodies = setting.bodies().expect("bodies");
    let mut tracker = Tracker::new();
    for _ in 0..3 {
        for solver in [Solver::Auto, Solver::Cta] {
            let cast = setting.query(&bodies).expect("a query").with_solver(solver);
            let outcome = tracker.first_contact(&cast).expect("an answer");
            assert_eq!(tracker.steps(), outcome.steps());
            let range = tracker.contact_range(&cast).expect("a range");
            let ends = range_ends(&range).into_iter().map(|end| end.steps());
            let mut sum = Steps::default();
            sum.started_from = StartedFrom::Features;
            for steps in ends {
                sum.planar_problems += steps.planar_problems;
                sum.supports += steps.supports;
                sum.pivots += steps.pivots;
                sum.iterations += steps.iterations;
                sum.started_from = sum.started_from.max(steps.started_from);
            }
            assert_eq!(tracker.steps(), sum);
        }
    }
}

/// Whatever was asked before: the other way, other questions, and nothing since.
#[test]
fn steps_are_those_of_the_last_query() {
    let setting = above(cone(12), cuboid(DVec3::ONE).vertices);
    let bodies = setting.bodies().expect("bodies");
    let there = setting.query(&bodies).expect("a query");
    let back = there.reversed();
    let keeping = |gap| there.with_options(Options::default().with_min_gap(gap)).expect("a gap");
    let [keeping, slightly] = [0.01, 1e-15].map(keeping);
    let mut tracker = Tracker::new();
    for cast in [&there, &back, &back, &keeping, &there, &slightly, &there, &back] {
        let outcome = tracker.first_contact(cast).expect("an answer");
        assert_eq!(tracker.steps(), outcome.steps());
        for _ in 0..2 {
            let moving = there.moving().at(there.moving_pose());
            let pair = Pair::new(moving, there.fixed().at(there.fixed_pose())).expect("a pair");
            let distance = tracker.distance(&pair).expect("a distance");
            assert_eq!(tracker.steps(), distance.steps);
        }
        let (mut of_range, mut of_depth) = (tracker.clone(), tracker.clone());
        of_range.contact_range(cast).expect("a range");
        of_depth.directional_depth(cast).expect("a depth");
        for asked in [of_range, of_depth] {
            let steps = asked.steps();
            assert!(steps.supports > 0 && asked.clone().steps() == steps, "{steps:?}");
            let mut asked = asked;
            asked.reset();
            assert_eq!(asked.steps(), steps);
        }
        tracker.intersects(cast).expect("an answer");
        assert!(tracker.steps().supports > 0);
    }
}

/// What the cast against the direction left is there for the next one that looks that way.
#[test]
fn both_ends_of_a_range_are_followed() {
    let setting = above(cone(12), cuboid(DVec3::ONE).vertices);
    let bodies = setting.bodies().expect("bodies");
    let mut tracker = Tracker::new();
    let there = setting.query(&bodies).expect("a query");
    let back = there.reversed();
    tracker.contact_range(&there).expect("a range");
    assert_eq!(tracker.steps().started_from, StartedFrom::Scratch);
    for cast in [&there, &back] {
        tracker.contact_range(cast).expect("a range");
        assert_eq!(tracker.steps().started_from, StartedFrom::Features);
        // Both ends are where they were: no face is crossed on the way there.
        assert!(tracker.steps().supports <= 8, "{:?}", tracker.steps());
    }
    for cast in [&there, &back, &back, &there] {
        let outcome = tracker.first_contact(cast).expect("an answer");
        assert_eq!(outcome.steps().started_from, StartedFrom::Features);
    }
}

#[test]
fn a_tracker_is_small() {
    let size = size_of::<Tracker>();
    println!("a tracker takes {size} bytes");
    // As its documentation says.
    assert!(size < 600, "{size}");
}

#[test]
fn a_slide_from_contact_to_separation_is_followed() {
    let mut rng = Random::new(5);
    let (mut switches, mut followed) = (0, 0);
    for _ in 0..100 {
        let mut body = || {
            let points: Vec<DVec3> = (0..60).map(|_| rng.direction()).collect();
            ConvexPolyhedron::from_points(&points).unwrap()
        };
        let (moving, fixed) = (body(), body());
        let mut tracker = Tracker::new();
        let mut met = false;
        for step in 0..250 {
            let at = DVec3::new(0.01 * f64::from(step), 0.1, 5.0);
            let pose = Pose::from_translation(at).unwrap();
            let cast = Cast::new(moving.at(pose), fixed.at(Pose::IDENTITY), DVec3::NEG_Z).unwrap();
            let outcome = tracker.first_contact(&cast).unwrap();
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

/// What trackers count as work: supports, portals, and the guess from scratch.
fn work(steps: Steps) -> f64 {
    let guesses = u32::from(steps.started_from == StartedFrom::Scratch);
    f64::from(3 * steps.supports + steps.pivots + guesses)
}

/// Of bodies that turn by so much from query to query that there is little to follow, a tracker makes no more
/// work than casts from scratch: it gives up, and tries again now and then. One that is told to follow makes more.
#[test]
fn a_tracker_gives_up_where_it_does_not_pay() {
    let shapes::Mesh { vertices, .. } = shapes::ring_sphere(200, 100);
    let ball = ConvexPolyhedron::from_points(&vertices).unwrap();
    let mut rng = Random::new(29);
    for (degrees, most, follows) in [(0.1_f64, 0.75, 0.9), (5.0, 1.03, 0.0), (40.0, 1.03, 0.0)] {
        let mut trackers = [Tracker::new(), Tracker::new().with_focus(Focus::default()).unwrap()];
        let mut works = [0.0; 3];
        let (mut followed, mut queries) = (0, 0);
        for _ in 0..20 {
            let axis = rng.direction();
            trackers.iter_mut().for_each(Tracker::reset);
            for step in 0..100 {
                let turn = DQuat::from_axis_angle(axis, degrees.to_radians() * f64::from(step));
                let pose = Pose::new(turn, turn * DVec3::new(0.3, 0.2, 4.0)).unwrap();
                let along = turn * DVec3::NEG_Z;
                let cast = Cast::new(ball.at(pose), ball.at(Pose::IDENTITY), along).unwrap();
                works[0] += work(cast.first_contact().unwrap().steps());
                for (tracker, sum) in trackers.iter_mut().zip(&mut works[1..]) {
                    *sum += work(tracker.first_contact(&cast).unwrap().steps());
                }
                queries += 1;
                followed += u32::from(trackers[0].steps().started_from == StartedFrom::Features);
            }
        }
        let [scratch, tracked, always] = works;
        println!(
            "{degrees}: {:.3} {:.3} {followed} of {queries}",
            tracked / scratch,
            always / scratch
        );
        assert!(tracked <= most * scratch, "{degrees}: {tracked} against {scratch}");
        assert!(tracked <= 1.1 * always, "{degrees}: {tracked} against {always}");
        assert!(f64::from(followed) >= follows * f64::from(queries), "{followed} of {queries}");
    }
}
