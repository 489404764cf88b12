//! Robots on paths of joint values: which two links first meet, each other or what stands around.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use colltrans::glam::DVec3;
use colltrans::motion::path::{JointPath, PathCast, PathContact, PathOutcome, PathProof, Place};
use colltrans::record::PathRecord;
use colltrans::{AnyBody, AnyPlaced, ProofFile, Statement};
use colltrans_assembly_io::read::{self, ReadOptions};
use colltrans_assembly_io::robot::{Cell, Robot as Arm, RobotJoint, Table};
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::answer::save;
use crate::arrays::{Vector, coordinates, row, table};
use crate::bulk::{Answered, Plan};
use crate::columns::{self, Row};
use crate::errors::{OrRaise, error, input};
use crate::frozen::{
    Options, Reduced, Shown, getters, match_args, plain, read, reduced, show, written,
};
use crate::solid::Piece;

/// Between two looks for signals.
const PATIENCE: Duration = Duration::from_millis(100);
/// The names of the outcomes, by their numbers; the last is that of a row without an answer.
const OUTCOMES: [&str; 6] = ["contact", "grazing", "free", "overlapping", "undecided", "error"];

/// A robot of URDF: links with what they collide with, and the joints between them.
///
/// Made by :meth:`read`.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Robot {
    arm: Arm,
    /// Which links are not held against each other, of an SRDF file.
    listed: Option<Vec<[String; 2]>>,
}

/// What is asked about one path, or many: the robot among what stands around, and the gap to be kept.
struct Asked {
    cell: Cell,
    keep: f64,
}

/// A path, as somebody gives it.
struct Rows {
    /// Of a file its name, with a colon.
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
        keep: f64,
    ) -> PyResult<Asked> {
        let (mut bodies, mut dents) = (Vec::new(), Vec::new());
        if let Some(scene) = scene {
            let named = PyDict::new(scene.py());
            let Ok(mapping) = scene.cast() else {
                let kind = scene.get_type().name()?;
                let what = "a dict of names to bodies, such as {\"wire\": body}";
                return Err(input("scene", format_args!("{what}, not a {kind}")));
            };
            named.update(mapping)?;
            for (name, body) in named {
                let name: String = name.extract()?;
                let piece = Piece::of(&body, &format!("scene[{name:?}]"))?;
                dents.extend(piece.dent().map(|depth| (name.clone(), depth)));
                bodies.push((name, any_body(&piece)));
            }
        }
        let cell = Cell::new(self.arm.clone(), bodies, self.listed.as_deref());
        let cell = cell.map_err(|what| input("srdf", what))?;
        let cell = cell.with_dents(dents).ignoring(ignore).map_err(|what| input("ignore", what))?;
        let cell = cell.with_a_pair().map_err(|what| input("scene", what))?;
        Ok(Asked { cell, keep })
    }
}

impl Asked {
    fn path(&self, rows: &Rows) -> Result<(JointPath, Vec<String>), String> {
        let path = self.cell.robot().path(&rows.table, &rows.rest);
        path.map_err(|what| format!("{}{what}", rows.place))
    }

    fn cast<'a>(&'a self, path: &'a JointPath) -> Result<PathCast<'a>, String> {
        self.cell.along(path, self.keep).map_err(|what| self.cell.words(&what))
    }

    fn first_contact(&self, path: &JointPath) -> Result<(PathOutcome, PathRecord), String> {
        let cast = self.cast(path)?;
        let found = cast.first_contact().map_err(|what| self.cell.words(&what))?;
        let record = PathRecord::of(&found, &cast, self.cell.names());
        Ok((found, record))
    }
}

impl Rows {
    /// Of a file, or of an array.
    fn of(
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
            return Err(input("path", "a file has its own columns and times"));
        }
        let file: PathBuf = path.extract()?;
        let place = file.display().to_string();
        let text = colltrans_mesh::file::text(&file)
            .map_err(|what| input("path", format_args!("{place}: cannot be read: {what}")))?;
        let table =
            Table::parse(&text).map_err(|what| input("path", format_args!("{place}: {what}")))?;
        Ok(Self { place: format!("{place}: "), table, rest })
    }
}

