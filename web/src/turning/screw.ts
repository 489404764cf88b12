// A screw as a function of time, for pictures, and an initial screw. Answers come from the library.

import { type Pose, type Vec, add, cross, length, placed, sub, times, turned, unit } from "../math";
import type { Slot } from "../engine";
import { type Screw, otherOf } from "../state";
import type { Drawn } from "../view/body";

export const RADIANS = Math.PI / 180;

/** Moves a point by a screw to a time. An axis without a direction moves nothing. */
export function carried({ point, axis, angle, rise }: Screw, v: Vec, time: number): Vec {
  if (!length(axis)) return v;
  const turn = rotation(axis, angle * time);
  return add(add(point, turned(turn, sub(v, point))), times(unit(axis), rise * time));
}

/** Returns the pose of a body at a time, from its pose at the start. */
export function poseAt(screw: Screw, start: Pose, time: number): Pose {
  const at = carried(screw, [start[0], start[1], start[2]], time);
  if (!length(screw.axis)) return start;
  const [, , , ax, ay, az, aw] = rotation(screw.axis, screw.angle * time);
  const [, , , bx, by, bz, bw] = start;
  return [
    ...at,
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

function rotation(axis: Vec, degrees: number): Pose {
  const half = (degrees * RADIANS) / 2;
  return [0, 0, 0, ...times(unit(axis), Math.sin(half)), Math.cos(half)];
}

/** Returns a hinge about which a body swings to the other one and beyond. */
export function hinge(poses: Record<Slot, Pose>, bodies: Record<Slot, Drawn>, body: Slot): Screw {
  const [from, to] = [body, otherOf(body)].map((slot) => placed(poses[slot], bodies[slot].middle)) as [Vec, Vec];
  const way = sub(to, from);
  const size = bodies.moving.radius + bodies.fixed.radius;
  const fine = 10 ** Math.ceil(1.5 - Math.log10(size));
  const round = (v: Vec) => v.map((x) => Math.round(x * fine) / fine || 0) as Vec;
  if (length(way) < 1e-3 * size) return { point: round(from), axis: [0, 0, 1], angle: 90, rise: 0 };
  // The axis is horizontal and perpendicular to the way; a quarter turn brings the middles together.
  const d = unit(way);
  const axis: Vec = Math.hypot(d[0], d[1]) > 0.1 ? unit(cross(d, [0, 0, 1])) : [0, 1, 0];
  const level = axis.map((x) => Math.round(x * 1e4) / 1e4 || 0) as Vec;
  const point = add(add(from, times(way, 0.5)), times(cross(unit(level), way), 0.5));
  return { point: round(point), axis: level, angle: 120, rise: 0 };
}
