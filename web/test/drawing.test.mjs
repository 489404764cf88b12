// The drawing as SVG: what hides what, against each triangle at each sample, and against the picture.

import assert from "node:assert/strict";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { site } from "../browser.mjs";

const here = dirname(fileURLToPath(import.meta.url));
let at, depths, order;
before(async () => {
  const module = async (name) => {
    const { outputFiles } = await build({ entryPoints: [join(here, `../src/view/${name}.ts`)], bundle: true, format: "esm", write: false });
    return import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);
  };
  [depths, order, at] = [await module("depths"), await module("order"), await site()];
});
after(() => at?.close());

let state = 7n;
function random() {
  state = (state * 6364136223846793005n + 1442695040888963407n) & ((1n << 64n) - 1n);
  return Number(state >> 11n) / 2 ** 53;
}
const [WIDE, HIGH] = [60, 40];
const point = () => ({ x: 80 * random() - 10, y: 60 * random() - 10, q: 0.5 + random() });
const triangle = () => [point(), point(), point()];

/** The q of a triangle where it covers a point. */
function qAt(point, [a, b, c]) {
  const cross = (p, r, s) => (r.x - p.x) * (s.y - p.y) - (r.y - p.y) * (s.x - p.x);
  const whole = cross(a, b, c);
  const shares = [cross(b, c, point), cross(c, a, point), cross(a, b, point)].map((s) => s / whole);
  return Math.min(...shares) >= 0 ? shares[0] * a.q + shares[1] * b.q + shares[2] * c.q : undefined;
}

test("a triangle covers the samples inside it", () => {
  for (let k = 0; k < 200; k++) {
    const corners = triangle();
    const covered = new Map();
    depths.cover(corners, 2, 2 * WIDE, 2 * HIGH, (cell, q) => covered.set(cell, q));
    for (let cell = 0; cell < 4 * WIDE * HIGH; cell++) {
      const q = qAt({ x: ((cell % (2 * WIDE)) + 0.5) / 2, y: (Math.floor(cell / (2 * WIDE)) + 0.5) / 2 }, corners);
      assert.equal(covered.has(cell), q !== undefined);
      if (q !== undefined) assert.ok(Math.abs(covered.get(cell) - q) < 1e-9);
    }
  }
});

test("facets in order: at each sample the nearest is drawn last, even where they go through each other", () => {
  let [cut, samples] = [0, 0];
  for (let round = 0; round < 20; round++) {
    const facets = Array.from({ length: 12 }, (_, k) => ({ corners: triangle(), style: String(k), opaque: true }));
    const drawn = order.ordered(facets, WIDE, HIGH, 1e-9);
    const [painted, nearest] = [new Map(), new Map()];
    for (const { corners, style } of drawn) depths.cover(corners, 1, WIDE, HIGH, (cell) => painted.set(cell, style));
    for (const { corners, style } of facets) {
      depths.cover(corners, 1, WIDE, HIGH, (cell, q) => q > (nearest.get(cell)?.q ?? 0) && nearest.set(cell, { q, style }));
    }
    assert.equal(painted.size, nearest.size);
    samples += nearest.size;
    for (const [cell, { style }] of nearest) if (painted.get(cell) !== style) cut++;
    assert.ok(drawn.length < 6_000, `${drawn.length} facets of 12`);
  }
  // Circles of facets as small as samples are cut open.
  assert.ok(cut < 0.005 * samples, `${cut} of ${samples}`);
});

test("what is translucent is drawn after what it is before, and before what hides it", () => {
  const square = (q, style, opaque, [x, y, s]) => [
    { corners: [{ x, y, q }, { x: x + s, y, q }, { x: x + s, y: y + s, q }], style, opaque },
    { corners: [{ x, y, q }, { x: x + s, y: y + s, q }, { x, y: y + s, q }], style, opaque },
  ];
  const facets = [...square(3, "near", true, [20, 10, 20]), ...square(2, "glass", false, [10, 5, 25]), ...square(1, "far", true, [5, 5, 20]), ...square(0.5, "hidden", true, [23, 12, 10])];
  const styles = order.ordered(facets, WIDE, HIGH, 1e-9).map(({ style }) => style);
  assert.deepEqual(styles, ["far", "far", "glass", "glass", "near", "near"]);
});

