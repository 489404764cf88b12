//! Answers to bytes and back, for `pickle` and `copy`: the same bits, with what they were asked.
//!
//! Every class says what it is made of ([`saved`]), and [`restore`] makes it again. What comes back is
//! believed, as all that is pickled; a proof in it is checked by `verify` as ever.

use colltrans::solid::{SolidOptions, StartOverlap};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::answer::{Contact, ContactRange, Grazing, Separated};
use crate::certificate::{Certificate, Separation};
use crate::clearance::{Behind, Blocked, DirectionalDepth, Intersection, Overlapping, Slides};
use crate::features::{Feature, Features, Steps};
use crate::offset::{OffsetReport, ShrinkReport};
use crate::pose::Pose;
use crate::query::{Cast, Query};
use crate::solid::Piece;
use crate::solid_answer::{
    SolidBlocked, SolidCertificate, SolidContact, SolidFree, SolidOverlapping,
};
use crate::solid_cast::SolidCast;

/// What `__reduce__` returns.
pub(crate) type Saved<'py> = (Bound<'py, PyAny>, (&'static str, Bound<'py, PyTuple>));

type Counts = [u32; 4];

/// A thing of this class, made of this.
pub(crate) fn saved<'py>(
    py: Python<'py>,
    class: &'static str,
    state: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
) -> PyResult<Saved<'py>> {
    let restore = py.import("colltrans._colltrans")?.getattr("_restore")?;
    Ok((restore, (class, state.into_pyobject(py)?)))
}

/// What the library says of itself, as text that reads back as the same bits.
pub(crate) fn written(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|error| PyValueError::new_err(error.to_string()))
}

fn read<T: DeserializeOwned>(text: &str) -> PyResult<T> {
    serde_json::from_str(text).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// What was asked, and what is [`written`] of the answer.
fn with_query<T: DeserializeOwned>(state: &Bound<'_, PyTuple>) -> PyResult<(Query, T)> {
    let (query, text): (Py<Cast>, String) = state.extract()?;
    Ok((query.get().0.copy(state.py()), read(&text)?))
}

/// What :func:`pickle.loads` calls.
#[pyfunction]
#[pyo3(name = "_restore")]
pub(crate) fn restore<'py>(kind: &str, state: &Bound<'py, PyTuple>) -> PyResult<Bound<'py, PyAny>> {
    if kind.starts_with("Solid") { solids(kind, state) } else { convex(kind, state) }
}

fn object<'py, T>(of: &Bound<'py, PyTuple>, thing: T) -> PyResult<Bound<'py, PyAny>>
where
    T: pyo3::PyClass + Into<PyClassInitializer<T>>,
{
    Ok(Bound::new(of.py(), thing)?.into_any())
}

