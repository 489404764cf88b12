//! Distances: what is known in closed form, named cases, degenerate bodies, proofs and changed ones.

use colltrans_convex::{
    ConvexPolyhedron, Distance, NearPoints, Pair, PlaneGap, Pose, QueryError, VertexId, Within,
};
use colltrans_testkit::bodies::{at_xyz as at, block as cuboid, body};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::nearest::DistanceJudge;
use colltrans_testkit::oracle::settings::{FAMILIES, near_contact, setting};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::random_hull;
use glam::{DMat3, DQuat, DVec3};

fn pose(rotation: DQuat, at: DVec3) -> Pose {
    Pose::new(rotation, at).expect("a pose")
}

/// The judged distance, and how many noises its bounds are apart.
fn judged(p: &ConvexPolyhedron, a: Pose, q: &ConvexPolyhedron, b: Pose) -> (Distance, f64) {
    let pair = Pair::new(p.at(a), q.at(b)).expect("a pair");
    let distance = pair.distance().expect("an answer");
    let noises = DistanceJudge::new(pair).check(&distance).expect("a right answer");
    (distance, noises)
}

#[test]
fn all_families_are_right() {
    let mut apart = 0;
    for (family, _) in FAMILIES {
        for seed in 0..cases(60) {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let (distance, noises) =
                judged(&bodies.moving, setting.moving_pose, &bodies.fixed, setting.fixed_pose);
            let outside = bodies.moving.hull_error() + bodies.fixed.hull_error();
            let width = distance.upper - distance.lower;
            let explained = noises <= 4.0 || width - outside <= 4.0 * width / noises;
            assert!(explained || family.starts_with("nearly"), "{setting}: {noises}");
            apart += u32::from(distance.lower > 0.0);
        }
    }
    assert!(apart > cases(600), "{apart}");
}

#[test]
fn aligned_boxes_have_distances_known_in_closed_form() {
    for size in [1e58, 1.0, 1e-10, 1e-20, 1e-30, 1e-40, 1e-50, 1e-58] {
        let cube = cuboid(DVec3::ZERO, DVec3::splat(size));
        for share in [0.5, 1e-3, 1e-6, 1e-9, 1e-12] {
            let gap = (1.0 + share) * size - size;
            let (distance, noises) =
                judged(&cube, Pose::IDENTITY, &cube, at(size + gap, size * 0.25, size * 0.5));
            assert!(distance.lower > 0.0 && noises <= 4.0, "{size:e} {share:e}: {noises}");
            assert_eq!(distance.normal, Some(DVec3::X));
            let features = distance.features.expect("apart");
            assert_eq!((features.moving.kind(), features.fixed.kind()), ("face", "face"));
        }
    }
}

/// Faces where coordinates are small, so that gaps far below the rounding of the bodies' size are numbers.
#[test]
fn aligned_boxes_are_apart_by_any_gap() {
    let low = cuboid(DVec3::new(-1.0, -1.0, -1.0), DVec3::new(0.0, 1.0, 1.0));
    for exponent in 9..=60 {
        let gap = 10.0_f64.powi(-exponent);
        for (y, z) in [(0.0, 0.0), (0.25, -0.5), (2.0, 0.0), (2.0, 2.0), (1.0 / 3.0, 0.7)] {
            // The other side of a face, an edge and a corner.
            let far = cuboid(DVec3::new(gap, y - 1.0, z - 1.0), DVec3::new(1.0, y + 1.0, z + 1.0));
            let turned = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
            for turn in [DMat3::IDENTITY, turned] {
                let at = Pose::from_matrix(turn, DVec3::ZERO).expect("a pose");
                let (distance, noises) = judged(&low, at, &far, at);
                let label = format!("{gap:e} {y} {z}: {distance:?}");
                let least = if gap < 1e-15 { 0.999 * gap } else { 0.0 };
                assert!(distance.lower > least && distance.lower <= gap, "{label}");
                assert!(noises <= 4.0, "{label}");
                let pair = Pair::new(low.at(at), far.at(at)).expect("a pair");
                assert!(matches!(pair.within(0.0), Ok(Within::Farther(_))), "{label}");
                assert!(pair.verify(&distance.gap.expect("apart")).is_ok(), "{label}");
            }
        }
    }
}

