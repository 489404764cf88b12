//! Convex bodies.

use std::path::PathBuf;

use colltrans::glam::DVec3;
use colltrans_mesh::body::{BodyOptions, drawn_body, load_convex};
use numpy::{IntoPyArray, PyArray2};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::arguments::{mesh_parts, refuse_file};
use crate::arrays::{Indices, Vector, faces, ids, points, read_only, row, table, vector};
use crate::errors::{OrRaise, error, input_error};
use crate::frozen::{Options, Shown, getters, html, show};
use crate::offset::OffsetReport;
use crate::placed::Placed;
use crate::solid::Piece;

/// A convex polyhedron in its own frame: the convex hull of points, or this hull swept by a ball
/// (:meth:`rounded`).
///
/// The body never changes, and any thread can query it any number of times. Flat polygons, segments and
/// points are bodies too.
///
/// Parameters
/// ----------
/// points : array_like of shape (N, 3), or mesh
///     Coordinates in the body frame, in any unit of length. Interior points are dropped. A mesh must be convex; see
///     :meth:`from_mesh`. ``ConvexPolyhedron(mesh.vertices)`` is the hull of any mesh.
///
/// Raises
/// ------
/// BuildError
///     There are no points, or coordinates are not finite or out of range.
/// InputError
///     The argument is not an array of that shape.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron
/// >>> tetrahedron = ConvexPolyhedron([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
/// >>> tetrahedron
/// ConvexPolyhedron(4 vertices, 6 edges, 4 faces)
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct ConvexPolyhedron(
    pub(crate) colltrans::ConvexPolyhedron,
    /// Descriptions of the repairs when the body was read.
    pub(crate) Vec<String>,
    /// Depth of the mesh's surface below the body; `None` if rounding or the precision of the file explains
    /// it.
    Option<f64>,
);

impl ConvexPolyhedron {
    /// Returns the depth of the mesh's surface below the body; `None` if rounding or the precision of its
    /// file explains this depth.
    pub(crate) const fn dent(&self) -> Option<f64> {
        self.2
    }
}

impl From<colltrans::ConvexPolyhedron> for ConvexPolyhedron {
    fn from(body: colltrans::ConvexPolyhedron) -> Self {
        let dent = Some(body.dent()).filter(|depth| *depth > 0.0);
        Self(body, Vec::new(), dent)
    }
}

/// A body as JSON, its notes and its dent.
type ReadBody = (String, Vec<String>, Option<f64>);

getters!(ConvexPolyhedron, |it| {
    /// ndarray of shape (N, 3): The vertices, in the body frame.
    vertices(py): PyResult<Bound<'py, PyArray2<f64>>> =
        table(py, it.0.vertices().iter().map(DVec3::to_array)).map(read_only);
    /// ndarray of shape (N,): For each vertex its index in the points or the mesh from which the body was
    /// built.
    input_indices(py): Indices<'py> = ids(py, it.0.input_indices());
    /// list of ndarray: The vertices of each face, counter-clockwise as seen from outside.
    faces(py): Vec<Indices<'py>> = {
        let face = |f| it.0.face_vertices(f).collect::<Vec<_>>().into_pyarray(py);
        (0..it.0.face_count() as u32).map(face).collect()
    };
    /// ndarray of shape (M, 3): The faces as triangles, as indices into ``vertices``, without the radius of a
    /// rounded body.
    triangles(py): PyResult<Bound<'py, PyArray2<u32>>> = {
        let fan = |f| {
            let corners: Vec<u32> = it.0.face_vertices(f).collect();
            (2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]).collect::<Vec<_>>()
        };
        table(py, (0..it.0.face_count() as u32).flat_map(fan)).map(read_only)
    };
    /// ndarray of shape (2, 3): Smallest and largest coordinates of the body, with its radius if it is rounded.
    bounds(py): PyResult<Bound<'py, PyArray2<f64>>> = {
        let (vertices, radius) = (it.0.vertices(), it.0.radius());
        let low = vertices.iter().copied().reduce(DVec3::min).unwrap_or_default() - radius;
        let high = vertices.iter().copied().reduce(DVec3::max).unwrap_or_default() + radius;
        table(py, [low, high].map(|v| v.to_array())).map(read_only)
    };
    /// int: The dimension of the hull of the vertices, without the radius: 3 for a body with a volume, 2 for a
    /// flat polygon, 1 for a segment, 0 for a point.
    dimension: u8 = it.0.dimension();
    /// float: An upper bound of the distance of an input point from the body, and of the distance of a vertex
    /// outside the plane of a face: a length of the order of rounding errors.
    hull_error: f64 = it.0.hull_error();
    /// float: The radius of the ball that sweeps the body (:meth:`rounded`); 0 for a polyhedron.
    radius: f64 = it.0.radius();
    /// float: The volume, in the cube of the unit of length. It includes the radius of a rounded body.
    volume: f64 = it.0.volume();
    /// int: Bytes of memory that the body occupies now. The sections for ``solver="cta"`` count once they are
    /// built (:meth:`prepare`).
    nbytes: usize = it.0.memory_bytes();
    /// list of str: Repairs when the body was read from a file, and by how much its hull exceeds the mesh.
    notes: Vec<String> = it.1.clone();
});

