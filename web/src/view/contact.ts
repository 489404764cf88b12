// The contact and its proof: point, normal, supporting plane, features, the pairs of vertices of the upper bound; or the
// plane between bodies that never meet.

import {
  BufferGeometry, CircleGeometry, CylinderGeometry, Group, type Matrix4, Mesh, MeshBasicMaterial, type Object3D, PlaneGeometry,
  SphereGeometry, Vector3,
} from "three";
import type { Certificate, Feature, PageCast, PageFeature } from "../answers";
import type { Slot, Touch } from "../engine";
import { type Pose, type Vec, add, cross, dot, placed, sub, times, unit } from "../math";
import type { State } from "../state";
import { type Drawn, corner, highest, matrixOf } from "./body";
import { type Frame, type Label, ball, dashes, inPicture, loop, rod, sheet } from "./shapes";

type Both = Record<Slot, Drawn>;
type Poses = Record<Slot, Pose>;

export function contact(frame: Frame, first: Touch, proof: PageCast["proof"], state: State, bodies: Both): { parts: Object3D[]; label: Label } {
  const { size, colours, origin } = frame;
  const { poses, direction } = state;
  const { moving, fixed } = bodies;
  const n = first.normal;
  const along = times(direction, first.t);
  const shifts = onSurfaces(n, bodies, along);
  const point = inPicture(frame, first.point);
  const start = inPicture(frame, sub(first.point, along));
  const reach = Math.min(moving.radius, fixed.radius);
  const back = (length: number) => inPicture(frame, sub(first.point, times(n, length * reach)));
  const parts = [
    dashes([start, point], colours.way, 0.7, size / 40),
    ...disc(point, n, 0.8 * reach, colours.plane),
    rod(back(0.62), point, colours.normal, 0.007 * size),
    ball(point, 0.013 * size, new MeshBasicMaterial({ color: colours.normal })),
    feature(first.features.fixed.kind, first.lit.fixed, fixed, matrixOf(poses.fixed, fixed.middle, origin, shifts.fixed), colours.fixedMark, size),
    feature(first.features.moving.kind, first.lit.moving, moving, matrixOf(poses.moving, moving.middle, origin, shifts.moving), colours.movingMark, size),
  ];
  if (proof && "contact" in proof) parts.push(...witness(frame, proof.contact.pairs, shifts, poses, bodies));
  return { parts, label: { text: "n", start: point, end: back(0.62), kind: "normal" } };
}

/** Draws the supporting plane that proves the lower bound. */
export function disc(at: Vector3, normal: Vec, radius: number, colour: string): Object3D[] {
  const disc = new Mesh(new CircleGeometry(radius, 72), sheet(colour, 0.2));
  disc.position.copy(at);
  disc.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...normal));
  const rim = Array.from({ length: 72 }, (_, k) => {
    const a = (k * Math.PI) / 36;
    return new Vector3(radius * Math.cos(a), radius * Math.sin(a), 0).applyQuaternion(disc.quaternion).add(at);
  });
  return [disc, loop(rim, colour, 0.8)];
}

/** Returns the shifts from features of the cores to the surfaces in contact, if the moving body has moved by `along`. Where
 * the surface of a rounded body has a given normal, it is a feature of the core, moved along the normal by the radius. */
export const onSurfaces = (normal: Vec, { moving, fixed }: Both, along: Vec = [0, 0, 0]): Record<Slot, Vec> => ({
  moving: add(along, times(normal, moving.body.facts.radius)),
  fixed: times(normal, -fixed.body.facts.radius),
});

