"""How one body leaves another: all free directions, and paths of several moves."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from colltrans._colltrans import FreeDirections, WaysOut, free_directions, ways_out
from colltrans.queries import AnyBodies, Floats, Poses, column, queries_of
from colltrans.rows import RowColumns

__all__ = [
    "FreeColumns",
    "FreeDirections",
    "WaysOut",
    "free_directions",
    "free_directions_many",
    "ways_out",
]


@dataclass(frozen=True, eq=False, repr=False)
class FreeColumns(RowColumns[FreeDirections]):
    """The answers of :func:`free_directions_many`; see :class:`Table`.

    Attributes
    ----------
    free_lower, free_upper : ndarray of shape (N,)
        Proven bounds of the share of all directions that is free, without the undecided ones.
    undecided : ndarray of shape (N,)
        An upper bound of the share of directions that are undecided.
    regions, arcs, points : ndarray of shape (N,)
        The numbers of connected regions, and of arcs and single directions that border no region.
    direction : ndarray of shape (N, 3)
        A direction in the largest region, nearly the farthest from its border; NaN without a
        region.
    """

    free_lower: Floats
    free_upper: Floats
    undecided: Floats
    regions: Floats
    arcs: Floats
    points: Floats
    direction: Floats

    _question = staticmethod(free_directions)
    _outcomes = ("free", "blocked", "undecided", "error")

    @staticmethod
    def _values(answer: Any) -> dict[str, Any]:
        lower, upper = answer.free_share
        regions = answer.regions
        return {
            "outcome": answer.outcome,
            "free_lower": lower,
            "free_upper": upper,
            "undecided": answer.undecided_share,
            "regions": len(regions),
            "arcs": len(answer.arcs),
            "points": len(answer.points),
            "direction": regions[0]["center"] if regions else None,
        }


def free_directions_many(
    moving: AnyBodies,
    fixed: AnyBodies,
    *,
    moving_pose: Poses = None,
    fixed_pose: Poses = None,
    moving_index: ArrayLike | None = None,
    fixed_index: ArrayLike | None = None,
    tolerance: ArrayLike | None = None,
    ignore_start_overlaps: bool = False,
    depth: int = 26,
    looks: int = 20_000_000,
    threads: int | None = None,
) -> FreeColumns:
    """Runs :func:`free_directions` for every row.

    Parameters
    ----------
    moving, fixed, moving_pose, fixed_pose, moving_index, fixed_index, threads
        See :func:`distance_many`.
    tolerance : float or array_like of shape (N,), optional
        See :func:`free_directions`.
    ignore_start_overlaps, depth, looks
        See :func:`free_directions`; one value for all rows.

    Returns
    -------
    FreeColumns

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron
    >>> from colltrans.removal import free_directions_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> columns = free_directions_many(cube, cube, moving_pose=[[0, 0, 1], [1, 1, 1], [0, 0, 0.5]])
    >>> columns
    FreeColumns(3 rows: 2 free, 1 error)
    >>> bool(columns.free_lower[0] <= 0.5 <= columns.free_upper[0]), columns.direction[0].tolist()
    (True, [0.0, 0.0, 1.0])
    """
    poses, indices = (moving_pose, fixed_pose), (moving_index, fixed_index)
    tables = {"tolerance": column(tolerance, "tolerance")}
    chosen = {"ignore_start_overlaps": ignore_start_overlaps, "depth": depth, "looks": looks}
    queries = queries_of((moving, fixed), poses, indices, tables, **chosen)
    return FreeColumns._ask(queries, False, threads)
