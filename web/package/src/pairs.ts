// Questions about two bodies in their poses, and about moving bodies.

import { QUESTIONS, decode } from "./answers.js";
import type { Depth, Distance, Free, MotionContact, MotionUndecided, Overlapping, PoseAnswer, Within } from "./answers.js";
import { Placed } from "./body.js";
import { InputError } from "./errors.js";
import { library } from "./library.js";
import { known, optionNumbers, pair, question } from "./questions.js";
import type { Placeable, PoseOptions } from "./questions.js";
import { number, pose, vector } from "./pose.js";
import type { PoseLike, VectorLike } from "./pose.js";

const POSES = ["movingPose", "fixedPose"];
const ANY = [0, 0, 1];

/** Computes the distance of two bodies and their nearest points. */
export function distance(moving: Placeable, fixed: Placeable, options: PoseOptions = {}): Distance {
  known(options, POSES);
  return question(QUESTIONS.Distance, moving, fixed, ANY, options) as Distance;
}

/** Computes how deep two bodies overlap. */
export function depth(moving: Placeable, fixed: Placeable, options: PoseOptions = {}): Depth {
  known(options, POSES);
  return question(QUESTIONS.Depth, moving, fixed, ANY, options) as Depth;
}

/** Checks whether two bodies are closer than a length. The search ends when the comparison is decided. */
export function within(moving: Placeable, fixed: Placeable, length: number, options: PoseOptions = {}): Within {
  known(options, POSES);
  return question(QUESTIONS.Within, moving, fixed, ANY, options, number(length, "length")) as Within;
}

/** An angle, by exactly one of its units. */
export type Angle = { readonly degrees: number; readonly radians?: never } | { readonly radians: number; readonly degrees?: never };

/** The pose of a body at time 0. */
export interface StartPose {
  readonly pose?: PoseLike;
}

const RADIANS = Math.PI / 180;

function radians({ degrees, radians }: { readonly degrees?: number; readonly radians?: number }): number {
  if ((degrees === undefined) === (radians === undefined)) throw new InputError("exactly one of degrees and radians is needed", "degrees, radians");
  return degrees === undefined ? number(radians as number, "radians") : number(degrees, "degrees") * RADIANS;
}

/** A motion: the pose of a body at every time from 0 to 1. */
export class Motion {
  private constructor(
    /** @internal */
    readonly numbers: readonly number[],
    /** @internal Poses that the body passes through, as matrices. */
    readonly rows: readonly number[] = [],
  ) {}

  /** Builds the motion of a body that rests. */
  static still(at?: PoseLike): Motion {
    return new Motion([0, ...pose(at, "pose")]);
  }

  /** @internal */
  static resting(pose: readonly number[]): Motion {
    return new Motion([0, ...pose]);
  }

  /** Builds a translation by a vector. */
  static slide(by: VectorLike, start: StartPose = {}): Motion {
    return new Motion([1, ...pose(start.pose, "pose"), ...vector(by, "by")]);
  }

  /** Builds a rotation about an axis through a point, counter-clockwise as seen against the axis. */
  static turn(point: VectorLike, axis: VectorLike, angle: Angle & StartPose): Motion {
    return Motion.screw(point, axis, { ...angle, rise: 0 });
  }

  /** Builds a rotation about an axis that itself moves along its direction by `rise`, a length. */
  static screw(point: VectorLike, axis: VectorLike, angle: Angle & StartPose & { readonly rise: number }): Motion {
    return new Motion([2, ...pose(angle.pose, "pose"), ...vector(point, "point"), ...vector(axis, "axis"), radians(angle), number(angle.rise, "rise")]);
  }

  /** Builds the motion of a thrown body. The point `center` of the world moves straight by `velocity`, and the body turns
   * about it by the length of `angularVelocity` in radians. */
  static thrown(center: VectorLike, velocity: VectorLike, angularVelocity: VectorLike, start: StartPose = {}): Motion {
    return new Motion([3, ...pose(start.pose, "pose"), ...vector(center, "center"), ...vector(velocity, "velocity"), ...vector(angularVelocity, "angularVelocity")]);
  }

  /** Builds screws from each pose to the next one, of equal durations. */
  static through(poses: readonly PoseLike[]): Motion {
    if (!Array.isArray(poses) || poses.length < 2) throw new InputError("at least two poses are needed", "poses");
    const rows = poses.flatMap((given: PoseLike, k) => {
      const { position, xAxis, yAxis, zAxis } = poseOf([0, ...pose(given, `poses[${k}]`), 0], []);
      return [...position, ...xAxis, ...yAxis, ...zAxis];
    });
    return new Motion([4, 0, 0, poses.length], rows);
  }

  /** Returns the pose at a time from 0 to 1, as the 16 numbers of a matrix by columns. */
  at(time: number): number[] {
    const { position, xAxis, yAxis, zAxis } = poseOf([...this.numbers, number(time, "time")], this.rows);
    return [...xAxis, 0, ...yAxis, 0, ...zAxis, 0, ...position, 1];
  }
}

const poseOf = (numbers: readonly number[], rows: readonly number[]) =>
  decode(new Float64Array(library().call([QUESTIONS.PoseAt, ...numbers], Float64Array.from(rows)).numbers)) as PoseAnswer;

/** Options of a question about moving bodies. */
export interface MotionOptions {
  /** The motion of the moving body. A body without one rests in its pose. */
  readonly movingMotion?: Motion;
  /** The motion of the fixed body. */
  readonly fixedMotion?: Motion;
  /** A minimum gap, a length. */
  readonly minGap?: number;
  /** A tolerated depth of convex bodies; solids are shrunk by half of it. */
  readonly tolerance?: number;
  /** Solids: whether facets that cross at the start are ignored. */
  readonly ignoreStartOverlaps?: boolean;
}

/** The answer of `motion`. */
export type MotionAnswer = MotionContact | MotionUndecided | Overlapping | Free;

/** Computes the time, from 0 to 1, at which moving bodies first meet. */
export function motion(moving: Placeable, fixed: Placeable, options: MotionOptions): MotionAnswer {
  const { movingMotion, fixedMotion, ...others } = options;
  const motionOf = (given: Placeable, named: Motion | undefined, argument: string): Motion => {
    if (given instanceof Placed && named) throw new InputError("the body has a pose already, from at(pose): give the pose to the motion alone", argument);
    if (named && !(named instanceof Motion)) throw new InputError("a Motion is needed, for example Motion.slide(by)", argument);
    if (!(given instanceof Placed)) return named ?? Motion.still();
    return Motion.resting(given.numbers);
  };
  const motions = [motionOf(moving, movingMotion, "movingMotion"), motionOf(fixed, fixedMotion, "fixedMotion")] as const;
  const bare = (given: Placeable) => (given instanceof Placed ? given.body : given);
  const { library, bodies } = pair(bare(moving), bare(fixed));
  // The poses of both motions follow each other; the second motion begins behind the first one.
  const [p, q] = motions;
  const second = q.rows.length ? [4, 0, p.rows.length, q.rows.length / 12] : q.numbers;
  const numbers = [QUESTIONS.Motion, ...bodies, ...optionNumbers(others, []), ...p.numbers, ...second];
  return decode(new Float64Array(library.call(numbers, Float64Array.from([...p.rows, ...q.rows])).numbers)) as MotionAnswer;
}
