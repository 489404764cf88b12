//! Answers about all translations: first contact, last contact, or separation.

use colltrans::record::{CastRecord, Record};
use colltrans::{ContactRange as Range, Outcome, ProofFile};
use pyo3::prelude::*;

use crate::answer::{Answer, answer, object};
use crate::arrays::{Vector, coordinates, row};
use crate::certificate::{Certificate, Separation};
use crate::errors::{OrRaise, error};
use crate::features::{Features, Steps};
use crate::frozen::{Reduced, getters, match_args, read, reduced, written};
use crate::number::number;
use crate::pose::Pose;
use crate::query::Cast;

/// The first contact of the bodies along the direction.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Contact {
    pub(crate) contact: colltrans::Contact,
    pub(crate) query: Py<Cast>,
}

answer!(Contact("translation", "normal", "point") of Outcome, Cast, |it| Outcome::Contact(it.contact));

getters!(Contact, |it| {
    /// float: The collision translation, in multiples of the direction. If it is negative, the contact is
    /// behind the body, or the bodies overlap at the start.
    translation: f64 = it.contact.translation;
    /// float: A proven lower bound of the translation.
    lower: f64 = it.contact.certificate.lower;
    /// float: A proven upper bound of the translation; infinite if the contact is not proven.
    upper: f64 = it.contact.certificate.upper;
    /// ndarray of shape (3,): Unit contact normal in the world, from the moving body to the fixed one.
    normal(py): Vector<'py> = row(py, it.contact.normal);
    /// ndarray of shape (3,): The contact point, in the world.
    point(py): PyResult<Vector<'py>> = {
        let points = it.query.get().with(|cast| it.contact.witness_points(cast))?;
        Ok(row(py, points.on_fixed))
    };
    /// ndarray of shape (3,): The contact point on the moving body at its start pose, in the world.
    point_at_start(py): PyResult<Vector<'py>> = {
        let points = it.query.get().with(|cast| it.contact.witness_points(cast))?;
        Ok(row(py, points.on_moving))
    };
    /// Features: The vertex, edge or face of each body in the contact plane.
    features: PyResult<Features> = it.query.get().with(|cast| Features::from_contact(&it.contact, cast));
    /// Certificate: Both bounds with their proofs.
    certificate(py): Certificate =
        Certificate { proof: it.contact.certificate, query: it.query.clone_ref(py) };
    /// Pose: The pose of the moving body just before this contact; rounding never moves it beyond.
    pose_before: PyResult<Pose> =
        it.query.get().with(|cast| it.contact.pose_before(cast))?.or_raise().map(Pose);
    /// str: The solver of the query, with ``auto`` replaced by its choice.
    solver: &'static str = it.contact.solver.name();
    /// Steps: Number of steps of the search.
    steps: Steps = Steps(it.contact.steps);
});

number!(Contact, f64, |it| it.contact.translation,
    /// float: The :attr:`translation`.
);

#[pymethods]
impl Contact {
    fn __repr__(&self) -> String {
        contact_text(&self.contact)
    }
}

pub(crate) fn contact_text(contact: &colltrans::Contact) -> String {
    let (t, n) = (contact.translation, coordinates(contact.normal));
    format!("Contact(translation={t:?}, normal={n:?})")
}

/// Grazing bodies: their shadows overlap by at most the graze tolerance, so that they slide along each other.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Grazing {
    pub(crate) grazing: colltrans::Grazing,
    pub(crate) query: Py<Cast>,
}

answer!(Grazing("overlap", "contact") of Outcome, Cast, |it| Outcome::Grazing(it.grazing));

getters!(Grazing, |it| {
    /// float: The overlap of the shadows, a length. It is negative if they may be disjoint by less than
    /// rounding errors.
    overlap: f64 = it.grazing.overlap;
    /// float: A proven lower bound of the translation at which the bodies meet.
    lower: f64 = it.grazing.contact.certificate.lower;
    /// float: A proven upper bound of that translation; infinite if the bodies may pass each other.
    upper: f64 = it.grazing.contact.certificate.upper;
    /// ndarray of shape (3,): Unit vector of the world, perpendicular to the direction, from the moving
    /// body's shadow to the fixed one's.
    separating_direction(py): Vector<'py> = row(py, it.grazing.separating_direction);
    /// Contact: The contact that results if the overlap is real.
    contact(py): Contact = Contact { contact: it.grazing.contact, query: it.query(py) };
});

