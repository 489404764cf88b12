/**
 * Casts of convex bodies: how far can a body move before it touches another? Exact answers with proven bounds.
 *
 * This entry is small. `colltrans` has solids, distances, motions and rounded bodies, too.
 * @module
 */

import { load, provide } from "./library.js";

provide(await load("colltrans/cast", new URL("./casts.wasm", import.meta.url)));

export type { Behind, Blocked, Contact, ContactRange, Feature, Features, Free, Grazing, Overlapping, Separated, Slides } from "./answers.js";
export { Body, ConvexPolyhedron, Placed } from "./body.js";
export { BuildError, ColltransError, InputError, NotConvergedError, PoseError, QueryError, StoppedError } from "./errors.js";
export type { Faces, Geometry, GeometryAttribute, GeometryClasses, GeometryOptions, Points } from "./geometry.js";
export type { MatrixLike, PoseLike, Poses, QuaternionLike, Vector, VectorLike } from "./pose.js";
export { cast, clearance, contactRange, intersects } from "./questions.js";
export type { CastAnswer, CastOptions, ClearanceAnswer, Placeable, PoseOptions } from "./questions.js";
export { Rows, castMany, clearanceMany } from "./rows.js";
export type { RowOptions } from "./rows.js";
