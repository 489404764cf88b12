//! Assemblies as people have them: a folder of meshes, a manifest, URDF, glTF, 3MF.
//!
//! Every reader gives parts in one world and one unit. Units are what the file says (metres for URDF
//! and glTF, what a 3MF file or a manifest names); a folder of meshes does not say, and its lengths
//! are taken as they are.

mod drafts;
mod files;
#[cfg(feature = "files")]
mod folder;
mod gltf;
#[cfg(feature = "files")]
mod manifest;
#[cfg(feature = "files")]
mod robot;
#[cfg(feature = "files")]
mod shapes;
#[cfg(feature = "files")]
mod slicer;
#[cfg(feature = "files")]
mod srdf;
#[cfg(feature = "files")]
mod threemf;
#[cfg(feature = "files")]
mod urdf;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

#[cfg(feature = "files")]
use colltrans_mesh::Mesh;
use colltrans_mesh::body::BodyOptions;

use crate::error::ReadError;
pub use crate::plain::plain;
#[cfg(feature = "files")]
use crate::plain::plain_words;
use colltrans_assembly::Assembly;
use colltrans_assembly::AssemblyError;
pub use drafts::Split;
use drafts::{Draft, Placed, assembled};
pub use files::{FileFault, Files};
use files::{Nothing, Source};

/// Which geometry of a URDF link is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Geometry {
    /// What collision checkers use.
    #[default]
    Collision,
    /// What is drawn.
    Visual,
}

/// What readers need to know beside the file.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
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
    /// Whether surfaces that have to be mended are refused.
    pub as_is: bool,
    /// Which parts are made of a file with several bodies.
    pub split: Split,
    /// Whether a source may name files that lie neither in its own folder nor in one of `packages`,
    /// by absolute paths, `..` or links.
    pub allow_outside: bool,
    /// Factors of parts whose files are in another unit, about the origin, by name; `bolt*` is all whose names begin with
    /// `bolt`.
    pub scales: BTreeMap<String, f64>,
    /// Links of a robot whose meshes are taken as their convex hulls, by name; `*` is all links.
    pub hulls: Vec<String>,
}

impl ReadOptions {
    /// The same with other [`hulls`](Self::hulls).
    #[must_use]
    pub fn with_hulls(self, hulls: Vec<String>) -> Self {
        Self { hulls, ..self }
    }

    /// Checks whether the meshes of a link are taken as their convex hulls.
    #[cfg(feature = "files")]
    fn takes_hull(&self, link: &str) -> bool {
        self.hulls.iter().any(|name| name == link || name == "*")
    }

    /// The same with other [`scales`](Self::scales).
    #[must_use]
    pub fn with_scales(self, scales: BTreeMap<String, f64>) -> Self {
        Self { scales, ..self }
    }

    /// The same with another [`packages`](Self::packages).
    #[must_use]
    pub fn with_packages(self, packages: Vec<PathBuf>) -> Self {
        Self { packages, ..self }
    }

    /// The same with another [`skip_missing`](Self::skip_missing).
    #[must_use]
    pub fn with_skip_missing(self, skip_missing: bool) -> Self {
        Self { skip_missing, ..self }
    }

    /// The same with another [`geometry`](Self::geometry).
    #[must_use]
    pub fn with_geometry(self, geometry: Geometry) -> Self {
        Self { geometry, ..self }
    }

    /// The same with another [`joints`](Self::joints).
    #[must_use]
    pub fn with_joints(self, joints: BTreeMap<String, f64>) -> Self {
        Self { joints, ..self }
    }

    /// The same with another [`as_is`](Self::as_is).
    #[must_use]
    pub fn with_as_is(self, as_is: bool) -> Self {
        Self { as_is, ..self }
    }

    /// The same with another [`split`](Self::split).
    #[must_use]
    pub fn with_split(self, split: Split) -> Self {
        Self { split, ..self }
    }

    /// How bodies are made.
    fn body(&self) -> BodyOptions {
        BodyOptions::default().with_as_is(self.as_is)
    }

    /// The same with another [`allow_outside`](Self::allow_outside).
    #[must_use]
    pub fn with_allow_outside(self, allow_outside: bool) -> Self {
        Self { allow_outside, ..self }
    }
}

/// Reads an assembly: a folder, a manifest (`.toml`, `.json`), `.urdf`, `.glb`, `.gltf`, `.3mf`, or a
/// single mesh. Only ordinary files are read, never a device, a pipe or an address.
///
/// # Errors
/// What cannot be read, with the file and the place; a source that has no parts.
#[cfg(feature = "files")]
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Assembly, ReadError> {
    let path = path.as_ref();
    let folders = files::Folders::of(path, options);
    if path.is_dir() {
        return folder::read(Source::new(path, options, &folders));
    }
    let known = is_known(path);
    match path.metadata() {
        Err(e) => Err(io(path)(e)),
        Ok(_) if !known => Err(unknown(path)),
        // Whoever gives a link to the source means it.
        Ok(_) => {
            let files = files::Given { path, files: &folders };
            read_from(path, &files, options)
        }
    }
}

#[cfg(feature = "files")]
fn is_known(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    let extension = extension.to_ascii_lowercase();
    let sources = ["toml", "json", "urdf", "glb", "gltf", "3mf"];
    sources.contains(&extension.as_str()) || colltrans_mesh::Format::of_path(path).is_ok()
}