#[pymethods]
impl ConvexPolyhedron {
    #[new]
    fn new(py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<Self> {
        refuse_file(points, "points", "ConvexPolyhedron")?;
        if mesh_parts(points)?.is_some() {
            return Self::from_mesh(py, points, None, 0.0);
        }
        let points = self::points(points, "points")?;
        py.detach(|| colltrans::ConvexPolyhedron::from_points(&points)).or_raise().map(Self::from)
    }

    /// Builds the convex hull of a closed convex surface.
    ///
    /// Parameters
    /// ----------
    /// vertices : array_like of shape (N, 3), or mesh
    ///     Coordinates in the body frame. Vertices that no face uses are ignored. A mesh is an object with ``vertices``
    ///     and ``faces`` or ``triangles``, such as those of trimesh and open3d.
    /// faces : array_like of shape (M, k), or a sequence of sequences
    ///     Vertex indices, counter-clockwise as seen from outside. They are not given for a mesh.
    /// convex_tolerance : float
    ///     The maximum depth of the surface below its convex hull, a length. Rounding errors are tolerated in
    ///     any case. The result is the hull.
    ///
    /// Returns
    /// -------
    /// ConvexPolyhedron
    ///
    /// Raises
    /// ------
    /// BuildError
    ///     The surface is open, inside out or not convex. The message names the place. Or the tolerance is
    ///     negative or not a number.
    /// InputError
    ///     An argument is not an array of that shape.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron
    /// >>> from colltrans.errors import BuildError
    /// >>> vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    /// >>> ConvexPolyhedron.from_mesh(vertices, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    /// ConvexPolyhedron(4 vertices, 6 edges, 4 faces)
    /// >>> try:
    /// ...     ConvexPolyhedron.from_mesh(vertices, [[0, 2, 1], [0, 1, 3], [1, 2, 3]])
    /// ... except BuildError as error:
    /// ...     print(error)
    /// the surface is open: the edge from vertex 0 to vertex 2 of face 0 has no face on its other side
    #[staticmethod]
    #[pyo3(signature = (vertices, faces=None, convex_tolerance=0.0))]
    fn from_mesh(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: Option<&Bound<'_, PyAny>>,
        convex_tolerance: f64,
    ) -> PyResult<Self> {
        if let (None, Some([vertices, faces])) = (faces, mesh_parts(vertices)?) {
            return Self::from_mesh(py, &vertices, Some(&faces), convex_tolerance);
        }
        let Some(faces) = faces else {
            let what = "they are missing; ConvexPolyhedron(points) makes the hull of points alone";
            return Err(input_error("faces", what));
        };
        let (vertices, faces) = (points(vertices, "vertices")?, self::faces(faces)?);
        py.detach(|| colltrans::ConvexPolyhedron::from_mesh(&vertices, &faces, convex_tolerance))
            .or_raise()
            .map(Self::from)
    }

    /// Reads a convex body from a mesh file; see :func:`colltrans.read`.
    #[staticmethod]
    #[pyo3(signature = (path, *, hull=false, scale=1.0, convex_tolerance=None, merge_tolerance=None))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        hull: bool,
        scale: f64,
        convex_tolerance: Option<f64>,
        merge_tolerance: Option<f64>,
    ) -> PyResult<Self> {
        read(py, path, hull, scale, convex_tolerance, merge_tolerance)
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
        Ok(Placed { body: Piece::Convex(slf.clone().unbind()), pose })
    }

