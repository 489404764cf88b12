"""Tests reads of queries: only the needed bytes, repeated after faults, of one version."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pa = pytest.importorskip("pyarrow")
pq = pytest.importorskip("pyarrow.parquet")
pytest.importorskip("fsspec")
pytest.importorskip("aiohttp")

from servers import FileServer, s3_bucket, serving  # noqa: E402
from shards import KEYS, all_ids, ids, queries, same, table_of, write, write_bodies  # noqa: E402

from colltrans.bulk import (  # noqa: E402
    Bodies,
    ChangedError,
    Job,
    NoRangesError,
    Options,
    ReadError,
    answer_shard,
    files,
    sources,
)
from colltrans.bulk.__main__ import main  # noqa: E402


@pytest.fixture
def bodies(tmp_path: Path) -> Path:
    return write_bodies(tmp_path / "bodies.parquet")


@pytest.fixture(autouse=True)
def no_pauses(monkeypatch: Any) -> None:
    monkeypatch.setattr(files, "PAUSE", 0.001)


@pytest.fixture
def server(tmp_path: Path) -> Iterator[FileServer]:
    (tmp_path / "web").mkdir()
    with serving(tmp_path / "web") as server:
        yield server


def row_groups(server: FileServer, name: str = "large.parquet", rows: int = 20_000) -> Path:
    """Writes a file with 100 row groups and returns its path."""
    return write(server.folder / name, queries(0, rows), row_group_size=rows // 100)


def words_for(server: FileServer, name: str, out: Path, bodies: Path, *more: str) -> list[str]:
    return [f"{server.url}/{name}", str(out), "--bodies", str(bodies), *more]


def test_each_byte_of_row_groups_is_sent_once(
    tmp_path: Path, bodies: Path, server: FileServer
) -> None:
    size = row_groups(server).stat().st_size
    words = words_for(server, "large.parquet", tmp_path / "out", bodies)
    assert main([*words, "--rows-per-task", "1000"]) == 0
    assert ids(tmp_path / "out") == all_ids(1, 20_000)
    assert len(list((tmp_path / "out").iterdir())) == 20
    # The footer once, and each task the bytes of its row groups.
    assert server.sent <= size + sources.FOOTER
    ranges = server.gets("large.parquet")
    assert len(ranges) == 21 and None not in ranges


def test_row_groups_in_a_bucket_are_requested_by_ranges(
    tmp_path: Path, bodies: Path, monkeypatch: Any
) -> None:
    with s3_bucket(monkeypatch) as system:
        file = write(tmp_path / "größe.parquet", queries(0, 20_000), row_group_size=200)
        system.put_file(str(file), "bucket/in/größe.parquet")
        gets: list[str | None] = []
        known = type(system)._call_s3

        async def counted(self: Any, method: str, *rest: Any, **more: Any) -> Any:
            if method == "get_object":
                gets.append(more.get("Range"))
            return await known(self, method, *rest, **more)

        monkeypatch.setattr(type(system), "_call_s3", counted)
        words = ["s3://bucket/in/größe.parquet", "s3://bucket/out", "--bodies", str(bodies)]
        assert main([*words, "--rows-per-task", "5000"]) == 0
        spans = [re.fullmatch(r"bytes=(\d+)-(\d+)", get or "") for get in gets]
        assert len(spans) == 5
        sent = sum(int(span[2]) - int(span[1]) + 1 for span in spans if span)
        size = file.stat().st_size
        assert size - sources.FOOTER < sent <= size + sources.FOOTER
        assert main([*words, "--rows-per-task", "5000", "--check"]) == 0
        system.get("bucket/out/", str(tmp_path / "out"), recursive=True)
    assert ids(tmp_path / "out") == all_ids(1, 20_000)


def test_a_large_footer_is_read_once_in_two_requests(
    tmp_path: Path, bodies: Path, server: FileServer, monkeypatch: Any
) -> None:
    size = row_groups(server).stat().st_size
    monkeypatch.setattr(sources, "FOOTER", 100)
    words = words_for(server, "large.parquet", tmp_path / "out", bodies)
    assert main([*words, "--rows-per-task", "10000"]) == 0
    assert len(server.gets("large.parquet")) == 4 and server.sent <= size + 200


def test_a_server_without_ranges_sends_the_file_to_one_task(
    tmp_path: Path, bodies: Path, capsys: Any
) -> None:
    with serving(tmp_path / "web", ranges=False) as server:
        row_groups(server)
        words = words_for(server, "large.parquet", tmp_path / "out", bodies)
        assert main([*words, "--rows-per-task", "1000"]) == 0
        assert "note: one shard, read completely" in capsys.readouterr().err
        with pytest.raises(NoRangesError):
            sources.source_of(f"{server.url}/large.parquet")
    assert [file.name for file in (tmp_path / "out").iterdir()] == ["large.parquet"]
    assert ids(tmp_path / "out") == all_ids(1, 20_000)


def test_faults_that_pass_are_not_noticed(tmp_path: Path, bodies: Path, server: FileServer) -> None:
    row_groups(server)
    write_bodies(server.folder / "bodies.parquet")
    server.faults = 4
    words = [f"{server.url}/large.parquet", str(tmp_path / "out")]
    words += ["--bodies", f"{server.url}/bodies.parquet", "--rows-per-task", "5000"]
    assert main(words) == 0
    assert server.faults == 0 and ids(tmp_path / "out") == all_ids(1, 20_000)


def test_faults_during_a_task_are_not_noticed(
    tmp_path: Path, bodies: Path, server: FileServer
) -> None:
    row_groups(server)
    url = f"{server.url}/large.parquet"
    source = sources.source_of(url)
    server.faults = 3
    job = Job(url, str(tmp_path / "out.parquet"), Options(), (10, 20), source)
    assert answer_shard(job, Bodies(str(bodies))).rows == 2000


def test_faults_that_last_are_typed_errors(
    tmp_path: Path, bodies: Path, server: FileServer, capsys: Any
) -> None:
    row_groups(server)
    url = f"{server.url}/large.parquet"
    source = sources.source_of(url)
    server.faults = 1 << 30
    job = Job(url, str(tmp_path / "out.parquet"), Options(), (10, 20), source)
    with pytest.raises(ReadError, match=r"large\.parquet: .*503.*in 6 attempts"):
        answer_shard(job, Bodies(str(bodies)))
    assert len([get for get in server.gets("large.parquet") if get != "bytes=4-"]) >= 6
    assert main(words_for(server, "large.parquet", tmp_path / "out", bodies)) == 2
    assert "503" in capsys.readouterr().err
    server.faults = 0
    with pytest.raises(ReadError, match="404"):
        sources.source_of(f"{server.url}/none.parquet")
    # A missing file is not requested again; HEAD is followed by GET.
    assert len(server.gets("none.parquet")) == 1


def test_a_file_that_changes_after_its_footer_is_not_answered(
    tmp_path: Path, bodies: Path, server: FileServer
) -> None:
    for name in (f"{server.url}/large.parquet", str(server.folder / "large.parquet")):
        file = row_groups(server)
        source = sources.source_of(name)
        write(file, queries(1, 20_000), row_group_size=200)
        job = Job(name, str(tmp_path / "out.parquet"), Options(), (10, 20), source)
        with pytest.raises(ChangedError, match="has changed while it was read: from"):
            answer_shard(job, Bodies(str(bodies)))
        # Shorter than the footer says.
        file.write_bytes(file.read_bytes()[:1000])
        with pytest.raises(ChangedError):
            answer_shard(job, Bodies(str(bodies)))
        assert not list(tmp_path.glob("*out.parquet*"))


def test_a_file_that_changes_while_it_is_answered_has_no_answers(
    tmp_path: Path, bodies: Path
) -> None:
    file = write(tmp_path / "queries.parquet", queries(0, 100))
    job = Job(str(file), str(tmp_path / "out.parquet"), Options())

    def change(rows: int) -> None:
        write(file, queries(1, 100))

    with pytest.raises(ChangedError):
        answer_shard(job, Bodies(str(bodies)), change)
    assert not list(tmp_path.glob("*out.parquet*"))


@pytest.mark.parametrize("kept", [0, 7, 11, 1000, 400_000])
def test_truncated_files_are_errors(
    tmp_path: Path, bodies: Path, server: FileServer, kept: int, capsys: Any
) -> None:
    file = row_groups(server)
    assert kept < file.stat().st_size
    file.write_bytes(file.read_bytes()[:kept])
    for name in (f"{server.url}/large.parquet", str(file)):
        with pytest.raises(ReadError, match=r"large\.parquet"):
            sources.source_of(name)
        words = [name, str(tmp_path / "out"), "--bodies", str(bodies), "--rows-per-task", "1000"]
        assert main(words) == 2
        assert f"error: {name}: " in capsys.readouterr().err


def test_a_footer_that_names_bytes_beyond_the_end_is_an_error(
    tmp_path: Path, bodies: Path, server: FileServer
) -> None:
    file = row_groups(server)
    whole = file.read_bytes()
    length = int.from_bytes(whole[-8:-4], "little") + 8
    file.write_bytes(whole[:1000] + whole[-length:])
    url = f"{server.url}/large.parquet"
    job = Job(url, str(tmp_path / "out.parquet"), Options(), (90, 99), sources.source_of(url))
    with pytest.raises(ReadError, match="large.parquet"):
        answer_shard(job, Bodies(str(bodies)))


def test_names_with_any_letters_are_read(tmp_path: Path, bodies: Path, server: FileServer) -> None:
    for k, name in enumerate(["größe 1.parquet", "名前#2?.parquet", "50%.parquet"]):
        write(server.folder / "in" / name, queries(k, 500), row_group_size=100)
    more = ("--rows-per-task", "200")
    assert main(words_for(server, "in", tmp_path / "out", bodies, *more)) == 0
    assert ids(tmp_path / "out") == all_ids(3, 500)
    here = [str(server.folder / "in"), str(tmp_path / "ö ü"), "--bodies", str(bodies), *more]
    assert main(here) == 0
    assert ids(tmp_path / "ö ü") == all_ids(3, 500)


def test_small_files_are_joined_to_tasks(tmp_path: Path, bodies: Path, monkeypatch: Any) -> None:
    assert sources.packed([3, 3, 3, 12, 1, None, 2, 2, 0], 6) == [
        [0, 1],
        [2],
        [3],
        [4],
        [5],
        [6, 7, 8],
    ]
    from colltrans.bulk import engines

    seen: list[list[int | None]] = []
    known = engines.local

    def spied(tasks: Any, *rest: Any) -> Any:
        seen.extend([job.rows for job in task] for task in tasks)
        return known(tasks, *rest)

    monkeypatch.setattr(engines, "local", spied)
    for k in range(7):
        write(tmp_path / "in" / f"{k}.parquet", queries(k, 100))
    write(tmp_path / "in" / "9.parquet", queries(7, 1000), row_group_size=100)
    words = [str(tmp_path / "in"), str(tmp_path / "out"), "--bodies", str(bodies)]
    assert main([*words, "--rows-per-task", "300"]) == 0
    assert seen == [[100] * 3, [100] * 3, [100], [300], [300], [300], [100]]
    assert len(list((tmp_path / "out").iterdir())) == 11
    assert len(ids(tmp_path / "out")) == 1700


def test_empty_row_groups_lose_no_row(tmp_path: Path, bodies: Path, server: FileServer) -> None:
    table = table_of(queries(0, 300))
    for name, counts in {"some": (0, 100, 0, 0, 200, 0), "none": (0, 0, 0), "no": ()}.items():
        with pq.ParquetWriter(server.folder / f"{name}.parquet", table.schema) as writer:
            begin = 0
            for count in counts:
                writer.write_table(table.slice(begin, count), row_group_size=1000)
                begin += count
    for place in (server.url, str(server.folder)):
        for name, shards in {"some": 2, "none": 1, "no": 1}.items():
            out = tmp_path / f"{name} {place[:4].strip('/')}"
            words = [f"{place}/{name}.parquet", str(out), "--bodies", str(bodies)]
            assert main([*words, "--rows-per-task", "100"]) == 0
            assert ids(out) == (all_ids(1, 300) if name == "some" else [])
            assert len(list(out.iterdir())) == shards


def test_a_job_of_empty_row_groups_has_an_empty_file(tmp_path: Path, bodies: Path) -> None:
    table, file = table_of(queries(0, 100)), tmp_path / "queries.parquet"
    with pq.ParquetWriter(file, table.schema) as writer:
        for part in (table, table[:0], table[:0]):
            writer.write_table(part)
    job = Job(str(file), str(tmp_path / "out.parquet"), Options(), (1, 3))
    assert answer_shard(job, Bodies(str(bodies))).rows == 0
    assert pq.read_table(tmp_path / "out.parquet").num_rows == 0


def test_a_huge_row_group_is_not_held_in_memory(tmp_path: Path, bodies: Path) -> None:
    rows = 400_000
    file = write(tmp_path / "queries.parquet", queries(0, rows), row_group_size=rows)
    assert pq.read_metadata(file).num_row_groups == 1
    numbers = rows * 10 * 8
    pool, before = pa.default_memory_pool(), pa.total_allocated_bytes()
    most = 0

    def watch(_: int) -> None:
        nonlocal most
        most = max(most, pool.bytes_allocated() - before)

    job = Job(str(file), str(tmp_path / "out.parquet"), Options())
    assert answer_shard(job, Bodies(str(bodies)), watch).rows == rows
    # Without a buffer the compressed bytes of all columns would be held.
    assert most < numbers, (most, numbers)


def test_nested_columns_are_kept_in_their_order(
    tmp_path: Path, bodies: Path, server: FileServer
) -> None:
    table = table_of(queries(0, 600))
    kind = pa.struct([("z", pa.int64()), ("a", pa.struct([("k", pa.string()), ("b", pa.int8())]))])
    nested = [{"z": i, "a": {"k": str(i), "b": i % 100}} if i % 7 else None for i in range(600)]
    table = table.add_column(1, "tags", pa.array(nested, kind))
    pq.write_table(table, server.folder / "nested.parquet", row_group_size=100)
    more = ("--rows-per-task", "200", "--keep", "tags")
    assert main(words_for(server, "nested.parquet", tmp_path / "out", bodies, *more)) == 0
    out = pq.read_table(tmp_path / "out")
    assert out.schema.field("tags").type == kind
    assert out["tags"].to_pylist() == nested and out["id"].to_pylist() == table["id"].to_pylist()


def test_files_of_different_schemas_are_answered_alone(
    tmp_path: Path, bodies: Path, capsys: Any
) -> None:
    columns = queries(0, 50)
    write(tmp_path / "in" / "a.parquet", columns)
    # Columns in another order, of other types, one less.
    swapped = {name: columns[name] for name in reversed(columns) if name != "moving_pose"}
    swapped["direction"] = columns["direction"].tolist()
    swapped["id"] = list(range(50))
    write(tmp_path / "in" / "b.parquet", swapped)
    write(tmp_path / "in" / "c.parquet", columns | {"direction": ["up"] * 50})
    words = [str(tmp_path / "in"), str(tmp_path / "out"), "--bodies", str(bodies)]
    assert main([*words, "--rows-per-task", "1000"]) == 2
    told = capsys.readouterr()
    assert "100 rows in 2 shards" in told.out
    assert "c.parquet: the column 'direction' has string" in told.err
    first, second = (pq.read_table(tmp_path / "out" / f"{name}.parquet") for name in "ab")
    assert first.drop_columns("id").schema.equals(second.drop_columns("id").schema)


def test_two_shards_with_one_name_are_refused(tmp_path: Path, bodies: Path, capsys: Any) -> None:
    write(tmp_path / "in" / "a.parquet", queries(0, 200), row_group_size=100)
    write(tmp_path / "in" / "a-00000-of-00002.parquet", queries(1, 10))
    words = [str(tmp_path / "in"), str(tmp_path / "out"), "--bodies", str(bodies)]
    assert main([*words, "--rows-per-task", "100"]) == 2
    assert "a-00000-of-00002.parquet: two shards have this file" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    assert main(words) == 0


def test_errors_of_rows_have_types(tmp_path: Path, bodies: Path) -> None:
    columns = queries(4, 100)
    columns["moving"][3], columns["fixed"][5], columns["moving"][7] = "broken", "nothing", None
    columns["moving_pose"][9, 0] = np.nan
    columns["moving_pose"][11, 3:] = 2
    columns["direction"][13] = 0
    write(tmp_path / "queries.parquet", columns)
    out = tmp_path / "answers.parquet"
    assert main([str(tmp_path / "queries.parquet"), str(out), "--bodies", str(bodies)]) == 5
    table = pq.read_table(out)
    assert {i: e for i, e in enumerate(table["error"].to_pylist()) if e} == {
        3: "BuildError",
        5: "InputError",
        7: "InputError",
        9: "PoseError",
        11: "PoseError",
        13: "QueryError",
    }
    lines = [{"moving": "none.off", "fixed": "none.off", "direction": [0, 0, 1]}]
    (tmp_path / "queries.jsonl").write_text("\n".join([*map(json.dumps, lines), "{"]) + "\n")
    assert main([str(tmp_path / "queries.jsonl"), str(out)]) == 5
    assert pq.read_table(out)["error"].to_pylist() == ["MissingFileError", "InputError"]


def test_a_small_cache_changes_no_answer(tmp_path: Path) -> None:
    random = np.random.default_rng(5)
    count = 400
    clouds = random.normal(size=(count, 20, 3))
    table = tmp_path / "bodies.parquet"
    keys = [str(k) for k in range(count)]
    pq.write_table(pa.table({"key": keys, "vertices": clouds.tolist()}), table)
    columns = queries(3, 5000)
    columns["moving"] = [keys[k] for k in random.integers(0, count, 5000)]
    columns["fixed"] = [keys[k] for k in random.integers(0, count, 5000)]
    file = write(tmp_path / "queries.parquet", columns)
    words = [str(file), "--bodies", str(table)]
    for name, size in {"large": 1 << 30, "small": 200_000, "none": 0}.items():
        out = str(tmp_path / f"{name}.parquet")
        assert main([words[0], out, *words[1:], "--cache-bytes", str(size)]) == 0
    large, small, none = (
        pq.read_table(tmp_path / f"{n}.parquet") for n in ("large", "small", "none")
    )
    assert same(large, small) and same(large, none)
    kept = Bodies(str(table), cache_bytes=200_000)
    for begin in range(0, count, 10):
        kept.get(keys[begin : begin + 10])
        assert kept._held <= 200_000
    assert 0 < len(kept._cache) < count
    assert KEYS[0] not in keys
