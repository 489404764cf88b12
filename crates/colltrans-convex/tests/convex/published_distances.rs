//! Distances and overlaps that published libraries are known to answer wrongly.

use colltrans_convex::{ConvexPolyhedron, Depth, Distance, Pair, Pose, Within};
use colltrans_testkit::oracle::nearest::DistanceJudge;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{cuboid, random_hull};
use glam::{DMat3, DQuat, DVec3};

use crate::common::{at, body};

/// Distance and depth, held against fractions.
fn asked(p: &ConvexPolyhedron, a: Pose, q: &ConvexPolyhedron, b: Pose) -> (Distance, Depth) {
    let pair = Pair::new(p.at(a), q.at(b)).expect("a pair");
    let (distance, depth) = (pair.distance().expect("an answer"), pair.depth().expect("an answer"));
    let judge = DistanceJudge::new(pair);
    judge.check(&distance).expect("a right distance");
    judge.check_depth(&depth).expect("a right depth");
    (distance, depth)
}

/// A rotation by its rows.
fn turned(rows: [[f64; 3]; 3], at: DVec3) -> Pose {
    let matrix = DMat3::from_cols_array_2d(&rows).transpose();
    Pose::from_matrix(matrix, at).expect("a pose")
}

/// FCL issues 493 and 495: faces that touch to within rounding, where its two searches disagree and it ends
/// in an exception. Either they are apart, by a proof, or no farther than rounding.
#[test]
fn boxes_whose_faces_kiss() {
    let one = [
        [0.940_960_632_174_177_6, 0.292_968_400_372_895, 0.169_595_415_861_748_1],
        [-0.235_698_368_412_998_8, 0.926_615_235_958_484_3, -0.292_968_400_372_895_07],
        [-0.242_980_179_903_263_9, 0.235_698_368_412_998_85, 0.940_960_632_174_177_6],
    ];
    let two = [
        [0.961_939_766_255_643_5, 0.154_012_799_157_373_6, 0.225_725_372_503_288_9],
        [-0.191_341_716_182_545, 0.969_364_942_512_839_1, 0.154_012_799_157_373_6],
        [-0.195_090_322_016_128_2, -0.191_341_716_182_545, 0.961_939_766_255_643_5],
    ];
    let ends = [
        (
            [0.073_242_100_093_223_82, 0.231_653_808_989_621_23, 1.308_924_592_103_249_7],
            [0.0, 0.0, 1.25],
        ),
        (
            [2.077_006_399_578_687, 0.484_682_474_756_419_5, 1.154_329_141_908_727_6],
            [2.0, 0.0, 1.25],
        ),
    ];
    // The second two were reported as they were printed, and are apart.
    for (rows, size, [from, to], gap) in [
        (one, 0.25, <[_; 2]>::from(ends[0]), 0.0),
        (two, 0.5, <[_; 2]>::from(ends[1]), 3.392_777e-9),
    ] {
        let cube = body(&cuboid(DVec3::splat(0.5 * size)).vertices);
        let [from, to] = [from, to].map(DVec3::from_array);
        for away in [0.0, 1e-16, 1e-15, 1e-14, 1e-12, 1e-9, -1e-15, -1e-12, -1e-8] {
            let moving = turned(rows, from + (from - to).normalize() * away);
            let (distance, depth) = asked(&cube, moving, &cube, turned(rows, to));
            let apart: f64 = gap + away;
            let is_near = |x: f64, y: f64| (x - y.max(0.0)).abs() < 1e-13;
            assert!(is_near(distance.upper, apart), "{away:e}: {distance:?}");
            assert!(is_near(depth.upper, -apart), "{away:e}: {:?}", depth.bounds());
            // Between the two rounding of the numbers themselves decides.
            assert!(distance.lower > 0.0 || apart < 1e-13, "{away:e}: {distance:?}");
            assert!(distance.lower == 0.0 || apart > -1e-13, "{away:e}: {distance:?}");
        }
    }
}

/// FCL issue 508: 3.16 for two unit boxes that are 3 apart along y.
#[test]
fn boxes_three_apart() {
    let cube = body(&cuboid(DVec3::splat(0.5)).vertices);
    for axis in DVec3::AXES {
        for far in [1.5, 1.99, 2.01, 4.0, 400.0] {
            let (distance, depth) = asked(&cube, at(axis * far), &cube, Pose::IDENTITY);
            assert!((distance.upper - (far - 1.0)).abs() < 2e-14 * (2.0 + far), "{axis} {far}");
            assert_eq!(depth.bounds(), [0.0; 2]);
        }
    }
}

