// Bodies that turn, in a browser, compared with the same code built natively. Needs `npm run build` and the example
// `native`.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { agreed, conform, draws, site } from "../browser.mjs";

let at, page;
before(async () => {
  at = await site();
  page = await at.open("#example=bracket");
});
after(() => at?.close());

const headline = () => page.textContent(".turning h2");
const outcome = (is) => page.waitForFunction((is) => {
  const { turning } = window.colltrans.probe();
  return turning?.answer?.record.outcome === is && !turning.asking;
}, is);
const probe = () => page.evaluate(() => {
  const { turning: { answer, screw, question }, state } = window.colltrans.probe();
  return { answer, screw, question, time: state.motion.time };
});
/** Returns the position of a handle on the screen, once the view is at rest. */
const grip = (name) => page.evaluate(async (name) => {
  const read = () => window.colltrans.probe().turning.grip(name);
  let last;
  for (let k = 0; k < 120; k++) {
    const next = read();
    if (k > 2 && String(next) === String(last)) break;
    last = next;
    await new Promise(requestAnimationFrame);
  }
  return read();
}, name);
/** Drags a handle by pixels. */
async function drag(name, by) {
  const [x, y] = await grip(name);
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let k = 1; k <= 5; k++) await page.mouse.move(x + (by[0] * k) / 5, y + (by[1] * k) / 5);
  await page.mouse.up();
}
async function example(name, is) {
  await page.selectOption('[aria-label="A motion to look at"]', name);
  await page.waitForFunction((name) => document.querySelector('[aria-label="A motion to look at"]').value === name && !document.querySelector(".turning[aria-busy]"), name);
  await outcome(is);
}

test("tab loads when it is opened and shows a hinge with its first contact", async () => {
  assert.ok(!page.read.some((url) => /turning|colltrans_motion|tabs/.test(url)));
  await page.click("#tab-motion");
  await outcome("contact");
  assert.ok(page.read.some((url) => url.endsWith("colltrans_motion.wasm")));
  assert.match(await headline(), /^Contact at [\d.]+°$/);
  const rows = await page.$$eval(".turning dt", (all) => all.map((dt) => dt.textContent));
  assert.deepEqual(rows, ["time", "proven", "angle", "normal n", "point", "moving", "fixed", "looked at"]);
  await page.waitForFunction(() => ["start", "first contact", "end"].every((text) => [...document.querySelectorAll(".marks button")].some((button) => button.textContent === text)));
  const labels = await page.$$eval(".labels span:not([hidden])", (all) => all.map((span) => span.textContent));
  assert.deepEqual(labels.sort(), ["120°", "axis", "n"]);
  // All handles are in the picture.
  const box = await page.locator("#view").boundingBox();
  for (const name of ["point", "axis", "angle"]) {
    const [x, y] = await page.evaluate((name) => window.colltrans.probe().turning.grip(name), name);
    assert.ok(x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height, `${name} ${x} ${y}`);
  }
  // The panel of casts is hidden, except for the bodies.
  assert.ok(!(await page.isVisible("#headline")) && (await page.isVisible('[aria-label="Choose a file for the moving body"]')));
  assert.deepEqual(page.complaints, []);
});

test("slider is the time, and the body is at the contact pose", async () => {
  await page.click(".marks button:text-is('first contact')");
  const { answer, time, screw } = await page.waitForFunction(() => window.colltrans.probe().state.motion.time > 0).then(probe);
  assert.equal(time, answer.record.time.lower);
  const shown = await page.textContent("#time output");
  assert.ok(Math.abs(Number(shown.replace("°", "")) - screw.angle * time) < 1e-3, shown);
  const drawn = await page.evaluate(() => {
    const { view } = window.colltrans.probe();
    const solid = view.extra.children.find(({ userData }) => userData.how === "solid");
    return { at: solid.matrix.elements.slice(12, 15), middle: solid.userData.body.middle, origin: view.frame.origin };
  });
  const [x, y, z, a, b, c, w] = answer.pose;
  const cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const t = cross([a, b, c], drawn.middle).map((s) => 2 * s);
  const turn = cross([a, b, c], t);
  const there = drawn.middle.map((m, k) => m + w * t[k] + turn[k] + [x, y, z][k] - drawn.origin[k]);
  there.forEach((s, k) => assert.ok(Math.abs(s - drawn.at[k]) < 1e-9, `${there} ${drawn.at}`));
});

