// Files as large as scans, and files that are too large: the page stays responsive, shows its progress, and answers.

import assert from "node:assert/strict";
import { closeSync, ftruncateSync, mkdtempSync, openSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { site } from "../browser.mjs";

/** COLLTRANS_FACETS=1000000 takes longer with the same steps. */
const FACETS = Number(process.env.COLLTRANS_FACETS ?? 200_000);

let at, page, folder;
before(async () => {
  at = await site();
  page = await at.open();
  folder = mkdtempSync(join(tmpdir(), "large-"));
});
after(async () => {
  await at?.close();
  if (folder) rmSync(folder, { recursive: true });
});

/** Builds a binary STL file of a closed ball with `waves` around it and a number of facets. */
function ball(facets, waves) {
  const around = 2 * Math.round(Math.sqrt(facets) / 2);
  const rings = Math.round(facets / 2 / around) + 1;
  const bytes = Buffer.alloc(84 + 50 * 2 * around * (rings - 1));
  const point = (i, j) => {
    const [theta, phi] = [(Math.PI * i) / rings, (2 * Math.PI * (j % around)) / around];
    const r = 1 + (waves ? 0.15 * Math.sin(theta) * Math.cos(waves * phi) : 0);
    if (i === 0 || i === rings) return [0, 0, i ? -1 : 1];
    return [r * Math.sin(theta) * Math.cos(phi), r * Math.sin(theta) * Math.sin(phi), r * Math.cos(theta)];
  };
  let count = 0;
  const facet = (...corners) => {
    corners.flat().forEach((x, k) => bytes.writeFloatLE(x, 84 + 50 * count + 12 + 4 * k));
    count++;
  };
  for (let i = 0; i < rings; i++) {
    for (let j = 0; j < around; j++) {
      if (i > 0) facet(point(i, j), point(i + 1, j), point(i, j + 1));
      if (i + 1 < rings) facet(point(i, j + 1), point(i + 1, j), point(i + 1, j + 1));
    }
  }
  bytes.writeUInt32LE(count, 80);
  return bytes;
}

/** Returns a function with the processor time that the page's own thread has used since, in milliseconds. */
async function processor(page) {
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable", { timeDomain: "threadTicks" });
  const used = async () => 1_000 * (await session.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration").value;
  const before = await used();
  return async () => (await used()) - before;
}

async function choose(page, slot, file) {
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.click(`[aria-label="Choose a file for the ${slot} body"]`)]);
  await chooser.setFiles(file);
}

test(`${FACETS.toLocaleString("en")} facets: frames go on, a notice is shown, the answer comes`, async () => {
  const file = join(folder, "waves.stl");
  writeFileSync(file, ball(FACETS, 7));
  const working = await processor(page);
  await page.evaluate(() => {
    window.longest = 0;
    window.notices = new Set();
    let last = performance.now();
    const frame = (now) => {
      window.longest = Math.max(window.longest, now - last);
      last = now;
      const wait = document.getElementById("wait");
      if (!wait.hidden) window.notices.add(wait.textContent);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  });
  const began = performance.now();
  await choose(page, "moving", file);
  // The error is reported after the whole file has been read; no answer about the old body replaces it.
  await page.waitForSelector(".refused", { timeout: 60_000 });
  assert.match(await page.textContent(".refused"), /^waves\.stl: .*convex/);
  assert.equal(await page.locator("#headline").count(), 0);
  await page.click("text=As a solid");
  await page.waitForFunction(() => window.colltrans.probe().answer?.kind === "solid", undefined, { timeout: 60_000 });
  // The body takes the pose of its file, until it is moved.
  assert.deepEqual(await page.evaluate(() => window.colltrans.probe().state.poses.moving), [0, 0, 0, 0, 0, 0, 1]);
  for (const [axis, place] of Object.entries({ x: 6, y: 1, z: 9 })) await page.fill(`[aria-label="moving position ${axis}"]`, String(place));
  await page.waitForFunction(() => window.colltrans.probe().answer?.record.outcome === "blocked", undefined, { timeout: 60_000 });
  const { triangles, outcome, longest, notices } = await page.evaluate(() => {
    const { view, answer } = window.colltrans.probe();
    return { triangles: view.bodyOf("moving").body.facts.triangles, outcome: answer.record.outcome, longest: window.longest, notices: [...window.notices] };
  });
  const took = performance.now() - began;
  const worked = await working();
  console.log(`${triangles} triangles answered after ${Math.round(took)} ms, the longest frame ${Math.round(longest)} ms, ${Math.round(worked)} ms of work between frames`);
  assert.ok(Math.abs(triangles / FACETS - 1) < 0.02, `${triangles}`);
  assert.equal(outcome, "blocked");
  assert.deepEqual(notices, ["Reading the mesh"]);
  // Reading and building never run on the thread of the frames, which only draws the result.
  assert.ok(worked < 2_000, `${worked} ms`);
  // Other programs on the machine make all of it longer.
  assert.ok(longest < took / 2, `${longest} ms of ${took}`);
  assert.deepEqual(page.complaints, []);
});

test("file beyond the limit is rejected before it is read", async () => {
  const file = join(folder, "huge.stl");
  const handle = openSync(file, "w");
  ftruncateSync(handle, 401 * 2 ** 20);
  closeSync(handle);
  await at.ask(page);
  await choose(page, "fixed", file);
  await page.waitForSelector(".refused");
  assert.match(await page.textContent(".refused"), /^huge\.stl: 401 MiB; the page accepts up to 400 MiB; use the command line for larger files/);
  assert.equal(await page.locator("#headline").count(), 0);
  await page.click("text=Leave it");
  await page.waitForSelector("#headline:text-is('Contact at t = 4.31674')");
  assert.deepEqual(page.complaints, []);
});
