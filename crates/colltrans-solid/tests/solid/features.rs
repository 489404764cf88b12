//! What of a solid is named where it is stopped: faces, edges and corners of the part, not of its
//! triangulation, by the numbers of the input.

use colltrans_convex::{
    Cast, Clearance, ConvexPolyhedron, FaceId, Feature, InputVertex, Outcome, Pose,
};
use colltrans_solid::{Solid, SolidCast, SolidContact};
use colltrans_testkit::shapes;
use colltrans_testkit::solids::{bolt, pin, slab, washer};
use glam::{DQuat, DVec3};

use crate::common::{at, cuboid, solid};

fn stopped(a: (&Solid, Pose), b: (&Solid, Pose), direction: DVec3) -> SolidContact {
    let cast = Cast::new(a.0.at(a.1), b.0.at(b.1), direction).expect("a direction");
    match cast.clearance().expect("an answer") {
        Clearance::Blocked { contact, .. } => contact,
        other => panic!("{other:?}"),
    }
}

/// Where the vertices of a feature are.
fn places(feature: Feature, body: &Solid) -> Vec<DVec3> {
    let own = feature.vertex_positions(body).into_iter();
    own.map(|v| body.vertices()[v.index()]).collect()
}

/// A block, its bottom at 0, finely cut.
fn table() -> Solid {
    solid(&slab(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0), [5, 7, 2]))
}

/// A square pyramid on its tip, and the numbers of its tip and its base.
fn pyramid() -> Solid {
    let base = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mut vertices: Vec<DVec3> = base.map(|(x, y)| DVec3::new(x, y, 1.0)).to_vec();
    vertices.push(DVec3::ZERO);
    let facets = [vec![0, 1, 2, 3], vec![1, 0, 4], vec![2, 1, 4], vec![3, 2, 4], vec![0, 3, 4]];
    Solid::from_mesh(&vertices, &facets).expect("a pyramid")
}

#[test]
fn a_diagonal_of_a_flat_face_is_the_face() {
    let (table, tip) = (table(), pyramid());
    // Onto diagonals, vertices and edges of the triangulation of the top.
    for x in [0.0, 0.1, -0.8, 0.8, 2.4] {
        for y in [0.0, 4.0 / 7.0, 0.3, 8.0 / 7.0] {
            let contact = stopped((&tip, at([x, y, 3.0])), (&table, Pose::IDENTITY), DVec3::NEG_Z);
            assert_eq!(
                contact.moving_feature,
                Feature::Vertex(InputVertex(4)),
                "{x} {y}: {contact:?}"
            );
            let Feature::Face(_) = contact.fixed_feature else { panic!("{x} {y}: {contact:?}") };
            let mut corners = places(contact.fixed_feature, &table);
            assert_eq!(corners.len(), 4, "{corners:?}");
            assert!(corners.iter().all(|c| c.z == 0.0 && c.x.abs() == 4.0 && c.y.abs() == 4.0));
            // Counter-clockwise as seen from outside.
            let turn = (corners[1] - corners[0]).cross(corners[2] - corners[1]);
            assert!(turn.z > 0.0, "{corners:?}");
            corners.dedup();
            assert_eq!(corners.len(), 4);
        }
    }
}

#[test]
fn a_polygon_has_one_number() {
    let (table, tip) = (table(), pyramid());
    let numbers: Vec<Feature> = [-3.0, -1.1, 0.3, 2.9]
        .into_iter()
        .flat_map(|x| [-3.3, 0.2, 3.1].map(|y| [x, y, 3.0]))
        .map(|p| stopped((&tip, at(p)), (&table, Pose::IDENTITY), DVec3::NEG_Z).fixed_feature)
        .collect();
    assert!(numbers.iter().all(|n| *n == numbers[0]), "{numbers:?}");
    // The least of the input facets that it is made of.
    let Feature::Face(number) = numbers[0] else { panic!("{numbers:?}") };
    let is_top = |t: &[u32; 3]| t.iter().all(|v| table.vertices()[*v as usize].z == 0.0);
    let tops = table.triangles().iter().zip(table.facet_indices());
    assert_eq!(tops.filter(|(t, _)| is_top(t)).map(|(_, f)| FaceId(f.0)).min(), Some(number));
}

