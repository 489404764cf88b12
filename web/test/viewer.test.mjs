// The viewer in an assembly's report, opened as a file. Needs `cargo build --release` before.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const program = join(root, "target/release/colltrans");
const executablePath = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find((path) => existsSync(path));
const skip = existsSync(program) ? false : "the command is not built: cargo build --release";

test("a report shows its plan from all sides", { skip }, async () => {
  const folder = mkdtempSync(join(tmpdir(), "report-"));
  execFileSync(program, ["assembly", join(root, "data/gearbox_small"), "--tolerance", "0.1", "-o", folder], { stdio: "ignore" });
  const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
  try {
    const page = await browser.newPage({ viewport: { width: 1100, height: 900 } });
    const complaints = [];
    page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
    page.on("pageerror", (error) => complaints.push(String(error)));
    page.on("request", (request) => request.url().startsWith("http") && complaints.push(request.url()));
    await page.goto(pathToFileURL(join(folder, "report.html")).href);
    await page.waitForSelector("#viewer canvas");
    assert.match(await page.textContent("#viewer output"), /^16 parts, \d+ steps/);
    await page.click('#viewer [aria-label="Step on"]');
    await page.waitForFunction(() => document.querySelector("#viewer input").valueAsNumber === 1);
    assert.match(await page.textContent("#viewer output"), /^Step 1 of \d+: .+ along /);
    // The part in the middle of the picture has a name.
    const box = await page.locator("#viewer canvas").boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForSelector("#viewer .name:not([hidden])");
    assert.ok((await page.textContent("#viewer .name")).length > 2);
    assert.deepEqual(complaints, []);
  } finally {
    await browser.close();
    rmSync(folder, { recursive: true });
  }
});
