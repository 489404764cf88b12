//! How far along a motion: a slide has the answer of the linear cast, with tolerances and overlaps at the start; closed
//! forms of what turns.

use std::f64::consts::{FRAC_PI_2, PI};

use colltrans_convex::{Cast, Clearance, Pose};
use colltrans_motion::{Motion, MotionCast, MotionClearance, MotionOutcome, MotionStop};
use colltrans_solid::{Solid, SolidCast, StartOverlap};
use colltrans_testkit::bodies::{at_xyz as at, block as cuboid, hull, solid};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::block;
use colltrans_testkit::solids::{pin, washer};
use glam::{DMat3, DVec3};

/// A pose on one of a few places of a grid, turned by quarter turns.
fn tied(random: &mut Random) -> Pose {
    let quarter = DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z);
    let turn = (0..random.index(4)).fold(DMat3::IDENTITY, |turn, _| quarter * turn);
    let place = [(); 3].map(|()| random.pick(&[-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0]));
    Pose::from_matrix(turn, place.into()).expect("a pose")
}

fn way(random: &mut Random) -> DVec3 {
    loop {
        let way = DVec3::from_array([(); 3].map(|()| random.pick(&[-4.0, 0.0, 0.0, 2.0, 5.0])));
        if way != DVec3::ZERO {
            return way;
        }
    }
}

/// What the tests know of an answer: the bounds of the time in the true place and of the shrunk bodies, or why there are
/// none.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Told {
    Blocked([f64; 2], [f64; 2]),
    Free,
    Overlapping,
}

fn told<P>(clearance: &MotionClearance<P>) -> Told {
    match clearance {
        MotionClearance::Blocked { time, contact } => {
            let MotionStop { time: place, shrunk, .. } = &**contact;
            assert!(*time <= place.lower && *time <= shrunk.lower && *time >= 0.0);
            assert!(place.lower <= place.value && place.value <= place.upper, "{place:?}");
            Told::Blocked(place.bounds(), [shrunk.lower, shrunk.upper])
        }
        MotionClearance::Free(_) => Told::Free,
        MotionClearance::Overlapping(_) => Told::Overlapping,
    }
}

/// Whether two answers are one, to within so much. What comes at the very end, or later, is free.
fn agree(a: Told, b: Told, off: f64) -> bool {
    let late = |told: Told| matches!(told, Told::Blocked(_, [lower, _]) if lower > 1.0 - off);
    let meet = |x: [f64; 2], y: [f64; 2]| x[0] <= y[1] + off && y[0] <= x[1] + off;
    match (a, b) {
        (Told::Blocked(a, b), Told::Blocked(c, d)) => meet(a, c) && meet(b, d),
        _ => a == b || (late(a) && b == Told::Free) || (late(b) && a == Told::Free),
    }
}

/// The linear cast's answer.
fn linear(cast: &Cast<Solid>) -> Told {
    match cast.clearance().expect("an answer") {
        Clearance::Blocked { contact, .. } => {
            let place = contact.translation.bounds().map(|t| t.max(0.0));
            Told::Blocked(place, contact.shrunk_distance.bounds())
        }
        Clearance::Free(_) => Told::Free,
        Clearance::Overlapping(_) => Told::Overlapping,
    }
}

/// A polygon in the plane z = 0, counter-clockwise, drawn up: one shell, whose corners all have a way inwards.
fn extruded(outline: &[[f64; 2]], height: f64) -> Solid {
    let at = |z: f64| outline.iter().map(move |[x, y]| DVec3::new(*x, *y, z));
    let vertices: Vec<DVec3> = at(0.0).chain(at(height)).collect();
    let n = outline.len() as u32;
    let mut faces = vec![(0..n).rev().collect::<Vec<u32>>(), (n..2 * n).collect()];
    faces.extend((0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]));
    Solid::from_mesh(&vertices, &faces).expect("a solid")
}

