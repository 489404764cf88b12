// Spheres, capsules and boxes in place of files, in a browser. Needs `npm run build` and the example `native`.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { answers as nativeAnswers, conform, data, draws, site } from "../browser.mjs";

const READY = ["#headline", "#tools button"];
let at;
before(async () => (at = await site()));
after(() => at?.close());

const probe = (page, field) => page.evaluate((field) => window.colltrans.probe()[field], field);
const said = (page, text) => page.waitForFunction((text) => document.querySelector("#headline")?.textContent === text, text);

test("address with shapes is answered by the library that has them, and restored", async () => {
  const hash = "#m=sphere:0.5:convex&f=box:2,2,2,0.25:convex&mp=0.4,0.2,9,0,0,0,1&d=0,0,-1";
  const page = await at.open(hash, {}, READY);
  await said(page, "Contact at t = 7.25");
  const files = page.read.map((url) => new URL(url).pathname.split("/").at(-1));
  assert.ok(files.includes("colltrans_all.wasm") && !files.includes("colltrans.wasm"), files.join());
  // The point is on both round surfaces.
  const { record } = await probe(page, "answer");
  [0.4, 0.2, 1.25].forEach((x, k) => assert.ok(Math.abs(record.point[k] - x) < 1e-12, record.point.join()));
  assert.match(await page.textContent(".said"), /the moving body \(at a vertex of its core\) meets the fixed one \(at a face of its core\)/);
  assert.match(await page.textContent(".bodies"), /a sphere of radius 0\.5/);
  await page.click("text=Verify");
  await page.waitForSelector(".verdict.yes");
  // Another question, and its address.
  await page.fill('[aria-label="moving position x"]', "1.6");
  await page.waitForFunction(() => location.hash.includes("mp=1.6,"));
  const now = await probe(page, "answer");
  const again = await at.open(new URL(page.url()).hash, {}, READY);
  assert.deepStrictEqual((await probe(again, "answer")).record, now.record);
  assert.deepEqual([...page.complaints, ...again.complaints], []);
  await again.context().close();
  await page.context().close();
});

test("form replaces a body at its pose, and the other body keeps its file", async () => {
  const page = await at.open("#example=bracket", {}, READY);
  const before = await probe(page, "state");
  await page.click("summary:has-text('A sphere, capsule or box')");
  await page.fill('[aria-label="Radius"]', "1.5");
  await page.click("text=As the moving body");
  await page.waitForFunction(() => window.colltrans.probe().state.parts.moving.file === "sphere:1.5" && window.colltrans.probe().answer);
  const state = await probe(page, "state");
  assert.deepEqual([state.poses, state.parts.fixed], [before.poses, before.parts.fixed]);
  await page.waitForFunction(() => location.hash.includes("m=sphere:1.5:convex"));
  // A capsule along z; both bodies are then shapes.
  await page.selectOption('[aria-label="Kind of shape"]', { label: "Capsule along z" });
  await page.fill('[aria-label="Length of the axis"]', "3");
  await page.click("text=As the fixed body");
  await page.waitForFunction(() => window.colltrans.probe().state.parts.fixed.file === "capsule:0,0,-1.5,0,0,1.5,0.5" && window.colltrans.probe().answer);
  // An invalid shape is refused, and the previous body is restored.
  await page.selectOption('[aria-label="Kind of shape"]', { label: "Box" });
  await page.fill('[aria-label="Rounded by"]', "-1");
  await page.click("text=As the fixed body");
  await page.waitForSelector(".refused");
  assert.match(await page.textContent(".refused"), /radius/);
  await page.click("text=Leave it");
  await page.waitForFunction(() => window.colltrans.probe().answer);
  assert.equal((await probe(page, "state")).parts.fixed.file, "capsule:0,0,-1.5,0,0,1.5,0.5");
  // Back to a pair of files.
  await page.selectOption("#example", "plate");
  await page.waitForFunction(() => window.colltrans.probe().answer?.kind === "solid");
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

test("shapes between solids, their distance and their motion are answered; a search is refused", async () => {
  const page = await at.open("#m=sphere:2:convex&f=plate.off:solid&mp=0,0,9,0,0,0,1&d=0,0,-1&near=1", {}, READY);
  await page.waitForSelector("#near");
  const { kind, record } = await probe(page, "answer");
  assert.equal(kind, "solid");
  assert.equal(record.outcome, "blocked");
  await page.click("text=Verify");
  await page.waitForSelector(".verdict.yes");
  const { distance } = await probe(page, "near");
  const p = distance.pointOnMoving;
  assert.ok(Math.abs(Math.hypot(p[0], p[1], p[2] - 9) - 2) < 1e-9, "the nearest point is on the sphere");
  await page.click("#tab-motion");
  await page.waitForFunction(() => window.colltrans.probe().turning?.answer?.record);
  assert.equal(await page.evaluate(() => window.colltrans.probe().turning.answer.kind), "solid");
  await page.click("#tab-found");
  await page.waitForSelector("text=Only between convex polyhedra");
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

test("casts of shapes equal native ones bit for bit and match the schema", async () => {
  const page = await at.open("#example=ball", {}, READY);
  const pairs = [["sphere:0.5", "bracket.obj"], ["capsule:-1,0,0,1,0,0,0.25", "box:1,2,3,0.1"], ["box:1,2,3", "plate.off"]];
  const { random, turn } = draws(11n);
  const questions = [];
  for (const [moving, fixed] of pairs) {
    const take = fixed === "plate.off" ? "solid" : "convex";
    questions.push({ question: { do: "load", slot: "moving", name: moving, take: "convex" } });
    questions.push({ file: fixed.includes(":") ? undefined : fixed, question: { do: "load", slot: "fixed", name: fixed, take } });
    for (let k = 0; k < 60; k++) {
      const direction = [random(), random(), random()];
      const from = direction.map((x) => -8 * x + random());
      questions.push({ question: { do: "cast", moving_pose: [...from, ...turn()], fixed_pose: [0, 0, 0, ...turn()], direction } });
    }
  }
  const expected = nativeAnswers("all", questions.map(({ file, question }) => (file ? `${join(data, file)}\t` : "") + JSON.stringify(question)));
  const seen = await page.evaluate(async (questions) => {
    const { engine } = window.colltrans.probe();
    const texts = [];
    for (const { bytes, question } of questions) texts.push((await engine.ask(question, bytes && new Uint8Array(bytes).buffer)).text);
    return texts;
  }, questions.map(({ file, question }) => ({ question, bytes: file && [...readFileSync(join(data, file))] })));
  const outcomes = new Set();
  seen.forEach((text, k) => {
    // Points of a drawing may differ in the last bit, because sines do.
    const { do: asked } = questions[k].question;
    if (asked === "cast") assert.equal(text, expected[k]);
    for (const one of [text, expected[k]]) conform(`page_${asked}`, JSON.parse(one));
    if (asked === "cast") outcomes.add(`${JSON.parse(text).kind} ${JSON.parse(text).record.outcome}`);
  });
  for (const one of ["convex contact", "convex separated", "solid blocked"]) assert.ok(outcomes.has(one), [...outcomes].join());
  await page.context().close();
});
