"""Distances, depths, intersections and comparisons with a length of many pairs, as columns."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from colltrans import _colltrans
from colltrans._colltrans import Depth, Distance, Intersection, OverlapDepth, Within
from colltrans.queries import AnyBodies, Floats, Poses, column, queries_of
from colltrans.table import Answer_co, Table, middle


@dataclass(frozen=True, eq=False, repr=False)
class PairColumns(Table[Answer_co]):
    """Answers about bodies at fixed poses, as columns; see :class:`Table`.

    Attributes
    ----------
    lower, upper : ndarray of shape (N,)
        Proven lower and upper bounds of the distance or the depth, lengths.
    """

    lower: Floats
    upper: Floats

    @property
    def value(self) -> Floats:
        """ndarray of shape (N,): The middle of both bounds."""
        return middle(self.lower, self.upper)


@dataclass(frozen=True, eq=False, repr=False)
class DistanceColumns(PairColumns[Distance]):
    """The answers of :func:`distance_many`; see :class:`PairColumns`.

    Attributes
    ----------
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the moving body to the fixed one.
    on_moving, on_fixed : ndarray of shape (N, 3)
        The nearest points of both bodies, in the world.
    """

    normal: Floats
    on_moving: Floats
    on_fixed: Floats

    _question, _name = staticmethod(_colltrans.distance), "distance"


@dataclass(frozen=True, eq=False, repr=False)
class DepthColumns(PairColumns[Depth | OverlapDepth]):
    """The answers of :func:`depth_many`; see :class:`PairColumns`.

    Attributes
    ----------
    least_tolerance : ndarray of shape (N,)
        For solids that overlap: the smallest tolerance without an overlap, a length.
    direction : ndarray of shape (N, 3)
        For convex bodies that overlap or touch: unit vectors, in the world, along which the moving
        body leaves.
    """

    least_tolerance: Floats
    direction: Floats

    _question, _name = staticmethod(_colltrans.depth), "depth"

    def _is_row(self, answer: Any, i: int) -> bool:
        found = (answer.lower, answer.upper, answer.to_dict()["outcome"])
        return found == (self.lower[i], self.upper[i], self.outcome[i])


@dataclass(frozen=True, eq=False, repr=False)
class WithinColumns(PairColumns[Within]):
    """The answers of :func:`within_many`; see :class:`PairColumns`.

    Attributes
    ----------
    normal : ndarray of shape (N, 3)
        For convex bodies that are farther apart, and for undecided rows: unit normals, in the
        world, from the moving body to the fixed one.
    on_moving, on_fixed : ndarray of shape (N, 3)
        For bodies that are closer, and for undecided rows: points of both bodies at the distance
        ``upper``, in the world.
    """

    normal: Floats
    on_moving: Floats
    on_fixed: Floats

    _question, _name = staticmethod(_colltrans.within), "within"


@dataclass(frozen=True, eq=False, repr=False)
class IntersectsColumns(Table[Intersection | bool]):
    """The answers of :func:`intersects_many`, in ``outcome``; see :class:`Table`."""

    _question, _name = staticmethod(_colltrans.intersects), "intersects"

    @property
    def meets(self) -> NDArray[np.bool_]:
        """ndarray of bool, shape (N,): Whether the bodies of each row meet."""
        return self.where("meeting")

    def _is_row(self, answer: Any, i: int) -> bool:
        return bool(answer) == bool(self.outcome[i] == "meeting")


def distance_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    features: bool = False,
    threads: int | None = None,
) -> DistanceColumns:
    """Runs :func:`distance` for every row.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron, Solid or sequence of them
        See :func:`cast_many`. If a body of a row is a solid, both are treated as solids.
    moving_pose, fixed_pose, moving_index, fixed_index, features, threads
        See :func:`cast_many`.

    Returns
    -------
    DistanceColumns

    Examples
    --------
    >>> import numpy as np
    >>> from colltrans import ConvexPolyhedron, distance_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> starts = np.array([[-3, 0.5, 0], [-4, 0.25, 0.5], [0.3, 0.2, 0.1], [np.nan, 0, 0]])
    >>> columns = distance_many(cube, cube, moving_pose=starts)
    >>> columns
    DistanceColumns(4 rows: 2 apart, 1 meeting, 1 error)
    >>> columns.upper.round(9)
    array([ 2.,  3.,  0., nan])
    >>> columns[1].features.moving.kind
    'face'
    """
    poses, indices = (moving_pose, fixed_pose), (moving_index, fixed_index)
    queries = queries_of((moving, fixed), poses, indices, {})
    return DistanceColumns._ask(queries, features, threads)


def depth_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    threads: int | None = None,
) -> DepthColumns:
    """Runs :func:`depth` for every row.

    Parameters
    ----------
    moving, fixed, moving_pose, fixed_pose, moving_index, fixed_index, threads
        See :func:`distance_many`.

    Returns
    -------
    DepthColumns

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, depth_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> columns = depth_many(cube, cube, moving_pose=[[0.75, 0, 0], [3, 0, 0]])
    >>> columns.upper.round(9), columns.counts()
    (array([0.25, 0.  ]), {'overlapping': 1, 'apart': 1})
    """
    poses, indices = (moving_pose, fixed_pose), (moving_index, fixed_index)
    queries = queries_of((moving, fixed), poses, indices, {})
    return DepthColumns._ask(queries, False, threads)


def within_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    length: ArrayLike,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    threads: int | None = None,
) -> WithinColumns:
    """Runs :func:`within` for every row.

    Parameters
    ----------
    moving, fixed, moving_pose, fixed_pose, moving_index, fixed_index, threads
        See :func:`distance_many`.
    length : float or array_like of shape (N,)
        A length, not negative, in the unit of the bodies. A row with a negative length is an error.

    Returns
    -------
    WithinColumns

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, within_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> columns = within_many(cube, cube, 2.5, moving_pose=[[-3, 0.5, 0], [-4, 0.5, 0]])
    >>> columns.where("closer")
    array([ True, False])
    """
    poses, indices = (moving_pose, fixed_pose), (moving_index, fixed_index)
    queries = queries_of((moving, fixed), poses, indices, {"length": column(length, "length")})
    return WithinColumns._ask(queries, False, threads)


def intersects_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    threads: int | None = None,
) -> IntersectsColumns:
    """Runs :func:`intersects` for every row.

    Parameters
    ----------
    moving, fixed, moving_pose, fixed_pose, moving_index, fixed_index, threads
        See :func:`distance_many`.

    Returns
    -------
    IntersectsColumns

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, intersects_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> columns = intersects_many(cube, cube, moving_pose=[[0.5, 0, 0], [3, 0, 0]])
    >>> columns
    IntersectsColumns(2 rows: 1 meeting, 1 apart)
    >>> columns.meets
    array([ True, False])
    """
    poses, indices = (moving_pose, fixed_pose), (moving_index, fixed_index)
    queries = queries_of((moving, fixed), poses, indices, {})
    return IntersectsColumns._ask(queries, False, threads)
