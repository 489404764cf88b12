"""Compares casts by this package and by other packages: time, error, missed contacts.

``pip install './python[peers]'``, then ``python python/benchmarks/peers.py [ROWS]``. All packages
answer the same rows: two polytopes, one rotated at random above the other and moved down, in some
rows past it. Each row is answered by all packages in turn, in an order that rotates, and twice by
each: a time is *in turns* if the other packages used the caches before, and *hot* right after the
same row. Only Bullet casts convex bodies too (``convexSweepTest``, in Python by panda3d). The other
packages use conservative advancement, the best loop that their distance query allows: move by the
distance divided by the component of the direction along the normal, until the distance is below
1e-9, the bodies separate, or 100 steps are done. The continuous collision of python-fcl has its own
rows.

The reference is the answer of this package with its proof: errors are relative to its certified
bounds. *missed* contacts were not found, *invented* contacts do not exist, *off* contacts are wrong
by more than 1e-6 (the bodies have radius 1), and *stuck* loops did not end.
"""

import argparse
import time
from importlib.metadata import PackageNotFoundError, version

import numpy as np

import colltrans
from colltrans import Contact, ConvexPolyhedron, Solid, SolidBlocked

LIMIT, STEPS, OFF, RADIUS = 1e-9, 100, 1e-6, 0.1
DOWN = np.array([0.0, 0.0, -1.0])


def settings(vertices, rows):
    """Draws points on two spheres, and for each row a pose of the moving one."""
    random = np.random.default_rng(11)
    clouds = random.normal(size=(2, vertices, 3))
    clouds /= np.linalg.norm(clouds, axis=-1, keepdims=True)
    starts = random.uniform(-1.5, 1.5, size=(rows, 3)) * [1, 1, 0] + [0, 0, 6]
    turns = random.normal(size=(rows, 4))
    return clouds, starts, turns / np.linalg.norm(turns, axis=1, keepdims=True)


def advance(distance):
    """Advances conservatively along DOWN; returns the translation, None if missed, NaN if stuck."""
    t = 0.0
    for _ in range(STEPS):
        gap, normal = distance(t)
        if gap <= LIMIT:
            return t
        closing = float(normal @ DOWN)
        if closing <= 1e-12:
            return None
        t += gap / closing
        if t > 20:
            return None
    return np.nan


def between(from_moving, from_fixed, gap):
    """Returns the unit vector between the nearest points, from the moving body to the fixed one."""
    return (np.asarray(from_fixed) - np.asarray(from_moving)) / max(gap, 1e-300)


def polygons(body):
    """Returns the triangles of a body as indices of its vertices."""
    return np.array([(f[0], *f[k : k + 2]) for f in body.faces for k in range(1, len(f) - 1)])


def ours(bodies):
    pose = np.zeros(7)

    def ask(start, turn):
        pose[:3], pose[3:] = start, turn
        answer = colltrans.cast(*bodies, DOWN, moving_pose=pose)
        return answer.translation if isinstance(answer, Contact) else None

    return ask


def coal(bodies):
    import coal

    def shape(body):
        points = coal.StdVec_Vec3s()
        points.extend(list(body.vertices))
        model = coal.BVHModelOBBRSS()
        model.beginModel(0, len(points))
        model.addVertices(body.vertices)
        model.endModel()
        model.buildConvexHull(True, "Qt")
        return model.convex

    moving, fixed = map(shape, bodies)
    request, still = coal.DistanceRequest(), coal.Transform3s()
    request.gjk_tolerance = 1e-12

    def ask(start, turn):
        place = coal.Transform3s(coal.Quaternion(turn[3], *turn[:3]), start)

        def distance(t):
            place.setTranslation(start + t * DOWN)
            found = coal.DistanceResult()
            gap = coal.distance(moving, place, fixed, still, request, found)
            return gap, between(found.getNearestPoint1(), found.getNearestPoint2(), gap)

        return advance(distance)

    return ask


def fcl_objects(bodies):
    import fcl

    def shape(body):
        triangles = polygons(body)
        flat = np.hstack([np.full((len(triangles), 1), 3), triangles]).ravel()
        return fcl.CollisionObject(fcl.Convex(body.vertices, len(triangles), flat))

    return [shape(body) for body in bodies]


