// The search behind an answer, in a browser: its playback, and the paper's figures. Needs `npm run build`.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { site } from "../browser.mjs";

let at, page;
before(async () => {
  at = await site();
  page = await at.open("#example=bracket");
});
after(() => at?.close());

const probe = (page, of) => page.evaluate((of) => window.colltrans.probe().found?.[of], of);
const steps = (page) => page.locator('.found [aria-label="Steps"] button').count();

/** Selects an example and waits until it is shown. */
async function look(page, k, example) {
  await page.selectOption('[aria-label="Example of a search"]', String(k));
  await page.waitForFunction((name) => document.querySelector("#example").value === name, example);
  await page.waitForSelector(".found:not([aria-busy])");
}

test("tab loads when it is opened", async () => {
  assert.ok(!page.read.some((url) => /found/.test(url)));
  await page.click("#tab-found");
  await page.waitForSelector(".stack .pick");
  assert.ok(page.read.some((url) => url.endsWith("colltrans_found.wasm")));
  // The minimum of the drawn graph is close to the answer and not below it.
  const { least, t } = await page.evaluate(async () => {
    const { found: { engine, found }, answer, state } = window.colltrans.probe();
    const pair = { moving_pose: state.poses.moving, fixed_pose: state.poses.fixed, direction: state.direction };
    const levels = ([low, high]) => Array.from({ length: 60 }, (_, k) => low + ((k + 0.5) / 60) * (high - low));
    const { numbers } = await engine.ask({
      do: "levels", ...pair, moving_axis: found.axes[0], fixed_axis: found.axes[1],
      moving_levels: levels(found.ranges[0]), fixed_levels: levels(found.ranges[1]),
    });
    const values = [...new Float64Array(numbers, 0, 3600)].filter((x) => !Number.isNaN(x));
    return { least: Math.min(...values), t: answer.record.translation };
  });
  assert.ok(least >= t - 1e-9 && least < t + 0.5, `${least} ${t}`);
  assert.deepEqual(page.complaints, []);
});

test("first example plays more than ten steps while bounds converge", async () => {
  await look(page, 0, "thirteen");
  const count = await steps(page);
  assert.ok(count >= 10, `${count} steps`);
  const { found, moments } = await page.evaluate(() => window.colltrans.probe().found);
  assert.equal(found.steps.length, count);
  const unit = Math.hypot(-0.36, 0.01, -1);
  const t = await page.evaluate(() => window.colltrans.probe().answer.record.translation);
  let [low, high] = [-Infinity, Infinity];
  for (const { cut, solved, shifted, region } of found.steps) {
    assert.ok(region.length >= 3);
    if (solved) assert.ok(Math.abs(shifted / unit - t) < 1e-9, `${shifted / unit} ${t}`);
    if (!cut) continue;
    // Infinite values are sent as null.
    const [lower, upper] = [cut.lower ?? -Infinity, cut.upper ?? Infinity];
    assert.ok(lower >= low - 1e-12 && upper <= high + 1e-12 && lower <= t * unit + 1e-9 && upper >= t * unit - 1e-9, `${lower} ${upper} ${t * unit}`);
    [low, high] = [lower, upper];
  }
  assert.ok(found.steps.at(-1).solved);
  // Sections, contact, shift and cut of each step in this order, then the hand-over.
  const order = ["sections", "touch", "shift", "cut", "solved", "portal"];
  moments.slice(1).forEach((moment, k) => {
    const last = moments[k];
    const on = moment.step === undefined || moment.step === last.step;
    assert.ok(on ? order.indexOf(moment.kind) > order.indexOf(last.kind) || moment.kind === "portal" : moment.step === last.step + 1 && moment.kind === "sections");
  });
  await page.click('[aria-label="One on"]');
  const before = await probe(page, "at");
  await page.click(".play");
  await page.waitForFunction((at) => window.colltrans.probe().found.at > at + 0.5, before);
  await page.click(".play");
  assert.equal(await page.textContent(".play"), "Play");
  // The last text describes the hand-over.
  await page.locator('[aria-label="Where in the search"]').fill(String(moments.length));
  await page.waitForFunction(() => /^Hand-over/.test(document.querySelector(".player .now").textContent));
  assert.match(await page.textContent(".bounds-over-steps"), /upper .*, lower .*, gap /);
  assert.deepEqual(page.complaints, []);
});

test("graph follows the remaining region without overlapping labels", async () => {
  const boxes = () => page.$$eval(".stack svg > text", (all) => all.filter((text) => /^(\d{1,2}|q|N\(p\))$/.test(text.textContent) && !text.getAttribute("text-anchor")).map((text) => {
    const { left, right, top, bottom } = text.getBoundingClientRect();
    return [left, right, top + 3, bottom - 3];
  }));
  for (const step of [1, 6, 13]) {
    await page.locator('[aria-label="Steps"] button').nth(step - 1).click();
    await page.waitForFunction((k) => document.querySelector(`[aria-label="Steps"] button:nth-child(${k})`).getAttribute("aria-pressed") === "true", step);
    const all = await boxes();
    assert.ok(all.length > 0);
    all.forEach(([a, b, c, d], k) => all.slice(0, k).forEach(([e, f, g, h]) => assert.ok(b <= e + 1 || f <= a + 1 || d <= g + 1 || h <= c + 1, `step ${step}`)));
    for (const what of [".region", ".least"]) assert.equal(await page.locator(`.stack ${what}`).count(), 1, `${what} at step ${step}`);
  }
  const levels = () => page.$$eval(".stack svg > text", (all) => all.slice(-4).map((text) => text.textContent).join());
  const near = await levels();
  await page.click(".zoom input");
  await page.waitForFunction((near) => [...document.querySelectorAll(".stack svg > text")].slice(-4).map((text) => text.textContent).join() !== near, near);
  await page.click(".zoom input");
  assert.deepEqual(page.complaints, []);
});

