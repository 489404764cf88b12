//! The corpora of the fuzz targets of readers as ordinary tests. A finding becomes one more file.

use std::fs;
use std::path::Path;

#[path = "../../../fuzz/readers.rs"]
mod readers;

/// Runs a target over every file of its corpus.
fn replay(name: &str, target: fn(&[u8]), at_least: usize) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(name);
    let mut files: Vec<_> =
        fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= at_least, "{} files only in {}", files.len(), folder.display());
    for file in files {
        println!("{}", file.display());
        target(&fs::read(&file).unwrap());
    }
}

#[test]
fn corpora_of_readers() {
    replay("threemf", readers::threemf, 4);
    replay("gltf", readers::gltf, 4);
    replay("urdf", readers::urdf, 3);
    replay("manifest", readers::manifest, 3);
}
