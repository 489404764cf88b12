//! Answers about the start pose of the moving body: clearance, depth, intersection.

use colltrans::glam::DVec3;
use colltrans::record::{ClearanceRecord, Record};
use colltrans::{CentralCast, Clearance, FreeReason, Outcome, OverlapAhead, ProofFile};
use pyo3::prelude::*;

use crate::answer::{Answer, answer, object};
use crate::arrays::{Vector, coordinates, row};
use crate::frozen::getters;
use crate::number::number;
use crate::outcome::{Contact, Grazing, LastContact, contact_text, grazing_text};
use crate::query::Cast;

/// The moving body can move until it touches the fixed one.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Blocked {
    distance: f64,
    contact: colltrans::Contact,
    query: Py<Cast>,
}

answer!(Blocked("distance", "contact") of Clearance, Cast, |it| {
    Clearance::Blocked { distance: it.distance, contact: it.contact }
});

getters!(Blocked, |it| {
    /// float: The free travel in multiples of the direction: the lower bound of the contact, or 0 if that is
    /// negative.
    distance: f64 = it.distance;
    /// float: The :attr:`distance`, which is proven: the bodies do not overlap up to it.
    lower: f64 = it.distance;
    /// float: A proven upper bound of the translation at which the body is stopped.
    upper: f64 = it.contact.certificate.upper.max(0.0);
    /// Contact: The contact that stops the body.
    contact(py): Contact = Contact { contact: it.contact, query: it.query(py) };
});

number!(Blocked, f64, |it| it.distance,
    /// float: The free travel, :attr:`distance`.
);

#[pymethods]
impl Blocked {
    fn __repr__(&self) -> String {
        format!("Blocked(distance={:?})", self.distance)
    }
}

/// The moving body slides along the fixed one without a limit.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Slides {
    grazing: colltrans::Grazing,
    query: Py<Cast>,
}

answer!(Slides("grazing") of Clearance, Cast, |it| Clearance::Free(FreeReason::Slides(it.grazing)));

getters!(Slides, |it| {
    /// float: Infinite.
    distance: f64 = f64::INFINITY;
    /// float: Infinite.
    lower: f64 = f64::INFINITY;
    /// float: Infinite.
    upper: f64 = f64::INFINITY;
    /// Grazing: The grazing contact along which the body slides.
    grazing(py): Grazing = Grazing { grazing: it.grazing, query: it.query(py) };
});

number!(Slides, f64, |_| f64::INFINITY,
    /// float: Infinite, because nothing blocks.
);

#[pymethods]
impl Slides {
    fn __repr__(&self) -> String {
        format!("Slides(grazing={})", grazing_text(&self.grazing))
    }
}

/// The last contact is behind the moving body, or at its start pose with the body moving away.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Behind {
    contact: colltrans::Contact,
    query: Py<Cast>,
}

answer!(Behind("contact") of Clearance, Cast, |it| Clearance::Free(FreeReason::Behind(it.contact)));

getters!(Behind, |it| {
    /// float: Infinite.
    distance: f64 = f64::INFINITY;
    /// float: Infinite.
    lower: f64 = f64::INFINITY;
    /// float: Infinite.
    upper: f64 = f64::INFINITY;
    /// Contact: The last contact, which is the first contact of the reversed query.
    contact(py): PyResult<Contact> = last(py, it.contact, &it.query);
});

number!(Behind, f64, |_| f64::INFINITY,
    /// float: Infinite, because nothing blocks.
);

#[pymethods]
impl Behind {
    fn __repr__(&self) -> String {
        format!("Behind(contact={})", contact_text(&self.contact))
    }
}

/// The bodies overlap at the start by more than rounding error, or are closer than the minimum gap.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Overlapping {
    ends: OverlapAhead,
    query: Py<Cast>,
}

answer!(Overlapping("first", "last") of Clearance, Cast, |it| Clearance::Overlapping(it.ends));

getters!(Overlapping, |it| {
    /// None: An overlap has no clearance.
    distance: Option<f64> = None;
    /// None: An overlap has no clearance.
    lower: Option<f64> = None;
    /// None: An overlap has no clearance.
    upper: Option<f64> = None;
    /// Contact: The first contact, behind.
    first(py): Contact = Contact { contact: it.ends.first, query: it.query(py) };
    /// LastContact: The last contact, ahead.
    last(py): PyResult<LastContact> = LastContact::from_outcome(py, Outcome::Contact(it.ends.last), &it.query);
});

number!(Overlapping, Option<f64>, |_| None,
    /// None: An overlap has no free travel. ``float`` raises a TypeError.
);

#[pymethods]
impl Overlapping {
    fn __repr__(&self) -> String {
        let [first, last] = [&self.ends.first, &self.ends.last].map(contact_text);
        format!("Overlapping(first={first}, last={last})")
    }
}

/// The travel backwards along the direction until an overlap ends.
#[pyclass(frozen, module = "colltrans.answers")]
pub(crate) struct DirectionalDepth {
    depth: colltrans::DirectionalDepth,
    query: Py<Cast>,
}

answer!(DirectionalDepth("depth") of colltrans::DirectionalDepth, Cast, |it| it.depth);

