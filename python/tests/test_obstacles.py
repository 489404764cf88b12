"""Tests one body among many: numbers, single queries, rows, threads, bad input."""

import math
import subprocess
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from colltrans import (
    Blocked,
    ColltransError,
    ConvexPolyhedron,
    InputError,
    Obstacles,
    Pose,
    Solid,
    check,
    clearance,
)
from colltrans.errors import CaseError, QueryError

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
DOWN = [0, 0, -1]


def shelf(n: int = 200) -> tuple[Obstacles, np.ndarray]:
    rng = np.random.default_rng(5)
    places = rng.uniform(0, 20, (n, 3))
    obstacles = Obstacles()
    assert obstacles.add_many(CUBE, places) == list(range(n))
    return obstacles, places


def test_numbers_stay_valid() -> None:
    obstacles = Obstacles()
    first, second = obstacles.add(CUBE), obstacles.add(CUBE, [3, 0, 0])
    assert (first, second, len(obstacles), first in obstacles) == (0, 1, 2, True)
    obstacles.remove(first)
    assert first not in obstacles
    assert obstacles.add(CUBE, [9, 0, 0]) == 2
    assert obstacles.pose(second).translation.tolist() == [3, 0, 0]
    obstacles.set_pose(second, Pose([4, 0, 0]))
    found = obstacles.nearest(CUBE)
    assert found is not None
    assert found.obstacle == second
    assert found.lower <= 3 <= found.upper
    assert found.normal is not None
    assert found.normal.tolist() == [1, 0, 0]
    assert repr(obstacles) == "Obstacles(2)"
    for gone in (first, 77):
        with pytest.raises(KeyError, match="there is no obstacle"):
            obstacles.remove(gone)
        with pytest.raises(KeyError):
            obstacles.set_pose(gone, [0, 0, 0])
        with pytest.raises(KeyError):
            obstacles.pose(gone)
        with pytest.raises(KeyError):
            obstacles.set_poses([second, gone], np.zeros((2, 3)))
    assert obstacles.pose(second).translation.tolist() == [4, 0, 0]


def test_answers_save_their_proofs(cli: Path, tmp_path: Path) -> None:
    obstacles, places = shelf(40)
    ball = obstacles.add(Solid.from_pieces([CUBE]), [40, 0, 0])
    where = [10, 10, 30]
    answers: dict[str, Any] = {
        "none is nearer": obstacles.nearest(CUBE, where),
        "farther": obstacles.within(CUBE, 20, where),
        "none stops": obstacles.clearance(CUBE, DOWN, where),
        "0.25 away or nearer": obstacles.clearance(CUBE, DOWN, where, min_gap=0.25),
        "none ever": obstacles.clearance(CUBE, [0, 0, 1], where, ignore=[ball]),
    }
    for said, answer in answers.items():
        answer.verify()
        saved = tmp_path / "proof.json"
        answer.save_proof(saved)
        told = subprocess.run([cli, "verify", saved], capture_output=True, text=True, check=True)
        assert told.stdout.startswith("holds") and said in told.stdout, told.stdout
        report = check.check(answer.proof_json())
        assert report.holds and not report.partly
        text = answer.proof_json().replace("10.0,10.0,30.0", "10.0,10.0,29.0")
        if said != "none ever":
            with pytest.raises(check.RefusedError):
                check.check(text)
    closer, undecided = answers["farther"]
    assert closer == answers["farther"].closer and undecided == [] == answers["farther"][1]
    # The statement makes no claim about other obstacles.
    obstacles.set_pose(ball, [50, 0, 0])
    for answer in answers.values():
        with pytest.raises(CaseError, match="the obstacles have changed"):
            answer.verify()
    nearest = obstacles.nearest(CUBE, [60, 0, 0])
    assert nearest is not None and nearest.obstacle == ball
    assert check.check(nearest.proof_json()).partly
    assert len(places) == 40


def test_casts_equal_those_of_single_queries() -> None:
    obstacles, places = shelf()
    rng = np.random.default_rng(6)
    for at in rng.uniform(0, 20, (20, 3)):
        singly = [clearance(CUBE, CUBE, DOWN, moving_pose=at, fixed_pose=to) for to in places]
        found = obstacles.clearance(CUBE, DOWN, at)
        if any(one.distance is None for one in singly):
            assert (found.outcome, found.distance) == ("overlapping", None)
            continue
        blocked = [
            (one.contact.certificate.upper, k)
            for k, one in enumerate(singly)
            if isinstance(one, Blocked)
        ]
        assert found.outcome == ("blocked" if blocked else "free")
        if blocked:
            upper, obstacle = min(blocked)
            assert (found.upper, found.obstacle) == (upper, obstacle)
        else:
            assert (found.distance, found.obstacle) == (math.inf, None)


