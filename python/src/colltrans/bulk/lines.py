"""Tables of queries from lines of JSON.

An invalid line is a row too, with the reason in the column :data:`REFUSED`.
"""

import json
import math
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import pyarrow as pa

from colltrans.bulk.reads import EVERYTHING, LISTS, SIDES, Reads

#: The column with the reason why a line is invalid.
REFUSED = "colltrans: refused"
#: The column with the complete line, if everything is kept.
LINE = "line"
#: Fields of motions in lines, and the columns of screws that they become.
MOTIONS = {"moving_motion": "moving_screw", "fixed_motion": "fixed_screw"}


def tables_of(path: Path, reads: Reads, rows: int) -> Iterator[Any]:
    """Yields tables with up to `rows` lines of a file, at least one; skips blank lines."""
    with path.open("rb") as file:
        lines = ((number, line) for number, line in enumerate(file, 1) if line.strip())
        first = True
        while (some := [_row(line, n, reads) for n, line in islice(lines, rows)]) or first:
            yield _table(some, reads)
            first = False


def _row(line: bytes, number: int, reads: Reads) -> dict[str, Any]:
    """Returns the query of a line, or the reason why it is invalid."""
    row = None
    kept: dict[str, Any] = {}
    if EVERYTHING in reads.kept:
        kept[LINE] = line.decode(errors="replace").rstrip("\r\n")
    try:
        row = json.loads(line)
        kept |= {name: _as_text(row, name) for name in reads.unread}
        return {"id": _id_of(row), **kept, **_query(row, reads)}
    except (ValueError, OverflowError, RecursionError) as error:
        return {"id": _id_of(row), **kept, REFUSED: f"line {number}: {error}"}


def _id_of(row: Any) -> str | None:
    found = row.get("id") if isinstance(row, dict) else None
    return None if found is None else str(found).encode(errors="replace").decode()


def _as_text(row: Any, name: str) -> str | None:
    """Returns a kept field as JSON, because lines may have any kind of value in it."""
    found = row.get(name) if isinstance(row, dict) else None
    return None if found is None else json.dumps(found)


def _query(row: Any, reads: Reads) -> dict[str, Any]:
    """Returns the query of a line. Unread fields that would change the answer are errors."""
    if not isinstance(row, dict):
        raise ValueError("not an object")
    row = {MOTIONS.get(name, name): _plain(value, name) for name, value in row.items()}
    if (stray := reads.stray(row)) is not None:
        raise ValueError(stray)
    query: dict[str, Any] = {side: _key(row.get(side), side) for side in SIDES}
    for name in reads.columns:
        if row.get(name) is None:
            continue
        if name in LISTS:
            query[name] = _numbers(row[name], name)
            if len(query[name]) not in LISTS[name]:
                raise ValueError(f"{name}: {len(query[name])} numbers")
        else:
            (query[name],) = _numbers([row[name]], name)
    return query


def _plain(value: Any, name: str) -> Any:
    """Returns a motion as the 8 numbers of its screw; values of other columns are not changed."""
    if name not in MOTIONS:
        return value
    kind = next(iter(value)) if isinstance(value, dict) and len(value) == 1 else None
    if kind not in ("screw", "turn") or not isinstance(value[kind], dict):
        raise ValueError(f'{name}: neither {{"screw": ...}} nor {{"turn": ...}}')
    fields = {"rise": 0.0, **value[kind]} if kind == "turn" else value[kind]
    if "degrees" in fields and "radians" not in fields:
        (degrees,) = _numbers([fields["degrees"]], f"{name}.degrees")
        fields = {**fields, "radians": math.radians(degrees)}
        del fields["degrees"]
    if fields.keys() != {"point", "axis", "radians", "rise"}:
        raise ValueError(f"{name}: {kind!r} has missing or unknown fields")
    point, axis = (_numbers(fields[part], f"{name}.{part}") for part in ("point", "axis"))
    rest = _numbers([fields["radians"], fields["rise"]], f"{name}.radians")
    if (len(point), len(axis)) != (3, 3):
        raise ValueError(f"{name}: point and axis must have three numbers each")
    return [*point, *axis, *rest]


def _key(value: Any, side: str) -> str:
    if isinstance(value, dict) and value.keys() == {"mesh"}:  # As `colltrans batch` reads it.
        value = value["mesh"]
    if not isinstance(value, str):
        raise ValueError(f'{side}: expected a key, or an object with the field "mesh" only')
    value.encode()
    return value


def _numbers(value: Any, name: str) -> list[float]:
    if name in LISTS and isinstance(value, dict):  # A pose as `colltrans batch` reads it.
        parts = {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1]}
        if name == "direction" or value.keys() - parts.keys():
            raise ValueError(f"{name}: neither a list of numbers nor a pose")
        each = {**parts, **value}
        place, turn = (_numbers(part, f"{name}.{of}") for of, part in each.items())
        if (len(place), len(turn)) != (3, 4):
            raise ValueError(f"{name}: {len(place)} and {len(turn)} numbers, not 3 and 4")
        return place + turn
    if not isinstance(value, list) or any(type(x) not in (int, float) for x in value):
        raise ValueError(f"{name}: not a list of numbers")
    return [float(x) for x in value]


def _table(rows: list[dict[str, Any]], reads: Reads) -> Any:
    """Builds a table that has the same columns for any rows."""
    whole = [LINE] if EVERYTHING in reads.kept else []
    kinds = dict.fromkeys((*reads.unread, *whole, "id", *SIDES, REFUSED), pa.string())
    lists = [name for name in reads.columns if name in LISTS]
    kinds |= dict.fromkeys(lists, pa.list_(pa.float64()))
    kinds |= dict.fromkeys(set(reads.columns) - set(lists), pa.float64())
    return pa.table({n: pa.array([row.get(n) for row in rows], kind) for n, kind in kinds.items()})
