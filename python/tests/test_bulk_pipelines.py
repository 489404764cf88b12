"""Tests batches of queries in pipelines: equal answers, bad rows that fail alone, recipes."""

import pickle
import re
import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

pa = pytest.importorskip("pyarrow")
pq = pytest.importorskip("pyarrow.parquet")

from shards import queries, same, table_of, write, write_bodies  # noqa: E402

from colltrans import InputError  # noqa: E402
from colltrans.bulk import Answer, Bodies, Options, answer_table  # noqa: E402
from colltrans.bulk import table as bulk_table  # noqa: E402

GUIDE = ROOT / "docs" / "guide" / "bulk.md"


@pytest.fixture
def bodies(tmp_path: Path) -> Path:
    return write_bodies(tmp_path / "bodies.parquet")


def recipe(heading: str) -> str:
    """Returns the first block of Python in a section of the guide."""
    section = GUIDE.read_text().split(f"\n## {heading}\n")[1]
    found = re.search(r"```python\n(.*?)```", section, re.DOTALL)
    assert found, heading
    return found[1]


def test_batches_have_the_answers_of_the_table(bodies: Path) -> None:
    table = table_of(queries(1, 300) | {"weight": list(range(300))})
    options = Options("clearance", threads=1, keep_columns=("weight",))
    answer = Answer(str(bodies), options)
    told, known = answer(table), answer_table(table, Bodies(str(bodies)), options)
    assert same(told, known.cast(told.schema))
    assert told.schema == answer.schema(table.schema)
    assert not any(pa.types.is_dictionary(kind) for kind in told.schema.types)
    (batch,) = table.to_batches()
    assert pa.Table.from_batches(answer.batches([batch, batch])).num_rows == 600
    with pytest.raises(InputError, match="batch_format"):
        answer({"moving": np.array(["cube"])})


def test_a_batch_with_wrong_columns_has_rows_of_errors(bodies: Path) -> None:
    answer, table = Answer(str(bodies)), table_of(queries(1, 5))
    for bad, message in [
        (table.drop_columns("direction"), "no column 'direction'"),
        (table.rename_columns([*table.column_names[:-1], "directoin"]), "read 'directoin'"),
        (table.append_column("moving", table["moving"]), "'moving' twice"),
    ]:
        told = answer(bad)
        assert told.schema == answer.schema(table.schema)
        assert told["id"].to_pylist() == table["id"].to_pylist()
        assert told["outcome"].to_pylist() == ["error"] * 5
        assert told["error"].to_pylist() == ["InputError"] * 5
        assert all(message in text for text in told["message"].to_pylist())
    missing = Answer("none.parquet")(table)
    assert missing["error"].to_pylist() == ["ReadError"] * 5


@pytest.mark.parametrize(
    "question", ["distance", "depth", "within", "directions", "motion", "motion_clearance"]
)
def test_failed_batches_have_the_columns_of_their_question(bodies: Path, question: Any) -> None:
    answer = Answer(str(bodies), Options(question))
    table = table_of({"moving": ["cube"], "fixed": ["cloud"], "wrong": [1]})
    good = table_of({"moving": ["cube"], "fixed": ["cloud"]})
    if question == "within":
        good = good.append_column("length", pa.array([1.0]))
    if "motion" in question:
        screw = pa.array([[0.0, 0, 0, 0, 0, 1, 1, 0]])
        good = good.append_column("moving_screw", screw)
    assert answer(table).schema == answer.schema(good.schema)
    assert answer(table)["error"].to_pylist() == ["InputError"]


def test_a_panic_is_the_error_of_its_row(bodies: Path, monkeypatch: Any) -> None:
    class Panic(BaseException):
        """The Python class of a panic of the extension, which is not an ``Exception``."""

    known = bulk_table.QUESTIONS["range"]
    columns = queries(1, 200)
    bad = columns["direction"][77]

    def panics(*sides: Any, **arguments: Any) -> Any:
        good = sides[2] != bad
        if not good.all(axis=1).all() and (arguments["moving_index"] >= 0).any():
            raise Panic("index out of bounds")
        return known(*sides, **arguments)

    plain = answer_table(table_of(columns), Bodies(str(bodies)))
    monkeypatch.setitem(bulk_table.QUESTIONS, "range", panics)
    told = answer_table(table_of(columns), Bodies(str(bodies)))
    assert told.schema == plain.schema
    assert [i for i, text in enumerate(told["message"].to_pylist()) if text] == [77]
    assert told["error"][77].as_py() == "ColltransError" and "Panic" in told["message"][77].as_py()
    others = np.arange(200) != 77
    for name in ("translation", "exit"):
        assert np.array_equal(
            np.asarray(told[name])[others], np.asarray(plain[name])[others], equal_nan=True
        )


