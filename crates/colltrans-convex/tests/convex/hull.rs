//! The hull against brute force, on what other hulls get wrong.

use colltrans_convex::{
    BuildError, Cast, ConvexPolyhedron, InputVertex, Outcome, Pose, TopologyError, convexity_defect,
};
use colltrans_testkit::oracle::input;
use colltrans_testkit::oracle::settings::{NEARLY_FLAT, narrow_rings, setting};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, block, cone, grid, of_bits, prism, ring, ring_points};
use glam::DVec3;
use proptest::prelude::*;

use crate::common::faces;

fn face_sizes(body: &ConvexPolyhedron) -> Vec<usize> {
    let mut sizes: Vec<usize> = faces(body).iter().map(Vec::len).collect();
    sizes.sort_unstable();
    sizes
}

fn assert_box(points: &[DVec3], what: &str) {
    let body = ConvexPolyhedron::from_points(points).unwrap();
    assert_eq!(body.dimension(), 3, "{what}");
    assert_eq!(face_sizes(&body), [4; 6], "{what}");
    assert_eq!(body.vertices().len(), 8, "{what}");
    check(&body, points);
}

/// Euler's formula, and every input point within the reported error of every face.
fn check(body: &ConvexPolyhedron, points: &[DVec3]) {
    let size = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    assert!(body.hull_error() <= 1e-13 * size, "hull error {:e} of {size}", body.hull_error());
    for (k, input) in body.input_indices().iter().enumerate() {
        assert_eq!(body.vertices()[k], points[input.index()]);
    }
    if body.dimension() < 3 {
        return;
    }
    let euler = body.vertices().len() as i64 - body.edge_count() as i64 + body.face_count() as i64;
    assert_eq!(euler, 2);
    for face in 0..body.face_count() as u32 {
        let corners: Vec<DVec3> =
            body.face_vertices(face).map(|v| body.vertices()[v as usize]).collect();
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let normal = body.face_normal(face);
        for p in points {
            let outside = normal.dot(*p - middle);
            assert!(outside <= body.hull_error() + 1e-14 * size, "{outside:e} outside face {face}");
        }
    }
}

/// Rims with chamfers, with points inside and points on the rim's chords: what a fan of many triangles sees.
#[test]
fn rims_with_chamfers_keep_their_corners() {
    let mut random = Random::new(21);
    for round in 0..24 {
        let (chamfer, rotation) = ([1e-1, 1e-2, 1e-4][round % 3], random.rotation());
        let rings =
            [(1.0 - chamfer, 0.0), (1.0, chamfer), (1.0, 1.0 - chamfer), (1.0 - chamfer, 1.0)];
        let mut points: Vec<DVec3> =
            rings.into_iter().flat_map(|(r, z)| ring(60, r, z)).map(|p| rotation * p).collect();
        let corners = points.len();
        for _ in 0..100 {
            let [a, b] = [0, 1].map(|_| points[random.range(0.0, corners as f64) as usize]);
            points.push(a.lerp(b, [0.5, 0.25][round % 2]));
            points.push(rotation * (DVec3::Z * 0.5 + random.direction() * 0.4));
        }
        let body = ConvexPolyhedron::from_points(&points).expect("a body");
        assert_eq!(body.vertices().len(), corners, "{round}");
        check(&body, &points);
    }
}

#[test]
fn rotated_grids_are_boxes() {
    let mut random = Random::new(1);
    for round in 0..200 {
        let rotation = random.rotation();
        let points: Vec<DVec3> =
            grid([6, 6, 6], DVec3::ONE).iter().map(|p| rotation * *p).collect();
        assert_box(&points, &format!("rotation {round}"));
        let moved: Vec<DVec3> = points.iter().map(|p| *p + DVec3::splat(100.0)).collect();
        assert_box(&moved, &format!("rotation {round}, offset 100"));
    }
}

