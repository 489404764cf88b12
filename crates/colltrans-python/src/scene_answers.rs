//! Answers about one body among many, with the question they are of: from which a proof is made on request.

use std::path::PathBuf;

use colltrans::glam::DVec3;
use colltrans::{Among, ByKind, Clearance, ClearanceAmong, Nearby, ProofFile};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyIterator, PyTuple};

use crate::answer::save;
use crate::arrays::{Vector, row};
use crate::errors::OrRaise;
use crate::frozen::getters;
use crate::scene::{Asked, keeping};

/// What all have in common: their proof.
macro_rules! proven {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            /// The proof, with all that it is about, as text: the file of ``--save-proof`` with ``--among``,
            /// which ``colltrans verify`` and ``python -m colltrans.check`` check. The obstacles are asked once
            /// more for it, all along the direction whatever was asked of ``before``. In it they have the numbers
            /// of their places, from 0 on, without those that are ignored.
            ///
            /// Returns
            /// -------
            /// str
            ///
            /// Raises
            /// ------
            /// CaseError
            ///     Obstacles have come, moved or gone since, or one is a union of solids that was shrunk or
            ///     grown as a whole.
            fn proof_json(&self, py: Python<'_>) -> PyResult<String> {
                Ok(self.proof(py)?.to_json())
            }

            /// Writes :meth:`proof_json` as a file.
            ///
            /// Parameters
            /// ----------
            /// path : str or os.PathLike
            fn save_proof(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
                save(&path, self.proof_json(py)?)
            }

            /// Checks the proof: every obstacle, by its box or by what is proven of it.
            ///
            /// Raises
            /// ------
            /// CertificateError
            ///     What is not proven.
            fn verify(&self, py: Python<'_>) -> PyResult<()> {
                let proof = self.proof(py)?;
                py.detach(|| proof.check().map(drop)).or_raise()
            }
        }
    };
}

/// The nearest of many obstacles.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct NearestObstacle {
    pub(crate) found: colltrans::Nearest,
    pub(crate) asked: Asked,
}

proven!(NearestObstacle);

impl NearestObstacle {
    fn proof(&self, py: Python<'_>) -> PyResult<ProofFile> {
        self.asked.proof(py, ProofFile::of_nearest)
    }
}

getters!(NearestObstacle, |it| {
    /// int: Which one.
    obstacle: u64 = it.found.obstacle.0;
    /// float: No obstacle is nearer, rounded down.
    lower: f64 = it.found.lower;
    /// float: This one is not farther, rounded up.
    upper: f64 = it.found.distance.upper();
    /// ndarray of shape (3,): The point of the moving body that is nearest to it, in the world.
    on_moving(py): Vector<'py> = row(py, it.found.distance.on_moving());
    /// ndarray of shape (3,): Its point that is nearest to the moving body.
    on_fixed(py): Vector<'py> = row(py, it.found.distance.on_fixed());
    /// ndarray of shape (3,) or None: Unit vector in the world, from the moving body to it, where they are
    /// apart.
    normal(py): Option<Vector<'py>> = it.found.distance.normal().map(|normal| row(py, normal));
});

#[pymethods]
impl NearestObstacle {
    fn __repr__(&self) -> String {
        let (obstacle, lower, upper) = (self.obstacle(), self.lower(), self.upper());
        format!("NearestObstacle(obstacle={obstacle}, lower={lower:?}, upper={upper:?})")
    }
}

/// Which of many obstacles are closer than a length. It unpacks into both lists.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct NearbyObstacles {
    pub(crate) found: Nearby,
    pub(crate) length: f64,
    pub(crate) asked: Asked,
}

proven!(NearbyObstacles);

impl NearbyObstacles {
    fn proof(&self, py: Python<'_>) -> PyResult<ProofFile> {
        self.asked.proof(py, |among| ProofFile::of_within(among, self.length).map(Some))
    }
}

