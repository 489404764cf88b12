//! Ways out in several moves, of two bodies.

use colltrans::Placed;
use colltrans::free::FreeError;
use colltrans::record::WaysRecord;
use colltrans::ways::WayOptions;
use pyo3::prelude::*;

use crate::arrays::points;
use crate::errors::{OrRaise, error};
use crate::frozen::{getters, plain};
use crate::pose::{Pose, pose};
use crate::solid::Piece;
use crate::solid_cast::{patiently, placed_bodies};

/// How a body can leave another one in several moves: see :func:`ways_out`.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct WaysOut {
    bodies: [Piece; 2],
    poses: [colltrans::Pose; 2],
    answer: colltrans::ways::WaysOut,
    record: WaysRecord,
}

type Placing<'a> = [Placed<'a, colltrans::Solid>; 2];

fn placed<'a>(bodies: &'a [Piece; 2], poses: &[colltrans::Pose; 2]) -> PyResult<Placing<'a>> {
    let [moving, fixed] =
        [bodies[0].solid_with_area().or_raise()?, bodies[1].solid_with_area().or_raise()?];
    Ok([moving.at(poses[0]), fixed.at(poses[1])])
}

fn raised(what: FreeError) -> PyErr {
    match what {
        FreeError::NotProven(what) => error("CertificateError", what),
        what => error("QueryError", what),
    }
}

placed_bodies!(WaysOut);

getters!(WaysOut, |it| {
    /// str: ``"found"``; ``"none"`` if there is none by translations, which is proven; ``"not_found"``,
    /// which proves nothing.
    outcome: &'static str = it.record.outcome;
    /// list of tuple of (tuple of float, float): What to do, in order: a direction of length 1 and how far
    /// to go; infinitely with the last one. Empty if no way was found.
    legs: Vec<([f64; 3], f64)> =
        it.record.legs.iter().map(|leg| (leg.direction, leg.travel)).collect();
    /// float or None: The tolerance, a length: both bodies are shrunk by half of it. None if nothing is
    /// proven.
    tolerance: Option<f64> = it.record.tolerance;
    /// int or None: How many cells of displacements prove that there is no way.
    cells: Option<usize> = it.record.cells;
});

#[pymethods]
impl WaysOut {
    /// Checks the proof of every move, or that there is none, without a search. If nothing was found there
    /// is nothing to check.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     What is not proven.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            let [moving, fixed] = placed(&self.bodies, &self.poses)?;
            match &self.answer {
                colltrans::ways::WaysOut::Found(way) => way.verify(&[moving, fixed]),
                colltrans::ways::WaysOut::Proven(proof) => proof.verify(&moving, &fixed),
                colltrans::ways::WaysOut::NotFound { .. } => Ok(()),
            }
            .map_err(raised)
        })
    }

    /// What it says, as plain Python: ``outcome``, ``legs``, ``tolerance``, ``cells``, and what was
    /// ``searched``; what does not apply is left out.
    ///
    /// Returns
    /// -------
    /// dict
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        plain(py, &self.record)
    }

    fn __repr__(&self) -> String {
        let WaysRecord { outcome, legs, .. } = &self.record;
        format!("WaysOut({outcome:?}, {} legs)", legs.len())
    }
}

/// How can a body leave another one by straight moves, one after another?
///
/// The body keeps how it is turned. Each move has its proof, and so has the answer that there is no way;
/// that none was found is no proof.
///
/// Parameters
/// ----------
/// moving, fixed : Solid or ConvexPolyhedron
///     The body that moves, and the one that does not; closed, and apart where they are.
/// moving_pose, fixed_pose : array_like or Pose, optional
///     Where the bodies are; see :class:`Pose`.
/// tolerance : float, optional
///     As of :class:`SolidCast`: both bodies are shrunk by half of it.
/// legs : int
///     At most so many moves.
/// directions : array_like of shape (D, 3)
///     Those to try, with their opposites; without any those of large faces, and across two of these.
/// looks : int
///     How many pairs of boxes are looked at, at most.
/// cells : int
///     At most so many cells for a proof that there is no way; 0 for no such proof.
///
/// Returns
/// -------
/// WaysOut
///
/// Raises
/// ------
/// QueryError
///     Bodies that are open, or overlap where they are.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, ways_out
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> way = ways_out(cube, cube, moving_pose=[0, 0, 2])
/// >>> way.outcome, len(way.legs)
/// ('found', 1)
/// >>> way.verify()
#[pyfunction]
#[pyo3(signature = (moving, fixed, *, moving_pose=None, fixed_pose=None, tolerance=None, legs=12,
    directions=None, looks=50_000_000, cells=20_000))]
#[expect(clippy::too_many_arguments, reason = "they are keywords")]
pub(crate) fn ways_out(
    py: Python<'_>,
    moving: &Bound<'_, PyAny>,
    fixed: &Bound<'_, PyAny>,
    moving_pose: Option<&Bound<'_, PyAny>>,
    fixed_pose: Option<&Bound<'_, PyAny>>,
    tolerance: Option<f64>,
    legs: usize,
    directions: Option<&Bound<'_, PyAny>>,
    looks: u64,
    cells: usize,
) -> PyResult<WaysOut> {
    if legs == 0 {
        return Err(error("InputError", "legs: at least one move"));
    }
    let bodies = [Piece::of(moving, "moving")?, Piece::of(fixed, "fixed")?];
    let poses = [pose(moving_pose, "moving_pose")?, pose(fixed_pose, "fixed_pose")?];
    let directions = directions.map_or_else(|| Ok(Vec::new()), |all| points(all, "directions"))?;
    let options = WayOptions::default()
        .with_tolerance(tolerance)
        .with_legs(legs)
        .with_directions(directions)
        .with_looks(looks)
        .with_cells(cells);
    let copies = [bodies[0].copy(py), bodies[1].copy(py)];
    patiently(py, &copies, move || {
        let [moving, fixed] = placed(&bodies, &poses)?;
        let answer = colltrans::ways::WaysOut::of(&moving, &fixed, &options).map_err(raised)?;
        let record = WaysRecord::of(&answer);
        Ok(WaysOut { bodies, poses, answer, record })
    })
}
