"""Counts instructions of casts with the paper's algorithm beside portal refinement.

``python research/bench/instructions.py PROGRAM OUTPUT.csv [--shapes S ...] [--vertices N ...]``
runs ``PROGRAM`` (``colltrans-bench --bin instructions``, a release build) under callgrind. It
writes a row for each shape, size and solver: means of a cast, and the instructions over those of
the first solver.
"""

import argparse
import csv
import re
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

SHAPES = ("ellipsoid", "hull", "thin", "half", "superellipsoid", "box", "prism", "bicone")
SOLVERS = ("portal", "guess", "guess-across", "center", "ellipsoids")
#: The function whose calls are counted, each in a file of its own.
COUNTED = "instructions::counted_casts"
HEAD = ("shape", "vertices", "solver", "planar problems", "iterations", "supports", "pivots")


def counted(
    program: Path, shape: str, vertices: int, pairs: int, casts: int
) -> Iterable[list[str]]:
    """Yields the rows of one shape and size."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        options = [f"--callgrind-out-file={out}", f"--toggle-collect={COUNTED}"]
        options += [f"--dump-after={COUNTED}", "--collect-atstart=no"]
        command = ["valgrind", "-q", "--tool=callgrind", *options, str(program)]
        command += ["--shape", shape, "--vertices", str(vertices), "--solvers", ",".join(SOLVERS)]
        command += ["--pairs", str(pairs), "--casts", str(casts)]
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        sums = [0] * len(SOLVERS)
        for k in range(pairs * len(SOLVERS)):
            dump = (out.parent / f"out.{k + 1}").read_text()
            total = re.search(r"^(?:totals|summary): (\d+)", dump, re.MULTILINE)
            sums[k % len(SOLVERS)] += int(total[1]) if total else 0
        for row, total in zip(csv.DictReader(text.splitlines()), sums, strict=True):
            counts = [row[name] for name in ("problems", "iterations", "supports", "pivots")]
            each = total / int(row["casts"])
            ratio = f"{total / sums[0]:.2f}"
            yield [shape, str(vertices), row["solver"], *counts, f"{each:.0f}", ratio]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("program", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("--shapes", nargs="+", default=SHAPES, choices=SHAPES)
    sizes = [200, 800, 3_200, 12_800, 51_200, 200_000]
    parser.add_argument("--vertices", type=int, nargs="+", default=sizes)
    parser.add_argument("--pairs", type=int, default=4)
    parser.add_argument("--casts", type=int, default=50)
    arguments = parser.parse_args()
    with arguments.output.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*HEAD, "instructions", "of portal"])
        for shape in arguments.shapes:
            for vertices in [8] if shape == "box" else arguments.vertices:
                # Bodies of many vertices take minutes to build under callgrind.
                pairs = arguments.pairs if vertices < 50_000 else 1
                for row in counted(arguments.program, shape, vertices, pairs, arguments.casts):
                    writer.writerow(row)
                    file.flush()


if __name__ == "__main__":
    main()
