"""Bodies by their keys, from a table of bodies or from mesh files.

The numbers of a table are in a temporary file that is mapped to memory, so that the system can drop
and reload its pages. Built bodies are in a cache of bounded size, and built again if needed.
"""

import hashlib
import tempfile
import threading
from bisect import bisect_right
from collections import OrderedDict
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from colltrans._arrays import Runs
from colltrans._colltrans import ConvexPolyhedron, Solid, read
from colltrans.bulk import files
from colltrans.bulk.files import ReadError
from colltrans.errors import ColltransError, InputError, as_error
from colltrans.queries import cores

Body: TypeAlias = ConvexPolyhedron | Solid | ColltransError


@dataclass(frozen=True)
class Doubled:
    """A row whose key occurs twice in its table, so that it defines no body."""

    table: str


#: A row of a table: its batch and its index there.
Row: TypeAlias = tuple[Any, int] | Doubled | None
#: Approximate number of bytes of a table that are read at once.
PIECE = 1 << 22
#: Default maximum size of the cache of bodies in bytes, as of `colltrans batch`.
CACHE_BYTES = 256 << 20
#: Number of bytes of an entry of the cache besides the body, and of an error.
ENTRY = 512
#: Approximate number of bytes of a built body for each vertex.
POINT = 200


@dataclass(frozen=True)
class Rows:
    """The rows of a table of bodies.

    Attributes
    ----------
    table : str
    batches : list of pyarrow.RecordBatch
        The columns ``vertices`` and ``faces``.
    starts : list of int
        The number of the first row of each batch.
    numbers : dict of str to int
        The row of each key; -1 for a key that occurs twice.
    """

    table: str
    batches: list[Any]
    starts: list[int]
    numbers: dict[str, int]

    def get(self, key: str) -> Row:
        """Returns the row of a key, or None."""
        number = self.numbers.get(key)
        if number is None:
            return None
        if number < 0:
            return Doubled(self.table)
        batch = bisect_right(self.starts, number) - 1
        return self.batches[batch], number - self.starts[batch]

    def size(self, key: str | None) -> int:
        """Returns an estimate of the size of a built body in bytes."""
        row = None if key is None else self.get(key)
        if row is None or isinstance(row, Doubled):
            return ENTRY
        lists = row[0].column("vertices").slice(row[1], 1)
        return ENTRY + POINT * (len(lists.flatten()) if hasattr(lists, "flatten") else 0)

    def total_size(self) -> int:
        """Returns an estimate of the size of all built bodies in bytes."""
        lists = (batch.column("vertices") for batch in self.batches)
        points = sum(len(column.flatten()) for column in lists if hasattr(column, "flatten"))
        return ENTRY * len(self.numbers) + POINT * points


