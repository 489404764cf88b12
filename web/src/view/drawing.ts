// The picture as lines and areas, the nearer over the farther: text of an SVG file.

import { BufferGeometry, type DirectionalLight, DoubleSide, FrontSide, type Group, type LineSegments, type Material, type Mesh, type Object3D, type PerspectiveCamera, type Scene, Vector3 } from "three";
import { SVGRenderer } from "three/addons/renderers/SVGRenderer.js";
import { svg } from "../dom";
import type { Drawn } from "./body";
import type { Label } from "./shapes";

/** Triangles of a file. */
const MOST_DRAWN = 40_000;

interface Picture {
  scene: Scene;
  camera: PerspectiveCamera;
  shown: Group;
  labels: Label[];
  host: HTMLElement;
  colour: string;
}

export function drawing({ scene, camera, shown, labels, host, colour }: Picture): string {
  let triangles = 0;
  scene.traverseVisible((object) => {
    const { geometry } = object as Partial<Mesh>;
    if ((object as Mesh).isMesh) triangles += (geometry?.index ?? geometry?.getAttribute("position"))!.count / 3;
  });
  if (triangles > MOST_DRAWN) throw new Error(`${Math.round(triangles)} triangles are too many for an SVG file: the PNG has them`);
  const drawing = new SVGRenderer();
  const { clientWidth: wide, clientHeight: high } = host;
  drawing.setSize(wide, high);
  drawing.setPrecision(2);
  const back = prepare(scene, shown, camera.position);
  drawing.render(scene, camera);
  back();
  const picture = drawing.domElement as unknown as SVGSVGElement;
  picture.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  picture.style.background = getComputedStyle(host).backgroundColor;
  for (const { text, at } of labels) {
    const place = at.clone().project(camera);
    picture.append(svg("text", { x: (place.x * wide) / 2, y: (-place.y * high) / 2, "font-size": 14, "font-style": "italic", "text-anchor": "middle", fill: colour }, text));
  }
  return new XMLSerializer().serializeToString(picture);
}

/** For a renderer that draws facet after facet: what faces away is left out, edges are drawn after
 * the facets of their body, the nearer body after the farther. Returns what takes that back. */
function prepare(scene: Scene, shown: Group, eye: Vector3): () => void {
  const undo: (() => void)[] = [];
  scene.traverse((object) => {
    // Light is counted otherwise there: without the division by pi, and clipped.
    const light = object as Partial<DirectionalLight>;
    if (light.isLight) {
      const { intensity } = light;
      light.intensity = intensity! / 4;
      undo.push(() => (light.intensity = intensity!));
    }
  });
  const groups = shown.children.filter(({ userData }) => userData.how === "solid");
  const far = (group: Object3D) => new Vector3().setFromMatrixPosition(group.matrix).distanceTo(eye);
  groups.sort((a, b) => far(b) - far(a)).forEach((group, k) => {
    const drawn = group.userData.body as Drawn;
    const { body } = drawn;
    const [mesh, lines] = group.children as [Mesh, LineSegments];
    const [old, material] = [lines.geometry, mesh.material as Material];
    const facing = eye.clone().applyMatrix4(group.matrix.clone().invert());
    const seen = new BufferGeometry().setFromPoints(seenEdges(drawn, facing));
    lines.geometry = seen;
    if (body.facts.closed) material.side = FrontSide;
    // Bodies that are not convex may stand in each other: there depth alone decides.
    const convex = body.facts.kind === "convex";
    mesh.renderOrder = convex ? 1 + k : 1;
    lines.renderOrder = convex ? 1.5 + k : 1;
    undo.push(() => {
      seen.dispose();
      lines.geometry = old;
      material.side = DoubleSide;
      mesh.renderOrder = lines.renderOrder = 0;
    });
  });
  for (const object of shown.children) {
    if (groups.includes(object as Group) || object.type === "LineSegments") continue;
    object.traverse((part) => {
      const { renderOrder } = part;
      part.renderOrder = 20 + renderOrder;
      undo.push(() => (part.renderOrder = renderOrder));
    });
  }
  return () => undo.forEach((f) => f());
}

/** Ends of the edges at a facet that looks at the eye; of a body about its middle. */
function seenEdges({ body, middle }: Drawn, eye: Vector3): Vector3[] {
  const { vertices, triangles, edges } = body;
  const at = (v: number) => new Vector3(vertices[3 * v]! - middle[0], vertices[3 * v + 1]! - middle[1], vertices[3 * v + 2]! - middle[2]);
  const key = (a: number, b: number) => Math.min(a, b) * (vertices.length / 3) + Math.max(a, b);
  const seen = new Set<number>();
  for (let t = 0; t < triangles.length; t += 3) {
    const corners = [triangles[t]!, triangles[t + 1]!, triangles[t + 2]!] as const;
    const [a, b, c] = corners.map(at) as [Vector3, Vector3, Vector3];
    const normal = b.clone().sub(a).cross(c.clone().sub(a));
    if (body.facts.closed && normal.dot(eye.clone().sub(a)) <= 0) continue;
    corners.forEach((v, k) => seen.add(key(v, corners[(k + 1) % 3]!)));
  }
  const ends: Vector3[] = [];
  for (let k = 0; k < edges.length; k += 2) {
    if (seen.has(key(edges[k]!, edges[k + 1]!))) ends.push(at(edges[k]!), at(edges[k + 1]!));
  }
  return ends;
}
