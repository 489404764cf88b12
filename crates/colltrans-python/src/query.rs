//! Queries between convex bodies, as values: two placed bodies, a direction and the choices.
//!
//! A [`Cast`] is what every answer keeps to say more when it is asked: features, points, whether a proof
//! is one. It holds its bodies by reference, so it is small, and the library's cast is made from it in
//! no time.

use colltrans::glam::DVec3;
use colltrans::record::Dents;
use colltrans::{Options, QueryError};
use pyo3::prelude::*;

use crate::arrays::{Vector, row, vector};
use crate::body::ConvexPolyhedron;
use crate::errors::{OrRaise, error, query_error};
use crate::frozen::{Options as Shows, Shown, getters, html, show};
use crate::pose::{Pose, pose};
use crate::solid::ConvexArgument;
use crate::solver::options_of;

/// The arguments that all queries share.
pub(crate) struct Arguments<'a, 'py> {
    pub(crate) moving: &'a Bound<'py, ConvexPolyhedron>,
    pub(crate) fixed: &'a Bound<'py, ConvexPolyhedron>,
    pub(crate) direction: &'a Bound<'py, PyAny>,
    pub(crate) poses: [Option<&'a Bound<'py, PyAny>>; 2],
    pub(crate) graze_tolerance: f64,
    pub(crate) keep: f64,
    pub(crate) solver: Option<&'a Bound<'py, PyAny>>,
}

/// A query as a value: two placed bodies and a direction, asked what one likes, saved and replayed.
///
/// Parameters
/// ----------
/// moving, fixed : ConvexPolyhedron
///     The body that moves, and the one that does not.
/// direction : array_like of shape (3,)
///     Of the world, of any length; translations count in multiples of it.
/// moving_pose, fixed_pose : array_like or Pose, optional
///     Where the bodies are; see :class:`Pose`.
/// graze_tolerance : float
///     Sideways overlaps up to this length count as grazing. 0 stands for rounding error.
/// keep : float
///     A gap to be kept, a length: all questions are then about where the bodies are as near as that, not
///     about where they touch. Points of answers are those that are the gap apart.
/// solver : {"auto", "cta", "portal"} or Cta
///     How the search is narrowed. Answers and certificates are the same. A body's first query with
///     "cta" that needs its sections makes them, and pays for it.
///
/// Raises
/// ------
/// QueryError
///     A direction that is zero or out of range, a tolerance or a gap that is negative.
/// PoseError
///     A pose that is none.
///
/// Examples
/// --------
/// >>> from colltrans import Cast, ConvexPolyhedron
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> query = Cast(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0])
/// >>> query.first_contact().translation
/// 2.0
/// >>> Cast.from_json(query.to_json()).first_contact().translation
/// 2.0
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Cast {
    pub(crate) moving: Py<ConvexPolyhedron>,
    pub(crate) fixed: Py<ConvexPolyhedron>,
    pub(crate) poses: [colltrans::Pose; 2],
    pub(crate) direction: DVec3,
    pub(crate) options: Options,
}

impl Cast {
    /// Returns the dents of the two meshes where these are convex only to within the tolerance.
    pub(crate) fn dents(&self) -> Option<Dents> {
        Dents::of([&self.moving, &self.fixed].map(|body| body.get().dent()))
    }

    /// Not checked yet.
    pub(crate) fn of(arguments: Arguments<'_, '_>) -> PyResult<Self> {
        let Arguments { moving, fixed, direction, poses, graze_tolerance, keep, solver } =
            arguments;
        Ok(Self {
            moving: moving.clone().unbind(),
            fixed: fixed.clone().unbind(),
            poses: [pose(poses[0], "moving_pose")?, pose(poses[1], "fixed_pose")?],
            direction: vector(direction, "direction")?,
            options: options_of(solver)?.with_graze_tolerance(graze_tolerance).with_keep(keep),
        })
    }

