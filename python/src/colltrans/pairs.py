"""Bodies where they are, in bulk: distances, depths, comparisons with a length; columns out."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from colltrans import _colltrans
from colltrans._colltrans import Depth, Distance, OverlapDepth, Within
from colltrans.columns import Answer_co, Table
from colltrans.queries import (
    AnyBodies,
    Floats,
    Index,
    Poses,
    Shape,
    body_list,
    checked_threads,
    column,
    indices_of,
    pose_table,
    row_of,
    together,
)

PairQuestion: TypeAlias = Literal["distance", "depth", "within"]


@dataclass(frozen=True)
class PairQueries:
    """What was asked: tables with one row or as many as there are queries."""

    bodies: tuple[list[Any], list[Any]]
    indices: tuple[Index, Index]
    poses: tuple[Floats, Floats]
    #: The length of :func:`within_many`; the tolerance of :func:`free_directions_many`.
    number: Floats | None
    shape: Shape

    def ask_all(
        self, question: PairQuestion, threads: int | None, features: bool = False
    ) -> dict[str, Any]:
        (moving, fixed), (moving_index, fixed_index) = self.bodies, self.indices
        columns, outcomes, errors = _colltrans.ask_pairs(
            int(np.prod(self.shape)),
            question,
            (moving, moving_index),
            (fixed, fixed_index),
            *self.poses,
            np.zeros((1, 1)) if self.number is None else self.number,
            features,
            threads,
        )
        return {**columns, "outcomes": tuple(outcomes), "errors": errors, "_queries": self}

    def ask(self, question: Any, i: int) -> Any:
        """One of them, alone."""
        moving, fixed, places = self.placed(i)
        number = () if self.number is None else (float(row_of(self.number, i)[0]),)
        return question(moving, fixed, *number, **places)

    def placed(self, i: int) -> tuple[Any, Any, dict[str, Floats]]:
        """The bodies of a row, and where they are."""
        moving, fixed = (
            bodies[0 if index is None else index[i]]
            for bodies, index in zip(self.bodies, self.indices, strict=True)
        )
        at, to = (row_of(table, i) for table in self.poses)
        return moving, fixed, {"moving_pose": at, "fixed_pose": to}


@dataclass(frozen=True, eq=False, repr=False)
class PairColumns(Table[Answer_co]):
    """Answers about bodies where they are, as columns; see :class:`Table`.

    Attributes
    ----------
    lower, upper : ndarray of shape (N,)
        Proven bounds, lengths: at least and at most the distance, or the depth.
    """

    lower: Floats
    upper: Floats

    def _is_row(self, answer: Any, i: int) -> bool:
        if answer is None:
            return False
        told = answer.to_dict()
        found = [told.get(name, np.nan) for name in ("lower", "upper")]
        same = np.array_equal([self.lower[i], self.upper[i]], found, equal_nan=True)
        return same and self.outcome[i] == told["outcome"]


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

    _question = staticmethod(_colltrans.distance)


@dataclass(frozen=True, eq=False, repr=False)
class DepthColumns(PairColumns[Depth | OverlapDepth]):
    """The answers of :func:`depth_many`; see :class:`PairColumns`.

    Attributes
    ----------
    least_tolerance : ndarray of shape (N,)
        Of solids that overlap: the least tolerance with which they would not, a length.
    direction : ndarray of shape (N, 3)
        Of convex bodies that overlap: unit vectors, in the world, by which the moving one leaves.
    """

    least_tolerance: Floats
    direction: Floats

    _question = staticmethod(_colltrans.depth)


@dataclass(frozen=True, eq=False, repr=False)
class WithinColumns(PairColumns[Within]):
    """The answers of :func:`within_many`; see :class:`PairColumns`.

    Attributes
    ----------
    normal : ndarray of shape (N, 3)
        Of convex bodies that are farther: unit normals, in the world.
    on_moving, on_fixed : ndarray of shape (N, 3)
        Of those that are closer: points of both bodies that are ``upper`` apart, in the world.
    """

    normal: Floats
    on_moving: Floats
    on_fixed: Floats

    _question = staticmethod(_colltrans.within)


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
    """:func:`distance` for every row.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron, Solid or sequence of them
        As for :func:`cast_many`; a row of which one body is a solid is asked as solids.
    moving_pose, fixed_pose, moving_index, fixed_index, features, threads
        As for :func:`cast_many`.

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
    queries = pair_queries((moving, fixed), poses, indices)
    return DistanceColumns(**queries.ask_all("distance", checked_threads(threads), features))


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
    """:func:`depth` for every row.

    Parameters
    ----------
    moving, fixed, moving_pose, fixed_pose, moving_index, fixed_index, threads
        As for :func:`distance_many`.

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
    queries = pair_queries((moving, fixed), poses, indices)
    return DepthColumns(**queries.ask_all("depth", checked_threads(threads)))


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
    """:func:`within` for every row.

    Parameters
    ----------
    moving, fixed, moving_pose, fixed_pose, moving_index, fixed_index, threads
        As for :func:`distance_many`.
    length : float or array_like of shape (N,)
        Not negative, in the unit of the bodies. A row with another one is an error.

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
    queries = pair_queries((moving, fixed), poses, indices, {"length": length})
    return WithinColumns(**queries.ask_all("within", checked_threads(threads)))


def pair_queries(
    bodies: tuple[AnyBodies, AnyBodies],
    poses: tuple[Poses, Poses],
    indices: tuple[ArrayLike | None, ArrayLike | None],
    number: Mapping[str, ArrayLike] = MappingProxyType({}),
) -> PairQueries:
    """What is asked, checked; ``number`` is one for each row, by its name."""
    moving, moving_index = body_list(bodies[0], indices[0], "moving")
    fixed, fixed_index = body_list(bodies[1], indices[1], "fixed")
    shape, tables = together(
        {
            "moving_pose": pose_table(poses[0], "moving_pose"),
            "fixed_pose": pose_table(poses[1], "fixed_pose"),
            **{name: column(values, name) for name, values in number.items()},
            "moving_index": moving_index,
            "fixed_index": fixed_index,
        }
    )
    return PairQueries(
        bodies=(moving, fixed),
        indices=indices_of(tables, shape),
        poses=(tables["moving_pose"], tables["fixed_pose"]),
        number=next((tables[name] for name in number), None),
        shape=shape,
    )
