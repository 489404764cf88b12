// Everything that a pointer does works with keys, and the focus stays where it is.

import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { join } from "node:path";
import { after, afterEach, before, test } from "node:test";
import { data, site } from "../browser.mjs";

const gearbox = join(data, "gearbox_small");

let at, page;
before(async () => {
  at = await site();
  page = await at.open();
});
after(() => at?.close());
afterEach(() => assert.deepEqual(page.complaints, []));

/** Returns the name of the focused element. */
const focused = () => page.evaluate(() => {
  const { activeElement: e } = document;
  return e?.getAttribute("aria-label") ?? (e?.id || e?.textContent?.trim()) ?? "";
});
const probed = (what) => page.evaluate((what) => {
  const { state, answer, view } = window.colltrans.probe();
  return { t: state.t, d: state.direction, first: answer?.record.translation, eye: view.camera.position.toArray(), tab: state.tab }[what];
}, what);

test("focus moves over the page in reading order", async () => {
  const seen = [];
  for (let k = 0; k < 40; k++) {
    await page.keyboard.press("Tab");
    seen.push(await focused());
    const outlined = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle !== "none");
    assert.ok(outlined, `${seen.at(-1)} has no outline`);
  }
  const order = [
    "example", "tab-answer", "Light or dark", /^The two bodies/, "Turn view", "Move", "Rotate", "Fit", "Along d", "Distance", "Play", "start", "first contact",
    "last contact", /^Where the moving body is shown/, "Proof", "Verify", "Bodies", /^Choose a file for the moving/, /^Choose a file for the fixed/,
    "A sphere, capsule or box", "Question", "Direction x", "Direction y", "Direction z", "+x",
  ];
  order.forEach((name, k) => assert.match(seen[k], name instanceof RegExp ? name : new RegExp(`^${name.replace("+", "\\+")}$`), `${k}: ${seen.join(", ")}`));
  // Arrow keys reach the other tabs.
  assert.ok(!seen.includes("tab-found"));
});

test("arrow keys change numbers, with Shift by ten times as much", async () => {
  await at.ask(page);
  const field = page.locator('[aria-label="Direction x"]');
  await field.focus();
  for (const [key, value] of [["ArrowUp", -0.29], ["ArrowDown", -0.3], ["Shift+ArrowUp", -0.2], ["Shift+ArrowDown", -0.3], ["ArrowDown", -0.31]]) {
    await page.keyboard.press(key);
    assert.equal(Number(await field.inputValue()), value);
    assert.equal((await probed("d"))[0], value);
  }
  await page.waitForFunction(() => Math.abs(window.colltrans.probe().answer.record.translation - 4.31674) > 1e-3);
  await page.locator("button:text-is('turn round')").press("Enter");
  assert.deepEqual(await probed("d"), [0.31, -0.1, 1]);
  await page.selectOption('[aria-label="Solver"]', "cta");
  await page.waitForFunction(() => window.colltrans.probe().answer?.record.solver === "cta");
});

test("the way: its slider, its marks, playing", async () => {
  await at.ask(page);
  const first = await probed("first");
  const slider = page.locator('[aria-label^="Where the moving body is shown"]');
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  const t = await probed("t");
  assert.ok(t > 0 && t < first / 10, `${t}`);
  await page.keyboard.press("End");
  assert.ok((await probed("t")) > first);
  await page.keyboard.press("Home");
  assert.equal(await probed("t"), 0);
  for (const key of ["Enter", "Space"]) {
    await page.locator(".marks button:text-is('first contact')").focus();
    await page.keyboard.press(key);
    await page.waitForFunction((t) => window.colltrans.probe().state.t === t, first);
    await page.waitForFunction(() => document.activeElement?.textContent === "first contact");
    await page.locator(".marks button:text-is('start')").press(key);
    await page.waitForFunction(() => window.colltrans.probe().state.t === 0);
  }
  await page.focus('[aria-label="Play"]');
  await page.keyboard.press("Space");
  await page.waitForFunction(() => window.colltrans.probe().state.t > 0.1);
  await page.keyboard.press("Space");
  const stopped = await probed("t");
  await page.waitForTimeout(200);
  assert.equal(await probed("t"), stopped);
});

test("arrow keys move and turn the view, Escape hides the handles", async () => {
  await at.ask(page);
  await page.focus("#view canvas");
  const eyes = [await probed("eye")];
  for (const key of ["ArrowLeft", "Shift+ArrowLeft", "Shift+ArrowUp"]) {
    await page.keyboard.press(key);
    eyes.push(await probed("eye"));
    assert.notDeepEqual(eyes.at(-1), eyes.at(-2), key);
  }
  await page.locator("#tools button:text-is('Fit')").press("Enter");
  assert.ok((await probed("eye")).every((x, k) => Math.abs(x - eyes[0][k]) < 1e-9));
  await page.locator("#tools button:text-is('Rotate')").press("Enter");
  assert.equal(await page.locator("#tools [aria-pressed=true]").textContent(), "Rotate");
  await page.locator("#tools button:text-is('moving')").press("Enter");
  assert.equal(await focused(), "fixed");
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("#tools [aria-pressed=true]").textContent(), "Turn view");
  // The drop zone covers the page until the drop or its cancellation.
  await page.evaluate(() => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File(["x"], "x.off"));
    window.dispatchEvent(new DragEvent("dragenter", { dataTransfer }));
  });
  await page.waitForSelector("#drop:not([hidden])");
  await page.keyboard.press("Escape");
  await page.waitForSelector("#drop", { state: "hidden" });
});

