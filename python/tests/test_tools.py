"""Tests the milling tools of the gallery against closed forms and the drop cutter of opencamlib."""

import runpy
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ROOT, Floats

tools = SimpleNamespace(**runpy.run_path(str(ROOT / "site" / "gallery" / "13-tools.py")))
R, CORNER, LENGTH = 0.5, 0.125, 3.0
BALL = tools.ball_mill(R, LENGTH)
BULL = tools.bull_nose_mill(R, CORNER, LENGTH)
FLAT = tools.flat_mill(R, LENGTH)
#: How far the sides of a prism of radius 1 are outside of the circle, at its corners.
CHORD = 1 / np.cos(np.pi / tools.SIDES) - 1
SQUARE: list[list[float]] = [[-9.0, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]
TWO = [[0, 1, 2], [0, 2, 3]]
#: An answer is below the contact by about 3 noises (32 u times the size, here up to 80), divided by
#: the component of the normal along the drop, here at least 0.3.
ROUNDING = 3 * 32 * 2.0**-53 * 80 / 0.3


def positions(seed: int, count: int, width: float) -> Floats:
    return np.random.default_rng(seed).uniform(-width, width, size=(count, 2))


def test_tools_rest_with_their_tips_on_a_plane() -> None:
    scene = tools.mesh_scene(SQUARE, TWO)
    for tool in (BALL, BULL, FLAT, tools.with_holder(FLAT, 1.0, 0.5, 2.0)):
        assert np.abs(tools.drop(tool, scene, positions(1, 20, 5), 4)).max() < ROUNDING
    assert tools.drop(BALL, scene, np.array([[20.0, 0]]), 4)[0] == -np.inf


@pytest.mark.parametrize("slope", [0.25, 1.0, 3.0])
def test_tools_rest_on_an_inclined_plane(slope: float) -> None:
    tilted = np.array(SQUARE) @ [[1, 0, slope], [0, 1, 0], [0, 0, 1]]
    scene, at = tools.mesh_scene(tilted, TWO), positions(2, 20, 2)
    higher = np.hypot(1, slope) - 1
    for tool, radius, corner in ((BALL, 0, R), (BULL, R - CORNER, CORNER), (FLAT, R, 0)):
        over = tools.drop(tool, scene, at, 40) - (
            slope * at[:, 0] + radius * slope + corner * higher
        )
        # A corner of the polygon is on the x axis.
        assert np.abs(over - CHORD * radius * slope).max() < ROUNDING


def test_tools_touch_an_edge_and_a_corner_of_a_block() -> None:
    # One face of a block: tools beside it touch its edge, or its corner at the origin.
    scene = tools.mesh_scene(np.array(SQUARE) / 9 + [-1, -1, 2], TWO)
    at = positions(3, 200, 0.6)
    aside = np.hypot(*np.maximum(at, 0).T)
    clear = np.abs(aside - R) > 2 * CHORD
    for tool, radius, corner in ((BALL, 0, R), (BULL, R - CORNER, CORNER), (FLAT, R, 0)):
        # A prism is wider by up to CHORD, so that it touches as if it were as much nearer.
        nearer = np.maximum(aside - radius * (1 + CHORD), 0)
        farther = np.maximum(aside - radius, 0)
        least, most = (
            2 + np.sqrt(np.maximum(corner**2 - x**2, 0)) - corner for x in (farther, nearer)
        )
        found, meets = tools.drop(tool, scene, at, 5), aside < R
        both = clear & meets
        assert (found[both] > least[both] - ROUNDING).all() and (
            found[both] < most[both] + ROUNDING
        ).all()
        assert (found[clear & ~meets] == -np.inf).all()


def test_a_ball_rests_on_a_tessellated_sphere() -> None:
    turns, rings = 96, 48
    around, up = np.meshgrid(np.linspace(0, 2 * np.pi, turns + 1), np.linspace(0, np.pi / 2, rings))
    vertices = np.stack(
        [np.cos(around) * np.cos(up), np.sin(around) * np.cos(up), np.sin(up)], axis=-1
    )
    k = np.arange(vertices[..., 0].size).reshape(around.shape)
    a, b, c, d = (part.ravel() for part in (k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]))
    fans = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    corners = vertices.reshape(-1, 3)
    # At the pole two corners coincide.
    fans = np.array(
        [t for t in fans if np.linalg.norm(np.cross(*(corners[t[1:]] - corners[t[0]]))) > 1e-12]
    )
    at = positions(4, 100, 0.7)
    found = tools.drop(BALL, tools.mesh_scene(corners, fans), at, 4)
    # The facets are inside the sphere, by at most this share of its radius.
    inside = 1 - np.cos(np.pi / turns) * np.cos(np.pi / (4 * (rings - 1)))
    least, most = (np.sqrt((x + R) ** 2 - (at**2).sum(axis=1)) - R for x in (1 - inside, 1.0))
    assert (found >= least - ROUNDING).all() and (found <= most + ROUNDING).all()


