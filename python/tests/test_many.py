"""Tests bulk calls: rows and single values, lists of bodies, bad rows, signals."""

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np
import pytest
from conftest import draw

import colltrans
from colltrans import (
    ColltransError,
    Contact,
    ConvexPolyhedron,
    InputError,
    Pose,
    Separated,
    cast,
    cast_many,
    clearance_many,
    contact_range_many,
)
from colltrans.columns import Failed
from colltrans.errors import BuildError

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
PLATE = ConvexPolyhedron.cuboid([-2, -2, -1], [2, 2, 0])
AHEAD = [1.0, 0, 0]


def test_single_values_apply_to_all_rows() -> None:
    starts = np.array([[-3.0, 0, 0], [-4, 0, 0], [-5, 0, 0]])
    assert cast_many(CUBE, CUBE, AHEAD, moving_pose=starts).translation.tolist() == [2, 3, 4]
    back = cast_many(CUBE, CUBE, AHEAD, fixed_pose=-starts)
    assert back.translation.tolist() == [2, 3, 4]
    longer = cast_many(CUBE, CUBE, [[1, 0, 0], [2, 0, 0]], moving_pose=Pose([-3, 0, 0]))
    assert longer.translation.tolist() == [2, 1]
    assert cast_many(CUBE, CUBE, AHEAD, moving_pose=[-3, 0, 0]).translation.tolist() == [2]
    grazes = cast_many(CUBE, CUBE, AHEAD, moving_pose=[-3, 0.99, 0], graze_tolerance=[0, 0.1])
    assert [row.outcome for row in grazes] == ["contact", "grazing"]
    assert [type(answer).__name__ for answer in grazes.answers()] == ["Contact", "Grazing"]


def test_no_rows_give_empty_columns() -> None:
    for many in (cast_many, contact_range_many, clearance_many):
        columns: Any = many(CUBE, CUBE, AHEAD, moving_pose=np.zeros((0, 3)))
        assert len(columns) == 0 and columns.normal.shape == (0, 3) and list(columns) == []
        assert columns.counts() == {}
        assert "0 rows" in columns._repr_html_()
    assert len(cast_many([], CUBE, AHEAD)) == 0
    assert len(cast_many(CUBE, CUBE, AHEAD, moving_pose=np.zeros((0, 3, 4)))) == 0


def test_bodies_are_given_by_index_or_one_for_each_row() -> None:
    starts = np.array([[0, 0, 5.0]] * 4)
    down = [0, 0, -1.0]
    by_index = cast_many([CUBE, PLATE], PLATE, down, moving_pose=starts, moving_index=[0, 1, 1, 0])
    assert by_index.translation.tolist() == [5, 4, 4, 5]
    each = cast_many([CUBE, PLATE, PLATE, CUBE], PLATE, down, moving_pose=starts)
    assert each.translation.tobytes() == by_index.translation.tobytes()
    assert each[1].query.moving is PLATE  # type: ignore[union-attr]


