// The package in Node, against native answers. Needs `npm run package` and the native example `package`.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import * as THREE from "three";
import { draws, program } from "../../browser.mjs";
import * as all from "colltrans";
import * as casts from "colltrans/cast";
import { Library, library } from "../dist/library.js";
import { castTwoBoxes, distanceOfMeshes, isFree, manyCasts, meshAgainstMesh } from "./five.mjs";

const { ConvexPolyhedron, Motion, Solid, cast, castMany, clearance, clearanceMany, contactRange, depth, distance, distanceMany, intersects, motion, within } = all;
const here = dirname(fileURLToPath(import.meta.url));
const cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1]);

// All calls of the tests are recorded, and answered once more by the native library.
const calls = [];
const call = Library.prototype.call;
const bytes = (array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength);
const lengths = (...parts) => Buffer.from(Uint32Array.from(parts, (part) => part.length).buffer);
before(() => {
  // Other bodies may be freed before the recording starts, so that it starts with those in use.
  Library.prototype.call = function (numbers, ...data) {
    const question = [bytes(Float64Array.from(numbers)), Buffer.concat(data.map(bytes))];
    let reply;
    try {
      reply = call.call(this, numbers, ...data);
    } catch (error) {
      calls.push({ question, error });
      throw error;
    }
    calls.push({ question, reply });
    return reply;
  };
});
after(() => (Library.prototype.call = call));

/** A cube with a square hole along z, from -2 to 2, as points and triangles. */
function frame() {
  const ring = (r, z) => [[-r, -r, z], [r, -r, z], [r, r, z], [-r, r, z]];
  const points = [...ring(2, -2), ...ring(1, -2), ...ring(2, 2), ...ring(1, 2)];
  const sides = [0, 1, 2, 3].flatMap((k) => {
    const n = (k + 1) % 4;
    return [[k, n, 8 + n, 8 + k], [4 + n, 4 + k, 12 + k, 12 + n], [n, k, 4 + k, 4 + n], [8 + k, 8 + n, 12 + n, 12 + k]];
  });
  return [points, sides];
}

test("five tasks have their answers", () => {
  assert.equal(castTwoBoxes(), 2);
  const [points, faces] = frame();
  const [above, at] = [points.map(([x, y, z]) => [x, y, z + 10]), distanceOfMeshes];
  assert.ok(Math.abs(at(points, faces, above, faces) - 6) < 1e-12);
  const hole = Solid.fromMesh(points, faces);
  const peg = ConvexPolyhedron.cuboid([-0.5, -0.5, -1], [0.5, 0.5, 1]);
  assert.equal(isFree(peg, hole, [0, 0, 1]), true);
  assert.equal(isFree(peg, hole, [1, 0, 0]), false);
  const positions = Float64Array.from({ length: 3 * 100 }, (_, k) => (k % 3 === 2 ? 2 + k : 0));
  assert.deepEqual(manyCasts(cube, cube, positions), Float64Array.from({ length: 100 }, (_, k) => 3 * k + 3));
  const mesh = new THREE.Mesh(new THREE.BoxGeometry(1, 1, 1));
  mesh.position.set(0, 0, 5);
  const found = meshAgainstMesh(mesh, new THREE.Mesh(new THREE.CylinderGeometry(2, 2, 1, 32).rotateX(Math.PI / 2)));
  assert.equal(found.outcome, "blocked");
  assert.ok(Math.abs(found.value - 4) < 1e-5, String(found.value));
});

test("program of the guide prints its output", () => {
  const guide = readFileSync(join(here, "../../../docs/guide/javascript.md"), "utf8");
  const [, program, printed] = /guide\.mjs -->\n```js\n(.*?)```.*?```text\n(.*?)```/s.exec(guide);
  assert.equal(readFileSync(join(here, "guide.mjs"), "utf8"), program);
  assert.equal(execFileSync(process.execPath, [join(here, "guide.mjs")], { encoding: "utf8" }), printed);
});

