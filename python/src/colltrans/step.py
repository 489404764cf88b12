"""STEP files to GLB, with the chord error of every part measured.

``python -m colltrans.step FILE -o OUT.glb`` needs ``pip install 'colltrans[step]'`` (cascadio,
which carries OpenCASCADE). It writes what ``colltrans assembly`` reads and what any viewer shows,
and prints one JSON object: of every part its name and its *chord error*, how far facets are from
the surface they stand for.

What was asked (``--chord``) is what OpenCASCADE aims at and does not always keep, so the error is
measured, in the numbers of the file that was written:

- on planes, cylinders and spheres exactly, up to rounding: the farthest point of each facet;
- on cones and tori as the largest of the exact distances of 45 points of each facet (``sampled``);
- on all other surfaces beside a tessellation that is four times as fine: the largest distance of
  its vertices from the facets of the same face, and a sixteenth more (``compared``).

The first is the error; the others are measures that a point between the samples may exceed.

``-o -`` writes the GLB to standard output, and nothing else: so ``colltrans assembly FILE.step``
calls it.
"""

import argparse
import json
import os
import re
import struct
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

#: How much finer the tessellation is that others are compared with: its own error is a sixteenth.
FINER = 4.0
#: Lengths of the file in a metre: all of GLB is in metres, and STEP files are told in millimetres.
PER_METRE = 1000.0
#: Weights of the corners at which a facet is sampled.
_SAMPLES = np.array([(i, j, 8 - i - j) for i in range(9) for j in range(9 - i)]) / 8.0
#: Pairs of points and facets that are compared at once.
_AT_ONCE = 1 << 20
#: Seconds between two words about how far it has come.
_SAID_EVERY = 0.5
#: Cells along the longest side of a face, by which its points are compared.
_CELLS = 32


class StepError(Exception):
    """A STEP file cannot be converted."""


@dataclass
class Measured:
    """The chord error of one mesh, in metres, and how it was found."""

    chord_error: float = 0.0
    exact: int = 0
    sampled: int = 0
    compared: int = 0

    def take(self, error: float, how: str) -> None:
        """Takes in one face."""
        self.chord_error = max(self.chord_error, error)
        setattr(self, how, getattr(self, how) + 1)


