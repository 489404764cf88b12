//! Tests robots: URDF and SRDF files, rows by name and by order, pairs, and a wire that all samples miss.

use colltrans_testkit::TemporaryFolder;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use colltrans::motion::path::{Joint, JointPath, PathBody, PathCast, PathOutcome};
use colltrans::{AnyBody, Pose};
use colltrans_assembly_io::ReadError;
use colltrans_assembly_io::read::{ReadOptions, read_disabled_pairs, read_robot};
use colltrans_assembly_io::robot::{Cell, JointKind, Robot, RobotError, Table, body_from_mesh};
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
    let of_shape = |shape: &str| {
        format!("<link name=\"a\"><collision><geometry>{shape}</geometry></collision></link>")
    };
    let capsule = of_shape("<capsule radius=\"1\" length=\"1\"/>");
    assert!(error_text(two + &capsule).contains("duplicate link name"));
    let negative = error_text(of_shape("<sphere radius=\"-1\"/>"));
    assert!(negative.contains("link a: line 1: a sphere has sizes [-1.0]"), "{negative}");
    let missing = error_text(of_shape("<capsule radius=\"1\"/>"));
    assert!(missing.contains("<capsule> has no attribute length"), "{missing}");
    let unknown = error_text(of_shape("<cone radius=\"1\"/>"));
    assert!(unknown.contains("unknown geometry cone; accepted: mesh, box"), "{unknown}");
}

/// Returns the time at which the only pair of a robot's cell first meets on a path of one joint, from 0 to 1.
fn first_contact_time(robot: Robot, until: f64) -> f64 {
    let path = JointPath::at_unit_times(vec![vec![0.0], vec![until]]).expect("a path");
    let cell = Cell::new(robot, Vec::new(), Some(&[])).expect("a cell");
    let cast = cell.path_cast(&path, 0.0).expect("a cast");
    let PathOutcome::Contact(contact) = cast.first_contact().expect("an answer") else {
        panic!("no contact")
    };
    assert_eq!(cast.verify(&contact.proof).expect("a proof"), [contact.lower, contact.upper]);
    assert!(contact.upper - contact.lower < 1e-11);
    0.5 * (contact.lower + contact.upper) * until
}

#[test]
fn spheres_and_capsules_are_exact() {
    let link = |name: &str, shape: &str, origin: &str| {
        format!(
            "<link name=\"{name}\"><collision><origin {origin}/><geometry>{shape}</geometry></collision></link>"
        )
    };
    let slides = joint_element("j", "prismatic", ["a", "b"], "<axis xyz=\"0 0 -1\"/>");
    let ball = "<sphere radius=\"0.5\"/>";
    let robot = |capsule: &str| {
        let text = link("a", capsule, "rpy=\"0 1.5707963267948966 0\"")
            + &link("b", ball, "xyz=\"0.25 0 3\"");
        read_text(&(text + &slides)).expect("a robot")
    };
    // The capsule lies along x, so that it is met as a cylinder.
    let found = robot("<capsule radius=\"0.25\" length=\"1\"/>");
    assert!(found.notes().is_empty(), "{:?}", found.notes());
    assert!((first_contact_time(found, 3.0) - 2.25).abs() < 1e-10);
    // The ball meets a half sphere: its centre is 3/4 from the end of the axis, a quarter aside.
    let time = first_contact_time(robot("<capsule radius=\"0.25\" length=\"0.001\"/>"), 3.0);
    assert!((time - (3.0 - (0.5625_f64 - 0.2495 * 0.2495).sqrt())).abs() < 1e-10, "{time}");
    // A cylinder stays a polyhedron, which is noted.
    let noted = robot("<cylinder radius=\"0.25\" length=\"1\"/>");
    assert!(
        noted.notes()[0].contains("a cylinder of radius 0.25 is replaced"),
        "{:?}",
        noted.notes()
    );
}

