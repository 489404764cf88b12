// The page in a browser: files, addresses, examples, and missing features. Needs `npm run build`.

import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { boxes, data, drop, launchPlain, site, watch } from "../browser.mjs";

let at, page, folder;
before(async () => {
  at = await site();
  folder = mkdtempSync(join(tmpdir(), "page-"));
});
after(async () => {
  await at?.close();
  if (folder) rmSync(folder, { recursive: true });
});

const headline = (page) => page.textContent("#headline");
const answered = (page) => page.evaluate(() => window.colltrans.probe().answer);

test("invalid direction is reported, and another address is answered", async () => {
  page = await at.open("#d=0,0,0", {}, ["text=No answer", "#tools button"]);
  assert.match(await page.textContent(".said"), /direction/);
  await at.ask(page);
  assert.equal(await headline(page), "Contact at t = 4.31674");
  assert.deepEqual(page.complaints, []);
});

test("view is saved as pixels and as a drawing, and so are the shadows", async () => {
  await at.ask(page);
  await page.click("summary:has-text('Share')");
  for (const [button, name, begins] of [["Save the view (PNG)", "contact.png", "\u0089PNG"], ["Save the view (SVG)", "contact.svg", "<svg"], ["Save the shadows (SVG)", "shadows.svg", "<?xml"]]) {
    const [download] = await Promise.all([page.waitForEvent("download"), page.click(`text=${button}`)]);
    assert.equal(download.suggestedFilename(), name);
    const text = readFileSync(await download.path(), "latin1");
    assert.ok(text.startsWith(begins), text.slice(0, 20));
    if (name === "contact.svg") assert.ok(text.split("<path").length > 50 && text.endsWith("</svg>\n"));
  }
  assert.deepEqual(page.complaints, []);
});

test("invalid file shows its error, and a file that is not convex two alternatives", async () => {
  await at.ask(page);
  const choose = async (file) => {
    const [chooser] = await Promise.all([
      page.waitForEvent("filechooser"),
      page.click('[aria-label="Choose a file for the moving body"]'),
    ]);
    await chooser.setFiles(file);
  };
  const bad = join(folder, "bad.off");
  writeFileSync(bad, "OFF\n4 1 0\n0 0 0\n1 0 0\n1.000000000000000 1.000000000000000 zero\n");
  await choose(bad);
  await page.waitForSelector(".refused");
  assert.match(await page.textContent(".refused"), /^bad\.off: line 5: /);
  await page.waitForFunction(() => document.querySelector(".refused").getBoundingClientRect().bottom <= innerHeight);
  // The old body is not part of the question until it is restored.
  await page.waitForSelector(".said h2:text-is('No answer')");
  assert.match(await page.textContent(".said"), /bad\.off: line 5/);
  assert.equal(await answered(page), undefined);
  await page.fill('[aria-label="moving position z"]', "12.5");
  await page.waitForFunction(() => window.colltrans.probe().state.poses.moving[2] === 12.5);
  assert.equal(await answered(page), undefined);
  await page.click("text=Leave it");
  await page.waitForFunction(() => window.colltrans.probe().answer?.record.translation > 7);
  assert.match(await page.textContent(".bodies"), /dodecahedron\.off/);
  await page.fill('[aria-label="moving position z"]', "9");
  await page.waitForFunction(() => document.querySelector("#headline")?.textContent === "Contact at t = 4.31674");
  await choose({ name: "bracket.off", mimeType: "", buffer: Buffer.alloc(0) });
  await page.waitForSelector(".refused");
  assert.match(await page.textContent(".refused"), /^bracket\.off: the file is empty/);
  await choose(join(data, "plate.off"));
  await page.waitForSelector("text=As a solid");
  assert.match(await page.textContent(".refused"), /not convex|topolog|sphere|genus|hole/i);
  await page.click("text=As a solid");
  await page.waitForFunction(() => window.colltrans.probe().answer?.kind === "solid");
  assert.deepEqual(page.complaints, []);
});

