//! Robots on joint paths: the first contact between two links, or between a link and the scene.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use colltrans::glam::DVec3;
use colltrans::motion::path::{
    JointPath, PathCast, PathContact, PathOutcome, PathPlace, PathProof,
};
use colltrans::record::PathRecord;
use colltrans::{AnyBody, AnyPlaced, ProofFile, Statement};
use colltrans_assembly_io::read::{self, ReadOptions};
use colltrans_assembly_io::robot::{Cell, Robot as Arm, RobotJoint, Table};
use colltrans_mesh::body::drawn_body;
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::answer::save;
use crate::arrays::{Vector, coordinates, row, table};
use crate::bulk::{Answered, Plan};
use crate::columns::{self, Row};
use crate::errors::{OrRaise, error, input_error};
use crate::frozen::{
    Options, Reduced, Shown, getters, match_args, plain, read, reduced, show, written,
};
use crate::number::{middle, number};
use crate::solid::Piece;

/// Time between two polls for signals.
const PATIENCE: Duration = Duration::from_millis(100);
/// The names of the outcomes, in the order of their numbers. The last one is that of a row without an answer.
const OUTCOMES: [&str; 6] = ["contact", "grazing", "free", "overlapping", "undecided", "error"];

/// A robot of a URDF file: links with their collision bodies, and the joints between them.
///
/// Built by :meth:`read`.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Robot {
    arm: Arm,
    /// Pairs of links that an SRDF file excludes from collision checks.
    listed: Option<Vec<[String; 2]>>,
}

/// A query for one path or many: the robot in its scene, and the minimum gap.
struct PathRequest {
    cell: Cell,
    min_gap: f64,
}

/// A path as the caller gives it.
struct Rows {
    /// The name of the file and a colon; empty for an array.
    place: String,
    table: Table,
    rest: BTreeMap<String, f64>,
}

fn any_body(piece: &Piece) -> AnyBody {
    match piece {
        Piece::Convex(body) => AnyBody::from(body.get().0.clone()),
        Piece::Solid(solid) => AnyBody::from(solid.get().solid.clone()),
    }
}

impl Robot {
    fn asked(
        &self,
        scene: Option<&Bound<'_, PyAny>>,
        ignore: &[[String; 2]],
        min_gap: f64,
    ) -> PyResult<PathRequest> {
        let (mut bodies, mut dents) = (Vec::new(), Vec::new());
        if let Some(scene) = scene {
            let named = PyDict::new(scene.py());
            let Ok(mapping) = scene.cast() else {
                let kind = scene.get_type().name()?;
                let what = "a dict of names to bodies, such as {\"wire\": body}";
                return Err(input_error("scene", format_args!("{what}, not a {kind}")));
            };
            named.update(mapping)?;
            for (name, body) in named {
                let name: String = name.extract()?;
                let piece = Piece::from_python(&body, &format!("scene[{name:?}]"))?;
                dents.extend(piece.dent().map(|depth| (name.clone(), depth)));
                bodies.push((name, any_body(&piece)));
            }
        }
        let cell = Cell::new(self.arm.clone(), bodies, self.listed.as_deref());
        let cell = cell.map_err(|what| input_error("srdf", what))?;
        let cell = cell
            .with_dents(dents)
            .without_pairs(ignore)
            .map_err(|what| input_error("ignore", what))?;
        let cell = cell.require_pair().map_err(|what| input_error("scene", what))?;
        Ok(PathRequest { cell, min_gap })
    }
}

impl PathRequest {
    fn path(&self, rows: &Rows) -> Result<(JointPath, Vec<String>), String> {
        let path = self.cell.robot().joint_path(&rows.table, &rows.rest);
        path.map_err(|what| format!("{}{what}", rows.place))
    }

    fn cast<'a>(&'a self, path: &'a JointPath) -> Result<PathCast<'a>, String> {
        self.cell.path_cast(path, self.min_gap).map_err(|what| self.cell.error_message(&what))
    }

