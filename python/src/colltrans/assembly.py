"""Assemblies: which parts come out, along which directions, in which order, and what holds them.

Lengths are in the unit of the files. Directions are made of length 1, so distances are lengths.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from html import escape
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from colltrans import _colltrans
from colltrans.errors import InputError

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Rooms:
    """How far each part can move in each direction, and what stops it.

    Attributes
    ----------
    parts : tuple of str
    directions : ndarray of shape (D, 3)
    distance : ndarray of shape (P, D)
        Lengths that are safe to move by, which is proven: infinite where nothing is in the way, 0
        where parts overlap.
    by : ndarray of int, shape (P, D)
        The position of the part that is in the way, -1 for none.
    """

    parts: tuple[str, ...]
    directions: Floats
    distance: Floats
    by: NDArray[np.int64]

    def free(self) -> dict[str, list[int]]:
        """For each part the positions of the directions in which nothing is in the way."""
        free = np.isinf(self.distance)
        return {part: np.flatnonzero(free[k]).tolist() for k, part in enumerate(self.parts)}


@dataclass(frozen=True)
class Blocking:
    """Who blocks whom along one direction.

    Attributes
    ----------
    direction : tuple of float
    blockers : dict of str to list of str
        The parts that each part would meet.
    removable : list of list of str
        The groups that can be taken out as they are.
    """

    direction: tuple[float, ...]
    blockers: dict[str, list[str]]
    removable: list[list[str]]


@dataclass(frozen=True)
class Turn:
    """How parts turn while they go along a move, about an axis along its direction.

    Attributes
    ----------
    point : tuple of float
        A point on the axis.
    turns : float
        Counter-clockwise as seen against the direction if positive.
    phase : float
        Threads overlap least where the parts are first turned by so many turns, ...
    aside : tuple of float
        ... and put aside by this vector.
    tolerance : float or None
        Of the thread, with which it is proven that they may turn so; ``None`` if it is not proven.
    words : str
        All of it, and why it is not proven.
    """

    point: tuple[float, ...]
    turns: float
    phase: float
    aside: tuple[float, ...]
    tolerance: float | None
    words: str


@dataclass(frozen=True)
class Move:
    """A move of some parts, as one: straight, or as a screw.

    Attributes
    ----------
    parts : list of str
    direction : tuple of float
        Of length 1.
    travel : float
        How far.
    turn : Turn or None
        How they turn meanwhile, if they do.
    """

    parts: list[str]
    direction: tuple[float, ...]
    travel: float
    turn: Turn | None = None


@dataclass(frozen=True)
class PairFit:
    """What two parts are to each other, said, suggested or let pass by a step.

    Attributes
    ----------
    parts : tuple of (str, str)
    role : str or None
        ``"press"``, ``"thread"``, ``"soft"``, ``"snap"``, ``"glued"``; ``None`` where only a
        tolerance is.
    tolerance : float or None
        Of this pair alone.
    words : str
        What is let pass, or what speaks for it.
    """

    parts: tuple[str, str]
    role: str | None
    tolerance: float | None
    words: str


@dataclass(frozen=True)
class Step:
    """A group that is taken out.

    Attributes
    ----------
    parts : list of str
    direction : tuple of float
        Of length 1.
    travel : float
        How far, a length, until it lies wholly beyond what is left; 0 if nothing is ahead.
    travel_bounds : tuple of float
        At least and at most the travel, proven.
    path : list of Move
        The moves, in order, of the parts or of others that make room: with the last one the parts
        leave, along `direction` for `travel`. Mostly there is no other.
    back : list of Move
        How what made room goes back to its place once they have left.
    within : int or None
        For a step that takes a group apart, the position of the step that took the group out.
    after : list of int
        The positions of the steps before it without which it would not go; all others may as well
        come later. Of several moves all before it.
    ignored : list of tuple of (str, str)
        What the step does not speak of: the first part moves, the second stays, and their overlap
        at the start, or all that they do, is ignored on request.
    passed : list of PairFit
        What it lets pass of pairs with a role or a tolerance of their own.
    falls : list of str
        What then rests on nothing that is left.
    off_balance : list of str
        What stood before, and whose centre of mass then lies beyond what carries it.
    surfaces : list of str
        The open surfaces that the step rests on: parts of the group or in its way, not closed.
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


