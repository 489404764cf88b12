"""Tests bulk calls with several axes, columns of features, and all directions."""

from typing import Any

import numpy as np
import pytest
from conftest import draw

from colltrans import (
    ConvexPolyhedron,
    InputError,
    Solid,
    cast,
    cast_many,
    clearance_many,
    contact_range_many,
    depth_many,
    distance_many,
    free_directions,
    motion_many,
    within_many,
)
from colltrans.columns import concatenate
from colltrans.removal import free_directions_many

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
PLATE = ConvexPolyhedron.cuboid([-2, -2, -1], [2, 2, 0])
DOWN = [0, 0, -1.0]


def test_axes_broadcast_as_in_numpy() -> None:
    starts = np.random.default_rng(5).uniform(-1, 1, (4, 1, 3)) + [0, 0, 5]
    ways = np.array([[0, 0, -1.0], [1, 0, -1], [0, 0, 1]])
    columns = cast_many(CUBE, PLATE, ways, moving_pose=starts, graze_tolerance=np.zeros((4, 3)))
    assert columns.shape == (4, 3) and len(columns) == 12
    found, normals = columns.stacked("translation"), columns.stacked("normal")
    assert found.shape == (4, 3) and normals.shape == (4, 3, 3)
    for i, j in np.ndindex(4, 3):
        alone: Any = cast(CUBE, PLATE, ways[j], moving_pose=starts[i, 0])
        assert np.array_equal(found[i, j], getattr(alone, "translation", np.nan), equal_nan=True)
        assert repr(columns[3 * i + j]) == repr(alone)
    outcomes = columns.stacked("outcome")
    assert outcomes.shape == (4, 3) and (outcomes == "contact")[:, [0, 2]].all()
    with pytest.raises(
        InputError, match="unknown column 'exit'; known columns: outcome, translation"
    ):
        columns.stacked("exit")
    # Selected or concatenated columns are rows.
    ahead = columns.translation > 0
    assert 0 < ahead.sum() < 12 and columns[ahead].shape == (ahead.sum(),)
    assert concatenate([columns, columns[:2]]).shape == (14,)


def test_every_question_accepts_stacks() -> None:
    starts = np.zeros((2, 2, 7))
    starts[..., 2] = np.array([[3, 4], [0.5, 9]])
    starts[..., 6] = 1
    index = np.array([[0, 0], [0, 0]])
    bodies: dict[str, Any] = {"moving_pose": starts, "moving_index": index}
    reach = clearance_many([CUBE], PLATE, DOWN, **bodies).stacked("translation")
    assert reach[0].tolist() == [3, 4]
    assert distance_many([CUBE], PLATE, **bodies).stacked("upper").shape == (2, 2)
    assert depth_many([CUBE], PLATE, **bodies).stacked("direction").shape == (2, 2, 3)
    near = within_many([CUBE], PLATE, [[3.5], [1.0]], **bodies).stacked("outcome") == "closer"
    assert near.tolist() == [[True, False], [True, False]]
    slides: dict[str, Any] = {"slide": {"by": [[0, 0, -10.0], [0, 0, 10]]}}
    moved = motion_many([CUBE], PLATE, slides, moving_pose=starts[:, :1], moving_index=index)
    assert moved.shape == (2, 2) and moved.stacked("outcome")[0].tolist() == ["contact", "free"]
    solid = Solid(*_mesh())
    lifted = clearance_many(solid, PLATE, DOWN, moving_pose=starts, tolerance=[[0.1], [0.2]])
    assert lifted.shape == (2, 2) and lifted.stacked("distance")[0].round(9).tolist() == [3, 4]
    matrices = np.broadcast_to(np.eye(4), (3, 2, 4, 4))
    assert cast_many(CUBE, CUBE, DOWN, moving_pose=matrices).shape == (3, 2)


def test_a_single_row_and_no_row_keep_their_shapes() -> None:
    assert cast_many(CUBE, PLATE, DOWN, moving_pose=[0, 0, 5]).shape == (1,)
    assert cast_many(CUBE, PLATE, np.zeros((0, 3))).shape == (0,)
    assert cast_many(CUBE, PLATE, np.zeros((2, 0, 3))).stacked("normal").shape == (2, 0, 3)
    for shapes in (((2, 3), (3, 3)), ((2, 1, 3), (4, 5, 3))):
        direction, pose = (np.ones(shape) for shape in shapes)
        with pytest.raises(InputError, match=r"2 rows.*3 rows|\(2, 1\).*\(4, 5\)"):
            cast_many(CUBE, PLATE, direction, moving_pose=pose)


