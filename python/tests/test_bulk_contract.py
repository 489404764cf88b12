"""Tests files of queries: no ignored column, no undetected change of a byte, no lost shard."""

import json
import os
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

from colltrans import InputError, Solid, clearance_many
from colltrans.motions import motion_clearance_many

pa = pytest.importorskip("pyarrow")
pq = pytest.importorskip("pyarrow.parquet")

from servers import s3_bucket  # noqa: E402
from shards import CORNERS, KEYS, all_ids, ids, queries, shards, table_of, write, write_bodies  # noqa: E402

from colltrans.bulk import Bodies, Options, answer_table, files  # noqa: E402
from colltrans.bulk.__main__ import main  # noqa: E402


@pytest.fixture
def bodies(tmp_path: Path) -> Path:
    return write_bodies(tmp_path / "bodies.parquet")


def test_misspelt_columns_are_refused_by_name(tmp_path: Path, bodies: Path, capsys: Any) -> None:
    columns = queries(1, 4)
    columns["moving_psoe"] = columns.pop("moving_pose")
    columns["weight"] = [1.0, 2.0, 3.0, 4.0]
    file = write(tmp_path / "queries.parquet", columns)
    words = [str(file), str(tmp_path / "out"), "--bodies", str(bodies)]
    assert main(words) == 2
    told = capsys.readouterr()
    assert "does not read 'moving_psoe' (is it 'moving_pose'?), 'weight'" in told.err
    assert "--keep moving_psoe,weight" in told.err and "1 shards FAILED" in told.out
    assert main([*words, "--keep", "moving_psoe"]) == 2
    assert "does not read 'weight'; --keep weight" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["scale", "solver", "tolerance", "hull"])
def test_columns_that_would_change_the_answer_are_refused(bodies: Path, name: str) -> None:
    table = table_of(queries(1, 2) | {name: [2.0, 3.0]})
    for kept in ((), (name,), ("*",)):
        with pytest.raises(InputError, match=f"'range' does not read '{name}', which would"):
            answer_table(table, Bodies(str(bodies)), Options(keep_columns=kept))


def test_extra_columns_are_copied_unchanged(tmp_path: Path, bodies: Path) -> None:
    columns = queries(1, 3) | {"weight": [1, None, 3], "labels": [["a"], [], None]}
    file = write(tmp_path / "queries.parquet", columns)
    words = [str(file), str(tmp_path / "out"), "--bodies", str(bodies)]
    assert main([*words, "--keep", "labels,moving,weight"]) == 0
    (out,) = (tmp_path / "out").glob("*.parquet")
    table, asked = pq.read_table(out), pq.read_table(file)
    assert table.column_names[:5] == ["id", "labels", "moving", "weight", "outcome"]
    assert main([*words, "--keep", "*"]) == 0
    whole = pq.read_table(out)
    assert whole.column_names[:7] == asked.column_names
    for name in asked.column_names:
        assert whole[name].to_pylist() == asked[name].to_pylist()
    assert np.array_equal(whole["translation"], table["translation"], equal_nan=True)


def test_columns_that_cannot_be_copied_are_reported(bodies: Path) -> None:
    table, known = table_of(queries(1, 2) | {"normal": [1, 2]}), Bodies(str(bodies))
    with pytest.raises(InputError, match="'normal' is not kept: the answers have one"):
        answer_table(table, known, Options(keep_columns=("normal",)))
    with pytest.raises(InputError, match="no column 'colour'"):
        answer_table(table_of(queries(1, 2)), known, Options(keep_columns=("colour",)))


