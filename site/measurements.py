"""Sets the dated runs in ``docs/measurements`` as a page, and the laboratory's claims as a table.

``python site/measurements.py`` prints the page in Markdown, ``--claims`` the table. The runs are
the JSON files of ``table``, ``paper``, ``coherence``, ``bulk`` and ``solids``, tables of other
programs (``.csv``), and the output of ``campaign`` (``.txt``). They are named by date and kind,
``YYYY-MM-DD-KIND.json``; of each kind the newest run is used. The claims come from ``claims.json``
of two runs of the laboratory with different seeds.
"""

import csv
import json
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from math import isnan, nan
from pathlib import Path, PurePath
from typing import Any

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "measurements"
#: The text of the page, with names of tables and numbers in braces.
TEMPLATE = Path(__file__).resolve().parent / "measurements.template.md"
#: A row, or a run with its rows.
Row = dict[str, Any]


def newest_runs(folder: Path = FOLDER) -> dict[str, Path]:
    """Returns the newest file of each kind, the name without date and extension."""
    files = sorted(file for file in folder.iterdir() if file.suffix in (".json", ".txt", ".csv"))
    found = {file.stem[11:]: file for file in files}
    return dict(sorted(found.items()))


def page(folder: Path = FOLDER) -> str:
    """Returns the page with all measurements and campaigns: the template, then the campaigns."""
    runs = newest_runs(folder)
    read = {
        kind: json.loads(file.read_text()) for kind, file in runs.items() if file.suffix == ".json"
    }
    used = {kind: read[kind] for kind in ("table", "paper", "coherence", "bulk", "solids")}
    parts = {kind: provenance(run) for kind, run in used.items()}
    parts |= table_run(used["table"]) | algorithm(used["paper"]) | coherence(used["coherence"])
    parts |= {"many": bulk(used["bulk"])} | solids(used["solids"])
    for kind, file in runs.items():
        if file.suffix == ".csv":
            parts[kind.replace("-", "_")] = csv_table(file)
    text = TEMPLATE.read_text().format(**{name: part.strip() for name, part in parts.items()})
    for kind, file in runs.items():
        if file.suffix == ".txt":
            title = kind.replace("-", " ").capitalize()
            text += f"\n## {title}\n\n`{file.name}`\n\n```text\n{file.read_text().rstrip()}\n```\n"
    return text


def csv_table(file: Path) -> str:
    """Returns a file of comma-separated values as a table."""
    with file.open(newline="") as lines:
        head, *rows = csv.reader(lines)
    return "".join(f"| {' | '.join(line)} |\n" for line in [head, ["---"] * len(head), *rows])


def figure(row: Any, path: str) -> Any:
    """Returns the value at a path ``KEY/KEY/...``; None if it is missing."""
    for key in path.split("/"):
        if isinstance(row, list):
            row = row[int(key)] if int(key) < len(row) else None
        else:
            row = row.get(key) if isinstance(row, dict) else None
    return row


def number(row: Any, path: str) -> float:
    """Returns the number at a path; NaN if it is missing."""
    value = figure(row, path)
    return nan if value is None or isinstance(value, str) else float(value)


def whole(value: float) -> str:
    return f"{value:,.0f}"


def rounded(value: float) -> str:
    """Formats a number with three digits."""
    digits = 2 if value < 9.95 else 1 if value < 99.5 else 0
    return f"{value:,.{digits}f}"


def fixed(digits: int) -> Callable[[float], str]:
    return lambda value: f"{value:.{digits}f}"


@dataclass(frozen=True)
class Column:
    """A column: its head, the path of its figure, and the format. Without a format it is text."""

    head: str
    path: str
    style: Callable[[float], str] | None = None
    #: Path of a divisor, or the divisor.
    over: str | float = 1.0
    missing: str = "NaN"
    #: A column in brackets behind the figure.
    more: "Column | None" = None

    def cell(self, row: Row) -> str:
        if self.style is None:
            value = figure(row, self.path)
            return "?" if value is None else str(value)
        over = number(row, self.over) if isinstance(self.over, str) else self.over
        value = sum(number(row, path) for path in self.path.split(" + ")) / over
        if isnan(value):
            return self.missing
        return self.style(value) + (f" ({self.more.cell(row)})" if self.more else "")


