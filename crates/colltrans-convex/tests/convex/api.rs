//! The public interface: what it refuses, and what it promises to the type system.

use colltrans_convex::cast;
use colltrans_convex::{
    BuildError, Cast, Certificate, CertificateError, Clearance, ContactRange, ConvexPolyhedron,
    FreeReason, HalfEdge, MAX_MAGNITUDE, MIN_MAGNITUDE, Options, Outcome, OverlapAhead, Pose,
    PoseError, QueryError, Separation, TopologyError, VertexId, cta,
};
use colltrans_testkit::oracle::exact::Vector;
use colltrans_testkit::oracle::settings::{FAMILIES, Setting, setting};
use colltrans_testkit::shapes::{Mesh, block, cuboid};
use glam::{DMat3, DQuat, DVec3};

use crate::common::{at, body};

fn cube() -> ConvexPolyhedron {
    body(&cuboid(DVec3::splat(0.5)).vertices)
}

#[test]
fn types_cross_threads() {
    fn is_send_and_sync<T: Send + Sync + Clone + std::fmt::Debug + 'static>() {}
    is_send_and_sync::<ConvexPolyhedron>();
    is_send_and_sync::<Pose>();
    is_send_and_sync::<Outcome>();
    is_send_and_sync::<ContactRange>();
    is_send_and_sync::<Clearance>();
    is_send_and_sync::<Cast>();
    is_send_and_sync::<Options>();
    is_send_and_sync::<QueryError>();
    is_send_and_sync::<BuildError>();
    is_send_and_sync::<PoseError>();
}

#[test]
fn points_are_checked() {
    assert_eq!(ConvexPolyhedron::from_points(&[]).unwrap_err(), BuildError::NoPoints);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut points = cuboid(DVec3::ONE).vertices;
        points[5].y = bad;
        let error = ConvexPolyhedron::from_points(&points).unwrap_err();
        assert!(matches!(error, BuildError::NotFinite { index: 5, .. }), "{error}");
    }
    for bad in [MAX_MAGNITUDE * 2.0, -MAX_MAGNITUDE * 2.0, MIN_MAGNITUDE / 2.0, 5e-324] {
        let mut points = cuboid(DVec3::ONE).vertices;
        points[3].z = bad;
        let error = ConvexPolyhedron::from_points(&points).unwrap_err();
        let expected = BuildError::OutOfRange { index: 3, point: points[3] };
        assert_eq!(error, expected);
        assert!(error.to_string().contains("point 3"), "{error}");
    }
    let edge = [DVec3::splat(MAX_MAGNITUDE), DVec3::splat(MIN_MAGNITUDE)];
    assert!(ConvexPolyhedron::from_points(&edge).is_ok());
}

#[test]
fn meshes_are_checked() {
    let Mesh { vertices, faces } = cuboid(DVec3::ONE);
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
    let (cube, world, pose) = (cube(), Pose::IDENTITY, at([3.0, 0.0, 0.0]));
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
        refused(Cast::new(cube.at(world), cube.at(pose), direction).unwrap_err());
        let valid = Cast::new(cube.at(world), cube.at(pose), DVec3::X).expect("a query");
        refused(valid.along(direction).unwrap_err());
    }
    let valid = Cast::new(cube.at(world), cube.at(pose), DVec3::X).expect("a query");
    for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        let error = valid.with_graze_tolerance(tolerance).unwrap_err();
        assert!(matches!(error, QueryError::GrazeTolerance { .. }), "{error}");
        let narrowing = cta::Options::new(cta::Start::Ellipsoids, cta::Until::Gap(-1.0));
        let error = valid.with_options(Options::default().with_narrowing(narrowing)).unwrap_err();
        assert!(matches!(error, QueryError::NarrowingGap { .. }), "{error}");
    }
}

/// A cube in the world, and another one moved by `offset`.
fn cubes(cube: &ConvexPolyhedron, offset: DVec3, direction: DVec3) -> Cast<'_> {
    let pose = at([offset.x, offset.y, offset.z]);
    Cast::new(cube.at(Pose::IDENTITY), cube.at(pose), direction).expect("a query")
}

