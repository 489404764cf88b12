//! Errors of readers, with the file and the place.

use std::path::PathBuf;

use colltrans_assembly::AssemblyError;
use thiserror::Error;

/// Why an assembly could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// A file or folder cannot be opened.
    #[error("{}: cannot be read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Neither a folder nor a kind of file that is known.
    #[error(
        "{}: neither a folder of meshes nor a known file: a manifest (.toml, .json), .urdf, .glb, \
         .gltf, .3mf, or a mesh",
        path.display()
    )]
    UnknownSource {
        /// What was given.
        path: PathBuf,
    },
    /// A STEP file, which has to be converted first.
    #[error(
        "{}: STEP files are converted to GLB first, which `colltrans assembly` and Python's `Assembly.read` do",
        path.display()
    )]
    Step {
        /// The file.
        path: PathBuf,
    },
    /// The contents are not what the format prescribes.
    #[error("{}: {place}: {reason}", path.display())]
    Contents {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: String,
        /// What is wrong.
        reason: String,
    },
    /// It names a file that it must not.
    #[error(
        "{}: {name} is named by an absolute path or lies outside of the folder that names it, and is \
         not read",
        path.display()
    )]
    Outside {
        /// The source.
        path: PathBuf,
        /// The file, as it is named, or where it is.
        name: String,
    },
    /// Nothing in it is a part.
    #[error("{}: holds no parts: {holds}", path.display())]
    NoParts {
        /// The source.
        path: PathBuf,
        /// What it holds instead.
        holds: String,
    },
    /// Files that are named and do not exist.
    #[error(
        "{}: {} of the meshes it names cannot be found, the first is {}; give the roots of \
         packages, or skip what is missing",
        path.display(), missing.len(), missing[0]
    )]
    Missing {
        /// The file that names them.
        path: PathBuf,
        /// Their names, as written there.
        missing: Vec<String>,
    },
    /// A mesh cannot be read.
    #[error(transparent)]
    Mesh(#[from] colltrans_mesh::Error),
    /// The parts do not make an assembly.
    #[error("{}: {source}", path.display())]
    Assembly {
        /// Where they come from.
        path: PathBuf,
        /// What is wrong.
        source: AssemblyError,
    },
}

impl ReadError {
    /// Checks whether the file does not exist.
    pub fn is_missing_file(&self) -> bool {
        matches!(self, Self::Io { source, .. } if source.kind() == std::io::ErrorKind::NotFound)
    }
}
