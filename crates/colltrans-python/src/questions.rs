//! Questions: the functions of the package, and the methods of queries that ask.

use colltrans::solid::SolidCast as _;
use colltrans::{QueryError, Solver};
use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::answer::Answer;
use crate::certificate::{Certificate, Separation, SolidCertificate};
use crate::distance::{depth_of, distance_of, within_of};
use crate::errors::{OrRaise, error};
use crate::pair::Pair;
use crate::query::{Arguments, Cast};
use crate::solid::ConvexArgument;
use crate::solid_answer::SolidOverlapping;
use crate::solid_cast::SolidCast;
use crate::solver::options_of;

/// The answer as Python has it.
fn answered<'py, A: Answer<Query = Cast>>(
    query: &Bound<'py, Cast>,
    question: impl FnOnce(&colltrans::Cast<'_>) -> Result<A, QueryError> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    query.get().ask(query.py(), question)?.object(query)
}

#[pymethods]
impl Cast {
    /// At which translation do the bodies first meet? See :func:`cast`.
    fn first_contact<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        answered(slf, |cast| cast.first_contact())
    }

    /// At which translations do they first and last meet? See :func:`contact_range`.
    fn contact_range<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        answered(slf, |cast| cast.contact_range())
    }

    /// How far can the moving body move from where it is? See :func:`clearance`.
    fn clearance<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        answered(slf, |cast| cast.clearance())
    }

    /// How far must it go back until the overlap ends? See :func:`directional_depth`.
    fn directional_depth<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        answered(slf, |cast| cast.directional_depth())
    }

    /// Do the bodies meet where they are? See :func:`intersects`.
    fn intersects<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        answered(slf, |cast| cast.intersects())
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
    fn verify(slf: &Bound<'_, Self>, proof: &Bound<'_, PyAny>) -> PyResult<f64> {
        if let Ok(separation) = proof.cast::<Separation>() {
            return separation.get().verify(Some(slf));
        }
        proof.cast::<Certificate>()?.get().verify(Some(slf))
    }
}

#[pymethods]
impl Pair {
    /// How far apart are the bodies, and where? See :func:`distance`.
    fn distance<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        distance_of(slf)
    }

    /// How deep do they overlap? See :func:`depth`.
    fn depth<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        depth_of(slf)
    }

    /// Are they closer than a length? See :func:`within`.
    fn within<'py>(slf: &Bound<'py, Self>, length: f64) -> PyResult<Bound<'py, PyAny>> {
        within_of(slf, length)
    }
}

/// They run without the interpreter's lock.
#[pymethods]
impl SolidCast {
    /// How far can the moving body move from where it is, and what stops it?
    ///
    /// Returns
    /// -------
    /// SolidBlocked or SolidFree or SolidOverlapping
    fn clearance<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::ask(slf, |cast| cast.clearance())?.or_raise()?.object(slf)
    }

    /// The clearance, with a proof that :meth:`verify` checks.
    ///
    /// Returns
    /// -------
    /// tuple of (SolidBlocked or SolidFree or SolidOverlapping, SolidCertificate)
    fn certified_clearance<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, SolidCertificate)> {
        let (answer, proof) = Self::ask(slf, |cast| cast.certified_clearance())?.or_raise()?;
        Ok((answer.object(slf)?, SolidCertificate(proof)))
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
    fn verify(slf: &Bound<'_, Self>, proof: &Bound<'_, SolidCertificate>) -> PyResult<f64> {
        let proof = proof.clone().unbind();
        Self::ask(slf, move |cast| cast.verify(&proof.get().0))?.or_raise()
    }

    /// Whether the bodies as they are, as closed sets, have a point in common. The gap to be kept plays no
    /// part.
    fn intersects(slf: &Bound<'_, Self>) -> PyResult<bool> {
        Ok(Self::ask(slf, |cast| cast.intersects())?.or_raise()?.meets)
    }

    /// The least tolerance with which the bodies do not overlap: 0 if they do not, None if there is
    /// none up to their size.
    fn least_tolerance(slf: &Bound<'_, Self>) -> PyResult<Option<f64>> {
        Self::ask(slf, |cast| cast.least_tolerance())
    }

    /// Where the bodies, shrunk by half the tolerance, overlap, and with which tolerance they
    /// would not; None if they do not: what
    /// an answer with ``ignore_start_overlaps`` has ignored.
    ///
    /// Returns
    /// -------
    /// SolidOverlapping or None
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, SolidCast
    /// >>> table = ConvexPolyhedron.cuboid([-4, -4, -1], [4, 4, 0])
    /// >>> plate = ConvexPolyhedron.cuboid([0, 0, 0], [1, 2, 1])
    /// >>> aside = SolidCast(plate, table, [1, 0, 0], moving_pose=[0, 0, -0.125],
    /// ...                   ignore_start_overlaps=True)
    /// >>> aside.clearance()
    /// SolidFree()
    /// >>> round(aside.start_overlap().least_tolerance, 9)
    /// 0.125
    fn start_overlap(slf: &Bound<'_, Self>) -> PyResult<Option<SolidOverlapping>> {
        let found = Self::ask(slf, |cast| cast.start_overlap())?;
        Ok(found.map(|overlap| SolidOverlapping { overlap, query: slf.clone().unbind() }))
    }

    /// Where the bodies, as they are, meet last, in multiples of the direction; None if nothing faces.
    /// The best estimate: for one that is safe see ``exit_bounds``.
    fn exit(slf: &Bound<'_, Self>) -> PyResult<Option<f64>> {
        Self::ask(slf, |cast| cast.exit().map(|exit| exit.value))
    }

    /// The proven bounds of ``exit``, None if nothing faces: beyond the second they never meet again.
    fn exit_bounds(slf: &Bound<'_, Self>) -> PyResult<Option<(f64, f64)>> {
        Self::ask(slf, |cast| cast.exit().map(|exit| exit.bounds().into()))
    }
}