    /// The library's.
    #[inline]
    fn cast(&self) -> Result<colltrans::Cast<'_>, QueryError> {
        let (moving, fixed) = (&self.moving.get().0, &self.fixed.get().0);
        colltrans::Cast::new(moving.at(self.poses[0]), fixed.at(self.poses[1]), self.direction)?
            .with_options(self.options)
    }

    /// An answer of the library's, or its exception; without the interpreter's lock where it takes long.
    #[inline]
    pub(crate) fn ask<'a, T: Send>(
        &'a self,
        py: Python<'_>,
        question: impl FnOnce(&colltrans::Cast<'a>) -> Result<T, QueryError> + Send,
    ) -> PyResult<T> {
        let work = || self.cast().and_then(|cast| question(&cast));
        // All others take about a microsecond, of bodies of any size: waiting for the lock would take longer.
        let options = &self.options;
        let is_long = options.keep != 0.0 || options.solver == colltrans::Solver::Cta;
        let found = if is_long { py.detach(work) } else { work() };
        found.map_err(|what| self.error(&what))
    }

    /// What is made of the library's cast without a search.
    pub(crate) fn with<'a, T>(
        &'a self,
        make: impl FnOnce(&colltrans::Cast<'a>) -> T,
    ) -> PyResult<T> {
        self.cast().map(|cast| make(&cast)).map_err(|what| self.error(&what))
    }

    pub(crate) fn error(&self, what: &QueryError) -> PyErr {
        query_error(what, || self.cast().map_or_else(|e| e.to_string(), |cast| cast.to_json()))
    }

    /// The same bodies where they are, along another direction.
    pub(crate) fn along(&self, py: Python<'_>, direction: DVec3) -> Self {
        let (moving, fixed) = (self.moving.clone_ref(py), self.fixed.clone_ref(py));
        Self { moving, fixed, direction, ..*self }
    }
}

getters!(Cast, |it| {
    /// ConvexPolyhedron: The moving body.
    moving(py): Py<ConvexPolyhedron> = it.moving.clone_ref(py);
    /// ConvexPolyhedron: The fixed body.
    fixed(py): Py<ConvexPolyhedron> = it.fixed.clone_ref(py);
    /// Pose: Where the moving body is.
    moving_pose: Pose = Pose(it.poses[0]);
    /// Pose: Where the fixed body is.
    fixed_pose: Pose = Pose(it.poses[1]);
    /// ndarray of shape (3,): The direction, as given.
    direction(py): Vector<'py> = row(py, it.direction);
    /// float: Sideways overlaps up to this length count as grazing.
    graze_tolerance: f64 = it.options.graze_tolerance;
    /// float: The gap to be kept; 0 if there is none.
    keep: f64 = it.options.keep;
    /// str: How the search is narrowed.
    solver: &'static str = it.options.solver.name();
});

#[pymethods]
impl Cast {
    #[new]
    #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
        graze_tolerance=0.0, keep=0.0, solver=None), text_signature = "(moving, fixed, direction, \
        *, moving_pose=None, fixed_pose=None, graze_tolerance=0.0, keep=0.0, solver='auto')")]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        moving: ConvexArgument<'_>,
        fixed: ConvexArgument<'_>,
        direction: &Bound<'_, PyAny>,
        moving_pose: Option<&Bound<'_, PyAny>>,
        fixed_pose: Option<&Bound<'_, PyAny>>,
        graze_tolerance: f64,
        keep: f64,
        solver: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let poses = [moving_pose, fixed_pose];
        let (moving, fixed) = (&moving.0, &fixed.0);
        let query =
            Self::of(Arguments { moving, fixed, direction, poses, graze_tolerance, keep, solver })?;
        query.with(|_| ())?;
        Ok(query)
    }

    /// The same bodies where they are, and the direction turned round.
    pub(crate) fn reversed(&self, py: Python<'_>) -> Self {
        self.along(py, -self.direction)
    }

    /// The query as text: bodies, poses, direction and choices, exact in bits.
    ///
    /// ``colltrans replay`` of the command line reads the same.
    fn to_json(&self) -> PyResult<String> {
        self.with(|cast| cast.to_json())
    }

    /// From what `to_json`, or the command line, has written.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        let saved = colltrans::Case::from_json(text).or_raise()?;
        let cast = saved.cast().map_err(|what| error("QueryError", what))?;
        let body =
            |body: &colltrans::ConvexPolyhedron| Py::new(py, ConvexPolyhedron::from(body.clone()));
        Ok(Self {
            moving: body(cast.moving())?,
            fixed: body(cast.fixed())?,
            poses: [cast.moving_pose(), cast.fixed_pose()],
            direction: cast.direction(),
            options: cast.options(),
        })
    }

    /// A picture of the bodies and of the first contact: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Shows<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> Shown<'py> {
        html(slf)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("from_json")?, (self.to_json()?,)))
    }

    fn __repr__(&self) -> PyResult<String> {
        self.with(|cast| format!("Cast({cast})"))
    }
}
