//! The work done for an answer, and the features that touch.

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::saved::{Saved, saved};

/// Work done for one answer.
#[pyclass(frozen, get_all, module = "colltrans")]
pub(crate) struct Steps {
    /// int: Planar problems solved.
    pub(crate) planar_problems: u32,
    /// int: Supporting planes computed.
    pub(crate) supports: u32,
    /// int: Portals visited.
    pub(crate) pivots: u32,
    /// int: Iterations of inner loops.
    pub(crate) iterations: u32,
    /// str: ``"scratch"``, or of a tracker ``"features"`` or ``"region"``.
    pub(crate) started_from: &'static str,
}

impl Steps {
    pub(crate) fn of(steps: colltrans::Steps) -> Self {
        let colltrans::Steps {
            planar_problems, supports, pivots, iterations, started_from, ..
        } = steps;
        let started_from = started_from.name();
        Self { planar_problems, supports, pivots, iterations, started_from }
    }
}

#[pymethods]
impl Steps {
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        let Self { planar_problems, supports, pivots, iterations, started_from } = *self;
        saved(py, "Steps", ([planar_problems, supports, pivots, iterations], started_from))
    }

    fn __repr__(&self) -> String {
        let Self { planar_problems, supports, pivots, iterations, started_from } = self;
        format!(
            "Steps(planar_problems={planar_problems}, supports={supports}, pivots={pivots}, \
             iterations={iterations}, started_from='{started_from}')"
        )
    }
}

/// A vertex, an edge or a face.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Feature {
    kind: &'static str,
    vertices: Vec<u32>,
}

#[pymethods]
impl Feature {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str) = ("kind", "vertices");

    /// str: ``"vertex"``, ``"edge"`` or ``"face"``.
    #[getter]
    fn kind(&self) -> &'static str {
        self.kind
    }

    /// ndarray: Its vertices, by the numbers of the points or the mesh that the body was made from.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.vertices)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "Feature", (self.kind, self.vertices.clone()))
    }

    fn __repr__(&self) -> String {
        format!("Feature('{}', {:?})", self.kind, self.vertices)
    }
}

impl Feature {
    pub(crate) fn new(kind: &'static str, vertices: Vec<u32>) -> Self {
        Self { kind, vertices }
    }
}

pub(crate) fn feature(feature: colltrans::Feature, body: &colltrans::ConvexPolyhedron) -> Feature {
    Feature {
        kind: feature.kind(),
        vertices: feature.vertices(body).into_iter().map(u32::from).collect(),
    }
}

/// The parts of both bodies that touch.
#[pyclass(frozen, get_all, module = "colltrans")]
pub(crate) struct Features {
    /// Feature: Of the moving body.
    pub(crate) moving: Py<Feature>,
    /// Feature: Of the fixed body.
    pub(crate) fixed: Py<Feature>,
}

#[pymethods]
impl Features {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str) = ("moving", "fixed");

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "Features", (self.moving.clone_ref(py), self.fixed.clone_ref(py)))
    }

    fn __repr__(&self) -> String {
        let [moving, fixed] = [&self.moving, &self.fixed].map(|f| f.get().__repr__());
        format!("Features(moving={moving}, fixed={fixed})")
    }
}
