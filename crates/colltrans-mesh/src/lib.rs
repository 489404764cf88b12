//! Reads mesh files in double precision (STL, OBJ, PLY, OFF and COLLADA) and builds bodies from them.
//!
//! The bytes of a file go through one reader per format (`stl`, `obj`, `ply`, `off`, `dae`) into a [`Mesh`].
//! `merge` merges duplicate vertices along open edges, and [`body`] builds a body of the library.
//!
//! - A reader returns every vertex and face in the order of the file, or an [`Error`] with place and reason.
//! - A reader allocates at most a small multiple of the file's size, regardless of the counts in its header.
//! - `identify` compares the contents with the extension.
//! - Every index in [`Mesh::faces`] is less than the number of vertices. A face has at least three corners, and
//!   consecutive corners differ.
//! - Nothing else is guaranteed: coordinates may be NaN, a face may contain a vertex twice, and the surface may
//!   be open ([`Mesh::open_edges`]).

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
use merge::{PlacePolicy, Precision};
use sniff::{Content, identify};

pub use digits::NumberFormat;
pub use edges::sides;
pub use error::{Error, Place};
pub use mesh::{Groups, Merged, Mesh};
pub use write::{to_obj, to_off, to_stl, write};

/// Compiles and runs the examples of `docs/guide/rust.md` as tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/guide/rust.md")]
pub struct GettingStarted;

/// A format of mesh files, identified by the extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Stereolithography: triangles in single precision, binary or text.
    Stl,
    /// Wavefront: polygons, text.
    Obj,
    /// Stanford polygon format, binary or text.
    Ply,
    /// Geomview's object file format: polygons, text.
    Off,
    /// COLLADA: polygons in a tree of nodes, XML.
    #[cfg(feature = "dae")]
    Dae,
}

/// The only list of formats. A new format is added here, and its reader in [`parse_with`].
impl Format {
    /// All formats, in the order in which messages list them.
    pub const ALL: &[Self] = &[
        Self::Stl,
        Self::Obj,
        Self::Ply,
        Self::Off,
        #[cfg(feature = "dae")]
        Self::Dae,
    ];

    /// Returns the extension, in lower case.
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

    /// Returns the name of a file of this format for messages, with its article.
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

    /// Lists the names of all formats with the conjunction `word`, for example `STL, OBJ, PLY, OFF or DAE`.
    pub fn list_names(word: &str) -> String {
        let names: Vec<String> = Self::ALL.iter().map(Self::to_string).collect();
        let (last, others) = names.split_last().map_or(("", &[][..]), |(last, all)| (last, all));
        format!("{} {word} {last}", others.join(", "))
    }

    /// Returns the format with the extension of the path, regardless of case.
    ///
    /// # Errors
    /// [`Error::UnknownFormat`] if the path has another extension, or none.
    pub fn from_path(path: &Path) -> Result<Self, Error> {
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

/// Options of the readers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct ReadOptions {
    /// The distance up to which vertices on open edges are merged, in the unit of the file.
    ///
    /// The value 0 merges equal vertices only. `None` selects a few units in the last place of the largest coordinate,
    /// which depends on the [`NumberFormat`]. For single precision (binary STL, PLY with `float`, text of such
    /// numbers) that is `2^-22` times its magnitude. For text that is rounded to fewer digits than doubles have, it is
    /// two units in the last place that is printed. It is at least `2^-48` times the magnitude, its value for doubles.
    pub merge_tolerance: Option<f64>,
}

impl ReadOptions {
    /// Sets [`Self::merge_tolerance`].
    #[must_use]
    pub const fn with_merge_tolerance(self, tolerance: Option<f64>) -> Self {
        Self { merge_tolerance: tolerance }
    }
}

/// Reads a mesh file. Its extension selects the format.
///
/// The vertices of an STL file are welded ([`Mesh::weld`]), because it stores the corners of each triangle
/// separately. In the other formats they keep their positions in the list. On open surfaces, vertices that
/// differ only by rounding are merged ([`Mesh::merged`]).
///
/// # Errors
/// [`Error`] if the extension is unknown, the file cannot be read, or its contents violate the format.
pub fn read(path: impl AsRef<Path>) -> Result<Mesh, Error> {
    read_with(path, ReadOptions::default())
}

/// Reads a mesh file like [`read`], with options.
///
/// # Errors
/// The errors of [`read`], and [`Error::MergeTolerance`] if the tolerance is negative or not finite.
pub fn read_with(path: impl AsRef<Path>, options: ReadOptions) -> Result<Mesh, Error> {
    let path = path.as_ref();
    let format = Format::from_path(path)?;
    let bytes =
        file::bytes(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    parse_with(format, bytes, path, options)
}

/// Reads a mesh from the bytes of a file. The `path` is used for errors only.
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
/// let reason = "contains an OFF file, but its extension stands for PLY; rename or convert the file";
/// assert_eq!(error.to_string(), format!("square.ply: {reason}"));
/// # Ok::<(), colltrans_mesh::Error>(())
/// ```
///
/// # Errors
/// [`Error`] if the contents violate the format.
pub fn parse(format: Format, bytes: Vec<u8>, path: &Path) -> Result<Mesh, Error> {
    parse_with(format, bytes, path, ReadOptions::default())
}

/// Reads a mesh from bytes like [`parse`], with options.
///
/// # Errors
/// The errors of [`parse`], and [`Error::MergeTolerance`] if the tolerance is negative or not finite.
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
    if let Some(content) = identify(&bytes).filter(|content| *content != Content::Mesh(format)) {
        let found = content.description(&bytes);
        return Err(Error::OtherContent { path: path.to_owned(), format, found });
    }
    let parsed = match format {
        Format::Stl => stl::parse_stl(bytes),
        Format::Obj => obj::parse_obj(&bytes).map(|mesh| (mesh, Precision::TEXT)),
        Format::Ply => ply::parse_ply(&bytes),
        Format::Off => off::parse_off(&bytes).map(|mesh| (mesh, Precision::TEXT)),
        #[cfg(feature = "dae")]
        Format::Dae => dae::parse_dae(&bytes).map(|mesh| (mesh, Precision::DOUBLE)),
    };
    let (mut mesh, precision) = parsed.map_err(|fault| fault.in_file(path))?;
    let places = if format == Format::Stl { PlacePolicy::Closed } else { PlacePolicy::Kept };
    mesh.merge_open_edges(options.merge_tolerance, precision, places);
    Ok(mesh)
}

/// Compiles and runs the example of the README as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