def test_extra_fields_of_json_lines_are_copied(tmp_path: Path, bodies: Path) -> None:
    line = {"moving": "cube", "fixed": "cloud", "direction": [0, 0, -1], "moving_pose": [0, 0, 9]}
    more: list[dict[str, Any]] = [{"tag": {"a": [1]}}, {}, {"tag": "x"}, {"scale": 2}]
    lines = [json.dumps(line | {"id": k} | part) for k, part in enumerate(more)]
    (tmp_path / "queries.jsonl").write_text("\n".join([*lines, "{"]) + "\n")
    out = tmp_path / "answers.parquet"
    words = [str(tmp_path / "queries.jsonl"), str(out), "--bodies", str(bodies)]
    assert main([*words, "--keep", "tag"]) == 5
    told = pq.read_table(out)
    assert told["tag"].to_pylist() == ['{"a": [1]}', None, '"x"', None, None]
    assert told["outcome"].to_pylist() == ["contact"] * 3 + ["error"] * 2
    assert main([*words, "--keep", "*"]) == 5
    assert pq.read_table(out)["line"].to_pylist() == [*lines, "{"]


def test_a_bad_shard_is_named_and_the_others_finish(
    tmp_path: Path, bodies: Path, capsys: Any
) -> None:
    asked = shards(tmp_path / "in", 4, 50)
    (asked / "shard-1.parquet").write_bytes(b"PAR1 half a file")
    write(asked / "shard-3.parquet", {"moving": ["cube"], "fixed": ["cloud"]})
    words = [str(asked), str(tmp_path / "out"), "--bodies", str(bodies)]
    assert main(words) == 2
    told = capsys.readouterr()
    assert "100 rows in 2 shards" in told.out and "2 shards FAILED" in told.out
    assert f"error: {asked / 'shard-1.parquet'}: cannot read the queries: " in told.err
    assert f"error: {asked / 'shard-3.parquet'}: the queries have no column 'direction'" in told.err
    assert ids(tmp_path / "out") == sorted(f"{k}-{i}" for k in (0, 2) for i in range(50))


def flip(path: Path, place: int) -> None:
    held = bytearray(path.read_bytes())
    held[place] ^= 0x10
    path.write_bytes(held)


def end_of_column(path: Path, number: int) -> int:
    column = pq.read_metadata(path).row_group(0).column(number)
    begin = column.dictionary_page_offset or column.data_page_offset
    return int(begin + column.total_compressed_size - 5)


def test_flipped_bytes_in_answers_are_found(tmp_path: Path, bodies: Path, capsys: Any) -> None:
    asked, out = shards(tmp_path / "in", 3, 40), tmp_path / "out"
    words = [str(asked), str(out), "--bodies", str(bodies)]
    assert main([*words, "--check"]) == 2
    assert f"{out / 'shard-0.parquet'} does not exist" in capsys.readouterr().err
    assert main(words) == 0 and main([*words, "--check"]) == 0
    assert "120 rows in 3 shards (3 were done before)" in capsys.readouterr().out
    answers = out / "shard-1.parquet"
    written = answers.read_bytes()
    n = len(written)
    for place in [*range(12), *range(12, n, 301), *range(n - 300, n, 3)]:
        flip(answers, place)
        assert main([*words, "--check"]) == 2, place
        told = capsys.readouterr().err
        assert "shard-1.parquet" in told and "shard-0" not in told
        answers.write_bytes(written)
    for held in (written[:-1], written + b" ", written[:100], b""):
        answers.write_bytes(held)
        assert main([*words, "--check"]) == 2
    assert main(words) == 0
    assert "(2 were done before)" in capsys.readouterr().out
    assert answers.read_bytes() == written


def test_pages_of_answers_have_checksums(tmp_path: Path, bodies: Path) -> None:
    file, out = write(tmp_path / "queries.parquet", queries(1, 500)), tmp_path / "out.parquet"
    assert main([str(file), str(out), "--bodies", str(bodies), "--threads", "1"]) == 0
    flip(out, end_of_column(out, 2))
    with pytest.raises(OSError, match="CRC"):
        pq.read_table(out, page_checksum_verification=True)


def test_flipped_bytes_in_queries_are_found(tmp_path: Path, bodies: Path, capsys: Any) -> None:
    asked = shards(tmp_path / "in", 2, 40)
    file = write(asked / "shard-1.parquet", queries(1, 40), write_page_checksum=True)
    words = [str(asked), str(tmp_path / "out"), "--bodies", str(bodies)]
    assert main(words) == 0
    flip(file, end_of_column(file, 3))
    assert main([*words, "--check"]) == 2
    assert "shard-1.parquet belongs to other queries" in capsys.readouterr().err
    assert main(words) == 2
    told = capsys.readouterr()
    assert f"{file}: cannot read the queries: " in told.err and "CRC" in told.err
    assert "1 shards FAILED" in told.out


