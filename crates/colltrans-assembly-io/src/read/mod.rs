//! Reads assemblies from a folder of meshes, a single mesh, a manifest, URDF, glTF or 3MF.
//!
//! Each reader returns parts in one world frame and one unit. The unit is that of the file: metres for URDF and
//! glTF, the named unit for 3MF and manifests. A glTF file that was converted from STEP may name the unit of the
//! STEP file, which is then used. Meshes have the unit of the first file that has one; if none has, their
//! coordinates are used unchanged.

mod drafts;
mod files;
#[cfg(feature = "files")]
mod folder;
mod gltf;
#[cfg(feature = "files")]
mod links;
#[cfg(feature = "files")]
mod manifest;
#[cfg(feature = "files")]
mod mjcf;
#[cfg(feature = "files")]
mod robot;
#[cfg(feature = "files")]
mod sdf;
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
pub use crate::plain::json_error_reason;
#[cfg(feature = "files")]
use crate::plain::reword_parser_message;
use colltrans_assembly::Assembly;
use colltrans_assembly::AssemblyError;
pub use drafts::Split;
use drafts::{Draft, Placed, assemble};
pub use files::{FileError, Files};
use files::{NoFiles, Source};

/// The geometry of a URDF link to read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Geometry {
    /// The geometry for collision checks.
    #[default]
    Collision,
    /// The geometry for display.
    Visual,
}

/// Options of the readers.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Package roots, in which `package://name/rest` is searched: as `name/rest`, then as `rest`, then with
    /// fewer leading folders. Meshes of URDF that do not exist relative to the source are searched likewise.
    /// Sources may refer to files in these folders.
    pub packages: Vec<PathBuf>,
    /// Whether missing mesh files are skipped, with a note. Otherwise they are an error.
    pub skip_missing: bool,
    /// The geometry of URDF links to read.
    pub geometry: Geometry,
    /// Positions of joints by name, in radians or metres. The position of other joints is 0, unless they mimic
    /// a joint.
    pub joints: BTreeMap<String, f64>,
    /// Whether surfaces that need repair are rejected.
    pub as_is: bool,
    /// The rule by which files with several bodies are split into parts.
    pub split: Split,
    /// Whether a source may refer to files outside of its own folder and of `packages`, by absolute paths, `..`
    /// or symbolic links.
    pub allow_outside: bool,
    /// Scale factors of parts about the origin, by name, for files in another unit. The name `bolt*` matches
    /// all names that begin with `bolt`.
    pub scales: BTreeMap<String, f64>,
    /// Names of the links of a robot whose meshes are replaced by their convex hulls; `*` matches all links.
    pub hulls: Vec<String>,
}

impl ReadOptions {
    /// Sets [`hulls`](Self::hulls).
    #[must_use]
    pub fn with_hulls(self, hulls: Vec<String>) -> Self {
        Self { hulls, ..self }
    }

    /// Checks whether the meshes of a link are replaced by their convex hulls.
    #[cfg(feature = "files")]
    fn takes_hull(&self, link: &str) -> bool {
        self.hulls.iter().any(|name| name == link || name == "*")
    }

    /// Sets [`scales`](Self::scales).
    #[must_use]
    pub fn with_scales(self, scales: BTreeMap<String, f64>) -> Self {
        Self { scales, ..self }
    }

    /// Sets [`packages`](Self::packages).
    #[must_use]
    pub fn with_packages(self, packages: Vec<PathBuf>) -> Self {
        Self { packages, ..self }
    }

    /// Sets [`skip_missing`](Self::skip_missing).
    #[must_use]
    pub fn with_skip_missing(self, skip_missing: bool) -> Self {
        Self { skip_missing, ..self }
    }

    /// Sets [`geometry`](Self::geometry).
    #[must_use]
    pub fn with_geometry(self, geometry: Geometry) -> Self {
        Self { geometry, ..self }
    }

    /// Sets [`joints`](Self::joints).
    #[must_use]
    pub fn with_joints(self, joints: BTreeMap<String, f64>) -> Self {
        Self { joints, ..self }
    }

    /// Sets [`as_is`](Self::as_is).
    #[must_use]
    pub fn with_as_is(self, as_is: bool) -> Self {
        Self { as_is, ..self }
    }

