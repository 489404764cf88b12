//! Tests of what people look at after an audit: its report, and its BCF file.

use std::collections::BTreeSet;
use std::io::{Cursor, Read};

use colltrans_assembly::audit::{Audit, AuditOptions, audit};
use colltrans_assembly::report::{bcf, clashes};
use colltrans_assembly::{Assembly, Bodies, Fit, Watch};
use colltrans_mesh::plain::escape_control;
use colltrans_mesh::xml::Element;
use serde_json::Value;

use crate::common::{cuboid, part};

/// Names that are markup, formulas, or break lines.
const HOSTILE: [&str; 3] =
    ["</details><script>alert(1)</script>", "=1+1,\"x\"\n&amp;]]>", "\u{1b}[31m\u{0}'\u{202e}☃"];

/// Returns three boxes in a row, of which the first two overlap by 0.5 along x, and the others are 0.25 apart.
fn row(names: [&str; 3]) -> Assembly {
    let boxes = [
        cuboid([0.0; 3], [2.0; 3]),
        cuboid([1.5, 0.25, 0.25], [4.0, 1.75, 1.75]),
        cuboid([4.25, 0.0, 0.0], [6.0, 2.0, 2.0]),
    ];
    let parts = names.iter().zip(boxes).map(|(name, piece)| part(name, &[piece]));
    Assembly::new(parts.collect()).unwrap().with_unit("mm")
}

/// Audits an assembly and returns its report.
fn audited(assembly: &Assembly, within: f64) -> (Audit, String) {
    let bodies = Bodies::new(assembly, Fit::default_for(assembly)).unwrap();
    let options = AuditOptions::default().with_within(within).unwrap();
    let found = audit(&bodies, &options, Watch::default()).unwrap();
    let page = clashes::clashes_page(&bodies, &options, &found, "a <b>title</b>", Watch::default())
        .unwrap();
    (found, page)
}

/// Returns the data of the viewer in a page.
fn viewer_data(page: &str) -> Value {
    let start = "id=\"viewer-data\">";
    let from = page.find(start).unwrap() + start.len();
    serde_json::from_str(&page[from..from + page[from..].find("</script>").unwrap()]).unwrap()
}

/// Returns the files of a package.
fn unpacked(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut files = Vec::new();
    for k in 0..archive.len() {
        let mut file = archive.by_index(k).unwrap();
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).unwrap();
        files.push((file.name().unwrap().into_owned(), bytes));
    }
    files
}

#[test]
fn findings_are_listed_with_sections_worst_first() {
    let (found, page) = audited(&row(["left", "middle", "right"]), 1.0);
    assert_eq!(found.pairs.len(), 2);
    let entries: Vec<&str> = page.split("<details class=\"clash\"").skip(1).collect();
    assert_eq!(entries.len(), 2);
    assert!(entries[0].contains("left · middle") && entries[0].contains("depth 0.5 mm"));
    assert!(entries[0].contains("left by 0.5 mm along −x"), "{}", entries[0]);
    assert!(entries[1].contains("middle · right") && entries[1].contains("distance 0.25 mm"));
    assert!(entries.iter().all(|entry| entry.matches("<svg").count() == 1));
    let data = viewer_data(&page);
    let clash = &data["clashes"][0];
    assert_eq!(clash["parts"], serde_json::json!([0, 1]));
    assert_eq!(clash["parts_by_moving"], true);
    let [from, to] = [0, 1].map(|end| clash["line"][end][0].as_f64().unwrap());
    assert!((to - from + 0.5).abs() < 1e-9, "{clash}");
    // The nearest points of the others.
    let [from, to] = [0, 1].map(|end| data["clashes"][1]["line"][end][0].as_f64().unwrap());
    assert!((to - from - 0.25).abs() < 1e-9);
}