test("dropped files take the poses of their files and are answered together", async () => {
  await at.ask(page);
  const cube = (z) => boxes([[0, 0, z], [1, 1, z + 1]]);
  const state = () => page.evaluate(() => window.colltrans.probe().state);
  await page.evaluate(() => {
    const { view } = window.colltrans.probe();
    window.shown = [];
    const look = () => {
      const { answer, state } = window.colltrans.probe();
      if (answer) window.shown.push(`${state.parts.moving.file} ${state.parts.fixed.file} ${answer.record.translation}`);
      window.looking = requestAnimationFrame(look);
    };
    look();
    return !!view;
  });
  await page.click(".card button:text-is('−z') >> nth=0");
  await drop(page, "[data-slot=moving]", { "upper.off": cube(5), "lower.off": cube(1) });
  await page.waitForFunction(() => window.colltrans.probe().state.parts.fixed.file === "lower.off" && window.colltrans.probe().answer);
  const given = await state();
  assert.deepEqual([given.poses.moving, given.poses.fixed], [[0, 0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0, 1]]);
  assert.equal(await headline(page), "Contact at t = 3");
  // No answer refers to bodies that were not opened together.
  const shown = await page.evaluate(() => (cancelAnimationFrame(window.looking), window.shown));
  assert.ok(shown.every((said) => !/^(upper|lower)/.test(said.split(" ")[0]) || said === "upper.off lower.off 3"), [...new Set(shown)].join("; "));
  assert.ok(shown.every((said) => !said.includes("lower.off") || said.startsWith("upper.off")), [...new Set(shown)].join("; "));
  // Moved and rotated, then reset to the poses of the files.
  await page.fill('[aria-label="moving position x"]', "30");
  await page.waitForSelector("#headline:text-is('They never meet')");
  await page.click("button:text-is('as in the files')");
  await page.waitForSelector("#headline:text-is('Contact at t = 3')");
  // A rejected file removes the answer, and its replacement takes the pose of its file.
  await page.fill('[aria-label="moving position x"]', "0.25");
  await drop(page, "[data-slot=moving]", { "no.off": "OFF\n" });
  await page.waitForSelector(".said h2:text-is('No answer')");
  assert.equal(await answered(page), undefined);
  await drop(page, "[data-slot=moving]", { "higher.off": cube(7) });
  await page.waitForSelector("#headline:text-is('Contact at t = 5')");
  assert.equal((await state()).poses.moving[0], 0);
  assert.equal(await page.locator(".refused").count(), 0);
  assert.deepEqual(page.complaints, []);
});

test("address with a file of the visitor determines how the file is used", async () => {
  const page = await at.open("#m=plate.STL:convex&f=mine.off:solid", {}, ["text=No answer", "#tools button"]);
  assert.match(await page.textContent(".said"), /mine\.off is not among the examples/);
  assert.equal(await page.locator("button:text-is('Leave it')").count(), 0);
  await page.click("#tab-found");
  await page.waitForSelector("text=A body is missing");
  await page.click("#tab-answer");
  await page.evaluate(() => (location.hash = "#f=mine.off:solid"));
  await page.waitForFunction(() => document.querySelectorAll(".refused").length === 1);
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.click('[aria-label="Choose a file for the fixed body"]')]);
  await chooser.setFiles({ name: "mine.off", mimeType: "", buffer: readFileSync(join(data, "plate.off")) });
  await page.waitForFunction(() => window.colltrans.probe().answer?.kind === "solid");
  assert.equal(await page.evaluate(() => window.colltrans.probe().state.parts.fixed.take), "solid");
  // The file is still available for another address and for the back button.
  await page.waitForFunction(() => location.hash.includes("f=mine.off"));
  await page.evaluate(() => (location.hash = `${location.hash.replace(/&d=[^&]*/, "")}&d=0,0.5,-1`));
  await page.waitForFunction(() => window.colltrans.probe().state.direction[1] === 0.5 && window.colltrans.probe().answer?.kind === "solid");
  await page.goBack();
  await page.waitForFunction(() => window.colltrans.probe().state.direction[1] === 0.1 && window.colltrans.probe().answer?.kind === "solid");
  assert.equal(await page.locator(".refused").count(), 0);
  // A missing file removes the answer about the previous one.
  await page.evaluate(() => (location.hash = "#m=gone.off:convex"));
  await page.waitForSelector("text=No answer");
  assert.equal(await answered(page), undefined);
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

test("choosing an example resets the check of the proof", async () => {
  await at.ask(page, "#example=__proto__");
  const chosen = () => page.inputValue("#example");
  assert.equal(await chosen(), "bracket");
  await page.fill('[aria-label="moving position z"]', "12.5");
  await page.waitForFunction(() => document.querySelector("#example").value === "");
  await page.click("text=Verify");
  await page.waitForSelector(".verdict.yes");
  await page.selectOption("#example", "bracket");
  await page.waitForFunction(() => document.querySelector("#headline")?.textContent === "Contact at t = 4.31674");
  assert.equal(await page.locator(".verdict").count(), 0);
  assert.equal(await chosen(), "bracket");
  // Of two examples chosen at the same time the last one is shown.
  const late = page.waitForResponse("**/data/gear_hull.stl");
  let go;
  const last = new Promise((resolve) => (go = resolve));
  await page.route("**/data/gear_hull.stl", (route) => last.then(() => route.continue()));
  await page.selectOption("#example", "miss");
  await page.selectOption("#example", "plate");
  await page.waitForFunction(() => window.colltrans.probe().answer?.kind === "solid");
  go();
  await (await late).finished();
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  const { parts, answer } = await page.evaluate(() => ({ parts: window.colltrans.probe().state.parts, answer: window.colltrans.probe().answer }));
  assert.deepEqual([parts.moving.file, parts.fixed.file, answer.kind], ["bolt.stl", "plate.off", "solid"]);
  await page.selectOption("#example", "gearbox");
  await page.waitForSelector("#assembly-headline");
  assert.equal(await chosen(), "gearbox");
  await page.click("#tab-answer");
  await page.waitForFunction(() => document.querySelector("#example").value === "plate");
  assert.deepEqual(page.complaints, []);
});

