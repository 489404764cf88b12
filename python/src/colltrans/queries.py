"""Arguments of queries in bulk, whatever was given: tables of one row, or of one for each query."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from colltrans import _arrays, _colltrans
from colltrans._colltrans import ConvexPolyhedron, Cta, Pose, Solid
from colltrans.errors import ColltransError, InputError

if TYPE_CHECKING:
    from colltrans._colltrans import HasMatrix

Floats: TypeAlias = NDArray[np.float64]
Bodies: TypeAlias = "ConvexPolyhedron | Sequence[ConvexPolyhedron | ColltransError]"
AnyBodies: TypeAlias = (
    "ConvexPolyhedron | Solid | Sequence[ConvexPolyhedron | Solid | ColltransError]"
)
Poses: TypeAlias = "ArrayLike | Pose | HasMatrix | None"
Solver: TypeAlias = Literal["auto", "cta", "portal"] | Cta
Question: TypeAlias = Literal["contact", "range", "clearance"]


@dataclass(frozen=True)
class Queries:
    """What was asked: tables with one row or as many as there are queries."""

    bodies: tuple[list[Any], list[Any]]
    indices: tuple[NDArray[np.int64] | None, NDArray[np.int64] | None]
    direction: Floats
    poses: tuple[Floats, Floats]
    graze_tolerance: Floats
    keep: Floats
    solver: Solver
    count: int

    def ask_all(self, question: Question, threads: int | None) -> dict[str, Any]:
        (moving, fixed), (moving_index, fixed_index) = self.bodies, self.indices
        columns, outcomes, errors = _colltrans.ask_many(
            self.count,
            question,
            (moving, moving_index),
            (fixed, fixed_index),
            self.direction,
            *self.poses,
            self.graze_tolerance,
            self.keep,
            self.solver,
            threads,
        )
        return {**columns, "outcomes": tuple(outcomes), "errors": errors, "_queries": self}

    def ask(self, question: Any, i: int) -> Any:
        """One of them, alone."""
        tolerance = float(row_of(self.graze_tolerance, i)[0])
        return self.ask_with(question, i, graze_tolerance=tolerance, solver=self.solver)

    def ask_with(self, question: Any, i: int, **choices: Any) -> Any:
        """One of them, alone, with the choices that its kind has."""
        moving, fixed = (
            bodies[0 if index is None else index[i]]
            for bodies, index in zip(self.bodies, self.indices, strict=True)
        )
        return question(
            moving,
            fixed,
            row_of(self.direction, i),
            moving_pose=row_of(self.poses[0], i),
            fixed_pose=row_of(self.poses[1], i),
            keep=float(row_of(self.keep, i)[0]),
            **choices,
        )


def row_of(table: Floats, i: int) -> Floats:
    """A row of a table of one for all or one for each; a matrix as one."""
    values: Floats = table[i if len(table) > 1 else 0]
    return values.reshape(-1, 4) if values.size > 7 else values


def refuse_solids(*sides: Any) -> None:
    if any(isinstance(body, Solid) for side in sides for body in listed(side)):
        raise TypeError("solids are asked for their clearance: clearance_many")


def listed(bodies: Any) -> Any:
    return [bodies] if isinstance(bodies, (ConvexPolyhedron, Solid)) else bodies


def queries_of(
    bodies: tuple[AnyBodies, AnyBodies],
    direction: ArrayLike,
    poses: tuple[Poses, Poses],
    indices: tuple[ArrayLike | None, ArrayLike | None],
    graze_tolerance: ArrayLike,
    keep: ArrayLike,
    solver: Solver,
    tolerance: Floats | None = None,
) -> Queries:
    """All arguments as tables, and how many rows they have together."""
    moving_bodies, moving_index = body_list(bodies[0], indices[0], "moving")
    fixed_bodies, fixed_index = body_list(bodies[1], indices[1], "fixed")
    tables = {
        "direction": _table(direction, "direction", 3),
        "moving_pose": pose_table(poses[0], "moving_pose"),
        "fixed_pose": pose_table(poses[1], "fixed_pose"),
        "graze_tolerance": column(graze_tolerance, "graze_tolerance"),
        "keep": column(keep, "keep"),
        "tolerance": np.zeros((1, 1)) if tolerance is None else tolerance,
    }
    return Queries(
        bodies=(moving_bodies, fixed_bodies),
        indices=(moving_index, fixed_index),
        direction=tables["direction"],
        poses=(tables["moving_pose"], tables["fixed_pose"]),
        graze_tolerance=tables["graze_tolerance"],
        keep=tables["keep"],
        solver=solver,
        count=count_of(tables, (moving_index, fixed_index)),
    )


def count_of(
    tables: dict[str, Floats], indices: tuple[NDArray[np.int64] | None, NDArray[np.int64] | None]
) -> int:
    """How many rows tables of one for all, or of one for each, have together."""
    rows = {name: len(table) for name, table in tables.items() if len(table) != 1}
    for name, index in zip(("moving_index", "fixed_index"), indices, strict=True):
        if index is not None:
            rows[name] = len(index)
    if len(set(rows.values())) > 1:
        found = ", ".join(f"{name} has {n} rows" for name, n in rows.items())
        raise InputError(f"arguments of different lengths: {found}")
    return next(iter(rows.values()), 1)


def body_list(
    bodies: AnyBodies, index: ArrayLike | None, name: str
) -> tuple[list[Any], NDArray[np.int64] | None]:
    alone = isinstance(bodies, (ConvexPolyhedron, Solid))
    all_bodies: list[Any] = list(listed(bodies))
    for body in all_bodies:
        if not isinstance(body, (ConvexPolyhedron, Solid, Exception)):
            raise TypeError(f"{name}: not a ConvexPolyhedron, but {type(body).__name__}")
    if index is None:
        return all_bodies, None if alone else np.arange(len(all_bodies))
    # A row that a masked array masks has no body.
    masked = isinstance(index, np.ma.MaskedArray)
    found = np.ma.filled(index, -1) if masked else np.asarray(index)
    if found.ndim != 1 or (found.size > 0 and found.dtype.kind not in "iu"):
        raise InputError(f"{name}_index: no row of whole numbers")
    if found.dtype == np.uint64 and found.size > 0 and found.max() > np.iinfo(np.int64).max:
        raise InputError(f"{name}_index: {found.max()} is too large")
    return all_bodies, np.require(found, np.int64, ["C", "A"])


def _table(values: ArrayLike, name: str, width: int) -> Floats:
    array = _arrays.floats(values, name)
    if array.ndim == 1:
        array = array.reshape(1, -1)
    if array.ndim != 2 or array.shape[1] != width:
        shape = np.shape(values)
        raise InputError(f"{name}: an array of shape {shape}, not ({width},) or (N, {width})")
    return array


def column(values: ArrayLike, name: str) -> Floats:
    array = _arrays.floats(values, name)
    if np.ndim(values) > 1:
        raise InputError(f"{name}: an array of shape {np.shape(values)}, not a number or (N,)")
    return array.reshape(-1, 1)


def pose_table(values: Poses, name: str) -> Floats:
    if values is None:
        return np.zeros((1, 3))
    matrices = hasattr(values, "as_matrix")
    array = _arrays.floats(values.as_matrix() if matrices else values, name)  # type: ignore[union-attr]
    if matrices and array.shape[-2:] == (3, 3):
        array = np.concatenate([array, np.zeros((*array.shape[:-1], 1))], axis=-1)
    shape = array.shape
    if shape in ((3, 4), (4, 4)):
        return array.reshape(1, -1)
    if len(shape) == 3 and shape[1:] in ((3, 4), (4, 4)):
        return array.reshape(len(array), -1)
    if len(shape) in (1, 2) and shape[-1] in (3, 7):
        return array.reshape(-1, shape[-1])
    raise InputError(
        f"{name}: an array of shape {shape}, not (3,), (7,), (3, 4) or (4, 4), "
        "nor a row of that for each query"
    )


def cores() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def checked_threads(threads: int | None) -> int | None:
    if threads is not None and (not isinstance(threads, (int, np.integer)) or threads < 1):
        raise InputError(f"threads: {threads!r} is not a whole number from 1")
    return None if threads is None else int(threads)
