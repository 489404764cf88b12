"""Tests assemblies in child processes with every start method, and in threads."""

import multiprocessing
import threading
from pathlib import Path

import pytest

from colltrans import Assembly

GEARBOX = Path(__file__).parents[2] / "data" / "gearbox_small"
#: Seconds after which a child counts as hanging. A plan takes one second.
PATIENCE = 120


def plan_in_child(steps: int) -> None:
    assert len(Assembly.read(GEARBOX).plan().steps) == steps


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_a_child_process_plans_after_its_parent_has_planned(method: str) -> None:
    steps = len(Assembly.read(GEARBOX).plan().steps)
    child = multiprocessing.get_context(method).Process(target=plan_in_child, args=(steps,))  # type: ignore[attr-defined]
    child.start()
    child.join(PATIENCE)
    ended = child.exitcode
    child.kill()
    assert ended == 0


def test_threads_plan_at_once() -> None:
    found: list[int] = []

    def plan() -> None:
        found.append(len(Assembly.read(GEARBOX).plan().steps))

    threads = [threading.Thread(target=plan) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE)
    assert len(found) == 4 and len(set(found)) == 1
