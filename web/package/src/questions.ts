// Questions along a direction, which both entries of the package have.

import { QUESTIONS, decode } from "./answers.js";
import type { Behind, Blocked, Contact, ContactRange, Free, Grazing, Intersection, Overlapping, Separated, Slides } from "./answers.js";
import { Body, Placed, handleOf } from "./body.js";
import type { ConvexPolyhedron } from "./body.js";
import { InputError } from "./errors.js";
import type { Library } from "./library.js";
import { number, pose, vector } from "./pose.js";
import type { PoseLike, VectorLike } from "./pose.js";

/** A body, with its pose or without. */
export type Placeable<B extends Body = Body> = B | Placed<B>;

/** Poses of both bodies, for bodies that are not placed by `at(pose)`. */
export interface PoseOptions {
  readonly movingPose?: PoseLike;
  readonly fixedPose?: PoseLike;
}

/** Options of a question along a direction. */
export interface CastOptions {
  /** A minimum gap, a length: the bodies count as meeting when their distance falls to it. Only in `colltrans`. */
  readonly minGap?: number;
  /** Convex bodies: overlaps of the shadows up to this length count as grazing. */
  readonly grazeTolerance?: number;
  /** Convex bodies: the search algorithm. */
  readonly solver?: "auto" | "cta" | "portal";
  /** Solids: both are shrunk by half of this length. The default follows from the precision of the coordinates. */
  readonly tolerance?: number;
  /** Solids: whether facets that cross at the start are ignored. */
  readonly ignoreStartOverlaps?: boolean;
}

/** The answer of `cast`. */
export type CastAnswer = Contact | Grazing | Separated | Free;
/** The answer of `clearance`. */
export type ClearanceAnswer = Blocked | Slides | Behind | Separated | Overlapping | Free;

const SOLVERS = ["auto", "cta", "portal"];
const OPTIONS = ["minGap", "grazeTolerance", "solver", "tolerance", "ignoreStartOverlaps"];

/** Checks that an object has known fields alone. */
export function known(options: object, names: readonly string[]) {
  if (typeof options !== "object" || options === null) throw new InputError("an object is needed", "options");
  for (const name of Object.keys(options)) {
    if (!names.includes(name)) throw new InputError(`unknown option; known options: ${names.join(", ")}`, name);
  }
}

/** Returns the numbers of options. */
export function optionNumbers(options: CastOptions, others: readonly string[]): number[] {
  known(options, [...OPTIONS, ...others]);
  const { minGap = 0, grazeTolerance, solver = "auto", tolerance, ignoreStartOverlaps = false } = options;
  const chosen = SOLVERS.indexOf(solver);
  if (chosen < 0) throw new InputError(`unknown solver ${String(solver)}; known solvers: ${SOLVERS.join(", ")}`, "solver");
  const optional = (given: number | undefined, name: string) => (given === undefined ? NaN : number(given, name));
  return [optional(grazeTolerance, "grazeTolerance"), number(minGap, "minGap"), chosen, optional(tolerance, "tolerance"), Number(ignoreStartOverlaps)];
}

/** Two bodies of a question: their library, numbers and poses. */
export interface Pair {
  library: Library;
  bodies: readonly [number, number];
  poses: readonly number[];
}

function place(given: Placeable, named: PoseLike | undefined, argument: string): [Body, readonly number[]] {
  if (!(given instanceof Placed)) return [given, pose(named, `${argument}Pose`)];
  if (named !== undefined) throw new InputError("the body has a pose already, from at(pose)", `${argument}Pose`);
  return [given.body, given.numbers];
}

/** Reads the bodies of a question. */
export function pair(moving: Placeable, fixed: Placeable, { movingPose, fixedPose }: PoseOptions = {}): Pair {
  const [movingBody, atStart] = place(moving, movingPose, "moving");
  const [fixedBody, atFixed] = place(fixed, fixedPose, "fixed");
  const [p, q] = [handleOf(movingBody, "moving"), handleOf(fixedBody, "fixed")];
  if (p.library !== q.library) {
    throw new InputError(`one body was built by colltrans/cast before colltrans was loaded, and cannot meet a body of ${q.library.name === "colltrans" ? "colltrans" : p.library.name}: import colltrans first`, "fixed");
  }
  return { library: p.library, bodies: [p.number, q.number], poses: [...atStart, ...atFixed] };
}

const POSES = ["movingPose", "fixedPose"];

/** Asks a question about two bodies. */
export function question(which: number, moving: Placeable, fixed: Placeable, direction: readonly number[], options: CastOptions & PoseOptions, length = 0): unknown {
  const { library, bodies, poses } = pair(moving, fixed, options);
  const numbers = [which, ...bodies, ...poses, ...direction, ...optionNumbers(options, POSES), length];
  return decode(new Float64Array(library.call(numbers).numbers));
}

/** Computes the translation along a direction at which two bodies first meet, in multiples of the direction. */
export function cast(moving: Placeable<ConvexPolyhedron>, fixed: Placeable<ConvexPolyhedron>, direction: VectorLike, options?: CastOptions & PoseOptions): Contact | Grazing | Separated;
export function cast(moving: Placeable, fixed: Placeable, direction: VectorLike, options?: CastOptions & PoseOptions): CastAnswer;
export function cast(moving: Placeable, fixed: Placeable, direction: VectorLike, options: CastOptions & PoseOptions = {}): CastAnswer {
  return question(QUESTIONS.Cast, moving, fixed, vector(direction, "direction"), options) as CastAnswer;
}

/** Computes how far the moving body can move from its pose, and what stops it. Contacts behind the body and grazing
 * contacts do not block. */
export function clearance(moving: Placeable<ConvexPolyhedron>, fixed: Placeable<ConvexPolyhedron>, direction: VectorLike, options?: CastOptions & PoseOptions): Exclude<ClearanceAnswer, Free>;
export function clearance(moving: Placeable, fixed: Placeable, direction: VectorLike, options?: CastOptions & PoseOptions): ClearanceAnswer;
export function clearance(moving: Placeable, fixed: Placeable, direction: VectorLike, options: CastOptions & PoseOptions = {}): ClearanceAnswer {
  return question(QUESTIONS.Clearance, moving, fixed, vector(direction, "direction"), options) as ClearanceAnswer;
}

/** Computes the translations along a direction at which two bodies first and last meet. */
export function contactRange(moving: Placeable, fixed: Placeable, direction: VectorLike, options: CastOptions & PoseOptions = {}): ContactRange | Separated | Free {
  return question(QUESTIONS.ContactRange, moving, fixed, vector(direction, "direction"), options) as ContactRange | Separated | Free;
}

/** Checks whether two bodies have a common point. The answer is exact for solids, and up to rounding errors for convex
 * bodies. */
export function intersects(moving: Placeable, fixed: Placeable, options: PoseOptions = {}): boolean {
  known(options, POSES);
  // The answer does not depend on the direction.
  return (question(QUESTIONS.Intersects, moving, fixed, [0, 0, 1], options) as Intersection).meets;
}
