//! The committed example parts equal the output of the program that writes them.

#[path = "../../examples/make_parts.rs"]
mod make_parts;

use crate::support::data;
use colltrans_testkit::TemporaryFolder;

#[test]
fn example_program_writes_the_committed_files() {
    let folder = TemporaryFolder::new();
    make_parts::write_parts(folder.path()).unwrap();
    let mut names: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names.len(), 7);
    for name in names {
        let written = std::fs::read(folder.path().join(&name)).unwrap();
        let committed = std::fs::read(data().join(&name)).unwrap_or_default();
        assert!(written == committed, "{} differs; run the example make_parts", name.display());
    }
    // The program's own entry point.
    let _: fn() -> Result<(), colltrans_mesh::Error> = make_parts::main;
}
