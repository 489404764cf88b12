//! Names that want to be more than names: in every field of every source, to every output.

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
use colltrans_assembly::{Assembly, Bodies, Fit, Question, Watch};
use colltrans_assembly_io::read::{ReadOptions, read_from};
use quick_xml::events::Event;
use serde_json::{Value, json};

/// Out of a text, an attribute, a script, a comment; a formula; codes for a terminal.
const HOSTILE: [&str; 6] = [
    "</td></text></title></script><script>window.hit=1</script><img src=x onerror=window.hit=1>",
    "\"><svg onload=window.hit=1>' onmouseover='window.hit=1",
    "<!--<script>{{7*7}}&lt;script&gt;\u{2028}window.hit=1//]]>",
    "=HYPERLINK(\"http://x\",\"y\"),\r\n@SUM(1),\u{1b}]0;t\u{7}\u{9b}31m",
    "+cmd|' /C calc'!A0",
    "\t-1,\"\n",
];

/// What each kind of output says, made of an assembly of cubes that partly overlap.
struct Outputs {
    page: String,
    table: String,
    pictures: Vec<String>,
    animation: Vec<u8>,
    facts: Value,
}

fn outputs(assembly: &Assembly, title: &str) -> Outputs {
    let watch = Watch::default();
    let bodies = Bodies::new(assembly, Fit::Tolerance(1e-6)).unwrap();
    let question = Question::default().with_options(PlanOptions::default().with_samples(12));
    let mut findings = question.ask(&bodies, watch).unwrap();
    let options = MapOptions::default().with_samples(12).with_border(1.0);
    let options = options.with_start(PlanOptions::default().start);
    let map = RemovalMap::new(&bodies, &[0], &[], options, watch).unwrap();
    findings.maps = vec![(title.to_owned(), map)];
    Outputs {
        page: html::page(&findings, title),
        table: findings.matrix.to_csv(&bodies),
        pictures: findings.maps.iter().map(|(name, found)| map::svg(found, name)).collect(),
        animation: glb::animation(assembly, &findings.plan),
        facts: facts::json(&findings),
    }
}

/// Every element of a page is one that this program writes, and has no attribute that it does not.
fn only_own_elements(page: &str) {
    let text = page.split("<script>").next().unwrap();
    let (mut rest, mut scripts) = (text, 0);
    while let Some(at) = rest.find('<') {
        rest = &rest[at + 1..];
        let end = rest.find('>').unwrap();
        let tag = rest[..end].trim_start_matches('/');
        let name = tag.split([' ', '/']).next().unwrap();
        assert!(!matches!(name, "img" | "iframe" | "a") && !name.starts_with("!--"), "{tag}");
        // Outside of what is quoted, attributes have names.
        for (k, outside) in tag.split('"').enumerate() {
            let handler = outside.split_whitespace().any(|word| word.starts_with("on"));
            assert!(k % 2 == 1 || !handler, "{tag}");
        }
        scripts += usize::from(name == "script" && !rest.starts_with('/'));
    }
    assert!(scripts <= 1, "the data of the viewer");
    // Behind the pictures only the viewer's own program begins, and ends once.
    assert_eq!(page.matches("<script>").count(), 1);
}

fn check(assembly: &Assembly, title: &str) {
    let Outputs { page, table, pictures, animation, facts } = outputs(assembly, title);
    only_own_elements(&page);
    for part in assembly.parts() {
        let name = part.name();
        assert!(facts.to_string().contains(&json!(name).to_string()));
        let escaped = name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        assert!(page.contains(&escaped.replace('"', "&quot;")), "{name:?} as it is");
    }
    // The animation is glTF, whose names are JSON.
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
    cells_are_texts(&table);
}