#[test]
fn near_contact_is_never_contact() {
    let mut random = Random::new(3);
    for vertices in [4, 8, 20, 60, 300] {
        for gap in [1e-3, 1e-6, 1e-9, 1e-12] {
            let [p, q] = [0, 1].map(|_| body(&random_hull(vertices, &mut random).vertices));
            let (a, b) =
                (pose(random.rotation(), DVec3::ZERO), pose(random.rotation(), DVec3::X * 5.0));
            let way = judged(&p, a, &q, b).0;
            let normal = way.normal.expect("apart");
            let near = a.translated_by(normal * (way.upper - gap)).expect("a pose");
            let (distance, noises) = judged(&p, near, &q, b);
            assert!(distance.lower > 0.9 * gap && noises <= 4.0, "{vertices} {gap:e}: {noises}");
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
        cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)),
        cuboid(DVec3::splat(-1e7), DVec3::splat(1e7)),
        cuboid(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 1e-9)),
        body(&[z * 1e-6, -z * 1e-6]),
    ];
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7);
    let far = DVec3::new(1e9, -3e8, 2e5);
    for p in &shapes {
        for q in &shapes {
            for by in [DVec3::ZERO, x * 2.0, y, z * 0.5, x + y + z] {
                for rotation in [DQuat::IDENTITY, turn] {
                    for from in [DVec3::ZERO, far] {
                        judged(p, pose(DQuat::IDENTITY, from), q, pose(rotation, from + by));
                    }
                }
            }
        }
    }
}

/// As two boxes of issue 3383 of `MuJoCo`: faces parallel, apart by a little, and never 0.
#[test]
fn touching_faces_part_by_one_rounding() {
    let cube = cuboid(DVec3::splat(-0.5), DVec3::splat(0.5));
    let (touching, _) = judged(&cube, Pose::IDENTITY, &cube, at(1.0, 0.0, 0.0));
    assert!(touching.lower == 0.0 && touching.upper < 1e-13);
    let (overlapping, _) = judged(&cube, Pose::IDENTITY, &cube, at(0.9, 0.3, 0.2));
    assert_eq!((overlapping.bounds(), overlapping.normal), ([0.0, 0.0], None));
    for gap in [1e-13, 1e-12, 1e-9] {
        let (apart, _) = judged(&cube, Pose::IDENTITY, &cube, at(1.0 + gap, 0.0, 0.0));
        assert!(apart.lower > 0.0, "{gap:e}");
    }
}

#[test]
fn within_a_length_or_not() {
    for (family, _) in FAMILIES {
        for seed in 0..20 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let [p, q] =
                [bodies.moving.at(setting.moving_pose), bodies.fixed.at(setting.fixed_pose)];
            let pair = Pair::new(p, q).expect("a pair");
            let judge = DistanceJudge::new(pair);
            let truth = judge.truth.to_f64();
            for length in [0.0, 0.5 * truth, truth, truth + 4.0 * judge.noise, 2.0 * truth, 1e9] {
                let within = pair.within(length).expect("an answer");
                judge.check_within(length, &within).expect("a right one");
                let clear = (length - truth).abs() > 70.0 * judge.noise;
                assert!(!clear || !matches!(within, Within::Undecided(_)), "{setting} {length:e}");
            }
            for length in [-1.0, f64::NAN] {
                assert!(matches!(pair.within(length), Err(QueryError::Length { .. })));
            }
        }
    }
}