#[test]
fn clean_assembly_has_a_report_without_findings() {
    let (found, page) = audited(&row(["a", "b", "c"]), 0.0);
    assert_eq!(found.counts.violations, 1);
    let apart = [cuboid([0.0; 3], [1.0; 3]), cuboid([3.0; 3], [4.0; 3])];
    let parts = ["a", "b"].iter().zip(apart).map(|(name, piece)| part(name, &[piece]));
    let (_, clean) = audited(&Assembly::new(parts.collect()).unwrap(), 0.0);
    assert!(page.contains("1 pair violates its clearance."));
    assert!(clean.contains("No pair violates its clearance.") && !clean.contains("<details"));
}

#[test]
fn settings_that_decide_are_in_the_report() {
    let assembly = row(["left", "middle", "right"]);
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    let options = AuditOptions::default().with_allow_contact(true);
    let options = options.with_level(&assembly, [&["mid*"], &["right"]], 0.250_000_01).unwrap();
    let found = audit(&bodies, &options, Watch::default()).unwrap();
    let page = clashes::clashes_page(&bodies, &options, &found, "row", Watch::default()).unwrap();
    assert!(page.contains("Clearance between mid* and right: 0.25 mm"), "{page}");
    assert!(page.contains("Parts that touch satisfy every clearance."));
    // The distance and the clearance differ in print.
    let entry = page.split("<details class=\"clash\"").nth(2).unwrap();
    assert!(
        entry.contains("distance 0.25 mm") && entry.contains("<dd>0.25000001 mm</dd>"),
        "{entry}"
    );
}

#[test]
fn long_names_do_not_multiply_in_a_report_and_in_topics() {
    let long = ["l", "m", "r"].map(|name| name.repeat(100_000) + "\u{202e}");
    let assembly = row(long.each_ref().map(String::as_str)).with_unit("unit".repeat(1_000));
    let (found, page) = audited(&assembly, 1.0);
    assert!(found.pairs.len() == 2 && page.contains(&("l".repeat(120) + "…")));
    // Each name once for the viewer, and its script.
    let (_, short) = audited(&row(["l", "m", "r"]), 1.0);
    assert!(page.len() < short.len() + 310_000, "{} {}", page.len(), short.len());
    assert!(!page.contains('\u{202e}'));
    let assembly = assembly.with_unit("mm");
    let files = unpacked(&bcf::bcf_file(&assembly, &found, "row", 0, Watch::default()).unwrap());
    assert!(
        files
            .iter()
            .filter(|(path, _)| path.ends_with("markup.bcf"))
            .all(|(_, bytes)| bytes.len() < 2_000)
    );
}

