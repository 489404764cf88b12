// Removes parts of three.js that the page does not use, which saves a fifth of its download. A bundler cannot detect
// them, because the renderer refers to all: shaders of other materials, virtual reality, shadows, environment maps.
// Minifiers do not touch shaders, which are strings, so their indentation and comments are removed here too.
//
// Used are: MeshLambertMaterial, MeshBasicMaterial, LineBasicMaterial, LineDashedMaterial. A browser reports an error
// if a shader is missing, and the tests check for errors.

import { readFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const three = join(dirname(fileURLToPath(import.meta.url)), "node_modules/three/src/Three.js");
const MATERIALS = ["meshlambert", "meshbasic", "linedashed"];
/** Pieces for features of other materials; removed if all of a piece is between `#ifdef USE_...`. */
const PIECES =
  /^(shadowmap_|shadowmask_|transmission_|envmap_|cube_uv_|bumpmap_|normalmap_|displacementmap_|morph|skin|logdepthbuf_|alphahash_|alphamap_|alphatest_|batching_|lightmap_|aomap_|emissivemap_|specularmap_|roughnessmap_|metalnessmap_|gradientmap_|fog_|lightprobes_|map_|uv_|dithering_|premultiplied_)/;
/** Pieces that only other materials, or tone mapping, include. */
const OTHERS = /^(lights_(physical|phong|toon)_|iridescence_|clearcoat_|tonemapping_pars_)/;
/** Stubs for classes without which the renderer does not start. */
const STUBS = {
  "renderers/webxr/WebXRManager.js": `export class WebXRManager {
    enabled = false; isPresenting = false; cameraAutoUpdate = false;
    addEventListener() {} removeEventListener() {} setAnimationLoop() {} getEnvironmentBlendMode() {} dispose() {}
  }`,
  "renderers/webgl/WebGLShadowMap.js": "export function WebGLShadowMap() { this.enabled = false; this.render = () => {}; }",
  "renderers/shaders/DFGLUTData.js": "export function getDFGLUT() { return null; }",
  "extras/PMREMGenerator.js": "export class PMREMGenerator {}",
};

/** Checks whether all lines are between an `#if` and its `#endif`. */
function nothingElse(text) {
  const lines = text.match(/\/\* glsl \*\/`([^`]*)`/)?.[1].split("\n") ?? ["?"];
  let depth = 0;
  return lines.map((line) => line.trim()).every((line) => {
    if (/^#if/.test(line)) depth++;
    else if (/^#endif/.test(line)) depth--;
    else return depth > 0 || line === "" || line.startsWith("//");
    return depth >= 0;
  });
}

export const shaders = {
  name: "shaders",
  setup(build) {
    build.onResolve({ filter: /^three$/ }, () => ({ path: three, sideEffects: false }));
    build.onLoad({ filter: /three[\\/]src[\\/]/ }, async ({ path }) => {
      const stub = Object.entries(STUBS).find(([file]) => path.replaceAll("\\", "/").endsWith(file));
      if (stub) return { contents: stub[1], loader: "js" };
      const [, folder, name] = path.match(/(Shader(?:Chunk|Lib))[\\/](\w+)\.glsl\.js$/) ?? [];
      if (!name) return undefined;
      if (folder === "ShaderLib" && !MATERIALS.includes(name)) return { contents: 'export const vertex = "", fragment = "";', loader: "js" };
      if (folder === "ShaderChunk" && OTHERS.test(name)) return { contents: 'export default "";', loader: "js" };
      const text = await readFile(path, "utf8");
      if (folder === "ShaderChunk" && PIECES.test(name) && nothingElse(text)) return { contents: 'export default "";', loader: "js" };
      return { contents: text.replace(/\n[\t ]+/g, "\n").replace(/\n\/\/[^\n]*/g, "").replace(/\n\/\*[\s\S]*?\*\//g, "").replace(/\n{2,}/g, "\n"), loader: "js" };
    });
  },
};
