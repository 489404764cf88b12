"""Tests shards: every row once after any failure, bits of the command line, skipped work."""

import json
import os
import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Batch

from colltrans import ConvexPolyhedron, clearance_many

pa = pytest.importorskip("pyarrow")
pq = pytest.importorskip("pyarrow.parquet")

from shards import (  # noqa: E402
    CORNERS,
    KEYS,
    all_ids,
    ids,
    queries,
    shards,
    write,
    write_bodies,
)

from colltrans.bulk import Bodies, Job, Options, Report, answer_shard, engines  # noqa: E402
from colltrans.bulk.__main__ import main  # noqa: E402


@pytest.fixture
def bodies(tmp_path: Path) -> Path:
    return write_bodies(tmp_path / "bodies.parquet")


def test_a_folder_of_shards(tmp_path: Path, bodies: Path, capsys: Any) -> None:
    asked = shards(tmp_path / "in", 3, 500)
    words = [str(asked), str(tmp_path / "out"), "--bodies", str(bodies), "--question", "clearance"]
    assert main(words) == 0
    assert "1,500 rows in 3 shards (0 were done before): 0 errors" in capsys.readouterr().out
    assert ids(tmp_path / "out") == all_ids(3, 500)
    table = pq.read_table(tmp_path / "out" / "shard-1.parquet")
    columns = queries(1, 500)
    cloud = np.random.default_rng(1).normal(size=(60, 3))
    known = clearance_many(
        [ConvexPolyhedron(CORNERS), ConvexPolyhedron(cloud)],
        ConvexPolyhedron(cloud),
        columns["direction"],
        moving_index=np.arange(500) % 2,
        moving_pose=columns["moving_pose"],
    )
    assert table["distance"].to_numpy().tobytes() == known.distance.tobytes()
    assert table["outcome"].to_pylist() == known.outcome.tolist()


def test_finished_shards_are_skipped_until_an_input_changes(
    tmp_path: Path, bodies: Path, capsys: Any
) -> None:
    asked = shards(tmp_path / "in", 3, 50)
    words = [str(asked), str(tmp_path / "out"), "--bodies", str(bodies)]
    for threads in ("1", "2"):
        assert main([*words, "--threads", threads]) == 0
    assert "(3 were done before)" in capsys.readouterr().out
    write(asked / "shard-1.parquet", queries(9, 50))
    (tmp_path / "out" / "shard-2.parquet").write_bytes(b"PAR1 half a file")
    assert main(words) == 0
    assert "(1 were done before)" in capsys.readouterr().out
    assert main([*words, "--solver", "cta"]) == 0
    assert "(0 were done before)" in capsys.readouterr().out
    table = pq.read_table(bodies)
    moved = [[[x + 1, y, z] for x, y, z in body] for body in table["vertices"].to_pylist()]
    pq.write_table(pa.table({"key": KEYS, "vertices": moved}), bodies)
    assert main([*words, "--solver", "cta"]) == 0
    assert "(0 were done before)" in capsys.readouterr().out
    assert not list((tmp_path / "out").glob(".*"))


def test_bad_rows_are_counted_and_kept(tmp_path: Path, bodies: Path) -> None:
    columns = queries(4, 100)
    columns["moving"][3], columns["fixed"][5], columns["moving"][7] = "broken", "nothing", None
    columns["moving_pose"][9, 0] = np.nan
    write(tmp_path / "queries.parquet", columns)
    out = tmp_path / "answers.parquet"
    assert main([str(tmp_path / "queries.parquet"), str(out), "--bodies", str(bodies)]) == 5
    table = pq.read_table(out)
    messages = {i: m for i, m in enumerate(table["message"].to_pylist()) if m}
    assert sorted(messages) == [3, 5, 7, 9]
    assert messages[3].startswith("moving: point 0 is not finite")
    assert messages[5].endswith("has no body 'nothing'")
    assert table["id"].to_pylist() == columns["id"]


