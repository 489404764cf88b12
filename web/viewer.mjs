// Builds the viewer of an assembly's report, which is committed so that a Rust toolchain alone builds the command. With
// --check it only compares the committed viewer with its source.

import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { shaders } from "./shaders.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const kept = join(here, "../crates/colltrans-assembly/assets/viewer.js");
const { outputFiles } = await build({
  entryPoints: [join(here, "src/viewer.ts")],
  bundle: true,
  minify: true,
  charset: "ascii",
  format: "iife",
  target: "es2022",
  legalComments: "none",
  plugins: [shaders],
  write: false,
  logLevel: "warning",
});
const { version } = JSON.parse(readFileSync(join(here, "node_modules/three/package.json"), "utf8"));
const notice = `/* Built from web/src/viewer.ts by web/viewer.mjs. Holds three.js ${version}, MIT licence, copyright three.js authors. */\n`;
const text = notice + outputFiles[0].text;
if (!process.argv.includes("--check")) {
  writeFileSync(kept, text);
} else if (readFileSync(kept, "utf8") !== text) {
  console.error("crates/colltrans-assembly/assets/viewer.js is not what web/src/viewer.ts makes: npm run viewer");
  process.exit(1);
}
