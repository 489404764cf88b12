//! One body among many: reported obstacles, bounds and proofs for all families of scenes, counts of work, invalid
//! input.

use std::sync::Arc;

use colltrans_convex::{
    CertificateError, Clearance, ConvexPolyhedron, ObstacleId, Options, Pose, QueryError,
};
use colltrans_scene::{Obstacles, SceneQuery};
use colltrans_solid::{ByKind, Solid};
use colltrans_testkit::bodies::{at_xyz as at, block as cuboid};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::among::{FAMILIES, examine};
use colltrans_testkit::random::Random;
use colltrans_testkit::tally::Tally;
use glam::{DQuat, DVec3};

#[test]
fn all_families_match_queries_of_single_obstacles() {
    let mut tally = Tally::default();
    for family in FAMILIES {
        for seed in 0..cases(60) {
            examine(family, seed, &mut tally).unwrap_or_else(|e| panic!("{family}:{seed}: {e}"));
        }
    }
    let [stopped, tied, overlapped, refused] =
        ["stopped", "tied", "overlapped", "refused"].map(|name| tally.get(name));
    assert!([stopped, tied, overlapped].iter().all(|&n| n > cases(50)) && refused > cases(500));
}

/// Returns random rotations, one in each cell of a grid.
fn grid_poses(side: u32, random: &mut Random) -> Vec<Pose> {
    let cells = (0..side * side * side).map(|k| [k % side, k / side % side, k / side / side]);
    let poses_along_direction = cells.map(|cell| DVec3::from_array(cell.map(f64::from)));
    poses_along_direction.map(|at| Pose::new(random.rotation(), at).expect("a pose")).collect()
}

#[test]
fn error_names_obstacle_that_vanishes_with_tolerance() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let two_sides = Solid::from_mesh(&corners, &[[0, 1, 2], [0, 2, 1]]).expect("closed");
    let cube = Solid::from_convex(&cuboid(DVec3::ZERO, DVec3::ONE)).expect("a solid");
    let mut scene = Obstacles::new();
    scene.insert(cube.clone(), at(0.0, 0.0, 3.0));
    let thin = scene.insert(two_sides, at(0.0, 0.0, 7.0));
    // Rotated bodies have a positive default tolerance.
    let turned = |z: f64| {
        let pose = Pose::new(DQuat::from_rotation_z(0.5), DVec3::Z * z).expect("a pose");
        SceneQuery::new(cube.at(pose), &scene).expect("a solid")
    };
    let refused = turned(5.0).clearance(DVec3::Z).expect_err("nothing of it remains");
    let QueryError::Obstacle { obstacle, reason } = &refused else { panic!("{refused}") };
    assert_eq!(*obstacle, thin);
    assert!(matches!(**reason, QueryError::NothingLeft { which: "fixed", .. }), "{refused}");
    assert!(refused.to_string().starts_with("obstacle 1: the tolerance"), "{refused}");
    let stopped = turned(0.0).clearance(DVec3::Z).expect("only the first is queried");
    assert!(stopped.lower > 1.9 && stopped.steps.bodies == 1);
}

/// Offset bodies meet later than nominal ones, and the delay grows as facets become parallel to the direction.
#[test]
fn oblique_obstacle_stops_body_before_wall_behind_it() {
    let solid = |body: &ConvexPolyhedron| Solid::from_convex(body).expect("a solid");
    let cube = solid(&cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)));
    let wall = solid(&cuboid(DVec3::new(3.5, -9.0, -9.0), DVec3::new(4.0, 9.0, 9.0)));
    // Its upper side rises by one in ten. The lower front edge of the cube, at z = -0.5, meets it at x = 3.45.
    let corners = [[0.0, -0.845], [6.0, -0.245], [6.0, -2.0], [0.0, -2.0]];
    let points: Vec<DVec3> =
        corners.iter().flat_map(|[x, z]| [-1.0, 1.0].map(|y| DVec3::new(*x, y, *z))).collect();
    let ramp = solid(&ConvexPolyhedron::from_points(&points).expect("a body"));
    let mut scene = Obstacles::new();
    let [_, ramp] = [wall, ramp].map(|body| scene.insert(body, Pose::IDENTITY));
    let options = colltrans_solid::SolidOptions::default().with_tolerance(0.02);
    let query = SceneQuery::new(cube.at(Pose::IDENTITY), &scene).expect("solids");
    let query = query.with_solid_options(options);
    let found = query.clearance(DVec3::X).expect("an answer");
    assert_eq!(found.stop.map(|(id, _)| id), Some(ramp));
    assert!((found.lower - 2.95).abs() < 1e-9, "{}", found.lower);
    assert!((query.clearance_before(DVec3::X, 2.97).expect("an answer").lower - 2.95).abs() < 1e-9);
}

