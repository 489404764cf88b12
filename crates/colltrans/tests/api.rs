//! The public interface: what it refuses, and what it promises to the type system.

use colltrans::glam::{DQuat, DVec3};
use colltrans::{
    BuildError, Certificate, Clearance, ContactRange, ConvexPolyhedron, MAX_MAGNITUDE,
    MIN_MAGNITUDE, Options, Outcome, Pose, PoseError, QueryError, Separation, TopologyError, cast,
    cast_with, clearance, contact_range, directional_depth, intersects,
};
use colltrans_oracle::settings::cuboid;

fn cube() -> ConvexPolyhedron {
    ConvexPolyhedron::from_points(&cuboid(DVec3::splat(0.5))).expect("a body")
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_translation(DVec3::new(x, y, z)).expect("a pose")
}

#[test]
fn types_cross_threads() {
    fn is_send_and_sync<T: Send + Sync + Clone + std::fmt::Debug + 'static>() {}
    is_send_and_sync::<ConvexPolyhedron>();
    is_send_and_sync::<Pose>();
    is_send_and_sync::<Outcome>();
    is_send_and_sync::<ContactRange>();
    is_send_and_sync::<Clearance>();
    is_send_and_sync::<Options>();
    is_send_and_sync::<QueryError>();
    is_send_and_sync::<BuildError>();
    is_send_and_sync::<PoseError>();
}

#[test]
fn points_are_checked() {
    assert_eq!(ConvexPolyhedron::from_points(&[]).unwrap_err(), BuildError::NoPoints);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut points = cuboid(DVec3::ONE);
        points[5].y = bad;
        let error = ConvexPolyhedron::from_points(&points).unwrap_err();
        assert!(matches!(error, BuildError::NotFinite { index: 5, .. }), "{error}");
    }
    for bad in [MAX_MAGNITUDE * 2.0, -MAX_MAGNITUDE * 2.0, MIN_MAGNITUDE / 2.0, 5e-324] {
        let mut points = cuboid(DVec3::ONE);
        points[3].z = bad;
        let error = ConvexPolyhedron::from_points(&points).unwrap_err();
        let expected = BuildError::OutOfRange { index: 3, point: points[3] };
        assert_eq!(error, expected);
        assert!(error.to_string().contains("point 3"), "{error}");
    }
    let edge = [DVec3::splat(MAX_MAGNITUDE), DVec3::splat(MIN_MAGNITUDE)];
    assert!(ConvexPolyhedron::from_points(&edge).is_ok());
}

const BOX_FACES: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

#[test]
fn meshes_are_checked() {
    let vertices = cuboid(DVec3::ONE);
    let faces: Vec<Vec<u32>> = BOX_FACES.map(|f| f.to_vec()).to_vec();
    let build =
        |vertices: &[DVec3], faces: &[Vec<u32>]| ConvexPolyhedron::from_mesh(vertices, faces, 0.0);
    let body = build(&vertices, &faces).expect("a box");
    assert_eq!((body.vertices().len(), body.edge_count(), body.face_count()), (8, 12, 6));

    let open = build(&vertices, &faces[..5]).unwrap_err();
    assert!(matches!(open, BuildError::Topology(TopologyError::OpenEdge { .. })), "{open}");

    let flipped: Vec<Vec<u32>> = faces.iter().map(|f| f.iter().rev().copied().collect()).collect();
    let inside_out = build(&vertices, &flipped).unwrap_err();
    assert!(
        matches!(inside_out, BuildError::InsideOut { signed_volume } if signed_volume < 0.0),
        "{inside_out}"
    );

    let mut unknown = faces.clone();
    unknown[2][1] = 8;
    let error = build(&vertices, &unknown).unwrap_err();
    assert!(
        matches!(
            error,
            BuildError::Topology(TopologyError::UnknownVertex { face: 2, vertex: 8, .. })
        ),
        "{error}"
    );

    let mut dented = vertices.clone();
    dented.push(DVec3::new(0.0, 0.0, 0.5));
    let mut faces = faces;
    let top = faces.remove(1);
    for k in 0..4 {
        faces.push(vec![top[k], top[(k + 1) % 4], 8]);
    }
    let error = build(&dented, &faces).unwrap_err();
    let BuildError::NotConvex { depth, face, .. } = error else { panic!("{error}") };
    assert!((0.1..=0.5).contains(&depth) && face >= 5, "face {face}, depth {depth}");
    // The caller may tolerate the dent.
    assert!(ConvexPolyhedron::from_mesh(&dented, &faces, 0.6).is_ok());
}

