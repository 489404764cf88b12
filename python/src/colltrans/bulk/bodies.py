"""Keys to bodies: from a table of bodies, or from mesh files."""

import hashlib
import threading
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import repeat
from pathlib import Path
from typing import Any

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
    _rows: dict[str, tuple[Any, Any]] | None = field(default=None, repr=False)
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
                    self._built[key] = self._build(key, self._table())
            return [self._built[key] for key in keys]

    def build_table(self) -> None:
        """Builds all bodies of the table, if there is one; copies of these read it no more."""
        with self._lock:
            self.get(self._table())
            self.digest(())

    def _table(self) -> dict[str, tuple[Any, Any]]:
        if self._rows is None:
            self._rows = {} if self.table is None else rows_of(self.table)
        return self._rows

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
            except (OSError, ValueError) as error:  # Or no path at all.
                return f"unreadable: {error}"
        return self._digests[path]

    def _build(self, key: Any, rows: dict[str, tuple[Any, Any]]) -> Body:
        try:
            if not isinstance(key, str):
                raise InputError("no key of a body")
            if self.table is None:
                return read(Path(self.folder, key), hull=self.hull)
            if key not in rows:
                raise InputError(f"{self.table} has no body {key!r}")
            vertices, faces = rows[key]
            if faces is None or self.hull:
                return ConvexPolyhedron(vertices)
            return ConvexPolyhedron.from_mesh(vertices, faces)
        except ColltransError as error:
            return error


def rows_of(table: str) -> dict[str, tuple[Any, Any]]:
    """Vertices and faces by their keys."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        columns = pq.read_table(table)
    except pa.ArrowException as error:
        raise ColltransError(f"{table}: {error}") from error
    for name in ("key", "vertices"):
        if name not in columns.column_names:
            raise InputError(f"{table} has no column {name!r}")
    keys, vertices = (columns[name].to_pylist() for name in ("key", "vertices"))
    if len(set(keys)) < len(keys):
        twice = next(key for key, count in Counter(keys).items() if count > 1)
        raise InputError(f"{table} has the body {twice!r} twice")
    faces = columns["faces"].to_pylist() if "faces" in columns.column_names else repeat(None)
    return dict(zip(keys, zip(vertices, faces, strict=False), strict=True))


def file_digest(path: str | Path) -> str:
    """SHA-256 of a file."""
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
