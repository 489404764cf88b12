//! Queries: two placed bodies, a direction and the choices, as a value and as functions.
//!
//! A [`Query`] is what every answer keeps to say more when it is asked: features, points, whether a
//! proof is one. It holds its bodies by reference, so it is small, and the library's cast is made
//! from it in no time.

use colltrans::glam::DVec3;
use colltrans::{Options, Solver};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};

use crate::answer;
use crate::arrays::{row, vector};
use crate::body::ConvexPolyhedron;
use crate::certificate::{Certificate, Separation};
use crate::errors::{OrRaise, error, query_error};
use crate::pose::{Pose, pose};
use crate::show::{Options as Shows, Shown, show};
use crate::solid_cast::SolidCast;

/// What was asked, or is about to be.
pub(crate) struct Query {
    pub(crate) moving: Py<ConvexPolyhedron>,
    pub(crate) fixed: Py<ConvexPolyhedron>,
    pub(crate) poses: [colltrans::Pose; 2],
    pub(crate) direction: DVec3,
    pub(crate) options: Options,
}

/// The arguments that all queries share.
pub(crate) struct Arguments<'a, 'py> {
    pub(crate) moving: &'a Bound<'py, ConvexPolyhedron>,
    pub(crate) fixed: &'a Bound<'py, ConvexPolyhedron>,
    pub(crate) direction: &'a Bound<'py, PyAny>,
    pub(crate) poses: [Option<&'a Bound<'py, PyAny>>; 2],
    pub(crate) graze_tolerance: f64,
    pub(crate) solver: Option<&'a Bound<'py, PyString>>,
}

impl Query {
    pub(crate) fn new(arguments: Arguments<'_, '_>) -> PyResult<Self> {
        let Arguments { moving, fixed, direction, poses, graze_tolerance, solver } = arguments;
        Ok(Self {
            moving: moving.clone().unbind(),
            fixed: fixed.clone().unbind(),
            poses: [pose(poses[0], "moving_pose")?, pose(poses[1], "fixed_pose")?],
            direction: vector(direction, "direction")?,
            options: Options {
                solver: solver_called(solver)?,
                graze_tolerance,
                ..Options::default()
            },
        })
    }

    /// The library's.
    #[inline]
    pub(crate) fn cast(&self) -> Result<colltrans::Cast<'_>, colltrans::QueryError> {
        let (moving, fixed) = (&self.moving.get().0, &self.fixed.get().0);
        colltrans::Cast::new(moving.at(self.poses[0]), fixed.at(self.poses[1]), self.direction)?
            .with_options(self.options)
    }

    /// An answer of the library's, or its exception.
    #[inline]
    pub(crate) fn ask<'a, T>(
        &'a self,
        question: impl FnOnce(&colltrans::Cast<'a>) -> Result<T, colltrans::QueryError>,
    ) -> PyResult<T> {
        self.cast().and_then(|cast| question(&cast)).map_err(|what| self.error(&what))
    }

    pub(crate) fn error(&self, what: &colltrans::QueryError) -> PyErr {
        query_error(what, || self.cast().map_or_else(|e| e.to_string(), |cast| cast.to_json()))
    }

    pub(crate) fn copy(&self, py: Python<'_>) -> Self {
        let (moving, fixed) = (self.moving.clone_ref(py), self.fixed.clone_ref(py));
        Self { moving, fixed, ..*self }
    }

    /// The same bodies, and the direction turned round.
    pub(crate) fn reversed(&self, py: Python<'_>) -> Self {
        Self { direction: -self.direction, ..self.copy(py) }
    }
}

/// A solver by its name; `auto` without.
pub(crate) fn solver_called(name: Option<&Bound<'_, PyString>>) -> PyResult<Solver> {
    name.map_or(Ok(Solver::Auto), |name| solver_called_by(name.to_str()?))
}

pub(crate) fn solver_called_by(name: &str) -> PyResult<Solver> {
    match name {
        "auto" => Ok(Solver::Auto),
        "cta" => Ok(Solver::Cta),
        "portal" => Ok(Solver::Portal),
        other => Err(error("QueryError", format_args!("no solver {other:?}: auto, cta or portal"))),
    }
}

pub(crate) fn solver_name(solver: Solver) -> &'static str {
    match solver {
        Solver::Auto => "auto",
        Solver::Cta => "cta",
        Solver::Portal => "portal",
    }
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
/// solver : {"auto", "cta", "portal"}
///     How the search is narrowed. Answers and certificates are the same.
///
/// Raises
/// ------
/// QueryError
///     A direction that is zero or out of range, a tolerance that is negative.
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
pub(crate) struct Cast(pub(crate) Query);

