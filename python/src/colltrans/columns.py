"""The answers of rows: tables of columns, and how to join them.

Each function ``..._many`` returns a :class:`Table` of its own class. ``value``, ``lower`` and
``upper`` are the numbers of the answers; :mod:`colltrans.answers` explains them. A missing number
is NaN.
"""

from colltrans.motions import MotionClearanceColumns, MotionColumns
from colltrans.outcomes import Outcomes
from colltrans.pairs import (
    DepthColumns,
    DistanceColumns,
    IntersectsColumns,
    PairColumns,
    WithinColumns,
)
from colltrans.removal import FreeColumns
from colltrans.robots import PathColumns
from colltrans.scenes import NearestColumns, ObstacleClearanceColumns
from colltrans.solids import SolidColumns, SolidContactColumns
from colltrans.table import (
    ClearanceColumns,
    Columns,
    ContactColumns,
    Failed,
    RangeColumns,
    Table,
    TimeColumns,
    concatenate,
)

__all__ = [
    "ClearanceColumns",
    "Columns",
    "ContactColumns",
    "DepthColumns",
    "DistanceColumns",
    "Failed",
    "FreeColumns",
    "IntersectsColumns",
    "MotionClearanceColumns",
    "MotionColumns",
    "NearestColumns",
    "ObstacleClearanceColumns",
    "Outcomes",
    "PairColumns",
    "PathColumns",
    "RangeColumns",
    "SolidColumns",
    "SolidContactColumns",
    "Table",
    "TimeColumns",
    "WithinColumns",
    "concatenate",
]
