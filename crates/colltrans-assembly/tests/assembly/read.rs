//! Tests every kind of source with small files that the tests write.

#![allow(clippy::format_push_string, reason = "small files, written for people to read")]

use colltrans_testkit::TemporaryFolder;
use std::collections::BTreeMap;
use std::path::Path;

use crate::common::*;
use base64::Engine;
use colltrans_assembly::plan::Plan;
use colltrans_assembly::report::glb::plan_animation;
use colltrans_assembly::{Assembly, Ignored};
use colltrans_assembly_io::ReadError;
use colltrans_assembly_io::read::{Geometry, ReadOptions, read};
use glam::DVec3;

/// Creates a folder with files.
fn folder(files: &[(&str, &str)]) -> TemporaryFolder {
    let folder = TemporaryFolder::new();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

/// Reads a source with default options.
fn open(path: impl AsRef<Path>) -> Result<Assembly, ReadError> {
    read(path, &ReadOptions::default())
}

/// Returns the corners of a part's box.
fn bounds(assembly: &Assembly, name: &str) -> [DVec3; 2] {
    let bounds = assembly.parts()[assembly.part_index(name).unwrap()].solid().bounds();
    [bounds.low, bounds.high]
}

/// Asserts that a box has these corners, up to `1e-6`.
fn assert_bounds(found: [DVec3; 2], low: [f64; 3], high: [f64; 3]) {
    let off = (found[0] - DVec3::from(low)).abs().max((found[1] - DVec3::from(high)).abs());
    assert!(off.max_element() < 1e-6, "{found:?} is not {low:?} to {high:?}");
}

#[test]
fn folder_is_read_in_natural_order() {
    let folder = folder(&[("p10.off", CUBE), ("p9.off", CUBE), ("notes.txt", "no mesh")]);
    let assembly = open(folder.path()).unwrap();
    assert_eq!(assembly.part_names(&[0, 1]), ["p9", "p10"]);
    assert_eq!(assembly.parts()[0].facet_count(), 6);
    assert!((assembly.parts()[0].solid().volume() - 1.0).abs() < 1e-12);
    assert_eq!(assembly.unit(), None);
}

#[test]
fn unused_manifest_in_folder_is_noted() {
    let toml = "[[part]]\nfile = 'p.off'\ntranslation = [5, 0, 0]\n";
    let folder = folder(&[("p.off", CUBE), ("assembly.toml", toml), ("answer.json", "{}")]);
    let assembly = open(folder.path()).unwrap();
    assert_bounds(bounds(&assembly, "p"), [0.0; 3], [1.0; 3]);
    let [note] = assembly.notes() else { panic!("{:?}", assembly.notes()) };
    assert!(note.starts_with("not read: assembly.toml; "), "{note}");
    assert!(open(folder.path().join("assembly.toml")).unwrap().notes().is_empty());
}

#[test]
fn manifests_in_toml_and_json_place_parts() {
    let toml = "unit = 'mm'\nignore = [['a', 'b']]\nignore_always = [['c', 'b']]\n\
        [[part]]\nfile = 'c.off'\nname = 'a'\n\
        translation = [5, 0, 0]\nrotation = { rpy_degrees = [0, 0, 90] }\nscale = 2\nfixed = true\n\
        [[part]]\nfile = ['c.off', 'c.off']\nname = 'b'\nrotation = [0, 0, 1, 0]\n\
        scale = [1, 1, 3]\n[[part]]\nfile = 'c.off'\nrotation = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]\n";
    let json = r#"{"unit": "mm", "ignore": [["a", "b"]], "ignore_always": [["c", "b"]],
        "parts": [
        {"file": "c.off", "name": "a", "translation": [5, 0, 0],
         "rotation": {"rpy_degrees": [0, 0, 90]}, "scale": 2, "fixed": true},
        {"file": ["c.off", "c.off"], "name": "b", "rotation": {"quaternion": [0, 0, 1, 0]},
         "scale": [1, 1, 3]},
        {"file": "c.off", "rotation": {"matrix": [[0, -1, 0], [1, 0, 0], [0, 0, 1]]}}]}"#;
    let folder = folder(&[("c.off", CUBE), ("m.toml", toml), ("m.json", json)]);
    for file in ["m.toml", "m.json"] {
        let assembly = open(folder.path().join(file)).unwrap();
        assert_eq!(assembly.unit(), Some("mm"));
        assert_eq!(assembly.ignored_contacts(1, 0), Some(Ignored::Overlap));
        assert_eq!(assembly.ignored_contacts(1, 2), Some(Ignored::Always));
        assert_eq!(assembly.ignored_contacts(0, 2), None);
        assert!(assembly.parts()[0].is_fixed());
        assert_bounds(bounds(&assembly, "a"), [3.0, 0.0, 0.0], [5.0, 2.0, 2.0]);
        assert_bounds(bounds(&assembly, "b"), [-1.0, -1.0, 0.0], [0.0, 0.0, 3.0]);
        assert_bounds(bounds(&assembly, "c"), [-1.0, 0.0, 0.0], [0.0, 1.0, 1.0]);
        assert_eq!(assembly.parts()[1].facet_count(), 12);
    }
}