#[test]
fn queries_visit_few_boxes_after_moves() {
    let mut random = Random::new(11);
    let small = Arc::new(cuboid(DVec3::splat(-0.1), DVec3::splat(0.1)));
    let mut scene = Obstacles::new();
    let poses = grid_poses(22, &mut random);
    let ids = scene.insert_all(poses.iter().map(|pose| (small.clone(), *pose)));
    // Average numbers of visited boxes and queried bodies: for the nearest obstacle, those within 0.3, and a cast.
    let work = |scene: &Obstacles, random: &mut Random| {
        let (mut boxes, mut bodies) = ([0; 3], [0; 3]);
        for _ in 0..200 {
            let place = (random.vector() * 0.5 + DVec3::splat(0.5)) * 22.0;
            let pose = Pose::new(random.rotation(), place).expect("a pose");
            let query = SceneQuery::new(small.at(pose), scene).expect("boxes");
            let steps = [
                query.nearest().expect("an answer").expect("some").steps,
                query.within(0.3).expect("an answer").steps,
                query.clearance(random.direction()).expect("an answer").steps,
            ];
            for k in 0..3 {
                boxes[k] += steps[k].boxes;
                bodies[k] += steps[k].bodies;
            }
        }
        (boxes.map(|n| n / 200), bodies.map(|n| n / 200))
    };
    let (boxes, bodies) = work(&scene, &mut random);
    assert!(boxes.iter().all(|n| *n < 160), "{boxes:?}");
    assert!(bodies.iter().all(|n| *n < 6), "{bodies:?}");

    // All obstacles move twice, to poses of others with a small displacement.
    for round in 0..2 {
        for (k, id) in ids.iter().enumerate() {
            let pose = poses[(k * 7_919 + round) % poses.len()];
            scene
                .set_pose(*id, pose.translated_by(random.vector() * 0.2).expect("a pose"))
                .expect("there");
        }
    }
    let (moved, bodies) = work(&scene, &mut random);
    for k in 0..3 {
        assert!(moved[k] <= 2 * boxes[k], "{moved:?} after {boxes:?}");
    }
    assert!(bodies.iter().all(|n| *n < 6), "{bodies:?}");
}

#[test]
fn single_insertions_match_bulk_insertion() {
    let mut random = Random::new(5);
    let small = Arc::new(cuboid(DVec3::splat(-0.1), DVec3::splat(0.1)));
    let poses = grid_poses(12, &mut random);
    let mut all = Obstacles::new();
    all.insert_all(poses.iter().map(|pose| (small.clone(), *pose)));
    let mut slowly = Obstacles::new();
    for pose in &poses {
        slowly.insert(small.clone(), *pose);
    }
    assert_eq!(Arc::strong_count(&small), 1 + 2 * poses.len());
    let mut boxes = [0; 2];
    for _ in 0..200 {
        let place = random.vector() * 6.0 + DVec3::splat(6.0);
        let pose = Pose::new(random.rotation(), place).expect("a pose");
        let found = [&all, &slowly].map(|scene| {
            let query = SceneQuery::new(small.at(pose), scene).expect("boxes");
            query.nearest().expect("an answer").expect("some")
        });
        assert_eq!(found[0].obstacle, found[1].obstacle);
        assert_eq!(found[0].distance, found[1].distance);
        boxes = [0, 1].map(|k| boxes[k] + found[k].steps.boxes);
    }
    assert!(boxes[1] <= 2 * boxes[0], "{boxes:?}");
}

