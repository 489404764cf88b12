// The picture as areas and lines: the text of an SVG file.
//
// Data flow: triangles and lines of the scene -> the page (`Eye`), with their colours (`Light`) -> a `Sheet` of them ->
// the module `picture`, which finds the hidden parts.

import {
  type AmbientLight, type BufferGeometry, Color, type DirectionalLight, DoubleSide, type Line, type LineBasicMaterial,
  type LineDashedMaterial, type Mesh, type MeshLambertMaterial, type Object3D, type PerspectiveCamera, type Scene, Vector3,
} from "three";
import { type Body, Engine } from "../engine";
import type { Drawn } from "./body";
import { placeOf } from "./overlay";
import type { Label } from "./shapes";

/** Maximum number of triangles of a file. */
const MOST_DRAWN = 40_000;
/** Differences of depth up to this fraction of the size are ignored. */
const SLACK = 2e-4;

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

export async function drawing({ scene, camera, labels, size, wide, high, ground, text }: Picture): Promise<string> {
  scene.updateMatrixWorld();
  const [meshes, lines]: [Mesh[], Line[]] = [[], []];
  scene.traverseVisible((object) => {
    if ((object as Mesh).isMesh) meshes.push(object as Mesh);
    else if ((object as Line).isLine) lines.push(object as Line);
  });
  const triangles = meshes.reduce((sum, { geometry }) => sum + countOf(geometry) / 3, 0);
  if (triangles > MOST_DRAWN) throw new Error(`${Math.round(triangles)} triangles are too many for an SVG file: the PNG has them`);
  const [eye, slack, sheet] = [new Eye(camera, wide, high), SLACK * size, new Sheet()];
  const light = new Light(scene, eye);
  /** For each body the number of its first triangle. */
  const firsts = new Map<Object3D, number>();
  let first = 0;
  for (const mesh of meshes) {
    if (mesh.parent) firsts.set(mesh.parent, first);
    addMesh(sheet, mesh, eye, light, slack, first);
    first += countOf(mesh.geometry) / 3;
  }
  for (const line of lines) addLine(sheet, line, eye, firsts.get(line.parent!) ?? 0);
  const words = labels.flatMap((label) => {
    const at = placeOf(label, camera, wide, high);
    return at ? [{ at: [at[0], at[1] + 4], text: label.text }] : [];
  });
  const engine = new Engine("colltrans_picture");
  try {
    const { numbers } = await engine.ask({ do: "draw", size: [wide, high], slack, ground, text, words, ...sheet.said() }, sheet.file());
    return new TextDecoder().decode(numbers);
  } finally {
    engine.stop("the drawing is done");
  }
}

const countOf = (geometry: BufferGeometry): number => (geometry.index ?? geometry.getAttribute("position")).count;

/** A point of the page in pixels; q is the inverse of its distance along the view, so that planes stay planes. */
interface Point {
  x: number;
  y: number;
  q: number;
}

/** Triangles and segments on the page, in the format of the module `picture` (`crates/colltrans-wasm/src/picture/scene.rs`). */
class Sheet {
  private readonly styles: Record<"areas" | "lines", Map<string, number>> = { areas: new Map(), lines: new Map() };
  private readonly corners: number[] = [];
  private readonly ends: number[] = [];
  private readonly ofCorners: number[] = [];
  private readonly ofEnds: number[] = [];
  private readonly beside: number[] = [];

  /** `number` identifies the triangle for the lines that are its edges. */
  triangle(corners: Point[], look: { fill: string; opacity: number; above: boolean }, number: number) {
    for (const { x, y, q } of corners) this.corners.push(x, y, q);
    this.ofCorners.push(this.style("areas", look), number);
  }

  segment(ends: Point[], look: { colour: string; opacity: number; dash: number | undefined; below: boolean }, beside: readonly number[]) {
    for (const { x, y, q } of ends) this.ends.push(x, y, q);
    this.ofEnds.push(this.style("lines", look), beside.length);
    this.beside.push(...beside);
  }

  private style(kind: "areas" | "lines", look: object): number {
    const [styles, text] = [this.styles[kind], JSON.stringify(look)];
    if (!styles.has(text)) styles.set(text, styles.size);
    return styles.get(text)!;
  }

  said(): object {
    const list = (kind: "areas" | "lines") => [...this.styles[kind].keys()].map((text) => JSON.parse(text));
    return { areas: list("areas"), lines: list("lines"), triangles: this.ofCorners.length / 2, segments: this.ofEnds.length / 2 };
  }

