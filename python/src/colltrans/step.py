"""Converts STEP files to GLB, and measures the chord error of every part.

``python -m colltrans.step FILE -o OUT.glb`` needs cadquery-ocp-novtk, which contains OpenCASCADE:
``pip install 'colltrans[step]'``, in a checkout ``pip install './python[step]'``. It writes a GLB
file that ``colltrans assembly`` and any viewer read. It prints one JSON object: the name of every
part, its number of solids and its *chord error*, the distance of its facets from the surface that
they approximate.

The product tree comes from OpenCASCADE's document (XCAF), including external files. A part is a
product in which no other product is placed. Curves and points are left out; a note names the parts
that contain nothing else.

OpenCASCADE aims at the chord error of ``--chord`` but does not always reach it. Therefore the error
is measured, with the numbers that are written to the file:

- on planes, cylinders and spheres exactly up to rounding, as the farthest point of each facet
  (``exact``);
- on cones and tori as the largest of the exact distances of 45 points of each facet (``sampled``);
- on all other surfaces with a tessellation that is four times as fine, as the largest distance of
  its vertices from the facets of the same face, plus a sixteenth (``compared``).

The exact measure is a bound of the error. Points between samples may exceed the other two measures.

``-o -`` writes only the GLB file, to standard output. The command ``colltrans assembly FILE.step``
uses this form.
"""

import argparse
import json
import os
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

#: Refinement factor of the tessellation for comparison; its own error is a sixteenth.
FINER = 4.0
#: Millimetres in a metre: GLB is in metres, STEP shapes are in millimetres.
PER_METRE = 1000.0
#: Barycentric weights of the sample points of a facet.
_SAMPLES = np.array([(i, j, 8 - i - j) for i in range(9) for j in range(9 - i)]) / 8.0
#: Maximum number of point-facet pairs that are compared at once.
_AT_ONCE = 1 << 20
#: Seconds between two progress messages.
_SAID_EVERY = 0.5
#: Number of facets above which the comparison with a finer tessellation may take many seconds.
_MANY_FACETS = 2000
#: Number of grid cells along the longest side of a face, for grouping its points.
_CELLS = 32


class StepError(Exception):
    """A STEP file cannot be converted."""


@dataclass
class Measured:
    """The chord error of one shape in millimetres, and the number of faces for each measure."""

    chord_error: float = 0.0
    exact: int = 0
    sampled: int = 0
    compared: int = 0

    def take(self, error: float, how: str) -> None:
        """Adds the error of one face."""
        self.chord_error = max(self.chord_error, error)
        setattr(self, how, getattr(self, how) + 1)


