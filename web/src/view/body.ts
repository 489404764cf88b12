// A drawn body: its geometry relative to its own middle, and its place in the picture.

import {
  BufferAttribute, BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshLambertMaterial,
  Quaternion, Vector3,
} from "three";
import type { Palette } from "../colours";
import type { Body, Slot } from "../engine";
import { type Pose, type Vec, add, dot, length, placed, sub, times, turned } from "../math";

export interface Drawn {
  body: Body;
  middle: Vec;
  radius: number;
  geometry: BufferGeometry;
  edges: BufferGeometry;
}

/** The bodies that are loaded. */
export type Bodies = Partial<Record<Slot, Drawn>>;

/** Opaque, translucent, or edges only. */
export type How = "solid" | "ghost" | "outline";

/** Number of edges above which edges are drawn faint. */
const MANY = 2e3;
const OPACITY: Record<How, { few: number; many: number }> = {
  solid: { few: 0.85, many: 0.25 }, ghost: { few: 0.5, many: 0.1 }, outline: { few: 0.28, many: 0.06 },
};

export function drawn(body: Body): Drawn {
  const middle = times(add(body.facts.low, body.facts.high), 0.5);
  const radius = Math.max(length(sub(body.facts.high, body.facts.low)) / 2, Number.MIN_VALUE);
  const { vertices, triangles } = body;
  const relative = (indices: Uint32Array): BufferAttribute => {
    const points = new Float32Array(3 * indices.length);
    for (let k = 0; k < indices.length; k++) {
      const v = 3 * indices[k]!;
      for (let c = 0; c < 3; c++) points[3 * k + c] = vertices[v + c]! - middle[c]!;
    }
    return new BufferAttribute(points, 3);
  };
  // Corners are not shared, so that every facet has its own shade.
  const geometry = new BufferGeometry().setAttribute("position", relative(triangles));
  const edges = new BufferGeometry().setAttribute("position", relative(body.edges));
  return { body, middle, radius, geometry, edges };
}

/** Frees the graphics memory of a body. */
export function forget(body: Drawn | undefined) {
  body?.geometry.dispose();
  body?.edges.dispose();
}

/** Returns the matrix of a body at a pose; its geometry is relative to its middle. */
export function matrixOf(pose: Pose, middle: Vec, origin: Vec, shift: Vec = [0, 0, 0]): Matrix4 {
  const at = sub(add(placed(pose, middle), shift), origin);
  const turn = new Quaternion(pose[3], pose[4], pose[5], pose[6]).normalize();
  return new Matrix4().compose(new Vector3(...at), turn, new Vector3(1, 1, 1));
}

/** Draws the facets of a body unless it is an outline, and its edges. `userData` has the body. */
export function placedBody(body: Drawn, matrix: Matrix4, colour: string, how: How, colours: Palette): Group {
  const group = new Group();
  group.userData = { body, how };
  group.matrixAutoUpdate = false;
  group.matrix.copy(matrix);
  if (how !== "outline") {
    const ghost = how === "ghost";
    const material = new MeshLambertMaterial({
      color: colour, flatShading: true, side: DoubleSide,
      transparent: ghost, opacity: ghost ? 0.3 : 1, depthWrite: !ghost,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    group.add(new Mesh(body.geometry, material));
  }
  const opacity = OPACITY[how][body.body.edges.length > 2 * MANY ? "many" : "few"];
  const line = colours.dark && how !== "solid" ? colours.way : colours.edge;
  group.add(new LineSegments(body.edges, new LineBasicMaterial({ color: line, transparent: true, opacity })));
  return group;
}

/** Returns a vertex of a placed body. */
export function corner({ body }: Drawn, pose: Pose, v: number): Vec {
  const { vertices } = body;
  return placed(pose, [vertices[3 * v]!, vertices[3 * v + 1]!, vertices[3 * v + 2]!]);
}

/** Returns the largest `n . x` of a placed body for a unit vector. */
export function highest(body: Body, pose: Pose, n: Vec): number {
  const back: Pose = [0, 0, 0, -pose[3], -pose[4], -pose[5], pose[6]];
  const [x, y, z] = turned(back, n);
  let best = -Infinity;
  const { vertices, facts } = body;
  for (let k = 0; k < 3 * facts.vertices; k += 3) {
    best = Math.max(best, x * vertices[k]! + y * vertices[k + 1]! + z * vertices[k + 2]!);
  }
  return best + facts.radius + dot(n, [pose[0], pose[1], pose[2]]);
}
