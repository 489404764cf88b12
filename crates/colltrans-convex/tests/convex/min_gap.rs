//! Casts that keep a gap: what is known in closed form, every family, degenerate bodies, proofs and changed ones.

use colltrans_convex::observe::{Event, Recording};
use colltrans_convex::{
    Cast, Clearance, Contact, ConvexPolyhedron, FreeReason, Outcome, Pose, QueryError, Solver,
    StartedFrom, Tracker,
};
use colltrans_testkit::bodies::{at_xyz as at, body};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::min_gap::GapJudge;
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::random_hull;
use glam::{DQuat, DVec3};
use proptest::prelude::*;

fn cube() -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)).expect("a box")
}

/// The judged first contact, if there is one.
fn judged(cast: &Cast) -> Option<Contact> {
    let judge = GapJudge::new(*cast);
    let outcome = cast.first_contact().expect("an answer");
    judge.check(&outcome).expect("a right outcome");
    judge.check_clearance(&cast.clearance().expect("an answer")).expect("a right clearance");
    match outcome {
        Outcome::Contact(contact) => Some(contact),
        _ => None,
    }
}

#[test]
fn all_families_are_right() {
    let mut contacts = 0;
    for (family, _) in FAMILIES {
        for seed in 0..cases(12) {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            for gap in [1e-9, 0.01, 0.5, 100.0] {
                contacts += u32::from(judged(&cast.with_min_gap(gap).expect("a gap")).is_some());
            }
        }
    }
    assert!(contacts > cases(900), "{contacts}");
}

#[test]
fn a_gap_of_nothing_is_none() {
    for (family, _) in FAMILIES {
        for seed in 0..12 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            let kept = cast.with_min_gap(0.0).expect("no gap");
            assert_eq!(kept.first_contact(), cast.first_contact());
            assert_eq!(kept.clearance(), cast.clearance());
        }
    }
}

#[test]
fn faces_edges_and_corners_in_closed_form() {
    let (cube, turned) = (cube(), DQuat::from_rotation_z(std::f64::consts::FRAC_PI_4));
    let turned = |x, y| Pose::new(turned, DVec3::new(x, y, 0.0)).expect("a pose");
    for gap in [1e-12, 1e-9, 1e-3, 0.25, 1.0, 17.0] {
        let first = |moving: Pose| {
            let cast = Cast::new(cube.at(moving), cube.at(Pose::IDENTITY), DVec3::X * 2.0);
            let kept = cast.expect("a query").with_min_gap(gap).expect("a gap");
            let contact = judged(&kept).expect("in the way");
            let size = 30.0 + gap;
            let certificate = contact.certificate;
            assert!(certificate.gap() <= 1e-14 * size, "{gap}: {certificate:?}");
            (2.0 * contact.translation, contact.normal, 4e-15 * size)
        };
        // Face to face; an edge and a face; edges that are half the gap off each other.
        let (t, normal, off) = first(at(-20.0, 0.25, 0.0));
        assert!((t - (19.0 - gap)).abs() <= off && normal == DVec3::X, "{gap}: {t}");
        let (t, _, off) = first(turned(-20.0, 0.25));
        assert!((t - (19.5 - 0.5_f64.sqrt() - gap)).abs() <= off, "{gap}: {t}");
        if gap < 1e-11 {
            // Half of it would be grazing.
            continue;
        }
        let (t, normal, off) = first(at(-20.0, 1.0 + 0.5 * gap, 0.0));
        assert!((t - (19.0 - 0.75_f64.sqrt() * gap)).abs() <= 8.0 * off, "{gap}: {t}");
        assert!((normal.y + 0.5).abs() < 1e-3, "{gap}: {normal}");
    }
}

