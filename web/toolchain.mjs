// The toolchain that compiles Rust to WebAssembly: the installed one if it has the target, otherwise Debian's packages,
// unpacked into a folder of their own because they conflict with an installed rustc. These have the standard library for
// WebAssembly only as source, which is compiled once and kept next to them.
//
// On an ordinary machine run: rustup target add wasm32-unknown-unknown

import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readdirSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { homedir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

/** Cargo's target folder. */
export const built = process.env.CARGO_TARGET_DIR ?? join(dirname(fileURLToPath(import.meta.url)), "../target");

const TARGET = "wasm32-unknown-unknown";

/** Unstable options, which a stable compiler accepts with RUSTC_BOOTSTRAP: panic messages without source locations, and
 * short debug output. Only the last message of a stopped library has either, and both cost bytes that every visitor
 * loads. */
const SMALLER = "-Zlocation-detail=none -Zfmt-debug=shallow";

/** Linker option: writes function numbers in as few bytes as needed instead of five. */
const LINKED = "-Clink-arg=--compress-relocations";

const run = (command, args, options = {}) => execFileSync(command, args, { encoding: "utf8", ...options });

function installed() {
  try {
    return existsSync(run("rustc", ["--print", "target-libdir", "--target", TARGET]).trim());
  } catch {
    return false;
  }
}

/** Returns the latest name that matches a pattern. */
function newest(names, pattern) {
  return names.filter((name) => pattern.test(name)).sort((a, b) => a.localeCompare(b, "en", { numeric: true })).at(-1);
}

function unpacked(folder) {
  const rustc = join(folder, "usr/bin/rustc");
  const linker = newest(existsSync("/usr/bin") ? readdirSync("/usr/bin") : [], /^wasm-ld(-\d+)?$/);
  if (!existsSync(rustc) || !linker) return undefined;
  const env = {
    LD_LIBRARY_PATH: join(folder, "usr/lib/x86_64-linux-gnu"),
    RUSTC: rustc,
    RUSTC_BOOTSTRAP: "1",
    CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER: join("/usr/bin", linker),
    CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS: SMALLER,
  };
  const sysroot = standardLibrary(folder, { ...process.env, ...env });
  return { ...env, CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS: `${SMALLER} ${LINKED} --sysroot=${sysroot}` };
}

/** The program for which the standard library is compiled: as small as the page's modules (see profile `page` in
 * crates/colltrans-wasm), linked together as one. */
const PROGRAM = `
[package]
name = "program"
version = "0.0.0"
edition = "2024"
[lib]
path = "program.rs"
crate-type = ["cdylib"]
[profile.release]
opt-level = "z"
lto = "fat"
codegen-units = 1
panic = "abort"
[workspace]
`;
const OF_SOURCE = ["-Zbuild-std=std,panic_abort", "-Zbuild-std-features=optimize_for_size"];

/** Returns the folder of the standard library for this compiler and such programs. */
function standardLibrary(folder, env) {
  const compiler = run(env.RUSTC, ["-vV"], { env });
  const key = createHash("sha256").update([compiler, PROGRAM, SMALLER, ...OF_SOURCE].join()).digest("hex").slice(0, 16);
  const sysroot = join(folder, `std-${key}`);
  if (existsSync(sysroot)) return sysroot;
  // The folder is renamed when it is complete.
  const making = mkdtempSync(join(folder, "making-"));
  try {
    writeFileSync(join(making, "Cargo.toml"), PROGRAM);
    writeFileSync(join(making, "program.rs"), "");
    const target = join(making, "target");
    run("cargo", ["build", "--release", "--target", TARGET, ...OF_SOURCE], { cwd: making, env: { ...env, CARGO_TARGET_DIR: target }, stdio: "inherit" });
    const [compiled, libraries] = [join(target, TARGET, "release/deps"), join(making, "std/lib/rustlib", TARGET, "lib")];
    mkdirSync(libraries, { recursive: true });
    for (const file of readdirSync(compiled).filter((name) => name.endsWith(".rlib"))) copyFileSync(join(compiled, file), join(libraries, file));
    renameSync(join(making, "std"), sysroot);
  } finally {
    rmSync(making, { recursive: true });
  }
  return sysroot;
}

function unpack(folder) {
  mkdirSync(folder, { recursive: true });
  const quiet = { stdio: ["ignore", "ignore", "inherit"] };
  run("apt-get", ["update", "-qq"], quiet);
  const search = (words) => run("apt-cache", ["search", "--names-only", words]).split("\n").map((line) => line.split(" ")[0]);
  const library = newest(search("^libstd-rust-web-[0-9.]+$"), /^libstd-rust-web-[\d.]+$/);
  const linker = newest(search("^lld-[0-9]+$"), /^lld-\d+$/);
  if (!library || !linker) throw new Error("Debian has no packages rustc-web and lld here");
  run("apt-get", ["download", "-qq", "rustc-web", "libstd-rust-web-dev", library, "rust-web-src"], { ...quiet, cwd: folder });
  for (const file of readdirSync(folder).filter((name) => name.endsWith(".deb"))) run("dpkg", ["-x", join(folder, file), folder]);
  run("apt-get", ["install", "-qq", "-y", "--no-install-recommends", linker], quiet);
}

/** The error that there is no compiler for the target; nothing is wrong with the page. */
export class Missing extends Error {}

/** Returns the environment for cargo; installs the toolchain if `install` is set. */
export function toolchain(install = process.argv.includes("--install")) {
  if (installed()) return { RUSTC_BOOTSTRAP: "1", CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS: `${SMALLER} ${LINKED}` };
  const folder = process.env.COLLTRANS_WASM_TOOLCHAIN ?? join(homedir(), ".cache/colltrans-wasm-toolchain");
  const found = unpacked(folder);
  if (found) return found;
  if (install) {
    unpack(folder);
    const now = unpacked(folder);
    if (now) return now;
  }
  throw new Missing(`rustc has no target ${TARGET}: rustup target add ${TARGET} (or --install, from Debian's packages)`);
}
