//! One body among many: the rule, bounds and proofs of all families of scenes, work, bad input.

use std::sync::Arc;

use colltrans_convex::{CertificateError, ConvexPolyhedron, ObstacleId, Options, Pose, QueryError};
use colltrans_scene::{Among, Obstacles};
use colltrans_solid::{ByKind, Solid};
use colltrans_testkit::bodies::{at_xyz as at, block as cuboid};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::among::{FAMILIES, examine};
use colltrans_testkit::random::Random;
use colltrans_testkit::tally::Tally;
use glam::{DQuat, DVec3};

#[test]
fn all_families_are_right() {
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

/// Small boxes, a quarter of a unit, one in each cell of a grid.
fn grid(side: u32, random: &mut Random) -> Vec<Pose> {
    let cells = (0..side * side * side).map(|k| [k % side, k / side % side, k / side / side]);
    let places = cells.map(|cell| DVec3::from_array(cell.map(f64::from)));
    places.map(|at| Pose::new(random.rotation(), at).expect("a pose")).collect()
}

#[test]
fn who_cannot_be_asked_about_is_named() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let two_sides = Solid::from_mesh(&corners, &[[0, 1, 2], [0, 2, 1]]).expect("closed");
    let cube = Solid::from_convex(&cuboid(DVec3::ZERO, DVec3::ONE)).expect("a solid");
    let mut scene = Obstacles::new();
    scene.insert(cube.clone(), at(0.0, 0.0, 3.0));
    let thin = scene.insert(two_sides, at(0.0, 0.0, 7.0));
    // Bodies that are turned are shrunk by more than nothing.
    let turned = |z: f64| {
        let pose = Pose::new(DQuat::from_rotation_z(0.5), DVec3::Z * z).expect("a pose");
        Among::new(cube.at(pose), &scene).expect("a solid")
    };
    let refused = turned(5.0).clearance(DVec3::Z).expect_err("nothing is left of it");
    let QueryError::Obstacle { obstacle, reason } = &refused else { panic!("{refused}") };
    assert_eq!(*obstacle, thin);
    assert!(matches!(**reason, QueryError::NothingLeft { which: "fixed", .. }), "{refused}");
    assert!(refused.to_string().starts_with("obstacle 1: the tolerance"), "{refused}");
    let stopped = turned(0.0).clearance(DVec3::Z).expect("only the first is asked about");
    assert!(stopped.lower > 1.9 && stopped.steps.bodies == 1);
}

/// Shrunk bodies meet later than they do as they are, and the later the more their facets are along the way.
#[test]
fn a_slanting_obstacle_stops_before_a_wall_behind_it() {
    let solid = |body: &ConvexPolyhedron| Solid::from_convex(body).expect("a solid");
    let cube = solid(&cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)));
    let wall = solid(&cuboid(DVec3::new(3.5, -9.0, -9.0), DVec3::new(4.0, 9.0, 9.0)));
    // Its upper side rises by one in ten: the lower edge of the cube in front, at z = -0.5, meets it at x = 3.45.
    let corners = [[0.0, -0.845], [6.0, -0.245], [6.0, -2.0], [0.0, -2.0]];
    let points: Vec<DVec3> =
        corners.iter().flat_map(|[x, z]| [-1.0, 1.0].map(|y| DVec3::new(*x, y, *z))).collect();
    let ramp = solid(&ConvexPolyhedron::from_points(&points).expect("a body"));
    let mut scene = Obstacles::new();
    let [_, ramp] = [wall, ramp].map(|body| scene.insert(body, Pose::IDENTITY));
    let options = colltrans_solid::SolidOptions::default().with_tolerance(0.02);
    let asked = Among::new(cube.at(Pose::IDENTITY), &scene).expect("solids");
    let asked = asked.with_solid_options(options);
    let found = asked.clearance(DVec3::X).expect("an answer");
    assert_eq!(found.stop.map(|(id, _)| id), Some(ramp));
    assert!((found.lower - 2.95).abs() < 1e-9, "{}", found.lower);
    assert!((asked.clearance_before(DVec3::X, 2.97).expect("an answer").lower - 2.95).abs() < 1e-9);
}

