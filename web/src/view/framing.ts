// The camera: its direction and its distance.

import type { PageCast } from "../answers";
import { touch } from "../engine";
import { type Vec, add, dot, length, placed, sub, times, unit } from "../math";
import type { State } from "../state";
import type { Drawn } from "./body";

/** Maximum coordinate in single precision, in which pictures are computed. */
const FAR = 1e30;

/** A centre and a radius. */
export type Ball = [Vec, number];

/** Checks whether a picture can be drawn. Numbers may exceed single precision until the library rejects them, and even
 * if it answers. */
export function drawable({ poses, direction }: State, answer: PageCast | undefined, moving: Drawn, fixed: Drawn): boolean {
  const way = times(direction, Math.max(1, Math.abs(answer?.record.translation ?? 0)));
  return [...poses.moving, ...poses.fixed, ...way, moving.radius, ...moving.middle, fixed.radius, ...fixed.middle].every((x) => Math.abs(x) < FAR);
}

/** Returns balls around the visible objects: the bodies, the moving one at its start and its stop, the arrow. */
export function seen(state: State, answer: PageCast | undefined, moving: Drawn, fixed: Drawn): Ball[] {
  const start = placed(state.poses.moving, moving.middle);
  const balls: Ball[] = [[start, moving.radius], [placed(state.poses.fixed, fixed.middle), fixed.radius]];
  const t = answer?.record.translation;
  if (t !== undefined && t > 0) balls.push([add(start, times(state.direction, t)), moving.radius]);
  // The tip of the arrow, which is slightly farther out when all of it is in the picture.
  const reach = 1.1 * moving.radius + 0.2 * (moving.radius + fixed.radius);
  balls.push([add(start, times(unit(state.direction), reach)), 0]);
  return balls;
}

/** Returns the centre of balls, and half of their extent. */
export function extent(balls: Ball[]): { origin: Vec; size: number } {
  let [low, high]: [Vec, Vec] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const [at, r] of balls) {
    low = low.map((x, k) => Math.min(x, at[k]! - r)) as Vec;
    high = high.map((x, k) => Math.max(x, at[k]! + r)) as Vec;
  }
  return { origin: times(add(low, high), 0.5), size: Math.max(length(sub(high, low)) / 2, 1e-9) };
}

/** Returns the distance of the eye at which a ball fills the picture. */
export function distance(size: number, fov: number, aspect: number): number {
  return (0.86 * size) / Math.sin((fov * Math.PI) / 360) / Math.min(1, aspect);
}

/** Returns a view from the side, so that the travel appears long, slightly from above, and with the contact visible. */
export function bestSide(direction: Vec, answer: PageCast | undefined): Vec {
  const d = unit(direction);
  const normal = touch(answer)?.normal;
  const candidates: Vec[] = [[-0.62, -0.68, 0.4], [0.62, -0.68, 0.4], [-0.62, 0.68, 0.4], [0.62, 0.68, 0.4]];
  const score = (v: Vec) => -Math.abs(dot(v, d)) - (normal ? 0.8 * dot(v, normal) : 0);
  return candidates.reduce((best, v) => (score(v) > score(best) ? v : best));
}
