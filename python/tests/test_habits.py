"""Tests NumPy conventions: selecting and comparing columns, masks, pictures, docstrings."""

import pickle
import re
import sys
import threading
import time
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

import colltrans
from colltrans import (
    Assembly,
    Cast,
    ConvexPolyhedron,
    InputError,
    Motion,
    MotionCast,
    Pair,
    Solid,
    SolidCast,
    cast,
    cast_many,
    clearance_many,
    contact_range,
    distance_many,
)
from colltrans.columns import Failed, concatenate
from colltrans.pictures import EDGE, FIXED, MOVING, TOUCH

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
AHEAD = [1.0, 0, 0]
STARTS = np.array([[-3, 0.5, 0], [-4, 9, 0], [np.nan, 0, 0], [-5, 0.25, 0.5]])


def columns() -> Any:
    return cast_many(CUBE, CUBE, AHEAD, moving_pose=STARTS)


def test_the_version_is_that_of_the_package() -> None:
    text = (ROOT / "python" / "pyproject.toml").read_text()
    assert f'version = "{colltrans.__version__}"' in text


def test_outcomes_compare_as_text() -> None:
    outcome = columns().outcome
    assert (outcome == "contact").tolist() == [True, False, False, True]
    assert (outcome != "error").tolist() == [True, True, False, True]
    assert (outcome == ["contact"] * 4).tolist() == [True, False, False, True]
    assert (np.array(["separated"] * 4) == outcome).tolist() == [False, True, False, False]
    assert (outcome == columns().outcome).all()
    assert np.isin(outcome, ["contact", "error"]).tolist() == [True, False, True, True]
    assert outcome.tolist() == list(outcome) == ["contact", "separated", "error", "contact"]
    assert outcome[-1] == "contact" and outcome[1:3].tolist() == ["separated", "error"]
    assert outcome.codes.dtype == np.uint8 and outcome.codes.tolist() == [0, 2, 3, 0]
    assert np.unique(outcome).tolist() == ["contact", "error", "separated"]
    again = pickle.loads(pickle.dumps(outcome))
    assert repr(again) == repr(outcome) and (again == outcome).all()


@pytest.mark.parametrize("wrong", ["contcat", ["contact", "x", "error", "error"]])
def test_comparing_with_an_unknown_outcome_is_an_error(wrong: Any) -> None:
    with pytest.raises(InputError, match="unknown outcome '"):
        columns().outcome == wrong  # noqa: B015


def test_columns_select_rows() -> None:
    whole = columns()
    for which in (slice(1, None), [1, 2, 3], np.array([False, True, True, True]), np.r_[1:4]):
        some = whole[which]
        assert type(some) is type(whole) and len(some) == 3
        assert some.errors == {1: whole.errors[2]} and isinstance(some[1], Failed)
        assert np.array_equal(some.translation, whole.translation[1:], equal_nan=True)
        assert some[2].translation == 4.0 and some[2].query.moving_pose.translation[0] == -5
    assert whole[whole.outcome == "contact"].translation.tolist() == [2, 4]
    assert whole[::-1][0].translation == 4.0 and isinstance(whole[::-1][1:][0], Failed)
    assert len(whole[[]]) == 0
    with pytest.raises(IndexError):
        whole[[7]]
    with pytest.raises(InputError, match=r"shape \(1, 2\)"):
        whole[np.array([[0, 1]])]


def test_columns_are_concatenated() -> None:
    whole = columns()
    other = cast_many(CUBE, CUBE, [0, 0, 1.0], moving_pose=[0, 0, -9])
    joined = concatenate([whole[:2], other, whole[2:]])
    assert joined.outcome.tolist() == ["contact", "separated", "contact", "error", "contact"]
    assert joined.errors == {3: whole.errors[2]}
    assert joined[2].translation == 8.0 and joined[4].translation == 4.0
    assert joined[2].query.direction.tolist() == [0, 0, 1]
    with pytest.raises(InputError, match="different classes: ClearanceColumns, ContactColumns"):
        concatenate([whole, clearance_many(CUBE, CUBE, AHEAD)])
    with pytest.raises(InputError, match="different classes: nothing"):
        concatenate([])


