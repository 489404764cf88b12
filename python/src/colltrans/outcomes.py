"""Outcomes of many rows as categories: stored as codes, read as names."""

import operator
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from colltrans.errors import InputError


class Outcomes:
    """Outcomes of many rows: an array of names that takes one byte for each row.

    It compares, selects and converts like an array of text. An unknown name is an error, not a mask
    of False.

    Attributes
    ----------
    codes : ndarray of uint8, shape (N,)
        Indices into ``names``.
    names : tuple of str
        All possible outcomes; the last one is ``"error"``.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, cast_many
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> outcome = cast_many(cube, cube, [1, 0, 0], moving_pose=[[-3, 0, 0], [-3, 9, 0]]).outcome
    >>> outcome == "separated"
    array([False,  True])
    >>> outcome[0], outcome[1:], outcome.codes.tolist()
    ('contact', Outcomes(['separated']), [0, 2])
    """

    __slots__ = ("codes", "names")
    #: Comparisons with arrays are left to this class instead of numpy.
    __array_ufunc__ = None
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, codes: NDArray[np.uint8], names: tuple[str, ...]) -> None:
        self.codes, self.names = codes, names

    @property
    def shape(self) -> tuple[int, ...]:
        return self.codes.shape

    def __len__(self) -> int:
        return len(self.codes)

    def __getitem__(self, which: Any) -> Any:
        found = self.codes[which]
        return Outcomes(found, self.names) if isinstance(found, np.ndarray) else self.names[found]

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        names: NDArray[Any] = np.array(self.names)[self.codes]
        return names if dtype is None else names.astype(dtype)

    def tolist(self) -> list[Any]:
        """Returns the names as a list."""
        named: list[Any] = np.asarray(self).tolist()
        return named

    def __eq__(self, other: object) -> Any:
        return self._compared(operator.eq, other)

    def __ne__(self, other: object) -> Any:
        return self._compared(operator.ne, other)

    def isin(self, names: Iterable[str]) -> NDArray[np.bool_]:
        """Returns a mask of the rows that have one of these outcomes."""
        return np.isin(self.codes, [self._code(name) for name in names])

    def counts(self) -> dict[str, int]:
        """Counts the rows of each outcome that occurs."""
        counts = np.bincount(self.codes.ravel(), minlength=len(self.names))
        return {name: int(n) for name, n in zip(self.names, counts, strict=True) if n}

    def _compared(self, compare: Any, other: object) -> Any:
        if isinstance(other, Outcomes):
            return compare(np.asarray(self), np.asarray(other))
        if isinstance(other, str):
            return compare(self.codes, self._code(other))
        others = np.asarray(other)
        if others.dtype.kind not in "UTO":
            return NotImplemented
        for name in np.unique(others):
            self._code(name)
        return compare(np.asarray(self), others)

    def _code(self, name: Any) -> int:
        if name not in self.names:
            raise InputError(
                f"unknown outcome {str(name)!r}; known outcomes: {', '.join(self.names)}"
            )
        return self.names.index(name)

    def __reduce__(self) -> Any:
        return Outcomes, (self.codes, self.names)

    def __repr__(self) -> str:
        shown = ", ".join(map(repr, np.asarray(self).ravel()[:6].tolist()))
        return f"Outcomes([{shown}{', ...' if self.codes.size > 6 else ''}])"
