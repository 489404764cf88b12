//! Converts errors of the library to the exceptions of `colltrans.errors`, with the same messages. For a file whose
//! mesh is rejected, the message also has the calls that would accept it.
//!
//! The exceptions are Python classes, because most have several bases: the base class of the package, and the
//! built-in exception that a caller would expect.

use std::ffi::OsStr;
use std::fmt::Display;

use colltrans::motion::MotionError;
use colltrans::removal::directions::FreeError;
use colltrans::solid::SolidError;
use colltrans::{
    BuildError, CaseError, CertificateError, PoseError, ProofError, ProofFileError, QueryError,
};
use colltrans_assembly::AssemblyError;
use colltrans_assembly_io::ReadError;
use colltrans_mesh::body::{BodyError, BodyKind, LoadError};
use pyo3::prelude::*;
use pyo3::types::PyType;

/// Builds the exception of the class called `class`, with a message.
pub(crate) fn error(class: &str, message: impl Display) -> PyErr {
    Python::attach(|py| match class_called(py, class) {
        Ok(class) => PyErr::from_type(class, message.to_string()),
        Err(error) => error,
    })
}

/// Builds the exception for an invalid argument called `name`.
pub(crate) fn input_error(name: &str, what: impl Display) -> PyErr {
    error("InputError", format_args!("{name}: {what}"))
}

/// Builds the exception for an answer that does not belong to the bodies of its query.
pub(crate) fn other_bodies_error() -> PyErr {
    error("CaseError", "an answer of other bodies")
}

fn class_called<'py>(py: Python<'py>, class: &str) -> PyResult<Bound<'py, PyType>> {
    Ok(py.import("colltrans.errors")?.getattr(class)?.cast_into()?)
}

/// Builds the exception for a failed query. A search that did not converge carries the query for a replay.
pub(crate) fn query_error(what: &QueryError, case: impl FnOnce() -> String) -> PyErr {
    if !matches!(what, QueryError::NotConverged { .. }) {
        return error("QueryError", what);
    }
    let raised = error("NotConvergedError", what);
    Python::attach(|py| match raised.value(py).setattr("case", case()) {
        Ok(()) => raised,
        Err(error) => error,
    })
}

/// An error of the library that becomes an exception.
pub(crate) trait Raised: Display {
    /// Returns the name of the exception class.
    fn class(&self) -> &'static str;
}

macro_rules! raised {
    ($($class:ident: $($error:ty),+;)+) => {$($(
        impl Raised for $error {
            fn class(&self) -> &'static str {
                stringify!($class)
            }
        }
    )+)+};
}

raised! {
    BuildError: BuildError, SolidError, BodyError;
    PoseError: PoseError;
    CertificateError: CertificateError, ProofError;
    CaseError: CaseError, ProofFileError;
    QueryError: QueryError, MotionError;
    AssemblyError: AssemblyError;
}

impl Raised for ReadError {
    fn class(&self) -> &'static str {
        if self.is_missing_file() { "MissingFileError" } else { "AssemblyError" }
    }
}

impl Raised for FreeError {
    fn class(&self) -> &'static str {
        if matches!(self, Self::NotProven(_)) { "CertificateError" } else { "QueryError" }
    }
}

/// A result whose error becomes an exception.
pub(crate) trait OrRaise<T> {
    fn or_raise(self) -> PyResult<T>;
}

impl<T, E: Raised> OrRaise<T> for Result<T, E> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(|what| error(what.class(), what))
    }
}

impl<T> OrRaise<T> for Result<T, LoadError> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(|what| match what {
            LoadError::Mesh(what) if what.is_missing_file() => error("MissingFileError", what),
            LoadError::Mesh(ref mesh @ colltrans_mesh::Error::UnknownFormat { ref path }) => {
                let read = "Assembly.read(path) reads it, as parts";
                if path.extension().is_some_and(is_of_assembly) {
                    error("MeshError", format_args!("{mesh}; {read}"))
                } else {
                    error("MeshError", mesh)
                }
            }
            LoadError::Mesh(what) => error("MeshError", what),
            LoadError::Body { ref source, .. } => match calls_instead(source) {
                Some(calls) => error("BuildError", format_args!("{what}; {calls}")),
                None => error("BuildError", what),
            },
        })
    }
}

/// Checks whether a file with this extension holds an assembly, not one mesh.
fn is_of_assembly(extension: &OsStr) -> bool {
    ["step", "stp", "glb", "gltf", "3mf", "urdf"]
        .into_iter()
        .any(|of| extension.eq_ignore_ascii_case(of))
}

/// Returns the calls that would take a file whose mesh was refused.
fn calls_instead(refused: &BodyError) -> Option<String> {
    let calls = refused.alternatives().iter().map(|take| match take {
        BodyKind::Convex => "read(path) reads a convex body",
        BodyKind::Solid => "Solid.read(path) reads it as it is",
        BodyKind::Hull => "read(path, hull=True) reads its convex hull",
        BodyKind::Open => "Solid.read(path, open=True) reads an open surface",
    });
    Some(calls.collect::<Vec<_>>().join(", ")).filter(|calls| !calls.is_empty())
}

/// Warns that a rotation with few digits was replaced by the nearest rotation.
pub(crate) fn warn_of_rounded_pose(py: Python<'_>, name: &str, defect: f64) -> PyResult<()> {
    let message = format!(
        "{name}: the rotation is off one by {defect:.1e}; the nearest rotation is used, and a \
         direction may be off by as much"
    );
    let class = class_called(py, "RoundedPoseWarning")?;
    PyErr::warn(py, &class, &std::ffi::CString::new(message)?, 1)
}