number!(Grazing, f64, |it| it.grazing.contact.translation,
    /// float: The translation of the contact that results if the overlap is real.
);

#[pymethods]
impl Grazing {
    fn __repr__(&self) -> String {
        grazing_text(&self.grazing)
    }
}

pub(crate) fn grazing_text(grazing: &colltrans::Grazing) -> String {
    let contact = contact_text(&grazing.contact);
    format!("Grazing(overlap={:?}, contact={contact})", grazing.overlap)
}

/// The bodies never meet along the direction.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Separated {
    pub(crate) separated: colltrans::Separated,
    pub(crate) query: Py<Cast>,
}

answer!(Separated("margin", "normal") of Outcome, Cast, |it| Outcome::Separated(it.separated));

getters!(Separated, |it| {
    /// float: A lower bound of the distance of the shadows, a length.
    margin: f64 = it.separated.certificate.margin;
    /// ndarray of shape (3,): Unit normal of a plane between them, parallel to the direction.
    normal(py): Vector<'py> = row(py, it.separated.certificate.normal);
    /// Separation: The proof.
    certificate(py): Separation =
        Separation { proof: it.separated.certificate, query: it.query.clone_ref(py) };
    /// float: The free travel of the moving body: infinite.
    distance: f64 = f64::INFINITY;
    /// float: Infinite.
    lower: f64 = f64::INFINITY;
    /// float: Infinite.
    upper: f64 = f64::INFINITY;
    /// str: The solver of the query, with ``auto`` replaced by its choice.
    solver: &'static str = it.separated.solver.name();
    /// Steps: Number of steps of the search.
    steps: Steps = Steps(it.separated.steps);
});

number!(Separated, f64, |_| f64::INFINITY,
    /// float: Infinite, because the bodies never meet.
);

#[pymethods]
impl Separated {
    fn __repr__(&self) -> String {
        format!("Separated(margin={:?})", self.separated.certificate.margin)
    }
}

/// All translations at which the bodies meet, with the contacts at both ends.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct ContactRange {
    range: Range,
    query: Py<Cast>,
}

answer!(ContactRange("interval") of Range, Cast, |it| it.range);

getters!(ContactRange, |it| {
    /// tuple of float: First and last translation, in multiples of the direction.
    interval: (f64, f64) = {
        let [enter, exit] = it.range.interval().unwrap_or([f64::NAN; 2]);
        (enter, exit + 0.0)
    };
    /// float: A proven lower bound of the first translation.
    lower: f64 = it.range.bounds().map_or(f64::NAN, |[first, _]| first.lower);
    /// float: A proven upper bound of the first translation.
    upper: f64 = it.range.bounds().map_or(f64::NAN, |[first, _]| first.upper);
    /// Contact or Grazing: The first contact along the direction.
    first(py): PyResult<Bound<'py, PyAny>> = {
        let first: Outcome = match it.range {
            Range::Contact { first, .. } => Outcome::Contact(first),
            Range::Grazing { first, .. } => Outcome::Grazing(first),
            Range::Separated(separated) => Outcome::Separated(separated),
        };
        first.object(it.query.bind(py))
    };
    /// LastContact: The last contact along the direction.
    last(py): PyResult<LastContact> = {
        let last = match it.range {
            Range::Contact { last, .. } => Outcome::Contact(last),
            Range::Grazing { last, .. } => Outcome::Grazing(last),
            Range::Separated(separated) => Outcome::Separated(separated),
        };
        LastContact::from_outcome(py, last, &it.query)
    };
});

number!(ContactRange, f64, |it| it.interval().0,
    /// float: The first translation of the :attr:`interval`.
);

#[pymethods]
impl ContactRange {
    fn __repr__(&self) -> String {
        format!("ContactRange(interval={:?})", self.interval())
    }
}

/// The last contact along the direction. The bodies are apart beyond it.
///
/// ``turned`` is the first contact of the reversed query, which has the proof.
#[pyclass(frozen, module = "colltrans.answers")]
pub(crate) struct LastContact {
    /// The outcome of the reversed query.
    found: Outcome,
    query: Py<Cast>,
    turned: Py<Cast>,
}

match_args!(LastContact("translation", "normal", "point"));

