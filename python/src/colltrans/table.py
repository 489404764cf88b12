"""Columns of bulk answers, and the complete answers of single rows."""

import operator
from collections import namedtuple
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
#: The columns of features, which exist if features are requested.
FEATURES = ("moving_feature", "fixed_feature")


@dataclass(frozen=True)
class Failed:
    """A row without an answer.

    Attributes
    ----------
    message : str
        The reason for the failure.
    """

    message: str


@dataclass(frozen=True)
class _Taken:
    """Selected rows of a query."""

    of: Any
    rows: NDArray[np.intp]

    @property
    def shape(self) -> Shape:
        return (len(self.rows),)

    def ask(self, question: Any, i: int) -> Any:
        return self.of.ask(question, int(self.rows[i]))


@dataclass(frozen=True)
class _Joined:
    """The queries of several calls, joined in order."""

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
    """Answers as columns, one row for each query. Missing numbers are NaN.

    ``len(columns)`` is the number of rows. ``columns[i]`` is the complete answer of a row, with its
    features and its proof; it is computed again from the arguments of the call. ``columns["name"]``
    is a column. A slice, a mask or an array of positions selects rows, as for an array;
    :func:`concatenate` joins tables. Iteration yields rows as named tuples of plain values, so that
    ``pandas.DataFrame(columns)`` has the columns of :meth:`to_pandas`, which is faster.
    ``polars.DataFrame(columns)`` reads the columns themselves.

    Attributes
    ----------
    outcome : Outcomes
        The outcome of each row, by name: ``columns.outcome == "contact"`` is a mask.
    errors : dict of int to str
        The messages of the rows without an answer.
    moving_feature, fixed_feature : ndarray of int64, shape (N, 3), or None
        With ``features=True``, the features in contact: one vertex number of the input for a
        vertex, two for an edge, the first three for a face; the rest is -1.
    """

    outcome: Outcomes
    outcomes: tuple[str, ...]
    errors: dict[int, str]
    _queries: Any
    moving_feature: NDArray[np.int64] | None = field(default=None, kw_only=True)
    fixed_feature: NDArray[np.int64] | None = field(default=None, kw_only=True)

    #: The function that answers one row, and the name of the bulk query.
    _question: ClassVar[Any]
    _name: ClassVar[str]

    @classmethod
    def _columns(cls) -> list[str]:
        """Returns the names of the columns that only this kind of answer has."""
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
        """tuple of int: The common axes of the arguments; rows are in C order."""
        shape: Shape = self._queries.shape
        return shape

    def stacked(self, name: str) -> NDArray[Any]:
        """Returns a column with the axes of the arguments, followed by the axis of vectors.

        Parameters
        ----------
        name : str
            The name of a column, for example ``"outcome"``.

        Raises
        ------
        InputError
            There is no such column.

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
        column = self._column(name)
        return column.reshape(*self.shape, *column.shape[1:])

    @overload
    def __getitem__(self, i: str) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, i: int) -> "Answer_co | Failed": ...
    @overload
    def __getitem__(self, i: slice | NDArray[Any] | Sequence[int] | Sequence[bool]) -> Self: ...
    def __getitem__(self, i: Any) -> Any:
        if isinstance(i, str):
            return self._column(i)
        if isinstance(i, (slice, np.ndarray, Sequence)):
            return self._take(np.arange(len(self))[i])
        i = range(len(self))[operator.index(i)]
        if i in self.errors:
            return Failed(self.errors[i])
        modified = f"row {i}: the arguments of the query have been modified since"
        try:
            answer = self._queries.ask(type(self)._question, i)
        except ColltransError:
            raise ColltransError(modified) from None
        if not self._is_row(answer, i):
            raise ColltransError(modified)
        return answer

    def answers(self) -> "Iterator[Answer_co | Failed]":
        """Iterates over the complete answers, ``columns[0]`` to ``columns[-1]``."""
        return (self[i] for i in range(len(self)))

    def __iter__(self) -> Iterator[Any]:
        """Iterates over the rows as named tuples of plain values."""
        columns = dict(self._flat_columns())
        row: Any = namedtuple("Row", list(columns))  # type: ignore[misc]
        return map(row._make, zip(*columns.values(), strict=True))

    def _flat_columns(self) -> Iterator[tuple[str, list[Any]]]:
        """Yields the columns of numbers and texts; a vector becomes three columns."""
        yield "outcome", self.outcome.tolist()
        for name, column in self._numbers():
            if column.ndim == 1:
                yield name, column.tolist()
            else:
                of = "012" if name in FEATURES else "xyz"
                yield from ((f"{name}_{axis}", column[:, k].tolist()) for k, axis in enumerate(of))
        yield "message", [self.errors.get(i) for i in range(len(self))]

    def _column(self, name: str) -> NDArray[Any]:
        known = {"outcome": np.asarray(self.outcome), **dict(self._numbers())}
        if name not in known:
            raise InputError(f"unknown column {name!r}; known columns: {', '.join(known)}")
        return known[name]

    def _take(self, rows: NDArray[np.intp]) -> Self:
        if rows.ndim != 1:
            raise InputError(f"rows: an array of shape {rows.shape}, not (N,)")
        found = (self.errors.get(int(row)) for row in rows) if self.errors else ()
        changed: dict[str, Any] = {name: column[rows] for name, column in self._numbers()}
        changed["outcome"] = self.outcome[rows]
        changed["errors"] = {i: text for i, text in enumerate(found) if text is not None}
        return replace(self, _queries=_Taken(self._queries, rows), **changed)

    def where(self, *outcomes: str) -> NDArray[np.bool_]:
        """Returns a mask of the rows that have one of these outcomes.

        Raises
        ------
        InputError
            A name is not an outcome of these answers.

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
        """Counts the rows of each outcome that occurs."""
        return self.outcome.counts()

    def to_arrow(self) -> "pyarrow.Table":
        """Converts the columns to a pyarrow table without copies; vectors become fixed-size lists.

        Raises
        ------
        ModuleNotFoundError
            pyarrow is missing; run ``pip install colltrans[arrow]``.
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
        """Exports the table of :meth:`to_arrow` to readers of Arrow: polars, DuckDB, pandas."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def to_xarray(self) -> "xarray.Dataset":
        """Converts the columns to a data set of xarray with the dimensions ``query`` and ``axis``.

        Columns of features have the dimensions ``query`` and ``corner``.

        Raises
        ------
        ModuleNotFoundError
            xarray is missing; run ``pip install colltrans[xarray]``.
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
        """Converts the columns to a data frame of pandas; a vector becomes three columns.

        Raises
        ------
        ModuleNotFoundError
            pandas is missing; run ``pip install colltrans[pandas]``.
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
        """Checks whether a row has the outcome and the bounds of an answer."""
        record = answer.to_dict()
        found = [record.get(name, np.nan) for name in ("lower", "upper")]
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


