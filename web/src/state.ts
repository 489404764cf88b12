// The question as a value, and as the part of an address after `#`.

import type { Slot, Start, Take } from "./engine";
import { EXAMPLES, FIRST, type Part } from "./examples";
import type { Pose, Vec } from "./math";

export type Solver = "auto" | "cta" | "portal";
export type Tab = "answer" | "motion" | "found" | "assembly";

/** A rotation about an axis through a point with a translation along it: a hinge without a translation, a slide without a rotation. */
export interface Screw {
  point: Vec;
  axis: Vec;
  /** In degrees. */
  angle: number;
  rise: number;
}

export interface State {
  /** Files of `data/`, names of files that the visitor dropped, or names such as `sphere:0.5`. */
  parts: Record<Slot, Part>;
  poses: Record<Slot, Pose>;
  direction: Vec;
  graze: number;
  /** `null` stands for the tolerance that follows from the files. */
  tolerance: number | null;
  ignore: boolean;
  solver: Solver;
  /** Start of the paper's algorithm, and the gap at which it ends; `null` for its own end. */
  start: Start;
  until: number | null;
  /** Whether the distance of the bodies at their poses is shown. */
  near: boolean;
  /** The position at which the moving body is shown, in multiples of the direction; `null` for its start. */
  t: number | null;
  tab: Tab;
  motion: {
    /** `null` stands for a motion that the page chooses. */
    screw: Screw | null;
    /** The body that moves; the other one rests. */
    body: Slot;
    /** A minimum gap. */
    minGap: number;
    /** The time from 0 to 1 at which the moving body is shown. */
    time: number;
  };
  assembly: {
    direction: Vec;
    /** `null` stands for the tolerance that follows from the precision of the files. */
    tolerance: number | null;
    ignore: boolean;
    /** The part whose removal map is shown. */
    part: number | null;
  };
}

/** The pose of a body as in its file. */
export const IN_FILE: Readonly<Pose> = [0, 0, 0, 0, 0, 0, 1];

export const otherOf = (slot: Slot): Slot => (slot === "moving" ? "fixed" : "moving");

export function fromExample(name: string): State {
  const example = EXAMPLES[Object.hasOwn(EXAMPLES, name) ? name : FIRST]!;
  return {
    parts: { moving: { ...example.moving }, fixed: { ...example.fixed } },
    poses: { moving: [...example.movingPose], fixed: [...example.fixedPose] },
    direction: [...example.direction],
    graze: 0,
    tolerance: null,
    ignore: false,
    solver: example.solver ?? "auto",
    start: "center",
    until: null,
    near: false,
    t: null,
    tab: "answer",
    motion: { screw: null, body: "moving", minGap: 0, time: 0 },
    assembly: { direction: [0, 0, 1], tolerance: null, ignore: false, part: null },
  };
}

const TAKES: Take[] = ["convex", "hull", "solid", "open"];
const SOLVERS: Solver[] = ["auto", "cta", "portal"];
export const TABS: Tab[] = ["answer", "motion", "found", "assembly"];

/** Writes the state as text for an address. Numbers keep their bits. */
export function toHash(state: State): string {
  const fields: [string, string | undefined][] = [
    ["m", `${state.parts.moving.file}:${state.parts.moving.take}`],
    ["f", `${state.parts.fixed.file}:${state.parts.fixed.take}`],
    ["mp", state.poses.moving.join(",")],
    ["fp", state.poses.fixed.join(",")],
    ["d", state.direction.join(",")],
    ["graze", state.graze ? String(state.graze) : undefined],
    ["tol", state.tolerance === null ? undefined : String(state.tolerance)],
    ["ignore", state.ignore ? "1" : undefined],
    ["solver", state.solver === "auto" ? undefined : state.solver],
    ["start", state.solver !== "cta" || state.start === "center" ? undefined : state.start],
    ["until", state.solver !== "cta" || state.until === null ? undefined : String(state.until)],
    ["near", state.near ? "1" : undefined],
    ["t", state.t === null ? undefined : String(state.t)],
    ["tab", state.tab === "answer" ? undefined : state.tab],
    ...(state.tab === "motion" ? motionFields(state) : []),
    ...(state.tab === "assembly" ? assemblyFields(state) : []),
  ];
  const given = fields.filter((field): field is [string, string] => field[1] !== undefined);
  return `#${given.map(([key, value]) => `${key}=${encodeURIComponent(value).replace(/%(2C|3A|2F)/g, decodeURIComponent)}`).join("&")}`;
}

