"""Tests motions: one and many, in files, the bits of the command line, proofs, copies."""

import copy
import json
import math
import pickle
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Batch
from test_schema import conform

import colltrans
from colltrans import (
    ConvexPolyhedron,
    FirstContact,
    InputError,
    Motion,
    MotionCast,
    Pose,
    Solid,
    check,
    clearance,
    motion_many,
)
from colltrans.columns import Failed
from colltrans.errors import CaseError, QueryError
from colltrans.motions import MotionClearance, motion_clearance, motion_clearance_many

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
CLOUD = ConvexPolyhedron(np.random.default_rng(1).normal(size=(40, 3)))
BOLT, PLATE = Solid.read(ROOT / "data/bolt.stl"), Solid.read(ROOT / "data/plate.off")


def screws(seed: int, n: int) -> dict[str, Any]:
    """Returns random screws about points between two bodies, a quarter of them along axes."""
    random = np.random.default_rng(seed)
    axis = random.normal(size=(n, 3))
    axis[: n // 4] = np.eye(3)[random.integers(0, 3, n // 4)]
    return {
        "point": random.normal(size=(n, 3)) * 2,
        "axis": axis,
        "radians": random.uniform(-6, 6, n),
        "rise": random.normal(size=n) * 2,
    }


def lines(numbers: dict[str, Any], places: Any, **more: Any) -> list[dict[str, Any]]:
    cloud = {"points": np.asarray(CLOUD.vertices).tolist()}
    cube = {"points": CUBE.vertices.tolist()}
    return [
        {
            "moving": cube,
            "fixed": cloud,
            "moving_pose": {"translation": place.tolist()},
            "moving_motion": {"screw": {k: np.asarray(v[i]).tolist() for k, v in numbers.items()}},
            "query": "motion",
            **more,
        }
        for i, place in enumerate(places)
    ]


@pytest.mark.parametrize("min_gap", [0.0, 0.25])
def test_rows_have_the_bits_of_the_command_line(batch: Batch, min_gap: float) -> None:
    n = 120
    numbers, places = screws(3, n), np.random.default_rng(4).normal(size=(n, 3)) * 4
    cloud = ConvexPolyhedron(np.asarray(CLOUD.vertices))
    cube = ConvexPolyhedron(CUBE.vertices)
    there = batch(lines(numbers, places, **({"min_gap": min_gap} if min_gap else {})))
    columns = motion_many(
        cube, cloud, {"screw": numbers}, moving_pose=places, min_gap=min_gap, threads=3
    )
    assert len(columns) == n and not columns.errors
    for i, answer in enumerate(there):
        answer = {k: v for k, v in answer.items() if k not in ("id", "notes")}
        conform("motion", answer)
        alone = columns[i]
        assert isinstance(alone, FirstContact)
        assert alone.to_dict() == answer
        time = answer.get("time", {})
        found = [columns.lower[i], columns.upper[i]]
        never = [1.0, math.inf] if answer["outcome"] == "free" else [0.0, 0.0]
        assert found == ([time["lower"], time.get("upper", math.inf)] if time else never)
        assert found == [alone.lower, alone.upper]
        assert np.array_equal([columns.value[i]], np.array([alone.value], float), equal_nan=True)
        none = [np.nan] * 3
        assert np.array_equal(columns.normal[i], answer.get("normal", none), equal_nan=True)
        assert np.array_equal(columns.point[i], answer.get("point", none), equal_nan=True)
    assert {"contact", "free"} <= set(columns.counts())


def answers() -> list[FirstContact]:
    turn = Motion.turn([0, 0, 0], [0, 0, 1], radians=3, pose=[2, 0, 0])
    found = [
        colltrans.motion(CUBE, CUBE, turn, Pose([-1.5, 1.5, 0.25])),
        colltrans.motion(CUBE, CUBE, turn, Pose([-1.5, 1.5, 0.25]), min_gap=0.25),
        colltrans.motion(CUBE, CUBE, turn, Motion.slide([0, 0, 5], pose=[-1.5, 1.5, 0.25])),
        colltrans.motion(CUBE, CUBE, Motion.slide([1, 0, 0])),
        colltrans.motion(
            CUBE, CUBE, Motion.turn([0.5, 0.5, 0], [0, 0, 1], radians=2), Pose([0, 0, -1])
        ),
    ]
    rest = Motion.turn([0.5, 0.5, 0], [0, 0, 1], radians=2)
    found.append(colltrans.motion(CUBE, CUBE, rest, Pose([0, 0, -1]), tolerance=1e-9))
    down = Motion.screw([0, 0, 0], [0, 0, 1], radians=1, rise=-20, pose=[0, 0, 9])
    found.append(colltrans.motion(BOLT, PLATE, down))
    found.append(colltrans.motion(CUBE, PLATE, Motion.slide([0, 0, 9], pose=[0, 0, 30])))
    return found


def test_answers_give_times_points_and_normals() -> None:
    contact, kept, free, over, touching, resting, solid, away = answers()
    outcomes = [answer.outcome for answer in answers()]
    assert outcomes == [
        "contact",
        "contact",
        "free",
        "overlapping",
        "grazing",
        "free",
        # Face to face while it turns: facets that cross soon after prove it.
        "contact",
        "free",
    ]
    match contact:
        case FirstContact("contact", lower, upper):
            assert upper is not None and lower < upper < lower + 1e-11
    assert kept.lower < contact.lower and kept.query.min_gap == 0.25
    assert contact.poses is not None and contact.features is not None
    assert contact.poses[0] == contact.query.moving_motion.at(contact.lower)
    assert contact.point is not None and contact.normal is not None and contact.looks > 3
    assert (free.lower, free.upper, free.poses, free.point) == (1.0, math.inf, None, None)
    assert (over.lower, over.upper) == (0.0, 0.0)
    assert (touching.lower, touching.upper) == (0.0, math.inf)
    assert resting.query.tolerance == 1e-9
    # The bolt moves down its hole while it turns: 9 of 20.
    assert abs(solid.lower - 0.45) < 1e-6
    assert solid.query.tolerance > 1e-7 and solid.features is not None
    assert away.normal is None and away.features is None


@pytest.mark.parametrize("answer", answers(), ids=lambda a: a.outcome)
def test_answers_and_queries_come_back_with_their_bits(answer: FirstContact) -> None:
    for again in (pickle.loads(pickle.dumps(answer)), copy.deepcopy(answer)):
        assert again.to_dict() == answer.to_dict() and repr(again) == repr(answer)
    query = pickle.loads(pickle.dumps(answer.query))
    assert query.motion().to_dict() == answer.to_dict()
    assert query.moving_motion == answer.query.moving_motion
    conform("motion", answer.to_dict())
    answer.verify()


def test_proofs_are_checked_in_fractions_and_by_the_command_line(cli: Path, tmp_path: Path) -> None:
    file = tmp_path / "proof.json"
    for answer in answers():
        answer.save_proof(file)
        conform("proof", json.loads(file.read_text()))
        said = subprocess.run([cli, "verify", file, "--json"], capture_output=True, text=True)
        assert said.returncode == 0, said.stderr
        told = json.loads(said.stdout)
        conform("verified", told)
        assert told["time"]["lower"] == answer.lower
        report = check.check(answer.proof_json())
        assert bool(report.holds) == (answer.outcome != "grazing")


def test_random_proofs_hold_in_fractions() -> None:
    random = np.random.default_rng(11)
    seen: dict[str, int] = {}
    for k in range(60):
        bodies = [ConvexPolyhedron(random.normal(size=(n, 3))) for n in (4 + k % 9, 4 + k % 5)]
        turn = random.normal(size=4)
        pose = np.hstack([random.normal(size=3) * 3, turn / np.linalg.norm(turn)])
        point, axis, way = random.normal(size=(3, 3))
        angle = float(random.uniform(-6, 6) * (1 if k % 7 else 30))
        motion = [
            Motion.screw(point, axis, radians=angle, rise=2.0, pose=pose),
            Motion.thrown(pose[:3], way - pose[:3], axis * angle, pose=pose),
            Motion.about(point, axis, way, radians=angle, pose=pose),
            Motion.between(pose, [0, 0, 0]),
            Motion.through([pose, random.normal(size=3) * 4, pose]),
        ][k % 5]
        other = Motion.turn(point * 3, way, radians=angle / 3) if k % 3 == 0 else None
        min_gap = [0.0, 0.0, 1e-9, 0.25][k % 4]
        found = colltrans.motion(bodies[0], bodies[1], motion, other, min_gap=min_gap)
        report = check.check(found.proof_json())
        assert report.holds or found.lower == 0
        seen[found.outcome] = seen.get(found.outcome, 0) + 1
    assert seen["contact"] > 10 and seen["free"] > 10


def test_motions_move_points_as_documented() -> None:
    pose = [1, 2, 3]
    quarter = Motion.turn([0, 0, 0], [0, 0, 2], degrees=90, pose=pose)
    assert np.allclose(quarter.at(1).translation, [-2, 1, 3])
    assert np.allclose(quarter.at(0.5).rotation[0], [0.5**0.5, -(0.5**0.5), 0])
    assert Motion.still(pose).at(0.3).translation.tolist() == pose
    assert Motion.slide([1, 0, 0], pose=pose).at(0.5).translation.tolist() == [1.5, 2, 3]
    screw = Motion.screw([1, 2, 0], [0, 0, 1], radians=7, rise=2, pose=pose)
    assert np.allclose(screw.at(1).translation, [1, 2, 5])
    same = Motion.about([0, 0, 0], [0, 0, 1], [0, 0, 2], radians=7, pose=pose)
    assert np.allclose(same.at(1).as_matrix(), screw.at(1).as_matrix())
    thrown = Motion.thrown(pose, [5, 0, 0], [0, 3, 0], pose=pose)
    assert np.allclose(thrown.at(1).translation, [6, 2, 3])
    to = Motion.between(pose, [0, 0, 0, 0.5, 0.5, 0.5, 0.5])
    assert np.allclose(to.at(1).quaternion, [0.5] * 4)
    assert Motion.through([pose, [0, 0, 0]]) == Motion.between(pose, [0, 0, 0])
    for motion in (quarter, screw, thrown, to, Motion.through([pose, [0, 0, 9], [4, 4, 4]])):
        again = pickle.loads(pickle.dumps(motion))
        assert again == motion and again.start == motion.start and motion != Motion.still()
        assert again.at(0.7) == motion.at(0.7)
    placed = "pose=[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0]"
    turn = "Motion.turn([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], radians=1.5707963267948966"
    assert repr(quarter) == f"{turn}, {placed})"


def test_a_query_is_saved_and_replayed(cli: Path, tmp_path: Path) -> None:
    query = answers()[1].query
    (tmp_path / "case.json").write_text(query.to_json())
    words: list[str | Path] = [cli, "replay", tmp_path / "case.json", "--json"]
    told = subprocess.run(words, capture_output=True, text=True)
    assert json.loads(told.stdout) == query.motion().to_dict()
    again = MotionCast.from_json(query.to_json())
    assert again.motion().to_dict() == query.motion().to_dict()
    assert again.min_gap == 0.25 and again.to_json() == query.to_json()
    with pytest.raises(CaseError, match="has no file"):
        answers()[-1].query.to_json()
    with pytest.raises(CaseError, match="the format is"):
        MotionCast.from_json(query.to_json().replace("case 1", "case 9"))


def test_invalid_arguments_are_refused() -> None:
    with pytest.raises(QueryError, match="axis"):
        Motion.turn([0, 0, 0], [0, 0, 0], radians=1)
    with pytest.raises(QueryError, match="1e5"):
        Motion.turn([0, 0, 0], [0, 0, 1], radians=1e6)
    with pytest.raises(QueryError, match="at least one pose"):
        Motion.through([])
    with pytest.raises(QueryError, match="time"):
        Motion.still().at(2)
    with pytest.raises(InputError, match="by"):
        Motion.slide([1, 2])
    slide = Motion.slide([1, 0, 0])
    with pytest.raises(QueryError, match="min_gap and tolerance are both given"):
        colltrans.motion(CUBE, CUBE, slide, min_gap=1, tolerance=1)
    with pytest.raises(QueryError, match="-1"):
        colltrans.motion(CUBE, CUBE, slide, min_gap=-1)
    with pytest.raises(TypeError, match="neither a ConvexPolyhedron nor a Solid"):
        colltrans.motion("cube", CUBE, slide)  # type: ignore[arg-type]
    turn: dict[str, Any] = {"point": [0, 0, 0], "axis": [0, 0, 1], "radians": [1, 2]}
    with pytest.raises(InputError, match="'turn' has point, axis, radians"):
        motion_many(CUBE, CUBE, {"turn": {**turn, "rise": 1}})
    with pytest.raises(InputError, match="one of slide, turn, screw, thrown, not twist"):
        motion_many(CUBE, CUBE, {"twist": turn})
    with pytest.raises(InputError, match=r"axis: an array of shape \(2,\)"):
        motion_many(CUBE, CUBE, {"turn": {**turn, "axis": [0, 1]}})
    with pytest.raises(InputError, match="axis has 3 rows, moving_motion.radians has 2 rows"):
        motion_many(CUBE, CUBE, {"turn": {**turn, "axis": np.eye(3)}})
    with pytest.raises(InputError, match="different lengths"):
        motion_many(CUBE, CUBE, {"turn": turn}, min_gap=[1, 2, 3])
    with pytest.raises(InputError, match="its own pose"):
        motion_many(CUBE, CUBE, slide, moving_pose=[1, 0, 0])
    with pytest.raises(TypeError, match="neither a Motion"):
        motion_many(CUBE, CUBE, [1, 2])  # type: ignore[list-item]


def test_rows_of_different_motions_equal_single_answers() -> None:
    numbers: dict[str, Any] = {
        "center": [0.5, 0.5, 0.5],
        "velocity": np.eye(3) * 8,
        "angular_velocity": [1, 2, 3],
    }
    thrown = motion_many(CUBE, CUBE, {"thrown": numbers}, fixed_pose=[4, 0.25, 0.25])
    alone = Motion.thrown([0.5, 0.5, 0.5], [8, 0, 0], [1, 2, 3])
    assert thrown.lower[0] == colltrans.motion(CUBE, CUBE, alone, Pose([4, 0.25, 0.25])).lower
    assert isinstance(row := thrown[0], FirstContact) and row.lower == thrown.lower[0]
    listed = motion_many(CUBE, CUBE, [alone, Motion.still()], fixed_pose=[4, 0.25, 0.25])
    assert listed.lower[0] == thrown.lower[0] and listed.counts() == {"contact": 1, "free": 1}
    slide: dict[str, Any] = {"slide": {"by": [[8, 0, 0], [8, np.nan, 0]]}}
    both = motion_many(CUBE, CUBE, slide, {"slide": {"by": [-8, 0, 0]}}, fixed_pose=[4, 0.25, 0.25])
    assert both.counts() == {"contact": 1, "error": 1} and "moving_motion" in both.errors[1]
    assert isinstance(both[1], Failed) and abs(both.lower[0] - 3 / 16) < 1e-12
    turn: dict[str, Any]
    turn = {"turn": {"point": [0, 0, 0], "axis": [0, 0, 1], "radians": [1, 2]}}
    more = motion_many(CUBE, CUBE, turn, fixed_pose=[0, 0, -1], tolerance=[1e-9, 1e-6])
    assert more.counts() == {"free": 2}
    wrong = motion_many(CUBE, CUBE, turn, fixed_pose=[0, 0, -1], tolerance=[1e-9, 1e-6], min_gap=1)
    assert wrong.counts() == {"error": 2} and "only one of them" in wrong.errors[0]
    mixed = motion_many([BOLT, CUBE], PLATE, turn, moving_pose=[0, 0, 30])
    assert mixed.counts() == {"free": 2}


def test_files_of_queries_ask_motions(batch: Batch, tmp_path: Path) -> None:
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    from colltrans.bulk.__main__ import main

    n = 40
    numbers, places = screws(5, n), np.random.default_rng(6).normal(size=(n, 3)) * 4
    keys = {"key": ["cube", "cloud"], "vertices": [CUBE.vertices.tolist(), CLOUD.vertices.tolist()]}
    pq.write_table(pa.table(keys), tmp_path / "bodies.parquet")
    asked = [
        {**line, "id": str(i), "moving": "cube", "fixed": "cloud"}
        for i, line in enumerate(lines(numbers, places))
    ]
    for line in asked:
        del line["query"]
    asked[0]["moving_motion"] = {"turn": {"point": [0, 0, 0], "axis": [0, 0, 1], "radians": 1}}
    asked[1]["moving_motion"] = {"slide": {"by": [1, 0, 0]}}
    asked[2]["fixed_motion"] = asked[2].pop("moving_motion")
    (tmp_path / "queries.jsonl").write_text("".join(json.dumps(line) + "\n" for line in asked))
    out, bodies = tmp_path / "out.parquet", str(tmp_path / "bodies.parquet")
    words = [str(tmp_path / "queries.jsonl"), str(out), "--bodies", bodies, "--question", "motion"]
    assert main(words) == 5
    table = pq.read_table(out)
    told = batch(lines(numbers, places))
    for i, outcome in enumerate(table["outcome"].to_pylist()):
        if i == 1:
            assert outcome == "error" and "turn" in table["message"][i].as_py()
        elif i > 2:
            assert outcome == told[i]["outcome"]
            # Free until the end of the motion, or in the way from its start.
            never = [1.0, math.inf] if outcome == "free" else [0.0, 0.0]
            time = told[i].get("time")
            known = [time["lower"], time.get("upper", math.inf)] if time else never
            assert [table["lower"][i].as_py(), table["upper"][i].as_py()] == known
    screw = np.column_stack(
        [numbers["point"], numbers["axis"], numbers["radians"], numbers["rise"]]
    )
    flat = pa.FixedSizeListArray.from_arrays(pa.array(screw.ravel()), 8)
    place = pa.FixedSizeListArray.from_arrays(pa.array(places.ravel()), 3)
    columns = {"moving": ["cube"] * n, "fixed": ["cloud"] * n, "moving_pose": place}
    pq.write_table(pa.table({**columns, "moving_screw": flat}), tmp_path / "queries.parquet")
    assert main([str(tmp_path / "queries.parquet"), *words[1:]]) == 0
    again = pq.read_table(out)
    assert np.array_equal(again["lower"][3:], table["lower"][3:], equal_nan=True)
    assert again["outcome"].to_pylist()[3:] == table["outcome"].to_pylist()[3:]


def test_pictures_show_ghosts_along_the_motion() -> None:
    pytest.importorskip("plotly")
    contact, _, free, *_ = answers()
    names = [trace.name for trace in colltrans.picture(contact).data if trace.name]
    assert names[:2] == ["moving", "fixed"] and names[-3:] == ["end", "point", "normal"]
    assert names[2].startswith("contact at 0.")
    names = [trace.name for trace in colltrans.picture(free.query).data if trace.name]
    assert names == ["moving", "fixed", "end"]


TABLE = ConvexPolyhedron.cuboid([-4, -4, -1], [4, 4, 0])


def cleared() -> list[MotionClearance]:
    out = Motion.turn([-1, 0, 0], [0, -1, 0], radians=1, pose=[0, 0, -0.125])
    solid = Solid.from_pieces([TABLE])
    return [
        motion_clearance(CUBE, TABLE, Motion.turn([0.5, 0.5, 0], [0, 0, 1], radians=2)),
        motion_clearance(CUBE, TABLE, Motion.slide([0, 0, -2])),
        motion_clearance(CUBE, TABLE, Motion.slide([0, 0, -2], pose=[0, 0, 1]), tolerance=0.01),
        motion_clearance(CUBE, TABLE, Motion.slide([0, 0, -2], pose=[0, 0, 1]), min_gap=0.25),
        motion_clearance(CUBE, TABLE, out),
        motion_clearance(CUBE, solid, Motion.slide([0, 0, -2], pose=[0, 0, 1])),
        motion_clearance(CUBE, solid, out),
        motion_clearance(CUBE, solid, out, ignore_start_overlaps=True),
    ]


def test_clearances_of_motions_give_their_times() -> None:
    turned, pushed, dropped, kept, pressed, solid, stuck, leaving = cleared()
    assert (turned.outcome, turned.time, turned.bounds) == ("free", 1.0, None)
    assert (pushed.outcome, pushed.time) == ("blocked", 0.0)
    assert pushed.tolerance is not None and pushed.tolerance < 1e-10
    for found, at, shrunk in [(dropped, 0.5, 0.505), (kept, 0.375, 0.375), (solid, 0.5, 0.5)]:
        assert found.time is not None and abs(found.time - at) < 1e-9
        for bounds, expected in [(found.bounds, at), (found.shrunk, shrunk)]:
            assert bounds is not None and bounds[1] is not None
            assert bounds[0] <= expected + 1e-9 and expected - 1e-9 <= bounds[1] < expected + 1e-9
    for found in (pressed, stuck):
        assert (found.outcome, found.time) == ("overlapping", None)
        assert found.least_tolerance is not None and abs(found.least_tolerance - 0.125) < 1e-9
        with pytest.raises(colltrans.errors.CertificateError):
            found.verify()
    assert leaving.outcome == "free"
    for found in (turned, pushed, dropped, kept, solid):
        found.verify()
        report = check.check(found.proof_json())
        assert report.holds
    with pytest.raises(QueryError, match="ignore_start_overlaps is for solids"):
        motion_clearance(CUBE, TABLE, Motion.slide([1, 0, 0]), ignore_start_overlaps=True)


@pytest.mark.parametrize("answer", cleared())
def test_clearances_come_back_with_their_bits(answer: MotionClearance) -> None:
    for again in (copy.copy(answer), copy.deepcopy(answer), pickle.loads(pickle.dumps(answer))):
        assert again.to_dict() == answer.to_dict()
        assert (again.time, again.bounds, again.shrunk) == (
            answer.time,
            answer.bounds,
            answer.shrunk,
        )
        again_, query = again.query, answer.query
        assert again_.ignore_start_overlaps == query.ignore_start_overlaps
    conform("motion", answer.to_dict())


def test_a_slide_goes_as_far_as_a_cast() -> None:
    random = np.random.default_rng(9)
    n = 200
    ways, places = random.normal(size=(n, 3)) * 5, random.normal(size=(n, 3)) * 3
    columns = motion_clearance_many(CUBE, CLOUD, {"slide": {"by": ways}}, moving_pose=places)
    counts = columns.counts()
    assert set(counts) == {"blocked", "free", "overlapping"} and sum(counts.values()) == n
    for i, (way, place) in enumerate(zip(ways, places, strict=True)):
        straight = clearance(CUBE, CLOUD, way, moving_pose=place).distance
        found = columns[i]
        assert isinstance(found, MotionClearance)
        expected = None if straight is None else min(straight, 1.0)
        if expected is None or found.time is None:
            assert expected == found.time
        else:
            assert abs(found.time - expected) < 1e-9, i
        told = [columns.value[i], columns.lower[i], columns.upper[i]]
        single = np.array([found.value, found.lower, found.upper], float)
        assert np.array_equal(told, single, equal_nan=True)
        assert np.isnan(columns.least_tolerance[i]) == (found.outcome != "overlapping")
