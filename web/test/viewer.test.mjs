// The viewer in the reports of an assembly, opened as a file. Needs the example `report`.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { boxes, data, isCut, launch, program, watch } from "../browser.mjs";

test("viewer shows the plan of a report", async () => {
  const folder = mkdtempSync(join(tmpdir(), "report-"));
  // Without the balls of its bearing, whose plan takes six times as long as that of all other parts.
  const names = readdirSync(join(data, "gearbox_small")).filter((name) => !name.startsWith("bearing_ball"));
  const parts = names.map((name) => join(data, "gearbox_small", name));
  execFileSync(program("report"), ["0.1", join(folder, "report.html"), ...parts]);
  const browser = await launch();
  try {
    const page = watch(await browser.newPage({ viewport: { width: 1100, height: 900 } }));
    await page.goto(pathToFileURL(join(folder, "report.html")).href);
    await page.waitForSelector("#viewer canvas");
    assert.match(await page.textContent("#viewer output"), /^12 parts, \d+ steps/);
    await page.click('#viewer [aria-label="Step on"]');
    await page.waitForFunction(() => document.querySelector("#viewer input").valueAsNumber === 1);
    assert.match(await page.textContent("#viewer output"), /^Step 1 of \d+: .+ along /);
    await page.locator('#viewer [aria-label="Steps of the plan"]').press("End");
    assert.equal(await isCut(page, "#viewer canvas"), false);
    // The part in the middle of the picture has a name.
    const box = await page.locator("#viewer canvas").boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForSelector("#viewer .name:not([hidden])");
    assert.ok((await page.textContent("#viewer .name")).length > 2);
    assert.deepEqual(page.complaints, []);
    assert.ok(page.read.every((url) => url.startsWith("file:") || url.startsWith("data:") || url.startsWith("blob:")), page.read.join());
  } finally {
    await browser.close();
    rmSync(folder, { recursive: true });
  }
});

test("a click in a report of an audit shows the pair and its way out", async () => {
  const folder = mkdtempSync(join(tmpdir(), "report-"));
  // The first two overlap by 0.5 along x, the others are 0.25 apart; the last one touches nothing.
  const parts = { left: [[0, 0, 0], [2, 2, 2]], middle: [[1.5, 0.25, 0.25], [4, 1.75, 1.75]], right: [[4.25, 0, 0], [6, 2, 2]], far: [[20, 0, 0], [22, 2, 2]] };
  for (const [name, ends] of Object.entries(parts)) writeFileSync(join(folder, `${name}.off`), boxes(ends));
  execFileSync(program("report"), ["0", join(folder, "clashes.html"), ...Object.keys(parts).map((name) => join(folder, `${name}.off`))]);
  const browser = await launch();
  try {
    const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
    await page.goto(pathToFileURL(join(folder, "clashes.html")).href);
    await page.waitForSelector("#viewer canvas");
    assert.equal(await page.locator("details.clash").count(), 2);
    assert.match(await page.textContent("#viewer output"), /^left and middle/);
    await page.locator('#viewer [aria-label="Shortest way out that was found"]').press("End");
    assert.equal(await page.textContent("#viewer output"), "Shortest way out that was found, of left");
    // The cut shows the material of both parts and of their common part, and follows its slider.
    const ways = page.locator("#viewer .cut input[type=range]");
    const colours = () => page.evaluate(() => {
      const source = document.querySelector("#viewer canvas");
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [source.width, source.height];
      const context = canvas.getContext("2d");
      context.drawImage(source, 0, 0);
      const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
      const near = (colour) => {
        let count = 0;
        for (let k = 0; k < data.length; k += 4) count += colour.every((c, i) => Math.abs(data[k + i] - c) < 4);
        return count;
      };
      return [[0x6f, 0x97, 0xd6], [0xd9, 0xcb, 0xb0], [0xb0, 0x16, 0x57]].map(near);
    });
    await page.locator('#viewer [aria-label="Shortest way out that was found"]').press("Home");
    assert.equal(await ways.isVisible(), false);
    await page.getByLabel("Cut", { exact: true }).check();
    await page.waitForFunction(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true)))));
    const cut = await colours();
    assert.ok(cut.every((count) => count > 1000), cut.join());
    await ways.press("End");
    await page.waitForFunction(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true)))));
    assert.notDeepEqual(await colours(), cut);
    await page.getByLabel("Cut", { exact: true }).uncheck();
    // The second finding has no way out, and the filter hides the first one.
    await page.click("details.clash >> nth=1 >> summary");
    assert.match(await page.textContent("#viewer output"), /^middle and right/);
    assert.equal(await page.locator('#viewer [aria-label="Shortest way out that was found"]').isDisabled(), true);
    assert.equal(await page.getByLabel("Cut", { exact: true }).isEnabled(), true);
    // A click on the first entry, which is open, shows its pair again.
    await page.click("details.clash >> nth=0 >> summary");
    assert.match(await page.textContent("#viewer output"), /^left and middle/);
    assert.equal(await page.locator("details.clash").first().getAttribute("open"), null);
    await page.fill(".filter input", "RIGHT");
    assert.deepEqual(await page.locator("details.clash:visible .names").allTextContents(), ["middle · right"]);
    await page.fill(".filter input", "");
    await page.selectOption(".filter select", "interfering");
    assert.deepEqual(await page.locator("details.clash:visible .names").allTextContents(), ["left · middle"]);
    assert.deepEqual(page.complaints, []);
    assert.ok(page.read.every((url) => url.startsWith("file:") || url.startsWith("data:") || url.startsWith("blob:")), page.read.join());
    // On a phone nothing is wider than the screen.
    await page.setViewportSize({ width: 400, height: 800 });
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 400);
  } finally {
    await browser.close();
    rmSync(folder, { recursive: true });
  }
});

test("a report of an audit without findings shows the parts, and its controls are off", async () => {
  const folder = mkdtempSync(join(tmpdir(), "report-"));
  const parts = { left: [[0, 0, 0], [2, 2, 2]], far: [[20, 0, 0], [22, 2, 2]] };
  for (const [name, ends] of Object.entries(parts)) writeFileSync(join(folder, `${name}.off`), boxes(ends));
  execFileSync(program("report"), ["0", join(folder, "clashes.html"), ...Object.keys(parts).map((name) => join(folder, `${name}.off`))]);
  const browser = await launch();
  try {
    const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
    await page.goto(pathToFileURL(join(folder, "clashes.html")).href);
    await page.waitForSelector("#viewer canvas");
    assert.match(await page.textContent("#viewer output"), /^No pair interferes, touches or is too near/);
    assert.ok(await page.locator("#viewer .bar > button, #viewer .bar > input").evaluateAll((all) => all.length > 0 && all.every(({ disabled }) => disabled)));
    assert.equal(await page.locator("#viewer .cut").isVisible(), false);
    assert.deepEqual(page.complaints, []);
  } finally {
    await browser.close();
    rmSync(folder, { recursive: true });
  }
});
