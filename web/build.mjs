// Builds the page into `dist/`: the library for WebAssembly by cargo, the scripts by esbuild.
//
//   node build.mjs            once
//   node build.mjs --serve    and serves it on this machine
//   node build.mjs --no-wasm  only the scripts; the library as it was built last

import { execFileSync } from "node:child_process";
import { copyFileSync, cpSync, existsSync, mkdirSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { toolchain } from "./toolchain.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const crate = join(here, "../crates/colltrans-wasm");
const data = join(here, "../data");
const out = join(here, "dist");

if (!process.argv.includes("--no-wasm")) {
  const { args, env } = toolchain();
  execFileSync("cargo", ["build", "--release", "--lib", "--target", "wasm32-unknown-unknown", ...args], {
    cwd: crate,
    env: { ...process.env, ...env },
    stdio: "inherit",
  });
}

rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });
copyFileSync(join(crate, "target/wasm32-unknown-unknown/release/colltrans_wasm.wasm"), join(out, "colltrans.wasm"));
for (const file of ["index.html", "style.css"]) copyFileSync(join(here, "src", file), join(out, file));
cpSync(data, join(out, "data"), { recursive: true, filter: (from) => !/queries\.jsonl$/.test(from) });
await build({
  entryPoints: [join(here, "src/main.ts"), join(here, "src/worker.ts")],
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "none",
  outdir: out,
  logLevel: "warning",
});
const notices = ["three"].map((name) => {
  const folder = join(here, "node_modules", name);
  const { version } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  return `${name} ${version}\n\n${readFileSync(join(folder, "LICENSE"), "utf8")}`;
});
const { writeFileSync } = await import("node:fs");
writeFileSync(join(out, "LICENSES.txt"), notices.join("\n"));

const types = {
  ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".wasm": "application/wasm", ".svg": "image/svg+xml",
};

/** A static server for a folder, on this machine only. */
export function serve(folder, port, under = "/") {
  return new Promise((resolve) => {
    const server = createServer((request, response) => {
      const path = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
      const inside = normalize(path.slice(under.length - 1));
      const file = join(folder, inside.endsWith("/") ? `${inside}index.html` : inside);
      if (!path.startsWith(under) || !file.startsWith(folder) || !existsSync(file)) {
        response.writeHead(404).end();
        return;
      }
      response.writeHead(200, { "content-type": types[extname(file)] ?? "application/octet-stream" });
      response.end(readFileSync(file));
    });
    server.listen(port, "127.0.0.1", () => resolve(server));
  });
}

if (process.argv.includes("--serve")) {
  const server = await serve(out, Number(process.env.PORT ?? 8000));
  console.log(`http://127.0.0.1:${server.address().port}/`);
}
