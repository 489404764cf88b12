// A recording of a search, in steps.

import type { PageEvent } from "../answers";
import { type Vec, add, times } from "../math";

type Two = [number, number];

/** One planar problem, the cut that followed, and what was left of the levels before it. */
export interface Step {
  levels: Two;
  value: number;
  meets: boolean;
  gradient: Two;
  shifted: number;
  /** Of the levels, before the cut. */
  region: Two[];
  cut?: { gradient: Two; origin: Two; limit: number; lower: number; upper: number };
}

export interface Minimisation {
  axes: [Vec, Vec];
  ranges: [Two, Two];
  steps: Step[];
  /** What is left in the end. */
  region: Two[];
  /** The neighbourhood `N(p)` that is searched first. */
  square?: { center: Two; half: number };
}

/** The minimisation over pairs of levels, if there was one. */
export function minimisation(events: PageEvent[]): Minimisation | undefined {
  const begun = events.find((event) => "sections" in event);
  if (!begun || !("sections" in begun)) return undefined;
  const [[a, b], [c, d]] = begun.ranges;
  let region: Two[] = [[a, c], [b, c], [b, d], [a, d]];
  const steps: Step[] = [];
  for (const event of events) {
    if ("planar" in event) {
      const { planar: levels, value, meets, gradient, shifted } = event;
      steps.push({ levels, value, meets, gradient, shifted, region });
    } else if ("cut" in event) {
      const { cut: gradient, origin, limit, lower, upper } = event;
      const last = steps.at(-1);
      if (last) last.cut = { gradient, origin, limit, lower, upper };
      region = below(region, gradient, origin, limit);
    }
  }
  return { axes: begun.sections, ranges: begun.ranges, steps, region };
}

/** The part of a convex polygon where `gradient . (p - origin) <= limit`. */
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

/** The portals in their order, each with the support points computed for it. */
export function portals(events: PageEvent[]): { frame: [Vec, Vec, Vec]; steps: { portal: [Vec, Vec, Vec]; supports: Vec[] }[]; loose: Vec[] } | undefined {
  let frame: [Vec, Vec, Vec] | undefined;
  let steps: { portal: [Vec, Vec, Vec]; supports: Vec[] }[] = [];
  let loose: Vec[] = [];
  for (const event of events) {
    if ("begun" in event) {
      // Begun again in a turned frame: what was before is of no use for the picture.
      [frame, steps, loose] = [event.begun, [], []];
    } else if ("support" in event) {
      const last = steps.at(-1);
      (last ? last.supports : loose).push(event.support);
    } else if ("portal" in event) steps.push({ portal: event.portal, supports: [] });
  }
  return frame && { frame, steps, loose };
}

/** A point of the shadow frame, in the world. */
export const inWorld = (frame: [Vec, Vec, Vec], v: Vec): Vec =>
  add(add(times(frame[0], v[0]), times(frame[1], v[1])), times(frame[2], v[2]));