    /// Sets [`split`](Self::split).
    #[must_use]
    pub fn with_split(self, split: Split) -> Self {
        Self { split, ..self }
    }

    /// Returns the options for building bodies from meshes.
    fn body_options(&self) -> BodyOptions {
        BodyOptions::default().with_as_is(self.as_is)
    }

    /// Sets [`allow_outside`](Self::allow_outside).
    #[must_use]
    pub fn with_allow_outside(self, allow_outside: bool) -> Self {
        Self { allow_outside, ..self }
    }
}

/// Reads an assembly from a folder, a manifest (`.toml`, `.json`), `.urdf`, `.glb`, `.gltf`, `.3mf`, or a
/// single mesh. Reads regular files only, never a device, a pipe or a network address.
///
/// # Errors
/// [`ReadError`] if a file cannot be read, with the file and the place, or if the source has no parts.
#[cfg(feature = "files")]
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Assembly, ReadError> {
    let path = path.as_ref();
    let folders = files::Folders::for_source(path, options);
    if path.is_dir() {
        return folder::read_folder(Source::new(path, options, &folders));
    }
    let known = is_known(path);
    match path.metadata() {
        Err(e) => Err(io_error(path)(e)),
        Ok(_) if !known => Err(unknown_source(path)),
        // The source itself may be a symbolic link.
        Ok(_) => {
            let files = files::SourceAndFiles { path, files: &folders };
            read_from(path, &files, options)
        }
    }
}

#[cfg(feature = "files")]
/// Checks whether the extension is that of a supported source.
fn is_known(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    let extension = extension.to_ascii_lowercase();
    let sources = ["toml", "json", "urdf", "glb", "gltf", "3mf"];
    sources.contains(&extension.as_str()) || colltrans_mesh::Format::from_path(path).is_ok()
}

/// Reads an assembly like [`read`], from a provider of files. The extension of `path`, the source, selects the
/// reader. The source cannot be a folder.
///
/// # Errors
/// The errors of [`read`].
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
        "toml" | "json" => manifest::read_manifest(source),
        "urdf" => urdf::read_urdf(source),
        "glb" | "gltf" => {
            let bytes = source.own_bytes()?;
            gltf::read_gltf(source, &bytes)
        }
        "3mf" => threemf::read_package(source),
        _ if is_known(path) => folder::read_file(source),
        _ => Err(unknown_source(path)),
    }
}

#[cfg(feature = "files")]
/// Builds the error for an unsupported source.
fn unknown_source(path: &Path) -> ReadError {
    let extension = path.extension().unwrap_or_default();
    let is_step = ["step", "stp"].iter().any(|known| extension.eq_ignore_ascii_case(known));
    let path = path.into();
    if is_step { ReadError::Step { path } } else { ReadError::UnknownSource { path } }
}

/// Reads a robot from a URDF, SDF or MJCF file: links with their bodies, and joints. The root element selects the format.
///
/// The links of an MJCF file are its bodies and the `world`. Its geoms are spheres, capsules, boxes and cylinders. Links
/// and joints of nested SDF models, and of the models of a world, are named `model::link`.
///
/// # Errors
/// [`ReadError`] if a file cannot be read, with the file and the place, if a joint has not exactly one degree
/// of freedom (except fixed joints), if a geom has another shape, or if the robot has no geometry.
#[cfg(feature = "files")]
pub fn read_robot(
    path: impl AsRef<Path>,
    options: &ReadOptions,
) -> Result<crate::Robot, ReadError> {
    let path = path.as_ref();
    let folders = files::Folders::for_source(path, options);
    robot::read_robot(Source::new(path, options, &files::SourceAndFiles { path, files: &folders }))
}

/// Reads the pairs of links that an SRDF file excludes from collision checks.
///
/// # Errors
/// [`ReadError`] if the file cannot be read, with the file and the place.
#[cfg(feature = "files")]
pub fn read_disabled_pairs(path: impl AsRef<Path>) -> Result<Vec<[String; 2]>, ReadError> {
    let (path, options) = (path.as_ref(), ReadOptions::default());
    let folders = files::Folders::for_source(path, &options);
    srdf::read_disabled_pairs(&Source::new(
        path,
        &options,
        &files::SourceAndFiles { path, files: &folders },
    ))
}

