"""The types of the extension, whose docstrings `tools/docstrings.py` adds when a wheel is built."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from os import PathLike
from typing import (
    Any,
    Final,
    Literal,
    Never,
    Protocol,
    SupportsFloat,
    TypeAlias,
    final,
    overload,
    type_check_only,
)

import numpy as np
from numpy.typing import ArrayLike, NDArray

from colltrans.scenes import NearestColumns, ObstacleClearanceColumns

_Floats: TypeAlias = NDArray[np.float64]
_Indices: TypeAlias = NDArray[np.uint32]
_Solver: TypeAlias = Literal["auto", "cta", "portal"] | Cta
_Pose: TypeAlias = ArrayLike | Pose | HasMatrix | tuple[ArrayLike, ArrayLike] | None
_Poses: TypeAlias = _Pose | Sequence[Any]
_Body: TypeAlias = ConvexPolyhedron | Solid | Placed
_Faces: TypeAlias = NDArray[np.integer[Any]] | Sequence[Sequence[int] | NDArray[np.integer[Any]]]
_Outcome: TypeAlias = Contact | Grazing | Separated
_Clearance: TypeAlias = Blocked | Slides | Behind | Separated | Overlapping

__all__ = [
    "Assembly",
    "Behind",
    "Blocked",
    "Cast",
    "Certificate",
    "CommonPart",
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
    "Placed",
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
    "ask_paths",
    "cast",
    "clearance",
    "contact_range",
    "depth",
    "directional_depth",
    "distance",
    "free_directions",
    "intersects",
    "motion",
    "motion_clearance",
    "read",
    "ways_out",
    "within",
]
_Answered: TypeAlias = tuple[dict[str, NDArray[Any]], list[str], dict[int, str]]
_SolidOutcome: TypeAlias = SolidContact | SolidFree
_SolidClearance: TypeAlias = SolidBlocked | SolidFree | SolidOverlapping

@type_check_only
class HasMatrix(Protocol):
    """A rotation or a placement of another package, scipy's for one."""

    def as_matrix(self) -> Any: ...

@final
class Pose:
    def __new__(cls, source: _Pose = None) -> Pose: ...
    @property
    def translation(self) -> _Floats: ...
    @property
    def rotation(self) -> _Floats: ...
    @property
    def quaternion(self) -> _Floats: ...
    def as_matrix(self) -> _Floats: ...
    def inverse(self) -> Pose: ...
    def __matmul__(self, first: Pose, /) -> Pose: ...
    def __rmatmul__(self, value: Pose, /) -> Pose: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@type_check_only
class HasFaces(Protocol):
    """A mesh of another package, trimesh's for one."""

    @property
    def vertices(self) -> Any: ...
    @property
    def faces(self) -> Any: ...

@type_check_only
class HasTriangles(Protocol):
    """A mesh of another package, open3d's for one."""

    @property
    def vertices(self) -> Any: ...
    @property
    def triangles(self) -> Any: ...

_Mesh: TypeAlias = HasFaces | HasTriangles

@final
class Placed:
    def __new__(cls, body: _Body, pose: _Pose = None) -> Placed: ...
    @property
    def body(self) -> ConvexPolyhedron | Solid: ...
    @property
    def pose(self) -> Pose: ...
    def __getnewargs__(self) -> tuple[Any, Pose]: ...

@final
class ConvexPolyhedron:
    def __new__(cls, points: ArrayLike | _Mesh) -> ConvexPolyhedron: ...
    @staticmethod
    def from_mesh(
        vertices: ArrayLike | _Mesh, faces: _Faces | None = None, convex_tolerance: float = 0.0
    ) -> ConvexPolyhedron: ...
    @staticmethod
    def read(
        path: str | PathLike[str],
        *,
        hull: bool = False,
        scale: float = 1.0,
        convex_tolerance: float | None = None,
        merge_tolerance: float | None = None,
    ) -> ConvexPolyhedron: ...
    def at(self, pose: _Pose = None) -> Placed: ...
    @staticmethod
    def cuboid(low: ArrayLike, high: ArrayLike) -> ConvexPolyhedron: ...
    @staticmethod
    def sphere(radius: float, center: ArrayLike | None = None) -> ConvexPolyhedron: ...
    @staticmethod
    def capsule(start: ArrayLike, end: ArrayLike, radius: float) -> ConvexPolyhedron: ...
    def rounded(self, radius: float) -> ConvexPolyhedron: ...
    def _drawn(self) -> ConvexPolyhedron: ...
    @property
    def radius(self) -> float: ...
    @staticmethod
    def from_json(text: str) -> ConvexPolyhedron: ...
    def to_json(self) -> str: ...
    @property
    def vertices(self) -> _Floats: ...
    @property
    def input_indices(self) -> _Indices: ...
    @property
    def faces(self) -> list[_Indices]: ...
    @property
    def triangles(self) -> _Indices: ...
    @property
    def bounds(self) -> _Floats: ...
    def face_normal(self, face: int) -> _Floats: ...
    @property
    def dimension(self) -> int: ...
    @property
    def hull_error(self) -> float: ...
    @property
    def dent(self) -> float: ...
    @property
    def volume(self) -> float: ...
    def support(self, direction: ArrayLike) -> int: ...
    def shrunk(self, amount: float) -> tuple[ConvexPolyhedron, OffsetReport]: ...
    def grown(self, amount: float) -> tuple[ConvexPolyhedron, OffsetReport]: ...
    def show(self, **options: Any) -> Any: ...
    def prepare(self) -> None: ...
    @property
    def nbytes(self) -> int: ...
    @property
    def notes(self) -> list[str]: ...
    @staticmethod
    def _read(text: str, notes: list[str], dent: float | None) -> ConvexPolyhedron: ...
    def __reduce__(self) -> tuple[Any, Any]: ...
    def __copy__(self) -> ConvexPolyhedron: ...
    def __deepcopy__(self, _memo: Any) -> ConvexPolyhedron: ...

