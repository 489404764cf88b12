//! Arguments that are easily confused: which call takes what was given.
//!
//! Invariant: no class is known here, so that each class can use this.

use pyo3::prelude::*;
use pyo3::types::{PySequence, PyString};

use crate::errors::input;

/// Returns the call that makes a body of an argument which is not one.
pub(crate) fn maker(given: &Bound<'_, PyAny>) -> PyResult<&'static str> {
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

/// Refuses a mesh object, or the name of a file, where `class` expects an array of points.
///
/// `call` is the call that takes a mesh.
pub(crate) fn refuse_mesh(
    given: &Bound<'_, PyAny>,
    name: &str,
    class: &str,
    call: &str,
) -> PyResult<()> {
    if given.is_instance_of::<PyString>() || given.hasattr("__fspath__")? {
        let call = format_args!("call {class}.read(path) for the body of a file");
        return Err(input(
            name,
            format_args!("the text {} is not an array: {call}", given.str()?.repr()?),
        ));
    }
    if !given.hasattr("vertices")? || !given.hasattr("faces")? {
        return Ok(());
    }
    let kind = given.get_type().name()?;
    Err(input(name, format_args!("{kind} is a mesh, not an array: call {call}")))
}