#[pymethods]
impl Cast {
    #[new]
    #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
        graze_tolerance=0.0, solver=None), text_signature = "(moving, fixed, direction, *, \
        moving_pose=None, fixed_pose=None, graze_tolerance=0.0, solver='auto')")]
    fn new(
        moving: &Bound<'_, ConvexPolyhedron>,
        fixed: &Bound<'_, ConvexPolyhedron>,
        direction: &Bound<'_, PyAny>,
        moving_pose: Option<&Bound<'_, PyAny>>,
        fixed_pose: Option<&Bound<'_, PyAny>>,
        graze_tolerance: f64,
        solver: Option<&Bound<'_, PyString>>,
    ) -> PyResult<Self> {
        let poses = [moving_pose, fixed_pose];
        let query =
            Query::new(Arguments { moving, fixed, direction, poses, graze_tolerance, solver })?;
        query.ask(|_| Ok(()))?;
        Ok(Self(query))
    }

    /// At which translation do the bodies first meet? See :func:`cast`.
    fn first_contact<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        first_contact(py, self.0.copy(py))
    }

    /// At which translations do they first and last meet? See :func:`contact_range`.
    fn contact_range<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        range(py, self.0.copy(py))
    }

    /// How far can the moving body move from where it is? See :func:`clearance`.
    fn clearance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        clear(py, self.0.copy(py))
    }

    /// How far must it go back until the overlap ends? See :func:`directional_depth`.
    fn directional_depth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        depth(py, self.0.copy(py))
    }

    /// Do the bodies meet where they are? See :func:`intersects`.
    fn intersects<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        meet(py, self.0.copy(py))
    }

    /// The same bodies where they are, and the direction turned round.
    fn reversed(&self, py: Python<'_>) -> Self {
        Self(self.0.reversed(py))
    }

    /// Checks a proof against the two bodies, with nothing of the search that found it.
    ///
    /// Parameters
    /// ----------
    /// proof : Certificate or Separation
    ///
    /// Returns
    /// -------
    /// float
    ///     The gap, in multiples of the direction, or the margin, a length, that is really proven.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     What is not proven.
    fn verify(&self, proof: &Bound<'_, PyAny>) -> PyResult<f64> {
        let cast = self.0.cast().map_err(|what| self.0.error(&what))?;
        if let Ok(separation) = proof.cast::<Separation>() {
            return cast.verify(&separation.get().proof).or_raise();
        }
        cast.verify(&proof.cast::<Certificate>()?.get().proof).or_raise()
    }

    /// The query as text: bodies, poses, direction and choices, exact in bits.
    ///
    /// ``colltrans replay`` of the command line reads the same.
    fn to_json(&self) -> PyResult<String> {
        self.0.ask(|cast| Ok(cast.to_json()))
    }

    /// From what `to_json`, or the command line, has written.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        let saved = colltrans::Case::from_json(text).or_raise()?;
        let cast = saved.cast().map_err(|what| error("QueryError", what))?;
        let body = |body: &colltrans::ConvexPolyhedron| Py::new(py, ConvexPolyhedron(body.clone()));
        Ok(Self(Query {
            moving: body(cast.moving())?,
            fixed: body(cast.fixed())?,
            poses: [cast.moving_pose(), cast.fixed_pose()],
            direction: cast.direction(),
            options: cast.options(),
        }))
    }

    /// ConvexPolyhedron: The moving body.
    #[getter]
    fn moving(&self, py: Python<'_>) -> Py<ConvexPolyhedron> {
        self.0.moving.clone_ref(py)
    }

    /// ConvexPolyhedron: The fixed body.
    #[getter]
    fn fixed(&self, py: Python<'_>) -> Py<ConvexPolyhedron> {
        self.0.fixed.clone_ref(py)
    }

    /// Pose: Where the moving body is.
    #[getter]
    fn moving_pose(&self) -> Pose {
        Pose(self.0.poses[0])
    }

    /// Pose: Where the fixed body is.
    #[getter]
    fn fixed_pose(&self) -> Pose {
        Pose(self.0.poses[1])
    }

    /// ndarray of shape (3,): The direction, as given.
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        row(py, self.0.direction)
    }

    /// float: Sideways overlaps up to this length count as grazing.
    #[getter]
    fn graze_tolerance(&self) -> f64 {
        self.0.options.graze_tolerance
    }

    /// str: How the search is narrowed.
    #[getter]
    fn solver(&self) -> &'static str {
        solver_name(self.0.options.solver)
    }

    /// A picture of the bodies and of the first contact: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Shows<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("from_json")?, (self.to_json()?,)))
    }

    fn __repr__(&self) -> PyResult<String> {
        self.0.ask(|cast| Ok(format!("Cast({cast})")))
    }
}

