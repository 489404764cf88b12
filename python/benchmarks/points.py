"""Measures queries of a body among the points of a cloud.

``python python/benchmarks/points.py [POINTS]`` needs the installed package. Each point is an
obstacle on a wavy surface of 2 by 2. Times are CPU times of one thread, for each query the minimum
of the repetitions divided by the number of queries. Each drop of the ball is compared with the
closed form over all points.
"""

import sys
import time

import numpy as np

from colltrans import ConvexPolyhedron, Obstacles, Solid

TURNS, QUERIES, RADIUS = 5, 200, 0.05
DOWN = [0.0, 0.0, -1.0]


def surface(points):
    """Draws points on the surface."""
    random = np.random.default_rng(1)
    x, y = random.uniform(-1, 1, size=(2, points))
    return np.stack([x, y, 0.1 * np.sin(5 * x) * np.cos(4 * y)], axis=1)


def closed_form(cloud, start):
    """Returns the drop of the ball until it touches the first point."""
    aside = np.sum((cloud[:, :2] - start[:2]) ** 2, axis=1)
    under = aside < RADIUS**2
    height = cloud[under, 2] + np.sqrt(RADIUS**2 - aside[under])
    return start[2] - height.max() if under.any() else np.inf


def microseconds(call, count):
    """Returns the CPU time of a query, and the answers."""
    least = np.inf
    for _ in range(TURNS):
        begin = time.process_time()
        answers = call()
        least = min(least, time.process_time() - begin)
    return least / count * 1e6, answers


def hook():
    """Returns a solid that is not convex: an angle of two boxes."""
    parts = [([-0.05, -0.02, 0], [0.05, 0.02, 0.02]), ([0.03, -0.02, -0.06], [0.05, 0.02, 0.02])]
    return Solid.from_pieces([ConvexPolyhedron.cuboid(*part) for part in parts])


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    cloud, scene = surface(count), Obstacles()
    begin = time.process_time()
    scene.add_many(ConvexPolyhedron([[0.0, 0, 0]]), cloud)
    print(f"{count} points inserted in {time.process_time() - begin:.2f} s")
    starts = np.random.default_rng(2).uniform(-0.9, 0.9, size=(QUERIES, 3))
    starts[:, 2] = 1.0
    ball = ConvexPolyhedron.sphere(RADIUS)
    box = ConvexPolyhedron.cuboid([-0.05, -0.02, 0], [0.05, 0.02, 0.02])
    for name, body in (("ball", ball), ("box", box), ("hook, a solid", hook())):
        drop = lambda body=body: scene.clearance_many(body, DOWN, starts, threads=1)  # noqa: E731
        took, answers = microseconds(drop, QUERIES)
        print(f"{name}: {took:.0f} us for a drop")
        if body is ball:
            exact = np.array([closed_form(cloud, start) for start in starts])
            print(f"  error of all drops: {np.abs(answers['distance'] - exact).max():.1e}")
    took, _ = microseconds(lambda: scene.nearest_many(ball, starts, threads=1), QUERIES)
    print(f"ball: {took:.0f} us for the nearest point")


if __name__ == "__main__":
    main()