fn bodies() -> [Solid; 4] {
    let ell = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let fork = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 2.0],
        [1.5, 2.0],
        [1.5, 0.5],
        [0.5, 0.5],
        [0.5, 2.0],
        [0.0, 2.0],
    ];
    let ring = solid(&washer([1.0, 2.0], [-0.5, 0.5], 8));
    [extruded(&ell, 1.0), extruded(&fork, 2.0), solid(&block([-0.5; 3], [1.0; 3])), ring]
}

/// Asks a slide as a motion and as a cast, with a tolerance and a meaning of overlaps, and counts how they end: stopped,
/// free, overlapping; after an overlap that is ignored stopped, and stopped by what is not proven to meet.
///
/// Of the last the cast knows that it is free, where edges pass along edges, or facets along vertices that shrinking has
/// left in their place: a motion stops too soon there, and says that it proves no more.
fn slides(poses: fn(&mut Random) -> Pose, by: fn(&mut Random) -> DVec3, off: f64) -> [u32; 5] {
    let (mut counts, bodies) = ([0; 5], bodies());
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let [p, q] = [(); 2].map(|()| &bodies[random.index(4)]);
        let (a, b, by) = (poses(&mut random), poses(&mut random), by(&mut random));
        let [slide, rest] = [Motion::slide(a, by).expect("a motion"), Motion::still(b)];
        let mut cast = MotionCast::new(p.along(&slide), q.along(&rest)).expect("a cast");
        let ignores = random.one_in(2);
        // By powers of two faces that are not turned are moved exactly: those along the way stay so.
        if ignores || random.one_in(2) {
            let tolerance = random.pick(&[0.5_f64.powi(30), 0.5_f64.powi(7), 0.125]);
            cast = cast.tolerating(tolerance).expect("a tolerance");
        }
        let start = if ignores { StartOverlap::Ignore } else { StartOverlap::Refuse };
        let straight = Cast::new(p.at(a), q.at(b), by).expect("a cast");
        let straight = straight.with_tolerance(cast.tolerance()).expect("a tolerance");
        let overlaps = straight.overlaps();
        let straight = linear(&straight.with_start_overlap(start));
        let turning = cast.with_start_overlap(start).clearance().expect("an answer");
        let turning = told(&turning);
        if let Told::Blocked(_, [lower, f64::INFINITY]) = turning
            && !agree(straight, turning, off)
        {
            let Told::Blocked(_, [_, upper]) = straight else {
                counts[4] += 1;
                continue;
            };
            assert!(lower < upper + off, "{seed}: {straight:?} {turning:?}");
            counts[4] += 1;
            continue;
        }
        assert!(agree(straight, turning, off), "{seed} {ignores}: {straight:?} {turning:?}");
        counts[match turning {
            Told::Blocked(..) if overlaps => 3,
            Told::Blocked(..) => 0,
            Told::Free => 1,
            Told::Overlapping => 2,
        }] += 1;
    }
    counts
}

#[test]
fn a_slide_of_solids_is_the_linear_clearance() {
    let any = |random: &mut Random| {
        let far = random.pick(&[0.5, 2.0, 5.0]);
        Pose::new(random.rotation(), random.direction() * far).expect("a pose")
    };
    let [counts @ .., unproven] = slides(any, |random| random.vector() * 8.0, 1e-9);
    assert!(counts.iter().all(|count| *count > 15) && unproven == 0, "{counts:?} {unproven}");
}

#[test]
fn a_slide_of_solids_that_touch_is_the_linear_clearance() {
    let [counts @ .., unproven] = slides(tied, way, 1e-9);
    assert!(counts.iter().all(|count| *count > 15) && unproven < 20, "{counts:?} {unproven}");
}