test("answers of every question have the fields of their types", () => {
  const placed = cube.at([-3, 0.5, 0]);
  const hit = cast(placed, cube, [1, 0, 0]);
  assert.equal(hit.outcome, "contact");
  assert.deepEqual([hit.value, hit.normal, hit.features.moving.kind], [2, [1, 0, 0], "face"]);
  assert.ok(hit.lower <= 2 && 2 <= hit.upper && hit.upper - hit.lower < 1e-12);
  assert.equal(cast(placed, cube, [0, 1, 0]).outcome, "separated");
  assert.equal(cast(cube.at([-3, 1, 0]), cube, [1, 0, 0]).outcome, "grazing");
  assert.equal(clearance(cube.at([0, 0, 1]), cube, [0, 0, -1]).value, 0);
  assert.deepEqual(["slides", "behind"], [[1, 0, 0], [0, 0, 1]].map((d) => clearance(cube.at([0, 0, 1]), cube, d).outcome));
  assert.equal(clearance(cube.at([0.5, 0, 0]), cube, [1, 0, 0]).value, null);
  assert.ok(Math.abs(clearance(cube.at([0, 0, 4]), cube, [0, 0, -1], { minGap: 0.25 }).value - 2.75) < 1e-12);
  const range = contactRange(placed, cube, [1, 0, 0]);
  assert.deepEqual([range.value, range.exit, range.overlap], [2, 4, null]);
  assert.equal(intersects(cube.at([1, 0, 0]), cube), true);
  assert.equal(intersects(cube.at([1.5, 0, 0]), cube), false);
  const apart = distance(cube, cube.at([4, 5, 0.25]));
  assert.ok(apart.lower <= 5 && 5 <= apart.upper && !apart.meets);
  assert.equal(apart.features.moving.kind, "edge");
  const overlap = depth(cube, cube.at([0.75, 0.5, 0.5]));
  assert.ok(overlap.lower <= 0.25 && 0.25 <= overlap.upper && overlap.overlaps);
  assert.deepEqual(overlap.direction, [-1, 0, 0]);
  assert.deepEqual([4.9, 5.1].map((length) => within(cube, cube, length, { fixedPose: [4, 5, 0.25] }).closer), [false, true]);
  const door = ConvexPolyhedron.cuboid([0, -0.02, 0], [1, 0.02, 2]);
  const post = ConvexPolyhedron.cuboid([0.55, 0.55, 0], [0.65, 0.65, 2]);
  const swing = Motion.turn([0, 0, 0], [0, 0, 1], { degrees: 90 });
  const met = motion(door, post, { movingMotion: swing });
  assert.equal(met.outcome, "contact");
  assert.ok(Math.abs(met.value - 0.432115832) < 1e-9);
  const ball = ConvexPolyhedron.sphere([0, 0, 0], 0.5);
  assert.ok(Math.abs(cast(ball.at([0, 0, 5]), cube, [0, 0, -1]).value - 3.5) < 1e-12);
  const block = ConvexPolyhedron.cuboid([-1, -1, -1], [1, 1, 1]);
  for (const fixed of [block, Solid.fromPieces([block])]) {
    const { lower, upper, pointOnMoving } = distance(ball.at([3, 0.25, 0.125]), fixed);
    assert.ok(lower <= 1.5 && 1.5 <= upper && upper - lower < 1e-9);
    assert.deepEqual(pointOnMoving, [2.5, 0.25, 0.125]);
    assert.equal(distance(ball.at([1.25, 0, 0]), fixed).meets, true);
  }
  const both = Solid.fromPieces([cube, ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 4])]);
  assert.deepEqual(both.bounds, { low: [0, 0, 0], high: [1, 1, 4] });
});

test("motions pass through poses, and rest in them", () => {
  const quarter = Motion.through([[0, 0, 0], [1, 0, 0, 0, 0, Math.SQRT1_2, Math.SQRT1_2]]);
  quarter.at(1).slice(12).forEach((x, k) => assert.ok(Math.abs(x - [1, 0, 0, 1][k]) < 1e-15));
  const other = Motion.through([[9, 0, 0], [5, 0, 0], [2, 0, 0]]);
  const met = motion(cube, cube, { movingMotion: Motion.slide([6, 0, 0]), fixedMotion: other });
  assert.equal(met.outcome, "contact");
  assert.ok(Math.abs(cube.bounds.high[0] + 6 * met.value - other.at(met.value)[12]) < 1e-9);
  assert.equal(motion(cube.at([0, 0, 3]), cube, { fixedMotion: Motion.slide([0, 0, 1]) }).outcome, "free");
  assert.throws(() => motion(cube.at([0, 0, 3]), cube, { movingMotion: quarter }), { name: "InputError", argument: "movingMotion" });
});

test("poses may be numbers, matrices and objects of three.js", () => {
  const turn = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(0, 0, 1), Math.PI / 4);
  const object = new THREE.Object3D();
  object.position.set(-3, 0, 0);
  object.quaternion.copy(turn);
  const numbers = [-3, 0, 0, turn.x, turn.y, turn.z, turn.w];
  const expected = cast(cube.at(numbers), cube, [1, 0, 0]).value;
  assert.equal(cast(cube.at({ position: object.position, quaternion: turn }), cube, { x: 1, y: 0, z: 0 }).value, expected);
  for (const pose of [object, object.matrixWorld, object.matrixWorld.elements]) {
    assert.ok(Math.abs(cast(cube, cube, [1, 0, 0], { movingPose: pose }).value - expected) < 1e-12);
  }
});

