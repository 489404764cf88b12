"""The types of the extension."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, Never, Protocol, TypeAlias, final, overload, type_check_only

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Floats: TypeAlias = NDArray[np.float64]
_Indices: TypeAlias = NDArray[np.uint32]
_Solver: TypeAlias = Literal["auto", "cta", "portal"] | Cta
_Pose: TypeAlias = ArrayLike | Pose | HasMatrix | None
_Faces: TypeAlias = NDArray[np.integer[Any]] | Sequence[Sequence[int] | NDArray[np.integer[Any]]]
_Outcome: TypeAlias = Contact | Grazing | Separated
_Clearance: TypeAlias = Blocked | Slides | Behind | Separated | Overlapping

__all__ = [
    "Assembly",
    "Behind",
    "Blocked",
    "Cast",
    "Certificate",
    "Contact",
    "ContactRange",
    "ConvexPolyhedron",
    "Cta",
    "Depth",
    "DirectionalDepth",
    "Distance",
    "Feature",
    "Features",
    "FirstContact",
    "FreeDirections",
    "Grazing",
    "Intersection",
    "LastContact",
    "Motion",
    "MotionCast",
    "MotionClearance",
    "NearbyObstacles",
    "NearestObstacle",
    "ObstacleClearance",
    "Obstacles",
    "OffsetReport",
    "OverlapDepth",
    "Overlapping",
    "Pair",
    "PathContact",
    "Planned",
    "Pose",
    "Robot",
    "Separated",
    "Separation",
    "ShrinkReport",
    "Slides",
    "Solid",
    "SolidBlocked",
    "SolidCast",
    "SolidCertificate",
    "SolidContact",
    "SolidFree",
    "SolidOverlapping",
    "Steps",
    "Tracker",
    "WaysOut",
    "Within",
    "ask_many",
    "ask_motions",
    "ask_pairs",
    "ask_paths",
    "cast",
    "clearance",
    "contact_range",
    "depth",
    "directional_depth",
    "distance",
    "first_contact",
    "free_directions",
    "intersects",
    "motion_clearance",
    "read",
    "ways_out",
    "within",
]
_SolidClearance: TypeAlias = SolidBlocked | SolidFree | SolidOverlapping

@type_check_only
class HasMatrix(Protocol):
    """A rotation or a placement of another package, scipy's for one."""

    def as_matrix(self) -> Any: ...

@final
class Pose:
    """A rigid placement of a body in the world: ``x_world = R @ x_body + t``.

    Parameters
    ----------
    source : array_like, Pose or object with ``as_matrix()``, optional
        A translation ``(3,)``; a translation and a unit quaternion ``(7,)``: x, y, z, then
        qx, qy, qz, qw; a matrix ``(3, 4)`` or ``(4, 4)``, whose entries are taken as they are; or
        something that has one (``scipy.spatial.transform``). The identity without. A rotation of few
        digits, off one by more than 1e-6 and at most 0.02, becomes the nearest rotation, with a
        ``RoundedPoseWarning``.

    Raises
    ------
    PoseError
        A rotation that is off one by more than 0.02, a translation that is not finite or out of range.
    InputError
        Another shape.

    Examples
    --------
    >>> from colltrans import Pose
    >>> turned = Pose([1, 2, 3, 0, 0, 1, 0])
    >>> turned.translation
    array([1., 2., 3.])
    >>> turned.rotation[0]
    array([-1.,  0.,  0.])
    """

    def __new__(cls, source: _Pose = None) -> Pose: ...
    @property
    def translation(self) -> _Floats:
        """ndarray of shape (3,): The translation ``t``, in world units."""
    @property
    def rotation(self) -> _Floats:
        """ndarray of shape (3, 3): The matrix ``R``, whose nine entries define where a body is."""
    @property
    def quaternion(self) -> _Floats:
        """ndarray of shape (4,): The rotation as a unit quaternion x, y, z, w, rounded."""
    def as_matrix(self) -> _Floats:
        """The matrix of shape (4, 4)."""
    def inverse(self) -> Pose:
        """The pose that undoes this one, to rounding error."""
    def __matmul__(self, first: Pose, /) -> Pose: ...
    def __rmatmul__(self, value: Pose, /) -> Pose: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class ConvexPolyhedron:
    """A convex polyhedron in its own frame: the convex hull of points.

    Built once, asked as often as one likes, from any thread; it never changes. Flat polygons,
    segments and points are bodies too.

    Parameters
    ----------
    points : array_like of shape (N, 3)
        In the body frame, in any unit of length. Interior points are dropped.

    Raises
    ------
    BuildError
        No points, coordinates that are not finite or out of range.
    InputError
        No array of that shape.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron
    >>> tetrahedron = ConvexPolyhedron([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> tetrahedron
    ConvexPolyhedron(4 vertices, 6 edges, 4 faces)
    """

    def __new__(cls, points: ArrayLike) -> ConvexPolyhedron: ...
    @staticmethod
    def from_mesh(
        vertices: ArrayLike, faces: _Faces, convex_tolerance: float = 0.0
    ) -> ConvexPolyhedron:
        """A closed convex surface.

        Parameters
        ----------
        vertices : array_like of shape (N, 3)
            In the body frame. Those that no face uses are ignored.
        faces : array_like of shape (M, k), or a sequence of sequences
            Vertex indices, counter-clockwise as seen from outside.
        convex_tolerance : float
            How far below the convex hull the surface may lie, a length. Rounding error is
            tolerated in any case. The hull is what is kept.

        Returns
        -------
        ConvexPolyhedron

        Raises
        ------
        BuildError
            A surface that is open, inside out or not convex, with the place.

        Examples
        --------
        >>> from colltrans import BuildError, ConvexPolyhedron
        >>> vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> ConvexPolyhedron.from_mesh(vertices, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
        ConvexPolyhedron(4 vertices, 6 edges, 4 faces)
        >>> try:
        ...     ConvexPolyhedron.from_mesh(vertices, [[0, 2, 1], [0, 1, 3], [1, 2, 3]])
        ... except BuildError as error:
        ...     print(error)
        the surface is open: the edge from vertex 0 to vertex 2 of face 0 has no face on its other side
        """
    @staticmethod
    def from_trimesh(mesh: Any, convex_tolerance: float = 0.0) -> ConvexPolyhedron:
        """From a mesh of trimesh, or anything with ``vertices`` and ``faces``: a closed convex surface.

        Parameters
        ----------
        mesh : object
        convex_tolerance : float
            As for :meth:`from_mesh`.

        Returns
        -------
        ConvexPolyhedron
        """
    @staticmethod
    def cuboid(low: ArrayLike, high: ArrayLike) -> ConvexPolyhedron:
        """The box between two corners.

        Parameters
        ----------
        low, high : array_like of shape (3,)
            Opposite corners. A coordinate in common makes a flat box.

        Returns
        -------
        ConvexPolyhedron

        Examples
        --------
        >>> from colltrans import ConvexPolyhedron
        >>> ConvexPolyhedron.cuboid([-2, -2, -1], [2, 2, 0]).volume
        16.0
        """
    @staticmethod
    def from_json(text: str) -> ConvexPolyhedron:
        """From what `to_json` has written, exact in bits."""
    def to_json(self) -> str:
        """The body as text: vertices and faces in their order, exact in bits."""
    @property
    def vertices(self) -> _Floats:
        """ndarray of shape (N, 3): The vertices, in the body frame."""
    @property
    def input_indices(self) -> _Indices:
        """ndarray of shape (N,): For each vertex its index in the points or mesh it was made from."""
    @property
    def faces(self) -> list[_Indices]:
        """list of ndarray: The vertices of each face, counter-clockwise as seen from outside."""
    def face_normal(self, face: int) -> _Floats:
        """Unit normal of a face, outwards, in the body frame.

        Parameters
        ----------
        face : int

        Returns
        -------
        ndarray of shape (3,)
        """
    @property
    def dimension(self) -> int:
        """int: 3 for a body with a volume, 2 for a flat polygon, 1 for a segment, 0 for a point."""
    @property
    def hull_error(self) -> float:
        """float: How far from the body an input point lies at most, a length of the size of rounding."""
    @property
    def dent(self) -> float:
        """float: How deep the surface of the mesh that the body was made of lies below the body.

        0 for a mesh that is convex to rounding error or to the precision of its file, and for a body that is
        not made of a mesh. Otherwise the mesh is convex only to within the tolerance, and answers are about the
        hull of its vertices.
        """
    @property
    def volume(self) -> float:
        """float: The volume, in the cube of the unit of length."""
    def support(self, direction: ArrayLike) -> int:
        """The vertex farthest along a direction.

        Parameters
        ----------
        direction : array_like of shape (3,)
            In the body frame, of any length.

        Returns
        -------
        int
            One of the farthest, to within rounding error.
        """
    def shrunk(self, amount: float) -> tuple[ConvexPolyhedron, OffsetReport]:
        """What lies at least so deep below every face plane.

        Every face plane moves inwards; where a face is too small to stay, the planes around it meet
        without it. Vertices are numbered anew; ``input_indices`` of the result has for each the input
        of the one that it comes from.

        Parameters
        ----------
        amount : float
            A length, not negative. 0 is the body itself, whatever it is.

        Returns
        -------
        ConvexPolyhedron
        OffsetReport
            How far vertices went, and which faces are gone.

        Raises
        ------
        BuildError
            A body that holds no ball of this radius, with a radius that it does hold; so also a flat
            polygon, a segment, a point. An amount that is negative or not finite.

        Examples
        --------
        >>> from colltrans import BuildError, ConvexPolyhedron
        >>> plate = ConvexPolyhedron.cuboid([0, 0, 0], [4, 4, 1])
        >>> smaller, report = plate.shrunk(0.25)
        >>> smaller.volume, round(report.farthest, 9), len(report.vanished)
        (6.125, 0.433012702, 0)
        >>> try:
        ...     plate.shrunk(0.75)
        ... except BuildError as error:
        ...     print(error)
        shrunk by 0.75 nothing is left of the body: it holds no ball of this radius, one of radius 0.5 it does
        """
    def grown(self, amount: float) -> tuple[ConvexPolyhedron, OffsetReport]:
        """What lies at most so far outside every face plane, for a margin to be kept.

        Every face plane moves outwards, and edges and corners stay as sharp as they are: all points
        within the amount of the body are in it, and beyond sharp corners more. A flat polygon becomes
        a plate twice as thick as the amount. Vertices are numbered as by :meth:`shrunk`.

        Parameters
        ----------
        amount : float
            A length, not negative. 0 is the body itself, whatever it is.

        Returns
        -------
        ConvexPolyhedron
        OffsetReport
            How far vertices went, and which faces are gone.

        Raises
        ------
        BuildError
            A segment or a point, which have no faces. An amount that is negative, not finite, or so
            large that coordinates leave the exact range.

        Examples
        --------
        >>> from colltrans import ConvexPolyhedron
        >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
        >>> larger, _ = cube.grown(0.5)
        >>> round(larger.volume, 9)
        8.0
        """
    def show(self, **options: Any) -> Any:
        """A picture of it: see :func:`colltrans.show`."""
    def prepare(self) -> None:
        """Builds the planar sections on which ``solver="cta"`` works, unless they are there.

        The first cast with that solver builds them otherwise, and takes as much longer. Other solvers
        need nothing of the kind.

        Examples
        --------
        >>> from colltrans import ConvexPolyhedron
        >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
        >>> before = cube.nbytes
        >>> cube.prepare()
        >>> cube.nbytes > before
        True
        """
    @property
    def nbytes(self) -> int:
        """int: Bytes of memory that the body occupies now; the sections that ``solver="cta"`` needs count
        once they are built (:meth:`prepare`).
        """
    @property
    def notes(self) -> list[str]:
        """list of str: What was mended when it was read from a file, and by how much its hull exceeds it."""
    @staticmethod
    def _read(text: str, notes: list[str], dent: float | None) -> ConvexPolyhedron: ...
    def __reduce__(self) -> tuple[Any, Any]: ...
    def __copy__(self) -> ConvexPolyhedron: ...
    def __deepcopy__(self, _memo: Any) -> ConvexPolyhedron: ...

