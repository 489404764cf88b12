// Example motions of pairs of bodies of the page.

import { AT_HOME, type Pose } from "../math";
import type { Screw } from "../state";

export interface Example {
  title: string;
  /** A key of `EXAMPLES`. */
  pair: string;
  moving: Pose;
  fixed: Pose;
  screw: Screw;
}

const at = (x: number, y: number, z: number): Pose => [x, y, z, 0, 0, 0, 1];

export const EXAMPLES: Record<string, Example> = {
  hinge: {
    title: "A dodecahedron swung onto a bracket",
    pair: "bracket",
    moving: [6, 1, 9, 0.2, 0.3, 0.1, 0.9273618495495703],
    fixed: AT_HOME,
    screw: { point: [7, 0, 3], axis: [0, -1, 0], angle: 120, rise: 0 },
  },
  bolt: {
    title: "A bolt screwed out of a plate",
    pair: "plate",
    moving: at(0, 0, 2),
    fixed: AT_HOME,
    screw: { point: [0, 0, 0], axis: [0, 0, 1], angle: 720, rise: 7 },
  },
  askew: {
    title: "The same, by an axis a little askew",
    pair: "plate",
    moving: at(0, 0, 2),
    fixed: AT_HOME,
    screw: { point: [0, 0, 0], axis: [0.05, 0, 1], angle: 720, rise: 7 },
  },
  shaft: {
    title: "A shaft tipped out of its housing",
    pair: "shaft",
    moving: at(0, 0, 5),
    fixed: AT_HOME,
    screw: { point: [0, 0, 0], axis: [1, 0, 0], angle: 60, rise: 0 },
  },
};