#[test]
fn poses_are_checked() {
    let no_rotation = Pose::new(DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0), DVec3::ZERO).unwrap_err();
    assert!(matches!(no_rotation, PoseError::NotARotation { length: 2.0, .. }));
    for w in [f64::NAN, f64::INFINITY, 0.0] {
        let rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, w);
        assert!(matches!(Pose::new(rotation, DVec3::ZERO), Err(PoseError::NotARotation { .. })));
    }
    for x in [f64::NAN, f64::INFINITY, 1e100] {
        let error = Pose::from_translation(DVec3::X * x).unwrap_err();
        assert!(matches!(error, PoseError::Translation { .. }), "{error}");
    }
    // A quaternion in single precision passes.
    let single = DQuat::from_xyzw(0.867_532_25, 0.490_253_03, 0.0, -0.083_903_54);
    let matrix = Pose::new(single, DVec3::ZERO).expect("a rotation").matrix();
    assert!((matrix.determinant() - 1.0).abs() < 1e-14);
}

#[test]
fn poses_compose() {
    let turn = DQuat::from_rotation_z(0.3) * DQuat::from_rotation_x(1.1);
    let pose = Pose::new(turn, DVec3::new(1.0, -2.0, 3.0)).expect("a pose");
    let inverse = pose.inverse().expect("in range");
    let v = DVec3::new(0.2, 0.5, -0.8);
    assert!(inverse.transform_point(pose.transform_point(v)).distance(v) < 1e-14);
    let round = pose.compose(&inverse).expect("in range");
    assert!(round.transform_point(v).distance(v) < 1e-14);
}

#[test]
fn directions_are_checked() {
    let (cube, world, pose) = (cube(), Pose::IDENTITY, at(3.0, 0.0, 0.0));
    let options = Options::default();
    for direction in [
        DVec3::ZERO,
        DVec3::new(f64::NAN, 1.0, 0.0),
        DVec3::new(f64::INFINITY, 0.0, 0.0),
        DVec3::X * 1e100,
        DVec3::X * 1e-100,
    ] {
        let refused = |error: QueryError| {
            assert!(matches!(error, QueryError::Direction { .. }), "{error}");
        };
        refused(cast(&cube, &world, &cube, &pose, direction).unwrap_err());
        refused(contact_range(&cube, &world, &cube, &pose, direction, &options).unwrap_err());
        refused(clearance(&cube, &world, &cube, &pose, direction, &options).unwrap_err());
        refused(directional_depth(&cube, &world, &cube, &pose, direction, &options).unwrap_err());
    }
    for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        let options = Options { graze_tolerance: tolerance, ..Options::default() };
        let error = cast_with(&cube, &world, &cube, &pose, DVec3::X, &options).unwrap_err();
        assert!(matches!(error, QueryError::GrazeTolerance { .. }), "{error}");
    }
}

#[test]
fn a_box_before_a_box() {
    let (cube, world, pose) = (cube(), Pose::IDENTITY, at(3.0, 0.25, 0.0));
    let options = Options::default();
    let range = contact_range(&cube, &world, &cube, &pose, DVec3::X * 2.0, &options);
    let Ok(ContactRange::Contact { first, last }) = range else { panic!("{range:?}") };
    // The last contact is that of the cast the other way.
    assert!((first.translation - 1.0).abs() < 1e-13 && (last.translation + 2.0).abs() < 1e-13);
    assert!(first.normal.distance(DVec3::X) < 1e-12 && last.normal.distance(DVec3::NEG_X) < 1e-12);

    let ahead = clearance(&cube, &world, &cube, &pose, DVec3::X, &options).expect("an answer");
    let Clearance::Blocked { distance, .. } = ahead else { panic!("{ahead:?}") };
    assert!((distance - 2.0).abs() < 1e-13);
    let away = clearance(&cube, &world, &cube, &pose, DVec3::NEG_X, &options);
    assert_eq!(away, Ok(Clearance::Free));
    let aside = clearance(&cube, &world, &cube, &pose, DVec3::Y, &options);
    assert_eq!(aside, Ok(Clearance::Free));
}

