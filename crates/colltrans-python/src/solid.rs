//! Solids, and queries about them.
//!
//! A solid keeps what it was made of, so that it can be pickled: made of the same again, it is the
//! same. Queries run without the interpreter's lock: one may take milliseconds.

use std::path::PathBuf;
use std::sync::Arc;

use colltrans::glam::DVec3;
use colltrans::{AsSolid, Clearance, SolidOptions, StartOverlap};
use colltrans_mesh::ReadOptions;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::answer::Feature;
use crate::arrays::{coordinates, faces, points, row, table, vector};
use crate::body::ConvexPolyhedron;
use crate::errors::{OrRaise, error};
use crate::pose::{Pose, pose};

/// What a solid was made of.
enum Source {
    Mesh { vertices: Vec<DVec3>, faces: Vec<Vec<u32>>, open: bool },
    Pieces(Vec<Piece>),
}

/// A body that stands for a solid.
enum Piece {
    Convex(Py<ConvexPolyhedron>),
    Solid(Py<Solid>),
}

impl Piece {
    fn of(thing: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(body) = thing.cast::<ConvexPolyhedron>() {
            return Ok(Self::Convex(body.clone().unbind()));
        }
        Ok(Self::Solid(thing.cast::<Solid>()?.clone().unbind()))
    }

    fn solid(&self) -> Result<&colltrans::Solid, colltrans::SolidError> {
        match self {
            Self::Convex(body) => body.get().0.as_solid(),
            Self::Solid(solid) => solid.get().solid.as_solid(),
        }
    }

    fn object(&self, py: Python<'_>) -> Py<PyAny> {
        match self {
            Self::Convex(body) => body.clone_ref(py).into_any(),
            Self::Solid(solid) => solid.clone_ref(py).into_any(),
        }
    }

    fn copy(&self, py: Python<'_>) -> Self {
        match self {
            Self::Convex(body) => Self::Convex(body.clone_ref(py)),
            Self::Solid(solid) => Self::Solid(solid.clone_ref(py)),
        }
    }
}

/// A part that need not be convex: a closed surface of polygons, decided exactly.
///
/// Parameters
/// ----------
/// vertices : array_like of shape (N, 3)
///     In the body frame, in any unit. Vertices with equal coordinates are one.
/// faces : array_like of shape (M, k), or a sequence of sequences
///     Vertex indices, counter-clockwise as seen from outside.
/// open : bool
///     Whether the surface may be open, as a scan is: it blocks and is blocked, but nothing is ever
///     inside it.
///
/// Raises
/// ------
/// BuildError
///     A surface that is open, or crosses itself in a polygon, with the place.
///
/// Examples
/// --------
/// >>> from colltrans import Solid
/// >>> Solid([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
/// ...       [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
/// Solid(4 vertices, 4 triangles)
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Solid {
    pub(crate) solid: colltrans::Solid,
    source: Arc<Source>,
}

impl Solid {
    fn of_mesh(vertices: Vec<DVec3>, faces: Vec<Vec<u32>>, open: bool) -> PyResult<Self> {
        let solid = if open {
            colltrans::Solid::from_open_mesh(&vertices, &faces)
        } else {
            colltrans::Solid::from_mesh(&vertices, &faces)
        };
        let solid = solid.or_raise()?;
        Ok(Self { solid, source: Arc::new(Source::Mesh { vertices, faces, open }) })
    }
}

