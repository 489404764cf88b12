// Portal refinement: the Minkowski difference projected along the direction, and the portals on it.

import { palette } from "../colours";
import { svg } from "../dom";
import type { Pair } from "../engine";
import { type Vec, dot, hull, placed, short } from "../math";
import type { Drawn } from "../view/body";
import type { Portals, Two } from "./recording";

const SIZE = 340;

export class Refinement {
  readonly element = svg("svg", { class: "figure", viewBox: `0 0 ${SIZE} ${SIZE}`, role: "img", "aria-label": "M seen along d" });

  /** The outline of M for the last bodies. */
  private known: { key: string; rim: Two[] } | undefined;

  /** Shows the portals up to an index (-1 for none) and returns a description. */
  show({ frame, steps, loose }: Portals, portal: number, bodies: [Drawn, Drawn], pair: Pair): string {
    const { element: picture } = this;
    const colours = palette();
    const rim = this.rim(frame, bodies, pair);
    const all: Two[] = [...rim, [0, 0]];
    const [lowX, highX] = [Math.min(...all.map(([x]) => x)), Math.max(...all.map(([x]) => x))];
    const [lowY, highY] = [Math.min(...all.map(([, y]) => y)), Math.max(...all.map(([, y]) => y))];
    const scale = (SIZE - 30) / Math.max(highX - lowX, highY - lowY, 1e-300);
    const place = ([x, y]: Two | Vec): Two => [SIZE / 2 + (x - (lowX + highX) / 2) * scale, SIZE / 2 - (y - (lowY + highY) / 2) * scale];
    const points = (polygon: (Two | Vec)[]) => polygon.map((v) => place([v[0], v[1]]).map((x) => x.toFixed(1)).join(",")).join(" ");
    const marks: Element[] = [svg("polygon", { points: points(rim), fill: colours.grid, "fill-opacity": 0.5, stroke: colours.text, "stroke-width": 1.2 })];
    steps.slice(0, portal + 1).forEach(({ corners }, k) => {
      const now = k === portal;
      marks.push(svg("polygon", {
        points: points(corners), fill: colours.moving, "fill-opacity": now ? 0.45 : 0.08,
        stroke: now ? colours.movingMark : colours.moving, "stroke-width": now ? 2.2 : 1, "stroke-dasharray": now ? "none" : "4 3",
      }));
    });
    for (const v of [...loose, ...(steps[portal]?.supports ?? [])]) {
      const [x, y] = place(v);
      marks.push(svg("circle", { cx: x, cy: y, r: 4, fill: colours.fixedMark, stroke: "#fff", "stroke-width": 1 }));
    }
    const [x, y] = place([0, 0]);
    marks.push(svg("path", { d: `M${x - 9} ${y}H${x + 9}M${x} ${y - 9}V${y + 9}`, stroke: colours.normal, "stroke-width": 2.5 }));
    picture.replaceChildren(...marks);
    const heights = steps[portal]?.corners.map((v) => short(v[2], 4));
    if (!steps.length) return "No portal: the line misses the difference, and a direction was found that separates.";
    return heights
      ? `Portal ${portal + 1} of ${steps.length}: its corners are at heights ${heights.join(", ")} along d; the orange points are the supports computed for it.`
      : "Not begun yet.";
  }

  private rim(frame: Portals["frame"], bodies: [Drawn, Drawn], pair: Pair): Two[] {
    const key = JSON.stringify([frame, pair, bodies.map(({ body }) => [body.facts.low, body.facts.high, body.facts.vertices])]);
    if (this.known?.key === key) return this.known.rim;
    const shadow = ({ body: { vertices } }: Drawn, pose: Pair["moving_pose"]) => {
      const flat: Two[] = [];
      for (let k = 0; k < vertices.length; k += 3) {
        const v = placed(pose, [vertices[k]!, vertices[k + 1]!, vertices[k + 2]!]);
        flat.push([dot(v, frame[0]), dot(v, frame[1])]);
      }
      return hull(flat);
    };
    const [p, q] = [shadow(bodies[0], pair.moving_pose), shadow(bodies[1], pair.fixed_pose)];
    const thin = (all: Two[]) => all.filter((_, k) => k % Math.ceil(all.length / 120) === 0);
    const rim = hull(thin(q).flatMap(([x, y]) => thin(p).map(([u, v]): Two => [x - u, y - v])));
    this.known = { key, rim };
    return rim;
  }
}
