"""Tests the tessellation of STEP files, with measured chord errors."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import colltrans
from colltrans import step

RADIUS, HEIGHT = 10.0, 30.0
DATA = Path(__file__).resolve().parents[3] / "shared" / "data"


class StepText:
    """The text of a STEP file under construction."""

    def __init__(self, scale: str = ".MILLI.") -> None:
        self.lines: list[str] = []
        unit = self.put(f"(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({scale},.METRE.))")
        angle = self.put("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        solid = self.put("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
        off = self.put(
            f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{unit},"
            "'distance_accuracy_value','')"
        )
        self.context = self.put(
            f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({off}))"
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({unit},{angle},{solid}))REPRESENTATION_CONTEXT('',''))"
        )
        self.application = self.put("APPLICATION_CONTEXT('automotive design')")
        self.about = self.put(f"PRODUCT_CONTEXT('',{self.application},'mechanical')")
        self.origin = self.place(0.0)

    def put(self, text: str) -> str:
        """Adds an entity; returns its name."""
        self.lines.append(f"#{len(self.lines) + 1}={text};")
        return f"#{len(self.lines)}"

    def point(self, x: float, y: float, z: float) -> str:
        return self.put(f"CARTESIAN_POINT('',({x!r},{y!r},{z!r}))")

    def direction(self, x: float, y: float, z: float) -> str:
        return self.put(f"DIRECTION('',({x!r},{y!r},{z!r}))")

    def place(self, z: float, up: float = 1.0) -> str:
        at, axis = self.point(0.0, 0.0, z), self.direction(0.0, 0.0, up)
        return self.put(f"AXIS2_PLACEMENT_3D('',{at},{axis},{self.direction(1.0, 0.0, 0.0)})")

    def rod(self) -> str:
        """Adds a cylinder about z."""
        put, point, direction, place = self.put, self.point, self.direction, self.place

        def face(surface: str, edges: list[tuple[str, bool]]) -> str:
            oriented = [
                put(f"ORIENTED_EDGE('',*,*,{e},{'.T.' if way else '.F.'})") for e, way in edges
            ]
            loop = put(f"EDGE_LOOP('',({','.join(oriented)}))")
            bound = put(f"FACE_OUTER_BOUND('',{loop},.T.)")
            return put(f"ADVANCED_FACE('',({bound}),{surface},.T.)")

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
        return put(f"MANIFOLD_SOLID_BREP('',{shell})")

    def product(self, name: str, shape: str) -> str:
        """Adds a product of a shape; returns its definition. The name is written as it is."""
        put = self.put
        product = put(f"PRODUCT('{name}','{name}','',({self.about}))")
        formation = put(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
        design = put(f"PRODUCT_DEFINITION_CONTEXT('part definition',{self.application},'design')")
        definition = put(f"PRODUCT_DEFINITION('design','',{formation},{design})")
        defined = put(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
        put(f"SHAPE_DEFINITION_REPRESENTATION({defined},{shape})")
        return definition

    def part(self, name: str, *solids: str) -> tuple[str, str]:
        """Adds a product of solids; returns its definition and its shape."""
        items = ",".join([self.origin, *solids])
        shape = self.put(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({items}),{self.context})")
        return self.product(name, shape), shape

    def curve(self, name: str) -> tuple[str, str]:
        """Adds a product of a circle; returns its definition and its shape."""
        circle = self.put(f"CIRCLE('',{self.place(0.0)},{RADIUS!r})")
        curves = self.put(f"GEOMETRIC_CURVE_SET('',({circle}))")
        shape = self.put(
            "GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION("
            f"'',({self.origin},{curves}),{self.context})"
        )
        return self.product(name, shape), shape

    def assembly(self, name: str, *children: tuple[str, str]) -> tuple[str, str]:
        """Adds a product in which others are placed, one above the other."""
        put = self.put
        places = [self.place(2 * HEIGHT * k) for k in range(len(children))]
        items = ",".join([self.origin, *places])
        shape = put(f"SHAPE_REPRESENTATION('',({items}),{self.context})")
        definition = self.product(name, shape)
        for number, ((child, child_shape), place) in enumerate(zip(children, places, strict=True)):
            usage = put(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{number}','','',{definition},{child},$)")
            placed = put(f"PRODUCT_DEFINITION_SHAPE('','',{usage})")
            move = put(f"ITEM_DEFINED_TRANSFORMATION('','',{self.origin},{place})")
            related = put(
                f"(REPRESENTATION_RELATIONSHIP('','',{child_shape},{shape})"
                f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({move})"
                "SHAPE_REPRESENTATION_RELATIONSHIP())"
            )
            put(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({related},{placed})")
        return definition, shape

    def text(self) -> str:
        """Returns the whole file."""
        body = "\n".join(self.lines)
        return (
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
            "FILE_NAME('','',(''),(''),'','','');\n"
            "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
            f"{body}\nENDSEC;\nEND-ISO-10303-21;\n"
        )


def rod(
    name: str = "rod", scale: str = ".MILLI.", colour: tuple[float, float, float] | None = None
) -> str:
    """Returns a cylinder about z as a STEP file."""
    text = StepText(scale)
    brep = text.rod()
    text.part(name, brep)
    if colour is not None:
        style = "{!r},{!r},{!r}".format(*colour)
        for form in (
            "COLOUR_RGB('',{})",
            "FILL_AREA_STYLE_COLOUR('',{})",
            "FILL_AREA_STYLE('',({}))",
            "SURFACE_STYLE_FILL_AREA({})",
            "SURFACE_SIDE_STYLE('',({}))",
            "SURFACE_STYLE_USAGE(.BOTH.,{})",
            "PRESENTATION_STYLE_ASSIGNMENT(({}))",
        ):
            style = text.put(form.format(style))
        item = text.put(f"STYLED_ITEM('color',({style}),{brep})")
        text.put(
            f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({item}),{text.context})"
        )
    return text.text()


def test_distances_to_curved_surfaces_are_bounded() -> None:
    """Compares with known values for single facets."""
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
    with pytest.raises(step.StepError, match="unknown surface type spline"):
        step.on_surface({"type": "spline"}, square)


def test_distances_beside_facets_are_bounded() -> None:
    """Compares all corners with all facets, one by one."""
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
def test_the_reported_deviation_of_a_rod_holds(tmp_path: Path, chord: float, angle: float) -> None:
    """The chord error is that of the polygon of the facets."""
    pytest.importorskip("OCP")
    (tmp_path / "rod.step").write_text(rod())
    glb, report = step.convert(tmp_path / "rod.step", chord, angle)
    (part,) = report["parts"]
    sides = {tuple(p) for p in step.Glb.parse(glb).numbers(0)[:, :2].tolist()}
    true = RADIUS * (1 - np.cos(np.pi / len(sides)))
    assert part["chord_error"] == pytest.approx(true, rel=1e-3)
    assert (part["exact"], part["sampled"], part["compared"]) == (3, 0, 0)
    assert part["solids"] == 1


def test_a_file_is_read_by_its_unit(tmp_path: Path) -> None:
    """Lengths become millimetres for every unit of the file."""
    pytest.importorskip("OCP")
    for scale, size in ((".MILLI.", 1.0), (".CENTI.", 10.0)):
        (tmp_path / "rod.stp").write_text(rod(scale=scale))
        assembly = colltrans.Assembly.read(tmp_path / "rod.stp", chord=0.05 * size)
        assert (assembly.unit, len(assembly.parts)) == ("mm", 1)
        (error,) = assembly.chord_errors
        assert error is not None
        assert 0 < error < 0.1 * size


def test_the_command_line_writes_a_file(tmp_path: Path) -> None:
    """Returns a GLB file and its report, or the GLB alone."""
    pytest.importorskip("OCP")
    (tmp_path / "rod.step").write_text(rod())
    call = [sys.executable, "-m", "colltrans.step", "rod.step", "-o"]
    done = subprocess.run([*call, "rod.glb"], cwd=tmp_path, capture_output=True, check=True)
    told = json.loads(done.stdout)
    assert told["unit"] == "mm"
    assert [part["name"] for part in told["parts"]] == ["rod"]
    piped = subprocess.run([*call, "-"], cwd=tmp_path, capture_output=True, check=True)
    assert piped.stdout == (tmp_path / "rod.glb").read_bytes()


def test_colours_are_those_of_the_file(tmp_path: Path) -> None:
    """STEP colours are sRGB, glTF colours linear; a missing colour stays missing."""
    pytest.importorskip("OCP")

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


def test_large_files_report_progress(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Progress is reported at most twice a second, and before free-form faces of many facets."""
    pytest.importorskip("OCP")
    text = StepText()
    text.assembly("machine", *(text.part(f"rod {k}", text.rod()) for k in range(5)))
    (tmp_path / "rods.step").write_text(text.text())
    monkeypatch.setattr(step, "_SAID_EVERY", -1.0)
    step.convert(tmp_path / "rods.step")
    said = capfd.readouterr().err.splitlines()
    assert said[-5:] == [f"part 'rod {k}' (shape {k + 1} of 5): tessellating" for k in range(5)]
    monkeypatch.setattr(step, "_SAID_EVERY", 1e9)
    step.convert(tmp_path / "rods.step")
    assert not any("shape" in line for line in capfd.readouterr().err.splitlines())
    monkeypatch.setattr(step, "_surface", lambda face: None)
    monkeypatch.setattr(step, "_MANY_FACETS", 1)
    step.convert(tmp_path / "rods.step")
    said = capfd.readouterr().err.splitlines()
    assert [line.split(":")[0] for line in said[-5:]] == [
        f"part 'rod {k}' (shape {k + 1} of 5)" for k in range(5)
    ]
    assert all("free-form faces" in line and line.endswith("to compare") for line in said[-5:])


