//! The corpora of the fuzz targets as ordinary tests. A finding becomes one more file.

use std::fs;
use std::path::Path;

use colltrans_testkit::oracle::fuzz;

/// Runs a target over every file of its corpus.
fn replay(name: &str, target: fn(&[u8]), at_least: usize) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(name);
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|entry| entry.expect("an entry").path())
        .collect();
    files.sort();
    assert!(files.len() >= at_least, "{} files only in {}", files.len(), folder.display());
    for file in files {
        let bytes = fs::read(&file).expect("a file");
        println!("{}", file.display());
        target(&bytes);
    }
}

#[test]
fn hull_corpus() {
    replay("hull", fuzz::hull, 8);
}

#[test]
fn from_mesh_corpus() {
    replay("from_mesh", fuzz::from_mesh, 8);
}

#[test]
fn cast_corpus() {
    replay("cast", fuzz::cast, 8);
}

#[test]
fn solids_corpus() {
    replay("solids", fuzz::solids, 12);
}

#[test]
fn track_corpus() {
    replay("track", fuzz::track, 24);
}
