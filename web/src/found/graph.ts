// The graph of `phi` over pairs of levels: contours, or a surface to turn; with the steps upon it.

import { palette } from "../colours";
import { h, refill, svg } from "../dom";
import { short } from "../math";
import type { Minimisation } from "./recording";

const SIZE = 340;
const EDGE = 34;
const INNER = SIZE - EDGE - 10;

export interface Grid {
  /** How many levels of either body. */
  count: number;
  /** By moving level, then fixed level; not a number where sections miss each other. */
  values: Float64Array;
}

type Two = [number, number];

export class Graph {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", { width: 2 * SIZE, height: 2 * SIZE, "aria-label": "The graph of phi" });
  private readonly marks = svg("svg", { viewBox: `0 0 ${SIZE} ${SIZE}` });
  private surface = false;
  private turn = -0.7;
  private tilt = 0.55;
  private last: (() => void) | undefined;
  onStep: (step: number) => void = () => {};

  constructor() {
    const choose = (surface: boolean) => () => {
      this.surface = surface;
      contours.setAttribute("aria-pressed", String(!surface));
      solid.setAttribute("aria-pressed", String(surface));
      this.last?.();
    };
    const contours = h("button", { class: "small", "aria-pressed": "true", onclick: choose(false) }, "Contours");
    const solid = h("button", { class: "small", "aria-pressed": "false", onclick: choose(true) }, "Surface");
    const stack = h("div", { class: "stack" }, this.canvas, this.marks);
    this.element = h("div", {}, h("div", { class: "row" }, contours, solid), stack);
    stack.addEventListener("pointerdown", (event) => {
      if (!this.surface) return;
      stack.setPointerCapture(event.pointerId);
      let [x, y] = [event.clientX, event.clientY];
      const move = (e: PointerEvent) => {
        this.turn += (e.clientX - x) / 120;
        this.tilt = Math.min(1.5, Math.max(0.15, this.tilt + (e.clientY - y) / 160));
        [x, y] = [e.clientX, e.clientY];
        this.last?.();
      };
      const up = () => stack.removeEventListener("pointermove", move);
      stack.addEventListener("pointermove", move);
      stack.addEventListener("pointerup", up, { once: true });
      stack.addEventListener("pointercancel", up, { once: true });
    });
  }

  show(found: Minimisation, grid: Grid | undefined, step: number) {
    this.last = () => (this.surface ? this.drawSurface(found, grid, step) : this.drawContours(found, grid, step));
    this.last();
  }

  /** From a level of either body to the picture. */
  private place(found: Minimisation): (p: Two) => Two {
    const [[a, b], [c, d]] = found.ranges;
    return ([x, y]) => [EDGE + ((x - a) / (b - a)) * INNER, 10 + INNER - ((y - c) / (d - c)) * INNER];
  }