def test_bad_rows_are_errors_and_lose_nothing() -> None:
    n = 3000
    random = np.random.default_rng(4)
    poses = np.hstack([random.normal(size=(n, 3)) + [0, 0, 9], np.tile([0.0, 0, 0, 1], (n, 1))])
    directions = np.tile([0.0, 0, -1], (n, 1))
    index = np.zeros(n, int)
    good = cast_many(CUBE, PLATE, directions, moving_pose=poses)
    poses[10, 0], poses[20, 3:], directions[30] = np.nan, 2, 0
    index[[40, 50, 2999]] = [5, -1, 1]
    no_body = BuildError("it was bent")
    columns = cast_many([CUBE, no_body], PLATE, directions, moving_pose=poses, moving_index=index)
    assert sorted(columns.errors) == [10, 20, 30, 40, 50, 2999]
    assert columns.errors[10].startswith("moving_pose: the translation [NaN")
    assert columns.errors[20].endswith("has length 4, not 1")
    assert columns.errors[30].startswith("the direction [0.0, 0.0, 0.0] is zero")
    assert columns.errors[40] == "moving: no body 5 among 2"
    assert columns.errors[50] == "moving: no body -1 among 2"
    assert columns.errors[2999] == "moving: it was bent"
    bad = columns.where("error")
    assert np.flatnonzero(bad).tolist() == sorted(columns.errors)
    assert np.isnan(columns.translation[bad]).all() and np.isnan(columns.normal[bad]).all()
    assert columns.translation[~bad].tobytes() == good.translation[~bad].tobytes()
    assert columns[10] == Failed(columns.errors[10])
    assert columns.counts()["error"] == 6


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"moving_pose": np.zeros((4, 3)), "fixed_pose": np.zeros((5, 3))}, "4 rows.*5 rows"),
        ({"moving_pose": np.zeros((4, 5))}, r"moving_pose: an array of shape \(4, 5\)"),
        ({"moving_pose": np.zeros((4, 3, 5))}, r"\(4, 3, 5\), not .*\(3, 3\), \(3, 4\)"),
        ({"direction": np.zeros((4, 2))}, r"direction: an array of shape \(4, 2\)"),
        (
            {"graze_tolerance": np.zeros((2, 2)), "moving_pose": np.zeros((4, 3))},
            r"axes that cannot be broadcast: moving_pose \(4,\), graze_tolerance \(2, 2\)",
        ),
        ({"moving_pose": np.eye(3)}, r"is ambiguous: .* Give Pose\(matrix\), or a list"),
        ({"moving_index": [0.5]}, "moving_index: not an array of whole numbers"),
        ({"moving_index": 0}, "moving_index: not an array of whole numbers"),
        ({"moving_index": np.array([2**64 - 1], np.uint64)}, "too large"),
        ({"moving_index": [0, 0], "fixed_index": [0, 0, 0]}, "2 rows.*3 rows"),
        ({"threads": 0}, "threads: 0"),
        ({"threads": 1.5}, "threads: 1.5"),
        ({"solver": "newton"}, "unknown solver"),
    ],
)
def test_arrays_of_different_lengths_are_refused(arguments: dict[str, Any], match: str) -> None:
    with pytest.raises(ColltransError, match=match):
        cast_many([CUBE], [CUBE], **{"direction": AHEAD, **arguments})
    with pytest.raises(TypeError, match="moving: not a ConvexPolyhedron, but str"):
        cast_many(["cube"], CUBE, AHEAD)  # type: ignore[list-item]


def test_arrays_changed_after_the_call_raise_an_error() -> None:
    starts = np.array([[-3.0, 0, 0], [-4, 0, 0]])
    columns = cast_many(CUBE, CUBE, AHEAD, moving_pose=starts)
    starts[1, 0] = -7
    assert isinstance(columns[0], Contact)
    with pytest.raises(
        ColltransError, match="row 1: the arguments of the query have been modified"
    ):
        columns[1]
    with pytest.raises(IndexError):
        columns[2]
    assert isinstance(columns[:1][0], Contact)
    with pytest.raises(TypeError, match="integer"):
        columns[1.0]  # type: ignore[call-overload]
    assert isinstance(columns[-2], Contact)


def test_columns_are_names_masks_and_counts() -> None:
    starts = np.array([[-3, 0.5, 0], [-3, 2, 0], [-3, 1, 0]])
    columns = contact_range_many(CUBE, CUBE, AHEAD, moving_pose=starts)
    assert columns.counts() == {"contact": 1, "grazing": 1, "separated": 1}
    assert columns.where("contact", "grazing").tolist() == [True, False, True]
    assert columns.exit.tolist()[0] == 4
    with pytest.raises(InputError, match="unknown outcome 'hit'"):
        columns.where("hit")
    again = pickle.loads(pickle.dumps(columns))
    assert repr(again[0]) == repr(columns[0])
    html = columns._repr_html_()
    assert html.count("<tr>") == 4 and "separated" in html


def test_arrow_tables_hold_the_columns() -> None:
    pytest.importorskip("pyarrow")
    starts = [[-3, 0.5, 0], [np.nan, 2, 0]]
    assert clearance_many([], CUBE, AHEAD).to_arrow().num_rows == 0
    columns = clearance_many(CUBE, CUBE, AHEAD, moving_pose=starts)
    table = columns.to_arrow()
    assert table["outcome"].to_pylist() == ["blocked", "error"]
    assert table["normal"].to_pylist()[0] == [1, 0, 0]
    assert table["message"].to_pylist() == [None, columns.errors[1]]
    assert table["distance"].to_numpy()[0] == columns.distance[0]


def test_data_frames_hold_the_columns() -> None:
    pytest.importorskip("pandas")
    starts = [[-3, 0.5, 0], [np.nan, 2, 0]]
    columns = clearance_many(CUBE, CUBE, AHEAD, moving_pose=starts)
    frame = columns.to_pandas()
    assert list(frame["outcome"]) == ["blocked", "error"]
    assert frame["normal_x"][0] == 1 and frame["message"][1] == columns.errors[1]