#[test]
fn slabs_needles_and_offsets_stay_solid() {
    let mut random = Random::new(2);
    for spacing in [
        DVec3::new(1.0, 1.0, 1e-3),
        DVec3::new(1.0, 1.0, 1e-6),
        DVec3::new(3000.0, 1.0, 1.0),
        DVec3::new(1e6, 1.0, 1.0),
        DVec3::new(1.0, 1e-3, 1e-5),
        DVec3::new(1e6, 1e6, 1.0),
    ] {
        for counts in [[2, 2, 2], [5, 4, 3]] {
            for round in 0..100 {
                let rotation = random.rotation();
                let points: Vec<DVec3> =
                    grid(counts, spacing).iter().map(|p| rotation * *p).collect();
                assert_box(&points, &format!("{spacing} {counts:?} rotation {round}"));
            }
            assert_box(&grid(counts, spacing), "not rotated");
        }
    }
    let far: Vec<DVec3> =
        grid([3, 3, 3], DVec3::ONE).iter().map(|p| *p + DVec3::new(1e6, -2e6, 3e6)).collect();
    assert_box(&far, "far away");
}

#[test]
fn lower_dimensions_are_bodies_too() {
    let mut random = Random::new(3);
    for _ in 0..50 {
        let rotation = random.rotation();
        let place = |p: DVec3| rotation * p + DVec3::new(1.0, 2.0, 3.0);
        let point = vec![place(DVec3::ONE); 5];
        let body = ConvexPolyhedron::from_points(&point).unwrap();
        assert_eq!((body.dimension(), body.vertices().len(), body.face_count()), (0, 1, 0));
        let line: Vec<DVec3> = (0..9).map(|k| place(DVec3::new(f64::from(k), 0.0, 0.0))).collect();
        let body = ConvexPolyhedron::from_points(&line).unwrap();
        assert_eq!((body.dimension(), body.vertices().len(), body.face_count()), (1, 2, 0));
        assert_eq!(body.neighbours(0), [1]);
        let sheet: Vec<DVec3> = grid([5, 4, 1], DVec3::ONE).iter().map(|p| place(*p)).collect();
        let body = ConvexPolyhedron::from_points(&sheet).unwrap();
        assert_eq!((body.dimension(), body.vertices().len(), body.face_count()), (2, 4, 2));
        check(&body, &sheet);
    }
    let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
    assert_eq!(ConvexPolyhedron::from_points(&triangle).unwrap().dimension(), 2);
}

#[test]
fn caps_with_many_corners_are_one_face() {
    let mut random = Random::new(4);
    for sides in [3, 7, 64, 1000] {
        let rotation = random.rotation();
        let prism: Vec<DVec3> =
            ring(sides, 1.0, 0.0).chain(ring(sides, 1.0, 0.7)).map(|p| rotation * p).collect();
        let body = ConvexPolyhedron::from_points(&prism).unwrap();
        assert_eq!(body.face_count(), sides + 2);
        assert_eq!(face_sizes(&body)[sides + 1], sides.max(4));
        check(&body, &prism);
        let cone = cone(sides, [0.0, 1.0]).mapped(|p| rotation * p).vertices;
        let body = ConvexPolyhedron::from_points(&cone).unwrap();
        assert_eq!(body.face_count(), sides + 1);
        check(&body, &cone);
    }
}

/// Vertices on an ellipsoid in rings: all faces but those at the poles are trapezoids.
fn rings(count: u32, per_ring: u32, axes: DVec3) -> Vec<DVec3> {
    ring_points(per_ring, count, 0.0).into_iter().map(|v| v * axes).collect()
}