#[test]
fn an_edge_is_named_by_its_corners_and_a_corner_by_itself() {
    let table = table();
    // A beam with an edge below, turned by an eighth about x, and across the table's rim.
    let roof = |far: f64| {
        let points = [[-far, 0.0, 0.0], [far, 0.0, 0.0], [-far, 1.0, 1.0], [far, 1.0, 1.0]];
        let more = [[-far, -1.0, 1.0], [far, -1.0, 1.0]];
        let points: Vec<DVec3> = points.iter().chain(&more).map(|p| DVec3::from(*p)).collect();
        ConvexPolyhedron::from_points(&points).expect("a beam")
    };
    let beam = roof(20.0);
    let beam = Solid::from_convex(&beam).expect("a solid");
    // Its lower edge, along x, meets the table's edge along y, from the side.
    let lying = Pose::new(
        DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2),
        DVec3::new(-12.0, 0.5, -0.5),
    )
    .expect("a rotation");
    let contact = stopped((&beam, lying), (&table, Pose::IDENTITY), DVec3::X);
    assert_eq!(contact.fixed_feature.kind(), "face", "{contact:?}");
    let tilted =
        Pose::new(DQuat::from_rotation_y(0.5), DVec3::new(-4.0, 0.37, 5.0)).expect("a rotation");
    let contact = stopped((&beam, tilted), (&table, Pose::IDENTITY), DVec3::NEG_Z);
    let Feature::Edge(ends) = contact.fixed_feature else { panic!("{contact:?}") };
    assert!(ends[0] < ends[1]);
    let ends = places(contact.fixed_feature, &table);
    assert!(ends.iter().all(|p| p.z == 0.0 && p.x.abs() == 4.0 && p.y.abs() == 4.0), "{ends:?}");
    assert_eq!((ends[0] - ends[1]).length(), 8.0);
    let mut own: Vec<DVec3> = places(contact.moving_feature, &beam);
    own.sort_by(|a, b| a.x.total_cmp(&b.x));
    assert_eq!(own, [DVec3::new(-20.0, 0.0, 0.0), DVec3::new(20.0, 0.0, 0.0)]);
    // A table's corner from below.
    let up = Pose::new(DQuat::from_rotation_x(0.5) * DQuat::from_rotation_y(0.4), DVec3::Z * 9.0)
        .expect("a rotation");
    let contact = stopped((&table, up), (&table, Pose::IDENTITY), DVec3::NEG_Z);
    assert_eq!(contact.moving_feature.kind(), "vertex", "{contact:?}");
    let corner = places(contact.moving_feature, &table)[0];
    assert_eq!((corner.x.abs(), corner.y.abs()), (4.0, 4.0), "{corner}");
}

#[test]
fn faces_on_faces_are_faces_with_their_holes() {
    let bolt = solid(&bolt([1.0, 2.0], [-5.0, 8.0, 9.0], 48));
    let plate = solid(&washer([1.125, 4.0], [0.0, 1.0], 32));
    let contact = stopped((&bolt, Pose::IDENTITY), (&plate, Pose::IDENTITY), DVec3::NEG_Z);
    let [head, top] = [(contact.moving_feature, &bolt), (contact.fixed_feature, &plate)]
        .map(|(feature, body)| (feature.kind(), places(feature, body)));
    assert_eq!((head.0, head.1.len()), ("face", 96));
    assert_eq!((top.0, top.1.len()), ("face", 64));
    // The outer loop comes first.
    let radius = |p: &DVec3| p.truncate().length();
    assert!(head.1[..48].iter().all(|p| (radius(p) - 2.0).abs() < 1e-12), "{:?}", head.1);
    assert!(top.1[32..].iter().all(|p| (radius(p) - 1.125).abs() < 1e-12), "{:?}", top.1);
}

