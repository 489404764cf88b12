"""Bodies by their keys, from a table of bodies or from mesh files."""

import hashlib
import threading
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from colltrans import ConvexPolyhedron, Solid, read
from colltrans._arrays import Runs
from colltrans.bulk import files
from colltrans.errors import ColltransError, InputError, as_error
from colltrans.queries import cores

Body: TypeAlias = ConvexPolyhedron | Solid | ColltransError


@dataclass(frozen=True)
class Doubled:
    """A row whose key occurs twice in its table, so that it defines no body."""

    table: str


#: A row of a table: its batch and its index there; None after its body is built.
Row: TypeAlias = tuple[Any, int] | Doubled | None
#: Approximate number of bytes after which memory of built rows is released.
PIECE = 1 << 22


@dataclass
class Bodies:
    """Bodies by their keys, each built once in a process, several at a time.

    Attributes
    ----------
    table : str or None
        A Parquet file with the columns ``key``, ``vertices`` (lists of three numbers) and, unless
        bodies are hulls of points, ``faces`` (lists of vertex indices). Without a table a key is
        the path of a mesh file relative to ``folder``. All paths may be URLs for fsspec.
    folder : str
    hull : bool
        Whether to take the convex hull of all meshes.
    solids : bool
        Whether to treat all bodies as solids, which need not be convex. Each body then needs faces.
    """

    table: str | None = None
    folder: str = "."
    hull: bool = False
    solids: bool = False
    _built: dict[str, Body] = field(default_factory=dict, repr=False)
    _digests: dict[str, str] = field(default_factory=dict, repr=False)
    _rows: dict[str, Row] | None = field(default=None, repr=False)
    _lock: threading.RLock = field(default_factory=threading.RLock, repr=False)

    def __post_init__(self) -> None:
        if self.hull and self.solids:
            raise InputError("hull and solids are both set; set only one of them")

    def __getstate__(self) -> dict[str, Any]:
        kept = {k: v for k, v in self.__dict__.items() if k != "_lock"}
        if self._rows is not None and None in self._rows.values():
            kept["_rows"] = None  # Rows of built bodies are gone: the table is read again.
        return {**kept, "_built": {}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _lock=threading.RLock())

    def get(self, keys: Iterable[Any]) -> list[Body]:
        """Returns the bodies of these keys, or the error of a body that cannot be built."""
        keys = list(keys)
        with self._lock:
            missing = [key for key in dict.fromkeys(keys) if key not in self._built]
            if missing:
                rows, gone = self.read_table(), 0
                # Bodies are built without the interpreter's lock.
                with ThreadPoolExecutor(min(len(missing), cores())) as pool:
                    for taken in pool.map(lambda key: self._make(key, rows), missing):
                        gone += taken
                        if gone > PIECE:
                            gone = 0
                            _release()
            return [self._built[key] for key in keys]

    def _make(self, key: Any, rows: dict[str, Row]) -> int:
        """Builds a body and releases its row; returns the approximate size of the row in bytes."""
        body = self._built[key] = self._build(key, rows)
        if rows.get(key) is None or isinstance(rows[key], Doubled):
            return 0
        rows[key] = None
        return 0 if isinstance(body, ColltransError) else body.nbytes // 4

    def read_table(self) -> dict[str, Row]:
        """Returns the rows of the table by their keys; empty without a table.

        Raises
        ------
        ColltransError
            The table cannot be read.
        """
        with self._lock:
            if self._rows is None:
                self._rows = {} if self.table is None else rows_of(self.table)
                _release()
            return self._rows

    def share(self) -> None:
        """Reads the table, if there is one, so that copies of this object do not read it again.

        Copies build the bodies that they need. Their numbers are shared by all processes of a
        machine if copies go through shared memory, as Arrow arrays do in Ray's object store.
        """
        with self._lock:
            self.read_table()
            self.digest(())

    def digest(self, keys: Iterable[Any]) -> str:
        """Returns a hash of the sources of these bodies."""
        with self._lock:
            if self.table is not None:
                return self._digest(self.table)
            each = (f"{key}:{self._digest(files.join(self.folder, str(key)))}" for key in keys)
            return hashlib.sha256("\n".join(sorted(each)).encode()).hexdigest()

    def _digest(self, path: str) -> str:
        if path not in self._digests:
            try:
                with files.local(path) as file:
                    self._digests[path] = files.digest(file)
            except (OSError, ValueError, InputError) as error:  # Or no path at all.
                return f"unreadable: {error}"
        return self._digests[path]

    def _build(self, key: Any, rows: dict[str, Row]) -> Body:
        try:
            if not isinstance(key, str):
                raise InputError("the key of a body is not a text")
            if self.table is not None:
                return self._of_row(rows.get(key), key)
            with files.local(files.join(self.folder, key)) as file:
                return Solid.read(file) if self.solids else read(file, hull=self.hull)
        except BaseException as error:
            return as_error(error, str(key))

    def _of_row(self, found: Row, key: str) -> Body:
        if found is None:
            raise InputError(f"{self.table} has no body {key!r}")
        if isinstance(found, Doubled):
            raise InputError(f"{found.table} has the body {key!r} twice")
        batch, row = found
        vertices = _vertices(batch.column("vertices"), row)
        faces = _faces(batch.column("faces"), row) if "faces" in batch.schema.names else None
        if self.solids:
            if faces is None:
                raise InputError("a solid needs faces, but the table has no column 'faces'")
            return Solid(vertices, faces)
        if faces is None or self.hull:
            return ConvexPolyhedron(vertices)
        return ConvexPolyhedron.from_mesh(vertices, faces)