def test_columns_are_readable_through_the_arrow_interface() -> None:
    pa = pytest.importorskip("pyarrow")
    table = pa.table(columns())
    assert table.schema == columns().to_arrow().schema and table.num_rows == 4
    assert table["outcome"].to_pylist()[:2] == ["contact", "separated"]
    assert pa.RecordBatchReader.from_stream(columns()).read_all().num_rows == 4


def test_columns_become_data_sets() -> None:
    pytest.importorskip("xarray")
    told = columns().to_xarray()
    assert dict(told.sizes) == {"query": 4, "axis": 3}
    assert told.normal.sel(axis="x").values[0] == 1.0
    assert told.translation.where(told.outcome == "contact").values.tolist()[::3] == [2, 4]
    assert told.message.values[2].startswith("moving_pose")
    near = distance_many(CUBE, CUBE, moving_pose=STARTS).to_xarray()
    assert near.on_fixed.dims == ("query", "axis")


def test_masked_rows_are_not_computed() -> None:
    masked: Any = np.ma.array(
        np.array([[-3, 0.5, 0.0], [-3, 0.5, 0]]), mask=[[False] * 3, [False, True, False]]
    )
    told = cast_many(CUBE, CUBE, AHEAD, moving_pose=masked)
    assert told.outcome.tolist() == ["contact", "error"]
    index: Any = np.ma.array([0, 0], mask=[True, False])
    told = cast_many([CUBE], CUBE, AHEAD, moving_index=index, moving_pose=[-3, 0, 0])
    assert told.outcome.tolist() == ["error", "contact"]
    with pytest.raises(colltrans.errors.PoseError, match="NaN"):
        cast(CUBE, CUBE, AHEAD, moving_pose=masked[1])
    with pytest.raises(colltrans.errors.QueryError):
        cast(CUBE, CUBE, np.ma.array(AHEAD, mask=[True, False, False]), moving_pose=[-3, 0, 0])
    with pytest.raises(colltrans.errors.BuildError, match="point 1 is not finite"):
        ConvexPolyhedron(masked)
    whole = cast(CUBE, CUBE, np.ma.array(AHEAD), moving_pose=masked[0])
    assert isinstance(whole, colltrans.Contact) and whole.translation == 2.0


def test_vertices_are_marked_read_only() -> None:
    solid = Solid.read(ROOT / "data" / "plate.off")
    for array in (CUBE.vertices, solid.vertices, solid.triangles):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 7


def test_the_last_contact_is_in_the_direction_asked() -> None:
    found = contact_range(CUBE, CUBE, [0.5, 0, 0], moving_pose=[-3, 0.5, 0])
    assert isinstance(found, colltrans.ContactRange)
    last = found.last
    assert (last.translation, found.interval[1]) == (8.0, 8.0)
    assert last.lower <= 8.0 <= last.upper < 8.0 + 1e-12
    assert last.query.direction.tolist() == [0.5, 0, 0]
    turned = last.turned
    assert isinstance(turned, colltrans.Contact) and turned.translation == -8.0
    assert np.array_equal(last.normal, turned.normal) and np.array_equal(last.point, turned.point)
    assert repr(last.features) == repr(turned.features)
    assert turned.certificate.verify() <= turned.certificate.rounding
    again = pickle.loads(pickle.dumps(last))
    assert repr(again) == repr(last) == "LastContact(translation=8.0, normal=[-1.0, 0.0, 0.0])"
    match last:
        case colltrans.answers.LastContact(translation, normal):
            assert translation == 8.0 and normal[0] == -1.0
    grazing = contact_range(CUBE, CUBE, AHEAD, moving_pose=[-3, 1, 0])
    assert isinstance(grazing, colltrans.ContactRange)
    assert isinstance(grazing.last.turned, colltrans.Grazing) and grazing.last.translation == 4.0


def things() -> list[Any]:
    solid = Solid.read(ROOT / "data" / "plate.off")
    turn = Motion.turn([0, 0, 0], [0, 0, 1], radians=1.0)
    moves = MotionCast(CUBE, CUBE, moving_motion=turn, fixed_motion=Motion.still([5, 0, 0]))
    over = SolidCast(CUBE, solid, [0, 0, -1], moving_pose=[0, 0, 9])
    query = Cast(CUBE, CUBE, AHEAD, moving_pose=[-3, 0.5, 0])
    flat = ConvexPolyhedron([[0, 0, 0], [1, 0, 0]])
    answers: list[Any] = [
        query.cast(),
        query.contact_range(),
        query.clearance(),
        over.clearance(),
    ]
    answers += [Pair(CUBE, CUBE, moving_pose=[-3, 0, 0]).distance(), moves.motion()]
    return [CUBE, flat, solid, query, over, moves, Pair(CUBE, solid), *answers]


