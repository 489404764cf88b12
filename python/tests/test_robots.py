"""Tests robot paths: arrays and files, the bits of the command line, proofs, bulk."""

import copy
import json
import math
import pickle
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT
from test_schema import conform

import colltrans
from colltrans import ColltransError, ConvexPolyhedron, InputError, Robot, Solid, read
from colltrans.columns import Failed
from colltrans.errors import AssemblyError, QueryError
from colltrans.robots import PathContact, path_many

DATA = ROOT / "data"
ARM = Robot.read(DATA / "arm.urdf")
WIRE = read(DATA / "wire.obj")
ROWS = np.array([[-1.2, 0.6, 0], [0.9, 0.3, 0.05], [1.2, 0.6, 0]])


def cli_path(cli: Path, *words: str) -> Any:
    told = subprocess.run([cli, "path", *words, "--json"], capture_output=True, text=True, cwd=DATA)
    assert told.returncode == 0, told.stderr
    return json.loads(told.stdout)


def test_a_robot_gives_its_joints_and_bodies() -> None:
    assert ARM.name == "arm"
    assert ARM.links == ["base", "upper", "fore", "tool"]
    assert ARM.joints == ["shoulder", "elbow", "reach"]
    assert ARM.limits == {"shoulder": (-3, 3), "reach": (0, 0.1)}
    assert "circumscribed polyhedron" in ARM.notes[0]
    assert repr(ARM) == 'Robot("arm", 4 links, 3 joints)'


def test_a_wire_in_the_way_is_met_as_on_the_command_line(cli: Path, tmp_path: Path) -> None:
    found = ARM.first_contact(ROWS, {"wire": WIRE})
    assert (found.outcome, found.pair) == ("contact", ("tool", "wire"))
    told = found.to_dict()
    assert told == cli_path(cli, "arm.urdf", "arm.csv", "wire.obj")
    conform("path", told)
    assert found.upper is not None and found.lower < found.upper < found.lower + 1e-11
    assert found.place is not None and found.point is not None and found.normal is not None
    assert found.place[0] == 0 and abs(np.linalg.norm(found.normal) - 1) < 1e-12
    assert found.point.tolist() == told["point"]
    assert len(found.notes) == 2 and found.pairs == 6
    found.verify()
    found.save_proof(tmp_path / "proof.json")
    verified = subprocess.run(
        [cli, "verify", tmp_path / "proof.json"], capture_output=True, text=True, check=True
    )
    assert "and tool and wire meet by the time" in verified.stdout
    assert copy.copy(found) is found and copy.deepcopy(found) is found
    match found:
        case PathContact("contact", lower):
            assert lower == found.lower


def test_answers_are_pickled_and_drawn() -> None:
    solid = Solid.from_pieces([ConvexPolyhedron.cuboid([0.5, -2, -1], [0.6, 2, 1])])
    for scene in ({"wire": WIRE}, {"wall": solid}, {}):
        found = ARM.first_contact(ROWS, scene)
        again = pickle.loads(pickle.dumps(found))
        assert isinstance(again, PathContact) and again.to_dict() == found.to_dict()
        assert (again.lower, again.upper, again.notes) == (found.lower, found.upper, found.notes)
        assert again.proof_json() == found.proof_json()
        again.verify()
        assert pickle.dumps(again) == pickle.dumps(found)
    found = ARM.first_contact(ROWS, {"wire": WIRE})
    here, start = found.meshes(), {name: v for name, v, _ in found.meshes((0, 0.0))}
    assert {name for name, _, _ in here} == {*ARM.links, "wire"}
    for name, vertices, triangles in here:
        assert triangles.max() < len(vertices)
        assert np.array_equal(vertices, start[name]) == (name in ("base", "wire")), name
    # The nearest point is on the tool.
    tool = next(v for name, v, _ in here if name == "tool")
    assert found.point is not None
    assert (tool.min(axis=0) - 1e-9 <= found.point).all() and (
        found.point <= tool.max(axis=0) + 1e-9
    ).all()
    for place in ((2, 0.5), (3, 0.0), (0, -0.1)):
        with pytest.raises(InputError, match="place"):
            found.meshes(place)
    pytest.importorskip("plotly")
    names = [trace.name for trace in colltrans.picture(found).data if trace.name]
    ghost = f"tool at {found.lower:.6g}"
    assert {"tool", "wire", ghost, "point", "normal"} <= set(names)
    assert not any(name.startswith("wire at") for name in names)