#[test]
fn ring_ellipsoids_have_trapezoids() {
    let mut random = Random::new(5);
    for (count, per_ring) in [(5, 8), (20, 30), (60, 61)] {
        let rotation = random.rotation();
        let axes = DVec3::new(0.7, 1.3, 1.0);
        let points: Vec<DVec3> =
            rings(count, per_ring, axes).iter().map(|p| rotation * *p).collect();
        let body = ConvexPolyhedron::from_points(&points).unwrap();
        assert_eq!(body.vertices().len(), points.len());
        let sizes = face_sizes(&body);
        let triangles = sizes.iter().filter(|&&s| s == 3).count();
        assert_eq!(
            (triangles, sizes.len()),
            (2 * per_ring as usize, (per_ring * (count + 1)) as usize)
        );
        check(&body, &points);
    }
}

#[test]
fn duplicates_and_interior_points_change_nothing() {
    let mut random = Random::new(6);
    let mut points: Vec<DVec3> = (0..300).map(|_| random.vector()).collect();
    let alone = ConvexPolyhedron::from_points(&points).unwrap();
    check(&alone, &points);
    points.extend(points.clone());
    let doubled = ConvexPolyhedron::from_points(&points).unwrap();
    assert_eq!(alone.vertices(), doubled.vertices());
    assert_eq!(alone.face_count(), doubled.face_count());
}

#[test]
fn bad_points_are_named() {
    let nan = [DVec3::ZERO, DVec3::new(0.0, f64::NAN, 0.0)];
    assert!(matches!(
        ConvexPolyhedron::from_points(&nan),
        Err(BuildError::NotFinite { index: 1, .. })
    ));
    let huge = [DVec3::ZERO, DVec3::X, DVec3::new(0.0, 1e70, 0.0)];
    assert!(matches!(
        ConvexPolyhedron::from_points(&huge),
        Err(BuildError::OutOfRange { index: 2, .. })
    ));
    let tiny = [DVec3::new(1e-70, 0.0, 0.0)];
    assert!(matches!(
        ConvexPolyhedron::from_points(&tiny),
        Err(BuildError::OutOfRange { index: 0, .. })
    ));
    assert_eq!(ConvexPolyhedron::from_points(&[]).unwrap_err(), BuildError::NoPoints);
}

fn cube() -> Mesh {
    block(DVec3::ZERO, DVec3::ONE)
}

#[test]
fn meshes_are_checked() {
    let Mesh { vertices, faces } = cube();
    let body = ConvexPolyhedron::from_mesh(&vertices, &faces, 0.0).unwrap();
    assert_eq!((body.vertices().len(), body.face_count()), (8, 6));
    assert!((body.volume() - 1.0).abs() < 1e-15);
    assert!(matches!(
        ConvexPolyhedron::from_mesh(&vertices, &faces[..5], 0.0),
        Err(BuildError::Topology(TopologyError::OpenEdge { .. }))
    ));
    assert!(matches!(
        ConvexPolyhedron::from_mesh(&vertices, &cube().reversed().faces, 0.0),
        Err(BuildError::InsideOut { signed_volume }) if (signed_volume + 1.0).abs() < 1e-12
    ));
    let mut far = faces;
    far[0][0] = 99;
    assert!(matches!(
        ConvexPolyhedron::from_mesh(&vertices, &far, 0.0),
        Err(BuildError::Topology(TopologyError::UnknownVertex {
            face: 0,
            vertex: 99,
            vertices: 8
        }))
    ));
}

#[test]
fn a_dent_is_measured() {
    // The lid is a fan around its centre, pushed in by 0.1.
    let Mesh { vertices: mut points, mut faces } = cube();
    points.push(DVec3::new(0.5, 0.5, 0.9));
    let lid = faces.remove(1);
    for k in 0..4 {
        faces.push(vec![lid[k], lid[(k + 1) % 4], 8]);
    }
    match ConvexPolyhedron::from_mesh(&points, &faces, 0.01) {
        Err(BuildError::NotConvex { face, depth, tolerance }) => {
            assert!(face >= 5 && (depth - 0.1).abs() < 1e-12 && tolerance == 0.01);
        }
        other => panic!("{other:?}"),
    }
    let body = ConvexPolyhedron::from_mesh(&points, &faces, 0.11).unwrap();
    assert_eq!((body.vertices().len(), body.face_count()), (8, 6));
    let defect = convexity_defect(&points, &faces).unwrap();
    assert!((defect.depth - 0.1).abs() < 1e-12);
}

