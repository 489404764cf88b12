//! Answers about two bodies at fixed poses: distance, depth, comparison of the distance with a length.

use std::sync::OnceLock;

use colltrans::glam::DVec3;
use colltrans::record::{DistanceRecord, PairAnswer, PairQuestion, Record};
use colltrans::solid::{SolidDepth, SolidSteps};
use colltrans::solid::{SolidPair as _, SolidPenetration as _};
use colltrans::{ProofFile, Solid};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::answer::{Answer, answer, object};
use crate::arrays::{Vector, coordinates, row};
use crate::errors::{OrRaise, error, other_bodies_error};
use crate::features::{Feature, Features, Steps};
use crate::frozen::getters;
use crate::number::{middle, number};
use crate::pair::{Of, Pair};

type DistanceOf = Of<colltrans::Distance, colltrans::Distance<Solid>>;

/// The answer whether the distance is less than a length.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(crate) struct WithinOf {
    length: f64,
    found: Of<(colltrans::Within, colltrans::Steps), (colltrans::Within<Solid>, SolidSteps)>,
}

/// The distance of two bodies and their nearest points: ``lower <= true distance <= upper``.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Distance {
    found: DistanceOf,
    query: Py<Pair>,
}

answer!(Distance("lower", "upper") of DistanceOf, Pair, |it| it.found);

/// Evaluates an expression for convex bodies or for solids.
macro_rules! either {
    ($of:expr, $found:ident => $value:expr) => {
        match &$of {
            Of::Convex($found) => $value,
            Of::Solids($found) => $value,
        }
    };
}

getters!(Distance, |it| {
    /// float: A lower bound of the distance; 0 if the bodies meet or are closer than rounding errors.
    lower: f64 = either!(it.found, found => found.lower);
    /// float: An upper bound of the distance; 0 if the bodies are proven to meet.
    upper: f64 = either!(it.found, found => found.upper);
    /// ndarray of shape (3,): The point of the moving body that is nearest to the fixed one, in the world.
    on_moving(py): Vector<'py> = row(py, either!(it.found, found => found.on_moving));
    /// ndarray of shape (3,): The point of the fixed body that is nearest to the moving one, in the world.
    on_fixed(py): Vector<'py> = row(py, either!(it.found, found => found.on_fixed));
    /// ndarray of shape (3,) or None: Unit normal in the world, from the moving body to the fixed one; None
    /// if ``lower`` is 0.
    normal(py): Option<Vector<'py>> =
        either!(it.found, found => found.normal).map(|normal| row(py, normal));
    /// Features or None: The nearest feature of each body; None if ``lower`` is 0.
    features: PyResult<Option<Features>> = {
        let query = it.query.get();
        let features = either!(it.found, found => found.features);
        let Some(colltrans::Features { moving, fixed }) = features else { return Ok(None) };
        either!(query.asked()?, pair => Ok(Some(Features {
            moving: Feature::from_feature(moving, pair.moving()),
            fixed: Feature::from_feature(fixed, pair.fixed()),
        })))
    };
    /// Steps or None: Number of steps of the search; None for solids.
    steps: Option<Steps> = match it.found {
        Of::Convex(found) => Some(Steps(found.steps)),
        Of::Solids(_) => None,
    };
});

number!(Distance, f64, |it| either!(it.found, found => middle(found.lower, found.upper)),
    /// float: The middle of both bounds.
);

#[pymethods]
impl Distance {
    /// Checks the proof with the bodies alone. Between solids the query runs again to build the proof.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        proof_of(&self.found, self.query.bind(py))?.check().map(drop).or_raise()
    }

    fn __repr__(&self) -> String {
        let [lower, upper] = either!(self.found, found => found.bounds());
        format!("Distance(lower={lower:?}, upper={upper:?})")
    }
}

/// The shortest translation that separates two convex bodies: ``lower <= true depth <= upper``.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Depth {
    depth: colltrans::Depth,
    query: Py<Pair>,
}

answer!(Depth("lower", "upper", "direction") of PairAnswer, Pair, |it| PairAnswer::Depth(it.depth.clone()));

