//! Pictures: `show` of every answer calls the package's own, which is Python.

use pyo3::prelude::*;
use pyo3::types::PyDict;

pub(crate) type Options<'a, 'py> = &'a Bound<'py, PyDict>;
pub(crate) type Shown<'py> = PyResult<Bound<'py, PyAny>>;

pub(crate) fn show<'py, T>(
    answer: &Bound<'py, T>,
    options: Option<Options<'_, 'py>>,
) -> Shown<'py> {
    let show = answer.py().import("colltrans.pictures")?.getattr("show")?;
    show.call((answer.as_any(),), options)
}