/** Draws the three pairs of vertices that prove the upper bound, at the contact. */
function witness(frame: Frame, pairs: Certificate["pairs"], shifts: Record<Slot, Vec>, poses: Poses, { moving, fixed }: Both): Object3D[] {
  const { colours } = frame;
  const triangles: [Vec[], string][] = [
    [pairs.map((pair) => add(corner(moving, poses.moving, pair.moving), shifts.moving)), colours.movingMark],
    [pairs.map((pair) => add(corner(fixed, poses.fixed, pair.fixed), shifts.fixed)), colours.fixedMark],
  ];
  return triangles.flatMap(([corners, colour]) => {
    const at = corners.map((v) => inPicture(frame, v));
    return [new Mesh(new BufferGeometry().setFromPoints(at), sheet(colour, 0.25)), loop(at, colour, 0.9)];
  });
}

/** Draws the vertex, edge or face in contact. Faces of rounded bodies are those of their cores. */
export function feature(kind: Feature["kind"], of: PageFeature, body: Drawn, matrix: Matrix4, colour: string, size: number): Group {
  const group = new Group();
  group.matrixAutoUpdate = false;
  group.matrix.copy(matrix);
  const { vertices } = body.body;
  const at = (v: number) => new Vector3(...([0, 1, 2].map((c) => vertices[3 * v + c]! - body.middle[c]!) as Vec));
  if (kind === "face") {
    const material = sheet(colour, 0.55);
    material.polygonOffset = true;
    material.polygonOffsetFactor = -1;
    material.polygonOffsetUnits = -1;
    group.add(new Mesh(new BufferGeometry().setFromPoints(body.body.facts.radius ? fan(of.vertices.map(at)) : faceOf(body, of.face)), material));
  } else if (kind === "edge" && of.vertices.length === 2) {
    const [a, b] = of.vertices.map(at) as [Vector3, Vector3];
    const width = 0.007 * size;
    const edge = new Mesh(new CylinderGeometry(width, width, a.distanceTo(b), 12), new MeshBasicMaterial({ color: colour }));
    edge.position.copy(a).lerp(b, 0.5);
    edge.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), b.clone().sub(a).normalize());
    group.add(edge);
  } else if (of.vertices[0] !== undefined) {
    const vertex = new Mesh(new SphereGeometry(0.02 * size, 20, 12), new MeshBasicMaterial({ color: colour }));
    vertex.position.copy(at(of.vertices[0]));
    group.add(vertex);
  }
  return group;
}

/** Returns the corners of the triangles of a convex polygon. */
const fan = ([first, ...rest]: Vector3[]): Vector3[] => rest.slice(1).flatMap((v, k) => [first!, rest[k]!, v]);

/** Returns the corners of the triangles of a face, relative to the body's middle. */
function faceOf({ body: { faces }, geometry }: Drawn, face: number | undefined): Vector3[] {
  const position = geometry.getAttribute("position");
  const corners: Vector3[] = [];
  faces.forEach((of, k) => {
    if (of !== face) return;
    for (let c = 0; c < 3; c++) corners.push(new Vector3().fromBufferAttribute(position, 3 * k + c));
  });
  return corners;
}

/** Draws the plane between bodies that never meet. */
export function gap(frame: Frame, normal: Vec, margin: number, state: State, { moving, fixed }: Both): Object3D[] {
  const { size, colours } = frame;
  const middle = placed(state.poses.fixed, fixed.middle);
  const level = highest(moving.body, state.poses.moving, normal) + margin / 2 - dot(middle, normal);
  const at = add(middle, times(normal, level));
  const d = unit(state.direction);
  const across = cross(normal, d);
  const [long, wide] = [1.1 * size, 0.8 * fixed.radius];
  const plane = new Mesh(new PlaneGeometry(2 * long, 2 * wide), sheet(colours.plane, 0.2));
  plane.matrixAutoUpdate = false;
  plane.matrix.makeBasis(new Vector3(...d), new Vector3(...across), new Vector3(...normal));
  plane.matrix.setPosition(inPicture(frame, at));
  const end = (a: number, b: number) => inPicture(frame, add(at, add(times(d, a * long), times(across, b * wide))));
  return [plane, loop([end(-1, -1), end(1, -1), end(1, 1), end(-1, 1)], colours.plane, 0.8)];
}
