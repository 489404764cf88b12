"""Queries about solids in bulk: threads that each ask one row after the other, columns out.

A row of solids takes so long that Python between two of them does not count. The interpreter's
lock is free while a row is answered. Every row has its own place, so the threads need no other.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from colltrans._colltrans import SolidBlocked, SolidCast, SolidFree, SolidOverlapping
from colltrans.columns import Table
from colltrans.errors import InputError
from colltrans.outcomes import Outcomes
from colltrans.queries import Floats, Index, Queries, Shape, cores, row_of

OUTCOMES = ("blocked", "free", "overlapping", "error")
#: The columns of numbers, in the order of :func:`_values`.
_NUMBERS = (
    "distance",
    "translation",
    "translation_lower",
    "translation_upper",
    "shrunk_distance",
    "shrunk_distance_lower",
    "shrunk_distance_upper",
    "least_tolerance",
)
#: Between two looks at signals, in seconds.
PATIENCE = 0.1


@dataclass(frozen=True)
class SolidQueries:
    """What was asked: the tables of all kinds of bodies, and a choice of solids."""

    queries: Queries
    ignore_start_overlaps: bool

    @property
    def shape(self) -> Shape:
        return self.queries.shape

    def ask(self, question: Any, i: int) -> Any:
        """One of them, alone."""
        tolerance = float(row_of(self.queries.tolerance, i)[0])
        choices = {
            "tolerance": None if np.isnan(tolerance) else tolerance,
            "ignore_start_overlaps": self.ignore_start_overlaps,
        }
        return question(self.queries.ask_with(SolidCast, i, **choices))


@dataclass(frozen=True, eq=False, repr=False)
class SolidColumns(Table[SolidBlocked | SolidFree | SolidOverlapping]):
    """The answers of :func:`clearance_many` about solids; see :class:`Table`.

    Attributes
    ----------
    distance : ndarray of shape (N,)
        How far the moving body may safely move, in multiples of the direction: infinite where
        nothing blocks, NaN where the bodies overlap.
    translation : ndarray of shape (N,)
        Where the faces that stop it meet in their true place, in multiples of the direction.
    translation_lower, translation_upper : ndarray of shape (N,)
        The proven bounds of the translation.
    shrunk_distance : ndarray of shape (N,)
        How far the bodies go that were shrunk by half the tolerance each.
    shrunk_distance_lower, shrunk_distance_upper : ndarray of shape (N,)
        The proven bounds of that.
    least_tolerance : ndarray of shape (N,)
        The least tolerance with which bodies that overlap would not, a length.
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the moving body to the fixed one.
    point : ndarray of shape (N, 3)
        Contact points, in the world.
    """

    distance: Floats
    translation: Floats
    translation_lower: Floats
    translation_upper: Floats
    shrunk_distance: Floats
    shrunk_distance_lower: Floats
    shrunk_distance_upper: Floats
    least_tolerance: Floats
    normal: Floats
    point: Floats

    _question = staticmethod(SolidCast.clearance)

    def _is_row(self, answer: Any, i: int) -> bool:
        if answer is None:
            return False
        code, distance, translation, *_ = _values(answer)
        told = (self.outcome.codes[i], self.distance[i], self.translation[i])
        return np.array_equal(told, (code, distance, translation), equal_nan=True)


def _values(answer: Any) -> tuple[Any, ...]:
    """The outcome and the numbers of a row."""
    nothing, none = np.full(3, np.nan), [np.nan] * 6
    match answer:
        case SolidBlocked(distance=distance, contact=contact):
            place = (contact.translation, *contact.translation_bounds)
            shrunk = (contact.shrunk_distance, *contact.shrunk_distance_bounds)
            return 0, distance, *place, *shrunk, np.nan, contact.normal, contact.point
        case SolidFree(normal=normal):
            normal = nothing if normal is None else normal
            return 1, np.inf, *none, np.nan, normal, nothing
        case SolidOverlapping(least_tolerance=least):
            least = np.nan if least is None else least
            return 2, np.nan, *none, least, nothing, nothing
    raise TypeError(type(answer).__name__)


def _corners(answer: Any) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The first vertices of the features that touch, -1 where there are no more."""
    found = np.full((2, 3), -1, np.int64)
    if isinstance(answer, SolidBlocked):
        touching = (answer.contact.moving_feature, answer.contact.fixed_feature)
        for corners, feature in zip(found, touching, strict=True):
            vertices = feature.vertices[:3]
            corners[: len(vertices)] = vertices
    return found[0], found[1]


def ask_solids(
    queries: Queries, ignore_start_overlaps: bool, features: bool, threads: int | None
) -> SolidColumns:
    """Answers all rows."""
    asked, n = SolidQueries(queries, ignore_start_overlaps), queries.count
    corners = [np.full((n, 3), -1, np.int64) for _ in range(2)] if features else [None, None]
    columns = SolidColumns(
        outcome=Outcomes(np.full(n, OUTCOMES.index("error"), np.uint8), OUTCOMES),
        outcomes=OUTCOMES,
        errors={},
        _queries=asked,
        moving_feature=corners[0],
        fixed_feature=corners[1],
        **{name: np.full(n, np.nan) for name in _NUMBERS},
        **{name: np.full((n, 3), np.nan) for name in ("normal", "point")},
    )
    numbers = [getattr(columns, name) for name in _NUMBERS]
    places: list[Any] = [columns.outcome.codes, *numbers, columns.normal, columns.point]
    places += [column for column in corners if column is not None]

    def answer(i: int) -> None:
        check_bodies(queries.bodies, queries.indices, i)
        found = asked.ask(SolidCast.clearance, i)
        values = (*_values(found), *(_corners(found) if features else ()))
        for place, value in zip(places, values, strict=True):
            place[i] = value

    columns.errors.update(answer_rows(n, answer, threads))
    return columns


def answer_rows(
    n: int, answer: Callable[[int], None], threads: int | None
) -> list[tuple[int, str]]:
    """Calls ``answer`` for every row; the rows that raised, and what they said.

    Ctrl-C ends it: rows that are being answered go on in the background.
    """
    rows, failed, stopped = iter(range(n)), {}, False

    def work() -> None:
        # One iterator for all threads: a step of it is one step of the interpreter.
        for i in rows:
            if stopped:
                return
            try:
                answer(i)
            except Exception as error:
                failed[i] = str(error)

    count = max(1, min(threads or cores(), n))
    pool = ThreadPoolExecutor(count)
    try:
        waiting = {pool.submit(work) for _ in range(count)}
        while waiting:
            _, waiting = wait(waiting, PATIENCE)
    finally:
        stopped = True
        pool.shutdown(wait=False, cancel_futures=True)
    return sorted(failed.items())


def check_bodies(bodies: tuple[list[Any], list[Any]], indices: tuple[Index, Index], i: int) -> None:
    """The words of the other bulk queries, where a row has no body."""
    for side, listed, index in zip(("moving", "fixed"), bodies, indices, strict=True):
        which = 0 if index is None else int(index[i])
        if not 0 <= which < len(listed):
            raise InputError(f"{side}: no body {which} among {len(listed)}")
        if isinstance(listed[which], Exception):
            raise InputError(f"{side}: {listed[which]}")
