"""Keys to bodies: from a table of bodies, or from mesh files."""

import hashlib
import threading
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from colltrans import ConvexPolyhedron, read
from colltrans.errors import ColltransError, InputError

Body = ConvexPolyhedron | ColltransError


@dataclass
class Bodies:
    """Bodies by their keys, each built once in a process.

    Attributes
    ----------
    table : str or None
        A Parquet file with the columns ``key``, ``vertices`` (lists of three numbers each) and, if
        they are not hulls of points, ``faces`` (lists of vertex indices). Without it a key is the
        path of a mesh file, relative to ``folder``.
    folder : str
    hull : bool
        Take the convex hull of all meshes.
    """

    table: str | None = None
    folder: str = "."
    hull: bool = False
    _built: dict[str, Body] = field(default_factory=dict, repr=False)
    _digests: dict[str, str] = field(default_factory=dict, repr=False)
    _rows: dict[str, Any] | None = field(default=None, repr=False)
    _lock: threading.RLock = field(default_factory=threading.RLock, repr=False)

    def __getstate__(self) -> dict[str, Any]:
        kept = {k: v for k, v in self.__dict__.items() if k not in ("_lock", "_rows")}
        return {**kept, "_built": dict(self._built)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _lock=threading.RLock(), _rows=None)

    def get(self, keys: Iterable[Any]) -> list[Body]:
        """The bodies of these keys; for one that cannot be built the reason."""
        with self._lock:
            for key in keys:
                if key not in self._built:
                    self._built[key] = self._build(key)
            return [self._built[key] for key in keys]

    def digest(self, keys: Iterable[Any]) -> str:
        """What the bodies of these keys are made of, as a hash."""
        with self._lock:
            if self.table is not None:
                return self._digest(self.table)
            each = (f"{key}:{self._digest(str(Path(self.folder, str(key))))}" for key in keys)
            return hashlib.sha256("\n".join(sorted(each)).encode()).hexdigest()

    def _digest(self, path: str) -> str:
        if path not in self._digests:
            try:
                self._digests[path] = file_digest(path)
            except OSError as error:
                return f"unreadable: {error}"
        return self._digests[path]

    def _build(self, key: Any) -> Body:
        try:
            if not isinstance(key, str):
                raise InputError("no key of a body")
            if self.table is None:
                return read(Path(self.folder, key), hull=self.hull)
            vertices, faces = self._row(key)
            if faces is None or self.hull:
                return ConvexPolyhedron(vertices)
            return ConvexPolyhedron.from_mesh(vertices, faces)
        except ColltransError as error:
            return error

    def _row(self, key: str) -> tuple[Any, Any]:
        if self._rows is None:
            import pyarrow.parquet as pq

            table = pq.read_table(self.table)
            faces = table["faces"].to_pylist() if "faces" in table.column_names else None
            rows = zip(table["vertices"].to_pylist(), faces or [None] * len(table), strict=True)
            self._rows = dict(zip(table["key"].to_pylist(), rows, strict=True))
        if key not in self._rows:
            raise InputError(f"{self.table} has no body {key!r}")
        vertices, faces = self._rows[key]
        return np.asarray(vertices, dtype=float), faces


def file_digest(path: str | Path) -> str:
    """SHA-256 of a file."""
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
