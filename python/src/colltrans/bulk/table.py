"""Answers a table of queries with a table of answers."""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from colltrans.bulk.bodies import Bodies, doubled_name, texts_of
from colltrans.bulk.lines import REFUSED
from colltrans.bulk.reads import EVERYTHING, OF_CONVEX, OF_SOLIDS, SCREWS, SIDES, Reads
from colltrans.errors import ColltransError, InputError, RoundedPoseWarning, as_error
from colltrans.many import cast_many, clearance_many, contact_range_many
from colltrans.motions import motion_clearance_many, motion_many
from colltrans.pairs import depth_many, distance_many, within_many
from colltrans.removal import free_directions_many
from colltrans.solids import SolidColumns, solid_casts
from colltrans.table import Table

QUESTIONS: dict[str, Any] = {
    "contact": cast_many,
    "range": contact_range_many,
    "clearance": clearance_many,
    "distance": distance_many,
    "depth": depth_many,
    "within": within_many,
    "directions": free_directions_many,
    "motion": motion_many,
    "motion_clearance": motion_clearance_many,
}
#: Questions with a direction.
CASTS = ("contact", "range", "clearance")
#: Questions whose answers have features.
FEATURED = (*CASTS, "distance", "motion", "motion_clearance")
#: Questions of moving bodies.
MOTIONS = ("motion", "motion_clearance")
#: A screw without motion, for rows that have none.
REST = (0, 0, 0, 0, 0, 1, 0, 0)
#: A pose without rotation and translation.
IDENTITY = (0, 0, 0, 0, 0, 0, 1)
#: The type of the column ``error``.
NAMES = pa.dictionary(pa.int8(), pa.string())


@dataclass(frozen=True)
class Options:
    """The question of every row, with its options.

    Attributes
    ----------
    question : str
    solver : str
        See :func:`colltrans.cast_many`.
    threads : int or None
        Number of threads; None for all processors.
    keep_columns : tuple of str
        Columns of the queries to copy to the answers; ``"*"`` stands for all.
    features : bool
        Whether to add ``moving_feature`` and ``fixed_feature``; see
        :class:`colltrans.columns.Table`.
    """

    question: Literal[
        "contact",
        "range",
        "clearance",
        "distance",
        "depth",
        "within",
        "directions",
        "motion",
        "motion_clearance",
    ] = "range"
    solver: Literal["auto", "cta", "portal"] = "auto"
    threads: int | None = None
    keep_columns: tuple[str, ...] = ()
    features: bool = False

    def __post_init__(self) -> None:
        if self.features and self.question not in FEATURED:
            told = ", ".join(FEATURED)
            raise InputError(f"features: the question {self.question!r} has none; accepted: {told}")

    def reads(self, solids: bool) -> Reads:
        """Returns the use of the columns, for convex bodies or solids."""
        known = OF_SOLIDS if solids else OF_CONVEX
        if self.question not in known:
            of = " of solids" if solids else ""
            raise InputError(f"unknown question {self.question!r}{of}; known: {', '.join(known)}")
        return Reads(self.question, known[self.question], self.keep_columns)


def answer_table(queries: Any, bodies: Bodies, options: Options = Options()) -> Any:
    """Answers a table of queries.

    Parameters
    ----------
    queries : pyarrow.Table or pyarrow.RecordBatch
        Columns ``moving`` and ``fixed`` (keys of bodies), ``direction`` (3 numbers), and
        optionally ``moving_pose``, ``fixed_pose`` (3 or 7 numbers), ``graze_tolerance``,
        ``min_gap`` and ``id``. *distance*, *depth* and *within* have no ``direction``; *within*
        has ``length``. *motion* and *motion_clearance* have ``moving_screw``, ``fixed_screw``
        or both, with 8 numbers each (point, axis, angle in radians, rise), and optionally
        ``min_gap`` or ``tolerance``. A clearance of solids has ``tolerance`` instead of
        ``graze_tolerance``. *directions* may have ``tolerance``.
    bodies : Bodies
    options : Options

    Returns
    -------
    pyarrow.Table
        The column ``id`` if there is one, kept columns, the columns of :meth:`Table.to_arrow`, and
        ``error``. A row that cannot be answered has the outcome *error*, a message, and the name of
        the class of its exception as ``error``, for example ``"BuildError"`` for a body.

    Raises
    ------
    InputError
        A column is missing, has the wrong type, or is neither read nor kept.
    """
    reads = options.reads(bodies.solids)
    if (doubled := doubled_name(queries.schema.names)) is not None:
        raise InputError(f"the queries have the column {doubled!r} twice")
    names = [name for name in queries.schema.names if name != REFUSED]
    if (stray := reads.stray(names)) is not None:
        raise InputError(stray)
    parts = [_answered(part, bodies, options) for part in _fitting(queries, bodies)]
    answers = pa.concat_tables(parts) if len(parts) > 1 else parts[0]
    assert answers.num_rows == queries.num_rows
    kept = names if EVERYTHING in reads.kept else reads.kept
    for name in reversed([*(["id"] if "id" in names else []), *(n for n in kept if n != "id")]):
        if name in answers.schema.names:
            raise InputError(f"the column {name!r} is not kept: the answers have one of this name")
        answers = answers.add_column(0, name, column_of(queries, name))
    return answers


