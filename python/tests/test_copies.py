"""Tests that pickled and copied answers keep their bits and their queries."""

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

import colltrans
from colltrans import (
    Cast,
    Contact,
    ConvexPolyhedron,
    Solid,
    SolidBlocked,
    SolidCast,
    SolidFree,
    SolidOverlapping,
    Tracker,
)

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
CLOUD = ConvexPolyhedron(np.random.default_rng(3).normal(size=(40, 3)))


def answers() -> list[Any]:
    found: list[Any] = []
    for start in ([-4, 0.3, 0], [-3, 1, 0], [-3, 5, 0], [4, 0.3, 0], [0.2, 0.3, 0.1]):
        for body in (CUBE, CLOUD):
            query = Cast(body, CUBE, [1, 0.01, 0], moving_pose=start, graze_tolerance=1e-3)
            found += [query.cast(), query.contact_range(), query.clearance()]
            found += [query.directional_depth(), query.intersects(), query]
    bolt, plate = Solid.read(ROOT / "data/bolt.stl"), Solid.read(ROOT / "data/plate.off")
    for height in (7, 0.5, -40):
        solids = SolidCast(
            bolt, plate, [0, 0, -1], moving_pose=[0.1, 0, height, 0, 0, 0.6, 0.8], tolerance=1e-6
        )
        found += [solids, *solids.certified_clearance()]
    return found


def parts(thing: Any) -> Any:
    """Returns all values of an object, with their bits."""
    if type(thing).__module__ != "colltrans":
        return thing.tobytes() if isinstance(thing, np.ndarray) else repr(thing)
    names = [name for name in dir(thing) if not name.startswith("_")]
    # The query of a Cast's parts is the Cast itself; memory use is not part of a value.
    values = ((name, getattr(thing, name)) for name in names if name not in ("query", "nbytes"))
    said = {name: parts(value) for name, value in values if not callable(value)}
    return type(thing).__name__, repr(thing), said


@pytest.mark.parametrize("answer", answers(), ids=lambda a: type(a).__name__)
def test_a_pickled_answer_keeps_its_bits(answer: Any) -> None:
    for again in (
        pickle.loads(pickle.dumps(answer)),
        copy.copy(answer),
        copy.deepcopy(answer),
    ):
        assert type(again) is type(answer)
        assert parts(again) == parts(answer)
    if isinstance(answer, Contact):
        again = pickle.loads(pickle.dumps(answer))
        assert again.certificate.verify() == answer.certificate.verify()
        assert repr(again.steps) == repr(answer.steps)
        assert again.query.to_json() == answer.query.to_json()


def test_the_answers_include_every_class() -> None:
    kinds = {type(answer).__name__ for answer in answers()}
    assert kinds >= {
        "Behind",
        "Blocked",
        "Contact",
        "ContactRange",
        "DirectionalDepth",
        "Intersection",
        "Overlapping",
        "Separated",
        "SolidBlocked",
        "SolidCertificate",
        "SolidOverlapping",
    }
    assert {SolidBlocked, SolidFree, SolidOverlapping} <= {type(a) for a in answers()}


def test_pickled_proofs_features_and_tracker_answers_keep_their_values() -> None:
    tracker, start = Tracker(), np.array([-4, 0.3, 0])
    for step in range(3):
        answer = tracker.cast(CLOUD, CUBE, [1, 0, 0], moving_pose=start + [0, step / 100, 0])
    assert isinstance(answer, Contact) and answer.steps.started_from == "features"
    again = pickle.loads(pickle.dumps(answer))
    assert again.steps.started_from == "features"
    for part in (answer.certificate, answer.features, answer.features.moving, answer.steps):
        assert repr(pickle.loads(pickle.dumps(part))) == repr(part)
    apart = colltrans.cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 9, 0])
    assert isinstance(apart, colltrans.Separated)
    proof = pickle.loads(pickle.dumps(apart.certificate))
    assert proof.verify() == apart.certificate.verify()
    grazing = colltrans.cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 1, 0])
    assert parts(copy.copy(grazing)) == parts(grazing)


def test_invalid_pickled_states_are_refused() -> None:
    again: Any = Contact
    with pytest.raises(TypeError):
        again._of(1, 2)
    with pytest.raises(ValueError):
        again._of(Cast(CUBE, CUBE, [1, 0, 0]), "{}")