#[test]
fn first_inserted_of_equal_obstacles_is_reported() {
    let cube = Arc::new(cuboid(DVec3::ZERO, DVec3::ONE));
    let mut scene = Obstacles::new();
    let ids: Vec<_> =
        [3.0, -3.0, 3.0].into_iter().map(|x| scene.insert(cube.clone(), at(x, 0.0, 0.0))).collect();
    let nearest = |scene: &Obstacles| {
        let query = SceneQuery::new(cube.at(Pose::IDENTITY), scene).expect("boxes");
        query.nearest().expect("an answer").map(|nearest| nearest.obstacle)
    };
    assert_eq!(nearest(&scene), Some(ids[0]));
    // The order of insertion is not changed by moves.
    scene.set_pose(ids[0], at(9.0, 0.0, 0.0)).expect("there");
    assert_eq!(nearest(&scene), Some(ids[1]));
    scene.set_pose(ids[0], at(0.0, 3.0, 0.0)).expect("there");
    assert_eq!(nearest(&scene), Some(ids[0]));
    scene.remove(ids[0]).expect("there");
    let newest = scene.insert(cube.clone(), at(3.0, 0.0, 0.0));
    assert_eq!((nearest(&scene), newest), (Some(ids[1]), ObstacleId(3)));
    let own = |id| id != newest;
    let query = SceneQuery::new(cube.at(Pose::IDENTITY), &scene).expect("boxes").ignoring(&own);
    assert_eq!(query.nearest().expect("an answer").map(|n| n.obstacle), Some(newest));
}

#[test]
fn invalid_input_is_rejected() {
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let point = ConvexPolyhedron::from_points(&[DVec3::ZERO]).expect("a point");
    let solid = Solid::from_convex(&cube).expect("a solid");
    let mut scene = Obstacles::new();
    let none = SceneQuery::new(point.at(Pose::IDENTITY), &scene).expect("no obstacles");
    assert_eq!(none.nearest(), Ok(None));
    assert!(none.within(1.0).expect("none").closer.is_empty());
    assert_eq!(none.clearance(DVec3::X).map(|c| (c.lower, c.stop)), Ok((f64::INFINITY, None)));

    let id = scene.insert(solid.clone(), at(3.0, 0.0, 0.0));
    assert!(SceneQuery::new(point.at(Pose::IDENTITY), &scene).is_ok());
    let query =
        SceneQuery::new(cube.at(Pose::IDENTITY), &scene).expect("a convex body and a solid");
    assert!(matches!(query.nearest(), Ok(Some(n)) if matches!(n.distance, ByKind::Solid(_))));
    for length in [-1.0, f64::NAN] {
        assert!(matches!(query.within(length), Err(QueryError::Length { .. })));
        assert!(matches!(query.clearance_before(DVec3::X, length), Err(QueryError::Length { .. })));
    }
    for direction in [DVec3::ZERO, DVec3::X * f64::NAN, DVec3::X * 1e100] {
        assert!(matches!(query.clearance(direction), Err(QueryError::Direction { .. })));
    }
    let (_, mut proof) = query.certified_nearest().expect("an answer").expect("one");
    proof.obstacle = ObstacleId(9);
    let unknown = CertificateError::UnknownObstacle { obstacle: ObstacleId(9) };
    assert_eq!(query.verify(&proof), Err(unknown));

    let point_id = scene.insert(point, Pose::IDENTITY);
    assert!(SceneQuery::new(solid.at(Pose::IDENTITY), &scene).is_ok());
    assert!(scene.remove(point_id).is_some() && scene.remove(point_id).is_none());
    assert!(SceneQuery::new(solid.at(Pose::IDENTITY), &scene).is_ok());
    assert_eq!(scene.set_pose(point_id, Pose::IDENTITY).unwrap_err().id, point_id);
    let moves = [(id, at(9.0, 0.0, 0.0)), (point_id, Pose::IDENTITY)];
    assert!(scene.set_poses(&moves).is_err());
    assert_eq!(scene.get(id).expect("there").1, at(3.0, 0.0, 0.0), "nothing has moved");
}

