"""Tests assemblies: rooms and plans as on the command line, and refusals."""

import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

from colltrans import Assembly, InputError
from colltrans.assembly import Stage
from colltrans.errors import AssemblyError

GEARBOX = ROOT / "data" / "gearbox_small"
BOX = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]


def cuboid(low: list[float], high: list[float]) -> tuple[np.ndarray, list[list[int]]]:
    corner = np.array([low, high], dtype=float)
    picks = [[k & 1, k >> 1 & 1, k >> 2 & 1] for k in range(8)]
    return np.array([[corner[p[a], a] for a in range(3)] for p in picks]), BOX


@pytest.fixture(scope="module")
def gearbox() -> Assembly:
    return Assembly.read(GEARBOX)


def test_the_plan_equals_that_of_the_command_line(cli: Path, gearbox: Assembly) -> None:
    command: list[str | Path] = [cli, "assembly", GEARBOX, "--json"]
    told = subprocess.run(command, check=True, capture_output=True, text=True)
    known = json.loads(told.stdout)
    plan = gearbox.plan()
    assert repr(plan) == "Plan(10 steps, 6 parts stuck)"
    assert [step.parts for step in plan.steps] == [step["parts"] for step in known["plan"]]
    for step, its in zip(plan.steps, known["plan"], strict=True):
        assert list(step.direction) == its["direction"]
        assert step.travel == its["travel"]
        assert list(step.travel_bounds) == its["travel_bounds"]
        assert its["travel_bounds"][0] <= step.travel <= its["travel_bounds"][1]
        assert step.after == its["after"]
    assert (plan.last, plan.left) == (known["last"], known["left"])
    for stage, its in zip(plan.stages, known["stages"], strict=True):
        first, last = its["steps"]
        assert stage == Stage(its["takes"], range(first, last + 1), its["travel"])
    assert plan.stages[0].takes == "4 x bolt" and plan.steps[4].after == [0, 1, 2, 3]
    # The opposite direction swaps blockers, except for parts that are free upwards.
    assert gearbox.plan(gravity=[0, 0, 1]).last == plan.last
    (stuck,), (its,) = plan.stuck, known["stuck"]
    assert stuck.proven == its["proof"]["proven"] and "proven" in stuck.because
    (asked,) = gearbox.plan(proofs=False).stuck
    assert asked.proven is None and f"{asked.directions} directions asked" in asked.because


def test_fasteners_equal_those_of_the_command_line(cli: Path, gearbox: Assembly) -> None:
    command: list[str | Path] = [cli, "assembly", GEARBOX, "--json"]
    told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    known = {part["name"]: part["fastener"] for part in told["parts"] if "fastener" in part}
    found = gearbox.fasteners()
    assert found.keys() == known.keys() == {f"bolt_{k}" for k in range(4)}
    for name, fastener in found.items():
        its = known[name]
        assert (fastener.kind, fastener.size, fastener.words) == (
            its["kind"],
            its["size"],
            its["words"],
        )
        assert [fastener.diameter, fastener.length] == [its["diameter"], its["length"]]
        assert [list(v) for v in fastener.axis] == its["axis"]
    for step, its in zip(gearbox.plan().steps, told["plan"], strict=True):
        assert (step.unscrewing is None) == ("unscrew" not in its)
        if step.unscrewing is not None:
            assert step.unscrewing.turns == its["unscrew"]["turns"]
            assert step.unscrewing.words == its["unscrew"]["words"]


def test_rooms_and_blocking_name_the_obstructing_parts(gearbox: Assembly) -> None:
    rooms = gearbox.rooms([[0, 0, 2], [0, 0, -1]])
    assert rooms.directions.tolist() == [[0, 0, 1], [0, 0, -1]]
    bolt = rooms.parts.index("bolt_0")
    assert rooms.distance[bolt, 0] == np.inf and rooms.by[bolt, 0] == -1
    assert rooms.distance[bolt, 1] < np.inf
    assert rooms.parts[rooms.by[bolt, 1]] in {"housing", "cover"}
    graph = gearbox.blocking([0, 0, 1])
    assert graph.blockers["bolt_0"] == [] and ["bolt_0"] in graph.removable
    assert "bolt_0" in graph.blockers["cover"]


def test_a_removal_map(gearbox: Assembly) -> None:
    rooms = gearbox.removal_map("bolt_0", samples=162, border=0.2)
    assert len(rooms.directions) == len(rooms.distance) == len(rooms.by) >= 162
    assert np.allclose(np.linalg.norm(rooms.directions, axis=1), 1)
    # A cone that is too narrow to be found gives its middle.
    assert rooms.regions == [] and np.allclose(rooms.isolated, [[0, 0, 1]], atol=1e-6)
    assert 0 <= rooms.free_share < 0.5


def test_parts_from_arrays_can_be_stuck_or_fixed() -> None:
    parts = {"lower": cuboid([0, 0, 0], [1, 1, 1]), "upper": cuboid([0, 0, 1], [1, 1, 2])}
    two = Assembly(parts).with_fixed("lower")
    plan = two.plan([[0, 0, 1]])
    assert [step.parts for step in plan.steps] == [["upper"]] and plan.left == ["lower"]
    overlap = Assembly({"a": cuboid([0, 0, 0], [1, 1, 1]), "b": cuboid([0.5, 0, 0], [2, 1, 1])})
    assert overlap.plan().steps == [] and overlap.plan().stuck[0].parts == ["a", "b"]
    assert overlap.plan().stuck[0].directions > 14
    first = overlap.with_ignored(("a", "b")).plan().steps[0]
    assert first.parts + ["b"] == list(first.ignored[0]) == ["a", "b"]
    ahead = [[1, 0, 0]]  # deeper into the other one
    assert overlap.with_ignored(("a", "b")).rooms(ahead).distance[0, 0] < 0.1
    assert overlap.with_ignored(("a", "b"), always=True).rooms(ahead).free()["a"] == [0]


