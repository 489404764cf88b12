// The distance or the depth of the bodies at their poses: computed by the npm package, described and drawn.

import type { Depth, Distance } from "colltrans";
import { MeshBasicMaterial, type Object3D } from "three";
import { type Body, type Pair, type Slot } from "./engine";
import { SLOTS } from "./examples";
import { type Vec, add, short, shown, times } from "./math";
import type { NearAnswer, NearBody, NearQuestion } from "./near-worker";
import { type Frame, type Label, above, ball, inPicture, line, rod } from "./view/shapes";
import { feature } from "./words";

/** The text and the drawing next to the answer. */
export interface Nearness {
  told: NearAnswer;
  sentence: string;
  rows: [string, string][];
  draw(frame: Frame): { parts: Object3D[]; labels: Label[] };
}

export class Near {
  private readonly worker = new Worker(new URL("near-worker.js", import.meta.url), { type: "module", name: "near" });
  /** The bodies that the worker has. */
  private readonly sent: Partial<Record<Slot, Body>> = {};

  /** Asks one question at a time. */
  async ask(bodies: Record<Slot, Body>, { moving_pose, fixed_pose }: Pair): Promise<Nearness> {
    const fresh = SLOTS.map((slot) => (this.sent[slot] === bodies[slot] ? undefined : nearBody(bodies[slot])));
    for (const slot of SLOTS) delete this.sent[slot];
    const told = await new Promise<NearAnswer>((resolve, reject) => {
      this.worker.onmessage = ({ data }: MessageEvent<NearAnswer | { error: string }>) => ("error" in data ? reject(new Error(data.error)) : resolve(data));
      this.worker.onerror = (event) => reject(new Error(event.message || "the worker could not be started"));
      this.worker.postMessage({ bodies: fresh, poses: [moving_pose, fixed_pose] } satisfies NearQuestion);
    });
    Object.assign(this.sent, bodies);
    return { told, ...say(told), draw: (frame) => draw(frame, told) };
  }
}

/** Returns the data of a body; of a rounded body those of its core. */
const nearBody = ({ facts, vertices, triangles }: Body): NearBody =>
  ({ kind: facts.kind, vertices: vertices.slice(0, 3 * facts.vertices), triangles, closed: facts.closed, radius: facts.radius });

const proven = ({ lower, upper }: Distance | Depth) => `${short(lower, 15)} to ${short(upper, 15)}`;

function say({ distance, depth }: NearAnswer): Pick<Nearness, "sentence" | "rows"> {
  if (!depth) {
    const { upper, features } = distance;
    return {
      sentence: `At their poses they are ${short(upper)} apart.`,
      rows: [
        ["distance now", short(upper, 12)],
        ["proven", proven(distance)],
        ...(features ? [["moving, nearest", feature(features.moving)], ["fixed, nearest", feature(features.fixed)]] as [string, string][] : []),
      ],
    };
  }
  const { upper, direction, overlaps } = depth;
  if (!overlaps) return { sentence: "At their poses they touch.", rows: [] };
  if (!direction || !Number.isFinite(upper)) return { sentence: "At their poses they overlap.", rows: [] };
  return {
    sentence: `At their poses they overlap: the shortest way out is ${short(upper)} long.`,
    rows: [["depth now", short(upper, 12)], ["proven", proven(depth)], ["way out", shown(direction as unknown as Vec)]],
  };
}

/** Draws the nearest points with a segment, or the shortest way out from a common point. */
function draw(frame: Frame, { distance, depth }: NearAnswer): { parts: Object3D[]; labels: Label[] } {
  const [from, to] = [distance.pointOnMoving, distance.pointOnFixed] as unknown as (Vec | null)[];
  if (!from || !to) return { parts: [], labels: [] };
  const { size, colours } = frame;
  const [start, way] = [inPicture(frame, from), (depth?.direction ?? undefined) as Vec | undefined];
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
