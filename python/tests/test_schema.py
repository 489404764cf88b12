"""Tests that the output of the command line matches ``docs/answers.schema.json``."""

import json
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT, Batch, draw

from colltrans import Cast, ConvexPolyhedron, Solid, SolidBlocked, SolidCast, check

Draft202012Validator = pytest.importorskip("jsonschema").Draft202012Validator
SCHEMA = json.loads((ROOT / "docs" / "answers.schema.json").read_text())
DATA = ROOT / "data"
ANSWERS = {"contact", "grazing", "separated", "blocked", "slides", "behind", "overlapping", "error"}


def of(name: str) -> Any:
    return Draft202012Validator({**SCHEMA, "anyOf": [{"$ref": f"#/$defs/{name}"}]})


def conform(name: str, value: Any) -> None:
    """Reports the fault of the failing part, not only that no alternative matches."""
    part = Draft202012Validator({"$defs": SCHEMA["$defs"], "$ref": f"#/$defs/{name}"})
    wrong = [f"{error.json_path}: {error.message}" for error in part.iter_errors(value)]
    assert wrong == [], value
    assert of(name).is_valid(value)


def ask(cli: Path, words: Sequence[str], code: int = 0) -> Any:
    told = subprocess.run([cli, *words, "--json"], capture_output=True, text=True, cwd=DATA)
    assert told.returncode == code, told.stderr
    return json.loads(told.stdout)


def test_the_schema_is_one() -> None:
    Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("query", ["contact", "clearance"])
def test_answers_of_convex_bodies(batch: Batch, query: str) -> None:
    seen = set()
    for answer in batch(draw(seed=26, count=400).lines(query=query)):
        conform("answer", answer)
        seen.add(answer["outcome"])
    wanted = {"contact", "grazing", "separated"} if query == "contact" else ANSWERS - {"contact"}
    assert seen >= wanted - {"grazing", "error"}
    (wrong,) = batch([{"moving": {"points": []}}])
    assert wrong["outcome"] == "error"
    conform("answer", wrong)


@pytest.mark.parametrize("pose", ["0,0,0", "0,0,9", "0.5,0,0", "0,40,0"])
def test_all_directions_and_their_proofs(cli: Path, tmp_path: Path, pose: str) -> None:
    proof = tmp_path / "proof.json"
    words = ["directions", "bolt.stl", "--from", "plate.off", "--moving-pose", pose]
    answer = ask(cli, [*words, "--save-proof", str(proof)])
    conform("directions", answer)
    if answer["outcome"] != "overlapping":
        conform("proof", json.loads(proof.read_text()))
        conform("verified", ask(cli, ["verify", str(proof)]))


def test_free_directions_and_proofs_of_an_assembly(cli: Path) -> None:
    words = ["assembly", "gearbox_small", "--free", "bolt_0", "--free", "cover"]
    conform("assembly", ask(cli, words))


CLEAR = ["clear", "bolt.stl", "--from", "plate.off", "--moving-pose"]
CAST = ["ellipsoid_a.obj", "ellipsoid_b.off", "--direction", "1,0.1,0.2", "--moving-pose"]
HULL = ["cast", "bolt.stl", "plate.off", "--hull", "--direction", "-z", "--moving-pose"]


@pytest.mark.parametrize(
    "words",
    [
        [*CLEAR, "0,0,9", "--direction", "-z"],
        [*CLEAR, "0,0,9", "--direction", "z"],
        [*CLEAR, "0,40,9", "--direction", "z"],
        [*CLEAR, "0.5,0,0", "--direction", "-z"],
        [*CLEAR, "0.5,0,0", "--direction", "-z", "--ignore-start-overlaps"],
        ["cast", *CAST, "-5,0.2,0.3"],
        ["cast", *CAST, "-5,9,0.3"],
        ["clearance", *CAST, "-5,0.2,0.3"],
        ["clearance", *CAST, "5,0.2,0.3"],
        ["clearance", *CAST, "0,0.2,0.3"],
        [*HULL, "0,0,9"],
    ],
)
def test_answers_and_their_proofs(cli: Path, tmp_path: Path, words: list[str]) -> None:
    proof = tmp_path / "proof.json"
    conform("answer", ask(cli, [*words, "--save-proof", str(proof)]))
    file = json.loads(proof.read_text())
    conform("proof", file)
    conform("verified", ask(cli, ["verify", str(proof)]))


SCENE = ["--scene", "plate.off", "scene.jsonl", "--moving-pose"]