#[test]
fn manifest_errors_state_file_and_place() {
    let cases = [
        ("[[part]]\nfile = 'c.off'\nturned = 3\n", "line 3"),
        ("[[part]]\nfile = 'c.off'\nscale = 0\n", "part 1 (c): invalid scale"),
        ("[[part]]\nfile = 'c.off'\nrotation = [0, 0, 0, 2]\n", "has length 2, expected 1"),
        ("[[part]]\nfile = 'c.off'\nrotation = [[2,0,0],[0,1,0],[0,0,1]]\n", "is not a rotation"),
        ("[[part]]\nfile = 'gone.off'\n", "gone.off"),
        ("ignore = [['c', 'd']]\n[[part]]\nfile = 'c.off'\n", "unknown part d"),
        ("[[part]]\nfile = 'c.off'\n[[part]]\nfile = 'c.off'\n", "duplicate part name c"),
        ("before = [['c', 'c']]\n[[part]]\nfile = 'c.off'\n", "cyclic order constraints: c"),
        ("subassembly = [{ name = ' ', parts = ['c'] }]\n[[part]]\nfile = 'c.off'\n", "empty name"),
        (
            "pair = [{ parts = ['c', 'c'], role = 'press' }]\n[[part]]\nfile = 'c.off'\n",
            "pair c,c names the same part twice",
        ),
        (
            "pair = [{ parts = ['c', 'd'] }]\n[[part]]\nfile = 'c.off'\n[[part]]\nfile = 'c.off'\n\
             name = 'd'\n",
            "neither a role nor a tolerance",
        ),
        // Lists that are too long or too short are rejected.
        ("before = [['c', 'd', 'e']]\n", "found a list of 3, expected a list of 2"),
        ("ignore = [['c']]\n", "found a list of 1, expected a list of 2"),
        ("pair = [{ parts = ['c', 'd', 'e'], role = 'press' }]\n", "expected a list of 2"),
        ("never = [{ parts = ['c'], along = [0, 0, 1, 1] }]\n", "expected a list of 3"),
        ("[[part]]\nfile = 'c.off'\ntranslation = [1, 2, 3, 4]\n", "expected a list of 3"),
    ];
    for (text, wanted) in cases {
        let folder = folder(&[("c.off", CUBE), ("m.toml", text)]);
        let message = open(folder.path().join("m.toml")).unwrap_err().to_string();
        assert!(message.contains(wanted), "{message}");
        assert!(message.contains("m.toml"), "{message}");
    }
    let message = open("/nowhere/at.all").unwrap_err().to_string();
    assert!(message.contains("cannot be read"), "{message}");
}

const URDF: &str = r#"<robot name="r">
  <link name="base"><collision><geometry><mesh filename="package://kit/meshes/c.off"/></geometry>
    </collision></link>
  <link name="arm"><collision><origin xyz="1 0 0" rpy="0 0 0"/><geometry>
    <mesh filename="package://kit/meshes/c.off" scale="2 1 1"/></geometry></collision>
    <visual><geometry><box size="2 2 2"/></geometry></visual></link>
  <link name="lost"><collision><geometry><mesh filename="package://kit/gone.stl"/></geometry>
    </collision></link>
  <joint name="turn" type="revolute"><origin xyz="0 0 1" rpy="0 0 0"/><parent link="base"/>
    <child link="arm"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/>
    </joint>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="lost"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="2" effort="1" velocity="1"/></joint>
</robot>"#;

