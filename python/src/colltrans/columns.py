"""Answers in bulk: columns, and whole answers of single rows."""

import operator
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from colltrans import _colltrans
from colltrans._colltrans import (
    Behind,
    Blocked,
    Contact,
    ContactRange,
    Grazing,
    Overlapping,
    Separated,
    Slides,
)
from colltrans.errors import ColltransError, InputError
from colltrans.queries import Floats

if TYPE_CHECKING:
    import pandas
    import pyarrow

Answer_co = TypeVar("Answer_co", covariant=True)


@dataclass(frozen=True)
class Failed:
    """A row without an answer.

    Attributes
    ----------
    message : str
        What is wrong with it.
    """

    message: str


@dataclass(frozen=True, eq=False, repr=False)
class Table(Generic[Answer_co]):
    """Answers as columns, one row a query. Numbers that a row has not are NaN.

    ``len(columns)`` is the number of rows, ``columns[i]`` the whole answer of one of them, with its
    features and its proof: it is asked again, from the arrays that were given.

    Attributes
    ----------
    outcome : ndarray of uint8, shape (N,)
        An index into ``outcomes``.
    outcomes : tuple of str
        The names of the outcomes; the last one is ``"error"``.
    errors : dict of int to str
        The messages of the rows without an answer.
    """

    outcome: NDArray[np.uint8]
    outcomes: tuple[str, ...]
    errors: dict[int, str]
    _queries: Any

    _question: ClassVar[Any]

    def __len__(self) -> int:
        return len(self.outcome)

    def __getitem__(self, i: int) -> "Answer_co | Failed":
        i = range(len(self))[operator.index(i)]
        if i in self.errors:
            return Failed(self.errors[i])
        try:
            answer: Answer_co = self._queries.ask(type(self)._question, i)
        except ColltransError:
            answer = None  # type: ignore[assignment]
        if not self._is_row(answer, i):
            raise ColltransError(f"row {i}: the arrays that were given have changed since")
        return answer

    def __iter__(self) -> "Iterator[Answer_co | Failed]":
        return (self[i] for i in range(len(self)))

    def where(self, *outcomes: str) -> NDArray[np.bool_]:
        """Which rows have one of these outcomes, by name: a mask for the columns.

        Examples
        --------
        >>> import numpy as np
        >>> from colltrans import ConvexPolyhedron, cast_many
        >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
        >>> columns = cast_many(cube, cube, [1, 0, 0], moving_pose=[[-3, 0, 0], [-3, 9, 0]])
        >>> columns.where("separated")
        array([False,  True])
        """
        for name in outcomes:
            if name not in self.outcomes:
                raise InputError(f"no outcome {name!r}: {', '.join(self.outcomes)}")
        return np.isin(self.outcome, [self.outcomes.index(name) for name in outcomes])

    def counts(self) -> dict[str, int]:
        """How many rows have each outcome, without those that none has."""
        counts = np.bincount(self.outcome, minlength=len(self.outcomes))
        return {name: int(n) for name, n in zip(self.outcomes, counts, strict=True) if n}

    def to_arrow(self) -> "pyarrow.Table":
        """A table of pyarrow; vectors are lists of fixed size, columns are not copied.

        Raises
        ------
        ModuleNotFoundError
            Without pyarrow, ``pip install colltrans[arrow]``.
        """
        import pyarrow as pa

        columns: dict[str, Any] = {
            "outcome": pa.DictionaryArray.from_arrays(
                pa.array(self.outcome.view(np.int8)), list(self.outcomes)
            )
        }
        for name, column in self._numbers():
            values = pa.array(column.reshape(-1))
            of_three = column.ndim == 2
            columns[name] = pa.FixedSizeListArray.from_arrays(values, 3) if of_three else values
        if self.errors:
            columns["message"] = pa.array(map(self.errors.get, range(len(self))), pa.string())
        else:
            columns["message"] = pa.nulls(len(self), pa.string())
        return pa.table(columns)

    def to_pandas(self) -> "pandas.DataFrame":
        """A data frame of pandas; vectors are three columns each.

        Raises
        ------
        ModuleNotFoundError
            Without pandas, ``pip install colltrans[pandas]``.
        """
        import pandas as pd

        columns: dict[str, Any] = {
            "outcome": pd.Categorical.from_codes(
                self.outcome.astype(np.int8), categories=list(self.outcomes)
            )
        }
        for name, column in self._numbers():
            if column.ndim == 1:
                columns[name] = column
            else:
                columns |= {f"{name}_{axis}": column[:, k] for k, axis in enumerate("xyz")}
        columns["message"] = pd.Series(self.errors, dtype=object).reindex(range(len(self)))
        return pd.DataFrame(columns)

    def _numbers(self) -> Iterator[tuple[str, Floats]]:
        for field in fields(self):
            column = getattr(self, field.name)
            if isinstance(column, np.ndarray) and field.name != "outcome":
                yield field.name, column

    def _is_row(self, answer: Any, i: int) -> bool:
        """Whether a row says what this answer does."""
        raise NotImplementedError

    def __repr__(self) -> str:
        counts = ", ".join(f"{n} {name}" for name, n in self.counts().items())
        return f"{type(self).__name__}({len(self)} rows: {counts})"

    def _repr_html_(self) -> str:
        shown = min(len(self), 8)
        columns = [("outcome", [self.outcomes[code] for code in self.outcome[:shown]])]
        columns += [(name, column[:shown].tolist()) for name, column in self._numbers()]
        head = "".join(f"<th>{name}</th>" for name, _ in columns)
        lines = (
            "".join(f"<td>{_cell(column[i])}</td>" for _, column in columns) for i in range(shown)
        )
        body = "".join(f"<tr><th>{i}</th>{line}</tr>" for i, line in enumerate(lines))
        return f"<p>{self!r}</p><table><tr><th></th>{head}</tr>{body}</table>"


