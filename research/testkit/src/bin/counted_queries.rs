//! `counted_queries`: answers named queries, each in one call of [`counted`], so that callgrind counts the
//! instructions of each.
//!
//! `.ci/instructions.py` runs it and compares the counts with `docs/measurements/`. A query is a number of calls with
//! different settings. It is answered once before it is counted, so that data that bodies compute on first use are
//! not part of it. Settings are random, with fixed seeds.

use std::hint::black_box;
use std::sync::Arc;

use colltrans::motion::{Motion, MotionCast};
use colltrans::removal::directions::{FreeDirections, FreeOptions};
use colltrans::{
    Cast, ConvexPolyhedron, FixedRotations, Obstacles, Options, Outcome, Pair, Pose, SceneQuery,
    Solid, Solver, Tracker, cta,
};
use colltrans_testkit::bodies::{at_xyz, body, centered, cube, hull, solid};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{prism, random_hull, ring_sphere};
use colltrans_testkit::solids::{bumpy_ball, comb, pin, washer};
use glam::DVec3;

/// A query by name.
type Named = (&'static str, Box<dyn FnMut()>);

/// A placement of two bodies, and a direction.
#[derive(Clone, Copy)]
struct Setting {
    moving: Pose,
    fixed: Pose,
    direction: DVec3,
}

fn main() {
    let mut queries = casts();
    queries.extend(distances());
    queries.extend(builds());
    queries.extend(solids());
    queries.extend(motions());
    queries.extend(several());
    for (name, query) in &mut queries {
        query();
        counted(query);
        println!("{name}");
    }
}

/// Answers a query. Callgrind counts the instructions of this function.
#[inline(never)]
fn counted(query: &mut dyn FnMut()) {
    query();
}

/// Draws settings at a distance of centres of `far`. Lines along the directions pass the fixed centre within `aside`.
fn draw_settings(count: usize, [far, aside]: [f64; 2]) -> Vec<Setting> {
    let mut random = Random::new(count as u64);
    let mut draw = || {
        let direction = random.direction();
        let beside = random.direction().reject_from_normalized(direction).normalize() * aside;
        let pose = |rotation, at| Pose::new(rotation, at).expect("in range");
        let moving = pose(random.rotation(), beside * random.range(0.1, 1.0) - direction * far);
        Setting { moving, fixed: pose(random.rotation(), DVec3::ZERO), direction }
    };
    (0..count).map(|_| draw()).collect()
}

/// Returns a query that asks for every setting.
fn for_settings<B: 'static>(
    name: &'static str,
    bodies: [B; 2],
    settings: Vec<Setting>,
    ask: impl Fn(&[B; 2], &Setting) + 'static,
) -> Named {
    (name, Box::new(move || settings.iter().for_each(|setting| ask(&bodies, black_box(setting)))))
}

fn rings(around: u32, rings: u32) -> [ConvexPolyhedron; 2] {
    [(); 2].map(|()| body(&ring_sphere(around, rings).vertices))
}

fn hulls(n: usize) -> [ConvexPolyhedron; 2] {
    let mut random = Random::new(n as u64);
    [(); 2].map(|()| hull(n, &mut random))
}

/// Returns a query about casts of convex bodies that meet.
fn casting(
    name: &'static str,
    bodies: [ConvexPolyhedron; 2],
    ask: impl Fn(&Cast<'_>) + 'static,
) -> Named {
    for_settings(name, bodies, draw_settings(40, [3.0, 0.7]), move |bodies, setting| {
        ask(&place(bodies, setting));
    })
}

fn place<'a>([p, q]: &'a [ConvexPolyhedron; 2], of: &Setting) -> Cast<'a> {
    Cast::new(p.at(of.moving), q.at(of.fixed), of.direction).expect("in range")
}