fn solids_meet<'py>(query: &Bound<'py, SolidCast>) -> PyResult<Bound<'py, PyAny>> {
    if query.get().options.keep != 0.0 {
        return Err(error("QueryError", "solids that keep a gap are asked by `within`"));
    }
    Ok(PyBool::new(query.py(), SolidCast::intersects(query)?).to_owned().into_any())
}

/// A function of Python that asks one question.
macro_rules! question {
    ($(#[$doc:meta])* $name:ident => $ask:ident) => {
        $(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
            graze_tolerance=0.0, keep=0.0, solver=None), text_signature = "(moving, fixed, \
            direction, *, moving_pose=None, fixed_pose=None, graze_tolerance=0.0, keep=0.0, \
            solver='auto')")]
        #[expect(clippy::too_many_arguments, reason = "they are keywords")]
        pub(crate) fn $name<'py>(
            py: Python<'py>,
            moving: ConvexArgument<'py>,
            fixed: ConvexArgument<'py>,
            direction: &Bound<'py, PyAny>,
            moving_pose: Option<&Bound<'py, PyAny>>,
            fixed_pose: Option<&Bound<'py, PyAny>>,
            graze_tolerance: f64,
            keep: f64,
            solver: Option<&Bound<'py, PyAny>>,
        ) -> PyResult<Bound<'py, PyAny>> {
            let poses = [moving_pose, fixed_pose];
            let (moving, fixed) = (&moving.0, &fixed.0);
            let asked =
                Arguments { moving, fixed, direction, poses, graze_tolerance, keep, solver };
            answered(&Bound::new(py, Cast::of(asked)?)?, |cast| cast.$ask())
        }
    };
}

/// A function of Python that asks one question of bodies of any kind.
macro_rules! question_of_any {
    ($(#[$doc:meta])* $name:ident => $ask:ident, $ask_solids:path) => {
        $(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
            graze_tolerance=None, keep=0.0, solver=None, tolerance=None,
            ignore_start_overlaps=false), text_signature = "(moving, fixed, direction, *, \
            moving_pose=None, fixed_pose=None, graze_tolerance=None, keep=0.0, solver='auto', \
            tolerance=None, ignore_start_overlaps=False)")]
        #[expect(clippy::too_many_arguments, reason = "they are keywords")]
        pub(crate) fn $name<'py>(
            py: Python<'py>,
            moving: &Bound<'py, PyAny>,
            fixed: &Bound<'py, PyAny>,
            direction: &Bound<'py, PyAny>,
            moving_pose: Option<&Bound<'py, PyAny>>,
            fixed_pose: Option<&Bound<'py, PyAny>>,
            graze_tolerance: Option<f64>,
            keep: f64,
            solver: Option<&Bound<'py, PyAny>>,
            tolerance: Option<f64>,
            ignore_start_overlaps: bool,
        ) -> PyResult<Bound<'py, PyAny>> {
            let poses = [moving_pose, fixed_pose];
            if let (Ok(moving), Ok(fixed)) = (moving.cast(), fixed.cast()) {
                if tolerance.is_some() || ignore_start_overlaps {
                    return Err(error("QueryError", FOR_SOLIDS));
                }
                let graze_tolerance = graze_tolerance.unwrap_or_default();
                let asked =
                    Arguments { moving, fixed, direction, poses, graze_tolerance, keep, solver };
                return answered(&Bound::new(py, Cast::of(asked)?)?, |cast| cast.$ask());
            }
            if graze_tolerance.is_some() || options_of(solver)?.solver != Solver::Auto {
                return Err(error("QueryError", FOR_CONVEX));
            }
            let query = SolidCast::new(
                py,
                moving,
                fixed,
                direction,
                moving_pose,
                fixed_pose,
                tolerance,
                keep,
                ignore_start_overlaps,
            )?;
            $ask_solids(&Bound::new(py, query)?)
        }
    };
}

const FOR_SOLIDS: &str =
    "tolerance and ignore_start_overlaps are for solids; convex bodies have graze_tolerance";
