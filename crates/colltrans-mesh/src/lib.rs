//! Mesh files in double precision: STL, OBJ, PLY and OFF.
//!
//! The data's way: a file's bytes -> one reader per format (`stl`, `obj`, `ply`, `off`) ->
//! [`Mesh`]. A reader either returns every vertex and face of the file, in the file's order, or an
//! [`Error`] that says what is wrong and where; it never allocates more than a small multiple of
//! the file's size, whatever the file's header promises.
//!
//! Every index in [`Mesh::faces`] is smaller than the number of vertices, but nothing else is
//! promised: coordinates may be NaN, faces may be degenerate, the surface may be open.

mod error;
mod mesh;
mod obj;
mod off;
mod ply;
mod stl;
mod write;

use std::path::Path;

pub use error::{Error, Place};
pub use mesh::Mesh;
pub use write::{to_obj, to_off, to_stl, write};

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
}

impl Format {
    /// The extensions that are understood.
    pub const EXTENSIONS: [&str; 4] = ["stl", "obj", "ply", "off"];

    /// The format that a path's extension names, in upper or lower case.
    ///
    /// # Errors
    /// [`Error::UnknownFormat`] for any other extension, or none.
    pub fn of_path(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "stl" => Ok(Self::Stl),
            "obj" => Ok(Self::Obj),
            "ply" => Ok(Self::Ply),
            "off" => Ok(Self::Off),
            _ => Err(Error::UnknownFormat { path: path.to_owned() }),
        }
    }
}

/// Reads a mesh file of the format that its extension names.
///
/// The vertices of an STL file, which stores each triangle's corners anew, are welded
/// ([`Mesh::weld`]); those of the other formats keep their place in the file.
///
/// # Errors
/// The extension is unknown, the file cannot be read, or its contents are not what the format
/// prescribes.
pub fn read(path: impl AsRef<Path>) -> Result<Mesh, Error> {
    let path = path.as_ref();
    let format = Format::of_path(path)?;
    let bytes =
        std::fs::read(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    parse(format, bytes, path)
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
///
/// let cut = square[..28].into();
/// let error = parse(Format::Off, cut, Path::new("square.off")).unwrap_err();
/// assert_eq!(error.to_string(), "square.off: end of file: vertex 3 of 4 is missing");
/// # Ok::<(), colltrans_mesh::Error>(())
/// ```
///
/// # Errors
/// The contents are not what the format prescribes.
pub fn parse(format: Format, bytes: Vec<u8>, path: &Path) -> Result<Mesh, Error> {
    let parsed = match format {
        Format::Stl => stl::parse(bytes),
        Format::Obj => obj::parse(&bytes),
        Format::Ply => ply::parse(&bytes),
        Format::Off => off::parse(&bytes),
    };
    parsed.map_err(|fault| fault.in_file(path))
}
