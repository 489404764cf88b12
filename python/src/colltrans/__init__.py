"""How far can one body move before it touches another? Exact answers, with proofs.

A body is a :class:`ConvexPolyhedron` or a :class:`Solid`, which need not be convex. Seven questions
take two bodies of either kind, each with a pose by keyword or as ``body.at(pose)``:

==============  ==================================================================================
cast            the translation along a direction at which the bodies first meet
clearance       the free travel along a direction from here, and what stops the body
distance        the distance of the bodies and their nearest points
depth           the shortest translation that separates bodies that overlap
within          whether the bodies are closer than a length
intersects      whether the bodies meet
motion          the time at which moving bodies first meet; :class:`Motion` turns, slides, screws
==============  ==================================================================================

>>> from colltrans import ConvexPolyhedron, cast
>>> box = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
>>> found = cast(box.at([-3, 0.5, 0]), box, [1, 0, 0])
>>> found, found.lower <= 2 <= found.upper, found < 2.5, float(found)
(Contact(translation=2.0, normal=[1.0, 0.0, 0.0]), True, True, 2.0)

``cast_many``, ... take rows of poses, directions and bodies in the same words and return columns.
An answer is a frozen object for ``match``, with its query and its proof; answers that are numbers
have ``value``, ``lower`` and ``upper`` (``help(colltrans.answers)``). A query is a value, too:
``Cast``, ``SolidCast``, ``Pair`` and ``MotionCast`` have the questions as methods.

Bodies are made of points, ``vertices, faces``, files (``read``, ``Solid.read``) or meshes of
trimesh and open3d. Poses are (3,), (7,), (3, 3), (3, 4) or (4, 4) numbers, ``(position,
quaternion)``, rotations of scipy, or a :class:`Pose`, whose help says what is normalised. Vertices
are in the body frame; directions, normals and points are in the world. Translations are multiples
of the direction, so they are lengths if it has length 1. The unit of length is the caller's,
except that robots are in metres.

The rest is in groups, each with its own help:

==================  ==============================================================================
colltrans.answers   all answers and proofs; what the number of an answer is
colltrans.columns   the answers of rows: tables, and how to join them
colltrans.motions   bodies that move in time; also ``motion_clearance``
colltrans.removal   all directions in which a part comes out, and ways of several moves
colltrans.assembly  many parts: disassembly plans, free travel, clashes (``audit``)
colltrans.robots    links with joints on paths (``Robot``, ``path_many``)
colltrans.scenes    one body among many (``Obstacles``)
colltrans.bulk      files of queries
colltrans.check     the checker of proofs, which needs nothing else of this package
colltrans.errors    exceptions; all are ``ColltransError``
==================  ==============================================================================

``show(answer)`` draws bodies and answers.
"""

import sys as _sys
from importlib.metadata import version as _version
from typing import TYPE_CHECKING as _TYPE_CHECKING

from colltrans import answers as answers
from colltrans import assembly as assembly
from colltrans import columns as columns
from colltrans import errors as errors
from colltrans import motions as motions
from colltrans import removal as removal
from colltrans import robots as robots
from colltrans import scenes as scenes
from colltrans._colltrans import (
    Behind,
    Blocked,
    Cast,
    CommonPart,
    Contact,
    ContactRange,
    ConvexPolyhedron,
    Cta,
    Depth,
    Distance,
    FirstContact,
    Grazing,
    Intersection,
    Motion,
    MotionCast,
    Obstacles,
    OverlapDepth,
    Overlapping,
    Pair,
    Placed,
    Pose,
    Robot,
    Separated,
    Slides,
    Solid,
    SolidBlocked,
    SolidCast,
    SolidContact,
    SolidFree,
    SolidOverlapping,
    Tracker,
    Within,
    cast,
    clearance,
    contact_range,
    depth,
    directional_depth,
    distance,
    intersects,
    motion,
    read,
    within,
)
from colltrans.assembly import (
    Assembly,
)
from colltrans.errors import (
    ColltransError,
    InputError,
)
from colltrans.many import (
    cast_many,
    clearance_many,
    contact_range_many,
)
from colltrans.motions import (
    motion_many,
)
from colltrans.pairs import (
    depth_many,
    distance_many,
    intersects_many,
    within_many,
)
from colltrans.pictures import (
    picture,
    show,
)
from colltrans.removal import (
    free_directions,
)

