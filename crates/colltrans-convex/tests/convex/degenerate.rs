//! Bodies of lower dimension, and bodies that are almost so.

use std::mem::discriminant;

use colltrans_convex::{Cast, Outcome, Pose, Solver};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::check::Judge;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::cuboid;
use glam::{DQuat, DVec3};

use crate::common::body;

/// The outcome, the same from all solvers and approved by the oracle.
fn cast(moving: &[DVec3], fixed: &[DVec3], offset: DVec3, direction: DVec3) -> Outcome {
    let (moving, fixed) = (body(moving), body(fixed));
    let pose = Pose::from_translation(offset).expect("a pose");
    let world = Pose::IDENTITY;
    let cast = Cast::new(moving.at(world), fixed.at(pose), direction).expect("a query");
    let judge = Judge::new(cast);
    let outcomes = [Solver::Cta, Solver::Portal, Solver::Auto].map(|solver| {
        let outcome =
            cast.with_solver(solver).first_contact().unwrap_or_else(|e| panic!("{solver:?}: {e}"));
        judge.check(&outcome).unwrap_or_else(|e| panic!("{solver:?}: {e}"));
        judge.compare_with_oracle(&outcome).unwrap_or_else(|e| panic!("{solver:?}: {e}"));
        outcome
    });
    outcomes[0]
}

/// What touches, upwards.
fn touching(moving: &[DVec3], fixed: &[DVec3], offset: DVec3) -> [&'static str; 2] {
    let (moving, fixed) = (body(moving), body(fixed));
    let pose = Pose::from_translation(offset).expect("a pose");
    let cast = Cast::new(moving.at(Pose::IDENTITY), fixed.at(pose), DVec3::Z).expect("a query");
    let outcome = cast.first_contact().expect("an answer");
    let Outcome::Contact(contact) = outcome else { panic!("{outcome:?}") };
    let features = contact.features(&cast);
    [features.moving.kind(), features.fixed.kind()]
}

fn translation(outcome: &Outcome) -> f64 {
    match outcome {
        Outcome::Contact(contact) => contact.translation,
        Outcome::Grazing(grazing) => grazing.contact.translation,
        Outcome::Separated(_) => panic!("separated"),
    }
}

const POINT: [DVec3; 1] = [DVec3::ZERO];
const SEGMENT: [DVec3; 2] = [DVec3::NEG_X, DVec3::X];
const CROSSING: [DVec3; 2] = [DVec3::NEG_Y, DVec3::Y];
const TRIANGLE: [DVec3; 3] = [DVec3::NEG_X, DVec3::X, DVec3::Y];

#[test]
fn dimensions_are_recognised() {
    let line = [DVec3::ZERO, DVec3::ONE, DVec3::ONE * 3.0, DVec3::ONE * 2.0];
    let square = cuboid(DVec3::new(1.0, 2.0, 0.0)).vertices;
    let expected: [(&[DVec3], u8, usize, usize); 6] = [
        (&POINT, 0, 1, 0),
        (&[DVec3::ONE; 5], 0, 1, 0),
        (&line, 1, 2, 0),
        (&TRIANGLE, 2, 3, 2),
        (&square, 2, 4, 2),
        (&cuboid(DVec3::ONE).vertices, 3, 8, 6),
    ];
    for (points, dimension, vertices, faces) in expected {
        let body = body(points);
        let found = (body.dimension(), body.vertices().len(), body.face_count());
        assert_eq!(found, (dimension, vertices, faces), "{points:?}");
    }
}

#[test]
fn point_onto_point() {
    let hit = cast(&POINT, &POINT, DVec3::Z * 3.0, DVec3::Z);
    assert!(matches!(hit, Outcome::Grazing(_)), "{hit:?}");
    assert!((translation(&hit) - 3.0).abs() < 1e-13);
    let miss = cast(&POINT, &POINT, DVec3::new(1e-9, 0.0, 3.0), DVec3::Z);
    assert!(matches!(miss, Outcome::Separated(_)), "{miss:?}");
}

#[test]
fn point_onto_solid() {
    let cube = cuboid(DVec3::ONE).vertices;
    let hit = cast(&POINT, &cube, DVec3::new(0.25, 0.5, 4.0), DVec3::Z);
    let Outcome::Contact(contact) = hit else { panic!("{hit:?}") };
    assert!((contact.translation - 3.0).abs() <= contact.certificate.rounding);
    let kinds = touching(&POINT, &cube, DVec3::new(0.25, 0.5, 4.0));
    assert_eq!(kinds, ["vertex", "face"]);
}

