//! Assemblies as people have them: a folder of meshes, a manifest, URDF, glTF, 3MF.
//!
//! Every reader gives parts in one world and one unit. Units are what the file says (metres for URDF
//! and glTF, what a 3MF file or a manifest names); a folder of meshes does not say, and its lengths
//! are taken as they are.

#[cfg(feature = "files")]
mod folder;
mod gltf;
#[cfg(feature = "files")]
mod manifest;
#[cfg(feature = "files")]
mod shapes;
#[cfg(feature = "files")]
mod threemf;
#[cfg(feature = "files")]
mod urdf;

#[cfg(feature = "files")]
use std::collections::BTreeMap;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

#[cfg(feature = "files")]
use glam::DAffine3;

use crate::error::{AssemblyError, ReadError};
#[cfg(feature = "files")]
use crate::part::Piece;
use crate::part::{Assembly, Part};

/// Which geometry of a URDF link is read.
#[cfg(feature = "files")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Geometry {
    /// What collision checkers use.
    #[default]
    Collision,
    /// What is drawn.
    Visual,
}

/// What readers need to know beside the file.
#[cfg(feature = "files")]
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Folders in which `package://name/rest` is looked for: as `name/rest`, then as `rest`, then
    /// with fewer leading folders.
    pub packages: Vec<PathBuf>,
    /// Whether meshes that cannot be found are left out, with a note.
    pub skip_missing: bool,
    /// Which geometry of a URDF link is read.
    pub geometry: Geometry,
    /// Positions of joints by name, in radians or metres; 0 for those not named.
    pub joints: BTreeMap<String, f64>,
}

/// Reads an assembly: a folder, a manifest (`.toml`, `.json`), `.urdf`, `.glb`, `.gltf`, `.3mf`, or a
/// single mesh.
///
/// # Errors
/// What cannot be read, with the file and the place.
#[cfg(feature = "files")]
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Assembly, ReadError> {
    let path = path.as_ref();
    if path.is_dir() {
        return folder::read(path);
    }
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "toml" | "json" => manifest::read(path, options),
        "urdf" => urdf::read(path, options),
        "glb" | "gltf" => gltf::read(path),
        "3mf" => threemf::read(path),
        _ if colltrans_mesh::Format::of_path(path).is_ok() => {
            folder::read_files(path, &[path.into()])
        }
        _ if path.exists() => Err(ReadError::UnknownSource { path: path.into() }),
        _ => Err(io(path)(std::io::Error::from(std::io::ErrorKind::NotFound))),
    }
}

/// Reads a GLB file that is in memory, of which nothing lies elsewhere.
///
/// # Errors
/// What cannot be read, with the place.
pub fn glb(name: impl AsRef<Path>, bytes: &[u8]) -> Result<Assembly, ReadError> {
    gltf::parse(name.as_ref(), bytes)
}

fn io(path: &Path) -> impl Fn(std::io::Error) -> ReadError + '_ {
    move |source| ReadError::Io { path: path.into(), source }
}

fn in_file(path: &Path) -> impl Fn(AssemblyError) -> ReadError + '_ {
    move |source| ReadError::Assembly { path: path.into(), source }
}

fn contents(path: &Path, place: impl Into<String>, reason: impl std::fmt::Display) -> ReadError {
    ReadError::Contents { path: path.into(), place: place.into(), reason: reason.to_string() }
}

/// A mesh file as a piece.
#[cfg(feature = "files")]
fn piece(path: &Path, world_from_piece: DAffine3) -> Result<Piece, ReadError> {
    let mesh = colltrans_mesh::read(path)?;
    Ok(Piece { vertices: mesh.vertices, faces: mesh.faces, world_from_piece })
}

/// Nodes or components of a file, each as often as it is placed, at most.
const MOST_PLACED: usize = 1 << 16;

/// Counts what a file places.
fn placed_one_more(count: &mut usize) -> Result<(), String> {
    *count += 1;
    if *count > MOST_PLACED {
        return Err(format!("more than {MOST_PLACED} things are placed, one in another"));
    }
    Ok(())
}

/// An assembly that says so if it has no parts.
fn or_noted(assembly: Assembly) -> Assembly {
    if assembly.parts().is_empty() {
        assembly.with_note("no mesh is in this file")
    } else {
        assembly
    }
}

/// The file's name without its extension.
#[cfg(feature = "files")]
fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Names that a file gives more than once are numbered, from the second on.
#[derive(Default)]
struct Names {
    taken: HashSet<String>,
    /// The next number of a name that was given before.
    next: HashMap<String, usize>,
}

impl Names {
    fn unique(&mut self, name: &str) -> String {
        let number = self.next.entry(name.to_owned()).or_insert(2);
        let mut chosen = name.to_owned();
        while !self.taken.insert(chosen.clone()) {
            chosen = format!("{name}_{number}");
            *number += 1;
        }
        chosen
    }
}

/// An assembly of parts that came from one source, and from the files that it names.
fn assembled(
    path: &Path,
    parts: Vec<Part>,
    mut files: Vec<PathBuf>,
) -> Result<Assembly, ReadError> {
    if path.is_file() {
        files.push(path.into());
    }
    Ok(Assembly::new(parts).map_err(in_file(path))?.with_files(files))
}