const FOR_CONVEX: &str = "graze_tolerance and solver are for convex bodies; solids have tolerance";

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
    /// keep : float
    ///     A gap to be kept, a length: asked is where the bodies are first as near as that, not where they
    ///     touch.
    /// solver : {"auto", "cta", "portal"} or Cta
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
    /// moving, fixed, direction, moving_pose, fixed_pose, graze_tolerance, keep, solver
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
    contact_range => contact_range
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
    /// keep : float
    ///     A gap to be kept, a length: how far until the bodies are as near as that. Bodies that are nearer at
    ///     the start overlap.
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
    /// >>> round(clearance(cube, cube, [0, 0, -1], moving_pose=[0, 0, 4], keep=0.25).distance, 9)
    /// 2.75
    clearance => clearance, SolidCast::clearance
}

question! {
    /// How far must the moving body go back, against the direction, until the overlap ends?
    ///
    /// Parameters
    /// ----------
    /// moving, fixed, direction, moving_pose, fixed_pose, graze_tolerance, keep, solver
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
    directional_depth => directional_depth
}

question_of_any! {
    /// Do the bodies, as closed sets and to within rounding error, meet where they are?
    ///
    /// Parameters
    /// ----------
    /// moving, fixed : ConvexPolyhedron or Solid
    /// direction, moving_pose, fixed_pose, graze_tolerance, solver, tolerance, ignore_start_overlaps
    ///     As for :func:`clearance`. The direction and the tolerances play no part.
    /// keep : float
    ///     Of convex bodies, a gap, a length: are they as near as that? For solids ask :func:`within`.
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
    intersects => intersects, solids_meet
}

/// How far apart are two bodies where they are, and where are they nearest?
///
/// The bounds hold exactly, however near the bodies are: ``lower <= true distance <= upper``, a few
/// roundings apart.
///
/// Parameters
/// ----------
/// moving, fixed : ConvexPolyhedron or Solid
///     Nothing moves; the names tell them apart. If one of them is a solid, both are asked as solids.
/// moving_pose, fixed_pose : array_like or Pose, optional
///     Where the bodies are; see :class:`Pose`.
///
/// Returns
/// -------
/// Distance
///
/// Raises
/// ------
/// PoseError, InputError, BuildError
///     An argument that is refused.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, distance
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> found = distance(cube, cube, fixed_pose=[4, 5, 0.25])
/// >>> found.lower <= 5 <= found.upper and found.upper - found.lower < 1e-13
/// True
/// >>> found.features.moving.kind, found.normal.round(9)
/// ('edge', array([0.6, 0.8, 0. ]))
/// >>> found.verify()
#[pyfunction]
#[pyo3(signature = (moving, fixed, *, moving_pose=None, fixed_pose=None))]
pub(crate) fn distance<'py>(
    py: Python<'py>,
    moving: &Bound<'py, PyAny>,
    fixed: &Bound<'py, PyAny>,
    moving_pose: Option<&Bound<'py, PyAny>>,
    fixed_pose: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    distance_of(&Bound::new(py, Pair::of(moving, fixed, [moving_pose, fixed_pose])?)?)
}

/// How deep do two bodies overlap: which shortest translation, over all directions, parts them?
///
/// Parameters
/// ----------
/// moving, fixed, moving_pose, fixed_pose
///     As for :func:`distance`.
///
/// Returns
/// -------
/// Depth or OverlapDepth
///     Of solids the second: the least tolerance with which they would not overlap.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, depth
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> found = depth(cube, cube, fixed_pose=[0.75, 0.5, 0.5])
/// >>> found.lower <= 0.25 <= found.upper
/// True
/// >>> found.direction
/// array([-1.,  0.,  0.])
#[pyfunction]
#[pyo3(signature = (moving, fixed, *, moving_pose=None, fixed_pose=None))]
pub(crate) fn depth<'py>(
    py: Python<'py>,
    moving: &Bound<'py, PyAny>,
    fixed: &Bound<'py, PyAny>,
    moving_pose: Option<&Bound<'py, PyAny>>,
    fixed_pose: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    depth_of(&Bound::new(py, Pair::of(moving, fixed, [moving_pose, fixed_pose])?)?)
}

/// Are two bodies closer than a length where they are? Ended as soon as that is known.
///
/// Parameters
/// ----------
/// moving, fixed, moving_pose, fixed_pose
///     As for :func:`distance`.
/// length : float
///     Not negative, in the unit of the bodies.
///
/// Returns
/// -------
/// Within
///
/// Raises
/// ------
/// QueryError
///     A length that is negative or not a number.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, within
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> within(cube, cube, 4.9, fixed_pose=[4, 5, 0.25]).closer
/// False
/// >>> within(cube, cube, 5.1, fixed_pose=[4, 5, 0.25])
/// Within(closer=True, length=5.1)
#[pyfunction]
#[pyo3(signature = (moving, fixed, length, *, moving_pose=None, fixed_pose=None))]
pub(crate) fn within<'py>(
    py: Python<'py>,
    moving: &Bound<'py, PyAny>,
    fixed: &Bound<'py, PyAny>,
    length: f64,
    moving_pose: Option<&Bound<'py, PyAny>>,
    fixed_pose: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    within_of(&Bound::new(py, Pair::of(moving, fixed, [moving_pose, fixed_pose])?)?, length)
}
