// Shrinks the modules of the page with Binaryen's wasm-opt. It keeps the order of floating-point operations, so that
// answers keep their bits.

import { execFile } from "node:child_process";
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readFileSync, renameSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { built } from "./toolchain.mjs";

const binaryen = join(dirname(fileURLToPath(import.meta.url)), "node_modules/binaryen");

/** WebAssembly features that the output of rustc uses, beyond the defaults of wasm-opt. */
const FEATURES = ["--enable-bulk-memory", "--enable-bulk-memory-opt", "--enable-nontrapping-float-to-int"];

/** Passes. The skipped ones make a module shorter but larger after brotli, because their output has fewer repetitions. */
const PASSES = ["-Os", "--skip-pass=inlining-optimizing", "--skip-pass=local-cse"];

/** Returns the path of the optimised form of a module. It is cached, and built again if the module, the passes or the
 * version of Binaryen change. */
export async function optimised(module) {
  const version = readFileSync(join(binaryen, "package.json"));
  const key = createHash("sha256").update(readFileSync(module)).update(version).update([...FEATURES, ...PASSES].join());
  const folder = join(built, "wasm32-unknown-unknown/page/optimised");
  const made = join(folder, `${basename(module, ".wasm")}-${key.digest("hex").slice(0, 16)}.wasm`);
  if (existsSync(made)) return made;
  mkdirSync(folder, { recursive: true });
  // The file is renamed when it is complete.
  const making = `${made}.${process.pid}`;
  await promisify(execFile)(process.execPath, [join(binaryen, "bin/wasm-opt"), module, ...FEATURES, ...PASSES, "-o", making]);
  renameSync(making, made);
  return made;
}