@final
class OffsetReport:
    __match_args__: Final = ("farthest", "vanished")
    @property
    def farthest(self) -> float: ...
    @property
    def vanished(self) -> _Indices: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class ShrinkReport:
    __match_args__: Final = ("farthest", "stuck", "inverted")
    @property
    def farthest(self) -> float: ...
    @property
    def stuck(self) -> _Indices: ...
    @property
    def inverted(self) -> _Indices: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Assembly:
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
    def fasteners(
        self,
    ) -> list[tuple[str, str, str, list[float], list[list[float]], bool] | None]: ...
    def group(self, names: list[str]) -> list[int]: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def unit(self) -> str | None: ...
    @property
    def notes(self) -> list[str]: ...
    def meshes(self) -> list[tuple[_Floats, _Indices]]: ...
    def index(self, name: str) -> int: ...
    def rooms(
        self, directions: ArrayLike, tolerance: float | None, ignore_overlaps: bool
    ) -> list[tuple[list[float], list[int]]]: ...
    def audit(
        self,
        within: float,
        levels: list[tuple[list[str], list[str], float]],
        tolerance: float | None,
        allow_contact: bool,
        proofs: str | PathLike[str] | None,
    ) -> tuple[
        list[list[int]],
        list[list[str]],
        list[bool],
        list[list[bool]],
        dict[str, _Floats],
        list[int],
        list[list[dict[str, str]]],
    ]: ...
    def blocking(
        self, direction: ArrayLike, tolerance: float | None, ignore_overlaps: bool
    ) -> list[list[list[int]]]: ...
    def plan(
        self,
        directions: ArrayLike,
        samples: int,
        effort: int,
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
                tuple[float, float, float, str] | None,
                tuple[str, list[int], str] | None,
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
    def report(self, title: str) -> str: ...

@final
class Cast:
    def __new__(
        cls,
        moving: ConvexPolyhedron | Placed,
        fixed: ConvexPolyhedron | Placed,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        min_gap: float = 0.0,
        solver: _Solver = "auto",
    ) -> Cast: ...
    def cast(self) -> _Outcome: ...
    def contact_range(self) -> ContactRange | Separated: ...
    def clearance(self) -> _Clearance: ...
    def directional_depth(self) -> DirectionalDepth: ...
    def intersects(self) -> Intersection: ...
    def reversed(self) -> Cast: ...
    def verify(self, proof: Certificate | Separation) -> float: ...
    def to_json(self) -> str: ...
    @staticmethod
    def from_json(text: str) -> Cast: ...
    @property
    def moving(self) -> ConvexPolyhedron: ...
    @property
    def fixed(self) -> ConvexPolyhedron: ...
    @property
    def moving_pose(self) -> Pose: ...
    @property
    def fixed_pose(self) -> Pose: ...
    @property
    def direction(self) -> _Floats: ...
    @property
    def graze_tolerance(self) -> float: ...
    @property
    def min_gap(self) -> float: ...
    @property
    def solver(self) -> _Solver: ...
    def __reduce__(self) -> tuple[Any, Any]: ...
    def show(self, **options: Any) -> Any: ...

@final
class Certificate:
    __match_args__: Final = ("lower", "upper")
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    @property
    def gap(self) -> float: ...
    @property
    def rounding(self) -> float: ...
    @property
    def normal(self) -> _Floats: ...
    @property
    def pairs(self) -> _Indices: ...
    @property
    def weights(self) -> _Floats: ...
    def verify(self, query: Cast | None = None) -> float: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Separation:
    __match_args__: Final = ("normal", "margin")
    @property
    def normal(self) -> _Floats: ...
    @property
    def margin(self) -> float: ...
    def verify(self, query: Cast | None = None) -> float: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Steps:
    @property
    def planar_problems(self) -> int: ...
    @property
    def supports(self) -> int: ...
    @property
    def pivots(self) -> int: ...
    @property
    def iterations(self) -> int: ...
    @property
    def region_sides(self) -> int: ...
    @property
    def started_from(self) -> Literal["scratch", "region", "features"]: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Feature:
    __match_args__: Final = ("kind", "vertices")
    @property
    def kind(self) -> Literal["vertex", "edge", "face"]: ...
    @property
    def vertices(self) -> _Indices: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Features:
    __match_args__: Final = ("moving", "fixed")
    @property
    def moving(self) -> Feature: ...
    @property
    def fixed(self) -> Feature: ...
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
class _Comparable:
    def __float__(self) -> float: ...
    def __lt__(self, other: SupportsFloat, /) -> bool: ...
    def __le__(self, other: SupportsFloat, /) -> bool: ...
    def __gt__(self, other: SupportsFloat, /) -> bool: ...
    def __ge__(self, other: SupportsFloat, /) -> bool: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@type_check_only
class _Number(_Comparable):
    @property
    def value(self) -> float: ...
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...

@type_check_only
class _NoNumber(_Comparable):
    @property
    def value(self) -> None: ...
    @property
    def lower(self) -> None: ...
    @property
    def upper(self) -> None: ...

@type_check_only
class _Time(_Comparable):
    @property
    def value(self) -> float | None: ...
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...

@type_check_only
class _Travel(_Comparable):
    @property
    def value(self) -> float | None: ...
    @property
    def lower(self) -> float | None: ...

@type_check_only
class _ConvexAnswer(_Answer):
    @property
    def query(self) -> Cast: ...

@type_check_only
class _SolidAnswer(_Answer):
    @property
    def query(self) -> SolidCast: ...

@final
class Contact(_ConvexAnswer, _Number):
    __match_args__: Final = ("translation", "normal", "point")
    @property
    def translation(self) -> float: ...
    @property
    def normal(self) -> _Floats: ...
    @property
    def point(self) -> _Floats: ...
    @property
    def point_at_start(self) -> _Floats: ...
    @property
    def features(self) -> Features: ...
    @property
    def certificate(self) -> Certificate: ...
    @property
    def pose_before(self) -> Pose: ...
    @property
    def solver(self) -> _Solver: ...
    @property
    def steps(self) -> Steps: ...

@final
class Grazing(_ConvexAnswer, _Number):
    __match_args__: Final = ("overlap", "contact")
    @property
    def overlap(self) -> float: ...
    @property
    def separating_direction(self) -> _Floats: ...
    @property
    def contact(self) -> Contact: ...

@final
class Separated(_ConvexAnswer, _Number):
    __match_args__: Final = ("margin", "normal")
    @property
    def margin(self) -> float: ...
    @property
    def normal(self) -> _Floats: ...
    @property
    def certificate(self) -> Separation: ...
    @property
    def distance(self) -> float: ...
    @property
    def solver(self) -> _Solver: ...
    @property
    def steps(self) -> Steps: ...

@final
class ContactRange(_ConvexAnswer, _Number):
    __match_args__: Final = ("interval",)
    @property
    def interval(self) -> tuple[float, float]: ...
    @property
    def first(self) -> Contact | Grazing: ...
    @property
    def last(self) -> LastContact: ...

@final
class LastContact(_Number):
    __match_args__: Final = ("translation", "normal", "point")
    @property
    def translation(self) -> float: ...
    @property
    def normal(self) -> _Floats: ...
    @property
    def point(self) -> _Floats: ...
    @property
    def features(self) -> Features: ...
    @property
    def query(self) -> Cast: ...
    @property
    def turned(self) -> Contact | Grazing: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Blocked(_ConvexAnswer, _Number):
    __match_args__: Final = ("distance", "contact")
    @property
    def distance(self) -> float: ...
    @property
    def contact(self) -> Contact: ...

@final
class Slides(_ConvexAnswer, _Number):
    __match_args__: Final = ("grazing",)
    @property
    def distance(self) -> float: ...
    @property
    def grazing(self) -> Grazing: ...

@final
class Behind(_ConvexAnswer, _Number):
    __match_args__: Final = ("contact",)
    @property
    def distance(self) -> float: ...
    @property
    def contact(self) -> Contact: ...

@final
class Overlapping(_ConvexAnswer, _NoNumber):
    __match_args__: Final = ("first", "last")
    @property
    def distance(self) -> None: ...
    @property
    def first(self) -> Contact: ...
    @property
    def last(self) -> LastContact: ...

@final
class DirectionalDepth(_ConvexAnswer, _Number):
    __match_args__: Final = ("depth",)
    @property
    def depth(self) -> float: ...
    @property
    def clearance(self) -> _Clearance: ...

@final
class Intersection(_ConvexAnswer):
    __match_args__: Final = ("meets",)
    @property
    def meets(self) -> bool: ...
    @property
    def direction(self) -> _Floats: ...
    @property
    def outcome(self) -> _Outcome: ...
    def __bool__(self) -> bool: ...

@final
class Solid:
    def __new__(
        cls, vertices: ArrayLike | _Mesh, faces: _Faces | None = None, *, open: bool = False
    ) -> Solid: ...
    def at(self, pose: _Pose = None) -> Placed: ...
    @staticmethod
    def from_pieces(pieces: Sequence[Solid | ConvexPolyhedron]) -> Solid: ...
    @staticmethod
    def read(
        path: str | PathLike[str],
        *,
        open: bool = False,
        scale: float = 1.0,
        merge_tolerance: float | None = None,
    ) -> Solid: ...
    def shrunk(self, amount: float) -> tuple[Solid, ShrinkReport]: ...
    def grown(self, amount: float) -> tuple[Solid, ShrinkReport]: ...
    def rounded(self, radius: float) -> Solid: ...
    def signed_distances(self, points: ArrayLike, pose: _Pose = None) -> _Floats: ...
    @property
    def radius(self) -> float: ...
    @property
    def vertices(self) -> _Floats: ...
    @property
    def triangles(self) -> _Indices: ...
    @property
    def input_indices(self) -> _Indices: ...
    @property
    def face_indices(self) -> _Indices: ...
    @property
    def is_closed(self) -> bool: ...
    @property
    def shells(self) -> dict[str, int]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def precision(self) -> float: ...
    @property
    def volume(self) -> float: ...
    @property
    def bounds(self) -> _Floats: ...
    def show(self, **options: Any) -> Any: ...
    @property
    def nbytes(self) -> int: ...
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
    def __new__(
        cls,
        moving: _Body,
        fixed: _Body,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        tolerance: float | None = None,
        min_gap: float = 0.0,
        ignore_start_overlaps: bool = False,
    ) -> SolidCast: ...
    def cast(self) -> _SolidOutcome: ...
    def clearance(self) -> _SolidClearance: ...
    def certified_clearance(self) -> tuple[_SolidClearance, SolidCertificate]: ...
    def verify(self, proof: SolidCertificate) -> float: ...
    def intersects(self) -> bool: ...
    def least_tolerance(self) -> float | None: ...
    def start_overlap(self) -> SolidOverlapping | None: ...
    def exit(self) -> float | None: ...
    def exit_bounds(self) -> tuple[float, float] | None: ...
    def reversed(self) -> SolidCast: ...
    @property
    def tolerance(self) -> float: ...
    @property
    def min_gap(self) -> float: ...
    @property
    def moving(self) -> Solid | ConvexPolyhedron: ...
    @property
    def fixed(self) -> Solid | ConvexPolyhedron: ...
    @property
    def moving_pose(self) -> Pose: ...
    @property
    def fixed_pose(self) -> Pose: ...
    @property
    def direction(self) -> _Floats: ...
    def show(self, **options: Any) -> Any: ...
    def __getnewargs_ex__(self) -> tuple[tuple[Any, ...], dict[str, Any]]: ...

@final
class SolidContact(_SolidAnswer, _Number):
    __match_args__: Final = ("translation", "normal", "point")
    @property
    def translation(self) -> float: ...
    @property
    def translation_bounds(self) -> tuple[float, float]: ...
    @property
    def offset_distance(self) -> float: ...
    @property
    def offset_distance_bounds(self) -> tuple[float, float]: ...
    @property
    def normal(self) -> _Floats: ...
    @property
    def point(self) -> _Floats: ...
    @property
    def point_at_start(self) -> _Floats: ...
    @property
    def moving_feature(self) -> Feature: ...
    @property
    def fixed_feature(self) -> Feature: ...

@final
class SolidBlocked(_SolidAnswer, _Number):
    __match_args__: Final = ("distance", "contact")
    @property
    def distance(self) -> float: ...
    @property
    def contact(self) -> SolidContact: ...
    @property
    def surfaces(self) -> list[str]: ...

@final
class SolidFree(_SolidAnswer, _Number):
    __match_args__: Final = ()
    @property
    def distance(self) -> float: ...
    @property
    def margin(self) -> float | None: ...
    @property
    def normal(self) -> _Floats | None: ...
    @property
    def surfaces(self) -> list[str]: ...

@final
class SolidOverlapping(_SolidAnswer, _NoNumber):
    __match_args__: Final = ("least_tolerance",)
    @property
    def distance(self) -> None: ...
    @property
    def least_tolerance(self) -> float | None: ...
    @property
    def place(self) -> tuple[int | None, int | None]: ...
    @property
    def surfaces(self) -> list[str]: ...

@final
class SolidCertificate:
    @property
    def tolerance(self) -> float: ...
    @property
    def lower(self) -> float: ...
    def to_json(self) -> str: ...
    @staticmethod
    def from_json(text: str) -> SolidCertificate: ...
    def __reduce__(self) -> tuple[Any, Any]: ...

@final
class Pair:
    def __new__(
        cls,
        moving: _Body,
        fixed: _Body,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
    ) -> Pair: ...
    def distance(self) -> Distance: ...
    def depth(self) -> Depth | OverlapDepth: ...
    def common_part(self, *, accuracy: float = 0.01) -> CommonPart: ...
    def surface_distance(self) -> tuple[float, float]: ...
    def intersects(self) -> Intersection | bool: ...
    def within(self, length: float) -> Within: ...
    @property
    def moving(self) -> ConvexPolyhedron | Solid: ...
    @property
    def fixed(self) -> ConvexPolyhedron | Solid: ...
    @property
    def moving_pose(self) -> Pose: ...
    @property
    def fixed_pose(self) -> Pose: ...
    def __getnewargs_ex__(self) -> tuple[Any, dict[str, Any]]: ...
    def show(self, **options: Any) -> Any: ...

@final
class Motion:
    @staticmethod
    def still(pose: _Pose = None) -> Motion: ...
    @staticmethod
    def slide(by: ArrayLike, *, pose: _Pose = None) -> Motion: ...
    @staticmethod
    def turn(
        point: ArrayLike,
        axis: ArrayLike,
        *angle: Never,
        degrees: float | None = None,
        radians: float | None = None,
        pose: _Pose = None,
    ) -> Motion: ...
    @staticmethod
    def screw(
        point: ArrayLike,
        axis: ArrayLike,
        *angle: Never,
        rise: float,
        degrees: float | None = None,
        radians: float | None = None,
        pose: _Pose = None,
    ) -> Motion: ...
    @staticmethod
    def thrown(
        center: ArrayLike, velocity: ArrayLike, angular_velocity: ArrayLike, *, pose: _Pose = None
    ) -> Motion: ...
    @staticmethod
    def between(start: ArrayLike | Pose, end: ArrayLike | Pose) -> Motion: ...
    @staticmethod
    def through(poses: Iterable[ArrayLike | Pose]) -> Motion: ...
    @staticmethod
    def about(
        arm: ArrayLike,
        axis: ArrayLike,
        way: ArrayLike,
        *angle: Never,
        degrees: float | None = None,
        radians: float | None = None,
        pose: _Pose = None,
    ) -> Motion: ...
    def at(self, time: float) -> Pose: ...
    @property
    def start(self) -> Pose: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, Any]: ...
    @staticmethod
    def _of(text: str) -> Motion: ...

