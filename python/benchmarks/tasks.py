"""Measures what a bulk run costs besides its rows: tasks, bytes moved, and memory of bodies.

``python python/benchmarks/tasks.py [FOLDER]`` prints

- the time of the driver for a file of 2,000 row groups, each a task: footers and division, and the
  submission of tasks that do nothing, by threads and (if it is installed) by Ray;
- the bytes that a server of files sends for 21 tasks of one file;
- the resident memory of a process that queries 100,000 bodies of 8 vertices, with several sizes of
  the cache.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from servers import serving
from shards import queries, write, write_bodies

from colltrans.bulk import Bodies, Report, engines
from colltrans.bulk.__main__ import arguments, main, tasks_of

GROUPS, ROWS = 2_000, 500
BODIES = 100_000


def nothing(job, bodies, progress=None):
    return Report(job)


def driver(folder):
    file = write(folder / "queries.parquet", queries(0, GROUPS * ROWS), row_group_size=ROWS)
    bodies = write_bodies(folder / "bodies.parquet")
    words = [str(file), str(folder / "out"), "--bodies", str(bodies), "--rows-per-task", str(ROWS)]
    clocks = time.perf_counter, time.process_time
    began = [clock() for clock in clocks]
    tasks = tasks_of(arguments(words))
    assert len(tasks) == GROUPS
    report(f"division into {GROUPS:,} tasks", clocks, began)
    known = Bodies(str(bodies))
    began = [clock() for clock in clocks]
    assert len(list(engines.local(tasks, known, 2, answer=nothing))) == GROUPS
    report("submission to threads", clocks, began)
    if find_spec("ray"):
        list(engines.ray(tasks[:4], known, 2, answer=nothing))  # Starts the workers.
        began = [clock() for clock in clocks]
        assert len(list(engines.ray(tasks, known, 2, answer=nothing))) == GROUPS
        report("submission to Ray, two workers", clocks, began)
    began = [clock() for clock in clocks]
    assert main([*words, "--threads", "2"]) == 0
    report("the run with two threads", clocks, began)
    began = [clock() for clock in clocks]
    assert main([words[0], str(folder / "whole.parquet"), *words[2:4], "--threads", "1"]) == 0
    report("the run as one task", clocks, began)


def report(what, clocks, began):
    wall, cpu = (clock() - start for clock, start in zip(clocks, began, strict=True))
    print(f"{what}: {wall:.2f} s, {cpu:.2f} s of CPU", flush=True)


def moved(folder):
    (folder / "web").mkdir()
    bodies = write_bodies(folder / "bodies.parquet")
    file = write(folder / "web" / "queries.parquet", queries(0, 126_000), row_group_size=6_000)
    with serving(folder / "web") as server:
        words = [f"{server.url}/queries.parquet", str(folder / "moved"), "--bodies", str(bodies)]
        assert main([*words, "--rows-per-task", "6000"]) == 0
        size, requests = file.stat().st_size, server.gets("queries.parquet")
    count = len(list((folder / "moved").iterdir()))
    print(f"{count} tasks of {size:,} bytes: {server.sent:,} sent in {len(requests)} requests")


def memory(folder):
    random = np.random.default_rng(1)
    table = folder / "many.parquet"
    clouds = random.normal(size=(BODIES, 8, 3))
    keys = [f"body {k}" for k in range(BODIES)]
    lists = pa.FixedSizeListArray.from_arrays(clouds.reshape(-1), 3)
    ends = pa.array(np.arange(0, 8 * BODIES + 1, 8, dtype=np.int32))
    vertices = pa.ListArray.from_arrays(ends, lists)
    pq.write_table(pa.table({"key": keys, "vertices": vertices}), table)
    for mebibytes in (16, 64, 4096):
        code = f"from tasks import resident; resident({str(table)!r}, {mebibytes << 20})"
        environment = os.environ | {"PYTHONPATH": str(Path(__file__).parent)}
        subprocess.run([sys.executable, "-c", code], check=True, env=environment)


def resident(table, cache_bytes):
    """Builds all bodies in the order of the table, and prints the growth of this process."""
    bodies, before = Bodies(table, cache_bytes=cache_bytes), anonymous()
    keys = [f"body {k}" for k in range(BODIES)]
    for begin in range(0, BODIES, 1000):
        bodies.get(keys[begin : begin + 1000])
    grown = (anonymous() - before) >> 20
    held, count = bodies._held >> 20, len(bodies._cache)
    print(
        f"cache of {cache_bytes >> 20:,} MiB: {count:,} bodies, {held} MiB held, {grown} MiB grown"
    )


def anonymous():
    """Returns the bytes of this process that no file backs."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("RssAnon:"):
            return int(line.split()[1]) << 10
    raise OSError("/proc/self/status has no RssAnon")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?")
    with tempfile.TemporaryDirectory(dir=parser.parse_args().folder) as name:
        for each in (driver, moved, memory):
            each(Path(name))
