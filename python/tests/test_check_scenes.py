"""Tests the checker in fractions on forged proofs about one body among many."""

import json
from typing import Any

import pytest
from test_check import check, refused


def placed(x: float) -> dict[str, Any]:
    return {"body": 0, "pose": {"matrix": [1, 0, 0, 0, 1, 0, 0, 0, 1], "translation": [x, 0, 0]}}


def scene(statement: Any, *places: float, **choices: Any) -> dict[str, Any]:
    """Returns a scene of a unit cube at 0 among others along x."""
    corners = [[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    cube = {"vertices": corners, "faces": faces, "input_indices": list(range(8)), "hull_error": 0.0}
    return {
        "format": "colltrans proof",
        "version": 2,
        "bodies": [{"convex": cube}],
        "placement": {"poses": [placed(x) for x in (0.0, *places)]},
        "query": {"scene": {"start_overlap": "refuse", **choices}},
        "statement": statement,
    }


def near(distance: float) -> dict[str, Any]:
    pair = {"moving": 4, "fixed": 0}
    weights = [1.0, 0.0, 0.0, 0.0]
    return {"convex": {"pairs": [pair] * 4, "weights": weights, "distance": distance}}


def apart(gap: float) -> dict[str, Any]:
    return {"convex": {"normal": [1.0, 0.0, 0.0], "gap": gap}}


def within(length: Any, **lists: Any) -> dict[str, Any]:
    return {"within": {"length": length, "closer": [], "undecided": [], "apart": [], **lists}}


def holds(file: Any) -> bool:
    return bool(check.check(json.dumps(file)).holds)


def test_listing_an_obstacle_twice_is_refused() -> None:
    assert holds(scene(within(2.0, closer=[[0, near(2.0)]], apart=[[1, apart(3.0)]]), 3.0, 4.0))
    assert holds(scene(within(2.0, closer=[[0, near(2.0)]]), 3.0, 4.0))
    assert holds(scene(within(2.0, undecided=[0, 1]), 3.0, 4.0))
    for lists in (
        {"closer": [[0, near(2.0)]], "apart": [[0, apart(1e9)]]},
        {"closer": [[0, near(2.0)]], "undecided": [0]},
        {"undecided": [0], "apart": [[0, apart(1e9)]]},
        {"undecided": [0, 0]},
        {"undecided": [0, 7]},
        {"undecided": [0.0]},
    ):
        assert refused(scene(within(2.0, **lists), 3.0, 4.0)), lists


@pytest.mark.parametrize("length", [-0.5, -1e300, float("nan")])
def test_an_invalid_length_is_refused(length: float) -> None:
    # The squared distance of the boxes exceeds that of the length.
    assert refused(scene(within(length), 3.0, 4.0))


def test_claims_that_are_not_needed_are_checked() -> None:
    claim = {"lower": 0.0, "obstacle": 0, "near": near(2.0), "apart": []}
    assert holds(scene({"nearest": claim}, 3.0, 4.0))
    assert refused(scene({"nearest": {**claim, "apart": [[1, apart(1e9)]]}}, 3.0, 4.0))


def test_unknown_options_are_refused() -> None:
    statement = within(2.0, closer=[[0, near(2.0)]])
    assert holds(scene(statement, 3.0, start_overlap="ignore", tolerance=None, graze_tolerance=0.5))
    for choices in (
        {"start_overlap": "allow"},
        {"graze_tolerance": -1.0},
        {"tolerance": -1.0},
        {"tolerance": ""},
        {"min_gap": -1.0},
        {"more": 1.0},
    ):
        assert refused(scene(statement, 3.0, **choices)), choices


def test_an_obstacle_ahead_is_not_behind() -> None:
    # Half a unit ahead and nearer than the gap: rounding must not be taken as twice the gap.
    pair = {"moving": 0, "fixed": 4}
    certificate = {
        "normal": [-1.0, 0.0, 0.0],
        "lower": -12.5,
        "pairs": [pair] * 3,
        "weights": [1.0, 0.0, 0.0],
        "upper": None,
        "rounding": 12.5,
    }
    passed = [[0, {"convex": {"free": {"behind": {"certificate": certificate}}}}]]
    claim = {"direction": [1.0, 0.0, 0.0], "lower": None, "stop": None, "passed": passed}
    assert refused(scene({"scene_clearance": claim}, 1.5, min_gap=10.0))
