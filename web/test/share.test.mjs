// The question as an address and as a command, without a browser.

import assert from "node:assert/strict";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { test } from "node:test";
import { build } from "esbuild";

const resolveDir = join(dirname(fileURLToPath(import.meta.url)), "../src");
const contents = ["share", "programs", "state", "examples"].map((name) => `export * from "./${name}";`).join("") + `export { asCommand as turningCommand } from "./turning/share";`;
const { outputFiles } = await build({ stdin: { contents, resolveDir, loader: "ts" }, bundle: true, format: "esm", write: false });
const { EXAMPLES, asCommand, asPython, asRust, fromExample, fromHash, toHash, turningCommand } = await import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);

test("address restores the same bits", () => {
  for (const name of Object.keys(EXAMPLES)) assert.deepEqual(fromHash(toHash(fromExample(name))), fromExample(name));
  const state = fromHash("#m=a b,+%26=#:%25.stl:hull&d=1e-7,-0.1,1e21&graze=1e-9&tol=0&ignore=1&solver=cta&t=-2.5&tab=assembly&ad=1,2,3&atol=0.1&aignore=1&apart=3");
  assert.deepEqual(fromHash(toHash(state)), state);
  // Invalid fields are as in the first example.
  for (const wrong of ["#example=toString", "#example=__proto__", "#d=1,2&mp=1&solver=x&tab=y&t=Infinity", "#m=x:y&f=:solid", "#%%%"]) {
    assert.deepEqual(fromHash(wrong), fromExample("bracket"));
  }
});

test("command asks the same question, or there is none", () => {
  assert.equal(asCommand(fromExample("slide")), "colltrans cast bracket.obj bracket.obj --direction=1,0,0 --moving-pose=-9,2,0,0,0,0,1");
  assert.equal(asCommand(fromHash("#example=plate&tol=0.01&ignore=1")),
    "colltrans clearance bolt.stl --from plate.off --direction=0,0,-1 --moving-pose=0,0,7,0,0,0,1 --tolerance=0.01 --ignore-start-overlaps");
  assert.match(asCommand(fromHash("#m=it's mine.off:hull&graze=0.1&solver=cta")), /^colltrans cast 'it'\\''s mine\.off' bracket\.obj .* --hull-moving --graze-tolerance=0\.1 --solver=cta$/);
  assert.match(asCommand(fromHash("#f=plate.off:open")), / --open$/);
  assert.match(asCommand(fromHash("#solver=cta&start=ellipsoids&until=0.2")), / --solver=cta --start=ellipsoids --until=0\.2$/);
  assert.match(asCommand(fromHash("#solver=cta&start=center&until=-1")), / --solver=cta$/);
  assert.equal(asCommand(fromHash("#m=bolt.stl:hull&f=plate.off:solid")), undefined);
});

test("shapes are restored from their address, and named as on the command line", () => {
  const state = fromHash("#m=capsule:0,0,-1e-7,0,0,1.5,0.25:convex&f=box:1,2,3,0.1:convex&mp=0,0,4,0,0,0,1&d=0,0,-1");
  assert.deepEqual([state.parts.moving.file, state.parts.fixed.file], ["capsule:0,0,-1e-7,0,0,1.5,0.25", "box:1,2,3,0.1"]);
  assert.deepEqual(fromHash(toHash(state)), state);
  assert.equal(asCommand(state), "colltrans cast capsule:0,0,-1e-7,0,0,1.5,0.25 box:1,2,3,0.1 --direction=0,0,-1 --moving-pose=0,0,4,0,0,0,1");
  assert.match(asCommand(fromHash("#m=sphere:0.5:convex&f=plate.off:solid")), /^colltrans clearance sphere:0\.5 --from plate\.off /);
  assert.match(asRust(state), /load_convex\("box:1,2,3,0\.1", &BodyOptions::default\(\)\)\?/);
  assert.match(asPython(state), /moving = colltrans\.read\("capsule:0,0,-1e-7,0,0,1\.5,0\.25"\)/);
  assert.match(turningCommand(state, { point: [0, 0, 0], axis: [0, 0, 1], angle: 9, rise: 0 }), /^colltrans motion capsule:0,0,-1e-7,0,0,1\.5,0\.25 box:1,2,3,0\.1 --turn /);
});

test("motion is restored from its address and its command", () => {
  const state = fromHash("#example=bracket&tab=motion&screw=1,2e-7,-3,0,-1,0.1,-120.5,4&gap=0.25&time=0.5&fp=0,0,1,0,0,0,1&tol=1e-3");
  assert.deepEqual(state.motion, { screw: { point: [1, 2e-7, -3], axis: [0, -1, 0.1], angle: -120.5, rise: 4 }, body: "moving", minGap: 0.25, time: 0.5 });
  assert.deepEqual(fromHash(toHash(state)), state);
  const asked = "colltrans motion dodecahedron.off bracket.obj --screw 1,2e-7,-3 0,-1,0.1 -120.5 4 --moving-pose=6,1,9,0.2,0.3,0.1,0.9273618495495703 --fixed-pose=0,0,1,0,0,0,1 --min-gap=0.25 --tolerance=0.001";
  assert.equal(turningCommand(state, state.motion.screw), asked);
  assert.match(turningCommand(fromHash("#m=x.off:hull&f=y.stl:open"), { point: [0, 0, 0], axis: [0, 0, 1], angle: 9, rise: 0 }), / --turn 0,0,0 0,0,1 9 .*--hull-moving .*--open$/);
  for (const wrong of ["#screw=1,2,3", "#screw=1,2,3,4,5,6,7,x", "#gap=-1&time=-3"]) assert.deepEqual(fromHash(wrong), fromExample("bracket"));
});

test("and as programs", () => {
  const state = fromHash('#m=a"b.stl:hull&f=plate.off:open&d=0,0,-1&tol=1&mp=0,0,7,0,0,0,1');
  assert.match(asRust(state), /load_convex\("a\\"b\.stl", &BodyOptions::default\(\)\.with_hull\(true\)\)\?;[^]*Solid::from_convex\(&moving\.body\)\?[^]*load_solid\("plate\.off", &BodyOptions::default\(\)\.with_open\(true\)\)\?;[^]*cast_between\([^]*DVec3::new\(0\.0, 0\.0, -1\.0\),\n *\[0\.0, fixed\.precision\],\n *Some\(1\.0\)/);
  const narrowed = fromHash("#solver=cta&until=0.1");
  assert.match(asRust(narrowed), /use colltrans::\{Cast, Options, Pose, Solver, cta\};[^]*with_narrowing\(cta::Options::new\(cta::Start::Center, cta::Until::Gap\(0\.1\)\)\)\)\?;/);
  assert.match(asPython(narrowed), /solver=colltrans\.Cta\(until=0\.1\)/);
  assert.match(asPython(fromHash("#solver=cta")), /solver="cta"/);
  assert.match(asPython(state), /read\("a\\"b\.stl", hull=True\)[^]*Solid\.read\("plate\.off", open=True\)[^]*tolerance=1\.0/);
});
