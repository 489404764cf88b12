// The worker of the distances: the bodies of the page in the npm package, which is used as any program uses it.

import type { Body, Depth, Distance, Placed } from "colltrans";
import type { Pose } from "./math";

/** A body as the page has it, to build it once more. */
export interface NearBody {
  kind: "convex" | "solid";
  vertices: Float64Array;
  triangles: Uint32Array;
  closed: boolean;
  radius: number;
}

/** A question. A body that is missing is the one of the last question. */
export interface NearQuestion {
  bodies: (NearBody | undefined)[];
  poses: Pose[];
}

/** The distance, and the depth if the bodies meet. */
export interface NearAnswer {
  distance: Distance;
  depth: Depth | undefined;
}

const placed: Body[] = [];

self.onmessage = async ({ data: { bodies, poses } }: MessageEvent<NearQuestion>) => {
  try {
    const { ConvexPolyhedron, Solid, depth, distance } = await import("colltrans");
    bodies.forEach((body, k) => {
      if (!body) return;
      placed[k]?.free();
      const { kind, vertices, triangles, closed, radius } = body;
      const core = kind === "convex" ? ConvexPolyhedron.fromPoints(vertices) : Solid.fromMesh(vertices, triangles, { open: !closed });
      placed[k] = radius > 0 ? core.rounded(radius) : core;
    });
    const [moving, fixed] = placed.map((body, k) => body.at(poses[k]!)) as [Placed, Placed];
    const apart = distance(moving, fixed);
    self.postMessage({ distance: apart, depth: apart.meets ? depth(moving, fixed) : undefined } satisfies NearAnswer);
  } catch (error) {
    self.postMessage({ error: error instanceof Error ? error.message : String(error) });
  }
};
