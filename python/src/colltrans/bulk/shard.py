"""A file of queries to a file of answers.

Invariant: an answer file has its name only when it is whole. It is written under another name
beside its place and renamed; its metadata say what it answers (the queries' bytes, the bodies, the
choices, the version), so a second run knows which are done, and two that answer the same shard do
no harm.
"""

import hashlib
import json
import os
import uuid
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import version
from itertools import islice
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from colltrans.bulk.bodies import Bodies, file_digest
from colltrans.columns import Table
from colltrans.errors import ColltransError, InputError
from colltrans.many import cast_many, clearance_many, contact_range_many
from colltrans.motions import motion_many
from colltrans.pairs import depth_many, distance_many, within_many

#: Of bodies where they are, without a direction.
PLACED: dict[str, Any] = {"distance": distance_many, "depth": depth_many, "within": within_many}
QUESTIONS: dict[str, Any] = {
    "contact": cast_many,
    "range": contact_range_many,
    "clearance": clearance_many,
    **PLACED,
    "motion": motion_many,
}
#: Rows that are in memory at once.
BATCH = 65_536
FINGERPRINT = b"colltrans"
#: The column of why a line is no query.
REFUSED = "colltrans: refused"


@dataclass(frozen=True)
class Options:
    """What is asked of every row."""

    question: Literal["contact", "range", "clearance", "distance", "depth", "within", "motion"] = (
        "range"
    )
    solver: Literal["auto", "cta", "portal"] = "auto"
    threads: int | None = None


@dataclass(frozen=True)
class Job:
    """One shard: where its queries are and where its answers go."""

    queries: str
    answers: str
    options: Options


@dataclass(frozen=True)
class Report:
    """What became of a shard."""

    job: Job
    rows: int
    errors: int
    skipped: bool


def answer_table(queries: Any, bodies: Bodies, options: Options = Options()) -> Any:
    """Answers of a table of queries.

    Parameters
    ----------
    queries : pyarrow.Table or pyarrow.RecordBatch
        Columns ``moving`` and ``fixed`` (keys of bodies), ``direction`` (3 numbers), and, if there
        are any, ``moving_pose``, ``fixed_pose`` (3 or 7 numbers), ``graze_tolerance``, ``keep`` and
        ``id``. A distance, a depth and *within* have no ``direction``, the last has ``length``. A
        motion has ``moving_screw``, ``fixed_screw`` or both, 8 numbers each: a point and the axis,
        the angle in radians and the rise; and ``keep``, if there is one.
    bodies : Bodies
    options : Options

    Returns
    -------
    pyarrow.Table
        The column ``id``, if there is one, and those of :meth:`Table.to_arrow`. A row that cannot
        be answered has the outcome *error* and a message.
    """
    count = queries.num_rows
    arguments: dict[str, Any] = {"threads": options.threads}
    sides: list[Any] = []
    for side in ("moving", "fixed"):
        keys = _column(queries, side).dictionary_encode()
        if isinstance(keys, pa.ChunkedArray):
            keys = keys.combine_chunks()
        index = keys.indices.fill_null(-1).to_numpy(zero_copy_only=False)
        sides.append(bodies.get(keys.dictionary.to_pylist()))
        arguments[f"{side}_index"] = index.astype(np.int64)
        if f"{side}_pose" in queries.schema.names:
            arguments[f"{side}_pose"] = _vectors(queries, f"{side}_pose", (7, 3))
    if options.question == "motion":
        screws = [name for name in SCREWS if name in queries.schema.names]
        if not screws:
            raise InputError(f"the queries have neither {' nor '.join(SCREWS)}")
        for name in screws:
            motion = _screws(_vectors(queries, name, (8,)))
            arguments[name.replace("screw", "motion")] = {"screw": motion}
        arguments.setdefault("moving_motion", None)
        if "keep" in queries.schema.names:
            arguments["keep"] = _numbers_of(queries, "keep", 0.0)
    elif options.question == "within":
        sides.append(_numbers_of(queries, "length", np.nan))
    elif options.question not in PLACED:
        arguments["solver"] = options.solver
        sides.append(_vectors(queries, "direction", (3,)))
        for name in {"graze_tolerance", "keep"} & set(queries.schema.names):
            arguments[name] = _numbers_of(queries, name, 0.0)
    columns: Table[Any] = QUESTIONS[options.question](*sides, **arguments)
    answers = columns.to_arrow()
    if REFUSED in queries.schema.names:
        told = pc.coalesce(_column(queries, REFUSED), answers["message"])
        answers = answers.set_column(answers.num_columns - 1, "message", told)
    if "id" in queries.schema.names:
        answers = answers.add_column(0, "id", _column(queries, "id"))
    assert answers.num_rows == count
    return answers