    fn first_contact(&self, path: &JointPath) -> Result<(PathOutcome, PathRecord), String> {
        let cast = self.cast(path)?;
        let found = cast.first_contact().map_err(|what| self.cell.error_message(&what))?;
        let record = PathRecord::from_outcome(&found, &cast, self.cell.names());
        Ok((found, record))
    }
}

impl Rows {
    /// Reads the rows of a file or an array.
    fn read(
        path: &Bound<'_, PyAny>,
        columns: Option<Vec<String>>,
        times: Option<&Bound<'_, PyAny>>,
        rest: BTreeMap<String, f64>,
    ) -> PyResult<Self> {
        let is_file = path.is_instance_of::<PyString>() || path.hasattr("__fspath__")?;
        if !is_file {
            let (place, table) = (String::new(), table_of(path, columns, times)?);
            return Ok(Self { place, table, rest });
        }
        if columns.is_some() || times.is_some() {
            return Err(input_error(
                "path",
                "columns and times are given, but a path file has its own; drop them",
            ));
        }
        let file: PathBuf = path.extract()?;
        let place = file.display().to_string();
        let text = colltrans_mesh::file::text(&file)
            .map_err(|what| input_error("path", format_args!("cannot read {place}: {what}")))?;
        let table = Table::parse(&text)
            .map_err(|what| input_error("path", format_args!("{place}: {what}")))?;
        Ok(Self { place: format!("{place}: "), table, rest })
    }
}

/// Converts an array of rows.
fn table_of(
    rows: &Bound<'_, PyAny>,
    names: Option<Vec<String>>,
    times: Option<&Bound<'_, PyAny>>,
) -> PyResult<Table> {
    let floats = rows.py().import("colltrans._arrays")?.getattr("floats")?;
    let array = floats.call1((rows, "path"))?;
    let shape = array.getattr("shape")?;
    let array: PyReadonlyArray2<'_, f64> = array.extract().map_err(|_| {
        input_error("path", format_args!("an array of shape {shape}, not (N, joints)"))
    })?;
    let rows: Vec<Vec<f64>> = array.as_array().outer_iter().map(|row| row.to_vec()).collect();
    if let Some(names) = &names
        && let Some(row) = rows.first().filter(|row| row.len() != names.len())
    {
        let what = format!("{} names for rows of {} values", names.len(), row.len());
        return Err(input_error("columns", what));
    }
    let times = times
        .map(|times| {
            let array = floats.call1((times, "times"))?;
            let array: PyReadonlyArray1<'_, f64> =
                array.extract().map_err(|_| input_error("times", "not an array of shape (N,)"))?;
            Ok::<_, PyErr>(array.as_array().to_vec())
        })
        .transpose()?;
    Ok(Table { names, times, rows, ..Table::default() })
}

getters!(Robot, |it| {
    /// str: The name of the robot.
    name: &str = it.arm.name();
    /// list of str: The names of its links.
    links: Vec<&str> = it.arm.links().iter().map(|link| link.name.as_str()).collect();
    /// list of str: The independent joints, in the order of the values of a row.
    joints: Vec<&str> = {
        let own = it.arm.joints().iter().filter(|joint| joint.mimic.is_none());
        own.map(|joint| joint.name.as_str()).collect()
    };
    /// dict of str to tuple of (float, float): The limits of joints that have some, in radians or metres.
    limits: BTreeMap<&str, (f64, f64)> = {
        let of = |joint: &'_ RobotJoint| -> Option<(f64, f64)> { joint.limits.map(Into::into) };
        let joints = it.arm.joints().iter();
        joints.filter_map(|joint| Some((joint.name.as_str(), of(joint)?))).collect()
    };
    /// list of str: Diagnostics of reading the file.
    notes: Vec<String> = it.arm.notes().to_vec();
});

