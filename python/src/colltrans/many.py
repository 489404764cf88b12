"""Bulk queries: arrays in, columns out.

An argument has one row for all queries, or one row for each. Arguments with more axes are broadcast
like arrays of numpy, and ``columns.stacked`` restores the axes. Bodies are one for all, or a list
with an index for each row. Rows are answered on all cores, without the interpreter's lock. A row
without an answer has the outcome ``"error"`` and a message.

The notes of :func:`cast_many` explain on what the answer of a row may depend.
"""

from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from colltrans._colltrans import Solid
from colltrans.errors import InputError
from colltrans.queries import (
    AnyBodies,
    Bodies,
    Poses,
    Queries,
    Solver,
    column,
    has_solid,
    queries_of,
    refuse_solids,
    table,
)
from colltrans.solids import SolidColumns, SolidContactColumns, solid_casts
from colltrans.table import ClearanceColumns, ContactColumns, RangeColumns


@overload
def cast_many(
    moving: Bodies,
    fixed: Bodies,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    graze_tolerance: ArrayLike = 0.0,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
) -> ContactColumns: ...
@overload
def cast_many(
    moving: Solid,
    fixed: AnyBodies,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> SolidContactColumns: ...
@overload
def cast_many(
    moving: AnyBodies,
    fixed: Solid,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> SolidContactColumns: ...
@overload
def cast_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    graze_tolerance: ArrayLike = 0.0,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> ContactColumns | SolidContactColumns: ...
def cast_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    graze_tolerance: ArrayLike = 0.0,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> ContactColumns | SolidContactColumns:
    """Runs :func:`cast` for every row.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron, Solid, Placed, or sequence of them
        One body for all rows, a list with an index for each row, or a list with a body for each
        row. Placed bodies, ``body.at(pose)``, have their poses. If one body is a solid, all are
        treated as solids. An exception in the list stands for a body that could not be built; its
        rows are errors.
    direction : array_like of shape (3,) or (N, 3)
        Vectors of the world, of any length. Translations are multiples of them.
    moving_pose, fixed_pose : array_like, Pose or object with ``as_matrix()``, optional
        One pose for all rows, of shape (3,), (7,), (3, 4) or (4, 4), or one for each row, of shape
        (N, 3), (N, 7), (N, 3, 3), (N, 3, 4) or (N, 4, 4); a list of :class:`Pose`; a pair of
        positions (N, 3) and quaternions (N, 4), or a list of such pairs; a stack of rotations of
        scipy. See :class:`Pose`. An array (3, 3) is three translations, unless it is a rotation,
        which is rejected as ambiguous.
    moving_index, fixed_index : array_like of int, shape (N,), optional
        The index of the body of each row.
    graze_tolerance : float or array_like of shape (N,)
        Lateral overlaps up to this length count as grazing. With 0 the limit follows from rounding
        errors.
    min_gap : float or array_like of shape (N,)
        A minimum gap, a length. The result is then the translation at which the distance of the
        bodies first falls to it.
    tolerance, ignore_start_overlaps
        See :func:`clearance_many`; only if one of the bodies is a solid.
    solver : {"auto", "cta", "portal"} or Cta
        The search algorithm. Answers are equally accurate; the normal and the features may differ
        if vertices or parallel edges meet.
    features : bool
        Whether to add the columns ``moving_feature`` and ``fixed_feature`` of the features in
        contact.
    threads : int, optional
        Number of threads; by default all cores that this process may use. The bits do not depend on
        it.

    Returns
    -------
    ContactColumns or SolidContactColumns

    Raises
    ------
    InputError
        The shapes of arrays do not fit together. Invalid numbers in a row are errors of that row.

    Notes
    -----
    A row has the bits of :func:`cast` with the same arguments, unless many rows share both bodies
    and both rotations: 564 rows of two boxes; in general 500 plus the product of the numbers of
    vertices. Such rows are answered with the faces of their Minkowski difference. These are built
    once, for at most 256 such groups of rows. If all rows of a group also share the direction, a
    map of the faces along it is used.

    In such groups the outcome of a row and the kind of its proof stay the same, but a translation,
    a bound or a contact point may differ in its last digits. Between separated bodies the normal is
    another separating one, so that ``margin`` may differ by any factor: it is a proven distance
    along that normal, not the largest one. The answers depend on the set of rows, not on
    ``threads``. They do not depend on the order of the rows either, unless more than 256 groups are
    large enough.

    Rows of two flat bodies, of a rounded body, of bodies with more than 16,384 pairs of vertices,
    with ``solver="cta"`` or with ``min_gap`` always have the bits of :func:`cast`. ``columns[i]``
    has them too, because it answers row ``i`` again by itself. Its margin, bounds and point may
    differ from those of the columns.

    Examples
    --------
    >>> import numpy as np
    >>> from colltrans import ConvexPolyhedron, cast_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> starts = np.array([[-3, 0.5, 0], [-4, 0.25, 0.5], [-3, 2, 0], [np.nan, 0, 0]])
    >>> columns = cast_many(cube, cube, [1, 0, 0], moving_pose=starts)
    >>> columns
    ContactColumns(4 rows: 2 contact, 1 separated, 1 error)
    >>> columns.translation
    array([ 2.,  3., nan, nan])
    >>> columns[1].features.moving.kind
    'face'
    """
    bodies, indices = (moving, fixed), (moving_index, fixed_index)
    poses = (moving_pose, fixed_pose)
    if _are_solids(bodies, graze_tolerance, solver, tolerance, ignore_start_overlaps):
        solids = solid_casts(
            bodies, direction, poses, indices, min_gap, tolerance, ignore_start_overlaps
        )
        return SolidContactColumns._ask(solids, features, threads)
    queries = _casts(bodies, direction, poses, indices, graze_tolerance, min_gap, solver)
    return ContactColumns._ask(queries, features, threads)


def contact_range_many(
    moving: Bodies,
    fixed: Bodies,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    graze_tolerance: ArrayLike = 0.0,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
) -> RangeColumns:
    """Runs :func:`contact_range` for every row: first and last contact.

    Parameters
    ----------
    moving, fixed, direction, moving_pose, fixed_pose, moving_index, fixed_index
        See :func:`cast_many`.
    graze_tolerance, min_gap, solver, features, threads
        See :func:`cast_many`.

    Returns
    -------
    RangeColumns

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, contact_range_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> columns = contact_range_many(cube, cube, [[1, 0, 0], [2, 0, 0]], moving_pose=[-3, 0.5, 0])
    >>> columns.translation, columns.exit
    (array([2., 1.]), array([4., 2.]))
    """
    poses, indices = (moving_pose, fixed_pose), (moving_index, fixed_index)
    refuse_solids(moving, fixed)
    queries = _casts((moving, fixed), direction, poses, indices, graze_tolerance, min_gap, solver)
    return RangeColumns._ask(queries, features, threads)


@overload
def clearance_many(
    moving: Bodies,
    fixed: Bodies,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    graze_tolerance: ArrayLike = 0.0,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
) -> ClearanceColumns: ...
@overload
def clearance_many(
    moving: Solid,
    fixed: AnyBodies,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> SolidColumns: ...
@overload
def clearance_many(
    moving: AnyBodies,
    fixed: Solid,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> SolidColumns: ...
@overload
def clearance_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> ClearanceColumns | SolidColumns: ...
def clearance_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    direction: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    graze_tolerance: ArrayLike = 0.0,
    min_gap: ArrayLike = 0.0,
    solver: Solver = "auto",
    features: bool = False,
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> ClearanceColumns | SolidColumns:
    """Runs :func:`clearance` for every row: how far the body can move, and what stops it.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron, Solid or sequence of them
        See :func:`cast_many`. If one of them is a solid, all bodies are treated as solids.
    direction, moving_pose, fixed_pose, moving_index, fixed_index
        See :func:`cast_many`.
    min_gap, features, threads
        See :func:`cast_many`.
    graze_tolerance, solver
        See :func:`cast_many`; only for convex bodies.
    tolerance : float or array_like of shape (N,), optional
        See :class:`SolidCast`; only if one of the bodies is a solid.
    ignore_start_overlaps : bool
        See :class:`SolidCast`; only if one of the bodies is a solid.

    Returns
    -------
    ClearanceColumns or SolidColumns

    Raises
    ------
    InputError
        See :func:`cast_many`. Or an argument is given for the other kind of bodies.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, clearance_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> clearance_many(cube, cube, [[0, 0, -1], [1, 0, 0]], moving_pose=[0, 0, 1]).distance
    array([ 0., inf])
    >>> clearance_many(cube, cube, [0, 0, -1], moving_pose=[0, 0, 4], min_gap=[0, 0.25]).distance
    array([3.  , 2.75])
    """
    bodies, indices = (moving, fixed), (moving_index, fixed_index)
    poses = (moving_pose, fixed_pose)
    if _are_solids(bodies, graze_tolerance, solver, tolerance, ignore_start_overlaps):
        solids = solid_casts(
            bodies, direction, poses, indices, min_gap, tolerance, ignore_start_overlaps
        )
        return SolidColumns._ask(solids, features, threads)
    queries = _casts(bodies, direction, poses, indices, graze_tolerance, min_gap, solver)
    return ClearanceColumns._ask(queries, features, threads)


def _are_solids(
    bodies: tuple[AnyBodies, AnyBodies],
    graze_tolerance: ArrayLike,
    solver: Solver,
    tolerance: ArrayLike | None,
    ignore_start_overlaps: bool,
) -> bool:
    """Checks whether a body is a solid, and that no argument is for the other kind of bodies."""
    if has_solid(*bodies):
        if np.any(graze_tolerance) or solver != "auto":
            told = "graze_tolerance, solver: are for convex bodies; solids have tolerance"
            raise InputError(told)
        return True
    if tolerance is not None or ignore_start_overlaps:
        raise InputError("tolerance, ignore_start_overlaps: are for solids")
    return False


def _casts(
    bodies: tuple[AnyBodies, AnyBodies],
    direction: ArrayLike,
    poses: tuple[Poses, Poses],
    indices: tuple[ArrayLike | None, ArrayLike | None],
    graze_tolerance: ArrayLike,
    min_gap: ArrayLike,
    solver: Solver,
) -> Queries:
    tables = {
        "direction": table(direction, "direction", 3),
        "graze_tolerance": column(graze_tolerance, "graze_tolerance"),
        "min_gap": column(min_gap, "min_gap"),
    }
    return queries_of(bodies, poses, indices, tables, solver=solver)
