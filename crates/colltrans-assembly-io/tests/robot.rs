//! Tests robots: URDF and SRDF files, rows by name and by order, pairs, and a wire that all samples miss.

use colltrans_testkit::TemporaryFolder;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use colltrans::motion::path::{Joint, JointPath, PathBody, PathCast, PathOutcome};
use colltrans::{AnyBody, Pose};
use colltrans_assembly_io::ReadError;
use colltrans_assembly_io::read::{ReadOptions, read_disabled_pairs, read_robot};
use colltrans_assembly_io::robot::{JointKind, Robot, RobotError, Table, body_from_mesh};
use colltrans_mesh::body::{BodyOptions, load};
use glam::{DAffine3, DVec3};

fn data_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name)
}

fn read_arm() -> Robot {
    read_robot(data_path("arm.urdf"), &ReadOptions::default()).expect("a robot")
}

/// Reads a robot from the elements in a text.
fn read_text(text: &str) -> Result<Robot, ReadError> {
    let folder = TemporaryFolder::new();
    let file = folder.path().join("robot.urdf");
    std::fs::write(&file, format!("<robot name=\"r\">{text}</robot>")).unwrap();
    read_robot(&file, &ReadOptions::default())
}

/// Returns a link with a cube.
fn cube_link(name: &str) -> String {
    format!(
        "<link name=\"{name}\"><collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>"
    )
}

fn joint_element(name: &str, kind: &str, [parent, child]: [&str; 2], rest: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
         {rest}</joint>"
    )
}

#[test]
fn links_and_joints_match_the_file() {
    let arm = read_arm();
    assert_eq!(arm.name(), "arm");
    let links: Vec<_> = arm.links().iter().map(|link| (&*link.name, link.frame)).collect();
    assert_eq!(links, [("base", None), ("upper", Some(0)), ("fore", Some(1)), ("tool", Some(2))]);
    let joints: Vec<_> = arm.joints().iter().map(|j| (&*j.name, j.kind, j.limits)).collect();
    assert_eq!(
        joints,
        [
            ("shoulder", JointKind::Revolute, Some([-3.0, 3.0])),
            ("elbow", JointKind::Continuous, None),
            ("reach", JointKind::Prismatic, Some([0.0, 0.1])),
        ]
    );
    let frames = arm.mechanism().frames();
    assert_eq!(frames[2].joint, Joint::Sliding(DVec3::X));
    assert_eq!(frames[1].origin.translation(), DVec3::X * 0.5);
    assert!(arm.links().iter().all(|link| matches!(link.bodies[..], [AnyBody::Convex(_)])));
    assert!(arm.notes()[0].contains("a cylinder of radius 0.002"), "{:?}", arm.notes());
}

#[test]
fn frames_match_link_poses_of_the_assembly_reader() {
    // The same file in one configuration, read as parts placed in the world.
    let arm = read_arm();
    let values = [("shoulder", 0.7), ("elbow", -0.4), ("reach", 0.05)];
    let joints: BTreeMap<String, f64> = values.map(|(name, x)| (name.to_owned(), x)).into();
    let options = ReadOptions::default().with_joints(joints);
    let parts = colltrans_assembly_io::read::read(data_path("arm.urdf"), &options).expect("parts");
    let path = JointPath::at_unit_times(vec![values.map(|(_, x)| x).to_vec()]).expect("a path");
    let bodies = arm.links().iter().flat_map(|link| {
        let body =
            move |body| PathBody { frame: link.frame, placed: AnyBody::at(body, Pose::IDENTITY) };
        link.bodies.iter().map(body)
    });
    let cast = PathCast::new(arm.mechanism(), &path, bodies.collect(), vec![]).expect("a cast");
    let start = colltrans::motion::path::PathPlace { row: 0, share: 0.0 };
    for (k, part) in parts.parts().iter().enumerate() {
        let AnyBody::Convex(body) = &arm.links()[k].bodies[0] else { panic!("not convex") };
        let pose = cast.world_pose(k, start);
        let place = DAffine3::from_mat3_translation(pose.matrix(), pose.translation());
        for v in body.vertices() {
            let at = place.transform_point3(*v);
            let off = |w: &DVec3| w.distance(at);
            let least = part.solid().vertices().iter().map(off).fold(f64::INFINITY, f64::min);
            // A round shape is circumscribed here and inscribed there, with 64 sides and a radius of 0.002.
            let bound = if part.name() == "tool" { 0.002 * 1.21e-3 } else { 0.0 };
            assert!(least < bound + 1e-12, "{least:e} of {}", part.name());
        }
    }
}

