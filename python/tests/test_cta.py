"""Tests the paper's algorithm as an option, with its start, its end and its steps."""

import pickle
from typing import Any

import numpy as np
import pytest

from colltrans import Contact, ConvexPolyhedron, Cta, Tracker, cast, cast_many
from colltrans.errors import QueryError

RANDOM = np.random.default_rng(3)
BALL = ConvexPolyhedron([point / np.linalg.norm(point) for point in RANDOM.normal(size=(400, 3))])
ABOVE = [0.2, 0.1, 5.0]
DOWN = [0.0, 0.0, -1.0]


def contact(direction: Any = DOWN, solver: Any = "cta") -> Contact:
    found = cast(BALL, BALL, direction, moving_pose=ABOVE, solver=solver)
    assert isinstance(found, Contact)
    return found


def test_planar_problems_are_solved_to_the_exit() -> None:
    whole = contact().steps
    part = contact(solver=Cta(until=0.3)).steps
    rough = contact(solver=Cta(start="ellipsoids")).steps
    assert whole.planar_problems > part.planar_problems > rough.planar_problems == 0
    assert 3 <= whole.region_sides <= 8 and rough.region_sides == 0
    near = contact(solver=Cta(start="guess", across_cells=True)).steps
    assert 1 <= near.planar_problems < whole.planar_problems
    cold = contact(solver=Cta(cold=True)).steps
    assert cold.iterations > whole.iterations
    early = contact(solver=Cta(cuts="centroid")).steps
    assert early.planar_problems != whole.planar_problems


def test_many_rows_take_the_options_of_one() -> None:
    directions = RANDOM.normal(size=(20, 3)) * 0.1 + DOWN
    solvers: list[Any] = [Cta(), Cta(until=0.1), Cta(start="guess", across_cells=True), "portal"]
    for solver in solvers:
        rows = cast_many(BALL, BALL, directions, moving_pose=ABOVE, solver=solver)
        ones = [contact(d, solver) for d in directions]
        assert rows.translation.tolist() == [one.translation for one in ones]


def test_a_tracker_starts_in_the_region_or_from_features() -> None:
    for tracker, solver, expected in (
        (Tracker(), "cta", "region"),
        (Tracker(region=0.1), "cta", "region"),
        (Tracker(features=True), "cta", "features"),
        (Tracker(features=False, region="everywhere"), "cta", "scratch"),
        (Tracker(), "auto", "features"),
    ):
        for step in range(3):
            start = np.add(ABOVE, [1e-3 * step, 0, 0])
            found = tracker.cast(BALL, BALL, DOWN, moving_pose=start, solver=solver)  # type: ignore[arg-type]
            assert isinstance(found, Contact)
            assert found.steps.started_from == (expected if step else "scratch")


def test_options_are_values_and_invalid_ones_are_refused() -> None:
    nearly = Cta(start="ellipsoids", until=0.25)
    assert repr(nearly) == "Cta(start='ellipsoids', until=0.25)"
    assert repr(Cta()) == "Cta(start='center', until='exit')"
    assert pickle.loads(pickle.dumps(nearly)) == nearly != Cta()
    fast = Cta(start="guess", cuts="centroid", across_cells=True, cold=True)
    options = "start='guess', until='exit', cuts='centroid', across_cells=True, cold=True"
    assert repr(fast) == f"Cta({options})"
    assert pickle.loads(pickle.dumps(fast)) == fast != Cta(start="guess")
    with pytest.raises(QueryError, match='there is no cut "corner"'):
        Cta(cuts="corner")  # type: ignore[arg-type]
    with pytest.raises(QueryError, match='there is no start "rim"'):
        Cta(start="rim")  # type: ignore[arg-type]
    for until in ("end", -1.0, float("nan")):
        with pytest.raises(QueryError, match="accepted: `exit`, or a number"):
            Cta(until=until)  # type: ignore[arg-type]
    with pytest.raises(QueryError, match='unknown region "near"'):
        Tracker(region="near")  # type: ignore[arg-type]
    with pytest.raises(QueryError, match="half-side"):
        Tracker(region=-1.0)
