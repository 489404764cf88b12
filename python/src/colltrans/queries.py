"""Arguments of bulk queries, converted to tables of one row, or of one row for each query.

Arguments may have any number of axes and are broadcast like arrays of numpy. The rows of the result
are the queries, in C order.
"""

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from colltrans import _arrays, _colltrans
from colltrans._colltrans import ConvexPolyhedron, Cta, Motion, Placed, Pose, Solid
from colltrans.errors import ColltransError, InputError, RoundedPoseWarning

if TYPE_CHECKING:
    from colltrans._colltrans import HasMatrix

Floats: TypeAlias = NDArray[np.float64]
Shape: TypeAlias = tuple[int, ...]
#: The body index of each row; None if there is only one body.
Index: TypeAlias = NDArray[np.int64] | None
Bodies: TypeAlias = "ConvexPolyhedron | Sequence[ConvexPolyhedron | ColltransError]"
AnyBodies: TypeAlias = (
    "ConvexPolyhedron | Solid | Placed"
    " | Sequence[ConvexPolyhedron | Solid | Placed | ColltransError]"
)
Poses: TypeAlias = "ArrayLike | Pose | HasMatrix | Sequence[Any] | None"
Solver: TypeAlias = Literal["auto", "cta", "portal"] | Cta
#: Arguments that precede the poses.
POSITIONAL = ("direction", "moving_motion", "fixed_motion")
#: The two bodies of a query.
SIDES = ("moving", "fixed")


class Stack(NamedTuple):
    """The rows of an argument, and the axes that they had."""

    rows: NDArray[Any]
    shape: Shape


@dataclass(frozen=True)
class Queries:
    """A bulk query: bodies, and the other arguments by name."""

    bodies: tuple[list[Any], list[Any]]
    indices: tuple[Index, Index]
    #: For each argument one row for all queries or one for each. NaN as a tolerance is the
    #: default.
    tables: dict[str, Floats | list[Motion]]
    #: Arguments with one value for all queries.
    choices: dict[str, Any]
    shape: Shape

    @property
    def count(self) -> int:
        return int(np.prod(self.shape))

    def ask_all(
        self, question: str, columns: list[str], features: bool, threads: int | None
    ) -> dict[str, Any]:
        """Answers all queries and returns the requested columns."""
        moving, fixed = zip(self.bodies, self.indices, strict=True)
        solver = self.choices.get("solver", "auto")
        found, outcomes, errors = _colltrans.ask_many(
            question, self.count, moving, fixed, self.tables, solver, columns, features, threads
        )
        return {**found, "outcomes": tuple(outcomes), "errors": errors, "_queries": self}

    def ask(self, question: Any, i: int) -> Any:
        """Answers a single query."""
        bodies = (self._body(side, i) for side in (0, 1))
        arguments = {name: argument(name, table, i) for name, table in self.tables.items()}
        for side in SIDES:
            if (motion := arguments.get(f"{side}_motion")) is not None:
                pose = arguments.pop(f"{side}_pose")
                if not isinstance(motion, Motion):
                    arguments[f"{side}_motion"] = _motion_of(motion, pose)
        given = {name: value for name, value in arguments.items() if value is not None}
        return question(*bodies, **given, **self.choices)

    def _body(self, side: int, i: int) -> Any:
        listed, index = self.bodies[side], self.indices[side]
        which = 0 if index is None else int(index[i])
        if not 0 <= which < len(listed):
            raise InputError(f"{SIDES[side]}: no body {which} among {len(listed)}")
        if isinstance(listed[which], Exception):
            raise InputError(f"{SIDES[side]}: {listed[which]}")
        return listed[which]


def argument(name: str, table: Floats | list[Motion], i: int) -> Any:
    """Returns the argument of one query; None stands for the default."""
    row: Any = table[i if len(table) > 1 else 0]
    if isinstance(row, Motion):
        return row
    if row.size == 1:
        return None if name == "tolerance" and np.isnan(row[0]) else float(row[0])
    return row.reshape(-1, 4) if name.endswith("pose") and row.size > 7 else row


