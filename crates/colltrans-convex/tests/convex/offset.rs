//! Convex bodies made smaller and larger, against all faces and all vertices.

use std::collections::BTreeSet;

use colltrans::Solid;
use colltrans::solid::SolidCast;
use colltrans_convex::{BuildError, Cast, Clearance, ConvexPolyhedron, InputVertex, Pose};
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{
    Mesh, cuboid, of_bits, prism, random_hull, ring_sphere, superellipsoid,
};
use glam::{DMat3, DQuat, DVec3};
use proptest::prelude::*;

use crate::common::body;

/// What is promised of planes, as a share of the largest coordinate.
const PROMISED: f64 = 1.0 / (1_u64 << 40) as f64;

fn size(body: &ConvexPolyhedron) -> f64 {
    body.vertices().iter().map(|v| v.abs().max_element()).fold(0.0, f64::max)
}

/// Outward normal and level of every face: that of the farthest vertex, by looking at all.
fn planes(body: &ConvexPolyhedron) -> Vec<(DVec3, f64)> {
    let plane = |face| {
        let normal = body.face_normal(face);
        (normal, level(body, normal))
    };
    (0..body.face_count() as u32).map(plane).collect()
}

fn level(body: &ConvexPolyhedron, normal: DVec3) -> f64 {
    body.vertices().iter().map(|v| normal.dot(*v)).fold(f64::NEG_INFINITY, f64::max)
}

/// How much a body can be shrunk by, at least.
fn fits(body: &ConvexPolyhedron) -> f64 {
    match body.shrunk(1e3 * size(body)) {
        Err(BuildError::TooThin { fits, .. }) => fits,
        other => panic!("{other:?}"),
    }
}

/// How a corner of three faces moves when their planes move by 1, and whether that is the shortest way:
/// the three normals carry it, none of them pulls.
fn tight(body: &ConvexPolyhedron, vertex: u32) -> Option<DVec3> {
    let faces = (0..body.face_count() as u32)
        .filter(|&f| body.face_vertices(f).any(|v| v == vertex))
        .map(|f| body.face_normal(f));
    let [a, b, c] = faces.collect::<Vec<_>>().try_into().ok()?;
    let rows = DMat3::from_cols(a, b, c).transpose();
    let way = rows.inverse() * DVec3::ONE;
    let carried = rows.transpose().inverse() * way;
    (carried.min_element() > 1e-6).then_some(way)
}

/// Whether a facet at a corner, in any triangulation, may be too low to have a say in how a solid shrinks: less than
/// a millionth of the body's size, with room for rounding.
fn has_sliver(body: &ConvexPolyhedron, vertex: u32) -> bool {
    let size = body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max);
    let at = |v: u32| body.vertices()[v as usize];
    let is_low = |f: u32| {
        let corners: Vec<u32> = body.face_vertices(f).collect();
        let others = corners.iter().flat_map(|&b| corners.iter().map(move |&c| [b, c]));
        others.filter(|[b, c]| *b < *c && *b != vertex && *c != vertex).any(|[b, c]| {
            let (ab, ac) = (at(b) - at(vertex), at(c) - at(vertex));
            let longest = ab.length().max(ac.length()).max((ac - ab).length());
            ab.cross(ac).length() < 4e-6 * size * longest
        })
    };
    (0..body.face_count() as u32)
        .filter(|&f| body.face_vertices(f).any(|v| v == vertex))
        .any(is_low)
}

/// Whether moving has left every edge between the vertices that it was between.
fn same_edges(body: &ConvexPolyhedron, made: &ConvexPolyhedron) -> bool {
    let edges = |of: &ConvexPolyhedron| -> BTreeSet<[InputVertex; 2]> {
        let index = of.input_indices();
        let around = |v: u32| of.neighbours(v).iter().map(move |&w| [v, w]);
        let all = (0..of.vertices().len() as u32).flat_map(around);
        all.map(|ends| ends.map(|v| index[v as usize])).collect()
    };
    made.vertices().len() == body.vertices().len() && edges(made) == edges(body)
}

