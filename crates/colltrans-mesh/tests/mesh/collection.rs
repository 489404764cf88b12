//! Reads a collection of real and broken mesh files, if it is available. Each file must be read or rejected
//! with a typed error, and known properties of some files are checked.
//!
//! The folder is `COLLTRANS_DATA`, or `../shared/data` next to the workspace.

use std::path::{Path, PathBuf};

use colltrans_mesh::{Error, Format, Mesh, ReadOptions, read, read_with};

fn collection_folder() -> Option<PathBuf> {
    let folder = std::env::var_os("COLLTRANS_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    folder.is_dir().then_some(folder)
}

fn mesh_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(mesh_files(&path));
        } else if Format::from_path(&path).is_ok() {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn every_file_is_read_or_rejected() {
    let Some(folder) = collection_folder() else { return };
    let files = mesh_files(&folder);
    assert!(!files.is_empty());
    for path in files {
        match read(&path) {
            Ok(mesh) => assert!(!mesh.vertices.is_empty(), "{}", path.display()),
            Err(Error::Syntax { .. }) => {}
            Err(other) => panic!("{other}"),
        }
    }
}

/// Closed parts with corners that are written with different rounding.
#[test]
fn duplicate_vertices_of_closed_parts_are_merged() {
    let Some(folder) = collection_folder() else { return };
    for (name, merged) in
        [("angle_block.STL", 46), ("featuretype.STL", 288), ("octagonal_pocket.ply", 27)]
    {
        let path = folder.join("trimesh").join(name);
        let mesh = read(&path).unwrap();
        assert_eq!(mesh.open_edges().len(), 0, "{name}");
        assert_eq!(mesh.merged.vertices, merged, "{name}");
        assert_eq!((mesh.merged.ambiguous, mesh.merged.dropped_faces), (0, 0), "{name}");
        // The differences are roundings of double precision, also in the file that was then written in single
        // precision.
        let rounding = 2.0_f64.powi(-48) * mesh.extent();
        assert!(mesh.merged.largest_distance <= rounding, "{name}");
        let equal_only = ReadOptions::default().with_merge_tolerance(Some(0.0));
        assert!(!read_with(&path, equal_only).unwrap().open_edges().is_empty(), "{name}");
    }
}

/// For each broken file, the number of open edges of its surface.
#[test]
fn broken_files_have_expected_open_edges() {
    let Some(folder) = collection_folder() else { return };
    for (name, open) in [
        ("busted.STL", 0),
        ("comments.off", 0),
        ("multibody.stl", 12),
        ("nancolor.obj", 0),
        ("negative_indices.obj", 0),
        ("not_convex.obj", 0),
        ("points_emptyface.ply", 0),
        ("soup.stl", 300),
        ("whitespace.off", 0),
    ] {
        let mesh = read(folder.join("bad").join(name)).unwrap();
        assert_eq!(mesh.open_edges().len(), open, "{name}");
        assert!(mesh.vertices.iter().all(|v| v.is_finite()), "{name}");
    }
}

#[test]
fn files_have_known_counts() {
    let Some(folder) = collection_folder() else { return };
    let counts = |name: &str| {
        let Mesh { vertices, faces, .. } = read(folder.join(name)).unwrap();
        (vertices.len(), faces.len())
    };
    assert_eq!(counts("trimesh/unit_cube.STL"), (8, 12));
    assert_eq!(counts("trimesh/bunny.ply"), (8171, 16301));
    assert_eq!(counts("trimesh/fuze.ply"), (502, 1000));
    assert_eq!(counts("bad/comments.off"), (8, 6));
    assert_eq!(counts("bad/whitespace.off"), (8, 6));
    assert_eq!(counts("bad/negative_indices.obj"), (8, 6));
    assert_eq!(counts("bad/nancolor.obj"), (8, 12));
    assert_eq!(counts("bad/points_emptyface.ply"), (1024, 0));
}