@pytest.mark.parametrize(
    "words",
    [
        ["distance", "dodecahedron.off", *SCENE, "24.25,0,4"],
        ["distance", "bolt.stl", *SCENE, "0,0,9"],
        ["distance", "dodecahedron.off", *SCENE, "24.25,0,0"],
        ["within", "dodecahedron.off", *SCENE, "24.25,0,4", "--length", "2.7"],
        ["within", "dodecahedron.off", *SCENE, "24.25,0,4", "--length", "0.5"],
        ["within", "box.off", *SCENE, "24,0,4", "--length", "3"],
        ["clearance", "dodecahedron.off", *SCENE, "24.25,0,4", "--direction", "-z"],
        ["clearance", "dodecahedron.off", *SCENE, "24.25,0,4", "--direction", "z"],
        ["clearance", "dodecahedron.off", *SCENE, "24.25,0,0", "--direction", "z"],
        ["clearance", "bolt.stl", *SCENE, "0,0,9", "--direction", "-z", "--min-gap", "0.25"],
    ],
)
def test_one_body_among_many(cli: Path, tmp_path: Path, words: list[str]) -> None:
    box = "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n"
    box += "4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n"
    (tmp_path / "box.off").write_text(box)
    crate = {"mesh": "box.off"}
    lines = [{"body": crate, "pose": {"translation": [2 * k, 0, 0]}} for k in range(5, 15)]
    (tmp_path / "scene.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    here = {"scene.jsonl": tmp_path / "scene.jsonl", "box.off": tmp_path / "box.off"}
    words = [str(here.get(word, word)) for word in words]
    proof = tmp_path / "proof.json"
    answer = ask(cli, [*words, "--save-proof", str(proof)])
    conform("among", answer)
    file = json.loads(proof.read_text())
    conform("proof", file)
    conform("verified", ask(cli, ["verify", str(proof)]))
    assert check.check(proof.read_text()).holds
    # A body that is nearer than claimed.
    places = file["placement"]["poses"]
    places[2]["pose"] = places[0]["pose"]
    if answer["outcome"] not in ("meeting", "overlapping"):
        with pytest.raises(check.RefusedError):
            check.check(json.dumps(file))


def plain(answer: Any) -> Any:
    """Returns the record without the command line's own texts and file names."""
    mine = ("message", "moving", "fixed")
    return {name: value for name, value in answer.items() if name not in mine}


def test_answers_of_solids_are_the_command_lines(cli: Path) -> None:
    bolt, plate = Solid.read(DATA / "bolt.stl"), Solid.read(DATA / "plate.off")
    seen = set()
    for start, way in [("0,0,9", "-z"), ("0,0,9", "z"), ("0,40,9", "z"), ("0.5,0,0", "-z")]:
        for ignore in (False, True):
            pose = [float(x) for x in start.split(",")]
            direction = [0, 0, -1 if way == "-z" else 1]
            query = SolidCast(
                bolt, plate, direction, moving_pose=pose, ignore_start_overlaps=ignore
            )
            words = [*CLEAR, start, "--direction", way, *["--ignore-start-overlaps"] * ignore]
            here, there = query.clearance().to_dict(), ask(cli, words)
            conform("answer", here)
            for overlap in there.get("start_overlaps", []):
                del overlap["moving"], overlap["fixed"]
            assert here == plain(there)
            seen.add(here["outcome"])
    assert seen == {"blocked", "free", "overlapping"}


def test_every_class_of_answers_has_a_record() -> None:
    cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    for start in ([-3, 0.5, 0], [-3, 1, 0], [-3, 9, 0], [0.5, 0, 0], [3, 0, 0]):
        query = Cast(cube, cube, [1, 0, 0], moving_pose=start)
        found: list[Any] = [query.cast(), query.contact_range(), query.clearance()]
        depth, meeting = query.directional_depth(), query.intersects()
        assert depth.to_dict() == depth.clearance.to_dict()
        told = meeting.to_dict()
        assert told.pop("direction") == meeting.direction.tolist()
        assert told == meeting.outcome.to_dict()
        for answer in [*found, depth, meeting]:
            conform("answer", answer.to_dict())
    blocked = SolidCast(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0]).clearance()
    assert isinstance(blocked, SolidBlocked)
    assert blocked.contact.to_dict() == blocked.to_dict()


def test_a_proof_that_does_not_hold(cli: Path, tmp_path: Path) -> None:
    proof = tmp_path / "proof.json"
    ask(cli, ["cast", *CAST, "-5,0.2,0.3", "--save-proof", str(proof)])
    file = json.loads(proof.read_text())
    cast = file["query"]["cast"]
    cast["direction"] = [-x for x in cast["direction"]]
    proof.write_text(json.dumps(file))
    conform("verified", ask(cli, ["verify", str(proof)], code=6))


def test_what_is_no_answer_is_noticed() -> None:
    good = {"outcome": "free", "tolerance": 0.0}
    assert of("answer").is_valid(good)
    for wrong in (
        {"tolerance": 0.0},
        {"outcome": "free"},
        {"outcome": "lost", "tolerance": 0.0},
        {**good, "distance": 1.0},
        {**good, "other": 1},
        {**good, "normal": [1, 0]},
        {"outcome": "contact", "translation": 1.0},
    ):
        assert not of("answer").is_valid(wrong), wrong
