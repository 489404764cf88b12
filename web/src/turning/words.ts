// An answer about a motion as text.

import type { PageMotion, PageProve } from "../answers";
import { type Vec, short, shown } from "../math";
import type { Screw, State } from "../state";
import { isSolid } from "../share";
import { type Said, feature, met } from "../words";

/** Describes the position on a screw at a time. */
export function gone({ angle, rise }: Screw, time: number): string {
  const ways = [angle || !rise ? `${short(angle * time)}°` : "", rise ? `${short(rise * time)} along the axis` : ""];
  return ways.filter(Boolean).join(", ");
}

export function say({ record }: PageMotion, screw: Screw, state: State): Said {
  const { minGap } = state.motion;
  const { outcome, time, features, normal, point, looks = 0, planes, tolerance } = record;
  const rows: [string, string][] = [];
  const near = minGap ? `come as near as ${short(minGap)}` : "meet";
  if (time) {
    const { lower, upper } = time;
    rows.push(["time", `${short(lower, 12)} of the motion`], ["proven", upper === undefined ? `not before ${short(lower, 15)}` : `${short(lower, 15)} to ${short(upper, 15)}`]);
    if (screw.angle) rows.push(["angle", `${short(screw.angle * lower, 12)}°`]);
    if (screw.rise) rows.push(["along the axis", short(screw.rise * lower, 12)]);
  }
  if (normal) rows.push(["normal n", shown(normal as Vec)]);
  if (point) rows.push(["point", point.map((x) => short(Math.abs(x) < 1e-12 ? 0 : x, 7)).join(", ")]);
  if (features) rows.push(["moving", feature(features.moving)], ["fixed", feature(features.fixed)]);
  if (tolerance) rows.push(["tolerance", short(tolerance, 3)]);
  rows.push(["looked at", `${looks} times${planes === undefined ? "" : `, ${planes} planes in the proof`}`]);
  switch (outcome) {
    case "contact": {
      const what = features && !minGap ? `then ${met(features.moving, "moving", state)} meets ${met(features.fixed, "fixed", state)}` : `then they ${near}`;
      return { kind: "stop", headline: `Contact at ${gone(screw, time!.lower)}`, sentence: `Free for ${short(100 * time!.lower)} % of the motion; ${what}.`, rows };
    }
    case "grazing":
      return {
        kind: "care", headline: `They graze at ${gone(screw, time!.lower)}`,
        sentence: `They come closer than rounding can resolve. They do not ${near} before; later times are not examined. A tolerance lets them continue.`, rows,
      };
    case "undecided":
      return {
        kind: "care", headline: `Free until ${gone(screw, time!.lower)}, then open`,
        sentence: `The search took its maximum number of steps. Proven: they do not ${near} before. Later contacts are open.`, rows,
      };
    case "overlapping":
      return { kind: "care", headline: "They overlap at the start", sentence: minGap ? "Or they are closer than the minimum gap." : "Later times are not examined.", rows };
    default:
      return { kind: "free", headline: "The whole motion is free", sentence: `Proven: at no time of the motion do they ${near}.`, rows };
  }
}

export function judged(told: PageProve, planes: boolean): { holds: boolean; text: string } {
  if (!told.holds) return { holds: false, text: `✗ ${told.because}` };
  const [lower, upper] = told.proven;
  const what = `${told.entries.toLocaleString("en")} ${planes ? "planes" : "entries"} checked`;
  const free = lower === 1 ? "nothing on the whole way" : `nothing before ${lower}`;
  return { holds: true, text: `✓ it holds: ${what}; ${free}${typeof upper === "number" ? `, contact by ${upper}` : ""}` };
}

/** Checks whether a body is used as a solid. */
export const solids = (state: State) => Object.values(state.parts).some(({ take }) => isSolid(take));