def _screws(table: np.ndarray[Any, Any]) -> dict[str, np.ndarray[Any, Any]]:
    return {
        "point": table[:, :3],
        "axis": table[:, 3:6],
        "angle": table[:, 6],
        "rise": table[:, 7],
    }


def _column(queries: Any, name: str) -> Any:
    if name not in queries.schema.names:
        raise InputError(f"the queries have no column {name!r}")
    return queries.column(name)


def _numbers_of(queries: Any, name: str, missing: float) -> np.ndarray[Any, Any]:
    column = _column(queries, name)
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
    """Lists of numbers as a table; rows that are none, or of another length, are NaN."""
    column = _column(queries, name)
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


def answer_shard(
    job: Job, bodies: Bodies, progress: Callable[[int], None] = lambda rows: None
) -> Report:
    """Answers a shard, unless that has been done.

    Parameters
    ----------
    job : Job
    bodies : Bodies
    progress : callable
        Called with the number of rows that have been answered since it was called last.

    Returns
    -------
    Report
    """
    try:
        return _answered(job, bodies, progress)
    except (ColltransError, pa.ArrowException) as error:
        raise ColltransError(f"{job.queries}: {error}") from error


def _answered(job: Job, bodies: Bodies, progress: Callable[[int], None]) -> Report:
    fingerprint = _fingerprint(job, bodies)
    target = Path(job.answers)
    done = _report_of(job, fingerprint)
    if done is not None:
        progress(done.rows)
        return done
    target.parent.mkdir(parents=True, exist_ok=True)
    partial = target.with_name(f".{target.name}.{uuid.uuid4().hex}.partial")
    writer, rows, errors = None, 0, 0
    try:
        for batch in _batches(Path(job.queries)):
            answers = answer_table(batch, bodies, job.options)
            if writer is None:
                schema = answers.schema.with_metadata({FINGERPRINT: fingerprint})
                dictionaries = ["outcome", "message"]
                writer = pq.ParquetWriter(partial, schema, use_dictionary=dictionaries)
            writer.write_table(answers.cast(schema))
            rows += answers.num_rows
            errors += answers.num_rows - answers["message"].null_count
            progress(answers.num_rows)
        assert writer is not None
        writer.add_key_value_metadata({"rows": str(rows), "errors": str(errors)})
        writer.close()
        writer = None
        os.replace(partial, target)
    finally:
        if writer is not None:
            writer.close()
        partial.unlink(missing_ok=True)
    return Report(job, rows, errors, skipped=False)


def _report_of(job: Job, fingerprint: str) -> Report | None:
    """Of a shard that has been answered already."""
    try:
        metadata = pq.read_metadata(job.answers).metadata or {}
    except (OSError, pa.ArrowInvalid):
        return None
    if metadata.get(FINGERPRINT) != fingerprint.encode():
        return None
    return Report(job, int(metadata[b"rows"]), int(metadata[b"errors"]), skipped=True)


def _fingerprint(job: Job, bodies: Bodies) -> str:
    options = {k: v for k, v in asdict(job.options).items() if k != "threads"}
    keys = set() if bodies.table else _keys(Path(job.queries))
    told = {
        "version": version("colltrans"),
        "queries": file_digest(job.queries),
        "bodies": bodies.digest(keys),
        "hull": bodies.hull,
        **options,
    }
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def _keys(path: Path) -> set[str]:
    """The keys of all bodies of a file."""
    keys: set[str] = set()
    for batch in _batches(path, ["moving", "fixed"]):
        for side in ("moving", "fixed"):
            keys.update(filter(None, _column(batch, side).unique().to_pylist()))
    return keys


def _batches(path: Path, columns: list[str] | None = None) -> Iterator[Any]:
    """The queries of a file; of one without any an empty batch, which has its columns."""
    if path.suffix == ".parquet":
        with pq.ParquetFile(path) as file:
            if file.metadata.num_rows == 0:
                yield file.schema_arrow.empty_table()
            yield from file.iter_batches(BATCH, columns=columns)
        return
    with path.open("rb") as file:
        lines = ((number, line) for number, line in enumerate(file, 1) if line.strip())
        rows = [_row(line, number) for number, line in islice(lines, BATCH)]
        yield _table(rows)
        while rows := [_row(line, number) for number, line in islice(lines, BATCH)]:
            yield _table(rows)