#[test]
fn joint_values_place_links_of_robot() {
    let folder = folder(&[("robot.urdf", URDF), ("kit/meshes/c.off", CUBE)]);
    let file = folder.path().join("robot.urdf");
    let mut options = ReadOptions::default().with_packages(vec![folder.path().into()]);
    options.joints.insert("turn".into(), std::f64::consts::FRAC_PI_2);
    let message = read(&file, &options).unwrap_err().to_string();
    assert!(message.contains("package://kit/gone.stl"), "{message}");
    options.skip_missing = true;
    let assembly = read(&file, &options).unwrap();
    assert_eq!(assembly.part_names(&[0, 1]), ["base", "arm"]);
    assert_eq!(assembly.notes().len(), 1);
    // From x = 1 to 3, rotated to y, and raised by 1.
    assert_bounds(bounds(&assembly, "arm"), [-1.0, 1.0, 1.0], [0.0, 3.0, 2.0]);
    options.geometry = Geometry::Visual;
    assert_bounds(
        bounds(&read(&file, &options).unwrap(), "arm"),
        [-1.0, -1.0, 0.0],
        [1.0, 1.0, 2.0],
    );
    options.joints.insert("elbow".into(), 1.0);
    let message = read(&file, &options).unwrap_err().to_string();
    assert!(message.contains("unknown joint elbow"), "{message}");
}

#[test]
fn mimic_chain_of_any_length_places_links_and_cycle_is_rejected() {
    // Twenty sliders along x on one base. Each but the first mimics the previous one with the offset 1.
    let robot = |first: &str| {
        let shape = "<collision><geometry><box size='1 1 1'/></geometry></collision>";
        let mut text = format!("<robot name='r'><link name='base'>{shape}</link>");
        for k in 0..20 {
            let mimic = match k {
                0 => first.to_owned(),
                _ => format!("<mimic joint='j{}' offset='1'/>", k - 1),
            };
            text += &format!(
                "<link name='l{k}'>{shape}</link><joint name='j{k}' type='prismatic'><parent link='base'/>\
                 <child link='l{k}'/><axis xyz='1 0 0'/>{mimic}</joint>"
            );
        }
        text + "</robot>"
    };
    let (chain, ring) = (robot(""), robot("<mimic joint='j19'/>"));
    let folder = folder(&[("chain.urdf", &chain), ("ring.urdf", &ring)]);
    let mut options = ReadOptions::default();
    options.joints.insert("j0".into(), 0.25);
    let assembly = read(folder.path().join("chain.urdf"), &options).unwrap();
    for k in 0..20 {
        let x = 0.25 + f64::from(k);
        assert_bounds(
            bounds(&assembly, &format!("l{k}")),
            [x - 0.5, -0.5, -0.5],
            [x + 0.5, 0.5, 0.5],
        );
    }
    let message = open(folder.path().join("ring.urdf")).unwrap_err().to_string();
    assert!(message.contains("joint j0") && message.contains("form a cycle"), "{message}");
}

#[test]
fn entries_of_missing_parts_are_dropped_with_notes() {
    let manifest = r#"
        ignore = [["a", "gone"]]
        before = [["a", "gone"]]
        together = [["a", "b", "gone"]]
        [[part]]
        file = "a.off"
        [[part]]
        file = "b.off"
        [[part]]
        file = "missing.off"
        name = "gone"
        [[pair]]
        parts = ["go*", "b"]
        role = "press"
        [[never]]
        parts = ["gone"]
        along = [0, 0, 1]
    "#;
    let files = [("m.toml", manifest), ("a.off", CUBE), ("b.off", CUBE)];
    let file = folder(&files);
    let path = file.path().join("m.toml");
    assert!(matches!(open(&path), Err(ReadError::MissingMeshes { .. })));
    let options = ReadOptions::default().with_skip_missing(true);
    let assembly = read(&path, &options).unwrap();
    let wanted = [
        "ignore of a, gone is dropped, because some of its parts are left out",
        "before of a, gone is dropped, because some of its parts are left out",
        "pair of go*, b is dropped, because some of its parts are left out",
        "together of a, b, gone applies to a, b only, because some of its parts are left out",
        "never of gone is dropped, because some of its parts are left out",
        "missing.off not found; left out",
    ];
    assert_eq!(assembly.notes(), wanted);
    assert_eq!(assembly.constraints().units()[0].parts, [0, 1]);
    // An unknown name is still an error.
    let wrong = manifest.replace("[[\"a\", \"b\", \"gone\"]]", "[[\"a\", \"bb\"]]");
    let files = [("m.toml", &wrong[..]), ("a.off", CUBE), ("b.off", CUBE)];
    let file = folder(&files);
    let refused = read(file.path().join("m.toml"), &options).unwrap_err().to_string();
    assert!(refused.contains("bb"), "{refused}");
}