#[test]
fn who_slides_along_at_the_gap_is_free_and_who_starts_nearer_is_told() {
    let cube = cube();
    let beside = |y: f64, gap: f64| {
        let cast = Cast::new(cube.at(at(-3.0, y, 0.1)), cube.at(Pose::IDENTITY), DVec3::X);
        let kept = cast.expect("a query").with_min_gap(gap).expect("a gap");
        judged(&kept);
        kept.clearance().expect("an answer")
    };
    assert!(matches!(beside(1.25, 0.25), Clearance::Free(FreeReason::Slides(_))));
    assert!(matches!(beside(1.25, 0.249_999), Clearance::Free(FreeReason::Separated(_))));
    assert!(matches!(beside(1.25, 0.250_001), Clearance::Blocked { .. }));
    // Who tolerates a graze does with a gap, whichever of the two the shadows overlap by.
    for (y, grazes) in [(1.0, true), (0.999, true), (0.98, false), (1.01, true)] {
        let cast = Cast::new(cube.at(at(-3.0, y, 0.1)), cube.at(Pose::IDENTITY), DVec3::X);
        let kept = cast.expect("a query").with_graze_tolerance(0.02).expect("a tolerance");
        let kept = kept.with_min_gap(0.01).expect("a gap");
        let outcome = kept.first_contact().expect("an answer");
        GapJudge::new(kept).check(&outcome).expect("right");
        assert_eq!(matches!(outcome, Outcome::Grazing(_)), grazes, "{y}: {outcome:?}");
    }
    // From above, a quarter away.
    let above = |direction: DVec3, gap: f64| {
        let cast = Cast::new(cube.at(at(0.0, 0.0, 1.25)), cube.at(Pose::IDENTITY), direction);
        let kept = cast.expect("a query").with_min_gap(gap).expect("a gap");
        judged(&kept);
        kept
    };
    let down = |gap| above(DVec3::NEG_Z, gap).clearance().expect("an answer");
    assert!(matches!(down(0.25), Clearance::Blocked { distance, .. } if distance < 1e-14));
    assert!(matches!(down(0.2), Clearance::Blocked { distance, .. } if distance > 0.049));
    let Clearance::Overlapping(nearer) = down(0.3) else { panic!("nearer than 0.3") };
    assert!((nearer.first.translation + 0.05).abs() < 1e-14);
    let up = |gap| above(DVec3::Z, gap).clearance().expect("an answer");
    assert!(matches!(up(0.25), Clearance::Free(FreeReason::Behind(_))));
    assert!(matches!(up(0.3), Clearance::Overlapping(_)));
    assert!(above(DVec3::X, 0.3).intersects().expect("an answer").meets);
    assert!(!above(DVec3::X, 0.2).intersects().expect("an answer").meets);
    let depth = above(DVec3::NEG_Z, 0.3).directional_depth().expect("an answer");
    assert!((depth.depth - 0.05).abs() < 3e-14);
    let range = above(DVec3::NEG_Z, 0.5).contact_range().expect("an answer");
    let [first, last] = range.interval().expect("they come near");
    assert!((first + 0.25).abs() < 1e-14 && (last - 2.75).abs() < 1e-14);
}

#[test]
fn who_glides_over_another_at_about_the_gap_is_told_where() {
    let cube = ConvexPolyhedron::cuboid(DVec3::NEG_ONE, DVec3::ONE).expect("a box");
    let over = |tilt: f64, gap: f64| {
        let above = DVec3::new(-0.5, 0.0, 2.01);
        let pose = Pose::new(DQuat::from_rotation_y(tilt), above).expect("a pose");
        let cast = Cast::new(cube.at(pose), cube.at(Pose::IDENTITY), DVec3::X).expect("a query");
        let kept = cast.with_min_gap(gap).expect("a gap");
        (judged(&kept), judged(&kept.reversed()), kept)
    };
    // Its front edge is as near as the gap, by less than rounding can tell; all of its lower side nearly is.
    let (first, last, kept) = over(6.3e-14, 0.01 * (1.0 + 1e-11));
    let [first, last] = [first, last].map(|contact| contact.expect("as near as the gap"));
    assert!((first.translation + 1.5).abs() < 1e-6, "{first:?}");
    // It is left where that edge passes that of the other box: the best estimate, between wide bounds.
    let proof = last.certificate;
    assert!((last.translation + 2.5).abs() < 1e-6 && proof.gap() > 0.1, "{last:?}");
    assert!(kept.reversed().verify(&proof).expect("a proof") <= proof.rounding);
    assert!(matches!(kept.clearance(), Ok(Clearance::Overlapping(_))));
    for tilt in [1e-15, 1e-14, 3e-14, 6.3e-14, 1e-13, 1e-12] {
        for more in (0..cases(60)).map(|k| 5e-15 * f64::from(k)) {
            over(tilt, 0.01 + more);
            over(-tilt, 0.01 + more);
        }
    }
}

#[test]
fn bodies_of_any_dimension_and_place() {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let shapes = [
        body(&[DVec3::ZERO]),
        body(&[x, -x]),
        body(&[x, y, -x - y]),
        cube(),
        ConvexPolyhedron::cuboid(DVec3::splat(-1e7), DVec3::splat(1e7)).expect("a box"),
        ConvexPolyhedron::cuboid(-x - y, x + y + z * 1e-9).expect("a box"),
        body(&[z * 1e-6, -z * 1e-6]),
    ];
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7);
    for p in &shapes {
        for q in &shapes {
            for by in [DVec3::ZERO, x * 3.0, y + z * 0.5, z * 2.0] {
                for rotation in [DQuat::IDENTITY, turn] {
                    for gap in [1e-13, 1e-9, 0.5, 1.0, 1e4] {
                        let pose = Pose::new(rotation, by + x * 1e3).expect("a pose");
                        let cast = Cast::new(p.at(at(1e3, 0.0, 0.0)), q.at(pose), x + y * 0.25);
                        judged(&cast.expect("a query").with_min_gap(gap).expect("a gap"));
                    }
                }
            }
        }
    }
}