#[pymethods]
impl Robot {
    /// Reads a robot from a URDF, SDF or MJCF file, in metres and radians.
    ///
    /// Joints may be revolute, continuous, prismatic or fixed, and may follow others (``mimic``). Spheres and
    /// capsules are exact. Cylinders are replaced by circumscribed prisms. The links of an MJCF file (MuJoCo) are its
    /// bodies and the ``world``; other geoms than spheres, capsules, boxes and cylinders are rejected. In SDF (Gazebo),
    /// links of nested models, and of the models of a world, are named ``model::link``; ``mimic`` is not applied.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    /// srdf : str or os.PathLike, optional
    ///     A file whose ``disable_collisions`` excludes pairs of links from collision checks. The default
    ///     excludes links with one moving joint between them.
    /// packages : list of str or os.PathLike
    ///     Folders in which ``package://`` references are searched.
    /// skip_missing : bool
    ///     Whether to leave out meshes that cannot be found, with a note.
    /// allow_outside : bool
    ///     Whether to read files outside the folder of the robot's file and outside all packages.
    /// hulls : list of str
    ///     Links whose meshes are replaced by their convex hulls, for meshes that do not bound a body;
    ///     ``"*"`` stands for all links.
    ///
    /// Returns
    /// -------
    /// Robot
    ///
    /// Raises
    /// ------
    /// AssemblyError
    ///     A file is invalid; the message has the reason and the place.
    /// InputError
    ///     The SRDF file names a link that the robot does not have.
    #[staticmethod]
    #[pyo3(signature = (path, *, srdf=None, packages=Vec::new(), skip_missing=false,
        allow_outside=false, hulls=Vec::new()))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        srdf: Option<PathBuf>,
        packages: Vec<PathBuf>,
        skip_missing: bool,
        allow_outside: bool,
        hulls: Vec<String>,
    ) -> PyResult<Self> {
        let options = ReadOptions::default()
            .with_hulls(hulls)
            .with_packages(packages)
            .with_skip_missing(skip_missing)
            .with_allow_outside(allow_outside);
        py.detach(|| {
            let arm = read::read_robot(&path, &options).or_raise()?;
            let listed = srdf.as_deref().map(read::read_disabled_pairs).transpose().or_raise()?;
            // Checks that the names in the SRDF file are links of this robot.
            arm.checked_pairs(listed.as_deref()).map_err(|what| match &srdf {
                Some(file) => input_error("srdf", format_args!("{}: {what}", file.display())),
                None => input_error("srdf", what),
            })?;
            Ok(Self { arm, listed })
        })
    }

    /// Computes when two bodies first meet on a joint path, and which.
    ///
    /// All links are checked against the scene and against each other, except neighbours, or the pairs that
    /// the SRDF file excludes. Each joint moves linearly from row to row.
    ///
    /// Parameters
    /// ----------
    /// path : array_like of shape (N, J), or str or os.PathLike
    ///     Rows of joint values, in radians or metres, in the order of :attr:`joints`; or a CSV or JSON file
    ///     of such rows.
    /// scene : dict of str to ConvexPolyhedron or Solid, optional
    ///     Bodies of the scene, in metres, by name.
    /// ignore : list of tuple of (str, str)
    ///     Pairs of links, or of a link and a scene body, that are excluded from collision checks.
    /// min_gap : float
    ///     A minimum gap, in metres. With a gap, two bodies count as meeting as soon as their distance falls to it.
    /// joints : dict of str to float, optional
    ///     Joints with fixed values. These joints have no column.
    /// columns : list of str, optional
    ///     The joints of the columns, if their order differs.
    /// times : array_like of shape (N,), optional
    ///     The times of the rows. Without them the rows are counted from 0.
    ///
    /// Returns
    /// -------
    /// PathContact
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The rows do not fit the joints, the times do not increase, or a name is unknown.
    /// QueryError
    ///     The library rejects the query.
    #[pyo3(signature = (path, scene=None, *, ignore=Vec::new(), min_gap=0.0, joints=BTreeMap::new(),
        columns=None, times=None))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn first_contact(
        &self,
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        scene: Option<&Bound<'_, PyAny>>,
        ignore: Vec<[String; 2]>,
        min_gap: f64,
        joints: BTreeMap<String, f64>,
        columns: Option<Vec<String>>,
        times: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PathAnswer> {
        let asked = Arc::new(self.asked(scene, &ignore, min_gap)?);
        let rows = Rows::read(path, columns, times, joints)?;
        let (path, said) = asked.path(&rows).map_err(|what| input_error("path", what))?;
        let notes = [asked.cell.notes(), &said].concat();
        let found = run_interruptible(py, || asked.first_contact(&path))?;
        let (found, mut record) = found.map_err(|what| error("QueryError", what))?;
        record.hulls = asked.cell.hull_links();
        record.dents.clone_from(asked.cell.dents());
        record.notes = rows.table.unused_note().into_iter().collect();
        let (end, question) = (end_of(&path), Question::Request(asked, path));
        Ok(PathAnswer { question, end, found, record, notes })
    }

    fn __repr__(&self) -> String {
        let (links, joints) = (self.arm.links().len(), self.joints().len());
        format!("Robot({:?}, {links} links, {joints} joints)", self.arm.name())
    }
}

