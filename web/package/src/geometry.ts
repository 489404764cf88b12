// Meshes: lists of coordinates and faces, and the geometries of three.js, described by their structure.

import { InputError } from "./errors.js";
import { finite, shown, vector } from "./pose.js";
import type { MatrixLike, VectorLike } from "./pose.js";

/** Points: three numbers each in one list, or a list of points. */
export type Points = ArrayLike<number> | readonly VectorLike[];

/** Faces by indices of points, counter-clockwise as seen from outside: three indices for each triangle in one list, or a
 * list of polygons. */
export type Faces = ArrayLike<number> | readonly ArrayLike<number>[];

/** An attribute of a geometry, such as three.js's `BufferAttribute` and `InterleavedBufferAttribute`. */
export interface GeometryAttribute {
  readonly count: number;
  getX(index: number): number;
  getY(index: number): number;
  getZ(index: number): number;
}

/** A geometry of triangles, such as three.js's `BufferGeometry`, with an index or without. */
export interface Geometry {
  readonly attributes: { readonly [name: string]: unknown };
  readonly index: { readonly count: number; getX(index: number): number } | null;
}

/** The classes with which `toGeometry` builds a geometry: the module `three`, or an object with these two of it. */
export interface GeometryClasses<G> {
  BufferGeometry: new () => G;
  BufferAttribute: new (array: Float32Array, itemSize: number) => unknown;
}

/** Options of `fromGeometry`. */
export interface GeometryOptions {
  /** A transformation of all points, such as the `matrixWorld` of a scaled mesh. Then the pose of the body is that of
   * the world. */
  readonly matrix?: MatrixLike;
}

/** Coordinates and faces, as arrays for the library. */
export interface Mesh {
  points: Float64Array;
  /** The corners of all faces. */
  corners: Uint32Array;
  /** The numbers of corners of polygons; empty if all faces are triangles. */
  sizes: Uint32Array;
}

/** Reads points. */
export function points(given: Points, argument = "points"): Float64Array {
  if (typeof given !== "object" || given === null || typeof given.length !== "number") {
    throw new InputError(`a list of coordinates or of points is needed; given: ${shown(given)}`, argument);
  }
  const flat = typeof given[0] === "object"
    ? Float64Array.from(Array.from(given as readonly VectorLike[]).flatMap((point, k) => vector(point, `${argument}[${k}]`)))
    : Float64Array.from(given as ArrayLike<number>);
  if (flat.length % 3 !== 0) throw new InputError(`three numbers for each point are needed; given are ${flat.length}`, argument);
  finite(flat, argument);
  return flat;
}

/** Reads points and faces. */
export function mesh(givenPoints: Points, givenFaces: Faces): Mesh {
  const coordinates = points(givenPoints);
  if (typeof givenFaces !== "object" || givenFaces === null || typeof givenFaces.length !== "number") {
    throw new InputError(`a list of indices or of polygons is needed; given: ${shown(givenFaces)}`, "faces");
  }
  const polygons = typeof givenFaces[0] === "object" ? Array.from(givenFaces as readonly ArrayLike<number>[]) : undefined;
  const list = polygons ? polygons.flatMap((polygon) => Array.from(polygon)) : (givenFaces as ArrayLike<number>);
  if (!polygons && list.length % 3 !== 0) throw new InputError(`three indices for each triangle are needed; given are ${list.length}`, "faces");
  const count = coordinates.length / 3;
  for (let k = 0; k < list.length; k++) {
    const index = list[k] as number;
    if (!Number.isInteger(index) || index < 0 || index >= count) {
      throw new InputError(`index ${String(index)} at place ${k} is not one of the ${count} points, which are numbered from 0`, "faces");
    }
  }
  return { points: coordinates, corners: Uint32Array.from(list), sizes: Uint32Array.from(polygons?.map((polygon) => polygon.length) ?? []) };
}

/** Reads a geometry. */
export function geometryMesh(geometry: Geometry, { matrix }: GeometryOptions): Mesh {
  const position = geometry?.attributes?.["position"] as GeometryAttribute | undefined;
  if (typeof position?.getX !== "function" || typeof position.count !== "number") {
    throw new InputError(`a geometry with an attribute position is needed, such as a BufferGeometry; given: ${shown(geometry)}`, "geometry");
  }
  const coordinates = new Float64Array(3 * position.count);
  for (let k = 0; k < position.count; k++) coordinates.set([position.getX(k), position.getY(k), position.getZ(k)], 3 * k);
  if (matrix) transform(coordinates, matrix.elements);
  const { index } = geometry;
  const corners = Array.from({ length: index ? index.count : position.count }, (_, k) => (index ? index.getX(k) : k));
  // A mirrored geometry is inside out.
  if (matrix && determinant(matrix.elements) < 0) corners.reverse();
  return mesh(coordinates, corners);
}

function transform(points: Float64Array, m: ArrayLike<number>) {
  finite(m, "matrix");
  if (m.length !== 16) throw new InputError("a matrix has 16 numbers by columns", "matrix");
  const at = (k: number) => m[k] as number;
  for (let k = 0; k < points.length; k += 3) {
    const [x = 0, y = 0, z = 0] = points.subarray(k, k + 3);
    points.set([0, 1, 2].map((row) => at(row) * x + at(4 + row) * y + at(8 + row) * z + at(12 + row)), k);
  }
}

function determinant(m: ArrayLike<number>): number {
  const [a = 0, b = 0, c = 0, , d = 0, e = 0, f = 0, , g = 0, h = 0, i = 0] = Array.from(m);
  return a * (e * i - f * h) - d * (b * i - c * h) + g * (b * f - c * e);
}
