"""``python -m colltrans.bulk QUERIES OUT``: files of queries to files of answers.

Every file is a shard: its answers have its name, and stand there only when they are whole. A second
run answers what is missing or has changed.
"""

import argparse
import os
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from colltrans.bulk import engines
from colltrans.bulk.bodies import Bodies
from colltrans.bulk.shard import QUESTIONS, Job, Options
from colltrans.errors import ColltransError, InputError

SUFFIXES = (".parquet", ".jsonl")


def arguments(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser("python -m colltrans.bulk", description=__doc__)
    parser.add_argument("queries", type=Path, help="a Parquet file, a file of JSON lines, a folder")
    parser.add_argument("out", type=Path, help="a folder, or for one file a file *.parquet")
    parser.add_argument("--bodies", type=Path, help="a Parquet table of key, vertices and faces")
    parser.add_argument("--hull", action="store_true", help="take the convex hull of all meshes")
    parser.add_argument("--question", choices=QUESTIONS, default="range")
    parser.add_argument("--solver", choices=["auto", "cta", "portal"], default="auto")
    parser.add_argument("--engine", choices=["local", "ray"], default="local")
    parser.add_argument("--address", help="of a Ray cluster; one is started here without")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    parser.add_argument("--threads", type=int, default=cores, help="all cores by default")
    return parser.parse_args(words)


def jobs_of(asked: argparse.Namespace) -> list[Job]:
    options = Options(asked.question, asked.solver)
    queries, out = asked.queries, asked.out
    if queries.is_dir():
        files = sorted(p for p in queries.iterdir() if p.suffix in SUFFIXES and p.name[0] != ".")
    elif queries.suffix in SUFFIXES and queries.exists():
        files = [queries]
    else:
        raise InputError(f"{queries}: no folder, and no file *.parquet or *.jsonl")
    if not files:
        raise InputError(f"{queries}: holds no file *.parquet or *.jsonl")
    names = [file.with_suffix(".parquet").name for file in files]
    if len(set(names)) < len(names):
        raise InputError(f"{queries}: two files have one name but for their suffix")
    alone = out.suffix == ".parquet" and not queries.is_dir()
    targets = [out] if alone else [out / name for name in names]
    for file, target in zip(files, targets, strict=True):
        if target.exists() and target.samefile(file):
            raise InputError(f"{target}: holds the queries; give the answers another place")
    absolute = ((str(f.resolve()), str(t.resolve())) for f, t in zip(files, targets, strict=True))
    return [Job(file, target, options) for file, target in absolute]


def rows_of(job: Job) -> int:
    if job.queries.endswith(".parquet"):
        try:
            return int(pq.read_metadata(job.queries).num_rows)
        except pa.ArrowException as error:
            raise ColltransError(f"{job.queries}: {error}") from error
    with open(job.queries, "rb") as file:
        return sum(1 for line in file if line.strip())


class Progress:
    """A line a second on the standard error: rows, rate, time left."""

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
            left = (self.total - self.rows) / rate
            text = f"{self.rows:,} of {self.total:,} rows, {rate:,.0f} a second, {left:,.0f} s left"
            print(text, file=sys.stderr, flush=True)


def main(words: Sequence[str] | None = None) -> int:
    """Answers all shards.

    Returns 0 if every row has an answer, 5 if not, 2 for files that are none, 130 after Ctrl-C.
    """
    asked = arguments(words)
    try:
        return run(asked)
    except (ColltransError, ModuleNotFoundError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; the same words go on from here", file=sys.stderr)
        return 130


def run(asked: argparse.Namespace) -> int:
    jobs = jobs_of(asked)
    if asked.threads < 1:
        raise InputError("--threads: at least one")
    folder = asked.queries if asked.queries.is_dir() else asked.queries.parent
    table = str(asked.bodies.resolve()) if asked.bodies else None
    bodies = Bodies(table, str(folder.resolve()), asked.hull)
    progress = Progress(sum(map(rows_of, jobs)))
    rows = errors = skipped = 0
    if asked.engine == "local":
        reports = engines.local(jobs, bodies, asked.threads, progress)
    else:
        reports = engines.ray(jobs, bodies, asked.threads, asked.address)
    for report in reports:
        rows, errors = rows + report.rows, errors + report.errors
        skipped += report.skipped
        if asked.engine == "ray":
            progress(report.rows)
    spent = time.perf_counter() - progress.began
    print(
        f"{rows:,} rows in {len(jobs)} shards ({skipped} were done before): "
        f"{errors:,} errors, {spent:.1f} s"
    )
    return 5 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
