"""Tests the checker in fractions on saved and forged proofs of turning solids."""

import json
import random
from collections.abc import Callable
from typing import Any

import pytest
from test_check import SOLIDS, always, changed, check, proof, refused, value_at, without_field

ALL = ["contact", "free", "kept", "carried", "inside"]
MOVERS = ("placement", "motions", 0)
QUERY = ("query", "motions", 0)
PARTS = ("statement", "motions", 0, "solids", "parts")
WAY = (*SOLIDS, "spans", 0, "cover")


@pytest.mark.parametrize(
    ("name", "holds"),
    [
        ("contact", ["never meet up to the time", "inside the other", "meet at the time"]),
        ("free", ["never meet throughout the motion", "inside the other"]),
        (
            "kept",
            ["never are as near as 0.25 up to", "inside the other", "are as near as 0.25 at"],
        ),
        ("carried", ["never meet throughout the motion", "inside the other"]),
        ("inside", ["never meet up to the time", "inside the other", "meet at the time"]),
    ],
)
def test_a_valid_proof_is_accepted(name: str, holds: list[str]) -> None:
    report = check.check(json.dumps(proof(f"solids_{name}")))
    assert len(report.holds) == len(holds) and report.partly
    assert all(words in line for words, line in zip(holds, report.holds, strict=True))
    assert report.unchecked == ["whether facets were moved inwards as the tolerance says"]


@pytest.mark.parametrize("name", ALL)
def test_a_changed_entry_of_a_cover_is_refused(name: str) -> None:
    file = proof(f"solids_{name}")
    cover = value_at(file, SOLIDS)["spans"][0]["cover"]
    drawn = random.Random(3)
    count = 0
    for _ in range(12):
        at = drawn.randrange(len(cover))
        with_ = drawn.choice("TPQL")
        for other in (cover[:at] + cover[at + 1 :], cover[:at] + with_ + cover[at + 1 :]):
            if other != cover:
                count += refused(changed(file, WAY, always(other)))
    assert count > 12
    # A body in the slot of another is not separated from it by one plane.
    for letter in "mabcxyz" if name in {"free", "carried"} else "":
        whole = changed(file, WAY, always(letter))
        value_at(whole, SOLIDS)["spans"][0]["lists"] = []
        assert refused(whole)


@pytest.mark.parametrize(
    ("part", "by"),
    [
        ((*MOVERS, 0, "motion", 0, "rate"), lambda x: 1.5 * x + 0.1),
        ((*MOVERS, 0, "motion", 0, "arm", 0), lambda x: x + 1.0),
        ((*MOVERS, 0, "motion", 0, "start", "translation", 0), lambda x: x - 1.5),
        ((*SOLIDS, "spans", 0, "until"), lambda x: min(1.0, x + 1e-3)),
        ((*SOLIDS, "meeting", "time"), lambda x: 0.9 * x),
        ((*SOLIDS, "meeting", "triangles", 0), lambda k: k + 1),
        ((*SOLIDS, "meeting", "triangles", 0), lambda k: 1000),
        ((*SOLIDS, "meeting", "met", "crossing", "moving"), lambda of: not of),
        ((*PARTS, 0, "numbers", 0), lambda k: k + 1),
        ((*PARTS, 0, "tree", 0), lambda k: 0),
        ((*PARTS, 0, "tree"), lambda tree: tree[:-1]),
        ((*PARTS, 1, "corners"), lambda of: of[:-1]),
        ((*SOLIDS, "meeting", "met", "crossing", "moving"), lambda of: int(of)),
        ((*SOLIDS, "meeting", "met", "crossing", "edge"), lambda k: k + 3),
        ((*SOLIDS, "start"), lambda of: "assumed"),
        ((*SOLIDS, "start"), lambda of: "apart"),
        ((*SOLIDS, "start"), lambda of: {"facets": [0, 0]}),
        ((*SOLIDS, "tolerance"), lambda x: -x),
        ((*SOLIDS, "tolerance"), lambda x: 0.0),
        ((*QUERY, "tolerance"), lambda x: 0.25),
        ((*SOLIDS, "spans", 0, "cover"), list),
        ((*SOLIDS, "spans", 0, "cover"), lambda of: [of[:1] + of[1:]]),
        ((*QUERY, "min_gap"), lambda x: 0.5),
        ((*QUERY, "min_gap"), lambda x: -0.5),
    ],
)
def test_changing_any_number_is_refused(part: tuple[Any, ...], by: Callable[[Any], Any]) -> None:
    file = proof("solids_contact")
    assert refused(changed(file, part, by))


