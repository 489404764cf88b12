// Sizes of the entries, as a bundler makes them, and the package by itself: without its checkout.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { brotliCompressSync, gzipSync } from "node:zlib";
import { build } from "esbuild";
import { launchPlain } from "../../browser.mjs";
import { serve } from "../../serve.mjs";

const here = join(dirname(fileURLToPath(import.meta.url)), "..");
const tsc = join(here, "../node_modules/typescript/bin/tsc");
let folder;
before(() => {
  folder = mkdtempSync(join(tmpdir(), "colltrans-"));
  execFileSync("npm", ["pack", "--silent", "--pack-destination", folder], { cwd: here });
  const [packed] = readdirSync(folder);
  writeFileSync(join(folder, "package.json"), '{"name":"user","private":true,"type":"module"}');
  execFileSync("npm", ["install", "--silent", "--no-audit", "--no-fund", "--offline", `./${packed}`], { cwd: folder });
});
after(() => rmSync(folder, { recursive: true, force: true }));

/** The libraries of both entries. */
const LIBRARIES = { "colltrans/cast": "casts.wasm", colltrans: "bodies.wasm" };

const bundle = async (name, text) => {
  writeFileSync(join(folder, `${name}.js`), text);
  await build({ entryPoints: [join(folder, `${name}.js`)], bundle: true, minify: true, format: "esm", target: "es2022", outfile: join(folder, `${name}.out.js`) });
  return readFileSync(join(folder, `${name}.out.js`));
};

test("casts alone have at most 150 KB", async () => {
  const sizes = {};
  for (const entry of ["colltrans/cast", "colltrans"]) {
    const made = await bundle("size", `import { ConvexPolyhedron, cast } from "${entry}";
      const box = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1]);
      console.log(cast(box.at([-3, 0.5, 0]), box, [1, 0, 0]).value);`);
    // The bundler leaves the library to the program.
    const [library] = [readFileSync(join(folder, "node_modules/colltrans/dist", LIBRARIES[entry]))];
    writeFileSync(join(folder, LIBRARIES[entry]), library);
    const size = (compress) => compress(made) + compress(library);
    sizes[entry] = { gzip: size((text) => gzipSync(text, { level: 9 }).length), brotli: size((text) => brotliCompressSync(text).length) };
    console.log(entry, sizes[entry]);
    assert.equal(execFileSync(process.execPath, [join(folder, "size.out.js")], { encoding: "utf8" }), "2\n");
  }
  assert.ok(sizes["colltrans/cast"].brotli < 150_000);
});

test("casts alone reject what they lack, and equal those of the whole package", () => {
  writeFileSync(join(folder, "small.mjs"), `
    import { ConvexPolyhedron, InputError, cast } from "colltrans/cast";
    const box = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1]);
    const small = cast(box.at([-3, 0.5, 0]), box, [1, 0.1, 0]);
    try { box.rounded(1); } catch (error) { console.log(error instanceof InputError, error.message); }
    const all = await import("colltrans");
    const other = all.ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1]);
    console.log(JSON.stringify(small) === JSON.stringify(all.cast(other.at([-3, 0.5, 0]), other, [1, 0.1, 0])));
    try { cast(box, other, [1, 0, 0]); } catch (error) { console.log(error instanceof InputError, error.argument); }
    try { all.distance(box, box); } catch (error) { console.log(error instanceof InputError); }
  `);
  const lines = execFileSync(process.execPath, ["small.mjs"], { cwd: folder, encoding: "utf8" }).trim().split("\n");
  assert.match(lines[0], /^true .*import colltrans/);
  assert.deepEqual(lines.slice(1), ["true", "true fixed", "true"]);
});