/// Runs work on a thread of its own and polls for signals. If a signal handler raises, the exception is
/// returned after the work ends.
fn run_interruptible<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let done = Mutex::new(None);
    py.detach(|| {
        std::thread::scope(|scope| {
            let worker = scope.spawn(|| {
                let found = work();
                *done.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
            });
            let mut nap = Duration::from_micros(20);
            while !worker.is_finished() {
                std::thread::sleep(nap);
                if nap < PATIENCE {
                    nap = (nap * 2).min(PATIENCE);
                } else {
                    Python::attach(|py| py.check_signals())?;
                }
            }
            Ok::<_, PyErr>(())
        })
    })?;
    let found = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    found.ok_or_else(|| error("QueryError", "internal error; please report it"))
}

/// The first contact of two bodies on a joint path.
///
/// The ``outcome`` is one of:
///
/// - ``"contact"``: no two bodies meet before ``lower``, and at ``upper`` the bodies of ``pair`` do;
/// - ``"grazing"``: no two meet before ``lower``, then these two come closer than rounding can resolve; the
///   time after it is not examined;
/// - ``"free"``: no two meet on the whole path;
/// - ``"overlapping"``: two bodies overlap at the start of the path;
/// - ``"undecided"``: the search for ``pair`` reached its maximum number of steps. No two meet before
///   ``lower``; later contacts of these two are open.
#[pyclass(frozen, module = "colltrans.robots", name = "PathContact")]
pub(crate) struct PathAnswer {
    question: Question,
    /// The end of the path, and the index of its last row.
    end: (f64, usize),
    found: PathOutcome,
    record: PathRecord,
    notes: Vec<String>,
}

/// The query of an answer: of a robot, or restored from a pickle.
enum Question {
    Request(Arc<PathRequest>, JointPath),
    Saved(Box<ProofFile>),
}

impl Question {
    /// Calls a function with the cast and the names of its bodies.
    fn with<T>(
        &self,
        of: impl FnOnce(&PathCast<'_>, &[String]) -> Result<T, String>,
    ) -> Result<T, String> {
        match self {
            Self::Request(asked, path) => of(&asked.cast(path)?, asked.cell.names()),
            Self::Saved(file) => {
                let (cast, names) = file.path_query().ok_or(NO_PATH)?;
                of(&cast, &names)
            }
        }
    }
}

const NO_PATH: &str = "the proof is not about a path";

/// Returns the proof in an answer.
fn proof_of(found: &mut PathOutcome) -> Option<&mut PathProof> {
    match found {
        PathOutcome::Contact(of)
        | PathOutcome::Grazing(of)
        | PathOutcome::Overlapping(of)
        | PathOutcome::Undecided(of) => Some(&mut of.proof),
        PathOutcome::Free(of) => Some(&mut of.proof),
        _ => None,
    }
}

/// A name, vertices in the world, and triangles.
type NamedMesh<'py> = (String, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// Returns the vertices of a body in its frame, and its triangles. Faces with more vertices become fans. A rounded body
/// is replaced by a polyhedron with vertices on its surface.
fn mesh_of(body: AnyPlaced<'_>) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    match body {
        AnyPlaced::Solid(placed) => {
            (placed.body.vertices().to_vec(), placed.body.triangles().to_vec())
        }
        AnyPlaced::Convex(placed) => {
            let body = drawn_body(placed.body);
            let fan = |face: u32| {
                let corners: Vec<u32> = body.face_vertices(face).collect();
                let ends = corners.windows(2).skip(1).map(|ends| [corners[0], ends[0], ends[1]]);
                ends.collect::<Vec<_>>()
            };
            let faces = 0..body.face_count() as u32;
            (body.vertices().to_vec(), faces.flat_map(fan).collect())
        }
    }
}