test("of a line is drawn what nothing hides; an edge is not hidden by its own facets", () => {
  const buffer = new depths.Depths(WIDE, HIGH, 1e-6);
  const corner = (x, y, q = 1) => ({ x, y, q });
  buffer.draw([corner(20, -10), corner(40, -10), corner(40, 60)], 0);
  buffer.draw([corner(20, -10), corner(40, 60), corner(20, 60)], 1);
  const pieces = (q, owners) => buffer.seen(corner(0, 20, q), corner(60, 20, q), owners).map((piece) => piece.map((s) => 60 * s));
  const [[from, left], [right, to], ...more] = pieces(0.5);
  assert.deepEqual([from, to, more.length], [0, 60, 0]);
  // To a pixel.
  assert.ok(Math.abs(left - 20) <= 1 && Math.abs(right - 40) <= 1, `${left} ${right}`);
  assert.deepEqual(pieces(2), [[0, 60]]);
  assert.deepEqual(pieces(0.5, [0, 1]), [[0, 60]]);
  // Where a valley is steep its edge is the farthest of all around it.
  const valley = new depths.Depths(WIDE, HIGH, 1e-6);
  valley.draw([corner(0, 20, 1), corner(60, 20, 1), corner(30, 19, 50)], 3);
  valley.draw([corner(0, 20, 1), corner(60, 20, 1), corner(30, 21, 50)], 4);
  assert.deepEqual(valley.seen(corner(0, 20, 1), corner(60, 20, 1), [3, 4]), [[0, 1]]);
});

test("the drawing of bodies that are not convex is as the picture is", async () => {
  const page = await at.open("#example=plate&t=6");
  for (const hash of ["#example=bracket", "#example=plate&t=6", "#example=shaft", "#example=shaft&t=20&d=1,0.2,0.3"]) {
    await at.ask(page, hash);
    const { share, edges, broken } = await page.evaluate(async () => {
      const { view } = window.colltrans.probe();
      const text = await view.drawing();
      const drawing = new DOMParser().parseFromString(text, "image/svg+xml");
      // Words are beside the picture on the page.
      drawing.querySelectorAll("text").forEach((word) => word.remove());
      const image = new Image();
      image.src = `data:image/svg+xml,${encodeURIComponent(new XMLSerializer().serializeToString(drawing))}`;
      await image.decode();
      const pixels = (source) => {
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [image.width, image.height];
        const context = canvas.getContext("2d");
        context.drawImage(source, 0, 0, canvas.width, canvas.height);
        return context.getImageData(0, 0, canvas.width, canvas.height).data;
      };
      const [drawn, shown] = [pixels(image), pixels(await createImageBitmap(await view.picture()))];
      let [other, all] = [0, 0];
      for (let k = 0; k < shown.length; k += 4) {
        const isGround = [0, 1, 2].every((c) => Math.abs(shown[k + c] - shown[c]) < 12);
        if (!isGround) all++;
        if ([0, 1, 2].some((c) => Math.abs(shown[k + c] - drawn[k + c]) > 60)) other++;
      }
      // An edge that nothing is before is one piece.
      const edges = [...drawing.querySelectorAll("path[stroke-linecap=round]")].map((path) => path.getAttribute("d").split("M").slice(1));
      const broken = edges.flat().filter((piece) => {
        const [x, y, u, v] = piece.match(/-?[\d.]+/g).map(Number);
        return Math.hypot(u - x, v - y) < 0.5;
      }).length;
      return { share: other / all, edges: edges.flat().length, broken };
    });
    console.log(`${hash}: ${(100 * share).toFixed(2)} % of the pixels differ, ${edges} pieces of lines, ${broken} of them dots`);
    assert.ok(share < 0.02, `${hash}: ${share}`);
    assert.ok(broken < 0.1 * edges, `${hash}: ${broken} of ${edges}`);
  }
  assert.deepEqual(page.complaints, []);
});