test("types fit under strict, with and without the library of the browser", () => {
  writeFileSync(join(folder, "user.ts"), `
    import { ConvexPolyhedron, Solid, InputError, cast, castMany, clearance, distance, within } from "colltrans";
    import type { CastAnswer, Contact } from "colltrans";
    const box: ConvexPolyhedron = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1]);
    const hit = cast(box.at([-3, 0.5, 0]), box, [1, 0, 0]);
    if (hit.outcome === "contact") { const contact: Contact = hit; const x: number = contact.normal[0]; void x; }
    // @ts-expect-error: convex bodies do not have this answer
    if (hit.outcome === "free") void hit;
    const any: CastAnswer = cast(box, Solid.fromPieces([box]), { x: 1, y: 0, z: 0 });
    const gap: number | null = clearance(box, box, [1, 0, 0]).value;
    const closer: boolean | null = within(box, box, 1).closer;
    const column: Float64Array = castMany(box, box, [1, 0, 0], { movingPoses: { positions: [0, 0, 3] } }).value;
    const apart: number = distance(box, box, { fixedPose: [4, 5, 0] }).upper;
    // @ts-expect-error: a direction has three coordinates
    cast(box, box, 3);
    // @ts-expect-error: an unknown option
    cast(box, box, [1, 0, 0], { gap: 3 });
    // @ts-expect-error: a solid is not convex
    const wrong: ConvexPolyhedron = Solid.fromPieces([box]);
    void [any, gap, closer, column, apart, wrong, InputError];
    { using copy = ConvexPolyhedron.fromPoints(box.vertices); void copy.volume; }
  `);
  for (const options of [["--module", "nodenext"], ["--module", "esnext", "--moduleResolution", "bundler", "--lib", "es2022,esnext.disposable"]]) {
    execFileSync(process.execPath, [tsc, "--strict", "--noEmit", "--target", "es2022", "--types", "", "--exactOptionalPropertyTypes", ...options, "user.ts"], { cwd: folder, encoding: "utf8", stdio: "pipe" });
  }
});

test("it answers in Chromium: without a bundler, bundled, and in a worker", async () => {
  const text = `import { ConvexPolyhedron, Solid, cast, distance } from "colltrans";
    const box = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1]);
    const found = [cast(box.at([-3, 0.5, 0.3]), box, [1, 0.1, 0]), distance(Solid.fromPieces([box]), box.at([4, 5, 0.25]))];`;
  await bundle("bundled", `${text} window.found = JSON.stringify(found);`);
  writeFileSync(join(folder, "worker.js"), `self.onmessage = async () => {
    const { ConvexPolyhedron, Solid, cast, distance } = await import("./node_modules/colltrans/dist/index.js");
    ${text.split("\n").slice(1).join("\n")}
    self.postMessage(JSON.stringify(found));
  };`);
  writeFileSync(join(folder, "native.mjs"), `${text} console.log(JSON.stringify(found));`);
  const head = '<!doctype html><title>user</title><script type="importmap">{"imports":{"colltrans":"./node_modules/colltrans/dist/index.js"}}</script>';
  writeFileSync(join(folder, "plain.html"), `${head}<script type="module">${text} window.found = JSON.stringify(found);</script>`);
  writeFileSync(join(folder, "bundled.html"), '<!doctype html><title>user</title><script type="module" src="bundled.out.js"></script>');
  writeFileSync(join(folder, "worker.html"), `<!doctype html><title>user</title><script type="module">
    const worker = new Worker("worker.js", { type: "module" });
    worker.onmessage = ({ data }) => (window.found = data);
    worker.postMessage("start");</script>`);
  const expected = execFileSync(process.execPath, ["native.mjs"], { cwd: folder, encoding: "utf8" }).trim();
  const [server, browser] = [await serve(folder, 0, "/"), await launchPlain()];
  try {
    for (const name of ["plain", "bundled", "worker"]) {
      const page = await browser.newPage();
      await page.goto(`http://127.0.0.1:${server.address().port}/${name}.html`);
      await page.waitForFunction(() => window.found);
      assert.equal(await page.evaluate(() => window.found), expected, name);
      await page.close();
    }
  } finally {
    await browser.close();
    server.close();
  }
});