/// Reads a GLB file from memory. The file must not refer to other files.
///
/// # Errors
/// [`ReadError`] if the contents are invalid, with the place, or if the file has no parts.
pub fn glb(name: impl AsRef<Path>, bytes: &[u8]) -> Result<Assembly, ReadError> {
    glb_with(name, bytes, &ReadOptions::default())
}

/// Reads a GLB file like [`glb`], with options.
///
/// # Errors
/// The errors of [`glb`].
pub fn glb_with(
    name: impl AsRef<Path>,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<Assembly, ReadError> {
    gltf::read_gltf(Source::new(name.as_ref(), options, &NoFiles), bytes)
}

#[cfg(feature = "files")]
/// Returns a function that adds the path to an error of the operating system.
fn io_error(path: &Path) -> impl Fn(std::io::Error) -> ReadError + '_ {
    move |source| ReadError::Io { path: path.into(), source }
}

/// Returns a function that adds the path to an error of an assembly.
fn assembly_error(path: &Path) -> impl Fn(AssemblyError) -> ReadError + '_ {
    move |source| ReadError::Assembly { path: path.into(), source }
}

/// Builds an error about the contents of a file.
fn contents_error(
    path: &Path,
    place: impl Into<String>,
    reason: impl std::fmt::Display,
) -> ReadError {
    ReadError::Contents { path: path.into(), place: place.into(), reason: reason.to_string() }
}

/// Parses a mesh file. Its extension selects the format.
#[cfg(feature = "files")]
fn parse_mesh(path: &Path, bytes: Vec<u8>) -> Result<Mesh, ReadError> {
    let format = colltrans_mesh::Format::from_path(path)?;
    Ok(colltrans_mesh::parse(format, bytes, path)?)
}

/// Maximum number of nodes, components, links or parts of a source, each counted as often as it is placed.
pub const MAX_PLACED: usize = 1 << 16;
/// Maximum number of placed facets beyond one per byte of the files. If a mesh has more vertices than facets, its
/// vertices are counted instead. The limit bounds sources that place the same shape very often.
pub const MAX_REPEATED: usize = 1 << 23;

/// Counts what a source places before it is built, because a few lines can place a shape arbitrarily often.
#[derive(Default)]
struct Budget {
    bytes: usize,
    #[cfg(feature = "files")]
    files: HashSet<PathBuf>,
    placed: usize,
    facets: usize,
}

impl Budget {
    /// Builds the budget of a source with this number of bytes.
    fn with_bytes(bytes: usize) -> Self {
        Self { bytes, ..Self::default() }
    }

    /// Adds the bytes of a file that was read. Each file counts once.
    #[cfg(feature = "files")]
    fn count_file(&mut self, file: &Path, bytes: usize) {
        if self.files.insert(file.into()) {
            self.bytes += bytes;
        }
    }

    /// Counts a placed node, component, link or part.
    fn count_placed(&mut self) -> Result<(), String> {
        self.placed += 1;
        if self.placed > MAX_PLACED {
            return Err(format!(
                "more than {MAX_PLACED} nodes, components or parts are placed; split the source into smaller ones"
            ));
        }
        Ok(())
    }

    /// Counts placed facets.
    fn count_facets(&mut self, count: usize) -> Result<(), String> {
        self.facets += count;
        if self.facets > self.bytes + MAX_REPEATED {
            return Err(format!(
                "{} facets are placed from files of {} bytes; accepted: one per byte and {MAX_REPEATED} \
                 more",
                self.facets, self.bytes
            ));
        }
        Ok(())
    }
}

/// Returns the name of a file without its extension.
#[cfg(feature = "files")]
fn file_stem(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// The names in use. A name that a file uses again gets a number, from 2 on.
#[derive(Default)]
struct Names {
    taken: HashSet<String>,
    /// The next number of a name that is in use.
    next: HashMap<String, usize>,
}

impl Names {
    /// Reserves the names of other parts.
    fn reserve<'a>(&mut self, names: impl Iterator<Item = &'a String>) {
        self.taken.extend(names.cloned());
    }

    /// Returns the name, with a number appended if it is in use.
    fn unique_name(&mut self, name: &str) -> String {
        let number = self.next.entry(name.to_owned()).or_insert(2);
        let mut chosen = name.to_owned();
        while !self.taken.insert(chosen.clone()) {
            chosen = format!("{name}_{number}");
            *number += 1;
        }
        chosen
    }
}
