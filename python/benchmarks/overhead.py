"""What Python costs over the bare library: one call, and many.

``python python/benchmarks/overhead.py [ROWS]`` with the package installed and Rust at hand. The bare
library runs the same casts in the same minutes (``crates/colltrans-python/examples/bare.rs``), in
turns; each figure is the least of its turns.
"""

import subprocess
import sys
import tempfile
import timeit
from pathlib import Path

import numpy as np

import colltrans
from colltrans import Cast, ConvexPolyhedron, Pose

CRATE = Path(__file__).parents[2] / "crates" / "colltrans-python"
TURNS = 7


def settings(vertices, rows):
    """Two bodies of points on a sphere, one turned about anyhow and dropped onto the other."""
    random = np.random.default_rng(7)
    clouds = random.normal(size=(2, vertices, 3))
    clouds /= np.linalg.norm(clouds, axis=-1, keepdims=True)
    starts = random.normal(size=(rows, 3)) * [0.4, 0.4, 0] + [0, 0, 6]
    turns = random.normal(size=(rows, 4))
    turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
    return clouds, np.hstack([starts, turns, np.tile([0.0, 0.0, -1.0], (rows, 1))])


def bare(folder, clouds, rows, threads):
    """Nanoseconds a cast of the library alone."""
    files = [folder / name for name in ("a", "b", "rows")]
    for file, numbers in zip(files, [*clouds, rows], strict=True):
        file.write_bytes(np.ascontiguousarray(numbers).tobytes())
    program = ["cargo", "run", "--release", "--quiet", "--example", "bare", "--"]
    told = subprocess.run(
        [*program, *files, str(threads), "3"], cwd=CRATE, check=True, capture_output=True, text=True
    )
    return float(told.stdout)


def many(bodies, rows, threads):
    def ask():
        colltrans.cast_many(*bodies, rows[:, 7:], moving_pose=rows[:, :7], threads=threads)

    return min(timeit.repeat(ask, number=1, repeat=3)) / len(rows) * 1e9


def one(ask):
    return min(timeit.repeat(ask, number=20_000, repeat=3)) / 20_000 * 1e9


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
        "one, numpy arrays": lambda: colltrans.cast(*bodies, direction, moving_pose=pose),
        "one, a tuple and a Pose": lambda: colltrans.cast(
            *bodies, (0.0, 0.0, -1.0), moving_pose=placed
        ),
        "one, a Cast": query.first_contact,
    }
    least = {}

    def note(name, nanoseconds):
        least[name] = min(nanoseconds, least.get(name, np.inf))

    repeated = np.tile(rows[0], (count // 4, 1))
    for _ in range(TURNS):
        note("bare one", bare(folder, clouds, repeated, 1))
        for name, ask in calls.items():
            note(name, one(ask))
        for threads in (1, 2):
            note(f"bare {threads}", bare(folder, clouds, rows, threads))
            note(f"many {threads}", many(bodies, rows, threads))
    pairs = [(name, "bare one") for name in calls]
    pairs += [(f"many {threads}", f"bare {threads}") for threads in (1, 2)]
    for name, yardstick in pairs:
        own, theirs = least[name], least[yardstick]
        words = name.replace("many 1", "many, 1 thread").replace("many 2", "many, 2 threads")
        print(
            f"| {vertices} vertices: {words} | {theirs:.0f} | {own:.0f} "
            f"| {own / theirs:.2f} | {own - theirs:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