#[test]
fn crossing_segments() {
    let hit = cast(&SEGMENT, &CROSSING, DVec3::new(0.25, 0.5, 2.0), DVec3::Z);
    let Outcome::Contact(contact) = hit else { panic!("{hit:?}") };
    assert!((contact.translation - 2.0).abs() <= contact.certificate.rounding);
    assert_eq!(touching(&SEGMENT, &CROSSING, DVec3::new(0.25, 0.5, 2.0)), ["edge", "edge"]);
    let miss = cast(&SEGMENT, &CROSSING, DVec3::new(1.25, 0.5, 2.0), DVec3::Z);
    assert!(matches!(miss, Outcome::Separated(_)), "{miss:?}");
}

#[test]
fn parallel_and_collinear_segments() {
    let above = cast(&SEGMENT, &SEGMENT, DVec3::Z, DVec3::Z);
    assert!(matches!(above, Outcome::Grazing(_)), "{above:?}");
    assert!((translation(&above) - 1.0).abs() < 1e-13);
    // Along themselves: the shadow is a point.
    let behind = cast(&SEGMENT, &SEGMENT, DVec3::X * 5.0, DVec3::X);
    assert!((translation(&behind) - 3.0).abs() < 1e-13);
    let beside = cast(&SEGMENT, &SEGMENT, DVec3::new(5.0, 1e-3, 0.0), DVec3::X);
    assert!(matches!(beside, Outcome::Separated(_)), "{beside:?}");
}

#[test]
fn triangles_edge_on_and_face_on() {
    let face_on = cast(&TRIANGLE, &TRIANGLE, DVec3::new(0.1, 0.1, 2.0), DVec3::Z);
    let Outcome::Contact(contact) = face_on else { panic!("{face_on:?}") };
    assert!((contact.translation - 2.0).abs() <= contact.certificate.rounding);
    let edge_on = cast(&TRIANGLE, &TRIANGLE, DVec3::new(0.0, 4.0, 0.0), DVec3::Y);
    assert!(matches!(edge_on, Outcome::Grazing(_)), "{edge_on:?}");
    let knife = cast(&TRIANGLE, &cuboid(DVec3::ONE).vertices, DVec3::new(0.0, 4.0, 0.0), DVec3::Y);
    let Outcome::Contact(contact) = knife else { panic!("{knife:?}") };
    assert!((contact.translation - 2.0).abs() <= contact.certificate.rounding);
}

/// Slabs that become thinner and thinner until they are flat.
#[test]
fn thin_slabs() {
    let mut rng = Random::new(5);
    for thickness in [1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-18, 1e-30, 0.0] {
        for _ in 0..20 {
            let rotation = rng.rotation();
            let slab: Vec<DVec3> = cuboid(DVec3::new(1.0, 1.0, thickness))
                .vertices
                .into_iter()
                .map(|v| rotation * v)
                .collect();
            let offset = rng.vector() * 0.2 + DVec3::Z * 5.0;
            let outcome = cast(&slab, &cuboid(DVec3::ONE).vertices, offset, DVec3::Z);
            assert!(matches!(outcome, Outcome::Contact(_)), "{thickness:e}: {outcome:?}");
        }
    }
}

/// Shadows about as wide as rounding errors: few portals have a plane, and exact sides of the line
/// contradict rounded ones; still each cast has an answer, and the same from both solvers, but where rounding
/// can just not tell whether the bodies pass each other: then one may prove that they do.
#[test]
fn shadows_as_wide_as_rounding() {
    let mut differ = 0;
    for seed in 0..cases(30_000) {
        let mut rng = Random::new(seed);
        let mut needle = [0; 4].map(|_| rng.vector());
        needle[0].z = -10.0_f64.powf(rng.range(10.0, 16.0));
        let block = [0; 5].map(|_| rng.vector());
        let offset = rng.vector() * DVec3::new(1.0, 1.0, 5.0);
        if seed % 50 == 0 {
            cast(&needle, &block, offset, DVec3::Z);
            continue;
        }
        let (moving, fixed) = (body(&needle), body(&block));
        let pose = Pose::from_translation(offset).expect("a pose");
        let cast = Cast::new(moving.at(Pose::IDENTITY), fixed.at(pose), DVec3::Z).expect("a query");
        let outcomes = [Solver::Cta, Solver::Portal].map(|solver| {
            let outcome = cast.with_solver(solver).first_contact();
            outcome.unwrap_or_else(|e| panic!("{seed}, {solver:?}: {e}"))
        });
        match &outcomes {
            [Outcome::Separated(passed), Outcome::Grazing(near)]
            | [Outcome::Grazing(near), Outcome::Separated(passed)]
                if near.overlap <= 0.0 =>
            {
                assert!(cast.verify(&passed.certificate).is_ok(), "{seed}");
                differ += 1;
            }
            [a, b] => assert_eq!(discriminant(a), discriminant(b), "{seed}"),
        }
    }
    assert!(differ < 10, "{differ}");
}