fn first_contact(py: Python<'_>, query: Query) -> PyResult<Bound<'_, PyAny>> {
    let outcome = query.ask(|cast| cast.first_contact())?;
    answer::outcome(py, query, outcome)
}

fn range(py: Python<'_>, query: Query) -> PyResult<Bound<'_, PyAny>> {
    let range = query.ask(|cast| cast.contact_range())?;
    answer::range(py, query, range)
}

fn clear(py: Python<'_>, query: Query) -> PyResult<Bound<'_, PyAny>> {
    let clearance = query.ask(|cast| cast.clearance())?;
    answer::clearance(py, query, clearance)
}

fn depth(py: Python<'_>, query: Query) -> PyResult<Bound<'_, PyAny>> {
    let depth = query.ask(|cast| cast.directional_depth())?;
    answer::depth(py, query, depth)
}

fn meet(py: Python<'_>, query: Query) -> PyResult<Bound<'_, PyAny>> {
    let meeting = query.ask(|cast| cast.intersects())?;
    answer::intersection(py, query, meeting)
}

fn solids_meet<'py>(query: &Bound<'py, SolidCast>) -> PyResult<Bound<'py, PyAny>> {
    Ok(PyBool::new(query.py(), SolidCast::intersects(query)?).to_owned().into_any())
}

/// A function of Python that asks one question.
macro_rules! question {
    ($(#[$doc:meta])* $name:ident => $ask:path) => {
        $(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
            graze_tolerance=0.0, solver=None), text_signature = "(moving, fixed, direction, *, \
            moving_pose=None, fixed_pose=None, graze_tolerance=0.0, solver='auto')")]
        #[expect(clippy::too_many_arguments, reason = "they are keywords")]
        pub(crate) fn $name<'py>(
            py: Python<'py>,
            moving: &Bound<'py, ConvexPolyhedron>,
            fixed: &Bound<'py, ConvexPolyhedron>,
            direction: &Bound<'py, PyAny>,
            moving_pose: Option<&Bound<'py, PyAny>>,
            fixed_pose: Option<&Bound<'py, PyAny>>,
            graze_tolerance: f64,
            solver: Option<&Bound<'py, PyString>>,
        ) -> PyResult<Bound<'py, PyAny>> {
            let poses = [moving_pose, fixed_pose];
            $ask(py, Query::new(Arguments { moving, fixed, direction, poses, graze_tolerance, solver })?)
        }
    };
}

/// A function of Python that asks one question of bodies of any kind.
macro_rules! question_of_any {
    ($(#[$doc:meta])* $name:ident => $ask:path, $ask_solids:expr) => {
        $(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
            graze_tolerance=None, solver=None, tolerance=None, ignore_start_overlaps=false),
            text_signature = "(moving, fixed, direction, *, moving_pose=None, fixed_pose=None, \
            graze_tolerance=None, solver='auto', tolerance=None, ignore_start_overlaps=False)")]
        #[expect(clippy::too_many_arguments, reason = "they are keywords")]
        pub(crate) fn $name<'py>(
            py: Python<'py>,
            moving: &Bound<'py, PyAny>,
            fixed: &Bound<'py, PyAny>,
            direction: &Bound<'py, PyAny>,
            moving_pose: Option<&Bound<'py, PyAny>>,
            fixed_pose: Option<&Bound<'py, PyAny>>,
            graze_tolerance: Option<f64>,
            solver: Option<&Bound<'py, PyString>>,
            tolerance: Option<f64>,
            ignore_start_overlaps: bool,
        ) -> PyResult<Bound<'py, PyAny>> {
            let poses = [moving_pose, fixed_pose];
            if let (Ok(moving), Ok(fixed)) = (moving.cast(), fixed.cast()) {
                if tolerance.is_some() || ignore_start_overlaps {
                    return Err(error("QueryError", FOR_SOLIDS));
                }
                let graze_tolerance = graze_tolerance.unwrap_or_default();
                let arguments =
                    Arguments { moving, fixed, direction, poses, graze_tolerance, solver };
                return $ask(py, Query::new(arguments)?);
            }
            if graze_tolerance.is_some() {
                return Err(error("QueryError", FOR_CONVEX));
            }
            solver_called(solver)?;
            let query = SolidCast::new(
                py,
                moving,
                fixed,
                direction,
                moving_pose,
                fixed_pose,
                tolerance,
                ignore_start_overlaps,
            )?;
            $ask_solids(&Bound::new(py, query)?)
        }
    };
}

