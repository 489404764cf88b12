//! Messages for confused arguments: the call that accepts a given object.
//!
//! Invariant: this module uses no class of the extension, so that each class can use it.

use pyo3::prelude::*;
use pyo3::types::{PySequence, PyString};

use crate::errors::input_error;

/// Returns a hint: the call that builds a body from an argument that is not a body.
pub(crate) fn loader_hint(given: &Bound<'_, PyAny>) -> PyResult<&'static str> {
    Ok(if given.hasattr("vertices")? && given.hasattr("faces")? {
        "ConvexPolyhedron.from_trimesh(mesh) or Solid.from_trimesh(mesh) makes a body of a mesh"
    } else if given.is_instance_of::<PyString>() || given.hasattr("__fspath__")? {
        "ConvexPolyhedron.read(path) and Solid.read(path) read the body of a file"
    } else if given.hasattr("__array__")? || given.is_instance_of::<PySequence>() {
        "ConvexPolyhedron(points) makes the convex hull of points"
    } else {
        "ConvexPolyhedron(points) makes a body, read(path) and Solid.read(path) read one"
    })
}

/// Rejects a mesh object or a file name where `class` expects an array of points.
///
/// `call` is the call that accepts a mesh.
pub(crate) fn refuse_mesh(
    given: &Bound<'_, PyAny>,
    name: &str,
    class: &str,
    call: &str,
) -> PyResult<()> {
    if given.is_instance_of::<PyString>() || given.hasattr("__fspath__")? {
        let call = format_args!("call {class}.read(path) for the body of a file");
        return Err(input_error(
            name,
            format_args!("the text {} is not an array: {call}", given.str()?.repr()?),
        ));
    }
    if !given.hasattr("vertices")? || !given.hasattr("faces")? {
        return Ok(());
    }
    let kind = given.get_type().name()?;
    Err(input_error(name, format_args!("{kind} is a mesh, not an array: call {call}")))
}
