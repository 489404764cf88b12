//! Tests that hostile names in every field of every source stay text in every output.

#![allow(
    clippy::format_push_string,
    clippy::format_collect,
    reason = "small files, written for people to read"
)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::common::{CUBE, mesh_of_3mf, package};
use colltrans_assembly::map::{self, MapOptions, RemovalMap};
use colltrans_assembly::plan::PlanOptions;
use colltrans_assembly::report::{facts, glb, html};
use colltrans_assembly::{AnalysisRequest, Assembly, Bodies, Fit, Watch};
use colltrans_assembly_io::read::{ReadOptions, read_from};
use quick_xml::events::Event;
use serde_json::{Value, json};

/// Texts that try to break out of text, attributes, scripts and comments, formulas, and terminal control
/// codes.
const HOSTILE: [&str; 6] = [
    "</td></text></title></script><script>window.hit=1</script><img src=x onerror=window.hit=1>",
    "\"><svg onload=window.hit=1>' onmouseover='window.hit=1",
    "<!--<script>{{7*7}}&lt;script&gt;\u{2028}window.hit=1//]]>",
    "=HYPERLINK(\"http://x\",\"y\"),\r\n@SUM(1),\u{1b}]0;t\u{7}\u{9b}31m",
    "+cmd|' /C calc'!A0",
    "\t-1,\"\n",
];

/// The outputs for an assembly.
struct Outputs {
    page: String,
    table: String,
    pictures: Vec<String>,
    animation: Vec<u8>,
    facts: Value,
}

/// Computes all outputs.
fn all_outputs(assembly: &Assembly, title: &str) -> Outputs {
    let watch = Watch::default();
    let bodies = Bodies::new(assembly, Fit::Tolerance(1e-6)).unwrap();
    let question = AnalysisRequest::default().with_options(PlanOptions::default().with_samples(12));
    let mut findings = question.analyse(&bodies, watch).unwrap();
    let options = MapOptions::default().with_samples(12).with_border(1.0);
    let options = options.with_start(PlanOptions::default().start);
    let map = RemovalMap::new(&bodies, &[0], &[], options, watch).unwrap();
    findings.maps = vec![(title.to_owned(), map)];
    Outputs {
        page: html::report_page(&findings, title),
        table: findings.matrix.to_csv(&bodies),
        pictures: findings.maps.iter().map(|(name, found)| map::render_svg(found, name)).collect(),
        animation: glb::plan_animation(assembly, &findings.plan),
        facts: facts::findings_json(&findings),
    }
}

/// Asserts that a page contains only elements and attributes that this program writes.
fn assert_own_elements(page: &str) {
    let text = page.split("<script>").next().unwrap();
    let (mut rest, mut scripts) = (text, 0);
    while let Some(at) = rest.find('<') {
        rest = &rest[at + 1..];
        let end = rest.find('>').unwrap();
        let tag = rest[..end].trim_start_matches('/');
        let name = tag.split([' ', '/']).next().unwrap();
        assert!(!matches!(name, "img" | "iframe" | "a") && !name.starts_with("!--"), "{tag}");
        // Text outside of quotes contains attribute names.
        for (k, outside) in tag.split('"').enumerate() {
            let handler = outside.split_whitespace().any(|word| word.starts_with("on"));
            assert!(k % 2 == 1 || !handler, "{tag}");
        }
        scripts += usize::from(name == "script" && !rest.starts_with('/'));
    }
    assert!(scripts <= 1, "only the data of the viewer");
    // After the pictures there is only the script of the viewer.
    assert_eq!(page.matches("<script>").count(), 1);
}

/// Asserts that the names of the parts are text in all outputs.
fn assert_names_stay_text(assembly: &Assembly, title: &str) {
    let Outputs { page, table, pictures, animation, facts } = all_outputs(assembly, title);
    assert_own_elements(&page);
    for part in assembly.parts() {
        let name = part.name();
        assert!(facts.to_string().contains(&json!(name).to_string()));
        let escaped = name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        assert!(page.contains(&escaped.replace('"', "&quot;")), "{name:?} is not in the page");
    }
    // The names in the animation are JSON texts.
    let size = u32::from_le_bytes(animation[12..16].try_into().unwrap()) as usize;
    let document: Value = serde_json::from_slice(&animation[20..20 + size]).unwrap();
    for (node, part) in document["nodes"].as_array().unwrap().iter().zip(assembly.parts()) {
        assert_eq!(node["name"], part.name());
    }
    for picture in pictures {
        let mut reader = quick_xml::Reader::from_str(&picture);
        let mut elements = BTreeMap::<String, usize>::new();
        loop {
            match reader.read_event().unwrap() {
                Event::Start(tag) | Event::Empty(tag) => {
                    *elements.entry(tag.name().as_ref().to_owned()).or_default() += 1;
                }
                Event::Eof => break,
                _ => (),
            }
        }
        assert!(!elements.contains_key("script") && !elements.contains_key("img"), "{elements:?}");
    }
    assert_cells_are_texts(&table);
}

/// Asserts that each row has seven cells and that no text cell is a formula.
fn assert_cells_are_texts(table: &str) {
    let (mut cells, mut cell, mut quoted) = (Vec::new(), String::new(), false);
    for c in table.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(std::mem::take(&mut cell)),
            '\n' if !quoted => {
                cells.push(std::mem::take(&mut cell));
                assert_eq!(cells.len(), 7, "{cells:?}");
                for text in [&cells[3], &cells[4], &cells[5]] {
                    let start = text.chars().next().unwrap();
                    assert!(!"=+-@\t\r\n".contains(start), "{text:?}");
                }
                cells.clear();
            }
            c => cell.push(c),
        }
    }
    assert!(!quoted && cells.is_empty() && cell.is_empty());
}