fn end_of(path: &JointPath) -> (f64, usize) {
    (path.time_range()[1], path.rows().len() - 1)
}

match_args!(PathAnswer("outcome", "lower", "upper"));

impl PathAnswer {
    fn contact(&self) -> Option<&PathContact> {
        match &self.found {
            PathOutcome::Contact(of)
            | PathOutcome::Grazing(of)
            | PathOutcome::Overlapping(of)
            | PathOutcome::Undecided(of) => Some(of),
            _ => None,
        }
    }

    /// Runs the query again and returns its answer and the file with its proof.
    fn outcome_and_proof(&self, py: Python<'_>) -> PyResult<(PathOutcome, ProofFile)> {
        let told = run_interruptible(py, || {
            self.question.with(|cast, names| {
                ProofFile::with_path(cast, names).map_err(|what| what.to_string())
            })
        })?;
        told.map_err(|what| error("CaseError", what))
    }
}

number!(PathAnswer, Option<f64>, |it| match it.found {
        PathOutcome::Undecided(_) => None,
        PathOutcome::Free(_) => Some(f64::INFINITY),
        _ => Some(middle(it.lower(), it.upper())),
    },
    /// float or None: The time of the first contact: the middle of both bounds, or ``lower`` without a finite ``upper``.
    /// Infinite if no bodies meet. None if the answer is undecided, for which ``float`` raises a TypeError.
);

getters!(PathAnswer, |it| {
    /// str: ``"contact"``, ``"grazing"``, ``"free"``, ``"overlapping"`` or ``"undecided"``.
    outcome: &'static str = it.record.outcome.name();
    /// float: No two bodies meet before this time: the end of the path if none meet, its start if two overlap
    /// there.
    lower: f64 = it.contact().map_or(it.end.0, |contact| contact.lower);
    /// float: Two bodies meet at this time; infinite if that is not proven, or if none meet.
    upper: f64 = it.contact().map_or(f64::INFINITY, |contact| contact.upper);
    /// tuple of (str, str) or None: The two bodies, links or scene bodies.
    pair: Option<(&str, &str)> = it.record.pair.as_ref().map(|[a, b]| (a.as_str(), b.as_str()));
    /// tuple of (int, float) or None: The position of ``lower`` on the path: the row before it, and the
    /// fraction of the step to the next row; None if no bodies meet.
    place: Option<(usize, f64)> = it.record.place.map(|place| (place.row, place.share));
    /// ndarray of shape (3,) or None: The point of the first body that is nearest to the second at that time,
    /// in the world.
    point(py): Option<Vector<'py>> = it.contact()?.points.map(|points| row(py, points[0]));
    /// ndarray of shape (3,) or None: Unit normal in the world, from the first body to the second.
    normal(py): Option<Vector<'py>> = it.contact()?.normal.map(|normal| row(py, normal));
    /// list of tuple of (str, str): All pairs that overlap at the start of the path, or are as near as
    /// ``min_gap`` there.
    overlaps: Vec<(String, String)> = it.record.overlaps.iter().cloned().map(Into::into).collect();
    /// list of str: Links whose meshes are replaced by their convex hulls. A contact of such a link is one of
    /// its hull.
    hulls: Vec<String> = it.record.hulls.clone();
    /// int: Number of pairs of bodies that were checked.
    pairs: usize = it.record.pairs;
    /// int: Number of distance samples.
    looks: u32 = it.record.looks;
    /// int: Number of planes in the proof.
    planes: usize = it.record.planes;
    /// list of str: Pairs that were excluded by default, exclusions without an effect, values beyond the limits
    /// of a joint, and fields of a path file that are not used.
    notes: Vec<String> = it.notes.clone();
});

