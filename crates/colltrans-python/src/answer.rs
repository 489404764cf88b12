//! Answers: frozen, with what they were asked. Arrays, points and features are made on access.
//!
//! A *last* contact is the first one of the query turned round, and keeps that query, as in the
//! library.

use colltrans::{ContactRange as Range, Outcome};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{coordinates, row};
use crate::certificate::{Certificate, Separation};
use crate::errors::OrRaise;
use crate::features::{Features, Steps, feature};
use crate::pose::Pose;
use crate::query::{Cast, Query};
use crate::saved::{Saved, saved, written};
use crate::show::{Options, Shown, show};

/// Where the bodies first meet along the direction.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Contact {
    pub(crate) contact: colltrans::Contact,
    pub(crate) query: Query,
}

impl Contact {
    /// The library's cast; its query has been answered, so it is one.
    fn with_cast<T>(&self, then: impl FnOnce(&colltrans::Cast<'_>) -> T) -> PyResult<T> {
        self.query.ask(|cast| Ok(then(cast)))
    }
}

#[pymethods]
impl Contact {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str, &'static str) =
        ("translation", "normal", "point");

    /// float: The collision translation, in multiples of the direction. Negative: a contact that
    /// lies behind, or an overlap now.
    #[getter]
    fn translation(&self) -> f64 {
        self.contact.translation
    }

    /// ndarray of shape (3,): Unit contact normal in the world, from the moving body to the fixed one.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.contact.normal)
    }

    /// ndarray of shape (3,): The contact point, in the world.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let points = self.with_cast(|cast| self.contact.points(cast))?;
        Ok(row(py, points.on_fixed))
    }

    /// ndarray of shape (3,): The same point of the moving body before it moves, in the world.
    #[getter]
    fn point_at_start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let points = self.with_cast(|cast| self.contact.points(cast))?;
        Ok(row(py, points.on_moving))
    }

    /// Features: The vertex, edge or face of each body in the contact plane.
    #[getter]
    fn features(&self, py: Python<'_>) -> PyResult<Features> {
        let (moving, fixed) = self.with_cast(|cast| {
            let found = self.contact.features(cast);
            (feature(found.moving, cast.moving()), feature(found.fixed, cast.fixed()))
        })?;
        Ok(Features { moving: Py::new(py, moving)?, fixed: Py::new(py, fixed)? })
    }

    /// Certificate: Both bounds with their proofs.
    #[getter]
    fn certificate(&self, py: Python<'_>) -> Certificate {
        Certificate { proof: self.contact.certificate, query: self.query.copy(py) }
    }

    /// Pose: The moving body's pose after the motion up to this contact and not beyond, whatever
    /// rounding does.
    #[getter]
    fn pose_before(&self) -> PyResult<Pose> {
        self.with_cast(|cast| self.contact.pose_before(cast))?.or_raise().map(Pose)
    }

    /// str: The solver that found it.
    #[getter]
    fn solver(&self) -> &'static str {
        self.contact.solver.name()
    }

    /// Steps: Work done.
    #[getter]
    fn steps(&self) -> Steps {
        Steps::of(self.contact.steps)
    }

    /// Cast: The query; of a last contact the one turned round.
    #[getter]
    fn query(&self, py: Python<'_>) -> Cast {
        Cast(self.query.copy(py))
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "Contact", (Cast(self.query.copy(py)), written(&self.contact)?))
    }

    pub(crate) fn __repr__(&self) -> String {
        let (t, n) = (self.contact.translation, coordinates(self.contact.normal));
        format!("Contact(translation={t:?}, normal={n:?})")
    }
}

/// The bodies slide along each other: their shadows overlap by no more than the graze tolerance.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Grazing {
    pub(crate) grazing: colltrans::Grazing,
    pub(crate) contact: Py<Contact>,
}

#[pymethods]
impl Grazing {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str) = ("overlap", "contact");

    /// float: How far the shadows overlap, a length; negative if they miss by less than rounding
    /// can tell.
    #[getter]
    fn overlap(&self) -> f64 {
        self.grazing.overlap
    }

    /// ndarray of shape (3,): Unit vector of the world, across the direction, from the moving body's
    /// shadow to the fixed one's.
    #[getter]
    fn separating_direction<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.grazing.separating_direction)
    }

    /// Contact: The contact if the overlap is taken for real.
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
        let (contact, g) = (self.contact.clone_ref(py), &self.grazing);
        saved(py, "Grazing", (contact, written(g)?))
    }

    pub(crate) fn __repr__(&self) -> String {
        let contact = self.contact.get().__repr__();
        format!("Grazing(overlap={:?}, contact={contact})", self.grazing.overlap)
    }
}

