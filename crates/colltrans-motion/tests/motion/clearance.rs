//! Clearance of motions: translations against linear casts, with tolerances and overlaps at the start; closed forms of
//! rotations.

use std::f64::consts::{FRAC_PI_2, PI};

use colltrans_convex::{Cast, Clearance, Pose};
use colltrans_motion::{Motion, MotionCast, MotionClearance, MotionOutcome, MotionStop};
use colltrans_solid::{Solid, SolidCast, StartOverlap};
use colltrans_testkit::bodies::{at_xyz as at, block as cuboid, hull, solid};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::block;
use colltrans_testkit::solids::{pin, washer};
use glam::{DMat3, DVec3};

/// Returns a random pose on a coarse grid, rotated by quarter turns.
fn grid_pose(random: &mut Random) -> Pose {
    let quarter = DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z);
    let turn = (0..random.index(4)).fold(DMat3::IDENTITY, |turn, _| quarter * turn);
    let place = [(); 3].map(|()| random.pick(&[-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0]));
    Pose::from_matrix(turn, place.into()).expect("a pose")
}

/// Returns a random displacement on a coarse grid.
fn grid_displacement(random: &mut Random) -> DVec3 {
    loop {
        let grid_displacement =
            DVec3::from_array([(); 3].map(|()| random.pick(&[-4.0, 0.0, 0.0, 2.0, 5.0])));
        if grid_displacement != DVec3::ZERO {
            return grid_displacement;
        }
    }
}

/// Summary of an answer: the bounds of the times of the nominal and of the shrunk bodies, or the reason why there are
/// none.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ClearanceSummary {
    Blocked([f64; 2], [f64; 2]),
    Free,
    Overlapping,
}

fn summary_of<P>(clearance: &MotionClearance<P>) -> ClearanceSummary {
    match clearance {
        MotionClearance::Blocked { time, contact } => {
            let MotionStop { time: place, shrunk, .. } = &**contact;
            assert!(*time <= place.lower && *time <= shrunk.lower && *time >= 0.0);
            assert!(place.lower <= place.value && place.value <= place.upper, "{place:?}");
            ClearanceSummary::Blocked(place.bounds(), [shrunk.lower, shrunk.upper])
        }
        MotionClearance::Free(_) => ClearanceSummary::Free,
        MotionClearance::Overlapping(_) => ClearanceSummary::Overlapping,
    }
}

/// Checks whether two answers agree within a margin. A contact at the very end agrees with a free motion.
fn are_consistent(a: ClearanceSummary, b: ClearanceSummary, off: f64) -> bool {
    let late = |summary: ClearanceSummary| matches!(summary, ClearanceSummary::Blocked(_, [lower, _]) if lower > 1.0 - off);
    let meet = |x: [f64; 2], y: [f64; 2]| x[0] <= y[1] + off && y[0] <= x[1] + off;
    match (a, b) {
        (ClearanceSummary::Blocked(a, b), ClearanceSummary::Blocked(c, d)) => {
            meet(a, c) && meet(b, d)
        }
        _ => {
            a == b
                || (late(a) && b == ClearanceSummary::Free)
                || (late(b) && a == ClearanceSummary::Free)
        }
    }
}

/// Returns the summary of a linear cast.
fn linear_summary(cast: &Cast<Solid>) -> ClearanceSummary {
    match cast.clearance().expect("an answer") {
        Clearance::Blocked { contact, .. } => {
            let place = contact.translation.bounds().map(|t| t.max(0.0));
            ClearanceSummary::Blocked(place, contact.offset_distance.bounds())
        }
        Clearance::Free(_) => ClearanceSummary::Free,
        Clearance::Overlapping(_) => ClearanceSummary::Overlapping,
    }
}

/// Extrudes a counter-clockwise polygon in the plane z = 0 along z.
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

