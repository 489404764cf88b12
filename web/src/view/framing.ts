// From where the picture is seen, and how large it is.

import type { PageCast } from "../answers";
import { touch } from "../engine";
import { type Vec, add, dot, length, placed, sub, times, unit } from "../math";
import type { State } from "../state";
import type { Drawn } from "./body";

/** Single precision, in which pictures are computed, holds no more. */
const FAR = 1e30;

/** A middle and a radius. */
export type Ball = [Vec, number];

/** Whether a picture can be made: numbers may be larger than it holds, until the library has refused them and
 * even where it answers. */
export function drawable({ poses, direction }: State, answer: PageCast | undefined, moving: Drawn, fixed: Drawn): boolean {
  const way = times(direction, Math.max(1, Math.abs(answer?.record.translation ?? 0)));
  return [...poses.moving, ...poses.fixed, ...way, moving.radius, ...moving.middle, fixed.radius, ...fixed.middle].every((x) => Math.abs(x) < FAR);
}

/** Balls around what is seen: the bodies, the moving one where it starts and where it stops, the arrow. */
export function seen(state: State, answer: PageCast | undefined, moving: Drawn, fixed: Drawn): Ball[] {
  const start = placed(state.poses.moving, moving.middle);
  const balls: Ball[] = [[start, moving.radius], [placed(state.poses.fixed, fixed.middle), fixed.radius]];
  const t = answer?.record.translation;
  if (t !== undefined && t > 0) balls.push([add(start, times(state.direction, t)), moving.radius]);
  // The arrow's tip, which is a little farther out when all of it is in the picture.
  const reach = 1.1 * moving.radius + 0.2 * (moving.radius + fixed.radius);
  balls.push([add(start, times(unit(state.direction), reach)), 0]);
  return balls;
}

/** The middle of balls, and half of their extent. */
export function extent(balls: Ball[]): { origin: Vec; size: number } {
  let [low, high]: [Vec, Vec] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const [at, r] of balls) {
    low = low.map((x, k) => Math.min(x, at[k]! - r)) as Vec;
    high = high.map((x, k) => Math.max(x, at[k]! + r)) as Vec;
  }
  return { origin: times(add(low, high), 0.5), size: Math.max(length(sub(high, low)) / 2, 1e-9) };
}

/** How far away the eye is for a ball to fill the picture. */
export function distance(size: number, fov: number, aspect: number): number {
  return (0.86 * size) / Math.sin((fov * Math.PI) / 360) / Math.min(1, aspect);
}

/** From the side, so that the way is long, a little from above; where the fixed body does not hide the contact. */
export function bestSide(direction: Vec, answer: PageCast | undefined): Vec {
  const d = unit(direction);
  const normal = touch(answer)?.normal;
  const candidates: Vec[] = [[-0.62, -0.68, 0.4], [0.62, -0.68, 0.4], [-0.62, 0.68, 0.4], [0.62, 0.68, 0.4]];
  const score = (v: Vec) => -Math.abs(dot(v, d)) - (normal ? 0.8 * dot(v, normal) : 0);
  return candidates.reduce((best, v) => (score(v) > score(best) ? v : best));
}
