// A static server for a folder, on this machine only.

import { existsSync, readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";

const types = {
  ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".wasm": "application/wasm", ".svg": "image/svg+xml",
  ".md": "text/plain; charset=utf-8", ".rs": "text/plain; charset=utf-8",
};

/** Serves a folder under a path; port 0 selects a free port. */
export function serve(folder, port, under = "/") {
  return new Promise((resolve) => {
    const server = createServer((request, response) => {
      const path = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
      const inside = normalize(path.slice(under.length - 1));
      const file = join(folder, inside.endsWith("/") ? `${inside}index.html` : inside);
      if (!path.startsWith(under) || !file.startsWith(folder) || !existsSync(file) || !statSync(file).isFile()) {
        response.writeHead(404).end();
        return;
      }
      response.writeHead(200, { "content-type": types[extname(file)] ?? "application/octet-stream" });
      response.end(readFileSync(file));
    });
    server.listen(port, "127.0.0.1", () => resolve(server));
  });
}
