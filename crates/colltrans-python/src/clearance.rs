//! Answers about where the moving body is now: how far it can go, how deep it is, whether it meets.

use colltrans::{CentralCast, Clearance, OverlapAhead, WhyFree};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use crate::answer::{Contact, Grazing, Separated, contact, grazing, object, outcome};
use crate::arrays::coordinates;
use crate::query::Query;
use crate::saved::{Saved, saved};
use crate::show::{Options, Shown, show};

/// The moving body can move until it touches.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Blocked {
    pub(crate) distance: f64,
    pub(crate) contact: Py<Contact>,
}

#[pymethods]
impl Blocked {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str) = ("distance", "contact");

    /// float: How far it may safely move, in multiples of the direction: never more than it can.
    #[getter]
    fn distance(&self) -> f64 {
        self.distance
    }

    /// Contact: What stops it.
    #[getter]
    fn contact(&self, py: Python<'_>) -> Py<Contact> {
        self.contact.clone_ref(py)
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "Blocked", (self.distance, self.contact.clone_ref(py)))
    }

    fn __repr__(&self) -> String {
        format!("Blocked(distance={:?})", self.distance)
    }
}

/// The moving body slides along the other one, as far as it likes.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Slides {
    pub(crate) grazing: Py<Grazing>,
}

#[pymethods]
impl Slides {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str,) = ("grazing",);

    /// float: Infinite.
    #[getter]
    fn distance(&self) -> f64 {
        f64::INFINITY
    }

    /// Grazing: Along what it slides.
    #[getter]
    fn grazing(&self, py: Python<'_>) -> Py<Grazing> {
        self.grazing.clone_ref(py)
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "Slides", (self.grazing.clone_ref(py),))
    }

    fn __repr__(&self) -> String {
        format!("Slides(grazing={})", self.grazing.get().__repr__())
    }
}

/// The last contact lies behind, or is here and the moving body leaves it.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Behind {
    pub(crate) contact: Py<Contact>,
}

#[pymethods]
impl Behind {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str,) = ("contact",);

    /// float: Infinite.
    #[getter]
    fn distance(&self) -> f64 {
        f64::INFINITY
    }

    /// Contact: The last one: the first one of the query turned round.
    #[getter]
    fn contact(&self, py: Python<'_>) -> Py<Contact> {
        self.contact.clone_ref(py)
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "Behind", (self.contact.clone_ref(py),))
    }

    fn __repr__(&self) -> String {
        format!("Behind(contact={})", self.contact.get().__repr__())
    }
}

/// The bodies overlap where they are, by more than rounding error.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Overlapping {
    pub(crate) first: Py<Contact>,
    pub(crate) last: Py<Contact>,
}

#[pymethods]
impl Overlapping {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str) = ("first", "last");

    /// None: There is none.
    #[getter]
    fn distance(&self) -> Option<f64> {
        None
    }

    /// Contact: The first contact, behind.
    #[getter]
    fn first(&self, py: Python<'_>) -> Py<Contact> {
        self.first.clone_ref(py)
    }

    /// Contact: The last contact, ahead: the first one of the query turned round.
    #[getter]
    fn last(&self, py: Python<'_>) -> Py<Contact> {
        self.last.clone_ref(py)
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "Overlapping", (self.first.clone_ref(py), self.last.clone_ref(py)))
    }

    fn __repr__(&self) -> String {
        let [first, last] = [&self.first, &self.last].map(|c| c.get().__repr__());
        format!("Overlapping(first={first}, last={last})")
    }
}

/// How far the moving body has to go back until the overlap has ended.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct DirectionalDepth {
    pub(crate) depth: f64,
    pub(crate) clearance: Py<PyAny>,
}

#[pymethods]
impl DirectionalDepth {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str,) = ("depth",);

    /// float: In multiples of the direction, never less than the true depth; 0 without overlap.
    #[getter]
    fn depth(&self) -> f64 {
        self.depth
    }

    /// Blocked or Slides or Behind or Separated or Overlapping: What it follows from.
    #[getter]
    fn clearance(&self, py: Python<'_>) -> Py<PyAny> {
        self.clearance.clone_ref(py)
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "DirectionalDepth", (self.depth, self.clearance.clone_ref(py)))
    }

    fn __repr__(&self) -> String {
        format!("DirectionalDepth(depth={:?})", self.depth)
    }
}

/// Whether the bodies meet where they are: true or false in a condition.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Intersection {
    pub(crate) meets: bool,
    pub(crate) direction: [f64; 3],
    pub(crate) outcome: Py<PyAny>,
}

#[pymethods]
impl Intersection {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str,) = ("meets",);

    /// bool: Whether they have a point in common, to within rounding error.
    #[getter]
    fn meets(&self) -> bool {
        self.meets
    }

    /// ndarray of shape (3,): The direction between the centres, of the cast that found out.
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.direction.to_vec().into_pyarray(py)
    }

    /// Contact or Grazing or Separated: What that cast found.
    #[getter]
    fn outcome(&self, py: Python<'_>) -> Py<PyAny> {
        self.outcome.clone_ref(py)
    }

    fn __bool__(&self) -> bool {
        self.meets
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "Intersection", (self.meets, self.direction, self.outcome.clone_ref(py)))
    }

    fn __repr__(&self) -> String {
        format!("Intersection(meets={})", if self.meets { "True" } else { "False" })
    }
}

pub(crate) fn clearance(py: Python<'_>, query: Query, of: Clearance) -> PyResult<Bound<'_, PyAny>> {
    match of {
        Clearance::Blocked { distance, contact: of } => {
            object(py, Blocked { distance, contact: contact(py, query, of)? })
        }
        Clearance::Free(WhyFree::Slides(of)) => {
            object(py, Slides { grazing: grazing(py, query, of)? })
        }
        Clearance::Free(WhyFree::Behind(of)) => {
            object(py, Behind { contact: contact(py, query.reversed(py), of)? })
        }
        Clearance::Free(WhyFree::Separated(separated)) => {
            object(py, Separated { separated, query })
        }
        Clearance::Overlapping(OverlapAhead { first, last }) => {
            let back = query.reversed(py);
            let (first, last) = (contact(py, query, first)?, contact(py, back, last)?);
            object(py, Overlapping { first, last })
        }
    }
}

pub(crate) fn depth(
    py: Python<'_>,
    query: Query,
    of: colltrans::DirectionalDepth,
) -> PyResult<Bound<'_, PyAny>> {
    let clearance = clearance(py, query, of.clearance)?.unbind();
    object(py, DirectionalDepth { depth: of.depth, clearance })
}

pub(crate) fn intersection(
    py: Python<'_>,
    query: Query,
    of: colltrans::Intersection,
) -> PyResult<Bound<'_, PyAny>> {
    let CentralCast { direction, outcome: found, .. } = of.evidence;
    let query = Query { direction, ..query };
    let direction = coordinates(direction);
    let outcome = outcome(py, query, found)?.unbind();
    object(py, Intersection { meets: of.meets, direction, outcome })
}
