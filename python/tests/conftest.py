"""Shared fixtures: the command line, and random queries from a seed."""

import json
import subprocess
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pytest
from numpy.typing import NDArray

from colltrans import ConvexPolyhedron

ROOT = Path(__file__).parents[2]
Floats: TypeAlias = NDArray[np.float64]
Batch: TypeAlias = Callable[[Iterable[dict[str, Any]]], list[dict[str, Any]]]


@pytest.fixture(scope="session")
def cli() -> Path:
    """Builds the program ``colltrans`` from this checkout and returns its path."""
    build = ["cargo", "build", "--release", "--bin", "colltrans", "--message-format=json"]
    told = subprocess.run(build, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    messages = map(json.loads, told.splitlines())
    (program,) = (m["executable"] for m in messages if m.get("executable"))
    return Path(program)


@pytest.fixture(scope="session")
def batch(cli: Path) -> Batch:
    """Returns the answers of ``colltrans batch``."""

    def ask(queries: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
        lines = "".join(json.dumps(query) + "\n" for query in queries)
        command: list[str | Path] = [cli, "batch", "-"]
        told = subprocess.run(command, input=lines, capture_output=True, text=True, cwd=ROOT)
        return [json.loads(line) for line in told.stdout.splitlines()]

    return ask


@dataclass(frozen=True)
class Settings:
    """Random queries as arrays: clouds of points; for each query two bodies, poses, a direction."""

    clouds: list[Floats]
    moving: NDArray[np.int64]
    fixed: NDArray[np.int64]
    moving_pose: Floats
    fixed_pose: Floats
    direction: Floats

    def __len__(self) -> int:
        return len(self.moving)

    def bodies(self) -> list[ConvexPolyhedron]:
        return [ConvexPolyhedron(cloud) for cloud in self.clouds]

    def lines(self, **more: Any) -> Iterable[dict[str, Any]]:
        """Returns the queries as input of ``colltrans batch``."""
        for i in range(len(self)):
            yield {
                "moving": {"points": self.clouds[self.moving[i]].tolist()},
                "fixed": {"points": self.clouds[self.fixed[i]].tolist()},
                "moving_pose": _pose(self.moving_pose[i]),
                "fixed_pose": _pose(self.fixed_pose[i]),
                "direction": self.direction[i].tolist(),
                **more,
            }


def _pose(row: Floats) -> dict[str, list[float]]:
    return {"translation": row[:3].tolist(), "rotation": row[3:].tolist()}


def draw(seed: int, count: int) -> Settings:
    """Draws queries; half have ties: cubes on a grid, moved along axes, turned by 0 or 90 deg."""
    random = np.random.default_rng(seed)
    cube = np.stack(np.meshgrid([0.0, 1], [0.0, 1], [0.0, 1]), axis=-1).reshape(-1, 3)
    clouds = [cube, cube * [4, 4, 1] - [2, 2, 0]]
    clouds += [random.normal(size=(n, 3)) for n in (1, 2, 3, 4, 8, 30, 200)]
    half = count // 2
    moving = np.r_[random.integers(0, 2, half), random.integers(0, 9, count - half)]
    fixed = np.r_[random.integers(0, 2, half), random.integers(2, 9, count - half)]
    quarter = np.array([[0, 0, 0, 1], [0, 0, 0.5**0.5, 0.5**0.5]])[random.integers(0, 2, half)]
    turned = random.normal(size=(2, count - half, 4))
    turned /= np.linalg.norm(turned, axis=-1, keepdims=True)
    spread = random.normal(size=(2, count - half, 3)) * [[[2.0]], [[0.5]]]
    grid = random.integers(-6, 7, size=(half, 3)) / 2
    along = np.eye(3)[random.integers(0, 3, half)] * random.choice([-1.0, 2.0], (half, 1))
    return Settings(
        clouds,
        moving,
        fixed,
        np.hstack([np.r_[grid, spread[0]], np.r_[quarter, turned[0]]]),
        np.hstack([np.r_[np.zeros((half, 3)), spread[1]], np.r_[quarter[::-1], turned[1]]]),
        np.r_[along, random.normal(size=(count - half, 3))],
    )
