"""Tests the checker in fractions on saved and forged proofs of joint paths."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_check import PATH, always, changed, check, proof, refused, value_at, without_field
from test_schema import conform

from colltrans import Robot, Solid

ALL = ["contact", "free", "kept", "solid"]
STATEMENT = ("statement", "path")
QUERY = ("query", "path")
JOINTS = (*QUERY, "path")
ROBOT = ("placement", "robot")
LINKS = (*ROBOT, "bodies")


@pytest.mark.parametrize(
    ("name", "holds"),
    [
        (
            "contact",
            [
                "of 6 pairs of bodies none meet up to the time 0.60356132767",
                "'tool' and 'wire' meet by the time",
            ],
        ),
        ("free", ["of 3 pairs of bodies none meet up to the time 2.0"]),
        (
            "kept",
            [
                "of 6 pairs of bodies none are as near as 0.01 up to",
                "are as near as 0.01 by the time",
            ],
        ),
        (
            "solid",
            [
                "of 6 pairs of bodies none meet up to the time 0.5581803",
                "'tool' and 'frame' meet by the time",
            ],
        ),
    ],
)
def test_a_valid_proof_is_accepted(name: str, holds: list[str]) -> None:
    report = check.check(json.dumps(proof(f"path_{name}")))
    assert len(report.holds) == len(holds) and not report.partly
    assert all(words in line for words, line in zip(holds, report.holds, strict=True))


#: The planes between boxes belong to slightly larger boxes. Each is a check, so some are enough.
SPARE = {"solid": 1e-7}
STRIDE = {"solid": 25}


def planes(file: Any) -> list[tuple[Any, ...]]:
    """Returns the paths of all planes."""

    def within(cover: Any, way: tuple[Any, ...]) -> Iterator[tuple[Any, ...]]:
        for s, step in enumerate(cover["steps"]):
            for t, stretch in enumerate(step.get("planes", [])):
                for k in range(len(stretch["planes"])):
                    yield (*way, "steps", s, "planes", t, "planes", k)
            for c, part in enumerate(step.get("parts", {}).get("covers", [])):
                yield from within(part, (*way, "steps", s, "parts", "covers", c))

    covers = enumerate(value_at(file, PATH)["covers"])
    return [way for c, cover in covers for way in within(cover, (*PATH, "covers", c))]


@pytest.mark.parametrize("name", ALL)
def test_a_plane_that_claims_too_much_is_refused(name: str) -> None:
    file = proof(f"path_{name}")
    for way in planes(file)[:: STRIDE.get(name, 7)]:
        assert refused(changed(file, (*way, "gap"), lambda x: x + SPARE.get(name, 1e-12)))
        assert refused(changed(file, (*way, "gap"), lambda x: -x))
        assert refused(changed(file, (*way, "normal"), lambda n: [-x for x in n]))
        assert refused(changed(file, (*way, "normal"), lambda n: [2 * x for x in n]))
        assert refused(changed(file, (*way, "alone"), lambda alone: not alone))


@pytest.mark.parametrize("name", ALL)
def test_dropping_a_needed_plane_is_refused(name: str) -> None:
    file = proof(f"path_{name}")
    dropped, all_ = 0, planes(file)[:: STRIDE.get(name, 3) // 3]
    for way in all_:
        without = json.loads(json.dumps(file))
        at = without
        for key in way[:-1]:
            at = at[key]
        del at[way[-1]]
        dropped += refused(without)
    assert dropped > len(all_) // 2
    without = json.loads(json.dumps(file))
    del value_at(without, PATH)["covers"][0]
    assert refused(without)
    value_at(without, STATEMENT)["pairs"].pop(0)
    assert name != "free" or not refused(without)


def test_a_changed_contact_time_is_refused() -> None:
    for name in ("contact", "kept"):
        file = proof(f"path_{name}")
        way: tuple[Any, ...] = (*PATH, "meeting", "place", "share")
        assert refused(changed(file, way, lambda t: 0.5 * t))
        assert refused(changed(file, way, lambda t: 1.5))
        assert refused(changed(file, (*STATEMENT, "upper"), lambda t: t - 1e-9))
        assert refused(changed(file, (*STATEMENT, "lower"), lambda t: t + 1e-9))
        assert refused(changed(file, (*PATH, "meeting", "pair"), lambda k: k - 1))
        assert refused(changed(file, (*PATH, "meeting"), lambda of: None))


def test_a_later_time_is_a_bound_and_none_is_no_claim() -> None:
    file = proof("path_contact")
    of = value_at(file, STATEMENT)
    for upper, told in ((of["upper"] + 1.0, "by the time"), (None, "on the path")):
        report = check.check(json.dumps({**file, "statement": {"path": {**of, "upper": upper}}}))
        meeting = report.holds[-1]
        assert f"meet {told}" in meeting


def test_omitted_pairs_are_named() -> None:
    file = proof("path_free")
    first, *others = value_at(file, STATEMENT)["pairs"]
    value_at(file, STATEMENT)["pairs"] = others
    del value_at(file, PATH)["covers"][0]
    report = check.check(json.dumps(file))
    a, b = map(repr, first)
    assert any(f"{a} and {b}" in line or f"{b} and {a}" in line for line in report.unchecked)
    (line,) = report.holds
    assert f"{a} and {b}" not in line and all(f"{c!r} and {d!r}" in line for c, d in others)


def test_the_pairs_of_a_statement_are_those_of_the_covers() -> None:
    file = proof("path_free")
    pairs: tuple[Any, ...] = (*STATEMENT, "pairs")
    assert refused(changed(file, pairs, lambda all_: all_[1:]))
    assert refused(changed(file, pairs, lambda all_: [*all_, all_[0]]))
    assert refused(changed(file, (*pairs, 0), lambda pair: [pair[0], pair[0]]))
    assert refused(changed(file, (*pairs, 0, 1), lambda name: name + " of another robot"))
    # Names identify the bodies; two equal names identify none.
    name = value_at(file, (*LINKS, 0, "name"))
    assert refused(changed(file, (*LINKS, 1, "name"), lambda _: name))
    assert refused(changed(file, (*LINKS, 1, "name"), lambda _: ""))


@pytest.mark.parametrize(
    ("part", "by"),
    [
        ((*JOINTS, "rows", 0, 0), lambda x: x + 0.01),
        ((*JOINTS, "rows", 1, 1), lambda x: x - 0.01),
        ((*JOINTS, "times", 1), lambda x: -x),
        ((*ROBOT, "frames", 0, "joint", "turning"), lambda axis: [-x for x in axis]),
        ((*ROBOT, "frames", 1, "joint", "turning"), lambda axis: [2 * x for x in axis]),
        ((*ROBOT, "frames", 1, "origin", "translation", 0), lambda x: x + 0.01),
        ((*ROBOT, "frames", 1, "parent"), lambda k: 1),
        ((*LINKS, -1, "pose", "translation", 0), lambda x: x + 0.01),
        ((*LINKS, -1, "frame"), lambda k: 0),
        ((*QUERY, "min_gap"), lambda x: -1.0),
    ],
)
def test_changing_any_number_of_a_path_is_refused(
    part: tuple[Any, ...], by: Callable[[Any], Any]
) -> None:
    file = proof("path_contact")
    assert refused(changed(file, part, by))


def test_omitting_parts_of_a_solid_is_refused() -> None:
    file = proof("path_solid")
    (at,) = (k for k, body in enumerate(file["bodies"]) if "pieces" in body)
    way: tuple[Any, ...] = (*STATEMENT, "parts", at)
    assert refused(changed(file, (*way, "numbers", 0), lambda k: k + 1))
    assert refused(changed(file, (*way, "numbers"), lambda all_: all_[1:]))
    assert refused(changed(file, (*way, "tree"), lambda tree: tree[:-1]))
    assert refused(changed(file, (*way, "tree", -1), lambda k: k + 1))
    steps = [
        (c, s)
        for c, cover in enumerate(value_at(file, PATH)["covers"])
        for s, step in enumerate(cover["steps"])
        if "parts" in step
    ]
    assert steps
    for c, s in steps:
        parts: tuple[Any, ...] = (*PATH, "covers", c, "steps", s, "parts")
        assert refused(changed(file, (*parts, "covers"), lambda all_: all_[1:]))
        assert refused(changed(file, (*parts, "covers"), lambda all_: all_[::-1]))
        assert refused(changed(file, (*parts, "which"), lambda k: 1 - k))
    met: tuple[Any, ...] = (*PATH, "meeting", "how", "pieces", "pieces")
    assert refused(changed(file, (*met, 1), lambda k: k - 7))
    assert refused(changed(file, (*met, 1), lambda k: 0))
    assert refused(changed(file, way, always(None)))
    assert refused(changed(file, way[:-1], lambda all_: all_[:-1]))
    assert refused(changed(file, (*way[:-1], 1 - at), always(value_at(file, way))))


def test_places_beyond_the_way_to_the_next_row_are_refused() -> None:
    file = proof("path_solid")
    steps = [
        (*PATH, "covers", c, "steps", s, "parts", "until", "share")
        for c, cover in enumerate(value_at(file, PATH)["covers"])
        for s, step in enumerate(cover["steps"])
        if "parts" in step
    ]
    assert steps
    for way in steps:
        # Seven times the way would be the time of a row that has no plane.
        for share in (7.0, -1.0):
            assert refused(changed(file, way, always(share)))


def test_a_path_of_one_row_is_free_by_planes_alone() -> None:
    file = proof("path_free")
    one = json.loads(json.dumps(file))
    value_at(one, JOINTS)["times"] = [2.0]
    del value_at(one, JOINTS)["rows"][1:]
    for cover in value_at(one, PATH)["covers"]:
        (step,) = cover["steps"]
        (first, *_) = step["planes"]
        step["planes"] = [{**first, "planes": first["planes"][:1]}]
    (line,) = check.check(json.dumps(one)).holds
    assert "of 3 pairs of bodies none meet up to the time 2.0" in line
    value_at(one, PATH)["covers"][1]["steps"] = []
    assert check.check(json.dumps(one)).holds == []


def test_planes_leave_what_the_hulls_leave_out() -> None:
    file = proof("path_free")
    names = {name for pair in value_at(file, STATEMENT)["pairs"] for name in pair}
    named = [of["body"] for of in value_at(file, LINKS) if of["name"] in names]
    for k in named:
        file["bodies"][k]["convex"]["hull_error"] = 1e-15
    assert not refused(file)
    file["bodies"][named[-1]]["convex"]["hull_error"] = 10.0
    assert refused(file)


def test_values_of_a_wrong_type_are_refused() -> None:
    file = proof("path_contact")
    pairs = value_at(file, (*STATEMENT, "pairs"))
    name = value_at(file, LINKS)[0]["name"]
    half = changed(file, (*LINKS, 0, "name"), always(name + "\ud800"))
    solid = proof("path_solid")
    parts = value_at(solid, (*STATEMENT, "parts"))
    body = next(k for k, part in enumerate(parts) if part is not None)
    tree = [float(k) for k in parts[body]["tree"]]
    for other, message in (
        (changed(file, (*STATEMENT, "pairs"), always(dict(pairs))), "is not a list"),
        (changed(file, (*STATEMENT, "pairs", 0), always("ab")), "is not a list of 2"),
        (half, "is not a name"),
        (changed(solid, (*STATEMENT, "parts", body, "tree"), always(tree)), "is not an index"),
    ):
        with pytest.raises(check.NoProofError, match=message):
            check.check(json.dumps(other))


def test_missing_or_unknown_fields_are_refused() -> None:
    file = proof("path_contact")
    for under in ((), PATH, STATEMENT, (*PATH, "meeting"), (*LINKS, 0)):
        assert refused(changed({"of": file}, ("of", *under), lambda of: {**of, "more": 0})["of"])
        at = file
        for key in under:
            at = at[key]
        for name in at:
            rest = changed({"of": file}, ("of", *under), without_field(name))["of"]
            assert refused(rest), name


def test_a_body_inside_another_at_the_start_is_found() -> None:
    file = proof("path_inside")
    (line,) = check.check(json.dumps(file)).holds
    assert "'upper' and 'room' meet by the time 0.0" in line
    (at,) = (k for k, body in enumerate(file["bodies"]) if "pieces" in body)
    (link,) = (k for k, of in enumerate(value_at(file, LINKS)) if of["body"] == at)
    way: tuple[Any, ...] = (*LINKS, link, "pose", "translation", 0)
    assert refused(changed(file, way, lambda x: x + 20.0))
    later: tuple[Any, ...] = (*PATH, "meeting", "place", "share")
    assert refused(changed(file, later, lambda t: 0.5))


def test_a_solid_inside_a_convex_body_is_found() -> None:
    here = {"matrix": [1, 0, 0, 0, 1, 0, 0, 0, 1], "translation": [0, 0, 0]}
    corners = [[x, y, z] for x in (-5.0, 5.0) for y in (-5.0, 5.0) for z in (-5.0, 5.0)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    block = {
        "vertices": corners,
        "faces": faces,
        "input_indices": list(range(8)),
        "hull_error": 0.0,
    }
    small = {
        "vertices": [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        "triangles": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    }
    parts = {"numbers": [0, 1, 2, 3], "tree": [4]}
    slide = {"parent": None, "origin": here, "joint": {"sliding": [1.0, 0.0, 0.0]}}
    links = [
        {"body": 0, "name": "small", "frame": 0, "pose": here},
        {"body": 1, "name": "block", "frame": None, "pose": here},
    ]
    meeting = {"pair": 0, "place": {"row": 0, "share": 0.0}, "how": "inside"}
    statement = {
        "pairs": [["small", "block"]],
        "lower": 0.0,
        "upper": 0.0,
        "parts": [parts, None],
        "proof": {"covers": [{"steps": []}], "meeting": meeting},
    }
    file = {
        "format": "colltrans proof",
        "version": 2,
        "bodies": [{"pieces": [small]}, {"convex": block}],
        "placement": {"robot": {"frames": [slide], "bodies": links}},
        "query": {"path": {"path": {"times": [0.0, 1.0], "rows": [[0.0], [1.0]]}}},
        "statement": {"path": statement},
    }
    (line,) = check.check(json.dumps(file)).holds
    assert line == "'small' and 'block' meet by the time 0.0"
    beside: tuple[Any, ...] = (*LINKS, 1, "pose", "translation", 0)
    # One corner of the small body is still inside, and then none.
    assert not refused(changed(file, beside, lambda x: x + 5.5))
    assert refused(changed(file, beside, lambda x: x + 6.5))


def test_solids_that_meet_face_to_face_do_by_a_point_inside_both(tmp_path: Path) -> None:
    outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
    n = len(outline)
    sides = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
    faces = [list(range(n))[::-1], list(range(n, 2 * n)), *sides]

    def upright(low: float, high: float) -> list[list[float]]:
        return [[x, y, z] for z in (low, high) for x, y in outline]

    lines = [f"v {x} {y} {z}" for x, y, z in upright(0, 0.25)]
    lines += ["f " + " ".join(str(k + 1) for k in face) for face in faces]
    (tmp_path / "plate.obj").write_text("\n".join(lines) + "\n")
    (tmp_path / "lift.urdf").write_text(
        '<robot name="lift"><link name="base"/><link name="plate"><collision><geometry>'
        '<mesh filename="plate.obj"/></geometry></collision></link>'
        '<joint name="down" type="prismatic"><parent link="base"/><child link="plate"/>'
        '<origin xyz="0 0 1"/><axis xyz="0 0 -1"/>'
        '<limit lower="0" upper="9" effort="1" velocity="1"/></joint></robot>'
    )
    column = Solid(np.array(upright(-3, 0)), faces)
    found = Robot.read(tmp_path / "lift.urdf").first_contact([[0.0], [4.0]], {"column": column})
    assert found.outcome == "contact" and found.upper is not None
    assert found.lower <= 0.25 <= found.upper < 0.25 + 1e-11
    found.verify()
    file = json.loads(found.proof_json())
    conform("proof", file)
    report = check.check(json.dumps(file))
    assert "'plate' and 'column' meet" in report.holds[-1] and not report.unchecked
    point = value_at(file, PATH)["meeting"]["how"]["point"]["point"]
    for axis, far in ((0, 3.0), (1, -3.0), (2, 1.0), (2, -1.0)):
        point[axis] += far
        with pytest.raises(check.RefusedError, match="the point is not inside"):
            check.check(json.dumps(file))
        point[axis] -= far