_Motion: TypeAlias = Motion | _Pose

@final
class MotionCast:
    def __new__(
        cls,
        moving: _Body,
        fixed: _Body,
        *,
        moving_motion: _Motion = None,
        fixed_motion: _Motion = None,
        min_gap: float = 0.0,
        tolerance: float | None = None,
        ignore_start_overlaps: bool = False,
    ) -> MotionCast: ...
    def motion(self) -> FirstContact: ...
    def clearance(self) -> MotionClearance: ...
    def to_json(self) -> str: ...
    @staticmethod
    def from_json(text: str) -> MotionCast: ...
    @property
    def moving(self) -> ConvexPolyhedron | Solid: ...
    @property
    def fixed(self) -> ConvexPolyhedron | Solid: ...
    @property
    def moving_motion(self) -> Motion: ...
    @property
    def fixed_motion(self) -> Motion: ...
    @property
    def min_gap(self) -> float: ...
    @property
    def tolerance(self) -> float: ...
    @property
    def ignore_start_overlaps(self) -> bool: ...
    def show(self, **options: Any) -> Any: ...
    def __getnewargs_ex__(self) -> tuple[Any, dict[str, Any]]: ...

@final
class FirstContact(_Answer, _Time):
    __match_args__: Final = ("outcome", "lower", "upper")
    @property
    def query(self) -> MotionCast: ...
    @property
    def outcome(self) -> Literal["contact", "grazing", "free", "overlapping", "undecided"]: ...
    @property
    def poses(self) -> tuple[Pose, Pose] | None: ...
    @property
    def point(self) -> _Floats | None: ...
    @property
    def normal(self) -> _Floats | None: ...
    @property
    def features(self) -> Features | None: ...
    @property
    def looks(self) -> int: ...
    def verify(self) -> None: ...