#[test]
fn a_box_before_a_box() {
    let cube = cube();
    let go = |direction| cubes(&cube, DVec3::new(3.0, 0.25, 0.0), direction);
    let range = go(DVec3::X * 2.0).contact_range();
    let Ok(ContactRange::Contact { first, last }) = range else { panic!("{range:?}") };
    // The last contact is that of the cast the other way.
    assert!((first.translation - 1.0).abs() < 1e-13 && (last.translation + 2.0).abs() < 1e-13);
    assert!(first.normal.distance(DVec3::X) < 1e-12 && last.normal.distance(DVec3::NEG_X) < 1e-12);

    let ahead = go(DVec3::X).clearance().expect("an answer");
    let Clearance::Blocked { distance, .. } = ahead else { panic!("{ahead:?}") };
    assert!(distance <= 2.0 && distance > 2.0 - 1e-13);
    assert_eq!(ahead.distance(), Some(distance));
    let away = go(DVec3::NEG_X).clearance().expect("an answer");
    let Clearance::Free(FreeReason::Behind(last)) = away else { panic!("{away:?}") };
    assert!(away.is_free() && (last.translation - 2.0).abs() < 1e-13);
    assert!(go(DVec3::X).verify(&last.certificate).is_ok(), "that of the reversed cast");
    let aside = go(DVec3::Y).clearance().expect("an answer");
    let Clearance::Free(FreeReason::Separated(separated)) = aside else { panic!("{aside:?}") };
    assert!(go(DVec3::Y).verify(&separated.certificate).is_ok());
}

#[test]
fn touching_boxes_block_one_way_only() {
    let cube = cube();
    let go = |direction| cubes(&cube, DVec3::new(1.0, 0.25, 0.0), direction);
    let clearance = |direction| go(direction).clearance().expect("an answer");
    let ahead = clearance(DVec3::X);
    assert!(matches!(ahead, Clearance::Blocked { distance: 0.0, .. }), "{ahead:?}");
    assert!(matches!(clearance(DVec3::NEG_X), Clearance::Free(FreeReason::Behind(_))));
    assert!(matches!(clearance(DVec3::Y), Clearance::Free(FreeReason::Slides(_))));
    assert_eq!(clearance(DVec3::Y).distance(), Some(f64::INFINITY));
    assert!(go(DVec3::X).intersects().expect("an answer").meets);
}

#[test]
fn overlapping_boxes() {
    let cube = cube();
    let cast = cubes(&cube, DVec3::new(0.75, 0.25, 0.0), DVec3::X);
    let found = cast.clearance().expect("an answer");
    let Clearance::Overlapping(OverlapAhead { first, last }) = found else { panic!("{found:?}") };
    assert!((first.translation + 0.25).abs() < 1e-13 && (last.translation + 1.75).abs() < 1e-13);
    assert_eq!(found.distance(), None);
    let depth = cast.directional_depth().expect("an answer");
    assert!(depth.depth >= 0.25 && depth.depth < 0.25 + 1e-13);
    assert_eq!(depth.clearance, found);
    assert!(cast.verify(&first.certificate).is_ok());
    assert!(cast.reversed().verify(&last.certificate).is_ok());
    let meets = |x| {
        let cast = cubes(&cube, DVec3::new(x, 0.25, 0.0), DVec3::Y);
        let found = cast.intersects().expect("an answer");
        // The proof is that of a cast along the line of the centres.
        let along = cast.along(found.evidence.direction).expect("a direction");
        match found.evidence.outcome {
            Outcome::Contact(contact) => along.verify(&contact.certificate).expect("a proof"),
            Outcome::Separated(separated) => along.verify(&separated.certificate).expect("a proof"),
            Outcome::Grazing(_) => panic!("boxes with a volume"),
        };
        found.meets
    };
    assert!(meets(0.75) && meets(0.0) && meets(1.0) && !meets(1.01));
}

