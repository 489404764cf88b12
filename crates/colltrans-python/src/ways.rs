//! Removal paths: sequences of straight moves by which one body leaves another.

use colltrans::record::WaysRecord;
use colltrans::removal::path::{RemovalOptions, RemovalSearch};
use pyo3::prelude::*;

use crate::arrays::points;
use crate::directions::place_bodies;
use crate::errors::{OrRaise, error};
use crate::frozen::{getters, plain};
use crate::pose::Pose;
use crate::solid::Piece;
use crate::solid_cast::{placed_bodies, run_patiently};

/// A sequence of moves by which one body leaves another; see :func:`ways_out`.
#[pyclass(frozen, module = "colltrans.removal")]
pub(crate) struct WaysOut {
    bodies: [Piece; 2],
    poses: [colltrans::Pose; 2],
    answer: RemovalSearch,
    record: WaysRecord,
}

placed_bodies!(WaysOut);

getters!(WaysOut, |it| {
    /// str: ``"found"``; ``"none"`` if it is proven that no sequence of translations exists; ``"not_found"``
    /// if the search found none, without a proof.
    outcome: &'static str = it.record.outcome;
    /// list of tuple of (list of float, float): The moves in order: a unit direction and a travel, which is
    /// infinite for the last move. Empty if no path was found.
    legs: Vec<([f64; 3], f64)> =
        it.record.legs.iter().map(|leg| (leg.direction, leg.travel)).collect();
    /// float or None: The tolerance, a length. Both bodies are shrunk by half of it. None if nothing is
    /// proven.
    tolerance: Option<f64> = it.record.tolerance;
    /// int or None: The number of cells of displacements in the proof that no path exists.
    cells: Option<usize> = it.record.cells;
});

#[pymethods]
impl WaysOut {
    /// Checks the proof of every move, or the proof that no path exists, without a search.
    ///
    /// If the search found nothing, there is nothing to check.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            let [moving, fixed] = place_bodies(&self.bodies, &self.poses)?;
            match &self.answer {
                RemovalSearch::Found(way) => way.verify(&[moving, fixed]),
                RemovalSearch::Proven(proof) => proof.verify(&moving, &fixed),
                RemovalSearch::NotFound { .. } => Ok(()),
            }
            .or_raise()
        })
    }

    /// Returns the answer as plain Python: ``outcome``, ``legs``, ``tolerance``, ``cells`` and ``searched``.
    /// Fields that do not apply are left out. The infinite travel of the last move is None.
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

/// Finds straight moves, one after another, by which one body leaves another.
///
/// The body keeps its rotation. Each move has a proof, and so has the answer that no path exists. An
/// unsuccessful search proves nothing.
///
/// Parameters
/// ----------
/// moving, fixed : Solid or ConvexPolyhedron
///     The moving and the fixed body, both closed and without an overlap at the start.
/// moving_pose, fixed_pose : array_like or Pose, optional
///     Poses of the bodies in the world; see :class:`Pose`.
/// tolerance : float, optional
///     Both bodies are shrunk by half of this length. The default is what rotated poses need; unlike that of
///     :class:`SolidCast`, it does not follow from the precision of files.
/// legs : int
///     The maximum number of moves.
/// directions : array_like of shape (D, 3)
///     Directions to try, with their opposites. The default is the normals of large faces, and directions
///     perpendicular to two of them.
/// looks : int
///     A limit of the visited pairs of boxes; the search can exceed it slightly.
/// cells : int
///     The maximum number of cells of a proof that no path exists; 0 for no such proof.
///
/// Returns
/// -------
/// WaysOut
///
/// Raises
/// ------
/// QueryError
///     A body is open, the bodies overlap at their poses, or a direction is zero or not finite.
/// BuildError
///     A body is a point, a segment or rounded.
/// InputError
///     ``legs`` is 0.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron
/// >>> from colltrans.removal import ways_out
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
        return Err(error("InputError", "legs: 0 is out of range; accepted: at least 1"));
    }
    let (moving, moving_pose) = Piece::placed(moving, moving_pose, "moving")?;
    let (fixed, fixed_pose) = Piece::placed(fixed, fixed_pose, "fixed")?;
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    let directions = directions.map_or_else(|| Ok(Vec::new()), |all| points(all, "directions"))?;
    let options = RemovalOptions::default()
        .with_tolerance(tolerance)
        .with_legs(legs)
        .with_directions(directions)
        .with_looks(looks)
        .with_cells(cells);
    let copies = [bodies[0].copy(py), bodies[1].copy(py)];
    run_patiently(py, &copies, move || {
        let [moving, fixed] = place_bodies(&bodies, &poses)?;
        let answer = RemovalSearch::search(&moving, &fixed, &options).or_raise()?;
        let record = WaysRecord::from_search(&answer);
        Ok(WaysOut { bodies, poses, answer, record })
    })
}