@pytest.mark.skipif(os.name == "nt", reason="files are limited another way")
def test_a_full_disk_fails_a_shard_and_leaves_no_partial_file(tmp_path: Path, bodies: Path) -> None:
    import resource

    asked, out = shards(tmp_path / "in", 2, 50), tmp_path / "out"
    write(asked / "large.parquet", queries(9, 20_000))

    def limited() -> None:  # Writes beyond it fail, as on a disk that is full.
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

    run = [sys.executable, "-m", "colltrans.bulk", str(asked), str(out), "--bodies", str(bodies)]
    told = subprocess.run(run, capture_output=True, text=True, preexec_fn=limited)
    assert told.returncode == 2
    assert f"{out / 'large.parquet'} cannot be written: " in told.stderr
    assert "100 rows in 2 shards" in told.stdout and "1 shards FAILED" in told.stdout
    assert sorted(file.name for file in out.iterdir()) == ["shard-0.parquet", "shard-1.parquet"]
    assert subprocess.run(run).returncode == 0
    assert len(ids(out)) == 20_100


@pytest.mark.skipif(os.name == "nt", reason="processes are killed another way")
def test_files_of_dead_runs_are_removed_and_those_of_live_runs_are_not(
    tmp_path: Path, bodies: Path
) -> None:
    asked, out = shards(tmp_path / "in", 1, 500_000), tmp_path / "out"
    run = [sys.executable, "-m", "colltrans.bulk", str(asked), str(out), "--bodies", str(bodies)]
    with subprocess.Popen([*run, "--threads", "1"]) as process:
        began = time.monotonic()
        while not list(out.glob(".*.partial")) and time.monotonic() - began < 300:
            time.sleep(0.01)
        (partial,) = out.glob(".*.partial")
        assert files.clean([str(out / "shard-0.parquet")]) == 0
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
    assert partial.exists()
    shards(asked, 1, 50)
    assert main([*run[3:]]) == 0
    assert [file.name for file in out.iterdir()] == ["shard-0.parquet"]


def test_nested_folders_keep_their_paths(tmp_path: Path, bodies: Path, capsys: Any) -> None:
    asked, out = tmp_path / "in", tmp_path / "out"
    write(asked / "a" / "one.parquet", queries(0, 5))
    write(asked / "b" / "deep" / "one.parquet", queries(1, 5))
    write(asked / ".hidden" / "one.parquet", queries(2, 5))
    assert main([str(asked), str(out), "--bodies", str(bodies)]) == 0
    assert (out / "a" / "one.parquet").exists() and (out / "b" / "deep" / "one.parquet").exists()
    assert ids(out) == all_ids(2, 5)
    assert main([str(asked), str(asked / "out"), "--bodies", str(bodies)]) == 2
    assert "must not be in the folder of the queries" in capsys.readouterr().err


def test_row_groups_are_tasks(tmp_path: Path, bodies: Path, capsys: Any) -> None:
    asked = tmp_path / "in"
    write(asked / "large.parquet", queries(0, 1000), row_group_size=100)
    write(asked / "small.parquet", queries(1, 50))
    words = [str(asked), str(tmp_path / "out"), "--bodies", str(bodies), "--rows-per-task", "250"]
    assert main(words) == 0
    names = sorted(file.name for file in (tmp_path / "out").iterdir())
    assert names == [f"large-0000{k}-of-00004.parquet" for k in range(4)] + ["small.parquet"]
    assert ids(tmp_path / "out") == sorted(all_ids(1, 1000) + [f"1-{i}" for i in range(50)])
    sizes = [pq.read_metadata(tmp_path / "out" / name).num_rows for name in names]
    assert sizes == [300, 300, 300, 100, 50]
    columns = queries(0, 1000)
    columns["moving_pose"][950, 2] += 1
    write(asked / "large.parquet", columns, row_group_size=100)
    capsys.readouterr()
    assert main(words) == 0
    assert "(4 were done before)" in capsys.readouterr().out