def test_the_offset_of_facets_is_reported() -> None:
    file = proof("solids_free")
    moved = changed(file, (*PARTS, 0, "corners", 0, 0, 2), lambda x: x + 0.125)
    report = check.check(json.dumps(moved))
    assert any("moved by at most 0.125" in line for line in report.holds)
    # The checker does not check the offset of the tolerance, so the report is partial.
    assert report.partly and any("as the tolerance says" in line for line in report.unchecked)


def test_missing_or_unknown_fields_are_refused() -> None:
    file = proof("solids_contact")
    for under in ((), SOLIDS, (*SOLIDS, "spans", 0), (*SOLIDS, "meeting"), (*PARTS, 0)):
        at = file
        for key in under:
            at = at[key]
        assert refused(changed({"of": file}, ("of", *under), lambda of: {**of, "more": 0})["of"])
        for name in at:
            rest = changed({"of": file}, ("of", *under), without_field(name))["of"]
            assert name not in at or refused(rest), name


def test_a_solid_inside_the_other_is_refused() -> None:
    file = proof("solids_free")
    # The other solid, far larger and around the first one: no facets meet, and there are no planes.
    inside = json.loads(json.dumps(file))
    for piece in inside["bodies"][1]["pieces"]:
        piece["vertices"] = [[100.0 * (x - 0.5) for x in v] for v in piece["vertices"]]
    parts = value_at(inside, PARTS)[1]
    parts["corners"] = [
        [[100.0 * (x - 0.5) for x in v] for v in triangle] for triangle in parts["corners"]
    ]
    assert refused(inside)
    with pytest.raises(check.RefusedError):
        check.check_start(*placed(inside))
    check.check_start(*placed(file))


def placed(file: Any) -> tuple[Any, Any]:
    """Returns the first span of a file, and its parts."""
    shapes = [check.Shape.read(body) for body in file["bodies"]]
    parts = [
        check.Parts.read(shape, of) for shape, of in zip(shapes, value_at(file, PARTS), strict=True)
    ]
    origin = [check._ZERO]
    spans = check.spans(value_at(file, MOVERS), [origin, origin], check.Fraction())
    return spans[0], (parts[0], parts[1])


def test_a_point_that_is_inside_both_has_to_be() -> None:
    file = proof("solids_inside")
    way: tuple[Any, ...] = (*SOLIDS, "meeting", "met", "inside", "point")
    at = value_at(proof("solids_inside"), (*SOLIDS, "meeting", "met", "inside", "point"))
    for k in range(3):
        for off in (2.5, -2.5, 1e-12 if k == 2 else 5.0):
            assert refused(changed(file, (*way, k), always(at[k] + off)))
    assert refused(changed(file, (*SOLIDS, "meeting", "time"), lambda t: t - 1e-12))
    open_ = changed(file, ("bodies", 1, "pieces", 0), lambda piece: {**piece, "open": True})
    assert refused(open_)


def test_a_point_of_a_facet_has_to_be_inside_the_other_solid() -> None:
    file = proof("solids_contained")
    report = check.check(json.dumps(file))
    assert [line for line in report.holds if "meet at the time" in line]
    way: tuple[Any, ...] = (*SOLIDS, "meeting", "met", "contained")
    for weights in ([0.5, 0.0, 0.0], [2.0, -1.0, 0.0], [1.0, 0.0], [1.0, 0.0, "0"]):
        assert refused(changed(file, (*way, "weights"), always(weights)))
    assert refused(changed(file, (*way, "moving"), always(False)))
    assert refused(changed(file, (*way, "moving"), always(1)))
    time = value_at(file, SOLIDS)["meeting"]["time"]
    for off in (-1e-9, -0.1):
        assert refused(changed(file, (*SOLIDS, "meeting", "time"), always(time + off)))
    assert refused(changed(file, (*QUERY, "min_gap"), always(0.5)))
    open_ = changed(file, ("bodies", 1, "pieces", 0), lambda piece: {**piece, "open": True})
    assert refused(open_)
