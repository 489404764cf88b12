"""Tests rounded bodies: closed forms, proofs for both checkers, copies, refusals."""

import copy
import json
import math
import pickle
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

import colltrans
from colltrans import (
    Cast,
    ConvexPolyhedron,
    Motion,
    Obstacles,
    Robot,
    Solid,
    cast,
    cast_many,
    check,
    clearance,
    depth,
    distance,
    free_directions,
    within,
)
from colltrans.errors import BuildError, QueryError

CUBE = ConvexPolyhedron.cuboid([-1, -1, -1], [1, 1, 1])
BALL = ConvexPolyhedron.sphere(0.5)
DOWN = [0.0, 0, -1]


def test_casts_meet_the_round_surface() -> None:
    cases: list[tuple[list[float], float]] = [
        ([0, 0, 5], 3.5),
        ([1.25, 0, 5], 4 - math.sqrt(0.25 - 0.0625)),
        ([1.2, 1.2, 5], 4 - math.sqrt(0.25 - 0.08)),
    ]
    for start, expected in cases:
        query = Cast(BALL, CUBE, DOWN, moving_pose=start)
        found: Any = query.cast()
        assert found.translation == pytest.approx(expected, abs=1e-13)
        assert found.certificate.lower <= found.translation <= found.certificate.upper
        assert found.certificate.verify() < 1e-12
        report = check.check(found.proof_json())
        assert report.holds and not report.partly
    stop: Any = clearance(BALL, CUBE, DOWN, moving_pose=[0, 0, 5])
    assert stop.distance == pytest.approx(3.5)
    aside: Any = cast(BALL, CUBE, DOWN, moving_pose=[2, 0, 5])
    assert aside.certificate.margin == pytest.approx(0.5)
    assert check.check(aside.proof_json()).holds


def test_proofs_of_other_radii_are_refused() -> None:
    found: Any = cast(BALL, CUBE, DOWN, moving_pose=[1.25, 0, 5])
    aside: Any = cast(BALL, CUBE, DOWN, moving_pose=[2, 0, 5])
    apart: Any = distance(BALL, CUBE, moving_pose=[0, 0, 4])
    deep: Any = depth(BALL, CUBE, moving_pose=[0, 0, 1.25])
    for answer, directions in [(found, (-1, 1)), (aside, (1,)), (apart, (-1, 1)), (deep, (-1, 1))]:
        text = answer.proof_json()
        assert check.check(text).holds
        for way in directions:
            file = json.loads(text)
            file["bodies"][0]["convex"]["radius"] += way * 1e-9
            with pytest.raises(check.RefusedError):
                check.check(json.dumps(file))


def test_distances_and_depths_follow_the_radii() -> None:
    pill = ConvexPolyhedron.capsule([-1, 0, 0], [1, 0, 0], 0.25)
    apart = distance(pill, pill, fixed_pose=[0, 2, 0])
    assert apart.lower <= 1.5 <= apart.upper < 1.5 + 1e-12
    assert apart.on_moving[1] == pytest.approx(0.25) and apart.on_fixed[1] == pytest.approx(1.75)
    assert depth(BALL, CUBE, moving_pose=[0, 0, 1.25]).upper == pytest.approx(0.25)
    assert depth(BALL, CUBE, moving_pose=[0, 0, 0.75]).upper == pytest.approx(0.75)
    above = [0, 0, 2]
    assert within(BALL, CUBE, 0.51, moving_pose=above).closer is True
    assert within(BALL, CUBE, 0.49, moving_pose=above).closer is False
    near: Any = within(BALL, CUBE, 1.0, moving_pose=above).points
    assert near[0][2] == pytest.approx(1.5) and near[1][2] == pytest.approx(1)
    assert BALL.volume == pytest.approx(math.pi / 6)


def test_many_casts_agree_with_single_ones() -> None:
    starts = np.array([[x, 0.1, 4.0] for x in np.linspace(-2, 2, 41)])
    many = cast_many(BALL, CUBE, DOWN, moving_pose=starts)
    for row, start in enumerate(starts):
        one: Any = cast(BALL, CUBE, DOWN, moving_pose=start)
        found = getattr(getattr(one, "contact", one), "translation", math.nan)
        np.testing.assert_array_equal(many.translation[row], found)


