// A grid under everything, with a mesh of round numbers.

import { BufferGeometry, LineBasicMaterial, LineSegments, type Vector3 } from "three";
import type { Slot } from "../engine";
import type { State } from "../state";
import { type Bodies, highest } from "./body";
import { type Frame, inPicture } from "./shapes";

export class Ground {
  /** The mesh width. */
  step = 1;
  /** The position of the grid, and the objects for which it was computed. */
  private known: { of: unknown[]; low: number } = { of: [], low: 0 };

  grid(frame: Frame, bodies: Bodies, state: State): LineSegments {
    const { size, origin, colours } = frame;
    const step = (this.step = 10 ** Math.floor(Math.log10(size / 1.5)));
    const low = this.low(size, bodies, state.poses);
    const snap = (x: number) => Math.round(x / step) * step;
    const count = Math.ceil((1.5 * size) / step);
    const [x, y] = [snap(origin[0]), snap(origin[1])];
    const reach = step * count;
    const points: Vector3[] = [];
    for (let k = -count; k <= count; k++) {
      points.push(inPicture(frame, [x + k * step, y - reach, low]), inPicture(frame, [x + k * step, y + reach, low]));
      points.push(inPicture(frame, [x - reach, y + k * step, low]), inPicture(frame, [x + reach, y + k * step, low]));
    }
    const look = new LineBasicMaterial({ color: colours.grid, transparent: true, opacity: 0.45 });
    return new LineSegments(new BufferGeometry().setFromPoints(points), look);
  }

  private low(size: number, bodies: Bodies, poses: State["poses"]): number {
    const now = [bodies.moving, bodies.fixed, poses.moving.join(), poses.fixed.join(), size];
    if (!now.every((value, k) => value === this.known.of[k])) {
      const lows = (["moving", "fixed"] as Slot[]).flatMap((slot) => {
        const body = bodies[slot];
        return body ? [-highest(body.body, poses[slot], [0, 0, -1])] : [];
      });
      this.known = { of: now, low: lows.length ? Math.min(...lows) - 0.02 * size : 0 };
    }
    return this.known.low;
  }
}
