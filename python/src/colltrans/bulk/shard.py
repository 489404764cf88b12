"""Answers a file of queries with a file of answers.

Invariant: a file of answers has its name only when it is complete. Its metadata identify what it
answers (bytes of the queries, bodies, options, version). A second run therefore skips completed
shards, and two runs of the same shard do no harm. The metadata also have a digest of all bytes,
which detects later changes. Pages have the checksums that readers of Parquet can verify.
"""

import hashlib
import json
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, BinaryIO

import pyarrow as pa
import pyarrow.parquet as pq

from colltrans.bulk import files, lines
from colltrans.bulk.bodies import Bodies, texts_of
from colltrans.bulk.files import ReadError
from colltrans.bulk.reads import SIDES
from colltrans.bulk.sources import Source, chunks_of, ranges_of
from colltrans.bulk.table import Options, answer_table, column_of
from colltrans.errors import ColltransError

#: Number of rows in memory at once.
BATCH = 65_536
#: Number of bytes of a column that are read at once.
BUFFER = 1 << 16
#: Metadata key of the fingerprint of the query.
FINGERPRINT = b"colltrans"
#: Metadata key of the SHA-256 of the file with zeros in place of the digest.
DIGEST = b"colltrans: sha256 of all but these 64 digits"
ZEROS = b"0" * 64


@dataclass(frozen=True)
class Job:
    """One shard: the places of its queries and of its answers.

    Attributes
    ----------
    queries, answers : str
        Paths, or URLs for fsspec.
    options : Options
    groups : tuple of int or None
        For a Parquet file the half-open range of its row groups; None for all.
    source : Source or None
        The footer of a Parquet file, if it is known. Of a URL, row groups are read by ranges only
        with their footer; without it the complete file is read.
    """

    queries: str
    answers: str
    options: Options
    groups: tuple[int, int] | None = None
    source: Source | None = None

    @property
    def rows(self) -> int | None:
        """int or None: The number of rows, if the footer is known."""
        return None if self.source is None else self.source.rows(self.groups)


@dataclass(frozen=True)
class Report:
    """The result of a shard.

    Attributes
    ----------
    job : Job
    rows, errors : int
        Number of rows, and of rows without an answer.
    skipped : bool
        Whether the shard had been answered before.
    failure : str or None
        The reason if the shard has no answers.
    error : str or None
        The name of the class of the exception that is this reason, for example ``"ChangedError"``.
    """

    job: Job
    rows: int = 0
    errors: int = 0
    skipped: bool = False
    failure: str | None = None
    error: str | None = None


def answer_shard(
    job: Job, bodies: Bodies, progress: Callable[[int], None] = lambda rows: None
) -> Report:
    """Answers a shard, unless its answers exist and are complete.

    Parameters
    ----------
    job : Job
    bodies : Bodies
    progress : callable
        Called with the number of rows that were answered since the last call.

    Returns
    -------
    Report

    Raises
    ------
    ReadError
        The queries cannot be read.
    ChangedError
        The queries have changed since their footer was read, or while they were answered.
    ColltransError
        The queries have a wrong column, or the answers cannot be written. All messages have the
        names of the files.
    """
    with _named(job), _opened(job) as (queries, stamp):
        fingerprint = _fingerprint(job, queries, bodies)
        done = _finished(job, fingerprint)
        if done.failure is None:
            progress(done.rows)
            return done
        with files.made(job.answers) as file, files.steady(job.queries, stamp):
            rows, errors = _write(file, job, queries, bodies, fingerprint, progress)
            _seal(file)
        return Report(job, rows, errors)


def check_shard(job: Job, bodies: Bodies) -> Report:
    """Checks whether the answers of a shard exist, belong to its queries and are undamaged.

    Parameters
    ----------
    job : Job
    bodies : Bodies

    Returns
    -------
    Report
        Its ``failure`` is the reason if they are not.
    """
    with _named(job), _opened(job) as (queries, _):
        return _finished(job, _fingerprint(job, queries, bodies))


@contextmanager
def _opened(job: Job) -> Iterator[tuple[Path, files.Stamp]]:
    """Provides a local file with the bytes of a shard, and the state of its source."""
    source = job.source
    stamp = files.stamp_of(job.queries) if source is None else source.stamp
    ranges = None if source is None else ranges_of(source.footer, job.groups)
    with files.part(job.queries, stamp, ranges) as queries:
        yield queries, stamp


@contextmanager
def _named(job: Job) -> Iterator[None]:
    """Adds the name of the shard to the message of an exception, unless it begins with it."""
    try:
        yield
    except ColltransError as error:
        if str(error).startswith(job.queries):
            raise
        raise type(error)(f"{job.queries}: {error}") from error
    except (pa.ArrowException, OSError) as error:
        raise ReadError(f"{job.queries}: {error}") from error


def _write(
    file: BinaryIO,
    job: Job,
    queries: Path,
    bodies: Bodies,
    fingerprint: str,
    progress: Callable[[int], None],
) -> tuple[int, int]:
    """Answers all rows; returns their number and the number of errors."""
    writer, rows, errors = None, 0, 0
    try:
        for batch in _batches(queries, job, bodies):
            answers = answer_table(batch, bodies, job.options)
            if writer is None:
                schema = answers.schema.with_metadata({FINGERPRINT: fingerprint})
                words = ["outcome", "message", *SIDES]
                writer = pq.ParquetWriter(
                    file, schema, use_dictionary=words, write_page_checksum=True
                )
            writer.write_table(answers.cast(schema))
            rows += answers.num_rows
            errors += answers.num_rows - answers["message"].null_count
            progress(answers.num_rows)
        assert writer is not None
        told = {"rows": str(rows), "errors": str(errors), DIGEST.decode(): ZEROS.decode()}
        writer.add_key_value_metadata(told)
    finally:
        if writer is not None:
            writer.close()
    return rows, errors