/// Compares translations as motions with casts, with tolerances and meanings of overlaps. Returns the numbers of
/// outcomes: blocked, free, overlapping, blocked after an ignored overlap, and blocked without a proven contact.
///
/// In the last case the cast may be free, if edges pass along edges, or facets along vertices that shrinking leaves in
/// place. The motion then stops too early, without an upper bound.
fn compare_translations_with_casts(
    poses: fn(&mut Random) -> Pose,
    by: fn(&mut Random) -> DVec3,
    off: f64,
) -> [u32; 5] {
    let (mut counts, bodies) = ([0; 5], bodies());
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let [p, q] = [(); 2].map(|()| &bodies[random.index(4)]);
        let (a, b, by) = (poses(&mut random), poses(&mut random), by(&mut random));
        let [slide, rest] = [Motion::translation(a, by).expect("a motion"), Motion::at_rest(b)];
        let mut cast =
            MotionCast::new(p.with_motion(&slide), q.with_motion(&rest)).expect("a cast");
        let ignores = random.one_in(2);
        // Powers of two offset axis-aligned faces exactly, so faces parallel to the motion remain parallel.
        if ignores || random.one_in(2) {
            let tolerance = random.pick(&[0.5_f64.powi(30), 0.5_f64.powi(7), 0.125]);
            cast = cast.with_tolerance(tolerance).expect("a tolerance");
        }
        let start = if ignores { StartOverlap::Ignore } else { StartOverlap::Refuse };
        let straight = Cast::new(p.at(a), q.at(b), by).expect("a cast");
        let straight = straight.with_tolerance(cast.tolerance()).expect("a tolerance");
        let overlaps = straight.overlaps();
        let straight = linear_summary(&straight.with_start_overlap(start));
        let turning = cast.with_start_overlap(start).clearance().expect("an answer");
        let turning = summary_of(&turning);
        if let ClearanceSummary::Blocked(_, [lower, f64::INFINITY]) = turning
            && !are_consistent(straight, turning, off)
        {
            let ClearanceSummary::Blocked(_, [_, upper]) = straight else {
                counts[4] += 1;
                continue;
            };
            assert!(lower < upper + off, "{seed}: {straight:?} {turning:?}");
            counts[4] += 1;
            continue;
        }
        assert!(
            are_consistent(straight, turning, off),
            "{seed} {ignores}: {straight:?} {turning:?}"
        );
        counts[match turning {
            ClearanceSummary::Blocked(..) if overlaps => 3,
            ClearanceSummary::Blocked(..) => 0,
            ClearanceSummary::Free => 1,
            ClearanceSummary::Overlapping => 2,
        }] += 1;
    }
    counts
}

#[test]
fn translated_solids_match_linear_clearance() {
    let any = |random: &mut Random| {
        let far = random.pick(&[0.5, 2.0, 5.0]);
        Pose::new(random.rotation(), random.direction() * far).expect("a pose")
    };
    let [counts @ .., unproven] =
        compare_translations_with_casts(any, |random| random.vector() * 8.0, 1e-9);
    assert!(counts.iter().all(|count| *count > 15) && unproven == 0, "{counts:?} {unproven}");
}

#[test]
fn translated_solids_in_contact_match_linear_clearance() {
    let [counts @ .., unproven] =
        compare_translations_with_casts(grid_pose, grid_displacement, 1e-9);
    assert!(counts.iter().all(|count| *count > 15) && unproven < 20, "{counts:?} {unproven}");
}

