"""``python -m colltrans.check PROOF``: checks a file of ``--save-proof`` in exact fractions.

The checker shares no code with the library and rounds nothing: every number of the file is the
fraction that its 64 bits represent, and the nine entries of a pose place a body. It needs no other
package, so ``python check.py PROOF`` works without the extension. It is a single file on purpose: a
reader who does not trust the library can read it from top to bottom, because each part uses only
earlier parts, and run it anywhere. The last part, "The whole file", lists the kinds of claims.

Notation: moving body ``P``, fixed body ``Q``, direction ``d``, all points in the world.

- *Lower bound.* ``(min_Q n.q - max_P n.p) / n.d`` over all vertices, for ``n.d > 0``: the bodies do
  not meet at any smaller translation. The claimed bound must not be larger.
- *Upper bound.* The weighted mean of the three differences ``q - p`` of the certificate is as near
  to the line ``t d`` as rounding explains. The claimed bound must not be smaller than the ``t`` of
  this point plus an allowance for rounding. If the line also meets the triangle of the differences
  by then, the bodies do meet exactly, which is reported.
- *Slides.* ``(max_P n'.p - min_Q n'.q) / |n'|`` over all vertices, where ``n' = n (d.d) - d (n.d)``
  is the part of ``n`` across the direction: an upper bound of the overlap of the shadows. The
  claimed overlap must not be smaller.
- *Rounded bodies* are hulls of points swept by a ball. The sum ``r`` of both radii is added to each
  gap: bodies are ``g`` apart where the hulls are ``g + r`` apart, and bodies whose hulls are ``x``
  apart, or ``x`` deep, have the depth ``r - x``, or ``r + x``. Boxes are wider by the radius. The
  same holds for the facets of rounded solids.
- *Bodies.* The faces of a convex body, if it has any, form a closed surface with all vertices, and
  no neighbouring vertex is far above a face. No proof depends on the faces. If they may not be
  those of the hull of the vertices, this is reported as unchecked; ``colltrans verify`` rejects
  such a body.
- *Separation.* ``n'`` is orthogonal to ``d``. ``min_Q n'.q > max_P n'.p`` proves that the bodies
  never meet, and ``(min_Q n'.q - max_P n'.p) / |n'|`` is a lower bound of the distance of their
  shadows. The claimed margin must not be larger.
- *A minimum gap* ``g`` replaces contact by a distance: ``g |n|`` is subtracted from what planes
  prove, and at the upper bound the weighted means of the pairs are at most ``g`` apart. Two facets
  of solids meet where they are ``g`` apart.
- *Distance.* ``min_Q n.q - max_P n.p`` over all vertices proves a lower bound. The weighted means
  of the pairs, one point of each body, prove an upper bound. For a distance of 0 the differences of
  the pairs enclose the origin.
- *Depth.* A translation of ``max_Q d.q - min_P d.p`` along the direction ``d`` separates the
  bodies. A closed surface of triangles between differences ``q - p`` winds around the origin, which
  a ray that meets none of its edges shows. No triangle is nearer than claimed, or turned away.
- *Solids.* A plane between them as above, and the translation at which the two stopping facets
  meet. The claims about all other facets (the covers) are not checked here; ``colltrans verify``
  checks them.
- *Distance of solids.* The two points, one in a facet of each body. A search over pairs of boxes
  and then facets shows that no others are nearer, and a ray that no shell is inside the other
  solid. The cover of the proof is not used.
- *Depth of solids.* At the stated translation the bodies are apart, by the same search. A box or a
  point in each body is swept by a ball: no facet is nearer than the radius, and a ray shows that it
  is inside. No shorter translation separates such boxes. For convex bodies,
  the closed surface of *Depth*, less the length by which the hulls of their vertices must be shrunk
  to be inside their facets.
- *Common parts of solids.* A box, each side of which bounds a body, is cut into convex cells. No
  facet of a body meets a cell that is claimed to be on one side of it, and a ray shows on which
  one. Corners are integers over a common denominator, and volumes are sums of tetrahedra.
- *One body among many.* Every obstacle is checked: by its claim, as above, or else by the bounding
  boxes of both bodies, with their distance or the translation at which they meet.
- *Motions.* For bodies that turn: at the time of each plane, its gap over all vertices, with sine
  and cosine to 36 digits; between two planes, a bound of the curvature of the heights, or of the
  rise of each vertex on its arc; at the time of contact, a surface around the origin as for a
  depth.
- *Motions of solids.* Their facets, moved inwards as stored in the file, in the tree that it names.
  Every entry of the cover is checked: its normal separates two boxes or facets at both ends of its
  time and, with a curvature bound, in between; or a list of planes does. A ray shows that no shell
  is inside the other solid at the start, and an edge passes through a facet at the contact. It is
  not checked that the tolerance moves facets as stored; the displacement is reported.
- *Joint paths.* For convex bodies: at each plane its gap over all vertices, with the joints
  composed one after the other; between two planes of a row a curvature bound of the heights; across
  rows a bound of the motion of points. For solids the same with pairs of boxes and facets. A ray
  shows that no body is inside another one at the start.
- *All directions.* Two facets ``f`` and ``g`` block an open cone: ``n_f.d > 0``, ``n_g.d < 0``, and
  ``d`` inside the cone of the nine differences ``g - f``. A blocked cell has its four corners in
  the cone. The remainder of any other cell after cones are removed consists of convex pieces, whose
  corners are vector products. A search over pairs of boxes and then facets shows that nothing else
  blocks them. It is not checked that the bodies do not overlap at the start, nor how they were
  shrunk.

Exit codes: 0 if the whole proof holds, 7 if the checked parts hold but not all were checked, 6 if
a claim does not hold, 3 if the file is not a proof, 1 if nothing in it can be checked here, 2 for
wrong usage.
"""

from __future__ import annotations

import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache
from itertools import combinations, pairwise, product
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

# Formats and limits
# ------------------

FORMAT = "colltrans proof"
VERSION = 2
Number = TypeVar("Number", int, Fraction)
Triple: TypeAlias = tuple[Number, Number, Number]
Vector: TypeAlias = Triple[Fraction]
#: A vector and the corners of a facet with integer coordinates.
Whole: TypeAlias = Triple[int]
Corners: TypeAlias = tuple[Whole, Whole, Whole]
Matrix: TypeAlias = tuple[Vector, Vector, Vector]
Triangle: TypeAlias = tuple[Vector, Vector, Vector]
#: The least and the largest coordinates of a box.
Bounds: TypeAlias = tuple[Triple[Number], Triple[Number]]
Facet: TypeAlias = tuple[int, int, int]
#: Rounding error of one operation.
_U = Fraction(1, 2**53)
#: Maximum deviation of the length of a unit vector from 1: the library's limit plus an eighth,
#: because the library rounds lengths.
_UNIT_VECTOR = 36 * _U
#: Rounding error of a coordinate, in sizes of the configuration: the library's noise.
_NOISE = 32 * _U
#: Number of noises up to which a gap is slight: points at that distance may not be found with
#: certainty. This limit and the next ones are the library's with a small margin, because the
#: library rounds noises.
_SLIGHT = 8 + Fraction(1, 64)
#: Numbers of noises by which witness points may miss each other, and by which an upper bound
#: exceeds them, divided by ``n.d``.
_MISS, _RAISE = Fraction(13, 4), Fraction(11, 4)
#: Number of noises by which witness points may miss each other if no upper bound is claimed.
_MISS_WIDENED = 67
#: The largest ``rounding`` of a contact in noises, and an allowance for a normal across the
#: direction.
_MOST_STATED = (63, 259)
#: Maximum magnitude of a coordinate, displacement or gap.
MOST = 2**200
#: Range of magnitudes of nonzero coordinates.
_RANGE = (Fraction(1, MOST), Fraction(MOST))
#: The minimum gap if there is none.
_NO_GAP = Fraction()
#: Maximum distance of a face from its plane, in sizes of the body, beyond its ``hull_error``.
_PLANE = Fraction(1, 2**20)
#: Maximum deviation of the products of a pose's axes from those of a rotation.
_TURN = Fraction(1, 10**6)
#: Absolute or relative error of sines, cosines and roots.
_TINY = Fraction(1, 2**120)
#: Binary digits after the point in their computation.
_DIGITS = 160
#: Relative error of a computed position. Claimed depths refer to such positions.
_POSE = 256 * _U
#: Error of facet points in the world, relative to the size, up to which signs are certain.
_SURE = Fraction(1, 2**96)
#: Maximum number of pairs of boxes in a search for two facets.
MAX_PAIRS = 5_000_000
#: Exceptions of reading a malformed file. The first one comes from numbers out of range.
_MALFORMED = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


class NoProofError(ValueError):
    """The file is not a proof file of ``--save-proof``."""


class RefusedError(Exception):
    """A claim does not hold."""


@dataclass
class Report:
    """The results of a check."""

    holds: list[str] = field(default_factory=list)
    unchecked: list[str] = field(default_factory=list)
    #: Whether a part of the claims was not checked.
    partly: bool = False
    #: Whether the proof has a cover that was not read, because its claim was checked without it.
    has_cover: bool = False


# Fields of the file
# ------------------


def number(value: Any) -> Fraction:
    """Returns a number of the file as a fraction."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise NoProofError(f"{value!r} is not a number")
    if not math.isfinite(value):
        raise NoProofError(f"{value!r} is not finite")
    return Fraction(float(value))


def coordinate(value: Any) -> Fraction:
    """Returns a number in the range of coordinates."""
    found = number(value)
    if found and not _RANGE[0] <= abs(found) <= _RANGE[1]:
        raise NoProofError(f"{value!r} is neither 0 nor a magnitude from 2^-200 to 2^200")
    return found


def fields(value: Any, needed: str, optional: str = "") -> dict[str, Any]:
    """Returns an object with exactly these fields; missing optional fields are None."""
    if not isinstance(value, dict):
        raise NoProofError(
            f"there has to be an object with {needed or optional}, not {value!r:.40}"
        )
    names = needed.split()
    missing = [name for name in names if name not in value]
    unknown = [name for name in value if name not in (*names, *optional.split())]
    if missing or unknown:
        raise NoProofError(f"missing fields {missing}, unknown fields {unknown}")
    return dict.fromkeys(optional.split()) | value


def listed(value: Any, count: int | None = None) -> list[Any]:
    """Returns a list; checks its length if ``count`` is given."""
    if not isinstance(value, list) or (count is not None and len(value) != count):
        raise NoProofError(f"{value!r:.40} is not a list" + (f" of {count}" if count else ""))
    return value


def whole(value: Any, end: int) -> int:
    """Returns an index below ``end``."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise NoProofError(f"{value!r} is not an index")
    if not 0 <= value < end:
        raise RefusedError(f"index {value} is out of range; there are {end}")
    return value


def vector(values: Any) -> Vector:
    x, y, z = listed(values, 3)
    return number(x), number(y), number(z)


def place(values: Any) -> Vector:
    """Returns a vector whose coordinates are in range."""
    x, y, z = listed(values, 3)
    return coordinate(x), coordinate(y), coordinate(z)


def one_of(of: Any, *kinds: str) -> tuple[str, Any]:
    """Returns name and content of the only field of an object, which has one of these names."""
    if not isinstance(of, dict) or len(of) != 1 or next(iter(of)) not in kinds:
        raise NoProofError(f"there has to be one of {', '.join(kinds)}")
    ((kind, content),) = of.items()
    return kind, content


def is_text(value: Any) -> bool:
    """Checks whether a value is a string without unpaired surrogates."""
    return isinstance(value, str) and not any("\ud800" <= c <= "\udfff" for c in value)


def truth(value: Any) -> bool:
    """Returns a boolean."""
    if not isinstance(value, bool):
        raise NoProofError(f"{value!r} is not true or false")
    return value


def bounded(value: Fraction, most: int | Fraction, what: str) -> Fraction:
    """Returns a number if its magnitude is at most ``most``."""
    if abs(value) > most:
        raise NoProofError(f"{what} of {float(value)!r} is out of range")
    return value


def bounded_vector(values: Any, what: str) -> Vector:
    """Returns a vector whose components have magnitudes of at most 2^200."""
    x, y, z = vector(values)
    return bounded(x, MOST, what), bounded(y, MOST, what), bounded(z, MOST, what)


# Vectors
# -------

_ZERO: Vector = (Fraction(), Fraction(), Fraction())
_UNITS: tuple[Vector, Vector, Vector] = (
    (Fraction(1), Fraction(), Fraction()),
    (Fraction(), Fraction(1), Fraction()),
    (Fraction(), Fraction(), Fraction(1)),
)
_ONES: Vector = (Fraction(1), Fraction(1), Fraction(1))


def dot(a: Triple[Number], b: Triple[Number]) -> Number:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Triple[Number], b: Triple[Number]) -> Triple[Number]:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def scaled(a: Triple[Number], by: Number) -> Triple[Number]:
    return a[0] * by, a[1] * by, a[2] * by


def plus(a: Triple[Number], b: Triple[Number]) -> Triple[Number]:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Triple[Number], b: Triple[Number]) -> Triple[Number]:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def negative(a: Triple[Number]) -> Triple[Number]:
    return -a[0], -a[1], -a[2]


def above(length: Fraction, square: Fraction) -> bool:
    """Checks whether a length is at least the root of a square."""
    return length >= 0 and length * length >= square


def is_within(p: Vector, q: Vector, length: Fraction) -> bool:
    """Checks whether two points are at most a length apart."""
    between = minus(q, p)
    return above(length, dot(between, between))


def root_above(square: Fraction) -> Fraction:
    """Returns an upper bound of the root of a number, with a relative error of at most `_TINY`."""
    if square <= 0:
        return Fraction()
    bits = (square.numerator.bit_length() - square.denominator.bit_length()) // 2
    places = _DIGITS - bits
    scale = Fraction(2) ** (2 * places)
    return Fraction(math.isqrt(math.ceil(square * scale)) + 1) / Fraction(2) ** places


def unit(normal: Vector, what: str = "the normal") -> None:
    if not (1 - _UNIT_VECTOR) ** 2 <= dot(normal, normal) <= (1 + _UNIT_VECTOR) ** 2:
        raise RefusedError(f"{what} is not a unit vector")


def mean(points: Sequence[Vector], weights: Sequence[Any]) -> Vector:
    """Returns the weighted mean of points."""
    shares = [w if isinstance(w, Fraction) else number(w) for w in listed(weights)]
    total = sum(shares, Fraction())
    if len(shares) != len(points) or min(shares) < 0 or abs(total - 1) > _UNIT_VECTOR:
        raise RefusedError("the weights are not those of a mean")
    found = _ZERO
    for point, share in zip(points, shares, strict=True):
        found = plus(found, scaled(point, share / total))
    return found


def area(points: list[Vector], face: list[int]) -> Vector:
    """Returns twice the area vector of a polygon."""
    total = _ZERO
    for a, b in pairwise(face[1:]):
        side, other = minus(points[a], points[face[0]]), minus(points[b], points[face[0]])
        total = plus(total, cross(side, other))
    return total


def line_range(points: Sequence[Vector], d: Vector) -> tuple[Fraction, Fraction] | None:
    """Returns the least and the largest ``t`` for which ``t d`` is in the convex hull of points.

    Both occur at points, on segments or in triangles of the points; None if there is no such ``t``.
    """
    square = dot(d, d)
    e1 = cross(d, min(_UNITS, key=lambda e: abs(dot(e, d))))
    e2 = cross(d, e1)
    shadows = [(dot(e1, m), dot(e2, m)) for m in points]
    times = [dot(d, m) / square for m in points]
    found = [t for s, t in zip(shadows, times, strict=True) if not any(s)]

    def turn(i: int, j: int) -> Fraction:
        (a, b), (x, y) = shadows[i], shadows[j]
        return a * y - b * x

    for i, j in combinations(range(len(points)), 2):
        a, b = shadows[i], shadows[j]
        if turn(i, j) == 0 and a[0] * b[0] + a[1] * b[1] < 0:
            # The origin is between the two shadows; use the coordinate in which they differ.
            k = 0 if a[0] != b[0] else 1
            share = a[k] / (a[k] - b[k])
            found.append(times[i] + share * (times[j] - times[i]))
    for i, j, k in combinations(range(len(points)), 3):
        u, v, w = turn(j, k), turn(k, i), turn(i, j)
        if (u > 0 and v > 0 and w > 0) or (u < 0 and v < 0 and w < 0):
            found.append((u * times[i] + v * times[j] + w * times[k]) / (u + v + w))
    return (min(found), max(found)) if found else None


def encloses(corners: Sequence[Vector]) -> bool:
    """Checks whether a tetrahedron with a volume contains the origin."""
    a, b, c, d = corners
    faces = ((b, c, d), (a, d, c), (a, b, d), (a, c, b))
    signs = [dot(u, cross(v, w)) for u, v, w in faces]
    return any(signs) and (min(signs) >= 0 or max(signs) <= 0)


def winds(at: Vector, facets: list[Triangle]) -> int:
    """Returns the winding number of a surface around a point that is not on it."""
    for k in range(1, 60):
        way = (Fraction(1), Fraction(k, 61), Fraction(k * k, 3721))
        count, sure = 0, True
        for triangle in facets:
            a, b, c = (minus(v, at) for v in triangle)
            volume = dot(cross(a, b), c)
            if volume == 0:
                # A ray that leaves the plane at the point does not meet it again.
                normal = cross(minus(b, a), minus(c, a))
                if any(normal) and dot(normal, way) == 0:
                    sure = False
                    break
                continue
            sides = [dot(cross(u, v), way) for u, v in ((a, b), (b, c), (c, a))]
            if 0 in sides:
                sure = False
                break
            if min(sides) < 0 < max(sides):
                continue
            if (volume > 0) == (sides[0] > 0):
                count += 1 if sides[0] > 0 else -1
        if sure:
            return count
    raise RefusedError("no ray decides whether a point is inside")


def shells(facets: list[Triangle]) -> list[Vector]:
    """Returns a point of each connected part of a surface."""
    leads: dict[Vector, Vector] = {}

    def root(v: Vector) -> Vector:
        while leads.setdefault(v, v) != v:
            # Path halving keeps the paths short.
            leads[v] = leads[leads[v]]
            v = leads[v]
        return v

    for a, b, c in facets:
        leads[root(b)] = root(a)
        leads[root(c)] = root(a)
    return [v for v in leads if root(v) == v]


def is_nested(surface: list[Triangle], around: list[Triangle]) -> bool:
    """Checks whether a shell of a surface is inside a closed surface that it does not meet."""
    return any(winds(v, around) > 0 for v in shells(surface)) if around else False


# Boxes and facets
# ----------------


def box_of(points: Sequence[Triple[Number]]) -> Bounds[Number]:
    """Returns the box of points."""
    xs, ys, zs = ([p[k] for p in points] for k in range(3))
    return (min(xs), min(ys), min(zs)), (max(xs), max(ys), max(zs))


def box_corners(bounds: Bounds[Fraction]) -> list[Vector]:
    return [(x[0], y[1], z[2]) for x, y, z in product(bounds, repeat=3)]


def box_gap(p: Bounds[Number], q: Bounds[Number]) -> Number:
    """Returns the squared distance of two boxes."""
    x, y, z = (max(q[0][k] - p[1][k], p[0][k] - q[1][k]) for k in range(3))
    # A negative value is an overlap along the axis.
    x, y, z = max(x, x - x), max(y, y - y), max(z, z - z)
    return x * x + y * y + z * z


@dataclass
class Box:
    """A box of facets with integer coordinates: a single facet, or two boxes."""

    bounds: Bounds[int]
    facet: int | None
    parts: tuple[Box, ...] = ()

    def extent(self) -> int:
        return max(minus(self.bounds[1], self.bounds[0]))


def box_tree(triangles: Sequence[Corners]) -> Box:
    """Builds a tree of boxes, halved along the longest side."""

    def build(all_of: list[Box]) -> Box:
        if len(all_of) == 1:
            return all_of[0]
        low, high = bounds = box_of([v for b in all_of for v in b.bounds])
        axis = max(range(3), key=lambda k: high[k] - low[k])
        all_of.sort(key=lambda b: b.bounds[0][axis] + b.bounds[1][axis])
        half = len(all_of) // 2
        return Box(bounds, None, (build(all_of[:half]), build(all_of[half:])))

    return build([Box(box_of(t), k) for k, t in enumerate(triangles)])


def near_facets(
    trees: tuple[Box, Box], is_far: Callable[[Bounds[int], Bounds[int]], bool]
) -> Iterator[tuple[int, int] | None]:
    """Visits pairs of boxes of two trees, and yields each pair of facets that remains.

    It skips pairs of boxes with ``is_far``, and yields None for each other pair of boxes, so
    that callers can count.
    """
    stack = [trees]
    while stack:
        a, b = stack.pop()
        yield None
        if is_far(a.bounds, b.bounds):
            continue
        if a.facet is None and (b.facet is not None or a.extent() >= b.extent()):
            stack += [(part, b) for part in a.parts]
        elif b.facet is None:
            stack += [(a, part) for part in b.parts]
        elif a.facet is not None:
            yield a.facet, b.facet


def in_units(points: Sequence[Sequence[Vector]]) -> tuple[list[list[Whole]], int]:
    """Returns points with integer coordinates, and the number of units of length 1."""
    unit_of = math.lcm(*(x.denominator for each in points for v in each for x in v))

    def units(v: Vector) -> Whole:
        return int(v[0] * unit_of), int(v[1] * unit_of), int(v[2] * unit_of)

    return [[units(v) for v in each] for each in points], unit_of


def edges(corners: Sequence[Triple[Number]]) -> list[Triple[Number]]:
    """Returns the edges of a facet; a point has none."""
    count = len(corners)
    return [minus(corners[k], corners[k - 1]) for k in range(count) if count > 1]


def are_apart(
    f: Sequence[Triple[Number]],
    g: Sequence[Triple[Number]],
    square: Fraction | int,
    strictly: bool = False,
) -> bool:
    """Checks whether the hulls of one or three points each are the root of a square apart.

    They are if a plane leaves this distance. The nearest points are in corners, edges or facets, so
    one of these normals leaves the whole distance: the vector between two corners, the
    perpendicular from a corner to an edge or a facet, or a vector across two edges.
    """

    def normals() -> Iterator[Triple[Number]]:
        p_edges, q_edges = edges(f), edges(g)
        yield from (cross(sides[0], sides[1]) for sides in (p_edges, q_edges) if sides)
        for p, q in product(f, g):
            way = minus(q, p)
            yield way
            for side in p_edges + q_edges:
                yield minus(scaled(way, dot(side, side)), scaled(side, dot(way, side)))
        yield from (cross(u, v) for u, v in product(p_edges, q_edges))

    for n in normals():
        own, other = [dot(n, p) for p in f], [dot(n, q) for q in g]
        gap = max(min(other) - max(own), min(own) - max(other))
        least = square * dot(n, n)
        if gap > 0 and (gap * gap > least if strictly else gap * gap >= least):
            return True
    return False


def is_around(facets: list[Triangle], at: Vector, off: Fraction) -> bool:
    """Checks whether a closed surface surrounds a point at a distance."""

    apart = all(are_apart([at], triangle, off * off) for triangle in facets)
    return apart and winds(at, facets) > 0


# Bodies
# ------


def check_closed(points: list[Vector], facets: list[tuple[int, int, int]]) -> None:
    """Checks that a surface without the mark ``open`` is closed, so that it has an interior.

    The facets on both sides of each edge are equal in number, and one facet has an area.
    """
    first: dict[Vector, int] = {}
    # Corners with equal coordinates are one corner.
    names = {k: first.setdefault(points[k], k) for facet in facets for k in facet}
    sides: dict[tuple[int, int], int] = {}
    has_area = False
    for facet in facets:
        a, b, c = (names[k] for k in facet)
        for side in ((a, b), (b, c), (c, a)):
            sides[side] = sides.get(side, 0) + 1
            sides[side[::-1]] = sides.get(side[::-1], 0) - 1
        has_area = has_area or any(area(points, [a, b, c]))
    if any(sides.values()):
        raise RefusedError("a surface not marked as open has an edge with unbalanced facets")
    if not has_area:
        raise RefusedError("a surface not marked as open has no facet with an area")


def is_thin(points: list[Vector], faces: list[list[int]]) -> bool:
    """Checks whether a body is so thin that rounding can hide which faces it has."""
    room = 512 * _U * Fraction(math.sqrt(max(float(dot(v, v)) for v in points)))
    for normal in (area(points, face) for face in faces):
        heights = [dot(normal, v) for v in points]
        if (max(heights) - min(heights)) ** 2 <= room * room * dot(normal, normal):
            return True
    return False


def convex_data(points: list[Vector], content: Any) -> tuple[list[list[int]], Fraction, Fraction]:
    """Returns the faces, the hull error and the input excess of a convex body.

    All are checked against its vertices.
    """
    inputs = [whole(k, 2**32) for k in listed(content["input_indices"])]
    # After shrinking or growing, several vertices may come from one input vertex.
    if len(inputs) != len(points):
        raise RefusedError("the input indices are not one for each vertex")
    error = number(content["hull_error"])
    if not 0 <= error <= _RANGE[1]:
        raise RefusedError(f"a hull error of {float(error)!r} is negative, or larger than any body")
    stored = content["input_excess"]
    excess = number(0.0 if stored is None else stored)
    if not 0 <= excess <= error:
        raise RefusedError(
            f"an input excess of {float(excess)!r} is negative, or over the hull error"
        )
    faces = [[whole(k, len(points)) for k in listed(face)] for face in listed(content["faces"])]
    if any(len(set(face)) != len(face) or len(face) < 3 for face in faces):
        raise RefusedError("a face has fewer than three corners, or one of them twice")
    sides = {side: face for face in faces for side in zip(face, face[1:] + face[:1], strict=True)}
    closed = len(sides) == sum(map(len, faces)) and all((b, a) in sides for a, b in sides)
    if not closed or (faces and len({a for a, _ in sides}) != len(points)):
        raise RefusedError("the faces do not close up around all vertices")
    if len(points) - len(sides) // 2 + len(faces) != 2 and len(points) > 2:
        raise RefusedError("the faces are not those of one convex body")
    room = error + _PLANE * Fraction(math.sqrt(max(float(dot(v, v)) for v in points)))
    for face in faces:
        normal = area(points, face)
        if not any(normal):
            raise RefusedError("a face has no area")
        square = dot(normal, normal)
        around = [v for a, b in zip(face, face[1:] + face[:1], strict=True) for v in sides[b, a]]
        for k in (*face, *around):
            above = dot(normal, minus(points[k], points[face[0]]))
            is_off = (above > 0 or k in face) and above * above > room * room * square
            if is_off and not is_thin(points, faces):
                raise RefusedError(f"vertex {k} is not where the faces around it are")
    return faces, error, excess