def _finished(job: Job, fingerprint: str) -> Report:
    """Returns the report of existing answers; a failure means that they cannot be used."""
    if not files.exists(job.answers):
        return Report(job, failure=f"{job.answers} does not exist")
    with files.local(job.answers) as answers:
        if (damage := _damage(answers)) is not None:
            return Report(job, failure=f"{job.answers} {damage}")
        metadata = pq.read_metadata(answers).metadata
    if metadata.get(FINGERPRINT) != fingerprint.encode():
        told = f"{job.answers} belongs to other queries, bodies, options or another version"
        return Report(job, failure=told)
    return Report(job, int(metadata[b"rows"]), int(metadata[b"errors"]), skipped=True)


def _seal(file: BinaryIO) -> None:
    """Writes the digest to its place in the file."""
    place = _place_of_digest(file)
    assert place is not None
    found = _digest_around(file, place)
    file.seek(place)
    file.write(found.encode())


def _damage(path: Path) -> str | None:
    """Compares a file with its digest; returns a description of the damage, or None."""
    with path.open("rb") as file:
        place = _place_of_digest(file)
        if place is None:
            return "is not a complete file of answers"
        found = _digest_around(file, place)
        file.seek(place)
        if file.read(len(ZEROS)) != found.encode():
            return "is damaged: its bytes have changed since it was written"
    return None


def _place_of_digest(file: BinaryIO) -> int | None:
    """Returns the offset of the digest, which follows its name in the footer."""
    size = file.seek(0, 2)
    file.seek(max(0, size - 8))
    length = int.from_bytes(file.read(4), "little")
    start = size - 8 - length
    if start < 0:
        return None
    file.seek(start)
    footer = file.read(length)
    named = max(0, footer.rfind(DIGEST))
    # The kind and the length of the value are between the name and the digest.
    found = re.compile(re.escape(DIGEST) + rb".{1,4}?([0-9a-f]{64})", re.DOTALL).match(
        footer, named
    )
    return start + found.start(1) if found else None


def _digest_around(file: BinaryIO, place: int) -> str:
    """Returns the SHA-256 of the file with zeros in place of the digest."""
    found = hashlib.sha256()
    file.seek(0)
    for end in (place, None):
        while block := file.read(min(1 << 20, end - file.tell()) if end else 1 << 20):
            found.update(block)
        if end:
            found.update(ZEROS)
            file.seek(len(ZEROS), 1)
    return found.hexdigest()


def _fingerprint(job: Job, queries: Path, bodies: Bodies) -> str:
    options = {k: v for k, v in asdict(job.options).items() if k != "threads"}
    keys = set() if bodies.table else _keys(queries, job, bodies)
    told = {
        "version": _version(),
        "queries": _digest_of(queries, job),
        "bodies": bodies.digest(keys),
        "hull": bodies.hull,
        "solids": bodies.solids,
        **options,
    }
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


@cache
def _version() -> str:
    """Returns the version of this package, which takes a millisecond to find."""
    return version("colltrans")


def _digest_of(queries: Path, job: Job) -> str:
    """Returns the SHA-256 of a file, or of its row groups in the shard with their schema."""
    if job.groups is None:
        return files.digest(queries)
    with _parquet(queries, job) as parquet:
        footer, found = parquet.metadata, hashlib.sha256(str(parquet.schema_arrow).encode())
    with queries.open("rb") as file:
        for number in range(*job.groups):
            for begin, end in chunks_of(footer.row_group(number)):
                file.seek(begin)
                for start in range(begin, end, files.BLOCK):
                    found.update(file.read(min(files.BLOCK, end - start)))
    return f"{job.groups}: {found.hexdigest()}"


def _keys(queries: Path, job: Job, bodies: Bodies) -> set[str]:
    """Returns the keys of all bodies in a file."""
    keys: set[str] = set()
    for batch in _batches(queries, job, bodies, list(SIDES)):
        for side in SIDES:
            keys.update(filter(None, texts_of(column_of(batch, side).unique())))
    return keys


def _batches(
    queries: Path, job: Job, bodies: Bodies, columns: list[str] | None = None
) -> Iterator[Any]:
    """Yields the queries of a shard in batches; a shard without rows yields one empty batch."""
    try:
        if queries.suffix != ".parquet":
            yield from lines.tables_of(queries, job.options.reads(bodies.solids), BATCH)
            return
        with _parquet(queries, job) as file:
            groups, empty = range(*(job.groups or (0, file.num_row_groups))), True
            for batch in file.iter_batches(BATCH, row_groups=groups, columns=columns):
                yield batch
                empty = False
            if empty:
                yield file.schema_arrow.empty_table()
    except (OSError, pa.ArrowException) as error:
        raise ReadError(f"cannot read the queries: {error}") from error


def _parquet(queries: Path, job: Job) -> Any:
    """Opens a file of queries, with its footer if that is known."""
    footer = None if job.source is None else job.source.footer
    return pq.ParquetFile(
        queries,
        metadata=footer,
        # Large row groups are read in pieces.
        buffer_size=BUFFER,
        pre_buffer=False,
        page_checksum_verification=True,
    )