    /// Builds the axis-aligned box between two corners.
    ///
    /// Parameters
    /// ----------
    /// low, high : array_like of shape (3,)
    ///     Opposite corners. If they share a coordinate, the box is flat.
    ///
    /// Returns
    /// -------
    /// ConvexPolyhedron
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron
    /// >>> ConvexPolyhedron.cuboid([-2, -2, -1], [2, 2, 0]).volume
    /// 16.0
    #[staticmethod]
    fn cuboid(low: &Bound<'_, PyAny>, high: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (low, high) = (vector(low, "low")?, vector(high, "high")?);
        colltrans::ConvexPolyhedron::cuboid(low, high).or_raise().map(Self::from)
    }

    /// Builds a sphere, exactly: a point with a radius.
    ///
    /// Parameters
    /// ----------
    /// radius : float
    /// center : array_like of shape (3,)
    ///     In the body frame; the origin by default.
    ///
    /// Returns
    /// -------
    /// ConvexPolyhedron
    ///
    /// Raises
    /// ------
    /// BuildError
    ///     The radius is negative, not finite or out of range, or the center is not finite or out of range.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, cast
    /// >>> ball = ConvexPolyhedron.sphere(0.5)
    /// >>> floor = ConvexPolyhedron.cuboid([-9, -9, -1], [9, 9, 0])
    /// >>> round(cast(ball, floor, [0, 0, -1], moving_pose=[0, 0, 3]).translation, 9)
    /// 2.5
    #[staticmethod]
    #[pyo3(signature = (radius, center=None))]
    fn sphere(radius: f64, center: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let center = center.map_or(Ok(DVec3::ZERO), |center| vector(center, "center"))?;
        colltrans::ConvexPolyhedron::sphere(center, radius).or_raise().map(Self::from)
    }

    /// Builds a capsule, exactly: a segment with a radius.
    ///
    /// Parameters
    /// ----------
    /// start, end : array_like of shape (3,)
    ///     The ends of the segment, in the body frame.
    /// radius : float
    ///
    /// Returns
    /// -------
    /// ConvexPolyhedron
    ///
    /// Raises
    /// ------
    /// BuildError
    ///     The radius is negative, not finite or out of range, or an end is not finite or out of range.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, distance
    /// >>> pill = ConvexPolyhedron.capsule([-1, 0, 0], [1, 0, 0], 0.25)
    /// >>> round(distance(pill, pill, fixed_pose=[0, 2, 0]).upper, 9)
    /// 1.5
    #[staticmethod]
    fn capsule(start: &Bound<'_, PyAny>, end: &Bound<'_, PyAny>, radius: f64) -> PyResult<Self> {
        let ends = [vector(start, "start")?, vector(end, "end")?];
        colltrans::ConvexPolyhedron::capsule(ends, radius).or_raise().map(Self::from)
    }

    /// Returns the body swept by a ball: all points at a distance of at most ``radius`` from it.
    ///
    /// Vertices, faces and features of the result are those of the body without radius. Nothing is tessellated.
    /// Casts, distances, depths, motions and :class:`Obstacles` accept rounded bodies, together with convex bodies
    /// and with solids.
    ///
    /// Parameters
    /// ----------
    /// radius : float
    ///     It is added to the radius of a body that is rounded already.
    ///
    /// Returns
    /// -------
    /// ConvexPolyhedron
    ///
    /// Raises
    /// ------
    /// BuildError
    ///     The radius is negative, not finite or out of range.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron
    /// >>> ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1]).rounded(0.1).radius
    /// 0.1
    fn rounded(&self, radius: f64) -> PyResult<Self> {
        let body = self.0.clone().rounded(radius).or_raise()?;
        Ok(Self(body, self.1.clone(), self.2))
    }