def fcl_distance(bodies):
    import fcl

    moving, fixed = fcl_objects(bodies)
    request = fcl.DistanceRequest(
        enable_nearest_points=True, gjk_solver_type=fcl.GJKSolverType.GST_LIBCCD
    )

    def ask(start, turn):
        moving.setQuatRotation(turn[[3, 0, 1, 2]])

        def distance(t):
            moving.setTranslation(start + t * DOWN)
            found = fcl.DistanceResult()
            gap = fcl.distance(moving, fixed, request, found)
            return gap, between(*found.nearest_points, gap)

        return advance(distance)

    return ask


def fcl_meshes(bodies):
    import fcl

    def model(body):
        triangles = polygons(body)
        mesh = fcl.BVHModel()
        mesh.beginModel(len(body.vertices), len(triangles))
        mesh.addSubModel(body.vertices, triangles)
        mesh.endModel()
        return fcl.CollisionObject(mesh)

    return map(model, bodies)


def fcl_continuous(objects):
    def make(bodies):
        import fcl

        moving, fixed = objects(bodies)
        request = fcl.ContinuousCollisionRequest(
            num_max_iterations=1000,
            toc_err=1e-9,
            ccd_solver_type=fcl.CCDSolverType.CCDC_CONSERVATIVE_ADVANCEMENT,
        )
        still, far = fcl.Transform(), 10.0

        def ask(start, turn):
            turned = turn[[3, 0, 1, 2]]
            moving.setTransform(fcl.Transform(turned, start))
            found = fcl.ContinuousCollisionResult()
            end = fcl.Transform(turned, start + far * DOWN)
            fcl.continuousCollide(moving, end, fixed, still, request, found)
            return found.time_of_contact * far if found.is_collide else None

        return ask

    return make


def pybullet(bodies):
    import pybullet as engine

    engine.connect(engine.DIRECT)

    def shape(body):
        hull = engine.createCollisionShape(engine.GEOM_MESH, vertices=body.vertices.tolist())
        made = engine.createMultiBody(0, hull)
        engine.changeDynamics(made, -1, collisionMargin=0.0)
        return made

    moving, fixed = map(shape, bodies)

    def ask(start, turn):
        def distance(t):
            engine.resetBasePositionAndOrientation(moving, (start + t * DOWN).tolist(), turn)
            found = engine.getClosestPoints(moving, fixed, 1e3)
            nearest = min(found, key=lambda point: point[8])
            return nearest[8], -np.array(nearest[7])

        return advance(distance)

    return ask


def mujoco(bodies):
    import mujoco

    def mesh(name, body):
        numbers = " ".join(f"{x!r}" for x in body.vertices.ravel().tolist())
        return f'<mesh name="{name}" vertex="{numbers}"/>'

    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><asset>{mesh('a', bodies[0])}{mesh('b', bodies[1])}</asset><worldbody>"
        '<body><freejoint/><geom type="mesh" mesh="a"/></body>'
        '<body><geom type="mesh" mesh="b"/></body></worldbody></mujoco>'
    )
    model.opt.ccd_tolerance, model.opt.ccd_iterations = 1e-12, 200
    data, ends = mujoco.MjData(model), np.zeros(6)

    def ask(start, turn):
        data.qpos[3:7] = turn[[3, 0, 1, 2]]

        def distance(t):
            data.qpos[:3] = start + t * DOWN
            mujoco.mj_kinematics(model, data)
            gap = mujoco.mj_geomDistance(model, data, 0, 1, 1e3, ends)
            return gap, between(ends[:3], ends[3:], gap)

        return advance(distance)

    return ask


