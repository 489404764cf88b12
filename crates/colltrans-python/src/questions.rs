//! Queries: the functions of the package, and the query methods of casts and pairs.

use colltrans::glam::DVec3;
use colltrans::solid::{SolidCast as _, SolidOptions, SolidPenetration as _};
use colltrans::{Options, QueryError, Solver};
use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::answer::Answer;
use crate::body::ConvexPolyhedron;
use crate::certificate::{Certificate, Separation, SolidCertificate};
use crate::common_part::CommonPart;
use crate::distance::{depth_of, distance_of, within_of};
use crate::errors::{OrRaise, error};
use crate::pair::Pair;
use crate::placed::Placed;
use crate::query::{Arguments, Cast};
use crate::solid::Piece;
use crate::solid_answer::SolidOverlapping;
use crate::solid_cast::{SolidCast, run_patiently};
use crate::solver::options_of;

/// Runs a query and converts its answer to a Python object.
fn run_query<'py, A: Answer<Query = Cast>>(
    query: &Bound<'py, Cast>,
    question: impl FnOnce(&colltrans::Cast<'_>) -> Result<A, QueryError> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    query.get().ask(query.py(), question)?.object(query)
}

#[pymethods]
impl Cast {
    /// Computes the translation at which the bodies first meet; see :func:`cast`.
    #[pyo3(name = "cast")]
    fn first_contact<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        run_query(slf, |cast| cast.first_contact())
    }

    /// Computes the translations at which the bodies first and last meet; see :func:`contact_range`.
    fn contact_range<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        run_query(slf, |cast| cast.contact_range())
    }

    /// Computes how far the moving body can move from its pose; see :func:`clearance`.
    fn clearance<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        run_query(slf, |cast| cast.clearance())
    }

    /// Computes how far the moving body must go back until the overlap ends; see :func:`directional_depth`.
    fn directional_depth<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        run_query(slf, |cast| cast.directional_depth())
    }

    /// Checks whether the bodies meet at their poses; see :func:`intersects`.
    fn intersects<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        run_query(slf, |cast| cast.intersects())
    }

    /// Checks a proof with the two bodies alone, without a search.
    ///
    /// Parameters
    /// ----------
    /// proof : Certificate or Separation
    ///
    /// Returns
    /// -------
    /// float
    ///     The proven gap, in multiples of the direction, or the proven margin, a length.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    fn verify(slf: &Bound<'_, Self>, proof: &Bound<'_, PyAny>) -> PyResult<f64> {
        if let Ok(separation) = proof.cast::<Separation>() {
            return separation.get().verify(Some(slf));
        }
        proof.cast::<Certificate>()?.get().verify(Some(slf))
    }
}