def test_rows_have_the_bits_of_single_answers() -> None:
    obstacles, _ = shelf()
    rng = np.random.default_rng(7)
    poses, directions = rng.uniform(0, 20, (300, 3)), rng.normal(size=(300, 3))
    ignore = {3, 5}
    for threads in (1, 3, None):
        near = obstacles.nearest_many(CUBE, poses, ignore=ignore, threads=threads)
        casts = obstacles.clearance_many(CUBE, directions, poses, ignore=ignore, threads=threads)
        assert near["on_fixed"].shape == (300, 3)
        for k in range(300):
            one = obstacles.nearest(CUBE, poses[k], ignore=ignore)
            assert one is not None
            assert (near["obstacle"][k], near["lower"][k], near["upper"][k]) == (
                one.obstacle,
                one.lower,
                one.upper,
            )
            stop = obstacles.clearance(CUBE, directions[k], poses[k], ignore=ignore)
            assert casts["obstacle"][k] == (-1 if stop.obstacle is None else stop.obstacle)
            assert casts.outcome[k] == stop.outcome
            if stop.distance is not None:
                assert casts["distance"][k] == stop.distance
        single = obstacles.clearance(CUBE, directions[7], poses[7], ignore=ignore)
        assert repr(casts[7]) == repr(single)
    same = obstacles.clearance_many(CUBE, DOWN, poses, before=0.5)
    assert (same.distance[same.where("free")] == 0.5).all()
    none = Obstacles().nearest_many(CUBE, poses)
    assert none.counts() == {"none": 300} and none.obstacle.tolist() == [-1] * 300
    assert none[0] is None
    obstacles.set_pose(0, [9, 9, 9])
    obstacles.set_poses(range(1, 200), np.zeros((199, 3)))
    with pytest.raises(ColltransError, match="modified since"):
        near[0]


def test_placed_bodies_are_inserted_and_queried() -> None:
    obstacles = Obstacles()
    first = obstacles.add(CUBE.at([3, 0, 0]))
    more = obstacles.add_many([CUBE.at([6, 0, 0]), CUBE.at(Pose([9, 0, 0]))])
    assert [obstacles.pose(k).translation[0] for k in (first, *more)] == [3, 6, 9]
    nearest = obstacles.nearest(CUBE.at([7.75, 0, 0]))
    assert nearest is not None and nearest.obstacle == more[1]
    assert nearest.lower <= nearest.value <= nearest.upper and 0.24 < nearest < 0.26
    assert obstacles.within(CUBE.at([12, 0, 0]), 2.5).closer == [more[1]]
    free = obstacles.clearance(CUBE.at([0, 0, 0]), [-1, 0, 0])
    stopped = obstacles.clearance(CUBE.at([0, 0, 0]), [1, 0, 0])
    assert float(free) == math.inf and 1.9 < stopped <= 2
    with pytest.raises(InputError, match="has a pose already"):
        obstacles.add(CUBE.at([3, 0, 0]), [1, 0, 0])


def test_obstacles_within_a_length_are_found() -> None:
    obstacles = Obstacles()
    obstacles.add_many([CUBE, CUBE, CUBE], [[2, 0, 0], [9, 0, 0], [0, 3, 0]])
    assert obstacles.within(CUBE, 1.5) == ([0], [])
    assert obstacles.within(CUBE, 2.5) == ([0, 2], [])
    assert obstacles.within(CUBE, 2.5, ignore=[0]) == ([2], [])
    # Exactly as far.
    assert obstacles.within(CUBE, 2) == ([0], [2])


def test_solids_and_convex_bodies_together() -> None:
    step = Solid.from_pieces([CUBE, ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 3])])
    obstacles = Obstacles()
    obstacles.add(step, [0.5, 0, 0])
    obstacles.add(CUBE)
    assert obstacles.clearance(CUBE, DOWN, [0, 0, 9]).obstacle == 0
    assert obstacles.clearance(step, DOWN, [-0.6, 0, 9]).obstacle == 1


def test_bad_input_is_refused() -> None:
    obstacles, _ = shelf(3)
    with pytest.raises(QueryError, match="length"):
        obstacles.within(CUBE, -1)
    with pytest.raises(QueryError, match="direction"):
        obstacles.clearance(CUBE, [0, 0, 0])
    rows = obstacles.clearance_many(CUBE, [[0, 0, 1], [0, 0, 0]], np.zeros((2, 3)))
    assert rows.outcome[1] == "error" and "the direction" in rows.errors[1]
    with pytest.raises(InputError):
        obstacles.clearance_many(CUBE, np.ones((3, 3)), np.zeros((2, 3)))
    with pytest.raises(InputError):
        obstacles.add_many([CUBE, CUBE], np.zeros((3, 3)))
    with pytest.raises(TypeError, match="body: neither"):
        obstacles.add("a cube")  # type: ignore[arg-type]
    obstacles.add(Solid.from_pieces([CUBE]))
    found = obstacles.nearest(ConvexPolyhedron([[-50, 0, 0]]))
    assert found is not None
    assert found.lower <= 50 <= found.upper


def test_threads_can_query_while_another_moves_obstacles() -> None:
    obstacles, places = shelf()
    wrong = []

    def ask() -> None:
        for _ in range(200):
            found = obstacles.nearest(CUBE, [50, 50, 50])
            if found is None or not found.lower <= found.upper:
                wrong.append(found)

    workers = [threading.Thread(target=ask) for _ in range(4)]
    for worker in workers:
        worker.start()
    for k in range(500):
        obstacles.set_pose(k % 200, places[(k * 7) % 200])
    for worker in workers:
        worker.join()
    assert not wrong
