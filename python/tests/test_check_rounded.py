"""Tests both verifiers on forged proofs of rounded solids in scenes, motions and paths."""

import copy
import json
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from test_check import always, changed, check, containers, value_at

import colltrans
from colltrans import ConvexPolyhedron, Motion, Obstacles, Robot, Solid, clearance

DOWN = [0.0, 0.0, -1.0]
BALL = ConvexPolyhedron.sphere(0.5)
PILL = ConvexPolyhedron.capsule([-1, 0, 0], [1, 0, 0], 0.25)
#: A floor with a tower of height 3, with rounded edges.
STEP = Solid.from_pieces(
    [ConvexPolyhedron.cuboid([0, 0, 0], [4, 2, 1]), ConvexPolyhedron.cuboid([0, 0, 0], [2, 2, 3])]
).rounded(0.25)


def steps_and_balls() -> Obstacles:
    scene = Obstacles()
    scene.add(STEP, [0, 0, -4])
    scene.add(STEP, [9, 0, 0])
    scene.add(PILL, [0, 6, 0])
    return scene


#: A bar that turns about the vertical axis.
BAR = """<robot name="gate"><link name="post"/>
  <link name="bar"><collision><origin xyz="1 0 0"/><geometry><box size="1 0.25 0.25"/></geometry>
  </collision></link><joint name="hinge" type="continuous"><parent link="post"/>
  <child link="bar"/><axis xyz="0 0 1"/></joint></robot>"""


def bar(corner: list[float], **options: Any) -> Any:
    """Returns the first contact of a bar with a rounded step of a tenth of the size."""
    x, y, z = corner
    low = ConvexPolyhedron.cuboid([x, y, z], [x + 0.4, y + 0.2, z + 0.1])
    high = ConvexPolyhedron.cuboid([x, y, z], [x + 0.2, y + 0.2, z + 0.3])
    step = Solid.from_pieces([low, high]).rounded(0.0625)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "gate.urdf"
        file.write_text(BAR)
        gate = Robot.read(file)
    return gate.first_contact([[0.0], [0.5]], {"step": step}, **options)


def turning(moving: Any, fixed: Any, **options: Any) -> Any:
    swing = Motion.turn([0, 0, 0], [0, 1, 0], degrees=40, pose=[0.5, 0.5, 4])
    return colltrans.motion(
        moving, fixed, swing, Motion.still([0, 0, -1]), **{"tolerance": 0, **options}
    )


ANSWERS: dict[str, Callable[[], Any]] = {
    "nearest": lambda: steps_and_balls().nearest(STEP, [2.75, 0.25, -2]),
    "nearest of a ball": lambda: steps_and_balls().nearest(BALL, [3.5, 0.5, -1.75]),
    "within": lambda: steps_and_balls().within(STEP, 0.125, [2.75, 0.25, -2]),
    "within of a capsule": lambda: steps_and_balls().within(PILL, 1.5, [3.5, 0.5, -1.75]),
    "clearance": lambda: steps_and_balls().clearance(STEP, DOWN, [2.75, 0.25, -2]),
    "clearance with a gap": lambda: steps_and_balls().clearance(
        BALL, DOWN, [3.5, 0.5, -1], min_gap=0.5
    ),
    "motion": lambda: turning(STEP, STEP),
    "motion of a ball": lambda: turning(BALL, STEP),
    "motion with a gap": lambda: turning(PILL, STEP, min_gap=0.125),
    "motion with a tolerance": lambda: turning(STEP, STEP, tolerance=0.0625),
    "path": lambda: bar([0.875, 0.3, 0]),
    "path with a gap": lambda: bar([0.875, 0.4, 0], min_gap=0.03125),
    "free path": lambda: bar([0.875, 1, 0]),
    "path from an overlap": lambda: bar([0.875, 0, 0]),
}


def verdicts(cli: Path, folder: Path, file: Any) -> tuple[bool, bool, bool]:
    """Returns whether each verifier accepts a file, and whether the checker reads all of it."""
    saved = folder / "proof.json"
    saved.write_text(json.dumps(file))
    code = subprocess.run([cli, "verify", saved], capture_output=True).returncode
    assert code in (0, 3, 6)
    try:
        report = check.check(saved.read_text())
    except (check.RefusedError, check.NoProofError):
        return code == 0, False, True
    return code == 0, True, not report.partly and bool(report.holds)


def bodies_with_radius(file: Any) -> Iterator[tuple[Any, ...]]:
    for k, body in enumerate(file["bodies"]):
        ((kind, content),) = body.items()
        if kind != "pieces" and content.get("radius"):
            yield ("bodies", k, kind, "radius")


