// The graph of `phi` over pairs of levels: contours of the remaining region, or a surface that can be turned, with the
// steps on it.

import { palette } from "../colours";
import { h, refill, svg } from "../dom";
import { short } from "../math";
import { type Minimisation, type Two, below, least } from "./recording";

const SIZE = 340;
const EDGE = 42;
const INNER = SIZE - EDGE - 10;

/** A rectangle of levels. */
export type Window = [Two, Two];

export interface Grid {
  /** Its position, and the number of levels of each body. */
  window: Window;
  count: number;
  /** Values by moving level, then fixed level; NaN if the sections miss each other. */
  values: Float64Array;
}

/** The visible state of a search. */
export interface Scene {
  found: Minimisation;
  step: number;
  /** Progress of the step, for drawing the shift and the cut. */
  shift: number;
  cut: number;
  window: Window;
  /** In drawing order, the back ones first. */
  grids: Grid[];
}

/** A label next to a point; it is omitted if it would cover another one. */
interface Word {
  at: Two;
  text: string;
  bold?: boolean;
  italic?: boolean;
}

export class Graph {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", { width: 2 * SIZE, height: 2 * SIZE, "aria-label": "The graph of phi" });
  private readonly marks = svg("svg", { viewBox: `0 0 ${SIZE} ${SIZE}` });
  private readonly legend = h("p", { class: "legend" });
  private readonly contours = h("button", { class: "small", "aria-pressed": "true" }, "Contours");
  private readonly solid = h("button", { class: "small", "aria-pressed": "false" }, "Surface");
  private readonly zoom = h("input", { type: "checkbox", checked: true });
  private surface = false;
  private turn = -0.7;
  private tilt = 0.55;
  private last: (() => void) | undefined;
  onStep: (step: number) => void = () => {};
  onFollow: (follow: boolean) => void = () => {};

