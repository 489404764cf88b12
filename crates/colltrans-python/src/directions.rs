//! All directions along which one body can leave another.

use std::path::PathBuf;

use colltrans::glam::DVec3;
use colltrans::record::FreeRecord;
use colltrans::removal::directions::{self as removal, FreeOptions, FreeProof, Verdict};
use colltrans::solid::SolidCast as _;
use colltrans::solid::StartOverlap;
use colltrans::{Placed, ProofFile, QueryError};
use colltrans_mesh::body::cast_between;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::answer::save;
use crate::arrays::points;
use crate::errors::{OrRaise, input_error};
use crate::frozen::{getters, plain};
use crate::pose::Pose;
use crate::solid::Piece;
use crate::solid_cast::{placed_bodies, run_patiently};

/// All directions along which one body can leave another, with proofs; see :func:`free_directions`.
#[pyclass(frozen, module = "colltrans.removal")]
pub(crate) struct FreeDirections {
    bodies: [Piece; 2],
    poses: [colltrans::Pose; 2],
    options: FreeOptions,
    proof: FreeProof,
    record: FreeRecord,
}

/// The arguments of the query.
struct Question {
    bodies: [Piece; 2],
    poses: [colltrans::Pose; 2],
    options: FreeOptions,
}

pub(crate) type PlacedPair<'a> = [Placed<'a, colltrans::Solid>; 2];

/// Places both bodies as solids. Returns an error for a point or a segment, which has no area.
pub(crate) fn place_bodies<'a>(
    bodies: &'a [Piece; 2],
    poses: &[colltrans::Pose; 2],
) -> PyResult<PlacedPair<'a>> {
    let [moving, fixed] =
        [bodies[0].solid_with_area().or_raise()?, bodies[1].solid_with_area().or_raise()?];
    Ok([moving.at(poses[0]), fixed.at(poses[1])])
}