  private drawContours(found: Minimisation, grid: Grid | undefined, step: number) {
    const colours = palette();
    const context = this.canvas.getContext("2d")!;
    context.setTransform(2, 0, 0, 2, 0, 0);
    context.clearRect(0, 0, SIZE, SIZE);
    const place = this.place(found);
    if (grid) this.fillGrid(context, grid, colours.dark);
    const marks: SVGElement[] = [];
    const add = (element: SVGElement) => marks.push(element);
    add(svg("rect", { x: EDGE, y: 10, width: INNER, height: INNER, fill: "none", stroke: colours.text, "stroke-opacity": 0.5 }));
    const now = found.steps[step];
    if (found.square) {
      const { center: [x, y], half } = found.square;
      const [[u, v], [s, t]] = [place([x - half, y + half]), place([x + half, y - half])];
      // Often smaller than a dot.
      const [wide, high] = [Math.max(s - u, 3), Math.max(t - v, 3)];
      add(svg("rect", { x: (u + s - wide) / 2, y: (v + t - high) / 2, width: wide, height: high, fill: colours.way, "fill-opacity": 0.12, stroke: colours.way, "stroke-width": 1.6, "stroke-dasharray": "4 3", class: "neighbourhood" }));
      const [p, q] = place([x, y]);
      add(svg("text", { x: p + 12, y: q + 16, fill: colours.text, "font-size": 12, "font-style": "italic" }, "N(p)"));
    }
    const polygon = (points: Two[]) => points.map((p) => place(p).map((x) => x.toFixed(1)).join(",")).join(" ");
    if (now) {
      add(svg("polygon", { points: polygon(now.region), fill: colours.plane, "fill-opacity": 0.13, stroke: colours.plane, "stroke-width": 2 }));
      const next = found.steps[step + 1]?.region ?? found.region;
      if (next.length > 2) add(svg("polygon", { points: polygon(next), fill: colours.plane, "fill-opacity": 0.3, stroke: "none" }));
    }
    found.steps.forEach((one, k) => {
      const [x, y] = place(one.levels);
      const dot = svg("circle", {
        cx: x, cy: y, r: k === step ? 7 : 4.5, fill: one.meets ? colours.normal : colours.fixedMark, stroke: "#fff", "stroke-width": 1.5,
        class: "pick", tabindex: 0, role: "button", "aria-label": `step ${k + 1}`,
        onpointerenter: () => this.onStep(k), onclick: () => this.onStep(k), onfocus: () => this.onStep(k),
      });
      add(dot);
      add(svg("text", { x: x + 8, y: y - 6, fill: colours.text, "font-size": 12, "font-weight": k === step ? 700 : 400 }, String(k + 1)));
    });
    if (now) marks.push(...this.arrow(place, now.levels, now.gradient, found, colours.text));
    const text = (x: number, y: number, what: string, more: Record<string, string> = {}) =>
      add(svg("text", { x, y, fill: colours.text, "font-size": 12, ...more }, what));
    text(EDGE + INNER / 2, SIZE - 4, "level x of the moving body", { "text-anchor": "middle" });
    text(0, 0, "level y of the fixed body", { "text-anchor": "middle", transform: `translate(10 ${10 + INNER / 2}) rotate(-90)` });
    const [[a, b], [c, d]] = found.ranges;
    text(EDGE, SIZE - 18 + 14, short(a, 3));
    text(EDGE + INNER, SIZE - 4, short(b, 3), { "text-anchor": "end" });
    text(EDGE - 4, 10 + INNER, short(c, 3), { "text-anchor": "end" });
    text(EDGE - 4, 20, short(d, 3), { "text-anchor": "end" });
    refill(this.marks, ...marks);
  }

  /** Down the gradient. */
  private arrow(place: (p: Two) => Two, at: Two, gradient: Two, found: Minimisation, colour: string): SVGElement[] {
    const [[a, b], [c, d]] = found.ranges;
    const [u, v] = [gradient[0] / (d - c), gradient[1] / (b - a)];
    const l = Math.hypot(u, v);
    if (!l) return [];
    const [x, y] = place(at);
    const [e, f] = [x - (u / l) * 38, y + (v / l) * 38];
    const [p, q] = [(u / l) * 8, -(v / l) * 8];
    return [svg("path", { d: `M${x} ${y}L${e} ${f}M${e + p - q * 0.6} ${f + q + p * 0.6}L${e} ${f}L${e + p + q * 0.6} ${f + q - p * 0.6}`, stroke: colour, "stroke-width": 2, fill: "none" })];
  }

  private bounds({ values }: Grid): Two {
    let [low, high] = [Infinity, -Infinity];
    for (const v of values) {
      if (v < low) low = v;
      if (v > high) high = v;
    }
    return [low, high];
  }

  private fillGrid(context: CanvasRenderingContext2D, grid: Grid, dark: boolean) {
    const { count, values } = grid;
    const [low, high] = this.bounds(grid);
    const cell = INNER / count;
    const at = (i: number, j: number) => values[i * count + j]!;
    for (let i = 0; i < count; i++) {
      for (let j = 0; j < count; j++) {
        const v = at(i, j);
        if (Number.isNaN(v)) continue;
        context.fillStyle = tint((v - low) / (high - low || 1), dark);
        context.fillRect(EDGE + i * cell, 10 + INNER - (j + 1) * cell, cell + 0.5, cell + 0.5);
      }
    }
    context.strokeStyle = dark ? "rgba(255,255,255,0.45)" : "rgba(20,40,70,0.45)";
    context.lineWidth = 0.8;
    context.beginPath();
    const lines = 14;
    for (let k = 1; k < lines; k++) {
      // Closer to each other near the least value.
      const value = low + (high - low) * (k / lines) ** 1.6;
      for (let i = 0; i + 1 < count; i++) for (let j = 0; j + 1 < count; j++) this.crossings(context, at, i, j, value, cell);
    }
    context.stroke();
  }

