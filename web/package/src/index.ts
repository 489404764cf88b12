/**
 * How far can a body move before it touches another? Exact answers with proven bounds, for convex bodies and solids.
 * @module
 */

import { load, provide } from "./library.js";

provide(await load("colltrans", new URL("./bodies.wasm", import.meta.url)));

export type {
  Behind, Blocked, Contact, ContactRange, Depth, Distance, Feature, Features, Free, Grazing, MotionContact, MotionUndecided, Overlapping,
  Separated, Slides, Within,
} from "./answers.js";
export { Body, ConvexPolyhedron, Placed } from "./body.js";
export { BuildError, ColltransError, InputError, NotConvergedError, PoseError, QueryError, StoppedError } from "./errors.js";
export type { Faces, Geometry, GeometryAttribute, GeometryClasses, GeometryOptions, Points } from "./geometry.js";
export { Motion, depth, distance, motion, within } from "./pairs.js";
export type { Angle, MotionAnswer, MotionOptions, StartPose } from "./pairs.js";
export type { MatrixLike, PoseLike, Poses, QuaternionLike, Vector, VectorLike } from "./pose.js";
export { cast, clearance, contactRange, intersects } from "./questions.js";
export type { CastAnswer, CastOptions, ClearanceAnswer, Placeable, PoseOptions } from "./questions.js";
export { Rows, castMany, clearanceMany, distanceMany } from "./rows.js";
export type { RowOptions } from "./rows.js";
export { Solid } from "./solid.js";
export type { SolidOptions } from "./solid.js";