#[test]
fn round_links_are_checked_against_solids() {
    let text = "<link name=\"a\"><collision><geometry><mesh filename=\"frame.off\"/></geometry></collision></link>\
                <link name=\"b\"><collision><origin xyz=\"0 0 3\"/><geometry><sphere radius=\"0.5\"/></geometry>\
                </collision></link>"
        .to_owned();
    let slides = joint_element("j", "prismatic", ["a", "b"], "<axis xyz=\"0 0 -1\"/>");
    let folder = TemporaryFolder::new();
    let file = folder.path().join("robot.urdf");
    std::fs::write(&file, format!("<robot name=\"r\">{text}{slides}</robot>")).unwrap();
    // A prism with a notch: two steps, of the heights 1 and 2.
    let profile = [(-2.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.25, 2.0), (0.25, 1.0), (-2.0, 1.0)];
    let corners = |y: f64| profile.map(|(x, z)| format!("{x} {y} {z}")).join("\n");
    let sides: Vec<String> =
        (0..6).map(|k| format!("4 {} {k} {} {}", (k + 1) % 6, k + 6, (k + 1) % 6 + 6)).collect();
    let fan = [[0, 1, 4], [1, 2, 3], [1, 3, 4], [0, 4, 5]];
    let ends: Vec<String> = fan
        .iter()
        .flat_map(|[a, b, c]| {
            [format!("3 {a} {b} {c}"), format!("3 {} {} {}", c + 6, b + 6, a + 6)]
        })
        .collect();
    let parts = [corners(-2.0), corners(2.0), sides.join("\n"), ends.join("\n")];
    let off = format!("OFF\n12 14 0\n{}\n", parts.join("\n"));
    std::fs::write(folder.path().join("frame.off"), off).unwrap();
    let robot = read_robot(&file, &ReadOptions::default()).expect("a robot");
    assert!(matches!(robot.links()[0].bodies[..], [AnyBody::Solid(_)]));
    // The ball, with its centre over the lower step, meets the edge of the upper one.
    let expected = 3.0 - (2.0 + (0.25_f64 - 0.0625).sqrt());
    assert!((first_contact_time(robot, 3.0) - expected).abs() < 1e-9);
}

/// Reads a robot from an MJCF file with these contents.
fn read_mjcf(text: &str) -> Result<Robot, ReadError> {
    let folder = TemporaryFolder::new();
    let file = folder.path().join("robot.xml");
    std::fs::write(&file, format!("<mujoco model=\"m\">{text}</mujoco>")).unwrap();
    read_robot(&file, &ReadOptions::default())
}

/// An arm with two hinges of one body, a slide, defaults and a geom for display.
const MJCF_ARM: &str = r#"
<compiler angle="degree" eulerseq="zyx"/>
<default><geom size="0.1"/><default class="shown"><geom contype="0" conaffinity="0"/></default></default>
<worldbody>
  <geom type="box" size="1 1 0.1" pos="0 0 -0.1"/>
  <body name="upper" pos="0 0 0.5" euler="90 0 0">
    <joint name="yaw" axis="0 0 1" range="-90 45"/>
    <joint name="pitch" type="hinge" axis="0 1 0" pos="0.25 0 0"/>
    <geom type="capsule" fromto="0 0 0 1 0 0"/>
    <geom type="mesh" mesh="cover" class="shown"/>
    <site name="mark"/>
    <frame pos="1 0 0">
      <body name="tip" pos="0.5 0 0" quat="0.5 0.5 0.5 0.5">
        <joint name="out" type="slide" axis="1 0 0"/>
        <geom/>
      </body>
    </frame>
  </body>
</worldbody>"#;