def test_paths_are_files_or_arrays_with_names_and_times() -> None:
    by_file = ARM.first_contact(DATA / "arm.csv", {"wire": WIRE})
    by_name = ARM.first_contact(
        ROWS[:, [2, 0, 1]],
        {"wire": WIRE},
        columns=["reach", "shoulder", "elbow"],
        times=[0, 1, 2],
    )
    assert by_file.to_dict() == by_name.to_dict()
    later = ARM.first_contact(ROWS, {"wire": WIRE}, times=[10, 30, 31])
    assert abs(later.lower - (10 + 20 * by_file.lower)) < 1e-9
    resting = ARM.first_contact(ROWS[:, :2], {"wire": WIRE}, joints={"reach": 0.02})
    assert resting.outcome == "contact" and resting.to_dict() != by_file.to_dict()


def test_gaps_are_kept_and_pairs_ignored() -> None:
    scene: dict[str, ConvexPolyhedron | Solid] = {"wire": WIRE}
    free = ARM.first_contact(ROWS, scene, ignore=[("wire", "tool")])
    assert (free.outcome, free.upper, free.lower, free.pair) == ("free", math.inf, 2, None)
    free.verify()
    assert ARM.first_contact(ROWS).outcome != "contact"
    near = ARM.first_contact(ROWS, scene, min_gap=0.02)
    assert near.lower < ARM.first_contact(ROWS, scene).lower
    near.verify()
    # A non-convex frame around the position of the wire.
    ring = Solid.from_pieces(
        [ConvexPolyhedron.cuboid([1.18, 0.38, z], [1.2, 0.42, z + 0.02]) for z in (0.1, 0.29, 0.5)]
    )
    met = ARM.first_contact(ROWS, {"ring": ring})
    assert (met.outcome, met.pair) == ("contact", ("tool", "ring"))
    met.verify()


def test_srdf_says_which_links_are_not_held_against_each_other(tmp_path: Path) -> None:
    names = [("base", "upper"), ("upper", "fore"), ("fore", "tool")]
    pairs = [f'<disable_collisions link1="{a}" link2="{b}"/>' for a, b in names]
    (tmp_path / "arm.srdf").write_text(f"<robot>{''.join(pairs)}</robot>")
    arm = Robot.read(DATA / "arm.urdf", srdf=tmp_path / "arm.srdf")
    found = arm.first_contact(ROWS)
    assert found.pairs == 3 and not any("SRDF" in note for note in found.notes)
    (tmp_path / "other.srdf").write_text('<robot><disable_collisions link1="a" link2="b"/></robot>')
    with pytest.raises(InputError, match="srdf: unknown name a; known names: base"):
        Robot.read(DATA / "arm.urdf", srdf=tmp_path / "other.srdf")


