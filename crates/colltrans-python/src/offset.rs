//! Reports of shrinking and growing a body.

use colltrans::{InputFacet, InputVertex};
use numpy::PyArray1;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arrays::{Indices, ids};
use crate::frozen::{getters, match_args, pickled};

/// The effect of moving the faces of a convex body.
#[pyclass(frozen, module = "colltrans.answers")]
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
    /// float: The largest distance of a new vertex from the vertex that it comes from, a length.
    farthest: f64 = it.farthest;
    /// ndarray: Faces of the original body that vanished, in increasing order.
    vanished(py): Indices<'py> = PyArray1::from_slice(py, &it.vanished);
});

#[pymethods]
impl OffsetReport {
    fn __repr__(&self) -> String {
        let Self { farthest, vanished } = self;
        format!("OffsetReport(farthest={farthest:?}, vanished={vanished:?})")
    }
}

/// The vertices and facets of a solid for which shrinking or growing failed.
#[pyclass(frozen, module = "colltrans.answers")]
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
        let colltrans::solid::ShrinkReport { farthest, fixed_vertices, inverted } = report;
        Self { farthest, stuck: fixed_vertices, inverted }
    }
}

getters!(ShrinkReport, |it| {
    /// float: The largest displacement of a vertex, a length.
    farthest: f64 = it.farthest;
    /// ndarray: Vertices that stay, because no displacement is inwards for all facets around them; indices of
    /// the input.
    stuck(py): Indices<'py> = ids(py, &it.stuck);
    /// ndarray: Facets that turned inside out or passed through others, because the body (or a gap that
    /// closes by growing) is thinner than twice the amount there. Indices of the input, in increasing order.
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