def test_lists_in_every_form_are_read_alike(bodies: Path) -> None:
    columns = queries(1, 50)
    table = table_of(columns)
    known = answer_table(table, Bodies(str(bodies)))
    for kind in (pa.list_, pa.large_list):
        other = table
        for name in ("moving_pose", "direction"):
            lists = other[name].combine_chunks().cast(kind(pa.float64()))
            other = other.set_column(other.schema.get_field_index(name), name, lists)
        assert same(answer_table(other, Bodies(str(bodies))), known)
        # Also if the column is a part of a longer one.
        assert same(answer_table(other.slice(7, 20), Bodies(str(bodies))), known.slice(7, 20))
    poses = columns["moving_pose"].tolist()
    poses[3], poses[5], poses[7] = None, poses[5][:3], [1.0, 2.0]
    poses[9], poses[11] = [None, *poses[9][1:]], []
    index = table.schema.get_field_index("moving_pose")
    told = answer_table(
        table.set_column(index, "moving_pose", pa.array(poses)), Bodies(str(bodies))
    )
    wrong = [i for i, error in enumerate(told["error"].to_pylist()) if error]
    assert wrong == [7, 9, 11]
    alone = table.slice(5, 1).set_column(index, "moving_pose", pa.array([poses[5]]))
    expected = answer_table(alone, Bodies(str(bodies)))
    assert same(told.slice(5, 1), expected)


def test_copies_in_one_process_are_one(bodies: Path) -> None:
    answer = Answer(str(bodies))
    answer(table_of(queries(1, 5)))
    first, second = (pickle.loads(pickle.dumps(answer)) for _ in range(2))
    assert first is second and first is not answer
    table = table_of(queries(2, 5))
    assert same(first(table), answer(table))
    assert pickle.loads(pickle.dumps(first)) is first
    assert len(pickle.dumps(answer)) < 2000


def run(heading: str, folder: Path, monkeypatch: Any) -> dict[str, Any]:
    """Runs a recipe in a folder with bodies and queries; two rows of them are bad."""
    monkeypatch.chdir(folder)
    write_bodies(folder / "bodies.parquet")
    for k in range(2):
        columns = queries(k, 400)
        columns["moving"][17] = "broken"
        write(folder / "queries" / f"{k}.parquet", columns)
    names: dict[str, Any] = {"__name__": "recipe"}
    exec(compile(recipe(heading), str(GUIDE), "exec"), names)
    return names


def check(folder: Path, bodies: Path) -> None:
    """Compares the answers of a recipe with those of this process."""
    told = {row["id"]: row for row in pq.read_table(folder / "answers").to_pylist()}
    assert len(told) == 800
    for k in range(2):
        table = pq.read_table(folder / "queries" / f"{k}.parquet")
        for row in answer_table(table, Bodies(str(bodies)), Options("clearance")).to_pylist():
            mine = told[row["id"]]
            assert (mine["outcome"], mine["error"]) == (row["outcome"], row["error"])
            assert str(mine["distance"]) == str(row["distance"])
            assert str(list(mine["normal"] or ())) == str(list(row["normal"] or ()))
    assert told["0-17"]["error"] == told["1-17"]["error"] == "BuildError"


@pytest.mark.filterwarnings("ignore")
def test_the_recipe_for_ray_data_runs(tmp_path: Path, monkeypatch: Any) -> None:
    ray = pytest.importorskip("ray")
    pytest.importorskip("ray.data")
    monkeypatch.chdir(tmp_path)  # Workers start in the folder of their driver.
    monkeypatch.setenv("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
    monkeypatch.setenv("RAY_worker_niceness", "0")  # Workers would wait on a busy machine.
    ray.init(address="local", num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        run("Ray Data", tmp_path, monkeypatch)
        check(tmp_path, tmp_path / "bodies.parquet")
    finally:
        ray.shutdown()


@pytest.mark.filterwarnings("ignore")
def test_the_recipe_for_daft_runs(tmp_path: Path, monkeypatch: Any) -> None:
    pytest.importorskip("daft")
    monkeypatch.setenv("DO_NOT_TRACK", "true")
    run("Daft", tmp_path, monkeypatch)
    check(tmp_path, tmp_path / "bodies.parquet")


@pytest.mark.skipif(shutil.which("java") is None, reason="Spark needs Java")
@pytest.mark.filterwarnings("ignore")
def test_the_recipe_for_spark_runs(tmp_path: Path, monkeypatch: Any) -> None:
    sql = pytest.importorskip("pyspark.sql")
    monkeypatch.chdir(tmp_path)  # Java starts in the folder of its driver.
    monkeypatch.setenv("PYSPARK_PYTHON", sys.executable)
    monkeypatch.setenv("SPARK_LOCAL_IP", "127.0.0.1")
    builder = sql.SparkSession.builder.master("local[2]").config("spark.ui.enabled", "false")
    session = builder.config("spark.sql.warehouse.dir", str(tmp_path / "warehouse")).getOrCreate()
    try:
        run("Spark", tmp_path, monkeypatch)
        check(tmp_path, tmp_path / "bodies.parquet")
    finally:
        session.stop()