    /// Returns the polyhedron with which pictures draw this body: vertices on its surface if it is rounded.
    fn _drawn(&self) -> Self {
        Self::from(drawn_body(&self.0).into_owned())
    }

    /// Reads the text that `to_json` wrote. The body has the same bits.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        py.detach(|| colltrans::ConvexPolyhedron::from_json(text)).or_raise().map(Self::from)
    }

    /// Returns the body as text: vertices and faces in their order, and the radius, exact in bits.
    fn to_json(&self) -> String {
        self.0.to_json()
    }

    /// Returns the outward unit normal of a face, in the body frame.
    ///
    /// Parameters
    /// ----------
    /// face : int
    ///     An index into :attr:`faces`.
    ///
    /// Returns
    /// -------
    /// ndarray of shape (3,)
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     There is no such face.
    fn face_normal<'py>(&self, py: Python<'py>, face: u32) -> PyResult<Vector<'py>> {
        if face as usize >= self.0.face_count() {
            return Err(PyIndexError::new_err(format!("there are {} faces", self.0.face_count())));
        }
        Ok(row(py, self.0.face_normal(face)))
    }

    /// float: The largest depth of the surface of the input mesh below the body.
    ///
    /// It is 0 if the mesh is convex up to rounding or the precision of its file, and for a body that was not
    /// built from a mesh. Otherwise the mesh is convex only within the tolerance, and answers refer to the
    /// hull of its vertices.
    #[getter(dent)]
    fn dent_depth(&self) -> f64 {
        self.dent().unwrap_or_default()
    }

    /// Returns the vertex that is farthest along a direction.
    ///
    /// Parameters
    /// ----------
    /// direction : array_like of shape (3,)
    ///     In the body frame, of any length.
    ///
    /// Returns
    /// -------
    /// int
    ///     An index into :attr:`vertices`: one of the farthest vertices, up to rounding errors.
    fn support(&self, direction: &Bound<'_, PyAny>) -> PyResult<u32> {
        Ok(self.0.support(vector(direction, "direction")?).0)
    }

    /// Shrinks the body: returns the points at least ``amount`` below every face plane.
    ///
    /// Every face plane moves inwards. If a face vanishes, the planes around it intersect without it. The
    /// vertices get new numbers; for each of them ``input_indices`` of the result has the input index of the
    /// vertex that it comes from.
    ///
    /// Parameters
    /// ----------
    /// amount : float
    ///     A length, not negative. With 0 the result is the body itself, of any kind.
    ///
    /// Returns
    /// -------
    /// ConvexPolyhedron
    /// OffsetReport
    ///     The displacement of the vertices, and the faces that vanished.
    ///
    /// Raises
    /// ------
    /// BuildError
    ///     The body contains no ball of this radius; the message gives a radius that it contains. This
    ///     includes flat polygons, segments and points. Or the body is rounded, or the amount is negative or
    ///     not finite.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron
    /// >>> from colltrans.errors import BuildError
    /// >>> plate = ConvexPolyhedron.cuboid([0, 0, 0], [4, 4, 1])
    /// >>> smaller, report = plate.shrunk(0.25)
    /// >>> smaller.volume, round(report.farthest, 9), len(report.vanished)
    /// (6.125, 0.433012702, 0)
    /// >>> try:
    /// ...     plate.shrunk(0.75)
    /// ... except BuildError as error:
    /// ...     print(error)
    /// nothing remains of the body shrunk by 0.75: it contains no ball of this radius, but one of radius 0.5
    fn shrunk(&self, py: Python<'_>, amount: f64) -> PyResult<(Self, OffsetReport)> {
        let (body, report) = py.detach(|| self.0.shrunk(amount)).or_raise()?;
        Ok((body.into(), report.into()))
    }

    /// Grows the body: moves every face plane outwards by ``amount``, for a safety margin.
    ///
    /// Edges and corners stay sharp. The result contains all points within the amount of the body, and more
    /// beyond sharp corners. A flat polygon becomes a plate twice as thick as the amount. Vertices are
    /// numbered as in :meth:`shrunk`.
    ///
    /// Parameters
    /// ----------
    /// amount : float
    ///     A length, not negative. With 0 the result is the body itself, of any kind.
    ///
    /// Returns
    /// -------
    /// ConvexPolyhedron
    /// OffsetReport
    ///     The displacement of the vertices, and the faces that vanished.
    ///
    /// Raises
    /// ------
    /// BuildError
    ///     The body is a segment or a point, which has no faces. Or the body is rounded, or the amount is
    ///     negative, not finite, or so large that coordinates leave the exact range.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> larger, _ = cube.grown(0.5)
    /// >>> round(larger.volume, 9)
    /// 8.0
    fn grown(&self, py: Python<'_>, amount: f64) -> PyResult<(Self, OffsetReport)> {
        let (body, report) = py.detach(|| self.0.grown(amount)).or_raise()?;
        Ok((body.into(), report.into()))
    }

    /// Builds the planar sections for ``solver="cta"``, unless they exist already.
    ///
    /// Otherwise the first cast with this solver builds them and takes longer. Other solvers do not need
    /// them.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> before = cube.nbytes
    /// >>> cube.prepare()
    /// >>> cube.nbytes > before
    /// True
    fn prepare(&self, py: Python<'_>) {
        py.detach(|| self.0.prepare_sections());
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, ReadBody)> {
        Ok((py.get_type::<Self>().getattr("_read")?, (self.to_json(), self.notes(), self.dent())))
    }

    #[staticmethod]
    #[pyo3(name = "_read")]
    fn read_again(
        py: Python<'_>,
        text: &str,
        notes: Vec<String>,
        dent: Option<f64>,
    ) -> PyResult<Self> {
        Ok(Self(Self::from_json(py, text)?.0, notes, dent))
    }

    /// Draws a picture of the body; see :func:`colltrans.show`.
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
        let (v, e, f) = (self.0.vertices().len(), self.0.edge_count(), self.0.face_count());
        match self.0.radius() {
            0.0 => format!("ConvexPolyhedron({v} vertices, {e} edges, {f} faces)"),
            r => format!("ConvexPolyhedron({v} vertices, {e} edges, {f} faces, radius {r:?})"),
        }
    }
}