#[test]
fn unused_vertices_are_ignored_and_indices_kept() {
    let first = Mesh::of_points(vec![DVec3::splat(9.0)]);
    let Mesh { vertices, faces } = first.joined(&cube());
    let body = ConvexPolyhedron::from_mesh(&vertices, &faces, 0.0).unwrap();
    assert_eq!(body.input_indices(), [1, 2, 3, 4, 5, 6, 7, 8].map(InputVertex));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn clouds_of_small_integers_are_enclosed(
        cloud in prop::collection::vec((-3_i32..=3, -3_i32..=3, -3_i32..=3), 1..40),
        seed in any::<u64>(),
    ) {
        let rotation = Random::new(seed).rotation();
        let exact: Vec<DVec3> =
            cloud.iter().map(|&(x, y, z)| DVec3::new(x.into(), y.into(), z.into())).collect();
        let rotated: Vec<DVec3> = exact.iter().map(|p| rotation * *p).collect();
        let (a, b) = (
            ConvexPolyhedron::from_points(&exact).unwrap(),
            ConvexPolyhedron::from_points(&rotated).unwrap(),
        );
        check(&a, &exact);
        check(&b, &rotated);
        prop_assert_eq!(a.dimension(), b.dimension());
        prop_assert_eq!(a.vertices().len(), b.vertices().len());
        prop_assert_eq!(face_sizes(&a), face_sizes(&b));
        let mut turned = exact.clone();
        turned.reverse();
        let c = ConvexPolyhedron::from_points(&turned).unwrap();
        prop_assert_eq!(face_sizes(&a), face_sizes(&c));
    }
}

#[test]
#[ignore = "long: 200,000 vertices"]
fn a_large_sphere_and_its_mesh() {
    let mut random = Random::new(7);
    let count: u32 = 200_000;
    let points: Vec<DVec3> = (0..count).map(|_| random.direction()).collect();
    let in_rings =
        rings(count.isqrt() * 7 / 10, count.isqrt() * 14 / 10, DVec3::new(0.7, 1.0, 1.3));
    for points in [points, in_rings] {
        let body = ConvexPolyhedron::from_points(&points).unwrap();
        assert!(body.vertices().len() > points.len() * 999 / 1000);
        let faces = faces(&body);
        let again = ConvexPolyhedron::from_mesh(body.vertices(), &faces, 0.0).unwrap();
        assert_eq!(again.vertices().len(), body.vertices().len());
    }
}

#[test]
fn a_flat_mesh_that_is_not_convex_is_refused() {
    let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];
    let points: Vec<DVec3> = corners.iter().map(|&(x, y)| DVec3::new(x, y, 3.0)).collect();
    let faces = [[0, 1, 2, 3, 4, 5], [5, 4, 3, 2, 1, 0]];
    let defect = convexity_defect(&points, &faces).unwrap();
    assert!((defect.depth - 0.5_f64.sqrt()).abs() < 1e-12, "{defect:?}");
    assert!(ConvexPolyhedron::from_mesh(&points, &faces, 0.1).is_err());
    let square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
    let body = ConvexPolyhedron::from_mesh(&square, &[[0, 1, 2, 3], [3, 2, 1, 0]], 0.0).unwrap();
    assert_eq!((body.dimension(), body.vertices().len()), (2, 4));
}

#[test]
fn single_precision_meshes_are_nearly_convex() {
    let exact = rings(100, 200, DVec3::new(0.7, 1.3, 1.0));
    let body = ConvexPolyhedron::from_points(&exact).unwrap();
    let faces = faces(&body);
    let rounded: Vec<DVec3> = body
        .vertices()
        .iter()
        .map(|p| DVec3::from_array(p.to_array().map(|c| f64::from(c as f32))))
        .collect();
    let defect = convexity_defect(&rounded, &faces).unwrap();
    assert!(defect.depth > 0.0 && defect.depth < 2e-7);
    assert!(ConvexPolyhedron::from_mesh(&rounded, &faces, 1e-6).is_ok());
}

