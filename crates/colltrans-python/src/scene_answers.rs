//! Answers about one body among many. Each holds its query, from which a proof is built on request.

use std::path::PathBuf;

use colltrans::glam::DVec3;
use colltrans::{ByKind, Clearance, Nearby, ProofFile, SceneClearance, SceneQuery};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyIterator, PyTuple};

use crate::answer::save;
use crate::arrays::{Vector, row};
use crate::errors::OrRaise;
use crate::frozen::getters;
use crate::number::{middle, number};
use crate::scene::{SceneRequest, with_min_gap};

/// Defines the methods for the proof, which all answers share.
macro_rules! proven {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            /// Returns the proof with everything that it refers to, as text.
            ///
            /// The text is a file of ``--save-proof`` with ``--scene``, which ``colltrans verify`` and
            /// ``python -m colltrans.check`` check. The query runs again to build it, without the limit
            /// ``before``. In the file the obstacles are numbered from 0 by their position, without ignored
            /// ones.
            ///
            /// Returns
            /// -------
            /// str
            ///
            /// Raises
            /// ------
            /// CaseError
            ///     Obstacles were added, moved or removed since, or one is a union of solids that was shrunk
            ///     or grown as a whole.
            fn proof_json(&self, py: Python<'_>) -> PyResult<String> {
                Ok(self.proof(py)?.to_json())
            }

            /// Writes :meth:`proof_json` to a file.
            ///
            /// Parameters
            /// ----------
            /// path : str or os.PathLike
            fn save_proof(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
                save(&path, self.proof_json(py)?)
            }

            /// Checks the proof: every obstacle, by its bounding box or by its own proof.
            ///
            /// Raises
            /// ------
            /// CertificateError
            ///     The proof does not hold; the message names the failed condition.
            fn verify(&self, py: Python<'_>) -> PyResult<()> {
                let proof = self.proof(py)?;
                py.detach(|| proof.check().map(drop)).or_raise()
            }
        }
    };
}

/// The nearest of many obstacles.
#[pyclass(frozen, module = "colltrans.scenes")]
pub(crate) struct NearestObstacle {
    pub(crate) found: colltrans::Nearest,
    pub(crate) asked: SceneRequest,
}

proven!(NearestObstacle);

impl NearestObstacle {
    fn proof(&self, py: Python<'_>) -> PyResult<ProofFile> {
        self.asked.proof(py, ProofFile::of_nearest)
    }
}

getters!(NearestObstacle, |it| {
    /// int: The number of the nearest obstacle.
    obstacle: u64 = it.found.obstacle.0;
    /// float: A lower bound of the distance to all obstacles.
    lower: f64 = it.found.lower;
    /// float: An upper bound of the distance to this obstacle.
    upper: f64 = it.found.distance.upper();
    /// ndarray of shape (3,): The point of the moving body that is nearest to the obstacle, in the world.
    on_moving(py): Vector<'py> = row(py, it.found.distance.on_moving());
    /// ndarray of shape (3,): The point of the obstacle that is nearest to the moving body.
    on_fixed(py): Vector<'py> = row(py, it.found.distance.on_fixed());
    /// ndarray of shape (3,) or None: Unit vector in the world, from the moving body to the obstacle; None if
    /// they meet or are closer than rounding errors.
    normal(py): Option<Vector<'py>> = it.found.distance.normal().map(|normal| row(py, normal));
});

number!(NearestObstacle, f64, |it| middle(it.found.lower, it.found.distance.upper()),
    /// float: The middle of both bounds.
);

#[pymethods]
impl NearestObstacle {
    fn __repr__(&self) -> String {
        let (obstacle, lower, upper) = (self.obstacle(), self.lower(), self.upper());
        format!("NearestObstacle(obstacle={obstacle}, lower={lower:?}, upper={upper:?})")
    }
}

/// The obstacles that are at most a length away. It unpacks into both lists.
#[pyclass(frozen, module = "colltrans.scenes")]
pub(crate) struct NearbyObstacles {
    pub(crate) found: Nearby,
    pub(crate) length: f64,
    pub(crate) asked: SceneRequest,
}

proven!(NearbyObstacles);

impl NearbyObstacles {
    fn proof(&self, py: Python<'_>) -> PyResult<ProofFile> {
        self.asked.proof(py, |among| ProofFile::of_within(among, self.length).map(Some))
    }
}

getters!(NearbyObstacles, |it| {
    /// list of int: The obstacles at most the length away, in the order in which they were added.
    closer: Vec<u64> = it.found.closer.iter().map(|(id, _)| id.0).collect();
    /// list of int: The obstacles for which rounding cannot decide.
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

/// How far a body can move among obstacles, and the obstacle that stops it.
#[pyclass(frozen, module = "colltrans.scenes")]
pub(crate) struct ObstacleClearance {
    pub(crate) found: SceneClearance,
    pub(crate) direction: DVec3,
    pub(crate) min_gap: f64,
    pub(crate) asked: SceneRequest,
}

proven!(ObstacleClearance);

impl ObstacleClearance {
    fn proof(&self, py: Python<'_>) -> PyResult<ProofFile> {
        let of = |among: &SceneQuery<'_>| {
            ProofFile::of_scene_clearance(&with_min_gap(among, self.min_gap)?, self.direction)
                .map(Some)
        };
        self.asked.proof(py, of)
    }
}

/// Returns the name of the outcome.
pub(crate) fn outcome_of(found: &SceneClearance) -> &'static str {
    match (found.stop, found.safe_translation()) {
        (_, None) => "overlapping",
        (Some(_), _) => "blocked",
        (None, _) => "free",
    }
}

/// Returns an upper bound of the translation at which the body is stopped.
pub(crate) fn upper_of(found: &SceneClearance) -> f64 {
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
    /// int or None: The obstacle that stops the body, or that overlaps it.
    obstacle: Option<u64> = it.found.stop.map(|(id, _)| id.0);
    /// float or None: How far the body can move past all obstacles, rounded down, in multiples of the
    /// direction. If nothing stops it, this is infinite, or at most the end of the query, ``before``. None if the
    /// body overlaps an obstacle at the start.
    distance: Option<f64> = it.found.safe_translation();
    /// float or None: The :attr:`distance`, which is proven.
    lower: Option<f64> = it.found.safe_translation();
    /// float: An upper bound of the translation at which the body is stopped; infinite if nothing stops it,
    /// NaN if it overlaps an obstacle.
    upper: f64 = upper_of(&it.found);
    /// ndarray of shape (3,) or None: Unit normal of the contact, from the moving body to the obstacle; None
    /// unless the body is blocked.
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

number!(ObstacleClearance, Option<f64>, |it| it.found.safe_translation(),
    /// float or None: The free travel, :attr:`distance`. ``float`` raises a TypeError if it is None.
);

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
