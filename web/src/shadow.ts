// The view along the direction: both shadows, and the plane between them or the contact point.

import { type Palette, palette } from "./colours";
import { h, svg } from "./dom";
import type { PageCast } from "./answers";
import { type Slot, plane, touch } from "./engine";
import { type Pose, type Vec, add, cross, dot, hull, placed, short, times, unit } from "./math";
import type { State } from "./state";
import type { Drawn } from "./view/body";

type Flat = [number, number];
/** Number of triangles above which solids are drawn only after the question has settled. */
const MANY = 20_000;
const WIDE = 320;

/** Returns the right and the up vector for a view along a unit vector. */
export function eyes(d: Vec): [Vec, Vec] {
  const up: Vec = Math.abs(d[2]) < 0.95 ? [0, 0, 1] : [0, 1, 0];
  const right = unit(cross(d, up));
  return [right, cross(right, d)];
}

function flat(body: Drawn, pose: Pose, right: Vec, up: Vec): Flat[] {
  const { vertices } = body.body;
  const points: Flat[] = [];
  for (let k = 0; k < vertices.length; k += 3) {
    const at = placed(pose, [vertices[k]!, vertices[k + 1]!, vertices[k + 2]!]);
    points.push([dot(at, right), dot(at, up)]);
  }
  return points;
}

export class Shadow {
  readonly element: HTMLElement;
  private readonly picture = svg("svg", { role: "img" });
  private readonly canvas = h("canvas");
  private readonly note = h("figcaption");
  private late = 0;
  private known: unknown[] = [];

  constructor() {
    this.element = h("figure", { class: "shadow" }, h("div", { class: "shadow-pictures" }, this.canvas, this.picture), this.note);
  }

  show(state: State, bodies: Record<Slot, Drawn>, answer: PageCast | undefined) {
    const { moving, fixed } = state.poses;
    const now = [bodies.moving, bodies.fixed, answer, palette(), [...state.direction, ...moving, ...fixed].join()];
    if (now.every((value, k) => value === this.known[k])) return;
    this.known = now;
    const d = unit(state.direction);
    const [right, up] = eyes(d);
    const points = {
      moving: flat(bodies.moving, state.poses.moving, right, up),
      fixed: flat(bodies.fixed, state.poses.fixed, right, up),
    };
    let [low, high]: [Flat, Flat] = [[Infinity, Infinity], [-Infinity, -Infinity]];
    for (const [x, y] of [...points.moving, ...points.fixed]) {
      low = [Math.min(low[0], x), Math.min(low[1], y)];
      high = [Math.max(high[0], x), Math.max(high[1], y)];
    }
    const size = Math.max(high[0] - low[0], high[1] - low[1], 1e-300) * 1.16;
    const middle: Flat = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
    const scale = WIDE / size;
    const place = ([x, y]: Flat): Flat => [(x - middle[0]) * scale + WIDE / 2, WIDE / 2 - (y - middle[1]) * scale];
    this.draw(state, bodies, answer, points, place, scale, [right, up]);
  }

  private draw(
    state: State, bodies: Record<Slot, Drawn>, answer: PageCast | undefined, points: Record<Slot, Flat[]>,
    place: (p: Flat) => Flat, scale: number, [right, up]: [Vec, Vec],
  ) {
    const colours = palette();
    const path = (all: Flat[]) => `M${all.map((p) => place(p).map((x) => x.toFixed(2)).join(" ")).join("L")}Z`;
    const { picture } = this;
    picture.setAttribute("viewBox", `0 0 ${WIDE} ${WIDE}`);
    picture.setAttribute("aria-label", "Both shadows, seen along the direction");
    picture.replaceChildren();
    const shadows: [Slot, string][] = [["fixed", colours.fixed], ["moving", colours.moving]];
    const solids: [Drawn, Flat[], string][] = [];
    for (const [slot, colour] of shadows) {
      if (bodies[slot].body.facts.kind === "solid") solids.push([bodies[slot], points[slot], colour]);
      else {
        picture.append(svg("path", {
          d: path(hull(points[slot])), fill: colour, "fill-opacity": 0.6, stroke: colours.text, "stroke-width": 1.2,
        }));
      }
    }
    this.fill(solids, place);
    const flatten = (v: Vec): Flat => place([dot(v, right), dot(v, up)]);
    const said = this.overlay(picture, state, bodies, answer, flatten, scale, colours);
    this.note.textContent = said;
  }

