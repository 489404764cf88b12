"""Compares ``colltrans audit`` with Manifold and FCL: time, memory, missed and false clashes.

``pip install './python[peers,step]'`` and ``cargo build --release -p colltrans-cli``, then ``python
python/benchmarks/clashes.py``. All programs get the same triangles: ``Assembly.meshes()`` of this
package returns them in world coordinates, as ``colltrans audit`` reads them. Manifold and FCL
examine all pairs whose boxes come within the clearance; a sweep along x finds these.

- Manifold intersects the two parts (``^``, double precision). A volume above 0 is a clash. If it is
  0, ``min_gap`` computes the distance up to the clearance. Several bodies of one part are united
  first. Parts that are not closed manifolds are refused.
- FCL collides bounding volume hierarchies of triangles (``collide``), and computes the distance
  (``distance``) of pairs that do not collide. FCL has no tolerance there; its numbers are double.

Each program runs in a process of its own, one after the other. ``cpu`` is user and system time of
all threads, ``wall`` the elapsed time, ``MB`` the maximum resident memory. For ``colltrans`` they
are those of the whole command, reading included; ``reading`` is the time of ``Assembly.read``
alone. For the others time begins when the triangles are in memory.

The clashes of generated models are known. For other models ``colltrans audit`` is the reference,
and each pair with another answer is printed for examination: *missed* clashes, clashes of parts
that are *touching* (within the tolerance of ``colltrans audit``), other *false* clashes, volumes
and distances outside of the proven bounds. A *sliver* is a false clash or one of touching parts
with at most 1e-9 of the smaller part's volume.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from itertools import product
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
SLIVER = 1e-9
#: The relative error of other programs' volumes and distances that counts as rounding.
ROUNDING = 1e-9
#: Models in the folder of test data, each with a clearance in its own unit.
DATA = {
    "gearbox": 0.5,
    "machines/vise.step": 0.5,
    "machines/enclosure2.step": 0.5,
    "machines/valveblock.step": 0.5,
    "step/as1-oc-214.stp": 0.5,
    "step/dm1-oc-214.stp": 0.5,
    "step/s1/s1-c5-214.stp": 0.5,
    "assemblies/pillow_block.step": 0.5,
    "assemblies/flange8": 0.5,
    "assemblies/valve_oring": 0.5,
    "assemblies/square_table/assembly.toml": 0.0005,
    "assemblies/ReciprocatingSaw.glb": 0.0005,
}

# Generated models: each function writes a model and returns its clashes.


def write_off(path, vertices, faces):
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(repr(float(x)) for x in vertex) for vertex in vertices]
    lines += [" ".join(map(str, [len(face), *face])) for face in faces]
    path.write_text("\n".join(lines) + "\n")


def prism(outline, low, high):
    """Returns vertices and faces of a prism over a counter-clockwise outline in the xy plane."""
    n = len(outline)
    vertices = [(*point, z) for z in (low, high) for point in outline]
    sides = [(k, (k + 1) % n, n + (k + 1) % n, n + k) for k in range(n)]
    return vertices, [tuple(range(n))[::-1], tuple(range(n, 2 * n)), *sides]


def box(low, high):
    (x, y, z), (u, v, w) = low, high
    return prism([(x, y), (u, y), (u, v), (x, v)], z, w)


def manifest(folder, parts):
    """Writes parts ``(name, file, translation, quaternion)`` as a manifest."""
    entries = []
    for name, file, translation, turn in parts:
        entry = {"name": name, "file": file, "translation": [float(x) for x in translation]}
        if turn is not None:
            entry["rotation"] = {"quaternion": [float(x) for x in turn]}
        entries.append(entry)
    path = folder / "model.json"
    path.write_text(json.dumps({"unit": "mm", "parts": entries}))
    return path


def folder_of(folder, parts):
    for name, (vertices, faces) in parts.items():
        write_off(folder / f"{name}.off", vertices, faces)
    return folder


def grid(folder, step=1.0):
    """10,000 boxes that touch."""
    write_off(folder / "box.off", *box((0, 0, 0), (step, step, step)))
    cells = product(range(25), range(20), range(20))
    parts = [(f"box_{k}", "box.off", np.array(c) * step, None) for k, c in enumerate(cells)]
    return manifest(folder, parts), set()


def rounded_grid(folder):
    """10,000 boxes of 0.1 that touch up to the rounding of their positions."""
    return grid(folder, 0.1)


def circle(radius, n=64):
    angles = 2 * np.pi * np.arange(n) / n
    return [(radius * np.cos(a), radius * np.sin(a)) for a in angles]


def pegs(folder):
    """Pegs in holes: exactly fitting, 1e-9 smaller, and 1e-9 larger in radius."""
    parts, n = {}, 64
    for k, (name, change) in enumerate([("exact", 0.0), ("loose", -1e-9), ("tight", 1e-9)]):
        at = [4.0 * k, 0.0]
        hole, peg = (np.array(circle(r, n)) + at for r in (1.0, 1.0 + change))
        rim = np.array(circle(1.5, n)) + at
        rings = [(*p, z) for z in (0.0, 1.0) for ring in (rim, hole) for p in ring]
        faces = []
        for a in range(n):
            b = (a + 1) % n
            # Outer and inner wall, floor and roof of the ring.
            faces += [(a, b, 2 * n + b, 2 * n + a), (n + b, n + a, 3 * n + a, 3 * n + b)]
            faces += [(b, a, n + a, n + b), (2 * n + a, 2 * n + b, 3 * n + b, 3 * n + a)]
        parts[f"{name}_hole"] = rings, faces
        parts[f"{name}_peg"] = prism([tuple(p) for p in peg], 0.25, 2.0)
    return folder_of(folder, parts), {("tight_hole", "tight_peg")}


def cavity(folder):
    """Cubes in the cavity of a block, on its floor, in its wall, and two at the same place."""
    vertices, faces = box((0, 0, 0), (10, 10, 10))
    inner, inside = box((2, 2, 2), (8, 8, 8))
    faces = [*faces, *(tuple(8 + k for k in face[::-1]) for face in inside)]
    parts = {
        "block": (vertices + inner, faces),
        "free": box((4, 4, 4), (5, 5, 5)),
        "on_floor": box((6, 6, 2), (7, 7, 3)),
        "in_wall": box((0.5, 4, 4), (1.5, 5, 5)),
        "through": box((1, 3, 6), (3, 3.5, 7)),
        "twin_1": box((12, 0, 0), (13, 1, 1)),
        "twin_2": box((12, 0, 0), (13, 1, 1)),
        "above": box((4, 4, 5), (5, 5, 6)),
    }
    return folder_of(folder, parts), {
        ("block", "in_wall"),
        ("block", "through"),
        ("twin_1", "twin_2"),
    }


def shared_edge(folder):
    """A part of two prisms that overlap and share an edge, and a box inside both."""
    square = prism([(0, 0), (1, 0), (1, 1), (0, 1)], 0, 1)
    turned = prism([(0, 0), (0.75, 0.5), (0.25, 1.25), (-0.5, 0.75)], 0, 1)
    faces = [*square[1], *(tuple(8 + k for k in face) for face in turned[1])]
    parts = {"two": (square[0] + turned[0], faces), "box": box((0.3, 0.35, 0.4), (0.4, 0.45, 0.6))}
    return folder_of(folder, parts), {("two", "box")}


def planted(folder):
    """10,000 cubes and brackets at random rotations, of which 50 pairs overlap."""
    random = np.random.default_rng(5)
    # Both shapes contain the ball of radius 0.5 around the origin, and lie in the ball of radius 1.
    write_off(folder / "cube.off", *box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))
    corner = [(-0.5, -0.5), (0.7, -0.5), (0.7, -0.3), (0.5, -0.3), (0.5, 0.5), (-0.5, 0.5)]
    write_off(folder / "bracket.off", *prism(corner, -0.5, 0.5))
    cells = np.array(list(product(range(25), range(20), range(20))))[:9950] * 4.0
    turns = random.normal(size=(10_000, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    hosts = random.choice(len(cells), 50, replace=False)
    ways = random.normal(size=(50, 3))
    ways *= random.uniform(0.5, 0.99, size=(50, 1)) / np.linalg.norm(ways, axis=1, keepdims=True)
    places = np.concatenate([cells, cells[hosts] + ways])
    names = [f"part_{k}" for k in range(10_000)]
    files = random.choice(["cube.off", "bracket.off"], 10_000)
    parts = list(zip(names, files.tolist(), places, turns, strict=True))
    clashes = {(names[host], names[9950 + k]) for k, host in enumerate(hosts)}
    return manifest(folder, parts), clashes


def sheets(folder):
    """Walls (open quads) that end on a floor or above it, or pass through it."""

    def wall(x, z):
        return [(x, 1, z), (x, 3, z), (x, 3, 2), (x, 1, 2)], [(0, 1, 2, 3)]

    parts = {"floor": ([(0, 0, 0), (40, 0, 0), (40, 4, 0), (0, 4, 0)], [(0, 1, 2, 3)])}
    parts |= {f"on_{k}": wall(1.3 * k + 1, 0.0) for k in range(20)}
    parts |= {f"above_{k}": wall(30 + k, 0.1) for k in range(3)}
    parts |= {f"through_{k}": wall(34 + k, -0.1) for k in range(3)}
    return folder_of(folder, parts), {("floor", f"through_{k}") for k in range(3)}


#: Generated models, each with a clearance.
MADE = {
    "grid": (grid, 0.0),
    "rounded_grid": (rounded_grid, 0.0),
    "pegs": (pegs, 1e-6),
    "cavity": (cavity, 1.0),
    "shared_edge": (shared_edge, 0.0),
    "planted": (planted, 2.5),
    "sheets": (sheets, 0.5),
}

# The other programs. Each runs in a process of its own.


def near_pairs(bodies, within):
    """Returns all pairs whose boxes are at most `within` apart along each axis, by a sweep."""
    lows = np.array([vertices.min(axis=0) for vertices, _ in bodies])
    highs = np.array([vertices.max(axis=0) for vertices, _ in bodies]) + within
    order = np.argsort(lows[:, 0], kind="stable")
    starts = lows[order, 0]
    for k, a in enumerate(order):
        rest = order[k + 1 : np.searchsorted(starts, highs[a, 0], side="right")]
        meets = (lows[rest] <= highs[a]).all(axis=1) & (lows[a] <= highs[rest]).all(axis=1)
        for b in rest[meets]:
            yield min(a, b), max(a, b)


def by_manifold(bodies, within):
    import manifold3d

    def built(body):
        mesh = manifold3d.Mesh64(body[0], body[1].astype(np.uint64))
        mesh.merge()
        made = manifold3d.Manifold(mesh)
        if made.status() != manifold3d.Error.NoError:
            return None
        # Bodies of one part may overlap. Without a union their common volume counts twice.
        bodies = made.decompose()
        if len(bodies) > 1 and all(one.volume() > 0 for one in bodies):
            made = manifold3d.Manifold.batch_boolean(bodies, manifold3d.OpType.Add)
        return made

    made = [built(body) for body in bodies]
    yield [k for k, one in enumerate(made) if one is None]
    for a, b in near_pairs(bodies, within):
        if made[a] is None or made[b] is None:
            yield a, b, None, None, None
            continue
        volume = (made[a] ^ made[b]).volume()
        gap = made[a].min_gap(made[b], within) if volume <= 0 and within > 0 else None
        yield a, b, volume > 0, volume, gap if gap is None or gap < within else None


def by_fcl(bodies, within):
    import fcl

    def built(body):
        mesh = fcl.BVHModel()
        mesh.beginModel(len(body[0]), len(body[1]))
        mesh.addSubModel(body[0], body[1].astype(np.int32))
        mesh.endModel()
        return fcl.CollisionObject(mesh)

    made = [built(body) for body in bodies]
    yield []
    request = fcl.CollisionRequest(num_max_contacts=1)
    for a, b in near_pairs(bodies, within):
        hits = fcl.collide(made[a], made[b], request, fcl.CollisionResult()) > 0
        gap = None if hits or within <= 0 else fcl.distance(made[a], made[b])
        yield a, b, hits, None, gap


PEERS = {"manifold3d": by_manifold, "python-fcl": by_fcl}


def placed(source, file):
    """Reads a model, and writes its triangles in world coordinates."""
    from colltrans import Assembly

    began = time.process_time()
    children = sum(os.times()[2:4])
    assembly = Assembly.read(source)
    seconds = time.process_time() - began + sum(os.times()[2:4]) - children
    arrays = {}
    for k, (vertices, triangles) in enumerate(assembly.meshes().values()):
        arrays[f"v{k}"], arrays[f"t{k}"] = vertices, triangles
    with open(file, "wb") as out:
        np.savez(out, names=np.array(assembly.parts), **arrays)
    return {"seconds": seconds, "parts": assembly.parts}


def answers_of(peer, file, within, limit):
    """Returns the answers of another program to all pairs, until `limit` seconds are over."""
    with np.load(file) as arrays:
        count = len(arrays["names"])
        bodies = [(arrays[f"v{k}"], arrays[f"t{k}"]) for k in range(count)]
    began, processor = time.perf_counter(), time.process_time()
    found = PEERS[peer](bodies, within)
    refused, pairs, is_complete = next(found), [], True
    built = time.process_time() - processor
    for row in found:
        pairs.append([x if x is None else x.item() if hasattr(x, "item") else x for x in row])
        if time.perf_counter() - began > limit:
            is_complete = False
            break
    spent = {"wall": time.perf_counter() - began, "cpu": time.process_time() - processor}
    return {**spent, "built": built, "refused": refused, "pairs": pairs, "complete": is_complete}


#: Runs a command in a small process, so that the memory of this one does not count.
MEASURE = """
import json, resource, subprocess, sys, time
began = time.perf_counter()
with open(sys.argv[1], "wb") as out, open(sys.argv[2], "wb") as words:
    code = subprocess.call(sys.argv[3:], stdout=out, stderr=words)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