#: Names of products as bytes of a file, and as they are read.
NAMES = {
    "plain": (b"Gruppe", "Gruppe"),
    "x2": (rb"Geh\X2\00E4\X0\use", "Geh\u00e4use"),
    "x": (rb"Geh\X\E4use", "Geh\u00e4use"),
    "s": (rb"Geh\S\duse", "Geh\u00e4use"),
    "latin1": ("Geh\u00e4use".encode("latin-1"), "Geh\u00e4use"),
    "utf8": ("Geh\u00e4use".encode(), "Geh\u00e4use"),
    "apostrophe": (b"Bob''s group", "Bob's group"),
    "backslash": (rb"a\\b", "a\\b"),
    "parenthesis": (b"a); (b", "a); (b"),
    "empty": (b"", None),
}


@pytest.mark.parametrize("kind", NAMES)
def test_a_sub_assembly_is_split_whatever_its_name(tmp_path: Path, kind: str) -> None:
    """Three parts keep the intended names."""
    pytest.importorskip("OCP")
    text = StepText()
    bolt = text.part("bolt", text.rod())
    group = text.assembly("GROUP", bolt, bolt)
    text.assembly("top", text.part("plate", text.rod()), group)
    written, meant = NAMES[kind]
    (tmp_path / "top.step").write_bytes(text.text().encode().replace(b"GROUP", written))
    glb, report = step.convert(tmp_path / "top.step")
    assert [(part["name"], part["solids"]) for part in report["parts"]] == [
        ("plate", 1),
        ("bolt", 1),
        ("bolt", 1),
    ]
    names = {node["name"] for node in step.Glb.parse(glb).document["nodes"]}
    if meant is not None:
        assert meant in names
    assert len(colltrans.Assembly.read(tmp_path / "top.step").parts) == 3