/// An array of rows.
fn table_of(
    rows: &Bound<'_, PyAny>,
    names: Option<Vec<String>>,
    times: Option<&Bound<'_, PyAny>>,
) -> PyResult<Table> {
    let floats = rows.py().import("colltrans._arrays")?.getattr("floats")?;
    let array = floats.call1((rows, "path"))?;
    let shape = array.getattr("shape")?;
    let array: PyReadonlyArray2<'_, f64> = array
        .extract()
        .map_err(|_| input("path", format_args!("an array of shape {shape}, not (N, joints)")))?;
    let rows: Vec<Vec<f64>> = array.as_array().outer_iter().map(|row| row.to_vec()).collect();
    if let Some(names) = &names
        && let Some(row) = rows.first().filter(|row| row.len() != names.len())
    {
        let what = format!("{} names for rows of {} values", names.len(), row.len());
        return Err(input("columns", what));
    }
    let times = times
        .map(|times| {
            let array = floats.call1((times, "times"))?;
            let array: PyReadonlyArray1<'_, f64> =
                array.extract().map_err(|_| input("times", "not an array of shape (N,)"))?;
            Ok::<_, PyErr>(array.as_array().to_vec())
        })
        .transpose()?;
    Ok(Table { names, times, rows, ..Table::default() })
}

getters!(Robot, |it| {
    /// str: Its name.
    name: &str = it.arm.name();
    /// list of str: The names of its links.
    links: Vec<&str> = it.arm.links().iter().map(|link| link.name.as_str()).collect();
    /// list of str: The joints that move by themselves, in the order of the values of a row.
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
    /// list of str: What was noted when it was read.
    notes: Vec<String> = it.arm.notes().to_vec();
});

#[pymethods]
impl Robot {
    /// A robot of a URDF file, in metres and radians.
    ///
    /// Joints may be revolute, continuous, prismatic or fixed, and may follow others (``mimic``). Cylinders
    /// and spheres are taken as polyhedra around them.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    /// srdf : str or os.PathLike, optional
    ///     A file whose ``disable_collisions`` says which links are not held against each other. Without
    ///     it these are links with one moving joint between them.
    /// packages : list of str or os.PathLike
    ///     Where ``package://`` is looked for.
    /// skip_missing : bool
    ///     Leave out meshes that cannot be found, with a note.
    /// allow_outside : bool
    ///     Read files that the robot's file names and that lie outside of its folder and all packages.
    /// hulls : list of str
    ///     Links whose meshes are taken as their convex hulls, for meshes that are no surface of a body;
    ///     ``"*"`` is all links.
    ///
    /// Returns
    /// -------
    /// Robot
    ///
    /// Raises
    /// ------
    /// AssemblyError
    ///     What is wrong with a file, and where.
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
            let arm = read::robot(&path, &options).or_raise()?;
            let listed = srdf.as_deref().map(read::disabled).transpose().or_raise()?;
            // What it names are links of this robot.
            arm.pairs(listed.as_deref()).map_err(|what| match &srdf {
                Some(file) => input("srdf", format_args!("{}: {what}", file.display())),
                None => input("srdf", what),
            })?;
            Ok(Self { arm, listed })
        })
    }

    /// Which two bodies first meet on a path, and when?
    ///
    /// All links are held against the scene, and against each other but for neighbours, or for what the
    /// SRDF file names. From row to row each joint goes evenly.
    ///
    /// Parameters
    /// ----------
    /// path : array_like of shape (N, J), or str or os.PathLike
    ///     Rows of joint values, radians or metres, in the order of :attr:`joints`; or a CSV or JSON file
    ///     of them.
    /// scene : dict of str to ConvexPolyhedron or Solid, optional
    ///     What stands in the world, in metres, by name.
    /// ignore : list of tuple of (str, str)
    ///     Pairs of links, or of a link and what stands there, that are not held against each other.
    /// keep : float
    ///     A gap to be kept: asked is when two are first as near as that.
    /// joints : dict of str to float, optional
    ///     Joints that rest, and their values; they have no column.
    /// columns : list of str, optional
    ///     The joints of the columns, where they are in another order.
    /// times : array_like of shape (N,), optional
    ///     When the rows are reached; without them rows are counted from 0.
    ///
    /// Returns
    /// -------
    /// PathContact
    ///
    /// Raises
    /// ------
    /// InputError
    ///     Rows that do not fit the joints, names that nothing has.
    /// QueryError
    ///     What the library refuses.
    #[pyo3(signature = (path, scene=None, *, ignore=Vec::new(), keep=0.0, joints=BTreeMap::new(),
        columns=None, times=None))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn first_contact(
        &self,
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        scene: Option<&Bound<'_, PyAny>>,
        ignore: Vec<[String; 2]>,
        keep: f64,
        joints: BTreeMap<String, f64>,
        columns: Option<Vec<String>>,
        times: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PathAnswer> {
        let asked = Arc::new(self.asked(scene, &ignore, keep)?);
        let rows = Rows::of(path, columns, times, joints)?;
        let (path, said) = asked.path(&rows).map_err(|what| input("path", what))?;
        let notes = [asked.cell.notes(), &said].concat();
        let found = answered(py, || asked.first_contact(&path))?;
        let (found, mut record) = found.map_err(|what| error("QueryError", what))?;
        record.hulls = asked.cell.hulls();
        record.dents.clone_from(asked.cell.dents());
        record.notes = rows.table.straight().into_iter().collect();
        let (end, question) = (end_of(&path), Question::Asked(asked, path));
        Ok(PathAnswer { question, end, found, record, notes })
    }

    fn __repr__(&self) -> String {
        let (links, joints) = (self.arm.links().len(), self.joints().len());
        format!("Robot({:?}, {links} links, {joints} joints)", self.arm.name())
    }
}

