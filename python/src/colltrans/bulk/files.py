"""Files by path, and by URL for fsspec (``s3://bucket/shard.parquet``).

A URL is copied to a temporary file for reading, completely or only some ranges of its bytes, and a
temporary file is copied to the URL after writing. All other modules read and write local files.
Reads of URLs are repeated after faults that may pass (:func:`retried`).

Invariant: a file that :func:`made` writes has its name only when it is complete. A local file is
written under another name in the same folder and renamed. While it is written it is locked, and the
lock ends with the process. Therefore :func:`clean` can identify abandoned files.
"""

import hashlib
import os
import random
import tempfile
import time
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from io import BufferedRandom
from pathlib import Path, PurePosixPath
from typing import Any, TypeVar

from colltrans.errors import ColltransError, InputError

try:
    import fcntl
except ImportError:  # Windows, where open files cannot be removed.
    fcntl = None  # type: ignore[assignment]

Result = TypeVar("Result")
#: Half-open ranges of bytes, in order and disjoint.
Ranges = list[tuple[int, int]]
#: Maximum number of attempts to read from a URL.
TRIES = 6
#: Time before the second attempt in seconds, doubled before each further one.
PAUSE = 0.5
#: Maximum number of bytes in a request.
BLOCK = 1 << 24
#: Fields in the description of a file that change with its bytes, in lower case.
MARKS = {
    "content-md5",
    "created",
    "e_tag",
    "etag",
    "generation",
    "last-modified",
    "last_modified",
    "lastmodified",
    "md5hash",
    "modified",
    "mtime",
    "updated",
    "versionid",
}
#: Statuses of HTTP below 500 that may pass: time-outs, and too many requests.
PASSING = (408, 425, 429)


class ReadError(ColltransError):
    """A file cannot be read, or is not complete."""


class ChangedError(ReadError):
    """A file has changed while it was read."""


class NoRangesError(ReadError):
    """A server sends only complete files."""


@dataclass(frozen=True)
class Stamp:
    """The state of a file, which differs after a change of its bytes.

    Attributes
    ----------
    size : int or None
        Number of bytes; None if the server does not report it.
    marks : str
        The entity tag or the time of the last change, if the file system has them.
    """

    size: int | None
    marks: str

    def __str__(self) -> str:
        return f"{self.size} bytes, {self.marks or 'no tag or time'}"


def is_url(path: str) -> bool:
    return "://" in path


def join(folder: str, name: str) -> str:
    """Joins a folder and a relative name; absolute paths and URLs stay as they are."""
    if is_url(name):
        return name
    return f"{folder.rstrip('/')}/{name}" if is_url(folder) else str(Path(folder, name))


def parent(path: str) -> str:
    return path.rpartition("/")[0] if is_url(path) else str(Path(path).parent)


def absolute(path: str) -> str:
    return path if is_url(path) else str(Path(path).resolve())


def is_folder(path: str) -> bool:
    return _kind(path) == "directory"


def exists(path: str) -> bool:
    return _kind(path) is not None


def _kind(path: str) -> str | None:
    """Returns "file" or "directory", or None if there is neither."""
    if not is_url(path):
        here = Path(path)
        return "directory" if here.is_dir() else "file" if here.exists() else None

    def find() -> str | None:
        system, inside = _system(path)
        try:
            found: str = system.info(inside)["type"]
        except FileNotFoundError as error:
            if _may_pass(error):
                raise
            return None
        # By HTTP a folder is a page with links. A file that has a suffix is not read for links.
        if found == "file" and not PurePosixPath(inside).suffix and system.isdir(inside):
            return "directory"
        return found

    return retried(path, find)


def names_in(folder: str) -> list[str]:
    """Returns the sorted names of all files in a folder and its subfolders, relative to it.

    Names that begin with a dot are left out.
    """
    if is_url(folder):

        def listed() -> list[PurePosixPath]:
            system, inside = _system(folder)
            return [PurePosixPath(file).relative_to(inside) for file in system.find(inside)]

        found = retried(folder, listed)
    else:
        files = (file for file in Path(folder).rglob("*") if file.is_file())
        found = [PurePosixPath(file.relative_to(folder).as_posix()) for file in files]
    return sorted(str(f) for f in found if not any(part.startswith(".") for part in f.parts))


@contextmanager
def local(path: str) -> Iterator[Path]:
    """Provides a local file: the file itself, or a temporary copy of a URL."""
    if not is_url(path):
        yield Path(path)
        return
    with _copy_of(path) as copy:
        _fetch(path, copy)
        yield copy


