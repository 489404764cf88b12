//! The functions of the package: one question each.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};

use crate::answer;
use crate::body::ConvexPolyhedron;
use crate::clearance as answers;
use crate::errors::error;
use crate::query::{Arguments, Query, solver_called};
use crate::solid_cast::SolidCast;

pub(crate) fn first_contact(py: Python<'_>, query: Query) -> PyResult<Bound<'_, PyAny>> {
    let outcome = query.ask(|cast| cast.first_contact())?;
    answer::outcome(py, query, outcome)
}

pub(crate) fn range(py: Python<'_>, query: Query) -> PyResult<Bound<'_, PyAny>> {
    let range = query.ask(|cast| cast.contact_range())?;
    answer::range(py, query, range)
}

pub(crate) fn clear(py: Python<'_>, query: Query) -> PyResult<Bound<'_, PyAny>> {
    let clearance = query.ask(|cast| cast.clearance())?;
    answers::clearance(py, query, clearance)
}

pub(crate) fn depth(py: Python<'_>, query: Query) -> PyResult<Bound<'_, PyAny>> {
    let depth = query.ask(|cast| cast.directional_depth())?;
    answers::depth(py, query, depth)
}

pub(crate) fn meet(py: Python<'_>, query: Query) -> PyResult<Bound<'_, PyAny>> {
    let meeting = query.ask(|cast| cast.intersects())?;
    answers::intersection(py, query, meeting)
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
