"""Pictures of bodies, queries and answers as figures of plotly.

The bodies are drawn solid at the start, and the moving body as a ghost at the contact, with the
contact point and the normal. Pictures need ``pip install colltrans[pictures]``. A notebook shows a
figure, a script opens a browser, and a saved file needs nothing else. No screen or graphics card is
needed.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from colltrans._colltrans import (
    Behind,
    Blocked,
    Cast,
    Contact,
    ContactRange,
    ConvexPolyhedron,
    Depth,
    DirectionalDepth,
    Distance,
    FirstContact,
    Grazing,
    Intersection,
    LastContact,
    MotionCast,
    MotionClearance,
    OverlapDepth,
    Overlapping,
    Pair,
    PathContact,
    Pose,
    Separated,
    Slides,
    Solid,
    SolidBlocked,
    SolidCast,
    SolidContact,
    SolidFree,
    SolidOverlapping,
    Within,
)
from colltrans.assembly import Assembly, Plan
from colltrans.errors import InputError

Floats: TypeAlias = NDArray[np.float64]
# The style of all pictures (`crates/colltrans-picture/src/style.rs`, which names the other places):
# blue and sand for bodies, magenta for contact points and normals.
FONT = "Helvetica, Arial, 'Liberation Sans', sans-serif"
MOVING, FIXED, TOUCH, EDGE = "#6f97d6", "#d9cbb0", "#b01657", "#1d2733"


@dataclass(frozen=True)
class _Mark:
    """What to draw for a contact: translation of the ghost, contact point, and normal."""

    name: str
    translation: float | None
    point: Floats | None
    normal: Floats | None
    direction: Floats


@dataclass(frozen=True)
class _Link:
    """A labelled segment between points of both bodies."""

    name: str
    ends: tuple[Floats, Floats]


def picture(answer: Any) -> Any:
    """Draws a body, an assembly, a plan, a query or an answer as a figure of plotly.

    Parameters
    ----------
    answer : ConvexPolyhedron, Solid, Assembly, Plan, Cast or any other query, or an answer
        Bodies and assemblies are drawn at their poses. The moving body is drawn solid at the start,
        and as a ghost at the contact, with the contact point and the normal from the moving body to
        the fixed one. Robot paths are drawn likewise, with all links. A distance has a segment
        between the nearest points. A depth has a ghost after the translation that separates the
        bodies. Removed parts of a plan are drawn after their moves.

    Returns
    -------
    plotly.graph_objects.Figure
        ``write_html`` saves it, with ``include_plotlyjs=True`` for use without a network.

    Raises
    ------
    ModuleNotFoundError
        plotly is missing; run ``pip install colltrans[pictures]``.
    TypeError
        The argument has no picture: it is not a body, a query or an answer, or its answer is about
        obstacles, free directions or removal paths.
    InputError
        A plan was restored from a pickle, so it has no bodies.

    Examples
    --------
    >>> from colltrans import ConvexPolyhedron, cast, picture
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> figure = picture(cast(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0]))
    >>> [trace.name for trace in figure.data if trace.name]
    ['moving', 'fixed', 'contact at 2', 'point', 'normal']
    """
    import plotly.graph_objects as go

    if isinstance(answer, Cast):
        answer = answer.cast()
    elif isinstance(answer, SolidCast):
        answer = answer.clearance()
    elif isinstance(answer, Pair):
        answer = answer.distance()
    elif isinstance(answer, MotionCast):
        answer = answer.motion()
    elif isinstance(answer, MotionClearance):
        answer = _cleared(answer).motion()
    figure = go.Figure()
    figure.add_traces(list(_traces(go, answer)))
    axes = {axis: {"showbackground": False} for axis in ("xaxis", "yaxis", "zaxis")}
    figure.update_layout(
        title=repr(answer),
        scene={"aspectmode": "data", **axes},
        font={"family": FONT, "color": EDGE},
        legend={"itemsizing": "constant"},
        margin={"l": 0, "r": 0, "t": 40, "b": 0},
    )
    return figure


def _traces(go: Any, thing: Any) -> Iterator[Any]:
    match thing:
        case FirstContact():
            yield from _moved(go, thing)
        case PathContact():
            yield from _carried(go, thing)
        case ConvexPolyhedron() | Solid():
            yield from _body(go, placed(thing, Pose()), "body", MOVING, 1.0)
        case Assembly():
            yield from _parts(go, thing, {})
        case Plan():
            if thing._assembly is None:
                raise InputError("a plan restored from a pickle has no bodies; compute it again")
            yield from _parts(go, thing._assembly, thing.displacements())
        case _:
            yield from _asked(go, thing)


def _parts(go: Any, assembly: Assembly, moved: dict[str, Floats]) -> Iterator[Any]:
    """Draws all parts at their place, or displaced; fixed parts are sand-coloured."""
    for name, (vertices, triangles) in assembly.meshes().items():
        way = moved.get(name, np.zeros(3))
        colour = MOVING if not moved or name in moved else FIXED
        shape = (vertices + way, triangles, _creases(vertices, triangles))
        yield from _body(go, shape, name, colour, 1.0)


def _asked(go: Any, answer: Any) -> Iterator[Any]:
    """Draws both bodies at their poses, and the marks of the answer."""
    query, marks = said(answer)
    moving = placed(query.moving, query.moving_pose)
    fixed = placed(query.fixed, query.fixed_pose)
    yield from _body(go, moving, "moving", MOVING, 1.0)
    yield from _body(go, fixed, "fixed", FIXED, 1.0)
    size = float(np.ptp(np.vstack([moving[0], fixed[0]]), axis=0).max()) or 1.0
    for mark in marks:
        if isinstance(mark, _Link):
            yield _line(go, *mark.ends, {"color": TOUCH, "width": 6}, mark.name)
        else:
            yield from _drawn(go, mark, moving, size)


def _cleared(answer: MotionClearance) -> MotionCast:
    """Returns the query whose first contact is drawn, with the tolerance that was used."""
    query = answer.query
    if query.min_gap > 0 or answer.tolerance is None:
        return query
    return MotionCast(
        query.moving,
        query.fixed,
        moving_motion=query.moving_motion,
        fixed_motion=query.fixed_motion,
        tolerance=answer.tolerance,
    )


def _moved(go: Any, answer: FirstContact) -> Iterator[Any]:
    """Draws the moving body solid at the start, and as ghosts at the contact and at the end.

    The fixed body is drawn at the time of the contact.
    """
    query, at = answer.query, 1.0 if answer.poses is None else answer.lower
    fixed = placed(query.fixed, query.fixed_motion.at(at))
    yield from _body(go, placed(query.moving, query.moving_motion.start), "moving", MOVING, 1.0)
    yield from _body(go, fixed, "fixed", FIXED, 1.0)
    ghosts = {"end": 1.0} if answer.poses is None else {f"{answer.outcome} at {at:.6g}": at}
    for name, time in {**ghosts, "end": 1.0}.items():
        yield from _body(go, placed(query.moving, query.moving_motion.at(time)), name, MOVING, 0.3)
    yield from _touch(go, answer, float(np.ptp(fixed[0], axis=0).max()) or 1.0)


def _carried(go: Any, answer: PathContact) -> Iterator[Any]:
    """Draws all bodies solid at the start, and moved ones as ghosts at the contact or the end."""
    starts, ends = answer.meshes((0, 0.0)), answer.meshes()
    size = float(np.ptp(np.vstack([vertices for _, vertices, _ in ends]), axis=0).max()) or 1.0
    when = "at the end" if answer.place is None else f"at {answer.lower:.6g}"
    for (name, start, triangles), (_, end, _) in zip(starts, ends, strict=True):
        colour = FIXED if np.array_equal(start, end) else MOVING
        if name in (answer.pair or ()):
            colour = TOUCH
        yield from _body(go, (start, triangles, _creases(start, triangles)), name, colour, 1.0)
        if not np.array_equal(start, end):
            ghost = (end, triangles, _creases(end, triangles))
            yield from _body(go, ghost, f"{name} {when}", colour, 0.3)
    yield from _touch(go, answer, size)


def _touch(go: Any, answer: FirstContact | PathContact, size: float) -> Iterator[Any]:
    """Draws the point of a contact and its normal."""
    if answer.point is not None:
        x, y, z = answer.point.reshape(3, 1)
        marker = {"color": TOUCH, "size": 6}
        yield go.Scatter3d(x=x, y=y, z=z, mode="markers", marker=marker, name="point")
        if answer.normal is not None:
            tip = answer.point + answer.normal * (size / 4)
            yield _line(go, answer.point, tip, {"color": TOUCH, "width": 6}, "normal")


def show(answer: Any, *, file: str | PathLike[str] | None = None) -> None:
    """Shows a body, a query or an answer as a picture: in the notebook, in a browser, or in a file.

    The method ``answer.show()`` does this too.

    Parameters
    ----------
    answer : ConvexPolyhedron, Solid, Assembly, Plan, Cast or any other query, or an answer
    file : str or os.PathLike, optional
        A self-contained page (HTML) that is written instead.

    Raises
    ------
    ModuleNotFoundError
        plotly is missing; run ``pip install colltrans[pictures]``.

    Examples
    --------
    >>> import os, tempfile
    >>> from colltrans import ConvexPolyhedron, cast
    >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    >>> page = os.path.join(tempfile.mkdtemp(), "contact.html")
    >>> cast(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0]).show(file=page)
    >>> os.path.getsize(page) > 1_000_000
    True
    """
    figure = picture(answer)
    if file is None:
        figure.show()
    else:
        figure.write_html(file, include_plotlyjs=True)


def said(answer: Any) -> tuple[Cast | SolidCast | Pair, list[_Mark | _Link]]:
    """Returns the query of an answer, and what to draw for the answer."""
    match answer:
        case Distance():
            points = (answer.on_moving, answer.on_fixed)
            return answer.query, [_Link(f"distance {answer.upper:.6g}", points)]
        case Within(points=between):
            links = [] if between is None else [_Link(f"at most {answer.upper:.6g}", between)]
            return answer.query, [*links]
        case Depth():
            return answer.query, [_Mark("separated", answer.upper, None, None, answer.direction)]
        case OverlapDepth():
            return answer.query, []
        case Contact():
            return answer.query, [_mark("contact", answer)]
        case Blocked(contact=contact) | Behind(contact=contact) | Grazing(contact=contact):
            return contact.query, [_mark(type(answer).__name__.lower(), contact)]
        case Slides(grazing=grazing):
            return grazing.contact.query, [_mark("slides", grazing.contact)]
        case Overlapping(first=first, last=last) | ContactRange(first=first, last=last):
            ends = [end.contact if isinstance(end, Grazing) else end for end in (first, last)]
            return ends[0].query, [_mark("first", ends[0]), _mark("last", ends[1])]
        case DirectionalDepth():
            return said(answer.clearance)
        case Intersection():
            return said(answer.outcome)
        case SolidBlocked(contact=contact):
            return contact.query, [_solid_mark(contact)]
        case SolidContact():
            return answer.query, [_solid_mark(answer)]
        case Separated() | SolidFree() | SolidOverlapping():
            normal = None if isinstance(answer, SolidOverlapping) else answer.normal
            query = answer.query
            return query, [_Mark("apart", None, None, normal, query.direction)]
    raise TypeError(f"{type(answer).__name__} is not a body, a query or an answer")


def _mark(name: str, contact: Contact | LastContact) -> _Mark:
    direction = contact.query.direction
    return _Mark(name, contact.translation, contact.point, contact.normal, direction)


def _solid_mark(contact: SolidContact) -> _Mark:
    direction = contact.query.direction
    return _Mark("blocked", contact.translation, contact.point, contact.normal, direction)


Placed: TypeAlias = tuple[Floats, NDArray[np.uint32], NDArray[Any]]


def placed(body: Solid | ConvexPolyhedron, pose: Pose) -> Placed:
    """Returns the vertices in the world, the triangles, and the visible edges of a placed body."""
    if isinstance(body, ConvexPolyhedron):
        body = body._drawn()
    vertices = body.vertices @ pose.rotation.T + pose.translation
    if isinstance(body, Solid):
        return vertices, body.triangles, _creases(vertices, body.triangles)
    if body.dimension < 2:
        return vertices, np.zeros((0, 3), np.uint32), np.zeros((1, 2), np.uint32) + [0, -1]
    fans = [(f[0], *f[k : k + 2]) for f in body.faces for k in range(1, len(f) - 1)]
    triangles = np.array(fans, np.uint32)
    return vertices, triangles, _creases(vertices, triangles)


def _creases(vertices: Floats, triangles: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Returns the edges, without those that two coplanar triangles share."""
    a, b, c = vertices[triangles].swapaxes(0, 1)
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owners = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort(sides.T)
    sides, owners = sides[order], owners[order]
    shared = (sides[:-1] == sides[1:]).all(axis=1)
    flat = np.einsum("ij,ij->i", normals[owners[:-1]], normals[owners[1:]]) > 1 - 1e-6
    hidden = sides[:-1][shared & flat]
    gone = set(map(tuple, hidden.tolist()))
    kept = [side for side in dict.fromkeys(map(tuple, sides.tolist())) if side not in gone]
    return np.array(kept, np.uint32).reshape(-1, 2)


