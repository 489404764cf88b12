"""Answers a table of queries with a table of answers."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from colltrans.bulk.bodies import Bodies, doubled_name, texts_of
from colltrans.bulk.lines import REFUSED
from colltrans.bulk.reads import EVERYTHING, OF_CONVEX, OF_SOLIDS, SCREWS, SIDES, Reads
from colltrans.columns import Table
from colltrans.directions import free_directions_many
from colltrans.errors import InputError
from colltrans.many import cast_many, clearance_many, contact_range_many
from colltrans.motions import motion_clearance_many, motion_many
from colltrans.pairs import depth_many, distance_many, within_many
from colltrans.solids import SolidColumns, solid_casts

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
        The column ``id`` if there is one, kept columns, and the columns of :meth:`Table.to_arrow`.
        A row that cannot be answered has the outcome *error* and a message.

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
    answers = _answers(queries, bodies, options).to_arrow()
    if REFUSED in queries.schema.names:
        told = pc.coalesce(column_of(queries, REFUSED), answers["message"])
        answers = answers.set_column(answers.num_columns - 1, "message", told)
    assert answers.num_rows == queries.num_rows
    kept = names if EVERYTHING in reads.kept else reads.kept
    for name in reversed([*(["id"] if "id" in names else []), *(n for n in kept if n != "id")]):
        if name in answers.schema.names:
            raise InputError(f"the column {name!r} is not kept: the answers have one of this name")
        answers = answers.add_column(0, name, column_of(queries, name))
    return answers


def _answers(queries: Any, bodies: Bodies, options: Options) -> Table[Any]:
    """Converts the columns to arrays and runs the query."""
    names = queries.schema.names
    arguments: dict[str, Any] = {}
    sides: list[Any] = []
    for side in SIDES:
        keys = column_of(queries, side).dictionary_encode()
        if isinstance(keys, pa.ChunkedArray):
            keys = keys.combine_chunks()
        index = keys.indices.fill_null(-1).to_numpy(zero_copy_only=False)
        sides.append(bodies.get(texts_of(keys.dictionary)))
        arguments[f"{side}_index"] = index.astype(np.int64)
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
    rows = column.to_pylist()
    width = next(
        (w for w in widths if any(r is not None and len(r) == w for r in rows)), widths[-1]
    )
    table = np.full((len(rows), width), np.nan)
    for place, row in zip(table, rows, strict=True):
        if row is None and name in SCREWS:
            place[:] = REST
        elif row is None and name != "direction":
            place[:] = (0, 0, 0, 0, 0, 0, 1)[:width]
        elif row is not None and len(row) == width and None not in row:
            place[:] = row
        elif row is not None and len(row) == 3 and width == 7 and None not in row:
            place[:] = (*row, 0, 0, 0, 1)
    return table