fn convex<'py>(class: &str, state: &Bound<'py, PyTuple>) -> PyResult<Bound<'py, PyAny>> {
    match class {
        "Contact" => {
            let (query, contact) = with_query(state)?;
            object(state, Contact { contact, query })
        }
        "Grazing" => object(state, grazing(state)?),
        "Separated" => {
            let (query, separated) = with_query(state)?;
            object(state, Separated { separated, query })
        }
        "ContactRange" => {
            let (interval, first, last) = state.extract()?;
            object(state, ContactRange { interval, first, last })
        }
        "Blocked" => {
            let (distance, contact) = state.extract()?;
            object(state, Blocked { distance, contact })
        }
        "Slides" => object(state, Slides { grazing: state.extract::<(_,)>()?.0 }),
        "Behind" => object(state, Behind { contact: state.extract::<(_,)>()?.0 }),
        "Overlapping" => {
            let (first, last) = state.extract()?;
            object(state, Overlapping { first, last })
        }
        "DirectionalDepth" => {
            let (depth, clearance) = state.extract()?;
            object(state, DirectionalDepth { depth, clearance })
        }
        "Intersection" => {
            let (meets, direction, outcome) = state.extract()?;
            object(state, Intersection { meets, direction, outcome })
        }
        "Certificate" => {
            let (query, proof) = with_query(state)?;
            object(state, Certificate { proof, query })
        }
        "Separation" => {
            let (query, proof) = with_query(state)?;
            object(state, Separation { proof, query })
        }
        "Steps" => {
            let (counts, started_from): (Counts, String) = state.extract()?;
            object(state, Steps::of(steps_of(counts, &started_from)?))
        }
        "Feature" => {
            let (kind, vertices): (String, Vec<u32>) = state.extract()?;
            object(state, Feature::new(kind_of(&kind)?, vertices))
        }
        "Features" => {
            let (moving, fixed) = state.extract()?;
            object(state, Features { moving, fixed })
        }
        "OffsetReport" => {
            let (farthest, vanished) = state.extract()?;
            object(state, OffsetReport(colltrans::OffsetReport { farthest, vanished }))
        }
        "ShrinkReport" => {
            let (farthest, stuck, inverted) = state.extract()?;
            object(
                state,
                ShrinkReport(colltrans::solid::ShrinkReport { farthest, stuck, inverted }),
            )
        }
        _ => Err(unknown(class)),
    }
}

fn unknown(what: &str) -> PyErr {
    PyValueError::new_err(format!("nothing of this package is called {what:?}"))
}

fn solids<'py>(class: &str, state: &Bound<'py, PyTuple>) -> PyResult<Bound<'py, PyAny>> {
    match class {
        "SolidCast" => object(state, solid_cast(state)?),
        "SolidContact" => {
            let (query, contact): (Py<SolidCast>, String) = state.extract()?;
            object(state, SolidContact { contact: read(&contact)?, query })
        }
        "SolidBlocked" => {
            let (distance, contact) = state.extract()?;
            object(state, SolidBlocked { distance, contact })
        }
        "SolidFree" => {
            let (separation, query) = state.extract()?;
            object(state, SolidFree { separation, query })
        }
        "SolidOverlapping" => {
            let (depth, place, query) = state.extract()?;
            object(state, SolidOverlapping { depth, place, query })
        }
        "SolidCertificate" => {
            let (text,): (String,) = state.extract()?;
            object(state, SolidCertificate::from_json(&text)?)
        }
        _ => Err(unknown(class)),
    }
}

fn grazing(state: &Bound<'_, PyTuple>) -> PyResult<Grazing> {
    let (contact, grazing): (Py<Contact>, String) = state.extract()?;
    Ok(Grazing { grazing: read(&grazing)?, contact })
}

fn solid_cast(state: &Bound<'_, PyTuple>) -> PyResult<SolidCast> {
    type State<'py> = ([Bound<'py, PyAny>; 2], [f64; 3], [Py<Pose>; 2], Option<f64>, bool);
    let ([moving, fixed], direction, poses, tolerance, ignores): State<'_> = state.extract()?;
    let start_overlap = if ignores { StartOverlap::Ignore } else { StartOverlap::Refuse };
    Ok(SolidCast {
        bodies: [Piece::of(&moving, "moving")?, Piece::of(&fixed, "fixed")?],
        poses: poses.map(|pose| pose.get().0),
        direction: direction.into(),
        options: SolidOptions::default()
            .with_tolerance(tolerance)
            .with_start_overlap(start_overlap),
    })
}

fn kind_of(name: &str) -> PyResult<&'static str> {
    ["vertex", "edge", "face"].into_iter().find(|kind| *kind == name).ok_or_else(|| unknown(name))
}

fn steps_of(counts: Counts, started_from: &str) -> PyResult<colltrans::Steps> {
    let mut steps = colltrans::Steps::default();
    [steps.planar_problems, steps.supports, steps.pivots, steps.iterations] = counts;
    steps.started_from = started_from.parse().map_err(|_| unknown(started_from))?;
    Ok(steps)
}
