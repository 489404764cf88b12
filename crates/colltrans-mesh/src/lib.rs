//! Mesh files in double precision: STL, OBJ, PLY, OFF and COLLADA, and the bodies made of them.
//!
//! Data flow: a file's bytes -> one reader per format (`stl`, `obj`, `ply`, `off`, `dae`) ->
//! [`Mesh`] -> twins along open edges merged (`merge`) -> a body of the library ([`body`]). A reader either
//! returns every vertex and face of the file, in the file's order, or an [`Error`] that says what is wrong and where; it
//! never allocates more than a small multiple of the file's size, whatever the file's header
//! promises. What the extension says is held against what the file holds (`sniff`).
//!
//! Every index in [`Mesh::faces`] is smaller than the number of vertices, every face has at least
//! three corners, none of them followed by itself, and nothing else is promised: coordinates may
//! be NaN, a face may pass twice through a vertex, the surface may be open ([`Mesh::open_edges`]).

pub mod body;
#[cfg(feature = "dae")]
mod dae;
mod digits;
mod edges;
mod error;
pub mod file;
mod merge;
mod mesh;
mod obj;
mod off;
pub mod plain;
mod ply;
mod sets;
mod sniff;
mod split;
mod stl;
mod text;
pub mod words;
mod write;
#[cfg(feature = "dae")]
pub mod xml;

use std::fmt;
use std::path::Path;

use error::Fault;
use merge::{Places, Precision};
use sniff::{Content, sniff};

pub use digits::NumberFormat;
pub use edges::sides;
pub use error::{Error, Place};
pub use mesh::{Groups, Merged, Mesh};
pub use write::{to_obj, to_off, to_stl, write};

/// The examples of `docs/guide/rust.md`, compiled and run as tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/guide/rust.md")]
pub struct GettingStarted;

/// A format of mesh files, told by the file's extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Stereolithography: triangles in single precision, binary or text.
    Stl,
    /// Wavefront: polygons, text.
    Obj,
    /// Stanford polygons, binary or text.
    Ply,
    /// Geomview's object file format: polygons, text.
    Off,
    /// COLLADA: polygons in a tree of nodes, XML.
    #[cfg(feature = "dae")]
    Dae,
}

/// The one list of formats: what has to be said of another one is said here, and its reader named in
/// [`parse_with`].
impl Format {
    /// All of them, in the order in which texts name them.
    pub const ALL: &[Self] = &[
        Self::Stl,
        Self::Obj,
        Self::Ply,
        Self::Off,
        #[cfg(feature = "dae")]
        Self::Dae,
    ];

    /// The extension of its files, in lower case.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Stl => "stl",
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Off => "off",
            #[cfg(feature = "dae")]
            Self::Dae => "dae",
        }
    }

    /// A file of the format, in words.
    const fn file(self) -> &'static str {
        match self {
            Self::Stl => "an STL file",
            Self::Obj => "an OBJ file",
            Self::Ply => "a PLY file",
            Self::Off => "an OFF file",
            #[cfg(feature = "dae")]
            Self::Dae => "a COLLADA file",
        }
    }

    /// The names of all formats: `STL, OBJ, PLY, OFF or DAE`, for the word `or`.
    pub fn names(word: &str) -> String {
        let names: Vec<String> = Self::ALL.iter().map(Self::to_string).collect();
        let (last, others) = names.split_last().map_or(("", &[][..]), |(last, all)| (last, all));
        format!("{} {word} {last}", others.join(", "))
    }

    /// The format that a path's extension names, in upper or lower case.
    ///
    /// # Errors
    /// [`Error::UnknownFormat`] for any other extension, or none.
    pub fn of_path(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        let named = |format: &Self| extension.eq_ignore_ascii_case(format.extension());
        Self::ALL
            .iter()
            .copied()
            .find(named)
            .ok_or_else(|| Error::UnknownFormat { path: path.to_owned() })
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.extension().to_ascii_uppercase())
    }
}

