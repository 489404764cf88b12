// The picture as areas and lines: text of an SVG file.
//
// The data's way: the scene's triangles and lines -> the page (`Eye`) -> areas in the `order` in which
// the nearer cover the farther, and of the lines what no opaque area hides (`depths`). What is above
// everything, the arrow, comes last.

import {
  type AmbientLight, type BufferGeometry, Color, type DirectionalLight, DoubleSide, type Line, type LineBasicMaterial,
  type LineDashedMaterial, type Mesh, type MeshLambertMaterial, type Object3D, type PerspectiveCamera, type Scene, Vector3,
} from "three";
import { svg } from "../dom";
import type { Body } from "../engine";
import type { Drawn } from "./body";
import { type Corners, Depths, type Point } from "./depths";
import { type Facet, ordered } from "./order";
import { placeOf } from "./overlay";
import type { Label } from "./shapes";

/** Triangles of a file. */
const MOST_DRAWN = 40_000;
/** Lengths along the view that are no difference, as a part of the size of what is shown. */
const SLACK = 2e-4;
/** The width of an area's rim. */
const RIM = 0.7;

export interface Picture {
  scene: Scene;
  camera: PerspectiveCamera;
  labels: Label[];
  size: number;
  wide: number;
  high: number;
  ground: string;
  text: string;
}

export function drawing({ scene, camera, labels, size, wide, high, ground, text }: Picture): string {
  scene.updateMatrixWorld();
  const eye = new Eye(camera, wide, high);
  const [meshes, lines]: [Mesh[], Line[]] = [[], []];
  scene.traverseVisible((object) => {
    if ((object as Mesh).isMesh) meshes.push(object as Mesh);
    else if ((object as Line).isLine) lines.push(object as Line);
  });
  const triangles = meshes.reduce((sum, { geometry }) => sum + countOf(geometry) / 3, 0);
  if (triangles > MOST_DRAWN) throw new Error(`${Math.round(triangles)} triangles are too many for an SVG file: the PNG has them`);
  const slack = SLACK * size;
  const light = new Light(scene, eye);
  const depths = new Depths(wide, high, slack);
  /** Of each body, where its triangles are among the owners of depths. */
  const owners = new Map<Object3D, number>();
  const [within, above]: [Facet[], Facet[]] = [[], []];
  let owner = 0;
  for (const mesh of meshes) {
    if (mesh.parent) owners.set(mesh.parent, owner);
    const hides = (mesh.material as MeshLambertMaterial).depthTest;
    for (const facet of facetsOf(mesh, eye, light, slack)) {
      (hides ? within : above).push(facet);
      if (hides && facet.opaque) depths.draw(facet.corners, owner + facet.triangle);
    }
    owner += countOf(mesh.geometry) / 3;
  }
  const grid = lines.filter((line) => line.type === "LineSegments" && !line.parent?.userData.body);
  const areas = (facets: Facet[]) => areasOf(ordered(facets, wide, high, slack));
  const strokes = (some: Line[]) => some.flatMap((line) => strokeOf(line, eye, depths, owners));
  const words = labels.flatMap((label) => {
    const at = placeOf(label, camera, wide, high);
    const look = { "font-family": "sans-serif", "font-size": 14, "font-style": "italic", "text-anchor": "middle", fill: text };
    return at ? [svg("text", { x: written(at[0]), y: written(at[1] + 4), ...look }, label.text)] : [];
  });
  const picture = svg("svg", { xmlns: "http://www.w3.org/2000/svg", viewBox: `0 0 ${wide} ${high}`, width: wide, height: high, "stroke-linejoin": "round" },
    svg("rect", { width: wide, height: high, fill: ground }),
    ...strokes(grid), ...areas(within), ...strokes(lines.filter((line) => !grid.includes(line))), ...areas(above), ...words);
  return new XMLSerializer().serializeToString(picture);
}

const countOf = (geometry: BufferGeometry): number => (geometry.index ?? geometry.getAttribute("position")).count;
const written = (x: number): string => String(Math.round(100 * x) / 100);