def middle(lower: Floats, upper: Floats) -> Floats:
    """Returns the middle of bounds, or the lower one if the upper one is infinite."""
    with np.errstate(invalid="ignore"):
        return np.where(np.isinf(upper), lower, lower + (upper - lower) / 2)


@dataclass(frozen=True, eq=False, repr=False)
class TimeColumns(Table[Answer_co]):
    """Answers about times, as columns; see :class:`Table`.

    Attributes
    ----------
    lower, upper : ndarray of shape (N,)
        Bounds of a time: that of the first contact, or that until which a body can move. The class
        of the answers states what they prove.
    """

    lower: Floats
    upper: Floats

    @property
    def value(self) -> Floats:
        """ndarray of shape (N,): The time of the answers; infinite if no bodies meet.

        The middle of both bounds, or the lower one if the upper one is infinite; NaN if the answer
        is undecided.
        """
        at = np.where(self.outcome == "undecided", np.nan, middle(self.lower, self.upper))
        return np.where(self.outcome == "free", np.inf, at)

    def _is_row(self, answer: Any, i: int) -> bool:
        found = [np.nan if bound is None else bound for bound in (answer.lower, answer.upper)]
        same = np.array_equal([self.lower[i], self.upper[i]], found, equal_nan=True)
        return same and bool(self.outcome[i] == answer.outcome)


