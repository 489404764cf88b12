"""A file of queries to a file of answers.

Invariant: an answer file has its name only when it is whole. Its metadata say what it answers (the
queries' bytes, the bodies, the choices, the version), so a second run knows which are done, and two
that answer the same shard do no harm. They have a digest of all its bytes, too, so that one that
has changed since is found; and pages have the checksums that readers of Parquet can look at.
"""

import hashlib
import json
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any, BinaryIO

import pyarrow as pa
import pyarrow.parquet as pq

from colltrans.bulk import files, lines
from colltrans.bulk.bodies import Bodies, texts_of
from colltrans.bulk.reads import SIDES
from colltrans.bulk.table import Options, answer_table, column_of
from colltrans.errors import ColltransError

#: Rows that are in memory at once.
BATCH = 65_536
#: In the metadata: what is answered.
FINGERPRINT = b"colltrans"
#: In the metadata: SHA-256 of the file with zeros in the place of this.
DIGEST = b"colltrans: sha256 of all but these 64 digits"
ZEROS = b"0" * 64


@dataclass(frozen=True)
class Job:
    """One shard: where its queries are and where its answers go.

    Attributes
    ----------
    queries, answers : str
        Paths, or URLs that fsspec knows.
    options : Options
    groups : tuple of int or None
        Of a Parquet file the row groups from the first up to the second, without it; None for all.
    """

    queries: str
    answers: str
    options: Options
    groups: tuple[int, int] | None = None


@dataclass(frozen=True)
class Report:
    """What became of a shard.

    Attributes
    ----------
    job : Job
    rows, errors : int
        How many rows it has, and how many of them have no answer.
    skipped : bool
        Whether it had been answered before.
    failure : str or None
        Why there are no answers at all.
    """

    job: Job
    rows: int = 0
    errors: int = 0
    skipped: bool = False
    failure: str | None = None


def answer_shard(
    job: Job, bodies: Bodies, progress: Callable[[int], None] = lambda rows: None
) -> Report:
    """Answers a shard, unless that has been done and its answers are whole.

    Parameters
    ----------
    job : Job
    bodies : Bodies
    progress : callable
        Called with the number of rows that have been answered since it was called last.

    Returns
    -------
    Report

    Raises
    ------
    ColltransError
        Queries that cannot be read, or answers that cannot be written, with their names.
    """
    with _named(job), files.local(job.queries) as queries:
        fingerprint = _fingerprint(job, queries, bodies)
        done = _finished(job, fingerprint)
        if done.failure is None:
            progress(done.rows)
            return done
        with files.made(job.answers) as file:
            rows, errors = _write(file, job, queries, bodies, fingerprint, progress)
            _seal(file)
        return Report(job, rows, errors)


def check_shard(job: Job, bodies: Bodies) -> Report:
    """Whether there are answers to a shard, and whole: of these queries, and as they were written.

    Parameters
    ----------
    job : Job
    bodies : Bodies

    Returns
    -------
    Report
        Its ``failure`` says what is wrong.
    """
    with _named(job), files.local(job.queries) as queries:
        return _finished(job, _fingerprint(job, queries, bodies))


@contextmanager
def _named(job: Job) -> Iterator[None]:
    """What goes wrong with a shard, by its name."""
    try:
        yield
    except (ColltransError, pa.ArrowException, OSError) as error:
        raise ColltransError(f"{job.queries}: {error}") from error


def _write(
    file: BinaryIO,
    job: Job,
    queries: Path,
    bodies: Bodies,
    fingerprint: str,
    progress: Callable[[int], None],
) -> tuple[int, int]:
    """Answers all rows; how many there are, and how many of them are errors."""
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
    """Of a shard that has been answered already; a failure says that it has not."""
    if not files.exists(job.answers):
        return Report(job, failure=f"{job.answers} is not there")
    with files.local(job.answers) as answers:
        if (damage := _damage(answers)) is not None:
            return Report(job, failure=f"{job.answers} {damage}")
        metadata = pq.read_metadata(answers).metadata
    if metadata.get(FINGERPRINT) != fingerprint.encode():
        told = f"{job.answers} is of other queries, bodies or choices, or of another version"
        return Report(job, failure=told)
    return Report(job, int(metadata[b"rows"]), int(metadata[b"errors"]), skipped=True)


