"""Conversion of array arguments to C order and native double precision.

The extension itself reads tuples, lists and arrays in that format; all other arguments are
converted here.
"""

from collections.abc import Sequence
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from colltrans._colltrans import Motion
from colltrans.errors import InputError


class Runs(NamedTuple):
    """Faces as the extension reads them: all corners, the start of each face, and the last end."""

    corners: Any
    ends: Any


def floats(values: Any, name: str) -> NDArray[np.float64]:
    """Converts ``values`` to an aligned array of doubles in C order.

    An array in this format is returned as it is. Masked entries become NaN, which every query
    rejects, bulk queries row by row.
    """
    if isinstance(values, str | PathLike):
        wanted = "give an array, for example the three numbers [0, 0, 1]"
        raise InputError(f"{name}: the text {str(values)!r} is not an array of numbers; {wanted}")
    try:
        array = np.asarray(_unmasked(values, float, np.nan))
    except Exception as error:
        raise InputError(f"{name}: not an array of numbers: {error}") from None
    if array.dtype.kind not in "fiu":
        several = array.dtype == object and any(isinstance(x, Motion) for x in array.flat)
        instead = "; give one Motion, or motion_many takes a list of them" if several else ""
        raise InputError(f"{name}: not an array of numbers, but of {array.dtype}{instead}")
    return np.require(array, np.float64, ["C", "A"])


def indices(values: Any, name: str) -> NDArray[np.uint32]:
    """Converts ``values`` to an aligned array of 32-bit indices in C order.

    An array in this format is returned as it is. Masked entries become -1, which is rejected.
    """
    try:
        array = np.asarray(_unmasked(values, np.int64, -1))
    except Exception as error:
        raise InputError(f"{name}: not an array of whole numbers: {error}") from None
    if array.size == 0:
        return np.zeros(array.shape, np.uint32)
    if array.dtype.kind not in "iu":
        raise InputError(f"{name}: not an array of whole numbers, but of {array.dtype}")
    if array.dtype != np.uint32 and (array.min() < 0 or array.max() >= 1 << 32):
        wanted = "accepted: 0 to 2^32 - 1"
        raise InputError(f"{name}: index {_outside(array)} is out of range; {wanted}")
    return np.require(array, np.uint32, ["C", "A"])


def _unmasked(values: Any, kind: Any, instead: Any) -> Any:
    if not isinstance(values, np.ma.MaskedArray) or not np.ma.is_masked(values):
        return values
    return np.ma.filled(values.astype(kind), instead)


def _outside(array: NDArray[Any]) -> int:
    return int(array.min()) if array.min() < 0 else int(array.max())


def faces(values: Any) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
    """Converts polygons to one array of corners, the start of each polygon, and the last end."""
    if isinstance(values, Runs):
        return indices(values.corners, "faces"), indices(values.ends, "faces")
    if isinstance(values, np.ndarray) and values.dtype != object:
        if values.ndim != 2:
            raise InputError(f"faces: an array of shape {values.shape}, not (M, k)")
        corners = indices(values, "faces")
        ends = np.arange(len(values) + 1) * values.shape[1]
        return corners.reshape(-1), ends.astype(np.uint32)
    if not isinstance(values, (Sequence, np.ndarray)) and hasattr(values, "__len__"):
        # Vectors of open3d are neither arrays nor sequences of Python.
        return faces(np.asarray(values))
    if not isinstance(values, (Sequence, np.ndarray)):
        raise InputError(f"faces: not a list of faces, but {type(values).__name__}")
    each = [indices(face, f"face {number}") for number, face in enumerate(values)]
    for number, face in enumerate(each):
        if face.ndim != 1:
            raise InputError(f"face {number}: an array of shape {face.shape}, not (k,)")
    ends = np.cumsum([0, *(len(face) for face in each)])
    corners = np.concatenate(each) if each else np.zeros(0, np.uint32)
    return corners, ends.astype(np.uint32)