#[test]
fn many_points_on_a_flat_circle() {
    let count = 100_000;
    let mut random = Random::new(9);
    let rotation = random.rotation();
    let points: Vec<DVec3> = ring(count, 1.0, 0.0).map(|corner| rotation * corner).collect();
    let body = ConvexPolyhedron::from_points(&points).unwrap();
    assert_eq!((body.dimension(), body.vertices().len()), (2, points.len()));
    assert!(body.hull_error() < 1e-13);
}

/// A cloud with noise, stretched along its axes and turned.
fn stretched(cloud: &[(i32, i32, i32)], exponents: [i32; 3], noise: i32, seed: u64) -> Vec<DVec3> {
    let mut random = Random::new(seed);
    let rotation = random.rotation();
    let scale = DVec3::from_array(exponents.map(|e| 2.0_f64.powi(e)));
    let mut point = |&(x, y, z): &(i32, i32, i32)| {
        let exact = DVec3::new(x.into(), y.into(), z.into());
        rotation * ((exact + random.vector() * 2.0_f64.powi(noise - 1)) * scale)
    };
    cloud.iter().map(&mut point).collect()
}

/// Two faces meet as on a knife: a point in both planes, up to rounding, is far beyond their edge.
#[test]
fn a_point_beyond_a_sharp_edge_is_a_vertex() {
    let points = of_bits(&[
        [0xbdd4_eed9_42e7_2831, 0x3db4_ab68_0975_f09a, 0xbdc5_1847_b9af_6d50],
        [0xbdd4_ccb3_9352_ec70, 0x3db6_98b9_5528_c534, 0xbdc5_1de0_5cc2_2b32],
        [0xbc08_9276_17e4_3a44, 0x3be8_79a0_bc67_b368, 0xbbf8_c73c_1b30_6f39],
        [0xbdd4_d53c_e4cc_db94, 0x3db6_1d64_dfbe_6572, 0xbdc5_1c7a_a74b_fc88],
        [0xbdd4_bba0_8533_ed41, 0x3db7_8f61_b493_a992, 0xbdc5_20ad_9367_7562],
        [0x3c7a_e77f_c439_fbd3, 0xbc61_7efe_1207_b5fb, 0xbc8c_b42f_e794_d909],
    ]);
    let body = ConvexPolyhedron::from_points(&points).unwrap();
    let size = points.iter().map(|p| p.length()).fold(0.0, f64::max);
    assert!(body.input_indices().contains(&InputVertex(3)));
    assert!(body.hull_error() <= 1e-14 * size, "{:e} of {size:e}", body.hull_error());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn clouds_of_any_shape_have_hulls(
        cloud in prop::collection::vec((-3_i32..=3, -3_i32..=3, -3_i32..=3), 1..12),
        exponents in (-60_i32..60, -60_i32..60, -60_i32..60),
        noise in -60_i32..-10,
        seed in any::<u64>(),
    ) {
        let exponents = [exponents.0, exponents.1, exponents.2];
        let points = stretched(&cloud, exponents, noise, seed);
        let body = ConvexPolyhedron::from_points(&points).unwrap();
        let kept = input::judge(&points, &body);
        prop_assert!(kept.is_ok(), "{kept:?}");
    }
}