fn casts() -> Vec<Named> {
    let first = |cast: &Cast<'_>| drop(black_box(cast.first_contact()));
    let missing = |bodies: &[ConvexPolyhedron; 2], setting: &Setting| {
        black_box(place(bodies, setting).first_contact()).expect("an answer");
    };
    let cta = cta::Options::new(cta::Start::Center, cta::Until::Exit);
    let cta = Options::default().with_solver(Solver::Cta).with_narrowing(cta);
    let rounded = rings(6, 5).map(|body| body.rounded(0.25).expect("a radius"));
    vec![
        casting("cast_ring_8", rings(3, 2), first),
        casting("cast_ring_32", rings(6, 5), first),
        casting("cast_ring_128", rings(11, 11), first),
        casting("cast_ring_2000", rings(45, 44), first),
        casting("cast_hull_8", hulls(8), first),
        casting("cast_hull_128", hulls(128), first),
        casting("cast_hull_2000", hulls(2000), first),
        casting("cast_cubes", [cube(), cube()], first),
        casting("cast_prism_128", [(); 2].map(|()| body(&prism(64, 1.0).vertices)), first),
        for_settings("miss_ring_128", rings(11, 11), draw_settings(40, [4.0, 9.0]), missing),
        casting("range_ring_128", rings(11, 11), |cast| drop(black_box(cast.contact_range()))),
        casting("clearance_ring_128", rings(11, 11), |cast| drop(black_box(cast.clearance()))),
        casting("verify_ring_128", rings(11, 11), |cast| {
            if let Ok(Outcome::Contact(contact)) = cast.first_contact() {
                black_box(cast.verify(&contact.certificate)).expect("a proof");
            }
        }),
        casting("cta_ring_128", rings(11, 11), move |cast| {
            let cast = cast.with_options(cta).expect("options");
            drop(black_box(cast.first_contact()));
        }),
        casting("min_gap_ring_32", rings(6, 5), |cast| {
            drop(black_box(cast.with_min_gap(0.125).expect("a gap").first_contact()));
        }),
        casting("rounded_ring_32", rounded, first),
        casting("cast_spheres", [sphere(), sphere()], first),
        tracking("tracked_ring_128", rings(11, 11)),
        tracking("tracked_ring_2000", rings(45, 44)),
        fixed_rotations("faces_hull_8", hulls(8), false),
        fixed_rotations("map_hull_8", hulls(8), true),
    ]
}

/// Returns a query that tracks casts of slightly changed directions.
fn tracking(name: &'static str, bodies: [ConvexPolyhedron; 2]) -> Named {
    let mut setting = draw_settings(1, [3.0, 0.7])[0];
    let steps = draw_settings(100, [3.0, 0.7]);
    let path: Vec<Setting> = steps
        .iter()
        .map(|step| {
            setting.direction = (setting.direction + step.direction * 0.01).normalize();
            setting
        })
        .collect();
    let query = move || {
        let mut tracker = Tracker::new();
        for setting in &path {
            drop(black_box(tracker.first_contact(&place(&bodies, setting))));
        }
    };
    (name, Box::new(query))
}

/// Returns a query about casts with fixed rotations, along one direction or along several.
fn fixed_rotations(name: &'static str, bodies: [ConvexPolyhedron; 2], along_one: bool) -> Named {
    let settings = draw_settings(200, [3.0, 0.7]);
    let query = move || {
        let [p, q] = &bodies;
        let rotations = FixedRotations::new(p.at(Pose::IDENTITY), q.at(Pose::IDENTITY));
        let map = rotations.for_direction(DVec3::X).expect("a direction");
        for setting in &settings {
            let direction = if along_one { DVec3::X } else { setting.direction };
            let moving = Pose::from_translation(setting.moving.translation()).expect("in range");
            let cast = Cast::new(p.at(moving), q.at(Pose::IDENTITY), direction).expect("in range");
            drop(black_box(if along_one {
                map.first_contact(&cast)
            } else {
                rotations.first_contact(&cast)
            }));
        }
    };
    (name, Box::new(query))
}