def test_json_lines_equal_those_of_the_command_line(tmp_path: Path, batch: Batch) -> None:
    data = str(ROOT / "data")
    asked = [
        {
            "id": f"{x}",
            "moving": {"mesh": f"{data}/dodecahedron.off"},
            "fixed": {"mesh": f"{data}/bracket.obj"},
            "moving_pose": {"translation": [x, 1, 9], "rotation": [0.6, 0, 0, 0.8]},
            "direction": [0, 0.1, -1],
        }
        for x in np.linspace(-2, 12, 40)
    ]
    bad = ["{", "[]", '{"moving": "none.off", "fixed": "none.off", "direction": "up"}']
    lines = [*map(json.dumps, asked), *bad]
    (tmp_path / "queries.jsonl").write_text("\n".join(lines) + "\n")
    out = tmp_path / "answers.parquet"
    assert main([str(tmp_path / "queries.jsonl"), str(out)]) == 5
    rows = pq.read_table(out).to_pylist()
    assert [row["outcome"] for row in rows[40:]] == ["error"] * 3
    for row, line in zip(rows, batch(asked), strict=False):
        assert (row["outcome"], row["id"]) == (line["outcome"], line["id"])
        if "exit" in line:
            assert (row["translation"], row["exit"]) == (line["translation"], line["exit"])
            assert (row["normal"], row["point"]) == (line["normal"], line["point"])


MESH = str(ROOT / "data" / "dodecahedron.off")
QUERY = {"moving": MESH, "fixed": MESH, "direction": [0, 0, -1], "moving_pose": [0, 0, 9]}


def test_lines_with_another_question_become_errors_and_lose_no_row(tmp_path: Path) -> None:
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"moving": {"mesh": MESH, "scale": 2}}, "moving: expected a key, or an object with"),
        ({"moving": {"mesh": MESH, "hull": True}}, "moving: expected a key, or an object with"),
        ({"fixed": {"points": [[0, 0, 0]]}}, "fixed: expected a key, or an object with"),
        ({"fixed": None}, "fixed: expected a key, or an object with"),
        ({"query": "clearance"}, "the question 'range' does not read 'query', which would"),
        ({"solver": "cta"}, "the question 'range' does not read 'solver', which would"),
        ({"length": 1}, "the question 'range' does not read 'length'; --keep length"),
        (
            {"min_gaps": 1},
            "the question 'range' does not read 'min_gaps' (is it 'min_gap'?); --keep min_gaps",
        ),
        ({"moving_pose": {"matrix": np.eye(4).tolist()}}, "moving_pose: neither a list of numbers"),
        ({"moving_pose": {"translation": 5}}, "moving_pose.translation: not a list of numbers"),
        ({"moving_pose": {"rotation": [0, 1]}}, "moving_pose: 3 and 2 numbers, not 3 and 4"),
        ({"moving_pose": [0, 0]}, "moving_pose: 2 numbers"),
        ({"direction": {"translation": [0, 0, 1]}}, "direction: neither a list of numbers"),
        ({"direction": [True, 0, 0]}, "direction: not a list of numbers"),
        ({"direction": [10**400, 0, 0]}, "int too large"),
        ({"graze_tolerance": "no"}, "graze_tolerance: not a list of numbers"),
        ({"moving": "\ud800"}, "'utf-8' codec"),
    ]
    lines = [json.dumps(QUERY | {"id": k} | part).encode() for k, (part, _) in enumerate(wrong)]
    lines += [
        b"\xff\xfe",
        b"[" * 100_000,
        b'{"moving": "a\\u0000b", "fixed": "c", "direction": [1,0,0]}',
    ]
    lines += [b"", b"\xef\xbb\xbf" + json.dumps(QUERY | {"id": "\ud800"}).encode()]
    (tmp_path / "queries.jsonl").write_bytes(b"\n".join(lines) + b"\n")
    out = tmp_path / "answers.parquet"
    assert main([str(tmp_path / "queries.jsonl"), str(out)]) == 5
    *rows, whole = pq.read_table(out).to_pylist()
    assert len(rows) == len(wrong) + 3 and whole["outcome"] == "contact" and whole["id"] == "?"
    assert {row["outcome"] for row in rows} == {"error"}
    for k, (row, (_, message)) in enumerate(zip(rows, wrong, strict=False)):
        assert row["id"] == str(k)
        assert row["message"].startswith(f"line {k + 1}: {message}")


def test_a_shard_without_queries_has_no_answers(tmp_path: Path, bodies: Path, capsys: Any) -> None:
    asked = shards(tmp_path / "in", 2, 10)
    full = pq.read_table(asked / "shard-0.parquet")
    pq.write_table(full.slice(0, 0), asked / "shard-1.parquet")
    (asked / "lines.jsonl").write_text("\n")
    words = [str(asked), str(tmp_path / "out"), "--bodies", str(bodies)]
    assert main(words) == 0 and main(words) == 0
    assert "10 rows in 3 shards (3 were done before)" in capsys.readouterr().out
    first, second = (pq.read_table(tmp_path / "out" / f"shard-{k}.parquet") for k in (0, 1))
    assert second.num_rows == 0 and first.schema == second.schema