/// Far from the origin of the world, boxes are loose but bounds are narrow.
#[test]
fn bounds_are_narrow_far_from_origin() {
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let far = DVec3::new(1e9, -3e8, 2e7);
    let mut scene = Obstacles::new();
    let turn = DQuat::from_rotation_x(0.25);
    for k in 0..20 {
        let pose = Pose::new(turn, far + DVec3::new(2.0 * f64::from(k), 0.0, 0.0));
        scene.insert(cube.clone(), pose.expect("a pose"));
    }
    let above = Pose::new(turn, far + turn * DVec3::new(6.0, 0.0, 1.25)).expect("a pose");
    let query = SceneQuery::new(cube.at(above), &scene).expect("boxes");
    let (nearest, proof) = query.certified_nearest().expect("an answer").expect("one");
    assert_eq!(nearest.obstacle, ObstacleId(3));
    assert!(nearest.distance.upper() - nearest.lower < 1e-7, "{nearest:?}");
    assert!(query.verify(&proof).expect("a proof") < 1e-7);
}

/// A clearance with a minimum gap considers obstacles whose boxes the body only passes.
#[test]
fn minimum_gap_is_kept_from_all_obstacles() {
    let cube = cuboid(DVec3::splat(-0.5), DVec3::splat(0.5));
    let mut obstacles = Obstacles::default();
    obstacles.insert(cube.clone(), at(3.0, 1.2, 0.0));
    obstacles.insert(cube.clone(), at(9.0, 0.0, 0.0));
    let among = SceneQuery::new(cube.at(Pose::IDENTITY), &obstacles).expect("a question");
    let plain = among.clearance(DVec3::X).expect("an answer").safe_translation().expect("apart");
    assert!((plain - 8.0).abs() < 1e-12);
    let kept = among.with_options(Options::default().with_min_gap(0.5)).expect("a gap");
    let kept = kept.clearance(DVec3::X).expect("an answer").safe_translation().expect("apart");
    assert!((kept - (2.0 - 0.21_f64.sqrt())).abs() < 1e-12, "{kept}");
}

#[test]
fn nearest_of_many_spheres_is_that_of_the_closed_form() {
    let mut random = Random::new(0x5ca);
    for _ in 0..cases(20) {
        let mut scene = Obstacles::new();
        let spheres: Vec<(DVec3, f64)> =
            (0..200).map(|_| (random.vector() * 10.0, random.range(0.01, 0.5))).collect();
        for (at, radius) in &spheres {
            let sphere = ConvexPolyhedron::sphere(DVec3::ZERO, *radius).expect("a sphere");
            scene.insert(sphere, Pose::from_translation(*at).expect("a pose"));
        }
        let ends = [random.vector(), random.vector()];
        let capsule = ConvexPolyhedron::capsule(ends, 0.25).expect("a capsule");
        let query = SceneQuery::new(capsule.at(Pose::IDENTITY), &scene).expect("a query");
        let gap = |(at, radius): &(DVec3, f64)| {
            let along = ends[1] - ends[0];
            let share = ((*at - ends[0]).dot(along) / along.dot(along)).clamp(0.0, 1.0);
            (*at - ends[0] - along * share).length() - radius - 0.25
        };
        let least = spheres.iter().map(gap).fold(f64::INFINITY, f64::min).max(0.0);
        let nearest = query.nearest().expect("an answer").expect("there are some");
        let ByKind::Convex(distance) = nearest.distance else { panic!("convex bodies") };
        let distance = distance.upper;
        assert!((distance - least).abs() < 1e-12, "{distance} {least}");
        let near = spheres.iter().filter(|sphere| gap(sphere) < 2.0).count();
        assert_eq!(query.within(2.0).expect("an answer").closer.len(), near);
        let (clearance, proof) = query.certified_clearance(DVec3::X).expect("an answer");
        assert!(query.verify(&proof).expect("a proof") < 1e-9, "{clearance:?}");
    }
}

