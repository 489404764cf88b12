"""Files by their paths, and by URLs that fsspec knows (``s3://bucket/shard.parquet``).

A URL is fetched whole to a temporary file, and what is made for one is put there whole. So all else
reads and writes local files.

Invariant: a file that is :func:`made` has its name only when it is whole. A local one is written
under another name beside its place and renamed. While it is written it is locked, and the lock goes
with the process, however that ends: :func:`clean` knows which such files nobody writes any more.
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
except ImportError:  # Windows, where a file that is open cannot be removed.
    fcntl = None  # type: ignore[assignment]


def is_url(path: str) -> bool:
    return "://" in path


def join(folder: str, name: str) -> str:
    """A name relative to a folder; a path that needs none, or a URL, as it is."""
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
    """What a path says of itself, or the file system of a URL of it."""
    if not is_url(path):
        return here(Path(path))
    with _told(path):
        system, inside = _system(path)
        return bool(getattr(system, there)(inside))


def names_in(folder: str) -> list[str]:
    """The files of a folder and of those in it, by their names relative to it, in order.

    What begins with a dot is left out.
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
    """The file here: itself, or of a URL a copy for as long as it is needed."""
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
    """A file to be written, which has its name when it is whole: after this, without an error.

    Raises
    ------
    ColltransError
        A file that cannot be written: what is raised in between as an ``OSError``, too.
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
            if fcntl:  # As long as it is locked nobody takes it for abandoned.
                partial.replace(target)
        if not fcntl:
            partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)


def clean(paths: Iterable[str]) -> int:
    """Removes what others have begun beside these files and will not end; how many there were."""
    folders = {Path(path).parent for path in paths if not is_url(path)}
    partials = (file for folder in folders for file in folder.glob(".*.partial"))
    return sum(_removed_if_abandoned(file) for file in partials)


def digest(path: str | Path) -> str:
    """SHA-256 of a local file."""
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@contextmanager
def _told(url: str) -> Iterator[None]:
    """What goes wrong with a URL, of whatever kind, by its name."""
    try:
        yield
    except ColltransError:
        raise
    except Exception as error:
        raise OSError(f"{url}: {error}") from error


def _system(url: str) -> tuple[Any, str]:
    """The file system of a URL, and where in it this is."""
    import fsspec

    try:
        system, inside = fsspec.core.url_to_fs(url)
    except (ImportError, ValueError) as error:  # A kind nobody knows, or whose package is missing.
        raise InputError(f"{url}: {error}") from error
    system.invalidate_cache()  # Others write there, too.
    return system, str(inside).rstrip("/") or "/"


def _begun(target: Path) -> tuple[Path, BufferedRandom]:
    """A new locked file beside a place."""
    while True:
        partial = target.with_name(f".{target.name}.{uuid.uuid4().hex}.partial")
        file = partial.open("x+b")
        # Somebody who cleans may have come between.
        if _locked(file) is not False and (not fcntl or os.fstat(file.fileno()).st_nlink > 0):
            return partial, file
        file.close()


def _locked(file: BufferedRandom) -> bool | None:
    """Whether it could be locked; None where files cannot be."""
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
