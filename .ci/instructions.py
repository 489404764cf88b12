#!/usr/bin/env python3
"""Counts the instructions of named queries with callgrind, and compares them with the recorded ones.

    .ci/instructions.py            compare; fails if a query differs from the record by more than 2 %
    .ci/instructions.py --record   replace the record

Counts do not depend on the load of the machine. They depend on the compiler, which rust-toolchain.toml fixes, and on
the kind of processor, for which the C library chooses its functions.
"""

import csv
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parent.parent
RECORD = ROOT / "docs" / "measurements" / "2026-11-29-counted-queries.csv"
#: Largest accepted change, relative to the record.
MOST = 0.02
PROGRAM = "counted_queries"


def counts(program: Path) -> dict[str, int]:
    """Runs the program once and returns the instructions of each query."""
    with tempfile.TemporaryDirectory() as folder:
        command = [
            "valgrind",
            "--tool=callgrind",
            f"--callgrind-out-file={folder}/out",
            f"--toggle-collect={PROGRAM}::counted",
            f"--dump-after={PROGRAM}::counted",
            str(program),
        ]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(done.stderr)
        names = done.stdout.split()
        found = []
        for part in range(1, len(names) + 1):
            text = Path(folder, f"out.{part}").read_text()
            total = re.search(r"^(?:totals|summary): (\d+)$", text, re.MULTILINE)
            found.append(int(total[1]) if total else 0)
    return dict(zip(names, found, strict=True))


def main() -> int:
    build = ["cargo", "build", "--release", "-p", "colltrans-testkit", "--bin", PROGRAM]
    subprocess.run(build, cwd=ROOT, check=True)
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    found = counts(ROOT / target / "release" / PROGRAM)
    if "--record" in sys.argv[1:]:
        with RECORD.open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["query", "instructions"])
            writer.writerows(found.items())
        return 0
    with RECORD.open(newline="") as file:
        known = {row["query"]: int(row["instructions"]) for row in csv.DictReader(file)}
    failed = found.keys() ^ known.keys()
    for name in found.keys() & known.keys():
        if abs(found[name] - known[name]) > MOST * known[name]:
            failed.add(name)
    for name in sorted(failed):
        print(f"{name}: {found.get(name)} instructions, recorded are {known.get(name)}")
    print(f"{len(found) - len(failed & found.keys())} of {len(found)} queries within {MOST:.0%}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