/// Many points in one plane that contains the direction, and the line as near to it as rounding: exact
/// portals that are rounded to the other side.
#[test]
fn lines_in_upright_planes() {
    for seed in 0..cases(20_000) {
        let mut rng = Random::new(seed);
        let turn = rng.rotation();
        let mut fan: Vec<DVec3> = (0..rng.int(6, 40))
            .map(|_| rng.range(0.0, std::f64::consts::TAU))
            .map(|angle_rad| DVec3::new(angle_rad.cos(), 0.0, angle_rad.sin()))
            .collect();
        for side in [-1.0, 1.0] {
            let beside = side * 10.0_f64.powf(rng.range(-13.0, -2.0));
            fan.push(DVec3::new(rng.range(-1.2, 1.2), beside, rng.range(-0.8, 0.8)));
        }
        let off = rng.range(-1.0, 1.0) * 10.0_f64.powf(rng.range(-18.0, -14.0));
        let at = DVec3::new(rng.range(-0.9, 0.9), off, 3.0);
        let fan: Vec<DVec3> = fan.into_iter().map(|v| turn * (v + at)).collect();
        if seed % 20 == 0 {
            cast(&POINT, &fan, DVec3::ZERO, turn * DVec3::Z);
            continue;
        }
        let (point, fan) = (body(&POINT), body(&fan));
        let cast = Cast::new(point.at(Pose::IDENTITY), fan.at(Pose::IDENTITY), turn * DVec3::Z)
            .expect("a query");
        for solver in [Solver::Cta, Solver::Portal] {
            let outcome = cast.with_solver(solver).first_contact();
            let outcome = outcome.unwrap_or_else(|e| panic!("{seed}, {solver:?}: {e}"));
            let proven = match &outcome {
                Outcome::Contact(contact) => cast.verify(&contact.certificate),
                Outcome::Grazing(grazing) => cast.verify(&grazing.contact.certificate),
                Outcome::Separated(separated) => cast.verify(&separated.certificate),
            };
            proven.unwrap_or_else(|e| panic!("{seed}, {solver:?}: {e}, {outcome:?}"));
        }
    }
}

/// Portals that rounding turns over in every frame.
#[test]
fn portals_turned_over() {
    let settings = [
        (
            [0.285_051_439_507_732_1, 0.947_668_157_945_216_4, 0.143_773_221_607_120_58],
            [
                [0.712_109_279_635_911_4, 1.893_938_746_570_692_5, 0.625_457_840_171_806_3],
                [0.712_925_700_108_005_8, 2.632_020_154_678_927, 0.212_318_653_031_609_68],
                [0.956_015_477_801_933_7, 1.690_598_689_902_075_5, 1.318_848_059_958_354_7],
                [1.245_310_807_672_668_7, 1.741_049_957_044_611_4, 1.977_267_295_881_618_2],
                [1.482_143_467_427_470_7, 3.167_969_842_271_110_4, 1.737_049_928_048_41],
            ],
        ),
        (
            [-0.232_505_845_981_131_91, 0.207_030_429_429_782_23, -0.950_304_915_737_427_1],
            [
                [-0.733_887_723_847_131_5, 0.600_890_745_616_369_6, -3.119_353_802_114_064_3],
                [-1.129_977_038_327_081_3, 2.172_769_043_866_784_6, -1.961_055_016_230_361_5],
                [-0.600_908_318_728_927_7, 0.501_199_748_132_012_4, -2.533_198_352_797_435_3],
                [-1.426_548_180_734_663_2, 2.588_422_458_238_442_7, -2.827_939_485_207_488],
                [-1.072_709_137_729_882_7, 1.864_628_294_249_350_4, -2.312_745_945_501_597],
            ],
        ),
    ];
    for (direction, corners) in settings {
        let corners = corners.map(DVec3::from_array);
        let outcome = cast(&POINT, &corners, DVec3::ZERO, DVec3::from_array(direction));
        assert!(matches!(outcome, Outcome::Contact(_)), "{outcome:?}");
    }
}