/// One bit of a claim, or a corner: what is not proven any more is refused.
#[test]
fn changed_proofs_are_refused() {
    let mut random = Random::new(11);
    for vertices in [4, 8, 60] {
        let [p, q] = [0, 1].map(|_| body(&random_hull(vertices, &mut random).vertices));
        let (a, b) =
            (pose(random.rotation(), DVec3::ZERO), pose(random.rotation(), DVec3::X * 5.0));
        let pair = Pair::new(p.at(a), q.at(b)).expect("a pair");
        let distance = pair.distance().expect("an answer");
        let (plane, near) = (distance.gap.expect("apart"), distance.near);
        let proven = pair.verify(&plane).expect("a proof");
        pair.verify(&PlaneGap { gap: proven, ..plane }).expect("all that is proven");
        let refused = [
            PlaneGap { gap: proven.next_up(), ..plane },
            PlaneGap { gap: f64::NAN, ..plane },
            PlaneGap { normal: -plane.normal, ..plane },
            PlaneGap { normal: plane.normal * 1.001, ..plane },
            PlaneGap { normal: (plane.normal + DVec3::Y * 1e-3).normalize(), ..plane },
        ];
        for changed in refused {
            assert!(pair.verify(&changed).is_err(), "{changed:?}");
        }
        let proven = pair.verify(&near).expect("a proof");
        pair.verify(&NearPoints { distance: proven, ..near }).expect("all that is proven");
        let mut other = near;
        other.pairs[0].moving = VertexId(10_000);
        let [w, ..] = near.weights;
        let mut negative = near;
        negative.weights = [1.0 + w, -w, 0.0, 0.0];
        let refused = [
            NearPoints { distance: proven.next_down(), ..near },
            NearPoints { distance: 0.0, ..near },
            NearPoints { distance: f64::NAN, ..near },
            NearPoints { weights: [w, 0.0, 0.0, 0.0].map(|w| w * 0.5), ..near },
            other,
            negative,
        ];
        for changed in refused {
            assert!(pair.verify(&changed).is_err(), "{changed:?}");
        }
    }
}

#[test]
fn depths_of_boxes_are_known() {
    let cube = cuboid(DVec3::splat(-0.5), DVec3::splat(0.5));
    for (by, depth, direction) in [
        (DVec3::new(0.75, 0.5, 0.25), 0.25, DVec3::NEG_X),
        (DVec3::new(0.1, -0.9, 0.25), 0.1, DVec3::Y),
        (DVec3::new(0.0, 0.0, 0.5), 0.5, DVec3::NEG_Z),
    ] {
        let pair = Pair::new(cube.at(Pose::IDENTITY), cube.at(pose(DQuat::IDENTITY, by)));
        let pair = pair.expect("a pair");
        let found = pair.depth().expect("an answer");
        assert!(found.lower <= depth && depth <= found.upper && found.upper - found.lower < 1e-13);
        assert_eq!(found.direction, direction, "{by}");
        DistanceJudge::new(pair).check_depth(&found).expect("a right answer");
        DistanceJudge::new(pair).compare_depth(&found).expect("a right answer");
    }
    // Centred: any of six ways.
    let pair = Pair::new(cube.at(Pose::IDENTITY), cube.at(Pose::IDENTITY)).expect("a pair");
    let [lower, upper] = pair.depth().expect("an answer").bounds();
    assert!(lower > 1.0 - 1e-13 && upper < 1.0 + 1e-13);
}

#[test]
fn depths_of_all_families_are_right() {
    let mut deep = 0;
    for (family, _) in FAMILIES {
        for seed in 0..cases(24) {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            // One within the other, more or less.
            let moving = Pose::from_matrix(
                setting.moving_pose.matrix(),
                setting.fixed_pose.translation() + DVec3::new(0.1, 0.05, 0.2),
            );
            let [p, q] =
                [bodies.moving.at(moving.expect("a pose")), bodies.fixed.at(setting.fixed_pose)];
            let pair = Pair::new(p, q).expect("a pair");
            let depth = pair.depth().unwrap_or_else(|e| panic!("{setting}: {e}"));
            let judge = DistanceJudge::new(pair);
            judge.check_depth(&depth).unwrap_or_else(|e| panic!("{setting}: {e}"));
            if p.body.vertices().len() + q.body.vertices().len() <= 16 {
                judge.compare_depth(&depth).unwrap_or_else(|e| panic!("{setting}: {e}"));
            }
            deep += u32::from(depth.lower > 0.0);
        }
    }
    assert!(deep > cases(200), "{deep}");
}

#[test]
fn changed_depths_are_refused() {
    let mut random = Random::new(5);
    for vertices in [12, 30, 60] {
        let [p, q] = [0, 1].map(|_| body(&random_hull(vertices, &mut random).vertices));
        let (a, b) =
            (pose(random.rotation(), DVec3::ZERO), pose(random.rotation(), DVec3::X * 0.2));
        let pair = Pair::new(p.at(a), q.at(b)).expect("a pair");
        let depth = pair.depth().expect("an answer");
        assert!(depth.lower > 0.0);
        let proven = pair.verify(&depth).expect("a proof");
        let mut all = depth.clone();
        all.lower = proven;
        pair.verify(&all).expect("all that is proven");
        let mut changed = vec![depth.clone(); 8];
        changed[0].lower = proven.next_up();
        changed[1].upper = depth.lower * 0.999;
        changed[2].direction = -depth.direction;
        changed[3].enclosure.triangles.swap_remove(0);
        changed[4].enclosure.triangles[0].swap(0, 1);
        changed[5].enclosure.normals[0] = -depth.enclosure.normals[0];
        changed[6].enclosure.triangles[0][0] = u32::MAX;
        changed[7].enclosure.pairs[depth.enclosure.triangles[0][0] as usize].moving =
            VertexId(10_000);
        for (k, changed) in changed.into_iter().enumerate() {
            let refused = pair.verify(&changed).is_err();
            assert!(refused, "{k}");
        }
    }
}