getters!(DirectionalDepth, |it| {
    /// float: The depth in multiples of the direction, never less than the true depth. It is 0 without an overlap,
    /// and for an overlap within rounding errors or the graze tolerance.
    depth: f64 = it.depth.depth;
    /// float: A proven lower bound of the depth.
    lower: f64 = match it.depth.clearance {
        Clearance::Overlapping(ends) => (-ends.first.certificate.upper).max(0.0),
        _ => 0.0,
    };
    /// float: The :attr:`depth`, which is proven: the overlap has ended after it.
    upper: f64 = it.depth.depth;
    /// Blocked or Slides or Behind or Separated or Overlapping: The clearance that determines the depth.
    clearance(py): PyResult<Bound<'py, PyAny>> = it.depth.clearance.object(it.query.bind(py));
});

number!(DirectionalDepth, f64, |it| it.depth.depth,
    /// float: The :attr:`depth`.
);

#[pymethods]
impl DirectionalDepth {
    fn __repr__(&self) -> String {
        format!("DirectionalDepth(depth={:?})", self.depth.depth)
    }
}

/// Whether the bodies meet at their poses; converts to a bool.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Intersection {
    found: colltrans::Intersection,
    query: Py<Cast>,
}

answer!(Intersection("meets") of colltrans::Intersection, Cast, |it| it.found);

getters!(Intersection, |it| {
    /// bool: Whether the bodies have a common point, up to rounding error. With a minimum gap: whether their
    /// distance is at most the gap.
    meets: bool = it.found.meets;
    /// ndarray of shape (3,): The unit vector from the centre of the moving body to that of the fixed one, along
    /// which a cast decided the answer; x if the centres coincide.
    direction(py): Vector<'py> = row(py, it.found.evidence.direction);
    /// Contact or Grazing or Separated: The outcome of that cast.
    outcome(py): PyResult<Bound<'py, PyAny>> =
        it.found
            .evidence
            .outcome
            .object(&along(it.query.bind(py), it.found.evidence.direction)?);
});

#[pymethods]
impl Intersection {
    fn __bool__(&self) -> bool {
        self.found.meets
    }

    fn __repr__(&self) -> String {
        format!("Intersection(meets={})", if self.found.meets { "True" } else { "False" })
    }
}

/// Builds the last contact, which is the first contact of the reversed query.
fn last(py: Python<'_>, contact: colltrans::Contact, query: &Py<Cast>) -> PyResult<Contact> {
    Ok(Contact { contact, query: Py::new(py, query.get().reversed(py))? })
}

/// Builds the query along the direction that decided whether the bodies meet.
fn along<'py>(query: &Bound<'py, Cast>, direction: DVec3) -> PyResult<Bound<'py, Cast>> {
    Bound::new(query.py(), query.get().along(query.py(), direction))
}

impl Answer for Clearance {
    type Query = Cast;

    fn object<'py>(self, asked: &Bound<'py, Cast>) -> PyResult<Bound<'py, PyAny>> {
        let (py, query) = (asked.py(), asked.clone().unbind());
        match self {
            Self::Blocked { distance, contact } => object(py, Blocked { distance, contact, query }),
            Self::Free(FreeReason::Slides(grazing)) => object(py, Slides { grazing, query }),
            Self::Free(FreeReason::Behind(contact)) => object(py, Behind { contact, query }),
            Self::Free(FreeReason::Separated(of)) => {
                let outcome: Outcome = Outcome::Separated(of);
                outcome.object(asked)
            }
            Self::Overlapping(ends) => object(py, Overlapping { ends, query }),
        }
    }

    fn record(&self, query: &Bound<'_, Cast>) -> PyResult<Record> {
        query.get().with(|cast| ClearanceRecord::from_clearance(self, cast).into())
    }

    fn proof(&self, query: &Bound<'_, Cast>) -> PyResult<String> {
        query.get().with(|cast| ProofFile::of_clearance(cast, self).to_json())
    }
}

impl Answer for colltrans::DirectionalDepth {
    type Query = Cast;

    fn object<'py>(self, query: &Bound<'py, Cast>) -> PyResult<Bound<'py, PyAny>> {
        object(query.py(), DirectionalDepth { depth: self, query: query.clone().unbind() })
    }

    fn record(&self, query: &Bound<'_, Cast>) -> PyResult<Record> {
        self.clearance.record(query)
    }

    fn proof(&self, query: &Bound<'_, Cast>) -> PyResult<String> {
        self.clearance.proof(query)
    }
}

impl Answer for colltrans::Intersection {
    type Query = Cast;

    fn object<'py>(self, query: &Bound<'py, Cast>) -> PyResult<Bound<'py, PyAny>> {
        object(query.py(), Intersection { found: self, query: query.clone().unbind() })
    }

    fn record(&self, query: &Bound<'_, Cast>) -> PyResult<Record> {
        let CentralCast { direction, outcome, .. } = self.evidence;
        let record = outcome.record(&along(query, direction)?)?;
        Ok(record.with_direction(coordinates(direction)))
    }

    fn proof(&self, query: &Bound<'_, Cast>) -> PyResult<String> {
        let CentralCast { direction, outcome, .. } = self.evidence;
        outcome.proof(&along(query, direction)?)
    }
}