getters!(Depth, |it| {
    /// float: After any shorter translation the bodies overlap; 0 if they are apart or touch, or if both are
    /// polyhedra in one plane.
    lower: f64 = it.depth.lower;
    /// float: After a translation of this length along ``direction`` they do not overlap; 0 if they are
    /// apart.
    upper: f64 = it.depth.upper;
    /// ndarray of shape (3,): Unit vector in the world, along which the moving body leaves the fixed one.
    direction(py): Vector<'py> = row(py, it.depth.direction);
    /// ndarray of shape (3,): The translation of the moving body that separates the bodies.
    translation(py): Vector<'py> = row(py, it.depth.translation());
    /// Steps: Number of steps of the search.
    steps: Steps = Steps(it.depth.steps);
});

number!(Depth, f64, |it| middle(it.depth.lower, it.depth.upper),
    /// float: The middle of both bounds.
);

#[pymethods]
impl Depth {
    /// Checks the proof with the bodies alone.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    fn verify(&self) -> PyResult<()> {
        match self.query.get().asked()? {
            Of::Convex(pair) => pair.verify(&self.depth).or_raise().map(|_| ()),
            Of::Solids(_) => Err(error("CertificateError", "the bodies are solids")),
        }
    }

    fn __repr__(&self) -> String {
        let colltrans::Depth { lower, upper, direction, .. } = &self.depth;
        let direction = coordinates(*direction);
        format!("Depth(lower={lower:?}, upper={upper:?}, direction={direction:?})")
    }
}

/// The overlap of two solids, measured by the tolerance that removes it.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct OverlapDepth {
    depth: colltrans::solid::OverlapDepth,
    query: Py<Pair>,
    /// Bounds of the shortest translation that separates the solids, computed on first access.
    translated: OnceLock<SolidDepth>,
}

impl OverlapDepth {
    /// Returns bounds of the shortest translation that separates the solids, and the translation.
    fn translated(&self) -> PyResult<&SolidDepth> {
        if let Some(found) = self.translated.get() {
            return Ok(found);
        }
        let query = self.query.get();
        let Of::Solids(pair) = query.asked()? else { return Err(other_bodies_error()) };
        let found = Python::attach(|py| py.detach(|| pair.depth())).or_raise()?;
        Ok(self.translated.get_or_init(|| found))
    }
}

answer!(OverlapDepth("meets", "least_tolerance") of PairAnswer, Pair, |it| PairAnswer::OverlapDepth(it.depth));

getters!(OverlapDepth, |it| {
    /// bool: Whether the solids have a common point, decided exactly.
    meets: bool = it.depth.meets;
    /// float or None: The smallest tolerance at which the solids no longer overlap, rounded up. It is 0 if they
    /// do not overlap. It is None if a solid vanishes before the overlap ends, or if overlapping solids have open
    /// shells.
    least_tolerance: Option<f64> = it.depth.least_tolerance;
    /// float: A lower bound of the length of the shortest translation that separates the solids; 0 if they do not
    /// overlap. Both bounds and the translation are computed on first access.
    lower: PyResult<f64> = Ok(it.translated()?.lower);
    /// float: An upper bound of this length.
    upper: PyResult<f64> = Ok(it.translated()?.upper);
    /// ndarray of shape (3,): Unit vector in the world, along which the moving body leaves the fixed one; 0 if they do
    /// not overlap.
    direction(py): PyResult<Vector<'py>> = Ok(row(py, it.translated()?.direction));
    /// ndarray of shape (3,): The shortest translation of the moving body that was found to separate the solids. Its
    /// length is at most ``upper``, and a shorter one may exist.
    translation(py): PyResult<Vector<'py>> = Ok(row(py, it.translated()?.translation));
});

number!(OverlapDepth, f64, |it| middle(it.translated()?.lower, it.translated()?.upper),
    /// float: The middle of both bounds.
);

#[pymethods]
impl OverlapDepth {
    fn __repr__(&self) -> String {
        let (meets, depth) = (self.depth.meets, self.depth.least_tolerance);
        let meets = if meets { "True" } else { "False" };
        let depth = depth.map_or("None".into(), |depth| format!("{depth:?}"));
        format!("OverlapDepth(meets={meets}, least_tolerance={depth})")
    }
}

