"""Answers in bulk: columns, and whole answers of single rows."""

import operator
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Self, TypeVar, overload

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
from colltrans.outcomes import Outcomes
from colltrans.queries import Floats, Queries, Shape, checked_threads

if TYPE_CHECKING:
    import pandas
    import pyarrow
    import xarray

Answer_co = TypeVar("Answer_co", covariant=True)
#: The columns of vertices, which are there if they are asked for.
FEATURES = ("moving_feature", "fixed_feature")


@dataclass(frozen=True)
class Failed:
    """A row without an answer.

    Attributes
    ----------
    message : str
        What is wrong with it.
    """

    message: str


@dataclass(frozen=True)
class _Taken:
    """Some rows of what was asked."""

    of: Any
    rows: NDArray[np.intp]

    @property
    def shape(self) -> Shape:
        return (len(self.rows),)

    def ask(self, question: Any, i: int) -> Any:
        return self.of.ask(question, int(self.rows[i]))


@dataclass(frozen=True)
class _Joined:
    """What was asked in several calls, one after the other."""

    parts: tuple[Any, ...]
    ends: NDArray[np.intp]

    @property
    def shape(self) -> Shape:
        return (int(self.ends[-1]),)

    def ask(self, question: Any, i: int) -> Any:
        part = int(np.searchsorted(self.ends, i, side="right"))
        return self.parts[part].ask(question, i - (int(self.ends[part - 1]) if part else 0))


@dataclass(frozen=True, eq=False, repr=False)
class Table(Generic[Answer_co]):
    """Answers as columns, one row a query. Numbers that a row has not are NaN.

    ``len(columns)`` is the number of rows, ``columns[i]`` the whole answer of one of them, with its
    features and its proof: it is asked again, from the arrays that were given. A slice, a mask or
    an array of positions selects rows, as of an array; :func:`concatenate` joins them.

    Attributes
    ----------
    outcome : Outcomes
        What became of each row, by name: ``columns.outcome == "contact"`` is a mask.
    errors : dict of int to str
        The messages of the rows without an answer.
    moving_feature, fixed_feature : ndarray of int64, shape (N, 3), or None
        With ``features=True``, what touches: a vertex as its number in the input, an edge as two, a
        face as its first three; -1 stands for none.
    """

    outcome: Outcomes
    outcomes: tuple[str, ...]
    errors: dict[int, str]
    _queries: Any
    moving_feature: NDArray[np.int64] | None = field(default=None, kw_only=True)
    fixed_feature: NDArray[np.int64] | None = field(default=None, kw_only=True)

    #: What is asked of one row, and the name of the question in bulk.
    _question: ClassVar[Any]
    _name: ClassVar[str]

    @classmethod
    def _columns(cls) -> list[str]:
        """The columns that only answers to this question have."""
        common = {each.name for each in fields(Table)}
        return [each.name for each in fields(cls) if each.name not in common]

    @classmethod
    def _ask(cls, queries: Queries, features: bool, threads: int | None) -> Self:
        """Answers all queries."""
        threads = checked_threads(threads)
        return cls(**queries.ask_all(cls._name, cls._columns(), features, threads))

    def __post_init__(self) -> None:
        if not isinstance(self.outcome, Outcomes):
            object.__setattr__(self, "outcome", Outcomes(self.outcome, self.outcomes))

    def __len__(self) -> int:
        return len(self.outcome)

    @property
    def shape(self) -> Shape:
        """tuple of int: The axes that the arguments had together; rows are in C order."""
        shape: Shape = self._queries.shape
        return shape

    def stacked(self, name: str) -> NDArray[Any]:
        """A column with the axes that the arguments had, those of vectors last.

        Parameters
        ----------
        name : str
            Of a column, ``"outcome"`` among them.

        Examples
        --------
        >>> import numpy as np
        >>> from colltrans import ConvexPolyhedron, cast_many
        >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
        >>> starts = np.array([[[-3, 0, 0], [-3, 9, 0]], [[-4, 0, 0], [-5, 0, 0]]])
        >>> columns = cast_many(cube, cube, [1, 0, 0], moving_pose=starts)
        >>> columns.stacked("translation")
        array([[ 2., nan],
               [ 3.,  4.]])
        >>> columns.stacked("normal").shape
        (2, 2, 3)
        """
        known = {"outcome": np.asarray(self.outcome), **dict(self._numbers())}
        if name not in known:
            raise InputError(f"no column {name!r}: {', '.join(known)}")
        column = known[name]
        return column.reshape(*self.shape, *column.shape[1:])

    @overload
    def __getitem__(self, i: int) -> "Answer_co | Failed": ...
    @overload
    def __getitem__(self, i: slice | NDArray[Any] | Sequence[int] | Sequence[bool]) -> Self: ...
    def __getitem__(self, i: Any) -> Any:
        if isinstance(i, (slice, np.ndarray, Sequence)):
            return self._take(np.arange(len(self))[i])
        i = range(len(self))[operator.index(i)]
        if i in self.errors:
            return Failed(self.errors[i])
        try:
            answer = self._queries.ask(type(self)._question, i)
        except ColltransError:
            answer = None
        if answer is None or not self._is_row(answer, i):
            raise ColltransError(f"row {i}: the arrays that were given have changed since")
        return answer

    def __iter__(self) -> "Iterator[Answer_co | Failed]":
        return (self[i] for i in range(len(self)))

    def _take(self, rows: NDArray[np.intp]) -> Self:
        if rows.ndim != 1:
            raise InputError(f"rows: an array of shape {rows.shape}, not (N,)")
        found = (self.errors.get(int(row)) for row in rows) if self.errors else ()
        changed: dict[str, Any] = {name: column[rows] for name, column in self._numbers()}
        changed["outcome"] = self.outcome[rows]
        changed["errors"] = {i: text for i, text in enumerate(found) if text is not None}
        return replace(self, _queries=_Taken(self._queries, rows), **changed)

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
        >>> columns[columns.where("contact", "grazing")]
        ContactColumns(1 rows: 1 contact)
        """
        return self.outcome.isin(outcomes)

    def counts(self) -> dict[str, int]:
        """How many rows have each outcome, without those that none has."""
        return self.outcome.counts()

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
                pa.array(self.outcome.codes.view(np.int8)), list(self.outcomes)
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

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """The table of :meth:`to_arrow` for whoever reads Arrow: polars, DuckDB, pandas."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def to_xarray(self) -> "xarray.Dataset":
        """A data set of xarray: each column by ``query``, vectors by ``axis`` too.

        Raises
        ------
        ModuleNotFoundError
            Without xarray, ``pip install colltrans[xarray]``.
        """
        import xarray as xr

        columns: dict[str, Any] = {"outcome": ("query", np.asarray(self.outcome))}
        for name, column in self._numbers():
            of = "corner" if name in FEATURES else "axis"
            columns[name] = (("query", of)[: column.ndim], column)
        messages = np.array([self.errors.get(i, "") for i in range(len(self))], dtype=str)
        columns["message"] = ("query", messages)
        return xr.Dataset(columns, coords={"axis": list("xyz")})

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
                self.outcome.codes.astype(np.int8), categories=list(self.outcomes)
            )
        }
        for name, column in self._numbers():
            if column.ndim == 1:
                columns[name] = column
            else:
                of = "012" if name in FEATURES else "xyz"
                columns |= {f"{name}_{axis}": column[:, k] for k, axis in enumerate(of)}
        columns["message"] = pd.Series(self.errors, dtype=object).reindex(range(len(self)))
        return pd.DataFrame(columns)

    def _numbers(self) -> Iterator[tuple[str, Floats]]:
        names = [each.name for each in fields(self)]
        for name in sorted(names, key=lambda name: name in FEATURES):
            column = getattr(self, name)
            if isinstance(column, np.ndarray):
                yield name, column

    def _is_row(self, answer: Any, i: int) -> bool:
        """Checks whether a row has the outcome of an answer, and its bounds."""
        record = answer.to_dict()
        bounds = record.get("time", record)
        found = [bounds.get(name, np.nan) for name in ("lower", "upper")]
        told: Any = self
        same = np.array_equal([told.lower[i], told.upper[i]], found, equal_nan=True)
        return same and self.outcome[i] == record["outcome"]

    def __repr__(self) -> str:
        counts = ", ".join(f"{n} {name}" for name, n in self.counts().items())
        return f"{type(self).__name__}({len(self)} rows: {counts})"

    def _repr_html_(self) -> str:
        shown = min(len(self), 8)
        columns = [("outcome", self.outcome[:shown].tolist())]
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
        record = answer.to_dict()
        told, found = self.translation[i], record.get("translation", np.nan)
        # Rows of one pair are asked together, a row alone by a cast: both are right, each within
        # its rounding.
        same = np.array_equal(told, found, equal_nan=True)
        same = same or abs(told - found) <= 2 * self.rounding[i]
        return bool(same) and self.outcome[i] == record["outcome"]


