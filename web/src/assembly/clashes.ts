// A pair of parts that overlap or are too close, in three dimensions: both parts translucent, all others pale, the
// measured line at the place, and a cut through it.

import { Group, MeshLambertMaterial, Vector3 } from "three";
import { type Vec, sub } from "../math";
import { above, ball, clear, rod } from "../view/shapes";
import type { Move, Parts } from "./parts";
import { Section } from "./section";

export interface Clash {
  /** Indices of the parts. The first one moves. */
  parts: [number, number];
  /** The nearest points of both parts, or a point and where the shortest way out that was found moves it; relative to the middle of the assembly. */
  line: [Vec, Vec];
  /** Whether the line is the shortest way out that was found. */
  parts_by_moving: boolean;
  /** Half the extent of the neighbourhood to show. */
  radius: number;
  /** Normal of the plane of the section. */
  normal: Vec;
}

/** Colour of the line, and colours of the first and second part, as in sections. */
const LINE = "#b01657";
const PAINTS = ["#6f97d6", "#d9cbb0"];
/** Opacities of the pair and of the other parts. */
const [PAIR, OTHERS] = [0.62, 0.08];

/** Returns the shortest way out that was found, as moves. */
export const wayOut = ({ parts: [moving], line: [from, to], parts_by_moving }: Clash): Move[] =>
  parts_by_moving ? [[{ parts: [moving], way: sub(to, from) }]] : [];

/** Describes the slider over the way out. */
export const MOTION = "Shortest way out that was found";

/** Describes the motion of a part along its way out. */
export const wayText = (name: string | undefined): string => `${MOTION}, of ${name}`;

/** Shows a pair and moves the camera to it; without a pair, shows all parts as they are. */
export class Marker {
  private readonly group = new Group();
  private readonly cut: Section;
  private clash: Clash | undefined;

  constructor(private readonly seen: Parts) {
    seen.scene.add(this.group);
    this.cut = new Section(seen, [PAINTS[0]!, PAINTS[1]!, LINE], () => this.paint());
  }

  /** The controls of the cut. */
  get element(): HTMLElement {
    return this.cut.element;
  }

  /** Colours the parts. Those of the pair are opaque if they are cut, so that the cut hides what is behind it. */
  private paint() {
    const { clash, seen } = this;
    const pair = this.cut.isOn ? 1 : PAIR;
    seen.fade((part) => (!clash ? 1 : clash.parts.includes(part) ? pair : OTHERS), (part) => clash && PAINTS[clash.parts.indexOf(part)]);
  }

  show(clash: Clash | undefined) {
    clear(this.group);
    this.clash = clash;
    this.cut.show(clash && { ...clash, at: clash.line[0] });
    if (clash) {
      const { line, parts_by_moving, radius } = clash;
      const [from, to] = line.map((end) => new Vector3(...end)) as [Vector3, Vector3];
      const width = 0.012 * radius;
      const long = from.distanceTo(to);
      // An arrow shorter than its head would not be visible.
      if (parts_by_moving && long > 0) to.sub(from).setLength(Math.max(long, 12 * width)).add(from);
      if (long > 0) this.group.add(parts_by_moving ? rod(from, to, LINE, width) : rod(from, to, LINE, 0.4 * width));
      const look = () => new MeshLambertMaterial({ color: LINE, emissive: LINE, emissiveIntensity: 0.35 });
      for (const end of parts_by_moving ? [from] : [from, to]) this.group.add(ball(end, 1.6 * width, look()));
      above(this.group);
      this.seen.focus(line[0], radius);
    }
    this.paint();
  }
}