#[test]
fn rows_are_assigned_by_name_or_by_order() {
    let arm = read_arm();
    let none = BTreeMap::new();
    let path = |text: &str, rest: &BTreeMap<String, f64>| {
        arm.joint_path(&Table::parse(text).expect("a table"), rest)
    };
    let (by_order, notes) = path("0.1,0.2,0.05\n0.3,0.4,0.05\n", &none).expect("a path");
    assert_eq!(by_order.rows(), [[0.1, 0.2, 0.05], [0.3, 0.4, 0.05]]);
    assert!(notes.is_empty());
    let (by_name, _) =
        path("reach,time,elbow,shoulder\n0.05,2,0.2,0.1\n0.05,4,0.4,0.3\n", &none).expect("a path");
    assert_eq!(by_name.rows(), by_order.rows());
    assert_eq!(by_name.times(), [2.0, 4.0]);
    let rest = BTreeMap::from([("reach".to_owned(), 0.05)]);
    assert_eq!(path("0.1,0.2\n0.3,0.4\n", &rest).expect("a path").0.rows(), by_order.rows());
    let (_, notes) = path("0,0,0\n0,0,0.2\n4,0,0.3\n", &none).expect("a path");
    assert_eq!(notes.len(), 2);
    assert!(notes[1].contains(
        "joint reach exceeds its limits, 0 to 0.1 m, in 2 of 3 rows; first: 0.2 in row 1"
    ));
    let error_text =
        |text: &str, rest: &BTreeMap<String, f64>| path(text, rest).unwrap_err().to_string();
    assert!(error_text("elbow,reach\n0,0\n", &none).contains("missing values for joint shoulder"));
    assert!(
        error_text("wrist,elbow\n0,0\n", &none)
            .contains("column wrist does not name an independent joint")
    );
    assert!(
        error_text("0,0\n", &none).contains("rows have 2 values, expected 3, one for each joint")
    );
    assert!(error_text("0,0,0\n", &rest).contains("rows have 3 values, expected 2"));
    let wrong = BTreeMap::from([("wrist".to_owned(), 0.0)]);
    assert!(error_text("0,0,0\n", &wrong).contains("joint wrist is not an independent joint"));
    assert!(
        error_text("time,shoulder,elbow,reach\n1,0,0,0\n1,0,0,0\n", &none)
            .contains("times must be finite and increase")
    );
}

#[test]
fn mimic_joints_follow_and_cycles_are_rejected() {
    let follows = "<axis xyz=\"0 1 0\"/><mimic joint=\"b\" multiplier=\"-2\" offset=\"0.5\"/>";
    let of_b = joint_element("b", "prismatic", ["base", "left"], "<axis xyz=\"0 1 0\"/>");
    let text = cube_link("base") + &cube_link("left") + &cube_link("right");
    let hand = read_text(
        &(text.clone() + &of_b + &joint_element("a", "prismatic", ["base", "right"], follows)),
    );
    let hand = hand.expect("a hand");
    let table = Table::parse("0.25\n0.5\n").expect("rows");
    let (path, _) = hand.joint_path(&table, &BTreeMap::new()).expect("a path");
    assert_eq!(path.rows(), [[0.25, 0.0], [0.5, -0.5]]);
    let ring = |of: &str| format!("<mimic joint=\"{of}\"/>");
    let ring = read_text(
        &(text
            + &joint_element("b", "prismatic", ["base", "left"], &ring("a"))
            + &joint_element("a", "prismatic", ["base", "right"], &ring("b"))),
    );
    assert!(ring.unwrap_err().to_string().contains("form a cycle"));
}

