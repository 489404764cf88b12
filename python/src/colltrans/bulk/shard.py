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
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from colltrans.bulk.bodies import Bodies, file_digest
from colltrans.columns import Columns
from colltrans.errors import ColltransError, InputError
from colltrans.many import cast_many, clearance_many, contact_range_many

QUESTIONS: dict[str, Any] = {
    "contact": cast_many,
    "range": contact_range_many,
    "clearance": clearance_many,
}
#: Rows that are in memory at once.
BATCH = 65_536
FINGERPRINT = b"colltrans"


@dataclass(frozen=True)
class Options:
    """What is asked of every row."""

    question: Literal["contact", "range", "clearance"] = "range"
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
        are any, ``moving_pose``, ``fixed_pose`` (3 or 7 numbers), ``graze_tolerance`` and ``id``.
    bodies : Bodies
    options : Options

    Returns
    -------
    pyarrow.Table
        The column ``id``, if there is one, and those of :meth:`Columns.to_arrow`. A row that cannot
        be answered has the outcome *error* and a message.
    """
    count = queries.num_rows
    arguments: dict[str, Any] = {"solver": options.solver, "threads": options.threads}
    sides = []
    for side in ("moving", "fixed"):
        keys = _column(queries, side).dictionary_encode()
        if isinstance(keys, pa.ChunkedArray):
            keys = keys.combine_chunks()
        index = keys.indices.fill_null(-1).to_numpy(zero_copy_only=False)
        sides.append(bodies.get(keys.dictionary.to_pylist()))
        arguments[f"{side}_index"] = index.astype(np.int64)
        if f"{side}_pose" in queries.schema.names:
            arguments[f"{side}_pose"] = _vectors(queries, f"{side}_pose", (7, 3))
    if "graze_tolerance" in queries.schema.names:
        tolerances = _column(queries, "graze_tolerance").fill_null(0.0)
        arguments["graze_tolerance"] = np.asarray(tolerances, dtype=float)
    directions = _vectors(queries, "direction", (3,))
    columns: Columns[Any] = QUESTIONS[options.question](*sides, directions, **arguments)
    answers = columns.to_arrow()
    if "id" in queries.schema.names:
        answers = answers.add_column(0, "id", _column(queries, "id"))
    assert answers.num_rows == count
    return answers


def _column(queries: Any, name: str) -> Any:
    if name not in queries.schema.names:
        raise InputError(f"the queries have no column {name!r}")
    return queries.column(name)


def _vectors(queries: Any, name: str, widths: tuple[int, ...]) -> np.ndarray[Any, Any]:
    """Lists of numbers as a table; rows that are none, or of another length, are NaN."""
    column = _column(queries, name)
    if isinstance(column, pa.ChunkedArray):
        column = column.combine_chunks()
    kind = column.type
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
        if row is None and name != "direction":
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
        if writer is None:
            raise InputError(f"{job.queries}: no queries")
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
    if path.suffix == ".parquet":
        try:
            with pq.ParquetFile(path) as file:
                yield from file.iter_batches(BATCH, columns=columns)
        except (pa.ArrowInvalid, OSError) as error:
            raise ColltransError(f"{path}: {error}") from None
        return
    rows: list[dict[str, Any]] = []
    with path.open() as file:
        for number, line in enumerate(file, 1):
            rows.append(_row(line, number))
            if len(rows) == BATCH:
                yield _table(rows)
                rows = []
    if rows:
        yield _table(rows)


def _row(line: str, number: int) -> dict[str, Any]:
    """A query of a line; of one that is none the error comes when it is asked."""
    try:
        row = json.loads(line)
        return row if isinstance(row, dict) else {"id": f"line {number}: no object"}
    except ValueError as error:
        return {"id": f"line {number}: {error}"}


LISTS = {"direction": 3, "moving_pose": 7, "fixed_pose": 7}


def _table(rows: list[dict[str, Any]]) -> Any:
    """The same columns for any rows: what has another type is as good as missing."""

    def numbers(value: Any) -> list[float] | None:
        if isinstance(value, dict):  # A pose as `colltrans batch` reads it.
            still = {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1], **value}
            value = [*still["translation"], *still["rotation"]]
        sound = isinstance(value, list) and all(isinstance(x, (int, float)) for x in value)
        return [float(x) for x in value] if sound else None if value is None else []

    def text(value: Any) -> str | None:
        if isinstance(value, dict):  # A body as `colltrans batch` reads it.
            value = value.get("mesh")
        return value if isinstance(value, str) else None

    columns: dict[str, Any] = {
        "id": pa.array([None if (i := r.get("id")) is None else str(i) for r in rows], pa.string())
    }
    for name in ("moving", "fixed"):
        columns[name] = pa.array([text(row.get(name)) for row in rows], pa.string())
    for name in LISTS:
        lists = [numbers(row.get(name)) for row in rows]
        columns[name] = pa.array(lists, pa.list_(pa.float64()))
    tolerances = [
        t if isinstance(t := r.get("graze_tolerance", 0.0), (int, float)) else -1 for r in rows
    ]
    columns["graze_tolerance"] = pa.array(map(float, tolerances), pa.float64())
    return pa.table(columns)