test("numbers out of range are reported and reset", async () => {
  const page = await at.open("#mp=1e200,1,9,0,0,0,1", {}, ["text=No answer", "#tools button"]);
  const field = page.locator('[aria-label="moving position x"]');
  // A picture holds a smaller range than the library, which holds a smaller range than a number.
  for (const [number, said] of [["1e50", "never meet"], ["1e308", "No answer"], ["6", "Contact at t"]]) {
    await field.fill(number);
    await page.waitForSelector(`.said h2:has-text('${said}')`);
    await page.click("#tools button:text-is('Fit')");
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  }
  await page.fill('[aria-label="Direction z"]', "-1e308");
  await page.waitForSelector("text=No answer");
  await page.fill('[aria-label="Direction z"]', "-1");
  await page.waitForSelector("#headline:has-text('Contact at t')");
  assert.ok((await page.evaluate(() => window.colltrans.probe().view.camera.position.toArray())).every(Number.isFinite));
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

test("missing WebGL is reported", async () => {
  const without = await launchPlain();
  const page = watch(await without.newPage());
  await page.goto(at.base);
  await page.waitForSelector("text=needs WebGL 2");
  assert.equal(await headline(page), "Contact at t = 4.31674");
  await page.fill('[aria-label="moving position z"]', "12.5");
  await page.waitForFunction(() => window.colltrans.probe().answer?.record.translation > 7);
  await without.close();
});

test("phone layout fits the screen", async () => {
  const page = await at.open("", { viewport: { width: 360, height: 640 } });
  for (const [width, height] of [[360, 640], [390, 844], [844, 390], [768, 1024]]) {
    await page.setViewportSize({ width, height });
    await page.waitForFunction((width) => innerWidth === width, width);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, `${wide} of ${width}`);
  }
  await page.context().close();
});

test("first tab works without a network after loading", async () => {
  const page = await at.open();
  await page.context().setOffline(true);
  await page.fill('[aria-label="moving position z"]', "12.5");
  await page.waitForFunction(() => window.colltrans.probe().answer?.record.translation > 7);
  await page.click("text=Verify");
  await page.waitForSelector(".verdict.yes");
  assert.deepEqual(page.complaints, []);
  // A part that is not loaded reports this once, and everything else stays.
  await page.click("#tab-assembly");
  await page.waitForSelector("text=This part of the page could not be read");
  await page.waitForSelector("#tab-answer[aria-selected=true]");
  await page.context().close();
});

test("page opens with an invitation, and two files are chosen at once", async () => {
  const page = await at.open();
  await page.waitForSelector("text=Drop your two parts here");
  const files = ["moving", "fixed"].map((name, k) => {
    const path = join(folder, `${name}.off`);
    writeFileSync(path, boxes([[0, 0, 5 - 5 * k], [1, 1, 6 - 5 * k]]));
    return path;
  });
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.click("text=Choose two files")]);
  assert.ok(chooser.isMultiple());
  await chooser.setFiles(files);
  await page.waitForFunction(() => window.colltrans.probe().state.parts.fixed.file === "fixed.off" && window.colltrans.probe().answer);
  assert.ok(await page.isHidden("text=Drop your two parts here"));
  await page.context().close();
});

test("every control has a name on a phone, in every tab", async () => {
  const phone = await at.open("", { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true });
  for (const tab of ["answer", "motion", "found", "assembly"]) {
    await phone.tap(`#tab-${tab}`);
    await phone.waitForFunction((tab) => window.colltrans.probe().state.tab === tab, tab);
    await phone.waitForTimeout(500);
    const tree = await phone.locator("body").ariaSnapshot();
    const nameless = tree.split("\n").filter((line) => /^\s*- (button|link|textbox|spinbutton|combobox|checkbox|slider|tab|radio)\b(?! ")/.test(line));
    assert.deepEqual(nameless, [], tab);
  }
  assert.deepEqual(phone.complaints, []);
  await phone.context().close();
});