/// A box whose six faces lean.
fn leaning_box(random: &mut Random) -> ConvexPolyhedron {
    let planes: Vec<(DVec3, f64)> = (0..6)
        .map(|k| {
            let across = [DVec3::X, DVec3::Y, DVec3::Z][k / 2] * [1.0, -1.0][k % 2];
            ((across + random.direction() * 0.25).normalize(), random.range(0.5, 2.0))
        })
        .collect();
    let corner = |k: usize| {
        let [a, b, c] = [k & 1, 2 + (k >> 1 & 1), 4 + (k >> 2)].map(|p| planes[p]);
        DMat3::from_cols(a.0, b.0, c.0).transpose().inverse() * DVec3::new(a.1, b.1, c.1)
    };
    body(&(0..8).map(corner).collect::<Vec<_>>())
}

/// Every vertex lies `inwards` deep below all planes, and faces that did not vanish are as far out as
/// they may be.
fn check(body: &ConvexPolyhedron, inwards: f64) -> ConvexPolyhedron {
    let made = if inwards < 0.0 { body.grown(-inwards) } else { body.shrunk(inwards) };
    let (result, report) = made.expect("an amount");
    let promised = PROMISED * size(body).max(size(&result));
    for (face, (normal, level_before)) in planes(body).into_iter().enumerate() {
        let off = level(&result, normal) - (level_before - inwards);
        assert!(off <= promised, "face {face} is {off:e} outside, {promised:e} promised");
        let stays = report.vanished.binary_search(&(face as u32)).is_err();
        assert!(!stays || off >= -promised, "face {face} is {:e} inside, {promised:e}", -off);
    }
    for (k, v) in result.vertices().iter().enumerate() {
        let source = body.input_indices().iter().position(|i| *i == result.input_indices()[k]);
        let source = body.vertices()[source.expect("a vertex of the body")];
        assert!(v.distance(source) <= report.farthest * (1.0 + 1e-12) + promised);
    }
    result
}

fn bodies(random: &mut Random) -> Vec<Mesh> {
    let mut found = vec![
        cuboid(DVec3::ONE),
        cuboid(DVec3::new(1.0, 2.0, 0.01)),
        prism(3, 1.0),
        prism(7, 0.2),
        prism(64, 10.0),
        prism(1_000, 0.7),
        ring_sphere(12, 7),
        ring_sphere(40, 31),
        superellipsoid(300, 4.0),
    ];
    for n in [4, 5, 6, 8, 12, 30, 100, 1_000] {
        found.push(random_hull(n, random));
    }
    found
}

fn placings(random: &mut Random) -> Vec<(DVec3, DQuat, DVec3)> {
    let turn = |random: &mut Random| {
        DQuat::from_rotation_arc(DVec3::Z, random.direction())
            * DQuat::from_rotation_z(random.direction().x)
    };
    let mut found = vec![(DVec3::ONE, DQuat::IDENTITY, DVec3::ZERO)];
    for stretch in [
        DVec3::ONE,
        DVec3::new(1.0, 1.0, 1e-3),
        DVec3::new(1.0, 1.0, 1e3),
        DVec3::new(1.0, 1e-2, 1e2),
        DVec3::splat(1e-40),
        DVec3::splat(1e50),
    ] {
        found.push((stretch, turn(random), random.direction() * stretch.max_element()));
    }
    found.push((DVec3::ONE, turn(random), DVec3::new(100.0, -300.0, 50.0)));
    found
}

#[test]
#[ignore = "long: every plane of many bodies in many places"]
fn planes_move_by_the_amount_and_no_farther() {
    let mut random = Random::new(11);
    for mesh in bodies(&mut random) {
        for (stretch, turn, by) in placings(&mut random) {
            let placed: Vec<DVec3> =
                mesh.vertices.iter().map(|v| turn * (*v * stretch) + by).collect();
            let body = body(&placed);
            let room = fits(&body);
            for share in [1e-6, 0.01, 0.3, 0.9] {
                check(&body, share * room);
            }
            for share in [1e-6, 0.1, 1.0, 100.0] {
                check(&body, -share * room);
            }
        }
    }
}