def failed_table(queries: Any, error: ColltransError, bodies: Bodies, options: Options) -> Any:
    """Returns the answers of queries that all fail with the same error.

    Columns ``id`` and kept columns are copied if the queries have them once.
    """
    names = queries.schema.names
    told = _failed(queries.num_rows, error, bodies, options)
    kept = names if EVERYTHING in options.keep_columns else ("id", *options.keep_columns)
    known = (*told.schema.names, REFUSED)
    copied = [name for name in kept if names.count(name) == 1 and name not in known]
    for name in reversed(copied):
        told = told.add_column(0, name, queries.column(name))
    return told


def _failed(n: int, error: ColltransError, bodies: Bodies, options: Options) -> Any:
    """Returns the answers of `n` rows with the same error, without kept columns."""
    none = pa.table({side: pa.nulls(0, pa.string()) for side in SIDES} | _blank(options))
    schema = _answered(none, bodies, options).schema
    columns = {field.name: pa.nulls(n, field.type) for field in schema}
    outcomes = pa.array(["error"] * n, pa.string()).dictionary_encode()
    columns["outcome"] = outcomes.cast(schema.field("outcome").type)
    columns["message"] = pa.array([str(error)] * n, pa.string())
    columns["error"] = _names(dict.fromkeys(range(n), type(error).__name__), n)
    return pa.table(columns)


def _blank(options: Options) -> dict[str, Any]:
    """Returns the columns that a question needs besides the bodies, without rows."""
    if options.question in CASTS:
        return {"direction": pa.nulls(0, pa.list_(pa.float64(), 3))}
    if options.question == "within":
        return {"length": pa.nulls(0, pa.float64())}
    if options.question in MOTIONS:
        return {SCREWS[0]: pa.nulls(0, pa.list_(pa.float64(), 8))}
    return {}


def _fitting(queries: Any, bodies: Bodies) -> Iterator[Any]:
    """Yields consecutive rows whose bodies together have about the size of the cache at most."""
    if bodies.all_fit():
        yield queries
        return
    keys, indices = _keys_of(queries)
    sizes = bodies.sizes(keys)
    if sum(sizes) <= bodies.cache_bytes:
        yield queries
        return
    begin, held, size = 0, set[int](), 0
    for row, pair in enumerate(zip(*indices, strict=True)):
        more = {which for which in pair if which not in held}
        if (
            needed := sum(sizes[which] for which in more)
        ) + size > bodies.cache_bytes and row > begin:
            yield queries.slice(begin, row - begin)
            begin, held, size = row, set(), 0
            more, needed = set(pair), sum(sizes[which] for which in set(pair))
        held |= more
        size += needed
    yield queries.slice(begin)


def _keys_of(queries: Any) -> tuple[list[str | None], list[Any]]:
    """Returns the keys of all bodies, and for both sides the index of the key of each row."""
    keys: list[str | None] = [None]
    indices = []
    for side in SIDES:
        of_side, index = _encoded(queries, side)
        indices.append((index + len(keys)).tolist() if len(of_side) else [0] * len(index))
        keys += of_side
    return keys, indices