seconds = {"wall": time.perf_counter() - began, "cpu": used.ru_utime + used.ru_stime}
print(json.dumps({"code": code, **seconds, "MB": used.ru_maxrss / 1024}))
"""


def measured(command, folder):
    """Runs a command that prints JSON; returns its value, and the time and memory used."""
    out, words = folder / "out.json", folder / "words.txt"
    launch = [sys.executable, "-S", "-c", MEASURE, out, words, *command]
    used = json.loads(subprocess.run(launch, check=True, stdout=subprocess.PIPE).stdout)
    if not out.stat().st_size:
        sys.exit(f"{command} failed with exit code {used['code']}: {words.read_text()[-1000:]}")
    return json.loads(out.read_text()), used


def child(folder, *words):
    return measured([sys.executable, __file__, "--child", *map(str, words)], folder)


# The comparison.


class Pairs:
    """The answers of ``colltrans audit`` to all pairs of a model."""

    def __init__(self, told, clashes):
        self.names = [part["name"] for part in told["parts"]]
        self.volumes = [abs(part.get("volume") or 0.0) for part in told["parts"]]
        self.found = {frozenset(pair["parts"]): pair for pair in told["pairs"]}
        self.own = {key for key, pair in self.found.items() if is_clash(pair)}
        self.known = self.own if clashes is None else {frozenset(pair) for pair in clashes}

    def of(self, a, b):
        key = frozenset((self.names[a], self.names[b]))
        return key, self.found.get(key, {"finding": "none"})


def is_clash(pair):
    return pair["finding"] in ("interfering", "contained")


def is_outside(value, bounds, scale):
    """Checks whether a value is outside of bounds by more than the rounding at a scale."""
    return max(bounds[0] - value, value - bounds[1]) > ROUNDING * scale


def judged(pairs, rows, within):
    """Compares answers with the known clashes and the proven bounds; returns counts and pairs."""
    counts, odd, seen = Counter(), [], set()
    for a, b, hit, volume, gap in rows:
        key, ours = pairs.of(a, b)
        seen.add(key)
        least = min(pairs.volumes[a], pairs.volumes[b])
        words = []
        if hit is None:
            counts["refused"] += 1
        elif hit and key not in pairs.known:
            words.append("touching" if ours["finding"] == "touching" else "false")
            if volume is not None and volume <= SLIVER * least:
                words.append("sliver")
        elif not hit and key in pairs.known:
            words.append("missed")
        if hit and volume is not None and is_clash(ours):
            counts["volumes"] += 1
            if is_outside(volume, ours["volume"], least):
                words.append("volumes off")
        if hit is False and ours["finding"] in ("touching", "apart") and within > 0:
            counts["distances"] += 1
            # Manifold has no gap beyond the clearance.
            if is_outside(within if gap is None else gap, ours["distance"], within):
                words.append("distances off")
        counts.update(words)
        if words:
            odd.append((words, sorted(key), volume, gap, ours))
    counts["missed"] += len(pairs.known - seen)
    return counts, odd


def brief(pair):
    keys = ("finding", "tolerance", "least_tolerance", "distance", "depth", "volume", "inner")
    return ", ".join(f"{key} {pair[key]}" for key in keys if pair.get(key) is not None)


def compare(name, source, within, clashes, arguments, folder):
    """Runs all programs on a model; returns a row for each."""
    file, load = folder / "placed.npz", os.getloadavg()[0]
    read, _ = child(folder, "placed", source, file)
    command = [arguments.program, "audit", source, "--within", within, "--json"]
    told, used = measured([str(word) for word in command], folder)
    pairs = Pairs(told, clashes)
    facets = sum(part["facets"] for part in told["parts"])
    about = {"model": name, "parts": len(pairs.names), "facets": facets, "within": within}
    about["load"] = f"{load:.1f}"
    row = {**about, "program": "colltrans", "pairs": told["counts"]["examined"]}
    row |= {"wall": used["wall"], "cpu": used["cpu"], "MB": round(used["MB"])}
    row |= {"reading": read["seconds"], "clashes": len(pairs.own)}
    row |= {"missed": len(pairs.known - pairs.own), "false": len(pairs.own - pairs.known)}
    rows = [row]
    kinds = Counter(pair["finding"] for pair in told["pairs"])
    print(f"\n{name}: {len(pairs.names)} parts, {facets} facets, {dict(kinds)}", flush=True)
    for key in pairs.known ^ pairs.own:
        print("  colltrans:", sorted(key), brief(pairs.found.get(key, {"finding": "none"})))
    for peer in arguments.peers:
        found, used = child(folder, peer, file, within, arguments.seconds)
        counts, odd = judged(pairs, found["pairs"], within)
        row = {**about, "program": peer, "pairs": len(found["pairs"])}
        row |= {"wall": found["wall"], "cpu": found["cpu"], "MB": round(used["MB"])}
        row["clashes"] = sum(hit is True for _, _, hit, *_ in found["pairs"])
        row |= {key: counts[key] for key in COUNTS} | {"refused parts": len(found["refused"])}
        if not found["complete"]:
            row |= {"pairs": f"{row['pairs']}, stopped", "missed": ""}
        rows.append(row)
        odd = [line for line in odd if not set(line[0]) <= set(arguments.quiet)]
        for words, names, volume, gap, ours in odd[: arguments.limit]:
            values = f"{' and '.join(words)} {names}: volume {volume}, gap {gap}"
            print(f"  {peer}: {values}; ours {brief(ours)}")
        if len(odd) > arguments.limit:
            print(f"  {peer}: and {len(odd) - arguments.limit} more")
    for row in rows:
        row |= {key: f"{row[key]:.2f}" for key in ("wall", "cpu", "reading") if key in row}
        print("  " + ", ".join(f"{key} {value}" for key, value in row.items() if key not in about))
    sys.stdout.flush()
    return rows


COUNTS = ["missed", "touching", "false", "sliver", "refused"]
COUNTS += ["volumes", "volumes off", "distances", "distances off"]
COLUMNS = ["model", "parts", "facets", "within", "load", "program", "pairs", "wall", "cpu"]
COLUMNS += ["reading", "MB", "clashes", "refused parts", *COUNTS]


def main():
    parser = argparse.ArgumentParser(description="Compares audits with other programs.")
    parser.add_argument(
        "models", nargs="*", help="models, PATH or PATH=CLEARANCE, or generated ones"
    )
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/colltrans")
    parser.add_argument("--peers", nargs="*", default=list(PEERS), choices=PEERS)
    parser.add_argument("--seconds", type=float, default=300, help="of another program on a model")
    parser.add_argument("--limit", type=int, default=10, help="printed pairs of a model")
    parser.add_argument(
        "--quiet", nargs="*", default=[], help="kinds of pairs that are not printed"
    )
    parser.add_argument("--csv", type=Path)
    parser.add_argument("--child", nargs="+", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        kind, *words = arguments.child
        if kind == "placed":
            json.dump(placed(*words), sys.stdout)
        else:
            json.dump(answers_of(kind, words[0], float(words[1]), float(words[2])), sys.stdout)
        return
    data = {name: within for name, within in DATA.items() if (arguments.data / name).exists()}
    rows = []
    for model in arguments.models or [*MADE, *data]:
        path, _, length = model.partition("=")
        make, default = MADE.get(path, (None, DATA.get(path, 0.0)))
        within = float(length or default)
        with tempfile.TemporaryDirectory() as folder:
            here = Path(folder)
            source, clashes = arguments.data / path if path in DATA else Path(path), None
            if make is not None:
                (here / "model").mkdir()
                source, clashes = make(here / "model")
            rows += compare(path, source, within, clashes, arguments, here)
        if arguments.csv:
            with arguments.csv.open("w", newline="") as file:
                table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
                table.writeheader()
                table.writerows(rows)


if __name__ == "__main__":
    main()