/// Every corner of the moved planes, by all triples of them, lies in the body, and the other way round;
/// triples that are nearly parallel to a line have a corner that rounding cannot place.
fn check_by_triples(body: &ConvexPolyhedron, inwards: f64) {
    let result = check(body, inwards);
    let moved: Vec<(DVec3, f64)> =
        planes(body).into_iter().map(|(n, level)| (n, level - inwards)).collect();
    let faces = planes(&result);
    let scale = size(&result).max(size(body));
    let (mut corners, mut sharp) = (0, 0);
    for i in 0..moved.len() {
        for j in 0..i {
            for k in 0..j {
                let [(a, p), (b, q), (c, r)] = [moved[i], moved[j], moved[k]];
                let volume = a.dot(b.cross(c));
                if volume.abs() < 1e-3 {
                    sharp += 1;
                    continue;
                }
                let corner = (b.cross(c) * p + c.cross(a) * q + a.cross(b) * r) / volume;
                if moved.iter().all(|(n, level)| n.dot(corner) <= level + 1e-13 * scale) {
                    corners += 1;
                    let off = faces.iter().map(|(n, level)| n.dot(corner) - level);
                    let off = off.fold(f64::NEG_INFINITY, f64::max);
                    assert!(off < 1e-8 * scale, "a corner is {off:e} outside");
                }
            }
        }
    }
    assert!(corners + sharp >= 4);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(64)))]

    #[test]
    fn small_bodies_are_the_intersection_of_their_moved_half_spaces(
        n in 4_usize..14,
        seed in any::<u64>(),
        share in -2.0..0.95_f64,
    ) {
        let body = body(&random_hull(n, &mut Random::new(seed)).vertices);
        check_by_triples(&body, share * fits(&body));
    }

    /// Near the largest amount there is; what a body that is refused holds is said to half.
    #[test]
    fn the_largest_ball_decides(n in 4_usize..40, seed in any::<u64>()) {
        let body = body(&random_hull(n, &mut Random::new(seed)).vertices);
        let (mut low, mut high) = (fits(&body), 2.001 * fits(&body));
        prop_assert!(body.shrunk(low * 0.999).is_ok() && body.shrunk(high).is_err());
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            match body.shrunk(middle) {
                Ok(_) => {
                    check(&body, middle);
                    low = middle;
                }
                Err(BuildError::TooThin { fits, .. }) => {
                    prop_assert!(fits <= low + (high - low) + 1e-12);
                    high = middle;
                }
                Err(other) => panic!("{other}"),
            }
        }
        // No ball of that radius fits: four planes hold the largest one from all sides.
        let moved: Vec<(DVec3, f64)> =
            planes(&body).into_iter().map(|(n, level)| (n, level - high)).collect();
        let last = body.shrunk(low).expect("it fits").0;
        let middle = last.vertices().iter().sum::<DVec3>() / last.vertices().len() as f64;
        let around: Vec<DVec3> = moved
            .iter()
            .filter(|(n, level)| n.dot(middle) > level - 1e-3 * high)
            .map(|(n, _)| *n)
            .collect();
        prop_assert!(around.len() >= 2);
        let held = |d: DVec3| around.iter().any(|n| n.dot(d) > -1e-3);
        let mut random = Random::new(seed ^ 1);
        prop_assert!((0..200).all(|_| held(random.direction())));
    }

    /// Corners of three faces, where nothing pulls, move to where those of the solid do.
    #[test]
    fn solids_move_alike_where_three_faces_meet(
        n in 5_usize..40,
        seed in any::<u64>(),
        share in 1e-6..0.01_f64,
        grows in any::<bool>(),
    ) {
        let rough = body(&random_hull(n, &mut Random::new(seed)).vertices);
        let body = body(rough.grown(0.5).expect("an amount").0.vertices());
        prop_assume!(body.input_indices().iter().copied().eq((0..body.vertices().len() as u32).map(InputVertex)));
        let amount = share * fits(&body);
        let solid = Solid::from_convex(&body).expect("a body");
        let ((made, report), (same, said)) = if grows {
            (body.grown(amount).expect("an amount"), solid.grown(amount).expect("an amount"))
        } else {
            (body.shrunk(amount).expect("an amount"), solid.shrunk(amount).expect("an amount"))
        };
        prop_assume!(report.vanished.is_empty() && same_edges(&body, &made));
        prop_assume!(said.fixed_vertices.is_empty());
        let mut compared = 0;
        for (v, &from) in made.vertices().iter().zip(made.input_indices()) {
            let Some(way) = tight(&body, from.0) else { continue };
            if has_sliver(&body, from.0) {
                continue;
            }
            // Rounding of planes moves a corner the farther the sharper it is.
            let apart = v.distance(same.vertices()[from.index()]);
            let sharpness = way.length_squared();
            prop_assert!(apart < 1e-12 * sharpness, "{apart:e}, sharpness {sharpness}");
            compared += 1;
        }
        prop_assert!(compared > 0 || n < 20);
    }

    /// A cast of shrunk bodies is the clearance of the same as solids with the tolerance.
    #[test]
    fn casts_of_shrunk_bodies_are_clearances_with_a_tolerance(
        seed in any::<u64>(),
        tolerance in 1e-6..0.05_f64,
    ) {
        let mut random = Random::new(seed);
        let bodies = [leaning_box(&mut random), leaning_box(&mut random)];
        let start = random.direction() * 20.0;
        let direction = random.direction() * 0.2 - start * 0.05;
        let compared = compare_shrunk(&bodies, start, direction, tolerance);
        prop_assume!(compared.map_err(TestCaseError::fail)?);
    }
}

