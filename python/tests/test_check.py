"""Tests the checker in fractions on saved proofs.

The checker needs neither the extension nor the shared helpers, and is loaded from its file:
``python3 -m pytest --noconftest python/tests/test_check.py`` runs anywhere.
"""

import ast
import importlib.util
import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent
PROOFS = HERE / "proofs"
FILE = HERE.parent / "src" / "colltrans" / "check.py"


#: The fields of the moving and the fixed pose, and of the direction.
MOVING_POSE = ("placement", "poses", 0, "pose")
FIXED_POSE = ("placement", "poses", 1, "pose")
DIRECTION = ("query", "cast", "direction")
#: The fields of the proofs of a motion, of a motion of solids and of a path.
MOTION = ("statement", "motions", 0, "convex")
SOLIDS = ("statement", "motions", 0, "solids", "proof")
PATH = ("statement", "path", "proof")
FAR = (*MOVING_POSE, "translation", 0)


def _load() -> Any:
    spec = importlib.util.spec_from_file_location("colltrans_check", FILE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


check = _load()


def proof(name: str) -> Any:
    return json.loads((PROOFS / f"{name}.json").read_text())


def without_field(name: str) -> Callable[[Any], Any]:
    """Returns a change that removes a field of an object."""
    return lambda of: {key: value for key, value in of.items() if key != name}


def refused(file: Any) -> bool:
    try:
        check.check(json.dumps(file))
    except (check.RefusedError, check.NoProofError):
        return True
    return False


def places(value: Any, way: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Returns the paths of all numbers."""
    if isinstance(value, dict | list):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, part in items:
            yield from places(part, (*way, key))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield way


def changed(file: Any, way: tuple[Any, ...], by: Callable[[Any], Any]) -> Any:
    other = json.loads(json.dumps(file))
    at = other
    for key in way[:-1]:
        at = at[key]
    at[way[-1]] = by(at.get(way[-1]) if isinstance(at, dict) else at[way[-1]])
    return other


def always(value: Any) -> Callable[[Any], Any]:
    """Returns a change to this value."""
    return lambda _: value


def believed(file: Any, under: tuple[Any, ...], by: Callable[[Any], Any]) -> list[Any]:
    """Returns the numbers whose change is not noticed."""
    ways = [way for way in places(file) if way[: len(under)] == under]
    assert ways
    return [way for way in ways if not refused(changed(file, way, by))]


@pytest.mark.parametrize(
    ("name", "holds"),
    [
        ("contacts", "against the direction: the bodies do meet at one of at most"),
        ("separation", "the bodies never meet: a gap of"),
        ("solids", "first meet at"),
        ("beside", "the bodies never meet: a gap of"),
        ("directions", "about 1.15048e-05 % of all directions are free"),
        ("inner", "4 by two boxes inside the bodies each"),
    ],
)
def test_a_valid_proof_is_accepted(name: str, holds: str) -> None:
    report = check.check((PROOFS / f"{name}.json").read_text())
    assert any(holds in line for line in report.holds)
    solid = name in {"solids", "beside", "directions", "inner"}
    assert any("overlap where they are" in line for line in report.unchecked) == solid


def more(x: Any) -> Any:
    return x + 1 if isinstance(x, int) else x * 1.001 + 1e-3


def less(x: Any) -> Any:
    return x + 1 if isinstance(x, int) else x * 0.999 - 1e-3


@pytest.mark.parametrize("by", [more, less])
def test_changing_any_number_of_a_contact_is_refused(by: Callable[[Any], Any]) -> None:
    file = proof("contacts")
    for way in [MOVING_POSE, FIXED_POSE, DIRECTION]:
        assert believed(file, way, by) == []
    for end in ["first", "last"]:
        for part in ["normal", "weights", "pairs"]:
            assert believed(file, ("statement", "contacts", end, part), by) == []


def inside(x: float, middle: float) -> float:
    """Returns a value that is nearly as far on the other side."""
    return middle + 0.98 * (middle - x)


def test_a_bound_beyond_the_proof_is_refused() -> None:
    file = proof("contacts")
    for end in ["first", "last"]:
        way = ("statement", "contacts", end)
        tight = file["statement"]["contacts"][end]
        middle = (tight["upper"] + tight["lower"]) / 2
        inwards = partial(inside, middle=middle)
        assert believed(file, (*way, "lower"), inwards) == []
        assert believed(file, (*way, "upper"), inwards) == []
        assert believed(file, (*way, "lower"), lambda x: x - 1) == [(*way, "lower")]
    apart = proof("separation")
    plane = ("statement", "separation")
    assert believed(apart, (*plane, "margin"), lambda x: x + 1e-12) == []
    assert believed(apart, (*plane, "margin"), lambda x: -x) == []
    assert believed(apart, (*plane, "normal"), more) == []


def test_changing_the_stop_of_solids_is_refused() -> None:
    file = proof("solids")
    way = ("statement", "clearance", "stop")
    assert believed(file, (*way, "translation", "lower"), lambda x: x + 1e-9) == []
    assert believed(file, (*way, "translation", "upper"), lambda x: x - 1e-9) == []
    # Facets of one plane meet the others equally early; facets of other planes do not.
    assert believed(file, (*way, "facets"), lambda k: k + 10_000) == []
    assert refused(changed(file, (*MOVING_POSE, "translation", 2), more))
    assert not refused(changed(file, (*way, "translation", "lower"), lambda _: None))
    beside = proof("beside")
    assert refused(changed(beside, ("statement", "clearance", "separation", "normal", 0), more))


def replaced_by(value: Any) -> Callable[[Any], Any]:
    return lambda _: value


def said(file: Any) -> str:
    (line,) = check.check(json.dumps(file)).holds
    told: str = line.partition("about")[2]
    return told


def test_changing_any_facet_of_a_cell_is_refused() -> None:
    file = proof("directions")
    way = ("statement", "free_directions", "cells")
    at = list(places(file["statement"]["free_directions"]["cells"]))
    counts = [sum(len(piece["triangles"]) for piece in body["pieces"]) for body in file["bodies"]]
    tried = held = 0
    for k, place in enumerate(at[::4]):
        for facet in (k % counts[place[-1]], counts[place[-1]]):
            other = changed(file, (*way, *place), replaced_by(facet))
            tried += 1
            if not refused(other):
                # Another facet of the same plane may block as much.
                held += 1
                assert said(other) == said(file)
    assert tried > 20 and held < tried / 2


def test_cells_cover_the_sphere_and_no_free_cell_is_blocked() -> None:
    file = proof("directions")
    way = ("statement", "free_directions")
    cells = file["statement"]["free_directions"]["cells"]
    assert refused(changed(file, (*way, "cells"), lambda all_of: all_of[:-1]))
    assert refused(changed(file, (*way, "cells"), lambda all_of: [*all_of, {"open": []}]))
    blocked = next(k for k, cell in enumerate(cells) if "blocked" in cell)
    assert refused(changed(file, (*way, "cells", blocked), lambda _: {"open": []}))
    some = next(
        k for k, cell in enumerate(cells) if cell != "cut" and len(cell.get("open", [])) > 1
    )
    assert refused(changed(file, (*way, "cells", some), lambda cell: {"open": cell["open"][:1]}))
    nothing = check.check(
        json.dumps(changed(file, (*way, "cells", some), lambda _: {"undecided": []}))
    )
    assert any("cells are undecided" in line for line in nothing.unchecked)
    assert refused(changed(file, (*way, "tolerance"), lambda _: 0.0))
    assert refused(changed(file, (*way, "shrunk", 0, 0, 2), lambda z: z - 5.0))


def test_inner_boxes_are_inside_and_block_their_cells() -> None:
    """Uses a ring around a rod, both with facets that are small compared with the play."""
    file = proof("inner")
    way = ("statement", "free_directions")
    statement = file["statement"]["free_directions"]
    outside = {"low": [50.0, 0.0, 0.0], "high": [51.0, 1.0, 1.0]}
    for side in range(2):
        for at, one in enumerate(statement["boxes"][side]):
            box = (*way, "boxes", side, at)
            assert refused(changed(file, box, always(outside)))
            turned = {"low": one["high"], "high": one["low"]}
            assert refused(changed(file, box, always(turned)))
            for k in range(3):
                assert refused(changed(file, (*box, "high", k), lambda x: x + 4.0))
                assert refused(changed(file, (*box, "low", k), lambda x: x - 4.0))
    cells = statement["cells"]
    inner = next(k for k, cell in enumerate(cells) if "inner" in cell)
    assert refused(changed(file, (*way, "cells", inner), lambda _: {"inner": [99, 0]}))
    others = [k for k, cell in enumerate(cells) if "blocked" in cell]
    moved = [changed(file, (*way, "cells", k), lambda _: cells[inner]) for k in others]
    assert sum(refused(one) for one in moved) > len(others) // 2
    assert refused(changed(file, (*way, "start_overlap"), lambda _: "ignore"))


def test_a_missing_field_claims_nothing() -> None:
    """Null means a missing value, as in the library."""
    file = proof("contacts")
    contacts = file["statement"]["contacts"]
    contacts["last"] = None
    report = check.check(json.dumps(file))
    assert report.holds and not any("against" in line for line in report.holds)
    contacts["first"] = None
    with pytest.raises(check.NoProofError, match="no contact is claimed"):
        check.check(json.dumps(file))
    for none in ({}, None, {"contacts": None, "separation": None}):
        file["statement"] = none
        with pytest.raises(check.NoProofError, match="there has to be one of contacts"):
            check.check(json.dumps(file))


def test_changing_any_field_of_a_body_is_refused() -> None:
    file = proof("contacts")
    body = ("bodies", 0, "convex")
    assert believed(file, (*body, "faces"), lambda k: k + 1) == []
    assert believed(file, (*body, "faces"), lambda _: 10_000) == []
    assert believed(file, (*body, "hull_error"), lambda x: -x - 1.0) == []
    for name, wrong in [
        ("faces", file["bodies"][0]["convex"]["faces"][1:]),
        ("faces", [face[::-1] for face in file["bodies"][0]["convex"]["faces"]]),
        ("input_indices", []),
        ("hull_error", None),
    ]:
        other = proof("contacts")
        other["bodies"][0]["convex"][name] = wrong
        assert refused(other), name


def test_a_body_without_some_input_points_is_accepted() -> None:
    file = proof("contacts")
    content = file["bodies"][0]["convex"]
    content["hull_error"] = 1e-12
    for excess in (None, 0.0, 1e-12):
        content["input_excess"] = excess
        assert not refused(file), excess
    for wrong in (2e-12, -1e-15, ""):
        content["input_excess"] = wrong
        assert refused(file), wrong


def test_a_stated_rounding_may_include_the_input_excess() -> None:
    file = proof("contacts")
    file["statement"]["contacts"]["first"]["rounding"] = 1e-9
    assert refused(file)
    file["bodies"][0]["convex"]["hull_error"] = 1e-9
    assert refused(file)
    file["bodies"][0]["convex"]["input_excess"] = 1e-9
    assert not refused(file)


def test_a_slide_is_checked_as_a_slide() -> None:
    file = proof("slide")
    report = check.check(json.dumps(file))
    assert report.holds[0].startswith("the bodies slide along each other")
    assert any("no upper bound is claimed" in line for line in report.unchecked)
    way = ("statement", "contacts", "slide")
    assert believed(file, (*way, "overlap"), lambda x: x - 1e-12) == []
    assert believed(file, (*way, "overlap"), lambda x: x + 1) == [(*way, "overlap")]
    assert believed(file, (*way, "normal"), lambda x: x + 0.1) == []


def test_a_contact_hidden_by_rounding_is_accepted() -> None:
    """Uses a corner that the line misses by the last bit, so that no triangle is met exactly."""
    file = proof("contacts")
    cube = file["bodies"][1]["convex"]["vertices"]
    first = file["statement"]["contacts"]["first"]
    pair = first["pairs"][0]
    # Uses the pair alone, with the direction rounded from one corner to the other.
    turn = value_at(file, MOVING_POSE)
    rows = [turn["matrix"][k::3] for k in range(3)]
    v = file["bodies"][0]["convex"]["vertices"][pair["moving"]]
    p = [sum(a * b for a, b in zip(row, v, strict=True)) for row in rows]
    p = [a + b for a, b in zip(p, turn["translation"], strict=True)]
    way = [a - b for a, b in zip(cube[pair["fixed"]], p, strict=True)]
    file["query"]["cast"]["direction"] = [x / 3 for x in way]
    first.update(pairs=[pair] * 3, lower=-100.0, upper=3.0 + 1e-12)
    del file["statement"]["contacts"]["last"]
    report = check.check(json.dumps(file))
    assert any("as far as rounding can tell" in line for line in report.holds)
    first["upper"] = 3.0
    assert refused(file)


#: A solid, and fields from the other kind of placement.
BESIDE = proof("solids")["bodies"][1]
RENAMED = {"motions": proof("contacts")["placement"]["poses"]}


def test_the_question_of_a_pair_must_be_known() -> None:
    file = proof("directions")
    assert file["query"] == "pair"
    with pytest.raises(check.NoProofError, match="there has to be one of cast, scene"):
        check.check(json.dumps(changed(file, ("query",), always({"pair": {}}))))


def test_files_without_a_proof_are_refused(tmp_path: Path) -> None:
    text = (PROOFS / "contacts.json").read_text()
    wrong = {
        "half": text[: len(text) // 2],
        "empty": "",
        "list": "[]",
        "format": text.replace("colltrans proof", "colltrans proofs"),
        "version": text.replace('"version":2', '"version":3'),
        "no version": text.replace('"version":2,', ""),
        "older": text.replace("colltrans proof", "colltrans proof 1"),
        "twice": text.replace('"direction":', '"direction":[1,0,0],"direction":'),
        "infinite": text.replace('"direction":[1.0', '"direction":[Infinity'),
        "deep": "[" * 100_000,
        "far": json.dumps(changed(proof("contacts"), FAR, lambda _: -1e300)),
        "still": json.dumps(changed(proof("contacts"), DIRECTION, always([0, 0, 0]))),
        "mixed": json.dumps(changed(proof("contacts"), ("bodies", 1), always(BESIDE))),
        "other query": json.dumps({**proof("contacts"), "query": "pair"}),
        "two queries": json.dumps(changed(proof("contacts"), ("query", "scene"), always({}))),
        "other placement": json.dumps(changed(proof("contacts"), ("placement",), always(RENAMED))),
    }
    for name, content in wrong.items():
        with pytest.raises(check.NoProofError):
            check.check(content)
        (tmp_path / name).write_text(content)
        assert check.main([str(tmp_path / name)]) == 3
    assert check.main([str(tmp_path / "none")]) == 3
    assert check.main([]) == 2


def test_the_checker_runs_without_the_package() -> None:
    """Runs without the package and its dependencies."""
    command = [sys.executable, "-I", "-S", str(FILE), str(PROOFS / "contacts.json")]
    told = subprocess.run(command, capture_output=True, text=True)
    assert told.returncode == 0, told.stderr
    assert told.stdout.startswith("holds: along the direction")
    assert check.main([str(PROOFS / "solids.json")]) == 7
    claim = proof("contacts")
    claim["statement"]["contacts"] = {}
    assert refused(claim), "it claims nothing"


def test_each_part_of_the_checker_uses_only_earlier_parts() -> None:
    parts = ast.parse(FILE.read_text()).body
    line_of: dict[str, int] = {}
    for part in parts:
        if isinstance(part, ast.FunctionDef | ast.ClassDef):
            line_of[part.name] = part.lineno
        elif isinstance(part, ast.Assign | ast.AnnAssign):
            targets = part.targets if isinstance(part, ast.Assign) else [part.target]
            names = (n for target in targets for n in ast.walk(target))
            line_of |= {n.id: part.lineno for n in names if isinstance(n, ast.Name)}
    later = [
        (part.lineno, name.id)
        for part in parts
        for name in ast.walk(part)
        if isinstance(name, ast.Name) and line_of.get(name.id, 0) > part.lineno
    ]
    assert len(line_of) > 100 and later == []


def test_a_margin_is_that_of_the_shadows_not_along_a_tilted_normal() -> None:
    file = proof("slide")
    value_at(file, MOVING_POSE)["translation"] = [-100.0, 1.1, 0.25]
    separation = {"normal": [0.0, -1.0, 0.0], "margin": 0.09}
    file["statement"] = {"separation": separation}
    assert not refused(file)
    # The shadows are 0.1 apart, the bodies 98.9 along a normal that is tilted to the direction.
    for normal, margin in [([0.99995, -0.01, 0.0], 98.9), ([3e-15, -1.0, 0.0], 0.1 + 2e-13)]:
        file["statement"] = {"separation": {"normal": normal, "margin": margin}}
        assert refused(file)


def test_an_overlap_of_a_slide_is_that_of_the_shadows() -> None:
    file = proof("slide")
    value_at(file, MOVING_POSE)["translation"] = [-1e9, 1.0 - 1e-6, 0.25]
    slide = {"normal": [0.0, -1.0, 0.0], "overlap": 1.1e-6}
    file["statement"]["contacts"] = {
        "slide": slide,
        "first": file["statement"]["contacts"]["first"] | {"lower": -1e30},
    }
    check.check(json.dumps(file))
    for normal in ([3e-15, -1.0, 0.0], [-3e-15, -1.0, 0.0]):
        slide |= {"normal": normal, "overlap": 0.0}
        assert refused(file)


@pytest.mark.parametrize(
    ("name", "way", "value"),
    [
        ("contacts", ("statement", "contacts", "first", "rounding"), -1e-300),
        ("contacts", ("statement", "contacts", "first", "rounding"), 1.0),
        ("contacts", ("statement", "contacts", "first", "weights"), {}),
        ("contacts", ("bodies", 0, "convex", "hull_error"), 1e200),
        ("contacts", (*MOVING_POSE, "translation", 0), 5e-324),
        ("contacts", (*DIRECTION, 1), 1e-300),
        ("separation", ("statement", "separation", "unknown"), 1.0),
        ("separation", ("query", "cast", "min_gap"), -1.0),
        ("separation", ("query", "cast", "min_gap"), None),
        ("solids", ("statement", "clearance", "certificate", "tolerance"), -1.0),
        ("solids", ("statement", "clearance", "certificate", "lower"), "x"),
        ("solids", ("statement", "clearance", "certificate", "cover"), "z"),
        ("solids", ("statement", "clearance", "certificate", "stop", "triangles"), [0]),
        ("solids", ("statement", "clearance", "stop", "translation", "value"), None),
    ],
)
def test_values_outside_the_specification_are_refused(
    name: str, way: tuple[Any, ...], value: Any
) -> None:
    file = proof(name)
    at = file
    for key in way[:-1]:
        at = at[key]
    at[way[-1]] = value
    assert refused(file)


def containers(value: Any, way: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Returns the paths of all lists and objects; of each list only the first entry."""
    if not isinstance(value, dict | list):
        return
    if way:
        yield way
    items = value.items() if isinstance(value, dict) else enumerate(value[:1])
    for key, part in items:
        yield from containers(part, (*way, key))


def value_at(file: Any, way: tuple[Any, ...]) -> Any:
    for key in way:
        file = file[key]
    return file


#: Fields that claim nothing, or state that nothing is claimed, if they are null.
MAY_BE_NULL = {"separation", "stop", "meeting", "first", "last", "slide"}


#: Files that take a second to check, where another file of the same kind is fast.
SLOW = {"path_contact", "path_free", "path_kept", "path_solid"}


@pytest.mark.parametrize("name", sorted({path.stem for path in PROOFS.glob("*.json")} - SLOW))
def test_another_value_instead_of_a_list_or_an_object_is_refused(name: str) -> None:
    file = proof(name)
    ways = list(containers(file))
    assert len(ways) > 10
    for way in ways:
        empty: Any = {} if isinstance(value_at(file, way), list) else []
        for other in (empty, "", None):
            if other is None and way[-1] in MAY_BE_NULL:
                continue
            assert refused(changed(file, way, always(other))), (way, other)


@pytest.mark.parametrize("name", ["solids", "beside", "inner", "solids_free", "path_solid"])
def test_a_piece_that_is_not_closed_is_refused(name: str) -> None:
    file = proof(name)
    solids = (body for body in file["bodies"] if "pieces" in body)
    triangles = next(solids)["pieces"][0]["triangles"]
    last = triangles.pop()
    assert refused(file)
    triangles.append(last[::-1])
    assert refused(file)
    triangles[:] = [[last[0]] * 3] * len(triangles)
    assert refused(file)


@pytest.mark.parametrize(
    "near",
    [
        {"meeting": "apart"},
        {"meeting": {"facets": [0]}},
        {"points": {"triangles": [0, "x"], "weights": [[1, 0, 0]] * 2, "distance": 1.0}},
        {"points": {"triangles": [0, 0], "weights": [[1, 0]] * 2, "distance": 1.0}},
        {"points": {"triangles": [0, 0], "weights": [[1, 0, 0]] * 2, "distance": None}},
    ],
)
def test_malformed_fields_of_near_solids_are_refused(near: Any) -> None:
    file = proof("solids")
    file["statement"] = {"solid_distance": {"lower": 0.0, "near": near, "cover": ""}}
    file["query"] = "pair"
    assert refused(file)


@pytest.mark.parametrize("name", ["solids_free", "solids_contact", "solids_kept"])
@pytest.mark.parametrize("start", [None, [], {}, 0, "z", "smz"])
def test_malformed_fields_of_the_start_are_refused(name: str, start: Any) -> None:
    assert refused(changed(proof(name), (*SOLIDS, "start", "apart"), always(start)))


@pytest.mark.parametrize("place", [0, 3])
def test_unused_weights_must_still_be_numbers(place: int) -> None:
    file = proof("path_kept")
    near = value_at(file, PATH)["meeting"]["how"]["pieces"]["met"]["near"]
    assert not refused(file)
    near["weights"][place] = None
    assert refused(file)


@pytest.mark.parametrize(
    "steps",
    [None, {}, [], 0, {"planar_problems": 0, "supports": 1, "pivots": 0, "iterations": None}],
)
def test_malformed_counts_of_work_are_refused(steps: Any) -> None:
    way = (*MOTION, "meeting", "met", "deep", "steps")
    assert refused(changed(proof("motion_contact"), way, always(steps)))


def test_any_corner_inside_shows_that_bodies_overlap_where_a_path_begins() -> None:
    file = proof("path_inside")
    assert value_at(file, PATH)["meeting"]["how"] == "inside"
    links = file["placement"]["robot"]["bodies"]
    room = next(of for of in links if of["name"] == "room")
    base = {**links[0], "name": "other base"}
    links.append(base)
    file["statement"]["path"]["pairs"][3] = ["other base", "room"]
    # Four of the eight corners are inside, and the first one is not.
    room["pose"]["translation"][0] = 4.95
    assert file["bodies"][base["body"]]["convex"]["vertices"][0][0] < -5.0 + 4.95
    report = check.check(json.dumps(file))
    assert any("'other base' and 'room' meet" in line for line in report.holds)
    room["pose"]["translation"][0] = 5.2
    assert refused(file)


def test_carried_values_beyond_their_range_are_refused() -> None:
    file = proof("path_free")
    links = file["placement"]["robot"]["bodies"]
    next(of for of in links if of["frame"] is not None)["pose"]["translation"][0] = 2.0**200
    with pytest.raises(check.NoProofError, match="farther than 2\\^200"):
        check.check(json.dumps(file))


def test_faces_that_may_not_be_those_of_the_hull_are_left_unchecked() -> None:
    file = proof("contacts")
    assert not check.check(json.dumps(file)).partly
    corner = file["bodies"][0]["convex"]["vertices"][0]
    corner[0] += 1e-12 * max(abs(x) for v in file["bodies"][0]["convex"]["vertices"] for x in v)
    lower, upper = (file["statement"]["contacts"][end] for end in ("first", "last"))
    for end in (lower, upper):
        end |= {"lower": end["lower"] - 1e-9, "upper": None}
    report = check.check(json.dumps(file))
    assert report.partly and any("the faces of body 0" in line for line in report.unchecked)


def test_facets_meet_exactly() -> None:
    """Finds common points of facets in any position, and none at the smallest distance."""
    tiny = Fraction(1, 2**80)

    def facet(*corners: tuple[int, int, int | Fraction]) -> Any:
        a, b, c = ((Fraction(x), Fraction(y), Fraction(z)) for x, y, z in corners)
        return a, b, c

    flat = facet((0, 0, 0), (4, 0, 0), (0, 4, 0))
    for other, meets in [
        (facet((1, 1, 0), (2, 1, 0), (1, 2, 0)), True),  # in the same plane, inside
        (facet((4, 0, 0), (8, 0, 0), (8, 4, 0)), True),  # with a common corner
        (facet((3, 3, 0), (8, 3, 0), (8, 8, 0)), False),  # in the same plane, apart
        (facet((1, 1, -1), (1, 1, 1), (9, 9, 9)), True),  # through the inside
        (facet((1, 1, 0), (1, 2, 1), (2, 1, 1)), True),  # a corner on the facet
        (facet((1, 1, tiny), (1, 2, 1), (2, 1, 1)), False),
        (facet((2, 2, -1), (2, 2, 1), (9, 9, 0)), True),  # at an edge
        (facet((3, 2, -1), (3, 2, 1), (9, 9, 0)), False),
        (facet((1, 1, 1), (2, 1, 1), (1, 2, 1)), False),  # parallel
        (facet((1, 1, 0), (1, 1, 0), (1, 1, 0)), False),  # without an area: not decided
    ]:
        for f in (flat, (flat[1], flat[2], flat[0])):
            assert check.do_facets_meet(f, other) == meets
            assert check.do_facets_meet(other, f) == meets