@final
class OffsetReport:
    """What became of a convex body whose faces were moved."""

    __match_args__: Final = ("farthest", "vanished")
    @property
    def farthest(self) -> float:
        """float: The largest distance of a vertex from the one that it comes from, a length."""
    @property
    def vanished(self) -> _Indices:
        """ndarray: Faces of the body as it was of which nothing is left, in increasing order."""
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class ShrinkReport:
    """What shrinking, or growing, could not do to a solid as it should."""

    __match_args__: Final = ("farthest", "stuck", "inverted")
    @property
    def farthest(self) -> float:
        """float: The largest displacement of a vertex, a length."""
    @property
    def stuck(self) -> _Indices:
        """ndarray: Vertices that stay, because no displacement is inwards for all facets around them;
        indices of the input.
        """
    @property
    def inverted(self) -> _Indices:
        """ndarray: Facets that turned inside out, or passed through others, because the body (or a gap in
        it that grows shut) is thinner than twice the amount there; indices of the input, in increasing
        order.
        """
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Assembly:
    """The extension's half of ``colltrans.Assembly``."""

    def __new__(cls, parts: list[tuple[str, ArrayLike, Any]]) -> Assembly: ...
    @staticmethod
    def read(
        path: str | PathLike[str],
        packages: Sequence[str | PathLike[str]],
        skip_missing: bool,
        visual: bool,
        joints: dict[str, float],
        allow_outside: bool,
        as_is: bool,
        split: str,
        glb: bytes | None,
    ) -> Assembly: ...
    @property
    def chord_errors(self) -> list[float | None]: ...
    def with_fixed(self, names: list[str]) -> Assembly: ...
    def with_ignored(self, pairs: list[tuple[str, str]], always: bool) -> Assembly: ...
    def with_before(self, first: list[str], second: list[str]) -> Assembly: ...
    def with_together(self, names: list[str]) -> Assembly: ...
    def with_subassembly(self, name: str, parts: list[str]) -> Assembly: ...
    def with_never(self, names: list[str], along: ArrayLike, within: float) -> Assembly: ...
    def with_pair(
        self, first: list[str], second: list[str], role: str | None, tolerance: float | None
    ) -> Assembly: ...
    def suggestions(
        self, tolerance: float | None, stuck: list[list[str]]
    ) -> list[tuple[list[int], str | None, float | None, str]]: ...
    def group(self, names: list[str]) -> list[int]: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def unit(self) -> str | None: ...
    @property
    def notes(self) -> list[str]: ...
    def meshes(self) -> list[tuple[_Floats, _Indices]]:
        """The vertices and triangles of all parts, in the world."""
    def index(self, name: str) -> int: ...
    def rooms(
        self, directions: ArrayLike, tolerance: float | None, ignore_overlaps: bool
    ) -> list[tuple[list[float], list[int]]]: ...
    def blocking(
        self, direction: ArrayLike, tolerance: float | None, ignore_overlaps: bool
    ) -> list[list[list[int]]]: ...
    def plan(
        self,
        directions: ArrayLike,
        samples: int,
        legs: int,
        proofs: bool,
        tolerance: float | None,
        ignore_overlaps: bool,
        gravity: ArrayLike | None,
        wanted: list[int],
        times: dict[str, float],
    ) -> tuple[
        list[
            tuple[
                list[int],
                list[float],
                float,
                list[float],
                list[
                    list[
                        tuple[
                            list[int],
                            list[float],
                            float,
                            tuple[list[float], float, float, list[float], float | None, str] | None,
                        ]
                    ]
                ],
                int | None,
                list[int],
                list[list[int]],
                list[tuple[list[int], str | None, float | None, str]],
                list[list[int]],
            ]
        ],
        list[tuple[str, list[int], float]],
        list[int],
        list[int],
        list[tuple[list[int], int, int | None, str, list[tuple[int, list[list[int]]]]]],
        tuple[list[int], list[int], bool, bool] | None,
        list[list[int]],
        list[tuple[int, list[int]]],
        list[float],
        Planned,
    ]: ...
    def removal_map(
        self,
        group: list[int],
        samples: int,
        border: float,
        tolerance: float | None,
        ignore_overlaps: bool,
    ) -> tuple[
        list[list[float]],
        tuple[list[float], list[int]],
        list[tuple[float, list[float]]],
        list[list[float]],
    ]: ...

@final
class Planned:
    """A plan, and of what it is one."""

    def report(self, title: str) -> str:
        """The page that is printed for the workshop."""

@final
class Cast:
    """A query as a value: two placed bodies and a direction, asked what one likes, saved and replayed.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron
        The body that moves, and the one that does not.
    direction : array_like of shape (3,)
        Of the world, of any length; translations count in multiples of it.
    moving_pose, fixed_pose : array_like or Pose, optional
        Where the bodies are; see :class:`Pose`.
    graze_tolerance : float
        Sideways overlaps up to this length count as grazing. 0 stands for rounding error.
    keep : float
        A gap to be kept, a length: all questions are then about where the bodies are as near as that, not
        about where they touch. Points of answers are those that are the gap apart.
    solver : {"auto", "cta", "portal"} or Cta
        How the search is narrowed. Answers and certificates are the same. A body's first query with
        "cta" that needs its sections makes them, and pays for it.

    Raises
    ------
    QueryError
        A direction that is zero or out of range, a tolerance or a gap that is negative.
    PoseError
        A pose that is none.

    Examples
    --------
    >>> from colltrans import Cast, ConvexPolyhedron
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> query = Cast(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0])
    >>> query.first_contact().translation
    2.0
    >>> Cast.from_json(query.to_json()).first_contact().translation
    2.0
    """

    def __new__(
        cls,
        moving: ConvexPolyhedron,
        fixed: ConvexPolyhedron,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        keep: float = 0.0,
        solver: _Solver = "auto",
    ) -> Cast: ...
    def first_contact(self) -> _Outcome:
        """At which translation do the bodies first meet? See :func:`cast`."""
    def contact_range(self) -> ContactRange | Separated:
        """At which translations do they first and last meet? See :func:`contact_range`."""
    def clearance(self) -> _Clearance:
        """How far can the moving body move from where it is? See :func:`clearance`."""
    def directional_depth(self) -> DirectionalDepth:
        """How far must it go back until the overlap ends? See :func:`directional_depth`."""
    def intersects(self) -> Intersection:
        """Do the bodies meet where they are? See :func:`intersects`."""
    def reversed(self) -> Cast:
        """The same bodies where they are, and the direction turned round."""
    def verify(self, proof: Certificate | Separation) -> float:
        """Checks a proof against the two bodies, with nothing of the search that found it.

        Parameters
        ----------
        proof : Certificate or Separation

        Returns
        -------
        float
            The gap, in multiples of the direction, or the margin, a length, that is really proven.

        Raises
        ------
        CertificateError
            What is not proven.
        """
    def to_json(self) -> str:
        """The query as text: bodies, poses, direction and choices, exact in bits.

        ``colltrans replay`` of the command line reads the same.
        """
    @staticmethod
    def from_json(text: str) -> Cast:
        """From what `to_json`, or the command line, has written."""
    @property
    def moving(self) -> ConvexPolyhedron:
        """ConvexPolyhedron: The moving body."""
    @property
    def fixed(self) -> ConvexPolyhedron:
        """ConvexPolyhedron: The fixed body."""
    @property
    def moving_pose(self) -> Pose:
        """Pose: Where the moving body is."""
    @property
    def fixed_pose(self) -> Pose:
        """Pose: Where the fixed body is."""
    @property
    def direction(self) -> _Floats:
        """ndarray of shape (3,): The direction, as given."""
    @property
    def graze_tolerance(self) -> float:
        """float: Sideways overlaps up to this length count as grazing."""
    @property
    def keep(self) -> float:
        """float: The gap to be kept; 0 if there is none."""
    @property
    def solver(self) -> _Solver:
        """str: How the search is narrowed."""
    def __reduce__(self) -> tuple[Any, Any]: ...
    def show(self, **options: Any) -> Any:
        """A picture of the bodies and of the first contact: see :func:`colltrans.show`."""

@final
class Certificate:
    """The proof of a contact: both bounds of the collision translation, rounded outwards.

    A supporting plane proves the lower bound, three weighted pairs of vertices the upper one.
    """

    __match_args__: Final = ("lower", "upper")
    @property
    def lower(self) -> float:
        """float: The proven lower bound, in multiples of the direction."""
    @property
    def upper(self) -> float:
        """float: The proven upper bound; infinite where bodies only touch sideways."""
    @property
    def gap(self) -> float:
        """float: ``upper - lower``."""
    @property
    def rounding(self) -> float:
        """float: What rounding alone can make of the gap."""
    @property
    def normal(self) -> _Floats:
        """ndarray of shape (3,): Unit normal of the supporting plane, in the world."""
    @property
    def pairs(self) -> _Indices:
        """ndarray of shape (3, 2): Vertices of the moving and of the fixed body (their own numbers)."""
    @property
    def weights(self) -> _Floats:
        """ndarray of shape (3,): Weights of the pairs, not negative, of sum 1."""
    def verify(self, query: Cast | None = None) -> float:
        """Checks the proof against the two bodies alone.

        Parameters
        ----------
        query : Cast, optional
            What it is to be a proof of; by default the query that was answered.

        Returns
        -------
        float
            The gap that is really proven, in multiples of the direction.

        Raises
        ------
        CertificateError
            What is not proven.
        """
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Separation:
    """The proof that two bodies never meet along a direction: a plane parallel to it between them."""

    __match_args__: Final = ("normal", "margin")
    @property
    def normal(self) -> _Floats:
        """ndarray of shape (3,): Unit normal of the plane, in the world, from the moving body to the
        fixed one.
        """
    @property
    def margin(self) -> float:
        """float: A lower bound of the distance of the shadows, a length."""
    def verify(self, query: Cast | None = None) -> float:
        """Checks the proof against the two bodies alone.

        Parameters
        ----------
        query : Cast, optional
            What it is to be a proof of; by default the query that was answered.

        Returns
        -------
        float
            The margin that is really proven, a length.

        Raises
        ------
        CertificateError
            What is not proven.
        """
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Steps:
    """Work done for one answer."""

    @property
    def planar_problems(self) -> int:
        """int: Planar problems solved."""
    @property
    def supports(self) -> int:
        """int: Supporting planes computed."""
    @property
    def pivots(self) -> int:
        """int: Portals visited."""
    @property
    def iterations(self) -> int:
        """int: Iterations of inner loops."""
    @property
    def region_sides(self) -> int:
        """int: Sides that the region of section levels had at most; 0 if there was none."""
    @property
    def started_from(self) -> Literal["scratch", "region", "features"]:
        """str: ``"scratch"``, or of a tracker ``"features"`` or ``"region"``."""
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Feature:
    """A vertex, an edge or a face."""

    __match_args__: Final = ("kind", "vertices")
    @property
    def kind(self) -> Literal["vertex", "edge", "face"]:
        """str: ``"vertex"``, ``"edge"`` or ``"face"``."""
    @property
    def vertices(self) -> _Indices:
        """ndarray: Its vertices, by the numbers of the points or the mesh that the body was made from."""
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Features:
    """The parts of both bodies that touch."""

    __match_args__: Final = ("moving", "fixed")
    @property
    def moving(self) -> Feature:
        """Feature: Of the moving body."""
    @property
    def fixed(self) -> Feature:
        """Feature: Of the fixed body."""
    def __reduce__(self) -> tuple[Any, Any]: ...

@type_check_only
class _Answer:
    def show(self, **options: Any) -> Any: ...
    def to_dict(self) -> dict[str, Any]: ...
    def proof_json(self) -> str: ...
    def save_proof(self, path: str | PathLike[str]) -> None: ...
    @staticmethod
    def _of(query: Any, text: str) -> Any: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@type_check_only
class _ConvexAnswer(_Answer):
    @property
    def query(self) -> Cast: ...

@type_check_only
class _SolidAnswer(_Answer):
    @property
    def query(self) -> SolidCast: ...

@final
class Contact(_ConvexAnswer):
    """Where the bodies first meet along the direction."""

    __match_args__: Final = ("translation", "normal", "point")
    @property
    def translation(self) -> float:
        """float: The collision translation, in multiples of the direction. Negative: a contact that
        lies behind, or an overlap now.
        """
    @property
    def normal(self) -> _Floats:
        """ndarray of shape (3,): Unit contact normal in the world, from the moving body to the fixed one."""
    @property
    def point(self) -> _Floats:
        """ndarray of shape (3,): The contact point, in the world."""
    @property
    def point_at_start(self) -> _Floats:
        """ndarray of shape (3,): The same point of the moving body before it moves, in the world."""
    @property
    def features(self) -> Features:
        """Features: The vertex, edge or face of each body in the contact plane."""
    @property
    def certificate(self) -> Certificate:
        """Certificate: Both bounds with their proofs."""
    @property
    def pose_before(self) -> Pose:
        """Pose: The moving body's pose after the motion up to this contact and not beyond, whatever
        rounding does.
        """
    @property
    def solver(self) -> _Solver:
        """str: The solver that found it."""
    @property
    def steps(self) -> Steps:
        """Steps: Work done."""

@final
class Grazing(_ConvexAnswer):
    """The bodies slide along each other: their shadows overlap by no more than the graze tolerance."""

    __match_args__: Final = ("overlap", "contact")
    @property
    def overlap(self) -> float:
        """float: How far the shadows overlap, a length; negative if they miss by less than rounding
        can tell.
        """
    @property
    def separating_direction(self) -> _Floats:
        """ndarray of shape (3,): Unit vector of the world, across the direction, from the moving body's
        shadow to the fixed one's.
        """
    @property
    def contact(self) -> Contact:
        """Contact: The contact if the overlap is taken for real."""

