"""Tests that a faulty body or shard of a bulk run does not affect the other rows."""

from pathlib import Path
from typing import Any

import pytest

pa = pytest.importorskip("pyarrow")
pq = pytest.importorskip("pyarrow.parquet")

from shards import CORNERS, KEYS, queries, shards, write, write_bodies  # noqa: E402

from colltrans.bulk import bodies as bulk_bodies  # noqa: E402
from colltrans.bulk import table as bulk_table  # noqa: E402
from colltrans.bulk.__main__ import main  # noqa: E402

#: Bytes that are not valid UTF-8.
NO_TEXT = b"\xff\xfe"


class Panic(BaseException):
    """The Python class of a panic of the extension, which is not an ``Exception``."""


def binary_as_text(values: list[bytes]) -> Any:
    """Returns a column of texts with unchecked bytes, as some writers produce."""
    column = pa.array(values, pa.binary())
    return pa.Array.from_buffers(pa.string(), len(column), column.buffers())


def run(asked: Path, out: Path, bodies: Path) -> int:
    return main([str(asked), str(out), "--bodies", str(bodies), "--threads", "2"])


def answers_of(out: Path, name: str) -> Any:
    return pq.read_table(out / name)


def test_a_panic_is_the_error_of_its_body(tmp_path: Path, monkeypatch: Any) -> None:
    table, file = write_bodies(tmp_path / "bodies.parquet"), tmp_path / "queries.parquet"
    write(file, queries(1, 4) | {"moving": [KEYS[0], KEYS[1]] * 2, "fixed": [KEYS[1]] * 4})
    known = bulk_bodies.Bodies._of_row

    def panics(self: Any, found: Any, key: str) -> Any:
        if key == KEYS[0]:
            raise Panic("index out of bounds")
        return known(self, found, key)

    monkeypatch.setattr(bulk_bodies.Bodies, "_of_row", panics)
    assert run(file, tmp_path / "out", table) == 5
    answers = answers_of(tmp_path / "out", "queries.parquet")
    told = answers["message"].to_pylist()
    assert "Panic: index out of bounds" in told[0] and "Panic" in told[2]
    assert told[1] is None and told[3] is None


def test_a_lack_of_memory_is_the_error_of_its_shard(
    tmp_path: Path, monkeypatch: Any, capsys: Any
) -> None:
    table, asked = write_bodies(tmp_path / "bodies.parquet"), shards(tmp_path / "in", 3, 20)
    write(asked / "shard-1.parquet", queries(1, 21))
    known = bulk_table.QUESTIONS["range"]

    def panics(*sides: Any, **arguments: Any) -> Any:
        if len(arguments["moving_index"]) == 21:
            raise MemoryError("no memory left")
        return known(*sides, **arguments)

    monkeypatch.setitem(bulk_table.QUESTIONS, "range", panics)
    assert run(asked, tmp_path / "out", table) == 2
    found = capsys.readouterr()
    assert "shard-1.parquet: MemoryError: no memory left" in found.err
    assert "40 rows in 2 shards" in found.out and "1 shards FAILED" in found.out


def test_a_duplicate_column_is_the_error_of_its_shard(tmp_path: Path, capsys: Any) -> None:
    table, asked = write_bodies(tmp_path / "bodies.parquet"), shards(tmp_path / "in", 2, 20)
    bad = pq.read_table(asked / "shard-1.parquet")
    pq.write_table(bad.append_column("direction", bad["direction"]), asked / "shard-1.parquet")
    assert run(asked, tmp_path / "out", table) == 2
    found = capsys.readouterr()
    assert "shard-1.parquet: " in found.err and "'direction' twice" in found.err
    assert "20 rows in 1 shards" in found.out


@pytest.mark.parametrize("kind", ["twice", "texts", "no text"])
def test_a_bad_row_of_bodies_is_the_error_of_its_queries(tmp_path: Path, kind: str) -> None:
    table, file = tmp_path / "bodies.parquet", tmp_path / "queries.parquet"
    corners = CORNERS.tolist()
    keys, vertices = pa.array(["cube", "box"]), [corners, corners]
    if kind == "twice":
        keys, vertices = pa.array(["cube", "box", "box"]), [corners] * 3
    elif kind == "no text":
        keys = binary_as_text([b"cube", NO_TEXT])
    columns: Any = pa.array(vertices)
    if kind == "texts":
        columns = pa.array(["1 2 3", "4 5 6"])
    pq.write_table(pa.table({"key": keys, "vertices": columns}), table)
    write(file, queries(1, 2) | {"moving": ["cube", "box"], "fixed": ["cube", "cube"]})
    assert run(file, tmp_path / "out", table) == 5
    told = answers_of(tmp_path / "out", "queries.parquet")["message"].to_pylist()
    words = {"twice": "'box' twice", "texts": "not lists of numbers", "no text": "no body 'box'"}
    assert words[kind] in told[1]
    assert (told[0] is None) == (kind != "texts")


def test_a_key_that_is_not_text_is_the_error_of_its_row(tmp_path: Path) -> None:
    table, file = write_bodies(tmp_path / "bodies.parquet"), tmp_path / "queries.parquet"
    write(file, queries(1, 2) | {"moving": binary_as_text([KEYS[0].encode(), NO_TEXT])})
    assert run(file, tmp_path / "out", table) == 5
    told = answers_of(tmp_path / "out", "queries.parquet")["message"].to_pylist()
    assert told[0] is None and told[1] is not None