/// Clouds whose hulls were wrong once.
#[test]
fn saved_clouds_have_hulls() {
    let wide = of_bits(&[
        [0x405d_d29c_0ac0_d119, 0x4047_0fd1_f351_4aa1, 0xc019_71bf_6771_85be],
        [0xc31a_d5ba_cf7a_42e5, 0xc30d_61d0_5f5b_5b2a, 0xc357_ec78_62fa_c466],
        [0xc31a_d5b8_a4d5_5946, 0xc30d_61db_8fe7_52e4, 0xc357_ec78_61f9_5e7f],
        [0xc31a_d5ba_cf7a_3d60, 0xc30d_61d0_5f5b_56eb, 0xc357_ec78_62fa_c47a],
        [0xc1e1_5527_4d0a_7aa2, 0x41f6_6117_ef70_082d, 0xc190_165e_918c_6004],
        [0x4301_e3cd_8a5c_fc9d, 0x42f3_96a1_4b54_d12f, 0x433f_e5f5_d548_c3b9],
    ]);
    let long = of_bits(&[
        [0x4265_bf3f_b28c_b01c, 0x429b_7c53_3b7b_395b, 0xc290_28fe_1a94_f8c0],
        [0xc270_4f6f_c4a4_9d14, 0xc2a4_9d3e_6b01_ddde, 0x4298_3d7d_25fc_a3e7],
        [0xc033_2f8a_7443_2668, 0xc068_3f97_0b6a_9608, 0x405c_837a_a2fb_8ff9],
        [0x4086_56f4_cd65_e084, 0x40bc_3c10_9b84_adb5, 0xc0b0_99b9_bf45_6b9c],
        [0xc093_9205_798a_5814, 0xc0c8_b4bd_1353_2e86, 0x40bd_11a3_e7de_16a9],
        [0xc090_19b1_5b31_5684, 0xc0c4_5951_7598_d938, 0x40b7_ed9d_8b7e_c80a],
        [0x4255_bf3f_b2b0_68f4, 0x428b_7c53_3ba8_b72a, 0xc280_28fe_1aaf_9d70],
        [0x4073_0144_9806_7470, 0x40a8_2261_d8b9_cbcc, 0xc09c_4f81_c2ef_ffcf],
    ]);
    for points in [wide, long] {
        let body = ConvexPolyhedron::from_points(&points).unwrap();
        let kept = input::judge(&points, &body);
        assert!(kept.is_ok(), "{kept:?}");
    }
}

#[test]
fn exactly_planar_caps_are_one_face() {
    let sides = 8_000;
    let prism = prism(sides, 0.5).vertices;
    let body = ConvexPolyhedron::from_points(&prism).unwrap();
    assert_eq!(body.face_count(), sides + 2);
}

/// Bent outwards at every edge and every face away from its middle, and yet not convex: it goes
/// twice round its axis.
#[test]
fn a_star_that_goes_round_twice_is_refused() {
    let ring = (0..5).map(|k| {
        let angle = 2.0 * std::f64::consts::TAU * f64::from(k) / 5.0;
        DVec3::new(angle.cos(), angle.sin(), 0.0)
    });
    let vertices: Vec<DVec3> = ring.chain([DVec3::Z, DVec3::NEG_Z]).collect();
    let faces: Vec<[u32; 3]> =
        (0..5).flat_map(|k| [[k, (k + 1) % 5, 5], [(k + 1) % 5, k, 6]]).collect();
    let star = ConvexPolyhedron::from_mesh(&vertices, &faces, 0.0);
    assert!(matches!(star, Err(BuildError::NotConvex { .. })), "{star:?}");
    // Once round, the same faces are a double pyramid.
    let order: Vec<DVec3> = [0, 3, 1, 4, 2, 5, 6].into_iter().map(|k: usize| vertices[k]).collect();
    let pyramid = ConvexPolyhedron::from_mesh(&order, &faces, 0.0).unwrap();
    assert_eq!((pyramid.vertices().len(), pyramid.face_count()), (7, 10));
}

