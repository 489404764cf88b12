//! Several bodies in one file: kept as one part, or split into parts.

#![allow(clippy::format_push_string, reason = "small files, written for people to read")]

use colltrans_testkit::TemporaryFolder;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::common::{CUBE, mesh_of_3mf, package};
use colltrans_assembly::plan::Plan;
use colltrans_assembly::{Assembly, Bodies, Fit, FreeTravel, Part};
use colltrans_assembly_io::ReadError;
use colltrans_assembly_io::read::{ReadOptions, Split, read_from};
use colltrans_testkit::shapes::{Mesh, block};

type Files = BTreeMap<PathBuf, Vec<u8>>;

fn files(all: &[(&str, &str)]) -> Files {
    all.iter().map(|(name, text)| ((*name).into(), text.as_bytes().to_vec())).collect()
}

fn open(name: &str, files: &Files, split: Split) -> Result<Assembly, ReadError> {
    read_from(Path::new(name), files, &ReadOptions::default().with_split(split))
}

/// Returns the names of the parts with their numbers of facets.
fn parts(assembly: &Assembly) -> Vec<(&str, usize)> {
    assembly.parts().iter().map(|part| (part.name(), part.facet_count())).collect()
}

fn cube(low: f64, high: f64) -> Mesh {
    block([low; 3], [high; 3])
}

fn obj(parts: &[(&str, Mesh)]) -> String {
    let (mut text, mut base) = (String::new(), 1);
    for (name, mesh) in parts {
        if !name.is_empty() {
            text += &format!("o {name}\n");
        }
        for v in &mesh.vertices {
            text += &format!("v {} {} {}\n", v.x, v.y, v.z);
        }
        for face in &mesh.faces {
            let corners: Vec<String> = face.iter().map(|v| (v + base).to_string()).collect();
            text += &format!("f {}\n", corners.join(" "));
        }
        base += mesh.vertices.len() as u32;
    }
    text
}

#[test]
fn named_objects_of_a_single_file_are_parts() {
    let hollow = cube(0.0, 3.0).joined(&cube(1.0, 2.0).reversed());
    let text = obj(&[("box", hollow), ("lid", cube(4.0, 5.0).joined(&cube(6.0, 7.0)))]);
    let files = files(&[("a.obj", &text)]);
    let named = open("a.obj", &files, Split::Auto).unwrap();
    assert_eq!(parts(&named), [("box", 12), ("lid", 12)]);
    assert!(
        (named.parts()[0].solid().volume() - 26.0).abs() < 1e-9,
        "the cavity must reduce the volume"
    );
    assert_eq!(named.notes().len(), 1);
    assert!(named.notes()[0].contains("split never"), "{:?}", named.notes());
    let asked = open("a.obj", &files, Split::Names).unwrap();
    assert_eq!((parts(&asked), asked.notes()), (parts(&named), &[][..]));
    let bodies = open("a.obj", &files, Split::Bodies).unwrap();
    assert_eq!(parts(&bodies), [("box", 12), ("lid_1", 6), ("lid_2", 6)]);
    let whole = open("a.obj", &files, Split::Never).unwrap();
    assert_eq!((parts(&whole), whole.notes()), (vec![("a", 24)], &[][..]));
}

#[test]
fn unnamed_bodies_of_a_single_file_are_parts() {
    let text = obj(&[("", cube(0.0, 1.0).joined(&cube(0.5, 2.0)).joined(&cube(3.0, 4.0)))]);
    let files = files(&[("a.obj", &text), ("c.off", CUBE)]);
    let bodies = open("a.obj", &files, Split::Auto).unwrap();
    assert_eq!(parts(&bodies), [("a_1", 6), ("a_2", 6), ("a_3", 6)]);
    assert_eq!(parts(&open("a.obj", &files, Split::Names).unwrap()), [("a", 18)]);
    for split in Split::ALL {
        let one = open("c.off", &files, split).unwrap();
        assert_eq!((parts(&one), one.notes()), (vec![("c", 6)], &[][..]), "{split:?}");
    }
}