#[test]
fn mjcf_bodies_are_placed_by_their_joints() {
    let arm = read_mjcf(MJCF_ARM).expect("a robot");
    assert_eq!(arm.name(), "m");
    let links: Vec<_> =
        arm.links().iter().map(|link| (&*link.name, link.frame, link.bodies.len())).collect();
    assert_eq!(links, [("world", None, 1), ("upper", Some(1), 1), ("tip", Some(2), 1)]);
    let joints: Vec<_> = arm.joints().iter().map(|j| (&*j.name, j.kind, j.limits)).collect();
    let quarter = std::f64::consts::FRAC_PI_2;
    assert_eq!(
        joints,
        [
            ("yaw", JointKind::Revolute, Some([-quarter, 0.5 * quarter])),
            ("pitch", JointKind::Continuous, None),
            ("out", JointKind::Prismatic, None),
        ]
    );
    let path = JointPath::at_unit_times(vec![vec![0.3, -0.7, 0.2]]).expect("a path");
    let bodies = arm
        .links()
        .iter()
        .map(|link| PathBody { frame: link.frame, placed: link.bodies[0].at(Pose::IDENTITY) });
    let cast = PathCast::new(arm.mechanism(), &path, bodies.collect(), vec![]).expect("a cast");
    let start = colltrans::motion::path::PathPlace { row: 0, share: 0.0 };
    let place = |body: usize| {
        let AnyBody::Convex(of) = &arm.links()[body].bodies[0] else { panic!("not convex") };
        assert_eq!(of.radius(), 0.1);
        let pose = cast.world_pose(body, start);
        let at = DAffine3::from_mat3_translation(pose.matrix(), pose.translation());
        of.vertices().iter().map(|v| at.transform_point3(*v)).collect::<Vec<_>>()
    };
    // The same chain of joints, multiplied by hand.
    let upper = DAffine3::from_translation(DVec3::Z * 0.5)
        * DAffine3::from_rotation_z(quarter)
        * DAffine3::from_rotation_z(0.3)
        * DAffine3::from_translation(DVec3::X * 0.25)
        * DAffine3::from_rotation_y(-0.7)
        * DAffine3::from_translation(DVec3::X * -0.25);
    let near = |points: &[DVec3], wanted: DVec3| points.iter().any(|p| p.distance(wanted) < 1e-13);
    for end in [DVec3::ZERO, DVec3::X] {
        assert!(near(&place(1), upper.transform_point3(end)));
    }
    // The quaternion maps x to y, along which the tip slides.
    assert!(near(&place(2), upper.transform_point3(DVec3::new(1.5, 0.2, 0.0))));
}

/// A chain of bodies in all forms of orientations.
const MJCF_CHAIN: &str = r#"
  <compiler angle="degree" eulerseq="zyx"/>
  <default>
    <geom size="0.05"/>
    <default class="arm">
      <geom type="capsule" size="0.04"/>
      <joint type="slide" axis="1 1 0"/>
    </default>
  </default>
  <worldbody>
    <geom type="box" size="0.2 0.3 0.1" pos="0.1 0 -0.4" axisangle="1 2 3 40"/>
    <body name="first" pos="0 0 0.2" euler="20 -30 40" childclass="arm">
      <joint name="a" type="hinge" axis="0 1 1" pos="0.1 0 0"/>
      <geom fromto="0 0 0 0.5 0 0.1"/>
      <frame pos="0.5 0 0" zaxis="1 0 1">
        <body name="second" xyaxes="1 1 0 0 1 1">
          <joint name="b" type="hinge" axis="1 0 0"/>
          <joint name="c" pos="0 0.2 0"/>
          <geom type="sphere" pos="0.2 0 0"/>
          <geom size="0.03 0.2" pos="0 0.1 0" quat="1 2 3 4"/>
          <body name="third" pos="0.3 0 0" quat="0.5 0.5 -0.5 0.5">
            <joint name="d" type="hinge" axis="0 0 1" pos="-0.1 0 0" range="-90 90"/>
            <geom class="main" pos="0 0 0.4"/>
            <geom class="main" contype="0" conaffinity="0" size="3"/>
          </body>
        </body>
      </frame>
    </body>
  </worldbody>
"#;