def doubled_name(names: list[str]) -> str | None:
    """Returns a name that occurs more than once; None if there is none."""
    return next((name for name in names if names.count(name) > 1), None)


def texts_of(column: Any) -> list[str | None]:
    """Returns the texts of a column; None for a null and for bytes that are not UTF-8."""
    import pyarrow as pa

    try:
        found: list[str | None] = column.to_pylist()
        return found
    except UnicodeDecodeError:
        return [_decoded(text) for text in column.cast(pa.large_binary()).to_pylist()]


def _decoded(text: bytes | None) -> str | None:
    try:
        return None if text is None else text.decode()
    except UnicodeDecodeError:
        return None


def _release() -> None:
    """Releases memory that Arrow caches; after reading a table it is as large as the table."""
    import pyarrow as pa

    pa.default_memory_pool().release_unused()


def rows_of(table: str) -> dict[str, Row]:
    """Returns the batch and row of each key of a table."""
    import pyarrow as pa

    found: dict[str, Row] = {}
    try:
        with files.local(table) as file:
            for batch in _batches(file, table):
                for row, key in enumerate(texts_of(batch.column("key"))):
                    if key is None:
                        continue  # No query can name it.
                    found[key] = Doubled(table) if key in found else (batch, row)
    except pa.ArrowException as error:
        raise ColltransError(f"{table}: {error}") from error
    return found


def _batches(file: Any, table: str) -> Iterator[Any]:
    import pyarrow.parquet as pq

    with pq.ParquetFile(file, page_checksum_verification=True) as parquet:
        names = parquet.schema_arrow.names
        for name in ("key", "vertices"):
            if name not in names:
                raise InputError(f"{table} has no column {name!r}")
        if (doubled := doubled_name(names)) is not None:
            raise InputError(f"{table} has the column {doubled!r} twice")
        columns = [name for name in ("key", "vertices", "faces") if name in names]
        for number in range(parquet.num_row_groups):
            group = parquet.metadata.row_group(number)
            rows = max(1, group.num_rows * PIECE // max(PIECE, group.total_byte_size))
            yield from parquet.iter_batches(rows, row_groups=[number], columns=columns)


def _lists(column: Any, row: int, name: str) -> Any:
    """Returns the lists in a row of a column of lists; None for a null."""
    import pyarrow as pa

    if pa.types.is_null(column.type) or not column[row].is_valid:
        return None
    if not pa.types.is_nested(column.type):
        raise InputError(f"{name}: not lists of numbers, but {column.type}")
    lists = column[row].values
    if not any(
        of(lists.type)
        for of in (pa.types.is_list, pa.types.is_large_list, pa.types.is_fixed_size_list)
    ):
        raise InputError(f"{name}: not lists of numbers, but {lists.type}")
    if lists.null_count:
        raise InputError(f"{name}: entry {_first(lists.is_null())} is null")
    return lists


def _first(mask: Any) -> int:
    return int(np.argmax(np.asarray(mask)))


def _runs(lists: Any) -> tuple[Any, Any]:
    """Returns all numbers of lists, the start of each list, and the last end."""
    numbers = lists.flatten().to_numpy(zero_copy_only=False)
    lengths = lists.value_lengths().to_numpy(zero_copy_only=False)
    return numbers, np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)


def _vertices(column: Any, row: int) -> Any:
    """Returns an array of shape (N, 3), without a copy if Arrow stores the numbers contiguously."""
    lists = _lists(column, row, "points")
    if lists is None:
        raise InputError("points: missing")
    numbers, ends = _runs(lists)
    if (others := np.diff(ends) != 3).any():
        point = _first(others)
        told = f"point {point} has {ends[point + 1] - ends[point]}, not 3"
        raise InputError(f"points: not an array of numbers: {told}")
    return numbers.reshape(-1, 3)


def _faces(column: Any, row: int) -> Any:
    lists = _lists(column, row, "faces")
    return None if lists is None else Runs(*_runs(lists))
