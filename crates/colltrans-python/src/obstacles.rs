//! Many placed bodies and queries of one body among them: the scene of the library behind a lock.
//!
//! Queries run without the interpreter's lock, any number of them at a time. Calls that add, move or remove
//! bodies wait for them. Bulk queries answer their rows on any number of threads, each row by itself.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, PoisonError};

use colltrans::glam::DVec3;
use colltrans::{AnyBody, ObstacleId, QueryError, SceneClearance, SceneQuery};
use numpy::{IntoPyArray, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{points, vector};
use crate::bulk::{Answered, each};
use crate::errors::{OrRaise, error, input_error};
use crate::placed::place;
use crate::pose::{Pose, pose};
use crate::rows::Table;
use crate::scene::{Scene, SceneRequest, with_min_gap};
use crate::scene_answers::{
    NearbyObstacles, NearestObstacle, ObstacleClearance, outcome_of, upper_of,
};
use crate::solid::Piece;

/// Number of rows that a thread takes at a time.
const CHUNK: usize = 64;

/// Many placed bodies of both kinds in a tree of boxes, which is updated as bodies are added, moved and
/// removed.
///
/// Answers equal those of querying all obstacles one by one. If several obstacles cannot be distinguished,
/// the answer names the one with the smallest upper bound, and among equal bounds the one that was added
/// first. Bounds hold for all obstacles together. A body that is added many times is stored once.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, Obstacles
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> shelf = Obstacles()
/// >>> shelf.add_many(cube, [[2 * k, 0, 0] for k in range(1000)])[:3]
/// [0, 1, 2]
/// >>> nearest = shelf.nearest(cube, [24.25, 0, 4])
/// >>> nearest.obstacle, nearest.lower <= 3 <= nearest.upper
/// (12, True)
/// >>> down = shelf.clearance(cube, [0, 0, -1], [24.25, 0, 4])
/// >>> down.outcome, down.obstacle, 3 - 1e-11 < down.distance <= 3
/// ('blocked', 12, True)
/// >>> shelf.within(cube, 3.2, [24.25, 0, 4])
/// NearbyObstacles(closer=[12, 13], undecided=[])
/// >>> down.verify()
/// >>> shelf.remove(12)
/// >>> shelf.clearance(cube, [0, 0, -1], [24.25, 0, 4])
/// ObstacleClearance('free', obstacle=None, distance=inf)
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Obstacles {
    scene: Arc<Scene>,
    /// Bodies by the address of their Python objects, which are stored with them.
    bodies: Mutex<HashMap<usize, (Piece, AnyBody)>>,
}

impl Obstacles {
    /// Runs a query of one body, without the interpreter's lock.
    fn ask<T: Send>(
        &self,
        py: Python<'_>,
        (body, at): (Piece, colltrans::Pose),
        ignore: HashSet<u64>,
        question: impl FnOnce(&SceneQuery<'_>) -> Result<T, QueryError> + Send,
    ) -> PyResult<(T, SceneRequest)> {
        let asked = || {
            let kept = self.scene.read();
            let found = kept.ask((&body, at), &ignore, question)?;
            Ok::<_, QueryError>((found, kept.changes))
        };
        let (found, changes) = py.detach(asked).or_raise()?;
        Ok((found, SceneRequest { scene: self.scene.clone(), changes, body, at, ignore }))
    }

    /// Runs a query for many poses, on several threads.
    fn ask_rows<T: Send>(
        &self,
        py: Python<'_>,
        (body, poses): (&Piece, &[colltrans::Pose]),
        ignore: &HashSet<u64>,
        threads: Option<usize>,
        question: impl Fn(usize, &SceneQuery<'_>) -> Result<T, QueryError> + Sync,
    ) -> PyResult<Vec<Result<T, String>>> {
        py.detach(|| {
            let kept = self.scene.read();
            each(poses.len(), CHUNK, threads, |k| {
                kept.ask((body, poses[k]), ignore, |among| question(k, among))
                    .map_err(|what| what.to_string())
            })
        })
    }
}

/// Computes how far a body can move with a minimum gap, at most to the translation `before`. An obstacle stops the
/// body only if it is certainly met before this translation.
fn clearance_with_min_gap(
    among: &SceneQuery<'_>,
    direction: DVec3,
    before: f64,
    min_gap: f64,
) -> Result<SceneClearance, QueryError> {
    with_min_gap(among, min_gap)?.clearance_before(direction, before)
}

fn lock<T>(of: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

fn unknown_obstacle_error(obstacle: u64) -> PyErr {
    PyKeyError::new_err(format!(
        "there is no obstacle {obstacle}: it was never added, or was removed"
    ))
}

/// Reads rows of poses, as bulk queries accept them.
fn read_poses(of: &Bound<'_, PyAny>) -> PyResult<Vec<colltrans::Pose>> {
    let stack = of.py().import("colltrans.queries")?.getattr("pose_table")?.call1((of, "poses"))?;
    let rows = stack.getattr("rows")?;
    let numbers: PyReadonlyArray2<'_, f64> = rows.extract()?;
    let width = numbers.shape()[1];
    let table = Table { name: "poses", numbers: numbers.as_slice()?, width };
    let row = |row| table.pose(row).map_err(|what| error("PoseError", what));
    (0..numbers.shape()[0]).map(row).collect()
}

fn vector_table(py: Python<'_>, all: Vec<[f64; 3]>) -> PyResult<Bound<'_, PyAny>> {
    let n = all.len();
    Ok(all.into_flattened().into_pyarray(py).reshape([n, 3])?.into_any())
}

#[pymethods]
impl Obstacles {
    #[new]
    fn new() -> Self {
        Self { scene: Arc::default(), bodies: Mutex::default() }
    }

    /// Adds a body.
    ///
    /// Parameters
    /// ----------
    /// body : ConvexPolyhedron, Solid or Placed
    /// pose : array_like or Pose, optional
    ///     The pose of the body, unless it is given as ``body.at(pose)``.
    ///
    /// Returns
    /// -------
    /// int
    ///     The number of the obstacle. It stays valid when other obstacles change, and is never used again.
    #[pyo3(signature = (body, pose=None))]
    fn add(
        &self,
        py: Python<'_>,
        body: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<u64> {
        let (body, at) = place(body, pose, "body")?;
        let ids = self.insert(py, &[body], vec![at])?;
        Ok(ids[0])
    }

    /// Adds many bodies in one pass.
    ///
    /// Parameters
    /// ----------
    /// body : ConvexPolyhedron, Solid, or sequence of them
    ///     One body for all poses, or one for each. A sequence of placed bodies, ``body.at(pose)``, has its poses.
    /// pose : array_like of shape (N, ...), or sequence of Pose, optional
    ///     Rows of poses, as for :func:`colltrans.cast_many`.
    ///
    /// Returns
    /// -------
    /// list of int
    ///     The numbers of the obstacles, in the order of the poses; see :meth:`add`.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The numbers of bodies and poses differ.
    #[pyo3(signature = (body, pose=None))]
    fn add_many(
        &self,
        py: Python<'_>,
        body: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<u64>> {
        let Some(poses) = pose else {
            let all = body.try_iter()?.map(|one| place(&one?, None, "body"));
            let (bodies, poses) = all.collect::<PyResult<(Vec<_>, Vec<_>)>>()?;
            return self.insert(py, &bodies, poses);
        };
        let poses = read_poses(poses)?;
        if Piece::from_python(body, "body").is_ok() {
            return self.insert(py, std::slice::from_ref(body), poses);
        }
        let bodies = body.try_iter()?.collect::<PyResult<Vec<_>>>()?;
        if bodies.len() != poses.len() {
            let what = format!("{} bodies for {} poses", bodies.len(), poses.len());
            return Err(input_error("body", what));
        }
        self.insert(py, &bodies, poses)
    }

    /// Moves an obstacle to another pose.
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     There is no such obstacle.
    fn set_pose(&self, py: Python<'_>, obstacle: u64, pose: &Bound<'_, PyAny>) -> PyResult<()> {
        let at = self::pose(Some(pose), "pose")?;
        let set = || self.scene.change(|all| all.set_pose(ObstacleId(obstacle), at));
        py.detach(set).map_err(|_| unknown_obstacle_error(obstacle))
    }

    /// Moves many obstacles in one pass: all of them, or none if a number is unknown.
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     There is no such obstacle.
    /// InputError
    ///     The numbers of obstacles and poses differ.
    fn set_poses(
        &self,
        py: Python<'_>,
        obstacles: Vec<u64>,
        poses: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let poses = read_poses(poses)?;
        if obstacles.len() != poses.len() {
            let what = format!("{} obstacles for {} poses", obstacles.len(), poses.len());
            return Err(input_error("poses", what));
        }
        let moves: Vec<_> = obstacles.into_iter().map(ObstacleId).zip(poses).collect();
        py.detach(|| self.scene.change(|all| all.set_poses(&moves)))
            .map_err(|what| unknown_obstacle_error(what.id.0))
    }

    /// Removes an obstacle.
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     There is no such obstacle.
    fn remove(&self, py: Python<'_>, obstacle: u64) -> PyResult<()> {
        let removed = py.detach(|| self.scene.change(|all| all.remove(ObstacleId(obstacle))));
        removed.map(|_| ()).ok_or_else(|| unknown_obstacle_error(obstacle))
    }

    /// Returns the pose of an obstacle.
    ///
    /// Returns
    /// -------
    /// Pose
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     There is no such obstacle.
    fn pose(&self, py: Python<'_>, obstacle: u64) -> PyResult<Pose> {
        let at = || self.scene.read().obstacles.get(ObstacleId(obstacle)).map(|(_, pose)| pose);
        py.detach(at).map(Pose).ok_or_else(|| unknown_obstacle_error(obstacle))
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        py.detach(|| self.scene.read().obstacles.len())
    }

    fn __contains__(&self, py: Python<'_>, obstacle: u64) -> bool {
        py.detach(|| self.scene.read().obstacles.get(ObstacleId(obstacle)).is_some())
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!("Obstacles({})", self.__len__(py))
    }

    /// Finds the obstacle that is nearest to a body, and its distance.
    ///
    /// Parameters
    /// ----------
    /// body : ConvexPolyhedron, Solid or Placed
    /// pose : array_like or Pose, optional
    ///     The pose of the body, unless it is given as ``body.at(pose)``.
    /// ignore : iterable of int
    ///     Obstacles that are ignored, for example the parts of a gripper.
    ///
    /// Returns
    /// -------
    /// NearestObstacle or None
    ///     None if there are no obstacles, or all are ignored.
    ///
    /// Raises
    /// ------
    /// QueryError
    ///     A pair has a solid and a convex body whose facets do not form a surface. Or a search
    ///     ended without an answer.
    #[pyo3(signature = (body, pose=None, *, ignore=HashSet::new()),
        text_signature = "($self, body, pose=None, *, ignore=())")]
    fn nearest(
        &self,
        py: Python<'_>,
        body: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = obstacle_numbers)] ignore: HashSet<u64>,
    ) -> PyResult<Option<NearestObstacle>> {
        let (body, at) = Piece::placed(body, pose, "body")?;
        let (found, asked) = self.ask(py, (body, at), ignore, |among| among.nearest())?;
        Ok(found.map(|found| NearestObstacle { found, asked }))
    }

    /// Finds the obstacles that are closer to a body than a length.
    ///
    /// Parameters
    /// ----------
    /// body, pose, ignore
    ///     See :meth:`nearest`.
    /// length : float
    ///     The length, in world units.
    ///
    /// Returns
    /// -------
    /// NearbyObstacles
    ///     The closer obstacles, and those that rounding cannot decide, each in the order in which they were
    ///     added. It unpacks into these two lists.
    ///
    /// Raises
    /// ------
    /// QueryError
    ///     The length is negative or not a number.
    #[pyo3(signature = (body, length, pose=None, *, ignore=HashSet::new()),
        text_signature = "($self, body, length, pose=None, *, ignore=())")]
    fn within(
        &self,
        py: Python<'_>,
        body: &Bound<'_, PyAny>,
        length: f64,
        pose: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = obstacle_numbers)] ignore: HashSet<u64>,
    ) -> PyResult<NearbyObstacles> {
        let (body, at) = Piece::placed(body, pose, "body")?;
        let (found, asked) = self.ask(py, (body, at), ignore, |among| among.within(length))?;
        Ok(NearbyObstacles { found, length, asked })
    }

    /// Computes how far a body can move along a direction, and which obstacle stops it.
    ///
    /// Parameters
    /// ----------
    /// body, pose, ignore
    ///     See :meth:`nearest`.
    /// direction : array_like of shape (3,)
    ///     A vector of any length. Translations are multiples of it.
    /// before : float, optional
    ///     The end of the query, in multiples of the direction. The travel is at most this translation. An
    ///     obstacle that is not certainly met before it does not stop the body, but still bounds the travel.
    /// min_gap : float
    ///     A minimum gap, a length. The body stops when its distance from an obstacle falls to it.
    ///
    /// Returns
    /// -------
    /// ObstacleClearance
    ///
    /// Raises
    /// ------
    /// QueryError
    ///     The direction is zero or out of range, or ``before`` or ``min_gap`` is negative.
    #[pyo3(signature = (body, direction, pose=None, *, before=None, min_gap=0.0,
        ignore=HashSet::new()), text_signature = "($self, body, direction, pose=None, *, \
        before=None, min_gap=0.0, ignore=())")]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn clearance(
        &self,
        py: Python<'_>,
        body: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
        before: Option<f64>,
        min_gap: f64,
        #[pyo3(from_py_with = obstacle_numbers)] ignore: HashSet<u64>,
    ) -> PyResult<ObstacleClearance> {
        let (body, at) = Piece::placed(body, pose, "body")?;
        let direction = vector(direction, "direction")?;
        let before = before.unwrap_or(f64::INFINITY);
        let ask =
            |among: &SceneQuery<'_>| clearance_with_min_gap(among, direction, before, min_gap);
        let (found, asked) = self.ask(py, (body, at), ignore, ask)?;
        Ok(ObstacleClearance { found, direction, min_gap, asked })
    }

    /// Runs :meth:`nearest` for many poses, on several threads.
    ///
    /// Parameters
    /// ----------
    /// body, ignore
    ///     See :meth:`nearest`.
    /// pose : array_like of shape (N, ...), or sequence of Pose
    ///     Rows of poses, as for :func:`colltrans.cast_many`.
    /// threads : int, optional
    ///     The default is the number of processors. Answers do not depend on it.
    ///
    /// Returns
    /// -------
    /// colltrans.scenes.NearestColumns
    #[pyo3(signature = (body, pose, *, ignore=HashSet::new(), threads=None),
        text_signature = "($self, body, pose, *, ignore=(), threads=None)")]
    fn nearest_many<'py>(
        slf: &Bound<'py, Self>,
        body: &Bound<'py, PyAny>,
        pose: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = obstacle_numbers)] ignore: HashSet<u64>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let scenes = slf.py().import("colltrans.scenes")?;
        scenes.getattr("_nearest_many")?.call1((slf, body, pose, ignore, threads))
    }

    /// Runs :meth:`clearance` for many poses and directions, on several threads.
    ///
    /// Parameters
    /// ----------
    /// body, before, min_gap, ignore
    ///     See :meth:`clearance`.
    /// direction : array_like of shape (N, 3) or (3,)
    ///     One direction for each pose, or one for all.
    /// pose, threads
    ///     See :meth:`nearest_many`.
    ///
    /// Returns
    /// -------
    /// colltrans.scenes.ObstacleClearanceColumns
    #[pyo3(signature = (body, direction, pose, *, before=None, min_gap=0.0, ignore=HashSet::new(),
        threads=None), text_signature = "($self, body, direction, pose, *, before=None, \
        min_gap=0.0, ignore=(), threads=None)")]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn clearance_many<'py>(
        slf: &Bound<'py, Self>,
        body: &Bound<'py, PyAny>,
        direction: &Bound<'py, PyAny>,
        pose: &Bound<'py, PyAny>,
        before: Option<f64>,
        min_gap: f64,
        #[pyo3(from_py_with = obstacle_numbers)] ignore: HashSet<u64>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let scenes = slf.py().import("colltrans.scenes")?;
        let arguments = (slf, body, direction, pose, before, min_gap, ignore, threads);
        scenes.getattr("_clearance_many")?.call1(arguments)
    }

    /// Answers :meth:`nearest` for many poses; see `colltrans.scenes`.
    fn _nearest_rows<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        poses: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = obstacle_numbers)] ignore: HashSet<u64>,
        threads: Option<usize>,
    ) -> PyResult<Answered<'py>> {
        let (body, poses) = (Piece::from_python(body, "body")?, read_poses(poses)?);
        let found = self.ask_rows(py, (&body, &poses), &ignore, threads, |_, a| a.nearest())?;
        let found: Vec<_> = found.into_iter().map(Result::transpose).collect();
        let outcomes = &["found", "none", "error"];
        answered(
            py,
            &found,
            outcomes,
            |row| u8::from(row.is_none()),
            |columns, all| {
                let column = |of: fn(&colltrans::Nearest) -> f64| -> Vec<f64> {
                    all.iter().map(|n| n.map_or(f64::NAN, of)).collect()
                };
                let points = |of: fn(&colltrans::AnyDistance) -> DVec3| {
                    let point = |n: &colltrans::Nearest| of(&n.distance).to_array();
                    vector_table(py, all.iter().map(|n| n.map_or([f64::NAN; 3], point)).collect())
                };
                let ids = all.iter().map(|n| n.map_or(-1, |n| n.obstacle.0 as i64));
                columns.set_item("obstacle", ids.collect::<Vec<_>>().into_pyarray(py))?;
                columns.set_item("lower", column(|n| n.lower).into_pyarray(py))?;
                columns.set_item("upper", column(|n| n.distance.upper()).into_pyarray(py))?;
                columns.set_item("on_moving", points(|d| d.on_moving())?)?;
                columns.set_item("on_fixed", points(|d| d.on_fixed())?)
            },
        )
    }

    /// Answers :meth:`clearance` for many poses and directions; see `colltrans.scenes`.
    #[expect(clippy::too_many_arguments, reason = "the Python caller passes each part of a query")]
    fn _clearance_rows<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        poses: &Bound<'py, PyAny>,
        before: Option<f64>,
        min_gap: f64,
        #[pyo3(from_py_with = obstacle_numbers)] ignore: HashSet<u64>,
        threads: Option<usize>,
    ) -> PyResult<Answered<'py>> {
        let (body, poses) = (Piece::from_python(body, "body")?, read_poses(poses)?);
        let directions = points(directions, "direction")?;
        let before = before.unwrap_or(f64::INFINITY);
        let ask = |k: usize, among: &SceneQuery<'_>| {
            clearance_with_min_gap(among, directions[k.min(directions.len() - 1)], before, min_gap)
        };
        let found = self.ask_rows(py, (&body, &poses), &ignore, threads, ask)?;
        let outcomes = &["blocked", "free", "overlapping", "error"];
        let code = |one: &SceneClearance| {
            let name = outcome_of(one);
            outcomes.iter().position(|known| *known == name).unwrap_or_default() as u8
        };
        let found: Vec<_> = found.into_iter().map(Some).collect();
        answered(
            py,
            &found,
            outcomes,
            |row| row.map_or(0, code),
            |columns, all| {
                let id = |one: &SceneClearance| one.stop.map_or(-1, |(id, _)| id.0 as i64);
                let ids = all.iter().map(|one| one.map_or(-1, id));
                let distance = |one: &SceneClearance| one.safe_translation().unwrap_or(f64::NAN);
                let number = |of: &dyn Fn(&SceneClearance) -> f64| -> Vec<f64> {
                    all.iter().map(|one| one.map_or(f64::NAN, of)).collect()
                };
                columns.set_item("obstacle", ids.collect::<Vec<_>>().into_pyarray(py))?;
                columns.set_item("distance", number(&distance).into_pyarray(py))?;
                columns.set_item("upper", number(&upper_of).into_pyarray(py))
            },
        )
    }
}

