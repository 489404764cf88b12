"""``python -m colltrans.bulk QUERIES OUT``: answers files of queries.

Every file is a shard. Its answers have the same file name, which appears only when they are
complete. A second run answers shards that are missing, changed or damaged.
"""

import argparse
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import PurePath

from colltrans.bulk import engines, files
from colltrans.bulk.bodies import CACHE_BYTES, Bodies, doubled_name
from colltrans.bulk.files import NoRangesError
from colltrans.bulk.shard import Job, Report, check_shard
from colltrans.bulk.sources import Source, packed, parts_of, sources_of
from colltrans.bulk.table import QUESTIONS, Options
from colltrans.errors import ColltransError, InputError, as_error
from colltrans.queries import cores

SUFFIXES = (".parquet", ".jsonl")
#: Options of tasks of Ray.
TASKS = {
    "--task-cpus": "processors and threads of a task (default: 1)",
    "--task-memory": "bytes of memory that are reserved for a task",
    "--tasks-in-flight": "maximum number of tasks that wait or run (default: twice as many as the "
    "processors can run)",
}


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
        help="divide the work into tasks of about N rows: larger Parquet files are split at their "
        "row groups, smaller files joined",
    )
    parser.add_argument(
        "--cache-bytes",
        type=int,
        default=CACHE_BYTES,
        metavar="N",
        help="maximum size of the bodies that each process keeps (default: %(default)s)",
    )
    for option, what in TASKS.items():
        parser.add_argument(option, type=int, metavar="N", help=f"with --engine ray: {what}")
    parser.set_defaults(task_cpus=1)
    parser.add_argument("--threads", type=int, default=cores(), help="default: all cores")
    return parser.parse_args(words)


def tasks_of(asked: argparse.Namespace) -> list[list[Job]]:
    """Returns the shards of all files, as lists that one process answers."""
    kept = tuple(name for name in asked.keep.split(",") if name)
    options = Options(asked.question, asked.solver, keep_columns=kept, features=asked.features)
    options.reads(asked.solids)
    pairs = shards_of(asked.queries, asked.out)
    for file, target in pairs:
        if target == file:
            raise InputError(f"{target}: contains the queries; choose another place for answers")
    rows = asked.rows_per_task
    known = sources_of(
        [
            file
            for file, _ in pairs
            if file.endswith(".parquet") and not (rows is None and files.is_url(file))
        ]
    )
    for error in known.values():
        if isinstance(error, NoRangesError):
            print(f"note: one shard, read completely: {error}", file=sys.stderr)
    jobs = []
    for file, target in pairs:
        # A file without a source is one shard, whose report has the reason.
        source = found if isinstance(found := known.get(file), Source) else None
        job = Job(file, target, options, source=source)
        jobs += [job] if source is None or rows is None else cut(job, source, rows)
    if (doubled := doubled_name([job.answers for job in jobs])) is not None:
        raise InputError(f"{doubled}: two shards have this file of answers; rename a file")
    if rows is None:
        return [[job] for job in jobs]
    return [[jobs[k] for k in numbers] for numbers in packed((job.rows for job in jobs), rows)]


def cut(job: Job, source: Source, rows: int) -> list[Job]:
    """Divides a file into shards of row groups, each with its own file of answers."""
    parts = parts_of(source, rows)
    if len(parts) == 1:
        return [job]
    stem = job.answers.removesuffix(".parquet")
    return [
        replace(job, answers=f"{stem}-{part:05}-of-{len(parts):05}.parquet", groups=groups)
        for part, groups in enumerate(parts)
    ]


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


def rows_of(job: Job) -> int:
    """Returns the number of rows of a shard, or 0 if it is unknown."""
    if job.rows is not None:
        return job.rows
    if files.is_url(job.queries) or job.queries.endswith(".parquet"):
        return 0  # A file is not read for its number of rows alone.
    try:
        with open(job.queries, "rb") as file:
            return sum(1 for line in file if line.strip())
    except OSError:
        return 0  # The report of the shard has the reason.


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
    for name in ("threads", "rows_per_task", "task_cpus", "task_memory", "tasks_in_flight"):
        if (value := getattr(asked, name)) is not None and value < 1:
            raise InputError(f"--{name.replace('_', '-')}: must be at least 1")
    tasks = tasks_of(asked)
    jobs = [job for task in tasks for job in task]
    queries = files.absolute(asked.queries)
    folder = queries if files.is_folder(queries) else files.parent(queries)
    table = files.absolute(asked.bodies) if asked.bodies else None
    bodies = Bodies(table, folder, asked.hull, asked.solids, asked.cache_bytes)
    progress = Progress(sum(map(rows_of, jobs)))
    if asked.check:
        return told(engines.local(tasks, bodies, asked.threads, progress, checked), jobs, progress)
    bodies.read_table()
    files.clean(job.answers for job in jobs)
    if asked.engine == "local":
        return told(engines.local(tasks, bodies, asked.threads, progress), jobs, progress)
    resources = engines.Resources(asked.task_cpus, asked.task_memory, asked.tasks_in_flight)
    reports = engines.ray(tasks, bodies, asked.threads, asked.address, resources=resources)
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
