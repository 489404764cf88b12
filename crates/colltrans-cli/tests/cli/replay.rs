//! `colltrans replay`: saved queries and invalid files.

use colltrans::glam::DVec3;
use colltrans::{Cast, ConvexPolyhedron, Pose};
use colltrans_testkit::TemporaryFolder;

use crate::support::{colltrans, stderr, stdout};

#[test]
fn replayed_query_has_the_same_answer() {
    let folder = TemporaryFolder::new();
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).unwrap();
    let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0)).unwrap();
    let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X).unwrap();
    // Some editors write a byte order mark at the start.
    std::fs::write(folder.path().join("case.json"), format!("\u{feff}{}", cast.to_json())).unwrap();
    let output = colltrans(folder.path()).args(["replay", "case.json"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.starts_with("contact\n  translation  2 times the direction"), "{text}");

    std::fs::write(folder.path().join("none.json"), "{}").unwrap();
    let output = colltrans(folder.path()).args(["replay", "none.json"]).output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("none.json: not a saved query"), "{}", stderr(&output));
}
