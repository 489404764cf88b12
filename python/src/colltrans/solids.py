"""Casts and clearances of many pairs of solids, as columns."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from colltrans._colltrans import (
    SolidBlocked,
    SolidCast,
    SolidContact,
    SolidFree,
    SolidOverlapping,
)
from colltrans.queries import AnyBodies, Floats, Poses, Queries, column, queries_of, table
from colltrans.rows import RowColumns


def _cast(*bodies: Any, **arguments: Any) -> Any:
    return SolidCast(*bodies, **arguments).cast()


def _clearance(*bodies: Any, **arguments: Any) -> Any:
    return SolidCast(*bodies, **arguments).clearance()


@dataclass(frozen=True, eq=False, repr=False)
class SolidContactColumns(RowColumns[SolidContact | SolidFree]):
    """The answers of :func:`cast_many` about solids; see :class:`Table`.

    Attributes
    ----------
    translation : ndarray of shape (N,)
        The translation at which the bodies first meet, in multiples of the direction.
    translation_lower, translation_upper : ndarray of shape (N,)
        Proven bounds of the translation.
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the moving body to the fixed one.
    point : ndarray of shape (N, 3)
        Contact points, in the world.
    """

    translation: Floats
    translation_lower: Floats
    translation_upper: Floats
    normal: Floats
    point: Floats

    _question = staticmethod(_cast)
    _outcomes = ("contact", "free", "error")

    @property
    def value(self) -> Floats:
        """ndarray of shape (N,): ``translation``, infinite for bodies that never meet."""
        return np.where(self.outcome == "free", np.inf, self.translation)

    @property
    def lower(self) -> Floats:
        """ndarray of shape (N,): Proven lower bounds of ``value``."""
        return np.where(self.outcome == "free", np.inf, self.translation_lower)

    @property
    def upper(self) -> Floats:
        """ndarray of shape (N,): Proven upper bounds of ``value``."""
        return np.where(self.outcome == "free", np.inf, self.translation_upper)

    @staticmethod
    def _values(answer: Any) -> dict[str, Any]:
        if isinstance(answer, SolidFree):
            return {"outcome": "free", "normal": answer.normal}
        return {
            "outcome": "contact",
            "translation": answer.translation,
            "translation_lower": answer.lower,
            "translation_upper": answer.upper,
            "normal": answer.normal,
            "point": answer.point,
        }


@dataclass(frozen=True, eq=False, repr=False)
class SolidColumns(RowColumns[SolidBlocked | SolidFree | SolidOverlapping]):
    """The answers of :func:`clearance_many` about solids; see :class:`Table`.

    Attributes
    ----------
    distance : ndarray of shape (N,)
        The free travel, rounded down, in multiples of the direction; infinite if nothing blocks,
        NaN if the bodies overlap.
    translation : ndarray of shape (N,)
        The translation at which the stopping faces meet in their nominal position, in multiples of
        the direction.
    translation_lower, translation_upper : ndarray of shape (N,)
        Proven bounds of the translation.
    offset_distance : ndarray of shape (N,)
        The free travel of the bodies shrunk by half the tolerance each.
    offset_distance_lower, offset_distance_upper : ndarray of shape (N,)
        Proven bounds of ``offset_distance``.
    least_tolerance : ndarray of shape (N,)
        The smallest tolerance at which overlapping bodies would not overlap, a length.
    normal : ndarray of shape (N, 3)
        Unit normals, in the world, from the moving body to the fixed one.
    point : ndarray of shape (N, 3)
        Contact points, in the world.
    """

    distance: Floats
    translation: Floats
    translation_lower: Floats
    translation_upper: Floats
    offset_distance: Floats
    offset_distance_lower: Floats
    offset_distance_upper: Floats
    least_tolerance: Floats
    normal: Floats
    point: Floats

    _question = staticmethod(_clearance)
    _outcomes = ("blocked", "free", "overlapping", "error")

    @property
    def value(self) -> Floats:
        """ndarray of shape (N,): The free travel, ``distance``."""
        return self.distance

    @property
    def lower(self) -> Floats:
        """ndarray of shape (N,): The free travel, which is proven."""
        return self.distance

    @property
    def upper(self) -> Floats:
        """ndarray of shape (N,): Upper bounds of the translation that stops the body."""
        stop = np.maximum(self.translation_upper, 0.0)
        return np.where(self.outcome == "blocked", stop, self.distance)

    @staticmethod
    def _values(answer: Any) -> dict[str, Any]:
        match answer:
            case SolidBlocked(distance=distance, contact=contact):
                lower, upper = contact.translation_bounds
                shrunk_lower, shrunk_upper = contact.offset_distance_bounds
                return {
                    "outcome": "blocked",
                    "distance": distance,
                    "translation": contact.translation,
                    "translation_lower": lower,
                    "translation_upper": upper,
                    "offset_distance": contact.offset_distance,
                    "offset_distance_lower": shrunk_lower,
                    "offset_distance_upper": shrunk_upper,
                    "normal": contact.normal,
                    "point": contact.point,
                }
            case SolidFree(distance=distance, normal=normal):
                return {"outcome": "free", "distance": distance, "normal": normal}
            case SolidOverlapping(least_tolerance=least):
                return {"outcome": "overlapping", "least_tolerance": least}
        raise TypeError(type(answer).__name__)


def solid_casts(
    bodies: tuple[AnyBodies, AnyBodies],
    direction: ArrayLike,
    poses: tuple[Poses, Poses],
    indices: tuple[ArrayLike | None, ArrayLike | None],
    min_gap: ArrayLike,
    tolerance: ArrayLike | None,
    ignore_start_overlaps: bool,
) -> Queries:
    """Returns the arguments of :class:`SolidCast` for all rows."""
    tables = {
        "direction": table(direction, "direction", 3),
        "min_gap": column(min_gap, "min_gap"),
        "tolerance": column(tolerance, "tolerance"),
    }
    ignored = {"ignore_start_overlaps": ignore_start_overlaps}
    return queries_of(bodies, poses, indices, tables, **ignored)
