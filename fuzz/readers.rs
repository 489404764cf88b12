//! Contains the fuzz targets for the readers of meshes, robots, tables and assemblies.
//!
//! The targets read arbitrary bytes as sources from memory. The result must be a mesh, an assembly or an error.
//! Inputs of targets for one format begin with a byte: after an even byte, the rest is the file; otherwise
//! [`written`] generates the file from the rest. The corpora are also ordinary tests
//! (`crates/colltrans-assembly/tests/assembly/fuzz_corpus.rs`).

use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use arbitrary::Unstructured;
use colltrans_assembly_io::read::{ReadOptions, read_disabled_pairs, read_from};
use colltrans_assembly_io::robot::Table;
use colltrans_mesh::Format;

#[path = "written.rs"]
mod written;

/// A cube, as a mesh file that sources may name.
const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n\
    4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";

/// Reads a source from memory, and checks the result.
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

/// Reads GLB if the bytes begin with its mark, else glTF.
pub(crate) fn gltf(bytes: &[u8]) {
    open(if bytes.starts_with(b"glTF") { "a.glb" } else { "a.gltf" }, bytes);
}

/// Reads a robot.
pub(crate) fn urdf(bytes: &[u8]) {
    open("a.urdf", bytes);
}

/// Reads a manifest: JSON if it begins with a brace, else TOML.
pub(crate) fn manifest(bytes: &[u8]) {
    open(if bytes.starts_with(b"{") { "a.json" } else { "a.toml" }, bytes);
}

/// Reads a 3MF package if the bytes begin like a zip archive. Otherwise, the bytes are the models of a package,
/// between lines of `----`.
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

/// Returns the bytes of a file: those after the first byte, or the output of `generate` from them.
fn file_of(
    bytes: &[u8],
    generate: impl FnOnce(&mut Unstructured<'_>) -> arbitrary::Result<Vec<u8>>,
) -> Option<Vec<u8>> {
    let (&first, rest) = bytes.split_first()?;
    if first % 2 == 0 { Some(rest.to_vec()) } else { generate(&mut Unstructured::new(rest)).ok() }
}

/// Reads a mesh, and checks the guarantees for every mesh.
fn mesh(format: Format, file: Option<Vec<u8>>) {
    let Some(file) = file else { return };
    match colltrans_mesh::parse(format, file, Path::new("a.mesh")) {
        Ok(mesh) => {
            let count = mesh.vertices.len();
            assert!(mesh.faces.iter().all(|face| face.len() >= 3));
            assert!(mesh.faces.iter().flatten().all(|&vertex| (vertex as usize) < count));
        }
        Err(error) => assert!(error.to_string().contains("a.mesh")),
    }
}

/// Reads an STL file.
pub(crate) fn stl(bytes: &[u8]) {
    mesh(Format::Stl, file_of(bytes, written::stl));
}

/// Reads an OBJ file.
pub(crate) fn obj(bytes: &[u8]) {
    mesh(Format::Obj, file_of(bytes, written::obj));
}

/// Reads a PLY file.
pub(crate) fn ply(bytes: &[u8]) {
    mesh(Format::Ply, file_of(bytes, written::ply));
}

/// Reads an OFF file.
pub(crate) fn off(bytes: &[u8]) {
    mesh(Format::Off, file_of(bytes, written::off));
}

/// Reads a COLLADA file.
pub(crate) fn dae(bytes: &[u8]) {
    mesh(Format::Dae, file_of(bytes, written::dae));
}

/// Reads the pairs of links that an SRDF file in the temporary folder disables.
pub(crate) fn srdf(bytes: &[u8]) {
    let Some(file) = file_of(bytes, written::srdf) else { return };
    let path = std::env::temp_dir().join(format!("colltrans-fuzz-{}.srdf", std::process::id()));
    std::fs::write(&path, file).expect("a temporary file");
    if let Err(error) = read_disabled_pairs(&path) {
        assert!(!error.to_string().is_empty());
    }
    std::fs::remove_file(&path).expect("the temporary file");
}

/// Reads a table of joint values, CSV or JSON.
pub(crate) fn csv(bytes: &[u8]) {
    let Some(file) = file_of(bytes, written::csv) else { return };
    match Table::parse(&String::from_utf8_lossy(&file)) {
        Ok(table) => assert!(!table.rows.is_empty()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
