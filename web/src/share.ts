// The question as a command; `programs` has other forms.

import type { Slot, Take } from "./engine";
import type { State } from "./state";

export const isHome = (pose: number[]) => pose.join() === "0,0,0,0,0,0,1";
export const quoted = (file: string) => (/^[\w.,:/-]+$/.test(file) ? file : `'${file.replaceAll("'", String.raw`'\''`)}'`);
export const isSolid = (take: Take) => take === "solid" || take === "open";
export const files = (state: State): Record<Slot, string> => ({
  moving: state.parts.moving.file.split("/").at(-1)!,
  fixed: state.parts.fixed.file.split("/").at(-1)!,
});

/** Returns undefined if no command asks this question. */
export function asCommand(state: State): string | undefined {
  const { moving, fixed } = files(state);
  const solids = isSolid(state.parts.moving.take) || isSolid(state.parts.fixed.take);
  const hull = Object.values(state.parts).some(({ take }) => take === "hull");
  if (solids && hull) return undefined;
  const words = solids
    ? ["colltrans", "clearance", quoted(moving), "--from", quoted(fixed)]
    : ["colltrans", "cast", quoted(moving), quoted(fixed)];
  words.push(`--direction=${state.direction.join(",")}`);
  for (const slot of ["moving", "fixed"] as const) {
    if (!isHome(state.poses[slot])) words.push(`--${slot}-pose=${state.poses[slot].join(",")}`);
    if (!solids && state.parts[slot].take === "hull") words.push(`--hull-${slot}`);
  }
  if (solids) {
    if (state.tolerance !== null) words.push(`--tolerance=${state.tolerance}`);
    if (state.ignore) words.push("--ignore-start-overlaps");
    if (state.parts.moving.take === "open" || state.parts.fixed.take === "open") words.push("--open");
  } else {
    if (state.graze) words.push(`--graze-tolerance=${state.graze}`);
    if (state.solver !== "auto") words.push(`--solver=${state.solver}`);
    if (state.solver === "cta" && state.start !== "center") words.push(`--start=${state.start}`);
    if (state.solver === "cta" && state.until !== null) words.push(`--until=${state.until}`);
  }
  return words.join(" ");
}
