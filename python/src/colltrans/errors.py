"""What goes wrong, by type. Messages are those of the library: what, where, and by how much."""

import errno


class ColltransError(Exception):
    """The base of all errors of this package."""


class InputError(ColltransError, ValueError):
    """An argument that is not an array of numbers, or has another shape than is asked for."""


class BuildError(ColltransError, ValueError):
    """Points or a mesh that make no body."""


class PoseError(ColltransError, ValueError):
    """A rotation that is none, or a translation out of range."""


class QueryError(ColltransError, ValueError):
    """A direction, a tolerance or another choice of a query that is refused."""


class NotConvergedError(QueryError):
    """A search that ended without an answer.

    Known only where one body is thinner than the rounding error at the size of the configuration
    (ratios beyond 1e11): please report another case.

    Attributes
    ----------
    case : str or None
        The query as a file, for ``Cast.from_json`` and ``colltrans replay``.
    """

    case: str | None = None


class CertificateError(ColltransError, ValueError):
    """A proof that does not prove what it says."""


class CaseError(ColltransError, ValueError):
    """A saved query or body that cannot be read back."""


class MeshError(ColltransError, ValueError):
    """A mesh file that cannot be read, or holds something else than its name says."""


class RoundedPoseWarning(UserWarning):
    """A rotation that was written with few digits and replaced by the nearest rotation."""


class AssemblyError(ColltransError, ValueError):
    """An assembly that cannot be read, a part that is none, or a name that no part has."""


class MissingFileError(MeshError, AssemblyError, FileNotFoundError):
    """A file of a mesh, an assembly or a robot that does not exist. Its ``errno`` is ``ENOENT``."""

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.errno = errno.ENOENT


def as_error(error: BaseException, place: str) -> ColltransError:
    """Returns what went wrong at a place as an error of this package, unless it ends the process.

    A panic of the extension is a ``BaseException``. Ctrl-C and the exit of the interpreter are
    raised again.
    """
    if isinstance(error, (KeyboardInterrupt, SystemExit, GeneratorExit)):
        raise error
    if isinstance(error, ColltransError):
        return error
    return ColltransError(f"{place}: {type(error).__name__}: {error}")
