"""Queries in bulk: arrays in, columns out.

Arguments have one row for all queries or one for each; bodies are one for all, or a list with an
index for each. Rows are answered on all cores, without the interpreter's lock; each has the bits of
the query asked alone. A row without an answer has the outcome ``"error"`` and a message.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Literal, TypeAlias, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from colltrans import _arrays, _colltrans
from colltrans._colltrans import (
    Behind,
    Blocked,
    Contact,
    ContactRange,
    ConvexPolyhedron,
    Grazing,
    Overlapping,
    Pose,
    Separated,
    Slides,
    Solid,
)
from colltrans.errors import ColltransError, InputError

if TYPE_CHECKING:
    import pandas
    import pyarrow

    from colltrans._colltrans import HasMatrix

Floats: TypeAlias = NDArray[np.float64]
Bodies: TypeAlias = "ConvexPolyhedron | Sequence[ConvexPolyhedron | ColltransError]"
AnyBodies: TypeAlias = (
    "ConvexPolyhedron | Solid | Sequence[ConvexPolyhedron | Solid | ColltransError]"
)
Poses: TypeAlias = "ArrayLike | Pose | HasMatrix | None"
Solver: TypeAlias = Literal["auto", "cta", "portal"]
Question: TypeAlias = Literal["contact", "range", "clearance"]
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


@dataclass(frozen=True)
class _Queries:
    """What was asked: tables with one row or as many as there are queries."""

    bodies: tuple[list[Any], list[Any]]
    indices: tuple[NDArray[np.int64] | None, NDArray[np.int64] | None]
    direction: Floats
    poses: tuple[Floats, Floats]
    graze_tolerance: Floats
    solver: Solver
    count: int

    def ask_all(self, question: Question, threads: int | None) -> dict[str, Any]:
        (moving, fixed), (moving_index, fixed_index) = self.bodies, self.indices
        columns, outcomes, errors = _colltrans.ask_many(
            self.count,
            question,
            (moving, moving_index),
            (fixed, fixed_index),
            self.direction,
            *self.poses,
            self.graze_tolerance,
            self.solver,
            threads,
        )
        return {**columns, "outcomes": tuple(outcomes), "errors": errors, "_queries": self}

    def ask(self, question: Any, i: int) -> Any:
        """One of them, alone."""
        tolerance = float(row_of(self.graze_tolerance, i)[0])
        return self.ask_with(question, i, graze_tolerance=tolerance, solver=self.solver)

    def ask_with(self, question: Any, i: int, **choices: Any) -> Any:
        """One of them, alone, with the choices that its kind has."""
        moving, fixed = (
            bodies[0 if index is None else index[i]]
            for bodies, index in zip(self.bodies, self.indices, strict=True)
        )
        return question(
            moving,
            fixed,
            row_of(self.direction, i),
            moving_pose=row_of(self.poses[0], i),
            fixed_pose=row_of(self.poses[1], i),
            **choices,
        )


def row_of(table: Floats, i: int) -> Floats:
    """A row of a table of one for all or one for each; a matrix as one."""
    values: Floats = table[i if len(table) > 1 else 0]
    return values.reshape(-1, 4) if values.size > 7 else values


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
        i = range(len(self))[i]
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
class Columns(Table[Answer_co]):
    """Answers about convex bodies as columns; see :class:`Table`.

    Attributes
    ----------
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the moving body to the fixed one.
    point : ndarray of shape (N, 3)
        Contact points, in the world.
    lower, upper : ndarray of shape (N,)
        Proven bounds of the translation, in multiples of the direction.
    translation : ndarray of shape (N,)
        Of the first contact, in multiples of the direction.
    tolerance : ndarray of shape (N,)
        What rounding can make of ``upper - lower``.
    margin : ndarray of shape (N,)
        How far the shadows are apart, a length; negative where they overlap and graze.
    """

    translation: Floats
    lower: Floats
    upper: Floats
    tolerance: Floats
    margin: Floats
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
    """

    exit: Floats

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
    back, on : ndarray of shape (N,)
        How far a body that overlaps has to go, back or on, until it does not.
    """

    distance: Floats
    exit: Floats
    back: Floats
    on: Floats

    _question = staticmethod(_colltrans.clearance)


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
    solver: Solver = "auto",
    threads: int | None = None,
) -> ContactColumns:
    """:func:`cast` for every row.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron or sequence of them
        One for all rows; or a list, with an index for each row, or with a body for each row. An
        exception in the list stands for a body that could not be built: its rows are errors.
    direction : array_like of shape (3,) or (N, 3)
        Of the world, of any length; translations count in multiples of it.
    moving_pose, fixed_pose : array_like, Pose or object with ``as_matrix()``, optional
        One for all, of shape (3,), (7,), (3, 4) or (4, 4), or one for each row, of shape (N, 3),
        (N, 7), (N, 3, 4) or (N, 4, 4); see :class:`Pose`.
    moving_index, fixed_index : array_like of int, shape (N,), optional
        Which of the bodies.
    graze_tolerance : float or array_like of shape (N,)
        Sideways overlaps up to this length count as grazing. 0 stands for rounding error.
    solver : {"auto", "cta", "portal"}
        How the search is narrowed. Answers are the same.
    threads : int, optional
        By default all cores that this process may use. The bits do not depend on it.

    Returns
    -------
    ContactColumns

    Raises
    ------
    InputError
        Arrays whose shapes do not go together. Wrong numbers in a row are errors of that row.

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
    poses, indices = (moving_pose, fixed_pose), (moving_index, fixed_index)
    _refuse_solids(moving, fixed)
    queries = _queries((moving, fixed), direction, poses, indices, graze_tolerance, solver)
    return ContactColumns(**queries.ask_all("contact", _threads(threads)))


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
    solver: Solver = "auto",
    threads: int | None = None,
) -> RangeColumns:
    """:func:`contact_range` for every row: first and last contact.

    Parameters
    ----------
    moving, fixed, direction, moving_pose, fixed_pose, moving_index, fixed_index
        As for :func:`cast_many`.
    graze_tolerance, solver, threads
        As for :func:`cast_many`.

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
    _refuse_solids(moving, fixed)
    queries = _queries((moving, fixed), direction, poses, indices, graze_tolerance, solver)
    return RangeColumns(**queries.ask_all("range", _threads(threads)))


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
    solver: Solver = "auto",
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
    solver: Solver = "auto",
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> "SolidColumns": ...
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
    solver: Solver = "auto",
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> "SolidColumns": ...
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
    solver: Solver = "auto",
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> "ClearanceColumns | SolidColumns": ...
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
    solver: Solver = "auto",
    threads: int | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
) -> "ClearanceColumns | SolidColumns":
    """:func:`clearance` for every row: how far from here, and what stops it.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron, Solid or sequence of them
        As for :func:`cast_many`. If one of them is a solid, all rows are asked as solids.
    direction, moving_pose, fixed_pose, moving_index, fixed_index
        As for :func:`cast_many`.
    graze_tolerance, solver, threads
        As for :func:`cast_many`.
    tolerance : float or array_like of shape (N,), optional
        Of solids, as for :class:`SolidCast`.
    ignore_start_overlaps : bool
        Of solids, as for :class:`SolidCast`.

    Returns
    -------
    ClearanceColumns or SolidColumns

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, clearance_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> clearance_many(cube, cube, [[0, 0, -1], [1, 0, 0]], moving_pose=[0, 0, 1]).distance
    array([ 0., inf])
    """
    bodies, indices = (moving, fixed), (moving_index, fixed_index)
    poses = (moving_pose, fixed_pose)
    if any(isinstance(body, Solid) for side in bodies for body in _listed(side)):
        if np.any(graze_tolerance):
            raise InputError("graze_tolerance: is for convex bodies; solids have tolerance")
        tolerances = None if tolerance is None else _column(tolerance, "tolerance")
        asked = _queries(bodies, direction, poses, indices, 0.0, solver, tolerances)
        return ask_solids(asked, tolerances, ignore_start_overlaps, _threads(threads))
    if tolerance is not None or ignore_start_overlaps:
        raise InputError("tolerance, ignore_start_overlaps: are for solids")
    queries = _queries(bodies, direction, poses, indices, graze_tolerance, solver)
    return ClearanceColumns(**queries.ask_all("clearance", _threads(threads)))


def _refuse_solids(*sides: Any) -> None:
    if any(isinstance(body, Solid) for side in sides for body in _listed(side)):
        raise TypeError("solids are asked for their clearance: clearance_many")


def _listed(bodies: Any) -> Any:
    return [bodies] if isinstance(bodies, (ConvexPolyhedron, Solid)) else bodies


def _queries(
    bodies: tuple[AnyBodies, AnyBodies],
    direction: ArrayLike,
    poses: tuple[Poses, Poses],
    indices: tuple[ArrayLike | None, ArrayLike | None],
    graze_tolerance: ArrayLike,
    solver: Solver,
    tolerance: Floats | None = None,
) -> _Queries:
    """All arguments as tables, and how many rows they have together."""
    moving_bodies, moving_index = _body_list(bodies[0], indices[0], "moving")
    fixed_bodies, fixed_index = _body_list(bodies[1], indices[1], "fixed")
    tables = {
        "direction": _table(direction, "direction", 3),
        "moving_pose": _pose_table(poses[0], "moving_pose"),
        "fixed_pose": _pose_table(poses[1], "fixed_pose"),
        "graze_tolerance": _column(graze_tolerance, "graze_tolerance"),
        "tolerance": np.zeros((1, 1)) if tolerance is None else tolerance,
    }
    rows = {name: len(table) for name, table in tables.items() if len(table) != 1}
    for name, index in (("moving_index", moving_index), ("fixed_index", fixed_index)):
        if index is not None:
            rows[name] = len(index)
    if len(set(rows.values())) > 1:
        found = ", ".join(f"{name} has {n} rows" for name, n in rows.items())
        raise InputError(f"arguments of different lengths: {found}")
    return _Queries(
        bodies=(moving_bodies, fixed_bodies),
        indices=(moving_index, fixed_index),
        direction=tables["direction"],
        poses=(tables["moving_pose"], tables["fixed_pose"]),
        graze_tolerance=tables["graze_tolerance"],
        solver=solver,
        count=next(iter(rows.values()), 1),
    )


def _body_list(
    bodies: AnyBodies, index: ArrayLike | None, name: str
) -> tuple[list[Any], NDArray[np.int64] | None]:
    alone = isinstance(bodies, (ConvexPolyhedron, Solid))
    all_bodies: list[Any] = list(_listed(bodies))
    for body in all_bodies:
        if not isinstance(body, (ConvexPolyhedron, Solid, Exception)):
            raise TypeError(f"{name}: not a ConvexPolyhedron, but {type(body).__name__}")
    if index is None:
        return all_bodies, None if alone else np.arange(len(all_bodies))
    found = np.asarray(index)
    if found.ndim != 1 or (found.size > 0 and found.dtype.kind not in "iu"):
        raise InputError(f"{name}_index: no row of whole numbers")
    if found.dtype == np.uint64 and found.size > 0 and found.max() > np.iinfo(np.int64).max:
        raise InputError(f"{name}_index: {found.max()} is too large")
    return all_bodies, np.require(found, np.int64, ["C", "A"])


def _table(values: ArrayLike, name: str, width: int) -> Floats:
    array = _arrays.floats(values, name)
    if array.ndim == 1:
        array = array.reshape(1, -1)
    if array.ndim != 2 or array.shape[1] != width:
        shape = np.shape(values)
        raise InputError(f"{name}: an array of shape {shape}, not ({width},) or (N, {width})")
    return array


def _column(values: ArrayLike, name: str) -> Floats:
    array = _arrays.floats(values, name)
    if np.ndim(values) > 1:
        raise InputError(f"{name}: an array of shape {np.shape(values)}, not a number or (N,)")
    return array.reshape(-1, 1)


def _pose_table(values: Poses, name: str) -> Floats:
    if values is None:
        return np.zeros((1, 3))
    matrices = hasattr(values, "as_matrix")
    array = _arrays.floats(values.as_matrix() if matrices else values, name)  # type: ignore[union-attr]
    if matrices and array.shape[-2:] == (3, 3):
        array = np.concatenate([array, np.zeros((*array.shape[:-1], 1))], axis=-1)
    shape = array.shape
    if shape in ((3, 4), (4, 4)):
        return array.reshape(1, -1)
    if len(shape) == 3 and shape[1:] in ((3, 4), (4, 4)):
        return array.reshape(len(array), -1)
    if len(shape) in (1, 2) and shape[-1] in (3, 7):
        return array.reshape(-1, shape[-1])
    raise InputError(
        f"{name}: an array of shape {shape}, not (3,), (7,), (3, 4) or (4, 4), "
        "nor a row of that for each query"
    )


def _threads(threads: int | None) -> int | None:
    if threads is not None and (not isinstance(threads, (int, np.integer)) or threads < 1):
        raise InputError(f"threads: {threads!r} is not a whole number from 1")
    return None if threads is None else int(threads)


# They are tables too, so they come last.
from colltrans.solids import SolidColumns, ask_solids  # noqa: E402