def table(columns: list[Column], rows: Iterable[Row]) -> str:
    """Returns a table in Markdown."""
    lines = [
        [column.head for column in columns],
        *([column.cell(row) for column in columns] for row in rows),
    ]
    text = ["|" + "".join(f" {cell} |" if cell else " |" for cell in line) + "\n" for line in lines]
    rule = "|" + "".join("---|" if column.style is None else "---:|" for column in columns) + "\n"
    return "".join([text[0], rule, *text[1:]])


def total(run: Row, *paths: str) -> str:
    """Returns the sum of the figures at these paths in all rows, without those that are missing."""
    figures = (number(row, path) for row in run["rows"] for path in paths)
    return whole(sum(value for value in figures if not isnan(value)))


def provenance(run: Row) -> str:
    """Returns date, machine, versions, and the command without folders of the original machine."""
    machine = run["machine"]
    program, *words = run["command"].split()
    typed = " ".join([program, "--", *(PurePath(word).name for word in words)])
    where = f"{machine['cpu']} with {machine['cores']} cores, {machine['system']}"
    command = f"cargo run --release -p colltrans-bench --bin {typed}"
    return f"\n{run['date']}, {where}; {run['versions']}.\n\n```sh\n{command}\n```\n"


def time_and_tail(head: str, who: str) -> Column:
    tail = Column("", f"{who}/p99_ns", whole)
    return Column(head, f"{who}/median_ns", whole, more=tail)


def is_tied(row: Row) -> bool:
    return row["meeting"] not in ("colliding", "separated")


def table_run(run: Row) -> dict[str, str]:
    """Returns the tables and numbers of a run of ``table``."""
    columns = [
        Column("shape", "shape"),
        Column("vertices", "vertices", whole),
        Column("", "meeting"),
        time_and_tail("`cta`", "cta"),
        time_and_tail("`portal`", "portal"),
        time_and_tail("`auto`", "auto"),
        time_and_tail("parry", "parry"),
        Column("x", "parry_over/auto/median", rounded, missing="-"),
        Column("planar", "cta/planar_problems", fixed(1)),
    ]
    return {
        "general": table(columns, (row for row in run["rows"] if not is_tied(row))),
        "failures": total(run, "cta/failures", "portal/failures", "auto/failures"),
        "disagreements": total(run, "parry_disagreements"),
        "ties": ties(run),
        "building": building(run),
    }


def ties(run: Row) -> str:
    tied = [dict(row) for row in run["rows"] if is_tied(row)]
    own = {
        row["shape"]: row["auto"]["mean_ns"] for row in tied if row["meeting"] == "general position"
    }
    for row in tied:
        row["general"] = own.get(row["shape"])
    columns = [
        Column("tie", "shape"),
        Column("placement", "meeting"),
        Column("`auto`", "auto/mean_ns", whole),
        Column("99 %", "auto/p99_ns", whole),
        Column("parry", "parry/mean_ns", whole),
        Column("x", "parry_over/auto/mean", rounded, missing="-"),
        Column("own", "auto/mean_ns", rounded, over="general", missing="-"),
        Column("supports", "auto/supports", fixed(1)),
    ]
    return table(columns, tied)


BODIES = [Column("bodies", "settings"), Column("vertices", "vertices", whole)]


def solver(head: str, who: str) -> list[Column]:
    """Returns the columns for the ratio, planar problems and exchanges of one solver."""
    return [
        Column(head, f"solvers/{who}/ratio", rounded, missing="-"),
        Column("planar", f"solvers/{who}/planar_problems", fixed(2)),
        Column("left", f"solvers/{who}/pivots", fixed(2)),
    ]


