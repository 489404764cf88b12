// Builds the npm package into `dist/`: the libraries by cargo and wasm-opt, the types of answers from their description
// in Rust, everything else by the compiler of TypeScript.
//
//   node build.mjs            builds once; then `npm pack`
//   node build.mjs --no-wasm  with the last build of the libraries

import { execFileSync } from "node:child_process";
import { copyFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { optimised } from "../optimise.mjs";
import { Missing, built, toolchain } from "../toolchain.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const crate = join(here, "../../crates/colltrans-wasm");
const source = join(here, "src");
/** The libraries by the features of `colltrans-wasm`. */
const MODULES = { "": "package_cast", "min-gap": "package_all" };

/** The names of their files. */
const NAMES = { package_cast: "casts", package_all: "bodies" };

const cargo = (args, options) => execFileSync("cargo", args, { cwd: crate, ...options });

if (!process.argv.includes("--no-wasm")) {
  let env;
  try {
    env = { ...process.env, ...toolchain() };
  } catch (error) {
    console.error(error.message);
    process.exit(error instanceof Missing ? 3 : 1);
  }
  for (const [features, example] of Object.entries(MODULES)) {
    cargo(["build", "--profile", "page", "--features", features, "--example", example, "--target", "wasm32-unknown-unknown"], { env, stdio: "inherit" });
  }
}

const native = ["--profile", "native", "--features", "min-gap", "--example", "package"];
const { answers, questions } = JSON.parse(cargo(["run", "--quiet", ...native, "--", "--describe"], { encoding: "utf8" }));
writeFileSync(join(source, "answers.ts"), typescript(answers, questions));

rmSync(join(here, "dist"), { recursive: true, force: true });
execFileSync(process.execPath, [join(here, "../node_modules/typescript/bin/tsc"), "-p", here], { stdio: "inherit" });

// The licences of the crates in the libraries.
const notices = [join(here, "../../.ci/release.py"), "notices", join(crate, "Cargo.toml"), "--target", "wasm32-unknown-unknown"];
writeFileSync(join(here, "dist/LICENSE-THIRD-PARTY"), execFileSync("python3", notices));

for (const example of Object.values(MODULES)) {
  const made = await optimised(join(built, "wasm32-unknown-unknown/page/examples", `${example}.wasm`));
  copyFileSync(made, join(here, "dist", `${NAMES[example]}.wasm`));
}

/** Returns the module of answers: their types, their decoder, and the numbers of questions. */
function typescript(answers, questions) {
  const camel = (name) => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());
  const types = { numberOrNull: "number | null", booleanOrNull: "boolean | null", VectorOrNull: "Vector | null", FeaturesOrNull: "Features | null" };
  const interfaces = answers.map(({ name, outcome, doc, fields }) => [
    `/** ${doc.replace(/\s+/g, " ")} */`,
    `export interface ${name} {`,
    `  readonly outcome: ${JSON.stringify(outcome)};`,
    ...fields.flatMap((field) => [
      `  /** ${field.doc.replace(/\s+/g, " ")} */`,
      `  readonly ${camel(field.name)}: ${types[field.type] ?? field.type};`,
    ]),
    "}",
  ].join("\n"));
  const table = answers.map(({ outcome, fields }) => `  [${[outcome, ...fields.map((field) => `${camel(field.name)}:${field.type}`)].map((text) => JSON.stringify(text)).join(", ")}],`);
  return `// Made by build.mjs of crates/colltrans-wasm/src/package/answers.rs.

import type { Vector } from "./pose.js";

/** A vertex, an edge or a face of a body. */
export interface Feature {
  readonly kind: "vertex" | "edge" | "face";
  /** The indices of its vertices in the input of the body. */
  readonly vertices: readonly number[];
}

/** The features of both bodies in contact. */
export interface Features {
  readonly moving: Feature;
  readonly fixed: Feature;
}

${interfaces.join("\n\n")}

/** The numbers of questions. */
export const QUESTIONS = ${JSON.stringify(questions)} as const;

const ANSWERS: readonly (readonly string[])[] = [
${table.join("\n")}
];

/** The outcomes of answers, by their numbers. */
export const OUTCOMES: readonly string[] = ANSWERS.map(([outcome]) => outcome as string);

const KINDS = ["vertex", "edge", "face"] as const;

/** Reads an answer: its number, then its fields in order. */
export function decode(numbers: Float64Array): unknown {
  let at = 0;
  const next = () => numbers[at++] as number;
  const nullable = <T>(read: (first: number) => T) => {
    const first = next();
    return Number.isNaN(first) ? null : read(first);
  };
  const vector = (x: number): Vector => [x, next(), next()];
  const feature = (kind: number): Feature => ({ kind: KINDS[kind] ?? "face", vertices: Array.from({ length: next() }, next) });
  const features = (kind: number): Features => ({ moving: feature(kind), fixed: feature(next()) });
  const readers: Record<string, () => unknown> = {
    number: next,
    numberOrNull: () => nullable((x) => x),
    boolean: () => next() === 1,
    booleanOrNull: () => nullable((x) => x === 1),
    Vector: () => vector(next()),
    VectorOrNull: () => {
      const all = vector(next());
      return Number.isNaN(all[0]) ? null : all;
    },
    Features: () => features(next()),
    FeaturesOrNull: () => nullable(features),
  };
  const [outcome, ...fields] = ANSWERS[next()] ?? [];
  const read = fields.map((field) => {
    const [name = "", type = ""] = field.split(":");
    return [name, readers[type]?.()];
  });
  return Object.freeze({ outcome, ...Object.fromEntries(read) as object });
}
`;
}
