"""STEP files: tessellated, with chord errors that are measured."""

import json
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import colltrans
from colltrans import step

RADIUS, HEIGHT = 10.0, 30.0


def rod(
    name: str = "rod", scale: str = ".MILLI.", colour: tuple[float, float, float] | None = None
) -> str:
    """A cylinder about z, as a STEP file."""
    lines: list[str] = []

    def put(text: str) -> str:
        lines.append(f"#{len(lines) + 1}={text};")
        return f"#{len(lines)}"

    def point(x: float, y: float, z: float) -> str:
        return put(f"CARTESIAN_POINT('',({x!r},{y!r},{z!r}))")

    def direction(x: float, y: float, z: float) -> str:
        return put(f"DIRECTION('',({x!r},{y!r},{z!r}))")

    def place(z: float, up: float = 1.0) -> str:
        at, axis = point(0.0, 0.0, z), direction(0.0, 0.0, up)
        return put(f"AXIS2_PLACEMENT_3D('',{at},{axis},{direction(1.0, 0.0, 0.0)})")

    def face(surface: str, edges: list[tuple[str, bool]], kept: bool = True) -> str:
        oriented = [put(f"ORIENTED_EDGE('',*,*,{e},{'.T.' if way else '.F.'})") for e, way in edges]
        loop = put(f"EDGE_LOOP('',({','.join(oriented)}))")
        bound = put(f"FACE_OUTER_BOUND('',{loop},.T.)")
        return put(f"ADVANCED_FACE('',({bound}),{surface},{'.T.' if kept else '.F.'})")

    ends = [put(f"VERTEX_POINT('',{point(RADIUS, 0.0, z)})") for z in (0.0, HEIGHT)]
    rings = []
    for end, z in zip(ends, (0.0, HEIGHT), strict=True):
        circle = put(f"CIRCLE('',{place(z)},{RADIUS!r})")
        rings.append(put(f"EDGE_CURVE('',{end},{end},{circle},.T.)"))
    way = put(f"VECTOR('',{direction(0.0, 0.0, 1.0)},1.)")
    line = put(f"LINE('',{point(RADIUS, 0.0, 0.0)},{way})")
    seam = put(f"EDGE_CURVE('',{ends[0]},{ends[1]},{line},.T.)")
    side = put(f"CYLINDRICAL_SURFACE('',{place(0.0)},{RADIUS!r})")
    faces = [
        face(side, [(rings[0], True), (seam, True), (rings[1], False), (seam, False)]),
        face(put(f"PLANE('',{place(0.0, -1.0)})"), [(rings[0], False)]),
        face(put(f"PLANE('',{place(HEIGHT)})"), [(rings[1], True)]),
    ]
    shell = put(f"CLOSED_SHELL('',({','.join(faces)}))")
    brep = put(f"MANIFOLD_SOLID_BREP('',{shell})")
    unit = put(f"(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({scale},.METRE.))")
    angle = put("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    solid = put("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    off = put(
        f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{unit},'distance_accuracy_value','')"
    )
    context = put(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({off}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({unit},{angle},{solid}))REPRESENTATION_CONTEXT('',''))"
    )
    shape = put(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({place(0.0)},{brep}),{context})")
    application = put("APPLICATION_CONTEXT('automotive design')")
    about = put(f"PRODUCT_CONTEXT('',{application},'mechanical')")
    product = put(f"PRODUCT('{name}','{name}','',({about}))")
    formation = put(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    design = put(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = put(f"PRODUCT_DEFINITION('design','',{formation},{design})")
    defined = put(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
    put(f"SHAPE_DEFINITION_REPRESENTATION({defined},{shape})")
    if colour is not None:
        style = "{!r},{!r},{!r}".format(*colour)
        for text in (
            "COLOUR_RGB('',{})",
            "FILL_AREA_STYLE_COLOUR('',{})",
            "FILL_AREA_STYLE('',({}))",
            "SURFACE_STYLE_FILL_AREA({})",
            "SURFACE_SIDE_STYLE('',({}))",
            "SURFACE_STYLE_USAGE(.BOTH.,{})",
            "PRESENTATION_STYLE_ASSIGNMENT(({}))",
        ):
            style = put(text.format(style))
        item = put(f"STYLED_ITEM('color',({style}),{brep})")
        put(f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({item}),{context})")
    body = "\n".join(lines)
    return (
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
        "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
        f"{body}\nENDSEC;\nEND-ISO-10303-21;\n"
    )


def test_distances_from_surfaces() -> None:
    """Against what is known of single facets."""
    square = np.array([[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0]]])
    cylinder = {"type": "cylinder", "origin": [0, 0, 5], "axis": [0, 0, 2], "radius": 1.0}
    error, how = step.on_surface(cylinder, square)
    assert how == "exact"
    assert error == pytest.approx(1 - np.sqrt(0.5))
    plane = {"type": "plane", "origin": [0, 0, 0.25], "normal": [0, 0, 1]}
    error, how = step.on_surface(plane, square)
    assert how == "exact"
    assert error == pytest.approx(0.75)
    sphere = {"type": "sphere", "center": [0, 0, 0], "radius": 2.0}
    # The nearest point of the facet is the middle of its first side.
    error, how = step.on_surface(sphere, square)
    assert how == "exact"
    assert error == pytest.approx(2 - np.sqrt(0.5))
    with pytest.raises(step.StepError, match="the surface spline is not known"):
        step.on_surface({"type": "spline"}, square)


def test_distances_beside_facets() -> None:
    """All corners against all facets, one by one."""
    random = np.random.default_rng(4)
    for _ in range(20):
        fine, facets = random.normal(size=(40, 3, 3)), random.normal(size=(30, 3, 3))
        facets[0] = facets[0, 0]  # without an area
        slow = max(
            min(float(step._nearest(corner, facet)) for facet in facets)
            for corner in fine.reshape(-1, 3)
        )
        assert step.beside(fine, facets) == pytest.approx(slow, abs=1e-15)


@pytest.mark.parametrize(("chord", "angle"), [(0.05, 0.2), (0.5, 2.0), (0.001, 0.5)])
def test_a_rod_is_as_far_off_as_is_said(tmp_path: Path, chord: float, angle: float) -> None:
    """The chord error is that of the polygon which the facets are."""
    pytest.importorskip("cascadio")
    (tmp_path / "rod.step").write_text(rod())
    glb, report = step.convert(tmp_path / "rod.step", chord, angle)
    (part,) = report["parts"]
    sides = {tuple(p) for p in step.Glb.parse(glb).numbers(0)[:, :2].tolist()}
    true = RADIUS * (1 - np.cos(np.pi / len(sides)))
    assert part["chord_error"] == pytest.approx(true, rel=1e-3)
    assert (part["exact"], part["sampled"], part["compared"]) == (3, 0, 0)


def test_a_file_is_read_by_its_unit(tmp_path: Path) -> None:
    """Lengths are millimetres whatever the file is in."""
    pytest.importorskip("cascadio")
    for scale, size in ((".MILLI.", 1.0), (".CENTI.", 10.0)):
        (tmp_path / "rod.stp").write_text(rod(scale=scale))
        assembly = colltrans.Assembly.read(tmp_path / "rod.stp", chord=0.05 * size)
        assert (assembly.unit, len(assembly.parts)) == ("mm", 1)
        (error,) = assembly.chord_errors
        assert error is not None
        assert 0 < error < 0.1 * size


def test_the_command_line_writes_a_file(tmp_path: Path) -> None:
    """A GLB file, and what was measured; or the GLB alone."""
    pytest.importorskip("cascadio")
    (tmp_path / "rod.step").write_text(rod())
    call = [sys.executable, "-m", "colltrans.step", "rod.step", "-o"]
    done = subprocess.run([*call, "rod.glb"], cwd=tmp_path, capture_output=True, check=True)
    told = json.loads(done.stdout)
    assert told["unit"] == "mm"
    assert [part["name"] for part in told["parts"]] == ["rod"]
    piped = subprocess.run([*call, "-"], cwd=tmp_path, capture_output=True, check=True)
    assert piped.stdout == (tmp_path / "rod.glb").read_bytes()


def test_colours_are_those_of_the_file(tmp_path: Path) -> None:
    """Of STEP as screens have them, of glTF linear; without a colour none is made up."""
    pytest.importorskip("cascadio")

    def material(text: str) -> object:
        (tmp_path / "rod.step").write_text(text)
        glb, _ = step.convert(tmp_path / "rod.step")
        document = step.Glb.parse(glb).document
        (primitive,) = document["meshes"][0]["primitives"]
        if "material" not in primitive:
            return None
        look = document["materials"][primitive["material"]]["pbrMetallicRoughness"]
        return look["baseColorFactor"]

    assert material(rod(colour=(1.0, 0.0, 0.5))) == pytest.approx([1.0, 0.0, 0.214, 1.0], abs=1e-3)
    assert material(rod()) is None


class Shapes(step.Glb):
    """A file whose shapes have no faces, each of which takes some time."""

    def faces(self, mesh: int) -> Iterator[Any]:
        time.sleep(0.03)
        yield from ()


def test_big_files_say_how_far_they_are(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Now and then, not of every shape, and not of small ones at all."""
    shapes = Shapes({"meshes": [{}] * 10}, b"")
    step.measure(shapes, None)
    assert capfd.readouterr().err == ""
    monkeypatch.setattr(step, "_SAID_EVERY", 0.1)
    assert len(step.measure(shapes, None)) == 10
    said = capfd.readouterr().err.splitlines()
    assert 0 < len(said) < 4
    assert all(re.fullmatch(r"measuring chord errors: \d of 10 shapes", line) for line in said)


def test_what_is_no_step_file_is_refused(tmp_path: Path) -> None:
    """With a message that names the file."""
    pytest.importorskip("cascadio")
    (tmp_path / "a.step").write_text("solid a\nendsolid a\n")
    with pytest.raises(step.StepError, match=r"a\.step: is no STEP file"):
        step.convert(tmp_path / "a.step")
    (tmp_path / "a.step").write_text("ISO-10303-21;\nnonsense")
    with pytest.raises(step.StepError, match=r"a\.step"):
        step.convert(tmp_path / "a.step")
