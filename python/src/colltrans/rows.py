"""Columns that Python threads fill, row by row.

A row takes long, so the overhead of Python between rows is negligible. The interpreter's lock is
released while a row is answered. Each row has its own entries, so the threads need no lock.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from typing import Any, ClassVar, Self

import numpy as np

from colltrans.outcomes import Outcomes
from colltrans.queries import Queries, checked_threads, cores
from colltrans.table import FEATURES, Answer_co, Table

#: The columns with three numbers in a row.
VECTORS = ("normal", "point", "direction")
#: Time between two polls for signals, in seconds.
PATIENCE = 0.1


class RowColumns(Table[Answer_co]):
    """Answers of slow queries, as columns; see :class:`Table`."""

    #: All outcomes; the last one is ``"error"``.
    _outcomes: ClassVar[tuple[str, ...]]

    @staticmethod
    def _values(answer: Any) -> dict[str, Any]:
        """Returns the outcome of an answer and its values of the columns."""
        raise NotImplementedError

    @classmethod
    def _ask(cls, queries: Queries, features: bool, threads: int | None) -> Self:
        n, names = queries.count, cls._columns()
        columns = {name: np.full((n, 3) if name in VECTORS else n, np.nan) for name in names}
        corners = {name: np.full((n, 3), -1) for name in FEATURES if features}
        codes = np.full(n, len(cls._outcomes) - 1, np.uint8)

        def answer(i: int) -> None:
            found = queries.ask(cls._question, i)
            values = cls._values(found)
            for name, column in columns.items():
                if values.get(name) is not None:
                    column[i] = values[name]
            for name, column in corners.items():
                if feature := getattr(getattr(found, "contact", found), name, None):
                    vertices = feature.vertices[:3]
                    column[i, : len(vertices)] = vertices
            codes[i] = cls._outcomes.index(values["outcome"])

        errors = dict(_answer_rows(n, answer, checked_threads(threads)))
        outcome = Outcomes(codes, cls._outcomes)
        return cls(outcome, cls._outcomes, errors, queries, **columns, **corners)

    def _is_row(self, answer: Any, i: int) -> bool:
        values = self._values(answer)
        names = [name for name in self._columns() if name not in VECTORS]
        told = [getattr(self, name)[i] for name in names]
        found = np.array([values.get(name) for name in names], float)
        return np.array_equal(told, found, equal_nan=True) and self.outcome[i] == values["outcome"]


def _answer_rows(
    n: int, answer: Callable[[int], None], threads: int | None
) -> list[tuple[int, str]]:
    """Calls ``answer`` for every row; returns the rows that raised, with their messages.

    Ctrl-C ends the call; rows that are being answered continue in the background.
    """
    rows, failed, stopped = iter(range(n)), {}, False

    def work() -> None:
        # One iterator serves all threads, because the interpreter's lock makes each step of it
        # atomic.
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
