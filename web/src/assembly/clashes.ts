// A pair of parts that overlap or are too close, in three dimensions: both parts translucent, all others pale, and the
// measured line at the place.

import { Group, MeshLambertMaterial, Vector3 } from "three";
import { type Vec, sub } from "../math";
import { above, ball, clear, rod } from "../view/shapes";
import type { Move, Parts } from "./parts";

export interface Clash {
  /** Indices of the parts. The first one moves. */
  parts: [number, number];
  /** The nearest points of both parts, or a point and where the least way out moves it; relative to the middle of the assembly. */
  line: [Vec, Vec];
  /** Whether the line is the least way out. */
  parts_by_moving: boolean;
  /** Half the extent of the neighbourhood to show. */
  radius: number;
}

/** Colour of the line, and colours of the first and second part, as in sections. */
const LINE = "#b01657";
const PAINTS = ["#6f97d6", "#d9cbb0"];
/** Opacities of the pair and of the other parts. */
const [PAIR, OTHERS] = [0.62, 0.08];

/** Returns the least way out as moves. */
export const wayOut = ({ parts: [moving], line: [from, to], parts_by_moving }: Clash): Move[] =>
  parts_by_moving ? [[{ parts: [moving], way: sub(to, from) }]] : [];

/** Shows a pair and moves the camera to it; without a pair, only removes the line. */
export class Marker {
  private readonly group = new Group();

  constructor(private readonly seen: Parts) {
    seen.scene.add(this.group);
  }

  show(clash: Clash | undefined) {
    clear(this.group);
    if (clash) {
      const { line, parts, parts_by_moving, radius } = clash;
      const [from, to] = line.map((end) => new Vector3(...end)) as [Vector3, Vector3];
      const width = 0.012 * radius;
      const long = from.distanceTo(to);
      // An arrow shorter than its head would not be visible.
      if (parts_by_moving && long > 0) to.sub(from).setLength(Math.max(long, 12 * width)).add(from);
      if (long > 0) this.group.add(parts_by_moving ? rod(from, to, LINE, width) : rod(from, to, LINE, 0.4 * width));
      const look = () => new MeshLambertMaterial({ color: LINE, emissive: LINE, emissiveIntensity: 0.35 });
      for (const end of parts_by_moving ? [from] : [from, to]) this.group.add(ball(end, 1.6 * width, look()));
      above(this.group);
      this.seen.fade((part) => (parts.includes(part) ? PAIR : OTHERS), (part) => PAINTS[parts.indexOf(part)]);
      this.seen.focus(line[0], radius);
    }
    this.seen.render();
  }
}