/// What a reader may choose.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Up to which distance vertices on open edges are merged, in the file's unit.
    ///
    /// 0 merges equal ones only. `None` is a few units in the last place of the largest
    /// coordinate ([`NumberFormat`]): `2^-22` times its magnitude where coordinates are in single precision
    /// (binary STL, PLY with `float`, text of such numbers), two units in the last place that a text prints, else `2^-48` times.
    pub merge_tolerance: Option<f64>,
}

impl ReadOptions {
    /// These options with another [`Self::merge_tolerance`].
    #[must_use]
    pub const fn with_merge_tolerance(self, tolerance: Option<f64>) -> Self {
        Self { merge_tolerance: tolerance }
    }
}

/// Reads a mesh file of the format that its extension names.
///
/// The vertices of an STL file, which stores each triangle's corners anew, are welded
/// ([`Mesh::weld`]); those of the other formats keep their place in the file. Where the surface
/// is open, vertices that rounding has kept apart are merged ([`Mesh::merged`] says which way).
///
/// # Errors
/// The extension is unknown, the file cannot be read, holds something else, or its contents are
/// not what the format prescribes.
pub fn read(path: impl AsRef<Path>) -> Result<Mesh, Error> {
    read_with(path, ReadOptions::default())
}

/// [`read`] with options.
///
/// # Errors
/// As [`read`], and a tolerance that is negative or not finite.
pub fn read_with(path: impl AsRef<Path>, options: ReadOptions) -> Result<Mesh, Error> {
    let path = path.as_ref();
    let format = Format::of_path(path)?;
    let bytes =
        file::bytes(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    parse_with(format, bytes, path, options)
}

/// Reads a mesh from the bytes of a file; `path` is only named in errors.
///
/// ```
/// use std::path::Path;
/// use colltrans_mesh::{Format, parse};
///
/// let square = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
/// let mesh = parse(Format::Off, square.into(), Path::new("square.off"))?;
/// assert_eq!(mesh.faces, [[0, 1, 2, 3]]);
/// assert_eq!(mesh.open_edges().len(), 4);
///
/// let cut = square[..28].into();
/// let error = parse(Format::Off, cut, Path::new("square.off")).unwrap_err();
/// assert_eq!(error.to_string(), "square.off: end of file: vertex 3 of 4 is missing");
///
/// let error = parse(Format::Ply, square.into(), Path::new("square.ply")).unwrap_err();
/// assert_eq!(error.to_string(), "square.ply: holds an OFF file, not PLY as its name says");
/// # Ok::<(), colltrans_mesh::Error>(())
/// ```
///
/// # Errors
/// The contents are not what the format prescribes.
pub fn parse(format: Format, bytes: Vec<u8>, path: &Path) -> Result<Mesh, Error> {
    parse_with(format, bytes, path, ReadOptions::default())
}

/// [`parse`] with options.
///
/// # Errors
/// As [`parse`], and a tolerance that is negative or not finite.
pub fn parse_with(
    format: Format,
    bytes: Vec<u8>,
    path: &Path,
    options: ReadOptions,
) -> Result<Mesh, Error> {
    if let Some(tolerance) = options.merge_tolerance.filter(|t| !t.is_finite() || *t < 0.0) {
        return Err(Error::MergeTolerance { path: path.to_owned(), tolerance });
    }
    if bytes.is_empty() {
        return Err(Fault::new(Place::End, "the file is empty").in_file(path));
    }
    if let Some(content) = sniff(&bytes).filter(|content| *content != Content::Mesh(format)) {
        let found = content.name(&bytes);
        return Err(Error::OtherContent { path: path.to_owned(), format, found });
    }
    let parsed = match format {
        Format::Stl => stl::parse(bytes),
        Format::Obj => obj::parse(&bytes).map(|mesh| (mesh, Precision::TEXT)),
        Format::Ply => ply::parse(&bytes),
        Format::Off => off::parse(&bytes).map(|mesh| (mesh, Precision::TEXT)),
        #[cfg(feature = "dae")]
        Format::Dae => dae::parse(&bytes).map(|mesh| (mesh, Precision::DOUBLE)),
    };
    let (mut mesh, precision) = parsed.map_err(|fault| fault.in_file(path))?;
    let places = if format == Format::Stl { Places::Closed } else { Places::Kept };
    mesh.close(options.merge_tolerance, precision, places);
    Ok(mesh)
}