/// [`read`], from files that lie wherever `files` has them; `path` is the source, and tells what it is.
///
/// # Errors
/// As [`read`].
#[cfg(feature = "files")]
pub fn read_from(
    path: impl AsRef<Path>,
    files: &dyn Files,
    options: &ReadOptions,
) -> Result<Assembly, ReadError> {
    let path = path.as_ref();
    let source = Source::new(path, options, files);
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "toml" | "json" => manifest::read(source),
        "urdf" => urdf::read(source),
        "glb" | "gltf" => {
            let bytes = source.own()?;
            gltf::read(source, &bytes)
        }
        "3mf" => threemf::read(source),
        _ if is_known(path) => folder::read_file(source),
        _ => Err(unknown(path)),
    }
}

#[cfg(feature = "files")]
fn unknown(path: &Path) -> ReadError {
    let extension = path.extension().unwrap_or_default();
    let is_step = ["step", "stp"].iter().any(|known| extension.eq_ignore_ascii_case(known));
    let path = path.into();
    if is_step { ReadError::Step { path } } else { ReadError::UnknownSource { path } }
}

/// Reads a robot that moves, from a URDF file: links with their bodies, and joints.
///
/// # Errors
/// What cannot be read, with the file and the place; joints that have not one value; a robot without geometry.
#[cfg(feature = "files")]
pub fn robot(path: impl AsRef<Path>, options: &ReadOptions) -> Result<crate::Robot, ReadError> {
    let path = path.as_ref();
    let folders = files::Folders::of(path, options);
    robot::read(Source::new(path, options, &files::Given { path, files: &folders }))
}

/// Reads which links are not held against each other, from an SRDF file.
///
/// # Errors
/// What cannot be read, with the file and the place.
#[cfg(feature = "files")]
pub fn disabled(path: impl AsRef<Path>) -> Result<Vec<[String; 2]>, ReadError> {
    let (path, options) = (path.as_ref(), ReadOptions::default());
    let folders = files::Folders::of(path, &options);
    srdf::read(&Source::new(path, &options, &files::Given { path, files: &folders }))
}

/// Reads a GLB file that is in memory, of which nothing lies elsewhere.
///
/// # Errors
/// What cannot be read, with the place; a file without parts.
pub fn glb(name: impl AsRef<Path>, bytes: &[u8]) -> Result<Assembly, ReadError> {
    glb_with(name, bytes, &ReadOptions::default())
}

/// [`glb`] with options.
///
/// # Errors
/// As [`glb`].
pub fn glb_with(
    name: impl AsRef<Path>,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<Assembly, ReadError> {
    gltf::read(Source::new(name.as_ref(), options, &Nothing), bytes)
}

#[cfg(feature = "files")]
fn io(path: &Path) -> impl Fn(std::io::Error) -> ReadError + '_ {
    move |source| ReadError::Io { path: path.into(), source }
}

fn in_file(path: &Path) -> impl Fn(AssemblyError) -> ReadError + '_ {
    move |source| ReadError::Assembly { path: path.into(), source }
}

fn contents(path: &Path, place: impl Into<String>, reason: impl std::fmt::Display) -> ReadError {
    ReadError::Contents { path: path.into(), place: place.into(), reason: reason.to_string() }
}

/// The mesh of a file's bytes.
#[cfg(feature = "files")]
fn mesh(path: &Path, bytes: Vec<u8>) -> Result<Mesh, ReadError> {
    let format = colltrans_mesh::Format::of_path(path)?;
    Ok(colltrans_mesh::parse(format, bytes, path)?)
}

/// Nodes, components, links or parts of a source, each as often as it is placed, at most.
pub const MOST_PLACED: usize = 1 << 16;
/// Facets that are placed beyond one for each byte of the files, at most: shapes that are placed
/// again and again.
pub const MOST_REPEATED: usize = 1 << 23;

/// What a source places, counted before it is built: a few lines can place a shape as often as they
/// like.
#[derive(Default)]
struct Budget {
    bytes: usize,
    #[cfg(feature = "files")]
    files: HashSet<PathBuf>,
    placed: usize,
    facets: usize,
}

impl Budget {
    fn of(bytes: usize) -> Self {
        Self { bytes, ..Self::default() }
    }

    /// A file that was read, whose bytes count once.
    #[cfg(feature = "files")]
    fn read(&mut self, file: &Path, bytes: usize) {
        if self.files.insert(file.into()) {
            self.bytes += bytes;
        }
    }

    fn place(&mut self) -> Result<(), String> {
        self.placed += 1;
        if self.placed > MOST_PLACED {
            return Err(format!("more than {MOST_PLACED} things are placed, one in another"));
        }
        Ok(())
    }

    fn facets(&mut self, count: usize) -> Result<(), String> {
        self.facets += count;
        if self.facets > self.bytes + MOST_REPEATED {
            return Err(format!(
                "{} facets are placed, of files of {} bytes: no more than {MOST_REPEATED} may be \
                 repeated",
                self.facets, self.bytes
            ));
        }
        Ok(())
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
    /// Names that are given to others.
    fn take<'a>(&mut self, names: impl Iterator<Item = &'a String>) {
        self.taken.extend(names.cloned());
    }

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