@dataclass(frozen=True, eq=False, repr=False)
class TimeColumns(Table[Answer_co]):
    """Answers about times as columns; see :class:`Table`.

    Attributes
    ----------
    lower, upper : ndarray of shape (N,)
        Of contacts, proven bounds of their times: nothing meets before the first, and what stops
        the motion does at the second.
    """

    lower: Floats
    upper: Floats

    def _is_row(self, answer: Any, i: int) -> bool:
        if answer is None:
            return False
        told = answer.to_dict()
        found = [told.get("time", {}).get(name, np.nan) for name in ("lower", "upper")]
        same = np.array_equal([self.lower[i], self.upper[i]], found, equal_nan=True)
        return same and self.outcomes[self.outcome[i]] == told["outcome"]


@dataclass(frozen=True, eq=False, repr=False)
class Columns(Table[Answer_co]):
    """Answers about convex bodies as columns; see :class:`Table`.

    Attributes
    ----------
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the moving body to the fixed one.
    point : ndarray of shape (N, 3)
        Contact points, in the world.
    translation_lower, translation_upper : ndarray of shape (N,)
        Proven bounds of the translation, in multiples of the direction; infinite where nothing is
        known.
    translation : ndarray of shape (N,)
        Of the first contact, in multiples of the direction.
    rounding : ndarray of shape (N,)
        What rounding alone can make of the difference of these bounds.
    margin : ndarray of shape (N,)
        How far the shadows of separated bodies are apart at least, a length.
    overlap : ndarray of shape (N,)
        By how much the shadows of bodies overlap that graze, a length; negative where they may not.
    """

    translation: Floats
    translation_lower: Floats
    translation_upper: Floats
    rounding: Floats
    margin: Floats
    overlap: Floats
    normal: Floats
    point: Floats

    def _is_row(self, answer: Any, i: int) -> bool:
        match answer:
            case None:
                return False
            case Blocked(contact=contact):
                name, translation = "blocked", contact.translation
            case Slides(grazing=grazing):
                name, translation = "slides", grazing.contact.translation
            case Behind() | Separated():
                name, translation = type(answer).__name__.lower(), np.nan
            case Overlapping(first=first):
                name, translation = "overlapping", first.translation
            case Grazing(contact=contact) | ContactRange(first=Grazing(contact=contact)):
                name, translation = "grazing", contact.translation
            case (Contact() as contact) | ContactRange(first=Contact() as contact):
                name, translation = "contact", contact.translation
        same = np.array_equal(self.translation[i], translation, equal_nan=True)
        return same and self.outcomes[self.outcome[i]] == name


def _cell(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_cell, value))
    return value if isinstance(value, str) else "" if np.isnan(value) else f"{value:.6g}"


class ContactColumns(Columns[Contact | Grazing | Separated]):
    """The answers of :func:`cast_many`; see :class:`Columns`."""

    _question = staticmethod(_colltrans.cast)


@dataclass(frozen=True, eq=False, repr=False)
class RangeColumns(Columns[ContactRange | Separated]):
    """The answers of :func:`contact_range_many`; see :class:`Columns`.

    Attributes
    ----------
    exit : ndarray of shape (N,)
        The translation of the last contact, in multiples of the direction.
    exit_lower, exit_upper : ndarray of shape (N,)
        Its proven bounds: beyond the upper one the bodies never meet.
    """

    exit: Floats
    exit_lower: Floats
    exit_upper: Floats

    _question = staticmethod(_colltrans.contact_range)


@dataclass(frozen=True, eq=False, repr=False)
class ClearanceColumns(Columns[Blocked | Slides | Behind | Separated | Overlapping]):
    """The answers of :func:`clearance_many`; see :class:`Columns`.

    Attributes
    ----------
    distance : ndarray of shape (N,)
        How far the moving body may safely move, in multiples of the direction: infinite where
        nothing blocks, NaN where the bodies overlap.
    exit : ndarray of shape (N,)
        The translation of the last contact, where it is behind or the bodies overlap.
    exit_lower, exit_upper : ndarray of shape (N,)
        Its proven bounds: beyond the upper one the bodies never meet.
    back, on : ndarray of shape (N,)
        How far a body that overlaps has to go, back or on, until it does not.
    """

    distance: Floats
    exit: Floats
    exit_lower: Floats
    exit_upper: Floats
    back: Floats
    on: Floats

    _question = staticmethod(_colltrans.clearance)
