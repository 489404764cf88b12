// The elements of pictures: lines, rods, balls, sheets, and the frame in which they are drawn.
//
// Coordinates of a picture are those of the world minus `origin`, a point near the bodies. Single precision then
// suffices for parts far from the origin of their coordinates.

import {
  BufferGeometry, ConeGeometry, CylinderGeometry, DoubleSide, Group, Line, LineBasicMaterial, LineDashedMaterial, LineLoop,
  type Material, Mesh, MeshBasicMaterial, MeshLambertMaterial, type Object3D, SphereGeometry, Vector3,
} from "three";
import type { Palette } from "../colours";
import { type Vec, sub } from "../math";

export interface Frame {
  origin: Vec;
  /** Half the extent of the visible scene; widths are fractions of it. */
  size: number;
  colours: Palette;
}

/** A label, slightly beyond the end of a segment. */
export interface Label {
  text: string;
  start: Vector3;
  end: Vector3;
  kind: string;
}

export const inPicture = ({ origin }: Frame, v: Vec): Vector3 => new Vector3(...sub(v, origin));

export function line(points: Vector3[], colour: string, opacity = 1): Line {
  return new Line(new BufferGeometry().setFromPoints(points), new LineBasicMaterial({ color: colour, transparent: true, opacity }));
}

export function loop(points: Vector3[], colour: string, opacity: number): Line {
  return new LineLoop(new BufferGeometry().setFromPoints(points), new LineBasicMaterial({ color: colour, transparent: true, opacity }));
}

export function dashes(points: Vector3[], colour: string, opacity: number, dash: number): Line {
  const look = { color: colour, transparent: true, opacity, dashSize: dash, gapSize: dash };
  return new Line(new BufferGeometry().setFromPoints(points), new LineDashedMaterial(look)).computeLineDistances();
}

/** Builds a rod with a head. */
export function rod(from: Vector3, to: Vector3, colour: string, width: number): Group {
  const group = new Group();
  const way = to.clone().sub(from);
  const long = way.length();
  const head = Math.min(5 * width, long / 2);
  const material = new MeshLambertMaterial({ color: colour, emissive: colour, emissiveIntensity: 0.35 });
  const shaft = new Mesh(new CylinderGeometry(width, width, long - head, 16), material);
  shaft.position.y = (long - head) / 2;
  const cone = new Mesh(new ConeGeometry(2.4 * width, head, 24), material);
  cone.position.y = long - head / 2;
  group.add(shaft, cone);
  group.position.copy(from);
  group.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), way.normalize());
  return group;
}

export function ball(at: Vector3, radius: number, material: Material): Mesh {
  const mesh = new Mesh(new SphereGeometry(radius, 24, 16), material);
  mesh.position.copy(at);
  return mesh;
}

/** Returns the material of a translucent sheet; objects behind it are drawn first. */
export function sheet(colour: string, opacity: number): MeshBasicMaterial {
  return new MeshBasicMaterial({ color: colour, transparent: true, opacity, side: DoubleSide, depthWrite: false });
}

/** Draws an object above everything. */
export function above(object: Object3D) {
  object.traverse((part) => {
    part.renderOrder = 5;
    const { material } = part as Partial<Mesh>;
    for (const one of material ? ([material].flat() as Material[]) : []) {
      one.depthTest = false;
      // So that it is drawn after translucent objects.
      one.transparent = true;
    }
  });
}

/** Empties a group and frees the graphics memory, except of kept geometries. Materials are freed after the next picture,
 * because it uses the same programs, which would be compiled again. */
export function clear(group: Group, kept = new Set<BufferGeometry>()) {
  const materials: Material[] = [];
  group.traverse((object) => {
    const { geometry, material } = object as Partial<Mesh>;
    if (geometry && !kept.has(geometry)) geometry.dispose();
    if (material) materials.push(...[material].flat());
  });
  group.clear();
  requestAnimationFrame(() => requestAnimationFrame(() => materials.forEach((one) => one.dispose())));
}