def test_motions_and_obstacles_accept_rounded_bodies() -> None:
    swing = Motion.turn([0, 0, 0], [0, 1, 0], degrees=90, pose=[0, 0, 4])
    floor = ConvexPolyhedron.cuboid([-9, -9, -1], [9, 9, 0])
    met: Any = colltrans.motion(BALL, floor, swing)
    assert met.lower <= math.acos(0.5 / 4) / (math.pi / 2) <= met.upper
    scene = Obstacles()
    names = [scene.add(BALL, [3.0 * k, 0, 0]) for k in range(1, 9)]
    nearest: Any = scene.nearest(BALL)
    assert nearest.obstacle == names[0]
    assert nearest.upper == pytest.approx(2)


def _scene_answers() -> list[tuple[str, Any]]:
    scene = Obstacles()
    for k in (2, 3):
        scene.add(BALL, [3.0 * k, 0, 0])
    scene.add(CUBE.rounded(0.25), [0, 0, -4])
    pill = ConvexPolyhedron.capsule([-1, 0, 0], [1, 0, 0], 0.25)
    return [
        ("nearest", scene.nearest(pill)),
        ("within", scene.within(pill, 2.6)),
        ("clearance", scene.clearance(pill, DOWN)),
        ("sliding", scene.clearance(pill, DOWN, pose=[0, -1.5, 0])),
    ]


def _moving_answers() -> list[tuple[str, Any]]:
    swing = Motion.turn([0, 0, 0], [0, 1, 0], degrees=90, pose=[0, 0, 4])
    floor = ConvexPolyhedron.cuboid([-9, -9, -1], [9, 9, 0]).rounded(0.125)
    arm = Robot.read(ROOT / "data" / "arm.urdf")
    rows = [[-1.2, 0.6, 0], [0.9, 0.3, 0.05]]
    beside = ConvexPolyhedron.sphere(0.1, center=[1.2, 0.4, 0.3])
    away = ConvexPolyhedron.sphere(0.1, center=[0.2, -1.2, 0.3])
    return [
        ("motion", colltrans.motion(BALL, floor, swing)),
        ("motion with a gap", colltrans.motion(BALL, floor, swing, min_gap=0.25)),
        ("path", arm.first_contact(rows, {"ball": beside})),
        ("path with a gap", arm.first_contact(rows, {"ball": beside}, min_gap=0.125)),
        ("free path", arm.first_contact(rows, {"ball": away})),
    ]


@pytest.mark.parametrize("answers", [_scene_answers, _moving_answers])
def test_both_checkers_agree_about_other_radii(
    cli: Path, tmp_path: Path, answers: Callable[[], list[tuple[str, Any]]]
) -> None:
    def accepted(text: str) -> bool:
        saved = tmp_path / "proof.json"
        saved.write_text(text)
        told = subprocess.run([cli, "verify", saved], capture_output=True)
        assert told.returncode in (0, 6)
        try:
            report = check.check(text)
        except check.RefusedError:
            assert told.returncode == 6
            return False
        assert report.holds and not report.partly and told.returncode == 0
        return True

    for name, answer in answers():
        text = answer.proof_json()
        assert accepted(text), name
        refused = 0
        for body, shape in enumerate(json.loads(text)["bodies"]):
            for change in (-1e-3, 1e-9, 1.0):
                file = json.loads(text)
                if "radius" in shape["convex"] and shape["convex"]["radius"] + change > 0:
                    file["bodies"][body]["convex"]["radius"] += change
                    refused += not accepted(json.dumps(file))
        assert refused, name


def test_copies_keep_the_radius() -> None:
    body = CUBE.rounded(0.25).rounded(0.25)
    for again in (copy.copy(body), copy.deepcopy(body), pickle.loads(pickle.dumps(body))):
        assert again.radius == 0.5 and "radius 0.5" in repr(again)
    assert ConvexPolyhedron.from_json(body.to_json()).radius == 0.5


def test_what_is_not_defined_is_refused() -> None:
    for radius in (-1.0, math.nan, math.inf):
        with pytest.raises(BuildError, match="radius"):
            ConvexPolyhedron.sphere(radius)
    with pytest.raises(BuildError, match="rounded"):
        BALL.grown(0.5)
    round_step = STEP.rounded(0.25)
    for refused in (
        lambda: round_step.shrunk(0.1),
        lambda: Solid.from_pieces([round_step, CUBE]),
        lambda: free_directions(round_step, CUBE, fixed_pose=[9, 0, 0]),
        lambda: STEP.rounded(-1.0),
    ):
        with pytest.raises((BuildError, QueryError), match="radius"):
            refused()


#: A floor with a tower of height 3.
STEP = Solid.from_pieces(
    [
        ConvexPolyhedron.cuboid([0, 0, 0], [4, 2, 1]),
        ConvexPolyhedron.cuboid([0, 0, 0], [2, 2, 3]),
    ]
)