/// Whether a cast of shrunk bodies is the clearance of the same as solids with the tolerance; nothing is
/// compared where shrinking loses an edge.
fn compare_shrunk(
    bodies: &[ConvexPolyhedron; 2],
    start: DVec3,
    direction: DVec3,
    tolerance: f64,
) -> Result<bool, String> {
    let start = Pose::from_translation(start).expect("in range");
    let shrunk = bodies.each_ref().map(|b| b.shrunk(tolerance / 2.0).expect("it fits").0);
    for (body, made) in bodies.iter().zip(&shrunk) {
        let all = (0..body.vertices().len() as u32).all(|v| tight(body, v).is_some());
        if !all || !same_edges(body, made) {
            return Ok(false);
        }
    }
    let solids = Cast::between(bodies[0].at(start), bodies[1].at(Pose::IDENTITY), direction)
        .and_then(|c| c.with_tolerance(tolerance))
        .and_then(|c| c.clearance())
        .expect("an answer");
    let cast = Cast::new(shrunk[0].at(start), shrunk[1].at(Pose::IDENTITY), direction)
        .expect("a direction");
    match (cast.clearance().expect("an answer"), solids) {
        (Clearance::Blocked { contact, .. }, Clearance::Blocked { contact: other, .. }) => {
            let [one, other] = [contact.translation, other.offset_distance.value];
            let both = contact.certificate.rounding + 1e-9;
            if (one - other).abs() < both { Ok(true) } else { Err(format!("{one} and {other}")) }
        }
        (Clearance::Free(_), Clearance::Free(_)) => Ok(true),
        (a, b) => Err(format!("{a:?} and {b:?}")),
    }
}