/** Who looks: from the world to the page. */
class Eye {
  constructor(readonly camera: PerspectiveCamera, private readonly wide: number, private readonly high: number) {}

  /** The corners of a triangle or the ends of a segment, before the eye. */
  before(points: Vector3[], closed: boolean): Vector3[] {
    const near = this.camera.near;
    return points.flatMap((a, k) => {
      const b = points[k + 1] ?? (closed ? points[0]! : a);
      const [here, there] = [-a.z >= near, -b.z >= near];
      return [...(here ? [a] : []), ...(here !== there ? [a.clone().lerp(b, (-near - a.z) / (b.z - a.z))] : [])];
    });
  }

  /** Pixels of a length at a depth. */
  scale(q: number): number {
    return (this.camera.projectionMatrix.elements[5]! * q * this.high) / 2;
  }

  place({ x, y, z }: Vector3, nearer = 0): Point {
    const e = this.camera.projectionMatrix.elements;
    return { x: ((1 - (e[0]! * x) / z) / 2) * this.wide, y: ((1 + (e[5]! * y) / z) / 2) * this.high, q: 1 / (-z - nearer) };
  }

  /** Points of an object, as the eye has them: x right, y up, z backwards. */
  sees({ geometry, matrixWorld }: Mesh | Line): Vector3[] {
    const position = geometry.getAttribute("position");
    const all = Array.from({ length: position.count }, (_, k) =>
      new Vector3().fromBufferAttribute(position, k).applyMatrix4(matrixWorld).applyMatrix4(this.camera.matrixWorldInverse));
    const { index } = geometry;
    return index ? Array.from(index.array, (k) => all[k]!) : all;
  }
}

/** Shades as the renderer of the view has them, after Lambert. */
class Light {
  private ambient = 0;
  private readonly suns: { toward: Vector3; intensity: number }[] = [];

  constructor(scene: Scene, { camera }: Eye) {
    scene.traverse((object) => {
      if ((object as AmbientLight).isAmbientLight) this.ambient += (object as AmbientLight).intensity;
      const sun = object as DirectionalLight;
      if (!sun.isDirectionalLight) return;
      const toward = sun.getWorldPosition(new Vector3()).sub(sun.target.getWorldPosition(new Vector3()));
      this.suns.push({ toward: toward.transformDirection(camera.matrixWorldInverse), intensity: sun.intensity });
    });
  }

  colour({ color, emissive, emissiveIntensity, isMeshLambertMaterial }: MeshLambertMaterial, normal: Vector3): string {
    // Other materials show their colour.
    if (!isMeshLambertMaterial) return color.getStyle();
    const sum = this.suns.reduce((sum, { toward, intensity }) => sum + intensity * Math.max(0, normal.dot(toward)), this.ambient);
    const shaded = color.clone().multiplyScalar(sum / Math.PI).add(emissive.clone().multiplyScalar(emissiveIntensity));
    return new Color(...(shaded.toArray().map((x) => Math.min(1, x)) as [number, number, number])).getStyle();
  }
}

/** What looks at the eye, and both sides of sheets. */
function facetsOf(mesh: Mesh, eye: Eye, light: Light, slack: number): (Facet & { triangle: number })[] {
  const material = mesh.material as MeshLambertMaterial;
  const closed = (mesh.parent?.userData.body as Drawn | undefined)?.body.facts.closed;
  const bothSides = material.side === DoubleSide && !closed;
  const nearer = material.polygonOffset ? -2 * slack * material.polygonOffsetFactor : 0;
  const corners = eye.sees(mesh);
  const facets: (Facet & { triangle: number })[] = [];
  for (let k = 0; k < corners.length; k += 3) {
    const [a, b, c] = [corners[k]!, corners[k + 1]!, corners[k + 2]!];
    const normal = b.clone().sub(a).cross(c.clone().sub(a)).normalize();
    if (normal.dot(a) >= 0) {
      if (!bothSides) continue;
      normal.negate();
    }
    const style = `${light.colour(material, normal)};${material.opacity}`;
    const [first, ...rest] = eye.before([a, b, c], true).map((v) => eye.place(v, nearer));
    for (let i = 1; i < rest.length; i++) {
      const fan = [first!, rest[i - 1]!, rest[i]!] as Corners;
      facets.push({ corners: fan, style, opaque: material.opacity === 1, triangle: k / 3 });
    }
  }
  return facets;
}

