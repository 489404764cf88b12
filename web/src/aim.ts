// The arrow of a direction; its tip is dragged over a sphere about its base.

import { type Camera, Raycaster, Vector2, Vector3 } from "three";
import type { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Vec } from "./math";

/** Projects a point of the scene to pixels of the page. */
export function onPage(canvas: HTMLCanvasElement, camera: Camera, point: Vector3): [number, number] {
  const box = canvas.getBoundingClientRect();
  const at = point.clone().project(camera);
  return [((at.x + 1) / 2) * box.width + box.left, ((1 - at.y) / 2) * box.height + box.top];
}

/** Casts a ray through a pixel. */
export function casterAt(canvas: HTMLCanvasElement, camera: Camera, event: MouseEvent): Raycaster {
  const box = canvas.getBoundingClientRect();
  const x = ((event.clientX - box.left) / box.width) * 2 - 1;
  const y = 1 - ((event.clientY - box.top) / box.height) * 2;
  const caster = new Raycaster();
  caster.setFromCamera(new Vector2(x, y), camera);
  return caster;
}

/** Rounds a vector to four digits; small components become 0. */
export const rounded = (v: Vec, small: number): Vec =>
  v.map((x) => (Math.abs(x) < small ? 0 : Number(x.toPrecision(4)))) as Vec;

/** Calls back with a unit vector while the tip is dragged. */
export function aim(
  canvas: HTMLCanvasElement, camera: Camera, orbit: OrbitControls,
  ends: () => { base: Vector3; tip: Vector3 } | undefined,
  turn: (way: Vec, done: boolean) => void,
) {
  const near = (event: PointerEvent): boolean => {
    const now = ends();
    if (!now) return false;
    const [x, y] = onPage(canvas, camera, now.tip);
    return Math.hypot(x - event.clientX, y - event.clientY) < (event.pointerType === "touch" ? 34 : 18);
  };
  const ray = (event: PointerEvent) => casterAt(canvas, camera, event).ray;
  let side = 0;
  const point = (event: PointerEvent, done: boolean) => {
    const now = ends();
    if (!now) return;
    const { base, tip } = now;
    const reach = tip.distanceTo(base);
    const r = ray(event);
    const middle = r.closestPointToPoint(base, new Vector3());
    const off = middle.distanceTo(base);
    const depth = off < reach ? Math.sqrt(reach * reach - off * off) : 0;
    const at = middle.addScaledVector(r.direction, depth * side).sub(base).normalize();
    turn([at.x, at.y, at.z], done);
  };
  canvas.addEventListener("pointerdown", (event) => {
    const now = ends();
    if (!now || !near(event)) return;
    side = Math.sign(now.tip.clone().sub(now.base).dot(ray(event).direction)) || 1;
    orbit.enabled = false;
    canvas.setPointerCapture(event.pointerId);
    event.stopImmediatePropagation();
    const move = (e: PointerEvent) => point(e, false);
    const up = (e: PointerEvent) => {
      canvas.removeEventListener("pointermove", move);
      canvas.removeEventListener("pointerup", up);
      canvas.removeEventListener("pointercancel", up);
      orbit.enabled = true;
      point(e, true);
    };
    canvas.addEventListener("pointermove", move);
    canvas.addEventListener("pointerup", up);
    canvas.addEventListener("pointercancel", up);
  }, { capture: true });
  canvas.addEventListener("pointermove", (event) => {
    canvas.style.cursor = near(event) ? "grab" : "";
  });
}
