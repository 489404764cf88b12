//! The step counts of an answer, and the features in contact.

use std::borrow::Cow;

use colltrans::Body;
use numpy::PyArray1;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arrays::Indices;
use crate::frozen::{getters, match_args, pickled};

/// Step counts of the search for one answer.
#[pyclass(frozen, module = "colltrans.answers")]
#[derive(Serialize, Deserialize)]
pub(crate) struct Steps(pub(crate) colltrans::Steps);

pickled!(Steps, Feature, Features);

getters!(Steps, |it| {
    /// int: Number of planar problems that were solved.
    planar_problems: u32 = it.0.planar_problems;
    /// int: Number of supporting planes that were computed.
    supports: u32 = it.0.supports;
    /// int: Number of portals that were visited.
    pivots: u32 = it.0.pivots;
    /// int: Number of iterations of inner loops.
    iterations: u32 = it.0.iterations;
    /// int: Maximum number of sides of the region of section levels; 0 if there was no region.
    region_sides: u32 = it.0.region_sides;
    /// str: The start of the search: ``"scratch"``, or with a tracker ``"features"`` or ``"region"``.
    started_from: &'static str = it.0.started_from.name();
});

#[pymethods]
impl Steps {
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

/// A vertex, an edge or a face of a body.
#[pyclass(frozen, module = "colltrans.answers")]
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Feature {
    kind: Cow<'static, str>,
    vertices: Vec<u32>,
}

match_args!(Feature("kind", "vertices"));

impl Feature {
    /// Converts a feature, with the vertex numbers of the input.
    pub(crate) fn from_feature<B: Body>(feature: colltrans::Feature, body: &B) -> Self {
        Self {
            kind: feature.kind().into(),
            vertices: feature.vertices(body).into_iter().map(u32::from).collect(),
        }
    }
}

getters!(Feature, |it| {
    /// str: ``"vertex"``, ``"edge"`` or ``"face"``.
    kind: &str = &it.kind;
    /// ndarray: The vertices of the feature, as indices of the points or the mesh from which the body was
    /// built.
    vertices(py): Indices<'py> = PyArray1::from_slice(py, &it.vertices);
});

#[pymethods]
impl Feature {
    fn __repr__(&self) -> String {
        format!("Feature('{}', {:?})", self.kind, self.vertices)
    }
}

/// The features of both bodies that are in contact.
#[pyclass(frozen, module = "colltrans.answers")]
#[derive(Serialize, Deserialize)]
pub(crate) struct Features {
    pub(crate) moving: Feature,
    pub(crate) fixed: Feature,
}

match_args!(Features("moving", "fixed"));

impl Features {
    pub(crate) fn from_contact(contact: &colltrans::Contact, cast: &colltrans::Cast<'_>) -> Self {
        let colltrans::Features { moving, fixed } = contact.features(cast);
        let moving = Feature::from_feature(moving, cast.moving());
        Self { moving, fixed: Feature::from_feature(fixed, cast.fixed()) }
    }
}

getters!(Features, |it| {
    /// Feature: The feature of the moving body.
    moving: Feature = it.moving.clone();
    /// Feature: The feature of the fixed body.
    fixed: Feature = it.fixed.clone();
});

#[pymethods]
impl Features {
    fn __repr__(&self) -> String {
        let [moving, fixed] = [&self.moving, &self.fixed].map(|f| f.__repr__());
        format!("Features(moving={moving}, fixed={fixed})")
    }
}
