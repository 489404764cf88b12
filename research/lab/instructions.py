"""Counts instructions of the laboratory's contestants, and fits the costs in ``solvers/cost.rs``.

``python research/lab/instructions.py PROGRAM OUTPUT.csv [--queries N] [--vertices N ...]`` runs
``PROGRAM count KIND VERTICES QUERIES`` (``colltrans-lab``, a release build) under callgrind. It
writes a row for each contestant, situation, kind and size, with means of a query: steps,
iterations, instructions, and misses of simulated caches and branch predictors. Then it prints for
each contestant ``base``, ``step`` and ``iteration`` of the estimate ``base + step * steps +
iteration * iterations``, with the median and the largest deviation. The fit is by least squares of
relative deviations without negative costs.
"""

import argparse
import csv
import subprocess
import tempfile
from collections.abc import Iterable
from itertools import combinations
from pathlib import Path
from statistics import median

KINDS = ("balanced", "thin", "meridians", "triangles")
#: The function whose calls are counted, each in a file of its own.
COUNTED = "colltrans_lab::counting::answer_all"
#: Events of callgrind, of which the sum is a column.
EVENTS = {
    "instructions": ("Ir",),
    "first-level data misses": ("D1mr", "D1mw"),
    "last-level misses": ("ILmr", "DLmr", "DLmw"),
    "mispredicted branches": ("Bcm", "Bim"),
}
HEAD = ("kind", "vertices", "situation", "contestant", "steps", "iterations", *EVENTS)
#: Steps, iterations and instructions of a query on average.
Counts = tuple[float, float, float]


def counted(
    program: Path, kind: str, vertices: int, queries: int, last_level: str | None
) -> Iterable[list[str]]:
    """Yields the rows of one kind and size."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        options = [f"--callgrind-out-file={out}", f"--toggle-collect={COUNTED}"]
        options += [f"--dump-after={COUNTED}", "--collect-atstart=no"]
        options += ["--cache-sim=yes", "--branch-sim=yes"]
        options += [f"--LL={last_level}"] if last_level else []
        command = ["valgrind", "-q", "--tool=callgrind", *options, str(program), "count", kind]
        command += [str(vertices), str(queries)]
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        for k, line in enumerate(text.splitlines(), 1):
            situation, contestant, steps, iterations = line.split(",")
            dump = (out.parent / f"out.{k}").read_text().splitlines()
            names = next(row for row in dump if row.startswith("events:")).split()[1:]
            totals = next(row for row in dump if row.startswith("totals:")).split()[1:]
            # Events at the end of the line that did not occur are left out.
            found = dict(zip(names, map(int, totals), strict=False))
            sums = [sum(found.get(e, 0) for e in events) / queries for events in EVENTS.values()]
            means = [float(steps), float(iterations), *sums]
            yield [kind, str(vertices), situation, contestant, *(f"{mean:.1f}" for mean in means)]


def fit(rows: list[Counts]) -> list[float]:
    """Returns base, step and iteration: the best fit without negative costs."""
    best, least = [0.0] * 3, float("inf")
    scaled = [[1 / count, steps / count, iterations / count] for steps, iterations, count in rows]
    for size in (1, 2, 3):
        for chosen in combinations(range(3), size):
            found = solved([[row[k] for k in chosen] for row in scaled])
            if found is None or min(found) < 0:
                continue
            costs = [0.0] * 3
            for k, cost in zip(chosen, found, strict=True):
                costs[k] = cost
            error = sum((sum(map(float.__mul__, row, costs)) - 1) ** 2 for row in scaled)
            if error < least:
                best, least = costs, error
    return best


def solved(rows: list[list[float]]) -> list[float] | None:
    """Returns the least squares solution of ``rows x = 1``; None if it is not unique."""
    size = len(rows[0])
    matrix = [[sum(r[i] * r[j] for r in rows) for j in range(size)] for i in range(size)]
    for i, row in enumerate(matrix):
        row.append(sum(r[i] for r in rows))
    for i in range(size):
        pivot = max(range(i, size), key=lambda k: abs(matrix[k][i]))
        matrix[i], matrix[pivot] = matrix[pivot], matrix[i]
        if abs(matrix[i][i]) < 1e-30:
            return None
        for k in range(size):
            if k != i:
                factor = matrix[k][i] / matrix[i][i]
                matrix[k] = [a - factor * b for a, b in zip(matrix[k], matrix[i], strict=True)]
    return [matrix[i][size] / matrix[i][i] for i in range(size)]


def print_costs(rows: list[list[str]]) -> None:
    """Prints the costs of each contestant, and how far estimates are off.

    Queries of CTA about bodies that pass each other have costs of their own, because steps without
    a contact lack the cell and the exit test. So have queries of EGJK in a sequence.
    """

    def name(row: list[str]) -> str:
        situation, contestant = row[2:4]
        passes = situation == "passing" and contestant.startswith(("CTA", "hybrid"))
        follows = situation.startswith("change") and contestant == "EGJK"
        return f"{contestant}, {situation.split()[0]}" if passes or follows else contestant

    for contestant in dict.fromkeys(map(name, rows)):
        own = [[float(cell) for cell in row[4:7]] for row in rows if name(row) == contestant]
        base, step, iteration = fit([(s, i, count) for s, i, count in own])
        off = [abs((base + step * s + iteration * i) / count - 1) for s, i, count in own]
        print(
            f"{contestant}: [{base:.1f}, {step:.1f}, {iteration:.1f}]"
            f" off by {median(off):.1%} (median), {max(off):.1%} (largest)"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("program", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("--queries", type=int, default=20)
    parser.add_argument("--vertices", type=int, nargs="+", default=[200, 3_200, 12_800, 51_200])
    parser.add_argument("--last-level", metavar="SIZE,WAYS,LINE", help="simulated cache, bytes")
    arguments = parser.parse_args()
    rows = []
    with arguments.output.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEAD)
        for vertices in arguments.vertices:
            for kind in KINDS:
                for row in counted(
                    arguments.program, kind, vertices, arguments.queries, arguments.last_level
                ):
                    rows.append(row)
                    writer.writerow(row)
                    file.flush()
    print_costs(rows)


if __name__ == "__main__":
    main()