@final
class Separated(_ConvexAnswer):
    """The bodies never meet along the direction."""

    __match_args__: Final = ("margin", "normal")
    @property
    def margin(self) -> float:
        """float: A lower bound of the distance of the shadows, a length."""
    @property
    def normal(self) -> _Floats:
        """ndarray of shape (3,): Unit normal of a plane between them, parallel to the direction."""
    @property
    def certificate(self) -> Separation:
        """Separation: The proof."""
    @property
    def distance(self) -> float:
        """float: How far the moving body can move: infinitely."""
    @property
    def solver(self) -> _Solver:
        """str: The solver that found it."""
    @property
    def steps(self) -> Steps:
        """Steps: Work done."""

@final
class ContactRange(_ConvexAnswer):
    """All translations at which the bodies meet, with what touches at either end."""

    __match_args__: Final = ("interval",)
    @property
    def interval(self) -> tuple[float, float]:
        """tuple of float: First and last translation, in multiples of the direction."""
    @property
    def first(self) -> Contact | Grazing:
        """Contact or Grazing: The first contact along the direction."""
    @property
    def last(self) -> LastContact:
        """LastContact: The last contact along the direction."""

@final
class LastContact:
    """Where the bodies last meet along the direction: beyond it they are apart.

    ``turned`` is the same as the first contact of the query turned round, which has the proof.
    """

    __match_args__: Final = ("translation", "normal", "point")
    @property
    def translation(self) -> float:
        """float: The translation, in multiples of the direction."""
    @property
    def bounds(self) -> tuple[float, float]:
        """tuple of float: Proven bounds of the translation; beyond the second the bodies never meet."""
    @property
    def normal(self) -> _Floats:
        """ndarray of shape (3,): Unit contact normal in the world, from the moving body to the fixed one."""
    @property
    def point(self) -> _Floats:
        """ndarray of shape (3,): The contact point, in the world."""
    @property
    def features(self) -> Features:
        """Features: The vertex, edge or face of each body in the contact plane."""
    @property
    def query(self) -> Cast:
        """Cast: The query."""
    @property
    def turned(self) -> Contact | Grazing:
        """Contact or Grazing: The same as the first contact of the query turned round, with its proof:
        translations count the other way.
        """
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Blocked(_ConvexAnswer):
    """The moving body can move until it touches."""

    __match_args__: Final = ("distance", "contact")
    @property
    def distance(self) -> float:
        """float: How far it may safely move, in multiples of the direction: never more than it can."""
    @property
    def contact(self) -> Contact:
        """Contact: What stops it."""

@final
class Slides(_ConvexAnswer):
    """The moving body slides along the other one, as far as it likes."""

    __match_args__: Final = ("grazing",)
    @property
    def distance(self) -> float:
        """float: Infinite."""
    @property
    def grazing(self) -> Grazing:
        """Grazing: Along what it slides."""

@final
class Behind(_ConvexAnswer):
    """The last contact lies behind, or is here and the moving body leaves it."""

    __match_args__: Final = ("contact",)
    @property
    def distance(self) -> float:
        """float: Infinite."""
    @property
    def contact(self) -> Contact:
        """Contact: The last one: the first one of the query turned round."""

@final
class Overlapping(_ConvexAnswer):
    """The bodies overlap where they are, by more than rounding error."""

    __match_args__: Final = ("first", "last")
    @property
    def distance(self) -> None:
        """None: There is none."""
    @property
    def first(self) -> Contact:
        """Contact: The first contact, behind."""
    @property
    def last(self) -> LastContact:
        """LastContact: The last contact, ahead."""

@final
class DirectionalDepth(_ConvexAnswer):
    """How far the moving body has to go back until the overlap has ended."""

    __match_args__: Final = ("depth",)
    @property
    def depth(self) -> float:
        """float: In multiples of the direction, never less than the true depth; 0 without overlap."""
    @property
    def clearance(self) -> _Clearance:
        """Blocked or Slides or Behind or Separated or Overlapping: What it follows from."""

@final
class Intersection(_ConvexAnswer):
    """Whether the bodies meet where they are: true or false in a condition."""

    __match_args__: Final = ("meets",)
    @property
    def meets(self) -> bool:
        """bool: Whether they have a point in common, to within rounding error."""
    @property
    def direction(self) -> _Floats:
        """ndarray of shape (3,): The direction between the centres, of the cast that found out."""
    @property
    def outcome(self) -> _Outcome:
        """Contact or Grazing or Separated: What that cast found."""
    def __bool__(self) -> bool: ...

@final
class Solid:
    """A part that need not be convex: a closed surface of polygons, decided exactly.

    Parameters
    ----------
    vertices : array_like of shape (N, 3)
        In the body frame, in any unit. Vertices with equal coordinates are one.
    faces : array_like of shape (M, k), or a sequence of sequences
        Vertex indices, counter-clockwise as seen from outside.
    open : bool
        Whether the surface may be open, as a scan is: it blocks and is blocked, but nothing is ever
        inside it.

    Raises
    ------
    BuildError
        A surface that is open, or crosses itself in a polygon, with the place.

    Examples
    --------
    >>> from colltrans import Solid
    >>> Solid([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...       [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    Solid(4 vertices, 4 triangles)
    """

    def __new__(
        cls, vertices: ArrayLike, faces: _Faces | None = None, *, open: bool = False
    ) -> Solid: ...
    @staticmethod
    def from_pieces(pieces: Sequence[Solid | ConvexPolyhedron]) -> Solid:
        """The union of several bodies, which may overlap.

        Parameters
        ----------
        pieces : sequence of Solid or ConvexPolyhedron
            Vertices and faces are numbered through.

        Returns
        -------
        Solid

        Examples
        --------
        >>> from colltrans import ConvexPolyhedron, Solid
        >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
        >>> post = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 4])
        >>> Solid.from_pieces([cube, post])
        Solid(16 vertices, 24 triangles)
        """
    @staticmethod
    def from_trimesh(mesh: Any) -> Solid:
        """From a mesh of trimesh, or anything with ``vertices`` and ``faces``.

        Parameters
        ----------
        mesh : object

        Returns
        -------
        Solid
        """
    @staticmethod
    def read(
        path: str | PathLike[str],
        *,
        open: bool = False,
        scale: float = 1.0,
        merge_tolerance: float | None = None,
    ) -> Solid:
        """Reads a part from a mesh file: STL, OBJ, PLY, OFF or COLLADA.

        Parameters
        ----------
        path : str or os.PathLike
        open : bool
            Whether the surface may be open.
        scale : float
            Lengths are multiplied by this, after the merging.
        merge_tolerance : float, optional
            Up to which distance vertices on open edges are merged. By default a few units in the
            last place of the largest coordinate.

        Returns
        -------
        Solid

        Raises
        ------
        MeshError
            A file that cannot be read, with the place.
        BuildError
            A surface that is open or not one.
        """
    def shrunk(self, amount: float) -> tuple[Solid, ShrinkReport]:
        """The solid with every facet plane moved inwards.

        Vertices and facets keep their numbers. What cannot be moved so is counted and named: walls
        thinner than twice the amount, and corners between facets of which none can move inwards
        without another moving outwards.

        Parameters
        ----------
        amount : float
            By how much, in the unit of the body.

        Returns
        -------
        Solid
        ShrinkReport

        Raises
        ------
        BuildError
            An amount that is negative or not finite, or of which nothing is left.

        Examples
        --------
        >>> from colltrans import ConvexPolyhedron, Solid
        >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
        >>> step = Solid.from_pieces([cube, ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 4])])
        >>> smaller, report = step.shrunk(0.25)
        >>> smaller.bounds.tolist(), report.stuck.tolist(), report.inverted.tolist()
        ([[0.25, 0.25, 0.25], [0.75, 0.75, 3.75]], [], [])
        """
    def grown(self, amount: float) -> tuple[Solid, ShrinkReport]:
        """The solid with every facet plane moved outwards: for a margin to be kept.

        Parameters
        ----------
        amount : float
            By how much, in the unit of the body.

        Returns
        -------
        Solid
        ShrinkReport

        Raises
        ------
        BuildError
            As of :meth:`shrunk`.
        """
    @property
    def vertices(self) -> _Floats:
        """ndarray of shape (N, 3): The vertices in use, in the body frame."""
    @property
    def triangles(self) -> _Indices:
        """ndarray of shape (M, 3): The triangles, as indices into ``vertices``."""
    @property
    def input_indices(self) -> _Indices:
        """ndarray of shape (N,): For each vertex its index in the input."""
    @property
    def face_indices(self) -> _Indices:
        """ndarray of shape (M,): For each triangle the face of the input that it is a part of."""
    @property
    def is_closed(self) -> bool:
        """bool: Whether all shells are closed; if not, the body is a surface, at least in part."""
    @property
    def shells(self) -> dict[str, int]:
        """dict of str to int: How many shells are ``closed`` (with an inside), ``sided`` (open, but all but
        closed) and ``sheet``. Open ones block from both sides, rims included; sheets are neither shrunk
        nor grown.
        """
    @property
    def notes(self) -> list[str]:
        """list of str: What was mended to make it of its mesh, or is not as it is in the file."""
    @property
    def precision(self) -> float:
        """float: How far apart vertices of its file may be written that were meant to be one, a length: from
        it comes the default tolerance of a query. 0 for what was not read from a file.
        """
    @property
    def volume(self) -> float:
        """float: The volume, in the cube of the unit of length."""
    @property
    def bounds(self) -> _Floats:
        """ndarray of shape (2, 3): Smallest and largest coordinates."""
    def show(self, **options: Any) -> Any:
        """A picture of it: see :func:`colltrans.show`."""
    @property
    def nbytes(self) -> int:
        """int: Bytes of memory that the body occupies, without what it was made of."""
    @staticmethod
    def _moved(of: Solid, by: float) -> Solid: ...
    @staticmethod
    def _mesh(
        v: _Floats, f: list[_Indices], open: bool, scale: float, precision: float, notes: list[str]
    ) -> Solid: ...
    def __reduce__(self) -> tuple[Any, Any]: ...
    def __copy__(self) -> Solid: ...
    def __deepcopy__(self, _memo: Any) -> Solid: ...

