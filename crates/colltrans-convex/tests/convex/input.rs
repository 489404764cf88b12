//! Bounds hold for the points that bodies were made from, also where a hull leaves some of them out.

use colltrans::motion::{Motion, MotionCast, MotionOutcome};
use colltrans::{FixedRotations, Obstacles, SceneQuery};
use colltrans_convex::{Cast, ConvexPolyhedron, Outcome, Pair, Pose, Solver, Within};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::check::Judge;
use colltrans_testkit::oracle::distance::distance;
use colltrans_testkit::oracle::exact::{Dyadic, Ratio, Vector};
use colltrans_testkit::oracle::input;
use colltrans_testkit::random::Random;
use glam::DVec3;

/// Points of a thin plate far from the origin, `bulge` roundings of its place uneven: its rim, and more
/// points on the side toward the other plate (`sign`), near its face and near its edges.
fn plate(random: &mut Random, (center, size, thickness): Shape, sign: f64) -> Vec<DVec3> {
    let rounding = 0.5 * f64::EPSILON * center.abs().max_element();
    let bulge = random.range(0.0, 96.0) * rounding;
    let corner =
        |i: i64| DVec3::new([-1.0, 1.0][(i & 1) as usize], [-1.0, 1.0][(i >> 1) as usize], 0.0);
    let mut points: Vec<DVec3> = (0..4).map(|i| corner(i) * size).collect();
    points.extend((0..4).map(|i| corner(i) * size - DVec3::Z * (sign * thickness)));
    for _ in 0..random.int(1, 12) {
        let [x, y] = [0, 1].map(|_| [random.range(-1.0, 1.0), random.range(-1.0, 1.0).signum()]);
        let on_edge = random.index(3);
        let at = DVec3::new(x[usize::from(on_edge == 1)], y[usize::from(on_edge == 2)], 0.0) * size;
        points.push(at + DVec3::Z * (sign * bulge * random.unit()));
    }
    points.iter().map(|p| center + *p).collect()
}

type Shape = (DVec3, f64, f64);

/// Two plates that face each other across a gap.
fn facing(random: &mut Random) -> [Vec<DVec3>; 2] {
    let far = 10.0_f64.powf(random.range(3.0, 9.0));
    let size = far * 10.0_f64.powf(random.range(-4.0, 0.0));
    let thickness = size * 10.0_f64.powf(random.range(-9.0, -3.0));
    let gap = far * 10.0_f64.powf(random.range(-14.5, -3.0));
    let center = random.rotation() * DVec3::X * far;
    let there = center + DVec3::Z * gap;
    [plate(random, (center, size, thickness), 1.0), plate(random, (there, size, thickness), -1.0)]
}

fn exact(points: &[DVec3]) -> Vec<Vector> {
    points.iter().map(|p| Vector::new(*p)).collect()
}

fn square(x: f64) -> Ratio {
    Ratio::from_f64(x).times(&Ratio::from_f64(x))
}

#[test]
fn distances_of_thin_far_plates_enclose_those_of_the_points() {
    let (mut random, mut left_out, mut apart) = (Random::new(0x1_70_27), 0, 0);
    for case in 0..cases(1_500) {
        let points = facing(&mut random);
        let bodies = points.each_ref().map(|p| ConvexPolyhedron::from_points(p).expect("points"));
        points.iter().zip(&bodies).for_each(|(points, body)| {
            input::judge(points, body).expect("a hull");
        });
        left_out += u32::from(bodies.iter().any(|body| body.hull_error() > 0.0));
        let at = Pose::IDENTITY;
        let pair = Pair::new(bodies[0].at(at), bodies[1].at(at)).expect("a pair");
        let truth = distance(&exact(&points[0]), &exact(&points[1])).square;
        let found = pair.distance().expect("an answer");
        let [low, high] = found.bounds();
        let is = truth.sqrt_to_f64();
        assert!(square(low) <= truth, "{case}: lower {low:e} of {is:e}");
        assert!(square(high) >= truth, "{case}: upper {high:e} of {is:e}");
        apart += u32::from(low > 0.0);
        if let Within::Farther(plane) = pair.within(low * (1.0 - 1e-9)).expect("an answer") {
            assert!(square(plane.gap) <= truth, "{case}: a gap of {:e} of {is:e}", plane.gap);
        }
        let depth = pair.depth().expect("an answer");
        assert!(depth.upper > 0.0 || !truth.is_zero(), "{case}: they meet, and have no depth");
        let mut obstacles = Obstacles::new();
        obstacles.insert(bodies[1].clone(), at);
        let among = SceneQuery::new(bodies[0].at(at), &obstacles).expect("a scene");
        let near = among.nearest().expect("an answer").expect("there is one");
        assert!(square(near.lower) <= truth, "{case}: nearest, {:e} of {is:e}", near.lower);
    }
    assert!(left_out > cases(1_000) && apart > cases(500), "{left_out} {apart}");
}

