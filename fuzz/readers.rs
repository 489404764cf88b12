//! Fuzz targets for the readers of assemblies: arbitrary bytes as sources, from memory. Whatever they
//! hold, the answer is an assembly or an error. Their corpora run as ordinary tests too
//! (`crates/colltrans-assembly/tests/assembly/fuzz_corpus.rs`).

use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use std::path::PathBuf;

use colltrans_assembly::read::{ReadOptions, read_from};

/// A cube, as a mesh file that sources may name.
const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n\
    4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";

fn open(name: &str, bytes: &[u8]) {
    let mut files: BTreeMap<PathBuf, Vec<u8>> = BTreeMap::new();
    files.insert("c.off".into(), CUBE.into());
    files.insert("c.bin".into(), (0..=255).collect());
    files.insert(name.into(), bytes.to_vec());
    let mut options = ReadOptions::default().with_skip_missing(true);
    options.packages.push("kit".into());
    match read_from(name, &files, &options) {
        Ok(assembly) => assert!(!assembly.parts().is_empty()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// glTF, or GLB by how it begins.
pub(crate) fn gltf(bytes: &[u8]) {
    open(if bytes.starts_with(b"glTF") { "a.glb" } else { "a.gltf" }, bytes);
}

/// A robot.
pub(crate) fn urdf(bytes: &[u8]) {
    open("a.urdf", bytes);
}

/// A manifest: JSON if it begins with a brace, else TOML.
pub(crate) fn manifest(bytes: &[u8]) {
    open(if bytes.starts_with(b"{") { "a.json" } else { "a.toml" }, bytes);
}

/// A 3MF package, if it begins as a zip archive does; else the models of one, between lines of `----`.
pub(crate) fn threemf(bytes: &[u8]) {
    if bytes.starts_with(b"PK") {
        return open("a.3mf", bytes);
    }
    let text = String::from_utf8_lossy(bytes);
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let stored =
        zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    let names = ["3D/3dmodel.model", "3D/Objects/b.model", "_rels/.rels"];
    for (name, model) in names.into_iter().zip(text.split("\n----\n")) {
        zip.start_file(name, stored).expect("a name of its own");
        zip.write_all(model.as_bytes()).expect("memory");
    }
    open("a.3mf", &zip.finish().expect("memory").into_inner());
}