@pytest.mark.parametrize(
    "torn",
    [b"", b"PAR1 half a file", b"PAR1" + bytes(64) + b"PAR1"],
    ids=["empty", "half", "no footer"],
)
def test_a_torn_file_among_row_groups_fails_alone(
    tmp_path: Path, bodies: Path, capsys: Any, torn: bytes
) -> None:
    asked, out = tmp_path / "in", tmp_path / "out"
    write(asked / "large.parquet", queries(0, 500), row_group_size=100)
    (asked / "torn.parquet").write_bytes(torn)
    whole = write(asked / "whole.parquet", queries(1, 500), row_group_size=100).read_bytes()
    (asked / "half.parquet").write_bytes(whole[: len(whole) // 2])
    words = [str(asked), str(out), "--bodies", str(bodies), "--rows-per-task", "250"]
    assert main(words) == 2
    told = capsys.readouterr()
    assert told.out.startswith("1,000 rows in 4 shards") and "2 shards FAILED" in told.out
    for name in ("half.parquet", "torn.parquet"):
        assert told.err.count(f"error: {asked / name}: ") == 1
    assert ids(out) == all_ids(2, 500)


def test_bodies_in_every_form_of_list_are_read(tmp_path: Path) -> None:
    faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    corners = [[x, y, z] for x in (0.0, 1) for y in (0.0, 1) for z in (0.0, 1)]
    faces = [face[::-1] for face in faces]
    numbers = pa.list_(pa.float64(), 3)
    kinds = [
        (pa.list_(pa.list_(pa.float64())), pa.list_(pa.list_(pa.int64()))),
        (pa.list_(numbers), pa.list_(pa.list_(pa.uint32(), 4))),
        (pa.large_list(pa.large_list(pa.float32())), pa.large_list(pa.list_(pa.int16()))),
    ]
    for of_points, of_faces in kinds:
        table = pa.table(
            {
                "key": ["none", "mesh", "hull"],
                "vertices": pa.array([None, corners, corners[:4]], of_points),
                "faces": pa.array([faces, faces, None], of_faces),
            }
        )
        pq.write_table(table, tmp_path / "bodies.parquet", row_group_size=2)
        known = Bodies(str(tmp_path / "bodies.parquet"))
        none, mesh, hull = known.get(["none", "mesh", "hull"])
        assert str(none) == "points: missing"
        assert repr(mesh) == "ConvexPolyhedron(8 vertices, 12 edges, 6 faces)"
        assert repr(hull).startswith("ConvexPolyhedron(4 vertices")


@pytest.mark.parametrize(
    ("vertices", "faces", "told"),
    [
        (
            [[0.0, 0.0], [1.0, 0.0, 0.0]],
            None,
            "points: not an array of numbers: point 0 has 2, not 3",
        ),
        ([[0.0, 0.0, 0.0], None], None, "points: entry 1 is null"),
        ([[0.0, None, 0.0]], None, "point 0 is not finite"),
        (CORNERS.tolist(), [[0, 1, 9]], "face 0"),
        (CORNERS.tolist(), [[0, 1, -1]], "faces: index -1 is out of range"),
        (CORNERS.tolist(), [[0, 1, None]], "faces: not an array of whole numbers"),
    ],
)
def test_rows_without_a_valid_body_become_errors(
    tmp_path: Path, vertices: Any, faces: Any, told: str
) -> None:
    table = pa.table({"key": ["it"], "vertices": [vertices], "faces": [faces]})
    pq.write_table(table, tmp_path / "bodies.parquet")
    (body,) = Bodies(str(tmp_path / "bodies.parquet")).get(["it"])
    assert isinstance(body, Exception) and told in str(body)


def test_solids_in_bulk_equal_single_answers(tmp_path: Path, capsys: Any) -> None:
    parts = [Solid.read(ROOT / "data" / name) for name in ("bolt.stl", "plate.off")]
    # Without the precision of the files, which tables do not contain.
    bolt, plate = (Solid(part.vertices, part.triangles) for part in parts)
    table = {
        "key": ["bolt", "plate", "bad"],
        "vertices": [bolt.vertices.tolist(), plate.vertices.tolist(), [[0.0, 0.0, 0.0]]],
        "faces": [bolt.triangles.tolist(), plate.triangles.tolist(), [[0, 0, 0]]],
    }
    known = tmp_path / "bodies.parquet"
    pq.write_table(pa.table(table), known)
    heights = np.array([[0.0, 0, 7], [0, 0, 9], [4, 0, 7]])
    columns = {
        "moving": ["bolt", "bolt", "bad"],
        "fixed": ["plate"] * 3,
        "direction": np.array([[0.0, 0, -1]] * 3),
        "moving_pose": heights,
        "tolerance": [None, 0.01, None],
    }
    file, out = write(tmp_path / "queries.parquet", columns), tmp_path / "out.parquet"
    words = [str(file), str(out), "--bodies", str(known), "--solids"]
    assert main([*words, "--question", "clearance"]) == 5
    told = pq.read_table(out)
    alone = clearance_many(bolt, plate, [0, 0, -1], moving_pose=heights[:2], tolerance=0.01)
    plain = clearance_many(bolt, plate, [0, 0, -1], moving_pose=heights[:2])
    assert told["distance"][0].as_py() == plain.distance[0]
    assert told["distance"][1].as_py() == alone.distance[1]
    assert told["outcome"].to_pylist() == ["blocked", "blocked", "error"]
    assert {"offset_distance_lower", "translation_upper"} <= set(told.column_names)
    assert main(words) == 2
    assert "unknown question 'range' of solids" in capsys.readouterr().err


def test_motion_clearances_in_bulk_equal_single_answers(tmp_path: Path, bodies: Path) -> None:
    screws = np.tile([0.0, 0, 0, 0, 0, 1, 1, 0], (4, 1)) * [
        [1, 1, 1, 1, 1, 1, k, 1] for k in range(4)
    ]
    columns = {"moving": ["cube"] * 4, "fixed": ["cloud"] * 4, "moving_screw": screws}
    columns |= {"moving_pose": np.tile([4.0, 0, 0], (4, 1)), "tolerance": [None, 0.1, None, 0.1]}
    known = Bodies(str(bodies))
    told = answer_table(table_of(columns), known, Options("motion_clearance"))
    cube, cloud = known.get(["cube", "cloud"])
    motions: dict[str, dict[str, Any]]
    motions = {
        "screw": {"point": [0, 0, 0], "axis": [0, 0, 1], "radians": np.arange(4.0), "rise": 0}
    }
    alone = motion_clearance_many(
        cube,  # type: ignore[arg-type]
        cloud,  # type: ignore[arg-type]
        motions,
        moving_pose=[4, 0, 0],
        tolerance=[np.nan, 0.1, np.nan, 0.1],
    )
    assert told["outcome"].to_pylist() == alone.outcome.tolist()
    assert np.array_equal(told["lower"], alone.lower, equal_nan=True)


@pytest.fixture
def memory() -> Iterator[Any]:
    fsspec = pytest.importorskip("fsspec")
    system = fsspec.filesystem("memory")
    yield system
    system.store.clear()


def test_queries_bodies_and_answers_can_be_urls(
    tmp_path: Path, bodies: Path, memory: Any, capsys: Any
) -> None:
    asked = shards(tmp_path / "in", 3, 40)
    for k in range(3):
        memory.put_file(str(asked / f"shard-{k}.parquet"), f"/in/deep/shard-{k}.parquet")
    memory.put_file(str(bodies), "/bodies.parquet")
    words = ["memory://in", "memory://out", "--bodies", "memory://bodies.parquet"]
    assert main(words) == 0 and main(words) == 0 and main([*words, "--check"]) == 0
    assert capsys.readouterr().out.count("(3 were done before)") == 2
    assert main([str(asked), str(tmp_path / "out"), "--bodies", str(bodies)]) == 0
    for k in range(3):
        here = (tmp_path / "out" / f"shard-{k}.parquet").read_bytes()
        assert memory.cat_file(f"/out/deep/shard-{k}.parquet") == here
    memory.pipe_file("/out/deep/shard-1.parquet", here[:-1])
    assert main([*words, "--check"]) == 2
    assert "memory://out/deep/shard-1.parquet is not a complete file" in capsys.readouterr().err
    for wrong in ("memory://none", "nothing://here"):
        assert main([wrong, "memory://out"]) == 2
        assert f"error: {wrong}: " in capsys.readouterr().err


def test_meshes_at_urls_are_read(tmp_path: Path, memory: Any, batch: Batch) -> None:
    memory.put_file(str(ROOT / "data" / "dodecahedron.off"), "/parts/one.off")
    line = {"moving": "one.off", "fixed": "memory://parts/one.off", "direction": [0, 0, -1]}
    lines = [line | {"moving_pose": [0, 0, 9]}, line | {"fixed": "two.off"}]
    memory.pipe_file("/parts/queries.jsonl", "\n".join(map(json.dumps, lines)).encode())
    assert main(["memory://parts/queries.jsonl", "memory://parts/out.parquet"]) == 5
    with files.local("memory://parts/out.parquet") as file:
        first, second = pq.read_table(file).to_pylist()
    mesh = {"mesh": "data/dodecahedron.off"}
    place = {"translation": [0, 0, 9]}
    (known,) = batch([line | {"moving": mesh, "fixed": mesh, "moving_pose": place}])
    assert first["translation"] == known["translation"]
    assert "two.off" in second["message"]


def test_an_s3_server_works_as_source_and_target(
    tmp_path: Path, bodies: Path, monkeypatch: Any
) -> None:
    with s3_bucket(monkeypatch) as system:
        asked = shards(tmp_path / "in", 2, 40)
        for k in range(2):
            system.put_file(str(asked / f"shard-{k}.parquet"), f"bucket/in/shard-{k}.parquet")
        system.put_file(str(bodies), "bucket/bodies.parquet")
        words = ["s3://bucket/in", "s3://bucket/out", "--bodies", "s3://bucket/bodies.parquet"]
        assert main(words) == 0 and main([*words, "--check"]) == 0
        system.get("bucket/out/", str(tmp_path / "out"), recursive=True)
        assert ids(tmp_path / "out") == all_ids(2, 40)


def test_features_and_free_directions_become_columns(tmp_path: Path, bodies: Path) -> None:
    asked = write(tmp_path / "queries.parquet", queries(1, 60))
    words = [str(asked), "--bodies", str(bodies), "--question"]
    assert main([*words[:1], str(tmp_path / "out"), *words[1:], "clearance", "--features"]) == 0
    answers = pq.read_table(tmp_path / "out" / "queries.parquet")
    columns = queries(1, 60)
    known: Any = Bodies(str(bodies)).get(KEYS[:2])
    row = clearance_many(
        known,
        known[1],
        columns["direction"],
        moving_index=np.arange(60) % 2,
        moving_pose=columns["moving_pose"],
        features=True,
    )
    assert row.moving_feature is not None and (row.moving_feature >= 0).any()
    assert answers["moving_feature"].to_pylist() == row.moving_feature.tolist()
    plain = {k: v for k, v in columns.items() if k != "direction"}
    asked = write(tmp_path / "all.parquet", {k: v[:8] for k, v in plain.items()})
    words = [str(asked), str(tmp_path / "out"), "--bodies", str(bodies), "--question", "directions"]
    assert main(words) in (0, 5)  # Bodies that overlap have no directions.
    answers = pq.read_table(tmp_path / "out" / "all.parquet")
    assert "free" in answers["outcome"].to_pylist() and "free_lower" in answers.column_names
    assert main([*words, "--features"]) == 2
