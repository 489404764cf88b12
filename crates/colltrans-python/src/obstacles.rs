//! Many placed bodies, and one among them: the library's, kept behind a lock.
//!
//! Questions are asked without the interpreter's lock, any number of them at a time; what adds, moves and
//! removes waits for them. Rows of many are answered on any number of threads, each by itself.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, PoisonError};

use colltrans::glam::DVec3;
use colltrans::{Among, AnyBody, ClearanceAmong, ObstacleId, QueryError};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::vector;
use crate::bulk::each;
use crate::errors::{OrRaise, input};
use crate::pose::{Pose, pose};
use crate::scene::{Asked, Scene, keeping};
use crate::scene_answers::{
    NearbyObstacles, NearestObstacle, ObstacleClearance, outcome_of, upper_of,
};
use crate::solid::Piece;

/// Rows that a thread takes at a time.
const CHUNK: usize = 64;

/// Many placed bodies, of either kind, in a tree of boxes that is kept as they come, move and go.
///
/// Answers are those of asking all obstacles one by one; of several that cannot be told apart, the one
/// whose upper bound is least, and of equal ones the one that came first. Bounds hold for all obstacles
/// together. A body that is added many times is kept once.
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
    /// By the address of their objects, which are kept with them.
    bodies: Mutex<HashMap<usize, (Piece, AnyBody)>>,
}