function motionFields({ motion: { screw, body, minGap, time } }: State): [string, string | undefined][] {
  return [
    ["screw", screw ? [screw.point, screw.axis, screw.angle, screw.rise].join() : undefined],
    ["moves", body === "fixed" ? body : undefined],
    ["gap", minGap ? String(minGap) : undefined],
    ["time", time ? String(time) : undefined],
  ];
}

function assemblyFields({ assembly: { direction, tolerance, ignore, part } }: State): [string, string | undefined][] {
  return [
    ["ad", direction.join(",")],
    ["atol", tolerance === null ? undefined : String(tolerance)],
    ["aignore", ignore ? "1" : undefined],
    ["apart", part === null ? undefined : String(part)],
  ];
}

/** Reads the state of an address. Missing or invalid fields are as in the first example. */
export function fromHash(hash: string): State {
  const fields = new URLSearchParams(hash.replace(/^#/, "").replaceAll("+", "%2B"));
  const example = fields.get("example");
  const state = fromExample(example ?? FIRST);
  const numbers = (key: string, count: number): number[] | undefined => {
    const read = fields.get(key)?.split(",").map(Number);
    return read?.length === count && read.every(Number.isFinite) ? read : undefined;
  };
  const part = (key: string): Part | undefined => {
    const [, file, take] = fields.get(key)?.match(/^(.+):([a-z]+)$/) ?? [];
    return file && TAKES.includes(take as Take) ? { file, take: take as Take } : undefined;
  };
  state.parts.moving = part("m") ?? state.parts.moving;
  state.parts.fixed = part("f") ?? state.parts.fixed;
  state.poses.moving = (numbers("mp", 7) as Pose) ?? state.poses.moving;
  state.poses.fixed = (numbers("fp", 7) as Pose) ?? state.poses.fixed;
  state.direction = (numbers("d", 3) as Vec) ?? state.direction;
  state.graze = numbers("graze", 1)?.[0] ?? 0;
  state.tolerance = numbers("tol", 1)?.[0] ?? null;
  state.ignore = fields.get("ignore") === "1";
  state.solver = SOLVERS.find((s) => s === fields.get("solver")) ?? state.solver;
  state.start = fields.get("start") === "ellipsoids" ? "ellipsoids" : "center";
  const until = numbers("until", 1)?.[0] ?? null;
  state.until = until !== null && until >= 0 ? until : null;
  state.near = fields.get("near") === "1";
  state.t = numbers("t", 1)?.[0] ?? null;
  state.tab = TABS.find((tab) => tab === fields.get("tab")) ?? "answer";
  const { assembly, motion } = state;
  const [x, y, z, a, b, c, angle, rise] = numbers("screw", 8) ?? [];
  if (rise !== undefined) motion.screw = { point: [x!, y!, z!], axis: [a!, b!, c!], angle: angle!, rise };
  if (fields.get("moves") === "fixed") motion.body = "fixed";
  motion.minGap = Math.max(0, numbers("gap", 1)?.[0] ?? 0);
  motion.time = Math.min(1, Math.max(0, numbers("time", 1)?.[0] ?? 0));
  assembly.direction = (numbers("ad", 3) as Vec) ?? assembly.direction;
  assembly.tolerance = numbers("atol", 1)?.[0] ?? null;
  assembly.ignore = fields.get("aignore") === "1";
  assembly.part = numbers("apart", 1)?.[0] ?? null;
  return state;
}