@dataclass
class Glb:
    """The two chunks of a GLB file."""

    document: dict[str, Any]
    binary: bytes = field(repr=False)

    @classmethod
    def parse(cls, data: bytes) -> "Glb":
        """Takes a file apart."""
        length = struct.unpack_from("<I", data, 12)[0]
        document = json.loads(data[20 : 20 + length])
        return cls(document, data[28 + length :])

    def to_bytes(self) -> bytes:
        """Puts it together again."""
        text = json.dumps(self.document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        binary = self.binary + b"\0" * (-len(self.binary) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
        return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks

    def numbers(self, accessor: int) -> NDArray[Any]:
        """The rows of an accessor."""
        found = self.document["accessors"][accessor]
        view = self.document["bufferViews"][found["bufferView"]]
        kind = np.dtype(
            {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}[found["componentType"]]
        )
        width = {"SCALAR": 1, "VEC3": 3}[found["type"]]
        start = view.get("byteOffset", 0) + found.get("byteOffset", 0)
        stride = view.get("byteStride", width * kind.itemsize)
        rows = np.ndarray(
            (found["count"], width), kind, self.binary, start, (stride, kind.itemsize)
        )
        return rows.copy()

    def faces(self, mesh: int) -> Iterator[tuple[tuple[int, int], dict[str, Any] | None, Points]]:
        """The faces of a mesh: their numbers, their surfaces if known, and their facets."""
        for number, primitive in enumerate(self.document["meshes"][mesh]["primitives"]):
            points = self.numbers(primitive["attributes"]["POSITION"]).astype(np.float64)
            facets = points[self.numbers(primitive["indices"]).reshape(-1, 3)]
            brep = primitive.get("extensions", {}).get("TM_brep_faces")
            if brep is None:
                yield (number, -1), None, facets
                continue
            of = self.numbers(brep["faceIndices"]).ravel()
            surfaces = {s["face_index"]: s for s in brep["faces"] if s and s.get("type")}
            order = np.argsort(of, kind="stable")
            for rows in np.split(order, np.flatnonzero(np.diff(of[order])) + 1):
                index = int(of[rows[0]])
                yield (number, index), surfaces.get(index), facets[rows]


def _across(points: Points, origin: Any, axis: Any) -> tuple[Points, Points]:
    """Points in the plane across an axis, and their heights along it."""
    axis = np.asarray(axis, dtype=np.float64)
    axis = axis / np.linalg.norm(axis)
    u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    u /= np.linalg.norm(u)
    local = points - np.asarray(origin, dtype=np.float64)
    flat = np.stack([local @ u, local @ np.cross(axis, u)], axis=-1)
    return flat, np.asarray(local @ axis)


def _nearest(point: Points, facets: Points) -> Points:
    """The distances of points from facets (n x 3 x d, of 2 or 3 dimensions): all that broadcast."""
    a, b, c = facets[..., 0, :], facets[..., 1, :], facets[..., 2, :]
    best = np.full(np.broadcast_shapes(point.shape[:-1], a.shape[:-1]), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        way = q - p
        length = np.maximum((way * way).sum(-1), np.finfo(float).tiny)
        t = np.clip(((point - p) * way).sum(-1) / length, 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(point - p - t[..., None] * way, axis=-1))
    # Where the foot of the perpendicular lies within the facet.
    u, v, w = b - a, c - a, point - a
    uu, uv, vv = (u * u).sum(-1), (u * v).sum(-1), (v * v).sum(-1)
    wu, wv, area = (w * u).sum(-1), (w * v).sum(-1), uu * vv - uv * uv
    # Facets without an area have their sides alone.
    whole = np.where(area > 0, area, 1.0)
    s, t = (wu * vv - wv * uv) / whole, (wv * uu - wu * uv) / whole
    inside = (area > 0) & (s >= 0) & (t >= 0) & (s + t <= 1)
    foot = np.linalg.norm(w - s[..., None] * u - t[..., None] * v, axis=-1)
    return np.asarray(np.where(inside, np.minimum(best, foot), best))


def _round(radius: float, corners: Points, nearest: Points) -> float:
    """The error of facets whose points are ``nearest`` to the farthest corner from the centre."""
    return float(max(radius - nearest.min(), np.abs(corners - radius).max()))


def on_surface(surface: dict[str, Any], facets: Points) -> tuple[float, str]:
    """The largest distance of facets from the surface they stand for, and how that was found.

    Parameters
    ----------
    surface : dict
        A face of ``TM_brep_faces``.
    facets : array of shape (n, 3, 3)

    Returns
    -------
    error : float
    how : str
        ``exact`` or ``sampled``.
    """
    kind = surface["type"]
    if kind == "plane":
        _, heights = _across(facets, surface["origin"], surface["normal"])
        return float(np.abs(heights).max()), "exact"
    if kind == "sphere":
        local = facets - np.asarray(surface["center"])
        corners = np.linalg.norm(local, axis=-1)
        return _round(surface["radius"], corners, _nearest(np.zeros(3), local)), "exact"
    if kind == "cylinder":
        flat, _ = _across(facets, surface["origin"], surface["axis"])
        corners = np.linalg.norm(flat, axis=-1)
        return _round(surface["radius"], corners, _nearest(np.zeros(2), flat)), "exact"
    points = np.einsum("sk,nkd->nsd", _SAMPLES, facets)
    if kind == "cone":
        flat, height = _across(points, surface["apex"], surface["axis"])
        angle = surface["semi_angle"]
        # On either side of the apex.
        away = np.linalg.norm(flat, axis=-1) * np.cos(angle) - np.abs(height) * abs(np.sin(angle))
    elif kind == "torus":
        flat, height = _across(points, surface["center"], surface["axis"])
        ring = np.linalg.norm(flat, axis=-1) - surface["major_radius"]
        away = np.hypot(ring, height) - surface["minor_radius"]
    else:
        raise StepError(f"the surface {kind} is not known")
    return float(np.abs(away).max()), "sampled"


def beside(fine: Points, facets: Points) -> float:
    """The largest distance of the corners of a finer tessellation from coarse facets.

    Corners are taken by the cells of a grid. Of the facets those are looked at whose boxes are no
    farther from a cell's corners than some facet is for certain.
    """
    corners = np.unique(fine.reshape(-1, 3), axis=0)
    low = corners.min(axis=0)
    side = max(float((corners.max(axis=0) - low).max()) / _CELLS, np.finfo(float).tiny)
    cells = ((corners - low) / side).astype(np.int64) @ np.array([1, 1 << 20, 1 << 40])
    order = np.argsort(cells, kind="stable")
    box_low, box_high = facets.min(axis=1), facets.max(axis=1)
    worst = 0.0
    for rows in np.split(order, np.flatnonzero(np.diff(cells[order])) + 1):
        some = corners[rows]
        middle = (some.min(axis=0) + some.max(axis=0)) / 2
        radius = np.linalg.norm(some - middle, axis=1).max()
        apart = np.maximum(np.maximum(box_low - middle, middle - box_high), 0.0)
        certain = np.linalg.norm(facets[:, 0] - middle, axis=1).min() + radius
        near = facets[np.linalg.norm(apart, axis=1) - radius <= certain]
        step = max(1, _AT_ONCE // len(near))
        for first in range(0, len(some), step):
            distances = _nearest(some[first : first + step, None], near[None])
            worst = max(worst, float(distances.min(axis=1).max()))
    return worst


def measure(glb: Glb, finer: Glb | None) -> list[Measured]:
    """The chord error of every mesh; says from time to time how many are measured."""
    found = []
    count = len(glb.document.get("meshes", []))
    said = time.monotonic()
    for mesh in range(count):
        if time.monotonic() - said > _SAID_EVERY:
            said = time.monotonic()
            _say(f"measuring chord errors: {mesh} of {count} shapes")
        measured = Measured()
        fine = {number: facets for number, _, facets in finer.faces(mesh)} if finer else {}
        for number, surface, facets in glb.faces(mesh):
            if surface is not None:
                measured.take(*on_surface(surface, facets))
            elif number in fine:
                measured.take(beside(fine[number], facets) * (1 + FINER**-2), "compared")
        found.append(measured)
    return found


def has_other_surfaces(glb: Glb) -> bool:
    """Whether there are faces whose surface is not known."""
    meshes = range(len(glb.document.get("meshes", [])))
    return any(surface is None for mesh in meshes for _, surface, _ in glb.faces(mesh))


def assemblies(text: str) -> set[str]:
    """The names of products that other products are placed in, and of their occurrences."""
    entity = re.compile(r"#(\d+)\s*=\s*(\w+)\s*\((.*?)\)\s*;", re.S)
    kinds = "NEXT_ASSEMBLY_USAGE_OCCURRENCE|PRODUCT_DEFINITION_FORMATION|PRODUCT_DEFINITION|PRODUCT"
    known: dict[str, dict[str, str]] = {}
    for number, kind, rest in entity.findall(text):
        if re.fullmatch(kinds + "|PRODUCT_DEFINITION_FORMATION_WITH_SPECIFIED_SOURCE", kind):
            known.setdefault(kind.removesuffix("_WITH_SPECIFIED_SOURCE"), {})[number] = rest
    formations = known.get("PRODUCT_DEFINITION_FORMATION", {})
    products = known.get("PRODUCT", {})

    def last(rest: str, place: int = -1) -> str:
        return str(re.findall(r"#(\d+)", rest)[place])

    def product_of(definition: str) -> str:
        rest = known["PRODUCT_DEFINITION"][definition]
        name = products[last(formations[last(rest, 0)], 0)]
        return re.match(r"\s*'((?:[^']|'')*)'", name)[1]  # type: ignore[index]

    names, placed = set(), []
    for rest in known.get("NEXT_ASSEMBLY_USAGE_OCCURRENCE", {}).values():
        relating, related = re.findall(r"#(\d+)", rest)[:2]
        strings = re.findall(r"'((?:[^']|'')*)'", rest)
        try:
            names.add(product_of(relating))
            placed.append((strings[1] if len(strings) > 1 else "", product_of(related)))
        except (KeyError, IndexError, TypeError):
            continue
    return names | {occurrence for occurrence, product in placed if product in names}


def mark(glb: Glb, measured: list[Measured], holding: set[str]) -> list[dict[str, Any]]:
    """Writes the chord errors into the nodes.

    Leaves below a product that holds no other are one part.
    """
    nodes = glb.document["nodes"]
    parts: list[dict[str, Any]] = []

    def below(index: int) -> list[int]:
        node = nodes[index]
        here = [node["mesh"]] if "mesh" in node else []
        return here + [mesh for child in node.get("children", []) for mesh in below(child)]

    def visit(index: int, is_root: bool) -> None:
        node = nodes[index]
        children, meshes = node.get("children", []), below(index)
        leaves = all("children" not in nodes[child] for child in children)
        name = node.get("name", "")
        whole = (
            bool(holding) and not is_root and len(children) > 1 and leaves and name not in holding
        )
        if "mesh" in node or whole:
            of = [measured[mesh] for mesh in meshes]
            error = max(each.chord_error for each in of)
            node["extras"] = {"colltrans": {"chord_error": error, "part": True}}
            told = {"name": name, "chord_error": error * PER_METRE}
            for how in ("exact", "sampled", "compared"):
                told[how] = sum(getattr(each, how) for each in of)
            parts.append(told)
            return
        for child in children:
            visit(child, False)

    for root in glb.document["scenes"][glb.document.get("scene", 0)]["nodes"]:
        visit(root, True)
    return parts


def strip(glb: Glb) -> None:
    """Leaves out the surfaces, which nobody asks for any more."""
    for mesh in glb.document.get("meshes", []):
        for primitive in mesh["primitives"]:
            primitive.get("extensions", {}).pop("TM_brep_faces", None)
    glb.document.pop("extensionsUsed", None)
    extras = {"colltrans": {"unit": "mm", "per_metre": PER_METRE, "up": "z"}}
    glb.document["asset"]["extras"] = extras


def convert(
    path: str | os.PathLike[str], chord: float = 0.05, angle: float = 0.2
) -> tuple[bytes, dict[str, Any]]:
    """Tessellates a STEP file.

    Parameters
    ----------
    path : str or os.PathLike
    chord : float
        The chord error that is aimed at, in millimetres.
    angle : float
        The largest angle between neighbouring facets of one face, in radians.

    Returns
    -------
    glb : bytes
    report : dict
        The chord error of each part, in millimetres, and of how many faces it was found in
        which way.
    """
    try:
        import cascadio
    except ImportError as error:
        raise StepError("STEP files need cascadio: pip install 'colltrans[step]'") from error
    data = Path(path).read_bytes()
    if not data.lstrip().startswith(b"ISO-10303-21"):
        raise StepError(f"{path}: is no STEP file: it does not begin with ISO-10303-21")

    def tessellated(factor: float) -> Glb:
        made = cascadio.load(
            data,
            file_type="step",
            tol_linear=chord / factor,
            tol_angular=angle / factor,
            include_brep=True,
        )
        if not made:
            raise StepError(f"{path}: OpenCASCADE finds no shape in it")
        return Glb.parse(made)

    _say(f"{path}: tessellating")
    glb = tessellated(1.0)
    finer = None
    if has_other_surfaces(glb):
        _say("tessellating once more, finer")
        finer = tessellated(FINER)
    _say("measuring chord errors")
    measured = measure(glb, finer)
    parts = mark(glb, measured, assemblies(data.decode("latin-1")))
    strip(glb)
    return glb.to_bytes(), {"unit": "mm", "chord": chord, "angle": angle, "parts": parts}


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m colltrans.step", description=__doc__)
    parser.add_argument("file", help="a STEP file")
    parser.add_argument("--chord", type=float, default=0.05, help="in millimetres (default 0.05)")
    parser.add_argument("--angle", type=float, default=0.2, help="in radians (default 0.2)")
    parser.add_argument("-o", "--output", required=True, help="the GLB file to write, or -")
    arguments = parser.parse_args()
    if not (0 < arguments.chord < float("inf") and 0 < arguments.angle < float("inf")):
        parser.error("--chord and --angle are lengths and angles above 0")
    try:
        glb, report = convert(arguments.file, arguments.chord, arguments.angle)
        if arguments.output == "-":
            sys.stdout.buffer.write(glb)
            return 0
        Path(arguments.output).write_bytes(glb)
    except (StepError, OSError) as error:
        _say(str(error))
        return 3
    print(json.dumps(report))
    return 0


if __name__ == "__main__":
    sys.exit(main())