def _motion_of(row: Floats, pose: Floats) -> Motion:
    """Returns the motion of 3 (slide), 8 (screw) or 9 numbers (throw)."""
    if len(row) == 3:
        return Motion.slide(row, pose=pose)
    if len(row) == 8:
        angle, rise = float(row[6]), float(row[7])
        return Motion.screw(row[:3], row[3:6], radians=angle, rise=rise, pose=pose)
    return Motion.thrown(row[:3], row[3:6], row[6:], pose=pose)


def refuse_solids(*sides: Any) -> None:
    if has_solid(*sides):
        raise TypeError("contact ranges of solids are not answered; call cast_many")


def listed(bodies: Any) -> Any:
    return [bodies] if isinstance(bodies, (ConvexPolyhedron, Placed, Solid)) else bodies


def has_solid(*sides: Any) -> bool:
    """Checks whether a body of these arguments is a solid, placed or not."""
    bodies = (getattr(body, "body", body) for side in sides for body in listed(side))
    return any(isinstance(body, Solid) for body in bodies)


def _unplaced(bodies: Any, pose: Poses, side: str) -> tuple[Any, Poses]:
    """Separates placed bodies from their poses."""
    each = listed(bodies)
    if not any(isinstance(body, Placed) for body in each):
        return bodies, pose
    if pose is not None:
        raise InputError(f"{side}_pose: {side} has a pose already, from body.at(pose); drop one")
    if not all(isinstance(body, Placed) for body in each):
        raise InputError(f"{side}: either all bodies of a list have poses, or none")
    if each is not bodies:
        return bodies.body, bodies.pose
    return [body.body for body in each], [body.pose for body in each]


def queries_of(
    bodies: tuple[AnyBodies, AnyBodies],
    poses: tuple[Poses, Poses],
    indices: tuple[ArrayLike | None, ArrayLike | None],
    tables: Mapping[str, Stack],
    **choices: Any,
) -> Queries:
    """Converts all arguments to tables, with the axes of their broadcast."""
    sides = zip(SIDES, bodies, poses, indices, strict=True)
    listed, stacks, indexed = [], dict[str, Stack | None](), dict[str, Stack | None]()
    for side, given, at, index in sides:
        of_side, pose = _unplaced(given, at, side)
        all_bodies, indexed[f"{side}_index"] = body_list(of_side, index, side)
        listed.append(all_bodies)
        stacks[f"{side}_pose"] = pose_table(pose, f"{side}_pose")
    before = {name: tables[name] for name in POSITIONAL if name in tables}
    shape, rows = together({**before, **stacks, **tables, **indexed})
    return Queries(
        bodies=(listed[0], listed[1]),
        indices=indices_of(rows, shape),
        tables={
            name: table.reshape(-1).tolist() if table.dtype == object else table
            for name, table in rows.items()
            if name not in indexed
        },
        choices=choices,
        shape=shape,
    )


def together(stacks: Mapping[str, Stack | None]) -> tuple[Shape, dict[str, NDArray[Any]]]:
    """Broadcasts arguments; returns the common axes and the rows: one for all, or one for each."""
    given = {name: stack for name, stack in stacks.items() if stack is not None}
    try:
        shape = np.broadcast_shapes(*(stack.shape for stack in given.values())) or (1,)
    except ValueError:
        raise InputError(_apart(given)) from None
    count = int(np.prod(shape))
    rows = {}
    for name, (table, axes) in given.items():
        if len(table) != 1 and axes != shape:
            wide = np.broadcast_to(table.reshape(*axes, table.shape[1]), (*shape, table.shape[1]))
            table = np.ascontiguousarray(wide).reshape(count, table.shape[1])
        rows[name] = table
    return shape, rows


