# Milling tools on a surface
# Ball, bull-nose and flat end mills are lowered onto a mesh: the lines are their tips. Between two
# positions the ball moves on a straight line, which gouges the surface at the marked points.
"""Drops milling tools onto a mesh, and moves them along polylines.

A tool is a list of convex bodies with the tip at the origin and the axis along z. The mesh is a
scene of triangles, because rounded bodies are answered against convex bodies.

- A ball end mill is a capsule, which is exact.
- A flat end mill is a prism around its cylinder. Its sides are at most ``R (1 / cos(pi / n) - 1)``
  outside, so it never gouges; it may stop too early.
- A bull-nose end mill is a prism of the radius ``R - r``, rounded by its corner radius ``r``. Only
  the polygon has this error; the corner is exact.
- A holder is a further cylinder above the tool.
"""

import sys
from itertools import pairwise

import numpy as np

from colltrans import ConvexPolyhedron, Obstacles

SIDES = 128
#: The plane of the picture. It contains no edge of the mesh, along which a single point would slide.
Y = 0.013
DOWN = [0.0, 0.0, -1.0]


def cylinder(radius, low, high, sides=SIDES):
    """Returns a prism around a cylinder about z."""
    angles = 2 * np.pi * np.arange(sides) / sides
    ring = radius / np.cos(np.pi / sides) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ends = [np.column_stack([ring, np.full(sides, z)]) for z in (low, high)]
    return ConvexPolyhedron(np.concatenate(ends))


def ball_mill(radius, length):
    """Returns a ball end mill with its shaft."""
    return [ConvexPolyhedron.capsule([0, 0, radius], [0, 0, length], radius)]


def flat_mill(radius, length):
    """Returns a flat end mill."""
    return [cylinder(radius, 0, length)]


def bull_nose_mill(radius, corner, length):
    """Returns an end mill whose edge is rounded by a corner radius."""
    return [cylinder(radius - corner, corner, length).rounded(corner)]


def with_holder(tool, radius, begin, end):
    """Returns a tool in a holder that spans the heights from begin to end."""
    return [*tool, cylinder(radius, begin, end)]


def mesh_scene(vertices, triangles):
    """Returns the triangles of a mesh as obstacles."""
    scene = Obstacles()
    for corners in np.asarray(vertices, float)[np.asarray(triangles)]:
        scene.add(ConvexPolyhedron(corners))
    return scene


def drop(tool, scene, positions, above):
    """Returns the height of the tip when the tool, lowered from a height, touches the scene.

    The height is -inf where nothing is below the tool.
    """
    starts = np.column_stack([positions, np.full(len(positions), float(above))])
    travel = [scene.clearance_many(part, DOWN, starts)["distance"] for part in tool]
    return above - np.min([np.where(np.isnan(t), np.inf, t) for t in travel], axis=0)


def first_gouge(tool, scene, path):
    """Returns the segment of a polyline of tips, and the share of it, where the tool first touches.

    None if it touches nothing.
    """
    for k, (start, end) in enumerate(pairwise(path)):
        stops = [scene.clearance(part, end - start, start, before=1.0) for part in tool]
        shares = [
            0.0 if s.outcome == "overlapping" else s.distance
            for s in stops
            if s.obstacle is not None
        ]
        if shares:
            return k, min(shares)
    return None


def terrain(count):
    """Returns a wavy surface of 2 by 2 as a mesh with count by count vertices."""
    axis = np.linspace(-1, 1, count)
    x, y = np.meshgrid(axis, axis)
    vertices = np.stack([x, y, 0.25 * np.sin(6 * x) + 0.1 * np.cos(5 * y)], axis=-1)
    k = np.arange(count * count).reshape(count, count)
    a, b, c, d = (part.ravel() for part in (k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return vertices.reshape(-1, 3), triangles


def main():
    import matplotlib.pyplot as plt

    vertices, triangles = terrain(41)
    scene = mesh_scene(vertices, triangles)
    tools = {
        "ball": ball_mill(0.2, 1),
        "bull-nose": bull_nose_mill(0.2, 0.08, 1),
        "flat": flat_mill(0.2, 1),
        "ball with holder": with_holder(ball_mill(0.2, 1), 0.6, 0.3, 0.9),
    }
    fine = np.column_stack([np.linspace(-0.951, 0.949, 400), np.full(400, Y)])
    figure, axes = plt.subplots(figsize=(6.5, 3.6))
    point = [ConvexPolyhedron([[0.0, 0, 0]])]
    axes.fill_between(fine[:, 0], -0.4, drop(point, scene, fine, 2), color="#c9ced6")
    for name, tool in tools.items():
        axes.plot(fine[:, 0], drop(tool, scene, fine, 2), label=name, linewidth=1.2)
    coarse = np.column_stack([np.linspace(-0.95, 0.95, 9), np.full(9, Y)])
    path = np.column_stack([coarse, drop(tools["ball"], scene, coarse, 2) + 1e-9])
    axes.plot(path[:, 0], path[:, 2], "k.:", linewidth=0.8, label="nine positions of the ball")
    for k in range(len(path) - 1):
        if found := first_gouge(tools["ball"], scene, path[k : k + 2]):
            x, _, z = path[k] + found[1] * (path[k + 1] - path[k])
            axes.plot(x, z, "x", color="#b01657")
    axes.set(xlabel="x", ylabel="height of the tip", ylim=(-0.4, 0.9))
    axes.legend(loc="upper right", fontsize=8, ncols=2)
    figure.savefig(sys.argv[1], bbox_inches="tight")


if __name__ == "__main__":
    main()