/// Seven cells a row, none of which is a formula.
fn cells_are_texts(table: &str) {
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

fn open(name: &str, files: &[(&str, Vec<u8>)]) -> Assembly {
    let files: BTreeMap<PathBuf, Vec<u8>> =
        files.iter().map(|(name, bytes)| (name.into(), bytes.clone())).collect();
    read_from(name, &files, &ReadOptions::default().with_skip_missing(true)).unwrap()
}

/// As XML writes it.
fn xml(text: &str) -> String {
    let plain: String = text.chars().filter(|c| !c.is_control()).collect();
    plain.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;").replace('\'', "&apos;")
}

#[test]
fn manifests() {
    let parts: Vec<Value> = HOSTILE
        .iter()
        .enumerate()
        .map(|(k, name)| {
            json!({"file": "c.off", "name": name, "translation": [0.0, 0.9 * k as f64, 0.0]})
        })
        // Missing: the name becomes a note.
        .chain([json!({"file": HOSTILE[0].replace('/', "")})])
        .collect();
    for (k, unit) in HOSTILE.iter().enumerate() {
        let ignore = [[HOSTILE[0], HOSTILE[1]]];
        let manifest = json!({"unit": unit, "parts": parts, "ignore": ignore}).to_string();
        let files = [("m.json", manifest.into_bytes()), ("c.off", CUBE.into())];
        let assembly = open("m.json", &files);
        assert_eq!((assembly.parts().len(), assembly.unit()), (6, Some(*unit)));
        assert_eq!(assembly.notes().len(), 1);
        check(&assembly, HOSTILE[k]);
    }
    // TOML writes strings as JSON does, but for the line separator.
    let quoted = |text: &str| serde_json::to_string(text).unwrap();
    let toml: String = HOSTILE
        .iter()
        .map(|name| {
            format!("[[part]]\nfile = 'c.off'\nname = {}\n", quoted(name).replace('\u{9b}', ""))
        })
        .collect();
    let toml = format!("unit = {}\n{toml}", quoted(HOSTILE[0]));
    check(&open("m.toml", &[("m.toml", toml.into_bytes()), ("c.off", CUBE.into())]), HOSTILE[0]);
}

#[test]
fn names_of_files() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    for name in HOSTILE {
        let name = name.replace(['/', '\0'], "");
        for (extension, text) in [("off", CUBE), ("obj", obj)] {
            let file = format!("{name}.{extension}");
            let assembly = open(&file, &[(&file, text.into())]);
            assert_eq!(assembly.parts()[0].name(), name);
            check(&assembly, &name);
        }
    }
}

#[test]
fn robots() {
    let links: String = HOSTILE
        .iter()
        .map(|name| {
            let shape = "<collision><geometry><box size='1 1 1'/></geometry></collision>";
            format!("<link name=\"{}\">{shape}</link>", xml(name))
        })
        .collect();
    let lost = format!(
        "<link name='l'><collision><geometry><mesh filename=\"{}\"/></geometry></collision></link>",
        xml(HOSTILE[1])
    );
    let text = format!("<robot name=\"{}\">{links}{lost}</robot>", xml(HOSTILE[0]));
    let assembly = open("r.urdf", &[("r.urdf", text.into_bytes())]);
    assert_eq!((assembly.parts().len(), assembly.notes().len()), (6, 1));
    check(&assembly, HOSTILE[1]);
}

#[test]
fn packages() {
    let mesh = mesh_of_3mf([1.0; 3]);
    let (mut objects, mut items) = (String::new(), String::new());
    for (k, name) in HOSTILE.iter().enumerate() {
        objects += &format!("<object id=\"{k}\" name=\"{}\">{mesh}</object>", xml(name));
        items += &format!("<item objectid=\"{k}\"/>");
    }
    let model = format!("<model><resources>{objects}</resources><build>{items}</build></model>");
    let assembly = open("p.3mf", &[("p.3mf", package(&[("3D/3dmodel.model", &model)]))]);
    assert_eq!(assembly.parts().len(), 6);
    check(&assembly, HOSTILE[2]);
}

#[test]
fn nodes() {
    let names = HOSTILE.map(str::to_owned);
    let manifest = json!({"parts": names.iter().map(|name| {
        json!({"file": "c.off", "name": name})
    }).collect::<Vec<_>>()});
    let files = [("m.json", manifest.to_string().into_bytes()), ("c.off", CUBE.into())];
    // Its own animation, read back.
    let animation = outputs(&open("m.json", &files), "t").animation;
    let assembly = open("a.glb", &[("a.glb", animation)]);
    let found: Vec<&str> = assembly.parts().iter().map(colltrans_assembly::Part::name).collect();
    assert_eq!(found, names);
    check(&assembly, HOSTILE[3]);
    let errors = read_from(Path::new(HOSTILE[0]), &BTreeMap::new(), &ReadOptions::default());
    assert!(errors.is_err());
}