const FOR_SOLIDS: &str =
    "tolerance and ignore_start_overlaps are for solids; convex bodies have graze_tolerance";
const FOR_CONVEX: &str = "graze_tolerance is for convex bodies; solids have tolerance";

question! {
    /// At which translation along a direction do two bodies first meet?
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
    /// solver : {"auto", "cta", "portal"}
    ///     How the search is narrowed. Answers and certificates are the same.
    ///
    /// Returns
    /// -------
    /// Contact or Grazing or Separated
    ///     A negative translation is a contact behind, or an overlap now.
    ///
    /// Raises
    /// ------
    /// QueryError, PoseError, InputError
    ///     An argument that is refused, with its name or its value.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import Contact, ConvexPolyhedron, Separated, cast
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> match cast(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0]):
    /// ...     case Contact(translation=t, normal=n):
    /// ...         print(t, n)
    /// ...     case Separated(margin=margin):
    /// ...         print("misses by", margin)
    /// 2.0 [1. 0. 0.]
    cast => first_contact
}

question! {
    /// At which translations along a direction do two bodies first and last meet?
    ///
    /// Parameters
    /// ----------
    /// moving, fixed, direction, moving_pose, fixed_pose, graze_tolerance, solver
    ///     As for :func:`cast`.
    ///
    /// Returns
    /// -------
    /// ContactRange or Separated
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, contact_range
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> contact_range(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0]).interval
    /// (2.0, 4.0)
    contact_range => range
}

question_of_any! {
    /// How far can the moving body move from where it is, and what stops it?
    ///
    /// Contacts behind and grazing slides do not block. Bodies that touch block each other if the
    /// motion would make them overlap.
    ///
    /// Parameters
    /// ----------
    /// moving, fixed : ConvexPolyhedron or Solid
    ///     The body that moves, and the one that does not.
    /// direction, moving_pose, fixed_pose
    ///     As for :func:`cast`.
    /// graze_tolerance, solver
    ///     As for :func:`cast`; between convex bodies.
    /// tolerance, ignore_start_overlaps
    ///     As for :class:`SolidCast`; if one of the bodies is a solid.
    ///
    /// Returns
    /// -------
    /// Blocked or Slides or Behind or Separated or Overlapping
    ///     All have a ``distance``: infinite where nothing blocks, None where the bodies overlap.
    /// SolidBlocked or SolidFree or SolidOverlapping
    ///     The same, if one of the bodies is a solid.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, clearance
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> for direction in ([0, 0, -1], [1, 0, 0], [0, 0, 1]):
    /// ...     answer = clearance(cube, cube, direction, moving_pose=[0, 0, 1])
    /// ...     print(type(answer).__name__, answer.distance)
    /// Blocked 0.0
    /// Slides inf
    /// Behind inf
    clearance => clear, SolidCast::clearance
}

question! {
    /// How far must the moving body go back, against the direction, until the overlap ends?
    ///
    /// Parameters
    /// ----------
    /// moving, fixed, direction, moving_pose, fixed_pose, graze_tolerance, solver
    ///     As for :func:`cast`.
    ///
    /// Returns
    /// -------
    /// DirectionalDepth
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, directional_depth
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> round(directional_depth(cube, cube, [1, 0, 0], moving_pose=[-0.75, 0, 0]).depth, 12)
    /// 0.25
    directional_depth => depth
}

question_of_any! {
    /// Do the bodies, as closed sets and to within rounding error, meet where they are?
    ///
    /// Parameters
    /// ----------
    /// moving, fixed : ConvexPolyhedron or Solid
    /// direction, moving_pose, fixed_pose, graze_tolerance, solver, tolerance, ignore_start_overlaps
    ///     As for :func:`clearance`. The direction and the tolerances play no part.
    ///
    /// Returns
    /// -------
    /// Intersection
    ///     True or false in a condition, with the proof.
    /// bool
    ///     If one of the bodies is a solid.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, intersects
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> bool(intersects(cube, cube, [1, 0, 0], moving_pose=[0.5, 0, 0]))
    /// True
    intersects => meet, solids_meet
}