def _apart(given: Mapping[str, Stack]) -> str:
    """Explains why arguments cannot be broadcast."""
    told = {name: stack for name, stack in given.items() if np.prod(stack.shape) != 1}
    if all(len(stack.shape) == 1 for stack in told.values()):
        found = ", ".join(f"{name} has {len(stack.rows)} rows" for name, stack in told.items())
        return f"arguments of different lengths: {found}"
    found = ", ".join(f"{name} {stack.shape}" for name, stack in told.items())
    return f"arguments with axes that cannot be broadcast: {found}"


def indices_of(tables: Mapping[str, NDArray[Any]], shape: Shape) -> tuple[Index, Index]:
    """Returns the body index of each row of both sides; None if there is only one body."""
    count = int(np.prod(shape))

    def index(name: str) -> Index:
        if name not in tables:
            return None
        found = tables[name].reshape(-1)
        return found if len(found) == count else np.full(count, found[0])

    return index("moving_index"), index("fixed_index")


def body_list(
    bodies: AnyBodies, index: ArrayLike | None, name: str
) -> tuple[list[Any], Stack | None]:
    alone = isinstance(bodies, (ConvexPolyhedron, Solid))
    all_bodies: list[Any] = list(listed(bodies))
    for body in all_bodies:
        if not isinstance(body, (ConvexPolyhedron, Solid, Exception)):
            raise TypeError(f"{name}: not a ConvexPolyhedron, but {type(body).__name__}")
    if index is None:
        if alone:
            return all_bodies, None
        return all_bodies, Stack(np.arange(len(all_bodies)).reshape(-1, 1), (len(all_bodies),))
    # A row that is masked in a masked array has no body.
    masked = isinstance(index, np.ma.MaskedArray)
    found = np.ma.filled(index, -1) if masked else np.asarray(index)
    if found.ndim == 0 or (found.size > 0 and found.dtype.kind not in "iu"):
        raise InputError(f"{name}_index: not an array of whole numbers")
    if found.dtype == np.uint64 and found.size > 0 and found.max() > np.iinfo(np.int64).max:
        raise InputError(f"{name}_index: {found.max()} is too large")
    return all_bodies, Stack(np.require(found, np.int64, ["C", "A"]).reshape(-1, 1), found.shape)


def table(values: ArrayLike, name: str, width: int) -> Stack:
    array = _arrays.floats(values, name)
    if array.ndim == 0 or array.shape[-1] != width:
        shape = np.shape(values)
        raise InputError(f"{name}: an array of shape {shape}, not ({width},) or (N, {width})")
    return Stack(array.reshape(-1, width), array.shape[:-1])


def column(values: ArrayLike | None, name: str) -> Stack:
    """Returns a column with one number for each query; NaN stands for None."""
    array = _arrays.floats(np.nan if values is None else values, name)
    return Stack(array.reshape(-1, 1), array.shape)


def pose_table(values: Poses, name: str) -> Stack:
    """Reads rows of poses: numbers, or objects that describe poses."""
    if values is None:
        return Stack(np.zeros((1, 3)), ())
    given: Any = values
    matrices = hasattr(given, "as_matrix")
    if matrices:
        given = given.as_matrix()
    elif isinstance(given, (list, tuple)) and given:
        given = _numbers_of_poses(given, name)
    array = _arrays.floats(given, name)
    shape = array.shape
    if shape == (3, 3) and not matrices and is_rotation(array):
        told = "one rotation or three translations? Give Pose(matrix), or a list of three Pose"
        raise InputError(f"{name}: the array of shape (3, 3) is ambiguous: {told}")
    if shape[-2:] == (3, 3) and (matrices or len(shape) > 2):
        array = np.concatenate([array, np.zeros((*shape[:-1], 1))], axis=-1)
        shape = array.shape
    if shape[-2:] in ((3, 4), (4, 4)):
        table = array.reshape(-1, 4 * shape[-2])
        return Stack(nearest_rotations(table, name), shape[:-2])
    if shape and shape[-1] in (3, 7):
        return Stack(nearest_rotations(array.reshape(-1, shape[-1]), name), shape[:-1])
    raise InputError(
        f"{name}: an array of shape {shape}, not (3,), (7,), (3, 3), (3, 4) or (4, 4), "
        "nor a row of that for each query"
    )