/** Neighbours of one style are one path; opaque ones have a thin rim, so that nothing shines through. */
function areasOf(facets: Facet[]): SVGElement[] {
  const paths: { style: string; opaque: boolean; d: string }[] = [];
  for (const { style, opaque, corners } of facets) {
    const [a, b, c] = corners;
    const turn = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    // All of them the same way round: then overlaps add up and nothing is a hole.
    const d = `M${(turn > 0 ? [a, b, c] : [a, c, b]).map(({ x, y }) => `${written(x)} ${written(y)}`).join("L")}Z`;
    const last = paths.at(-1);
    if (last?.style === style) last.d += d;
    else paths.push({ style, opaque, d });
  }
  return paths.map(({ style, opaque, d }) => {
    const [fill, opacity] = style.split(";") as [string, string];
    return svg("path", opaque ? { d, fill, stroke: fill, "stroke-width": RIM } : { d, fill, "fill-opacity": opacity });
  });
}

/** What is seen of a line. */
function strokeOf(line: Line, eye: Eye, depths: Depths, owners: Map<Object3D, number>): SVGElement[] {
  const points = eye.sees(line);
  const apart = line.type === "LineSegments";
  const last = line.type === "LineLoop" ? points.length : points.length - 1;
  const body = (line.parent?.userData.how === "solid" ? line.parent.userData.body : undefined) as Drawn | undefined;
  const beside = body && trianglesBeside(body.body, owners.get(line.parent!) ?? 0);
  const away = (edge: number) => body?.body.facts.closed && !beside![edge]!.some((triangle) => depths.has(triangle));
  let d = "";
  let near = 0;
  for (let k = 0; k < last; k += apart ? 2 : 1) {
    if (away(k / 2)) continue;
    const ends = eye.before([points[k]!, points[(k + 1) % points.length]!], false);
    if (ends.length < 2) continue;
    const [a, b] = ends.map((v) => eye.place(v)) as [Point, Point];
    near = Math.max(near, a.q, b.q);
    const at = (s: number) => `${written(a.x + s * (b.x - a.x))} ${written(a.y + s * (b.y - a.y))}`;
    for (const [from, to] of depths.seen(a, b, beside?.[k / 2])) d += `M${at(from)}L${at(to)}`;
  }
  if (!d) return [];
  const { color, opacity, ...material } = line.material as LineBasicMaterial & Partial<LineDashedMaterial>;
  const dash = material.dashSize && written(material.dashSize * eye.scale(near));
  return [svg("path", { d, fill: "none", stroke: color.getStyle(), "stroke-opacity": opacity, "stroke-linecap": dash ? "butt" : "round", "stroke-dasharray": dash || undefined })];
}

/** Of each edge the triangles that meet there. */
function trianglesBeside({ vertices, triangles, edges }: Body, first: number): number[][] {
  const key = (a: number, b: number) => Math.min(a, b) * (vertices.length / 3) + Math.max(a, b);
  const beside = new Map<number, number[]>();
  for (let t = 0; t < triangles.length; t++) {
    const corner = triangles[t]!;
    const next = triangles[t % 3 === 2 ? t - 2 : t + 1]!;
    const at = beside.get(key(corner, next));
    const owner = first + Math.floor(t / 3);
    if (at) at.push(owner);
    else beside.set(key(corner, next), [owner]);
  }
  return Array.from({ length: edges.length / 2 }, (_, k) => beside.get(key(edges[2 * k]!, edges[2 * k + 1]!)) ?? []);
}