#[test]
fn hostile_names_in_a_report_are_text() {
    let (_, page) = audited(&row(HOSTILE), 1.0);
    assert!(!page.contains("<script>alert") && !page.contains("<b>title"));
    assert_eq!(page.matches("<details").count(), 2);
    // A script ends only where the page ends it.
    assert_eq!(page.matches("</script>").count(), 2);
    let data = viewer_data(&page);
    let names: Vec<&str> =
        data["parts"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(names, HOSTILE.map(|name| escape_control(name).into_owned()));
}

#[test]
fn thousand_findings_share_the_geometry_of_their_parts() {
    let boxes = (0..=1_000).map(|k| {
        let x = f64::from(k);
        part(&format!("box {k}"), &[cuboid([x, 0.0, 0.0], [x + 1.125, 1.0, 1.0])])
    });
    let (found, page) = audited(&Assembly::new(boxes.collect()).unwrap(), 0.0);
    assert_eq!(found.counts.interfering, 1_000);
    assert_eq!(page.matches("<details class=\"clash\"").count(), 1_000);
    assert_eq!(page.matches("<svg").count(), 1_000);
    let data = viewer_data(&page);
    assert_eq!(data["parts"].as_array().unwrap().len(), 1_001);
    assert_eq!(data["clashes"].as_array().unwrap().len(), 1_000);
    assert!(page.len() < 5_000_000, "{}", page.len());
}

/// Returns the names of the children of an element, in order.
fn children(element: &Element) -> Vec<&str> {
    element.children.iter().map(|child| child.name.as_str()).collect()
}

/// The order of elements is that of `markup.xsd` and `visinfo.xsd` of BCF-XML 2.1.
#[test]
fn bcf_file_has_a_topic_for_each_violation() {
    for names in [["left", "middle", "right"], HOSTILE] {
        let assembly = row(names);
        let (found, _) = audited(&assembly, 1.0);
        let bytes = bcf::bcf_file(&assembly, &found, "row", 951_782_400, Watch::default()).unwrap();
        assert_eq!(
            bytes,
            bcf::bcf_file(&assembly, &found, "row", 951_782_400, Watch::default()).unwrap()
        );
        let files = unpacked(&bytes);
        assert_eq!(files.len(), 1 + 3 * 2);
        assert_eq!(files[0].0, "bcf.version");
        let version = Element::parse(std::str::from_utf8(&files[0].1).unwrap()).unwrap();
        assert_eq!(version.get("VersionId"), Some("2.1"));
        let mut ids = BTreeSet::new();
        for topic in files[1..].chunks(3) {
            let (folder, _) = topic[0].0.split_once('/').unwrap();
            let paths: Vec<&str> = topic.iter().map(|(path, _)| path.as_str()).collect();
            let expected = ["markup.bcf", "viewpoint.bcfv", "snapshot.png"];
            assert_eq!(paths, expected.map(|name| format!("{folder}/{name}")));
            let [markup, view] =
                [0, 1].map(|k| Element::parse(std::str::from_utf8(&topic[k].1).unwrap()).unwrap());
            assert_eq!(children(&markup), ["Topic", "Viewpoints"]);
            let details = markup.first_child("Topic").unwrap();
            assert_eq!(
                children(details),
                ["Title", "Index", "Labels", "CreationDate", "CreationAuthor", "Description"]
            );
            assert_eq!(details.get("Guid"), Some(folder));
            let text = |name| details.first_child(name).unwrap().text.as_str();
            assert_eq!(text("CreationDate"), "2000-02-29T00:00:00Z");
            // The reader of this workspace omits character references.
            let shown = names.map(|name| {
                name.replace(['\u{1b}', '\u{0}'], "\u{fffd}").replace(['<', '>', '&', '"'], "")
            });
            // Titles have the names with escapes.
            let title =
                colltrans_mesh::plain::escape_control(names[1]).replace(['<', '>', '&', '"'], "");
            assert!(text("Title").contains(&title), "{}", text("Title"));
            let viewpoints = markup.first_child("Viewpoints").unwrap();
            assert_eq!(viewpoints.get("Guid"), view.get("Guid"));
            assert_eq!(children(&view), ["Components", "PerspectiveCamera", "ClippingPlanes"]);
            let components = view.first_child("Components").unwrap();
            assert_eq!(children(components), ["Selection", "Visibility", "Coloring"]);
            let selected = components.first_child("Selection").unwrap();
            let named = selected.children_named("Component");
            let named: Vec<&str> =
                named.map(|c| c.first_child("AuthoringToolId").unwrap().text.as_str()).collect();
            assert!(named.len() == 2 && named.contains(&shown[1].as_str()), "{named:?}");
            assert!(topic[2].1.starts_with(b"\x89PNG\r\n"));
            ids.extend([folder.to_owned(), view.get("Guid").unwrap().to_owned()]);
        }
        assert_eq!(ids.len(), 4);
        let is_uuid = |id: &String| {
            let groups: Vec<usize> = id.split('-').map(str::len).collect();
            groups == [8, 4, 4, 4, 12] && id.chars().all(|c| c == '-' || c.is_ascii_hexdigit())
        };
        assert!(ids.iter().all(is_uuid), "{ids:?}");
    }
}

#[test]
fn topics_keep_their_identifiers_if_the_parts_are_listed_in_another_order() {
    let ids = |order: [usize; 3]| {
        let row = row(["left", "middle", "right"]);
        let parts = order.map(|k| row.parts()[k].clone()).to_vec();
        let assembly = Assembly::new(parts).unwrap().with_unit("mm");
        let (found, _) = audited(&assembly, 1.0);
        let files =
            unpacked(&bcf::bcf_file(&assembly, &found, "row", 0, Watch::default()).unwrap());
        files.into_iter().map(|(path, _)| path).collect::<BTreeSet<_>>()
    };
    assert_eq!(ids([0, 1, 2]), ids([2, 1, 0]));
    assert_eq!(ids([0, 1, 2]).len(), 7);
}

#[test]
fn bcf_file_needs_a_known_unit() {
    let (assembly, (found, _)) = (row(["a", "b", "c"]), audited(&row(["a", "b", "c"]), 0.0));
    let refused =
        bcf::bcf_file(&assembly.clone().with_unit("yd"), &found, "row", 0, Watch::default())
            .unwrap_err();
    assert_eq!(refused.kind(), std::io::ErrorKind::InvalidInput);
    assert!(
        refused.to_string().starts_with("unknown unit yd; BCF needs one of m, mm, cm"),
        "{refused}"
    );
    let without = Assembly::new(assembly.parts().to_vec()).unwrap();
    assert_eq!(bcf::metres_per_unit(&without), Ok(1.0));
}

#[test]
fn bcf_coordinates_have_the_z_axis_upwards() {
    use glam::DVec3;
    let location = |up: DVec3| {
        let assembly = row(["a", "b", "c"]).with_unit("m").with_up(up);
        let (found, _) = audited(&assembly, 0.0);
        let files =
            unpacked(&bcf::bcf_file(&assembly, &found, "row", 0, Watch::default()).unwrap());
        let view = Element::parse(std::str::from_utf8(&files[2].1).unwrap()).unwrap();
        let planes = view.first_child("ClippingPlanes").unwrap();
        let at = planes.first_child("ClippingPlane").unwrap().first_child("Location").unwrap();
        let at =
            ["X", "Y", "Z"].map(|name| at.first_child(name).unwrap().text.parse::<f64>().unwrap());
        (DVec3::from_array(at), found.pairs[0].finding.place())
    };
    for up in [DVec3::X, DVec3::Y, DVec3::Z] {
        let (written, place) = location(up);
        assert_eq!((written.z, written.length()), (place.dot(up), place.length()), "{up}");
    }
}

#[test]
fn bcf_camera_looks_at_the_place_in_metres() {
    let assembly = row(["0123456789abcdefghij_$", "middle", "right"]);
    let (found, _) = audited(&assembly, 0.0);
    let files = unpacked(&bcf::bcf_file(&assembly, &found, "row", 0, Watch::default()).unwrap());
    let view = Element::parse(std::str::from_utf8(&files[2].1).unwrap()).unwrap();
    let vector = |path: [&'static str; 2], from: &Element| {
        let vector = from.first_child(path[0]).unwrap().first_child(path[1]).unwrap();
        ["X", "Y", "Z"].map(|name| vector.first_child(name).unwrap().text.parse::<f64>().unwrap())
    };
    let eye = glam::DVec3::from_array(vector(["PerspectiveCamera", "CameraViewPoint"], &view));
    let along = glam::DVec3::from_array(vector(["PerspectiveCamera", "CameraDirection"], &view));
    let place = found.pairs[0].finding.place() * 1e-3;
    assert!((along.length() - 1.0).abs() < 1e-12);
    assert!((place - eye).cross(along).length() < 1e-12 && (place - eye).dot(along) > 1e-3);
    let planes = view.first_child("ClippingPlanes").unwrap();
    assert!(
        glam::DVec3::from_array(vector(["ClippingPlane", "Location"], planes)).distance(place)
            < 1e-12
    );
    // The plane hides what is in front of it.
    let hidden = glam::DVec3::from_array(vector(["ClippingPlane", "Direction"], planes));
    assert!(hidden.dot(along) < -0.5);
    // The identifier of a part in a building model.
    let selected = view.first_child("Components").unwrap().first_child("Selection").unwrap();
    let guids: Vec<_> = selected.children_named("Component").map(|c| c.get("IfcGuid")).collect();
    assert_eq!(guids, [Some("0123456789abcdefghij_$"), None]);
}