impl FreeDirections {
    /// Evaluates a query of the library's answer for each direction.
    fn each<T>(
        &self,
        directions: &Bound<'_, PyAny>,
        ask: impl Fn(&removal::FreeDirections<'_>, DVec3) -> Result<T, QueryError>,
    ) -> PyResult<Vec<T>> {
        let directions = points(directions, "directions")?;
        self.with_answer(|free| directions.into_iter().map(|d| ask(&free, d).or_raise()).collect())
    }

    /// Rebuilds the library's answer from its proof, for a query.
    fn with_answer<T>(
        &self,
        ask: impl FnOnce(removal::FreeDirections<'_>) -> PyResult<T>,
    ) -> PyResult<T> {
        let [moving, fixed] = place_bodies(&self.bodies, &self.poses)?;
        let free = removal::FreeDirections::from_trusted_proof(&moving, &fixed, &self.proof);
        ask(free.or_raise()?)
    }
}

impl Question {
    /// Chooses the tolerance from the precision of the files, if none is given.
    fn settled(mut self) -> PyResult<Self> {
        let [moving, fixed] = place_bodies(&self.bodies, &self.poses)?;
        let precisions = [0, 1].map(|k| self.bodies[k].precision());
        let FreeOptions { tolerance, start_overlap, .. } = self.options;
        let cast = cast_between(moving, fixed, DVec3::Z, precisions, tolerance, start_overlap);
        self.options = self.options.with_tolerance(cast.or_raise()?.tolerance());
        Ok(self)
    }

    fn answer(self) -> PyResult<FreeDirections> {
        let asked = self.settled()?;
        let [moving, fixed] = place_bodies(&asked.bodies, &asked.poses)?;
        let free = removal::FreeDirections::compute(&moving, &fixed, asked.options);
        let free = free.or_raise()?;
        let (proof, record) = (free.proof(), FreeRecord::from_directions(&free, |_| [None, None]));
        let Self { bodies, poses, options } = asked;
        Ok(FreeDirections { bodies, poses, options, proof, record })
    }
}

placed_bodies!(FreeDirections);

getters!(FreeDirections, |it| {
    /// str: ``"free"`` if some directions are free, ``"blocked"`` if it is proven that none is,
    /// ``"undecided"`` if no direction is known to be free and some are undecided.
    outcome: &'static str = it.record.outcome.name();
    /// tuple of (float, float): Lower and upper bound of the share of all directions that is free, without
    /// the undecided ones.
    free_share: (f64, f64) = it.record.free_share.unwrap_or_default().into();
    /// float: An upper bound of the share of directions that are undecided.
    undecided_share: f64 = it.record.undecided_share.unwrap_or_default();
    /// float: The tolerance that was used, a length. Each body is shrunk by half of it.
    tolerance: f64 = it.proof.tolerance;
    /// list of dict: Connected regions, the largest first: ``share``, ``center``, the ``margin`` (the angle between
    /// the center and the boundary, in radians), ``corners`` and the convex ``pieces`` that form the region.
    regions(py): PyResult<Bound<'py, PyAny>> = plain(py, &it.record.regions);
    /// list of dict: Arcs of free directions that border no region, exactly. Each arc runs counterclockwise
    /// around the ``normal`` of its ``plane``, from the first of its ``ends`` (points) to the second, through the
    /// directions ``along``. A whole circle has no ``ends``.
    arcs(py): PyResult<Bound<'py, PyAny>> = plain(py, &it.record.arcs);
    /// list of dict: Isolated free directions: the ``direction``, rounded, and two ``planes``. Each plane has
    /// its ``normal`` and its origin ``of``: two ``triangles``, and three ``vertices`` that span it. A plane at the
    /// boundary of undecided directions has no ``of``. The exact direction is the vector product of the normals.
    points(py): PyResult<Bound<'py, PyAny>> = plain(py, &it.record.points);
});

#[pymethods]
impl FreeDirections {
    /// Classifies directions.
    ///
    /// Parameters
    /// ----------
    /// directions : array_like of shape (N, 3)
    ///     Of any length.
    ///
    /// Returns
    /// -------
    /// list of str
    ///     ``"free"``, ``"blocked"`` or ``"undecided"`` for each direction.
    fn says(&self, py: Python<'_>, directions: &Bound<'_, PyAny>) -> PyResult<Vec<&'static str>> {
        let directions = points(directions, "directions")?;
        py.detach(|| {
            self.with_answer(|free| {
                let word = |d: DVec3| {
                    Ok(match free.classify(d).or_raise()? {
                        Verdict::Free => "free",
                        Verdict::Blocked(_) => "blocked",
                        Verdict::Undecided => "undecided",
                    })
                };
                directions.into_iter().map(word).collect()
            })
        })
    }

    /// Checks whether directions equal an isolated direction exactly.
    ///
    /// Parameters
    /// ----------
    /// number : int
    ///     An index into :attr:`points`; IndexError if it is out of range.
    /// directions : array_like of shape (N, 3)
    ///     Of any length.
    ///
    /// Returns
    /// -------
    /// list of bool
    fn is_at(&self, number: usize, directions: &Bound<'_, PyAny>) -> PyResult<Vec<bool>> {
        let Some(point) = self.record.points.get(number) else {
            return Err(PyIndexError::new_err(format!("there is no point {number}")));
        };
        self.each(directions, |free, d| free.is_at_point(point, d))
    }

    /// Checks whether directions are on an arc or at one of its ends, exactly.
    ///
    /// Parameters
    /// ----------
    /// number : int
    ///     An index into :attr:`arcs`; IndexError if it is out of range.
    /// directions : array_like of shape (N, 3)
    ///     Of any length.
    ///
    /// Returns
    /// -------
    /// list of bool
    fn is_on(&self, number: usize, directions: &Bound<'_, PyAny>) -> PyResult<Vec<bool>> {
        let Some(arc) = self.record.arcs.get(number) else {
            return Err(PyIndexError::new_err(format!("there is no arc {number}")));
        };
        self.each(directions, |free, d| free.is_on_arc(arc, d))
    }

    /// Checks the proof for every cell of the sphere, without a search.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            let [moving, fixed] = place_bodies(&self.bodies, &self.poses)?;
            let checked = removal::FreeDirections::from_proof(&moving, &fixed, &self.proof);
            checked.map(|_| ()).or_raise()
        })
    }

    /// Returns the answer as plain Python: the fields of ``colltrans directions --json``, with the same bits.
    ///
    /// Returns
    /// -------
    /// dict
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        plain(py, &self.record)
    }

    /// Returns the proof with everything that it refers to, as text.
    ///
    /// The text is a file of ``--save-proof``, which ``colltrans verify`` and ``python -m colltrans.check``
    /// check.
    ///
    /// Returns
    /// -------
    /// str
    fn proof_json(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| {
            let file = self.with_answer(|free| {
                let pieces =
                    [self.bodies[0].pieces().or_raise()?, self.bodies[1].pieces().or_raise()?];
                let free = free.with_options(self.options);
                ProofFile::of_free_directions(&free, [&pieces[0], &pieces[1]]).or_raise()
            })?;
            Ok(file.to_json())
        })
    }

    /// Writes :meth:`proof_json` to a file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    fn save_proof(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        save(&path, self.proof_json(py)?)
    }

    fn __repr__(&self) -> String {
        let [low, high] = self.record.free_share.unwrap_or_default();
        let outcome = self.record.outcome.name();
        format!("FreeDirections({outcome:?}, free_share=({low:?}, {high:?}))")
    }
}