/// Reads a convex body from a mesh file: STL, OBJ, PLY, OFF or COLLADA.
///
/// Parameters
/// ----------
/// path : str or os.PathLike
/// hull : bool
///     Whether to take the convex hull of the vertices that faces use, or of all vertices if there are no
///     faces.
/// scale : float
///     Lengths are multiplied by this factor, after the tolerances are applied. These are in the unit of the
///     file.
/// convex_tolerance : float, optional
///     The maximum depth of the surface below its convex hull. The default is 1e-5 of its extent.
/// merge_tolerance : float, optional
///     Vertices on open edges within this distance are merged. The default follows from the number format of
///     the file: for example two units in the last place of single precision, or of printed digits.
///
/// Returns
/// -------
/// ConvexPolyhedron
///     The body that the command line makes of the file.
///
/// Raises
/// ------
/// MeshError
///     The file cannot be read. The message names the place.
/// BuildError
///     The mesh is not convex or not closed; ``hull=True`` takes its hull.
/// InputError
///     ``scale`` is not finite and positive.
#[pyfunction]
#[pyo3(signature = (path, *, hull=false, scale=1.0, convex_tolerance=None, merge_tolerance=None))]
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
    hull: bool,
    scale: f64,
    convex_tolerance: Option<f64>,
    merge_tolerance: Option<f64>,
) -> PyResult<ConvexPolyhedron> {
    if !scale.is_finite() || scale <= 0.0 {
        return Err(error("InputError", format_args!("scale: {scale} is not finite and positive")));
    }
    let options = BodyOptions::default()
        .with_scale(scale)
        .with_merge_tolerance(merge_tolerance)
        .with_convex_tolerance(convex_tolerance)
        .with_hull(hull);
    let loaded = py.detach(|| load_convex(&path, &options)).or_raise()?;
    let notes = loaded.notes.iter().map(ToString::to_string).collect();
    let dent = loaded.dent();
    Ok(ConvexPolyhedron(loaded.body, notes, dent))
}