test("proof is built and checked", async () => {
  await page.click(".turning button:text-is('Verify')");
  await page.waitForSelector(".turning .verdict.yes:has-text('it holds')");
  const { answer: { record: { time, planes } } } = await probe();
  const said = await page.textContent(".turning .verdict");
  assert.equal(said, `✓ it holds: ${planes} planes checked; nothing before ${time.lower}, contact by ${time.upper}`);
});

test("handles change the angle, the axis, its point and the rise", async () => {
  let last = (await probe()).screw;
  for (const [name, field, by] of [["angle", "angle", [0, -40]], ["axis", "axis", [30, 10]], ["point", "point", [-20, 25]]]) {
    await drag(name, by);
    await page.waitForFunction((last) => JSON.stringify(window.colltrans.probe().turning.screw) !== last, JSON.stringify(last));
    const { screw } = await probe();
    const changed = Object.keys(screw).filter((key) => JSON.stringify(screw[key]) !== JSON.stringify(last[key]));
    assert.deepEqual(changed, [field], name);
    last = screw;
  }
  await page.click(".turning button:text-is('Screw')");
  await page.waitForSelector('[aria-label="Rise"]');
  const { rise } = (await probe()).screw;
  assert.ok(rise > 0);
  await page.click("text='Fit'");
  await page.waitForFunction(() => window.colltrans.probe().turning.grip("rise"));
  const ends = [await grip("point"), await grip("rise")];
  // Further along the axis as it is shown.
  await drag("rise", [0, 1].map((k) => 0.3 * (ends[1][k] - ends[0][k])));
  await page.waitForFunction((rise) => window.colltrans.probe().turning.screw.rise > rise, rise);
  await page.click(".turning button:text-is('Hinge')");
  await page.waitForFunction(() => window.colltrans.probe().turning.screw.rise === 0);
  // The values are in the address, which restores the question.
  const { question } = await probe();
  await page.waitForTimeout(400); // The address follows after a quarter of a second.
  assert.match(new URL(page.url()).hash, /tab=motion.*screw=/);
  const other = await at.open(new URL(page.url()).hash, {}, [".turning h2"]);
  await other.waitForFunction(() => window.colltrans.probe().turning?.answer);
  assert.deepEqual(await other.evaluate(() => window.colltrans.probe().turning.question), question);
  await other.context().close();
  assert.deepEqual(page.complaints, []);
});

test("bolt screws out of its plate only along its axis, and gaps are respected", async () => {
  await example("bolt", "free");
  assert.equal(await headline(), "The whole motion is free");
  await page.click(".turning button:text-is('Verify')");
  await page.waitForSelector(".turning .verdict:has-text('nothing on the whole way')");
  await example("askew", "contact");
  assert.match(await headline(), /^Contact at [\d.]+°, [\d.]+ along the axis$/);
  await page.click(".turning button:text-is('Verify')");
  await page.waitForSelector(".turning .verdict:has-text('contact by')");
  await example("shaft", "contact");
  await example("hinge", "contact");
  await page.waitForTimeout(400); // The last answer, also a contact, stays until the next one.
  await page.waitForFunction(() => {
    const { asking, answer } = window.colltrans.probe().turning;
    return !asking && answer?.record.time?.lower;
  });
  const before = (await probe()).answer.record.time.lower;
  await page.fill('[aria-label="Minimum gap"]', "1");
  await page.waitForFunction((before) => window.colltrans.probe().turning.answer?.record.time?.lower < before, before);
  await page.fill('[aria-label="Minimum gap"]', "0");
  // Overlapping at the start; free in the opposite direction.
  await page.fill('[aria-label="Angle"]', "-20");
  await outcome("free");
  assert.deepEqual(page.complaints, []);
});