@pytest.mark.parametrize(
    ("name", "column"),
    [
        ("direction", ["up", "down"]),
        ("direction", [1.0, 2.0]),
        ("moving_pose", [["a"], ["b"]]),
        ("graze_tolerance", ["a", "b"]),
    ],
)
def test_columns_of_a_wrong_type_are_refused(
    tmp_path: Path, bodies: Path, name: str, column: list[Any], capsys: Any
) -> None:
    file = tmp_path / "queries.parquet"
    write(file, queries(1, 2) | {name: column})
    assert main([str(file), str(tmp_path / "out"), "--bodies", str(bodies)]) == 2
    assert f"error: {file}: the column '{name}' has " in capsys.readouterr().err
    assert not list((tmp_path / "out").iterdir())


def test_invalid_tables_of_bodies_are_refused(tmp_path: Path, bodies: Path, capsys: Any) -> None:
    file, table = tmp_path / "queries.parquet", tmp_path / "table.parquet"
    write(file, queries(1, 4))
    words = [str(file), str(tmp_path / "out"), "--bodies", str(table)]
    corners = CORNERS.tolist()
    pq.write_table(pa.table({"key": ["cube"]}), table)
    assert main(words) == 2 and "no column 'vertices'" in capsys.readouterr().err
    pq.write_table(pa.table({"key": ["cube"] * 2, "vertices": [corners] * 2}), table)
    assert main(words) == 5
    told = pq.read_table(tmp_path / "out" / "queries.parquet")["message"].to_pylist()
    assert "the body 'cube' twice" in told[0]
    table.write_text("no table")
    assert main(words) == 2 and "table.parquet" in capsys.readouterr().err
    pq.write_table(pa.table({"key": KEYS[:2], "vertices": [[[1.0, 2.0], [3.0]], corners]}), table)
    assert main(words) == 5
    message = pq.read_table(tmp_path / "out" / "queries.parquet")["message"][0].as_py()
    assert message.startswith("moving: points: not an array of numbers")


def test_a_copied_table_of_bodies_is_not_read_again(bodies: Path) -> None:
    here = Bodies(str(bodies))
    here.share()
    digest = here.digest(())
    buffers: list[pickle.PickleBuffer] = []
    told = pickle.dumps(here, protocol=5, buffer_callback=buffers.append)
    # The vertices are not in the pickle, because copies share the file.
    numbers = sum(len(buffer.raw()) for buffer in buffers)
    assert numbers > 60 * 3 * 8
    there = pickle.loads(told, buffers=buffers)
    # Other copies read the table again.
    begun = Bodies(str(bodies))
    begun.get(KEYS[:1])
    assert pickle.loads(pickle.dumps(begun))._rows is None
    bodies.unlink()
    assert there.digest(()) == digest
    for mine, its in zip(here.get(KEYS[:2]), there.get(KEYS[:2]), strict=True):
        assert isinstance(mine, ConvexPolyhedron) and isinstance(its, ConvexPolyhedron)
        assert mine.vertices.tobytes() == its.vertices.tobytes()
    assert str(there.get(["broken"])[0]) == str(here.get(["broken"])[0])


@pytest.mark.parametrize(
    "words",
    [
        ["nowhere", "out"],
        ["torn.parquet", "out"],
        ["empty", "out"],
        ["empty/../bodies.parquet", "bodies.parquet"],
        ["bodies.parquet", "out", "--threads", "0"],
        ["bodies.parquet", "out"],
    ],
)
def test_invalid_files_are_refused(
    tmp_path: Path, bodies: Path, words: list[str], capsys: Any, monkeypatch: Any
) -> None:
    monkeypatch.chdir(bodies.parent)
    (tmp_path / "empty").mkdir()
    (tmp_path / "torn.parquet").write_bytes(b"PAR1 half a file")
    assert main(words) == 2
    assert capsys.readouterr().err.startswith("error: ")


def command(asked: Path, out: Path, bodies: Path, *more: str) -> list[str]:
    words = [str(asked), str(out), "--bodies", str(bodies), *more]
    return [sys.executable, "-m", "colltrans.bulk", *words]