def algorithm(run: Row) -> dict[str, str]:
    rows = run["rows"]
    failures = sum(one["failures"] for row in rows for one in row["solvers"].values())
    portal = "solvers/portal"
    parry = "parry_8/median_ns"
    casts = [
        *BODIES,
        Column("portal, ns", f"{portal}/median_ns", whole, over=f"{portal}/ratio"),
        Column("`portal`", f"{portal}/ratio", rounded, missing="-"),
        Column("`cta`, rough", "solvers/rough/ratio", rounded, missing="-"),
        *solver("centre, 1 %", "centre 1%"),
        *solver("centre, end", "centre end"),
        Column("of parry", "solvers/centre end/median_ns", rounded, over=parry, missing="-"),
    ]
    sequences = [
        *BODIES,
        *solver("focus, 1 %", "focus 1%"),
        *solver("focus, end", "focus end"),
        Column("no focus, end", "solvers/centre end/ratio", rounded, missing="-"),
        Column("planar", "solvers/centre end/planar_problems", fixed(2)),
    ]
    problems = "end/planar_problems"
    phases = [
        *BODIES,
        Column("planar problems", "phases/planar problems", whole),
        Column("cell shift, exit", "phases/cell shift", whole),
        Column("region", "phases/search region", whole),
        Column("bound", "phases/lower bound", whole),
        Column("refinement", "phases/portal refinement", whole),
        Column("each planar problem", "phases/planar problems", whole, over=problems),
        Column("iterations", "end/iterations", fixed(1), over=problems),
    ]
    phased = [dict(row) for row in rows if row.get("phases") is not None]
    for row in phased:
        row["end"] = row["solvers"].get("focus end") or row["solvers"]["centre end"]
    single = [row for row in rows if row["solvers"].get("portal")]
    moving = [row for row in rows if not row["solvers"].get("portal")]
    return {
        "single": table(casts, single),
        "sequences": table(sequences, moving),
        "phases": table(phases, phased),
        "paper_failures": whole(failures),
    }


def coherence(run: Row) -> dict[str, str]:
    tracker, scratch = "solvers/tracker", "solvers/scratch"
    means = Column("", f"{tracker}/mean_ns", fixed(2), over=f"{scratch}/mean_ns")
    columns = [
        Column("vertices", "vertices", whole),
        Column("sequence", "sequences"),
        Column("scratch", f"{scratch}/median_ns", whole),
        Column("tracker", f"{tracker}/median_ns", whole),
        Column("ratio", f"{tracker}/median_ns", fixed(2), over=f"{scratch}/median_ns", more=means),
        Column("of parry", f"{tracker}/mean_ns", fixed(2), over="parry_8/mean_ns"),
        Column("planar", "solvers/cta/planar_problems", fixed(1)),
        Column("with focus", "solvers/cta region/planar_problems", fixed(2)),
    ]
    return {"tracked": table(columns, run["rows"]), "differences": total(run, "differences")}


def bulk(run: Row) -> str:
    rows = [dict(row) for row in run["rows"]]
    for row in rows:
        ns = row["ns"]
        best = ns.get("one direction") or ns.get("any direction")
        gain = ns["cast"] - best if best else 0.0
        row["pays"] = (row["make_ns"] + row["map_ns"]) / gain if gain > 0 else None
        row["percent"] = 100 * row["left"][0]

    def faster(head: str, who: str) -> Column:
        more = Column("", "ns/cast", fixed(2), over=f"ns/{who}")
        return Column(head, f"ns/{who}", whole, missing="-", more=more)

    columns = [
        Column("casts", "set"),
        Column("bodies", "shape"),
        Column("vertices", "vertices", whole),
        Column("cast", "ns/cast", whole),
        Column("tracker", "ns/tracker", whole, missing="-"),
        faster("any", "any direction"),
        faster("one", "one direction"),
        Column("make", "make_ns + map_ns", rounded, over=1e3, missing="-"),
        Column("pays", "pays", whole, missing="never"),
        Column("left", "percent", fixed(1)),
    ]
    return table(columns, rows)