/// Returns a query about pairs of convex bodies with centres at a distance.
fn pairing(
    name: &'static str,
    bodies: [ConvexPolyhedron; 2],
    far: f64,
    ask: impl Fn(&Pair<'_>) + 'static,
) -> Named {
    for_settings(name, bodies, draw_settings(40, [far, 0.3]), move |[p, q], setting| {
        ask(&Pair::new(p.at(setting.moving), q.at(setting.fixed)).expect("in range"));
    })
}

fn sphere() -> ConvexPolyhedron {
    ConvexPolyhedron::sphere(DVec3::ZERO, 0.5).expect("a sphere")
}

fn distances() -> Vec<Named> {
    let distance = |pair: &Pair<'_>| drop(black_box(pair.distance()));
    let rounded = hulls(32).map(|body| body.rounded(0.25).expect("a radius"));
    let capsule = ConvexPolyhedron::capsule([DVec3::NEG_X, DVec3::X], 0.25).expect("a capsule");
    let [hull, _] = hulls(32);
    vec![
        pairing("distance_spheres", [sphere(), sphere()], 3.0, distance),
        pairing("distance_sphere_capsule", [sphere(), capsule.clone()], 3.0, distance),
        pairing("distance_capsules", [capsule.clone(), capsule], 3.0, distance),
        pairing("distance_sphere_box", [sphere(), centered([0.5, 0.75, 1.0])], 3.0, distance),
        pairing("distance_sphere_hull_32", [sphere(), hull], 3.0, distance),
        pairing("distance_hull_8", hulls(8), 3.0, distance),
        pairing("distance_hull_32", hulls(32), 3.0, distance),
        pairing("distance_hull_128", hulls(128), 3.0, distance),
        pairing("distance_hull_2000", hulls(2000), 3.0, distance),
        pairing("distance_rounded_hull_32", rounded, 3.0, distance),
        pairing("within_hull_32", hulls(32), 3.0, |pair| drop(black_box(pair.within(1.0)))),
        pairing("depth_hull_32", hulls(32), 0.5, |pair| drop(black_box(pair.depth()))),
    ]
}

fn builds() -> Vec<Named> {
    let build = |name, n: usize| -> Named {
        let points = random_hull(n, &mut Random::new(n as u64)).vertices;
        (name, Box::new(move || drop(black_box(ConvexPolyhedron::from_points(&points)))))
    };
    let mesh = bumpy_ball(2000);
    vec![
        build("build_hull_32", 32),
        build("build_hull_500", 500),
        ("build_solid_2000", Box::new(move || drop(black_box(solid(&mesh))))),
    ]
}

/// Returns a query about casts of solids that meet.
fn casting_solids(name: &'static str, bodies: [Solid; 2], far: f64) -> Named {
    for_settings(name, bodies, draw_settings(10, [far, 0.7]), |[p, q], of| {
        let cast = Cast::new(p.at(of.moving), q.at(of.fixed), of.direction).expect("in range");
        drop(black_box(cast.clearance()));
    })
}

/// Returns a query about distances of solids.
fn pairing_solids(name: &'static str, bodies: [Solid; 2], far: f64) -> Named {
    for_settings(name, bodies, draw_settings(10, [far, 0.7]), |[p, q], of| {
        let pair = Pair::new(p.at(of.moving), q.at(of.fixed)).expect("in range");
        drop(black_box(pair.distance()));
    })
}

fn solids() -> Vec<Named> {
    let balls = || [(); 2].map(|()| solid(&bumpy_ball(2000)));
    let convex = || hulls(32).map(|body| Solid::from_convex(&body).expect("a solid"));
    vec![
        casting_solids("solid_cast_balls_2000", balls(), 3.0),
        casting_solids("solid_cast_combs", [(); 2].map(|()| solid(&comb(8))), 20.0),
        casting_solids("solid_cast_hull_32", convex(), 3.0),
        pairing_solids("solid_distance_balls_2000", balls(), 3.0),
        pairing_solids("solid_distance_hull_32", convex(), 3.0),
    ]
}

/// Returns the motion of a setting: along the direction, with a rotation.
fn flight(of: &Setting) -> Motion {
    let (center, spin) = (of.moving.translation(), DVec3::new(0.4, -0.9, 1.1));
    Motion::free_flight(of.moving, center, of.direction * 4.0, spin).expect("a motion")
}

fn motions() -> Vec<Named> {
    let moving = |name, bodies: [ConvexPolyhedron; 2], is_clearance: bool| {
        for_settings(name, bodies, draw_settings(10, [3.0, 0.5]), move |[p, q], setting| {
            let (motion, rest) = (flight(setting), Motion::at_rest(setting.fixed));
            let cast = MotionCast::new(p.with_motion(&motion), q.with_motion(&rest));
            let cast = cast.expect("in range");
            if is_clearance {
                drop(black_box(cast.clearance()));
            } else {
                drop(black_box(cast.first_contact()));
            }
        })
    };
    let balls = [(); 2].map(|()| solid(&bumpy_ball(2000)));
    vec![
        moving("motion_hull_8", hulls(8), false),
        moving("motion_hull_128", hulls(128), false),
        moving("motion_clearance_hull_32", hulls(32), true),
        for_settings("motion_balls_2000", balls, draw_settings(5, [3.0, 0.5]), |[p, q], of| {
            let (motion, rest) = (flight(of), Motion::at_rest(of.fixed));
            let cast = MotionCast::new(p.with_motion(&motion), q.with_motion(&rest));
            drop(black_box(cast.expect("in range").first_contact()));
        }),
    ]
}

/// Returns queries about many bodies, and about removal.
fn several() -> Vec<Named> {
    let mut obstacles = Obstacles::new();
    let body = Arc::new(hulls(32)[0].clone());
    obstacles.insert_all((0..100).map(|k| {
        let [x, y, z] = [k % 5, k / 5 % 5, k / 25].map(|c| 4.0 * f64::from(c));
        (Arc::clone(&body), at_xyz(x, y, z))
    }));
    let settings = draw_settings(40, [5.0, 4.0]);
    let scene = move || {
        for setting in &settings {
            let query = SceneQuery::new(body.at(setting.moving), &obstacles).expect("a query");
            drop(black_box(query.nearest()));
        }
    };
    let [part, plate] =
        [solid(&pin(0.9, [-1.0, 1.0], 12)), solid(&washer([1.0, 2.0], [-0.5, 0.5], 12))];
    let removal = move || {
        let placed = [&part, &plate].map(|of| of.at(Pose::IDENTITY));
        let [moving, fixed] = &placed;
        drop(black_box(FreeDirections::compute(moving, fixed, FreeOptions::default())));
    };
    vec![("scene_nearest_100", Box::new(scene)), ("removal_pin_washer", Box::new(removal))]
}