#[test]
fn tracked_distances_are_as_tight() {
    let mut random = Random::new(8);
    for vertices in [4, 12, 60, 300] {
        let [p, q] = [0, 1].map(|_| body(&random_hull(vertices, &mut random).vertices));
        let mut tracker = colltrans_convex::Tracker::new();
        let rotation = random.rotation();
        for step in 0..60 {
            let angle = 0.05 * f64::from(step);
            let a = pose(DQuat::from_rotation_z(angle), DVec3::new(3.0 - angle, 0.1, angle * 0.1));
            let pair = Pair::new(p.at(a), q.at(pose(rotation, DVec3::ZERO))).expect("a pair");
            let distance = tracker.distance(&pair).expect("an answer");
            let noises = DistanceJudge::new(pair).check(&distance).expect("a right answer");
            assert!(noises <= 4.0, "{noises}");
        }
    }
}

#[test]
fn lined_up_boxes_that_meet_have_a_point_in_common_for_certain() {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).unwrap();
    let large = ConvexPolyhedron::cuboid(DVec3::splat(-4.0), DVec3::splat(4.0)).unwrap();
    let places = [
        [0.0, 0.0, 0.0],
        [0.5, 0.25, 0.0],
        [0.1, 0.7, 0.3],
        [1.0, 0.25, 0.5],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.5],
        [1.0, 1.0, 1.0],
    ];
    for fixed in [&cube, &large] {
        for place in places {
            let pose = Pose::from_translation(DVec3::from_array(place)).unwrap();
            let pair = Pair::new(cube.at(pose), fixed.at(Pose::IDENTITY)).unwrap();
            let distance = pair.distance().unwrap();
            assert_eq!(distance.bounds(), [0.0, 0.0], "{place:?}");
            assert_eq!(pair.verify(&distance.near).unwrap(), 0.0);
            assert!(distance.on_moving.distance(distance.on_fixed) < 1e-14, "{place:?}");
            assert!(matches!(pair.within(0.0).unwrap(), Within::Closer(_)), "{place:?}");
        }
    }
}

/// Normals that are some roundings too long are unit vectors still, and prove no more for that.
#[test]
fn a_depth_counts_in_lengths_of_its_normals() {
    let cube = cuboid(DVec3::splat(-0.5), DVec3::splat(0.5));
    let pair = Pair::new(cube.at(Pose::IDENTITY), cube.at(Pose::IDENTITY)).expect("a pair");
    let mut depth = pair.depth().expect("a depth");
    let unit = f64::EPSILON / 2.0;
    depth.enclosure.normals.iter_mut().for_each(|normal| *normal *= 1.0 + 30.0 * unit);
    assert!(pair.verify(&depth).expect("still a proof") <= 1.0);
    depth.lower = 1.0 + 12.0 * unit;
    assert!(pair.verify(&depth).is_err());
}

/// Bodies with nearly straight chains of vertices, brought near each other as the campaign does: four pairs that
/// enclose the origin span next to no volume, and rounded weights left the two points that are one apart.
#[test]
fn points_that_are_one_are_so_in_thin_overlaps() {
    for seed in [304_942_693_826, 304_942_696_221, 304_942_709_989] {
        let setting = setting("nearly-straight", seed);
        let bodies = setting.bodies().expect("bodies");
        let mut random = Random::new(seed ^ 0x5eed);
        let moving = near_contact(&setting, &bodies, &mut random).unwrap_or(setting.moving_pose);
        let (distance, _) = judged(&bodies.moving, moving, &bodies.fixed, setting.fixed_pose);
        assert_eq!(distance.upper, 0.0, "{setting}");
    }
}
