//! `--picture`: pictures of all pairs of bodies are well formed, finite and complete.

use std::path::Path;

use crate::support::{CAST, colltrans, data, folder, stderr};

/// Returns the names of the elements of an XML document in order of their start. Panics if it is not well formed.
fn elements(svg: &str) -> Vec<String> {
    let mut open: Vec<String> = Vec::new();
    let mut found = Vec::new();
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        let text = &rest[..start];
        assert!(!open.is_empty() || text.trim().is_empty(), "text outside the root: {text:?}");
        assert!(!text.contains('>'), "a stray > in {text:?}");
        let end = start + rest[start..].find('>').expect("an unclosed tag");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "tags close in order");
            assert!(!open.is_empty() || rest.trim().is_empty(), "one root");
            continue;
        }
        let body = tag.strip_suffix('/').unwrap_or(tag);
        let name = body.split_whitespace().next().unwrap();
        assert_eq!(body.matches('"').count() % 2, 0, "quotes come in pairs: {body:?}");
        found.push(name.to_string());
        if !tag.ends_with('/') {
            open.push(name.to_string());
        }
    }
    assert!(open.is_empty(), "left open: {open:?}");
    found
}

/// Runs a command with a picture, checks the picture and returns it.
fn picture(folder: &Path, arguments: &[&str]) -> String {
    let output = colltrans(folder).args(arguments).args(["--picture", "out.svg"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
    let svg = std::fs::read_to_string(folder.join("out.svg")).unwrap();
    let found = elements(&svg);
    assert_eq!(found[0], "svg");
    assert!(found.iter().filter(|name| *name == "path").count() > 1, "{arguments:?}");
    for word in ["NaN", "nan", "inf"] {
        assert!(!svg.contains(word), "{word} in the picture of {arguments:?}");
    }
    // Far coordinates are clipped, because renderers use few bits.
    for path in svg.split(" d=\"").skip(1) {
        let data = path.split('"').next().unwrap();
        for number in data.split(['M', 'L', 'Z', 'h', 'v', 'z', ' ']).filter(|n| !n.is_empty()) {
            assert!(number.parse::<f64>().unwrap().abs() < 2000.0, "{number} in {arguments:?}");
        }
    }
    svg
}

#[test]
fn picture_of_a_contact_has_labels_and_legend() {
    let folder = folder();
    let svg = picture(folder.path(), &CAST);
    for part in [
        "Contact at t = 2",
        "moving, at the start",
        "normal n = (1, 0, 0)",
        ">n<",
        "stroke-dasharray",
    ] {
        assert!(svg.contains(part), "{part:?}");
    }
    assert_eq!(svg, picture(folder.path(), &CAST), "the same bits each time");
}

#[test]
fn pictures_of_other_outcomes_state_them() {
    let folder = folder();
    let at = |pose: &str| {
        let more = ["cast", "cube.off", "cube.off", "--direction", "0,0,-1", "--moving-pose", pose];
        picture(folder.path(), &more)
    };
    let separated = at("1.5,0,9");
    assert!(
        separated.contains("margin (gap along the normal n) 0.5")
            && separated.contains("separating plane")
    );
    assert!(at("1,0,9").contains("Grazing at t = 8"));
    let overlapping = at("0,0.5,0.5");
    assert!(overlapping.contains("the bodies overlap now, first contact at t = -0.5"));
    let behind = at("0,0.5,-30");
    assert!(behind.contains("drawn shortened"));
    assert!(behind.contains("Contact: lies behind, at t = -31"));
    assert!(!overlapping.contains("lies behind") && !behind.contains("overlap now"));
    assert!(at("0,0.5,1").contains("Contact at t = 0"), "touching");
    assert!(at("0,0,1e6").contains("drawn shortened"), "far away");
}

/// Points, segments, polygons, and very different sizes.
#[test]
fn pictures_of_degenerate_bodies_are_well_formed() {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("point.obj", "v 0.5 0.5 0.5\n");
    write("segment.obj", "v 0.5 0.5 0.5\nv 0.25 0.75 1\n");
    write("triangle.obj", "v 0 0.5 0.5\nv 0.25 0.75 1\nv 0 0.25 0\nf 1 2 3\n");
    write("floor.obj", "v -1e6 -1e6 0\nv 1e6 -1e6 0\nv 1e6 1e6 0\nv -1e6 1e6 0\nv 0 0 -1\n");
    let names = ["point.obj", "segment.obj", "triangle.obj", "cube.off", "floor.obj"];
    for moving in names {
        for fixed in names {
            for direction in ["0,0,-1", "1,0.5,-0.25"] {
                let more = ["cast", moving, fixed, "--hull", "--direction", direction];
                picture(folder.path(), &[&more[..], &["--moving-pose", "0,0,3"]].concat());
            }
        }
    }
}

#[test]
fn pictures_of_example_parts_are_well_formed() {
    let folder = folder();
    let part = |name: &str| data().join(name).to_str().unwrap().to_owned();
    let parts =
        ["bracket.obj", "dodecahedron.off", "gear_hull.stl", "ellipsoid_a.obj", "ellipsoid_b.off"];
    for moving in parts {
        for fixed in parts {
            let (moving, fixed) = (part(moving), part(fixed));
            let more = ["cast", &moving, &fixed, "--direction", "1,0.5,-1"];
            picture(folder.path(), &[&more[..], &["--moving-pose", "-8,-4,8"]].concat());
        }
    }
}

#[test]
fn pictures_of_nonconvex_parts_are_well_formed() {
    let folder = folder();
    let [bolt, plate] = ["bolt.stl", "plate.off"].map(|part| data().join(part));
    for part in [&bolt, &plate] {
        std::fs::copy(part, folder.path().join(part.file_name().unwrap())).unwrap();
    }
    let ask = |more: &[&str]| {
        let words = ["clear", "bolt.stl", "--from", "plate.off", "--direction"];
        picture(folder.path(), &[&words[..], more].concat())
    };
    let svg = ask(&["-z", "--moving-pose", "0,0,7"]);
    for part in ["Blocked at t = 7", "moving, at the start", "normal n = (0, 0, -1)", ">n<"] {
        assert!(svg.contains(part), "{part:?}");
    }
    assert!(!svg.contains("contact feature") && !svg.contains("separating plane"));
    assert!(svg.contains("stroke-dasharray"), "hidden edges");
    assert!(svg.len() < 100_000, "{} bytes", svg.len());
    let free = ask(&["z", "--moving-pose", "0,0,7"]);
    assert!(free.contains("Free: nothing stops the body along d") && !free.contains(">n<"));
    assert!(ask(&["1,2,3", "--moving-pose", "1,0,-1"]).contains("Overlapping"));
    // Very different sizes, and large distances.
    ask(&["-z", "--moving-pose", "0,0,9000"]);
    ask(&["-z", "--moving-pose", "0,0,5000", "--fixed-scale", "1000"]);
    ask(&["1,0.3,-0.2", "--moving-pose", "-30,-9,6", "--moving-rpy", "20,30,40"]);
}
