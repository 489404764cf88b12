"""The same bits as the command line's, one by one and in bulk, on any number of threads."""

from typing import Any

import numpy as np
import pytest
from conftest import Batch, Settings, draw

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


def said(contact: Contact) -> dict[str, Any]:
    """What the command line says of a contact."""
    proof, features, steps = contact.certificate, contact.features, contact.steps
    fields: dict[str, Any] = {
        "translation": contact.translation,
        "normal": contact.normal.tolist(),
        "point": contact.point.tolist(),
        "translation_bounds": bounds(proof.lower, proof.upper),
        "rounding": proof.rounding,
        "features": {
            name: {"kind": feature.kind, "vertices": feature.vertices.tolist()}
            for name, feature in (("moving", features.moving), ("fixed", features.fixed))
        },
        "solver": contact.solver,
        "steps": {
            "planar_problems": steps.planar_problems,
            "supports": steps.supports,
            "pivots": steps.pivots,
        },
    }
    return fields


def bounds(lower: float, upper: float) -> list[float | None]:
    return [x if np.isfinite(x) else None for x in (lower, upper)]


def exit_of(last: Contact) -> dict[str, Any]:
    proof = last.certificate
    exits = bounds(0.0 - proof.upper, 0.0 - proof.lower)
    return {"exit": 0.0 - last.translation, "exit_bounds": exits}


def last_of(answer: ContactRange) -> Contact:
    return answer.last.contact if isinstance(answer.last, Grazing) else answer.last


def said_of(answer: Any) -> dict[str, Any]:
    match answer:
        case Separated():
            steps = answer.steps
            return {
                "outcome": "separated",
                "normal": answer.normal.tolist(),
                "margin": answer.margin,
                "solver": answer.solver,
                "steps": {
                    "planar_problems": steps.planar_problems,
                    "supports": steps.supports,
                    "pivots": steps.pivots,
                },
            }
        case ContactRange(first=Contact() as first):
            return {"outcome": "contact", **said(first), **exit_of(last_of(answer))}
        case ContactRange(first=Grazing() as first):
            contact = said(first.contact)
            exits = {**exit_of(last_of(answer)), "overlap": first.overlap}
            return {"outcome": "grazing", **contact, **exits}
        case Blocked(distance=distance, contact=contact):
            return {"outcome": "blocked", "distance": distance, **said(contact)}
        case Slides(grazing=grazing):
            return {"outcome": "slides", **said(grazing.contact), "overlap": grazing.overlap}
        case Behind(contact=last):
            return {"outcome": "behind", **exit_of(last), **said(last)}
        case Overlapping(first=first, last=last):
            back, on = -first.certificate.lower, -last.certificate.lower
            exits = {**exit_of(last), "back": back, "on": on}
            return {"outcome": "overlapping", **said(first), **exits}
    raise AssertionError(answer)


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
def test_the_command_line_says_the_same(batch: Batch, query: str, one: Any, many: Any) -> None:
    lines = batch(SETTINGS.lines(query=query))
    answers = asked(SETTINGS, one)
    columns = asked_at_once(SETTINGS, many, None)
    outcomes = set()
    # Behind, the command line leaves out what belongs to the way back.
    left_out = {"behind": {"translation", "translation_bounds"}}
    for i, (line, answer) in enumerate(zip(lines, answers, strict=True)):
        outcomes.add(line["outcome"])
        del line["id"]
        line.pop("message", None)
        mine = said_of(answer)
        for name in left_out.get(line["outcome"], ()):
            mine.pop(name, None)
        assert mine == line
        assert columns.outcomes[columns.outcome[i]] == line["outcome"]
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


def test_a_cast_is_the_first_end_of_the_range(batch: Batch) -> None:
    columns = asked_at_once(SETTINGS, colltrans.cast_many, 2)
    for i, line in enumerate(batch(SETTINGS.lines())):
        assert columns.outcomes[columns.outcome[i]] == line["outcome"]
        assert np.array_equal(columns.translation[i], line.get("translation", np.nan), True)
        assert columns.normal[i].tolist() == line["normal"]


@pytest.mark.parametrize(
    "many", [colltrans.cast_many, colltrans.contact_range_many, colltrans.clearance_many]
)
def test_threads_make_no_difference(many: Any) -> None:
    settings = draw(seed=21, count=3000)
    one = asked_at_once(settings, many, 1)
    for threads in (2, 3, 8):
        other = asked_at_once(settings, many, threads)
        assert one.outcome.tobytes() == other.outcome.tobytes()
        for (_, mine), (_, its) in zip(one._numbers(), other._numbers(), strict=True):
            assert mine.tobytes() == its.tobytes()


def test_rows_are_the_answers() -> None:
    columns = asked_at_once(SETTINGS, colltrans.clearance_many, None)
    for row, alone in zip(columns, asked(SETTINGS, colltrans.clearance), strict=True):
        assert said_of(row) == said_of(alone)


@pytest.mark.parametrize("solver", ["cta", "portal"])
def test_solvers_are_the_command_lines(batch: Batch, solver: str) -> None:
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