@dataclass(frozen=True, eq=False, repr=False)
class Columns(Table[Answer_co]):
    """Answers about convex bodies, as columns; see :class:`Table`.

    Attributes
    ----------
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the moving body to the fixed one.
    point : ndarray of shape (N, 3)
        Contact points, in the world.
    translation_lower, translation_upper : ndarray of shape (N,)
        Proven bounds of the translation, in multiples of the direction. The upper one is infinite
        if the shadows overlap by less than rounding errors.
    translation : ndarray of shape (N,)
        Translation of the first contact, in multiples of the direction.
    rounding : ndarray of shape (N,)
        An upper bound of the part of the difference of both bounds that is due to rounding.
    margin : ndarray of shape (N,)
        A lower bound of the distance of the shadows of separated bodies, a length.
    overlap : ndarray of shape (N,)
        The overlap of the shadows of grazing bodies, a length; negative if they may be disjoint.
    """

    translation: Floats
    translation_lower: Floats
    translation_upper: Floats
    rounding: Floats
    margin: Floats
    overlap: Floats
    normal: Floats
    point: Floats

    @property
    def value(self) -> Floats:
        """ndarray of shape (N,): ``translation``, infinite for bodies that never meet."""
        return self._or_never(self.translation)

    @property
    def lower(self) -> Floats:
        """ndarray of shape (N,): Proven lower bounds of ``value``."""
        return self._or_never(self.translation_lower)

    @property
    def upper(self) -> Floats:
        """ndarray of shape (N,): Proven upper bounds of ``value``."""
        return self._or_never(self.translation_upper)

    def _or_never(self, column: Floats) -> Floats:
        return np.where(self.outcome == "separated", np.inf, column)

    def _is_row(self, answer: Any, i: int) -> bool:
        record = answer.to_dict()
        told, found = self.translation[i], record.get("translation", np.nan)
        # Rows with the same pair of bodies share data in bulk; a single row runs its own cast.
        # Both answers are valid, each within its rounding.
        same = np.array_equal(told, found, equal_nan=True)
        same = same or abs(told - found) <= 2 * self.rounding[i]
        return bool(same) and self.outcome[i] == record["outcome"]


Columns_ = TypeVar("Columns_", bound=Table[Any])


def concatenate(columns: "Sequence[Columns_]") -> Columns_:
    """Joins columns of the same class in order.

    Parameters
    ----------
    columns : sequence of columns
        At least one, all of one class: the answers of several calls of the same function.

    Returns
    -------
    Columns of the same class

    Raises
    ------
    InputError
        There are no columns, their classes differ, only some have features, or paths are about
        different bodies.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, cast_many
    >>> from colltrans.columns import concatenate
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> one = cast_many(cube, cube, [1, 0, 0], moving_pose=[[-3, 0, 0], [-3, 9, 0]])
    >>> other = cast_many(cube, cube, [0, 0, 1], moving_pose=[0, 0, -4])
    >>> concatenate([one[:1], other]).translation
    array([2., 3.])
    """
    if len({type(each) for each in columns}) != 1:
        kinds = ", ".join(sorted({type(each).__name__ for each in columns})) or "nothing"
        raise InputError(f"cannot join columns of different classes: {kinds}")
    first, ends = columns[0], np.cumsum([len(each) for each in columns])
    if len({tuple(name for name, _ in each._numbers()) for each in columns}) != 1:
        raise InputError("cannot join columns with features and columns without")
    for name in ("outcomes", "bodies"):
        if any(getattr(each, name, ()) != getattr(first, name, ()) for each in columns):
            raise InputError(f"cannot join columns with different {name}")
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
        Proven bounds of the last contact. The bodies never meet beyond the upper one.
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
        The free travel, rounded down, in multiples of the direction; infinite if nothing blocks,
        NaN if the bodies overlap.
    exit : ndarray of shape (N,)
        The translation of the last contact, if it is behind the body or the bodies overlap.
    exit_lower, exit_upper : ndarray of shape (N,)
        Proven bounds of the last contact. The bodies never meet beyond the upper one.
    back, on : ndarray of shape (N,)
        The travel backwards and forwards after which an overlap ends.
    """

    distance: Floats
    exit: Floats
    exit_lower: Floats
    exit_upper: Floats
    back: Floats
    on: Floats

    @property
    def value(self) -> Floats:
        """ndarray of shape (N,): The free travel, ``distance``."""
        return self.distance

    @property
    def lower(self) -> Floats:
        """ndarray of shape (N,): The free travel, which is proven."""
        return self.distance

    @property
    def upper(self) -> Floats:
        """ndarray of shape (N,): Upper bounds of the translation that stops the body."""
        stop = np.maximum(self.translation_upper, 0.0)
        return np.where(self.outcome == "blocked", stop, self.distance)

    _question, _name = staticmethod(_colltrans.clearance), "clearance"
