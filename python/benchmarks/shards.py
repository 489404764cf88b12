"""Measures queries in files: CPU time for a row, and memory, over many rows.

``python python/benchmarks/shards.py ROWS [FOLDER]`` writes shards of 500,000 rows with random poses
of two polytopes of 128 vertices, and answers them with the engines ``local`` and ``ray`` (if it is
installed) on two threads. It prints the CPU time for a row compared with ``contact_range_many``
alone, the rows answered in a second of wall time, and the largest resident memory of any process.
It fails if the files of both engines differ in any byte.
"""

import filecmp
import os
import subprocess
import sys
import tempfile
import threading
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from colltrans import ConvexPolyhedron, contact_range_many

SHARD = 500_000


def settings(seed, rows):
    random = np.random.default_rng(seed)
    turns = random.normal(size=(rows, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    starts = random.normal(size=(rows, 3)) * [0.4, 0.4, 0] + [0, 0, 6]
    return np.hstack([starts, turns]), np.tile([0.0, 0, -1], (rows, 1))


def write(folder, count):
    random = np.random.default_rng(7)
    clouds = random.normal(size=(2, 128, 3))
    clouds /= np.linalg.norm(clouds, axis=-1, keepdims=True)
    bodies = pa.table({"key": ["a", "b"], "vertices": clouds.tolist()})
    pq.write_table(bodies, folder / "bodies.parquet")
    (folder / "in").mkdir()
    for k in range(count):
        poses, directions = settings(k, SHARD)
        table = pa.table(
            {
                "id": np.arange(SHARD, dtype=np.int64) + k * SHARD,
                "moving": pa.array(["a"] * SHARD).dictionary_encode(),
                "fixed": pa.array(["b"] * SHARD).dictionary_encode(),
                "moving_pose": pa.FixedSizeListArray.from_arrays(poses.reshape(-1), 7),
                "direction": pa.FixedSizeListArray.from_arrays(directions.reshape(-1), 3),
            }
        )
        pq.write_table(table, folder / "in" / f"{k:05}.parquet", use_dictionary=["moving", "fixed"])
    return [ConvexPolyhedron(cloud) for cloud in clouds]


def family(root):
    """Returns a process and its descendants, with their CPU seconds and resident bytes."""
    parents, found = {}, {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            except OSError:
                continue
            parents[int(entry.name)] = int(fields[1])
            ticks = sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")
            found[int(entry.name)] = ticks, int(fields[21]) * os.sysconf("SC_PAGE_SIZE")

    def below(process):
        while process not in (root, 0):
            process = parents.get(process, 0)
        return process == root

    return {process: use for process, use in found.items() if below(process)}


def run(folder, engine):
    """Runs an engine; returns CPU seconds of all processes, wall seconds and peak memory."""
    words = [str(folder / "in"), str(folder / engine), "--bodies", str(folder / "bodies.parquet")]
    command = [sys.executable, "-m", "colltrans.bulk", *words, "--engine", engine, "--threads", "2"]
    began = time.perf_counter()
    cpu, memory = {}, []
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:

        def watch():
            while process.poll() is None:
                now = family(process.pid)
                cpu.update({who: ticks for who, (ticks, _) in now.items()})
                memory.append(max((resident for _, resident in now.values()), default=0))
                time.sleep(0.2)

        watcher = threading.Thread(target=watch)
        watcher.start()
        process.wait()
        watcher.join()
    third = max(1, len(memory) // 3)
    return sum(cpu.values()), time.perf_counter() - began, max(memory[:third]), max(memory)


def main():
    rows = int(sys.argv[1])
    parent = sys.argv[2] if len(sys.argv) > 2 else None
    with tempfile.TemporaryDirectory(dir=parent) as name:
        folder = Path(name)
        count = max(1, rows // SHARD)
        bodies = write(folder, count)
        poses, directions = settings(0, SHARD)
        contact_range_many(*bodies, directions[:9], moving_pose=poses[:9], threads=1)
        began = time.process_time()
        contact_range_many(*bodies, directions, moving_pose=poses, threads=1)
        bare = (time.process_time() - began) / SHARD
        size = sum(f.stat().st_size for f in (folder / "in").iterdir()) / count / SHARD
        print(f"{count * SHARD:,} rows of {size:.0f} bytes; bare: {bare * 1e6:.2f} us of CPU")
        print(
            "| engine | CPU a row, us | of the bare | rows a second | resident, at first | most |"
        )
        print("|---|---:|---:|---:|---:|---:|")
        for engine in ["local", *(["ray"] if find_spec("ray") else [])]:
            cpu, wall, early, most = run(folder, engine)
            done = sum(1 for _ in (folder / engine).glob("*.parquet"))
            assert done == count, f"{engine}: {done} shards of {count}"
            written = sum(f.stat().st_size for f in (folder / engine).iterdir()) / count / SHARD
            each = cpu / count / SHARD
            print(
                f"| {engine} | {each * 1e6:.2f} | {each / bare:.2f} | {count * SHARD / wall:,.0f} "
                f"| {early / 2**20:.0f} MiB | {most / 2**20:.0f} MiB |",
                flush=True,
            )
        print(f"answers: {written:.0f} bytes a row")
        if (folder / "ray").exists():
            names = [f.name for f in (folder / "local").iterdir()]
            same, *others = filecmp.cmpfiles(folder / "local", folder / "ray", names, shallow=False)
            assert others == [[], []], f"not the same: {others}"
            print(f"{len(same)} files of both engines have the same bytes")


if __name__ == "__main__":
    main()
