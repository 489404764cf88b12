"""All directions along which bodies leave each other, in bulk; columns out."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from colltrans._colltrans import FreeDirections, free_directions
from colltrans.columns import Table
from colltrans.outcomes import Outcomes
from colltrans.pairs import PairQueries, pair_queries
from colltrans.queries import AnyBodies, Floats, Poses, Shape, checked_threads, row_of
from colltrans.solids import answer_rows, check_bodies

OUTCOMES = ("free", "blocked", "undecided", "error")


@dataclass(frozen=True)
class FreeQueries:
    """What was asked: bodies where they are, and choices that are one for all rows."""

    pairs: PairQueries
    choices: dict[str, Any]

    @property
    def shape(self) -> Shape:
        return self.pairs.shape

    def ask(self, question: Any, i: int) -> Any:
        """One of them, alone."""
        moving, fixed, places = self.pairs.placed(i)
        # NaN stands for none.
        found = np.nan if self.pairs.number is None else float(row_of(self.pairs.number, i)[0])
        tolerance = None if np.isnan(found) else found
        return question(moving, fixed, **places, **self.choices, tolerance=tolerance)


@dataclass(frozen=True, eq=False, repr=False)
class FreeColumns(Table[FreeDirections]):
    """The answers of :func:`free_directions_many`; see :class:`Table`.

    Attributes
    ----------
    free_lower, free_upper : ndarray of shape (N,)
        Proven bounds of the share of all directions that is free, without what is undecided.
    undecided : ndarray of shape (N,)
        At most this share of all directions is not known.
    regions, arcs, points : ndarray of shape (N,)
        How many there are: connected regions, and arcs and single directions with no region beside.
    direction : ndarray of shape (N, 3)
        A direction in the largest region, nearly the farthest from its border, where there is one.
    """

    free_lower: Floats
    free_upper: Floats
    undecided: Floats
    regions: Floats
    arcs: Floats
    points: Floats
    direction: Floats

    _question = staticmethod(free_directions)

    def _is_row(self, answer: Any, i: int) -> bool:
        if answer is None:
            return False
        bounds = (self.free_lower[i], self.free_upper[i])
        return bool(self.outcome[i] == answer.outcome and bounds == answer.free_share)


def free_directions_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
    depth: int = 26,
    looks: int = 20_000_000,
    threads: int | None = None,
) -> FreeColumns:
    """:func:`free_directions` for every row.

    Parameters
    ----------
    moving, fixed, moving_pose, fixed_pose, moving_index, fixed_index, threads
        As for :func:`distance_many`.
    tolerance : float or array_like of shape (N,), optional
        As for :func:`free_directions`.
    ignore_start_overlaps, depth, looks
        As for :func:`free_directions`, the same for all rows.

    Returns
    -------
    FreeColumns

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, free_directions_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> columns = free_directions_many(cube, cube, moving_pose=[[0, 0, 1], [1, 1, 1], [0, 0, 0.5]])
    >>> columns
    FreeColumns(3 rows: 2 free, 1 error)
    >>> bool(columns.free_lower[0] <= 0.5 <= columns.free_upper[0]), columns.direction[0].tolist()
    (True, [0.0, 0.0, 1.0])
    """
    poses, indices = (moving_pose, fixed_pose), (moving_index, fixed_index)
    tolerances = {} if tolerance is None else {"tolerance": tolerance}
    asked = FreeQueries(
        pair_queries((moving, fixed), poses, indices, tolerances),
        {"ignore_start_overlaps": ignore_start_overlaps, "depth": depth, "looks": looks},
    )
    return _answered(asked, checked_threads(threads))


def _answered(asked: FreeQueries, threads: int | None) -> FreeColumns:
    n = int(np.prod(asked.shape))
    names = ("free_lower", "free_upper", "undecided", "regions", "arcs", "points")
    columns = FreeColumns(
        outcome=Outcomes(np.full(n, OUTCOMES.index("error"), np.uint8), OUTCOMES),
        outcomes=OUTCOMES,
        errors={},
        _queries=asked,
        direction=np.full((n, 3), np.nan),
        **{name: np.full(n, np.nan) for name in names},
    )
    numbers = [getattr(columns, name) for name in names]

    def answer(i: int) -> None:
        check_bodies(asked.pairs.bodies, asked.pairs.indices, i)
        found = asked.ask(free_directions, i)
        counts = map(len, (found.regions, found.arcs, found.points))
        values = (*found.free_share, found.undecided_share, *counts)
        for place, value in zip(numbers, values, strict=True):
            place[i] = value
        if found.regions:
            columns.direction[i] = found.regions[0]["center"]
        columns.outcome.codes[i] = OUTCOMES.index(found.outcome)

    columns.errors.update(answer_rows(n, answer, threads))
    return columns
