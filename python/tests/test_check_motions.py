"""Tests the checker in fractions on saved and forged proofs of turning motions.

Like ``test_check`` it needs neither the extension nor the shared helpers.
"""

import json
import math
import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from test_check import MOTION, always, changed, check, proof, refused, value_at, without_field

#: The fields of the moving and the fixed body.
MOVERS = ("placement", "motions", 0)
KEEP = ("query", "motions", 0, "min_gap")

ALL = ["contact", "free", "kept", "through", "alone", "sinking"]


@pytest.mark.parametrize(
    ("name", "holds"),
    [
        ("contact", ["never meet up to the time 0.28739254482", "meet at the time 0.28739254482"]),
        ("free", ["the bodies never meet throughout the motion"]),
        (
            "kept",
            ["never are as near as 0.25 up to", "are as near as 0.25 at the time 0.4911185688"],
        ),
        ("through", ["the bodies never meet throughout the motion"]),
        ("alone", ["the bodies never meet throughout the motion"]),
        ("sinking", ["never overlap by more than 0.001 up to", "by more than 0.001 at the time"]),
    ],
)
def test_a_valid_proof_is_accepted(name: str, holds: list[str]) -> None:
    report = check.check(json.dumps(proof(f"motion_{name}")))
    assert len(report.holds) == len(holds) and not report.partly
    assert all(words in line for words, line in zip(holds, report.holds, strict=True))


@pytest.mark.parametrize("name", ALL)
def test_a_plane_that_claims_too_much_is_refused(name: str) -> None:
    file = proof(f"motion_{name}")
    for s, planes in enumerate(value_at(file, MOTION)["spans"]):
        for k in range(len(planes)):
            way = (*MOTION, "spans", s, k)
            assert refused(changed(file, (*way, "gap"), lambda x: x + 1e-12 * (1 + abs(x))))
            assert refused(changed(file, (*way, "gap"), lambda x: -x))
            assert refused(changed(file, (*way, "normal"), lambda n: [-x for x in n]))
            assert refused(changed(file, (*way, "normal"), lambda n: [2 * x for x in n]))
            if planes[k]["time"] > 0:
                assert refused(changed(file, (*way, "time"), lambda x: -x))


@pytest.mark.parametrize("name", ALL)
def test_dropping_a_needed_plane_is_refused(name: str) -> None:
    file = proof(f"motion_{name}")
    for s, planes in enumerate(value_at(file, MOTION)["spans"]):
        # The first plane defines the start of the span; without all but the last it is unproven.
        without = json.loads(json.dumps(file))
        value_at(without, MOTION)["spans"][s] = planes[1:]
        assert planes[1]["time"] == planes[0]["time"] or refused(without)
        value_at(without, MOTION)["spans"][s] = [{**planes[0], "alone": False}, planes[-1]]
        assert name in {"sinking", "through"} or refused(without)
    if len(value_at(file, MOTION)["spans"]) > 1:
        del value_at(file, MOTION)["spans"][0]
        assert refused(file)


def test_a_single_plane_needs_the_arcs() -> None:
    file = proof("motion_alone")
    way = (*MOTION, "spans", 0, 0, "alone")
    assert refused(changed(file, way, lambda alone: not alone))
    assert refused(changed(file, way, lambda alone: 1))
    # No plane of the contact is enough alone.
    file = proof("motion_contact")
    for k in range(len(value_at(file, MOTION)["spans"][0]) - 1):
        assert refused(changed(file, (*MOTION, "spans", 0, k, "alone"), lambda alone: True))


@pytest.mark.parametrize("name", ["contact", "kept", "sinking"])
def test_a_changed_contact_time_is_refused(name: str) -> None:
    file = proof(f"motion_{name}")
    time = value_at(file, MOTION)["meeting"]["time"]
    reached = value_at(file, MOTION)["spans"][-1][-1]["time"]
    assert refused(changed(file, (*MOTION, "meeting", "time"), lambda t: 0.5 * t))
    # Just after the last plane they do not meet yet.
    assert refused(changed(file, (*MOTION, "meeting", "time"), lambda t: reached))
    assert refused(changed(file, (*MOTION, "meeting", "time"), lambda t: 1.5))
    assert refused(changed(file, (*MOTION, "spans", -1, -1, "time"), lambda t: time + 1e-6))
    kind = next(iter(value_at(file, MOTION)["meeting"]["met"]))
    if kind == "near":
        way: tuple[Any, ...] = (*MOTION, "meeting", "met", "near", "pairs", 0, "moving")
    else:
        way = (*MOTION, "meeting", "met", "deep", "enclosure", "triangles", 0, 0)
    assert refused(changed(file, way, lambda k: k + 1))
    other = {"near": "deep", "deep": "near"}[kind]
    met = value_at(file, MOTION)["meeting"]["met"]
    assert refused(changed(file, (*MOTION, "meeting", "met"), lambda _: {other: met[kind]}))