/// `MuJoCo` issue 3383: exactly 0 for 103 of 3,000 random pairs that a plane parts by millimetres to decimetres.
#[test]
fn random_hulls_that_a_plane_parts() {
    let mut random = Random::new(7);
    let mut apart = 0;
    for round in 0..600 {
        let hull = |random: &mut Random| {
            let points = random_hull(8 + round % 40, random).vertices;
            body(&points.into_iter().map(|v| 0.1 * v).collect::<Vec<_>>())
        };
        let (p, q) = (hull(&mut random), hull(&mut random));
        let place = |random: &mut Random, far: f64| {
            Pose::new(random.rotation(), far * random.vector()).expect("a pose")
        };
        let (a, b) = (place(&mut random, 0.25), place(&mut random, 0.05));
        let (distance, _) = asked(&p, a, &q, b);
        let ways = (0..64).map(|_| random.vector().normalize());
        let gap = |n: DVec3| {
            let heights = |body: &ConvexPolyhedron, pose: Pose| -> [f64; 2] {
                let all = body.vertices().iter().map(|&v| pose.transform_point(v).dot(n));
                all.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [l.min(x), h.max(x)])
            };
            heights(&q, b)[0] - heights(&p, a)[1]
        };
        let seen = ways.map(gap).fold(f64::NEG_INFINITY, f64::max);
        assert!(distance.upper >= seen - 1e-15, "{round}");
        assert!(seen < 1e-13 || distance.lower > 0.0, "{round}: {seen:e}");
        apart += u32::from(seen > 1e-3);
    }
    assert!(apart > 100, "{apart}");
}

/// `DOLFINx` issue 3653: no answer within the steps that its search has, for a point and seven others.
#[test]
fn a_point_before_a_flat_hull() {
    let point = body(&[DVec3::new(44.2919, 39.7508, 18.8208)]);
    let hull = body(&[
        DVec3::new(46.0659, 38.6251, 16.3637),
        DVec3::new(44.2764, 42.3867, 18.239),
        DVec3::new(50.0397, 38.4649, 19.9843),
        DVec3::new(47.1963, 40.4563, 19.1057),
        DVec3::new(48.0266, 38.5593, 18.2475),
        DVec3::new(45.1735, 40.495, 17.3336),
        DVec3::new(48.0415, 40.4456, 18.1963),
    ]);
    let (distance, _) = asked(&point, Pose::IDENTITY, &hull, Pose::IDENTITY);
    assert!(distance.upper - distance.lower < 1e-11 && distance.lower > 1.8, "{distance:?}");
}

/// `MuJoCo` Warp issue 1527: a small positive distance for two meshes that overlap.
#[test]
fn slender_hulls_that_overlap() {
    let hull = body(&[
        DVec3::new(-0.061_159_066_9, -0.138_015_24, -0.158_372_656),
        DVec3::new(0.062_051_441_5, 0.135_089_189, -0.159_879_193),
        DVec3::new(-0.105_518_319, -0.100_999_095, -0.188_289_702),
        DVec3::new(-0.107_238_553, -0.102_976_903, 0.156_926_2),
        DVec3::new(-0.085_127_949_7, -0.122_304_708, 0.156_887_323),
        DVec3::new(-0.059_092_637_2, -0.104_567_274, -0.242_715_642),
    ]);
    let turn = DQuat::from_xyzw(0.002_900_976_1, 0.000_142_432_8, 0.840_008_747_9, 0.542_565_081_3);
    let place = |x: f64| Pose::new(turn.normalize(), DVec3::X * x).expect("a pose");
    let (distance, depth) = asked(&hull, place(-0.141_666_584), &hull, place(0.141_666_584));
    assert_eq!(distance.lower > 0.0, depth.upper == 0.0);
}

/// The hull of points.
fn points<const N: usize>(numbers: [[f64; 3]; N]) -> ConvexPolyhedron {
    body(&numbers.map(DVec3::from_array))
}

/// A box by its three edges.
fn sized(edges: [f64; 3]) -> ConvexPolyhedron {
    body(&cuboid(0.5 * DVec3::from_array(edges)).vertices)
}