  file(): ArrayBuffer {
    const [points, numbers] = [[this.corners, this.ends].flat(), [this.ofCorners, this.ofEnds, this.beside].flat()];
    const file = new ArrayBuffer(8 * points.length + 4 * numbers.length);
    new Float64Array(file, 0, points.length).set(points);
    new Uint32Array(file, 8 * points.length).set(numbers);
    return file;
  }
}

/** The projection from the world to the page. */
class Eye {
  constructor(readonly camera: PerspectiveCamera, private readonly wide: number, private readonly high: number) {}

  /** Clips the corners of a triangle or the ends of a segment to the space in front of the eye. */
  before(points: Vector3[], closed: boolean): Vector3[] {
    const near = this.camera.near;
    return points.flatMap((a, k) => {
      const b = points[k + 1] ?? (closed ? points[0]! : a);
      const [here, there] = [-a.z >= near, -b.z >= near];
      return [...(here ? [a] : []), ...(here !== there ? [a.clone().lerp(b, (-near - a.z) / (b.z - a.z))] : [])];
    });
  }

  /** Returns the pixels of a length at a depth. */
  scale(q: number): number {
    return (this.camera.projectionMatrix.elements[5]! * q * this.high) / 2;
  }

  place({ x, y, z }: Vector3, nearer = 0): Point {
    const e = this.camera.projectionMatrix.elements;
    return { x: ((1 - (e[0]! * x) / z) / 2) * this.wide, y: ((1 + (e[5]! * y) / z) / 2) * this.high, q: 1 / (-z - nearer) };
  }

  /** Returns points of an object in the frame of the eye: x right, y up, z backwards. */
  sees({ geometry, matrixWorld }: Mesh | Line): Vector3[] {
    const position = geometry.getAttribute("position");
    const all = Array.from({ length: position.count }, (_, k) =>
      new Vector3().fromBufferAttribute(position, k).applyMatrix4(matrixWorld).applyMatrix4(this.camera.matrixWorldInverse));
    const { index } = geometry;
    return index ? Array.from(index.array, (k) => all[k]!) : all;
  }
}

/** Shades of the view's renderer, after Lambert. */
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

/** Adds the triangles that face the eye, and both sides of sheets. */
function addMesh(sheet: Sheet, mesh: Mesh, eye: Eye, light: Light, slack: number, first: number) {
  const material = mesh.material as MeshLambertMaterial;
  const closed = (mesh.parent?.userData.body as Drawn | undefined)?.body.facts.closed;
  const bothSides = material.side === DoubleSide && !closed;
  const nearer = material.polygonOffset ? -2 * slack * material.polygonOffsetFactor : 0;
  const corners = eye.sees(mesh);
  for (let k = 0; k < corners.length; k += 3) {
    const [a, b, c] = [corners[k]!, corners[k + 1]!, corners[k + 2]!];
    const normal = b.clone().sub(a).cross(c.clone().sub(a)).normalize();
    if (normal.dot(a) >= 0) {
      if (!bothSides) continue;
      normal.negate();
    }
    const look = { fill: light.colour(material, normal), opacity: material.opacity, above: !material.depthTest };
    const [corner, ...rest] = eye.before([a, b, c], true).map((v) => eye.place(v, nearer));
    for (let i = 1; i < rest.length; i++) sheet.triangle([corner!, rest[i - 1]!, rest[i]!], look, first + k / 3);
  }
}

/** Adds a line. `first` is the number of the first triangle of the body whose edges the lines are. */
function addLine(sheet: Sheet, line: Line, eye: Eye, first: number) {
  const points = eye.sees(line);
  const apart = line.type === "LineSegments";
  const last = line.type === "LineLoop" ? points.length : points.length - 1;
  const body = (line.parent?.userData.how === "solid" ? line.parent.userData.body : undefined) as Drawn | undefined;
  const beside = body && trianglesBeside(body.body, first);
  const segments: { ends: Point[]; edge: number }[] = [];
  for (let k = 0; k < last; k += apart ? 2 : 1) {
    const ends = eye.before([points[k]!, points[(k + 1) % points.length]!], false).map((v) => eye.place(v));
    if (ends.length === 2) segments.push({ ends, edge: k / 2 });
  }
  const { color, opacity, dashSize } = line.material as LineBasicMaterial & Partial<LineDashedMaterial>;
  const near = segments.reduce((most, { ends }) => Math.max(most, ends[0]!.q, ends[1]!.q), 0);
  const dash = dashSize && eye.scale(near) * dashSize;
  // The grid on the ground is below everything.
  const below = apart && !line.parent?.userData.body;
  const look = { colour: color.getStyle(), opacity, dash, below };
  for (const { ends, edge } of segments) sheet.segment(ends, look, beside?.[edge] ?? []);
}

/** Returns for each edge the triangles that meet there. */
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
