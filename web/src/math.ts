// Vectors, quaternions and poses in double precision. A pose is x, y, z, qx, qy, qz, qw.

export type Vec = [number, number, number];
export type Pose = [number, number, number, number, number, number, number];

export const AT_HOME: Pose = [0, 0, 0, 0, 0, 0, 1];

export const add = (a: Vec, b: Vec): Vec => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec, b: Vec): Vec => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (a: Vec, s: number): Vec => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec, b: Vec): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const length = (a: Vec): number => Math.hypot(a[0], a[1], a[2]);
export const cross = (a: Vec, b: Vec): Vec => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** Normalises a vector; returns the x axis for a zero vector. */
export function unit(a: Vec): Vec {
  const l = length(a);
  return l > 0 ? times(a, 1 / l) : [1, 0, 0];
}

/** Returns two unit vectors that complete a unit vector to a right-handed frame; the second one points up as far as possible. */
export function lateral(d: Vec): [Vec, Vec] {
  const up: Vec = Math.abs(d[2]) < 0.9 ? [0, 0, 1] : [0, 1, 0];
  const first = unit(cross(up, d));
  return [first, cross(d, first)];
}

/** Rotates a vector by a pose. */
export function turned(pose: Pose, v: Vec): Vec {
  const l = Math.hypot(pose[3], pose[4], pose[5], pose[6]) || 1;
  const q: Vec = [pose[3] / l, pose[4] / l, pose[5] / l];
  const t = times(cross(q, v), 2);
  return add(add(v, times(t, pose[6] / l)), cross(q, t));
}

/** Transforms a point of a body to the world. */
export const placed = (pose: Pose, v: Vec): Vec => add([pose[0], pose[1], pose[2]], turned(pose, v));

/** Returns the corners of the convex hull of points in the plane, counter-clockwise. */
export function hull(points: [number, number][]): [number, number][] {
  const sorted = points.slice().sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (all: [number, number][]) => {
    const chain: [number, number][] = [];
    for (const p of all) {
      for (;;) {
        const [a, b] = [chain.at(-2), chain.at(-1)];
        if (!a || !b || (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        chain.pop();
      }
      chain.push(p);
    }
    chain.pop();
    return chain;
  };
  return sorted.length < 3 ? sorted : [...half(sorted), ...half(sorted.reverse())];
}

/** Formats a number with up to six significant digits. */
export function short(x: number, digits = 6): string {
  if (x === 0) return "0";
  if (!Number.isFinite(x)) return x > 0 ? "∞" : "−∞";
  const size = Math.abs(x);
  if (size < 1e-4 || size >= 1e6) return minus(x.toExponential(1).replace("e+", "e"));
  return minus(String(Number(x.toPrecision(digits))));
}

const minus = (text: string) => text.replace(/-/g, "−");

/** Formats a vector; rounding errors around 0 become 0. */
export const shown = (v: Vec): string => v.map((x) => short(Math.abs(x) < 1e-12 ? 0 : x, 4)).join(", ");