/// Up to the contact and not beyond: afterwards a plane still lies between the bodies, exactly.
#[test]
fn a_pose_before_a_contact_is_free() {
    let mut moved = 0;
    for (family, ..) in FAMILIES {
        for seed in 0..40 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            let Ok(Clearance::Blocked { contact, .. }) = cast.clearance() else { continue };
            let pose = contact.pose_before(&cast).expect("in range");
            let there = Setting { moving_pose: pose, ..setting.clone() };
            let judge = there.judge(&bodies);
            let normal = Vector::new(contact.normal);
            let highest = judge.scene.moving.iter().map(|p| normal.dot(p)).max();
            let lowest = judge.scene.fixed.iter().map(|q| normal.dot(q)).min();
            let was_free = contact.certificate.lower >= 0.0;
            assert!(!was_free || lowest >= highest, "{setting}");
            moved += u32::from(pose != setting.moving_pose);
        }
    }
    assert!(moved > 250, "{moved}");
}

#[test]
fn matrices_are_taken_as_they_are() {
    let off = DMat3::from_cols(DVec3::X, DVec3::Y * (1.0 + 4e-7), DVec3::Z);
    let pose = Pose::from_matrix(off, DVec3::ONE).expect("nearly a rotation");
    assert_eq!(pose.matrix(), off);
    for (matrix, least) in [
        (DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.0 + 1e-6)), 1.9e-6),
        (DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)), 2.0),
        (DMat3::from_cols(DVec3::X, DVec3::new(1e-5, 1.0, 0.0), DVec3::Z), 9e-6),
    ] {
        let refused = Pose::from_matrix(matrix, DVec3::ZERO).unwrap_err();
        let PoseError::NotARotationMatrix { defect, .. } = refused else { panic!("{refused}") };
        assert!((least..1.2 * least).contains(&defect), "{defect:e}");
    }
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        let matrix = DMat3::from_diagonal(DVec3::new(bad, 1.0, 1.0));
        let refused = Pose::from_matrix(matrix, DVec3::ZERO).unwrap_err();
        let PoseError::NotARotationMatrix { defect, .. } = refused else { panic!("{refused}") };
        assert_eq!(defect, f64::INFINITY);
    }
}

#[test]
fn tampered_certificates_are_refused() {
    let cube = body(&block(DVec3::ZERO, DVec3::ONE).vertices);
    let start = Pose::from_translation(DVec3::new(-3.0, 0.25, 0.125)).unwrap();
    let world = Pose::IDENTITY;
    let Outcome::Contact(contact) = cast(&cube, &start, &cube, &world, DVec3::X).unwrap() else {
        panic!("the cubes meet")
    };
    let good = contact.certificate;
    let there = Cast::new(cube.at(start), cube.at(world), DVec3::X).expect("a query");
    let verify = |c: &Certificate| there.verify(c);
    assert!(verify(&good).is_ok());
    for bad in [f64::NAN, f64::INFINITY, 3.0] {
        assert!(verify(&Certificate { lower: bad, ..good }).is_err());
        // A larger upper bound claims less, an infinite one nothing.
        assert_eq!(verify(&Certificate { upper: bad, ..good }).is_ok(), !bad.is_nan());
        assert!(verify(&Certificate { rounding: bad, ..good }).is_err());
        assert!(verify(&Certificate { normal: DVec3::splat(bad), ..good }).is_err());
        assert!(verify(&Certificate { weights: [bad, 0.0, 0.0], ..good }).is_err());
    }
    assert!(verify(&Certificate { upper: 1.0, ..good }).is_err());
    // 2 is proven by this plane, and not one bit more.
    assert_eq!(verify(&Certificate { lower: 2.0 - 2e-15, ..good }), verify(&good));
    for lie in [2.0_f64.next_up(), 2.0 + 4e-14] {
        let refused = verify(&Certificate { lower: lie, ..good }).unwrap_err();
        assert!(matches!(refused, CertificateError::Bound { .. }), "{refused}");
    }
    let refused = verify(&Certificate { lower: 2.0, upper: 1.0, ..good }).unwrap_err();
    assert_eq!(refused, CertificateError::Order { lower: 2.0, upper: 1.0 });
    for lie in [2.0, 2.0_f64.next_up(), good.lower] {
        let refused = verify(&Certificate { upper: lie, ..good }).unwrap_err();
        assert!(matches!(refused, CertificateError::Bound { .. }), "{refused}");
    }
    for lie in [-1e-15, -1.0, 100.0 * good.rounding] {
        let refused = verify(&Certificate { rounding: lie, ..good }).unwrap_err();
        assert!(matches!(refused, CertificateError::Rounding { .. }), "{refused}");
    }
    let mut pairs = good.pairs;
    pairs[0].fixed = VertexId(99);
    assert!(verify(&Certificate { pairs, ..good }).is_err());
    let beside = Pose::from_translation(DVec3::new(-3.0, 5.0, 0.0)).unwrap();
    let Outcome::Separated(separated) = cast(&cube, &beside, &cube, &world, DVec3::X).unwrap()
    else {
        panic!("they pass")
    };
    let good = separated.certificate;
    let aside = Cast::new(cube.at(beside), cube.at(world), DVec3::X).expect("a query");
    let verify = |s: &Separation| aside.verify(s);
    assert!(verify(&good).is_ok());
    for bad in [f64::NAN, 99.0, -1.0] {
        assert!(verify(&Separation { margin: bad, ..good }).is_err());
    }
    assert!(verify(&Separation { normal: -good.normal, ..good }).is_err());
    // The shadows are 4 apart.
    assert!(verify(&Separation { margin: 4.0 - 4e-15, ..good }).is_ok());
    let refused = verify(&Separation { margin: 4.0_f64.next_up(), ..good }).unwrap_err();
    assert!(matches!(refused, CertificateError::Bound { .. }), "{refused}");
}