__version__ = _version("colltrans")

__all__ = [
    "Assembly",
    "Behind",
    "Blocked",
    "Cast",
    "ColltransError",
    "CommonPart",
    "Contact",
    "ContactRange",
    "ConvexPolyhedron",
    "Cta",
    "Depth",
    "Distance",
    "FirstContact",
    "Grazing",
    "InputError",
    "Intersection",
    "Motion",
    "MotionCast",
    "Obstacles",
    "OverlapDepth",
    "Overlapping",
    "Pair",
    "Placed",
    "Pose",
    "Robot",
    "Separated",
    "Slides",
    "Solid",
    "SolidBlocked",
    "SolidCast",
    "SolidContact",
    "SolidFree",
    "SolidOverlapping",
    "Tracker",
    "Within",
    "cast",
    "cast_many",
    "clearance",
    "clearance_many",
    "contact_range",
    "contact_range_many",
    "depth",
    "depth_many",
    "directional_depth",
    "distance",
    "distance_many",
    "free_directions",
    "intersects",
    "intersects_many",
    "motion",
    "motion_many",
    "picture",
    "read",
    "show",
    "within",
    "within_many",
]

#: Names that have left this module, and their modules now.
_MOVED = {
    "AssemblyError": "errors",
    "Audit": "assembly",
    "Blocking": "assembly",
    "BuildError": "errors",
    "CaseError": "errors",
    "Certificate": "answers",
    "CertificateError": "errors",
    "ClearanceColumns": "columns",
    "Columns": "columns",
    "ContactColumns": "columns",
    "DepthColumns": "columns",
    "DirectionalDepth": "answers",
    "DistanceColumns": "columns",
    "Failed": "columns",
    "Feature": "answers",
    "Features": "answers",
    "FreeColumns": "removal",
    "FreeDirections": "removal",
    "LastContact": "answers",
    "MeshError": "errors",
    "MissingFileError": "errors",
    "MotionClearance": "motions",
    "MotionClearanceColumns": "motions",
    "MotionColumns": "motions",
    "Move": "assembly",
    "NearbyObstacles": "scenes",
    "NearestObstacle": "scenes",
    "NotConvergedError": "errors",
    "ObstacleClearance": "scenes",
    "OffsetReport": "answers",
    "Outcomes": "columns",
    "PairColumns": "columns",
    "PairFit": "assembly",
    "PathColumns": "robots",
    "PathContact": "robots",
    "Plan": "assembly",
    "PoseError": "errors",
    "QueryError": "errors",
    "RangeColumns": "columns",
    "RemovalMap": "assembly",
    "Rooms": "assembly",
    "RoundedPoseWarning": "errors",
    "Separation": "answers",
    "ShrinkReport": "answers",
    "SolidCertificate": "answers",
    "SolidColumns": "columns",
    "Stage": "assembly",
    "Step": "assembly",
    "Steps": "answers",
    "Stuck": "assembly",
    "Turn": "assembly",
    "Wanted": "assembly",
    "WaysOut": "removal",
    "WithinColumns": "columns",
    "audit": "assembly",
    "concatenate": "columns",
    "free_directions_many": "removal",
    "motion_clearance": "motions",
    "motion_clearance_many": "motions",
    "path_many": "robots",
    "ways_out": "removal",
}
#: Names that have changed.
_RENAMED = {"first_contact": "motion"}


def _moved(name: str) -> str | None:
    """Returns the new name of a former name of this module."""
    if name in _MOVED:
        return f"colltrans.{_MOVED[name]}.{name}"
    return f"colltrans.{_RENAMED[name]}" if name in _RENAMED else None


if not _TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        new = _moved(name)
        if new is None:
            raise AttributeError(f"module 'colltrans' has no attribute {name!r}")
        # An AttributeError would lose its message: ``from colltrans import name`` replaces it.
        importing = _sys._getframe(1).f_globals.get("__name__") == "importlib._bootstrap"
        raise (ImportError if importing else AttributeError)(
            f"colltrans.{name} is now {new}; MIGRATION.md lists all names"
        )
