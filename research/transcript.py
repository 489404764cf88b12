#!/usr/bin/env python3
"""Compares two builds of the command line program, byte for byte.

    python3 research/transcript.py OLD NEW [--count 2000] [--seed 1]

Both programs run the same random command lines: all subcommands, text and JSON, valid and invalid input,
files that they write, proofs among them. Every exit code, standard output, standard error and file has to be
the same. Each difference is printed; the exit code is 1 if there is one. A change that only moves code has none.
"""

import argparse
import collections
import collections.abc
import concurrent.futures
import hashlib
import json
import pathlib
import random
import shlex
import subprocess
import sys
import tempfile

DATA = pathlib.Path(__file__).resolve().parent.parent / "data"

CONVEX = [
    "data/dodecahedron.off",
    "data/ellipsoid_a.obj",
    "data/ellipsoid_b.off",
    "data/cube.off",
    "data/gear_hull.stl",
]
PARTS = ["data/plate.off", "data/bolt.stl", "data/bracket.obj"]
SHEETS = ["sheet.obj"]
BROKEN = [
    "missing.stl",
    "empty.obj",
    "words.off",
    "flat.stl",
    "data/queries.jsonl",
    "nan.obj",
    "inside_out.off",
    "far.obj",
]

FILES = {
    "empty.obj": "",
    "words.off": "OFF\nthis is no mesh\n",
    "flat.stl": "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
    "vertex 2 0 0\nendloop\nendfacet\nendsolid a\n",
    "nan.obj": "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "inside_out.off": "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 3 1\n3 1 3 2\n3 2 3 0\n",
    "far.obj": "v 0 0 0\nv 1e300 0 0\nv 0 1e300 0\nv 0 0 1e300\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n",
    "sheet.obj": "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3\nf 1 3 4\n",
    "ways.txt": "x\n-y\n1,1,0\n# none\n0,0,0\n",
    "bad.jsonl": '{"moving": "data/cube.off", "fixed": 3}\nnot JSON\n{"direction": [0, 0, "x"]}\n\n',
    "scene.jsonl": '{"body": {"mesh": "data/cube.off"}, "pose": {"translation": [9, 0, 0]}}\n'
    '{"body": {"mesh": "data/dodecahedron.off"}, "pose": {"translation": [0, 9, 0]}, "name": "d"}\n',
    "poses.json": "[[0, 0, 9, 0, 0, 0, 1], [3, 0, 5, 0, 0, 0, 1]]",
    "bad.json": '{"format": "colltrans proof", "version": 2, "bodies": []}',
}


#: What a word of an option is: itself, or what makes it.
Word = str | collections.abc.Callable[[], str]