#[pymethods]
impl Solid {
    #[new]
    #[pyo3(signature = (vertices, faces, *, open=false))]
    fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        open: bool,
    ) -> PyResult<Self> {
        let (vertices, faces) = (points(vertices, "vertices")?, self::faces(faces)?);
        py.detach(|| Self::of_mesh(vertices, faces, open))
    }

    /// The union of several bodies, which may overlap.
    ///
    /// Parameters
    /// ----------
    /// pieces : sequence of Solid or ConvexPolyhedron
    ///     Vertices and faces are numbered through.
    ///
    /// Returns
    /// -------
    /// Solid
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, Solid
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> post = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 4])
    /// >>> Solid.from_pieces([cube, post])
    /// Solid(16 vertices, 24 triangles)
    #[staticmethod]
    fn from_pieces(pieces: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let pieces: Vec<Piece> = pieces.iter().map(Piece::of).collect::<PyResult<_>>()?;
        let solids: Result<Vec<_>, _> = pieces.iter().map(Piece::solid).collect();
        let solid = colltrans::Solid::from_pieces(solids.or_raise()?).or_raise()?;
        Ok(Self { solid, source: Arc::new(Source::Pieces(pieces)) })
    }

    /// From a mesh of trimesh, or anything with ``vertices`` and ``faces``.
    ///
    /// Parameters
    /// ----------
    /// mesh : object
    ///
    /// Returns
    /// -------
    /// Solid
    #[staticmethod]
    fn from_trimesh(py: Python<'_>, mesh: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::new(py, &mesh.getattr("vertices")?, &mesh.getattr("faces")?, false)
    }

    /// Reads a part from a mesh file: STL, OBJ, PLY or OFF.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    /// open : bool
    ///     Whether the surface may be open.
    /// scale : float
    ///     Lengths are multiplied by this, after the merging.
    /// merge_tolerance : float, optional
    ///     Up to which distance vertices on open edges are merged. By default a few units in the
    ///     last place of the largest coordinate.
    ///
    /// Returns
    /// -------
    /// Solid
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     A file that cannot be read, with the place.
    /// BuildError
    ///     A surface that is open or not one.
    #[staticmethod]
    #[pyo3(signature = (path, *, open=false, scale=1.0, merge_tolerance=None))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        open: bool,
        scale: f64,
        merge_tolerance: Option<f64>,
    ) -> PyResult<Self> {
        if !scale.is_finite() || scale <= 0.0 {
            return Err(crate::errors::input("scale", format_args!("{scale} is not positive")));
        }
        let options = ReadOptions::default().with_merge_tolerance(merge_tolerance);
        py.detach(|| {
            let mesh = colltrans_mesh::read_with(&path, options).or_raise()?;
            let vertices = mesh.vertices.iter().map(|v| *v * scale).collect();
            Self::of_mesh(vertices, mesh.faces, open)
        })
    }

    /// ndarray of shape (N, 3): The vertices in use, in the body frame.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.solid.vertices().iter().map(DVec3::to_array))
    }

    /// ndarray of shape (M, 3): The triangles, as indices into ``vertices``.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        table(py, self.solid.triangles().iter().copied())
    }

    /// ndarray of shape (N,): For each vertex its index in the input.
    #[getter]
    fn input_indices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, self.solid.vertex_indices())
    }

    /// ndarray of shape (M,): For each triangle the face of the input that it is a part of.
    #[getter]
    fn face_indices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, self.solid.facet_indices())
    }

    /// bool: Whether the surface encloses a volume.
    #[getter]
    fn is_closed(&self) -> bool {
        self.solid.is_closed()
    }

    /// float: The volume, in the cube of the unit of length.
    #[getter]
    fn volume(&self) -> f64 {
        self.solid.volume()
    }

    /// ndarray of shape (2, 3): Smallest and largest coordinates.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.solid.bounds().map(|v| v.to_array()))
    }

    /// int: Bytes of memory that the body occupies, without what it was made of.
    #[getter]
    fn nbytes(&self) -> usize {
        self.solid.memory_bytes()
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let class = py.get_type::<Self>();
        match &*self.source {
            Source::Pieces(pieces) => {
                let pieces: Vec<_> = pieces.iter().map(|piece| piece.object(py)).collect();
                Ok((class.getattr("from_pieces")?, (pieces,).into_pyobject(py)?))
            }
            Source::Mesh { vertices, faces, open } => {
                let vertices = table(py, vertices.iter().map(DVec3::to_array))?;
                let faces: Vec<_> = faces.iter().map(|f| f.clone().into_pyarray(py)).collect();
                let name = if *open { "_open" } else { "_closed" };
                Ok((class.getattr(name)?, (vertices, faces).into_pyobject(py)?))
            }
        }
    }

    #[staticmethod]
    #[pyo3(name = "_closed")]
    fn closed(py: Python<'_>, v: &Bound<'_, PyAny>, f: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::new(py, v, f, false)
    }

    #[staticmethod]
    #[pyo3(name = "_open")]
    fn open(py: Python<'_>, v: &Bound<'_, PyAny>, f: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::new(py, v, f, true)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __repr__(&self) -> String {
        let (v, t) = (self.solid.vertices().len(), self.solid.triangles().len());
        format!("Solid({v} vertices, {t} triangles)")
    }
}