#[test]
fn files_of_a_folder_stay_parts_with_a_note() {
    let folder = TemporaryFolder::new();
    let two = obj(&[("x", cube(2.0, 3.0)), ("", cube(4.0, 5.0))]);
    std::fs::write(folder.path().join("screws.obj"), &two).unwrap();
    std::fs::write(folder.path().join("plate.off"), CUBE).unwrap();
    let read = |split| {
        colltrans_assembly_io::read::read(folder.path(), &ReadOptions::default().with_split(split))
            .unwrap()
    };
    let kept = read(Split::Auto);
    assert_eq!(parts(&kept), [("plate", 6), ("screws", 12)]);
    assert_eq!(
        kept.notes(),
        ["parts with several bodies: screws (2); use `split bodies` to read each body as a part"]
    );
    assert!(read(Split::Never).notes().is_empty());
    let apart = read(Split::Bodies);
    assert_eq!(parts(&apart), [("plate", 6), ("screws/screws_1", 6), ("screws/screws_2", 6)]);
}

#[test]
fn manifest_splits_each_part_on_its_own() {
    let two = obj(&[("x", cube(2.0, 3.0)), ("y", cube(4.0, 5.0))]);
    let text = "[[part]]\nfile = 'a.obj'\n[[part]]\nfile = 'a.obj'\nname = 'b'\nsplit = 'names'\nfixed = true\n\
        translation = [0, 0, 9]\n";
    let mut files = files(&[
        ("a.obj", &two),
        ("m.toml", text),
        ("n.toml", "[[part]]\nfile = 'a.obj'\nsplit = 'no'\n"),
    ]);
    let read = open("m.toml", &files, Split::Auto).unwrap();
    assert_eq!(parts(&read), [("a", 12), ("b/x", 6), ("b/y", 6)]);
    assert!(read.parts().iter().skip(1).all(Part::is_fixed));
    assert_eq!(read.parts()[2].solid().bounds().low.to_array(), [4.0, 4.0, 13.0]);
    let all = open("m.toml", &files, Split::Bodies).unwrap();
    assert_eq!(parts(&all), [("a/x", 6), ("a/y", 6), ("b/x", 6), ("b/y", 6)]);
    let error = open("n.toml", &files, Split::Auto).unwrap_err().to_string();
    assert_eq!(
        error,
        "n.toml: part 1 (a): split: unknown split no; accepted: auto, never, names, bodies"
    );
    // A file that the manifest lists is one part.
    files.insert("one.toml".into(), b"[[part]]\nfile = 'a.obj'\n".to_vec());
    assert_eq!(parts(&open("one.toml", &files, Split::Auto).unwrap()), [("a", 12)]);
}

#[test]
fn repaired_surfaces_are_split_after_the_repair() {
    let mut mesh = cube(0.0, 1.0).joined(&cube(3.0, 4.0));
    mesh.faces[2].reverse();
    mesh.faces.push(mesh.faces[7].clone());
    let files = files(&[("a.obj", &obj(&[("", mesh)]))]);
    let read = open("a.obj", &files, Split::Auto).unwrap();
    assert_eq!(parts(&read), [("a_1", 6), ("a_2", 6)]);
    assert!(read.parts().iter().all(|part| part.defects().is_empty() && !part.is_surface()));
    let notes = read.notes().join("\n");
    assert!(notes.contains("a: 1 face with the corners of another one left out"), "{notes}");
    assert!(notes.contains("a: 1 face turned"), "{notes}");
    let refused = ReadOptions::default().with_as_is(true);
    let error = read_from(Path::new("a.obj"), &files, &refused).unwrap_err().to_string();
    assert!(error.contains("the mesh needs repair"), "{error}");
}

#[test]
fn split_never_keeps_3mf_items_whole() {
    let object =
        |id: u32, name: &str, mesh: &str| format!("<object id=\"{id}\"{name}>{mesh}</object>");
    let small = mesh_of_3mf([1.0; 3]);
    let model = format!(
        "<model unit=\"millimeter\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>{}{}{}\
         </resources><build><item objectid=\"3\"/><item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 9 0 0\"/></build></model>",
        object(1, " name=\"rod\"", &small),
        object(2, "", &small),
        object(
            3,
            " name=\"cart\"",
            "<components><component objectid=\"1\"/>\
            <component objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 3 0 0\"/></components>"
        ),
    );
    let mut files = Files::new();
    files.insert("a.3mf".into(), package(&[("3D/3dmodel.model", model)]));
    // An object without a name takes that of the enclosing object.
    assert_eq!(
        parts(&open("a.3mf", &files, Split::Auto).unwrap()),
        [("rod", 12), ("cart", 12), ("rod_2", 12)]
    );
    assert_eq!(parts(&open("a.3mf", &files, Split::Never).unwrap()), [("cart", 24), ("rod", 12)]);
}

