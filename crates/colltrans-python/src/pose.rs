//! Poses, and the arguments that describe one.

use colltrans::glam::{DMat3, DQuat, DVec3};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyList, PySequence, PyTuple};

use crate::arrays::{Numbers, Shape, Vector, numbers, plain_numbers, row, table};
use crate::errors::{OrRaise, input_error, warn_of_rounded_pose};
use crate::frozen::getters;

/// A rigid placement of a body in the world: ``x_world = R @ x_body + t``.
///
/// Parameters
/// ----------
/// source : array_like, Pose or object with ``as_matrix()``, optional
///     One of these; the default is the identity:
///
///     - a translation ``(3,)``;
///     - a translation and a unit quaternion ``(7,)``: x, y, z, then qx, qy, qz, qw, or the pair of both, ``((x, y,
///       z), (qx, qy, qz, qw))``, as pybullet returns it;
///     - a rotation matrix ``(3, 3)``, or a matrix ``(3, 4)`` or ``(4, 4)``;
///     - an object with a method ``as_matrix()``, such as a ``Rotation`` of ``scipy.spatial.transform``.
///
/// Notes
/// -----
/// Quaternions are normalised. The entries of a matrix are used as they are. A rotation with few digits, with a
/// defect above 1e-6 and at most 0.02, is replaced by the nearest rotation with a ``RoundedPoseWarning``. Directions
/// are never normalised: translations are multiples of them. Axes of motions may have any length.
///
/// Raises
/// ------
/// PoseError
///     The defect of the rotation exceeds 0.02, or the translation is not finite or out of range.
/// InputError
///     The argument has another shape.
///
/// Examples
/// --------
/// >>> from colltrans import Pose
/// >>> turned = Pose([1, 2, 3, 0, 0, 1, 0])
/// >>> turned.translation
/// array([1., 2., 3.])
/// >>> turned.rotation[0]
/// array([-1.,  0.,  0.])
#[pyclass(frozen, eq, module = "colltrans")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Pose(pub(crate) colltrans::Pose);

getters!(Pose, |it| {
    /// ndarray of shape (3,): The translation ``t``, in world units.
    translation(py): Vector<'py> = row(py, it.0.translation());
    /// ndarray of shape (3, 3): The matrix ``R``, whose nine entries define the rotation.
    rotation(py): PyResult<Bound<'py, PyArray2<f64>>> =
        table(py, it.0.matrix().transpose().to_cols_array_2d().map(|row| row.map(|c| c + 0.0)));
    /// ndarray of shape (4,): The rotation as a unit quaternion x, y, z, w, rounded.
    quaternion(py): Vector<'py> = PyArray1::from_slice(py, &it.0.rotation().to_array());
});

#[pymethods]
impl Pose {
    #[new]
    #[pyo3(signature = (source=None))]
    fn new(source: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        pose(source, "source").map(Self)
    }

    /// Returns the matrix of shape (4, 4).
    fn as_matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (r, t) = (self.0.matrix(), self.0.translation());
        let line = |i: usize| [r.x_axis[i], r.y_axis[i], r.z_axis[i], t[i]].map(|c| c + 0.0);
        table(py, [line(0), line(1), line(2), [0.0, 0.0, 0.0, 1.0]])
    }

    /// Returns the inverse pose, up to rounding error.
    fn inverse(&self) -> PyResult<Self> {
        self.0.inverse().or_raise().map(Self)
    }

    /// Composes two poses: the result applies ``first``, then this pose.
    fn __matmul__(&self, first: &Self) -> PyResult<Self> {
        self.0.compose(&first.0).or_raise().map(Self)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let arguments = (self.as_matrix(py)?,).into_pyobject(py)?;
        Ok((py.get_type::<Self>().into_any(), arguments.into_any()))
    }

    fn __repr__(&self) -> String {
        format!("Pose({})", self.text())
    }
}

impl Pose {
    /// Formats the seven numbers that build the pose again, up to rounding.
    pub(crate) fn text(&self) -> String {
        let (t, q) = (self.0.translation(), self.0.rotation());
        let numbers = [t.x, t.y, t.z, q.x, q.y, q.z, q.w].map(|c| c + 0.0);
        format!("{numbers:?}")
    }
}

