"""Files by path, and by URL for fsspec (``s3://bucket/shard.parquet``).

A URL is copied to a temporary file for reading, and a temporary file is copied to the URL after
writing. All other modules read and write local files.

Invariant: a file that :func:`made` writes has its name only when it is complete. A local file is
written under another name in the same folder and renamed. While it is written it is locked, and the
lock ends with the process. Therefore :func:`clean` can identify abandoned files.
"""

import hashlib
import os
import tempfile
import uuid
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from io import BufferedRandom
from pathlib import Path, PurePosixPath
from typing import Any

from colltrans.errors import ColltransError, InputError

try:
    import fcntl
except ImportError:  # Windows, where open files cannot be removed.
    fcntl = None  # type: ignore[assignment]


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
    return _is(path, Path.is_dir, "isdir")


def exists(path: str) -> bool:
    return _is(path, Path.exists, "exists")


def _is(path: str, here: Callable[[Path], bool], there: str) -> bool:
    """Evaluates a check of a path, or of a URL with its file system."""
    if not is_url(path):
        return here(Path(path))
    with _told(path):
        system, inside = _system(path)
        return bool(getattr(system, there)(inside))


def names_in(folder: str) -> list[str]:
    """Returns the sorted names of all files in a folder and its subfolders, relative to it.

    Names that begin with a dot are left out.
    """
    if is_url(folder):
        with _told(folder):
            system, inside = _system(folder)
            found = [PurePosixPath(file).relative_to(inside) for file in system.find(inside)]
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
    with tempfile.TemporaryDirectory(prefix="colltrans-") as folder:
        with _told(path):
            system, inside = _system(path)
            copy = Path(folder, PurePosixPath(inside).name)
            system.get_file(inside, str(copy))
        yield copy


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