#[test]
fn a_slide_of_convex_bodies_is_the_linear_clearance() {
    let mut counts = [0; 3];
    let boxes = [cuboid([0.0; 3], [3.0, 1.0, 1.0]), cuboid([-1.0; 3], [1.0; 3])];
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let is_tied = random.one_in(2);
        let hulls = [hull(12, &mut random), hull(8, &mut random)];
        let [p, q] = if is_tied { boxes.each_ref() } else { hulls.each_ref() };
        let (a, b, by) = if is_tied {
            (tied(&mut random), tied(&mut random), way(&mut random))
        } else {
            let [a, b] = [3.0, 0.5]
                .map(|far| Pose::new(random.rotation(), random.direction() * far).expect("a pose"));
            (a, b, random.vector() * 6.0)
        };
        let slide = Motion::slide(a, by).expect("a motion");
        let cast = MotionCast::new(p.along(&slide), q.at(b)).expect("a cast");
        let clearance = cast.clearance().expect("an answer");
        let straight = Cast::new(p.at(a), q.at(b), by).expect("a cast").clearance();
        let straight = match straight.expect("an answer") {
            Clearance::Blocked { contact, .. } => {
                let bounds = contact.bounded().bounds().map(|t| t.max(0.0));
                Told::Blocked(bounds, bounds)
            }
            Clearance::Free(_) => Told::Free,
            Clearance::Overlapping(_) => Told::Overlapping,
        };
        let turning = told(&clearance);
        // Rounding alone is tolerated, closed no faster than by a thousandth of the way.
        assert!(agree(straight, turning, 1e-9), "{seed}: {straight:?} {turning:?}");
        if let MotionClearance::Blocked { contact, .. } = &clearance {
            let asked = cast.clone().tolerating(contact.tolerance).expect("a tolerance");
            let [lower, upper] = asked.verify(&contact.shrunk.proof).expect("a proof");
            assert_eq!([lower, upper], [contact.shrunk.lower, contact.shrunk.upper]);
        }
        // As solids, and one of each kind, they are answered the same.
        let rest = Motion::still(b);
        let mixed = MotionCast::between(p.along(&slide), q.along(&rest)).expect("a cast");
        let mixed = told(&mixed.clearance().expect("an answer"));
        assert!(agree(mixed, turning, 1e-9), "{seed}: {mixed:?} {turning:?}");
        counts[match turning {
            Told::Blocked(..) => 0,
            Told::Free => 1,
            Told::Overlapping => 2,
        }] += 1;
    }
    assert!(counts.iter().all(|count| *count > 30), "{counts:?}");
}

#[test]
fn what_stops_a_door_is_told_in_its_true_place() {
    // As in `solids_motion.rs`: the corner (1, 1/8) of a door meets the stop's face y = 1/2 at
    // sin a + cos a / 8 = 1/2; smaller by 0.01 all around, (0.99, 0.115) meets y = 0.51.
    let door = solid(&block([0.0, -0.125, 0.0], [1.0, 0.125, 2.0]));
    let frame = solid(
        &block([0.5, 0.5, -0.5], [1.5, 1.0, 2.5])
            .joined(&block([-0.5, -0.5, -1.5], [1.5, 1.0, -1.0])),
    );
    let swing = Motion::turn(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, FRAC_PI_2).expect("a motion");
    let rest = Motion::still(Pose::IDENTITY);
    let cast = MotionCast::new(door.along(&swing), frame.along(&rest)).expect("a cast");
    let cast = cast.tolerating(0.02).expect("a tolerance");
    let Told::Blocked(place, shrunk) = told(&cast.clearance().expect("an answer")) else {
        panic!("the door is stopped")
    };
    let expected = |x: f64, y: f64, face: f64| {
        let (r, phase) = (x.hypot(y), (y / x).atan());
        ((face / r).asin() - phase) / FRAC_PI_2
    };
    for ([lower, upper], expected) in
        [(place, expected(1.0, 0.125, 0.5)), (shrunk, expected(0.99, 0.115, 0.51))]
    {
        assert!(lower < expected + 1e-14 && expected < upper + 1e-14, "{lower} {upper} {expected}");
        assert!(upper - lower < 1e-11, "{:e}", upper - lower);
    }
    // The shrunk bounds are those of the first contact, whose proof holds.
    let outcome = cast.certified_first_contact().expect("an answer");
    let [lower, upper] = cast.verify(outcome.proof()).expect("a proof");
    assert!(lower <= shrunk[1] && shrunk[0] <= upper);
}