def motion(
    moving: _Body,
    fixed: _Body,
    moving_motion: _Motion,
    fixed_motion: _Motion = None,
    *,
    min_gap: float = 0.0,
    tolerance: float | None = None,
) -> FirstContact: ...

@final
class MotionClearance(_Answer, _Travel):
    __match_args__: Final = ("outcome", "time")
    @property
    def query(self) -> MotionCast: ...
    @property
    def outcome(self) -> Literal["blocked", "free", "overlapping"]: ...
    @property
    def time(self) -> float | None: ...
    @property
    def upper(self) -> float | None: ...
    @property
    def bounds(self) -> tuple[float, float | None] | None: ...
    @property
    def shrunk(self) -> tuple[float, float | None] | None: ...
    @property
    def tolerance(self) -> float | None: ...
    @property
    def least_tolerance(self) -> float | None: ...
    def verify(self) -> None: ...

def motion_clearance(
    moving: _Body,
    fixed: _Body,
    moving_motion: _Motion,
    fixed_motion: _Motion = None,
    *,
    min_gap: float = 0.0,
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> MotionClearance: ...

@final
class Robot:
    @staticmethod
    def read(
        path: str | PathLike[str],
        *,
        srdf: str | PathLike[str] | None = None,
        packages: Sequence[str | PathLike[str]] = ...,
        skip_missing: bool = False,
        allow_outside: bool = False,
        hulls: Sequence[str] = ...,
    ) -> Robot: ...
    @property
    def name(self) -> str: ...
    @property
    def links(self) -> list[str]: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def limits(self) -> dict[str, tuple[float, float]]: ...
    @property
    def notes(self) -> list[str]: ...
    def first_contact(
        self,
        path: ArrayLike | str | PathLike[str],
        scene: Mapping[str, ConvexPolyhedron | Solid] | None = None,
        *,
        ignore: Sequence[tuple[str, str]] = ...,
        min_gap: float = 0.0,
        joints: dict[str, float] = ...,
        columns: Sequence[str] | None = None,
        times: ArrayLike | None = None,
    ) -> PathContact: ...

@final
class PathContact(_Time):
    __match_args__: Final = ("outcome", "lower", "upper")
    @property
    def outcome(self) -> Literal["contact", "grazing", "free", "overlapping", "undecided"]: ...
    @property
    def pair(self) -> tuple[str, str] | None: ...
    @property
    def place(self) -> tuple[int, float] | None: ...
    @property
    def point(self) -> _Floats | None: ...
    @property
    def normal(self) -> _Floats | None: ...
    @property
    def overlaps(self) -> list[tuple[str, str]]: ...
    @property
    def hulls(self) -> list[str]: ...
    @property
    def pairs(self) -> int: ...
    @property
    def looks(self) -> int: ...
    @property
    def planes(self) -> int: ...
    @property
    def notes(self) -> list[str]: ...
    def verify(self) -> None: ...
    def proof_json(self) -> str: ...
    def save_proof(self, path: str | PathLike[str]) -> None: ...
    def meshes(
        self, place: tuple[int, float] | None = None
    ) -> list[tuple[str, _Floats, NDArray[np.uint32]]]: ...
    def show(self, **options: Any) -> Any: ...
    def __reduce__(self) -> tuple[Any, Any]: ...
    @staticmethod
    def _of(file: str, found: str, notes: list[str]) -> PathContact: ...
    def to_dict(self) -> dict[str, Any]: ...
    def __copy__(self) -> PathContact: ...
    def __deepcopy__(self, _memo: Any) -> PathContact: ...

@type_check_only
class _PairAnswer(_Answer):
    @property
    def query(self) -> Pair: ...

@final
class Distance(_PairAnswer, _Number):
    __match_args__: Final = ("lower", "upper")
    @property
    def on_moving(self) -> _Floats: ...
    @property
    def on_fixed(self) -> _Floats: ...
    @property
    def normal(self) -> _Floats | None: ...
    @property
    def features(self) -> Features | None: ...
    @property
    def steps(self) -> Steps | None: ...
    def verify(self) -> None: ...

@final
class Depth(_PairAnswer, _Number):
    __match_args__: Final = ("lower", "upper", "direction")
    @property
    def direction(self) -> _Floats: ...
    @property
    def translation(self) -> _Floats: ...
    @property
    def steps(self) -> Steps: ...
    def verify(self) -> None: ...

@final
class OverlapDepth(_PairAnswer, _Number):
    __match_args__: Final = ("meets", "least_tolerance")
    @property
    def meets(self) -> bool: ...
    @property
    def least_tolerance(self) -> float | None: ...
    @property
    def direction(self) -> _Floats: ...
    @property
    def translation(self) -> _Floats: ...

@final
class CommonPart:
    @property
    def query(self) -> Pair: ...
    @property
    def volume(self) -> tuple[float, float]: ...
    @property
    def bounds(self) -> tuple[_Floats, _Floats] | None: ...
    @property
    def point(self) -> _Floats | None: ...
    @property
    def relation(
        self,
    ) -> Literal["disjoint", "crossing", "moving_contained", "fixed_contained"] | None: ...
    def verify(self) -> None: ...
    def proof_json(self) -> str: ...
    def save_proof(self, path: str | PathLike[str]) -> None: ...
    def __reduce__(self) -> tuple[Any, Any]: ...
    @staticmethod
    def _of(query: Pair, text: str) -> CommonPart: ...

@final
class Within(_PairAnswer):
    __match_args__: Final = ("closer", "lower", "upper")
    @property
    def length(self) -> float: ...
    @property
    def closer(self) -> bool | None: ...
    @property
    def lower(self) -> float | None: ...
    @property
    def upper(self) -> float | None: ...
    @property
    def points(self) -> tuple[_Floats, _Floats] | None: ...
    @property
    def steps(self) -> Steps | None: ...
    def verify(self) -> None: ...
    def __bool__(self) -> bool: ...

@final
class Obstacles:
    def __new__(cls) -> Obstacles: ...
    def add(self, body: _Body, pose: _Pose = None) -> int: ...
    def add_many(
        self,
        body: ConvexPolyhedron | Solid | Sequence[ConvexPolyhedron | Solid | Placed],
        pose: _Poses = None,
    ) -> list[int]: ...
    def set_pose(self, obstacle: int, pose: _Pose) -> None: ...
    def set_poses(self, obstacles: Sequence[int], poses: _Poses) -> None: ...
    def remove(self, obstacle: int) -> None: ...
    def pose(self, obstacle: int) -> Pose: ...
    def __len__(self) -> int: ...
    def __contains__(self, obstacle: int, /) -> bool: ...
    def nearest(
        self,
        body: _Body,
        pose: _Pose = None,
        *,
        ignore: Iterable[int] = (),
    ) -> NearestObstacle | None: ...
    def within(
        self,
        body: _Body,
        length: float,
        pose: _Pose = None,
        *,
        ignore: Iterable[int] = (),
    ) -> NearbyObstacles: ...
    def clearance(
        self,
        body: _Body,
        direction: ArrayLike,
        pose: _Pose = None,
        *,
        before: float | None = None,
        min_gap: float = 0.0,
        ignore: Iterable[int] = (),
    ) -> ObstacleClearance: ...
    def nearest_many(
        self,
        body: ConvexPolyhedron | Solid,
        pose: _Poses,
        *,
        ignore: Iterable[int] = (),
        threads: int | None = None,
    ) -> NearestColumns: ...
    def clearance_many(
        self,
        body: ConvexPolyhedron | Solid,
        direction: ArrayLike,
        pose: _Poses,
        *,
        before: float | None = None,
        min_gap: float = 0.0,
        ignore: Iterable[int] = (),
        threads: int | None = None,
    ) -> ObstacleClearanceColumns: ...
    def _nearest_rows(
        self, body: Any, poses: Any, ignore: Iterable[int], threads: int | None
    ) -> _Answered: ...
    def _clearance_rows(
        self,
        body: Any,
        directions: Any,
        poses: Any,
        before: float | None,
        min_gap: float,
        ignore: Iterable[int],
        threads: int | None,
    ) -> _Answered: ...

@type_check_only
class _Proven:
    def proof_json(self) -> str: ...
    def save_proof(self, path: str | PathLike[str]) -> None: ...
    def verify(self) -> None: ...

@final
class NearbyObstacles(_Proven):
    @property
    def closer(self) -> list[int]: ...
    @property
    def undecided(self) -> list[int]: ...
    def __len__(self) -> int: ...
    def __getitem__(self, at: int, /) -> list[int]: ...
    def __iter__(self) -> Iterator[list[int]]: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class NearestObstacle(_Proven, _Number):
    @property
    def obstacle(self) -> int: ...
    @property
    def on_moving(self) -> _Floats: ...
    @property
    def on_fixed(self) -> _Floats: ...
    @property
    def normal(self) -> _Floats | None: ...

@final
class ObstacleClearance(_Proven, _Travel):
    @property
    def outcome(self) -> Literal["blocked", "free", "overlapping"]: ...
    @property
    def obstacle(self) -> int | None: ...
    @property
    def distance(self) -> float | None: ...
    @property
    def upper(self) -> float: ...
    @property
    def normal(self) -> _Floats | None: ...

@final
class Cta:
    def __new__(
        cls,
        *,
        start: Literal["center", "ellipsoids", "guess"] = "center",
        until: Literal["exit"] | float = "exit",
        cuts: Literal["shifted", "centroid"] = "shifted",
        across_cells: bool = False,
        cold: bool = False,
    ) -> Cta: ...
    @property
    def start(self) -> Literal["center", "ellipsoids", "guess"]: ...
    @property
    def until(self) -> Literal["exit"] | float: ...
    @property
    def cuts(self) -> Literal["shifted", "centroid"]: ...
    @property
    def across_cells(self) -> bool: ...
    @property
    def cold(self) -> bool: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getnewargs_ex__(self) -> tuple[tuple[()], dict[str, Any]]: ...

@final
class Tracker:
    def __new__(
        cls,
        *,
        features: bool | None = None,
        region: Literal["automatic", "everywhere"] | float | None = None,
    ) -> Tracker: ...
    def reset(self) -> None: ...
    @property
    def steps(self) -> Steps: ...
    def cast(
        self,
        moving: ConvexPolyhedron | Placed,
        fixed: ConvexPolyhedron | Placed,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        min_gap: float = 0.0,
        solver: _Solver = "auto",
    ) -> _Outcome: ...
    def contact_range(
        self,
        moving: ConvexPolyhedron | Placed,
        fixed: ConvexPolyhedron | Placed,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        min_gap: float = 0.0,
        solver: _Solver = "auto",
    ) -> ContactRange | Separated: ...
    def clearance(
        self,
        moving: ConvexPolyhedron | Placed,
        fixed: ConvexPolyhedron | Placed,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        min_gap: float = 0.0,
        solver: _Solver = "auto",
    ) -> _Clearance: ...
    def directional_depth(
        self,
        moving: ConvexPolyhedron | Placed,
        fixed: ConvexPolyhedron | Placed,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        min_gap: float = 0.0,
        solver: _Solver = "auto",
    ) -> DirectionalDepth: ...
    def intersects(
        self,
        moving: ConvexPolyhedron | Placed,
        fixed: ConvexPolyhedron | Placed,
        direction: ArrayLike,
        *,
        moving_pose: _Pose = None,
        fixed_pose: _Pose = None,
        graze_tolerance: float = 0.0,
        min_gap: float = 0.0,
        solver: _Solver = "auto",
    ) -> Intersection: ...

@overload
def cast(
    moving: ConvexPolyhedron,
    fixed: ConvexPolyhedron,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float | None = None,
    min_gap: float = 0.0,
    solver: _Solver = "auto",
    tolerance: None = None,
    ignore_start_overlaps: Literal[False] = False,
) -> _Outcome: ...
@overload
def cast(
    moving: Solid,
    fixed: _Body,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: None = None,
    min_gap: float = 0.0,
    solver: _Solver = "auto",
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> _SolidOutcome: ...
@overload
def cast(
    moving: _Body,
    fixed: Solid,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: None = None,
    min_gap: float = 0.0,
    solver: _Solver = "auto",
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> _SolidOutcome: ...
@overload
def cast(
    moving: _Body,
    fixed: _Body,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float | None = None,
    min_gap: float = 0.0,
    solver: _Solver = "auto",
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> _Outcome | _SolidOutcome: ...
def contact_range(
    moving: ConvexPolyhedron | Placed,
    fixed: ConvexPolyhedron | Placed,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float = 0.0,
    min_gap: float = 0.0,
    solver: _Solver = "auto",
) -> ContactRange | Separated: ...
@overload
def clearance(
    moving: ConvexPolyhedron,
    fixed: ConvexPolyhedron,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float | None = None,
    min_gap: float = 0.0,
    solver: _Solver = "auto",
    tolerance: None = None,
    ignore_start_overlaps: Literal[False] = False,
) -> _Clearance: ...
@overload
def clearance(
    moving: Solid,
    fixed: _Body,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: None = None,
    min_gap: float = 0.0,
    solver: _Solver = "auto",
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> _SolidClearance: ...
@overload
def clearance(
    moving: _Body,
    fixed: Solid,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: None = None,
    min_gap: float = 0.0,
    solver: _Solver = "auto",
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> _SolidClearance: ...
@overload
def clearance(
    moving: _Body,
    fixed: _Body,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float | None = None,
    min_gap: float = 0.0,
    solver: _Solver = "auto",
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
) -> _Clearance | _SolidClearance: ...
def directional_depth(
    moving: ConvexPolyhedron | Placed,
    fixed: ConvexPolyhedron | Placed,
    direction: ArrayLike,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    graze_tolerance: float = 0.0,
    min_gap: float = 0.0,
    solver: _Solver = "auto",
) -> DirectionalDepth: ...
@overload
def intersects(
    moving: ConvexPolyhedron,
    fixed: ConvexPolyhedron,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> Intersection: ...
@overload
def intersects(
    moving: Solid,
    fixed: _Body,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> bool: ...
@overload
def intersects(
    moving: _Body,
    fixed: Solid,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> bool: ...
@overload
def intersects(
    moving: _Body,
    fixed: _Body,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> Intersection | bool: ...
def distance(
    moving: _Body,
    fixed: _Body,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> Distance: ...
@overload
def depth(
    moving: ConvexPolyhedron,
    fixed: ConvexPolyhedron,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> Depth: ...
@overload
def depth(
    moving: Solid,
    fixed: _Body,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> OverlapDepth: ...
@overload
def depth(
    moving: _Body,
    fixed: Solid,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> OverlapDepth: ...
@overload
def depth(
    moving: _Body,
    fixed: _Body,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> Depth | OverlapDepth: ...
def within(
    moving: _Body,
    fixed: _Body,
    length: float,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
) -> Within: ...

@final
class FreeDirections:
    @property
    def moving(self) -> ConvexPolyhedron | Solid: ...
    @property
    def fixed(self) -> ConvexPolyhedron | Solid: ...
    @property
    def moving_pose(self) -> Pose: ...
    @property
    def fixed_pose(self) -> Pose: ...
    @property
    def outcome(self) -> Literal["free", "blocked", "undecided"]: ...
    @property
    def free_share(self) -> tuple[float, float]: ...
    @property
    def undecided_share(self) -> float: ...
    @property
    def tolerance(self) -> float: ...
    @property
    def regions(self) -> list[dict[str, Any]]: ...
    @property
    def arcs(self) -> list[dict[str, Any]]: ...
    @property
    def points(self) -> list[dict[str, Any]]: ...
    def says(self, directions: ArrayLike) -> list[Literal["free", "blocked", "undecided"]]: ...
    def is_at(self, number: int, directions: ArrayLike) -> list[bool]: ...
    def is_on(self, number: int, directions: ArrayLike) -> list[bool]: ...
    def verify(self) -> None: ...
    def to_dict(self) -> dict[str, Any]: ...
    def proof_json(self) -> str: ...
    def save_proof(self, path: str | PathLike[str]) -> None: ...

def free_directions(
    moving: _Body,
    fixed: _Body,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    tolerance: float | None = None,
    ignore_start_overlaps: bool = False,
    depth: int = 26,
    looks: int = 20_000_000,
) -> FreeDirections: ...

@final
class WaysOut:
    @property
    def moving(self) -> ConvexPolyhedron | Solid: ...
    @property
    def fixed(self) -> ConvexPolyhedron | Solid: ...
    @property
    def moving_pose(self) -> Pose: ...
    @property
    def fixed_pose(self) -> Pose: ...
    @property
    def outcome(self) -> Literal["found", "none", "not_found"]: ...
    @property
    def legs(self) -> list[tuple[list[float], float]]: ...
    @property
    def tolerance(self) -> float | None: ...
    @property
    def cells(self) -> int | None: ...
    def verify(self) -> None: ...
    def to_dict(self) -> dict[str, Any]: ...

def ways_out(
    moving: _Body,
    fixed: _Body,
    *,
    moving_pose: _Pose = None,
    fixed_pose: _Pose = None,
    tolerance: float | None = None,
    legs: int = 12,
    directions: ArrayLike | None = None,
    looks: int = 50_000_000,
    cells: int = 20_000,
) -> WaysOut: ...
def read(
    path: str | PathLike[str],
    *,
    hull: bool = False,
    scale: float = 1.0,
    convex_tolerance: float | None = None,
    merge_tolerance: float | None = None,
) -> ConvexPolyhedron: ...
def ask_many(
    question: str,
    n: int,
    moving: tuple[list[Any], NDArray[np.int64] | None],
    fixed: tuple[list[Any], NDArray[np.int64] | None],
    tables: Mapping[str, _Floats | list[Motion]],
    solver: _Solver,
    columns: Sequence[str],
    featured: bool,
    threads: int | None,
) -> _Answered: ...
def ask_paths(
    robot: Robot,
    paths: list[Any],
    scene: Mapping[str, ConvexPolyhedron | Solid] | None,
    ignore: Sequence[tuple[str, str]],
    min_gap: float,
    joints: dict[str, float],
    columns: Sequence[str] | None,
    times: list[Any] | None,
    told: Sequence[str],
    threads: int | None,
) -> tuple[_Answered, list[str]]: ...