def test_other_threads_run_during_a_call() -> None:
    settings = draw(seed=9, count=20)
    big = ConvexPolyhedron(settings.clouds[-1])
    poses = np.random.default_rng(1).normal(size=(300_000, 3)) + [0, 0, 9]
    ticks: list[float] = []
    done = threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    began = time.perf_counter()
    cast_many(big, big, [0, 0, -1], moving_pose=poses, threads=1)
    ended = time.perf_counter()
    done.set()
    thread.join()
    assert sum(began < t < ended for t in ticks) >= 5


@pytest.mark.skipif(os.name == "nt", reason="signals are sent another way")
def test_an_interrupt_ends_the_call() -> None:
    program = """
import numpy as np, colltrans, sys, time
random = np.random.default_rng(0)
body = colltrans.ConvexPolyhedron(random.normal(size=(2000, 3)))
poses = random.normal(size=(4_000_000, 7)) + [0, 0, 9, 0, 0, 0, 0]
print("ready", flush=True)
try:
    colltrans.cast_many(body, body, [0, 0, -1], moving_pose=poses, threads=2)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        # The call takes seconds: each row has a rotation of its own.
        time.sleep(0.2)
        sent = time.perf_counter()
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "interrupted\n"
        # Takes a second on an idle machine.
        assert time.perf_counter() - sent < 5


def test_a_single_call_equals_its_row_of_many() -> None:
    one = cast(CUBE, PLATE, [0, 0, -1], moving_pose=[0, 0, 5])
    columns = cast_many(CUBE, PLATE, [0, 0, -1], moving_pose=[0, 0, 5])
    (answer,), (row,) = columns.answers(), columns
    assert repr(one) == repr(answer) == repr(columns[0])
    assert isinstance(one, Contact)
    assert (row.outcome, row.translation) == ("contact", one.translation)
    assert [row.normal_x, row.normal_y, row.normal_z] == one.normal.tolist()
    assert [row.translation_lower, row.translation_upper] == one.to_dict()["translation_bounds"]
    assert colltrans.__all__ == sorted(colltrans.__all__)


def test_rows_beside_many_of_one_pair_keep_outcome_and_proof_but_not_the_margin() -> None:
    box = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    starts = np.random.default_rng(5).uniform(-3, 3, (600, 3))
    together = cast_many(box, box, [0, 0, -1], moving_pose=starts)
    for row in range(0, 600, 7):
        alone = cast_many(box, box, [0, 0, -1], moving_pose=starts[row])
        assert alone.outcome[0] == together.outcome[row]
        answer: Any = together[row]
        answer.certificate.verify()
    apart = together.where("separated")
    few = cast_many(box, box, [0, 0, -1], moving_pose=starts[apart][:9])
    first = cast(box, box, [0, 0, -1], moving_pose=starts[apart][0])
    assert isinstance(first, Separated) and few.margin[0] == first.margin


def test_groups_of_rotations_are_found_among_distinct_ones_on_any_threads() -> None:
    random = np.random.default_rng(6)
    body = ConvexPolyhedron(random.normal(size=(6, 3)))
    counts = {0: 700, 1: 800, 2: 3}
    which = np.concatenate([np.full(n, k) for k, n in counts.items()] + [np.full(40_000, -1)])
    random.shuffle(which)
    starts = np.concatenate(
        [random.uniform(-3, 3, (len(which), 3)), random.normal(size=(len(which), 4))], axis=1
    )
    starts[:, 3:] /= np.linalg.norm(starts[:, 3:], axis=1, keepdims=True)
    for k in counts:
        starts[which == k, 3:] = starts[np.argmax(which == k), 3:]

    def columns(rows: Any, threads: int) -> list[Any]:
        found = cast_many(body, CUBE, AHEAD, moving_pose=starts[rows], threads=threads)
        return [found.translation, found.normal, found.translation_lower, found.margin]

    every = columns(slice(None), 1)
    for one, other in zip(every, columns(slice(None), 3), strict=True):
        np.testing.assert_array_equal(one, other)
    # Each group has the answers that it has alone, a row without a group those of few rows.
    for k, n in counts.items():
        rows = np.flatnonzero(which == k)
        assert len(rows) == n
        for one, other in zip(every, columns(rows, 1), strict=True):
            np.testing.assert_array_equal(one[rows], other)
    distinct = np.flatnonzero(which == -1)[:200]
    for one, other in zip(every, columns(distinct, 1), strict=True):
        np.testing.assert_array_equal(one[distinct], other)
    # The faces of a group have other margins than the search.
    rows = np.flatnonzero(which == 0)
    few = columns(rows[:50], 1)[3]
    apart = ~np.isnan(few)
    assert apart.any() and np.any(few[apart] != every[3][rows[:50]][apart])
