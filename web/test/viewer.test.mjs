// The viewer in an assembly's report, opened as a file. Needs the example `report`.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { data, isCut, launch, program, watch } from "../browser.mjs";

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