#[pymethods]
impl PathAnswer {
    /// Checks the proof with the robot, its path and the scene alone, without a search.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        let checked = run_interruptible(py, || {
            self.question
                .with(|cast, _| cast.verify(self.found.proof()).map_err(|what| what.to_string()))
        })?;
        checked.map(|_| ()).map_err(|what| error("CertificateError", what))
    }

    /// Returns the proof with everything that it refers to, as text.
    ///
    /// The text is a file of ``--save-proof`` of ``colltrans path``, which ``colltrans verify`` and ``python -m
    /// colltrans.check`` check. The query runs again to build it.
    ///
    /// Returns
    /// -------
    /// str
    ///
    /// Raises
    /// ------
    /// CaseError
    ///     The library cannot build the proof file; the message has the reason.
    fn proof_json(&self, py: Python<'_>) -> PyResult<String> {
        Ok(self.outcome_and_proof(py)?.1.to_json())
    }

    /// Writes :meth:`proof_json` to a file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    fn save_proof(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        save(&path, self.proof_json(py)?)
    }

    /// Returns the answer as plain Python: the fields of ``--json`` of ``colltrans path``, with the same
    /// bits.
    ///
    /// Returns
    /// -------
    /// dict
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        plain(py, &self.record)
    }

    /// Returns all bodies as meshes, at a position on the path and up to rounding.
    ///
    /// Parameters
    /// ----------
    /// place : tuple of (int, float), optional
    ///     A row, and the fraction of the step to the next row. The default is the position of ``lower``, or
    ///     the end of the path if no bodies meet.
    ///
    /// Returns
    /// -------
    /// list of tuple of (str, ndarray of shape (V, 3), ndarray of shape (T, 3))
    ///     The bodies of the links, then the scene bodies: for each the name of its owner, its vertices in
    ///     the world, and its triangles as indices of vertices.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The position is not on the path: there is no such row, or the fraction is not between 0 and 1.
    #[pyo3(signature = (place=None))]
    fn meshes<'py>(
        &self,
        py: Python<'py>,
        place: Option<(usize, f64)>,
    ) -> PyResult<Vec<NamedMesh<'py>>> {
        let (row, share) = place.or_else(|| self.place()).unwrap_or((self.end.1, 0.0));
        let is_one =
            (0.0..=1.0).contains(&share) && (row < self.end.1 || (row, share) == (self.end.1, 0.0));
        if !is_one {
            return Err(input_error(
                "place",
                format_args!("a path of {} rows has no {row}, {share}", self.end.1 + 1),
            ));
        }
        let told = self.question.with(|cast, names| {
            let place = PathPlace { row, share };
            let all = cast.bodies().zip(names).enumerate();
            let placed = |(k, (body, name)): (usize, (AnyPlaced<'_>, &String))| {
                let ((vertices, triangles), pose) = (mesh_of(body), cast.world_pose(k, place));
                let vertices = vertices.iter().map(|v| pose.transform_point(*v).to_array());
                (name.clone(), vertices.collect::<Vec<_>>(), triangles)
            };
            Ok(all.map(placed).collect::<Vec<_>>())
        });
        let told = told.map_err(|what| error("QueryError", what))?;
        let arrays = told.into_iter().map(|(name, vertices, triangles)| {
            Ok((name, table(py, vertices)?, table(py, triangles)?))
        });
        arrays.collect()
    }

    /// Draws a picture; see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    /// Returns the state for a pickle: the file of the proof, the answer without its proof, and the notes.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Reduced<'py, (String, String, Vec<String>)>> {
        let (mut found, file) = self.outcome_and_proof(py)?;
        let record =
            file.path_query().map(|(cast, names)| PathRecord::from_outcome(&found, &cast, &names));
        if record.is_none_or(|record| record != self.record) {
            return Err(error("CaseError", "the saved proof file restores other bodies"));
        }
        if let Some(proof) = proof_of(&mut found) {
            *proof = PathProof::default();
        }
        reduced::<Self, _>(py, (file.to_json(), written(&found)?, self.notes.clone()))
    }

    #[staticmethod]
    fn _of(file: &str, found: &str, notes: Vec<String>) -> PyResult<Self> {
        let file = ProofFile::from_json(file).or_raise()?;
        let mut found: PathOutcome = read(found)?;
        let ((cast, names), Statement::Path(of)) =
            (file.path_query().ok_or_else(|| error("CaseError", NO_PATH))?, file.statement())
        else {
            return Err(error("CaseError", NO_PATH));
        };
        if let Some(proof) = proof_of(&mut found) {
            proof.clone_from(&of.proof);
        }
        let (record, end) = (PathRecord::from_outcome(&found, &cast, &names), end_of(cast.path()));
        Ok(Self { question: Question::Saved(Box::new(file)), end, found, record, notes })
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __repr__(&self) -> String {
        let upper = self.upper();
        let pair = self.pair().map(|(a, b)| format!(", {a:?} and {b:?}")).unwrap_or_default();
        let notes = self.record.notes.iter().map(String::as_str);
        let only = std::iter::once("").chain(notes).collect::<Vec<_>>().join(", only ");
        let (outcome, lower) = (self.outcome(), self.lower());
        format!("PathContact({outcome:?}, lower={lower:?}, upper={upper:?}{pair}{only})")
    }
}

