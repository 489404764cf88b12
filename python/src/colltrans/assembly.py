"""Assemblies: which parts come out, along which directions, in which order, and what blocks them.

Lengths are in the unit of the files. Directions are normalised, so distances are lengths.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from colltrans import _colltrans
from colltrans.errors import InputError

if TYPE_CHECKING:
    from colltrans._colltrans import _Mesh

__all__ = [
    "Assembly",
    "Audit",
    "Blocking",
    "Fastener",
    "Move",
    "PairFit",
    "Plan",
    "RemovalMap",
    "Rooms",
    "Stage",
    "Step",
    "Stuck",
    "ToolReach",
    "Turn",
    "Unscrewing",
    "Wanted",
    "audit",
]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Rooms:
    """The free travel of each part in each direction, and the part that blocks it.

    Attributes
    ----------
    parts : tuple of str
    directions : ndarray of shape (D, 3)
    distance : ndarray of shape (P, D)
        Proven lower bounds of the free travel, lengths: infinite if nothing blocks, 0 if parts
        overlap.
    by : ndarray of int, shape (P, D)
        The index of the blocking part; -1 if none blocks.
    """

    parts: tuple[str, ...]
    directions: Floats
    distance: Floats
    by: NDArray[np.int64]

    def free(self) -> dict[str, list[int]]:
        """Returns for each part the indices of the directions in which nothing blocks it."""
        free = np.isinf(self.distance)
        return {part: np.flatnonzero(free[k]).tolist() for k, part in enumerate(self.parts)}


@dataclass(frozen=True, eq=False)
class Audit:
    """The pairs of parts that interfere, touch, or are nearer than their clearance.

    Violations are first, and of these the worst. Absent numbers are NaN. All bounds are proven
    ``[lower, upper]``.

    Attributes
    ----------
    parts : tuple of str
    first, second : ndarray of int, shape (N,)
        Indices of the parts of each pair, the smaller first.
    finding : ndarray of str, shape (N,)
        ``"interfering"``, ``"contained"``, ``"touching"`` or ``"apart"``.
    violation : ndarray of bool, shape (N,)
        Whether the pair interferes, is contained, or is nearer than its clearance.
    inner : ndarray of int, shape (N,)
        The index of the part inside the other one, of contained pairs; otherwise -1.
    role : ndarray of str, shape (N,)
        The role of the pair, for example ``"press"``; ``""`` without a role.
    clearance, tolerance : ndarray of shape (N,)
        The required clearance of the pair, and the sum of the lengths by which its closed bodies
        are shrunk.
    distance : ndarray of shape (N, 2)
        Bounds of the distance of parts that touch or are apart.
    depth : ndarray of shape (N, 2)
        Bounds of the length of the shortest translation that separates parts that interfere or are
        contained.
    volume : ndarray of shape (N, 2)
        Bounds of the volume of the common part.
    translation : ndarray of shape (N, 3)
        Translations of the first part that separate it; as long as the upper bound of the depth.
    point : ndarray of shape (N, 3)
        A point inside both parts, or else the nearest point of the first part.
    other_point : ndarray of shape (N, 3)
        The nearest point of the second part, of parts that touch or are apart.
    wall : ndarray of shape (N, 2)
        Bounds of the distance of the surfaces of contained parts: how thick the wall between them
        is.
    wall_point, other_wall_point : ndarray of shape (N, 3)
        The nearest points of the surfaces of the first and the second part, of contained parts.
    least_tolerance : ndarray of shape (N,)
        The tolerance with which parts that interfere would touch; NaN if there is none.
    open_shells : ndarray of bool, shape (N, 2)
        Whether each part has open shells. These have no inside, so that containment, depth and
        volume are those of closed shells alone.
    examined, ignored : int
        Number of pairs whose boxes are near enough, and of those that are ignored or glued.
    proofs, unproven : tuple of dict
        With ``proofs=``: for each pair the name of the file of each claim (``"distance"``,
        ``"depth"``, ``"common_part"``), and the reason why a claim has no proof.
    """

    parts: tuple[str, ...]
    first: NDArray[np.int64]
    second: NDArray[np.int64]
    finding: NDArray[np.str_]
    violation: NDArray[np.bool_]
    inner: NDArray[np.int64]
    role: NDArray[np.str_]
    clearance: Floats
    tolerance: Floats
    distance: Floats
    depth: Floats
    volume: Floats
    translation: Floats
    point: Floats
    other_point: Floats
    wall: Floats
    wall_point: Floats
    other_wall_point: Floats
    least_tolerance: Floats
    open_shells: NDArray[np.bool_]
    examined: int
    ignored: int
    proofs: tuple[dict[str, str], ...] = ()
    unproven: tuple[dict[str, str], ...] = ()

    def __len__(self) -> int:
        return len(self.first)

    def violations(self) -> list[tuple[str, str]]:
        """Returns the names of the parts of each violation, the worst first."""
        pairs = zip(self.first[self.violation], self.second[self.violation], strict=True)
        return [(self.parts[a], self.parts[b]) for a, b in pairs]

    def __repr__(self) -> str:
        return f"Audit({self.examined} pairs examined, {int(self.violation.sum())} violations)"


@dataclass(frozen=True)
class Blocking:
    """The blocking graph of one direction.

    Attributes
    ----------
    direction : tuple of float
    blockers : dict of str to list of str
        The parts that each part would meet.
    removable : list of list of str
        The groups that can be removed in this direction while all other parts stay.
    """

    direction: tuple[float, ...]
    blockers: dict[str, list[str]]
    removable: list[list[str]]


@dataclass(frozen=True)
class Turn:
    """The rotation of parts during a move, about an axis along its direction.

    Attributes
    ----------
    point : tuple of float
        A point on the axis.
    turns : float
        Number of turns; positive values are counter-clockwise as seen against the direction.
    phase : float
        Initial rotation of the parts, in turns, with which threads overlap least.
    aside : tuple of float
        Initial lateral displacement of the parts, with which threads overlap least.
    tolerance : float or None
        The thread tolerance for which the rotation is proven; ``None`` if it is not proven.
    words : str
        A description, with the reason if the rotation is not proven.
    """

    point: tuple[float, ...]
    turns: float
    phase: float
    aside: tuple[float, ...]
    tolerance: float | None
    words: str


@dataclass(frozen=True)
class Move:
    """A move of some parts as one: straight, or as a screw.

    Attributes
    ----------
    parts : list of str
    direction : tuple of float
        A unit vector.
    travel : float
        The length of the move.
    turn : Turn or None
        The rotation of the parts during the move; ``None`` for a straight move.
    """

    parts: list[str]
    direction: tuple[float, ...]
    travel: float
    turn: Turn | None = None


@dataclass(frozen=True)
class PairFit:
    """The fit of two parts: given by the caller, suggested, or tolerated by a step.

    Attributes
    ----------
    parts : tuple of (str, str)
    role : str or None
        ``"press"``, ``"thread"``, ``"soft"``, ``"snap"``, ``"glued"``; ``None`` if the fit has only
        a tolerance.
    tolerance : float or None
        The tolerance of this pair.
    words : str
        A description of what is tolerated, or the reason for the suggestion.
    """

    parts: tuple[str, str]
    role: str | None
    tolerance: float | None
    words: str


@dataclass(frozen=True)
class Fastener:
    """A part recognised as a fastener or another standard part, in the unit of the files.

    Attributes
    ----------
    kind : str
        ``"screw"``, ``"nut"``, ``"washer"``, ``"dowel"``, ``"circlip"``, ``"key"`` or
        ``"bearing"``.
    size : str
        The designation in millimetres, for example ``"M5 x 20"``.
    words : str
        Head, drive and thread of a screw.
    diameter : float
        Of the shank, the cylinder or the hole; the width of a key.
    length : float
        The length of a screw without its head (with a countersunk head), or the height.
    width : float
        Of the head or the outside; the height of a key.
    axis : tuple of tuple of float
        A point on the axis, and its unit direction; of a screw towards the head.
    by_name : bool
        Whether the kind rests on the name too, because other parts have this shape.
    """

    kind: str
    size: str
    words: str
    diameter: float
    length: float
    width: float
    axis: tuple[tuple[float, ...], tuple[float, ...]]
    by_name: bool


@dataclass(frozen=True)
class Unscrewing:
    """The turns of a screw or nut whose thread is not modelled. The proof does not contain them.

    Attributes
    ----------
    length : float
        The length until the thread has left the hole.
    turns : float
    pitch : float
        The pitch of the model, or the standard pitch of the metric size.
    words : str
        A description that names the source of the pitch.
    """

    length: float
    turns: float
    pitch: float
    words: str


@dataclass(frozen=True)
class ToolReach:
    """A hand tool for the fastener that a step removes, among the parts that remain.

    Attributes
    ----------
    name : str
        The tool with its size in millimetres: the first one that reaches, or else the one with the
        fewest parts in its way.
    blockers : list of str
        The parts in its way; empty if it is proven that the tool and the swing of its lever meet no
        part.
    words : str
        A description.
    """

    name: str
    blockers: list[str]
    words: str

    @property
    def reaches(self) -> bool:
        """Whether the tool reaches the fastener."""
        return not self.blockers


@dataclass(frozen=True)
class Step:
    """A step of a plan: a group that is removed.

    Attributes
    ----------
    parts : list of str
    direction : tuple of float
        A unit vector.
    travel : float
        The length after which the group is completely beyond the remaining parts; 0 if nothing is
        ahead.
    travel_bounds : tuple of float
        Proven lower and upper bounds of the travel.
    path : list of Move
        The moves in order, of the group or of other parts that make room. In the last one the group
        leaves, along `direction` for `travel`. Usually this is the only move.
    back : list of Move
        The moves by which parts that made room return to their places, and by which parts of the
        group return that left displaced against each other.
    within : int or None
        For a step that takes a group apart: the index of the step that removed the group.
    after : list of int
        The indices of the earlier steps that this step needs; all others may also come later. For
        several moves these are all earlier steps.
    ignored : list of tuple of (str, str)
        Pairs that the step ignores on request: the first part moves, the second stays, and their
        overlap at the start, or every contact, is ignored.
    passed : list of PairFit
        Contacts that the step tolerates, of pairs with a role or a tolerance of their own.
    falls : list of str
        Parts that then have no support.
    off_balance : list of str
        Parts that stood before, and whose centre of mass is then outside their support.
    surfaces : list of str
        The open surfaces on which the result depends: parts of the group or in its way that are not
        closed.
    unscrewing : Unscrewing or None
        The turns of a screw or nut without a modelled thread.
    tool : ToolReach or None
        The hand tool for a screw, nut or circlip that leaves alone along its axis.
    """

    parts: list[str]
    direction: tuple[float, ...]
    travel: float
    travel_bounds: tuple[float, ...]
    path: list[Move]
    back: list[Move]
    within: int | None
    after: list[int]
    ignored: list[tuple[str, str]]
    passed: list[PairFit]
    falls: list[str]
    off_balance: list[str]
    surfaces: list[str]
    unscrewing: Unscrewing | None = None
    tool: ToolReach | None = None


@dataclass(frozen=True)
class Stuck:
    """Parts of which no group, moved as one in a straight line, can leave the others.

    If ``proven`` is set, this holds for all groups and directions; otherwise for the tested
    directions, and a group may leave along others. ``because`` describes the search for sequences
    of moves. Simultaneous moves of parts in different directions are never tried.

    Attributes
    ----------
    parts : list of str
    directions : int
        Number of different directions that were tested.
    proven : int or None
        Number of cells of the sphere in the proof that no translation of a group as one, in any
        direction, separates it from the others; ``None`` without a proof.
    because : str
        The reason, and the search for sequences of moves.
    holds : dict of str to list of list of str
        For each part the minimal sets of other parts that hold it.
    """

    parts: list[str]
    directions: int
    proven: int | None
    because: str
    holds: dict[str, list[list[str]]]


@dataclass(frozen=True)
class Stage:
    """Consecutive steps that form one operation.

    The parts have the same shape and leave along one direction, or equally far along directions of
    their own.

    Attributes
    ----------
    takes : str
        A label of the removed parts, for example ``"8 x bolt"``.
    steps : range
        Indices of the steps; none of them depends on another one of the stage.
    travel : float
        The largest travel of the steps.
    """

    takes: str
    steps: range
    travel: float


@dataclass(frozen=True)
class Wanted:
    """The removal of wanted parts.

    Attributes
    ----------
    parts : list of str
    others : list of str
        Other parts that are removed.
    least : bool
        Whether it is proven that fewer other parts do not suffice, for single moves along the
        tested directions.
    out : bool
        Whether the wanted parts come out.
    """

    parts: list[str]
    others: list[str]
    least: bool
    out: bool


@dataclass(frozen=True)
class Plan:
    """A disassembly plan.

    Attributes
    ----------
    steps : list of Step
        The steps in order.
    stages : list of Stage
        The steps grouped into operations.
    last : list of str
        The parts that remain at their place when everything else is removed; empty if parts are
        left.
    left : list of str
        Parts that stay: fixed, or not moved by any tested direction.
    stuck : list of Stuck
    wanted : Wanted or None
        The answer for wanted parts, if the plan is for some parts.
    rounds : list of list of int
        Indices of steps that may be done at the same time; each depends on a step of the round
        before.
    assembly : list of tuple of (int, list of int)
        The assembly sequence: steps to be reversed, in order, each with the indices in this list of
        its predecessors.
    seconds : list of float
        Duration of each step, from a table of handling times.
    taken : list of PairFit
        With ``auto``, the suggestions that were assumed.
    """

    steps: list[Step]
    stages: list[Stage]
    last: list[str]
    left: list[str]
    stuck: list[Stuck]
    wanted: Wanted | None
    rounds: list[list[int]]
    assembly: list[tuple[int, list[int]]]
    seconds: list[float]
    taken: list[PairFit] = field(default_factory=list)
    _assembly: "Assembly | None" = field(default=None, repr=False, compare=False)
    _planned: "_colltrans.Planned | None" = field(default=None, repr=False, compare=False)

    def __repr__(self) -> str:
        stuck = sum(len(group.parts) for group in self.stuck)
        return f"Plan({len(self.steps)} steps, {stuck or 'no'} parts stuck)"

    def displacements(self) -> dict[str, Floats]:
        """Returns the displacement of each moved part after all steps, without rotations."""
        found: dict[str, Floats] = {}
        for step in self.steps:
            for move in (*step.path, *step.back):
                for part in move.parts:
                    way = np.multiply(move.direction, move.travel)
                    found[part] = found.get(part, np.zeros(3)) + way
        return found

    def show(self, **options: Any) -> None:
        """Draws all parts after their removal; see :func:`colltrans.show`.

        Raises
        ------
        InputError
            The plan was restored from a pickle, so it has no bodies.
        """
        from colltrans.pictures import show

        show(self, **options)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_assembly": None, "_planned": None}

    def _way(self, stage: Stage) -> str:
        first, *rest = {self.steps[k].direction: None for k in stage.steps}
        return "each its own" if rest else ", ".join(f"{c:.3g}" for c in first)

    def report(self, path: str | PathLike[str], *, title: str = "assembly") -> None:
        """Writes a printable HTML report, as the command ``assembly -o`` does.

        The overlaps, contacts and blockers in the report are computed again.

        Parameters
        ----------
        path : str or os.PathLike
            An existing file is replaced.
        title : str
            The title of the first page.

        Raises
        ------
        InputError
            The plan was restored from a pickle, so it has no bodies.

        Examples
        --------
        >>> from pathlib import Path
        >>> from tempfile import TemporaryDirectory
        >>> from colltrans import Assembly
        >>> plan = Assembly.read("data/gearbox_small").plan()
        >>> with TemporaryDirectory() as folder:
        ...     file = Path(folder) / "report.html"
        ...     plan.report(file, title="gearbox")
        ...     "Proven:" in file.read_text()
        True
        """
        if self._planned is None:
            raise InputError("a plan restored from a pickle has no bodies; compute it again")
        Path(path).write_text(self._planned.report(title), encoding="utf-8")

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{number}</th><td>{escape(stage.takes)}</td>"
            f"<td>{self._way(stage)}</td>"
            f"<td>{stage.travel:.6g}</td></tr>"
            for number, stage in enumerate(self.stages, 1)
        )
        kept = {"last": self.last, "left": self.left}
        kept |= {"stuck": [part for group in self.stuck for part in group.parts]}
        rest = "; ".join(f"{of}: {escape(', '.join(names))}" for of, names in kept.items() if names)
        head = "<tr><th></th><th>takes</th><th>direction</th><th>travel</th></tr>"
        return f"<table>{head}{rows}</table><p>{rest}</p>"


@dataclass(frozen=True, eq=False)
class RemovalMap:
    """The free travel of a group of parts over the sphere of directions.

    Attributes
    ----------
    parts : list of str
    directions : ndarray of shape (N, 3)
    distance : ndarray of shape (N,)
        Proven lower bounds of the free travel, lengths; infinite if nothing blocks.
    by : ndarray of int, shape (N,)
        The index of the blocking part; -1 if none blocks.
    regions : list of tuple of (float, tuple of float)
        Connected sets of free directions, largest first: solid angle in steradians, and the
        direction farthest from the border. They are exact if all parts are closed, the group
        overlaps no other part, and no pair of them is ignored or has a fit of its own. Otherwise
        they are sampled.
    isolated : ndarray of shape (K, 3)
        Free directions outside all regions, or in a region smaller than a disc of ``border``.
    """

    parts: list[str]
    directions: Floats
    distance: Floats
    by: NDArray[np.int64]
    regions: list[tuple[float, tuple[float, ...]]]
    isolated: Floats

    @property
    def free_share(self) -> float:
        """Returns the share of the sphere that is free."""
        return sum(angle for angle, _ in self.regions) / (4 * np.pi)


def _mesh(name: str, mesh: Any) -> Sequence[Any]:
    """Returns the vertices and the faces of a part."""
    faces = getattr(mesh, "faces", None)
    faces = getattr(mesh, "triangles", None) if faces is None else faces
    if faces is not None and hasattr(mesh, "vertices"):
        return mesh.vertices, faces
    if not isinstance(mesh, Sequence) or isinstance(mesh, str) or len(mesh) != 2:
        what = type(mesh).__name__
        raise InputError(f"parts[{name!r}]: a pair (vertices, faces) or a mesh, not a {what}")
    return mesh


def _list(names: str | Sequence[str]) -> list[str]:
    return [names] if isinstance(names, str) else list(names)


class Assembly:
    """Parts in one world frame and one unit.

    Parameters
    ----------
    parts : mapping of str to tuple of (array_like, faces), mesh or body
        For each part name the vertices, of shape (N, 3), and the faces of its surface, or an object
        with ``vertices`` and ``faces`` or ``triangles``: a mesh of trimesh or open3d, or a body.

    Raises
    ------
    AssemblyError
        A part has no valid surface, or two parts have the same name. Methods raise this error for
        an unknown part name, and for constraints that are cyclic or contradict each other.
    InputError
        The argument is not a mapping, or a part is not a pair of vertices and faces.

    Examples
    --------
    >>> from colltrans import Assembly
    >>> gearbox = Assembly.read("data/gearbox_small")
    >>> len(gearbox.parts)
    16
    >>> plan = gearbox.plan()
    >>> plan.steps[0].parts, len(plan.stuck[0].parts), plan.stuck[0].proven is not None
    (['bolt_0'], 6, True)
    """

    def __init__(self, parts: "Mapping[str, tuple[ArrayLike, Any] | _Mesh]") -> None:
        if not isinstance(parts, Mapping):
            what = f"parts: a dict of names to (vertices, faces), not a {type(parts).__name__}"
            raise InputError(f"{what}; Assembly.read(path) reads a file or a folder")
        meshes = [(name, *_mesh(name, mesh)) for name, mesh in parts.items()]
        self._assembly = _colltrans.Assembly(meshes)

    @classmethod
    def _of(cls, assembly: _colltrans.Assembly) -> "Assembly":
        made = cls.__new__(cls)
        made._assembly = assembly
        return made

    @classmethod
    def read(
        cls,
        path: str | PathLike[str],
        *,
        packages: Sequence[str | PathLike[str]] = (),
        skip_missing: bool = False,
        visual: bool = False,
        joints: Mapping[str, float] | None = None,
        allow_outside: bool = False,
        as_is: bool = False,
        split: Literal["auto", "never", "names", "bodies"] = "auto",
        chord: float = 0.05,
    ) -> "Assembly":
        """Reads a folder of meshes, a manifest, URDF, glTF, GLB, 3MF, STEP or one mesh.

        Parameters
        ----------
        path : str or os.PathLike
        packages : sequence of paths
            Folders in which ``package://`` references are searched.
        skip_missing : bool
            Whether to leave out parts whose meshes are missing, with a note.
        visual : bool
            Whether to read the visual geometry of URDF instead of the collision geometry.
        joints : mapping of str to float
            Positions of joints, in radians or metres.
        allow_outside : bool
            Whether to read files that the source references outside its folder and outside
            ``packages``. Set this only for a source that you trust.
        as_is : bool
            Whether to reject parts whose surface needs repair.
        split : str
            How files with several bodies become parts. ``names``: each object or group of OBJ, each
            solid of STL. ``bodies``: each closed shell with its cavities, and each open shell.
            ``never``: each file, node of glTF or item of a 3MF build is one part. ``auto``: a
            source that would be a single part is split, by names if possible, otherwise into
            bodies.
        chord : float
            For a STEP file: the approximate distance of facets from its surfaces, in millimetres.
            It needs cadquery-ocp-novtk (``pip install 'colltrans[step]'``).

        Returns
        -------
        Assembly

        Raises
        ------
        AssemblyError
            A file is invalid or missing; the message has the reason and the place.
        colltrans.step.StepError
            A STEP file cannot be converted, or the converter is not installed.
        """
        folders = [Path(package) for package in packages]
        glb = None
        if Path(path).suffix.lower() in (".step", ".stp") and Path(path).exists():
            from .step import convert

            glb, _ = convert(path, chord)
        read = _colltrans.Assembly.read(
            Path(path),
            folders,
            skip_missing,
            visual,
            dict(joints or {}),
            allow_outside,
            as_is,
            split,
            glb,
        )
        return cls._of(read)

    @property
    def parts(self) -> list[str]:
        """list of str: The names of the parts, in order."""
        return self._assembly.names

    @property
    def chord_errors(self) -> list[float | None]:
        """list of float or None: Distance of the facets of each part from its surface, if known."""
        return self._assembly.chord_errors

    @property
    def unit(self) -> str | None:
        """str or None: The unit of length, if the files specify one."""
        return self._assembly.unit

    @property
    def notes(self) -> list[str]:
        """list of str: Repairs, guesses and omissions."""
        return self._assembly.notes

    def with_fixed(self, *names: str) -> "Assembly":
        """Returns a copy in which these parts never move; ``PART*`` stands for a name prefix."""
        return self._of(self._assembly.with_fixed(list(names)))

    def with_ignored(self, *pairs: tuple[str, str], always: bool = False) -> "Assembly":
        """Returns a copy in which overlaps of these pairs at the start are ignored.

        Later contacts still block, and so does a motion that would deepen the overlap. With
        ``always`` every contact of the pairs is ignored. ``PART*`` stands for a name prefix.
        """
        return self._of(self._assembly.with_ignored(list(pairs), always))

    def with_before(self, first: str | Sequence[str], second: str | Sequence[str]) -> "Assembly":
        """Returns a copy in which the second parts leave only after all of the first parts.

        Names may end with ``*``, which stands for a name prefix.
        """
        return self._of(self._assembly.with_before(_list(first), _list(second)))

    def with_together(self, *names: str) -> "Assembly":
        """Returns a copy in which these parts leave as one and are not taken apart."""
        return self._of(self._assembly.with_together(list(names)))

    def with_subassembly(self, name: str, *parts: str) -> "Assembly":
        """Returns a copy in which these parts leave as one and are then taken apart separately."""
        return self._of(self._assembly.with_subassembly(name, list(parts)))

    def with_never(self, *names: str, along: ArrayLike, within: float = 45.0) -> "Assembly":
        """Returns a copy in which these parts never move within an angle of a direction.

        Parameters
        ----------
        *names : str
        along : array_like of shape (3,)
        within : float
            The angle in degrees, at least 0 and less than 180.
        """
        return self._of(self._assembly.with_never(list(names), along, within))

    def with_pair(
        self,
        first: str | Sequence[str],
        second: str | Sequence[str],
        *,
        role: str | None = None,
        tolerance: float | None = None,
    ) -> "Assembly":
        """Returns a copy with a role or a tolerance for pairs of parts.

        Parameters
        ----------
        first, second : str or sequence of str
            Each of the first parts forms a pair with each of the second; names may end with ``*``.
        role : str, optional
            ``"press"`` or ``"soft"``: both parts are shrunk, only against each other, by half of
            the tolerance or of their overlap. If shrinking by their overlap would destroy a part,
            crossings at the start are ignored instead. ``"thread"``: the screw is replaced by its
            core; without a thread in the parts, crossings at the start are ignored. ``"snap"``:
            contacts that begin within the tolerance of the start are ignored. ``"glued"``: the
            parts leave as one.
        tolerance : float, optional
            The tolerance of these pairs, a length. ``"snap"`` needs one.

        Raises
        ------
        AssemblyError
            Neither a role nor a tolerance is given, a value is invalid, or a name is unknown.
        InputError
            The role is unknown.
        """
        lists = _list(first), _list(second)
        return self._of(self._assembly.with_pair(*lists, role, tolerance))

    def suggestions(
        self, *, tolerance: float | None = None, stuck: Sequence[Stuck] = ()
    ) -> list[PairFit]:
        """Suggests roles and tolerances of pairs, without a proof.

        They are for pairs that overlap with the tolerance of the bodies, for rings that snap into a
        groove, and for threads with play in stuck groups.

        Parameters
        ----------
        tolerance : float, optional
            See :meth:`rooms`.
        stuck : sequence of Stuck
            Stuck groups of a plan, whose parts are searched for threads with play.

        Examples
        --------
        ``parts.with_suggestions(parts.suggestions()).plan()`` assumes the suggestions.
        """
        held = [list(group.parts) for group in stuck]
        return [self._fit(*pair) for pair in self._assembly.suggestions(tolerance, held)]

    def with_suggestions(self, fits: Sequence[PairFit]) -> "Assembly":
        """Returns a copy with these fits of pairs."""
        made = self
        for fit in fits:
            made = made.with_pair(*fit.parts, role=fit.role, tolerance=fit.tolerance)
        return made

    def rooms(
        self,
        directions: ArrayLike,
        *,
        tolerance: float | None = None,
        ignore_overlaps: bool = False,
    ) -> Rooms:
        """Computes how far each part can move in each direction while all others stay.

        Parameters
        ----------
        directions : array_like of shape (D, 3)
        tolerance : float, optional
            Parts are shrunk by half of this length, so that fitting parts do not jam. The default
            follows from the chord errors of the parts and the precision of their files.
        ignore_overlaps : bool
            Whether overlaps at the start are ignored. Later contacts count.

        Returns
        -------
        Rooms

        Examples
        --------
        >>> from colltrans import Assembly
        >>> rooms = Assembly.read("data/gearbox_small").rooms([[0, 0, 1], [0, 0, -1]])
        >>> rooms.free()["bolt_0"]
        [0]
        """
        rows = self._assembly.rooms(directions, tolerance, ignore_overlaps)
        table = np.asarray(directions, dtype=float)
        lengths = np.linalg.norm(table, axis=-1, keepdims=True)
        shape = (len(rows), len(table))
        distance = np.array([distance for distance, _ in rows], dtype=float).reshape(shape)
        by = np.array([by for _, by in rows], dtype=np.int64).reshape(shape)
        return Rooms(tuple(self.parts), table / lengths, distance, by)

    def audit(
        self,
        within: float = 0.0,
        *,
        levels: Mapping[tuple[str, str], float] | None = None,
        tolerance: float | None = None,
        allow_contact: bool = False,
        proofs: str | PathLike[str] | None = None,
    ) -> Audit:
        """Finds all pairs of parts that interfere, touch, or are nearer than a clearance.

        Pairs with a role or a tolerance of their own have no clearance, unless a level names both
        parts. Ignored and glued pairs are left out.

        Parameters
        ----------
        within : float
            The clearance of all pairs. With 0, only interferences are violations.
        levels : mapping of (str, str) to float, optional
            Clearances between two groups of parts, for example ``{("pipe*", "beam*"): 50}``. A
            later one replaces an earlier one.
        tolerance : float, optional
            Parts that overlap by no more than this length touch. The default follows from the chord
            errors of the parts and the precision of their files.
        allow_contact : bool
            Whether parts that touch satisfy every clearance.
        proofs : str or os.PathLike, optional
            A new or empty folder for proof files of all pairs, which ``colltrans verify`` and
            ``python -m colltrans.check`` check.

        Returns
        -------
        Audit

        Examples
        --------
        >>> from colltrans import Assembly
        >>> found = Assembly.read("data/gearbox_small").audit(0.5, allow_contact=True)
        >>> bool((found.distance[found.finding == "apart", 1] < 0.5).all())
        True
        """
        if proofs is not None:
            Path(proofs).mkdir(parents=True, exist_ok=True)
            if any(Path(proofs).iterdir()):
                raise InputError(f"proofs: the folder {proofs} is not empty; name a new one")
        asked = [([a], [b], float(length)) for (a, b), length in (levels or {}).items()]
        parts, words, violation, open_shells, tables, counts, files = self._assembly.audit(
            float(within), asked, tolerance, allow_contact, proofs
        )
        first, second, inner = (np.array(part, dtype=np.int64) for part in parts)
        finding, role = (np.array(word, dtype=np.str_) for word in words)
        # Quantities with one number are columns without a second axis.
        columns = {
            name: table[:, 0] if table.shape[1] == 1 else table for name, table in tables.items()
        }
        return Audit(
            tuple(self.parts),
            first,
            second,
            finding,
            np.array(violation, dtype=np.bool_),
            inner,
            role,
            **columns,
            open_shells=np.array(open_shells, dtype=np.bool_).reshape(-1, 2),
            examined=counts[0],
            ignored=counts[1],
            proofs=tuple(files[0]),
            unproven=tuple(files[1]),
        )

    def blocking(
        self,
        direction: ArrayLike,
        *,
        tolerance: float | None = None,
        ignore_overlaps: bool = False,
    ) -> Blocking:
        """Computes which parts block which along a direction, for moves of any length.

        Parameters
        ----------
        direction : array_like of shape (3,)
        tolerance, ignore_overlaps
            See :meth:`rooms`.

        Returns
        -------
        Blocking
        """
        graph = self._assembly.blocking(direction, tolerance, ignore_overlaps)
        blockers, removable = ([self._names(group) for group in groups] for groups in graph)
        unit = np.asarray(direction, dtype=float) / np.linalg.norm(np.asarray(direction, float))
        return Blocking(
            tuple(unit.tolist()), dict(zip(self.parts, blockers, strict=True)), removable
        )

    def fasteners(self) -> dict[str, Fastener]:
        """Recognises screws, nuts, washers, dowels, circlips, keys and bearings.

        The shape decides; a name alone is not enough. See the guide to assemblies.

        Returns
        -------
        dict of str to Fastener
            The fasteners by the names of their parts.

        Examples
        --------
        >>> from colltrans import Assembly
        >>> Assembly.read("data/gearbox_small").fasteners()["bolt_0"].kind
        'screw'
        """
        return {
            name: Fastener(
                kind, size, words, d, length, width, (tuple(point), tuple(axis)), by_name
            )
            for name, found in zip(self.parts, self._assembly.fasteners(), strict=True)
            if found is not None
            for kind, size, words, (d, length, width), (point, axis), by_name in [found]
        }

    def plan(
        self,
        directions: ArrayLike = (),
        *,
        samples: int = 162,
        effort: int = 3,
        proofs: bool = True,
        tolerance: float | None = None,
        ignore_overlaps: bool = False,
        gravity: ArrayLike | None = None,
        remove: str | Sequence[str] = (),
        times: Mapping[str, float] | None = None,
        auto: bool = False,
    ) -> Plan:
        """Computes a disassembly plan of straight moves and screws.

        The smallest groups come first, in a natural order: parts that carry nothing, by the
        shortest travel, parts of one shape in sequence, preferably upwards and away from the
        largest part.

        Parameters
        ----------
        directions : array_like of shape (D, 3)
            Directions to try. The default is the directions from contacts and axes of the parts.
        samples : int
            Number of sampled directions for parts that no other direction moves; 0 for none.
        effort : int
            The work of each search for several moves, or a turn, that take out what a single move
            does not. Other parts may make room and return. A larger effort continues the same
            search. 0 for single moves only.
        proofs : bool
            Whether to prove for stuck parts that no translation of a group as one, in any
            direction, separates it from the others.
        tolerance, ignore_overlaps
            See :meth:`rooms`.
        gravity : array_like of shape (3,), optional
            The direction of gravity. The default is opposite to the upward axis of the file; ``-z``
            if the file states none. It is ``-y`` for glTF.
        remove : str or sequence of str, optional
            Wanted parts. The plan then removes only these and the fewest other parts, as far as
            this is proven. Names may end with ``*``.
        times : mapping of str to float, optional
            Handling times in seconds that replace entries of the table: ``grasp``, ``move``,
            ``direction``, ``shape``, ``group``, ``hold``, ``press``, ``soft``, ``snap``,
            ``thread``.
        auto : bool
            Whether to plan again if parts do not come apart, with the roles that
            :meth:`suggestions` returns. ``Plan.taken`` lists them.

        Returns
        -------
        Plan

        Examples
        --------
        >>> from colltrans import Assembly
        >>> gearbox = Assembly.read("data/gearbox_small").with_fixed("housing")
        >>> gearbox.plan(remove="cover").wanted.others
        ['bolt_0', 'bolt_1', 'bolt_2', 'bolt_3']
        """
        if auto:
            asked: dict[str, Any] = {
                "samples": samples,
                "effort": effort,
                "proofs": proofs,
                "tolerance": tolerance,
                "ignore_overlaps": ignore_overlaps,
                "gravity": gravity,
                "remove": remove,
                "times": times,
            }
            once = self.plan(directions, **asked)
            taken = self.suggestions(tolerance=tolerance, stuck=once.stuck) if once.stuck else []
            if not taken:
                return once
            again = self.with_suggestions(taken).plan(directions, **asked)
            return replace(again, taken=taken)
        wanted = self._assembly.group(_list(remove))
        plan = self._assembly.plan(
            directions,
            samples,
            effort,
            proofs,
            tolerance,
            ignore_overlaps,
            gravity,
            wanted,
            dict(times or {}),
        )
        steps, stages, last, left, stuck, goes, rounds, assembly, seconds, planned = plan
        names = self.parts

        def moves(all_of: list[tuple[list[int], list[float], float, Any]]) -> list[Move]:
            return [
                Move(self._names(parts), tuple(d), travel, turn and _turn(*turn))
                for parts, d, travel, turn in all_of
            ]

        return Plan(
            [
                Step(
                    self._names(parts),
                    tuple(d),
                    travel,
                    tuple(travel_bounds),
                    moves(path),
                    moves(back),
                    within,
                    after,
                    [(names[a], names[b]) for a, b in ignored],
                    [self._fit(*pair) for pair in passed],
                    self._names(falls),
                    self._names(off_balance),
                    self._names(surfaces),
                    turns and Unscrewing(*turns),
                    tool and ToolReach(tool[0], self._names(tool[1]), tool[2]),
                )
                for parts, d, travel, travel_bounds, (
                    path,
                    back,
                ), within, after, ignored, passed, (
                    falls,
                    off_balance,
                    surfaces,
                ), turns, tool in steps
            ],
            [Stage(takes, range(*of), travel) for takes, of, travel in stages],
            self._names(last),
            self._names(left),
            [
                Stuck(
                    self._names(parts),
                    directions,
                    proven,
                    because,
                    {names[part]: [self._names(group) for group in sets] for part, sets in holds},
                )
                for parts, directions, proven, because, holds in stuck
            ],
            self._wanted(*goes) if goes is not None else None,
            rounds,
            assembly,
            seconds,
            _assembly=self,
            _planned=planned,
        )

    def _fit(
        self, parts: list[int], role: str | None, tolerance: float | None, words: str
    ) -> PairFit:
        first, second = self._names(parts)
        return PairFit((first, second), role, tolerance, words)

    def _wanted(self, parts: list[int], others: list[int], least: bool, out: bool) -> Wanted:
        return Wanted(self._names(parts), self._names(others), least, out)

    def removal_map(
        self,
        *parts: str,
        samples: int = 2562,
        border: float = 0.01,
        tolerance: float | None = None,
        ignore_overlaps: bool = False,
    ) -> RemovalMap:
        """Computes in which directions a part, or several parts as one, can leave.

        Parameters
        ----------
        *parts : str
            Part names.
        samples : int
            The minimum number of directions before refinement.
        border : float
            The resolution of the borders of free regions, in radians.
        tolerance, ignore_overlaps
            See :meth:`rooms`.

        Returns
        -------
        RemovalMap
        """
        if not parts:
            raise InputError("parts: no part is named; give at least one name")
        group = sorted({self._assembly.index(name) for name in parts})
        found = self._assembly.removal_map(group, samples, border, tolerance, ignore_overlaps)
        directions, (distance, by), regions, isolated = found
        return RemovalMap(
            self._names(group),
            np.array(directions),
            np.array(distance),
            np.array(by, dtype=np.int64),
            [(angle, tuple(center)) for angle, center in regions],
            np.array(isolated).reshape(-1, 3),
        )

    def _names(self, positions: Sequence[int]) -> list[str]:
        names = self.parts
        return [names[k] for k in positions]

    def meshes(self) -> dict[str, tuple[Floats, NDArray[np.uint32]]]:
        """Returns the vertices in the world and the triangles of all parts, by name."""
        return dict(zip(self.parts, self._assembly.meshes(), strict=True))

    def show(self, **options: Any) -> None:
        """Draws all parts; see :func:`colltrans.show`."""
        from colltrans.pictures import show

        show(self, **options)

    def __repr__(self) -> str:
        return f"Assembly({len(self.parts)} parts)"


def _turn(
    point: list[float],
    turns: float,
    phase: float,
    aside: list[float],
    tolerance: float | None,
    words: str,
) -> Turn:
    return Turn(tuple(point), turns, phase, tuple(aside), tolerance, words)


def audit(
    parts: Assembly | Mapping[str, tuple[ArrayLike, Any]] | str | PathLike[str],
    within: float = 0.0,
    *,
    levels: Mapping[tuple[str, str], float] | None = None,
    tolerance: float | None = None,
    allow_contact: bool = False,
    proofs: str | PathLike[str] | None = None,
) -> Audit:
    """Finds all pairs of parts that interfere, touch, or are nearer than a clearance.

    Parameters
    ----------
    parts : Assembly, mapping of str to (vertices, faces), or path
        The parts, or a file or folder for :meth:`Assembly.read`.
    within, levels, tolerance, allow_contact, proofs
        See :meth:`Assembly.audit`.

    Returns
    -------
    Audit

    Examples
    --------
    >>> import numpy as np
    >>> from colltrans.assembly import audit
    >>> corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    >>> faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    >>> parts = {"a": (corners, faces), "b": (corners + [0.75, 0, 0], faces)}
    >>> found = audit(parts)
    >>> found
    Audit(1 pairs examined, 1 violations)
    >>> found.finding.tolist(), bool(np.allclose(found.depth, 0.25))
    (['interfering'], True)
    """
    if isinstance(parts, Assembly):
        assembly = parts
    elif isinstance(parts, (str, PathLike)):
        assembly = Assembly.read(parts)
    else:
        assembly = Assembly(parts)
    return assembly.audit(
        within, levels=levels, tolerance=tolerance, allow_contact=allow_contact, proofs=proofs
    )