#[test]
fn mjcf_bodies_are_where_mujoco_places_them() {
    let chain = read_mjcf(MJCF_CHAIN).expect("a robot");
    let found = placed_vertices(chain, &[0.3, -0.7, 0.2, 0.5]);
    // Centres of spheres, ends of axes and a corner, computed by MuJoCo 4.0.0 (`mj_kinematics`).
    let wanted = [
        ("world", [0.151_336_560_555, 0.352_473_885_014, -0.285_428_110_194]),
        ("first", [0.358_975_974_228, 0.190_916_352_567, 0.508_696_294_473]),
        ("first", [0.012_493_481_388, -0.026_781_676_746, 0.204_463_735_092]),
        ("second", [0.198_161_995_332, 0.551_881_266_189, 0.584_979_598_797]),
        ("second", [0.264_373_154_546, 0.223_641_554_989, 0.485_607_699_414]),
        ("second", [0.064_743_844_588, 0.443_446_870_140, 0.753_625_911_551]),
        ("third", [0.457_296_514_534, 0.699_780_274_360, 0.313_253_592_809]),
    ];
    for (body, point) in wanted {
        let point = DVec3::from_array(point);
        assert!(
            found.iter().any(|(name, at)| name == body && at.distance(point) < 1e-11),
            "{body} {point}: {found:?}"
        );
    }
}

#[test]
fn mjcf_geoms_have_the_sizes_of_the_format() {
    let extent = |geom: &str| {
        let robot = read_mjcf(&format!("<worldbody><geom {geom}/></worldbody>")).expect(geom);
        let AnyBody::Convex(body) = &robot.links()[0].bodies[0] else { panic!("not convex") };
        let (low, high) = body
            .vertices()
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        (high - low + DVec3::splat(2.0 * body.radius())).to_array().map(|x| (x * 1e3).round() / 1e3)
    };
    assert_eq!(extent("size=\"1\""), [2.0; 3]);
    assert_eq!(extent("type=\"box\" size=\"1 2 3\""), [2.0, 4.0, 6.0]);
    assert_eq!(extent("type=\"box\" size=\"1\" fromto=\"0 0 0 0 5 0\""), [2.0, 5.0, 2.0]);
    assert_eq!(extent("type=\"capsule\" size=\"1 2\""), [2.0, 2.0, 6.0]);
    assert_eq!(extent("type=\"capsule\" size=\"1\" fromto=\"0 0 0 4 0 0\""), [6.0, 2.0, 2.0]);
    let cylinder = extent("type=\"cylinder\" size=\"1 2\" zaxis=\"1 0 0\"");
    assert!(cylinder[0] == 4.0 && (2.0..2.01).contains(&cylinder[1]), "{cylinder:?}");
}

