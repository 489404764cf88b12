// Solids: bodies that need not be convex.

import { QUESTIONS } from "./answers.js";
import { Body, build, handleOf, meshNumbers } from "./body.js";
import { InputError } from "./errors.js";
import { geometryMesh, mesh } from "./geometry.js";
import type { Faces, Geometry, GeometryOptions, Mesh, Points } from "./geometry.js";
import { library } from "./library.js";
import { number } from "./pose.js";

/** Options of a solid. */
export interface SolidOptions {
  /** Whether the surface may be open, like a scan. An open surface blocks and is blocked, but has no interior. */
  readonly open?: boolean;
}

function solid({ points, corners, sizes }: Mesh, open: boolean, single: boolean): Solid {
  const numbers = [QUESTIONS.Solid, ...meshNumbers({ points, corners, sizes }), Number(open), Number(single)];
  return new Solid(build(library(), numbers, points, corners, sizes));
}

/** A body that need not be convex: a surface of polygons. */
export class Solid extends Body {
  readonly kind = "solid";

  /** Builds a solid from the points and faces of its surface. Points with equal coordinates are merged. */
  static fromMesh(points: Points, faces: Faces, { open = false }: SolidOptions = {}): Solid {
    return solid(mesh(points, faces), open, false);
  }

  /** Builds a solid from a geometry of three.js. Its coordinates are in single precision: vertices that differ by no
   * more are merged where the surface is open, and the default tolerance of questions follows from it. */
  static fromGeometry(geometry: Geometry, { open = false, ...options }: GeometryOptions & SolidOptions = {}): Solid {
    return solid(geometryMesh(geometry, options), open, true);
  }

  /** Builds the union of bodies, which may overlap. */
  static fromPieces(pieces: readonly Body[]): Solid {
    const all = pieces.map((piece, k) => handleOf(piece, `pieces[${k}]`));
    const [first] = all;
    if (!first) throw new InputError("at least one body is needed", "pieces");
    if (all.some((piece) => piece.library !== first.library)) throw new InputError("the bodies are of different libraries", "pieces");
    return new Solid(build(first.library, [QUESTIONS.Union, all.length, ...all.map((piece) => piece.number)]));
  }

  /** Returns the body swept by a ball. */
  rounded(radius: number): Solid {
    const handle = handleOf(this, "body");
    return new Solid(build(handle.library, [QUESTIONS.Rounded, handle.number, number(radius, "radius")]));
  }
}