#[test]
fn witness_points_are_the_gap_apart() {
    let mut random = Random::new(5);
    for _ in 0..200 {
        let [p, q] = [0, 1].map(|_| body(&random_hull(20, &mut random).vertices));
        let start = Pose::new(random.rotation(), DVec3::X * -6.0).expect("a pose");
        let cast = Cast::new(p.at(start), q.at(Pose::IDENTITY), DVec3::X).expect("a query");
        let contact = judged(&cast.with_min_gap(0.5).expect("a gap")).expect("in the way");
        let points = contact.witness_points(&cast);
        let there = points.on_moving + DVec3::X * contact.translation;
        let way = points.on_fixed - there;
        assert!((way.length() - 0.5).abs() < 1e-13, "{way}");
        assert!(way.normalize().distance(contact.normal) < 1e-6, "{way} {}", contact.normal);
        let before = contact.pose_before(&cast).expect("a pose");
        assert!(before.translation().x <= start.translation().x + contact.certificate.lower);
    }
}

#[test]
fn gaps_that_are_none_are_refused() {
    let cube = cube();
    let cast = Cast::new(cube.at(at(-3.0, 0.0, 0.0)), cube.at(Pose::IDENTITY), DVec3::X);
    let cast = cast.expect("a query");
    for gap in [-1e-300, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e61] {
        let refused = cast.with_min_gap(gap).expect_err("no gap");
        assert!(matches!(refused, QueryError::MinGap { .. }), "{gap}");
        assert!(refused.to_string().contains("gap"), "{refused}");
    }
    for gap in [0.0, f64::MIN_POSITIVE, 1e-70, 1e60] {
        cast.with_min_gap(gap).expect("a gap").clearance().expect("an answer");
    }
}

#[test]
fn changed_proofs_are_refused() {
    let mut random = Random::new(11);
    for round in 0..300 {
        let [p, q] = [0, 1].map(|_| body(&random_hull(12, &mut random).vertices));
        let start = Pose::new(random.rotation(), random.direction() * 5.0).expect("a pose");
        let way = -start.translation() + random.direction() * 0.5;
        let cast = Cast::new(p.at(start), q.at(Pose::IDENTITY), way).expect("a query");
        let gap = [0.01, 0.3, 2.0][round % 3];
        let kept = cast.with_min_gap(gap).expect("a gap");
        let Some(contact) = judged(&kept) else { continue };
        let proof = contact.certificate;
        let proven = kept.verify(&proof).expect("a proof");
        assert!(proven >= 0.0);
        let noise = 1e-13 / proof.normal.dot(way);
        let refused = |what: &str, change: &dyn Fn(&mut colltrans_convex::Certificate)| {
            let mut changed = proof;
            change(&mut changed);
            assert!(kept.verify(&changed).is_err(), "{what} of {round}");
        };
        refused("lower", &|p| p.lower += noise);
        refused("upper", &|p| p.upper = p.lower - noise);
        refused("upper", &|p| p.upper -= noise);
        refused("normal", &|p| p.normal = (p.normal + DVec3::X * 1e-3).normalize());
        refused("weights", &|p| p.weights[0] *= 1.5);
        refused("rounding", &|p| p.rounding *= 1e3);
        refused("no number", &|p| p.upper = f64::NAN);
        // It is about this gap, and no larger one.
        assert!(cast.with_min_gap(gap + 1e-9).expect("a gap").verify(&proof).is_err());
        assert!(cast.verify(&proof).is_err());
    }
}

#[test]
fn separations_are_of_the_gap() {
    let cube = cube();
    let cast = Cast::new(cube.at(at(-3.0, 1.5, 0.0)), cube.at(Pose::IDENTITY), DVec3::X);
    let cast = cast.expect("a query");
    let kept = cast.with_min_gap(0.4).expect("a gap");
    let Outcome::Separated(separated) = kept.first_contact().expect("an answer") else {
        panic!("half a unit aside")
    };
    assert!(kept.verify(&separated.certificate).expect("a proof") > 0.4);
    assert!(cast.with_min_gap(0.5).expect("a gap").verify(&separated.certificate).is_err());
    let mut less = separated.certificate;
    less.margin = 0.4;
    assert!(kept.verify(&less).is_err());
}

