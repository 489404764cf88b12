// One question for many poses and directions, by typed arrays.

import { OUTCOMES, QUESTIONS } from "./answers.js";
import { InputError, errorOf } from "./errors.js";
import type { ColltransError } from "./errors.js";
import { optionNumbers, pair } from "./questions.js";
import type { CastOptions, Placeable } from "./questions.js";
import { poses, table } from "./pose.js";
import type { Poses, Table } from "./pose.js";

/** Poses of both bodies, one for each row or one for all. */
export interface RowOptions {
  readonly movingPoses?: Poses;
  readonly fixedPoses?: Poses;
}

/** The answers of many questions, by columns. Fields that an answer does not have are NaN. */
export class Rows {
  /** `value` of each answer; NaN where it is null. */
  readonly value: Float64Array;
  /** Lower bounds. */
  readonly lower: Float64Array;
  /** Upper bounds. */
  readonly upper: Float64Array;
  /** Normals, three numbers each. */
  readonly normal: Float64Array;
  /** Points on the fixed body, three numbers each. */
  readonly point: Float64Array;
  private readonly numbers: Float64Array;

  /** @internal */
  constructor(
    /** Number of rows. */
    readonly length: number,
    answers: Float64Array,
    /** The errors of rows without an answer. */
    readonly errors: ReadonlyMap<number, ColltransError>,
  ) {
    const columns = (first: number, width: number) => Float64Array.from({ length: width * length }, (_, k) => answers[10 * Math.floor(k / width) + first + (k % width)] as number);
    this.numbers = columns(0, 1);
    [this.value, this.lower, this.upper] = [columns(1, 1), columns(2, 1), columns(3, 1)];
    [this.normal, this.point] = [columns(4, 3), columns(7, 3)];
  }

  /** Returns the outcome of a row, for example `contact`; `error` if it has no answer. */
  outcome(row: number): string {
    return OUTCOMES[this.numbers[row] as number] ?? "error";
  }
}

function many(which: number, moving: Placeable, fixed: Placeable, directions: Table, options: RowOptions & CastOptions): Rows {
  const { library, bodies, poses: placed } = pair(moving, fixed);
  if (placed.length > 2) throw new InputError("bodies of many rows have no pose of their own: give movingPoses and fixedPoses", "moving, fixed");
  const tables = [poses(options.movingPoses, "movingPoses"), poses(options.fixedPoses, "fixedPoses"), directions];
  const rows = tables.some((of) => of.rows === 0) ? 0 : Math.max(...tables.map((of) => of.rows));
  for (const [k, argument] of ["movingPoses", "fixedPoses", "directions"].entries()) {
    const has = (tables[k] as Table).rows;
    if (has !== rows && has !== 1) throw new InputError(`${has} rows, but others have ${rows}; accepted are 1 and ${rows}`, argument);
  }
  const head = [QUESTIONS.Rows, which, ...bodies, ...optionNumbers(options, ["movingPoses", "fixedPoses"])];
  // The module of casts alone has no question with a length.
  if (library.name === "colltrans") head.push(0);
  const reply = library.call([...head, rows, ...tables.flatMap((of) => [of.width, of.rows])], ...tables.map((of) => of.numbers));
  const errors = new Map(reply.text.split("\0").filter(Boolean).map((text) => {
    const [row, ...error] = text.split("\n");
    return [Number(row), errorOf(error.join("\n"))];
  }));
  return new Rows(rows, new Float64Array(reply.numbers), errors);
}

/** Computes `cast` for many rows. `directions` has three numbers for each row, or three for all. A row that fails has its
 * error in `errors`; the other rows have their answers. */
export function castMany(moving: Placeable, fixed: Placeable, directions: ArrayLike<number>, options: RowOptions & CastOptions = {}): Rows {
  return many(QUESTIONS.Cast, moving, fixed, table(directions, 3, "directions"), options);
}

/** Computes `clearance` for many rows, as `castMany` does. */
export function clearanceMany(moving: Placeable, fixed: Placeable, directions: ArrayLike<number>, options: RowOptions & CastOptions = {}): Rows {
  return many(QUESTIONS.Clearance, moving, fixed, table(directions, 3, "directions"), options);
}

/** Computes `distance` for many rows. Only in `colltrans`, not in `colltrans/cast`. */
export function distanceMany(moving: Placeable, fixed: Placeable, options: RowOptions = {}): Rows {
  return many(QUESTIONS.Distance, moving, fixed, { width: 0, rows: 1, numbers: new Float64Array() }, options);
}