@final
class SolidCast:
    """A query about solids as a value: two placed bodies and a direction.

    Parameters
    ----------
    moving, fixed : Solid or ConvexPolyhedron
        The body that moves, and the one that does not.
    direction : array_like of shape (3,)
        Of the world, of any length; translations count in multiples of it.
    moving_pose, fixed_pose : array_like or Pose, optional
        Where the bodies are; see :class:`Pose`.
    tolerance : float, optional
        Both bodies are shrunk by half of this length, so that parts that fit do not jam. By default
        as on the command line: twice what rounding may have made of the coordinates of both files
        (:attr:`Solid.precision`), and no less than what turned poses need; 0 for bodies that are not of
        files where both poses turn by quarter turns.
    keep : float
        A gap to be kept, a length: asked is where the bodies, shrunk by half the tolerance each, are as near
        as that, not where they touch.
    ignore_start_overlaps : bool
        Whether facets that cross now do not block, but contacts that begin later do.

    Examples
    --------
    >>> from colltrans import Solid, SolidCast
    >>> bolt, plate = Solid.read("data/bolt.stl"), Solid.read("data/plate.off")
    >>> query = SolidCast(bolt, plate, [0, 0, -1], moving_pose=[0, 0, 7])
    >>> found = query.clearance()
    >>> query.tolerance  # the bolt is in single precision
    2.3841858407536165e-06
    >>> found.contact.translation
    7.0
    >>> 7 - 1e-11 < found.distance <= 7
    True
    >>> query.exit()
    12.0
    """

    def __new__(
        cls,
        moving: Solid | ConvexPolyhedron,
        fixed: Solid | ConvexPolyhedron,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        tolerance: float | None = None,
        keep: float = 0.0,
        ignore_start_overlaps: bool = False,
    ) -> SolidCast: ...
    def clearance(self) -> _SolidClearance:
        """How far can the moving body move from where it is, and what stops it?

        Returns
        -------
        SolidBlocked or SolidFree or SolidOverlapping
        """
    def certified_clearance(self) -> tuple[_SolidClearance, SolidCertificate]:
        """The clearance, with a proof that :meth:`verify` checks.

        Returns
        -------
        tuple of (SolidBlocked or SolidFree or SolidOverlapping, SolidCertificate)
        """
    def verify(self, proof: SolidCertificate) -> float:
        """Checks a proof against the two bodies.

        Parameters
        ----------
        proof : SolidCertificate

        Returns
        -------
        float
            How far the bounds of the distance are apart, in multiples of the direction.

        Raises
        ------
        CertificateError
            What is not proven.
        """
    def intersects(self) -> bool:
        """Whether the bodies as they are, as closed sets, have a point in common. The gap to be kept plays no
        part.
        """
    def least_tolerance(self) -> float | None:
        """The least tolerance with which the bodies do not overlap: 0 if they do not, None if there is
        none up to their size.
        """
    def start_overlap(self) -> SolidOverlapping | None:
        """Where the bodies, shrunk by half the tolerance, overlap, and with which tolerance they
        would not; None if they do not: what
        an answer with ``ignore_start_overlaps`` has ignored.

        Returns
        -------
        SolidOverlapping or None

        Examples
        --------
        >>> from colltrans import ConvexPolyhedron, SolidCast
        >>> table = ConvexPolyhedron.cuboid([-4, -4, -1], [4, 4, 0])
        >>> plate = ConvexPolyhedron.cuboid([0, 0, 0], [1, 2, 1])
        >>> aside = SolidCast(plate, table, [1, 0, 0], moving_pose=[0, 0, -0.125],
        ...                   ignore_start_overlaps=True)
        >>> aside.clearance()
        SolidFree()
        >>> round(aside.start_overlap().least_tolerance, 9)
        0.125
        """
    def exit(self) -> float | None:
        """Where the bodies, as they are, meet last, in multiples of the direction; None if nothing faces.
        The best estimate: for one that is safe see ``exit_bounds``.
        """
    def exit_bounds(self) -> tuple[float, float] | None:
        """The proven bounds of ``exit``, None if nothing faces: beyond the second they never meet again."""
    def reversed(self) -> SolidCast:
        """The same bodies where they are, and the direction turned round."""
    @property
    def tolerance(self) -> float:
        """float: The tolerance that is used, a length."""
    @property
    def keep(self) -> float:
        """float: The gap to be kept; 0 if there is none."""
    @property
    def moving(self) -> Solid | ConvexPolyhedron:
        """ConvexPolyhedron or Solid: The moving body."""
    @property
    def fixed(self) -> Solid | ConvexPolyhedron:
        """ConvexPolyhedron or Solid: The fixed body."""
    @property
    def moving_pose(self) -> Pose:
        """Pose: Where the moving body is."""
    @property
    def fixed_pose(self) -> Pose:
        """Pose: Where the fixed body is."""
    @property
    def direction(self) -> _Floats:
        """ndarray of shape (3,): The direction, as given."""
    def show(self, **options: Any) -> Any:
        """A picture of the bodies and of the answer: see :func:`colltrans.show`."""
    def __getnewargs_ex__(self) -> tuple[tuple[Any, ...], dict[str, Any]]: ...

@final
class SolidContact(_SolidAnswer):
    """Where a solid is stopped."""

    __match_args__: Final = ("translation", "normal", "point")
    @property
    def translation(self) -> float:
        """float: Where the faces that stop the body meet in their true place, not shrunk, in multiples of
        the direction; the best estimate.
        """
    @property
    def translation_bounds(self) -> tuple[float, float]:
        """tuple of (float, float): Its proven bounds. Up to the first the shrunk bodies do not overlap and
        those two faces have not met; beyond the second the bodies overlap: as they are, or, where
        those faces pass each other as they are, shrunk.
        """
    @property
    def shrunk_distance(self) -> float:
        """float: How far the bodies go that were shrunk by half the tolerance each, in multiples of the
        direction.
        """
    @property
    def shrunk_distance_bounds(self) -> tuple[float, float]:
        """tuple of (float, float): Its proven bounds."""
    @property
    def normal(self) -> _Floats:
        """ndarray of shape (3,): Unit contact normal in the world, from the moving body to the fixed one."""
    @property
    def point(self) -> _Floats:
        """ndarray of shape (3,): The contact point on the fixed body, in the world."""
    @property
    def point_at_start(self) -> _Floats:
        """ndarray of shape (3,): The same point of the moving body before it moves, in the world."""
    @property
    def moving_feature(self) -> Feature:
        """Feature: What of the moving body touches: a corner, an edge from corner to corner, or the whole
        polygon of a face.
        """
    @property
    def fixed_feature(self) -> Feature:
        """Feature: What of the fixed body touches."""

@final
class SolidBlocked(_SolidAnswer):
    """A solid can move until it touches."""

    __match_args__: Final = ("distance", "contact")
    @property
    def distance(self) -> float:
        """float: How far it may safely move, in multiples of the direction: the lower bound of where it is
        stopped, and never negative.
        """
    @property
    def contact(self) -> SolidContact:
        """SolidContact: What stops it."""
    @property
    def surfaces(self) -> list[str]:
        """list of str: Which of ``moving`` and ``fixed`` are open surfaces, at least in part: what is inside
        of them is not known.
        """

@final
class SolidFree(_SolidAnswer):
    """A solid can move as far as it likes."""

    __match_args__: Final = ()
    @property
    def distance(self) -> float:
        """float: Infinite."""
    @property
    def margin(self) -> float | None:
        """float or None: The margin of a plane between the bodies, parallel to the direction, a length;
        None if there is no such plane: it slides along, or moves away.
        """
    @property
    def normal(self) -> _Floats | None:
        """ndarray of shape (3,) or None: Unit normal of that plane, in the world."""
    @property
    def surfaces(self) -> list[str]:
        """list of str: Which of ``moving`` and ``fixed`` are open surfaces, at least in part: what is inside
        of them is not known.
        """

@final
class SolidOverlapping(_SolidAnswer):
    """Two solids overlap where they are, by more than is tolerated."""

    __match_args__: Final = ("least_tolerance",)
    @property
    def distance(self) -> None:
        """None: There is none."""
    @property
    def least_tolerance(self) -> float | None:
        """float or None: The least tolerance with which they would not overlap, a length; None if there is
        none, as for open surfaces.
        """
    @property
    def place(self) -> tuple[int | None, int | None]:
        """tuple of (int or None, int or None): One of the places where the bodies, shrunk by half the
        tolerance each, overlap: a face of the moving and one of the fixed body that cross, as they
        were numbered in the input; where one of them is None, the shell with the other lies inside
        that body.
        """
    @property
    def surfaces(self) -> list[str]:
        """list of str: Which of ``moving`` and ``fixed`` are open surfaces, at least in part: what is inside
        of them is not known.
        """

@final
class SolidCertificate:
    """The proof of a clearance between solids."""

    @property
    def tolerance(self) -> float:
        """float: The tolerance by which the bodies were shrunk."""
    @property
    def lower(self) -> float:
        """float: The proven lower bound of the shrunk bodies' distance, in multiples of the direction."""
    def to_json(self) -> str:
        """The proof as text."""
    @staticmethod
    def from_json(text: str) -> SolidCertificate:
        """From what `to_json` has written. It is read, not believed."""
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Pair:
    """Two bodies where they are, as a value: asked how far they are apart, how deep they overlap.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron or Solid
        Nothing moves; the names tell them apart. If one of them is a solid, both are asked as solids.
    moving_pose, fixed_pose : array_like or Pose, optional
        Where the bodies are; see :class:`Pose`.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, Pair
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> pair = Pair(cube, cube, moving_pose=[-3, 0.5, 0])
    >>> found = pair.distance()
    >>> found.lower <= 2 <= found.upper
    True
    """

    def __new__(
        cls,
        moving: ConvexPolyhedron | Solid,
        fixed: ConvexPolyhedron | Solid,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
    ) -> Pair: ...
    def distance(self) -> Distance:
        """How far apart are the bodies, and where? See :func:`distance`."""
    def depth(self) -> Depth | OverlapDepth:
        """How deep do they overlap? See :func:`depth`."""
    def within(self, length: float) -> Within:
        """Are they closer than a length? See :func:`within`."""
    @property
    def moving(self) -> ConvexPolyhedron | Solid:
        """ConvexPolyhedron or Solid: The moving body."""
    @property
    def fixed(self) -> ConvexPolyhedron | Solid:
        """ConvexPolyhedron or Solid: The fixed body."""
    @property
    def moving_pose(self) -> Pose:
        """Pose: Where the moving body is."""
    @property
    def fixed_pose(self) -> Pose:
        """Pose: Where the fixed body is."""
    def __getnewargs_ex__(self) -> tuple[Any, dict[str, Any]]: ...
    def show(self, **options: Any) -> Any:
        """A picture of the bodies and of the shortest way between them: see :func:`colltrans.show`."""