test("each figure of the paper has an example with its section", async () => {
  const examples = { 3: "cubes", 4: "corner", 5: "beside", 7: "thirteen" };
  for (let figure = 1; figure <= 9; figure++) {
    await look(page, figure, examples[figure] ?? "cubes");
    await page.waitForFunction((n) => document.querySelector(".caption").textContent.startsWith(`The paper, figure ${n}, section II`), figure);
    const kind = { 3: "edges", 4: "vertex", 5: "separated" }[figure];
    if (!kind) continue;
    const shown = await page.evaluate(() => {
      const { found, moments, at } = window.colltrans.probe().found;
      return found.steps[moments[Math.ceil(at) - 1].step].touch;
    });
    assert.equal(shown, kind);
    assert.match(await page.textContent('[aria-label="Both sections in the shadow plane"]'), figure === 5 ? /never meet/ : /lowest common point/);
  }
  assert.equal(await steps(page), 2);
  assert.deepEqual(page.complaints, []);
});

test("neighbourhood search and motion from one solution to the next", async () => {
  const pose = () => page.evaluate(() => window.colltrans.probe().state.poses.moving.join());
  await look(page, 10, "thirteen");
  const start = await page.evaluate(() => window.colltrans.probe().state.poses.moving.join());
  await page.waitForSelector(".stack .neighbourhood", { state: "attached" });
  await page.waitForSelector("text=Play a motion");
  await page.waitForFunction(() => /^24 places: \d+ planar problems in N\(p\), \d+ from the centre/.test([...document.querySelectorAll(".found .proof")].map((p) => p.textContent).find((text) => /places:/.test(text)) ?? ""));
  const [, near, all] = /places: (\d+) planar problems in N\(p\), (\d+)/.exec(await page.textContent(".found"));
  assert.ok(Number(near) < Number(all), `${near} of ${all}`);
  assert.match(await pose(), /^3,1\.1,10,/);
  assert.ok(start.length);
  // The savings are reported for the bracket too after a small change of the direction.
  // Without a previous question there is no p, and no graph.
  await at.ask(page, "#example=bracket&tab=found", ['[aria-label="Where the search starts"]']);
  await page.selectOption('[aria-label="Where the search starts"]', "center");
  await page.click("#tab-answer");
  const t = await page.evaluate(() => window.colltrans.probe().answer.record.translation);
  await page.fill('[aria-label="Direction y"]', "0.105");
  await page.waitForFunction((t) => window.colltrans.probe().answer?.record.translation !== t, t);
  await page.click("#tab-found");
  await page.waitForSelector("text=a tracker starts from the region");
  const scratch = await steps(page);
  await page.selectOption('[aria-label="Where the search starts"]', "region");
  await page.waitForSelector(".stack .neighbourhood", { state: "attached" });
  const few = await steps(page);
  assert.ok(few >= 1 && few < scratch, `${few} of ${scratch}`);
  assert.match(await page.textContent(".found"), new RegExp(`solved ${few} planar problems?, from scratch ${scratch}: ${scratch - few} of ${scratch} are saved`));
  assert.deepEqual(page.complaints, []);
});

test("start and end of the algorithm are in the address and the command", async () => {
  await at.ask(page, "#example=thirteen");
  await page.click("#tab-answer");
  const planar = () => page.evaluate(() => window.colltrans.probe().answer.record.steps.planar_problems);
  assert.equal(await planar(), 13);
  await page.fill('[aria-label="Gap at which the algorithm ends"]', "0.05");
  await page.waitForFunction(() => window.colltrans.probe().answer.record.steps.planar_problems < 13);
  await page.selectOption('[aria-label="Where the algorithm starts"]', "ellipsoids");
  await page.waitForFunction(() => location.hash.includes("start=ellipsoids&until=0.05"));
  await page.waitForFunction(() => !window.colltrans.probe().answer.record.steps.planar_problems);
  await page.selectOption('[aria-label="Solver"]', "auto");
  await page.waitForFunction(() => document.querySelector('[aria-label="Where the algorithm starts"]').getBoundingClientRect().width === 0);
  assert.deepEqual(page.complaints, []);
});

test("phone layout fits the screen in both colour schemes", async () => {
  const phone = await at.open("#example=thirteen&tab=found", { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true, colorScheme: "dark" }, [".stack .pick"]);
  assert.ok(await phone.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  await phone.tap('[aria-label="One on"]');
  await phone.waitForFunction(() => window.colltrans.probe().found.at > 0);
  assert.deepEqual(phone.complaints, []);
  await phone.context().close();
});
