// The distance of the bodies at their poses in a browser. Needs `npm run build`. The tests of the npm package, which
// computes it, compare answers with native ones.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { site } from "../browser.mjs";

let at, page;
before(async () => {
  at = await site();
  page = await at.open();
});
after(() => at?.close());

const near = () => page.evaluate(() => window.colltrans.probe().near);
const labels = () => page.$$eval(".labels span:not([hidden])", (all) => all.map((span) => span.textContent));

test("distance is loaded on demand, described, drawn and removed", async () => {
  assert.ok(!page.read.some((url) => url.endsWith("bodies.wasm")));
  await page.click("text='Distance'");
  await page.waitForSelector("#near");
  assert.equal(await page.textContent("#near"), "At their poses they are 3.96811 apart.");
  await page.waitForFunction(() => [...document.querySelectorAll(".labels span")].some((span) => span.textContent === "3.96811"));
  const rows = await page.$$eval("dt", (all) => all.map((dt) => dt.textContent));
  assert.deepEqual(rows.slice(0, 4), ["distance now", "proven", "moving, nearest", "fixed, nearest"]);
  await page.waitForFunction(() => location.hash.includes("near=1"));
  await page.click("text='Distance'");
  await page.waitForFunction(() => !document.querySelector("#near"));
  assert.ok(!(await labels()).includes("3.96811"));
  assert.deepEqual(page.complaints, []);
});

test("distance follows the bodies into an overlap", async () => {
  await page.click("text='Distance'");
  await page.waitForSelector("#near");
  await page.fill('[aria-label="moving position z"]', "12.5");
  await page.waitForFunction(() => window.colltrans.probe().near?.distance.upper > 6);
  await page.fill('[aria-label="moving position z"]', "4");
  await page.fill('[aria-label="moving position x"]', "2");
  await page.waitForFunction(() => window.colltrans.probe().near?.depth?.overlaps);
  assert.match(await page.textContent("#near"), /^At their poses they overlap: the shortest way out is [\d.]+ long\.$/);
  await page.waitForFunction(() => [...document.querySelectorAll(".labels span")].some((span) => /^depth /.test(span.textContent)));
  // Another body of another kind.
  await page.selectOption("#example", "shaft");
  await page.waitForFunction(() => window.colltrans.probe().answer?.kind === "solid" && window.colltrans.probe().near?.distance.meets);
  assert.deepEqual(page.complaints, []);
});
