//! Queries about solids.
//!
//! They run without the interpreter's lock, because a query takes milliseconds, or minutes for large bodies.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use colltrans::glam::DVec3;
use colltrans::record::Dents;
use colltrans::solid::SolidCast as _;
use colltrans::solid::{SolidOptions, StartOverlap};
use colltrans_mesh::body::cast_between;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Vector, coordinates, row, vector};
use crate::errors::{OrRaise, error};
use crate::frozen::{Options, Shown, getters, html, show};
use crate::pose::Pose;
use crate::solid::Piece;

/// A query about solids, as a value: two placed bodies and a direction.
///
/// Parameters
/// ----------
/// moving, fixed : Solid or ConvexPolyhedron
///     The moving and the fixed body.
/// direction : array_like of shape (3,)
///     A vector of the world, of any length. Translations are multiples of it.
/// moving_pose, fixed_pose : array_like or Pose, optional
///     Poses of the bodies in the world; see :class:`Pose`.
/// tolerance : float, optional
///     Both bodies are shrunk by half of this length, so that fitting parts do not jam. The default is that
///     of the command line: twice the possible rounding of the coordinates in both files
///     (:attr:`Solid.precision`), and at least what rotated poses need. It is 0 for bodies without files if
///     both poses rotate by quarter turns.
/// min_gap : float
///     A minimum gap, a length. The bodies, shrunk by half the tolerance each, stop when their distance falls
///     to it.
/// ignore_start_overlaps : bool
///     Whether facets that cross at the start are ignored. Contacts that begin later still block.
///
/// Raises
/// ------
/// QueryError
///     The direction is zero or out of range, a length is negative, or the tolerance leaves nothing of a body.
/// BuildError
///     The facets of a convex body do not form a surface.
/// PoseError, InputError
///     An argument does not describe a pose, or is not an array of that shape.
///
/// Examples
/// --------
/// >>> from colltrans import Solid, SolidCast
/// >>> bolt, plate = Solid.read("data/bolt.stl"), Solid.read("data/plate.off")
/// >>> query = SolidCast(bolt, plate, [0, 0, -1], moving_pose=[0, 0, 7])
/// >>> found = query.clearance()
/// >>> query.tolerance  # the bolt is in single precision
/// 2.3841858407536165e-06
/// >>> found.contact.translation
/// 7.0
/// >>> 7 - 1e-11 < found.distance <= 7
/// True
/// >>> query.exit()
/// 12.0
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidCast {
    pub(crate) bodies: [Piece; 2],
    pub(crate) poses: [colltrans::Pose; 2],
    pub(crate) direction: DVec3,
    pub(crate) options: SolidOptions,
}

/// The bodies and the direction.
type Positional = (Py<PyAny>, Py<PyAny>, [f64; 3]);

/// Time between two polls for signals.
const PATIENCE: Duration = Duration::from_millis(100);
/// Number of triangles below which queries run on the calling thread, because no answer takes long.
const LARGE: usize = 4096;

impl SolidCast {
    /// Returns the dents of the two meshes, if these are convex only within the tolerance.
    pub(crate) fn dents(&self) -> Option<Dents> {
        Dents::from_depths(self.bodies.each_ref().map(Piece::dent))
    }