@final
class Motion:
    """Where a body is at every time from 0 to 1: it rests, slides, turns, unscrews, is thrown, or goes
    through poses.

    Made by :meth:`still`, :meth:`slide`, :meth:`turn`, :meth:`screw`, :meth:`thrown`, :meth:`between`,
    :meth:`through` and :meth:`about`. Angles are keywords, ``degrees=`` or ``radians=``. Answers hold of the
    motion as the real function of its numbers.

    Examples
    --------
    >>> from colltrans import Motion
    >>> door = Motion.turn([0, 0, 0], [0, 0, 1], degrees=90)
    >>> door.at(1).rotation.round(12)[0]
    array([ 0., -1.,  0.])
    >>> door
    Motion.turn([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], radians=1.5707963267948966)
    """

    @staticmethod
    def still(pose: _Pose = None) -> Motion:
        """None: the body rests at a pose."""
    @staticmethod
    def slide(by: ArrayLike, *, pose: _Pose = None) -> Motion:
        """A translation from a pose on, by a vector in world units.

        Raises
        ------
        QueryError
            A vector that is not finite or out of range; so do all others.
        """
    @staticmethod
    def turn(
        point: ArrayLike,
        axis: ArrayLike,
        *angle: Never,
        degrees: float | None = None,
        radians: float | None = None,
        pose: _Pose = None,
    ) -> Motion:
        """Turns about an axis through a point of the world, counter-clockwise as seen against the axis.

        Parameters
        ----------
        point, axis : array_like of shape (3,)
            A point of the axis, and its direction, of any length above 0.
        degrees, radians : float
            The angle: one of the two, by its name.
        pose : array_like, Pose or object with ``as_matrix()``, optional
            Where the body is at time 0.

        Raises
        ------
        InputError
            An angle without its unit, with both units, or none.
        """
    @staticmethod
    def screw(
        point: ArrayLike,
        axis: ArrayLike,
        *angle: Never,
        rise: float,
        degrees: float | None = None,
        radians: float | None = None,
        pose: _Pose = None,
    ) -> Motion:
        """Turns about an axis, which itself moves along its own direction by ``rise``, a length.

        Parameters
        ----------
        point, axis, degrees, radians, pose
            As for :meth:`turn`.
        rise : float
            By how much the axis moves along its direction.
        """
    @staticmethod
    def thrown(
        center: ArrayLike, velocity: ArrayLike, angular_velocity: ArrayLike, *, pose: _Pose = None
    ) -> Motion:
        """A point of the body, given in the world, goes straight by ``velocity``, and the body turns about it
        by the angular velocity's length in radians, about its direction.
        """
    @staticmethod
    def between(start: ArrayLike | Pose, end: ArrayLike | Pose) -> Motion:
        """The screw from one pose to another, by the shorter turn; it ends there to rounding."""
    @staticmethod
    def through(poses: Iterable[ArrayLike | Pose]) -> Motion:
        """Screws from each pose to the next one, in equal times.

        Parameters
        ----------
        poses : sequence
            Of array_like or :class:`Pose` each.
        """
    @staticmethod
    def about(
        arm: ArrayLike,
        axis: ArrayLike,
        way: ArrayLike,
        *angle: Never,
        degrees: float | None = None,
        radians: float | None = None,
        pose: _Pose = None,
    ) -> Motion:
        """Makes a motion from the numbers that define it: the vector from a point of the axis to the origin of
        the body's frame, the axis, the angle, and the translation of the axis.
        """
    def at(self, time: float) -> Pose:
        """Where the body is at a time from 0 to 1, to rounding."""
    @property
    def start(self) -> Pose:
        """Pose: Where the body is at time 0."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, Any]: ...
    @staticmethod
    def _of(text: str) -> Motion: ...

_Motion: TypeAlias = Motion | _Pose

@final
class MotionCast:
    """Two bodies and what they do, as a value: asked when they first meet, saved and replayed.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron or Solid
        If one of them is a solid, both are asked as solids.
    moving_motion, fixed_motion : Motion, Pose or array_like, optional
        What they do. A :class:`Pose`, or seven numbers or a matrix that give one, stands for rest. Three
        numbers are refused, because they could be a displacement (:meth:`Motion.slide`) or a place
        (:meth:`Motion.still`).
    keep : float
        A gap to be kept, a length: asked is when the bodies are first as near as that.
    tolerance : float, optional
        Of convex bodies, a depth that is tolerated, in the place of ``keep``: asked is when they first
        overlap by more. Solids are shrunk by half of it; by default by what the precision of their files,
        and rounding, ask for.
    ignore_start_overlaps : bool
        For :meth:`clearance` of solids: whether facets that cross when the motion begins do not count until
        they are apart.

    Raises
    ------
    QueryError, PoseError, InputError
        An argument that is refused.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, Motion, MotionCast
    >>> door = ConvexPolyhedron.cuboid([0, -0.02, 0], [1, 0.02, 2])
    >>> post = ConvexPolyhedron.cuboid([0.55, 0.55, 0], [0.65, 0.65, 2])
    >>> swing = Motion.turn([0, 0, 0], [0, 0, 1], degrees=90)
    >>> found = MotionCast(door, post, moving_motion=swing).first_contact()
    >>> found.outcome, round(found.lower, 9), found.upper - found.lower < 1e-11
    ('contact', 0.432115832, True)
    >>> found.verify()
    """

    def __new__(
        cls,
        moving: ConvexPolyhedron | Solid,
        fixed: ConvexPolyhedron | Solid,
        *,
        moving_motion: _Motion = None,
        fixed_motion: _Motion = None,
        keep: float = 0.0,
        tolerance: float | None = None,
        ignore_start_overlaps: bool = False,
    ) -> MotionCast: ...
    def first_contact(self) -> FirstContact:
        """When do the bodies first meet? See :func:`first_contact`."""
    def clearance(self) -> MotionClearance:
        """How far can the body go? See :func:`motion_clearance`."""
    def to_json(self) -> str:
        """The question as text, of convex bodies: bodies, motions and what is to be kept, exact in bits.

        ``colltrans replay`` of the command line reads the same.
        """
    @staticmethod
    def from_json(text: str) -> MotionCast:
        """From what `to_json`, or the command line, has written."""
    @property
    def moving(self) -> ConvexPolyhedron | Solid:
        """ConvexPolyhedron or Solid: The moving body."""
    @property
    def fixed(self) -> ConvexPolyhedron | Solid:
        """ConvexPolyhedron or Solid: The fixed body."""
    @property
    def moving_motion(self) -> Motion:
        """Motion: What the moving body does."""
    @property
    def fixed_motion(self) -> Motion:
        """Motion: What the fixed body does."""
    @property
    def keep(self) -> float:
        """float: The gap to be kept; 0 if there is none."""
    @property
    def tolerance(self) -> float:
        """float: The depth that is tolerated; of solids the tolerance that is used."""
    @property
    def ignore_start_overlaps(self) -> bool:
        """bool: Whether what overlaps when the motion begins is ignored."""
    def show(self, **options: Any) -> Any:
        """A picture of the bodies at the start, where they touch and at the end: see :func:`colltrans.show`."""
    def __getnewargs_ex__(self) -> tuple[Any, dict[str, Any]]: ...

@final
class FirstContact(_Answer):
    """When two bodies that move first meet, from 0 at the start of the motion to 1 at its end.

    ``outcome`` is ``"contact"``: they do not meet before ``lower``, and at ``upper`` they do;
    ``"grazing"``: they come nearer than rounding can tell, not before ``lower``, and nothing is said
    after it; ``"free"``: they never meet throughout the motion (never come as near as the gap to be kept, or
    never overlap by more than the tolerance); ``"overlapping"``: they overlap when it begins;
    ``"undecided"``: the search took its maximum number of steps, they do not meet before ``lower``, and whether
    they do later is open.
    """

    __match_args__: Final = ("outcome", "lower", "upper")
    @property
    def query(self) -> MotionCast:
        """Cast or SolidCast or Pair: The query; of a last contact the one turned round."""
    @property
    def outcome(self) -> Literal["contact", "grazing", "free", "overlapping", "undecided"]:
        """str: ``"contact"``, ``"grazing"``, ``"free"``, ``"overlapping"`` or ``"undecided"``."""
    @property
    def lower(self) -> float:
        """float: The bodies do not meet before: 1 if they never do, 0 if they overlap when the motion begins."""
    @property
    def upper(self) -> float | None:
        """float or None: At this time they do meet; None where that is not proven, or they never do."""
    @property
    def poses(self) -> tuple[Pose, Pose] | None:
        """tuple of (Pose, Pose) or None: Where both bodies are at ``lower``, to rounding; None if they never
        meet or overlap at the start.
        """
    @property
    def point(self) -> _Floats | None:
        """ndarray of shape (3,) or None: The point of the fixed body that is nearest then, in the world."""
    @property
    def normal(self) -> _Floats | None:
        """ndarray of shape (3,) or None: Unit normal in the world, from the moving body to the fixed one."""
    @property
    def features(self) -> Features | None:
        """Features or None: What of each body faces the other one."""
    @property
    def looks(self) -> int:
        """int: At how many times the bodies were looked at."""
    def verify(self) -> None:
        """Checks the proof against the bodies alone; between solids they are asked once more for it.

        Raises
        ------
        CertificateError
            What is not proven.
        """

def first_contact(
    moving: ConvexPolyhedron | Solid,
    fixed: ConvexPolyhedron | Solid,
    moving_motion: _Motion,
    fixed_motion: _Motion = None,
    *,
    keep: float = 0.0,
    tolerance: float | None = None,
) -> FirstContact:
    """When do two bodies that move first meet?

    Parameters
    ----------
    moving, fixed, moving_motion, fixed_motion, keep, tolerance
        As for :class:`MotionCast`.

    Returns
    -------
    FirstContact

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, Motion, first_contact
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> slide = Motion.slide([8, 0, 0], pose=[-4, 0.5, 0])
    >>> found = first_contact(cube, cube, slide)
    >>> found.lower <= 0.375 <= found.upper, found.normal
    (True, array([1., 0., 0.]))
    """

@final
class MotionClearance(_Answer):
    """How far along its motion a body can go, from 0 at its start to 1 at its end.

    ``outcome`` is ``"blocked"``: up to ``time`` for certain, 0 if it is pushed in at once; ``"free"``: to the
    end; ``"overlapping"``: the bodies overlap when the motion begins, by more than is tolerated.
    """

    __match_args__: Final = ("outcome", "time")
    @property
    def query(self) -> MotionCast:
        """Cast or SolidCast or Pair: The query; of a last contact the one turned round."""
    @property
    def outcome(self) -> Literal["blocked", "free", "overlapping"]:
        """str: ``"blocked"``, ``"free"`` or ``"overlapping"``."""
    @property
    def time(self) -> float | None:
        """float or None: Up to then the body may go: 1 to the end; None if the bodies overlap when it begins."""
    @property
    def bounds(self) -> tuple[float, float | None] | None:
        """tuple of (float, float or None) or None: When what stops it meets in its true place: not before the
        first, for certain at the second, if there is one.
        """
    @property
    def shrunk(self) -> tuple[float, float | None] | None:
        """tuple of (float, float or None) or None: When the bodies meet as the tolerance leaves them."""
    @property
    def tolerance(self) -> float | None:
        """float or None: The tolerance that was used, a length, where something stops it."""
    @property
    def least_tolerance(self) -> float | None:
        """float or None: The least tolerance with which the bodies would not overlap when the motion begins."""
    def verify(self) -> None:
        """Checks the proof of the bounds ``shrunk`` against the bodies alone; between solids they are asked once
        more for it.

        Raises
        ------
        CertificateError
            What is not proven; all, of bodies that overlap when the motion begins, or may.
        """

def motion_clearance(
    moving: ConvexPolyhedron | Solid,
    fixed: ConvexPolyhedron | Solid,
    moving_motion: _Motion,
    fixed_motion: _Motion = None,
    *,
    keep: float = 0.0,
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> MotionClearance:
    """How far along its motion can a body go? What touches may slide, turn and leave, and is stopped where it
    is pushed in: with the tolerance, or without one with what rounding can do to a fit.

    Parameters
    ----------
    moving, fixed, moving_motion, fixed_motion, keep, tolerance, ignore_start_overlaps
        As for :class:`MotionCast`.

    Returns
    -------
    MotionClearance

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, Motion, motion_clearance
    >>> block = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> table = ConvexPolyhedron.cuboid([-4, -4, -1], [4, 4, 0])
    >>> motion_clearance(block, table, Motion.turn([0.5, 0.5, 0], [0, 0, 1], radians=2))
    MotionClearance("free", time=1.0)
    >>> motion_clearance(block, table, Motion.turn([0.5, 0.5, 0], [1, 0, 0], radians=2))
    MotionClearance("blocked", time=0.0)
    """

@final
class Robot:
    """A robot of URDF: links with what they collide with, and the joints between them.

    Made by :meth:`read`.
    """

    @staticmethod
    def read(
        path: str | PathLike[str],
        *,
        srdf: str | PathLike[str] | None = None,
        packages: Sequence[str | PathLike[str]] = ...,
        skip_missing: bool = False,
        allow_outside: bool = False,
        hulls: Sequence[str] = ...,
    ) -> Robot:
        """A robot of a URDF file, in metres and radians.

        Joints may be revolute, continuous, prismatic or fixed, and may follow others (``mimic``). Cylinders
        and spheres are taken as polyhedra around them.

        Parameters
        ----------
        path : str or os.PathLike
        srdf : str or os.PathLike, optional
            A file whose ``disable_collisions`` says which links are not held against each other. Without
            it these are links with one moving joint between them.
        packages : list of str or os.PathLike
            Where ``package://`` is looked for.
        skip_missing : bool
            Leave out meshes that cannot be found, with a note.
        allow_outside : bool
            Read files that the robot's file names and that lie outside of its folder and all packages.
        hulls : list of str
            Links whose meshes are taken as their convex hulls, for meshes that are no surface of a body;
            ``"*"`` is all links.

        Returns
        -------
        Robot

        Raises
        ------
        AssemblyError
            What is wrong with a file, and where.
        """
    @property
    def name(self) -> str:
        """str: Its name."""
    @property
    def links(self) -> list[str]:
        """list of str: The names of its links."""
    @property
    def joints(self) -> list[str]:
        """list of str: The joints that move by themselves, in the order of the values of a row."""
    @property
    def limits(self) -> dict[str, tuple[float, float]]:
        """dict of str to tuple of (float, float): The limits of joints that have some, in radians or metres."""
    @property
    def notes(self) -> list[str]:
        """list of str: What was noted when it was read."""
    def first_contact(
        self,
        path: ArrayLike | str | PathLike[str],
        scene: Mapping[str, ConvexPolyhedron | Solid] | None = None,
        *,
        ignore: Sequence[tuple[str, str]] = ...,
        keep: float = 0.0,
        joints: dict[str, float] = ...,
        columns: Sequence[str] | None = None,
        times: ArrayLike | None = None,
    ) -> PathContact:
        """Which two bodies first meet on a path, and when?

        All links are held against the scene, and against each other but for neighbours, or for what the
        SRDF file names. From row to row each joint goes evenly.

        Parameters
        ----------
        path : array_like of shape (N, J), or str or os.PathLike
            Rows of joint values, radians or metres, in the order of :attr:`joints`; or a CSV or JSON file
            of them.
        scene : dict of str to ConvexPolyhedron or Solid, optional
            What stands in the world, in metres, by name.
        ignore : list of tuple of (str, str)
            Pairs of links, or of a link and what stands there, that are not held against each other.
        keep : float
            A gap to be kept: asked is when two are first as near as that.
        joints : dict of str to float, optional
            Joints that rest, and their values; they have no column.
        columns : list of str, optional
            The joints of the columns, where they are in another order.
        times : array_like of shape (N,), optional
            When the rows are reached; without them rows are counted from 0.

        Returns
        -------
        PathContact

        Raises
        ------
        InputError
            Rows that do not fit the joints, names that nothing has.
        QueryError
            What the library refuses.
        """

@final
class PathContact:
    """Which two bodies first meet on a path of joint values, and when.

    ``outcome`` is ``"contact"``: no two meet before ``lower``, and at ``upper`` these two do;
    ``"grazing"``: they come nearer than rounding can tell, not before ``lower``, and nothing is said
    after it; ``"free"``: no two meet on the whole path; ``"overlapping"``: two overlap where it begins;
    ``"undecided"``: the search between the two of ``pair`` took its maximum number of steps, no two meet before
    ``lower``, and whether these two do later is open.
    """

    __match_args__: Final = ("outcome", "lower", "upper")
    @property
    def outcome(self) -> Literal["contact", "grazing", "free", "overlapping", "undecided"]:
        """str: ``"contact"``, ``"grazing"``, ``"free"``, ``"overlapping"`` or ``"undecided"``."""
    @property
    def lower(self) -> float:
        """float: No two meet before: the end of the path if none do, its beginning if two overlap there."""
    @property
    def upper(self) -> float | None:
        """float or None: At this time two do meet; None where that is not proven, or none do."""
    @property
    def pair(self) -> tuple[str, str] | None:
        """tuple of (str, str) or None: The two, links or what stands around."""
    @property
    def place(self) -> tuple[int, float] | None:
        """tuple of (int, float) or None: Where ``lower`` is: the row before, and which part of the way to the
        next one.
        """
    @property
    def point(self) -> _Floats | None:
        """ndarray of shape (3,) or None: Where the first one is nearest to the second then, in the world."""
    @property
    def normal(self) -> _Floats | None:
        """ndarray of shape (3,) or None: Unit normal in the world, from the first to the second."""
    @property
    def overlaps(self) -> list[tuple[str, str]]:
        """list of tuple of (str, str): Where the path begins with overlaps, all pairs that overlap there, or are as
        near as ``keep``.
        """
    @property
    def hulls(self) -> list[str]:
        """list of str: Links for whose meshes their convex hulls stand; a contact of one is that of its hull."""
    @property
    def pairs(self) -> int:
        """int: How many pairs of bodies were asked about."""
    @property
    def looks(self) -> int:
        """int: How often two bodies were looked at."""
    @property
    def planes(self) -> int:
        """int: Planes in the proof."""
    @property
    def notes(self) -> list[str]:
        """list of str: What was not asked though nobody said so, and values beyond a joint's limits."""
    def verify(self) -> None:
        """Checks the proof against the robot, its path and the scene alone, without a search.

        Raises
        ------
        CertificateError
            What is not proven.
        """
    def proof_json(self) -> str:
        """The proof, with all that it is about, as text: the file of ``--save-proof`` of ``colltrans path``,
        which ``colltrans verify`` checks. The question is asked once more for it.

        Returns
        -------
        str
        """
    def save_proof(self, path: str | PathLike[str]) -> None:
        """Writes :meth:`proof_json` as a file.

        Parameters
        ----------
        path : str or os.PathLike
        """
    def meshes(
        self, place: tuple[int, float] | None = None
    ) -> list[tuple[str, _Floats, NDArray[np.uint32]]]:
        """All bodies as meshes, where they are in the world at a place of the path, to rounding.

        Parameters
        ----------
        place : tuple of (int, float), optional
            A row, and which part of the way to the next one; without it that of ``lower``, where the path ends if
            nothing meets.

        Returns
        -------
        list of tuple of (str, ndarray of shape (V, 3), ndarray of shape (T, 3))
            The links' bodies, then what stands around: the name of what each belongs to, its vertices, and its
            triangles by their numbers.

        Raises
        ------
        InputError
            A place beyond the path.
        """
    def show(self, **options: Any) -> Any:
        """A picture: see :func:`colltrans.show`."""
    def __reduce__(self) -> tuple[Any, Any]:
        """What a pickle has: the file of the proof, the answer but for that, and what was noted."""
    @staticmethod
    def _of(file: str, found: str, notes: list[str]) -> PathContact: ...
    def to_dict(self) -> dict[str, Any]:
        """What it says, as plain Python: the fields of ``--json`` of ``colltrans path``, with the same bits.

        Returns
        -------
        dict
        """
    def __copy__(self) -> PathContact: ...
    def __deepcopy__(self, _memo: Any) -> PathContact: ...