#[test]
fn facets_of_a_fine_cylinder_stay_facets() {
    let round = solid(&pin(1.0, [0.0, 1.0], 720));
    let table = cuboid([3.0, -4.0, -4.0], [4.0, 4.0, 4.0]);
    let turned = Pose::new(DQuat::from_rotation_z(0.001), DVec3::ZERO).expect("a rotation");
    let contact = stopped((&round, turned), (&table, Pose::IDENTITY), DVec3::X);
    let Feature::Edge(_) = contact.moving_feature else { panic!("{contact:?}") };
    let ends = places(contact.moving_feature, &round);
    assert!((ends[0] - ends[1]).length() == 1.0, "from end to end, not around: {ends:?}");
    let mut sizes: Vec<usize> = (0..round.facet_indices().len() as u32)
        .map(|f| Feature::Face(FaceId(f)))
        .filter(|f| !f.vertex_positions(&round).is_empty())
        .map(|f| f.vertices(&round).len())
        .collect();
    sizes.sort_unstable();
    assert_eq!(sizes.len(), 722, "720 facets around, two ends");
    assert!(sizes[..720].iter().all(|n| *n == 4) && sizes[720..] == [720, 720]);
}

#[test]
fn single_precision_does_not_cut_a_face() {
    // A plate, turned, and rounded to single precision as in a file: its triangles are coplanar only
    // nearly.
    let mesh = slab(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0), [6, 5, 1]);
    let rotation = DQuat::from_xyzw(0.1, 0.7, -0.2, 0.3).normalize();
    let rounded = |v: &DVec3| (rotation * *v + DVec3::new(30.0, -7.0, 11.0)).as_vec3().as_dvec3();
    let vertices: Vec<DVec3> = mesh.vertices.iter().map(rounded).collect();
    let plate = Solid::from_mesh(&vertices, &mesh.faces).expect("a closed mesh");
    let faces: std::collections::BTreeSet<Vec<InputVertex>> = (0..mesh.faces.len() as u32)
        .map(|f| Feature::Face(FaceId(f)).vertices(&plate))
        .filter(|corners| !corners.is_empty())
        .collect();
    assert_eq!(faces.len(), 6, "{faces:?}");
    assert!(faces.iter().all(|corners| corners.len() == 4), "{faces:?}");
}

#[test]
fn numbers_are_those_of_the_input() {
    // Two vertices that nothing uses first, and every corner a second time: the first one counts.
    let mesh = slab(DVec3::ZERO, DVec3::ONE, [1; 3]);
    let mut vertices = vec![DVec3::splat(50.0), DVec3::splat(60.0)];
    vertices.extend_from_slice(&mesh.vertices);
    vertices.extend_from_slice(&mesh.vertices);
    let count = mesh.vertices.len() as u32;
    let facets: Vec<Vec<u32>> = mesh
        .faces
        .iter()
        .enumerate()
        .map(|(k, face)| face.iter().map(|v| v + 2 + count * (k as u32 % 2)).collect())
        .collect();
    let cube = Solid::from_mesh(&vertices, &facets).expect("a cube");
    assert_eq!(cube.input_counts(), [vertices.len() as u32, facets.len() as u32]);
    let table = table();
    let tilted = |translation| {
        let turn = DQuat::from_rotation_x(0.6) * DQuat::from_rotation_y(0.5);
        Pose::new(turn, translation).expect("a rotation")
    };
    let down = |body: &Solid| {
        let contact =
            stopped((body, tilted(DVec3::Z * 5.0)), (&table, Pose::IDENTITY), DVec3::NEG_Z);
        let Feature::Vertex(InputVertex(v)) = contact.moving_feature else { panic!("{contact:?}") };
        (v, contact.point_on_moving)
    };
    let (lowest, place) = down(&cube);
    assert!(lowest >= 2 && lowest < 2 + count, "the first of equal ones: {lowest}");
    let there = tilted(DVec3::Z * 5.0).transform_point(vertices[lowest as usize]);
    assert!((there - place).length() < 1e-12, "{lowest}");
    // As the second piece of a body: after all numbers of the first one, unused ones included.
    let mut spare = mesh.vertices.iter().map(|v| *v + DVec3::Z * 9.0).collect::<Vec<_>>();
    spare.extend([DVec3::ZERO; 5]);
    let first = Solid::from_mesh(&spare, &mesh.faces).expect("a cube");
    let both = Solid::from_pieces([&first, &cube]).expect("two pieces");
    assert_eq!(down(&both).0, spare.len() as u32 + lowest);
}