/// An answer of each row that may be absent, or the reason of a failure.
type RowAnswer<T> = Option<Result<T, String>>;

/// Builds the columns of rows: the outcomes, those that `write` adds, and the messages of failed rows.
fn answered<'py, T>(
    py: Python<'py>,
    rows: &[RowAnswer<T>],
    outcomes: &'static [&'static str],
    code: impl Fn(Option<&T>) -> u8,
    write: impl FnOnce(&Bound<'py, PyDict>, &[Option<&T>]) -> PyResult<()>,
) -> PyResult<Answered<'py>> {
    let (columns, messages) = (PyDict::new(py), PyDict::new(py));
    let error = outcomes.len() as u8 - 1;
    let mut codes = Vec::with_capacity(rows.len());
    for (row, found) in rows.iter().enumerate() {
        codes.push(match found {
            Some(Err(what)) => {
                messages.set_item(row, what)?;
                error
            }
            Some(Ok(found)) => code(Some(found)),
            None => code(None),
        });
    }
    columns.set_item("outcome", codes.into_pyarray(py))?;
    let all: Vec<_> =
        rows.iter().map(|row| row.as_ref().and_then(|row| row.as_ref().ok())).collect();
    write(&columns, &all)?;
    Ok((columns, outcomes, messages))
}

