//! Queries between convex bodies, as values: two placed bodies, a direction and options.
//!
//! Every answer holds its [`Cast`] and computes features, points and checks of proofs from it on request. A
//! cast holds its bodies by reference, so it is small, and building the library's cast from it is cheap.

use colltrans::glam::DVec3;
use colltrans::record::Dents;
use colltrans::{Options, QueryError};
use pyo3::prelude::*;

use crate::arrays::{Vector, row, vector};
use crate::body::ConvexPolyhedron;
use crate::errors::{OrRaise, error, query_error};
use crate::frozen::{Options as Shows, Shown, getters, html, show};
use crate::placed::place;
use crate::pose::Pose;
use crate::solid::convex_body;
use crate::solver::options_of;

/// The arguments that all queries share.
pub(crate) struct Arguments<'a, 'py> {
    pub(crate) moving: &'a Bound<'py, PyAny>,
    pub(crate) fixed: &'a Bound<'py, PyAny>,
    pub(crate) direction: &'a Bound<'py, PyAny>,
    pub(crate) poses: [Option<&'a Bound<'py, PyAny>>; 2],
    pub(crate) graze_tolerance: f64,
    pub(crate) min_gap: f64,
    pub(crate) solver: Option<&'a Bound<'py, PyAny>>,
}

/// Two placed bodies and a direction, as a value: query it, save it, replay it.
///
/// Parameters
/// ----------
/// moving, fixed : ConvexPolyhedron
///     The moving and the fixed body.
/// direction : array_like of shape (3,)
///     A vector of the world, of any length. Translations are multiples of it.
/// moving_pose, fixed_pose : array_like or Pose, optional
///     Poses of the bodies in the world; see :class:`Pose`.
/// graze_tolerance : float
///     Lateral overlaps up to this length count as grazing. With 0 the limit follows from rounding errors.
/// min_gap : float
///     A minimum gap, a length. With a gap all questions refer to the translation at which the distance falls
///     to the gap instead of contact. Points of answers are then the gap apart.
/// solver : {"auto", "cta", "portal"} or Cta
///     The search algorithm. Answers are equally accurate; the normal and the features may differ if vertices
///     or parallel edges meet. With "cta", the first query of a body that needs its sections builds them, which
///     takes longer.
///
/// Raises
/// ------
/// QueryError
///     The direction is zero or out of range, or a tolerance or a gap is negative.
/// PoseError
///     An argument does not describe a pose.
///
/// Examples
/// --------
/// >>> from colltrans import Cast, ConvexPolyhedron
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> query = Cast(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0])
/// >>> query.cast().translation
/// 2.0
/// >>> Cast.from_json(query.to_json()).cast().translation
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
    /// Returns the dents of the two meshes, if these are convex only within the tolerance.
    pub(crate) fn dents(&self) -> Option<Dents> {
        Dents::from_depths([&self.moving, &self.fixed].map(|body| body.get().dent()))
    }

    /// Builds a query without checking it.
    pub(crate) fn from_arguments(arguments: Arguments<'_, '_>) -> PyResult<Self> {
        let Arguments { moving, fixed, direction, poses, graze_tolerance, min_gap, solver } =
            arguments;
        let (moving, moving_pose) = place(moving, poses[0], "moving")?;
        let (fixed, fixed_pose) = place(fixed, poses[1], "fixed")?;
        Ok(Self {
            moving: convex_body(&moving)?.unbind(),
            fixed: convex_body(&fixed)?.unbind(),
            poses: [moving_pose, fixed_pose],
            direction: vector(direction, "direction")?,
            options: options_of(solver)?
                .with_graze_tolerance(graze_tolerance)
                .with_min_gap(min_gap),
        })
    }

    /// Builds the cast of the library.
    #[inline]
    fn cast(&self) -> Result<colltrans::Cast<'_>, QueryError> {
        let (moving, fixed) = (&self.moving.get().0, &self.fixed.get().0);
        colltrans::Cast::new(moving.at(self.poses[0]), fixed.at(self.poses[1]), self.direction)?
            .with_options(self.options)
    }

    /// Runs a query of the library. Releases the interpreter's lock if the query takes long.
    #[inline]
    pub(crate) fn ask<'a, T: Send>(
        &'a self,
        py: Python<'_>,
        question: impl FnOnce(&colltrans::Cast<'a>) -> Result<T, QueryError> + Send,
    ) -> PyResult<T> {
        let work = || self.cast().and_then(|cast| question(&cast));
        // All other queries of polyhedra take about a microsecond for bodies of any size; waiting for the lock
        // would take longer.
        let options = &self.options;
        let rounded = [&self.moving, &self.fixed].iter().any(|body| body.get().0.radius() != 0.0);
        let is_long = options.min_gap != 0.0 || rounded || options.solver == colltrans::Solver::Cta;
        let found = if is_long { py.detach(work) } else { work() };
        found.map_err(|what| self.error(&what))
    }

    /// Computes a value from the library's cast without a search.
    pub(crate) fn with<'a, T>(
        &'a self,
        make: impl FnOnce(&colltrans::Cast<'a>) -> T,
    ) -> PyResult<T> {
        self.cast().map(|cast| make(&cast)).map_err(|what| self.error(&what))
    }

    pub(crate) fn error(&self, what: &QueryError) -> PyErr {
        query_error(what, || self.cast().map_or_else(|e| e.to_string(), |cast| cast.to_json()))
    }

    /// Returns the query of the same placed bodies along another direction.
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
    /// Pose: The pose of the moving body.
    moving_pose: Pose = Pose(it.poses[0]);
    /// Pose: The pose of the fixed body.
    fixed_pose: Pose = Pose(it.poses[1]);
    /// ndarray of shape (3,): The direction, as given.
    direction(py): Vector<'py> = row(py, it.direction);
    /// float: Lateral overlaps up to this length count as grazing.
    graze_tolerance: f64 = it.options.graze_tolerance;
    /// float: The minimum gap; 0 if there is none.
    min_gap: f64 = it.options.min_gap;
    /// str: The search algorithm.
    solver: &'static str = it.options.solver.name();
});

#[pymethods]
impl Cast {
    #[new]
    #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
        graze_tolerance=0.0, min_gap=0.0, solver=None), text_signature = "(moving, fixed, direction, \
        *, moving_pose=None, fixed_pose=None, graze_tolerance=0.0, min_gap=0.0, solver='auto')")]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        moving: &Bound<'_, PyAny>,
        fixed: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        moving_pose: Option<&Bound<'_, PyAny>>,
        fixed_pose: Option<&Bound<'_, PyAny>>,
        graze_tolerance: f64,
        min_gap: f64,
        solver: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let poses = [moving_pose, fixed_pose];
        let query = Self::from_arguments(Arguments {
            moving,
            fixed,
            direction,
            poses,
            graze_tolerance,
            min_gap,
            solver,
        })?;
        query.with(|_| ())?;
        Ok(query)
    }

    /// Returns the query of the same placed bodies along the opposite direction.
    pub(crate) fn reversed(&self, py: Python<'_>) -> Self {
        self.along(py, -self.direction)
    }

    /// Returns the query as text: bodies, poses, direction and options, exact in bits.
    ///
    /// The command ``colltrans replay`` reads this text too.
    fn to_json(&self) -> PyResult<String> {
        self.with(|cast| cast.to_json())
    }

    /// Reads the text that `to_json` or the command line wrote.
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

    /// Draws the bodies and the first contact; see :func:`colltrans.show`.
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
