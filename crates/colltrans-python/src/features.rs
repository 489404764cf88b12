//! The work done for an answer, and the features that touch.

use std::borrow::Cow;

use colltrans::Body;
use numpy::PyArray1;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::frozen::{match_args, pickled};

/// Work done for one answer.
#[pyclass(frozen, module = "colltrans")]
#[derive(Serialize, Deserialize)]
pub(crate) struct Steps(pub(crate) colltrans::Steps);

pickled!(Steps, Feature, Features);

#[pymethods]
impl Steps {
    /// int: Planar problems solved.
    #[getter]
    fn planar_problems(&self) -> u32 {
        self.0.planar_problems
    }

    /// int: Supporting planes computed.
    #[getter]
    fn supports(&self) -> u32 {
        self.0.supports
    }

    /// int: Portals visited.
    #[getter]
    fn pivots(&self) -> u32 {
        self.0.pivots
    }

    /// int: Iterations of inner loops.
    #[getter]
    fn iterations(&self) -> u32 {
        self.0.iterations
    }

    /// int: Sides that the region of section levels had at most; 0 if there was none.
    #[getter]
    fn region_sides(&self) -> u32 {
        self.0.region_sides
    }

    /// str: ``"scratch"``, or of a tracker ``"features"`` or ``"region"``.
    #[getter]
    fn started_from(&self) -> &'static str {
        self.0.started_from.name()
    }

    fn __repr__(&self) -> String {
        let colltrans::Steps {
            planar_problems, supports, pivots, iterations, started_from, ..
        } = self.0;
        format!(
            "Steps(planar_problems={planar_problems}, supports={supports}, pivots={pivots}, \
             iterations={iterations}, started_from='{started_from}')"
        )
    }
}

/// A vertex, an edge or a face.
#[pyclass(frozen, module = "colltrans")]
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Feature {
    kind: Cow<'static, str>,
    vertices: Vec<u32>,
}

match_args!(Feature("kind", "vertices"));

impl Feature {
    /// By the numbers of the input.
    pub(crate) fn of<B: Body>(feature: colltrans::Feature, body: &B) -> Self {
        Self {
            kind: feature.kind().into(),
            vertices: feature.vertices(body).into_iter().map(u32::from).collect(),
        }
    }
}

#[pymethods]
impl Feature {
    /// str: ``"vertex"``, ``"edge"`` or ``"face"``.
    #[getter]
    fn kind(&self) -> &str {
        &self.kind
    }

    /// ndarray: Its vertices, by the numbers of the points or the mesh that the body was made from.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.vertices)
    }

    fn __repr__(&self) -> String {
        format!("Feature('{}', {:?})", self.kind, self.vertices)
    }
}

/// The parts of both bodies that touch.
#[pyclass(frozen, module = "colltrans")]
#[derive(Serialize, Deserialize)]
pub(crate) struct Features {
    pub(crate) moving: Feature,
    pub(crate) fixed: Feature,
}

match_args!(Features("moving", "fixed"));

impl Features {
    pub(crate) fn of(contact: &colltrans::Contact, cast: &colltrans::Cast<'_>) -> Self {
        let colltrans::Features { moving, fixed } = contact.features(cast);
        let moving = Feature::of(moving, cast.moving());
        Self { moving, fixed: Feature::of(fixed, cast.fixed()) }
    }
}

#[pymethods]
impl Features {
    /// Feature: Of the moving body.
    #[getter]
    fn moving(&self) -> Feature {
        self.moving.clone()
    }

    /// Feature: Of the fixed body.
    #[getter]
    fn fixed(&self) -> Feature {
        self.fixed.clone()
    }

    fn __repr__(&self) -> String {
        let [moving, fixed] = [&self.moving, &self.fixed].map(|f| f.__repr__());
        format!("Features(moving={moving}, fixed={fixed})")
    }
}
