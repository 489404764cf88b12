// The planar problem of a step: both sections projected along the direction. Also sections of drawn bodies.

import { palette } from "../colours";
import { svg } from "../dom";
import type { Body } from "../engine";
import { type Pose, type Vec, add, cross, dot, hull, placed, sub, times, turned, unit } from "../math";
import { type Two, below } from "./recording";

const [WIDE, HIGH] = [340, 230];

/** Returns the corners of a body's section at a level along an axis of the world, in order and in the world. */
export function section({ vertices, triangles }: Body, pose: Pose, axis: Vec, level: number): Vec[] {
  const back: Pose = [0, 0, 0, -pose[3], -pose[4], -pose[5], pose[6]];
  const [x, y, z] = turned(back, axis);
  const height = (v: number) => x * vertices[3 * v]! + y * vertices[3 * v + 1]! + z * vertices[3 * v + 2]! - level;
  const points: Vec[] = [];
  for (let k = 0; k < triangles.length; k += 3) {
    for (let e = 0; e < 3; e++) {
      const [v, w] = [triangles[k + e]!, triangles[k + ((e + 1) % 3)]!];
      // Every edge occurs twice; use it once.
      if (v > w) continue;
      const [a, b] = [height(v), height(w)];
      if (a < 0 === b < 0) continue;
      const s = a / (a - b);
      const at = (c: number) => vertices[3 * v + c]! + s * (vertices[3 * w + c]! - vertices[3 * v + c]!);
      points.push([at(0), at(1), at(2)]);
    }
  }
  if (points.length < 3) return [];
  // Sort the corners by the hull of their projection across the plane.
  const n = unit([x, y, z]);
  const first = unit(cross(n, Math.abs(n[0]) < 0.6 ? [1, 0, 0] : [0, 1, 0]));
  const second = cross(n, first);
  const base = times(n, dot(n, points[0]!));
  return hull(points.map((p): Two => [dot(p, first), dot(p, second)])).map(([a, b]) => placed(pose, add(base, add(times(first, a), times(second, b)))));
}

export class Planar {
  readonly element = svg("svg", { class: "figure", viewBox: `0 0 ${WIDE} ${HIGH}`, role: "img", "aria-label": "Both sections in the shadow plane" });

  /** Shows both sections; `h` points up, `g` to the right. `touches` is the result of the search. */
  show([moving, fixed]: [Vec[], Vec[]], [a, b]: [Vec, Vec], direction: Vec, touches: boolean) {
    const { element } = this;
    const colours = palette();
    element.replaceChildren();
    if (moving.length < 3 || fixed.length < 3) {
      element.append(svg("text", { x: 6, y: HIGH - 7, "font-size": 12, fill: colours.text }, "a section at the end of its body has no area: it is a point, an edge or a face"));
      return;
    }
    const d = unit(direction);
    const c = sub(times(a, 1 / dot(a, d)), times(b, 1 / dot(b, d)));
    const [up, right] = [unit(c), unit(cross(d, c))];
    const flat = (v: Vec): Two => [dot(v, right), dot(v, up)];
    const [p, q] = [hull(moving.map(flat)), hull(fixed.map(flat))];
    const all = [...p, ...q];
    const [lowX, highX] = [Math.min(...all.map(([x]) => x)), Math.max(...all.map(([x]) => x))];
    const [lowY, highY] = [Math.min(...all.map(([, y]) => y)), Math.max(...all.map(([, y]) => y))];
    const scale = Math.min((WIDE - 40) / (highX - lowX || 1), (HIGH - 56) / (highY - lowY || 1));
    const place = ([x, y]: Two): Two => [WIDE / 2 + (x - (lowX + highX) / 2) * scale, HIGH / 2 - 4 - (y - (lowY + highY) / 2) * scale];
    const points = (polygon: Two[]) => polygon.map((v) => place(v).map((x) => x.toFixed(1)).join(",")).join(" ");
    element.append(
      svg("polygon", { points: points(q), fill: colours.fixed, "fill-opacity": 0.65, stroke: colours.text, "stroke-width": 1.2 }),
      svg("polygon", { points: points(p), fill: colours.moving, "fill-opacity": 0.55, stroke: colours.text, "stroke-width": 1.2 }));
    const common = intersection(p, q);
    const lowest = common.reduce<Two | undefined>((best, v) => (!best || v[1] < best[1] ? v : best), undefined);
    if (lowest) {
      const [x, y] = place(lowest);
      element.append(
        svg("polygon", { points: points(common), fill: colours.plane, "fill-opacity": 0.35, stroke: "none" }),
        svg("line", { x1: 6, x2: WIDE - 6, y1: y, y2: y, stroke: colours.normal, "stroke-width": 1.2, "stroke-dasharray": "5 4" }),
        svg("circle", { cx: x, cy: y, r: touches ? 6 : 4, fill: colours.normal, stroke: "#fff", "stroke-width": 1.5 }));
    }
    element.append(svg("text", { x: 6, y: HIGH - 7, "font-size": 12, fill: colours.text }, lowest ? "the lowest common point of both shadows" : touches ? "they touch in a point" : "nothing in common: these sections never meet"));
  }
}

/** Returns the intersection of two convex polygons, both counter-clockwise. */
function intersection(p: Two[], q: Two[]): Two[] {
  let left = p;
  q.forEach((a, k) => {
    const b = q[(k + 1) % q.length]!;
    left = below(left, [b[1] - a[1], a[0] - b[0]], a, 0);
  });
  return left;
}