#[test]
fn translated_convex_bodies_match_linear_clearance() {
    let mut counts = [0; 3];
    let boxes = [cuboid([0.0; 3], [3.0, 1.0, 1.0]), cuboid([-1.0; 3], [1.0; 3])];
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let is_tied = random.one_in(2);
        let hulls = [hull(12, &mut random), hull(8, &mut random)];
        let [p, q] = if is_tied { boxes.each_ref() } else { hulls.each_ref() };
        let (a, b, by) = if is_tied {
            (grid_pose(&mut random), grid_pose(&mut random), grid_displacement(&mut random))
        } else {
            let [a, b] = [3.0, 0.5]
                .map(|far| Pose::new(random.rotation(), random.direction() * far).expect("a pose"));
            (a, b, random.vector() * 6.0)
        };
        let slide = Motion::translation(a, by).expect("a motion");
        let cast = MotionCast::new(p.with_motion(&slide), q.at(b)).expect("a cast");
        let clearance = cast.clearance().expect("an answer");
        let straight = Cast::new(p.at(a), q.at(b), by).expect("a cast").clearance();
        let straight = match straight.expect("an answer") {
            Clearance::Blocked { contact, .. } => {
                let bounds = contact.bounded().bounds().map(|t| t.max(0.0));
                ClearanceSummary::Blocked(bounds, bounds)
            }
            Clearance::Free(_) => ClearanceSummary::Free,
            Clearance::Overlapping(_) => ClearanceSummary::Overlapping,
        };
        let turning = summary_of(&clearance);
        // The default tolerance covers rounding errors only.
        assert!(are_consistent(straight, turning, 1e-9), "{seed}: {straight:?} {turning:?}");
        if let MotionClearance::Blocked { contact, .. } = &clearance {
            let query = cast.clone().with_tolerance(contact.tolerance).expect("a tolerance");
            let [lower, upper] = query.verify(&contact.shrunk.proof).expect("a proof");
            assert_eq!([lower, upper], [contact.shrunk.lower, contact.shrunk.upper]);
        }
        // The answer is the same for the bodies as solids.
        let rest = Motion::at_rest(b);
        let mixed =
            MotionCast::between_any(p.with_motion(&slide), q.with_motion(&rest)).expect("a cast");
        let mixed = summary_of(&mixed.clearance().expect("an answer"));
        assert!(are_consistent(mixed, turning, 1e-9), "{seed}: {mixed:?} {turning:?}");
        counts[match turning {
            ClearanceSummary::Blocked(..) => 0,
            ClearanceSummary::Free => 1,
            ClearanceSummary::Overlapping => 2,
        }] += 1;
    }
    assert!(counts.iter().all(|count| *count > 30), "{counts:?}");
}