/// Coal issue 604: with a tolerance of 1e-6 a wrong distance of two boxes that are hardly apart.
#[test]
fn boxes_turned_by_half_a_degree() {
    let one = turned(
        [
            [0.999_919_570_3, 0.010_218_494_13, 0.007_512_347_878],
            [-0.010_218_782_48, 0.999_947_786_9, -3.329_855_922e-17],
            [-0.007_511_955_635, -7.676_704_888e-5, 0.999_971_781_9],
        ],
        DVec3::new(1.503_354_966, -0.853_170_783_5, 0.770_009_241_8),
    );
    let two = turned(
        [
            [0.999_867_096_7, -0.012_977_083_24, 0.009_868_343_982],
            [0.012_977_715_17, 0.999_915_785_9, 5.255_670_031e-17],
            [-0.009_867_512_928, 0.000_128_068_557_4, 0.999_951_306_7],
        ],
        DVec3::new(1.488_383_08, -1.102_020_834, 0.449_707_379_9),
    );
    let (distance, _) =
        asked(&sized([0.363, 0.277, 0.363]), one, &sized([0.363, 0.363, 0.277]), two);
    assert!(distance.lower > 0.0 && distance.upper - distance.lower < 1e-14, "{distance:?}");
}

/// Coal issue 685: a pair within the security margin that its tree of boxes does not report, and the same with a
/// wall that is turned by a degree.
#[test]
fn a_box_near_a_wall() {
    let moving = turned(
        [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]],
        DVec3::new(1.490_67, 0.845_416, -0.194_226),
    );
    let (sine, cosine) = (0.017_452_4, 0.999_847_7);
    let degree = [[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]];
    let straight = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let (moved, wall) = (sized([0.16, 0.27, 0.37]), sized([5.898, 0.06, 2.69]));
    for (rows, gap) in [(straight, 0.014_584), (degree, 0.038)] {
        let there = turned(rows, DVec3::new(0.0, 1.075, 0.555));
        let (distance, _) = asked(&moved, moving, &wall, there);
        assert!((distance.upper - gap).abs() < 1e-3, "{distance:?}");
        let pair = Pair::new(moved.at(moving), wall.at(there)).expect("a pair");
        let [less, more] = [distance.lower - 1e-9, distance.upper + 1e-9].map(|l| pair.within(l));
        assert!(matches!(less, Ok(Within::Farther(_))) && matches!(more, Ok(Within::Closer(_))));
    }
}

/// Coal issue 144, of boxes that overlap by 1e-4 in whole faces (a contact at a corner of them), and its change 325,
/// of vertices that touch, minus infinity before; libccd issue 25, of cubes 1.9 apart (a depth of 0, no number as
/// its direction).
#[test]
fn cubes_of_two_that_overlap_slightly() {
    let cube = sized([2.0; 3]);
    for (there, depth) in [
        (DVec3::X * 1.9999, 2.0 - 1.9999),
        (DVec3::new(2.0, 2.0, 2.0), 0.0),
        (DVec3::Z * 1.9, 2.0 - 1.9),
    ] {
        let (distance, found) = asked(&cube, Pose::IDENTITY, &cube, at(there));
        assert_eq!(distance.bounds(), [0.0; 2]);
        assert!((found.upper - depth).abs() < 1e-13, "{there}: {found:?}");
        assert!(
            depth == 0.0 || found.direction.dot(there) < 1e-15 - there.max_element(),
            "{found:?}"
        );
    }
}

/// parry issue 431: 3.710461 or 3.5731668 for two rectangles, by their order.
#[test]
fn boxes_side_by_side_in_both_orders() {
    let (one, two) = (sized([2.0; 3]), sized([2.0, 4.0, 2.0]));
    let there = at(DVec3::X * -5.573_167);
    let (ahead, _) = asked(&one, Pose::IDENTITY, &two, there);
    let (back, _) = asked(&two, there, &one, Pose::IDENTITY);
    for distance in [ahead, back] {
        assert!((distance.upper - 3.573_167).abs() < 1e-13, "{distance:?}");
    }
    assert_eq!(ahead.normal.map(|n| -n), back.normal);
}

/// parry issue 315: two unit boxes side by side, which touch in the plane x = 1, with a contact point at their
/// centres and a normal across.
#[test]
fn unit_boxes_side_by_side() {
    let cube = sized([1.0; 3]);
    let places = [0.5, 1.5].map(|x| at(DVec3::new(x, 0.5, 0.5)));
    let (distance, depth) = asked(&cube, places[0], &cube, places[1]);
    assert_eq!(
        (distance.bounds(), distance.on_moving.x, distance.on_fixed.x),
        ([0.0; 2], 1.0, 1.0)
    );
    assert!(depth.upper < 1e-13 && depth.direction == DVec3::NEG_X, "{depth:?}");
}

