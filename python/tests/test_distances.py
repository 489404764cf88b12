"""Tests distances, depths, comparisons: one and many, in files, bits of the command line."""

import copy
import json
import pickle
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Batch, draw
from test_schema import conform

import colltrans
from colltrans import (
    ConvexPolyhedron,
    Depth,
    Distance,
    InputError,
    OverlapDepth,
    Pair,
    Solid,
    Within,
    check,
)
from colltrans.columns import Failed
from colltrans.errors import QueryError

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
BOLT, PLATE = Solid.read(ROOT / "data/bolt.stl"), Solid.read(ROOT / "data/plate.off")
PLACES: list[list[float]] = [[0.0, 0, 9], [0.5, 0, 0], [0, 0, 4], [40, 0, 0]]
LENGTH = 1.25


def told(answers: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [{k: v for k, v in answer.items() if k not in ("id", "notes")} for answer in answers]


@pytest.mark.parametrize("query", ["distance", "depth", "within"])
def test_convex_bodies_have_the_bits_of_the_command_line(batch: Batch, query: str) -> None:
    asked = draw(seed=7, count=300)
    lines = list(asked.lines(query=query, **({"length": LENGTH} if query == "within" else {})))
    for line in lines:
        del line["direction"]
    there = told(batch(lines))
    bodies = asked.bodies()
    places: dict[str, Any] = {"moving_pose": asked.moving_pose, "fixed_pose": asked.fixed_pose}
    places |= {"moving_index": asked.moving, "fixed_index": asked.fixed}
    many: Any
    if query == "within":
        many = colltrans.within_many(bodies, bodies, LENGTH, **places, threads=3)
    elif query == "depth":
        many = colltrans.depth_many(bodies, bodies, **places)
    else:
        many = colltrans.distance_many(bodies, bodies, **places)
    assert len(many) == 300 and not many.errors
    seen = set()
    for i, answer in enumerate(there):
        conform("answer", answer)
        alone = many[i]
        assert not isinstance(alone, Failed)
        assert alone.to_dict() == answer
        assert isinstance(alone, Distance | Depth | Within) and alone.steps is not None
        assert alone.steps.supports == answer["steps"]["supports"] > 0
        assert many.outcome[i] == answer["outcome"]
        for name, column in many._numbers():
            points = answer.get("points", [None, None])
            of = {"on_moving": points[0], "on_fixed": points[1], **answer}.get(name)
            expected = np.full(column[i].shape, np.nan) if of is None else of
            assert np.array_equal(column[i], expected, equal_nan=True), (name, answer)
        seen.add(answer["outcome"])
    wanted = {"distance": {"apart", "meeting"}, "depth": {"apart", "overlapping"}}
    assert seen >= wanted.get(query, {"closer", "farther"})


def test_solids_have_the_bits_of_the_command_line(batch: Batch) -> None:
    body = {"solid": str(ROOT / "data/bolt.stl")}, {"solid": str(ROOT / "data/plate.off")}
    more: list[tuple[str, dict[str, float]]]
    more = [("distance", {}), ("depth", {}), ("within", {"length": LENGTH})]
    for query, fields in more:
        lines = [
            {
                "moving": body[0],
                "fixed": body[1],
                "moving_pose": {"translation": place},
                "query": query,
                **fields,
            }
            for place in PLACES
        ]
        there = told(batch(lines))
        ask = getattr(colltrans, f"{query}_many")
        many = ask(BOLT, PLATE, *fields.values(), moving_pose=PLACES)
        for i, answer in enumerate(there):
            conform("answer", answer)
            assert many[i].to_dict() == answer and "steps" not in answer
    outcomes = colltrans.distance_many(BOLT, PLATE, moving_pose=PLACES).counts()
    assert outcomes == {"apart": 3, "meeting": 1}
    # A solid and a convex body.
    mixed = colltrans.distance(CUBE, PLATE, moving_pose=[4, 4, 3])
    assert mixed.lower <= 3 <= mixed.upper and mixed.upper - mixed.lower < 1e-11


def answers() -> list[Any]:
    found: list[Any] = []
    cubes: list[list[float]] = [[-3, 0.5, 0], [0.3, 0.2, 0.1], [1, 0, 0]]
    for place in cubes:
        pair = Pair(CUBE, CUBE, moving_pose=place)
        found += [pair.distance(), pair.depth(), pair.within(0.5)]
    for place in PLACES:
        pair = Pair(BOLT, PLATE, moving_pose=place)
        found += [pair, pair.distance(), pair.depth(), pair.within(LENGTH)]
    return found


def parts(thing: Any) -> Any:
    if isinstance(thing, Pair):
        return repr(thing), thing.moving_pose.translation.tolist(), thing.distance().to_dict()
    return repr(thing), thing.to_dict()


@pytest.mark.parametrize("answer", answers(), ids=lambda a: type(a).__name__)
def test_a_pickled_answer_keeps_its_bits(answer: Any) -> None:
    for again in (pickle.loads(pickle.dumps(answer)), copy.deepcopy(answer)):
        assert parts(again) == parts(answer)
    if not isinstance(answer, Pair):
        conform("answer", answer.to_dict())
        assert "Pair" in repr(answer.query)


def test_answers_give_bounds_points_and_normals() -> None:
    found = colltrans.distance(CUBE, CUBE, moving_pose=[-3, 0.5, 0.25])
    assert isinstance(found, Distance)
    match found:
        case Distance(lower, upper):
            assert lower <= 2 <= upper
    between = found.on_fixed - found.on_moving
    assert np.allclose(between, [2, 0, 0]) and found.normal is not None
    assert found.features is not None and found.features.fixed.kind == "face"
    met = colltrans.distance(CUBE, CUBE)
    assert met.normal is None and met.features is None and met.lower == 0
    deep = colltrans.depth(CUBE, CUBE, moving_pose=[0.75, 0, 0])
    assert isinstance(deep, Depth) and np.allclose(deep.translation, [0.25, 0, 0])
    assert deep.lower <= 0.25 <= deep.upper
    solid = colltrans.depth(BOLT, PLATE, moving_pose=[0.5, 0, 0])
    assert isinstance(solid, OverlapDepth) and solid.meets
    assert solid.least_tolerance is not None and 0.39 < solid.least_tolerance < 0.4
    near = colltrans.within(CUBE, CUBE, 2.5, moving_pose=[-3, 0.5, 0.25])
    assert isinstance(near, Within) and near.closer is True and near.lower is None
    assert near.points is not None and near.upper is not None and near.upper <= 2.5
    far = colltrans.within(CUBE, CUBE, 1.5, moving_pose=[-3, 0.5, 0.25])
    assert far.closer is False and far.points is None and far.lower is not None and far.lower > 1.5
    unknown = colltrans.within(CUBE, CUBE, 2, moving_pose=[-3, 0.5, 0.25])
    assert unknown.closer is None and unknown.length == 2


def test_proofs_are_checked_in_fractions_and_by_the_command_line(cli: Path, tmp_path: Path) -> None:
    file = tmp_path / "proof.json"
    for answer in answers():
        if isinstance(answer, Pair):
            continue
        if not isinstance(answer, OverlapDepth):
            answer.verify()
        answer.save_proof(file)
        conform("proof", json.loads(file.read_text()))
        said = subprocess.run([cli, "verify", file, "--json"], capture_output=True, text=True)
        assert said.returncode == 0, said.stderr
        conform("verified", json.loads(said.stdout))
        report = check.check(answer.proof_json())
        assert report.holds or report.unchecked


def changed(claim: Any, *path: Any, by: float) -> str:
    file = json.loads(claim.proof_json())
    place = file["statement"]
    for name in path[:-1]:
        place = place[name]
    place[path[-1]] += by
    return json.dumps(file)


def test_changed_proofs_are_refused_in_fractions() -> None:
    pair = Pair(CUBE, CUBE, moving_pose=[-3, 0.5, 0.25, 0.1, 0.2, 0.3, 0.86**0.5])
    apart = pair.distance()
    deep = colltrans.depth(CUBE, CUBE, moving_pose=[-0.3, 0.5, 0.25, 0.1, 0.2, 0.3, 0.86**0.5])
    for wrong in (
        changed(apart, "distance", "gap", "gap", by=1e-12),
        changed(apart, "distance", "gap", "normal", 0, by=0.01),
        changed(apart, "distance", "near", "distance", by=-1e-12),
        changed(apart, "distance", "near", "weights", 0, by=-2),
        changed(deep, "depth", "lower", by=1e-12),
        changed(deep, "depth", "upper", by=-1e-12),
        changed(deep, "depth", "direction", 1, by=0.01),
        changed(deep, "depth", "enclosure", "triangles", 0, 0, by=1),
        changed(deep, "depth", "enclosure", "normals", 0, 0, by=50),
    ):
        with pytest.raises(check.RefusedError):
            check.check(wrong)


def test_invalid_arguments_are_refused() -> None:
    with pytest.raises(QueryError, match="length -1 is negative"):
        colltrans.within(CUBE, CUBE, -1)
    with pytest.raises(QueryError, match="not a number"):
        Pair(BOLT, PLATE).within(float("nan"))
    with pytest.raises(TypeError, match="moving: neither a ConvexPolyhedron nor a Solid"):
        colltrans.distance("cube", CUBE)  # type: ignore[arg-type]
    with pytest.raises(InputError):
        colltrans.distance(CUBE, CUBE, moving_pose=[1, 2])
    with pytest.raises(colltrans.ColltransError):
        colltrans.distance(CUBE, CUBE, moving_pose=[np.nan, 0, 0])
    with pytest.raises(InputError, match="different lengths"):
        colltrans.within_many(CUBE, CUBE, [1.0, 2.0], moving_pose=np.zeros((3, 3)))
    point = ConvexPolyhedron([[0, 0, 9]])
    assert colltrans.distance(point, PLATE).lower > 0
    columns = colltrans.within_many([CUBE, point], PLATE, [1.0, 2.0])
    assert not columns.errors
    columns = colltrans.within_many(CUBE, CUBE, [1.0, -1.0, np.nan])
    assert set(columns.errors) == {1, 2} and isinstance(columns[2], Failed)
    assert colltrans.distance_many([CUBE, CUBE], CUBE, fixed_index=[0, 5]).errors.keys() == {1}


def test_columns_become_arrow_tables() -> None:
    pytest.importorskip("pyarrow")
    columns = colltrans.distance_many(CUBE, CUBE, moving_pose=[[2.5, 0, 0], [0.1, 0.2, 0.3]])
    table = columns.to_arrow()
    names = ["outcome", "lower", "upper", "normal", "on_moving", "on_fixed", "message"]
    assert table.column_names == names
    assert columns.to_pandas()["on_fixed_x"].iloc[0] == 1.0
    assert "apart" in columns._repr_html_()


def test_files_of_queries_ask_distances(tmp_path: Path) -> None:
    pa = pytest.importorskip("pyarrow")
    from colltrans import bulk
    from colltrans.bulk.__main__ import main

    (tmp_path / "cube.off").write_text((ROOT / "data/plate.off").read_text())
    lines = [
        {"id": str(i), "moving": "cube.off", "fixed": {"mesh": "cube.off"}, "length": length}
        | {"moving_pose": [30 * i, 0, 0]}
        for i, length in enumerate([1.0, 2.0, None])
    ]
    queries = tmp_path / "queries.jsonl"
    queries.write_text("".join(json.dumps(line) + "\n" for line in lines))
    told = {}
    for question in ("distance", "depth", "within"):
        out = tmp_path / question / "queries.parquet"
        kept = [] if question == "within" else ["--keep", "length"]
        code = main([str(queries), str(out), "--hull", "--question", question, *kept])
        assert code == (5 if question == "within" else 0)
        told[question] = pa.parquet.read_table(out).to_pydict()
    hull = colltrans.read(tmp_path / "cube.off", hull=True)
    alone = colltrans.distance(hull, hull, moving_pose=[30, 0, 0])
    assert told["distance"]["upper"][1] == alone.upper
    assert told["distance"]["length"] == ["1.0", "2.0", None]
    assert told["depth"]["outcome"] == ["overlapping", "apart", "apart"]
    assert told["within"]["outcome"] == ["closer", "farther", "error"]
    table = pa.table({"moving": ["cube.off"], "fixed": ["cube.off"]})
    answers = bulk.answer_table(
        table, bulk.Bodies(folder=str(tmp_path), hull=True), bulk.Options("depth")
    )
    assert answers["upper"][0].as_py() == told["depth"]["upper"][0]
    with pytest.raises(InputError, match="the queries have no column 'length'"):
        bulk.answer_table(table, bulk.Bodies(folder=str(tmp_path)), bulk.Options("within"))


def test_pictures_join_the_nearest_points() -> None:
    pytest.importorskip("plotly")

    def names(answer: Any) -> list[str]:
        return [trace.name for trace in colltrans.picture(answer).data if trace.name]

    pair = Pair(CUBE, CUBE, moving_pose=[-3, 0.5, 0])
    assert names(pair) == ["moving", "fixed", "distance 2"]
    assert names(pair.within(9))[2].startswith("at most ")
    assert "separated at 0.25" in names(colltrans.depth(CUBE, CUBE, moving_pose=[0.75, 0, 0]))
    assert names(colltrans.depth(BOLT, PLATE)) == ["moving", "fixed"]


def test_a_distance_equals_that_of_its_points() -> None:
    asked = draw(seed=8, count=100)
    bodies = asked.bodies()
    places: dict[str, Any] = {"moving_pose": asked.moving_pose, "fixed_pose": asked.fixed_pose}
    places |= {"moving_index": asked.moving, "fixed_index": asked.fixed}
    columns = colltrans.distance_many(bodies, bodies, **places)
    apart = columns.where("apart")
    between = columns.on_fixed - columns.on_moving
    lengths = np.linalg.norm(between, axis=1)
    assert np.allclose(lengths[apart], columns.upper[apart], atol=1e-12)
    along = np.einsum("ij,ij->i", between, columns.normal)
    assert np.allclose(along[apart], columns.lower[apart], atol=1e-12)
