//! Reports of shrinking and growing.

use colltrans::{InputFacet, InputVertex};
use numpy::PyArray1;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arrays::{Indices, ids};
use crate::frozen::{getters, match_args, pickled};

/// What became of a convex body whose faces were moved.
#[pyclass(frozen, module = "colltrans")]
#[derive(Serialize, Deserialize)]
pub(crate) struct OffsetReport {
    farthest: f64,
    vanished: Vec<u32>,
}

match_args!(OffsetReport("farthest", "vanished"));
pickled!(OffsetReport);

impl From<colltrans::OffsetReport> for OffsetReport {
    fn from(report: colltrans::OffsetReport) -> Self {
        let colltrans::OffsetReport { farthest, vanished } = report;
        Self { farthest, vanished }
    }
}

getters!(OffsetReport, |it| {
    /// float: The largest distance of a vertex from the one that it comes from, a length.
    farthest: f64 = it.farthest;
    /// ndarray: Faces of the body as it was of which nothing is left, in increasing order.
    vanished(py): Indices<'py> = PyArray1::from_slice(py, &it.vanished);
});

#[pymethods]
impl OffsetReport {
    fn __repr__(&self) -> String {
        let Self { farthest, vanished } = self;
        format!("OffsetReport(farthest={farthest:?}, vanished={vanished:?})")
    }
}

/// What shrinking, or growing, could not do to a solid as it should.
#[pyclass(frozen, module = "colltrans")]
#[derive(Serialize, Deserialize)]
pub(crate) struct ShrinkReport {
    farthest: f64,
    stuck: Vec<InputVertex>,
    inverted: Vec<InputFacet>,
}

match_args!(ShrinkReport("farthest", "stuck", "inverted"));
pickled!(ShrinkReport);

impl From<colltrans::solid::ShrinkReport> for ShrinkReport {
    fn from(report: colltrans::solid::ShrinkReport) -> Self {
        let colltrans::solid::ShrinkReport { farthest, stuck, inverted } = report;
        Self { farthest, stuck, inverted }
    }
}

getters!(ShrinkReport, |it| {
    /// float: The largest displacement of a vertex, a length.
    farthest: f64 = it.farthest;
    /// ndarray: Vertices that stay, because no displacement is inwards for all facets around them;
    /// indices of the input.
    stuck(py): Indices<'py> = ids(py, &it.stuck);
    /// ndarray: Facets that turned inside out, or passed through others, because the body (or a gap in
    /// it that grows shut) is thinner than twice the amount there; indices of the input, in increasing
    /// order.
    inverted(py): Indices<'py> = ids(py, &it.inverted);
});

#[pymethods]
impl ShrinkReport {
    fn __repr__(&self) -> String {
        let farthest = self.farthest;
        let stuck: Vec<u32> = self.stuck.iter().map(|v| v.0).collect();
        let inverted: Vec<u32> = self.inverted.iter().map(|f| f.0).collect();
        format!("ShrinkReport(farthest={farthest:?}, stuck={stuck:?}, inverted={inverted:?})")
    }
}