/// Whether two bodies are closer than a length, with a bound of their distance that proves it.
///
/// There are three outcomes, in ``closer``: True, False, and None if the length lies between the bounds of the distance,
/// which differ by a few rounding errors. ``bool`` is False only if the distance is proven to exceed the length, so that
/// the undecided case counts as closer.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Within {
    found: WithinOf,
    query: Py<Pair>,
}

answer!(Within("closer", "lower", "upper") of WithinOf, Pair, |it| it.found);

impl Within {
    fn told(&self, py: Python<'_>) -> PyResult<DistanceRecord> {
        self.found.told(self.query.bind(py))
    }
}

getters!(Within, |it| {
    /// float: The length that is compared with the distance.
    length: f64 = it.found.length;
    /// bool or None: Whether the distance is at most the length; None if the length is between the bounds of
    /// the distance, which differ by a few rounding errors.
    closer: Option<bool> = {
        use colltrans::Within::{Closer, Farther, Undecided};
        either!(it.found.found, found => match found.0 {
            Closer(_) => Some(true),
            Farther(_) => Some(false),
            Undecided(_) => None,
        })
    };
    /// float or None: A lower bound of the distance, if the search computed one.
    lower(py): PyResult<Option<f64>> = Ok(it.told(py)?.lower);
    /// float or None: An upper bound of the distance, if the search computed one.
    upper(py): PyResult<Option<f64>> = Ok(it.told(py)?.upper);
    /// list of two ndarray, or None: Points of the moving and of the fixed body, in the world, at the distance
    /// ``upper``; None if the search found only a lower bound.
    points(py): PyResult<Option<[Vector<'py>; 2]>> = {
        let points = it.told(py)?.points;
        Ok(points.map(|points| points.map(|point| row(py, DVec3::from_array(point)))))
    };
    /// Steps or None: Number of steps of the search; None for solids.
    steps: Option<Steps> = match it.found.found {
        Of::Convex((_, steps)) => Some(Steps(steps)),
        Of::Solids(_) => None,
    };
});

#[pymethods]
impl Within {
    /// Checks the proof with the bodies alone. Between solids the query runs again to build the proof.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        within_proof(&self.found, self.query.bind(py))?.check().map(drop).or_raise()
    }

    fn __bool__(&self) -> bool {
        self.closer().unwrap_or(true)
    }

    fn __repr__(&self) -> String {
        let closer = match self.closer() {
            Some(true) => "True",
            Some(false) => "False",
            None => "None",
        };
        format!("Within(closer={closer}, length={:?})", self.found.length)
    }
}

fn proof_of(found: &DistanceOf, query: &Bound<'_, Pair>) -> PyResult<ProofFile> {
    match (found, query.get().asked()?) {
        (Of::Convex(distance), Of::Convex(pair)) => Ok(ProofFile::of_distance(&pair, distance)),
        _ => query.get().solid_proof(PairQuestion::Distance),
    }
}

fn within_proof(of: &WithinOf, query: &Bound<'_, Pair>) -> PyResult<ProofFile> {
    match (&of.found, query.get().asked()?) {
        (Of::Convex((within, _)), Of::Convex(pair)) => Ok(ProofFile::of_distance(&pair, within)),
        _ => query.get().solid_proof(PairQuestion::Within(of.length)),
    }
}

impl Answer for DistanceOf {
    type Query = Pair;

    fn object<'py>(self, query: &Bound<'py, Pair>) -> PyResult<Bound<'py, PyAny>> {
        object(query.py(), Distance { found: self, query: query.clone().unbind() })
    }

    fn record(&self, query: &Bound<'_, Pair>) -> PyResult<Record> {
        match (self, query.get().asked()?) {
            (Self::Convex(found), Of::Convex(pair)) => {
                Ok(DistanceRecord::from_distance(found, &pair).into())
            }
            (Self::Solids(found), Of::Solids(pair)) => {
                Ok(DistanceRecord::of_solids(found, &pair).into())
            }
            _ => Err(other_bodies_error()),
        }
    }

    fn proof(&self, query: &Bound<'_, Pair>) -> PyResult<String> {
        Ok(proof_of(self, query)?.to_json())
    }
}