#[pymethods]
impl Pair {
    /// Computes the distance of the bodies and their nearest points; see :func:`distance`.
    fn distance<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        distance_of(slf)
    }

    /// Computes the depth of the overlap; see :func:`depth`.
    fn depth<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        depth_of(slf)
    }

    /// Computes how much of the bodies overlaps, and proves it. Convex bodies are treated as solids.
    ///
    /// Parameters
    /// ----------
    /// accuracy : float
    ///     Difference of the bounds of the volume at which the search ends, as a share of the lower one. It also ends
    ///     after a limited amount of work.
    ///
    /// Returns
    /// -------
    /// CommonPart
    ///
    /// Raises
    /// ------
    /// CaseError
    ///     There is no proof, for example because a body is rounded.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, Pair
    /// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    /// >>> common = Pair(cube, cube, moving_pose=[0.5, 0, 0]).common_part()
    /// >>> common.relation, common.volume[0] <= 0.5 <= common.volume[1]
    /// ('crossing', True)
    /// >>> common.verify()
    #[pyo3(signature = (*, accuracy=0.01))]
    fn common_part(slf: &Bound<'_, Self>, accuracy: f64) -> PyResult<CommonPart> {
        CommonPart::of_pair(slf, accuracy)
    }

    /// Computes the distance of the surfaces of both bodies, also if one lies inside the other: the thickness of the
    /// wall between them.
    ///
    /// Of a solid from overlapping pieces, facets within the solid count as surface.
    ///
    /// Returns
    /// -------
    /// tuple of (float, float)
    ///     Proven lower and upper bound. Both are 0 if the surfaces have a common point.
    ///
    /// Raises
    /// ------
    /// QueryError
    ///     A body is rounded.
    ///
    /// Examples
    /// --------
    /// >>> from colltrans import ConvexPolyhedron, Pair
    /// >>> outer = ConvexPolyhedron.cuboid([0, 0, 0], [8, 8, 8])
    /// >>> inner = ConvexPolyhedron.cuboid([3, 3, 3], [4, 6, 4])
    /// >>> lower, upper = Pair(inner, outer).surface_distance()
    /// >>> lower <= 2 <= upper, Pair(inner, outer).distance().upper
    /// (True, 0.0)
    fn surface_distance(slf: &Bound<'_, Self>) -> PyResult<(f64, f64)> {
        let query = slf.clone().unbind();
        run_patiently(slf.py(), &slf.get().bodies, move || {
            let found = query.get().solids()?.surface_distance().or_raise()?;
            Ok((found.lower, found.upper))
        })
    }

    /// Checks whether the bodies meet; see :func:`intersects`.
    fn intersects<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        intersects_of(slf)
    }

    /// Checks whether the bodies are closer than a length; see :func:`within`.
    fn within<'py>(slf: &Bound<'py, Self>, length: f64) -> PyResult<Bound<'py, PyAny>> {
        within_of(slf, length)
    }
}

/// These methods run without the interpreter's lock.
#[pymethods]
impl SolidCast {
    /// Computes the translation at which the bodies first meet; see :func:`cast`.
    #[pyo3(name = "cast")]
    fn first_contact<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::ask(slf, |cast| cast.first_contact())?.or_raise()?.object(slf)
    }

    /// Computes how far the moving body can move from its pose, and what stops it.
    ///
    /// Returns
    /// -------
    /// SolidBlocked or SolidFree or SolidOverlapping
    fn clearance<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::ask(slf, |cast| cast.clearance())?.or_raise()?.object(slf)
    }

    /// Computes the clearance with a proof that :meth:`verify` checks.
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

    /// Checks a proof with the two bodies alone, without a search.
    ///
    /// Parameters
    /// ----------
    /// proof : SolidCertificate
    ///
    /// Returns
    /// -------
    /// float
    ///     The distance minus its proven lower bound, in multiples of the direction; 0 if nothing blocks or the
    ///     bodies overlap.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    fn verify(slf: &Bound<'_, Self>, proof: &Bound<'_, SolidCertificate>) -> PyResult<f64> {
        let proof = proof.clone().unbind();
        Self::ask(slf, move |cast| cast.verify(&proof.get().0))?.or_raise()
    }

    /// Checks whether the nominal bodies, as closed sets, have a common point, exactly.
    ///
    /// With a minimum gap the answer is also True if the distance of two facets is certainly at most the gap.
    fn intersects(slf: &Bound<'_, Self>) -> PyResult<bool> {
        Ok(Self::ask(slf, |cast| cast.intersects())?.or_raise()?.meets)
    }

    /// Computes the smallest tolerance at which the bodies do not overlap.
    ///
    /// The result is rounded up. It is 0 if the nominal bodies do not overlap. It is None if a body vanishes before
    /// the overlap ends, or if overlapping bodies have open shells.
    fn least_tolerance(slf: &Bound<'_, Self>) -> PyResult<Option<f64>> {
        Self::ask(slf, |cast| cast.least_tolerance())
    }

    /// Finds a place where the bodies, shrunk by half the tolerance, overlap; None if they do not.
    ///
    /// This is the overlap that an answer with ``ignore_start_overlaps`` ignores. The result also has the
    /// smallest tolerance without an overlap.
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

    /// Estimates the last translation at which the nominal bodies meet, in multiples of the direction.
    ///
    /// It is 0 if the last contact is behind, and None if the bodies never meet along the direction. With a minimum
    /// gap, bodies within the gap count as meeting. Proven bounds are in ``exit_bounds``.
    fn exit(slf: &Bound<'_, Self>) -> PyResult<Option<f64>> {
        Self::ask(slf, |cast| cast.exit().map(|exit| exit.value))
    }

    /// Computes proven bounds of ``exit``: the bodies do not meet beyond the second one. None if the bodies never
    /// meet along the direction.
    fn exit_bounds(slf: &Bound<'_, Self>) -> PyResult<Option<(f64, f64)>> {
        Self::ask(slf, |cast| cast.exit().map(|exit| exit.bounds().into()))
    }
}