@pytest.mark.parametrize(
    ("part", "by"),
    [
        (("rate",), lambda x: 1.02 * x + 1e-3),
        (("arm", 1), lambda x: x + 0.05),
        (("arm", 0), lambda x: x + 0.05),
        (("axis",), lambda axis: [-x for x in axis]),
        (("axis",), lambda axis: [2 * x for x in axis]),
        (("velocity", 1), lambda x: x + 0.05),
        (("start", "translation", 0), lambda x: x + 0.05),
        (("start", "translation", 1), lambda x: x - 0.05),
        (("since",), lambda x: x + 0.25),
        (("rate",), lambda x: 1e6),
    ],
)
def test_changing_any_number_of_a_motion_is_refused(
    part: tuple[Any, ...], by: Callable[[Any], Any]
) -> None:
    file = proof("motion_contact")
    assert refused(changed(file, (*MOVERS, 0, "motion", 0, *part), by))


def test_other_bodies_are_refused() -> None:
    file = proof("motion_contact")
    for side in range(2):
        for factor in (0.99, 1.01):
            larger = json.loads(json.dumps(file))
            body = larger["bodies"][side]["convex"]
            body["vertices"] = [[factor * x for x in v] for v in body["vertices"]]
            assert refused(larger)
    assert refused(changed(file, ("bodies",), lambda bodies: bodies[::-1]))
    for min_gap in (0.01, -0.01, "0", None):
        assert refused(changed(file, KEEP, always(min_gap)))
    assert refused(changed(file, (*KEEP[:-1], "tolerance"), always(0.0)))
    assert refused(changed(proof("motion_kept"), KEEP, always(0.26)))
    assert refused(changed(proof("motion_sinking"), KEEP, always(-0.0009)))
    two = (*MOVERS, 0, "motion")
    assert refused(changed(proof("motion_free"), two, lambda of: [*of, {**of[0], "since": 0.5}]))


def test_files_without_a_proof_are_refused() -> None:
    file = proof("motion_contact")
    for name in file:
        assert refused({k: v for k, v in file.items() if k != name})
    assert refused(changed(file, (*MOVERS, 0, "motion"), always([])))
    assert refused(changed(file, MOVERS, lambda pair: pair[:1]))
    assert refused(changed(file, (*MOVERS, 0, "body"), always(2)))
    for name in ("placement", "query", "statement"):
        assert refused(changed(file, (name, "motions"), lambda all_: [*all_, all_[0]]))
    # A statement without claims holds.
    nothing = changed(file, MOTION, always({"spans": [], "meeting": None}))
    assert check.check(json.dumps(nothing)).holds == []


def test_a_piece_that_begins_when_the_motion_ends_is_refused() -> None:
    # It would change the pose at the time 1, for which there is no plane.
    way = (*MOVERS, 0, "motion")
    assert refused(changed(proof("motion_free"), way, lambda of: [*of, {**of[-1], "since": 1.0}]))


def test_depths_and_distances_may_differ_only_by_rounding() -> None:
    for name in ("contact", "sinking"):
        file = proof(f"motion_{name}")
        way: tuple[Any, ...] = (*MOTION, "meeting", "met", "deep")
        assert check.check(json.dumps(file)).unchecked == []
        for field, by in (
            ("lower", lambda x: x + 1e-9),
            ("lower", lambda x: -1e-9),
            ("upper", lambda x: x - 1e-9),
            ("direction", lambda d: [1.01 * x for x in d]),
        ):
            assert refused(changed(file, (*way, field), by)), (name, field)
    file = proof("motion_kept")
    way = (*MOTION, "meeting", "met", "near")
    assert refused(changed(file, (*way, "distance"), lambda x: x - 1e-9))
    assert refused(changed(file, (*way, "distance"), lambda x: -x))
    assert refused(changed(file, (*way, "pairs"), lambda pairs: pairs[:3]))