@dataclass(frozen=True)
class Shape:
    """A body in its own frame: the hull of its points, or facets; swept by a ball of the radius."""

    points: list[Vector]
    #: The facets of a solid, by their corners.
    facets: list[Facet] = field(default_factory=list)
    #: For each facet whether it belongs to an open surface.
    is_open: list[bool] = field(default_factory=list)
    #: For each facet the number of its piece.
    piece: list[int] = field(default_factory=list)
    #: The faces of a convex body; no claim depends on them.
    faces: list[list[int]] = field(default_factory=list)
    #: Upper bound of the distance of the input of a convex body beyond its vertices.
    hull_error: Fraction = Fraction()
    #: The part of it by which input points lie outside of the body.
    input_excess: Fraction = Fraction()
    radius: Fraction = Fraction()

    @classmethod
    def read(cls, shape: Any) -> Shape:
        kind, content = one_of(shape, "convex", "pieces", "rounded")
        if kind == "convex":
            names = "vertices faces input_indices hull_error"
            content = fields(content, names, "input_excess radius")
            points = [place(v) for v in listed(content["vertices"])]
            faces, error, excess = convex_data(points, content)
            found = cls(points, faces=faces, hull_error=error, input_excess=excess)
        else:
            if kind == "rounded":
                content = fields(content, "pieces radius")
            found = cls([])
            for piece in listed(content["pieces"] if kind == "rounded" else content):
                found.add_piece(piece)
        if not found.points or (kind != "convex" and not found.facets):
            raise NoProofError("a body has no points or no facets")
        stored = 0.0 if kind == "pieces" else content["radius"]
        # Only that of a convex body may be missing.
        radius = number(0.0 if stored is None and kind == "convex" else stored)
        if radius != 0 and not _RANGE[0] <= radius <= _RANGE[1]:
            raise RefusedError(f"a radius of {float(radius)!r} is not from 2^-200 to 2^200")
        return replace(found, radius=radius)

    def add_piece(self, piece: Any) -> None:
        """Adds the surface of a piece of a solid."""
        fields(piece, "vertices triangles", "open")
        is_open = truth(piece.get("open", False))
        base, begin = len(self.points), len(self.facets)
        number = self.piece[-1] + 1 if self.piece else 0
        self.points.extend(place(v) for v in listed(piece["vertices"]))
        for triangle in listed(piece["triangles"]):
            a, b, c = (base + whole(k, len(self.points) - base) for k in listed(triangle, 3))
            self.facets.append((a, b, c))
            self.is_open.append(is_open)
            self.piece.append(number)
        used = {k for facet in self.facets[begin:] for k in facet}
        if used != set(range(base, len(self.points))):
            raise RefusedError("a piece has a vertex that no facet uses")
        if not is_open:
            check_closed(self.points, self.facets[begin:])

    @property
    def is_convex(self) -> bool:
        """Checks whether the body is the hull of its points; other bodies have facets."""
        return not self.facets

    def closed(self) -> list[Facet]:
        """Returns the facets of closed surfaces, which have an interior."""
        sides = zip(self.facets, self.is_open, strict=True)
        return [facet for facet, is_open in sides if not is_open]

    def has_open_area(self) -> bool:
        """Checks whether an open surface has a facet with three corners.

        Parts of such a surface may be closed, which is not checked. Points and segments, the cores
        of spheres and capsules, have no interior.
        """
        sides = zip(self.facets, self.is_open, strict=True)
        return any(is_open and len(set(facet)) == 3 for facet, is_open in sides)

    def as_solid(self) -> Shape:
        """Returns a point or a segment, the core of a sphere or a capsule, with its only facet.

        Other bodies are returned unchanged, because the facets of a convex body have no numbers.
        """
        last = len(self.points) - 1
        if self.facets or last > 1:
            return self
        return replace(self, facets=[(0, last, last)], is_open=[True], piece=[0])


#: Limits of :func:`are_own_faces` in largest coordinates: maximum distance of vertices from the
#: plane of their face, and minimum distance beyond their neighbours. Within them the library
#: certainly accepts the faces of a body.
_OWN_PLANE, _OWN_CORNER = 96 * 2.0**-53, 1024 * 2.0**-53
#: Limit of the negative volume of a flat body by rounding, in cubes of the largest coordinate.
_OWN_VOLUME = 48 * 2.0**-53


def _unit_way(p: Sequence[float], q: Sequence[float]) -> list[float]:
    """Returns the unit vector from one point to another, rounded."""
    way = [b - a for a, b in zip(p, q, strict=True)]
    length = math.hypot(*way) or math.inf
    return [x / length for x in way]


def _rounded_area(corners: list[tuple[float, float, float]]) -> tuple[float, float, float]:
    """Returns twice the area vector of a polygon, rounded."""
    (x, y, z), total = corners[0], [0.0, 0.0, 0.0]
    for (a, b, c), (p, q, r) in pairwise(corners[1:]):
        a, b, c, p, q, r = a - x, b - y, c - z, p - x, q - y, r - z
        for k, part in enumerate((b * r - c * q, c * p - a * r, a * q - b * p)):
            total[k] += part
    return total[0], total[1], total[2]


def _along(normal: Sequence[float], p: Sequence[float], q: Sequence[float]) -> float:
    """Returns the height of ``q`` above ``p`` along a normal, rounded."""
    return sum(n * (b - a) for n, a, b in zip(normal, p, q, strict=True))


def _rounded_volume(at: list[tuple[float, float, float]], faces: list[list[int]]) -> float:
    """Returns the volume inside a closed surface, rounded."""
    x, y, z = (sum(axis) / len(at) for axis in zip(*at, strict=True))
    corners = ([at[k] for k in face] for face in faces)
    return sum(_along(_rounded_area(face), (x, y, z), face[0]) for face in corners) / 6


def are_own_faces(points: list[Vector], faces: list[list[int]]) -> bool:
    """Checks whether the faces of a body are clearly those of the hull of its vertices.

    Rounded numbers are used because no claim depends on the result: the library rejects other
    bodies.
    """
    at = [(float(x), float(y), float(z)) for x, y, z in points]
    most = max(abs(x) for v in at for x in v)
    if len(faces) < 2:
        return not faces and len(set(points)) == len(points)
    normals = []
    for face in faces:
        x, y, z = _rounded_area([at[k] for k in face])
        length = math.hypot(x, y, z)
        if length == 0:
            return False
        normals.append((x / length, y / length, z / length))
    sides = {
        side: k
        for k, face in enumerate(faces)
        for side in zip(face, face[1:] + face[:1], strict=True)
    }
    outward = [[0.0, 0.0, 0.0] for _ in at]
    for (a, b), k in sides.items():
        other = sides[b, a]
        heights = [_along(normals[k], at[a], at[v]) for v in (*faces[k], *faces[other])]
        if max(heights) > _OWN_PLANE * most or min(heights[: len(faces[k])]) < -_OWN_PLANE * most:
            return False
        # Beyond a face or, for a flat body, beyond both neighbours in its plane.
        way = normals[k] if len(faces) > 2 else _unit_way(at[b], at[a])
        outward[a] = [p + q for p, q in zip(outward[a], way, strict=True)]
    if len(faces) == 2:
        corners = faces[0] + faces[0][:2]
        turns = [
            _along(_rounded_area([at[a], at[b], at[c]]), (0.0, 0.0, 0.0), normals[0])
            for a, b, c in zip(corners, corners[1:], corners[2:], strict=False)
        ]
        if min(turns) <= 0:
            return False
        # The library rejects flat bodies with a negative volume beyond its rounding limit.
        if _rounded_volume(at, faces) < -_OWN_VOLUME * most**3:
            return False
    lengths = [math.hypot(*normal) for normal in outward]
    return all(
        _along(outward[a], at[b], at[a]) > _OWN_CORNER * most * max(lengths[a], 1e-6)
        for a, b in sides
    )


@dataclass(frozen=True)
class Body:
    """A shape at the pose ``R x + t``."""

    shape: Shape
    rows: Matrix
    offset: Vector

    @classmethod
    def placed(cls, shape: Shape, pose: Any) -> Body:
        pose = fields(pose, "matrix translation")
        entries = [number(x) for x in listed(pose["matrix"], 9)]
        columns = [x if abs(x) >= _RANGE[0] else Fraction() for x in entries]
        x, y, z = (tuple(columns[k::3]) for k in range(3))
        rows: Matrix = ((x[0], x[1], x[2]), (y[0], y[1], y[2]), (z[0], z[1], z[2]))
        for i, j in product(range(3), repeat=2):
            entry = sum((row[i] * row[j] for row in rows), Fraction())
            if abs(entry - (i == j)) > _TURN:
                raise NoProofError("a pose is not a rotation")
        if dot(rows[0], cross(rows[1], rows[2])) < 0:
            raise NoProofError("a pose is a reflection")
        return cls(shape, rows, place(pose["translation"]))

    @property
    def points(self) -> list[Vector]:
        return self.shape.points

    @property
    def facets(self) -> list[Facet]:
        return self.shape.facets

    @property
    def radius(self) -> Fraction:
        return self.shape.radius

    def with_points(self, points: list[Vector]) -> Body:
        """Returns other points at the same pose."""
        return replace(self, shape=Shape(points))

    def at(self, k: int) -> Vector:
        """Returns a point in the world."""
        v = self.points[k]
        x, y, z = (dot(row, v) for row in self.rows)
        return plus((x, y, z), self.offset)

    def as_solid(self) -> Body:
        return replace(self, shape=self.shape.as_solid())

    def facet(self, k: int) -> Triangle:
        a, b, c = self.facets[k]
        return self.at(a), self.at(b), self.at(c)

    def turn(self, v: Vector) -> Vector:
        """Rotates a vector of the body frame to the world."""
        x, y, z = (dot(row, v) for row in self.rows)
        return x, y, z

    def skew(self) -> Fraction:
        """Returns a bound of the deviation of the axis products from those of a rotation."""
        products = (
            abs(dot(self.rows[i], self.rows[j]) - (i == j)) for i, j in product(range(3), repeat=2)
        )
        return max(products) + _TINY

    def heights(self, normal: Vector) -> Iterator[Fraction]:
        """Yields the heights of all points along a normal of the world."""
        columns = [
            sum((normal[r] * self.rows[r][c] for r in range(3)), Fraction()) for c in range(3)
        ]
        local = (columns[0], columns[1], columns[2])
        base = dot(normal, self.offset)
        for v in self.points:
            yield dot(local, v) + base

    def reach(self) -> float:
        """Returns the largest distance of a point from the origin of the frame, rounded."""
        return math.sqrt(max(float(dot(v, v)) for v in self.points))


def radii(moving: Body, fixed: Body) -> Fraction:
    """Returns the sum of the radii of both bodies."""
    return moving.radius + fixed.radius


def size(moving: Body, fixed: Body) -> Fraction:
    """Returns an upper bound of the distance of any two points, rounded."""
    between = minus(fixed.offset, moving.offset)
    reach = moving.reach() + fixed.reach() + math.sqrt(float(dot(between, between)))
    return max(Fraction(reach), _RANGE[0])


def vertex_pairs(pairs: Any, moving: int, fixed: int) -> list[tuple[int, int]]:
    """Returns the indices of pairs of vertices, below the numbers of vertices of both bodies."""
    named = [fields(pair, "moving fixed") for pair in listed(pairs)]
    return [(whole(pair["moving"], moving), whole(pair["fixed"], fixed)) for pair in named]


def ends_of(moving: Body, fixed: Body, pairs: Any) -> list[tuple[Vector, Vector]]:
    """Returns the points of pairs of vertices."""
    named = vertex_pairs(pairs, len(moving.points), len(fixed.points))
    return [(moving.at(i), fixed.at(j)) for i, j in named]


# Two convex bodies along a direction
# -----------------------------------


def across(d: Vector, normal: Vector) -> Vector:
    """Returns the part of a normal across the direction, scaled by ``d.d``."""
    return minus(scaled(normal, dot(d, d)), scaled(d, dot(normal, d)))


def are_shadows_apart(moving: Body, fixed: Body, d: Vector, normal: Vector, by: Fraction) -> bool:
    """Checks whether the part of a normal across the direction proves a distance of the shadows.

    A negative length is an upper bound of their overlap.
    """
    unit(normal)
    if dot(normal, d) ** 2 > _UNIT_VECTOR**2 * dot(d, d):
        raise RefusedError("the normal is not across the direction")
    level = across(d, normal)
    gap, square = min(fixed.heights(level)) - max(moving.heights(level)), dot(level, level)
    if by > 0:
        return above(gap, by * by * square)
    return gap >= 0 or gap * gap <= by * by * square


def shadows_apart(moving: Body, fixed: Body, d: Vector, normal: Vector) -> float:
    """Returns the rounded distance of the shadows along the part of a normal across ``d``."""
    level = across(d, normal)
    gap = min(fixed.heights(level)) - max(moving.heights(level))
    return float(gap) / math.sqrt(float(dot(level, level)))


def never_near(min_gap: Fraction) -> str:
    """Returns the statement that a plane between the bodies proves."""
    return f"are never as near as {float(min_gap)!r}" if min_gap else "never meet"


def stated(d: Vector, proof: Any, noise: Fraction, min_gap: Fraction, excess: Fraction) -> None:
    """Checks that the stated rounding of a certificate is within limits; it proves nothing.

    ``excess`` bounds how far input points of both bodies lie outside of them.
    """
    normal, rounding = vector(proof["normal"]), number(proof["rounding"])
    sideways = cross(normal, d)
    share = root_above(dot(sideways, sideways) / dot(d, d))
    most, across = _MOST_STATED
    slight = 2 * min_gap if min_gap <= _SLIGHT * noise else Fraction()
    limit = (most + across * share) * noise + slight + (2 + 6 * share) * excess
    if not 0 <= rounding * dot(normal, d) <= limit:
        raise RefusedError(f"rounding does not explain {float(rounding)!r}")


def contact(
    moving: Body,
    fixed: Body,
    d: Vector,
    proof: Any,
    report: Report,
    which: str,
    min_gap: Fraction = _NO_GAP,
) -> None:
    """Checks both bounds of a certificate between convex bodies.

    Rounded bodies are as near as ``min_gap`` where the hulls of their points are as near as the sum
    of ``min_gap`` and both radii.
    """
    proof = fields(proof, "normal lower pairs weights upper rounding")
    normal = vector(proof["normal"])
    unit(normal)
    along = dot(normal, d)
    if along <= 0:
        raise RefusedError(f"{which}: the normal does not point along the direction")
    lower = number(proof["lower"])
    gap = min(fixed.heights(normal)) - max(moving.heights(normal))
    body_gap, min_gap = min_gap, min_gap + radii(moving, fixed)
    if not above(gap - lower * along, min_gap * min_gap * dot(normal, normal)):
        proven = float((gap - min_gap) / along)
        raise RefusedError(f"{which}: the plane proves {proven!r}, not {float(lower)!r}")
    meet = f"are nearer than {float(body_gap)!r}" if body_gap else "meet"
    report.holds.append(f"{which}: the bodies {meet} at no translation below {float(lower)!r}")

    noise = _NOISE * (size(moving, fixed) + min_gap)
    # Poses stretch the excess by at most four deviations from a rotation.
    excess = (moving.shape.input_excess + fixed.shape.input_excess) * (1 + 4 * _TURN)
    stated(d, proof, noise, min_gap, excess)
    weights = listed(proof["weights"], 3)
    ends = ends_of(moving, fixed, listed(proof["pairs"], 3))
    corners = [minus(q, p) for p, q in ends]
    point = mean(corners, weights)
    estimate = dot(point, d) / dot(d, d)
    off = minus(point, scaled(d, estimate))
    miss = dot(off, off)
    if proof["upper"] is None:
        if not min_gap and miss > (_MISS_WIDENED * noise + Fraction(4, 3) * excess) ** 2:
            raise RefusedError(f"{which}: the witness points miss each other")
        report.unchecked.append(f"{which}: no upper bound is claimed")
        return
    upper = number(proof["upper"])
    if upper < lower:
        raise RefusedError(f"{which}: the bounds are in the wrong order")
    between = minus(point, scaled(d, upper))
    if min_gap and above(min_gap, dot(between, between)):
        meet = "are as near" if body_gap else "do meet"
        report.holds.append(f"{which}: the bodies {meet} at one of at most {float(upper)!r}")
        return
    if min_gap > _SLIGHT * noise:
        raise RefusedError(f"{which}: the witness points are not as near as {float(min_gap)!r}")
    # For a slight gap the proof may only show that the bodies meet.
    if miss > (_MISS * noise) ** 2:
        raise RefusedError(f"{which}: the witness points miss each other")
    if upper < estimate + _RAISE * noise / along:
        raise RefusedError(f"{which}: the pairs do not prove an upper bound of {float(upper)!r}")
    met = line_range(corners, d)
    if met is not None and met[0] <= upper:
        report.holds.append(f"{which}: the bodies do meet at one of at most {float(upper)!r}")
    else:
        report.holds.append(
            f"{which}: the bodies meet at one of at most {float(upper)!r}, as far as rounding can "
            f"tell (the witness points come within {math.sqrt(float(miss)):.1e})"
        )


def slide(
    moving: Body, fixed: Body, d: Vector, claim: Any, report: Report, min_gap: Fraction = _NO_GAP
) -> None:
    """Checks the overlap of the shadows, including the gap, along the direction."""
    claim = fields(claim, "normal overlap")
    normal, overlap = vector(claim["normal"]), number(claim["overlap"])
    core_gap = min_gap + radii(moving, fixed)
    if not are_shadows_apart(moving, fixed, d, normal, core_gap - overlap):
        proven = float(core_gap) - shadows_apart(moving, fixed, d, normal)
        raise RefusedError(f"the bodies overlap by {proven!r} there, not {float(overlap)!r}")
    report.holds.append(
        "the bodies slide along each other: seen along the direction they overlap by at most "
        f"{float(overlap)!r}" + (f", with the gap of {float(min_gap)!r}" if min_gap else "")
    )


def separation(
    moving: Body, fixed: Body, d: Vector, proof: Any, report: Report, min_gap: Fraction = _NO_GAP
) -> None:
    """Checks a separating plane between convex bodies."""
    proof = fields(proof, "normal margin")
    normal, margin = vector(proof["normal"]), number(proof["margin"])
    swept = radii(moving, fixed)
    if margin <= min_gap or not are_shadows_apart(moving, fixed, d, normal, margin + swept):
        proven = shadows_apart(moving, fixed, d, normal) - float(swept)
        raise RefusedError(f"the plane proves a margin of {proven!r}, not {float(margin)!r}")
    report.holds.append(
        f"the bodies {never_near(min_gap)}: a gap of {float(margin)!r} is between them"
    )


def contacts(
    moving: Body, fixed: Body, d: Vector, claim: Any, report: Report, min_gap: Fraction
) -> None:
    """Checks both ends of the range of translations at which two convex bodies meet."""
    claim = fields(claim, "", "slide first last")
    claim = {name: part for name, part in claim.items() if part is not None}
    if not {"first", "last"} & set(claim):
        raise NoProofError("no contact is claimed")
    if "slide" in claim:
        slide(moving, fixed, d, claim["slide"], report, min_gap)
    if "first" in claim:
        contact(moving, fixed, d, claim["first"], report, "along the direction", min_gap)
    if "last" in claim:
        back = negative(d)
        contact(moving, fixed, back, claim["last"], report, "against the direction", min_gap)
    report.unchecked.append("the stated rounding, which proves nothing")


# Two solids along a direction
# ----------------------------


def refuses(start_overlap: Any) -> bool:
    """Checks whether an overlap at the start stops the bodies, instead of being ignored."""
    if start_overlap not in ("refuse", "ignore"):
        raise NoProofError(f"start_overlap is {start_overlap!r}, not refuse or ignore")
    return bool(start_overlap == "refuse")


def check_letters(cover: Any, letters: str = "mfapnxdos") -> None:
    """Checks the form of a cover of pairs of facets."""
    if not isinstance(cover, str) or set(cover) - set(letters):
        raise NoProofError("a cover is not a text of letters")


def overlap_of(value: Any, counts: tuple[int, int], *others: str) -> str:
    """Checks the form of an overlap of two solids, and returns its kind.

    ``counts`` has their numbers of facets, and ``others`` the kinds that are not overlaps.
    """
    kind, where = one_of(value, *others, "facets", "moving_inside", "fixed_inside")
    if kind == "apart":
        check_letters(where)
    elif kind == "facets":
        for k, count in zip(listed(where, 2), counts, strict=True):
            whole(k, count)
    else:
        whole(where, counts[kind == "fixed_inside"])
    return kind


def translation_of(stop: Any) -> tuple[Fraction | None, Fraction | None]:
    """Returns the bounds of the translation at which two facets meet; None stands for no bound."""
    ends = fields(stop["translation"], "value lower upper")
    value = number(ends["value"])
    lower, upper = (None if ends[k] is None else number(ends[k]) for k in ("lower", "upper"))
    if (lower is not None and lower > value) or (upper is not None and upper < value):
        raise RefusedError("the translation is not between its bounds")
    return lower, upper


def stopping_facets(
    moving: Body,
    fixed: Body,
    d: Vector,
    stop: Any,
    tolerance: Fraction,
    core_gap: Fraction,
    report: Report,
) -> None:
    """Checks the translation at which the two nominal stopping facets meet.

    With a gap they meet where they are as near as the gap. Their distance is a convex function of
    the translation, so they do not meet before the lower bound if they are at least the gap apart
    there and at most the gap at a greater upper bound. Equal bounds may be those of the exit.
    """
    named = listed(stop["facets"], 2)
    f, g = (whole(k, len(body.facets)) for k, body in zip(named, (moving, fixed), strict=True))
    lower, upper = translation_of(stop)
    names = f"facet {f} of the moving body and {g} of the fixed one"
    if core_gap:
        ends = [] if lower is None or upper is None else [lower, upper]
        swept = [[plus(v, scaled(d, t)) for v in moving.facet(f)] for t in ends]
        other, square = fixed.facet(g), core_gap * core_gap
        is_slight = core_gap <= _SLIGHT * _NOISE * (size(moving, fixed) + core_gap)
        is_before = bool(ends) and are_apart(swept[0], other, square)
        reaches_gap = is_before and not are_apart(swept[1], other, square, strictly=True)
        if reaches_gap and ends[0] < ends[1]:
            near = f"come as near as {float(core_gap)!r}"
            report.holds.append(f"{names} {near} within the bounds claimed")
            return
        if ends and not reaches_gap and not tolerance and not is_slight:
            raise RefusedError(f"{names} are not {float(core_gap)!r} apart within the bounds")
        report.unchecked.append(f"where {names} are {float(core_gap)!r} apart")
        return
    corners = [minus(q, p) for p in moving.facet(f) for q in fixed.facet(g)]
    met = line_range(corners, d)
    if met is None:
        if tolerance == 0:
            raise RefusedError(f"{names} never meet")
        report.unchecked.append(f"{names} pass each other as they are")
        return
    at = float(met[0])
    if lower is not None and met[0] < lower:
        raise RefusedError(f"{names} meet at {at!r}, before {float(lower)!r}")
    if upper is not None and met[0] > upper:
        if tolerance == 0:
            raise RefusedError(f"{names} meet at {at!r}, after {float(upper)!r}")
        report.unchecked.append(f"the upper bound {float(upper)!r} is one of the shrunk bodies")
        return
    report.holds.append(f"{names} first meet at {at!r}, within the bounds claimed")


def clearance(
    moving: Body, fixed: Body, d: Vector, claim: Any, report: Report, min_gap: Fraction = _NO_GAP
) -> None:
    """Checks the claims of a clearance of solids that do not depend on their trees."""
    claim = fields(claim, "start_overlap certificate", "stop separation")
    certificate = fields(claim["certificate"], "tolerance start lower cover", "stop")
    refuses(claim["start_overlap"])
    counts = (len(moving.facets), len(fixed.facets))
    if certificate["start"] != "assumed":
        overlap_of(certificate["start"], counts, "apart")
    check_letters(certificate["cover"])
    if certificate["stop"] is not None:
        first = fields(certificate["stop"], "distance triangles")
        number(first["distance"])
        for k, count in zip(listed(first["triangles"], 2), counts, strict=True):
            whole(k, count)
    tolerance = number(certificate["tolerance"])
    # The lower bound is null if nothing stops the body.
    if tolerance < 0 or (certificate["lower"] is not None and number(certificate["lower"]) < 0):
        raise RefusedError("a tolerance, or a bound, is negative")
    plane, stop, swept = claim["separation"], claim["stop"], radii(moving, fixed)
    if plane is not None:
        plane = fields(plane, "normal margin")
        normal, margin = vector(plane["normal"]), number(plane["margin"])
        is_apart = are_shadows_apart(moving, fixed, d, normal, margin + swept)
        proven = shadows_apart(moving, fixed, d, normal) - float(swept)
        if margin <= min_gap or (tolerance == 0 and not is_apart):
            raise RefusedError(f"the plane proves a margin of {proven!r}, not {float(margin)!r}")
        # A gap of the nominal bodies, if the shrunk bodies have a larger margin.
        gap = margin if is_apart else Fraction(proven) * (1 - 8 * _U)
        if gap > min_gap and are_shadows_apart(moving, fixed, d, normal, gap + swept):
            report.holds.append(
                f"the bodies {never_near(min_gap)}: a gap of {float(gap)!r} is between them"
            )
        if not is_apart:
            report.unchecked.append(f"the margin of the shrunk bodies, {float(margin)!r}")
    if (stop is None) != (certificate["stop"] is None):
        raise RefusedError("the certificate and the claim do not agree about what stops the body")
    stop = None if stop is None else fields(stop, "facets translation")
    if stop is not None:
        stopping_facets(moving, fixed, d, stop, tolerance, min_gap + swept, report)
    if tolerance:
        report.unchecked.append(
            f"what shrinking by {float(tolerance / 2)!r} makes of the bodies, which may be thinner"
        )
    report.partly = True
    overlap = "are nearer than the gap" if min_gap else "overlap"
    report.unchecked.append(f"whether the bodies {overlap} where they are")
    come_near = "come as near as the gap" if min_gap else "meet"
    report.unchecked.append(
        "that nothing stops the moving body before" if stop else f"that no two facets {come_near}"
    )


