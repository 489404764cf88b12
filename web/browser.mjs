// For the tests: the page as it was built, in a browser; and programs that answer the same natively.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { Ajv2020 } from "ajv/dist/2020.js";
import { chromium } from "playwright-core";
import { serve } from "./serve.mjs";
import { built } from "./toolchain.mjs";

const root = join(dirname(fileURLToPath(import.meta.url)), "..");
export const data = join(root, "data");
export const dist = join(root, "web/dist");

/** An example of crates/colltrans-wasm: there, `cargo build --profile native --all-features --example NAME`. */
export const program = (name) => join(built, "native/examples", name);

/** The answers of a module (`page`, `found`, ...) natively, a line each. */
export function answers(module, questions) {
  return execFileSync(program("native"), [module], { input: questions.join("\n"), encoding: "utf8", maxBuffer: 1 << 28 }).trim().split("\n");
}

/** Asks a module of the page and the native one the same questions, some with a file of data/; returns the answers, which agree to the bit. */
export async function agreed(page, module, questions) {
  const native = answers(module, questions.map(({ file, question }) =>
    (file ? `${join(data, file)}\t` : "") + JSON.stringify(question)));
  const seen = await page.evaluate(async ([engine, questions]) => {
    const asked = new (window.colltrans.probe().engine.constructor)(engine);
    const texts = [];
    for (const { file, question } of questions) {
      const bytes = file ? await (await fetch(`data/${file}`)).arrayBuffer() : undefined;
      texts.push((await asked.ask(question, bytes)).text);
    }
    return texts;
  }, [`colltrans_${module}`, questions]);
  assert.deepEqual(seen, native);
  return seen;
}

const schema = new Ajv2020({ strict: false, allErrors: true });
schema.addSchema(JSON.parse(readFileSync(join(root, "docs/answers.schema.json"), "utf8")), "answers");

/** The same numbers each time for a seed: from -1 to 1, and unit quaternions of four of them. */
export function draws(seed) {
  let state = seed;
  const random = () => {
    state = (state * 6364136223846793005n + 1442695040888963407n) & ((1n << 64n) - 1n);
    return Number(state >> 11n) / 2 ** 52 - 1;
  };
  const turn = () => {
    const q = [random(), random(), random(), random()];
    const l = Math.hypot(...q);
    return q.map((x) => x / l);
  };
  return { random, turn };
}

/** Whether a value is what the schema of answers calls so. */
export function conform(name, value) {
  const fits = schema.getSchema(`answers#/$defs/${name}`);
  assert.ok(fits, `${name} is not in the schema`);
  assert.ok(fits(value), `${name}: ${schema.errorsText(fits.errors)}: ${JSON.stringify(value).slice(0, 500)}`);
}

/** Graphics are computed. Only what is drawn in three dimensions is, as by a graphics card; the page around it is
 * put together without one, which takes half as long. */
const COMPUTED = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-compositing", "--disable-gpu-rasterization"];

export function launch(args = COMPUTED) {
  const executablePath = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find((path) => existsSync(path));
  return chromium.launch({ executablePath, args: ["--no-sandbox", ...args] });
}

/** Without graphics. */
export const launchPlain = () => launch(["--disable-gpu", "--disable-3d-apis"]);

/** An OFF file of boxes, each by its lowest and its highest corner. */
export function boxes(...all) {
  const corners = all.flatMap((ends) => [...Array(8).keys()].map((k) => [0, 1, 2].map((axis) => ends[(k >> axis) & 1][axis]).join(" ")));
  const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const faces = all.flatMap((_, k) => sides.map((side) => `4 ${side.map((v) => v + 8 * k).join(" ")}`));
  return ["OFF", `${corners.length} ${faces.length} 0`, ...corners, ...faces, ""].join("\n");
}

/** Files, by name and text, that are dropped on an element. */
export const drop = (page, selector, files) => page.evaluate(([selector, files]) => {
  const dataTransfer = new DataTransfer();
  for (const [name, text] of Object.entries(files)) dataTransfer.items.add(new File([text], name));
  document.querySelector(selector).dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
}, [selector, files]);

/** What a page complains about, and what it reads. Waits end with a failure late: graphics are computed here, and
 * pages of several tests at once. */
export function watch(page) {
  page.setDefaultTimeout(120_000);
  page.complaints = [];
  // Without a card the browser reads what is drawn back for every frame, and warns of it; the page never does.
  const isBrowsers = (text) => /^\[\.WebGL-\w+\]GL Driver Message .*: GPU stall due to ReadPixels/.test(text);
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && !isBrowsers(message.text()) && page.complaints.push(message.text()));
  page.on("pageerror", (error) => page.complaints.push(String(error)));
  page.read = [];
  page.on("request", (request) => page.read.push(request.url()));
  page.on("requestfailed", (request) => page.complaints.push(request.url()));
  return page;
}

/** Whether something of what a canvas shows is cut off by its border. */
export const isCut = (page, canvas) => page.evaluate(async (selector) => {
  await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
  const source = document.querySelector(selector);
  const { width, height } = source;
  const flat = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d", { willReadFrequently: true });
  flat.drawImage(source, 0, 0);
  const borders = [[0, 0, width, 1], [0, height - 1, width, 1], [0, 0, 1, height], [width - 1, 0, 1, height]];
  return borders.some((border) => flat.getImageData(...border).data.some((x, k) => k % 4 === 3 && x > 0));
}, canvas);

/** The page, served under a path of its own as on a site among others, in a browser. */
export async function site() {
  const server = await serve(dist, 0, "/some/where/");
  const browser = await launch();
  const base = `http://127.0.0.1:${server.address().port}/some/where/`;
  return {
    base,
    browser,
    /** A page of a context of its own, once it shows what is waited for. */
    async open(hash = "", options = {}, ready = ["#headline", "#tools button"]) {
      const context = await browser.newContext({ viewport: { width: 900, height: 640 }, ...options });
      const page = watch(await context.newPage());
      await page.goto(base + hash);
      for (const selector of ready) await page.waitForSelector(selector);
      return page;
    },
    /** The same page, asked by another address, as where somebody follows a link in it: what is asked and answered
     * is as where a page is opened with it. Tools, themes and cards are a test's own to put back. */
    async ask(page, hash = "#example=bracket", ready = ["#headline"]) {
      await page.evaluate(async (hash) => {
        const changed = new Promise((resolve) => addEventListener("hashchange", resolve, { once: true }));
        window.before = window.colltrans.probe().answer;
        // What nobody reads in it makes it another one, even where the same is asked again.
        location.hash = `${hash}&turn=${(window.turn = (window.turn ?? 0) + 1)}`;
        await changed;
      }, hash);
      // The last answer stays until there is another one.
      await page.waitForFunction(() => ![undefined, window.before].includes(window.colltrans.probe().answer));
      await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
      for (const selector of ready) await page.waitForSelector(selector);
      return page;
    },
    async close() {
      await browser.close();
      server.close();
    },
  };
}
