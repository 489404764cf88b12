//! Many placed bodies and queries of one body among them: the scene of the library behind a lock.
//!
//! Queries run without the interpreter's lock, any number of them at a time. Calls that add, move or remove
//! bodies wait for them. Bulk queries answer their rows on any number of threads, each row by itself.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, PoisonError};

use colltrans::glam::DVec3;
use colltrans::{AnyBody, ObstacleId, QueryError, SceneClearance, SceneQuery};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::vector;
use crate::bulk::each;
use crate::errors::{OrRaise, input_error};
use crate::pose::{Pose, pose};
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
    ) -> PyResult<Vec<T>> {
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

/// Reads the poses of an array or a sequence.
fn read_poses(of: &Bound<'_, PyAny>) -> PyResult<Vec<colltrans::Pose>> {
    of.try_iter()?.map(|one| pose(Some(&one?), "poses")).collect()
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
    /// body : ConvexPolyhedron or Solid
    /// pose : array_like or Pose, optional
    ///     The pose of the body.
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
        let at = self::pose(pose, "pose")?;
        let ids = self.insert(py, std::slice::from_ref(body), vec![at])?;
        Ok(ids[0])
    }

    /// Adds many bodies in one pass.
    ///
    /// Parameters
    /// ----------
    /// body : ConvexPolyhedron, Solid or sequence of them
    ///     One body for all poses, or one for each.
    /// poses : array_like of shape (N, ...), or sequence of Pose
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
    fn add_many(
        &self,
        py: Python<'_>,
        body: &Bound<'_, PyAny>,
        poses: &Bound<'_, PyAny>,
    ) -> PyResult<Vec<u64>> {
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
    /// body : ConvexPolyhedron or Solid
    /// pose : array_like or Pose, optional
    ///     The pose of the body.
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
        let (body, at) = (Piece::from_python(body, "body")?, self::pose(pose, "pose")?);
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
        let (body, at) = (Piece::from_python(body, "body")?, self::pose(pose, "pose")?);
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
        let (body, at) = (Piece::from_python(body, "body")?, self::pose(pose, "pose")?);
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
    /// poses : array_like of shape (N, ...), or sequence of Pose
    /// threads : int, optional
    ///     The default is the number of processors. Answers do not depend on it.
    ///
    /// Returns
    /// -------
    /// dict of ndarray
    ///     Columns ``obstacle`` (-1 without obstacles), ``lower`` and ``upper`` (infinite without obstacles),
    ///     ``on_moving`` and ``on_fixed`` (NaN without obstacles).
    ///
    /// Raises
    /// ------
    /// QueryError
    ///     A row has no answer; the message has the first such row and the reason.
    #[pyo3(signature = (body, poses, *, ignore=HashSet::new(), threads=None),
        text_signature = "($self, body, poses, *, ignore=(), threads=None)")]
    fn nearest_many<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        poses: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = obstacle_numbers)] ignore: HashSet<u64>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (body, poses) = (Piece::from_python(body, "body")?, read_poses(poses)?);
        let found = self.ask_rows(py, (&body, &poses), &ignore, threads, |_, a| a.nearest())?;
        let column = |of: fn(&colltrans::Nearest) -> f64| -> Vec<f64> {
            found.iter().map(|n| n.as_ref().map_or(f64::INFINITY, of)).collect()
        };
        let points = |of: fn(&colltrans::AnyDistance) -> DVec3| {
            let point = |n: &colltrans::Nearest| of(&n.distance).to_array();
            let all = found.iter().map(|n| n.as_ref().map_or([f64::NAN; 3], point));
            vector_table(py, all.collect())
        };
        let id = |n: &Option<colltrans::Nearest>| n.map_or(-1, |n| n.obstacle.0 as i64);
        let ids: Vec<i64> = found.iter().map(id).collect();
        let columns = PyDict::new(py);
        columns.set_item("obstacle", ids.into_pyarray(py))?;
        columns.set_item("lower", column(|n| n.lower).into_pyarray(py))?;
        columns.set_item("upper", column(|n| n.distance.upper()).into_pyarray(py))?;
        columns.set_item("on_moving", points(|d| d.on_moving())?)?;
        columns.set_item("on_fixed", points(|d| d.on_fixed())?)?;
        Ok(columns)
    }

    /// Runs :meth:`clearance` for many poses and directions, on several threads.
    ///
    /// Parameters
    /// ----------
    /// body, before, min_gap, ignore
    ///     See :meth:`clearance`.
    /// directions : array_like of shape (N, 3) or (3,)
    ///     One direction for each pose, or one for all.
    /// poses, threads
    ///     See :meth:`nearest_many`.
    ///
    /// Returns
    /// -------
    /// dict of ndarray
    ///     Columns ``outcome`` (0 is blocked, 1 free, 2 overlapping), ``obstacle`` (-1 if nothing stops the
    ///     body), ``distance`` (at most ``before``; NaN for an overlap) and ``upper``, an upper bound of the
    ///     translation at which the body is stopped (infinite if nothing stops it, NaN for an overlap).
    #[pyo3(signature = (body, directions, poses, *, before=None, min_gap=0.0,
        ignore=HashSet::new(), threads=None), text_signature = "($self, body, directions, poses, \
        *, before=None, min_gap=0.0, ignore=(), threads=None)")]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn clearance_many<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        poses: &Bound<'py, PyAny>,
        before: Option<f64>,
        min_gap: f64,
        #[pyo3(from_py_with = obstacle_numbers)] ignore: HashSet<u64>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (body, poses) = (Piece::from_python(body, "body")?, read_poses(poses)?);
        let one = vector(directions, "directions").map(|one| vec![one]);
        let rows = || directions.try_iter()?.map(|one| vector(&one?, "directions")).collect();
        let directions: Vec<DVec3> = one.or_else(|_| rows())?;
        if directions.len() != 1 && directions.len() != poses.len() {
            let what = format!("{} for {} poses", directions.len(), poses.len());
            return Err(input_error("directions", what));
        }
        let before = before.unwrap_or(f64::INFINITY);
        let ask = |k: usize, among: &SceneQuery<'_>| {
            clearance_with_min_gap(among, directions[k.min(directions.len() - 1)], before, min_gap)
        };
        let found = self.ask_rows(py, (&body, &poses), &ignore, threads, ask)?;
        let kind = |one: &SceneClearance| match outcome_of(one) {
            "blocked" => 0_u8,
            "free" => 1,
            _ => 2,
        };
        let columns = PyDict::new(py);
        let outcome: Vec<u8> = found.iter().map(kind).collect();
        let id = |one: &SceneClearance| one.stop.map_or(-1, |(id, _)| id.0 as i64);
        let ids: Vec<i64> = found.iter().map(id).collect();
        let distance = found.iter().map(|one| one.safe_translation().unwrap_or(f64::NAN));
        let upper = found.iter().map(upper_of);
        columns.set_item("outcome", outcome.into_pyarray(py))?;
        columns.set_item("obstacle", ids.into_pyarray(py))?;
        columns.set_item("distance", distance.collect::<Vec<_>>().into_pyarray(py))?;
        columns.set_item("upper", upper.collect::<Vec<_>>().into_pyarray(py))?;
        Ok(columns)
    }
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