test("cards and buttons", async () => {
  await at.ask(page);
  await page.focus("button:text-is('Verify')");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".verdict.yes");
  assert.equal(await focused(), "Verify");
  await page.focus("summary:has-text('Share')");
  await page.keyboard.press("Enter");
  await page.locator("button:text-is('Copy as Rust')").waitFor();
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator("button:text-is('Save the view (PNG)')").press("Space")]);
  assert.equal(download.suggestedFilename(), "contact.png");
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.locator('[aria-label="Choose a file for the fixed body"]').press("Enter")]);
  await chooser.setFiles({ name: "bad.off", mimeType: "", buffer: Buffer.from("OFF\n1 0 0\n0 zero 0\n") });
  await page.locator("button:text-is('Leave it')").press("Enter");
  await page.waitForSelector(".refused", { state: "detached" });
  await page.focus("#theme");
  await page.keyboard.press("Enter");
  assert.equal(await page.getAttribute("html", "data-theme"), "dark");
});

test("steps and graph of a search keep the focus", async () => {
  await page.context().close();
  page = await at.open("#tab=found", {}, [".stack .pick", ".steps button"]);
  const step = page.locator(".found .steps").first().locator("button").nth(1);
  await step.focus();
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.querySelector(".found .steps button:nth-child(2)").getAttribute("aria-pressed") === "true");
  assert.equal(await focused(), "2");
  // The first step is not in the remaining region.
  await page.uncheck(".zoom input");
  await page.locator('.stack [aria-label="step 1"]').focus();
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.querySelector(".found .steps button").getAttribute("aria-pressed") === "true");
});

test("arrow keys, Home and End switch tabs", async () => {
  await at.ask(page);
  await page.focus("#tab-answer");
  for (const [key, tab] of [["ArrowRight", "motion"], ["ArrowRight", "found"], ["Home", "answer"], ["ArrowLeft", "assembly"], ["ArrowRight", "answer"], ["End", "assembly"], ["ArrowLeft", "found"]]) {
    await page.keyboard.press(key);
    await page.waitForSelector(`#tab-${tab}[aria-selected=true]`);
    assert.equal(await focused(), `tab-${tab}`);
    assert.equal(await page.locator("[role=tab][tabindex='0']").count(), 1);
  }
});

test("assemblies: parts, the sphere, the steps", async () => {
  await page.click("#tab-assembly");
  // Without the balls of its bearing, whose plan takes six times as long as that of all other parts.
  const names = readdirSync(gearbox).filter((name) => !name.startsWith("bearing_ball"));
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.click("text=Choose files…")]);
  await chooser.setFiles(names.map((name) => join(gearbox, name)));
  await page.waitForFunction((count) => {
    const { facts, plan } = window.colltrans.probe().assembly;
    return facts?.parts.length === count && plan;
  }, names.length);
  await page.waitForSelector(".assembly-panel ol li");
  const part = page.locator(".part", { has: page.locator("strong:text-is('bolt_0')") });
  await part.focus();
  await page.keyboard.press("Enter");
  await page.waitForSelector(".part[aria-pressed=true]");
  assert.match(await focused(), /^bolt_0/);
  await page.waitForSelector(".sphere");
  await page.focus(".sphere");
  const way = () => page.evaluate(() => window.colltrans.probe().state.assembly.direction.join());
  for (const key of ["ArrowRight", "ArrowRight", "ArrowUp", "Shift+ArrowLeft", "ArrowDown"]) {
    const old = await way();
    await page.keyboard.press(key);
    await page.waitForFunction((old) => window.colltrans.probe().state.assembly.direction.join() !== old, old);
    await page.waitForFunction(() => document.activeElement?.classList.contains("sphere"));
  }
  await page.focus('[aria-label="Step on"]');
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => window.colltrans.probe().assembly.t === 1);
  await page.focus('[aria-label="Steps of the plan"]');
  await page.keyboard.press("End");
  assert.match(await page.textContent(".assembly-stage output"), /^Step (\d+) of \1:/);
  // A row is a stage, and jumps to its end.
  await page.focus(".assembly-panel ol button");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => {
    const { t, plan } = window.colltrans.probe().assembly;
    return t === plan.stages[0].steps[1] + 1;
  });
});