/// parry issue 253: no answer but a panic, of two triangles, one of which has a corner in the plane of the other.
/// In the numbers as they are printed it is just outside.
#[test]
fn a_triangle_on_the_rim_of_another() {
    let flat = points([
        [-13.174_434, 1.0, 8.736_801],
        [3.525_103_8, 1.0, 12.1],
        [3.204_846_6, 1.0, 12.218_325],
    ]);
    let upright =
        points([[-1.63, 0.0, 11.19], [-2.349_647, 0.0, 11.037_681], [-2.349_647, 1.0, 11.037_681]]);
    let (distance, depth) = asked(&flat, Pose::IDENTITY, &upright, Pose::IDENTITY);
    assert!(distance.lower > 2.037e-7 && distance.upper < 2.038e-7, "{distance:?}");
    assert_eq!(depth.bounds(), [0.0; 2]);
}

/// parry issue 75: a point said to be in a triangle that it is 0.15627 away from.
#[test]
fn a_point_beside_a_triangle() {
    let triangle = points([[21.94, 3.7, 0.0], [22.255, 3.7, -0.315], [22.255, 3.5, -0.315]]);
    let point = points([[22.01, 3.7, -0.291]]);
    let (distance, _) = asked(&point, Pose::IDENTITY, &triangle, Pose::IDENTITY);
    assert!((distance.lower - 0.156_270_5).abs() < 1e-6, "{distance:?}");
}

/// openGJK issue 52: 0.0033 for two blocks, far from the origin, that overlap by hundreds.
#[test]
fn blocks_far_out_that_overlap() {
    let block = |[x, y]: [[f32; 4]; 2]| {
        let corner = |k: usize, z: f64| DVec3::new(x[k].into(), y[k].into(), z);
        let all = [300.0, 0.0].map(|z| [0, 1, 2, 3].map(|k| corner(k, z)));
        body(all.as_flattened())
    };
    let one = block([
        [90_945.08, 91_077.46, 91_454.92, 91_322.54],
        [54_122.54, 53_745.082, 53_877.46, 54_254.918],
    ]);
    let two = block([
        [90_919.64, 91_162.62, 91_480.36, 91_237.38],
        [54_037.383, 53_719.637, 53_962.617, 54_280.363],
    ]);
    let (distance, depth) = asked(&one, Pose::IDENTITY, &two, Pose::IDENTITY);
    assert_eq!(distance.bounds(), [0.0; 2]);
    assert!(depth.lower > 299.0, "{:?}", depth.bounds());
}

/// distance3d issue 27: an error, of two hulls of six points.
#[test]
fn two_hulls_of_six_points() {
    let one = points([
        [1.940_898_267_757_529_3, 1.755_563_010_118_602_8, 0.185_583_704_571_386_18],
        [0.832_577_281_180_207_2, 0.073_487_398_817_516_65, 1.736_383_585_583_098_2],
        [0.464_797_962_633_186_6, 0.780_236_465_620_551_4, 0.768_335_243_650_948_5],
        [1.814_784_949_811_168_8, 0.171_065_000_734_661_7, 1.802_196_858_095_821],
        [0.057_423_727_216_105_56, 1.659_900_506_000_528_5, 0.014_474_511_746_654_706],
        [1.527_086_196_650_000_2, 0.494_562_454_016_467_7, 0.716_241_989_455_111_7],
    ]);
    let two = points([
        [0.137_467_279_939_410_66, 0.201_296_361_903_127_72, 0.344_828_183_096_292_15],
        [0.531_522_318_506_499_9, 0.859_293_459_032_485, 0.627_579_591_421_955_9],
        [0.581_008_705_827_466_3, 0.428_715_899_382_559_94, 0.620_131_343_119_703_7],
        [0.483_953_288_485_520_66, 0.357_102_872_725_019_84, 0.275_866_010_140_415_34],
        [0.158_637_771_069_155_1, 0.642_162_004_725_228_4, 0.648_778_898_972_740_1],
        [0.518_519_756_289_535_7, 0.058_044_153_658_207_476, 0.402_026_978_073_723_9],
    ]);
    let (distance, depth) = asked(&one, Pose::IDENTITY, &two, Pose::IDENTITY);
    assert_eq!(distance.lower > 0.0, depth.upper == 0.0);
}
