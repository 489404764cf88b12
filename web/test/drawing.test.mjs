// The drawing as SVG, compared with the picture. Hidden parts are tested in crates/colltrans-picture, against each
// triangle at each sample.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { site } from "../browser.mjs";

let at;
before(async () => {
  at = await site();
});
after(() => at?.close());

test("drawing of solids equals the picture", async () => {
  const page = await at.open("#example=plate&t=6");
  for (const hash of ["#example=bracket", "#example=plate&t=6", "#example=shaft", "#example=shaft&t=20&d=1,0.2,0.3"]) {
    await at.ask(page, hash);
    const { share, edges, broken } = await page.evaluate(async () => {
      const { view } = window.colltrans.probe();
      const text = await view.drawing();
      const drawing = new DOMParser().parseFromString(text, "image/svg+xml");
      // Labels are outside the picture on the page.
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
      // A completely visible edge is one piece.
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