def scaled_vertices(file: Any, by: float) -> Any:
    """Returns a file with another unit of the vertices of solids, but not of their radii."""
    other = copy.deepcopy(file)
    for body in other["bodies"]:
        for piece in body.get("rounded", {}).get("pieces", []):
            piece["vertices"] = [[by * x for x in v] for v in piece["vertices"]]
    return other


def swapped_bodies(file: Any) -> Any:
    """Returns a file with the first two bodies in the place of each other."""
    other = copy.deepcopy(file)
    other["bodies"][:2] = other["bodies"][1::-1]
    return other


def added(by: float) -> Callable[[float], float]:
    """Returns a change that adds a number."""
    return lambda x: x + by


#: The radii of the bodies, by the amounts of their changes.
RADII = {"larger": 1.0, "smaller": -1e-2, "a little larger": 1e-6, "a little smaller": -1e-6}


def forged(file: Any) -> Iterator[tuple[str, Any]]:
    """Returns changed files, with a name of the change."""
    for way in bodies_with_radius(file):
        for name, by in RADII.items():
            yield f"{way[1]}: {name}", changed(file, way, added(by))
        for value in (-0.25, None, "0.25", 1e300):
            yield f"{way[1]}: {value}", changed(file, way, always(value))
        yield f"{way[1]}: in another unit", changed(file, way, lambda r: 1000.0 * r)
    yield "vertices in another unit", scaled_vertices(file, 0.001)
    yield "bodies swapped", swapped_bodies(file)
    (kind,) = file["statement"]
    statement = ("statement", kind)
    for name in ("lower", "upper", "distance", "time", "min_gap", "length"):
        for way in numbers_named(file, name):
            if way[:2] in (statement, ("query", way[1])):
                for by in (1e-9, -1e-9, 0.25, -0.25):
                    yield f"{way} {by:+}", changed(file, way, added(by))
    for way in containers(file["statement"]):
        entry = value_at(file["statement"], way)
        if isinstance(entry, list) and len(entry) > 1 and not isinstance(entry[0], int | float):
            yield f"{way} without an entry", changed(file, ("statement", *way), lambda of: of[1:])
    for way in numbers_named(file, "obstacle"):
        yield f"{way} of another body", changed(file, way, lambda k: k + 1)
    for way in places_of_bodies(file):
        for by in (1e-9, 0.25):
            yield f"{way} moved", changed(file, way, added(-by))


def numbers_named(file: Any, name: str) -> Iterator[tuple[Any, ...]]:
    """Returns the paths of the numbers with this name, of each list only in the first entry."""
    for way in containers({"file": file}):
        found = value_at({"file": file}, way)
        if isinstance(found, dict) and isinstance(found.get(name), int | float):
            yield (*way[1:], name)


def places_of_bodies(file: Any) -> Iterator[tuple[Any, ...]]:
    """Returns the paths of the heights at which bodies are placed."""
    for way in containers(file["placement"]):
        found = value_at(file["placement"], way)
        if isinstance(found, dict) and "translation" in found:
            yield ("placement", *way, "translation", 2)


@pytest.mark.parametrize("min_gap", [0.0, 0.125])
def test_facets_of_rounded_solids_meet_within_the_bounds(min_gap: float) -> None:
    stop = clearance(BALL, STEP, DOWN, moving_pose=[2.5, 0.5, 9], tolerance=0, min_gap=min_gap)
    file = json.loads(stop.proof_json())
    (line,) = check.check(json.dumps(file)).holds
    assert "come as near as" in line
    way = ("statement", "clearance", "stop", "translation")
    for name, by in (("lower", 1e-9), ("upper", -1e-9)):
        with pytest.raises(check.RefusedError):
            check.check(json.dumps(changed(file, (*way, name), added(by))))
    for radius in bodies_with_radius(file):
        for by in (1e-9, -1e-9):
            with pytest.raises(check.RefusedError):
                check.check(json.dumps(changed(file, radius, added(by))))


@pytest.mark.parametrize("name", ANSWERS)
def test_both_verifiers_accept_a_true_proof(cli: Path, tmp_path: Path, name: str) -> None:
    file = json.loads(ANSWERS[name]().proof_json())
    library, fractions, _ = verdicts(cli, tmp_path, file)
    assert library and fractions


@pytest.mark.parametrize("name", ANSWERS)
def test_both_verifiers_agree_about_forged_proofs(cli: Path, tmp_path: Path, name: str) -> None:
    file = json.loads(ANSWERS[name]().proof_json())
    refused = 0
    for change, other in forged(file):
        library, fractions, all_of_it = verdicts(cli, tmp_path, other)
        assert fractions or not library, change
        # The report lists the parts that only the library checks.
        assert library or not (fractions and all_of_it), change
        refused += not fractions
    assert refused > 10