@dataclass
class Bodies:
    """Bodies by their keys, built when they are needed, several at a time.

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
    cache_bytes : int
        Maximum size of the built bodies that are kept. The bodies of the rows that are being
        answered are held in addition.
    """

    table: str | None = None
    folder: str = "."
    hull: bool = False
    solids: bool = False
    cache_bytes: int = CACHE_BYTES
    _cache: OrderedDict[str, Body] = field(default_factory=OrderedDict, repr=False)
    _held: int = field(default=0, repr=False)
    _total: int | None = field(default=None, repr=False)
    _digests: dict[str, str] = field(default_factory=dict, repr=False)
    _rows: Rows | None = field(default=None, repr=False)
    _shared: bool = field(default=False, repr=False)
    _lock: threading.RLock = field(default_factory=threading.RLock, repr=False)

    def __post_init__(self) -> None:
        if self.hull and self.solids:
            raise InputError("hull and solids are both set; set only one of them")
        if self.cache_bytes < 0:
            raise InputError(f"cache_bytes: {self.cache_bytes} is not a number of bytes from 0")

    def __getstate__(self) -> dict[str, Any]:
        kept = {k: v for k, v in self.__dict__.items() if k != "_lock"}
        rows = self._rows if self._shared else None
        return {**kept, "_cache": OrderedDict(), "_held": 0, "_rows": rows}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _lock=threading.RLock())

    def get(self, keys: Iterable[Any]) -> list[Body]:
        """Returns the bodies of these keys, or the error of a body that cannot be built."""
        keys = list(keys)
        with self._lock:
            found = {key: self._cache[key] for key in keys if key in self._cache}
            for key in found:
                self._cache.move_to_end(key)
            missing = [key for key in dict.fromkeys(keys) if key not in found]
            if missing:
                rows = self.read_table()
                # Bodies are built without the interpreter's lock.
                with ThreadPoolExecutor(min(len(missing), cores())) as pool:
                    for key, body in zip(
                        missing, pool.map(lambda key: self._build(key, rows), missing), strict=True
                    ):
                        found[key] = body
                        self._keep(key, body)
            return [found[key] for key in keys]

    def _keep(self, key: Any, body: Body) -> None:
        """Adds a body to the cache, and removes those that have not been used for longest."""
        self._cache[key] = body
        self._held += _size_of(body)
        while self._held > self.cache_bytes:
            _, oldest = self._cache.popitem(last=False)
            self._held -= _size_of(oldest)

    def all_fit(self) -> bool:
        """Checks whether the cache can hold all bodies; mesh files are assumed to fit."""
        rows = self.read_table()
        if self._total is None:
            self._total = rows.total_size()
        return self._total <= self.cache_bytes

    def sizes(self, keys: Iterable[Any]) -> list[int]:
        """Returns estimates of the sizes of built bodies of the table, in bytes."""
        rows = self.read_table()
        return [rows.size(key) for key in keys]

    def read_table(self) -> Rows:
        """Returns the rows of the table; none without a table.

        Raises
        ------
        ColltransError
            The table cannot be read.
        """
        with self._lock:
            if self._rows is not None:
                return self._rows
            if self.table is None:
                self._rows = Rows("", [], [], {})
                return self._rows
            with files.local(self.table) as file:
                self._rows = rows_of(self.table, file)
                self._digests[self.table] = files.digest(file)
            return self._rows

    def share(self) -> None:
        """Reads the table, if there is one, so that copies of this object do not read it again.

        Copies build the bodies that they need. Their numbers are shared by all processes of a
        machine if copies go through shared memory, as Arrow arrays do in Ray's object store.
        """
        with self._lock:
            self.read_table()
            self.digest(())
            self._shared = True

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
            except (OSError, ValueError, ColltransError) as error:  # Or no path at all.
                return f"unreadable: {error}"
        return self._digests[path]

    def _build(self, key: Any, rows: Rows) -> Body:
        try:
            if not isinstance(key, str):
                raise InputError("the key of a body is not a text")
            if self.table is not None:
                return self._of_row(rows.get(key), key)
            with files.local(files.join(self.folder, key)) as file:
                return Solid.read(file) if self.solids else read(file, hull=self.hull)
        except BaseException as error:
            told = as_error(error, str(key))
            # Frames of the traceback would keep their arrays in memory.
            told.__cause__ = told.__context__ = None
            return told.with_traceback(None)

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


def rows_of(table: str, file: Path) -> Rows:
    """Copies a table to a temporary file that is mapped to memory; returns its rows."""
    import pyarrow as pa

    numbers: dict[str, int] = {}
    count = 0
    try:
        # The map outlives the name of the file, except on Windows, where the file remains.
        with tempfile.TemporaryDirectory(prefix="colltrans-", ignore_cleanup_errors=True) as folder:
            copy, writer = Path(folder, "bodies.arrow"), None
            for batch in _batches(file, table):
                keys, batch = batch.column("key"), batch.drop_columns(["key"])
                for number, key in enumerate(texts_of(keys), count):
                    if key is not None:  # No query can name it.
                        numbers[key] = -1 if key in numbers else number
                count += batch.num_rows
                writer = writer or pa.ipc.new_file(copy, batch.schema)
                writer.write_batch(batch)
            if writer is None:
                return Rows(table, [], [], {})
            writer.close()
            mapped = pa.ipc.open_file(pa.memory_map(str(copy)))
            batches = [mapped.get_batch(k) for k in range(mapped.num_record_batches)]
    except (pa.ArrowException, OSError) as error:
        raise ReadError(f"{table}: {error}") from error
    # Arrow caches as much memory as it used for the table.
    pa.default_memory_pool().release_unused()
    starts = np.cumsum([0, *(batch.num_rows for batch in batches)])[:-1]
    return Rows(table, batches, starts.tolist(), numbers)


def _size_of(body: Body) -> int:
    """Returns the approximate number of bytes of an entry of the cache."""
    return ENTRY if isinstance(body, ColltransError) else ENTRY + body.nbytes


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