/// Rounded solids and rounded convex bodies among each other: the boxes include the radii, and each answer is that of
/// querying all obstacles one by one.
#[test]
fn rounded_solids_match_queries_of_single_obstacles() {
    let random = &mut Random::new(0x2ad);
    let poses = grid_poses(4, random);
    let mut scene = Obstacles::new();
    let cube = cuboid(DVec3::ZERO, DVec3::splat(0.25));
    let bar = cuboid(DVec3::ZERO, DVec3::new(0.1, 0.1, 0.5));
    let cross = Solid::from_pieces([&cube, &bar]).expect("a solid");
    let mut ids = Vec::new();
    for (k, pose) in poses.iter().enumerate() {
        let pose = Pose::from_matrix(pose.matrix(), pose.translation() * 2.0).expect("a pose");
        let radius = [0.0, 0.125, 0.75][k % 3];
        let id = if k % 2 == 0 {
            scene.insert(cross.clone().rounded(radius).expect("a solid"), pose)
        } else {
            scene.insert(cube.clone().rounded(radius).expect("a body"), pose)
        };
        ids.push(id);
    }
    let ball = ConvexPolyhedron::sphere(DVec3::ZERO, 0.25).expect("a ball");
    for _ in 0..cases(40) {
        let start = at(random.range(-2.0, 8.0), random.range(-2.0, 8.0), random.range(8.0, 9.0));
        let query = SceneQuery::new(ball.at(start), &scene).expect("solids");
        let nearest = query.certified_nearest().expect("an answer");
        let (nearest, proof) = nearest.expect("there are some");
        assert!(query.verify(&proof).is_ok());
        let bounds = ids.iter().map(|id| match query.pair_with(*id).expect("a pair") {
            ByKind::Convex(pair) => pair.distance().expect("a distance").bounds(),
            ByKind::Solid(pair) => pair.distance().expect("a distance").bounds(),
        });
        let least = bounds.map(|[_, upper]| upper).fold(f64::INFINITY, f64::min);
        assert_eq!(nearest.distance.upper(), least);
        let direction = DVec3::new(random.range(-1.0, 1.0), random.range(-1.0, 1.0), -1.0);
        let (found, proof) = query.certified_clearance(direction).expect("an answer");
        assert!(query.verify(&proof).is_ok());
        let single = ids.iter().map(|id| match query.cast_with(*id, direction).expect("a cast") {
            ByKind::Convex(cast) => cast.clearance().expect("an answer").distance(),
            ByKind::Solid(cast) => cast.clearance().expect("an answer").distance(),
        });
        let least = single.map(|one| one.unwrap_or(f64::INFINITY)).fold(f64::INFINITY, f64::min);
        assert!((found.lower - least).abs() < 1e-9 || found.lower == least, "{found:?} {least}");
    }
}

/// A ball is bounded by its reach, not by the cube around it: the points in the corners of the cube are not queried.
#[test]
fn ball_among_many_points_queries_few_of_them() {
    let mut random = Random::new(0xba11);
    let point = Arc::new(ConvexPolyhedron::from_points(&[DVec3::ZERO]).expect("a point"));
    let points: Vec<DVec3> = (0..20_000).map(|_| random.vector()).collect();
    let mut scene = Obstacles::new();
    scene.insert_all(points.iter().map(|p| (point.clone(), at(p.x, p.y, p.z))));
    let radius = 0.25;
    let ball = ConvexPolyhedron::sphere(DVec3::ZERO, radius).expect("a ball");
    let count = cases(100);
    let mut bodies = [0; 3];
    for k in 0..count {
        let start = random.direction() * 3.0;
        let direction = if k % 2 == 0 {
            (random.vector() * 0.5 - start).normalize()
        } else {
            random.pick(&[DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z])
        };
        let query = SceneQuery::new(ball.at(at(start.x, start.y, start.z)), &scene);
        let query = query.expect("a query");
        let nearest = query.nearest().expect("an answer").expect("points");
        let least = points.iter().map(|p| p.distance(start)).fold(f64::INFINITY, f64::min);
        assert!((nearest.distance.upper() - (least - radius)).abs() < 1e-13, "{nearest:?}");
        let within = query.within(2.0).expect("an answer");
        let closer = points.iter().filter(|p| p.distance(start) - radius < 2.0).count();
        assert_eq!(within.closer.len(), closer);
        let entry = |p: &DVec3| {
            let way = *p - start;
            let lateral = way.reject_from_normalized(direction).length();
            let along = way.dot(direction);
            let is_ahead = lateral < radius && along > 0.0;
            is_ahead.then(|| along - ((radius - lateral) * (radius + lateral)).sqrt())
        };
        let first = points.iter().filter_map(entry).fold(f64::INFINITY, f64::min);
        let found = query.clearance(direction).expect("an answer");
        assert!((found.lower - first).abs() < 1e-10 || found.lower == first, "{found:?} {first}");
        let of_query =
            [nearest.steps.bodies, within.steps.bodies - closer as u32, found.steps.bodies];
        bodies = [0, 1, 2].map(|k| bodies[k] + of_query[k]);
    }
    // One obstacle for each answer, and few others.
    assert!(bodies.iter().all(|n| u64::from(*n) < 3 * count), "{bodies:?} of {count}");
}