@type_check_only
class _PairAnswer(_Answer):
    @property
    def query(self) -> Pair: ...

@final
class Distance(_PairAnswer):
    """How far two bodies are apart, and where they are nearest: ``lower <= true distance <= upper``."""

    __match_args__: Final = ("lower", "upper")
    @property
    def lower(self) -> float:
        """float: The bodies are not nearer; 0 if they meet, or are less apart than rounding can tell."""
    @property
    def upper(self) -> float:
        """float: They are not farther; 0 where they are proven to meet."""
    @property
    def on_moving(self) -> _Floats:
        """ndarray of shape (3,): The point of the moving body that is nearest to the fixed one, in the
        world.
        """
    @property
    def on_fixed(self) -> _Floats:
        """ndarray of shape (3,): The point of the fixed body that is nearest to the moving one, in the
        world.
        """
    @property
    def normal(self) -> _Floats | None:
        """ndarray of shape (3,) or None: Unit normal in the world, from the moving body to the fixed one; None
        if they meet.
        """
    @property
    def features(self) -> Features | None:
        """Features or None: What of each body faces the other one; None if they meet."""
    @property
    def steps(self) -> Steps | None:
        """Steps or None: Work done; None of solids."""
    def verify(self) -> None:
        """Checks the proof against the bodies alone; between solids they are asked once more for it.

        Raises
        ------
        CertificateError
            What is not proven.
        """

@final
class Depth(_PairAnswer):
    """The shortest translation that parts two convex bodies: ``lower <= true depth <= upper``."""

    __match_args__: Final = ("lower", "upper", "direction")
    @property
    def lower(self) -> float:
        """float: After any shorter translation they overlap; 0 if they are apart, touch, or are flat."""
    @property
    def upper(self) -> float:
        """float: After a translation of this length along ``direction`` they do not; 0 if they are apart."""
    @property
    def direction(self) -> _Floats:
        """ndarray of shape (3,): Unit vector, in the world, along which the moving body leaves."""
    @property
    def translation(self) -> _Floats:
        """ndarray of shape (3,): The translation of the moving body that parts the bodies."""
    @property
    def steps(self) -> Steps:
        """Steps: Work done."""
    def verify(self) -> None:
        """Checks the proof against the bodies alone.

        Raises
        ------
        CertificateError
            What is not proven.
        """

@final
class OverlapDepth(_PairAnswer):
    """How deep two solids overlap, by the measure that they have."""

    __match_args__: Final = ("meets", "least_tolerance")
    @property
    def meets(self) -> bool:
        """bool: Whether they have a point in common, decided exactly."""
    @property
    def least_tolerance(self) -> float | None:
        """float or None: The least tolerance with which they would not overlap: 0 if they do not, None if
        there is none.
        """

@final
class Within(_PairAnswer):
    """Whether two bodies are closer than a length, with a bound of their distance that proves it."""

    __match_args__: Final = ("closer", "lower", "upper")
    @property
    def length(self) -> float:
        """float: The length."""
    @property
    def closer(self) -> bool | None:
        """bool or None: Whether they are; None where the length lies between the bounds of the distance, a few
        roundings apart.
        """
    @property
    def lower(self) -> float | None:
        """float or None: The bodies are not nearer, where that was found out."""
    @property
    def upper(self) -> float | None:
        """float or None: They are not farther, where that was found out."""
    @property
    def points(self) -> tuple[_Floats, _Floats] | None:
        """tuple of (ndarray, ndarray) or None: Points of the moving and of the fixed body, in the world, that
        are ``upper`` apart.
        """
    @property
    def steps(self) -> Steps | None:
        """Steps or None: Work done; None of solids."""
    def verify(self) -> None:
        """Checks the proof against the bodies alone; between solids they are asked once more for it.

        Raises
        ------
        CertificateError
            What is not proven.
        """

@final
class Obstacles:
    """Many placed bodies, of either kind, in a tree of boxes that is kept as they come, move and go.

    Answers are those of asking all obstacles one by one; of several that cannot be told apart, the one
    whose upper bound is least, and of equal ones the one that came first. Bounds hold for all obstacles
    together. A body that is added many times is kept once.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, Obstacles
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> shelf = Obstacles()
    >>> shelf.add_many(cube, [[2 * k, 0, 0] for k in range(1000)])[:3]
    [0, 1, 2]
    >>> nearest = shelf.nearest(cube, [24.25, 0, 4])
    >>> nearest.obstacle, nearest.lower <= 3 <= nearest.upper
    (12, True)
    >>> down = shelf.clearance(cube, [0, 0, -1], [24.25, 0, 4])
    >>> down.outcome, down.obstacle, 3 - 1e-11 < down.distance <= 3
    ('blocked', 12, True)
    >>> shelf.within(cube, 3.2, [24.25, 0, 4])
    NearbyObstacles(closer=[12, 13], undecided=[])
    >>> down.verify()
    >>> shelf.remove(12)
    >>> shelf.clearance(cube, [0, 0, -1], [24.25, 0, 4])
    ObstacleClearance('free', obstacle=None, distance=inf)
    """

    def __new__(cls) -> Obstacles: ...
    def add(self, body: ConvexPolyhedron | Solid, pose: _Pose = None) -> int:
        """Adds a body.

        Parameters
        ----------
        body : ConvexPolyhedron or Solid
        pose : array_like or Pose, optional
            Where it is.

        Returns
        -------
        int
            Its number, which stays valid whatever else comes, moves and goes, and is never used again.
        """
    def add_many(
        self,
        body: ConvexPolyhedron | Solid | Sequence[ConvexPolyhedron | Solid],
        poses: ArrayLike | Sequence[Pose],
    ) -> list[int]:
        """Adds many, in one pass.

        Parameters
        ----------
        body : ConvexPolyhedron, Solid or sequence of them
            One for all poses, or one for each.
        poses : array_like of shape (N, ...), or sequence of Pose

        Returns
        -------
        list of int
        """
    def set_pose(self, obstacle: int, pose: _Pose) -> None:
        """Puts an obstacle elsewhere.

        Raises
        ------
        KeyError
            There is no such one.
        """
    def set_poses(self, obstacles: Sequence[int], poses: ArrayLike | Sequence[Pose]) -> None:
        """Puts many elsewhere, in one pass: all of them, or, with a KeyError, none."""
    def remove(self, obstacle: int) -> None:
        """Takes an obstacle away.

        Raises
        ------
        KeyError
            There is no such one.
        """
    def pose(self, obstacle: int) -> Pose:
        """Where an obstacle is.

        Returns
        -------
        Pose
        """
    def __len__(self) -> int: ...
    def __contains__(self, obstacle: int, /) -> bool: ...
    def nearest(
        self,
        body: ConvexPolyhedron | Solid,
        pose: _Pose = None,
        *,
        ignore: Iterable[int] = (),
    ) -> NearestObstacle | None:
        """Which obstacle is nearest to a body, and how far is it?

        Parameters
        ----------
        body : ConvexPolyhedron or Solid
        pose : array_like or Pose, optional
            Where it is.
        ignore : iterable of int
            Obstacles that are not asked about: the parts of a gripper, say.

        Returns
        -------
        NearestObstacle or None
            None if there are none.

        Raises
        ------
        QueryError
            A convex body whose facets make no surface, where a solid is asked about it.
        """
    def within(
        self,
        body: ConvexPolyhedron | Solid,
        length: float,
        pose: _Pose = None,
        *,
        ignore: Iterable[int] = (),
    ) -> NearbyObstacles:
        """Which obstacles are closer to a body than a length?

        Parameters
        ----------
        body, pose, ignore
            As for :meth:`nearest`.
        length : float
            In world units.

        Returns
        -------
        NearbyObstacles
            Those that are, and those of which rounding cannot tell, each in the order in which they came; it
            unpacks into the two.
        """
    def clearance(
        self,
        body: ConvexPolyhedron | Solid,
        direction: ArrayLike,
        pose: _Pose = None,
        *,
        before: float | None = None,
        keep: float = 0.0,
        ignore: Iterable[int] = (),
    ) -> ObstacleClearance:
        """How far can a body move along a direction, and what stops it?

        Parameters
        ----------
        body, pose, ignore
            As for :meth:`nearest`.
        direction : array_like of shape (3,)
            Of any length; translations count in multiples of it.
        before : float, optional
            What is not met before this translation is of no interest.
        keep : float
            A gap to be kept, a length: how far until an obstacle is as near as that.

        Returns
        -------
        ObstacleClearance
        """
    def nearest_many(
        self,
        body: ConvexPolyhedron | Solid,
        poses: ArrayLike | Sequence[Pose],
        *,
        ignore: Iterable[int] = (),
        threads: int | None = None,
    ) -> dict[str, NDArray[Any]]:
        """:meth:`nearest` of many poses, on some threads.

        Parameters
        ----------
        body, ignore
            As for :meth:`nearest`.
        poses : array_like of shape (N, ...), or sequence of Pose
        threads : int, optional
            By default as many as there are processors. Answers do not depend on it.

        Returns
        -------
        dict of ndarray
            Columns ``obstacle`` (-1 if there are none), ``lower``, ``upper``, ``on_moving`` and ``on_fixed``.
        """
    def clearance_many(
        self,
        body: ConvexPolyhedron | Solid,
        directions: ArrayLike,
        poses: ArrayLike | Sequence[Pose],
        *,
        before: float | None = None,
        keep: float = 0.0,
        ignore: Iterable[int] = (),
        threads: int | None = None,
    ) -> dict[str, NDArray[Any]]:
        """:meth:`clearance` of many poses and directions, on some threads.

        Parameters
        ----------
        body, before, keep, ignore
            As for :meth:`clearance`.
        directions : array_like of shape (N, 3) or (3,)
            One for each pose, or one for all.
        poses, threads
            As for :meth:`nearest_many`.

        Returns
        -------
        dict of ndarray
            Columns ``outcome`` (0 is blocked, 1 free, 2 overlapping), ``obstacle`` (-1 if nothing stops it),
            ``distance`` (NaN where bodies overlap) and ``upper``.
        """

