"""Measures the overhead of Python over the bare library, for single calls and for many rows.

``python python/benchmarks/overhead.py [ROWS]`` needs the installed package and a Rust toolchain.
The bare library runs the same casts (``crates/colltrans-python/examples/bare.rs``), alternating
with Python. Times are CPU times, the minimum of the repetitions; ``wall`` is the wall time of two
threads.
"""

import json
import resource
import subprocess
import sys
import tempfile
import time
import timeit
from collections import defaultdict
from pathlib import Path

import numpy as np

import colltrans
from colltrans import Cast, ConvexPolyhedron, Pose

CRATE = Path(__file__).parents[2] / "crates" / "colltrans-python"
TURNS = 5


def settings(vertices, rows):
    """Draws two hulls of points on a sphere; one, rotated at random, moves down to the other."""
    random = np.random.default_rng(7)
    clouds = random.normal(size=(2, vertices, 3))
    clouds /= np.linalg.norm(clouds, axis=-1, keepdims=True)
    starts = random.normal(size=(rows, 3)) * [0.4, 0.4, 0] + [0, 0, 6]
    turns = random.normal(size=(rows, 4))
    turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
    return clouds, np.hstack([starts, turns, np.tile([0.0, 0.0, -1.0], (rows, 1))])


def program():
    """Builds the program of the bare library and returns its path."""
    build = ["cargo", "build", "--release", "--example", "bare", "--message-format=json"]
    told = subprocess.run(build, cwd=CRATE, check=True, capture_output=True, text=True).stdout
    messages = map(json.loads, told.splitlines())
    return next(m["executable"] for m in messages if m.get("executable"))


def bare(files, threads, count):
    """Returns nanoseconds of CPU and wall time of a cast of the bare library, without its start."""

    def cpu(repeats):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [*files, str(threads), str(repeats)]
        told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
        return used, float(told)

    (once, _), (often, wall) = cpu(1), cpu(5)
    return (often - once) / 4 / count * 1e9, wall


def many(bodies, rows, threads):
    """Returns the same for Python."""

    poses, directions = map(np.ascontiguousarray, (rows[:, :7], rows[:, 7:]))

    def ask():
        colltrans.cast_many(*bodies, directions, moving_pose=poses, threads=threads)

    ask()
    began = time.process_time()
    wall = min(timeit.repeat(ask, number=1, repeat=4))
    return (time.process_time() - began) / 4 / len(rows) * 1e9, wall / len(rows) * 1e9


def one(ask):
    spent = timeit.repeat(ask, timer=time.process_time, number=20_000, repeat=3)
    return min(spent) / 20_000 * 1e9


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 400_000
    print("| what | bare, ns | Python, ns | ratio | difference, ns |")
    print("|---|---:|---:|---:|---:|")
    for vertices in (8, 128):
        with tempfile.TemporaryDirectory() as folder:
            report(Path(folder), vertices, count)


def report(folder, vertices, count):
    clouds, rows = settings(vertices, count)
    bodies = [ConvexPolyhedron(cloud) for cloud in clouds]
    pose, direction = rows[0, :7].copy(), rows[0, 7:].copy()
    query = Cast(*bodies, direction, moving_pose=pose)
    placed = Pose(pose)
    calls = {
        "one call, arrays": lambda: colltrans.cast(*bodies, direction, moving_pose=pose),
        "one call, tuple and Pose": lambda: colltrans.cast(
            *bodies, (0.0, 0.0, -1.0), moving_pose=placed
        ),
        "one call, Cast": query.cast,
    }
    numbers = {"a": clouds[0], "b": clouds[1], "rows": rows, "same": np.tile(rows[0], (count, 1))}
    for name, values in numbers.items():
        (folder / name).write_bytes(np.ascontiguousarray(values).tobytes())
    files = [program(), folder / "a", folder / "b"]
    least = defaultdict(lambda: np.inf)

    def note(name, nanoseconds):
        least[name] = min(nanoseconds, least[name])

    for _ in range(TURNS):
        note("bare one", bare([*files, folder / "same"], 1, count)[0])
        for name, ask in calls.items():
            note(name, one(ask))
        for threads in (1, 2):
            for who, (cpu, wall) in {
                "bare": bare([*files, folder / "rows"], threads, count),
                "many": many(bodies, rows, threads),
            }.items():
                note(f"{who} {threads}", cpu)
                note(f"{who} {threads} wall", wall)
    pairs = [(name, "bare one", name) for name in calls]
    pairs += [
        ("many 1", "bare 1", "many, 1 thread"),
        ("many 2", "bare 2", "many, 2 threads"),
        ("many 2 wall", "bare 2 wall", "many, 2 threads, wall"),
    ]
    for name, reference, words in pairs:
        own, theirs = least[name], least[reference]
        print(
            f"| {vertices} vertices: {words} | {theirs:.0f} | {own:.0f} "
            f"| {own / theirs:.2f} | {own - theirs:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