def _answered(queries: Any, bodies: Bodies, options: Options) -> Any:
    """Answers rows. A panic of the extension is the error of the rows that cause it.

    These rows are found by bisection.
    """
    try:
        return _told(queries, _answers(queries, bodies, options))
    except (ColltransError, MemoryError):
        raise
    except BaseException as panic:
        error, n = as_error(panic, "a fault of this package"), queries.num_rows
        if n == 0:
            raise error from panic
    if n == 1:
        return _failed(1, error, bodies, options)
    halves = (queries.slice(0, n // 2), queries.slice(n // 2))
    return pa.concat_tables([_answered(half, bodies, options) for half in halves])


def _told(queries: Any, found: Table[Any]) -> Any:
    """Converts answers to a table with the columns ``error`` and ``message`` at its end."""
    answers, errors = found.to_arrow(), _errors(found)
    if REFUSED in queries.schema.names:
        refused = column_of(queries, REFUSED)
        if refused.null_count < len(refused):
            told = pc.coalesce(refused, answers["message"])
            answers = answers.set_column(answers.num_columns - 1, "message", told)
            rows = np.flatnonzero(np.asarray(refused.is_valid()))
            errors |= dict.fromkeys(rows.tolist(), InputError.__name__)
    return answers.add_column(answers.num_columns - 1, "error", _names(errors, len(found)))


def _errors(found: Table[Any]) -> dict[int, str]:
    """Returns the name of the class of the error of each row without an answer.

    The extension reports messages only, so the first row with each message is queried again.
    """
    known: dict[str, str] = {}
    names = {}
    for row, message in found.errors.items():
        if message not in known:
            known[message] = _error_of(found, row)
        names[row] = known[message]
    return names


def _error_of(found: Table[Any], row: int) -> str:
    queries = found._queries
    for bodies, index in zip(queries.bodies, queries.indices, strict=True):
        which = 0 if index is None else int(index[row])
        if which >= 0 and isinstance(bodies[which], Exception):
            return type(bodies[which]).__name__
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RoundedPoseWarning)
            queries.ask(type(found)._question, row)
    except ColltransError as error:
        return type(error).__name__
    return ColltransError.__name__


def _names(errors: dict[int, str], n: int) -> Any:
    """Returns the column ``error``."""
    if not errors:
        return pa.nulls(n, NAMES)
    return pa.array(map(errors.get, range(n)), pa.string()).dictionary_encode().cast(NAMES)


def _answers(queries: Any, bodies: Bodies, options: Options) -> Table[Any]:
    """Converts the columns to arrays and runs the query."""
    names = queries.schema.names
    arguments: dict[str, Any] = {}
    sides: list[Any] = []
    for side in SIDES:
        keys, arguments[f"{side}_index"] = _encoded(queries, side)
        sides.append(bodies.get(keys))
        if f"{side}_pose" in names:
            arguments[f"{side}_pose"] = _vectors(queries, f"{side}_pose", (7, 3))
    if options.question in MOTIONS:
        arguments |= _motion(queries)
    elif options.question == "within":
        sides.append(_numbers_of(queries, "length", np.nan))
    elif options.question in CASTS:
        sides.append(_vectors(queries, "direction", (3,)))
        if bodies.solids:
            return _solid_clearances(queries, sides, arguments, options)
        arguments["solver"] = options.solver
        for name in {"graze_tolerance", "min_gap"} & set(names):
            arguments[name] = _numbers_of(queries, name, 0.0)
    elif options.question == "directions" and "tolerance" in names:
        arguments["tolerance"] = _numbers_of(queries, "tolerance", np.nan)
    if options.features:
        arguments["features"] = True
    columns: Table[Any] = QUESTIONS[options.question](*sides, **arguments, threads=options.threads)
    return columns


def _encoded(queries: Any, side: str) -> tuple[list[str | None], Any]:
    """Returns the distinct keys of a side, and the index of the key of each row; -1 for a null."""
    keys = column_of(queries, side).dictionary_encode()
    if isinstance(keys, pa.ChunkedArray):
        keys = keys.combine_chunks()
    index = keys.indices.fill_null(-1).to_numpy(zero_copy_only=False)
    return texts_of(keys.dictionary), index.astype(np.int64)


def _motion(queries: Any) -> dict[str, Any]:
    """Returns the motions of the bodies in each row."""
    names = queries.schema.names
    screws = [name for name in SCREWS if name in names]
    if not screws:
        raise InputError(f"the queries have neither {' nor '.join(SCREWS)}")
    found: dict[str, Any] = {"moving_motion": None}
    for name in screws:
        table = _vectors(queries, name, (8,))
        numbers = {"point": table[:, :3], "axis": table[:, 3:6]}
        numbers |= {"radians": table[:, 6], "rise": table[:, 7]}
        found[name.replace("screw", "motion")] = {"screw": numbers}
    for name, missing in {"min_gap": 0.0, "tolerance": np.nan}.items():
        if name in names:
            found[name] = _numbers_of(queries, name, missing)
    return found


def _solid_clearances(
    queries: Any, sides: list[Any], arguments: dict[str, Any], options: Options
) -> Table[Any]:
    """Answers clearances as solids, with the same columns even if no body could be built."""
    names = queries.schema.names
    moving, fixed, direction = sides
    asked = solid_casts(
        (moving, fixed),
        direction,
        (arguments.get("moving_pose"), arguments.get("fixed_pose")),
        (arguments["moving_index"], arguments["fixed_index"]),
        min_gap=_numbers_of(queries, "min_gap", 0.0) if "min_gap" in names else 0.0,
        tolerance=_numbers_of(queries, "tolerance", np.nan) if "tolerance" in names else None,
        ignore_start_overlaps=False,
    )
    return SolidColumns._ask(asked, options.features, options.threads)


def column_of(queries: Any, name: str) -> Any:
    if name not in queries.schema.names:
        raise InputError(f"the queries have no column {name!r}")
    return queries.column(name)


def _numbers_of(queries: Any, name: str, missing: float) -> np.ndarray[Any, Any]:
    column = column_of(queries, name)
    if not _is_number(column.type):
        raise InputError(f"the column {name!r} has {column.type}, not numbers")
    return np.asarray(column.cast(pa.float64()).fill_null(missing), dtype=float)


def _is_number(kind: Any) -> bool:
    return any(of(kind) for of in (pa.types.is_floating, pa.types.is_integer, pa.types.is_null))


def _is_list(kind: Any) -> bool:
    return any(
        of(kind) for of in (pa.types.is_list, pa.types.is_large_list, pa.types.is_fixed_size_list)
    )


def _vectors(queries: Any, name: str, widths: tuple[int, ...]) -> np.ndarray[Any, Any]:
    """Converts lists of numbers to a table; invalid rows and rows of other lengths are NaN."""
    column = column_of(queries, name)
    if isinstance(column, pa.ChunkedArray):
        column = column.combine_chunks()
    kind = column.type
    if not (pa.types.is_null(kind) or (_is_list(kind) and _is_number(kind.value_type))):
        raise InputError(f"the column {name!r} has {kind}, not lists of numbers")
    if pa.types.is_fixed_size_list(kind) and column.null_count == 0:
        if kind.list_size not in widths:
            raise InputError(f"the column {name!r} has lists of {kind.list_size} numbers")
        flat = column.flatten()
        if flat.null_count == 0:
            return np.asarray(flat, dtype=float).reshape(-1, kind.list_size)
    if pa.types.is_null(kind):
        column = column.cast(pa.list_(pa.float64()))
    lengths = pc.list_value_length(column).fill_null(-1).to_numpy(zero_copy_only=False)
    width = next((w for w in widths if (lengths == w).any()), widths[-1])
    numbers = column.flatten()
    flat = np.asarray(numbers.to_numpy(zero_copy_only=False), dtype=float)
    starts = np.cumsum(np.maximum(lengths, 0)) - np.maximum(lengths, 0)
    if (lengths == width).all():
        table = flat.reshape(-1, width)
    else:
        table = np.full((len(lengths), width), np.nan)
        for length in {width, 3} if width == 7 else {width}:
            rows = np.flatnonzero(lengths == length)
            table[rows, :length] = flat[starts[rows, None] + np.arange(length)]
            table[rows, length:] = IDENTITY[length:width]
        if name != "direction":
            table[lengths == -1] = REST if name in SCREWS else IDENTITY[:width]
    if numbers.null_count:
        table = table.copy()
        holes = np.asarray(numbers.is_null()).nonzero()[0]
        table[np.searchsorted(starts + np.maximum(lengths, 0), holes, side="right")] = np.nan
    return table