impl WithinOf {
    fn told(&self, query: &Bound<'_, Pair>) -> PyResult<DistanceRecord> {
        match (&self.found, query.get().asked()?) {
            (Of::Convex((answer, steps)), Of::Convex(pair)) => {
                Ok(DistanceRecord::of_within(answer, *steps, &pair))
            }
            (Of::Solids((answer, _)), Of::Solids(pair)) => {
                DistanceRecord::of_solids_within(answer, &pair).or_raise()
            }
            _ => Err(other_bodies_error()),
        }
    }
}

impl Answer for WithinOf {
    type Query = Pair;

    fn object<'py>(self, query: &Bound<'py, Pair>) -> PyResult<Bound<'py, PyAny>> {
        object(query.py(), Within { found: self, query: query.clone().unbind() })
    }

    fn record(&self, query: &Bound<'_, Pair>) -> PyResult<Record> {
        Ok(self.told(query)?.into())
    }

    fn proof(&self, query: &Bound<'_, Pair>) -> PyResult<String> {
        Ok(within_proof(self, query)?.to_json())
    }
}

/// A depth of convex bodies or of solids.
impl Answer for PairAnswer {
    type Query = Pair;

    fn object<'py>(self, query: &Bound<'py, Pair>) -> PyResult<Bound<'py, PyAny>> {
        let (py, asked) = (query.py(), query.clone().unbind());
        match self {
            Self::Depth(depth) => object(py, Depth { depth, query: asked }),
            Self::OverlapDepth(depth) => {
                object(py, OverlapDepth { depth, query: asked, translated: OnceLock::new() })
            }
            Self::Distance(found) => DistanceOf::Convex(found).object(query),
            Self::Within { .. } => Err(other_bodies_error()),
        }
    }

    fn record(&self, query: &Bound<'_, Pair>) -> PyResult<Record> {
        match (self, query.get().asked()?) {
            (Self::OverlapDepth(depth), Of::Solids(pair)) => {
                PairAnswer::<Solid>::OverlapDepth(*depth).record(&pair).or_raise()
            }
            (answer, Of::Convex(pair)) => Ok(answer.record(&pair)),
            _ => Err(other_bodies_error()),
        }
    }

    fn proof(&self, query: &Bound<'_, Pair>) -> PyResult<String> {
        let proof = match (self, query.get().asked()?) {
            (Self::Depth(depth), Of::Convex(pair)) => ProofFile::of_depth(&pair, depth),
            _ => query.get().solid_proof(PairQuestion::Depth)?,
        };
        Ok(proof.to_json())
    }
}

/// Computes the distance.
pub(crate) fn distance_of<'py>(query: &Bound<'py, Pair>) -> PyResult<Bound<'py, PyAny>> {
    let found: DistanceOf = Pair::ask(query, false, |pair| {
        Ok(match pair {
            Of::Convex(pair) => Of::Convex(pair.distance()?),
            Of::Solids(pair) => Of::Solids(pair.distance()?),
        })
    })?;
    found.object(query)
}

/// Computes the depth of convex bodies, or the overlap of solids.
pub(crate) fn depth_of<'py>(query: &Bound<'py, Pair>) -> PyResult<Bound<'py, PyAny>> {
    let found: PairAnswer = Pair::ask(query, true, |pair| {
        Ok(match pair {
            Of::Convex(pair) => PairAnswer::Depth(pair.depth()?),
            Of::Solids(pair) => PairAnswer::OverlapDepth(pair.overlap_depth()?),
        })
    })?;
    found.object(query)
}

/// Checks whether the bodies are closer than a length.
pub(crate) fn within_of<'py>(query: &Bound<'py, Pair>, length: f64) -> PyResult<Bound<'py, PyAny>> {
    let found = Pair::ask(query, false, move |pair| {
        Ok(match pair {
            Of::Convex(pair) => Of::Convex(pair.within_counted(length)?),
            Of::Solids(pair) => Of::Solids(pair.within_counted(length)?),
        })
    })?;
    WithinOf { length, found }.object(query)
}