/// Reads an assembly from memory.
fn open(name: &str, files: &[(&str, Vec<u8>)]) -> Assembly {
    let files: BTreeMap<PathBuf, Vec<u8>> =
        files.iter().map(|(name, bytes)| (name.into(), bytes.clone())).collect();
    read_from(name, &files, &ReadOptions::default().with_skip_missing(true)).unwrap()
}

/// Escapes a text for XML.
fn xml_escaped(text: &str) -> String {
    let plain: String = text.chars().filter(|c| !c.is_control()).collect();
    plain.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;").replace('\'', "&apos;")
}

#[test]
fn hostile_names_in_manifests_stay_text() {
    let parts: Vec<Value> = HOSTILE
        .iter()
        .enumerate()
        .map(|(k, name)| {
            json!({"file": "c.off", "name": name, "translation": [0.0, 0.9 * k as f64, 0.0]})
        })
        // A missing mesh, whose name becomes a note.
        .chain([json!({"file": HOSTILE[0].replace('/', "")})])
        .collect();
    for (k, unit) in HOSTILE.iter().enumerate() {
        let ignore = [[HOSTILE[0], HOSTILE[1]]];
        let manifest = json!({"unit": unit, "parts": parts, "ignore": ignore}).to_string();
        let files = [("m.json", manifest.into_bytes()), ("c.off", CUBE.into())];
        let assembly = open("m.json", &files);
        assert_eq!((assembly.parts().len(), assembly.unit()), (6, Some(*unit)));
        assert_eq!(assembly.notes().len(), 1);
        assert_names_stay_text(&assembly, HOSTILE[k]);
    }
    // TOML and JSON strings have the same syntax, except for the control character U+009B.
    let quoted = |text: &str| serde_json::to_string(text).unwrap();
    let toml: String = HOSTILE
        .iter()
        .map(|name| {
            format!("[[part]]\nfile = 'c.off'\nname = {}\n", quoted(name).replace('\u{9b}', ""))
        })
        .collect();
    let toml = format!("unit = {}\n{toml}", quoted(HOSTILE[0]));
    assert_names_stay_text(
        &open("m.toml", &[("m.toml", toml.into_bytes()), ("c.off", CUBE.into())]),
        HOSTILE[0],
    );
}

#[test]
fn hostile_file_names_stay_text() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    for name in HOSTILE {
        let name = name.replace(['/', '\0'], "");
        for (extension, text) in [("off", CUBE), ("obj", obj)] {
            let file = format!("{name}.{extension}");
            let assembly = open(&file, &[(&file, text.into())]);
            assert_eq!(assembly.parts()[0].name(), name);
            assert_names_stay_text(&assembly, &name);
        }
    }
}

#[test]
fn hostile_names_in_robots_stay_text() {
    let links: String = HOSTILE
        .iter()
        .map(|name| {
            let shape = "<collision><geometry><box size='1 1 1'/></geometry></collision>";
            format!("<link name=\"{}\">{shape}</link>", xml_escaped(name))
        })
        .collect();
    let lost = format!(
        "<link name='l'><collision><geometry><mesh filename=\"{}\"/></geometry></collision></link>",
        xml_escaped(HOSTILE[1])
    );
    let text = format!("<robot name=\"{}\">{links}{lost}</robot>", xml_escaped(HOSTILE[0]));
    let assembly = open("r.urdf", &[("r.urdf", text.into_bytes())]);
    assert_eq!((assembly.parts().len(), assembly.notes().len()), (6, 1));
    assert_names_stay_text(&assembly, HOSTILE[1]);
}

#[test]
fn hostile_names_in_3mf_packages_stay_text() {
    let mesh = mesh_of_3mf([1.0; 3]);
    let (mut objects, mut items) = (String::new(), String::new());
    for (k, name) in HOSTILE.iter().enumerate() {
        objects += &format!("<object id=\"{k}\" name=\"{}\">{mesh}</object>", xml_escaped(name));
        items += &format!("<item objectid=\"{k}\"/>");
    }
    let model = format!("<model><resources>{objects}</resources><build>{items}</build></model>");
    let assembly = open("p.3mf", &[("p.3mf", package(&[("3D/3dmodel.model", &model)]))]);
    assert_eq!(assembly.parts().len(), 6);
    assert_names_stay_text(&assembly, HOSTILE[2]);
}

#[test]
fn hostile_node_names_in_gltf_stay_text() {
    let names = HOSTILE.map(str::to_owned);
    let manifest = json!({"parts": names.iter().map(|name| {
        json!({"file": "c.off", "name": name})
    }).collect::<Vec<_>>()});
    let files = [("m.json", manifest.to_string().into_bytes()), ("c.off", CUBE.into())];
    // Reads the animation of the program itself.
    let animation = all_outputs(&open("m.json", &files), "t").animation;
    let assembly = open("a.glb", &[("a.glb", animation)]);
    let found: Vec<&str> = assembly.parts().iter().map(colltrans_assembly::Part::name).collect();
    assert_eq!(found, names);
    assert_names_stay_text(&assembly, HOSTILE[3]);
    let errors = read_from(Path::new(HOSTILE[0]), &BTreeMap::new(), &ReadOptions::default());
    assert!(errors.is_err());
}
