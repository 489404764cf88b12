// three.js keeps its shaders as text with indents and comments, which no minifier may touch: both are
// taken out here. Neither means anything to GLSL, nor at the beginning of a line to JavaScript.

import { readFile } from "node:fs/promises";

export const shaders = {
  name: "shaders",
  setup(build) {
    build.onLoad({ filter: /three[\\/]build[\\/]three\.(module|core)\.js$/ }, async ({ path }) => {
      const text = await readFile(path, "utf8");
      return { contents: text.replace(/\n[\t ]+/g, "\n").replace(/\n\/\/[^\n]*/g, "").replace(/\n\/\*[\s\S]*?\*\//g, "").replace(/\n{2,}/g, "\n"), loader: "js" };
    });
  },
};
