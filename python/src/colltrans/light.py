"""Output of notebook cells: a line of text, and a drawing if the bodies are small.

A drawing is an SVG image of a few kilobytes: bodies in an oblique view from above, facets sorted
from back to front, in the colours of :mod:`colltrans.pictures`. For an interactive figure call
``show()``.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np

from colltrans._colltrans import (
    ConvexPolyhedron,
    FirstContact,
    MotionCast,
    MotionClearance,
    Pose,
    Solid,
)
from colltrans.pictures import EDGE, FIXED, MOVING, TOUCH, Floats, Placed, _Link, placed, said

#: Maximum number of triangles in a drawing. Larger bodies are shown as text only.
MOST = 1500
#: Size of a drawing and its margin, in pixels.
WIDTH, HEIGHT, MARGIN = 320, 240, 8
#: Directions from the scene to the eye and to the light.
EYE = np.array([0.48, -0.72, 0.5])
LIGHT = np.array([0.35, -0.5, 0.79])


@dataclass(frozen=True)
class _Shape:
    """A placed body with its colour and opacity."""

    placed: Placed
    colour: str
    opacity: float


def html(thing: Any) -> str:
    """Returns the HTML that a notebook shows for a body, a query or an answer."""
    text = f"<p>{escape(repr(thing))}</p>"
    shapes, points = _scene(thing)
    if not shapes or sum(len(shape.placed[1]) for shape in shapes) > MOST:
        return text
    return text + svg(shapes, points)


def _scene(thing: Any) -> tuple[list[_Shape], list[Floats]]:
    """Returns the shapes to draw, and the points of an answer."""
    if isinstance(thing, (ConvexPolyhedron, Solid)):
        return [_Shape(placed(thing, Pose()), MOVING, 1.0)], []
    if isinstance(thing, (MotionCast, MotionClearance, FirstContact)):
        return _moved(thing)
    if hasattr(thing, "moving"):  # A query, which is not run just for a drawing.
        return _bodies(thing), []
    try:
        query, marks = said(thing)
    except TypeError:
        return [], []
    shapes = _bodies(query)
    points: list[Floats] = []
    for mark in marks:
        if isinstance(mark, _Link):
            points += mark.ends
            continue
        if mark.translation is not None:
            vertices, triangles, edges = shapes[0].placed
            ghost = (vertices + mark.direction * mark.translation, triangles, edges)
            shapes.append(_Shape(ghost, MOVING, 0.3))
        points += [] if mark.point is None else [mark.point]
    return shapes, points


def _bodies(query: Any) -> list[_Shape]:
    moving = _Shape(placed(query.moving, query.moving_pose), MOVING, 1.0)
    return [moving, _Shape(placed(query.fixed, query.fixed_pose), FIXED, 1.0)]


def _moved(thing: MotionCast | MotionClearance | FirstContact) -> tuple[list[_Shape], list[Floats]]:
    """Returns the moving body at the start, the fixed body, and a ghost of the moving body.

    The fixed body and the ghost are at the time of the contact, or else at the end of the motion.
    A query has no contact yet, so it shows the end.
    """
    query = thing if isinstance(thing, MotionCast) else thing.query
    at = 1.0
    if isinstance(thing, FirstContact) and thing.lower is not None:
        at = min(thing.lower, 1.0)
    if isinstance(thing, MotionClearance) and thing.time is not None:
        at = thing.time
    start = placed(query.moving, query.moving_motion.at(0.0))
    ghost = placed(query.moving, query.moving_motion.at(at))
    fixed = placed(query.fixed, query.fixed_motion.at(at))
    shapes = [_Shape(start, MOVING, 1.0), _Shape(fixed, FIXED, 1.0), _Shape(ghost, MOVING, 0.3)]
    point = getattr(thing, "point", None)
    return shapes, [] if point is None else [point]


def svg(shapes: list[_Shape], points: list[Floats]) -> str:
    """Draws shapes and points as SVG."""
    right = np.cross([0.0, 0, 1], EYE)
    right /= np.linalg.norm(right)
    onto = np.stack([right, -np.cross(EYE, right), EYE], axis=1)
    corners = np.vstack([shape.placed[0] for shape in shapes]) @ onto
    low, high = corners.min(axis=0)[:2], corners.max(axis=0)[:2]
    size = np.maximum(high - low, 1e-300)
    room = np.array([WIDTH, HEIGHT]) - 2 * MARGIN
    scale = float((room / size).min())
    shift = MARGIN + (room - size * scale) / 2 - low * scale

    def pixels(at: Floats) -> Floats:
        pixel: Floats = (at @ onto)[..., :2] * scale + shift
        return pixel

    opaque = [shape for shape in shapes if shape.opacity == 1.0]
    ghosts = [shape for shape in shapes if shape.opacity < 1.0]
    drawn = [line for group in (opaque, ghosts) for line in _facets(group, pixels)]
    dots = (pixels(point) for point in points)
    drawn += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{TOUCH}"/>' for x, y in dots]
    box = f'viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {box}>{"".join(drawn)}</svg>'


def _facets(shapes: list[_Shape], pixels: Any) -> Iterator[str]:
    """Draws the facets that face the eye, from back to front, with their edges."""
    all_of: list[tuple[float, str]] = []
    for shape in shapes:
        vertices, triangles, edges = shape.placed
        seen = {tuple(sorted(map(int, edge))) for edge in edges}
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        lengths = np.linalg.norm(normals, axis=1)
        normals /= np.maximum(lengths, 1e-300)[:, None]
        facing = np.flatnonzero((normals @ EYE > 0) & (lengths > 0))
        depths = ((a + b + c) / 3) @ EYE
        shades = 0.62 + 0.38 * np.maximum(normals @ LIGHT, 0)
        for k in facing:
            corners = triangles[k]
            x = pixels(vertices[corners])
            fill = _shaded(shape.colour, float(shades[k]))
            look = f'fill="{fill}" stroke="{fill}" stroke-width="0.6" opacity="{shape.opacity}"'
            ends = (
                f"M{p[0]:.1f} {p[1]:.1f}L{q[0]:.1f} {q[1]:.1f}" for p, q in _sides(corners, x, seen)
            )
            lines = "".join(ends)
            told = f'<path d="M{" L".join(f"{u:.1f} {v:.1f}" for u, v in x)}Z" {look}/>'
            if lines:
                told += f'<path d="{lines}" stroke="{EDGE}" fill="none" opacity="{shape.opacity}"/>'
            all_of.append((float(depths[k]), told))
        if len(triangles) == 0:
            for edge in edges:
                (x0, y0), (x1, y1) = pixels(vertices[edge])
                line = f'd="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}" stroke="{shape.colour}"'
                all_of.append((float((vertices[edge] @ EYE).mean()), f"<path {line}/>"))
    return (told for _, told in sorted(all_of, key=lambda it: it[0]))


def _sides(corners: Any, x: Floats, seen: set[tuple[int, ...]]) -> Iterator[tuple[Floats, Floats]]:
    """Returns the sides of a triangle that are visible edges."""
    for j, k in ((0, 1), (1, 2), (2, 0)):
        if tuple(sorted((int(corners[j]), int(corners[k])))) in seen:
            yield x[j], x[k]


def _shaded(colour: str, shade: float) -> str:
    parts = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return "#" + "".join(f"{min(255, round(part * shade)):02x}" for part in parts)