test("geometries with an index, without, interleaved and scaled give the same body", () => {
  const box = new THREE.BoxGeometry(2, 2, 2);
  const interleaved = new THREE.BufferGeometry();
  const { array, count } = box.attributes.position;
  const buffer = new THREE.InterleavedBuffer(Float32Array.from({ length: 5 * count }, (_, k) => (k % 5 < 3 ? array[3 * Math.floor(k / 5) + (k % 5)] : 7)), 5);
  interleaved.setAttribute("position", new THREE.InterleavedBufferAttribute(buffer, 3, 0)).setIndex(box.index);
  const half = [new THREE.BoxGeometry(1, 1, 1), { matrix: new THREE.Matrix4().makeScale(-2, 2, 2) }];
  for (const given of [[box], [box.toNonIndexed()], [interleaved], half]) {
    for (const body of [Solid.fromGeometry(...given), ConvexPolyhedron.fromGeometry(...given)]) {
      assert.deepEqual(body.bounds, { low: [-1, -1, -1], high: [1, 1, 1] });
      assert.ok(Math.abs(body.volume - 8) < 1e-12 && body.isClosed);
    }
  }
  // Their seams and poles are closed up to the precision of single numbers.
  for (const round of [new THREE.SphereGeometry(1), new THREE.CylinderGeometry(), new THREE.TorusGeometry(), new THREE.TorusKnotGeometry()]) {
    const body = Solid.fromGeometry(round);
    assert.ok(body.isClosed && body.volume > 0.5, round.type);
    const back = Solid.fromGeometry(body.toGeometry(THREE));
    assert.ok(Math.abs(back.volume - body.volume) < 1e-5 * body.volume, round.type);
  }
});

test("many rows equal single answers to the bit, and a failed row has its error", () => {
  const { random, turn } = draws(5n);
  const rows = 200;
  const positions = Float64Array.from({ length: 3 * rows }, () => 3 * random());
  const quaternions = Float64Array.from(Array.from({ length: rows }, turn).flat());
  const directions = Float64Array.from({ length: 3 * rows }, random);
  directions.fill(0, 30, 33);
  quaternions[80] = 5;
  const solid = Solid.fromMesh(...frame());
  for (const fixed of [cube, solid]) {
    for (const [many, single, given] of [[castMany, cast, [directions]], [clearanceMany, clearance, [directions]], [distanceMany, distance, []]]) {
      const answers = many(cube, fixed, ...given, { movingPoses: { positions, quaternions } });
      assert.equal(answers.length, rows);
      for (let k = 0; k < rows; k++) {
        const pose = [...positions.subarray(3 * k, 3 * k + 3), ...quaternions.subarray(4 * k, 4 * k + 4)];
        const direction = given.map((all) => all.subarray(3 * k, 3 * k + 3));
        if (answers.errors.has(k)) {
          const error = answers.errors.get(k);
          assert.throws(() => single(cube.at(pose), fixed, ...direction), { name: error.name });
          assert.equal(answers.outcome(k), "error");
          assert.ok(Number.isNaN(answers.value[k]));
          continue;
        }
        const one = single(cube.at(pose), fixed, ...direction);
        assert.deepEqual([answers.outcome(k), answers.lower[k], answers.upper[k]], [one.outcome, one.lower ?? NaN, one.upper ?? NaN]);
        assert.ok(Object.is(answers.value[k], one.value ?? NaN));
      }
      assert.deepEqual([...answers.errors.keys()], given.length ? [10, 20] : [20]);
    }
  }
});

test("wrong arguments are errors that name the argument", () => {
  const wrong = [
    [() => cast(cube, cube, [0, 0, 0]), "QueryError", "direction"],
    [() => cast(cube, cube, [0, 1]), "InputError", "direction"],
    [() => cast(cube, cube, [0, NaN, 1]), "InputError", "direction"],
    [() => cast(cube, {}, [0, 0, 1]), "InputError", "fixed"],
    [() => cast(cube, cube, [0, 0, 1], { gap: 1 }), "InputError", "gap"],
    [() => cast(cube, cube, [0, 0, 1], { minGap: -1 }), "QueryError", "minGap"],
    [() => cast(cube, cube, [0, 0, 1], { tolerance: 1 }), "InputError", "tolerance"],
    [() => cast(cube.at([0, 0, 0, 0, 0, 0, 2]), cube, [0, 0, 1]), "PoseError", "movingPose"],
    [() => cube.at([1, 2]), "InputError", "pose"],
    [() => cube.at(new THREE.Matrix4().makeScale(2, 2, 2)) && cast(cube, cube.at(new THREE.Matrix4().makeScale(2, 2, 2)), [0, 0, 1]), "PoseError", "fixedPose"],
    [() => within(cube, cube, -1), "QueryError", "length"],
    [() => ConvexPolyhedron.fromPoints([]), "BuildError", "points"],
    [() => ConvexPolyhedron.fromPoints([1, 2, 3, 4]), "InputError", "points"],
    [() => ConvexPolyhedron.fromMesh(...frame()), "BuildError", "faces"],
    [() => ConvexPolyhedron.sphere([0, 0, 0], -1), "BuildError", "radius"],
    [() => Solid.fromMesh([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]), "BuildError", "faces"],
    [() => Solid.fromMesh([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 3]), "InputError", "faces"],
    [() => Solid.fromGeometry({}), "InputError", "geometry"],
    [() => castMany(cube, cube, [0, 0, 1, 0]), "InputError", "directions"],
    [() => castMany(cube, cube, [0, 0, 1, 0, 0, 1], { movingPoses: { positions: new Float64Array(9) } }), "InputError", "directions"],
    [() => Motion.turn([0, 0, 0], [0, 0, 1], { degrees: 1, radians: 1 }), "InputError", "degrees, radians"],
    [() => Motion.turn([0, 0, 0], [0, 0, 0], { degrees: 1 }).at(0.5), "QueryError", "motion"],
  ];
  for (const [ask, name, argument] of wrong) assert.throws(ask, (error) => error instanceof all.ColltransError && error.name === name && error.argument === argument, ask.toString());
  assert.throws(() => Solid.fromMesh([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]), /not closed: 3 edges .* from vertex 0 to vertex 1 of face 0/);
  assert.equal(Solid.fromMesh([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2], { open: true }).isClosed, false);
});