getters!(NearbyObstacles, |it| {
    /// list of int: Those that are at most the length away, in the order in which they came.
    closer: Vec<u64> = it.found.closer.iter().map(|(id, _)| id.0).collect();
    /// list of int: Those of which rounding cannot tell.
    undecided: Vec<u64> = it.found.undecided.iter().map(|(id, _)| id.0).collect();
});

#[pymethods]
impl NearbyObstacles {
    fn __len__(&self) -> usize {
        2
    }

    fn __getitem__(&self, at: usize) -> PyResult<Vec<u64>> {
        match at {
            0 => Ok(self.closer()),
            1 => Ok(self.undecided()),
            _ => Err(PyIndexError::new_err("there are two lists")),
        }
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyTuple::new(py, [self.closer(), self.undecided()])?.try_iter()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let lists = (self.closer(), self.undecided());
        match other.cast::<Self>() {
            Ok(other) => lists == (other.get().closer(), other.get().undecided()),
            Err(_) => other.extract().is_ok_and(|other: (Vec<u64>, Vec<u64>)| other == lists),
        }
    }

    fn __repr__(&self) -> String {
        format!("NearbyObstacles(closer={:?}, undecided={:?})", self.closer(), self.undecided())
    }
}

/// How far a body can move among obstacles, and what stops it.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct ObstacleClearance {
    pub(crate) found: ClearanceAmong,
    pub(crate) direction: DVec3,
    pub(crate) keep: f64,
    pub(crate) asked: Asked,
}

proven!(ObstacleClearance);

impl ObstacleClearance {
    fn proof(&self, py: Python<'_>) -> PyResult<ProofFile> {
        let of = |among: &Among<'_>| {
            ProofFile::of_scene_clearance(&keeping(among, self.keep)?, self.direction).map(Some)
        };
        self.asked.proof(py, of)
    }
}

/// Its outcome in a word.
pub(crate) fn outcome_of(found: &ClearanceAmong) -> &'static str {
    match (found.stop, found.distance()) {
        (_, None) => "overlapping",
        (Some(_), _) => "blocked",
        (None, _) => "free",
    }
}

/// By when the body is stopped for certain.
pub(crate) fn upper_of(found: &ClearanceAmong) -> f64 {
    match found.stop {
        None => f64::INFINITY,
        Some((_, ByKind::Convex(Clearance::Blocked { contact, .. }))) => contact.certificate.upper,
        Some((_, ByKind::Solid(Clearance::Blocked { contact, .. }))) => contact.translation.upper,
        Some(_) => f64::NAN,
    }
}

getters!(ObstacleClearance, |it| {
    /// str: ``"blocked"``, ``"free"`` or ``"overlapping"``.
    outcome: &'static str = outcome_of(&it.found);
    /// int or None: What stops the body, or overlaps it.
    obstacle: Option<u64> = it.found.stop.map(|(id, _)| id.0);
    /// float or None: How far the body may safely move past all obstacles, in multiples of the direction; None
    /// if it overlaps one now.
    distance: Option<f64> = it.found.distance();
    /// float: The body is stopped no later, for certain; infinite if nothing stops it, NaN if it overlaps an
    /// obstacle.
    upper: f64 = upper_of(&it.found);
    /// ndarray of shape (3,) or None: Unit normal of the contact, from the moving body to what stops it.
    normal(py): Option<Vector<'py>> = match it.found.stop {
        Some((_, ByKind::Convex(Clearance::Blocked { contact, .. }))) => {
            Some(row(py, contact.normal))
        }
        Some((_, ByKind::Solid(Clearance::Blocked { contact, .. }))) => {
            Some(row(py, contact.normal))
        }
        _ => None,
    };
});

#[pymethods]
impl ObstacleClearance {
    fn __repr__(&self) -> String {
        let or_none = |text: Option<String>| text.unwrap_or_else(|| "None".into());
        let obstacle = or_none(self.obstacle().map(|id| id.to_string()));
        let distance = or_none(self.distance().map(|distance| format!("{distance:?}")));
        let outcome = self.outcome();
        format!("ObstacleClearance('{outcome}', obstacle={obstacle}, distance={distance})")
    }
}
