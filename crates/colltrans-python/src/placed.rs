//! Bodies in poses.

use pyo3::prelude::*;

use crate::errors::input_error;
use crate::frozen::getters;
use crate::pose::{Pose, pose};
use crate::solid::Piece;

/// A body in a pose: the result of ``body.at(pose)``.
///
/// Every function that takes a body with a pose takes a placed body instead of both.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, cast
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> cast(cube.at([-3, 0.5, 0]), cube, [1, 0, 0]).translation
/// 2.0
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Placed {
    pub(crate) body: Piece,
    pub(crate) pose: colltrans::Pose,
}

getters!(Placed, |it| {
    /// ConvexPolyhedron or Solid: The body.
    body(py): Py<PyAny> = it.body.object(py);
    /// Pose: The pose of the body in the world.
    pose: Pose = Pose(it.pose);
});

#[pymethods]
impl Placed {
    #[new]
    #[pyo3(signature = (body, pose=None))]
    fn new(body: &Bound<'_, PyAny>, pose: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let (body, pose) = Piece::placed(body, pose, "body")?;
        Ok(Self { body, pose })
    }

    fn __getnewargs__(&self, py: Python<'_>) -> (Py<PyAny>, Pose) {
        (self.body.object(py), Pose(self.pose))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let body = self.body.object(py).bind(py).repr()?.to_string();
        Ok(format!("{body}.at({})", Pose(self.pose).text()))
    }
}

/// Separates a body from its pose: that of a placed body, or that of the argument `name_pose`.
pub(crate) fn place<'py>(
    given: &Bound<'py, PyAny>,
    at: Option<&Bound<'_, PyAny>>,
    name: &str,
) -> PyResult<(Bound<'py, PyAny>, colltrans::Pose)> {
    let argument = if name == "body" { "pose".into() } else { format!("{name}_pose") };
    let Ok(placed) = given.cast::<Placed>() else {
        return Ok((given.clone(), pose(at, &argument)?));
    };
    if at.is_some() {
        let what = format!("{name} has a pose already, from body.at(pose); drop one of them");
        return Err(input_error(&argument, what));
    }
    let Placed { body, pose } = placed.get();
    Ok((body.object(given.py()).into_bound(given.py()), *pose))
}
