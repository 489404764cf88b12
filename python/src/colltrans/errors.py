"""The exceptions of the package. Messages are those of the library."""

import errno

__all__ = [
    "AssemblyError",
    "BuildError",
    "CaseError",
    "CertificateError",
    "ColltransError",
    "InputError",
    "MeshError",
    "MissingFileError",
    "NotConvergedError",
    "PoseError",
    "QueryError",
    "RoundedPoseWarning",
]


class ColltransError(Exception):
    """The base class of all errors in this module."""


class InputError(ColltransError, ValueError):
    """An argument is not an array of numbers, or has a wrong shape or value."""


class BuildError(ColltransError, ValueError):
    """Points or a mesh do not form a body."""


class PoseError(ColltransError, ValueError):
    """A matrix or quaternion is not a rotation, or a translation is out of range."""


class QueryError(ColltransError, ValueError):
    """A direction, a tolerance or another argument of a query is rejected."""


class NotConvergedError(QueryError):
    """A search ended without an answer.

    The only known cases have a body that is thinner than the rounding error at the size of the
    configuration (ratios beyond 1e11). Please report any other case.

    Attributes
    ----------
    case : str or None
        The query as a file, for ``colltrans replay`` and ``Cast.from_json``, or for a motion
        ``MotionCast.from_json``. None for a query without a direction, such as a distance.
    """

    case: str | None = None


class CertificateError(ColltransError, ValueError):
    """A proof does not prove its claim."""


class CaseError(ColltransError, ValueError):
    """A saved query or body cannot be read, or a query or an answer cannot be saved."""


class MeshError(ColltransError, ValueError):
    """A mesh file cannot be read, or its content does not match its extension."""


class RoundedPoseWarning(UserWarning):
    """A rotation with few digits was replaced by the nearest rotation."""


class AssemblyError(ColltransError, ValueError):
    """An assembly cannot be read, a part is invalid, or a part name is unknown."""


class MissingFileError(MeshError, AssemblyError, FileNotFoundError):
    """A file of a mesh, an assembly or a robot does not exist. Its ``errno`` is ``ENOENT``."""

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.errno = errno.ENOENT


def as_error(error: BaseException, place: str) -> ColltransError:
    """Converts an exception at a place to an error of this package, unless it ends the process.

    A panic of the extension is a ``BaseException``. Ctrl-C and the exit of the interpreter are
    raised again.
    """
    if isinstance(error, (KeyboardInterrupt, SystemExit, GeneratorExit)):
        raise error
    if isinstance(error, ColltransError):
        return error
    return ColltransError(f"{place}: {type(error).__name__}: {error}")
