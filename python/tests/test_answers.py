"""Tests answers: the class of every case, checked proofs, saved queries."""

import pickle
import subprocess
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import draw

import colltrans
from colltrans import (
    Behind,
    Blocked,
    Cast,
    Contact,
    ContactRange,
    ConvexPolyhedron,
    Grazing,
    Overlapping,
    Separated,
    Slides,
    Tracker,
    cast,
    clearance,
    contact_range,
    directional_depth,
    intersects,
)
from colltrans.errors import CaseError, CertificateError, QueryError

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])


def test_outcomes_match_by_field_name_and_by_position() -> None:
    match cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 0.5, 0.25]):
        case Contact(translation, normal, point):
            assert (translation, normal.tolist(), point[0]) == (2.0, [1, 0, 0], 0.0)
        case other:
            raise AssertionError(other)
    match cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 1, 0]):
        case Grazing(overlap, contact):
            assert abs(overlap) < 1e-13 and contact.translation == 2.0
        case other:
            raise AssertionError(other)
    match cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 2, 0]):
        case Separated(margin, normal):
            assert 0.999 < margin <= 1 and normal.tolist() == [0, -1, 0]
        case other:
            raise AssertionError(other)


def test_a_clearance_gives_its_distance_as_a_length() -> None:
    def toward(direction: list[float], z: float = 1.0) -> object:
        return clearance(CUBE, CUBE, direction, moving_pose=[0, 0, z])

    assert isinstance(toward([0, 0, 1]), Behind)
    assert isinstance(toward([1, 0, 0]), Slides)
    match toward([0, 0, -1], z=3):
        case Blocked(distance, Contact(translation=translation)):
            assert distance <= 2 and translation == 2
        case other:
            raise AssertionError(other)
    match toward([0, 0, 1], z=0.25):
        case Overlapping(first, last) as overlap:
            assert (first.translation, last.translation) == (-1.25, 0.75)
            assert overlap.distance is None
        case other:
            raise AssertionError(other)


def test_a_contact_gives_points_features_and_its_pose() -> None:
    contact = cast(CUBE, CUBE, [2, 0, 0], moving_pose=[-3, 0.5, 0])
    assert isinstance(contact, Contact)
    assert contact.translation == 1.0
    moved = contact.point_at_start + contact.translation * np.array([2, 0, 0])
    assert np.allclose(moved, contact.point, atol=1e-13)
    kinds = contact.features.moving.kind, contact.features.fixed.kind
    assert kinds == ("face", "face")
    assert sorted(contact.features.moving.vertices.tolist()) == [1, 3, 5, 7]
    before = contact.pose_before
    assert -1 - 1e-13 < before.translation[0] <= -1
    assert contact.steps.started_from == "scratch"


def test_a_proof_of_another_query_is_refused() -> None:
    contact = cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 0.5, 0])
    assert isinstance(contact, Contact)
    proof = contact.certificate
    assert 0 <= proof.verify() <= proof.rounding
    assert proof.lower <= 2 <= proof.upper and proof.gap == proof.upper - proof.lower
    assert proof.pairs.shape == (3, 2) and abs(proof.weights.sum() - 1) < 1e-15
    nearer = Cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-2, 0.5, 0])
    with pytest.raises(CertificateError, match="proves only"):
        proof.verify(nearer)
    with pytest.raises(CertificateError):
        nearer.verify(proof)
    beside = cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 2, 0])
    assert isinstance(beside, Separated)
    assert beside.certificate.verify() == pytest.approx(beside.margin, abs=1e-13)
    with pytest.raises(CertificateError):
        beside.certificate.verify(nearer)
    with pytest.raises(TypeError):
        nearer.verify("trust me")  # type: ignore[arg-type]


def test_every_answer_of_many_is_proven() -> None:
    settings = draw(seed=6, count=400)
    bodies = settings.bodies()
    for i in range(len(settings)):
        query = Cast(
            bodies[settings.moving[i]],
            bodies[settings.fixed[i]],
            settings.direction[i],
            moving_pose=settings.moving_pose[i],
            fixed_pose=settings.fixed_pose[i],
        )
        match query.contact_range():
            case ContactRange(first=first, last=last):
                for end in (first, last.turned):
                    contact = end.contact if isinstance(end, Grazing) else end
                    if np.isfinite(contact.certificate.upper):
                        assert contact.certificate.verify() <= contact.certificate.rounding
            case Separated() as apart:
                assert query.verify(apart.certificate) > 0


def test_range_depth_and_intersection_have_expected_values() -> None:
    found = contact_range(CUBE, CUBE, [0.5, 0, 0], moving_pose=[-3, 0.5, 0])
    assert isinstance(found, ContactRange) and found.interval == (4.0, 8.0)
    assert found.last.turned.query.direction.tolist() == [-0.5, 0, 0]
    depth = directional_depth(CUBE, CUBE, [1, 0, 0], moving_pose=[-0.75, 0, 0])
    assert abs(depth.depth - 0.25) < 1e-13 and isinstance(depth.clearance, Overlapping)
    assert intersects(CUBE, CUBE, moving_pose=[0.5, 0, 0])
    apart = intersects(CUBE, CUBE, moving_pose=[5, 0, 0])
    assert not apart and apart.meets is False
    assert apart.direction.tolist() == [-1, 0, 0]
    match apart.outcome:
        case Contact(translation=ahead):
            assert ahead > 0
        case other:
            raise AssertionError(other)


