"""Robots on joint paths: their links and bodies that first meet, single and in rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from colltrans import _colltrans
from colltrans._colltrans import ConvexPolyhedron, PathContact, Robot, Solid
from colltrans.errors import InputError
from colltrans.queries import Floats, Shape, checked_threads
from colltrans.table import TimeColumns

__all__ = ["PathColumns", "PathContact", "Robot", "path_many"]

#: Rows of joint values, or the name of a file with such rows.
Path: TypeAlias = ArrayLike | str | PathLike[str]

#: The integer columns.
POSITIONS = ("row", "first", "second")


@dataclass(frozen=True)
class PathQueries:
    """The arguments of a call of :func:`path_many`."""

    robot: Robot
    paths: list[Any]
    scene: Mapping[str, ConvexPolyhedron | Solid] | None
    ignore: list[tuple[str, str]]
    min_gap: float
    joints: dict[str, float]
    columns: list[str] | None
    times: list[Any] | None

    @property
    def shape(self) -> Shape:
        return (len(self.paths),)

    def ask_all(self, columns: list[str], threads: int | None) -> dict[str, Any]:
        (found, outcomes, errors), bodies = _colltrans.ask_paths(
            self.robot,
            self.paths,
            self.scene,
            self.ignore,
            self.min_gap,
            self.joints,
            self.columns,
            self.times,
            columns,
            threads,
        )
        whole = {name: np.nan_to_num(found[name], nan=-1).astype(np.int64) for name in POSITIONS}
        names = {"outcomes": tuple(outcomes), "bodies": tuple(bodies)}
        return {**found, **whole, **names, "errors": errors, "_queries": self}

    def ask(self, question: Any, i: int) -> Any:
        """Answers a single query."""
        return question(
            self.robot,
            self.paths[i],
            self.scene,
            ignore=self.ignore,
            min_gap=self.min_gap,
            joints=self.joints,
            columns=self.columns,
            times=None if self.times is None else self.times[i],
        )


@dataclass(frozen=True, eq=False, repr=False)
class PathColumns(TimeColumns[PathContact]):
    """The answers of :func:`path_many`; see :class:`Table`.

    Attributes
    ----------
    lower, upper : ndarray of shape (N,)
        Proven bounds of the times of first contacts: no two bodies meet before the first one, and
        two meet at the second one. The first one is the end of the path if none meet. The second
        one is infinite if none meet or no contact is proven.
    row : ndarray of int64, shape (N,)
        The row before the contact; -1 without a contact.
    share : ndarray of shape (N,)
        The fraction of the step to the next row at the contact.
    first, second : ndarray of int64, shape (N,)
        The two bodies that meet, as indices into ``bodies``; -1 if none meet.
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the first body to the second.
    point : ndarray of shape (N, 3)
        The point of the first body that is nearest to the second, in the world.
    bodies : tuple of str
        The names of all bodies: of the links, then of the scene.
    """

    row: NDArray[np.int64]
    share: Floats
    first: NDArray[np.int64]
    second: NDArray[np.int64]
    normal: Floats
    point: Floats
    bodies: tuple[str, ...]

    _question = staticmethod(Robot.first_contact)


def path_many(
    robot: Robot,
    paths: Sequence[Path] | NDArray[Any],
    scene: Mapping[str, ConvexPolyhedron | Solid] | None = None,
    *,
    ignore: Sequence[tuple[str, str]] = (),
    min_gap: float = 0.0,
    joints: Mapping[str, float] | None = None,
    columns: Sequence[str] | None = None,
    times: Sequence[ArrayLike] | None = None,
    threads: int | None = None,
) -> PathColumns:
    """Runs :meth:`Robot.first_contact` for many paths of one robot.

    Parameters
    ----------
    robot : Robot
    paths : array_like of shape (N, K, J), or sequence of paths
        See :meth:`Robot.first_contact`. Paths may have different numbers of rows.
    scene, ignore, min_gap, joints, columns
        See :meth:`Robot.first_contact`; one value for all paths.
    times : sequence of array_like, optional
        The times of the rows of each path.
    threads : int, optional
        Number of threads; by default the number of processors.

    Returns
    -------
    PathColumns

    Raises
    ------
    InputError
        An argument is not an array, or a name is unknown. A path that does not fit the robot is an
        error of its row.

    Examples
    --------
    >>> import numpy as np
    >>> from colltrans import Robot, read
    >>> from colltrans.robots import path_many
    >>> arm, wire = Robot.read("data/arm.urdf"), read("data/wire.obj")
    >>> turns = np.linspace(-0.4, 1.2, 9)
    >>> paths = [[[-0.6, 0.0, 0.1], [angle, 0.5, 0.1]] for angle in turns]
    >>> found = path_many(arm, paths, {"wire": wire})
    >>> found
    PathColumns(9 rows: 6 contact, 3 free)
    """
    paths = list(paths)
    if times is not None and len(times) != len(paths):
        raise InputError(f"times: {len(times)} arrays for {len(paths)} paths")
    queries = PathQueries(
        robot=robot,
        paths=paths,
        scene=scene,
        ignore=[(a, b) for a, b in ignore],
        min_gap=float(min_gap),
        joints=dict(joints or {}),
        columns=None if columns is None else list(columns),
        times=None if times is None else list(times),
    )
    return PathColumns(**queries.ask_all(PathColumns._columns(), checked_threads(threads)))