Columns_ = TypeVar("Columns_", bound=Table[Any])


def concatenate(columns: "Sequence[Columns_]") -> Columns_:
    """Columns of one kind, one after the other.

    Parameters
    ----------
    columns : sequence of columns
        At least one, all of answers to the same question.

    Returns
    -------
    Columns of the same class

    Raises
    ------
    InputError
        None at all, or answers to different questions.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, cast_many, concatenate
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> one = cast_many(cube, cube, [1, 0, 0], moving_pose=[[-3, 0, 0], [-3, 9, 0]])
    >>> other = cast_many(cube, cube, [0, 0, 1], moving_pose=[0, 0, -4])
    >>> concatenate([one[:1], other]).translation
    array([2., 3.])
    """
    if len({type(each) for each in columns}) != 1:
        kinds = ", ".join(sorted({type(each).__name__ for each in columns})) or "nothing"
        raise InputError(f"columns of one kind are joined, not {kinds}")
    first, ends = columns[0], np.cumsum([len(each) for each in columns])
    if len({tuple(name for name, _ in each._numbers()) for each in columns}) != 1:
        raise InputError("columns with features and columns without are not joined")
    for name in ("outcomes", "bodies"):
        if any(getattr(each, name, ()) != getattr(first, name, ()) for each in columns):
            raise InputError(f"columns of the same {name} are joined")
    begins = np.concatenate([[0], ends[:-1]])
    shifted = (
        {int(begin) + i: text for i, text in each.errors.items()}
        for begin, each in zip(begins, columns, strict=True)
    )
    changed: dict[str, Any] = {
        name: np.concatenate([getattr(each, name) for each in columns])
        for name, _ in first._numbers()
    }
    codes = np.concatenate([each.outcome.codes for each in columns])
    changed["outcome"] = Outcomes(codes, first.outcomes)
    changed["errors"] = {i: text for errors in shifted for i, text in errors.items()}
    queries = _Joined(tuple(each._queries for each in columns), ends)
    return replace(first, _queries=queries, **changed)


def _cell(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_cell, value))
    return value if isinstance(value, str) else "" if np.isnan(value) else f"{value:.6g}"


class ContactColumns(Columns[Contact | Grazing | Separated]):
    """The answers of :func:`cast_many`; see :class:`Columns`."""

    _question, _name = staticmethod(_colltrans.cast), "contact"


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

    _question, _name = staticmethod(_colltrans.contact_range), "range"


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

    _question, _name = staticmethod(_colltrans.clearance), "clearance"