def test_a_saved_query_replays_with_the_same_answer(cli: Path, tmp_path: Path) -> None:
    settings = draw(seed=7, count=60)
    bodies = settings.bodies()
    for i in range(len(settings)):
        query = Cast(
            bodies[settings.moving[i]],
            bodies[settings.fixed[i]],
            settings.direction[i],
            moving_pose=settings.moving_pose[i],
            graze_tolerance=1e-9,
            solver="portal",
        )
        again = Cast.from_json(query.to_json())
        assert repr(again.contact_range()) == repr(query.contact_range())
        assert (again.graze_tolerance, again.solver) == (1e-9, "portal")
        assert pickle.loads(pickle.dumps(query)).to_json() == query.to_json()
    file = tmp_path / "query.json"
    query = Cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 0.5, 0])
    file.write_text(query.to_json())
    told = subprocess.run([cli, "replay", file], capture_output=True, text=True, check=True)
    assert told.stdout.startswith("contact\n  translation  2 ")
    with pytest.raises(CaseError):
        Cast.from_json("[]")


def test_a_query_gives_its_arguments() -> None:
    answer = cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 0.5, 0])
    assert isinstance(answer, Contact)
    query = answer.query
    assert query.moving is CUBE and query.fixed is CUBE
    assert query.moving_pose.translation.tolist() == [-3, 0.5, 0]
    assert query.reversed().direction.tolist() == [-1, 0, 0]
    with pytest.raises(AttributeError):
        answer.translation = 1.0  # type: ignore[misc]


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"direction": [0, 0, 0]}, r"the direction \[0.0, 0.0, 0.0\] is zero"),
        ({"direction": [np.inf, 0, 0]}, "not finite"),
        ({"graze_tolerance": -1.0}, "the graze tolerance -1 is negative"),
        ({"graze_tolerance": np.nan}, "graze tolerance"),
        ({"solver": "newton"}, 'unknown solver "newton"; known solvers: auto, cta, portal'),
    ],
)
def test_invalid_queries_are_refused(arguments: dict[str, Any], match: str) -> None:
    all_arguments: dict[str, Any] = {"direction": [1, 0, 0], **arguments}
    for question in (cast, contact_range, clearance, directional_depth, Cast):
        with pytest.raises(QueryError, match=match):
            question(CUBE, CUBE, **all_arguments)
    with pytest.raises(QueryError, match=match):
        Tracker().clearance(CUBE, CUBE, **all_arguments)
    # The bodies at fixed poses have no direction and no solver.
    ask: Any = intersects
    with pytest.raises(TypeError, match="unexpected keyword argument"):
        ask(CUBE, CUBE, **arguments)


def test_arguments_that_are_not_bodies_are_refused() -> None:
    with pytest.raises(TypeError, match="ConvexPolyhedron"):
        cast(CUBE, "cube", [1, 0, 0])  # type: ignore[call-overload]


def test_a_tracker_answers_as_a_cast() -> None:
    settings = draw(seed=8, count=300)
    bodies = settings.bodies()
    tracker = Tracker()
    for i in range(len(settings)):
        pair = bodies[settings.moving[i]], bodies[settings.fixed[i]]
        for step in range(3):
            pose = settings.moving_pose[i] + np.r_[1e-3 * step, np.zeros(6)]
            arguments = (*pair, settings.direction[i])
            known = clearance(*arguments, moving_pose=pose)
            found = tracker.clearance(*arguments, moving_pose=pose)
            assert type(found) is type(known)
            if known.distance is not None and np.isfinite(known.distance):
                assert found.distance == pytest.approx(known.distance, abs=1e-9)
            if step and isinstance(found, Blocked) and len(pair[0].vertices) > 3:
                assert tracker.steps.supports <= 40
    tracker.reset()
    tracker.cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 0, 0])
    assert tracker.steps.started_from == "scratch"


def test_a_tracker_keeps_its_bodies_alive() -> None:
    tracker = Tracker()
    for seed in range(50):
        random = np.random.default_rng(seed)
        cloud = random.normal(size=(20, 3))
        bodies = ConvexPolyhedron(cloud), ConvexPolyhedron(-cloud)
        found = tracker.cast(*bodies, [0, 0, -1], moving_pose=[0, 0, 9])
        del bodies
        assert isinstance(found, Contact) and found.certificate.verify() >= 0


def test_answers_can_be_used_on_other_threads() -> None:
    found: list[object] = []

    def ask() -> None:
        found.extend(repr(colltrans.cast(CUBE, CUBE, [1, 0, 0])) for _ in range(200))

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 800 and len(set(found)) == 1