def trimesh(bodies):
    import trimesh

    def manager(body, name):
        mesh = trimesh.Trimesh(body.vertices, polygons(body), process=False)
        found = trimesh.collision.CollisionManager()
        found.add_object(name, mesh)
        return found

    moving, fixed = manager(bodies[0], "moving"), manager(bodies[1], "fixed")

    def ask(start, turn):
        place = colltrans.Pose(np.r_[start, turn]).as_matrix()

        def distance(t):
            place[:3, 3] = start + t * DOWN
            moving.set_transform("moving", place)
            gap, found = moving.min_distance_other(fixed, return_data=True)
            return gap, between(found.point("moving"), found.point("fixed"), gap)

        return advance(distance)

    return ask


def bullet(bodies):
    from panda3d.bullet import BulletConvexHullShape, BulletRigidBodyNode, BulletWorld
    from panda3d.core import BitMask32, LPoint3, LQuaternion, LVecBase3, TransformState

    def shape(body):
        hull = BulletConvexHullShape()
        for point in body.vertices.tolist():
            hull.add_point(LPoint3(*point))
        hull.set_margin(0.0)
        return hull

    world, node, moving = BulletWorld(), BulletRigidBodyNode("fixed"), shape(bodies[0])
    node.add_shape(shape(bodies[1]))
    world.attach(node)
    everything, reach = BitMask32.all_on(), 20.0

    def ask(start, turn):
        turned = LQuaternion(turn[3], *turn[:3])
        begin, end = (
            TransformState.make_pos_quat_scale(LPoint3(*place), turned, LVecBase3(1))
            for place in (start, start + reach * DOWN)
        )
        found = world.sweep_test_closest(moving, begin, end, everything, 0.0)
        return reach * found.get_hit_fraction() if found.has_hit() else None

    return ask


PEERS = {
    "colltrans": ("colltrans", ours),
    "panda3d, Bullet's convexSweepTest": ("panda3d", bullet),
    "coal, distance": ("coal", coal),
    "python-fcl, distance": ("python-fcl", fcl_distance),
    "python-fcl, continuousCollide of convex bodies": ("python-fcl", fcl_continuous(fcl_objects)),
    "python-fcl, continuousCollide of meshes": ("python-fcl", fcl_continuous(fcl_meshes)),
    "pybullet, getClosestPoints": ("pybullet", pybullet),
    "mujoco, mj_geomDistance": ("mujoco", mujoco),
    "trimesh, min_distance_other": ("trimesh", trimesh),
}


def torus(facets):
    """Returns the points and triangles of a torus with waves."""
    n = round((facets / 2) ** 0.5)
    u, v = np.meshgrid(*[2 * np.pi * np.arange(n) / n] * 2, indexing="ij")
    r = 0.4 + 0.02 * np.sin(9 * u) * np.sin(7 * v)
    w = 1 + r * np.cos(v)
    points = np.stack([w * np.cos(u), w * np.sin(u), r * np.sin(v)], axis=-1).reshape(-1, 3)
    a = np.arange(n * n).reshape(n, n)
    b, c = np.roll(a, -1, 0), np.roll(a, -1, 1)
    d = np.roll(b, -1, 1)
    faces = [np.stack(corners, axis=-1).reshape(-1, 3) for corners in ([a, b, d], [a, d, c])]
    return points, np.concatenate(faces)


def fcl_sphere_and_mesh(points, faces):
    import fcl

    mesh = fcl.BVHModel()
    mesh.beginModel(len(points), len(faces))
    mesh.addSubModel(points, faces)
    mesh.endModel()
    return fcl.CollisionObject(fcl.Sphere(RADIUS)), fcl.CollisionObject(mesh)


def fcl_distance_to_mesh(sphere, mesh):
    import fcl

    def ask(start, _):
        def distance(t):
            sphere.setTranslation(start + t * DOWN)
            # The plane at the nearest point does not bound a mesh that is not convex. The gap does.
            return fcl.distance(sphere, mesh), DOWN

        return advance(distance)

    return ask


