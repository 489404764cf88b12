// Builds the page into `dist/`: the library for WebAssembly by cargo and wasm-opt, the scripts by esbuild. The folder
// is built under another name and renamed when it is complete, so that several builds at a time do not disturb each other.
//
//   node build.mjs            builds once
//   node build.mjs --serve    also serves the page on this machine
//   node build.mjs --no-wasm  builds only the scripts, with the last build of the library

import { execFileSync } from "node:child_process";
import { copyFileSync, cpSync, mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { optimised } from "./optimise.mjs";
import { shaders } from "./shaders.mjs";
import { serve } from "./serve.mjs";
import { Missing, built, toolchain } from "./toolchain.mjs";

/** Exits with code 3 if there is no compiler for the target, to distinguish this from a failure. */
function found() {
  try {
    return toolchain();
  } catch (error) {
    console.error(error.message);
    process.exit(error instanceof Missing || error.code === "ENOENT" ? 3 : 1);
  }
}

const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, "..");
const data = join(root, "data");
const target = join(here, "dist");
/** Number of attempts to replace the folder, if other builds replace it too. */
const ATTEMPTS = 10;

/** The modules of the page by the features of `colltrans-wasm`. Fewer features give smaller modules. */
const MODULES = {
  "": ["page", "page_found", "page_picture"],
  "min-gap": ["page_motion", "page_all"],
  assembly: ["page_assembly"],
};

if (!process.argv.includes("--no-wasm")) {
  const env = { ...process.env, ...found() };
  for (const [features, examples] of Object.entries(MODULES)) {
    const named = examples.flatMap((name) => ["--example", name]);
    execFileSync("cargo", ["build", "--profile", "page", "--features", features, ...named, "--target", "wasm32-unknown-unknown"], {
      cwd: join(root, "crates/colltrans-wasm"),
      env,
      stdio: "inherit",
    });
  }
}

const out = join(here, `dist-${process.pid}`);
mkdirSync(out);
process.on("exit", () => rmSync(out, { recursive: true, force: true }));
await Promise.all(Object.values(MODULES).flat().map(async (example) => {
  const made = join(built, "wasm32-unknown-unknown/page/examples", `${example}.wasm`);
  copyFileSync(await optimised(made), join(out, `${example.replace("page", "colltrans")}.wasm`));
}));
// The npm package, whose module finds its library next to it.
copyFileSync(join(here, "package/dist/bodies.wasm"), join(out, "bodies.wasm"));
copyFileSync(join(here, "src/index.html"), join(out, "index.html"));
cpSync(data, join(out, "data"), { recursive: true, filter: (from) => !/queries\.jsonl$/.test(from) });
// Files that the page links to.
copyFileSync(join(root, "docs/paper.md"), join(out, "paper.md"));
cpSync(join(root, "docs/figures"), join(out, "figures"), { recursive: true });
mkdirSync(join(out, "source"));
for (const file of ["minimise.rs", "cell.rs", "region.rs"]) copyFileSync(join(root, "crates/colltrans-convex/src/solve/cta", file), join(out, "source", file));
await build({
  entryPoints: ["main.ts", "worker.ts", "near-worker.ts", "style.css", "tabs.css"].map((file) => join(here, "src", file)),
  bundle: true,
  minify: true,
  format: "esm",
  // Code that is not needed at once is loaded on demand.
  splitting: true,
  chunkNames: "chunk-[name]-[hash]",
  target: "es2022",
  legalComments: "none",
  plugins: [shaders],
  outdir: out,
  logLevel: "warning",
});
const notices = ["three"].map((name) => {
  const folder = join(here, "node_modules", name);
  const { version } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  return `${name} ${version}\n\n${readFileSync(join(folder, "LICENSE"), "utf8")}`;
});
writeFileSync(join(out, "LICENSES.txt"), notices.join("\n"));
for (let attempt = 1; ; attempt++) {
  rmSync(target, { recursive: true, force: true });
  try {
    renameSync(out, target);
    break;
  } catch (error) {
    if (attempt === ATTEMPTS) throw error;
  }
}

if (process.argv.includes("--serve")) {
  const server = await serve(target, Number(process.env.PORT ?? 8000));
  console.log(`http://127.0.0.1:${server.address().port}/`);
}