def _numbers_of_poses(given: Sequence[Any], name: str) -> Any:
    """Converts a list of poses, or a pair of positions and quaternions, to numbers."""
    if _is_pair(given, 1):
        position, quaternion = (_arrays.floats(part, name) for part in given)
        axes = np.broadcast_shapes(position.shape[:-1], quaternion.shape[:-1])
        parts = (np.broadcast_to(part, (*axes, part.shape[-1])) for part in (position, quaternion))
        return np.concatenate(list(parts), axis=-1)
    if all(_is_pair(each, 0) for each in given):
        return np.array([np.concatenate(each) for each in given])
    if any(hasattr(each, "as_matrix") for each in given):
        return np.array([Pose(each).as_matrix() for each in given])
    return given


def _is_pair(given: Any, stacked: int) -> bool:
    """Checks for a position and a quaternion, or with ``stacked`` for arrays of them."""
    if not isinstance(given, (list, tuple)) or len(given) != 2:
        return False
    try:
        position, quaternion = (np.shape(part) for part in given)
    except ValueError:
        return False
    few = stacked or len(position) == len(quaternion) == 1
    return bool(few) and position[-1:] == (3,) and quaternion[-1:] == (4,)


def is_rotation(matrix: Floats) -> bool:
    """Checks whether a matrix is a rotation, up to few digits."""
    gram = np.nan_to_num(matrix) @ np.nan_to_num(matrix).T
    near = np.abs(gram - np.eye(3)).max() <= FEW_DIGITS
    return bool(near and np.linalg.det(np.nan_to_num(matrix)) > 0)


#: Range of defects of a rotation that is treated as one with few digits.
FEW_DIGITS, UNIT_LENGTH = 0.02, 1e-6


def nearest_rotations(table: Floats, name: str) -> Floats:
    """Replaces rotations with few digits by the nearest ones, with one warning for all rows.

    ``table`` has rows of 7, 12 or 16 numbers. Rows with a larger defect stay and are rejected
    later.
    """
    if table.shape[1] == 7:
        rotations = table[:, 3:]
        defects = np.abs(np.linalg.norm(rotations, axis=1) - 1)
    elif table.shape[1] > 7:
        rotations = table.reshape(len(table), table.shape[1] // 4, 4)[:, :3, :3]
        gram = np.einsum("nki,nkj->nij", rotations, rotations)
        defects = np.abs(gram - np.eye(3)).max(axis=(1, 2))
        defects[np.linalg.det(np.nan_to_num(rotations)) < 0] = 2
    else:
        return table
    rounded = (defects > UNIT_LENGTH) & (defects <= FEW_DIGITS)
    if not rounded.any():
        return table
    table = table.copy()
    if table.shape[1] == 7:
        table[rounded, 3:] /= np.linalg.norm(table[rounded, 3:], axis=1, keepdims=True)
    else:
        left, _, right = np.linalg.svd(rotations[rounded])
        wide = table[rounded].reshape(int(rounded.sum()), -1, 4)
        wide[:, :3, :3] = left @ right
        table[rounded] = wide.reshape(len(wide), -1)
    warnings.warn(
        f"{name}: {int(rounded.sum())} of {len(table)} rotations are off one by up to "
        f"{defects[rounded].max():.1e}; the nearest rotations are used, and directions may be off "
        "by as much",
        RoundedPoseWarning,
        stacklevel=2,
    )
    return table


def cores() -> int:
    """Returns the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def checked_threads(threads: int | None) -> int | None:
    if threads is not None and (not isinstance(threads, (int, np.integer)) or threads < 1):
        raise InputError(f"threads: {threads!r} is not a whole number from 1")
    return None if threads is None else int(threads)
