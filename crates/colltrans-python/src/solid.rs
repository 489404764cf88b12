//! Solids.
//!
//! A solid stores its source (mesh, pieces or another solid), so that it can be pickled: building it from the
//! same source again gives the same solid.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use colltrans::glam::DVec3;
use colltrans::solid::{AsSolid, ShellKind};
use colltrans_mesh::Mesh;
use colltrans_mesh::body::{self, BodyError, BodyOptions, Loaded, load};
use numpy::{IntoPyArray, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::{loader_hint, mesh_parts, refuse_file};
use crate::arrays::{Indices, faces, ids, points, read_only, table};
use crate::body::ConvexPolyhedron;
use crate::errors::{OrRaise, error, input_error};
use crate::frozen::{Options, Shown, getters, html, show};
use crate::offset::ShrinkReport;
use crate::placed::{Placed, place};

/// The source of a solid.
enum Source {
    Mesh(Box<Mesh>, BodyOptions),
    Pieces(Vec<Piece>),
    /// Another solid with facets moved inwards by this length, or outwards if it is negative.
    Moved(Py<Solid>, f64),
    /// Another solid swept by a ball of this radius.
    Rounded(Py<Solid>, f64),
}

/// A body that can be treated as a solid.
pub(crate) enum Piece {
    Convex(Py<ConvexPolyhedron>),
    Solid(Py<Solid>),
}

impl Piece {
    /// Reads the body of the argument called `name`.
    pub(crate) fn from_python(thing: &Bound<'_, PyAny>, name: &str) -> PyResult<Self> {
        if let Ok(body) = thing.cast::<ConvexPolyhedron>() {
            return Ok(Self::Convex(body.clone().unbind()));
        }
        if let Ok(solid) = thing.cast::<Solid>() {
            return Ok(Self::Solid(solid.clone().unbind()));
        }
        let what = thing.get_type().name()?;
        let message = format!(
            "{name}: neither a ConvexPolyhedron nor a Solid, but {what}; {}",
            loader_hint(thing)?
        );
        Err(PyTypeError::new_err(message))
    }

    /// Reads the body of the argument called `name`, and its pose.
    pub(crate) fn placed(
        thing: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
        name: &str,
    ) -> PyResult<(Self, colltrans::Pose)> {
        let (body, pose) = place(thing, pose, name)?;
        Ok((Self::from_python(&body, name)?, pose))
    }

    /// Returns the depth of the body's dent; `None` for a convex mesh or a solid.
    pub(crate) fn dent(&self) -> Option<f64> {
        match self {
            Self::Convex(body) => body.get().dent(),
            Self::Solid(_) => None,
        }
    }

    pub(crate) fn solid(&self) -> Result<&colltrans::Solid, colltrans::solid::SolidError> {
        match self {
            Self::Convex(body) => body.get().0.as_surface(),
            Self::Solid(solid) => solid.get().solid.as_surface(),
        }
    }

    /// Returns the body as a solid. Returns an error for a point or a segment, which has no area.
    pub(crate) fn solid_with_area(
        &self,
    ) -> Result<&colltrans::Solid, colltrans::solid::SolidError> {
        self.solid()?.as_solid()
    }

    /// Returns the pieces of a union, or the body itself.
    pub(crate) fn pieces(&self) -> Result<Vec<&colltrans::Solid>, colltrans::solid::SolidError> {
        match self {
            Self::Solid(solid) => solid.get().pieces(),
            Self::Convex(_) => Ok(vec![self.solid()?]),
        }
    }

    /// Returns the precision of the body's file, a length. Convex bodies count as exact.
    pub(crate) fn precision(&self) -> f64 {
        match self {
            Self::Convex(_) => 0.0,
            Self::Solid(solid) => solid.get().precision,
        }
    }

    /// Returns the number of triangles; for a convex body an estimate.
    pub(crate) fn triangle_count(&self) -> usize {
        match self {
            Self::Convex(body) => 2 * body.get().0.vertices().len(),
            Self::Solid(solid) => solid.get().solid.triangles().len(),
        }
    }

    fn notes(&self) -> Vec<String> {
        match self {
            Self::Convex(body) => body.get().1.clone(),
            Self::Solid(solid) => solid.get().notes.clone(),
        }
    }

    pub(crate) fn object(&self, py: Python<'_>) -> Py<PyAny> {
        match self {
            Self::Convex(body) => body.clone_ref(py).into_any(),
            Self::Solid(solid) => solid.clone_ref(py).into_any(),
        }
    }

    pub(crate) fn copy(&self, py: Python<'_>) -> Self {
        match self {
            Self::Convex(body) => Self::Convex(body.clone_ref(py)),
            Self::Solid(solid) => Self::Solid(solid.clone_ref(py)),
        }
    }
}

/// Reads an argument that must be a convex body. The error message names the calls that accept the given object.
pub(crate) fn convex_body<'py>(
    given: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, ConvexPolyhedron>> {
    if let Ok(body) = given.cast::<ConvexPolyhedron>() {
        return Ok(body.clone());
    }
    let message = if given.is_instance_of::<Solid>() {
        "Solid is not a ConvexPolyhedron; SolidCast(moving, fixed, direction) is the query of solids, and cast, \
         clearance, distance, depth, within, intersects and motion take them"
            .into()
    } else {
        format!("{} is not a ConvexPolyhedron; {}", given.get_type().name()?, loader_hint(given)?)
    };
    Err(PyTypeError::new_err(message))
}

/// A part that need not be convex: a closed surface of polygons, with exact decisions.
///
/// Parameters
/// ----------
/// vertices : array_like of shape (N, 3), or mesh
///     Coordinates in the body frame, in any unit. Vertices with equal coordinates are merged. A mesh is an object
///     with ``vertices`` and ``faces`` or ``triangles``, such as those of trimesh and open3d, or a ConvexPolyhedron.
/// faces : array_like of shape (M, k), or a sequence of sequences
///     Vertex indices, counter-clockwise as seen from outside. They are not given for a mesh.
/// open : bool
///     Whether the surface may be open, like a scan. An open surface blocks and is blocked, but it has no
///     interior.
///
/// Raises
/// ------
/// BuildError
///     The surface is open, or crosses itself in a polygon. The message names the place.
///
/// Examples
/// --------
/// >>> from colltrans import Solid
/// >>> Solid([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
/// ...       [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
/// Solid(4 vertices, 4 triangles)
#[pyclass(frozen, module = "colltrans")]
#[expect(clippy::struct_field_names, reason = "a solid of the library and its source")]
pub(crate) struct Solid {
    pub(crate) solid: colltrans::Solid,
    /// Maximum distance of stored vertices that represent the same point.
    pub(crate) precision: f64,
    notes: Vec<String>,
    source: Arc<Source>,
}

/// Vertices, faces, whether shells may be open, scale, precision of the file, notes.
type MeshAndReport<'py> = (Bound<'py, PyAny>, Vec<Bound<'py, PyAny>>, bool, f64, f64, Vec<String>);

impl Solid {
    /// Returns the pieces of a union, or the solid itself. Those of a rounded solid are the pieces of its core.
    fn pieces(&self) -> Result<Vec<&colltrans::Solid>, colltrans::solid::SolidError> {
        match &*self.source {
            Source::Pieces(pieces) => {
                let parts: Result<Vec<_>, _> = pieces.iter().map(Piece::pieces).collect();
                Ok(parts?.concat())
            }
            Source::Rounded(of, _) => of.get().pieces(),
            Source::Mesh(..) | Source::Moved(..) => Ok(vec![&self.solid]),
        }
    }

    fn of_mesh(mesh: Mesh, options: BodyOptions) -> Result<Self, BodyError> {
        let Loaded { body: solid, precision, notes } = body::solid(&mesh, &options)?;
        let notes = notes.iter().map(ToString::to_string).collect();
        let source = Arc::new(Source::Mesh(Box::new(mesh), options));
        Ok(Self { solid, precision, notes, source })
    }

    /// Moves all facets inwards or outwards by an amount.
    fn moved(slf: &Bound<'_, Self>, amount: f64, inwards: bool) -> PyResult<(Self, ShrinkReport)> {
        let of = &slf.get().solid;
        let moved = || if inwards { of.shrunk(amount) } else { of.grown(amount) };
        let (solid, report) = slf.py().detach(moved).or_raise()?;
        let by = if inwards { amount } else { -amount };
        let source = Arc::new(Source::Moved(slf.clone().unbind(), by));
        let (precision, notes) = (slf.get().precision, slf.get().notes.clone());
        Ok((Self { solid, precision, notes, source }, report.into()))
    }
}

getters!(Solid, |it| {
    /// ndarray of shape (N, 3): The vertices in use, in the body frame.
    vertices(py): PyResult<Bound<'py, PyArray2<f64>>> =
        table(py, it.solid.vertices().iter().map(DVec3::to_array)).map(read_only);
    /// ndarray of shape (M, 3): The triangles, as indices into ``vertices``.
    triangles(py): PyResult<Bound<'py, PyArray2<u32>>> =
        table(py, it.solid.triangles().iter().copied()).map(read_only);
    /// ndarray of shape (N,): For each vertex its index in the input.
    input_indices(py): Indices<'py> = ids(py, it.solid.vertex_indices());
    /// ndarray of shape (M,): For each triangle the face of the input that it is a part of.
    face_indices(py): Indices<'py> = ids(py, it.solid.facet_indices());
    /// bool: Whether all shells are closed. Otherwise at least a part of the body is an open surface.
    is_closed: bool = it.solid.is_closed();
    /// dict of str to int: The number of shells that are ``closed`` (with an inside), ``sided`` (open, but
    /// nearly closed) and ``sheet``. Open shells block from both sides, including their boundary; sheets are
    /// neither shrunk nor grown.
    shells: BTreeMap<&'static str, usize> = {
        let report = it.solid.report();
        ShellKind::ALL.into_iter().map(|kind| (kind.name(), report.shell_count(kind))).collect()
    };
    /// list of str: Repairs when the solid was built from its mesh, and differences from the file.
    notes: Vec<String> = it.notes.clone();
    /// float: The maximum distance of vertices in the file that represent the same point, a length. The
    /// default tolerance of a query follows from it. It is 0 for a solid that was not read from a file.
    precision: f64 = it.precision;
    /// float: The radius of the ball that sweeps the solid (:meth:`rounded`); 0 unless it is rounded.
    radius: f64 = it.solid.radius();
    /// float: The volume, in the cube of the unit of length, without the radius of a rounded solid.
    volume: f64 = it.solid.volume();
    /// ndarray of shape (2, 3): Smallest and largest coordinates of the body, with its radius if it is rounded.
    bounds(py): PyResult<Bound<'py, PyArray2<f64>>> = {
        let (bounds, radius) = (it.solid.bounds(), it.solid.radius());
        table(py, [bounds.low - radius, bounds.high + radius].map(|v| v.to_array())).map(read_only)
    };
    /// int: Bytes of memory that the body occupies, without its source.
    nbytes: usize = it.solid.memory_bytes();
});