test("freed bodies are gone, and their memory is used again", () => {
  const size = () => library().exports.memory.buffer.byteLength;
  const points = Float64Array.from({ length: 3 * 20_000 }, draws(1n).random);
  const round = () => {
    const body = ConvexPolyhedron.fromPoints(points);
    assert.ok(body.volume > 0);
    // As `using` does at the end of a block.
    body[Symbol.dispose]();
    return body;
  };
  const body = round();
  assert.throws(() => body.volume, { name: "InputError" });
  body.free();
  round();
  const before = size();
  for (let k = 0; k < 20; k++) round();
  assert.equal(size(), before);
});

test("bodies that were collected are freed", { skip: !globalThis.gc }, async () => {
  const size = () => library().exports.memory.buffer.byteLength;
  const points = Float64Array.from({ length: 3 * 20_000 }, draws(1n).random);
  const rounds = async (count) => {
    for (let k = 0; k < count; k++) {
      ConvexPolyhedron.fromPoints(points);
      globalThis.gc();
      await new Promise((resolve) => setTimeout(resolve, 5));
    }
  };
  await rounds(10);
  const before = size();
  await rounds(30);
  assert.equal(size(), before);
});

test("1,000 answers equal native answers to the bit, and so do all others of these tests", () => {
  const { random, turn } = draws(3n);
  const cloud = () => ConvexPolyhedron.fromPoints(Float64Array.from({ length: 3 * 40 }, random));
  const bodies = [cloud(), cloud(), cube, Solid.fromMesh(...frame())];
  const pose = () => [3 * random(), 3 * random(), 3 * random(), ...turn()];
  for (let k = 0; k < 1000; k++) {
    const [p, q] = [bodies[k % 4].at(pose()), bodies[(k >> 2) % 4].at(pose())];
    const direction = [random(), random(), random()];
    const ask = [() => cast(p, q, direction), () => clearance(p, q, direction), () => contactRange(p, q, direction), () => distance(p, q), () => depth(p, q), () => within(p, q, 2), () => intersects(p, q)][k % 7];
    ask();
  }
  // The box that the modules of the tests share was built before the recording.
  const corners = Float64Array.of(3, 0, 0, 0, 1, 1, 1);
  const questions = [{ question: [bytes(corners), Buffer.alloc(0)] }, ...calls].map(({ question }) => [lengths(...question), ...question]).flat();
  const out = execFileSync(program("package"), ["colltrans"], { input: Buffer.concat(questions), maxBuffer: 1 << 30 });
  let at = 8 + out.readUInt32LE(0) + out.readUInt32LE(4);
  for (const { reply, error } of calls) {
    const [text, numbers] = [out.readUInt32LE(at), out.readUInt32LE(at + 4)];
    const said = out.toString("utf8", at + 8, at + 8 + text);
    const answer = out.subarray(at + 8 + text, (at += 8 + text + numbers));
    if (error) assert.ok(said.endsWith(error.message.replace(/^[\w, ]+: /, "")), `${said} | ${error.message}`);
    else assert.deepEqual([said, Buffer.compare(answer, Buffer.from(reply.numbers))], [reply.text, 0]);
  }
  console.log(`${calls.length} calls`);
  assert.ok(calls.length > 2000);
});

test("the module of casts alone is small, and rejects what it lacks", () => {
  // In this process the full module is loaded first, so that its library is used.
  assert.equal(casts.cast, cast);
  assert.equal(library().name, "colltrans");
});