class Lines:
    """Makes random command lines."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def one_in(self, n: int) -> bool:
        return self.random.randrange(n) == 0

    def some(self, *options: tuple[float, *tuple[Word, ...]]) -> list[str]:
        """Returns some options, each with its probability. An option `name=` is followed by its value."""
        found: list[str] = []
        for chance, *words in options:
            if self.random.random() < chance:
                made = [word if isinstance(word, str) else word() for word in words]
                found += ["".join(made)] if made[0].endswith("=") else made
        return found

    def number(self) -> str:
        if self.one_in(250):
            return self.random.choice(["nan", "inf", "1e300", "1e-320", "word", ""])
        return self.random.choice([f"{self.random.uniform(-8, 8):.3g}", str(self.random.randint(-6, 6))])

    def length(self) -> str:
        return self.number() if self.one_in(8) else f"{self.random.uniform(0, 2):.2g}"

    def vector(self) -> str:
        if self.one_in(200):
            return self.random.choice(["", "1,2", "0,0,0", "a,b,c"])
        return ",".join(self.number() for _ in range(3))

    def direction(self) -> str:
        return self.random.choice(["x", "-y", "z", "-z", self.vector(), self.vector()])

    def pose(self) -> str:
        half = "0.7071067811865476"
        turns = ["", "", "", ",0,0,0,1", ",0.2,0.4,0.4,0.8", f",0,0,{half},{half}", ",0,0,0.71,0.71"]
        return self.vector() + (",1,1,1,1" if self.one_in(60) else self.random.choice(turns))

    def mesh(self, parts: bool) -> str:
        if self.one_in(40):
            return self.random.choice(BROKEN)
        return self.random.choice(CONVEX + PARTS + SHEETS if parts or self.one_in(12) else CONVEX)

    def sides(self, parts: float, between: str = "--from") -> list[str]:
        """Returns a moving and a fixed mesh, with this probability as parts."""
        if self.random.random() < parts:
            return [self.mesh(True), between, self.mesh(True)]
        return [self.mesh(False), self.mesh(False)]

    def asked(self) -> list[str]:
        """Returns where meshes are, and what is written of the answer."""
        return self.some(
            (0.6, "--moving-pose=", self.pose),
            (0.25, "--fixed-pose=", self.pose),
            (0.05, "--moving-rpy=", self.vector),
            (0.06, "--fixed-scale=", self.length),
            *self.outputs(),
        )

    def outputs(self) -> list[tuple[float, *tuple[Word, ...]]]:
        written = (0.3, "--save-proof", "proof.json")
        return [(0.45, "--json"), written, (0.1, "--picture", "picture.svg"), (0.01, "--unknown")]

    def way(self) -> list[str]:
        if self.one_in(12):
            return ["--directions", "ways.txt"]
        return self.some((0.98, "--direction=", self.direction))

    def cast(self) -> list[str]:
        solvers = [["--solver", "portal"], ["--solver", "auto"], ["--solver", "none"], ["--solver", "cta"]]
        solvers.append(
            ["--solver", "cta", *self.some((0.5, "--start", "ellipsoids"), (0.5, "--until", "0.001"))]
        )
        solver = self.random.choice(solvers) if self.one_in(3) else []
        options = self.some((0.15, "--min-gap=", self.length), (0.1, "--graze-tolerance=", self.length))
        return [*self.sides(0.0), *self.way(), *solver, *options, *self.some((0.1, "--hull")), *self.asked()]

    def clearance(self) -> list[str]:
        if self.one_in(8):
            scene = [self.mesh(True), "--scene", "scene.jsonl", self.mesh(True)]
            return [*scene, *self.way(), *self.some((0.6, "--moving-pose=", self.pose), *self.outputs())]
        of_parts = self.some((0.3, "--tolerance=", self.length), (0.25, "--ignore-start-overlaps"))
        sides = self.sides(0.6)
        options = of_parts if "--from" in sides or self.one_in(20) else []
        return [*sides, *self.way(), *options, *self.some((0.1, "--min-gap=", self.length)), *self.asked()]

    def motion(self) -> list[str]:
        angle = self.random.choice(["90", "10", "-200", self.number()])
        moves = [
            ["--turn", self.vector(), self.direction(), angle],
            ["--screw", self.vector(), "z", "45", self.number()],
            [f"--slide={self.vector()}"],
            ["--thrown", self.vector(), self.vector(), self.vector()],
            [f"--to={self.pose()}"],
            ["--through", "poses.json"],
        ]
        options = self.some((0.1, "--min-gap=", self.length), (0.15, "--clearance"), (0.1, "--tolerance=0.1"))
        places = self.some((0.7, "--fixed-pose=", self.pose), *self.outputs())
        return [*self.sides(0.2), *self.random.choice(moves), *options, *places]

    def path(self) -> list[str]:
        pairs = self.random.choice(["base,wire", "tool,wire", "a", "fore,tool"])
        return [
            *("data/cube.off" if self.one_in(20) else "data/arm.urdf", "data/arm.csv"),
            *self.some((0.7, "data/wire.obj"), (0.2, "data/cube.off"), (0.2, "--min-gap=", self.length)),
            *self.some((0.2, "--ignore", pairs), (0.1, "--hull", "*"), (0.1, "--strict")),
            *self.some((0.1, "--scene-scale=0.5"), *self.outputs()[:2]),
        ]

    def distance(self) -> list[str]:
        if self.one_in(8):
            return [self.mesh(True), "--scene", "scene.jsonl", *self.some((0.6, "--moving-pose=", self.pose))]
        sides = [side for side in self.sides(0.4) if side != "--from"]
        return [*sides, *self.some((0.1, "--hull")), *self.asked()]

    def depth(self) -> list[str]:
        return [*self.sides(0.0), *self.some((0.2, "--hull")), *self.asked()]

    def within(self) -> list[str]:
        return [*self.sides(0.4), *self.some((0.98, "--length=", self.length)), *self.asked()]

    def directions(self) -> list[str]:
        moving = self.random.choice(["data/bolt.stl", "data/cube.off"])
        fixed = self.random.choice(["data/plate.off", "data/bracket.obj"])
        options = self.some((0.4, "--tolerance=", self.length), (0.2, "--ignore-start-overlaps"))
        depth = ["--depth", self.random.choice(["3", "4", "5", "x"]), *self.some((0.2, "--looks", "2000"))]
        return [moving, "--from", fixed, *depth, *options, *self.some((0.6, "--moving-pose=", self.pose))] + (
            self.some(*self.outputs()[:2])
        )

    def assembly(self) -> list[str]:
        files = ["data/gearbox_small"] * 4 + ["data/arm.urdf", "empty.obj"]
        options = self.some(
            (0.3, "--json"), (0.2, "--tolerance", "0.05"), (0.2, "--auto"), (0.5, "-o", "out")
        )
        return [self.random.choice(files), *options]

    def batch(self) -> list[str]:
        files = ["data/queries.jsonl", "bad.jsonl", "missing.jsonl"]
        return [self.random.choice(files), *self.some((0.3, "-o", "results.jsonl"))]

    def info(self) -> list[str]:
        return [self.random.choice(BROKEN) if self.one_in(3) else self.mesh(True)]

    def verify(self) -> list[str]:
        return [self.random.choice(["bad.json", "data/queries.jsonl", "missing.json", "poses.json"])]

    def replay(self) -> list[str]:
        return self.verify()

    def each(self, count: int) -> list[list[str]]:
        """Returns so many command lines, most of the questions that are asked most."""
        weights = {
            "cast": 26, "clearance": 26, "motion": 10, "path": 6, "distance": 8, "depth": 5, "within": 5,
            "directions": 4, "assembly": 1, "batch": 2, "info": 5, "verify": 1, "replay": 1,
        }  # fmt: skip
        names = self.random.choices(list(weights), list(weights.values()), k=count)
        others = [
            ["--help"],
            ["--version"],
            [],
            ["unknown"],
            ["setup"],
            *([name, "--help"] for name in weights),
        ]
        return (others + [[name, *getattr(self, name)()] for name in names])[:count]


def transcript(program: pathlib.Path, words: list[str]) -> list[tuple[str, bytes]]:
    """Runs a command line in a folder of its own, checks a proof that it writes, and returns all output."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "data").symlink_to(DATA)
        for file, text in FILES.items():
            (folder / file).write_text(text)
        told: list[tuple[str, bytes]] = []

        def run(words: list[str]) -> None:
            # Both have one name in their messages.
            done = subprocess.run(
                ["colltrans", *words],
                executable=program,
                cwd=folder,
                capture_output=True,
                stdin=subprocess.DEVNULL,
                timeout=300,
            )
            told.append(("exit code", str(done.returncode).encode()))
            # Folders have other names each time.
            told.extend(
                (what, text.replace(name.encode(), b"FOLDER"))
                for what, text in [("output", done.stdout), ("error", done.stderr)]
            )

        run(words)
        if (folder / "proof.json").is_file():
            run(["verify", "proof.json"])
        written = sorted(path for path in folder.rglob("*") if path.is_file() and path.name not in FILES)
        told.extend(
            (str(path.relative_to(folder)), path.read_bytes())
            for path in written
            if "data" not in path.parts[len(folder.parts) :]
        )
        return told


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    asked = parser.parse_args()
    programs = [asked.old.resolve(), asked.new.resolve()]
    lines = Lines(asked.seed).each(asked.count)
    codes, proofs, differences, all_bytes = collections.Counter[str](), 0, 0, hashlib.sha256()
    with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        for words, (old, new) in zip(
            lines, pool.map(lambda words: [transcript(p, words) for p in programs], lines), strict=True
        ):
            codes[f"{words[0] if words else ''} {old[0][1].decode()}"] += 1
            proofs += any(name == "proof.json" for name, _ in old)
            all_bytes.update(json.dumps([[name, text.hex()] for name, text in old]).encode())
            if old == new:
                continue
            differences += 1
            print(f"colltrans {shlex.join(words)}")
            for (name, before), (_, after) in zip(old, new, strict=False):
                if before != after:
                    print(f"    {name}: {before[:200]!r}\n    {' ' * len(name)}  {after[:200]!r}")
            if [name for name, _ in old] != [name for name, _ in new]:
                print(f"    parts: {[name for name, _ in old]}\n           {[name for name, _ in new]}")
    print(", ".join(f"{name}: {count}" for name, count in sorted(codes.items())))
    print(
        f"{len(lines)} command lines, {proofs} proofs, {differences} differences; "
        f"sha256 {all_bytes.hexdigest()}"
    )
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