/// A query about solids as a value: two placed bodies and a direction.
///
/// Parameters
/// ----------
/// moving, fixed : Solid or ConvexPolyhedron
///     The body that moves, and the one that does not.
/// direction : array_like of shape (3,)
///     Of the world, of any length; translations count in multiples of it.
/// moving_pose, fixed_pose : array_like or Pose, optional
///     Where the bodies are; see :class:`Pose`.
/// tolerance : float, optional
///     Both bodies are shrunk by half of this length, so that parts that fit do not jam. By default
///     what rounding can do to a fit, 0 where both poses turn by quarter turns. (The command line
///     adds what the files' precision can do.)
/// ignore_start_overlaps : bool
///     Whether facets that cross now do not block, but contacts that begin later do.
///
/// Examples
/// --------
/// >>> from colltrans import Solid, SolidCast
/// >>> bolt, plate = Solid.read("data/bolt.stl"), Solid.read("data/plate.off")
/// >>> query = SolidCast(bolt, plate, [0, 0, -1], moving_pose=[0, 0, 7])
/// >>> query.clearance()
/// SolidBlocked(distance=7.0)
/// >>> query.exit()
/// 12.0
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidCast {
    bodies: [Piece; 2],
    poses: [colltrans::Pose; 2],
    direction: DVec3,
    options: SolidOptions,
}

impl SolidCast {
    /// Asks the library, without the interpreter's lock.
    fn ask<T: Send>(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&colltrans::Cast<'_, colltrans::Solid>) -> T + Send,
    ) -> PyResult<T> {
        let solids = [self.bodies[0].solid().or_raise()?, self.bodies[1].solid().or_raise()?];
        py.detach(|| {
            colltrans::Cast::new(
                solids[0].at(self.poses[0]),
                solids[1].at(self.poses[1]),
                self.direction,
            )
            .and_then(|cast| cast.with_options(self.options))
            .map(|cast| question(&cast))
        })
        .map_err(|what| error("QueryError", what))
    }
}