# Distances and depths
# --------------------

#: The fields of a claim that two points are near each other.
_NEAR = "pairs weights distance"


def are_points_near(
    ends: Sequence[tuple[Vector, Vector]], shares: Sequence[Any], length: Fraction
) -> bool:
    """Checks whether the weighted means of pairs of points are at most a length apart."""
    p, q = (mean([end[k] for end in ends], shares) for k in (0, 1))
    return is_within(p, q, length)


def are_cores_near(near: Any, ends: Sequence[tuple[Vector, Vector]], length: Fraction) -> bool:
    """Checks whether the pairs of a claim prove that hulls are at most a length apart.

    Either the weighted means are, or the differences enclose the origin if the claim is 0.
    """
    shares = [number(weight) for weight in listed(near["weights"], 4)]
    enclosed = number(near["distance"]) == 0 and encloses([minus(q, p) for p, q in ends])
    return (enclosed and length >= 0) or are_points_near(ends, shares, length)


def distance(moving: Body, fixed: Body, claim: Any, report: Report) -> None:
    """Checks the bounds of the distance of convex bodies."""
    claim = fields(claim, "", "gap near")
    gap, near, swept = claim["gap"], claim["near"], radii(moving, fixed)
    if gap is None and near is None:
        raise NoProofError("no distance is claimed")
    if gap is not None:
        gap = fields(gap, "normal gap")
        normal, lower = vector(gap["normal"]), number(gap["gap"])
        unit(normal)
        proven = min(fixed.heights(normal)) - max(moving.heights(normal))
        between = lower + swept
        if lower < 0 or not above(proven, between * between * dot(normal, normal)):
            raise RefusedError(f"the plane proves a gap of {float(proven)!r}, not {float(lower)!r}")
        report.holds.append(f"the bodies are at least {float(lower)!r} apart")
    if near is None:
        return
    near = fields(near, _NEAR)
    upper, ends = number(near["distance"]), ends_of(moving, fixed, listed(near["pairs"], 4))
    is_proven = are_cores_near(near, ends, upper + swept)
    if upper == 0 and not swept:
        is_proven = encloses([minus(q, p) for p, q in ends])
    if upper < 0 or not is_proven:
        raise RefusedError(f"the pairs do not prove a distance of at most {float(upper)!r}")
    apart = f"are at most {float(upper)!r} apart" if upper else "have a point in common"
    report.holds.append(f"the bodies {apart}")


def enclosure(corners: list[Vector], surface: Any, lower: Fraction) -> None:
    """Checks a closed surface around the origin whose triangles are not nearer than a length."""
    triangles = [tuple(whole(k, len(corners)) for k in t) for t in listed(surface["triangles"])]
    if any(len(t) != 3 for t in triangles) or len(surface["normals"]) != len(triangles):
        raise NoProofError("a triangle does not have three corners and a normal")
    sides = [(t[k], t[k - 2]) for t in triangles for k in range(3)]
    if len(set(sides)) < len(sides) or any((b, a) not in set(sides) for a, b in sides):
        raise RefusedError("the surface is not closed")
    for t, each in zip(triangles, listed(surface["normals"]), strict=True):
        normal = vector(each)
        least = min(dot(normal, corners[k]) for k in t)
        if least <= 0 or lower * lower * dot(normal, normal) > least * least:
            raise RefusedError(f"a triangle is nearer to the origin than {float(lower)!r}")
    if winds(_ZERO, [(corners[a], corners[b], corners[c]) for a, b, c in triangles]) <= 0:
        raise RefusedError("the surface does not wind around the origin")


def check_enclosure(moving: Body, fixed: Body, surface: Any, lower: Fraction) -> None:
    """Checks that the differences of two hulls surround the origin at a distance."""
    corners = [minus(q, p) for p, q in ends_of(moving, fixed, surface["pairs"])]
    triangles = [listed(t, 3) for t in listed(surface["triangles"])]
    for normal in listed(surface["normals"], len(triangles)):
        unit(vector(normal), "the normal of a triangle")
    enclosure(corners, surface, lower)
    for a, b, c in triangles:
        if dot(corners[a], cross(corners[b], corners[c])) < 0:
            raise RefusedError("a triangle is turned away, as seen from the origin")


def depth(moving: Body, fixed: Body, claim: Any, report: Report) -> None:
    """Checks the bounds of the shortest translation that separates convex bodies."""
    # The step counts are optional and are not read.
    claim = fields(claim, "lower upper direction enclosure", "near steps")
    d, lower, upper = vector(claim["direction"]), number(claim["lower"]), number(claim["upper"])
    unit(d)
    swept = radii(moving, fixed)
    reach = -(min(moving.heights(d)) - max(fixed.heights(d)))
    # The translation must be at least reach / |d|, of either sign, plus both radii.
    square, rest = reach * reach / dot(d, d), upper - swept
    if not above(rest, square) if reach > 0 else rest < 0 and rest * rest > square:
        raise RefusedError(
            f"a translation by {float(reach + swept)!r} separates the bodies, not {float(upper)!r}"
        )
    if upper < 0 or not 0 <= lower <= upper:
        raise RefusedError("the bounds are in the wrong order")
    report.holds.append(
        f"a translation by {float(upper)!r} along the direction separates the bodies"
    )
    surface = fields(claim["enclosure"], "pairs triangles normals")
    near = claim["near"]
    if lower > 0 and near is not None and not any(listed(part) for part in surface.values()):
        ends = ends_of(moving, fixed, listed(fields(near, _NEAR)["pairs"], 4))
        if not swept or not are_cores_near(near, ends, swept - lower):
            raise RefusedError(f"the points do not prove a depth of {float(lower)!r}")
        report.holds.append(f"no translation below {float(lower)!r} separates them")
    elif lower > 0 or any(listed(part) for part in surface.values()):
        check_enclosure(moving, fixed, surface, max(lower - swept, _NO_GAP))
        report.holds.append(f"no translation below {float(lower)!r} separates them")


# Distances of solids
# -------------------


def check_solid_near(near: Any) -> None:
    """Checks the form of a claim about the nearest points of two solids."""
    kind, claim = one_of(near, "points", "meeting")
    if kind == "meeting":
        overlap_of(claim, (2**32, 2**32))
        return
    fields(claim, "triangles weights distance")
    for k in listed(claim["triangles"], 2):
        whole(k, 2**32)
    for weights in listed(claim["weights"], 2):
        for weight in listed(weights, 3):
            number(weight)
    number(claim["distance"])


def surface_of(body: Body, facets: list[Facet]) -> list[Triangle]:
    """Returns facets of a body in the world."""
    placed = [body.at(k) for k in range(len(body.points))]
    return [(placed[a], placed[b], placed[c]) for a, b, c in facets]


def do_facets_meet(f: Triangle, g: Triangle) -> bool:
    """Checks whether two facets with an area have a point in common.

    Otherwise a normal of a facet, a direction across two edges or a normal of an edge in the plane
    of its facet separates them.
    """
    edges = [[minus(t[k - 2], t[k]) for k in range(3)] for t in (f, g)]
    normals = [cross(own[0], own[1]) for own in edges]
    if not all(any(normal) for normal in normals):
        return False
    across = [cross(a, b) for a, b in product(*edges)]
    in_plane = [cross(n, e) for n, own in zip(normals, edges, strict=True) for e in own]
    heights = ([[dot(way, v) for v in t] for t in (f, g)] for way in (*normals, *across, *in_plane))
    return all(min(p) <= max(q) and min(q) <= max(p) for p, q in heights)


def has_common_point(moving: Body, fixed: Body, meeting: Any) -> bool:
    """Checks whether two facets meet, or a corner of a facet is inside the other body.

    The claims of the library may be about rounded facets. Such a claim need not hold exactly.
    """
    kind, where = next(iter(meeting.items()))
    named = zip((moving, fixed), where if kind == "facets" else [where] * 2, strict=True)
    facets = [body.facet(k) if k < len(body.facets) else None for body, k in named]
    if kind == "facets":
        f, g = facets
        return f is not None and g is not None and do_facets_meet(f, g)
    inner = facets[0 if kind == "moving_inside" else 1]
    outer = fixed if kind == "moving_inside" else moving
    with suppress(RefusedError):
        return inner is not None and winds(inner[0], surface_of(outer, outer.shape.closed())) > 0
    return False


def solid_near(moving: Body, fixed: Body, near: Any, report: Report) -> None:
    """Checks two points of solids, by the weights of the corners of two facets."""
    check_solid_near(near)
    if "points" not in near:
        if has_common_point(moving, fixed, near["meeting"]):
            report.holds.append("the bodies have a point in common")
        else:
            report.partly = True
            report.unchecked.append("that the bodies have a point in common")
        return
    near = near["points"]
    named = zip((moving, fixed), listed(near["triangles"], 2), strict=True)
    corners = [body.facet(whole(k, len(body.facets))) for body, k in named]
    p, q = (mean(c, w) for c, w in zip(corners, listed(near["weights"], 2), strict=True))
    upper = number(near["distance"])
    if upper < 0 or not is_within(p, q, upper + radii(moving, fixed)):
        raise RefusedError(f"the points do not prove a distance of at most {float(upper)!r}")
    report.holds.append(f"the bodies are at most {float(upper)!r} apart")


def are_surfaces_apart(p: list[Triangle], q: list[Triangle], length: Fraction) -> bool | None:
    """Checks whether no two facets of two surfaces are nearer than a length, or meet.

    Returns None if this takes too many steps.
    """
    corners, unit_of = in_units([[v for t in facets for v in t] for facets in (p, q)])
    f, g = ([(v[k], v[k + 1], v[k + 2]) for k in range(0, len(v), 3)] for v in corners)
    square, visited = (length * unit_of) ** 2, 0
    for pair in near_facets((box_tree(f), box_tree(g)), lambda p, q: 0 < box_gap(p, q) >= square):
        visited += pair is None
        if visited > MAX_PAIRS:
            return None
        if pair is not None and not are_apart(f[pair[0]], g[pair[1]], square):
            return False
    return True


def are_solids_apart(moving: Body, fixed: Body, length: Fraction) -> bool | None:
    """Checks whether two solids without their radii are at least a length apart.

    No two facets are nearer, and no shell is inside the other solid. Returns None if this takes too
    many steps, or if open surfaces may have closed parts.
    """
    bodies = (moving, fixed)
    surfaces = [surface_of(body, body.facets) for body in bodies]
    apart = are_surfaces_apart(surfaces[0], surfaces[1], length)
    if not apart:
        return apart
    for own, other in ((0, 1), (1, 0)):
        if is_nested(surfaces[own], surface_of(bodies[other], bodies[other].shape.closed())):
            return False
    return None if any(body.shape.has_open_area() for body in bodies) else True


def solid_gap(moving: Body, fixed: Body, claim: Any, report: Report) -> None:
    """Checks that no two points of solids are nearer than the lower bound of a distance.

    The cover of the claim is not used: a search of pairs of facets decides.
    """
    check_letters(claim["cover"], "mfpqwnxs")
    lower = number(claim["lower"])
    if lower < 0:
        raise RefusedError("a distance is not negative")
    report.has_cover = report.has_cover or bool(claim["cover"])
    if lower == 0:
        return
    if "points" not in claim["near"]:
        raise RefusedError("bodies with a point in common are not apart")
    found = are_solids_apart(moving, fixed, lower + radii(moving, fixed))
    apart = f"the bodies are at least {float(lower)!r} apart"
    if found is None:
        report.partly = True
        report.unchecked.append(f"that {apart}")
    elif found:
        report.holds.append(apart)
    else:
        raise RefusedError(f"the bodies are not proven to be {float(lower)!r} apart")


def solid_distance(moving: Body, fixed: Body, claim: Any, report: Report) -> None:
    """Checks the distance of solids."""
    solid_near(moving, fixed, fields(claim, "lower near cover")["near"], report)
    solid_gap(moving, fixed, claim, report)


# Depths of solids
# ----------------

#: Maximum number of pairs of cores in a proof.
MAX_CORES = 32


@dataclass(frozen=True)
class Core:
    """A box along the axes of the world, or a point, swept by a ball, inside a solid."""

    low: Vector
    high: Vector
    radius: Fraction

    @classmethod
    def read(cls, core: Any) -> Core:
        core = fields(core, "origin size radius cover")
        check_letters(core["cover"], "mfpqwnxs")
        low, size, radius = place(core["origin"]), place(core["size"]), number(core["radius"])
        if radius < 0 or (any(size) and min(size) <= 0):
            raise RefusedError("a core has a negative side or radius, or sides of which some are 0")
        return cls(low, plus(low, size), radius)

    def surface(self) -> list[Triangle]:
        """Returns the facets of the box, outwards, or the point as one facet."""
        if self.low == self.high:
            return [(self.low, self.low, self.low)]
        v = [(x[0], y[1], z[2]) for x, y, z in product((self.low, self.high), repeat=3)]
        sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        return [(v[a], v[i], v[j]) for a, b, c, d in sides for i, j in ((b, c), (c, d))]

    def is_inside(self, solid: Body) -> bool | None:
        """Checks whether the core is inside a solid; None if this takes too many steps."""
        box, closed = self.surface(), surface_of(solid, solid.shape.closed())
        apart = are_surfaces_apart(box, surface_of(solid, solid.facets), self.radius)
        if not apart:
            return apart
        if solid.shape.has_open_area():
            return None
        around = box if len(box) > 1 else []
        return bool(closed) and winds(self.low, closed) > 0 and not is_nested(closed, around)


def difference(moving: Core, fixed: Core) -> Bounds[Fraction]:
    """Returns the box of translations after which the boxes of two cores overlap."""
    return minus(fixed.low, moving.high), minus(fixed.high, moving.low)


def are_covered(boxes: list[Bounds[Fraction]], length: Fraction) -> bool:
    """Checks whether open boxes contain all points that are nearer to the origin than a length.

    The planes of all boxes divide space into boxes, rectangles, segments and points, and each of
    these is inside or outside of a box.
    """
    axes: list[list[tuple[Fraction, Fraction, Fraction]]] = []
    for k in range(3):
        ends = sorted({end[k] for bounds in boxes for end in bounds} | {-length, length})
        parts = [(end, end) for end in ends] + list(pairwise(ends))
        nearest = [(min(max(Fraction(), a), b), a, b) for a, b in parts]
        axes.append([(at * at, a, b) for at, a, b in nearest if abs(at) < length])

    def holds(k: int, among: list[Bounds[Fraction]], square: Fraction) -> bool:
        for at, a, b in axes[k]:
            if at >= square:
                continue
            inner = [
                (low, high)
                for low, high in among
                if (low[k] < a and b < high[k] if a == b else low[k] <= a and b <= high[k])
            ]
            # The other coordinates may be 0.
            if not inner or (k < 2 and not holds(k + 1, inner, square - at)):
                return False
        return True

    return holds(0, boxes, length * length)


def is_depth_of_cores(cores: list[tuple[Core, Core]], lower: Fraction, swept: Fraction) -> bool:
    """Checks whether no translation shorter than a length separates all pairs of swept cores.

    Either the origin is in the difference of one pair, a box swept by a ball, and has this distance
    from its surface, or the differences of all boxes cover the ball of this radius. ``swept`` is
    the sum of the radii of the solids.
    """
    if lower <= 0:
        return True
    differences = [difference(moving, fixed) for moving, fixed in cores]
    for (low, high), (moving, fixed) in zip(differences, cores, strict=True):
        between = min(*high, *negative(low))
        if between >= 0 and lower <= between + moving.radius + fixed.radius + swept:
            return True
    return lower > swept and are_covered(differences, lower - swept)


def shrinking_loss(body: Body) -> Fraction | None:
    """Returns the distance by which the hull of a convex solid moves at most, until it is inside.

    For each facet any normal will do, for example the rounded one: the facet is above the height of
    its lowest corner. No facet meets the region below all of these heights, and the hull, shrunk
    towards the mean of its vertices, is inside the region. Returns None if this takes too long.
    """
    points, shape = body.points, body.shape
    if any(shape.is_open):
        raise RefusedError("a body with an open surface is not convex")
    if len(points) * len(shape.facets) > MAX_PAIRS:
        return None
    rounded = [(float(x), float(y), float(z)) for x, y, z in points]
    placed, most = in_units([points])[0][0], Fraction()
    count, total = len(points), (0, 0, 0)
    for v in placed:
        total = plus(total, v)
    for facet in shape.facets:
        area = _rounded_area([rounded[k] for k in facet])
        n = in_units([[vector(list(area))]])[0][0][0]
        heights = [dot(n, v) for v in placed]
        height = min(heights[k] for k in facet)
        excess, below = max(heights) - height, height - Fraction(dot(n, total), count)
        if below <= 0:
            raise RefusedError("a solid with an enclosure is not convex")
        most = max(most, excess / (excess + below))
    world = [body.at(k) for k in range(count)]
    center = mean(world, [Fraction(1, count)] * count)
    if winds(center, surface_of(body, shape.facets)) <= 0:
        raise RefusedError("a solid with an enclosure does not contain the mean of its vertices")
    between = (minus(v, center) for v in world)
    return most * root_above(max(dot(v, v) for v in between)) if most else most


def lower_depth(moving: Body, fixed: Body, claim: Any, lower: Fraction) -> bool | None:
    """Checks whether no translation below a length separates two solids.

    Returns None if this takes too many steps.
    """
    cores, surface, swept = claim["cores"], claim["enclosure"], radii(moving, fixed)
    pairs = [listed(pair, 2) for pair in listed([] if cores is None else cores)]
    if pairs and surface is not None:
        raise RefusedError("a lower bound has two proofs")
    if len(pairs) > MAX_CORES:
        raise RefusedError(f"there are more than {MAX_CORES} pairs of cores")
    if pairs:
        read = [
            (Core.read(moving_core), Core.read(fixed_core)) for moving_core, fixed_core in pairs
        ]
        inside = [
            core.is_inside(body)
            for pair in read
            for core, body in zip(pair, (moving, fixed), strict=True)
        ]
        if False in inside:
            raise RefusedError("a core is not inside its solid")
        is_proven = lower >= 0 and is_depth_of_cores(read, lower, swept)
        return None if is_proven and None in inside else is_proven
    if surface is not None:
        surface = fields(surface, "pairs triangles normals")
        losses = [shrinking_loss(body) for body in (moving, fixed)]
        known = [loss for loss in losses if loss is not None]
        least = max(lower - swept, _NO_GAP) + sum(known, Fraction())
        check_enclosure(moving, fixed, surface, least)
        return None if None in losses else lower >= 0
    return lower == 0


def solid_depth(moving: Body, fixed: Body, claim: Any, report: Report) -> None:
    """Checks the bounds of the shortest translation that separates two solids."""
    claim = fields(claim, "lower upper translation apart", "cores enclosure")
    lower, upper = number(claim["lower"]), number(claim["upper"])
    moved = replace(moving, offset=place(claim["translation"]))
    if not is_within(moving.offset, moved.offset, upper) or lower > upper:
        raise RefusedError(f"the translation is longer than {float(upper)!r}, or the lower bound")
    if number(fields(claim["apart"], "lower near cover")["lower"]) <= 0:
        raise RefusedError("the bodies are not proven to be apart after the translation")
    after = Report()
    solid_distance(moved, fixed, claim["apart"], after)
    report.has_cover = True
    separated = f"a translation by {float(upper)!r} separates the bodies"
    (report.unchecked if after.partly else report.holds).append(separated)
    found = lower_depth(moving, fixed, claim, lower)
    if found is False:
        raise RefusedError(f"no depth of {float(lower)!r} is proven")
    if lower > 0:
        none = f"no translation below {float(lower)!r} separates them"
        (report.unchecked if found is None else report.holds).append(none)
    report.partly = report.partly or after.partly or found is None


# Common parts of solids
# ----------------------

#: A plane ``a x + b y + c z + d = 0``, and a point ``x, y, z`` over a positive ``w``.
Plane4: TypeAlias = tuple[int, int, int, int]
Point4: TypeAlias = tuple[int, int, int, int]
Ring: TypeAlias = list[Point4]
#: Maximum number of corners of all cells of a proof.
MAX_CORNERS = 8_000_000
#: Maximum number of cuts around a cell.
MAX_CUTS = 4096
#: Binary digits after the point in sums of volumes, in roots.
_VOLUME_DIGITS = 400


def lowest_terms(v: Sequence[int]) -> Point4:
    """Divides four integers by their common divisor, which keeps corners of many cuts short."""
    most = math.gcd(*v) or 1
    return v[0] // most, v[1] // most, v[2] // most, v[3] // most


def side_of(plane: Plane4, v: Point4) -> int:
    """Returns the height of a point above a plane, times a positive number."""
    return plane[0] * v[0] + plane[1] * v[1] + plane[2] * v[2] + plane[3] * v[3]


def cut_ring(ring: Ring, plane: Plane4) -> list[Ring | None]:
    """Returns the parts of a convex polygon behind a plane and in front of it, None for no part."""
    p, q, r, offset = plane
    sides = [p * x + q * y + r * z + offset * w for x, y, z, w in ring]
    low, high = min(sides), max(sides)
    if low >= 0 or high <= 0:
        return [ring if low < 0 else None, ring if high > 0 else None]
    parts: list[Ring] = [[], []]
    for k, (v, s) in enumerate(zip(ring, sides, strict=True)):
        if s <= 0:
            parts[0].append(v)
        if s >= 0:
            parts[1].append(v)
        w, t = ring[k + 1 - len(ring)], sides[k + 1 - len(ring)]
        if (s < 0 < t) or (t < 0 < s):
            between = [abs(t) * a + abs(s) * b for a, b in zip(v, w, strict=True)]
            for part in parts:
                part.append(lowest_terms(between))
    return [parts[0], parts[1]]