#[test]
fn unsupported_mjcf_elements_are_rejected_with_their_place() {
    let error_text = |text: &str| read_mjcf(text).unwrap_err().to_string();
    let of_geom =
        |geom: &str| error_text(&format!("<worldbody>\n<geom name=\"g\" {geom}/></worldbody>"));
    for (geom, reason) in [
        (
            "type=\"ellipsoid\" size=\"1 2 3\"",
            "unsupported type ellipsoid; accepted: sphere, capsule, box",
        ),
        ("type=\"plane\" size=\"1 1 1\"", "unsupported type plane"),
        ("mesh=\"m\"", "unsupported type mesh"),
        ("type=\"box\" size=\"1 2\"", "size=\"1 2\" is invalid; expected 3 numbers"),
        ("size=\"-1\"", "a sphere has sizes [-1.0]; accepted: finite and positive"),
        ("type=\"box\"", "missing attribute size"),
        ("size=\"1\" pos=\"0 0\"", "pos=\"0 0\" of <geom> is invalid; expected 3 numbers"),
        ("size=\"1\" quat=\"0 0 0 0\"", "quat=\"0 0 0 0\" is not an orientation"),
        (
            "size=\"1\" quat=\"1 0 0 0\" euler=\"0 0 0\"",
            "several orientations: quat, euler; accepted: one",
        ),
        ("size=\"1\" class=\"none\"", "unknown class none"),
    ] {
        let text = of_geom(geom);
        assert!(text.contains(&format!("MJCF: line 2: geom g: {reason}")), "{geom}: {text}");
        assert!(text.contains("robot.xml"), "{text}");
    }
    let of_joint = |joint: &str| {
        error_text(&format!(
            "<worldbody><body name=\"b\">{joint}<geom size=\"1\"/></body></worldbody>"
        ))
    };
    assert!(of_joint("<freejoint/>").contains("unsupported type free; accepted: hinge, slide"));
    assert!(of_joint("<joint type=\"ball\"/>").contains("unsupported type ball"));
    assert!(of_joint("<joint axis=\"0 0 0\"/>").contains("invalid axis"));
    assert!(of_joint("<joint ref=\"1\"/>").contains("unsupported ref"));
    assert!(of_joint("<composite/>").contains("unsupported in body"));
    let twice = "<worldbody><body name=\"b\"/><body name=\"b\"/></worldbody>";
    assert!(error_text(twice).contains("body b: duplicate name"));
    assert!(error_text("<include file=\"other.xml\"/>").contains("unsupported element include"));
    assert!(error_text("<compiler eulerseq=\"abc\"/>").contains("accepted: three of xyzXYZ"));
    assert!(error_text("<worldbody/>").contains("none of its 0 bodies has a geom that collides"));
}

/// Reads a robot from an SDF file of version 1.11 with these contents.
fn read_sdf(text: &str) -> Result<Robot, ReadError> {
    read_sdf_of("1.11", text)
}

fn read_sdf_of(version: &str, text: &str) -> Result<Robot, ReadError> {
    let folder = TemporaryFolder::new();
    let file = folder.path().join("robot.sdf");
    std::fs::write(&file, format!("<sdf version=\"{version}\">{text}</sdf>")).unwrap();
    read_robot(&file, &ReadOptions::default())
}

/// Returns the vertices of all convex bodies in the world, with the names of their links, for a row of joint values.
fn placed_vertices(robot: Robot, row: &[f64]) -> Vec<(String, DVec3)> {
    let path = JointPath::at_unit_times(vec![row.to_vec()]).expect("a path");
    let cell = Cell::new(robot, Vec::new(), None).expect("a cell");
    let cast = cell.path_cast(&path, 0.0).expect("a cast");
    let start = colltrans::motion::path::PathPlace { row: 0, share: 0.0 };
    let place = |(k, placed): (usize, colltrans::AnyPlaced<'_>)| {
        let colltrans::AnyPlaced::Convex(placed) = placed else { panic!("not convex") };
        let pose = cast.world_pose(k, start);
        let at = DAffine3::from_mat3_translation(pose.matrix(), pose.translation());
        let points = placed.body.vertices().iter().map(|v| at.transform_point3(*v));
        points.map(|point| (cell.names()[k].clone(), point)).collect::<Vec<_>>()
    };
    cast.bodies().enumerate().flat_map(place).collect()
}

fn assert_has_vertex(found: &[(String, DVec3)], link: &str, point: DVec3) {
    assert!(
        found.iter().any(|(name, at)| name == link && at.distance(point) < 1e-13),
        "{link} {point}: {found:?}"
    );
}

