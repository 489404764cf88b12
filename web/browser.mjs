// For the tests: the built page in a browser, and native programs that give the same answers.

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

/** Returns the path of an example of crates/colltrans-wasm; build it there with `cargo build --profile native --all-features --example NAME`. */
export const program = (name) => join(built, "native/examples", name);

/** Returns the native answers of a module (`page`, `found`, ...), one for each question. */
export function answers(module, questions) {
  return execFileSync(program("native"), [module], { input: questions.join("\n"), encoding: "utf8", maxBuffer: 1 << 28 }).trim().split("\n");
}

/** Sends questions, some with a file of data/, to a module of the page and to the native one; checks that the answers are equal to the bit and returns them. */
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

/** Returns generators of reproducible random numbers for a seed: from -1 to 1, and unit quaternions of four of them. */
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

/** Checks a value against a definition of the schema of answers. */
export function conform(name, value) {
  const fits = schema.getSchema(`answers#/$defs/${name}`);
  assert.ok(fits, `${name} is not in the schema`);
  assert.ok(fits(value), `${name}: ${schema.errorsText(fits.errors)}: ${JSON.stringify(value).slice(0, 500)}`);
}

/** Flags for software rendering. Only the three-dimensional drawing uses it, as it would use a graphics card. The page
 * around it is composited without a card, which takes half as long. */
const COMPUTED = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-compositing", "--disable-gpu-rasterization"];

export function launch(args = COMPUTED) {
  const executablePath = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find((path) => existsSync(path));
  return chromium.launch({ executablePath, args: ["--no-sandbox", ...args] });
}

/** Launches the browser without graphics. */
export const launchPlain = () => launch(["--disable-gpu", "--disable-3d-apis"]);

/** Builds an OFF file of boxes, each given by its lowest and its highest corner. */
export function boxes(...all) {
  const corners = all.flatMap((ends) => [...Array(8).keys()].map((k) => [0, 1, 2].map((axis) => ends[(k >> axis) & 1][axis]).join(" ")));
  const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const faces = all.flatMap((_, k) => sides.map((side) => `4 ${side.map((v) => v + 8 * k).join(" ")}`));
  return ["OFF", `${corners.length} ${faces.length} 0`, ...corners, ...faces, ""].join("\n");
}

/** Drops files, by name and text, on an element. */
export const drop = (page, selector, files) => page.evaluate(([selector, files]) => {
  const dataTransfer = new DataTransfer();
  for (const [name, text] of Object.entries(files)) dataTransfer.items.add(new File([text], name));
  document.querySelector(selector).dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
}, [selector, files]);

/** Collects the errors and the requests of a page. Waits have long time limits, because graphics are computed in
 * software and several tests run their pages at once. */
export function watch(page) {
  page.setDefaultTimeout(120_000);
  page.complaints = [];
  // Without a graphics card the browser reads every frame back and warns about it; the page itself never reads back.
  const isBrowsers = (text) => /^\[\.WebGL-\w+\]GL Driver Message .*: GPU stall due to ReadPixels/.test(text);
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && !isBrowsers(message.text()) && page.complaints.push(message.text()));
  page.on("pageerror", (error) => page.complaints.push(String(error)));
  page.read = [];
  page.on("request", (request) => page.read.push(request.url()));
  page.on("requestfailed", (request) => page.complaints.push(request.url()));
  return page;
}

/** Checks whether the drawing of a canvas is cut off at its border. */
export const isCut = (page, canvas) => page.evaluate(async (selector) => {
  await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
  const source = document.querySelector(selector);
  const { width, height } = source;
  const flat = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d", { willReadFrequently: true });
  flat.drawImage(source, 0, 0);
  const borders = [[0, 0, width, 1], [0, height - 1, width, 1], [0, 0, 1, height], [width - 1, 0, 1, height]];
  return borders.some((border) => flat.getImageData(...border).data.some((x, k) => k % 4 === 3 && x > 0));
}, canvas);

/** Serves the page under a path of its own, as on a site among others, and opens a browser. */
export async function site() {
  const server = await serve(dist, 0, "/some/where/");
  const browser = await launch();
  const base = `http://127.0.0.1:${server.address().port}/some/where/`;
  return {
    base,
    browser,
    /** Opens a page in a context of its own, and waits for the given elements. */
    async open(hash = "", options = {}, ready = ["#headline", "#tools button"]) {
      const context = await browser.newContext({ viewport: { width: 900, height: 640 }, ...options });
      const page = watch(await context.newPage());
      await page.goto(base + hash);
      for (const selector of ready) await page.waitForSelector(selector);
      return page;
    },
    /** Navigates the page to another address, as a link in it does. The state is then as in a newly opened page. Tools,
     * themes and cards are reset by each test itself. */
    async ask(page, hash = "#example=bracket", ready = ["#headline"]) {
      await page.evaluate(async (hash) => {
        const changed = new Promise((resolve) => addEventListener("hashchange", resolve, { once: true }));
        window.before = window.colltrans.probe().answer;
        // An unused parameter makes the address new, even for the same question.
        location.hash = `${hash}&turn=${(window.turn = (window.turn ?? 0) + 1)}`;
        await changed;
      }, hash);
      // The last answer stays until the next one arrives.
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