  constructor() {
    this.contours.addEventListener("click", () => this.choose(false));
    this.solid.addEventListener("click", () => this.choose(true));
    this.zoom.addEventListener("change", () => this.onFollow(this.zoom.checked));
    const stack = h("div", { class: "stack" }, this.canvas, this.marks);
    this.element = h("div", {},
      h("div", { class: "row" }, this.contours, this.solid, h("label", { class: "zoom" }, this.zoom, "follow what is left")), stack, this.legend);
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

  /** Selects contours or the surface. */
  choose(surface: boolean) {
    this.surface = surface;
    this.contours.setAttribute("aria-pressed", String(!surface));
    this.solid.setAttribute("aria-pressed", String(surface));
    this.last?.();
  }

  set follows(follow: boolean) {
    this.zoom.checked = follow;
  }

  get follows(): boolean {
    return this.zoom.checked;
  }

  show(scene: Scene) {
    this.last = () => (this.surface ? this.drawSurface(scene) : this.drawContours(scene));
    this.last();
    const colours = palette();
    const sign = (colour: string, text: string, round = false) =>
      h("span", {}, h("i", { style: `background: ${colour}; border-radius: ${round ? 50 : 2}%` }), text);
    refill(this.legend, sign(colours.text, "c, where it is cut", true), sign(colours.movingMark, "the least value", true),
      ...(this.surface ? [] : [sign(colours.normal, "q, where the shift goes", true), sign(colours.normal, "cut line, dashed at c, at q"), sign("#e0a526", "cell: the same features touch"), sign(colours.plane, "M, the region that is left"), sign(colours.grid, "cut off"),
        ...(scene.found.square ? [sign(colours.fixedMark, "N(p)")] : [])]));
  }

  /** Maps a pair of levels to the picture. */
  private place([[a, c], [b, d]]: Window): (p: Two) => Two {
    return ([x, y]) => [EDGE + ((x - a) / (b - a)) * INNER, 10 + INNER - ((y - c) / (d - c)) * INNER];
  }

  private drawContours({ found, step, shift, cut, window, grids }: Scene) {
    const colours = palette();
    const context = this.canvas.getContext("2d")!;
    context.setTransform(2, 0, 0, 2, 0, 0);
    context.clearRect(0, 0, SIZE, SIZE);
    const place = this.place(window);
    context.save();
    context.beginPath();
    context.rect(EDGE, 10, INNER, INNER);
    context.clip();
    for (const grid of grids) this.fillGrid(context, grid, place, colours.dark);
    context.restore();
    const inner: SVGElement[] = [];
    const marks: SVGElement[] = [];
    const [low, high] = window;
    const isSeen = ([x, y]: Two) => x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1];
    const polygon = (points: Two[], look: Record<string, string | number>) => {
      if (points.length > 2) inner.push(svg("polygon", { points: points.map((p) => place(p).map((x) => Math.min(Math.max(x, -1e4), 1e4).toFixed(1)).join(",")).join(" "), ...look }));
    };
    const words: Word[] = [];
    const lost = colours.dark ? "#0b0e13" : "#8a919b";
    const now = found.steps[step];
    if (now) {
      const next = found.steps[step + 1]?.region ?? (now.cut ? found.region : now.region);
      // Everything outside the remaining region has been cut off.
      const ring = [...now.region].reverse().map((p) => place(p).map((x) => x.toFixed(1)).join(" ")).join("L");
      if (ring) inner.push(svg("path", { d: `M0 0H${SIZE}V${SIZE}H0ZM${ring}Z`, "fill-rule": "evenodd", fill: lost, "fill-opacity": 0.5 }));
      if (now.cut && cut > 0) {
        const { gradient, origin, limit } = now.cut;
        polygon(below(now.region, [-gradient[0], -gradient[1]], origin, -limit), { fill: lost, "fill-opacity": 0.5 * cut, stroke: "none" });
      }
      polygon(now.cell, { fill: "#f2b632", "fill-opacity": 0.42, stroke: "#b07d0a", "stroke-width": 1, class: "cell" });
      polygon(cut > 0.5 ? next : now.region, { fill: "none", stroke: colours.plane, "stroke-width": 2.2, class: "region" });
      const line = (at: Two, dashed: boolean) => {
        const [a, b] = this.chord(now.gradient, at, window);
        if (a && b) inner.push(svg("line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: colours.normal, "stroke-width": 1.5, "stroke-dasharray": dashed ? "5 4" : "none" }));
      };
      line(now.levels, true);
      if (now.meets && shift > 0) line([now.levels[0] + shift * (now.best[0] - now.levels[0]), now.levels[1] + shift * (now.best[1] - now.levels[1])], false);
    }
    const dot = (at: Two, colour: string, r: number, more: Record<string, unknown> = {}) => svg("circle", { cx: place(at)[0], cy: place(at)[1], r, fill: colour, stroke: colours.dark ? "#0b0e13" : "#fff", "stroke-width": 1.5, ...(more as Record<string, string>) });
    found.steps.forEach((one, k) => {
      if (!isSeen(one.levels)) return;
      marks.push(dot(one.levels, k === step ? colours.text : colours.grid, k === step ? 6 : 4, {
        class: "pick", tabindex: 0, role: "button", "aria-label": `step ${k + 1}`,
        onclick: () => this.onStep(k), onfocus: () => this.onStep(k), "stroke": k === step ? "#fff" : colours.text,
      }));
      words.push({ at: place(one.levels), text: String(k + 1), bold: k === step });
    });
    const end = least(found);
    if (end && isSeen(end.at)) marks.push(dot(end.at, colours.movingMark, 4.5, { class: "least" }));
    if (now?.meets && shift > 0) {
      const at: Two = [now.levels[0] + shift * (now.best[0] - now.levels[0]), now.levels[1] + shift * (now.best[1] - now.levels[1])];
      marks.push(dot(at, colours.normal, 5));
      if (shift >= 1) words.push({ at: place(at), text: "q", italic: true, bold: true });
    }
    if (found.square) {
      const { center: [x, y], half } = found.square;
      const overlaps = x + half >= low[0] && x - half <= high[0] && y + half >= low[1] && y - half <= high[1];
      if (overlaps) {
        const [[u, v], [s, t]] = [place([x - half, y + half]), place([x + half, y - half])];
        // A square smaller than a dot is drawn around the dot.
        const [wide, tall] = [Math.max(s - u, 16), Math.max(t - v, 16)];
        inner.push(svg("rect", { x: (u + s - wide) / 2, y: (v + t - tall) / 2, width: wide, height: tall, fill: "none", stroke: colours.fixedMark, "stroke-width": 1.6, "stroke-dasharray": "4 3", "pointer-events": "none", class: "neighbourhood" }));
        words.push({ at: [Math.min(Math.max((u + s) / 2, EDGE + 20), SIZE - 34), Math.min(Math.max(v, 26), 10 + INNER - 6)], text: "N(p)", italic: true });
      }
    }
    if (now) marks.push(...this.arrow(place, now.levels, now.gradient, window, colours.text));
    words.sort((a, b) => Number(b.bold ?? 0) - Number(a.bold ?? 0));
    const text = (x: number, y: number, what: string, more: Record<string, string> = {}) =>
      marks.push(svg("text", { x, y, fill: colours.text, "font-size": 12, ...more }, what));
    this.lay(words, [...found.steps.map((one) => one.levels), ...(end ? [end.at] : [])].filter(isSeen).map(place), text);
    text(EDGE + INNER / 2, SIZE - 4, "level x of the moving body", { "text-anchor": "middle" });
    text(0, 0, "level y of the fixed body", { "text-anchor": "middle", transform: `translate(10 ${10 + INNER / 2}) rotate(-90)` });
    text(EDGE, SIZE - 4, short(low[0], 3));
    text(EDGE + INNER, SIZE - 4, short(high[0], 3), { "text-anchor": "end" });
    text(EDGE - 4, 10 + INNER, short(low[1], 3), { "text-anchor": "end", "font-size": "10.5" });
    text(EDGE - 4, 20, short(high[1], 3), { "text-anchor": "end", "font-size": "10.5" });
    const clip = svg("clipPath", { id: "levels" }, svg("rect", { x: EDGE, y: 10, width: INNER, height: INNER }));
    refill(this.marks, clip, svg("g", { "clip-path": "url(#levels)" }, ...inner), svg("rect", { x: EDGE, y: 10, width: INNER, height: INNER, fill: "none", stroke: colours.text, "stroke-opacity": 0.5, "pointer-events": "none" }), ...marks);
  }

  /** Places labels next to their points, on the first free side of four; omits a label if no side is free. */
  private lay(words: Word[], dots: Two[], text: (x: number, y: number, what: string, more: Record<string, string>) => void) {
    const taken = dots.map(([x, y]): [number, number, number, number] => [x - 4, y - 4, x + 4, y + 4]);
    for (const { at: [x, y], text: what, bold, italic } of words) {
      const wide = 7.5 * what.length;
      const places: Two[] = [[x + 7, y - 5], [x - 7 - wide, y - 5], [x + 7, y + 15], [x - 7 - wide, y + 15]];
      const free = places.find(([u, v]) =>
        u >= EDGE && u + wide <= SIZE - 4 && v >= 20 && v <= 10 + INNER - 2 &&
        taken.every(([a, b, c, d]) => u > c || u + wide < a || v - 11 > d || v < b));
      if (!free) continue;
      taken.push([free[0], free[1] - 11, free[0] + wide, free[1]]);
      text(free[0], free[1], what, { "font-weight": bold ? "700" : "400", ...(italic ? { "font-style": "italic" } : {}) });
    }
  }

  /** Returns where the line through a point, perpendicular to a gradient, leaves the picture. */
  private chord(gradient: Two, at: Two, window: Window): Two[] {
    const place = this.place(window);
    const [x, y] = place(at);
    const [[a, c], [b, d]] = window;
    // The line is perpendicular to the gradient in levels; the picture scales both axes separately.
    const way: Two = [-gradient[1] / (b - a), -gradient[0] / (d - c)];
    const l = Math.hypot(...way);
    return l > 0 ? [[x - (way[0] / l) * 500, y - (way[1] / l) * 500], [x + (way[0] / l) * 500, y + (way[1] / l) * 500]] : [];
  }

  /** Draws an arrow down the gradient. */
  private arrow(place: (p: Two) => Two, at: Two, gradient: Two, [[a, c], [b, d]]: Window, colour: string): SVGElement[] {
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

  private fillGrid(context: CanvasRenderingContext2D, grid: Grid, place: (p: Two) => Two, dark: boolean) {
    const { count, values, window: [from, to] } = grid;
    const [low, high] = this.bounds(grid);
    const [left, top] = place([from[0], to[1]]);
    const [right, foot] = place([to[0], from[1]]);
    const [wide, tall] = [(right - left) / count, (foot - top) / count];
    const at = (i: number, j: number) => values[i * count + j]!;
    for (let i = 0; i < count; i++) {
      for (let j = 0; j < count; j++) {
        const v = at(i, j);
        if (Number.isNaN(v)) continue;
        context.fillStyle = tint((v - low) / (high - low || 1), dark);
        context.fillRect(left + i * wide, foot - (j + 1) * tall, wide + 0.5, tall + 0.5);
      }
    }
    context.strokeStyle = dark ? "rgba(255,255,255,0.45)" : "rgba(20,40,70,0.45)";
    context.lineWidth = 0.8;
    context.beginPath();
    const lines = 14;
    for (let k = 1; k < lines; k++) {
      // Contours are denser near the minimum.
      const value = low + (high - low) * (k / lines) ** 1.6;
      for (let i = 0; i + 1 < count; i++) for (let j = 0; j + 1 < count; j++) this.crossings(context, at, [i, j], value, (u, v) => [left + u * wide, foot - v * tall]);
    }
    context.stroke();
  }

  /** Draws a contour through the square between four centres of cells. */
  private crossings(context: CanvasRenderingContext2D, at: (i: number, j: number) => number, [i, j]: Two, value: number, place: (u: number, v: number) => Two) {
    const corners: [number, number][] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
    const heights = corners.map(([a, b]) => at(a, b));
    if (heights.some(Number.isNaN)) return;
    const points: Two[] = [];
    corners.forEach(([a, b], k) => {
      const [c, d] = corners[(k + 1) % 4]!;
      const [u, v] = [heights[k]! - value, heights[(k + 1) % 4]! - value];
      if (u < 0 === v < 0) return;
      const s = u / (u - v);
      points.push(place(a + 0.5 + s * (c - a), b + 0.5 + s * (d - b)));
    });
    for (let k = 0; k + 1 < points.length; k += 2) {
      context.moveTo(...points[k]!);
      context.lineTo(...points[k + 1]!);
    }
  }

  /** Draws the convex function that the minimisation descends, as a surface. */
  private drawSurface({ found, step, grids }: Scene) {
    const grid = grids.at(-1);
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
    const [[a, c], [b, d]] = grid.window;
    const upon = (p: Two): Two | undefined => {
      const [x, y] = [(p[0] - a) / (b - a), (p[1] - c) / (d - c)];
      if (x < 0 || x > 1 || y < 0 || y > 1) return undefined;
      const near = values[Math.min(count - 1, Math.floor(x * count)) * count + Math.min(count - 1, Math.floor(y * count))]!;
      const [u, v] = project(x, y, height(Number.isNaN(near) ? low : near));
      return [u, v];
    };
    const words: Word[] = [];
    found.steps.forEach((one, k) => {
      const at = one.meets ? upon(one.levels) : undefined;
      if (!at) return;
      words.push({ at, text: String(k + 1), bold: k === step });
      this.marks.append(svg("circle", { cx: at[0], cy: at[1], r: k === step ? 7 : 4.5, fill: k === step ? colours.text : colours.grid, stroke: k === step ? "#fff" : colours.text, "stroke-width": 1.5, class: "pick", tabindex: 0, role: "button", "aria-label": `step ${k + 1}`, onclick: () => this.onStep(k), onfocus: () => this.onStep(k) }));
    });
    const end = least(found);
    const at = end && upon(end.at);
    if (at) this.marks.append(svg("circle", { cx: at[0], cy: at[1], r: 5, fill: colours.movingMark, stroke: colours.dark ? "#0b0e13" : "#fff", "stroke-width": 1.5 }));
    words.sort((a, b) => Number(b.bold) - Number(a.bold));
    this.lay(words, words.map((word) => word.at), (x, y, what, more) => this.marks.append(svg("text", { x, y, "font-size": 12, fill: colours.text, ...more }, what)));
    this.marks.append(svg("text", { x: SIZE / 2, y: SIZE - 4, "text-anchor": "middle", "font-size": 12, fill: colours.text }, "drag to turn"));
  }
}

/** Returns a colour from dark (minimum) to pale (maximum); it varies in lightness, so that everyone can distinguish the values. */
function tint(share: number, dark: boolean): string {
  const s = Math.sqrt(Math.min(1, Math.max(0, share)));
  return dark ? `hsl(${215 - 20 * s} ${60 - 25 * s}% ${58 - 38 * s}%)` : `hsl(${220 - 25 * s} ${62 - 12 * s}% ${46 + 46 * s}%)`;
}
