// Example pairs of bodies. Their files are in `data/` and are served with the page.

import type { Slot, Take } from "./engine";
import { AT_HOME, type Pose, type Vec } from "./math";

export interface Part {
  /** A file, or the name of a sphere, capsule or box. */
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
  ball: {
    title: "A ball onto a bracket",
    moving: convex("sphere:1.5"),
    fixed: convex("bracket.obj"),
    movingPose: at(6, 1, 9),
    fixedPose: AT_HOME,
    direction: [-0.3, 0.1, -1],
  },
  ellipsoids: {
    title: "Two ellipsoids",
    moving: convex("ellipsoid_a.obj"),
    fixed: convex("ellipsoid_b.off"),
    movingPose: [0.4, 0.2, 10, 0.2, 0.3, 0.1, 0.9273618495495704],
    fixedPose: AT_HOME,
    direction: [0.1, 0, -1],
  },
  thirteen: {
    title: "Two ellipsoids, thirteen planar problems",
    moving: convex("ellipsoid_a.obj"),
    fixed: convex("ellipsoid_b.off"),
    movingPose: [3, 1.1, 10, -0.6843147422804421, 0.64644344763433, -0.2035155951836031, -0.2690828961962411],
    fixedPose: AT_HOME,
    direction: [-0.36, 0.01, -1],
    solver: "cta",
  },
  // The cubes of the pictures in docs/paper.md.
  cubes: {
    title: "The two cubes of the paper's figures",
    moving: convex("cube.off"),
    fixed: convex("cube.off"),
    movingPose: [-1.1, 1, 5, -0.6644105970267493, -0.2847473987257497, 0.18983159915049982, 0.6644105970267493],
    fixedPose: AT_HOME,
    direction: [0.42, -0.3, -1],
    solver: "cta",
  },
  corner: {
    title: "Two cubes, a corner of a section first",
    moving: convex("cube.off"),
    fixed: convex("cube.off"),
    movingPose: [-1.5, -0.8, 5, -0.4662524041201569, -0.6527533657682195, -0.4662524041201569, -0.3730019232961255],
    fixedPose: AT_HOME,
    direction: [0.3, -0.04, -1],
    solver: "cta",
  },
  beside: {
    title: "Two cubes whose first sections miss each other",
    moving: convex("cube.off"),
    fixed: convex("cube.off"),
    movingPose: [-1.1, 1, 5, -0.6644105970267493, -0.2847473987257497, 0.18983159915049982, 0.6644105970267493],
    fixedPose: AT_HOME,
    direction: [0.86, -0.02, -1],
    solver: "cta",
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