#[test]
fn pairs_exclude_neighbours_or_srdf_pairs() {
    let arm = read_arm();
    // base, upper, fore, tool: a chain with one joint between neighbours.
    assert_eq!(arm.checked_pairs(None).expect("pairs"), [[0, 2], [0, 3], [1, 3]]);
    let folder = TemporaryFolder::new();
    let file = folder.path().join("arm.srdf");
    let text = "<robot name=\"arm\"><disable_collisions link1=\"tool\" link2=\"base\" reason=\"Never\"/>\
                <disable_collisions link1=\"base\" link2=\"upper\"/></robot>";
    std::fs::write(&file, text).unwrap();
    let listed = read_disabled_pairs(&file).expect("a list");
    assert_eq!(arm.checked_pairs(Some(&listed)).expect("pairs"), [[0, 2], [1, 2], [1, 3], [2, 3]]);
    let unknown = [["hand".to_owned(), "base".to_owned()]];
    assert!(matches!(arm.checked_pairs(Some(&unknown)), Err(RobotError::Unknown { .. })));
    std::fs::write(&file, "<robot><disable_collisions link1=\"a\"/></robot>").unwrap();
    let error_text = read_disabled_pairs(&file).unwrap_err().to_string();
    assert!(error_text.contains("<disable_collisions> has no attribute link2"), "{error_text}");
    // Links that a fixed joint connects never move relative to each other.
    let held = read_text(
        &(cube_link("a") + &cube_link("b") + &joint_element("j", "fixed", ["a", "b"], "")),
    )
    .expect("a robot");
    assert_eq!(held.checked_pairs(Some(&[])).expect("pairs"), Vec::<[usize; 2]>::new());
    assert_eq!(held.joints_between(1, None), 0);
}

#[test]
fn unsupported_robots_are_rejected_with_reason() {
    let two = cube_link("a") + &cube_link("b");
    let error_text = |text: String| read_text(&text).unwrap_err().to_string();
    let floating = error_text(two.clone() + &joint_element("j", "floating", ["a", "b"], ""));
    assert!(floating.contains("joint j: unsupported type floating"), "{floating}");
    let axis = error_text(
        two.clone() + &joint_element("j", "revolute", ["a", "b"], "<axis xyz=\"0 0 0\"/>"),
    );
    assert!(axis.contains("joint j: invalid axis [0.0, 0.0, 0.0]"), "{axis}");
    let mimic = joint_element("j", "revolute", ["a", "b"], "<mimic joint=\"k\"/>");
    assert!(error_text(two.clone() + &mimic).contains("it mimics k, which is not a moving joint"));
    let none = "<link name=\"a\"/>".to_owned();
    assert!(error_text(none).contains("none of its 1 links has collision geometry"));
    let capsule = "<link name=\"a\"><collision><geometry><capsule radius=\"1\" length=\"1\"/></geometry>\
                   </collision></link>";
    assert!(error_text(two + capsule).contains("duplicate link name"));
    assert!(
        error_text(capsule.to_owned())
            .contains("replace the capsule by a cylinder and two spheres")
    );
}

#[test]
fn path_cast_finds_wire_that_all_samples_miss() {
    let arm = read_arm();
    let table =
        Table::parse(&std::fs::read_to_string(data_path("arm.csv")).unwrap()).expect("rows");
    let (path, _) = arm.joint_path(&table, &BTreeMap::new()).expect("a path");
    let options = BodyOptions::default();
    let wire =
        load(data_path("wire.obj"), &options, |mesh, options| body_from_mesh(&mesh, options));
    let wire = wire.expect("a wire").body;
    let first_contact_along = |path: &JointPath| {
        let bodies = arm.links().iter().flat_map(|link| {
            let body = move |body| PathBody {
                frame: link.frame,
                placed: AnyBody::at(body, Pose::IDENTITY),
            };
            link.bodies.iter().map(body)
        });
        let bodies: Vec<_> =
            bodies.chain([PathBody { frame: None, placed: wire.at(Pose::IDENTITY) }]).collect();
        let cast = PathCast::new(arm.mechanism(), path, bodies, vec![[1, 4], [2, 4], [3, 4]]);
        cast.expect("a cast").first_contact().expect("an answer")
    };
    for pair in path.rows().windows(2) {
        for k in 0..=100 {
            let share = f64::from(k) / 100.0;
            let row = pair[0].iter().zip(&pair[1]).map(|(a, b)| a + (b - a) * share).collect();
            let sample = first_contact_along(&JointPath::at_unit_times(vec![row]).expect("a row"));
            assert!(matches!(sample, PathOutcome::Free(_)), "{sample:?}");
        }
    }
    let PathOutcome::Contact(contact) = first_contact_along(&path) else {
        panic!("the tool passes the wire")
    };
    assert_eq!(contact.pair, [3, 4]);
    assert!(
        0.603 < contact.lower && contact.upper < 0.604 && contact.upper - contact.lower < 1e-12
    );
}
