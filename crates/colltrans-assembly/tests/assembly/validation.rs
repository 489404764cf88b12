//! Tests of malicious files and of files that reference others: what is rejected, and how much memory that
//! needs.

#![allow(clippy::format_push_string, reason = "small files, written for people to read")]

use colltrans_testkit::TemporaryFolder;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::common::{CUBE, mesh_of_3mf, package};
use allocation_counter::measure;
use base64::Engine;
use colltrans_assembly::plan::Plan;
use colltrans_assembly::report::glb::plan_animation;
use colltrans_assembly::{Assembly, Bodies, Fit};
use colltrans_assembly_io::ReadError;
use colltrans_assembly_io::read::{ReadOptions, Split, read, read_from};
use colltrans_testkit::shapes::block;
use glam::DVec3;
use serde_json::{Value, json};

/// Reads a source with its other files from memory.
fn from_memory(name: &str, files: &[(&str, Vec<u8>)]) -> Result<Assembly, ReadError> {
    let files: BTreeMap<PathBuf, Vec<u8>> =
        files.iter().map(|(name, bytes)| (name.into(), bytes.clone())).collect();
    read_from(name, &files, &ReadOptions::default())
}

/// Returns the error of a source that must be rejected.
fn refusal(name: &str, files: &[(&str, Vec<u8>)]) -> String {
    from_memory(name, files).unwrap_err().to_string()
}

/// Asserts that a message contains all words.
fn says(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "{word:?} is not in {message}");
    }
}

/// Returns the buffer of a cube in glTF: 96 bytes of positions, 72 of indices.
fn cube_bytes() -> Vec<u8> {
    let mesh = block(DVec3::ZERO, DVec3::ONE);
    let positions = mesh.vertices.iter().flat_map(DVec3::to_array);
    let mut bytes: Vec<u8> = positions.flat_map(|c| (c as f32).to_le_bytes()).collect();
    bytes.extend(mesh.triangles().flatten().flat_map(|v| (v as u16).to_le_bytes()));
    bytes
}

/// Returns a cube as a glTF document.
fn cube_gltf() -> Value {
    let data = base64::engine::general_purpose::STANDARD.encode(cube_bytes());
    json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "cube"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 96},
                        {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": 168, "uri": format!("data:;base64,{data}")}],
    })
}

/// Returns the bytes of a changed cube document.
fn gltf(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut file = cube_gltf();
    change(&mut file);
    file.to_string().into_bytes()
}

/// Reads two cubes, the first with two primitives, with given materials.
fn coloured(materials: &Value, [large, small, other]: [Value; 3]) -> Assembly {
    let file = gltf(|file| {
        let shape = |material: Value, indices: usize| {
            let mut shape = json!({"attributes": {"POSITION": 0}, "indices": indices});
            if !material.is_null() {
                shape["material"] = material;
            }
            shape
        };
        file["materials"] = materials.clone();
        file["scenes"][0]["nodes"] = json!([0, 1]);
        file["nodes"] =
            json!([{"mesh": 0, "name": "a"}, {"mesh": 1, "name": "b", "translation": [3, 0, 0]}]);
        let cube = json!({"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"});
        file["accessors"].as_array_mut().unwrap().push(cube);
        file["meshes"] = json!([
            {"primitives": [shape(small, 2), shape(large, 1)]},
            {"primitives": [shape(other, 1)]},
        ]);
    });
    from_memory("a.gltf", &[("a.gltf", file)]).unwrap()
}

/// Colours are linear in the file and sRGB in parts, also after a plan is written and read.
#[test]
fn part_has_colour_of_its_largest_primitive() {
    let of = |colour: [f64; 4]| json!({"pbrMetallicRoughness": {"baseColorFactor": colour}});
    let materials = json!([
        of([1.0, 0.0, 0.214_041, 1.0]),
        of([0.0, 1.0, 0.0, 1.0]),
        {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "baseColorTexture": {"index": 0}}},
    ]);
    let near = |found: Option<[f64; 3]>, known: [f64; 3]| {
        let found = found.expect("it has a colour");
        assert!((0..3).all(|k| (found[k] - known[k]).abs() < 1e-3), "{found:?} {known:?}");
    };
    let read = coloured(&materials, [json!(0), json!(1), json!(1)]);
    let written = plan_animation(&read, &Plan::default());
    for assembly in [&read, &colltrans_assembly_io::read::glb("b.glb", &written).unwrap()] {
        near(assembly.parts()[0].colour(), [1.0, 0.0, 0.5]);
        near(assembly.parts()[1].colour(), [0.0, 1.0, 0.0]);
    }
    // A texture, a missing material and an unknown material yield no colour.
    for none in [json!(2), Value::Null, json!(7)] {
        let read = coloured(&materials, [json!(0), json!(1), none]);
        near(read.parts()[0].colour(), [1.0, 0.0, 0.5]);
        assert_eq!(read.parts()[1].colour(), None);
    }
}