/// An arm whose poses are relative to its model, to links, joints and a frame.
const SDF_ARM: &str = r#"
<model name="base">
  <pose>0 0 0.5 0 0 0</pose>
  <frame name="flange" attached_to="upper"><pose>1 0 0 0 0 0</pose></frame>
  <link name="base">
    <inertial><mass>1</mass></inertial>
    <collision name="c"><geometry><box><size>1 1 0.2</size></box></geometry></collision>
    <visual name="v"><geometry><plane/></geometry></visual>
  </link>
  <link name="upper">
    <pose relative_to="yaw"/>
    <collision name="c">
      <pose>0.5 0 0 0 1.5707963267948966 0</pose>
      <geometry><capsule><radius>0.1</radius><length>1</length></capsule></geometry>
    </collision>
  </link>
  <joint name="yaw" type="revolute">
    <parent>base</parent><child>upper</child>
    <pose relative_to="base" degrees="true">0 0 0.1 0 0 90</pose>
    <axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>2</upper></limit></axis>
  </joint>
  <link name="tip">
    <pose relative_to="flange" rotation_format="quat_xyzw">0.5 0 0 0 0 0.6 0.8</pose>
    <collision name="c">
      <pose relative_to="flange">0.5 0.25 0 0 0 0</pose>
      <geometry><sphere><radius>0.1</radius></sphere></geometry>
    </collision>
    <collision name="none"><geometry><empty/></geometry></collision>
  </link>
  <joint name="reach" type="prismatic">
    <parent>flange</parent><child>tip</child>
    <axis><xyz expressed_in="__model__">0 1 0</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit></axis>
  </joint>
  <joint name="mount" type="fixed"><parent>world</parent><child>base</child></joint>
</model>"#;

#[test]
fn sdf_links_are_placed_relative_to_named_frames() {
    let arm = read_sdf(SDF_ARM).expect("a robot");
    assert_eq!(arm.name(), "base");
    let links: Vec<_> =
        arm.links().iter().map(|link| (&*link.name, link.frame, link.bodies.len())).collect();
    assert_eq!(links, [("base", Some(0), 1), ("upper", Some(1), 1), ("tip", Some(2), 1)]);
    let joints: Vec<_> = arm.joints().iter().map(|j| (&*j.name, j.kind, j.limits)).collect();
    assert_eq!(
        joints,
        [("yaw", JointKind::Revolute, Some([-1.0, 2.0])), ("reach", JointKind::Prismatic, None),]
    );
    let AnyBody::Convex(capsule) = &arm.links()[1].bodies[0] else { panic!("not convex") };
    assert_eq!((capsule.vertices().len(), capsule.radius()), (2, 0.1));
    let found = placed_vertices(arm, &[0.3, 0.2]);
    // The same chain of poses, multiplied by hand; at the joint positions 0 the links are where rod 0.5.0, a reader in
    // Python, places them. The y axis of the model is then the x axis of the upper arm.
    let upper = DAffine3::from_translation(DVec3::new(0.0, 0.0, 0.6))
        * DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2 + 0.3);
    assert_has_vertex(&found, "base", DVec3::new(0.5, -0.5, 0.6));
    for end in [DVec3::ZERO, DVec3::X] {
        assert_has_vertex(&found, "upper", upper.transform_point3(end));
    }
    assert_has_vertex(&found, "tip", upper.transform_point3(DVec3::new(1.7, 0.25, 0.0)));
}

/// Two models of a world, one of which has a nested model, and the other is static.
const SDF_WORLD: &str = r#"
<world name="cell">
  <gravity>0 0 -9.8</gravity>
  <model name="robot" canonical_link="arm::forearm">
    <pose>1 0 0 0 0 0</pose>
    <link name="base"><collision name="c"><geometry><sphere><radius>1</radius></sphere></geometry></collision></link>
    <model name="arm">
      <pose relative_to="base">0 2 0 0 0 0</pose>
      <frame name="tool"><pose>0 0 3 0 0 0</pose></frame>
      <link name="forearm">
        <collision name="c">
          <pose relative_to="tool"/><geometry><sphere><radius>1</radius></sphere></geometry>
        </collision>
      </link>
    </model>
    <joint name="elbow" type="continuous">
      <parent>base</parent><child>arm</child>
      <pose relative_to="arm::tool"/>
      <axis><xyz>1 0 0</xyz></axis>
    </joint>
  </model>
  <model name="table">
    <static>true</static>
    <pose relative_to="robot">0 0 -5 0 0 0</pose>
    <link name="top"><collision name="c"><geometry><sphere><radius>1</radius></sphere></geometry></collision></link>
    <link name="leaf"><pose>0 1 0 0 0 0</pose></link>
    <joint name="hinge" type="revolute"><parent>top</parent><child>leaf</child><axis><xyz>1 0 0</xyz></axis></joint>
  </model>
