//! Errors of readers, with the file and the place.

use std::path::{Path, PathBuf};

use colltrans_assembly::AssemblyError;
use thiserror::Error;

/// An error that occurs while an assembly is read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// A file or folder cannot be opened or read.
    #[error("{}: cannot be read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The path is neither a folder nor a file of a known format.
    #[error(
        "{}: unknown kind of source; accepted: a folder of meshes, a manifest (.toml, .json), .urdf, .glb, \
         .gltf, .3mf, or a mesh",
        path.display()
    )]
    UnknownSource {
        /// The path that was given.
        path: PathBuf,
    },
    /// A STEP file, which this crate does not read.
    #[error(
        "{}: STEP is not read directly; convert the file to GLB, or use `colltrans assembly` or Python's `Assembly.read`, which convert it",
        path.display()
    )]
    Step {
        /// The file.
        path: PathBuf,
    },
    /// The contents violate the format.
    #[error("{}: {place}: {reason}", path.display())]
    Contents {
        /// The file.
        path: PathBuf,
        /// The place in the file.
        place: String,
        /// The reason, with the value that is rejected.
        reason: String,
    },
    /// The source refers to a file outside of the folders that may be read.
    #[error(
        "{}: rejected reference {name}; references must be relative and inside the folder of the \
         file",
        path.display()
    )]
    OutsideFolder {
        /// The source that has the reference.
        path: PathBuf,
        /// The reference as written in the source, or the path to which it leads.
        name: String,
    },
    /// The source has no parts.
    #[error("{}: no parts found: {holds}", path.display())]
    NoParts {
        /// The source.
        path: PathBuf,
        /// A description of the contents.
        holds: String,
    },
    /// The source refers to mesh files that do not exist.
    #[error("{}: {}", path.display(), missing_text(path, missing))]
    MissingMeshes {
        /// The file that has the references.
        path: PathBuf,
        /// The references as written in the file.
        missing: Vec<String>,
    },
    /// A mesh cannot be read.
    #[error(transparent)]
    Mesh(#[from] colltrans_mesh::Error),
    /// The parts do not form a valid assembly.
    #[error("{}: {source}", path.display())]
    Assembly {
        /// The source of the parts.
        path: PathBuf,
        /// The reason.
        source: AssemblyError,
    },
}

impl ReadError {
    /// Checks whether the error means that the source, or a file that must exist, was not found.
    pub fn is_missing_file(&self) -> bool {
        matches!(self, Self::Io { source, .. } if source.kind() == std::io::ErrorKind::NotFound)
    }
}

/// Returns the text about missing meshes, with the advice. Only robots have packages.
fn missing_text(path: &Path, missing: &[String]) -> String {
    let count = missing.len();
    let found = match missing {
        [one] => format!("1 referenced mesh not found: {one}"),
        _ => format!("{count} referenced meshes not found, the first is {}", missing[0]),
    };
    let extension = path.extension().unwrap_or_default();
    let is_manifest = ["toml", "json"].iter().any(|known| extension.eq_ignore_ascii_case(known));
    let advice = if is_manifest { "correct the paths" } else { "give the package roots" };
    format!("{found}; {advice}, or skip missing meshes")
}
