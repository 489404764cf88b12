"""The columns that a question reads, keeps for the answers, or rejects."""

from collections.abc import Collection
from dataclasses import dataclass
from difflib import get_close_matches

SIDES = ("moving", "fixed")
POSES = ("moving_pose", "fixed_pose")
SCREWS = ("moving_screw", "fixed_screw")
#: Columns of lists, and the accepted numbers of entries; all other columns are numbers.
LISTS = {
    "direction": (3,),
    **dict.fromkeys(POSES, (3, 7)),
    **dict.fromkeys(SCREWS, (8,)),
}
_OF_MOTIONS = (*POSES, *SCREWS, "min_gap", "tolerance")
_OF_CASTS = ("direction", *POSES, "graze_tolerance", "min_gap")
#: The columns that each question of convex bodies reads, besides the bodies and ``id``.
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
#: The columns of each question of solids, which lack some questions.
OF_SOLIDS = {name: columns for name, columns in OF_CONVEX.items() if columns is not _OF_CASTS}
OF_SOLIDS["clearance"] = ("direction", *POSES, "min_gap", "tolerance")
#: Columns that would change an answer (``colltrans batch`` reads them): never kept unread.
MEANT = {
    "query",
    "solver",
    "start",
    "until",
    "cuts",
    "across_cells",
    "cold",
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
#: Entry of :attr:`Reads.kept` that stands for all columns.
EVERYTHING = "*"


@dataclass(frozen=True)
class Reads:
    """The use of the columns of a table of queries.

    Attributes
    ----------
    question : str
    columns : tuple of str
        Columns that the question reads, besides ``id``, ``moving`` and ``fixed``.
    kept : tuple of str
        Columns that are copied to the answers.
    """

    question: str
    columns: tuple[str, ...]
    kept: tuple[str, ...]

    @property
    def known(self) -> tuple[str, ...]:
        """Returns ``id``, ``moving``, ``fixed`` and the columns that the question reads."""
        return ("id", *SIDES, *self.columns)

    @property
    def unread(self) -> tuple[str, ...]:
        """Returns the columns that are kept but not read."""
        return tuple(name for name in self.kept if name not in (EVERYTHING, *self.known))

    def stray(self, names: Collection[str]) -> str | None:
        """Returns an error that names columns neither read nor kept; None if there are none."""
        unread = [name for name in names if name not in self.known]
        if meant := [name for name in unread if name in MEANT]:
            which = ", ".join(map(repr, meant))
            return (
                f"the question {self.question!r} does not read {which}, which would change "
                "the answer; remove it"
            )
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