/// Checks whether the bodies of a pair meet.
fn intersects_of<'py>(pair: &Bound<'py, Pair>) -> PyResult<Bound<'py, PyAny>> {
    let (py, Pair { bodies, poses }) = (pair.py(), pair.get());
    // The answers do not depend on the direction.
    if let [Piece::Convex(moving), Piece::Convex(fixed)] = bodies {
        let (moving, fixed) = (moving.clone_ref(py), fixed.clone_ref(py));
        let (direction, options) = (DVec3::X, Options::default());
        let query = Cast { moving, fixed, poses: *poses, direction, options };
        return run_query(&Bound::new(py, query)?, |cast| cast.intersects());
    }
    let bodies = [bodies[0].copy(py), bodies[1].copy(py)];
    let (direction, options) = (DVec3::X, SolidOptions::default());
    let query = Bound::new(py, SolidCast { bodies, poses: *poses, direction, options })?;
    Ok(PyBool::new(py, SolidCast::intersects(&query)?).to_owned().into_any())
}

/// Defines a function for one question of convex bodies.
macro_rules! question {
    ($(#[$doc:meta])* $name:ident => $ask:ident) => {
        $(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
            graze_tolerance=0.0, min_gap=0.0, solver=None), text_signature = "(moving, fixed, \
            direction, *, moving_pose=None, fixed_pose=None, graze_tolerance=0.0, min_gap=0.0, \
            solver='auto')")]
        #[expect(clippy::too_many_arguments, reason = "they are keywords")]
        pub(crate) fn $name<'py>(
            py: Python<'py>,
            moving: &Bound<'py, PyAny>,
            fixed: &Bound<'py, PyAny>,
            direction: &Bound<'py, PyAny>,
            moving_pose: Option<&Bound<'py, PyAny>>,
            fixed_pose: Option<&Bound<'py, PyAny>>,
            graze_tolerance: f64,
            min_gap: f64,
            solver: Option<&Bound<'py, PyAny>>,
        ) -> PyResult<Bound<'py, PyAny>> {
            let poses = [moving_pose, fixed_pose];
            let asked =
                Arguments { moving, fixed, direction, poses, graze_tolerance, min_gap, solver };
            run_query(&Bound::new(py, Cast::from_arguments(asked)?)?, |cast| cast.$ask())
        }
    };
}

/// Checks whether an argument is a convex body, placed or not.
fn is_convex(given: &Bound<'_, PyAny>) -> bool {
    given.is_instance_of::<ConvexPolyhedron>()
        || given.cast::<Placed>().is_ok_and(|placed| matches!(placed.get().body, Piece::Convex(_)))
}

