// The proven lower and upper bound after each step.

import { palette } from "../colours";
import { refill, svg } from "../dom";
import { short } from "../math";
import type { Minimisation } from "./recording";

const [WIDE, HIGH] = [340, 150];
const [LEFT, RIGHT, TOP, FOOT] = [10, 10, 20, 22];

export class Bounds {
  readonly element = svg("svg", { class: "figure bounds-over-steps", viewBox: `0 0 ${WIDE} ${HIGH}`, role: "img", "aria-label": "Lower and upper bound over the steps" });
  onStep: (step: number) => void = () => {};

  /** Shows the bounds. Values are lengths; `unit` is the length of the direction. */
  show({ steps }: Minimisation, step: number, answer: number | undefined, unit: number) {
    const colours = palette();
    const known = steps.map(({ cut, solved, shifted }) => cut ?? (solved ? { lower: shifted, upper: shifted } : undefined));
    const all = known.flatMap((one) => (one ? [one.lower, one.upper] : [])).filter(Number.isFinite);
    if (answer !== undefined) all.push(answer * unit);
    const [low, high] = [Math.min(...all), Math.max(...all)];
    const room = (high - low || 1) * 0.08;
    const x = (k: number) => LEFT + ((k + 0.5) / steps.length) * (WIDE - LEFT - RIGHT);
    const y = (v: number) => HIGH - FOOT - ((Math.min(Math.max(v, low - room), high + room) - low + room) / (high - low + 2 * room || 1)) * (HIGH - TOP - FOOT);
    const marks: Element[] = [svg("line", { x1: LEFT, x2: WIDE - RIGHT, y1: HIGH - FOOT, y2: HIGH - FOOT, stroke: colours.grid, "stroke-width": 1 })];
    if (!all.length) return refill(this.element, svg("text", { x: LEFT, y: HIGH / 2, "font-size": 12, fill: colours.text }, "No value was found, so there are no bounds."));
    if (answer !== undefined) {
      const at = y(answer * unit);
      marks.push(svg("line", { x1: LEFT, x2: WIDE - RIGHT, y1: at, y2: at, stroke: colours.normal, "stroke-width": 1.2, "stroke-dasharray": "5 4" }));
    }
    const curve = (value: (one: { lower: number; upper: number }) => number, colour: string, name: string) => {
      const points = known.flatMap((one, k): [number, number][] => (one && Number.isFinite(value(one)) ? [[x(k), y(value(one))]] : []));
      if (!points.length) return;
      marks.push(svg("polyline", { points: points.map((p) => p.map((c) => c.toFixed(1)).join(",")).join(" "), fill: "none", stroke: colour, "stroke-width": 2, class: name }));
      for (const [cx, cy] of points) marks.push(svg("circle", { cx, cy, r: 2.6, fill: colour }));
    };
    curve((one) => one.upper, colours.fixedMark, "upper");
    curve((one) => one.lower, colours.plane, "lower");
    const now = known[step];
    marks.push(svg("line", { x1: x(step), x2: x(step), y1: TOP - 4, y2: HIGH - FOOT, stroke: colours.text, "stroke-width": 1, "stroke-opacity": 0.5 }));
    // Label every step if there is room.
    const every = Math.ceil(steps.length / 16);
    steps.forEach((_, k) => {
      if (k % every === 0 || k === steps.length - 1) marks.push(svg("text", { x: x(k), y: HIGH - 7, "font-size": 11, "text-anchor": "middle", fill: colours.text, "font-weight": k === step ? 700 : 400 }, String(k + 1)));
      const wide = (WIDE - LEFT - RIGHT) / steps.length;
      marks.push(svg("rect", { x: x(k) - wide / 2, y: 0, width: wide, height: HIGH, fill: "transparent", class: "pick", onclick: () => this.onStep(k) }));
    });
    const text = (v: number) => (Number.isFinite(v) ? short(v / unit, 7) : "nothing yet");
    if (now) {
      const part = (fill: string, words: string) => svg("tspan", { fill }, words);
      const gap = now.upper - now.lower;
      marks.push(svg("text", { x: LEFT, y: 13, "font-size": 12, "font-weight": 600 },
        part(colours.fixedMark, `upper ${text(now.upper)}`), part(colours.text, ", "), part(colours.plane, `lower ${text(now.lower)}`),
        part(colours.text, Number.isFinite(gap) ? `, gap ${short(Math.max(gap, 0) / unit, 3)}` : "")));
    }
    refill(this.element, ...marks);
  }
}