/// A change of a document.
type Change = Box<dyn FnOnce(&mut Value)>;

#[test]
fn gltf_with_false_counts_is_rejected_without_allocation() {
    let cube = from_memory("a.gltf", &[("a.gltf", gltf(|_| ()))]).unwrap();
    assert!((cube.parts()[0].solid().volume() - 1.0).abs() < 1e-12);
    let most = u64::MAX;
    let sparse = |count: u64, view: u64| {
        json!({"count": count, "indices": {"bufferView": view, "componentType": 5123},
               "values": {"bufferView": 0}})
    };
    let set = |path: &'static str, value: Value| -> Change {
        Box::new(move |file: &mut Value| {
            let (object, key) = path.rsplit_once('/').unwrap();
            file.pointer_mut(object).unwrap()[key] = value;
        })
    };
    let cases: Vec<(Change, &str)> = vec![
        (set("/accessors/0/count", json!(300_000_000)), "positions extend beyond"),
        (set("/accessors/0/count", json!(most)), "are too many"),
        (set("/accessors/0/byteOffset", json!(most)), "positions extend beyond"),
        (set("/accessors/1/count", json!(4_000_000_000_u64)), "indices extend beyond"),
        (set("/bufferViews/0/byteStride", json!(0)), "a stride of 0 bytes"),
        (set("/bufferViews/0/byteStride", json!(4)), "a stride of 4 bytes"),
        (set("/bufferViews/0/byteStride", json!(most)), "positions extend beyond"),
        (set("/bufferViews/0/byteOffset", json!(most)), "positions extend beyond"),
        (set("/bufferViews/0/byteLength", json!(most)), "positions extend beyond"),
        (set("/bufferViews/0/buffer", json!(7)), "positions extend beyond"),
        (set("/buffers/0/byteLength", json!(most)), "168 bytes, expected"),
        (
            set("/accessors/0/sparse", sparse(600_000_000, 1)),
            "600000000 sparse positions replace only 8",
        ),
        (set("/accessors/0/sparse", sparse(8, 1)), "must be increasing"),
        (set("/accessors/0/sparse", sparse(8, 9)), "unknown buffer view 9"),
        (set("/accessors/0/bufferView", Value::Null), "without a buffer view"),
        (set("/accessors/1/componentType", json!(5122)), "not unsigned integers"),
        (set("/accessors/1/componentType", json!(1)), "unknown component type 1"),
        (set("/accessors/1/type", json!("VEC2")), "VEC2, expected SCALAR"),
        (set("/nodes/0/mesh", json!(3)), "unknown mesh 3; the file has"),
        (set("/nodes/0/children", json!([0])), "in a cycle"),
        (set("/nodes/0/rotation", json!([0, 0, 0, 0])), "its rotation is zero"),
        (set("/extensionsRequired", json!(["KHR_draco_mesh_compression"])), "KHR_draco"),
        (set("/asset/version", json!("1.0")), "version 1.0"),
    ];
    for (change, words) in cases {
        let mut file = cube_gltf();
        change(&mut file);
        let bytes = file.to_string().into_bytes();
        let mut message = String::new();
        let memory = measure(|| message = refusal("a.gltf", &[("a.gltf", bytes)]));
        says(&message, &["a.gltf", words]);
        assert!(memory.bytes_max < 1 << 20, "{} bytes: {message}", memory.bytes_max);
    }
}

#[test]
fn sparse_gltf_accessors_are_read() {
    let bytes = gltf(|file| {
        // Moves the last corner to (2, 2, 2).
        file["accessors"][0]["sparse"] = json!({"count": 1,
            "indices": {"bufferView": 2, "componentType": 5121},
            "values": {"bufferView": 3}});
        let extra = base64::engine::general_purpose::STANDARD
            .encode([7, 0, 0, 0].into_iter().chain([0, 0, 0, 64].repeat(3)).collect::<Vec<u8>>());
        file["buffers"].as_array_mut().unwrap().push(
            json!({"byteLength": 16, "uri": format!("data:application/octet-stream;base64,{extra}")}));
        let views = file["bufferViews"].as_array_mut().unwrap();
        views.push(json!({"buffer": 1, "byteLength": 1}));
        views.push(json!({"buffer": 1, "byteOffset": 4, "byteLength": 12}));
    });
    let assembly = from_memory("a.gltf", &[("a.gltf", bytes)]).unwrap();
    assert_eq!(assembly.parts()[0].solid().bounds().high, glam::DVec3::splat(2.0));
}