#[pymethods]
impl Solid {
    #[new]
    #[pyo3(signature = (vertices, faces=None, *, open=false))]
    fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: Option<&Bound<'_, PyAny>>,
        open: bool,
    ) -> PyResult<Self> {
        refuse_file(vertices, "vertices", "Solid")?;
        if let (None, Some([vertices, faces])) = (faces, mesh_parts(vertices)?) {
            return Self::new(py, &vertices, Some(&faces), open);
        }
        let Some(faces) = faces else {
            let what = "they are missing; ConvexPolyhedron(points) makes the hull of points alone";
            return Err(input_error("faces", what));
        };
        let (vertices, faces) = (points(vertices, "vertices")?, self::faces(faces)?);
        let options = BodyOptions::default().with_open(open);
        py.detach(|| Self::of_mesh(Mesh::new(vertices, faces), options)).or_raise()
    }

    /// Builds the union of several bodies, which may overlap.
    ///
    /// Parameters
    /// ----------
    /// pieces : sequence of Solid or ConvexPolyhedron
    ///     The bodies. Vertices and faces are numbered consecutively over all of them.
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
        let pieces: Vec<Piece> = pieces
            .iter()
            .map(|piece| Piece::from_python(piece, "pieces"))
            .collect::<PyResult<_>>()?;
        let solids: Result<Vec<_>, _> = pieces.iter().map(Piece::solid).collect();
        let solid = colltrans::Solid::from_pieces(solids.or_raise()?).or_raise()?;
        let precision = pieces.iter().map(Piece::precision).fold(0.0, f64::max);
        let notes = pieces.iter().flat_map(Piece::notes).collect();
        Ok(Self { solid, precision, notes, source: Arc::new(Source::Pieces(pieces)) })
    }

    /// Places the body in the world.
    ///
    /// Parameters
    /// ----------
    /// pose : array_like or Pose, optional
    ///     See :class:`Pose`.
    ///
    /// Returns
    /// -------
    /// Placed
    #[pyo3(signature = (pose=None))]
    fn at(slf: &Bound<'_, Self>, pose: Option<&Bound<'_, PyAny>>) -> PyResult<Placed> {
        let pose = crate::pose::pose(pose, "pose")?;
        Ok(Placed { body: Piece::Solid(slf.clone().unbind()), pose })
    }

    /// Reads a part from a mesh file: STL, OBJ, PLY, OFF or COLLADA.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    /// open : bool
    ///     Whether the surface may be open.
    /// scale : float
    ///     Lengths are multiplied by this factor, after vertices are merged.
    /// merge_tolerance : float, optional
    ///     Vertices on open edges within this distance are merged. The default follows from the number format of
    ///     the file: for example two units in the last place of single precision, or of printed digits.
    ///
    /// Returns
    /// -------
    /// Solid
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     The file cannot be read. The message names the place.
    /// BuildError
    ///     The mesh is open, or does not form a surface.
    /// InputError
    ///     ``scale`` is not finite and positive.
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
            return Err(input_error("scale", format_args!("{scale} is not positive")));
        }
        let options = BodyOptions::default()
            .with_scale(scale)
            .with_merge_tolerance(merge_tolerance)
            .with_open(open);
        py.detach(|| load(&path, &options, |mesh, options| Self::of_mesh(mesh, *options)))
            .or_raise()
    }

    /// Shrinks the solid: moves every facet plane inwards.
    ///
    /// Vertices and facets keep their numbers. The report lists the places where this fails: walls thinner
    /// than twice the amount, and corners between facets that cannot all move inwards.
    ///
    /// Parameters
    /// ----------
    /// amount : float
    ///     The displacement, in the unit of the body.
    ///
    /// Returns
    /// -------
    /// Solid
    /// ShrinkReport
    ///
    /// Raises
    /// ------
    /// BuildError
    ///     The amount is negative, not finite, or so large that coordinates leave the exact range.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, Solid
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> step = Solid.from_pieces([cube, ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 4])])
    /// >>> smaller, report = step.shrunk(0.25)
    /// >>> smaller.bounds.tolist(), report.stuck.tolist(), report.inverted.tolist()
    /// ([[0.25, 0.25, 0.25], [0.75, 0.75, 3.75]], [], [])
    fn shrunk(slf: &Bound<'_, Self>, amount: f64) -> PyResult<(Self, ShrinkReport)> {
        Self::moved(slf, amount, true)
    }

    /// Grows the solid: moves every facet plane outwards, for a safety margin.
    ///
    /// Parameters
    /// ----------
    /// amount : float
    ///     The displacement, in the unit of the body.
    ///
    /// Returns
    /// -------
    /// Solid
    /// ShrinkReport
    ///
    /// Raises
    /// ------
    /// BuildError
    ///     See :meth:`shrunk`.
    fn grown(slf: &Bound<'_, Self>, amount: f64) -> PyResult<(Self, ShrinkReport)> {
        Self::moved(slf, amount, false)
    }

    /// Returns the solid swept by a ball: all points at a distance of at most ``radius`` from it.
    ///
    /// Vertices, triangles and features of the result are those of the solid without radius. Nothing is
    /// tessellated. Casts, distances, motions, paths and :class:`Obstacles` accept rounded solids. A tolerance
    /// offsets the solid without radius inwards.
    ///
    /// Parameters
    /// ----------
    /// radius : float
    ///     It is added to the radius of a solid that is rounded already.
    ///
    /// Returns
    /// -------
    /// Solid
    ///
    /// Raises
    /// ------
    /// BuildError
    ///     The radius is negative, not finite or out of range.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, Solid, distance
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> step = Solid.from_pieces([cube, ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 4])]).rounded(0.25)
    /// >>> ball = ConvexPolyhedron.sphere(0.5)
    /// >>> round(distance(ball, step, moving_pose=[3, 0.5, 0.5]).upper, 9)
    /// 1.25
    fn rounded(slf: &Bound<'_, Self>, radius: f64) -> PyResult<Self> {
        let Self { solid, precision, notes, .. } = slf.get();
        let solid = solid.clone().rounded(radius).or_raise()?;
        let source = Arc::new(Source::Rounded(slf.clone().unbind(), radius));
        Ok(Self { solid, precision: *precision, notes: notes.clone(), source })
    }

    /// Computes the distances of points from the surface of the solid, negative inside.
    ///
    /// Of a solid from overlapping pieces, facets within the solid count as surface.
    ///
    /// Parameters
    /// ----------
    /// points : array_like of shape (N, 3)
    ///     Points in the world.
    /// pose : array_like or Pose, optional
    ///     Pose of the solid in the world; see :class:`Pose`.
    ///
    /// Returns
    /// -------
    /// ndarray of shape (N, 2)
    ///     Proven lower and upper bound of each distance. Both are 0 for a point on the surface.
    ///
    /// Raises
    /// ------
    /// QueryError
    ///     The solid is rounded, or a point is not finite or out of range.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, Solid
    /// >>> cube = Solid.from_pieces([ConvexPolyhedron.cuboid([0, 0, 0], [4, 4, 4])])
    /// >>> cube.signed_distances([[2, 2, 3], [7, 8, 2], [4, 1, 1]]).mean(axis=1).round(9).tolist()
    /// [-1.0, 5.0, 0.0]
    #[pyo3(signature = (points, pose=None))]
    fn signed_distances<'py>(
        slf: &Bound<'py, Self>,
        points: &Bound<'py, PyAny>,
        pose: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let places = self::points(points, "points")?;
        let pose = crate::pose::pose(pose, "pose")?;
        let solid = &slf.get().solid;
        let found = slf.py().detach(|| solid.signed_distances(pose, &places));
        let found = found.map_err(|what| error("QueryError", what))?;
        table(slf.py(), found.iter().map(|of| [of.lower, of.upper]))
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
            Source::Rounded(of, radius) => {
                Ok((class.getattr("rounded")?, (of, *radius).into_pyobject(py)?))
            }
            Source::Moved(of, by) => Ok((class.getattr("_moved")?, (of, *by).into_pyobject(py)?)),
            Source::Mesh(mesh, BodyOptions { open, scale, .. }) => {
                let vertices = table(py, mesh.vertices.iter().map(DVec3::to_array))?.into_any();
                let face = |f: &Vec<u32>| f.clone().into_pyarray(py).into_any();
                let faces: Vec<_> = mesh.faces.iter().map(face).collect();
                let state: MeshAndReport<'_> =
                    (vertices, faces, *open, *scale, mesh.precision, self.notes.clone());
                Ok((class.getattr("_mesh")?, state.into_pyobject(py)?))
            }
        }
    }

    #[staticmethod]
    #[pyo3(name = "_mesh")]
    fn of_mesh_again(
        py: Python<'_>,
        v: &Bound<'_, PyAny>,
        f: &Bound<'_, PyAny>,
        open: bool,
        scale: f64,
        precision: f64,
        notes: Vec<String>,
    ) -> PyResult<Self> {
        let mut mesh = Mesh::new(points(v, "vertices")?, faces(f)?);
        mesh.precision = precision;
        let options = BodyOptions::default().with_open(open).with_scale(scale);
        let solid = py.detach(|| Self::of_mesh(mesh, options)).or_raise()?;
        Ok(Self { notes, ..solid })
    }

    #[staticmethod]
    #[pyo3(name = "_moved")]
    fn moved_again(of: &Bound<'_, Self>, by: f64) -> PyResult<Self> {
        Ok(Self::moved(of, by.abs(), by.is_sign_positive())?.0)
    }

    /// Draws a picture of the solid; see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> Shown<'py> {
        html(slf)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __repr__(&self) -> String {
        let (v, t) = (self.solid.vertices().len(), self.solid.triangles().len());
        match self.solid.radius() {
            0.0 => format!("Solid({v} vertices, {t} triangles)"),
            r => format!("Solid({v} vertices, {t} triangles, radius {r:?})"),
        }
    }
}