impl Obstacles {
    /// Inserts one body for each pose, or one body for all poses.
    fn insert(
        &self,
        py: Python<'_>,
        bodies: &[Bound<'_, PyAny>],
        poses: Vec<colltrans::Pose>,
    ) -> PyResult<Vec<u64>> {
        let made = bodies.iter().map(|body| self.body(body)).collect::<PyResult<Vec<_>>>()?;
        let all = poses.into_iter().enumerate();
        let all = all.map(|(k, at)| (made[k.min(made.len() - 1)].clone(), at));
        let ids = py.detach(|| self.scene.change(|kept| kept.insert_all(all)));
        Ok(ids.into_iter().map(|id| id.0).collect())
    }

    /// Returns the stored body of a Python object, which is converted once.
    fn body(&self, body: &Bound<'_, PyAny>) -> PyResult<AnyBody> {
        let piece = Piece::from_python(body, "body")?;
        let mut bodies = lock(&self.bodies);
        let (_, kept) = bodies.entry(body.as_ptr() as usize).or_insert_with(|| {
            let kept = match &piece {
                Piece::Convex(body) => AnyBody::from(body.get().0.clone()),
                Piece::Solid(solid) => AnyBody::from(solid.get().solid.clone()),
            };
            (piece, kept)
        });
        Ok(kept.clone())
    }
}

/// Reads the numbers of obstacles.
fn obstacle_numbers(of: &Bound<'_, PyAny>) -> PyResult<HashSet<u64>> {
    of.try_iter()?.map(|one| one?.extract()).collect()
}