/// Returns a GLB file of one unit cube, placed by these nodes.
fn glb(nodes: &serde_json::Value, asset: &serde_json::Value) -> Vec<u8> {
    let mesh = cube(0.0, 1.0);
    let (mut bytes, corners): (Vec<u8>, Vec<[u32; 3]>) = (Vec::new(), mesh.triangles().collect());
    for v in &mesh.vertices {
        bytes.extend(v.as_vec3().to_array().iter().flat_map(|x| x.to_le_bytes()));
    }
    bytes.extend(corners.iter().flatten().flat_map(|v| v.to_le_bytes()));
    let document = serde_json::json!({
        "asset": asset, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 144},
        ],
        "buffers": [{"byteLength": 240}],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF".to_vec();
    let word = |file: &mut Vec<u8>, n: usize| file.extend((n as u32).to_le_bytes());
    word(&mut file, 2);
    word(&mut file, 28 + text.len() + bytes.len());
    word(&mut file, text.len());
    file.extend(b"JSON");
    file.extend(&text);
    word(&mut file, bytes.len());
    file.extend(b"BIN\0");
    file.extend(&bytes);
    file
}

#[test]
fn converter_extras_of_glb_nodes_are_read() {
    use serde_json::json;
    let part = |error: f64| json!({"colltrans": {"part": true, "chord_error": error}});
    let nodes = json!([
        {"name": "root", "children": [1, 4]},
        {"name": "screw", "children": [2, 3], "extras": part(2e-5)},
        {"name": "body", "mesh": 0},
        {"name": "thread", "mesh": 0, "translation": [2, 0, 0]},
        {"name": "plate", "mesh": 0, "translation": [0, 0, 3], "extras": part(1e-5)},
    ]);
    let converted = json!({"version": "2.0", "extras": {"colltrans": {"unit": "mm", "per_metre": 1000, "up": "z"}}});
    let read =
        |nodes, asset| colltrans_assembly_io::read::glb("a.glb", &glb(nodes, asset)).unwrap();
    let found = read(&nodes, &converted);
    assert_eq!(parts(&found), [("screw", 24), ("plate", 12)]);
    assert_eq!((found.unit(), found.up().to_array()), (Some("mm"), [0.0, 0.0, 1.0]));
    assert_eq!(found.parts()[0].solid().bounds().high.to_array(), [3000.0, 1000.0, 1000.0]);
    let errors: Vec<f64> = found.parts().iter().map(|part| part.chord_error().unwrap()).collect();
    assert!((errors[0] - 0.02).abs() < 1e-12 && (errors[1] - 0.01).abs() < 1e-12);
    // The tolerance of a pair is the sum of both chord errors, plus a term for the last digits.
    let Fit::Chords { base, largest } = Fit::default_for(&found) else { panic!("no chord errors") };
    assert!(
        (largest - 0.04 - base).abs() < 1e-12
            && base == found.coordinate_size() / f64::from(1 << 21)
    );
    // The plate moves further down to the screw by the amount by which both are shrunk.
    let bodies = Bodies::new(&found, Fit::default_for(&found)).unwrap();
    let mut workspace = colltrans::solid::Workspace::default();
    let start = colltrans::solid::StartOverlap::Refuse;
    let FreeTravel::Blocked(stop) =
        bodies.free_travel([1, 0], glam::DVec3::NEG_Z, None, start, &mut workspace)
    else {
        panic!("the screw must block the plate");
    };
    assert!(
        (stop.shrunk_translation.value - 2000.03 - base).abs() < 1e-6,
        "{:?}",
        stop.shrunk_translation
    );
    assert!((stop.translation.value - 2000.0).abs() < 1e-6);
    // Other programs may store arbitrary data in these extras.
    let others = json!([{"mesh": 0, "extras": {"colltrans": 7}, "children": [1]}, {"mesh": 0, "extras": [1]}]);
    let found = read(&others, &json!({"version": "2.0", "extras": "x"}));
    assert_eq!(
        (parts(&found).len(), found.unit(), found.up().to_array()),
        (2, Some("m"), [0.0, 1.0, 0.0])
    );
    assert!(matches!(Fit::default_for(&found), Fit::Tolerance(_)));
}