/// Reads the pose of an argument; the identity if it is missing.
pub(crate) fn pose(of: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<colltrans::Pose> {
    let Some(of) = of else { return Ok(colltrans::Pose::IDENTITY) };
    if let Ok(pose) = of.cast::<Pose>() {
        return Ok(pose.get().0);
    }
    pose_from_bare(of.py(), &bare_numbers(of, name)?, name)
}

/// The numbers of an argument that is not a [`Pose`].
///
/// They are those of the argument itself, or of the matrix that its method `as_matrix` returns.
pub(crate) struct Bare(pub(crate) Numbers);

/// Returns the numbers of an argument that describes a pose and is not a [`Pose`].
pub(crate) fn bare_numbers(of: &Bound<'_, PyAny>, name: &str) -> PyResult<Bare> {
    if let Some(found) = plain_numbers(of) {
        return Ok(Bare(found));
    }
    if let Some(found) = position_and_quaternion(of, name)? {
        return Ok(Bare(found));
    }
    refuse_list_of_poses(of, name)?;
    match of.getattr_opt("as_matrix")? {
        Some(as_matrix) => numbers(&as_matrix.call0()?, name).map(Bare),
        None => numbers(of, name).map(Bare),
    }
}

/// Reads a pair of a position `(3,)` and a quaternion `(4,)`, as pybullet returns it, as seven numbers.
fn position_and_quaternion(of: &Bound<'_, PyAny>, name: &str) -> PyResult<Option<Numbers>> {
    if !of.is_instance_of::<PyTuple>() && !of.is_instance_of::<PyList>() {
        return Ok(None);
    }
    let pair = of.cast::<PySequence>()?;
    if pair.len()? != 2 {
        return Ok(None);
    }
    let (position, quaternion) = (pair.get_item(0)?, pair.get_item(1)?);
    let has_items = |item: &Bound<'_, PyAny>, n| item.len().is_ok_and(|len| len == n);
    if !has_items(&position, 3) || !has_items(&quaternion, 4) {
        return Ok(None);
    }
    let (position, quaternion) = (numbers(&position, name)?, numbers(&quaternion, name)?);
    let mut values = [0.0; 16];
    values[..3].copy_from_slice(&position.values[..3]);
    values[3..7].copy_from_slice(&quaternion.values[..4]);
    Ok(Some(Numbers { values, shape: Shape::Row(7) }))
}

/// Builds a pose from three or seven numbers or from a matrix.
pub(crate) fn pose_from_bare(py: Python<'_>, bare: &Bare, name: &str) -> PyResult<colltrans::Pose> {
    let Bare(found) = bare;
    let [x, y, z, ..] = found.values;
    let translation = DVec3::new(x, y, z);
    match found.shape {
        Shape::Row(3) => colltrans::Pose::from_translation(translation).or_raise(),
        Shape::Row(7) => {
            let [_, _, _, x, y, z, w, ..] = found.values;
            let rotation = DQuat::from_xyzw(x, y, z, w);
            let rounded = colltrans::Pose::from_rounded(rotation, translation).or_raise()?;
            warn_if_rounded(py, rounded, name)
        }
        _ => pose_from_matrix(py, found, name),
    }
}

/// Builds a pose from a matrix with three or four rows. A matrix `(3, 3)` is a rotation about the origin.
fn pose_from_matrix(py: Python<'_>, found: &Numbers, name: &str) -> PyResult<colltrans::Pose> {
    let v = &found.values;
    let (columns, translation) = match found.shape {
        Shape::Table(3, 4) => (4, DVec3::new(v[3], v[7], v[11])),
        Shape::Table(4, 4) if v[12..] == [0.0, 0.0, 0.0, 1.0] => (4, DVec3::new(v[3], v[7], v[11])),
        Shape::Table(4, 4) => {
            return Err(input_error(
                name,
                format_args!("the last row is {:?}, not 0, 0, 0, 1", &v[12..]),
            ));
        }
        Shape::Table(3, 3) => (3, DVec3::ZERO),
        shape => {
            let shape = shape.text();
            let what =
                format_args!("an array of shape {shape}, not (3,), (7,), (3, 3), (3, 4) or (4, 4)");
            return Err(input_error(name, what));
        }
    };
    let column = |j: usize| DVec3::new(v[j], v[columns + j], v[2 * columns + j]);
    let matrix = DMat3::from_cols(column(0), column(1), column(2));
    let rounded = colltrans::Pose::from_rounded_matrix(matrix, translation).or_raise()?;
    warn_if_rounded(py, rounded, name)
}

/// Returns the pose, and warns if its rotation was replaced by the nearest one.
fn warn_if_rounded(
    py: Python<'_>,
    (pose, defect): (colltrans::Pose, Option<f64>),
    name: &str,
) -> PyResult<colltrans::Pose> {
    defect.map_or(Ok(()), |defect| warn_of_rounded_pose(py, name, defect))?;
    Ok(pose)
}

/// Rejects a list of poses where one pose is expected.
fn refuse_list_of_poses(given: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
    let Ok(list) = given.cast::<PySequence>() else { return Ok(()) };
    if list.len()? == 0 || !list.get_item(0)?.is_instance_of::<Pose>() {
        return Ok(());
    }
    let count = list.len()?;
    Err(input_error(
        name,
        format_args!(
            "a list of {count} poses, where one is expected; functions in bulk (cast_many, \
             distance_many, ...) take a list, one for each row"
        ),
    ))
}