test("either body moves, and a slide is a motion", async () => {
  await example("hinge", "contact");
  const moved = () => page.evaluate(() => {
    const { view } = window.colltrans.probe();
    const solid = view.extra.children.find(({ userData }) => userData.how === "solid");
    return solid.userData.body === view.bodyOf("fixed") ? "fixed" : "moving";
  });
  assert.equal(await moved(), "moving");
  const { answer, screw } = await probe();
  await page.click(".turning button:text-is('The fixed one')");
  // Relative to the other body, it turns in the opposite direction.
  await page.fill('[aria-label="Angle"]', String(-screw.angle));
  await page.waitForFunction((last) => {
    const { turning } = window.colltrans.probe();
    return !turning.asking && turning.question.fixed_motion?.turn.angle < 0 && turning.answer?.record.time?.lower && turning.answer.record.time.lower !== last;
  }, answer.record.time.lower);
  const other = await probe();
  assert.ok(Math.abs(other.answer.record.time.lower - answer.record.time.lower) < 1e-9, `${other.answer.record.time.lower}`);
  assert.equal(await moved(), "fixed");
  await page.waitForTimeout(400);
  assert.match(new URL(page.url()).hash, /moves=fixed/);
  assert.deepEqual(await page.$$eval(".body small:first-of-type", (said) => said.map((one) => one.textContent.split(";")[0])), ["stays", "moves"]);
  await page.click(".turning button:text-is('The moving body')");
  await page.click(".turning button:text-is('Slide')");
  await page.waitForFunction(() => window.colltrans.probe().turning.screw.angle === 0 && !document.querySelector(".turning[aria-busy]"));
  assert.ok(!(await page.isVisible('[aria-label="Angle"]')) && (await page.isVisible('[aria-label="Rise"]')));
  assert.equal(await grip("angle"), undefined);
  await page.click(".turning button:text-is('Hinge')");
  await page.waitForFunction(() => window.colltrans.probe().turning.screw.angle === 90);
  assert.deepEqual(page.complaints, []);
});

test("invalid motions are reported", async () => {
  const said = (text) => page.waitForFunction((text) => document.querySelector(".turning .said.care")?.textContent.includes(text), text);
  await page.fill('[aria-label="Angle"]', "1e9");
  await said("radians");
  await page.fill('[aria-label="Angle"]', "90");
  for (const letter of ["x", "y", "z"]) await page.fill(`[aria-label="Axis ${letter}"]`, "0");
  await said("axis");
  await page.click(".turning .row button:text-is('z')");
  await page.waitForFunction(() => window.colltrans.probe().turning.answer);
  assert.deepEqual(page.complaints, []);
});

test("casts are unchanged after a return to their tab", async () => {
  await page.click("#tab-answer");
  await page.waitForFunction(() => document.querySelector("#headline") && !document.querySelector(".marks")?.textContent.includes("end"));
  assert.equal(await page.evaluate(() => window.colltrans.probe().view.extra.children.length), 0);
  assert.ok(await page.isVisible("#headline"));
  // Labels are placed when the next frame is drawn.
  await page.waitForFunction(() => {
    const labels = [...document.querySelectorAll(".labels span:not([hidden])")].map((span) => span.textContent);
    return labels.includes("d") && !labels.some((label) => label.includes("axis") || label.includes("°"));
  });
});

test("phone layout shows everything", async () => {
  const phone = await at.open("#example=bracket&tab=motion", { viewport: { width: 390, height: 844 }, hasTouch: true, colorScheme: "dark" }, [".turning h2"]);
  await phone.waitForFunction(() => window.colltrans.probe().turning?.answer);
  const wide = await phone.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `${wide}`);
  assert.deepEqual(phone.complaints, []);
  await phone.context().close();
});

test("motion answers equal native answers and match the schema", async () => {
  const pairs = [
    ["dodecahedron.off", "convex", "bracket.obj", "convex", 5],
    ["bolt.stl", "solid", "plate.off", "solid", 7],
    ["dodecahedron.off", "convex", "plate.off", "solid", 8],
  ];
  const { random, turn } = draws(11n);
  const questions = [];
  for (const [moving, takeMoving, fixed, takeFixed, far] of pairs) {
    questions.push({ file: moving, question: { do: "place", slot: "moving", name: moving, take: takeMoving } });
    questions.push({ file: fixed, question: { do: "place", slot: "fixed", name: fixed, take: takeFixed } });
    for (let k = 0; k < 30; k++) {
      const at = () => [far * random(), far * random(), far * random()];
      const axis = { point: at(), axis: [random(), random(), random()], angle: 3 * random() };
      const motion = k % 2 ? { turn: axis } : { screw: { ...axis, rise: far * random() } };
      const asked = { [k % 4 ? "moving_motion" : "fixed_motion"]: motion, moving_pose: [...at(), ...turn()], fixed_pose: [0, 0, 0, ...turn()], minGap: k % 5 ? 0 : 0.25 };
      questions.push({ question: { do: "motion", ...asked } });
      if (k % 3 === 0) questions.push({ question: { do: "prove", ...asked } });
    }
  }
  const seen = await agreed(page, "motion", questions);
  const outcomes = new Set();
  seen.forEach((text, k) => {
    const told = JSON.parse(text);
    conform(`page_${questions[k].question.do}`, told);
    if (told.record) outcomes.add(told.record.outcome);
    else if (questions[k].question.do === "prove") assert.equal(told.holds, true, text);
  });
  assert.deepEqual([...outcomes].sort(), ["contact", "free", "overlapping"]);
});