@pytest.mark.parametrize("thing", things(), ids=lambda thing: type(thing).__name__)
def test_notebook_cells_show_small_drawings(thing: Any) -> None:
    shown = thing._repr_html_()
    assert "<svg" in shown and "nan" not in shown and len(shown) < 60_000
    coordinates = re.findall(r'd="([^"]*)"', shown)
    numbers = [float(x) for path in coordinates for x in re.findall(r"-?\d+\.\d", path)]
    assert numbers and min(numbers) >= 0 and max(numbers) <= 320


def test_notebook_cells_of_large_bodies_show_text_only() -> None:
    cloud = ConvexPolyhedron(np.random.default_rng(1).normal(size=(90_000, 3)))
    sphere = np.random.default_rng(1).normal(size=(2000, 3))
    dense = ConvexPolyhedron(sphere / np.linalg.norm(sphere, axis=1, keepdims=True))
    assert "<svg" in cloud._repr_html_() and "<svg" not in dense._repr_html_()  # type: ignore[attr-defined]


def test_notebook_cells_show_assemblies_and_plans() -> None:
    pytest.importorskip("plotly")
    gearbox = Assembly.read(ROOT / "data" / "gearbox_small")
    names = [trace.name for trace in colltrans.picture(gearbox).data if trace.name]
    assert names == gearbox.parts
    plan = gearbox.plan()
    figure = colltrans.picture(plan)
    bolt, still = (
        next(trace for trace in figure.data if trace.name == name)
        for name in ("bolt_0", plan.last[0])
    )
    assert (bolt.color, still.color) == (MOVING, FIXED)
    moved = np.ptp(np.array([bolt.z, gearbox.meshes()["bolt_0"][0][:, 2]]), axis=0)
    assert np.allclose(moved, abs(plan.displacements()["bolt_0"][2])) and moved.min() > 0
    table = plan._repr_html_()
    assert table.count("<tr>") == len(plan.stages) + 1 and "4 x bolt" in table
    body = colltrans.picture(CUBE)
    assert [trace.name for trace in body.data if trace.name] == ["body"]
    again = pickle.loads(pickle.dumps(plan))
    assert again == plan
    with pytest.raises(InputError, match="from a pickle"):
        again.show()


def test_colours_equal_those_of_the_page() -> None:
    text = (ROOT / "web" / "src" / "colours.ts").read_text().split("const DARK")[0]
    told = dict(re.findall(r'(\w+): "(#[0-9a-f]{6})"', text))
    assert (told["moving"], told["fixed"]) == (MOVING, FIXED)
    assert (told["normal"], told["edge"]) == (TOUCH, EDGE)


def test_every_class_has_a_repr() -> None:
    for name in colltrans.__all__:
        thing = getattr(colltrans, name)
        if isinstance(thing, type) and not issubclass(thing, BaseException):
            assert thing.__repr__ is not object.__repr__, name


def test_long_calls_release_the_interpreter_lock() -> None:
    random = np.random.default_rng(3)
    sphere = random.normal(size=(30_000, 3))
    large = ConvexPolyhedron(sphere / np.linalg.norm(sphere, axis=1, keepdims=True))
    placed: dict[str, Any] = {"moving_pose": [-0.5, 0.1, 0.2]}
    asked = [
        Cast(large, large, AHEAD, **placed, solver="cta").cast,
        Pair(large, large, **placed).depth,
    ]
    stopped = threading.Event()
    counted = [0]

    def count() -> None:
        while not stopped.is_set():
            counted[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    # The other thread runs only while the lock is released, because the switch interval never ends.
    before = sys.getswitchinterval()
    sys.setswitchinterval(1000)
    try:
        thread.start()
        time.sleep(0.01)
        for call in asked:
            seen = counted[0]
            for _ in range(20_000):
                call()
                if counted[0] > seen:
                    break
            assert counted[0] > seen
    finally:
        stopped.set()
        sys.setswitchinterval(before)
        thread.join()