</world>"#;

#[test]
fn sdf_worlds_nested_models_and_static_models_are_read() {
    let cell = read_sdf(SDF_WORLD).expect("a robot");
    assert_eq!(cell.name(), "cell");
    let links: Vec<_> = cell.links().iter().map(|link| (&*link.name, link.frame)).collect();
    let expected = [
        ("robot::base", None),
        ("robot::arm::forearm", Some(0)),
        ("table::top", None),
        ("table::leaf", None),
    ];
    assert_eq!(links, expected);
    let joints: Vec<_> = cell.joints().iter().map(|j| (&*j.name, j.kind)).collect();
    assert_eq!(joints, [("robot::elbow", JointKind::Continuous)]);
    assert_eq!(cell.mechanism().frames()[0].origin.translation(), DVec3::new(1.0, 2.0, 3.0));
    let found = placed_vertices(cell, &[0.7]);
    // The centre of the forearm's sphere is on its axis.
    assert_has_vertex(&found, "robot::arm::forearm", DVec3::new(1.0, 2.0, 3.0));
    assert_has_vertex(&found, "table::top", DVec3::new(1.0, 0.0, -5.0));
}

#[test]
fn sdf_models_without_links_are_carried_by_a_nested_one() {
    let ball = "<collision name=\"c\"><geometry><sphere><radius>1</radius></sphere></geometry></collision>";
    let robot = read_sdf(&format!(
        "<model name=\"outer\"><model name=\"inner\" canonical_link=\"b\"><link name=\"a\">{ball}</link>\
         <link name=\"b\">{ball}</link></model><joint name=\"lift\" type=\"prismatic\"><parent>world</parent>\
         <child>__model__</child><axis><xyz>0 0 1</xyz><limit><upper>2</upper></limit></axis></joint></model>"
    ));
    let robot = robot.expect("a robot");
    let frames: Vec<_> = robot.links().iter().map(|link| (&*link.name, link.frame)).collect();
    assert_eq!(frames, [("inner::a", None), ("inner::b", Some(0))]);
    let note = "joint lift: a limit at one end alone is not applied";
    assert!(robot.notes().iter().any(|said| said == note), "{:?}", robot.notes());
}

#[test]
fn sdf_axes_of_old_versions_are_in_the_frame_of_the_model() {
    let robot = |version: &str, axis: &str| {
        let text = format!(
            "<model name=\"m\"><link name=\"a\"/><link name=\"b\"><pose>0 0 0 0 0 1.5707963267948966</pose>\
             <collision name=\"c\"><geometry><sphere><radius>1</radius></sphere></geometry></collision></link>\
             <joint name=\"j\" type=\"prismatic\"><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz>{axis}\
             </axis></joint></model>"
        );
        let robot = read_sdf_of(version, &text).expect("a robot");
        assert_eq!(robot.joints()[0].limits, None);
        placed_vertices(robot, &[2.0])
    };
    for (version, axis, end) in [
        ("1.4", "", DVec3::X),
        ("1.6", "", DVec3::Y),
        ("1.6", "<use_parent_model_frame>true</use_parent_model_frame>", DVec3::X),
        ("1.10", "", DVec3::Y),
    ] {
        assert_has_vertex(&robot(version, axis), "b", end * 2.0);
    }
}