#[test]
fn corners_of_a_box_may_be_given_in_any_order() {
    let (low, high) = (DVec3::new(-1.0, 2.0, -3.0), DVec3::new(4.0, 5.0, 6.0));
    let swapped = ConvexPolyhedron::cuboid(DVec3::new(4.0, 2.0, 6.0), DVec3::new(-1.0, 5.0, -3.0));
    let body = ConvexPolyhedron::cuboid(high, low).unwrap();
    for body in [body, swapped.unwrap()] {
        assert_eq!(body.volume(), 135.0);
        let corners = body.vertices().iter();
        assert_eq!(corners.clone().copied().reduce(DVec3::min), Some(low));
        assert_eq!(corners.copied().reduce(DVec3::max), Some(high));
    }
    assert!(ConvexPolyhedron::cuboid(low, DVec3::NAN).is_err());
}

#[test]
fn convex_tolerances_are_lengths() {
    let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    for bad in [f64::NAN, -1e-9, f64::NEG_INFINITY] {
        let refused = ConvexPolyhedron::from_mesh(&vertices, &faces, bad).unwrap_err();
        assert!(matches!(refused, BuildError::Tolerance { .. }), "{refused}");
    }
    for good in [0.0, -0.0, 1.0, f64::INFINITY] {
        assert!(ConvexPolyhedron::from_mesh(&vertices, &faces, good).is_ok());
    }
}

#[test]
fn a_range_knows_the_clearance() {
    for (family, ..) in FAMILIES {
        for seed in 0..20 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            let (Ok(range), Ok(clearance)) = (cast.contact_range(), cast.clearance()) else {
                continue;
            };
            let same =
                std::mem::discriminant(&range.clearance()) == std::mem::discriminant(&clearance);
            assert!(same, "{setting}");
            assert_eq!(range.clearance().distance(), clearance.distance(), "{setting}");
        }
    }
}

#[test]
fn half_edges_lead_around_faces_and_vertices() {
    for body in [body(&cuboid(DVec3::ONE).vertices), body(&[DVec3::ZERO, DVec3::X, DVec3::Y])] {
        let half_edges = body.half_edges();
        assert_eq!(half_edges.len(), 2 * body.edge_count());
        for face in 0..body.face_count() as u32 {
            let around = body.face_half_edges(face).map(|h| half_edges[h as usize]);
            assert!(around.clone().all(|h| h.face == face));
            assert!(around.map(|h| h.origin).eq(body.face_vertices(face)));
        }
        for vertex in 0..body.vertices().len() as u32 {
            let leaving = body.outgoing(vertex).iter().map(|&h| half_edges[h as usize]);
            assert!(leaving.clone().all(|h| h.origin == vertex));
            let target = |h: HalfEdge| half_edges[h.twin as usize].origin;
            assert!(leaving.map(target).eq(body.neighbours(vertex).iter().copied()));
        }
    }
    let segment = body(&[DVec3::ZERO, DVec3::X]);
    assert!(segment.half_edges().is_empty() && segment.outgoing(0).is_empty());
}