@dataclass(frozen=True)
class Stuck:
    """Parts of which no group, moved as one in a straight line, leaves the others.

    No group along any direction, if that is ``proven``; else none along the directions asked, and
    along others one may. Several moves, one after another, were searched as ``because`` says.
    Parts that move at once, each its own way, may come apart in all cases: that is not tried.

    Attributes
    ----------
    parts : list of str
    directions : int
        How many different directions were asked.
    proven : int or None
        The number of cells of the sphere in which it is proven that no translation of a group as
        one, in any direction, takes it from the others; ``None`` where that is not proven.
    because : str
        Why, in words: also what was searched for several moves.
    holds : dict of str to list of list of str
        For each part the least sets of others that hold it.
    """

    parts: list[str]
    directions: int
    proven: int | None
    because: str
    holds: dict[str, list[list[str]]]


@dataclass(frozen=True)
class Stage:
    """Steps that are one for whoever does them.

    Parts of one shape that leave along one direction, or equally far each along its own.

    Attributes
    ----------
    takes : str
        What is taken away: ``"8 x bolt"``.
    steps : range
        Positions of the steps; none of them waits for another one.
    travel : float
        How far they go, at most.
    """

    takes: str
    steps: range
    travel: float


@dataclass(frozen=True)
class Wanted:
    """What goes for some parts to come out.

    Attributes
    ----------
    parts : list of str
    others : list of str
        What else is taken away.
    least : bool
        Whether it is certain that no fewer others are enough, in single moves along the directions
        asked. Nothing is said of other directions.
    out : bool
        Whether the parts come out.
    """

    parts: list[str]
    others: list[str]
    least: bool
    out: bool


@dataclass(frozen=True)
class Plan:
    """How an assembly comes apart.

    Attributes
    ----------
    steps : list of Step
        In order.
    stages : list of Stage
        The same, in runs that are one for whoever does them.
    last : list of str
        What all else was taken away from and stays where it is; nothing if parts are left.
    left : list of str
        Parts that stay: fixed, or not moved by any direction asked.
    stuck : list of Stuck
    wanted : Wanted or None
        Of a plan for some parts.
    rounds : list of list of int
        Positions of the steps that may go at once: each waits for some of the round before it.
    assembly : list of tuple of (int, list of int)
        How it is put together: the steps that are walked backwards, in order, each with the
        positions in this list of those that have to come before it.
    seconds : list of float
        Of each step, by a table of handling times.
    taken : list of PairFit
        With ``auto``, what was suggested and taken for granted.
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

    def displacements(self) -> dict[str, Floats]:
        """By how much each part that moves is away from its place when all steps are done.

        How it is turned then is not told.
        """
        found: dict[str, Floats] = {}
        for step in self.steps:
            for move in (*step.path, *step.back):
                for part in move.parts:
                    way = np.multiply(move.direction, move.travel)
                    found[part] = found.get(part, np.zeros(3)) + way
        return found

    def show(self, **options: Any) -> None:
        """A picture of all parts, taken out: see :func:`colltrans.show`.

        Raises
        ------
        InputError
            A plan that comes from a pickle: it has no bodies.
        """
        from colltrans.pictures import show

        show(self, **options)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_assembly": None, "_planned": None}

    def _way(self, stage: Stage) -> str:
        first, *rest = {self.steps[k].direction: None for k in stage.steps}
        return "each its own" if rest else ", ".join(f"{c:.3g}" for c in first)

    def report(self, path: str | PathLike[str], *, title: str = "assembly") -> None:
        """Writes what is printed for the workshop: one HTML file, as ``assembly -o`` has it.

        Overlaps, contacts and who meets whom, which it tells beside the plan, are found once more.

        Parameters
        ----------
        path : str or os.PathLike
            It is written anew if it is there.
        title : str
            Of its first page.

        Raises
        ------
        InputError
            A plan that comes from a pickle: it has no bodies.

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
            raise InputError("a plan that comes from a pickle has no bodies")
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
    """The rooms of a group of parts over the sphere of directions.

    Attributes
    ----------
    parts : list of str
    directions : ndarray of shape (N, 3)
    distance : ndarray of shape (N,)
        Lengths that are safe to move by, which is proven; infinite where nothing is in the way.
    by : ndarray of int, shape (N,)
        The position of the part that is in the way, -1 for none.
    regions : list of tuple of (float, tuple of float)
        Connected sets of free directions, largest first: solid angle in steradians, and the
        direction that is farthest from the border; exact where parts are closed and meet by rule,
        else sampled.
    isolated : ndarray of shape (K, 3)
        Free directions that lie in no region, or in one that is smaller than a disc of ``border``.
    """

    parts: list[str]
    directions: Floats
    distance: Floats
    by: NDArray[np.int64]
    regions: list[tuple[float, tuple[float, ...]]]
    isolated: Floats

    @property
    def free_share(self) -> float:
        """The share of the sphere that is free."""
        return sum(angle for angle, _ in self.regions) / (4 * np.pi)