#[test]
fn what_rests_convex_turns_slides_and_is_stopped() {
    let (brick, table) = (cuboid([0.0; 3], [1.0; 3]), cuboid([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0]));
    let here = Pose::IDENTITY;
    let motions = [
        (true, Motion::turn(here, DVec3::new(0.3, 0.2, 0.0), DVec3::Z, 6.0)),
        (true, Motion::slide(here, DVec3::X)),
        (true, Motion::screw(here, DVec3::ZERO, DVec3::Z, 3.0, 1.0)),
        (true, Motion::turn(here, DVec3::X, DVec3::Y, 1.0)),
        (false, Motion::screw(here, DVec3::ZERO, DVec3::Z, 1.0, -1.0)),
        (false, Motion::turn(here, DVec3::new(0.5, 0.0, 0.0), DVec3::Y, 1.0)),
    ];
    for (is_free, motion) in motions {
        let motion = motion.expect("a motion");
        let cast = MotionCast::new(brick.along(&motion), table.at(here)).expect("a cast");
        match cast.clearance().expect("an answer") {
            MotionClearance::Free(_) => assert!(is_free),
            MotionClearance::Blocked { time, contact } => {
                assert!(!is_free && time == 0.0 && contact.shrunk.lower < 1e-11, "{contact:?}");
            }
            other @ MotionClearance::Overlapping(_) => panic!("{other:?}"),
        }
    }
    // It slides, is pushed in at the half, and meets the table there: not where it has lain all the time.
    let poses = [here, at(1.0, 0.0, 0.0), at(1.0, 0.0, -1.0)];
    let pushed = Motion::through(&poses).expect("a motion");
    let cast = MotionCast::new(brick.along(&pushed), table.at(here)).expect("a cast");
    let Told::Blocked(place, _) = told(&cast.clearance().expect("an answer")) else {
        panic!("it is pushed in")
    };
    assert!((place[0] - 0.5).abs() < 1e-11 && (place[1] - 0.5).abs() < 1e-11, "{place:?}");
    // Sunk in by more than rounding, by an eighth.
    let sunk = Motion::slide(at(0.0, 0.0, -0.125), DVec3::X).expect("a motion");
    let cast = MotionCast::new(brick.along(&sunk), table.at(here)).expect("a cast");
    let MotionClearance::Overlapping(found) = cast.clearance().expect("an answer") else {
        panic!("it overlaps")
    };
    assert!((found.least_tolerance.expect("a depth") - 0.125).abs() < 1e-12, "{found:?}");
    let cast = cast.tolerating(0.126).expect("a tolerance");
    assert!(cast.clearance().expect("an answer").is_free());
    // Nearer than a gap, by 0.05.
    let above = Motion::slide(at(0.0, 0.0, 0.25), DVec3::X).expect("a motion");
    let cast = MotionCast::new(brick.along(&above), table.at(here)).expect("a cast");
    assert!(cast.clone().keeping(0.25).expect("a gap").clearance().expect("an answer").is_free());
    let near = cast.keeping(0.3).expect("a gap").clearance().expect("an answer");
    let MotionClearance::Overlapping(found) = near else { panic!("it is too near") };
    assert!((found.least_tolerance.expect("a depth") - 0.05).abs() < 1e-12, "{found:?}");
}

