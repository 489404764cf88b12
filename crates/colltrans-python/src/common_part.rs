//! Common parts of two bodies, with their proofs.

use colltrans::glam::DVec3;
use colltrans::solid::{CommonPartCertificate, ProvenRelation, VolumeOptions};
use colltrans::{Aabb, ProofFile, Statement};
use pyo3::prelude::*;

use crate::answer::save;
use crate::arrays::{Vector, row};
use crate::errors::{OrRaise, error, other_bodies_error};
use crate::frozen::{Reduced, getters, reduced};
use crate::pair::Pair;
use crate::solid_cast::run_patiently;

/// How much of two bodies overlaps: bounds of the volume of their common part, its box, and how the bodies lie to each
/// other, with a proof.
///
/// The interiors of closed shells are compared. The bodies are those of the proof, exact in bits.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct CommonPart {
    volume: [f64; 2],
    bounds: Option<Aabb>,
    point: Option<DVec3>,
    relation: Option<&'static str>,
    proof: ProofFile,
    query: Py<Pair>,
}

impl CommonPart {
    fn new(proof: ProofFile, query: Py<Pair>) -> PyResult<Self> {
        let Statement::SolidCommonPart(claims) = proof.statement() else {
            return Err(other_bodies_error());
        };
        let CommonPartCertificate { volume, bounds, point, relation, .. } = *claims;
        let relation = relation.map(relation_name);
        Ok(Self { volume, bounds, point, relation, proof, query })
    }

    /// Computes the common part and its proof.
    pub(crate) fn of_pair(query: &Bound<'_, Pair>, accuracy: f64) -> PyResult<Self> {
        if accuracy.is_nan() || accuracy < 0.0 {
            let text = format!("accuracy is {accuracy}; it must be 0 or a positive share");
            return Err(error("InputError", text));
        }
        let asked = query.clone().unbind();
        let options = VolumeOptions::default().with_accuracy(accuracy);
        let work = move || asked.get().common_part_proof(options);
        let proof = run_patiently(query.py(), &query.get().bodies, work)?;
        Self::new(proof, query.clone().unbind())
    }
}

/// Returns the name of a relation, as in proof files.
fn relation_name(relation: ProvenRelation) -> &'static str {
    match relation {
        ProvenRelation::Disjoint => "disjoint",
        ProvenRelation::Crossing { .. } => "crossing",
        ProvenRelation::MovingContained => "moving_contained",
        ProvenRelation::FixedContained => "fixed_contained",
        _ => "unknown",
    }
}

getters!(CommonPart, |it| {
    /// Pair: The query.
    query(py): Py<Pair> = it.query.clone_ref(py);
    /// tuple of float: The proven lower and upper bound of the volume.
    volume: (f64, f64) = (it.volume[0], it.volume[1]);
    /// tuple of two ndarray, or None: The lowest and the highest corner of a box in the world that contains the common
    /// part; None if there is none.
    bounds(py): Option<(Vector<'py>, Vector<'py>)> =
        it.bounds.map(|bounds| (row(py, bounds.low), row(py, bounds.high)));
    /// ndarray of shape (3,), or None: A point of the world in the interior of both bodies, if one is proven.
    point(py): Option<Vector<'py>> = it.point.map(|point| row(py, point));
    /// str or None: ``"disjoint"``, ``"crossing"``, ``"moving_contained"`` (the fixed body contains the moving one) or
    /// ``"fixed_contained"``; None if the relation is not proven.
    relation: Option<&'static str> = it.relation;
});

#[pymethods]
impl CommonPart {
    /// Checks the proof with the bodies alone.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| self.proof.check().map(drop)).or_raise()
    }

    /// Returns the proof with both bodies, as text. ``colltrans verify`` and ``python -m colltrans.check`` check it.
    ///
    /// Returns
    /// -------
    /// str
    fn proof_json(&self) -> String {
        self.proof.to_json()
    }

    /// Writes :meth:`proof_json` to a file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    fn save_proof(&self, path: std::path::PathBuf) -> PyResult<()> {
        save(&path, self.proof_json())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py, (Py<Pair>, String)>> {
        reduced::<Self, _>(py, (self.query(py), self.proof_json()))
    }

    #[staticmethod]
    fn _of(query: &Bound<'_, Pair>, text: &str) -> PyResult<Self> {
        Self::new(ProofFile::from_json(text).or_raise()?, query.clone().unbind())
    }

    fn __repr__(&self) -> String {
        let [lower, upper] = self.volume;
        let relation = self.relation.map_or("None".into(), |name| format!("'{name}'"));
        format!("CommonPart(volume=({lower:?}, {upper:?}), relation={relation})")
    }
}
