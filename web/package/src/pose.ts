// Vectors, poses and tables of them, as numbers for the library.

import { InputError } from "./errors.js";

/** Three coordinates. */
export type Vector = readonly [number, number, number];

/** A vector: three numbers, or an object with `x`, `y` and `z` such as three.js's `Vector3`. */
export type VectorLike = ArrayLike<number> | { readonly x: number; readonly y: number; readonly z: number };

/** A rotation: the four numbers `x, y, z, w` of a unit quaternion, or an object with them such as `Quaternion`. */
export type QuaternionLike = ArrayLike<number> | { readonly x: number; readonly y: number; readonly z: number; readonly w: number };

/** The 16 numbers of a 4 x 4 matrix by columns, as three.js's `Matrix4`. */
export interface MatrixLike {
  readonly elements: ArrayLike<number>;
}

/**
 * The pose of a body in the world:
 *
 * - 3 numbers, a position; 7 numbers, a position and a quaternion `x, y, z, w`; or the 16 numbers of a matrix by columns;
 * - an object with `position` and `quaternion`;
 * - a matrix with `elements`, or an object of three.js, whose `matrixWorld` is taken.
 *
 * A pose rotates and translates. Scales belong into the body: see `fromGeometry`.
 */
export type PoseLike =
  | ArrayLike<number>
  | MatrixLike
  | { readonly matrixWorld: MatrixLike; updateWorldMatrix?(parents: boolean, children: boolean): void }
  | { readonly position: VectorLike; readonly quaternion?: QuaternionLike };

/** Poses of many rows: positions of three numbers each, with quaternions of four, or matrices of 16. */
export type Poses =
  | { readonly positions: ArrayLike<number>; readonly quaternions?: ArrayLike<number> }
  | { readonly matrices: ArrayLike<number> };

const isList = (given: unknown): given is ArrayLike<number> =>
  typeof given === "object" && given !== null && typeof (given as ArrayLike<number>).length === "number";

/** Returns the text of a value for a message. */
export function shown(given: unknown): string {
  if (isList(given)) return `[${Array.from(given).slice(0, 7).join(", ")}${given.length > 7 ? ", ..." : ""}] of length ${given.length}`;
  if (typeof given === "object" && given !== null) return `an object with ${Object.keys(given).slice(0, 5).join(", ") || "no fields"}`;
  return String(given);
}

/** Checks that numbers are finite. */
export function finite(numbers: ArrayLike<number>, argument: string) {
  for (let k = 0; k < numbers.length; k++) {
    if (!Number.isFinite(numbers[k])) throw new InputError(`number ${k} is ${String(numbers[k])}, which is not a finite number`, argument);
  }
}

function numbersOf(given: unknown, names: readonly string[], argument: string): number[] {
  const fields = given as Record<string, number>;
  const numbers = isList(given) ? Array.from(given) : typeof given === "object" && given !== null ? names.map((name) => fields[name] as number) : [];
  if (numbers.length !== names.length) {
    throw new InputError(`${names.length} numbers are needed, or an object with ${names.join(", ")}; given: ${shown(given)}`, argument);
  }
  finite(numbers, argument);
  return numbers;
}

/** Returns the coordinates of a vector. */
export const vector = (given: VectorLike, argument: string): number[] => numbersOf(given, ["x", "y", "z"], argument);

/** Returns a number. */
export function number(given: number, argument: string): number {
  if (typeof given !== "number" || Number.isNaN(given)) throw new InputError(`${String(given)} is not a number`, argument);
  return given;
}

/** Returns position and columns of a matrix. */
function matrix(elements: ArrayLike<number>, argument: string): number[] {
  finite(elements, argument);
  const at = (k: number) => elements[k] as number;
  if (elements.length !== 16 || at(3) !== 0 || at(7) !== 0 || at(11) !== 0 || at(15) !== 1) {
    throw new InputError("a matrix has 16 numbers by columns, and its last row is 0, 0, 0, 1", argument);
  }
  return [12, 13, 14, 0, 1, 2, 4, 5, 6, 8, 9, 10].map(at);
}

/** Returns the numbers of a pose, behind their number. */
export function pose(given: PoseLike | undefined, argument: string): number[] {
  if (given === undefined) return [0];
  if (isList(given)) {
    if (given.length === 16) return [12, ...matrix(given, argument)];
    if (given.length !== 3 && given.length !== 7) {
      throw new InputError(`a pose has 3 numbers (a position), 7 (position and quaternion x, y, z, w) or 16 (a matrix by columns); given: ${shown(given)}`, argument);
    }
    finite(given, argument);
    return [given.length, ...Array.from(given)];
  }
  if (typeof given === "object" && given !== null) {
    if ("matrixWorld" in given) {
      given.updateWorldMatrix?.(true, false);
      return [12, ...matrix(given.matrixWorld.elements, argument)];
    }
    if ("elements" in given) return [12, ...matrix(given.elements, argument)];
    if ("position" in given) {
      const position = vector(given.position, `${argument}.position`);
      if (given.quaternion === undefined) return [3, ...position];
      return [7, ...position, ...numbersOf(given.quaternion, ["x", "y", "z", "w"], `${argument}.quaternion`)];
    }
  }
  throw new InputError(`not a pose: ${shown(given)}`, argument);
}

/** A table for the library: its numbers, and their number in a row. */
export interface Table {
  width: number;
  rows: number;
  numbers: Float64Array;
}

/** Returns a table of numbers, `width` in a row. */
export function table(given: ArrayLike<number>, width: number, argument: string): Table {
  if (!isList(given) || given.length % width !== 0) {
    throw new InputError(`a list of ${width} numbers for each row is needed; given: ${shown(given)}`, argument);
  }
  finite(given, argument);
  return { width, rows: given.length / width, numbers: Float64Array.from(given) };
}

/** Returns the table of poses. */
export function poses(given: Poses | undefined, argument: string): Table {
  if (given === undefined) return { width: 0, rows: 1, numbers: new Float64Array() };
  if ("matrices" in given) {
    const { rows, numbers } = table(given.matrices, 16, `${argument}.matrices`);
    const all = new Float64Array(12 * rows);
    for (let row = 0; row < rows; row++) all.set(matrix(numbers.subarray(16 * row, 16 * row + 16), `${argument}.matrices`), 12 * row);
    return { width: 12, rows, numbers: all };
  }
  const positions = table(given.positions, 3, `${argument}.positions`);
  if (given.quaternions === undefined) return positions;
  const quaternions = table(given.quaternions, 4, `${argument}.quaternions`);
  if (quaternions.rows !== positions.rows) {
    throw new InputError(`${quaternions.rows} quaternions for ${positions.rows} positions`, `${argument}.quaternions`);
  }
  const numbers = new Float64Array(7 * positions.rows);
  for (let row = 0; row < positions.rows; row++) {
    numbers.set(positions.numbers.subarray(3 * row, 3 * row + 3), 7 * row);
    numbers.set(quaternions.numbers.subarray(4 * row, 4 * row + 4), 7 * row + 3);
  }
  return { width: 7, rows: positions.rows, numbers };
}