/// The bodies never meet along the direction.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Separated {
    pub(crate) separated: colltrans::Separated,
    pub(crate) query: Query,
}

#[pymethods]
impl Separated {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str) = ("margin", "normal");

    /// float: A lower bound of the distance of the shadows, a length.
    #[getter]
    fn margin(&self) -> f64 {
        self.separated.certificate.margin
    }

    /// ndarray of shape (3,): Unit normal of a plane between them, parallel to the direction.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.separated.certificate.normal)
    }

    /// Separation: The proof.
    #[getter]
    fn certificate(&self, py: Python<'_>) -> Separation {
        Separation { proof: self.separated.certificate, query: self.query.copy(py) }
    }

    /// float: How far the moving body can move: infinitely.
    #[getter]
    fn distance(&self) -> f64 {
        f64::INFINITY
    }

    /// str: The solver that found it.
    #[getter]
    fn solver(&self) -> &'static str {
        self.separated.solver.name()
    }

    /// Steps: Work done.
    #[getter]
    fn steps(&self) -> Steps {
        Steps::of(self.separated.steps)
    }

    /// Cast: The query.
    #[getter]
    fn query(&self, py: Python<'_>) -> Cast {
        Cast(self.query.copy(py))
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        saved(py, "Separated", (Cast(self.query.copy(py)), written(&self.separated)?))
    }

    pub(crate) fn __repr__(&self) -> String {
        format!("Separated(margin={:?})", self.separated.certificate.margin)
    }
}

/// All translations at which the bodies meet, with what touches at either end.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct ContactRange {
    pub(crate) interval: (f64, f64),
    pub(crate) first: Py<PyAny>,
    pub(crate) last: Py<PyAny>,
}

#[pymethods]
impl ContactRange {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str,) = ("interval",);

    /// tuple of float: First and last translation, in multiples of the direction.
    #[getter]
    fn interval(&self) -> (f64, f64) {
        self.interval
    }

    /// Contact or Grazing: The first contact along the direction.
    #[getter]
    fn first(&self, py: Python<'_>) -> Py<PyAny> {
        self.first.clone_ref(py)
    }

    /// Contact or Grazing: The last contact: the first one of the query turned round.
    #[getter]
    fn last(&self, py: Python<'_>) -> Py<PyAny> {
        self.last.clone_ref(py)
    }

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        let (first, last) = (self.first.clone_ref(py), self.last.clone_ref(py));
        saved(py, "ContactRange", (self.interval, first, last))
    }

    pub(crate) fn __repr__(&self) -> String {
        format!("ContactRange(interval={:?})", self.interval)
    }
}

pub(crate) fn contact(
    py: Python<'_>,
    query: Query,
    contact: colltrans::Contact,
) -> PyResult<Py<Contact>> {
    Py::new(py, Contact { contact, query })
}

pub(crate) fn grazing(
    py: Python<'_>,
    query: Query,
    grazing: colltrans::Grazing,
) -> PyResult<Py<Grazing>> {
    let contact = contact(py, query, grazing.contact)?;
    Py::new(py, Grazing { grazing, contact })
}

/// An answer of a class of its own.
pub(crate) fn object<T>(py: Python<'_>, of: T) -> PyResult<Bound<'_, PyAny>>
where
    T: pyo3::PyClass + Into<PyClassInitializer<T>>,
{
    Ok(Bound::new(py, of)?.into_any())
}

pub(crate) fn outcome(py: Python<'_>, query: Query, of: Outcome) -> PyResult<Bound<'_, PyAny>> {
    match of {
        Outcome::Contact(contact) => object(py, Contact { contact, query }),
        Outcome::Grazing(of) => Ok(grazing(py, query, of)?.into_bound(py).into_any()),
        Outcome::Separated(separated) => object(py, Separated { separated, query }),
    }
}

pub(crate) fn range(py: Python<'_>, query: Query, of: Range) -> PyResult<Bound<'_, PyAny>> {
    let back = query.reversed(py);
    let interval = of.interval().map(|[enter, exit]| (enter, exit + 0.0));
    let (first, last) = match of {
        Range::Contact { first, last } => {
            (contact(py, query, first)?.into_any(), contact(py, back, last)?.into_any())
        }
        Range::Grazing { first, last } => {
            (grazing(py, query, first)?.into_any(), grazing(py, back, last)?.into_any())
        }
        Range::Separated(separated) => return object(py, Separated { separated, query }),
    };
    let interval = interval.unwrap_or((f64::NAN, f64::NAN));
    object(py, ContactRange { interval, first, last })
}