#[test]
fn door_is_blocked_at_nominal_and_shrunk_closed_form_times() {
    // As in `solids.rs`, the corner (1, 1/8) of a door meets the face y = 1/2 of the stop at sin a + cos a / 8 = 1/2.
    // Shrunk by 0.01, the corner (0.99, 0.115) meets y = 0.51.
    let door = solid(&block([0.0, -0.125, 0.0], [1.0, 0.125, 2.0]));
    let frame = solid(
        &block([0.5, 0.5, -0.5], [1.5, 1.0, 2.5])
            .joined(&block([-0.5, -0.5, -1.5], [1.5, 1.0, -1.0])),
    );
    let swing =
        Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, FRAC_PI_2).expect("a motion");
    let rest = Motion::at_rest(Pose::IDENTITY);
    let cast = MotionCast::new(door.with_motion(&swing), frame.with_motion(&rest)).expect("a cast");
    let cast = cast.with_tolerance(0.02).expect("a tolerance");
    let ClearanceSummary::Blocked(place, shrunk) =
        summary_of(&cast.clearance().expect("an answer"))
    else {
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
fn resting_brick_may_rotate_and_slide_but_not_sink() {
    let (brick, table) = (cuboid([0.0; 3], [1.0; 3]), cuboid([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0]));
    let here = Pose::IDENTITY;
    let motions = [
        (true, Motion::rotation_about(here, DVec3::new(0.3, 0.2, 0.0), DVec3::Z, 6.0)),
        (true, Motion::translation(here, DVec3::X)),
        (true, Motion::screw(here, DVec3::ZERO, DVec3::Z, 3.0, 1.0)),
        (true, Motion::rotation_about(here, DVec3::X, DVec3::Y, 1.0)),
        (false, Motion::screw(here, DVec3::ZERO, DVec3::Z, 1.0, -1.0)),
        (false, Motion::rotation_about(here, DVec3::new(0.5, 0.0, 0.0), DVec3::Y, 1.0)),
    ];
    for (is_free, motion) in motions {
        let motion = motion.expect("a motion");
        let cast = MotionCast::new(brick.with_motion(&motion), table.at(here)).expect("a cast");
        match cast.clearance().expect("an answer") {
            MotionClearance::Free(_) => assert!(is_free),
            MotionClearance::Blocked { time, contact } => {
                assert!(!is_free && time == 0.0 && contact.shrunk.lower < 1e-11, "{contact:?}");
            }
            other @ MotionClearance::Overlapping(_) => panic!("{other:?}"),
        }
    }
    // It slides, and is pushed into the table from the middle of the motion on. It is blocked there, not at the start.
    let poses = [here, at(1.0, 0.0, 0.0), at(1.0, 0.0, -1.0)];
    let pushed = Motion::through_poses(&poses).expect("a motion");
    let cast = MotionCast::new(brick.with_motion(&pushed), table.at(here)).expect("a cast");
    let ClearanceSummary::Blocked(place, _) = summary_of(&cast.clearance().expect("an answer"))
    else {
        panic!("it is pushed in")
    };
    assert!((place[0] - 0.5).abs() < 1e-11 && (place[1] - 0.5).abs() < 1e-11, "{place:?}");
    // An eighth deep in the table.
    let sunk = Motion::translation(at(0.0, 0.0, -0.125), DVec3::X).expect("a motion");
    let cast = MotionCast::new(brick.with_motion(&sunk), table.at(here)).expect("a cast");
    let MotionClearance::Overlapping(found) = cast.clearance().expect("an answer") else {
        panic!("it overlaps")
    };
    assert!((found.least_tolerance.expect("a depth") - 0.125).abs() < 1e-12, "{found:?}");
    let cast = cast.with_tolerance(0.126).expect("a tolerance");
    assert!(cast.clearance().expect("an answer").is_free());
    // Nearer than the gap by 0.05.
    let above = Motion::translation(at(0.0, 0.0, 0.25), DVec3::X).expect("a motion");
    let cast = MotionCast::new(brick.with_motion(&above), table.at(here)).expect("a cast");
    assert!(
        cast.clone().with_min_gap(0.25).expect("a gap").clearance().expect("an answer").is_free()
    );
    let near = cast.with_min_gap(0.3).expect("a gap").clearance().expect("an answer");
    let MotionClearance::Overlapping(found) = near else { panic!("it is too near") };
    assert!((found.least_tolerance.expect("a depth") - 0.05).abs() < 1e-12, "{found:?}");
}

#[test]
fn ignored_start_overlap_still_blocks_later_contacts() {
    // A blade is pressed 1/8 into a table and rotated out of it about the x axis. It is free unless its far edge meets
    // a shelf above.
    let blade = solid(&block([-1.0, 0.0, -0.125], [1.0, 2.0, 0.25]));
    let table = block([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0]);
    let shelf = block([-4.0, 0.0, 1.5], [4.0, 3.0, 2.0]);
    let out = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::X, 1.5).expect("a motion");
    let rest = Motion::at_rest(Pose::IDENTITY);
    let query = |scene: &Solid| {
        let cast =
            MotionCast::new(blade.with_motion(&out), scene.with_motion(&rest)).expect("a cast");
        let MotionClearance::Overlapping(found) = cast.clearance().expect("an answer") else {
            panic!("it overlaps")
        };
        let ignoring = cast.with_start_overlap(StartOverlap::Ignore);
        let ignored = ignoring.start_overlap().expect("an answer").expect("an overlap");
        assert_eq!(found, ignored);
        assert!((found.least_tolerance.expect("a tolerance") - 0.125).abs() < 1e-9, "{found:?}");
        summary_of(&ignoring.clearance().expect("an answer"))
    };
    // Its lower edge at y = 0 moves down through the table, which it crosses from the start on.
    assert_eq!(query(&solid(&table)), ClearanceSummary::Free);
    let ClearanceSummary::Blocked(place, shrunk) = query(&solid(&table.joined(&shelf))) else {
        panic!("the shelf is in the way")
    };
    // The edge (2, 1/4) reaches z = 3/2.
    let (r, phase) = (2.0_f64.hypot(0.25), (0.125_f64).atan());
    let expected = ((1.5 / r).asin() - phase) / 1.5;
    for [lower, upper] in [place, shrunk] {
        assert!(lower < expected + 1e-10 && expected < upper + 1e-10, "{lower} {upper} {expected}");
        assert!(upper - lower < 1e-10);
    }
}