#[test]
fn convex_bodies_are_named_by_their_input_too() {
    // Points inside come first, so that own numbers are not those of the input.
    let mut points = vec![DVec3::splat(0.5); 3];
    points.extend(shapes::block(DVec3::ZERO, DVec3::ONE).vertices);
    let cube = ConvexPolyhedron::from_points(&points).expect("a cube");
    let table = ConvexPolyhedron::cuboid(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0))
        .expect("a table");
    let turn = DQuat::from_rotation_x(0.6) * DQuat::from_rotation_y(0.5);
    let tilted = Pose::new(turn, DVec3::Z * 5.0).expect("a rotation");
    let cast = Cast::new(cube.at(tilted), table.at(Pose::IDENTITY), DVec3::NEG_Z).expect("a cast");
    let Ok(Outcome::Contact(contact)) = cast.first_contact() else { panic!("the table") };
    let features = contact.features(&cast);
    let Feature::Vertex(lowest) = features.moving else { panic!("{features:?}") };
    let there = tilted.transform_point(points[lowest.index()]);
    assert!((there - contact.witness_points(&cast).on_moving).length() < 1e-12, "{features:?}");
    let own = features.moving.vertex_positions(&cube);
    assert_eq!(cube.vertices()[own[0].index()], points[lowest.index()]);
    // The same bodies as solids name the same.
    let between = Cast::between(cube.at(tilted), table.at(Pose::IDENTITY), DVec3::NEG_Z);
    let Clearance::Blocked { contact, .. } =
        between.expect("a cast").clearance().expect("an answer")
    else {
        panic!("the table")
    };
    assert_eq!(contact.moving_feature, features.moving);
    let [Feature::Face(_), Feature::Face(_)] = [contact.fixed_feature, features.fixed] else {
        panic!("{contact:?} {features:?}")
    };
    let sorted = |mut corners: Vec<InputVertex>| {
        corners.sort_unstable();
        corners
    };
    let (solid, convex) = (Solid::from_convex(&table).expect("a solid"), features.fixed);
    assert_eq!(sorted(contact.fixed_feature.vertices(&solid)), sorted(convex.vertices(&table)));
}

#[test]
fn a_body_that_was_shrunk_has_the_faces_it_had() {
    let mesh = slab(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0), [6, 5, 1]);
    let rotation = DQuat::from_xyzw(0.1, 0.7, -0.2, 0.3).normalize();
    let vertices: Vec<DVec3> =
        mesh.vertices.iter().map(|v| (rotation * *v).as_vec3().as_dvec3()).collect();
    let plate = Solid::from_mesh(&vertices, &mesh.faces).expect("a closed mesh");
    let (smaller, _) = plate.shrunk(0.01).expect("small");
    for face in 0..mesh.faces.len() as u32 {
        let face = Feature::Face(FaceId(face));
        assert_eq!(face.vertices(&plate), face.vertices(&smaller), "{face:?}");
    }
}
