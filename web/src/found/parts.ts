// Drawings of a search in the view: sections at their start and contact, and portals on the bodies.

import { BufferGeometry, DoubleSide, Line, LineBasicMaterial, LineLoop, Mesh, MeshBasicMaterial, Vector3 } from "three";
import { palette } from "../colours";
import type { Pair } from "../engine";
import { type Vec, add, times } from "../math";
import type { View } from "../view";
import { type Drawn, corner } from "../view/body";
import { above, ball } from "../view/shapes";
import type { Portal, Two } from "./recording";

/** Two sections, and the translation of the moving one in multiples of the direction. */
export interface Sections {
  moving: Vec[];
  fixed: Vec[];
  t: number;
}

function polygon(view: View, corners: Vec[], colour: string, opacity: number) {
  if (corners.length < 3) return;
  const at = corners.map((v) => view.toScene(v));
  const triangles: Vector3[] = [];
  for (let k = 1; k + 1 < at.length; k++) triangles.push(at[0]!, at[k]!, at[k + 1]!);
  const sheet = new MeshBasicMaterial({ color: colour, transparent: true, opacity, side: DoubleSide, depthWrite: false });
  const line = new LineLoop(new BufferGeometry().setFromPoints(at), new LineBasicMaterial({ color: colour }));
  view.extra.add(new Mesh(new BufferGeometry().setFromPoints(triangles), sheet), line);
}

/** Draws the sections and the displacement of the moving one. */
export function drawSections(view: View, { moving, fixed, t }: Sections, direction: Vec) {
  const colours = palette();
  polygon(view, fixed, colours.fixedMark, 0.6);
  polygon(view, moving, colours.movingMark, t ? 0.25 : 0.6);
  if (!t) return;
  const moved = moving.map((v) => add(v, times(direction, t)));
  polygon(view, moved, colours.movingMark, 0.6);
  for (const k of [0, Math.floor(moving.length / 2)]) {
    const ends = [moving[k]!, moved[k]!].map((v) => view.toScene(v));
    view.extra.add(new Line(new BufferGeometry().setFromPoints(ends), new LineBasicMaterial({ color: colours.movingMark, transparent: true, opacity: 0.5 })));
  }
}

/** Draws the three vertices of each body that form a portal; those of the moving body at the contact. For the portal of
 * the proof, the proof names them. */
export function drawPortal(view: View, { pairs }: Portal, proven: Two[], [moving, fixed]: [Drawn, Drawn], pair: Pair, t: number) {
  const colours = palette();
  const told = pairs.filter((one) => one !== undefined);
  const known = told.length < 3 ? proven : told;
  if (known.length < 3) return;
  const own = known.map(([v]) => add(corner(moving, pair.moving_pose, v), times(pair.direction, t)));
  const other = known.map(([, v]) => corner(fixed, pair.fixed_pose, v));
  for (const [points, colour] of [[other, colours.fixedMark], [own, colours.movingMark]] as const) {
    polygon(view, points, colour, 0.7);
    for (const v of points) {
      const dot = ball(view.toScene(v), 0.012 * view.size, new MeshBasicMaterial({ color: colour }));
      above(dot);
      view.extra.add(dot);
    }
  }
}