/// Defines a function for one question of bodies of both kinds.
macro_rules! question_of_any {
    ($(#[$doc:meta])* $name:ident => $ask:ident, $ask_solids:path) => {
        $(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
            graze_tolerance=None, min_gap=0.0, solver=None, tolerance=None,
            ignore_start_overlaps=false), text_signature = "(moving, fixed, direction, *, \
            moving_pose=None, fixed_pose=None, graze_tolerance=None, min_gap=0.0, solver='auto', \
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
            min_gap: f64,
            solver: Option<&Bound<'py, PyAny>>,
            tolerance: Option<f64>,
            ignore_start_overlaps: bool,
        ) -> PyResult<Bound<'py, PyAny>> {
            let poses = [moving_pose, fixed_pose];
            if is_convex(moving) && is_convex(fixed) {
                if tolerance.is_some() || ignore_start_overlaps {
                    return Err(error("QueryError", FOR_SOLIDS));
                }
                let graze_tolerance = graze_tolerance.unwrap_or_default();
                let asked =
                    Arguments { moving, fixed, direction, poses, graze_tolerance, min_gap, solver };
                return run_query(&Bound::new(py, Cast::from_arguments(asked)?)?, |cast| cast.$ask());
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
                min_gap,
                ignore_start_overlaps,
            )?;
            $ask_solids(&Bound::new(py, query)?)
        }
    };
}

const FOR_SOLIDS: &str =
    "tolerance and ignore_start_overlaps are for solids; convex bodies have graze_tolerance";
const FOR_CONVEX: &str = "graze_tolerance and solver are for convex bodies; solids have tolerance";

question_of_any! {
    /// Computes the translation along a direction at which two bodies first meet.
    ///
    /// Parameters
    /// ----------
    /// moving, fixed : ConvexPolyhedron, Solid or Placed
    ///     The moving and the fixed body. If one of them is a solid, both are treated as solids.
    /// direction : array_like of shape (3,)
    ///     A vector of the world, of any length. Translations are multiples of it.
    /// moving_pose, fixed_pose : array_like or Pose, optional
    ///     Poses of the bodies in the world; see :class:`Pose`. A body may be given with its pose, as
    ///     ``body.at(pose)``.
    /// graze_tolerance : float
    ///     For convex bodies: lateral overlaps up to this length count as grazing. With 0 the limit follows
    ///     from rounding errors.
    /// min_gap : float
    ///     A minimum gap, a length. With a gap the result is the translation at which the distance of the
    ///     bodies first falls to it.
    /// solver : {"auto", "cta", "portal"} or Cta
    ///     The search algorithm for convex bodies. Answers are equally accurate; the normal and the features may
    ///     differ if vertices or parallel edges meet.
    /// tolerance, ignore_start_overlaps
    ///     See :class:`SolidCast`; only if one of the bodies is a solid. The second one has no effect here.
    ///
    /// Returns
    /// -------
    /// Contact or Grazing or Separated
    ///     If the translation is negative, the contact is behind the body, or the bodies overlap at the
    ///     start.
    /// SolidContact or SolidFree
    ///     The corresponding answers if one of the bodies is a solid. Solids do not graze.
    ///
    /// Raises
    /// ------
    /// QueryError, PoseError, InputError
    ///     An argument is rejected; the message has its name or its value.
    /// NotConvergedError
    ///     The search ended without an answer.
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
    cast => first_contact, SolidCast::first_contact
}

question! {
    /// Computes the translations along a direction at which two bodies first and last meet.
    ///
    /// Parameters
    /// ----------
    /// moving, fixed, direction, moving_pose, fixed_pose, graze_tolerance, min_gap, solver
    ///     See :func:`cast`.
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
    /// Computes how far the moving body can move from its pose, and what stops it.
    ///
    /// Contacts behind the body and grazing contacts do not block. Touching bodies block each other if the
    /// motion would make them overlap.
    ///
    /// Parameters
    /// ----------
    /// moving, fixed : ConvexPolyhedron or Solid
    ///     The moving and the fixed body.
    /// direction, moving_pose, fixed_pose
    ///     See :func:`cast`.
    /// min_gap : float
    ///     A minimum gap, a length. The body stops when the distance falls to it. Bodies that are closer at
    ///     the start count as overlapping.
    /// graze_tolerance, solver
    ///     See :func:`cast`; only for convex bodies.
    /// tolerance, ignore_start_overlaps
    ///     See :class:`SolidCast`; only if one of the bodies is a solid.
    ///
    /// Returns
    /// -------
    /// Blocked or Slides or Behind or Separated or Overlapping
    ///     All have a ``distance``: infinite if nothing blocks, None if the bodies overlap.
    /// SolidBlocked or SolidFree or SolidOverlapping
    ///     The corresponding answers if one of the bodies is a solid.
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
    /// >>> round(clearance(cube, cube, [0, 0, -1], moving_pose=[0, 0, 4], min_gap=0.25).distance, 9)
    /// 2.75
    clearance => clearance, SolidCast::clearance
}