/// Finds all directions along which one body can leave another, with proofs.
///
/// Parameters
/// ----------
/// moving, fixed : Solid or ConvexPolyhedron
///     The moving and the fixed body, both closed.
/// moving_pose, fixed_pose : array_like or Pose, optional
///     Poses of the bodies in the world; see :class:`Pose`.
/// tolerance, ignore_start_overlaps
///     See :class:`SolidCast`. A direction is free exactly if its clearance is free.
/// depth : int
///     The maximum number of times that the sides of a cube of directions are halved; at most 50.
/// looks : int
///     A limit of the work, in visited pairs of boxes; the search can exceed it slightly. Directions that are not
///     decided by then stay undecided.
///
/// Returns
/// -------
/// FreeDirections
///
/// Raises
/// ------
/// QueryError
///     A body is open, or the bodies overlap at their poses.
/// BuildError
///     A body is a point, a segment or rounded.
/// InputError
///     ``depth`` exceeds 50.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron
/// >>> from colltrans.removal import free_directions
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> lid = free_directions(cube, cube, moving_pose=[0, 0, 1])
/// >>> low, high = lid.free_share
/// >>> low <= 0.5 <= high
/// True
/// >>> " ".join(lid.says([[1, 2, 0], [1, 2, -1e-50]]))
/// 'free blocked'
/// >>> lid.verify()
#[pyfunction]
#[pyo3(signature = (moving, fixed, *, moving_pose=None, fixed_pose=None, tolerance=None,
    ignore_start_overlaps=false, depth=26, looks=20_000_000))]
#[expect(clippy::too_many_arguments, reason = "they are keywords")]
pub(crate) fn free_directions(
    py: Python<'_>,
    moving: &Bound<'_, PyAny>,
    fixed: &Bound<'_, PyAny>,
    moving_pose: Option<&Bound<'_, PyAny>>,
    fixed_pose: Option<&Bound<'_, PyAny>>,
    tolerance: Option<f64>,
    ignore_start_overlaps: bool,
    depth: u32,
    looks: u64,
) -> PyResult<FreeDirections> {
    if depth > 50 {
        return Err(input_error(
            "depth",
            format_args!("{depth} is out of range; accepted: at most 50"),
        ));
    }
    let (moving, moving_pose) = Piece::placed(moving, moving_pose, "moving")?;
    let (fixed, fixed_pose) = Piece::placed(fixed, fixed_pose, "fixed")?;
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    let start = if ignore_start_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
    let options = FreeOptions::DEFAULT
        .with_tolerance(tolerance)
        .with_start_overlap(start)
        .with_depth(depth)
        .with_looks(looks);
    let copies = [bodies[0].copy(py), bodies[1].copy(py)];
    run_patiently(py, &copies, move || Question { bodies, poses, options }.answer())
}
