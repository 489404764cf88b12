// The drawing of a motion: the moving body at the current time, the start, the contact and the end, the path of one of
// its points, the axis with its handles, and the contact.

import { MeshBasicMaterial, MeshLambertMaterial, type Object3D } from "three";
import type { PageMotion } from "../answers";
import { type Pose, type Vec, add, placed, sub, times, unit } from "../math";
import type { Slot } from "../engine";
import { type Screw, type State, otherOf } from "../state";
import type { View } from "../view";
import { type Drawn, type How, matrixOf, placedBody } from "../view/body";
import { disc, feature, onSurfaces } from "../view/contact";
import type { Ball } from "../view/framing";
import { type Label, above, ball, dashes, inPicture, line, rod } from "../view/shapes";
import { type Grip, arm } from "./grips";
import { carried, poseAt } from "./screw";

/** Number of segments in which the path of a rotation is drawn. */
const PIECES = 48;
/** Maximum number of turns of a drawn path; more would be illegible. */
const MOST_TURNS = 12;

/** Draws everything into `view.extra` and returns the handles. */
export function draw(view: View, state: State, screw: Screw, answer: PageMotion | undefined, bodies: Record<Slot, Drawn>): Grip[] {
  const { frame } = view;
  const { size, colours } = frame;
  const { time, body: moves } = state.motion;
  const [start, mover] = [state.poses[moves], bodies[moves]];
  const stop = answer?.record.time?.lower;
  const body = (t: number, how: How) => {
    view.extra.add(placedBody(mover, matrixOf(poseAt(screw, start, t), mover.middle, frame.origin), colours[moves], how, colours));
  };
  body(time, "solid");
  if (time > 0) body(0, "outline");
  if (time < 1) body(1, stop === undefined ? "ghost" : "outline");
  if (stop !== undefined && Math.abs(stop - time) > 1e-9) body(stop, "ghost");
  const parts: Object3D[] = [];
  const labels: Label[] = [];
  // The path of a point, dashed where the body does not get.
  const middle = screw.angle ? arm(screw, placed(start, mover.middle), mover.radius) : placed(start, mover.middle);
  const turns = Math.min(Math.abs(screw.angle) / 360, MOST_TURNS);
  const count = Math.max(2, Math.ceil(PIECES * Math.max(turns, 0.25)));
  const way = (from: number, to: number) => Array.from({ length: count + 1 }, (_, k) => inPicture(frame, carried(screw, middle, from + ((to - from) * k) / count)));
  const free = stop ?? 1;
  if (free > 0) parts.push(line(way(0, free), colours.way, 0.8));
  if (free < 1) parts.push(dashes(way(free, 1), colours.way, 0.7, size / 50));
  // The axis.
  const axis = unit(screw.axis);
  const reach = 0.55 * size;
  const at = (length: number) => add(screw.point, times(axis, length));
  const tip = at(reach);
  const look = () => new MeshLambertMaterial({ color: colours.way, emissive: colours.way, emissiveIntensity: 0.2 });
  const grips: Grip[] = [{ name: "point", at: screw.point }, { name: "axis", at: tip }];
  if (screw.angle) grips.push({ name: "angle", at: carried(screw, middle, 1) });
  const handles: Object3D[] = [
    dashes([inPicture(frame, at(-reach)), inPicture(frame, screw.point)], colours.way, 0.8, size / 60),
    rod(inPicture(frame, screw.point), inPicture(frame, tip), colours.way, 0.006 * size),
  ];
  if (screw.rise) {
    const top = at(screw.rise);
    grips.push({ name: "rise", at: top });
    handles.push(line([inPicture(frame, screw.point), inPicture(frame, top)], colours.plane, 1));
    labels.push({ text: "rise", start: inPicture(frame, screw.point), end: inPicture(frame, top), kind: "axis" });
  }
  handles.push(...grips.map((grip) => ball(inPicture(frame, grip.at), 0.022 * size, look())));
  handles.forEach(above);
  labels.push({ text: "axis", start: inPicture(frame, screw.point), end: inPicture(frame, tip), kind: "way" });
  const end = inPicture(frame, carried(screw, middle, 1));
  if (screw.angle) labels.push({ text: `${screw.angle}°`, start: inPicture(frame, carried(screw, middle, 0.97)), end, kind: "way" });
  if (answer) parts.push(...contact(view, { ...state.poses, [moves]: poseAt(screw, start, stop ?? 0) }, answer, bodies, labels));
  view.extra.add(...parts, ...handles);
  view.extraLabels = labels;
  return grips;
}

/** Draws the features in contact at the poses of the contact. */
function contact(view: View, poses: Record<Slot, Pose>, { record: { point, normal }, lit }: PageMotion, bodies: Record<Slot, Drawn>, labels: Label[]): Object3D[] {
  if (!point || !normal) return [];
  const { moving, fixed } = bodies;
  const { frame } = view;
  const { size, colours, origin } = frame;
  const [at, n] = [point as Vec, normal as Vec];
  const shifts = onSurfaces(n, bodies);
  const reach = Math.min(moving.radius, fixed.radius);
  const [end, from] = [inPicture(frame, at), inPicture(frame, sub(at, times(n, 0.62 * reach)))];
  labels.push({ text: "n", start: end, end: from, kind: "normal" });
  const kind = (vertices: number[], face: number | undefined) => (face !== undefined ? "face" : vertices.length === 2 ? "edge" : "vertex");
  return [
    ...disc(end, n, 0.8 * reach, colours.plane),
    rod(from, end, colours.normal, 0.007 * size),
    ball(end, 0.013 * size, new MeshBasicMaterial({ color: colours.normal })),
    ...(lit ? [
      feature(kind(lit.fixed.vertices, lit.fixed.face), lit.fixed, fixed, matrixOf(poses.fixed, fixed.middle, origin, shifts.fixed), colours.fixedMark, size),
      feature(kind(lit.moving.vertices, lit.moving.face), lit.moving, moving, matrixOf(poses.moving, moving.middle, origin, shifts.moving), colours.movingMark, size),
    ] : []),
  ];
}

/** Returns balls around everything to be in the picture: both bodies, the moving one along its path, and the point of the axis. */
export function seen({ poses, motion: { body } }: State, screw: Screw, bodies: Record<Slot, Drawn>): Ball[] {
  const [mover, rests] = [bodies[body], otherOf(body)];
  const middle = placed(poses[body], mover.middle);
  const times = Array.from({ length: 9 }, (_, k) => k / 8);
  return [
    [placed(poses[rests], bodies[rests].middle), bodies[rests].radius], [screw.point, 0],
    ...times.map((time): Ball => [carried(screw, middle, time), mover.radius]),
  ];
}

/** Returns the direction of a view across the axis, slightly from above. */
export function side(screw: Screw, along: boolean): Vec {
  const axis = unit(screw.axis);
  if (along) return times(axis, 1);
  // The path of a rotation is best visible along its axis, its rise from the side.
  const views: Vec[] = [[-0.62, -0.68, 0.4], [0.62, -0.68, 0.4], [-0.62, 0.68, 0.4], [0.62, 0.68, 0.4], [0.25, -0.45, 0.86]];
  const score = (v: Vec) => {
    const share = Math.abs(v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2]);
    return -Math.abs(share - (screw.rise ? 0.35 : 0.6));
  };
  return views.reduce((best, v) => (score(v) > score(best) ? v : best));
}