def test_invalid_arguments_are_refused(tmp_path: Path) -> None:
    def refused(error: type[ColltransError], words: str, *given: Any, **more: Any) -> None:
        with pytest.raises(error, match=words):
            ARM.first_contact(*given, **more)

    refused(InputError, "path: rows have 2 values, expected 3, one for each joint", ROWS[:, :2])
    refused(InputError, r"path: an array of shape \(3,\), not \(N, joints\)", [0, 0, 0])
    refused(InputError, "path: not an array of numbers", [["a", "b", "c"]])
    refused(InputError, "path: cannot read .*none.csv", tmp_path / "none.csv")
    refused(InputError, "columns: 2 names for rows of 3 values", ROWS, columns=["a", "b"])
    refused(
        InputError,
        "path: column a does not name an independent joint",
        ROWS,
        columns=["a", "elbow", "reach"],
    )
    refused(
        InputError, "path: invalid time 1 of row 2; times must be finite", ROWS, times=[0, 2, 1]
    )
    refused(InputError, r"path: the path has \d+ rows and 2 times; give", ROWS, times=[0, 1])
    refused(InputError, "path: joint hand is not an independent joint", ROWS, joints={"hand": 1.0})
    refused(
        InputError, "ignore: unknown name hand; known names: base", ROWS, ignore=[("tool", "hand")]
    )
    refused(QueryError, "gap", ROWS, min_gap=-1.0)
    refused(
        QueryError,
        "row 0: invalid value NaN of joint shoulder",
        [[np.nan, 0, 0], [0, 0, 0]],
    )
    with pytest.raises(TypeError, match="neither a ConvexPolyhedron nor a Solid"):
        ARM.first_contact(ROWS, {"wire": "wire.obj"})  # type: ignore[dict-item]
    with pytest.raises(AssemblyError, match="arm.csv"):
        Robot.read(DATA / "arm.csv")
    found = ARM.first_contact(np.array([[0, 0, 0.5], [0.1, 0, 0]]))
    assert any("reach exceeds its limits" in note for note in found.notes)


def test_many_paths_equal_single_paths() -> None:
    random = np.random.default_rng(5)
    paths = [
        np.cumsum(random.normal(size=(random.integers(1, 6), 3)) * [0.8, 0.8, 0.05], axis=0)
        for _ in range(60)
    ]
    paths[7] = np.zeros((2, 2))
    scene = {"wire": WIRE, "post": ConvexPolyhedron.cuboid([0.6, 0.3, 0], [0.7, 0.4, 1])}
    columns = path_many(ARM, paths, scene, threads=3)
    assert columns.counts() == path_many(ARM, paths, scene, threads=1).counts()
    assert columns.bodies == ("base", "upper", "fore", "tool", "wire", "post")
    assert columns.errors[7].startswith("rows have 2 values") and isinstance(columns[7], Failed)
    assert {"contact", "free", "error"} <= set(columns.counts())
    for k in np.flatnonzero(columns.outcome != "error"):
        alone = columns[int(k)]
        assert isinstance(alone, PathContact)
        assert alone.outcome == columns.outcome[k]
        assert [alone.lower, alone.upper] == [columns.lower[k], columns.upper[k]]
        assert alone.value is None or alone.value == columns.value[k]
        if alone.pair is None:
            assert columns.first[k] == -1 and columns.row[k] == -1
            continue
        assert alone.pair == (columns.bodies[columns.first[k]], columns.bodies[columns.second[k]])
        assert alone.place == (columns.row[k], columns.share[k])
        assert alone.point is None or np.array_equal(alone.point, columns.point[k])
        alone.verify()
    block = path_many(ARM, np.stack([ROWS, ROWS]), scene, times=[[0, 1, 2], [0, 2, 4]])
    assert block.lower[1] == pytest.approx(2 * block.lower[0])
    assert len(path_many(ARM, [])) == 0
    with pytest.raises(InputError, match="times: 1 arrays for 2 paths"):
        path_many(ARM, [ROWS, ROWS], times=[[0, 1, 2]])


def test_the_proof_file_matches_the_schema() -> None:
    for path, scene in ((ROWS, {"wire": WIRE}), (ROWS, {}), (ROWS[:1], {"wire": WIRE})):
        saved = json.loads(ARM.first_contact(path, scene, min_gap=0.001).proof_json())
        assert list(saved["statement"]) == ["path"]
        conform("proof", saved)