def killed_and_repeated(asked: Path, out: Path, bodies: Path, *more: str) -> str:
    """Kills the program after it has answered a shard, runs it again and returns its output."""
    run = command(asked, out, bodies, *more)
    with subprocess.Popen(run, start_new_session=True) as process:
        began = time.monotonic()
        while not list(out.glob("shard-*.parquet")) and time.monotonic() - began < 300:
            time.sleep(0.002)
        os.killpg(process.pid, signal.SIGKILL)
    assert list(out.glob("shard-*.parquet")), "no shard was answered in 300 s"
    again = subprocess.run(run, capture_output=True, text=True)
    assert again.returncode == 0, again.stderr
    return again.stdout


@pytest.mark.skipif(os.name == "nt", reason="processes are killed another way")
def test_a_killed_run_is_resumed(tmp_path: Path, bodies: Path) -> None:
    asked = shards(tmp_path / "in", 8, 60_000)
    told = killed_and_repeated(asked, tmp_path / "out", bodies, "--threads", "1")
    assert "(0 were done before)" not in told
    assert ids(tmp_path / "out") == all_ids(8, 60_000)


@pytest.mark.skipif(os.name == "nt", reason="signals are sent another way")
def test_an_interrupt_ends_the_run_and_leaves_no_partial_file(tmp_path: Path, bodies: Path) -> None:
    asked, out = shards(tmp_path / "in", 1, 1_000_000), tmp_path / "out"
    run = command(asked, out, bodies, "--threads", "1")
    with subprocess.Popen(run, stderr=subprocess.PIPE, text=True) as process:
        began = time.monotonic()
        while not list(out.glob(".*.partial")) and time.monotonic() - began < 300:
            time.sleep(0.01)
        sent = time.monotonic()
        process.send_signal(signal.SIGINT)
        assert process.stderr is not None
        assert "interrupted" in process.stderr.read()
        assert process.wait() == 130
        # Takes a second on an idle machine.
        assert time.monotonic() - sent < 5
    assert not list(out.iterdir())


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    ray = pytest.importorskip("ray")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
        # Lets workers import the modules of the tests.
        patch.setenv("PYTHONPATH", str(Path(__file__).parent))
        yield ray
    ray.shutdown()


def dies_once(job: Job, bodies: Bodies) -> Report:
    """Answers a shard, but kills the first worker that reaches this one half way."""
    marker = Path(job.answers + ".died")
    if job.queries.endswith("shard-1.parquet") and not marker.exists():
        marker.touch()

        def die(rows: int) -> None:
            os.kill(os.getpid(), signal.SIGKILL)

        return answer_shard(job, bodies, die)
    return answer_shard(job, bodies)


@pytest.mark.filterwarnings("ignore")
def test_ray_answers_every_row_once_even_if_a_worker_dies(
    tmp_path: Path, bodies: Path, cluster: Any
) -> None:
    asked = shards(tmp_path / "in", 5, 2000)
    files = sorted(asked.glob("*.parquet"))
    (tmp_path / "out").mkdir()
    jobs = [Job(str(f), str(tmp_path / "out" / f.name), Options()) for f in files]
    here = Bodies(str(bodies))
    reports = list(engines.ray([jobs[:2], *([j] for j in jobs[2:])], here, 2, answer=dies_once))
    assert (tmp_path / "out" / "shard-1.parquet.died").exists()
    assert sum(report.rows for report in reports) == 10_000 and len(reports) == 5
    assert ids(tmp_path / "out") == all_ids(5, 2000)
    again = list(engines.ray([jobs], here, 2))
    assert all(report.skipped for report in again)
    known = tmp_path / "known"
    assert main([str(asked), str(known), "--bodies", str(bodies)]) == 0
    for file in files:
        mine, its = (pq.read_table(f / file.name) for f in (known, tmp_path / "out"))
        assert mine["translation"].to_numpy().tobytes() == its["translation"].to_numpy().tobytes()
    cluster.shutdown()


@pytest.mark.skipif(os.name == "nt", reason="processes are killed another way")
def test_ray_resumes_after_its_driver_died(tmp_path: Path, bodies: Path, cluster: Any) -> None:
    asked = shards(tmp_path / "in", 8, 60_000)
    more = ("--engine", "ray", "--threads", "2")
    told = killed_and_repeated(asked, tmp_path / "out", bodies, *more)
    assert "(0 were done before)" not in told
    assert ids(tmp_path / "out") == all_ids(8, 60_000)
