// A recording of a search as steps, and these as moments that can be played.

import type { PageEvent } from "../answers";
import { type Vec, add, times } from "../math";

export type Two = [number, number];
export type Touch = "edges" | "vertex" | "separated" | "hidden";

/** A planar problem, the cut after it, and the region of levels before it. */
export interface Step {
  levels: Two;
  value: number;
  touch: Touch;
  meets: boolean;
  gradient: Two;
  /** The end of the cell shift, and its value. */
  best: Two;
  shifted: number;
  /** The levels at which the same features touch; empty if the sections miss each other. */
  cell: Two[];
  /** Whether the best point was found to solve the problem. */
  solved: boolean;
  /** The region of levels before the cut. */
  region: Two[];
  cut?: { gradient: Two; origin: Two; limit: number; lower: number; upper: number };
}

export interface Minimisation {
  axes: [Vec, Vec];
  ranges: [Two, Two];
  steps: Step[];
  /** The region at the end. */
  region: Two[];
  /** The neighbourhood `N(p)` that is searched first. */
  square?: { center: Two; half: number };
}

/** Returns the minimisation over pairs of levels, if there was one. */
export function minimisation(events: PageEvent[]): Minimisation | undefined {
  const begun = events.find((event) => "sections" in event);
  if (!begun || !("sections" in begun)) return undefined;
  const [[a, b], [c, d]] = begun.ranges;
  let region: Two[] = [[a, c], [b, c], [b, d], [a, d]];
  const steps: Step[] = [];
  for (const event of events) {
    const last = steps.at(-1);
    if ("planar" in event) {
      const { planar: levels, value, touch, gradient, best, shifted } = event;
      const meets = touch === "edges" || touch === "vertex";
      steps.push({ levels, value: value ?? NaN, touch, meets, gradient, best, shifted: shifted ?? NaN, cell: [], solved: false, region });
    } else if ("cell" in event && last) last.cell = event.cell;
    else if ("solved" in event && last) last.solved ||= event.solved;
    else if ("cut" in event) {
      const { cut: gradient, origin, limit, lower, upper } = event;
      if (last) last.cut = { gradient, origin, limit, lower: lower ?? -Infinity, upper: upper ?? Infinity };
      region = below(region, gradient, origin, limit);
    }
  }
  return { axes: begun.sections as [Vec, Vec], ranges: begun.ranges as [Two, Two], steps, region };
}

/** Returns the part of a convex polygon where `gradient . (p - origin) <= limit`. */
export function below(polygon: Two[], gradient: Two, origin: Two, limit: number): Two[] {
  const value = (p: Two) => gradient[0] * (p[0] - origin[0]) + gradient[1] * (p[1] - origin[1]) - limit;
  const left: Two[] = [];
  polygon.forEach((p, k) => {
    const q = polygon[(k + 1) % polygon.length]!;
    const [u, v] = [value(p), value(q)];
    if (u <= 0) left.push(p);
    if (u < 0 !== v < 0 && u !== v) {
      const s = u / (u - v);
      if (s > 0 && s < 1) left.push([p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])]);
    }
  });
  return left;
}

/** Returns the levels of the least value that was found. */
export function least({ steps }: Minimisation): { at: Two; value: number } | undefined {
  const met = steps.filter((step) => step.meets && Number.isFinite(step.shifted));
  const best = met.reduce<Step | undefined>((a, b) => (!a || b.shifted < a.shifted ? b : a), undefined);
  return best && { at: best.best, value: best.shifted };
}

/** A portal with the support points computed for it, and the vertices of both bodies at its corners. */
export interface Portal {
  corners: [Vec, Vec, Vec];
  pairs: (Two | undefined)[];
  supports: Vec[];
}

export interface Portals {
  frame: [Vec, Vec, Vec];
  steps: Portal[];
  loose: Vec[];
}

/** Returns the portals in order. */
export function portals(events: PageEvent[]): Portals | undefined {
  let frame: [Vec, Vec, Vec] | undefined;
  let steps: Portal[] = [];
  let loose: Vec[] = [];
  const pairs = new Map<string, Two>();
  for (const event of events) {
    if ("begun" in event) {
      // The search restarted in a rotated frame; earlier portals do not fit the picture.
      [frame, steps, loose] = [event.begun as [Vec, Vec, Vec], [], []];
    } else if ("support" in event) {
      pairs.set(event.support.join(), event.pair as Two);
      const last = steps.at(-1);
      (last ? last.supports : loose).push(event.support as Vec);
    } else if ("portal" in event) {
      const corners = event.portal as [Vec, Vec, Vec];
      steps.push({ corners, pairs: corners.map((v) => pairs.get(v.join())), supports: [] });
    }
  }
  return frame && { frame, steps, loose };
}

/** Converts a point of the shadow frame to the world. */
export const inWorld = (frame: [Vec, Vec, Vec], v: Vec): Vec =>
  add(add(times(frame[0], v[0]), times(frame[1], v[1])), times(frame[2], v[2]));

/** A moment, in which one thing happens. */
export type Moment =
  | { kind: "sections" | "touch" | "shift" | "cut" | "solved"; step: number }
  | { kind: "portal"; portal: number };

/** Returns all moments of a search in order. */
export function moments(found: Minimisation | undefined, refined: Portals | undefined): Moment[] {
  const all: Moment[] = [];
  found?.steps.forEach((one, step) => {
    all.push({ kind: "sections", step }, { kind: "touch", step });
    if (one.meets && (one.best[0] !== one.levels[0] || one.best[1] !== one.levels[1])) all.push({ kind: "shift", step });
    if (one.cut) all.push({ kind: "cut", step });
    else if (one.solved) all.push({ kind: "solved", step });
  });
  refined?.steps.forEach((_, portal) => all.push({ kind: "portal", portal }));
  return all;
}

export const mix = (a: number, b: number, s: number) => a + s * (b - a);
export const between = (a: Two, b: Two, s: number): Two => [mix(a[0], b[0], s), mix(a[1], b[1], s)];