impl Obstacles {
    /// Asks about one body, without the interpreter's lock.
    fn ask<T: Send>(
        &self,
        py: Python<'_>,
        (body, at): (Piece, colltrans::Pose),
        ignore: HashSet<u64>,
        question: impl FnOnce(&Among<'_>) -> Result<T, QueryError> + Send,
    ) -> PyResult<(T, Asked)> {
        let asked = || {
            let kept = self.scene.read();
            let found = kept.ask((&body, at), &ignore, question)?;
            Ok::<_, QueryError>((found, kept.changes))
        };
        let (found, changes) = py.detach(asked).or_raise()?;
        Ok((found, Asked { scene: self.scene.clone(), changes, body, at, ignore }))
    }

    /// Asks rows, on some threads.
    fn ask_rows<T: Send>(
        &self,
        py: Python<'_>,
        (body, poses): (&Piece, &[colltrans::Pose]),
        ignore: &HashSet<u64>,
        threads: Option<usize>,
        question: impl Fn(usize, &Among<'_>) -> Result<T, QueryError> + Sync,
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

/// How far a body may move that is to keep a gap, past what is met before a translation.
fn clearance_keeping(
    among: &Among<'_>,
    direction: DVec3,
    before: f64,
    keep: f64,
) -> Result<ClearanceAmong, QueryError> {
    keeping(among, keep)?.clearance_before(direction, before)
}

fn lock<T>(of: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

fn unknown(obstacle: u64) -> PyErr {
    PyKeyError::new_err(format!("there is no obstacle {obstacle}, or not any more"))
}

/// Poses of an array or a sequence.
fn poses(of: &Bound<'_, PyAny>) -> PyResult<Vec<colltrans::Pose>> {
    of.try_iter()?.map(|one| pose(Some(&one?), "poses")).collect()
}

fn vectors(py: Python<'_>, all: Vec<[f64; 3]>) -> PyResult<Bound<'_, PyAny>> {
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
    ///     Where it is.
    ///
    /// Returns
    /// -------
    /// int
    ///     Its number, which stays valid whatever else comes, moves and goes, and is never used again.
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

    /// Adds many, in one pass.
    ///
    /// Parameters
    /// ----------
    /// body : ConvexPolyhedron, Solid or sequence of them
    ///     One for all poses, or one for each.
    /// poses : array_like of shape (N, ...), or sequence of Pose
    ///
    /// Returns
    /// -------
    /// list of int
    fn add_many(
        &self,
        py: Python<'_>,
        body: &Bound<'_, PyAny>,
        poses: &Bound<'_, PyAny>,
    ) -> PyResult<Vec<u64>> {
        let poses = self::poses(poses)?;
        if Piece::of(body, "body").is_ok() {
            return self.insert(py, std::slice::from_ref(body), poses);
        }
        let bodies = body.try_iter()?.collect::<PyResult<Vec<_>>>()?;
        if bodies.len() != poses.len() {
            let what = format!("{} bodies for {} poses", bodies.len(), poses.len());
            return Err(input("body", what));
        }
        self.insert(py, &bodies, poses)
    }

    /// Puts an obstacle elsewhere.
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     There is no such one.
    fn set_pose(&self, py: Python<'_>, obstacle: u64, pose: &Bound<'_, PyAny>) -> PyResult<()> {
        let at = self::pose(Some(pose), "pose")?;
        let set = || self.scene.change(|all| all.set_pose(ObstacleId(obstacle), at));
        py.detach(set).map_err(|_| unknown(obstacle))
    }

    /// Puts many elsewhere, in one pass: all of them, or, with a KeyError, none.
    fn set_poses(
        &self,
        py: Python<'_>,
        obstacles: Vec<u64>,
        poses: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let poses = self::poses(poses)?;
        if obstacles.len() != poses.len() {
            let what = format!("{} obstacles for {} poses", obstacles.len(), poses.len());
            return Err(input("poses", what));
        }
        let moves: Vec<_> = obstacles.into_iter().map(ObstacleId).zip(poses).collect();
        py.detach(|| self.scene.change(|all| all.set_poses(&moves)))
            .map_err(|what| unknown(what.id.0))
    }

    /// Takes an obstacle away.
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     There is no such one.
    fn remove(&self, py: Python<'_>, obstacle: u64) -> PyResult<()> {
        let removed = py.detach(|| self.scene.change(|all| all.remove(ObstacleId(obstacle))));
        removed.map(|_| ()).ok_or_else(|| unknown(obstacle))
    }

    /// Where an obstacle is.
    ///
    /// Returns
    /// -------
    /// Pose
    fn pose(&self, py: Python<'_>, obstacle: u64) -> PyResult<Pose> {
        let at = || self.scene.read().obstacles.get(ObstacleId(obstacle)).map(|(_, pose)| pose);
        py.detach(at).map(Pose).ok_or_else(|| unknown(obstacle))
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

    /// Which obstacle is nearest to a body, and how far is it?
    ///
    /// Parameters
    /// ----------
    /// body : ConvexPolyhedron or Solid
    /// pose : array_like or Pose, optional
    ///     Where it is.
    /// ignore : iterable of int
    ///     Obstacles that are not asked about: the parts of a gripper, say.
    ///
    /// Returns
    /// -------
    /// NearestObstacle or None
    ///     None if there are none.
    ///
    /// Raises
    /// ------
    /// QueryError
    ///     A convex body whose facets make no surface, where a solid is asked about it.
    #[pyo3(signature = (body, pose=None, *, ignore=HashSet::new()),
        text_signature = "($self, body, pose=None, *, ignore=())")]
    fn nearest(
        &self,
        py: Python<'_>,
        body: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = numbers)] ignore: HashSet<u64>,
    ) -> PyResult<Option<NearestObstacle>> {
        let (body, at) = (Piece::of(body, "body")?, self::pose(pose, "pose")?);
        let (found, asked) = self.ask(py, (body, at), ignore, |among| among.nearest())?;
        Ok(found.map(|found| NearestObstacle { found, asked }))
    }

    /// Which obstacles are closer to a body than a length?
    ///
    /// Parameters
    /// ----------
    /// body, pose, ignore
    ///     As for :meth:`nearest`.
    /// length : float
    ///     In world units.
    ///
    /// Returns
    /// -------
    /// NearbyObstacles
    ///     Those that are, and those of which rounding cannot tell, each in the order in which they came; it
    ///     unpacks into the two.
    #[pyo3(signature = (body, length, pose=None, *, ignore=HashSet::new()),
        text_signature = "($self, body, length, pose=None, *, ignore=())")]
    fn within(
        &self,
        py: Python<'_>,
        body: &Bound<'_, PyAny>,
        length: f64,
        pose: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = numbers)] ignore: HashSet<u64>,
    ) -> PyResult<NearbyObstacles> {
        let (body, at) = (Piece::of(body, "body")?, self::pose(pose, "pose")?);
        let (found, asked) = self.ask(py, (body, at), ignore, |among| among.within(length))?;
        Ok(NearbyObstacles { found, length, asked })
    }

    /// How far can a body move along a direction, and what stops it?
    ///
    /// Parameters
    /// ----------
    /// body, pose, ignore
    ///     As for :meth:`nearest`.
    /// direction : array_like of shape (3,)
    ///     Of any length; translations count in multiples of it.
    /// before : float, optional
    ///     What is not met before this translation is of no interest.
    /// keep : float
    ///     A gap to be kept, a length: how far until an obstacle is as near as that.
    ///
    /// Returns
    /// -------
    /// ObstacleClearance
    #[pyo3(signature = (body, direction, pose=None, *, before=None, keep=0.0,
        ignore=HashSet::new()), text_signature = "($self, body, direction, pose=None, *, \
        before=None, keep=0.0, ignore=())")]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn clearance(
        &self,
        py: Python<'_>,
        body: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
        before: Option<f64>,
        keep: f64,
        #[pyo3(from_py_with = numbers)] ignore: HashSet<u64>,
    ) -> PyResult<ObstacleClearance> {
        let (body, at) = (Piece::of(body, "body")?, self::pose(pose, "pose")?);
        let direction = vector(direction, "direction")?;
        let before = before.unwrap_or(f64::INFINITY);
        let ask = |among: &Among<'_>| clearance_keeping(among, direction, before, keep);
        let (found, asked) = self.ask(py, (body, at), ignore, ask)?;
        Ok(ObstacleClearance { found, direction, keep, asked })
    }

    /// :meth:`nearest` of many poses, on some threads.
    ///
    /// Parameters
    /// ----------
    /// body, ignore
    ///     As for :meth:`nearest`.
    /// poses : array_like of shape (N, ...), or sequence of Pose
    /// threads : int, optional
    ///     By default as many as there are processors. Answers do not depend on it.
    ///
    /// Returns
    /// -------
    /// dict of ndarray
    ///     Columns ``obstacle`` (-1 if there are none), ``lower``, ``upper``, ``on_moving`` and ``on_fixed``.
    #[pyo3(signature = (body, poses, *, ignore=HashSet::new(), threads=None),
        text_signature = "($self, body, poses, *, ignore=(), threads=None)")]
    fn nearest_many<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        poses: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = numbers)] ignore: HashSet<u64>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (body, poses) = (Piece::of(body, "body")?, self::poses(poses)?);
        let found = self.ask_rows(py, (&body, &poses), &ignore, threads, |_, a| a.nearest())?;
        let column = |of: fn(&colltrans::Nearest) -> f64| -> Vec<f64> {
            found.iter().map(|n| n.as_ref().map_or(f64::INFINITY, of)).collect()
        };
        let points = |of: fn(&colltrans::AnyDistance) -> DVec3| {
            let point = |n: &colltrans::Nearest| of(&n.distance).to_array();
            let all = found.iter().map(|n| n.as_ref().map_or([f64::NAN; 3], point));
            vectors(py, all.collect())
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

    /// :meth:`clearance` of many poses and directions, on some threads.
    ///
    /// Parameters
    /// ----------
    /// body, before, keep, ignore
    ///     As for :meth:`clearance`.
    /// directions : array_like of shape (N, 3) or (3,)
    ///     One for each pose, or one for all.
    /// poses, threads
    ///     As for :meth:`nearest_many`.
    ///
    /// Returns
    /// -------
    /// dict of ndarray
    ///     Columns ``outcome`` (0 is blocked, 1 free, 2 overlapping), ``obstacle`` (-1 if nothing stops it),
    ///     ``distance`` (NaN where bodies overlap) and ``upper``.
    #[pyo3(signature = (body, directions, poses, *, before=None, keep=0.0,
        ignore=HashSet::new(), threads=None), text_signature = "($self, body, directions, poses, \
        *, before=None, keep=0.0, ignore=(), threads=None)")]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn clearance_many<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        poses: &Bound<'py, PyAny>,
        before: Option<f64>,
        keep: f64,
        #[pyo3(from_py_with = numbers)] ignore: HashSet<u64>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (body, poses) = (Piece::of(body, "body")?, self::poses(poses)?);
        let one = vector(directions, "directions").map(|one| vec![one]);
        let rows = || directions.try_iter()?.map(|one| vector(&one?, "directions")).collect();
        let directions: Vec<DVec3> = one.or_else(|_| rows())?;
        if directions.len() != 1 && directions.len() != poses.len() {
            let what = format!("{} for {} poses", directions.len(), poses.len());
            return Err(input("directions", what));
        }
        let before = before.unwrap_or(f64::INFINITY);
        let ask = |k: usize, among: &Among<'_>| {
            clearance_keeping(among, directions[k.min(directions.len() - 1)], before, keep)
        };
        let found = self.ask_rows(py, (&body, &poses), &ignore, threads, ask)?;
        let kind = |one: &ClearanceAmong| match outcome_of(one) {
            "blocked" => 0_u8,
            "free" => 1,
            _ => 2,
        };
        let columns = PyDict::new(py);
        let outcome: Vec<u8> = found.iter().map(kind).collect();
        let id = |one: &ClearanceAmong| one.stop.map_or(-1, |(id, _)| id.0 as i64);
        let ids: Vec<i64> = found.iter().map(id).collect();
        let distance = found.iter().map(|one| one.distance().unwrap_or(f64::NAN));
        let upper = found.iter().map(upper_of);
        columns.set_item("outcome", outcome.into_pyarray(py))?;
        columns.set_item("obstacle", ids.into_pyarray(py))?;
        columns.set_item("distance", distance.collect::<Vec<_>>().into_pyarray(py))?;
        columns.set_item("upper", upper.collect::<Vec<_>>().into_pyarray(py))?;
        Ok(columns)
    }
}

impl Obstacles {
    /// Bodies at poses: one for each, or one for all.
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

    /// A body as it is kept: one object once.
    fn body(&self, body: &Bound<'_, PyAny>) -> PyResult<AnyBody> {
        let piece = Piece::of(body, "body")?;
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

/// Numbers of obstacles.
fn numbers(of: &Bound<'_, PyAny>) -> PyResult<HashSet<u64>> {
    of.try_iter()?.map(|one| one?.extract()).collect()
}