def checked(answer: Any, partly: bool = True) -> Any:
    """Checks the proof of an answer with both checkers, and returns the file."""
    text = answer.proof_json()
    report = check.check(text)
    assert report.holds or report.unchecked
    assert report.partly == partly
    return json.loads(text)


def test_rounded_solids_add_radii() -> None:
    step = STEP.rounded(0.25)
    assert step.radius == 0.25 and "radius 0.25" in repr(step)
    for x, y, expected in [(3.5, 1.0, 7.25), (1.0, 1.0, 5.25), (2.5, 1.0, 6 - math.sqrt(0.3125))]:
        stop: Any = clearance(BALL, step, DOWN, moving_pose=[x, y, 9], tolerance=0)
        assert stop.distance == pytest.approx(expected, abs=1e-11)
    near = distance(BALL, step, moving_pose=[1, 1, 9])
    assert near.lower <= 5.25 <= near.upper < 5.25 + 1e-12
    assert near.on_moving[2] == pytest.approx(8.5) and near.on_fixed[2] == pytest.approx(3.25)
    assert within(BALL, step, 5.26, moving_pose=[1, 1, 9]).closer is True
    assert within(BALL, step, 5.24, moving_pose=[1, 1, 9]).closer is False
    pill = ConvexPolyhedron.capsule([-1, 0, 0], [1, 0, 0], 0.25)
    apart = distance(pill, step, moving_pose=[4, 1, 2.5])
    assert apart.lower <= 0.5 <= apart.upper
    # A mesh that is not convex.
    bolt = Solid.read(ROOT / "data" / "bolt.stl")
    point = distance(ConvexPolyhedron([[0, 0, 0]]), bolt, moving_pose=[0, 0, 40])
    ball = distance(BALL, bolt, moving_pose=[0, 0, 40])
    assert ball.upper == pytest.approx(point.upper - 0.5, abs=1e-10)


def test_proofs_of_rounded_solids_state_the_radius() -> None:
    step = STEP.rounded(0.25)
    answers: list[tuple[Any, float]] = [
        (clearance(BALL, step, DOWN, moving_pose=[9, 1, 9]), 1),
        (distance(BALL, step, moving_pose=[3.5, 1, 4]), -1),
    ]
    for answer, way in answers:
        file = checked(answer)
        assert [body["rounded"]["radius"] for body in file["bodies"]] == [0.5, 0.25]
        for body in (0, 1):
            changed = copy.deepcopy(file)
            changed["bodies"][body]["rounded"]["radius"] += way * 1e-6
            with pytest.raises(check.RefusedError):
                check.check(json.dumps(changed))
        changed = copy.deepcopy(file)
        del changed["bodies"][0]["rounded"]["radius"]
        with pytest.raises(check.NoProofError):
            check.check(json.dumps(changed))


def test_motions_of_rounded_solids_are_checked() -> None:
    swing = Motion.turn([0, 0, 0], [0, 1, 0], degrees=90, pose=[0, 0, 4])
    floor = Solid.from_pieces(
        [
            ConvexPolyhedron.cuboid([-9, -9, -1], [9, 9, 0]),
            ConvexPolyhedron.cuboid([-9, -9, -1], [-8, 9, 3]),
        ]
    )
    met: Any = colltrans.motion(BALL, floor.rounded(0.125), swing, tolerance=0)
    expected = math.acos(0.625 / 4) / (math.pi / 2)
    assert met.lower - 1e-11 <= expected <= met.upper + 1e-11 and met.upper - met.lower < 1e-9
    file = json.loads(met.proof_json())
    report = check.check(json.dumps(file))
    assert any("radii of 0.625" in line for line in report.holds), report
    for way in (-1, 1):
        changed = copy.deepcopy(file)
        changed["bodies"][1]["rounded"]["radius"] += way * 1e-6
        with pytest.raises(check.RefusedError):
            check.check(json.dumps(changed))


def test_obstacles_may_be_rounded_solids() -> None:
    scene = Obstacles()
    names = [scene.add(STEP.rounded(0.1 * k), [0, 0, 9.0 * k]) for k in range(1, 5)]
    nearest: Any = scene.nearest(BALL, [1, 1, 0])
    assert nearest.obstacle == names[0]
    assert nearest.upper == pytest.approx(9 - 0.1 - 0.5)


def test_copies_of_rounded_solids_keep_the_radius() -> None:
    step = STEP.rounded(0.25).rounded(0.125)
    for again in (copy.copy(step), copy.deepcopy(step), pickle.loads(pickle.dumps(step))):
        assert again.radius == 0.375
        np.testing.assert_array_equal(again.vertices, step.vertices)
