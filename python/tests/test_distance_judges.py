"""Compares distances with Manifold's ``min_gap`` and trimesh's closest points, if installed.

Neither proves its numbers: if they differ from ours by more than their rounding, our proof
decides.
"""

from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Floats

from colltrans import ConvexPolyhedron, Pair, Pose, Solid, check

#: The relative tolerances of the other packages.
ROUNDING = 1e-9


def triangles_of(body: Solid | ConvexPolyhedron) -> Any:
    if isinstance(body, Solid):
        return np.asarray(body.triangles, np.uint64)
    fans = [(f[0], f[k], f[k + 1]) for f in body.faces for k in range(1, len(f) - 1)]
    return np.array(fans, np.uint64)


def placed(body: Solid | ConvexPolyhedron, at: Pose) -> Floats:
    vertices: Floats = body.vertices @ at.rotation.T + at.translation
    return vertices


def poses(seed: int, count: int, far: float) -> Floats:
    random = np.random.default_rng(seed)
    turns = random.normal(size=(count, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return np.hstack([random.normal(size=(count, 3)) * far, turns])


def pairs(count: int) -> list[Pair]:
    random = np.random.default_rng(5)
    hulls = [ConvexPolyhedron(random.normal(size=(n, 3))) for n in (6, 20, 80)]
    bolt, plate = Solid.read(ROOT / "data/bolt.stl"), Solid.read(ROOT / "data/plate.off")
    all_bodies: list[tuple[Any, Any, float]] = [
        (hulls[0], hulls[1], 4),
        (hulls[2], hulls[1], 3),
        (bolt, plate, 12),
        (hulls[1], plate, 8),
    ]
    return [
        Pair(moving, fixed, moving_pose=pose)
        for k, (moving, fixed, far) in enumerate(all_bodies)
        for pose in poses(k, count, far)
    ]


def judged(pair: Pair, told: float, is_upper: bool = False) -> bool:
    """Returns whether another package's number agrees; if not, our proof has to hold."""
    found = pair.distance()
    size = float(np.abs(pair.moving_pose.translation).max()) + 20
    over = told > found.upper + ROUNDING * size and not is_upper
    if not over and told >= found.lower - ROUNDING * size:
        return True
    found.verify()
    assert check.check(found.proof_json()).holds
    return False


def test_manifold_has_the_same_gaps() -> None:
    manifold3d = pytest.importorskip("manifold3d")

    def of(body: Any, pose: Any) -> Any:
        mesh = manifold3d.Mesh64(placed(body, pose), triangles_of(body))
        return manifold3d.Manifold(mesh)

    disagreed, apart = [], 0
    for pair in pairs(40):
        p, q = of(pair.moving, pair.moving_pose), of(pair.fixed, pair.fixed_pose)
        told = p.min_gap(q, 1e3)
        apart += pair.distance().lower > 0
        if not judged(pair, told):
            disagreed.append((told, pair.distance()))
    assert apart > 80
    assert disagreed == []


def test_no_point_of_a_surface_is_nearer_to_the_other() -> None:
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("scipy")
    pytest.importorskip("rtree")
    touched = 0
    for pair in pairs(12):
        found = pair.distance()
        if not found.lower:
            continue
        surface = trimesh.Trimesh(
            placed(pair.fixed, pair.fixed_pose),
            triangles_of(pair.fixed),
            process=False,
        )
        points = placed(pair.moving, pair.moving_pose)
        _, distances, _ = trimesh.proximity.closest_point(surface, points)
        assert judged(pair, float(distances.min()), is_upper=True)
        features = found.features
        if features is not None and features.moving.kind == "vertex":
            # Then a vertex is nearest.
            assert abs(distances.min() - found.upper) < ROUNDING * 40
            touched += 1
    assert touched > 8