def test_missing_or_unknown_fields_are_refused() -> None:
    file = proof("motion_contact")
    met: tuple[Any, ...] = (*MOTION, "meeting", "met", "deep")
    for under in ((), MOTION, (*MOTION, "spans", 0, 0), (*MOTION, "meeting"), met):
        at = file
        for key in under:
            at = at[key]
        more = changed({"of": file}, ("of", *under), lambda of: {**of, "more": 0})["of"]
        assert refused(more)
        for name in set(at) - {"steps"}:
            rest = changed({"of": file}, ("of", *under), without_field(name))["of"]
            assert refused(rest), name


def several(files: list[Any]) -> Any:
    """Returns the pairs of several files as one file."""
    bodies: list[Any] = []
    joined: dict[str, list[Any]] = {"placement": [], "query": [], "statement": []}
    for file in files:
        for pair in file["placement"]["motions"]:
            moved = [{**of, "body": of["body"] + len(bodies)} for of in pair]
            joined["placement"].append(moved)
        joined["query"] += file["query"]["motions"]
        joined["statement"] += file["statement"]["motions"]
        bodies += file["bodies"]
    parts = {name: {"motions": of} for name, of in joined.items()}
    return {"format": "colltrans proof", "version": 2, "bodies": bodies, **parts}


def test_several_pairs_share_one_question() -> None:
    files = [proof("motion_contact"), proof("motion_free")]
    assert len(check.check(json.dumps(several(files))).holds) == 3
    # A pair without planes needs the proof of solids.
    assert refused(several([*files, proof("solids_contact")]))
    whole = proof("solids_whole")
    solids = several([*files, whole])
    found = check.check(json.dumps(solids))
    alone = check.check(json.dumps(whole))
    assert found.holds[3:] == [f"pair 2: {line}" for line in alone.holds]
    assert found.unchecked == [f"pair 2: {line}" for line in alone.unchecked]
    entry: tuple[Any, ...] = ("statement", "motions", 2, "solids", "proof", "meeting", "time")
    assert refused(changed(solids, entry, lambda time: time / 2))
    path = proof("path_free")["statement"]
    assert refused({**several(files), "statement": {"motions": [path, path]}})
    assert refused(several([]))
    # A statement about all pairs would combine two gaps.
    assert refused(several([*files, proof("motion_kept")]))


def test_sine_and_cosine_are_enclosed() -> None:
    drawn = random.Random(5)
    for scale in (1e-9, 0.8, 6.0, 1e5):
        for _ in range(50):
            angle = Fraction(drawn.uniform(-scale, scale))
            sin, cos = check.sine_cosine(angle)
            assert abs(sin * sin + cos * cos - 1) < check._TINY
            assert math.isclose(float(sin), math.sin(angle), rel_tol=1e-15, abs_tol=1e-18)
            assert math.isclose(float(cos), math.cos(angle), rel_tol=1e-15, abs_tol=1e-18)
            half = check.sine_cosine(angle / 2)
            assert abs(sin - 2 * half[0] * half[1]) < check._TINY


def test_a_root_is_an_upper_bound() -> None:
    for x in (Fraction(0), Fraction(2), Fraction(1, 3), Fraction(10) ** 40, Fraction(7, 10**60)):
        root = check.root_above(x)
        assert x <= root * root <= x * (1 + check._TINY)


def test_between_two_planes_the_chord_bound_is_exact() -> None:
    drawn = random.Random(7)
    seen = set()
    for _ in range(2_000):
        a, b = (Fraction(drawn.uniform(0.0, 1.0)) for _ in range(2))
        c = Fraction(drawn.uniform(-1.0, 8.0))
        parts = [Fraction(k, 400) for k in range(401)]
        least = min((1 - x) * a + x * b - c * x * (1 - x) / 2 for x in parts)
        stays = check.stays(a, b, c)
        # Samples exceed the least value by at most the curvature between two samples.
        assert not (stays and least <= 0) and (stays or least < abs(c) / 2 / 400**2)
        seen.add(stays)
    assert seen == {True, False}
