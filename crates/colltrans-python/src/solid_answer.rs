//! Answers of queries about solids: frozen, with what they were asked.

use colltrans::Clearance;
use colltrans::solid::{Overlap, SolidOverlap};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{coordinates, row};
use crate::errors::OrRaise;
use crate::features::Feature;
use crate::saved::{Saved, saved, written};
use crate::show::{Options, Shown, show};
use crate::solid::Piece;
use crate::solid_cast::SolidCast;

/// Where a solid is stopped.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidContact {
    pub(crate) contact: colltrans::solid::SolidContact,
    pub(crate) query: Py<SolidCast>,
}

#[pymethods]
impl SolidContact {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str, &'static str) =
        ("translation", "normal", "point");

    /// float: Where the faces that stop the body meet in their true place, not shrunk, in multiples of
    /// the direction; the best estimate.
    #[getter]
    fn translation(&self) -> f64 {
        self.contact.translation.value
    }

    /// tuple of (float, float): Its proven bounds. Up to the first the shrunk bodies do not overlap and
    /// those two faces have not met; beyond the second the bodies overlap: as they are, or, where
    /// those faces pass each other as they are, shrunk.
    #[getter]
    fn translation_bounds(&self) -> (f64, f64) {
        self.contact.translation.bounds().into()
    }

    /// float: How far the bodies go that were shrunk by half the tolerance each, in multiples of the
    /// direction.
    #[getter]
    fn shrunk_distance(&self) -> f64 {
        self.contact.shrunk_distance.value
    }

    /// tuple of (float, float): Its proven bounds.
    #[getter]
    fn shrunk_distance_bounds(&self) -> (f64, f64) {
        self.contact.shrunk_distance.bounds().into()
    }

    /// ndarray of shape (3,): Unit contact normal in the world, from the moving body to the fixed one.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.contact.normal)
    }

    /// ndarray of shape (3,): The contact point on the fixed body, in the world.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.contact.point_on_fixed)
    }

    /// ndarray of shape (3,): The same point of the moving body before it moves, in the world.
    #[getter]
    fn point_at_start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.contact.point_on_moving)
    }

    /// Feature: What of the moving body touches: a corner, an edge from corner to corner, or the whole
    /// polygon of a face.
    #[getter]
    fn moving_feature(&self) -> PyResult<Feature> {
        feature(self.contact.moving_feature, &self.query.get().bodies[0])
    }

    /// Feature: What of the fixed body touches.
    #[getter]
    fn fixed_feature(&self) -> PyResult<Feature> {
        feature(self.contact.fixed_feature, &self.query.get().bodies[1])
    }

    /// SolidCast: The query.
    #[getter]
    fn query(&self, py: Python<'_>) -> Py<SolidCast> {
        self.query.clone_ref(py)
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "SolidContact", (self.query.clone_ref(py), written(&self.contact)?))
    }

    fn __repr__(&self) -> String {
        let (t, n) = (self.contact.translation.value, coordinates(self.contact.normal));
        format!("SolidContact(translation={t:?}, normal={n:?})")
    }
}

/// A feature by the numbers of the input.
fn feature(feature: colltrans::Feature, body: &Piece) -> PyResult<Feature> {
    let vertices = feature.vertices(body.solid().or_raise()?);
    Ok(Feature::new(feature.kind(), vertices.into_iter().map(u32::from).collect()))
}

/// A solid can move until it touches.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidBlocked {
    pub(crate) distance: f64,
    pub(crate) contact: Py<SolidContact>,
}

#[pymethods]
impl SolidBlocked {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str) = ("distance", "contact");

    /// float: How far it may safely move, in multiples of the direction: the lower bound of where it is
    /// stopped, and never negative.
    #[getter]
    fn distance(&self) -> f64 {
        self.distance
    }

    /// SolidContact: What stops it.
    #[getter]
    fn contact(&self, py: Python<'_>) -> Py<SolidContact> {
        self.contact.clone_ref(py)
    }

    /// list of str: Which of ``moving`` and ``fixed`` are open surfaces, at least in part: what is inside
    /// of them is not known.
    #[getter]
    fn surfaces(&self) -> PyResult<Vec<&'static str>> {
        surfaces(&self.contact.get().query)
    }

    /// SolidCast: The query.
    #[getter]
    fn query(&self, py: Python<'_>) -> Py<SolidCast> {
        self.contact.get().query.clone_ref(py)
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "SolidBlocked", (self.distance, self.contact.clone_ref(py)))
    }

    fn __repr__(&self) -> String {
        format!("SolidBlocked(distance={:?})", self.distance)
    }
}

/// A solid can move as far as it likes.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidFree {
    pub(crate) separation: Option<[f64; 4]>,
    pub(crate) query: Py<SolidCast>,
}

#[pymethods]
impl SolidFree {
    /// float: Infinite.
    #[getter]
    fn distance(&self) -> f64 {
        f64::INFINITY
    }

    /// float or None: The margin of a plane between the bodies, parallel to the direction, a length;
    /// None if there is no such plane: it slides along, or moves away.
    #[getter]
    fn margin(&self) -> Option<f64> {
        self.separation.map(|s| s[3])
    }

