// Checks the site in a browser, at two widths, light and dark: no page scrolls sideways, nothing is cut off, text has
// enough contrast, nothing is fetched from other sites, no script reports an error.
//
//   node site/look.mjs SITE [PICTURES]        writes pictures of some pages to the folder PICTURES

import { mkdirSync, readdirSync } from "node:fs";
import { join, relative, resolve } from "node:path";
import { launchPlain, watch } from "../web/browser.mjs";
import { serve } from "../web/serve.mjs";

const [folder, pictures] = process.argv.slice(2).map((path) => resolve(path));
/** The documentation of Rust, the page and the report of the laboratory have checks of their own. */
const OTHERS = /^(rust|page|laboratory|_static|_sources)\//;
const PICTURED = ["index.html", "gallery.html", "docs/peers.html", "docs/reference/command-line.html", "notebooks/data.html", "python/api.html"];

const pages = readdirSync(folder, { recursive: true })
  .filter((file) => file.endsWith(".html") && !OTHERS.test(file))
  .sort();

/** Returns the faults of the layout of the page. */
function faults() {
  const told = [];
  const root = document.documentElement;
  if (root.scrollWidth > innerWidth) told.push(`the page is ${root.scrollWidth} wide, ${innerWidth} are there`);
  const scrolls = (element) => ["auto", "scroll"].includes(getComputedStyle(element).overflowX);
  const luminance = (colour) => {
    const [r, g, b] = colour.match(/[\d.]+/g).map((value) => value / 255).map((value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const colour = getComputedStyle(at).backgroundColor;
      const opacity = colour.match(/[\d.]+/g)[3];
      if (opacity === undefined || Number(opacity) > 0.5) return colour;
    }
    return "rgb(255, 255, 255)";
  };
  for (const element of document.querySelectorAll("article :is(p, li, pre, td, th, dt, dd, h1, h2, h3, img, table, code, span, svg, math)")) {
    const box = element.getBoundingClientRect();
    if (box.width === 0 || getComputedStyle(element).visibility === "hidden") continue;
    let holder = element;
    while (holder && !scrolls(holder)) holder = holder.parentElement;
    const words = `<${element.localName}> ${element.textContent.trim().slice(0, 40)}`;
    if (!holder && (box.right > innerWidth + 1 || box.left < -1)) told.push(`cut off at ${Math.round(box.right)}: ${words}`);
    if (element.childElementCount === 0 && element.textContent.trim() && !element.closest("svg")) {
      const [text, ground] = [getComputedStyle(element).color, behind(element)].map(luminance);
      const contrast = (Math.max(text, ground) + 0.05) / (Math.min(text, ground) + 0.05);
      if (contrast < 3) told.push(`contrast ${contrast.toFixed(1)}: ${words}`);
    }
  }
  for (const image of document.querySelectorAll("img")) {
    if (image.complete && image.naturalWidth === 0) told.push(`no picture: ${image.src}`);
  }
  return [...new Set(told)].slice(0, 5);
}

const server = await serve(folder, 0, "/");
const base = `http://127.0.0.1:${server.address().port}/`;
const browser = await launchPlain();
let wrong = 0;
for (const [width, height] of [[1280, 900], [390, 844]]) {
  for (const colorScheme of ["light", "dark"]) {
    const context = await browser.newContext({ viewport: { width, height }, colorScheme });
    for (const file of pages) {
      const page = watch(await context.newPage());
      await page.goto(base + relative(".", file), { waitUntil: "load" });
      const elsewhere = page.read.filter((address) => !address.startsWith(base) && !address.startsWith("data:"));
      const told = [...(await page.evaluate(faults)), ...elsewhere.map((address) => `fetched: ${address}`), ...page.complaints];
      for (const what of told) console.log(`${file}, ${width} ${colorScheme}: ${what}`);
      wrong += told.length;
      if (pictures && PICTURED.includes(file)) {
        mkdirSync(pictures, { recursive: true });
        await page.screenshot({ path: join(pictures, `${file.replaceAll("/", "-").replace(".html", "")}-${width}-${colorScheme}.png`) });
      }
      await page.close();
    }
    await context.close();
  }
}
await browser.close();
server.close();
console.log(`${pages.length} pages at two widths, by day and by night: ${wrong} faults`);
process.exit(wrong > 0 ? 1 : 0);