@type_check_only
class _Proven:
    def proof_json(self) -> str: ...
    def save_proof(self, path: str | PathLike[str]) -> None: ...
    def verify(self) -> None: ...

@final
class NearbyObstacles(_Proven):
    """Which of many obstacles are closer than a length. It unpacks into both lists."""

    @property
    def closer(self) -> list[int]:
        """list of int: Those that are at most the length away, in the order in which they came."""
    @property
    def undecided(self) -> list[int]:
        """list of int: Those of which rounding cannot tell."""
    def __len__(self) -> int: ...
    def __getitem__(self, at: int, /) -> list[int]: ...
    def __iter__(self) -> Iterator[list[int]]: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class NearestObstacle(_Proven):
    """The nearest of many obstacles."""

    @property
    def obstacle(self) -> int:
        """int: Which one."""
    @property
    def lower(self) -> float:
        """float: No obstacle is nearer, rounded down."""
    @property
    def upper(self) -> float:
        """float: This one is not farther, rounded up."""
    @property
    def on_moving(self) -> _Floats:
        """ndarray of shape (3,): The point of the moving body that is nearest to it, in the world."""
    @property
    def on_fixed(self) -> _Floats:
        """ndarray of shape (3,): Its point that is nearest to the moving body."""
    @property
    def normal(self) -> _Floats | None:
        """ndarray of shape (3,) or None: Unit vector in the world, from the moving body to it, where they are
        apart.
        """

@final
class ObstacleClearance(_Proven):
    """How far a body can move among obstacles, and what stops it."""

    @property
    def outcome(self) -> Literal["blocked", "free", "overlapping"]:
        """str: ``"blocked"``, ``"free"`` or ``"overlapping"``."""
    @property
    def obstacle(self) -> int | None:
        """int or None: What stops the body, or overlaps it."""
    @property
    def distance(self) -> float | None:
        """float or None: How far the body may safely move past all obstacles, in multiples of the direction; None
        if it overlaps one now.
        """
    @property
    def upper(self) -> float:
        """float: The body is stopped no later, for certain; infinite if nothing stops it, NaN if it overlaps an
        obstacle.
        """
    @property
    def normal(self) -> _Floats | None:
        """ndarray of shape (3,) or None: Unit normal of the contact, from the moving body to what stops it."""

@final
class Cta:
    """The paper's algorithm with its choices, to be given as ``solver``.

    Parameters
    ----------
    start : {"center", "ellipsoids"}
        Where the minimisation starts: at the centre of all sections, or where ellipsoids would meet.
    until : "exit" or float
        Where it ends: where the features that touch are seen to solve the problem, or before, where its bounds
        are as near as this share of the extent of both bodies along the direction.

    Raises
    ------
    QueryError
        A start or an end that is none.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, Cta, cast
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> nearly = Cta(until=0.1)
    >>> nearly
    Cta(start='center', until=0.1)
    >>> cast(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0], solver=nearly).translation
    2.0
    """

    def __new__(
        cls,
        *,
        start: Literal["center", "ellipsoids"] = "center",
        until: Literal["exit"] | float = "exit",
    ) -> Cta: ...
    @property
    def start(self) -> Literal["center", "ellipsoids"]:
        """str: Where the minimisation starts."""
    @property
    def until(self) -> Literal["exit"] | float:
        """str or float: Where it ends."""
    def __eq__(self, other: object, /) -> bool: ...
    def __getnewargs_ex__(self) -> tuple[tuple[()], dict[str, Any]]: ...

@final
class Tracker:
    """Queries that follow each other closely, each starting from the answer of the one before.

    Outcomes and certificates are those of the functions of the same names; poses, directions and
    bodies may jump: a poor beginning costs time, never the answer.

    Parameters
    ----------
    features : bool, optional
        Whether a query starts from the features that touched in the last answer. By default it does, unless its
        solver is "cta", which starts as in the paper, in the region around the last solution, or a region is given.
    region : "automatic", "everywhere" or float, optional
        That region, of "cta": the half-side of a square of section levels as a length, or by what has changed.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, Tracker
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> tracker = Tracker()
    >>> for x in (0.0, 0.1, 0.2):
    ...     contact = tracker.cast(cube, cube, [0, 0, -1], moving_pose=[x, 0.2, 4])
    ...     print(contact.translation, contact.steps.started_from)
    3.0 scratch
    3.0 features
    3.0 features
    """

    def __new__(
        cls,
        *,
        features: bool | None = None,
        region: Literal["automatic", "everywhere"] | float | None = None,
    ) -> Tracker: ...
    def reset(self) -> None:
        """Forgets the last answer: the next query starts from scratch."""
    @property
    def steps(self) -> Steps:
        """Steps: The work of the last query, of all its casts together."""
    def cast(
        self,
        moving: ConvexPolyhedron,
        fixed: ConvexPolyhedron,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        keep: float = 0.0,
        solver: _Solver = "auto",
    ) -> _Outcome:
        """:func:`cast`, starting from the last answer."""
    def contact_range(
        self,
        moving: ConvexPolyhedron,
        fixed: ConvexPolyhedron,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        keep: float = 0.0,
        solver: _Solver = "auto",
    ) -> ContactRange | Separated:
        """:func:`contact_range`, starting from the last answer."""
    def clearance(
        self,
        moving: ConvexPolyhedron,
        fixed: ConvexPolyhedron,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        keep: float = 0.0,
        solver: _Solver = "auto",
    ) -> _Clearance:
        """:func:`clearance`, starting from the last answer."""
    def directional_depth(
        self,
        moving: ConvexPolyhedron,
        fixed: ConvexPolyhedron,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        keep: float = 0.0,
        solver: _Solver = "auto",
    ) -> DirectionalDepth:
        """:func:`directional_depth`, starting from the last answer."""
    def intersects(
        self,
        moving: ConvexPolyhedron,
        fixed: ConvexPolyhedron,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        keep: float = 0.0,
        solver: _Solver = "auto",
    ) -> Intersection:
        """:func:`intersects`, starting from the last answer to the same question."""

def cast(
    moving: ConvexPolyhedron,
    fixed: ConvexPolyhedron,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float = 0.0,
    keep: float = 0.0,
    solver: _Solver = "auto",
) -> _Outcome:
    """At which translation along a direction do two bodies first meet?

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron
        The body that moves, and the one that does not.
    direction : array_like of shape (3,)
        Of the world, of any length; translations count in multiples of it.
    moving_pose, fixed_pose : array_like or Pose, optional
        Where the bodies are; see :class:`Pose`.
    graze_tolerance : float
        Sideways overlaps up to this length count as grazing. 0 stands for rounding error.
    keep : float
        A gap to be kept, a length: asked is where the bodies are first as near as that, not where they
        touch.
    solver : {"auto", "cta", "portal"} or Cta
        How the search is narrowed. Answers and certificates are the same.

    Returns
    -------
    Contact or Grazing or Separated
        A negative translation is a contact behind, or an overlap now.

    Raises
    ------
    QueryError, PoseError, InputError
        An argument that is refused, with its name or its value.

    Examples
    --------
    >>> from colltrans import Contact, ConvexPolyhedron, Separated, cast
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> match cast(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0]):
    ...     case Contact(translation=t, normal=n):
    ...         print(t, n)
    ...     case Separated(margin=margin):
    ...         print("misses by", margin)
    2.0 [1. 0. 0.]
    """

def contact_range(
    moving: ConvexPolyhedron,
    fixed: ConvexPolyhedron,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float = 0.0,
    keep: float = 0.0,
    solver: _Solver = "auto",
) -> ContactRange | Separated:
    """At which translations along a direction do two bodies first and last meet?

    Parameters
    ----------
    moving, fixed, direction, moving_pose, fixed_pose, graze_tolerance, keep, solver
        As for :func:`cast`.

    Returns
    -------
    ContactRange or Separated

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, contact_range
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> contact_range(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0]).interval
    (2.0, 4.0)
    """

@overload
def clearance(
    moving: ConvexPolyhedron,
    fixed: ConvexPolyhedron,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float | None = None,
    keep: float = 0.0,
    solver: _Solver = "auto",
    tolerance: None = None,
    ignore_start_overlaps: Literal[False] = False,
) -> _Clearance:
    """How far can the moving body move from where it is, and what stops it?

    Contacts behind and grazing slides do not block. Bodies that touch block each other if the
    motion would make them overlap.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron or Solid
        The body that moves, and the one that does not.
    direction, moving_pose, fixed_pose
        As for :func:`cast`.
    keep : float
        A gap to be kept, a length: how far until the bodies are as near as that. Bodies that are nearer at
        the start overlap.
    graze_tolerance, solver
        As for :func:`cast`; between convex bodies.
    tolerance, ignore_start_overlaps
        As for :class:`SolidCast`; if one of the bodies is a solid.

    Returns
    -------
    Blocked or Slides or Behind or Separated or Overlapping
        All have a ``distance``: infinite where nothing blocks, None where the bodies overlap.
    SolidBlocked or SolidFree or SolidOverlapping
        The same, if one of the bodies is a solid.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, clearance
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> for direction in ([0, 0, -1], [1, 0, 0], [0, 0, 1]):
    ...     answer = clearance(cube, cube, direction, moving_pose=[0, 0, 1])
    ...     print(type(answer).__name__, answer.distance)
    Blocked 0.0
    Slides inf
    Behind inf
    >>> round(clearance(cube, cube, [0, 0, -1], moving_pose=[0, 0, 4], keep=0.25).distance, 9)
    2.75
    """