def _mesh() -> tuple[Any, Any]:
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    corners = [[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)]
    return corners, faces


def _told(feature: Any) -> list[int]:
    """Returns a feature as a row of its column."""
    vertices: list[int] = feature.vertices[:3].tolist()
    return vertices + [-1] * (3 - len(vertices))


def _contact(answer: Any) -> Any:
    """Returns the part of an answer that has features: a contact, or the answer itself."""
    for name in ("first", "contact", "grazing", "last"):
        if hasattr(answer, name) and not hasattr(answer, "features"):
            return _contact(getattr(answer, name))
    return answer


@pytest.mark.parametrize("ask", [cast_many, contact_range_many, clearance_many])
def test_features_equal_those_of_the_row(ask: Any) -> None:
    drawn = draw(7, 400)
    poses = {"moving_pose": drawn.moving_pose, "fixed_pose": drawn.fixed_pose}
    index = {"moving_index": drawn.moving, "fixed_index": drawn.fixed}
    columns = ask(drawn.bodies(), drawn.bodies(), drawn.direction, features=True, **poses, **index)
    seen = 0
    for i, answer in enumerate(columns.answers()):
        features = getattr(_contact(answer), "features", None)
        for side in ("moving", "fixed"):
            row = getattr(columns, f"{side}_feature")[i].tolist()
            assert row == ([-1] * 3 if features is None else _told(getattr(features, side)))
            seen += row != [-1] * 3
    assert seen > 200
    plain = ask(drawn.bodies(), drawn.bodies(), drawn.direction, **poses, **index)
    assert plain.moving_feature is None and "moving_feature" not in dict(plain._numbers())
    assert plain.point.tobytes() == columns.point.tobytes()
    with pytest.raises(InputError, match="with features and columns without"):
        concatenate([plain, columns])


def test_features_of_solids_distances_and_motions() -> None:
    solid, starts = Solid(*_mesh()), [[0.25, 0.25, 3.0], [0.0, 0.0, 9.0], [50.0, 0.0, 3.0]]
    columns = clearance_many(solid, PLATE, DOWN, moving_pose=starts, features=True)
    blocked = columns[0]
    assert columns.moving_feature is not None and columns.fixed_feature is not None
    assert columns.moving_feature[0].tolist() == _told(blocked.contact.moving_feature)  # type: ignore[union-attr]
    assert columns.fixed_feature[0].tolist() == _told(blocked.contact.fixed_feature)  # type: ignore[union-attr]
    assert columns.moving_feature[2].tolist() == [-1, -1, -1]
    near = distance_many(CUBE, PLATE, moving_pose=starts, features=True)
    assert near.moving_feature is not None
    for i, answer in enumerate(near.answers()):
        assert near.moving_feature[i].tolist() == _told(answer.features.moving)  # type: ignore[union-attr]
    fall = {"slide": {"by": [0, 0, -20.0]}}
    moved = motion_many(CUBE, PLATE, fall, moving_pose=starts, features=True)
    assert moved.moving_feature is not None
    assert (moved.moving_feature[:2] >= 0).any(axis=1).all() and (moved.moving_feature[2] < 0).all()
    table = columns.to_arrow()
    assert table["moving_feature"].to_pylist()[2] == [-1, -1, -1]
    assert "fixed_feature_0" in columns.to_pandas()
    assert columns.to_xarray()["moving_feature"].dims == ("query", "corner")


def test_free_directions_of_many_equal_those_of_each() -> None:
    bar = Solid(*_mesh())
    starts = np.array([[[0, 0, 0.0], [1, 1, 1]], [[0, 0, 3], [0.2, 0.3, 0.5]]])
    columns = free_directions_many([bar, CUBE], PLATE, moving_pose=starts, moving_index=[[0], [1]])
    assert columns.shape == (2, 2)
    assert columns.stacked("outcome").tolist() == [["free", "free"], ["free", "free"]]
    for i in range(4):
        answer: Any = columns[i]
        alone = free_directions(
            CUBE if i // 2 else bar, PLATE, moving_pose=starts.reshape(-1, 3)[i]
        )
        assert (columns.free_lower[i], columns.free_upper[i]) == alone.free_share
        assert answer.free_share == alone.free_share
        assert columns.regions[i] == len(alone.regions) and columns.arcs[i] == len(alone.arcs)
        assert alone.says([columns.direction[i]]) == ["free"]
    sunk = free_directions_many(CUBE, PLATE, moving_pose=[[0, 0, -0.5], [0, 0, 2.0]])
    assert sunk.counts() == {"free": 1, "error": 1} and "overlap" in sunk.errors[0]