#[test]
fn trackers_answer_as_one_off_queries() {
    let mut random = Random::new(7);
    let [p, q] = [0, 1].map(|_| body(&random_hull(60, &mut random).vertices));
    let (mut tracker, mut looks) = (Tracker::new(), [0, 0]);
    for step in 0..cases(200) {
        let turn = DQuat::from_rotation_z(1e-3 * f64::from(step));
        let start = Pose::new(turn, DVec3::new(-5.0, 0.2, 1e-3 * f64::from(step)));
        let cast = Cast::new(p.at(start.expect("a pose")), q.at(Pose::IDENTITY), DVec3::X);
        let kept = cast.expect("a query").with_min_gap(0.2).expect("a gap");
        let tracked = tracker.first_contact(&kept).expect("an answer");
        GapJudge::new(kept).check(&tracked).expect("right");
        let (Outcome::Contact(a), Some(b)) = (tracked, judged(&kept)) else { panic!("ahead") };
        assert!((a.translation - b.translation).abs() < 1e-13);
        let from = if step == 0 { StartedFrom::Scratch } else { StartedFrom::Features };
        assert_eq!(a.steps.started_from, from);
        looks[0] += a.steps.pivots;
        looks[1] += b.steps.pivots;
    }
    assert!(looks[0] <= looks[1], "{looks:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(300)))]

    #[test]
    fn any_gap_and_solver(
        seed in 0_u64..1_000_000,
        exponent in -15.0..5.0_f64,
        y in -2.0..2.0_f64,
        vertices in 4_usize..40,
        cta: bool,
    ) {
        let mut random = Random::new(seed);
        let [p, q] = [0, 1].map(|_| body(&random_hull(vertices, &mut random).vertices));
        let start = Pose::new(random.rotation(), DVec3::new(-4.0, y, 0.3)).expect("a pose");
        let cast = Cast::new(p.at(start), q.at(Pose::IDENTITY), DVec3::X * 0.3).expect("a query");
        let solver = if cta { Solver::Cta } else { Solver::Portal };
        let kept = cast.with_solver(solver).with_min_gap(10.0_f64.powf(exponent)).expect("a gap");
        judged(&kept);
        let back = GapJudge::new(kept.reversed());
        back.check(&kept.reversed().first_contact().expect("an answer")).expect("right");
    }

    /// Who keeps more stops no later.
    #[test]
    fn larger_gaps_stop_earlier(seed in 0_u64..1_000_000, gap in 0.0..1.0_f64, more in 0.0..1.0_f64) {
        let mut random = Random::new(seed);
        let [p, q] = [0, 1].map(|_| body(&random_hull(16, &mut random).vertices));
        let start = Pose::new(random.rotation(), DVec3::X * -6.0).expect("a pose");
        let cast = Cast::new(p.at(start), q.at(Pose::IDENTITY), DVec3::X).expect("a query");
        let travel = |gap| {
            let clearance = cast.with_min_gap(gap).expect("a gap").clearance().expect("an answer");
            clearance.distance().expect("apart")
        };
        prop_assert!(travel(gap + more) <= travel(gap) + 1e-12);
        prop_assert!(travel(gap + more) >= travel(gap) - more * 1e6);
    }
}

/// A gap of some roundings, and bodies that pass each other without it but not with it.
#[test]
fn a_slight_gap_that_alone_stops_a_body_is_proven() {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a box");
    let pose =
        Pose::from_translation(DVec3::new(-3.0, 1.000_000_000_000_03, 0.25)).expect("a pose");
    let cast = Cast::new(cube.at(pose), cube.at(Pose::IDENTITY), DVec3::X)
        .and_then(|cast| cast.with_min_gap(7.8e-14))
        .expect("a cast");
    let contact = match cast.first_contact().expect("an answer") {
        Outcome::Contact(contact) => contact,
        Outcome::Grazing(of) => of.contact,
        Outcome::Separated(of) => panic!("{of:?}"),
    };
    cast.verify(&contact.certificate).expect("its own proof");
}

/// Who observes such a search hears the frame and then planes, each lowest on `M` there; answers are the same.
#[test]
fn observers_hear_of_planes() {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a box");
    let turn = DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize();
    let start = Pose::new(turn, DVec3::new(-3.0, 0.5, 0.25)).expect("a pose");
    for gap in [0.25, 1e-15] {
        let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X).expect("a query");
        let cast = cast.with_min_gap(gap).expect("a gap");
        let mut heard = Recording::default();
        let observed = cast.first_contact_observed(&mut heard);
        assert_eq!(observed, cast.first_contact());
        let Ok(Outcome::Contact(contact)) = observed else { panic!("{observed:?}") };
        let Some(Event::SearchStarted(frame)) = heard.events().first() else { panic!("{heard:?}") };
        assert!((frame.world_from_shadow.z_axis - DVec3::X).length() < 1e-15);
        let supports = heard.events().iter().filter(|event| matches!(event, Event::Support(_)));
        let count = supports.count() as u32;
        assert!(0 < count && count <= contact.steps.supports, "{count} of {:?}", contact.steps);
        let mut tracked = Recording::default();
        let again = Tracker::new().first_contact_observed(&cast, &mut tracked);
        assert_eq!((again, tracked.events().len()), (observed, heard.events().len()));
    }
}