/// The contact of a body with itself, moved by nothing.
#[test]
fn a_body_and_itself() {
    let mut rng = Random::new(6);
    for _ in 0..20 {
        let points: Vec<DVec3> = (0..10).map(|_| rng.vector()).collect();
        let direction = rng.direction();
        let outcome = cast(&points, &points, DVec3::ZERO, direction);
        assert!(translation(&outcome) < 0.0);
    }
}

/// Very small and very large bodies.
#[test]
fn magnitudes_at_the_limits() {
    let turn = DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5);
    for exponent in [-190, -100, 0, 100, 190] {
        let size = 2.0_f64.powi(exponent);
        let cube: Vec<DVec3> =
            cuboid(DVec3::splat(size)).vertices.into_iter().map(|v| turn * v).collect();
        let outcome = cast(&cube, &cube, DVec3::new(0.25, 0.5, 5.0) * size, DVec3::Z * size);
        let error = (translation(&outcome) - 3.0).abs();
        assert!(error < 1e-13, "2^{exponent}: {error:e}");
    }
}

/// A polygon with corners on a circle, or anywhere on an ellipse, as the ends of a prism.
fn prism(corners: u32, radii: [f64; 2], rng: Option<&mut Random>) -> Vec<DVec3> {
    let mut angles_rad: Vec<f64> =
        (0..corners).map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(corners)).collect();
    if let Some(rng) = rng {
        for angle_rad in &mut angles_rad {
            *angle_rad = rng.range(0.0, std::f64::consts::TAU);
        }
    }
    let corner = |z: f64| move |a: &f64| DVec3::new(radii[0] * a.cos(), radii[1] * a.sin(), z);
    angles_rad.iter().map(corner(-0.5)).chain(angles_rad.iter().map(corner(0.5))).collect()
}

#[test]
fn prisms_stand_on_prisms() {
    let mut rng = Random::new(5);
    let mut at_once = 0;
    for case in 0..400 {
        let ends = [9, 12, 24, 25, 31].map(|n| n + (case % 3));
        let mut any = |k: u32| {
            let n = ends[(case + k) as usize % ends.len()];
            let radii = [rng.range(0.5, 1.5), rng.range(0.5, 1.5)];
            if case % 2 == 0 { prism(n, radii, None) } else { prism(n, radii, Some(&mut rng)) }
        };
        let (below, above) = (body(&any(0)), body(&any(case % 5)));
        // Centred, by quarters, and anywhere.
        let place = |rng: &mut Random| match case % 3 {
            0 => 0.0,
            1 => 0.25 * (rng.range(-4.0, 4.0)).round(),
            _ => rng.range(-1.0, 1.0),
        };
        let offset = DVec3::new(place(&mut rng), place(&mut rng), 3.0);
        let turn = if case % 4 < 2 { DQuat::IDENTITY } else { rng.rotation() };
        let pose = |offset| Pose::new(turn, turn * offset).expect("a pose");
        let (up, down) = (pose(offset), pose(DVec3::ZERO));
        let cast = Cast::new(above.at(up), below.at(down), turn * DVec3::NEG_Z).expect("a query");
        let judge = Judge::new(cast);
        for solver in [Solver::Cta, Solver::Portal] {
            let cast = cast.with_solver(solver);
            let outcome = cast.first_contact().unwrap_or_else(|e| panic!("case {case}: {e}"));
            judge.check(&outcome).unwrap_or_else(|e| panic!("case {case}: {e}"));
            if let Outcome::Contact(contact) = outcome {
                assert!((contact.translation - 2.0).abs() < 1e-13, "case {case}: {contact:?}");
                let once = contact.steps.supports == 1 && solver == Solver::Portal;
                at_once += u32::from(once);
            }
        }
    }
    assert!(at_once > 200, "{at_once} answered by the faces");
}
