// The assembly tab in a browser, compared with the same code built natively and with results by hand.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { answers, boxes, conform, data, drop, isCut, launchPlain, site, watch } from "../browser.mjs";

const gearbox = join(data, "gearbox_small");

let at, page;
before(async () => {
  at = await site();
  page = await opened();
});
after(() => at?.close());

const opened = (hash = "", options = {}) => at.open(`#tab=assembly${hash}`, options, ["#assembly-headline"]);

const probe = (page) => page.evaluate(() => {
  const { facts, fit, along, plan, tip, t, busy, error } = window.colltrans.probe().assembly;
  return { facts, fit, along, plan, tip, t, busy, error };
});
const planned = (page) => page.waitForSelector(".assembly-panel ol li");

async function choose(page, files) {
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.click("text=Choose files…")]);
  await chooser.setFiles(files);
}

test("files are chosen, rejected and dropped while frames continue", async () => {
  await choose(page, [{ name: "bad.off", mimeType: "", buffer: Buffer.from("OFF\n1 0 0\n0 zero 0\n") }]);
  await page.waitForSelector(".assembly-panel [role=alert]");
  assert.match(await page.textContent(".assembly-panel [role=alert]"), /^bad\.off: line 3/);
  await choose(page, [{ name: "bad.glb", mimeType: "", buffer: Buffer.from("glTF, but no more") }]);
  await page.waitForFunction(() => /bad\.glb: glTF/.test(document.querySelector(".assembly-panel [role=alert]")?.textContent));
  await choose(page, ["housing.off", "shaft.off"].map((name) => join(gearbox, name)));
  await page.waitForFunction(() => window.colltrans.probe().assembly.facts?.parts.length === 2 && window.colltrans.probe().assembly.fit);
  await page.waitForSelector("text=1 of 2 parts come out along d");
  // Frames continue during slow computations.
  await page.evaluate(() => {
    const { probe } = window.colltrans;
    window.drawn = 0;
    const frame = () => {
      const { facts, fit, plan } = probe().assembly;
      if (facts?.parts.length === 16 && fit && plan) return;
      window.drawn++;
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  });
  await page.click("button:text-is('Small gearbox')");
  await page.waitForFunction(() => {
    const { facts, plan } = window.colltrans.probe().assembly;
    return facts?.parts.length === 16 && plan;
  });
  await planned(page);
  const frames = await page.evaluate(() => window.drawn);
  assert.ok(frames > 20, `${frames} frames`);
  assert.deepEqual(page.complaints, []);
});

test("gearbox plan, slider and answers equal native answers", async () => {
  assert.match(await page.textContent("#assembly-headline"), /^4 of 16 parts come out along d$/);
  await planned(page);
  const { facts, plan, fit } = await probe(page);
  assert.equal(facts.parts.length, 16);
  assert.equal(fit.tolerance, 0.1);
  // Straight moves do not take a ball bearing apart.
  const stuck = plan.stuck.flatMap(({ parts }) => parts);
  assert.ok(stuck.length > 0 && stuck.every((name) => name.startsWith("bearing")), stuck.join());
  await page.click('[aria-label="Step on"]');
  await page.waitForFunction(() => window.colltrans.probe().assembly.t === 1);
  assert.match(await page.textContent(".assembly-stage output"), /^Step 1 of \d+: bolt_0 along \+z/);
  await page.locator('[aria-label="Steps of the plan"]').press("End");
  assert.match(await page.textContent(".assembly-stage output"), new RegExp(`^Step ${plan.plan.length} of`));
  const [report] = await Promise.all([page.waitForEvent("download"), page.click("text=Download report.html")]);
  assert.equal(report.suggestedFilename(), "report.html");
  const sheets = (await readFile(await report.path(), "utf8")).match(/class="sheet step"/g);
  assert.equal(sheets.length, plan.stages.length);
  assert.equal(await isCut(page, ".assembly-view canvas"), false);
  // The native answers to the same questions: those that the page has sent, and two more.
  const files = facts.parts.map(({ name }) => `${name}.off`);
  const more = [[0.3, -0.2, 1], [0, 0, -1]].map((direction) => ({ do: "along", direction }));
  const questions = [
    ...files.map((name) => `${join(gearbox, name)}\t${JSON.stringify({ do: "add", name })}`),
    ...[{ do: "parts" }, { do: "fit", tolerance: 0.1 }, { do: "plan" }, ...more].map((q) => JSON.stringify(q)),
  ];
  const [, nativeFit, nativePlan, ...native] = answers("assembly", questions).slice(files.length);
  // Strictly equal numbers have the same bits.
  assert.deepStrictEqual([fit, plan], [nativeFit, nativePlan].map((text) => JSON.parse(text)));
  const told = await page.evaluate(async (more) => {
    const { engine } = window.colltrans.probe().assembly;
    const texts = [];
    for (const question of more) texts.push((await engine.ask(question)).text);
    return texts;
  }, more);
  assert.deepStrictEqual(told, native);
  assert.deepEqual(page.complaints, []);
});

test("arrow, part and map can be dragged, picked and clicked", async () => {
  await planned(page);
  await page.click("button:text-is('Assembled')");
  const [x, y] = (await probe(page)).tip;
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 90, y + 60, { steps: 6 });
  await page.mouse.up();
  await page.waitForFunction(() => document.querySelector("#assembly-headline")?.textContent === "No part comes out alone along d");
  const direction = await page.inputValue('[aria-label="Direction x of the assembly"]');
  assert.notEqual(Number(direction), 0);
  await page.click(".part:has-text('bolt_2')");
  assert.match(await page.textContent(".part:has-text('bolt_2') small"), /^Blocked by: .*cover/);
  await page.waitForSelector(".sphere");
  assert.match(await page.textContent(".assembly-panel"), /bolt_2 is free only in 1 single direction/);
  // The centre of the sphere points to the eye; the button is the tight fit.
  await page.click(".sphere");
  await page.waitForFunction((old) => document.querySelector('[aria-label="Direction x of the assembly"]').value !== old, direction);
  const looked = (await page.evaluate(() => window.colltrans.probe().state.assembly.direction));
  assert.ok(looked[2] > 0 && looked[1] < 0, looked.join());
  await page.click(".assembly-panel button:text-is('+z') >> nth=-1");
  await page.waitForFunction(() => /^4 of 16/.test(document.querySelector("#assembly-headline")?.textContent));
  await page.locator(".sphere").focus();
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => window.colltrans.probe().state.assembly.direction[2] < 1);
  // The address restores the state.
  await page.waitForFunction(() => {
    const fields = new URLSearchParams(location.hash.slice(1));
    return fields.has("apart") && fields.get("ad") === window.colltrans.probe().state.assembly.direction.join(",");
  });
  const again = await opened(new URL(page.url()).hash.replace(/^#/, "&").replace("&tab=assembly", ""));
  await again.waitForFunction((along) => JSON.stringify(window.colltrans.probe().assembly.along) === along, JSON.stringify((await probe(page)).along));
  assert.deepEqual([...page.complaints, ...again.complaints], []);
  await again.context().close();
});

test("initial direction frees most parts, and overlaps are reported first", async () => {
  const page = await opened();
  // A box that is open along y, and a cube in it.
  const tray = boxes([[0, 0, 0], [6, 6, 1]], [[0, 0, 5], [6, 6, 6]], [[0, 0, 1], [1, 6, 5]], [[5, 0, 1], [6, 6, 5]], [[1, 0, 1], [5, 1, 5]]);
  await drop(page, ".assembly-stage", { "tray.off": tray, "cube.off": boxes([[2, 2, 2], [4, 4, 4]]) });
  await page.waitForFunction(() => window.colltrans.probe().assembly.facts?.parts.length === 2 && window.colltrans.probe().assembly.along);
  assert.deepEqual(await page.evaluate(() => window.colltrans.probe().state.assembly.direction), [0, 1, 0]);
  assert.equal(await page.textContent("#assembly-headline"), "1 of 2 parts come out along d");
  assert.equal(await page.locator("#assembly-overlaps").count(), 0);
  assert.equal(await page.locator(".assembly-panel .said.free").count(), 1);
  // Upwards they hold each other, and the two together are the whole assembly.
  await page.click(".assembly-panel button:text-is('+z') >> nth=-1");
  await page.waitForSelector("#assembly-headline:text-is('No part comes out alone along d')");
  assert.match(await page.textContent(".assembly-panel .said"), /Every part is blocked/);
  assert.equal(await page.locator(".assembly-panel .said.stop").count(), 1);
  // Overlapping parts are reported first, as a problem.
  await drop(page, ".assembly-stage", { "tray.off": tray, "cube.off": boxes([[2, 2, 0.75], [4, 4, 4]]) });
  await page.waitForSelector("#assembly-overlaps");
  assert.match(await page.textContent("#assembly-overlaps"), /^1 pair overlaps with this tolerance, and moves as one: cube and tray/);
  assert.equal(await page.locator(".assembly-panel .said.care").count(), 1);
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

test("clashes are listed, shown and saved", async () => {
  const page = await opened();
  await drop(page, ".assembly-stage", { "a.off": boxes([[0, 0, 0], [2, 2, 2]]), "b.off": boxes([[1.5, 0.25, 0.25], [4, 1.75, 1.75]]), "c.off": boxes([[4.25, 0, 0], [6, 2, 2]]) });
  await page.waitForFunction(() => window.colltrans.probe().assembly.facts?.parts.length === 3 && window.colltrans.probe().assembly.plan);
  await page.fill('[aria-label="Clearance"]', "1");
  await page.click("text=Find clashes");
  await page.waitForSelector("#clashes-found");
  assert.match(await page.textContent("#clashes-found"), /^2 pairs violate their clearance: 1 interfering, 1 nearer than the clearance/);
  const told = await page.evaluate(() => window.colltrans.probe().assembly.audit);
  conform("page_audit", told);
  assert.deepEqual(told.views[0].parts, [0, 1]);
  // The deepest pair is shown at once, with its way out.
  assert.match(await page.textContent(".assembly-stage output"), /^a and b;/);
  await page.locator('[aria-label="Shortest way out that was found"]').press("End");
  assert.match(await page.textContent(".assembly-stage output"), /^Shortest way out that was found, of a/);
  await page.getByLabel("Cut", { exact: true }).check();
  await page.click(".part:has-text('b · c')");
  assert.match(await page.textContent(".assembly-stage output"), /^b and c;/);
  await page.locator('[aria-label="Place of the cut"]').press("End");
  const [report] = await Promise.all([page.waitForEvent("download"), page.click("text=Download clashes.html")]);
  assert.equal((await readFile(await report.path(), "utf8")).match(/<details class="clash"/g).length, 2);
  // A second click returns to the plan.
  await page.click(".part:has-text('b · c')");
  assert.match(await page.textContent(".assembly-stage output"), /^3 parts, \d+ steps/);
  assert.equal(await page.getByLabel("Cut", { exact: true }).isVisible(), false);
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

test("on a phone, and without WebGL", async () => {
  // A part that does not exist is not waited for.
  const page = await opened("&apart=99", { viewport: { width: 360, height: 640 }, hasTouch: true });
  await page.waitForSelector(".assembly-panel :text('Pick a part')");
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 360);
  await page.tap(".part:has-text('cover')");
  await page.waitForSelector(".part[aria-pressed=true]");
  assert.deepEqual(page.complaints, []);
  await page.context().close();
  const without = await launchPlain();
  const plain = watch(await without.newPage());
  await plain.goto(`${at.base}#tab=assembly`);
  await plain.waitForSelector("#assembly-headline");
  await choose(plain, ["housing.off", "shaft.off"].map((name) => join(gearbox, name)));
  await plain.waitForSelector("text=1 of 2 parts come out along d");
  await planned(plain);
  assert.match(await plain.textContent(".assembly-view"), /WebGL 2/);
  await without.close();
});