#[test]
fn what_overlaps_at_the_start_may_be_ignored() {
    // A blade is pressed 1/8 into a table along the x axis, and is turned out of it about that axis, upwards by 2
    // radians: free, unless a shelf above is in the way, which its far edge meets.
    let blade = solid(&block([-1.0, 0.0, -0.125], [1.0, 2.0, 0.25]));
    let table = block([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0]);
    let shelf = block([-4.0, 0.0, 1.5], [4.0, 3.0, 2.0]);
    let out = Motion::turn(Pose::IDENTITY, DVec3::ZERO, DVec3::X, 1.5).expect("a motion");
    let rest = Motion::still(Pose::IDENTITY);
    let asked = |scene: &Solid| {
        let cast = MotionCast::new(blade.along(&out), scene.along(&rest)).expect("a cast");
        let MotionClearance::Overlapping(found) = cast.clearance().expect("an answer") else {
            panic!("it overlaps")
        };
        let ignoring = cast.with_start_overlap(StartOverlap::Ignore);
        let ignored = ignoring.start_overlap().expect("an answer").expect("an overlap");
        assert_eq!(found, ignored);
        assert!((found.least_tolerance.expect("a tolerance") - 0.125).abs() < 1e-9, "{found:?}");
        told(&ignoring.clearance().expect("an answer"))
    };
    // Its lower edge at y = 0 goes down and on through the table: it crosses that from the start on.
    assert_eq!(asked(&solid(&table)), Told::Free);
    let Told::Blocked(place, shrunk) = asked(&solid(&table.joined(&shelf))) else {
        panic!("the shelf is in the way")
    };
    // The edge (2, 1/4) comes up to z = 3/2.
    let (r, phase) = (2.0_f64.hypot(0.25), (0.125_f64).atan());
    let expected = ((1.5 / r).asin() - phase) / 1.5;
    for [lower, upper] in [place, shrunk] {
        assert!(lower < expected + 1e-10 && expected < upper + 1e-10, "{lower} {upper} {expected}");
        assert!(upper - lower < 1e-10);
    }
}

#[test]
fn what_is_inside_may_come_out_and_not_in_again() {
    // A ball in the wall of a ring, none of whose facets it crosses, leaves it, goes on and meets it again.
    let ring = solid(&washer([1.0, 3.0], [-0.5, 0.5], 24));
    let ball = solid(&block([1.75, -0.125, -0.125], [2.0, 0.125, 0.125]));
    let rest = Motion::still(Pose::IDENTITY);
    // About an axis far away, along y: up out of the upper face, around, and down again.
    let over = Motion::turn(Pose::IDENTITY, DVec3::new(0.0, 0.0, 0.0), DVec3::NEG_Y, 2.0 * PI);
    let over = over.expect("a motion");
    let cast = MotionCast::new(ball.along(&over), ring.along(&rest)).expect("a cast");
    assert_eq!(told(&cast.clearance().expect("an answer")), Told::Overlapping);
    let outcome = cast.first_contact().expect("an answer");
    assert!(matches!(outcome, MotionOutcome::Overlapping(_)));
    let cast = cast.with_start_overlap(StartOverlap::Ignore);
    let Told::Blocked(place, _) = told(&cast.clearance().expect("an answer")) else {
        panic!("it comes back")
    };
    // Its corner (2, -1/8), seen along y, comes down to z = 1/2 on the other side: at z = r sin(a + p).
    let (r, phase) = (2.0_f64.hypot(0.125), (-0.0625_f64).atan());
    let high = [1.75_f64.hypot(0.125), (0.125_f64 / 1.75).atan()];
    let down = |[r, phase]: [f64; 2]| (PI - (0.5 / r).asin() - phase) / (2.0 * PI);
    let expected = down([r, phase]).min(down(high));
    assert!(place[0] < expected + 1e-9 && expected < place[1] + 1e-9, "{place:?} {expected}");
}

#[test]
fn a_pin_pressed_into_its_hole_is_pulled_out_by_a_screw() {
    // The pin is larger than the hole by 0.01 all around, and has a head above; it is unscrewed, or screwed in until
    // the head is on the ring, 0.5 below.
    let ring = solid(&washer([1.0, 3.0], [-0.5, 0.5], 24));
    let stud = pin(1.01, [-1.0, 1.0], 24).joined(&pin(2.0, [1.0, 1.5], 24));
    let stud = solid(&stud);
    let rest = Motion::still(Pose::IDENTITY);
    let asked = |rise: f64| {
        let screw = Motion::screw(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 0.0, rise);
        let screw = screw.expect("a motion");
        let cast = MotionCast::new(stud.along(&screw), ring.along(&rest)).expect("a cast");
        told(&cast.with_start_overlap(StartOverlap::Ignore).clearance().expect("an answer"))
    };
    assert_eq!(asked(3.0), Told::Free);
    let Told::Blocked(place, _) = asked(-2.0) else { panic!("the head stops it") };
    assert!((place[0] - 0.25).abs() < 1e-11, "{place:?}");
}
