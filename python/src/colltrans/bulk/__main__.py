"""``python -m colltrans.bulk QUERIES OUT``: answers files of queries.

Every file is a shard. Its answers have the same file name, which appears only when they are
complete. A second run answers shards that are missing, changed or damaged.
"""

import argparse
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import PurePath

import pyarrow as pa
import pyarrow.parquet as pq

from colltrans.bulk import engines, files
from colltrans.bulk.bodies import Bodies
from colltrans.bulk.shard import Job, Report, check_shard
from colltrans.bulk.table import QUESTIONS, Options
from colltrans.errors import ColltransError, InputError, as_error
from colltrans.queries import cores

SUFFIXES = (".parquet", ".jsonl")


def arguments(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser("python -m colltrans.bulk", description=__doc__)
    parser.add_argument("queries", help="a Parquet file, a file of JSON lines, or a folder of them")
    parser.add_argument("out", help="a folder, or for one file of queries a file *.parquet")
    parser.add_argument("--bodies", help="a Parquet table with columns key, vertices and faces")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--hull", action="store_true", help="take the convex hull of all meshes")
    kind.add_argument("--solids", action="store_true", help="treat all bodies as solids")
    parser.add_argument("--question", choices=QUESTIONS, default="range")
    parser.add_argument("--solver", choices=["auto", "cta", "portal"], default="auto")
    parser.add_argument(
        "--keep",
        default="",
        metavar="A,B",
        help="columns of the queries to copy to the answers; '*' for all",
    )
    parser.add_argument(
        "--features", action="store_true", help="add the first vertices of the features in contact"
    )
    parser.add_argument("--check", action="store_true", help="only check which shards are complete")
    parser.add_argument("--engine", choices=["local", "ray"], default="local")
    parser.add_argument(
        "--address", help="address of a Ray cluster; by default one is started here"
    )
    parser.add_argument(
        "--rows-per-task",
        type=int,
        metavar="N",
        help="split Parquet files into shards of row groups with at least N rows",
    )
    parser.add_argument("--threads", type=int, default=cores(), help="default: all cores")
    return parser.parse_args(words)


def jobs_of(asked: argparse.Namespace) -> list[Job]:
    kept = tuple(name for name in asked.keep.split(",") if name)
    options = Options(asked.question, asked.solver, keep_columns=kept, features=asked.features)
    options.reads(asked.solids)
    pairs = shards_of(asked.queries, asked.out)
    for file, target in pairs:
        if target == file:
            raise InputError(f"{target}: contains the queries; choose another place for answers")
    jobs = [Job(file, target, options) for file, target in pairs]
    if asked.rows_per_task is None:
        return jobs
    return [part for job in jobs for part in parts_of(job, asked.rows_per_task)]


def shards_of(queries: str, out: str) -> list[tuple[str, str]]:
    """Returns the files of queries with the files for their answers."""
    queries, out = files.absolute(queries), files.absolute(out)
    if files.is_folder(queries):
        if PurePath(queries) in (PurePath(out), *PurePath(out).parents):
            raise InputError(f"{out}: must not be in the folder of the queries")
        names = [name for name in files.names_in(queries) if name.endswith(SUFFIXES)]
        if not names:
            raise InputError(f"{queries}: contains no file *.parquet or *.jsonl")
        sources = [files.join(queries, name) for name in names]
    elif queries.endswith(SUFFIXES) and files.exists(queries):
        sources, names = [queries], [PurePath(queries).name]
        if out.endswith(".parquet"):
            return [(queries, out)]
    else:
        raise InputError(f"{queries}: not a folder, and not a file *.parquet or *.jsonl")
    answers = [name.removesuffix(".jsonl").removesuffix(".parquet") + ".parquet" for name in names]
    if len(set(answers)) < len(answers):
        raise InputError(f"{queries}: two file names differ only in their suffix; rename one")
    return list(zip(sources, (files.join(out, name) for name in answers), strict=True))


def parts_of(job: Job, rows: int) -> Iterator[Job]:
    """Yields runs of row groups with at least `rows` rows, each with its own file of answers.

    A file that cannot be read stays one shard, because the report of the shard has the reason.
    """
    if rows < 1:
        raise InputError("--rows-per-task: must be at least 1")
    begins, count = [0], 0
    counts = row_counts(job) if job.queries.endswith(".parquet") else []
    for number, group in enumerate(counts):
        count += group
        if count >= rows:
            begins.append(number + 1)
            count = 0
    ends = sorted({*begins, len(counts)})
    if len(ends) < 3:
        yield job
        return
    stem = job.answers.removesuffix(".parquet")
    for part, groups in enumerate(pairwise(ends)):
        answers = f"{stem}-{part:05}-of-{len(ends) - 1:05}.parquet"
        yield Job(job.queries, answers, job.options, groups)


def row_counts(job: Job) -> list[int]:
    """Returns the number of rows of each row group; empty if the file cannot be read."""
    try:
        with files.local(job.queries) as file:
            metadata = metadata_of(job.queries, file)
    except (ColltransError, OSError):
        return []
    return [metadata.row_group(number).num_rows for number in range(metadata.num_row_groups)]


def metadata_of(name: str, file: object) -> pq.FileMetaData:
    try:
        return pq.read_metadata(file)
    except pa.ArrowException as error:
        raise ColltransError(f"{name}: {error}") from error


def rows_of(job: Job) -> int:
    """Returns the number of rows of a shard; 0 if it cannot be read, which its report explains."""
    try:
        if files.is_url(job.queries):
            return 0  # Not worth fetching the file.
        if job.queries.endswith(".parquet"):
            metadata = metadata_of(job.queries, job.queries)
            groups = range(*(job.groups or (0, metadata.num_row_groups)))
            return sum(metadata.row_group(number).num_rows for number in groups)
        with open(job.queries, "rb") as file:
            return sum(1 for line in file if line.strip())
    except (ColltransError, OSError):
        return 0


class Progress:
    """Prints a line each second on standard error: rows, rate, time left."""

    def __init__(self, total: int) -> None:
        self.total, self.rows, self.began = total, 0, time.perf_counter()
        self.told = self.began
        self.lock = threading.Lock()

    def __call__(self, rows: int) -> None:
        with self.lock:
            self.rows += rows
            now = time.perf_counter()
            if now - self.told < 1:
                return
            self.told = now
            rate = max(self.rows, 1) / (now - self.began)
            text = f"{self.rows:,} rows, {rate:,.0f} a second"
            if self.total >= self.rows:
                left = (self.total - self.rows) / rate
                text += f", of {self.total:,}, {left:,.0f} s left"
            print(text, file=sys.stderr, flush=True)


def main(words: Sequence[str] | None = None) -> int:
    """Answers all shards and returns the exit code.

    The code is 0 if every row has an answer, 5 if some have none, 2 if some shards were not
    answered (or with ``--check`` are incomplete) or nothing could start, 130 after Ctrl-C.
    """
    asked = arguments(words)
    try:
        return run(asked)
    except KeyboardInterrupt:
        print("interrupted; the same command continues from here", file=sys.stderr)
        return 130
    except (ColltransError, ModuleNotFoundError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except BaseException as error:
        print(f"error: {as_error(error, asked.queries)}", file=sys.stderr)
        return 2


def run(asked: argparse.Namespace) -> int:
    jobs = jobs_of(asked)
    if asked.threads < 1:
        raise InputError("--threads: must be at least 1")
    queries = files.absolute(asked.queries)
    folder = queries if files.is_folder(queries) else files.parent(queries)
    table = files.absolute(asked.bodies) if asked.bodies else None
    bodies = Bodies(table, folder, asked.hull, asked.solids)
    progress = Progress(sum(map(rows_of, jobs)))
    if asked.check:
        return told(engines.local(jobs, bodies, asked.threads, progress, checked), jobs, progress)
    bodies.read_table()
    files.clean(job.answers for job in jobs)
    if asked.engine == "local":
        return told(engines.local(jobs, bodies, asked.threads, progress), jobs, progress)
    reports = engines.ray(jobs, bodies, asked.threads, asked.address)
    return told(counted(reports, progress), jobs, progress)


def checked(job: Job, bodies: Bodies, progress: Progress) -> Report:
    report = check_shard(job, bodies)
    progress(report.rows)
    return report


def counted(reports: Iterator[Report], progress: Progress) -> Iterator[Report]:
    for report in reports:
        progress(report.rows)
        yield report


def told(reports: Iterator[Report], jobs: list[Job], progress: Progress) -> int:
    """Prints a summary of all shards; returns the exit code."""
    rows = errors = skipped = failed = 0
    for report in reports:
        rows, errors = rows + report.rows, errors + report.errors
        skipped += report.skipped
        if report.failure is not None:
            failed += 1
            print(f"error: {report.failure}", file=sys.stderr, flush=True)
    spent = time.perf_counter() - progress.began
    print(
        f"{rows:,} rows in {len(jobs) - failed} shards ({skipped} were done before): "
        f"{errors:,} errors, {spent:.1f} s" + (f"; {failed} shards FAILED" if failed else "")
    )
    return 2 if failed else 5 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