def _list(names: str | Sequence[str]) -> list[str]:
    return [names] if isinstance(names, str) else list(names)


class Assembly:
    """Parts in one world, in one unit.

    Parameters
    ----------
    parts : mapping of str to tuple of (array_like, faces)
        For each name the vertices, of shape (N, 3), and the faces of a surface.

    Raises
    ------
    AssemblyError
        A part whose surface is none, two of one name.
    InputError
        No mapping, or a part that is not a pair of vertices and faces.

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

    def __init__(self, parts: Mapping[str, tuple[ArrayLike, Any]]) -> None:
        if not isinstance(parts, Mapping):
            what = f"parts: a dict of names to (vertices, faces), not a {type(parts).__name__}"
            raise InputError(f"{what}; Assembly.read(path) reads a file or a folder")
        for name, mesh in parts.items():
            if not isinstance(mesh, Sequence) or isinstance(mesh, str) or len(mesh) != 2:
                what = type(mesh).__name__
                raise InputError(f"parts[{name!r}]: a pair (vertices, faces), not a {what}")
        self._assembly = _colltrans.Assembly([(name, *mesh) for name, mesh in parts.items()])

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
            Folders in which ``package://`` is looked for.
        skip_missing : bool
            Leave out parts whose meshes are missing, with a note.
        visual : bool
            Of URDF the visual geometry, not that for collisions.
        joints : mapping of str to float
            Positions of joints, in radians or metres.
        allow_outside : bool
            Read files that the source names and that lie neither in its folder nor in one of
            ``packages``. Only for a source that you trust.
        as_is : bool
            Refuse parts whose surface has to be mended.
        split : str
            Which parts are made of a file with several bodies. ``names``: each object or group of
            OBJ, each solid of STL; ``bodies``: each closed shell with the cavities in it, and each
            open shell; ``never``: each file, node of glTF or item of a 3MF build is one part;
            ``auto``: a source that would be a single part is taken apart, by names or else into
            bodies.
        chord : float
            Of a STEP file: how far facets may be from its surfaces, about, in millimetres. It
            needs ``pip install 'colltrans[step]'``.

        Returns
        -------
        Assembly
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
        """list of float or None: How far the facets of each part are from its surface, if known."""
        return self._assembly.chord_errors

    @property
    def unit(self) -> str | None:
        """str or None: The unit of length, where the files say one."""
        return self._assembly.unit

    @property
    def notes(self) -> list[str]:
        """list of str: What was mended, guessed or left out."""
        return self._assembly.notes

    def with_fixed(self, *names: str) -> "Assembly":
        """The same with these parts never moved; ``PART*`` is all whose names begin so."""
        return self._of(self._assembly.with_fixed(list(names)))

    def with_ignored(self, *pairs: tuple[str, str], always: bool = False) -> "Assembly":
        """The same with these pairs of parts let pass, though they overlap at the start.

        Contacts that begin later block, and so does what would make the overlap deeper. With
        ``always`` nothing between them does, whatever they run through.
        """
        return self._of(self._assembly.with_ignored(list(pairs), always))

    def with_before(self, first: str | Sequence[str], second: str | Sequence[str]) -> "Assembly":
        """The same where none of the second parts leaves while one of the first stays.

        Names may end with ``*``: all parts whose names begin so.
        """
        return self._of(self._assembly.with_before(_list(first), _list(second)))

    def with_together(self, *names: str) -> "Assembly":
        """The same where these parts leave as one, and are not taken apart."""
        return self._of(self._assembly.with_together(list(names)))

    def with_subassembly(self, name: str, *parts: str) -> "Assembly":
        """The same where these parts leave as one, and are taken apart by themselves."""
        return self._of(self._assembly.with_subassembly(name, list(parts)))

    def with_never(self, *names: str, along: ArrayLike, within: float = 45.0) -> "Assembly":
        """The same where these parts never go along a direction, nor within an angle of it.

        Parameters
        ----------
        *names : str
        along : array_like of shape (3,)
        within : float
            In degrees.
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
        """The same with what parts are to others where their contact is not like all others.

        Parameters
        ----------
        first, second : str or sequence of str
            Each of the first and each of the second are a pair; names may end with ``*``.
        role : str, optional
            ``"press"`` or ``"soft"``: both are shrunk, against each other only, by half of the
            tolerance each, or from how deep they overlap; ``"thread"``: of the screw its core is
            asked; ``"snap"``: contacts that begin within the tolerance of the start are let pass;
            ``"glued"``: they leave as one.
        tolerance : float, optional
            Of these pairs alone.
        """
        lists = _list(first), _list(second)
        return self._of(self._assembly.with_pair(*lists, role, tolerance))

    def suggestions(
        self, *, tolerance: float | None = None, stuck: Sequence[Stuck] = ()
    ) -> list[PairFit]:
        """What pairs that overlap with a tolerance may be to each other; nothing is proven by it.

        Parameters
        ----------
        tolerance : float, optional
            As for :meth:`rooms`.
        stuck : sequence of Stuck
            Of a plan, what does not come apart: threads with play are looked for among its parts.

        Examples
        --------
        ``parts.with_suggestions(parts.suggestions()).plan()`` takes them for granted.
        """
        held = [list(group.parts) for group in stuck]
        return [self._fit(*pair) for pair in self._assembly.suggestions(tolerance, held)]

    def with_suggestions(self, fits: Sequence[PairFit]) -> "Assembly":
        """The same with these said of their pairs."""
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
        """How far each part can move in each direction, against all others.

        Parameters
        ----------
        directions : array_like of shape (D, 3)
        tolerance : float, optional
            Parts are shrunk by half of this length, so that those that fit do not jam. By default
            what the chord errors of the parts and the last digits of their files ask for.
        ignore_overlaps : bool
            Whether parts that overlap now may part, and what they do later counts.

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

    def blocking(
        self,
        direction: ArrayLike,
        *,
        tolerance: float | None = None,
        ignore_overlaps: bool = False,
    ) -> Blocking:
        """Who blocks whom along a direction, however far one moves.

        Parameters
        ----------
        direction : array_like of shape (3,)
        tolerance, ignore_overlaps
            As for :meth:`rooms`.

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

    def plan(
        self,
        directions: ArrayLike = (),
        *,
        samples: int = 162,
        legs: int = 2,
        proofs: bool = True,
        tolerance: float | None = None,
        ignore_overlaps: bool = False,
        gravity: ArrayLike | None = None,
        remove: str | Sequence[str] = (),
        times: Mapping[str, float] | None = None,
        auto: bool = False,
    ) -> Plan:
        """Takes apart what straight moves take apart, and unscrews what is screwed.

        The smallest groups come first, in a natural order: what carries nothing, by the shortest
        way, parts of one shape one after another, rather up, and away from the largest part.

        Parameters
        ----------
        directions : array_like of shape (D, 3)
            Those to try; without any they are found from the parts' contacts and axes.
        samples : int
            How many directions to sample for what no other moves; 0 for none.
        legs : int
            How many moves, one after another, may take out what no single one does; parts may make
            room and go back. 1 for none.
        proofs : bool
            Whether to prove of what is stuck that no translation of a group as one, in any
            direction, takes it from the others.
        tolerance, ignore_overlaps
            As for :meth:`rooms`.
        gravity : array_like of shape (3,), optional
            Its direction; ``-y`` of glTF, else ``-z``.
        remove : str or sequence of str, optional
            Parts that are to come out, and only what has to go for that: the fewest others, if that
            can be said. Names may end with ``*``.
        times : mapping of str to float, optional
            Handling times in seconds, what to replace of the table: ``grasp``, ``move``,
            ``direction``, ``shape``, ``group``, ``hold``, ``press``, ``soft``, ``snap``,
            ``thread``.
        auto : bool
            If parts do not come apart: once more, with what their overlaps and threads
            :meth:`suggest <suggestions>`; ``taken`` of the plan says what.

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
                "legs": legs,
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
            legs,
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
                    *map(self._names, named),
                )
                for parts, d, travel, travel_bounds, (
                    path,
                    back,
                ), within, after, ignored, passed, named in steps
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
        """Where a part, or several as one, can go: all directions.

        Parameters
        ----------
        *parts : str
            Names.
        samples : int
            At least so many directions before anything is refined.
        border : float
            The border of free regions is known to this angle, in radians.
        tolerance, ignore_overlaps
            As for :meth:`rooms`.

        Returns
        -------
        RemovalMap
        """
        if not parts:
            raise InputError("parts: no part was named")
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
        """Vertices, in the world, and triangles of all parts by their names."""
        return dict(zip(self.parts, self._assembly.meshes(), strict=True))

    def show(self, **options: Any) -> None:
        """A picture of all parts: see :func:`colltrans.show`."""
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