@contextmanager
def part(path: str, stamp: Stamp, ranges: Ranges | None) -> Iterator[Path]:
    """Provides a local file with these ranges of bytes: the file itself, or a copy of a URL.

    The copy is as long as the file, with holes between the ranges. Without ranges, or from a server
    that sends only complete files, it is complete.

    Raises
    ------
    ChangedError
        The file is not in the state of the stamp.
    """
    if not is_url(path):
        unchanged(path, stamp)
        yield Path(path)
        return
    with _copy_of(path) as copy:
        with steady(path, stamp):
            _fetch_ranges(path, copy, stamp, ranges)
        yield copy


@contextmanager
def steady(path: str, stamp: Stamp) -> Iterator[None]:
    """Checks at its end whether a file is still in the state of a stamp.

    Raises
    ------
    ChangedError
        It is not. This error replaces others, which the change may have caused.
    """
    try:
        yield
    finally:
        unchanged(path, stamp)


def stamp_of(path: str) -> Stamp:
    """Returns the state of a file.

    Raises
    ------
    ReadError
        The file cannot be found or described.
    """
    if not is_url(path):
        try:
            found = Path(path).stat()
        except (OSError, ValueError) as error:
            raise ReadError(f"{path}: {error}") from error
        return Stamp(found.st_size, f"time {found.st_mtime_ns}, inode {found.st_ino}")

    def describe() -> Mapping[str, Any]:
        system, inside = _system(path)
        described: Mapping[str, Any] = system.info(inside)
        return described

    info = retried(path, describe)
    marks = {name: info[name] for name in sorted(info) if name.lower() in MARKS}
    told = ", ".join(f"{name} {value}" for name, value in marks.items() if value is not None)
    return Stamp(info.get("size"), told)


def unchanged(path: str, stamp: Stamp) -> None:
    """Checks whether a file is still in the state of a stamp.

    Raises
    ------
    ChangedError
        It is not.
    """
    if (now := stamp_of(path)) != stamp:
        raise ChangedError(f"{path} has changed while it was read: from {stamp} to {now}")


def tail(url: str, stamp: Stamp, count: int) -> bytes:
    """Returns the last `count` bytes of a file, or all of a smaller one.

    Raises
    ------
    ChangedError
        The file is not in the state of the stamp.
    NoRangesError
        The server sends only complete files.
    """
    if stamp.size is None:
        raise NoRangesError(f"{url}: the server does not report the size of the file")
    return _read_range(url, stamp, max(0, stamp.size - count), stamp.size)


def retried(path: str, attempt: Callable[[], Result]) -> Result:
    """Calls `attempt` until it succeeds, at most :data:`TRIES` times, with pauses in between.

    Faults that do not pass, for example a missing file, are not repeated.

    Raises
    ------
    ReadError
        All attempts failed, or the first one with a fault that does not pass.
    """
    pause = PAUSE
    for number in range(1, TRIES + 1):
        try:
            return attempt()
        except ColltransError:
            raise
        except Exception as error:
            if number == TRIES or not _may_pass(error):
                tried = f" (in {number} attempts)" if number > 1 else ""
                told = str(error) or type(error).__name__
                if error.__cause__ is not None:  # It has the status of HTTP.
                    told += f": {error.__cause__}"
                raise ReadError(f"{path}: {told}{tried}") from error
        # Clients that failed together do not return together.
        time.sleep(pause * random.uniform(0.5, 1))
        pause *= 2
    raise AssertionError("the last attempt returns or raises")


def _may_pass(error: BaseException | None) -> bool:
    """Checks whether another attempt may succeed; errors have the status of HTTP as a cause."""
    cause = error
    while cause is not None:
        status = getattr(cause, "status", None)
        if isinstance(status, int):
            return status >= 500 or status in PASSING
        cause = cause.__cause__
    lasting = (FileNotFoundError, PermissionError, IsADirectoryError, NotADirectoryError)
    # A ValueError is a path or an argument that is refused.
    return not isinstance(error, (*lasting, ImportError, NotImplementedError, ValueError))


@contextmanager
def _copy_of(url: str) -> Iterator[Path]:
    """Provides the name of a temporary copy of a URL, with the same suffix."""
    name = PurePosixPath(url.rpartition("://")[2]).name
    with tempfile.TemporaryDirectory(prefix="colltrans-") as folder:
        yield Path(folder, "copy" + PurePosixPath(name).suffix)


