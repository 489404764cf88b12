// The five tasks of the guide, each in two to four statements.

import { ConvexPolyhedron, Solid, cast, castMany, clearance, distance } from "colltrans";

/** How far can a box move until it touches another? */
export function castTwoBoxes() {
  const box = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1]);
  return cast(box.at([-3, 0.5, 0]), box, [1, 0, 0]).value;
}

/** How far apart are two meshes? */
export function distanceOfMeshes(points, faces, otherPoints, otherFaces) {
  const part = Solid.fromMesh(points, faces);
  return distance(part, Solid.fromMesh(otherPoints, otherFaces)).value;
}

/** Can a part be removed along d? */
export function isFree(part, rest, d) {
  return clearance(part, rest, d).value === Infinity;
}

/** How far can a body move from each of many positions? */
export function manyCasts(body, floor, positions) {
  const answers = castMany(body, floor, [0, 0, -1], { movingPoses: { positions } });
  return answers.value;
}

/** What stops a mesh of three.js on its way to another one? */
export function meshAgainstMesh(mesh, other) {
  const [moving, fixed] = [mesh, other].map((one) => Solid.fromGeometry(one.geometry).at(one));
  return clearance(moving, fixed, [0, 0, -1]);
}