def test_invalid_arguments_are_refused(tmp_path: Path, gearbox: Assembly) -> None:
    with pytest.raises(AssemblyError):
        Assembly.read(tmp_path / "nothing")
    with pytest.raises(AssemblyError, match="nobody"):
        gearbox.with_fixed("nobody")
    with pytest.raises(InputError, match="no part is named"):
        gearbox.removal_map()
    with pytest.raises(AssemblyError, match="direction"):
        gearbox.rooms([[0, 0, 0]])
    with pytest.raises(InputError, match="directions"):
        gearbox.rooms([0, 0, 1])
    with pytest.raises(AssemblyError):
        gearbox.plan(tolerance=-1.0)


def test_a_plan_follows_its_options() -> None:
    gearbox = Assembly.read(GEARBOX).with_fixed("housing")
    plan = gearbox.plan(remove="cover")
    assert plan.wanted is not None and plan.wanted.least and plan.wanted.out
    assert plan.wanted.others == [f"bolt_{k}" for k in range(4)]
    assert plan.steps[-1].parts == ["cover"] and "gear" in plan.last
    late = gearbox.with_before("cover", "bolt_0").plan()
    assert [step.parts for step in late.steps[:1]] == [["bolt_1"]]
    # The bolt may leave with the cover, and then the cover from the bolt.
    assert late.steps[3].parts == ["bolt_0", "cover"] and late.steps[4].parts == ["cover"]
    one = gearbox.with_subassembly("drive", "shaft", "gear").plan()
    step = next(step for step in one.steps if "gear" in step.parts)
    assert {"shaft", "gear"} <= set(step.parts)
    held = gearbox.with_never("cover", along=(0, 0, 1), within=80).plan(remove=["cover"])
    assert held.wanted is not None and not held.wanted.out
    for first in ("cover", "nobody"):
        with pytest.raises(AssemblyError):
            gearbox.with_before("bolt_0", "cover").with_before(first, "bolt*")


def test_a_press_fit_uses_its_own_tolerance() -> None:
    floor = cuboid([-1, -1, -1], [3, 3, 0])
    block, pin = cuboid([0, 0, 0], [1, 1, 1]), cuboid([0.995, 0, 0], [2, 1, 1])
    parts = Assembly({"floor": floor, "block": block, "pin": pin}).with_fixed("floor", "block")
    assert not parts.plan(samples=0).steps
    (found,) = parts.suggestions()
    assert found.parts == ("block", "pin") and found.tolerance is not None
    for made in (
        parts.with_suggestions([found]),
        parts.with_pair("block", "pin*", role="press", tolerance=0.2),
    ):
        (step,) = made.plan(samples=0).steps
        assert step.parts == ["pin"] and step.passed[0].parts == ("pin", "block")
        assert "tolerance" in step.passed[0].words
    with pytest.raises(InputError):
        parts.with_pair("block", "pin", role="welded")
    # The stuck parts of another assembly's plan are not parts of this one.
    (stuck,) = Assembly({"a": block, "b": pin}).plan(samples=0).stuck
    with pytest.raises(AssemblyError, match="unknown part a"):
        parts.suggestions(stuck=[stuck])
    with pytest.raises(AssemblyError):
        parts.with_pair("block", "pin", role="snap")


def test_rounds_the_way_back_and_times(gearbox: Assembly) -> None:
    plan = gearbox.plan()
    level = {step: k for k, steps in enumerate(plan.rounds) for step in steps}
    for k, step in enumerate(plan.steps):
        assert level[k] == max((level[j] + 1 for j in step.after), default=0)
    put = [step for step, _ in plan.assembly]
    assert put == list(reversed(range(len(plan.steps))))
    for at, (index, after) in enumerate(plan.assembly):
        assert all(k < at and index in plan.steps[put[k]].after for k in after)
    assert sum(len(after) for _, after in plan.assembly) == sum(len(s.after) for s in plan.steps)
    twice = gearbox.plan(times={"move": 3.0})
    moves = [len(step.path) + len(step.back) for step in plan.steps]
    for now, then, count in zip(twice.seconds, plan.seconds, moves, strict=True):
        assert now == pytest.approx(then + 1.5 * count)
    for wrong in ({"walk": 1.0}, {"move": -1.0}, {"move": float("nan")}):
        with pytest.raises(InputError):
            gearbox.plan(times=wrong)


def test_the_report_equals_that_of_the_command_line(
    cli: Path, gearbox: Assembly, tmp_path: Path
) -> None:
    command: list[str | Path] = [cli, "assembly", GEARBOX, "-o", tmp_path / "out"]
    subprocess.run(command, check=True, capture_output=True)
    plan = gearbox.plan()
    plan.report(tmp_path / "report.html", title="gearbox_small")
    known = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == known
    with pytest.raises(InputError, match="pickle"):
        pickle.loads(pickle.dumps(plan)).report(tmp_path / "none.html")