#[pymethods]
impl SolidCast {
    #[new]
    #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
        tolerance=None, ignore_start_overlaps=false))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        py: Python<'_>,
        moving: &Bound<'_, PyAny>,
        fixed: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        moving_pose: Option<&Bound<'_, PyAny>>,
        fixed_pose: Option<&Bound<'_, PyAny>>,
        tolerance: Option<f64>,
        ignore_start_overlaps: bool,
    ) -> PyResult<Self> {
        let start_overlap =
            if ignore_start_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
        let cast = Self {
            bodies: [Piece::of(moving)?, Piece::of(fixed)?],
            poses: [pose(moving_pose, "moving_pose")?, pose(fixed_pose, "fixed_pose")?],
            direction: vector(direction, "direction")?,
            options: SolidOptions { tolerance, start_overlap, ..SolidOptions::default() },
        };
        cast.ask(py, |_| ())?;
        Ok(cast)
    }

    /// How far can the moving body move from where it is, and what stops it?
    ///
    /// Returns
    /// -------
    /// SolidBlocked or SolidFree or SolidOverlapping
    fn clearance<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let answer = slf.get().ask(py, |cast| cast.clearance())?;
        solid_answer(slf, &answer)
    }

    /// The clearance, with a proof that :meth:`verify` checks.
    ///
    /// Returns
    /// -------
    /// tuple of (SolidBlocked or SolidFree or SolidOverlapping, SolidCertificate)
    fn certified_clearance<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, SolidCertificate)> {
        let (answer, proof) = slf.get().ask(slf.py(), |cast| cast.certified_clearance())?;
        Ok((solid_answer(slf, &answer)?, SolidCertificate(proof)))
    }

    /// Checks a proof against the two bodies.
    ///
    /// Parameters
    /// ----------
    /// proof : SolidCertificate
    ///
    /// Returns
    /// -------
    /// float
    ///     How far the bounds of the distance are apart, in multiples of the direction.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     What is not proven.
    fn verify(&self, py: Python<'_>, proof: &Bound<'_, SolidCertificate>) -> PyResult<f64> {
        let proof = &proof.get().0;
        self.ask(py, |cast| cast.verify(proof))?.or_raise()
    }

    /// Whether the bodies as they are, as closed sets, have a point in common.
    fn intersects(&self, py: Python<'_>) -> PyResult<bool> {
        self.ask(py, |cast| cast.intersects())
    }

    /// The least tolerance with which the bodies do not overlap: 0 if they do not, None if there is
    /// none up to their size.
    fn depth(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        self.ask(py, |cast| cast.depth())
    }

    /// The translation after which the bodies never meet again, None if nothing faces.
    fn exit(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        self.ask(py, |cast| cast.exit())
    }

    /// float: The tolerance that is used, a length.
    #[getter]
    fn tolerance(&self, py: Python<'_>) -> PyResult<f64> {
        self.ask(py, |cast| cast.tolerance())
    }

    /// Solid or ConvexPolyhedron: The moving body.
    #[getter]
    fn moving(&self, py: Python<'_>) -> Py<PyAny> {
        self.bodies[0].object(py)
    }

    /// Solid or ConvexPolyhedron: The fixed body.
    #[getter]
    fn fixed(&self, py: Python<'_>) -> Py<PyAny> {
        self.bodies[1].object(py)
    }

    /// Pose: Where the moving body is.
    #[getter]
    fn moving_pose(&self) -> Pose {
        Pose(self.poses[0])
    }

    /// Pose: Where the fixed body is.
    #[getter]
    fn fixed_pose(&self) -> Pose {
        Pose(self.poses[1])
    }

    /// ndarray of shape (3,): The direction, as given.
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.direction)
    }

    /// The same bodies where they are, and the direction turned round.
    fn reversed(&self, py: Python<'_>) -> Self {
        let bodies = [self.bodies[0].copy(py), self.bodies[1].copy(py)];
        Self { bodies, direction: -self.direction, ..*self }
    }

    fn __repr__(&self) -> String {
        format!("SolidCast(direction={:?})", coordinates(self.direction))
    }
}

/// Where a solid is stopped.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidContact {
    contact: colltrans::SolidContact,
    query: Py<SolidCast>,
}

#[pymethods]
impl SolidContact {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str, &'static str) = ("nominal", "normal", "point");

    /// float: Where the bodies as they are, not shrunk, meet, in multiples of the direction.
    #[getter]
    fn nominal(&self) -> f64 {
        self.contact.nominal
    }

    /// ndarray of shape (3,): Unit contact normal in the world, from the moving body to the fixed one.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.contact.normal)
    }

    /// ndarray of shape (3,): The contact point on the fixed body, in the world.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.contact.point_on_fixed)
    }

    /// ndarray of shape (3,): The same point of the moving body before it moves, in the world.
    #[getter]
    fn point_at_start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.contact.point_on_moving)
    }

    /// Feature: What of the moving body touches; of a face its vertices in the input's numbers.
    #[getter]
    fn moving_feature(&self) -> PyResult<Feature> {
        feature(self.contact.moving_feature, &self.query.get().bodies[0])
    }

    /// Feature: What of the fixed body touches.
    #[getter]
    fn fixed_feature(&self) -> PyResult<Feature> {
        feature(self.contact.fixed_feature, &self.query.get().bodies[1])
    }

    fn __repr__(&self) -> String {
        let (t, n) = (self.contact.nominal, coordinates(self.contact.normal));
        format!("SolidContact(nominal={t:?}, normal={n:?})")
    }
}