#[test]
fn gltf_uris_are_decoded_and_confined_to_folder() {
    let with = |uri: &str| gltf(|file| file["buffers"][0]["uri"] = json!(uri));
    let files = |uri: &str, name: &'static str| [("s/a.gltf", with(uri)), (name, cube_bytes())];
    let read = from_memory("s/a.gltf", &files("my%20cube%2B.bin", "s/my cube+.bin"));
    assert_eq!(read.unwrap().files().len(), 2);
    from_memory("s/a.gltf", &files("b/%C3%A4.bin", "s/b/ä.bin")).unwrap();
    let refused = |uri: &str| refusal("s/a.gltf", &files(uri, "s/x"));
    says(&refused("../a.bin"), &["rejected reference ../a.bin"]);
    says(&refused("%2e%2e/a.bin"), &["rejected reference ../a.bin"]);
    says(&refused("/etc/passwd"), &["rejected reference /etc/passwd"]);
    says(
        &refused("https://example.org/a.bin"),
        &["https://example.org/a.bin is a network address"],
    );
    says(&refused("file:///etc/passwd"), &["is a network address (file)"]);
    says(&refused("a%2"), &["a%2: % at the end"]);
    says(&refused("a%zz"), &["expected two hexadecimal digits after %"]);
    says(&refused("%ff"), &["not UTF-8"]);
    says(&refused("gone.bin"), &["file gone.bin not found"]);
    says(&refused("data:;base64,***"), &["not base64"]);
}