#[test]
fn body_inside_solid_may_leave_but_not_enter_again() {
    // A block inside the material of a ring, which crosses no facet, leaves it and meets it again.
    let ring = solid(&washer([1.0, 3.0], [-0.5, 0.5], 24));
    let ball = solid(&block([1.75, -0.125, -0.125], [2.0, 0.125, 0.125]));
    let rest = Motion::at_rest(Pose::IDENTITY);
    // About the y axis: out of the upper face, around, and down again.
    let over =
        Motion::rotation_about(Pose::IDENTITY, DVec3::new(0.0, 0.0, 0.0), DVec3::NEG_Y, 2.0 * PI);
    let over = over.expect("a motion");
    let cast = MotionCast::new(ball.with_motion(&over), ring.with_motion(&rest)).expect("a cast");
    assert_eq!(summary_of(&cast.clearance().expect("an answer")), ClearanceSummary::Overlapping);
    let outcome = cast.first_contact().expect("an answer");
    assert!(matches!(outcome, MotionOutcome::Overlapping(_)));
    let cast = cast.with_start_overlap(StartOverlap::Ignore);
    let ClearanceSummary::Blocked(place, _) = summary_of(&cast.clearance().expect("an answer"))
    else {
        panic!("it comes back")
    };
    // Seen along y, its corner (2, -1/8) reaches z = 1/2 on the other side, with z = r sin(a + p).
    let (r, phase) = (2.0_f64.hypot(0.125), (-0.0625_f64).atan());
    let high = [1.75_f64.hypot(0.125), (0.125_f64 / 1.75).atan()];
    let down = |[r, phase]: [f64; 2]| (PI - (0.5 / r).asin() - phase) / (2.0 * PI);
    let expected = down([r, phase]).min(down(high));
    assert!(place[0] < expected + 1e-9 && expected < place[1] + 1e-9, "{place:?} {expected}");
}

#[test]
fn pressed_pin_may_be_pulled_out_but_its_head_blocks() {
    // The pin is larger than the hole by 0.01 and has a head. It is pulled out, or pushed in until the head meets the
    // ring, 0.5 below.
    let ring = solid(&washer([1.0, 3.0], [-0.5, 0.5], 24));
    let stud = pin(1.01, [-1.0, 1.0], 24).joined(&pin(2.0, [1.0, 1.5], 24));
    let stud = solid(&stud);
    let rest = Motion::at_rest(Pose::IDENTITY);
    let query = |rise: f64| {
        let screw = Motion::screw(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 0.0, rise);
        let screw = screw.expect("a motion");
        let cast =
            MotionCast::new(stud.with_motion(&screw), ring.with_motion(&rest)).expect("a cast");
        summary_of(&cast.with_start_overlap(StartOverlap::Ignore).clearance().expect("an answer"))
    };
    assert_eq!(query(3.0), ClearanceSummary::Free);
    let ClearanceSummary::Blocked(place, _) = query(-2.0) else { panic!("the head stops it") };
    assert!((place[0] - 0.25).abs() < 1e-11, "{place:?}");
}