#[test]
fn few_boxes_are_looked_at() {
    let mut random = Random::new(11);
    let small = Arc::new(cuboid(DVec3::splat(-0.1), DVec3::splat(0.1)));
    let mut scene = Obstacles::new();
    let poses = grid(22, &mut random);
    let ids = scene.insert_all(poses.iter().map(|pose| (small.clone(), *pose)));
    // Boxes and bodies that are looked at on average: for the nearest one, those within 0.3, and a cast.
    let work = |scene: &Obstacles, random: &mut Random| {
        let (mut boxes, mut bodies) = ([0; 3], [0; 3]);
        for _ in 0..200 {
            let place = (random.vector() * 0.5 + DVec3::splat(0.5)) * 22.0;
            let pose = Pose::new(random.rotation(), place).expect("a pose");
            let asked = Among::new(small.at(pose), scene).expect("boxes");
            let steps = [
                asked.nearest().expect("an answer").expect("some").steps,
                asked.within(0.3).expect("an answer").steps,
                asked.clearance(random.direction()).expect("an answer").steps,
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

    // Everything goes elsewhere, twice: to the places of others, by small steps and by large ones.
    for round in 0..2 {
        for (k, id) in ids.iter().enumerate() {
            let pose = poses[(k * 7_919 + round) % poses.len()];
            scene
                .set_pose(*id, pose.translated(random.vector() * 0.2).expect("a pose"))
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
fn one_by_one_is_as_good_as_all_at_once() {
    let mut random = Random::new(5);
    let small = Arc::new(cuboid(DVec3::splat(-0.1), DVec3::splat(0.1)));
    let poses = grid(12, &mut random);
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
            let asked = Among::new(small.at(pose), scene).expect("boxes");
            asked.nearest().expect("an answer").expect("some")
        });
        assert_eq!(found[0].obstacle, found[1].obstacle);
        assert_eq!(found[0].distance, found[1].distance);
        boxes = [0, 1].map(|k| boxes[k] + found[k].steps.boxes);
    }
    assert!(boxes[1] <= 2 * boxes[0], "{boxes:?}");
}

#[test]
fn of_equal_ones_the_first() {
    let cube = Arc::new(cuboid(DVec3::ZERO, DVec3::ONE));
    let mut scene = Obstacles::new();
    let ids: Vec<_> =
        [3.0, -3.0, 3.0].into_iter().map(|x| scene.insert(cube.clone(), at(x, 0.0, 0.0))).collect();
    let nearest = |scene: &Obstacles| {
        let asked = Among::new(cube.at(Pose::IDENTITY), scene).expect("boxes");
        asked.nearest().expect("an answer").map(|nearest| nearest.obstacle)
    };
    assert_eq!(nearest(&scene), Some(ids[0]));
    // Its place in line stays, wherever it has been.
    scene.set_pose(ids[0], at(9.0, 0.0, 0.0)).expect("there");
    assert_eq!(nearest(&scene), Some(ids[1]));
    scene.set_pose(ids[0], at(0.0, 3.0, 0.0)).expect("there");
    assert_eq!(nearest(&scene), Some(ids[0]));
    scene.remove(ids[0]).expect("there");
    let newest = scene.insert(cube.clone(), at(3.0, 0.0, 0.0));
    assert_eq!((nearest(&scene), newest), (Some(ids[1]), ObstacleId(3)));
    let own = |id| id != newest;
    let asked = Among::new(cube.at(Pose::IDENTITY), &scene).expect("boxes").ignoring(&own);
    assert_eq!(asked.nearest().expect("an answer").map(|n| n.obstacle), Some(newest));
}

#[test]
fn bad_input_is_refused() {
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let point = ConvexPolyhedron::from_points(&[DVec3::ZERO]).expect("a point");
    let solid = Solid::from_convex(&cube).expect("a solid");
    let mut scene = Obstacles::new();
    let none = Among::new(point.at(Pose::IDENTITY), &scene).expect("no obstacles");
    assert_eq!(none.nearest(), Ok(None));
    assert!(none.within(1.0).expect("none").closer.is_empty());
    assert_eq!(none.clearance(DVec3::X).map(|c| (c.lower, c.stop)), Ok((f64::INFINITY, None)));

    let id = scene.insert(solid.clone(), at(3.0, 0.0, 0.0));
    assert!(Among::new(point.at(Pose::IDENTITY), &scene).is_ok());
    let asked = Among::new(cube.at(Pose::IDENTITY), &scene).expect("a convex body and a solid");
    assert!(matches!(asked.nearest(), Ok(Some(n)) if matches!(n.distance, ByKind::Solid(_))));
    for length in [-1.0, f64::NAN] {
        assert!(matches!(asked.within(length), Err(QueryError::Length { .. })));
        assert!(matches!(asked.clearance_before(DVec3::X, length), Err(QueryError::Length { .. })));
    }
    for direction in [DVec3::ZERO, DVec3::X * f64::NAN, DVec3::X * 1e100] {
        assert!(matches!(asked.clearance(direction), Err(QueryError::Direction { .. })));
    }
    let (_, mut proof) = asked.certified_nearest().expect("an answer").expect("one");
    proof.obstacle = ObstacleId(9);
    let unknown = CertificateError::UnknownObstacle { obstacle: ObstacleId(9) };
    assert_eq!(asked.verify(&proof), Err(unknown));

    let point_id = scene.insert(point, Pose::IDENTITY);
    assert!(Among::new(solid.at(Pose::IDENTITY), &scene).is_ok());
    assert!(scene.remove(point_id).is_some() && scene.remove(point_id).is_none());
    assert!(Among::new(solid.at(Pose::IDENTITY), &scene).is_ok());
    assert_eq!(scene.set_pose(point_id, Pose::IDENTITY).unwrap_err().id, point_id);
    let moves = [(id, at(9.0, 0.0, 0.0)), (point_id, Pose::IDENTITY)];
    assert!(scene.set_poses(&moves).is_err());
    assert_eq!(scene.get(id).expect("there").1, at(3.0, 0.0, 0.0), "nothing has moved");
}

/// Far from the world's origin boxes are loose, bounds are not.
#[test]
fn far_from_the_origin() {
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let far = DVec3::new(1e9, -3e8, 2e7);
    let mut scene = Obstacles::new();
    let turn = DQuat::from_rotation_x(0.25);
    for k in 0..20 {
        let pose = Pose::new(turn, far + DVec3::new(2.0 * f64::from(k), 0.0, 0.0));
        scene.insert(cube.clone(), pose.expect("a pose"));
    }
    let above = Pose::new(turn, far + turn * DVec3::new(6.0, 0.0, 1.25)).expect("a pose");
    let asked = Among::new(cube.at(above), &scene).expect("boxes");
    let (nearest, proof) = asked.certified_nearest().expect("an answer").expect("one");
    assert_eq!(nearest.obstacle, ObstacleId(3));
    assert!(nearest.distance.upper() - nearest.lower < 1e-7, "{nearest:?}");
    assert!(asked.verify(&proof).expect("a proof") < 1e-7);
}

/// One that is asked among many keeps the gap from all: also from those whose boxes it passes.
#[test]
fn among_many_the_gap_is_kept_from_all() {
    let cube = cuboid(DVec3::splat(-0.5), DVec3::splat(0.5));
    let mut obstacles = Obstacles::default();
    obstacles.insert(cube.clone(), at(3.0, 1.2, 0.0));
    obstacles.insert(cube.clone(), at(9.0, 0.0, 0.0));
    let among = Among::new(cube.at(Pose::IDENTITY), &obstacles).expect("a question");
    let plain = among.clearance(DVec3::X).expect("an answer").distance().expect("apart");
    assert!((plain - 8.0).abs() < 1e-12);
    let kept = among.with_options(Options::default().with_keep(0.5)).expect("a gap");
    let kept = kept.clearance(DVec3::X).expect("an answer").distance().expect("apart");
    assert!((kept - (2.0 - 0.21_f64.sqrt())).abs() < 1e-12, "{kept}");
}