/// A mesh that is its own hull is taken as it is; what comes out is what its points alone give.
#[test]
fn convex_meshes_give_the_hull_of_their_vertices() {
    let mut random = Random::new(21);
    for count in [4, 9, 40, 400] {
        let points: Vec<DVec3> = (0..count).map(|_| random.direction()).collect();
        let hull = ConvexPolyhedron::from_points(&points).unwrap();
        let faces = faces(&hull);
        let again = ConvexPolyhedron::from_mesh(hull.vertices(), &faces, 0.0).unwrap();
        let faces_of = |body: &ConvexPolyhedron| {
            let name = |v: u32| body.vertices()[v as usize].to_array().map(f64::to_bits);
            let mut faces: Vec<Vec<_>> = (0..body.face_count() as u32)
                .map(|f| {
                    let mut corners: Vec<_> = body.face_vertices(f).map(name).collect();
                    let first = (0..corners.len()).min_by_key(|&k| corners[k]).unwrap();
                    corners.rotate_left(first);
                    corners
                })
                .collect();
            faces.sort();
            faces
        };
        assert_eq!(faces_of(&hull), faces_of(&again));
    }
}

/// A corner of a face that points inwards ends a climb, for the edges that lead on are inside the face.
#[test]
fn faces_have_no_corner_that_points_inwards() {
    let mut random = Random::new(5);
    for case in 0..2_000 {
        let Ok(body) = ConvexPolyhedron::from_points(&narrow_rings(&mut random)) else { continue };
        let reach = body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max);
        for face in 0..body.face_count() as u32 {
            let at: Vec<DVec3> =
                body.face_vertices(face).map(|v| body.vertices()[v as usize]).collect();
            let next = |k: usize| at[k % at.len()];
            let normal = (0..at.len())
                .map(|k| (next(k) - at[0]).cross(next(k + 1) - at[0]))
                .sum::<DVec3>()
                .normalize();
            for k in 0..at.len() {
                let chord = (next(k + 2) - next(k)).normalize();
                let inward = chord.cross(next(k + 1) - next(k)).dot(normal);
                assert!(
                    inward < 1e-12 * reach,
                    "case {case}, face {face}: {inward:e} of {reach:e}"
                );
            }
        }
    }
}

/// A disc of 24 corners, a few roundings thick because it was modelled 300 away from where it is.
fn recentred_disc(random: &mut Random) -> Vec<DVec3> {
    let (rotation, far) = (random.rotation(), random.direction() * 300.0);
    ring(24, 1.0, 0.0).map(|corner| rotation * corner + far - far).collect()
}

#[test]
fn nearly_flat_discs_keep_their_corners() {
    let mut random = Random::new(300);
    for case in 0..200 {
        let points = recentred_disc(&mut random);
        let body = ConvexPolyhedron::from_points(&points).unwrap();
        let kept = input::judge(&points, &body);
        assert!(kept.is_ok(), "case {case}: {kept:?}");
        assert_eq!(body.vertices().len(), 24, "case {case}");
    }
}

/// Casts past the corners that are left out are not stopped by them.
#[test]
fn nearly_flat_discs_are_met_at_every_corner() {
    let mut random = Random::new(301);
    let point = ConvexPolyhedron::from_points(&[DVec3::ZERO]).unwrap();
    for case in 0..50 {
        let points = recentred_disc(&mut random);
        let disc = ConvexPolyhedron::from_points(&points).unwrap();
        for (k, &corner) in points.iter().enumerate() {
            let direction = random.direction();
            let start = Pose::from_translation(corner * 0.999 - direction * 5.0).unwrap();
            let cast = Cast::new(point.at(start), disc.at(Pose::IDENTITY), direction).unwrap();
            let Ok(Outcome::Contact(contact)) = cast.first_contact() else {
                panic!("case {case}: no contact a thousandth within corner {k}")
            };
            assert!((contact.translation - 5.0).abs() < 1e-9, "case {case}, corner {k}");
        }
    }
}

#[test]
fn nearly_flat_bodies_keep_their_points() {
    for family in NEARLY_FLAT {
        for seed in 0..400 {
            let setting = setting(family, seed);
            let kept = setting.judge_bodies(&setting.bodies().unwrap());
            assert!(kept.is_ok(), "{setting}: {kept:?}");
        }
    }
}
