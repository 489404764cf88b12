"""Which columns a question reads, which are kept for the answers, and which are refused."""

from collections.abc import Collection
from dataclasses import dataclass
from difflib import get_close_matches

SIDES = ("moving", "fixed")
POSES = ("moving_pose", "fixed_pose")
SCREWS = ("moving_screw", "fixed_screw")
#: Lists of numbers, and how many there may be; all other columns are numbers.
LISTS = {
    "direction": (3,),
    **dict.fromkeys(POSES, (3, 7)),
    **dict.fromkeys(SCREWS, (8,)),
}
_OF_MOTIONS = (*POSES, *SCREWS, "keep", "tolerance")
_OF_CASTS = ("direction", *POSES, "graze_tolerance", "keep")
#: Beside the bodies and ``id``, what each question reads of convex bodies.
OF_CONVEX: dict[str, tuple[str, ...]] = {
    "contact": _OF_CASTS,
    "range": _OF_CASTS,
    "clearance": _OF_CASTS,
    "distance": POSES,
    "depth": POSES,
    "within": (*POSES, "length"),
    "directions": (*POSES, "tolerance"),
    "motion": _OF_MOTIONS,
    "motion_clearance": _OF_MOTIONS,
}
#: The same of solids, which are not asked all of these.
OF_SOLIDS = {name: columns for name, columns in OF_CONVEX.items() if columns is not _OF_CASTS}
OF_SOLIDS["clearance"] = ("direction", *POSES, "keep", "tolerance")
#: What changes an answer where it is read (``colltrans batch`` does): never kept unread.
MEANT = {
    "query",
    "solver",
    "start",
    "until",
    "scale",
    "hull",
    "open",
    "tolerance",
    "convex_tolerance",
    "depth",
    "looks",
    "merge_tolerance",
    "ignore_start_overlaps",
    "moving_motion",
    "fixed_motion",
}
#: Of :attr:`Reads.kept`: all columns.
EVERYTHING = "*"


@dataclass(frozen=True)
class Reads:
    """What is done with the columns of a table of queries.

    Attributes
    ----------
    question : str
    columns : tuple of str
        Those that it reads beside ``id``, ``moving`` and ``fixed``.
    kept : tuple of str
        Those that go into the answers as they are.
    """

    question: str
    columns: tuple[str, ...]
    kept: tuple[str, ...]

    @property
    def known(self) -> tuple[str, ...]:
        """What has a place, whether it is kept or not."""
        return ("id", *SIDES, *self.columns)

    @property
    def unread(self) -> tuple[str, ...]:
        """What is kept by its name alone."""
        return tuple(name for name in self.kept if name not in (EVERYTHING, *self.known))

    def stray(self, names: Collection[str]) -> str | None:
        """Why these columns are refused, if they are: by the names of all that nobody wants."""
        unread = [name for name in names if name not in self.known]
        if meant := [name for name in unread if name in MEANT]:
            which = ", ".join(map(repr, meant))
            return f"the question {self.question!r} does not read {which}, and would be another"
        if EVERYTHING in self.kept:
            return None
        stray = [name for name in unread if name not in self.kept]
        if not stray:
            return None
        which = ", ".join(f"{name!r}{self._hint(name)}" for name in stray)
        return f"the question {self.question!r} does not read {which}; --keep {','.join(stray)}"

    def _hint(self, name: str) -> str:
        near = get_close_matches(name, self.known, 1)
        return f" (is it {near[0]!r}?)" if near else ""
