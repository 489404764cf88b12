// The question about a motion as a command.

import { times, unit } from "../math";
import { files, isHome, quoted } from "../share";
import type { Screw, State } from "../state";

export function asCommand(state: State, { point, axis, angle, rise }: Screw): string {
  const { moving, fixed } = files(state);
  const words = ["colltrans", "motion", quoted(moving), quoted(fixed)];
  const option = state.motion.body === "fixed" ? "--fixed-" : "--";
  if (angle) words.push(`${option}${rise ? "screw" : "turn"}`, point.join(","), axis.join(","), String(angle), ...(rise ? [String(rise)] : []));
  else words.push(`${option}slide=${times(unit(axis), rise).join(",")}`);
  for (const slot of ["moving", "fixed"] as const) {
    if (!isHome(state.poses[slot])) words.push(`--${slot}-pose=${state.poses[slot].join(",")}`);
    if (state.parts[slot].take === "hull") words.push(`--hull-${slot}`);
  }
  if (Object.values(state.parts).some(({ take }) => take === "open")) words.push("--open");
  if (state.motion.minGap) words.push(`--min-gap=${state.motion.minGap}`);
  if (state.tolerance !== null) words.push(`--tolerance=${state.tolerance}`);
  return words.join(" ");
}
