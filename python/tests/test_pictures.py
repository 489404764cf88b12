"""Tests that pictures show the data of the answers; they are drawn without a screen."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

import colltrans
from colltrans import Cast, ConvexPolyhedron, Pose, Solid, SolidCast, picture

pytest.importorskip("plotly")

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
CLOUD = ConvexPolyhedron(np.random.default_rng(3).normal(size=(40, 3)))


def named(figure: Any) -> dict[str, Any]:
    return {trace.name: trace for trace in figure.data if trace.name}


def points(trace: Any) -> Any:
    return np.column_stack([trace.x, trace.y, trace.z])


def test_a_contact_has_bodies_a_ghost_a_point_and_a_normal() -> None:
    contact = colltrans.cast(CUBE, CUBE, [2, 0, 0], moving_pose=[-3, 0.5, 0, 0, 0, 0, 1])
    assert isinstance(contact, colltrans.Contact)
    traces = named(picture(contact))
    assert set(traces) == {"moving", "fixed", "contact at 1", "point", "normal"}
    assert np.allclose(points(traces["moving"]).min(axis=0), [-3, 0.5, 0])
    assert np.allclose(points(traces["contact at 1"]).min(axis=0), [-1, 0.5, 0])
    assert np.allclose(points(traces["point"])[0], contact.point)
    foot, tip = points(traces["normal"])
    assert np.allclose(np.cross(tip - foot, contact.normal), 0) and tip[0] > foot[0]
    # Two triangles for each face, and only the edges between faces.
    assert len(traces["fixed"].i) == 12
    (lines,) = (t for t in picture(contact).data[1:2])
    assert len(lines.x) == 3 * 12


def test_the_ghost_of_a_turned_body_touches() -> None:
    query = Cast(CLOUD, CUBE, [0.1, 0, -1], moving_pose=[0.3, 0.2, 6, 0.5, 0.5, 0.5, 0.5])
    contact = query.cast()
    assert isinstance(contact, colltrans.Contact)
    ghost = next(t for name, t in named(picture(query)).items() if name.startswith("contact"))
    assert abs(points(ghost)[:, 2].min() - 1) < 1e-9 or contact.features.fixed.kind != "face"
    gap = (points(ghost) - contact.point) @ contact.normal
    assert abs(gap.max()) < 1e-9


@pytest.mark.parametrize("start", [[-4, 0.3, 0], [-3, 1, 0], [-3, 5, 0], [4, 0, 0], [0.2, 0, 0]])
def test_every_answer_has_a_picture(start: list[float], tmp_path: Path) -> None:
    query = Cast(CUBE, CUBE, [1, 0, 0], moving_pose=start)
    answers: list[Any] = [query, query.cast(), query.contact_range(), query.clearance()]
    answers += [query.directional_depth(), query.intersects()]
    for answer in answers:
        assert {"moving", "fixed"} <= set(named(picture(answer)))
    answers[-1].show(file=tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text()
    assert "plotly" in page and "<script src=" not in page


def test_solids_and_bodies_of_every_dimension() -> None:
    bolt, plate = Solid.read(ROOT / "data/bolt.stl"), Solid.read(ROOT / "data/plate.off")
    for height, name in ((7, "blocked at 7"), (0.5, None), (-40, None)):
        query = SolidCast(bolt, plate, [0, 0, -1], moving_pose=[0, 0, height])
        for answer in (query, query.clearance()):
            traces = named(picture(answer))
            assert {"moving", "fixed"} <= set(traces)
            assert name is None or name in traces
    assert len(named(picture(query))["moving"].i) == len(bolt.triangles)
    for corners in ([[0, 0, 0]], [[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [1, 0, 0], [0, 1, 0]]):
        flat = ConvexPolyhedron(corners)
        assert picture(Cast(flat, CUBE, [0, 0, -1], moving_pose=[0.2, 0.2, 3])).data


def test_show_hands_the_figure_to_plotly(monkeypatch: pytest.MonkeyPatch) -> None:
    import plotly.graph_objects as go

    shown: list[Any] = []
    monkeypatch.setattr(go.Figure, "show", lambda figure: shown.append(figure))
    Cast(CUBE, CUBE, [1, 0, 0], moving_pose=[-3, 0, 0]).show()
    assert len(shown) == 1 and "contact at 2" in named(shown[0])


def test_other_objects_are_refused() -> None:
    with pytest.raises(TypeError, match="Pose is not a body, a query or an answer"):
        picture(Pose())
    with pytest.raises(TypeError):
        Cast(CUBE, CUBE, [1, 0, 0]).show(colour="red")