impl LastContact {
    /// Builds a last contact from the outcome of the reversed query.
    pub(crate) fn from_outcome(py: Python<'_>, found: Outcome, query: &Py<Cast>) -> PyResult<Self> {
        let turned = Py::new(py, query.get().reversed(py))?;
        Ok(Self { found, query: query.clone_ref(py), turned })
    }

    fn contact(&self) -> PyResult<&colltrans::Contact> {
        match &self.found {
            Outcome::Contact(contact) => Ok(contact),
            Outcome::Grazing(grazing) => Ok(&grazing.contact),
            Outcome::Separated(_) => Err(error("CaseError", "separated bodies have no contact")),
        }
    }
}

getters!(LastContact, |it| {
    /// float: The translation, in multiples of the direction.
    translation: PyResult<f64> = Ok(it.contact()?.exit().value + 0.0);
    /// float: A proven lower bound of the translation.
    lower: PyResult<f64> = Ok(it.contact()?.exit().lower + 0.0);
    /// float: A proven upper bound of the translation. The bodies never meet beyond it.
    upper: PyResult<f64> = Ok(it.contact()?.exit().upper + 0.0);
    /// ndarray of shape (3,): Unit contact normal in the world, from the moving body to the fixed one.
    normal(py): PyResult<Vector<'py>> = Ok(row(py, it.contact()?.normal));
    /// ndarray of shape (3,): The contact point, in the world.
    point(py): PyResult<Vector<'py>> = {
        let contact = it.contact()?;
        Ok(row(py, it.turned.get().with(|cast| contact.witness_points(cast))?.on_fixed))
    };
    /// Features: The vertex, edge or face of each body in the contact plane.
    features: PyResult<Features> = {
        let contact = it.contact()?;
        it.turned.get().with(|cast| Features::from_contact(contact, cast))
    };
    /// Cast: The query.
    query(py): Py<Cast> = it.query.clone_ref(py);
    /// Contact or Grazing: The first contact of the reversed query, with its proof. Its translations have the
    /// opposite sign.
    turned(py): PyResult<Bound<'py, PyAny>> = it.found.object(it.turned.bind(py));
});

number!(LastContact, f64, |it| it.translation()?,
    /// float: The :attr:`translation`.
);

#[pymethods]
impl LastContact {
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py, (Py<Cast>, String)>> {
        reduced::<Self, _>(py, (self.query(py), written(&self.found)?))
    }

    #[staticmethod]
    fn _of(py: Python<'_>, query: Py<Cast>, text: &str) -> PyResult<Self> {
        Self::from_outcome(py, read(text)?, &query)
    }

    fn __repr__(&self) -> PyResult<String> {
        let (t, n) = (self.translation()?, coordinates(self.contact()?.normal));
        Ok(format!("LastContact(translation={t:?}, normal={n:?})"))
    }
}

impl Answer for Outcome {
    type Query = Cast;

    fn object<'py>(self, asked: &Bound<'py, Cast>) -> PyResult<Bound<'py, PyAny>> {
        let (py, query) = (asked.py(), asked.clone().unbind());
        match self {
            Self::Contact(contact) => object(py, Contact { contact, query }),
            Self::Grazing(grazing) => object(py, Grazing { grazing, query }),
            Self::Separated(separated) => object(py, Separated { separated, query }),
        }
    }

    fn record(&self, query: &Bound<'_, Cast>) -> PyResult<Record> {
        query.get().with(|cast| CastRecord::of_outcome(self, cast).into())
    }

    fn proof(&self, query: &Bound<'_, Cast>) -> PyResult<String> {
        query.get().with(|cast| ProofFile::of_outcome(cast, self).to_json())
    }
}

impl Answer for Range {
    type Query = Cast;

    fn object<'py>(self, query: &Bound<'py, Cast>) -> PyResult<Bound<'py, PyAny>> {
        if let Self::Separated(separated) = self {
            let outcome: Outcome = Outcome::Separated(separated);
            return outcome.object(query);
        }
        object(query.py(), ContactRange { range: self, query: query.clone().unbind() })
    }

    fn record(&self, query: &Bound<'_, Cast>) -> PyResult<Record> {
        query.get().with(|cast| CastRecord::of_range(self, cast).into())
    }

    fn proof(&self, query: &Bound<'_, Cast>) -> PyResult<String> {
        query.get().with(|cast| ProofFile::of_range(cast, self).to_json())
    }
}