/// A case that was wrong once.
#[test]
fn a_saved_cast_of_shrunk_bodies_is_a_clearance_with_a_tolerance() {
    let moving = of_bits(&[
        [0x3fe5_f64d_b81e_1714, 0x3fe0_ccb6_ca6e_7e17, 0x3fe6_b18b_e0d4_6547],
        [0xbfe5_6713_d793_ecd5, 0x3fe9_f01f_9bc8_4007, 0x3fee_db37_fa16_1574],
        [0x3fe7_b61e_07ac_4b7e, 0xbff0_89a0_3c9f_c169, 0x3fde_1bb1_9f18_558d],
        [0xbfef_045f_91b6_6fea, 0xbfec_b06b_109d_d915, 0x3fe8_4cf3_bc6c_ff0a],
        [0x3ff3_ee99_b96a_d20e, 0x3fe6_247e_f59a_e9d5, 0xbfff_096a_fd71_d7b9],
        [0xbfe5_b65f_498a_f2ca, 0x3ff1_af0c_98e3_ab4b, 0xbffa_5a4c_681d_da4c],
        [0x3ff5_1f94_33ef_505c, 0xbffb_bcee_b82e_8605, 0xc002_16bf_72c7_145a],
        [0xbff2_576c_087c_2cbd, 0xbff8_eba8_e62c_1e1a, 0xbffe_e6cc_34d1_4783],
    ]);
    let fixed = of_bits(&[
        [0x3ff1_d96a_69c2_13c7, 0x3ff2_7a1e_efef_9e62, 0x3fe8_0487_21a9_fcf3],
        [0xbff3_35cd_3d9c_cc2e, 0x3ff4_dbe2_5ba5_bdb6, 0x3ff2_4389_b244_bb23],
        [0x3fe9_051e_2e7b_62ca, 0xbff2_bdee_4381_cba0, 0x3ff3_15f5_dadd_f528],
        [0xbff1_e172_2097_2af6, 0xbfe7_914a_622f_3746, 0x3ff7_646e_5ec9_db1f],
        [0x3fe6_498c_3be9_3a84, 0x3fdf_d451_ad4e_6ff3, 0xc000_2be0_bd00_cc5f],
        [0xc000_92b4_7932_bf7d, 0x3fe0_23d1_871c_e248, 0xc002_1c8b_96d2_3a18],
        [0x3fdd_389c_14db_266e, 0xbff1_c80e_e11c_b34e, 0xbffc_c034_6b62_89a5],
        [0xc000_3bb4_5d2d_5608, 0xbfe1_7365_8708_06fb, 0xc000_ccfa_1a7e_3e41],
    ]);
    let placed = of_bits(&[
        [0xc023_855f_2f52_60b0, 0x401e_6e4e_93f7_a16a, 0xc02f_6c5a_fdc3_d27b],
        [0x3fd8_e209_7841_6c6a, 0xbfd0_967f_372e_a4b4, 0x3fed_1e33_5fc0_41c3],
    ]);
    let bodies = [body(&moving), body(&fixed)];
    assert_eq!(compare_shrunk(&bodies, placed[0], placed[1], 1e-6), Ok(true));
}

#[test]
fn boxes_prisms_and_the_solids_of_them() {
    let mut random = Random::new(5);
    for mesh in
        [cuboid(DVec3::ONE), cuboid(DVec3::new(1.0, 2.0, 30.0)), prism(3, 1.0), prism(9, 0.5)]
    {
        let turn = DQuat::from_rotation_arc(DVec3::Z, random.direction());
        let body = body(&mesh.vertices.iter().map(|v| turn * *v).collect::<Vec<_>>());
        let solid = Solid::from_convex(&body).expect("a body");
        for amount in [1e-3, 0.1, 0.24] {
            let pairs = [
                (
                    body.shrunk(amount).expect("it fits").0,
                    solid.shrunk(amount).expect("an amount").0,
                ),
                (
                    body.grown(amount).expect("an amount").0,
                    solid.grown(amount).expect("an amount").0,
                ),
            ];
            for (made, same) in pairs {
                assert_eq!(made.vertices().len(), same.vertices().len());
                for (v, from) in made.vertices().iter().zip(made.input_indices()) {
                    let apart = v.distance(same.vertices()[from.index()]);
                    assert!(apart < 1e-13 * size(&body), "{apart:e}");
                }
                assert!((made.volume() - same.volume()).abs() < 1e-12 * made.volume());
            }
        }
    }
}