#[test]
fn scale_option_scales_matching_parts() {
    let file = folder(&[("bolt_1.off", CUBE), ("bolt_2.off", CUBE), ("lid.off", CUBE)]);
    let scales = BTreeMap::from([("bolt_*".to_owned(), 25.4)]);
    let options = ReadOptions::default().with_scales(scales.clone());
    let assembly = read(file.path(), &options).unwrap();
    let size = |k: usize| assembly.parts()[k].solid().bounds().side_lengths().x;
    assert_eq!([0, 1, 2].map(size), [25.4, 25.4, 1.0]);
    for (name, factor) in [("nut", 1.0), ("lid", 0.0), ("lid", f64::NAN)] {
        let options = ReadOptions::default().with_scales(BTreeMap::from([(name.into(), factor)]));
        assert!(read(file.path(), &options).is_err());
    }
}

#[test]
fn written_glb_is_read_back() {
    let parts = vec![
        part("well", &well([0.0; 3], [2.0; 3], 1.0)),
        part("cube", &[cuboid([0.0; 3], [1.0, 2.0, 3.0])]),
    ];
    let assembly = Assembly::new(parts).unwrap().with_unit("m");
    let folder = TemporaryFolder::new();
    let file = folder.path().join("a.glb");
    std::fs::write(&file, plan_animation(&assembly, &Plan::default())).unwrap();
    let back = open(&file).unwrap();
    assert_eq!(back.part_names(&[0, 1]), ["well", "cube"]);
    assert_eq!(back.unit(), Some("m"));
    // The z axis became the y axis.
    assert_bounds(bounds(&back, "cube"), [0.0, 0.0, -2.0], [1.0, 3.0, 0.0]);
    std::fs::write(&file, b"glTF but not really").unwrap();
    assert!(open(&file).unwrap_err().to_string().contains("a.glb"));
}

#[test]
fn items_of_3mf_package_are_placed_with_unit() {
    let mut model = String::from(
        r#"<?xml version="1.0"?><model unit="inch" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
        <resources><object id="1" name="cube" type="model">"#,
    );
    model += &mesh_of_3mf([1.0; 3]);
    model += r#"</object><object id="2"><components>
        <component objectid="1" transform="0 1 0 -1 0 0 0 0 1 0 0 0"/></components></object></resources>
        <build><item objectid="1" transform="2 0 0 0 2 0 0 0 2 10 0 0"/><item objectid="2"/></build></model>"#;
    let package = |model: &str| package(&[("3D/3dmodel.model", model)]);
    let folder = TemporaryFolder::new();
    let file = folder.path().join("a.3mf");
    std::fs::write(&file, package(&model)).unwrap();
    let assembly = open(&file).unwrap();
    assert_eq!(assembly.unit(), Some("inch"));
    assert_eq!(assembly.part_names(&[0, 1]), ["cube", "cube_2"]);
    assert_bounds(bounds(&assembly, "cube"), [10.0, 0.0, 0.0], [12.0, 2.0, 2.0]);
    assert_bounds(bounds(&assembly, "cube_2"), [-1.0, 0.0, 0.0], [0.0, 1.0, 1.0]);
    std::fs::write(&file, package(&model.replace("objectid=\"2\"", "objectid=\"7\""))).unwrap();
    let message = open(&file).unwrap_err().to_string();
    assert!(message.contains("build item 2: unknown object id 7"), "{message}");
    let refused = |model: &str, words: &str| {
        std::fs::write(&file, package(model)).unwrap();
        let message = open(&file).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    };
    refused(&model.replace("inch", "league"), "unknown unit league; accepted: micron");
    // Each object contains the previous one ten times, which yields 10^12 cubes.
    let ten = |k: usize| {
        let below = format!("<component objectid=\"{}\"/>", k - 1).repeat(10);
        format!("<object id=\"{k}\"><components>{below}</components></object>")
    };
    let nested: String = (3..15).map(ten).collect();
    let many = model.replace("</resources>", &format!("{nested}</resources>"));
    refused(
        &many.replace("<item objectid=\"2\"/>", "<item objectid=\"14\"/>"),
        "build item 2: more than",
    );
    let none = r#"<model unit="foot"><resources/><build/></model>"#;
    std::fs::write(&file, package(none)).unwrap();
    let message = open(&file).unwrap_err().to_string();
    assert!(message.contains("no parts found: its build places no mesh"), "{message}");
}