def test_a_holder_stops_a_tool_beside_a_wall() -> None:
    wall = np.array([[1.0, -9, 0], [1, 9, 0], [1, 9, 2.5], [1, -9, 2.5]])
    scene = tools.mesh_scene(np.concatenate([SQUARE, wall]), [*TWO, [4, 5, 6], [4, 6, 7]])
    held = tools.with_holder(BALL, 1.5, 2.0, 3.0)
    at = np.array([[0.0, 0], [-2, 0]])
    assert np.abs(tools.drop(BALL, scene, at, 5)).max() < ROUNDING
    assert tools.drop(held, scene, at, 5) == pytest.approx([0.5, 0], abs=ROUNDING)


def test_a_straight_move_between_two_positions_may_gouge() -> None:
    ridge = [[0, -9, 1], [0, 9, 1], [-3, -9, 0], [-3, 9, 0], [3, -9, 0], [3, 9, 0]]
    scene = tools.mesh_scene(ridge, [[0, 1, 2], [1, 3, 2], [0, 4, 1], [1, 4, 5]])
    at = np.array([[-2.0, 0], [2, 0]])
    path = np.column_stack([at, tools.drop(BALL, scene, at, 4) + 1e-9])
    found = tools.first_gouge(BALL, scene, path)
    # The ball moves level, and touches the face of the ridge where it began to touch it.
    assert found is not None and found[0] == 0 and found[1] < 1e-6
    for rise in (0.5, 0.62):
        higher = path + [0, 0, rise]
        k, share = tools.first_gouge(BALL, scene, higher)
        # At this height above the ridge the centre meets the plane of the face, or the edge.
        height = higher[0, 2] + R - 1
        x = 3 * height - R * np.sqrt(10)
        if x + R / np.sqrt(10) > 0:
            x = -np.sqrt(R**2 - height**2)
        assert (k, share) == (0, pytest.approx((2 + x) / 4, abs=ROUNDING))
    assert tools.first_gouge(BALL, scene, path + [0, 0, 2.0]) is None


def test_drops_equal_those_of_opencamlib() -> None:
    ocl = pytest.importorskip("opencamlib")
    vertices, triangles = tools.terrain(21)
    scene, surface = tools.mesh_scene(vertices, triangles), ocl.STLSurf()
    for corners in vertices[triangles]:
        surface.addTriangle(ocl.Triangle(*(ocl.Point(*map(float, v)) for v in corners)))
    at = positions(6, 300, 0.6)
    radius, corner = 0.2, 0.05
    cases = [
        (tools.ball_mill(radius, 1), ocl.BallCutter(2 * radius, 1), 0.0),
        (
            tools.bull_nose_mill(radius, corner, 1),
            ocl.BullCutter(2 * radius, corner, 1),
            radius - corner,
        ),
        (tools.flat_mill(radius, 1), ocl.CylCutter(2 * radius, 1), radius),
    ]
    slope = np.hypot(1.5, 0.5)
    for tool, cutter, core in cases:
        dropper = ocl.BatchDropCutter()
        dropper.setSTL(surface)
        dropper.setCutter(cutter)
        for x, y in at:
            dropper.appendPoint(ocl.CLPoint(float(x), float(y), -9.0))
        dropper.run()
        found = np.array([point.z for point in dropper.getCLPoints()])
        over = tools.drop(tool, scene, at, 3) - found
        # The prism around a cylinder is higher by up to its chord error times the slope.
        assert over.min() > -1e-7 and over.max() < CHORD * core * slope * 1.01 + 1e-7
