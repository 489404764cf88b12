// Handles of a screw in the view: the point and the direction of its axis, its angle, its rise.

import { type Ray, Vector3 } from "three";
import { casterAt, onPage, rounded } from "../aim";
import { type Vec, add, cross, dot, sub, times, unit } from "../math";
import type { Screw } from "../state";
import type { View } from "../view";

export interface Grip {
  name: "point" | "axis" | "angle" | "rise";
  /** In the world. */
  at: Vec;
}

/** Returns the screw after a handle is dragged along a ray of the world from the eye. */
function dragged(name: Grip["name"], from: Screw, began: Vec, origin: Vec, way: Vec, fine: number, size: number): Screw | undefined {
  const axis = unit(from.axis);
  const round = (v: Vec) => v.map((x) => Math.round(x * fine) / fine || 0) as Vec;
  switch (name) {
    case "point": {
      // In the plane through the point that faces the eye.
      const eye = unit(sub(began, origin));
      const along = dot(way, eye);
      if (along < 1e-3) return undefined;
      return { ...from, point: round(add(origin, times(way, dot(sub(began, origin), eye) / along))) };
    }
    case "axis": {
      // Over a sphere about the point.
      const reach = Math.hypot(...sub(began, from.point));
      const near = add(origin, times(way, dot(sub(from.point, origin), way)));
      const off = Math.hypot(...sub(near, from.point));
      const depth = off < reach ? Math.sqrt(reach * reach - off * off) : 0;
      const side = dot(sub(began, from.point), way) > 0 ? 1 : -1;
      return { ...from, axis: rounded(unit(sub(add(near, times(way, depth * side)), from.point)), 0.003) };
    }
    case "angle": {
      // Around the axis, at the height of the handle; turns are counted from the last angle.
      const along = dot(way, axis);
      if (Math.abs(along) < 0.05) return undefined;
      const hit = add(origin, times(way, dot(sub(began, origin), axis) / along));
      const flat = (v: Vec) => sub(v, times(axis, dot(v, axis)));
      const [a, b] = [flat(sub(began, from.point)), flat(sub(hit, from.point))];
      if (Math.hypot(...b) < 1e-6 * size) return undefined;
      const turn = (Math.atan2(dot(cross(a, b), axis), dot(a, b)) * 180) / Math.PI;
      return { ...from, angle: Math.round(from.angle + turn) };
    }
    case "rise": {
      // Along the axis, at its point that is nearest to the ray.
      const across = dot(way, axis);
      const square = 1 - across * across;
      if (square < 1e-3) return undefined;
      const between = sub(began, origin);
      const moved = (across * dot(between, way) - dot(between, axis)) / square;
      return { ...from, rise: Math.round((from.rise + moved) * fine) / fine || 0 };
    }
  }
}

export class Grips {
  grips: Grip[] = [];
  screw: Screw | undefined;
  onScrew: (screw: Screw) => void = () => {};

  constructor(private readonly view: View) {
    const canvas = view.renderer.domElement;
    canvas.addEventListener("pointerdown", (event) => this.take(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      if (this.grips.length && this.under(event)) canvas.style.cursor = "grab";
    });
  }

  /** Returns the position of a handle, in pixels of the page. */
  onPage(name: Grip["name"]): [number, number] | undefined {
    const grip = this.grips.find((one) => one.name === name);
    return grip && this.pixels(grip);
  }

  private pixels({ at }: Grip): [number, number] {
    return onPage(this.view.renderer.domElement, this.view.camera, this.view.toScene(at));
  }

  /** Returns the nearest handle under a pointer. */
  private under(event: PointerEvent): Grip | undefined {
    const reach = event.pointerType === "touch" ? 34 : 18;
    const far = (grip: Grip) => {
      const [x, y] = this.pixels(grip);
      return Math.hypot(x - event.clientX, y - event.clientY);
    };
    const near = this.grips.filter((grip) => far(grip) < reach);
    return near.sort((a, b) => far(a) - far(b))[0];
  }

  private take(event: PointerEvent) {
    const grip = this.under(event);
    if (!grip || !this.screw) return;
    const { view } = this;
    const canvas = view.renderer.domElement;
    let { at } = grip;
    view.turns = false;
    canvas.setPointerCapture(event.pointerId);
    event.stopImmediatePropagation();
    const move = (e: PointerEvent) => {
      const { origin, way } = this.world(casterAt(canvas, view.camera, e).ray);
      const fine = 10 ** Math.ceil(2 - Math.log10(view.size));
      const next = dragged(grip.name, this.screw!, at, origin, way, fine, view.size);
      if (!next) return;
      this.onScrew(next);
      // The handle is where it was drawn last.
      at = this.grips.find((one) => one.name === grip.name)?.at ?? at;
    };
    const up = () => {
      canvas.removeEventListener("pointermove", move);
      canvas.removeEventListener("pointerup", up);
      canvas.removeEventListener("pointercancel", up);
      view.turns = true;
    };
    canvas.addEventListener("pointermove", move);
    canvas.addEventListener("pointerup", up);
    canvas.addEventListener("pointercancel", up);
  }

  private world(ray: Ray): { origin: Vec; way: Vec } {
    const { x, y, z } = ray.origin;
    const d = ray.direction.clone().normalize();
    return { origin: add([x, y, z], this.view.frame.origin), way: [d.x, d.y, d.z] };
  }
}

/** Returns a point at the distance of the body's radius from the axis, if the body's middle is on the axis. */
export function arm(screw: Screw, middle: Vec, radius: number): Vec {
  const axis = unit(screw.axis);
  const off = sub(middle, screw.point);
  const flat = sub(off, times(axis, dot(off, axis)));
  if (Math.hypot(...flat) > 0.2 * radius) return middle;
  const side = new Vector3(...axis).cross(Math.abs(axis[0]) < 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0)).normalize();
  return add(middle, times([side.x, side.y, side.z], radius));
}