/// An assembly that was read from glTF is written with the same axes and lengths.
#[test]
fn written_glb_has_the_axes_and_lengths_of_its_source() {
    let nodes =
        serde_json::json!([{"name": "a", "mesh": 0, "scale": [1, 2, 3], "translation": [4, 5, 6]}]);
    let first = colltrans_assembly_io::read::glb(
        "a.glb",
        &glb(&nodes, &serde_json::json!({"version": "2.0"})),
    )
    .unwrap();
    let written = colltrans_assembly::report::glb::plan_animation(&first, &Plan::default());
    let again = colltrans_assembly_io::read::glb("b.glb", &written).unwrap();
    let bounds = |assembly: &Assembly| assembly.parts()[0].solid().bounds();
    assert_eq!(
        (bounds(&first).low, bounds(&first).high),
        (bounds(&again).low, bounds(&again).high)
    );
    // An assembly with z up is rotated in glTF, which is in metres.
    let z = first.with_up(glam::DVec3::Z).with_unit("mm");
    let written = colltrans_assembly::report::glb::plan_animation(&z, &Plan::default());
    let low = bounds(&colltrans_assembly_io::read::glb("b.glb", &written).unwrap()).low;
    assert!((low - glam::DVec3::new(0.004, 0.006, -0.007)).length() < 1e-9, "{low}");
}

/// Returns a tetrahedron in COLLADA, in a unit, placed by these nodes.
fn dae(metres: f64, nodes: &str) -> String {
    format!(
        "<COLLADA><asset><unit meter='{metres}'/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id='g'><mesh>\
         <source id='p'><float_array id='a' count='12'>0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common>\
         <accessor source='#a' count='4' stride='3'><param name='X'/><param name='Y'/><param name='Z'/></accessor>\
         </technique_common></source><vertices id='v'><input semantic='POSITION' source='#p'/></vertices>\
         <triangles count='4'><input semantic='VERTEX' source='#v' offset='0'/><p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles>\
         </mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='s'>{nodes}</visual_scene>\
         </library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>"
    )
}

#[test]
fn collada_nodes_become_parts_in_the_file_unit() {
    let shown = "<instance_geometry url='#g'/>";
    let nodes = format!(
        "<node name='arm'>{shown}<node name='tip'><translate>0 0 4</translate>{shown}</node></node>"
    );
    let robot = "<robot name='r'><link name='l'><visual><geometry><mesh filename='a.dae'/></geometry></visual></link></robot>";
    let manifest = "unit = 'mm'\n[[part]]\nfile = 'a.dae'\n";
    let mut files = files(&[
        ("r.urdf", robot),
        ("m.toml", manifest),
        ("a.dae", &dae(0.01, &nodes)),
        ("b.dae", &dae(0.5, &nodes)),
    ]);
    let high = |assembly: &Assembly, k: usize| assembly.parts()[k].solid().bounds().high.z;
    let two = open("a.dae", &files, Split::Auto).unwrap();
    assert_eq!(parts(&two), [("arm", 4), ("tip", 4)]);
    assert_eq!(
        (two.unit(), two.up().to_array(), high(&two, 1)),
        (Some("cm"), [0.0, 0.0, 1.0], 5.0)
    );
    // A unit without a name, a manifest in another unit, and a robot, which is in metres.
    let metres = open("b.dae", &files, Split::Never).unwrap();
    assert_eq!((metres.unit(), high(&metres, 0)), (Some("m"), 2.5));
    assert!((high(&open("m.toml", &files, Split::Auto).unwrap(), 0) - 50.0).abs() < 1e-9);
    let visual =
        ReadOptions::default().with_geometry(colltrans_assembly_io::read::Geometry::Visual);
    let robot = read_from(Path::new("r.urdf"), &files, &visual).unwrap();
    assert!((high(&robot, 0) - 0.05).abs() < 1e-12);
    files.insert("c.dae".into(), b"<COLLADA/>".to_vec());
    let error = open("c.dae", &files, Split::Auto).unwrap_err().to_string();
    assert!(error.contains("c.dae: line 1: the file has no scene"), "{error}");
}