  /** Draws marks, and returns their meaning. */
  private overlay(
    picture: SVGSVGElement, state: State, bodies: Record<Slot, Drawn>, answer: PageCast | undefined,
    flatten: (v: Vec) => Flat, scale: number, colours: Palette,
  ): string {
    const grazing = answer?.kind === "convex" ? answer.record : undefined;
    const [first, between, overlap] = [touch(answer), plane(answer), grazing?.overlap ?? 0];
    const sideways = between?.normal ?? grazing?.sideways;
    if (sideways) {
      // The line at the end of the moving body's shadow, and the one at the fixed body's.
      const gap = between?.margin ?? -overlap;
      const end = farthest(bodies.moving, state.poses.moving, sideways);
      const along = cross(unit(state.direction), sideways);
      const far = (2 * WIDE) / scale;
      const line = (at: Vec) => {
        const [a, b] = [flatten(add(at, times(along, far))), flatten(add(at, times(along, -far)))];
        picture.append(svg("line", {
          x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: colours.plane, "stroke-width": 1.5, "stroke-dasharray": "5 4",
        }));
      };
      line(end);
      if (Math.abs(gap) * scale > 2) line(add(end, times(sideways, gap)));
      const [a, b] = [flatten(end), flatten(add(end, times(sideways, gap)))];
      picture.append(
        svg("line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: colours.normal, "stroke-width": 3 }),
        svg("circle", { cx: a[0], cy: a[1], r: 3.5, fill: colours.normal }),
      );
      return between?.margin
        ? `Seen along d: the shadows are at least ${short(between.margin)} apart, so the bodies never meet.`
        : `Seen along d: the shadows overlap by ${short(Math.abs(overlap))}, at most the graze tolerance.`;
    }
    if (first) {
      const at = flatten(first.point);
      picture.append(svg("circle", { cx: at[0], cy: at[1], r: 4.5, fill: colours.normal, stroke: "#fff", "stroke-width": 1.5 }));
      return "Seen along d: the shadows overlap, so the bodies meet; the point is where they touch first.";
    }
    if (answer?.record.outcome === "free") return "Seen along d: no part of the fixed body is ahead of the moving one.";
    return "Seen along d.";
  }

  /** Draws shadows of solids: all triangles, each pixel once. */
  private fill(solids: [Drawn, Flat[], string][], place: (p: Flat) => Flat) {
    clearTimeout(this.late);
    this.canvas.width = this.canvas.height = 2 * WIDE;
    if (!solids.length) return;
    const draw = () => {
      const context = this.canvas.getContext("2d")!;
      context.scale(2, 2);
      for (const [body, points, colour] of solids) {
        const at = points.map(place);
        context.globalAlpha = 0.6;
        context.fillStyle = colour;
        context.beginPath();
        const { triangles } = body.body;
        for (let k = 0; k < triangles.length; k += 3) {
          const [a, b, c] = [at[triangles[k]!]!, at[triangles[k + 1]!]!, at[triangles[k + 2]!]!];
          // All triangles get the same orientation, so that overlaps add up and make no holes.
          const turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
          const [e, f] = turn > 0 ? [b, c] : [c, b];
          context.moveTo(a[0], a[1]);
          context.lineTo(e[0], e[1]);
          context.lineTo(f[0], f[1]);
        }
        context.fill("nonzero");
      }
    };
    const many = solids.reduce((sum, [body]) => sum + body.body.facts.triangles, 0) > MANY;
    if (many) this.late = window.setTimeout(draw, 150);
    else draw();
  }

  /** Returns the drawing as a file. */
  source(): string {
    const copy = this.picture.cloneNode(true) as SVGSVGElement;
    copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    copy.setAttribute("width", "640");
    copy.setAttribute("height", "640");
    if (this.canvas.getContext("2d") && copy.querySelectorAll("path").length < 2) {
      copy.prepend(svg("image", { href: this.canvas.toDataURL("image/png"), width: WIDE, height: WIDE }));
    }
    return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(copy)}\n`;
  }
}

/** Returns a point of a placed body that is extreme along a unit vector. */
function farthest(body: Drawn, pose: Pose, n: Vec): Vec {
  const { vertices, facts } = body.body;
  let best = -Infinity;
  let at: Vec = [0, 0, 0];
  for (let k = 0; k < 3 * facts.vertices; k += 3) {
    const v = placed(pose, [vertices[k]!, vertices[k + 1]!, vertices[k + 2]!]);
    if (dot(v, n) > best) [best, at] = [dot(v, n), v];
  }
  return add(at, times(n, facts.radius));
}
