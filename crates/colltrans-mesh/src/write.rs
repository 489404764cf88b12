//! Writes meshes as OBJ and OFF with all digits, and as binary STL in single precision.

use std::fmt::Write as _;
use std::path::Path;

use glam::DVec3;
use stl_io::{Normal, Triangle, Vertex};

use crate::Format;
use crate::error::Error;
use crate::mesh::Mesh;

/// Writes a mesh as STL (binary), OBJ or OFF. The extension of the path selects the format.
///
/// # Errors
/// [`Error`] if the format cannot be written, a face of an STL file is not a triangle, or the file cannot be
/// written.
#[cfg_attr(
    not(feature = "dae"),
    expect(
        clippy::match_wildcard_for_single_variants,
        reason = "without COLLADA the wildcard matches PLY alone, but formats that are only read may be added"
    )
)]
pub fn write(mesh: &Mesh, path: impl AsRef<Path>) -> Result<(), Error> {
    let path = path.as_ref();
    let not_storable = |what: &str| Error::NotStorable { path: path.to_owned(), what: what.into() };
    let bytes = match Format::from_path(path)? {
        Format::Stl => to_stl(mesh).ok_or_else(|| {
            not_storable("STL files have only triangles, fewer than 2^32; triangulate the faces, or write OBJ or OFF")
        })?,
        Format::Obj => to_obj(mesh).into_bytes(),
        Format::Off => to_off(mesh).into_bytes(),
        format => return Err(not_storable(&format!("writing {format} files is not supported; write STL, OBJ or OFF"))),
    };
    std::fs::write(path, bytes).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// Returns a binary STL file; `None` if a face is not a triangle or there are 2^32 faces or more.
///
/// Coordinates are rounded to single precision.
pub fn to_stl(mesh: &Mesh) -> Option<Vec<u8>> {
    u32::try_from(mesh.faces.len()).ok()?;
    let mut triangles = Vec::with_capacity(mesh.faces.len());
    for face in &mesh.faces {
        let face: [u32; 3] = face.as_slice().try_into().ok()?;
        let corners = face.map(|v| mesh.vertices[v as usize]);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        triangles.push(Triangle {
            normal: Normal::new(rounded_to_single(normal)),
            vertices: corners.map(|c| Vertex::new(rounded_to_single(c))),
        });
    }
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles.iter()).ok()?;
    Some(bytes)
}

/// Rounds a vector to single precision.
fn rounded_to_single(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

/// Returns an OBJ file, with as many digits as each coordinate needs.
pub fn to_obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for DVec3 { x, y, z } in &mesh.vertices {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    for face in &mesh.faces {
        text.push('f');
        for vertex in face {
            let _ = write!(text, " {}", u64::from(*vertex) + 1);
        }
        text.push('\n');
    }
    text
}

/// Returns an OFF file, with as many digits as each coordinate needs.
pub fn to_off(mesh: &Mesh) -> String {
    let mut text = format!("OFF\n{} {} 0\n", mesh.vertices.len(), mesh.faces.len());
    for DVec3 { x, y, z } in &mesh.vertices {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    for face in &mesh.faces {
        let _ = write!(text, "{}", face.len());
        for vertex in face {
            let _ = write!(text, " {vertex}");
        }
        text.push('\n');
    }
    text
}
