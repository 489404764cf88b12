// The distance or the depth of the bodies at their poses: queried from a library of its own, described and drawn.

import { MeshBasicMaterial, type Object3D } from "three";
import type { DepthAnswer, DistanceAnswer, PageDistance } from "./answers";
import { Engine, type Pair, type Slot } from "./engine";
import { type Vec, add, short, shown, times } from "./math";
import { Placing, type Source } from "./placing";
import { type Frame, type Label, above, ball, inPicture, line, rod } from "./view/shapes";
import { feature } from "./words";

/** The text and the drawing next to the answer. */
export interface Nearness {
  told: PageDistance;
  sentence: string;
  rows: [string, string][];
  draw(frame: Frame): { parts: Object3D[]; labels: Label[] };
}

export class Near {
  private readonly engine = new Engine("colltrans_distance");
  private readonly placing = new Placing(this.engine);

  async ask(sources: Record<Slot, Source>, { moving_pose, fixed_pose }: Pair): Promise<Nearness> {
    await this.placing.place(sources);
    const { facts } = await this.engine.ask({ do: "distance", moving_pose, fixed_pose });
    return { told: facts, ...say(facts), draw: (frame) => draw(frame, facts) };
  }
}

const proven = ({ lower, upper }: DistanceAnswer | DepthAnswer) => `${short(lower ?? 0, 15)} to ${short(upper ?? 0, 15)}`;

function say({ distance, depth }: PageDistance): Pick<Nearness, "sentence" | "rows"> {
  if (!depth) {
    const { upper = 0, features } = distance;
    return {
      sentence: `At their poses they are ${short(upper)} apart.`,
      rows: [
        ["distance now", short(upper, 12)],
        ["proven", proven(distance)],
        ...(features ? [["moving, nearest", feature(features.moving)], ["fixed, nearest", feature(features.fixed)]] as [string, string][] : []),
      ],
    };
  }
  const { upper, direction, start_overlaps } = depth;
  if (direction && upper) {
    return {
      sentence: `At their poses they overlap: the shortest way out is ${short(upper)} long.`,
      rows: [["depth now", short(upper, 12)], ["proven", proven(depth)], ["way out", shown(direction as Vec)]],
    };
  }
  const tolerance = start_overlaps?.[0]?.least_tolerance;
  return {
    sentence: start_overlaps ? `At their poses they overlap${tolerance ? `: with a tolerance of ${short(tolerance)} they would not` : ""}.` : "At their poses they touch.",
    rows: tolerance ? [["depth now", short(tolerance, 9)]] : [],
  };
}

/** Draws the nearest points with a segment, or the shortest way out from a common point. */
function draw(frame: Frame, { distance, depth }: PageDistance): { parts: Object3D[]; labels: Label[] } {
  const [from, to] = (distance.points ?? []) as Vec[];
  if (!from || !to) return { parts: [], labels: [] };
  const { size, colours } = frame;
  const [start, way] = [inPicture(frame, from), depth?.direction as Vec | undefined];
  const dot = () => new MeshBasicMaterial({ color: colours.normal });
  const end = inPicture(frame, way ? add(from, times(way, depth?.upper ?? 0)) : to);
  const long = start.distanceTo(end);
  const parts = way && depth?.upper && long > 1e-3 * size
    ? [rod(start, end, colours.normal, 0.008 * size)]
    : [line([start, end], colours.normal), ball(start, 0.013 * size, dot()), ball(end, 0.013 * size, dot())];
  parts.forEach(above);
  const upper = depth ? depth.upper : distance.upper;
  const text = depth ? (way && upper ? `depth ${short(upper)}` : "") : short(upper ?? 0);
  const middle = start.clone().lerp(end, 0.5);
  return { parts, labels: text ? [{ text, start: middle, end: middle, kind: "normal" }] : [] };
}
