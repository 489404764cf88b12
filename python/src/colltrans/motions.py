"""Bodies that move in time: motions, their queries and answers, single and in rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from colltrans import _arrays, _colltrans
from colltrans._colltrans import (
    FirstContact,
    Motion,
    MotionCast,
    MotionClearance,
    motion,
    motion_clearance,
)
from colltrans.errors import InputError
from colltrans.queries import (
    AnyBodies,
    Floats,
    Poses,
    Queries,
    Stack,
    column,
    queries_of,
    together,
)
from colltrans.table import TimeColumns

__all__ = [
    "FirstContact",
    "Motion",
    "MotionCast",
    "MotionClearance",
    "MotionClearanceColumns",
    "MotionColumns",
    "motion",
    "motion_clearance",
    "motion_clearance_many",
    "motion_many",
]

#: One motion for all rows, one for each row, or a kind of motion with arrays of its numbers.
Motions: TypeAlias = Motion | Sequence[Motion] | Mapping[str, Mapping[str, ArrayLike]] | None

#: The kinds of motions given as arrays, and the width of each array.
KINDS: dict[str, dict[str, int]] = {
    "slide": {"by": 3},
    "turn": {"point": 3, "axis": 3, "radians": 1},
    "screw": {"point": 3, "axis": 3, "radians": 1, "rise": 1},
    "thrown": {"center": 3, "velocity": 3, "angular_velocity": 3},
}


@dataclass(frozen=True, eq=False, repr=False)
class MotionColumns(TimeColumns[FirstContact]):
    """The answers of :func:`motion_many`; see :class:`Table`.

    Attributes
    ----------
    lower, upper : ndarray of shape (N,)
        Proven bounds of the times of contacts, from 0 (start of the motion) to 1 (end): the bodies
        do not meet before the first one, and meet at the second one. The first one is 1 if they
        never meet. The second one is infinite if they never meet or no contact is proven.
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the moving body to the fixed one.
    point : ndarray of shape (N, 3)
        Contact points on the fixed body, in the world.
    """

    normal: Floats
    point: Floats

    _question, _name = staticmethod(_colltrans.motion), "motion"


@dataclass(frozen=True, eq=False, repr=False)
class MotionClearanceColumns(TimeColumns[MotionClearance]):
    """The answers of :func:`motion_clearance_many`; see :class:`Table`.

    Attributes
    ----------
    lower, upper : ndarray of shape (N,)
        The body can move until the first time. At the second time the stopping features meet in
        their nominal position, or after the tolerance is applied; infinite if neither is proven.
        Both are 1 if the body can move to the end, NaN if the bodies overlap at the start.
    least_tolerance : ndarray of shape (N,)
        The smallest tolerance without an overlap, for bodies that overlap at the start of the
        motion.
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the moving body to the fixed one.
    point : ndarray of shape (N, 3)
        Contact points on the fixed body, in the world.
    """

    least_tolerance: Floats
    normal: Floats
    point: Floats

    _question, _name = staticmethod(_colltrans.motion_clearance), "motion_clearance"

    @property
    def value(self) -> Floats:
        """ndarray of shape (N,): The time until which the body can move; NaN for an overlap."""
        return self.lower


def motion_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    moving_motion: Motions,
    fixed_motion: Motions = None,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    min_gap: ArrayLike = 0.0,
    tolerance: ArrayLike | None = None,
    features: bool = False,
    threads: int | None = None,
) -> MotionColumns:
    """Runs :func:`motion` for every row.

    Parameters
    ----------
    moving, fixed, moving_index, fixed_index, features, threads
        See :func:`distance_many`.
    moving_motion, fixed_motion : Motion, sequence of them, or dict
        The motions of the bodies: one motion for all rows, one for each row, or ``{"screw":
        {"point", "axis", "radians", "rise"}}``, ``{"turn": {"point", "axis", "radians"}}``,
        ``{"slide": {"by"}}`` or ``{"thrown": {"center", "velocity", "angular_velocity"}}`` with
        arrays of one row for all, or of one row for each. ``"degrees"`` may replace ``"radians"``.
        None stands for rest.
    moving_pose, fixed_pose : array_like, Pose or object with ``as_matrix()``, optional
        The start of motions that are given as arrays, or the pose of a body at rest; see
        :func:`cast_many`. Motion objects have their own pose.
    min_gap : float or array_like of shape (N,)
        A minimum gap, a length.
    tolerance : float or array_like of shape (N,), optional
        See :class:`MotionCast`.

    Returns
    -------
    MotionColumns

    Raises
    ------
    InputError
        The shapes of arrays do not fit together. Invalid numbers in a row are errors of that row.

    Examples
    --------
    >>> import numpy as np
    >>> from colltrans import ConvexPolyhedron, motion_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> angles = np.array([1, 2, 3, 4e5])
    >>> turn = {"turn": {"point": [0, 0, 0], "axis": [0, 0, 1], "radians": angles}}
    >>> columns = motion_many(cube, cube, turn, moving_pose=[2, 0, 0], fixed_pose=[-1, 2, 0])
    >>> columns
    MotionColumns(4 rows: 2 contact, 1 free, 1 error)
    >>> columns.lower.round(6)
    array([1.      , 0.553574, 0.36905 ,      nan])
    """
    sides = (
        (moving, moving_index, moving_motion, moving_pose),
        (fixed, fixed_index, fixed_motion, fixed_pose),
    )
    return MotionColumns._ask(_motions(sides, min_gap, tolerance), features, threads)


def motion_clearance_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    moving_motion: Motions,
    fixed_motion: Motions = None,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    min_gap: ArrayLike = 0.0,
    tolerance: ArrayLike | None = None,
    features: bool = False,
    threads: int | None = None,
) -> MotionClearanceColumns:
    """Runs :func:`motion_clearance` for every row.

    Parameters
    ----------
    moving, fixed, moving_motion, fixed_motion, moving_pose, fixed_pose
        See :func:`motion_many`, also for all other arguments and errors.

    Returns
    -------
    MotionClearanceColumns

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron
    >>> from colltrans.motions import motion_clearance_many
    >>> block = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> table = ConvexPolyhedron.cuboid([-4, -4, -1], [4, 4, 0])
    >>> ways = {"slide": {"by": [[1, 0, 0], [0, 0, 2], [0, 0, -1]]}}
    >>> motion_clearance_many(block, table, ways)
    MotionClearanceColumns(3 rows: 1 blocked, 2 free)
    """
    sides = (
        (moving, moving_index, moving_motion, moving_pose),
        (fixed, fixed_index, fixed_motion, fixed_pose),
    )
    return MotionClearanceColumns._ask(_motions(sides, min_gap, tolerance), features, threads)


#: The bodies of a side, the body index of each row, the motions and the poses.
Side: TypeAlias = tuple[AnyBodies, ArrayLike | None, Motions, Poses]


def _motions(sides: tuple[Side, Side], min_gap: ArrayLike, tolerance: ArrayLike | None) -> Queries:
    moving, fixed = sides
    tables = {
        "moving_motion": motion_table(moving[2], moving[3], "moving_motion"),
        "fixed_motion": motion_table(fixed[2], fixed[3], "fixed_motion"),
        "min_gap": column(min_gap, "min_gap"),
        "tolerance": column(tolerance, "tolerance"),
    }
    bodies, indices, poses = (moving[0], fixed[0]), (moving[1], fixed[1]), (moving[3], fixed[3])
    return queries_of(bodies, poses, indices, tables)


def motion_table(motions: Motions, pose: Poses, name: str) -> Stack:
    """Returns a table of motions, or of the numbers of motions of one kind."""
    if motions is None:
        return Stack(np.zeros((1, 3)), ())
    if isinstance(motions, Mapping):
        return numbers_of(motions, name)
    listed = [motions] if isinstance(motions, Motion) else list(motions)
    if any(not isinstance(motion, Motion) for motion in listed):
        raise TypeError(
            f"{name}: neither a Motion, nor a list of them, nor a dict of arrays{_instead(listed)}"
        )
    if pose is not None:
        raise InputError(f"{name}: a Motion has its own pose; drop the pose argument")
    table = np.empty((len(listed), 1), object)
    table[:, 0] = listed
    return Stack(table, () if isinstance(motions, Motion) else (len(listed),))


def _instead(listed: list[Any]) -> str:
    """Suggests an argument in place of bare vectors."""
    try:
        vectors = np.asarray(listed, float)
    except (TypeError, ValueError):
        return ""
    if vectors.ndim not in {1, 2} or vectors.shape[-1] != 3:
        return ""
    if vectors.ndim == 1:
        vector = vectors.tolist()
        slide = f"Motion.slide({vector}) moves the body by it"
        still = f"Motion.still({vector}) lets it rest there"
        return f"; three numbers could be a displacement or a position: {slide}, {still}"
    return '; {"slide": {"by": array}} moves the body by each row of an array'


def numbers_of(motions: Mapping[str, Mapping[str, ArrayLike]], name: str) -> Stack:
    """Returns the arrays of one kind of motion side by side."""
    if len(motions) != 1 or next(iter(motions)) not in KINDS:
        raise InputError(f"{name}: one of {', '.join(KINDS)}, not {', '.join(map(str, motions))}")
    ((kind, given),) = motions.items()
    known = KINDS[kind]
    if not isinstance(given, Mapping):
        parts_of_kind = ", ".join(f'"{part}": ...' for part in known)
        what = type(given).__name__
        raise InputError(f"{name}: {kind!r} takes a dict {{{parts_of_kind}}}, not a {what}")
    if "radians" in known and "degrees" in given and "radians" not in given:
        radians = np.radians(_arrays.floats(given["degrees"], f"{name}.degrees"))
        given = {**{part: given[part] for part in given if part != "degrees"}, "radians": radians}
    if given.keys() != known.keys():
        raise InputError(f"{name}: {kind!r} has {', '.join(known)}, not {', '.join(given)}")
    parts: dict[str, Stack | None] = {}
    for part, width in known.items():
        array = _arrays.floats(given[part], f"{name}.{part}")
        if width == 1:
            array = array[..., None]
        if array.ndim == 0 or array.shape[-1] != width:
            shape = np.shape(given[part])
            wanted = f"({width},) or (N, {width})"
            raise InputError(f"{name}.{part}: an array of shape {shape}, not {wanted}")
        parts[f"{name}.{part}"] = Stack(array.reshape(-1, width), array.shape[:-1])
    if kind == "turn":
        parts["rise"] = Stack(np.zeros((1, 1)), ())
    alone = all(stack is None or stack.shape == () for stack in parts.values())
    shape, tables = together(parts)
    count = int(np.prod(shape))
    wide = [np.broadcast_to(table, (count, table.shape[1])) for table in tables.values()]
    table = np.require(np.hstack(wide), np.float64, ["C", "A"])
    return Stack(table, () if alone else shape)
