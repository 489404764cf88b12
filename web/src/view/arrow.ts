// The arrow of the direction, from the middle of the moving body; its tip can be dragged.

import { Group, MeshLambertMaterial, type Vector3 } from "three";
import { type Pose, type Vec, add, placed, times, unit } from "../math";
import type { Drawn } from "./body";
import { type Frame, type Label, above, ball, inPicture, rod } from "./shapes";

export interface Arrow {
  group: Group;
  base: Vector3;
  tip: Vector3;
  label: Label;
}

export function arrow(frame: Frame, moving: Drawn, fixed: Drawn, pose: Pose, direction: Vec): Arrow {
  const { size, colours } = frame;
  const middle = placed(pose, moving.middle);
  const reach = 1.05 * moving.radius + 0.14 * Math.min(size, moving.radius + fixed.radius);
  const at = (length: number) => inPicture(frame, add(middle, times(unit(direction), length)));
  const [base, tip] = [at(0), at(reach)];
  const look = { color: colours.way, emissive: colours.way, emissiveIntensity: 0.2 };
  const group = new Group().add(rod(base, tip, colours.way, 0.0065 * size), ball(tip, 0.024 * size, new MeshLambertMaterial(look)));
  // The arrow is visible through the body in which it starts.
  above(group);
  return { group, base, tip, label: { text: "d", start: base, end: tip, kind: "way" } };
}