/// A feature by the numbers of the input; a face by the vertices of all its triangles.
fn feature(feature: colltrans::Feature, body: &Piece) -> PyResult<Feature> {
    let vertices = match feature {
        colltrans::Feature::Vertex(v) => vec![v],
        colltrans::Feature::Edge(ends) => ends.to_vec(),
        colltrans::Feature::Face(face) => {
            let solid = body.solid().or_raise()?;
            let triangles = solid.triangles().iter().zip(solid.facet_indices());
            let corners = triangles.filter(|(_, f)| **f == face).flat_map(|(t, _)| *t);
            let mut found: Vec<u32> = corners.map(|v| solid.vertex_indices()[v as usize]).collect();
            found.sort_unstable();
            found.dedup();
            found
        }
    };
    Ok(Feature::new(feature.kind(), vertices))
}

/// A solid can move until it touches.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidBlocked {
    distance: f64,
    contact: Py<SolidContact>,
}

#[pymethods]
impl SolidBlocked {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str, &'static str) = ("distance", "contact");

    /// float: How far, in multiples of the direction, the bodies shrunk by half the tolerance each.
    #[getter]
    fn distance(&self) -> f64 {
        self.distance
    }

    /// SolidContact: What stops it.
    #[getter]
    fn contact(&self, py: Python<'_>) -> Py<SolidContact> {
        self.contact.clone_ref(py)
    }

    fn __repr__(&self) -> String {
        format!("SolidBlocked(distance={:?})", self.distance)
    }
}

/// A solid can move as far as it likes.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidFree {
    separation: Option<[f64; 4]>,
}

#[pymethods]
impl SolidFree {
    /// float: Infinite.
    #[getter]
    fn distance(&self) -> f64 {
        f64::INFINITY
    }

    /// float or None: The margin of a plane between the bodies, parallel to the direction, a length;
    /// None if there is no such plane: it slides along, or moves away.
    #[getter]
    fn margin(&self) -> Option<f64> {
        self.separation.map(|s| s[3])
    }

    /// ndarray of shape (3,) or None: Unit normal of that plane, in the world.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.separation.map(|s| PyArray1::from_slice(py, &s[..3]))
    }

    fn __repr__(&self) -> &'static str {
        "SolidFree()"
    }
}

/// Two solids overlap where they are, by more than is tolerated.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidOverlapping {
    depth: Option<f64>,
}

#[pymethods]
impl SolidOverlapping {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&'static str,) = ("depth",);

    /// None: There is none.
    #[getter]
    fn distance(&self) -> Option<f64> {
        None
    }

    /// float or None: The least tolerance with which they would not overlap, a length.
    #[getter]
    fn depth(&self) -> Option<f64> {
        self.depth
    }

    fn __repr__(&self) -> String {
        format!(
            "SolidOverlapping(depth={})",
            self.depth.map_or("None".into(), |d| format!("{d:?}"))
        )
    }
}

/// The proof of a clearance between solids.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidCertificate(colltrans::SolidCertificate);

#[pymethods]
impl SolidCertificate {
    /// float: The tolerance by which the bodies were shrunk.
    #[getter]
    fn tolerance(&self) -> f64 {
        self.0.tolerance
    }

    /// float: The proven lower bound of the distance, in multiples of the direction.
    #[getter]
    fn lower(&self) -> f64 {
        self.0.lower
    }

    /// The proof as text.
    fn to_json(&self) -> String {
        self.0.to_json()
    }

    /// From what `to_json` has written. It is read, not believed.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        colltrans::SolidCertificate::from_json(text).or_raise().map(Self)
    }

    fn __repr__(&self) -> String {
        format!("SolidCertificate(lower={:?})", self.0.lower)
    }
}

fn solid_answer<'py>(
    query: &Bound<'py, SolidCast>,
    answer: &Clearance<colltrans::Solid>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = query.py();
    Ok(match answer {
        Clearance::Blocked { distance, contact } => {
            let contact = SolidContact { contact: *contact, query: query.clone().unbind() };
            let contact = Py::new(py, contact)?;
            Bound::new(py, SolidBlocked { distance: *distance, contact })?.into_any()
        }
        Clearance::Free(separation) => {
            let separation = separation.as_ref().map(|s| {
                let [x, y, z] = coordinates(s.normal);
                [x, y, z, s.margin]
            });
            Bound::new(py, SolidFree { separation })?.into_any()
        }
        Clearance::Overlapping(overlap) => {
            Bound::new(py, SolidOverlapping { depth: overlap.depth })?.into_any()
        }
    })
}