#[test]
fn gltf_accessors_beyond_buffers_are_rejected() {
    // A triangle repeated three times: 36 bytes of positions and 18 of indices.
    let file = |positions: usize, indices: usize| {
        let mut bytes = Vec::new();
        for x in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            bytes.extend(x.to_le_bytes());
        }
        bytes.extend([0_u16, 1, 2].repeat(3).iter().flat_map(|k| k.to_le_bytes()));
        let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
        serde_json::json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "name": "leaf"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": positions, "type": "VEC3",
                 "min": [0, 0, 0], "max": [1, 1, 0]},
                {"bufferView": 1, "componentType": 5123, "count": indices, "type": "SCALAR"}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36},
                            {"buffer": 0, "byteOffset": 36, "byteLength": 18}],
            "buffers": [{"byteLength": 54, "uri": format!("data:;base64,{data}")}],
        })
    };
    let folder = TemporaryFolder::new();
    let path = folder.path().join("a.gltf");
    let read = |positions: usize, indices: usize| {
        std::fs::write(&path, file(positions, indices).to_string()).unwrap();
        open(&path).map_err(|e| e.to_string())
    };
    assert_eq!(read(3, 3).unwrap().part_names(&[0]), ["leaf"]);
    let refused = |positions: usize, indices: usize, words: &str| {
        let message = read(positions, indices).unwrap_err();
        assert!(message.contains("node 0, mesh 0") && message.contains(words), "{message}");
    };
    refused(1_000_000, 3, "positions extend beyond");
    refused(3, 1_000_000, "indices extend beyond");
    refused(3, 8, "8 indices are not a multiple of 3");
}

#[test]
fn hidden_and_empty_gltf_nodes_are_left_out_with_a_note() {
    let cube = |x: f64| [cuboid([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0])];
    let parts = [("seen", 0.0), ("hidden", 2.0), ("lines", 4.0)];
    let parts = parts.map(|(name, x)| part(name, &cube(x)));
    let assembly = Assembly::new(parts.into()).unwrap().with_unit("m");
    let folder = TemporaryFolder::new();
    let path = folder.path().join("a.gltf");
    let glb = plan_animation(&assembly, &Plan::default());
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut document: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let data = base64::engine::general_purpose::STANDARD.encode(&glb[28 + length..]);
    document["buffers"][0]["uri"] = format!("data:;base64,{data}").into();
    let nodes = document["nodes"].as_array_mut().unwrap();
    let named = |name: &str, nodes: &[serde_json::Value]| {
        nodes.iter().position(|node| node["name"] == name).unwrap()
    };
    let hidden = named("hidden", nodes);
    nodes[hidden]["extensions"] = serde_json::json!({"KHR_node_visibility": {"visible": false}});
    let lines = named("lines", nodes);
    let mesh = usize::try_from(nodes[lines]["mesh"].as_u64().unwrap()).unwrap();
    let own = document["meshes"].as_array().unwrap().len();
    let mut points = document["meshes"][mesh].clone();
    points["primitives"][0]["mode"] = 0.into();
    document["meshes"].as_array_mut().unwrap().push(points);
    document["nodes"][lines]["mesh"] = own.into();
    document["extensionsRequired"] = serde_json::json!(["KHR_node_visibility"]);
    std::fs::write(&path, document.to_string()).unwrap();
    let assembly = open(&path).unwrap();
    assert_eq!(assembly.part_names(&[0]), ["seen"]);
    assert_eq!(assembly.parts().len(), 1);
    assert_eq!(assembly.notes(), ["left out: hidden (hidden), lines (no triangles)"]);
}