def _seal(file: BinaryIO) -> None:
    """Writes the digest into its place."""
    place = _place_of_digest(file)
    assert place is not None
    found = _digest_around(file, place)
    file.seek(place)
    file.write(found.encode())


def _damage(path: Path) -> str | None:
    """What is wrong with the bytes of a file that should have its digest."""
    with path.open("rb") as file:
        place = _place_of_digest(file)
        if place is None:
            return "is no whole file of answers"
        found = _digest_around(file, place)
        file.seek(place)
        if file.read(len(ZEROS)) != found.encode():
            return "is damaged: its bytes are not those that were written"
    return None


def _place_of_digest(file: BinaryIO) -> int | None:
    """Where in a Parquet file the digest stands: in its footer, behind its name."""
    size = file.seek(0, 2)
    file.seek(max(0, size - 8))
    length = int.from_bytes(file.read(4), "little")
    start = size - 8 - length
    if start < 0:
        return None
    file.seek(start)
    footer = file.read(length)
    named = max(0, footer.rfind(DIGEST))
    # Between them stand the kind and the length of the value.
    found = re.compile(re.escape(DIGEST) + rb".{1,4}?([0-9a-f]{64})", re.DOTALL).match(
        footer, named
    )
    return start + found.start(1) if found else None


def _digest_around(file: BinaryIO, place: int) -> str:
    """SHA-256 of the file with zeros in the place of the digest."""
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
        "version": version("colltrans"),
        "queries": _digest_of(queries, job.groups),
        "bodies": bodies.digest(keys),
        "hull": bodies.hull,
        "solids": bodies.solids,
        **options,
    }
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def _digest_of(queries: Path, groups: tuple[int, int] | None) -> str:
    """SHA-256 of a file, or of these row groups and of what their columns are."""
    if groups is None:
        return files.digest(queries)
    with pq.ParquetFile(queries) as parquet:
        metadata, found = parquet.metadata, hashlib.sha256(str(parquet.schema_arrow).encode())
    with queries.open("rb") as file:
        for number in range(*groups):
            group = metadata.row_group(number)
            for chunk in map(group.column, range(group.num_columns)):
                pages = chunk.dictionary_page_offset if chunk.has_dictionary_page else None
                file.seek(pages or chunk.data_page_offset)
                found.update(file.read(chunk.total_compressed_size))
    return f"{groups}: {found.hexdigest()}"


def _keys(queries: Path, job: Job, bodies: Bodies) -> set[str]:
    """The keys of all bodies of a file."""
    keys: set[str] = set()
    for batch in _batches(queries, job, bodies, list(SIDES)):
        for side in SIDES:
            keys.update(filter(None, texts_of(column_of(batch, side).unique())))
    return keys


def _batches(
    queries: Path, job: Job, bodies: Bodies, columns: list[str] | None = None
) -> Iterator[Any]:
    """The queries of a file; of one without any an empty batch, which has its columns."""
    try:
        if queries.suffix != ".parquet":
            yield from lines.tables_of(queries, job.options.reads(bodies.solids), BATCH)
            return
        with pq.ParquetFile(queries, page_checksum_verification=True) as file:
            groups = range(*(job.groups or (0, file.num_row_groups)))
            if file.metadata.num_rows == 0:
                yield file.schema_arrow.empty_table()
            yield from file.iter_batches(BATCH, row_groups=groups, columns=columns)
    except (OSError, pa.ArrowException) as error:
        raise ColltransError(f"cannot be read: {error}") from error