SIDES = ("moving", "fixed")
#: Lists of numbers, and how many there may be.
LISTS = {
    "direction": (3,),
    "moving_pose": (3, 7),
    "fixed_pose": (3, 7),
    "moving_screw": (8,),
    "fixed_screw": (8,),
}
SCREWS = ("moving_screw", "fixed_screw")
#: A screw that moves nothing: what a row without one does.
REST = (0, 0, 0, 0, 0, 1, 0, 0)
NUMBERS = ("graze_tolerance", "keep", "length")
FIELDS = {"id", *SIDES, *LISTS, *NUMBERS}
#: A screw or a turn as `colltrans batch` reads it, by the fields that follow each other.
MOTIONS = {"moving_motion": "moving_screw", "fixed_motion": "fixed_screw"}


def _row(line: bytes, number: int) -> dict[str, Any]:
    """A query of a line; of one that is none why it is refused."""
    row = None
    try:
        row = json.loads(line)
        return {"id": _id_of(row), **_query(row)}
    except (ValueError, OverflowError, RecursionError) as error:
        return {"id": _id_of(row), REFUSED: f"line {number}: {error}"}


def _id_of(row: Any) -> str | None:
    found = row.get("id") if isinstance(row, dict) else None
    return None if found is None else str(found).encode(errors="replace").decode()


def _query(row: Any) -> dict[str, Any]:
    """What a line asks. What it asks beside that is refused, for its answer would be another."""
    if not isinstance(row, dict):
        raise ValueError("no object")
    row = {MOTIONS.get(name, name): _plain(value, name) for name, value in row.items()}
    for name in row.keys() - FIELDS:
        raise ValueError(f"the field {name!r} is not for files in bulk")
    query: dict[str, Any] = {side: _key(row.get(side), side) for side in SIDES}
    for name, counts in LISTS.items():
        if row.get(name) is not None:
            query[name] = _numbers(row[name], name)
            if len(query[name]) not in counts:
                raise ValueError(f"{name}: {len(query[name])} numbers")
    for name in NUMBERS:
        if row.get(name) is not None:
            (query[name],) = _numbers([row[name]], name)
    return query


def _plain(value: Any, name: str) -> Any:
    """A motion as the numbers of its screw; anything else as it is."""
    if name not in MOTIONS:
        return value
    kind = next(iter(value)) if isinstance(value, dict) and len(value) == 1 else None
    if kind not in ("screw", "turn") or not isinstance(value[kind], dict):
        raise ValueError(f'{name}: no {{"screw": ...}} and no {{"turn": ...}}')
    fields = {"rise": 0.0, **value[kind]} if kind == "turn" else value[kind]
    if fields.keys() != {"point", "axis", "angle", "rise"}:
        raise ValueError(f"{name}: {kind!r} has other fields")
    point, axis = (_numbers(fields[part], f"{name}.{part}") for part in ("point", "axis"))
    rest = _numbers([fields["angle"], fields["rise"]], f"{name}.angle")
    if (len(point), len(axis)) != (3, 3):
        raise ValueError(f"{name}: a point and an axis have three numbers each")
    return [*point, *axis, *rest]


def _key(value: Any, side: str) -> str:
    if isinstance(value, dict) and value.keys() == {"mesh"}:  # As `colltrans batch` reads it.
        value = value["mesh"]
    if not isinstance(value, str):
        raise ValueError(f'{side}: a body is a key, or an object with nothing but "mesh"')
    value.encode()
    return value


def _numbers(value: Any, name: str) -> list[float]:
    if name in LISTS and isinstance(value, dict):  # A pose as `colltrans batch` reads it.
        parts = {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1]}
        if name == "direction" or value.keys() - parts.keys():
            raise ValueError(f"{name}: no list of numbers, and no pose")
        each = {**parts, **value}
        place, turn = (_numbers(part, f"{name}.{of}") for of, part in each.items())
        if (len(place), len(turn)) != (3, 4):
            raise ValueError(f"{name}: {len(place)} and {len(turn)} numbers, not 3 and 4")
        return place + turn
    if not isinstance(value, list) or any(type(x) not in (int, float) for x in value):
        raise ValueError(f"{name}: no list of numbers")
    return [float(x) for x in value]


def _table(rows: list[dict[str, Any]]) -> Any:
    """The same columns for any rows."""
    kinds = dict.fromkeys(("id", *SIDES, REFUSED), pa.string())
    kinds |= dict.fromkeys(LISTS, pa.list_(pa.float64()))
    kinds |= dict.fromkeys(NUMBERS, pa.float64())
    return pa.table({n: pa.array([row.get(n) for row in rows], kind) for n, kind in kinds.items()})
