"""Division of files of queries into shards and tasks.

The footer of a Parquet file has the places of its row groups. It is read once, before the work
begins. A shard of row groups carries the footer, and therefore reads only the bytes of these row
groups. A task is a sequence of shards that one process answers.
"""

from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from colltrans.bulk import files
from colltrans.bulk.files import ReadError, Stamp

#: Number of bytes at the end of a file that are requested for its footer.
FOOTER = 1 << 16
#: Maximum number of footers that are read at a time.
FOOTERS_AT_A_TIME = 32
#: The bytes at both ends of a Parquet file.
MAGIC = b"PAR1"


@dataclass(frozen=True, eq=False)
class Source:
    """A Parquet file: its state when its footer was read, and the footer.

    Attributes
    ----------
    stamp : Stamp
    footer : pyarrow.parquet.FileMetaData
    """

    stamp: Stamp
    footer: Any

    def rows(self, groups: tuple[int, int] | None) -> int:
        """Returns the number of rows of a range of row groups, or of all of them."""
        if groups is None:
            return int(self.footer.num_rows)
        return sum(self.footer.row_group(number).num_rows for number in range(*groups))


def source_of(path: str) -> Source:
    """Reads the footer of a Parquet file.

    Raises
    ------
    ReadError
        The file cannot be read, or is not a complete Parquet file.
    NoRangesError
        The server sends only complete files.
    """
    stamp = files.stamp_of(path)
    try:
        if not files.is_url(path):
            footer = pq.read_metadata(path)
        else:
            footer = pq.read_metadata(pa.BufferReader(_footer_of(path, stamp)))
    except (pa.ArrowException, OSError) as error:
        raise ReadError(f"{path}: cannot read the queries: {error}") from error
    files.unchanged(path, stamp)
    return Source(stamp, footer)


def _footer_of(url: str, stamp: Stamp) -> bytes:
    """Returns a Parquet file that has only the footer of a file."""
    found = files.tail(url, stamp, FOOTER)
    if len(found) < 12 or found[-4:] != MAGIC:
        raise ReadError(f"{url}: not a complete Parquet file: it does not end with {MAGIC!r}")
    length = int.from_bytes(found[-8:-4], "little") + 8
    if stamp.size is None or length + 4 > stamp.size:
        raise ReadError(f"{url}: not a complete Parquet file: its footer has {length} bytes")
    if length > len(found):
        found = files.tail(url, stamp, length)
    return MAGIC + found[-length:]


def sources_of(paths: Sequence[str]) -> dict[str, Source | ReadError]:
    """Reads the footers of Parquet files, several at a time. An error stands for a missing one."""

    def read(path: str) -> Source | ReadError:
        try:
            return source_of(path)
        except ReadError as error:
            return error

    with ThreadPoolExecutor(FOOTERS_AT_A_TIME) as pool:
        return dict(zip(paths, pool.map(read, paths), strict=True))


def ranges_of(footer: Any, groups: tuple[int, int] | None) -> files.Ranges | None:
    """Returns the bytes of a range of row groups; None for the complete file."""
    if groups is None:
        return None
    found = [chunk for number in range(*groups) for chunk in chunks_of(footer.row_group(number))]
    joined: files.Ranges = []
    for begin, end in sorted(found):
        if joined and begin <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        else:
            joined.append((begin, end))
    return joined


def chunks_of(group: Any) -> Iterator[tuple[int, int]]:
    """Yields the bytes of each column of a row group, in the order of the columns."""
    for column in map(group.column, range(group.num_columns)):
        pages = column.dictionary_page_offset if column.has_dictionary_page else None
        begin = pages or column.data_page_offset
        if column.total_compressed_size > 0:
            yield begin, begin + column.total_compressed_size


def parts_of(source: Source, rows: int) -> list[tuple[int, int]]:
    """Divides a file into ranges of row groups with at least `rows` rows each.

    The rest at the end is a range, too, unless it has no rows.
    """
    begins, count = [0], 0
    for number in range(source.footer.num_row_groups):
        if count >= rows:
            begins.append(number)
            count = 0
        count += source.footer.row_group(number).num_rows
    if count == 0 and len(begins) > 1:
        begins.pop()
    return list(pairwise([*begins, source.footer.num_row_groups]))


def packed(sizes: Iterable[int | None], rows: int) -> list[list[int]]:
    """Divides the numbers of consecutive items into lists, each closed when it has `rows` rows.

    An item of unknown size, or with at least `rows` rows, is a list of its own.
    """
    lists: list[list[int]] = []
    count = rows
    for item, size in enumerate(sizes):
        if size is None or max(count, size) >= rows:
            lists.append([])
            count = 0
        lists[-1].append(item)
        count += rows if size is None else max(size, 1)
    return lists