/// Writes an answer to the columns. `end` is the time of the end of the path.
fn write_row(row: &mut Row<'_>, outcome: &PathOutcome, end: f64) {
    let (code, of) = match outcome {
        PathOutcome::Contact(of) => (0, of),
        PathOutcome::Grazing(of) => (1, of),
        PathOutcome::Overlapping(of) => (3, of),
        PathOutcome::Undecided(of) => (4, of),
        _ => {
            row.set_outcome(2)
                .set_number(columns::AT_LEAST, end)
                .set_number(columns::AT_MOST, f64::INFINITY);
            return;
        }
    };
    row.set_outcome(code)
        .set_number(columns::AT_LEAST, of.lower)
        .set_number(columns::AT_MOST, of.upper)
        .set_number(columns::ROW, of.place.row as f64)
        .set_number(columns::SHARE, of.place.share)
        .set_number(columns::FIRST, of.pair[0] as f64)
        .set_number(columns::SECOND, of.pair[1] as f64)
        .set_optional_vector(columns::NORMAL, of.normal.map(coordinates))
        .set_optional_vector(columns::POINT, of.points.map(|points| coordinates(points[0])));
}

/// The extension's part of ``colltrans.path_many``.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are the arguments of path_many")]
pub(crate) fn ask_paths<'py>(
    py: Python<'py>,
    robot: &Bound<'py, Robot>,
    paths: Vec<Bound<'py, PyAny>>,
    scene: Option<&Bound<'py, PyAny>>,
    ignore: Vec<[String; 2]>,
    min_gap: f64,
    joints: BTreeMap<String, f64>,
    columns: Option<Vec<String>>,
    times: Option<Vec<Bound<'py, PyAny>>>,
    told: Vec<String>,
    threads: Option<usize>,
) -> PyResult<(Answered<'py>, Vec<String>)> {
    let asked = robot.get().asked(scene, &ignore, min_gap)?;
    let rows = paths.iter().enumerate().map(|(k, path)| {
        let times = times.as_ref().map(|all| &all[k]);
        Rows::read(path, columns.clone(), times, joints.clone())
    });
    let rows: Vec<Rows> = rows.collect::<PyResult<_>>()?;
    let plan = Plan {
        rows: rows.len(),
        chunk: 1,
        columns: &told,
        featured: false,
        outcomes: &OUTCOMES,
        threads,
    };
    let answered = plan.run(py, |k, row| {
        let (path, _) = asked.path(&rows[k])?;
        asked.first_contact(&path).map(|(found, _)| write_row(row, &found, end_of(&path).0))
    })?;
    Ok((answered, asked.cell.names().to_vec()))
}
