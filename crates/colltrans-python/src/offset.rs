//! What shrinking and growing tell beside the body.

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::saved::{Saved, saved};

/// What became of a convex body whose faces were moved.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct OffsetReport(pub(crate) colltrans::OffsetReport);

#[pymethods]
impl OffsetReport {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str) = ("farthest", "vanished");

    /// float: The largest distance of a vertex from the one that it comes from, a length.
    #[getter]
    fn farthest(&self) -> f64 {
        self.0.farthest
    }

    /// ndarray: Faces of the body as it was of which nothing is left, in increasing order.
    #[getter]
    fn vanished<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.0.vanished)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "OffsetReport", (self.0.farthest, self.0.vanished.clone()))
    }

    fn __repr__(&self) -> String {
        let colltrans::OffsetReport { farthest, vanished } = &self.0;
        format!("OffsetReport(farthest={farthest:?}, vanished={vanished:?})")
    }
}