@overload
def clearance(
    moving: Solid,
    fixed: Solid | ConvexPolyhedron,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: None = None,
    keep: float = 0.0,
    solver: _Solver = "auto",
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> _SolidClearance: ...
@overload
def clearance(
    moving: ConvexPolyhedron,
    fixed: Solid,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: None = None,
    keep: float = 0.0,
    solver: _Solver = "auto",
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> _SolidClearance: ...
def directional_depth(
    moving: ConvexPolyhedron,
    fixed: ConvexPolyhedron,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float = 0.0,
    keep: float = 0.0,
    solver: _Solver = "auto",
) -> DirectionalDepth:
    """How far must the moving body go back, against the direction, until the overlap ends?

    Parameters
    ----------
    moving, fixed, direction, moving_pose, fixed_pose, graze_tolerance, keep, solver
        As for :func:`cast`.

    Returns
    -------
    DirectionalDepth

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, directional_depth
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> round(directional_depth(cube, cube, [1, 0, 0], moving_pose=[-0.75, 0, 0]).depth, 12)
    0.25
    """

@overload
def intersects(
    moving: ConvexPolyhedron,
    fixed: ConvexPolyhedron,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float | None = None,
    keep: float = 0.0,
    solver: _Solver = "auto",
    tolerance: None = None,
    ignore_start_overlaps: Literal[False] = False,
) -> Intersection:
    """Do the bodies, as closed sets and to within rounding error, meet where they are?

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron or Solid
    direction, moving_pose, fixed_pose, graze_tolerance, solver, tolerance, ignore_start_overlaps
        As for :func:`clearance`. The direction and the tolerances play no part.
    keep : float
        Of convex bodies, a gap, a length: are they as near as that? For solids ask :func:`within`.

    Returns
    -------
    Intersection
        True or false in a condition, with the proof.
    bool
        If one of the bodies is a solid.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, intersects
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> bool(intersects(cube, cube, [1, 0, 0], moving_pose=[0.5, 0, 0]))
    True
    """

@overload
def intersects(
    moving: Solid,
    fixed: Solid | ConvexPolyhedron,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: None = None,
    keep: float = 0.0,
    solver: _Solver = "auto",
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> bool: ...
@overload
def intersects(
    moving: ConvexPolyhedron,
    fixed: Solid,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: None = None,
    keep: float = 0.0,
    solver: _Solver = "auto",
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> bool: ...
def distance(
    moving: ConvexPolyhedron | Solid,
    fixed: ConvexPolyhedron | Solid,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> Distance:
    """How far apart are two bodies where they are, and where are they nearest?

    The bounds hold exactly, however near the bodies are: ``lower <= true distance <= upper``, a few
    roundings apart.

    Parameters
    ----------
    moving, fixed : ConvexPolyhedron or Solid
        Nothing moves; the names tell them apart. If one of them is a solid, both are asked as solids.
    moving_pose, fixed_pose : array_like or Pose, optional
        Where the bodies are; see :class:`Pose`.

    Returns
    -------
    Distance

    Raises
    ------
    PoseError, InputError, BuildError
        An argument that is refused.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, distance
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> found = distance(cube, cube, fixed_pose=[4, 5, 0.25])
    >>> found.lower <= 5 <= found.upper and found.upper - found.lower < 1e-13
    True
    >>> found.features.moving.kind, found.normal.round(9)
    ('edge', array([0.6, 0.8, 0. ]))
    >>> found.verify()
    """

@overload
def depth(
    moving: ConvexPolyhedron,
    fixed: ConvexPolyhedron,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> Depth:
    """How deep do two bodies overlap: which shortest translation, over all directions, parts them?

    Parameters
    ----------
    moving, fixed, moving_pose, fixed_pose
        As for :func:`distance`.

    Returns
    -------
    Depth or OverlapDepth
        Of solids the second: the least tolerance with which they would not overlap.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, depth
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> found = depth(cube, cube, fixed_pose=[0.75, 0.5, 0.5])
    >>> found.lower <= 0.25 <= found.upper
    True
    >>> found.direction
    array([-1.,  0.,  0.])
    """

@overload
def depth(
    moving: Solid,
    fixed: ConvexPolyhedron | Solid,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> OverlapDepth: ...
@overload
def depth(
    moving: ConvexPolyhedron,
    fixed: Solid,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> OverlapDepth: ...
def within(
    moving: ConvexPolyhedron | Solid,
    fixed: ConvexPolyhedron | Solid,
    length: float,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> Within:
    """Are two bodies closer than a length where they are? Ended as soon as that is known.

    Parameters
    ----------
    moving, fixed, moving_pose, fixed_pose
        As for :func:`distance`.
    length : float
        Not negative, in the unit of the bodies.

    Returns
    -------
    Within

    Raises
    ------
    QueryError
        A length that is negative or not a number.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, within
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> within(cube, cube, 4.9, fixed_pose=[4, 5, 0.25]).closer
    False
    >>> within(cube, cube, 5.1, fixed_pose=[4, 5, 0.25])
    Within(closer=True, length=5.1)
    """

@final
class FreeDirections:
    """All directions along which a body can leave another one, proven: see :func:`free_directions`."""

    @property
    def moving(self) -> ConvexPolyhedron | Solid:
        """ConvexPolyhedron or Solid: The moving body."""
    @property
    def fixed(self) -> ConvexPolyhedron | Solid:
        """ConvexPolyhedron or Solid: The fixed body."""
    @property
    def moving_pose(self) -> Pose:
        """Pose: Where the moving body is."""
    @property
    def fixed_pose(self) -> Pose:
        """Pose: Where the fixed body is."""
    @property
    def outcome(self) -> Literal["free", "blocked", "undecided"]:
        """str: ``"free"`` if some directions are, ``"blocked"`` if none is, which is proven, ``"undecided"`` if
        none is known to be and not all are known.
        """
    @property
    def free_share(self) -> tuple[float, float]:
        """tuple of (float, float): The share of all directions that is free, at least and at most, without
        what is undecided.
        """
    @property
    def undecided_share(self) -> float:
        """float: At most this share of all directions is not known."""
    @property
    def tolerance(self) -> float:
        """float: The tolerance that was used, a length: both bodies are shrunk by half of it."""
    @property
    def regions(self) -> list[dict[str, Any]]:
        """list of dict: Connected regions, the largest first: ``share``, ``center``, ``corners`` and the convex
        ``pieces`` that together are it.
        """
    @property
    def arcs(self) -> list[dict[str, Any]]:
        """list of dict: Arcs of free directions beside which there is no region, exactly: each goes
        counterclockwise around the ``normal`` of its ``plane``, from the first of its ``ends`` (points; none
        of a whole circle) to the second, through the directions ``along``.
        """
    @property
    def points(self) -> list[dict[str, Any]]:
        """list of dict: Free directions with no other beside them: the ``direction``, rounded, and two
        ``planes``, each with its ``normal`` and what it is ``of``: two ``triangles``, and three ``vertices``
        that span it. The direction is exactly along the vector product of the normals.
        """
    def says(self, directions: ArrayLike) -> list[Literal["free", "blocked", "undecided"]]:
        """What is said of directions.

        Parameters
        ----------
        directions : array_like of shape (N, 3)
            Of any length.

        Returns
        -------
        list of str
            ``"free"``, ``"blocked"`` or ``"undecided"`` of each.
        """
    def is_at(self, number: int, directions: ArrayLike) -> list[bool]:
        """Whether directions are that of a point, exactly.

        Parameters
        ----------
        number : int
            Which of :attr:`points`.
        directions : array_like of shape (N, 3)
            Of any length.

        Returns
        -------
        list of bool
        """
    def is_on(self, number: int, directions: ArrayLike) -> list[bool]:
        """Whether directions are on an arc or at one of its ends, exactly.

        Parameters
        ----------
        number : int
            Which of :attr:`arcs`.
        directions : array_like of shape (N, 3)
            Of any length.

        Returns
        -------
        list of bool
        """
    def verify(self) -> None:
        """Checks what is said of every cell of the sphere, without a search.

        Raises
        ------
        CertificateError
            What is not proven.
        """
    def to_dict(self) -> dict[str, Any]:
        """What it says, as plain Python: the fields of ``colltrans directions --json``, with the same bits.

        Returns
        -------
        dict
        """
    def proof_json(self) -> str:
        """The proof, with all that it is about, as text: the file of ``--save-proof``, which ``colltrans
        verify`` and ``python -m colltrans.check`` check. The question is asked once more for it.

        Returns
        -------
        str
        """
    def save_proof(self, path: str | PathLike[str]) -> None:
        """Writes :meth:`proof_json` as a file.

        Parameters
        ----------
        path : str or os.PathLike
        """

def free_directions(
    moving: ConvexPolyhedron | Solid,
    fixed: ConvexPolyhedron | Solid,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
    depth: int = 26,
    looks: int = 20_000_000,
) -> FreeDirections:
    """Along which directions can a body leave another one? All of them, proven.

    Parameters
    ----------
    moving, fixed : Solid or ConvexPolyhedron
        The body that moves, and the one that does not; closed.
    moving_pose, fixed_pose : array_like or Pose, optional
        Where the bodies are; see :class:`Pose`.
    tolerance, ignore_start_overlaps
        As of :class:`SolidCast`: a direction is free exactly where its clearance says so.
    depth : int
        How often the sides of a cube of directions are halved, at most; no more than 50.
    looks : int
        How many pairs of boxes are looked at, at most; what is not decided by then stays undecided.

    Returns
    -------
    FreeDirections

    Raises
    ------
    QueryError
        Bodies that are open, or overlap where they are.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, free_directions
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> lid = free_directions(cube, cube, moving_pose=[0, 0, 1])
    >>> low, high = lid.free_share
    >>> low <= 0.5 <= high
    True
    >>> " ".join(lid.says([[1, 2, 0], [1, 2, -1e-50]]))
    'free blocked'
    >>> lid.verify()
    """

@final
class WaysOut:
    """How a body can leave another one in several moves: see :func:`ways_out`."""

    @property
    def moving(self) -> ConvexPolyhedron | Solid:
        """ConvexPolyhedron or Solid: The moving body."""
    @property
    def fixed(self) -> ConvexPolyhedron | Solid:
        """ConvexPolyhedron or Solid: The fixed body."""
    @property
    def moving_pose(self) -> Pose:
        """Pose: Where the moving body is."""
    @property
    def fixed_pose(self) -> Pose:
        """Pose: Where the fixed body is."""
    @property
    def outcome(self) -> Literal["found", "none", "not_found"]:
        """str: ``"found"``; ``"none"`` if there is none by translations, which is proven; ``"not_found"``,
        which proves nothing.
        """
    @property
    def legs(self) -> list[tuple[list[float], float]]:
        """list of tuple of (tuple of float, float): What to do, in order: a direction of length 1 and how far
        to go; infinitely with the last one. Empty if no way was found.
        """
    @property
    def tolerance(self) -> float | None:
        """float or None: The tolerance, a length: both bodies are shrunk by half of it. None if nothing is
        proven.
        """
    @property
    def cells(self) -> int | None:
        """int or None: How many cells of displacements prove that there is no way."""
    def verify(self) -> None:
        """Checks the proof of every move, or that there is none, without a search. If nothing was found there
        is nothing to check.

        Raises
        ------
        CertificateError
            What is not proven.
        """
    def to_dict(self) -> dict[str, Any]:
        """What it says, as plain Python: ``outcome``, ``legs``, ``tolerance``, ``cells``, and what was
        ``searched``; what does not apply is left out.

        Returns
        -------
        dict
        """

def ways_out(
    moving: ConvexPolyhedron | Solid,
    fixed: ConvexPolyhedron | Solid,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    tolerance: float | None = None,
    legs: int = 12,
    directions: ArrayLike | None = None,
    looks: int = 50_000_000,
    cells: int = 20_000,
) -> WaysOut:
    """How can a body leave another one by straight moves, one after another?

    The body keeps how it is turned. Each move has its proof, and so has the answer that there is no way;
    that none was found is no proof.

    Parameters
    ----------
    moving, fixed : Solid or ConvexPolyhedron
        The body that moves, and the one that does not; closed, and apart where they are.
    moving_pose, fixed_pose : array_like or Pose, optional
        Where the bodies are; see :class:`Pose`.
    tolerance : float, optional
        As of :class:`SolidCast`: both bodies are shrunk by half of it.
    legs : int
        At most so many moves.
    directions : array_like of shape (D, 3)
        Those to try, with their opposites; without any those of large faces, and across two of these.
    looks : int
        How many pairs of boxes are looked at, at most.
    cells : int
        At most so many cells for a proof that there is no way; 0 for no such proof.

    Returns
    -------
    WaysOut

    Raises
    ------
    QueryError
        Bodies that are open, or overlap where they are.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, ways_out
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> way = ways_out(cube, cube, moving_pose=[0, 0, 2])
    >>> way.outcome, len(way.legs)
    ('found', 1)
    >>> way.verify()
    """

def read(
    path: str | PathLike[str],
    *,
    hull: bool = False,
    scale: float = 1.0,
    convex_tolerance: float | None = None,
    merge_tolerance: float | None = None,
) -> ConvexPolyhedron:
    """Reads a convex body from a mesh file: STL, OBJ, PLY, OFF or COLLADA.

    Parameters
    ----------
    path : str or os.PathLike
    hull : bool
        Take the convex hull of the vertices that faces use, of all if there are no faces.
    scale : float
        Lengths are multiplied by this, after the tolerances, which are in the file's unit.
    convex_tolerance : float, optional
        How far below its convex hull the surface may lie. By default 1e-5 of its extent.
    merge_tolerance : float, optional
        Up to which distance vertices on open edges are merged. By default a few units in the last
        place of the largest coordinate.

    Returns
    -------
    ConvexPolyhedron
        The same as the command line makes of the file.

    Raises
    ------
    MeshError
        A file that cannot be read, with the place.
    BuildError
        A mesh that is not convex or not closed; ``hull=True`` takes its hull.
    """

def ask_many(
    n: int,
    question: Literal["contact", "range", "clearance"],
    moving: tuple[list[Any], NDArray[np.int64] | None],
    fixed: tuple[list[Any], NDArray[np.int64] | None],
    direction: _Floats,
    moving_pose: _Floats,
    fixed_pose: _Floats,
    graze_tolerance: _Floats,
    keep: _Floats,
    solver: _Solver,
    featured: bool,
    threads: int | None,
) -> tuple[dict[str, NDArray[Any]], list[str], dict[int, str]]:
    """Answers `n` queries: what `colltrans.many` calls when it has made all arguments what they have to
    be, tables with one row or `n`.
    """

def ask_motions(
    n: int,
    question: Literal["motion", "motion_clearance"],
    moving: tuple[list[Any], NDArray[np.int64] | None],
    fixed: tuple[list[Any], NDArray[np.int64] | None],
    moving_motion: list[Motion] | _Floats,
    fixed_motion: list[Motion] | _Floats,
    moving_pose: _Floats,
    fixed_pose: _Floats,
    keep: _Floats,
    tolerance: _Floats,
    featured: bool,
    threads: int | None,
) -> tuple[dict[str, NDArray[Any]], list[str], dict[int, str]]:
    """The same of bodies that move: what `colltrans.motions` calls."""

def ask_paths(
    robot: Robot,
    paths: list[Any],
    scene: Mapping[str, ConvexPolyhedron | Solid] | None,
    ignore: Sequence[tuple[str, str]],
    keep: float,
    joints: dict[str, float],
    columns: Sequence[str] | None,
    times: list[Any] | None,
    threads: int | None,
) -> tuple[dict[str, NDArray[Any]], list[str], list[str], dict[int, str]]:
    """The extension's half of ``colltrans.path_many``."""

def ask_pairs(
    n: int,
    question: Literal["distance", "depth", "within"],
    moving: tuple[list[Any], NDArray[np.int64] | None],
    fixed: tuple[list[Any], NDArray[np.int64] | None],
    moving_pose: _Floats,
    fixed_pose: _Floats,
    length: _Floats,
    featured: bool,
    threads: int | None,
) -> tuple[dict[str, NDArray[Any]], list[str], dict[int, str]]:
    """The same of bodies where they are: what `colltrans.pairs` calls."""