def drop_on_mesh(facets, rows):
    """Compares drops of a sphere on a mesh with python-fcl."""
    points, faces = torus(facets)
    sphere, mesh = ConvexPolyhedron.sphere(RADIUS), Solid(points, faces)
    pose = np.array([0.0, 0, 0, 0, 0, 0, 1])

    def ours(start, _):
        pose[:3] = start
        answer = colltrans.clearance(sphere, mesh, DOWN, moving_pose=pose)
        return answer.distance if isinstance(answer, SolidBlocked) else None

    asked = {"colltrans": ours}
    try:
        asked["python-fcl, distance"] = fcl_distance_to_mesh(*fcl_sphere_and_mesh(points, faces))
    except ImportError as error:
        print(f"python-fcl is not installed: {error}")
    _, starts, turns = settings(8, rows)
    known = []
    for start in starts:
        pose[:3] = start
        answer = colltrans.clearance(sphere, mesh, DOWN, moving_pose=pose)
        is_hit = isinstance(answer, SolidBlocked)
        known.append(answer.contact.translation_bounds if is_hit else None)
    hits = sum(bounds is not None for bounds in known)
    print(f"\nsphere on {len(faces)} triangles, {rows} rows, {hits} contacts\n")
    compare(asked, starts, turns, known)


def judged(found, known):
    """Returns the error of a row if both found a contact, otherwise a word for its result."""
    if found is not None and np.isnan(found):
        return "stuck"
    if known is None:
        return "invented" if found is not None else None
    if found is None:
        return "missed"
    lower, upper = known
    return max(lower - found, found - upper, 0.0)


def line(name, spent, again, verdicts):
    errors = np.array([v for v in verdicts if isinstance(v, float)])
    words = [v for v in verdicts if isinstance(v, str)]
    counts = [words.count("missed"), words.count("invented"), int((errors > OFF).sum())]
    counts.append(words.count("stuck"))
    largest = f"{errors.max():.1e}" if errors.size else "-"
    times = " | ".join(f"{np.median(each) * 1e6:.1f}" for each in (spent, again))
    return f"| {name} | {times} | {largest} | " + " | ".join(map(str, counts)) + " |"


def timed(ask, start, turn):
    began = time.perf_counter()
    found = ask(start, turn)
    return found, time.perf_counter() - began


def compare(asked, starts, turns, known):
    """Measures the contestants in turns, and prints a line for each."""
    print(
        "| who | us a cast, median, in turns | hot | largest error "
        "| missed | invented | off | stuck |"
    )
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    spent, again, verdicts = ({name: [] for name in asked} for _ in range(3))
    names = list(asked)
    for row, (start, turn, truth) in enumerate(zip(starts, turns, known, strict=True)):
        first = row % len(names)
        for name in names[first:] + names[:first]:
            found, time_in_turns = timed(asked[name], start, turn)
            spent[name].append(time_in_turns)
            again[name].append(timed(asked[name], start, turn)[1])
            verdicts[name].append(judged(found, truth))
    for name in names:
        print(line(name, spent[name], again[name], verdicts[name]), flush=True)


def main():
    parser = argparse.ArgumentParser(description="Compares casts with other packages.")
    parser.add_argument("rows", nargs="?", type=int, default=300)
    parser.add_argument("--mesh", metavar="FACETS", type=int)
    arguments = parser.parse_args()
    rows = arguments.rows
    if arguments.mesh is not None:
        drop_on_mesh(arguments.mesh, rows)
        return
    for vertices in (8, 128):
        clouds, starts, turns = settings(vertices, rows)
        bodies = [ConvexPolyhedron(cloud) for cloud in clouds]
        answers = [
            colltrans.cast(*bodies, DOWN, moving_pose=np.r_[start, turn])
            for start, turn in zip(starts, turns, strict=True)
        ]
        proofs = [a.certificate if isinstance(a, Contact) else None for a in answers]
        assert all(proof is None or proof.verify() < 1e-9 for proof in proofs)
        known = [None if proof is None else (proof.lower, proof.upper) for proof in proofs]
        hits = sum(bounds is not None for bounds in known)
        print(f"\n{vertices} vertices, {rows} rows, {hits} contacts\n")
        asked = {}
        for name, (package, make) in PEERS.items():
            try:
                asked[f"{name} ({version(package)})"] = make(bodies)
            except (PackageNotFoundError, ImportError) as error:
                print(f"{name} is not installed: {error}")
        compare(asked, starts, turns, known)


if __name__ == "__main__":
    main()