def _fetch(url: str, copy: Path) -> None:
    """Copies a complete file."""

    def fetch() -> None:
        system, inside = _system(url)
        system.get_file(inside, str(copy))

    retried(url, fetch)


def _fetch_ranges(url: str, copy: Path, stamp: Stamp, ranges: Ranges | None) -> None:
    """Copies ranges of a file, in requests of at most :data:`BLOCK` bytes."""
    if stamp.size is None:
        _fetch(url, copy)
        return
    try:
        with copy.open("wb") as file:
            file.truncate(stamp.size)
            for begin, end in [(0, stamp.size)] if ranges is None else ranges:
                file.seek(begin)
                for start in range(begin, end, BLOCK):
                    file.write(_read_range(url, stamp, start, min(start + BLOCK, end)))
    except NoRangesError:
        _fetch(url, copy)


def _read_range(url: str, stamp: Stamp, start: int, end: int) -> bytes:
    """Returns a range of the bytes of a URL."""

    def read() -> bytes:
        system, inside = _system(url)
        # Without the size it would be requested once more.
        with system.open(inside, "rb", cache_type="none", size=stamp.size) as file:
            try:
                file.seek(start)
                found: bytes = file.read(end - start)
            except ValueError as error:  # Of fsspec for a server that sends complete files.
                raise NoRangesError(f"{url}: {error}") from error
        if len(found) != end - start:
            unchanged(url, stamp)
            raise OSError(f"bytes {start} to {end}: only {len(found)} were sent")
        return found

    return b"" if start >= end else retried(url, read)


@contextmanager
def made(path: str) -> Iterator[BufferedRandom]:
    """Opens a file for writing, which gets its name when this context ends without an error.

    Raises
    ------
    ColltransError
        The file cannot be written. An ``OSError`` raised in the context is converted too.
    """
    try:
        with _made(path) as file:
            yield file
    except OSError as error:
        raise ColltransError(f"{path} cannot be written: {error}") from error


@contextmanager
def _made(path: str) -> Iterator[BufferedRandom]:
    if is_url(path):
        with tempfile.TemporaryDirectory(prefix="colltrans-") as folder:
            whole = Path(folder, "whole")
            with whole.open("w+b") as file:
                yield file
            with _told(path):
                system, inside = _system(path)
                system.makedirs(str(PurePosixPath(inside).parent), exist_ok=True)
                system.put_file(str(whole), inside)
        return
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    partial, file = _begun(target)
    try:
        with file:
            yield file
            file.flush()
            if fcntl:  # While it is locked, nothing else treats it as abandoned.
                partial.replace(target)
        if not fcntl:
            partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)


def clean(paths: Iterable[str]) -> int:
    """Removes abandoned partial files next to these files; returns their number."""
    folders = {Path(path).parent for path in paths if not is_url(path)}
    partials = (file for folder in folders for file in folder.glob(".*.partial"))
    return sum(_removed_if_abandoned(file) for file in partials)


def digest(path: str | Path) -> str:
    """Returns the SHA-256 of a local file."""
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@contextmanager
def _told(url: str) -> Iterator[None]:
    """Adds the URL to the message of any exception."""
    try:
        yield
    except ColltransError:
        raise
    except Exception as error:
        raise OSError(f"{url}: {error}") from error


def _system(url: str) -> tuple[Any, str]:
    """Returns the file system of a URL, and the path in it."""
    import fsspec

    try:
        system, inside = fsspec.core.url_to_fs(url)
    except (ImportError, ValueError) as error:  # Unknown protocol, or missing package.
        raise InputError(f"{url}: {error}") from error
    system.invalidate_cache()  # Other processes write there too.
    return system, str(inside).rstrip("/") or "/"


def _begun(target: Path) -> tuple[Path, BufferedRandom]:
    """Creates and locks a new partial file next to the target."""
    while True:
        partial = target.with_name(f".{target.name}.{uuid.uuid4().hex}.partial")
        file = partial.open("x+b")
        # Another process may have removed the file before it was locked.
        if _locked(file) is not False and (not fcntl or os.fstat(file.fileno()).st_nlink > 0):
            return partial, file
        file.close()


def _locked(file: BufferedRandom) -> bool | None:
    """Tries to lock a file; returns None if files cannot be locked."""
    if fcntl is None:
        return None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


def _removed_if_abandoned(partial: Path) -> bool:
    with suppress(OSError):
        if fcntl is not None:
            with partial.open("r+b") as file:
                if not _locked(file):
                    return False
                partial.unlink()
                return True
        partial.unlink()
        return True
    return False