/// Work on a thread of its own, which signals end by ending the waiting.
fn answered<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
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

/// Which two bodies first meet on a path of joint values, and when.
///
/// ``outcome`` is ``"contact"``: no two meet before ``lower``, and at ``upper`` these two do;
/// ``"grazing"``: they come nearer than rounding can tell, not before ``lower``, and nothing is said
/// after it; ``"free"``: no two meet on the whole path; ``"overlapping"``: two overlap where it begins;
/// ``"undecided"``: the search between the two of ``pair`` took its maximum number of steps, no two meet before
/// ``lower``, and whether these two do later is open.
#[pyclass(frozen, module = "colltrans", name = "PathContact")]
pub(crate) struct PathAnswer {
    question: Question,
    /// When the path ends, and the number of its last row.
    end: (f64, usize),
    found: PathOutcome,
    record: PathRecord,
    notes: Vec<String>,
}

/// What was asked: of a robot, or as a pickle has it.
enum Question {
    Asked(Arc<Asked>, JointPath),
    Saved(Box<ProofFile>),
}

impl Question {
    /// What is asked, and the names of its bodies.
    fn with<T>(
        &self,
        of: impl FnOnce(&PathCast<'_>, &[String]) -> Result<T, String>,
    ) -> Result<T, String> {
        match self {
            Self::Asked(asked, path) => of(&asked.cast(path)?, asked.cell.names()),
            Self::Saved(file) => {
                let (cast, names) = file.path().ok_or(NO_PATH)?;
                of(&cast, &names)
            }
        }
    }
}

const NO_PATH: &str = "the proof is not about a path";

/// Where the proof of an answer is.
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

/// A name, the vertices in the world, triangles.
type NamedMesh<'py> = (String, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// The vertices of a body in its frame, and its triangles: faces of more corners as fans.
fn mesh(body: AnyPlaced<'_>) -> (&[DVec3], Vec<[u32; 3]>) {
    match body {
        AnyPlaced::Solid(placed) => (placed.body.vertices(), placed.body.triangles().to_vec()),
        AnyPlaced::Convex(placed) => {
            let fan = |face: u32| {
                let corners: Vec<u32> = placed.body.face_vertices(face).collect();
                let ends = corners.windows(2).skip(1).map(|ends| [corners[0], ends[0], ends[1]]);
                ends.collect::<Vec<_>>()
            };
            let faces = 0..placed.body.face_count() as u32;
            (placed.body.vertices(), faces.flat_map(fan).collect())
        }
    }
}

fn end_of(path: &JointPath) -> (f64, usize) {
    (path.ends()[1], path.rows().len() - 1)
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

    /// The question as a file with its proof, of which the answer is asked once more.
    fn saved(&self, py: Python<'_>) -> PyResult<(PathOutcome, ProofFile)> {
        let told = answered(py, || {
            self.question.with(|cast, names| {
                ProofFile::with_path(cast, names).map_err(|what| what.to_string())
            })
        })?;
        told.map_err(|what| error("CaseError", what))
    }
}

getters!(PathAnswer, |it| {
    /// str: ``"contact"``, ``"grazing"``, ``"free"``, ``"overlapping"`` or ``"undecided"``.
    outcome: &'static str = it.record.outcome.name();
    /// float: No two meet before: the end of the path if none do, its beginning if two overlap there.
    lower: f64 = it.contact().map_or(it.end.0, |contact| contact.lower);
    /// float or None: At this time two do meet; None where that is not proven, or none do.
    upper: Option<f64> =
        it.contact().map(|contact| contact.upper).filter(|upper| upper.is_finite());
    /// tuple of (str, str) or None: The two, links or what stands around.
    pair: Option<(&str, &str)> = it.record.pair.as_ref().map(|[a, b]| (a.as_str(), b.as_str()));
    /// tuple of (int, float) or None: Where ``lower`` is: the row before, and which part of the way to the
    /// next one.
    place: Option<(usize, f64)> = it.record.place.map(|place| (place.row, place.share));
    /// ndarray of shape (3,) or None: Where the first one is nearest to the second then, in the world.
    point(py): Option<Vector<'py>> = it.contact()?.points.map(|points| row(py, points[0]));
    /// ndarray of shape (3,) or None: Unit normal in the world, from the first to the second.
    normal(py): Option<Vector<'py>> = it.contact()?.normal.map(|normal| row(py, normal));
    /// list of tuple of (str, str): Where the path begins with overlaps, all pairs that overlap there, or are as
    /// near as ``keep``.
    overlaps: Vec<(String, String)> = it.record.overlaps.iter().cloned().map(Into::into).collect();
    /// list of str: Links for whose meshes their convex hulls stand; a contact of one is that of its hull.
    hulls: Vec<String> = it.record.hulls.clone();
    /// int: How many pairs of bodies were asked about.
    pairs: usize = it.record.pairs;
    /// int: How often two bodies were looked at.
    looks: u32 = it.record.looks;
    /// int: Planes in the proof.
    planes: usize = it.record.planes;
    /// list of str: What was not asked though nobody said so, and values beyond a joint's limits.
    notes: Vec<String> = it.notes.clone();
});

#[pymethods]
impl PathAnswer {
    /// Checks the proof against the robot, its path and the scene alone, without a search.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     What is not proven.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        let checked = answered(py, || {
            self.question
                .with(|cast, _| cast.verify(self.found.proof()).map_err(|what| what.to_string()))
        })?;
        checked.map(|_| ()).map_err(|what| error("CertificateError", what))
    }

    /// The proof, with all that it is about, as text: the file of ``--save-proof`` of ``colltrans path``,
    /// which ``colltrans verify`` checks. The question is asked once more for it.
    ///
    /// Returns
    /// -------
    /// str
    fn proof_json(&self, py: Python<'_>) -> PyResult<String> {
        Ok(self.saved(py)?.1.to_json())
    }

    /// Writes :meth:`proof_json` as a file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    fn save_proof(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        save(&path, self.proof_json(py)?)
    }

    /// What it says, as plain Python: the fields of ``--json`` of ``colltrans path``, with the same bits.
    ///
    /// Returns
    /// -------
    /// dict
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        plain(py, &self.record)
    }

    /// All bodies as meshes, where they are in the world at a place of the path, to rounding.
    ///
    /// Parameters
    /// ----------
    /// place : tuple of (int, float), optional
    ///     A row, and which part of the way to the next one; without it that of ``lower``, where the path ends if
    ///     nothing meets.
    ///
    /// Returns
    /// -------
    /// list of tuple of (str, ndarray of shape (V, 3), ndarray of shape (T, 3))
    ///     The links' bodies, then what stands around: the name of what each belongs to, its vertices, and its
    ///     triangles by their numbers.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A place beyond the path.
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
            return Err(input(
                "place",
                format_args!("a path of {} rows has no {row}, {share}", self.end.1 + 1),
            ));
        }
        let told = self.question.with(|cast, names| {
            let place = Place { row, share };
            let all = cast.bodies().zip(names).enumerate();
            let placed = |(k, (body, name)): (usize, (AnyPlaced<'_>, &String))| {
                let ((vertices, triangles), pose) = (mesh(body), cast.pose(k, place));
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

    /// A picture: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    /// What a pickle has: the file of the proof, the answer but for that, and what was noted.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Reduced<'py, (String, String, Vec<String>)>> {
        let (mut found, file) = self.saved(py)?;
        let record = file.path().map(|(cast, names)| PathRecord::of(&found, &cast, &names));
        if record.is_none_or(|record| record != self.record) {
            return Err(error("CaseError", "the bodies are not what their file makes of them"));
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
            (file.path().ok_or_else(|| error("CaseError", NO_PATH))?, file.statement())
        else {
            return Err(error("CaseError", NO_PATH));
        };
        if let Some(proof) = proof_of(&mut found) {
            proof.clone_from(&of.proof);
        }
        let (record, end) = (PathRecord::of(&found, &cast, &names), end_of(cast.path()));
        Ok(Self { question: Question::Saved(Box::new(file)), end, found, record, notes })
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __repr__(&self) -> String {
        let upper = self.upper().map_or_else(|| "None".into(), |upper| format!("{upper:?}"));
        let pair = self.pair().map(|(a, b)| format!(", {a:?} and {b:?}")).unwrap_or_default();
        let notes = self.record.notes.iter().map(String::as_str);
        let only = std::iter::once("").chain(notes).collect::<Vec<_>>().join(", only ");
        let (outcome, lower) = (self.outcome(), self.lower());
        format!("PathContact({outcome:?}, lower={lower:?}, upper={upper}{pair}{only})")
    }
}

/// Returns the columns of an answer.
fn row_of(outcome: &PathOutcome) -> Row {
    let (code, of) = match outcome {
        PathOutcome::Contact(of) => (0, of),
        PathOutcome::Grazing(of) => (1, of),
        PathOutcome::Overlapping(of) => (3, of),
        PathOutcome::Undecided(of) => (4, of),
        _ => return Row { outcome: 2, ..Row::NONE },
    };
    let point = of.points.map(|points| points[0]);
    let row = Row { outcome: code, ..Row::NONE }
        .with(columns::AT_LEAST, of.lower)
        .with(columns::AT_MOST, if of.upper.is_finite() { of.upper } else { f64::NAN })
        .with(columns::ROW, of.place.row as f64)
        .with(columns::SHARE, of.place.share)
        .with(columns::FIRST, of.pair[0] as f64)
        .with(columns::SECOND, of.pair[1] as f64);
    [(columns::NORMAL, of.normal), (columns::POINT, point)]
        .into_iter()
        .fold(row, |row, (k, vector)| {
            vector.map_or(row, |vector| row.along(k, coordinates(vector)))
        })
}

/// The extension's half of ``colltrans.path_many``.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are those of path_many")]
pub(crate) fn ask_paths<'py>(
    py: Python<'py>,
    robot: &Bound<'py, Robot>,
    paths: Vec<Bound<'py, PyAny>>,
    scene: Option<&Bound<'py, PyAny>>,
    ignore: Vec<[String; 2]>,
    keep: f64,
    joints: BTreeMap<String, f64>,
    columns: Option<Vec<String>>,
    times: Option<Vec<Bound<'py, PyAny>>>,
    told: Vec<String>,
    threads: Option<usize>,
) -> PyResult<(Answered<'py>, Vec<String>)> {
    let asked = robot.get().asked(scene, &ignore, keep)?;
    let rows = paths.iter().enumerate().map(|(k, path)| {
        let times = times.as_ref().map(|all| &all[k]);
        Rows::of(path, columns.clone(), times, joints.clone())
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
    let answered = plan.run(py, |k| {
        let (path, _) = asked.path(&rows[k])?;
        asked.first_contact(&path).map(|(found, _)| row_of(&found))
    })?;
    Ok((answered, asked.cell.names().to_vec()))
}
