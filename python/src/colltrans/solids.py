"""Queries about solids in bulk: threads that each ask one row after the other, columns out.

A row of solids takes so long that Python between two of them does not count. The interpreter's
lock is free while a row is answered. Every row has its own place, so the threads need no other.
"""

import os
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any

import numpy as np

from colltrans._colltrans import SolidBlocked, SolidCast, SolidFree, SolidOverlapping
from colltrans.columns import Table
from colltrans.errors import InputError
from colltrans.queries import Floats, Queries, row_of

OUTCOMES = ("blocked", "free", "overlapping", "error")
#: Between two looks at signals, in seconds.
PATIENCE = 0.1


@dataclass(frozen=True)
class SolidQueries:
    """What was asked: the tables of all kinds of bodies, and the choices of solids."""

    queries: Queries
    tolerance: Floats | None
    ignore_start_overlaps: bool

    def ask(self, question: Any, i: int) -> Any:
        """One of them, alone."""
        none = self.tolerance is None
        choices = {
            "tolerance": None if none else float(row_of(self.tolerance, i)[0]),  # type: ignore[arg-type]
            "ignore_start_overlaps": self.ignore_start_overlaps,
        }
        return question(self.queries.ask_with(SolidCast, i, **choices))


@dataclass(frozen=True, eq=False, repr=False)
class SolidColumns(Table[SolidBlocked | SolidFree | SolidOverlapping]):
    """The answers of :func:`clearance_many` about solids; see :class:`Table`.

    Attributes
    ----------
    distance : ndarray of shape (N,)
        How far the moving body may move, in multiples of the direction, both bodies shrunk by half
        the tolerance: infinite where nothing blocks, NaN where the bodies overlap.
    nominal : ndarray of shape (N,)
        Where the bodies as they are meet, in multiples of the direction.
    depth : ndarray of shape (N,)
        The least tolerance with which bodies that overlap would not, a length.
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the moving body to the fixed one.
    point : ndarray of shape (N, 3)
        Contact points, in the world.
    """

    distance: Floats
    nominal: Floats
    depth: Floats
    normal: Floats
    point: Floats

    _question = staticmethod(SolidCast.clearance)

    def _is_row(self, answer: Any, i: int) -> bool:
        if answer is None:
            return False
        code, distance, nominal, *_ = _values(answer)
        told = (self.outcome[i], self.distance[i], self.nominal[i])
        return np.array_equal(told, (code, distance, nominal), equal_nan=True)


def _values(answer: Any) -> tuple[int, float, float, float, Any, Any]:
    """The outcome and the numbers of a row."""
    nothing = np.full(3, np.nan)
    match answer:
        case SolidBlocked(distance=distance, contact=contact):
            return 0, distance, contact.nominal, np.nan, contact.normal, contact.point
        case SolidFree(normal=normal):
            normal = nothing if normal is None else normal
            return 1, np.inf, np.nan, np.nan, normal, nothing
        case SolidOverlapping(depth=depth):
            depth = np.nan if depth is None else depth
            return 2, np.nan, np.nan, depth, nothing, nothing
    raise TypeError(type(answer).__name__)


def ask_solids(
    queries: Queries, tolerance: Floats | None, ignore_start_overlaps: bool, threads: int | None
) -> SolidColumns:
    """Answers all rows. Ctrl-C ends it: rows that are being answered go on in the background."""
    asked, n = SolidQueries(queries, tolerance, ignore_start_overlaps), queries.count
    columns = SolidColumns(
        outcome=np.full(n, OUTCOMES.index("error"), np.uint8),
        outcomes=OUTCOMES,
        errors={},
        _queries=asked,
        **{name: np.full(n, np.nan) for name in ("distance", "nominal", "depth")},
        **{name: np.full((n, 3), np.nan) for name in ("normal", "point")},
    )
    numbers = [columns.outcome, columns.distance, columns.nominal, columns.depth]
    places: list[Any] = [*numbers, columns.normal, columns.point]
    rows, failed, stopped = iter(range(n)), {}, False

    def work() -> None:
        # One iterator for all threads: a step of it is one step of the interpreter.
        for i in rows:
            if stopped:
                return
            try:
                _check_bodies(queries, i)
                values = _values(asked.ask(SolidCast.clearance, i))
            except Exception as error:
                failed[i] = str(error)
            else:
                for place, value in zip(places, values, strict=True):
                    place[i] = value

    count = max(1, min(threads or _cores(), n))
    pool = ThreadPoolExecutor(count)
    try:
        waiting = {pool.submit(work) for _ in range(count)}
        while waiting:
            _, waiting = wait(waiting, PATIENCE)
    finally:
        stopped = True
        pool.shutdown(wait=False, cancel_futures=True)
    columns.errors.update(sorted(failed.items()))
    return columns


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _check_bodies(queries: Queries, i: int) -> None:
    """The words of the other bulk queries, where a row has no body."""
    for side, bodies, index in zip(
        ("moving", "fixed"), queries.bodies, queries.indices, strict=True
    ):
        which = 0 if index is None else int(index[i])
        if not 0 <= which < len(bodies):
            raise InputError(f"{side}: no body {which} among {len(bodies)}")
        if isinstance(bodies[which], Exception):
            raise InputError(f"{side}: {bodies[which]}")
