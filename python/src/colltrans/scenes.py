"""One body among many placed bodies: :class:`Obstacles`, its answers, and their columns."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from colltrans._colltrans import (
    ConvexPolyhedron,
    NearbyObstacles,
    NearestObstacle,
    ObstacleClearance,
    Obstacles,
    Solid,
)
from colltrans.queries import Floats, Poses, Shape, argument, checked_threads, pose_table, together
from colltrans.queries import table as vectors
from colltrans.table import Table, middle

__all__ = [
    "NearbyObstacles",
    "NearestColumns",
    "NearestObstacle",
    "ObstacleClearance",
    "ObstacleClearanceColumns",
    "Obstacles",
]


@dataclass(frozen=True)
class SceneQueries:
    """Queries of one body among obstacles; the arguments have one row for all, or one for each."""

    obstacles: Obstacles
    body: ConvexPolyhedron | Solid
    tables: dict[str, NDArray[Any]]
    choices: dict[str, Any]
    shape: Shape

    def ask(self, question: Any, i: int) -> Any:
        """Answers a single query."""
        arguments = {name: argument(name, table, i) for name, table in self.tables.items()}
        return question(self.obstacles, self.body, **arguments, **self.choices)


@dataclass(frozen=True, eq=False, repr=False)
class NearestColumns(Table[NearestObstacle | None]):
    """The answers of :meth:`Obstacles.nearest_many`; see :class:`Table`.

    Attributes
    ----------
    obstacle : ndarray of int64, shape (N,)
        The number of the nearest obstacle; -1 without obstacles.
    lower, upper : ndarray of shape (N,)
        Proven bounds of the distance.
    on_moving, on_fixed : ndarray of shape (N, 3)
        The nearest points of the body and of the obstacle, in the world.
    """

    obstacle: NDArray[np.int64]
    lower: Floats
    upper: Floats
    on_moving: Floats
    on_fixed: Floats

    _question = staticmethod(Obstacles.nearest)

    @property
    def value(self) -> Floats:
        """ndarray of shape (N,): The middle of both bounds."""
        return middle(self.lower, self.upper)

    def _is_row(self, answer: Any, i: int) -> bool:
        if answer is None:
            return bool(self.outcome[i] == "none")
        found = (answer.obstacle, answer.lower, answer.upper)
        return found == (self.obstacle[i], self.lower[i], self.upper[i])


@dataclass(frozen=True, eq=False, repr=False)
class ObstacleClearanceColumns(Table[ObstacleClearance]):
    """The answers of :meth:`Obstacles.clearance_many`; see :class:`Table`.

    Attributes
    ----------
    obstacle : ndarray of int64, shape (N,)
        The obstacle that stops the body; -1 if nothing does.
    distance : ndarray of shape (N,)
        The free travel, in multiples of the direction; NaN for an overlap.
    upper : ndarray of shape (N,)
        An upper bound of the translation at which the body is stopped; infinite if nothing stops
        it, NaN for an overlap.
    """

    obstacle: NDArray[np.int64]
    distance: Floats
    upper: Floats

    _question = staticmethod(Obstacles.clearance)

    @property
    def value(self) -> Floats:
        """ndarray of shape (N,): The free travel, ``distance``."""
        return self.distance

    @property
    def lower(self) -> Floats:
        """ndarray of shape (N,): The free travel, which is proven."""
        return self.distance

    def _is_row(self, answer: Any, i: int) -> bool:
        obstacle = -1 if answer.obstacle is None else answer.obstacle
        distance = np.nan if answer.distance is None else answer.distance
        same = np.array_equal([self.distance[i]], [distance], equal_nan=True)
        return same and (answer.outcome, obstacle) == (self.outcome[i], self.obstacle[i])


def _nearest_many(
    obstacles: Obstacles,
    body: ConvexPolyhedron | Solid,
    pose: Poses,
    ignore: Iterable[int],
    threads: int | None,
) -> NearestColumns:
    ignore = tuple(ignore)
    shape, tables = together({"pose": pose_table(pose, "pose")})
    rows = _flat_poses(tables["pose"])
    found = obstacles._nearest_rows(body, rows, ignore, checked_threads(threads))
    queries = SceneQueries(obstacles, body, tables, {"ignore": ignore}, shape)
    return NearestColumns(**_columns(found, queries))


def _clearance_many(
    obstacles: Obstacles,
    body: ConvexPolyhedron | Solid,
    direction: ArrayLike,
    pose: Poses,
    before: float | None,
    min_gap: float,
    ignore: Iterable[int],
    threads: int | None,
) -> ObstacleClearanceColumns:
    ignore = tuple(ignore)
    stacks = {"direction": vectors(direction, "direction", 3), "pose": pose_table(pose, "pose")}
    shape, tables = together(stacks)
    count = int(np.prod(shape))
    poses = np.broadcast_to(tables["pose"], (count, tables["pose"].shape[1]))
    found = obstacles._clearance_rows(
        body,
        tables["direction"],
        _flat_poses(poses),
        before,
        min_gap,
        ignore,
        checked_threads(threads),
    )
    chosen = {"before": before, "min_gap": min_gap, "ignore": ignore}
    queries = SceneQueries(obstacles, body, tables, chosen, shape)
    return ObstacleClearanceColumns(**_columns(found, queries))


def _flat_poses(rows: Floats) -> Floats:
    """Returns rows of poses in a shape that is read as poses: matrices have two axes."""
    return rows if rows.shape[1] < 12 else rows.reshape(len(rows), -1, 4)


def _columns(found: Any, queries: SceneQueries) -> dict[str, Any]:
    columns, outcomes, errors = found
    return {**columns, "outcomes": tuple(outcomes), "errors": errors, "_queries": queries}
