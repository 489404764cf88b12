// Pairs of bodies to begin with. Their files are in `data/`, and served beside the page.

import type { Slot, Take } from "./engine";
import { AT_HOME, type Pose, type Vec } from "./math";

export interface Part {
  file: string;
  take: Take;
}

export interface Example {
  title: string;
  moving: Part;
  fixed: Part;
  movingPose: Pose;
  fixedPose: Pose;
  direction: Vec;
  solver?: "cta";
}

const convex = (file: string): Part => ({ file, take: "convex" });
const solid = (file: string): Part => ({ file, take: "solid" });
const at = (x: number, y: number, z: number): Pose => [x, y, z, 0, 0, 0, 1];

export const EXAMPLES: Record<string, Example> = {
  bracket: {
    title: "A dodecahedron onto a bracket",
    moving: convex("dodecahedron.off"),
    fixed: convex("bracket.obj"),
    movingPose: [6, 1, 9, 0.2, 0.3, 0.1, 0.9273618495495704],
    fixedPose: AT_HOME,
    direction: [-0.3, 0.1, -1],
  },
  plate: {
    title: "A bolt into the hole of a plate (not convex)",
    moving: solid("bolt.stl"),
    fixed: solid("plate.off"),
    movingPose: at(0, 0, 7),
    fixedPose: AT_HOME,
    direction: [0, 0, -1],
  },
  ellipsoids: {
    title: "Two ellipsoids",
    moving: convex("ellipsoid_a.obj"),
    fixed: convex("ellipsoid_b.off"),
    movingPose: [0.4, 0.2, 10, 0.2, 0.3, 0.1, 0.9273618495495704],
    fixedPose: AT_HOME,
    direction: [0.1, 0, -1],
  },
  slide: {
    title: "Two brackets that only slide along each other",
    moving: convex("bracket.obj"),
    fixed: convex("bracket.obj"),
    movingPose: at(-9, 2, 0),
    fixedPose: AT_HOME,
    direction: [1, 0, 0],
  },
  miss: {
    title: "Two that never meet",
    moving: convex("dodecahedron.off"),
    fixed: convex("gear_hull.stl"),
    movingPose: at(-9, 0, 6),
    fixedPose: AT_HOME,
    direction: [1, 0, 0],
  },
  shaft: {
    title: "The shaft of a gearbox out of its housing (not convex)",
    moving: solid("gearbox_small/shaft.off"),
    fixed: solid("gearbox_small/housing.off"),
    movingPose: AT_HOME,
    fixedPose: AT_HOME,
    direction: [0, 0, 1],
  },
};

export const FIRST = "bracket";
export const SLOTS: Slot[] = ["moving", "fixed"];