#[test]
fn touching_boxes_block_one_way_only() {
    let (cube, world, pose) = (cube(), Pose::IDENTITY, at(1.0, 0.25, 0.0));
    let go = |direction| {
        clearance(&cube, &world, &cube, &pose, direction, &Options::default()).expect("an answer")
    };
    assert!(matches!(go(DVec3::X), Clearance::Blocked { distance: 0.0, .. }), "{:?}", go(DVec3::X));
    assert_eq!(go(DVec3::NEG_X), Clearance::Free);
    assert_eq!(go(DVec3::Y), Clearance::Free);
    assert_eq!(intersects(&cube, &world, &cube, &pose), Ok(true));
}

#[test]
fn overlapping_boxes() {
    let (cube, world, pose) = (cube(), Pose::IDENTITY, at(0.75, 0.25, 0.0));
    let options = Options::default();
    let found = clearance(&cube, &world, &cube, &pose, DVec3::X, &options).expect("an answer");
    let Clearance::Overlapping { range: [first, last] } = found else { panic!("{found:?}") };
    assert!((first + 0.25).abs() < 1e-13 && (last - 1.75).abs() < 1e-13);
    let depth = directional_depth(&cube, &world, &cube, &pose, DVec3::X, &options);
    assert!((depth.expect("an answer") - 0.25).abs() < 1e-13);
    assert_eq!(intersects(&cube, &world, &cube, &pose), Ok(true));
    assert_eq!(intersects(&cube, &world, &cube, &at(1.01, 0.25, 0.0)), Ok(false));
}

#[test]
fn tampered_certificates_are_refused() {
    let corners: Vec<DVec3> = (0..8)
        .map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)))
        .collect();
    let cube = ConvexPolyhedron::from_points(&corners).unwrap();
    let start = Pose::from_translation(DVec3::new(-3.0, 0.25, 0.125)).unwrap();
    let world = Pose::IDENTITY;
    let Outcome::Contact(contact) = cast(&cube, &start, &cube, &world, DVec3::X).unwrap() else {
        panic!("the cubes meet")
    };
    let good = contact.certificate;
    let verify = |c: &Certificate| c.verify(&cube, &start, &cube, &world, DVec3::X);
    assert!(verify(&good).is_ok());
    for bad in [f64::NAN, f64::INFINITY, 3.0] {
        assert!(verify(&Certificate { lower: bad, ..good }).is_err());
        assert!(verify(&Certificate { upper: bad, ..good }).is_err());
        assert!(verify(&Certificate { tolerance: bad, ..good }).is_err());
        assert!(verify(&Certificate { normal: DVec3::splat(bad), ..good }).is_err());
        assert!(verify(&Certificate { weights: [bad, 0.0, 0.0], ..good }).is_err());
    }
    assert!(verify(&Certificate { upper: 1.0, ..good }).is_err());
    let mut pairs = good.pairs;
    pairs[0].fixed = 99;
    assert!(verify(&Certificate { pairs, ..good }).is_err());
    let beside = Pose::from_translation(DVec3::new(-3.0, 5.0, 0.0)).unwrap();
    let Outcome::Separated(separated) = cast(&cube, &beside, &cube, &world, DVec3::X).unwrap()
    else {
        panic!("they pass")
    };
    let good = separated.certificate;
    let verify = |s: &Separation| s.verify(&cube, &beside, &cube, &world, DVec3::X);
    assert!(verify(&good).is_ok());
    for bad in [f64::NAN, 99.0, -1.0] {
        assert!(verify(&Separation { margin: bad, ..good }).is_err());
    }
    assert!(verify(&Separation { normal: -good.normal, ..good }).is_err());
}