#[test]
fn faces_too_small_to_stay_vanish() {
    // A cube with one corner cut off a little: shrunk, the cut stays; grown, the corner does not
    // come back; a roof whose ridge face is narrow loses it.
    let mut corners = cuboid(DVec3::ONE).vertices;
    corners.retain(|v| *v != DVec3::ONE);
    corners.extend([DVec3::X, DVec3::Y, DVec3::Z].map(|e| DVec3::ONE - e * 0.1));
    let cut = body(&corners);
    assert_eq!(cut.face_count(), 7);
    for amount in [0.01, 0.1, 0.5] {
        assert_eq!(cut.grown(amount).expect("an amount").0.face_count(), 7);
    }
    // The cut is 0.1 / sqrt(3) below the corner, which moves by sqrt(3) - 1 more than the cut does.
    let gone = 0.1 / 3.0_f64.sqrt() / (3.0_f64.sqrt() - 1.0);
    let report = |amount| cut.shrunk(amount).expect("it fits").1;
    assert!(report(0.999 * gone).vanished.is_empty());
    let lost = report(1.001 * gone).vanished;
    assert_eq!(lost.len(), 1);
    let normal = cut.face_normal(lost[0]);
    assert!((normal - DVec3::ONE / 3.0_f64.sqrt()).length() < 1e-12);
    assert_eq!(cut.shrunk(1.001 * gone).expect("it fits").0.vertices().len(), 8);
}

#[test]
fn bodies_too_thin_are_refused_and_say_what_would_fit() {
    let plate = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(8.0, 3.0, 1.0)).expect("a box");
    for amount in [0.5, 0.5 + 1e-15, 0.6, 5.0, 1e40] {
        let Err(BuildError::TooThin { amount: said, fits }) = plate.shrunk(amount) else {
            panic!("{amount}")
        };
        assert_eq!(said, amount);
        assert!((0.25 - 1e-12..=0.5 + 1e-12).contains(&fits), "{fits}");
    }
    let sliver = check(&plate, 0.5 - 1e-9);
    assert!((sliver.volume() / (7.0 * 2.0 * 2e-9) - 1.0).abs() < 1e-5, "{}", sliver.volume());
    for amount in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(plate.shrunk(amount), Err(BuildError::Amount { .. })));
        assert!(matches!(plate.grown(amount), Err(BuildError::Amount { .. })));
    }
    for amount in [1e61, 1e77, 1e300] {
        let Err(BuildError::Amount { amount: told }) = plate.grown(amount) else {
            panic!("grown by {amount}")
        };
        assert_eq!(told, amount);
    }
}

#[test]
fn bodies_of_lower_dimension() {
    let point = body(&[DVec3::ONE]);
    let segment = body(&[DVec3::ZERO, DVec3::X]);
    let square = body(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y]);
    for body in [&point, &segment, &square] {
        assert!(matches!(body.shrunk(0.1), Err(BuildError::TooThin { fits: 0.0, .. })));
        assert_eq!(body.shrunk(0.0).expect("itself").0.vertices(), body.vertices());
        assert_eq!(body.grown(0.0).expect("itself").0.vertices(), body.vertices());
    }
    for (body, dimension) in [(&point, 0), (&segment, 1)] {
        let refused = body.grown(0.1).expect_err("no faces");
        assert_eq!(refused, BuildError::NothingToMove { dimension });
    }
    let mut random = Random::new(3);
    for amount in [1e-6, 0.25, 50.0] {
        let turn = DQuat::from_rotation_arc(DVec3::Z, random.direction());
        let turned = body(&square.vertices().iter().map(|v| turn * *v).collect::<Vec<_>>());
        let plate = turned.grown(amount).expect("an amount").0;
        let side = 1.0 + 2.0 * amount;
        assert!((plate.volume() / (side * side * 2.0 * amount) - 1.0).abs() < 1e-9);
        assert_eq!((plate.vertices().len(), plate.face_count()), (8, 6));
        // Everything within the amount is in it.
        for _ in 0..100 {
            let out = random.direction();
            assert!(level(&plate, out) >= level(&turned, out) + amount * (1.0 - 1e-12));
        }
    }
}

#[test]
#[ignore = "long: 100,000 vertices"]
fn large_bodies_shrink_and_grow() {
    let body = body(&random_hull(100_000, &mut Random::new(9)).vertices);
    let made = [body.shrunk(0.1).expect("it fits"), body.grown(0.1).expect("an amount")];
    assert!(made[0].0.volume() < body.volume() && body.volume() < made[1].0.volume());
    // Grown, all vertices of more than three faces are split.
    assert!(made[1].0.vertices().len() > body.face_count() / 2);
}