@dataclass
class Glb:
    """The two chunks of a GLB file."""

    document: dict[str, Any]
    binary: bytes = field(repr=False)

    @classmethod
    def parse(cls, data: bytes) -> "Glb":
        """Splits a file into its chunks."""
        length = struct.unpack_from("<I", data, 12)[0]
        document = json.loads(data[20 : 20 + length])
        return cls(document, data[28 + length :])

    def to_bytes(self) -> bytes:
        """Returns the bytes of the file."""
        text = json.dumps(self.document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        binary = self.binary + b"\0" * (-len(self.binary) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
        return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks

    def numbers(self, accessor: int) -> NDArray[Any]:
        """Returns the rows of an accessor."""
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


def _across(points: Points, origin: Any, axis: Any) -> tuple[Points, Points]:
    """Projects points to the plane perpendicular to an axis; returns also the heights along it."""
    axis = np.asarray(axis, dtype=np.float64)
    axis = axis / np.linalg.norm(axis)
    u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    u /= np.linalg.norm(u)
    local = points - np.asarray(origin, dtype=np.float64)
    flat = np.stack([local @ u, local @ np.cross(axis, u)], axis=-1)
    return flat, np.asarray(local @ axis)


def _nearest(point: Points, facets: Points) -> Points:
    """Returns the distances of points from facets (n x 3 x d, d = 2 or 3), with broadcasting."""
    a, b, c = facets[..., 0, :], facets[..., 1, :], facets[..., 2, :]
    best = np.full(np.broadcast_shapes(point.shape[:-1], a.shape[:-1]), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        way = q - p
        length = np.maximum((way * way).sum(-1), np.finfo(float).tiny)
        t = np.clip(((point - p) * way).sum(-1) / length, 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(point - p - t[..., None] * way, axis=-1))
    # The distance from the plane counts if the foot of the perpendicular is inside the facet.
    u, v, w = b - a, c - a, point - a
    uu, uv, vv = (u * u).sum(-1), (u * v).sum(-1), (v * v).sum(-1)
    wu, wv, area = (w * u).sum(-1), (w * v).sum(-1), uu * vv - uv * uv
    # For facets without an area only the sides count.
    whole = np.where(area > 0, area, 1.0)
    s, t = (wu * vv - wv * uv) / whole, (wv * uu - wu * uv) / whole
    inside = (area > 0) & (s >= 0) & (t >= 0) & (s + t <= 1)
    foot = np.linalg.norm(w - s[..., None] * u - t[..., None] * v, axis=-1)
    return np.asarray(np.where(inside, np.minimum(best, foot), best))


def _round(radius: float, corners: Points, nearest: Points) -> float:
    """Returns the error on a sphere or circle, from distances of corners and nearest points."""
    return float(max(radius - nearest.min(), np.abs(corners - radius).max()))


def on_surface(surface: dict[str, Any], facets: Points) -> tuple[float, str]:
    """Returns the largest distance of facets from their surface, and the kind of measure.

    Parameters
    ----------
    surface : dict
        The ``type`` of the surface, with its lengths and directions by name.
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
        # The cone continues on both sides of the apex.
        away = np.linalg.norm(flat, axis=-1) * np.cos(angle) - np.abs(height) * abs(np.sin(angle))
    elif kind == "torus":
        flat, height = _across(points, surface["center"], surface["axis"])
        ring = np.linalg.norm(flat, axis=-1) - surface["major_radius"]
        away = np.hypot(ring, height) - surface["minor_radius"]
    else:
        raise StepError(f"unknown surface type {kind}")
    return float(np.abs(away).max()), "sampled"


def beside(fine: Points, facets: Points) -> float:
    """Returns the largest distance of the corners of a finer tessellation from coarse facets.

    Corners are grouped by the cells of a grid. For each cell only facets are examined whose boxes
    are not farther away than an upper bound of the nearest distance.
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


@dataclass
class Face:
    """A tessellated face in millimetres; facets refer to points by index."""

    shape: Any = field(repr=False)
    surface: dict[str, Any] | None
    points: Points
    facets: NDArray[np.int64]

    def corners(self) -> Points:
        """Returns the corners of the facets in single precision, as they are written."""
        written = (self.points / PER_METRE).astype(np.float32).astype(np.float64) * PER_METRE
        return np.asarray(written[self.facets])


@dataclass
class Progress:
    """Progress messages about the conversion of shapes, on standard error."""

    shape: str = ""
    said: float = field(default_factory=time.monotonic)

    def say(self, what: str, is_long: bool = False) -> None:
        """Prints the next operation if it takes long or the last message is some time ago.

        OpenCASCADE does not let other threads run, so the message precedes the operation.
        """
        if is_long or time.monotonic() - self.said > _SAID_EVERY:
            self.said = time.monotonic()
            _say(f"{self.shape}: {what}")


def measure(faces: list[Face], chord: float, angle: float, progress: Progress) -> Measured:
    """Measures the chord error of the faces of one shape, in millimetres."""
    measured = Measured()
    others = [face for face in faces if face.surface is None]
    if others:
        facets = sum(len(face.facets) for face in others)
        progress.say(
            f"tessellating its {len(others)} free-form faces ({facets} facets) more finely, "
            "to compare",
            is_long=facets >= _MANY_FACETS,
        )
    finer = _tessellated([face.shape for face in others], chord / FINER, angle / FINER)
    for face in faces:
        if face.surface is not None:
            measured.take(*on_surface(face.surface, face.corners()))
    for number, (face, fine) in enumerate(zip(others, finer, strict=True)):
        progress.say(f"comparing free-form face {number + 1} of {len(others)}")
        error = beside(fine.points[fine.facets], face.corners())
        measured.take(error * (1 + FINER**-2), "compared")
    return measured


def _xyz(triple: Any) -> list[float]:
    return [triple.X(), triple.Y(), triple.Z()]


def _surface(face: Any) -> dict[str, Any] | None:
    """Returns the surface of a face in the form of `on_surface`; None for free-form surfaces."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType as Kind

    if BRep_Tool.Surface_s(face) is None:
        return None
    adaptor = BRepAdaptor_Surface(face, False)
    kind = adaptor.GetType()
    if kind == Kind.GeomAbs_Plane:
        axis = adaptor.Plane().Axis()
        return {
            "type": "plane",
            "origin": _xyz(axis.Location()),
            "normal": _xyz(axis.Direction()),
        }
    if kind == Kind.GeomAbs_Sphere:
        sphere = adaptor.Sphere()
        return {"type": "sphere", "center": _xyz(sphere.Location()), "radius": sphere.Radius()}
    if kind == Kind.GeomAbs_Cylinder:
        cylinder = adaptor.Cylinder()
        axis = cylinder.Axis()
        origin, along = _xyz(axis.Location()), _xyz(axis.Direction())
        return {"type": "cylinder", "origin": origin, "axis": along, "radius": cylinder.Radius()}
    if kind == Kind.GeomAbs_Cone:
        cone = adaptor.Cone()
        along = _xyz(cone.Axis().Direction())
        angle = cone.SemiAngle()
        return {"type": "cone", "apex": _xyz(cone.Apex()), "axis": along, "semi_angle": angle}
    if kind == Kind.GeomAbs_Torus:
        torus = adaptor.Torus()
        return {
            "type": "torus",
            "center": _xyz(torus.Location()),
            "axis": _xyz(torus.Axis().Direction()),
            "major_radius": torus.MajorRadius(),
            "minor_radius": torus.MinorRadius(),
        }
    return None


def _explored(shape: Any, kind: Any) -> Iterator[Any]:
    """Yields the sub-shapes of a kind in a shape."""
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def _tessellated(shapes: list[Any], chord: float, angle: float) -> list[Face]:
    """Tessellates the faces of shapes together, so that neighbours share corners."""
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools
    from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS, TopoDS_Compound

    if not shapes:
        return []
    whole, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(whole)
    for shape in shapes:
        builder.Add(whole, shape)
    BRepTools.Clean_s(whole)
    BRepMesh_IncrementalMesh(whole, chord, False, angle, False)
    faces = []
    for shape in _explored(whole, TopAbs_ShapeEnum.TopAbs_FACE):
        face, location = TopoDS.Face(shape), TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, location)
        if mesh is None:
            raise StepError("OpenCASCADE cannot tessellate one of its faces; repair the file")
        place = np.array(_matrix(location))
        points = np.array([mesh.Node(k + 1).Coord() for k in range(mesh.NbNodes())])
        points = points @ place[:3, :3].T + place[:3, 3]
        facets = np.array([mesh.Triangle(k + 1).Get() for k in range(mesh.NbTriangles())]) - 1
        reverse = face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
        if reverse != (np.linalg.det(place[:3, :3]) < 0):
            facets = facets[:, ::-1]
        faces.append(Face(face, _surface(face), points, facets))
    return faces


def _matrix(location: Any) -> list[list[float]]:
    """Returns a location as the rows of a 4 x 4 matrix, in millimetres."""
    move = location.Transformation()
    rows = [[move.Value(row, column) for column in range(1, 5)] for row in range(1, 4)]
    return [*rows, [0.0, 0.0, 0.0, 1.0]]


@dataclass
class Node:
    """A node of the product tree: an assembly with children, or a leaf with a shape."""

    name: str
    matrix: list[list[float]]
    label: Any = field(repr=False)
    colour: tuple[float, ...] | None = None
    is_part: bool = False
    is_leaf: bool = False
    children: list["Node"] = field(default_factory=list)

    def leaves(self) -> "Iterator[Node]":
        """Yields the leaves below this node, or the node itself."""
        if self.is_leaf:
            yield self
        for child in self.children:
            yield from child.leaves()


def _entry(label: Any) -> str:
    """Returns the entry of a label in its document, which identifies the label."""
    from OCP.TCollection import TCollection_AsciiString
    from OCP.TDF import TDF_Tool

    entry = TCollection_AsciiString()
    TDF_Tool.Entry_s(label, entry)
    return str(entry.ToCString())


class Product:
    """The product tree of a STEP file, from OpenCASCADE's document (XCAF)."""

    def __init__(self, path: Path) -> None:
        """Reads a file and the external files that it references."""
        from OCP.IFSelect import IFSelect_ReturnStatus
        from OCP.Interface import Interface_Static
        from OCP.STEPCAFControl import STEPCAFControl_Reader
        from OCP.TCollection import TCollection_ExtendedString
        from OCP.TDocStd import TDocStd_Document
        from OCP.XCAFDoc import XCAFDoc_DocumentTool

        _quieten()
        self.path = path
        self.document = TDocStd_Document(TCollection_ExtendedString("MDTV-XCAF"))
        reader = STEPCAFControl_Reader()
        reader.SetNameMode(True)
        reader.SetColorMode(True)
        Interface_Static.SetCVal_s("xstep.cascade.unit", "MM")
        # Part 21 allows only ASCII and escapes. Some programs write UTF-8, others their code
        # page.
        Interface_Static.SetCVal_s("read.step.codepage", _encoding(path.read_bytes()))
        done = IFSelect_ReturnStatus.IFSelect_RetDone
        # The reader finds external files only if the path is absolute.
        if reader.ReadFile(str(path.resolve())) != done:
            raise StepError(
                f"{path}: OpenCASCADE cannot read the file; export it again as STEP AP214"
            )
        _check_external_files(path, reader.Reader().WS(), set())
        _say(f"{path}: building the product tree")
        if not reader.Transfer(self.document):
            raise StepError(f"{path}: OpenCASCADE finds no shape in the file")
        self.shapes = XCAFDoc_DocumentTool.ShapeTool_s(self.document.Main())
        self.colours = XCAFDoc_DocumentTool.ColorTool_s(self.document.Main())
        sessions = [reader.Reader().WS()]
        for file in reader.ExternFiles():
            name = file.GetName().ToCString()
            if file.GetLoadStatus() != done:
                raise StepError(
                    f"{path}: cannot read its external file {name}; "
                    "put it into the folder of the source"
                )
            sessions.append(file.GetWS())
        self.assemblies = {
            entry for session in sessions for entry in self._assemblies(session, reader)
        }

    def _assemblies(self, session: Any, reader: Any) -> Iterator[str]:
        """Yields the entries of products in which other products are placed."""
        from OCP.STEPConstruct import STEPConstruct_Tool
        from OCP.StepRepr import StepRepr_NextAssemblyUsageOccurrence

        tool, known = STEPConstruct_Tool(session), reader.GetShapeLabelMap()
        model = session.Model()
        for number in range(1, model.NbEntities() + 1):
            entity = model.Value(number)
            if isinstance(entity, StepRepr_NextAssemblyUsageOccurrence):
                placed = reader.FindInstance_s(entity, self.shapes, tool, known)
                if placed is not None and not placed.IsNull():
                    yield _entry(placed.Father())

    def roots(self) -> list[Node]:
        """Returns the nodes that have no parent."""
        from OCP.collections import Sequence_TDF_Label

        free = Sequence_TDF_Label()
        self.shapes.GetFreeShapes(free)
        return [self._node(label, False) for label in free]

    def _node(self, label: Any, is_within: bool) -> Node:
        """Returns a node and all nodes below it; ``is_within`` is set inside a part."""
        from OCP.collections import Sequence_TDF_Label
        from OCP.TDF import TDF_Label
        from OCP.TopLoc import TopLoc_Location
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        of = TDF_Label()
        is_placed = XCAFDoc_ShapeTool.GetReferredShape_s(label, of)
        of = of if is_placed else label
        place = XCAFDoc_ShapeTool.GetLocation_s(label) if is_placed else TopLoc_Location()
        # Programs number occurrences ("1", "*DIT33", "=>[0:1:1:3]"); the name of the product is
        # better.
        names = [_name(label), _name(of)]
        told = [name for name in names if name and name[0] not in "*=" and not name.isdigit()]
        name = next(iter(told + names[::-1]))
        node = Node(name, _matrix(place), of, self._colour(label) or self._colour(of))
        node.is_leaf = not XCAFDoc_ShapeTool.IsAssembly_s(of)
        # OpenCASCADE also expands a product with several bodies, though it contains no other
        # product.
        expanded = bool(self.assemblies) and _entry(of) not in self.assemblies
        node.is_part = not is_within and (node.is_leaf or expanded)
        if not node.is_leaf:
            components = Sequence_TDF_Label()
            XCAFDoc_ShapeTool.GetComponents_s(of, components)
            within = is_within or node.is_part
            node.children = [self._node(component, within) for component in components]
        return node

    def _colour(self, label: Any) -> tuple[float, ...] | None:
        """Returns the colour of a label in linear RGB, as in glTF; None without a colour."""
        from OCP.Quantity import Quantity_Color
        from OCP.XCAFDoc import XCAFDoc_ColorTool, XCAFDoc_ColorType

        colour = Quantity_Color()
        for kind in (XCAFDoc_ColorType.XCAFDoc_ColorSurf, XCAFDoc_ColorType.XCAFDoc_ColorGen):
            if XCAFDoc_ColorTool.GetColor_s(label, kind, colour):
                return (colour.Red(), colour.Green(), colour.Blue())
        return None

    def colours_within(self, label: Any) -> list[tuple[Any, tuple[float, ...]]]:
        """Returns the shapes of a leaf with colours of their own, larger shapes first."""
        from OCP.collections import Sequence_TDF_Label
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        within = Sequence_TDF_Label()
        XCAFDoc_ShapeTool.GetSubShapes_s(label, within)
        found = [(XCAFDoc_ShapeTool.GetShape_s(each), self._colour(each)) for each in within]
        coloured = [(shape, colour) for shape, colour in found if colour is not None]
        return sorted(coloured, key=lambda each: int(each[0].ShapeType()))


def _name(label: Any) -> str:
    """Returns the name of a label; empty if it has no name."""
    from OCP.TDataStd import TDataStd_Name

    name = TDataStd_Name()
    return str(name.Get().ToExtString()) if label.FindAttribute(name.GetID_s(), name) else ""


def _encoding(data: bytes) -> str:
    """Returns OpenCASCADE's name of the encoding: UTF-8 if the text is valid, else CP1252."""
    try:
        data.decode()
    except UnicodeDecodeError:
        return "CP1252"
    return "UTF8"


def _lies_beside(name: str) -> bool:
    """Checks whether a file name stays inside its folder, on any system."""
    parts = name.replace("\\", "/").split("/")
    return ".." not in parts and parts[0] != "" and ":" not in name


def _check_external_files(path: Path, session: Any, known: set[Path]) -> None:
    """Checks that the names of the external files of a source stay inside its folder.

    Files that these files reference are checked too. A file is opened only after its name is
    checked; symbolic links are followed. Missing files are left to OpenCASCADE.
    """
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPConstruct import STEPConstruct_ExternRefs
    from OCP.STEPControl import STEPControl_Reader

    references = STEPConstruct_ExternRefs(session)
    references.LoadExternRefs()
    for number in range(1, references.NbExternRefs() + 1):
        name = str(references.FileName(number))
        if not _lies_beside(name):
            raise StepError(f"{path}: the external file {name} must be in the folder of the source")
        file = path.parent / name
        if file in known or not file.is_file():
            continue
        known.add(file)
        reader = STEPControl_Reader()
        if reader.ReadFile(str(file.resolve())) == IFSelect_ReturnStatus.IFSelect_RetDone:
            _check_external_files(file, reader.WS(), known)


def _quieten() -> None:
    """Keeps the messages of OpenCASCADE away from standard output."""
    from OCP.Message import Message

    for printer in list(Message.DefaultMessenger_s().Printers()):
        Message.DefaultMessenger_s().RemovePrinter(printer)


@dataclass
class Writer:
    """A GLB file under construction, with one mesh for each leaf and colour."""

    product: Product
    chord: float
    angle: float
    document: dict[str, Any] = field(default_factory=dict)
    binary: bytearray = field(default_factory=bytearray)
    shapes: dict[str, tuple[list[Face], Measured, int]] = field(default_factory=dict)
    meshes: dict[tuple[str, Any], int] = field(default_factory=dict)
    parts: list[dict[str, Any]] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    progress: Progress = field(default_factory=Progress)

    def shape_of(self, node: Node) -> tuple[list[Face], Measured, int]:
        """Returns the faces of a leaf, their chord error and its number of solids; caches them."""
        from OCP.TopAbs import TopAbs_ShapeEnum
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        entry = _entry(node.label)
        if entry not in self.shapes:
            shape = XCAFDoc_ShapeTool.GetShape_s(node.label)
            solids = sum(1 for _ in _explored(shape, TopAbs_ShapeEnum.TopAbs_SOLID))
            try:
                faces = _tessellated([shape], self.chord, self.angle)
            except StepError as error:
                raise StepError(f"{self.product.path}: part {node.name!r}: {error}") from error
            measured = measure(faces, self.chord, self.angle, self.progress)
            self.shapes[entry] = faces, measured, solids
        return self.shapes[entry]

    def write(self, roots: list[Node]) -> None:
        """Writes all nodes, with progress messages about the current shape."""
        leaves = {_entry(leaf.label): leaf for root in roots for leaf in root.leaves()}
        for number, leaf in enumerate(leaves.values()):
            self.progress.shape = f"part {leaf.name!r} (shape {number + 1} of {len(leaves)})"
            self.progress.say("tessellating")
            self.shape_of(leaf)
        extras: dict[str, Any] = {"unit": "mm", "per_metre": PER_METRE, "up": "z"}
        self.document = {
            "asset": {"version": "2.0", "extras": {"colltrans": extras}},
            **{name: [] for name in ("nodes", "meshes", "materials", "accessors", "bufferViews")},
        }
        nodes = [self._node(root) for root in roots]
        self.document["scenes"] = [{"nodes": [node for node in nodes if node is not None]}]
        self.document["scene"] = 0
        if self.left_out:
            extras["notes"] = [self.note()]
        self.document["buffers"] = [{"byteLength": len(self.binary)}]
        for name in ("materials", "meshes"):
            if not self.document[name]:
                del self.document[name]

    def note(self) -> str:
        """Returns a sentence about the parts that are left out."""
        names = ", ".join(repr(name) for name in self.left_out[:5])
        more = ", ..." if len(self.left_out) > 5 else ""
        what = "left out because they contain only curves or points"
        return f"{what} ({len(self.left_out)}): {names}{more}"

    def _node(self, node: Node) -> int | None:
        """Writes a node and its descendants; returns its index, ``None`` if it has no face."""
        written: dict[str, Any] = {"name": node.name}
        if node.is_part and not any(self.shape_of(leaf)[0] for leaf in node.leaves()):
            self.left_out.append(node.name)
            return None
        if node.is_part:
            self._part(node, written)
        if node.is_leaf:
            mesh = self._mesh(node)
            if mesh is None:
                return None
            written["mesh"] = mesh
        else:
            children = [self._node(child) for child in node.children]
            written["children"] = [child for child in children if child is not None]
            if not written["children"]:
                return None
        matrix = np.array(node.matrix)
        if not np.array_equal(matrix, np.eye(4)):
            matrix[:3, 3] /= PER_METRE
            written["matrix"] = matrix.T.ravel().tolist()
        self.document["nodes"].append(written)
        return len(self.document["nodes"]) - 1

    def _part(self, node: Node, written: dict[str, Any]) -> None:
        """Adds a part to the report, and its chord error to its node."""
        found = [self.shape_of(leaf) for leaf in node.leaves()]
        error = max(measured.chord_error for _, measured, _ in found)
        written["extras"] = {"colltrans": {"chord_error": error / PER_METRE, "part": True}}
        told = {"name": node.name, "chord_error": error, "solids": sum(n for _, _, n in found)}
        for how in ("exact", "sampled", "compared"):
            told[how] = sum(getattr(measured, how) for _, measured, _ in found)
        self.parts.append(told)

    def _mesh(self, node: Node) -> int | None:
        """Returns the mesh index of a leaf, written once per colour; None if it has no face."""
        faces = self.shape_of(node)[0]
        key = _entry(node.label), node.colour
        if faces and key not in self.meshes:
            by_colour: dict[Any, list[Face]] = {}
            for face, colour in zip(faces, self._face_colours(node, faces), strict=True):
                by_colour.setdefault(colour, []).append(face)
            primitives = [self._primitive(some, colour) for colour, some in by_colour.items()]
            self.meshes[key] = len(self.document["meshes"])
            self.document["meshes"].append({"primitives": primitives})
        return self.meshes.get(key)

    def _face_colours(self, node: Node, faces: list[Face]) -> list[Any]:
        """Returns the colour of each face: its own, that of its solid or that of its part."""
        from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher
        from OCP.TopAbs import TopAbs_ShapeEnum

        known = IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher()
        numbers = [known.Add(face.shape) for face in faces]
        own: dict[int, Any] = {}
        for shape, colour in self.product.colours_within(node.label):
            for face in _explored(shape, TopAbs_ShapeEnum.TopAbs_FACE):
                own[known.FindIndex(face)] = colour
        return [own.get(number, node.colour) for number in numbers]

    def _primitive(self, faces: list[Face], colour: Any) -> dict[str, Any]:
        """Writes faces of one colour as a primitive."""
        first = np.cumsum([0, *(len(face.points) for face in faces)])
        points = np.concatenate([face.points for face in faces]) / PER_METRE
        facets = np.concatenate([face.facets + n for face, n in zip(faces, first, strict=False)])
        primitive: dict[str, Any] = {
            "attributes": {"POSITION": self._accessor(points.astype("<f4"), 5126, "VEC3")},
            "indices": self._accessor(facets.ravel().astype("<u4"), 5125, "SCALAR"),
        }
        if colour is not None:
            look = {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0}
            material = {"pbrMetallicRoughness": look}
            if material not in self.document["materials"]:
                self.document["materials"].append(material)
            primitive["material"] = self.document["materials"].index(material)
        return primitive

    def _accessor(self, numbers: NDArray[Any], kind: int, width: str) -> int:
        """Writes numbers; returns the index of their accessor."""
        data = numbers.tobytes()
        views, accessors = self.document["bufferViews"], self.document["accessors"]
        views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary += data
        accessor = {
            "bufferView": len(views) - 1,
            "componentType": kind,
            "count": len(numbers),
            "type": width,
        }
        if width == "VEC3":
            accessor["min"] = numbers.min(axis=0).tolist()
            accessor["max"] = numbers.max(axis=0).tolist()
        accessors.append(accessor)
        return len(accessors) - 1


def convert(
    path: str | os.PathLike[str], chord: float = 0.05, angle: float = 0.2
) -> tuple[bytes, dict[str, Any]]:
    """Tessellates a STEP file and converts it to GLB.

    Parameters
    ----------
    path : str or os.PathLike
    chord : float
        The intended chord error, in millimetres.
    angle : float
        The largest angle between neighbouring facets of one face, in radians.

    Returns
    -------
    glb : bytes
    report : dict
        For each part its name, its number of solids, its chord error in millimetres, and the number
        of faces for each kind of measure; ``left_out``, the names of the parts without a face.
    """
    try:
        import OCP.STEPCAFControl  # noqa: F401
    except ImportError as error:
        raise StepError(
            "STEP files need cadquery-ocp-novtk: pip install 'cadquery-ocp-novtk>=8.0.1'"
        ) from error
    path = Path(path)
    with path.open("rb") as file:
        if not file.read(1024).lstrip().startswith(b"ISO-10303-21"):
            raise StepError(f"{path}: not a STEP file: it does not begin with ISO-10303-21")
    _say(f"{path}: reading")
    product = Product(path)
    writer = Writer(product, chord, angle)
    writer.write(product.roots())
    if not writer.parts:
        raise StepError(
            f"{path}: none of its {len(writer.left_out)} parts has a face; "
            "export solids, not curves or points"
        )
    if writer.left_out:
        _say(f"{path}: {writer.note()}")
    report: dict[str, Any] = {"unit": "mm", "chord": chord, "angle": angle, "parts": writer.parts}
    report["left_out"] = writer.left_out
    return Glb(writer.document, bytes(writer.binary)).to_bytes(), report


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def main() -> int:
    """Runs the command line and returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m colltrans.step", description=__doc__)
    parser.add_argument("file", help="a STEP file")
    parser.add_argument("--chord", type=float, default=0.05, help="in millimetres (default 0.05)")
    parser.add_argument("--angle", type=float, default=0.2, help="in radians (default 0.2)")
    parser.add_argument("-o", "--output", required=True, help="the GLB file to write, or -")
    arguments = parser.parse_args()
    if not (0 < arguments.chord < float("inf") and 0 < arguments.angle < float("inf")):
        parser.error("--chord and --angle must be positive and finite")
    # Output of a library on standard output must not mix with the GLB file or the report.
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    try:
        glb, report = convert(arguments.file, arguments.chord, arguments.angle)
        told = glb
        if arguments.output != "-":
            Path(arguments.output).write_bytes(glb)
            told = json.dumps(report).encode() + b"\n"
        with output:
            output.write(told)
    except (StepError, OSError) as error:
        _say(str(error))
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main())