question! {
    /// Computes how far the moving body must go back, against the direction, until the overlap ends.
    ///
    /// Parameters
    /// ----------
    /// moving, fixed, direction, moving_pose, fixed_pose, graze_tolerance, min_gap, solver
    ///     See :func:`cast`.
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

/// Checks whether two bodies, as closed sets, meet at fixed poses.
///
/// The answer is exact for solids, and up to rounding error for convex bodies.
///
/// Parameters
/// ----------
/// moving, fixed, moving_pose, fixed_pose
///     See :func:`distance`.
///
/// Returns
/// -------
/// Intersection
///     Converts to a bool, and has the proof.
/// bool
///     The result if one of the bodies is a solid.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, intersects
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> bool(intersects(cube, cube, moving_pose=[0.5, 0, 0]))
/// True
#[pyfunction]
#[pyo3(signature = (moving, fixed, *, moving_pose=None, fixed_pose=None))]
pub(crate) fn intersects<'py>(
    py: Python<'py>,
    moving: &Bound<'py, PyAny>,
    fixed: &Bound<'py, PyAny>,
    moving_pose: Option<&Bound<'py, PyAny>>,
    fixed_pose: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    intersects_of(&Bound::new(py, Pair::from_arguments(moving, fixed, [moving_pose, fixed_pose])?)?)
}

/// Computes the distance of two bodies at fixed poses, and their nearest points.
///
/// The bounds hold exactly at any distance: ``lower <= true distance <= upper``. They differ by a few
/// rounding errors.
///
/// Parameters
/// ----------
/// moving, fixed : ConvexPolyhedron or Solid
///     Neither body moves; the names only distinguish them. If one of them is a solid, both are treated as
///     solids.
/// moving_pose, fixed_pose : array_like or Pose, optional
///     Poses of the bodies in the world; see :class:`Pose`.
///
/// Returns
/// -------
/// Distance
///
/// Raises
/// ------
/// PoseError, InputError, BuildError
///     An argument is rejected.
/// NotConvergedError
///     The search ended without an answer.
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
    distance_of(&Bound::new(py, Pair::from_arguments(moving, fixed, [moving_pose, fixed_pose])?)?)
}

/// Computes how deep two bodies overlap: the shortest translation, over all directions, that separates them.
///
/// Parameters
/// ----------
/// moving, fixed, moving_pose, fixed_pose
///     See :func:`distance`.
///
/// Returns
/// -------
/// Depth or OverlapDepth
///     Solids have an OverlapDepth, which also has the smallest tolerance at which they would not overlap.
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
    depth_of(&Bound::new(py, Pair::from_arguments(moving, fixed, [moving_pose, fixed_pose])?)?)
}

/// Checks whether two bodies at fixed poses are closer than a length. The search ends when the comparison is
/// decided.
///
/// Parameters
/// ----------
/// moving, fixed, moving_pose, fixed_pose
///     See :func:`distance`.
/// length : float
///     A length, not negative, in the unit of the bodies.
///
/// Returns
/// -------
/// Within
///
/// Raises
/// ------
/// QueryError
///     The length is negative or not a number.
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
    within_of(
        &Bound::new(py, Pair::from_arguments(moving, fixed, [moving_pose, fixed_pose])?)?,
        length,
    )
}