def _body(go: Any, placed: Placed, name: str, colour: str, opacity: float) -> Iterator[Any]:
    vertices, triangles, edges = placed
    x, y, z = vertices.T
    i, j, k = triangles.T
    style = {"color": colour, "opacity": opacity, "flatshading": True, "hoverinfo": "name"}
    yield go.Mesh3d(x=x, y=y, z=z, i=i, j=j, k=k, name=name, showlegend=True, **style)
    lines = np.full((len(edges), 3, 3), np.nan)
    lines[:, :2] = vertices[edges]
    x, y, z = lines.reshape(-1, 3).T
    line = {"color": colour if opacity < 1 else EDGE, "width": 2}
    yield go.Scatter3d(x=x, y=y, z=z, mode="lines", line=line, hoverinfo="skip", showlegend=False)


def _drawn(go: Any, mark: _Mark, moving: Placed, size: float) -> Iterator[Any]:
    vertices, triangles, edges = moving
    start = vertices.mean(axis=0)
    length = float(np.linalg.norm(mark.direction))
    way = mark.direction * (size / length if mark.translation is None else mark.translation)
    if mark.translation is not None:
        ghost = (vertices + way, triangles, edges)
        yield from _body(go, ghost, f"{mark.name} at {mark.translation:.6g}", MOVING, 0.3)
    dashed = {"color": MOVING, "width": 3, "dash": "dash"}
    yield _line(go, start, start + way, dashed, None)
    if mark.point is not None:
        x, y, z = mark.point.reshape(3, 1)
        yield go.Scatter3d(
            x=x, y=y, z=z, mode="markers", marker={"color": TOUCH, "size": 6}, name="point"
        )
    if mark.normal is not None:
        foot = start if mark.point is None else mark.point
        tip = foot + mark.normal * (size / 4)
        yield _line(go, foot, tip, {"color": TOUCH, "width": 6}, "normal")
        (x, y, z), (u, v, w) = tip.reshape(3, 1), mark.normal.reshape(3, 1)
        cone = {"sizemode": "absolute", "sizeref": size / 12, "anchor": "tip", "showscale": False}
        colour = [[0, TOUCH], [1, TOUCH]]
        yield go.Cone(x=x, y=y, z=z, u=u, v=v, w=w, colorscale=colour, hoverinfo="skip", **cone)


def _line(go: Any, start: Floats, end: Floats, line: dict[str, Any], name: str | None) -> Any:
    x, y, z = np.stack([start, end]).T
    return go.Scatter3d(
        x=x, y=y, z=z, mode="lines", line=line, name=name, showlegend=name is not None
    )