/// Searches bound rounded bodies and minimum gaps exactly. The answers are those of querying all obstacles.
#[test]
fn rounded_bodies_with_minimum_gaps_match_single_queries() {
    let mut random = Random::new(0x9a9);
    let bar = cuboid(DVec3::ZERO, DVec3::new(0.125, 0.25, 0.75));
    let segment = [DVec3::NEG_X * 0.5, DVec3::X * 0.25];
    let bodies = [
        ConvexPolyhedron::sphere(DVec3::ZERO, 0.5).expect("a sphere"),
        ConvexPolyhedron::capsule(segment, 0.25).expect("a capsule"),
        bar.clone().rounded(0.375).expect("a body"),
        bar,
    ];
    let mut stopped = 0;
    for round in 0..cases(60) {
        let mut scene = Obstacles::new();
        let ids: Vec<ObstacleId> = grid_poses(5, &mut random)
            .iter()
            .enumerate()
            .map(|(k, pose)| {
                let place = pose.translation() * 2.0 + random.vector() * 0.5;
                let pose = Pose::from_matrix(pose.matrix(), place).expect("a pose");
                scene.insert(bodies[k % 4].clone(), pose)
            })
            .collect();
        let place = (random.vector() * 0.5 + DVec3::splat(0.5)) * 10.0;
        let pose = Pose::new(random.rotation(), place).expect("a pose");
        let min_gap = random.pick(&[0.0, 0.125, 0.75]);
        let query = SceneQuery::new(bodies[round as usize % 4].at(pose), &scene).expect("a query");
        let query = query.with_options(Options::default().with_min_gap(min_gap)).expect("a gap");
        let direction = if random.one_in(2) { random.direction() } else { DVec3::NEG_Z };

        let nearest = query.nearest().expect("an answer").expect("obstacles");
        let distances = ids.iter().map(|id| match query.pair_with(*id).expect("a pair") {
            ByKind::Convex(pair) => pair.distance().expect("a distance").upper,
            ByKind::Solid(_) => unreachable!("all are convex"),
        });
        let least = distances.clone().fold(f64::INFINITY, f64::min);
        assert_eq!(nearest.distance.upper(), least);
        let within = query.within(1.0).expect("an answer");
        let closer = distances.filter(|upper| *upper <= 1.0).count();
        assert_eq!(within.closer.len() + within.undecided.len(), closer);

        let found = query.clearance(direction).expect("an answer");
        let upper_of = |clearance: &Clearance| match clearance {
            Clearance::Blocked { contact, .. } => contact.certificate.upper,
            Clearance::Overlapping(_) => f64::NEG_INFINITY,
            Clearance::Free(_) => f64::INFINITY,
        };
        let singles = ids.iter().map(|id| match query.cast_with(*id, direction).expect("a cast") {
            ByKind::Convex(cast) => (upper_of(&cast.clearance().expect("an answer")), *id),
            ByKind::Solid(_) => unreachable!("all are convex"),
        });
        let first = singles.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (upper, id) = first.expect("obstacles");
        match found.stop {
            Some((stop, ByKind::Convex(clearance))) => {
                assert_eq!((stop, upper_of(&clearance)), (id, upper));
                stopped += 1;
            }
            _ => assert_eq!(upper, f64::INFINITY),
        }
        let (_, proof) = query.certified_clearance(direction).expect("an answer");
        assert!(query.verify(&proof).is_ok());
        let (_, proof) = query.certified_within(1.0).expect("an answer");
        assert!(query.verify(&proof).is_ok());
    }
    assert!(stopped > cases(20), "{stopped}");
}