def test_a_product_of_several_solids_is_one_part(tmp_path: Path) -> None:
    """Also for files with a product tree; each solid is counted."""
    pytest.importorskip("OCP")
    text = StepText()
    pair = text.part("pair", text.rod(), text.rod())
    text.assembly("top", text.part("plate", text.rod()), pair)
    (tmp_path / "top.step").write_text(text.text())
    _, report = step.convert(tmp_path / "top.step")
    assert [(p["name"], p["solids"]) for p in report["parts"]] == [("plate", 1), ("pair", 2)]


def test_curves_are_left_out_with_a_note(tmp_path: Path) -> None:
    """A part of curves next to solids is named, and a file with curves only is refused."""
    pytest.importorskip("OCP")
    text = StepText()
    text.assembly("top", text.part("rod", text.rod()), text.curve("axis"))
    (tmp_path / "top.step").write_text(text.text())
    _, report = step.convert(tmp_path / "top.step")
    assert [part["name"] for part in report["parts"]] == ["rod"]
    assert report["left_out"] == ["axis"]
    assembly = colltrans.Assembly.read(tmp_path / "top.step")
    assert [note for note in assembly.notes if "left out" in note and "'axis'" in note]
    text = StepText()
    text.curve("axis")
    (tmp_path / "axis.step").write_text(text.text())
    with pytest.raises(step.StepError, match=r"axis\.step: none of its 1 parts has a face"):
        step.convert(tmp_path / "axis.step")