#[test]
fn truncated_glb_files_are_rejected() {
    let json = gltf(|file| {
        file["buffers"][0].as_object_mut().unwrap().remove("uri");
    });
    let mut glb = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    let mut chunk = |kind: &[u8], bytes: &[u8], pad: u8| {
        let size = bytes.len().next_multiple_of(4);
        glb.extend((size as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(bytes);
        glb.resize(glb.len() + size - bytes.len(), pad);
    };
    chunk(b"JSON", &json, b' ');
    chunk(b"BIN\0", &cube_bytes(), 0);
    let length = glb.len() as u32;
    glb[8..12].copy_from_slice(&length.to_le_bytes());
    assert_eq!(from_memory("a.glb", &[("a.glb", glb.clone())]).unwrap().parts().len(), 1);
    for end in 0..glb.len() {
        let mut cut = glb[..end].to_vec();
        assert!(from_memory("a.glb", &[("a.glb", cut.clone())]).is_err(), "{end} bytes");
        // Truncated files are rejected also if the length in the header agrees.
        if let Some(size) = cut.get_mut(8..12) {
            size.copy_from_slice(&(end as u32).to_le_bytes());
            assert!(from_memory("a.glb", &[("a.glb", cut)]).is_err(), "{end} bytes");
        }
    }
}

#[test]
fn numbers_of_placed_shapes_and_pairs_are_limited() {
    let nodes = |count: usize| {
        gltf(|file| {
            file["nodes"] = (0..count).map(|_| json!({"mesh": 0})).collect();
            file["scenes"][0]["nodes"] = (0..count).collect();
        })
    };
    says(&refusal("a.gltf", &[("a.gltf", nodes(70_000))]), &["more than 65536 nodes"]);
    // Many primitives of one shape, each with 40 bytes and 12 facets.
    let many = gltf(|file| {
        let one = file["meshes"][0]["primitives"][0].clone();
        file["meshes"][0]["primitives"] = vec![one; 100].into();
        file["nodes"] = (0..60_000).map(|_| json!({"mesh": 0})).collect();
        file["scenes"][0]["nodes"] = vec![0; 60_000].into();
    });
    says(&refusal("a.gltf", &[("a.gltf", many)]), &["facets are placed", "accepted: one per byte"]);
    // Coincident parts: pairs are counted before they are stored.
    let same = from_memory("a.gltf", &[("a.gltf", nodes(3_000))]).unwrap();
    let mut message = String::new();
    let memory = measure(|| {
        let bodies = Bodies::new(&same, Fit::Tolerance(0.0));
        message = bodies.err().unwrap().to_string();
    });
    says(&message, &["more than 524288 pairs of parts"]);
    assert!(memory.bytes_max < 400 << 20, "{}", memory.bytes_max);
}

/// Returns a box of these sides as an object of a 3MF model.
fn object(id: u32, size: [f64; 3]) -> String {
    format!("<object id=\"{id}\" type=\"model\">{}</object>", mesh_of_3mf(size))
}

const CORE: &str = "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"";
const PRODUCTION: &str =
    "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\"";

/// Returns a 3MF model document.
fn model(attributes: &str, resources: &str, build: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?><model unit=\"millimeter\" {CORE} {attributes}><resources>\
         {resources}</resources><build>{build}</build></model>"
    )
}

/// Returns a package as slicers write it: an object of components, each in its own file.
fn slicer(target: &str) -> Vec<u8> {
    let assembly = "<object id=\"3\" type=\"model\"><components>\
        <component p:path=\"/3D/Objects/object_1.model\" objectid=\"1\"/>\
        <component p:path=\"/3D/Objects/object_2.model\" objectid=\"1\" \
         transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/></components></object>";
    let attributes = format!("{PRODUCTION} requiredextensions=\"p\"");
    let start = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
    package(&[
        (
            "_rels/.rels",
            format!(
                "<Relationships><Relationship Target=\"{target}\" Id=\"r\" Type=\"{start}\"/></Relationships>"
            ),
        ),
        // Both files use the same object id.
        ("3D/Objects/object_1.model", model("", &object(1, [1.0, 2.0, 3.0]), "")),
        ("3D/Objects/object_2.model", model("", &object(1, [4.0, 5.0, 6.0]), "")),
        // A model that is found first if the relationship is ignored.
        ("a.model", model("", &object(3, [9.0, 9.0, 9.0]), "<item objectid=\"3\"/>")),
        (
            "3D/3dmodel.model",
            model(
                &attributes,
                assembly,
                "<item objectid=\"3\" transform=\"1 0 0 0 1 0 0 0 1 0 0 7\"/>",
            ),
        ),
    ])
}

#[test]
fn objects_in_several_files_of_3mf_package_are_read() {
    let read = from_memory("a.3mf", &[("a.3mf", slicer("/3D/3dmodel.model"))]).unwrap();
    let boxes: Vec<_> = read
        .parts()
        .iter()
        .map(|p| [p.solid().bounds().low, p.solid().bounds().high].map(|b| b.to_array()))
        .collect();
    assert_eq!(
        boxes,
        [[[0.0, 0.0, 7.0], [1.0, 2.0, 10.0]], [[10.0, 0.0, 7.0], [14.0, 5.0, 13.0]],]
    );
    let gone = refusal("a.3mf", &[("a.3mf", slicer("/3D/other.model"))]);
    says(&gone, &["a.3mf: /3D/other.model: the package has no such file"]);
}

/// Returns the names and notes of a package with metadata of a slicer.
fn as_sliced(files: &[(&str, String)], options: &ReadOptions) -> (Vec<String>, Vec<String>) {
    let files = BTreeMap::from([(PathBuf::from("a.3mf"), package(files))]);
    let read = read_from("a.3mf", &files, options).unwrap();
    let names = read.parts().iter().map(|part| part.name().to_owned());
    (names.collect(), read.notes().to_vec())
}

#[test]
fn slicer_metadata_names_parts() {
    let part = |id: u32, kind: &str, name: &str| {
        format!(
            "<part id=\"{id}\" subtype=\"{kind}\"><metadata key=\"name\" value=\"{name}\"/></part>"
        )
    };
    let parts = [part(1, "normal_part", "lid &amp; knob"), part(2, "modifier_part", "denser")];
    let settings = |id: u32| {
        format!(
            "<config><object id=\"{id}\"><metadata key=\"name\" value=\"tin\"/><metadata \
             key=\"extruder\" value=\"1\"/>{}</object></config>",
            parts.concat()
        )
    };
    let whole = "<object id=\"3\" name=\"of the core\"><components><component objectid=\"1\"/><component \
        objectid=\"2\"/><component objectid=\"4\"/></components></object>";
    let objects = [1, 2, 4].map(|id| object(id, [f64::from(id), 1.0, 1.0])).concat() + whole;
    let root = || ("3D/3dmodel.model", model("", &objects, "<item objectid=\"3\"/>"));
    let read = |config: String, split: Split| {
        let files = [root(), ("Metadata/model_settings.config", config)];
        as_sliced(&files, &ReadOptions::default().with_split(split))
    };
    let (names, notes) = read(settings(3), Split::Auto);
    // A component without metadata takes the name of the whole object.
    assert_eq!(names, ["lid & knob", "tin"]);
    assert_eq!(notes, ["left out because they are not parts of the model: denser (modifier)"]);
    assert_eq!(read(settings(3), Split::Never).0, ["tin"]);
    // Metadata of another object, or invalid metadata, is ignored.
    for config in [settings(1), "<config".into(), "no xml".into()] {
        let (names, notes) = read(config, Split::Auto);
        assert!(names.len() == 3 && names[0] == "of the core" && notes.is_empty(), "{names:?}");
    }
    let two = mesh_of_3mf([1.0; 3]).replace("</vertices>", "").replace("</mesh>", "");
    let other = mesh_of_3mf([5.0; 3]);
    let corners = other.split("<vertices>").nth(1).unwrap().split("</vertices>").next().unwrap();
    let corners = corners.replace("=\"0\"", "=\"2\"");
    let faces = other.split("<triangles>").nth(1).unwrap().split("</triangles>").next().unwrap();
    let more: String = (0..8).rev().fold(faces.to_owned(), |text, k| {
        text.replace(&format!("=\"{k}\""), &format!("=\"{}\"", k + 8))
    });
    let (head, own) = two.split_once("<triangles>").unwrap();
    let own = own.replace("</triangles>", "");
    let mesh = format!("{head}{corners}</vertices><triangles>{own}{more}</triangles></mesh>");
    let volume = |[first, last]: [u32; 2], kind: &str, name: &str| {
        let said = |key: &str, value: &str| {
            format!("<metadata type=\"volume\" key=\"{key}\" value=\"{value}\"/>")
        };
        let said = said("name", name) + &said("volume_type", kind);
        format!("<volume firstid=\"{first}\" lastid=\"{last}\">{said}</volume>")
    };
    let sliced = |volumes: &[String], split: Split| {
        let object = format!("<object id=\"1\" type=\"model\">{mesh}</object>");
        let config = format!("<config><object id=\"1\">{}</object></config>", volumes.concat());
        let root = ("3D/3dmodel.model", model("", &object, "<item objectid=\"1\"/>"));
        let files = [root, ("Metadata/Slic3r_PE_model.config", config)];
        as_sliced(&files, &ReadOptions::default().with_split(split)).0
    };
    let [small, large] =
        [volume([0, 11], "ModelPart", "small"), volume([12, 23], "ModelPart", "large")];
    assert_eq!(sliced(&[small.clone(), large], Split::Auto), ["small", "large"]);
    let negative = volume([12, 23], "NegativeVolume", "hole");
    assert_eq!(sliced(&[small.clone(), negative], Split::Auto), ["small"]);
    // Volumes that do not cover all triangles are ignored.
    for wrong in [[12, 22], [11, 23], [12, 24], [13, 23]] {
        let names = sliced(&[small.clone(), volume(wrong, "ModelPart", "large")], Split::Never);
        assert_eq!(names, ["object_1"], "{wrong:?}");
    }
}

#[test]
fn paths_in_3mf_package_may_be_percent_encoded() {
    let start = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
    let rels = |target: &str| {
        let relation = format!("<Relationship Target=\"{target}\" Id=\"r\" Type=\"{start}\"/>");
        ("_rels/.rels", format!("<Relationships>{relation}</Relationships>"))
    };
    let far = |path: &str| {
        let component = format!("<component p:path=\"{path}\" objectid=\"1\"/>");
        let object = format!("<object id=\"3\"><components>{component}</components></object>");
        model(PRODUCTION, &object, "<item objectid=\"3\"/>")
    };
    let cube = || model("", &object(1, [1.0, 2.0, 3.0]), "");
    // Either name, both or none may be encoded; `%C3%A9` is one letter.
    for (target, root) in [
        ("/3D/my%20model.model", "3D/my model.model"),
        ("/3D/my%20model.model", "3D/my%20model.model"),
        ("/3D/my model.model", "3D/my%20model.model"),
    ] {
        for (path, name) in [
            ("/3D/a%20b%C3%A9.model", "3D/a bé.model"),
            ("/3D/a%20b%C3%A9.model", "3D/A%20b%c3%a9.model"),
            ("/3D/a bé.model", "3D/a%20b%C3%A9.model"),
            ("/3D/100%.model", "3D/100%.model"),
        ] {
            let files = package(&[rels(target), (name, cube()), (root, far(path))]);
            let read = from_memory("a.3mf", &[("a.3mf", files)]).unwrap();
            assert_eq!(read.parts().len(), 1, "{target} {root} {path} {name}");
        }
    }
}

#[test]
fn non_part_objects_of_3mf_are_left_out_with_notes() {
    let of = |kind: &str, id: u32| {
        object(id, [f64::from(id), 1.0, 1.0])
            .replace("type=\"model\"", &format!("type=\"{kind}\" name=\"{kind}\""))
    };
    let kinds = ["model", "surface", "support", "solidsupport", "other"];
    let mut resources: String = (1..).zip(kinds).map(|(id, kind)| of(kind, id)).collect();
    // Components are left out too, with all objects below.
    resources += "<object id=\"6\" type=\"support\" name=\"tree\"><components>\
        <component objectid=\"1\"/></components></object>";
    resources += "<object id=\"7\"><components><component objectid=\"1\"/><component objectid=\"6\"/>\
        </components></object>";
    let items = [1, 2, 3, 4, 5, 7].map(|id| {
        let printable = if id == 2 || id == 7 { " printable=\"0\"" } else { "" };
        format!("<item objectid=\"{id}\"{printable}/>")
    });
    let read = |resources: &str, items: &str| {
        let files = package(&[("3D/3dmodel.model", model("", resources, items))]);
        from_memory("a.3mf", &[("a.3mf", files)])
    };
    let found = read(&resources, &items.concat()).unwrap();
    let names: Vec<&str> = found.parts().iter().map(colltrans_assembly::Part::name).collect();
    assert_eq!(names[..2], ["model", "surface"]);
    assert!(names.len() == 3 && names[2].starts_with("model"), "{names:?}");
    let [left_out, unprinted] = found.notes() else { panic!("{:?}", found.notes()) };
    let told = "left out because they are not parts of the model: support (support), solidsupport \
        (solidsupport), other (other), tree (support)";
    assert_eq!(left_out, told);
    let told = "read although marked as not printable (printable=\"0\"): build item 2, 6";
    assert_eq!(unprinted, told);
    let none = read(&resources, &items[2]).unwrap_err().to_string();
    says(&none, &["its build places no mesh", "not parts of the model: support (support)"]);
    let wrong = read(&of("modell", 1), &items[0]).unwrap_err().to_string();
    says(&wrong, &["unknown type modell; accepted: model, surface, support"]);
    // A surface may be open.
    let open = of("surface", 2).replace("<triangle v1=\"0\" v2=\"2\" v3=\"3\"/>", "");
    assert!(read(&open, &items[1]).unwrap().parts()[0].is_surface());
}

#[test]
fn invalid_3mf_files_and_unknown_extensions_are_rejected() {
    let refused = |files: &[(&str, String)]| refusal("a.3mf", &[("a.3mf", package(files))]);
    let of = |text: String| refused(&[("3D/3dmodel.model", text)]);
    says(&refusal("a.3mf", &[("a.3mf", b"no zip".to_vec())]), &["not a 3MF file"]);
    says(&refused(&[("word/document.xml", "<x/>".into())]), &["none of the 1 files", "is a model"]);
    says(&of("<html><body/></html>".into()), &["line 1: not a 3MF model", "root element is html"]);
    says(&of("no xml".into()), &["3D/3dmodel.model", "no XML element"]);
    let lattice = "xmlns:b=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\" requiredextensions=\"b\"";
    let item = "<item objectid=\"1\"/>";
    let cube = object(1, [1.0, 1.0, 1.0]);
    says(
        &of(model(lattice, &cube, item)),
        &["extension b", "beamlattice/2017/02", "not supported"],
    );
    says(&of(model("requiredextensions=\"q\"", &cube, item)), &["extension q (q)"]);
    let shapeless = "<object id=\"1\" type=\"model\"><other/></object>";
    says(&of(model("", shapeless, item)), &["object 1 has neither a mesh nor components"]);
    let inch = model("", &cube, "").replace("millimeter", "inch");
    let far = "<item objectid=\"1\" p:path=\"/b.model\"/>";
    let two = [("3D/3dmodel.model", model(PRODUCTION, "", far)), ("b.model", inch)];
    says(&refused(&two), &["its unit is inch, but the unit of the root model is millimeter"]);
    let deep = "<a>".repeat(50_000);
    says(&of(model("", &deep, item)), &["nested deeper than the accepted 64"]);
    let ring = "<object id=\"1\"><components><component objectid=\"1\"/></components></object>";
    says(&of(model("", ring, item)), &["in a cycle"]);
    // A package that unpacks to far more than its size.
    let bomb = package(&[("3D/3dmodel.model", " ".repeat(100 << 20))]);
    assert!(bomb.len() < 1 << 20);
    says(
        &refusal("a.3mf", &[("a.3mf", bomb)]),
        &["unpacks to more than the accepted 256 times its size"],
    );
    // Elements of extensions are not elements of the core.
    let other = "xmlns:s=\"http://schemas.microsoft.com/3dmanufacturing/slice/2015/07\"";
    let sliced = cube.replace("</mesh>", "</mesh><s:vertex x=\"9\" y=\"9\" z=\"9\"/>");
    let read = from_memory(
        "a.3mf",
        &[("a.3mf", package(&[("3D/3dmodel.model", model(other, &sliced, item))]))],
    );
    assert_eq!(read.unwrap().parts()[0].facet_count(), 12);
}

#[test]
fn invalid_urdf_files_are_rejected() {
    let refused = |text: String| refusal("a.urdf", &[("a.urdf", text.into_bytes())]);
    says(
        &refused("<html><body/></html>".into()),
        &["line 1: the root element", "html, expected robot"],
    );
    says(&refused("<sdf version='1.6'><model/></sdf>".into()), &["sdf, expected robot"]);
    says(&refused("{}".into()), &["no XML element"]);
    says(&refused("<robot name='r'/>".into()), &["no parts found", "none of its 0 links"]);
    says(
        &refused("<robot><link name='a'/></robot>".into()),
        &["none of its 1 links has collision geometry"],
    );
    says(&refused("<robot>\n<xacro:include/></robot>".into()), &["line 2", "run xacro first"]);
    let deep = format!("<robot name='r'>{}", "<link name='a'>".repeat(50_000));
    says(&refused(deep), &["nested deeper than the accepted 64"]);
    let geometry = |shape: &str| {
        let link = format!("<collision><geometry>{shape}</geometry></collision>");
        format!("<robot><link name='a'>{link}</link></robot>")
    };
    says(&refused(geometry("<torus/>")), &["link a", "unknown geometry torus"]);
    says(&refused(geometry("<box/>")), &["<box> has no attribute size"]);
    says(
        &refused(geometry("<box size='1 2'/>")),
        &["size=\"1 2\" of <box> is invalid; expected 3 numbers"],
    );
    says(
        &refused(geometry("<mesh filename='http://x/a.stl'/>")),
        &["http://x/a.stl is a network address"],
    );
    says(
        &refused(geometry("<mesh filename='file:///etc/a.stl'/>")),
        &["rejected reference /etc/a.stl"],
    );
    says(&refused(geometry("<mesh filename='../a.stl'/>")), &["rejected reference ../a.stl"]);
    says(&refused("<robot><link name='a'></robot>".into()), &["line 1"]);
    let ring = "<robot><link name='a'/><link name='b'/><joint name='j' type='fixed'>\
        <parent link='a'/><child link='b'/></joint><joint name='k' type='fixed'><parent link='b'/>\
        <child link='a'/></joint></robot>";
    says(&refused(ring.into()), &["its joints form a cycle"]);
}

/// Each link is attached to the previous one.
#[test]
fn chain_of_3000_links_is_placed() {
    let mut text = String::from("<robot name='r'>");
    for k in 0..3_000 {
        text += &format!("<link name='l{k}'>");
        if k == 2_999 {
            text += "<collision><geometry><box size='1 1 1'/></geometry></collision>";
        }
        text += "</link>";
        if k > 0 {
            text += &format!(
                "<joint name='j{k}' type='fixed'><origin xyz='1 0 0'/><parent link='l{}'/>\
                 <child link='l{k}'/></joint>",
                k - 1
            );
        }
    }
    let read = from_memory("a.urdf", &[("a.urdf", (text + "</robot>").into_bytes())]).unwrap();
    assert_eq!(read.parts()[0].solid().bounds().low.x, 2_998.5);
}

#[test]
fn manifest_errors_contain_no_names_of_the_program() {
    let refused = |name: &str, text: &str| {
        let files = [(name, text.as_bytes().to_vec()), ("c.off", CUBE.as_bytes().to_vec())];
        let message = refusal(name, &files);
        for word in ["struct", "Manifest", "Entry", "enum", "f64", "usize", "tuple", "serde"] {
            assert!(!message.contains(word), "{word} in {message}");
        }
        message
    };
    says(&refused("a.json", "[]"), &["expected an object (manifest)"]);
    says(&refused("a.json", "{\"parts\": 3}"), &["expected a list"]);
    says(&refused("a.json", "{\"parts\": [3]}"), &["expected an object (part)"]);
    says(&refused("a.json", "{\"parts\": ["), &["the file ends inside a list"]);
    says(&refused("a.json", "{\"parts\": []}"), &["no parts found: it lists no parts"]);
    says(
        &refused("a.json", "{\"parts\": [{\"file\": \"c.off\", \"scale\": \"x\"}]}"),
        &["a scale must be"],
    );
    says(&refused("a.toml", "[[part]]\nfile = c.off\n"), &["line 2"]);
    says(&refused("a.toml", "part = 3\n"), &["expected a list"]);
    says(&refused("a.toml", ""), &["it lists no parts"]);
    for (name, text) in [
        ("a.json", "\u{feff}{\"parts\": [{\"file\": \"c.off\"}]}"),
        ("a.toml", "\u{feff}[[part]]\nfile = 'c.off'\n"),
    ] {
        let files = [(name, text.as_bytes().to_vec()), ("c.off", CUBE.as_bytes().to_vec())];
        assert_eq!(from_memory(name, &files).unwrap().parts().len(), 1, "with a mark");
    }
    says(
        &refused("a.json", "{\"parts\": [{\"file\": \"../c.off\"}]}"),
        &["rejected reference ../c.off"],
    );
    says(
        &refused("a.json", "{\"parts\": [{\"file\": \"/c.off\"}]}"),
        &["rejected reference /c.off"],
    );
    says(
        &refused("a.json", "{\"parts\": [{\"file\": \"https://x/c.off\"}]}"),
        &["is a network address"],
    );
    let wide = [0xff, 0xfe, b'{', 0];
    says(&refusal("a.json", &[("a.json", wide.to_vec())]), &["UTF-16"]);
}

/// Links, pipes and folders on a disk.
#[cfg(unix)]
#[test]
fn referenced_files_are_confined_to_folder_of_source() {
    use std::os::unix::fs::symlink;

    let place = TemporaryFolder::new();
    let at = |name: &str| place.path().join(name);
    let write = |name: &str, text: &str| std::fs::write(at(name), text).unwrap();
    std::fs::create_dir_all(at("in/meshes")).unwrap();
    std::fs::create_dir_all(at("kit")).unwrap();
    write("secret.off", CUBE);
    write("in/meshes/c.off", CUBE);
    write("kit/k.off", CUBE);
    symlink(at("secret.off"), at("in/link.off")).unwrap();
    symlink(at("in/meshes"), at("in/folder")).unwrap();
    let fifo = std::process::Command::new("mkfifo").arg(at("in/pipe.off")).status().unwrap();
    assert!(fifo.success());
    symlink("/dev/zero", at("in/zero.off")).unwrap();
    let manifest = |file: &str, options: &ReadOptions| {
        write("in/m.json", &json!({"parts": [{"file": file, "name": "a"}]}).to_string());
        read(at("in/m.json"), options).map_err(|e| e.to_string())
    };
    let closed = ReadOptions::default();
    let open = ReadOptions::default().with_allow_outside(true);
    let kit = ReadOptions::default().with_packages(vec![at("kit")]);
    for inside in ["meshes/c.off", "folder/c.off", "meshes/../meshes/c.off"] {
        manifest(inside, &closed).unwrap();
    }
    let absolute = at("secret.off").display().to_string();
    for outside in ["../secret.off", "link.off", "meshes/../../secret.off", &absolute] {
        says(&manifest(outside, &closed).unwrap_err(), &["rejected reference"]);
        manifest(outside, &open).unwrap();
    }
    says(&manifest("../gone.off", &closed).unwrap_err(), &["rejected reference ../gone.off"]);
    manifest("../kit/k.off", &kit).unwrap();
    for (special, options) in [("pipe.off", &closed), ("zero.off", &open), ("../in", &open)] {
        let name = if special == "../in" { "meshes" } else { special };
        says(&manifest(name, options).unwrap_err(), &["not a regular file"]);
    }
    // Special files are rejected also as the source, and within a folder.
    says(&read(at("in/pipe.off"), &open).unwrap_err().to_string(), &["not a regular file"]);
    says(&colltrans_mesh::read(at("in/pipe.off")).unwrap_err().to_string(), &["not a regular"]);
    says(&read(at("in"), &closed).unwrap_err().to_string(), &["rejected reference", "link.off"]);
    // A symbolic link to the source itself is followed.
    write("in/n.json", &json!({"parts": [{"file": "k.off"}]}).to_string());
    symlink(at("in/n.json"), at("kit/n.json")).unwrap();
    assert_eq!(read(Path::new(&at("kit/n.json")), &closed).unwrap().parts().len(), 1);
}
