"""What the command line writes is what ``docs/answers.schema.json`` says."""

import json
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT, Batch, draw

Draft202012Validator = pytest.importorskip("jsonschema").Draft202012Validator
SCHEMA = json.loads((ROOT / "docs" / "answers.schema.json").read_text())
DATA = ROOT / "data"
ANSWERS = {"contact", "grazing", "separated", "blocked", "slides", "behind", "overlapping", "error"}


def of(name: str) -> Any:
    return Draft202012Validator({**SCHEMA, "anyOf": [{"$ref": f"#/$defs/{name}"}]})


def conform(name: str, value: Any) -> None:
    """Says what is wrong of the part itself, not only that none of all fits."""
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


def test_a_proof_that_does_not_hold(cli: Path, tmp_path: Path) -> None:
    proof = tmp_path / "proof.json"
    ask(cli, ["cast", *CAST, "-5,0.2,0.3", "--save-proof", str(proof)])
    file = json.loads(proof.read_text())
    file["direction"] = [-x for x in file["direction"]]
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