    /// ndarray of shape (3,) or None: Unit normal of that plane, in the world.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.separation.map(|s| PyArray1::from_slice(py, &s[..3]))
    }

    /// list of str: Which of ``moving`` and ``fixed`` are open surfaces, at least in part: what is inside
    /// of them is not known.
    #[getter]
    fn surfaces(&self) -> PyResult<Vec<&'static str>> {
        surfaces(&self.query)
    }

    /// SolidCast: The query.
    #[getter]
    fn query(&self, py: Python<'_>) -> Py<SolidCast> {
        self.query.clone_ref(py)
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "SolidFree", (self.separation, self.query.clone_ref(py)))
    }

    fn __repr__(&self) -> &'static str {
        "SolidFree()"
    }
}

/// Two solids overlap where they are, by more than is tolerated.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidOverlapping {
    pub(crate) depth: Option<f64>,
    /// Faces of the moving and of the fixed body.
    pub(crate) place: [Option<u32>; 2],
    pub(crate) query: Py<SolidCast>,
}

impl SolidOverlapping {
    pub(crate) fn of(overlap: &SolidOverlap, query: &Bound<'_, SolidCast>) -> PyResult<Self> {
        let triangles = match overlap.place {
            Overlap::Facets(moving, fixed) => [Some(moving), Some(fixed)],
            Overlap::MovingInside(moving) => [Some(moving), None],
            Overlap::FixedInside(fixed) => [None, Some(fixed)],
        };
        let bodies = &query.get().bodies;
        let solids = [bodies[0].solid().or_raise()?, bodies[1].solid().or_raise()?];
        let face = |i: usize| Some(solids[i].facet_indices()[triangles[i]? as usize]);
        let place = [face(0), face(1)];
        Ok(Self { depth: overlap.least_tolerance, place, query: query.clone().unbind() })
    }
}

#[pymethods]
impl SolidOverlapping {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str,) = ("depth",);

    /// None: There is none.
    #[getter]
    fn distance(&self) -> Option<f64> {
        None
    }

    /// float or None: The least tolerance with which they would not overlap, a length; None if there is
    /// none, as for open surfaces.
    #[getter]
    fn depth(&self) -> Option<f64> {
        self.depth
    }

    /// tuple of (int or None, int or None): One of the places where the bodies, shrunk by half the
    /// tolerance each, overlap: a face of the moving and one of the fixed body that cross, as they
    /// were numbered in the input; where one of them is None, the shell with the other lies inside
    /// that body.
    #[getter]
    fn place(&self) -> (Option<u32>, Option<u32>) {
        self.place.into()
    }

    /// list of str: Which of ``moving`` and ``fixed`` are open surfaces, at least in part: what is inside
    /// of them is not known.
    #[getter]
    fn surfaces(&self) -> PyResult<Vec<&'static str>> {
        surfaces(&self.query)
    }

    /// SolidCast: The query.
    #[getter]
    fn query(&self, py: Python<'_>) -> Py<SolidCast> {
        self.query.clone_ref(py)
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "SolidOverlapping", (self.depth, self.place, self.query.clone_ref(py)))
    }

    fn __repr__(&self) -> String {
        format!(
            "SolidOverlapping(depth={})",
            self.depth.map_or("None".into(), |d| format!("{d:?}"))
        )
    }
}

fn surfaces(query: &Py<SolidCast>) -> PyResult<Vec<&'static str>> {
    let mut found = Vec::new();
    for (name, body) in ["moving", "fixed"].into_iter().zip(&query.get().bodies) {
        if !body.solid().or_raise()?.is_closed() {
            found.push(name);
        }
    }
    Ok(found)
}

/// The proof of a clearance between solids.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidCertificate(pub(crate) colltrans::solid::SolidCertificate);

#[pymethods]
impl SolidCertificate {
    /// float: The tolerance by which the bodies were shrunk.
    #[getter]
    fn tolerance(&self) -> f64 {
        self.0.tolerance
    }

    /// float: The proven lower bound of the shrunk bodies' distance, in multiples of the direction.
    #[getter]
    fn lower(&self) -> f64 {
        self.0.lower
    }

    /// The proof as text.
    pub(crate) fn to_json(&self) -> String {
        self.0.to_json()
    }

    /// From what `to_json` has written. It is read, not believed.
    #[staticmethod]
    pub(crate) fn from_json(text: &str) -> PyResult<Self> {
        colltrans::solid::SolidCertificate::from_json(text).or_raise().map(Self)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "SolidCertificate", (self.to_json(),))
    }

    fn __repr__(&self) -> String {
        format!("SolidCertificate(lower={:?})", self.0.lower)
    }
}

pub(crate) fn solid_answer<'py>(
    query: &Bound<'py, SolidCast>,
    answer: &Clearance<colltrans::Solid>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = query.py();
    Ok(match answer {
        Clearance::Blocked { distance, contact } => {
            let contact = SolidContact { contact: *contact, query: query.clone().unbind() };
            let contact = Py::new(py, contact)?;
            Bound::new(py, SolidBlocked { distance: *distance, contact })?.into_any()
        }
        Clearance::Free(free) => {
            let separation = free.separation.as_ref().map(|s| {
                let [x, y, z] = coordinates(s.normal);
                [x, y, z, s.margin]
            });
            Bound::new(py, SolidFree { separation, query: query.clone().unbind() })?.into_any()
        }
        Clearance::Overlapping(overlap) => {
            Bound::new(py, SolidOverlapping::of(overlap, query)?)?.into_any()
        }
    })
}