#[test]
fn unsupported_sdf_elements_are_rejected_with_their_place() {
    let error_text = |text: &str| read_sdf(text).unwrap_err().to_string();
    let of_shape = |shape: &str| {
        error_text(&format!(
            "<model name=\"m\"><link name=\"l\"><collision name=\"c\"><geometry>\n{shape}</geometry>\
             </collision></link></model>"
        ))
    };
    for (shape, reason) in [
        (
            "<ellipsoid><radii>1 2 3</radii></ellipsoid>",
            "unsupported geometry ellipsoid; accepted: mesh, box",
        ),
        ("<plane/>", "unsupported geometry plane"),
        ("<sphere/>", "<sphere> has no element radius"),
        (
            "<sphere><radius>-1</radius></sphere>",
            "a sphere has sizes [-1.0]; accepted: finite and positive",
        ),
        ("<sphere><radius>1 2</radius></sphere>", "<radius> is \"1 2\"; accepted: a number"),
        ("<box><size>1 2</size></box>", "<size> is \"1 2\"; accepted: 3 numbers"),
        ("<mesh><uri>a.stl</uri><submesh/></mesh>", "unsupported element submesh"),
        ("<mesh/>", "<mesh> has no element uri"),
    ] {
        let text = of_shape(shape);
        assert!(text.contains(&format!("SDF: line 2: link l: {reason}")), "{shape}: {text}");
        assert!(text.contains("robot.sdf"), "{text}");
    }
    let in_model = |text: &str| {
        error_text(&format!(
            "<model name=\"m\">\n{text}<link name=\"a\"/><link name=\"b\"/></model>"
        ))
    };
    let joint = |kind: &str, rest: &str| {
        format!(
            "<joint name=\"j\" type=\"{kind}\"><parent>a</parent><child>b</child>{rest}</joint>"
        )
    };
    let fixed = joint("fixed", "");
    let axis = "<axis><xyz expressed_in=\"z\">0 0 1</xyz></axis>";
    let back = "<joint name=\"k\" type=\"fixed\"><parent>b</parent><child>a</child></joint>";
    let of_itself = "<frame name=\"f\"><pose relative_to=\"f\"/></frame><link name=\"l\">\
        <collision name=\"c\"><pose relative_to=\"f\"/><geometry><empty/></geometry></collision></link>";
    let attached = "<frame name=\"f\" attached_to=\"g\"/><frame name=\"g\" attached_to=\"f\"/>";
    for (text, reason) in [
        ("<include><uri>x</uri></include>".into(), "include without a name: unsupported in model"),
        (joint("ball", ""), "joint j: unsupported type ball; accepted: fixed, revolute"),
        (joint("revolute", ""), "joint j: missing element axis"),
        (
            joint("revolute", "<axis><xyz>0 0 0</xyz></axis>"),
            "joint j: invalid axis [0.0, 0.0, 0.0]",
        ),
        (joint("revolute", axis), "joint j: unknown frame z"),
        (joint("fixed", "<pose>1 2</pose>"), "joint j: <pose> is \"1 2\"; accepted: 6 numbers"),
        (fixed.replace("child>b", "child>world"), "joint j: its child is the world"),
        (fixed.clone() + "<link name=\"j\"/>", "link j: duplicate name"),
        (fixed.clone() + &fixed.replace("\"j\"", "\"k\""), "link b already is the child"),
        (fixed.clone() + back, "its joints form a cycle"),
        (of_itself.into(), "frame f: its pose is relative to itself"),
        (attached.to_owned() + &fixed.replace("child>b", "child>f"), "it is attached to itself"),
        (
            "<model name=\"n\" placement_frame=\"q\"/>".into(),
            "model n: unsupported placement_frame q",
        ),
    ] {
        let error = in_model(&text);
        assert!(error.contains("SDF: line 2: ") && error.contains(reason), "{text}: {error}");
    }
    assert!(error_text("").contains("0 models and worlds; accepted: one model or one world"));
    assert!(
        error_text("<model name=\"m\"/>").contains("none of its 0 links has collision geometry")
    );
    for version in ["1", "1.2"] {
        let error = read_sdf_of(version, "<model name=\"m\"/>").unwrap_err().to_string();
        assert!(error.contains(&format!("SDF: line 1: unsupported version {version};")), "{error}");
    }
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
