//! Answers to bytes and back, for `pickle` and `copy`: the same bits, with what they were asked.
//!
//! Every class says what it is made of ([`saved`]), and [`restore`] makes it again. What comes back is
//! believed, as all that is pickled; a proof in it is checked by `verify` as ever.

use colltrans::glam::DVec3;
use colltrans::{Bounded, SolidOptions, StartOverlap, VertexPair};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::answer::{Contact, ContactRange, Grazing, Separated};
use crate::certificate::{Certificate, Separation};
use crate::clearance::{Behind, Blocked, DirectionalDepth, Intersection, Overlapping, Slides};
use crate::features::{Feature, Features, Steps};
use crate::offset::{OffsetReport, ShrinkReport};
use crate::pose::Pose;
use crate::query::{Cast, Query, solver_called_by};
use crate::solid::Piece;
use crate::solid_answer::{
    SolidBlocked, SolidCertificate, SolidContact, SolidFree, SolidOverlapping,
};
use crate::solid_cast::SolidCast;

/// What `__reduce__` returns.
pub(crate) type Saved<'py> = (Bound<'py, PyAny>, (&'static str, Bound<'py, PyTuple>));

/// A proof: normal, lower, upper, tolerance, pairs, weights.
type Proof = ([f64; 3], [f64; 3], [[u32; 2]; 3], [f64; 3]);
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
        "Contact" => object(state, contact(state)?),
        "Grazing" => object(state, grazing(state)?),
        "Separated" => object(state, separated(state)?),
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
            let (query, proof): (Py<Cast>, Proof) = state.extract()?;
            let query = query.get().0.copy(state.py());
            object(state, Certificate { proof: proof_of(proof), query })
        }
        "Separation" => {
            let (query, proof): (Py<Cast>, ([f64; 3], f64)) = state.extract()?;
            let query = query.get().0.copy(state.py());
            object(state, Separation { proof: separation_of(proof), query })
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
            object(state, ShrinkReport(colltrans::ShrinkReport { farthest, stuck, inverted }))
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
        "SolidContact" => object(state, solid_contact(state)?),
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

fn contact(state: &Bound<'_, PyTuple>) -> PyResult<Contact> {
    type State = (Py<Cast>, (f64, [f64; 3], Proof), [u32; 2], String, Counts, String);
    let (query, (translation, normal, proof), pair, solver, counts, started_from): State =
        state.extract()?;
    let contact = colltrans::Contact {
        translation,
        normal: normal.into(),
        support: pair_of(pair),
        certificate: proof_of(proof),
        solver: solver_called_by(&solver)?,
        steps: steps_of(counts, &started_from)?,
    };
    Ok(Contact { contact, query: query.get().0.copy(state.py()) })
}

fn grazing(state: &Bound<'_, PyTuple>) -> PyResult<Grazing> {
    let (contact, overlap, direction): (Py<Contact>, f64, [f64; 3]) = state.extract()?;
    let grazing = colltrans::Grazing {
        separating_direction: direction.into(),
        overlap,
        contact: contact.get().contact,
    };
    Ok(Grazing { grazing, contact })
}

fn separated(state: &Bound<'_, PyTuple>) -> PyResult<Separated> {
    type State = (Py<Cast>, ([f64; 3], f64), String, Counts, String);
    let (query, proof, solver, counts, started_from): State = state.extract()?;
    let query: Query = query.get().0.copy(state.py());
    let separated = colltrans::Separated {
        certificate: separation_of(proof),
        solver: solver_called_by(&solver)?,
        steps: steps_of(counts, &started_from)?,
    };
    Ok(Separated { separated, query })
}

fn solid_cast(state: &Bound<'_, PyTuple>) -> PyResult<SolidCast> {
    type State<'py> = ([Bound<'py, PyAny>; 2], [f64; 3], [Py<Pose>; 2], Option<f64>, bool);
    let ([moving, fixed], direction, poses, tolerance, ignores): State<'_> = state.extract()?;
    let start_overlap = if ignores { StartOverlap::Ignore } else { StartOverlap::Refuse };
    Ok(SolidCast {
        bodies: [Piece::of(&moving, "moving")?, Piece::of(&fixed, "fixed")?],
        poses: poses.map(|pose| pose.get().0),
        direction: direction.into(),
        options: SolidOptions { tolerance, start_overlap, ..SolidOptions::default() },
    })
}

fn solid_contact(state: &Bound<'_, PyTuple>) -> PyResult<SolidContact> {
    type State = (Py<SolidCast>, [[f64; 3]; 2], [[f64; 3]; 3], [(String, Vec<u32>); 2], [u32; 2]);
    let (query, numbers, vectors, [moving, fixed], triangles): State = state.extract()?;
    let [translation, shrunk_distance] =
        numbers.map(|[value, lower, upper]| Bounded { value, lower, upper });
    let [normal, point_on_moving, point_on_fixed] = vectors.map(DVec3::from_array);
    let contact = colltrans::SolidContact {
        translation,
        shrunk_distance,
        normal,
        point_on_moving,
        point_on_fixed,
        moving_feature: feature_of(&moving)?,
        fixed_feature: feature_of(&fixed)?,
        triangles,
    };
    Ok(SolidContact { contact, query })
}

fn feature_of((kind, numbers): &(String, Vec<u32>)) -> PyResult<colltrans::Feature> {
    match (&**kind, &**numbers) {
        ("vertex", &[v]) => Ok(colltrans::Feature::Vertex(v)),
        ("edge", &[a, b]) => Ok(colltrans::Feature::Edge([a, b])),
        ("face", &[face]) => Ok(colltrans::Feature::Face(face)),
        _ => Err(unknown(kind)),
    }
}

fn kind_of(name: &str) -> PyResult<&'static str> {
    ["vertex", "edge", "face"].into_iter().find(|kind| *kind == name).ok_or_else(|| unknown(name))
}

fn pair_of([moving, fixed]: [u32; 2]) -> VertexPair {
    VertexPair { moving, fixed }
}

pub(crate) fn proof_parts(proof: &colltrans::Certificate) -> Proof {
    let bounds = [proof.lower, proof.upper, proof.rounding];
    let pairs = proof.pairs.map(|pair| [pair.moving, pair.fixed]);
    (proof.normal.to_array(), bounds, pairs, proof.weights)
}

fn proof_of((normal, [lower, upper, rounding], pairs, weights): Proof) -> colltrans::Certificate {
    let pairs = pairs.map(pair_of);
    colltrans::Certificate { normal: normal.into(), lower, pairs, weights, upper, rounding }
}

fn separation_of((normal, margin): ([f64; 3], f64)) -> colltrans::Separation {
    colltrans::Separation { normal: normal.into(), margin }
}

pub(crate) fn step_parts(steps: colltrans::Steps) -> (Counts, &'static str) {
    let counts = [steps.planar_problems, steps.supports, steps.pivots, steps.iterations];
    (counts, steps.started_from.name())
}

fn steps_of(counts: Counts, started_from: &str) -> PyResult<colltrans::Steps> {
    let started_from = started_from.parse().map_err(|_| unknown(started_from))?;
    let [planar_problems, supports, pivots, iterations] = counts;
    Ok(colltrans::Steps { planar_problems, supports, pivots, iterations, started_from })
}