  /** A contour through the square between four middles of cells. */
  private crossings(context: CanvasRenderingContext2D, at: (i: number, j: number) => number, i: number, j: number, value: number, cell: number) {
    const corners: [number, number][] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
    const heights = corners.map(([a, b]) => at(a, b));
    if (heights.some(Number.isNaN)) return;
    const points: Two[] = [];
    corners.forEach(([a, b], k) => {
      const [c, d] = corners[(k + 1) % 4]!;
      const [u, v] = [heights[k]! - value, heights[(k + 1) % 4]! - value];
      if (u < 0 === v < 0) return;
      const s = u / (u - v);
      points.push([EDGE + (a + 0.5 + s * (c - a)) * cell, 10 + INNER - (b + 0.5 + s * (d - b)) * cell]);
    });
    for (let k = 0; k + 1 < points.length; k += 2) {
      context.moveTo(...points[k]!);
      context.lineTo(...points[k + 1]!);
    }
  }

  /** The convex function itself: what the minimisation goes down. */
  private drawSurface(found: Minimisation, grid: Grid | undefined, step: number) {
    const colours = palette();
    const context = this.canvas.getContext("2d")!;
    context.setTransform(2, 0, 0, 2, 0, 0);
    context.clearRect(0, 0, SIZE, SIZE);
    this.marks.replaceChildren();
    if (!grid) return;
    const { count, values } = grid;
    const [low, high] = this.bounds(grid);
    const [cos, sin] = [Math.cos(this.turn), Math.sin(this.turn)];
    const project = (x: number, y: number, z: number): [number, number, number] => {
      const [a, b] = [(x - 0.5) * cos - (y - 0.5) * sin, (x - 0.5) * sin + (y - 0.5) * cos];
      const up = (z - 0.4) * 0.85;
      return [SIZE / 2 + a * 225, SIZE / 2 + 18 - b * Math.sin(this.tilt) * 225 - up * Math.cos(this.tilt) * 190, b];
    };
    const height = (v: number) => (v - low) / (high - low || 1);
    const quads: { points: Two[]; depth: number; value: number }[] = [];
    for (let i = 0; i + 1 < count; i++) {
      for (let j = 0; j + 1 < count; j++) {
        const corners: [number, number][] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
        const heights = corners.map(([a, b]) => values[a * count + b]!);
        if (heights.some(Number.isNaN)) continue;
        const at = corners.map(([a, b], k) => project((a + 0.5) / count, (b + 0.5) / count, height(heights[k]!)));
        quads.push({ points: at.map(([x, y]) => [x, y]), depth: at[0]![2] + at[2]![2], value: (heights[0]! + heights[2]!) / 2 });
      }
    }
    quads.sort((a, b) => b.depth - a.depth);
    context.lineWidth = 0.5;
    context.strokeStyle = colours.dark ? "rgba(0,0,0,0.45)" : "rgba(20,40,70,0.35)";
    for (const { points, value } of quads) {
      context.fillStyle = tint(height(value), colours.dark);
      context.beginPath();
      points.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
      context.closePath();
      context.fill();
      context.stroke();
    }
    const [[a, b], [c, d]] = found.ranges;
    found.steps.forEach((one, k) => {
      if (!one.meets) return;
      const [x, y] = [(one.levels[0] - a) / (b - a), (one.levels[1] - c) / (d - c)];
      const near = values[Math.min(count - 1, Math.floor(x * count)) * count + Math.min(count - 1, Math.floor(y * count))]!;
      const [u, v] = project(x, y, height(Number.isNaN(near) ? low : near));
      this.marks.append(
        svg("circle", { cx: u, cy: v, r: k === step ? 7 : 4.5, fill: colours.normal, stroke: "#fff", "stroke-width": 1.5, onclick: () => this.onStep(k) }),
        svg("text", { x: u + 8, y: v - 6, fill: colours.text, "font-size": 12 }, String(k + 1)),
      );
    });
    this.marks.append(svg("text", { x: SIZE / 2, y: SIZE - 4, "text-anchor": "middle", "font-size": 12, fill: colours.text }, "drag to turn"));
  }
}

/** From the least value, dark, to the largest, pale; by lightness, so that everybody tells them apart. */
function tint(share: number, dark: boolean): string {
  const s = Math.sqrt(Math.min(1, Math.max(0, share)));
  return dark ? `hsl(${215 - 20 * s} ${60 - 25 * s}% ${58 - 38 * s}%)` : `hsl(${220 - 25 * s} ${62 - 12 * s}% ${46 + 46 * s}%)`;
}
