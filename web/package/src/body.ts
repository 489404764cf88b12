/// <reference lib="esnext.disposable" preserve="true" />
// Bodies: their memory in the library, and what both kinds have in common.

import { QUESTIONS } from "./answers.js";
import { InputError } from "./errors.js";
import { geometryMesh, mesh, points } from "./geometry.js";
import type { Faces, Geometry, GeometryClasses, GeometryOptions, Mesh, Points } from "./geometry.js";
import { library } from "./library.js";
import type { Library } from "./library.js";
import { number, pose, shown, vector } from "./pose.js";
import type { PoseLike, VectorLike } from "./pose.js";

/** The memory of a body. */
interface Handle {
  readonly library: Library;
  readonly number: number;
}

const handles = new WeakMap<Body, Handle>();

/** Frees the memory of bodies that were collected. */
const collected = new FinalizationRegistry<Handle>(release);

function release({ library, number }: Handle) {
  try {
    library.call([QUESTIONS.Free, number]);
  } catch {
    // A library that stopped has no bodies.
  }
}

/** Returns the memory of a body. */
export function handleOf(body: Body, argument: string): Handle {
  const handle = handles.get(body);
  if (handle) return handle;
  if (body instanceof Body) throw new InputError("the body was freed", argument);
  throw new InputError(`a ConvexPolyhedron or a Solid is needed, placed by at(pose) or not; given: ${shown(body)}`, argument);
}

/** Sends a question about a body to its library. */
export const ask = (body: Body, question: number) => {
  const handle = handleOf(body, "body");
  return handle.library.call([question, handle.number]).numbers;
};

/** Builds a body in a library, and returns its memory. */
export function build(from: Library, numbers: readonly number[], ...data: (Float64Array | Uint32Array)[]): Handle {
  return { library: from, number: new Float64Array(from.call(numbers, ...data).numbers)[0] as number };
}

/** Returns the question for a mesh. */
export const meshNumbers = ({ points, corners, sizes }: Mesh) => [points.length / 3, corners.length, sizes.length];

/** A body that never changes: a `ConvexPolyhedron` or a `Solid`. */
export abstract class Body {
  /** The kind of the body. */
  abstract readonly kind: "convex" | "solid";

  /** @internal */
  constructor(handle: Handle) {
    handles.set(this, handle);
    collected.register(this, handle, this);
  }

  /** Places the body in the world. */
  at(pose: PoseLike): Placed<this> {
    return new Placed(this, pose);
  }

  /** The smallest and the largest coordinates. */
  get bounds(): { low: [number, number, number]; high: [number, number, number] } {
    const [, , , , , , a = 0, b = 0, c = 0, d = 0, e = 0, f = 0] = this.properties();
    return { low: [a, b, c], high: [d, e, f] };
  }

  /** The volume; of a rounded solid without the radius. */
  get volume(): number {
    return this.properties()[5] as number;
  }

  /** The radius of the ball that sweeps a rounded body, otherwise 0. */
  get radius(): number {
    return this.properties()[4] as number;
  }

  /** Whether the surface is closed. */
  get isClosed(): boolean {
    return this.properties()[1] === 1;
  }

  /** The vertices in the frame of the body, three numbers each. */
  get vertices(): Float64Array {
    return new Float64Array(ask(this, QUESTIONS.Vertices));
  }

  /** Triangles of the surface, three indices of `vertices` each, counter-clockwise as seen from outside. */
  get triangles(): Uint32Array {
    return new Uint32Array(ask(this, QUESTIONS.Triangles));
  }

  /** Builds a geometry of three.js: `body.toGeometry(THREE)`. A rounded body gives its core. */
  toGeometry<G>({ BufferGeometry, BufferAttribute }: GeometryClasses<G>): G {
    const { vertices, triangles } = this;
    // Each triangle has its own corners, so that it is drawn flat.
    const positions = Float32Array.from({ length: 3 * triangles.length }, (_, k) => vertices[3 * (triangles[Math.floor(k / 3)] as number) + (k % 3)] as number);
    const geometry = new BufferGeometry() as G & { setAttribute(name: string, attribute: unknown): unknown; computeVertexNormals(): void };
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.computeVertexNormals();
    return geometry;
  }

  /** Frees the memory of the body. Otherwise it is freed some time after the last use of the body. */
  free(): void {
    const handle = handles.get(this);
    if (!handle) return;
    handles.delete(this);
    collected.unregister(this);
    release(handle);
  }

  [Symbol.dispose](): void {
    this.free();
  }

  private properties(): Float64Array {
    return new Float64Array(ask(this, QUESTIONS.Properties));
  }
}

/** A body in its pose. */
export class Placed<B extends Body = Body> {
  /** @internal */
  readonly numbers: readonly number[];

  /** @internal */
  constructor(readonly body: B, given: PoseLike) {
    this.numbers = pose(given, "pose");
  }
}

/** A convex polyhedron: the convex hull of its vertices. */
export class ConvexPolyhedron extends Body {
  readonly kind = "convex";

  /** Builds the convex hull of points. */
  static fromPoints(given: Points): ConvexPolyhedron {
    return new ConvexPolyhedron(build(library(), [QUESTIONS.Hull], points(given)));
  }

  /** Builds a convex body from its closed surface. A surface that is open or not convex is an error. */
  static fromMesh(points: Points, faces: Faces): ConvexPolyhedron {
    const input = mesh(points, faces);
    return new ConvexPolyhedron(build(library(), [QUESTIONS.Mesh, ...meshNumbers(input)], input.points, input.corners, input.sizes));
  }

  /** Builds the convex hull of a geometry of three.js. */
  static fromGeometry(geometry: Geometry, options: GeometryOptions = {}): ConvexPolyhedron {
    const { points, corners } = geometryMesh(geometry, options);
    const used = Float64Array.from({ length: 3 * corners.length }, (_, k) => points[3 * (corners[Math.floor(k / 3)] as number) + (k % 3)] as number);
    return ConvexPolyhedron.fromPoints(used);
  }

  /** Builds a box from its smallest and its largest coordinates. */
  static cuboid(low: VectorLike, high: VectorLike): ConvexPolyhedron {
    return new ConvexPolyhedron(build(library(), [QUESTIONS.Cuboid, ...vector(low, "low"), ...vector(high, "high")]));
  }

  /** Builds a ball. Only in `colltrans`, not in `colltrans/cast`. */
  static sphere(center: VectorLike, radius: number): ConvexPolyhedron {
    return ConvexPolyhedron.fromPoints(vector(center, "center")).rounded(radius);
  }

  /** Builds a capsule: all points within the radius of a segment. Only in `colltrans`, not in `colltrans/cast`. */
  static capsule(from: VectorLike, to: VectorLike, radius: number): ConvexPolyhedron {
    return ConvexPolyhedron.fromPoints([...vector(from, "from"), ...vector(to, "to")]).rounded(radius);
  }

  /** Returns the body swept by a ball. Only in `colltrans`, not in `colltrans/cast`. */
  rounded(radius: number): ConvexPolyhedron {
    const handle = handleOf(this, "body");
    return new ConvexPolyhedron(build(handle.library, [QUESTIONS.Rounded, handle.number, number(radius, "radius")]));
  }
}