#[test]
fn objects_of_3mf_without_triangles_are_left_out_with_a_note() {
    let cube = mesh_of_3mf([1.0; 3]);
    let model = format!(
        "<model unit=\"inch\"><resources><object id=\"1\" name=\"cube\">{cube}</object><object id=\"2\" \
         name=\"bare\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/></vertices><triangles/></mesh></object>\
         </resources><build><item objectid=\"1\"/><item objectid=\"2\"/></build></model>"
    );
    let folder = TemporaryFolder::new();
    let file = folder.path().join("a.3mf");
    std::fs::write(&file, package(&[("3D/3dmodel.model", &model)])).unwrap();
    let assembly = open(&file).unwrap();
    assert_eq!(assembly.parts().len(), 1);
    let [note] = assembly.notes() else { panic!("{:?}", assembly.notes()) };
    assert!(note.contains("left out") && note.contains("bare (no triangles)"), "{note}");
}

#[test]
fn meshes_that_the_build_or_the_scene_does_not_place_are_named_in_a_note() {
    let cube = mesh_of_3mf([1.0; 3]);
    let model = format!(
        "<model unit=\"inch\"><resources><object id=\"1\" name=\"cube\">{cube}</object><object id=\"2\" \
         name=\"spare\">{cube}</object><object id=\"3\"><components><component objectid=\"1\"/></components>\
         </object></resources><build><item objectid=\"3\"/></build></model>"
    );
    let folder = TemporaryFolder::new();
    let file = folder.path().join("a.3mf");
    std::fs::write(&file, package(&[("3D/3dmodel.model", &model)])).unwrap();
    let found = open(&file).unwrap();
    assert_eq!(found.notes(), ["left out because no item of the build places them: spare"]);
    let parts =
        [0.0, 2.0].map(|x| part(&format!("at{x}"), &[cuboid([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0])]));
    let assembly = Assembly::new(parts.into()).unwrap().with_unit("m");
    let glb = plan_animation(&assembly, &Plan::default());
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut document: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let data = base64::engine::general_purpose::STANDARD.encode(&glb[28 + length..]);
    document["buffers"][0]["uri"] = format!("data:;base64,{data}").into();
    let spare = document["nodes"].as_array().unwrap().iter().find(|node| node["mesh"].is_u64());
    let mut spare = spare.unwrap().clone();
    spare["name"] = "spare".into();
    document["nodes"].as_array_mut().unwrap().push(spare);
    let file = folder.path().join("a.gltf");
    std::fs::write(&file, document.to_string()).unwrap();
    assert_eq!(open(&file).unwrap().notes(), ["left out because they are not in the scene: spare"]);
}

#[test]
fn rounded_rotations_are_normalised_and_shears_rejected() {
    let manifest = |rotation: &str| {
        let toml = format!("[[part]]\nfile = 'c.off'\nrotation = {rotation}\n");
        let folder = folder(&[("c.off", CUBE), ("m.toml", &toml)]);
        open(folder.path().join("m.toml"))
    };
    for exact in ["[0, 0, 0, 1]", "[0, 0, 0.6, 0.8]", "[[0, -1, 0], [1, 0, 0], [0, 0, 1]]"] {
        assert!(manifest(exact).unwrap().notes().is_empty());
    }
    for few in [
        "[[1, 0.0009, 0], [0, 1, 0], [0, 0, 1]]",
        "[[1, 0.015, 0], [0, 1, 0], [0, 0, 1]]",
        "[[0.87, -0.5, 0], [0.5, 0.87, 0], [0, 0, 1]]",
        "[[0.866, -0.5, 0], [0.5, 0.866, 0], [0, 0, 1]]",
        "[0, 0, 0.38, 0.92]",
    ] {
        let assembly = manifest(few).unwrap();
        let [note] = assembly.notes() else { panic!("{:?}", assembly.notes()) };
        assert!(
            note.starts_with("the rotation of c deviates ") && note.contains("normalised"),
            "{note}"
        );
        // A shear would keep the volume, but not the lengths of the edges.
        let solid = assembly.parts()[0].solid();
        let corner = |k: usize| solid.vertices()[k];
        for (a, b) in [(0, 1), (0, 2), (0, 4)] {
            assert!((corner(a).distance(corner(b)) - 1.0).abs() < 1e-12);
        }
    }
    // Poses have the same limit of 0.02.
    let sheared = "[[1, 0.025, 0], [0, 1, 0], [0, 0, 1]]";
    let mirrored = "[[-1, 0, 0], [0, 1, 0], [0, 0, 1]]";
    for sheared in [sheared, mirrored, "[0, 0, 0.3, 0.9]"] {
        assert!(manifest(sheared).is_err());
    }
}