def solids(run: Row) -> dict[str, str]:
    rows = sorted((dict(row) for row in run["rows"]), key=lambda row: row["ratio_of_medians"] or 0)
    for row in rows:
        if row["group"] != "pairs":
            row["name"] = f"{row['group']}: {row['name']}" if row.get("name") else row["group"]
    columns = [
        Column("what", "name"),
        Column("facets", "facets", whole),
        Column("median", "median_ns", rounded, over=1e3, missing="-"),
        Column("mean", "mean_ns", rounded, over=1e3, missing="-"),
        Column("parry, median", "parry_median_ns", rounded, over=1e3, missing="-"),
        Column("x", "ratio_of_medians", rounded, missing="-", more=Column("", "ratio", rounded)),
    ]
    return {"casts": table(columns, rows), "apart": total(run, "answers_apart")}


def building(run: Row) -> str:
    columns = [
        Column("shape", "shape"),
        Column("vertices", "vertices", whole),
        Column("bytes a vertex", "bytes_per_vertex", fixed(0)),
        Column("ms", "build_ms", rounded, missing="-"),
    ]
    rows = (row for row in run["rows"] if row["meeting"] == "colliding")
    return table(columns, rows)


VERDICTS = ("holds", "better than the paper", "undecided", "does not hold")


def laboratory(folder: Path = FOLDER) -> tuple[Row, Row]:
    """Returns both runs of the laboratory. Rejects runs of different claims."""
    runs = newest_runs(folder)
    run, again = (json.loads(runs[kind].read_text()) for kind in ("laboratory", "laboratory-again"))
    if list(by_name(run)) != list(by_name(again)):
        raise SystemExit("laboratory and laboratory-again have different claims")
    return run, again


def by_name(run: Row) -> dict[str, Row]:
    return {claim["id"]: claim for claim in run["claims"]}


def counts(run: Row) -> str:
    """Returns the number of claims, and of each verdict."""
    of = [f"{sum(c['verdict'] == v for c in run['claims'])} {v}" for v in VERDICTS]
    return f"Of {len(run['claims'])} claims: {', '.join(of)}."


def estimate(one: Row) -> str:
    """Formats a number with its interval."""

    def short(value: float) -> str:
        return f"{value:.{0 if abs(value) >= 99.5 else 1 if abs(value) >= 9.95 else 2}f}"

    return f"{short(one['value'])} ({short(one['low'])} to {short(one['high'])})"


def claims(folder: Path = FOLDER) -> str:
    """Returns the table of claims, and the reasons of those that do not hold."""
    run, again = laboratory(folder)
    other = by_name(again)
    same = sum(claim["verdict"] == other[claim["id"]]["verdict"] for claim in run["claims"])
    overlap = sum(intervals_overlap(claim, other[claim["id"]]) for claim in run["claims"])
    machine = run["machine"]
    text = (
        f"From a {run['scale']} run with seed {run['seed']} ({run['date']}) on "
        f"{machine['cores']} cores of an {machine['cpu']}, {run['versions']}. {counts(run)} "
        f"A {again['scale']} run with seed {again['seed']} gives the same verdict on {same}; a "
        "different one is named (*again*). The intervals of both runs overlap in all numbers of "
        f"{overlap} claims.\n\n| claim | the paper | here | verdict |\n|---|---|---|---|\n"
    )
    for claim in run["claims"]:
        here = "; ".join(f"{estimate(one)} {one['what']}" for one in claim["measured"])
        second = other[claim["id"]]["verdict"]
        verdict = claim["verdict"] + (f" (again: {second})" if second != claim["verdict"] else "")
        name = f"{claim['statement']} (`{claim['id']}`)"
        text += f"| {name} | {claim['paper']}; {claim['place']} | {here} | {verdict} |\n"
    text += "\nReasons, where a claim does not hold or is undecided, with counts from the data:\n\n"
    for claim in run["claims"]:
        if claim["why"]:
            text += f"- `{claim['id']}`, {claim['reason']}: {claim['why']}\n"
    return text


def intervals_overlap(claim: Row, other: Row) -> bool:
    pairs = zip(claim["measured"], other["measured"], strict=True)
    return all(a["low"] <= b["high"] and b["low"] <= a["high"] for a, b in pairs)


if __name__ == "__main__":
    print(claims() if "--claims" in sys.argv[1:] else page(), end="")