/// Along directions across the plates and nearly so, by all solvers, and by the faces of `M`.
#[test]
fn casts_of_thin_far_plates_enclose_those_of_the_points() {
    let mut random = Random::new(0x_c457);
    let mut told = [0; 3];
    for case in 0..cases(400) {
        let points = facing(&mut random);
        let bodies = points.each_ref().map(|p| ConvexPolyhedron::from_points(p).expect("points"));
        let placed = bodies.each_ref().map(|body| body.at(Pose::IDENTITY));
        let tilt = random.direction() * 10.0_f64.powf(random.range(-12.0, -0.5));
        let sideways = random.index(3) == 0;
        let direction = if sideways { random.direction().with_z(0.0) } else { DVec3::Z } + tilt;
        let cast = Cast::new(placed[0], placed[1], direction).expect("a cast");
        let judge = Judge::new(cast).with_input(&points[0], &points[1]);
        let table = FixedRotations::new(placed[0], placed[1]);
        let mut answers = vec![("faces", table.first_contact(&cast))];
        for solver in [Solver::Portal, Solver::Cta] {
            answers.push(("search", cast.with_solver(solver).first_contact()));
        }
        for (by, answer) in answers {
            let answer = answer.unwrap_or_else(|e| panic!("{case} by {by}: {e}"));
            let right = judge.check(&answer).and_then(|_| judge.compare_with_oracle(&answer));
            right.unwrap_or_else(|e| panic!("{case} by {by}: {e}"));
            told[match answer {
                Outcome::Contact(_) => 0,
                Outcome::Grazing(_) => 1,
                Outcome::Separated(_) => 2,
            }] += 1;
        }
    }
    assert!(told[0] > cases(500) && told[1] >= cases(4) && told[2] > cases(50), "{told:?}");
}

/// A slide is a motion: it is free no farther than the points are.
#[test]
fn slides_of_thin_far_plates_stop_before_the_points_meet() {
    let mut random = Random::new(0x_51_1d_e5);
    let mut stopped = 0;
    for case in 0..cases(300) {
        let points = facing(&mut random);
        let bodies = points.each_ref().map(|p| ConvexPolyhedron::from_points(p).expect("points"));
        let truth = distance(&exact(&points[0]), &exact(&points[1])).square.sqrt_to_f64();
        let way = DVec3::Z * (4.0 * truth.max(1e-3));
        let slide = Motion::translation(Pose::IDENTITY, way).expect("a motion");
        let still = Motion::at_rest(Pose::IDENTITY);
        let cast = MotionCast::new(bodies[0].with_motion(&slide), bodies[1].with_motion(&still))
            .expect("a cast");
        let free = match cast.first_contact() {
            Ok(MotionOutcome::Contact(contact) | MotionOutcome::Grazing(contact)) => contact.lower,
            Ok(MotionOutcome::Overlapping(_)) | Err(_) => continue,
            Ok(_) => 1.0,
        };
        // At the time that is said to be free the points of both are no nearer than they are apart.
        let by = Vector::new(way).times(&Dyadic::new(free));
        let there: Vec<Vector> = exact(&points[0]).iter().map(|p| p.plus(&by)).collect();
        let left = distance(&there, &exact(&points[1]));
        assert!(free == 0.0 || !left.intersects(), "{case}: free up to {free:e}, and they meet");
        stopped += u32::from(free > 0.0);
    }
    assert!(stopped > cases(100), "{stopped}");
}
