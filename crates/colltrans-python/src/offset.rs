//! Reports of shrinking and growing.

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

/// What shrinking, or growing, could not do to a solid as it should.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct ShrinkReport(pub(crate) colltrans::solid::ShrinkReport);

#[pymethods]
impl ShrinkReport {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str, &'static str) =
        ("farthest", "stuck", "inverted");

    /// float: The largest displacement of a vertex, a length.
    #[getter]
    fn farthest(&self) -> f64 {
        self.0.farthest
    }

    /// ndarray: Vertices that stay, because no displacement is inwards for all facets around them;
    /// indices of the input.
    #[getter]
    fn stuck<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.0.stuck)
    }

    /// ndarray: Facets that turned inside out, or passed through others, because the body (or a gap in
    /// it that grows shut) is thinner than twice the amount there; indices of the input, in increasing
    /// order.
    #[getter]
    fn inverted<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.0.inverted)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        let colltrans::solid::ShrinkReport { farthest, stuck, inverted } = self.0.clone();
        saved(py, "ShrinkReport", (farthest, stuck, inverted))
    }

    fn __repr__(&self) -> String {
        let colltrans::solid::ShrinkReport { farthest, stuck, inverted } = &self.0;
        format!("ShrinkReport(farthest={farthest:?}, stuck={stuck:?}, inverted={inverted:?})")
    }
}