@dataclass
class Polytope:
    """A convex cell with an interior: its faces, and the parts of facets of both bodies in it."""

    faces: list[Ring]
    facets: tuple[list[Ring], list[Ring]]
    depth: int = 0
    #: Whether the cell is inside each body, if that is known. Parts of the cell inherit it.
    inside: tuple[bool | None, bool | None] = (None, None)

    def corners(self) -> int:
        return sum(map(len, self.faces)) + sum(len(ring) for part in self.facets for ring in part)

    def cut(self, plane: Plane4) -> tuple[Polytope, Polytope]:
        """Returns the parts behind a plane and in front of it."""
        faces: tuple[list[Ring], list[Ring]] = ([], [])
        for ring in self.faces:
            for part, kept in zip(cut_ring(ring, plane), faces, strict=True):
                if part is not None:
                    kept.append(part)
        if not faces[0] or not faces[1]:
            raise RefusedError("a cut of a common part does not divide its cell")
        for kept in faces:
            # The cut closes a part: it has the edges of the faces in the plane, in reverse.
            after: dict[Point4, Point4] = {}
            for ring in kept:
                flat = [side_of(plane, v) == 0 for v in ring]
                for k, v in enumerate(ring):
                    if flat[k - 1] and flat[k]:
                        after[v] = ring[k - 1]
            lid = [next(iter(after))]
            while after[lid[-1]] != lid[0]:
                lid.append(after[lid[-1]])
            if len(lid) < 3 or len(lid) != len(after):
                raise RefusedError("a cell of a common part does not close up")
            kept.append(lid)
        low: tuple[list[Ring], list[Ring]] = ([], [])
        high: tuple[list[Ring], list[Ring]] = ([], [])
        for body, rings in enumerate(self.facets):
            for ring in rings:
                behind, before = cut_ring(ring, plane)
                if behind is not None:
                    low[body].append(behind)
                if before is not None:
                    high[body].append(before)
        return (
            Polytope(faces[0], low, self.depth + 1, self.inside),
            Polytope(faces[1], high, self.depth + 1, self.inside),
        )

    def tetrahedra(self) -> Iterator[tuple[Point4, Point4, Point4, Point4]]:
        """Yields tetrahedra that fill the cell."""
        top = self.faces[0][0]
        for ring in self.faces:
            if top not in ring:
                for a, b in pairwise(ring[1:]):
                    yield top, ring[0], a, b

    def volume(self) -> Fraction:
        """Returns the volume in cubic units."""
        total = Fraction()
        for corners in self.tetrahedra():
            a, b, c, d = corners
            u, v, w = (
                (
                    p[0] * a[3] - a[0] * p[3],
                    p[1] * a[3] - a[1] * p[3],
                    p[2] * a[3] - a[2] * p[3],
                )
                for p in (b, c, d)
            )
            weights = b[3] * c[3] * d[3] * a[3] ** 3
            total += Fraction(abs(dot(u, cross(v, w))), 6 * weights)
        return total

    def inner_point(self) -> Point4:
        """Returns a point of the interior."""
        corners = next(self.tetrahedra())
        weight = math.lcm(*(v[3] for v in corners))
        x, y, z = (sum(v[k] * (weight // v[3]) for v in corners) for k in range(3))
        return lowest_terms((x, y, z, 4 * weight))


def crossings(at: Point4, way: Whole, facets: Iterable[Corners]) -> int | None:
    """Counts how often a ray leaves through facets, less how often it enters.

    Returns None if the ray may meet an edge.
    """
    count = 0
    for triangle in facets:
        a, b, c = (
            (
                v[0] * at[3] - at[0],
                v[1] * at[3] - at[1],
                v[2] * at[3] - at[2],
            )
            for v in triangle
        )
        sides = [dot(cross(u, v), way) for u, v in ((a, b), (b, c), (c, a))]
        if min(sides) < 0 < max(sides):
            continue
        volume = dot(cross(a, b), c)
        if volume == 0:
            # A ray in the plane of a facet with an area may meet an edge of the facet.
            normal = cross(minus(b, a), minus(c, a))
            if any(normal) and dot(normal, way) == 0:
                return None
        elif 0 in sides:
            return None
        elif (volume > 0) == (sides[0] > 0):
            count += 1 if sides[0] > 0 else -1
    return count


class Sight:
    """The facets of a surface as seen along a direction, in a binary tree of boxes."""

    def __init__(self, way: Whole, facets: list[Corners]) -> None:
        #: Two coordinates across the direction, and one along it.
        self.forms = ((way[1], -way[0], 0), (way[2], 0, -way[0]), way)
        seen = [(self.box(facet), facet) for facet in facets]
        self.root = self.node(seen)

    def box(self, facet: Corners) -> tuple[int, ...]:
        """Returns the highest coordinates of a facet, and the lowest ones across the direction."""
        heights = [[dot(form, v) for v in facet] for form in self.forms]
        return (*map(max, heights), min(heights[0]), min(heights[1]))

    def node(self, seen: list[tuple[tuple[int, ...], Corners]]) -> tuple[Any, ...]:
        """Returns a node: its box, and its facets or both parts."""
        highest = [max(box[k] for box, _ in seen) for k in range(3)]
        lowest = [min(box[k] for box, _ in seen) for k in (3, 4)]
        bounds = (*highest, *lowest)
        if len(seen) <= 4:
            return bounds, [facet for _, facet in seen], None
        k = 0 if highest[0] - lowest[0] > highest[1] - lowest[1] else 1
        seen.sort(key=lambda entry: entry[0][k] + entry[0][k + 3])
        half = len(seen) // 2
        return bounds, self.node(seen[:half]), self.node(seen[half:])

    def met(self, at: Point4) -> Iterator[Corners]:
        """Yields all facets that the ray from a point meets, and some others."""
        x, y, z = (dot(form, at[:3]) for form in self.forms)
        weight, stack = at[3], [self.root]
        while stack:
            (right, upper, ahead, left, lower), first, second = stack.pop()
            if not (
                left * weight <= x <= right * weight
                and lower * weight <= y <= upper * weight
                and z <= ahead * weight
            ):
                continue
            if second is None:
                yield from first
            else:
                stack += [first, second]


class Surface:
    """A surface, and its winding numbers around points."""

    def __init__(self, facets: list[Corners]) -> None:
        self.facets = facets
        self.sights: dict[Whole, Sight] = {}

    def winding(self, at: Point4) -> int:
        """Returns the winding number around a point that is not on the surface."""
        if not self.facets:
            return 0
        for k in range(1, 60):
            way = (3721, 61 * k, k * k)
            if way not in self.sights:
                self.sights[way] = Sight(way, self.facets)
            count = crossings(at, way, self.sights[way].met(at))
            if count is not None:
                return count
        raise RefusedError("no ray decides whether a point is inside")


def has_point(triangle: Corners, at: Point4) -> bool:
    """Checks whether a facet contains a point."""
    a, b, c = ((v[0] * at[3] - at[0], v[1] * at[3] - at[1], v[2] * at[3] - at[2]) for v in triangle)
    normal = cross(minus(b, a), minus(c, a))
    sides = [dot(cross(u, v), normal) for u, v in ((a, b), (b, c), (c, a))]
    return any(normal) and dot(normal, a) == 0 and min(sides) >= 0


def edges_of(facet: Facet) -> tuple[tuple[int, int], ...]:
    a, b, c = facet
    return (a, b), (b, c), (c, a)


def is_balanced(facets: list[Facet]) -> bool:
    """Checks whether each edge is passed as often in one direction as in the other."""
    passed = Counter(edge for facet in facets for edge in edges_of(facet))
    return all(passed[u, v] == passed[v, u] for u, v in passed)


def connected(
    facets: list[Facet], connects: Callable[[tuple[int, int]], bool]
) -> list[list[Facet]]:
    """Returns the parts of a surface that are connected across some edges."""
    leads = list(range(len(facets)))

    def root(k: int) -> int:
        while leads[k] != k:
            leads[k] = leads[leads[k]]
            k = leads[k]
        return k

    first: dict[tuple[int, int], int] = {}
    for k, facet in enumerate(facets):
        for u, v in filter(connects, edges_of(facet)):
            leads[root(k)] = root(first.setdefault((min(u, v), max(u, v)), k))
    parts: dict[int, list[Facet]] = {}
    for k, facet in enumerate(facets):
        parts.setdefault(root(k), []).append(facet)
    return list(parts.values())


def shells_of(facets: list[Facet]) -> list[list[Facet]]:
    """Returns the shells of a surface.

    Facets are connected at edges that two of them have. If this does not give closed shells, all
    facets of an edge are connected.
    """
    count = Counter(frozenset(edge) for facet in facets for edge in edges_of(facet))
    shells = connected(facets, lambda edge: count[frozenset(edge)] == 2)
    if all(is_balanced(shell) for shell in shells):
        return shells
    return connected(facets, lambda _: True)


class TooLongError(Exception):
    """A proof has too many cells to be checked here."""


def check_outwards(shape: Shape) -> None:
    """Checks that no shell is inside out, unless the rest of its piece surrounds its corners."""
    points, _ = in_units([shape.points])
    first: dict[Whole, int] = {}
    names = [first.setdefault(v, k) for k, v in enumerate(points[0])]
    work = 0
    for number in set(shape.piece):
        own = [
            (names[a], names[b], names[c])
            for (a, b, c), piece, is_open in zip(
                shape.facets, shape.piece, shape.is_open, strict=True
            )
            if piece == number and not is_open
        ]
        parts = [
            [(points[0][a], points[0][b], points[0][c]) for a, b, c in part]
            for part in shells_of(own)
        ]
        for part in parts:
            base = part[0][0]
            sixth = (dot(minus(a, base), cross(minus(b, base), minus(c, base))) for a, b, c in part)
            low, high = box_of([v for facet in part for v in facet])
            # The library rounds volumes, so a shell without a volume may have any sign.
            if sum(sixth) * 2**44 >= -(max(minus(high, low)) ** 3):
                continue
            corners = [(*v, 1) for v in {v for facet in part for v in facet}]
            others = [facet for other in parts if other is not part for facet in other]
            rest = Surface(others)
            work += 2 * len(corners) * len(others)
            if work > MAX_CORNERS:
                raise TooLongError
            free = [at for at in corners if not any(has_point(facet, at) for facet in others)]
            if not free or any(rest.winding(at) <= 0 for at in free):
                raise RefusedError("a shell is inside out; facets have to point outwards")


class Common:
    """The bodies of a claim about their common part, in integers."""

    def __init__(self, moving: Body, fixed: Body) -> None:
        self.bodies = (moving, fixed)
        placed = [[body.at(k) for k in range(len(body.points))] for body in self.bodies]
        corners, self.unit_of = in_units(placed)
        #: The facets with an area by their numbers, and those of each piece.
        self.facets: list[dict[int, Corners]] = []
        self.pieces: list[list[Surface]] = []
        for body, at in zip(self.bodies, corners, strict=True):
            named: dict[int, Corners] = {}
            pieces: dict[int, list[Corners]] = {}
            shape = body.shape
            for k, (a, b, c) in enumerate(shape.facets):
                facet = (at[a], at[b], at[c])
                if not shape.is_open[k] and any(
                    cross(minus(facet[1], facet[0]), minus(facet[2], facet[0]))
                ):
                    named[k] = facet
                    pieces.setdefault(shape.piece[k], []).append(facet)
            self.facets.append(named)
            self.pieces.append([Surface(facets) for facets in pieces.values()])
        bits = max(x.bit_length() for at in corners for v in at for x in v)
        #: Factor by which long numbers take longer.
        self.weight = (1 + bits // 512) ** 2
        self.work = 0

    def point(self, v: Vector) -> Point4:
        weight = math.lcm(*((x * self.unit_of).denominator for x in v))
        x, y, z = (int(x * self.unit_of * weight) for x in v)
        return x, y, z, weight

    def coordinate(self, axis: int, at: Fraction) -> Plane4:
        """Returns the plane of the points with a coordinate."""
        of = at * self.unit_of
        plane = [0, 0, 0, -of.numerator]
        plane[axis] = of.denominator
        return plane[0], plane[1], plane[2], plane[3]

    def facet_plane(self, body: int, number: int) -> Plane4:
        if number not in self.facets[body]:
            raise RefusedError(f"facet {number} does not exist, is open or has no area")
        a, b, c = self.facets[body][number]
        normal = cross(minus(b, a), minus(c, a))
        return lowest_terms((*normal, -dot(normal, a)))

    def is_inside(self, body: int, at: Point4) -> bool:
        """Checks whether a point that is on no facet is inside one of the pieces of a body."""
        windings = [surface.winding(at) for surface in self.pieces[body]]
        if min(windings, default=0) < 0:
            raise RefusedError("a piece has a negative winding number in a cell")
        return max(windings, default=0) > 0

    def check_point(self, at: Vector, inside: tuple[bool, bool]) -> None:
        """Checks that a point is in the interior of bodies, and off the others."""
        point = self.point(at)
        for body, claimed in enumerate(inside):
            facets = self.facets[body].values()
            if any(has_point(facet, point) for facet in facets):
                raise RefusedError("a point is on the surface of a body")
            if self.is_inside(body, point) != claimed:
                raise RefusedError("a point is on the other side of a body")

    def root(self, low: Vector, high: Vector) -> tuple[Polytope, list[bool]]:
        """Returns a box that contains the common part, and which bodies are in it."""
        contains = [True, True]
        for axis, (end, sign) in product(range(3), ((low, -1), (high, 1))):
            plane = self.coordinate(axis, end[axis])
            bounds = [
                all(sign * side_of(plane, (*v, 1)) <= 0 for facet in named.values() for v in facet)
                for named in self.facets
            ]
            if not any(bounds):
                raise RefusedError("a side of the root bounds no body")
            contains = [a and b for a, b in zip(contains, bounds, strict=True)]
        if any(b <= a for a, b in zip(low, high, strict=True)):
            raise RefusedError("the root has no interior")
        v = [self.point((x[0], y[1], z[2])) for x, y, z in product((low, high), repeat=3)]
        sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        faces = [[lowest_terms(v[k]) for k in side] for side in sides]
        parts: list[list[Ring]] = []
        for named in self.facets:
            rings: list[Ring] = [[(*v, 1) for v in facet] for facet in named.values()]
            for axis, (end, k) in product(range(3), ((low, 1), (high, 0))):
                plane = self.coordinate(axis, end[axis])
                cut = [cut_ring(ring, plane)[k] for ring in rings]
                rings = [ring for ring in cut if ring is not None]
            parts.append(rings)
        return Polytope(faces, (parts[0], parts[1])), contains

    def spend(self, work: int) -> None:
        self.work += work * self.weight
        if self.work > MAX_CORNERS:
            raise TooLongError

    def check_side(self, cell: Polytope, body: int, claimed: bool) -> None:
        """Checks that a cell is on one side of a body."""
        if cell.facets[body]:
            raise RefusedError("a facet of a body meets a cell that is claimed to be on one side")
        if self.side(cell, body) != claimed:
            raise RefusedError("a cell is on the other side of a body")

    def side(self, cell: Polytope, body: int) -> bool:
        """Returns whether a cell that no facet of a body meets is inside this body."""
        known = cell.inside[body]
        if known is None:
            self.spend(len(self.facets[body]))
            known = self.is_inside(body, cell.inner_point())
            cell.inside = (known, cell.inside[1]) if body == 0 else (cell.inside[0], known)
        return known

    def decide_sides(self, cell: Polytope) -> None:
        """Decides the sides of a cell before it is cut, so that its parts inherit them."""
        for body in range(2):
            if not cell.facets[body]:
                # Only a claim about such a part is refused.
                with suppress(RefusedError):
                    self.side(cell, body)


#: The claims of a leaf: each body, and whether the cell is inside.
_LEAVES: dict[str, list[tuple[int, bool]]] = {
    "both": [(0, True), (1, True)],
    "outside_moving": [(0, False)],
    "outside_fixed": [(1, False)],
    "undecided": [],
}
_CUTS = ("x", "y", "z", "moving", "fixed")


def read_nodes(nodes: Any) -> list[tuple[str, Fraction | int]]:
    """Reads the nodes of a tree of cells."""
    read: list[tuple[str, Fraction | int]] = []
    for node in listed(nodes):
        if isinstance(node, str):
            if node not in _LEAVES:
                raise NoProofError(f"{node!r:.40} is not a cell")
            read.append((node, 0))
            continue
        kind, value = one_of(node, *_CUTS)
        read.append((kind, number(value) if kind in "xyz" else whole(value, 2**32)))
    return read


def read_box(value: Any) -> tuple[Vector, Vector]:
    bounds = fields(value, "low high")
    return vector(bounds["low"]), vector(bounds["high"])


def in_range(*vectors: Vector) -> None:
    """Refuses coordinates out of range."""
    for x in (x for v in vectors for x in v):
        if x and not _RANGE[0] <= abs(x) <= _RANGE[1]:
            raise RefusedError(f"the coordinate {float(x)!r} is out of range")


def check_cells(
    common: Common,
    nodes: list[tuple[str, Fraction | int]],
    root: tuple[Vector, Vector],
    bounds: tuple[Vector, Vector] | None,
    volume: tuple[Fraction, Fraction],
    relation: tuple[str | None, bool],
) -> None:
    """Checks the cells of a common part, and the claims that they prove together."""
    cell, contains = common.root(*root)
    walls = None
    if bounds is not None:
        walls = [
            (common.coordinate(axis, bounds[k][axis]), 1 - 2 * k)
            for axis, k in product(range(3), range(2))
        ]
    whole_volume = cell.volume()
    scale = 2**_VOLUME_DIGITS / whole_volume
    sums, leaves, stack = [0, 0], set(), [cell]
    for kind, value in nodes:
        if not stack:
            raise RefusedError("the tree of cells ends before its nodes")
        cell = stack.pop()
        common.spend(8 + cell.corners())
        if kind in _CUTS:
            if cell.depth >= MAX_CUTS:
                raise RefusedError("a cell has too many cuts around it")
            if isinstance(value, Fraction):
                in_range((value, value, value))
                plane = common.coordinate(_CUTS.index(kind), value)
            else:
                plane = common.facet_plane(0 if kind == "moving" else 1, value)
            common.decide_sides(cell)
            behind, before = cell.cut(plane)
            stack += [before, behind]
            continue
        for body, claimed in _LEAVES[kind]:
            common.check_side(cell, body, claimed)
        leaves.add(kind)
        if kind in ("both", "undecided"):
            part = cell.volume() * scale
            sums[0] += math.floor(part) if kind == "both" else 0
            sums[1] += math.ceil(part)
            if walls is None or any(
                sign * side_of(plane, v) < 0
                for plane, sign in walls
                for ring in cell.faces
                for v in ring
            ):
                raise RefusedError("the box of the common part does not contain a cell")
    if stack:
        raise RefusedError("the nodes end before the tree of cells")
    cubic = scale * common.unit_of**3
    if volume[0] * cubic > sums[0] or volume[1] * cubic < sums[1]:
        raise RefusedError("the cells do not prove the bounds of the volume")
    name, has_point = relation
    refused = {
        None: False,
        "disjoint": bool(leaves & {"both", "undecided"}),
        "crossing": "both" not in leaves and not has_point,
        "moving_contained": not contains[0] or not leaves <= {"both", "outside_moving"},
        "fixed_contained": not contains[1] or not leaves <= {"both", "outside_fixed"},
    }
    is_empty = name in ("moving_contained", "fixed_contained") and "both" not in leaves
    if refused[name] or is_empty:
        raise RefusedError("the cells do not prove the relation of the bodies")


def solid_common_part(moving: Body, fixed: Body, claim: Any, report: Report) -> None:
    """Checks the bounds of the volume that two solids have in common."""
    claim = fields(claim, "volume root nodes", "bounds point relation")
    lower, upper = (number(x) for x in listed(claim["volume"], 2))
    nodes, root = read_nodes(claim["nodes"]), read_box(claim["root"])
    bounds = None if claim["bounds"] is None else read_box(claim["bounds"])
    point = None if claim["point"] is None else vector(claim["point"])
    relation, alone = claim["relation"], []
    if isinstance(relation, dict):
        relation, only = one_of(relation, "crossing")
        only = fields(only, "only_moving only_fixed")
        alone = [vector(only["only_moving"]), vector(only["only_fixed"])]
    elif relation not in (None, "disjoint", "moving_contained", "fixed_contained"):
        raise NoProofError(f"{relation!r:.40} is not a relation")
    if radii(moving, fixed):
        raise RefusedError("common parts of rounded solids are not claimed")
    if not 0 <= lower <= upper:
        raise RefusedError("the bounds of the volume are not in order")
    in_range(*root, *(bounds or ()), *([] if point is None else [point]), *alone)
    if any(body.shape.has_open_area() for body in (moving, fixed)):
        report.partly = True
        report.unchecked.append("the common part: an open surface may have closed parts")
        return
    common = Common(moving, fixed)
    if point is not None:
        common.check_point(point, (True, True))
    for at, inside in zip(alone, ((True, False), (False, True)), strict=False):
        common.check_point(at, inside)
    try:
        for body in (moving, fixed):
            check_outwards(body.shape)
        check_cells(common, nodes, root, bounds, (lower, upper), (relation, point is not None))
    except TooLongError:
        report.partly = True
        report.unchecked.append(f"the common part: its cells have over {MAX_CORNERS} corners")
        return
    report.holds.append(
        f"the common part has a volume between {float(lower)!r} and {float(upper)!r}"
    )
    if relation is not None:
        report.holds.append(f"the relation of the bodies is {relation}")


# One body among many
# -------------------

#: The bound if nothing ever stops the body.
_NEVER = None


def body_box(body: Body) -> Bounds[Fraction]:
    """Returns the box of a placed body, including its radius."""
    low, high = box_of([body.at(k) for k in range(len(body.points))])
    by = (body.radius, body.radius, body.radius)
    return minus(low, by), plus(high, by)


def box_entry(
    p: Bounds[Fraction], q: Bounds[Fraction], d: Vector, min_gap: Fraction
) -> Fraction | None:
    """Returns the first translation, from 0 on, at which a box grown by a gap meets another."""
    first, last = Fraction(), None
    for a, b, c, e, x in zip(*p, *q, d, strict=True):
        near, far = c - b - min_gap, e - a + min_gap
        if x == 0:
            if near > 0 or far < 0:
                return _NEVER
            continue
        begin, end = sorted((near / x, far / x))
        first = max(first, begin)
        last = end if last is None else min(last, end)
    return _NEVER if last is not None and first > last else first


def beyond(bound: Fraction | None, lower: Fraction | None) -> bool:
    """Checks whether a bound is at least another one; None stands for infinity."""
    return bound is None or (lower is not None and bound >= lower)


#: The kind of placement for each kind of query.
PLACEMENTS = {
    "cast": "poses",
    "pair": "poses",
    "scene": "poses",
    "motions": "motions",
    "path": "robot",
}


@dataclass(frozen=True)
class File:
    """The bodies of a file, their placement, and the query."""

    shapes: list[Shape]
    #: The kind of the query, and its content.
    question: str
    query: Any
    placement: Any

    @classmethod
    def read(cls, content: dict[str, Any]) -> File:
        shapes = [Shape.read(shape) for shape in listed(content["bodies"])]
        question, query = "pair", None
        if content["query"] != "pair":
            question, query = one_of(
                content["query"], *(kind for kind in PLACEMENTS if kind != "pair")
            )
        _, placement = one_of(content["placement"], PLACEMENTS[question])
        return cls(shapes, question, query, placement)

    def number(self, value: Any) -> int:
        """Returns the index of a body."""
        return whole(value, len(self.shapes))

    def placed(self, of: Any) -> Body:
        """Returns a body at its pose."""
        return Body.placed(self.shapes[self.number(of["body"])], of["pose"])

    def poses(self) -> list[Body]:
        """Returns the bodies at their poses, the moving one first."""
        return [self.placed(fields(of, "body pose")) for of in listed(self.placement)]

    def two(self, solids: bool) -> tuple[Body, Body]:
        """Returns the moving and the fixed body: two solids, or two convex bodies."""
        listed(self.placement, 2)
        moving, fixed = self.poses()
        if moving.shape.is_convex == solids or fixed.shape.is_convex == solids:
            raise NoProofError("this claim does not apply to bodies of this kind")
        return moving, fixed


def gap_to_keep(of: Any) -> Fraction:
    """Returns the minimum gap of a query; 0 if there is none."""
    min_gap = number(of.get("min_gap", 0.0))
    if not 0 <= min_gap <= _RANGE[1]:
        raise NoProofError(
            f"a minimum gap of {float(min_gap)!r} is out of range; accepted: 0 to 2^200"
        )
    return min_gap


class Scene:
    """The check of a proof about one body among many."""

    def __init__(self, file: File, report: Report) -> None:
        self.moving, *self.obstacles = file.poses()
        choices = file.query
        fields(choices, "start_overlap", "min_gap graze_tolerance tolerance")
        self.min_gap = bounded(gap_to_keep(choices), MOST, "the gap to be kept")
        self.graze = number(choices.get("graze_tolerance", 0.0))
        tolerance = choices.get("tolerance")
        if self.graze < 0 or (tolerance is not None and number(tolerance) < 0):
            raise NoProofError("a tolerance is negative")
        self.refuses = refuses(choices["start_overlap"])
        self.box = body_box(self.moving)
        self.report = report

    def check(self, kind: str, claim: Any) -> None:
        kinds = {"nearest": self.nearest, "within": self.within}
        kinds.get(kind, self.clearance)(claim)

    def named(self, claims: Any) -> dict[int, Any]:
        """Returns the claims by obstacle, each obstacle once and in order."""
        pairs = [listed(pair, 2) for pair in listed(claims)]
        found = {whole(k, len(self.obstacles)): claim for k, claim in pairs}
        if sorted(found) != [k for k, _ in pairs]:
            raise RefusedError("obstacles are not listed once each, in order")
        return found

    def part(self, k: int, claim: Any, kinds: dict[str, Any]) -> Any:
        """Checks a claim about an obstacle with the function for its kind; returns the value."""
        ((kind, content),) = claim.items()
        if kind not in kinds:
            raise NoProofError(f"unknown kind of claim {kind!r}")
        if (kind == "convex") != (
            self.moving.shape.is_convex and self.obstacles[k].shape.is_convex
        ):
            raise RefusedError(f"obstacle {k}: a {kind} claim about bodies that are not")
        scratch = Report()
        try:
            found = kinds[kind](self.obstacles[k], content, scratch)
        except RefusedError as error:
            raise RefusedError(f"obstacle {k}: {error}") from error
        self.report.has_cover = self.report.has_cover or scratch.has_cover
        if scratch.partly:
            self.report.partly = True
            self.report.unchecked += [f"obstacle {k}: {line}" for line in scratch.unchecked]
        return found

    def report_line(self, line: str, since: int, by_boxes: str = "") -> None:
        """Reports a claim as valid, unless a part of it was left unchecked since ``since``."""
        if len(self.report.unchecked) == since:
            self.report.holds.append(line)
            return
        self.report.unchecked.append(line)
        if by_boxes:
            self.report.holds.append(by_boxes)

    def boxed(self, claims: Iterable[int], what: str) -> str:
        """Returns what the bounding boxes prove about obstacles without a claim."""
        count = len(self.obstacles) - len(set(claims))
        return f"by their boxes, {count} obstacles {what}" if count else ""

    def near(self, k: int, claim: Any) -> Fraction:
        """Returns the proven upper bound of the distance of an obstacle."""

        def convex(body: Body, near: Any, report: Report) -> Fraction:
            distance(self.moving, body, {"near": near}, report)
            return number(near["distance"])

        def solid(body: Body, near: Any, report: Report) -> Fraction:
            check_solid_near(near)
            upper = number(near["points"]["distance"]) if "points" in near else Fraction()
            moving, fixed = self.moving.as_solid(), body.as_solid()
            if moving.facets and fixed.facets:
                solid_near(moving, fixed, near, report)
            else:
                # The file does not number the facets of a convex body.
                report.partly = True
                report.unchecked.append(f"that it is at most {float(upper)!r} away")
            return upper

        found: Fraction = self.part(k, claim, {"convex": convex, "solid": solid})
        return found

    def is_apart(self, k: int, claim: Any, length: Fraction, strictly: bool) -> bool:
        """Checks whether an obstacle is farther than a length, by its claim or its bounding box."""

        def convex(body: Body, gap: Any, report: Report) -> Fraction:
            distance(self.moving, body, {"gap": gap}, report)
            return number(gap["gap"])

        def solid(body: Body, claim: Any, report: Report) -> Fraction:
            moving, fixed = self.moving.as_solid(), body.as_solid()
            if moving.facets and fixed.facets:
                solid_distance(moving, fixed, claim, report)
            else:
                # The file has no facets of a convex body.
                check_solid_near(fields(claim, "lower near cover")["near"])
                check_letters(claim["cover"], "mfpqwnxs")
                report.partly = True
                report.unchecked.append(f"that it is at least {claim['lower']!r} away")
            return number(claim["lower"])

        if claim is None:
            proven, least = box_gap(self.box, body_box(self.obstacles[k])), length * length
        else:
            proven, least = self.part(k, claim, {"convex": convex, "solid": solid}), length
        return bool(proven > least if strictly else proven >= least)

    def nearest(self, claim: Any) -> None:
        lower = number(fields(claim, "lower obstacle near apart")["lower"])
        nearest = whole(claim["obstacle"], len(self.obstacles))
        open_lines = len(self.report.unchecked)
        upper, claims = self.near(nearest, claim["near"]), self.named(claim["apart"])
        if not 0 <= lower <= upper:
            raise RefusedError("the bounds are in the wrong order")
        self.report_line(f"obstacle {nearest} is at most {float(upper)!r} away", open_lines)
        open_lines = len(self.report.unchecked)
        for k in range(len(self.obstacles)) if lower > 0 else claims:
            if not self.is_apart(k, claims.get(k), lower, strictly=False):
                raise RefusedError(f"obstacle {k} is not proven to be so far away")
        if lower > 0:
            all_of = f"none of {len(self.obstacles)} obstacles"
            by_boxes = self.boxed(claims, f"are not nearer than {float(lower)!r}")
            self.report_line(f"{all_of} is nearer than {float(lower)!r}", open_lines, by_boxes)

    def within(self, claim: Any) -> None:
        fields(claim, "length closer undecided apart")
        length, closer = claim["length"], self.named(claim["closer"])
        open_ones = self.named([[k, None] for k in listed(claim["undecided"])])
        claims = self.named(claim["apart"])
        if length is not None and number(length) < 0:
            raise RefusedError(f"a length of {length!r} is negative")
        if len({*closer, *open_ones, *claims}) < len(closer) + len(open_ones) + len(claims):
            raise RefusedError("an obstacle has two claims")
        open_lines = len(self.report.unchecked)
        for k, near in closer.items():
            if self.near(k, near) > (number(length) if length is not None else math.inf):
                raise RefusedError(f"obstacle {k} is not proven to be so near")
        are = "are proven to be" if open_ones else "are"
        self.report_line(f"{len(closer)} obstacles {are} at most {length!r} away", open_lines)
        open_lines = len(self.report.unchecked)
        others = [k for k in range(len(self.obstacles)) if k not in closer and k not in open_ones]
        for k in others:
            if length is None or not self.is_apart(k, claims.get(k), number(length), strictly=True):
                raise RefusedError(f"obstacle {k} is not proven to be so far away")
        by_boxes = self.boxed([*closer, *open_ones, *claims], "are farther")
        self.report_line(f"{len(others)} obstacles are farther", open_lines, by_boxes)
        if open_ones:
            self.report.unchecked.append(f"{len(open_ones)} obstacles, of which nothing is claimed")

    def clearance(self, claim: Any) -> None:
        d = vector(fields(claim, "direction lower stop passed")["direction"])
        if any(x and not _RANGE[0] <= abs(x) <= _RANGE[1] for x in d):
            raise NoProofError("the direction is out of range")
        lower = None if claim["lower"] is None else number(claim["lower"])
        if not any(d) or (lower is not None and lower < 0):
            raise RefusedError("there is no direction, or a bound is negative")
        claims, stop = self.named(claim["passed"]), claim["stop"]
        if self.graze > 0:
            self.report.holds.append(
                f"an overlap of the shadows by at most {float(self.graze)!r} counts as passed"
            )
        open_lines = len(self.report.unchecked)
        bounds = {k: self.passed(k, of, d) for k, of in claims.items()}
        if stop is not None:
            upper = bounds[whole(stop, len(self.obstacles))][1]
            if upper == -math.inf and lower == 0:
                self.report_line(f"obstacle {stop} overlaps the moving body", open_lines)
                return
            if upper is None or lower is None or lower > max(upper, 0):
                raise RefusedError(f"obstacle {stop} is not proven to stop the moving body")
            self.report_line(f"obstacle {stop} stops it by {float(upper)!r}", open_lines)
        for k, body in enumerate(self.obstacles):
            bound = (
                bounds[k][0]
                if k in bounds
                else box_entry(self.box, body_box(body), d, self.min_gap)
            )
            overlaps = k in bounds and bounds[k][1] == -math.inf
            if overlaps or not beyond(bound, lower) or (bound == 0 and k not in bounds):
                raise RefusedError(f"obstacle {k} is not proven to stop nothing before")
        never = "never" if lower is None else f"not before a translation of {float(lower)!r}"
        by_boxes = self.boxed(bounds, f"stop the moving body {never}")
        line = f"{len(self.obstacles)} obstacles stop the moving body {never}"
        self.report_line(line, open_lines, by_boxes)

    def passed(self, k: int, claim: Any, d: Vector) -> Any:
        """Returns bounds of the translation at which an obstacle stops the body, or None."""

        def solid(_: Body, proof: Any, report: Report) -> Any:
            report.partly = True
            report.unchecked.append("when it stops the moving body")
            proof = fields(proof, "tolerance start lower cover", "stop")
            stop, start = proof["stop"], proof["start"]
            overlaps = start != "assumed" and "apart" not in start
            if stop is None and overlaps and self.refuses:
                return Fraction(), -math.inf
            lower = None if proof["lower"] is None else number(proof["lower"])
            return lower, None if stop is None else number(stop["distance"])

        def convex(body: Body, answer: Any, report: Report) -> Any:
            return self.convex_bounds(body, answer, d, report)

        return self.part(k, claim, {"convex": convex, "solid": solid})

    def convex_bounds(self, body: Body, answer: Any, d: Vector, report: Report) -> Any:
        ((kind, of),) = answer.items()
        back, never = negative(d), (_NEVER, _NEVER)
        if kind == "blocked":
            proof = of["contact"]["certificate"]
            contact(self.moving, body, d, proof, report, "along the direction", self.min_gap)
            if number(of["distance"]) > max(number(proof["lower"]), Fraction()):
                raise RefusedError("the distance is larger than what is proven")
            upper = None if proof["upper"] is None else number(proof["upper"])
            return number(of["distance"]), upper
        if kind == "overlapping":
            for end, way in ((of["first"], d), (of["last"], back)):
                proof = end["certificate"]
                contact(self.moving, body, way, proof, report, "of the overlap", self.min_gap)
                if proof["upper"] is None or number(proof["upper"]) >= 0:
                    raise RefusedError("the bodies are not proven to overlap")
            return Fraction(), -math.inf
        if kind != "free":
            raise NoProofError(f"unknown clearance {kind!r}")
        ((why, free),) = of.items()
        if why == "separated":
            separation(self.moving, body, d, free["certificate"], report, self.min_gap)
        elif why == "behind":
            proof = free["certificate"]
            contact(self.moving, body, back, proof, report, "against the direction", self.min_gap)
            if number(proof["lower"]) < -number(proof["rounding"]):
                raise RefusedError("the bodies are not proven to meet behind only")
        elif why == "slides":
            self.slides(body, d, vector(free["separating_direction"]))
        else:
            raise NoProofError(f"unknown reason {why!r} of a free motion")
        return never

    def slides(self, body: Body, d: Vector, normal: Vector) -> None:
        """Checks that the shadows overlap by at most the graze tolerance, up to rounding."""
        core_gap = self.min_gap + radii(self.moving, body)
        noise = _NOISE * (size(self.moving, body) + core_gap)
        most = max(self.graze, 8 * noise) + 3 * noise
        if not are_shadows_apart(self.moving, body, d, normal, core_gap - most):
            raise RefusedError("the shadows overlap by more than the graze tolerance")


# All directions
# --------------

#: Maximum depth of a cell, and the fixed-point unit of slopes.
_DEEPEST = 50
_PARTS = 1 << 60


@dataclass
class Polygon:
    """A closed convex set of directions on a side of the cube; it may be an arc or a point."""

    corners: list[Whole]
    #: The planes from each corner to the next, with the polygon on their positive side.
    edges: list[Whole]

    def clipped(self, form: Whole, axis: int, sign: int) -> Polygon:
        """Returns the part of the polygon where a linear form is not negative."""
        sides = [dot(form, c) for c in self.corners]
        kept = Polygon([], [])
        for k, (corner, edge) in enumerate(zip(self.corners, self.edges, strict=True)):
            here, there = sides[k], sides[(k + 1) % len(sides)]
            if here >= 0:
                kept.corners.append(corner)
                kept.edges.append(form if here == 0 and there < 0 else edge)
            if (here > 0 and there < 0) or (here < 0 and there > 0):
                at = cross(edge, form)
                kept.corners.append(at if at[axis] * sign > 0 else negative(at))
                kept.edges.append(form if here > 0 else edge)
        return kept

    def is_region(self) -> bool:
        first = self.corners[0]
        for other in self.corners[1:]:
            normal = cross(first, other)
            if any(normal):
                return any(dot(normal, c) for c in self.corners)
        return False

    def holds(self, other: Polygon) -> bool:
        return all(dot(e, c) >= 0 for e in self.edges for c in other.corners)


def face_each_other(f: Corners, g: Corners, ahead: Whole, back: Whole) -> bool:
    """Checks whether two coplanar facets face each other with overlapping interiors."""
    if dot(ahead, back) <= 0:
        return False
    for one, other in ((f, g), (g, f)):
        for k in range(3):
            across = cross(ahead, minus(one[k], one[k - 1]))
            inner = dot(across, minus(one[k - 2], one[k]))
            if all(dot(across, minus(c, one[k])) * inner <= 0 for c in other):
                return False
    return True


def blocking_cone(f: Corners, g: Corners) -> list[Whole]:
    """Returns the forms of the cone that facets ``f`` (moving) and ``g`` (fixed) block.

    The list is empty if they block nothing. A side of the cone over the differences is spanned by a
    vertex of one facet and an edge of the other, and has all nine differences on one side.
    """
    ahead = cross(minus(f[1], f[0]), minus(f[2], f[0]))
    back = negative(cross(minus(g[1], g[0]), minus(g[2], g[0])))
    between = [minus(q, p) for p in f for q in g]
    if not any(dot(ahead, m) or dot(back, m) for m in between):
        return [ahead] if face_each_other(f, g, ahead, back) else []
    spanned = [(minus(g[a], p), minus(g[a - 1], p)) for p in f for a in range(3)]
    spanned += [(minus(q, f[a]), minus(q, f[a - 1])) for q in g for a in range(3)]
    sides: list[Whole] = []
    for u, v in spanned:
        form = cross(u, v)
        heights = [dot(form, m) for m in between]
        if any(heights) and min(heights) >= 0:
            sides.append(form)
        elif any(heights) and max(heights) <= 0:
            sides.append(negative(form))
    return [ahead, back, *sides] if sides else []


@dataclass
class Sphere:
    """The facets of two bodies with integer coordinates, and the directions that they block."""

    bodies: tuple[list[Corners], list[Corners]]
    trees: tuple[Box, Box]
    #: Boxes inside the moving and the fixed body, as least and greatest coordinates.
    inner: tuple[list[Bounds[int]], list[Bounds[int]]] = ([], [])
    cones: dict[tuple[int, int], list[Whole]] = field(default_factory=dict)
    #: Number of pairs of boxes that the search has visited.
    pairs: int = 0

    def cone(self, pair: tuple[int, int]) -> list[Whole]:
        """Returns forms that are all positive exactly on the directions that two facets block."""
        if pair not in self.cones:
            self.cones[pair] = blocking_cone(self.bodies[0][pair[0]], self.bodies[1][pair[1]])
        return self.cones[pair]


@dataclass(frozen=True)
class Cell:
    """A square on a side of the cube, which has ``2 ** depth`` by ``2 ** depth`` squares."""

    side: int
    depth: int
    at: tuple[int, int]

    @property
    def axes(self) -> tuple[int, int, int]:
        k = self.side // 2
        return k, (k + 1) % 3, (k + 2) % 3

    @property
    def sign(self) -> int:
        return -1 if self.side % 2 else 1

    def corner(self, across: int, up: int) -> Whole:
        one = 1 << self.depth
        d = [0, 0, 0]
        k, i, j = self.axes
        d[k], d[i], d[j] = (
            self.sign * one,
            2 * (self.at[0] + across) - one,
            2 * (self.at[1] + up) - one,
        )
        return d[0], d[1], d[2]

    def polygon(self) -> Polygon:
        corners = [self.corner(*at) for at in ((0, 0), (1, 0), (1, 1), (0, 1))]
        middle = tuple(sum(c[k] for c in corners) for k in range(3))
        edges = [cross(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
        inner = (middle[0], middle[1], middle[2])
        return Polygon(corners, [e if dot(e, inner) > 0 else negative(e) for e in edges])

    def quarters(self) -> list[Cell]:
        u, v = self.at
        places = ((2 * u + a, 2 * v + b) for b in (0, 1) for a in (0, 1))
        return [Cell(self.side, self.depth + 1, place) for place in places]


def pair_of(value: Any, sphere: Sphere) -> tuple[int, int]:
    f, g = listed(value, 2)
    return whole(f, len(sphere.bodies[0])), whole(g, len(sphere.bodies[1]))


def whole_bodies(moving: Body, fixed: Body, claim: Any, report: Report) -> Sphere:
    """Returns both bodies with integer coordinates, shrunk as stored in the file."""
    tolerance, shrunk = number(claim["tolerance"]), claim.get("shrunk")
    if tolerance < 0 or (tolerance > 0) != (shrunk is not None):
        raise RefusedError("a tolerance above 0 and shrunk vertices must occur together")
    bodies = [moving, fixed]
    if shrunk is not None:
        farthest = 0.0
        for k, points in enumerate(
            [[vector(v) for v in listed(side)] for side in listed(shrunk, 2)]
        ):
            if len(points) != len(bodies[k].points):
                raise RefusedError("the shrunk bodies have other vertices")
            ways = [minus(a, b) for a, b in zip(points, bodies[k].points, strict=True)]
            farthest = max(farthest, *(math.sqrt(float(dot(w, w))) for w in ways))
            bodies[k] = replace(bodies[k], shape=replace(bodies[k].shape, points=points))
        report.unchecked.append(
            f"what shrinking by {float(tolerance / 2)!r} makes of the bodies: vertices are moved "
            f"by up to {farthest:.3e}"
        )
    placed = [[body.at(k) for k in range(len(body.points))] for body in bodies]
    origin, inner = moving.offset, []
    for stored in listed(claim.get("boxes", [[], []])):
        sides = [fields(of, "low high") for of in listed(stored)]
        ends = [(vector(of["low"]), vector(of["high"])) for of in sides]
        inner.append([(plus(low, origin), plus(high, origin)) for low, high in ends])
    if len(inner) != 2:
        raise NoProofError("inner boxes are not given for both bodies")
    of_boxes = [[v for ends in boxes_ for v in ends] for boxes_ in inner]
    (*at, p_boxes, q_boxes), _ = in_units([*placed, *of_boxes])
    f, g = (
        [(v[a], v[b], v[c]) for a, b, c in body.facets] for body, v in zip(bodies, at, strict=True)
    )
    within = [list(zip(ends[::2], ends[1::2], strict=True)) for ends in (p_boxes, q_boxes)]
    return Sphere((f, g), (box_tree(f), box_tree(g)), (within[0], within[1]))


def is_between(near: Bounds[int], far: Bounds[int], d: Whole) -> bool:
    """Checks whether a positive multiple of ``d`` is inside the box of differences of two boxes."""
    low, high = minus(far[0], near[1]), minus(far[1], near[0])
    after, before = Fraction(0), None
    for k in range(3):
        if d[k] == 0:
            if not low[k] < 0 < high[k]:
                return False
            continue
        ends = sorted((Fraction(low[k], d[k]), Fraction(high[k], d[k])))
        after = max(after, ends[0])
        before = ends[1] if before is None else min(before, ends[1])
    return before is None or after < before


def is_parted(facet: Corners, low: Whole, high: Whole) -> bool:
    """Checks whether a plane separates a facet from the interior of a box."""
    a, b, c = facet
    edges = minus(b, a), minus(c, b), minus(a, c)
    across = [cross(edges[0], edges[1])]
    for x, y, z in edges:
        across += [(0, -z, y), (z, 0, -x), (-y, x, 0)]
    for n in across:
        least = sum(n[k] * (low[k] if n[k] > 0 else high[k]) for k in range(3))
        most = sum(n[k] * (high[k] if n[k] > 0 else low[k]) for k in range(3))
        heights = [dot(n, p) for p in facet]
        if least < most and (max(heights) <= least or min(heights) >= most):
            return True
    return False


def winding(sphere: Sphere, side: int, at: Whole) -> int | None:
    """Returns the winding number of a body around a point, from a ray along ``x``.

    The coordinates of ``at`` are in sixteenths. Returns None if the ray meets an edge.
    """
    stack, count = [sphere.trees[side]], 0
    while stack:
        node = stack.pop()
        beside = any(
            16 * node.bounds[0][k] > at[k] or 16 * node.bounds[1][k] < at[k] for k in (1, 2)
        )
        if beside or 16 * node.bounds[1][0] < at[0]:
            continue
        if node.facet is None:
            stack += node.parts
            continue
        facet = sphere.bodies[side][node.facet]
        a, b, c = (minus((16 * p[0], 16 * p[1], 16 * p[2]), at) for p in facet)
        turns = [p[1] * q[2] - p[2] * q[1] for p, q in ((a, b), (b, c), (c, a))]
        if min(turns) < 0 < max(turns):
            continue
        if 0 in turns:
            return None
        ahead = dot(cross(minus(b, a), minus(c, a)), a)
        if ahead == 0:
            return None
        if (ahead > 0) == (turns[0] > 0):
            count += 1 if turns[0] > 0 else -1
    return count


def is_inside(sphere: Sphere, side: int, box_: Bounds[int]) -> bool:
    """Checks whether a box is inside a body: no facet meets its interior, and a ray exits."""
    low, high = box_
    if any(a >= b for a, b in zip(low, high, strict=True)):
        return False
    stack = [sphere.trees[side]]
    while stack:
        node = stack.pop()
        if any(node.bounds[0][k] >= high[k] or node.bounds[1][k] <= low[k] for k in range(3)):
            continue
        if node.facet is None:
            stack += node.parts
        elif not is_parted(sphere.bodies[side][node.facet], low, high):
            return False
    # Test points of the box, as sixteenths of its sides.
    for shares in ((8, 8, 8), (7, 9, 6), (5, 10, 11)):
        at = [low[k] * (16 - shares[k]) + high[k] * shares[k] for k in range(3)]
        turns = winding(sphere, side, (at[0], at[1], at[2]))
        if turns is not None:
            return turns > 0
    return False


def is_met(cone: list[Whole], polygon: Polygon, cell: Cell) -> bool:
    """Checks whether a cone contains a direction of a polygon."""
    if not cone or any(all(dot(form, c) <= 0 for c in polygon.corners) for form in cone):
        return False
    for form in cone:
        polygon = polygon.clipped(form, cell.axes[0], cell.sign)
        if not polygon.corners:
            return False
    # If each form is positive at some corner, all are positive at the mean of the corners.
    return all(any(dot(form, c) > 0 for c in polygon.corners) for form in cone)


def remainder(sphere: Sphere, cell: Cell, pairs: list[tuple[int, int]]) -> list[Polygon]:
    """Returns the remainder of a cell after the cones of some pairs of facets are removed."""
    left = [cell.polygon()]
    for pair in pairs:
        cone, after = sphere.cone(pair), []
        for polygon in left:
            if not is_met(cone, polygon, cell):
                after.append(polygon)
                continue
            inner = polygon
            for form in cone:
                outer = inner.clipped(negative(form), cell.axes[0], cell.sign)
                if outer.corners:
                    after.append(outer)
                inner = inner.clipped(form, cell.axes[0], cell.sign)
                if not inner.corners:
                    break
        regions = [p for p in after if p.is_region()]
        alone = [p for p in after if not p.is_region() and not any(r.holds(p) for r in regions)]
        left = regions + alone
    return left


def is_beside(cell: Cell, ends: list[tuple[int, int]], low: Whole, high: Whole) -> bool:
    """Checks whether no ``t d`` with ``t >= 0`` is in a box, for all ``d`` between the ends."""
    k, i, j = cell.axes
    near, far = (low[k], high[k]) if cell.sign > 0 else (-high[k], -low[k])
    near = max(near, 0)
    for (least, most), axis in zip(ends, (i, j), strict=True):
        for slope, limit in ((most, low[axis]), (-least, -high[axis])):
            # The condition t slope >= limit.
            if slope > 0:
                near = max(near, limit * _PARTS // slope)
            elif slope < 0:
                far = min(far, -(limit * _PARTS // -slope) + 1)
            elif limit > 0:
                return True
    return near > far


def face_away(sphere: Sphere, pair: tuple[int, int], polygon: Polygon) -> bool:
    """Checks whether one of two facets faces away from all directions of a polygon."""
    for facet, sign in ((sphere.bodies[0][pair[0]], 1), (sphere.bodies[1][pair[1]], -1)):
        normal = cross(minus(facet[1], facet[0]), minus(facet[2], facet[0]))
        if all(sign * dot(normal, c) <= 0 for c in polygon.corners):
            return True
    return False


def first_met(sphere: Sphere, cell: Cell, polygon: Polygon) -> tuple[int, int] | None:
    """Finds a pair of facets that blocks a direction of a polygon."""
    k, i, j = cell.axes
    ends = []
    for axis in (i, j):
        below = [c[axis] * _PARTS // (c[k] * cell.sign) for c in polygon.corners]
        ends.append((min(below), max(below) + 1))

    def misses(a: Bounds[int], b: Bounds[int]) -> bool:
        return is_beside(cell, ends, minus(b[0], a[1]), minus(b[1], a[0]))

    for pair in near_facets(sphere.trees, misses):
        if pair is None:
            sphere.pairs += 1
        elif not face_away(sphere, pair, polygon) and is_met(sphere.cone(pair), polygon, cell):
            return pair
    return None


def solid_angle(corners: list[Whole]) -> float:
    """Returns the solid angle of a convex polygon of directions, rounded."""
    largest = max(abs(x) for c in corners for x in c)
    ways = [tuple(float(Fraction(x, largest)) for x in c) for c in corners]
    ways = [tuple(x / math.hypot(*c) for x in c) for c in ways]
    total = 0.0
    a = ways[0]
    for b, c in pairwise(ways[1:]):
        edge, other = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
        normal = [edge[k - 2] * other[k - 1] - edge[k - 1] * other[k - 2] for k in range(3)]
        volume = abs(sum(a[k] * normal[k] for k in range(3)))
        ab, bc, ca = (
            sum(x * y for x, y in zip(p, q, strict=True)) for p, q in ((a, b), (b, c), (c, a))
        )
        total += 2 * math.atan2(volume, 1 + ab + bc + ca)
    return total


def summary(report: Report, count: dict[str, int], areas: list[float], skipped: int) -> None:
    free, undecided = (f"{100 * area / (4 * math.pi):.6g} %" for area in areas)
    line = f"{sum(count.values())} cells cover the sphere"
    line += f", {count['blocked']} are blocked by two facets each"
    if count["inner"]:
        line += f", {count['inner']} by two boxes inside the bodies each"
    if count["open"]:
        line += f", {count['open'] - skipped} are decided exactly"
    report.holds.append(f"{line}: about {free} of all directions are free")
    if count["undecided"]:
        report.unchecked.append(f"{count['undecided']} cells are undecided: about {undecided}")
    if skipped:
        report.unchecked.append(
            f"that nothing else blocks the free parts of {skipped} cells: too many pairs"
        )


def free_directions(moving: Body, fixed: Body, claim: Any, report: Report) -> None:
    """Checks the classification of all directions, cell by cell, in integers."""
    fields(claim, "tolerance start_overlap cells", "shrunk boxes")
    refuses_overlap = refuses(claim["start_overlap"])
    sphere = whole_bodies(moving, fixed, claim, report)
    stack = [Cell(side, 0, (0, 0)) for side in range(5, -1, -1)]
    count = {"blocked": 0, "inner": 0, "open": 0, "undecided": 0}
    if any(sphere.inner) and not refuses_overlap:
        raise RefusedError("inner boxes prove nothing if overlaps at the start are ignored")
    for k in range(2):
        for at, box_ in enumerate(sphere.inner[k]):
            if not is_inside(sphere, k, box_):
                raise RefusedError(f"box {at} is not inside the {('moving', 'fixed')[k]} body")
    free, undecided, skipped = 0.0, 0.0, 0
    for entry in listed(claim["cells"]):
        if not stack:
            raise RefusedError("there are more cells than the sphere has")
        cell = stack.pop()
        if entry == "cut":
            if cell.depth == _DEEPEST:
                raise RefusedError("a cell is divided too often")
            stack += reversed(cell.quarters())
            continue
        kind, content = one_of(entry, *count)
        count[kind] += 1
        if kind == "inner":
            a, b = content
            near = sphere.inner[0][whole(a, len(sphere.inner[0]))]
            far = sphere.inner[1][whole(b, len(sphere.inner[1]))]
            if not all(is_between(near, far, c) for c in cell.polygon().corners):
                raise RefusedError(f"boxes {content} do not block all of a cell")
            continue
        pairs = [pair_of(p, sphere) for p in ([content] if kind == "blocked" else content)]
        if kind == "blocked":
            corners = cell.polygon().corners
            cone = sphere.cone(pairs[0])
            if not cone or any(dot(form, c) <= 0 for form in cone for c in corners):
                raise RefusedError(f"facets {content} do not block all of a cell")
            continue
        left = remainder(sphere, cell, pairs)
        around = sum(solid_angle(p.corners) for p in left if p.is_region())
        if kind == "undecided":
            undecided += around
            continue
        free += around
        if sphere.pairs > MAX_PAIRS:
            skipped += 1
            continue
        for polygon in left:
            met = first_met(sphere, cell, polygon)
            if met is not None:
                raise RefusedError(
                    f"facets {list(met)} block a direction that is claimed to be free"
                )
    if stack:
        raise RefusedError("the cells do not cover the sphere")
    summary(report, count, [free, undecided], skipped)
    report.partly = True
    if refuses_overlap:
        report.unchecked.append("that the bodies do not overlap where they are")


# Motions of convex bodies
# ------------------------


@cache
def quarter_turn() -> int:
    """Returns half of pi with twice the digits, by Machin's formula."""
    one = 1 << (2 * _DIGITS)

    def arctan(n: int) -> int:
        total, power, k = 0, one // n, 0
        while power:
            total += (-power if k % 2 else power) // (2 * k + 1)
            power, k = power // (n * n), k + 1
        return total

    return 2 * (4 * arctan(5) - arctan(239))


@cache
def sine_cosine(angle: Fraction) -> tuple[Fraction, Fraction]:
    """Returns sine and cosine of an angle in radians, by reduction to a quarter turn and series."""
    one = 1 << _DIGITS
    fine = math.floor(angle * (1 << (2 * _DIGITS)))
    quarters = round(Fraction(fine, quarter_turn()))
    left = (fine - quarters * quarter_turn()) >> _DIGITS
    cos, sin, term, k = 0, 0, one, 0
    while term:
        signed = -term if k % 4 > 1 else term
        cos, sin = (cos, sin + signed) if k % 2 else (cos + signed, sin)
        k += 1
        term = term * abs(left) // (k * one)
    sin = -sin if left < 0 else sin
    sin, cos = ((sin, cos), (cos, -sin), (-sin, -cos), (-cos, sin))[quarters % 4]
    return Fraction(sin, one), Fraction(cos, one)


#: Maximum angle of a motion, in radians.
_MOST_TURN = 10**5
#: Maximum difference of the end of a piece of a motion and the start of the next one. It applies to
#: the entries of the rotation, and to the translation as a share of the lengths that it is computed
#: from.
_JUMP = Fraction(1, 10**12)


@dataclass(frozen=True)
class Plane:
    """A normal at a time, and the claimed gap beyond the minimum gap."""

    time: Fraction
    normal: Vector
    gap: Fraction
    alone: bool

    @classmethod
    def read(cls, of: Any) -> Plane:
        fields(of, "time normal gap alone")
        alone = truth(of["alone"])
        return cls(number(of["time"]), vector(of["normal"]), number(of["gap"]), alone)

    @property
    def along(self) -> Fraction:
        """Returns a lower bound of the gap in multiples of the normal, a rounded unit vector."""
        return self.gap * (1 - _UNIT_VECTOR)

    def leaves(self, along: Fraction, min_gap: Fraction) -> bool:
        """Checks whether the remaining gap is at least the claimed gap plus ``min_gap``.

        With a tolerated depth the sum, and the remaining gap, may be negative.
        """
        gap, square = self.gap + min_gap, dot(self.normal, self.normal)
        if gap > 0:
            return above(along, gap * gap * square)
        return along >= 0 or along * along <= gap * gap * square


def stays(a: Fraction, b: Fraction, c: Fraction) -> bool:
    """Checks whether ``(1 - x) a + x b - c x (1 - x) / 2`` is positive for ``x`` from 0 to 1.

    This holds if ``sqrt a + sqrt b > sqrt(c / 2)``.
    """
    over = c / 2 - a - b
    return min(a, b) > 0 and (over < 0 or over * over < 4 * a * b)


@dataclass
class Spin:
    """A body that spins evenly; a point ``y`` is at ``place + way (t - since) + E y``.

    ``y`` runs over ``arm + R v``, the vectors from a point of the axis to the vertices at the
    start. ``E`` is the rotation by ``rate (t - since)`` about the normalised axis.
    """

    body: Body
    since: Fraction
    arm: Vector
    axis: Vector
    rate: Fraction
    way: Vector
    #: The squared length of the axis, and the inverse of its length.
    square: Fraction
    inverse: Fraction
    #: Upper bounds of the distance of points from the axis, and from the point on it.
    radius: Fraction
    reach: Fraction

    @classmethod
    def read(cls, points: list[Vector], piece: Any) -> Spin:
        piece = fields(piece, "since start arm axis rate velocity")
        body = Body.placed(Shape(points), piece["start"])
        arm, axis = bounded_vector(piece["arm"], "an arm"), vector(piece["axis"])
        rate, way = number(piece["rate"]), bounded_vector(piece["velocity"], "a velocity")
        unit(axis)
        if abs(rate) > _MOST_TURN:
            raise NoProofError(f"a rotation by {float(rate)!r} is out of range")
        square = dot(axis, axis)
        since, inverse, zero = number(piece["since"]), 1 / root_above(square), Fraction()
        spin = cls(body, since, arm, axis, rate, way, square, inverse, zero, zero)
        return spin.with_points(points)

    def with_points(self, points: list[Vector]) -> Spin:
        """Returns this spin with other points."""
        body = self.body.with_points(points)
        ways = [plus(self.arm, minus(body.at(k), body.offset)) for k in range(len(points))]
        beside = [cross(self.axis, y) for y in ways]
        radius = root_above(max(dot(y, y) for y in beside) / self.square)
        return replace(
            self, body=body, radius=radius, reach=root_above(max(dot(y, y) for y in ways))
        )

    def turned(self, v: Vector, time: Fraction) -> Vector:
        """Returns ``E v``: rotates a vector from the start of the spin to a time."""
        return replace(self, rate=-self.rate).back(v, time)

    def back(self, n: Vector, time: Fraction) -> Vector:
        """Returns ``E' n``: rotates a vector from a time back to the start of the spin."""
        if self.rate == 0:
            return n
        sin, cos = sine_cosine(self.rate * (time - self.since))
        beside = cross(self.axis, n)
        found = minus(n, scaled(beside, sin * self.inverse))
        return plus(found, scaled(cross(self.axis, beside), (1 - cos) / self.square))

    def along(self, n: Vector, time: Fraction) -> list[Fraction]:
        """Returns ``n . E y`` for all points."""
        u = self.back(n, time)
        base = dot(u, self.arm) - dot(u, self.body.offset)
        return [base + height for height in self.body.heights(u)]

    def foot(self, n: Vector, time: Fraction) -> Fraction:
        """Returns the common part of all heights along a normal."""
        start = minus(self.body.offset, self.arm)
        return dot(n, plus(start, scaled(self.way, time - self.since)))

    def at(self, k: int, time: Fraction) -> Vector:
        """Returns a point in the world."""
        x, y, z = (self.foot(e, time) + self.one(k, e, time) for e in _UNITS)
        return x, y, z

    def facets(self, facets: list[Triangle], time: Fraction) -> list[Triangle]:
        """Returns facets of the body in the world."""
        if not facets:
            return []
        turned = self.with_points([v for facet in facets for v in facet])
        corners = iter([turned.at(k, time) for k in range(3 * len(facets))])
        return list(zip(corners, corners, corners, strict=True))

    def one(self, k: int, n: Vector, time: Fraction) -> Fraction:
        u = self.back(n, time)
        return dot(u, plus(self.arm, minus(self.body.at(k), self.body.offset)))

    def off(self, n: Vector) -> Fraction:
        """Returns a bound of the error of ``n . E y`` from sine, cosine and root."""
        return 16 * _TINY * root_above(dot(n, n)) * self.reach if self.rate else Fraction()

    def across(self, n: Vector) -> Vector:
        """Returns the part of a vector across the axis."""
        return minus(n, scaled(self.axis, dot(n, self.axis) / self.square))

    def curvature(self, ends: Sequence[Plane], sign: int, tightly: bool) -> Fraction:
        """Returns an upper bound of ``W . E y`` between two planes.

        ``W = sign (alpha^2 n_across + 2 alpha k x dn)`` is affine in the time. ``E y`` across the
        axis is a combination of its values at both ends. The sum of the weights is at least 1, and
        at most ``1 / cos(alpha / 2)``. The loose bound is the longer ``W`` times the largest
        distance of a point from the axis.
        """
        a, b = ends
        alpha = self.rate * (b.time - a.time)
        if alpha == 0:
            return Fraction()
        dn = minus(b.normal, a.normal)
        sideways = scaled(cross(self.axis, dn), 2 * alpha * self.inverse)
        ways = [
            scaled(plus(scaled(self.across(end.normal), alpha * alpha), sideways), Fraction(sign))
            for end in ends
        ]
        longest = root_above(max(dot(w, w) for w in ways))
        room = 64 * _TINY * (longest + abs(alpha)) * self.reach
        if not tightly or abs(alpha) > 3:
            return longest * self.radius + room
        most = max(max(self.along(w, end.time)) for w in ways for end in ends) + room
        least = sine_cosine(alpha / 2)[1] - _TINY
        return most / least if most > 0 else most

    def rise(self, n: Vector, begin: Fraction, end: Fraction) -> Fraction:
        """Returns an upper bound of the rise of the highest point between two times."""
        angle = abs(self.rate * (end - begin))
        if angle == 0:
            return Fraction()
        sign = 1 if self.rate > 0 else -1
        side = scaled(cross(n, self.axis), sign * self.inverse)
        around, off = self.across(n), self.off(n)
        sin, cos = sine_cosine(angle) if angle < 3 else (Fraction(), Fraction())
        highest, before = None, None
        heights, across, ahead = (self.along(v, begin) for v in (n, around, side))
        for height, a, b in zip(heights, across, ahead, strict=True):
            top, rest = height, height - a
            slope = b * cos - a * sin
            if angle >= 3 or (b > -off and slope < 2 * off):
                top = rest + root_above(a * a + b * b)
            elif angle < 3:
                top = max(top, rest + a * cos + b * sin)
            highest = top if highest is None else max(highest, top)
            before = height if before is None else max(before, height)
        assert highest is not None and before is not None
        return highest - before + 8 * off


#: Returns the points of pairs of vertices, from the moving and from the fixed body.
Ends: TypeAlias = Callable[[Any], list[tuple[Vector, Vector]]]


def check_steps(steps: Any) -> None:
    """Checks the form of step counts, which prove nothing."""
    if not isinstance(steps, dict):
        raise NoProofError(f"steps is {steps!r:.40}, not an object with counts")
    for name in ("planar_problems", "supports", "pivots", "iterations"):
        whole(steps.get(name), 2**32)
    whole(steps.get("region_sides", 0), 2**32)
    if steps.get("started_from", "scratch") not in ("difference", "features", "region", "scratch"):
        raise NoProofError(f"unknown start of a search {steps['started_from']!r}")


def near_claim(claim: Any) -> Any:
    """Returns a claim that two points are near each other, after a check of its fields."""
    for weight in listed(fields(claim, _NEAR)["weights"], 4):
        number(weight)
    return claim


def deep_claim(claim: Any) -> Any:
    """Returns a claim that bodies overlap, after a check of its fields."""
    fields(claim, "lower upper direction enclosure", "near steps")
    if "steps" in claim:
        check_steps(claim["steps"])
    fields(claim["enclosure"], "pairs triangles normals")
    if claim.get("near") is not None:
        near_claim(claim["near"])
    return claim


def check_deep(
    claim: Any,
    ends: Ends,
    gap: Callable[[Vector], Fraction],
    off: tuple[Fraction, Fraction],
    tolerated: Fraction,
    swept: Fraction,
) -> None:
    """Checks that bodies overlap by more than the tolerated depth; the depth holds up to rounding.

    ``gap`` returns the least gap of the hulls of points along a normal. ``off`` has the errors of
    points here, and in the poses to which the depth refers. ``swept`` is the sum of the radii.
    """
    surface, near = deep_claim(claim)["enclosure"], claim.get("near")
    lower, upper, d = number(claim["lower"]), number(claim["upper"]), vector(claim["direction"])
    unit(d, "the direction of the depth")
    for normal in listed(surface["normals"]):
        unit(vector(normal))
    if not tolerated < lower <= upper:
        raise RefusedError(
            "the bounds of the depth are in the wrong order, or the depth is tolerated"
        )
    # Hulls at the distance `x` have the depth `swept - x`, hulls of the depth `x` have `swept + x`.
    deeper = max(off[0] + tolerated * (1 + _TINY), lower - off[1]) - swept
    if near is not None and not any(listed(part) for part in surface.values()):
        if not swept or not are_cores_near(near, ends(listed(near["pairs"], 4)), -deeper):
            raise RefusedError(f"the points do not prove a depth of {float(lower)!r}")
    else:
        # A surface still winds around the origin if its points move by less than their distance
        # from it.
        corners = [minus(q, p) for p, q in ends(surface["pairs"])]
        enclosure(corners, surface, max(off[0], deeper))
    # The translation along the direction must separate the bodies up to rounding.
    reach = swept - gap(negative(d))
    if reach > upper + off[1]:
        raise RefusedError(
            f"a translation by {float(reach)!r} separates the bodies, not {float(upper)!r}"
        )


def check_near(
    claim: Any,
    ends: Ends,
    off: tuple[Fraction, Fraction],
    min_gap: Fraction,
    swept: Fraction,
) -> None:
    """Checks that points of both bodies are within a gap; the distance holds up to rounding.

    ``off`` and ``swept`` are those of :func:`check_deep`.
    """
    pairs, claimed = listed(near_claim(claim)["pairs"], 4), number(claim["distance"])
    if not 0 <= claimed <= min_gap:
        raise RefusedError(f"{float(claimed)!r} is not as near as {float(min_gap)!r}")
    for length in (min_gap - off[0], claimed + off[1]):
        if not are_cores_near(claim, ends(pairs), length + swept):
            raise RefusedError(f"the points are not as near as {float(length)!r}")


def check_contact(
    met: Any,
    ends: Ends,
    gap: Callable[[Vector], Fraction],
    off: tuple[Fraction, Fraction],
    min_gap: Fraction,
    swept: Fraction,
) -> None:
    """Checks that convex bodies overlap by more than tolerated, or are within the minimum gap.

    A negative minimum gap is a tolerated depth. See :func:`check_deep` for the
    other arguments.
    """
    kind, claim = one_of(met, "deep", "near")
    if kind == "deep":
        check_deep(claim, ends, gap, off, max(-min_gap, Fraction()), swept)
    elif min_gap > 0:
        check_near(claim, ends, off, min_gap, swept)
    else:
        raise RefusedError(f"{kind!r} does not prove that the bodies meet")


@dataclass
class Span:
    """A period in which both bodies spin evenly."""

    moving: Spin
    fixed: Spin
    begin: Fraction
    end: Fraction
    #: The minimum gap; a negative value is a tolerated depth.
    min_gap: Fraction
    #: The sum of the radii of both bodies.
    swept: Fraction = Fraction()

    @property
    def core_gap(self) -> Fraction:
        """Returns the gap of the bodies without radius: the minimum gap plus both radii."""
        return self.min_gap + self.swept

    def gap(self, n: Vector, time: Fraction) -> Fraction:
        """Returns a lower bound of ``min_Q n.q - max_P n.p``."""
        p, q = self.moving, self.fixed
        highest, lowest = max(p.along(n, time)), min(q.along(n, time))
        between = q.foot(n, time) - p.foot(n, time)
        return between + lowest - highest - p.off(n) - q.off(n)

    def has_gap(self, plane: Plane) -> bool:
        """Checks whether a plane leaves its claimed gap beyond the minimum gap and the radii."""
        return plane.leaves(self.gap(plane.normal, plane.time), self.core_gap)

    def joins(self, a: Plane, b: Plane) -> bool:
        """Checks whether two planes prove all times between them.

        With ``n = (1 - x) n_a + x n_b`` a point ``y`` of a body has the height ``n . E y``, whose
        second derivative by ``x`` is ``-W . E y``. It exceeds its chord by at most ``C x (1 - x) /
        2``, and so does the maximum over all points. Together with the fixed body, with the
        opposite sign, and with ``n`` times the motion between the axes, the gap is at least ``(1 -
        x) a + x b - C x (1 - x) / 2``. Let ``G`` be the minimum gap plus the radii. ``G`` times the
        length of ``n`` is below its chord. If ``G`` is negative, because a depth is tolerated, this
        product exceeds its chord by at most ``-G |dn|^2 x (1 - x)``.
        """
        if a.time == b.time:
            return True
        if a.alone:
            return a.normal == b.normal and a.along > self.lost(a, b)
        if a.along > self.carried(a, b.time):
            return True
        dn = minus(b.normal, a.normal)
        drift = minus(self.fixed.way, self.moving.way)
        c = 2 * dot(dn, drift) * (b.time - a.time)
        if self.core_gap < 0:
            c -= 2 * self.core_gap * dot(dn, dn) * (1 + Fraction(1, 2**40))
        return any(
            stays(
                a.along,
                b.along,
                c
                + self.moving.curvature((a, b), 1, tightly)
                + self.fixed.curvature((a, b), -1, tightly),
            )
            for tightly in (False, True)
        )

    def lost(self, a: Plane, b: Plane) -> Fraction:
        """Returns a bound of the loss of a plane's gap, along its normal, until another plane."""
        drift = dot(a.normal, minus(self.fixed.way, self.moving.way)) * (b.time - a.time)
        risen = self.moving.rise(a.normal, a.time, b.time)
        sunk = self.fixed.rise(negative(a.normal), a.time, b.time)
        return risen + sunk - min(drift, Fraction())

    def carried(self, a: Plane, until: Fraction) -> Fraction:
        """Returns a bound of the loss of the gap of a plane that the moving body carries along.

        The bound is small if both bodies spin alike. The normal becomes ``E n``. In the frame that
        turns by ``E`` the moving body rests and the fixed one only translates: the vector between
        points of both axes and their drift turn by ``E'``. This leaves their parts along the axis
        unchanged, and their parts across it count along the part of ``n`` across it. With another
        angular velocity the points of the fixed body are displaced by the difference times their
        distance from the point of the axis.
        """
        p, q = self.moving, self.fixed
        h = until - a.time
        feet = [plus(minus(s.body.offset, s.arm), scaled(s.way, a.time - s.since)) for s in (p, q)]
        beside = p.across(minus(feet[1], feet[0]))
        swung = root_above(dot(beside, beside)) * min(abs(p.rate) * h, Fraction(2))
        drift = minus(q.way, p.way)
        sideways, n = p.across(drift), p.across(a.normal)
        lost = (swung + root_above(dot(sideways, sideways)) * h) * root_above(dot(n, n))
        along = dot(a.normal, p.axis) * dot(drift, p.axis) / p.square * h
        lost -= min(along, Fraction())
        if (p.axis, p.rate) != (q.axis, q.rate):
            spins = minus(scaled(q.axis, q.rate * q.inverse), scaled(p.axis, p.rate * p.inverse))
            room = 8 * _TINY * (abs(p.rate) + abs(q.rate))
            elsewhere = (root_above(dot(spins, spins)) + room) * h * q.reach
            lost += elsewhere * root_above(dot(a.normal, a.normal))
        return lost + 8 * p.off(a.normal)

    def ends(self, pairs: Any, time: Fraction) -> list[tuple[Vector, Vector]]:
        """Returns the points of pairs of vertices at a time."""
        p, q = self.moving, self.fixed
        named = vertex_pairs(pairs, len(p.body.points), len(q.body.points))
        return [(p.at(i, time), q.at(j, time)) for i, j in named]

    def check_contact(self, met: Any, time: Fraction) -> None:
        """Checks that the bodies overlap by more than tolerated, or are within the minimum gap."""
        off = sum((spin.off(_ONES) for spin in (self.moving, self.fixed)), Fraction())

        def ends(pairs: Any) -> list[tuple[Vector, Vector]]:
            return self.ends(pairs, time)

        def gap(n: Vector) -> Fraction:
            return self.gap(n, time) - off

        check_contact(met, ends, gap, (off, self.rounded()), self.min_gap, self.swept)

    def rounded(self) -> Fraction:
        """Returns a bound of the error of points in poses to which depths and distances refer."""
        spins = (self.moving, self.fixed)
        sizes = (s.reach + 2 * root_above(dot(s.arm, s.arm)) for s in spins)
        ways = (root_above(dot(s.way, s.way)) for s in spins)
        between = minus(self.fixed.body.offset, self.moving.body.offset)
        whole_ = sum(sizes, sum(ways, root_above(dot(between, between))))
        return _POSE * whole_


def follows(last: Spin, later: Spin) -> bool:
    """Checks whether a piece of a motion starts where the previous one ends, up to rounding."""

    def column(spin: Spin, k: int) -> Vector:
        x, y, z = (row[k] for row in spin.body.rows)
        return x, y, z

    def length(v: Vector) -> Fraction:
        return root_above(dot(v, v))

    def defect(spin: Spin) -> Fraction:
        columns = [column(spin, k) for k in range(3)]
        off = (dot(columns[i], columns[j]) - (i == j) for i, j in product(range(3), repeat=2))
        return root_above(sum((x * x for x in off), Fraction()))

    span, way = later.since - last.since, scaled(last.way, later.since - last.since)
    turned = (minus(last.turned(column(last, k), later.since), column(later, k)) for k in range(3))
    start, end = last.body.offset, later.body.offset
    reached = plus(plus(minus(start, last.arm), way), last.turned(last.arm, later.since))
    sizes = length(start) + length(end) + length(way)
    sizes += length(last.arm) * min(abs(last.rate * span), Fraction(2))
    return (
        max(abs(x) for v in turned for x in v) <= _JUMP + 4 * (defect(last) + defect(later))
        and length(minus(reached, end)) <= _JUMP * sizes
    )


def spans(
    movers: list[Any],
    points: Sequence[list[Vector]],
    min_gap: Fraction,
    swept: Fraction = _NO_GAP,
) -> list[Span]:
    """Returns the periods in which both bodies spin evenly, in order."""
    sides = []
    for of, own in zip(movers, points, strict=True):
        spins = [Spin.read(own, piece) for piece in listed(of["motion"])]
        times = [spin.since for spin in spins]
        if not times or times[0] != 0 or times[-1] >= 1 or sorted(set(times)) != times:
            raise NoProofError("the pieces of a motion are not in order, or do not start at 0")
        if not all(follows(last, later) for last, later in pairwise(spins)):
            raise NoProofError("a piece of a motion does not start where the previous one ends")
        sides.append(spins)
    borders = [*sorted({spin.since for side in sides for spin in side}), Fraction(1)]
    found = []
    for begin, end in pairwise(borders):
        p, q = (max((s for s in side if s.since <= begin), key=lambda s: s.since) for side in sides)
        found.append(Span(p, q, begin, end, min_gap, swept))
    return found


def chain(span: Span, planes: list[Plane]) -> Fraction:
    """Checks that each plane has its gap and joins the next one; returns the proven end time."""
    before = None
    for plane in planes:
        unit(plane.normal)
        at = float(plane.time)
        if not span.begin <= plane.time <= span.end or (before and plane.time < before.time):
            raise RefusedError(f"the plane at {at!r} is out of order")
        if plane.gap <= 0 or not span.has_gap(plane):
            raise RefusedError(f"the plane at {at!r} does not leave a gap of {float(plane.gap)!r}")
        if before is not None and not span.joins(before, plane):
            raise RefusedError(f"the times from {float(before.time)!r} to {at!r} are not proven")
        before = plane
    return span.begin if before is None else before.time


def convex_motion(file: File, movers: list[Any], query: Any, proof: Any, report: Report) -> None:
    """Checks the first contact of two moving convex bodies."""
    shapes = [file.shapes[of["body"]] for of in movers]
    if any(shape.facets for shape in shapes) or query["tolerance"] is not None:
        raise NoProofError("this claim needs convex bodies without a tolerance")
    min_gap = query["min_gap"]
    swept = shapes[0].radius + shapes[1].radius
    all_spans = spans(movers, [shape.points for shape in shapes], min_gap, swept)
    fields(proof, "spans meeting")
    claimed = listed(proof["spans"])
    if len(claimed) > len(all_spans):
        raise RefusedError("there are more spans than the motions have")
    reached = Fraction()
    for span, planes in zip(all_spans, claimed, strict=False):
        read = [Plane.read(plane) for plane in listed(planes)]
        if reached != span.begin or (read and read[0].time != span.begin):
            raise RefusedError("a span does not begin where the previous one ends")
        reached = chain(span, read)
    meet = "meet" if min_gap == 0 else f"are as near as {float(min_gap)!r}"
    if min_gap < 0:
        meet = f"overlap by more than {float(-min_gap)!r}"
    if any(claimed):
        period = "throughout the motion" if reached == 1 else f"up to the time {float(reached)!r}"
        report.holds.append(f"the bodies never {meet} {period}")
    meeting = proof["meeting"]
    if meeting is not None:
        time = number(fields(meeting, "time met")["time"])
        if not claimed or not reached <= time <= all_spans[len(claimed) - 1].end:
            raise RefusedError(
                f"the time at which the bodies {meet} does not follow the proven span"
            )
        all_spans[len(claimed) - 1].check_contact(meeting["met"], time)
        report.holds.append(f"the bodies {meet} at the time {float(time)!r}")


# Motions of solids
# -----------------


def node_of_tree(value: Any, end: int) -> int:
    """Returns a node of a tree in preorder: -1, or a facet index below ``end``."""
    return -1 if type(value) is int and value == -1 else whole(value, end)


def facet_numbers(numbers: Any, count: int) -> list[int]:
    """Returns the order of the facets of a body in a proof, which has each of them once."""
    found = [whole(k, count) for k in listed(numbers)]
    if sorted(found) != list(range(count)):
        raise RefusedError("the facets are not those of the body, each once")
    return found


def read_tree(
    leaves: Sequence[Sequence[Vector]],
) -> tuple[list[list[int]], list[Bounds[Fraction]]]:
    """Returns the children and the box of each node of a binary tree.

    The nodes are in preorder. ``leaves`` has the points of each leaf, and no point for a node with
    two children.
    """
    children: list[list[int]] = [[] for _ in leaves]
    boxes: list[Bounds[Fraction]] = [(_ZERO, _ZERO)] * len(leaves)
    # The nodes without a parent, among those read from the end.
    roots: list[int] = []
    for at in reversed(range(len(leaves))):
        if leaves[at]:
            boxes[at] = box_of(leaves[at])
        else:
            if len(roots) < 2:
                raise RefusedError("the nodes do not form a tree")
            children[at] = [roots.pop(), roots.pop()]
            boxes[at] = box_of([v for k in children[at] for v in boxes[k]])
        roots.append(at)
    if roots != [0]:
        raise RefusedError("the nodes do not form a tree")
    return children, boxes


def cyclic_orders(corners: Sequence[Vector]) -> list[Sequence[Vector]]:
    """Returns the corners of a facet, with each of them as the first one."""
    return [[*corners[k:], *corners[:k]] for k in range(len(corners))]


@dataclass
class Parts:
    """The facets of a solid, moved inwards as stored in the file, and their tree."""

    corners: list[Triangle]
    #: The facet of a leaf, or -1 for an inner node.
    facet: list[int]
    #: The two children of an inner node.
    children: list[list[int]]
    bounds: list[Bounds[Fraction]]
    #: Upper bound of the displacement of a corner.
    moved: Fraction
    #: The facets of closed surfaces, which have an interior.
    closed: list[Triangle]
    known: dict[tuple[int, Fraction], Spin] = field(default_factory=dict)

    @classmethod
    def read(
        cls,
        shape: Shape,
        of: Any,
    ) -> Parts:
        corners: list[Triangle] = []
        square = Fraction()
        fields(of, "numbers corners tree")
        numbers = facet_numbers(of["numbers"], len(shape.facets))
        for at, triangle in zip(numbers, listed(of["corners"]), strict=True):
            a, b, c = (vector(v) for v in triangle)
            corners.append((a, b, c))
            # The corners are in cyclic order, with any first corner.
            nominal = cyclic_orders([shape.points[k] for k in shape.facets[at]])
            moves = [
                max(dot(minus(u, v), minus(u, v)) for u, v in zip((a, b, c), order, strict=True))
                for order in nominal
            ]
            square = max(square, min(moves))
        facet = [node_of_tree(k, len(corners)) for k in listed(of["tree"])]
        if sorted(k for k in facet if k >= 0) != list(range(len(corners))):
            raise RefusedError("the parts of the body are not its facets, each once")
        children, bounds = read_tree([corners[k] if k >= 0 else () for k in facet])
        closed = [c for k, c in zip(numbers, corners, strict=True) if not shape.is_open[k]]
        return cls(corners, facet, children, bounds, root_above(square), closed)

    def points(self, node: int) -> list[Vector]:
        """Returns the corners of a facet, or of the box of an inner node."""
        if self.facet[node] >= 0:
            return list(self.corners[self.facet[node]])
        return box_corners(self.bounds[node])

    def below(self, node: int) -> list[Vector]:
        """Returns the corners of all facets of a node, each once."""
        open_, corners = [node], dict[Vector, None]()
        while open_:
            at = open_.pop()
            if self.facet[at] >= 0:
                corners.update(dict.fromkeys(self.corners[self.facet[at]]))
            else:
                open_ += self.children[at]
        return list(corners)

    def middle(self, node: int) -> Vector:
        points = self.points(node)
        total = _ZERO
        for v in points:
            total = plus(total, v)
        return scaled(total, Fraction(1, len(points)))

    def spin(self, node: int, spin: Spin) -> Spin:
        key = (node, spin.since)
        if key not in self.known:
            self.known[key] = spin.with_points(self.points(node))
        return self.known[key]

    def whole_spin(self, node: int, spin: Spin) -> Spin:
        """Returns the spin of all corners of the facets of a node."""
        if self.facet[node] >= 0:
            return self.spin(node, spin)
        return spin.with_points(self.below(node))


@dataclass
class Cover:
    """A check of all pairs of facets of two solids during a span, along the letters of a cover."""

    span: Span
    parts: tuple[Parts, Parts]

    def at(self, nodes: tuple[int, int]) -> Span:
        p, q = self.parts
        moving, fixed = p.spin(nodes[0], self.span.moving), q.spin(nodes[1], self.span.fixed)
        return replace(self.span, moving=moving, fixed=fixed)

    def whole(self, nodes: tuple[int, int]) -> Span:
        """Returns the span of all corners of the facets of two nodes."""
        p, q = self.parts
        moving = p.whole_spin(nodes[0], self.span.moving)
        fixed = q.whole_spin(nodes[1], self.span.fixed)
        return replace(self.span, moving=moving, fixed=fixed)

    def check(self, letters: str, lists: list[Any], until: Fraction) -> None:
        """Checks every entry of the cover, and that the entries cover all pairs."""
        if not isinstance(letters, str):
            raise NoProofError("a cover is not a text of letters")
        stack = [((0, 0), self.span.begin, until)]
        rest = iter(listed(lists))
        for number_, letter in enumerate(letters):
            if not stack:
                raise RefusedError("the cover has more entries than there are pairs")
            nodes, a, b = stack.pop()
            if letter == "T":
                half = Fraction(float(a) + 0.5 * (float(b) - float(a)))
                if not a <= half <= b:
                    raise RefusedError(f"entry {number_} cannot halve its time")
                stack += [(nodes, half, b), (nodes, a, half)]
            elif letter in "PQ":
                which = "PQ".index(letter)
                parts, at = self.parts[which], nodes[which]
                if parts.facet[at] >= 0:
                    raise RefusedError(f"entry {number_} splits a facet")
                both = parts.children[at]
                pairs = [(k, nodes[1]) if which == 0 else (nodes[0], k) for k in both]
                stack += [(pairs[1], a, b), (pairs[0], a, b)]
            elif letter == "L":
                planes = [Plane.read(plane) for plane in next(rest, [])]
                ends = (planes[0].time, planes[-1].time) if planes else None
                if ends != (a, b):
                    raise RefusedError(f"entry {number_} has no planes for its time")
                chain(replace(self.whole(nodes), begin=a, end=b), planes)
            elif not self.parted(letter, nodes, a, b):
                raise RefusedError(
                    f"entry {number_}: no plane {letter!r} separates the parts throughout"
                )
        if stack or next(rest, None) is not None:
            raise RefusedError("the cover does not end with all pairs")

    def parted(self, letter: str, nodes: tuple[int, int], a: Fraction, b: Fraction) -> bool:
        """Checks whether one normal, of any length, separates two nodes between two times."""
        span = self.at(nodes)
        n = self.normal(letter, nodes, span, (a, b))
        if not any(n):
            return False
        kept = span.core_gap * root_above(dot(n, n))
        ends = [Plane(time, n, span.gap(n, time) - kept, False) for time in (a, b)]
        if min(end.gap for end in ends) > 0 and span.joins(ends[0], ends[1]):
            return True
        # Try a normal that both bodies carry along.
        n = self.normal(letter, nodes, span, (a, a))
        gap = span.gap(n, a) - span.core_gap * root_above(dot(n, n))
        return gap > span.carried(Plane(a, n, gap, False), b)

    def normal(
        self, letter: str, nodes: tuple[int, int], span: Span, times: tuple[Fraction, Fraction]
    ) -> Vector:
        """Returns the normal of a letter, rounded; the proof is valid for any vector."""
        spins = (span.moving, span.fixed)

        def both(of: Callable[[Fraction], Vector]) -> Vector:
            return plus(of(times[0]), of(times[1]))

        def way(k: int, v: Vector) -> Vector:
            return both(lambda time: spins[k].turned(spins[k].body.turn(v), time))

        def edge(k: int, j: int) -> Vector:
            facet = self.parts[k].facet[nodes[k]]
            if facet < 0:
                raise RefusedError("an inner node has no edges")
            corners = self.parts[k].corners[facet]
            return way(k, minus(corners[(j + 1) % 3], corners[j]))

        middles = [spins[k].with_points([self.parts[k].middle(nodes[k])]) for k in (0, 1)]
        apart = both(lambda time: minus(middles[1].at(0, time), middles[0].at(0, time)))
        if letter == "m":
            n = apart
        elif letter in "abcxyz":
            at = "abcxyz".index(letter)
            n = way(at // 3, _UNITS[at % 3])
        elif letter in "pq":
            k = "pq".index(letter)
            n = cross(edge(k, 0), edge(k, 1))
        elif letter in "123456789":
            i, j = divmod("123456789".index(letter), 3)
            n = cross(edge(0, i), edge(1, j))
        else:
            raise NoProofError(f"unknown letter {letter!r} of a cover")
        x, y, z = (Fraction(float(v)) for v in n)
        return negative((x, y, z)) if dot((x, y, z), apart) < 0 else (x, y, z)


def certain(x: Vector, y: Vector, z: Vector, off: Fraction) -> int:
    """Returns the sign of a volume of vectors with errors below ``off``; 0 if it is not certain."""
    value = dot(cross(x, y), z)
    k, m, n = (max(abs(part) for part in v) + off for v in (x, y, z))
    error = 6 * off * (k * m + m * n + n * k)
    return 0 if abs(value) <= error else 1 if value > 0 else -1


def pierces(p: Vector, q: Vector, triangle: Triangle, off: Fraction) -> bool:
    """Checks whether a segment passes through a triangle, for all points within an error."""
    a, b, c = triangle
    below, above_ = (certain(minus(b, a), minus(c, a), minus(end, a), 2 * off) for end in (p, q))
    around = {
        certain(minus(q, p), minus(u, p), minus(v, p), 2 * off) for u, v in ((a, b), (b, c), (c, a))
    }
    return below * above_ < 0 and len(around) == 1 and 0 not in around


def solids_meet(span: Span, parts: tuple[Parts, Parts], meeting: Any) -> None:
    """Checks that two facets meet at a time."""
    time = number(fields(meeting, "time triangles met")["time"])
    numbers = [
        whole(k, len(side.corners))
        for k, side in zip(listed(meeting["triangles"]), parts, strict=True)
    ]
    spins = (span.moving, span.fixed)
    own, other = (side.corners[k] for side, k in zip(parts, numbers, strict=True))
    f, g = spins[0].facets([own], time)[0], spins[1].facets([other], time)[0]
    size = max(abs(x) for v in (*f, *g) for x in v)
    size += spins[0].with_points(list(own)).reach + spins[1].with_points(list(other)).reach
    off = size * _SURE
    kind, claim = one_of(meeting["met"], "crossing", "near", "inside", "contained")
    if kind == "crossing" and span.core_gap == 0:
        fields(claim, "moving edge")
        piercing, pierced = (f, g) if truth(claim["moving"]) else (g, f)
        k = whole(claim["edge"], 3)
        if not pierces(piercing[k], piercing[(k + 1) % 3], pierced, off):
            raise RefusedError("the edge does not pass through the facet")
    elif kind == "near" and span.core_gap > 0:
        fields(claim, "weights")
        p, q = (
            mean(side, weights)
            for side, weights in zip((f, g), listed(claim["weights"], 2), strict=True)
        )
        if not is_within(p, q, span.core_gap - 4 * off):
            raise RefusedError(f"the points are not as near as {float(span.core_gap)!r}")
    elif kind == "inside" and span.core_gap == 0:
        at = bounded_vector(fields(claim, "point")["point"], "the point")
        if not (parts[0].closed and parts[1].closed):
            raise RefusedError("open surfaces have no interior")
        there = span.fixed.with_points([at]).at(0, time)
        if not is_around(span.moving.facets(parts[0].closed, time), there, 4 * off):
            raise RefusedError("the point is not inside the moving solid")
        if not is_around(parts[1].closed, at, Fraction()):
            raise RefusedError("the point is not inside the fixed solid")
    elif kind == "contained" and span.core_gap == 0:
        fields(claim, "moving weights")
        which = 1 if truth(claim["moving"]) else 0
        closed = parts[which].closed
        if not closed:
            raise RefusedError("open surfaces have no interior")
        point = mean((f, g)[1 - which], claim["weights"])
        if not is_around(spins[which].facets(closed, time), point, 4 * off):
            raise RefusedError("the point of the facet is not inside the other solid")
    else:
        raise RefusedError(f"{kind!r} does not prove that the solids meet")


def check_start(span: Span, parts: tuple[Parts, Parts]) -> None:
    """Checks that no shell is inside the other solid at the start, where surfaces do not meet."""
    spins = (span.moving, span.fixed)
    for own, other in ((0, 1), (1, 0)):
        shells_of = spins[own].facets(parts[own].corners, Fraction())
        if is_nested(shells_of, spins[other].facets(parts[other].closed, Fraction())):
            raise RefusedError("a shell is inside the other solid at the start of the motion")


def check_tolerance(queried: Any, claimed: Fraction, parts: tuple[Parts, Parts]) -> None:
    """Checks that the proof has the tolerance of the query, and without one moves no facet."""
    if bounded(claimed, MOST, "the tolerance") < 0:
        raise NoProofError(f"a tolerance of {float(claimed)!r} is negative")
    if queried is not None and number(queried) != claimed:
        raise RefusedError(
            f"the tolerance of the proof is not the query's, {float(number(queried))!r}"
        )
    if claimed == 0 and any(side.moved for side in parts):
        raise RefusedError("facets are moved although the tolerance is 0")


def solid_motion(file: File, movers: list[Any], query: Any, claim: Any, report: Report) -> None:
    """Checks the first contact of two moving solids, with facets moved inwards as in the file."""
    fields(claim, "parts proof")
    proof = fields(claim["proof"], "tolerance start spans meeting")
    shapes = [file.shapes[of["body"]] for of in movers]
    if any(shape.is_convex for shape in shapes):
        raise NoProofError("the bodies are not made of facets")
    p, q = (Parts.read(*of) for of in zip(shapes, listed(claim["parts"]), strict=True))
    parts = (p, q)
    check_tolerance(query["tolerance"], number(proof["tolerance"]), parts)
    min_gap = query["min_gap"]
    if min_gap < 0:
        raise NoProofError("the minimum gap is negative")
    swept = shapes[0].radius + shapes[1].radius
    all_spans = spans(movers, [[_ZERO], [_ZERO]], min_gap, swept)
    meet = "meet" if min_gap == 0 else f"are as near as {float(min_gap)!r}"
    moved = float(max(side.moved for side in parts))
    of = f"the facets, moved by at most {moved:.3g}," if moved else "the facets"
    of = f"{of} with radii of {float(swept)!r} together" if swept else of
    claimed = listed(proof["spans"])
    if proof["start"] == "assumed":
        raise RefusedError("it is not proven whether the solids overlap at the start of the motion")
    begin = overlap_of(proof["start"], (len(p.corners), len(q.corners)), "apart")
    if begin != "apart":
        if claimed or proof["meeting"] is not None:
            raise RefusedError("the solids overlap at the start, but the file has other claims")
        report.unchecked.append("that they overlap at the start of the motion")
        report.partly = True
        return
    if len(claimed) > len(all_spans):
        raise RefusedError("there are more spans than the motions have")
    reached = Fraction()
    for span, claim in zip(all_spans, claimed, strict=False):
        until = number(fields(claim, "until cover lists")["until"])
        if reached != span.begin or not span.begin <= until <= span.end:
            raise RefusedError("a span does not begin where the previous one ends")
        if until > span.begin:
            Cover(span, parts).check(claim["cover"], claim["lists"], until)
        elif claim["cover"] != "" or listed(claim["lists"]):
            raise RefusedError("a span of length 0 has entries")
        reached = until
    if reached == 0:
        report.unchecked.append("that they do not overlap at the start of the motion")
        report.partly = True
    else:
        period = "throughout the motion" if reached == 1 else f"up to the time {float(reached)!r}"
        report.holds.append(f"{of} never {meet} {period}")
        if any(shape.has_open_area() for shape in shapes):
            report.unchecked.append(
                "whether one is inside the other at the start: surfaces are open"
            )
            report.partly = True
        else:
            check_start(all_spans[0], parts)
            report.holds.append("neither of them is inside the other at the start of the motion")
    meeting = proof["meeting"]
    if meeting is not None:
        time = number(meeting["time"])
        if not claimed or not reached <= time <= all_spans[len(claimed) - 1].end:
            raise RefusedError(f"the time at which they {meet} does not follow the proven span")
        solids_meet(all_spans[len(claimed) - 1], parts, meeting)
        report.holds.append(f"{of} {meet} at the time {float(time)!r}")
    if moved:
        report.unchecked.append("whether facets were moved inwards as the tolerance says")
        report.partly = True


def check_motions(file: File, claims: Any, report: Report) -> None:
    """Checks the first contact among several pairs of bodies, convex or solid."""
    placed, queries = listed(file.placement), []
    for of in listed(file.query):
        fields(of, "min_gap", "tolerance")
        min_gap = bounded(number(of["min_gap"]), MOST, "the gap to be kept")
        queries.append({"min_gap": min_gap, "tolerance": of.get("tolerance")})
    pairs = list(zip(placed, queries, listed(claims), strict=True))
    if not pairs:
        raise NoProofError("there is no pair of bodies")
    least = min(of["min_gap"] for of in queries)
    for number_, (movers, of, claim) in enumerate(pairs):
        for mover in listed(movers, 2):
            file.number(fields(mover, "body motion")["body"])
        kind, proof = one_of(claim, "convex", "solids")
        # Solids that are apart by a larger gap are also apart by the smallest one.
        if kind == "convex" and of["min_gap"] != least:
            raise NoProofError("convex pairs have different minimum gaps")
        found = Report()
        if kind == "convex":
            convex_motion(file, movers, of, proof, found)
        else:
            solid_motion(file, movers, of, proof, found)
            if len(pairs) > 1 and number(proof["proof"]["tolerance"]) != 0:
                raise NoProofError("one of several pairs of solids has a tolerance other than 0")
        pair = f"pair {number_}: " if len(pairs) > 1 else ""
        report.holds += [f"{pair}{line}" for line in found.holds]
        report.unchecked += [f"{pair}{line}" for line in found.unchecked]
        report.partly = report.partly or found.partly
        if pair and not found.holds:
            report.unchecked.append(f"{pair}nothing is proven about it")
            report.partly = True


# Paths of joints
# ---------------

#: Maximum number of pairs of bodies named in a line.
NAMED = 12
#: Binary digits to which rotations are rounded; the error is negligible compared with `_SURE`.
_KEPT = 256


def rounded_down(v: Vector) -> Vector:
    x, y, z = (Fraction(math.floor(c * (1 << _KEPT)), 1 << _KEPT) for c in v)
    return x, y, z


@dataclass(frozen=True)
class Stage:
    """A frame in its parent, and the joint that moves it by the values of a column."""

    origin: Body
    kind: str
    axis: Vector
    column: int


@dataclass
class Field:
    """The pose of a body and the motion of its points: ``p' = v + w x p`` and ``p'' = a + A p``."""

    #: The axes of the body frame, and its origin.
    columns: tuple[Vector, Vector, Vector]
    origin: Vector
    v: Vector
    w: Vector
    a: Vector
    #: The columns of ``A``.
    matrix: tuple[Vector, Vector, Vector]

    def place(self, p: Vector) -> Vector:
        x, y, z = self.columns
        return plus(self.origin, plus(scaled(x, p[0]), plus(scaled(y, p[1]), scaled(z, p[2]))))

    def facets(self, facets: list[Triangle]) -> list[Triangle]:
        """Returns facets of the body in the world."""
        return [(self.place(a), self.place(b), self.place(c)) for a, b, c in facets]

    def height_curvature(self, p: Vector, n: Vector, dn: Vector) -> Fraction:
        """Returns ``n . p'' + 2 dn . p'`` for a point at its current position."""
        x, y, z = self.matrix
        second = plus(self.a, plus(scaled(x, p[0]), plus(scaled(y, p[1]), scaled(z, p[2]))))
        return dot(n, second) + 2 * dot(dn, plus(self.v, cross(self.w, p)))


@dataclass
class Pieces:
    """The pieces of a body: itself, the boxes of its tree, and its facets.

    A convex body is its only piece.
    """

    #: For each piece its points, or the corners of its box.
    points: list[list[Vector]]
    #: The children of each piece.
    below: list[list[int]]
    #: The facets of a solid.
    facets: list[Triangle] = field(default_factory=list)
    #: The facets of closed surfaces, which have an interior.
    closed: list[Triangle] = field(default_factory=list)
    #: Whether the body has an open surface with an area.
    is_open: bool = False
    #: For a convex body triples of corners that form tetrahedra with its first point.
    fans: list[tuple[int, int, int]] = field(default_factory=list)

    @classmethod
    def read(cls, shape: Shape, of: Any) -> Pieces:
        if shape.is_convex:
            # Any corners are valid: a point inside a tetrahedron of vertices is inside the shape.
            fans = [(face[0], a, b) for face in shape.faces for a, b in pairwise(face[1:])]
            return cls([shape.points], [[]], fans=fans)
        fields(of, "numbers tree")
        numbers = facet_numbers(of["numbers"], len(shape.facets))
        facets: list[Triangle] = []
        for at in numbers:
            a, b, c = (shape.points[k] for k in shape.facets[at])
            facets.append((a, b, c))
        tree = [node_of_tree(k, len(facets) + 1) for k in listed(of["tree"])]
        if 0 in tree:
            raise RefusedError("the nodes do not form a tree")
        leaves: list[list[int]] = []
        used = 0
        for count in (max(k, 0) for k in tree):
            leaves.append([len(tree) + k for k in range(used, used + count)])
            used += count
        if used != len(facets):
            raise RefusedError("the parts of the body are not its facets, each once")
        corners = [list(facet) for facet in facets]
        children, bounds = read_tree(
            [[v for k in leaf for v in corners[k - len(tree)]] for leaf in leaves]
        )
        below = [leaf or parts for leaf, parts in zip(leaves, children, strict=True)]
        return cls(
            [box_corners(box) for box in bounds] + corners,
            below + [[] for _ in facets],
            facets,
            [facet for k, facet in zip(numbers, facets, strict=True) if not shape.is_open[k]],
            shape.has_open_area(),
        )


@dataclass
class Carried:
    """A body at the end of a chain of joints, in a frame that it shares with another body."""

    stages: list[Stage]
    body: Body
    rows: list[list[Fraction]]
    #: For each turning joint an upper bound of the distance of the body from its axis.
    levers: list[Fraction] = field(default_factory=list)
    #: Upper bound of the distance of any point from the start of the chain.
    size: Fraction = Fraction(1)
    known: dict[tuple[int, Fraction], Field] = field(default_factory=dict)

    def __post_init__(self) -> None:
        points = [self.body.at(k) for k in range(len(self.body.points))]
        whole_ = root_above(max(dot(p, p) for p in points))
        beyond: tuple[Vector, Fraction] | None = None
        for stage in reversed(self.stages):
            lever = Fraction()
            if stage.kind == "turning":
                beside = [cross(stage.axis, p) for p in points]
                if beyond is not None:
                    beside = [cross(stage.axis, beyond[0])]
                lever = root_above(max(dot(v, v) for v in beside) / dot(stage.axis, stage.axis))
                lever += beyond[1] if beyond is not None else 0
            self.levers.append(lever)
            slides = Fraction()
            if stage.kind == "sliding":
                slides = max(abs(row[stage.column]) for row in self.rows)
            beyond = (stage.origin.offset, slides + whole_)
            whole_ += slides + root_above(dot(stage.origin.offset, stage.origin.offset))
        self.levers.reverse()
        self.size = whole_ + 1

    def rounded(self) -> Fraction:
        """Returns a bound of the error of points in poses to which depths and distances refer."""
        values = [abs(row[s.column]) for row in self.rows for s in self.stages if s.kind != "fixed"]
        return _POSE * self.size * (1 + len(self.stages)) * (1 + max(values, default=Fraction()))

    def rate(self, row: int, stage: Stage) -> Fraction:
        """Returns the increase of a joint's value from a row to the next one."""
        if row + 1 >= len(self.rows):
            return Fraction()
        return self.rows[row + 1][stage.column] - self.rows[row][stage.column]

    def at(self, row: int, share: Fraction) -> Field:
        """Returns the pose and the motion of the body at a fraction of a step."""
        if (row, share) in self.known:
            return self.known[row, share]
        axes, origin = _UNITS, _ZERO
        v = w = a = _ZERO
        matrix = (_ZERO, _ZERO, _ZERO)

        def turned(u: Vector, axes: tuple[Vector, Vector, Vector]) -> Vector:
            x, y, z = axes
            return plus(scaled(x, u[0]), plus(scaled(y, u[1]), scaled(z, u[2])))

        for stage in self.stages:
            origin = plus(origin, turned(stage.origin.offset, axes))
            x, y, z = (rounded_down(turned(stage.origin.turn(e), axes)) for e in _UNITS)
            axes = (x, y, z)
            if stage.kind == "fixed":
                continue
            rate = self.rate(row, stage)
            value = self.rows[row][stage.column] + share * rate
            unit_ = scaled(stage.axis, 1 / root_above(dot(stage.axis, stage.axis)))
            along = turned(unit_, axes)
            spin = scaled(along, rate)
            if stage.kind == "sliding":
                v = plus(v, spin)
                a = plus(a, scaled(cross(w, spin), Fraction(2)))
                origin = rounded_down(plus(origin, scaled(along, value)))
                continue
            # The joint moves p by spin x (p - origin); earlier joints turn this by B.
            before = plus(scaled(w, Fraction(2)), spin)
            v = minus(v, cross(spin, origin))
            a = minus(a, cross(before, cross(spin, origin)))
            x, y, z = (
                plus(column, cross(before, cross(spin, e)))
                for column, e in zip(matrix, _UNITS, strict=True)
            )
            matrix = (x, y, z)
            w = plus(w, spin)
            sin, cos = sine_cosine(value)
            x, y, z = (
                plus(
                    plus(e, scaled(cross(unit_, e), sin)),
                    scaled(cross(unit_, cross(unit_, e)), 1 - cos),
                )
                for e in _UNITS
            )
            x, y, z = (rounded_down(turned(e, axes)) for e in (x, y, z))
            axes = (x, y, z)
        origin = plus(origin, turned(self.body.offset, axes))
        x, y, z = (turned(self.body.turn(e), axes) for e in _UNITS)
        found = Field((x, y, z), origin, v, w, a, matrix)
        self.known[row, share] = found
        return found

    def most(self, row: int) -> tuple[Fraction, Fraction, Fraction]:
        """Returns upper bounds of the first three derivatives of points, within a row."""
        before, most = Fraction(), [Fraction()] * 3
        for stage, lever in zip(self.stages, self.levers, strict=True):
            if stage.kind == "fixed":
                continue
            rate = abs(self.rate(row, stage))
            after = before + rate
            for k in range(3):
                if stage.kind == "turning":
                    most[k] += (after ** (k + 1) - before ** (k + 1)) * lever
                else:
                    most[k] += (k + 1) * before**k * rate
            before = after if stage.kind == "turning" else before
        # Rotations are exact up to rounding; larger deviations are rejected when poses are read.
        first, second, third = (x * (1 + 4 * len(self.stages) * _TURN) for x in most)
        return first, second, third

    def third_along(self, row: int, normals: Sequence[Vector]) -> Fraction:
        """Returns an upper bound of the third derivative of heights along normals between two.

        Each of its terms begins with the angular velocity of its first joint, so along ``n`` it has
        the part of ``n`` across that axis as a factor. Two consecutive turning joints keep the
        angle between their axes, and the sine of a sum of angles is at most the sum of the sines.
        """
        if not self.stages:
            return Fraction()
        off = 16 * (len(self.stages) + 1) * max(of.origin.skew() for of in self.stages)
        longest = root_above(max(dot(n, n) for n in normals))
        axis: Vector | None = None
        between: list[Body] = []
        along, third = Fraction(), Fraction()
        turning: list[tuple[Fraction, Fraction]] = []
        for stage, lever in zip(self.stages, self.levers, strict=True):
            between.append(stage.origin)
            if stage.kind == "fixed":
                continue
            rate, later = abs(self.rate(row, stage)), Fraction()
            for first, share in reversed(turning):
                if stage.kind == "sliding":
                    third += 3 * share * rate * first * (2 * later + first)
                else:
                    third += 3 * share * first * rate * (2 * later + first + rate) * lever
                later += first
            if stage.kind == "sliding":
                continue
            there = stage.axis
            for origin in reversed(between):
                there = origin.turn(there)
            before = normals if axis is None else [scaled(axis, longest)]
            square = dot(there, there) * (1 if axis is None else dot(axis, axis))
            aside = max(dot(v, v) for v in (cross(n, there) for n in before))
            along += root_above(aside / square) + off * longest
            share = min(along, longest)
            third += share * rate**3 * lever
            turning.append((rate, share))
            axis, between = stage.axis, []
        return third * (1 + off)


@dataclass
class PiecePair:
    """Two convex pieces of bodies on chains of joints."""

    moving: Carried
    fixed: Carried
    min_gap: Fraction
    own: Sequence[Vector]
    other: Sequence[Vector]
    #: Upper bound of the distance of the input of both bodies beyond their vertices.
    left_out: Fraction

    @property
    def swept(self) -> Fraction:
        """Returns the sum of the radii of both bodies."""
        return radii(self.moving.body, self.fixed.body)

    def off(self) -> Fraction:
        """Returns a bound of the error of heights from sines, roots and rotations."""
        return (self.moving.size + self.fixed.size) * 64 * _SURE

    def rounded(self) -> Fraction:
        """Returns a bound of the error of points in poses to which depths and distances refer."""
        return self.moving.rounded() + self.fixed.rounded()

    def gap(self, n: Vector, row: int, share: Fraction) -> Fraction:
        p, q = (of.at(row, share) for of in (self.moving, self.fixed))
        high = max(dot(n, p.place(v)) for v in self.own)
        low = min(dot(n, q.place(v)) for v in self.other)
        return low - high - self.off() - self.left_out

    def has_gap(self, plane: Plane, row: int) -> bool:
        unit(plane.normal)
        along = self.gap(plane.normal, row, plane.time)
        return plane.gap > 0 and plane.leaves(along, self.min_gap + self.swept)

    def joins(self, row: int, a: Plane, b: Plane) -> bool:
        """Checks whether two planes of a row prove everything between them.

        Let ``n(x)`` be the normal between both planes, ``x`` from 0 to 1. Along it the height of a
        point has the second derivative ``h^2 n . p'' + 2 h dn . p'``. The derivative of this
        second derivative is at most ``h^3`` times the third derivative of ``n . p``, plus
        ``3 h^2 |dn| |p''|``. Therefore the second derivative never exceeds the mean of its values
        at both ends plus half of that bound.
        """
        h = b.time - a.time
        if h == 0:
            return True
        dn = minus(b.normal, a.normal)
        beside = root_above(dot(dn, dn))
        longest = root_above(max(dot(a.normal, a.normal), dot(b.normal, b.normal)))
        c = Fraction()
        for of, points, sign in ((self.moving, self.own, -1), (self.fixed, self.other, 1)):
            first, second, third = of.most(row)
            third = min(longest * third, of.third_along(row, (a.normal, b.normal)))
            loose = h * h * longest * second + 2 * h * beside * first
            ends = []
            for plane in (a, b):
                found = of.at(row, plane.time)
                n, along = scaled(plane.normal, sign * h * h), scaled(dn, sign * h)
                ends.append(max(found.height_curvature(found.place(v), n, along) for v in points))
            changes = h * h * (h * third + 3 * beside * second)
            room = 64 * _SURE * of.size * (1 + sum(of.most(row)))
            c += min(loose, (ends[0] + ends[1] + changes) / 2 + room)
        return stays(a.along, b.along, c)

    def way(self, row: int) -> Fraction:
        return self.moving.most(row)[0] + self.fixed.most(row)[0]

    def between(self, a: tuple[int, Fraction], b: tuple[int, Fraction]) -> Fraction:
        """Returns a bound of the motion of points of both bodies from one place to another."""
        if a[0] == b[0]:
            return (b[1] - a[1]) * self.way(a[0])
        rows = sum((self.way(row) for row in range(a[0] + 1, b[0])), Fraction())
        return (1 - a[1]) * self.way(a[0]) + rows + b[1] * self.way(b[0])

    def check_contact(self, met: Any, row: int, share: Fraction) -> None:
        """Checks that the pieces overlap at a place, or are within the minimum gap."""
        p, q = (of.at(row, share) for of in (self.moving, self.fixed))
        own, other = self.own, self.other

        def ends(pairs: Any) -> list[tuple[Vector, Vector]]:
            named = vertex_pairs(pairs, len(own), len(other))
            return [(p.place(own[i]), q.place(other[j])) for i, j in named]

        def gap(n: Vector) -> Fraction:
            return self.gap(n, row, share)

        check_contact(met, ends, gap, (self.off(), self.rounded()), self.min_gap, self.swept)


def settled(row: int, share: Fraction) -> tuple[int, Fraction]:
    """Returns a place in normal form: the end of a row is the beginning of the next one."""
    return (row + 1, Fraction()) if share == 1 else (row, share)


def place_of(of: Any, last: int) -> tuple[int, Fraction]:
    """Returns a place on a path: a row, and a fraction from 0 to 1 of the step to the next row."""
    fields(of, "row share")
    row, share = whole(of["row"], last + 1), number(of["share"])
    if not 0 <= share <= 1 or (row == last and share):
        raise RefusedError(f"a fraction of {float(share)!r} after row {row} is not on the path")
    return row, share


def is_inside_fans(at: Vector, corners: list[Vector], fans: list[tuple[int, int, int]]) -> bool:
    """Checks whether a point is inside a tetrahedron of the first corner and three others."""
    ways = [minus(corner, at) for corner in corners]
    return any(encloses([ways[0], ways[a], ways[b], ways[c]]) for a, b, c in fans)


def has_planes(steps: Any) -> bool:
    """Checks whether a valid cover proves that two pieces do not meet where it begins."""
    kinds = [one_of(step, "planes", "parts") for step in listed(steps)]
    return any(
        bool(claim)
        if kind == "planes"
        else all(has_planes(cover["steps"]) for cover in listed(claim["covers"]))
        for kind, claim in kinds
    )


def planes_of_path(
    pair: PiecePair, stretches: Any, here: tuple[int, Fraction], last: int
) -> tuple[int, Fraction]:
    """Returns up to which place planes prove that two pieces do not meet, starting from a place."""
    before = None
    for stretch in stretches:
        row = whole(fields(stretch, "row planes")["row"], last + 1)
        planes = [Plane.read(plane) for plane in listed(stretch["planes"])]
        if not planes or any(plane.alone for plane in planes):
            raise RefusedError(f"the planes of row {row} are out of order")
        times = [plane.time for plane in planes]
        if sorted(times) != times or times[0] < 0 or times[-1] > 1:
            raise RefusedError(f"the planes of row {row} are out of order")
        if settled(row, times[-1]) > (last, Fraction()):
            raise RefusedError("a plane is beyond the end of the path")
        if before is None:
            if settled(row, times[0]) != here:
                raise RefusedError(f"the planes of row {row} do not begin where others end")
        else:
            (place, gap), next_ = before, (row, times[0])
            far = place <= next_ and pair.between(place, next_) < gap + planes[0].along
            if place > next_ or (settled(*place) != settled(*next_) and not far):
                raise RefusedError(f"the path before row {row} is not proven")
        for k, plane in enumerate(planes):
            if not pair.has_gap(plane, row):
                gap_ = float(plane.gap)
                raise RefusedError(f"a plane of row {row} does not leave a gap of {gap_!r}")
            if k and not pair.joins(row, planes[k - 1], plane):
                raise RefusedError(f"two planes of row {row} do not prove the path between them")
        before = ((row, times[-1]), planes[-1].along)
    if before is not None:
        here = settled(*before[0])
    return here


@dataclass
class PathPair:
    """Two bodies along a path, with the tree of pieces of their cover."""

    moving: Carried
    fixed: Carried
    min_gap: Fraction
    pieces: tuple[Pieces, Pieces]
    #: Upper bound of the distance of the input of both bodies beyond their vertices.
    left_out: Fraction
    #: The last row.
    last: int

    def piece_pair(self, numbers: tuple[int, int]) -> PiecePair:
        own, other = (side.points[k] for side, k in zip(self.pieces, numbers, strict=True))
        return PiecePair(self.moving, self.fixed, self.min_gap, own, other, self.left_out)

    def cover(
        self,
        steps: Any,
        numbers: tuple[int, int],
        here: tuple[int, Fraction],
        until: tuple[int, Fraction],
    ) -> tuple[int, Fraction]:
        """Returns the place, at most ``until``, up to which a cover proves no contact."""
        both = self.piece_pair(numbers)
        for step in listed(steps):
            kind, claim = one_of(step, "planes", "parts")
            if kind == "planes":
                here = planes_of_path(both, claim, here, self.last)
                continue
            which = whole(fields(claim, "which until covers")["which"], 2)
            place = settled(*place_of(claim["until"], self.last))
            below, covers = self.pieces[which].below[numbers[which]], listed(claim["covers"])
            if not below or len(below) != len(covers) or place < here:
                raise RefusedError("a piece is divided without all of its parts")
            reached = place
            for part, cover in zip(below, covers, strict=True):
                pair = (part, numbers[1]) if which == 0 else (numbers[0], part)
                steps_ = fields(cover, "steps")["steps"]
                reached = min(reached, self.cover(steps_, pair, here, place))
            if reached < place:
                return reached
            here = place
        return min(here, until)

    def is_nested(self, everywhere: bool = False) -> bool:
        """Checks whether one body has a corner inside the other at the start of the path.

        One corner of each shell is tested. This suffices if no surfaces meet, because then either
        all corners of a shell are inside or none. With ``everywhere`` all corners are tested.
        """
        fields_ = [of.at(0, Fraction()) for of in (self.moving, self.fixed)]
        for own, other in ((0, 1), (1, 0)):
            mine, there = self.pieces[own], self.pieces[other]
            first = fields_[own].place(mine.points[0][0])
            points = shells(fields_[own].facets(mine.facets)) if mine.facets else [first]
            if everywhere:
                corners = [v for facet in mine.facets for v in facet] or mine.points[0]
                points = [fields_[own].place(v) for v in corners]
            if there.facets:
                around = fields_[other].facets(there.closed)
                inside = any(winds(v, around) > 0 for v in points)
            else:
                corners = [fields_[other].place(v) for v in there.points[0]]
                inside = any(is_inside_fans(v, corners, there.fans) for v in points if mine.facets)
            if inside:
                return True
        return False


def is_in_both(walk: PathPair, point: Vector, row: int, share: Fraction) -> None:
    """Checks that a point in the second body's frame is inside both solids at a place."""
    own, other = walk.pieces
    if walk.min_gap or not (own.closed and other.closed):
        raise RefusedError(
            "a point proves nothing for open surfaces, convex bodies, or a minimum gap"
        )
    p, q = (of.at(row, share) for of in (walk.moving, walk.fixed))
    if not is_around(p.facets(own.closed), q.place(point), 4 * walk.piece_pair((0, 0)).off()):
        raise RefusedError("the point is not inside the first solid")
    if not is_around(other.closed, point, Fraction()):
        raise RefusedError("the point is not inside the second solid")


def pieces_meet(walk: PathPair, how: Any, row: int, share: Fraction) -> None:
    """Checks that two pieces, whole bodies or facets, meet at a place."""
    kind, claim = one_of(how, "pieces", "point")
    fields(claim, "pieces met" if kind == "pieces" else "pieces point")
    i, j = (
        whole(k, len(side.points))
        for k, side in zip(listed(claim["pieces"]), walk.pieces, strict=True)
    )
    if walk.pieces[0].below[i] or walk.pieces[1].below[j]:
        raise RefusedError("a piece in contact has parts of its own")
    if kind == "point":
        is_in_both(walk, bounded_vector(claim["point"], "the point"), row, share)
        return
    pair, refused = walk.piece_pair((i, j)), RefusedError("the pieces have no points")
    # The file does not define which corner of a facet is the first one.
    orders = [
        cyclic_orders(points) if side.facets else [points]
        for points, side in zip((pair.own, pair.other), walk.pieces, strict=True)
    ]
    for first, second in product(*orders):
        try:
            replace(pair, own=first, other=second).check_contact(claim["met"], row, share)
        except RefusedError as error:
            refused = error
        else:
            return
    raise refused


@dataclass
class Robot:
    """A tree of frames, the bodies that they carry, and the pairs of bodies of a proof."""

    frames: list[Stage]
    parents: list[int | None]
    rows: list[list[Fraction]]
    times: list[Fraction]
    #: For each body the frames that carry it, and the body in the last one.
    bodies: list[tuple[list[int], Body]]
    pieces: list[Pieces]
    #: For each body an upper bound of the distance of its input beyond its vertices.
    left_out_of: list[Fraction]
    names: list[str]
    pairs: list[tuple[int, int]]

    @classmethod
    def read(cls, file: File, claim: Any) -> Robot:
        placement, joints = fields(file.placement, "frames bodies"), file.query["path"]
        fields(joints, "times rows")
        rows = [[number(x) for x in row] for row in listed(joints["rows"])]
        times = [bounded(number(x), MOST, "a time") for x in listed(joints["times"])]
        if not rows or len(times) != len(rows) or any(b <= a for a, b in pairwise(times)):
            raise NoProofError("the times of the rows do not increase")
        frames: list[Stage] = []
        parents: list[int | None] = []
        column = 0
        for k, frame in enumerate(listed(placement["frames"])):
            fields(frame, "parent origin joint")
            parent, joint = frame["parent"], frame["joint"]
            parents.append(None if parent is None else whole(parent, k))
            origin = Body.placed(Shape([_ZERO]), frame["origin"])
            if joint == "fixed":
                frames.append(Stage(origin, "fixed", _UNITS[0], 0))
                continue
            kind, axis = one_of(joint, "turning", "sliding")
            unit(vector(axis), f"the axis of joint {column}")
            frames.append(Stage(origin, kind, vector(axis), column))
            column += 1
        if any(len(row) != column for row in rows):
            raise NoProofError("a row does not have a value for each joint")
        for stage in frames:
            if stage.kind != "fixed":
                most = _MOST_TURN if stage.kind == "turning" else MOST
                for row in rows:
                    bounded(row[stage.column], most, "the value of a joint")
        robot = cls(frames, parents, rows, times, [], [], [], [], [])
        parts = listed(claim["parts"], len(file.shapes))
        for k, (shape, own) in enumerate(zip(file.shapes, parts, strict=True)):
            if shape.is_convex == (own is not None):
                raise NoProofError(
                    f"body {k}: parts are given for a convex body, or missing for a solid"
                )
        for of in listed(placement["bodies"]):
            robot.add(file, fields(of, "body name frame pose"), parts)
        numbers = {name: k for k, name in enumerate(robot.names)}
        for a, b in (listed(pair, 2) for pair in listed(claim["pairs"])):
            if a not in numbers or b not in numbers or a == b:
                raise NoProofError(f"{a!r} and {b!r} are not the names of two bodies")
            robot.pairs.append((numbers[a], numbers[b]))
        return robot

    def add(self, file: File, of: Any, parts: list[Any]) -> None:
        """Adds a body of the file."""
        name, body = of["name"], file.placed(of)
        if not is_text(name) or not name or name in self.names:
            raise NoProofError(f"{name!r} is not a name, or names several bodies")
        way = [] if of["frame"] is None else [whole(of["frame"], len(self.frames))]
        while way and (parent := self.parents[way[-1]]) is not None:
            way.append(parent)
        self.names.append(name)
        self.bodies.append((way[::-1], body))
        if self.reach(len(self.bodies) - 1) > MOST:
            raise NoProofError(f"{name!r} can be farther than 2^200 from the root of its frames")
        self.pieces.append(Pieces.read(body.shape, parts[of["body"]]))
        self.left_out_of.append(body.shape.hull_error)

    def reach(self, k: int) -> float:
        """Returns an upper bound of the distance of a body from the root of its frames, rounded."""
        way, body = self.bodies[k]
        rows, offset = (
            [[float(x) for x in row] for row in body.rows],
            [float(x) for x in body.offset],
        )
        reach = 0.0
        for point in body.points:
            v = [float(x) for x in point]
            at = [_along(row, (0.0, 0.0, 0.0), v) + x for row, x in zip(rows, offset, strict=True)]
            reach = max(reach, math.hypot(*at))
        for stage in (self.frames[frame] for frame in reversed(way)):
            reach += math.hypot(*map(float, stage.origin.offset))
            if stage.kind == "sliding":
                reach += max(float(abs(row[stage.column])) for row in self.rows)
            reach *= 1 + 1e-9
        return reach

    def walk(self, pair: tuple[int, int], min_gap: Fraction) -> PathPair:
        """Returns two bodies relative to the last frame that carries both."""
        (way_p, p), (way_q, q) = (self.bodies[k] for k in pair)
        while way_p and way_q and way_p[0] == way_q[0]:
            way_p, way_q = way_p[1:], way_q[1:]
        own, other = (
            Carried([self.frames[k] for k in way], of, self.rows)
            for way, of in ((way_p, p), (way_q, q))
        )
        pieces = self.pieces[pair[0]], self.pieces[pair[1]]
        left_out = sum((self.left_out_of[k] for k in pair), Fraction())
        return PathPair(own, other, min_gap, pieces, left_out, len(self.rows) - 1)

    def time(self, row: int, share: Fraction) -> Fraction:
        times = self.times
        return times[row] + (share * (times[row + 1] - times[row]) if share else 0)

    def names_of(self, pair: tuple[int, int]) -> str:
        """Returns the names of two bodies."""
        return " and ".join(repr(self.names[k]) for k in pair)

    def left_out(self) -> list[str]:
        """Returns pairs of bodies that joints move against each other but the proof leaves out."""
        pairs = {frozenset(pair) for pair in self.pairs}
        moved_by = [[k for k in way if self.frames[k].kind != "fixed"] for way, _ in self.bodies]
        return [
            self.names_of((i, j))
            for i, j in combinations(range(len(self.bodies)), 2)
            if moved_by[i] != moved_by[j] and frozenset((i, j)) not in pairs
        ]


def check_path(file: File, statement: Any, report: Report) -> None:
    """Checks the first contact among pairs of bodies on chains of joints."""
    fields(file.query, "path", "min_gap")
    min_gap = bounded(gap_to_keep(file.query), MOST, "the gap to be kept")
    fields(statement, "pairs lower upper parts proof")
    proof, robot = fields(statement["proof"], "covers meeting"), Robot.read(file, statement)
    covers, pairs, last = listed(proof["covers"]), robot.pairs, len(robot.rows) - 1
    if not pairs:
        raise NoProofError("there is no pair of bodies")
    if len(covers) != len(pairs):
        raise RefusedError("the number of covers differs from the number of pairs")
    begin, reached, open_, begins = (0, Fraction()), (last, Fraction()), 0, True
    for pair, cover in zip(pairs, covers, strict=True):
        walk, steps = robot.walk(pair, min_gap), fields(cover, "steps")["steps"]
        up_to = walk.cover(steps, (0, 0), begin, reached)
        if has_planes(steps):
            if walk.pieces[0].is_open or walk.pieces[1].is_open:
                open_ += 1
            elif walk.is_nested():
                raise RefusedError("one of two bodies is inside the other at the start of the path")
        else:
            begins = False
        reached = min(reached, up_to)
    meet = "meet" if min_gap == 0 else f"are as near as {float(min_gap)!r}"
    lower, meeting = number(statement["lower"]), proof["meeting"]
    if lower > robot.time(*reached):
        raise RefusedError(f"the path up to {float(lower)!r} is not proven")
    if left_out := robot.left_out():
        report.unchecked.append(f"pairs that the query leaves out: {', '.join(left_out)}")
    # On a path with one row the planes are at its only place.
    if lower > robot.times[0] or (lower == robot.times[-1] and begins):
        named = ", ".join(map(robot.names_of, pairs[:NAMED]))
        named += ", ..." if len(pairs) > NAMED else ""
        report.holds.append(
            f"of {len(pairs)} pairs of bodies none {meet} up to the time {float(lower)!r}: {named}"
        )
    if open_:
        report.unchecked.append(
            f"whether a body is inside another at the start: {open_} pairs have open surfaces"
        )
        report.partly = True
    upper = None if statement["upper"] is None else number(statement["upper"])
    if meeting is None:
        if upper is not None:
            raise RefusedError("a contact is claimed without a proof")
        return
    which = whole(fields(meeting, "pair place how")["pair"], len(pairs))
    place = place_of(meeting["place"], last)
    if place < reached or (upper is not None and robot.time(*place) > upper):
        raise RefusedError(f"the place at which two bodies {meet} is before the proven part ends")
    found, how = robot.walk(pairs[which], min_gap), meeting["how"]
    if how == "inside":
        if place != begin or not (found.is_nested() or found.is_nested(everywhere=True)):
            raise RefusedError("neither body is inside the other at the start of the path")
    else:
        pieces_meet(found, how, *place)
    by = f"by the time {float(upper)!r}" if upper is not None else "on the path"
    report.holds.append(f"{robot.names_of(pairs[which])} {meet} {by}")


# The whole file
# --------------

#: The checks of claims about two bodies at fixed poses.
PLACED = {
    "distance": distance,
    "depth": depth,
    "solid_distance": solid_distance,
    "solid_depth": solid_depth,
    "solid_common_part": solid_common_part,
    "free_directions": free_directions,
}
#: The claims about two solids.
SOLID_PAIRS = ("solid_distance", "solid_depth", "solid_common_part", "free_directions")
#: The kind of query of each kind of claim.
CLAIMS = {
    **dict.fromkeys(("contacts", "separation", "clearance"), "cast"),
    **dict.fromkeys(PLACED, "pair"),
    **dict.fromkeys(("nearest", "within", "scene_clearance"), "scene"),
    "motions": "motions",
    "path": "path",
}


def check_cast(file: File, kind: str, claim: Any, report: Report) -> None:
    """Checks a claim about two bodies along a direction."""
    moving, fixed = file.two(solids=kind == "clearance")
    fields(file.query, "direction", "min_gap")
    d, min_gap = place(file.query["direction"]), gap_to_keep(file.query)
    if not any(d):
        raise NoProofError("the direction is zero")
    if kind == "separation":
        separation(moving, fixed, d, claim, report, min_gap)
    elif kind == "clearance":
        clearance(moving, fixed, d, claim, report, min_gap)
    else:
        contacts(moving, fixed, d, claim, report, min_gap)


def check_pair(file: File, kind: str, claim: Any, report: Report) -> None:
    """Checks a claim about two bodies at fixed poses."""
    moving, fixed = file.two(solids=kind in SOLID_PAIRS)
    if kind == "free_directions" and any(moving.shape.is_open + fixed.shape.is_open):
        raise NoProofError("free directions are not claimed for open surfaces")
    if kind == "free_directions" and radii(moving, fixed):
        raise NoProofError("free directions are not claimed for rounded solids")
    PLACED[kind](moving, fixed, claim, report)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Builds an object, and rejects repeated names."""
    fields = dict(pairs)
    if len(fields) < len(pairs):
        raise NoProofError("a name occurs twice in an object")
    return fields


def _integer(text: str) -> int | float:
    """Converts an integer; -0 becomes a floating-point number."""
    return -0.0 if text == "-0" else int(text)


def _finite(text: str) -> float:
    """Converts a number, and rejects numbers that exceed any double."""
    value = float(text)
    if math.isinf(value):
        raise NoProofError(f"{text:.40} is larger than any double")
    return value


def _no_number(text: str) -> Any:
    raise NoProofError(f"{text} is not a number")


def check(text: str) -> Report:
    """Checks the text of a proof file.

    Raises
    ------
    NoProofError
        The text is not a saved proof.
    RefusedError
        A claim does not hold.
    """
    try:
        content = json.loads(
            text.removeprefix("\ufeff"),
            object_pairs_hook=_once,
            parse_int=_integer,
            parse_float=_finite,
            parse_constant=_no_number,
        )
        if content["format"] != FORMAT:
            raise NoProofError(f"the format is {content['format']!r}, not {FORMAT!r}")
        if type(content.get("version")) is not int or content["version"] != VERSION:
            raise NoProofError(f"the version is {content.get('version')!r}, not {VERSION}")
        fields(content, "format version bodies placement query statement")
        file, report = File.read(content), Report()
        for k, shape in enumerate(file.shapes):
            if shape.is_convex and not are_own_faces(shape.points, shape.faces):
                report.partly = True
                report.unchecked.append(f"the faces of body {k}: it is the hull of its vertices")
        kind, claim = one_of(content["statement"], *CLAIMS)
        if CLAIMS[kind] != file.question:
            raise NoProofError(f"the claim {kind!r} does not belong to the query {file.question!r}")
        if file.question == "cast":
            check_cast(file, kind, claim, report)
        elif file.question == "pair":
            check_pair(file, kind, claim, report)
        elif file.question == "scene":
            Scene(file, report).check(kind, claim)
        elif file.question == "motions":
            check_motions(file, claim, report)
        else:
            check_path(file, claim, report)
        if report.has_cover:
            report.partly = True
            report.unchecked.append("the covers: the distances were checked without them")
    except (*_MALFORMED, RecursionError) as error:
        if isinstance(error, NoProofError):
            raise
        raise NoProofError(f"{type(error).__name__}: {error}") from error
    return report


def check_file(path: str, before: str) -> int:
    """Checks a file and prints the result, each line after a text. Returns the exit code."""
    try:
        report = check(Path(path).read_text(encoding="utf-8"))
    except (OSError, NoProofError, UnicodeDecodeError) as error:
        print(f"{path}: not a proof: {error}", file=sys.stderr)
        return 3
    except RefusedError as error:
        print(f"{path}: the proof does not hold: {error}", file=sys.stderr)
        return 6
    for line in report.holds:
        print(f"{before}holds: {line}")
    for line in report.unchecked:
        print(f"{before}not checked: {line}")
    if not report.holds:
        return 1
    return 7 if report.partly else 0


def main(words: Sequence[str] | None = None) -> int:
    words = sys.argv[1:] if words is None else words
    if not words or any(word.startswith("-") for word in words):
        print(__doc__ if words == ["--help"] else "usage: python -m colltrans.check PROOF.json ...")
        return 0 if words == ["--help"] else 2
    codes = {check_file(word, f"{word}: " if len(words) > 1 else "") for word in words}
    # Of several files, the most important result counts.
    return next(code for code in (6, 3, 1, 7, 0) if code in codes)


if __name__ == "__main__":
    sys.exit(main())
