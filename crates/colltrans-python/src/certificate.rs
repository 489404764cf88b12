//! Proofs of casts, and their verification.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arrays::{Vector, row, table};
use crate::errors::OrRaise;
use crate::frozen::{Reduced, getters, match_args, pickled, read, reduced, written};
use crate::query::Cast;

/// Defines pickling of a proof with its query.
macro_rules! of_a_query {
    ($class:ident($($name:literal),*)) => {
        match_args!($class($($name),*));

        #[pymethods]
        impl $class {
            fn __reduce__<'py>(
                &self,
                py: Python<'py>,
            ) -> PyResult<Reduced<'py, (Py<Cast>, String)>> {
                reduced::<Self, _>(py, (self.query.clone_ref(py), written(&self.proof)?))
            }

            #[staticmethod]
            #[pyo3(name = "_of")]
            fn of_text(query: Py<Cast>, text: &str) -> PyResult<Self> {
                Ok(Self { proof: read(text)?, query })
            }
        }
    };
}

/// The proof of a contact: lower and upper bound of the collision translation, rounded outwards.
///
/// A supporting plane proves the lower bound, three weighted pairs of vertices prove the upper one. For rounded
/// bodies these are the vertices of the hulls without radius, and the check adds the radii.
#[pyclass(frozen, module = "colltrans.answers")]
pub(crate) struct Certificate {
    pub(crate) proof: colltrans::Certificate,
    pub(crate) query: Py<Cast>,
}

of_a_query!(Certificate("lower", "upper"));

getters!(Certificate, |it| {
    /// float: The proven lower bound, in multiples of the direction.
    lower: f64 = it.proof.lower;
    /// float: The proven upper bound, in multiples of the direction; infinite if the shadows overlap by less
    /// than rounding errors.
    upper: f64 = it.proof.upper;
    /// float: ``upper - lower``.
    gap: f64 = it.proof.gap();
    /// float: An upper bound of the part of the gap that is due to rounding.
    rounding: f64 = it.proof.rounding;
    /// ndarray of shape (3,): Unit normal of the supporting plane, in the world.
    normal(py): Vector<'py> = row(py, it.proof.normal);
    /// ndarray of shape (3, 2): Pairs of vertices, one of the moving and one of the fixed body, as indices into
    /// :attr:`ConvexPolyhedron.vertices`.
    pairs(py): PyResult<Bound<'py, PyArray2<u32>>> =
        table(py, it.proof.pairs.map(|pair| [pair.moving.0, pair.fixed.0]));
    /// ndarray of shape (3,): Weights of the pairs, not negative, with sum 1.
    weights(py): Vector<'py> = PyArray1::from_slice(py, &it.proof.weights);
});

#[pymethods]
impl Certificate {
    /// Checks the proof with the two bodies alone, without a search.
    ///
    /// Parameters
    /// ----------
    /// query : Cast, optional
    ///     The query for which the proof is checked; by default the query that was answered.
    ///
    /// Returns
    /// -------
    /// float
    ///     The gap that the check proves, in multiples of the direction.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    #[pyo3(signature = (query=None))]
    pub(crate) fn verify(&self, query: Option<&Bound<'_, Cast>>) -> PyResult<f64> {
        let query = query.map_or_else(|| self.query.get(), |cast| cast.get());
        query.with(|cast| cast.verify(&self.proof))?.or_raise()
    }

    fn __repr__(&self) -> String {
        let colltrans::Certificate { lower, upper, .. } = self.proof;
        format!("Certificate(lower={lower:?}, upper={upper:?})")
    }
}

/// The proof that two bodies never meet along a direction: a plane parallel to it between them.
#[pyclass(frozen, module = "colltrans.answers")]
pub(crate) struct Separation {
    pub(crate) proof: colltrans::Separation,
    pub(crate) query: Py<Cast>,
}

of_a_query!(Separation("normal", "margin"));

getters!(Separation, |it| {
    /// ndarray of shape (3,): Unit normal of the plane, in the world, from the moving body to the
    /// fixed one.
    normal(py): Vector<'py> = row(py, it.proof.normal);
    /// float: A lower bound of the distance of the shadows, a length.
    margin: f64 = it.proof.margin;
});

#[pymethods]
impl Separation {
    /// Checks the proof with the two bodies alone, without a search.
    ///
    /// Parameters
    /// ----------
    /// query : Cast, optional
    ///     The query for which the proof is checked; by default the query that was answered.
    ///
    /// Returns
    /// -------
    /// float
    ///     The margin that the check proves, a length.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    #[pyo3(signature = (query=None))]
    pub(crate) fn verify(&self, query: Option<&Bound<'_, Cast>>) -> PyResult<f64> {
        let query = query.map_or_else(|| self.query.get(), |cast| cast.get());
        query.with(|cast| cast.verify(&self.proof))?.or_raise()
    }

    fn __repr__(&self) -> String {
        format!("Separation(margin={:?})", self.proof.margin)
    }
}

/// The proof of a clearance between solids.
#[pyclass(frozen, module = "colltrans.answers")]
#[derive(Serialize, Deserialize)]
pub(crate) struct SolidCertificate(pub(crate) colltrans::solid::SolidCertificate);

pickled!(SolidCertificate);

getters!(SolidCertificate, |it| {
    /// float: The tolerance, a length. Both bodies were shrunk by half of it.
    tolerance: f64 = it.0.tolerance;
    /// float: The proven lower bound of the shrunk bodies' distance, in multiples of the direction.
    lower: f64 = it.0.lower;
});

#[pymethods]
impl SolidCertificate {
    /// Returns the proof as text.
    pub(crate) fn to_json(&self) -> String {
        self.0.to_json()
    }

    /// Reads the text that `to_json` wrote, without a check of the proof.
    #[staticmethod]
    pub(crate) fn from_json(text: &str) -> PyResult<Self> {
        colltrans::solid::SolidCertificate::from_json(text).or_raise().map(Self)
    }

    fn __repr__(&self) -> String {
        format!("SolidCertificate(lower={:?})", self.0.lower)
    }
}