    /// Runs a query of the library.
    fn run<T>(
        &self,
        question: impl FnOnce(&colltrans::Cast<'_, colltrans::Solid>) -> T,
    ) -> PyResult<T> {
        let solids = [self.bodies[0].solid().or_raise()?, self.bodies[1].solid().or_raise()?];
        let [moving, fixed] = [0, 1].map(|i| solids[i].at(self.poses[i]));
        let precisions = [0, 1].map(|i| self.bodies[i].precision());
        let SolidOptions { tolerance, start_overlap, min_gap, .. } = self.options;
        cast_between(moving, fixed, self.direction, precisions, tolerance, start_overlap)
            .and_then(|cast| cast.with_min_gap(min_gap))
            .map(|cast| question(&cast))
            .map_err(|what| error("QueryError", what))
    }

    pub(crate) fn ask<T: Send + 'static>(
        slf: &Bound<'_, Self>,
        question: impl FnOnce(&colltrans::Cast<'_, colltrans::Solid>) -> T + Send + 'static,
    ) -> PyResult<T> {
        let query = slf.clone().unbind();
        run_patiently(slf.py(), &slf.get().bodies, move || query.get().run(question))
    }
}

/// Defines the attributes of the placed bodies, for a query that has `bodies` and `poses`.
macro_rules! placed_bodies {
    ($query:ident) => {
        $crate::frozen::getters!($query, |it| {
            /// ConvexPolyhedron or Solid: The moving body.
            moving(py): Py<PyAny> = it.bodies[0].object(py);
            /// ConvexPolyhedron or Solid: The fixed body.
            fixed(py): Py<PyAny> = it.bodies[1].object(py);
            /// Pose: The pose of the moving body.
            moving_pose: Pose = Pose(it.poses[0]);
            /// Pose: The pose of the fixed body.
            fixed_pose: Pose = Pose(it.poses[1]);
        });
    };
}
pub(crate) use placed_bodies;

placed_bodies!(SolidCast);

/// Runs work without the interpreter's lock. For large bodies it runs on a thread of its own; if a signal
/// handler raises, the call returns and the thread is abandoned.
pub(crate) fn run_patiently<T: Send + 'static>(
    py: Python<'_>,
    bodies: &[Piece; 2],
    work: impl FnOnce() -> PyResult<T> + Send + 'static,
) -> PyResult<T> {
    if bodies.iter().map(Piece::triangle_count).sum::<usize>() < LARGE {
        return py.detach(work);
    }
    let (sender, receiver) = mpsc::sync_channel(1);
    std::thread::Builder::new().spawn(move || {
        // The receiver is gone if a signal handler raised.
        let _ = sender.send(work());
    })?;
    py.detach(move || {
        loop {
            match receiver.recv_timeout(PATIENCE) {
                Ok(answer) => return answer,
                Err(RecvTimeoutError::Timeout) => Python::attach(|py| py.check_signals())?,
                Err(RecvTimeoutError::Disconnected) => {
                    let what = "internal error; please report it";
                    return Err(PyRuntimeError::new_err(what));
                }
            }
        }
    })
}

getters!(SolidCast, |it| {
    /// float: The tolerance that is used, a length.
    tolerance(py): PyResult<f64> = py.detach(|| it.run(|cast| cast.tolerance()));
    /// float: The minimum gap; 0 if there is none.
    min_gap: f64 = it.options.min_gap;
    /// ndarray of shape (3,): The direction, as given.
    direction(py): Vector<'py> = row(py, it.direction);
});

#[pymethods]
impl SolidCast {
    #[new]
    #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
        tolerance=None, min_gap=0.0, ignore_start_overlaps=false))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    pub(crate) fn new(
        py: Python<'_>,
        moving: &Bound<'_, PyAny>,
        fixed: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        moving_pose: Option<&Bound<'_, PyAny>>,
        fixed_pose: Option<&Bound<'_, PyAny>>,
        tolerance: Option<f64>,
        min_gap: f64,
        ignore_start_overlaps: bool,
    ) -> PyResult<Self> {
        let start_overlap =
            if ignore_start_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
        let (moving, moving_pose) = Piece::placed(moving, moving_pose, "moving")?;
        let (fixed, fixed_pose) = Piece::placed(fixed, fixed_pose, "fixed")?;
        let cast = Self {
            bodies: [moving, fixed],
            poses: [moving_pose, fixed_pose],
            direction: vector(direction, "direction")?,
            options: SolidOptions::default()
                .with_tolerance(tolerance)
                .with_min_gap(min_gap)
                .with_start_overlap(start_overlap),
        };
        py.detach(|| cast.run(|_| ()))?;
        Ok(cast)
    }

    /// Returns the query of the same placed bodies along the opposite direction.
    fn reversed(&self, py: Python<'_>) -> Self {
        let bodies = [self.bodies[0].copy(py), self.bodies[1].copy(py)];
        Self { bodies, direction: -self.direction, ..*self }
    }

    /// Draws the bodies and the answer; see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> Shown<'py> {
        html(slf)
    }

    /// Returns the arguments that build the query again, for `pickle` and `copy`.
    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Positional, Bound<'py, PyDict>)> {
        let named = PyDict::new(py);
        named.set_item("moving_pose", self.moving_pose())?;
        named.set_item("fixed_pose", self.fixed_pose())?;
        named.set_item("tolerance", self.options.tolerance)?;
        named.set_item("min_gap", self.options.min_gap)?;
        let ignores = self.options.start_overlap == StartOverlap::Ignore;
        named.set_item("ignore_start_overlaps", ignores)?;
        Ok(((self.moving(py), self.fixed(py), self.direction.to_array()), named))
    }

    fn __repr__(&self) -> String {
        format!("SolidCast(direction={:?})", coordinates(self.direction))
    }
}
