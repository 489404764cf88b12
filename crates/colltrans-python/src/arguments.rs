//! Messages for confused arguments: the call that accepts a given object.
//!
//! Invariant: this module uses no class of the extension, so that each class can use it.

use pyo3::prelude::*;
use pyo3::types::{PySequence, PyString};

use crate::errors::input_error;

/// Returns a hint: the call that builds a body from an argument that is not a body.
pub(crate) fn loader_hint(given: &Bound<'_, PyAny>) -> PyResult<&'static str> {
    Ok(if mesh_parts(given)?.is_some() {
        "Solid(mesh) or ConvexPolyhedron(mesh) makes a body of a mesh"
    } else if given.is_instance_of::<PyString>() || given.hasattr("__fspath__")? {
        "ConvexPolyhedron.read(path) and Solid.read(path) read the body of a file"
    } else if given.hasattr("__array__")? || given.is_instance_of::<PySequence>() {
        "ConvexPolyhedron(points) makes the convex hull of points"
    } else {
        "ConvexPolyhedron(points) makes a body, read(path) and Solid.read(path) read one"
    })
}

/// Rejects a file name where `class` expects an array of points or a mesh.
pub(crate) fn refuse_file(given: &Bound<'_, PyAny>, name: &str, class: &str) -> PyResult<()> {
    if given.is_instance_of::<PyString>() || given.hasattr("__fspath__")? {
        let call = format_args!("call {class}.read(path) for the body of a file");
        return Err(input_error(
            name,
            format_args!("the text {} is not an array: {call}", given.str()?.repr()?),
        ));
    }
    Ok(())
}

/// Returns the vertices and the faces of a mesh; `None` for an object that is not a mesh.
///
/// A mesh has the attributes `vertices` and `faces`, as trimesh names them, or `vertices` and `triangles`, as open3d
/// does.
pub(crate) fn mesh_parts<'py>(
    given: &Bound<'py, PyAny>,
) -> PyResult<Option<[Bound<'py, PyAny>; 2]>> {
    let Some(vertices) = given.getattr_opt("vertices")? else { return Ok(None) };
    let faces = match given.getattr_opt("faces")? {
        Some(faces) => Some(faces),
        None => given.getattr_opt("triangles")?,
    };
    Ok(faces.map(|faces| [vertices, faces]))
}
