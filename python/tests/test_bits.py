"""Tests that answers have the bits of the command line, in bulk too, with any number of threads."""

from typing import Any

import numpy as np
import pytest
from conftest import Batch, Settings, draw
from test_schema import conform

import colltrans
from colltrans import (
    Behind,
    Blocked,
    Contact,
    ContactRange,
    Grazing,
    Overlapping,
    Separated,
    Slides,
)

SETTINGS = draw(seed=20, count=1200)


def plain(line: dict[str, Any]) -> dict[str, Any]:
    """Returns the record of the command line without ids and texts."""
    return {name: value for name, value in line.items() if name not in ("id", "message")}


def bounds(lower: float, upper: float) -> list[float | None]:
    return [x if np.isfinite(x) else None for x in (lower, upper)]


def ends(answer: Any) -> tuple[Contact | None, Contact | None]:
    """Returns the first and the last contact of an answer."""
    match answer:
        case Blocked(contact=first):
            return first, None
        case Slides(grazing=grazing):
            return grazing.contact, None
        case Behind(contact=last):
            return None, last
        case Overlapping(first=first, last=last) | ContactRange(first=first, last=last):
            ends = (first, last.turned)
            both = [end.contact if isinstance(end, Grazing) else end for end in ends]
            return both[0], both[1]
    return None, None


def says_the_same(answer: Any, told: dict[str, Any]) -> None:
    """Checks that the attributes equal the entries of ``to_dict``."""
    first, last = ends(answer)
    if first is not None:
        proof = first.certificate
        assert told["translation"] == first.translation
        assert told["translation_bounds"] == bounds(proof.lower, proof.upper)
    if last is not None:
        proof = last.certificate
        assert told["exit"] == 0.0 - last.translation
        assert told["exit_bounds"] == bounds(0.0 - proof.upper, 0.0 - proof.lower)
    if (contact := first or last) is not None:
        assert told["point"] == contact.point.tolist()
        assert told["rounding"] == contact.certificate.rounding
        for name, feature in told["features"].items():
            mine = getattr(contact.features, name)
            assert feature == {"kind": mine.kind, "vertices": mine.vertices.tolist()}
    if isinstance(answer, Separated):
        assert told["margin"] == answer.margin
    if isinstance(answer, Overlapping):
        assert told["back"] == -answer.first.certificate.lower
    if isinstance(answer, Blocked):
        assert told["distance"] == answer.distance
    if isinstance(answer, Slides):
        assert told["overlap"] == answer.grazing.overlap
    known = answer if isinstance(answer, Separated) else contact
    assert known is not None
    assert told["normal"] == known.normal.tolist() and told["solver"] == known.solver
    for name in ("planar_problems", "supports", "pivots", "iterations"):
        assert told["steps"][name] == getattr(known.steps, name)


def asked(settings: Settings, question: Any) -> list[Any]:
    bodies = settings.bodies()
    return [
        question(
            bodies[settings.moving[i]],
            bodies[settings.fixed[i]],
            settings.direction[i],
            moving_pose=settings.moving_pose[i],
            fixed_pose=settings.fixed_pose[i],
        )
        for i in range(len(settings))
    ]


def asked_at_once(settings: Settings, question: Any, threads: int | None) -> Any:
    bodies = settings.bodies()
    return question(
        bodies,
        bodies,
        settings.direction,
        moving_index=settings.moving,
        fixed_index=settings.fixed,
        moving_pose=settings.moving_pose,
        fixed_pose=settings.fixed_pose,
        threads=threads,
    )


QUESTIONS = [
    ("contact", colltrans.contact_range, colltrans.contact_range_many),
    ("clearance", colltrans.clearance, colltrans.clearance_many),
]


@pytest.mark.parametrize(("query", "one", "many"), QUESTIONS)
def test_answers_have_the_bits_of_the_command_line(
    batch: Batch, query: str, one: Any, many: Any
) -> None:
    lines = batch(SETTINGS.lines(query=query))
    answers = asked(SETTINGS, one)
    columns = asked_at_once(SETTINGS, many, None)
    outcomes = set()
    for i, (line, answer) in enumerate(zip(lines, answers, strict=True)):
        outcomes.add(line["outcome"])
        assert answer.to_dict() == plain(line)
        conform("answer", answer.to_dict())
        says_the_same(answer, line)
        assert columns.outcome[i] == line["outcome"]
        for name, column in columns._numbers():
            known = line.get(name, np.nan)
            for k, end in enumerate(("_lower", "_upper")):
                if name.endswith(end) and f"{name.removesuffix(end)}_bounds" in line:
                    known = line[f"{name.removesuffix(end)}_bounds"][k]
                    known = (-np.inf, np.inf)[k] if known is None else known
            if name == "distance":
                known = np.nan if answer.distance is None else answer.distance
            assert np.array_equal(column[i], np.broadcast_to(known, column[i].shape), True), name
    assert len(outcomes) == {"contact": 3, "clearance": 5}[query], "all outcomes occur"


def test_a_cast_equals_the_first_end_of_the_range(batch: Batch) -> None:
    columns = asked_at_once(SETTINGS, colltrans.cast_many, 2)
    for i, line in enumerate(batch(SETTINGS.lines())):
        assert columns.outcome[i] == line["outcome"]
        assert np.array_equal(columns.translation[i], line.get("translation", np.nan), True)
        assert columns.normal[i].tolist() == line["normal"]


@pytest.mark.parametrize(
    "many", [colltrans.cast_many, colltrans.contact_range_many, colltrans.clearance_many]
)
def test_the_number_of_threads_does_not_change_answers(many: Any) -> None:
    settings = draw(seed=21, count=3000)
    one = asked_at_once(settings, many, 1)
    for threads in (2, 3, 8):
        other = asked_at_once(settings, many, threads)
        assert one.outcome.codes.tobytes() == other.outcome.codes.tobytes()
        for (_, mine), (_, its) in zip(one._numbers(), other._numbers(), strict=True):
            assert mine.tobytes() == its.tobytes()


def test_rows_equal_single_answers() -> None:
    columns = asked_at_once(SETTINGS, colltrans.clearance_many, None)
    for row, alone in zip(columns.answers(), asked(SETTINGS, colltrans.clearance), strict=True):
        assert row.to_dict() == alone.to_dict()


@pytest.mark.parametrize("solver", ["cta", "portal"])
def test_solvers_have_the_bits_of_the_command_line(batch: Batch, solver: str) -> None:
    settings = draw(seed=22, count=100)
    bodies = settings.bodies()
    columns = colltrans.contact_range_many(
        [bodies[k] for k in settings.moving],
        [bodies[k] for k in settings.fixed],
        settings.direction,
        moving_pose=settings.moving_pose,
        fixed_pose=settings.fixed_pose,
        solver=solver,  # type: ignore[arg-type]
    )
    for i, line in enumerate(batch(settings.lines(solver=solver))):
        assert np.array_equal(columns.exit[i], line.get("exit", np.nan), True)
