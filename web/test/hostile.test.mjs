// The report of an assembly with names that try to be programs, opened as a file: none of them runs. Needs the
// example `report`.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { data, launch, program, watch } from "../browser.mjs";

const HOSTILE = [
  "</td></text></title></style></script><script>window.hit=1</script><img src=x onerror=window.hit=1>",
  "\"><svg onload=window.hit=1>' onmouseover='window.hit=1",
  "<!--<script>window.hit=1</script>-->\u2028window.hit=1//]]>",
  "<iframe srcdoc='<script>parent.hit=1</script>'>\u0000\u001b[31m",
  "javascript:window.hit=1",
];

test("names in a report are escaped", async () => {
  const folder = mkdtempSync(join(tmpdir(), "hostile-"));
  copyFileSync(join(data, "gearbox_small/bolt_0.off"), join(folder, "a.off"));
  const browser = await launch();
  try {
    for (const unit of HOSTILE) {
      const parts = HOSTILE.map((name, k) => ({ file: "a.off", name, translation: [0, 0, 50 * k] }));
      writeFileSync(join(folder, "m.json"), JSON.stringify({ unit, parts }));
      execFileSync(program("report"), ["0.1", join(folder, "report.html"), join(folder, "m.json")]);
      const page = watch(await browser.newPage({ viewport: { width: 1100, height: 900 } }));
      await page.goto(pathToFileURL(join(folder, "report.html")).href);
      await page.waitForSelector("#viewer canvas");
      // Including the descriptions of steps and of the part under the pointer.
      await page.locator('#viewer [aria-label="Steps of the plan"]').press("End");
      const box = await page.locator("#viewer canvas").boundingBox();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      assert.match(await page.textContent("#viewer output"), / along /);
      assert.equal(await page.evaluate(() => window.hit), undefined);
      assert.equal(await page.locator("img, iframe, [onload], [onerror], [onmouseover]").count(), 0);
      assert.equal(await page.locator("script").count(), 2, "the viewer and its data");
      // Every name is present literally.
      const text = await page.textContent("body");
      assert.ok(text.includes(unit.replace("\0", "\ufffd")) || text.includes(unit.replaceAll(/[\0\x1b]/g, "\ufffd")), unit);
      assert.equal(await page.title(), HOSTILE[0]);
      assert.deepEqual(page.complaints, []);
      await page.close();
    }
  } finally {
    await browser.close();
    rmSync(folder, { recursive: true });
  }
});