#: Classic files and machines: their parts, and how many of these contain one solid.
COLLECTION = {
    "step/as1-oc-214.stp": 18,
    "step/as1-tu-203.stp": 18,
    "step/as1_pe_203.stp": 18,
    "step/dm1-oc-214.stp": 7,
    "step/s1/s1-c5-214.stp": 11,
    "machines/enclosure2.step": 13,
    "machines/nested.step": 3,
    "machines/solid_and_wire.step": 1,
    "machines/solids_and_point.step": 2,
    "machines/valveblock.step": 10,
    "machines/vise.step": 16,
    "machines/step_names/enc_apos.step": 3,
    "machines/step_names/enc_ascii.step": 3,
    "machines/step_names/enc_latin1.step": 3,
    "machines/step_names/enc_x2.step": 3,
}


def solids_of(path: Path) -> int:
    """Counts the solids of a file with OpenCASCADE's reader of shapes, without a tree."""
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum

    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    return sum(1 for _ in step._explored(reader.OneShape(), TopAbs_ShapeEnum.TopAbs_SOLID))


@pytest.mark.parametrize("name", COLLECTION)
def test_files_of_the_collection_have_all_their_parts(name: str) -> None:
    """Compares with known numbers of parts, and with the solids that another reader counts."""
    pytest.importorskip("OCP")
    path = DATA / name
    if not path.exists():
        pytest.skip("the collection is not here")
    _, report = step.convert(path, 1.0, 0.5)
    assert len(report["parts"]) == COLLECTION[name]
    # The other reader does not open external files.
    if "s1" not in name:
        assert sum(part["solids"] for part in report["parts"]) == solids_of(path)


def test_external_files_are_read_or_named(tmp_path: Path) -> None:
    """External files are in the same folder; a missing one is an error with its name."""
    pytest.importorskip("OCP")
    source = DATA / "step" / "s1"
    if not source.exists():
        pytest.skip("the collection is not here")
    for file in source.glob("*.stp"):
        shutil.copyfile(file, tmp_path / file.name)
    call = [sys.executable, "-m", "colltrans.step", "s1-c5-214.stp", "--chord", "1", "-o", "-"]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, check=True)
    assert done.stdout.startswith(b"glTF")
    (tmp_path / "TAIL_TURBINE.stp").unlink()
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, check=False)
    assert (done.returncode, done.stdout) == (3, b"")
    assert b"TAIL_TURBINE.stp" in done.stderr.splitlines()[-1]


@pytest.mark.parametrize(
    ("file", "name"), [("s1-c5-214.stp", b"TAIL.stp"), ("TAIL.stp", b"TAIL_TURBINE.stp")]
)
def test_external_files_elsewhere_are_not_opened(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], file: str, name: bytes
) -> None:
    """The names of all files are checked before OpenCASCADE opens one."""
    pytest.importorskip("OCP")
    source = DATA / "step" / "s1"
    if not source.exists():
        pytest.skip("the collection is not here")
    for each in source.glob("*.stp"):
        shutil.copyfile(each, tmp_path / each.name)
    text = (tmp_path / file).read_bytes()
    (tmp_path / file).write_bytes(text.replace(b"'" + name + b"'", b"'../" + name + b"'"))
    with pytest.raises(step.StepError, match=rf"{file}: the external file \.\./{name.decode()}"):
        step.convert(tmp_path / "s1-c5-214.stp")
    assert "building the product tree" not in capfd.readouterr().err


def test_an_external_file_lies_in_the_folder_of_its_source() -> None:
    """Names of other folders differ from names in the folder of the source."""
    assert all(map(step._lies_beside, ["a.stp", "sub/a.stp", "b..stp"]))
    assert not any(map(step._lies_beside, ["../a.stp", "/a.stp", "C:\\a.stp", "x/..\\..\\a.stp"]))


def test_files_that_are_not_step_are_refused(tmp_path: Path) -> None:
    """The message names the file."""
    pytest.importorskip("OCP")
    (tmp_path / "a.step").write_text("solid a\nendsolid a\n")
    with pytest.raises(step.StepError, match=r"a\.step: not a STEP file"):
        step.convert(tmp_path / "a.step")
    (tmp_path / "a.step").write_text("ISO-10303-21;\nnonsense")
    with pytest.raises(step.StepError, match=r"a\.step"):
        step.convert(tmp_path / "a.step")
